#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The exchange of the latest value under ThreadSanitizer: `sh tests/exchange/races.sh BUILD [PUBLISHES]`. The shipped
# code has no race in two threads and 10^6 publishes; without one acquire or release it has one each time.
set -u
build=$1
publishes=${2:-1000000}
here=$(dirname "$0")
. "$here/../lib/verdict.sh"
scratch=$build/races
rm -rf "$scratch"
mkdir -p "$scratch"

# compiled OUTPUT ARGUMENT...: a program with the sanitizer.
compiled() {
    output=$1
    shift
    ${CC:-cc} -std=gnu99 -O2 -g -fsanitize=thread -Iinclude -Isrc -Itests "$@" -pthread -o "$output"
}

# The sanitizer does not start where the kernel puts a program at places that it does not expect.
cat >"$scratch/race.c" <<'END'
#include <pthread.h>
static int shared;
static void *add(void *unused)
{
    shared++;
    return unused;
}
int main(void)
{
    pthread_t thread;
    if (pthread_create(&thread, 0, add, 0))
        return 2;
    shared++;
    return pthread_join(thread, 0);
}
END
told='WARNING: ThreadSanitizer: data race'
fixed=
if ! compiled "$scratch/race" "$scratch/race.c" >"$scratch/race.out" 2>&1; then
    skip "the exchange under ThreadSanitizer: the compiler has none"
    finish
fi
"$scratch/race" >"$scratch/race.out" 2>&1
if ! grep -q "$told" "$scratch/race.out"; then
    fixed='setarch -R'
    $fixed "$scratch/race" >"$scratch/race.out" 2>&1
fi
if ! grep -q "$told" "$scratch/race.out"; then
    skip "the exchange under ThreadSanitizer: it cannot run here ($(head -n 1 "$scratch/race.out"))"
    finish
fi

sources="$here/test_latest.c src/exchange/latest.c tests/lib/check.c"
# shellcheck disable=SC2086 # words
check "the test builds with ThreadSanitizer" compiled "$scratch/test_latest" $sources
$fixed "$scratch/test_latest" "$publishes" >"$scratch/shipped.out" 2>&1
verdict $? "two threads and $publishes publishes: no race"
tail -n 1 "$scratch/shipped.out" | grep -q '^3 passed, 0 failed'
verdict $? "and all values are whole"

# races_without WHAT PUBLISH TAKE: with these orders the sanitizer tells a race in the threads' values.
races_without() {
    program=$scratch/relaxed
    # shellcheck disable=SC2086 # words
    compiled "$program" -include "$here/relaxed_latest.h" -DPUBLISH_ORDER="__ATOMIC_$2" -DTAKE_ORDER="__ATOMIC_$3" \
        $sources || { bad "the test builds without $1"; return; }
    TSAN_OPTIONS="halt_on_error=1" $fixed "$program" "$publishes" >"$scratch/relaxed.out" 2>&1
    grep -q "$told" "$scratch/relaxed.out" && grep -q "Location is global 'places'" "$scratch/relaxed.out"
    verdict $? "a race without $1"
}
races_without "publish's release" ACQUIRE ACQ_REL
races_without "publish's acquire" RELEASE ACQ_REL
races_without "take's release" ACQ_REL ACQUIRE
races_without "take's acquire" ACQ_REL RELEASE
finish
