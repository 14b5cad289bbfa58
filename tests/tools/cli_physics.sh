#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# run --physics: tissue is as stiff as with springs in each tick, a still hand feels no hum, runs and replays give the same
# bits, a thread that is too slow does not delay the loop, and what cannot be stepped apart is refused.
# `sh tests/tools/cli_physics.sh BUILD [part]`.
. "$(dirname "$0")/cli.sh"

# number NAME: of the last report in JSON
number()
{
    sed -n "s/.*\"$1\":\([-+.0-9e]*\).*/\1/p" stdout
}

# is_below A B
is_below()
{
    awk -v a="$1" -v b="$2" 'BEGIN { exit !(a != "" && b != "" && a < b) }'
}

# A hand that comes down by 25 mm in half a second, and rests. 5 mm are above the tissue.
hand()
{
    printf 't,x,y,z\n0,0,0,0\n0.5,0,-0.025,0\n' >hand.csv
}

# stiffness FILE: force by depth, the mean of what follows the 2000th tick
stiffness()
{
    "$program" record csv "$1" -o - | awk -F, '
        NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
        $at["number"] >= 2000 { force += $at["asked_fy"]; depth += -0.005 - $at["y"] }
        END { print force / depth }'
}

# pressed FILE OPTION...: the hand at rest in soft-liver, recorded
pressed()
{
    file=$1
    shift
    succeeds "pressed $*" run soft-liver --device 'sim:?hand=hand.csv' --stiffness 100 --ticks 3000 --json --record "$file" "$@" --law bed
}

felt()
{
    hand
    pressed tick.dpr
    check 'without --physics there is none in the report' test "$(grep -c '"physics"' stdout)" -eq 0
    by_tick=$(stiffness tick.dpr)
    check "it is soft: $by_tick N/m" is_below "$by_tick" 80
    for rate in 1000 500; do
        pressed physics.dpr --physics $rate
        check "$rate Hz in the report: $(cat stdout)" grep -q \
            "\"physics\":{\"rate\":$rate,\"asked\":$rate,\"steps\":$((3 * rate)),\"late\":0,\"thread\":false}" stdout
        apart=$(stiffness physics.dpr)
        check "$rate Hz: $apart N/m for $by_tick" awk -v a="$apart" -v b="$by_tick" \
            'BEGIN { exit !(a > 0.95 * b && a < 1.05 * b) }'
    done
    check 'the delay is counted' grep -q '"delay":0.0025' stdout
    pressed again.dpr --physics 500
    check 'twice the same bytes' cmp -s physics.dpr again.dpr
    check 'others than with springs in each tick' test "$(cmp -s physics.dpr tick.dpr; echo $?)" -eq 1
    succeeds 'replay' replay physics.dpr --json
    check "replayed: $(cat stdout)" grep -q '"ticks":3000,"same":true,"end":"whole"' stdout
    succeeds 'record info' record info physics.dpr
    check 'the rate is in the recording' grep -qx '  physics=500' stdout
    succeeds 'in words' run membrane --device 'sim:?hand=press' --ticks 600 --physics 500
    check "a line: $(cat stdout)" grep -qx "  physics 500 Hz, 300 steps, 0 late, by the device's own time" stdout
}

# hum FILE: of the force under a still hand, after tick 1300, in mN: the largest rms about a line in windows of 51 ticks;
# a two-hundredth of the force or 1 mN; and the force
hum()
{
    "$program" record csv "$1" -o - | awk -F, '
        NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
        $at["number"] < 1300 { next }
        { f[n++] = sqrt($at["asked_fx"] ^ 2 + $at["asked_fy"] ^ 2 + $at["asked_fz"] ^ 2); sum += f[n - 1] }
        n == 51 {
            mean = slope = square = 0
            for (i = 0; i < n; i++) mean += f[i] / n
            for (i = 0; i < n; i++) slope += (i - 25) * f[i] / 11050
            for (i = 0; i < n; i++) square += (f[i] - mean - slope * (i - 25)) ^ 2 / n
            if (sqrt(square) > most) most = sqrt(square)
            count += n; n = 0
        }
        END { limit = 5 * sum / count; print 1000 * most, (limit > 1 ? limit : 1), 1000 * sum / count }'
}

