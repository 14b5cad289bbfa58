#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""make charts: draw docs/charts/*.svg, and keep their data, from what the bench wrote.

chart.py BENCH_DIR OUT_DIR   draws what no scene's chart is (dynpoint chart): growth over meshes and parts, histograms, and
                             what programs of the bench measure, and names the files that are not there; standard
                             library only
"""
import csv
import math
import os
import shutil
import sys

WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 760, 420, 70, 190, 50, 60
PANEL, GAP, ZERO = 84, 16, 56  # of histograms: a panel's height, the gap below it, the place of 0

METHODS = {  # rows of dynpoint chart, without kernels that are not here
    "fcl": ("FCL, OBBRSS, warm", "#d55e00", "6 4"),
    "cgal": ("CGAL, AABB tree", "#aa4499", "6 4"),
    "paper in 1 part": ("paper, 1 part (inexact)", "#e69f00", "2 3"),
    "exact by scalar": ("exact, scalar", "#999999", ""),
    "exact by sse2": ("exact, SSE2", "#56b4e9", ""),
    "exact by avx2": ("exact, AVX2", "#2e86c1", ""),
    "exact": ("exact, widest kernel", "#154360", ""),
    "tree": ("tree, widest kernel", "#009e73", "9 3"),
}
MESHES = {
    "star": ("star, 20,480", "#d55e00", ""),
    "torus-61358": ("torus, 61,358", "#e69f00", "6 4"),
    "liver": ("liver, 50,332", "#154360", ""),
    "torus-5568": ("torus, 5,568", "#7fb3d5", "6 4"),
    "membrane": ("membrane, 512", "#009e73", "2 3"),
}

STRIPS = {
    "routes": ("routes, as the paper", "#e69f00"),
    "narrow": ("shadow, width 0", "#7fb3d5"),
    "wide": ("shadow, width margin", "#154360"),
}

TIMED = {"exact": ("exact", "#154360"), "tree": ("tree", "#009e73"), "fcl": ("FCL, OBBRSS, warm", "#d55e00")}

MOVING = {
    "fcl": ("FCL, RSS", "#d55e00"),
    "bullet": ("Bullet, swept box", "#e69f00"),
    "embree": ("Embree, 64 points", "#aa4499"),
    "sse2": ("dynpoint, SSE2", "#7fb3d5"),
    "avx512": ("dynpoint, AVX-512", "#154360"),
    "rigid": ("dynpoint, rigid body", "#95a5a6"),
}

MAP_KINDS = {
    "one": ("stable in one step", "#7fb3d5"),
    "cut": ("cut into substeps", "#d4e6f1"),
    "refused": ("refused", "#d5d8dc"),
    "grown": ("energy grows", "#d55e00"),
}
MAP_GROWN = 2  # times the energy at the start: rounding and swings of a stable step stay below

LAWS = {
    "point": ("#d55e00", 0.9),
    "bed": ("#e69f00", 1.8),
    "proxy": ("#154360", 2.2),
}
ZOOM = (700, 750)  # ms of the needle that its lower panel shows


class Axis:
    """A logarithmic axis from a 1, 2, 5 mark below the least value to one above the largest."""

    def __init__(self, values, start, end):
        marks = [m * 10**e for e in range(-4, 9) for m in (1, 2, 5)]
        self.low = max(m for m in marks if m <= min(values))
        self.high = min(m for m in marks if m >= max(values))
        self.marks = [m for m in marks if self.low <= m <= self.high]
        self.start, self.end = start, end

    def at(self, value):
        share = math.log(value / self.low) / math.log(self.high / self.low)
        return self.start + share * (self.end - self.start)


class Doublings(Axis):
    """A logarithmic axis whose marks are the values themselves: 1, 2, 4, ..."""

    def __init__(self, values, start, end):
        self.marks = sorted(set(values))
        self.low, self.high = self.marks[0], self.marks[-1]
        self.start, self.end = start, end


class Percent(Axis):
    """From 0 to 100."""

    def __init__(self, values, start, end):
        self.marks = range(0, 101, 20)
        self.low, self.high = 0, 100
        self.start, self.end = start, end

    def at(self, value):
        return self.start + value / 100 * (self.end - self.start)


class Steps(Axis):
    """A linear axis with a mark every `step`, from the one below the least value to the one above the largest."""

    def __init__(self, values, start, end, step):
        first, last = math.floor(min(values) / step), math.ceil(max(values) / step)
        self.marks = [mark * step for mark in range(first, last + 1)]
        self.low, self.high = self.marks[0], self.marks[-1]
        self.start, self.end = start, end

    def at(self, value):
        return self.start + (value - self.low) / (self.high - self.low) * (self.end - self.start)


def text(x, y, content, anchor="middle", size=13, extra=""):
    return (f'<text x="{x:.1f}" y="{y:.1f}" font-size="{size}" text-anchor="{anchor}" {extra}>'
            f"{content}</text>")


def polyline(x, y, points, colour, width, dash):
    path = " ".join(f"{x.at(a):.1f},{y.at(b):.1f}" for a, b in points)
    return (f'<polyline points="{path}" fill="none" stroke="{colour}" stroke-width="{width}" '
            f'stroke-dasharray="{dash}"/>')


def spread(labels, least, bottom=math.inf):
    """[height, ...] in order of height, moved down until they are `least` apart, and up where that is below `bottom`."""
    labels.sort()
    for previous, label in zip(labels, labels[1:]):
        label[0] = max(label[0], previous[0] + least)
    for label in reversed(labels):
        label[0] = min(label[0], bottom)
        bottom = label[0] - least
    return labels


def draw(title, subtitle, x_title, y_title, series, x_axis=Axis, y_axis=Axis):
    """series: name, colour, dash, points, thin points beside them, points apart (squares), and (x, low, high) of bars."""
    x = x_axis([p[0] for s in series for p in s["points"]], LEFT, WIDTH - RIGHT)
    y = y_axis([p[1] for s in series for p in s["points"] + s["thin"]], HEIGHT - BOTTOM, TOP)
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" '
           'font-family="sans-serif" fill="#222">',
           f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>',
           text(LEFT, 22, title, "start", 16, 'font-weight="bold"'),
           text(LEFT, 40, subtitle, "start", 12)]
    for mark in y.marks:
        out.append(f'<line x1="{LEFT}" x2="{WIDTH - RIGHT}" y1="{y.at(mark):.1f}" '
                   f'y2="{y.at(mark):.1f}" stroke="#ddd"/>')
        out.append(text(LEFT - 8, y.at(mark) + 4, f"{mark:g}", "end"))
    for mark in x.marks:
        out.append(f'<line x1="{x.at(mark):.1f}" x2="{x.at(mark):.1f}" y1="{HEIGHT - BOTTOM}" '
                   f'y2="{HEIGHT - BOTTOM + 5}" stroke="#888"/>')
        out.append(text(x.at(mark), HEIGHT - BOTTOM + 20, f"{int(mark):,}" if mark == int(mark) else f"{mark:g}"))
    out.append(text((LEFT + WIDTH - RIGHT) / 2, HEIGHT - 16, x_title))
    out.append(text(18, HEIGHT / 2, y_title, extra=f'transform="rotate(-90 18 {HEIGHT / 2})"'))
    labels = []
    for s in series:
        out.append(polyline(x, y, s["points"], s["colour"], 2.5, s["dash"]))
        if s["thin"]:
            out.append(polyline(x, y, s["thin"], s["colour"], 0.9, s["dash"]))
        out += [f'<path d="M{x.at(a):.1f},{y.at(low):.1f}V{y.at(high):.1f}" stroke="{s["colour"]}" stroke-width="8" '
                'stroke-opacity="0.3"/>' for a, low, high in s.get("ranges", [])]
        out += [f'<circle cx="{x.at(a):.1f}" cy="{y.at(b):.1f}" r="3" fill="{s["colour"]}"/>'
                for a, b in s["points"]]
        out += [f'<rect x="{x.at(a) - 4:.1f}" y="{y.at(b) - 4:.1f}" width="8" height="8" fill="white" '
                f'stroke="{s["colour"]}" stroke-width="2"/>' for a, b in s.get("apart", [])]
        labels.append([y.at(s["points"][-1][1]), s["name"], s["colour"], s["dash"]])
    for height, name, colour, dash in spread(labels, 16, HEIGHT - BOTTOM):
        left = WIDTH - RIGHT + 8
        out.append(f'<path d="M{left},{height:.1f}h20" stroke="{colour}" stroke-width="2.5" stroke-dasharray="{dash}"/>')
        out.append(text(left + 26, height + 4, name, "start", 12, f'fill="{colour}"'))
    out.append("</svg>")
    return "\n".join(out) + "\n"


def read_bins(rows, mesh, name, of):
    """[from, to, share of the ticks in %] of one histogram."""
    rows = [r for r in rows if (r["mesh"], r["name"], r["of"]) == (mesh, name, of)]
    ticks = sum(int(r["ticks"]) for r in rows)
    return [(float(r["from"]), float(r["to"] or 2 * float(r["from"])),
             100 * int(r["ticks"]) / ticks) for r in rows]


def quantile(bins, share):
    """Where that share of the ticks (in %) is reached, evenly within a bin."""
    for low, high, here in bins:
        if share <= here:
            return low + (high - low) * share / here
        share -= here
    return bins[-1][1]


def draw_histograms(title, subtitle, x_title, series):
    """One panel below the other, on one logarithmic axis; series: name, colour, bins."""
    bottom = TOP + len(series) * (PANEL + GAP) - GAP
    height = bottom + BOTTOM
    values = [v for s in series for low, high, _ in s["bins"] for v in (low, high) if low > 0]
    zero = any(low == 0 for s in series for low, _, _ in s["bins"])
    x = Axis(values, LEFT + (ZERO if zero else 0), WIDTH - RIGHT)
    least = min(share for s in series for _, _, share in s["bins"])
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" '
           'font-family="sans-serif" fill="#222">',
           f'<rect width="{WIDTH}" height="{height}" fill="white"/>',
           text(LEFT, 22, title, "start", 16, 'font-weight="bold"'),
           text(LEFT, 40, subtitle, "start", 12)]
    for number, s in enumerate(series):
        floor = TOP + number * (PANEL + GAP) + PANEL
        y = Axis([least / 2, 100], floor, floor - PANEL)
        y.low = least / 2  # down to half of one tick, not to a mark
        for mark in [m for m in (0.01, 0.1, 1, 10, 100) if m >= y.low]:
            out.append(f'<line x1="{LEFT}" x2="{WIDTH - RIGHT}" y1="{y.at(mark):.1f}" '
                       f'y2="{y.at(mark):.1f}" stroke="#ddd"/>')
            out.append(text(LEFT - 8, y.at(mark) + 4, f"{mark:g}", "end", 11))
        for low, high, share in s["bins"]:
            left, right = (x.at(low), x.at(high)) if low > 0 else (LEFT, LEFT + ZERO / 2)
            out.append(f'<rect x="{left:.1f}" y="{y.at(share):.1f}" width="{right - left:.1f}" '
                       f'height="{floor - y.at(share):.1f}" fill="{s["colour"]}" '
                       'fill-opacity="0.75" stroke="white" stroke-width="0.5"/>')
        for share in (50, 99):
            value = quantile(s["bins"], share)
            at = x.at(value) if value >= x.low else LEFT + ZERO / 4
            out.append(f'<line x1="{at:.1f}" x2="{at:.1f}" y1="{floor - PANEL}" y2="{floor}" '
                       'stroke="#222" stroke-dasharray="3 2"/>')
        for left, right in ((LEFT, LEFT + ZERO / 2), (x.start, WIDTH - RIGHT)):
            out.append(f'<line x1="{left}" x2="{right}" y1="{floor}" y2="{floor}" stroke="#888"/>')
        out.append(text(WIDTH - RIGHT + 8, floor - PANEL / 2 + 4, s["name"], "start", 13,
                        f'fill="{s["colour"]}"'))
    for mark in x.marks:
        out.append(f'<line x1="{x.at(mark):.1f}" x2="{x.at(mark):.1f}" y1="{bottom}" '
                   f'y2="{bottom + 5}" stroke="#888"/>')
        out.append(text(x.at(mark), bottom + 20, f"{mark:,g}"))
    if zero:
        out.append(text(LEFT + ZERO / 4, bottom + 20, "0"))
    out.append(text((LEFT + WIDTH - RIGHT) / 2, height - 16, x_title))
    middle = (TOP + bottom) / 2
    out.append(text(18, middle, "% of the ticks", extra=f'transform="rotate(-90 18 {middle})"'))
    out.append("</svg>")
    return "\n".join(out) + "\n"


def time_histogram(rows):
    """How often a tick on the liver took how long."""
    series = [{"name": name, "colour": colour, "bins":
               [(low / 1e3, high / 1e3, share) for low, high, share in bins]}
              for row, (name, colour) in TIMED.items() if (bins := read_bins(rows, "liver", row, "ns"))]
    return draw_histograms("Time of a tick on the liver (50,332 triangles)",
                           "All ticks, crossing or not; 8 bins a doubling. Dashed: median and 99 %.",
                           "microseconds a tick", series)


def work_histogram(rows):
    """How often a tick of the exact method looked at how many blocks, a panel a mesh."""
    series = [{"name": name, "colour": colour, "bins": bins}
              for mesh, (name, colour, _) in MESHES.items() if (bins := read_bins(rows, mesh, "exact", "work"))]
    return draw_histograms("Work of a tick: the exact method on five meshes",
                           "Each number up to 8, then 4 bins a doubling. Dashed: median and 99 %.",
                           "blocks of 16 boxes or triangles looked at in a tick", series)


def tick_time(rows):
    """Time against triangles, ticks that do not cross, on tori and liver (the paper's Figure 10)."""
    def points(mesh, row, column):
        return sorted((int(r["triangles"]), float(r[column])) for r in rows
                      if r["mesh"].startswith(mesh) and (r["part"], r["name"]) == ("pair", row) and r[column])

    def ranges(row):
        return [(a[0], a[1], b[1]) for a, b in zip(points("", row, "other_median_least_us"),
                                                   points("", row, "other_median_most_us")) if a[0] in tori]

    tori = {int(r["triangles"]) for r in rows if r["mesh"].startswith("torus")}
    series = [{"name": name, "colour": colour, "dash": dash, "points": medians,
               "thin": points("torus", row, "other_p99_us"), "apart": points("liver", row, "other_median_us"),
               "ranges": ranges(row)}
              for row, (name, colour, dash) in METHODS.items() if (medians := points("torus", row, "other_median_us"))]
    return draw("Nearest pair of a sliding tool and a torus (squares: the liver)",
                "Ticks that do not cross. Thick: median, bars: of the repeats; thin: 99 %. All but the paper's are exact.",
                "triangles", "microseconds a tick", series)


def parts(rows, title, subtitle, y_title, value, is_there=lambda row: True):
    """A line a mesh: the paper's method against the number of parts."""
    def points(mesh):
        here = [r for r in rows if (r["mesh"], r["part"]) == (mesh, "pair") and r["name"].startswith("paper in")]
        return sorted((int(r["parts"]), value(r)) for r in here if is_there(r))

    series = [{"name": name, "colour": colour, "dash": dash, "thin": [], "points": here}
              for mesh, (name, colour, dash) in MESHES.items() if (here := points(mesh))]
    return draw("The paper's method: " + title, subtitle, "parts, each with its own dynamic point", y_title, series, Doublings)


def parts_time(rows):
    return parts(rows, "time against parts of the tool", "Median of all ticks. It grows with the parts, hardly with the mesh.",
                 "microseconds a tick", lambda r: float(r["median_us"]))


def parts_error(rows):
    return parts(rows, "largest error of the nearest distance",
                 "The meshes are about 0.35 m large. No point: no tick is wrong, as on the flat membrane.",
                 "mm", lambda r: 1e3 * float(r["distance_error_m"]), lambda r: int(r["wrong"]))


def parts_wrong(rows):
    return parts(rows, "ticks with a wrong nearest pair",
                 "Local minima hold the dynamic points. No point: no tick is wrong, as of the exact method.",
                 "% of the ticks", lambda r: 100 * int(r["wrong"]) / int(r["ticks"]), lambda r: int(r["wrong"]))


def strip_recall(rows):
    """What share of the triangles near a tool a strip holds, against the tool's length."""
    series = []
    for kind, (name, colour) in STRIPS.items():
        points, thin = [], []
        for length in sorted({int(r["length"]) for r in rows}):
            here = [(float(r[kind + "_found"]), int(r["poses"]) * float(r["near"]))
                    for r in rows if int(r["length"]) == length]
            points.append((length, sum(f * n for f, n in here) / sum(n for _, n in here)))
            thin.append((length, min(f for f, _ in here)))
        series.append({"name": name, "colour": colour, "dash": "", "points": points, "thin": thin})
    meshes = len({r["mesh"] for r in rows})
    return draw("What a strip holds of the triangles within the margin of a tool",
                f"Tools that lie on {meshes} closed meshes, margin 1 % of the diagonal. "
                "Thick: all meshes; thin: the worst one.",
                "length of the tool, % of the mesh's diagonal", "% of the triangles that are near",
                series, Doublings, Percent)


def contact_budget(rows):
    """What share of the ticks in reach has its contact, against what a tick takes, by budget."""
    series = []
    for mesh, (name, colour, dash) in MESHES.items():
        here = sorted((r for r in rows if r["mesh"] == mesh and r["budget"] != "0"),
                      key=lambda r: int(r["budget"]))
        if here:
            lines = [[(float(r["p99"]) / 1e3, 100 - 100 * int(r[column]) / int(r["in_reach"]))
                      for r in here] for column in ("unknown", "off")]
            whole = [(float(r["p99"]) / 1e3, 100) for r in rows
                     if r["mesh"] == mesh and r["budget"] == "0"]
            series.append({"name": name, "colour": colour, "dash": dash, "points": lines[0],
                           "thin": lines[1], "apart": whole})
    return draw("Contact with a budget of 25, 50, 100 ... 3,200 units (squares: none)",
                "Thick: ticks in reach whose contact is known; thin: and whose thrust is within 2 % of the peak.",
                "microseconds a tick, 99 %", "% of the ticks in reach", series, Axis, Percent)


def draw_forces(rows, top, bottom, x, names):
    """A panel: the force of each law the way out, against time, named at its right."""
    forces = {law: [(float(r["ms"]), float(r[law + "_force"])) for r in rows] for law in LAWS}
    y = Steps([force for points in forces.values() for _, force in points], bottom, top, 5)
    out, labels = [], []
    for mark in y.marks:
        out.append(f'<line x1="{LEFT}" x2="{WIDTH - RIGHT}" y1="{y.at(mark):.1f}" y2="{y.at(mark):.1f}" '
                   f'stroke="{"#888" if mark == 0 else "#ddd"}"/>')
        out.append(text(LEFT - 8, y.at(mark) + 4, f"{mark:g}", "end"))
    for mark in x.marks:
        out.append(f'<line x1="{x.at(mark):.1f}" x2="{x.at(mark):.1f}" y1="{bottom}" y2="{bottom + 5}" '
                   'stroke="#888"/>')
        out.append(text(x.at(mark), bottom + 20, f"{mark:g}"))
    for law, (colour, width) in LAWS.items():
        out.append(polyline(x, y, forces[law], colour, width, ""))
        labels.append([y.at(forces[law][-1][1]), names[law], colour])
    for height, name, colour in spread(labels, 16):
        out.append(text(WIDTH - RIGHT + 8, height + 4, name, "start", 13, f'fill="{colour}"'))
    out.append(text(18, (top + bottom) / 2, "force outward, N",
                    extra=f'transform="rotate(-90 18 {(top + bottom) / 2})"'))
    return out


def needle_force(rows):
    """What a needle feels that is pushed through a liver and held there, and a part of it closer by."""
    whole, part = (TOP + 24, TOP + 234), (TOP + 306, TOP + 466)
    height = part[1] + BOTTOM
    closer = [r for r in rows if ZOOM[0] <= int(r["ms"]) <= ZOOM[1]]
    x = Steps([float(r["ms"]) for r in rows], LEFT, WIDTH - RIGHT, 100)
    turns = {law: sum(float(r[law + "_turn"] or 0) > 30 for r in rows) for law in LAWS}
    upper = draw_forces(rows, *whole, x, {law: f"{law}: {turns[law]} turns" for law in LAWS})
    lower = draw_forces(closer, *part, Steps(ZOOM, LEFT, WIDTH - RIGHT, 10), {law: law for law in LAWS})
    band = (f'<rect x="{x.at(ZOOM[0]):.1f}" y="{whole[0]}" width="{x.at(ZOOM[1]) - x.at(ZOOM[0]):.1f}" '
            f'height="{whole[1] - whole[0]}" fill="#f2e8c9"/>')
    held = x.at(600)
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" '
           'font-family="sans-serif" fill="#222">',
           f'<rect width="{WIDTH}" height="{height}" fill="white"/>',
           text(LEFT, 22, "Force on a needle that is pushed into a liver, with a tremor of 0.2 mm", "start", 16,
                'font-weight="bold"'),
           text(LEFT, 40, "The same motion for each law, K = 500 N/m. A turn: a tick that turns the force by more than "
                "30 degrees.", "start", 12),
           band, *upper,
           text((x.at(0) + held) / 2, whole[0] - 8, "pushed in, 27 mm deep", size=12),
           text((held + x.at(1000)) / 2, whole[0] - 8, "held there", size=12),
           f'<line x1="{held:.1f}" x2="{held:.1f}" y1="{whole[0] - 20}" y2="{whole[1]}" stroke="#888" '
           'stroke-dasharray="3 2"/>',
           text(LEFT, part[0] - 14, f"{ZOOM[0]} to {ZOOM[1]} ms", "start", 12, 'font-weight="bold"'),
           *lower, text((LEFT + WIDTH - RIGHT) / 2, height - 16, "ms, one tick each"), "</svg>"]
    return "\n".join(out) + "\n"


