# SPDX-License-Identifier: Apache-2.0
"""./dev firmware: bakes, links and runs images for microcontrollers, and compares them with the host."""
import argparse
import json
import os
import pathlib
import sys

import common

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "firmware"))
import build  # noqa: E402
import image as images  # noqa: E402
import qemu  # noqa: E402
import recorded_profile  # noqa: E402
import sizes  # noqa: E402

OUT = common.BUILD / "firmware"


def parse_arguments():
    parser = argparse.ArgumentParser(
        prog="./dev firmware", formatter_class=argparse.RawDescriptionHelpFormatter,
        description="Bakes an application, compiles and links it for its targets, prints the size of its parts, runs\n"
                    "it in QEMU, and compares its digest with `chimera run --virtual --digest` of this machine.\n"
                    "Exit 0 only if the digests are equal.",
        epilog="images: " + ", ".join(images.names()) + "   (firmware/images/NAME/image.yaml)\n"
               "result: build/firmware/NAME.TARGET/image.elf, and beside it image.elf.map, output.txt, host.digest\n"
               "example: ./dev firmware servo --target stm32vldiscovery --detail")
    parser.add_argument("name", nargs="*", metavar="NAME", help="images; left out: all")
    parser.add_argument("--target", metavar="T", help="one target, also one that the image does not list")
    parser.add_argument("--no-run", action="store_true", help="link only")
    parser.add_argument("--detail", action="store_true", help="sizes of each file")
    parser.add_argument("--profile", metavar="FILE", help="write the times of the tasks, for `chimera bake --profile`")
    parser.add_argument("--tree", choices=("debug", "release"), default="debug", help="of the program (default debug)")
    return parser.parse_args()


def host_is_ready(image, tree):
    targets = ["chimera", *(f"component_{name}_files" for name in image.components())]
    return common.configure_with_tests(tree) and common.compile_tree(tree, *targets)


def show(image, target, arguments):
    """True if the image was linked and, where QEMU has the machine, its digest is that of the host."""
    built = images.Built(image, target, common.BUILD / arguments.tree, OUT)
    common.step(f"{image.name} for {target}: bake, compile, link")
    built.bake()
    built.link()
    print("\n".join(sizes.text(built.sizes(), arguments.detail)))
    complaints = built.complaints()
    if complaints:
        print("\n".join(complaints))
        return False
    if arguments.no_run or built.machine() is None:
        common.step(f"{image.name} for {target}: linked" + ("" if arguments.no_run else "; QEMU has no such machine"))
        return True
    common.step(f"{image.name} for {target}: run for {image.duration} in QEMU and on this machine")
    lines = built.run()
    print("\n".join(f"   {line}" for line in lines if not line.startswith("digest ")))
    if arguments.profile:
        profile = recorded_profile.of_image(lines, built.out / "baked")
        pathlib.Path(arguments.profile).write_text(json.dumps(profile, indent=2) + "\n")
        common.step(f"{image.name} for {target}: its profile is in {arguments.profile}")
    print("".join(f"   {line}\n" for line in images.unpunctual(lines, built.periods())), end="")
    found = built.difference(lines)
    common.step(f"{image.name} for {target}: " + (found or "its digest is equal to that of this machine"))
    return not found


def main():
    arguments = parse_arguments()
    os.environ.setdefault("LC_ALL", "C")
    good = True
    try:
        for name in arguments.name or images.names():
            image = images.Image.read(name)
            if not host_is_ready(image, arguments.tree):
                return 1
            for target in [arguments.target] if arguments.target else image.targets:
                good = show(image, target, arguments) and good
    except (images.ImageError, build.BuildError, qemu.QemuError) as error:
        print(f"./dev firmware: {error}", file=sys.stderr)
        return 1
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
