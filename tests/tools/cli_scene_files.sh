#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# dynpoint run SCENE.json: what a file says is what a name or an option says, bit for bit, and its recordings know its meshes.
# `sh tests/tools/cli_scene_files.sh BUILD`.
. "$(dirname "$0")/cli.sh"

docs=$tests/../docs
hand='sim:?hand=press'
ticks=800
echo '{ "bodies": [ { "shape": "box" } ] }' >box.json
run run box.json --device sim --ticks 1
if grep -q 'this build reads no scene files' stderr; then
    skip "scene files: no jansson"
    finish
fi

# scene NAME: standard input is the file NAME.json
scene()
{
    cat >"$1.json"
}

# body NAME MEMBERS: a scene of one body with these
body()
{
    echo "{ \"bodies\": [ { $2 } ] }" >"$1.json"
}

# felt NAME ARGUMENT...: a run of it, recorded; all records as text in NAME.csv
felt()
{
    name=$1
    shift
    rm -f "$name.dpr" "$name.csv"
    succeeds "$name: run $*" run "$@" --ticks $ticks --record "$name.dpr" --json
    cp stdout "$name.says"
    succeeds "$name: record csv" record csv "$name.dpr" -o "$name.csv"
}

# is_same A B, differs A B: of what was felt
is_same()
{
    check "$1 and $2: the same bits" cmp -s "$1.csv" "$2.csv"
}
differs()
{
    if cmp -s "$1.csv" "$2.csv"; then bad "$1 and $2: the same bits"; else ok; fi
}

is_touched()
{
    check "$1 is touched: $(cat "$1.says")" grep -q '"contacts":[1-9][0-9]' "$1.says"
    check "$1: all ticks are felt: $(cat "$1.says")" grep -q '"failed":0,' "$1.says"
}

# --- What a name says.
sample=$docs/samples/scene.json
felt sample_file "$sample"
is_touched sample_file
felt sample_name laparoscopy --device "$hand"
is_same sample_file sample_name
succeeds 'its replay' replay sample_file.dpr
check "other bits: $(cat stdout)" grep -q ': 800 ticks, all the same bits$' stdout
sed -n '/^```json$/,/^```$/p' "$docs/scene.md" | sed '/^```/d' >page.json
check 'docs/scene.md shows the sample' cmp -s page.json "$sample"

square='"shape": "membrane", "triangles": 512, "orientation": [0.70710678118654752, -0.70710678118654752, 0, 0]'
border='{ "box": [-0.11, -0.11, -0.01, -0.0999, 0.11, 0.01], "fixed": true },
    { "box": [0.0999, -0.11, -0.01, 0.11, 0.11, 0.01], "fixed": true },
    { "box": [-0.11, -0.11, -0.01, 0.11, -0.0999, 0.01], "fixed": true },
    { "box": [-0.11, 0.0999, -0.01, 0.11, 0.11, 0.01], "fixed": true }'
rubber='"kind": "sheet", "young": 1e5, "thickness": 1e-3, "density": 1000, "drag": 10, "viscosity": 1e-3'
sheet="$square, \"material\": { $rubber, \"regions\": [ $border ] }"
within=0,0.007,-0.05 # the stylus lies within the border
felt membrane_name membrane --device "$hand"
body membrane "$sheet"
felt membrane_file membrane.json --device "$hand" --at "$within"
is_touched membrane_file
is_same membrane_file membrane_name
scene tori <<'END'
{ "bodies": [ { "shape": "torus", "triangles": 61358 },
              { "shape": "torus", "triangles": 5568, "rigid": true, "position": [0.1, 0, 0],
                "orientation": [0.70710678118654752, -0.70710678118654752, 0, 0] } ] }
END
felt tori_name tori --device "$hand"
felt tori_file tori.json --device "$hand"
is_touched tori_file
is_same tori_file tori_name

# --- A port: the stylus leads through it, and what its shaft meets is felt by the lever about it. The box's edge is at
# z = -0.04 m, the tip 0.04 m behind it, and the port 0.2 m before the tip.
scene ported <<'END'
{ "bodies": [ { "shape": "box" } ], "tool": { "port": [0, 0.06, 0.12] }, "device": { "origin": [0, 0.06, -0.08] } }
END
succeeds 'a port' run ported.json --device "$hand" --ticks 2000 --record ported-trace.csv
awk -F, 'NR > 1 { dy = 0.06 - $3; dz = 0.12 - $4; off = ($6 - $3) * dz - ($7 - $4) * dy; if (off * off > 1e-28) wrong++ }
    END { exit wrong || NR != 2001 }' ported-trace.csv
