#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Read a picture of dynpoint chart back by its own axes, and compare it with the CSV beside it.

read_chart.py NAME      reads NAME.svg and NAME.csv

Each row that got through the trace has one mark in the panel of its part, at its median, with a line to its 99 %, and as high
as its error, or in the band; the frontier goes through the marks that nothing beats, and no others; names, and numbers
in their place, cover neither marks nor lines nor each other. Prints the panels with their marks, and what is wrong; exit status 1 then.
"""
import csv
import re
import sys
import xml.etree.ElementTree

SVG = "{http://www.w3.org/2000/svg}"
PREFIX = {"": 1.0, "m": 1e-3, "u": 1e-6, "n": 1e-9, "p": 1e-12, "f": 1e-15, "a": 1e-18}
CLOSE = 1.5  # px: the CSV has four digits, a picture tenths of a pixel
ERRORS = {  # by how a panel's name begins and ends
    ("Nearest pair", ""): ("pair", lambda row: float(row["distance_error_m"])),
    ("Contact", ""): (
        "contact", lambda row: 100.0 * sum(int(row[k]) for k in ("missed", "invented", "unknown")) / int(row["ticks"])),
    ("Force", "apart"): ("force", lambda row: float(row["wrench_max_N"])),
    ("Force", "tick"): ("force", lambda row: float(row["jump_N"])),
}
faults = []


def fault(text):
    faults.append(text)


def value_of(label):
    number, unit = label.split(" ")
    prefix = "" if unit == "%" else unit[:-1]
    return float(number) * PREFIX[prefix]


class LogAxis:
    """Value = first * ratio ** (pixels from the first mark)."""

    def __init__(self, marks):
        import math

        self.log = math.log10
        (self.at0, first), (at1, last) = marks[0], marks[-1]
        self.low = self.log(value_of(first))
        self.slope = (at1 - self.at0) / (self.log(value_of(last)) - self.low)
        for at, label in marks:
            if abs(self.pixel(value_of(label)) - at) > 0.2:
                fault(f"the mark {label} is not where it should be")

    def pixel(self, value):
        return self.at0 + self.slope * (self.log(value) - self.low)


def numbers(path):
    return [float(number) for number in re.findall(r"-?\d+(?:\.\d+)?", path)]


def texts(panel, anchor):
    found = [(float(t.get("x")), float(t.get("y")), t.text or "") for t in panel.findall(SVG + "text")
             if t.get("text-anchor") == anchor]
    return [text for text in found if re.match(r"^[\d.e+-]+ \S+$", text[2])]


def centre(shape):
    """The middle of a mark from its path."""
    d = shape.get("d")
    at = numbers(d)
    if "a5" in d:
        return at[0] + 5, at[1]
    if "h9v9" in d:
        return at[0] + 4.5, at[1] + 4.5
    if "l8 8m" in d:
        return at[0] + 4, at[1] + 4
    if d.count("L") == 3:
        return at[0], at[1] + 6.5
    return at[0], at[1] + 6


def boxes_meet(a, b):
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]


def segment_meets(box, x0, y0, x1, y1):
    steps = 40
    return any(box[0] < x0 + (x1 - x0) * i / steps < box[2] and box[1] < y0 + (y1 - y0) * i / steps < box[3]
               for i in range(steps + 1))


def read_panel(panel, rows):
    name = "".join(panel.find(SVG + "text").itertext())
    part, error_of = next(ERRORS[key] for key in ERRORS if name.startswith(key[0]) and name.endswith(key[1]))
    rows = {row["name"]: row for row in rows if row["part"] == part and not row["failure"]
            and (part != "pair" or row["distance_error_m"])}
    bottom = max(y for _, y, _ in texts(panel, "middle"))
    x_axis = LogAxis([(x, text) for x, y, text in texts(panel, "middle") if y == bottom])
    y_marks = [(y - 4, text) for x, y, text in texts(panel, "end")]
    y_axis = LogAxis(y_marks) if len(y_marks) > 1 else None
    band = next((p for p in panel.findall(SVG + "path") if p.get("class") == "band"), None)
    band_top = numbers(band.get("d"))[1] if band is not None else 1e9
    taken, lines, places, seen = [], [], {}, []
    for mark in (g for g in panel.findall(SVG + "g") if g.get("class") == "mark"):
        label = mark.find(SVG + "title").text.split(":")[0]
        paths = [p for p in mark.findall(SVG + "path") if p.get("class") != "range"]
        bars = [numbers(p.get("d")) for p in mark.findall(SVG + "path") if p.get("class") == "range"]
        x, y = centre(paths[-1])
        seen.append(label)
        taken.append((x - 5, y - 5, x + 5, y + 5))
        if label not in rows:
            fault(f"{name} {label}: there is no such row")
            continue
        row, error = rows[label], error_of(rows[label])
        places[label] = (x, y)
        if abs(x - x_axis.pixel(1e-6 * float(row["whole_median_us"]))) > CLOSE:
            fault(f"{name} {label}: at {x}, not at its median")
        check_ranges(name + " " + label, row, bars, x_axis)
        lines += [(bar[0], bar[1], bar[2], bar[1]) for bar in bars]
        if len(paths) == 2:
            line = numbers(paths[0].get("d"))
            if abs(line[2] - x_axis.pixel(1e-6 * float(row["whole_p99_us"]))) > CLOSE:
                fault(f"{name} {label}: its line does not end at the 99 %")
            lines.append((line[0], line[1], line[2], line[1]))
        elif float(row["whole_p99_us"]) > 1.02 * float(row["whole_median_us"]):
            fault(f"{name} {label}: no line to the 99 %")
        if y < band_top and (not y_axis or abs(y - y_axis.pixel(error)) > CLOSE):
            fault(f"{name} {label}: at height {y}, not at its error {error}")
        if y > band_top and error > 1e-3:
            fault(f"{name} {label}: in the band with an error of {error}")
    expected = [label for label in rows if not (band is None and error_of(rows[label]) == 0.0)]
    if sorted(seen) != sorted(expected):
        fault(f"{name} marks {sorted(seen)}, rows {sorted(expected)}")
    check_frontier(panel, name, places, band_top)
    check_names(panel, name, taken, lines)
    return f"{name.split(':')[0]} {len(seen)}"


def check_ranges(name, row, bars, x_axis):
    """A bar for the median and one for the 99 %, each from the least of the repeats to the largest."""
    ends = [[1e-6 * float(row[f"whole_{of}_{end}_us"]) for end in ("least", "most")] for of in ("median", "p99")]
    clear = [[x_axis.pixel(value) for value in pair] for pair in ends if pair[1] > 1.002 * pair[0]]
    for pair in clear:
        if not any(abs(bar[0] - pair[0]) < CLOSE and abs(bar[2] - pair[1]) < CLOSE for bar in bars):
            fault(f"{name}: no bar from {pair[0]} to {pair[1]}")
    if len(bars) > sum(pair[1] > pair[0] for pair in ends):
        fault(f"{name}: {len(bars)} bars")


def check_frontier(panel, name, places, band_top):
    """Its corners are marks; none of them is beaten, and each mark that is clearly not beaten is one. All in the band are
    equal. A tenth of a pixel decides nothing."""
    path = next(p for p in panel.findall(SVG + "path") if p.get("class") == "frontier")
    at = numbers(path.get("d"))[2:]
    corners = list(zip(at[0::2], at[1::2]))
    marks = [(x, y, band_top + 1 if y > band_top else y) for x, y in places.values()]
    for x, y in corners:
        mark = next((m for m in marks if abs(m[0] - x) < 0.2 and abs(m[1] - y) < 0.2), None)
        if not mark:
            fault(f"{name} a corner of the frontier at {x}, {y} is no mark")
        elif any(m[0] < mark[0] - 0.2 and m[2] > mark[2] + 0.2 for m in marks):
            fault(f"{name} the frontier's corner at {x}, {y} is beaten")
    for mark in marks:
        others = [m for m in marks if m is not mark]
        is_best = not any(m[0] <= mark[0] + 0.2 and m[2] >= mark[2] - 0.2 for m in others)
        if is_best and not any(abs(x - mark[0]) < 0.2 and abs(y - mark[1]) < 0.2 for x, y in corners):
            fault(f"{name} the mark at {mark[0]}, {mark[1]} is not on the frontier")


def check_names(panel, name, taken, lines):
    """Names, and numbers in their place, cover nothing; each number has its mark's name below the axis, once."""
    boxes, texts_of = [], {"name": [], "number": [], "key": []}
    for group in (g for g in panel.findall(SVG + "g") if g.get("class") in texts_of):
        text = group.find(SVG + "text")
        texts_of[group.get("class")].append(text.text)
        x, y = float(text.get("x")), float(text.get("y"))
        box = (x, y - 9, x + 0.5 * 12 * len(text.text), y)
        boxes.append(box)
        for mark in taken:
            if boxes_meet(box, mark):
                fault(f"{name} the name {text.text} covers a mark")
        for line in lines:
            if segment_meets(box, *line):
                fault(f"{name} the name {text.text} covers a line")
        if box[0] < 76 or box[2] > 760:
            fault(f"{name} the name {text.text} is cut off")
    for i, a in enumerate(boxes):
        for b in boxes[:i]:
            if boxes_meet(a, b):
                fault(f"{name} names cover each other")
    keys = [text.split(" ", 1) for text in texts_of["key"]]
    titles = {g.find(SVG + "title").text.split(":")[0] for g in panel.findall(SVG + "g") if g.get("class") == "mark"}
    if [number for number, _ in keys] != [str(i + 1) for i in range(len(keys))] or texts_of["number"] != [n for n, _ in keys]:
        fault(f"{name} numbers {texts_of['number']}, keys {keys}")
    if not {key for _, key in keys} <= titles - set(texts_of["name"]):
        fault(f"{name} keys {keys} are of marks that have names, or of none")
    if 2 * len(texts_of["name"]) < len(taken) and "jump" not in name:
        fault(f"{name} only {len(texts_of['name'])} of {len(taken)} marks have a name beside them")


def main():
    root = xml.etree.ElementTree.parse(sys.argv[1] + ".svg").getroot()
    with open(sys.argv[1] + ".csv", encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    panels = [g for g in root.findall(SVG + "g") if g.get("class") == "panel"]
    parts = {row["part"] for row in rows if not row["failure"]}
    if len(panels) != len(parts) + ("force" in parts):
        fault(f"{len(panels)} panels of the parts {sorted(parts)}")
    told = [read_panel(panel, rows) for panel in panels]
    print(", ".join(told))
    for text in faults:
        print("fault:", text)
    return 1 if faults else 0


sys.exit(main())
