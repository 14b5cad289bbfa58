#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Tips of tools: in scene files, by run --tip, in recordings; and the tools of docs/recipes.md.
# `sh tests/tools/cli_tips.sh BUILD [part]`.
. "$(dirname "$0")/cli.sh"

docs=$tests/../docs
arm=$tests/golden/arm_1_mesh_4.dpa
press='sim:?hand=press'
still='sim:?hand=hold'

# felt NAME ARGUMENT...: a run, recorded; all records as text in NAME.csv. It replays with the same bits.
felt()
{
    name=$1
    shift
    rm -f "$name.dpr" "$name.csv"
    succeeds "$name: run $*" run "$@" --ticks 1100 --record "$name.dpr" --json
    cp stdout "$name.says"
    check "$name is touched: $(cat stdout)" grep -q '"contacts":[1-9][0-9]' "$name.says"
    check "$name: all ticks are felt: $(cat stdout)" grep -q '"failed":0,' "$name.says"
    check "$name: nothing is unknown: $(cat stdout)" grep -q '"unknown":0,' "$name.says"
    succeeds "$name: record csv" record csv "$name.dpr" -o "$name.csv"
    replays "$name"
}

# replays NAME [ARGUMENT...]
replays()
{
    replayed=$1
    shift
    run replay "$replayed.dpr" "$@"
    check "$replayed: other bits: exit $status, $(cat stdout stderr)" grep -q 'ticks, all the same bits$' stdout
}

is_same()
{
    check "$1 and $2: the same bits" cmp -s "$1.csv" "$2.csv"
}
differs()
{
    if cmp -s "$1.csv" "$2.csv"; then bad "$1 and $2: the same bits"; else ok; fi
}

# tips_of NAME: the lines of a recording's tips
tips_of()
{
    run record info "$1.dpr"
    sed -n 's/^ *tip=//p' stdout
}

# first_gap ARGUMENT...: of the first tick, over the box, with a hand that rests
first_gap()
{
    run "$@" --device "$still" --ticks 2 --record gap.dpr
    run record csv gap.dpr -o gap.csv
    awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == "gap") n = i } NR == 2 { print $n }' gap.csv
}

# is_gap WHAT WANTED ARGUMENT...
is_gap()
{
    what=$1 wanted=$2
    shift 2
    gap=$(first_gap "$@")
    check "$what: a gap of $gap, not $wanted" \
        awk -v a="$gap" -v b="$wanted" 'BEGIN { exit !(a != "" && (a - b) ^ 2 < 1e-16) }'
}

# The box's top is at y = 0.05. The tool's origin is where it is told to be.
places()
{
    at='--at 0,0.1,0'
    # shellcheck disable=SC2086
    for row in 'box:0.02,0.04,0.03 0.03' 'box:0.02,0.04,0.03,0.005 0.025' 'wedge:0.02,0.04,0.03 0.03' \
        'cylinder:0.04,0.04,0.03 0.03' 'cylinder:0.04,0,0.03,0.001 0.029' 'box:0.04,0,0.04,0.001 0.048'; do
        is_gap "--tip ${row% *}" "${row#* }" run box.dpa $at --tip "${row% *}"
    done
    is_gap 'the lowest of two' 0.02 run box.dpa $at --tip box:0.01,0.02,0.01 --tip box:0.01,0.06,0.01
    is_gap 'the stylus is there too' 0.048 run box.dpa $at --tip box:0.01,0.001,0.01
    is_gap 'and has its radius' 0.04 run box.dpa $at --tip box:0.01,0.001,0.01 --radius 0.01

    # z upwards; then the edge and the point are below.
    up='"orientation": [0.70710678118654752, -0.70710678118654752, 0, 0]'
    for tip in '"box", "extent": [0.02, 0.01, 0.04]' '"wedge", "extent": [0.02, 0.01, 0.04]' \
        '"cylinder", "extent": [0.02, 0.02, 0.04]' '"cone", "extent": [0.02, 0.02, 0.04]'; do
        echo "{ \"bodies\": [ { \"shape\": \"box\" } ], \"tool\": { \"tips\": [ { \"shape\": $tip, $up } ] } }" >up.json
        is_gap "$tip, upright" 0.03 run up.json $at
    done
    echo "{ \"bodies\": [ { \"shape\": \"box\" } ], \"tool\": { \"length\": 0, \"radius\": 0,
        \"tips\": [ { \"shape\": \"cone\", \"extent\": [0.02, 0, 0.02], \"radius\": 0.002, \"at\": [0.005, 0.03, 0], $up } ] } }" >up.json
    is_gap 'the rest of it is higher: the segment of no length' 0.05 run up.json $at
    sed 's/0.03, 0\], "or/-0.03, 0], "or/' up.json >down.json
    is_gap 'a place below' 0.008 run down.json $at
    is_gap 'an origin that was not given is 5 mm above what is lowest' 0.005 run down.json
    is_gap 'the same of --tip' 0.005 run box.dpa --tip box:0.02,0.04,0.03,0.003
}

# with NAME MEMBERS: a scene of a box, with this tool
with()
{
    echo "{ \"bodies\": [ { \"shape\": \"box\" } ], \"tool\": { $2 } }" >"$1.json"
}

