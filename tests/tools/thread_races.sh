#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The program's threads under ThreadSanitizer: `sh tests/tools/thread_races.sh BUILD`. There is no race between the loop and
# physics, nor between the loop and its viewers; without the exchange, and with a relaxed order in the ring of ticks, there
# is one. Instrumented are the sources that hand things from thread to thread; all else is the release build's.
set -u
build=$1
here=$(dirname "$0")
. "$here/../lib/verdict.sh"
scratch=$build/thread_races
told='WARNING: ThreadSanitizer: data race'
mkdir -p "$scratch"

printf 'int main(void) { return 0; }\n' >"$scratch/empty.c"
${CC:-cc} -fsanitize=thread "$scratch/empty.c" -o "$scratch/empty" 2>"$scratch/empty.out" ||
    { skip "threads under ThreadSanitizer: the compiler has none"; finish; }
# The sanitizer does not start where the kernel puts a program at places that it does not expect.
fixed=
"$scratch/empty" 2>"$scratch/empty.out" || fixed='setarch -R'
$fixed "$scratch/empty" 2>"$scratch/empty.out" ||
    { skip "threads under ThreadSanitizer: it cannot run here ($(head -n 1 "$scratch/empty.out"))"; finish; }

parts=
for part in $(ls src/*/*.c | sed '/^src\/convex\//d; /^src\/\(scene\|host\)\//d; s/\.c$//') src/scene/scene_list src/scene/host_error src/scene/host_file src/scene/surface_regions src/scene/shape src/scene/shape_organs tools/cli/command_options tools/cli/complete tools/view/view_stream $(ls drivers/platform/posix/*.c drivers/platform/linux/*.c | sed "/_serial/d; /_interpreter/d; s/\.c$//"); do
    parts="$parts $build/$part.o"
done

# raced NAME SOURCE...: a program of these sources and the release build's objects, and what it says; of what is there
# twice the first is taken, which is the instrumented one
raced()
{
    name=$1
    shift
    # shellcheck disable=SC2086 # words
    check "$name builds with ThreadSanitizer" ${CC:-cc} -std=gnu99 -O1 -g -fsanitize=thread -Iinclude -Isrc -Itests -Itools \
        -Idrivers "$@" tests/lib/check.c tests/lib/fixture.c tests/lib/rig.c $parts "$build/libdynpoint_drivers.a" \
        -Wl,--allow-multiple-definition -lm -pthread -o "$scratch/$name"
    $fixed "$scratch/$name" >"$scratch/$name.out" 2>&1
    status=$?
}

physics="tests/tools/test_scene_physics.c tests/lib/soft_scene.c src/scene/scene_physics.c src/scene/scene_bodies.c
    src/world/deform_body.c src/proxy/tool_loads.c src/deform/deform_vertices.c src/deform/deform_loads.c src/deform/springs.c
    src/deform/loaded_step.c src/deform/local_yield.c"
# shellcheck disable=SC2086 # words
raced physics $physics src/exchange/latest.c
grep -q ' thread_stands_still_with_the_loop$' "$scratch/physics.out"
verdict $? "physics runs in its thread"
grep -q "$told" "$scratch/physics.out"
verdict $((! $?)) "no race between the loop and physics"

# Without an exchange both write the same place.
cat >"$scratch/shared_place.c" <<'END_OF_C'
#include "dynpoint/exchange.h"
void dpt_latest_init(dpt_latest *latest) { latest->writing = latest->reading = latest->between = 0; }
void dpt_latest_publish(dpt_latest *latest) { __atomic_store_n(&latest->between, 1u, __ATOMIC_RELAXED); }
int dpt_latest_take(dpt_latest *latest) { return (int)__atomic_exchange_n(&latest->between, 0u, __ATOMIC_RELAXED); }
END_OF_C
# shellcheck disable=SC2086 # words
raced shared_physics $physics "$scratch/shared_place.c"
check "a race without the exchange" grep -q "$told" "$scratch/shared_physics.out"

raced feed tests/view/test_view_feed.c tools/view/view_stream.c src/exchange/latest.c
verdict $status "no race between the loop and its viewers"
sed 's/__ATOMIC_RELEASE/__ATOMIC_RELAXED/' tools/view/view_stream.c >"$scratch/relaxed_feed.c"
raced relaxed_feed tests/view/test_view_feed.c "$scratch/relaxed_feed.c" src/exchange/latest.c
check "a race in a ring with a relaxed order" grep -q "$told" "$scratch/relaxed_feed.out"
finish