def moving_mesh(rows):
    """The query on the liver by how far its vertices move in a tick."""
    rows = [r for r in rows if (r["mesh"], r["motion"]) == ("liver", "modes") and r["other_median"]]

    def points(subject, column):
        return sorted((1e3 * float(r["step"]), float(r[column]) / 1e3) for r in rows if r["subject"] == subject)

    series = [{"name": name, "colour": colour, "dash": "6 4" if subject in ("fcl", "bullet", "embree") else "",
               "points": medians, "thin": points(subject, "other_p99")}
              for subject, (name, colour) in MOVING.items() if (medians := points(subject, "other_median"))]
    return draw("Nearest pair on a liver whose every vertex moves each tick",
                "50,332 triangles, ticks that do not cross: median, thin 99 %. Refits of peers are not in it.",
                "farthest that a vertex moves in a tick, mm", "microseconds a query", series)


def map_cell(rows):
    """What becomes of a stiffness and step: one step, so many substeps, refused, or grown, which must not be."""
    outcomes = {int(r["substeps"]): float(r["outcome"]) for r in rows}
    accepted = [value for substeps, value in outcomes.items() if substeps and value > 0]
    if any(not value <= MAP_GROWN for value in accepted):
        return "grown"
    return "one" if outcomes[1] > 0 else "cut" if accepted else "refused"


