#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# dynpoint view: what it refuses, the pages that play by themselves, decoded by docs/view.md alone, and what it serves.
# `sh tests/tools/cli_view.sh BUILD`.
. "$(dirname "$0")/cli.sh"

record_bytes=528

help()
{
    succeeds 'view --help' view --help
    check 'its usage' grep -q '^usage: dynpoint view MESH' stdout
    check 'nothing on standard error' test ! -s stderr
}

operands()
{
    refuses 'view alone' 'is needed (see --help)' view
    refuses 'two operands' 'one argument too many' view box.dpa torus.dpa
    refuses 'no such option' 'unknown option --frob' view box.dpa --frob
    refuses 'steering a mesh' '--control is of a scene' view box.dpa --control
    refuses 'no file' 'nowhere.ply: it cannot be opened' view nowhere.ply -o out/x.html
    refuses 'no compiled file' 'nowhere.dpa: cannot be opened' view nowhere.dpa -o out/x.html
    refuses 'no recording' 'nowhere.dpr: ' view nowhere.dpr -o out/x.html
    refuses 'a folder' 'out: ' view out -o out/x.html
    echo 'no mesh' >words.obj
    refuses 'no mesh' 'words.obj: ' view words.obj -o out/x.html
    head -c 1000 box.dpa >cut.dpa
    refuses 'a mesh that is cut' 'cut.dpa: byte ' view cut.dpa -o out/x.html
    refuses 'a mesh with a mesh' '--mesh and --tool are of a recording' view box.dpa --mesh box.ply -o out/x.html
    refuses 'a mesh with a tool' '--mesh and --tool are of a recording' view box.ply --tool box.dpa -o out/x.html
    refuses 'a page of a scene to standard output' '-o: the page of a scene is a file' view tori -o -
    refuses 'a page of a scene that is served' 'does not go with --port' view tori -o out/x.html --port 8000
    refuses 'a page of a scene without a name' '-o needs a value' view tori -o
    refuses 'a page of a scene that is none' 'dynpoint view: tro.json' view tro.json -o out/x.html
    refuses 'an option that no scene has' 'dynpoint view: unknown option --frob' view tori --frob
    refuses 'no time' '--for must be positive' view box.dpa --for 0
    refuses 'no port' '--port must be 0 to 65535' view box.dpa --port 65536
    for option in --open '--port 8000' '--address 0.0.0.0'; do
        # shellcheck disable=SC2086
        refuses "-o and $option" '-o writes a page, and --open, --port, --address and --json serve one' \
            view box.dpa -o out/x.html $option
        # shellcheck disable=SC2086
        refuses "$option without --view" '--open, --port, --address and --control need --view' \
            run box.dpa --device sim --ticks 5 $option
    done
    refuses '--control without --view' '--open, --port, --address and --control need --view' \
        run box.dpa --device sim --ticks 5 --control
    refuses 'steering no hand' '--control: only a simulated hand can be steered' \
        run box.dpa --device sim: --ticks 5 --view --control
    refuses 'steering a replay' '--control: only a simulated hand' \
        run box.dpa --device 'replay:torus.csv' --ticks 5 --view --control
    refuses 'steering a recorded hand' '--control is of a scene' view named.dpr --control
    cp box.dpa before
    for out in box.dpa ./box.dpa; do
        refuses "over the mesh, $out" 'it is an input too' view box.dpa -o $out
    done
    refuses 'over the recording' 'it is an input too' view named.dpr -o named.dpr
    refuses "over the recording's mesh" 'it is an input too' view named.dpr --mesh box.dpa -o box.dpa
    refuses "over the recording's tool" 'it is an input too' view named.dpr --tool box.dpa -o box.dpa
    refuses 'a recording whose file is gone' 'its scene is not where it was, so --mesh FILE is needed' view gone.dpr -o out/x.html
    check 'the mesh has changed' cmp -s box.dpa before
}

