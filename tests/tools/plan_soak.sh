#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Plans of every scene, of organs and of two devices, on traces that no plan has seen. `sh tests/tools/plan_soak.sh BUILD [SEEDS]`.
# Takes an hour. DPT_DATA names the folder of real organs. A scene that this machine is too slow for is skipped, and named.
. "$(dirname "$0")/cli.sh"
seeds=${2:-10}

# holds_unseen NAME ARGUMENT...: its plan, on other seeds
holds_unseen()
{
    name=$1
    shift
    run plan "$@" -o "$name.json"
    if [ $status -eq 1 ]; then
        skip "$name: $(cat stdout)"
        return
    fi
    check "plan $name: exit $status, $(cat stderr)" test $status -eq 0
    seed=101
    while [ $seed -lt $((101 + seeds)) ]; do
        run replay --plan "$name.json" --check --seed $seed --ticks $((8000 + 100 * seed))
        check "$name, seed $seed: $(tail -n 1 stdout) $(cat stderr)" test $status -eq 0
        seed=$((seed + 1))
    done
    run replay --plan "$name.json" --cheaper --check
    check "$name: the next cheaper: exit $status" test $status -eq 1
}

printf 'mass=0.045\ndamping=0.5\nfriction=0.26\nposition_step=0.000055\ndelay=0.0005\n' >light.txt
printf 'mass=0.3\ndamping=5\nfriction=0.5\nposition_step=0.00001\ninertia=0.0003\nspin_damping=0.01\n' >heavy.txt
asked='--error 0.1mm --force-error 0.05N'
for scene in membrane laparoscopy liver tori; do
    # shellcheck disable=SC2086
    holds_unseen "$scene" "$scene" $asked
done
# At 1 kHz all of what gives way is too much for some machines.
# shellcheck disable=SC2086
holds_unseen soft-liver soft-liver $asked --rate 500
holds_unseen cloth cloth --error 1mm --force-error 0.1N --rate 500
for device in light heavy; do
    # shellcheck disable=SC2086
    holds_unseen "liver-$device" liver $asked --device $device.txt
done
for organ in openhelp_liver.stl openhelp_stomach.stl openhelp_kidney_left.stl; do
    file=${DPT_DATA:-none}/meshes/organs/$organ
    if [ ! -e "$file" ]; then
        skip "$organ: no DPT_DATA"
        continue
    fi
    succeeds "compile $organ" compile "$file" -o "$organ.dpa" --unit mm
    # shellcheck disable=SC2086
    holds_unseen "$organ" "$organ.dpa" $asked
done
finish
