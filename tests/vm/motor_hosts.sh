#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Hosts that others wrote, of our simulated motors on the kernel's bus, for tests/vm/run.sh: COUNT torques and statuses of each
# DRIVE (damiao, robstride, cybergear, moteus). Python is slow in the emulated machine, 10 s of processor time a drive, so make
# check does not run it.
# robstride-dynamics needs numpy, whose code the emulated processor does not have.
#     sh tests/vm/motor_hosts.sh BUILD [COUNT [DRIVE...]]
program=$1/dynpoint count=${2:-100} dir=/tmp/motors.$$
shift
[ $# -eq 0 ] || shift
[ $# -gt 0 ] || set -- damiao cybergear moteus
. tests/lib/verdict.sh

if [ ! -f build/venv-motors/complete ]; then
    skip "hosts for motors: make deps motors"
    finish
fi
mkdir "$dir"
if ! "$program" compile docs/samples/arm.urdf -o "$dir/arm.dpa" >/dev/null 2>"$dir/error"; then
    skip "hosts for motors: this build has no urdfdom"
    finish
fi
for drive; do
    : >"$dir/name"
    "$program" device simulate "can:vcan0?arm=$dir/arm.dpa&drive=$drive&model=rs-02&watchdog=2" --for 200 >"$dir/name" &
    simulator=$!
    while [ ! -s "$dir/name" ]; do sleep 0.1; done
    build/venv-motors/bin/python tests/vm/motor_hosts.py $drive "$count" >"$dir/said" 2>"$dir/error"
    status=$?
    check "$drive: $(tail -n 1 "$dir/said")" test $status -eq 0
    [ $status -eq 0 ] || tail -n 5 "$dir/error"
    kill $simulator
    wait $simulator
done
rm -r "$dir"
finish