verdict $? 'the axis leads through the port in all ticks'
ticks=2000
felt ported ported.json --device "$hand"
is_touched ported
share=$(awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i }
    NR > 1 { all = sqrt(2 * stiffness * $at["energy"]); felt = sqrt($at["asked_fy"] ^ 2 + $at["asked_fz"] ^ 2) }
    END { print felt / all }' stiffness="$(sed 's/.*"stiffness":\([0-9.]*\).*/\1/' ported.says)" ported.csv)
awk "BEGIN { exit !($share > 0.79 && $share < 0.81) }"
verdict $? "the edge is felt by the lever, 1 - 0.04 / 0.2: $share"
succeeds 'ported: replay' replay ported.dpr
check "ported: other bits: $(cat stdout)" grep -q ': 2000 ticks, all the same bits$' stdout
sed 's/"port": [^]]*\]//' ported.json >unported.json
felt unported unported.json --device "$hand"
ticks=800
differs ported unported

# --- What each setting does: the scene is another one with it, and with its default the same.
felt plain membrane.json --device "$hand" --at "$within"
soft()
{
    body "$1" "$sheet, \"physics\": { $2 }, \"surface\": { ${3:-} }"
    felt "$1" "$1.json" --device "$hand" --at "$within"
    is_touched "$1"
}
soft usual '"integrator": "symplectic", "sleep_speed": 1e-3, "response": "load", "period": 0' \
    '"static_friction": 0, "stiffness": 0, "side_limit": 0, "unfelt": false'
is_same usual plain
soft implicit '"integrator": "implicit"'
differs implicit plain
soft twice '"integrator": "implicit", "iterations": 2'
is_same twice implicit
soft often '"integrator": "implicit", "iterations": 9'
differs often implicit
soft spread '"period": 0.01'
differs spread plain
check "its period is a delay: $(cat spread.says)" grep -q '"delay":0.0105' spread.says
check 'and of none there is none' grep -q '"delay":0.0005' plain.says
soft awake '"sleep_speed": 0'
check "nothing sleeps: $(cat awake.says)" grep -q '"spring_nodes":\([0-9]*\),"spring_nodes_awake":\1,' awake.says
soft drowsy '"sleep_speed": 1'
differs drowsy plain
soft yielding '"period": 0' '"stiffness": 300'
differs yielding plain
wiped()
{
    body "$1" "\"shape\": \"box\", \"surface\": { $2 }"
    felt "$1" "$1.json" --device 'sim:?hand=wipe&cycle=0.5' ${3:+--friction $3}
    is_touched "$1"
}
wiped smooth ''
wiped rough '"static_friction": 0.5'
differs rough smooth
wiped slippery '"static_friction": 0.5, "kinetic_friction": 0.2'
differs slippery rough
succeeds 'slippery: replay' replay slippery.dpr
check "slippery: other bits: $(cat stdout)" grep -q ': 800 ticks, all the same bits$' stdout
wiped overridden '"static_friction": 0.3' 0.5
is_same overridden rough
body unfelt "$sheet, \"surface\": { \"unfelt\": true }"
felt unfelt unfelt.json --device "$hand"
check "what is unfelt gives no force: $(cat unfelt.says)" grep -q '"strongest":0,' unfelt.says
for way in '"gravity": 9.81' '"tool": { "length": 0.05, "radius": 0.01 }' '"tool": { "law": "bed" }' \
    '"device": { "zoom": 2 }' '"device": { "force_scale": 0.5 }' '"device": { "origin": [0.01, 0.004, 0.02] }' \
    '"tool": { "segments": [ { "a": [0, 0, 0], "b": [0, 0, 0.1], "radius": 0.004 },
                             { "a": [0, 0, 0.1], "b": [0.05, 0, 0.1], "radius": 0.002 } ] }'; do
    scene other <<END
{ "bodies": [ { $sheet, "physics": { "load_radius": 0.0375 } } ], $way }
END
    felt other other.json --device "$hand"
    is_touched other
    differs other plain
    succeeds "$way: replay" replay other.dpr
    check "$way: other bits: $(cat stdout)" grep -q ': 800 ticks, all the same bits$' stdout
done
scene displaced <<END
{ "bodies": [ { $sheet, "physics": { "load_radius": 0.0375, "response": "displace" } } ], "tool": { "law": "bed" } }
END
felt displaced displaced.json --device "$hand"
is_touched displaced
check "the sheet is out of the tool's way: $(cat displaced.says)" grep -q '"deepest":0.00[0-3]' displaced.says
scene loaded <<END
{ "bodies": [ { $sheet, "physics": { "load_radius": 0.0375 } } ], "tool": { "law": "bed" } }
END
felt loaded loaded.json --device "$hand"
differs displaced loaded
succeeds 'displaced: replay' replay displaced.dpr
check "displaced: other bits: $(cat stdout)" grep -q ': 800 ticks, all the same bits$' stdout

