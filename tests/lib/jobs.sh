# SPDX-License-Identifier: BSD-3-Clause
# The tests of a run, some at a time. run.sh reads it in, in the root of the tree, and begins with `begin_jobs TIER`.
#
#   run TITLE COMMAND...                 a program or script that ends in "N passed, M failed, K skipped": run later
#   run_reading PATHS TITLE COMMAND...   likewise, a script that depends on these paths and the tests alone
#   run_waiting TITLE COMMAND...         likewise, for what waits more than it computes
#   run_clock TITLE COMMAND...           likewise, for what looks at the clock too closely to run beside its like
#   go LANES                             runs what was named since the last go, so many at a time
#   add_up                               prints what all said, and adds up their last lines: $passed $failed $skipped
#
# What has passed in this tree, in the same tier, is not run again while nothing has changed that it depends on: the
# compiler, some of the environment, the tests' data, the words of its command and the bytes of the files that they name.
# A script depends on all sources too. What was skipped in part has not passed. With WHOLE=1 all is run.

begin_jobs() { # TIER
    passed=0 failed=0 skipped=0 count=0 next=1 reads=
    log=build/$1.log names=build/$1.skipped dir=build/$1 kept=build/passed/$1
    rm -rf "$dir"
    mkdir -p "$dir" "$kept"
    : >"$log"
    : >"$names"
    [ "$1" != test ] || unset DPT_DATA
    surroundings=$({
        env | grep -E '^(CC|CXX|CLANG|CFLAGS|CFLAGS_EXTRA|LDFLAGS|DPT_DATA|STRICT|PATH)=' | LC_ALL=C sort
        ${CC:-cc} --version
        [ -z "${DPT_DATA:-}" ] || ls -lRL "$DPT_DATA"
        find tests docs/samples -type f ! -name '*.[ch]' ! -name '*.cc' ! -name '*.sh' ! -name '*.py' ! -name '*.js' \
            ! -name '*.mk' ! -path '*/__pycache__/*' -exec cksum {} + | LC_ALL=C sort -k 3
    } | cksum)
    everything=$(contents Makefile include src drivers tools tests docs)
}

fail() {
    echo "  FAIL $1"
    failed=$((failed + 1))
}

skip() {
    echo "  skip $1: $2" | tee -a "$names"
    skipped=$((skipped + 1))
}

contents() {
    find "$@" -type f ! -path '*/__pycache__/*' -exec cksum {} + | LC_ALL=C sort -k 3 | cksum
}

# What the test of these words depends on. Two programs read what the build makes beside them.
key_of() { # words...
    echo "$surroundings $*"
    for word; do [ ! -f "$word" ] || cksum <"$word"; done
    case "$* " in
    *.sh\ * | *.py\ *)
        cat build/built_with.h
        if [ -n "$reads" ]; then contents $reads; else echo "$everything"; fi
        ;;
    *test_exactness\ *) cksum <build/dynpoint ;;
    *test_openhaptics* | *test_hd_stand_in*) cat "${1%/*}"/libHD-*.so | cksum ;;
    esac
}

run() {
    count=$((count + 1))
    place=$(printf %s/%03d "$dir" "$count")
    printf '%s\n' "$1" >"$place.title"
    shift
    for word; do printf "'%s' " "$word"; done >"$place.command"
    key_of "$@" >"$place.key"
}

run_reading() {
    reads="$1 tests Makefile"
    shift
    run "$@"
    reads=
}

run_waiting() {
    run "$@"
    : >"$place.waits"
}
run_clock() {
    run "$@"
    : >"$place.clock"
}

# run_one PLACE [NICE...]: the last line of `times` is what the command computed.
run_one() {
    place=$1 before=$kept/$(cksum <"$1.command" | tr ' ' -)
    shift
    if [ "${WHOLE:-0}" = 0 ] && cmp -s "$place.key" "$before.key"; then
        cp "$before.out" "$place.out"
        echo 0 0 as-before >"$place.status"
        return
    fi
    rm -f "$before.key"
    begin=$(date +%s)
    "$@" sh -c '. "$0"; code=$?; times >"$1"; exit $code' "$place.command" "$place.times" >"$place.out" 2>&1 </dev/null
    status=$?
    echo $status $(($(date +%s) - begin)) "$(tail -n 1 "$place.times" | tr " " +)" >"$place.status"
    if [ $status -eq 0 ] && tail -n 1 "$place.out" | grep -qE '^[0-9]+ passed, 0 failed, 0 skipped$'; then
        cp "$place.out" "$before.out" && cp "$place.key" "$before.key"
    fi
}

# lane [NICE...]: one after the other of what stdin names, but for what another lane has taken.
lane() {
    while read -r place; do
        ! mkdir "$place.taken" 2>/dev/null || run_one "$place" "$@"
    done
}

# What looks at the clock has a lane of its own, after what waits. Half of its time it waits, so the others are as many as
# without it, and give way to it. What waits takes none of their places, and goes at once.
go() { # LANES
    : >"$dir/computing"
    : >"$dir/waiting"
    : >"$dir/clock"
    while [ "$next" -le "$count" ]; do
        place=$(printf %s/%03d "$dir" "$next")
        list=computing
        [ ! -e "$place.waits" ] || list=waiting
        [ ! -e "$place.clock" ] || list=clock
        echo "$place" >>"$dir/$list"
        next=$((next + 1))
    done
    {
        for waiting in $(seq 16); do
            lane <"$dir/waiting" &
        done
        wait
        lane <"$dir/clock"
    } &
    for computing in $(seq "$1"); do
        lane nice <"$dir/computing" &
    done
    wait
}

add_up() {
    for title in "$dir"/*.title; do
        place=${title%.title}
        title=$(cat "$title")
        read -r status seconds computed <"$place.status"
        echo "== $title, $seconds s, computed $computed"
        cat "$place.out" | tee -a "$log"
        counts=$(tail -n 1 "$place.out" | sed -n 's/^\([0-9]*\) passed, \([0-9]*\) failed, \([0-9]*\) skipped$/\1 \2 \3/p')
        if [ -z "$counts" ]; then
            fail "$title ended without a sum (status $status)"
            continue
        fi
        set -- $counts
        passed=$((passed + $1)) failed=$((failed + $2)) skipped=$((skipped + $3))
        [ "$status" -eq 0 ] || [ "$2" -gt 0 ] || fail "$title left status $status"
        sed -n "s|^ *skip \(.*\)|  skip \1 ($title)|p" "$place.out" >>"$names"
    done
}
