#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# `make figures`: what the README says of the default tick, on this machine. `sh tests/bench/figures.sh BUILD OUT.csv`.
# A row a subject: the least of TURNS (3) runs, us. Run it beside nothing else, and put the figures into README.md:
# tests/docs/figures.py holds them to the file.
set -eu
build=$1 out=$2 turns=${TURNS:-3}
rows=$(mktemp)
trap 'rm -f "$rows"' EXIT

turn=0
while [ $turn -lt "$turns" ]; do
    turn=$((turn + 1))
    sh tools/demo.sh "$build" | awk '/^  all / { print "demo," $2 "," $3 "," $4 "," $5; exit }' >>"$rows"
    for tool in ball line; do
        for motion in open rest wipe fast; do
            "$build/tests/bench/proxy_ticks" liver $tool $motion 20000 0 1 |
                awk -F, 'NR == 2 { print $3 " " $4 "," $6 "," $7 "," $8 "," $9 }' >>"$rows"
        done
    done
done
awk -F, '
    BEGIN { print "subject,ticks,median_us,p99_us,worst_us" }
    !($1 in ticks) { order[++count] = $1; ticks[$1] = $2 }
    { for (i = 3; i <= 5; i++) if (!(($1, i) in least) || $i + 0 < least[$1, i]) least[$1, i] = $i + 0 }
    END { for (n = 1; n <= count; n++) print order[n] "," ticks[order[n]] "," least[order[n], 3] "," least[order[n], 4] "," least[order[n], 5] }
' "$rows" >"$out.new"
[ "$(wc -l <"$out.new")" -eq 10 ]
mv "$out.new" "$out"
cat "$out"
