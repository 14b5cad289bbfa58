#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# What helps at the command line: help in all its forms, values behind an equals sign, typos (typos.txt), completion, the
# manual's pages. `sh tests/tools/cli_help.sh BUILD`.
. "$(dirname "$0")/cli.sh"
packaging=$tests/../tools/packaging
commands=$("$program" help | sed -n 's/^  \([a-z-][a-z-]*\)  .*/\1/p')

helps()
{
    for asked in -h help --help; do
        "$program" $asked >"said$asked" 2>stderr
        check "$asked: $(cat stderr)" cmp -s "said$asked" said-h
    done
    check "the commands: $commands" test "$(echo "$commands" | wc -l)" -eq 13
    "$program" --version >version
    check '-V' test "$("$program" -V)" = "$(cat version)"
    check 'run -V' test "$("$program" run -V)" = "$(cat version)"
    for command in $commands 'make trace' 'device identify' 'record csv'; do
        # shellcheck disable=SC2086
        run $command --help
        check "$command --help" grep -q '^usage: dynpoint' stdout
        # shellcheck disable=SC2086
        for asked in "help $command" "$command -h"; do
            "$program" $asked >asked 2>stderr
            check "$asked: $(cat stderr)" cmp -s stdout asked
        done
    done
    refuses 'help of none' 'no such command' help frobnicate
}

equals()
{
    succeeds 'a value behind a blank' run membrane --device sim --ticks 20 --stiffness 150 --json
    sed 's/"\(late\|took\)_us.*//' stdout >blank
    succeeds 'a value behind an equals sign' run membrane --device=sim --ticks=20 --stiffness=150 --json
    sed 's/"\(late\|took\)_us.*//' stdout >sign
    check 'the same' cmp -s blank sign
    check 'something' grep -q '"ticks":20,' sign
    succeeds 'a short one' make box 12 -o=box.obj
    check 'a short one is there' test -s box.obj
    refuses 'a flag has no value' '--json takes no value' run membrane --device=sim --json=yes
    refuses 'no value' "--ticks: '' is not a count" run membrane --device=sim --ticks=
    refuses 'another sign is part of the value' "--ticks: '=2' is not a count" run membrane --device=sim --ticks==2
}

# The text that each typo gets is that of the table; nearly all name what was meant.
typos()
{
    sed -n 's/^\$ //p' "$tests/tools/typos.txt" >typed
    while read -r line; do
        echo "\$ $line"
        # shellcheck disable=SC2086
        "$program" $line </dev/null 2>&1
        echo "$?" >>statuses
    done <typed >told
    sed '/^#/d' "$tests/tools/typos.txt" >wanted
    check "typos: $(diff wanted told)" cmp -s wanted told
    check "at least forty: $(wc -l <typed)" test "$(wc -l <typed)" -ge 40
    check 'each is an error' test "$(sort -u statuses)" = 2
    check "most name what was meant: $(grep -c 'did you mean' told)" test "$(grep -c 'did you mean' told)" -ge 36
}

# words TEXT...: what completes the last one
words()
{
    "$program" complete "$@" 2>stderr | LC_ALL=C sort
}

completion()
{
    check 'commands' test "$(words r | tr '\n' ' ')" = 'record replay run '
    check 'help of a command' test "$(words help st)" = stability
    check 'scenes, and files' test "$(words run mem | tr '\n' ' ')" = ':files membrane '
    check 'drivers' test "$(words run liver --device s | tr '\n' ' ')" = 'serial sim '
    check 'devices of one' test "$(words run liver --device 'sim:?' | head -c 5)" = 'sim:?'
    check 'behind an equals sign' test "$(words run liver --law=p | tr '\n' ' ')" = '--law=point --law=proxy '
    check 'shapes' test "$(words make tor)" = torus
    check 'cases' test "$(words stability spikes hu)" = hum
    check 'of a sub-command' test "$(words device sel)" = selftest
    check 'files alone' test "$(words info '')" = :files
    check 'nothing beyond' test -z "$(words info a.dpa '')"
    check 'an unknown command' test -z "$(words frobnicate '')"
    # What a help lists is what is completed, and the other way round.
    for command in $commands 'make trace'; do
        # shellcheck disable=SC2086
        "$program" help $command >help.txt
        grep -oE '^  (-[A-Za-z]|--[a-z-]+)' help.txt | tr -d ' ' | LC_ALL=C sort -u >listed
        # shellcheck disable=SC2086
        words $command - | grep -vxE -e '--(help|version)' >completed
        check "$command: listed, not completed: $(LC_ALL=C comm -23 listed completed)" test -z "$(LC_ALL=C comm -23 listed completed)"
        while read -r option; do
            check "$command: $option is not in its help" grep -qE -e "(^|[^a-z-])$option([^a-z-]|\$)" help.txt
        done <completed
    done
}

