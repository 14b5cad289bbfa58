#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# What a needle feels that is pushed through a liver, by each law, on the same motion: `sh tests/bench/needle.sh BUILD`
# writes BUILD/bench/needle.csv. DPT_DATA names the folder of real meshes; without it there is nothing to do.
#
# The needle is 120 mm long and 4 mm thick. It lies on a lobe of the liver and is pushed in sideways, 27 mm deep at
# 50 mm/s, and held there, with a tremor whose peaks are about 0.2 mm. K = 500 N/m.
#
#     ms              from the beginning
#     depth           of the needle below the plane that it touches first, mm
#     LAW_force       of the force the way out of that plane, N
#     LAW_turn        between the force and that of the tick before, degrees; nothing where one is below 0.05 N
set -u
build=$1
dir=$build/bench
csv=$dir/needle.csv
liver=${DPT_DATA:-}/meshes/organs/openhelp_liver.stl
[ -f "$liver" ] || { echo "  needle left out: DPT_DATA has no meshes/organs/openhelp_liver.stl"; exit 0; }
mkdir -p "$dir"
"$build/dynpoint" compile "$liver" --unit mm -o "$dir/needle.dpa" >/dev/null || exit 1

# A place on the liver, the way out there, and the needle's direction.
frame='split("0.021728063 0.118415365 0.134204803", place); split("0.989543722 -0.079506331 -0.120341037", out)
       split("0.097431043 -0.246737478 0.964172085", along)'

awk "BEGIN { $frame"'
    print "tick,ax,ay,az,bx,by,bz"
    seed = 7
    for (i = 0; i < 1000; i++) {
        height = i < 600 ? 0.005 - 5e-5 * i : -0.025
        printf "%d", i
        for (k = 1; k <= 3; k++) {
            seed = (16807 * seed) % 2147483647
            tremor[k] = 0.9 * tremor[k] + 1.2e-4 * (seed / 2147483647 - 0.5)
            middle[k] = place[k] + height * out[k] + tremor[k]
        }
        for (end = -1; end <= 1; end += 2)
            for (k = 1; k <= 3; k++)
                printf ",%.9f", middle[k] + end * 0.06 * along[k]
        print ""
    } }' >"$dir/needle-motion.csv"

for law in point bed proxy; do
    "$build/dynpoint" replay "$dir/needle.dpa" "$dir/needle-motion.csv" -o "$dir/needle-$law.csv" --radius 0.002 \
        --stiffness 500 --law $law >/dev/null || exit 1
done

# Beside each other: the motion, and a replay a law.
paste -d, "$dir/needle-motion.csv" "$dir/needle-point.csv" "$dir/needle-bed.csv" "$dir/needle-proxy.csv" |
    awk -F, "BEGIN { $frame }"'
    function turn(law, x, y, z,    size, cosine, sine, said) {
        size = sqrt(x * x + y * y + z * z)
        cosine = (x * wasx[law] + y * wasy[law] + z * wasz[law]) / (size * was[law] + 1e-300)
        sine = cosine < 1 && cosine > -1 ? sqrt(1 - cosine * cosine) : 0
        said = size < 0.05 || was[law] < 0.05 ? "" : sprintf("%.1f", atan2(sine, cosine) * 57.29577951)
        wasx[law] = x; wasy[law] = y; wasz[law] = z; was[law] = size
        return said
    }
    NR == 1 {
        for (i = 8; i <= NF; i++)
            if ($i == "fx")
                column[laws++] = i
        print "ms,depth,point_force,bed_force,proxy_force,point_turn,bed_turn,proxy_turn"
        next
    }
    {
        depth = 0.002
        for (k = 1; k <= 3; k++)
            depth -= (0.5 * ($(1 + k) + $(4 + k)) - place[k]) * out[k]
        line = sprintf("%d,%.3f", $1, 1e3 * depth)
        for (law = 0; law < 3; law++) {
            at = column[law]
            line = line sprintf(",%.3f", $at * out[1] + $(at + 1) * out[2] + $(at + 2) * out[3])
        }
        for (law = 0; law < 3; law++) {
            at = column[law]
            line = line "," turn(law, $at, $(at + 1), $(at + 2))
        }
        print line
    }' >"$csv"

awk -F, 'NR > 1 { for (k = 0; k < 3; k++) turns[k] += $(6 + k) > 30 }
    END { printf "  needle through a liver: turns by more than 30 degrees in a tick: point %d, bed %d, proxy %d\n",
        turns[0], turns[1], turns[2] }' "$csv"
