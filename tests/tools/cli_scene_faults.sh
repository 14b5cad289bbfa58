#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# dynpoint run SCENE.json: whatever is wrong in a scene file has its place and its reason. `sh tests/tools/cli_scene_faults.sh BUILD`.
. "$(dirname "$0")/cli.sh"

echo '{ "bodies": [ { "shape": "box" } ] }' >wrong.json
run run wrong.json --device sim --ticks 1
if grep -q 'this build reads no scene files' stderr; then
    skip "scene files: no jansson"
    finish
fi

# wrong TEXT SCENE; in_body TEXT MEMBERS, and so on: TEXT follows the place
wrong()
{
    printf '%s' "$2" >wrong.json
    refuses "$2" "wrong.json$1" run wrong.json --device sim --ticks 5
}
square='"shape": "membrane", "triangles": 8'
in_scene() { wrong ": $1" "{ \"bodies\": [ { \"shape\": \"box\" } ], $2 }"; }
in_body() { wrong ": bodies[0]$1" "{ \"bodies\": [ { $2 } ] }"; }
in_sheet() { in_body ".material$1" "$square, \"material\": { \"kind\": \"sheet\", $2 }"; }
in_volume() { in_body ".material$1" "\"shape\": \"liver\", \"triangles\": 200, \"material\": { \"kind\": \"volume\", $2 }"; }
in_region() { in_sheet ".regions[0]$1" "\"regions\": [ { $2 } ]"; }
in_physics() { in_body ".physics$1" "$square, \"material\": { \"kind\": \"sheet\" }, \"physics\": { $2 }"; }
in_surface() { in_body ".surface$1" "\"shape\": \"box\", \"surface\": { $2 }"; }

# --- No JSON: line and column of the last character that was read.
wrong ":1:1: '[' or '{' expected near end of file" ''
wrong ":2:2: string or '}' expected near 'x'" '{
 x }'
wrong ":2:14: invalid token near 'NaN'" '{ "bodies": [],
 "gravity":NaN }'
wrong ":1:21: invalid token near 'Infinity'" '{ "gravity": Infinity }'
wrong ':1:24: real number overflow' '{ "gravity": 1e999999999 }'
wrong ':1:41: too big integer' '{ "gravity": 1000000000000000000000000000 }'
wrong ":3:9: duplicate object key near '\"bodies\"'" '{
 "bodies": [],
 "bodies": [] }'
wrong ":1:37: end of file expected near 'x'" '{ "bodies": [ { "shape": "box" } ] }x'
wrong ':1:17: unable to decode byte 0xff' "$(printf '{ "bodies": [ { "\377" } ] }')"
wrong ':1:37: \u0000 is not allowed' '{ "bodies": [ { "mesh": "a\u0000.dpa" } ] }'
awk 'BEGIN { for (i = 0; i < 500000; i++) printf "[" }' >wrong.json
refuses 'brackets' "wrong.json:1:2049: maximum parsing depth reached near '['" run wrong.json
awk 'BEGIN { for (i = 0; i < 100000; i++) printf "{\"a\":" }' >wrong.json
refuses 'braces' 'maximum parsing depth reached' run wrong.json

