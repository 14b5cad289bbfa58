#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# macOS, by zig: sh tests/platforms/macos.sh BUILD. Programs and libraries for arm64 and x86-64 are compiled and linked, and
# their names, run paths and symbols are read. Nothing is run: there is no macOS here.
set -u
. "$(dirname "$0")/../lib/verdict.sh"
cd "$(dirname "$0")/../.." || exit 2
build=$1 zig=$PWD/build/venv-platforms/bin/python
if [ ! -x "$zig" ]; then
    skip "macOS: no ziglang (make deps platforms)"
    finish
fi
rm -f a.o
for target in aarch64-macos x86_64-macos; do
    made=$build/$target
    mkdir -p "$made"
    PKG_CONFIG_LIBDIR=$made make -s -j"${JOBS:-2}" B="$made" CC="$zig -m ziglang cc -target $target" AR="$zig -m ziglang ar" CFLAGS=-O1 \
        URDF=no CONVEX=no JANSSON=no LWS=no VIEW_PAGE=no all >"$made/make.out" 2>&1
    verdict $? "zig builds and links the program and the libraries for $target; not run"
    for lib in libdynpoint libdynpoint_compile libdynpoint_drivers libdynpoint_host; do
        python3 -B tests/platforms/macho.py "$made/$lib.1.dylib" "tests/abi/$lib.symbols"
        verdict $? "$target: $lib.1.dylib is found by @rpath, finds ours beside itself, and exports the public symbols alone"
    done
done
[ ! -e a.o ]
verdict $? "nothing is written beside the build"
finish
