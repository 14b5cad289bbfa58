#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Help, and what the command line refuses.
# `sh tests/tools/cli_usage.sh BUILD`.
. "$(dirname "$0")/cli.sh"

help_and_version()
{
    for command in '' make compile info replay record run plan chart force-test 'make trace'; do
        for option in --help --version; do
            # shellcheck disable=SC2086
            run $command $option
            check "$command $option: exit $status" test $status -eq 0
            check "$command $option: nothing printed" test -s stdout
            check "$command $option: $(cat stderr)" test ! -s stderr
        done
    done
    for command in make compile info replay record chart 'make trace'; do
        # shellcheck disable=SC2086
        run $command --help
        check "$command --help: whose?" grep -q "^usage:.*dynpoint $command" stdout
    done
}

usage_errors()
{
    refuses 'no command' 'command'
    refuses 'unknown command' frobnicate frobnicate
    refuses 'option for a command' --json --json
    for command in make compile info replay record; do
        refuses "$command alone" "dynpoint $command: " $command
        refuses "$command: unknown option" --frob $command --frob
        refuses "$command: surplus words" "dynpoint $command: " $command a b c d -o out/x.ply
    done
    refuses 'make trace: no -o' 'dynpoint' make trace --mesh box.dpa
    refuses 'compile: -o without value' -- -o compile box.ply -o
    refuses 'compile: --scale without value' --scale compile box.ply -o out/x --scale
    for value in nan inf -1 0 one 1x '' 1,5 0x10; do
        refuses "compile --scale '$value'" scale compile box.ply -o out/x --scale "$value"
    done
    for value in 0 -1 1.5 many '' 99999999999999999999; do
        refuses "compile -j '$value'" j compile box.ply -o out/x -j "$value"
    done
    for value in nan inf -1 0 180.1 sharp ''; do
        refuses "compile --crease '$value'" crease compile box.ply -o out/x --crease "$value"
    done
    for value in '' 9a a-b 'a b' 'x;y' int class restrict _Bool uint64_t; do
        refuses "compile --c-array '$value'" "$value" compile box.ply -o out/x --c-array "$value"
    done
    for pair in radius:nan radius:inf radius:-0.001 radius:1e7 radius:wide radius: dt:0 dt:-1 \
        dt:nan dt:inf dt:soon stiffness:nan stiffness:inf stiffness:-1 stiffness:2e9 \
        stiffness:hard repeat:0 repeat:-1 repeat:1.5 repeat:many repeat:99999999999999999999 \
        radius:1e7:1e6 strip-width:1e7:1e6 dt:1e7:1e6 every:-1 every:1.5 every:20:against budget:-1 budget:1.5 budget:4294967296 budget:few method:guess law:soft law:2 against:guess until:lunch kernel:abacus; do
        name=${pair%%:*} value=${pair#*:}
        expected=$name
        [ "$value" = "${value#*:}" ] || expected=${value#*:}
        refuses "replay --$pair" "$expected" \
            replay box.dpa box.csv -o out/x --"$name" "${value%%:*}"
    done
    for method in tree brute paper; do
        refuses "replay --budget with $method" budget replay box.dpa box.csv -o out/x \
            --method $method --budget 8
    done
    refuses 'replay --json beside -o -' json replay box.dpa box.csv -o - --json
    for name in ticks length band speed; do
        for value in nan inf -1 1e300 1e999 long; do
            refuses "make trace --$name $value" $name \
                make trace --mesh box.dpa -o out/x --ticks 3 --$name $value
        done
    done
    # A run that is not refused would not end.
    printf '#!/bin/sh\nexec timeout 20 %s "$@"\n' "'$program'" >limited && chmod 755 limited
    whole=$program program=$PWD/limited
    refuses 'run --ticks 0' '--ticks must be positive' run box.dpa --device sim --ticks 0
    refuses 'run --for 0' '--for must be positive' run box.dpa --device sim --for 0
    refuses 'view --ticks 0' '--ticks must be positive' view tori --ticks 0
    program=$whole
    refuses 'replay --plan --ticks 0' '--ticks must be 1 to' replay --plan none.json --ticks 0
    refuses 'settings without a colon' "settings follow a colon, as in sim:?hand=press" \
        run box.dpa --device 'sim?hand=press' --ticks 5
    refuses 'settings of a driver that is none' "there is no driver 'sin?hand=press'" \
        run box.dpa --device 'sin?hand=press' --ticks 5
    refuses 'make trace --ticks 0' ticks make trace --mesh box.dpa -o out/x --ticks 0
    refuses 'make: unknown shape' pyramid make pyramid -o out/x.ply
    refuses 'make: no format' x.xyz make box -o out/x.xyz
    refuses 'make: no ending' 'dynpoint' make box -o out/x
    for count in 0 -12 12.5 13 one 11 99999999999 99999999999999999999; do
        refuses "make box $count" 'dynpoint make: ' make box "$count" -o out/x.ply
    done
    refuses 'make torus without number' torus make torus -o out/x.ply
    refuses 'make laparoscopic, too few' 'dynpoint' make laparoscopic 999 -o out/x.ply
    refuses 'replay --every 0' 'must be 1' replay box.dpa box.csv -o out/x --against brute --every 0
    refuses 'make trace: bad seed' 'dynpoint make trace: --seed' make trace --mesh box.dpa -o out/x --seed -1
    refuses 'make: bad seed' seed make box -o out/x.ply --seed -1
}

prepare
help_and_version
usage_errors
finish
