#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# make fuzz: CALLS_RUNS random calls of everything public (10^8) under the sanitizers, on all cores, in pieces of
# 2 million with a seed each, from CALLS_SEED (1) on. Logs are in build/fuzz/log; a piece with a finding says how to
# play it again, and the status is 1.
set -u
runs=${CALLS_RUNS:-100000000}
first=${CALLS_SEED:-1}
jobs=${FUZZ_JOBS:-$(nproc 2>/dev/null || echo 2)}
piece=2000000
log=build/fuzz/log
program=build/sanitize/tests/test_calls
mkdir -p "$log"
rm -f "$log"/calls.*
make -s -j"$jobs" CONFIG=sanitize "$program" || exit 2
export log program piece
count=$(((runs + piece - 1) / piece))
echo "$((count * piece)) random calls on $jobs cores; logs in $log"
seq "$first" $((first + count - 1)) | xargs -n 1 -P "$jobs" sh -c '
    "$program" "$piece" --seed "$0" >"$log/calls.$0" 2>&1 ||
        { echo "  FOUND with seed $0: $log/calls.$0"; echo "$0" >>"$log/calls.found"; }'
total=$(cat "$log"/calls.[0-9]* | sed -n 's/^ *\([0-9]*\) calls$/\1/p' | awk '{ n += $1 } END { print n + 0 }')
findings=$(cat "$log/calls.found" 2>/dev/null | wc -l)
echo "$total random calls, $findings pieces with a finding"
[ "$findings" -eq 0 ]