same_by_file_and_option()
{
    wedge='"shape": "wedge", "extent": [0.03, 0.02, 0.02]'
    with none '"length": 0.1'
    with file "\"tips\": [ { $wedge } ]"
    with full "\"length\": 0.1, \"radius\": 0.002, \"law\": \"proxy\", \"tips\": [ { $wedge, \"radius\": 0, \"at\": [0, 0, 0],
        \"orientation\": [1, 0, 0, 0] } ]"
    felt none none.json --device "$press"
    felt file file.json --device "$press"
    felt full full.json --device "$press"
    felt option none.json --device "$press" --tip wedge:0.03,0.02,0.02
    felt mesh box.dpa --device "$press" --tip wedge:0.03,0.02,0.02
    is_same full file
    is_same option file
    is_same mesh file
    differs file none
    felt override file.json --device "$press" --tip box:0.03,0.02,0.02,0.004
    felt other none.json --device "$press" --tip box:0.03,0.02,0.02,0.004
    is_same override other
    differs override file
    check "the tip in the recording: $(tips_of mesh)" test "$(tips_of mesh)" = \
        'wedge,0.029999999999999999,0.02,0.02,0,0,0,0,0,1,0,0,0'
    check "no tip: $(tips_of none)" test -z "$(tips_of none)"
    felt wiped box.dpa --device 'sim:?hand=wipe&cycle=0.5' --friction 0.4 --tip box:0.03,0.02,0.02,0.002
    felt free box.dpa --device 'sim:?hand=press&dofs=6' --tip cone:0.01,0,0.04 --tip box:0.02,0.005,0.001
    felt embedded box.dpa --device "$press" --tip wedge:0.03,0.02,0.02 --embed
    is_same embedded mesh
    felt clutched box.dpa --device "$press" --tip wedge:0.03,0.02,0.02 --clutch 0 --zoom 2

    round='"shape": "cylinder", "extent": [0.02, 0, 0.03]'
    with round "\"tips\": [ { $round } ]"
    with sixteen "\"tips\": [ { $round, \"sides\": 16 } ]"
    with five "\"tips\": [ { $round, \"sides\": 5 } ]"
    felt round round.json --device "$press"
    felt sixteen sixteen.json --device "$press"
    felt five five.json --device "$press"
    is_same sixteen round
    differs five round
}

# An arm's tool takes the place of the file's, tips too; --tip is beside it.
arms()
{
    felt arm none.json --device "$press" --tool "$arm"
    felt arm_for_tips file.json --device "$press" --tool "$arm"
    is_same arm_for_tips arm
    check "no tip: $(tips_of arm_for_tips)" test -z "$(tips_of arm_for_tips)"
    felt arm_with_tip none.json --device "$press" --tool "$arm" --tip box:0.1,0.1,0.1
    differs arm_with_tip arm
    cp "$arm" arm.dpa
    with arm_file '"arm": "arm.dpa", "tips": [ { "shape": "box", "extent": [0.1, 0.1, 0.1] } ]'
    felt arm_file arm_file.json --device "$press"
    is_same arm_file arm_with_tip
}

