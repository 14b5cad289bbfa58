#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# What strips cost, on livers of 5,568 to 1,000,000 triangles: `sh tests/bench/strips.sh BUILD`. Writes
# BUILD/bench/strips.csv, whose columns tests/bench/strips.c explains, and prints it as a table.
set -u
build=$1
dir=$build/bench
mkdir -p "$dir"
meshes=
for count in 5568 61360 1000000; do
    mesh=$dir/liver-$count.dpa
    if [ ! -e "$mesh" ]; then
        "$build/dynpoint" make liver $count -o "$dir/strips.ply" &&
            "$build/dynpoint" compile "$dir/strips.ply" -o "$mesh" >/dev/null || exit 1
        rm -f "$dir/strips.ply"
    fi
    meshes="$meshes $mesh"
done
sh tests/bench/repeats.sh "$dir/strips.csv" "$build/tests/bench/strips" $meshes >/dev/null || exit 1
awk -F, '/^#/ { print; next } { printf "  %-18s %9s %5s  %-12s %9s %9s %9s %9s %9s %9s %6s\n", $1, $2, $3, $4,
    NR == 1 ? "holds" : $5, $6, $7, $8, $9, $10, $11 }' "$dir/strips.csv"
