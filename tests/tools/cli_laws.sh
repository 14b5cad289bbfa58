#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The laws of force from outside: replay --law, run --law, force-test. `sh tests/tools/cli_laws.sh BUILD [part]`.
. "$(dirname "$0")/cli.sh"

# A line pushed flat through the box from its face at x = 0.06 to x = -0.05: the point's push turns on the way out of the
# middle, the proxy stays on the face.
laws()
{
    awk -v header=$header 'BEGIN { print header
        for (i = 0; i <= 240; i++) { x = 0.07 - 0.0005 * i; print i "," x ",-0.02,0," x ",0.02,0" } }' >through.csv
    succeeds '--law point' replay box.dpa through.csv -o point.out --radius 0.002 --law point
    check 'the point pushes on, behind the middle' awk -F, 'END { exit !($17 < -4 && NF == 30 && $23 $24 $30 == "") }' \
        point.out
    succeeds '--law proxy' replay box.dpa through.csv -o proxy.out --radius 0.002 --law proxy
    succeeds 'without --law' replay box.dpa through.csv -o usual.out --radius 0.002
    check 'the usual law is the proxy' cmp -s proxy.out usual.out
    awk -v header=$header 'BEGIN { print header
        for (i = 0; i < 20; i++) print i "," 0.001 * i ",-0.02,0," 0.001 * i ",0.02,0" }' >within.csv
    succeeds 'a tool that begins inside' replay box.dpa within.csv -o within.out --radius 0.002
    check 'it is said that it began inside' grep -q 'no force on 20 ticks: the tool began inside' stderr stdout
    succeeds '--law bed' replay box.dpa through.csv -o bed.out --radius 0.002 --law bed
    check '--law bed: an energy, no proxy' awk -F, '$23 > 1e-4 { felt++ } NR > 1 { other += NF != 30 || $24 $30 != "" }
        END { exit !(felt > 100 && !other) }' bed.out
    check '--law proxy: header' test "$(head -n 1 proxy.out)" = "$out_header"
    check '--law proxy: the spring' awk -F, 'NR > 1 { x = 0.07 - 0.0005 * $1; wrong += NF != 30
        if (x > 0.0621) wrong += $17 != 0 || $23 != 0 || ($24 - x) ^ 2 > 1e-24
        if (x < 0.0619) { felt++; wrong += ($17 / (500 * (0.062 - x)) - 1) ^ 2 > 1e-4 || ($24 - 0.062) ^ 2 > 1e-10 ||
            ($23 / (250 * (0.062 - x) ^ 2) - 1) ^ 2 > 1e-3 || $3 != "penetrating" || $5 $6 != "" } }
        END { exit wrong || felt < 200 }' proxy.out
    succeeds '--law proxy again' replay box.dpa through.csv -o again.out --radius 0.002 --law proxy --repeat 2
    check '--law proxy: other bytes' cmp -s proxy.out again.out
    # Led along the face it would slide; friction holds it at the cone, and a damper changes what is felt.
    awk -v header=$header 'BEGIN { print header
        for (i = 0; i <= 240; i++) { x = i < 40 ? 0.07 - 0.00025 * i : 0.06; y = i < 40 ? 0 : 0.00005 * (i - 40)
            print i "," x "," (y - 0.02) ",0," x "," (y + 0.02) ",0" } }' >drawn.csv
    succeeds '--friction' replay box.dpa drawn.csv -o friction.out --radius 0.002 --friction 0.3
    check '--friction: it slips at the cone' awk -F, 'NR == 240 { exit !(($18 / $17 + 0.3) ^ 2 < 1e-5 && $17 > 0.9) }' \
        friction.out
    succeeds '--damping' replay box.dpa drawn.csv -o damped.out --radius 0.002 --damping 2
    check '--damping: B v is added while it is pressed in, and goes with the motion' awk -F, '
        NR == FNR { force[$1] = $17; next } $1 == 38 { pressed = $17 - force[38] } $1 == 100 { still = $17 - force[100] }
        END { exit !((pressed - 0.5) ^ 2 < 1e-6 && still ^ 2 < 1e-12) }' friction.out damped.out
    succeeds '--law proxy, scalar' replay box.dpa through.csv -o again.out --radius 0.002 --law proxy --kernel scalar
    check '--law proxy: other bytes with another kernel' cmp -s proxy.out again.out
    succeeds '--law proxy --until contact' replay box.dpa through.csv -o again.out --law proxy --until contact
    check 'no force, nothing in its columns' awk -F, 'NR > 1 && ($17 $23 $24 != "" || NF != 30) { exit 1 }' again.out
}

