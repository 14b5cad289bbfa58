# SPDX-License-Identifier: BSD-3-Clause
# What a test script prints. A script reads it in by `. "$(dirname "$0")/lib/verdict.sh"`, prints a line for each check,
# and last "N passed, M failed, K skipped", which tests/run.sh adds up.
#
#   ok WHAT, bad WHAT, skip WHAT   count a check and print its line; with quiet=1, what passes has no line
#   verdict STATUS WHAT            ok if STATUS is 0, else bad: [ -s file ]; verdict $? "the file has content"
#   check WHAT COMMAND...          ok if the command's status is 0, else bad; its output goes to the file $log, if set
#   finish                         prints the last line and ends the script: status 0 if nothing failed, else 1
passed=0 failed=0 skipped=0 quiet='' log=''

ok() {
    passed=$((passed + 1))
    [ -n "$quiet" ] || printf '  ok   %s\n' "$*"
}
bad() {
    failed=$((failed + 1))
    printf '  FAIL %s\n' "$*"
}
skip() {
    skipped=$((skipped + 1))
    printf '  skip %s\n' "$*"
}
verdict() {
    if [ "$1" -eq 0 ]; then ok "$2"; else bad "$2"; fi
}
check() {
    what=$1
    shift
    if [ -n "$log" ]; then "$@" >>"$log" 2>&1; else "$@"; fi
    verdict $? "$what"
}
finish() {
    echo "$passed passed, $failed failed, $skipped skipped"
    [ "$failed" -eq 0 ]
    exit
}
