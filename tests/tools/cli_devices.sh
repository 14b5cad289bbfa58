#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Devices, and the whole tick on one, all without hardware: `sh tests/tools/cli_devices.sh BUILD`. A simulated device has
# a time of its own. Where time is real, a busy machine can spoil a try, so a check holds if one of several tries passes.
. "$(dirname "$0")/cli.sh"

# Seconds of the clock for each try: a slow start spoils short ones, a pause of the machine is likelier in long ones.
tries='0.2 0.3 0.4 0.2 0.6 0.3 1 0.2 0.4 2 0.3 0.2 4 0.3 0.2 0.4 8'

# soon WHAT COMMAND...: the command, called with the seconds of a try, leaves status 0 in one of the tries
soon()
{
    what=$1
    shift
    for seconds in $tries; do
        if "$@" "$seconds"; then
            ok
            return
        fi
    done
    bad "$what: $(tail -n 1 stdout) $(cat stderr)"
}

# count NAME: a number of the last report in JSON
count()
{
    sed -n "s/.*\"$1\":\([0-9]*\).*/\1/p" stdout
}

listing()
{
    succeeds 'device list' device list
    check 'device list names sim' grep -q '^sim ' stdout
    check 'device list names replay' grep -q '^replay ' stdout
    check 'device list names openhaptics' grep -q '^openhaptics ' stdout
    refuses 'no such driver' 'nothing' device watch nothing
    refuses 'no such verb' "'look' is none of list, watch" device look sim
    refuses 'nothing else is simulated' 'only serial and can:' device simulate can
    refuses 'an arm is needed' 'arm=FILE' device simulate 'can:vcan0?gear=8,8,8'
    refuses 'an arm is needed' 'arm=FILE' run torus.dpa --device 'can:can0'
}

selftests()
{
    succeeds 'selftest of a sound device' device selftest sim
    check 'without consent nothing is pushed' grep -q 'not tested without may_move, --move' stdout
    check 'what a coupling is computed from is shown' grep -q '^  mass 0.1 kg, damping 0.5 Ns/m$' stdout
    check 'no turn is none' test "$(grep -c 'w, x, y, z' stdout)" -eq 0
    { echo t,x,y,z,rx,ry,rz; echo 0,0,0,0,0,0,3.14159265358979312; } >turned.csv
    run device selftest 'sim:?dofs=6&hand=turned.csv'
    check "no turn with w last: $(cat stdout)" grep -q 'is it sent as x, y, z, w? The order is w, x, y, z' stdout
    succeeds 'selftest with consent' device selftest sim --move
    check 'six pushes' test "$(grep -c 'moves the hand that way' stdout)" -eq 6
    check 'a watchdog is asked' grep -q 'ok   without commands its watchdog ends a force' stdout
    run device selftest 'sim:?fault=estop@0.3'
    check 'selftest of one that stops' test $status -eq 1
    check 'says what fails' grep -q 'FAIL ready all the time' stdout
}

# watched NAME SECONDS: a line a sample, and 20 of them at least
watched()
{
    run device watch "$1" --for "$2"
    [ $status -eq 0 ] && awk -F, 'NR > 1 && $2 == "ready" && NF == 10 { n++ } END { exit n < 20 }' stdout
}

refused_runs()
{
    refuses 'no device' '--device NAME are needed' run box.dpa
    refuses 'a device that is not there' 'nothing' run box.dpa --device nothing
    refuses 'a record without an end' '--record needs --ticks or --for' \
        run box.dpa --device sim --record out/r.csv
    refuses 'a place of two numbers' '--at takes three numbers' \
        run box.dpa --device sim --ticks 5 --at 1,2
    refuses 'too long a record' '--record: at most' \
        run torus.dpa --device 'sim:?live=1' --for 1e6 --record out/r.csv
    refuses 'too many ticks for one' '--record: at most' \
        run torus.dpa --device sim --ticks 100000001 --record out/r.csv
    refuses 'too large a budget' '--budget must be 0 to' run torus.dpa --device sim --ticks 5 --budget 4294967296
    refuses 'a force below none' '--force-max must be 0 to 1000' \
        run torus.dpa --device sim --ticks 5 --force-max -1
    refuses 'settings without a ?' 'only settings, as in sim:?live=1' \
        run torus.dpa --device sim:live=1 --ticks 5
}

