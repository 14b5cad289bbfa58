#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Describe the functions and types that the shared libraries offer, by abidw of libabigail: `sh tests/abi/describe.sh BUILD
# OUT LIBRARY...` builds them with debug information in BUILD and writes OUT/LIBRARY.abi, without places in the sources. The
# files beside this script are release 0.3's, made so on x86-64; a release that adds something stores them anew.
set -u
build=$1 out=$2
shift 2
mkdir -p "$out"
for lib; do
    make -s -j2 B="$build" CFLAGS='-O0 -g' "$build/$lib.so.1" || exit 1
    abidw --headers-dir include --drop-private-types --exported-interfaces-only --no-corpus-path --no-comp-dir-path \
        --no-show-locs --no-elf-needed --no-parameter-names --type-id-style hash "$build/$lib.so.1" |
        sed "s/^ *//; s/ visibility='default'//; s/ language='[^']*'//" >"$out/$lib.abi" || exit 1
done
