#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# What replay, make and compile answer: columns, the same bytes every time, JSON.
# `sh tests/tools/cli_answers.sh BUILD [part]`.
. "$(dirname "$0")/cli.sh"

answers()
{
    succeeds 'replay' replay box.dpa box.csv -o box.out --law point
    check 'OUT.csv: header' test "$(head -n 1 box.out)" = "$out_header"
    check 'OUT.csv: rows' test "$(wc -l <box.out)" -eq "$(wc -l <box.csv)"
    succeeds 'replay torus' replay torus.dpa torus.csv -o torus.out --radius 0.003 --law point
    check 'OUT.csv: rows, torus' test "$(wc -l <torus.out)" -eq 401
    check 'OUT.csv: fields' test "$(awk -F, 'NF != 30' torus.out | wc -l)" -eq 0
    check 'OUT.csv: ticks' test "$(column torus.out 1)" = "$(column torus.csv 1)"
    check 'OUT.csv: nan or inf' test -z "$(grep -i -e nan -e inf torus.out)"
    check 'OUT.csv: exact' test "$(column torus.out 2 | sort -u)" = exact

    succeeds 'replay --radius' replay box.dpa box.csv -o push.out --radius 0.004 --stiffness 1000 \
        --law point
    # At rest on the faces x = 0.06 and x = -0.06, 2 mm deep: 2 N outward, nothing sideways.
    check "force out of the box: $(column push.out 17 | tr '\n' ' ')" awk -F, '
        NR == 2 && !($17 > 1.99 && $17 < 2.01 && $18 == 0 && $19 == 0 && $3 == "penetrating") ||
        NR == 3 && !($17 < -1.99 && $17 > -2.01 && $18 == 0 && $19 == 0) ||
        NR == 4 && !($3 == "separated" && $17 == 0 && $18 == 0 && $19 == 0 && $20 == 0 &&
            $21 == 0 && $22 == 0 && $6 == 0 && $5 > 0.13) ||
        NR == 5 && !($3 == "penetrating" && $4 == 0) { wrong = 1 }
        END { exit wrong || NR != 5 }' push.out
    check 'a line has no depth outside' awk -F, 'NR > 1 && NR < 5 && ($17 != 0 || $6 != 0) {
        wrong = 1 } END { exit wrong }' box.out

    succeeds '--until track' replay torus.dpa torus.csv -o track.out --until track --radius 0.003
    check '--until track: columns' awk -F, 'NR > 1 && $3 $5 $6 $17 $18 $19 $20 $21 $22 $23 $24 $30 != "" ||
        NF != 30 || $4 == "" { wrong = 1 } END { exit wrong }' track.out
    succeeds '--until contact' replay torus.dpa torus.csv -o contact.out --until contact
    check '--until contact: columns' awk -F, 'NR > 1 && ($3 == "" ||
        $17 $18 $19 $20 $21 $22 != "") { wrong = 1 } END { exit wrong }' contact.out
    check '--until changes the pairs' test "$(cut -d, -f1,4,7-16 torus.out)" = \
        "$(cut -d, -f1,4,7-16 track.out)"

    # What a budget ends is bounded, says no more than it knows, and holds what is true.
    succeeds '--budget' replay torus.dpa torus.csv -o bounded.out --budget 3 --radius 0.003 --json
    check '--budget: work' grep -q '"work":{[^}]*"max":3}' stdout
    check '--budget: columns' awk -F, 'NR == FNR { true_distance[$1] = $4; next }
        $2 == "bounded" { many++; wrong += $3 != "unknown" || $5 $6 != "" || $17 + $18 + $19 != 0 ||
            $16 > true_distance[$1] + 1e-12 || $4 < true_distance[$1] - 1e-12 ||
            $4 - $16 > $15 + 1e-12 }
        $2 == "exact" { wrong += ($4 - true_distance[$1]) ^ 2 > 1e-24 }
        END { exit wrong || !many }' torus.out bounded.out

    for method in exact tree brute; do
        succeeds "--method $method" replay torus.dpa torus.csv -o $method.out --method $method \
            --against brute
        succeeds "--method $method --every" replay torus.dpa torus.csv -o every.out \
            --method $method --against brute --every 7
    done
}

