#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Plans: what is chosen, that its promise holds where it was not measured, that the next cheaper setting breaks what it is
# said to break, and what is refused. `sh tests/tools/cli_plan.sh BUILD [part]`.
. "$(dirname "$0")/cli.sh"

# edited FROM WORD TO: a copy of the torus' plan
edited()
{
    sed "s/$1/$2/" torus.json >edited.json
    check "the plan has $1" test "$(cmp torus.json edited.json | wc -l)" -eq 1
}

# breaks WHAT BOUND ARGUMENT...: replay --check says no, and names the bound
breaks()
{
    what=$1 bound=$2
    shift 2
    run replay --check "$@"
    check "$what: exit $status, $(tail -n 1 stdout) $(cat stderr)" test $status -eq 1
    check "$what: not '$bound' but $(tail -n 1 stdout)" grep -q "^[^ ]*: broken: $bound: " stdout
}

# holds WHAT ARGUMENT...
holds()
{
    what=$1
    shift
    run replay --check "$@"
    check "$what: exit $status, $(tail -n 1 stdout) $(cat stderr)" test $status -eq 0
    check "$what: $(tail -n 1 stdout)" grep -q '^[^ ]*: holds over [0-9]* ticks$' stdout
}

# json FILE EXPRESSION: of its object p, true or false
json()
{
    python3 -c '
import json, sys
p = json.load(open(sys.argv[1]))
sys.exit(not eval("(" + sys.argv[2] + ")"))' "$1" "$2" 2>python.log
}

chosen()
{
    succeeds 'plan torus' plan torus.dpa --error 0.1mm --force-error 0.05N --rate 0.5kHz --ticks 10000 \
        -o torus.json --header torus.h
    cp stdout torus.txt
    check "the first thing: $(head -n 1 torus.txt)" grep -qx 'torus.dpa, law proxy, at 500 Hz' torus.txt
    check 'a force is needed' grep -q '^  until  *respond  *track: the force is [0-9.]* N off, at most 0.05 N$' torus.txt
    check 'a proxy needs no contacts' grep -q '^  max_contacts  *0 ' torus.txt
    check 'next cheaper' grep -q "^  next cheaper: [a-z_]* [0-9a-z]* breaks the bound '[a-z]*' (" torus.txt
    check 'next better' grep -q '^  next better: max_contacts [0-9]*, ' torus.txt
    check 'what is in it' has_keys_of torus.json scene scene_crc32 meshes motion.speed asked.error \
        setting.budget setting.margin promises.time_p999 promises.speed does_not_promise measured.work_p999 \
        machine.processor machine.system machine.kernel machine.compiler machine.version cheaper.knob better.figures.bytes
    check 'margin: a tick of 1.5 times the fastest motion' json torus.json \
        'abs(p["setting"]["margin"] - 3e-3 * p["motion"]["speed"]) < 1e-12'
    check 'the budget is 3 times one that held' json torus.json \
        'p["setting"]["budget"] >= 3 * p["measured"]["work"] * 2 ** -0.5'
    check 'the next cheaper is the last that was refused' json torus.json 'p["cheaper"]["knob"] == "budget"'
    check 'within what was asked for' json torus.json 'p["measured"]["force_error"] <= 0.05 and
p["measured"]["distance_error"] <= 1e-4 and p["measured"]["unknown"] <= p["measured"]["ticks"] / 10000 and
p["measured"]["time_p999"] <= 0.001'
    check 'no stability without a device' json torus.json '"stability: no identified device was given" in p["does_not_promise"]'
    check 'half of the trace, backwards, and two others' json torus.json 'p["measured"]["ticks"] > 17000'
}

