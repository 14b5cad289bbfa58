#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# In make check: the judge of crossings (crossings.cpp) tells right answers from wrong ones, ours and the z-buffer's are
# right, and methods and peers get the same moving vertices. `sh tests/bench/crossings.sh BUILD`.
set -u
. "$(dirname "$0")/../lib/verdict.sh"
build=$1
dir=$build/bench
work=$dir/crossings.files
rm -rf "$work"
mkdir -p "$work"
PEERS=zbuffer
. tests/bench/peers.sh >"$work/peers"
if ! command -v g++ >/dev/null 2>&1; then
    skip "which crossings are missed, invented or misnamed: g++ is not here"
    finish
fi
build_judge
verdict $? "the judge of crossings builds"

# verdict_of MESH FILE...: crossing,missed,invented,misnamed,later,off of the last file, or of each
verdict_of() {
    mesh=$1
    shift
    "$dir/crossings" "$work/$mesh.tri" "$work/$mesh.csv" "$@" | cut -d, -f3-8 | sed 1d
}
is() { # WHAT WANTED GOT
    [ "$2" = "$3" ]
    verdict $? "$1: $3"
}
between() { # WHAT LINE AWK-CONDITION on m, i, n: missed, invented and misnamed
    echo "$2" | awk -F, "{ c = \$1; m = \$2; i = \$3; n = \$4; exit !($3) }"
    verdict $? "$1: $2"
}

# ---- the judge, by answers that are wrong in known ways ----

length=1
for shape in box-12 membrane-512; do
    file=$work/$shape
    "$build/dynpoint" make $(echo $shape | tr - ' ') -o "$file.ply" &&
        "$build/dynpoint" compile "$file.ply" -o "$file.dpa" >/dev/null 2>&1 &&
        "$build/dynpoint" make trace --mesh "$file.dpa" --ticks 5000 --length "$length" -o "$file.trace" &&
        "$build/tests/bench/tori" "$file.dpa" "$file.trace" $shape "$work" >/dev/null
    verdict $? "$shape: mesh, trace and our answers"
    length=0.25
done
ours=$work/membrane-512.exact.csv
crossing=$(awk -F, 'NR > 1 && $2 == 0' "$ours" | wc -l | tr -d ' ')
is "our crossings of a sheet" "$crossing,0,0,0,0,0" "$(verdict_of membrane-512 "$ours")"
[ "$crossing" -ge 200 ]
verdict $? "the sheet is crossed often"

# The tool crosses a flat sheet in one triangle: any other name is wrong.
wrong() { awk -F, -v OFS=, "NR == 1 { print; next } $1 { print }" "$ours" >"$work/wrong.csv"; }
wrong '$2 == 0 && a < 5 { a++; $2 = 0.001 }'
is "5 crossings taken away" "$crossing,5,0,0,0,5" "$(verdict_of membrane-512 "$work/wrong.csv")"
wrong '$2 > 0 && a < 7 { a++; $2 = 0 }'
is "7 put in" "$crossing,0,7,0,0,7" "$(verdict_of membrane-512 "$work/wrong.csv")"
wrong '$2 == 0 && a < 3 { a++; $3 = ($3 + 256) % 512 }'
is "3 with another's name" "$crossing,0,0,3,0,0" "$(verdict_of membrane-512 "$work/wrong.csv")"
wrong '$2 > 0 && a < 4 { a++; $2 *= 1.00001 }'
is "4 distances too large" "$crossing,0,0,0,0,4" "$(verdict_of membrane-512 "$work/wrong.csv")"
wrong '$2 > 0 { $2 = "" }'
is "distances left out" "$crossing,0,0,0,0," "$(verdict_of membrane-512 "$work/wrong.csv")"

# ---- moving vertices: the recorded ones are those that our methods had ----

mkdir "$work/scenes"
"$build/tests/bench/scenes" "$work/scenes" 100 >/dev/null 2>&1
verdict $? "the paper's scenes run"
for scene in membrane cloth laparoscopy; do
    recorded=$("$dir/crossings" "$work/scenes/$scene.tri" "$work/scenes/$scene.csv" \
        --motion "recorded:$work/scenes/$scene.motion" "$work/scenes/$scene.exact.csv" "$work/scenes/$scene.brute.csv" |
        cut -d, -f4-6,8 | sed 1d | sort -u)
    echo "$recorded" | grep -qE '^0,0,0,0?$' && [ "$(echo "$recorded" | wc -l)" -eq 1 ]
    verdict $? "$scene: exact and every triangle are right on what was recorded: $recorded"
