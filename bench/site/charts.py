#!/usr/bin/env python3
"""Usage: charts.py FOLDER RESULTS

Draws the bar charts of the site into FOLDER as SVG, from the rows of RESULTS (bench/results/results.json).
Pictures of concepts are in bench/site/pages.
"""

import html
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "results"))
from rows import Rows, short  # noqa: E402

# Distinguishable with any colour vision (Okabe and Ito, "Color Universal Design", 2008).
BLUE, GREY, DARK_GREY, INK = ("#0072b2", "#b6bec8", "#5b6675", "#1c2430")


class Picture:
    def __init__(self, width, height, title):
        self.size = (width, height)
        self.parts = [f"<title>{html.escape(title)}</title>", f'<rect width="{width}" height="{height}" fill="#fff"/>']

    def box(self, x, y, w, h, fill):
        self.parts.append(f'<rect x="{x:.1f}" y="{y:.1f}" width="{w:.1f}" height="{h:.1f}" fill="{fill}"/>')

    def text(self, x, y, words, size=16, fill=INK, anchor="start", weight=400):
        self.parts.append(f'<text x="{x:.1f}" y="{y:.1f}" font-size="{size}" fill="{fill}" '
                          f'text-anchor="{anchor}" font-weight="{weight}">{html.escape(words)}</text>')

    def write(self, path):
        path.write_text(
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {self.size[0]} {self.size[1]}" '
            'font-family="system-ui, sans-serif">\n' + "\n".join(self.parts) + "\n</svg>\n")


def times(rows, pattern):
    """Returns the least time of the matching rows by the group `engine`."""
    found = {}
    for groups, time in rows.found(pattern, "real_time", only_right=False):
        found[groups["engine"]] = min(time, found.get(groups["engine"], math.inf))
    return found


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
        picture.box(x - 0.5, 30, 1, height - 38, "#dde3ea")
        picture.text(x, 22, f"{10**power:,} {unit}", 13, DARK_GREY, "middle")
    y = 44
    for name, rows in groups:
        picture.text(10, y + 14, name, 16, weight=600)
        y += 24
        for label, value, ours in rows:
            picture.text(left - 8, y + 13, label, 14, INK if ours else DARK_GREY, "end", 600 if ours else 400)
            picture.box(left, y + 2, max(at(value) - left, 2), 15, BLUE if ours else GREY)
            picture.text(at(value) + 6, y + 14, short(value), 13, INK)
            y += 22
        y += 10
    picture.write(path)


def frames(folder, rows):
    others = ("embree", "fcl_tree", "cgal_boxes", "bullet_dbvt")
    skipped = (*others, "yardstick", "ode_sap", "bullet_sweep", "n_squared", "bounds_n_squared")
    groups = []
    for scene in ("uniform", "mixed", "clustered", "pile"):
        found = times(rows, rf"throughput/{scene}/objects:100000/threads:2/(?P<engine>\w+)/isa:\w+")
        best = min(time for name, time in found.items() if name not in skipped)
        listed = [("winnow", best, True)]
        listed += [(name.replace("_", " "), found[name], False) for name in others if name in found]
        groups.append((scene, listed))
    bars(folder / "frames.svg", "Time of a frame by scene", groups, "ms")


def shapes(folder, rows):
    groups = []
    for kind in ("sphere-box", "capsule-capsule", "box-box", "triangle-triangle", "hull16-hull16"):
        robust = times(rows, rf"pair/{kind}/distance/(?P<engine>isa:\w+)")
        others = times(rows, rf"pair/{kind}/distance/(?P<engine>(?:bullet|fcl)\w*)")
        listed = [("winnow robust", min(robust.values()), True)]
        listed += [(name.replace("_", " "), time, False) for name, time in others.items()]
        groups.append((kind, listed))
    bars(folder / "shapes.svg", "Time of a pair by kind", groups, "ns")


def main():
    folder, rows = pathlib.Path(sys.argv[1]), Rows(sys.argv[2])
    frames(folder, rows)
    shapes(folder, rows)


if __name__ == "__main__":
    main()
