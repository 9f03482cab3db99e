# SPDX-License-Identifier: Apache-2.0
"""Compares the digest that an image prints with that of `chimera run --virtual --digest` (docs/formats/digest.md)."""


def of_host(text):
    """{(second, task): rest of the line}"""
    return {tuple(line.split()[:2]): line.split()[2:] for line in text.splitlines()[1:]}


def of_image(lines):
    return {tuple(line.split()[1:3]): line.split()[3:] for line in lines if line.startswith("digest ")}


def difference(host, image):
    """One sentence about the first difference; "" if the digests are equal."""
    for key in sorted(host.keys() | image.keys(), key=lambda each: (int(each[0]), each[1])):
        on_host, on_image = host.get(key), image.get(key)
        if on_host != on_image:
            return (f"second {key[0]}, task {key[1]}: the image has {' '.join(on_image or ['nothing'])}, "
                    f"the host has {' '.join(on_host or ['nothing'])}")
    return "" if host else "the host printed no digest"
