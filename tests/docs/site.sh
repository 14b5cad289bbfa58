#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The site of `make docs`: it is made without a warning, below its version; each public function and each name of Python's
# package has its place, and the names of other languages; links and pictures lead to files that are there; in a browser no page
# is wider than a window of 390 pixels, and the organ in the tutorial ticks.
#
#     sh tests/docs/site.sh [BUILD=build]
set -u
cd "$(dirname "$0")/../.." || exit 2
. tests/lib/verdict.sh
build=${1:-build}
mkdir -p "$build/docs"
if ! command -v doxygen >/dev/null || [ ! -e build/venv-docs/complete ]; then
    skip "the site of the pages: no doxygen or no Sphinx (make deps docs)"
    finish
fi
# It makes sources for other languages, whose tests compile them meanwhile.
flock "$build/wasm.lock" make -s docs >"$build/docs/made.log" 2>&1
verdict $? "make docs: $(tail -n 1 "$build/docs/made.log")"
python3 -B tests/docs/site.py "$build" >"$build/docs/said"
if command -v chromium >/dev/null 2>&1 && command -v node >/dev/null 2>&1; then
    room=$(mktemp -d)
    version=$(sed -n 's/^#define DPT_VERSION_STRING "\(.*\)"/\1/p' include/dynpoint/base.h)
    node tests/docs/site_look.js "$build/docs/site" "$version" "$room" >>"$build/docs/said" 2>&1
    rm -rf "$room"
else
    echo "skip the site in a browser: no chromium or no node (make deps view)" >>"$build/docs/said"
fi
while read -r word rest; do
    case $word in
    ok) ok "$rest" ;;
    FAIL) bad "$rest" ;;
    skip) skip "$rest" ;;
    esac
done <"$build/docs/said"
[ "$(grep -vc '^ *[0-9]' "$build/docs/said")" -ge 14 ]
verdict $? "all of it was looked at"
finish
