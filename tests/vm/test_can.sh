#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# tests/drivers/test_can.c on a real kernel's bus in place of the one that stands in for it. For tests/vm/run.sh.
case $1 in
*/*) cycles=3000 ;; # built to find faults, not to be fast
*) cycles=15000 ;; # the kernel's bus; 60,000 are on the one that stands in for it
esac
DPT_CAN=vcan0 "$1/tests/test_can" $cycles
