#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""make charts: the paper's Figures 10 and 11, from what table1.sh wrote, and their data.

chart_paper.py BENCH_DIR OUT_DIR   reads table1.csv, figure10.csv and crossings.csv; without them the charts stay
"""
import math
import os
import shutil
import sys

from chart import Axis, Doublings, draw, read, write

# What is drawn of a method: its column, name, colour and dash; of one without a name its own, which begins so. Colours
# that the colour-blind tell apart, and dashes for grey.
COMPARED = [
    ("RSS trees, FCL", "check", "RSS trees, FCL", "#d55e00", "6 4"),
    ("RSS trees, FCL", "detection", "FCL, refit left out", "#d55e00", "1 3"),
    ("z-buffer on ", "check", "", "#aa4499", "9 3 2 3"),
    ("dynamic point (1)", "check", "dynamic point (1), force", "#000000", "2 3"),
    ("exact, proxy's force", "check", "exact, proxy's force", "#0072b2", ""),
    ("exact, nearest pair", "check", "exact, nearest pair", "#4d9fd6", ""),
    ("a ray, Embree", "check", "a ray, Embree", "#009e73", "9 3"),
]
SCENES = {"membrane": "#d55e00", "cloth": "#009e73", "laparoscopy": "#000000", "liver": "#0072b2"}


class Decades(Axis):
    """A logarithmic axis with a mark at each power of ten."""

    def __init__(self, values, start, end):
        low, high = math.floor(math.log10(min(values))), math.ceil(math.log10(max(values)))
        self.marks = [10.0**power for power in range(low, high + 1)]
        self.low, self.high = self.marks[0], self.marks[-1]
        self.start, self.end = start, end


def figure_10(rows, moving, title, subtitle):
    """Time of a check against the triangles of a torus."""
    series = []
    for method, column, name, colour, dash in COMPARED:
        here = [r for r in rows if r["mesh"].startswith("torus") and r["moving"] == moving
                and (r["method"] == method or not name and r["method"].startswith(method))]
        if here and (moving == "1" or column == "check"):
            points = sorted((int(r["triangles"]), float(r[column]) / 1e6) for r in here)
            series.append({"name": name or here[0]["method"], "colour": colour, "dash": dash, "points": points,
                           "thin": []})
    return draw(title, subtitle, "triangles", "ms a check", series, Axis, Decades)


def figure_11(rows):
    """Time of a check against the number of dynamic points: the paper's by its Table 1, and here."""
    series = []
    for source, dash in (("paper", "6 4"), ("here", "")):
        for scene, colour in SCENES.items():
            points = sorted((int(r["method"].split("(")[1].rstrip(")")), 1 / float(r["checks_per_ms"])) for r in rows
                            if (r["source"], r["scene"]) == (source, scene) and "ynamic point" in r["method"])
            series.append({"name": f"{scene}, {source}", "colour": colour, "dash": dash, "points": points, "thin": []})
    return draw("Figure 11: the paper's times, dashed, and its method here",
                "A check with its force: one over the checks a millisecond of Table 1.",
                "dynamic points, one for each part of the tool", "ms a check", series, Doublings, Decades)


def main(bench, folder):
    names = ("table1", "figure10", "crossings")
    missing = [name for name in names if not os.path.exists(f"{bench}/{name}.csv")]
    if missing:
        print(f"chart_paper.py: no {bench}/{missing[0]}.csv: the charts stay as they are", file=sys.stderr)
        return
    figure = read(bench + "/figure10.csv")
    write(folder + "/figure10-rigid.svg", figure_10(
        figure, "0", "Figure 10 (a), here: a tool slides over a rigid torus",
        "Medians of all ticks. FCL, ray and z-buffer detect alone; ray and z-buffer tell no distance."))
    write(folder + "/figure10-deforming.svg", figure_10(
        figure, "1", "Figure 10 (b), here: every vertex of the torus moves",
        "Medians of all ticks: new positions taken, or the tree refitted, and then as in (a)."))
    write(folder + "/figure11.svg", figure_11(read(bench + "/table1.csv")))
    for name in names:
        shutil.copyfile(f"{bench}/{name}.csv", f"{folder}/{name}.csv")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2])