# A gripper: a palm, and below it two jaws that one joint turns about z, the other one by a mimic.
grippers()
{
    cat >grip.urdf <<'END_OF_URDF'
<robot name="grip">
  <link name="base"/><link name="wrist"/>
  <link name="palm"><collision><geometry><box size="0.02 0.04 0.03"/></geometry></collision></link>
  <link name="left"><collision><origin xyz="0 -0.02 0"/><geometry><box size="0.01 0.04 0.01"/></geometry></collision></link>
  <link name="right"><collision><origin xyz="0 -0.02 0"/><geometry><box size="0.01 0.04 0.01"/></geometry></collision></link>
  <joint name="turn" type="revolute"><parent link="base"/><child link="wrist"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
  <joint name="hold" type="fixed"><parent link="wrist"/><child link="palm"/></joint>
  <joint name="squeeze" type="revolute"><parent link="palm"/><child link="left"/><origin xyz="0.005 -0.02 0"/>
    <axis xyz="0 0 1"/><limit lower="0" upper="1" effort="1" velocity="1"/></joint>
  <joint name="follow" type="revolute"><parent link="palm"/><child link="right"/><origin xyz="-0.005 -0.02 0"/>
    <axis xyz="0 0 1"/><mimic joint="squeeze" multiplier="-1"/><limit lower="-1" upper="0" effort="1" velocity="1"/></joint>
</robot>
END_OF_URDF
    succeeds 'compile a gripper' compile grip.urdf -o grip.dpa --tool palm
    if grep -q 'reads no URDF' stderr; then
        skip 'grippers: no urdfdom'
        return
    fi
    check "its tips and jaws: $(cat stdout)" grep -q 'tool palm of 0 capsules and 3 tips with 1 jaw,' stdout
    at='--at 0,0.15,0'
    for share in 0 0.25 0.5 1; do
        lowest=$(awk -v q=$share 'BEGIN { printf "%.17g", 0.08 - 0.04 * cos(q) - 0.005 * sin(q) }')
        # shellcheck disable=SC2086
        is_gap "--jaw $share" "$lowest" run box.dpa $at --tool grip.dpa --jaw $share
    done
    # shellcheck disable=SC2086
    is_gap 'jaws at 0' 0.04 run box.dpa $at --tool grip.dpa
    # shellcheck disable=SC2086
    is_gap 'a tip beside them' 0.03 run box.dpa $at --tool grip.dpa --tip box:0.01,0.14,0.01
    is_gap 'an origin that was not given' 0.005 run box.dpa --tool grip.dpa
    with grip '"arm": "grip.dpa", "jaw": { "to": 0.5 }'
    # shellcheck disable=SC2086
    is_gap "a file's jaw" "$(awk 'BEGIN { printf "%.17g", 0.08 - 0.04 * cos(0.5) - 0.005 * sin(0.5) }')" run grip.json $at
    # shellcheck disable=SC2086
    is_gap '--jaw replaces it' 0.04 run grip.json $at --jaw 0

    # From wide open, the hand at rest: the jaws turn down on to the box and stop there. Nothing is felt.
    with closing '"arm": "grip.dpa", "jaw": { "from": 1, "to": 0, "seconds": 0.4 }'
    for run in 'file closing.json' 'option box.dpa --tool grip.dpa --jaw 1:0:0.4'; do
        succeeds "jaws close: $run" run ${run#* } --device "$still" --at 0,0.1,0 --ticks 600 --record "close_${run%% *}.dpr"
        run record csv "close_${run%% *}.dpr" -o "close_${run%% *}.csv"
        replays "close_${run%% *}"
    done
    is_same close_file close_option
    awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
        { gap = $at["gap"]; through += gap < 0; felt += $at["asked_fx"] ^ 2 + $at["asked_fy"] ^ 2 > 0; if (NR == 2) first = gap }
        END { print NR - 1, through + 0, felt + 0, first, gap }' close_file.csv >closed
    check "jaws that close on the box: $(cat closed)" awk '{ exit !($1 == 600 && !$2 && !$3 && $4 > 0.001 && $5 > 0 && $5 < 2e-6) }' closed
    # In the open they go on.
    succeeds 'jaws close in the open' run box.dpa --tool grip.dpa --jaw 1:0:0.4 --device "$still" --at 0,0.15,0 --ticks 600 --record open.dpr
    run record csv open.dpr -o open.csv
    check "they arrive: $(tail -1 open.csv | cut -c1-40)" awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == "gap") n = i }
        NR == 601 { exit !(($n - 0.04) ^ 2 < 1e-16) }' open.csv
    # By a button: closed a while after it went down, and open again after it went up.
    { echo 't,x,y,z,buttons'; echo '0,0,0,0,0'; echo '0.1,0,0,0,4'; echo '0.35,0,0,0,0'; echo '1,0,0,0,0'; } >button.csv
    for run in 'by_option --tool grip.dpa --jaw 1:0:0.2:2 box.dpa' 'by_file by_button.json'; do
        with by_button '"arm": "grip.dpa", "jaw": { "from": 1, "to": 0, "seconds": 0.2, "button": 2 }'
        succeeds "a button: $run" run ${run#* } --device 'sim:?hand=button.csv' --at 0,0.15,0 --ticks 700 --record "${run%% *}.dpr"
        run record csv "${run%% *}.dpr" -o "${run%% *}.csv"
        replays "${run%% *}"
    done
    is_same by_option by_file
    awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == "gap") n = i; next }
        NR % 100 == 52 { print $n }' by_file.csv >opening
    # It is down from 0.1 to 0.35 s; they take 0.2 s there, and as long back.
    check "jaws by a button: $(cat opening | tr '\n' ' ')" awk 'BEGIN { split("1 0.75 0.25 0 0.5 1 1", share, " ") }
        { q = share[NR]; off = $1 - (0.08 - 0.04 * cos(q) - 0.005 * sin(q)); wrong += off ^ 2 > (3e-4) ^ 2 }
        END { exit !(NR == 7 && !wrong) }' opening
    # A hand that presses feels the jaw that stands on the box.
    felt pressed_jaw box.dpa --tool grip.dpa --jaw 0.2 --device "$press"
    felt closed_jaw box.dpa --tool grip.dpa --jaw 0.1 --device "$press"
    differs pressed_jaw closed_jaw
    if python3 -c 'import zlib' 2>python.log; then
        forge close_file forged 'jaw=[^\n]*\n' ''
        run replay forged.dpr
        check "without its jaws it differs: exit $status" test $status -eq 1
        for bad in '' 1 1: 1:0 1:0:x 2:0:1 0:-1:1 0:1:-1 0:1:1:32 0:1:1:0.5 0:1:0:1 0:1:1:1:1 nan:0:1; do
            [ "$bad" = 1 ] && continue
            forge close_file forged 'jaw=[^\n]*\n' "jaw=$bad\n"
            refuses "a line jaw=$bad" "of its header: 'jaw=" replay forged.dpr
        done
    fi
    for bad in '' x 1: 0:1 0:1: 0:1:1:1:1 1,1 0:1:1x; do
        refuses "--jaw '$bad'" "dynpoint run: --jaw takes SHARE or FROM:TO:SECONDS[:BUTTON]; it is '$bad'" \
            run box.dpa --tool grip.dpa --device sim --ticks 5 --jaw "$bad"
    done
    refuses 'a share above 1' '--jaw 0:1.5:1: its shares must be 0 to 1' run box.dpa --tool grip.dpa --device sim --ticks 5 --jaw 0:1.5:1
    refuses 'a time below 0' '--jaw 0:1:-1: its time must be 0 to 1e6 s' run box.dpa --tool grip.dpa --device sim --ticks 5 --jaw 0:1:-1
    refuses 'no such button' '--jaw 0:1:1:32: its button must be 0 to 31' run box.dpa --tool grip.dpa --device sim --ticks 5 --jaw 0:1:1:32
    refuses 'a button at once' '--jaw 0:1:0:1: with a button its time must be above 0' \
        run box.dpa --tool grip.dpa --device sim --ticks 5 --jaw 0:1:0:1
    with at_once '"arm": "grip.dpa", "jaw": { "to": 1, "button": 1 }'
    refuses "a file's button at once" 'tool.jaw: needs seconds above 0 with a button' run at_once.json --device sim --ticks 5
    refuses 'no jaws' 'its tool has no jaws to move (--jaw)' run box.dpa --device sim --ticks 5 --jaw 1
    with stylus_jaw '"length": 0.1, "jaw": { "to": 1 }'
    refuses 'a stylus with jaws' 'tool.jaw: is for the tool of an arm' run stylus_jaw.json --device sim --ticks 5
    with jaw_to '"arm": "grip.dpa", "jaw": { "from": 1 }'
    refuses 'no end' 'tool.jaw: needs to' run jaw_to.json --device sim --ticks 5
    refuses 'tips alone with another law' 'its tool has no capsule, and no tip that is felt' \
        run box.dpa --tool grip.dpa --device sim --ticks 5 --law bed
}

