# SPDX-License-Identifier: Apache-2.0
"""./dev firmware: bakes, links and runs images for microcontrollers, and compares them with the host."""
import argparse
import os
import pathlib
import sys

import common

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "firmware"))
import image as images  # noqa: E402
import make  # noqa: E402

OUT = common.BUILD / "firmware"


def parse_arguments():
    parser = argparse.ArgumentParser(
        prog="./dev firmware", formatter_class=argparse.RawDescriptionHelpFormatter,
        description="Bakes an application, compiles and links it for its targets, prints the size of its parts, runs\n"
                    "it in QEMU, and compares its digest with `chimera run --virtual --digest` of this machine.\n"
                    "Exit 0 only if the digests are equal.",
        epilog="images: " + ", ".join(images.names()) + "   (firmware/images/NAME/image.yaml)\n"
               "result: build/firmware/NAME.TARGET/image.elf, and beside it image.elf.map, output.txt, host.digest\n"
               "example: ./dev firmware servo --target fictive-m0plus --detail")
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
                good = make.make(image, target, common.BUILD / arguments.tree, OUT, not arguments.no_run,
                                 arguments.detail, arguments.profile) and good
    except make.ERRORS as error:
        print(f"./dev firmware: {error}", file=sys.stderr)
        return 1
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
