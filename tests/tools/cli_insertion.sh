#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# dynpoint make trace --insert: a hand inserts a needle, pauses and withdraws, twice; and the three terms of Okamura, Simone
# and O'Leary (2004), the toughness's share and friction, read off a recording of it by lines through points, within 2 %
# of what the scene says. `sh tests/tools/cli_insertion.sh BUILD`.
. "$(dirname "$0")/cli.sh"

succeeds 'a box' make box 12 -o box.obj
succeeds 'compiled' compile box.obj -o box.dpa
succeeds 'a trace' make trace --insert --mesh box.dpa -o insert.csv
succeeds 'a trace again' make trace --insert --mesh box.dpa -o again.csv
check 'a seed gives the same bytes' cmp -s insert.csv again.csv
succeeds 'another seed' make trace --insert --mesh box.dpa --seed 2 -o other.csv
check 'the seed is not used' test "$(sed -n 2p other.csv)" != "$(sed -n 2p insert.csv)"
succeeds 'with sizes' make trace --insert --mesh box.dpa --length 0.07 --depth 0.02 --speed 0.05 --ticks 1500 -o sized.csv
refuses 'a band' --band make trace --insert --mesh box.dpa --band 0.01 -o none.csv
refuses 'a depth of a tool that slides' --depth make trace --mesh box.dpa --depth 0.01 -o none.csv
refuses 'a speed at which it never arrives' '--speed: at 1e-300 m/s' make trace --insert --mesh box.dpa --speed 1e-300 -o none.csv

cat >sized.py <<'END'
rows = [[float(cell) for cell in line.split(",")] for line in open("sized.csv").read().splitlines()[1:]]
tips = [row[3] for row in rows]
steps = [b - a for a, b in zip(tips, tips[1:])]
assert len(rows) == 1500 and all(abs(row[6] - row[3] - 0.07) < 1e-12 for row in rows), "its length"
assert abs(max(tips) - min(tips) - 0.025) < 1e-12, "a quarter of its depth above, and its depth below"
assert abs(max(map(abs, steps)) - 5e-5) < 1e-12, "its speed"
assert all(abs(b - a) < 1.01e-6 for a, b in zip(steps, steps[1:])), "it jerks"
still = [tip for tip in tips if tip == min(tips)]
assert 495 <= len(still) <= 505, "a pause of %d ticks" % len(still)
END
check 'depth, speed, length and pause are those asked for' python3 sized.py

cp "$tests/../docs/samples/insertion.json" .
run run insertion.json --ticks 1
if grep -q 'this build reads no scene files' stderr; then
    skip "a recorded insertion: no jansson"
    finish
fi
ticks=$(($(wc -l <insert.csv) - 1))
succeeds 'a run' run insertion.json --active --stiffness 1000 --unstable --ticks "$ticks" --record insert.dpr
succeeds 'as a table' record csv insert.dpr -o felt.csv

cat >terms.py <<'END'
import csv, sys

STIFFNESS, SURFACE, PUNCTURE, CUTTING, FRICTION, VISCOSITY = 1000, 1500, 1.5, 0.4, 30, 5