record_scenes()
{
    cp box.dpa gone.dpa
    succeeds 'a mesh' run gone.dpa --device 'sim:?hand=press' --ticks 50 --record gone.dpr
    succeeds 'one that stays' run box.dpa --device 'sim:?hand=press' --ticks 50 --record there.dpr
    rm gone.dpa
    succeeds 'a scene by name' run tori --device 'sim:?hand=wipe&cycle=1' --ticks 2000 --friction 0.3 --record named.dpr
    succeeds 'one that gives way' run membrane --device 'sim:?hand=press&cycle=1' --ticks 1000 --record soft.dpr
    succeeds 'of an arm' run "$tests/golden/arm_1_mesh_4.dpa" --device 'sim:?dofs=6&hand=wipe&cycle=1' --ticks 500 \
        --embed --record arm.dpr
    succeeds 'slowly' run tori --device 'sim:?hand=press&cycle=1&rate=50' --ticks 100 --record slow.dpr
    size=$(wc -c <named.dpr)
    begin=$((size - 2000 * record_bytes))
    at=$((begin + 1234 * record_bytes))
    head -c $((at + 77)) named.dpr >cut.dpr
    { head -c $((at + 77)) named.dpr; printf damage; tail -c +$((at + 84)) named.dpr; } >damaged.dpr
    { head -c $at named.dpr; tail -c +$((at + 3 * record_bytes + 1)) named.dpr; } >gap.dpr
    head -c "$begin" named.dpr >empty.dpr
}