# --- Files.
mkdir -p folder.json
ln -s /dev/zero endless.json
refuses 'a folder' 'folder.json: cannot be read: ' run folder.json
refuses 'none' 'nonesuch.json: cannot be opened: ' run nonesuch.json
awk 'BEGIN { for (i = 0; i < 1048577; i++) printf " " }' >wrong.json
refuses 'a huge file' 'wrong.json: a scene file has at most 1048576 bytes' run wrong.json
refuses 'an endless one' 'endless.json: a scene file has at most 1048576 bytes' run endless.json
awk 'BEGIN { printf "{\"bodies\":["; for (i = 0; i < 300000; i++) printf "{},"; printf "{}]}" }' >wrong.json
refuses '300,001 bodies' 'wrong.json: bodies: has 300001 items; there must be 1 to 64' run wrong.json
awk 'BEGIN { printf "{\"bodies\":["; for (i = 0; i < 1000000; i++) printf "{},"; printf "{}]}" }' >wrong.json
refuses '1,000,001 bodies' 'wrong.json: a scene file has at most' run wrong.json
in_body '.mesh: standard input is none' '"mesh": "-"'
in_body '.mesh: has a control character' '"mesh": "a\nb.dpa"'
in_body '.mesh: has 0 bytes' '"mesh": ""'
in_body '.mesh: has 5000 bytes; there must be 1 to 4000' "\"mesh\": \"$(printf %05000d 0)\""
echo '{ "bodies": [ { "mesh": "nonesuch.dpa" } ] }' >wrong.json
refuses 'no mesh' 'nonesuch.dpa: cannot be opened' run wrong.json --device sim --ticks 5
echo '{ "bodies": [ { "mesh": "wrong.json" } ] }' >wrong.json
refuses 'no compiled mesh' 'wrong.json: byte 0' run wrong.json --device sim --ticks 5
echo '{ "bodies": [ { "shape": "box" } ], "tool": { "arm": "nonesuch.dpa" } }' >wrong.json
refuses 'no arm' 'nonesuch.dpa: cannot be opened' run wrong.json --device sim --ticks 5
echo '{ "bodies": [ { "shape": "box" } ] }' >wrong.json
refuses 'no device' 'and --device NAME are needed' run wrong.json
refuses 'a motion over it' 'wrong.json: byte 0' replay wrong.json - -o out/out.csv
prepare
echo '{ "bodies": [ { "shape": "box" }, { "mesh": "box.dpa", "rigid": false } ] }' >wrong.json
refuses 'no springs' 'wrong.json: bodies[1]: box.dpa has no springs' run wrong.json --device sim --ticks 5
echo '{ "bodies": [ { "mesh": "box.dpa", "physics": {} } ] }' >wrong.json
refuses 'no springs' 'wrong.json: bodies[0]: box.dpa has no springs' run wrong.json --device sim --ticks 5
succeeds 'compile a volume' compile box.ply -o volume.dpa --springs volume --spacing 0.02
echo '{ "bodies": [ { "mesh": "volume.dpa", "physics": { "response": "displace" } } ], "tool": { "law": "bed" } }' >wrong.json
refuses 'a volume' 'wrong.json: bodies[0]: response: displace is for' run wrong.json --device sim --ticks 5
sheet='"shape": "membrane", "triangles": 200, "material": { "kind": "sheet" }'
echo "{ \"bodies\": [ { $sheet, \"physics\": { \"response\": \"displace\" } } ], \"tool\": { \"law\": \"bed\" } }" >wrong.json
refuses 'a thread for it' 'bodies[0] is displaced by the tool' run wrong.json --device sim --ticks 9 --physics 500

# --- What a scene has.
wrong ': must be an object; it is a list' '[]'
wrong ': there are no bodies' '{}'
wrong ": there is no key 'gravitation'" '{ "bodies": [ { "shape": "box" } ], "gravitation": 0 }'
wrong ": there is no key 'gr?????'" '{ "bodies": [ { "shape": "box" } ], "gr\u0007\u00e9\u00e9": 0 }'
wrong ': bodies: must be a list; it is an object' '{ "bodies": {} }'
wrong ': bodies: has 0 items; there must be 1 to 64' '{ "bodies": [] }'
wrong ': bodies[1]: must be an object; it is null' '{ "bodies": [ { "shape": "box" }, null ] }'
wrong ': bodies: its shapes have 10050332 triangles; at most 10000000 together' \
    '{ "bodies": [ { "shape": "liver" }, { "shape": "torus", "triangles": 10000000 } ] }'
in_scene 'gravity: must be 0 to 1000; it is -9.81' '"gravity": -9.81'
in_scene 'gravity: must be 0 to 1000; it is 1e+300' '"gravity": 1e300'
in_scene 'gravity: must be a number; it is a text' '"gravity": "9.81"'
in_scene 'gravity: must be a number; it is null' '"gravity": null'