def springs_map(rows):
    """Which stiffness and step each integrator takes, a panel each; crosses: the loop alone explodes there."""
    panels = [("euler", "EULER"), ("symplectic", "SYMPLECTIC"), ("implicit", "IMPLICIT")]
    stiffnesses = sorted({float(r["stiffness"]) for r in rows})
    steps = sorted({float(r["step"]) for r in rows})
    wide, high, top, gap = 12, 24, TOP + 54, 20
    height = top + high * len(steps) + BOTTOM
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" '
           'font-family="sans-serif" fill="#222">',
           f'<rect width="{WIDTH}" height="{height}" fill="white"/>',
           text(LEFT, 22, "Which stiffness and step each integrator of springs takes", "start", 16, 'font-weight="bold"'),
           text(LEFT, 40, "A block of 216 nodes, thrown about for a second; at most 16 substeps. "
                "Crosses: the loop alone explodes.", "start", 12)]
    at = LEFT
    for kind, (name, colour) in MAP_KINDS.items():
        out.append(f'<rect x="{at}" y="{TOP}" width="14" height="14" fill="{colour}"/>')
        out.append(text(at + 20, TOP + 12, name, "start", 12))
        at += 40 + 7 * len(name)
    left = LEFT
    for integrator, title in panels:
        out.append(text(left + wide * len(stiffnesses) / 2, top - 8, title, size=13, extra='font-weight="bold"'))
        for column, stiffness in enumerate(stiffnesses):
            for row, step in enumerate(steps):
                here = [r for r in rows if r["integrator"] == integrator and float(r["stiffness"]) == stiffness
                        and float(r["step"]) == step]
                x, y = left + wide * column, top + high * (len(steps) - 1 - row)
                out.append(f'<rect x="{x}" y="{y}" width="{wide - 1}" height="{high - 1}" '
                           f'fill="{MAP_KINDS[map_cell(here)][1]}"/>')
                if any(r["substeps"] == "0" and not float(r["outcome"]) <= MAP_GROWN for r in here):
                    out.append(f'<path d="M{x + 2.5},{y + 8.5} l6,6 m0,-6 l-6,6" stroke="#222" fill="none"/>')
        for column, stiffness in enumerate(stiffnesses):
            power = math.log10(stiffness)
            if abs(power - round(power)) < 0.01 and round(power) % 2 == 0:
                out.append(text(left + wide * (column + 0.5), height - BOTTOM + 18, f"1e{round(power):d}", size=12))
        left += wide * len(stiffnesses) + gap
    for row, step in enumerate(steps):
        if row % 2 == 0:
            out.append(text(LEFT - 8, top + high * (len(steps) - 1 - row) + high / 2 + 4, f"{1e3 * step:g}", "end", 12))
    out.append(text((LEFT + left - gap) / 2, height - 16, "stiffness (1: E = 5 kPa, cells of 10 mm)"))
    middle = top + high * len(steps) / 2
    out.append(text(18, middle, "step, ms", extra=f'transform="rotate(-90 18 {middle})"'))
    out.append("</svg>")
    return "\n".join(out) + "\n"


