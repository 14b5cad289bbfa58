#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The wheels of a release, in make check-release: sh tests/python/wheels.sh [BUILD=build]. For x86-64 and for AArch64
# they are made by zig for an old glibc; they are installed where there is no compiler, and answer as the C program
# does, on AArch64 in an emulator. Those for musl, Windows and macOS are looked at; a musl's Python and a Windows' in wine
# answer the same, and so does the program for musl on AArch64. And pyvista's meshes; packages come from PyPI.
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

build_wheel() { # WHEEL_FOR VARIABLE...
    rm -f "build/wheel-$1"/*.whl
    system=$1
    shift
    (unset CC && PATH=$made:$PATH make -s -j"${JOBS:-2}" wheel-release WHEEL_FOR="$system" WHEEL_URDF="$urdf" PYTHON="$made/python" "$@") >>"$log" 2>&1
}
# robots WHAT COMMAND...: of the URDFs $robots it makes what the C program makes, of bytes and of refusals. The C program has
# Debian's urdfdom.
robots() {
    what=$1 taken=0 refused=0 wrong=
    shift
    for robot in $robots; do
        rm -f "$room/robot.dpa" "$room/made.dpa"
        "$build/dynpoint" compile "$robot" -o "$room/robot.dpa" >/dev/null 2>"$room/told"
        told=$?
        "$@" compile "$robot" -o "$room/made.dpa" >/dev/null 2>"$room/made" </dev/null
        if [ $? -ne $told ] || ! tr -d '\r' <"$room/made" | cmp -s "$room/told" - ||
            { [ $told -eq 0 ] && ! cmp -s "$room/robot.dpa" "$room/made.dpa"; }; then
            wrong="$wrong ${robot##*/}"
        elif [ $told -eq 0 ]; then
            taken=$((taken + 1))
        else
            refused=$((refused + 1))
        fi
    done
    [ -z "$wrong" ] && [ $taken -gt 0 ] && [ $refused -gt 0 ]
    verdict $? "$what robots in URDF are the C program's: $taken, and $refused that are refused${wrong:+; not$wrong}"
}
systems=$build/wheel-systems urdf= all="docs/samples/*.urdf tests/golden-urdf/*.urdf"
if [ ! -f "$systems/urdf.complete" ]; then
    skip "robots in URDF in the wheels: no sources of urdfdom (make deps wheels)"
elif ! grep -q DPT_HAS_URDF "$build/built_with.h"; then
    skip "robots in URDF in the wheels: the C program has none (make deps light)"
else
    urdf=$systems/urdf
