#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The package of npm (docs/javascript.md): what `make npm` packs is installed in an empty folder, loaded by node in each way,
# misused, typed, and run in a headless Chromium.
#
#     sh tests/js/check.sh [BUILD=build]
set -u
cd "$(dirname "$0")/../.." || exit 2
. tests/lib/verdict.sh
. tests/lib/count.sh
build=${1:-build}
room=$(mktemp -d) || exit 2
trap 'rm -rf "$room"' EXIT

for tool in clang wasm-ld node npm; do
    if ! command -v $tool >/dev/null; then
        skip "the package of npm: no $tool (make deps wasm)"
        finish
    fi
done
case $(node --version) in
v[0-9].* | v1[0-7].*)
    skip "the package of npm: node $(node --version), not 18 (make deps wasm)"
    finish
    ;;
esac
if ! echo '#include <stdlib.h>' | clang --target=wasm32-wasi -E -x c - >/dev/null 2>&1; then
    skip "the package of npm: no C library for WebAssembly (make deps wasm)"
    finish
fi
if ! python3 -c 'import pycparser' 2>/dev/null; then
    skip "the package of npm: no pycparser (make deps light)"
    finish
fi
flock "$build/wasm.lock" make -s npm >"$room/make" 2>&1
verdict $? "make npm: $(tail -n 1 "$room/make")"
sh tests/js/install.sh "$build" "$room"
verdict $? "the package unpacks"
count "the package" node tests/js/package.js "$room"
count "misuse" node tests/js/misuse.js "$room"

# tsc MODULE RESOLUTION FILE...
tsc() {
    module=$1 resolution=$2
    shift 2
    (cd "$room" && node "$typescript/bin/tsc" --strict --noEmit --exactOptionalPropertyTypes --noUncheckedIndexedAccess \
        --target es2022 --lib es2022,dom --module "$module" --moduleResolution "$resolution" "$@") >"$room/tsc" 2>&1
    verdict $? "tsc --strict, as $resolution resolves: $* $(head -n 1 "$room/tsc")"
}
typescript=$PWD/build/js/node_modules/typescript
if [ -e "$typescript/package.json" ]; then
    cp tests/js/types/* "$room"
    tsc nodenext nodenext use.mts required.cts
    tsc esnext bundler use.mts
    count "types and objects" node tests/js/types.js "$room" "$typescript"
else
    skip "types: no TypeScript (make deps wasm)"
fi
if command -v chromium >/dev/null; then
    count "Chromium" node tests/js/browser.js "$room"
else
    skip "the package in a browser: chromium is missing (make deps view)"
fi
finish
