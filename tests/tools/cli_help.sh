#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# What helps at the command line: help in all its forms, values behind an equals sign, typos (typos.txt), completion, the
# manual's pages. `sh tests/tools/cli_help.sh BUILD`.
. "$(dirname "$0")/cli.sh"
packaging=$tests/../tools/packaging
commands=$("$program" help | sed -n 's/^  \([a-z-][a-z-]*\)  .*/\1/p')
# And what the commands have in turn, a line each.
all_commands=$(
    printf '%s\n' "$commands" 'make trace'
    for command in device record; do "$program" complete $command '' | grep -v '^:' | sed "s/^/$command /"; done
)

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
    printf '%s\n' "$all_commands" >asked_of
    check "commands and what they have: $(wc -l <asked_of)" test "$(wc -l <asked_of)" -eq 21
    while read -r command; do
        # shellcheck disable=SC2086
        run $command --help
        check "$command --help" grep -q "^usage: dynpoint $command " stdout
        # shellcheck disable=SC2086
        for asked in "help $command" "$command -h"; do
            "$program" $asked >asked 2>stderr
            check "$asked: $(cat stderr)" cmp -s stdout asked
        done
    done <asked_of
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
    check 'what a sub-command takes, and no more' test "$(words device list - | tr '\n' ' ')" = '--help --json --version '
    check 'files alone' test "$(words info '')" = :files
    check 'nothing beyond' test -z "$(words info a.dpa '')"
    check 'an unknown command' test -z "$(words frobnicate '')"
    # What a help lists is what is completed, and the other way round.
    while read -r command; do
        # shellcheck disable=SC2086
        "$program" help $command >help.txt
        grep -oE '^  (-[A-Za-z]|--[a-z-]+)' help.txt | tr -d ' ' | LC_ALL=C sort -u >listed
        # shellcheck disable=SC2086
        words $command - | grep -vxE -e '--(help|version)' >completed
        check "$command: listed, not completed: $(LC_ALL=C comm -23 listed completed)" test -z "$(LC_ALL=C comm -23 listed completed)"
        while read -r option; do
            check "$command: $option is not in its help" grep -qE -e "(^|[^a-z-])$option([^a-z-]|\$)" help.txt
        done <completed
    done <asked_of
}

# By bash itself, as a user types: each option of each command, from all but its last letter.
by_bash()
{
    if ! command -v bash >/dev/null; then
        skip 'completion by bash: there is none'
        return
    fi
    while read -r command; do
        # shellcheck disable=SC2086
        words $command - | sed "s|^|$command |"
    done <asked_of | grep -v -e '=' >all
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
    check "options: $(wc -l <all)" test "$(wc -l <all)" -ge 195
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
    succeeds 'device watch --json' device watch sim --json --for 0.01
    head -n 1 stdout >sample.json
    check "a sample: $(cat sample.json)" has_keys sample.json sequence status position orientation velocity joints buttons
    check 'a sample a line' test "$(grep -c '^{"sequence":[0-9]*,.*}$' stdout)" -eq "$(wc -l <stdout)"
    succeeds 'device simulate --json' device simulate serial --json --for 0.01
    check "its name: $(cat stdout)" grep -q '^{"name":"serial:/' stdout
    succeeds 'make --json' make laparoscopic 1200 -o three.obj --json
    check "what was made: $(cat stdout)" has_keys stdout files
    for name in liver stomach spleen; do
        check "three-$name.obj" grep -q "\"path\":\"three-$name.obj\",\"triangles\":$(grep -c '^f' three-$name.obj),\"vertices\":$(
            grep -c '^v ' three-$name.obj)}" stdout
    done
    succeeds 'a run' run tori --device 'sim:?hand=press' --ticks 1500 --record run.dpr
    succeeds 'its columns' record csv run.dpr -o run.csv
    succeeds 'plot --json' plot run.csv -o run.svg --json
    check "what was drawn: $(cat stdout)" has_keys stdout from to runs
    force=$(awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
        { f = sqrt($at["sent_fx"] ^ 2 + $at["sent_fy"] ^ 2 + $at["sent_fz"] ^ 2); if (f > most) most = f }
        END { printf "%.6g", most }' run.csv)
    check "something is felt: $force" test "${force%%.*}" -ge 1
    check "the strongest is $force: $(cat stdout)" test "$(sed 's/.*"Force".*"highest":\([0-9.e-]*\),.*"Gap".*/\1/' stdout |
        awk '{ printf "%.6g", $1 }')" = "$force"
    refuses 'plot: both want standard output' '--json and -o -' plot run.csv -o - --json
    # Whatever tells something has it; these three write a file, or a page, and tell nothing else.
    while read -r command; do
        # shellcheck disable=SC2086
        case $command in 'make trace' | 'record csv' | record) continue ;; esac
        # shellcheck disable=SC2086
        check "$command has no --json" test -n "$(words $command --jso)"
    done <asked_of
}

