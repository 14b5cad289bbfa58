#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# `dynpoint stability hum` with few rows: its words, its counts, its JSON; and that neither rigid bodies hum nor soft scenes as
# `dynpoint run` has them, nor those under a thick tool. Other rows are told, and not looked at. `sh tests/tools/cli_stability_hum.sh BUILD [EFFORT|part]`;
# EFFORT 1 takes minutes.
. "$(dirname "$0")/cli.sh"

effort=${2:-0.25}
[ ! "$is_part" ] || effort=0.05

succeeds 'stability --list' stability --list
check '--list: it runs only where it is named' grep -q '^hum  *[A-Z].*(only where named)$' stdout
check '--list: nothing else does' test "$(grep -c '(only where named)' stdout)" -eq 1
succeeds 'stability --help' stability --help
check '--help: it must be named' grep -q 'hum, which runs only where it is named' stdout

json()
{
    run stability hum --effort "$effort" --json
    check "exit $status: $(cat stderr)" test $status -le 1
    check 'an object' test "$(wc -l <stdout)" -eq 1
    cp stdout json
    python3 -c '
import json, sys
effort, status = float(sys.argv[1]), int(sys.argv[2])
case = json.loads(open("json").read(), parse_constant=lambda word: sys.exit("not JSON: " + word))
assert case["case"] == "hum" and case["points"] == []
for text in (case["title"], case["method"], case["advice"]):
    assert "  " not in text and text == text.strip() and len(text) > 10, text
figures = {(f["method"], f["what"]): f for f in case["figures"]}
assert len(figures) == len(case["figures"])
fails = any(f["verdict"] == "fails" for f in case["figures"] if "verdict" in f)
assert status == fails, "the exit status"
rows = case["rows"]
skipped = [f["value"] for f in case["figures"] if f["method"] == "data"]
scenes = ["liver", "membrane", "laparoscopy", "soft-liver", "cloth", "biopsy", "organ-liver", "organ-kidney", "organ-spleen"]
seen = list(dict.fromkeys(row["scene"] for row in rows))
assert skipped == [9 - len(seen)] and seen == scenes[:len(seen)], (skipped, seen)
assert len(rows) == (len(seen) - 1) * max(1, int(20 * effort + 0.5)) + 1, len(rows)
words = {"integrator": ("rigid", "SYMPLECTIC", "EULER", "IMPLICIT"), "rotation": ("locked", "free"),
         "hand": ("still", "press", "wipe", "rub"), "verdict": ("holds", "fails", "no force", "broke", "refused")}
numbers = ["lean_deg", "stiffness", "edge_of_radius", "mean_N", "hum_N", "hum_percent", "jump_median_mN", "jump_99_mN",
           "jump_max_mN", "strongest_Hz"]
for row in rows:
    assert set(row) == {"scene", *words, *numbers}, row
    assert all(row[key] in words[key] for key in words), row
    assert (row["integrator"] == "rigid") == (row["scene"] == "liver"), row
    if row["verdict"] in ("holds", "fails"):
        assert all(row[key] is not None and row[key] >= 0 for key in numbers), row
        assert abs(row["hum_percent"] * row["mean_N"] - 100 * row["hum_N"]) <= 1e-6 * row["mean_N"], row
        assert row["jump_median_mN"] <= row["jump_99_mN"] <= row["jump_max_mN"], row
        assert row["strongest_Hz"] == 0 or 20 < row["strongest_Hz"] <= 500, row
        if row["hand"] == "still":
            is_calm = row["hum_N"] <= max(1e-3 * row["mean_N"], 5e-4) and row["jump_99_mN"] <= 1
            assert row["verdict"] == ("holds" if is_calm else "fails"), row
for scene, name in zip(scenes, ["rigid liver", *scenes[1:6], "real liver", "real kidney", "real spleen"]):
    mine = [row["verdict"] for row in rows if row["scene"] == scene]
    if mine:
        judged = figures["proxy", name + ": rows that were judged"]["value"]
        failing = figures["proxy", name + ": rows that fail"]["value"]
        assert judged == len(mine) - mine.count("refused"), (name, judged)
        assert failing == judged - mine.count("holds"), (name, failing)
        broken = [f["what"] for (_, what), f in figures.items() if what.startswith(name) and f.get("verdict") == "fails"]
        assert bool(broken) == bool(failing), (name, broken)
assert all(row["verdict"] == "holds" and row["hum_N"] < 1e-12 * row["mean_N"] and row["jump_max_mN"] < 1e-9
           for row in rows if row["scene"] == "liver" and row["hand"] == "still"), "the rigid liver"
assert all(row["verdict"] == "holds" for row in rows if row["scene"] == "liver"), "the rigid liver"
needles = [row for row in rows if row["scene"] == "biopsy"]
assert [(row["hand"], row["verdict"], row["lean_deg"]) for row in needles] == [("still", "holds", 0)], needles
assert needles[0]["mean_N"] > 0.1, "the needle is not held"
for scene in scenes[1:5]:
    for row in [row for row in rows if row["scene"] == scene][:3]:
        is_slip = (scene, row["hand"]) == ("soft-liver", "press")  # off an edge: one jump too large
        assert row["verdict"] == "holds" or is_slip and row["jump_99_mN"] <= 20, row
    # A tool twice as thick as edges are long: a still one with EULER, one that wipes.
    for row in [row for row in rows if row["scene"] == scene][3:5]:
        assert row["verdict"] == "holds", row
' "$effort" $status 2>python.log
    check "--json: $(tail -n 1 python.log)" test ! -s python.log
}

if [ -x "$(command -v python3)" ]; then json; fi

run stability hum --effort 0.05
check "exit $status: $(cat stderr)" test $status -le 1
check 'a table: a title' grep -q '^hum: ' stdout
check 'a table: its columns' grep -q '^ scene  *integrator  *lean_deg .* jump_99_mN .* verdict *$' stdout
for scene in liver membrane laparoscopy soft-liver cloth biopsy; do
    check "a table: $scene" test "$(grep -c "^ $scene .* still .*[a-z] *$" stdout)" -eq 1
done
check 'a table: the rigid liver holds' grep -q '^ liver  *rigid  *90 .* still .* holds *$' stdout
check 'a table: what is skipped' grep -q '^  data  *real organs skipped.* 3 *$' stdout

finish
