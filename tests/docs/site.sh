#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The site of `make docs`: it is made without a warning, below its version; each public function and each name of Python's
# package has its place; links and pictures lead to files that are there.
#
#     sh tests/docs/site.sh [BUILD=build]
set -u
cd "$(dirname "$0")/../.." || exit 2
. tests/lib/verdict.sh
build=${1:-build}
mkdir -p "$build/docs"
if ! command -v doxygen >/dev/null || [ ! -e build/venv-docs/complete ]; then
    skip "the site of the pages: no doxygen or no Sphinx (make deps docs)"
    finish
fi
make -s docs >"$build/docs/made.log" 2>&1
verdict $? "make docs: $(tail -n 1 "$build/docs/made.log")"
python3 -B tests/docs/site.py "$build" >"$build/docs/said"
while read -r word rest; do
    case $word in
    ok) ok "$rest" ;;
    FAIL) bad "$rest" ;;
    esac
done <"$build/docs/said"
[ "$(wc -l <"$build/docs/said")" -ge 7 ]
verdict $? "all of it was looked at"
finish
