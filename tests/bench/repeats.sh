#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# A program of the bench, run REPEATS times (3). `sh tests/bench/repeats.sh OUT.csv PROGRAM [ARGUMENT ...]`: the program
# prints a CSV, with the same rows each time. OUT.csv gets the middle one of each number, and a last line that begins with #
# and says how far the repeats lie apart in the columns that differ at all. Prints OUT.csv too.
set -u
out=$1 repeat=0 files=
shift
while [ $repeat -lt "${REPEATS:-3}" ]; do
    repeat=$((repeat + 1))
    files="$files $out.$repeat"
    "$@" >"$out.$repeat" || exit 2
done
awk -F, '
    function sort(v, n,   i, k, x) {
        for (i = 2; i <= n; i++) {
            x = v[i]
            for (k = i; k > 1 && v[k - 1] + 0 > x + 0; k--) v[k] = v[k - 1]
            v[k] = x
        }
    }
    FNR == 1 { file++ }
    { fields[FNR] = NF; lines[file] = FNR; for (i = 1; i <= NF; i++) cell[file, FNR, i] = $i }
    END {
        for (f = 2; f <= file; f++)
            if (lines[f] != lines[1]) { print "the repeats have other rows" >"/dev/stderr"; exit 2 }
        for (r = 1; r <= lines[1]; r++) {
            for (i = 1; i <= fields[r]; i++) {
                for (f = 1; f <= file; f++) {
                    v[f] = cell[f, r, i]
                    differs[i] = differs[i] || v[f] != v[1]
                }
                sort(v, file)
                least[r, i] = v[1]
                most[r, i] = v[file]
                printf "%s%s", v[int((file + 1) / 2)], i < fields[r] ? "," : "\n"
            }
        }
        for (r = 1; r <= lines[1]; r++)
            for (i = 1; i <= fields[r]; i++)
                if (differs[i] && least[r, i] > 0) apart[++count] = most[r, i] / least[r, i]
        sort(apart, count)
        if (count)
            printf "# the middle of %d repeats; the largest is %.2f times the least in the middle cell, %.2f at 90 %% and %.2f at most\n",
                file, apart[int((count + 1) / 2)], apart[int(0.9 * count + 0.5)], apart[count]
    }' $files >"$out" || exit 2
rm -f $files
cat "$out"
