#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# WebAssembly: the core and the compiler of `make wasm` answer as the native library does, under node, under WASI and in a
# headless Chromium; and the layer in JavaScript does what its manual says.
#
#     sh tests/wasm/check.sh [BUILD=build]
set -u
cd "$(dirname "$0")/../.." || exit 2
. tests/lib/verdict.sh
. tests/lib/count.sh
build=${1:-build} wasm=build/wasm
room=$(mktemp -d) || exit 2
trap 'rm -rf "$room"' EXIT

for tool in clang wasm-ld node; do
    if ! command -v $tool >/dev/null; then
        skip "WebAssembly: no $tool (make deps wasm)"
        finish
    fi
done
if ! echo '#include <stdlib.h>' | clang --target=wasm32-wasi -E -x c - >/dev/null 2>&1; then
    skip "WebAssembly: no C library for it (make deps wasm)"
    finish
fi
flock "$build/wasm.lock" make -s wasm CFLAGS_EXTRA=-Werror >"$room/make" 2>&1
verdict $? "make wasm: $(tail -n 1 "$room/make")"
count "the modules" node tests/wasm/modules.js $wasm "$build" "$room"

# The scenes of answers_hash.c with every kernel, method and budget;.
hash() {
    sed 's,<dynpoint_compile.h>,<dynpoint/compile.h>,' tests/amalgamation/answers_hash.c >"$room/hash.c"
    ${CC:-cc} -O1 -ffp-contract=off -Iinclude "$room/hash.c" "$build/libdynpoint_compile.a" "$build/libdynpoint.a" -lm -pthread \
        -o "$room/hash" && "$room/hash" 30 >"$room/native" &&
        clang --target=wasm32-wasi -O1 -ffp-contract=off -Iinclude "$room/hash.c" $(find $wasm/core/src -name '*.o' ! -name memcmp.o) \
            $(find $wasm/compile/src/compile $wasm/compile/src/text -name '*.o') \
            -o "$room/hash.wasm" &&
        node --no-warnings tests/wasm/wasi.js "$room/hash.wasm" 30 >"$room/wasi" && [ "$(grep -c contacts "$room/wasi")" -eq 6 ]
}
log=$build/wasm.log
: >"$log"
check "answers_hash runs, see $log" hash
check "every method, budget, strip and sweep: the same hashes" cmp "$room/native" "$room/wasi"
log=
if command -v chromium >/dev/null; then
    count "Chromium" node tests/wasm/browser.js $wasm "$room"
else
    skip "the core in a browser: chromium is missing (make deps view)"
fi
finish
