#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# LeRobot itself opens what dynpoint.exports writes, in make check-release: sh tests/python/lerobot.sh [BUILD=build]. For
# x86-64, PyPI has PyTorch with all of CUDA alone, several GB; for AArch64 it has one without. So LeRobot runs in the
# emulator, on the Python that runs the wheel for AArch64 (make deps wheels lerobot).
set -u
cd "$(dirname "$0")/../.." || exit 2
. tests/lib/verdict.sh
. tests/lib/count.sh
build=$PWD/${1:-build}
foreign=$build/foreign site=$build/python/site room=$(mktemp -d) || exit 2
trap 'rm -rf "$room"' EXIT

if [ ! -f "$build/lerobot.complete" ] || [ ! -f "$foreign/complete" ]; then
    skip "LeRobot: no packages, or no Python for AArch64 (make deps wheels lerobot)"
    finish
fi
if [ ! -d "$site/dynpoint" ]; then
    skip "LeRobot: no package of Python (sh tests/python/check.sh)"
    finish
fi
PYTHONPATH=$site "$build/venv-python/bin/python" - "$room" <<'EOF'
import sys
from pathlib import Path

import numpy as np

import dynpoint as dp
import dynpoint.exports as exports

room, takes = Path(sys.argv[1]), []
for i, name in enumerate(("soft-liver", "liver")):
    with dp.Scene(name, "sim:?hand=press", ticks=300 + i, record=room / f"{i}.dpr") as scene:
        scene.run()
    takes.append(exports.load(room / f"{i}.dpr"))
exports.to_lerobot(takes, room / "set", task="press")
np.savez(room / "wanted.npz", **{f"{i}/{name}": array for i, take in enumerate(takes) for name, array in take.arrays().items()})
EOF
verdict $? "two recordings are written as a set"
count "LeRobot" env PYTHONPATH="$build/lerobot" HF_HUB_OFFLINE=1 HF_HOME="$room/hub" qemu-aarch64-static -L "$foreign/tree" \
    "$foreign/tree/usr/bin/python3.11" -B tests/python/lerobot_opens.py "$room/set" "$room/wanted.npz"
finish
