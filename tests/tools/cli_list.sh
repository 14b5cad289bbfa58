#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# `dynpoint compile --list`: many meshes, some malformed; rows, hashes, killed in the middle, done again.
# `sh tests/tools/cli_list.sh BUILD [part]`.
. "$(dirname "$0")/cli.sh"

count=${LIST:-60} # meshes, a tenth of them malformed
[ -z "$is_part" ] || count=20

# One organ, moved a little each time; every tenth is cut or names a vertex that is not there.
"$program" make liver 400 -o liver.obj >/dev/null || exit 2
mkdir -p in made
: >manifest
i=0
while [ $i -lt "$count" ]; do
    awk -v i=$i '$1 == "v" { printf "v %.6f %s %s\n", $2 + i * 0.001, $3, $4; next } { print }
        END { if (i % 20 == 9) print "f 1 2 999999"; if (i % 20 == 19) print "v 1 nan"; }' liver.obj >in/$i.obj
    printf 'in/%s.obj\tmade/%s.dpa\n' $i $i >>manifest
    i=$((i + 1))
done
bad=$((count / 10))

# column N TABLE: without its settings and names
column() { awk -F'\t' -v n="$1" 'NR > 2 { print $n }' "$2"; }

run compile --list manifest -o one.tsv
if [ $status -eq 1 ] && grep -q "one.tsv: $((count - bad)) compiled, $bad refused$" stdout; then ok; else bad "a list: exit $status, $(cat stdout stderr)"; fi
if [ "$(column 1 one.tsv)" = "$(cut -f1 manifest)" ]; then ok; else bad "rows are in the manifest's order"; fi
if [ "$(column 3 one.tsv | grep -vc '^DPT_OK$')" -eq $bad ]; then ok; else bad "verdicts: $(column 3 one.tsv | sort | uniq -c)"; fi
if grep -q 'in/9.obj.*DPT_E_INDEX.*line [0-9]*: ' one.tsv; then ok; else bad "an index: $(grep in/9.obj one.tsv)"; fi
column 2 one.tsv | while read -r file; do [ ! -e "$file" ] || sha256sum "$file" | cut -d' ' -f1; done >sums
if [ "$(column 4 one.tsv | grep .)" = "$(cat sums)" ]; then ok; else bad "hashes are those of sha256sum"; fi
succeeds 'one of them alone' compile in/3.obj -o alone.dpa
if cmp -s alone.dpa made/3.dpa; then ok; else bad "a file of a list is that of a command of its own"; fi

