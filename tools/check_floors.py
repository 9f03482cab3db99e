# SPDX-License-Identifier: Apache-2.0
"""Proves by the #include lines that a folder imports only lower floors (docs/walk.md), and that the support of tests
lies in testing/ folders, which no production source includes,
and that only chimera/platform/ sees the headers of an operating system."""
import pathlib
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent / "check"))
import sources  # noqa: E402

FLOOR = {"base": 0, "platform": 1, "table": 2, "task": 3, "schedule": 4, "runtime": 5, "load": 5, "rtpu": 6,
         "text": 6, "units": 7, "description": 8, "catalogue": 9, "verify": 10, "analysis": 11,
         "keeper": 12, "guard": 12, "component_test": 12, "control": 12, "subsystem": 12, "draw": 12, "bake": 12,
         "cli": 13, "manager": 13, "record": 13, "web": 14}
# Rooms of one floor: a room imports only those with lower numbers. "" is the folder itself.
INSIDE = {"cli": {"": 0, "command": 0, "files": 1, "print": 1, "live": 2, "run": 3, "batch": 4},
          "runtime": {"": 0, "record": 1, "job": 2, "plan": 3, "state": 4, "life": 5, "switch": 6, "cycle": 7,
                      "executive": 8, "link": 8, "hosted": 8, "preemptive": 9, "virtual": 9},
          "manager": {"state": 0, "watch": 1, "answer": 2, "switch": 3, "act": 4, "": 5},
          "control": {"receipt": 0, "": 1},
          "description": {"": 0, "edit": 1}}
COMPONENT_INTERFACE = ("chimera/task/abi.h", "chimera/task/component.h", "chimera/task/geometry.h",
                       "chimera/task/number_at.h", "chimera/task/pbo.h", "chimera/task/rig.h")
