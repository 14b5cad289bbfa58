#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Plans of scenes, and whether their times hold on motions that they have not seen: `sh tests/bench/plans.sh BUILD`. Prints a
# line a scene and seed; the plans are in BUILD/bench.
set -u
build=$1
held=0 broken=0 skipped=0
mkdir -p "$build/bench"
for scene in liver tori membrane laparoscopy; do
    plan=$build/bench/$scene.plan.json
    "$build/dynpoint" plan $scene --error 0.1mm --force-error 0.05N --rate 1kHz -o "$plan" >"$plan.txt"
    case $? in
    0) ;;
    1)
        echo "  skip $scene: $(cat "$plan.txt")"
        skipped=$((skipped + 1))
        continue
        ;;
    *)
        broken=$((broken + 1))
        continue
        ;;
    esac
    for seed in 7 8 9; do
        if "$build/dynpoint" replay --plan "$plan" --check=time --seed $seed >"$plan.seed"; then
            held=$((held + 1))
        else
            broken=$((broken + 1))
        fi
        echo "  $scene, seed $seed: $(tail -n 1 "$plan.seed")"
        grep "the plan's setting" "$plan.seed"
    done
done
echo "$held passed, $broken failed, $skipped skipped"
[ $broken -eq 0 ]
