#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The picture of docs/plot.md: a tool slides over a liver, felt by two laws.
#
#     sh tests/pictures/draw_plot.sh BUILD OUT.svg
set -eu
program=$(cd "$1" && pwd)/dynpoint out=$2
room=$(mktemp -d)
trap 'rm -rf "$room"' EXIT
quietly() {
    "$program" "$@" >"$room/said" 2>&1 || { cat "$room/said" >&2; exit 1; }
}
quietly make liver 4000 -o "$room/liver.obj"
quietly compile "$room/liver.obj" -o "$room/liver.dpa"
quietly make trace --mesh "$room/liver.dpa" --ticks 4000 --seed 7 --length 0.05 -o "$room/slide.csv"
quietly replay "$room/liver.dpa" "$room/slide.csv" -o "$room/proxy"
quietly replay "$room/liver.dpa" "$room/slide.csv" --law point -o "$room/point"
quietly plot "$room/proxy" "$room/point" --title 'A stylus of 50 mm slides over a liver: laws proxy and point' -o "$out"
