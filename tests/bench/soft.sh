#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Contact with a soft body of MuJoCo's, where `make deps soft` put it into build/venv-soft; or, with `feel`, the force of
# a hand that presses it. Prints a table and writes BUILD/bench/soft.csv or soft_feel.csv:
# `sh tests/bench/soft.sh BUILD [feel]`.
set -u
build=$1
venv=build/venv-soft
if ! command -v python3 >/dev/null 2>&1; then
    echo "  skip MuJoCo's soft bodies: no python3"
    echo "0 passed, 0 failed, 1 skipped"
    exit 0
fi
python=python3
[ ! -f $venv/complete ] || python=$venv/bin/python
mkdir -p "$build/bench"
if [ "${2-}" = feel ]; then
    exec $python -B tests/bench/feel_mujoco.py "$build" "$build/bench/soft_feel.csv"
fi
exec $python -B tests/bench/peer_mujoco.py "$build" "$build/bench/soft.csv"