# A wall limits the margin. No force is asked for, which takes less time.
thin()
{
    succeeds 'a thin torus' compile torus.obj -o thin.dpa --scale 0.05
    succeeds 'plan a thin torus' plan thin.dpa --error 0.1mm --ticks 10000 -o thin.json --json
    check "--json: $(cat stdout)" has_keys stdout plan.setting plan.promises richest.time_p999 refused
    check 'it tells the plan, no limit, and what was refused' json stdout \
        'p["limit"] is None and p["plan"] == json.load(open("thin.json")) and {r["breaks"] for r in p["refused"]} and
all(r["knob"] and r["where"] for r in p["refused"])'
    refuses 'both want standard output' '--json and -o -' plan thin.dpa --error 0.1mm -o - --json
    check 'margin: a third of the thinnest wall' json thin.json '0.0038 < p["thinnest_wall"] < 0.004 and
abs(p["setting"]["margin"] - p["thinnest_wall"] / 3) < 1e-15'
    holds 'another seed' --plan thin.json --seed 21 --ticks 4000
    [ ! "$is_part" ] || return
    succeeds 'the same again' plan thin.dpa --error 100um --rate 1kHz --ticks 10000 -o again.json
    check 'the same setting' sh -c 'for f in thin again; do sed -n "/\"setting\": {/,/}/p" $f.json >$f.set; done; cmp -s thin.set again.set && test -s thin.set'
}

# has_keys_of FILE KEY...: as has_keys, of a file of many lines
has_keys_of()
{
    tr -d '\n' <"$1" >one.json && echo >>one.json
    shift
    has_keys one.json "$@"
}

# Other seeds, lengths and speeds up to the limit; and the printed neighbour.
promised()
{
    holds 'its own trace' --plan torus.json
    holds 'another seed' --plan torus.json --seed 21 --ticks 4000
    holds 'another seed, longer' --plan torus.json --seed 22 --ticks 16000
    holds 'faster' --plan torus.json --seed 23 --ticks 5000 --speed 0.4
    check "within the limit of speed: $(cat stdout)" test "$(grep -c 'nothing is promised' stdout)" -eq 0
    run replay --plan torus.json --seed 23 --ticks 2000 --speed 3
    check 'beyond the limit that is said' grep -q 'the trace moves at up to [0-9.]* m/s: beyond [0-9.]* nothing is promised' stdout
    succeeds 'another trace' make trace --mesh torus.dpa --ticks 3000 --seed 9 --length 0.1 -o other.csv
    holds 'a trace of a file' --plan torus.json other.csv
    bound=$(sed -n "s/^  next cheaper: .* breaks the bound '\([a-z]*\)'.*/\1/p" torus.txt)
    breaks "the next cheaper breaks $bound" "$bound" --plan torus.json --cheaper
    run replay --plan torus.json --cheaper --json
    check 'over the trace by which it was measured, tick for tick' python3 -c '
import json
told, was = json.load(open("stdout")), json.load(open("torus.json"))["cheaper"]["figures"]
assert all(told[key] == was[key] for key in ("ticks", "work_total", "distance_error", "force_error"))' 2>python.log
    run replay --plan torus.json --cheaper
    figure=$(awk '/there /{ f = $4 } END { print f }' torus.txt)
    check "the figures that were printed ($figure)" grep -q "^  the next cheaper *$figure " stdout
}

# A plan that was broken on purpose says so.
broken()
{
    edited '"budget": [0-9]*' '"budget": 40'
    breaks 'no budget' distance --plan edited.json
    edited '"distance": 0.000[0-9]*' '"distance": 1'
    sed 's/"budget": [0-9]*/"budget": 40/' edited.json >looser.json
    breaks 'no budget, no bound of distances' force --plan looser.json
    sed 's/"force": [0-9.]*/"force": 1000/' looser.json >looser2.json
    breaks 'nor of forces' unknown --plan looser2.json
    edited '"work_p999": [0-9]*' '"work_p999": 3'
    breaks 'fewer units' work --plan edited.json
    edited '"max_contacts": 0' '"max_contacts": 9'
    sed 's/"contacts": [0-9]*, "strip"/"contacts": 1, "strip"/' edited.json >looser.json
    breaks 'less room' contacts --plan looser.json
    edited '"time_p999": 0.001[0-9]*, "speed"' '"time_p999": 1e-9, "speed"'
    holds 'times are not looked at' --plan edited.json --seed 4 --ticks 500
    breaks 'with times' time --plan edited.json --seed 4 --ticks 500 --check=time
    sed 's/"processor": "[^"]*"/"processor": "a better one"/' edited.json >elsewhere.json
    holds 'on another machine' --plan elsewhere.json --seed 4 --ticks 500 --check=time
    check 'that is said' grep -qx '  time: not measured here, but on another processor' stdout
    run replay --plan torus.json --check --json --ticks 500 --seed 4
    check "as JSON: $(cat stdout python.log)" has_keys stdout plan ticks work_total busy broken times_count
}