# A device with torque is coupled as weakly as the tool is long, whether a segment or a tip is.
coupled()
{
    with bar '"segments": [ { "a": [0, 0, 0], "b": [0, 0, 0.1], "radius": 0.002 },
                            { "a": [-0.15, 0, 0], "b": [0.15, 0, 0], "radius": 0.001 } ]'
    for tool in 'bar.json' 'box.dpa' 'box.dpa --tip box:0.3,0.0002,0.0002'; do
        # shellcheck disable=SC2086
        run run $tool --device 'sim:?dofs=6&hand=press' --ticks 5 --json
        sed -n 's/.*"stiffness":\([0-9.]*\).*/\1/p' stdout
    done >stiffness
    check "as stiff as with a segment, not as without: $(cat stiffness)" awk '{ k[NR] = $1 }
        END { exit !(k[1] > 0 && (k[3] / k[1] - 1) ^ 2 < 1e-6 && k[2] > 1.1 * k[1]) }' stiffness
}

# What docs ship.
samples()
{
    felt scalpel "$docs/samples/scalpel.json"
    sed 's/"tips": \[/"tip": [/' "$docs/samples/scalpel.json" >misspelt.json
    refuses 'a misspelt key' "misspelt.json: tool: there is no key 'tip'" run misspelt.json --ticks 5
    check "tissue gives way to a tip: $(cat scalpel.says)" grep -q '"spring_nodes_awake":[1-9]' scalpel.says
    run run "$docs/samples/scalpel.json" --ticks 2000
    check "the sample: $(cat stdout stderr)" grep -q '^  in contact on 1[0-9][0-9][0-9], deepest 1\.[0-9]* mm' stdout
    sed -n '/^## Tools with tips$/,$p' "$docs/recipes.md" | sed '2,${/^## /,$d;}' >tools.md
    awk '/^```json$/ { n++; f = "recipe" n ".part"; next } /^```sh$/ { f = "catheter.sh"; next }
        /^```c$/ { f = "jaws.c"; next } /^```$/ { f = "" } f { print > f }' tools.md
    run compile "$docs/samples/forceps.urdf" -o forceps.dpa --tool shaft
    if grep -q 'reads no URDF' stderr; then
        rm recipe5.part
        skip 'forceps: no urdfdom'
    else
        check "forceps: $(cat stdout stderr)" grep -q 'tool shaft of 1 capsule and 2 tips with 1 jaw,' stdout
    fi
    sh catheter.sh
    felt catheter catheter.json --device "$press"
    check "a catheter of 64 segments: $(grep -c radius catheter.json)" test "$(grep -c radius catheter.json)" -eq 64
    printf '#include "dynpoint.h"\nvoid move(const dpt_arm *arm, double opening, dpt_world *world, dpt_tool tool);\n%s\n{\n%s\n}\n' \
        'void move(const dpt_arm *arm, double opening, dpt_world *world, dpt_tool tool)' "$(cat jaws.c)" >jaws_whole.c
    if cc -std=c99 -Wall -Wextra -Werror -I"$tests/../include" -fsyntax-only jaws_whole.c 2>cc.log; then ok
    else bad "the recipe's C: $(cat cc.log)"; fi
    count=0
    for part in recipe*.part; do
        count=$((count + 1))
        { echo '{ "bodies": [ { "shape": "liver", "triangles": 2692,
              "orientation": [0.70710678118654752, -0.70710678118654752, 0, 0] } ],'; cat "$part"; echo '}'; } >"${part%.part}.json"
        felt "${part%.part}" "${part%.part}.json" --device "$press"
    done
    check "recipes of tools: $count" test "$count" -eq "$(ls recipe*.part | wc -l)" -a "$count" -ge 4
    sed -n '/"tool"/,/^  },/p' "$docs/samples/scalpel.json" | sed 's/^  //; $s/,$//' >scalpel.part
    check 'docs/recipes.md shows the scalpel of the sample' cmp -s scalpel.part recipe2.part
}

# forge FROM TO PATTERN REPLACEMENT: another text in a recording's header
forge()
{
    python3 - "$@" <<'END_OF_PYTHON'
import re, struct, sys, zlib
data = open(sys.argv[1] + ".dpr", "rb").read()
begin, size = struct.unpack_from("<I", data, 12)[0], struct.unpack_from("<I", data, 40)[0]
text = re.sub(sys.argv[3].encode(), sys.argv[4].encode(), data[48:48 + size])
header = bytearray(data[:48] + text + b"\0" * (8 - (48 + len(text)) % 8))
struct.pack_into("<I", header, 12, len(header))
struct.pack_into("<I", header, 40, len(text))
struct.pack_into("<I", header, 16, 0)
struct.pack_into("<I", header, 16, zlib.crc32(header))
open(sys.argv[2] + ".dpr", "wb").write(bytes(header) + data[begin:])
END_OF_PYTHON
}

