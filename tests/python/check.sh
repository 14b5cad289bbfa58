#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The package of Python: a wheel is built, installed into a folder, and tested there.
#
#     sh tests/python/check.sh [BUILD=build]
#
# With RELEASE=yes also 2,000 organs on Dask's workers, and Newton's sample (make deps newton).
set -u
cd "$(dirname "$0")/../.." || exit 2
. tests/lib/verdict.sh
. tests/lib/count.sh
build=${1:-build}
python=$PWD/$build/venv-python/bin/python room=$(mktemp -d) || exit 2
trap 'rm -rf "$room"' EXIT

if [ ! -f "$build/venv-python/complete" ]; then
    skip "Python's package: no packages to build and test it (make deps python)"
    finish
fi
site=$PWD/$build/python/site
rm -rf "$site"
mkdir "$room/old" && echo '__version__ = "76.1.0"' >"$room/old/setuptools.py"
PYTHONPATH=$room/old "$python" -B src/bindings/python/setup.py bdist_wheel >"$room/said" 2>&1
[ $? -eq 1 ] && grep -q 'needs setuptools 77 or newer, and .* has 76.1.0' "$room/said" && ! grep -q Traceback "$room/said"
verdict $? "an old setuptools is refused in words: $(tail -n 1 "$room/said" | sed 's/, and .*//')"
make -s wheel PYTHON="$python" CFLAGS_EXTRA=-Werror >"$room/make" 2>&1
verdict $? "make wheel: $(tail -n 1 "$room/make")"
log=$build/python/check.log
: >"$log"
check "it installs" "$python" -m pip install --quiet --no-index --no-deps --target "$site" "$build"/python/dynpoint-*.whl
check "it keeps to the stable ABI of 3.11, see $log" "$build/venv-python/bin/abi3audit" --strict "$build"/python/dynpoint-*.whl
check "its types pass mypy --strict, see $log" env MYPYPATH="$site" "$build/venv-python/bin/mypy" --strict \
    --cache-dir "$build/python/mypy" -p dynpoint
check "a user's types do, see $log" env MYPYPATH="$site" "$build/venv-python/bin/mypy" --strict \
    --cache-dir "$build/python/mypy" tests/python/typed.py
log=
[ "${RELEASE:-no}" != yes ] || export BULK=2000
# Away from the tree: nothing of it is found by accident.
for test in feel.py misuse.py life.py safety.py files.py parts.py view.py batch.py bulk.py exports.py with_newton.py; do
    count "${test%.py}" env PYTHONPATH="$site" PYTHONDONTWRITEBYTECODE=1 DYNPOINT_BUILD="$PWD/$build" "$python" -X dev -W ignore::ResourceWarning \
        "tests/python/$test"
done
scene() { sh tests/languages/check.sh "$build" python | sed 's/^ *//'; }
count "the scene of all languages" scene
if [ -f build/venv-soft/complete ]; then
    # Where MuJoCo leaves its log.
    with_mujoco() {
        root=$PWD
        (cd "$room" && env PYTHONPATH="$site" PYTHONDONTWRITEBYTECODE=1 DYNPOINT_BUILD="$root/$build" \
            "$root/build/venv-soft/bin/python" -X dev -W ignore::ResourceWarning "$root/tests/python/with_mujoco.py")
    }
    count with_mujoco with_mujoco
else
    skip "with_mujoco: no MuJoCo (make deps soft)"
fi
if [ "${RELEASE:-no}" = yes ] && [ ! -f build/venv-newton/complete ]; then
    skip "Newton: no packages (make deps newton)"
elif [ "${RELEASE:-no}" = yes ]; then
    newton() { env PYTHONPATH="$site" build/venv-newton/bin/python docs/samples/newton_touch.py "$@" >"$room/newton" 2>&1; }
    newton
    verdict $? "Newton's block under a stiff tool: $(tail -n 1 "$room/newton")"
    ! newton 0 && grep -q 'it is not felt as it should be' "$room/newton"
    verdict $? "it shakes where the block does not tell how far it gives way"
fi
finish
