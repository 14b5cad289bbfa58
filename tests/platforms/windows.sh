#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Windows, by mingw-w64 and by zig, run by wine: sh tests/platforms/windows.sh BUILD. What wine cannot tell is how late a
# real Windows wakes a loop, and how a vendor's library behaves.
set -u
. "$(dirname "$0")/../lib/verdict.sh"
cd "$(dirname "$0")/../.." || exit 2
build=$1 scratch=$PWD/$1/windows/scratch made=$PWD/$1/windows
rm -rf "$scratch"
mkdir -p "$scratch"
LC_ALL=C.UTF-8 WINEDEBUG=-all WINEPREFIX=$made/wine WINEDLLOVERRIDES='mscoree=;mshtml=;winemenubuilder.exe='
export LC_ALL WINEDEBUG WINEPREFIX WINEDLLOVERRIDES
if ! command -v x86_64-w64-mingw32-gcc >/dev/null 2>&1; then
    skip "Windows: no mingw-w64 (make deps platforms)"
    finish
fi
with="JANSSON=no LWS=no"
! sh tests/platforms/libraries.sh "$PWD/build/windows-libraries" || with="JANSSON=yes LWS=yes"
export PKG_CONFIG_LIBDIR="$PWD/build/windows-libraries/lib/pkgconfig"
make -s -j"${JOBS:-2}" B="$made" CC=x86_64-w64-mingw32-gcc AR=x86_64-w64-mingw32-ar NM=x86_64-w64-mingw32-nm CFLAGS_EXTRA=-Werror \
    URDF=no CONVEX=no $with all >"$scratch/make.out" 2>&1
verdict $? "mingw-w64 builds the program and the libraries, without a warning ($with)"
[ -x "$made/dynpoint.exe" ] || { tail -n 20 "$scratch/make.out"; finish; }

# What the DLLs give and need.
wrong=0
for lib in libdynpoint libdynpoint_compile libdynpoint_drivers libdynpoint_host; do
    x86_64-w64-mingw32-objdump -p "$made/$lib-1.dll" >"$scratch/$lib.txt"
    sed -n '/Ordinal\/Name Pointer/,/^$/s/^[^[]*\[ *[0-9]*\] \([A-Za-z_0-9]*\)$/\1/p' "$scratch/$lib.txt" | sort >"$scratch/$lib.exports"
    sort "tests/abi/$lib.symbols" | cmp - "$scratch/$lib.exports" || wrong=1
    ! sed -n 's/.*DLL Name: //p' "$scratch/$lib.txt" |
        grep -viE '^(libdynpoint(_[a-z]*)?-1|kernel32|advapi32|bcrypt|msvcrt|ucrtbase|api-ms-win-crt-[a-z0-9-]*)\.dll$' || wrong=1
done
verdict $wrong "each DLL exports the public symbols alone, and needs ours and the system's"

make -s amalgamation >"$scratch/single.out" 2>&1 && (cd build/amalgamation &&
    x86_64-w64-mingw32-gcc -std=c99 -w -O0 -c dynpoint.c -o "$scratch/single.o" &&
    x86_64-w64-mingw32-gcc -std=c99 -w -O0 -c dynpoint_compile.c -o "$scratch/single.o") >>"$scratch/single.out" 2>&1
verdict $? "the single files of core and compiler compile"

if ! command -v wine >/dev/null 2>&1; then
    skip "Windows programs are not run: no wine (make deps platforms)"
    finish
fi
timeout 300 wine wineboot -u >"$scratch/wine.out" 2>&1
. tests/platforms/same_bits.sh
same_bits "timeout 120 wine" "$made/dynpoint.exe"

