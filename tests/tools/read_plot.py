#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Read a chart of dynpoint plot back by its own axes, and compare it with the CSV files it was drawn from.

read_plot.py CHART.svg [--dt S] [--from S] [--to S] RUN.csv [SECOND.csv]

Every extreme of a CSV must be drawn, within a pixel of its time; nothing may be drawn where a pixel's column and its
neighbours have no such value; a gap of three columns and more must be one. Prints the names of the panels, and what is
wrong; exit status 1 then. It cannot judge what order the points of one column are drawn in.
"""
import csv
import math
import re
import sys
import xml.etree.ElementTree

SVG = "{http://www.w3.org/2000/svg}"
PREFIX = {"": 1.0, "m": 1e-3, "u": 1e-6, "n": 1e-9, "p": 1e-12}
UNITS = {"Force": "N", "Depth": "m", "Gap": "m", "Energy": "J", "Lateness": "s", "Time": "s"}
HALF = 0.051  # px: places are written in tenths

faults = []


def fault(text):
    faults.append(text)


def options(arguments):
    found, files = {"--dt": 1e-3, "--from": 0.0, "--to": math.inf}, []
    while arguments:
        word = arguments.pop(0)
        if word in found:
            found[word] = float(arguments.pop(0))
        else:
            files.append(word)
    return found, files


class Axis:
    """Value = slope * pixel + base, in SI units, from an axis' name and its labels."""

    def __init__(self, name, marks):
        self.name, unit = name.split(", ")
        assert unit.endswith(UNITS[self.name]), name
        scale = PREFIX[unit[: -len(UNITS[self.name])]]
        (pixel, first), (end, last) = marks[0], marks[-1]
        self.slope = (last - first) * scale / (end - pixel)
        self.base = first * scale - self.slope * pixel
        for at, label in marks:
            if abs(self.pixel(label * scale) - at) > 2 * HALF:
                fault(f"{name}: the mark {label} is not where it should be")

    def pixel(self, value):
        return (value - self.base) / self.slope


def strokes(path):
    """The stretches of a path, each a list of places."""
    stretches, at = [], (0.0, 0.0)
    for command, numbers in re.findall(r"([MLVh])([-0-9. ]*)", path):
        values = [float(number) for number in numbers.split()]
        if command == "M":
            stretches.append([])
        if command in "ML":
            at = (values[0], values[1])
        elif command == "V":
            at = (at[0], values[0])
        stretches[-1].append(at)
    return stretches


def texts(group):
    return [(float(t.get("x")), float(t.get("y")), t.get("text-anchor"), t.text) for t in group.iter(SVG + "text")]


def length(x, y, z):
    return math.hypot(x, y, z)


def number(row, name):
    text = row.get(name, "")
    return float(text) if text else math.nan


def rows_of_replay(rows, dt):
    first, before = int(rows[0]["tick"]), None
    for row in rows:
        tick = int(row["tick"])
        yield before is not None and tick != before + 1, (tick - first) * dt, {
            "Force": length(number(row, "fx"), number(row, "fy"), number(row, "fz")),
            "Depth": number(row, "depth"),
            "Gap": number(row, "gap"),
            "Energy": number(row, "energy"),
        }
        before = tick


def rows_of_record(rows):
    first, before = int(rows[0]["time_ns"]), None
    for row in rows:
        tick = int(row["number"])
        felt = int(row["flags"]) & 1
        gap = number(row, "gap") if felt and int(row["hit_flags"]) & 1 else math.nan
        yield before is not None and tick != before + 1, (int(row["time_ns"]) - first) * 1e-9, {
            "Force": length(*(number(row, "asked_f" + axis) for axis in "xyz")) if felt else math.nan,
            "Depth": math.nan if math.isnan(gap) else max(0.0, -gap),
            "Gap": gap,
            "Energy": number(row, "energy") if felt else math.nan,
            "Lateness": int(row["late_ns"]) * 1e-9,
        }
        before = tick


def read_run(name, wanted):
    rows = list(csv.DictReader(open(name)))
    ticks = rows_of_record(rows) if "time_ns" in rows[0] else rows_of_replay(rows, wanted["--dt"])
    return [tick for tick in ticks if wanted["--from"] <= tick[1] <= wanted["--to"]]