# json KEY: its number on stdout
json()
{
    sed -n "s/^.*[{,]\"$1\":\([^,}]*\).*$/\1/p" stdout
}

trials()
{
    succeeds 'force-test' force-test box.dpa --law proxy --places 4 --paths 4
    check 'force-test: nothing is broken' test "$(grep -c '^  ok ' stdout),$(grep -c BROKEN stdout)" = 10,0
    run force-test box.dpa --places 4 --paths 4 --law point --through 0.05 --json
    check "force-test --law point: exit $status" test $status,"$(wc -l <stderr)" = 1,0
    check 'force-test: the point turns' grep -q '^{"law":"point",.*"turns":[1-9].*"broken":1}$' stdout
    check 'force-test: the point turns in the middle' test "$(json through_turns)" -gt 10
    check 'force-test: the point pushes who began inside' test "$(json felt_inside)" -gt 100
    check 'force-test: the point is in time' awk "BEGIN { exit !($(json delay) < 0.1) }"
    succeeds 'force-test --json' force-test box.dpa --law proxy --places 4 --paths 4 --json
    for key in law ticks turns through_turns jumps delay fold_pushes folds lagging penetrations felt_inside emitted emitting \
        through_ticks through_folds delay_places largest_jump least_gap inside_places paths lost broken; do
        check "force-test --json: $key" grep -q "[{,]\"$key\":" stdout
    done
    check 'force-test: through, inside, in time' awk "BEGIN { exit !($(json through_ticks) > 1500 &&
        $(json inside_places) == 8 && $(json delay_places) == 4 && $(json delay) < 0.1) }"
    sed 's/"us":{[^}]*},//' stdout >first.json
    succeeds 'force-test again' force-test box.dpa --law proxy --places 4 --paths 4 --json
    sed 's/"us":{[^}]*},//' stdout >again.json
    check 'force-test: other figures' cmp -s first.json again.json
    succeeds 'force-test --contacts' force-test box.dpa --law proxy --places 4 --paths 4 --json --contacts 0
    sed 's/"us":{[^}]*},//' stdout >again.json
    check 'force-test --contacts 0: the force is another' cmp -s first.json again.json
    run force-test box.dpa --places 4 --paths 4 --json --friction 0.4
    check 'force-test --friction: it is lost on closed paths' awk -F'"lost":' '{ exit !($2 + 0 > 0.01) }' stdout
    check 'force-test --friction: nothing is penetrated' grep -q '"penetrations":0,' stdout
    run force-test box.dpa --law proxy --places 4 --paths 4 --through 0.002 --json
    check 'force-test --through: shorter' test "$(json through_ticks)" -lt 2000
}

