#!/usr/bin/env python3
"""Usage: pictures.py FOLDER [RESULTS]

Draws the site's pictures into FOLDER as SVG: concepts, computed from small scenes, and results, from the
rows of RESULTS (bench/results/results.json). Without RESULTS it draws only contacts.svg, which README.md shows and
which is therefore committed, in bench/site/pages.
"""

import html
import json
import math
import pathlib
import random
import re
import sys

# Distinguishable with any colour vision (Okabe and Ito, "Color Universal Design", 2008).
BLUE, SKY, ORANGE, GREEN, GREY, INK, PALE = (
    "#0072b2", "#56b4e9", "#d55e00", "#009e73", "#8a94a0", "#1c2430", "#eef2f6")


class Picture:
    def __init__(self, width, height, title):
        self.size = (width, height)
        self.parts = [f"<title>{html.escape(title)}</title>",
                      f'<rect width="{width}" height="{height}" fill="#fff"/>']

    def box(self, x, y, w, h, fill="none", stroke="none", width=1.5, extra=""):
        self.parts.append(f'<rect x="{x:.1f}" y="{y:.1f}" width="{w:.1f}" height="{h:.1f}" '
                          f'fill="{fill}" stroke="{stroke}" stroke-width="{width}" {extra}/>')

    def line(self, x0, y0, x1, y1, stroke=GREY, width=1.5, extra=""):
        self.parts.append(f'<line x1="{x0:.1f}" y1="{y0:.1f}" x2="{x1:.1f}" y2="{y1:.1f}" '
                          f'stroke="{stroke}" stroke-width="{width}" {extra}/>')

    def circle(self, x, y, r, fill="none", stroke="none"):
        self.parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{r:.1f}" fill="{fill}" '
                          f'stroke="{stroke}" stroke-width="1.5"/>')

    def text(self, x, y, words, size=16, fill=INK, anchor="start", weight=400):
        self.parts.append(f'<text x="{x:.1f}" y="{y:.1f}" font-size="{size}" fill="{fill}" '
                          f'text-anchor="{anchor}" font-weight="{weight}">{html.escape(words)}</text>')

    def arrow(self, x0, y0, x1, y1, stroke=INK):
        self.line(x0, y0, x1, y1, stroke, 2)
        angle = math.atan2(y1 - y0, x1 - x0)
        points = " ".join(f"{x1 - 9 * math.cos(angle + turn):.1f},{y1 - 9 * math.sin(angle + turn):.1f}"
                          for turn in (-0.45, 0.45))
        self.parts.append(f'<polygon points="{x1:.1f},{y1:.1f} {points}" fill="{stroke}"/>')

    def write(self, path):
        path.write_text(
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {self.size[0]} {self.size[1]}" '
            'font-family="system-ui, sans-serif">\n' + "\n".join(self.parts) + "\n</svg>\n")


def scattered(count, width, height, seed=5):
    """Returns boxes (x, y, w, h) of different sizes, some of which overlap."""
    draw = random.Random(seed)
    boxes = []
    for _ in range(count):
        w, h = draw.uniform(14, 44), draw.uniform(14, 44)
        boxes.append((draw.uniform(8, width - w - 8), draw.uniform(8, height - h - 8), w, h))
    return boxes


def overlap(a, b):
    return (a[0] <= b[0] + b[2] and b[0] <= a[0] + a[2] and
            a[1] <= b[1] + b[3] and b[1] <= a[1] + a[3])


def around(boxes):
    x, y = min(b[0] for b in boxes), min(b[1] for b in boxes)
    return (x, y, max(b[0] + b[2] for b in boxes) - x, max(b[1] + b[3] for b in boxes) - y)


def tree_nodes(boxes, leaf=5):
    """Yields depth and bounds of the nodes of a tree built by median splits, from the root."""
    nodes = [(0, boxes)]
    while nodes:
        depth, inside = nodes.pop()
        yield depth, around(inside)
        if len(inside) <= leaf:
            continue
        _, _, w, h = around(inside)
        axis = 0 if w > h else 1
        order = sorted(inside, key=lambda b: b[axis] + b[axis + 2] / 2)
        half = len(order) // 2
        nodes += [(depth + 1, order[:half]), (depth + 1, order[half:])]


def draw_boxes(picture, boxes, dx=0, dy=0):
    overlapping = {i for i, a in enumerate(boxes) for j, b in enumerate(boxes) if i != j and overlap(a, b)}
    for i, (x, y, w, h) in enumerate(boxes):
        hot = i in overlapping
        picture.box(x + dx, y + dy, w, h, "#fbe3d3" if hot else PALE, ORANGE if hot else GREY)


