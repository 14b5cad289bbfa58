#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# A tick in WebAssembly beside the native one: `sh tests/bench/wasm.sh BUILD`. Says so and ends if there is no build/wasm.
set -eu
cd "$(dirname "$0")/../.."
if ! command -v node >/dev/null || ! make -s wasm >/dev/null 2>&1; then
    echo "WebAssembly is not measured: make deps wasm"
    exit 0
fi
mkdir -p "$1/bench"
room=$(mktemp -d)
trap 'rm -rf "$room"' EXIT
node tests/bench/wasm.js "$1" "$room" | tee "$1/bench/wasm.csv"