# Reads a page by docs/view.md and docs/format.md alone, and prints "title|mode|meshes|bodies|frames|ticks|end".
write_decoder()
{
    cat >decode.py <<'PYTHON'
import base64, json, math, re, struct, subprocess, sys

program, path, source = sys.argv[1:4]
csv_path = sys.argv[4] if len(sys.argv) > 4 and sys.argv[4] != "--jaws" else None
page = open(path, encoding="utf-8").read()
found = re.findall(r'<script type="text/plain" id="data">([^<]*)</script>', page)
assert len(found) == 1, "%d places for data" % len(found)
open(path + ".frame", "w").write(page.replace(found[0], ""))
assert "@DATA@" not in page
stream = base64.b64decode(found[0], validate=True)
messages, at = [], 0
while at < len(stream):
    size = struct.unpack_from("<Q", stream, at)[0]
    at += 8
    messages.append(stream[at : at + size])
    assert len(messages[-1]) == size and not any(stream[at + size : (at + size + 7) // 8 * 8])
    at = (at + size + 7) // 8 * 8
assert at == len(stream)
NONE = 0xFFFFFFFF

def read_scene(message):
    kind, size = struct.unpack_from("<II", message)
    assert kind == 1
    scene = json.loads(message[8 : 8 + size].decode("utf-8"), parse_constant=lambda word: 1 / 0)
    begin = (8 + size + 7) // 8 * 8
    assert not any(message[8 + size : begin])
    assert set(scene) == set("title program mode control device up frame_rate force_max camera inset look jaws dress meshes bodies".split())
    end = begin
    for mesh in scene["meshes"]:
        n, m = mesh["vertices"], mesh["triangles"]
        positions = struct.unpack_from("<%df" % (3 * n), message, begin + mesh["positions"])
        corners = struct.unpack_from("<%dI" % (3 * m), message, begin + mesh["corners"])
        sources = struct.unpack_from("<%dI" % m, message, begin + mesh["sources"])
        assert n > 2 and m > 0 and all(map(math.isfinite, positions)) and max(corners) < n and len(set(sources)) == m
        assert set(corners) == set(range(n))
        end = max(end, begin + max(mesh["positions"] + 12 * n, mesh["corners"] + 12 * m, mesh["sources"] + 4 * m))
        assert all(mesh[key] % 4 == 0 for key in ("positions", "corners", "sources"))
    assert (end + 7) // 8 * 8 >= len(message) >= end
    assert scene["jaws"] in (True, False)
    for part in scene["dress"]:
        assert set(part) == set("mesh pose hinge colour".split()) and part["mesh"] < len(scene["meshes"])
        assert len(part["pose"]) == 7 and (part["hinge"] is None or len(part["hinge"]) == 7)
    for body in scene["bodies"]:
        assert body["mesh"] < len(scene["meshes"]) and len(body["pose"]) == 7
        assert body["look"] in ("organ", "cloth", "bone")
        assert body["colour"] is None or len(body["colour"]) == 3 and all(0 <= part <= 1 for part in body["colour"])
    assert scene["inset"] is None or len(scene["inset"]) == 9 and all(map(math.isfinite, scene["inset"]))
    assert scene["camera"] is None or len(scene["camera"]) == 9 and all(map(math.isfinite, scene["camera"]))
    assert scene["look"] in ("none", "stylus", "needle", "scalpel", "forceps", "laparoscope")
    assert scene["up"] in "yz" and scene["frame_rate"] == 60 and scene["control"] is False
    return scene

strides = {1: 80, 2: 304, 3: 224, 4: 144, 5: 32, 6: 12}

def read_snapshot(block, scene):
    magic, version, header, size, steps, time, flags, count, work, zero, more = struct.unpack_from("<8sIIQQdIIIIQ", block)
    assert magic == b"\x89DPS\r\n\x1a\n" and version == 1 and header == 64 and zero == more == 0
    assert size == len(block) and size % 8 == 0 and flags & ~7 == 0
    sections = {}
    for i in range(count):
        kind, items, stride, zero, offset = struct.unpack_from("<4IQ", block, header + 24 * i)
        assert kind not in sections and zero == 0 and offset % 8 == 0 and offset + items * stride <= size
        assert stride == strides[kind]
        sections[kind] = [block[offset + stride * k : offset + stride * (k + 1)] for k in range(items)]
    bodies = [struct.unpack("<4IQ7d", item) for item in sections[1]]
    assert [body[0] for body in bodies] == [body["id"] for body in scene["bodies"]]
    for body, told in zip(bodies, scene["bodies"]):
        assert abs(sum(x * x for x in body[8:]) - 1) < 1e-9
        assert body[3] == 0 or body[3] == scene["meshes"][told["mesh"]]["vertices"]
        assert bool(body[1] & 1) == (body[3] > 0)
        assert body[2] == NONE or body[2] + body[3] <= len(sections.get(6, []))
    assert len(sections[2]) == 1
    tool = struct.unpack("<12I2Q30d", sections[2][0])
    assert tool[4] == 0 and tool[5] == len(sections[3]) > tool[10] and tool[7] == len(sections.get(4, []))
    for item in sections[3]:
        segment = struct.unpack("<8I24d", item)
        assert segment[0] <= 3 and segment[1] <= 3 and segment[6] == 0 and segment[14] >= 0
    for item in sections.get(6, []):
        assert all(map(math.isfinite, struct.unpack("<3f", item)))
    return steps, time, tool, len(sections.get(6, []))

def f32(x):
    return struct.unpack("<f", struct.pack("<f", x))[0]

scene = read_scene(messages[0])
ticks, frames, moved, lost, end = [], [], 0, 0, ""
for message in messages[1:]:
    kind = struct.unpack_from("<I", message)[0]
    assert not end
    if kind == 3:
        assert struct.unpack_from("<I", message, 4)[0] == len(message) - 8
        end = message[8:].decode("utf-8")
        continue
    kind, size, count, zero, number, dropped, lost = struct.unpack_from("<4I3Q", message)
    rates = struct.unpack_from("<5d", message, 40)
    assert kind == 2 and zero == 0 and number == len(frames) and dropped == 0 and all(map(math.isfinite, rates))
    assert len(message) == 80 + size + 40 * count
    steps, time, tool, vertices = read_snapshot(message[80 : 80 + size], scene)
    ticks += [struct.unpack_from("<dfffffIIf", message, 80 + size + 40 * i) for i in range(count)]
    assert count > 0 and abs(ticks[-1][0] - time) < 1e-9 and steps == len(ticks), "tick at %g, snapshot at %g" % (ticks[-1][0], time)
    frames.append((time, tool))
    moved += vertices > 0
if scene["mode"] == "mesh":
    assert len(messages) == 1 and scene["device"] is None and scene["force_max"] is None
    info = json.loads(subprocess.run([program, "info", source, "--json"], stdout=subprocess.PIPE, check=True).stdout)
    told = scene["meshes"][0]
    assert (told["vertices"], told["triangles"]) == (info["vertices"], info["triangles"])
else:
    assert scene["mode"] == "recording" and end and lost == 0
    device = scene["device"]
    assert set(device) == set("name simulated rate workspace".split()) and device["simulated"] is True
    assert scene["force_max"] == 5
if csv_path:
    rows = [row.split(",") for row in open(csv_path).read().splitlines()]
    columns = {name: [row[i] for row in rows[1:]] for i, name in enumerate(rows[0])}
    felt = [i for i, flags in enumerate(columns["flags"]) if int(flags) & 1]
    assert len(ticks) <= len(felt)
    if "--all" in sys.argv:
        assert len(ticks) == len(felt), "%d ticks of %d" % (len(ticks), len(felt))
    time = 0.0
    for tick, i in zip(ticks, felt):
        time += float(columns["dt"][i])
        assert abs(tick[0] - time) < 1e-9
        assert tick[3] == f32(float(columns["energy"][i])) and tick[6:] == (int(columns["contact"][i]), int(columns["force_reason"][i]), 0.5)
        assert abs(tick[4] - 1e-9 * int(columns["late_ns"][i])) < 1e-9 and abs(tick[5] - 1e-9 * int(columns["took_ns"][i])) < 1e-9
        asked = [float(columns["asked_f" + axis][i]) for axis in "xyz"]
        # The passivity controller may take some away, but adds nothing on the whole.
        if float(columns["energy"][i]) == 0:
            assert tick[1] < 1e-3 or math.hypot(asked[0], math.hypot(*asked[1:])) > 0
    dt = float(columns["dt"][felt[0]])
    proxies = [[float(columns["proxy_" + key][i]) for key in "x y z qw qx qy qz".split()] for i in felt]
    done = 0
    for time, tool in frames:
        i = round(time / dt) - 1
        assert list(tool[21:28]) == proxies[i], "proxy at %g" % time
        assert i >= done
        done = i
    # 60 a second where there are so many ticks; the last one at the end.
    expected = min(len(ticks), ticks[-1][0] * 60)
    assert expected - 1 <= len(frames) <= expected + 2, "%d frames for %g s" % (len(frames), ticks[-1][0])
    for (a, _), (b, _) in zip(frames, frames[1:-1]):
        assert dt * 0.99 < b - a < max(1 / 60 + dt, 1.01 * dt), "a frame after %g s" % (b - a)
if "--jaws" in sys.argv:
    # Open for 0.2 s, closed within 0.4 s while the button is down, and back.
    opening = [tick[8] for tick in ticks]
    assert opening[0] == opening[199] == opening[-1] == 1 and opening[700] == 0
    assert abs(opening[400] - 0.5) < 0.01 and all(abs(a - b) < 0.003 for a, b in zip(opening, opening[1:]))
    assert scene["jaws"] and [part["hinge"] and part["hinge"][6] for part in scene["dress"]] == [None, -0.5, 0.5]
    assert [scene["meshes"][part["mesh"]]["triangles"] for part in scene["dress"]] == [116, 12, 12]
    assert all(part["mesh"] >= len(scene["bodies"]) for part in scene["dress"]), "a part is a body"
print("|".join([scene["title"], scene["mode"], scene["up"], str(len(scene["meshes"])), str(len(scene["bodies"])), str(len(frames)),
                str(len(ticks)), str(moved), end]))
PYTHON
}

# decoded WHAT PAGE SOURCE [CSV] [--all]: sets `line`, the decoder's
decoded()
{
    what=$1
    shift
    if line=$(python3 decode.py "$program" "$@" 2>python.log); then ok
    else bad "$what, decoded: $(tail -n 1 python.log)"; fi
}

mesh_pages()
{
    succeeds 'an OBJ' make torus 300 -o ring.obj
    succeeds 'an STL' make torus 300 -o ring.stl
    succeeds 'a PLY' make torus 300 -o ring.ply
    succeeds 'compiled' compile ring.obj -o ring.dpa
    for ending in dpa obj stl ply; do
        refuses "$ending, no such folder" 'nowhere/x.html: cannot be written' view ring.$ending -o nowhere/x.html
        succeeds "a page of ring.$ending" view ring.$ending -o $ending.html
        check "$ending: silent" test ! -s stdout -a ! -s stderr
        succeeds "again" view ring.$ending -o again.html
        check "$ending: the same bytes" cmp -s again.html $ending.html
        if [ $has_python ]; then
            decoded "ring.$ending" $ending.html ring.dpa
            check "ring.$ending: $line" test "$line" = "ring.$ending|mesh|y|1|1|0|0|0|"
        fi
    done
    "$program" view ring.ply -o - >stdout.html 2>stderr
    check 'to standard output' cmp -s stdout.html ply.html
    check 'nothing that is loaded from elsewhere' test "$(grep -cE '(src|href)="?(https?:)?//' ply.html)" -eq 0
}

# A page may be written over; it is whole, or as it was.
whole_pages()
{
    echo keep >kept.html
    (
        trap '' XFSZ
        ulimit -f 200
        exec "$program" view ring.dpa -o kept.html
    ) >stdout 2>stderr
    status=$?
    if is_refusal kept.html; then ok; else bad "a full disk: $reason"; fi
    check 'the page before is there' test "$(cat kept.html)" = keep
    check 'nothing beside it' test ! -e kept.html.part
    refuses 'a mesh that is none' words.obj view words.obj -o kept.html
    check 'leaves the page' test "$(cat kept.html)" = keep
    head -c 40 named.dpr >header.dpr
    refuses 'a header that is cut' 'header.dpr: byte 0 (header): ' view header.dpr -o kept.html
    check 'leaves it, too' test "$(cat kept.html)" = keep
}

# ends RECORDING TEXT: the page's last message
ends()
{
    succeeds "a page of $1" view "$1" -o "$1.html"
    [ $has_python ] || return
    decoded "$1" "$1.html" "$1"
    check "$1 ends: $line" test "${line##*|}" = "$2"
}

# A scene is felt, recorded, and shown; the recording goes.
scene_pages()
{
    succeeds 'a page of a scene' view tori -o scene.html --ticks 700
    check 'how it went' grep -q '^700 ticks' stdout
    check 'no recording is left' test ! -e scene.html.dpr
    succeeds 'the same by hand' run tori --device 'sim:?hand=press' --ticks 700 --record scene.html.dpr
    succeeds 'and its page' view scene.html.dpr -o by_hand.html
    check 'is the same' cmp -s scene.html by_hand.html
    refuses 'a recording in the way' 'scene.html.dpr is in the way' view tori -o scene.html
    rm scene.html.dpr
}

# A tool that looks like meshes of the user's own, with jaws that a button closes.
dressed_pages()
{
    printf 't,x,y,z,buttons\n0,0,0.02,0,0\n0.199,0,0.02,0,0\n0.2,0,0.02,0,1\n0.799,0,0.02,0,1\n0.8,0,0.02,0,0\n3,0,0.02,0,0\n' >squeeze.csv
    run run "$tests/../docs/samples/grasper.json" --device 'sim:?hand=squeeze.csv' --ticks 1300 --record dressed.dpr
    if grep -q 'this build reads no scene files' stderr; then
        skip 'a tool with meshes of its own: no jansson'
        return
    fi
    check "a tool with meshes of its own: exit $status, $(cat stderr)" test $status -eq 0
    succeeds 'and its page' view dressed.dpr -o dressed.html
    [ $has_python ] || return
    decoded 'a tool with meshes of its own' dressed.html dressed.dpr --jaws
    sed 's/grasper-jaw.obj/nonesuch.obj/' "$tests/../docs/samples/grasper.json" >undressed.json
    cp "$tests/../docs/samples/grasper-shaft.obj" .
    refuses 'a part that is not there' 'undressed.json: tool.dress[1]: ' run undressed.json --device sim --ticks 5
}

recording_pages()
{
    succeeds 'replay opens the file that was recorded' replay there.dpr
    succeeds 'and so does a page' view there.dpr -o there.html
    cp torus.dpa gone.dpa
    refuses 'another file in its place' 'this is another scene than the recording' view gone.dpr -o out/x.html
    rm gone.dpa
    for name in named soft arm slow; do
        succeeds "a page of $name" view $name.dpr -o $name.html
        succeeds 'again' view $name.dpr -o again.html
        check "$name: the same bytes" cmp -s again.html $name.html
        [ $has_python ] || continue
        succeeds "$name in columns" record csv $name.dpr -o $name.csv
        decoded "$name" $name.html $name.dpr $name.csv --all
        case $name in
        named) expected='recording|y|*|*|12?|2000|0|The recording is whole: 2000 records.' ;;
        soft) expected='recording|y|1|1|6?|1000|[1-9]*|The recording is whole: 1000 records.' ;;
        arm) expected='recording|z|*|3?|500|0|The recording is whole: 500 records.' ;;
        slow) expected='recording|y|*|*|100|100|0|The recording is whole: 100 records.' ;;
        esac
        # shellcheck disable=SC2254
        case $line in "$name.dpr|"$expected) ok ;; *) bad "$name: $line" ;; esac
    done
    ends cut.dpr "The recording is cut off at byte $at."
    ends damaged.dpr "The recording is damaged at byte $at."
    ends gap.dpr 'The recording is whole: 1997 records. 3 records are missing in it.'
    ends empty.dpr 'The recording is whole: 0 records.'
    if [ $has_python ]; then
        decoded 'what is cut' cut.dpr.html cut.dpr named.csv
        check "as far as it goes: $line" test "$(echo "$line" | cut -d '|' -f 7)" -eq 1234
    fi
}