# --- A body.
in_body ': needs a mesh or a shape, and not both' '"rigid": true'
in_body ': needs a mesh or a shape, and not both' '"mesh": "a.dpa", "shape": "box"'
in_body ": there is no key 'Shape'" '"Shape": "box"'
in_body ".shape: 'boxes' is no shape of dynpoint make" '"shape": "boxes"'
in_body '.shape: must be a text; it is a number' '"shape": 1'
in_body '.triangles: must be a whole number' '"shape": "box", "triangles": 12.0'
in_body '.triangles: must be 1 to 10000000; it is 0' '"shape": "box", "triangles": 0'
in_body '.triangles: must be 1 to 10000000; it is -12' '"shape": "box", "triangles": -12'
in_body '.triangles: is for a shape' '"mesh": "a.dpa", "triangles": 12'
in_body ': box can only have 12 k^2 triangles' '"shape": "box", "triangles": 13'
in_body ': torus needs the number of triangles' '"shape": "torus"'
in_body '.rigid: must be true or false; it is a number' '"shape": "box", "rigid": 1'
in_body ': a shape that gives way needs a material' '"shape": "box", "rigid": false'
in_body ': a shape that gives way needs a material' '"shape": "box", "physics": {}'
in_body '.rigid: what has a material gives way' '"shape": "membrane", "rigid": true, "material": { "kind": "sheet" }'
in_body '.physics: is for a body that gives way' '"mesh": "a.dpa", "rigid": true, "physics": {}'
in_body '.material: is for a shape' '"mesh": "a.dpa", "material": { "kind": "sheet" }'
in_body '.position: has 2 items; there must be 3' '"shape": "box", "position": [0, 0]'
in_body '.position[2]: must be a number; it is true' '"shape": "box", "position": [0, 0, true]'
in_body '.position[1]: must be -1e+06 to 1e+06; it is 2e+06' '"shape": "box", "position": [0, 2e6, 0]'
in_body '.orientation: a quaternion w, x, y, z has the length 1; this has 2' '"shape": "box", "orientation": [1, 1, 1, 1]'
in_body '.orientation: a quaternion w, x, y, z has the length 1; this has 0' '"shape": "box", "orientation": [0, 0, 0, 0]'
in_body '.colour: has red, green and blue from 0 to 1' '"shape": "box", "colour": [0, -0.1, 0]'
in_scene "tool.look: 'axe' is none of: none, stylus, needle, scalpel, forceps, laparoscope" '"tool": { "look": "axe" }'
in_body ".look: 'wood' is none of: organ, cloth, bone" '"shape": "box", "look": "wood"'
in_body '.colour[0]: must be -1 to 1; it is 255' '"shape": "box", "colour": [255, 0, 0]'

# --- Its material.
in_body '.material: needs a kind, sheet or volume' '"shape": "box", "material": {}'
in_body ".material.kind: 'solid' is none of: sheet, volume" '"shape": "box", "material": { "kind": "solid" }'
in_sheet '.young: must be above 0, at most 1e+12; it is 0' '"young": 0'
in_sheet '.density: must be above 0, at most 1e+09; it is -1' '"density": -1'
in_sheet '.drag: must be 0 to 1e+09; it is -1' '"drag": -1'
in_sheet '.viscosity: must be 0 to 1e+09; it is 1e+10' '"viscosity": 1e10'
in_sheet '.thickness: must be above 0' '"thickness": 0'
in_sheet '.bending: must be 0 to 1e+12' '"bending": -1'
in_sheet '.spacing: is for a volume' '"spacing": 0.01'
in_volume '.thickness: is for a sheet' '"thickness": 0.01'
in_volume '.bending: is for a sheet' '"bending": 0'
in_volume '.spacing: must be above 0' '"spacing": 0'
in_sheet '.poisson: is for a volume' '"poisson": 0.3'
in_volume '.poisson: must be 0.1 to 0.45; it is 0.5' '"poisson": 0.5'
in_sheet '.regions: must be a list' '"regions": {}'
in_sheet '.regions: has 1001 items; there must be 0 to 1000' "\"regions\": [ $(awk 'BEGIN { for (i = 0; i < 1000; i++) printf "0," }')0 ]"
in_region ': needs a box or a sphere, and not both' '"fixed": true'
in_region ': needs a box or a sphere, and not both' '"box": [0, 0, 0, 1, 1, 1], "sphere": [0, 0, 0, 1], "fixed": true'
in_region ': is neither fixed nor of another material' '"box": [0, 0, 0, 1, 1, 1]'
in_region ': what is fixed has no material' '"box": [0, 0, 0, 1, 1, 1], "fixed": true, "drag": 1'
in_region '.box: is empty' '"box": [0, 0, 0, 1, -1, 1], "fixed": true'
in_region '.box: has 4 items; there must be 6' '"box": [0, 0, 0, 1], "fixed": true'
in_region '.sphere: its radius must be above 0' '"sphere": [0, 0, 0, 0], "fixed": true'
in_region '.young: must be above 0' '"sphere": [0, 0, 0, 1], "young": -5'
in_body ': membrane: region 1 holds nothing' \
    "$square, \"material\": { \"kind\": \"sheet\", \"regions\": [ { \"sphere\": [5, 0, 0, 1], \"fixed\": true } ] }"
