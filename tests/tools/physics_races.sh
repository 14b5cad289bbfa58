#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Physics in a thread of its own under ThreadSanitizer: `sh tests/tools/physics_races.sh BUILD`. It builds the library once
# more, which takes a minute. There is no race between the loop and the thread; without the exchange there is one.
set -u
build=$1
here=$(dirname "$0")
. "$here/../lib/verdict.sh"
scratch=$build/physics_races
told='WARNING: ThreadSanitizer: data race'
mkdir -p "$scratch"

printf 'int main(void) { return 0; }\n' >"$scratch/empty.c"
${CC:-cc} -fsanitize=thread "$scratch/empty.c" -o "$scratch/empty" 2>"$scratch/empty.out" ||
    { skip "physics under ThreadSanitizer: the compiler has none"; finish; }
# The sanitizer does not start where the kernel puts a program at places that it does not expect.
fixed=
"$scratch/empty" 2>"$scratch/empty.out" || fixed='setarch -R'
$fixed "$scratch/empty" 2>"$scratch/empty.out" ||
    { skip "physics under ThreadSanitizer: it cannot run here ($(head -n 1 "$scratch/empty.out"))"; finish; }

# test_built: the test program with the sanitizer
test_built()
{
    make -s B="$scratch" CFLAGS='-O1 -g' CFLAGS_EXTRA='-fsanitize=thread -Wno-tsan' LDFLAGS=-fsanitize=thread \
        "$scratch/tests/test_scene_physics" >"$scratch/make.out" 2>&1
}

# ran NAME: the test; it judges races alone, as the sanitizer makes all slower
ran()
{
    $fixed "$scratch/tests/test_scene_physics" >"$scratch/$1.out" 2>&1
    grep -q ' thread_stands_still_with_the_loop$' "$scratch/$1.out"
}

check "the test builds with ThreadSanitizer" test_built
check "it runs" ran shipped
grep -q "$told" "$scratch/shipped.out"
verdict $((! $?)) "no race between the loop and physics"

# Without an exchange both write the same place.
cp "$scratch/src/exchange/latest.o" "$scratch/latest.kept"
cat >"$scratch/shared_place.c" <<'END_OF_C'
#include "dynpoint/exchange.h"
void dpt_latest_init(dpt_latest *latest) { latest->writing = latest->reading = latest->between = 0; }
void dpt_latest_publish(dpt_latest *latest) { __atomic_store_n(&latest->between, 1u, __ATOMIC_RELAXED); }
int dpt_latest_take(dpt_latest *latest) { return (int)__atomic_exchange_n(&latest->between, 0u, __ATOMIC_RELAXED); }
END_OF_C
${CC:-cc} -std=gnu99 -O1 -g -fPIC -fsanitize=thread -Iinclude -c "$scratch/shared_place.c" -o "$scratch/src/exchange/latest.o"
check "the test builds without the exchange" test_built
check "it runs" ran shared
check "and the race is told" grep -q "$told" "$scratch/shared.out"
mv "$scratch/latest.kept" "$scratch/src/exchange/latest.o"
rm -f "$scratch/tests/test_scene_physics"
finish