# By import library: mingw's, and what Microsoft's linker is given, which brings no C library.
cat >"$scratch/user.c" <<'EOF'
#include <dynpoint.h>
int main(void) { return dpt_version()[0] != '0'; }
int start(void) { return main(); }
EOF
x86_64-w64-mingw32-gcc -DDPT_USE_SHARED -Iinclude "$scratch/user.c" "$made/libdynpoint.dll.a" -o "$made/user.exe" && timeout 60 wine "$made/user.exe"
verdict $? "a program that is linked by gcc to the import library runs"
if command -v lld-link >/dev/null 2>&1 && command -v clang >/dev/null 2>&1; then
    mkdir -p "$scratch/none"
    printf '#pragma once\n' | tee "$scratch/none/stddef.h" "$scratch/none/stdint.h" "$scratch/none/string.h" >/dev/null
    clang --target=x86_64-pc-windows-msvc -nostdlib -ffreestanding -DDPT_USE_SHARED -Iinclude -c "$scratch/user.c" -o "$scratch/user.obj" &&
        lld-link /entry:start /subsystem:console /nodefaultlib "$scratch/user.obj" "$made/libdynpoint.dll.a" "/out:$made/user.exe" &&
        timeout 60 wine "$made/user.exe"
    verdict $? "and one that clang and lld make as Microsoft's compiler would"
else
    skip "a program as of Microsoft's compiler: no clang, lld (make deps wasm)"
fi
cat >"$scratch/load.c" <<'EOF'
#include <windows.h>
int wmain(int count, wchar_t **names)
{
    HMODULE library = count == 3 ? LoadLibraryExW(names[1], NULL, LOAD_LIBRARY_SEARCH_DLL_LOAD_DIR | LOAD_LIBRARY_SEARCH_DEFAULT_DIRS) : NULL;
    char name[64];
    wcstombs(name, names[2], sizeof name);
    return !library || !GetProcAddress(library, name);
}
EOF
x86_64-w64-mingw32-gcc -municode "$scratch/load.c" -o "$scratch/load.exe"
wrong=0
for lib in libdynpoint libdynpoint_compile libdynpoint_drivers libdynpoint_host; do
    timeout 60 wine "$scratch/load.exe" "Z:$made/$lib-1.dll" "$(head -n 1 "tests/abi/$lib.symbols")" || { wrong=1; echo "  $lib"; }
done
verdict $wrong "each DLL loads alone, and finds the others beside itself"

# Names beyond 260 characters, drive letters, backslashes.
part=$(printf 'a%.0s' $(seq 1 100))
deep="$scratch/$part/$part/$part"
mkdir -p "$deep"
timeout 120 wine "$made/dynpoint.exe" compile "$scratch/liver.obj" -o "$deep/long.dpa" >"$scratch/out" 2>&1 && cmp "$deep/long.dpa" "$scratch/liver.dpa" &&
    timeout 120 wine "$made/dynpoint.exe" run "$deep/long.dpa" --ticks 100 --record "$deep/long.dpr" --device sim >>"$scratch/out" 2>&1 &&
    build/dynpoint replay "$deep/long.dpr" "$scratch/liver.dpa" >>"$scratch/out" 2>&1
verdict $? "files are read and written where their names have more than 300 characters"
timeout 120 wine "$made/dynpoint.exe" info "Z:$(echo "$scratch/liver.dpa" | tr / '\\')" >"$scratch/out" 2>&1
verdict $? "and by a drive's letter and backslashes"

# By the clock, and what is only elsewhere.
timeout 120 wine "$made/dynpoint.exe" run "$scratch/liver.dpa" --device 'sim:?hand=press&live=1' --for 10 >"$scratch/run.out" 2>&1 &&
    ticks=$(sed -n 's/^\([0-9]*\) ticks:.*/\1/p' "$scratch/run.out") && [ "${ticks:-0}" -gt 1000 ]
