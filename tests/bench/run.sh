#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# make bench: time per tick of every kernel and of the peers that are here, on the same mesh and trace in one
# run, always with the error beside it. `sh tests/bench/run.sh BUILD [MESH ...]`; MESH is a shape, a shape
# and its count (torus-61358), or a mesh file. Prints a table and writes BUILD/bench/results.csv: times in
# ns, least of three passes a tick, the first tick apart; `differs` is the largest difference from our
# distances, and theirs are held against brute force on every 100th tick.
set -u
build=$1
shift
meshes=${*:-torus-5568 torus-13580 torus-20832 torus-39648 torus-61358 liver membrane cloth star}
ticks=${TICKS:-20000}
dir=$build/bench
mkdir -p "$dir"
csv=$dir/results.csv
echo "mesh,triangles,method,kernel,ticks,crossing,median,p99,crossing_median,crossing_p99,other_median,other_p99,max,differs" >"$csv"

number() { sed -n "s/.*\"$2\":\([0-9.e+-]*\).*/\1/p" "$1"; }
field() { sed -n "s/.*\"$2\":{[^}]*\"$3\":\([0-9.]*\).*/\1/p" "$1"; }

row() { # method kernel json differs
    printf '  %-22s %9s %9s %9s %9s %9s %9s %10s  %s\n' "$1 $2" "$(field "$3" ns median)" \
        "$(field "$3" ns p99)" "$(field "$3" ns_crossing median)" "$(field "$3" ns_crossing p99)" \
        "$(field "$3" ns_other median)" "$(field "$3" ns_other p99)" "$(field "$3" ns max)" "$4"
    echo "$name,$triangles,$1,$2,$ticks,$crossing,$(field "$3" ns median),$(field "$3" ns p99),$(field "$3" ns_crossing median),$(field "$3" ns_crossing p99),$(field "$3" ns_other median),$(field "$3" ns_other p99),$(field "$3" ns max),$4" >>"$csv"
}

peer=
if command -v pkg-config >/dev/null 2>&1 && pkg-config --exists fcl 2>/dev/null && command -v g++ >/dev/null 2>&1; then
    peer=$dir/peer_fcl
    if [ ! -x "$peer" ] || [ tests/bench/peer_fcl.cpp -nt "$peer" ]; then
        g++ -O3 $(pkg-config --cflags fcl) -std=c++17 tests/bench/peer_fcl.cpp -o "$peer" $(pkg-config --libs fcl) || peer=
    fi
fi
[ -n "$peer" ] || echo "left out: FCL (libfcl-dev, g++ or pkg-config is not here)"

for name in $meshes; do
    file=$dir/$(basename "$name")
    case $name in
    *.*) "$build/dynpoint" compile "$name" -o "$file.dpa" 2>/dev/null ;;
    *) "$build/dynpoint" make $(echo "$name" | tr - ' ') -o "$file.ply" &&
        "$build/dynpoint" compile "$file.ply" -o "$file.dpa" 2>/dev/null ;;
    esac || exit 2
    "$build/dynpoint" make trace --mesh "$file.dpa" --ticks "$ticks" -o "$file.csv" || exit 2
    triangles=$("$build/dynpoint" info "$file.dpa" --json | sed -n 's/^{"triangles":\([0-9]*\).*/\1/p')

    "$build/dynpoint" replay "$file.dpa" "$file.csv" -o "$file.ours.csv" --until track --repeat 3 \
        --against brute --every 100 --json >"$file.auto.json" || exit 1
    crossing=$(number "$file.auto.json" crossing)
    echo "$(basename "$name"): $triangles triangles, $ticks ticks, $crossing crossing; ns a tick"
    printf '  %-22s %9s %9s %9s %9s %9s %9s %10s  %s\n' '' median '99 %' 'crossing' '99 %' 'other' '99 %' max 'differs, m'
    for kernel in scalar sse2 avx2 avx512 neon; do
        "$build/dynpoint" replay "$file.dpa" "$file.csv" -o "$file.$kernel.csv" --until track --repeat 3 \
            --kernel $kernel --json >"$file.$kernel.json" 2>/dev/null || continue
        cmp -s "$file.$kernel.csv" "$file.ours.csv" || { echo "$kernel gives other answers"; exit 1; }
        row tree "$kernel" "$file.$kernel.json" 0
    done
    if [ -n "$peer" ]; then
        "$build/tests/bench/dump_mesh" "$file.dpa" "$file.tri" || exit 2
        "$peer" "$file.tri" "$file.csv" -o "$file.fcl.csv" --json >"$file.fcl.json" || exit 2
        differs=$(awk -F, 'NR == FNR { if (FNR > 1) ours[$1] = $4; next }
            FNR > 1 { d = $2 - ours[$1]; d = d < 0 ? -d : d; if (d > worst) worst = d }
            END { printf "%.2g", worst }' "$file.ours.csv" "$file.fcl.csv")
        row FCL OBBRSS "$file.fcl.json" "$differs"
    fi
    echo "  against brute force: $(sed -n 's/.*"against":{[^}]*"ticks":\([0-9]*\),"wrong":\([0-9]*\),"largest_error":\([0-9.e+-]*\).*/\2 of \1 ticks wrong, largest error \3 m/p' "$file.auto.json")"
done