in_body ': membrane: all of the body is fixed' \
    "$square, \"material\": { \"kind\": \"sheet\", \"regions\": [ { \"sphere\": [0, 0, 0, 1], \"fixed\": true } ] }"
wrong ': bodies[0] is too stiff: ' \
    "{ \"bodies\": [ { $square, \"material\": { \"kind\": \"sheet\", \"young\": 1e12 } } ] }"

# --- Its physics and its surface.
in_physics ".integrator: 'rk4' is none of: symplectic, euler, implicit" '"integrator": "rk4"'
in_physics '.iterations: is for a body with "integrator": "implicit"' '"iterations": 2'
in_physics '.iterations: must be 1 to 1024; it is 0' '"integrator": "implicit", "iterations": 0'
in_physics '.iterations: must be a whole number' '"integrator": "implicit", "iterations": 2e0'
in_physics '.sleep_speed: must be 0 to 1e+06; it is -1' '"sleep_speed": -1'
in_physics ".response: 'push' is none of: load, displace" '"response": "push"'
in_physics '.response: displace is for the laws point and bed' '"response": "displace"'
in_physics '.load_radius: must be above 0' '"load_radius": 0'
in_physics '.period: must be 0 to 1000; it is 1001' '"period": 1001'
in_body '.physics.response: displace is for a sheet' \
    '"shape": "liver", "triangles": 200, "material": { "kind": "volume" }, "physics": { "response": "displace" }'
in_surface '.static_friction: must be 0 to 10; it is 11' '"static_friction": 11'
in_surface '.kinetic_friction: must be 0 to 0.3; it is 0.4' '"static_friction": 0.3, "kinetic_friction": 0.4'
in_surface '.kinetic_friction: must be 0 to 0; it is 0.1' '"kinetic_friction": 0.1'
in_surface '.stiffness: must be 0 to 1e+09' '"stiffness": -1'
in_surface '.side_limit: must be 0 to 1e+06' '"side_limit": -1'
in_surface '.unfelt: must be true or false; it is a text' '"unfelt": "yes"'
in_surface '.puncture_force: must be 0 to 1e+06' '"puncture_force": -1'
in_surface '.toughness: must be 0 to 1e+09' '"toughness": 1e10'
in_surface '.cutting_force: must be 0 to 1e+06' '"cutting_force": -1'
in_surface '.shaft_friction: must be 0 to 1e+06' '"shaft_friction": -1'
in_surface '.shaft_viscosity: must be 0 to 1e+06' '"shaft_viscosity": -1'
in_surface '.shaft_stiffness: must be 0 to 1e+12' '"shaft_stiffness": -1'

