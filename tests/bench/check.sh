#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# In make check: on the liver, in one run, the exact method is at least twice as fast at the median as FCL warm,
# where the machine has AVX2 or more; and FCL's distances are ours. `sh tests/bench/check.sh BUILD`.
set -u
build=$1
best=$("$build/dynpoint" replay --help >/dev/null 2>&1 && TICKS=6000 PEERS=fcl sh tests/bench/run.sh "$build" liver >"$build/bench.out" 2>&1; echo $?)
cat "$build/bench.out"
passed=0 failed=0 skipped=0
csv=$build/bench/results.csv
median() { awk -F, -v m="$1" -v k="$2" '$3 == m && $4 == k { print $7 }' "$csv"; }
if [ "$best" -ne 0 ]; then
    echo "  FAIL the bench ended with status $best"
    failed=1
elif [ -z "$(median FCL OBBRSS)" ]; then
    echo "  skip FCL: libfcl-dev is not here"
    skipped=1
else
    wide=$(median exact avx512)
    wide=${wide:-$(median exact avx2)}
    if [ -z "$wide" ]; then
        echo "  skip ratio to FCL: the machine has neither AVX2 nor AVX-512"
        skipped=1
    elif awk "BEGIN { exit !($(median FCL OBBRSS) >= 2 * $wide) }"; then
        echo "  ok   FCL takes $(awk "BEGIN { printf \"%.1f\", $(median FCL OBBRSS) / $wide }") times as long at the median"
        passed=1
    else
        echo "  FAIL FCL takes $(median FCL OBBRSS) ns, the exact method $wide"
        failed=1
    fi
    if awk -F, '$3 == "FCL" { exit !($14 < 1e-10) }' "$csv"; then
        echo "  ok   FCL's distances are ours within 1e-10 m"
        passed=$((passed + 1))
    else
        echo "  FAIL FCL differs"
        failed=$((failed + 1))
    fi
fi
echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