# Each platform implements these; those of an image are in firmware/.
OF_PLATFORMS = ("library/button/input_pin.h", "library/terminal/terminal_line.h")
ROOT_FOLDERS = ("chimera", "library", "apps", "executive", "firmware", "examples", "tests", "bench", "tools")
# Slow to compile: one .cc of an upper floor pays for each, never a header, never the real-time floors.
HEAVY = re.compile(r"^(boost/|yaml-cpp/|nlohmann/|fmt/|mujoco/|gmock/)")
SEES_BOOST = "chimera/web/web_server.cc"
SEES_JSON_LIBRARY = ("chimera/text/json.cc", "chimera/text/json_test.cc")  # all others include chimera/text/json.h
INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*([<"])([^">]+)[">]', re.MULTILINE)


def includes(root, name):
    """(line, quoted?, path) of every include line."""
    content = sources.text(root, name)
    for match in INCLUDE.finditer(content):
        yield content.count("\n", 0, match.start()) + 1, match[1] == '"', match[2]


def interface_headers(root):
    """The headers of the component interface and all that these include."""
    known, queue = set(), [name for name in COMPONENT_INTERFACE if (root / name).is_file()]
    while queue:
        name = queue.pop()
        if name not in known:
            known.add(name)
            queue += [path for _, quoted, path in includes(root, name) if quoted and (root / path).is_file()]
    return known


# Headers of POSIX and Linux. Not among them: <csignal>, standard C++ for the numbers of signals; <elf.h>, a format.
SYSTEM = re.compile(r"^(aio|dirent|dlfcn|execinfo|fcntl|ftw|glob|grp|ifaddrs|libgen|link|mqueue|netdb|poll|pthread|"
                    r"pty|pwd|sched|semaphore|signal|spawn|sys(exits|log)|termios?|ucontext|unistd|utime?|utmpx?|"
                    r"wordexp|(arpa|asm|asm-generic|linux|net|netinet|netpacket|sys)/.*)\.h$")
SEES_THE_SYSTEM = {
    "chimera/platform/": "the floor for it",
    "chimera/base/hosted/ordinary_file.h": "components read files too, and they see chimera/base only",
    "chimera/cli/print/outlet.cc": "a stream that never waits for its reader",
    "chimera/cli/run/own_process.cc": "forks, waits and passes signals on: one piece of code with its limits of time",
    "chimera/cli/batch/side_by_side.cc": "the same of many children",
    "chimera/cli/run/under_way.cc": "memory shared with both of these",
    "library/button/": "a digital input",
    "library/csv_log/": "writes a file, whose loss it must tell",
    "library/device/": "reasons why a device cannot be opened",
    "library/modbus_io/": "a serial line, a socket",
    "library/serial_frame/": "a serial line",
    "library/tball/": "an input device",
    "library/terminal/": "the mode of a terminal",
    "library/udp_frame/": "a socket",
    "library/vision/": "a socket",
}
TESTS = re.compile(r"^(tests|bench)/|/testing/|_(test|fuzz|stress)\.cc$")
# Included by tests alone, and yet no support of our tests.
OFFERED = {"chimera/task/rig.h": "the authors of components test with it",
           "chimera/task/rig_ports.h": "a part of rig.h",
           "chimera/task/rig_safe_frames.h": "a part of rig.h"}


def testing_complaints(root, names):
    """Headers outside of testing/ that are included by nothing but tests, other such headers and their own .cc."""
    users = {}
    for name in names:
        for _, quoted, path in includes(root, name):
            if quoted:
                users.setdefault(path, set()).add(name)
    of_tests, grows = {name for name in names if TESTS.search(name)}, True
    while grows:
        grows = False
        for name in names:
            beside = name[:-2] + ".cc"
            others = users.get(name, set()) - {beside}
            if name.endswith(".h") and name not in of_tests and others and others <= of_tests:
                of_tests |= {name, beside}
                grows = True
    for name in names:
        if name in of_tests and name.endswith(".h") and not TESTS.search(name) and name not in OFFERED:
            yield f"{name}: only tests use it: it belongs into testing/, or is dead"


def floor_of(path):
    parts = path.split("/")
    return FLOOR.get(parts[1]) if parts[0] == "chimera" and len(parts) > 2 else None


def room_of(folders):
    return folders[2] if len(folders) > 3 else ""


def refusal(root, name, path, interface):
    """Why `name` must not include the project's file `path`; None when it may."""
    folder, target = name.split("/"), path.split("/")
    if "testing" in target[:-1] and not TESTS.search(name):
        return "testing/ is for tests"
    if target[0] not in ROOT_FOLDERS:  # else made by the build
        beside = ((root / name).parent / path).is_file()
        return "includes start at the root of the checkout" if beside else None
    if folder[0] == "chimera":
        mine, theirs = floor_of(name), floor_of(path)
        if target[0] != "chimera":
            return f"chimera/ imports nothing from {target[0]}/"
        if mine is None or theirs is None:
            return "no floor is known for this folder"
        if folder[1] != target[1] and theirs >= mine:
            return f"{folder[1]} is floor {mine}, {target[1]} is floor {theirs}"
        inside = INSIDE.get(folder[1]) if folder[1] == target[1] and not TESTS.search(name) else None
        mine, theirs = room_of(folder), room_of(target)
        if inside and mine != theirs and not inside.get(mine, -1) > inside.get(theirs, 99):
            return f"inside {folder[1]}/, {mine or 'the folder itself'} does not import {theirs or 'the folder itself'}"
    if folder[0] == "library" and not name.endswith("_test.cc") and target[0] != "library":
        if path not in interface and not path.startswith("chimera/base/"):
            return "library/ imports only the component interface and chimera/base"
    if folder[0] == "executive" and target[0] == "chimera" and (floor_of(path) is None or floor_of(path) > 5):
        return "executive/ imports only floors 0 to 5"
    if folder[0] == "firmware" and not TESTS.search(name) and target[0] != "firmware" and path not in OF_PLATFORMS:
        if target[0] != "chimera" or floor_of(path) not in range(6) or "hosted" in target:
            return "firmware/ imports only floors 0 to 5 without their hosted halves"
    return None


def heavy_refusal(name, path):
    if path.startswith("nlohmann/"):
        return None if name in SEES_JSON_LIBRARY else "slow to compile: include chimera/text/json.h"
    if not name.startswith("chimera/") or not HEAVY.match(path):
        return None
    if path.startswith("boost/"):
        return None if name == SEES_BOOST else f"only {SEES_BOOST} sees Boost"
    if (floor_of(name) or 0) < 6:
        return "libraries like this stay above the real-time line"
    return "slow to compile: include it in the one .cc that needs it" if name.endswith(".h") else None


def system_refusal(name, path):
    if not name.startswith(("chimera/", "library/", "firmware/")) or TESTS.search(name):
        return None
    if name.startswith(tuple(SEES_THE_SYSTEM)):
        return None
    if SYSTEM.match(path):
        return "only chimera/platform/ sees the operating system"
    return None


def told_floors(root):
    """{folder: floor} as CONTRIBUTING.md draws the floors; none without that file."""
    if not (root / "CONTRIBUTING.md").is_file():
        return None
    drawing = re.search(r"^## Floors\n\n((?: {4}.*\n)+)", sources.text(root, "CONTRIBUTING.md"), re.MULTILINE)
    found, waiting = {}, []
    for word in re.sub(r"\|[^|]*\|", "", drawing[1] if drawing else "").split():
        if not word.isdigit():
            waiting.append(word)
            continue
        found |= dict.fromkeys(waiting, int(word))
        waiting = []
    return found


def drawing_complaints(root):
    told = told_floors(root)
    if told is None:
        return
    there = {name.split("/")[1] for name in sources.files(root) if re.match(r"chimera/\w+/", name)}
    for folder in sorted(set(told) | there):
        if folder not in there:
            yield f"CONTRIBUTING.md: floor '{folder}' is no folder of chimera/"
        elif told.get(folder) != FLOOR.get(folder):
            yield (f"CONTRIBUTING.md: floor of '{folder}': {told.get(folder)}, but tools/check_floors.py says "
                   f"{FLOOR.get(folder)}")


def check(root):
    yield from drawing_complaints(root)
    interface = interface_headers(root)
    names = [name for name in sources.files(root) if name.endswith((".h", ".cc", ".c"))]
    yield from testing_complaints(root, names)
    for name in names:
        for line, quoted, path in includes(root, name):
            why = refusal(root, name, path, interface) if quoted else heavy_refusal(name, path)
            why = why or system_refusal(name, path)
            if why:
                yield f"{name}:{line}: includes {path}: {why}"


def _tree(name, included):
    return {name: f"#include {included}\n"}


_SUPPORT = "chimera/base/testing/x.h"
_DRAWING = "## Floors\n\n    base 0 | the line |\n    load{} 5\n\nMore.\n"
PLANTED = (
    (_tree("chimera/table/x.h", '"chimera/base/time.h"'), None),
    (_tree("chimera/table/x.h", '"chimera/table/y.h"'), None),
    (_tree("chimera/base/x.h", '"chimera/table/y.h"'),
     "chimera/base/x.h:1: includes chimera/table/y.h: base is floor 0, table is floor 2"),
    (_tree("chimera/manager/x.cc", '"chimera/record/y.h"'),
     "chimera/manager/x.cc:1: includes chimera/record/y.h: manager is floor 13, record is floor 13"),
    (_tree("chimera/cli/run/x.cc", '"chimera/cli/files/y.h"'), None),
    (_tree("chimera/cli/live/testing/x.h", '"chimera/cli/live/y.h"'), None),
    (_tree("chimera/cli/files/x.cc", '"chimera/cli/run/y.h"'),
     "chimera/cli/files/x.cc:1: includes chimera/cli/run/y.h: inside cli/, files does not import run"),
    (_tree("chimera/cli/live/x_test.cc", '"chimera/cli/run/y.h"'), None),
    (_tree("chimera/runtime/x.h", '"chimera/runtime/job/y.h"'),
     "chimera/runtime/x.h:1: includes chimera/runtime/job/y.h: inside runtime/, the folder itself does not import job"),
    (_tree("chimera/manager/x.h", '"chimera/manager/act/y.h"'), None),
    ({"CONTRIBUTING.md": _DRAWING.format(""), "chimera/base/x.h": "", "chimera/load/x.h": ""}, None),
    ({"CONTRIBUTING.md": _DRAWING.format(" web"), "chimera/base/x.h": "", "chimera/load/x.h": ""},
     "CONTRIBUTING.md: floor 'web' is no folder of chimera/"),
    ({"CONTRIBUTING.md": _DRAWING.format(""), "chimera/base/x.h": "", "chimera/load/x.h": "", "chimera/draw/x.h": ""},
     "CONTRIBUTING.md: floor of 'draw': None, but tools/check_floors.py says 12"),
    (_tree("chimera/load/x_test.cc", '"chimera/runtime/y.h"'),
     "chimera/load/x_test.cc:1: includes chimera/runtime/y.h: load is floor 5, runtime is floor 5"),
    (_tree("chimera/oddity/x.cc", '"chimera/base/y.h"'),
     "chimera/oddity/x.cc:1: includes chimera/base/y.h: no floor is known for this folder"),
    (_tree("chimera/base/x.cc", '"made_by_the_build.h"'), None),
    ({"chimera/base/x.cc": '#include "time.h"\n', "chimera/base/time.h": "\n"},
     "chimera/base/x.cc:1: includes time.h: includes start at the root of the checkout"),
    (_tree("chimera/base/x.cc", '"library/gain/gain.h"'),
     "chimera/base/x.cc:1: includes library/gain/gain.h: chimera/ imports nothing from library/"),
    (_tree("library/gain/gain.cc", '"chimera/table/register.h"'),
     "library/gain/gain.cc:1: includes chimera/table/register.h: "
     "library/ imports only the component interface and chimera/base"),
    ({"library/gain/gain.cc": '#include "chimera/task/component.h"\n#include "chimera/table/slot.h"\n',
      "chimera/task/component.h": '#include "chimera/table/slot.h"\n', "chimera/table/slot.h": "\n"}, None),
    (_tree("executive/main.cc", '"chimera/verify/verify.h"'),
     "executive/main.cc:1: includes chimera/verify/verify.h: executive/ imports only floors 0 to 5"),
    (_tree("firmware/shell/x.cc", '"chimera/runtime/life/y.h"'), None),
    (_tree("firmware/shell/x_test.cc", '"chimera/runtime/hosted/y.h"'), None),
    (_tree("firmware/shell/x.cc", '"chimera/runtime/hosted/y.h"'),
     "firmware/shell/x.cc:1: includes chimera/runtime/hosted/y.h: "
     "firmware/ imports only floors 0 to 5 without their hosted halves"),
    (_tree("firmware/x.cc", '"chimera/verify/y.h"'),
     "firmware/x.cc:1: includes chimera/verify/y.h: firmware/ imports only floors 0 to 5 without their hosted halves"),
    (_tree("firmware/x.cc", '"library/button/input_pin.h"'), None),
    (_tree("firmware/x.cc", "<unistd.h>"),
     "firmware/x.cc:1: includes unistd.h: only chimera/platform/ sees the operating system"),
    ({"chimera/base/x.cc": f'#include "{_SUPPORT}"\n', _SUPPORT: ""},
     f"chimera/base/x.cc:1: includes {_SUPPORT}: testing/ is for tests"),
    ({"chimera/base/x_test.cc": f'#include "{_SUPPORT}"\n', _SUPPORT: ""}, None),
    ({"chimera/base/x_test.cc": '#include "chimera/base/y.h"\n', "chimera/base/y.h": ""},
     "chimera/base/y.h: only tests use it: it belongs into testing/, or is dead"),
    ({"bench/x.h": '#include "chimera/base/y.h"\n', "chimera/base/y.h": '#include "chimera/base/z.h"\n',
      "chimera/base/x.cc": '#include "chimera/base/z.h"\n', "chimera/base/z.h": ""},
     "chimera/base/y.h: only tests use it: it belongs into testing/, or is dead"),
    ({"chimera/base/x_test.cc": '#include "chimera/base/x.h"\n', "chimera/base/x.h": "",
      "chimera/base/x.cc": '#include "chimera/base/x.h"\n'},
     "chimera/base/x.h: only tests use it: it belongs into testing/, or is dead"),
    (_tree("chimera/draw/x.cc", "<sys/eventfd.h>"),
     "chimera/draw/x.cc:1: includes sys/eventfd.h: only chimera/platform/ sees the operating system"),
    (_tree("library/gain/gain.cc", "<unistd.h>"),
     "library/gain/gain.cc:1: includes unistd.h: only chimera/platform/ sees the operating system"),
    (_tree("chimera/rtpu/x_test.cc", "<sys/eventfd.h>"), None),
    (_tree("chimera/platform/x.cc", "<sys/eventfd.h>"), None),
    (_tree("library/tball/x.cc", "<linux/input.h>"), None),
    (_tree("chimera/rtpu/x.cc", "<csignal>"), None),
    (_tree("chimera/runtime/x.cc", "<fmt/core.h>"),
     "chimera/runtime/x.cc:1: includes fmt/core.h: libraries like this stay above the real-time line"),
    (_tree("chimera/text/json.cc", "<nlohmann/json.hpp>"), None),
    (_tree("chimera/manager/x.cc", "<nlohmann/json.hpp>"),
     "chimera/manager/x.cc:1: includes nlohmann/json.hpp: slow to compile: include chimera/text/json.h"),
    (_tree("bench/x.cc", "<nlohmann/json_fwd.hpp>"),
     "bench/x.cc:1: includes nlohmann/json_fwd.hpp: slow to compile: include chimera/text/json.h"),
    (_tree("chimera/description/x.h", "<yaml-cpp/yaml.h>"),
     "chimera/description/x.h:1: includes yaml-cpp/yaml.h: slow to compile: include it in the one .cc that needs it"),
)

if __name__ == "__main__":
    sources.run(check, PLANTED)