# --- Needles.
in_scene 'tool.dress: is in place of a look' '"tool": { "look": "needle", "dress": [ { "mesh": "a.obj" } ] }'
in_scene 'tool.dress: has 0 items; there must be 1 to 8' '"tool": { "dress": [] }'
in_scene 'tool.dress[0]: needs a mesh' '"tool": { "dress": [ { "scale": 1 } ] }'
in_scene 'tool.dress[0].scale: must be above 0' '"tool": { "dress": [ { "mesh": "a.obj", "scale": 0 } ] }'
in_scene 'tool.dress[0]: axis and open are for a part with a hinge' '"tool": { "dress": [ { "mesh": "a.obj", "open": 1 } ] }'
in_scene 'tool.dress[0].axis: is no direction' '"tool": { "dress": [ { "mesh": "a.obj", "hinge": [0,0,0], "axis": [0,0,0] } ] }'
in_scene 'tool.dress[0].colour: has a number below 0' '"tool": { "dress": [ { "mesh": "a.obj", "colour": [0,-1,0] } ] }'
in_scene 'tool.dress[0]: a.obj: ' '"tool": { "dress": [ { "mesh": "a.obj" } ] }'
in_scene 'tool.jaw: is for the tool of an arm' '"tool": { "look": "needle", "jaw": { "to": 1 } }'
in_scene 'tool.port: is for a stylus that has a length' '"tool": { "port": [0, 0.2, 0], "length": 0 }'
in_scene 'tool.port: is for a stylus that has a length' \
    '"tool": { "port": [0, 0.2, 0], "segments": [ { "a": [0,0,0], "b": [0,0.1,0], "radius": 0.001 } ] }'
in_scene 'tool.port[1]: must be' '"tool": { "port": [0, 1e9, 0] }'
in_scene "tool.port is where the device's origin is" '"tool": { "port": [0, 0.2, 0] }, "device": { "origin": [0, 0.2, 0] }'
in_scene "view.inset: there is no key 'inset'" \
    '"view": { "position": [1,0,0], "target": [0,0,0], "inset": { "position": [1,0,0], "target": [0,0,0], "inset": {} } }'
in_scene 'view.inset: needs a position and a target' \
    '"view": { "position": [1,0,0], "target": [0,0,0], "inset": { "position": [1,0,0] } }'
in_scene "tool.piercing: 'tip' is none of: none, a, b" '"tool": { "piercing": "tip" }'
in_scene 'tool.piercing: is for a stylus or one segment, without tips' \
    '"tool": { "piercing": "a", "segments": [ { "a": [0,0,0], "b": [0,0.1,0], "radius": 0.001 },
{ "a": [0,0,0], "b": [0.1,0,0], "radius": 0.001 } ] }'
in_scene 'a tool pierces by the law proxy alone (tool.law, --law)' '"tool": { "piercing": "a", "law": "bed" }'
in_scene 'a needle has a length and a radius above 0' '"tool": { "piercing": "a", "radius": 0 }'
wrong ': bodies[0] is displaced: needles pierce bodies that are pushed by loads' \
    "{ \"bodies\": [ { $square, \"material\": { \"kind\": \"sheet\" }, \"physics\": { \"response\": \"displace\" },
\"surface\": { \"puncture_force\": 1 } } ], \"tool\": { \"law\": \"bed\" } }"

# --- Tool.
in_scene 'tool: must be an object; it is a text' '"tool": "stylus"'
in_scene 'tool.length: must be 0 to 10' '"tool": { "length": -1 }'
in_scene 'tool.radius: must be 0 to 1; it is 2' '"tool": { "radius": 2 }'
in_scene 'tool: is one of these' '"tool": { "radius": 0.002, "arm": "arm.dpa" }'
in_scene "tool.law: 'paper' is none of: point, bed, proxy" '"tool": { "law": "paper" }'
in_scene 'tool.segments: has 0 items; there must be 1 to 64' '"tool": { "segments": [] }'
in_scene 'tool.segments[0]: needs a, b and radius' '"tool": { "segments": [ { "a": [0, 0, 0], "b": [0, 0, 1] } ] }'
in_scene 'tool.segments[0].radius: must be 0 to 1' \
    '"tool": { "segments": [ { "a": [0, 0, 0], "b": [0, 0, 1], "radius": -0.1 } ] }'
echo '{ "bodies": [ { "shape": "box" } ], "tool": { "segments": [ { "a": [0,0,0], "b": [0,0,1], "radius": 0.01 } ] } }' >wrong.json
refuses 'a radius of segments' '--length and --radius are for a stylus; its tool is segments' \
    run wrong.json --device sim --ticks 5 --radius 0.1
