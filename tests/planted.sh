#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# That the tests find faults: `sh tests/planted.sh BUILD [TABLE]`, about two minutes on two cores. In a copy of the tree
# each fault of tests/planted.txt is planted alone; the test that is named for it must pass without it, and fail a check
# with it. A test is a program, with its argument of `make test` or else of `make check`, a script of tests/tools, with
# "part", or a page_....js of tests/view, which needs BUILD/view/node_modules and chromium.
set -u
build=$1
here=$(dirname "$0")
table=${2:-$here/planted.txt}
. "$here/lib/verdict.sh"
# A table has a folder of its own: check-release tries two at a time.
scratch=$build/planted/$(cd "$(dirname "$table")" && basename "$PWD")
tree=$scratch/tree
jobs=$(nproc 2>/dev/null || echo 2)
unset DPT_DATA MAKEFLAGS MFLAGS MAKELEVEL
rm -rf "$scratch"
mkdir -p "$tree"

made_by() { # test
    case $1 in *.sh) echo build/dynpoint ;; *.js) echo build/view/page.html ;; *) echo "build/tests/test_$1" ;; esac
}
build_in_tree() { # targets...
    (cd "$tree" && make -s -j"$jobs" "$@") >"$scratch/make.log" 2>&1 </dev/null
}

# Likewise, of a page. Where the test itself ended early, nothing was found.
run_page() {
    mkdir -p "$scratch/room"
    (cd "$tree" && timeout 300 node "tests/view/$1" build/view/page.html ../room) >"$2" 2>&1 </dev/null && return 0
    grep -q '^FAIL' "$2" && ! grep -q "test itself" "$2" && return 1
    return 2
}

# run TEST FILE: the output goes to FILE. Status 0 if it passed, 1 if a check failed, 3 if it checks nothing here, else 2.
run() {
    case $1 in
    *.js)
        run_page "$@"
        return
        ;;
    *.sh) set -- "$2" sh "tests/tools/$1" build part ;;
    *)
        amount=$(awk -v name="$1" '$1 == name { print $2 == "-" ? $3 : $2 }' "$here/programs.txt")
        set -- "$2" "build/tests/test_$1" "$amount"
        ;;
    esac
    out=$1
    shift
    [ "$2" != all ] || set -- "$1"
    (cd "$tree" && timeout 300 "$@") >"$out" 2>&1 </dev/null
    status=$?
    case $(tail -n 1 "$out") in
    '0 passed, 0 failed, '*) return 3 ;;
    *[0-9]' passed, 0 failed, '*) [ $status -eq 0 ] || return 2 ;;
    *[0-9]' passed, '[1-9]*' failed, '*) return 1 ;;
    *) return 2 ;;
    esac
}

# plant FILE RIGHT WRONG: replaces the one place of FILE where RIGHT stands; status 1 if there are others, or none.
plant() {
    RIGHT=$2 WRONG=$3 awk '
        BEGIN { right = ENVIRON["RIGHT"] }
        (at = index($0, right)) {
            found += index(substr($0, at + 1), right) ? 2 : 1
            $0 = substr($0, 1, at - 1) ENVIRON["WRONG"] substr($0, at + length(right))
        }
        { print }
        END { exit found != 1 }' "$here/../$1" >"$scratch/planted" && cp "$scratch/planted" "$tree/$1"
}

# judge FILE TEST RIGHT WRONG WHAT
judge() {
    name="$5 ($1, by $2)"
    if ! plant "$1" "$3" "$4"; then
        bad "$name: this is not once in its file: $3"
    elif ! build_in_tree "$(made_by "$2")"; then
        bad "$name: it does not build, see $scratch/make.log"
    else
        run "$2" "$scratch/$2.found"
        case $? in
        0) bad "$name: not found" ;;
        1) ok "$name" ;;
        3) skip "$name: $2 checks nothing here" ;;
        *) bad "$name: $2 ended without a failed check, see $scratch/$2.found" ;;
        esac
    fi
    cp "$here/../$1" "$tree/$1"
}

# The objects of the build are taken over, not its programs: those are linked in a second each.
mkdir -p "$tree/build"
(cd "$here/.." && tar cf - include src drivers tools tests docs Makefile) | tar xf - -C "$tree" &&
    (cd "$build" && find src drivers tools tests built_with.h -name '*.[oadh]' | tar cf - -T -) | tar xf - -C "$tree/build"
verdict $? "a copy of the tree and its objects"

if [ -e "$build/view/node_modules" ]; then
    mkdir -p "$tree/build/view" && ln -s "$(cd "$build" && pwd)/view/node_modules" "$tree/build/view/"
fi
if grep -q '^[a-z][^ ]* page_.*js ' "$table" && { [ ! -e "$tree/build/view/node_modules" ] || ! command -v chromium >/dev/null; }; then
    skip "faults of the page: three.js or chromium is missing (make deps view)"
    finish
fi

tests=$(sed -n 's/^[a-z][^ ]* \([^ ]*\) .*/\1/p' "$table" | LC_ALL=C sort -u)
build_in_tree $(for test in $tests; do made_by "$test"; done | sort -u)
verdict $? "the tests that are named are built, see $scratch/make.log"
for test in $tests; do
    run "$test" "$scratch/$test.out"
    status=$?
    if [ $status -eq 3 ]; then skip "$test checks nothing here"; else verdict $status "$test passes without a fault"; fi
done

right=
while IFS= read -r line; do
    case $line in
    '' | '#'*) ;;
    '- '*) right=${line#- } ;;
    '+ '*) judge "$file" "$test" "$right" "${line#+ }" "$fault" ;;
    *)
        file=${line%% *} fault=${line#* }
        test=${fault%% *} fault=${fault#* }
        ;;
    esac
done <"$table"
finish
