#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
#
# Commands on a real Linux kernel with SocketCAN, in an emulated machine:
#
#     sh tests/vm/run.sh [-t SECONDS] COMMAND...
#     sh tests/vm/run.sh build/tests/vm/test_slcan 'build/dynpoint device list'
#
# Each argument is a line for the shell. They run one after the other, as root, in the root of this repository, and see this
# machine's files; what they write is gone when they end. vcan0 is up. SECONDS (60) is for each of them.
# What they say comes out, between lines that begin with "vm:". The status is 0 if all of theirs are, or the first that is not
# (124: out of time). 77: there can be no such machine here, and a line says why. 125: it broke down.
set -u
cd "$(dirname "$0")/../.." || exit 2
limit=60
if [ "${1:-}" = -t ]; then
    limit=$2
    shift 2
fi
[ $# -gt 0 ] || {
    sed -n '4,13s/^# \{0,1\}//p' "$0"
    exit 2
}
for tool in qemu-system-x86_64 timeout; do
    command -v $tool >/dev/null 2>&1 || {
        echo "skip a real kernel: no $tool"
        exit 77
    }
done
sh tests/vm/kernel.sh || exit

cache=build/vm
run=$cache/run.$$
trap 'rm -rf "$run"' EXIT
trap 'kill "$(cat "$run/pid" 2>/dev/null)" 2>/dev/null; exit 143' INT TERM HUP
mkdir "$run" && printf '%s\n' "$@" >"$run/job" || exit 2
kernel=$cache/vmlinux
[ -f $kernel ] || kernel=$cache/vmlinuz

# Without KVM: that /dev/kvm is there does not mean that a kernel boots with it. One processor: of two the emulator's threads
# keep each other waiting where this machine is busy. A guest that restarts has ended.
{
    timeout --foreground -k 5 $((60 + limit * $#)) qemu-system-x86_64 -M pc -accel tcg -cpu qemu64 -smp 1 -m 512 -no-reboot \
        -nodefaults -no-user-config -display none -pidfile "$run/pid" -kernel $kernel -initrd $cache/initramfs \
        -append "console=ttyS0 quiet panic=-1 nokaslr mitigations=off cryptomgr.notests repository=\"$PWD\" job=$run/job limit=$limit" \
        -virtfs local,path=/,mount_tag=host,security_model=none,readonly=on,multidevs=remap \
        -serial "file:$run/console" -serial stdio </dev/null 2>"$run/error" ||
        echo "vm: QEMU ended with status $?"
} | tee "$run/said" &
wait $!
if [ "$(tail -n 1 "$run/said")" = "vm: end" ]; then
    exit "$(sed -n 's/^vm: status \([0-9]*\) of .*/\1/p' "$run/said" | grep -v '^0$' | head -n 1 | grep . || echo 0)"
fi
echo "vm: the machine broke down"
cat "$run/error" "$run/console" | tail -n 60
exit 125
