#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The kinematics of robots' descriptions against an oracle of their own, and pinocchio's where `make deps kinematics` put it
# into build/venv-urdf: `sh tests/oracle/urdf.sh BUILD`.
set -u
build=$1
venv=build/venv-urdf
if [ ! -x "$build/tests/urdf/answers" ] || [ ! -e "$build/libdynpoint_urdf.a" ]; then
    echo "  skip kinematics of robots' descriptions: no urdfdom with g++"
    echo "0 passed, 0 failed, 1 skipped"
    exit 0
fi
if ! command -v python3 >/dev/null 2>&1; then
    echo "  skip kinematics of robots' descriptions: no python3"
    echo "0 passed, 0 failed, 1 skipped"
    exit 0
fi
python=python3
[ ! -f $venv/complete ] || python=$venv/bin/python
exec $python tests/oracle/urdf_kinematics.py "$build"
