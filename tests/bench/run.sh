#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# make bench: `dynpoint chart` of each mesh with the peers that are here, and of all of them the tables of
# docs/measurements.md. `sh tests/bench/run.sh BUILD [MESH ...]`; MESH is a shape, a shape and its count (torus-61358), or a
# mesh file. BUILD/bench/MESH.chart.* are the charts; meshes.csv has all their rows, behind the mesh and its triangles
# (docs/chart.md says what the columns mean), and histograms.csv those that are drawn: work of the exact method, and times
# on the liver. TICKS (20000), REPEATS (3), UNTIL (contact). PEERS names the peers to run ("fcl cgal"), all by default; one
# that cannot be built or run is named and left out, and is never a failure.
set -u
build=$1
shift
meshes=${*:-torus-5568 torus-13580 torus-20832 torus-39648 torus-61358 liver membrane cloth star}
dir=$build/bench
mkdir -p "$dir"
PEERS=${PEERS-fcl coal cgal embree bullet libccd} # not the z-buffer, which is asked for crossings alone (table1.sh)
. tests/bench/peers.sh
rm -rf "$dir/peers"
mkdir "$dir/peers"
for peer in $ready; do
    ln -s "../peer_$peer" "$dir/peers/peer_$peer"
done
rm -f "$dir/meshes.csv" "$dir/histograms.csv"

for name in $meshes; do
    mesh=$(basename "$name")
    file=$dir/$mesh
    case $name in
    *.*) "$build/dynpoint" compile "$name" -o "$file.dpa" ;;
    *) "$build/dynpoint" make $(echo "$name" | tr - ' ') -o "$file.ply" && "$build/dynpoint" compile "$file.ply" -o "$file.dpa" ;;
    esac >/dev/null 2>&1 || exit 2
    "$build/dynpoint" chart "$file.dpa" --ticks "${TICKS:-20000}" --repeats "${REPEATS:-3}" --until "${UNTIL:-contact}" --radius 0 \
        ${ready:+--peers "$dir/peers"} --title "$mesh" -o "$file.chart" >"$file.chart.txt" || exit 2
    sed -n "s,^# \\(dynpoint\\|times\\|truth\\),\\1,; s,$dir/,,; /^[dt]/p; /^truth/q" "$file.chart.csv"
    triangles=$(sed -n 's/^# body 0: \([0-9]*\) triangles.*/\1/p' "$file.chart.csv")
    for kind in chart chart.histograms; do
        all=$dir/$([ $kind = chart ] && echo meshes || echo histograms).csv
        grep -v '^#' "$file.$kind.csv" | awk -v key="$mesh,$triangles" -v is_new="$([ -e "$all" ]; echo $?)" -F, '
            NR == 1 { if (is_new) print "mesh,triangles," $0; next }
            NF > 6 || $2 == "pair" && ($1 == "exact" && $3 == "work" || key ~ /^liver,/ && $3 == "ns" && $1 ~ /^(exact|tree|fcl)$/) {
                print key "," $0 }' >>"$all"
    done
done
awk -F, -f tests/bench/meshes.awk "$dir/meshes.csv"
