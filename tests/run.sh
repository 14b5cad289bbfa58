#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Builds and runs tests and adds up their last lines; what was skipped is named above the sum. programs.txt says which
# program runs where, and how much of it.
#
#     run.sh test     the release build, nothing installed, a part of every kind of test: about a minute on two cores, once
#                     it is built. What needs a build of its own, as programs that count basic blocks do, is not in it
#     run.sh check    all, in three configurations, but for what needs a release alone
#     run.sh release  that, and what takes long for what it can find: all compilers of the single files, link-time
#                     optimization, planted faults
#
# DPT_DATA names the folder of real meshes; STRICT=1 lets skips fail; DEPS=all installs all packages that are used, beside the
# builds. What has passed in this tree and has not changed is not run again (lib/jobs.sh); WHOLE=1 runs all, as .ci/run does.
set -u
whole=$1
case $whole in test | check | release) ;; *) echo "usage: run.sh test|check|release" >&2; exit 2 ;; esac
. tests/lib/jobs.sh
begin_jobs "$whole"
jobs=$(nproc 2>/dev/null || echo 2)

# Only in the whole: a warning of a newer compiler must not stop a user.
werror=
[ "$whole" = test ] || werror=CFLAGS_EXTRA=-Werror
build() {
    echo "== build $*"
    if make -j"$jobs" $werror "$@" >build/$whole.out 2>&1; then
        passed=$((passed + 1))
    else
        tail -n 40 build/$whole.out
        fail "build $*"
    fi
}

# The table's programs of one column: those that compute beside others, those that wait, or those that run alone.
programs() { # column config beside|waits|alone
    if [ "$2" = release ]; then tests=build/tests title= ; else tests=build/$2/tests title=", $2"; fi
    while read -r name test release scalar sanitize how; do
        case $name in '' | '#'*) continue ;; esac
        eval "count_of=\$$1"
        [ "$count_of" != - ] || continue
        [ "$3" = "${how:-beside}" ] || continue
        case $3 in waits) run=run_waiting ;; *) run=run ;; esac
        program=$tests/test_$name
        [ -x "$program" ] || continue
        case $count_of in
        all) $run "test_$name$title" "$program" ;;
        bare) $run "test_$name$title" env -u DPT_DATA "$program" ;;
        *) $run "test_$name$title" "$program" "$count_of" ;;
        esac
    done <tests/programs.txt
}

# The program of a build from outside, a script a topic; with the argument "part" what takes long is left out.
command_line() { # build [part]
    for script in tests/tools/cli_*.sh; do
        topic=${script#*/cli_}
        case $topic in devices.sh) run=run_waiting ;; *) run=run ;; esac
        # Under sanitizers: what reads arguments and files, and what is wrong in them. The library has its programs.
        case $1-$topic in
        */*-usage.sh | */*-scene_faults.sh | */*-meshes.sh | */*-traces.sh) ;;
        */*) continue ;;
        esac
        $run "the program $1, ${topic%.sh}" sh "$script" "$@"
    done
}

# Every program has its line in the table, and the other way round.
lines_and_programs() {
    find tests -name 'test_*.c' ! -path 'tests/vm/*' | sed 's,.*/test_,,; s,\.c$,,' | LC_ALL=C sort >"$dir/sources"
    sed -n 's/^\([a-z][a-z0-9_]*\) .*/\1/p' tests/programs.txt | LC_ALL=C sort >"$dir/lines"
    diff "$dir/lines" "$dir/sources"
}
if ! lines_and_programs; then
    fail "tests/programs.txt does not list the test programs that there are"
fi

if [ "$whole" = test ]; then
    [ -d build/tests ] || echo "all tests are built first, which takes some minutes; they then take about one"
    build all test-programs
    command_line build part
    programs test release waits
    programs test release beside
    run_reading "include src" "races of the exchange" sh tests/exchange/races.sh build 5000
    run "the layers" sh tests/layers.sh build
    run "the first page's figures" python3 -B tests/docs/figures.py
    run "the page of what comes out" python3 -B tests/docs/output.py build
    run "links and anchors" python3 -B tests/docs/links.py
    run "blocks of code in the pages" python3 -B tests/docs/blocks.py build
    if [ -x "$(command -v python3)" ]; then
        run "other languages" python3 tests/ffi/touch.py build
        run "the simulated device's oracle" python3 -B tests/drivers/sim_oracle.py build 4
    else
        skip "other languages, the simulated device's oracle" "no python3"
    fi
    go "$jobs"
    programs test release alone
    go 1
    add_up
