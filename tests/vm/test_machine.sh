#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The machine itself, for tests/vm/check.sh, from within: sh tests/vm/test_machine.sh BUILD
. tests/lib/verdict.sh
build=$1 log=/dev/null

check "the kernel is the one that was fetched" test -d "build/vm/tree/lib/modules/$(uname -r)"
check "it is one processor" test "$(nproc)" -eq 1
check "the program of this build runs" "$build/dynpoint" device list
check "files can be written" sh -c "echo 1 >$build/vm.written && echo 2 >/tmp/vm.written"
check "vcan0 is up" grep -q 0x.*1 /sys/class/net/vcan0/flags
check "scripts set interfaces down" sh -c 'ip link set vcan0 down && ! ip link show vcan0 | grep -q ,UP'
check "and up" sh -c 'ip link set vcan0 up && ip link show vcan0 | grep -q ,UP'
check "and add and remove them" sh -c 'ip link add vcan5 type vcan && ip link del vcan5 && ! test -e /sys/class/net/vcan5'
check "programs have pseudo-terminals" test -c /dev/ptmx -a -d /dev/pts
finish
