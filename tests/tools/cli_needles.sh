#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# dynpoint run SCENE.json with a needle: it ruptures a wall, and a recording of it has the same bits again.
# `sh tests/tools/cli_needles.sh BUILD`.
. "$(dirname "$0")/cli.sh"

sample=$tests/../docs/samples/needle.json
run run "$sample" --ticks 1
if grep -q 'this build reads no scene files' stderr; then
    skip "needles: no jansson"
    finish
fi

# flagged FILE BIT: in how many rows force_flags has it
flagged()
{
    awk -F, -v bit="$2" 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == "force_flags") at = i }
NR > 1 && at && int($at / bit) % 2 { count++ } END { print count + 0 }' "$1"
}

succeeds 'a needle' run "$sample" --ticks 3000 --record needle.dpr
succeeds 'as a table' record csv needle.dpr -o needle.csv
check 'no rupture' test "$(flagged needle.csv 512)" -gt 0
check 'it is hardly in' test "$(flagged needle.csv 1024)" -gt 500
# column FILE NAME: least and most of a column.
column()
{
    awk -F, -v name="$2" 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == name) at = i; next }
$at + 0 > most { most = $at } END { printf "%.6f\n", most }' "$1"
}

check 'how deep it is' awk -v d="$(column needle.csv depth)" 'BEGIN { exit !(d > 0.005 && d < 0.1) }'
check 'what is inside' test "$(column needle.csv inside)" = "$(column needle.csv depth)"
check "one wall: $(column needle.csv ruptures)" test "$(column needle.csv ruptures)" = 1.000000
check "one layer: $(column needle.csv layers)" test "$(column needle.csv layers)" = 1.000000
succeeds 'what is in it' record info needle.dpr
check "it is told: $(cat stdout)" grep -q "a needle was $(awk -v d="$(column needle.csv depth)" \
    'BEGIN { printf "%.2f", 1000 * d }') mm in; walls opened in [1-9]" stdout
succeeds 'a report' run "$sample" --ticks 3000 --json
check "ruptures are told: $(cat stdout)" grep -q '"ruptures":[1-9][0-9]*,"needle_depth":0\.0[0-9]*,' stdout
succeeds 'its replay' replay needle.dpr
check "other bits: $(cat stdout)" grep -q ': 3000 ticks, all the same bits$' stdout

succeeds 'by name' run needle --device 'sim:?hand=press' --ticks 3000 --record name.dpr
check "one rupture: $(grep needle: stdout)" grep -q '^  the needle: 1 rupture, at most [0-9.]* mm in$' stdout
succeeds 'it as a table' record csv name.dpr -o name.csv
check 'docs/samples/needle.json is the scene needle' cmp -s needle.csv name.csv

# What cannot be pierced, by the same needle, and what can be, by a blunt tool.
sed '/"puncture_force"/d' "$sample" >hard.json
sed '/"piercing"/d; s/"look": "needle",/"look": "needle"/' "$sample" >blunt.json
for name in hard blunt; do
    succeeds "$name" run "$name.json" --ticks 3000 --record "$name.dpr"
    succeeds "$name as a table" record csv "$name.dpr" -o "$name.csv"
    check "$name: a rupture" test "$(flagged "$name.csv" 512)" -eq 0
    check "$name: it is in" test "$(flagged "$name.csv" 1024)" -eq 0
done

# A region of the surface with a law of its own, where the hand presses: the top.
sed 's/"shaft_stiffness": 20000/"shaft_stiffness": 20000, "regions": [ { "box": [-1, 0.039, -1, 1, 1, 1], "puncture_force": 0.6 } ]/' \
    "$sample" >region.json
sed 's/0\.039/0.9/' region.json >elsewhere.json
for name in region elsewhere; do
    succeeds "a scene with a $name" run "$name.json" --ticks 3000 --record "$name.dpr"
    succeeds "$name as a table" record csv "$name.dpr" -o "$name.csv"
done
peak()
{
    awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) { if ($i == "asked_fy") at = i; if ($i == "ruptures") open = i } next }
$open == 0 && $at + 0 > most { most = $at } $open > 0 { exit } END { printf "%.3f\n", most }' "$1"
}
check "the region's puncture force: $(peak region.csv)" awk -v f="$(peak region.csv)" 'BEGIN { exit !(f > 0.55 && f < 0.62) }'
check "a region elsewhere: $(peak elsewhere.csv)" awk -v f="$(peak elsewhere.csv)" 'BEGIN { exit !(f > 1.45 && f < 1.55) }'
sed 's/"box": \[-1, 0.039, -1, 1, 1, 1\], //' region.json >odd.json
refuses 'a region without a place' 'needs a box or a sphere' run odd.json --ticks 1

# A header that names no end is refused.
sed 's/^piercing=1$/piercing=9/' needle.dpr >odd.dpr
run replay odd.dpr
check 'an odd header is taken' test "$status" -eq 2
finish
