#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# A body that cannot go on is held where it was, and ticks that failed are told first: run, replay and view then exit with 2,
# and the other bodies keep their force. `sh tests/tools/cli_held.sh BUILD`.
. "$(dirname "$0")/cli.sh"

echo '{ "bodies": [ { "shape": "box" } ] }' >alone.json
run run alone.json --device sim --ticks 1
if grep -q 'this build reads no scene files' stderr; then
    skip "scene files: no jansson"
    finish
fi

# number NAME: of the last report in JSON
number()
{
    sed -n "s/.*\"$1\":\([-+.0-9e]*\).*/\1/p" stdout
}

# troubled WHAT TEXT ARGUMENT...: exit 2, one line on standard error, and TEXT first in the report and in that line
troubled()
{
    what=$1 expected=$2
    shift 2
    run "$@"
    check "$what: exit $status" test $status -eq 2
    check "$what: $(cat stderr)" test "$(wc -l <stderr)" -eq 1
    check "$what: no '$expected' in: $(cat stderr)" grep -qF -e "$expected" stderr
    check "$what: no '$expected' first in: $(head -n 1 stdout)" \
        sh -c 'head -n 1 stdout | grep -qF -e "$1"' sh "$expected"
}

tool='"tool": { "length": 0.05, "radius": 0.002 }, "device": { "url": "sim:?hand=press", "origin": [0, 0.057, 0] }'
box='{ "shape": "box" }'
liver='{ "shape": "liver", "triangles": 500, "position": [1, 0, 0], "material": { "kind": "volume", "spacing": 0.03 }'
echo "{ \"bodies\": [ $box ], $tool }" >alone.json
echo "{ \"bodies\": [ $liver, \"physics\": { \"room\": 0.5 } }, $box ], \"gravity\": 9.81, $tool }" >falls.json
echo "{ \"bodies\": [ $liver }, $box ], \"gravity\": 9.81, $tool }" >table.json

# --- It falls out of its room at 0.32 s, while a hand presses on a box; the force is that of a box alone, but for the
# clearance, which goes by the largest mesh.
succeeds 'a box' run alone.json --ticks 1500 --json
strongest=$(number strongest)
troubled 'it falls' 'bodies[0] (liver) was held where it was on 1182 ticks from tick 318 on: it leaves its room, which ends 0.5 m beyond its box' \
    run falls.json --ticks 1500 --record falls.dpr
check 'the cure is told' grep -q 'physics.room' stderr
run run falls.json --ticks 1500 --json
check "it falls: exit $status" test $status -eq 2
check "it takes no force: $(number strongest) N of $strongest" \
    awk -v a="$(number strongest)" -v b="$strongest" 'BEGIN { exit !(a > 1 && b > 1 && (a - b) ^ 2 < (1e-4 * b) ^ 2) }'
check "1182 ticks, no failure: $(number held), $(number failed)" test "$(number held) $(number failed)" = '1182 0'
check 'the trouble is in the object' has_keys stdout trouble held
succeeds 'csv' record csv falls.dpr -o falls.csv
held=$(awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
    { n += $at["flags"] == 3; force += $at["flags"] == 3 && $at["asked_fy"] > 0 } END { print n, (force > 100) }' falls.csv)
check "the recording has it: $held" test "$held" = '1182 1'
troubled 'replay' 'bodies[0] (liver) was held where it was on 1182 ticks from tick 318 on' replay falls.dpr
check 'and the bits are the same' grep -q 'all the same bits' stdout
run replay falls.dpr --json
check "replay --json: exit $status" test $status -eq 2
check 'its trouble is in the object' has_keys stdout trouble
run view falls.dpr --mesh falls.json -o out/falls.html
if ! grep -q "has no viewer's page" stderr; then
    check "view: exit $status" test $status -eq 2
    check "view: $(cat stderr)" grep -q 'bodies\[0\] (liver) was held where it was on 1182 ticks' stderr
    check 'and it is shown' test -s out/falls.html
fi

# --- A table is 2 m high at most: by default the room is larger.
succeeds 'from a table' run table.json --ticks 640 --json
check "nothing is held: $(number held)" test "$(number held)" = 0

# --- Physics of its own holds it as well.
troubled 'apart' 'bodies[0] (liver) was held where it was on ' run falls.json --ticks 1500 --physics 500
troubled 'without bounds' 'bodies[0] (liver) was held where it was on ' run falls.json --ticks 1500 --physics 1000 --law bed

# --- Samples that are 2 s apart are no step of springs.
echo '{ "bodies": [ { "shape": "membrane", "triangles": 32, "material": { "kind": "sheet" },
  "physics": { "integrator": "implicit" } } ] }' >slow.json
troubled 'ticks that fail' ' of 15 ticks failed, and gave no force, the first of them tick 1: samples were more than 1 s apart' \
    run slow.json --device 'sim:?hand=hold&rate=1&loss=0.5' --ticks 30
check "they do not count as fresh: $(sed -n 2p stdout)" grep -q '^30 ticks: 7 with a fresh sample, 15 without' stdout

# --- The public reports, as they are.
if [ -n "${DPT_DATA:-}" ] && [ -f "$DPT_DATA/reports/soft/fall2.json" ]; then
    cp "$DPT_DATA/reports/soft/"* .
    troubled 'fall2' 'bodies[0] (liver) was held where it was on 1573 ticks from tick 1427 on' run fall2.json --ticks 3000
    run run fall2.json --ticks 3000 --json
    check "fall2: $(number contacts) contacts" test "$(number contacts)" -gt 2000
    succeeds 'held at an edge' run held_at_an_edge.json --ticks 3000 --json
    check "held at an edge: $(number held) held, $(number failed) failed" test "$(number held) $(number failed)" = '0 0'
else
    skip 'reports of strangers: no DPT_DATA'
fi
finish