def needle_peers(rows):
    """What a tick of a needle takes, and how far its force is from the stated law's, by method and setting."""
    styles = {"dynpoint": ("dynpoint", "#154360", "units of work a tick"), "penalty": ("penalty needle", "#d55e00", "nodes"),
              "ray": ("sticking ray", "#009e73", "")}
    x = Axis([float(r["ns"]) / 1e3 for r in rows], LEFT, WIDTH - RIGHT)
    y = Axis([float(r[column]) for r in rows for column in ("rms", "rms_going")], HEIGHT - BOTTOM, TOP)
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" fill="#222">',
           f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>',
           text(LEFT, 22, "A needle that goes in, rests, and comes out: error of its force", "start", 16, 'font-weight="bold"'),
           text(LEFT, 40, "Root mean square: full marks of all ticks, open ones of those in which it goes in.", "start", 12)]
    for mark in y.marks:
        out.append(f'<line x1="{LEFT}" x2="{WIDTH - RIGHT}" y1="{y.at(mark):.1f}" y2="{y.at(mark):.1f}" stroke="#ddd"/>')
        out.append(text(LEFT - 8, y.at(mark) + 4, f"{mark:g}", "end"))
    for mark in x.marks:
        out.append(text(x.at(mark), HEIGHT - BOTTOM + 20, f"{mark:g}"))
    out.append(text((LEFT + WIDTH - RIGHT) / 2, HEIGHT - 14, "median of a tick, us"))
    out.append(text(18, (TOP + HEIGHT - BOTTOM) / 2, "N", extra=f'transform="rotate(-90 18 {(TOP + HEIGHT - BOTTOM) / 2})"'))
    for number, (method, (name, colour, unit)) in enumerate(styles.items()):
        mine = [r for r in rows if r["method"] == method]
        for r in mine:
            at = x.at(float(r["ns"]) / 1e3)
            out.append(f'<circle cx="{at:.1f}" cy="{y.at(float(r["rms"])):.1f}" r="5" fill="{colour}"/>')
            out.append(f'<circle cx="{at:.1f}" cy="{y.at(float(r["rms_going"])):.1f}" r="5" fill="none" stroke="{colour}" stroke-width="2"/>')
        settings = ", ".join("without a budget" if r["setting"] == "0" else r["setting"] for r in mine)
        out.append(text(WIDTH - RIGHT + 12, TOP + 20 + 60 * number, name, "start", 13, f'fill="{colour}" font-weight="bold"'))
        if unit:
            out.append(text(WIDTH - RIGHT + 12, TOP + 36 + 60 * number, settings, "start", 11))
            out.append(text(WIDTH - RIGHT + 12, TOP + 50 + 60 * number, unit, "start", 11))
    out.append("</svg>")
    return "\n".join(out) + "\n"


