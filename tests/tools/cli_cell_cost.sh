#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# What a term for the volume of cells costs: instructions of dpt_springs_step on the liver of 50,332 triangles, all awake,
# with it and without, counted by callgrind. The counts are the same in every run. `sh tests/tools/cli_cell_cost.sh BUILD`.
. "$(dirname "$0")/cli.sh"

if [ ! -x "$(command -v valgrind)" ]; then
    skip 'what cells cost: no valgrind'
    finish
fi
if ! grep -qw avx2 /proc/cpuinfo; then
    skip 'what cells cost: no AVX2, which is what is counted'
    finish
fi
if "$program" run no.json --device sim 2>&1 | grep -q 'this build reads no scene files'; then
    skip 'what cells cost: this build reads no scene files'
    finish
fi

# instructions POISSON: of a step of half a millisecond, which is one substep
instructions()
{
    succeeds "compile $1" compile liver.obj -o "$1.dpa" --springs volume --viscosity 0.001 --poisson "$1"
    cat >"$1.json" <<END_OF_SCENE
{ "bodies": [ { "mesh": "$1.dpa", "physics": { "integrator": "symplectic", "sleep_speed": 0 } } ],
  "tool": { "length": 0.1, "radius": 0.002, "law": "proxy" }, "device": { "url": "sim" } }
END_OF_SCENE
    valgrind --tool=callgrind --collect-atstart=no --toggle-collect=dpt_springs_step --callgrind-out-file=out.txt \
        "$program" run "$1.json" --device 'sim:?rate=2000' --rate 2000 --physics 2000 --ticks 4 >stdout 2>stderr
    check "callgrind, $1: $(tail -1 stderr)" grep -q 'physics 2000 Hz, 4 steps' stdout
    check "all of it is awake: $(grep springs stdout)" grep -q '100.0 % of the nodes were awake' stdout
    counted=$(awk '/^totals:/ { print $2 / 4 }' out.txt)
}

succeeds 'a liver' make liver 50332 -o liver.obj
instructions 0.25
alone=$counted
check "springs alone: $alone instructions" awk -v n="$alone" 'BEGIN { exit !(n > 1e6) }'
instructions 0.3
check "with cells: $counted instructions, $alone of springs alone" awk -v a="$counted" -v b="$alone" \
    'BEGIN { exit !(a > 1.2 * b && a <= 1.6 * b) }'
finish
