#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The extension's own sources under ASan and UBSan, in make check-release: sh tests/python/sanitize.sh [BUILD=build].
# The library that they call is sanitized in the tests in C. Nor is the interpreter: the run-time library of ASan is
# loaded before it. What Python leaves at its end is its own business; life.py counts what objects of the package leave.
set -u
cd "$(dirname "$0")/../.." || exit 2
. tests/lib/verdict.sh
. tests/lib/count.sh
build=$PWD/${1:-build}
python=$build/venv-python/bin/python
made=$build/python/sanitized room=$(mktemp -d) || exit 2
trap 'rm -rf "$room"' EXIT

if [ ! -f "$build/venv-python/complete" ]; then
    skip "Python's package under sanitizers: no packages (make deps python)"
    finish
fi
rm -rf "$made/site" && mkdir -p "$made"
make -s -j"${JOBS:-2}" wheel "${1:-build}/python/sanitized/_dynpoint.abi3.so" PYTHON="$python" >"$made/make.log" 2>&1 &&
    "$python" -m pip install --quiet --no-index --no-deps --target "$made/site" "$build"/python/dynpoint-*.whl \
        >>"$made/make.log" 2>&1 &&
    cp "$made/_dynpoint.abi3.so" "$made/site/dynpoint"
verdict $? "an extension of sanitized sources, see $made/make.log"
# With that of C++, whose exceptions it wants to see: others' extensions bring it later.
runtime="$(${CC:-cc} -print-file-name=libasan.so) $(${CC:-cc} -print-file-name=libstdc++.so.6)"
for test in misuse.py "life.py 2000" feel.py view.py files.py safety.py; do
    # Objects of Python have red zones too where each is a block of malloc's. But then Python keeps up to 50 kB, however
    # often objects are made, and life.py is about what it keeps; so ASan may keep little of what was freed.
    case $test in
    life*) allocator=default kept=1 ;;
    *) allocator=malloc kept=64 ;;
    esac
    # The words of one test, and its number.
    # shellcheck disable=SC2086
    count "${test%.py*}" env LD_PRELOAD="$runtime" ASAN_OPTIONS=detect_leaks=0:abort_on_error=1:quarantine_size_mb=$kept \
        UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1 \
        PYTHONMALLOC=$allocator PYTHONPATH="$made/site" PYTHONDONTWRITEBYTECODE=1 DYNPOINT_BUILD="$build" \
        "$python" -W ignore tests/python/$test
done
finish
