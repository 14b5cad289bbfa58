#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The tables of docs/batch.md, on a machine that does nothing else: sh tests/bench/python_batch.sh [BUILD [ENVIRONMENTS
# [TICKS [ROUNDS]]]]. The wheel is built and installed into a folder before; MuJoCo is that of make deps soft.
set -u
cd "$(dirname "$0")/../.." || exit 2
build=${1:-build}
if [ ! -f "$build/venv-python/complete" ] || [ ! -f "$build/venv-soft/complete" ]; then
    echo "python_batch.sh: no packages (make deps python soft)" >&2
    exit 2
fi
site=$PWD/$build/python/batch
rm -rf "$site"
make -s -j"${JOBS:-2}" wheel PYTHON="$build/venv-python/bin/python" >"$build/python_batch.log" 2>&1 &&
    "$build/venv-python/bin/python" -m pip install --quiet --no-index --no-deps --target "$site" "$build"/python/dynpoint-*.whl \
        >>"$build/python_batch.log" 2>&1 || { echo "python_batch.sh: see $build/python_batch.log" >&2; exit 2; }
PYTHONPATH=$site exec "$build/venv-soft/bin/python" tests/bench/python_batch.py "${2:-1000}" "${3:-20}" "${4:-3}"