# Folds are the mesh's: where they are many nothing is broken for that, and how many there are is told. Two organs of
# DPT_DATA and a mesh that is always there; at 0.5 % of the ticks this was BROKEN.
folding()
{
    cp torus.dpa folds-torus.dpa
    for organ in gallbladder_low:mm openhelp_kidney_left:mm; do
        file=${DPT_DATA:-none}/meshes/organs/${organ%%:*}.stl
        [ ! -f "$file" ] || succeeds "compile $organ" compile "$file" --unit "${organ#*:}" -o "folds-${organ%%:*}.dpa"
    done
    for mesh in folds-*.dpa; do
        succeeds "force-test $mesh" force-test "$mesh" --places 8 --paths 4 --depth 0.008 --json
        check "force-test $mesh: folds $(json folds), pushes $(json fold_pushes)" awk "BEGIN {
            exit !($(json folds) > 0.005 && $(json fold_pushes) == 0 && $(json broken) == 0) }"
    done
    succeeds 'force-test, a table' force-test folds-torus.dpa --places 8 --paths 4 --depth 0.008
    check 'force-test: how many ticks fold, without a limit' test \
        "$(grep -c '^  ticks with a fold [0-9.]* %, held through the mesh [0-9.]* %$' stdout)" = 1
}

# A low-pass holds a slow force back by its time, a faster one by less.
late()
{
    for pair in torus:0.005:4:5:1 box:0.005:4:5:1 box:0.02:9:14:1 box:0.001:0.3:0.6:0; do
        mesh=${pair%%:*} rest=${pair#*:}
        low_pass=${rest%%:*} rest=${rest#*:}
        least=${rest%%:*} rest=${rest#*:}
        run force-test $mesh.dpa --law proxy --places 4 --paths 1 --low-pass "$low_pass" --json
        delay=$(json delay)
        check "force-test --low-pass $low_pass, $mesh: exit $status, delay $delay" awk "BEGIN {
            exit !($delay > $least && $delay < ${rest%%:*} && $status >= ${rest#*:}) }"
    done
    run force-test torus.dpa --law bed --places 4 --paths 1 --low-pass 0.005
    check 'force-test --low-pass: delay is BROKEN' grep -q '^  BROKEN ticks that the force is behind' stdout
}

refusals()
{
    refuses 'replay --law proxy with paper' '--law proxy' replay box.dpa box.csv -o out/x --law proxy --method paper
    for option in friction:-1 friction:11 friction:nan damping:-1 damping:inf stiffness:-1; do
        refuses "replay --$option" "--${option%%:*}" replay box.dpa box.csv -o out/x --"${option%%:*}" "${option#*:}"
        refuses "run --$option" "--${option%%:*}" run box.dpa --device sim --ticks 5 --"${option%%:*}" "${option#*:}"
    done
    refuses 'friction of a point' '--friction and --damping' replay box.dpa box.csv -o out/x --law point --friction 0.1
    refuses 'run --law' "is none of point, bed, proxy" run box.dpa --device sim --ticks 5 --law soft
    refuses 'force-test alone' 'dynpoint force-test: ' force-test
    refuses 'force-test: unknown option' --frob force-test --frob
    refuses 'force-test: no such file' none.dpa force-test none.dpa
    for pair in law:soft friction:-1 friction:11 length:0 length:11 radius:-1 radius:nan stiffness:0 stiffness:hard depth:0 depth:2 speed:0 \
        speed:inf through:0 through:2 low-pass:-1 low-pass:nan low-pass:2 places:0 places:100001 \
        places:-1 paths:0 paths:many seed:-1 contacts:65536 contacts:-1; do
        refuses "force-test --$pair" "--${pair%%:*}" force-test box.dpa --"${pair%%:*}" "${pair#*:}"
    done
}

pressed()
{
    run run torus.dpa --device 'sim:?hand=press' --ticks 4000 --law proxy --stiffness 500 --json
    cp stdout proxy.json
    run run torus.dpa --device 'sim:?hand=press' --ticks 4000 --stiffness 500 --json
    check 'the usual law of run is the proxy' cmp -s proxy.json stdout
    check 'run --law proxy: a spring' awk -F'[:,]' '{ for (i = 1; i < NF; i++) said[$i] = $(i + 1)
        d = said["\"deepest\""]; f = said["\"strongest\""]
        exit !(d > 1e-3 && f > 0.5 && (f / d / 500 - 1) ^ 2 < 1e-9) }' stdout
}

prepare
laws
[ "$is_part" ] || trials
[ "$is_part" ] || folding
late
refusals
pressed
finish