# By bash itself, as a user types: each option of each command, from all but its last letter.
by_bash()
{
    if ! command -v bash >/dev/null; then
        skip 'completion by bash: there is none'
        return
    fi
    for command in $commands 'make trace'; do
        # shellcheck disable=SC2086
        words $command - | sed "s|^|$command |"
    done | grep -v -e '=' >all
    cat >typing.bash <<'B'
. "$1"
unknown=0
typed() { # LINE: into COMPREPLY
    COMP_LINE=$1 COMP_POINT=${#1}
    _dynpoint dynpoint
}
while IFS= read -r line; do
    typed "dynpoint ${line%?}"
    [[ " ${COMPREPLY[*]} " == *" ${line##* } "* ]] || echo "$line: ${COMPREPLY[*]}"
done <all
typed 'dynpoint run liver --law=pro'
[[ ${COMPREPLY[*]} == proxy ]] || echo "behind a sign: ${COMPREPLY[*]}"
typed 'dynpoint run liver --device sim:'
[[ ${COMPREPLY[0]} == '?'* ]] || echo "behind a colon: ${COMPREPLY[*]}"
: >a_file.dpa
typed 'dynpoint info a_fi'
[[ ${COMPREPLY[*]} == a_file.dpa ]] || echo "a file: ${COMPREPLY[*]}"
B
    PATH=$(dirname "$program"):$PATH bash typing.bash "$packaging/complete/dynpoint.bash" >typed 2>&1
    check "bash completes: $(cat typed)" test ! -s typed
    check "options: $(wc -l <all)" test "$(wc -l <all)" -gt 130
}

manual()
{
    sh "$packaging/man.sh" "$program" man
    for command in $commands; do
        check "the page of $command" grep -q "^dynpoint-$command .- " "man/dynpoint-$command.1"
        check "dynpoint.1 names $command" grep -qx "\.BR dynpoint-$command (1)" man/dynpoint.1
    done
    check 'a page has its options' grep -q '^  .-.-stiffness' man/dynpoint-run.1
    if ! command -v groff >/dev/null; then
        skip 'the pages by groff: there is none'
        return
    fi
    for page in man/*.1; do
        groff -man -Tutf8 -ww "$page" >page.txt 2>wrong
        check "$page: $(cat wrong)" test ! -s wrong
    done
}

# What is told is told to programs too.
json()
{
    succeeds 'a mesh' make torus 600 -o torus.obj
    succeeds 'compile --json' compile torus.obj -o torus.dpa --json
    cp stdout compiled.json
    succeeds 'info --json' info torus.dpa --json
    check 'both tell the same' cmp -s stdout compiled.json
    check "one object: $(cat python.log 2>&1)" has_keys compiled.json triangles rounding sections
    refuses 'both want standard output' '--json and -o -' compile torus.obj -o - --json
    succeeds 'device list --json' device list --json
    check "the drivers: $(cat stdout)" has_keys stdout drivers
    check 'as many as without' test "$("$program" device list | grep -c '^[a-z]')" -eq "$(grep -o '"devices"' stdout | wc -l)"
    succeeds 'device selftest --json' device selftest sim --json
    check "the verdicts: $(cat stdout)" has_keys stdout name checks passed failed is_whole
    check 'a whole one' grep -q '"failed":0,"is_whole":true}$' stdout
    refuses 'of these alone' '--json is of list, selftest and identify' device watch sim --json
}

helps
equals
json
typos
completion
by_bash
manual
finish
