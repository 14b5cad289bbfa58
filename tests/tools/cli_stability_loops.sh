#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The closed loops of `dynpoint stability`, at the least effort: what is told, and that it can fail.
# `sh tests/tools/cli_stability_loops.sh BUILD [part]`. What fails and what holds is looked at where all run.
. "$(dirname "$0")/cli.sh"

loops='wall organs delay rate phase zoom energy late rest beat'
[ ! "$is_part" ] || loops='wall delay'

# part_of METHOD WHAT FIELD: a field of a figure of all cases
part_of()
{
    sed -n "s/.*{\"method\":\"$1\",\"what\":\"$2\"\([^}]*\)}.*/\1/p" stdout | sed -n "s/.*\"$3\":\"\{0,1\}\([^\",]*\).*/\1/p"
}

# holds METHOD WHAT
holds()
{
    check "$1, $2: $(part_of "$1" "$2" value)" test "$(part_of "$1" "$2" verdict)" = holds
}

# is_within METHOD WHAT LOW HIGH
is_within()
{
    check "$1, $2: $(part_of "$1" "$2" value)" awk -v v="$(part_of "$1" "$2" value)" -v low="$3" -v high="$4" \
        'BEGIN { exit !(v != "" && v + 0 >= low && v + 0 <= high) }'
}

# shellcheck disable=SC2086
run stability $loops --effort 0.01 --json
check "exit $status: $(cat stderr)" test $status -eq 0
check 'an object a case' test "$(wc -l <stdout)" -eq "$(echo "$loops" | wc -w)"
if [ -x "$(command -v python3)" ]; then
    check 'JSON' python3 -c 'import json, sys
for line in open("stdout"):
    case = json.loads(line)
    assert case["title"] and case["method"] and case["advice"] and case["figures"], case["case"]
    assert all(figure["what"] for figure in case["figures"]), case["case"]'
fi
[ ! "$is_part" ] || finish

# The limit is met, and beyond it motion grows as the model says: by half of b / 2m at 1.5 limits.
for subject in 'spring:limit of a spring: largest share that it is off' \
    'spring:limit of a spring against turns: share that it is off' \
    'proxy:limit of a wall: largest share that it is off' \
    'proxy:limit of a wall against turns: share that it is off'; do
    holds "${subject%%:*}" "${subject#*:}"
done
is_within spring 'spring: growth at 1.5 limits' 0.4 0.6
is_within proxy 'wall: growth at 1.5 limits' 0.4 0.6
is_within proxy 'wall against turns: growth at 1.5 limits' 0.4 0.6
is_within proxy 'share of loops at 0.97 of the limit whose motion grows' 0 0
is_within proxy 'share of loops at 1.1 limits whose motion grows' 1 1
is_within proxy 'least share of the limit at delays that is stable' 0.97 1.03
is_within ball 'least share of the limit at delays that is stable' 0.1 0.5
is_within proxy 'stiffest coupling at 10 kHz, of that at 1 kHz' 9 11
is_within proxy 'stiffest wall, served 0.1 periods after a sample' 824 842
is_within proxy 'stiffest wall, served 0.5 periods after a sample' 495 505
is_within proxy 'least growth at zooms of 2 and 4 with that of zoom 1' 0.1 3
check 'chart of delays' grep -q '{"chart":"stability-delay","series":"limit","x":1,"y":33[34]' stdout

# Accounts: kept on the borders and by the controller, overdrawn without.
holds proxy 'least account on the border of Colgate'
holds proxy 'least account on the border of Abbott and Okamura'
holds observer 'least account at three times the border of Colgate'
holds controller 'least account'
is_within observer 'least account without the controller' -1e9 -2
holds controller 'steps in which it acts where the wall has a margin of 1.5'
holds controller 'beating organ: force, of that without the controller'
is_within controller 'beating organ: the same, if its work is not credited' 0 0.98

# What lies comes to rest on the proxy, and not on a push at one point.
turn='0.2 kg, 2 Ns\/m, 0.1 N, 0.02 mm, 6 DoF: fastest turn at the end'
check 'the proxy rests' test "$(part_of proxy "$turn" verdict)" = holds
check 'the point does not rest' test "$(part_of point "$turn" verdict)" = fails

finish
