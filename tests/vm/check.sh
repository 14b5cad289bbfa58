#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# In make check: every test_* of tests/vm, programs and scripts, on a real kernel, in one boot. A program BUILD/tests/vm/test_X is run
# without arguments, a script tests/vm/test_X.sh with BUILD; both end in "N passed, M failed, K skipped". $DPT_PEER runs
# tests/vm/peer.py there, where `make deps vm` put what it needs into build/venv.
#
#     sh tests/vm/check.sh [BUILD...]
set -u
cd "$(dirname "$0")/../.." || exit 2
builds=${*:-build}
said=build/vm.out

venv=build/venv
[ -f $venv/complete ] || echo "  no python-can: make deps vm"
peer=
[ -f $venv/complete ] && peer="DPT_PEER='$venv/bin/python tests/vm/peer.py' "

set --
for build in $builds; do
    for test in "$build"/tests/vm/test_* tests/vm/test_*.sh; do
        [ -f "$test" ] || continue
        case $test in
        *.o | *.d) ;;
        *.sh) set -- "$@" "${peer}sh $test $build" ;;
        *) set -- "$@" "$peer$test" ;;
        esac
    done
done
sh tests/vm/run.sh -t 300 "$@" >"$said" 2>&1
status=$?
sed 's/^vm: run \(DPT_PEER=.* tests.vm.peer.py. \)\{0,1\}\(sh \)\{0,1\}/- /; /^vm: /d; s/^skip /  skip /; /^[0-9]* passed, /d' "$said"
if [ $status -eq 77 ]; then
    echo "0 passed, 0 failed, 1 skipped"
    exit 0
fi
# What is written there does not come here.
written=0
for place in $builds /tmp; do
    [ ! -e "$place/vm.written" ] || written=1
done
awk -v status=$status -v written=$written '
/^[0-9]+ passed, [0-9]+ failed, [0-9]+ skipped$/ { passed += $1; failed += $3; skipped += $5; sum = $3 + 1 }
/^vm: status / {
    if (!sum || ($3 != 0 && sum == 1)) {
        print "  FAIL status " substr($0, 12)
        failed++
    }
    sum = 0
    ended++
}
END {
    if (status == 125) {
        print "  FAIL the machine broke down"
        failed++
    }
    if (written) {
        print "  FAIL the machine writes to this one"
        failed++
    }
    print passed + 0 " passed, " failed + 0 " failed, " skipped + 0 " skipped"
    exit failed > 0
}' "$said"
