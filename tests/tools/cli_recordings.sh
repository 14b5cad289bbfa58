#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Recordings of runs: written while they last, read wherever they end, replayed bit for bit.
# `sh tests/tools/cli_recordings.sh BUILD`.
. "$(dirname "$0")/cli.sh"

record_bytes=528

# json NAME: a number of the last report in JSON
json()
{
    sed -n "s/.*\"$1\":\([0-9]*\).*/\1/p" stdout
}

# recorded WHAT ARGUMENT...: a run whose recording, run.dpr, replays to the same bits
recorded()
{
    what=$1
    shift
    succeeds "$what" run "$@" --record run.dpr
    run replay run.dpr --json
    check "$what, replayed: exit $status, $(cat stdout stderr)" test $status -eq 0
    check "$what: all of it" grep -q '"same":true,"end":"whole"' stdout
}

replays()
{
    recorded 'a proxy with friction' torus.dpa --device 'sim:?hand=wipe&cycle=1' --ticks 3000 --friction 0.4 --damping 1
    check 'as many ticks' test "$(json ticks)" -eq 3000
    cp run.dpr wipe.dpr
    succeeds 'the same run' run torus.dpa --device 'sim:?hand=wipe&cycle=1' --for 3 --friction 0.4 --damping 1 \
        --record again.dpr
    check 'gives the same bytes' cmp -s wipe.dpr again.dpr
    succeeds 'make liver' make liver 2000 -o liver.obj
    succeeds 'compile liver' compile liver.obj -o liver.dpa
    recorded 'a liver, six degrees of freedom' liver.dpa --device 'sim:?dofs=6&hand=press&cycle=1' --ticks 2000 \
        --friction 0.3 --zoom 2 --length 0.05 --radius 0.003
    recorded 'the bed, on a budget' liver.dpa --device 'sim:?hand=wipe&cycle=1' --ticks 2000 --law bed --budget 200 \
        --at 0,0.1,0 --stiffness 900
    recorded 'the scene of an arm' "$tests/golden/arm_1_mesh_4.dpa" --device 'sim:?dofs=6&hand=wipe&cycle=1' --ticks 2000
    recorded "a mesh and an arm's tool" liver.dpa --tool "$tests/golden/arm_1_mesh_4.dpa" --device 'sim:?hand=press' \
        --ticks 1000
    succeeds 'a trace as before' run torus.dpa --device 'sim:?hand=press' --ticks 50 --record trace.csv
    check 'has its header' grep -qx "$header" trace.csv
}

# What the scene was is in the file; another one is refused.
scenes()
{
    mkdir -p moved
    cp torus.dpa moved/torus.dpa
    succeeds 'another path' replay wipe.dpr moved/torus.dpa
    check 'in words' grep -qx 'wipe.dpr: 3000 ticks, all the same bits' stdout
    refuses 'another mesh' 'another scene than the recording' replay wipe.dpr box.dpa
    refuses 'no tool in it' 'another tool than the recording' replay wipe.dpr --tool "$tests/golden/arm_1_mesh_4.dpa"
    (cd moved && rm torus.dpa && "$program" replay ../wipe.dpr >../stdout 2>../stderr)
    status=$?
    check 'a mesh that is not there' is_refusal 'dynpoint replay: torus.dpa: cannot be opened'
    refuses 'an option for traces' 'unknown option --radius' replay wipe.dpr --radius 1
    run replay wipe.dpr --help
    check 'help of its own' grep -q '^usage: dynpoint replay FILE.dpr' stdout
    refuses 'onto the mesh' 'it is an input too' run torus.dpa --device sim --ticks 5 --record torus.dpa
    refuses 'onto standard output' '--record needs a file' run torus.dpa --device sim --ticks 5 --record -
    refuses 'into no folder' 'cannot be written' run torus.dpa --device sim --ticks 5 --record nowhere/run.dpr
}