done
still=$("$dir/crossings" "$work/scenes/cloth.tri" "$work/scenes/cloth.csv" "$work/scenes/cloth.exact.csv" | cut -d, -f8 |
    sed 1d)
[ "${still:-0}" -gt 50 ]
verdict $? "and wrong on the cloth where it lay at first: $still of 100"

# Where scene and record differ it is by the rounding of positions to float.
for scene in membrane cloth laparoscopy liver; do
    motion=$work/scenes/$scene.motion
    [ -e "$motion" ] || motion=
    error=$("$dir/crossings" "$work/scenes/$scene.tri" "$work/scenes/$scene.csv" ${motion:+--motion "recorded:$motion"} \
        "$work/scenes/$scene.scene" | sed 1d | cut -d, -f4,5,9)
    echo "$error" | awk -F, '{ exit !($1 + $2 == 0 && $3 != "" && $3 < 1e-7) }'
    verdict $? "$scene: the scene's own distances are those of its record (missed, invented, error): $error"
done

# ---- the z-buffer ----

if [ -z "$ready" ]; then
    skip "the z-buffer: $(cat "$work/peers")"
    finish
fi
zbuffer() { # MESH OUT options...
    mesh=$1 answers=$work/$2.csv
    shift 2
    "$dir/peer_zbuffer" "$work/$mesh.tri" "$work/$mesh.csv" -o "$answers" --repeat 1 "$@" 2>"$work/log"
}
if ! zbuffer box-12 box --json >"$work/json"; then
    skip "the z-buffer: $(cat "$work/log")"
    finish
fi
box=$(awk -F, 'NR > 1 && $2 == 0' "$work/box-12.exact.csv" | wc -l | tr -d ' ')
sed -n 's/.*"peer":"z-buffer on \([^"]*\)".*/  drawn by \1/p' "$work/json"
between "of 5000 ticks of a cube, $box crossing, at most 2 wrong" "$(verdict_of box-12 "$work/box.csv")" \
    "c == $box && c >= 200 && m + i + n <= 2"
is "it names the first triangle" 0 "$(verdict_of box-12 "$work/box.csv" | cut -d, -f5)"
zbuffer membrane-512 sheet
between "of a sheet, $crossing crossing, at most 2 wrong" "$(verdict_of membrane-512 "$work/sheet.csv")" \
    "c == $crossing && m + i + n <= 2"
zbuffer membrane-512 coarse --pixel 1
between "with a pixel as wide as the tool is long it errs in all ways" "$(verdict_of membrane-512 "$work/coarse.csv")" \
    'm > 0 && i > 0 && n > 20'

# From the other end it sees the last triangle; of a cube that is another one wherever the tool goes through.
cp "$work/box-12.csv" "$work/kept"
awk -F, -v OFS=, 'NR == 1 { print; next } { print $1, $5, $6, $7, $2, $3, $4 }' "$work/kept" >"$work/box-12.csv"
zbuffer box-12 last
cp "$work/kept" "$work/box-12.csv"
through=$(awk -F, 'NR == FNR { first[$1] = $3; next } FNR > 1 && $2 == 0 && first[$1] != $3' "$work/box.csv" "$work/last.csv" |
    wc -l | tr -d ' ')
is "drawn from the other end, what it names comes later" "$through" "$(verdict_of box-12 "$work/last.csv" | cut -d, -f5)"
[ "$through" -ge 50 ]
verdict $? "the tool goes through the cube often"

# Vertices that move, and one that is drawn where they were.
head -n 801 "$work/membrane-512.trace" >"$work/short.trace"
"$build/tests/bench/tori" "$work/membrane-512.dpa" "$work/short.trace" moving "$work" modes 1e-3 >/dev/null
zbuffer moving moved --motion modes:1e-3
zbuffer moving stale
judged=$("$dir/crossings" "$work/moving.tri" "$work/moving.csv" --motion modes:1e-3 "$work/moving.exact.csv" \
    "$work/moved.csv" "$work/stale.csv" | cut -d, -f3-8 | sed 1d)
is "our crossings of a sheet that moves" "0,0,0,0,0" "$(echo "$judged" | sed -n 1p | cut -d, -f2-)"
between "the z-buffer's, at most 2 wrong" "$(echo "$judged" | sed -n 2p)" 'c > 50 && m + i + n <= 2'
between "it is wrong where the vertices are not handed over" "$(echo "$judged" | sed -n 3p)" 'm + i + n > 20'
finish