# Leaves the trace of a run in pressed.csv.
runs()
{
    succeeds 'run' run torus.dpa --device 'sim:?hand=press' --ticks 4000 --record pressed.csv
    check 'it touches' grep -q '^  in contact on [1-9]' stdout
    succeeds 'run again' run torus.dpa --device 'sim:?hand=press' --ticks 4000 --record again.csv
    check 'the same motion, bit for bit' cmp -s pressed.csv again.csv
    run run torus.dpa --device 'sim:?hand=press' --for 4 --record again.csv
    check 'four seconds of its own time are as many' cmp -s pressed.csv again.csv
    check 'and no one needs a hint' test $status,"$(wc -l <stderr)" = 0,0
    for budget in "3000 sim" "1500 sim:?rate=2000" "200 sim:?rate=50000" "0 sim --budget 0" "7 sim --budget 7"; do
        # shellcheck disable=SC2086
        run run torus.dpa --ticks 5 --json --device ${budget#* }
        check "a budget of $budget" grep -q "\"budget\":${budget%% *}}" stdout
    done
    run run torus.dpa --device 'sim:?hand=press' --ticks 4000 --budget 7 --record undecided.dpr
    check 'what so little leaves undecided is told' grep -q '^  unknown on [1-9][0-9]*, with --budget 7$' stdout
    succeeds 'without a budget' run torus.dpa --device 'sim:?hand=press' --ticks 4000 --budget 0 --record again.csv
    check 'the usual one is not reached' cmp -s pressed.csv again.csv
    succeeds 'what was felt, replayed' replay torus.dpa pressed.csv -o o.csv --radius 0.002 --budget 3000
    in_contact=$(column o.csv 3 | grep -c penetrating)
    run run torus.dpa --device 'sim:?hand=press' --ticks 4000 --json
    check 'as many ticks in contact' grep -q "\"penetrating\":$in_contact," stdout
    run run torus.dpa --device 'sim:?hand=press' --ticks 4000 --force-max 0 --json
    check 'no force is no force' grep -q '"clamped":[1-9]' stdout
}

# A device whose time is not the clock's runs for --for of that, in silence; without an end it says that it does not wait.
hints()
{
    run run box.dpa --device sim --for 0.05 --json
    check "a sim that does not wait: $status, $(cat stderr)" test $status -eq 0 -a ! -s stderr
    check 'it runs for 50 of its periods' grep -q '^{"ticks":50,' stdout
    run run box.dpa --device sim --for 0.05
    check 'no table of times that are none' test "$(grep -c microseconds stdout),$(grep -c "by the device's own time" stdout)" = 0,1
    run run box.dpa --device 'sim:?live=1' --for 0.05
    check 'by the clock there is one' grep -q microseconds stdout
    timeout -s INT 1 "$program" run box.dpa --device sim >stdout 2>stderr
    check 'says so, in a line, and what to do' test "$(grep -c "'sim:?hand=press&live=1'" stderr),$(wc -l <stderr)" = 1,1
    run device identify 'sim:?live=1&loss=0.9' --move
    check "identification on a line that loses samples: $(cat stderr)" test $status -eq 1
    check 'says what helps' grep -q 'more than 4 in a row of .* leave live=1 out' stderr
}

# live_record SECONDS: it has each fresh sample, and some
live_record()
{
    run run torus.dpa --device 'sim:?live=1&hand=press' --for "$1" --record live.csv --json
    [ $status -eq 0 ] && [ "$(count fresh)" -gt 20 ] && [ "$(grep -c '^[0-9]' live.csv)" = "$(count fresh)" ]
}

live_runs()
{
    soon 'watch of a live device' watched 'sim:?live=1&hand=press'
    soon 'a record of a live run, until --for' live_record
    check 'also after no time' timeout 60 "$program" run torus.dpa --device 'sim:?live=1' --for 1e-9 --json >/dev/null
    run run torus.dpa --device 'sim:?live=1&hand=press' --for 0.1 --json
    check 'a live run ends' test $status -eq 0
    mv stdout run.json
    if python3 -c 'import json' 2>python.log; then
        check "run --json: $(tail -n 1 python.log)" has_keys run.json ticks fresh stale missed sent \
            refused late_us.median took_us.p99 real_time locked contacts deepest strongest
    else
        skip 'JSON of a run: no python3'
    fi
}

# What a replay of the run's trace shows, with and without certificates, and within the guard's limits.
replays()
{
    succeeds 'no certificate' replay torus.dpa pressed.csv -o none.csv --radius 0.002 --certificate-bytes 0
    succeeds 'a certificate' replay torus.dpa pressed.csv -o some.csv --radius 0.002
    check 'costs time, never truth' awk -F, 'NR == FNR { d[FNR] = $4; next } d[FNR] != $4 { n++ } END { exit n > 0 }' none.csv some.csv
    "$program" replay torus.dpa pressed.csv -o none.csv --certificate-bytes 0 --json >none.json
    "$program" replay torus.dpa pressed.csv -o some.csv --json >some.json
    less=$(sed 's/.*"bytes":\([0-9]*\).*/\1/' none.json) more=$(sed 's/.*"bytes":\([0-9]*\).*/\1/' some.json)
    check 'a mebibyte less' test $((more - less)) -eq 1048576
    refuses 'too much of it' '--certificate-bytes must be' \
        replay torus.dpa pressed.csv -o out/o.csv --certificate-bytes 9000000000000000

    # With a stiff spring the bare force is far above what a guard lets through: 5 N, 2 N more a tick.
    succeeds 'replay, bare' replay torus.dpa pressed.csv -o o.csv --radius 0.002 --stiffness 50000
    check 'above the limit' awk -F, 'NR > 1 && $17 * $17 + $18 * $18 + $19 * $19 > 50 { n++ } END { exit !n }' o.csv
    succeeds 'replay --limit' replay torus.dpa pressed.csv -o o.csv --radius 0.002 --stiffness 50000 --limit
    check 'within the limits' awk -F, 'NR > 1 {
            n += $17 * $17 + $18 * $18 + $19 * $19 > 1
            if ($17 * $17 + $18 * $18 + $19 * $19 > 25.0001 || ($18 - y) * ($18 - y) > 4.0001) bad = 1
            y = $18
        } END { exit bad || n < 100 }' o.csv
}

