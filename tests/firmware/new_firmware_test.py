# SPDX-License-Identifier: Apache-2.0
"""What `chimera new firmware` makes runs outside the checkout, with an installed Chimera alone, and its digest is that
of the host. Without a compiler the packages are named. usage: new_firmware_test.py BUILD_TREE"""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

EQUAL = "-- mine for board: its digest is equal to that of this machine\n"
ADVICE = ("error: arm-none-eabi-g++: not installed. On Debian or Ubuntu: sudo apt install --no-install-recommends "
          "gcc-arm-none-eabi libstdc++-arm-none-eabi-dev libnewlib-dev\n")


def run(command, folder, **environment):
    done = subprocess.run(list(map(str, command)), stdin=subprocess.DEVNULL, capture_output=True, text=True, cwd=folder,
                          env={**os.environ, "ASAN_OPTIONS": "detect_leaks=0", **environment}, check=False)
    return done.returncode, done.stdout + done.stderr


def without_compiler(place):
    """A folder for PATH with links to all programs but that compiler."""
    folder = place / "programs"
    folder.mkdir()
    for program in pathlib.Path("/usr/bin").iterdir():
        if not program.name.startswith("arm-none-eabi-"):
            (folder / program.name).symlink_to(program)
    return folder


def complaints(tree, place):
    prefix, work = place / "its prefix", place / "my work"  # a shell must read them back
    work.mkdir()
    for part in ("sdk", "documents"):
        code, said = run(["cmake", "--install", tree, "--prefix", prefix, "--component", part], place)
        if code != 0:
            yield f"cmake --install of {part}: exit {code}\n{said}"
            return
    code, said = run([prefix / "bin" / "chimera", "new", "firmware", "mine"], work)
    if (code, said[said.find("next:"):]) != (0, "next:\n  cd mine\n  ./run.sh\n"):
        yield f"chimera new firmware: exit {code}, it says\n{said}"
    script = work / "mine" / "run.sh"
    code, said = run([script], work)
    print(said)
    if code != 0 or not said.endswith(EQUAL):
        yield f"run.sh: exit {code}"
    sources = [prefix / "share" / "chimera" / part for part in ("chimera", "firmware", "tools")]
    installed = [path for folder in sources for path in folder.rglob("*")]
    strays = [str(path) for path in installed if path.suffix == ".pyc" or path.name.endswith("_test.cc")]
    if strays or not installed:
        yield f"installed, but not needed: {strays}"
    code, said = run([script], work, PATH=without_compiler(place))
    if code == 0 or not said.endswith(ADVICE):
        yield f"run.sh without a compiler: exit {code}, it says\n{said}"


def main():
    tree = pathlib.Path(sys.argv[1]).resolve()
    for program in ("arm-none-eabi-g++", "qemu-system-arm", "ninja"):
        if shutil.which(program) is None:
            print(f"{program} is not installed")
            return 77
    with tempfile.TemporaryDirectory() as place:
        found = list(complaints(tree, pathlib.Path(place)))
    print("\n".join(found) or "it builds and runs outside the checkout")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