# --- Its tips.
in_tips() { in_scene "tool.tips$1" "\"tool\": { \"tips\": $2 }"; }
in_tip() { in_tips "[1]$1" "[ { $cone }, { $2 } ]"; }
cone='"shape": "cone", "extent": [0.01, 0, 0.02]'
in_tips ': must be a list; it is an object' "{ $cone }"
in_tips ': has 0 items; there must be 1 to 16' '[]'
in_tips ': has 17 items; there must be 1 to 16' "[ $(awk 'BEGIN { for (i = 0; i < 16; i++) printf "0," }')0 ]"
in_tips '[0]: must be an object; it is a text' '[ "box" ]'
in_tip ': needs a shape and an extent' ''
in_tip ': needs a shape and an extent' '"shape": "box"'
in_tip ': needs a shape and an extent' '"extent": [0.01, 0.01, 0.01]'
in_tip ": there is no key 'size'" "$cone, \"size\": 1"
in_tip ".shape: 'ball' is none of: box, wedge, cylinder, cone" '"shape": "ball", "extent": [0.01, 0.01, 0.01]'
in_tip '.shape: must be a text; it is a number' '"shape": 1, "extent": [0.01, 0.01, 0.01]'
in_tip '.extent: must be a list; it is a number' '"shape": "box", "extent": 0.01'
in_tip '.extent: has 2 items; there must be 3' '"shape": "box", "extent": [0.01, 0.01]'
in_tip '.extent[2]: must be a number; it is null' '"shape": "box", "extent": [0.01, 0.01, null]'
in_tip '.extent[0]: must be 0 to 10; it is -0.01' '"shape": "box", "extent": [-0.01, 0.01, 0.01]'
in_tip '.extent[1]: must be 0 to 10; it is 11' '"shape": "wedge", "extent": [0.01, 11, 0.01]'
in_tip '.extent[2]: must be 0 to 10; it is 1e+300' '"shape": "box", "extent": [0.01, 0.01, 1e300]'
in_tip '.extent[1]: is the diameter, as along x, or 0: a cone is round' '"shape": "cone", "extent": [0.01, 0.02, 0.02]'
in_tip '.extent[1]: is the diameter, as along x, or 0: a cylinder is round' '"shape": "cylinder", "extent": [0, 0.02, 0.02]'
in_tip '.radius: must be 0 to 1; it is -0.001' "$cone, \"radius\": -0.001"
in_tip '.radius: must be 0 to 1; it is 2' "$cone, \"radius\": 2"
in_tip '.radius: must be a number; it is a text' "$cone, \"radius\": \"0\""
in_tip '.sides: is for a cylinder or a cone' '"shape": "box", "extent": [0.01, 0.01, 0.01], "sides": 4'
in_tip '.sides: is for a cylinder or a cone' '"shape": "wedge", "extent": [0.01, 0.01, 0.01], "sides": 4'
in_tip '.sides: must be 3 to 63; it is 2' "$cone, \"sides\": 2"
in_tip '.sides: must be 3 to 63; it is 64' "$cone, \"sides\": 64"
in_tip '.sides: must be 3 to 32; it is 33' '"shape": "cylinder", "extent": [0.01, 0.01, 0.02], "sides": 33'
in_tip '.sides: must be a whole number' "$cone, \"sides\": 8.0"
in_tip '.at: has 2 items; there must be 3' "$cone, \"at\": [0, 0]"
in_tip '.at[2]: must be -10 to 10; it is 11' "$cone, \"at\": [0, 0, 11]"
in_tip '.orientation: has 3 items; there must be 4' "$cone, \"orientation\": [1, 0, 0]"
in_tip '.orientation: a quaternion w, x, y, z has the length 1; this has 1.41421' "$cone, \"orientation\": [1, 1, 0, 0]"
in_tip ': it is too thin' '"shape": "box", "extent": [0.01, 0, 0]'
in_tip ': it is too thin' '"shape": "box", "extent": [0, 0, 0], "radius": 0.01'
in_tip ': it is too thin' '"shape": "cylinder", "extent": [0, 0, 0.01]'
egg='"shape": "ellipsoid", "extent": [0.01, 0.02, 0.03]'
in_tip '.sides: must be 3 to 12; it is 13' "$egg, \"sides\": 13"
in_tip '.sides: must be 3 to 15; it is 2' '"shape": "capsule", "extent": [0.01, 0, 0.03], "sides": 2'
in_tip '.sides: must be 3 to 32; it is 33' '"shape": "curved-cylinder", "extent": [0.01, 0, 0.03], "sides": 33'
in_tip '.sides: must be 3 to 63; it is 64' '"shape": "curved-cone", "extent": [0.01, 0, 0.03], "sides": 64'
in_tip '.extent: has 4 items; there must be 3' '"shape": "ellipsoid", "extent": [0.01, 0.02, 0.03, 0.04]'
in_tip '.extent[0]: must be 0 to 10; it is 11' '"shape": "ellipsoid", "extent": [11, 0.02, 0.03]'
in_tip '.extent[1]: is the diameter, as along x, or 0: a capsule is round' '"shape": "capsule", "extent": [0.01, 0.02, 0.03]'
echo "{ \"bodies\": [ { \"shape\": \"box\" } ], \"tool\": { \"tips\": [ { $egg } ] } }" >wrong.json
run run wrong.json --device sim --ticks 1
if test $status -eq 0; then
    in_tip ': it is curved: it has no radius beside its lengths' "$egg, \"radius\": 0.001"
    in_tip ': its lengths must be above 0, and none 10,000 times another' '"shape": "ellipsoid", "extent": [0.01, 0, 0.03]'
    in_tip ': its lengths must be above 0, and none 10,000 times another' '"shape": "curved-cone", "extent": [10, 0, 0.0009]'
    in_tip ': a capsule is at least as long as it is wide' '"shape": "capsule", "extent": [0.02, 0, 0.01]'
    in_scene 'tips are felt by the law proxy alone' "\"tool\": { \"tips\": [ { $egg }, { $cone } ], \"law\": \"point\" }"
    wrong ': bodies[1] gives way: by the laws point and bed curved tips feel rigid bodies alone (tool.law, --law)' \
        "{ \"bodies\": [ { \"shape\": \"box\" }, { \"shape\": \"membrane\", \"triangles\": 8, \"material\": { \"kind\": \"sheet\" } } ],
