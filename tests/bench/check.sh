#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# In make check: on the liver, in one run, the exact method is at least twice as fast at the median as FCL warm,
# where the machine has AVX2 or more; and FCL's distances are ours. `sh tests/bench/check.sh BUILD`.
set -u
. "$(dirname "$0")/../lib/verdict.sh"
build=$1
csv=$build/bench/meshes.csv
cell() { # NAME COLUMN, of the nearest pair
    awk -F, -v name="$1" -v column="$2" 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i }
        $at["part"] == "pair" && $at["name"] == name { print $at[column] }' "$csv"
}

TICKS=10000 REPEATS=1 UNTIL=track PEERS=fcl sh tests/bench/run.sh "$build" liver >"$build/bench.out" 2>&1
status=$?
cat "$build/bench.out"
if [ $status -ne 0 ]; then
    bad "the bench ended with status $status"
    finish
fi
fcl=$(cell fcl median_us)
if [ -z "$fcl" ]; then
    skip "FCL: libfcl-dev is not here"
    finish
fi
ours=$(cell exact median_us)
case $(cell exact kernel) in
avx*)
    awk "BEGIN { exit !($fcl >= 2 * $ours) }"
    verdict $? "FCL takes $(awk "BEGIN { printf \"%.1f\", $fcl / $ours }") times as long at the median: $fcl us, ours $ours"
    ;;
*) skip "ratio to FCL: the machine has neither AVX2 nor AVX-512" ;;
esac
awk "BEGIN { exit !($(cell fcl distance_error_m) < 1e-10) }"
verdict $? "FCL's distances are ours within 1e-10 m"
finish
fi
fcl=$(median FCL OBBRSS)
if [ -z "$fcl" ]; then
    skip "FCL: libfcl-dev is not here"
    finish
fi
ours=$(median exact avx512)
ours=${ours:-$(median exact avx2)}
if [ -z "$ours" ]; then
    skip "ratio to FCL: the machine has neither AVX2 nor AVX-512"
else
    awk "BEGIN { exit !($fcl >= 2 * $ours) }"
    verdict $? "FCL takes $(awk "BEGIN { printf \"%.1f\", $fcl / $ours }") times as long at the median: $fcl ns, ours $ours"
fi
awk -F, '$3 == "FCL" { exit !($14 < 1e-10) }' "$csv"
verdict $? "FCL's distances are ours within 1e-10 m"
finish
