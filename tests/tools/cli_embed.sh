#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Recordings that carry their scene: run --embed, and what replay, view and record info find in them, whole or damaged.
# `sh tests/tools/cli_embed.sh BUILD [part]`.
. "$(dirname "$0")/cli.sh"

record_bytes=528
ticks=300
arm=arm.dpa

# A path that blocks whoever opens it: a pipe without a writer.
limited()
{
    timeout 10 "$program" "$@" >stdout 2>stderr </dev/null
    status=$?
}

prepare_scenes()
{
    succeeds 'make liver' make liver 2000 -o liver.obj
    succeeds 'compile liver' compile liver.obj -o liver.dpa
    succeeds 'make box' make box -o box.ply
    succeeds 'compile box' compile box.ply -o box.dpa
    cp liver.dpa saved.dpa
    cp "$tests/golden/arm_1_mesh_4.dpa" "$arm"
    cp "$arm" kept_arm.dpa
    for name in carried again; do
        succeeds "a run, $name" run liver.dpa --device 'sim:?dofs=6&hand=press&cycle=1' --ticks $ticks --embed \
            --record $name.dpr
    done
    check 'the same run gives the same bytes' cmp -s carried.dpr again.dpr
    succeeds 'a run that carries nothing' run liver.dpa --device 'sim:?dofs=6&hand=press&cycle=1' --ticks $ticks \
        --record bare.dpr
    succeeds 'with the tool of an arm' run liver.dpa --tool "$arm" --device 'sim:?hand=press' --ticks $ticks --embed \
        --record tool.dpr
    succeeds 'the scene of an arm' run "$arm" --device 'sim:?dofs=6&hand=wipe&cycle=1' --ticks $ticks --embed \
        --record arm.dpr
    succeeds "a scene by name, an arm's tool" run tori --tool "$arm" --device 'sim:?hand=press' --ticks 50 --embed \
        --record name.dpr
    notes 'a scene by name' 'tori: note: --embed: a scene by name needs none' run tori --device 'sim:?hand=press' --ticks 50 \
        --embed --record none.dpr
    size=$(wc -c <carried.dpr)
    # In both, the text has as many bytes: saved.dpa is as long a name as liver.dpa.
    begin=$(wc -c <bare.dpr)
    check 'pieces come behind the ticks' test "$size" -gt $((begin + $(wc -c <liver.dpa)))
}

has_page()
{
    run view box.dpa -o probe.html
    if [ $status -eq 0 ]; then return; fi
    check "a build without a page: $(cat stderr)" grep -q "this build has no viewer's page" stderr
    return 1
}

# Without the files; a pipe stands where the path points.
without_files()
{
    rm liver.dpa "$arm"
    mkfifo liver.dpa "$arm"
    mkdir -p elsewhere
    for name in carried tool arm name; do
        limited replay $name.dpr --json
        check "$name, replayed: exit $status, $(cat stdout stderr)" grep -q '"same":true,"end":"whole"' stdout
    done
    (cd elsewhere && exec "$program" replay ../carried.dpr) >stdout 2>stderr
    check "in another folder: $(cat stdout stderr)" grep -q ": $ticks ticks, all the same bits\$" stdout
    limited replay carried.dpr saved.dpa
    check "a path wins: $(cat stderr)" test $status -eq 0
    limited replay carried.dpr box.dpa
    check 'also if it is wrong' is_refusal 'box.dpa: this is another scene than the recording'
    limited replay tool.dpr --tool box.dpa
    check 'and for the tool alone' is_refusal 'box.dpa: '
    limited view bare.dpr -o out/page.html
    check "nothing carried, no --mesh: $(cat stderr)" is_refusal "it was 'liver.dpa', of $(wc -c <saved.dpa) bytes"
    if ! has_page; then
        skip "pages of recordings: this build has no viewer's page"
        return
    fi
    for name in carried tool arm name; do
        limited view $name.dpr -o $name.html
        check "$name in a page: exit $status, $(cat stderr)" test $status -eq 0 -a -s $name.html
    done
    limited view bare.dpr --mesh saved.dpa -o bare.html
    check "of a file: exit $status" test $status -eq 0
    limited view carried.dpr --mesh box.dpa -o out/page.html
    check 'of another file' is_refusal 'another scene'
}