rows = list(csv.DictReader(open("felt.csv")))
first, second = rows[: len(rows) // 2], rows[len(rows) // 2 :]
number = lambda row, name: float(row[name])
force = lambda row: number(row, "asked_fz")
speed = max(abs(number(row, "vz")) for row in rows)
deepest = max(number(row, "depth") for row in rows)
going = lambda row, way: number(row, "vz") * way > 0.999 * speed
middle = lambda row: 0.3 * deepest < number(row, "depth") < 0.8 * deepest

def line(points):
    n, sx, sy = len(points), sum(x for x, y in points), sum(y for x, y in points)
    slope = (n * sum(x * y for x, y in points) - sx * sy) / (n * sum(x * x for x, y in points) - sx * sx)
    return slope, (sy - slope * sx) / n

def near(what, found, wanted):
    print("%s: %.5g, %.5g in the scene" % (what, found, wanted))
    assert abs(found - wanted) <= 0.02 * abs(wanted), what

pressed = [(-number(row, "z"), force(row)) for row in first if row["ruptures"] == "0" and force(row) > 0.1 and going(row, -1)]
along = {}
for name, half, way in (("in", first, -1), ("out", first, 1), ("again", second, -1)):
    along[name] = line([(number(row, "inside"), force(row)) for row in half if middle(row) and going(row, way)])
near("the stiffness before puncture, N/m", line(pressed)[0], STIFFNESS * SURFACE / (STIFFNESS + SURFACE))
near("the puncture force, N", max(map(force, first)), PUNCTURE)
near("friction by length, going in, N/m", along["in"][0], FRICTION + VISCOSITY * speed)
near("friction by length, coming out, N/m", -along["out"][0], FRICTION + VISCOSITY * speed)
near("the cutting force, N", along["in"][1], CUTTING)
at = 0.5 * deepest
near("the cutting force by two insertions at one depth, N", sum(a * b for a, b in zip(along["in"], (at, 1))) -
     sum(a * b for a, b in zip(along["again"], (at, 1))), CUTTING)
assert [row["ruptures"] for row in rows].count("1") > 1000 and {row["ruptures"] for row in rows} == {"0", "1"}
flagged = [i for i, row in enumerate(first) if int(row["force_flags"]) & 512]
opened = next(i for i, row in enumerate(first) if row["ruptures"] == "1")
assert flagged and flagged[0] == opened, "the rupture is flagged where the wall opens"
assert not any(int(row["force_flags"]) & 512 for row in second), "the hole is there already"
END
check "the terms: $(python3 terms.py 2>&1)" python3 terms.py

# A soft ball of which one side has a law of its own: its two terms, off the recording.
cat >soft.json <<'END'
{
  "bodies": [
    {
      "mesh": "ball.dpa",
      "surface": {
        "puncture_force": 5,
        "shaft_friction": 90,
        "regions": [
          { "box": [-1, -1, 0, 1, 1, 1], "puncture_force": 0.4, "cutting_force": 0.2, "shaft_friction": 20 }
        ]
      },
      "physics": { "integrator": "implicit" }
    }
  ],
  "tool": { "length": 0.1, "radius": 0.0006, "piercing": "a" },
  "device": { "url": "replay:into.csv", "origin": [0, 0, 0], "zoom": 1, "force_scale": 1 }
}
END
cat >law.py <<'END'
import csv

rows = list(csv.DictReader(open("soft.csv")))
force = lambda row: sum(float(row["asked_f" + axis]) ** 2 for axis in "xyz") ** 0.5
deepest = max(float(row["inside"]) for row in rows)
end = next(i for i, row in enumerate(rows) if float(row["inside"]) == deepest)
points = [(float(row["inside"]), force(row)) for row in rows[:end] if 0.3 * deepest < float(row["inside"]) < 0.8 * deepest]
n, sx, sy = len(points), sum(x for x, y in points), sum(y for x, y in points)
slope = (n * sum(x * y for x, y in points) - sx * sy) / (n * sum(x * x for x, y in points) - sx * sx)
cut = (sy - slope * sx) / n
print("%.4g N/m and %.4g N" % (slope, cut))
assert n > 300 and deepest > 0.02 and abs(slope - 20) < 0.4 and abs(cut - 0.2) < 0.01
before = max(force(row) for row in rows if row["ruptures"] == "0")
assert 0.4 <= before < 0.43, "it ruptures at %.4g N" % before
END
echo 'box -1 -1 -1 1 1 -0.05 fixed' >held.txt
succeeds 'a ball' make sphere 512 -o ball.obj
succeeds 'a soft one' compile ball.obj -o ball.dpa --springs volume --young 8000 --spacing 0.012 --regions held.txt
succeeds 'its trace' make trace --insert --mesh ball.dpa -o into.csv
succeeds 'a run in it' run soft.json --active --stiffness 500 --unstable --ticks 2000 --record soft.dpr
succeeds 'its table' record csv soft.dpr -o soft.csv
check "the region's law: $(python3 law.py 2>&1)" python3 law.py
finish
