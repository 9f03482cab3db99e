# SPDX-License-Identifier: Apache-2.0
"""Compares the digest that an image prints with that of `chimera run --virtual --digest` (docs/formats/digest.md)."""


def of_host(text):
    """{(second, task): rest of the line}"""
    return {tuple(line.split()[:2]): line.split()[2:] for line in text.splitlines()[1:]}


def of_image(lines):
    return {tuple(line.split()[1:3]): line.split()[3:] for line in lines if line.startswith("digest ")}


def unequal(found, pairs):
    """Sentences about tasks that should have the same lines."""
    for one, other in pairs:
        lines = [{key[0]: line for key, line in found.items() if key[1] == task} for task in (one, other)]
        seconds = [key for key in lines[0].keys() | lines[1].keys() if lines[0].get(key) != lines[1].get(key)]
        if seconds or not lines[0]:
            yield f"tasks {one} and {other}: " + (f"second {min(seconds, key=int)} differs" if seconds else "no lines")


def difference(host, image):
    """One sentence about the first difference; "" if the digests are equal."""
    for key in sorted(host.keys() | image.keys(), key=lambda each: (int(each[0]), each[1])):
        on_host, on_image = host.get(key), image.get(key)
        if on_host != on_image:
            return (f"second {key[0]}, task {key[1]}: the image has {' '.join(on_image or ['nothing'])}, "
                    f"the host has {' '.join(on_host or ['nothing'])}")
    return "" if host else "the host printed no digest"