def columns_of(ticks, panel, x):
    """For each column of pixels: lowest and highest value, and whether every value in it is missing."""
    columns = {}
    for _, time, values in ticks:
        column = math.floor(x.pixel(time) + 1e-6)
        low, high, empty = columns.get(column, (math.inf, -math.inf, True))
        value = values.get(panel, math.nan)
        if math.isfinite(value):
            low, high, empty = min(low, value), max(high, value), False
        columns[column] = (low, high, empty)
    return columns


def compare(what, stretches, ticks, panel, x, y):
    columns = columns_of(ticks, panel, x)
    drawn = [place for stretch in stretches for place in stretch]
    known = [(time, values[panel]) for _, time, values in ticks if math.isfinite(values.get(panel, math.nan))]
    for time, value in (min(known, key=lambda p: p[1]), max(known, key=lambda p: p[1])):
        places = (x.pixel(time), y.pixel(value))
        if not any(abs(px - places[0]) <= 1.05 and abs(py - places[1]) <= HALF for px, py in drawn):
            fault(f"{what}: its extreme {value} at {time} s is not drawn")
    for column, (low, high, empty) in columns.items():
        if empty:
            continue
        near = [py for px, py in drawn if column - 1 <= px <= column + 2]
        if not near or max(near) < y.pixel(low) - HALF or min(near) > y.pixel(high) + HALF:
            fault(f"{what}: the values from {low} to {high} at {column} px are not drawn")
    for px, py in drawn:
        near = [columns[c] for c in range(math.floor(px) - 1, math.floor(px) + 2) if c in columns and not columns[c][2]]
        if not near or not any(y.pixel(high) - HALF <= py <= y.pixel(low) + HALF for low, high, _ in near):
            fault(f"{what}: nothing is at {px},{py}")
    for stretch in stretches:
        for (a, _), (b, _) in zip(stretch, stretch[1:]):
            if b < a:
                fault(f"{what}: the line goes back at {a}")
            inside = [columns[c] for c in range(math.ceil(a) + 1, math.floor(b) - 1) if c in columns]
            if len(inside) >= 3 and any(empty for _, _, empty in inside):
                fault(f"{what}: a gap between {a} and {b} is drawn over")
    jumps = [time for jump, time, _ in ticks if jump]
    for before, after in zip(ticks, ticks[1:]):
        if after[1] in jumps and x.pixel(after[1]) - x.pixel(before[1]) > 3.0:
            middle = (x.pixel(after[1]) + x.pixel(before[1])) / 2
            if any(a < middle < b for s in stretches for (a, _), (b, _) in zip(s, s[1:])):
                fault(f"{what}: the jump to {after[1]} s is drawn over")


def main():
    wanted, files = options(sys.argv[1:])
    chart = files.pop(0)
    text = open(chart, "rb").read()
    if len(text) > 300000:
        fault(f"{len(text)} bytes")
    root = xml.etree.ElementTree.fromstring(text)
    runs = [read_run(name, wanted) for name in files]
    groups = list(root.findall(SVG + "g"))
    marks = texts(groups.pop())
    x = Axis(marks.pop()[3], [(mark[0], float(mark[3])) for mark in marks])
    names = []
    for group in groups:
        marks = texts(group)
        y = Axis(marks.pop(0)[3], [(mark[1] - 4, float(mark[3])) for mark in marks])
        names.append(y.name)
        lines = [path for path in group.findall(SVG + "path") if path.get("stroke-linecap") == "round"]
        if len(lines) != len(runs):
            fault(f"{y.name}: {len(lines)} lines")
        if len({line.get("stroke") for line in lines}) != len(lines):
            fault(f"{y.name}: lines look the same")
        for name, line, ticks in zip(files, lines, runs):
            compare(f"{name}: {y.name}", strokes(line.get("d")), ticks, y.name, x, y)
    print(" ".join(names))
    print("title:", root.find(SVG + "title").text)
    for line in faults[:20]:
        print("wrong:", line)
    return bool(faults)


sys.exit(main())