recordings()
{
    if ! python3 -c 'import zlib' 2>python.log; then
        skip 'forged tips: no python3'
        return
    fi
    forge mesh forged 'nothing' ''
    check 'a header that is made again is the same' cmp -s mesh.dpr forged.dpr
    forge mesh forged 'tip=[^\n]*\n' ''
    run replay forged.dpr
    check "without its tip it differs: exit $status" test $status -eq 1
    forge mesh forged 'tip=wedge' 'tip=box'
    run replay forged.dpr
    check "with another tip it differs: exit $status" test $status -eq 1
    forge file forged 'tip=[^\n]*\n' ''
    run replay forged.dpr
    check "what the recording says counts, not the file: exit $status" test $status -eq 1
    refuses 'another file' 'none.json: this is another scene' replay file.dpr none.json
    good=wedge,0.03,0.02,0.02,0,0,0,0,0,1,0,0,0
    for bad in '' wedge wedge, ball,${good#*,} "$good,0" "${good%,0}" wedge,-0.03,0.02,0.02,0,0,0,0,0,1,0,0,0 \
        wedge,11,0.02,0.02,0,0,0,0,0,1,0,0,0 wedge,0.03,0,0,0,0,0,0,0,1,0,0,0 \
        wedge,0.03,0.02,0.02,2,0,0,0,0,1,0,0,0 wedge,0.03,0.02,0.02,0,3,0,0,0,1,0,0,0 \
        wedge,0.03,0.02,0.02,0,0.5,0,0,0,1,0,0,0 wedge,0.03,0.02,0.02,0,-1,0,0,0,1,0,0,0 \
        cylinder,0.03,0.02,0.02,0,0,0,0,0,1,0,0,0 cylinder,0.03,0,0.02,0,2,0,0,0,1,0,0,0 \
        cylinder,0.03,0,0.02,0,33,0,0,0,1,0,0,0 cylinder,0.03,0,0.02,0,1e300,0,0,0,1,0,0,0 \
        wedge,0.03,0.02,0.02,0,0,0,0,0,2,0,0,0 wedge,0.03,0.02,0.02,0,0,0,11,0,1,0,0,0 \
        wedge,nan,0.02,0.02,0,0,0,0,0,1,0,0,0 wedge,0.03,0.02,0.02,0,0,0,0,0,inf,0,0,0; do
        forge mesh forged 'tip=[^\n]*\n' "tip=$bad\n"
        refuses "a line tip=$bad" "of its header: 'tip=" replay forged.dpr
    done
    forge mesh forged 'tip=[^\n]*\n' "$(for i in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17; do printf 'tip=%s\\n' "$good"; done)"
    refuses 'seventeen tips' "of its header: 'tip=" replay forged.dpr
    forge mesh forged 'law=proxy' 'law=bed'
    refuses 'tips with another law' 'forged.dpr: its header has tips, and another law than proxy' replay forged.dpr
}

# error_of NAME: how much a run said that its curved tips are off, m
error_of()
{
    sed 's/.*"tip_error":\([^,]*\),.*/\1/' "$1.says"
}

# is_near_gap WHAT WANTED ARGUMENT...: at most by the error that is said of the tip nearer, as a hull is round it
is_near_gap()
{
    what=$1 wanted=$2
    shift 2
    gap=$(first_gap "$@")
    run "$@" --device "$still" --ticks 2 --json
    cp stdout gap.says
    check "$what: a gap of $gap, not $wanted less at most $(error_of gap)" awk -v a="$gap" -v b="$wanted" -v e="$(error_of gap)" \
        'BEGIN { exit !(a != "" && e > 0 && e < 0.007 && a <= b + 1e-9 && a >= b - e - 1e-9) }'
}

# forces NAME: the force of each tick, and the energy
forces()
{
    awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
        { print $at["asked_fx"], $at["asked_fy"], $at["asked_fz"], $at["energy"] }' "$1.csv" >"$1.forces"
}

# are_as_ball NAME STIFFNESS: the forces of an ellipsoid with three equal lengths are those of the ball, within its error
are_as_ball()
{
    forces ball
    forces "$1"
    paste -d' ' ball.forces "$1.forces" >both
    check "$1: an ellipsoid is felt as the ball, within $(error_of "$1") m: $(tail -1 both)" \
        awk -v most="$(awk -v k="$2" -v e="$(error_of "$1")" 'BEGIN { print k * e + 1e-9 }')" \
        '{ for (i = 1; i <= 3; i++) far += ($i - $(i + 4)) ^ 2 > most ^ 2; pressed += $2 > 0.5; stored += $8 > 1e-4 }
        END { exit !(NR == 1100 && most < 0.05 && pressed > 100 && stored > 100 && !far) }' both
}

curved()
{
    run run box.dpa --device sim --ticks 1 --tip ellipsoid:0.01,0.01,0.01
    if grep -q 'this build has no curved tips' stderr; then
        left_out=': this build has no curved tips: install libccd (Debian: libccd-dev pkg-config) and run make again, without CONVEX=no'
        refuses 'a build without them' "dynpoint run: --tip ellipsoid:1,1,1$left_out" run box.dpa --device sim --ticks 5 --tip ellipsoid:1,1,1
        with egg '"tips": [ { "shape": "ellipsoid", "extent": [0.01, 0.01, 0.01] } ]'
        refuses 'the same of a file' "egg.json: tool.tips[0]$left_out" run egg.json --device sim
        forge mesh forged 'tip=wedge' 'tip=ellipsoid'
        refuses 'the same of a recording' "box.dpa: tip 1$left_out" replay forged.dpr
        skip 'curved tips: no libccd'
        return
    fi
    at='--at 0,0.1,0'
    # shellcheck disable=SC2086
    for row in 'ellipsoid:0.02,0.04,0.03 0.03' 'capsule:0.04,0.04,0.06 0.03' 'capsule:0.04,0,0.04 0.03' \
        'curved-cylinder:0.04,0,0.03 0.03' 'curved-cone:0.04,0,0.03 0.03'; do
        is_near_gap "--tip ${row% *}" "${row#* }" run box.dpa $at --tip "${row% *}"
    done
    for tip in '"ellipsoid", "extent": [0.02, 0.01, 0.04]' '"ellipsoid", "extent": [0.02, 0.01, 0.04], "sides": 6' \
        '"capsule", "extent": [0.02, 0, 0.04]' '"curved-cylinder", "extent": [0.02, 0.02, 0.04], "sides": 8' \
        '"curved-cone", "extent": [0.02, 0.02, 0.04]'; do
        with up "\"tips\": [ { \"shape\": $tip, \"orientation\": [0.70710678118654752, -0.70710678118654752, 0, 0] } ]"
        # shellcheck disable=SC2086
        is_near_gap "$tip, upright" 0.03 run up.json $at
    done
    # Turned, what is lowest is no end of an axis, and the hull is farther off.
    for sine in 0.15 0.2 0.25 0.3 0.6; do
        turn=$(awk -v s=$sine 'BEGIN { a = atan2(s, sqrt(1 - s * s)) / 2; printf "[%.17g, %.17g, 0, 0]", cos(a), sin(a) }')
        lowest=$(awk -v s=$sine 'BEGIN { printf "%.17g", 0.05 - sqrt(0.005 ^ 2 * (1 - s * s) + (0.04 * s) ^ 2) }')
        with up "\"tips\": [ { \"shape\": \"ellipsoid\", \"extent\": [0.01, 0.01, 0.08], \"orientation\": $turn } ]"
        # shellcheck disable=SC2086
        is_near_gap "an ellipsoid that is turned by the sine $sine" "$lowest" run up.json $at
    done

    # A ball of the stylus, and one of a tip, whose stylus is a point in its middle. By the law bed the ball has two free
    # ends, and a tip is one.
    egg='--tip ellipsoid:0.02,0.02,0.02 --radius 0'
    for row in 'proxy 300' 'point 300' 'bed 600'; do
        press_at="--device $press --at 0,0.065,0 --length 0 --law ${row% *}"
        # shellcheck disable=SC2086
        felt ball box.dpa $press_at --radius 0.01 --stiffness 300
        # shellcheck disable=SC2086
        felt "egg_${row% *}" box.dpa $press_at $egg --stiffness "${row#* }"
        are_as_ball "egg_${row% *}" "${row#* }"
    done
    check "the tip in the recording: $(tips_of egg_bed)" test "$(tips_of egg_bed)" = \
        'ellipsoid,0.02,0.02,0.02,0,0,0,0,0,1,0,0,0'
    run record info egg_bed.dpr
    check "the error in the recording: $(cat stdout)" grep -q 'a proxy feels, it is up to 0.0347 mm larger$' stdout
    for law in proxy point; do
        run run box.dpa --device "$press" --ticks 1100 --tip ellipsoid:0.02,0.02,0.02 --law $law
        check "$law: the error is told: $(cat stdout)" grep -q '^  curved tips: ' stdout
    done

    # On a body that is turned, by a file as by an option, with others beside it, from elsewhere, embedded.
    shape='"shape": "ellipsoid", "extent": [0.02, 0.01, 0.03]'
    for law in proxy bed point; do
        with egg "\"law\": \"$law\", \"tips\": [ { $shape }, { \"shape\": \"capsule\", \"extent\": [0.01, 0, 0.02], \"at\": [0, 0, 0.02] } ]"
        felt file_$law egg.json --device "$press"
        felt option_$law box.dpa --device "$press" --law $law --tip ellipsoid:0.02,0.01,0.03
        felt embedded_$law box.dpa --device "$press" --law $law --tip ellipsoid:0.02,0.01,0.03 --embed
        is_same embedded_$law option_$law
        felt organ_$law torus.dpa --device 'sim:?hand=press&dofs=6' --law $law --tip curved-cone:0.01,0,0.03 --tip curved-cylinder:0.02,0,0.01
    done
    echo "{ \"bodies\": [ { \"shape\": \"box\", \"orientation\": [0.9659258262890683, 0, 0, 0.25881904510252074], \"position\": [0.5, 0, 0] } ],
        \"tool\": { \"law\": \"point\", \"tips\": [ { $shape } ] } }" >turned.json
    felt turned turned.json --device "$press" --at 0.5,0.0677,0

    # A trace's line has one too: the same gaps, and the force of its depth.
    trace down.csv 0,0,0.07,0,0,0.07,0.1 1,0,0.0595,0,0,0.0595,0.1 2,0,0.058,0,0,0.058,0.1 3,0,0.057,0,0,0.057,0.1
    for row in 'point 500' 'bed 250'; do
        succeeds "replay, ${row% *}" replay box.dpa down.csv --tip ellipsoid:0.02,0.02,0.02 --law "${row% *}" --radius 0 -o down_out.csv
        awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next } { print $at["fy"] "," $at["energy"] "," $at["gap"] }' down_out.csv >down
        check "replay, ${row% *}: $(paste -sd' ' down)" awk -F, -v k="${row#* }" '{ d[1] = 0; d[2] = 0.0005; d[3] = 0.002; d[4] = 0.003
            wrong += ($1 - k * d[NR]) ^ 2 > 1e-6 || (k == 250 && ($2 - 0.5 * k * d[NR] ^ 2) ^ 2 > 1e-12) || (NR > 1 && ($3 + d[NR]) ^ 2 > 1e-10) }
            END { exit !(NR == 4 && !wrong) }' down
    done
    for bad in '--method tree' '--against brute' '--law point --until contact'; do
        # shellcheck disable=SC2086
        refuses "replay --tip $bad" 'what is curved, for the other laws too, with --until respond' \
            replay box.dpa down.csv --tip ellipsoid:1,1,1 $bad -o out/x.csv
    done

    for row in 'ellipsoid:1,1,0 its lengths must be above 0, and none 10,000 times another' \
        'ellipsoid:1,1,0.00009 its lengths must be above 0, and none 10,000 times another' \
        'ellipsoid:1,1,11 its lengths must be 0 to 10' 'ellipsoid:1,1,1,0.1 it is curved: it has no radius' \
        'capsule:0.2,0,0.1 a capsule is at least as long as it is wide' 'capsule:0.2,0.1,0.3 it is round' \
        'curved-cone:1,2,1 it is round' 'curved-cylinder:1,0,0 its lengths must be above 0'; do
        refuses "--tip ${row%% *}" "--tip ${row%% *}: ${row#* }" run box.dpa --device sim --ticks 5 --tip "${row%% *}"
    done
    refuses 'one with corners beside it' 'tips are felt by the law proxy alone (tool.law, --law), but for curved ones' \
        run box.dpa --device sim --ticks 5 --law point --tip ellipsoid:1,1,1 --tip box:1,1,1
    refuses 'what gives way' 'cloth: bodies[0] gives way: by the laws point and bed curved tips feel rigid bodies alone' \
        run cloth --law point --device sim --ticks 5 --tip ellipsoid:0.1,0.1,0.1
    good=ellipsoid,0.03,0.02,0.02,0,0,0,0,0,1,0,0,0
    for bad in "$good,0" ellipsoid,0.03,0.02,0.02,0.1,0,0,0,0,1,0,0,0 ellipsoid,0.03,0.02,0.02,0,13,0,0,0,1,0,0,0 \
        ellipsoid,0.03,0,0.02,0,0,0,0,0,1,0,0,0 capsule,0.03,0,0.02,0,0,0,0,0,1,0,0,0; do
        forge mesh forged 'tip=[^\n]*\n' "tip=$bad\n"
        refuses "a line tip=$bad" "of its header: 'tip=" replay forged.dpr
    done
}

