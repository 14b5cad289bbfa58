#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# make bench: time per tick of every kernel and of the peers that are here, on the same mesh and trace in one
# run, always with the error beside it. `sh tests/bench/run.sh BUILD [MESH ...]`; MESH is a shape, a shape
# and its count (torus-61358), or a mesh file. Prints a table and writes BUILD/bench/results.csv: times in
# ns, least of three passes a tick, the first tick apart; `differs` is the largest difference from our
# distances, `wrong` the ticks that differ by more than 1e-9 of the diagonal (of a peer that only says whether
# it meets: the ticks where it does not say what we do). Our distances are held against brute force on every
# 100th tick. BUILD/bench/histograms.csv says how many ticks took `from` up to, not including, `to`: ns, or
# 16-lane blocks (work). PEERS names the peers to run ("fcl cgal"), all by default; one that cannot be built
# or run is named and left out, and is never a failure.
set -u
build=$1
shift
meshes=${*:-torus-5568 torus-13580 torus-20832 torus-39648 torus-61358 liver membrane cloth star}
ticks=${TICKS:-20000}
dir=$build/bench
mkdir -p "$dir"
csv=$dir/results.csv
echo "mesh,triangles,method,kernel,ticks,crossing,median,p99,crossing_median,crossing_p99,other_median,other_p99,max,differs,wrong" >"$csv"
histograms=$dir/histograms.csv
echo "mesh,method,kernel,of,from,to,ticks" >"$histograms"

number() { sed -n "s/.*\"$2\":\([0-9.e+-]*\).*/\1/p" "$1"; }
field() { sed -n "s/.*\"$2\":{[^}]*\"$3\":\([0-9.]*\).*/\1/p" "$1"; }

row() { # method kernel json differs wrong
    printf '  %-22s %9s %9s %9s %9s %9s %9s %10s  %-9s %s\n' "$1 $2" "$(field "$3" ns median)" \
        "$(field "$3" ns p99)" "$(field "$3" ns_crossing median)" "$(field "$3" ns_crossing p99)" \
        "$(field "$3" ns_other median)" "$(field "$3" ns_other p99)" "$(field "$3" ns max)" "$4" "$5"
    echo "$name,$triangles,$1,$2,$ticks,$crossing,$(field "$3" ns median),$(field "$3" ns p99),$(field "$3" ns_crossing median),$(field "$3" ns_crossing p99),$(field "$3" ns_other median),$(field "$3" ns_other p99),$(field "$3" ns max),$4,$5" >>"$csv"
}

# Bins that are empty are left out; the one below all edges is from 0, the one above all has no `to`.
histogram() { # method kernel json; a peer that counts none gives no rows
    for of in ns work; do
        sed -n "s/.*\"${of}_histogram\":{\"edges\":\[\([0-9,]*\)\],\"counts\":\[\([0-9,]*\)\]}.*/\1 \2/p" "$3" |
            awk -v key="$name,$1,$2,$of" '{ edges = split($1, edge, ","); bins = split($2, count, ",")
                for (i = 1; i <= bins; i++)
                    if (count[i] > 0)
                        print key "," (i > 1 ? edge[i - 1] : 0) "," (i <= edges ? edge[i] : "") "," count[i] }'
    done >>"$histograms"
}

# Not the z-buffer, which is asked for crossings alone (table1.sh).
PEERS=${PEERS-fcl coal cgal embree bullet libccd}
. tests/bench/peers.sh

against() { # OUT.csv, its column of the distance: the largest difference from ours, and the ticks that are wrong
    awk -F, -v column="$2" -v bound="$bound" 'NR == FNR { if (FNR > 1) ours[$1] = $4; next }
        FNR == 1 { next }
        $column == "" { wrong += ours[$1] == 0; next }
        { d = $column - ours[$1]; d = d < 0 ? -d : d; if (d > worst) worst = d; wrong += d > bound }
        END { printf "%.2g %d", worst, wrong }' "$file.ours.csv" "$1"
}

