#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# What tests/lib/jobs.sh runs again, and what it keeps: `sh tests/run_test.sh BUILD`. A tree that is made up has a program
# and a script, each of which notes that it ran and says what it is told to. And that what runs beside others leaves theirs
# alone.
set -u
here=$(cd "$(dirname "$0")" && pwd) || exit 2
. "$here/lib/verdict.sh"
scratch=$1/run_test
rm -rf "$scratch"
mkdir -p "$scratch/data" "$scratch/tree"
scratch=$(cd "$scratch" && pwd) || exit 2
cd "$scratch/tree" || exit 2
mkdir -p include src drivers tools tests/data tests/golden docs/samples build/tests
for file in Makefile include/a.h src/a.c drivers/a.c tools/a.c tests/test_a.c tests/data/a.csv docs/a.md docs/samples/a.json \
    build/built_with.h build/dynpoint build/tests/libHD-a.so "$scratch/data/liver.obj"; do
    echo a >"$file"
done
unset CC CFLAGS CFLAGS_EXTRA CXX CLANG LDFLAGS DPT_DATA STRICT WHOLE
export RAN="$scratch/ran" SAYS="$scratch/says" LEAVES=0
for file in build/tests/test_a build/tests/test_exactness build/tests/test_hd_stand_in tests/a.sh; do
    printf '%s\n' '#!/bin/sh' 'echo "$0" >>"$RAN"' 'cat "$SAYS"' 'exit "$LEAVES"' >"$file"
    chmod 755 "$file"
done
tier=check

# A run of the tree's tests; the arguments are the program's.
tests() {
    : >"$RAN"
    (
        . "$here/lib/jobs.sh"
        begin_jobs "$tier"
        run "a program" build/tests/test_a "$@"
        run "the program's own" build/tests/test_exactness
        run_waiting "with a library" build/tests/test_hd_stand_in
        run_clock "a script" sh tests/a.sh build
        run_reading "include src" "a script of the core" sh tests/a.sh core
        go 2
        add_up
        echo "$passed $failed $skipped"
    ) >"$scratch/out"
    ran=$(sed 's,.*/,,' "$RAN" | LC_ALL=C sort | tr '\n' ' ')
}
# again WHAT RAN [ARGUMENT...]: these run now, and the others are kept; all add up to the same.
again() {
    what=$1 expected=$2
    shift 2
    tests "$@"
    [ "$ran" = "$expected" ] && [ "$(tail -n 1 "$scratch/out")" = '15 0 0' ]
    verdict $? "$what: ${ran:-none }ran"
}
changed() { # FILE RAN
    echo b >>"$1"
    again "${1##*/} has changed" "$2"
}
# not_kept WHAT SUM SAYS: whatever passed, then this is said, and all run until they pass again.
not_kept() {
    echo "$3" >"$SAYS"
    WHOLE=1 tests
    tests
    [ "$ran" = "$all" ] && [ "$(tail -n 1 "$scratch/out")" = "$2" ]
    verdict $? "$1 is run again: $ran"
    echo '3 passed, 0 failed, 0 skipped' >"$SAYS"
    LEAVES=0
    again "and when it passes" "$all"
    again "then" ''
}

all='a.sh a.sh test_a test_exactness test_hd_stand_in '
scripts='a.sh a.sh '
echo '3 passed, 0 failed, 0 skipped' >"$SAYS"
again "at first" "$all"
again "then" ''
grep -q '^== a program, 0 s, computed as-before$' "$scratch/out" && [ "$(grep -c '^3 passed' "$scratch/out")" -eq 5 ]
verdict $? "what is kept is said again, and marked"

