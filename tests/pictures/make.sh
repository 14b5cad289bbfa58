#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# `make pictures`: every picture of README and docs but the charts: a plot, the drawings, the viewer's stills, and the picture that
# moves. What is missing on this machine is named, with what it leaves out; status 1 then.
#
#     sh tests/pictures/make.sh [BUILD=build] [OUT=docs/pictures]
set -u
cd "$(dirname "$0")/../.." || exit 2
build=${1:-build} out=${2:-docs/pictures} status=0

# lacks TOOL PACKAGES WHAT: a tool that is missing leaves WHAT out
lacks() {
    command -v "$1" >/dev/null && return 1
    echo "no $1 ($2): left out: $3"
    status=1
}

sh tests/pictures/draw_plot.sh "$build" "$out/plot-laws.svg" || exit 1
lacks node "make deps view" "all others" && exit 1
if lacks clang "make deps wasm" "the drawings" || lacks wasm-ld "make deps wasm" "the drawings"; then
    :
elif make -s wasm; then
    node tests/pictures/draw_concepts.js build/wasm "$out" || exit 1
else
    echo "make wasm failed (make deps wasm): left out: the drawings"
    status=1
fi
program=$(cd "$build" && pwd)/dynpoint || exit 2
viewer="the viewer's stills, and the picture that moves"
lacks chromium "make deps view" "$viewer" && exit 1
if ! grep -q HAS_VIEW_PAGE "$build/built_with.h"; then
    echo "this build has no viewer's page (make deps view, then make): left out: $viewer"
    exit 1
fi
node tests/pictures/stills.js "$program" "$build/view/pictures" "$out" || exit 1
lacks webpmux "Debian's webp, make deps view" "the picture that moves" && exit 1
node tests/pictures/moving.js "$program" "$build/view/pictures" "$out" || exit 1
exit $status
