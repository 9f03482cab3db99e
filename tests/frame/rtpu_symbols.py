# SPDX-License-Identifier: Apache-2.0
"""The real-time program links no YAML, JSON or HTTP: judged by its symbols. The `chimera` command, which does, proves
that the look finds them where they are."""
import subprocess
import sys

UNWANTED = ("YAML::", "nlohmann::", "boost::beast", "ut_parse")


def found(program):
    symbols = subprocess.run(["nm", "--demangle", program], check=True, capture_output=True, text=True).stdout
    libraries = subprocess.run(["ldd", program], check=True, capture_output=True, text=True).stdout
    return [word for word in UNWANTED if word in symbols] + [lib for lib in ("yaml", "udunits") if lib in libraries]


rtpu, command = sys.argv[1:]
assert found(command), f"{command} shows nothing of what it links: the look is blind"
if found(rtpu):
    sys.exit(f"{rtpu} links {', '.join(found(rtpu))}")
