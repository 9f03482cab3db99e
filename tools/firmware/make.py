# SPDX-License-Identifier: Apache-2.0
"""Bakes, compiles and links an image for its targets, prints the size of its parts, runs it in QEMU, and compares its
digest with that of this machine. Exit 0 only if the digests are equal."""
import argparse
import json
import pathlib
import sys

sys.dont_write_bytecode = True  # it may lie in a folder of the system
import build  # noqa: E402
try:
    import image as images  # noqa: E402
except ModuleNotFoundError as lack:
    sys.exit(f"error: {lack}. On Debian or Ubuntu: sudo apt install python3-yaml")
import qemu  # noqa: E402
import recorded_profile  # noqa: E402
import sizes  # noqa: E402

ERRORS = (images.ImageError, build.BuildError, qemu.QemuError)


def step(words):
    print(f"-- {words}", flush=True)


def make(image, target, tree, out, runs=True, detail=False, profile=None):
    """True if the image was linked and, where QEMU has the machine, its digest is that of this machine. The times of
    its tasks go to the file `profile`. One of ERRORS is raised if that cannot be found out."""
    built = images.Built(image, target, tree, out)
    step(f"{image.name} for {target}: bake, compile, link")
    built.bake()
    built.link()
    print("\n".join(sizes.text(built.sizes(), detail)))
    complaints = built.complaints()
    if complaints:
        print("\n".join(complaints))
        return False
    if not runs or built.machine() is None:
        step(f"{image.name} for {target}: linked {built.elf}" + ("; QEMU has no such machine" if runs else ""))
        return True
    step(f"{image.name} for {target}: run for {image.duration} in QEMU and on this machine")
    lines = built.run()
    print("\n".join(f"   {line}" for line in lines if not line.startswith("digest ")))
    if profile:
        times = recorded_profile.of_image(lines, built.out / "baked")
        pathlib.Path(profile).write_text(json.dumps(times, indent=2) + "\n")
        step(f"{image.name} for {target}: its profile is in {profile}")
    print("".join(f"   {line}\n" for line in images.unpunctual(lines, built.periods())), end="")
    found = built.differences(lines)
    step(f"{image.name} for {target}: " + ("; ".join(found) or "its digest is equal to that of this machine"))
    return not found


def main():
    parser = argparse.ArgumentParser(prog="make.py", description=__doc__)
    parser.add_argument("file", type=pathlib.Path, metavar="IMAGE.yaml")
    parser.add_argument("--program", type=pathlib.Path, required=True, help="chimera, installed or of a build tree")
    parser.add_argument("--out", type=pathlib.Path, required=True, metavar="FOLDER")
    parser.add_argument("--no-run", action="store_true", help="link only")
    parser.add_argument("--detail", action="store_true", help="sizes of each file")
    parser.add_argument("--profile", metavar="FILE", help="write the times of the tasks, for `chimera bake --profile`")
    arguments = parser.parse_args()
    tree = arguments.program.resolve().parent.parent
    try:
        image = images.Image.of_file(arguments.file)
        made = [make(image, target, tree, arguments.out, not arguments.no_run, arguments.detail,
                     arguments.profile)
                for target in image.targets]
    except ERRORS as error:
        sys.exit(f"error: {error}")
    return 0 if all(made) else 1


if __name__ == "__main__":
    sys.exit(main())
