#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The wheels of a release, in make check-release: sh tests/python/wheels.sh [BUILD=build]. For x86-64 and for AArch64
# they are made by zig for an old glibc; they are installed where there is no compiler, and answer as the C program
# does, on AArch64 in an emulator. And pyvista's meshes; packages come from PyPI.
set -u
cd "$(dirname "$0")/../.." || exit 2
. tests/lib/verdict.sh
. tests/lib/count.sh
build=$PWD/${1:-build}
made=$build/venv-wheels/bin foreign=$build/foreign room=$(mktemp -d) || exit 2
trap 'rm -rf "$room"' EXIT

if [ ! -f "$build/venv-wheels/complete" ]; then
    skip "Python's wheels of a release: no zig, auditwheel and pyvista (make deps wheels)"
    finish
fi
log=$build/wheels.log
: >"$log"
# The mesh of an organ, where there is one; all ticks of a tool that touches it.
organ=$room/liver.obj unit=m
if [ -f "${DPT_DATA:-}/meshes/organs/openhelp_liver.stl" ]; then
    organ=$DPT_DATA/meshes/organs/openhelp_liver.stl unit=mm
else
    "$build/dynpoint" make liver -o "$organ" >>"$log" 2>&1
fi
"$build/dynpoint" compile "$organ" --unit $unit -o "$room/liver.dpa" >>"$log" 2>&1 &&
    "$build/dynpoint" make trace --mesh "$room/liver.dpa" --seed 7 --ticks 400 -o "$room/trace.csv" >>"$log" 2>&1 &&
    "$build/dynpoint" replay "$room/liver.dpa" "$room/trace.csv" --radius 0.002 -o "$room/told.csv" >>"$log" 2>&1
verdict $? "the program's own answers, see $log"

# wheel MACHINE [ROOT]: it is made, for no newer a glibc than 2.28; then $wheel is its file.
wheel() {
    rm -f "build/manylinux-$1"/*.whl
    (unset CC && PATH=$made:$PATH make -s -j"${JOBS:-2}" wheel-release WHEEL_FOR="$1" WHEEL_ROOT="${2:-}" \
        PYTHON="$made/python") >>"$log" 2>&1
    wheel=$(echo "build/manylinux-$1"/dynpoint-*-cp311-abi3-manylinux_2_2[0-8]_"$1".whl)
    [ -f "$wheel" ]
    verdict $? "a wheel for $1: ${wheel##*/}"
}
wheel x86_64
check "its text can be shown, see $log" "$made/twine" check --strict "$wheel"
# A folder without a compiler is all that there is to find programs in.
mkdir "$room/programs"
PATH=$room/programs "$build/venv-wheels/bin/python" -m venv "$room/empty" >>"$log" 2>&1 &&
    PATH=$room/programs "$room/empty/bin/python" -m pip install --quiet --disable-pip-version-check "$wheel" >>"$log" 2>&1
verdict $? "it installs into an empty virtual environment, without a compiler"
(cd "$room" && PATH=$room/programs "$room/empty/bin/python" "$OLDPWD/tests/python/bits.py" "$organ" $unit trace.csv \
    liver.dpa told.csv) >"$room/here" 2>>"$log"
verdict $? "there it answers as the C program, bit for bit: $(sed -n 's/^as C //p' "$room/here")"

if [ -f "$foreign/complete" ] && command -v qemu-aarch64-static >/dev/null; then
    wheel aarch64 "$foreign/tree"
    rm -rf "$room/site"
    mkdir "$room/site" && (cd "$room/site" && "$made/python" -m zipfile -e "$OLDPWD/$wheel" .)
    verdict $? "it is unpacked"
    (cd "$room" && PYTHONPATH=$room/site:$foreign/site qemu-aarch64-static -L "$foreign/tree" \
        "$foreign/tree/usr/bin/python3.11" \
        "$OLDPWD/tests/python/bits.py" "$organ" $unit trace.csv liver.dpa told.csv) >"$room/there" 2>>"$log"
    verdict $? "on AArch64 it answers as the C program"
    check "and as the wheel for x86-64, also a soft scene" cmp "$room/here" "$room/there"
else
    skip "the wheel for AArch64: no Python for it, or no emulator (make deps wheels cross)"
fi
if [ -d "$build/python/site" ]; then
    count "pyvista" env PYTHONPATH="$build/python/site" DYNPOINT_BUILD="$build" \
        "$made/python" -W ignore tests/python/files.py
fi
finish
