#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The same scene in every language: touch.c is the reference, and each folder beside it has the same program in a language
# of its own, with what else is tested there.
#
#     sh tests/languages/check.sh [BUILD=build] [LANGUAGE...]
#
# It calls `sh tests/languages/LANGUAGE/run.sh BUILD ROOM ROUNDS` from the top of the tree. ROOM is an empty folder, which
# is removed afterwards; RELEASE=yes is for what takes long. A run.sh calls make with BUILD/wasm.lock, as tests/js does:
# both make the model of the ABI. It prints a line for each thing that it says. If it ends with another status than 0, it
# says why:
#
#     ok WHAT, FAIL WHAT, skip WHAT      a check; a skip names what is missing, and the group of `make deps`
#     note TEXT                          is shown
#     touch NAME HASH TICKS SECONDS      what a program of the scene printed: compared with the reference's
set -u
cd "$(dirname "$0")/../.." || exit 2
. tests/lib/verdict.sh
build=${1:-build}
[ $# -eq 0 ] || shift
room=$(mktemp -d) || exit 2
trap 'rm -rf "$room"' EXIT
rounds=5

${CC:-cc} -std=gnu99 -O2 -ffp-contract=off -Wall -Wextra -Wshadow -Wconversion -Werror -Iinclude tests/languages/touch.c \
    "$build/libdynpoint_compile.a" "$build/libdynpoint.a" -lm -pthread -o "$room/touch" &&
    "$room/touch" $rounds >"$room/reference" && read -r hash ticks seconds <"$room/reference"
verdict $? "the reference in C: ${hash-} of ${ticks-} ticks"

# touched NAME HASH TICKS SECONDS: beside the reference, which is timed anew as the machine may be busier now.
touched() {
    if [ $# -ne 4 ]; then
        bad "$language: the program of the scene said nothing: $* ($(tail -n 1 "$room/errors"))"
        return
    fi
    [ "$2 $3" = "$hash $ticks" ]
    verdict $? "$1: the same wrenches in each of $3 ticks ($2)"
    read -r _ _ seconds <<END
$("$room/touch" $rounds)
END
    awk -v name="$1" -v c="$seconds" -v its="$4" -v ticks="$ticks" 'BEGIN {
        printf "       %s: %.2f us a tick, %.2f over C (%.2f times)\n",
            name, 1e6 * its / ticks, 1e6 * (its - c) / ticks, its / c }'
}

for script in tests/languages/*/run.sh; do
    language=$(basename "$(dirname "$script")")
    case " ${*:-$language} " in *" $language "*) ;; *) continue ;; esac
    # Its package is being built beside this: tests/python/check.sh asks for it.
    [ $# -gt 0 ] || [ "$language" != python ] || continue
    mkdir "$room/$language"
    sh "$script" "$build" "$room/$language" $rounds >"$room/said" 2>"$room/errors"
    status=$?
    before=$failed
    while read -r word rest; do
        case $word in
        ok) ok "$language: $rest" ;;
        FAIL) bad "$language: $rest" ;;
        skip) skip "$language: $rest" ;;
        note) echo "       $language: $rest" ;;
        touch) touched $rest ;;
        esac
    done <"$room/said"
    [ $status -eq 0 ] || [ "$failed" -gt "$before" ] || grep -q '^skip ' "$room/said" ||
        bad "$language: status $status, $(tail -n 1 "$room/errors")"
    grep -q '^ok \|^FAIL \|^skip \|^touch ' "$room/said" || bad "$language: it checked nothing"
    rm -rf "${room:?}/$language"
done
finish
