#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The traces that replay reads: well-formed or not, and those that do not end.
# `sh tests/tools/cli_traces.sh BUILD`.
. "$(dirname "$0")/cli.sh"

bad_traces()
{
    trace few.csv 0,1,2,3,4,5
    refuses 'trace: too few fields' 'few.csv:2: there are too few fields' replay box.dpa few.csv -o out/x
    trace many.csv 0,1,2,3,4,5,6 1,1,2,3,4,5,6,7
    refuses 'trace: too many fields' 'many.csv:3: there are too many fields' replay box.dpa many.csv -o out/x
    for word in nan inf -inf x '' 1.5.2 '1 2' 1e7 -1000001 1e400 0x1; do
        trace word.csv 0,1,2,3,4,5,6 "1,1,$word,3,4,5,6"
        refuses "trace: coordinate '$word'" word.csv:3: replay box.dpa word.csv -o out/x
        trace last.csv "0,1,2,3,4,5,$word"
        refuses "trace: last coordinate '$word'" last.csv:2: replay box.dpa last.csv -o out/x
    done
    for word in 0 -1 1.5 nan '' 1e30 x; do
        trace tick.csv 0,1,2,3,4,5,6 "$word,1,2,3,4,5,6"
        refuses "trace: tick '$word' behind 0" tick.csv:3: replay box.dpa tick.csv -o out/x
    done
    for word in 9007199254740992 9007199254740993 -9007199254740993 1e30; do
        trace tick.csv "$word,1,2,3,4,5,6"
        refuses "trace: tick '$word'" 'tick.csv:2: the tick is not within 2^53' \
            replay box.dpa tick.csv -o out/x
    done
    printf '\n# note\n%s\r\n\r\n \n0,1\n' $header >below.csv
    refuses 'trace: below blank lines' below.csv:6: replay box.dpa below.csv -o out/x
    echo 0,1,2,3,4,5,6 >headless.csv
    refuses 'trace: no header' headless.csv:1: replay box.dpa headless.csv -o out/x
    { echo $header; printf '\357\273\2770,1,2,3,4,5,6\n'; } >marked.csv
    refuses 'trace: a byte order mark that is none' marked.csv:2: replay box.dpa marked.csv -o out/x
    printf 'time,ax,ay,az,bx,by,bz\n0,1,2,3,4,5,6\n' >other.csv
    refuses 'trace: wrong header' 'other.csv:1: the header is not tick,ax,ay,az,bx,by,bz' \
        replay box.dpa other.csv -o out/x
    : >empty.csv
    refuses 'trace: empty' empty.csv replay box.dpa empty.csv -o out/x
    trace rowless.csv
    refuses 'trace: no row' rowless.csv replay box.dpa rowless.csv -o out/x
    refuses 'trace: missing' none.csv replay box.dpa none.csv -o out/x
    refuses 'trace: a mesh' box.dpa replay box.dpa box.dpa -o out/x
    refuses 'trace: a folder' 'out: cannot be read' replay box.dpa out -o out/x
    { echo $header; head -c 1100000 /dev/zero | tr '\0' 7; } >wide.csv
    refuses 'trace: a line without end' 'wide.csv:2: the line is longer than 1 MiB' replay box.dpa wide.csv -o out/x
    refuses 'trace: a line without end' 'wide.csv:2: the line is longer than 1 MiB' \
        device watch replay:wide.csv
}

# What is wrong ends a pipe that does not end, and one that waits: no second row is needed, nor memory.
endless_traces()
{
    rm -f pipe && mkfifo pipe
    trace twice.csv 0,1,2,3,4,5,6 0,1,2,3,4,5,6
    for rest in 'yes 5,1,2,3,4,5,6' 'sleep 60'; do
        for reader in 'replay box.dpa pipe -o out/x' 'device watch replay:pipe'; do
            # shellcheck disable=SC2086
            { cat twice.csv; exec $rest; } >pipe 2>pipe.log &
            # shellcheck disable=SC2086
            timeout 20 "$program" $reader >stdout 2>stderr </dev/null
            status=$?
            if is_refusal 'pipe:3: the first column does not increase'; then ok
            else bad "trace: $rest, $reader: $reason"; fi
            { kill $! && wait $!; } 2>/dev/null
        done
    done
    rm -f pipe
}

