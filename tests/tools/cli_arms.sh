#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Robots' descriptions, and the arms that are compiled from them.
# `sh tests/tools/cli_arms.sh BUILD`.
. "$(dirname "$0")/cli.sh"

# Robots' descriptions, and arms.
descriptions()
{
    sample=$tests/../docs/samples/arm.urdf golden=$tests/golden-urdf
    run compile "$sample" -o arm.dpa
    if [ $status -eq 2 ] && grep -q 'this build reads no URDF' stderr; then
        is_refusal 'install urdfdom and a C++ compiler'
        check "a build without URDF: $reason" test $? -eq 0
        skip "robots' descriptions: this build has no urdfdom"
        return
    fi
    check "compile arm.urdf: exit $status: $(cat stderr)" test $status -eq 0 -a ! -s stderr
    check "report: $(cat stdout)" grep -q \
        '^arm.dpa: arm arm, 3 joints, tool stylus of 1 capsule, 1 body, 0.8 kg' stdout
    succeeds 'info of an arm' info arm.dpa
    for line in 'joint 1 shoulder .* -17.1887 .. 80.2141 degrees, 1.5 Nm, 20 rad/s' \
        'link 2  on link 1, turns about (0, -1, 0) by elbow, 0.15 kg' 'tool stylus on link 2' \
        'capsule (0, 0, -0.106) to (0, 0, 0.006) m, radius 0.004 m' \
        'body desk at (0, 0, -0.01) m, 12 triangles'; do
        check "info: $line" grep -q "$line" stdout
    done
    if python3 -c 'import json' 2>python.log; then
        run info arm.dpa --json
        mv stdout info.json
        check "info --json of an arm: $(tail -n 1 python.log)" has_keys info.json arm root joints links \
            tool.name tool.link tool.position tool.orientation tool.capsules bodies mass source.bytes \
            source.hash format bytes
        sed 's/name="elbow"/name="e\&quot;l\\b"/' "$sample" >quotes.urdf
        succeeds 'a name with quotes' compile quotes.urdf -o quotes.dpa
        run info quotes.dpa --json
        check 'a name with quotes in JSON' python3 -c 'import json, sys
sys.exit(json.load(open("stdout"))["joints"][2]["name"] != "e\"l\\b")'
    else
        skip 'JSON of an arm: no python3'
    fi
    run info arm.dpa --verify
    check "info --verify of an arm: $(cat stdout)" test $status -eq 0
    { head -c 700 arm.dpa; printf '\377'; tail -c +702 arm.dpa; } >damaged.dpa
    run info damaged.dpa --verify
    check "info --verify of a damaged arm: $(cat stdout)" test $status -eq 1
    refuses 'info of a damaged arm' 'damaged.dpa: byte' info damaged.dpa
    refuses 'replay of an arm' 'not of the kind asked for' replay arm.dpa torus.csv -o out/x

    cp "$sample" robot.txt
    succeeds 'a description by its content' compile robot.txt -o other.dpa
    check 'and the same bytes' cmp -s arm.dpa other.dpa
    succeeds 'to standard output' compile "$sample" -o -
    check 'with the same bytes' cmp -s arm.dpa stdout
    refuses 'a description without robot' 'not a URDF' compile "$golden/sdf.urdf" -o out/x
    echo '<COLLADA/>' >mesh.dae
    refuses 'a mesh in XML' 'mesh.dae: this is COLLADA: python3 -c' compile mesh.dae -o out/x
    refuses 'the line of a refusal' 'zero_axis.urdf:14: joint' \
        compile "$golden/zero_axis.urdf" -o out/x
    refuses 'notes of what is refused' "arm.urdf: there is no link 'nonesuch'" \
        compile "$sample" -o out/x --tool nonesuch
    for option in '--tool tip' '--packages .' '--skip tip' --without-scene; do
        # shellcheck disable=SC2086
        refuses "$option with a mesh" '--tool, --packages, --skip and --without-scene are for a URDF' \
            compile box.ply -o out/x $option
    done
    succeeds 'notes' compile "$golden/extensions.urdf" -o noted.dpa
    check "notes: $(cat stderr)" grep -q \
        'extensions.urdf:[0-9]*: note: <transmission> in <robot> is left out, 2 times' stderr
    run compile "$golden/limit_without_upper.urdf" -o noted.dpa
    check "a joint without upper: $(cat stderr)" grep -q \
        "limit_without_upper.urdf:14: note: joint 'elbow' has no upper limit: it is 0" stderr
    check "an arm without masses: $(cat stderr)" grep -q \
        "limit_without_upper.urdf:8: note: no link from joint 'shoulder' on has a mass" stderr
    check 'and it is compiled' test $status -eq 0
    notes 'an arm with masses and limits' '' compile "$golden/masses.urdf" -o noted.dpa
    succeeds 'another tool' compile "$sample" -o forearm.dpa --tool upper_arm
    check "another tool: $(cat stdout)" grep -q ' 2 joints, tool upper_arm of 0 capsules' stdout
    printf '<robot name="r"><link name="b"><collision><geometry><mesh filename="%s"/></geometry>' \
        'package://plates/meshes/large%20plate.obj' >plate.urdf
    printf '</collision></link><link name="t"/><joint name="j" type="continuous"><parent link="b"/>' \
        >>plate.urdf
    echo '<child link="t"/></joint></robot>' >>plate.urdf
    refuses 'a package that is not found' 'is not found: name the folder that holds the package by --packages' \
        compile plate.urdf -o out/x
    mkdir -p prefix/share && cp -r "$golden/packages/plates" prefix/share
    for found in "ROS_PACKAGE_PATH=/nowhere:$golden/packages" "ROS_PACKAGE_PATH=$golden/packages/plates" \
        "AMENT_PREFIX_PATH=/nowhere:$PWD/prefix"; do
        env "$found" "$program" compile plate.urdf -o plate.dpa >stdout 2>stderr
        status=$?
        check "$found: $(cat stderr)" test $status -eq 0
    done
    sed 's/package[^"]*/base.dae/' plate.urdf >collada.urdf
    refuses 'COLLADA in the scene' "'base.dae' is COLLADA: make it an STL (docs/urdf.md#collada-and-gltf), or leave it out: --skip" \
        compile collada.urdf -o out/x
    sed 's/package[^"]*/base.glb/' plate.urdf >gltf.urdf
    refuses 'glTF in the scene' "'base.glb' is glTF: make it an STL" compile gltf.urdf -o out/x
    succeeds '--skip' compile collada.urdf -o skipped.dpa --skip t --skip b
    succeeds '--without-scene' compile collada.urdf -o bare.dpa --without-scene
    refuses '--skip of no link' "there is no link 'c' to skip" compile collada.urdf -o out/x --skip c
    succeeds '--packages' compile plate.urdf -o plate.dpa --packages "$golden/packages" --scale 0.5
    check "--packages: $(cat stdout)" grep -q ' 1 body' stdout
    # A ':' behind a drive's letter is no end of a path, and one letter is a folder too.
    mkdir -p C:/ros c && cp -r "$golden/packages/plates" C:/ros && cp -r "$golden/packages/plates" c && cp arm.dpa C:/
    for folders in C:/ros nowhere:C:/ros "C:/ros:$golden" "C:/nowhere:$golden/packages" "c:$golden" "c:/nowhere"; do
        succeeds "--packages $folders" compile plate.urdf -o plate.dpa --packages "$folders"
    done
    cp box.csv C:/box.csv
    run device watch 'replay:C:/box.csv'
    check "a device of a drive's file: $(cat stderr)" grep -q '^0,ready,0.062,' stdout
    run device watch 'replay:C:/nowhere.csv'
    check "a drive's file: $(cat stderr)" grep -q 'C:/nowhere.csv: C:/nowhere.csv: No such file' stderr
    run run box.dpa --device 'can:nowhere?arm=C:/nowhere.dpa&gear=8,8,8' --ticks 5
    check "a setting with a drive: $(cat stderr)" grep -qF 'C:/nowhere.dpa: ' stderr
    run run box.dpa --device 'can:nowhere?arm=C:/arm.dpa&gear=8,8,8' --ticks 5
    check "a setting with a drive: $(cat stderr)" test $status -eq 2 -a "$(grep -c 'No such file' stderr)" -eq 0
    succeeds 'a tool on a drive' run box.dpa --tool C:/arm.dpa --device 'sim:?hand=press' --ticks 5

    # The desk's top is at 0, y of the device is up there: the capsule, 4 mm thick, lies along the device's z.
    run run arm.dpa --device sim --at 0.2,0,0.003 --ticks 1 --law point --stiffness 500 --json
    check "a millimetre in the desk: $(cat stdout)" grep -q \
        '"contacts":1,"penetrating":1,"unknown":0,"deepest":0.000999999[0-9]*,"strongest":0.4999998' stdout
    run run arm.dpa --device sim --at 0.35,0,0.003 --ticks 1 --json
    check "beside the desk, away from it: $(cat stdout)" grep -q '"contacts":0,' stdout
    run run arm.dpa --device sim --at 0.2,0,0.003 --ticks 2000 --law point --json
    check "it is pushed out upward: $(cat stdout)" grep -qE '"contacts":[1-9][0-9]{0,2},' stdout
    run run arm.dpa --device 'sim:?hand=press' --at 0.2,0,0.01 --ticks 3000 --json
    check "a hand presses on the desk: $(cat stdout)" grep -qE '"penetrating":[12][0-9]{3},' stdout
    run run box.dpa --tool arm.dpa --device 'sim:?hand=press' --ticks 3000 --json
    check "the arm's tool on a mesh: $(cat stdout)" grep -qE '"penetrating":[12][0-9]{3},' stdout
    {
        echo '<robot name="six"><link name="l0"><collision><geometry><box size="1 1 0.02"/></geometry></collision></link>'
        for i in 1 2 3 4 5 6; do
            echo "<link name='l$i'><collision><geometry><sphere radius='0.01'/></geometry></collision></link>" \
                "<joint name='j$i' type='revolute'><parent link='l$((i - 1))'/><child link='l$i'/><origin xyz='0 0 0.1'/>" \
                "<limit lower='-1' upper='1' effort='1' velocity='20'/></joint>"
        done
        echo '</robot>'
    } >six.urdf
    succeeds 'an arm of six joints' compile six.urdf -o six.dpa
    run run six.dpa --device 'sim:?hand=press&dofs=6' --at 0,0,0.03 --ticks 3000 --json
    check "another device's six joints are not its own: $(cat stdout)" grep -q '"penetrating":[1-9]' stdout
    refuses 'a record of the arm' '--record needs the stylus, without tips: a trace has one segment' \
        run arm.dpa --device sim --ticks 5 --record out/r.csv
    refuses 'a scene without a body' 'whose scene has no body' run noted.dpa --device sim --ticks 5
    refuses 'a tool without a shape' 'its tool has no capsule, and no tip that is felt' \
        run box.dpa --tool plate.dpa --device sim --ticks 5
    refuses 'a URDF that is not compiled' 'dynpoint compile makes one' run "$sample" --device sim
    refuses 'a mesh as tool' 'box.dpa: byte 0 (header): not a dynpoint file' \
        run box.dpa --tool box.dpa --device sim --ticks 5

    succeeds '--c-array of an arm' compile "$sample" -o arm.c --c-array arm_bytes
    check '--c-array tells how to open it' grep -q \
        'A dynpoint arm of [0-9]* bytes: dpt_arm_open(arm_bytes, arm_bytes_size, &arm)' arm.c
    cat >opens_arm.c <<'C'
#include <dynpoint.h>
#include <stdint.h>
extern const uint64_t arm_bytes[];
extern const size_t arm_bytes_size;
int main(void)
{
    const dpt_arm *arm;
    return dpt_arm_open(arm_bytes, arm_bytes_size, &arm);
}
C
    rm -f opens_arm
    for runtime in '' '-fsanitize=address,undefined'; do
        # shellcheck disable=SC2086
        ${CC:-cc} -std=c99 $runtime -I"$tests/../include" opens_arm.c arm.c "$build/libdynpoint.a" -lm \
            -o opens_arm 2>cc.log && break
    done
    check "--c-array of an arm: $(tail -n 1 cc.log)" ./opens_arm
}

prepare
descriptions
finish
