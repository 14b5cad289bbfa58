#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Ticks of a proxy by two builds, in turns. `sh tests/bench/proxy_ticks.sh PROGRAM OTHER [MESH [TOOL [MOTION [TICKS
# [FRICTION]]]]]`: both programs are build/tests/bench/proxy_ticks of a build. Each runs TURNS times (5). Prints, for each
# tool and motion, the least median, 99 % and worst of both in us, and how many times longer the first takes; where
# valgrind is, k instructions a tick too. OTHER "-": the instructions of PROGRAM alone, of a TOOL and MOTION.
set -u
[ $# -ge 2 ] || { sed -n 's/^# //p' "$0" >&2; exit 2; }
one=$1 other=$2 mesh=${3:-liver} tool=${4:-} motion=${5:-} ticks=${6:-5000} friction=${7:-0}
work=$(mktemp -d) || exit 2
trap 'rm -rf "$work"' EXIT

# k instructions of all steps, by tick, of a program, a tool and a motion; the first 100 ticks are counted too.
instructions() {
    valgrind --tool=callgrind --toggle-collect=dpt_world_step --callgrind-out-file="$work/out" \
        "$1" "$mesh" "$2" "$3" 2000 "$friction" 1 >/dev/null 2>&1 || return
    awk '/^(summary|totals):/ { printf "%.1f", $2 / 2100 / 1000; exit }' "$work/out"
}

if [ "$other" = - ]; then
    echo "tool,motion,friction,k_instructions"
    echo "$tool,$motion,$friction,$(instructions "$one" "$tool" "$motion")"
    exit
fi

turn=0
while [ $turn -lt "${TURNS:-5}" ]; do
    turn=$((turn + 1))
    "$one" "$mesh" "$tool" "$motion" "$ticks" "$friction" 1 | sed '1d;s/^/one,/' >>"$work/rows" || exit 2
    "$other" "$mesh" "$tool" "$motion" "$ticks" "$friction" 1 | sed '1d;s/^/other,/' >>"$work/rows" || exit 2
done

echo "tool,motion,median_us,other,ratio,p99_us,other,ratio,worst_us,other,k_instructions,other,ratio"
cut -d, -f4,5 "$work/rows" | sort -u | while IFS=, read -r t m; do
    k= l=
    if command -v valgrind >/dev/null; then
        k=$(instructions "$one" "$t" "$m") l=$(instructions "$other" "$t" "$m")
    fi
    awk -F, -v t="$t" -v m="$m" -v k="$k" -v l="$l" '
        $4 == t && $5 == m {
            for (i = 8; i <= 10; i++)
                if (!(($1, i) in best) || $i + 0 < best[$1, i]) best[$1, i] = $i + 0
        }
        END {
            printf "%s,%s", t, m
            for (i = 8; i <= 9; i++)
                printf ",%.2f,%.2f,%.2f", best["one", i], best["other", i], best["one", i] / best["other", i]
            printf ",%.0f,%.0f,%s,%s,%s\n", best["one", 10], best["other", 10], k, l, (l > 0 ? sprintf("%.2f", k / l) : "")
        }' "$work/rows"
done
