#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Our frames of motors and those of libraries that others wrote, where `make deps motors` put these into build/venv-motors:
# `sh tests/drivers/drive_peers.sh BUILD [COUNT]`, COUNT frames each way and drive.
build=$1 count=${2:-10000}
. tests/lib/verdict.sh
python=build/venv-motors/bin/python
if [ ! -f build/venv-motors/complete ]; then
    skip "libraries for motors: make deps motors"
    finish
fi
for drive in damiao robstride cybergear moteus; do
    said=$($python tests/drivers/drive_peers.py "$build/tests/test_drive" "$count" $drive 2>&1)
    status=$?
    echo "    $(echo "$said" | grep '^[a-z]* ours' || echo "$said" | tail -n 3)"
    check "$drive: its library and this one understand each other" test $status -eq 0
done
finish
