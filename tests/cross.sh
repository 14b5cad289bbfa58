#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
#
# Other machines, the same bytes: the program for AArch64 and for s390x, which is big-endian, makes,
# compiles and replays under qemu what the program of this machine does here, and all that it writes
# is equal bit for bit. Kinematics on 32-bit ARM too, and the single files of `make amalgamation` on all of them.
#
#     sh tests/cross.sh [BUILD_DIR]
#
# BUILD_DIR holds the program of this machine; the others go to build/cross-aarch64 and
# build/cross-s390x. JOBS: how many compilers at a time. RELEASE=no: of AArch64 the single files alone.

cd "$(dirname "$0")/.." || exit 2
. tests/lib/verdict.sh
quiet=1 # the name of a check says what is wrong
native=${1:-build}
LC_ALL=C
export LC_ALL

# work PROGRAM...: everything that is compared, written into the folder $out
work()
{
    rm -rf "$out"
    mkdir -p "$out" &&
        "$@" make torus 5568 -o "$out/torus.ply" &&
        "$@" make liver 2000 -o "$out/liver.obj" &&
        "$@" compile "$out/torus.ply" -o "$out/torus.dpa" &&
        "$@" compile "$out/liver.obj" -o "$out/liver.dpa" --scale 0.7 &&
        "$@" make stomach 2001 -o "$out/open.obj" &&
        "$@" compile "$out/open.obj" -o "$out/open.dpa" &&
        awk '/^v /{ printf "v %.2f %.2f %.2f\n", $2, $3, $4; next } 1' "$out/liver.obj" >"$out/coarse.obj" && # cuts itself
        "$@" compile "$out/coarse.obj" -o "$out/coarse.dpa" &&
        awk 'NF == 4 && NR > 2 { printf "%d %.2f %.2f %.2f\n", $1, 0.3 * $2, 0.3 * $3, 0.3 * $4; next } 1' tests/golden/torus.node \
            >"$out/cube.node" && # some vertices are outside of it
        cp tests/golden/torus.ele "$out/cube.ele" &&
        "$@" compile "$out/torus.ply" -o "$out/embedded.dpa" --nodes "$out/cube" &&
        "$@" compile "$out/torus.ply" -o "$out/sheet.dpa" --springs sheet --bending 1000 &&
        "$@" compile "$out/liver.obj" -o "$out/volume.dpa" --springs volume --spacing 0.007 &&
        "$@" info "$out/torus.dpa" --verify >"$out/verified" &&
        "$@" compile "$out/torus.ply" -o "$out/torus.c" --c-array torus &&
        "$@" make trace --mesh "$out/torus.dpa" --ticks 500 -o "$out/torus.csv" &&
        "$@" make trace --mesh "$out/liver.dpa" --ticks 500 -o "$out/liver.csv" &&
        "$@" replay "$out/torus.dpa" "$out/torus.csv" -o "$out/torus.out" --radius 0.003 &&
        head -n 40 "$out/torus.csv" >"$out/few.csv" && # an emulated tick of this takes a tenth of a second
        "$@" replay "$out/torus.dpa" "$out/few.csv" -o "$out/brute.out" --method brute &&
        "$@" replay "$out/liver.dpa" "$out/liver.csv" -o "$out/liver.out" --radius 0.003 &&
        "$@" run "$out/torus.dpa" --device 'sim:?hand=wipe&cycle=0.4' --ticks 500 --friction 0.3 --record "$out/torus.dpr" &&
        "$@" record csv "$out/torus.dpr" -o "$out/records.csv"
}

# made TARGET...: of this machine; static, so that qemu needs no libraries of it; without the driver that loads one
made()
{
    make -j"${JOBS:-$(nproc 2>/dev/null || echo 2)}" B="$folder" URDF=no CONVEX=no JANSSON=no LWS=no VIEW_PAGE=no DRIVERS="sim replay serial can" \
        CC="$machine-linux-gnu-gcc" LD="$machine-linux-gnu-ld" AR="$machine-linux-gnu-ar" OBJCOPY="$machine-linux-gnu-objcopy" \
        CORE="$folder/single/core.o" LDFLAGS="-static -Wl,--allow-multiple-definition" CFLAGS=-O1 "$@"
}

# The core is the single file, by that compiler's plain flags: what answers right here proves it.
# What is around them is compiled quickly, and must not matter.
build()
{
    made "$folder/dynpoint" \
            "$folder/tests/test_wire" "$folder/tests/test_wire_damage" "$folder/tests/test_wire_device" "$folder/tests/test_kinematics" \
            "$folder/tests/test_arm" "$folder/tests/test_arm_compile" "$folder/tests/test_sim" "$folder/tests/test_record"
}