printf '\n# changed\n' >>build/tests/test_a
again "a program has changed" 'test_a '
again "it has an argument" 'test_a ' 20
again "and another one" 'test_a ' 30
again "and none" '' # as it has passed before
changed build/dynpoint 'test_exactness '
changed build/tests/libHD-a.so 'test_hd_stand_in '
changed build/built_with.h "$scripts"
changed tests/data/a.csv "$all"
changed docs/samples/a.json "$all"
mv tests/data/a.csv tests/data/b.csv
again "a file of data has another name" "$all"
changed tests/test_a.c "$scripts"
changed Makefile "$scripts"
changed include/a.h "$scripts"
changed src/a.c "$scripts"
changed drivers/a.c 'a.sh '
changed tools/a.c 'a.sh '
changed docs/a.md 'a.sh '
printf '\n# changed\n' >>tests/a.sh
again "a script has changed" "$scripts"

for name in CC CXX CLANG CFLAGS CFLAGS_EXTRA LDFLAGS STRICT; do
    export "$name=cc"
    again "$name is set" "$all"
    unset "$name"
    again "$name is not" "$all"
done
mkdir bin
path=$PATH PATH="$PWD/bin:$PATH"
again "PATH is another" "$all"
printf '%s\n' '#!/bin/sh' 'cat "$0"' >bin/cc
chmod 755 bin/cc
again "the compiler is another" "$all"
PATH=$path
again "PATH is as before" "$all"
export DPT_DATA="$scratch/data"
again "DPT_DATA is set" "$all"
changed "$scratch/data/liver.obj" "$all"
tier=test
again "another tier" "$all"
unset DPT_DATA
again "which has no DPT_DATA" ''
tier=check
again "the first tier without it" "$all"
OTHER=b
export OTHER
again "what no test reads is set" ''

not_kept "what fails" '10 5 0' '2 passed, 1 failed, 0 skipped'
not_kept "what skips" '10 0 5' '2 passed, 0 failed, 1 skipped'
not_kept "what ends without a sum" '0 5 0' 'Killed'
LEAVES=3
not_kept "what leaves another status" '15 5 0' '3 passed, 0 failed, 0 skipped'
(WHOLE=1 && export WHOLE && tests && [ "$ran" = "$all" ])
verdict $? "WHOLE=1 runs all"
again "and what passed then is kept" ''

# In a tree of its own a test of one list of faults runs the other list, as check-release does at the same time.
export PLANTED="$scratch/planted"
mkdir -p "$PLANTED/build" && cd "$PLANTED" || exit 2
mkdir -p include src drivers tools docs tests/tools tests/view build/src build/drivers build/tools build/tests
touch build/built_with.h build/src/a.o
printf 'build/dynpoint:\n' >Makefile
echo right >src/a.c
cp -R "$here/lib" "$here/planted.sh" tests
printf '%s\n' 'src/a.c a.sh it is wrong' '- right' '+ wrong' | tee tests/planted.txt >tests/view/planted.txt
cat >tests/tools/a.sh <<'END'
[ "${PWD#*/planted/tests/}" = "$PWD" ] || (cd "$PLANTED" && sh tests/planted.sh build tests/view/planted.txt >said)
if grep -q right src/a.c; then echo "1 passed, 0 failed, 0 skipped"; else echo "0 passed, 1 failed, 0 skipped"; fi
END
sh tests/planted.sh build >"$scratch/out" 2>&1 && tail -n 1 said | grep -q '^4 passed, 0 failed' &&
    tail -n 1 "$scratch/out" | grep -q '^4 passed, 0 failed'
verdict $? "two lists of faults are planted at a time: $(tail -n 1 "$scratch/out")"
cd "$here/.." || exit 2
unlocked=$(grep -nE '^[^#]*make -s [^|]*\b(wasm|npm|page|docs|csharp|java-sources|crate-sources)\b' tests/*/*.sh tests/languages/*/*.sh |
    grep -vE 'flock|"make |^tests/(bench|pictures)/|^tests/languages/ubsan.sh')
[ -z "$unlocked" ]
verdict $? "sources for other languages are made by one test at a time $unlocked"
finish