# silent SCENE RATE...: the hand at rest, with the compliance of the springs
silent()
{
    scene=$1
    shift
    for rate; do
        succeeds "$scene at $rate Hz" run "$scene" --device 'sim:?hand=hand.csv' --stiffness 600 --ticks 2000 \
            --physics "$rate" --record hum.dpr
        hum hum.dpr >hum.txt
        check "$scene at $rate Hz: hum, what is allowed, force in mN: $(cat hum.txt)" \
            awk '{ is_silent = $1 <= $2 && $3 > 10 } END { exit !is_silent }' hum.txt
    done
}

# A membrane of 1 kg/m^2 in a frame, by IMPLICIT
sheet()
{
    cat <<'END_OF_SCENE'
{ "bodies": [ { "shape": "membrane", "triangles": 512, "orientation": [0.70710678118654752, -0.70710678118654752, 0, 0],
    "material": { "kind": "sheet", "young": 1e5, "thickness": 1e-3, "density": 1000, "drag": 10, "viscosity": 1e-3,
      "regions": [ { "box": [-0.11, -0.11, -0.01, -0.0999, 0.11, 0.01], "fixed": true },
                   { "box": [0.0999, -0.11, -0.01, 0.11, 0.11, 0.01], "fixed": true },
                   { "box": [-0.11, -0.11, -0.01, 0.11, -0.0999, 0.01], "fixed": true },
                   { "box": [-0.11, 0.0999, -0.01, 0.11, 0.11, 0.01], "fixed": true } ] },
    "physics": { "integrator": "implicit", "load_radius": 0.0375 } } ],
  "tool": { "length": 0.1, "radius": 0.002, "law": "proxy" },
  "device": { "url": "sim:?hand=press", "origin": [0, 0.007, -0.05] } }
END_OF_SCENE
}

# The same cloth as the scene of that name, by IMPLICIT
cloth()
{
    cat <<'END_OF_SCENE'
{ "bodies": [ { "shape": "cloth", "triangles": 2048, "orientation": [0.70710678118654752, -0.70710678118654752, 0, 0],
    "material": { "kind": "sheet", "young": 1e5, "thickness": 1e-3, "density": 400, "drag": 10, "viscosity": 1e-4,
      "regions": [ { "box": [-0.16, -0.16, -0.1, -0.14, -0.14, 0.1], "fixed": true },
                   { "box": [0.14, -0.16, -0.1, 0.16, -0.14, 0.1], "fixed": true },
                   { "box": [-0.16, 0.14, -0.1, -0.14, 0.16, 0.1], "fixed": true },
                   { "box": [0.14, 0.14, -0.1, 0.16, 0.16, 0.1], "fixed": true } ] },
    "physics": { "integrator": "implicit", "sleep_speed": 0.01, "load_radius": 0.02 } } ],
  "gravity": 9.81, "tool": { "length": 0.2, "radius": 0.004, "law": "proxy" },
  "device": { "url": "sim:?hand=press", "origin": [0, -0.02, -0.1] } }
END_OF_SCENE
}

# A liver of 2,692 triangles, by IMPLICIT, beside the rigid ones of the sample; loads are spread in each tick, too
volume()
{
    sed 's/"integrator": "symplectic"/"integrator": "implicit", "load_radius": 0.02/' "$tests/../docs/samples/scene.json"
}

# by INTEGRATOR SCENE: another integrator
by()
{
    sed "s/\"integrator\": \"implicit\"/\"integrator\": \"$1\"/" "$2"
}

# Each body by each integrator, in long steps, whose substeps are as long as those in each tick
integrators()
{
    if "$program" run no.json --device sim 2>&1 | grep -q 'this build reads no scene files'; then return; fi
    sheet >membrane-implicit.json
    cloth >cloth-implicit.json
    volume >volume-implicit.json
    for body in membrane cloth volume; do
        for integrator in symplectic euler; do
            by $integrator $body-implicit.json >$body-$integrator.json
        done
        for integrator in symplectic euler implicit; do
            [ "$is_part" ] || silent $body-$integrator.json 100
            silent $body-$integrator.json 31.25
        done
    done
}

