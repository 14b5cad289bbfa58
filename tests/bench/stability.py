#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""make stability: docs/stability.md and its charts, from what `dynpoint stability --json` said.

stability.py RESULTS DOCS   RESULTS has one JSON object a line; writes DOCS/stability.md and
                            DOCS/charts/stability-*.svg with their data; standard library only
"""
import csv
import glob
import json
import math
import os
import sys

import chart

METHODS = ("proxy", "bed", "ball", "point")
SERIES = {
    "proxy": ("#154360", ""),
    "bed": ("#ca6f1e", "8 3"),
    "ball": ("#117864", "2 3"),
    "point": ("#b03a2e", "6 2 2 2"),
}
OTHERS = (("#222222", "1 3"), ("#7d3c98", "10 3"), ("#7f8c8d", "4 4"), ("#d4ac0d", "6 4"), ("#2e86c1", "3 2"))

# Title, what is drawn, x, y, and which axes are logarithmic: "", "x", "y" or "xy".
CHARTS = {
    "stability-thinsheet": (
        "Force at which a tool passes through a wall", "Pushed by a device that goes on, K = 500 N/m. A proxy never passes.",
        "thickness of the wall, mm", "N", "xy"),
    "stability-rocking": (
        "Torque of a lying tool that rocks end to end", "Lying 1 mm deep on a box and turned by one degree either way.",
        "tilt, degrees", "Nm", ""),
    "stability-tilt": (
        "Stiffness felt on a plane, upright to lying", "One contact, orientation held. Formula: 1 / (1 / K + c^2 / K_r).",
        "tilt from upright, degrees", "N/m", ""),
    "stability-segments": (
        "Stiffness of one flat tool, cut into segments", "80 mm long, 1 mm deep; beside the same tool as one segment.",
        "segments", "times that of one", ""),
    "stability-budget": (
        "Ticks without a force because the budget ended", "A needle on an organ, contact not known in time.",
        "units of work a tick", "% of the ticks", "x"),
    "stability-budget-lag": (
        "Ticks whose proxy lags by more than 1 %", "The same motion. A small budget makes a proxy crawl; it never passes.",
        "units of work a tick", "% of the ticks", "x"),
    "stability-wall": (
        "Stiffest stable wall against delay", "Found by bisection in the loop; limit: the spectral radius of its exact model.",
        "delay, periods", "N/m", "y"),
    "stability-delay": (
        "Stiffest stable wall against delay, by method", "Limit: the spectral radius of the sampled device held on the plane.",
        "delay, periods", "N/m", "y"),
    "stability-damping": (
        "Stiffest stable wall against virtual damping, by method", "Limit: the spectral radius of the sampled device.",
        "virtual damping, Ns/m", "N/m", ""),
    "stability-rate": (
        "Stiffest stable stiffness against the rate of the loop", "The same device on an organ; delay counted in periods.",
        "Hz", "N/m", "xy"),
    "stability-phase": (
        "Stiffest stable wall against the phase of the loop", "How long after a sample its command comes.",
        "phase, periods", "N/m", ""),
    "stability-tissue": (
        "Stiffest coupling that comes to rest on tissue", "A ball on lively tissue. Chosen: by dpt_coupling_for_device.",
        "rate of physics, Hz", "N/m", "xy"),
    "stability-displace": (
        "Noise of a pin's force over what is moved out of its way", "A pin of 5 mm, 5 mm deep, at 20 mm/s.",
        "edges, mm", "rms above 100 Hz, of the mean force", ""),
}

INTRODUCTION = """\
<!-- SPDX-License-Identifier: BSD-3-Clause -->
<!-- Made by `make stability`; edit the cases in tools/lab or tests/bench/stability.py. -->
# Stability: what breaks which method