def partition(folder):
    picture = Picture(760, 380, "Boxes, pairs and the nodes of a tree")
    boxes = scattered(46, 760, 380)
    for depth, (x, y, w, h) in tree_nodes(boxes):
        grow = 6 - 1.5 * depth
        picture.box(x - grow, y - grow, w + 2 * grow, h + 2 * grow, "none",
                    (INK, BLUE, SKY, GREEN)[min(depth, 3)], 2.4 - 0.4 * min(depth, 3),
                    'rx="3"' + (' stroke-dasharray="5 4"' if depth > 2 else ""))
    draw_boxes(picture, boxes)
    picture.write(folder / "partition.svg")


def structures(folder):
    picture = Picture(760, 560, "Four structures over the same boxes")
    boxes = scattered(24, 350, 220, 11)
    places = ((16, 34, "sweep: strips"), (394, 34, "grid: cells"),
              (16, 314, "grids by size"), (394, 314, "tree"))
    for k, (dx, dy, name) in enumerate(places):
        picture.text(dx, dy - 10, name, 16, weight=600)
        picture.box(dx, dy, 350, 220, "none", "#dde3ea")
        if k == 0:
            for i in range(1, 5):
                picture.line(dx, dy + 44 * i, dx + 350, dy + 44 * i, SKY)
        elif k == 1:
            for i in range(1, 7):
                picture.line(dx + 50 * i, dy, dx + 50 * i, dy + 220, SKY)
            for i in range(1, 5):
                picture.line(dx, dy + 44 * i, dx + 350, dy + 44 * i, SKY)
        elif k == 2:
            for i in range(1, 14):
                picture.line(dx + 25 * i, dy, dx + 25 * i, dy + 220, "#cfe6f5", 1)
            for i in range(1, 9):
                picture.line(dx, dy + 24.4 * i, dx + 350, dy + 24.4 * i, "#cfe6f5", 1)
            for i in range(1, 5):
                picture.line(dx + 70 * i, dy, dx + 70 * i, dy + 220, BLUE)
            for i in range(1, 3):
                picture.line(dx, dy + 73.3 * i, dx + 350, dy + 73.3 * i, BLUE)
        else:
            for depth, (x, y, w, h) in tree_nodes(boxes, 4):
                picture.box(x + dx - 2, y + dy - 2, w + 4, h + 4, "none", (INK, BLUE, SKY)[min(depth, 2)])
        draw_boxes(picture, boxes, dx, dy)
    picture.write(folder / "structures.svg")


def steps(picture, y, names, below):
    """Draws a row of boxes with arrows between them, and text below each."""
    count = len(names)
    width = (picture.size[0] - 20 - 34 * (count - 1)) / count
    for i, name in enumerate(names):
        x = 10 + i * (width + 34)
        picture.box(x, y, width, 56, "#e6f0fa", BLUE, 1.5, 'rx="6"')
        picture.text(x + width / 2, y + 34, name, 16, INK, "middle", 600)
        for k, words in enumerate(below[i]):
            picture.text(x + width / 2, y + 82 + 20 * k, words, 14, "#5b6675", "middle")
        if i + 1 < count:
            picture.arrow(x + width + 4, y + 28, x + width + 30, y + 28)


def phases(folder):
    picture = Picture(760, 170, "Broad, mid and narrow phase")
    steps(picture, 16, ["poses", "boxes", "pairs", "parts", "contacts"],
          [["bodies move"], ["rounded outward,", "partitions follow"], ["broad phase:", "boxes that overlap"],
           ["mid phase:", "triangles, children"], ["narrow phase:", "points, depths,", "bounds of errors"]])
    picture.write(folder / "phases.svg")


def tiers(folder):
    picture = Picture(760, 170, "What tier robust does with a pair")
    steps(picture, 16, ["lanes", "certify", "solver", "exact"],
          [["sixteen pairs at once,", "in float"], ["in double:", "is the bound small", "enough?"],
           ["one pair at a time,", "in double"], ["integers settle", "the sign"]])
    picture.write(folder / "tiers.svg")


def bounds(folder):
    picture = Picture(860, 190, "Intervals around distances")
    for y, at, bound, verdict, colour in ((50, 480, 90, "apart, for certain", GREEN),
                                          (100, 330, 90, "not certain: the next step decides", ORANGE),
                                          (150, 130, 70, "overlapping, for certain", BLUE)):
        picture.line(at - bound, y, at + bound, y, colour, 8, 'stroke-linecap="round"')
        picture.circle(at, y, 7, INK)
        picture.text(596, y + 5, verdict, 15)
    picture.line(300, 20, 300, 172, INK, 1.5, 'stroke-dasharray="4 4"')
    picture.text(300, 14, "distance 0", 14, "#5b6675", "middle")
    picture.write(folder / "bounds.svg")


