#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Another C library for Linux, musl: sh tests/platforms/musl.sh BUILD. The whole program is built for it into BUILD/musl,
# and its files and replays are those of BUILD, byte for byte. What other libraries bring is left out: there are none here
# for musl.
set -u
. "$(dirname "$0")/../lib/verdict.sh"
cd "$(dirname "$0")/../.." || exit 2
build=$1 scratch=$1/musl/scratch
rm -rf "$scratch"
mkdir -p "$scratch" "$build/musl/kernel"
if ! command -v musl-gcc >/dev/null 2>&1; then
    skip "the program for musl: no musl-gcc (make deps build)"
    finish
fi
# The kernel's headers alone, which are for every C library; beside them lie those of glibc.
for name in linux asm asm-generic; do
    for place in /usr/include "/usr/include/$(${CC:-cc} -dumpmachine)"; do
        [ ! -d "$place/$name" ] || ln -sfn "$place/$name" "$build/musl/kernel/$name"
    done
done
make -s -j"${JOBS:-1}" B="$build/musl" CC=musl-gcc CFLAGS=-O0 CFLAGS_EXTRA="-isystem $build/musl/kernel" URDF=no CONVEX=no \
    JANSSON=no LWS=no VIEW_PAGE=no "$build/musl/dynpoint" >"$scratch/make.out" 2>&1
verdict $? "the program is built for musl"
[ -x "$build/musl/dynpoint" ] || { tail -n 20 "$scratch/make.out"; finish; }
readelf -l "$build/musl/dynpoint" | grep -q 'ld-musl'
verdict $? "and is musl's: that is its loader"
. tests/platforms/same_bits.sh
same_bits "" "$build/musl/dynpoint"
timeout 60 "$build/musl/dynpoint" run "$scratch/liver.dpa" --device 'sim:?hand=press&live=1' --for 1 >"$scratch/run.out" 2>&1
verdict $? "it feels a mesh by the clock for a second"
finish
