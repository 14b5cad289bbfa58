#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Build the program of tests/oracle/inside_cgal.cpp where its package is here; where it is not, its test is skipped.
# `sh tests/oracle/inside.sh BUILD`.
set -u
program=$1/tests/inside_cgal
source=tests/oracle/inside_cgal.cpp
[ "$program" -nt "$source" ] && exit 0
echo '#include <CGAL/Side_of_triangle_mesh.h>' | g++ -std=c++17 -E -x c++ - >/dev/null 2>&1 || exit 0
mkdir -p "$1/tests"
# Its predicates go on with interval arithmetic, which changes the rounding.
g++ -O2 -std=c++17 -frounding-math -DNDEBUG "$source" -o "$program" -lgmp -lmpfr 2>"$program.log" || {
    rm -f "$program"
    echo "libcgal-dev is here, but $source does not build: $program.log"
}
exit 0