refusals()
{
    for value in '' box box: box:1 box:1,1 'box:1,1,1,1,1' 'box:1,1,1,' 'box:,1,1' ball:1,1,1 BOX:1,1,1 'box 1,1,1' box:1,1,x \
        box:nan,1,1 box:0x1,1,1 'box:1, 1,1' :1,1,1; do
        refuses "--tip '$value'" "dynpoint run: --tip takes SHAPE:X,Y,Z or SHAPE:X,Y,Z,RADIUS, with the shape box" \
            run box.dpa --device sim --ticks 5 --tip "$value"
    done
    refuses 'a negative length' '--tip box:-1,1,1: its lengths must be 0 to 10' run box.dpa --device sim --tip box:-1,1,1
    refuses 'a huge one' '--tip box:1,1,11: its lengths must be 0 to 10' run box.dpa --device sim --tip box:1,1,11
    refuses 'a negative radius' ': its radius must be 0 to 1' run box.dpa --device sim --tip box:1,1,1,-0.1
    refuses 'a huge one' ': its radius must be 0 to 1' run box.dpa --device sim --tip box:1,1,1,1.1
    refuses 'a line' '--tip box:1,0,0: it is too thin' run box.dpa --device sim --tip box:1,0,0
    refuses 'a point' '--tip cone:0,0,0,0.1: it is too thin' run box.dpa --device sim --tip cone:0,0,0,0.1
    refuses 'an oval' '--tip cone:1,2,1: it is round' run box.dpa --device sim --tip cone:1,2,1
    refuses 'the second one' '--tip box:1,0,0' run box.dpa --device sim --tip box:1,1,1 --tip box:1,0,0
    refuses 'no value' '--tip needs a value' run box.dpa --device sim --tip
    # shellcheck disable=SC2046
    refuses 'seventeen' '--tip: at most 16 of them' run box.dpa --device sim --ticks 5 \
        $(for i in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17; do echo --tip box:1,1,1; done)
    # shellcheck disable=SC2046
    succeeds 'sixteen' run box.dpa --device sim --ticks 5 --at 0,9,0 \
        $(for i in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16; do echo --tip box:0.1,0.1,0.1; done)
    for law in bed point; do
        refuses "the law $law" 'box.dpa: tips are felt by the law proxy alone (tool.law, --law)' \
            run box.dpa --device sim --ticks 5 --tip box:0.1,0.1,0.1 --law $law
        refuses "a file's tips, the law $law" 'file.json: tips are felt by the law proxy alone (tool.law, --law)' \
            run file.json --device sim --ticks 5 --law $law
    done
    refuses 'a trace' '--record needs the stylus, without tips' \
        run box.dpa --device sim --ticks 5 --tip box:0.1,0.1,0.1 --record out/trace.csv
}