# --- Options win.
scene full <<END
{ "bodies": [ { $sheet, "surface": { "static_friction": 1 } } ],
  "tool": { "length": 0.2, "radius": 0.02, "law": "point" },
  "device": { "url": "sim:?hand=wipe", "zoom": 4, "force_scale": 3, "origin": [0.05, 0.1, 0.05], "clutch": 2 } }
END
felt full full.json --device "$hand" --length 0.1 --radius 0.002 --law proxy --zoom 1 --force-scale 1 --friction 0 \
    --at "$within"
is_same full plain
run record info full.dpr
check "the file's clutch stays: $(cat stdout)" grep -q '^ *clutch=2$' stdout
run run full.json --clutch 5 --ticks 5 --record clutch.dpr
run record info clutch.dpr
check "--clutch wins: $(cat stdout)" grep -q '^ *clutch=5$' stdout
check "the file's device: $(cat stdout)" grep -q 'sim:?hand=wipe' stdout

# --- Meshes of one's own, beside the file, from elsewhere.
prepare
mkdir -p folder/meshes
succeeds 'make membrane' make membrane 512 -o membrane.ply
printf 'box -0.11 -0.11 -0.01 -0.0999 0.11 0.01 fixed\nbox 0.0999 -0.11 -0.01 0.11 0.11 0.01 fixed\nbox -0.11 -0.11 -0.01 0.11 -0.0999 0.01 fixed\nbox -0.11 0.0999 -0.01 0.11 0.11 0.01 fixed\n' >border
succeeds 'compile membrane' compile membrane.ply -o folder/meshes/soft.dpa --springs sheet --young 1e5 --thickness 0.001 \
    --density 1000 --drag 10 --viscosity 0.001 --regions border
cp box.dpa folder/meshes/box.dpa
lying='"orientation": [0.70710678118654752, -0.70710678118654752, 0, 0]'
body folder/soft "\"mesh\": \"meshes/soft.dpa\", $lying"
felt soft_mesh folder/soft.json --device "$hand" --at "$within"
is_same soft_mesh plain
body folder/stiff "\"mesh\": \"meshes/soft.dpa\", $lying, \"rigid\": true"
felt stiff_mesh folder/stiff.json --device "$hand"
is_touched stiff_mesh
check "a rigid one has no springs: $(cat stiff_mesh.says)" grep -q '"spring_nodes":0,' stiff_mesh.says
body folder/box "\"mesh\": \"meshes/box.dpa\""
felt box_file folder/box.json --device "$hand"
felt box_mesh box.dpa --device "$hand"
is_same box_file box_mesh
body absolute "\"mesh\": \"$work/box.dpa\""
felt box_absolute absolute.json --device "$hand"
is_same box_absolute box_mesh

succeeds 'replay' replay box_file.dpr
mkdir -p moved && cp -r folder/box.json folder/meshes moved
succeeds 'replay, moved' replay box_file.dpr moved/box.json
cp torus.dpa moved/meshes/box.dpa
run replay box_file.dpr moved/box.json
check "another mesh: exit $status" test $status -eq 2
check "is told: $(cat stderr)" grep -q 'moved/box.json: this is another scene than the recording' stderr
cp box.dpa moved/meshes/box.dpa
echo >>moved/box.json
run replay box_file.dpr moved/box.json
check "another file: exit $status" test $status -eq 2
refuses 'a recording over the mesh' 'it is an input too' run folder/box.json --device sim --ticks 5 --record folder/meshes/box.dpa
refuses 'a recording over the file' 'it is an input too' run folder/box.json --device sim --ticks 5 --record folder/box.json

# --- A byte order mark, as some editors write it, before JSON and before settings.
{ printf '\357\273\277'; cat box.json; } >marked.json
felt marked marked.json --device "$hand"
felt unmarked box.json --device "$hand"
is_same marked unmarked
echo '{ "bodies": [ }' | { printf '\357\273\277'; cat; } >wrong.json
refuses 'what is wrong behind a mark has its place' 'wrong.json:1:15: ' run wrong.json --device sim --ticks 5
printf '\357\273\277mass=0.1\ndamping=2\n' >marked.txt
succeeds 'settings behind a mark' run box.json --device sim --ticks 5 --identified marked.txt

# --- A tool of an arm, where arms can be compiled.
if "$program" compile "$docs/samples/arm.urdf" -o folder/arm.dpa >/dev/null 2>&1; then
    echo '{ "bodies": [ { "shape": "box" } ], "tool": { "arm": "arm.dpa" } }' >folder/held.json
    felt arm_file folder/held.json --device "$hand"
    felt arm_option box.json --device "$hand" --tool folder/arm.dpa
    is_same arm_file arm_option
    succeeds 'replay with an arm' replay arm_file.dpr
    refuses 'a length of an arm' "--length and --radius are for a stylus; its tool is an arm's" \
        run folder/held.json --device sim --ticks 5 --length 0.1
else
    skip "the tool of an arm: no urdfdom"
fi

finish