# What the header fills in is the same world: the same units in every tick.
header()
{
    if ! command -v "${CC:-cc}" >/dev/null; then
        skip 'plan --header: no C compiler'
        return
    fi
    cat >felt.c <<'C'
#include "torus.h"
#include <stdio.h>
static uint64_t file[1 << 20], block[1 << 20];
int main(void)
{
    const dpt_mesh *mesh;
    dpt_world_def def;
    dpt_world *world;
    dpt_body body;
    dpt_tool tool;
    dpt_springs_def springs;
    dpt_body_settings surface = { .size = sizeof surface };
    dpt_tool_settings held = { .size = sizeof held };
    dpt_step step = { .size = sizeof step };
    dpt_segment stylus = { .radius = PLAN_RADIUS };
    unsigned long long work = 0;
    char line[400];
    FILE *stream = fopen("torus.dpa", "rb");
    size_t size = stream ? fread(file, 1, sizeof file, stream) : 0;
    plan_fill_world(&def);
    if (dpt_mesh_open(file, size, &mesh) || dpt_world_bytes(&def) > sizeof block ||
        dpt_world_create(block, sizeof block, &def, &world) || dpt_body_add(world, mesh, NULL, &body) ||
        dpt_tool_add(world, &stylus, 1, &tool))
        return 1;
    dpt_springs_def_init(&springs);
    dpt_body_get_settings(world, body, &surface);
    dpt_tool_get_settings(world, tool, &held);
    plan_fill_body(0, &surface);
    plan_fill_tool(&held);
    if (plan_fill_springs(0, &springs) || dpt_body_set_settings(world, body, &surface) ||
        dpt_tool_set_settings(world, tool, &held) || !held.near_only)
        return 2;
    stream = fopen("other.csv", "r");
    if (!stream || !fgets(line, sizeof line, stream))
        return 3;
    while (fscanf(stream, "%*d,%lf,%lf,%lf,%lf,%lf,%lf", stylus.a, stylus.a + 1, stylus.a + 2, stylus.b,
                  stylus.b + 1, stylus.b + 2) == 6) {
        dpt_tool_set_segments(world, tool, &stylus, 1);
        if (dpt_world_step(world, 1.0 / PLAN_RATE, &step))
            return 4;
        work += step.work;
    }
    printf("%llu\n", work);
    return 0;
}
C
    for runtime in '' -fsanitize=address,undefined --coverage; do
        # shellcheck disable=SC2086
        ${CC:-cc} -std=c99 -Wall -Wextra -Werror $runtime -I"$tests/../include" felt.c "$build/libdynpoint.a" -lm \
            -o felt 2>cc.log && break
    done
    check "plan --header compiles: $(tail -n 1 cc.log)" test -x felt
    run replay --plan torus.json other.csv --json
    told=$(sed -n 's/.*"work_total":\([0-9]*\).*/\1/p' stdout)
    check "the same world: $(./felt) units, $told by replay" test "$(./felt)" = "$told"
}