# replay_gaps WANTED ARGUMENT...: each tick's gap is the one in the file WANTED, of a trace over the box
replay_gaps()
{
    wanted=$1
    shift
    succeeds "replay $*" replay box.dpa "$@" -o gaps.csv
    column gaps.csv 5 | paste -d' ' - "$wanted" >both
    check "replay $*: $(awk '($1 - $2) ^ 2 > 1e-16 || $1 == "" { print NR ": " $1 " not " $2; exit }' both)" \
        awk 'NF != 2 || ($1 - $2) ^ 2 > 1e-16 { wrong++ } END { exit wrong || NR < 3 }' both
}

# The line goes round an eighth of a sphere: z, y, x, z. A tip that does not spin about it comes back turned by 90 degrees.
traces()
{
    awk -v OFMT=%.17g 'function row(tick, x, y, z) { printf "%d,0,0.1,0,%.17g,%.17g,%.17g\n", tick, 0.1 * x, 0.1 + 0.1 * y, 0.1 * z }
        BEGIN { print "tick,ax,ay,az,bx,by,bz"
            for (i = 0; i <= 30; i++) { t = i * atan2(0, -1) / 60; row(i, 0, sin(t), cos(t)); print 0.05 - 0.02 * cos(t) - 0.015 * sin(t) >"wanted" }
            for (i = 1; i <= 30; i++) { t = i * atan2(0, -1) / 60; row(30 + i, sin(t), cos(t), 0); print 0.05 - 0.015 * cos(t) - 0.01 * sin(t) >"wanted" }
            for (i = 1; i <= 30; i++) { t = i * atan2(0, -1) / 60; row(60 + i, cos(t), 0, sin(t)); print 0.05 - 0.01 >"wanted" }
            row(95, 0, 0, 1); print 0.03 >"wanted"; row(96, 0, 0, 1); print 0.03 >"wanted" }' >round.csv
    replay_gaps wanted round.csv --tip box:0.02,0.04,0.03
    sed 's/$/ - 0.004/' wanted | bc -l >wanted_round
    replay_gaps wanted_round round.csv --tip box:0.02,0.04,0.03,0.004
    sed 's/.*/0.048/' wanted >wanted_line
    awk -F, 'NR == 1 || $6 >= 0.1 { print }' round.csv >above.csv
    sed 1d above.csv | sed 's/.*/0.048/' >wanted_line
    replay_gaps wanted_line above.csv --tip box:0.001,0.001,0.001 --radius 0.002

    trace grown.csv 0,0,0.1,0,0,0.1,0.1 1,0,0.1,0,0,0.2,0 2,0,0.1,0,0,0.3,0

    # What run does with its stylus and a tip, replay does with a trace of the same motion. The hand turns about x.
    felt pressed box.dpa --device 'sim:?hand=press&dofs=6' --at 0,0.065,0 --tip wedge:0.03,0.02,0.02 --budget 0 --stiffness 300
    awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; print "tick,ax,ay,az,bx,by,bz"; next }
        { x = $at["x"]; y = 0.065 + $at["y"]; z = $at["z"]; w = $at["qw"]; q = $at["qx"]
            printf "%d,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g\n", NR - 2, x, y, z, x, y - 0.2 * w * q, z + 0.1 * (w * w - q * q) }' \
        pressed.csv >pressed_trace.csv
    succeeds 'replay of the trace' replay box.dpa pressed_trace.csv --tip wedge:0.03,0.02,0.02 --stiffness 300 \
        --radius 0.002 -o replayed.csv
    for names in 'pressed asked_fx asked_fy asked_fz asked_tx energy proxy_x proxy_y proxy_z proxy_qw proxy_qx distance' \
        'replayed fx fy fz tx energy ox oy oz qw qi distance'; do
        awk -F, -v names="${names#* }" 'NR == 1 { n = split(names, name, " "); for (i = 1; i <= NF; i++) at[$i] = i; next }
            { for (i = 1; i <= n; i++) printf "%s%s", $at[name[i]], i < n ? " " : "\n" }' "${names%% *}.csv" >"${names%% *}.as"
    done
    check "replay of the trace is as run: $(paste -d' ' pressed.as replayed.as | tail -1)" \
        awk 'BEGIN { while ((getline <"pressed.as") > 0) { n++; for (i = 1; i <= 11; i++) run[n, i] = $i } }
            { for (i = 1; i <= 11; i++) wrong += ($i - run[NR, i]) ^ 2 > 1e-16 }
            END { exit !(!wrong && NR == n && n > 1000 && run[n, 2] > 0.5) }' replayed.as

    refuses 'a trace whose line grows' "grown.csv: tick 2: --tip needs a tool of one length; it is 0.2 m, and 0.1 m in the first row" \
        replay box.dpa grown.csv --tip box:1,1,1 -o out/x.csv
    for bad in '--law bed' '--law point' '--method tree' '--method brute' '--method paper' '--against brute'; do
        # shellcheck disable=SC2086
        refuses "replay --tip $bad" 'dynpoint replay: --tip is for the method exact and the law proxy, without --against' \
            replay box.dpa above.csv --tip box:0.01,0.01,0.01 $bad -o out/x.csv
    done
    refuses 'replay: no such shape' 'dynpoint replay: --tip takes SHAPE' replay box.dpa above.csv --tip ball:1,1,1 -o out/x.csv
    refuses 'replay: a thin one' 'dynpoint replay: --tip box:1,0,0: it is too thin' replay box.dpa above.csv --tip box:1,0,0 -o out/x.csv
}

echo '{ "bodies": [ { "shape": "box" } ] }' >probe.json
run run probe.json --device sim --ticks 1
if grep -q 'this build reads no scene files' stderr; then
    skip "tips: no jansson"
    finish
fi
prepare
places
same_by_file_and_option
arms
grippers
coupled
refusals
traces
[ ! "$is_part" ] || finish
samples
recordings
curved
finish
