#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The page with the core in it (tools/page/): its hand, its loop and its messages under node; the page in a headless
# Chromium, opened from its file, and what it felt against the native library.
#
#     sh tests/page/check.sh [BUILD=build]
set -u
cd "$(dirname "$0")/../.." || exit 2
. tests/lib/verdict.sh
. tests/lib/count.sh
build=${1:-build}
room=$(mktemp -d) || exit 2
trap 'rm -rf "$room"' EXIT

for tool in clang wasm-ld node; do
    if ! command -v $tool >/dev/null; then
        skip "the page: no $tool (make deps view wasm)"
        finish
    fi
done
if ! echo '#include <stdlib.h>' | clang --target=wasm32-wasi -E -x c - >/dev/null 2>&1; then
    skip "the page: no C library for WebAssembly (make deps wasm)"
    finish
fi
flock "$build/wasm.lock" make -s wasm >"$room/make" 2>&1
verdict $? "make wasm: $(tail -n 1 "$room/make")"
count "the world, the hand and the loop" node tests/page/page_world.js build/wasm "$build/dynpoint" "$room"
if [ ! -e build/view/node_modules/three/package.json ]; then
    skip "the page's file, and what it does: three.js is missing (make deps view)"
    finish
fi
flock "$build/wasm.lock" make -s page >"$room/make" 2>&1
verdict $? "make page: $(tail -n 1 "$room/make")"
count "the page's file" node tests/page/page_one_file.js build/page/dynpoint.html
if ! command -v chromium >/dev/null; then
    skip "what the page does: chromium is missing (make deps view)"
    finish
fi
count "the page" node tests/page/page_touch.js build/page/dynpoint.html "$build" "$room"
count "its choices" node tests/page/page_choices.js build/page/dynpoint.html "$room"
finish
