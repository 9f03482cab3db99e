# SPDX-License-Identifier: Apache-2.0
"""Makes the recorded profile (docs/formats/profile.md) of the lines that an image prints at its end.
usage: recorded_profile.py BAKED OUTPUT > PROFILE   (OUTPUT: the lines of the serial port)"""
import json
import pathlib
import re
import sys

LINE = re.compile(r"profile (\S+) samples (\d+) worst (\d+) mean (\d+) response (\d+) jitter (\d+)")
KEYS = ("samples", "worst_ns", "mean_ns", "response_ns", "jitter_ns")


def of_image(lines, baked):
    """The profile as one object. `baked`: the folder that `chimera bake` made."""
    subsystem = json.loads((pathlib.Path(baked) / "dictionary.json").read_text())["subsystem"]
    found = filter(None, (LINE.fullmatch(line.strip()) for line in lines))
    tasks = [{"task": each[1], **{key: int(each[i + 2]) for i, key in enumerate(KEYS)}} for each in found]
    return {"version": 1, "subsystem": subsystem, "tasks": tasks}


def main():
    lines = pathlib.Path(sys.argv[2]).read_text(errors="replace").splitlines()
    print(json.dumps(of_image(lines, sys.argv[1]), indent=2))


if __name__ == "__main__":
    main()