# What gives way: stiff beside what is asked for, it is rigid; else it gives way.
soft()
{
    cat >sheet.scene.json <<'J'
{ "bodies": [ { "shape": "membrane", "triangles": 72,
    "material": { "kind": "sheet", "young": 1e5, "thickness": 0.001, "drag": 10, "viscosity": 0.001,
      "regions": [ { "box": [-0.11, -0.11, -0.01, -0.0999, 0.11, 0.01], "fixed": true },
                   { "box": [0.0999, -0.11, -0.01, 0.11, 0.11, 0.01], "fixed": true } ] },
    "physics": { "integrator": "implicit", "iterations": 8, "load_radius": 0.05 } } ] }
J
    succeeds 'plan a soft sheet' plan sheet.scene.json --error 0.1mm --force-error 0.05N --rate 500 --ticks 10000 -o soft.json
    check "it gives way: $(grep rigid stdout)" grep -q '^  bodies\[0\] rigid  *gives way  *rigid: ' stdout
    check 'with fewer iterations than 8, or why not' grep -q '^  iterations ' stdout
    check 'in the file' json soft.json 'p["setting"]["rigid"] == []'
    check 'with no tick that ends early' json soft.json 'p["setting"]["budget"] == 4294967295'
    # 3 times those of the first half of its trace; all that was measured had these or more.
    check 'with room for 3 times the contacts' json soft.json \
        '(r := p["setting"]["max_contacts"]) % 3 == 0 and 0 < p["measured"]["contacts"] <= r <= 3 * p["measured"]["contacts"]'
    check "and why: $(grep '^  budget' stdout)" grep -q '^  budget  *none  *of what gives way, ' stdout
    holds 'on another trace' --plan soft.json --seed 5 --ticks 3000
    succeeds 'run --plan' run --plan soft.json --device 'sim:?hand=press&rate=500' --ticks 300 --json
    check "what gives way does: $(cat stdout)" grep -q '"spring_nodes":[1-9]' stdout
    succeeds 'plan a soft sheet coarsely' plan sheet.scene.json --error 10cm --rate 500 --ticks 10000 -o stiff.json
    check 'then it is rigid' json stiff.json 'p["setting"]["rigid"] == [0]'
    check 'and has a budget' json stiff.json 'p["setting"]["budget"] < 1000000'
    check 'and no force is needed' json stiff.json 'p["setting"]["until"] == "track"'
    succeeds 'run --plan' run --plan stiff.json --device 'sim:?hand=press&rate=500' --ticks 300 --json
    check "it is rigid: $(cat stdout)" test "$(grep -c "\"spring_nodes\":[1-9]" stdout)" -eq 0
    check "and no contact is looked for: $(cat stdout)" grep -q '"unknown":300,' stdout
    succeeds 'run --plan, the torus' run --plan torus.json --device 'sim:?hand=press&rate=500' --ticks 300 --json
    budget=$(sed -n 's/.*"budget": \([0-9]*\).*/\1/p' torus.json | head -n 1)
    check "its budget: $(cat stdout)" grep -q "\"budget\":$budget}" stdout
    notes 'at another rate' 'what it promises does not count' run --plan torus.json --device 'sim:?hand=press&rate=2000' --ticks 50 --json
}

# to_and_fro TICKS STAY: a trace of a tool that is now on one side of the torus, now on the other, and goes across in one
# tick. STAY, in awk, has the ticks of a side: row(HEIGHT, OFF).
to_and_fro()
{
    awk -v ticks="$1" 'function row(z, off) {
            printf "%d,%.9f,%.9f,%.9f,%.9f,%.9f,%.9f\n", tick++, x + off - 0.005 * side, -0.05, z,
                x + off + 0.005 * side, 0.05, z
        }
        BEGIN {
            print "tick,ax,ay,az,bx,by,bz"
            for (side = 1; tick < ticks; side = -side) {
                x = 0.1 * side
                '"$2"'
            }
        }' </dev/null
}

# A tool that rests above, presses now here, now there, and flies across in one tick.
sweeps()
{
    check 'slides are swept at once' json torus.json 'p["setting"]["sweep_budget"] == 0'
    check "and why: $(grep sweep_budget torus.txt)" grep -q '^  sweep_budget  *none  *\([0-9]*: .*\|-\)$' torus.txt
    to_and_fro 10080 'for (i = 0; i < 220; i++) row(0.06)
        for (i = 0; i < 40; i++) row(0.06 - 0.0195 * i / 39)
        for (i = 0; i < 60; i++) row(0.0405, 0.0005 * sin(0.05 * i))
        for (i = 0; i < 40; i++) row(0.0405 + 0.0195 * i / 39)' >flights.csv
    succeeds 'a finer torus' make torus 61358 -o fine.obj
    succeeds 'compiled' compile fine.obj -o fine.dpa
    succeeds 'plan flights' plan fine.dpa --error 0.1mm --force-error 0.05N --trace flights.csv -o flights.json --header flights.h
    check "flights need none, as a tick that took long goes on in the next: $(grep sweep_budget stdout)" json flights.json \
        'p["setting"]["sweep_budget"] == 0'
    check "in the header: $(grep sweep_budget flights.h)" grep -qx "    def->sweep_budget = 0;" flights.h
    holds 'flights' --plan flights.json
    # Where the tool strikes in the tick of its flight, a sweep that has to wait is felt. The plan has not seen that.
    sed 's/"sweep_budget": 0/"sweep_budget": 64/' flights.json >few.json
    to_and_fro 3000 'row(0.06)
        for (i = 0; i < 60; i++) row(0.0405, 0.0005 * sin(0.05 * i))
        row(0.06)' >strikes.csv
    run replay --plan flights.json --json strikes.csv
    check "strikes, without a bound on sweeps: $(cat stdout)" python3 -c '
import json
assert json.load(open("stdout"))["force_error"] <= 0.05' 2>python.log
    breaks 'too few' force --plan few.json strikes.csv
    edited '"sweep_budget": 0' '"sweep_budget": -1'
    refuses 'no units' 'edited.json: setting.sweep_budget: must be 0 to 4294967295; it is -1' replay --plan edited.json
    sed 's/"sweep_budget": [0-9]*, //' torus.json >older.json
    holds 'a plan that says nothing of sweeps' --plan older.json
}