# Names are a user's or another person's: any bytes.
names()
{
    odd=$(printf 'a"b\\<!--<script>&\001\t\033\303\251\377\355\240\200\360\237\230\200.ply')
    cp ring.ply "$odd"
    succeeds 'a name of any bytes' view "$odd" -o odd.html
    mkdir 'odd<'
    cp named.dpr 'odd</script>x.dpr'
    succeeds 'a path that ends a script' view 'odd</script>x.dpr' -o script.html
    if [ ! $has_python ]; then
        skip 'names in a page: no python3'
        return
    fi
    decoded 'a name of any bytes' odd.html ring.dpa
    expected=$(printf 'a"b\\<!--<script>&\001\t\033\303\251\357\277\275\357\277\275\357\277\275\357\277\275\360\237\230\200.ply')
    check "its name: $line" test "${line%%|*}" = "$expected"
    decoded 'a path that ends a script' script.html named.dpr named.csv --all
    check "its name: $line" test "${line%%|*}" = 'odd</script>x.dpr'
    check 'the page around is the same' cmp -s odd.html.frame named.html.frame
    check 'and for the other' cmp -s script.html.frame named.html.frame
}

served()
{
    run view ring.dpa --for 0.2
    if [ $status -eq 2 ] && grep -q 'this build cannot serve a page' stderr; then
        is_refusal 'which needs libwebsockets'
        check "a build without libwebsockets: $reason" test $? -eq 0
        skip 'what is served: this build has no libwebsockets'
        return
    fi
    address='^the viewer: http://127\.0\.0\.1:[0-9]*/#[0-9a-f]\{32\}$'
    check "a mesh: exit $status, $(cat stderr)" test $status -eq 0 -a ! -s stderr
    check "its address: $(cat stdout)" grep -q "$address" stdout
    mv stdout first
    mkdir -p bin
    printf '#!/bin/sh\nexit 3\n' >bin/xdg-open
    chmod 755 bin/xdg-open
    (PATH=$PWD/bin:$PATH exec "$program" view ring.dpa --open --for 0.3) >stdout 2>stderr </dev/null
    check "a browser that fails leaves the address: $(cat stdout stderr)" grep -q "$address" stdout
    run view named.dpr --for 0.2
    check "a recording: $(cat stdout stderr)" grep -q "$address" stdout
    check 'another token' test "$(sed 's/.*#//' first)" != "$(sed 's/.*#//' stdout)"
    run run tori --device 'sim:?hand=press' --ticks 20 --view
    check "a run: $(cat stdout stderr)" grep -q "$address" stdout
    check 'and its report' grep -q '^20 ticks: ' stdout
    run view tori --for 0.3
    check "a scene, felt by a hand: exit $status, $(cat stdout stderr)" grep -qE '^[1-9][0-9]* ticks: ' stdout
    run view tori --for 0.3 --control
    check "and by one that is steered: exit $status, $(cat stderr)" test $status -eq 0
    rm first
    "$program" view ring.dpa --for 60 >first 2>&1 </dev/null &
    server=$!
    for _ in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do
        [ ! -s first ] || break
        sleep 0.2
    done
    port=$(sed -n 's/.*127.0.0.1:\([0-9]*\).*/\1/p' first)
    refuses "a port that is taken, $port" 'the viewer: ' view ring.dpa --for 0.2 --port "$port"
    refuses 'also for a run' 'the viewer: ' run tori --device sim --ticks 5 --view --port "$port"
    kill -INT $server
    wait $server
    check "an interrupt ends it: exit $?" test $? -eq 0
}

