#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""figures.py: the figures of README.md, docs/performance.md and docs/comparison.md are those of their data files, each to
the digits shown; and so are rows of tables of docs/algorithms.

Whether a data file is what a machine measures it cannot say: `make figures`, `make soft-tables` and `make bench` write
them."""
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


def rows(file_name):
    with open(CHARTS / file_name, encoding="utf-8") as file:
        return list(csv.DictReader(file))


def told_rows():
    """Of physics that tells its compliance, the rows of a tool, its compliance and rate: docs/algorithms/deform.md."""
    found = {}
    for of in rows("soft-told.csv"):
        found[tuple(of[key] for key in ("tool", "ticks", "told", "foresees", "is_light", "late", "drops"))] = of

    def columns(tool, ticks, told):
        of = found[tool, ticks, told, "0", "0", "0", "0"]
        return [1e3 * float(of["hum"]), 1e3 * float(of["still_jump"]), float(of["ratio"]), 1e3 * float(of["work"])]

    def worst(late, foresees, told):
        chosen = [of for of in found.values() if of["ticks"] == "33" and of["is_light"] == "0" and (of["late"] != "0") == late
                  and of["foresees"] == foresees and of["told"] in told]

        def of_all(key):
            return [float(of[key]) for of in chosen]
        at_rest = [float(of["force"]) / float(found[of["tool"], "1", "1", "0", "0", "0", "0"]["force"]) for of in chosen]
        return [1e3 * max(of_all("hum")), 1e3 * max(of_all("still_jump")), min(at_rest), min(of_all("ratio")),
                max(of_all("ratio")), 1e3 * min(of_all("work")), 1e3 * min(of_all("late_work"))]
    ten, all_three = ("10",), ("1", "0.1", "10")
    return {
        "| a lying tool of 2.4 N, c | rate": {
            "| as each vertex has it | 1,000 Hz |": columns("lying", "1", "1"), "| | 500 Hz |": columns("lying", "2", "1"),
            "| | 100 Hz |": columns("lying", "10", "1"), "| | 30 Hz |": columns("lying", "33", "1"),
            "| a tenth of it | 30 Hz |": columns("lying", "33", "0.1"),
            "| ten times as much | 30 Hz |": columns("lying", "33", "10")},
        "| a ball of 1.3 N, as each vertex has it |": {
            "| a ball of 1.3 N, as each vertex has it | 1,000 Hz |": columns("ball", "1", "1"),
            "| | 100 Hz |": columns("ball", "10", "1"), "| | 30 Hz |": columns("ball", "33", "1"),
            "| ten times as much | 30 Hz |": columns("ball", "33", "10")},
        "| 30 Hz | hum, mN": {
            "| in time, c as it is or a tenth |": worst(False, "0", ("1", "0.1")),
            "| in time, ten times as much |": worst(False, "0", ten),
            "| late or lost, c as it is or a tenth |": worst(True, "0", ("1", "0.1")),
            "| late or lost, ten times as much |": worst(True, "0", ten),
            "| late or lost, with [foresight](#physics-that-looks-a-step-ahead), all three |": worst(True, "1", all_three)}}


def physics_rows():
    """Of run --physics: hum and force in mN; and the force at 2 Hz."""
    still, moving = {}, {}
    for of in rows("soft-physics.csv"):
        name = f"| {of['body']}, {of['integrator'].upper()} |"
        still.setdefault(name, []).extend((1e3 * float(of["hum"]), 1e3 * float(of["force"])))
        if of["at_2_hz"] and of["rate"] != "0":
            moving.setdefault(name, []).append(float(of["at_2_hz"]))
    return {"| a still hand, 600 N/m asked: hum, mN (force, mN)": still, "| force at 2 Hz, of that in each tick": moving}


def block_rows():
    """Of blocks that are indented: docs/algorithms/springs.md."""
    indent = {f"| {of['cell_mm']} mm |": [float(of[key]) for key in ("from_alike", "from_limit", "in_by_5", "from_045")]
              for of in rows("soft-indent.csv")}
    poisson = {f"| {of['poisson']} |": [float(of[key]) for key in ("5", "2.5", "bulge", "force")]
               for of in rows("soft-poisson.csv")}
    asleep, phases = {}, {"press": "press 5 mm in", "hold": "hold still for 1.5 s", "tremor": "tremble, 0.05 mm",
                          "2 Hz": "2 mm up and down at 2 Hz", "slide": "slide", "leave": "leave", "gone": "gone for 1.7 s",
                          "all": "all"}
    for of in rows("soft-liver.csv"):
        if of["subject"] in ("symplectic", "implicit") and of["phase"] in phases:
            asleep.setdefault(f"| {phases[of['phase']]} |", []).extend((100 * float(of["awake"]), 100 * float(of["off"])))
    return {"| cells | small strains: from cubes as large": indent, "| nu | 5 mm | 2.5 mm |": poisson,
            "| | awake | off | implicit: awake | off |": asleep}


TABLES = {"docs/algorithms/deform.md": (told_rows, physics_rows), "docs/algorithms/springs.md": (block_rows,)}
NUMBER = re.compile(r"(?<![\w.,])[-+]?\d+(?:\.\d+)?")


def check_tables():
    """Each row of these tables has the numbers of its data, in their order. Returns how many are right, and wrong."""
    right = wrong = 0
    for page, tables in TABLES.items():
        lines = (ROOT / page).read_text(encoding="utf-8").split("\n")
        for header, table in (item for of in tables for item in of().items()):
            begin = next((i for i, line in enumerate(lines) if line.startswith(header)), len(lines))
            for start, expected in table.items():
                line = next((line for line in lines[begin:] if line.startswith(start)), "")
                shown = NUMBER.findall(line[len(start):])
                is_right = len(shown) == len(expected) and all(map(is_shown, shown, expected))
                right, wrong = right + is_right, wrong + (not is_right)
                if not is_right:
                    print(f"  FAIL {page}, {header} ... {start}: {line[len(start):]} where the data have "
                          f"{', '.join(f'{value:.5g}' for value in expected)}")
    print(f"  {'FAIL' if wrong else 'ok  '} rows of tables of docs/algorithms: {right} right, {wrong} not")
    return right, wrong


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
    rows_right, rows_wrong = check_tables()
    count = sum(map(len, FIGURES.values())) + rows_right + rows_wrong
    wrong += rows_wrong
    print(f"{count - wrong} passed, {wrong} failed, 0 skipped")
    return wrong > 0


sys.exit(main())
