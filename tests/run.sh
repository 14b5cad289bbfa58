#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# make check: builds and runs every test in its configurations and adds up their last lines. What was
# skipped is named above the sum. DPT_DATA names the folder of real meshes; STRICT=1 lets skips fail.
set -u
passed=0 failed=0 skipped=0
log=build/check.log
names=build/check.skipped
dir=build/check
count=0 next=1
rm -rf "$dir"
mkdir -p "$dir"
: >"$log"
: >"$names"
jobs=$(nproc 2>/dev/null || echo 2)

fail() {
    echo "  FAIL $1"
    failed=$((failed + 1))
}

skip() {
    echo "  skip $1: $2" | tee -a "$names"
    skipped=$((skipped + 1))
}

# A program or script that ends in "N passed, M failed, K skipped": run later, beside others.
run() {
    count=$((count + 1))
    place=$(printf %s/%03d "$dir" "$count")
    printf '%s\n' "$1" >"$place.title"
    shift
    for word; do printf "'%s' " "$word"; done >"$place.command"
}

# Those that were named so far, at most $1 at a time, and what they said in the order of their names.
go() {
    while [ "$next" -le "$count" ]; do
        printf '%s/%03d\n' "$dir" "$next"
        next=$((next + 1))
    done | xargs -n 1 -P "$1" sh -c '
        begin=$(date +%s)
        eval "$(cat "$0.command")" >"$0.out" 2>&1 </dev/null
        echo $? $(($(date +%s) - begin)) >"$0.status"'
    next=$((count + 1))
}

add_up() {
    for title in "$dir"/*.title; do
        place=${title%.title}
        title=$(cat "$title")
        read -r status seconds <"$place.status"
        echo "== $title, $seconds s"
        cat "$place.out" | tee -a "$log"
        counts=$(tail -n 1 "$place.out" | sed -n 's/^\([0-9]*\) passed, \([0-9]*\) failed, \([0-9]*\) skipped$/\1 \2 \3/p')
        if [ -z "$counts" ]; then
            fail "$title ended without a sum (status $status)"
            continue
        fi
        set -- $counts
        passed=$((passed + $1)) failed=$((failed + $2)) skipped=$((skipped + $3))
        [ "$status" -eq 0 ] || [ "$2" -gt 0 ] || fail "$title left status $status"
        sed -n "s/^ *skip \(.*\)/  skip \1 ($title)/p" "$place.out" >>"$names"
    done
}

# -Werror only here: a warning of a newer compiler must not stop a user.
build() {
    echo "== build $*"
    if make -j"$jobs" CFLAGS_EXTRA=-Werror "$@" >build/check.out 2>&1; then
        passed=$((passed + 1))
    else
        tail -n 40 build/check.out
        fail "build $*"
    fi
}

sh tests/deps.sh
build all test-programs
build CONFIG=scalar all test-programs
build CONFIG=sanitize all test-programs
sh tests/oracle/inside.sh build

# What looks at the clock, or compares times, runs alone at the end.
timed="nasty loop serial serial_faults openhaptics openhaptics_faults openhaptics_open hd_stand_in"
is_timed() { case " $timed " in *" $1 "*) ;; *) false ;; esac; }

for program in build/tests/test_*; do
    [ -x "$program" ] && [ ! -d "$program" ] || continue
    case $program in *.o | *.d) continue ;; esac
    is_timed "${program#build/tests/test_}" || run "$(basename "$program")" "$program"
done
for config in scalar sanitize; do
    for name in read compile parallel mesh damage arm kinematics normal winding parts kernel query world stale handles settings trial sizes region region_forms paper shape budget near sweep_mesh voyages way_sides route_strip strips guard sim replay driver syscalls urgent odrive can can_faults can_open; do
        program=build/$config/tests/test_$name
        [ -x "$program" ] && run "test_$name, $config" "$program"
    done
    run "test_pair, $config" build/$config/tests/test_pair 100000
    for name in sheets sheet_touches walks; do
        run "test_$name, $config" build/$config/tests/test_$name 2000
    done
    run "test_sweep, $config" build/$config/tests/test_sweep 2000
    run "test_depth, $config" build/$config/tests/test_depth 20
    run "test_depth_forms, $config" build/$config/tests/test_depth_forms 20
    run "test_region_integrals, $config" build/$config/tests/test_region_integrals 30
    run "test_route, $config" env -u DPT_DATA build/$config/tests/test_route
done
for name in strip strip_memory overlap recall; do
    run "test_$name, sanitize" env -u DPT_DATA build/sanitize/tests/test_$name
done
run "test_fuzz, sanitize" build/sanitize/tests/test_fuzz 100000
if [ -x build/tests/test_urdf_golden ]; then
    run "test_urdf_golden, sanitize" build/sanitize/tests/test_urdf_golden 5000
    run "test_urdf_arm, sanitize" build/sanitize/tests/test_urdf_arm
else
    skip "robots' descriptions" "no urdfdom with g++"
fi
run "robots' kinematics" sh tests/oracle/urdf.sh build
run "test_wire, sanitize" build/sanitize/tests/test_wire 16
run "test_wire_device, sanitize" build/sanitize/tests/test_wire_device
run "test_silent, scalar" build/scalar/tests/test_silent
run "the libraries" sh tests/abi/check.sh build
run "the layers" sh tests/layers.sh build
run "the layers' own test" sh tests/layers_test.sh build
if command -v python3 >/dev/null 2>&1; then run "other languages" python3 tests/ffi/touch.py build; else skip "other languages" "no python3"; fi
run "other machines" sh tests/cross.sh
[ -x build/tests/test_sweep_exact ] || skip "test_sweep_exact" "no g++ with gmpxx"
go "$jobs"

for name in $timed; do
    run "test_$name" build/tests/test_$name
done
run "test_loop, scalar" build/scalar/tests/test_loop
run "test_loop, sanitize" build/sanitize/tests/test_loop
for name in serial serial_faults openhaptics openhaptics_faults openhaptics_open hd_units hd_stand_in; do
    run "test_$name, sanitize" build/sanitize/tests/test_$name
done
run "the program" sh tests/tools/test_cli.sh build
run "the program, sanitize" sh tests/tools/test_cli.sh build/sanitize
run "firmware" sh tests/firmware/run.sh build
run "a real kernel" sh tests/vm/check.sh build build/sanitize
run "the peer" sh tests/bench/check.sh build
go 1
add_up

echo
if [ -s "$names" ]; then
    echo "skipped:"
    sort -u "$names"
fi
[ "${STRICT:-0}" = 0 ] || failed=$((failed + skipped))
echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
