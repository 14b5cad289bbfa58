#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The nearest pair of a tool and a mesh whose vertices move each tick: ours with each kernel, beside a mesh that does
# not move, and the peers that refit, in one run. `sh tests/bench/deform.sh BUILD [MESH ...]`; MESH as in run.sh. Prints
# a table and writes BUILD/bench/deform.csv: what tests/bench/deform.c says, for each mesh and motion. Motions are those
# of vertex_motion.h with the farthest that a vertex moves in a tick, m (MOTIONS="modes:1e-4 dent:1e-4"); by default the
# first mesh gets all of them and the others one.
#
#     new positions   until the body or tree has them: of ours the hand-over, of peers the refit
#     query           on ticks whose axis does not cross; each with its ratio to ours with the best kernel
#     error           the largest against brute force over the positions of that tick, of the first 50 ticks and each 20th
#     wrong           of ours, those off by more than their error bound; of peers, by more than 1e-9 of the diagonal
#
# Ours are the middle of REPEATS runs (3). Refits take up to 0.1 s, so all peers but Embree get SLOW_TICKS of the ticks (30),
# once. PEERS is as in peers.sh.
set -u
build=$1
shift
data=${DPT_DATA:+$DPT_DATA/meshes/organs/openhelp_liver.stl $DPT_DATA/meshes/organs/openhelp_stomach.stl}
meshes=${*:-liver torus-61358 cloth-20000 star $data}
motions=${MOTIONS:-modes:1e-4 modes:1e-5 modes:1e-3 dent:1e-4}
ticks=${TICKS:-2000}
dir=$build/bench
mkdir -p "$dir"
csv=$dir/deform.csv
echo "mesh,triangles,vertices,motion,step,subject,ticks,crossing,set_median,set_p99,median,p99,other_median,other_p99,max,work_median,work_p99,compared,wrong,error" >"$csv"

PEERS=${PEERS-fcl embree bullet}
. tests/bench/peers.sh

number() { sed -n "s/.*\"$2\":\([0-9.e+-]*\).*/\1/p" "$1"; }
field() { sed -n "s/.*\"$2\":{[^}]*\"$3\":\([0-9.]*\).*/\1/p" "$1"; }

compared() { # OUT.csv of a peer: how many ticks have the brute force's distance, how many are wrong, the largest error
    awk -F, -v bound="$bound" 'NR == FNR { truth[$1] = $3; next }
        FNR == 1 || truth[$1] == "" { next }
        { d = $2 - truth[$1]; d = d < 0 ? -d : d; if (d > worst) worst = d; wrong += d > bound; count++ }
        END { printf "%d,%d,%.2g", count, wrong, worst }' "$file.moved.csv" "$1"
}

for mesh in $meshes; do
    name=$(basename "$mesh" | sed 's/\..*//')
    file=$dir/deform-$name
    case $mesh in
    *.*) "$build/dynpoint" compile "$mesh" --unit mm -o "$file.dpa" >/dev/null 2>&1 ;;
    *) "$build/dynpoint" make $(echo "$mesh" | tr - ' ') -o "$file.ply" &&
        "$build/dynpoint" compile "$file.ply" -o "$file.dpa" >/dev/null 2>&1 ;;
    esac || { echo "deform: $mesh cannot be compiled" >&2; exit 2; }
    "$build/dynpoint" make trace --mesh "$file.dpa" --ticks "$ticks" -o "$file.csv" || exit 2
    "$build/tests/bench/deform" "$file.dpa" "$file.tri" || exit 2
    "$build/dynpoint" info "$file.dpa" --json >"$file.json"
    bound=$(sed -n 's/.*"box":\[\[\([^]]*\)\],\[\([^]]*\)\]\].*/\1,\2/p' "$file.json" |
        awk -F, '{ printf "%.17g", 1e-9 * sqrt(($4 - $1)^2 + ($5 - $2)^2 + ($6 - $3)^2) }')
    triangles=$(number "$file.json" triangles)
    vertices=$(od -A n -t u4 -N 4 "$file.tri" | tr -d ' ')
    for motion in $motions; do
        key=$name,$triangles,$vertices,${motion%:*},${motion#*:}
        sh tests/bench/repeats.sh "$file.rows" "$build/tests/bench/deform" "$file.dpa" "$file.csv" "${motion%:*}" \
            "${motion#*:}" "$file.moved.csv" >/dev/null || exit 1
        sed -n "/^#/!s/^/$key,/p" "$file.rows" >>"$csv"
        for peer in $ready; do
            few=$ticks option=
            [ "$peer" = embree ] || few=${SLOW_TICKS:-30}
            [ "$peer" != fcl ] || option='--bv rss'
            if ! "$dir/peer_$peer" "$file.tri" "$file.csv" -o "$file.$peer.csv" --motion "$motion" --ticks "$few" $option \
                --json >"$file.$peer.json"; then
                echo "  $peer failed"
                continue
            fi
            ns=
            for of in ns_move ns ns_other; do
                ns=$ns,$(field "$file.$peer.json" $of median),$(field "$file.$peer.json" $of p99)
            done
            echo "$key,$peer,$((few - 1)),$(number "$file.$peer.json" crossing)$ns,$(field "$file.$peer.json" ns max),,,$(compared "$file.$peer.csv")" >>"$csv"
        done
        echo "$name: $triangles triangles, $vertices vertices, ${motion%:*}, ${motion#*:} m a tick; us"
        printf '  %-8s %9s %9s %7s %9s %9s %7s %9s %6s %6s  %-9s %s\n' '' 'positions' '99 %' ratio query '99 %' ratio max work \
            '99 %' error wrong
        awk -F, -v mesh="$name" -v motion="${motion%:*}" -v step="${motion#*:}" '
            $1 != mesh || $4 != motion || $5 != step { next }
            !set { set = $9; query = $13 }
            {
                of_set = $9 > 0 ? sprintf("%.3g", $9 / set) : ""
                of_query = $13 > 0 && query > 0 ? sprintf("%.3g", $13 / query) : ""
                positions = $9 > 0 ? sprintf("%9.2f %9.2f", $9 / 1e3, $10 / 1e3) : sprintf("%19s", "")
                asked = $13 > 0 ? sprintf("%9.2f %9.2f", $13 / 1e3, $14 / 1e3) : sprintf("%19s", "")
                printf "  %-8s %s %7s %s %7s %9.1f %6s %6s  %-9s %s\n", $6, positions, of_set, asked, of_query,
                    $15 / 1e3, $16, $17, $20, $19 " of " $18
            }' "$csv"
        sed -n 's/^#/  of ours:/p' "$file.rows"
    done
    motions=${MOTIONS:-modes:1e-4}
done
