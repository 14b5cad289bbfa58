#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# How stiff `run` couples a device, what it takes away, zoom, force scale and clutch. `sh tests/tools/cli_coupling.sh BUILD`.
. "$(dirname "$0")/cli.sh"

# number NAME: of the last report in JSON
number()
{
    sed -n "s/.*\"$1\":\([-+.0-9e]*\).*/\1/p" stdout
}

# is_near A B PART
is_near()
{
    awk -v a="$1" -v b="$2" -v p="$3" 'BEGIN { exit !((a - b) ^ 2 <= (p * b) ^ 2) }'
}

# feels ARGUMENT...: a report in JSON
feels()
{
    run run torus.dpa --ticks 3000 --json "$@"
    check "run $*: exit $status, $(cat stderr)" test $status -eq 0
}

# 0.1 kg and 0.5 Ns/m at 1 kHz: 1000 N/m without delay, 334 with 1 ms.
chosen()
{
    feels --device 'sim:?hand=press'
    check "as stiff as it can be: $(cat stdout)" is_near "$(number stiffness)" 667.2 1e-3
    check 'by stability' grep -q '"limit":"stability","stable":1000.8' stdout
    check 'no more is said' test ! -s stderr
    feels --device 'sim:?hand=press' --gain-margin 1
    check "a margin of 1: $(number stiffness)" is_near "$(number stiffness)" 1000.8 1e-3
    feels --device 'sim:?hand=press' --stiffness 300
    check 'what is asked for' grep -q '"stiffness":300,"limit":"asked"' stdout
    feels --device 'sim:?hand=press&delay=1' --stiffness 500
    check "less than is asked for: $(number stiffness)" is_near "$(number stiffness)" 222.5 1e-3
    check "why: $(cat stderr)" grep -q '^dynpoint run: 500 N/m need T/2 + t_d <= 0.667 ms; this device has 1.5\. ' stderr
    feels --device 'sim:?hand=press' --stiffness 1e6
    check "nor can it be as stiff as any number: $(cat stderr)" grep -q '^dynpoint run: 667.2 N/m instead of 1e+06: this device holds no more' stderr
    feels --device 'sim:?hand=press&delay=1' --stiffness 500 --unstable
    check 'all the same' grep -q '"stiffness":500,"limit":"asked"' stdout
    check 'then nothing is said' test ! -s stderr
    feels --device 'sim:?hand=press&dofs=6' --stiffness 900
    check "by rotation: $(cat stderr)" grep -q '"limit":"rotation"' stdout
    check 'that is said' grep -q 'as its rotation is weaker' stderr
    feels --device 'sim:?hand=press&step=0.002' --stiffness 900
    check "by the steps: $(number stiffness)" is_near "$(number stiffness)" 400 1e-6
    check "that is said: $(cat stderr)" grep -q "the device's steps would be felt" stderr
    awk -v header=$header 'BEGIN { print header
        for (i = 0; i < 100; i++) print i ",0,0.01,0,0,0.01,0.1" }' >hand.csv
    run run torus.dpa --device 'replay:hand.csv' --stiffness 500 --ticks 50 --json
    check "not known: $(cat stdout stderr)" grep -q '"stiffness":100,"limit":"unknown"' stdout
    check 'measure it' grep -q 'device identify' stderr
    run run torus.dpa --device 'replay:hand.csv?mass=0.1&damping=0.5&inertia=0.01&spin_damping=10&rate=1000' --stiffness 500 --ticks 50 --json
    check "with settings: $(cat stdout stderr)" grep -q '"stiffness":500,"limit":"asked"' stdout
}

# At the hand the stiffness is the same; the scene's is less by zoom and force scale. Force is the coupling's at the hand.
scaled()
{
    feels --device 'sim:?hand=press' --zoom 2 --force-scale 3
    check "zoom and force scale: $(number stiffness)" is_near "$(number stiffness)" "$(awk 'BEGIN { print 667.2 / 6 }')" 1e-3
    f=$(number strongest) d=$(number deepest) k=$(number stiffness)
    check "the hand's force is $f N" is_near "$f" "$(awk "BEGIN { printf \"%.17g\", 3 * $k * $d }")" 1e-9
    refuses 'no force at all' '--force-scale must be 0.001 to 1000' run torus.dpa --device sim --force-scale 0
    refuses 'a margin below 1' '--gain-margin must be 1 to 100' run torus.dpa --device sim --gain-margin 0.5
    refuses 'unstable without a stiffness' '--unstable needs --stiffness' run torus.dpa --device sim --unstable
    refuses 'a button that is none' '--clutch must be 0 to 31' run torus.dpa --device sim --clutch 32
}

# Beyond the limit the loop shakes, and with the controller it does not.
passive()
{
    feels --device 'sim:?hand=press&delay=1' --stiffness 150
    check 'idle where it is stable' grep -q '"passivity":{"acted":0,"taken":0' stdout
    feels --device 'sim:?hand=press&delay=1' --stiffness 800 --unstable --active
    check 'without the controller' test -z "$(number acted)"
    loud=$(number strongest)
    feels --device 'sim:?hand=press&delay=1' --stiffness 800 --unstable
    check "it acts: $(cat stdout)" test "$(number acted)" -gt 100
    check 'the account is bounded' awk -v a="$(number account_min)" -v e="$(number eps)" 'BEGIN { exit !(a >= -2 * e && e > 0) }'
    check "$(number strongest) N, $loud without it" awk -v a="$(number strongest)" -v b="$loud" 'BEGIN { exit !(a < 0.8 * b) }'
    run run torus.dpa --device 'sim:?hand=press&delay=1' --ticks 3000 --stiffness 800 --unstable --record shaken.dpr
    run replay shaken.dpr
    check "a recording of it: $(cat stdout stderr)" grep -qx 'shaken.dpr: 3000 ticks, all the same bits' stdout
}

# Down 2 cm to the torus, then up with the clutch and down again: the tool goes on from where it stood.
clutched()
{
    awk 'BEGIN { print "t,x,y,z,buttons"
        for (i = 0; i <= 60; i++) {
            t = 0.05 * i
            y = t < 1 ? -0.012 * t : t < 2 ? -0.012 + 0.05 * (t - 1) : 0.038 - 0.004 * (t - 2)
            print t ",0," y ",0," (t >= 1 && t < 2 ? 4 : 0)
        } }' >clutch.csv
    feels --device 'sim:?hand=clutch.csv' --clutch 2 --record clutch.dpr
    check "1 s of the clutch: $(number clutched)" test "$(number clutched)" -eq 1000
    check 'the force ends, and comes back' grep -q '"stops":1,' stdout
    "$program" record csv clutch.dpr -o clutch.out.csv
    check 'the proxy stands still meanwhile, and goes on from there' awk -F, '
        NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
        { n++; y = $at["proxy_y"]; f = $at["sent_fy"] }
        n == 1000 { before = y }
        n > 1010 && n <= 2000 { wrong += f != 0 }
        n == 2001 { wrong += (y - before) ^ 2 > 1e-8 }
        n > 2500 { felt += f > 0.3 }
        END { exit wrong || felt < 400 }' clutch.out.csv
    run replay clutch.dpr
    check "a recording of it: $(cat stdout stderr)" grep -qx 'clutch.dpr: 3000 ticks, all the same bits' stdout
}

prepare
chosen
scaled
passive
clutched
finish
