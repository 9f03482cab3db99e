# SPDX-License-Identifier: Apache-2.0
"""Draws a robot as SVG from what its file says of its joints: the same file gives the same picture.

usage: draw_robot.py FILE [--pose Q1,Q2,...] [--floor Z] [--check SVG]

FILE is a URDF file (the chain to its farthest link is drawn) or a module store of library/rmms. The pose is in degrees.
Links are drawn along the axes of their frames, joints as drums about their axes, the tool frame with x red, y green, z
blue. --check compares with a picture."""
import argparse
import math
import pathlib
import re
import sys
import xml.etree.ElementTree as xml

VIEW = (math.radians(-58), math.radians(22))  # azimuth and elevation of the eye
SIZE = 460  # px


def product(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(4)) for j in range(4)] for i in range(4)]


def place(x, y, z):
    return [[1, 0, 0, x], [0, 1, 0, y], [0, 0, 1, z], [0, 0, 0, 1]]


def turn(axis, angle):
    """About a unit vector."""
    (x, y, z), c, s = axis, math.cos(angle), math.sin(angle)
    v = 1 - c
    return [[c + x * x * v, x * y * v - z * s, x * z * v + y * s, 0],
            [y * x * v + z * s, c + y * y * v, y * z * v - x * s, 0],
            [z * x * v - y * s, z * y * v + x * s, c + z * z * v, 0], [0, 0, 0, 1]]


def origin(t):
    return [t[i][3] for i in range(3)]


def direction(t, v):
    return [sum(t[i][k] * v[k] for k in range(3)) for i in range(3)]


class Chain:
    """Steps from the base: ("go", x, y, z), ("turn", axis, angle), ("joint", axis)."""

    def __init__(self, steps):
        self.steps = steps

    @staticmethod
    def of_store(text):
        steps = []
        for line in text.split("\n"):
            words = line.split("#")[0].split()
            if not words:
                continue
            a, alpha, d, theta = (float(word) for word in words[1:5])
            steps += [("joint", (0, 0, 1)), ("turn", (0, 0, 1), math.radians(theta)), ("go", a, 0, d),
                      ("turn", (1, 0, 0), math.radians(alpha))]
        return Chain(steps)

    @staticmethod
    def of_urdf(text):
        root = xml.fromstring(text)
        to = {joint.find("child").get("link"): joint for joint in root.findall("joint")}

        def way(link):
            return way(to[link].find("parent").get("link")) + [to[link]] if link in to else []
        steps = []
        ways = [way(link.get("name")) for link in root.findall("link")]
        for joint in max(ways, key=len):
            at = joint.find("origin")
            numbers = {key: [float(n) for n in (at.get(key) if at is not None and at.get(key) else "0 0 0").split()]
                       for key in ("xyz", "rpy")}
            steps.append(("go", *numbers["xyz"]))
            for axis, angle in zip(((0, 0, 1), (0, 1, 0), (1, 0, 0)), reversed(numbers["rpy"])):
                if angle:
                    steps.append(("turn", axis, angle))
            if joint.get("type") in ("revolute", "continuous"):
                axis = joint.find("axis")
                words = (axis.get("xyz") if axis is not None else "1 0 0").split()
                steps.append(("joint", tuple(float(n) for n in words)))
        return Chain(steps)

    def walk(self, pose):
        """Links as (from, to), joints as (place, axis), and the tool frame."""
        pose, frame = list(pose), place(0, 0, 0)
        links, joints = [], []
        for kind, *step in self.steps:
            if kind == "turn":
                frame = product(frame, turn(*step))
            elif kind == "joint":
                joints.append((origin(frame), direction(frame, step[0])))
                frame = product(frame, turn(step[0], pose.pop(0) if pose else 0))
            else:
                x, y, z = step
                for part in ((0, 0, z), (x, y, 0)):
                    if any(abs(n) > 1e-9 for n in part):
                        start, frame = origin(frame), product(frame, place(*part))
                        links.append((start, origin(frame)))
        return links, joints, frame


def seen(p):
    """Right, up, and towards the eye."""
    a, e = VIEW
    x, y = p[0] * math.cos(a) - p[1] * math.sin(a), p[0] * math.sin(a) + p[1] * math.cos(a)
    return (x, p[2] * math.cos(e) + y * math.sin(e), -y * math.cos(e) + p[2] * math.sin(e))


def drum(at, axis, radius, half):
    """The two rims of a drum, as points in space."""
    side = (1, 0, 0) if abs(axis[0]) < 0.9 else (0, 1, 0)
    u = cross(axis, side)
    u = [n / math.hypot(*u) for n in u]
    v = cross(axis, u)
    rims = []
    for end in (-half, half):
        round_ = [(math.cos(k * math.pi / 12), math.sin(k * math.pi / 12)) for k in range(24)]
        rims.append([[at[i] + end * axis[i] + radius * (c * u[i] + s * v[i]) for i in range(3)] for c, s in round_])
    return rims


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def hull(points):
    points = sorted(set(points))

    def half(ps):
        found = []
        for p in ps:
            while len(found) > 1 and ((found[-1][0] - found[-2][0]) * (p[1] - found[-2][1]) -
                                      (found[-1][1] - found[-2][1]) * (p[0] - found[-2][0])) <= 0:
                found.pop()
            found.append(p)
        return found[:-1]
    return half(points) + half(points[::-1])