# Two runs, and all instruction sets, give identical bytes.
same_bytes()
{
    succeeds 'make again' make torus 2000 -o again.obj
    succeeds 'compile again' compile torus.obj -o again.dpa
    succeeds 'make sphere' make sphere 20000 -o sphere.stl
    succeeds 'compile sphere' compile sphere.stl -o sphere.dpa
    for threads in 1 2 3 64 4294967297; do
        succeeds "compile -j $threads" compile sphere.stl -o threads.dpa -j $threads
        check "compile -j $threads: other bytes" cmp -s sphere.dpa threads.dpa
    done
    # A leak sanitizer needs the ptrace that strace has, and clones itself.
    if strace -o calls true 2>/dev/null; then
        for threads in '' '-j 1' '-j 4'; do
            ASAN_OPTIONS=detect_leaks=0 strace -f -qq -o calls -e trace=clone,clone3 "$program" compile sphere.stl -o threads.dpa $threads >/dev/null
            check "compile $threads: threads" test "$(grep -c clone calls)" -$([ "$threads" = '-j 4' ] && echo gt || echo eq) 0
        done
    else
        skip 'that -j makes threads: no strace'
    fi
    succeeds 'make trace again' make trace --mesh torus.dpa --ticks 400 -o again.csv
    succeeds 'replay once' replay torus.dpa torus.csv -o torus.out --radius 0.003
    succeeds 'replay again' replay torus.dpa torus.csv -o again.out --radius 0.003 --repeat 3
    for ending in obj dpa csv out; do
        check "two runs: other bytes in .$ending" cmp -s torus.$ending again.$ending
    done
    succeeds 'make --seed' make star --seed 2 -o seed2.obj
    succeeds 'make star' make star -o seed0.obj
    check 'make: the seed is not used' test -n "$(cmp seed2.obj seed0.obj 2>&1)"
    succeeds 'make trace --seed' make trace --mesh torus.dpa --ticks 400 --seed 2 -o seed.csv
    check 'make trace: the seed is not used' test -n "$(cmp torus.csv seed.csv 2>&1)"
    for kernel in scalar sse2 avx2 avx512 neon; do
        run replay torus.dpa torus.csv -o kernel.out --radius 0.003 --kernel $kernel
        if [ $status -eq 2 ] && grep -q "kernel $kernel: .* does not have" stderr; then
            skip "kernel $kernel: not on this machine"
        else
            check "kernel $kernel: exit $status" test $status -eq 0
            check "kernel $kernel: other bytes" cmp -s torus.out kernel.out
        fi
        rm -f kernel.out
    done
    # The four formats hold the same mesh.
    for ending in obj ply stl off; do
        succeeds "make $ending" make torus 2000 -o form.$ending
        succeeds "compile $ending" compile form.$ending -o form.dpa
        succeeds "replay $ending" replay form.dpa torus.csv -o form.out --radius 0.003
        check "$ending: another answer" cmp -s torus.out form.out
        check "$ending: wound inward" test "$(info_count form.dpa turned_triangles)" = 0
    done
    succeeds 'compile in mm' compile torus.obj -o mm.dpa --scale 0.001
    check 'compile: the scale is not used' test -n "$(cmp torus.dpa mm.dpa 2>&1)"
}