# run_over_line SECONDS: fresh samples, and no frame damaged
run_over_line()
{
    run run torus.dpa --device "$name" --for "$1" --json
    [ $status -eq 0 ] && [ "$(count device_damaged)" = 0 ] && [ "$(count fresh)" -gt 20 ]
}

# faults: whether the device says that it is in one
faults()
{
    sleep 0.1 # five times its watchdog
    run device watch "$name" --for 0.1
    grep -q ',fault,' stdout
}

# host_ended_by SIGNAL SECONDS: of a host that runs for so long before; $code is its status. It does not ignore a hang-up,
# though what started the tests may have, as nohup does.
host_ended_by()
{
    $heeding "$program" run torus.dpa --device "$name" --for 60 >killed 2>&1 &
    host=$!
    sleep "$2"
    kill "-$1" $host
    wait $host 2>/dev/null
    code=$?
}

# A host that dies leaves the device in fault, for its watchdog missed the commands. The next one ends that, is told of it,
# and gives force.
killed_host()
{
    host_ended_by KILL "$1"
    faults || return
    run run torus.dpa --device "$name" --for "$1" --json
    [ $status -eq 0 ] && grep -q 'had stopped itself (watchdog)' stderr && [ "$(count not_ready)" = 0 ] &&
        [ "$(count fresh)" -gt 20 ]
}

# A terminal that is closed: the host ends in order, and leaves no fault.
hung_up_host()
{
    host_ended_by HUP "$1"
    [ $code -eq 0 ] && ! faults
}

unread_report()
{
    "$program" run torus.dpa --device "$name" --for "$1" 2>/dev/null | :
    ! faults
}

serial_line()
{
    heeding=
    ! env --default-signal=HUP true 2>/dev/null || heeding='env --default-signal=HUP'
    "$program" device simulate serial --for 300 >simulated 2>/dev/null &
    simulator=$!
    while [ ! -s simulated ] && kill -0 $simulator; do sleep 0.02; done
    name="$(cat simulated)?silent=10"
    soon 'watch over a line' watched "$name"
    soon 'run over a line' run_over_line
    soon 'a host that dies leaves a fault, which the next one ends' killed_host
    soon 'a hang-up ends a host in order, without a fault' hung_up_host
    soon 'a report that no one reads leaves no fault' unread_report
    kill -TERM $simulator && wait $simulator
    check 'the simulated device ends in order' test $? -eq 0
    refuses 'a line that is gone' "${name%?silent*}" device watch "$name"
}

# selftest_passes NAME SECONDS: which takes a second, however much is given
selftest_passes()
{
    run device selftest "$1"
    [ $status -eq 0 ]
}

# touches NAME SECONDS: the stand-in's hand goes down and up again in two seconds
touches()
{
    STAND_IN_SWING=0.03 "$program" run torus.dpa --device "$1" --for "$2" --json >stdout 2>stderr </dev/null
    status=$?
    [ $status -eq 0 ] && [ "$(count contacts)" -gt 0 ] && [ "$(count fresh)" -gt 20 ]
}