def far(folder):
    picture = Picture(760, 210, "The spacing of floats")
    for y, step, words in ((70, 9, "near 0: floats lie close"), (170, 90, "far away: 8 apart at 1e8")):
        picture.text(10, y - 40, words, 15, weight=600)
        picture.line(10, y, 750, y, INK)
        for i in range(int(740 / step) + 1):
            picture.line(10 + i * step, y - 6, 10 + i * step, y + 6, GREY, 1)
        low, high = 312, 398
        down, up = 10 + math.floor((low - 10) / step) * step, 10 + math.ceil((high - 10) / step) * step
        picture.box(down, y - 20, up - down, 16, "#fbe3d3", ORANGE)
        picture.box(low, y - 18, high - low, 12, BLUE)
    picture.box(480, 24, 14, 12, BLUE)
    picture.text(500, 35, "the box", 14)
    picture.box(580, 24, 14, 12, "#fbe3d3", ORANGE)
    picture.text(600, 35, "rounded outward", 14)
    picture.write(folder / "far.svg")


def nearest_on_segment(x, y, a, b):
    """Returns the point of the segment from a to b that is closest to (x, y)."""
    dx, dy = b[0] - a[0], b[1] - a[1]
    t = ((x - a[0]) * dx + (y - a[1]) * dy) / (dx * dx + dy * dy)
    t = min(max(t, 0), 1)
    return (a[0] + t * dx, a[1] + t * dy)


GROUND = [(10, 20), (90, 150), (190, 210), (300, 222), (390, 180), (440, 180), (660, 180), (750, 80)]
BOXES = [(470, 120, 150, 60), (500, 60, 110, 60)]  # x, y, width, height; the second rests on the first


def obstacle_points(x, y):
    """Yields the points of the ground and of the boxes that are closest to (x, y)."""
    for a, b in zip(GROUND, GROUND[1:]):
        yield nearest_on_segment(x, y, a, b)
    for bx, by, w, h in BOXES:
        yield (min(max(x, bx), bx + w), min(max(y, by), by + h))


def settled_discs(radii, seed=7):
    """Returns discs (x, y, radius) that fell onto the ground and the boxes, by position-based dynamics."""
    draw = random.Random(seed)
    discs = [[draw.uniform(120, 600), draw.uniform(-260, 20), r] for r in radii]
    for step in range(1500):
        for disc in discs:
            disc[1] += 1.2 if step < 1200 else 0.02
        for _ in range(6):
            for i, one in enumerate(discs):
                for other in discs[:i]:
                    dx, dy = one[0] - other[0], one[1] - other[1]
                    length = math.hypot(dx, dy)
                    depth = one[2] + other[2] - length
                    if depth > 0:
                        for disc, sign in ((one, 0.5), (other, -0.5)):
                            disc[0] += sign * depth * dx / length
                            disc[1] += sign * depth * dy / length
                for px, py in obstacle_points(one[0], one[1]):
                    dx, dy = one[0] - px, one[1] - py
                    length = math.hypot(dx, dy)
                    if 0 < length < one[2]:
                        one[0] += (one[2] - length) * dx / length
                        one[1] += (one[2] - length) * dy / length
    return discs


def disc_contacts(discs, margin=0.8):
    """Yields contacts (x, y, normal x, normal y) of discs with each other, the ground and the boxes."""
    for i, (x, y, r) in enumerate(discs):
        others = [(ox, oy, o) for ox, oy, o in discs[:i]] + [(*p, 0) for p in obstacle_points(x, y)]
        seen = []
        for ox, oy, o in others:
            length = math.hypot(x - ox, y - oy)
            if length > r + o + margin:
                continue
            nx, ny = (x - ox) / length, (y - oy) / length
            at = (ox + o * nx, oy + o * ny)
            if all(math.hypot(at[0] - sx, at[1] - sy) > 3 for sx, sy in seen):
                seen.append(at)
                yield (*at, nx, ny)


def box_contacts():
    """Yields the two ends of each edge that a box rests on."""
    for x, y, width, height in BOXES:
        yield from ((corner, y + height, 0, -1) for corner in (x, x + width))