info_and_csv()
{
    succeeds 'record info' record info wipe.dpr
    check 'what was recorded' grep -q '^wipe.dpr: 3000 records, 2.999 s at 1000 Hz$' stdout
    check 'and of what' grep -qx '  friction=0.40000000000000002' stdout
    succeeds 'record info --json' record info wipe.dpr --json
    check 'no gap' test "$(json records),$(json missing),$(json damages)" = 3000,0,0
    mv stdout info.json
    succeeds 'record csv' record csv wipe.dpr -o wipe.csv
    check 'a row for each' test "$(grep -c '^[0-9]' wipe.csv)" -eq 3000
    check 'each with all columns' awk -F, 'NR == 1 { n = NF } NF != n { bad = 1 } END { exit bad || n < 60 }' wipe.csv
    succeeds 'to standard output' record csv wipe.dpr -o -
    check 'the same' cmp -s stdout wipe.csv
    refuses 'record alone' 'is needed' record
    refuses 'csv without -o' 'is needed' record csv wipe.dpr
    refuses 'info with -o' 'unknown option -o' record info wipe.dpr -o out/x
    refuses 'no recording' 'not a dynpoint file' record info torus.csv
    refuses 'no file' 'cannot be opened' record info nowhere.dpr
    refuses 'onto itself' 'it is an input too' record csv wipe.dpr -o wipe.dpr
    if ! python3 -c 'import zlib' 2>python.log; then
        skip 'a reader in another language: no python3'
        return
    fi
    check "info --json: $(tail -n 1 python.log)" has_keys info.json path records rate scene asked_max
    # Read by docs/format.md alone. A forged answer, with its checksum made good, must be found.
    python3 - >python.out 2>&1 <<'PYTHON'
import struct, zlib
file = open("wipe.dpr", "rb").read()
magic, version, header_bytes, crc, writer, rate, began, text_bytes, zero = struct.unpack_from("<8sIIIIdQII", file)
assert magic == b"\x89DPR\r\n\x1a\n" and version == 1 and rate == 1000 and began == 0 and zero == 0
assert zlib.crc32(file[:16] + bytes(4) + file[20:header_bytes]) == crc
text = dict(line.split("=", 1) for line in file[48 : 48 + text_bytes].decode().splitlines())
assert text["scene"] == "torus.dpa" and zlib.crc32(open("torus.dpa", "rb").read()) == int(text["scene_crc32"])
rows = [row.split(",") for row in open("wipe.csv").read().splitlines()]
columns = rows.pop(0)
u64 = "number sequence time_ns sent_ns late_ns took_ns".split()
u32 = ("flags result status reasons code buttons fresh commands force_reason force_flags hit_status contact hit_flags"
       " triangle ruptures layers").split()
f64 = ("x y z qw qx qy qz vx vy vz wx wy wz " + " ".join("joint%d" % i for i in range(8)) +
       " asked_fx asked_fy asked_fz asked_tx asked_ty asked_tz sent_fx sent_fy sent_fz sent_tx sent_ty sent_tz"
       " proxy_x proxy_y proxy_z proxy_qw proxy_qx proxy_qy proxy_qz distance gap energy lag point_x point_y point_z depth inside").split()
at = header_bytes
for row in rows:
    kind, size, crc, device = struct.unpack_from("<4I", file, at)
    assert kind == 1 and size == 528 and zlib.crc32(file[at : at + 8] + bytes(4) + file[at + 12 : at + size]) == crc
    numbers = struct.unpack_from("<6Qd14I49d2I", file, at + 16)
    numbers = numbers[:21] + numbers[70:] + numbers[21:70]
    told = dict(zip(u64 + ["dt"] + u32 + f64, numbers), device=device)
    for name, word in zip(columns, row):
        assert float(word) == told[name] if name in f64 + ["dt"] else int(word) == told[name], name
    at += size
assert at == len(file) and len(rows) == 3000
forged = bytearray(file)
begin = header_bytes + 528 * 2000
forged[begin + 16 + 56 + 56 + 8 * 22] ^= 1
forged[begin + 8 : begin + 12] = struct.pack("<I", zlib.crc32(forged[begin : begin + 8] + bytes(4) + forged[begin + 12 : begin + 528]))
open("forged.dpr", "wb").write(forged)
PYTHON
    check "read in another language: $(tail -n 1 python.out)" test ! -s python.out
    run replay forged.dpr
    check "a forged answer: $(cat stdout)" test $status -eq 1
    check 'is named' grep -qE '^forged.dpr: 2000 ticks, all the same bits; then record 2000 differs: asked_fy was .* and is ' stdout
    run replay forged.dpr --json
    check 'in JSON, too' grep -q '"same":false,"end":"differs","record":2000,"field":"asked_fy","recorded":' stdout
}

# Cut, with a record taken out, and with a byte changed.
damage()
{
    size=$(wc -c <wipe.dpr)
    header_bytes=$((size - 3000 * record_bytes))
    for cut in 1 100 527 528 529 1000000; do
        head -c $((size - cut)) wipe.dpr >cut.dpr
        left=$(((size - cut - header_bytes) / record_bytes))
        succeeds "cut by $cut" replay cut.dpr --json
        check "as many ticks: $(cat stdout)" test "$(json ticks)" -eq "$left"
        if [ $((cut % record_bytes)) -eq 0 ]; then end=whole; else end=cut; fi
        check "$end: $(cat stdout)" grep -q "\"end\":\"$end\"" stdout
        succeeds "info of what was cut by $cut" record info cut.dpr --json
        check 'counts them' test "$(json records)" -eq "$left"
    done
    head -c $((header_bytes - 1)) wipe.dpr >cut.dpr
    refuses 'cut in its header' 'ends before its content' record info cut.dpr
    at=$((header_bytes + 1234 * record_bytes))
    { head -c $at wipe.dpr; tail -c +$((at + 3 * record_bytes + 1)) wipe.dpr; } >gap.dpr
    run replay gap.dpr
    check "records that are missing: exit $status" test $status -eq 1
    check "are told: $(cat stdout)" grep -q '^gap.dpr: 1234 ticks, all the same bits; then 3 records are missing from number 1234 on' stdout
    succeeds 'info of them' record info gap.dpr --json
    check 'one gap of three' test "$(json gaps),$(json missing),$(json records)" = 1,3,2997
    { head -c $((at + 77)) wipe.dpr; printf 'damage'; tail -c +$((at + 84)) wipe.dpr; } >damaged.dpr
    run replay damaged.dpr
    check "damage: exit $status" test $status -eq 1
    check "is named: $(cat stdout)" grep -q "^damaged.dpr: 1234 ticks, all the same bits; it is damaged at byte $at," stdout
    run record info damaged.dpr --json
    check "info of it: exit $status" test $status -eq 1
    check 'the others are there' test "$(json records),$(json damages),$(json damaged_bytes)" = 2999,1,$record_bytes
    check 'where it is' test "$(json first_damage)" -eq $at
    # Bytes in between, so that what follows is not where it was.
    { head -c $at wipe.dpr; printf 'noise'; tail -c +$((at + 1)) wipe.dpr; } >noise.dpr
    run record csv noise.dpr -o noise.csv
    check "noise: exit $status" test $status -eq 1
    check "says where: $(cat stderr)" grep -q "noise.dpr: byte $at: damaged; 5 bytes were left out" stderr
    check 'leaves all records' cmp -s noise.csv wipe.csv
}

