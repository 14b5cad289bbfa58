# SPDX-License-Identifier: BSD-3-Clause
# For scripts that have read in verdict.sh and made a folder $room: checks that another program prints, "ok WHAT",
# "FAIL WHAT" or "skip WHAT" a line (tests/view/verdicts.js); "note TEXT" is shown.

# count WHAT COMMAND...: adds the checks that a program prints; one that ends badly without saying why is a failure
count() {
    what=$1
    shift
    "$@" >"$room/said" 2>"$room/errors"
    status=$?
    before=$failed
    while read -r word rest; do
        case $word in
        ok) ok "$rest" ;;
        FAIL) bad "$rest" ;;
        skip) skip "$rest" ;;
        note) echo "       $rest" ;;
        esac
    done <"$room/said"
    [ $status -eq 0 ] || [ "$failed" -gt "$before" ] || bad "$what: status $status, $(grep -m 1 '^[A-Za-z]*Error: ' "$room/errors" || tail -n 1 "$room/errors")"
    grep -q '^ok\|^FAIL\|^skip' "$room/said" || bad "$what: it checked nothing"
}
