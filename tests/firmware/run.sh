#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
#
# Firmware on an emulated Cortex-M7: what the protocol and a tick take there, as the table of docs/wire.md; and from end
# to end, the driver against it.
#
#     sh tests/firmware/run.sh [BUILD_DIR]
#
# PULLS (16) is how often the plug is pulled while docs/samples/safe_device.c runs on it.
set -u
cd "$(dirname "$0")/../.." || exit 2
build=${1:-build}
out=$build/firmware
cross=arm-none-eabi-
. tests/lib/verdict.sh

# leave_out WHY: the whole test is skipped.
leave_out() {
    skip "firmware: $1"
    finish
}

for tool in ${cross}gcc ${cross}size qemu-system-arm python3; do
    command -v $tool >/dev/null 2>&1 || leave_out "no $tool"
done
rm -rf "$out"
mkdir -p "$out"
echo '#include <string.h>' | ${cross}gcc -mcpu=cortex-m7 -E -x c - >"$out/log" 2>&1 || leave_out "no newlib for ${cross}gcc"

exact=$(sed -n 's/^EXACT := //p' Makefile)
flags="-std=gnu99 -O2 $exact -Wall -Wextra -Wshadow -Wconversion -Werror -ffunction-sections -fdata-sections -Iinclude -Isrc -Idrivers -Itools -Itests"
machine="-mcpu=cortex-m7 -mthumb -mfloat-abi=hard -mfpu=fpv5-d16"
link="-T tests/firmware/m7.ld -nostartfiles -Wl,--gc-sections --specs=nosys.specs -lm"
run="qemu-system-arm -M mps2-an500 -display none -monitor none -semihosting-config enable=on,target=native"

"$build/dynpoint" make membrane 512 -o "$out/mesh.ply" >>"$out/log" 2>&1 &&
    "$build/dynpoint" compile "$out/mesh.ply" -o "$out/mesh.c" --c-array flash_mesh >>"$out/log" 2>&1 &&
    "$build/dynpoint" compile "$out/mesh.ply" -o "$out/mesh.dpa" >>"$out/log" 2>&1
verdict $? "512 triangles as an array in C"
${CC:-cc} -std=gnu99 -Iinclude tests/firmware/arm.c "$build/libdynpoint_compile.a" "$build/libdynpoint.a" -lm -lpthread \
    -o "$out/arm" >>"$out/log" 2>&1 && "$out/arm" >"$out/arm.c"
verdict $? "an arm of three joints likewise"
# The core as one file, by the compiler's plain -O2, as firmware takes it; on this machine it is the library.
make -s amalgamation B="$build" &&
    ${cross}gcc -O2 $machine -Wall -Wextra -Werror -ffunction-sections -fdata-sections -c "$build/amalgamation/dynpoint.c" \
        -o "$out/dynpoint.o" >>"$out/log" 2>&1
is_built=$?
core=$out/dynpoint.o
[ $is_built -eq 0 ] && [ "$(${cross}objdump -d "$core" | grep -cE '[[:space:]]vfn?m[as]')" -eq 0 ]
verdict $? "the core as one file is built for a Cortex-M7 without a warning, and fuses nothing, see $out/log"
wire="drivers/serial/wire.c drivers/serial/wire_device.c"
[ $is_built -eq 0 ] &&
    ${cross}gcc $flags $machine -DPERIOD=4 -DWATCHDOG=0.5f tests/firmware/device.c tests/firmware/board.c $wire $link \
        -o "$out/device.elf" >>"$out/log" 2>&1 &&
    ${cross}gcc $flags $machine -DPERIOD=4 -DWATCHDOG=0.5f -DPRESS=0.015 -DMETER=1 tests/firmware/device.c tests/firmware/board.c \
        $wire $link -o "$out/pressed.elf" >>"$out/log" 2>&1 &&
    ${cross}gcc $flags $machine tests/firmware/measure.c tests/firmware/board.c $wire $core "$out/mesh.c" "$out/arm.c" $link \
        -o "$out/measure.elf" >>"$out/log" 2>&1