told()
{
    succeeds 'record info' record info tool.dpr
    check 'carries its scene' grep -q "^  it carries its scene: $(wc -c <saved.dpa) bytes, CRC-32 [0-9a-f]*\$" stdout
    succeeds 'pieces of 64 KiB' record info carried.dpr --json
    check "are counted: $(cat stdout)" grep -q "\"held\":$(wc -c <saved.dpa),\"pieces\":$((($(wc -c <saved.dpa) + 65535) / 65536))," stdout
    succeeds 'record info' record info tool.dpr
    check 'and its tool' grep -q "^  it carries its tool: $(wc -c <kept_arm.dpa) bytes" stdout
    succeeds 'record info --json' record info bare.dpr --json
    check "nothing carried: $(cat stdout)" grep -q '"embedded":\[\]' stdout
    check 'and the text says so' grep -q '"embedded=0"' stdout
    succeeds 'record csv' record csv carried.dpr -o carried.csv
    check 'has the ticks alone' test "$(grep -c '^[0-9]' carried.csv)" -eq $ticks
    # Cut between pieces and within one, and before the first: a run that was killed.
    for cut in 1 8 1000 70000 $((size - begin)) $((size - begin + record_bytes)); do
        head -c $((size - cut)) carried.dpr >cut.dpr
        limited replay cut.dpr
        check "cut by $cut: $reason$(cat stderr)" is_refusal 'cut.dpr: '
        if [ "$cut" -lt $((size - begin)) ]; then
            check "cut by $cut, the byte: $(cat stderr)" grep -qE 'byte [0-9]+: it (is cut off|ends), and only' stderr
        else
            check "cut by $cut, all of it: $(cat stderr)" grep -q 'the scene that it should carry is not in it' stderr
        fi
        limited replay cut.dpr saved.dpa
        check "cut by $cut, with the file: $(cat stdout stderr)" test $status -eq 0
    done
    head -c $((size - 1000)) carried.dpr >cut.dpr
    run record info cut.dpr
    check "info of what was cut: exit $status" test $status -eq 1
    check 'says so' grep -q 'the scene that it carries is not whole: byte [0-9]*: it is cut off, and only' stdout
}

# What no option can mean.
refusals()
{
    echo '{"bodies": [{"mesh": "box.dpa"}], "tool": {"length": 0.1, "radius": 0.002}}' >scene.json
    if "$program" run scene.json --device 'sim:?hand=press' --ticks 5 >probe 2>&1; then
        refuses 'a scene file' 'which names others' run scene.json --device sim --ticks 5 --embed --record out/x.dpr
    else
        skip "a scene file: $(cat probe)"
    fi
    refuses 'no recording' '--embed needs --record F.dpr' run box.dpa --device sim --ticks 5 --embed
    refuses 'a trace' '--embed needs --record F.dpr' run box.dpa --device sim --ticks 5 --embed --record out/x.csv
    mkfifo pipe.dpr
    limited run box.dpa --device sim --ticks 5 --embed --record pipe.dpr
    check "a pipe: $(cat stderr)" is_refusal 'pipe.dpr is no file'
    # The disk is full when the ticks are there: a limit of files, in blocks of 512 or 1024 bytes.
    for blocks in $(((begin + 20000) / 512)) $(((begin + 20000) / 1024)); do
        (
            trap '' XFSZ
            ulimit -f $blocks
            exec "$program" run saved.dpa --device 'sim:?dofs=6&hand=press&cycle=1' --ticks $ticks --embed --record full.dpr
        ) >stdout 2>stderr
        status=$?
        if grep -q 'its scene could not be added' stderr; then break; fi
    done
    check "a full disk: exit $status, $(cat stderr)" test $status -eq 2
    check 'is told' grep -q 'full.dpr: its scene could not be added: File too large' stderr
    check 'and the ticks are there, and no more' test "$(wc -c <full.dpr)" -eq "$begin"
    limited replay full.dpr saved.dpa
    check "and sound: $(cat stdout stderr)" test $status -eq 0
}

