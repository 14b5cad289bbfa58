#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# A stylus that stands on a membrane and is pushed down: it stands up to 10 N, lies down in front of it beyond that, and
# never is behind. A hand that turns too far has no force there, and the report says why.
# `sh tests/tools/cli_upright.sh BUILD`.
. "$(dirname "$0")/cli.sh"

# number NAME: of the last report in JSON
number()
{
    sed -n "s/.*\"$1\":\([-+.0-9e]*\).*/\1/p" stdout
}

# scene LENGTH ARGUMENTS: of the device sim
scene()
{
    cat <<EOF
{ "bodies": [ { "shape": "membrane", "triangles": 512 } ], "tool": { "length": $1, "radius": 0.001 },
  "device": { "url": "sim:?hand=push.csv&dofs=6&force=20&torque=1&grip=1000&turn_grip=2$2", "origin": [0.0011, 0.0007, 0.005] } }
EOF
}

# hand DEPTH TURN: down by DEPTH, in half of the time of its turn by TURN, and back, with a tremor
hand()
{
    awk -v deep="$1" -v turn="$2" 'BEGIN { print "t,x,y,z,rx,ry,rz"
        for (i = 0; i <= 300; i++) {
            share = i < 150 ? i / 150 : 2 - i / 150
            down = turn && share < 0.5 ? 2 * share : turn ? 1 : share
            printf "%.3f,%.7f,%.7f,%.7f,0.05,%.4f,0\n", i / 100, 1e-4 * sin(7 * i), 1e-4 * cos(11 * i), -deep * down,
                (share > 0.5 ? turn * (2 * share - 1) : 0)
        } }' >push.csv
}

# sides FILE LENGTH: of a recording in CSV, "ticks behind, largest lean (rad), largest force of those that lean by less
# than 0.5 rad (N)". A free tool's x axis points to its other end.
sides()
{
    awk -F, -v length_of="$2" 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
        {
            up = 2 * ($at["proxy_qx"] * $at["proxy_qz"] - $at["proxy_qw"] * $at["proxy_qy"])
            low = $at["proxy_z"]; high = low + length_of * up
            behind += $at["force_reason"] < 2 && (low <= 0 || high <= 0)
            lean = atan2(sqrt(up < 1 ? 1 - up * up : 0), up)
            if (lean > most) most = lean
            force = sqrt($at["asked_fx"] ^ 2 + $at["asked_fy"] ^ 2 + $at["asked_fz"] ^ 2)
            if (lean < 0.5 && force > strongest) strongest = force
        }
        END { print behind + 0, most + 0, strongest + 0 }' "$1"
}

# pushed WHAT SCENE LENGTH
pushed()
{
    succeeds "$1" run "$2" --ticks 3000 --record pushed.dpr --json
    check "$1: never put" test "$(number put_turned)$(number put_squeezed)$(number inside)" = 000
    "$program" record csv pushed.dpr -o pushed.csv
    set -- "$1" "$2" $(sides pushed.csv "$3")
    check "$1: $3 ticks behind" test "$3" -eq 0
    lean=$4 strongest=$5
}

# What the device holds decides; a heavy handle with much damping holds all of it.
stands()
{
    for length in 0.05 0.1 0.2 0.3; do
        hand 0.06 0
        scene $length '&mass=0.2&damping=2&inertia=2e-3&turn_damping=1e-2' >stands.json
        pushed "$length m" stands.json $length
        check "$length m stands up to $strongest N" awk -v f="$strongest" 'BEGIN { exit !(f > 10) }'
        check "$length m: $(number rotational_stiffness) Nm/rad" awk -v k="$(number rotational_stiffness)" -v s="$(number stiffness)" \
            -v l=$length 'BEGIN { exit !(k > 7.49 * l || s * l * l / 12 > 7.49 * l) }'
    done
}

lies_down()
{
    hand 0.06 0
    scene 0.05 '' >lies.json
    pushed 'a short stylus' lies.json 0.05
    check "it leans by $lean rad" awk -v a="$lean" 'BEGIN { exit !(a > 0.8) }'
    run replay pushed.dpr
    check "the recording of it: $(cat stdout stderr)" grep -qx 'pushed.dpr: 3000 ticks, all the same bits' stdout
}

turned_too_far()
{
    hand 0.012 3
    scene 0.05 '' >turned.json
    succeeds 'a hand that turns by 3 rad' run turned.json --ticks 3000 --record turned.dpr --json
    check "it is put there: $(cat stdout)" test "$(number put_turned)" -ge 1
    check 'and is without force' test "$(number inside)" -ge 100
    "$program" record csv turned.dpr -o turned.csv
    set -- $(sides turned.csv 0.05)
    check "$1 ticks behind" test "$1" -eq 0
    check 'the recording says why' awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
        $at["force_flags"] % 32 >= 16 && $at["force_reason"] == 5 { put++ } END { exit !put }' turned.csv
    run run turned.json --ticks 3000
    check "so does the report: $(cat stdout)" grep -q 'by a turn of more than 1 rad [1-9]' stdout
}

reported()
{
    [ -f "${DPT_DATA:-/nowhere}/reports/upright/scene.json" ] || { skip 'the reported scene' 'not in DPT_DATA'; return; }
    cp "$DPT_DATA/reports/upright/scene.json" "$DPT_DATA/reports/upright/push.csv" .
    pushed 'the reported scene' scene.json 0.05
}

stands
lies_down
turned_too_far
reported
finish