# Each shape, with its usual number of triangles and with another one.
shapes()
{
    for wanted in torus:5568 torus:32 liver::50332 liver:200 stomach::20000 stomach:201 \
        spleen::10000 membrane::512 membrane:2 cloth::2048 star::20480 sphere:1000 box::12 \
        box:1200 hub:3 hub:5000 wall::1024 wall:64; do
        number=${wanted#*:}
        # shellcheck disable=SC2086
        succeeds "make $wanted" make ${wanted%%:*} ${number%:*} -o shape.ply
        succeeds "compile $wanted" compile shape.ply -o shape.dpa
        found=$(info_count shape.dpa triangles)
        check "make $wanted: $found triangles" test "$found" = "${wanted##*:}"
    done
    listed=$(run make --help && awk '/^  SHAPE/ { on = 1; next } on { print $1 }' stdout |
        tr '\n' ' ')
    check "shapes that are not tried here: $listed" test "$listed" = \
        'torus liver stomach spleen membrane cloth star sphere box hub wall laparoscopic '

    succeeds 'make laparoscopic' make laparoscopic -o scene.ply
    sum=0
    for body in liver stomach spleen; do
        succeeds "compile $body" compile scene-$body.ply -o body.dpa
        found=$(info_count body.dpa triangles)
        sum=$((sum + ${found:-0}))
    done
    check "laparoscopic: $sum triangles" test $sum -eq 5387
    check 'laparoscopic: a fourth file' test ! -e scene.ply
    refuses 'make laparoscopic: no such folder' none/ make laparoscopic -o none/scene.ply
    echo keep >some-liver.ply && mkdir some-spleen.ply
    refuses 'make laparoscopic: a folder in its way' some-spleen.ply make laparoscopic -o some.ply
    check 'all three, or those that were there' test "$(ls -d some-*)$(cat some-liver.ply)" = \
        "$(printf 'some-liver.ply\nsome-spleen.ply')keep"
}

# histograms_hold FILE: of a replay's summary; they count each tick once, its median and largest too
histograms_hold()
{
    python3 -c '
import bisect, json, sys
found = json.load(open(sys.argv[1]))
for of in "ns", "work":
    edges, counts = found[of + "_histogram"]["edges"], found[of + "_histogram"]["counts"]
    assert edges == sorted(set(edges)) and len(counts) == len(edges) + 1, of
    assert sum(counts) == found["ticks"] - 1, "%s: %d counted" % (of, sum(counts))
    for name, share in ("median", 0.5), ("max", 1.0):
        place = bisect.bisect_right(edges, found[of][name])
        below = sum(counts[:place])
        assert not sum(counts) or below < share * sum(counts) <= below + counts[place], of + name
' "$@" 2>python.log
}

json()
{
    if ! python3 -c 'import json' 2>python.log; then
        skip 'JSON: no python3'
        return
    fi
    run info box.dpa --json
    mv stdout info.json
    check "info --json: $(tail -n 1 python.log)" has_keys info.json triangles vertices scale \
        rounding open_edges nonmanifold_edges crease_edges crease self_intersections self_intersections_more components dropped dropped.degenerate \
        dropped.duplicate sections
    times=
    for name in ns ns_crossing ns_other; do
        times="$times $name.median $name.p99 $name.p999 $name.max"
    done
    trace one.csv 0,1,0,0,1,1,0
    for file in torus.csv one.csv; do
        for option in '' '--until track' '--against brute' '--repeat 2 --method brute'; do
            # shellcheck disable=SC2086
            run replay torus.dpa $file -o json.out --json $option
            mv stdout replay.json
            # shellcheck disable=SC2086
            check "replay --json $option: $(tail -n 1 python.log)" has_keys replay.json ticks \
                exact bounded local stale separated touching penetrating $times first_ns \
                work.median work.p99 work.max bytes kernel ns_histogram work_histogram
            if histograms_hold replay.json; then ok
            else bad "replay --json $option: histograms: $(tail -n 1 python.log)"; fi
        done
    done
    for strip in shadow routes; do
        run replay torus.dpa torus.csv -o json.out --json --radius 0.01 --strip $strip
        mv stdout replay.json
        check "replay --strip $strip: $(tail -n 1 python.log)" has_keys replay.json strips.ticks \
            strips.median strips.p99 strips.max strips.full
    done
    refuses 'a strip that there is not' "--strip: 'line' is none of none, shadow, routes" \
        replay torus.dpa torus.csv -o out/o.csv --strip line
}

prepare
answers
same_bytes
shapes
[ "$is_part" ] || json
finish