verdict $? "a device and what measures a tick are built for it without a warning, see $out/log"
${CC:-cc} $flags tests/firmware/measure.c tests/firmware/board_host.c $wire "$out/mesh.c" "$out/arm.c" "$build/libdynpoint.a" -lm \
    -o "$out/measure" >>"$out/log" 2>&1 && "$out/measure" >"$out/measure.host"
verdict $? "and for this machine"

# An instruction a nanosecond: the emulated timer counts instructions, the same ones in every run.
timeout 120 $run -serial null -icount shift=0 -kernel "$out/measure.elf" >"$out/measure.m7" 2>&1
verdict $? "it runs"
value() { sed -n "s/^$1 //p" "$out/measure.m7"; }
sizes() { ${cross}size "$@" | awk 'NR > 1 { text += $1; data += $2 + $3 } END { print text, data }'; }
[ -n "$(value bits)" ] && [ "$(value bits)" = "$(sed -n 's/^bits //p' "$out/measure.host")" ]
verdict $? "frames, poses, efforts, distances, wrenches and proxies have the same bits on both"

for source in $wire src/arm/arm_kinematics.c src/arm/arm_open.c; do
    ${cross}gcc $flags $machine -c $source -o "$out/$(basename $source .c).o"
done
cat >"$out/core.c" <<'END'
#include "dynpoint.h"
int main(void);
void board_exit(int status);
void reset(void);
void reset(void) { board_exit(main()); }
void board_exit(int status) { for (;;) (void)status; }
extern const unsigned char bytes[];
extern uint64_t block[];
int main(void)
{
    const dpt_mesh *mesh;
    dpt_world_def def;
    dpt_world *world;
    dpt_body body;
    dpt_tool tool;
    dpt_wrench wrench;
    dpt_step step = { .size = sizeof step };
    const dpt_segment segment = { { 0, 0, 0 }, { 0, 0, 1 }, 0 };
    const dpt_pose pose = DPT_POSE_IDENTITY;
    dpt_world_def_init(&def);
    return dpt_mesh_open(bytes, 1, &mesh) | dpt_world_create(block, dpt_world_bytes(&def), &def, &world) |
           dpt_body_add(world, mesh, NULL, &body) | dpt_tool_add(world, &segment, 1, &tool) |
           dpt_tool_set_pose(world, tool, &pose) | dpt_world_step(world, 0.001, &step) |
           dpt_tool_get_wrench(world, tool, &wrench);
}
END
# What of the core a device needs, with the C library's part of it.
${cross}gcc $flags $machine "$out/core.c" $core $link -Wl,--defsym=bytes=0 -Wl,--defsym=block=0x20000000 \
    -o "$out/core.elf" >>"$out/log" 2>&1
verdict $? "the core alone is linked"
set -- $(sizes "$out/wire.o") $(sizes "$out/wire_device.o") $(sizes "$out/device.elf") $(sizes "$out/core.elf") \
    $(sizes "$out/arm_kinematics.o") $(sizes "$out/arm_open.o")
cat <<END