\"tool\": { \"law\": \"point\", \"tips\": [ { $egg } ] } }"
else
    in_tip ': this build has no curved tips: install libccd (Debian: libccd-dev pkg-config) and run make again, without CONVEX=no' "$egg"
fi
in_scene 'tips are felt by the law proxy alone (tool.law, --law)' "\"tool\": { \"tips\": [ { $cone } ], \"law\": \"bed\" }"
wrong ":2:87: duplicate object key near '\"at\"'" "{ \"bodies\": [ { \"shape\": \"box\" } ],
\"tool\": { \"tips\": [ { $cone, \"at\": [0, 0, 0], \"at\": [0, 0, 0] } ] } }"
wrong ": bodies[0]: there is no key 'tips'" "{ \"bodies\": [ { \"shape\": \"box\", \"tips\": [] } ] }"

# --- Device and view.
in_scene 'device.url: must be a text' '"device": { "url": 1 }'
in_scene "device: there is no key 'name'" '"device": { "name": "sim" }'
in_scene 'device.zoom: must be above 0, at most 1000' '"device": { "zoom": 0 }'
in_scene 'device.force_scale: must be 0.001 to 1000' '"device": { "force_scale": 0 }'
in_scene 'device.origin: has 1 items; there must be 3' '"device": { "origin": [0] }'
in_scene 'device.clutch: must be 0 to 31; it is 32' '"device": { "clutch": 32 }'
in_scene 'view: needs a position and a target' '"view": {}'
in_scene 'view: looks nowhere' '"view": { "position": [1, 1, 1], "target": [1, 1, 1] }'
in_scene 'view: looks nowhere, or up and ahead are one line' '"view": { "position": [0, 1, 0], "target": [0, 0, 0] }'
in_scene 'view.up[1]: must be a number' '"view": { "position": [0, 0, 1], "target": [0, 0, 0], "up": [0, null, 0] }'
finish
