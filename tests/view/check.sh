#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The viewer's page (tools/view/page/): its readers under node, the file that is made, and what it draws and does in a
# headless Chromium, from its file, from a mock of the server, and from the program itself. BUILD/view/node_modules has three.js.
# And the pictures of README and docs (tests/pictures).
#
#     sh tests/view/check.sh [BUILD=build]
set -u
cd "$(dirname "$0")/../.." || exit 2
. tests/lib/verdict.sh
. tests/lib/count.sh
build=${1:-build} view=$PWD/${1:-build}/view
room=$(mktemp -d) || exit 2
trap 'rm -rf "$room"' EXIT

if ! command -v node >/dev/null; then
    skip "the viewer's page: node is missing (Debian's nodejs)"
    finish
fi
count "the readers" node tests/view/page_readers.js
count "the pictures' files" node tests/pictures/picture_files.js
if command -v clang >/dev/null && command -v wasm-ld >/dev/null && flock "$build/wasm.lock" make -s wasm >"$room/wasm" 2>&1; then
    count "the drawings' numbers" node tests/pictures/drawings_again.js build/wasm "$room"
else
    skip "the drawings' numbers, asked again: no WebAssembly (make deps wasm)"
fi
if command -v chromium >/dev/null; then
    count "the drawings" node tests/pictures/drawings.js docs/pictures "$room"
fi
if [ ! -e "$view/node_modules/three/package.json" ]; then
    skip "the page's file, and what it draws: three.js is missing (npm ci in $view)"
    finish
fi
count "the page's file" node tests/view/page_file.js "$view" "$room"
# One of its own: others build with the build's page beside this.
mkdir "$room/view" && ln -s "$view/node_modules" "$room/view" && view=$room/view
log=/dev/null
check "the page is made" node tools/view/page/make_page.js "$view"
if ! command -v chromium >/dev/null; then
    skip "what the page draws and does, and the drawings' texts: chromium is missing (Debian's chromium)"
    finish
fi
count "the picture" node tests/view/page_picture.js "$view/page.html" "$room"
count "its light" node tests/view/page_light.js "$view/page.html" "$room"
count "its instruments" node tests/view/page_instruments.js "$view/page.html" "$room"
count "its second view" node tests/view/page_inset.js "$view/page.html" "$room"
count "a saved picture" node tests/view/page_saved.js "$view/page.html" "$room"
count "a needle" node tests/view/page_needle.js "$view/page.html" "$room"
count "its colours" node tests/view/page_colours.js "$view/page.html" "$room"
count "a recording" node tests/view/page_recording.js "$view/page.html" "$room"
count "a running world" node tests/view/page_live.js "$view" "$room"
if grep -q HAS_LWS "$build/built_with.h" && grep -q HAS_VIEW_PAGE "$build/built_with.h"; then
    count "the program" node tests/view/program.js "$build/dynpoint" "$room"
else
    skip "the program and its page: this build has no libwebsockets, or no page"
fi
finish
