#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# make demo: a liver, a tool that slides over it, and the proof of every answer. `sh tools/demo.sh BUILD`.
set -eu
build=$1
dynpoint=$build/dynpoint
dir=$build/demo
mkdir -p "$dir"

say() { printf '\n%s\n' "$*"; }

say "1. A liver of 50,332 triangles, compiled once into a file that is used in place:"
"$dynpoint" make liver -o "$dir/liver.stl"
"$dynpoint" compile "$dir/liver.stl" -o "$dir/liver.dpa"

say "2. Ten seconds of a 0.26 m tool that slides over it and now and then goes in, 1 kHz:"
"$dynpoint" make trace --mesh "$dir/liver.dpa" --ticks 10000 -o "$dir/slide.csv"
echo "   $dir/slide.csv"

say "3. The nearest pair and the force of every tick; every 20th held against all triangles:"
echo
"$dynpoint" replay "$dir/liver.dpa" "$dir/slide.csv" -o "$dir/answers.csv" --radius 0.002 --against brute \
    --every 20 --repeat 3

say "4. One of the answers ($dir/answers.csv):"
awk -F, 'NR > 1 && $4 > 0.0005 && $17 * $17 + $18 * $18 + $19 * $19 > 0.25 {
    printf "   tick %d: the axis is %.3f mm from triangle %d; its proxy is held back, and pulls with %.3f N\n",
        $1, 1e3 * $4, $14, sqrt($17 * $17 + $18 * $18 + $19 * $19)
    found = 1
    exit
} END { exit !found }' "$dir/answers.csv"

say "Next: $dynpoint compile YOUR.stl -o your.dpa --unit mm   (see README.md)"
