#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The cases of `dynpoint stability` in which vertices move, at the least effort: what is told, and that it can fail.
# `sh tests/tools/cli_stability_tissue.sh BUILD [part]`. What fails and what holds is looked at where all run.
. "$(dirname "$0")/cli.sh"

tissue='tissue soft pulse reaction displace springs'
[ ! "$is_part" ] || tissue='pulse reaction'

# part_of CASE METHOD WHAT FIELD: a field of a figure
part_of()
{
    grep "^{\"case\":\"$1\"" stdout | sed -n "s~.*{\"method\":\"$2\",\"what\":\"$3\"\([^}]*\)}.*~\1~p" |
        sed -n "s/.*\"$4\":\"\{0,1\}\([^\",]*\).*/\1/p"
}

# holds CASE METHOD WHAT
holds()
{
    check "$1, $2, $3: $(part_of "$1" "$2" "$3" value)" test "$(part_of "$1" "$2" "$3" verdict)" = holds
}

# is_within CASE METHOD WHAT LOW HIGH
is_within()
{
    check "$1, $2, $3: $(part_of "$1" "$2" "$3" value)" awk -v v="$(part_of "$1" "$2" "$3" value)" -v low="$4" \
        -v high="$5" 'BEGIN { exit !(v != "" && v + 0 >= low && v + 0 <= high) }'
}

# shellcheck disable=SC2086
run stability $tissue --effort 0.01 --json
check "exit $status: $(cat stderr)" test $status -eq 0
check 'an object a case' test "$(wc -l <stdout)" -eq "$(echo "$tissue" | wc -w)"
if [ -x "$(command -v python3)" ]; then
    check 'JSON' python3 -c 'import json, sys
for line in open("stdout"):
    case = json.loads(line)
    assert case["title"] and case["method"] and case["advice"] and case["figures"], case["case"]
    assert all(figure["what"] and figure["value"] is not None for figure in case["figures"]), case["case"]
    told = [(figure["method"], figure["what"]) for figure in case["figures"]]
    assert len(set(told)) == len(told), case["case"]'
fi
[ ! "$is_part" ] || finish

# A membrane and an organ are as stiff on a finer mesh and with a faster physics; loads on three corners are not.
holds tissue proxy 'membrane, ball: stiffness, change by edges halved'
holds tissue proxy 'membrane, ball: stiffness, change by dt halved'
holds tissue proxy 'membrane, ball: stiffness, change on uneven cells'
holds tissue proxy 'organ: force at 2 Hz, change by edges halved'
holds tissue proxy 'organ: phase at 2 Hz, change by dt halved'
is_within tissue proxy 'membrane, ball: stiffness felt' 100 400
is_within tissue proxy 'membrane, ball: change by edges halved, loads on corners alone' 0.1 0.5

# Loops come to rest at the coupling that is chosen. Far above it they do not.
holds soft proxy 'interpolated, 30 Hz to 1 kHz: share of loops that do not come to rest'
holds soft proxy 'stepped, 100 Hz to 1 kHz: the same'
is_within soft proxy 'ball, interpolated: stiffest that comes to rest, of the chosen' 1 200
check 'chart of rates' grep -q '{"chart":"stability-tissue","series":"stepped","x":30.3' stdout

# Work of vertices keeps the force, and loses it if no one is told.
holds pulse controller 'beating vertices: force, of that without the controller'
is_within pulse controller 'beating vertices: the same, if their work is not credited' 0 0.9
holds pulse proxy 'interpolated: largest |dF| in a tick, of K |motion|'
holds pulse proxy 'tissue that gives way: least account, with body_work'
holds pulse proxy 'the same, by its loads and the motion of its vertices'

# Loads and wrench sum up to zero, also while a force fades; and there are ticks in which it does.
holds reaction proxy 'largest |sum of loads + force|, of the peak force'
holds reaction proxy 'while the force fades: |sum of loads + force|'
is_within reaction proxy 'ticks whose force fades' 1 1000
holds reaction bed 'largest |sum of loads + force|, of the peak force'
holds reaction point 'largest |sum of loads + force|, of the peak force'

# A strip makes a displaced surface smoother than the nearest triangle does.
holds displace strip 'edges of r/2: rms with the strip, of that with the nearest alone'
is_within displace point 'edges of r/2, nearest alone: rms above 100 Hz, of the mean force' 0.1 1

# A liver of springs holds still under a needle and a lying tool, and gives no energy away.
holds springs proxy 'needle, SYMPLECTIC: fastest in the last quarter'
holds springs proxy 'needle, SYMPLECTIC: drift from the second quarter to the last'
holds springs observer 'needle, SYMPLECTIC: least account'
for tool in needle 'lying tool'; do
    holds springs proxy "$tool, SYMPLECTIC: hum there, of what is allowed"
    holds springs proxy "$tool, SYMPLECTIC: 99 % of jumps there, of what is allowed"
done
is_within springs proxy 'lying tool, loads spread over 20 mm: hum there, of what is allowed' 0 1
holds springs observer 'lying tool, SYMPLECTIC: least account'
is_within springs proxy 'needle, SYMPLECTIC: how deep the liver was pressed' 2 6

finish
