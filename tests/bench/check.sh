#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# In make check: on the liver, in one run, the exact method is at least twice as fast at the median as FCL warm,
# where the machine has AVX2 or more; and FCL's distances are ours. And repeats are joined. `sh tests/bench/check.sh BUILD`.
set -u
. "$(dirname "$0")/../lib/verdict.sh"
build=$1
csv=$build/bench/meshes.csv
cell() { # NAME COLUMN, of the nearest pair
    awk -F, -v name="$1" -v column="$2" 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i }
        $at["part"] == "pair" && $at["name"] == name { print $at[column] }' "$csv"
}

# A program that takes 4, 1 and 2 us for one thing, and always 10 for another.
mkdir -p "$build/bench"
thrice=$build/bench/thrice
rm -f "$thrice.calls"
cat >"$thrice.sh" <<END
echo >>"$thrice.calls"
case \$(wc -l <"$thrice.calls") in 1) us=4 ;; 2) us=1 ;; *) us=2 ;; esac
printf 'name,ticks,us\na,7,%s\nb,7,10\n' \$us
END
sh tests/bench/repeats.sh "$thrice.csv" sh "$thrice.sh" >"$thrice.out"
verdict $? "a program is run three times"
[ "$(cat "$thrice.csv")" = "name,ticks,us
a,7,2
b,7,10
# the middle of 3 repeats; the largest is 1.00 times the least in the middle cell, 4.00 at 90 % and 4.00 at most" ]
verdict $? "its middle times, and how far they lie apart: $(tail -n 1 "$thrice.csv")"
cmp -s "$thrice.csv" "$thrice.out"
verdict $? "are printed, too"

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
[ "$(grep -cE '^\| fcl \| [0-9.]+ / [0-9.]+ \| \|$' "$build/bench.out")" -eq 3 ]
verdict $? "each of three tables has its row, and says nowhere why it is faster"
finish