`dynpoint stability` breaks methods of force on purpose. Each case below says what is done, what was measured, what is
allowed, and what to do about it. `dynpoint stability CASE` runs one of them. Without a name it runs {count} cases: all but
`hum`, of which some rows are known to fail. It does a quarter of the places and ticks, which takes a minute of processor
time; a busy machine takes some minutes for it. `--effort 1` does all: three minutes more, and two for `hum`. `make
stability` runs all with that effort and makes this page, and `make check` looks whether the page still tells what short
cases say. The exit status is 1 if the proxy or a controller breaks a limit, else 0. There is no hardware in it: hands and
devices are simulated ([back_ends.md](back_ends.md#sim)).

| method | what it is |
|---|---|
| proxy | the default: a spring to a pose of the tool that has gone through nothing ([force.md](algorithms/force.md)) |
| bed | the gradient of an energy along the tool and at its ends |
| ball | a proxy of one point at the tool's tip, as point-based toolkits have it; it is our own, not their code |
| point | the paper's: a push at the deepest point of the tool |

A method *holds* in a case if all its figures are within their limits. A baseline may fail: that is what it is there for.
"""


def nice_step(low, high):
    """About six marks between two values, at 1, 2 or 5 times a power of ten."""
    rough = (high - low or abs(high) or 1.0) / 6
    power = 10 ** math.floor(math.log10(rough))
    return min((m * power for m in (1, 2, 5, 10) if m * power >= rough))


class Linear(chart.Steps):
    """From the mark below the least value to the one above the largest."""

    def __init__(self, values, start, end):
        low, high = min(values), max(values)
        if low == high:
            low, high = low - 1, high + 1
        super().__init__([low, high], start, end, nice_step(low, high))


def number(value):
    """As few digits as tell what it is."""
    if value is None:
        return "none"
    return f"{value:.4g}" if value == 0 or 1e-3 <= abs(value) < 1e5 else f"{value:.2e}"


def verdict(figures):
    said = [f["verdict"] for f in figures if "verdict" in f]
    return "" if not said else "fails" if "fails" in said else "holds"


def summary(cases):
    rows = ["| case | " + " | ".join(METHODS) + " | controller, spring |", "|---|" + "---|" * (len(METHODS) + 1)]
    for case in cases:
        told = [verdict([f for f in case["figures"] if f["method"] == m]) for m in METHODS]
        told.append(verdict([f for f in case["figures"] if f["method"] not in METHODS]))
        rows.append(f"| [{case['title']}](#{anchor(case)}) | " + " | ".join(told) + " |")
    return "\n".join(rows)


def heading(case):
    return f"{case['case']}: {case['title']}"


def anchor(case):
    kept = "".join(c for c in heading(case).lower() if c.isalnum() or c in " -_")
    return kept.replace(" ", "-")


def wrap(paragraph, width=118):
    lines, line = [], ""
    for word in paragraph.split():
        if line and len(line) + 1 + len(word) > width:
            lines.append(line)
            line = word
        else:
            line = f"{line} {word}" if line else word
    return "\n".join(lines + [line])


def cell(words):
    """A bar would end the cell."""
    return words.replace("|", "\\|")


def figures_table(case):
    rows = ["| method | figure | value | limit | |", "|---|---|---|---|---|"]
    for f in case["figures"]:
        limit = ("at most " + number(f["at_most"]) if "at_most" in f else
                 "at least " + number(f["at_least"]) if "at_least" in f else "")
        value = " ".join((number(f["value"]), f["unit"])).strip()
        rows.append(f"| {f['method']} | {cell(f['what'])} | {value} | {limit} | {f.get('verdict', '')} |")
    return "\n".join(rows)


def table(head, lines):
    return "\n".join("| " + " | ".join(line) + " |" for line in (head, ["---"] * len(head), *lines))


def rows_table(case):
    """How many rows of each scene and hand hold, and all that do not."""
    rows = case["rows"]
    hands = list(dict.fromkeys(row["hand"] for row in rows))
    held = []
    for scene in dict.fromkeys(row["scene"] for row in rows):
        of = {hand: [row["verdict"] == "holds" for row in rows if (row["scene"], row["hand"]) == (scene, hand)] for hand in hands}
        of["all"] = sum(of.values(), [])
        held.append([scene, *(f"{sum(told)} of {len(told)}" for told in of.values())])
    others = [[v if isinstance(v, str) else number(v) for v in row.values()] for row in rows if row["verdict"] != "holds"]
    return (f"Rows that hold, by what the hand does:\n\n{table(['scene', *hands, 'all'], held)}\n\nRows that do not:\n\n"
            + table([key.replace("_", " ") for key in rows[0]], others))


def section(case):
    parts = [f"## {heading(case)}", wrap(case["method"]), figures_table(case)]
    if case.get("rows"):
        parts.append(rows_table(case))
    for name in charts_of(case):
        parts.append(f"![{CHARTS[name][0]}](charts/{name}.svg)\n\n[Data](charts/{name}.csv)")
    parts.append("**What to do.**\n" + wrap(case["advice"]))
    return "\n\n".join(parts)


def charts_of(case):
    return list(dict.fromkeys(p["chart"] for p in case["points"]))


def curve(name, points, place):
    colour, dash = SERIES.get(name) or OTHERS[place % len(OTHERS)]
    return {"name": name, "colour": colour, "dash": dash, "points": points, "thin": []}


def draw(name, points):
    title, subtitle, x_title, y_title, logarithmic = CHARTS[name]
    by_series, others = {}, 0
    for p in points:
        x_fits, y_fits = (p[k] is not None and (p[k] > 0 or k not in logarithmic) for k in "xy")
        if x_fits and y_fits:
            by_series.setdefault(p["series"], []).append((p["x"], p["y"]))
    series = []
    for key, here in by_series.items():
        series.append(curve(key, sorted(here), others))
        others += key not in SERIES
    return chart.draw(title, subtitle, x_title, y_title, series, *(
        chart.Axis if axis in logarithmic else Linear for axis in "xy"))


def write_charts(cases, folder):
    for old in glob.glob(f"{folder}/stability-*"):
        os.remove(old)
    for case in cases:
        for name in charts_of(case):
            points = [p for p in case["points"] if p["chart"] == name]
            chart.write(f"{folder}/{name}.svg", draw(name, points))
            with open(f"{folder}/{name}.csv", "w", encoding="utf-8", newline="") as file:
                writer = csv.writer(file, lineterminator="\n")
                writer.writerow(("series", "x", "y"))
                writer.writerows((p["series"], p["x"], p["y"]) for p in points)


def main(results, docs):
    with open(results, encoding="utf-8") as file:
        cases = [json.loads(line) for line in file]
    unknown = {name for case in cases for name in charts_of(case)} - set(CHARTS)
    if unknown:
        sys.exit(f"stability.py: no title for {', '.join(sorted(unknown))}")
    write_charts(cases, docs + "/charts")
    page = [INTRODUCTION.format(count=len([case for case in cases if not case.get("rows")])), summary(cases), *map(section, cases)]
    chart.write(docs + "/stability.md", "\n\n".join(p.rstrip("\n") for p in page) + "\n")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2])
