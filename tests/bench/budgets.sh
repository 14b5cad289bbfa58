#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Contact with budgets, on the meshes of run.sh, which compiles them, and the motions of its charts:
# `sh tests/bench/budgets.sh BUILD [MESH ...]` writes BUILD/bench/budgets.csv, whose columns tests/bench/budgets.c explains,
# and prints it as a table.
set -u
build=$1
shift
dir=$build/bench
csv=$dir/budgets.csv
echo "mesh,triangles,budget,ticks,in_reach,median,p99,max,unknown,coarse,off,gap_off" >"$csv"
for name in ${*:-liver torus-61358 star membrane}; do
    "$build/dynpoint" make trace --mesh "$dir/$name.dpa" --ticks "${TICKS:-20000}" -o "$dir/$name.csv" &&
        sh tests/bench/repeats.sh "$dir/budgets.rows" "$build/tests/bench/budgets" "$name" "$dir/$name.dpa" "$dir/$name.csv" \
            >/dev/null || exit 1
    sed '/^#/d' "$dir/budgets.rows" >>"$csv"
    sed -n "s/^#/  $name:/p" "$dir/budgets.rows"
done
awk -F, '{ printf "  %-14s %9s %9s %9s %9s %9s %9s %9s %9s\n", $1, $3, $5, $6, $7, $8, $9, $10, $11 }' "$csv"