# Killed in the middle, and called again; on two threads, as often as it takes.
mkdir -p kept && mv made/* kept
times=0
while [ $times -lt 40 ]; do
    "$program" compile --list manifest -o two.tsv -j 2 >stdout 2>stderr &
    sleep 0.005
    kill -9 $! 2>/dev/null
    wait $! 2>/dev/null
    [ $? -eq 137 ] || break
    times=$((times + 1))
done
if [ $times -gt 0 ]; then ok; else bad "it was done before it was killed"; fi
grep -v '^in/2.obj' two.tsv >left
{ cat left; printf 'in/2.obj\tmade/2.dpa\tDPT_OK\t12'; } >two.tsv # a row that was cut,
rm -f made/4.dpa                                                # a file that is gone,
printf x >made/5.dpa                                            # and one that is another
run compile --list manifest -o two.tsv -j 2
if [ $status -eq 1 ] && grep -q "of these were there$" stdout; then ok; else bad "again: exit $status, $(cat stdout stderr)"; fi
if [ "$(cut -f1-4,6 one.tsv)" = "$(cut -f1-4,6 two.tsv)" ]; then ok; else bad "the same rows after kills: $(diff one.tsv two.tsv | head -n 3)"; fi
for file in kept/*; do cmp -s "$file" "made/${file#kept/}" || bad "$file is another"; done
if [ "$(ls made | wc -l)" -eq "$(ls kept | wc -l)" ]; then ok; else bad "files: $(ls made)"; fi
cp two.tsv before.tsv
run compile --list manifest -o two.tsv -j 2
if cmp -s two.tsv before.tsv; then ok; else bad "a third time changes nothing, not even seconds"; fi

# A call that works on a list, at a pipe that nobody writes to yet, keeps a second one out; a killed one does not.
mkfifo slow.obj
for ending in kill write; do
    printf 'in/1.obj\tmade/lock.dpa\nslow.obj\tmade/slow.dpa\n' >held
    rm -f held.tsv
    "$program" compile --list held -o held.tsv >/dev/null 2>&1 &
    first=$!
    tries=0
    while ! grep -q 'made/lock.dpa' held.tsv 2>/dev/null && [ $tries -lt 600 ]; do
        sleep 0.05
        tries=$((tries + 1))
    done
    # One that is let in would wait at the pipe, too.
    timeout 60 "$program" compile --list held -o other.tsv >stdout 2>stderr
    if [ $? -eq 2 ] && grep -q 'held: another dynpoint works on this list' stderr; then ok; else bad "a list that is worked on ($ending): $(cat stdout stderr)"; fi
    if [ $ending = kill ]; then kill -9 $first; else printf 'v 0 0 0\n' >slow.obj; fi
    wait $first 2>/dev/null
done
if [ "$(column 3 held.tsv | head -n 1)" = DPT_OK ] && [ "$(column 1 held.tsv | wc -l)" -eq 2 ] && [ ! -e other.tsv ]; then ok; else bad "after the lock: $(cat held.tsv)"; fi

refuses 'a list: other settings' 'two.tsv: it is no table of these settings' compile --list manifest -o two.tsv --unit mm
printf 'in/1.obj\tout/1.dpa\nin/2.obj\tout/1.dpa\n' >twice
refuses 'a list: one file twice' "'out/1.dpa' is to be written twice" compile --list twice -o x.tsv
printf 'in/1.obj\tin/1.dpa\nin/2.obj\tin/2.dpa\nin/2.obj\t./in/../in/1.dpa\n' >aliases
refuses 'a list: one file by two names' "'./in/../in/1.dpa' is to be written twice: it is 'in/1.dpa', too" compile --list aliases -o x.tsv
mkfifo piped
timeout 60 sh -c 'head -n 2 manifest >piped' &
timeout 60 "$program" compile --list piped -o piped.tsv >stdout 2>stderr
status=$?
rows=$(column 2 piped.tsv | wc -l)
if [ $status -eq 0 ] && [ "$rows" -eq 2 ]; then ok; else bad "a list from a pipe: $status, $(cat stdout stderr)"; fi
wait
printf 'in/1.obj out/1.dpa\n' >blank
refuses 'a list: no tab' 'blank:1: a line is IN, a tab, OUT' compile --list blank -o x.tsv
printf 'in/1.obj\tin/2.obj\n' >source
refuses 'a list: a source is not written over' "source:1: 'in/2.obj' does not end in .dpa" compile --list source -o x.tsv
refuses 'a list: not C' '--list takes neither --c-array' compile --list manifest -o x.tsv --json
refuses 'a list: two inputs' '--list names the inputs' compile --list manifest in/1.obj -o x.tsv
printf 'in/none.obj\tout/none.dpa\n' >none
run compile --list none -o none.tsv
if [ $status -eq 1 ] && grep -q 'DPT_E_SYSTEM.*No such file' none.tsv; then ok; else bad "a source that is not there: $(cat none.tsv)"; fi
mkdir -p out
cp in/1.obj in/none.obj
run compile --list none -o none.tsv
if [ $status -eq 0 ] && grep -q 'none.tsv: 1 compiled, 0 refused$' stdout; then ok; else bad "now it is: exit $status, $(cat stdout stderr none.tsv)"; fi
short=/sys/devices/system/cpu/possible # the system says it has 4096 bytes
if [ -r $short ]; then
    printf '%s\tout/short.dpa\n' $short >short
    run compile --list short -o short.tsv
    if [ $status -eq 1 ] && grep -q 'DPT_E_SYSTEM.*Input/output error' short.tsv; then ok; else bad "a source that is cut: $(cat short.tsv)"; fi
else
    skip "a source that is cut: no $short"
fi

finish