# Ticks of each scene: contacts, sweeps, strips and budgets are all met in these.
walk=15

# single PREFIX: the files of `make amalgamation`, compiled for $machine. ARM's -O1 is compiled sooner, and fuses as readily,
# which s390x's does not; before a release all have -O2.
single()
{
    optimize=-O2
    [ "$machine" != arm ] || [ "${RELEASE:-yes}" != no ] || optimize=-O1
    alone=$native/amalgamation
    rm -rf "$folder/single"
    mkdir -p "$folder/single"
    check "$machine: single files compile, see $log" "$1gcc" $optimize -Wall -Wextra -Werror -c "$alone/dynpoint.c" \
        -o "$folder/single/core.o"
    check "$machine: and the compiler's, see $log" "$1gcc" $optimize -Wall -Wextra -Werror -c "$alone/dynpoint_compile.c" \
        -o "$folder/single/compile.o"
    "$1objdump" -d "$folder/single/core.o" "$folder/single/compile.o" >"$folder/single/code"
    fused=$(grep -cE '[[:space:]](v?fn?m(add|sub|l[as])|vfn?m[as]\.|m[as][de]br?|wfn?m[as])[[:space:]]' "$folder/single/code")
    check "$machine: single files fuse $fused multiplies with an add" test "$fused" -eq 0
}

# hashes PREFIX QEMU: answers_hash.c draws the same scenes everywhere
hashes()
{
    "$1gcc" -O1 -ffp-contract=off -static -I"$alone" tests/amalgamation/answers_hash.c "$folder/single/core.o" \
        "$folder/single/compile.o" -lm -pthread -o "$folder/single/hash" 2>>"$log"
    "$2" "$folder/single/hash" $walk >"$folder/single/hashes" 2>>"$log"
    check "$machine: single files answer otherwise, see $folder/single/hashes" cmp "$native/cross/hashes" "$folder/single/hashes"
}

# try MACHINE: as the names of its compiler and of qemu begin and end
try()
{
    machine=$1 folder=build/cross-$1
    for tool in "$1-linux-gnu-gcc" "$1-linux-gnu-ld" "qemu-$1-static"; do
        if ! command -v "$tool" >/dev/null; then
            skip "$machine: no $tool"
            return
        fi
    done
    mkdir -p "$folder"
    log=$folder/log out=$folder/work
    : >"$log"
    single "$1-linux-gnu-"
    # Before a merge the big-endian machine runs everything; of the other its kernel is what differs, and its answers tell.
    if [ "$1" = aarch64 ] && [ "${RELEASE:-yes}" = no ]; then
        hashes "$1-linux-gnu-" "qemu-$1-static"
        return
    fi
    check "$machine: build, see $log" build
    [ -x "$folder/dynpoint" ] || return
    check "$machine: warnings, see $log" test "$(grep -c warning: "$log")" -eq 0
    # With plain flags, compilers for aarch64 call a helper of their own for an atomic exchange.
    "$1-linux-gnu-nm" -u "$folder/single/core.o" | awk '{ print $2 }' |
        grep -vxE 'sqrtf?|floor|mem(cpy|set|move|cmp)|_GLOBAL_OFFSET_TABLE_|__stack_chk_fail|__aarch64_swp4_acq_rel' >"$folder/imports"
    check "$machine: the core imports $(tr '\n' ' ' <"$folder/imports")" test ! -s "$folder/imports"
    check "$machine: it runs, see $log" work "qemu-$machine-static" "$folder/dynpoint"
    for name in torus.ply liver.obj torus.dpa liver.dpa open.dpa coarse.dpa embedded.dpa sheet.dpa volume.dpa torus.c torus.csv liver.csv torus.out brute.out \
        liver.out records.csv; do
        check "$machine: other bytes in $name" cmp -s "$native/cross/$name" "$out/$name"
    done
    # A simulated device moves as it does here.
    check "$machine: the simulated device differs, see $log" "qemu-$machine-static" "$folder/tests/test_sim" bits
    # The bytes in an array are those of the file, and a copy converts in place.
    check "$machine: the array compiles, see $log" "$1-linux-gnu-gcc" -std=c99 -static -Wall -Wextra \
        -Wconversion -Werror -Iinclude "$native/cross/array.c" "$out/torus.c" "$folder/single/core.o" -lm \
        -o "$out/array"
    "qemu-$machine-static" "$out/array" "$out/torus.dpa"
    code=$?
    check "$machine: the array differs from the file: $code" test $code -eq 0
    # Frames are the same bytes, and a device answers the same.
    for name in test_wire test_wire_damage test_wire_device; do
        check "$machine: $name, see $log" "qemu-$machine-static" "$folder/tests/$name" 24
    done
    # Arms compile to the same bytes, open where they convert, and move to the same bits.
    check "$machine: test_kinematics, see $log" "qemu-$machine-static" "$folder/tests/test_kinematics" bits
    check "$machine: test_arm, see $log" "qemu-$machine-static" "$folder/tests/test_arm" tests/golden src/arm/arm_open.c 16
    check "$machine: test_arm_compile, see $log" "qemu-$machine-static" "$folder/tests/test_arm_compile"
    # Recordings are the same bytes; that of this machine replays there.
    check "$machine: another recording, see $log" "qemu-$machine-static" "$folder/dynpoint" replay "$native/cross/torus.dpr"
    check "$machine: test_record, see $log" "qemu-$machine-static" "$folder/tests/test_record"
    hashes "$1-linux-gnu-" "qemu-$1-static"
    # A damaged file is refused at the same byte, whatever the byte order.
    head -c 9000 "$out/torus.dpa" >"$out/short.dpa"
    "qemu-$machine-static" "$folder/dynpoint" info "$out/short.dpa" >"$out/said" 2>&1
    check "$machine: a short file is taken" test $? -eq 2
    check "$machine: $(cat "$out/said")" grep -q 'byte 9000 (header)' "$out/said"
}