def read(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def write(path, content):
    with open(path, "w", encoding="utf-8") as file:
        file.write(content)


# Of each file of the bench: how its copy is called, and what is drawn from it.
DRAWN = {
    "meshes": ("meshes", {"tick-time": tick_time, "parts-time": parts_time, "parts-wrong": parts_wrong,
                          "parts-error": parts_error}),
    "histograms": ("histograms", {"time-histogram": time_histogram, "work-histogram": work_histogram}),
    "strip_coverage": ("strip-recall", {"strip-recall": strip_recall}),
    "budgets": ("contact-budget", {"contact-budget": contact_budget}),
    "needle": ("needle-force", {"needle-force": needle_force}),
    "needle_peers": ("needle-peers", {"needle-peers": needle_peers}),
    "deform": ("deform", {"deform": moving_mesh}),
    "springs_map": ("springs-map", {"springs-map": springs_map}),
    "soft_liver": ("soft-liver", {}),
    "springs": ("springs", {}),
}


def main(bench, folder):
    for source, (copy, charts) in DRAWN.items():
        path = f"{bench}/{source}.csv"
        if not os.path.exists(path):
            print(f"chart.py: no {path}: what is drawn from it stays as it is", file=sys.stderr)
            continue
        for name, chart in charts.items():
            write(f"{folder}/{name}.svg", chart(read(path)))
        shutil.copyfile(path, f"{folder}/{copy}.csv")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2])
