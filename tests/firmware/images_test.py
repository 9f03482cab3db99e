# SPDX-License-Identifier: Apache-2.0
"""An image runs in QEMU on the clock of the chip: its digest is that of the host, to the bit. It has no allocator, no
code before main and no symbol of a library but libgcc. usage: images_test.py BUILD_TREE IMAGE TARGET"""
import pathlib
import shutil
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools" / "firmware"))
import image as images  # noqa: E402
import sizes  # noqa: E402


def complaints(built):
    built.bake()
    built.link()
    print("\n".join(sizes.text(built.sizes())))
    yield from built.complaints()
    if built.machine() is None:
        return
    lines = built.run()
    yield from images.unpunctual(lines, built.periods())
    yield from built.differences(lines)


def main():
    tree, name, target = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2], sys.argv[3]
    for program in ("arm-none-eabi-g++", "qemu-system-arm", "ninja"):
        if shutil.which(program) is None:
            print(f"{program} is not installed")
            return 77
    built = images.Built(images.Image.read(name), target, tree, tree / "firmware")
    found = list(complaints(built))
    good = "linked; QEMU has no such machine" if built.machine() is None else "the digest is equal to that of the host"
    print("\n".join(found) or f"{name} for {target}: {good}")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