# recorded PLAN KEY=VALUE...: a run with a plan, whose recording tells that, and replays to the same bits
recorded()
{
    plan=$1
    shift
    succeeds "run --plan $plan --record" run --plan "$plan" --device 'sim:?hand=wipe&cycle=1' --ticks 1500 --record run.dpr
    for line; do
        check "$plan: $line in $(grep -a '^plan' run.dpr)" grep -aqx "$line" run.dpr
    done
    succeeds "replay of $plan" replay run.dpr
    check "the same bits: $(cat stdout)" grep -qx 'run.dpr: 1500 ticks, all the same bits' stdout
}

# A recording tells a plan's setting, so that it is made again.
recordings()
{
    recorded torus.json planned=1 plan_until=0 plan_max_contacts=0 plan_integrator=0 plan_sweep_budget=0
    recorded older.json plan_sweep_budget=0
    recorded few.json plan_sweep_budget=64
    recorded soft.json plan_rigid_low=0 "plan_iterations=$(sed -n 's/.*"iterations": \([0-9]*\).*/\1/p' soft.json | head -n 1)"
    recorded stiff.json plan_rigid_low=1 plan_until=1
    # Settings that are felt: with another margin, other contacts, normals or sweeps the bits would be others.
    sed 's/"law": "proxy"/"law": "bed"/' torus.json >bed.json
    recorded bed.json law=bed
    sed 's/"law": "proxy"/"law": "point"/; s/"smooth_normals": 0/"smooth_normals": 1/' torus.json >point.json
    recorded point.json law=point plan_smooth_normals=1 plan_max_contacts=0
    sed 's/"sweep_budget": 0/"sweep_budget": 20/' torus.json >waits.json
    recorded waits.json plan_sweep_budget=20
    succeeds 'without a plan' run torus.dpa --device 'sim:?hand=wipe&cycle=1' --ticks 50 --record run.dpr
    check 'none is told' grep -aqx 'planned=0' run.dpr
}

# A device, a stiffness that it cannot hold, and the bound that limits.
devices()
{
    printf 'mass=0.1\ndamping=0.5\ndelay=0.001\n' >slow.txt
    run plan torus.dpa --error 0.1mm --stiffness 800 --device slow.txt
    check "exit $status" test $status -eq 1
    check "why: $(cat stdout)" grep -qx 'K 800 needs T/2 + t_d <= 0\.41[0-9]* ms; you have 1\.75' stdout
    run plan torus.dpa --error 0.1mm --stiffness 800 --device slow.txt --json
    check "exit $status" test $status -eq 1
    check "why, as JSON: $(cat stdout)" json stdout 'p["plan"] is None and p["limit"].startswith("K 800 needs T/2 + t_d <= 0.41")'
    succeeds 'as stiff as it holds' plan torus.dpa --error 0.1mm --ticks 10000 --device slow.txt -o held.json
    # With T/2 + t_d = 1.75 ms it shakes from 0.5 / 1.75e-3 = 286 N/m on, nearly.
    check "with a margin of 1.5: $(cat held.json)" json held.json '185 < p["setting"]["stiffness"] < 195 and
abs(p["stable"] / p["setting"]["stiffness"] - 1.5) < 1e-3 and p["promises"]["gain_margin"] == 1.5 and p["setting"]["lock_rotation"] == 1'
    printf 'mass=0.1\nposition_step=0.0005\n' >unknown.txt
    run plan torus.dpa --error 0.1mm --stiffness 800 --device unknown.txt
    check "exit $status, not known: $(cat stdout)" grep -q '^K 800: the device.s mass or damping is not known' stdout
    succeeds 'a trace' make trace --mesh torus.dpa --ticks 10000 --length 0.1 -o long.csv
    run plan torus.dpa --error 0.1mm --force-error 0.05N --rate 100kHz --trace long.csv
    check "no time for it: exit $status" test $status -eq 1
    check "which bound: $(cat stdout)" grep -qx 'no setting keeps all bounds: ticks take [0-9.]* ms at 99.9 %, at most 0.005 ms\(, and this machine was busy: try again with less beside it\)\{0,1\}' stdout
}