# swing FILE: of the force at 2 Hz in the third second, N
swing()
{
    "$program" record csv "$1" -o - | awk -F, '
        NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
        $at["number"] < 2000 || $at["number"] >= 3000 { next }
        {
            force = sqrt($at["asked_fx"] ^ 2 + $at["asked_fy"] ^ 2 + $at["asked_fz"] ^ 2)
            turn = 0.0125663706143592 * $at["number"]
            sine += force * sin(turn); cosine += force * cos(turn)
        }
        END { print sqrt(sine ^ 2 + cosine ^ 2) / 500 }'
}

# swings SCENE STIFFNESS [RATE]: a hand that goes up and down by 4 mm
swings()
{
    succeeds "$1 at 2 Hz, $2 N/m${3:+, physics of $3 Hz}" run "$1" --device 'sim:?hand=swing.csv' --stiffness "$2" --unstable \
        --active --ticks 3000 ${3:+--physics $3} --record swing.dpr
    swing swing.dpr >swing.txt
}

# feels SCENE STIFFNESS RATE: within 5 % of physics in each tick
feels()
{
    swings "$1" "$2"
    in_tick=$(cat swing.txt)
    swings "$1" "$2" "$3"
    check "$1, $2 N/m: $(cat swing.txt) N at $3 Hz, $in_tick in each tick" awk -v a="$(cat swing.txt)" -v b="$in_tick" \
        'BEGIN { exit !(a > 0.95 * b && a < 1.05 * b && b > 0.01) }'
}

# Also above what the device holds at that rate, as the lag is felt there
moving()
{
    [ -e membrane-implicit.json ] || return
    awk 'BEGIN {
        print "t,x,y,z\n0,0,0,0\n0.5,0,-0.02,0"
        for (t = 1; t < 3.0005; t += 0.004) printf "%g,0,%.8g,0\n", t, -0.02 - 0.004 * sin(12.5663706143592 * (t - 1)) }' \
        >swing.csv
    feels volume-symplectic.json 80 100
    feels membrane-symplectic.json 10 31.25
    [ "$is_part" ] && return
    feels membrane-implicit.json 80 100
    feels membrane-implicit.json 80 500
    feels volume-symplectic.json 10 31.25
}

# What is light goes on by its speed within a step: sheets of springs look ahead.
still()
{
    hand
    silent laparoscopy 1000 500
    silent membrane 1000 500
    [ "$is_part" ] || silent cloth 1000 500
    [ "$is_part" ] || silent soft-liver 1000 100
    if "$program" run no.json --device sim 2>&1 | grep -q 'this build reads no scene files'; then return; fi
    sheet >sheet.json
    silent sheet.json 1000 500
}

# The page of a recording has vertices for as long as they move: more for a hand that goes on than for one that is away.
pages()
{
    [ -x "$(command -v python3)" ] || { skip 'frames with vertices: no python3'; return; }
    printf 't,x,y,z\n0,0,0,0\n0.2,0,-0.01,0\n0.4,0,0.03,0\n' >touch.csv
    succeeds 'a touch' run laparoscopy --device 'sim:?hand=touch.csv' --ticks 8000 --physics 250 --record touch.dpr
    run view touch.dpr -o touch.html
    if grep -q 'this build has no viewer' stderr; then skip 'frames with vertices: no page in this build'; return; fi
    check "view: $(cat stderr)" test $status -eq 0
    python3 - touch.html >moving.txt 2>&1 <<'END_OF_PYTHON'
import base64, re, struct, sys
text = open(sys.argv[1]).read()
data = max(re.findall(r"[A-Za-z0-9+/=]{1000,}", text), key=lambda run: (base64.b64decode(run)[8:12] == b"\1\0\0\0", len(run)))
data, at, frames, moving, last = base64.b64decode(data), 0, 0, 0, 0
while at < len(data):
    size, = struct.unpack_from("<Q", data, at)
    message = data[at + 8:at + 8 + size]
    at += 8 + (size + 7) // 8 * 8
    if struct.unpack_from("<I", message)[0] != 2:
        continue
    sections, = struct.unpack_from("<I", message, 80 + 44)
    counts = {struct.unpack_from("<I", message, 80 + 64 + 24 * s)[0]: struct.unpack_from("<I", message, 80 + 68 + 24 * s)[0] for s in range(sections)}
    frames += 1
    if counts.get(6):
        moving, last = moving + 1, frames
print(frames, moving, last)
END_OF_PYTHON
    read -r frames moving last <moving.txt
    check "frames, with vertices, the last of those: $(cat moving.txt)" test "${moving:-0}" -ge 10 -a "${last:-0}" -lt "${frames:-0}"
}