fi
# wheel MACHINE [ROOT]: it is made, for no newer a glibc than 2.28; then $wheel is its file.
wheel() {
    build_wheel "$1" WHEEL_ROOT="${2:-}"
    wheel=$(echo "build/wheel-$1"/dynpoint-*-cp311-abi3-manylinux_2_2[0-8]_"$1".whl)
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
if [ -n "$urdf" ]; then
    robots=$all
    robots "there" "$room/empty/bin/python" -B -m dynpoint
    terms=$(cd "$room" && "$made/python" -m zipfile -l "$OLDPWD/$wheel" | sed -n 's/.*licenses\/LICENSE\.\([a-z-]*\) .*/\1/p' | sort | tr '\n' ' ')
    [ "$terms" = "console-bridge expat jansson libcxx tinyxml urdfdom urdfdom-headers " ]
    verdict $? "the terms of what is in it are in it: $terms"
fi

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
    chmod +x "$room/site/dynpoint/program"
    [ -z "$urdf" ] || robots "there" qemu-aarch64-static -L "$foreign/tree" "$room/site/dynpoint/program"
else
    skip "the wheel for AArch64: no Python for it, or no emulator (make deps wheels cross)"
fi
# other SYSTEM: the wheel for it is made and looked at; then $wheel is its file.
other() {
    build_wheel "$1" WHEEL_JANSSON="$systems/jansson" WHEEL_PYTHON="$systems/windows/python/include"
    wheel=$(echo "build/wheel-$1"/dynpoint-*.whl)
    count "the wheel for $1" "$made/python" -B tests/python/look.py "$wheel" "$1" ${urdf:+urdf}
    check "$1: it keeps to the stable ABI of 3.11, see $log" "$made/abi3audit" --strict "$wheel"
}
# answers WHAT FOLDER PYTHON...: beside NumPy of the folder the wheel answers as the C program, and as the others do.
answers() {
    what=$1 site=$2
    shift 2
    rm -rf "$site/dynpoint"*
    (cd "$site" && "$made/python" -m zipfile -e "$OLDPWD/$wheel" .) >>"$log" 2>&1
    (cd "$room" && "$@" "$OLDPWD/tests/python/bits.py" "$organ" $unit trace.csv liver.dpa told.csv) 2>>"$log" |
        tr -d '\r' >"$room/there"
    cmp "$room/here" "$room/there" >>"$log" 2>&1
    verdict $? "$what it answers as the C program, and as the wheel for glibc, also a soft scene"
}
if [ ! -f "$systems/jansson.complete" ]; then
    skip "wheels for musl, Windows and macOS: no sources of jansson (make deps wheels)"
else
    for machine in aarch64 x86_64; do
        other $machine-macos
        skip "the wheel for macOS on $machine is not run: there is no macOS here"
    done
    other aarch64-musl
    skip "the extension for musl on AArch64 is not run: there is no Python for it here"
    # Its program is linked statically.
    if command -v qemu-aarch64-static >/dev/null; then
        rm -rf "$room/musl"
        mkdir "$room/musl" && (cd "$room/musl" && "$made/python" -m zipfile -e "$OLDPWD/$wheel" .) &&
            chmod +x "$room/musl/dynpoint/program"
        verdict $? "it is unpacked"
        qemu-aarch64-static "$room/musl/dynpoint/program" replay "$room/liver.dpa" "$room/trace.csv" --radius 0.002 \
            -o "$room/made.csv" >>"$log" 2>&1
        check "its program answers as the C program" cmp "$room/told.csv" "$room/made.csv"
        [ -z "$urdf" ] || robots "there" qemu-aarch64-static "$room/musl/dynpoint/program"
    else
        skip "nor is its program: no emulator (make deps wheels)"
    fi
    other x86_64-musl
    if [ -f "$systems/musl.complete" ]; then
        answers "on musl" "$systems/musl/site" env PYTHONPATH="$systems/musl/site" "$systems/musl/python/bin/python3.11" -B
        count "on musl" env URDF="$urdf" PYTHONPATH="$systems/musl/site" "$systems/musl/python/bin/python3.11" -B tests/python/elsewhere.py
        [ -z "$urdf" ] || robots "there" "$systems/musl/site/dynpoint/program"
    else
        skip "the wheel for musl is not run: no Python for it (make deps wheels)"
    fi
    if [ ! -f "$systems/windows.complete" ]; then
        skip "the wheel for Windows: no Python for it (make deps wheels)"
    elif ! command -v wine >/dev/null; then
        other x86_64-windows
        skip "the wheel for Windows is not run: no wine (make deps platforms)"
    else
        other x86_64-windows
        WINEDEBUG=-all WINEPREFIX=$systems/wine WINEDLLOVERRIDES='mscoree=;mshtml=;winemenubuilder.exe='
        export WINEDEBUG WINEPREFIX WINEDLLOVERRIDES
        # Pools of processes hang on what wine calls Windows 7.
        timeout 300 wine wineboot -u >>"$log" 2>&1 && timeout 60 wine winecfg -v win10 >>"$log" 2>&1
        # Python's streams in wine can be pipes, and no files.
        cat >"$room/python" <<EOF
#!/bin/sh
{ { timeout 300 wine "$systems/windows/python/python.exe" -B "\$@"; echo \$? >"\$0.status"; } 2>&1 >&3 | cat >&2; } 3>&1 </dev/null | cat
exit "\$(cat "\$0.status")"
EOF
        chmod +x "$room/python"
        answers "on Windows, by wine," "$systems/windows/site" env PYTHONPATH="Z:$systems/windows/site" "$room/python"
        count "on Windows" env PYTHONUTF8=1 URDF="$urdf" PYTHONPATH="Z:$systems/windows/site" "$room/python" "$PWD/tests/python/elsewhere.py"
        # A few, as each begins anew in wine; and Windows says other words of a folder.
        robots="docs/samples/*.urdf tests/golden-urdf/mesh_[!d]*.urdf"
        [ -z "$urdf" ] || robots "there" timeout 120 wine "$systems/windows/site/dynpoint/program.exe"
        timeout 60 wineserver -k >/dev/null 2>&1
    fi
fi
if [ -d "$build/python/site" ]; then
    count "pyvista" env PYTHONPATH="$build/python/site" DYNPOINT_BUILD="$build" \
        "$made/python" -W ignore tests/python/files.py
fi
finish
