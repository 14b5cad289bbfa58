#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The paper's method against K: time, wrong ticks, missed contacts and largest error, every tick held against
# the tree. `sh tests/bench/paper.sh BUILD [MESH ...]` prints a table and writes BUILD/bench/paper.csv.
set -u
build=$1
shift
meshes=${*:-torus-5568 torus-13580 torus-20832 torus-39648 torus-61358 liver membrane star}
ticks=${TICKS:-20000}
dir=$build/bench
mkdir -p "$dir"
csv=$dir/paper.csv
echo "mesh,triangles,parts,one_step,ticks,median,p99,max,wrong,missed,largest_error" >"$csv"
printf '%-14s %3s %9s %9s %9s %8s %8s  %s\n' mesh K 'ns median' '99 %' max 'wrong %' 'missed %' 'largest error, m'
for name in $meshes; do
    file=$dir/$name
    "$build/dynpoint" make $(echo "$name" | tr - ' ') -o "$file.ply" &&
        "$build/dynpoint" compile "$file.ply" -o "$file.dpa" >/dev/null &&
        "$build/dynpoint" make trace --mesh "$file.dpa" --ticks "$ticks" -o "$file.csv" || exit 2
    triangles=$("$build/dynpoint" info "$file.dpa" --json | sed -n 's/^{"triangles":\([0-9]*\).*/\1/p')
    for parts in 1 2 4 8 16 1s; do
        step=
        [ "$parts" = 1s ] && step=--one-step
        "$build/dynpoint" replay "$file.dpa" "$file.csv" -o "$file.paper.csv" --method paper \
            --parts "${parts%s}" $step --repeat 3 --against tree --json >"$file.paper.json"
        [ $? -le 1 ] || exit 2
        sed -n 's/.*"ns":{"median":\([0-9]*\),"p99":\([0-9]*\),"p999":[0-9]*,"max":\([0-9]*\)}.*"against":{[^}]*"wrong":\([0-9]*\),"missed":\([0-9]*\),"largest_error":\([0-9.e+-]*\).*/\1 \2 \3 \4 \5 \6/p' \
            "$file.paper.json" | while read -r median p99 max wrong missed error; do
            echo "$name,$triangles,${parts%s},$([ -n "$step" ] && echo 1 || echo 0),$ticks,$median,$p99,$max,$wrong,$missed,$error" >>"$csv"
            awk "BEGIN { printf \"%-14s %3s %9d %9d %9d %8.2f %8.2f  %.2g\n\", \"$name\", \"$parts\", $median, $p99, $max,
                100 * $wrong / $ticks, 100 * $missed / $ticks, $error }"
        done
    done
done