# An error names what was typed, and is status 2; a command without anything too, but for those that need nothing.
errors()
{
    while read -r command; do
        # shellcheck disable=SC2086
        refuses "$command --nonsense" "dynpoint $command: unknown option --nonsense" $command --nonsense
        case $command in stability | 'device list') continue ;; esac
        # shellcheck disable=SC2086
        refuses "$command alone" "dynpoint $command: " $command
    done <asked_of
    refuses 'a scene that is viewed' 'dynpoint view: --zoom must be' view tori --zoom 0
    refuses 'a device that is watched' "dynpoint device watch: sin: there is no driver 'sin'" device watch sin
    refuses 'an option of another one' 'dynpoint device list: unknown option --swing' device list --swing 1
    refuses 'a recording that there is none of' 'dynpoint record info: none.dpr' record info none.dpr
}

# on_terminal ARGUMENT...: what comes to a terminal, which `script` makes, into typed
on_terminal()
{
    script -qec "'$program' $*" typed </dev/null >/dev/null 2>&1
}

# The table of docs/index.md. What is damaged is told, with status 1.
statuses()
{
    succeeds 'a whole file' info torus.dpa --verify
    "$program" info torus.dpa | head -n 1 >whole
    { head -c 3000 torus.dpa; printf x; tail -c +3002 torus.dpa; } >damaged.dpa
    run info damaged.dpa --verify
    check "a damaged file: $status" test $status -eq 1
    { head -c 90000 run.dpr; printf xxxx; tail -c +90005 run.dpr; } >damaged.dpr
    for command in 'record info damaged.dpr' 'record csv damaged.dpr -o damaged.csv' 'plot damaged.dpr -o damaged.svg'; do
        # shellcheck disable=SC2086
        run $command
        check "$command: $status" test $status -eq 1
    done
    run replay damaged.dpr
    check "replay: $status" test $status -ne 0
    run plan torus.dpa --error 0.1mm --rate 100kHz --ticks 10000 --json
    check "plan: $status $(cat stdout stderr)" test $status -le 1
    run frobnicate
    check "no command: $status" test $status -eq 2
}

# Time that is left, on a terminal, and nowhere else; no colour on either, which NO_COLOR could switch off.
terminal()
{
    if ! command -v script >/dev/null; then
        skip 'what a terminal shows: no script(1)'
        return
    fi
    succeeds 'what takes long, without a terminal' force-test torus.dpa --places 12 --paths 60
    check "silent: $(cat stderr)" test ! -s stderr
    # Long enough for this machine.
    for places in 200 400 800 1600 3200; do
        on_terminal force-test torus.dpa --places $places --paths 60
        tr '\r' '\n' <typed >lines
        ! grep -q ' s left' lines || break
    done
    check "time that is left: $(head -n 5 lines)" grep -qE '^[a-z -]+ +[0-9]+ %, [0-9]+ s left *$' lines
    check 'the line is wiped' grep -qE '^ {40,}$' lines
    for command in help 'stability --list' 'device list' 'info torus.dpa' 'device watch sim --for 0.1' 'make none'; do
        for colour in '' 'NO_COLOR=1'; do
            env $colour TERM=xterm-256color script -qec "'$program' $command" typed </dev/null >/dev/null 2>&1
            check "$command, $colour: colour" test "$(grep -c "$(printf '\033')\[[0-9;]*m" typed)" -eq 0
        done
        # shellcheck disable=SC2086
        run $command
        check "$command: a terminal's codes" test "$(cat stdout stderr | grep -c "$(printf '\033')")" -eq 0
    done
}

helps
equals
json
errors
statuses
terminal
typos
completion
by_bash
manual
finish