# The two sources that know what a build lacks, compiled as for one that lacks it.
lacking()
{
    if ! command -v "${CC:-cc}" >/dev/null; then
        skip 'a build without page or server: no compiler'
        return
    fi
    mkdir lacking
    echo '/* nothing */' >lacking/built_with.h
    cat >lacking/says.c <<'C'
#include <stdarg.h>
#include <stdio.h>
#include "view/view_serve.h"
int complain(const char *command, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    printf("%s: ", command);
    vprintf(format, arguments);
    va_end(arguments);
    return 2;
}
int main(void)
{
    const struct run_view_options options = { .is_on = 1 };
    const struct view_source source = { .first_count = 0 };
    struct view_serving *serving;
    const int status = view_serve("view", &options, &source, &serving);
    view_serve_end(serving, "");
    return status == 2 && !serving && !view_page_bytes().html ? 0 : 1;
}
C
    ${CC:-cc} -std=gnu99 -Ilacking -I"$tests/../tools" -I"$tests/../include" -I"$tests/../src" -I"$tests/../drivers" \
        -include "$tests/../tools/view/view_serve.h" lacking/says.c "$tests/../tools/view/view_serve.c" -o lacking/says 2>cc.log
    check "compiled without page and server: $(head -n 1 cc.log)" test -x lacking/says
    lacking/says >stdout 2>stderr
    check 'says so' test $? -eq 0
    check "in a sentence: $(cat stdout)" grep -q '^view: this build cannot serve a page, which needs libwebsockets: make deps view, then make' stdout
}

prepare
record_scenes
help
operands
lacking
if python3 -c 'import json' 2>python.log; then has_python=1; else has_python=''; fi
run view box.dpa -o probe.html
if [ $status -eq 2 ] && grep -q "this build has no viewer's page" stderr; then
    skip "pages: this build has no viewer's page"
    finish
fi
[ $has_python ] && write_decoder || skip 'pages, decoded: no python3'
mesh_pages
whole_pages
scene_pages
dressed_pages
recording_pages
names
served
finish
