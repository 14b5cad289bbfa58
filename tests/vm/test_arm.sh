#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The whole way, for tests/vm/run.sh: a URDF compiled, its motors simulated on a bus, its scene felt through them. sh tests/vm/test_arm.sh BUILD
program=$1/dynpoint dir=/tmp/arm.$$
name="can:vcan0?arm=$dir/arm.dpa&gear=8,-8,10&watchdog=2&silent=1&rate=200"
. tests/lib/verdict.sh

# number KEY: of the run's report.
number() {
    sed -n "s/.*\"$1\":\([0-9.]*\).*/\1/p" "$dir/json"
}

mkdir "$dir"
if ! "$program" compile docs/samples/arm.urdf -o "$dir/arm.dpa" >/dev/null 2>"$dir/error"; then
    if grep -q 'this build reads no URDF' "$dir/error"; then
        skip "an arm from its URDF: this build has no urdfdom"
        finish
    fi
fi
"$program" device simulate "$name" --swing 0.02 --for 100 >"$dir/name" &
simulator=$!
while [ ! -s "$dir/name" ]; do sleep 0.1; done
for turn in 1 2 3 4 5; do
    # Where the device's own frame lies does not matter: the arm's joints tell where its tool is.
    "$program" run "$dir/arm.dpa" --device "$name&centre=1,2,3&axes=+x+y+z" --law point --ticks 800 --json >"$dir/json" 2>"$dir/error" && break
done
kill $simulator
wait $simulator
check "the scene is felt through the motors" test "$(number ticks)" = 800
check "the tool goes down to the desk and comes up" test "$(number contacts)" -gt 50 -a "$(number contacts)" -lt 750
check "not deeper than the hand goes" awk "BEGIN { exit !($(number deepest) > 0.0005 && $(number deepest) < 0.02) }"
check "nothing is lost" test "$(number lost)" = 0 -a "$(number losses)" = 0
[ "$failed" -eq 0 ] || cat "$dir/error" "$dir/json"
rm -r "$dir"
finish
