#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""soft_tables.py BUILD FOLDER [NAME ...]: what docs/algorithms/springs.md and deform.md say in tables, measured anew, as CSV
in FOLDER (docs/charts); `make soft-tables` does that. A name makes that one alone. tests/docs/figures.py holds the pages to
them. None of these figures is a time: each machine and kernel finds the same.

    soft-indent    the indented block                        46 s of a processor
    soft-poisson   blocks of another Poisson's ratio         30 s
    soft-told      physics that tells its compliance         20 s
    soft-physics   run --physics by each integrator          90 s
"""
import csv
import io
import json
import math
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
QUARTER = [0.70710678118654752, -0.70710678118654752, 0, 0]


def said(*command):
    return subprocess.run([str(part) for part in command], check=True, capture_output=True, text=True).stdout


def indent(build):
    found = re.findall(r"lattice of ([0-9.]+) mm.*off by ([-+0-9.]+) %.*, ([-+0-9.]+) % from their limit; "
                       r"in by 5 % [0-9.]+ N/m, ([-+0-9.]+) %, and ([-+0-9.]+) %", said(build / "tests/test_springs_indent", "all"))
    return ["cell_mm", "from_alike", "from_limit", "in_by_5", "from_045"], found


def poisson(build):
    text, rows = said(build / "tests/test_springs_poisson", "all"), {}
    for ratio, cell, off in re.findall(r"([0-9.]+), cells of ([0-9.]+) mm: .*: ([-+0-9.]+) %", text):
        rows.setdefault(ratio, {})[cell] = off
    for ratio, bulge, force in re.findall(r"([0-9.]+): bulges by .*: ([-+0-9.]+) %; .*, ([-+0-9.]+) %", text):
        rows[ratio].update(bulge=bulge, force=force)
    return ["poisson", "5", "2.5", "bulge", "force"], [(ratio, *(row[key] for key in ("5", "2.5", "bulge", "force")))
                                                       for ratio, row in rows.items()]


def told(build):
    header, *rows = csv.reader(io.StringIO(said(build / "tests/test_own_compliance", "table")))
    return header, rows


def boxes(size, edge, corners):
    if corners:
        return [{"box": [x - edge, y - edge, -0.1, x + edge, y + edge, 0.1], "fixed": True}
                for x in (-size, size) for y in (-size, size)]
    far = size + edge
    return [{"box": box, "fixed": True} for box in ([-far, -far, -edge, -size, far, edge], [size, -far, -edge, far, far, edge],
                                                    [-far, -far, -edge, far, -size, edge], [-far, size, -edge, far, far, edge])]


def scene(body, integrator):
    """The scenes membrane, cloth and laparoscopy, with that integrator, and loads that are spread in each tick as well."""
    if body == "liver":
        made = json.loads((ROOT / "docs/samples/scene.json").read_text(encoding="utf-8"))
        made["bodies"][0]["physics"] = {"integrator": integrator, "load_radius": 0.02}
        return made
    is_cloth = body == "cloth"
    material = {"kind": "sheet", "young": 1e5, "thickness": 1e-3, "density": 400 if is_cloth else 1000, "drag": 10,
                "viscosity": 1e-4 if is_cloth else 1e-3, "regions": boxes(0.15 if is_cloth else 0.0999, 0.01, is_cloth)}
    physics = {"integrator": integrator, "load_radius": 0.02 if is_cloth else 0.0375}
    return {"bodies": [{"shape": body, "triangles": 2048 if is_cloth else 512, "orientation": QUARTER, "material": material,
                        "physics": physics | ({"sleep_speed": 0.01} if is_cloth else {})}],
            "gravity": 9.81 if is_cloth else 0, "tool": {"length": 0.2 if is_cloth else 0.1, "radius": 0.004 if is_cloth else
                                                         0.002, "law": "proxy"},
            "device": {"url": "sim:?hand=press", "origin": [0, -0.02, -0.1] if is_cloth else [0, 0.007, -0.05]}}


def forces(build, work, file, hand, ticks, rate, *options):
    record = work / "run.dpr"
    said(build / "dynpoint", "run", file, "--device", f"sim:?hand={hand}", "--ticks", ticks, "--record", record, *options,
         *(["--physics", rate] if rate else []))
    rows = csv.DictReader(io.StringIO(said(build / "dynpoint", "record", "csv", record, "-o", "-")))
    return [math.hypot(*(float(row[f"asked_f{axis}"]) for axis in "xyz")) for row in rows]


def hum(force, first=1300, window=51):
    """N: the largest rms about a line; and the mean force."""
    force, most = force[first:], 0.0
    middle = window // 2
    spread = sum((i - middle) ** 2 for i in range(window))
    for at in range(0, len(force) - window + 1, window):
        part = force[at:at + window]
        mean, slope = sum(part) / window, sum((i - middle) * f for i, f in enumerate(part)) / spread
        most = max(most, math.sqrt(sum((f - mean - slope * (i - middle)) ** 2 for i, f in enumerate(part)) / window))
    return most, sum(force) / len(force)


def swing(force, first=2000, count=1000):
    turn = 2 * math.pi * 2e-3
    return math.hypot(sum(force[first + i] * math.sin(turn * i) for i in range(count)),
                      sum(force[first + i] * math.cos(turn * i) for i in range(count))) * 2 / count


def physics(build):
    work = build / "bench"
    work.mkdir(parents=True, exist_ok=True)
    still, moving, rows = work / "still.csv", work / "moving.csv", []
    still.write_text("t,x,y,z\n0,0,0,0\n0.5,0,-0.025,0\n", encoding="ascii")
    moving.write_text("t,x,y,z\n0,0,0,0\n0.5,0,-0.02,0\n" + "".join(
        f"{1 + t:g},0,{-0.02 - 0.004 * math.sin(4 * math.pi * t):.8g},0\n" for t in (0.004 * i for i in range(1, 501))),
        encoding="ascii")
    for body in ("membrane", "cloth", "liver"):
        for integrator in ("symplectic", "euler", "implicit"):
            file, base = work / f"{body}-{integrator}.json", {}
            file.write_text(json.dumps(scene(body, integrator)), encoding="ascii")
            for rate, stiffness in ((0, 80), (1000, 80), (500, 80), (100, 80), (0, 10), (31.25, 10)):
                noise, mean = hum(forces(build, work, file, still, 2000, rate, "--stiffness", 600)) if stiffness > 10 or rate \
                    else ("", "")
                amplitude = swing(forces(build, work, file, moving, 3000, rate, "--stiffness", stiffness, "--unstable",
                                         "--active")) if body != "cloth" else ""
                if body != "cloth":
                    base.setdefault(stiffness, amplitude)
                if noise != "":
                    rows.append((body, integrator, rate, f"{mean:.4g}", f"{noise:.3g}", "" if body == "cloth" else stiffness,
                                 "" if body == "cloth" else f"{amplitude / base[stiffness]:.4f}"))
    return ["body", "integrator", "rate", "force", "hum", "stiffness", "at_2_hz"], rows


TABLES = {"soft-indent": indent, "soft-poisson": poisson, "soft-told": told, "soft-physics": physics}


def main():
    build, folder = Path(sys.argv[1]), Path(sys.argv[2])
    for name in sys.argv[3:] or TABLES:
        header, rows = TABLES[name](build)
        if not rows:
            sys.exit(f"{name}: there are no rows")
        with open(folder / f"{name}.csv", "w", encoding="ascii", newline="") as file:
            table = csv.writer(file, lineterminator="\n")
            table.writerow(header)
            table.writerows(rows)
        print(f"{folder / name}.csv: {len(rows)} rows", flush=True)


main()