for name in $meshes; do
    file=$dir/$(basename "$name")
    case $name in
    *.*) "$build/dynpoint" compile "$name" -o "$file.dpa" 2>/dev/null ;;
    *) "$build/dynpoint" make $(echo "$name" | tr - ' ') -o "$file.ply" &&
        "$build/dynpoint" compile "$file.ply" -o "$file.dpa" 2>/dev/null ;;
    esac || exit 2
    "$build/dynpoint" make trace --mesh "$file.dpa" --ticks "$ticks" -o "$file.csv" || exit 2
    bound=$("$build/dynpoint" info "$file.dpa" --json | sed -n 's/.*"box":\[\[\([^]]*\)\],\[\([^]]*\)\]\].*/\1,\2/p' |
        awk -F, '{ printf "%.17g", 1e-9 * sqrt(($4 - $1)^2 + ($5 - $2)^2 + ($6 - $3)^2) }')
    triangles=$("$build/dynpoint" info "$file.dpa" --json | sed -n 's/^{"triangles":\([0-9]*\).*/\1/p')

    "$build/dynpoint" replay "$file.dpa" "$file.csv" -o "$file.ours.csv" --until track --repeat 3 \
        --against brute --every 100 --json >"$file.auto.json" || exit 1
    crossing=$(number "$file.auto.json" crossing)
    histogram exact auto "$file.auto.json"
    echo "$(basename "$name"): $triangles triangles, $ticks ticks, $crossing crossing; ns a tick"
    printf '  %-22s %9s %9s %9s %9s %9s %9s %10s  %-9s %s\n' '' median '99 %' 'crossing' '99 %' 'other' '99 %' max 'differs' wrong
    for kernel in scalar sse2 avx2 avx512 neon; do
        "$build/dynpoint" replay "$file.dpa" "$file.csv" -o "$file.$kernel.csv" --until track --repeat 3 \
            --kernel $kernel --json >"$file.$kernel.json" 2>/dev/null || continue
        cmp -s "$file.$kernel.csv" "$file.ours.csv" || { echo "$kernel gives other answers"; exit 1; }
        row exact "$kernel" "$file.$kernel.json" 0 0
    done
    if "$build/dynpoint" replay "$file.dpa" "$file.csv" -o "$file.contact.csv" --until contact \
        --repeat 3 --json >"$file.contact.json"; then
        row exact contact "$file.contact.json" $(against "$file.contact.csv" 4)
    fi
    if "$build/dynpoint" replay "$file.dpa" "$file.csv" -o "$file.tree.csv" --method tree --until track \
        --repeat 3 --json >"$file.tree.json"; then
        row tree warm "$file.tree.json" $(against "$file.tree.csv" 4)
        histogram tree warm "$file.tree.json"
    fi
    if "$build/dynpoint" replay "$file.dpa" "$file.csv" -o "$file.paper.csv" --method paper --parts 1 --until track \
        --repeat 3 --json >"$file.paper.json"; then
        row paper K=1 "$file.paper.json" $(against "$file.paper.csv" 4)
    fi
    [ -z "$ready" ] || "$build/tests/bench/dump_mesh" "$file.dpa" "$file.tri" || exit 2
    for peer in $ready; do
        called=$(echo "$peers" | sed -n "s/^$peer [^ ]* [^ ]* //p")
        if ! "$dir/peer_$peer" "$file.tri" "$file.csv" -o "$file.$peer.csv" --json >"$file.$peer.json"; then
            echo "  $called failed"
            continue
        fi
        row $called "$file.$peer.json" $(against "$file.$peer.csv" 2)
        histogram $called "$file.$peer.json"
        [ $peer != libccd ] ||
            echo "    libccd says only whether they meet: $(number "$file.$peer.json" pairs) pairs a tick, $(number "$file.$peer.json" pair_ns) ns a pair"
    done
    echo "  against brute force: $(sed -n 's/.*"against":{[^}]*"ticks":\([0-9]*\),"wrong":\([0-9]*\),[^}]*"largest_error":\([0-9.e+-]*\).*/\2 of \1 ticks wrong, largest error \3 m/p' "$file.auto.json")"
done