refused()
{
    refuses 'no force to be felt' 'no tick in the first half of the trace feels a force' \
        plan torus.dpa --error 0.1mm --force-error 0.05N --rate 100kHz --ticks 10000 --seed 2
    head -n 300 torus.csv >short.csv
    refuses 'no bound' '--error is needed' plan torus.dpa
    refuses 'no scene' 'a scene, SCENE.json or MESH.dpa is needed' plan --error 1mm
    refuses 'another unit' "--error: '1N' is not in m, cm, mm or um" plan torus.dpa --error 1N
    refuses 'no number' "--force-error: 'x' is not a number" plan torus.dpa --error 1mm --force-error x
    refuses 'no rate' '--rate must be 10 to 100000 Hz' plan torus.dpa --error 1mm --rate 5
    refuses 'few ticks' '--ticks must be 10000 to 100000000' plan torus.dpa --error 1mm --ticks 9999
    refuses 'a short trace' 'short.csv: it has 299 ticks, and at least 10000 are needed' plan torus.dpa --error 1mm --trace short.csv
    refuses 'the mesh as output' torus.dpa plan torus.dpa --error 1mm -o torus.dpa
    refuses 'no device' none.txt plan torus.dpa --error 1mm --device none.txt
    head -c 700 torus.json >cut.json
    refuses 'a plan cut off' 'cut.json:' replay --plan cut.json
    refuses 'no plan' none.json replay --plan none.json
    refuses 'a scene for a plan' "sheet.scene.json: there is no key 'bodies'" replay --plan sheet.scene.json
    edited '"until": "respond"' '"until": "later"'
    refuses 'a word' "edited.json: setting.until: 'later' is none of: respond, track, contact" replay --plan edited.json
    edited '"budget": [0-9]*' '"budget": -1'
    refuses 'a number' 'edited.json: setting.budget: must be 0 to 4294967295; it is -1' run --plan edited.json --device sim
    edited '"scene_crc32": "[0-9a-f]*"' '"scene_crc32": "0123456"'
    refuses 'a checksum' 'edited.json: scene_crc32: must be eight digits, base 16' replay --plan edited.json
    edited '"dynpoint_plan": 1' '"dynpoint_plan": 2'
    refuses 'another format' 'edited.json: dynpoint_plan: must be 1 to 1; it is 2' replay --plan edited.json
    edited '"asked"' '"aksed"'
    refuses 'another key' "edited.json: there is no key 'aksed'" replay --plan edited.json
    grep -v '"machine"' torus.json >edited.json
    refuses 'a key is missing' "edited.json: the key 'machine' is missing" replay --plan edited.json
    edited '"crc32": "[0-9a-f]*" }]' '"crc32": "00000000" }]'
    refuses 'another mesh' 'edited.json: meshes[0]: another mesh than now in torus.dpa' replay --plan edited.json
    refuses 'a plan and a scene' '--plan names a scene and its tool' run torus.dpa --plan torus.json --device sim
    refuses 'another law' '--law: the plan torus.json is of the law proxy' run --plan torus.json --device sim --law bed
    refuses 'two traces' '--seed, --ticks and --speed are for a trace that is made' replay --plan torus.json torus.csv --seed 2
}

run replay --plan none.json
if grep -q 'this build reads no plans' stderr; then
    skip "plans: no jansson"
    finish
fi
prepare
thin
[ ! "$is_part" ] || finish
chosen
promised
broken
header
soft
sweeps
recordings
devices
refused
finish