good_traces()
{
    trace plain.csv 0,1,2,3,4,5,6 1,1,2,3,4,5,6.5 7,-1e-3,.5,+3,4.,5E0,6
    succeeds 'trace: plain' replay box.dpa plain.csv -o plain.out
    sed 's/$/\r/' plain.csv >crlf.csv
    { echo '# a comment'; echo; sed 's/^1,/# 0,between\n\n  \n \t# 0,b,c\n1,/' plain.csv; echo '# end'; } \
        >comments.csv
    printf %s "$(cat plain.csv)" >unended.csv
    sed 's/,/ , /g; 1s/ //g' plain.csv >blanks.csv
    for form in plain crlf comments; do
        { printf '\357\273\277'; cat $form.csv; } >marked_$form.csv
    done
    for form in crlf comments unended blanks marked_plain marked_crlf marked_comments; do
        succeeds "trace: $form" replay box.dpa $form.csv -o $form.out
        check "trace: $form differs" cmp -s plain.out $form.out
    done
    # Byte by byte, with a comment that is longer than what is read at once.
    { head -c 100000 /dev/zero | tr '\0' '#'; echo; cat plain.csv; } >long.csv
    succeeds 'trace: a long comment' replay box.dpa long.csv -o long.out
    check 'trace: a long comment differs' cmp -s plain.out long.out
    dd if=comments.csv bs=1 2>dd.log | "$program" replay box.dpa - -o bytes.out >stdout 2>stderr
    check "trace: byte by byte: $(cat stderr)" cmp -s plain.out bytes.out
    # On a face's diagonal either triangle is nearest: history decides, and a teleport forgets it.
    trace fresh.csv 0,0.07,0,0,0.08,0,0
    succeeds 'trace: fresh' replay box.dpa fresh.csv -o fresh.out
    for y in 0.03 -0.03; do
        trace past.csv 0,0.07,$y,0,0.08,$y,0 1,0.07,0,0,0.08,0,0 9,0.07,0,0,0.08,0,0
        succeeds 'trace: past' replay box.dpa past.csv -o past.out
        found=$(column past.out 14 | tr '\n' ' ')
        check "trace: triangles $found" test "$found" = "$(column past.out 14 | sed -n '1{p;p;}' |
            tr '\n' ' ')$(column fresh.out 14) "
    done
    # A tick that is not the last one plus 1 is a teleport: a row like any other, its own number.
    trace gap.csv 5,1,0,0,1,1,0 6,1,0,0,1,1,0 100,0.1,0,0,1,1,0 101,0.1,0,0,1,1,0
    succeeds 'trace: gap' replay box.dpa gap.csv -o gap.out
    check 'trace: gap changes the ticks' test "$(column gap.out 1 | tr '\n' ' ')" = '5 6 100 101 '
    trace far.csv -9007199254740991,1,0,0,1,1,0 9007199254740990,1,0,0,1,1,0 9007199254740991,1,0,0,1,1,0
    succeeds 'trace: the farthest ticks' replay box.dpa far.csv -o far.out
    check 'trace: the farthest ticks change' test "$(column far.out 1)" = "$(column far.csv 1)"
    trace negative.csv -3,1,0,0,1,1,0 -2,1,0,0,1,1,0
    succeeds 'trace: negative ticks' replay box.dpa negative.csv -o negative.out
}

# A trace in millimetres is noted where a trace is read, and one in metres is not, near or far.
units()
{
    awk -F, 'NR == 1 { print; next } { printf "%d", $1; for (i = 2; i <= 7; i++) printf ",%.9g", 1000 * $i; print "" }' \
        torus.csv >millimetres.csv
    notes 'a trace in millimetres' 'are its numbers millimetres?' replay torus.dpa millimetres.csv -o mm.out
    notes 'a trace in metres' '' replay torus.dpa torus.csv -o m.out
    trace far.csv 0,5,0,0,6,0,0 1,5,0,0,6,0,0
    notes 'a trace that is far' '' replay torus.dpa far.csv -o far.out
    run chart torus.dpa millimetres.csv -o out/x
    check 'a chart of 400 ticks is refused before' grep -q 'at least' stderr
}

prepare
bad_traces
endless_traces
good_traces
units
finish