else
    compilers=two release=no
    [ "$whole" = check ] || compilers=all release=yes
    # First what the builds look for. Beside them what else is to be had, and an oracle and a peer, which are single files
    # that take long.
    groups=light
    [ "${DEPS:-}" != all ] || groups="light view"
    sh tests/deps.sh $groups
    (
        [ "${DEPS:-}" != all ] || sh tests/deps.sh all
        sh tests/oracle/inside.sh build
        mkdir -p build/bench
        dir=build/bench PEERS='fcl zbuffer'
        . tests/bench/peers.sh
    ) >build/beside.out 2>&1 &
    build all check-programs
    build CONFIG=scalar check-programs
    build CONFIG=sanitize all check-programs
    wait
    cat build/beside.out
    # The emulated machines and the browser look at the clock, and wait for much of their time.
    reads="include src drivers tools/simulate tools/shape tests docs/samples Makefile"
    run_clock "a real kernel" sh tests/vm/check.sh build
    run_clock "firmware" sh tests/firmware/run.sh build
    reads=
    run_clock "the viewer's page" sh tests/view/check.sh build
    run_clock "the page of the core" sh tests/page/check.sh build
    # The longest first.
    run "other machines" env JOBS=1 RELEASE="$release" sh tests/cross.sh build
    run_reading "include src tools/packaging" "single files" env COMPILERS="$compilers" sh tests/amalgamation.sh build
    [ "$whole" = check ] || run "planted faults" sh tests/planted.sh build
    [ "$whole" = check ] || run "planted faults of the page" sh tests/planted.sh build tests/view/planted.txt
    run "the libraries" env RELEASE="$release" sh tests/abi/check.sh build
    run "CMake" sh tests/abi/cmake.sh build
    run "what is installed" sh tests/abi/install.sh build
    run_reading "include src tools/packaging" "WebAssembly" sh tests/wasm/check.sh build
    run_reading "include src tools/packaging" "the package of npm" sh tests/js/check.sh build
    run_reading "include src drivers tools tests/abi docs/samples" "Python's package" env RELEASE="$release" sh tests/python/check.sh build
    run_reading "include src drivers tools tests/abi docs/csharp.md docs/java.md docs/go.md docs/rust.md" \
        "other languages, the same scene" env RELEASE="$release" sh tests/languages/check.sh build
    command_line build
    command_line build/sanitize
    for config in release scalar sanitize; do
        programs $config $config waits
    done
    programs release release beside
    [ -x build/tests/test_urdf_golden ] || skip "robots' descriptions" "no urdfdom with g++"
    [ -x build/tests/test_convex ] || skip "curved tips" "no libccd"
    [ -x build/tests/test_view_server ] || skip "the viewer's server" "no libwebsockets"
    run_reading "include src" "robots' kinematics" sh tests/oracle/urdf.sh build
    run_reading "include src drivers" "libraries for motors" sh tests/drivers/drive_peers.sh build
    run_reading "include src" "races of the exchange" sh tests/exchange/races.sh build
    run "races of threads" sh tests/tools/thread_races.sh build
    run_reading "include src" "MuJoCo's soft bodies" sh tests/bench/soft.sh build
    run_reading "include src" "MuJoCo's soft bodies, felt" sh tests/bench/soft.sh build feel
    run "crossings, and a z-buffer's" sh tests/bench/crossings.sh build
    run "another C library" sh tests/platforms/musl.sh build
    if [ "$whole" = release ]; then
        run_waiting "Windows" env JOBS=1 sh tests/platforms/windows.sh build
        run "an embedder's first hour" sh tests/platforms/embedder.sh build
        run "macOS" env JOBS=1 sh tests/platforms/macos.sh build
        run "Python's wheels" env JOBS=1 sh tests/python/wheels.sh build
        run "LeRobot" env JOBS=1 sh tests/python/lerobot.sh build
        run "Python's package, sanitized" env JOBS=1 sh tests/python/sanitize.sh build
        run "the site of the pages" sh tests/docs/site.sh build
    fi
    run "the layers" sh tests/layers.sh build
    run "the first page's figures" python3 -B tests/docs/figures.py
    run "the page of what comes out" python3 -B tests/docs/output.py build
    run "links and anchors" python3 -B tests/docs/links.py
    run "blocks of code in the pages" python3 -B tests/docs/blocks.py build $([ "$whole" != release ] || echo release)
    run "the layers' own test" sh tests/layers_test.sh build
    run "packages for tests" sh tests/deps_test.sh build
    run_reading "" "what has passed is kept" sh tests/run_test.sh build
    if command -v python3 >/dev/null 2>&1; then
        run "libraries alone" python3 -B tests/platforms/alone.py build
        run "other languages" python3 tests/ffi/touch.py build
        run "declarations for other languages" python3 tests/ffi/cdef.py build
        run "a host in another language" python3 -B tests/ffi/host.py build
        run "the simulated device's oracle" python3 -B tests/drivers/sim_oracle.py build
    else
        skip "other languages" "no python3"
        skip "the simulated device's oracle" "no python3"
    fi
    [ -x build/tests/test_sweep_exact ] || skip "test_sweep_exact, test_sweep_moving" "no g++ with gmpxx"
    for config in sanitize scalar; do
        programs $config $config beside
    done
    go "$jobs"

    # What looks at the clock, or compares times.
    for config in release scalar sanitize; do
        programs $config $config alone
    done
    run "the peer" sh tests/bench/check.sh build
    go 1
    add_up
fi

echo
if [ -s "$names" ]; then
    echo "skipped:"
    sort -u "$names"
fi
[ "${STRICT:-0}" = 0 ] || failed=$((failed + skipped))
echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
