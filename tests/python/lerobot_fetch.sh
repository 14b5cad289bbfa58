#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Packages from PyPI for AArch64, as they are, without what they ask for: sh tests/python/lerobot_fetch.sh FOLDER
# REQUIREMENTS. Once: then FOLDER.complete is there. Status 1, and a line that says why, where that cannot be done.
set -u
[ ! -f "$1.complete" ] || exit 0
rm -rf "$1" "$1-pip"
python3 -m venv "$1-pip" >"$1.log" 2>&1 # whose pip is there, where the system has none
"$1-pip/bin/python" -m pip install --no-deps --no-cache-dir --disable-pip-version-check --target "$1" \
    --platform manylinux_2_28_aarch64 --platform manylinux_2_27_aarch64 --platform manylinux_2_17_aarch64 \
    --platform manylinux2014_aarch64 --platform any --only-binary=:all: --python-version 3.11 -r "$2" >>"$1.log" 2>&1 && rm -rf "$1-pip" && touch "$1.complete" && exit 0
echo "no LeRobot: PyPI cannot be reached; see $1.log"
exit 1