# Without --reopen a loss ends the run; with it, the recording goes on.
losses()
{
    run run torus.dpa --device 'sim:?hand=press&fault=unplugged@0.5' --ticks 3000 --record lost.dpr
    check "a loss ends the run: exit $status" test $status -eq 2
    succeeds 'its recording' record info lost.dpr --json
    check "has the loss: $(cat stdout)" test "$(json lost),$(json missing)" = 1,0
    check 'and what was before it' test "$(json felt)" -ge 490
    recorded 'a device that comes back' torus.dpa --device 'sim:?hand=press&fault=unplugged@0.5' --ticks 3000 --reopen
    check 'is felt again' test "$(json records)" -eq 3000
    felt=$(json ticks)
    succeeds 'and that recording' record info run.dpr --json
    check "has all ticks: $(cat stdout)" test "$(json lost)" -ge 900
    check 'before and after' test "$felt" -ge 1900
}

# A limit of files is a disk that is full.
full_disk()
{
    (
        ulimit -f 600
        "$program" run torus.dpa --device 'sim:?hand=press' --ticks 3000 --record full.dpr >stdout 2>stderr
    )
    status=$?
    check "a full disk: exit $status" test $status -eq 2
    check "is told: $(cat stderr)" grep -q 'records could not be written' stderr
    check 'and the run goes on' grep -q '^3000 ticks: 3000 with a fresh sample' stdout
    run replay full.dpr --json
    check "what is there is sound: $(cat stdout stderr)" grep -q '"same":true' stdout
    check 'and some is' test "$(json ticks)" -gt 200
}

# killed_after SECONDS: a live run that is killed leaves a recording of what it did until then
killed_after()
{
    "$program" run torus.dpa --device 'sim:?live=1&hand=press&cycle=1' --for 60 --record killed.dpr >killed 2>&1 &
    host=$!
    sleep "$1"
    kill -KILL $host
    wait $host 2>/dev/null
    run replay killed.dpr --json
    [ $status -eq 0 ] && grep -q '"same":true' stdout && [ "$(json ticks)" -gt 50 ] || return
    run record info killed.dpr --json
    [ $status -eq 0 ] && [ "$(json took_max_ns)" -gt 0 ] && [ "$(json began_ns)" -gt 0 ]
}

# What the sweeps of a step may take is replayed as it was recorded; where it is not told, as before 0.3, nothing bounds them.
sweep_budgets()
{
    check 'the default is told' grep -aq 'sweep_budget=4000' wipe.dpr
    if ! command -v python3 >/dev/null 2>&1; then
        skip 'other budgets of sweeps: no python3'
        return
    fi
    cat >rewrite.py <<'PYTHON'
import struct, sys, zlib
file = bytearray(open("wipe.dpr", "rb").read())
size = struct.unpack_from("<I", file, 12)[0]
head = file[:size].replace(b"sweep_budget=4000", sys.argv[1].encode())
head[16:20] = bytes(4)
head[16:20] = struct.pack("<I", zlib.crc32(head))
assert len(head) == size and head[20:] != file[20:size]
open("other.dpr", "wb").write(head + file[size:])
PYTHON
    python3 rewrite.py sweep_budget=0004
    run replay other.dpr --json
    check "four units are not enough: exit $status, $(cat stderr)" test $status -eq 1
    check 'and other bits' grep -q '"same":false' stdout
    python3 rewrite.py sweep_budgex=4000
    run replay other.dpr --json
    check "without the key: exit $status, $(cat stdout stderr)" test $status -eq 0
}

# A busy machine can spoil a try.
kills()
{
    for seconds in 0.3 0.5 1 2 4 8; do
        if killed_after "$seconds"; then
            ok
            return
        fi
    done
    bad "a run that is killed: $(cat stdout stderr)"
}

prepare
replays
sweep_budgets
scenes
info_and_csv
damage
losses
full_disk
kills
finish
