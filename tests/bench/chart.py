#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""make charts: draw docs/charts/*.svg and their data from the bench's results. Standard library only.

chart.py RESULTS.csv OUT_DIR
"""
import csv
import math
import sys

STYLE = {
    ("FCL", "OBBRSS"): ("FCL, OBBRSS, warm", "#b03a2e", "6 4"),
    ("tree", "scalar"): ("tree, scalar", "#95a5a6", ""),
    ("tree", "sse2"): ("tree, SSE2", "#7fb3d5", ""),
    ("tree", "avx2"): ("tree, AVX2", "#2e86c1", ""),
    ("tree", "avx512"): ("tree, AVX-512", "#154360", ""),
    ("tree", "neon"): ("tree, NEON", "#117864", ""),
}
WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 760, 420, 70, 170, 50, 60


class Axis:
    """A logarithmic axis from decade parts 1, 2, 5 below the least to above the largest value."""

    def __init__(self, values, start, end):
        low, high = min(values), max(values)
        marks = [m * 10**e for e in range(-3, 9) for m in (1, 2, 5)]
        self.low = max(m for m in marks if m <= low)
        self.high = min(m for m in marks if m >= high)
        self.marks = [m for m in marks if self.low <= m <= self.high]
        self.start, self.end = start, end

    def at(self, value):
        share = math.log(value / self.low) / math.log(self.high / self.low)
        return self.start + share * (self.end - self.start)


def text(x, y, content, anchor="middle", size=13, extra=""):
    return (f'<text x="{x:.1f}" y="{y:.1f}" font-size="{size}" text-anchor="{anchor}" {extra}>'
            f"{content}</text>")


def draw(rows, title, subtitle):
    """Median (line) and 99 % (thin line above it) over triangles, per method."""
    x = Axis([r["triangles"] for r in rows], LEFT, WIDTH - RIGHT)
    y = Axis([r["median"] for r in rows] + [r["p99"] for r in rows], HEIGHT - BOTTOM, TOP)
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
        out.append(text(x.at(mark), HEIGHT - BOTTOM + 20, f"{mark:,}"))
    out.append(text((LEFT + WIDTH - RIGHT) / 2, HEIGHT - 16, "triangles"))
    out.append(text(18, HEIGHT / 2, "microseconds a tick", extra=f'transform="rotate(-90 18 {HEIGHT / 2})"'))
    labels = []
    for key, (name, colour, dash) in STYLE.items():
        line = sorted((r for r in rows if r["key"] == key), key=lambda r: r["triangles"])
        if not line:
            continue
        for column, width in (("median", 2.5), ("p99", 0.9)):
            points = " ".join(f"{x.at(r['triangles']):.1f},{y.at(r[column]):.1f}" for r in line)
            out.append(f'<polyline points="{points}" fill="none" stroke="{colour}" '
                       f'stroke-width="{width}" stroke-dasharray="{dash}"/>')
        for r in line:
            out.append(f'<circle cx="{x.at(r["triangles"]):.1f}" cy="{y.at(r["median"]):.1f}" r="3" '
                       f'fill="{colour}"/>')
        labels.append([y.at(line[-1]["median"]), name, colour])
    labels.sort()
    for previous, label in zip(labels, labels[1:]):
        label[0] = max(label[0], previous[0] + 16)
    for height, name, colour in labels:
        out.append(text(WIDTH - RIGHT + 8, height + 4, name, "start", 13, f'fill="{colour}"'))
    out.append("</svg>")
    return "\n".join(out) + "\n"


def main(results, folder):
    with open(results, newline="", encoding="utf-8") as file:
        table = list(csv.DictReader(file))
    rows = []
    for record in table:
        if record["mesh"].startswith("torus"):
            rows.append({"key": (record["method"], record["kernel"]),
                         "triangles": int(record["triangles"]),
                         "median": float(record["other_median"]) / 1e3,
                         "p99": float(record["other_p99"]) / 1e3})
    if not rows:
        sys.exit("chart.py: no torus in " + results)
    with open(folder + "/tick-time.svg", "w", encoding="utf-8") as file:
        file.write(draw(rows, "Exact nearest pair of a sliding tool and a torus",
                        "Ticks whose axis does not cross. Thick: median; thin: 99 %. Answers within "
                        "rounding of brute force."))
    with open(folder + "/tick-time.csv", "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, table[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows(table)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2])