def contacts(folder):
    picture = Picture(760, 262, "Bodies on a terrain, with their contact points and normals")
    ground = " ".join(f"{x},{y}" for x, y in [(10, 238), *GROUND, (750, 238)])
    picture.parts.append(f'<polygon points="{ground}" fill="#e9edf1" stroke="{GREY}" stroke-width="1.5"/>')
    for x, y, w, h in BOXES:
        picture.box(x, y, w, h, "#e6f0fa", BLUE, 1.5)
    discs = settled_discs((30, 24, 34, 20, 27, 22, 18, 25, 16, 21, 19, 28))
    for x, y, r in discs:
        picture.circle(x, y, r, "#e6f0fa", BLUE)
    for x, y, nx, ny in (*disc_contacts(discs), *box_contacts()):
        picture.arrow(x, y, x + 20 * nx, y + 20 * ny, ORANGE)
        picture.circle(x, y, 4, ORANGE, "#fff")
    picture.circle(18, 252, 4, ORANGE, "none")
    picture.text(28, 256, "contact point", 13)
    picture.arrow(126, 252, 146, 252, ORANGE)
    picture.text(152, 256, "contact normal", 13)
    picture.write(folder / "contacts.svg")


def times(results, name):
    """Returns the times of the rows whose names match, by the match's group."""
    found = {}
    for row in json.loads(results.read_text())["benchmarks"]:
        match = re.fullmatch(name, row["name"])
        if match:
            found[match[1]] = min(row["real_time"], found.get(match[1], math.inf))
    return found


def three_digits(value):
    """Formats a value with three significant digits: 2217.3 as 2,220."""
    digits = max(0, 2 - math.floor(math.log10(value)))
    return f"{round(value, 2 - math.floor(math.log10(value))):,.{digits}f}"


def bars(path, title, groups, unit):
    """Draws groups of bars [(name, [(label, value, is winnow)])] on a logarithmic axis."""
    height = 46 + sum(34 + 22 * len(rows) for _, rows in groups)
    picture = Picture(760, height, title)
    values = [value for _, rows in groups for _, value, _ in rows]
    low, high = math.floor(math.log10(min(values))), math.ceil(math.log10(max(values)))
    left, right = 150, 690

    def at(value):
        return left + (math.log10(value) - low) / (high - low) * (right - left)

    for power in range(low, high + 1):
        x = at(10.0**power)
        picture.line(x, 30, x, height - 8, "#dde3ea", 1)
        picture.text(x, 22, f"{10**power:,} {unit}", 13, "#5b6675", "middle")
    y = 44
    for name, rows in groups:
        picture.text(10, y + 14, name, 16, weight=600)
        y += 24
        for label, value, ours in rows:
            picture.text(left - 8, y + 13, label, 14, INK if ours else "#5b6675", "end", 600 if ours else 400)
            picture.box(left, y + 2, max(at(value) - left, 2), 15, BLUE if ours else "#b6bec8")
            picture.text(at(value) + 6, y + 14, three_digits(value), 13, INK)
            y += 22
        y += 10
    picture.write(path)


def frames(folder, results):
    others = ("embree", "fcl_tree", "cgal_boxes", "bullet_dbvt")
    skipped = (*others, "yardstick", "ode_sap", "bullet_sweep", "n_squared", "bounds_n_squared")
    groups = []
    for scene in ("uniform", "mixed", "clustered", "pile"):
        found = times(results, rf"throughput/{scene}/objects:100000/threads:2/(\w+)/isa:\w+")
        best = min(time for name, time in found.items() if name not in skipped)
        listed = [("winnow", best, True)]
        listed += [(name.replace("_", " "), found[name], False) for name in others if name in found]
        groups.append((scene, listed))
    bars(folder / "frames.svg", "Time of a frame by scene", groups, "ms")


def shapes(folder, results):
    groups = []
    for kind in ("sphere-box", "capsule-capsule", "box-box", "triangle-triangle", "hull16-hull16"):
        robust = times(results, rf"pair/{kind}/distance/(isa:\w+)")
        others = times(results, rf"pair/{kind}/distance/((?:bullet|fcl)\w*)")
        listed = [("winnow robust", min(robust.values()), True)]
        listed += [(name.replace("_", " "), time, False) for name, time in others.items()]
        groups.append((kind, listed))
    bars(folder / "shapes.svg", "Time of a pair by kind", groups, "ns")


def main():
    folder = pathlib.Path(sys.argv[1])
    if len(sys.argv) == 2:
        contacts(folder)
        return
    results = pathlib.Path(sys.argv[2])
    for draw in (partition, structures, phases, tiers, bounds, far):
        draw(folder)
    for draw in (frames, shapes):
        draw(folder, results)


if __name__ == "__main__":
    main()
