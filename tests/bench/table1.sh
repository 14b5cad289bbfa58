#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The paper's comparison: its Table 1, Figures 10 and 11 in its rows and columns, and which crossings each method
# misses, invents or misnames. `sh tests/bench/table1.sh BUILD` prints the tables as Markdown and writes
# BUILD/bench/table1.csv, figure10.csv and crossings.csv. TICKS of each scene (3000), SLIDES of each rigid mesh (5000), MOVES of each deforming
# one (1000), REPEATS (3). PEERS as in peers.sh: fcl, embree (a ray) and zbuffer; one that is not here is named and left
# out, and is never a failure.
#
# All methods get the same tool and the same vertices, bit for bit (play.h). Each runs alone, one pass a run; the runs
# are repeated, and the least median of a run counts. `_most` and `_least` are of the worst run: the spread. FCL runs
# once on the deforming tori.
#
#     check      new positions taken (ours: handed over, peers: the refit, or the upload), then the query; of ours with
#                the paper's methods, the force as well
#     detection  the query alone
#
# crossings.csv: what crossings.cpp says of each method's answers. There z-buffer-2e-3 has a pixel of that share of the
# tool's length, as a picture of 512 pixels across it; on the membrane there are narrower and wider ones.
set -u
build=$1
ticks=${TICKS:-3000} slides=${SLIDES:-5000} moves=${MOVES:-1000} repeats=${REPEATS:-3}
dir=$build/bench
work=$dir/table1
mkdir -p "$work"
times=$work/times # lines: name, method, check or detection, ns
verdicts=$dir/crossings.csv
: >"$times"
echo "name,motion,method,ticks,crossing,missed,invented,misnamed,later,off,error" >"$verdicts"

PEERS=${PEERS-fcl embree zbuffer}
. tests/bench/peers.sh
build_judge || echo "left out: the judge of crossings (g++ is not here)"

field() { sed -n "s/.*\"$2\":{[^}]*\"$3\":\([0-9.]*\).*/\1/p" "$1"; }

# Rows of play.h, into the times: a check is the first stage of `stages` that a method has.
ours() { # ROWS
    awk -F, '$1 == "scene" { next }
        $2 == "scene" { print $1, ($3 == "respond" ? "exact-force" : "exact-physics"), "check", $6; next }
        $3 == "track" { print $1, $2, "detection", $6; if ($2 == "exact") print $1, $2, "check", $5 + $6 }
        $2 == "exact" && $3 == "contact" { print $1, "exact-contact", "check", $5 + $6 }
        $2 == "exact" && $3 == "respond" { print $1, "exact-proxy", "check", $5 + $6 }
        $2 != "exact" && $3 == "respond" { print $1, $2, "check", $5 + $6 }' "$1" >>"$times"
}

ask() { # METHOD PEER NAME TICKS MOTION options...: the peer's times and answers
    method=$1 peer=$2 name=$3 few=$4 motion=$5
    shift 5
    case " $ready " in *" $peer "*) ;; *) return ;; esac
    if ! "$dir/peer_$peer" "$work/$name.tri" "$work/$name.csv" -o "$work/$name.$method.csv" --ticks "$few" --repeat 1 \
        ${motion:+--motion "$motion"} "$@" --json >"$work/$name.$method.json"; then
        echo "left out: $peer, which does not run"
        ready=$(echo " $ready " | sed "s/ $peer / /")
        return
    fi
    query=$(field "$work/$name.$method.json" ns median)
    moved=$(field "$work/$name.$method.json" ns_move median)
    echo "$name $method check $((query + ${moved:-0}))
$name $method detection $query" >>"$times"
}

peers_of() { # NAME TICKS MOTION
    case $1,$repeat in
    *-moving,[1-9]*) ;; # a refit takes a tenth of a second: once
    *) ask fcl fcl "$1" "$2" "$3" --bv rss ;;
    esac
    ask ray embree "$1" "$2" "$3" --parts ray
    ask z-buffer zbuffer "$1" "$2" "$3"
}

judge() { # NAME MOTION TICKS: all answers that are there
    [ -x "$dir/crossings" ] || return
    pixels=2e-3
    [ "$1" != membrane-512 ] || pixels='1 1e-1 1e-2 2e-3 1e-3 1e-4'
    for pixel in $pixels; do
        ask z-buffer-$pixel zbuffer "$1" "$3" "$2" --pixel $pixel
    done
    "$dir/crossings" "$work/$1.tri" "$work/$1.csv" ${2:+--motion "$2"} "$work/$1".*.csv |
        sed -n "s,^$work/$1\.\(.*\)\.csv,$1\,${2:-rigid}\,\1,p" | sed 's/recorded:[^,]*/recorded/' >>"$verdicts"
}

rm -f "$work"/*.*
repeat=0
while [ $repeat -lt "$repeats" ]; do
    "$build/tests/bench/scenes" "$work" "$ticks" >"$work/rows" 2>/dev/null || exit 2
    ours "$work/rows"
    for scene in membrane cloth laparoscopy liver; do
        motion=$work/$scene.motion
        [ -e "$motion" ] && motion=recorded:$motion || motion=
        peers_of $scene "$ticks" "$motion"
        [ $repeat -gt 0 ] || judge $scene "$motion" "$ticks"
    done
    repeat=$((repeat + 1))
done

# The tori of Figure 10, and other shapes that a tool slides over and through.
tori='torus-5568 torus-13580 torus-20832 torus-39648 torus-61358'
for shape in $tori liver-50332 star-20480 cloth-2048 membrane-512; do
    file=$work/$shape
    "$build/dynpoint" make $(echo $shape | tr - ' ') -o "$file.ply" &&
        "$build/dynpoint" compile "$file.ply" -o "$file.dpa" >/dev/null 2>&1 &&
        "$build/dynpoint" make trace --mesh "$file.dpa" --ticks "$slides" -o "$file.trace" &&
        head -n $((moves + 1)) "$file.trace" >"$file.short" || exit 2
    repeat=0
    while [ $repeat -lt "$repeats" ]; do
        "$build/tests/bench/tori" "$file.dpa" "$file.trace" $shape "$work" >"$work/rows" || exit 2
        ours "$work/rows"
        peers_of $shape "$slides" ''
        [ $repeat -gt 0 ] || judge $shape '' "$slides"
        case $shape in torus*)
            "$build/tests/bench/tori" "$file.dpa" "$file.short" $shape-moving "$work" modes 1e-4 >"$work/rows" || exit 2
            ours "$work/rows"
            peers_of $shape-moving "$moves" modes:1e-4
            [ $repeat -gt 0 ] || judge $shape-moving modes:1e-4 "$moves"
            ;;
        esac
        repeat=$((repeat + 1))
    done
done
renderer=$(cat "$work"/*.z-buffer.json 2>/dev/null | sed -n '1s/.*"peer":"z-buffer on \([^"]*\)".*/\1/p')
awk -v renderer="$renderer" -v table="$dir/table1.csv" -v figure="$dir/figure10.csv" -f tests/bench/table1.awk \
    "$times" "$verdicts"
