# SPDX-License-Identifier: Apache-2.0
"""An image runs in QEMU on the clock of the chip: its digest is that of the host, to the bit. It has no allocator, no
code before main and no symbol of a library but libgcc. usage: images_test.py BUILD_TREE IMAGE TARGET"""
import json
import pathlib
import shutil
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools" / "firmware"))
import image as images  # noqa: E402
import recorded_profile  # noqa: E402
import sizes  # noqa: E402


def complaints_about_profile(built, lines):
    """With the profile of its own run an image is baked; with times of a processor that is far slower it is refused."""
    profile = recorded_profile.of_image(lines, built.out / "baked")
    path = built.out / "profile.json"
    path.write_text(json.dumps(profile))
    try:
        built.bake("--profile", path, out="baked_by_profile")
    except images.ImageError as error:
        yield f"with its own profile: {error}"
    for task in profile["tasks"]:
        task["worst_ns"] = 2 * max(built.periods())
        task["mean_ns"] = min(task["mean_ns"], task["worst_ns"])
    path.write_text(json.dumps(profile))
    try:
        built.bake("--profile", path, out="baked_by_profile")
        yield "with a profile of far longer times it is baked, too"
    except images.ImageError as error:
        for words in ("by the profile the tasks take ", "by the profile task '", "is not guaranteed", "at most 0."):
            if words not in str(error):
                yield f"the refusal does not say '{words}': {error}"


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
    yield from complaints_about_profile(built, lines)


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
