#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""figures.py: the figures of README.md, docs/performance.md and docs/comparison.md are those of their data files, each to
the digits shown.

Whether a data file is what a machine measures it cannot say: `make figures` and `make bench` write them."""
import csv
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
CHARTS = ROOT / "docs/charts"


def row(file_name, **where):
    with open(CHARTS / file_name, encoding="utf-8") as file:
        return next(row for row in csv.DictReader(file) if all(row[key] == value for key, value in where.items()))


def pair(found, median, p99):
    return float(found[median]), float(found[p99])


TICK = "default-tick.csv"
PAIR = {"mesh": "liver", "part": "pair"}
# What a line of the table says, and where its two figures come from.
FIGURES = {
    "README.md": {
        "a line of 0.26 m slides": pair(row(TICK, subject="demo"), "median_us", "p99_us"),
        "a ball of 1 mm wipes it": pair(row(TICK, subject="ball wipe"), "median_us", "p99_us"),
        "the exact nearest pair": pair(row("meshes.csv", name="exact", **PAIR), "other_median_us", "other_p99_us"),
        "the same with FCL": pair(row("meshes.csv", name="fcl", **PAIR), "other_median_us", "other_p99_us"),
        "soft, a tool in it": pair(row("soft-liver.csv", subject="symplectic", phase="all"), "tick_us", "tick_99_us"),
    },
    "docs/performance.md": {
        "nearest pair of a line": pair(row("meshes.csv", name="exact", **PAIR), "other_median_us", "other_p99_us"),
        "default tick, a ball of 1 mm at rest": pair(row(TICK, subject="ball rest"), "median_us", "p99_us"),
        "a ball that wipes it": pair(row(TICK, subject="ball wipe"), "median_us", "p99_us"),
        "default tick, a line of 0.1 m at rest": pair(row(TICK, subject="line rest"), "median_us", "p99_us"),
        "a line that wipes it |": pair(row(TICK, subject="line wipe"), "median_us", "p99_us"),
        "a line that wipes it at 1 m/s": pair(row(TICK, subject="line fast"), "median_us", "p99_us"),
        "soft liver, a tool in it": pair(row("soft-liver.csv", subject="symplectic", phase="all"), "tick_us", "tick_99_us"),
    },
    "docs/comparison.md": {
        "nearest pair of a line": pair(row("meshes.csv", name="exact", **PAIR), "other_median_us", "other_p99_us"),
        "proxy and force of a ball": (8.2, 34),
    },
}


def is_shown(text, value):
    """Whether value, rounded to the digits of text, is text."""
    digits = len(text.partition(".")[2])
    return abs(float(text) - value) <= 0.5001 * 10 ** -digits


def main():
    wrong = 0
    for page, figures in FIGURES.items():
        lines = (ROOT / page).read_text(encoding="utf-8").split("\n")
        for start, expected in figures.items():
            line = next((line for line in lines if line.startswith(f"| {start}")), "")
            shown = re.search(r"\| ([0-9.]+) / ([0-9.]+)", line)
            right = shown and all(is_shown(text, value) for text, value in zip(shown.groups(), expected))
            wrong += not right
            print(f"  {'ok  ' if right else 'FAIL'} {page}, {start}: {line.strip()[-80:] if not right else shown.group()[2:]}"
                  + ("" if right else f", where the data have {expected[0]:g} / {expected[1]:g}"))
    count = sum(map(len, FIGURES.values()))
    print(f"{count - wrong} passed, {wrong} failed, 0 skipped")
    return wrong > 0


sys.exit(main())
