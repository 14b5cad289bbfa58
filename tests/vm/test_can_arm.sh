#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# tests/drivers/test_can_arm.c on a real kernel's bus in place of the one that stands in for it. For tests/vm/run.sh.
DPT_CAN=vcan0 "$1/tests/test_can_arm"