log=$native/cross.log out=$native/cross
: >"$log"
check "this machine: it runs, see $log" work "$native/dynpoint"
cat >"$native/cross/array.c" <<'C'
#include <dynpoint.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
extern const uint64_t torus[];
extern const size_t torus_size;
static uint64_t file[1 << 17], copy[1 << 17];
int main(int argc, char **argv)
{
    const dpt_mesh *mesh;
    const uint32_t one = 1;
    const int little = *(const unsigned char *)&one == 1;
    FILE *stream = argc > 1 ? fopen(argv[1], "rb") : NULL;
    size_t size = stream ? fread(file, 1, sizeof file, stream) : 0;
    if (size != torus_size || memcmp(file, torus, size) != 0)
        return 1;
    if (dpt_mesh_open(torus, size, &mesh) != (little ? DPT_OK : DPT_E_BYTE_ORDER))
        return 2;
    memcpy(copy, torus, size);
    return dpt_mesh_convert(copy, size, NULL) || dpt_mesh_open(copy, size, &mesh) ? 3 : 0;
}
C
if command -v python3 >/dev/null; then
    check "single files are made" make -s amalgamation B="$native"
    ${CC:-cc} -O1 -ffp-contract=off -I"$native/amalgamation" tests/amalgamation/answers_hash.c "$native/libdynpoint_compile.a" \
        "$native/libdynpoint.a" -lm -pthread -o "$native/cross/hash" 2>>"$log" && "$native/cross/hash" $walk >"$native/cross/hashes"
    check "single files: the libraries here answer, see $log" test -s "$native/cross/hashes"
else
    skip "single files on other machines: no python3"
fi
try aarch64
try s390x
# A machine of 32 bits, as microcontrollers are: kinematics alone, which they are to compute.
if echo 'int main(void) { return 0; }' | arm-linux-gnueabihf-gcc -static -x c - -o "$native/cross/arm_bits" 2>/dev/null &&
    command -v qemu-arm-static >/dev/null; then
    arm-linux-gnueabihf-gcc -std=gnu99 -O3 $(sed -n 's/^EXACT := //p' Makefile) -static -Iinclude -Isrc -Itests \
        tests/arm/test_kinematics.c tests/lib/check.c tests/lib/arm_random.c tests/oracle/arm.c \
        src/base/*.c src/mesh/*.c src/hull/hull.c src/arm/*.c src/text/*.c src/compile/*.c -lm -pthread -o "$native/cross/arm_bits" \
        2>>"$log" && qemu-arm-static "$native/cross/arm_bits" bits >>"$log" 2>&1
    code=$?
    check "arm: kinematics differ, see $log" test $code -eq 0
    machine=arm folder=$native/cross/arm
    single arm-linux-gnueabihf-
    hashes arm-linux-gnueabihf- qemu-arm-static
else
    skip "arm: no arm-linux-gnueabihf-gcc with a C library, or no qemu-arm-static"
fi
finish