verdict $? "it feels a mesh by the clock for 10 s: ${ticks:-no} ticks"
timeout 60 wine "$made/dynpoint.exe" run "$scratch/liver.dpa" --device 'can:can0?arm=tests/golden/arm_1.dpa&gear=8,8&torque=1,1' --for 1 >"$scratch/out" 2>&1
grep -q 'SocketCAN is a part of Linux alone' "$scratch/out"
verdict $? "it says of CAN that it is Linux's alone"
timeout 60 wine "$made/dynpoint.exe" run "$scratch/liver.dpa" --device serial:COM77 --for 1 >"$scratch/out" 2>&1
grep -q 'COM77 is not there' "$scratch/out"
verdict $? "and of a serial port that it is not there"
timeout 60 wine "$made/dynpoint.exe" run "$scratch/liver.dpa" --device openhaptics --for 1 >"$scratch/out" 2>&1
grep -q 'OpenHaptics is not installed (no HD.dll)' "$scratch/out"
verdict $? "and of OpenHaptics which library is missing"

if ! grep -q DPT_HAS_LWS "$made/built_with.h" || ! grep -q DPT_HAS_VIEW_PAGE "$made/built_with.h"; then
    skip "the viewer on Windows: no libwebsockets for it, or no page (make deps platforms view)"
else
    timeout 120 wine "$made/dynpoint.exe" run "$scratch/liver.dpa" --device 'sim:?hand=press&live=1' --for 20 --view >"$scratch/view.out" 2>&1 &
    python3 - "$scratch/view.out" build/view/page.html <<'EOF'
import re, sys, time, urllib.request
for _ in range(300):
    found = re.search(r"http://127\.0\.0\.1:\d+/", open(sys.argv[1]).read())
    if found:
        break
    time.sleep(0.1)
page = urllib.request.urlopen(found.group(0), timeout=10)
sys.exit(page.read() != open(sys.argv[2], "rb").read() or "default-src 'none'" not in page.headers["content-security-policy"])
EOF
    verdict $? "the viewer's page comes from it, byte for byte, with its policy"
    wait
fi

zig=$PWD/build/venv-platforms/bin/python
if [ ! -x "$zig" ]; then
    skip "Windows by zig: no ziglang (make deps platforms)"
else
    made=$PWD/$build/zig-windows
    mkdir -p "$made"
    make -s -j"${JOBS:-2}" B="$made" CC="$zig -m ziglang cc -target x86_64-windows-gnu" AR="$zig -m ziglang ar" CFLAGS=-O1 \
        URDF=no CONVEX=no JANSSON=no LWS=no VIEW_PAGE=no all >"$scratch/zig.out" 2>&1
    verdict $? "zig builds the program and the libraries for Windows"
    wrong=0
    for lib in libdynpoint libdynpoint_compile libdynpoint_drivers libdynpoint_host; do
        x86_64-w64-mingw32-objdump -p "$made/$lib-1.dll" | sed -n '/Ordinal\/Name Pointer/,/^$/s/^[^[]*\[ *[0-9]*\] \([A-Za-z_0-9]*\)$/\1/p' | sort |
            cmp - "$scratch/$lib.exports" || wrong=1
    done
    verdict $wrong "its DLLs export the same"
    timeout 120 wine "$made/dynpoint.exe" replay "$scratch/own.dpr" "$scratch/liver.dpa" >"$scratch/replay.out" 2>&1 &&
        grep -q '3000 ticks, all the same bits' "$scratch/replay.out"
    verdict $? "its program replays this machine's recording: all the same bits"
    timeout 120 wine "$made/dynpoint.exe" compile "$scratch/liver.obj" -o "$scratch/zig.dpa" >"$scratch/out" 2>&1 && cmp "$scratch/zig.dpa" "$scratch/liver.dpa"
    verdict $? "and compiles the same bytes"
    (cd build/amalgamation && "$zig" -m ziglang cc -target x86_64-windows-gnu -O0 -c dynpoint.c -o "$scratch/zig.o" &&
        "$zig" -m ziglang cc -target x86_64-windows-gnu -O0 -c dynpoint_compile.c -o "$scratch/zig.o") >"$scratch/zig.out" 2>&1
    verdict $? "and the single files"
fi
timeout 60 wineserver -k >/dev/null 2>&1
finish