# The vendor's library is not needed; a stand-in for it is loaded as it would be.
vendor_library()
{
    refuses 'a library that is not there' 'there is no library' device watch 'openhaptics:?library=/nowhere/libHD.so'
    name="openhaptics:?library=$build/tests/libHD-stand-in.so&silent=5"
    if [ ! -e "$build/tests/libHD-stand-in.so" ]; then
        skip 'openhaptics: make test-programs builds the stand-in'
        return
    fi
    soon 'selftest of the stand-in' selftest_passes "$name"
    soon 'run on the stand-in, which touches' touches "$name"
}

# near FILE KEY VALUE: the value of a key is within 5 % of this
near()
{
    awk -F= -v key="$2" -v value="$3" '$1 == key && $2 > 0.95 * value && $2 < 1.05 * value { n++ } END { exit n != 1 }' "$1"
}

identifications()
{
    arm='sim:?mass=0.045&friction=0.26&step=5.5e-5&force=3.3&delay=1'
    succeeds 'identify' device identify "$arm" --move -o arm.txt
    check 'it says so' grep -q '^  mass  *0.0' stdout
    check 'mass' near arm.txt mass 0.045
    check 'damping' near arm.txt damping 0.5
    check 'friction' near arm.txt friction 0.26
    check 'step' near arm.txt position_step 5.5e-5
    check 'an interval' grep -q '^mass_low=0.04' arm.txt
    check 'which device' grep -q "^# device: sim:?mass=0.045" arm.txt
    cp arm.txt arm1.txt
    succeeds 'again' device identify "$arm" --move -o arm.txt
    check 'the same' cmp arm.txt arm1.txt
    succeeds 'identify --json' device identify "$arm" --move --json
    check 'JSON' has_keys stdout end held rate jitter samples mass mass_low mass_high damping friction delay \
        position_step mass_matrix damping_matrix position force_bound displacement_max
    succeeds 'identify without --move' device identify sim
    check 'nothing is pushed' grep -q -e 'not pushed: --move' stdout
    run device identify 'sim:?hand=hold' --move -o held.txt
    check 'held: exit status 1' test $status -eq 1
    check 'let go' grep -q 'Let go' stderr
    check 'no file' test ! -e held.txt
    run device identify 'sim:?friction=1' --move
    check 'stuck: exit status 1' test $status -eq 1
    check 'it says why' grep -q 'do not move it' stderr
    run device identify 'sim:?live=1&watchdog=0' --move
    check 'no watchdog: exit status 1' test $status -eq 1
    check 'that is why' grep -q 'no watchdog' stderr
    run device identify 'sim:?fault=estop@3' --move
    check 'a fault ends it: exit status 1' test $status -eq 1
    check 'not ready' grep -q 'not ready' stderr
    run device identify sim --move --button 2
    check 'a button that no one holds: exit status 1' test $status -eq 1
    refuses 'no such button' '--button must be' device identify sim --button 32
    refuses 'of identify alone' 'unknown option --button' device watch sim --button 1
    refuses 'an input is no output' 'is an input too' device identify "sim:?hand=arm.txt" -o arm.txt
    succeeds 'run --identified' run torus.dpa --device sim --ticks 100 --identified arm.txt
    echo 'mass=heavy' >wrong.txt
    refuses 'a wrong file' "wrong.txt: line 1: 'heavy' is not a number" \
        run torus.dpa --device sim --ticks 100 --identified wrong.txt
}

# Of a run on a terminal, which `script` makes; and nowhere else.
status_line()
{
    succeeds 'a run without a terminal' run torus.dpa --device 'sim:?live=1&hand=press' --for 1.6
    check "no line there: $(cat stderr)" test "$(grep -c ' at most' stderr)" -eq 0
    if ! command -v script >/dev/null; then
        skip 'the line that follows a run: no script(1)'
        return
    fi
    script -qec "'$program' run torus.dpa --device 'sim:?live=1&hand=press' --for 2.6" typed >/dev/null 2>&1
    check 'it ends' test $? -eq 0
    tr '\r' '\n' <typed >lines
    check "a line follows the run: $(cat lines)" test \
        "$(grep -cE '^ +[0-9.]+ s  (touches|free   ) +[0-9.]+ N  deepest [0-9.]+ mm  late [0-9]+ us at most' lines)" -ge 2
    check 'and is wiped' grep -q '^ *$' lines
}

prepare
status_line
listing
selftests
identifications
refused_runs
runs
hints
live_runs
replays
serial_line
vendor_library
finish