class Picture:
    def __init__(self):
        self.things = []  # (depth, kind, points, width in m, colour)
        self.corners = []

    def line(self, a, b, width, colour, edge="#333", lift=0.0):
        p, q = seen(a), seen(b)
        self.things.append(((p[2] + q[2]) / 2 + lift, "line", [p[:2], q[:2]], width, (colour, edge)))
        self.corners += [p[:2], q[:2]]

    def area(self, points, depth, colour, edge):
        self.things.append((depth, "area", [p[:2] for p in points], 0, (colour, edge)))
        self.corners += [p[:2] for p in points]

    def drum(self, at, axis, radius, half):
        rims = [[seen(p) for p in rim] for rim in drum(at, axis, radius, half)]
        near = max(rims, key=lambda rim: sum(p[2] for p in rim))
        depth = seen(at)[2] + radius
        self.area(hull([p[:2] for rim in rims for p in rim]), depth, "#d97b29", "#5c2f08")
        self.area(near, depth + 1e-6, "#f0a860", "#5c2f08")

    def svg(self, title):
        margin = 0.12
        left, right = min(p[0] for p in self.corners) - margin, max(p[0] for p in self.corners) + margin
        low, high = min(p[1] for p in self.corners) - margin, max(p[1] for p in self.corners) + margin
        scale = SIZE / max(right - left, high - low)

        def at(p):
            return f"{(p[0] - left) * scale:.1f},{(high - p[1]) * scale:.1f}"
        width, height = math.ceil((right - left) * scale), math.ceil((high - low) * scale)
        size = f'viewBox="0 0 {width} {height}" width="{width}" height="{height}"'
        out = [f'<svg xmlns="http://www.w3.org/2000/svg" {size}>', f"<title>{title}</title>",
               f'<rect width="{width}" height="{height}" fill="#ffffff"/>']
        for _, kind, points, thick, (colour, edge) in sorted(self.things, key=lambda thing: thing[0]):
            path = " ".join(at(p) for p in points)
            if kind == "area":
                out.append(f'<polygon points="{path}" fill="{colour}" stroke="{edge}" stroke-width="1"/>')
                continue
            px = max(thick * scale, 1.0)
            if edge and px > 3:
                out.append(stroke(path, edge, px + 2))
            out.append(stroke(path, colour, px))
        return "\n".join(out + ["</svg>"]) + "\n"


def stroke(path, colour, px):
    return f'<polyline points="{path}" stroke="{colour}" stroke-width="{px:.1f}" stroke-linecap="round"/>'


def draw(chain, pose, floor, title):
    links, joints, tool = chain.walk(pose)
    reach = sum(math.dist(a, b) for a, b in links) - floor
    picture = Picture()
    step, n = 0.25, 3
    for i in range(-n, n + 1):
        for a, b in (((i * step, -n * step, floor), (i * step, n * step, floor)),
                     ((-n * step, i * step, floor), (n * step, i * step, floor))):
            picture.line(a, b, 0, "#d5dbe3", None, -100)
    if floor < 0:
        picture.line((0, 0, floor), (0, 0, -0.04 * reach), 0.10 * reach, "#8d99a8")
    for i, (a, b) in enumerate(links):
        picture.line(a, b, (0.055 - 0.025 * i / max(1, len(links) - 1)) * reach, "#c3ccd8")
    last = None
    for i, (at, axis) in enumerate(joints):
        small = 1 - 0.45 * i / max(1, len(joints) - 1)
        again = last is not None and math.dist(last, at) < 1e-6
        radius, half = (0.8, 1.1) if again else (1, 1)
        picture.drum(at, axis, 0.036 * reach * small * radius, 0.05 * reach * small * half)
        last = at
    for axis, colour in (((1, 0, 0), "#d62728"), ((0, 1, 0), "#2ca02c"), ((0, 0, 1), "#1f5fd0")):
        start = origin(tool)
        end = [start[k] + 0.09 * reach * direction(tool, axis)[k] for k in range(3)]
        picture.line(start, end, 0.008 * reach, colour, None, 1)
    return picture.svg(title)


def read(path):
    text = path.read_text()
    return Chain.of_urdf(text) if re.search(r"<robot\b", text) else Chain.of_store(text)


def self_test():
    """One link that turns up, by either form; and a drawing is the same twice."""
    table = Chain.of_store("m 1 0 0.5 0 9 -90 90 5  # a metre out, half up\n")
    _, joints, tool = table.walk([math.pi / 2])
    assert len(joints) == 1 and all(abs(a - b) < 1e-12 for a, b in zip(origin(tool), (0, 1, 0.5)))
    urdf = Chain.of_urdf("""<robot name="r"><link name="a"/><link name="b"/><link name="c"/>
        <joint name="j" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint>
        <joint name="k" type="fixed"><parent link="b"/><child link="c"/><origin xyz="1 0 0.5"/></joint></robot>""")
    assert all(abs(a - b) < 1e-12 for a, b in zip(origin(urdf.walk([math.pi / 2])[2]), (0, 1, 0.5)))
    assert draw(table, [0.3], -0.2, "t") == draw(table, [0.3], -0.2, "t") != draw(table, [0.4], -0.2, "t")


def main():
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("file", type=pathlib.Path)
    words.add_argument("--pose", default="")
    words.add_argument("--floor", type=float, default=0.0)
    words.add_argument("--check", type=pathlib.Path)
    said = words.parse_args()
    self_test()
    pose = [math.radians(float(word)) for word in said.pose.split(",") if word]
    picture = draw(read(said.file), pose, said.floor, said.file.stem)
    if said.check is None:
        sys.stdout.write(picture)
        return 0
    if said.check.is_file() and said.check.read_text() == picture:
        return 0
    print(f"{said.check} is not what {said.file} looks like: draw it again")
    return 1


if __name__ == "__main__":
    sys.exit(main())
