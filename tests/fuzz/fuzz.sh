#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# make fuzz: FUZZ_RUNS executions in sum (10^8) over all targets, by libFuzzer, on all cores: seven eighths of them
# watched by the targets' own checks alone, which is five to ten times as quick, the last eighth under the address and
# undefined behaviour sanitizers. Six eighths are searches of their own, since a corpus that grows slows its search down
# ten times and more; the least set of inputs that reaches as much is where the last two go on. That set stays in
# build/fuzz/corpus, from which the next run begins; logs are in build/fuzz/log. What is found is left in
# build/fuzz/found, and the status is 1.
#     fuzz.sh [TARGET=SHARE ...]      shares in percent
set -u
runs=${FUZZ_RUNS:-100000000}
jobs=${FUZZ_JOBS:-$(nproc 2>/dev/null || echo 2)}
cc=${FUZZ_CC:-clang}
# An execution that takes ten seconds, or more than this memory, is a finding. Of the schedules the plain one: the other
# spends half of the time on itself.
limits="-entropic=0 -timeout=10 -rss_limit_mb=1024 -malloc_limit_mb=64"

out=build/fuzz
mkdir -p "$out/found" "$out/log" "$out/corpus"
echo 'int LLVMFuzzerTestOneInput(const unsigned char *b, unsigned long n) { return !b && n; }' >"$out/probe.c"
if ! $cc -fsanitize=fuzzer,address,undefined "$out/probe.c" -o "$out/probe" >"$out/log/probe" 2>&1; then
    echo "make fuzz needs clang with libFuzzer and its sanitizers (Debian: clang), or FUZZ_CC; $cc says:"
    head -n 3 "$out/log/probe"
    exit 2
fi
for config in fuzz fuzz-fast; do
    make -s -j"$jobs" CONFIG=$config CC="$cc" fuzz-programs || exit 2
done
scene=
[ ! -x build/fuzz/tests/fuzz/fuzz_scene ] || scene=scene=2 # it needs jansson
[ $# -gt 0 ] ||
    set -- obj=17 stl=12 ply=18 off=11 tetgen=2 regions=2 trace=5 $scene mesh=10 forged=2 arm=4 wire=8 motor=2 record=4 snapshot=3 request=1

# A piece of work is a target and a seed: so many that every core has some until the end.
rm -f "$out"/log/*.run "$out"/log/*.merge "$out/log/found"
each_target() { # COMMAND SEED...: of every target, so many pieces at a time
    what=$1
    shift
    for seed; do
        for share in $shares; do
            name=${share%=*}
            printf '%s %s %s\0' "$seed" "$name" $((runs / 100 * ${share#*=} / 8 + 1))
        done
    done | xargs -0 -n 1 -P "$jobs" sh -c "$prelude$what" | tee -a "$out/log/found"
}
prelude='
set -- $0
all="$out/corpus/$2 tests/fuzz/corpus/$2"
case $2 in obj | stl | ply | off) all="$all tests/golden-bad" ;; esac
# The longer, the slower, and the less is new.
case $2 in mesh | arm | snapshot) most=4096 ;; stl | record | scene) most=2048 ;; wire | motor) most=512 ;; *) most=1024 ;; esac
'
search='
case $1 in 8) config=fuzz ;; *) config=fuzz-fast ;; esac
dict=
[ ! -f tests/fuzz/$2.dict ] || dict=-dict=tests/fuzz/$2.dict
mkdir -p $out/corpus/$2 $out/search/$2.$1
build/$config/tests/fuzz/fuzz_$2 $limits -max_len=$most -seed=$1 -runs=$3 -print_final_stats=1 $dict \
    -artifact_prefix=$out/found/$2- $out/search/$2.$1 $all >$out/log/$2.$1.run 2>&1 ||
    echo "  FOUND by $2, seed $1: $(grep -m 1 -E "^tests/fuzz|runtime error|ERROR: " $out/log/$2.$1.run)"
'
merge='
mkdir -p $out/merged/$2
build/fuzz-fast/tests/fuzz/fuzz_$2 $limits -max_len=$most -merge=1 $out/merged/$2 $all $out/search/$2.* \
    >$out/log/$2.merge 2>&1 || echo "  FOUND by $2 when its inputs were merged: $out/log/$2.merge"
rm -rf $out/corpus/$2 $out/search/$2.*
mv $out/merged/$2 $out/corpus/$2
'
shares=$*
export out limits
echo "$runs executions on $jobs cores; logs in $out/log"
each_target "$search" 1 2 3 4 5 6
each_target "$merge" 0
each_target "$search" 7 8
each_target "$merge" 0

total=0
for share; do
    name=${share%=*}
    done_here=$(cat "$out"/log/"$name".*.run | sed -n 's/^stat::number_of_executed_units: *//p' | awk '{ n += $1 } END { print n + 0 }')
    sanitized=$(sed -n 's/^stat::number_of_executed_units: *//p' "$out/log/$name.8.run")
    echo "  $name: $done_here executions, ${sanitized:-0} of them under the sanitizers, $(ls "$out/corpus/$name" | wc -l) inputs in its work corpus"
    total=$((total + done_here))
done
findings=$(wc -l <"$out/log/found")
echo "$total executions, $findings pieces with a finding"
[ "$findings" -eq 0 ]