| on a Cortex-M7, gcc -O2 | instructions | text, bytes | RAM, bytes |
|---|---|---|---|
| encode a state, 61 / 89 bytes | $(value encode_3) / $(value encode_6) | | |
| decode it, byte by byte | $(value decode_3) / $(value decode_6) | | |
| a device's sample: take a command, 43 bytes, look after the watchdog, say a state, 89 bytes | $(value sample) | | |
| wire.c, wire_device.c | | $1 + $3 | $(value device_bytes), stack below $(value stack_wire) |
| the whole firmware of tests/firmware | | $5 | $6 |
| the core: dpt_world_step and what it needs | | $7 | $8, stack $(value stack) |
| mesh of 512 triangles in flash | | $(value mesh_bytes) | 0 |
| an arm of 3 joints in flash | | $(value arm_bytes) | 0 |
| its pose, velocity and efforts: arm_kinematics.c | $(value arm_tick) | $9 | 0, stack below $(value stack_arm) |
| open it, once: arm_open.c, and mesh_open.c | $(value arm_open) | ${11} | 0, stack below $(value stack_arm_open) |
| tick, exact, nearest pair (DPT_UNTIL_TRACK): median / 99 % / most | $(value track_median) / $(value track_p99) / $(value track_most) | | $(value track_bytes) |
| tick, exact, with depth and force, max_contacts 0 | $(value depth_median) / $(value depth_p99) / $(value depth_most) | | $(value depth_bytes) |
| tick, exact, with regions, max_contacts 4 | $(value tick_median) / $(value tick_p99) / $(value tick_most) | | $(value tick_bytes) |
| tick with a proxy and friction, 5 mm deep: a needle on its tip | $(value needle_median) / $(value needle_p99) / $(value needle_most) | | $(value needle_bytes) |
| the same, a tool that lies on the mesh | $(value lying_median) / $(value lying_p99) / $(value lying_most) | | $(value lying_bytes) |

END
[ "$(value sample)" -lt 10000 ] && [ $(($1 + $3)) -lt 8192 ] && [ "$2" -eq 0 ] && [ "$4" -eq 0 ] && [ "$8" -eq 0 ]
verdict $? "the protocol costs a sample less than 10,000 instructions, 8 KB of text and no static RAM"
[ "$(value arm_tick)" -lt 20000 ] && [ "$(value stack_arm)" -lt 2048 ] && [ "${10}" -eq 0 ] && [ "${12}" -eq 0 ]
verdict $? "an arm of three joints costs a tick less than 20,000 instructions, 2 KB of stack and no static RAM"

# Against the slowest tick that finds the nearest pair anew; twice what it was when this was written.
nearest=$(value track_most)
[ "$(value needle_median)" -gt "$(value depth_median)" ] && [ "$(value lying_median)" -lt $((15 * nearest)) ] &&
    [ "$(value needle_median)" -lt $((12 * nearest)) ] && [ "$(value lying_most)" -lt $((200 * nearest)) ] &&
    [ "$(value needle_most)" -lt $((140 * nearest)) ]
verdict $? "a proxy with friction costs a tick less than 15 times the slowest nearest pair in the median, 200 times at most"

if [ -x "$build/tests/firmware/link" ]; then
    timeout 300 "$build/tests/firmware/link" $run -chardev pty,id=p -serial chardev:p -kernel "$out/device.elf" >"$out/link.log" 2>&1
    cat "$out/link.log" | sed '$d'
    set -- $(sed -n '$s/^\([0-9]*\) passed, \([0-9]*\) failed.*/\1 \2/p' "$out/link.log") 0 1
    passed=$((passed + $1)) failed=$((failed + $2))
else
    bad "no $build/tests/firmware/link"
fi

# safe_device on it, and the plug pulled.
if [ -x "$build/tests/firmware/pull" ] && [ -x "$build/tests/safe_device" ]; then
    pulls=${PULLS:-16}
    timeout $((60 + 10 * pulls)) "$build/tests/firmware/pull" "$build/tests/safe_device" "$out/mesh.dpa" "$out/meter" $pulls $run -chardev pty,id=p \
        -serial chardev:p -serial "file:$out/meter" -kernel "$out/pressed.elf" >"$out/pull.log" 2>&1
    cat "$out/pull.log" | sed '$d'
    set -- $(sed -n '$s/^\([0-9]*\) passed, \([0-9]*\) failed.*/\1 \2/p' "$out/pull.log") 0 1
    passed=$((passed + $1)) failed=$((failed + $2))
else
    bad "no $build/tests/firmware/pull or safe_device"
fi
finish