# By the clock, with a hand. A step of 100,000 nodes in 64 iterations takes far longer than a tick.
threads()
{
    succeeds 'a thread' run laparoscopy --device 'sim:?hand=press&cycle=1&live=1' --for 1 --physics 250 --json
    check "it stepped: $(cat stdout)" is_below 20 "$(number steps)"
    check 'in a thread' grep -q '"asked":250,.*"thread":true' stdout
    check 'each tick felt' grep -q '"failed":0,' stdout
    check 'no step after the end' is_below "$(number steps)" 260
    if ! "$program" run no.json --device sim 2>&1 | grep -q 'this build reads no scene files'; then
        sed -e 's/"integrator": "symplectic"/"integrator": "implicit", "iterations": 64, "sleep_speed": 0/' \
            -e 's/"viscosity": 0.001,/"viscosity": 0.001, "spacing": 0.003,/' "$tests/../docs/samples/scene.json" >slow.json
        succeeds 'a slow thread' run slow.json --device 'sim:?hand=press&cycle=1&live=1' --for 2 --physics 1000 --json
        check "it is late: $(cat stdout)" is_below 100 "$(number late)"
        check "a step takes as long as 10 ticks or more" is_below "$(number rate)" 100
        took=$(sed -n 's/.*"took_us":{"median":\([0-9.]*\),.*/\1/p' stdout)
        check "half of the ticks take less than a tenth of that: $took us" is_below "$took" 1000
        check 'the loop ran meanwhile' is_below 500 "$(number ticks)"
        check 'and felt' grep -q '"failed":0,' stdout
    fi
    succeeds 'a trace of the tool can be had' run laparoscopy --device 'sim:?hand=press&live=1' --for 0.2 --physics 100 \
        --record trace.csv
}

refusals()
{
    live='sim:?hand=press&live=1'
    refuses 'a recording by the clock' 'is not in a recording' run laparoscopy --device "$live" --ticks 9 --physics 250 --record out/x.dpr
    refuses 'nothing soft' 'none of its bodies gives way' run tori --device sim --ticks 9 --physics 500
    refuses 'no part of the rate' 'must divide the 1000 Hz' run membrane --device sim --ticks 9 --physics 300
    refuses 'more than the rate' 'must divide the 1000 Hz' run membrane --device sim --ticks 9 --physics 2000
    refuses 'too slow' '--physics must be 1 to 5000' run membrane --device sim --ticks 9 --physics 0.5
    refuses 'too fast' '--physics must be 1 to 5000' run membrane --device "$live" --ticks 9 --physics 5001
    if ! "$program" run no.json --device sim 2>&1 | grep -q 'this build reads no scene files'; then
        sheet | sed 's/1e5/1e9/; s/"implicit"/"symplectic"/' >stiff.json
        refuses 'too stiff for it' 'and 160 of them are less than 0.01 s' run stiff.json --device sim --ticks 9 --physics 100
        refuses 'as in each tick' 'and 16 of them are less than 0.001 s' run stiff.json --device sim --ticks 9
    fi
    succeeds 'more than the rate by the clock' run membrane --device "$live" --for 0.2 --physics 2000
}

[ "$is_part" ] || felt
still
integrators
moving
pages
threads
refusals
finish