# forged NAME TEXT: forge.py NAME makes forged.dpr, whose scene replay and view must refuse with TEXT
forged()
{
    check "$1 is forged: $(python3 forge.py "$1" 2>&1)" test -s forged.dpr
    for command in replay view; do
        [ $command = replay ] && limited replay forged.dpr || limited view forged.dpr -o out/page.html
        if is_refusal "forged.dpr: $2"; then ok; else bad "$command, $1: $reason"; fi
    done
    run record info forged.dpr
    check "info, $1: exit $status, $(cat stdout)" grep -q "the scene that it carries is not whole: $2" stdout
    check "info, $1: exit $status" test $status -eq 1
    rm -f forged.dpr
}

damage()
{
    if ! python3 -c 'import zlib' 2>python.log; then
        skip 'forged pieces: no python3'
        return
    fi
    # Reads by docs/format.md alone; each change has its checksum made good, but for the flipped byte.
    cat >forge.py <<'PYTHON'
import struct, sys, zlib
file = open("carried.dpr", "rb").read()
at = struct.unpack_from("<I", file, 12)[0]
front, pieces = bytearray(file[:at]), []
while at < len(file):
    kind, size, crc, device, number = struct.unpack_from("<4IQ", file, at)
    record = file[at : at + size]
    assert zlib.crc32(record[:8] + bytes(4) + record[12:]) == crc
    if kind == 2:
        which, count, offset, total = struct.unpack_from("<IIQQ", record, 24)
        assert (device, number, which) == (0, len(pieces), 0) and size == (48 + count + 7) // 8 * 8 and size <= 1 << 20
        assert not any(record[48 + count :])
        pieces.append([which, count, offset, total, record[48 : 48 + count], number])
    else:
        assert not pieces
        front += record
    at += size
def write(pieces, name="forged.dpr"):
    out = bytearray(front)
    for which, count, offset, total, data, number in pieces:
        size = (48 + len(data) + 7) // 8 * 8
        record = struct.pack("<4IQIIQQ", 2, size, 0, 0, number, which, count, offset, total) + data
        record += bytes(size - len(record))
        out += record[:8] + struct.pack("<I", zlib.crc32(record)) + record[12:]
    open(name, "wb").write(out)
first, second, third = 3 * (pieces[0],) if len(pieces) < 3 else pieces[:3]
change = sys.argv[1]
if change == "read":
    assert b"".join(piece[4] for piece in pieces) == open("saved.dpa", "rb").read() and len(pieces) >= 3
    assert pieces[0][3] == len(open("saved.dpa", "rb").read())
    write(pieces)
    assert open("forged.dpr", "rb").read() == file
elif change == "missing":
    write([first] + pieces[2:])
elif change == "first_missing":
    write(pieces[1:])
elif change == "twice":
    write([first, first] + pieces[1:])
elif change == "order":
    write([second, first] + pieces[2:])
elif change == "overlap":
    write([first, [0, second[1] + 8, second[2] - 8, second[3], first[4][-8:] + second[4], 1]] + pieces[2:])
elif change == "huge":
    write([piece[:3] + [1 << 60] + piece[4:] for piece in pieces])
elif change == "large":
    write([piece[:3] + [piece[3] + 8] + piece[4:] for piece in pieces])
elif change == "small":
    write([piece[:3] + [piece[3] - 8] + piece[4:] for piece in pieces])
elif change == "zero":
    write([piece[:3] + [0] + piece[4:] for piece in pieces])
elif change == "changed_total":
    write([first, second[:3] + [second[3] + 8] + second[4:]] + pieces[2:])
elif change == "far":
    write([first, second[:2] + [(1 << 64) - 8] + second[3:]] + pieces[2:])
elif change == "length":
    write([first[:1] + [first[1] + 8] + first[2:]] + pieces[1:])
elif change == "empty":
    write([[0, 0, 0, first[3], b"", 0]] + pieces)
elif change == "short":
    body = struct.pack("<4IQQ", 2, 32, 0, 0, 0, 0)
    write(pieces)
    data = open("forged.dpr", "rb").read()
    record = body[:8] + struct.pack("<I", zlib.crc32(body)) + body[12:]
    open("forged.dpr", "wb").write(data[: len(front)] + record + data[len(front) :])
elif change == "other":
    data = bytearray(second[4])
    data[1000] ^= 1
    write([first, second[:4] + [bytes(data), 1]] + pieces[2:])
elif change == "newer":
    write([[7, 8, 0, 8, b"whatever", 0]] + pieces)
elif change == "between":
    ticks = bytes(front)
    write(pieces)
    data = open("forged.dpr", "rb").read()
    half = len(front) - 528 * 100
    open("forged.dpr", "wb").write(ticks[:half] + data[len(front) :] + ticks[half:])
elif change == "flip":
    data = bytearray(file)
    data[int(sys.argv[2])] ^= 1 << int(sys.argv[3])
    open("forged.dpr", "wb").write(data)
PYTHON
    check "pieces by the page alone: $(python3 forge.py read 2>&1 | tail -n 1)" cmp -s forged.dpr carried.dpr
    total=$(wc -c <saved.dpa) piece=65584
    forged missing "byte $((begin + piece)): before this piece, bytes 65536 to 131071 of the scene are missing"
    forged first_missing "byte $begin: before this piece, bytes 0 to 65535 of the scene are missing"
    forged twice "byte $((begin + piece)): this piece is of byte 0 of the scene and on, which was there up to 65536"
    forged order "byte $begin: before this piece, bytes 0 to 65535 of the scene are missing"
    forged overlap "byte $((begin + piece)): this piece is of byte 65528 of the scene and on, which was there up to 65536"
    forged huge "byte $begin: this piece says that the scene has 1152921504606846976 bytes, and so many are not in"
    forged large "byte $size: it ends, and only $total of $((total + 8)) bytes of the scene are there"
    forged zero "byte $begin: "
    forged changed_total "byte $((begin + piece)): this piece says that the scene has $((total + 8)) bytes, and the one before"
    forged far "byte $((begin + piece)): before this piece, "
    forged length "byte $begin: this piece of the scene has a length that cannot be"
    forged empty "byte $begin: this piece of the scene has a length that cannot be"
    forged short "byte $begin: this piece of the scene has a length that cannot be"
    forged small "byte "
    check "other bytes: $(python3 forge.py other 2>&1)" test -s forged.dpr
    limited replay forged.dpr
    check "other bytes: $(cat stderr)" is_refusal 'forged.dpr: the scene that it carries has '
    for change in newer between; do
        check "$change: $(python3 forge.py $change 2>&1)" test -s forged.dpr
        limited replay forged.dpr
        check "$change is read: exit $status, $(cat stdout stderr)" test $status -eq 0
    done
    # A byte of each part of a piece, and some anywhere.
    for byte in 0 4 8 12 16 24 28 32 40 48 20000 65583 65584 90000 131000 200000; do
        python3 forge.py flip $((begin + byte)) $((byte % 8)) 2>python.log
        limited replay forged.dpr
        if is_refusal 'forged.dpr: '; then ok; else bad "byte $byte of the pieces: $reason"; fi
        check "byte $byte of the pieces, the place: $(cat stderr)" grep -q "byte $((begin + byte / piece * piece)): damaged" stderr
    done
    run record info forged.dpr --json
    check "info of a flipped byte: exit $status" test $status -eq 1
    check "in JSON: $(cat stdout)" grep -qE '"damages":1,.*"embedded":\[\{"file":"scene",.*"fault":"byte [0-9]+: damaged' stdout
}

# A recording of the first release that wrote pieces stays readable.
golden()
{
    succeeds 'the golden one' record info "$tests/golden/recording_1_scene.dpr" --json
    check "carries its scene: $(cat stdout)" grep -q \
        '"records":20,.*"embedded":\[{"file":"scene","bytes":[0-9]*,"held":[0-9]*,"pieces":1,"crc32":[0-9]*,"fault":null}\]' stdout
    limited replay "$tests/golden/recording_1_scene.dpr" --json
    check "which replay opens: exit $status, $(cat stdout stderr)" grep -q '"records":' stdout
    # Its friction is solved in another way since.
    limited replay "$tests/golden/recording_0_2.dpr" "$tests/golden/torus_6.dpa" --json
    check "one of 0.2 is replayed: exit $status, $(cat stdout)" grep -q '"records":[2-8][0-9],.*"end":"differs"' stdout
    check "and told to be of another release: $(cat stderr)" grep -q 'release 0.2.0, .*: other bits are no fault' stderr
}

prepare_scenes
without_files
told
refusals
[ "$is_part" ] || damage
golden
finish
