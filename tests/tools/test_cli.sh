#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
#
# The program from outside: exit status, what goes to which stream, which files are there then.
#
#     sh tests/tools/test_cli.sh BUILD_DIR
#
# An error is exit status 2, exactly one line on standard error, nothing on standard output, and no
# output file, nor the .part beside it. Everything is written below a folder in BUILD_DIR.

build=${1:?usage: sh tests/tools/test_cli.sh BUILD_DIR}
tests=$(cd "$(dirname "$0")/.." && pwd) || exit 2
build=$(cd "$build" && pwd) || exit 2
program=$build/dynpoint
work=$build/tests/cli.$$
passed=0 failed=0 skipped=0
LC_ALL=C
export LC_ALL

mkdir -p "$work/out" || exit 2
trap 'rm -rf "$work"' EXIT
trap 'exit 2' HUP INT TERM
cd "$work" || exit 2

ok()
{
    passed=$((passed + 1))
}

bad()
{
    failed=$((failed + 1))
    printf '  FAIL %s\n' "$*"
}

skip()
{
    skipped=$((skipped + 1))
    printf '  skip %s\n' "$*"
}

# Only what fails is named, and the last line counts: a hundred golden files would hide it.
check()
{
    what=$1
    shift
    if "$@"; then ok; else bad "$what"; fi
}

run()
{
    "$program" "$@" >stdout 2>stderr </dev/null
    status=$?
}

# succeeds WHAT ARGUMENT...
succeeds()
{
    what=$1
    shift
    run "$@"
    if [ $status -eq 0 ]; then ok; else bad "$what: exit $status: $(cat stderr)"; fi
}

# What an error must look like once it is in stdout, stderr and $status; TEXT is to be in its line.
is_refusal()
{
    text=$1
    [ $status -eq 2 ] || { reason="exit $status"; return 1; }
    [ ! -s stdout ] || { reason='something on standard output'; return 1; }
    [ "$(wc -l <stderr)" -eq 1 ] || { reason="$(wc -l <stderr) lines"; return 1; }
    [ -n "$(tail -c 1 stderr)" ] && { reason='no end of line'; return 1; }
    grep -qF -e "$text" stderr || { reason="no '$text' in: $(cat stderr)"; return 1; }
    [ -z "$(ls -A out)" ] || { reason="left out/$(ls -A out)"; return 1; }
}

# refuses WHAT TEXT ARGUMENT...
refuses()
{
    what=$1 expected=$2
    shift 2
    run "$@"
    if is_refusal "$expected"; then ok; else bad "$what: $reason"; fi
    rm -rf out && mkdir out
}

# notes WHAT TEXT ARGUMENT...: done, with TEXT in the one line on standard error; no TEXT, no line
notes()
{
    what=$1 expected=$2
    shift 2
    succeeds "$what" "$@"
    if [ -z "$expected" ]; then
        check "$what: $(cat stderr)" test ! -s stderr
    elif [ "$(wc -l <stderr)" -eq 1 ] && grep -qF -e "$expected" stderr; then ok
    else bad "$what: no '$expected' in: $(cat stderr)"; fi
}

# A number of `info --json` that stands at its beginning: triangles, vertices, ...
info_count()
{
    "$program" info "$1" --json | sed -n "s/^[^[]*[{,]\"$2\":\([0-9]*\)[,}].*/\1/p"
}

header=tick,ax,ay,az,bx,by,bz
out_header=tick,status,contact,distance,gap,depth,s,px,py,pz,qx,qy,qz,triangle,error_bound
out_header=$out_header,lower_bound,fx,fy,fz,tx,ty,tz

# trace FILE ROW...
trace()
{
    file=$1
    shift
    { echo $header; for row; do echo "$row"; done; } >"$file"
}

# column FILE N: the Nth of each row behind the header
column()
{
    awk -F, -v n="$2" 'NR > 1 { print $n }' "$1"
}

prepare()
{
    succeeds 'make box' make box -o box.ply
    succeeds 'compile box' compile box.ply -o box.dpa
    succeeds 'make torus' make torus 2000 -o torus.obj
    succeeds 'compile torus' compile torus.obj -o torus.dpa
    succeeds 'make trace' make trace --mesh torus.dpa --ticks 400 -o torus.csv
    # Beside the box's faces at x = 0.06 and x = -0.06, then far away, then right through it.
    trace box.csv 0,0.062,-0.02,0,0.062,0.02,0 1,-0.062,-0.02,0,-0.062,0.02,0 \
        2,0.2,0,0,0.2,1,0 3,-1,0.01,0.01,1,0.01,0.01
}

help_and_version()
{
    for command in '' make compile info replay 'make trace'; do
        for option in --help --version; do
            # shellcheck disable=SC2086
            run $command $option
            check "$command $option: exit $status" test $status -eq 0
            check "$command $option: nothing printed" test -s stdout
            check "$command $option: $(cat stderr)" test ! -s stderr
        done
    done
    for command in make compile info replay 'make trace'; do
        # shellcheck disable=SC2086
        run $command --help
        check "$command --help: whose?" grep -q "^usage:.*dynpoint $command" stdout
    done
}

usage_errors()
{
    refuses 'no command' 'command'
    refuses 'unknown command' frobnicate frobnicate
    refuses 'option for a command' --json --json
    for command in make compile info replay; do
        refuses "$command alone" "dynpoint $command: " $command
        refuses "$command: unknown option" --frob $command --frob
        refuses "$command: surplus words" "dynpoint $command: " $command a b c d -o out/x.ply
    done
    refuses 'make trace: no -o' 'dynpoint' make trace --mesh box.dpa
    refuses 'compile: -o without value' -- -o compile box.ply -o
    refuses 'compile: --scale without value' --scale compile box.ply -o out/x --scale
    for value in nan inf -1 0 one 1x '' 1,5 0x10; do
        refuses "compile --scale '$value'" scale compile box.ply -o out/x --scale "$value"
    done
    for value in 0 -1 1.5 many '' 99999999999999999999; do
        refuses "compile -j '$value'" j compile box.ply -o out/x -j "$value"
    done
    for value in nan inf -1 0 180.1 sharp ''; do
        refuses "compile --crease '$value'" crease compile box.ply -o out/x --crease "$value"
    done
    for value in '' 9a a-b 'a b' 'x;y' int class restrict _Bool uint64_t; do
        refuses "compile --c-array '$value'" "$value" compile box.ply -o out/x --c-array "$value"
    done
    for pair in radius:nan radius:inf radius:-0.001 radius:1e7 radius:wide radius: dt:0 dt:-1 \
        dt:nan dt:inf dt:soon stiffness:nan stiffness:inf stiffness:-1 stiffness:2e9 \
        stiffness:hard repeat:0 repeat:-1 repeat:1.5 repeat:many repeat:99999999999999999999 \
        radius:1e7:1e6 strip-width:1e7:1e6 dt:1e7:1e6 every:-1 every:1.5 every:20:against budget:-1 budget:1.5 budget:4294967296 budget:few method:guess against:guess until:lunch kernel:abacus; do
        name=${pair%%:*} value=${pair#*:}
        expected=$name
        [ "$name" = against ] && expected=method
        [ "$value" = "${value#*:}" ] || expected=${value#*:}
        refuses "replay --$pair" "$expected" \
            replay box.dpa box.csv -o out/x --"$name" "${value%%:*}"
    done
    for method in tree brute paper; do
        refuses "replay --budget with $method" budget replay box.dpa box.csv -o out/x \
            --method $method --budget 8
    done
    refuses 'replay --json beside -o -' json replay box.dpa box.csv -o - --json
    for name in ticks length band speed; do
        for value in nan inf -1 1e300 1e999 long; do
            refuses "make trace --$name $value" $name \
                make trace --mesh box.dpa -o out/x --ticks 3 --$name $value
        done
    done
    refuses 'make trace --ticks 0' ticks make trace --mesh box.dpa -o out/x --ticks 0
    refuses 'make: unknown shape' pyramid make pyramid -o out/x.ply
    refuses 'make: no format' x.xyz make box -o out/x.xyz
    refuses 'make: no ending' 'dynpoint' make box -o out/x
    for count in 0 -12 12.5 13 one 11 99999999999 99999999999999999999; do
        refuses "make box $count" 'dynpoint make: ' make box "$count" -o out/x.ply
    done
    refuses 'make torus without number' torus make torus -o out/x.ply
    refuses 'make laparoscopic, too few' 'dynpoint' make laparoscopic 999 -o out/x.ply
    refuses 'replay --every 0' 'must be 1' replay box.dpa box.csv -o out/x --against brute --every 0
    refuses 'make trace: bad seed' 'dynpoint make trace: --seed' make trace --mesh box.dpa -o out/x --seed -1
    refuses 'make: bad seed' seed make box -o out/x.ply --seed -1
}

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

bad_inputs()
{
    refuses 'compile: missing' none.obj compile none.obj -o out/x
    refuses 'compile: a folder' out compile out -o out/x
    for option in '' --json --verify '--verify --json'; do
        # shellcheck disable=SC2086
        refuses "info $option: missing" none.dpa info none.dpa $option
        # shellcheck disable=SC2086
        refuses "info $option: a folder" out info out $option
    done
    refuses 'replay: mesh missing' none.dpa replay none.dpa box.csv -o out/x
    refuses 'make trace: mesh missing' none.dpa make trace --mesh none.dpa -o out/x
    refuses 'no name' 'dynpoint' compile '' -o out/x
    printf 'v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n' >line.obj
    : >nothing.obj
    refuses 'compile: only a line' line.obj compile line.obj -o out/x
    refuses 'compile: no bytes' nothing.obj compile nothing.obj -o out/x
    cp box.dpa compiled.obj
    refuses 'compile: compiled already' 'compiled.obj: this is compiled already' compile compiled.obj -o out/x
    refuses 'compile: not a mesh' box.csv compile box.csv -o out/x
    refuses 'compile: too large' box.ply compile box.ply -o out/x --scale 1e9

    size=$(wc -c <box.dpa)
    { printf X; tail -c +2 box.dpa; } >magic.dpa
    head -c $((size - 1)) box.dpa >short.dpa
    head -c 100 box.dpa >stub.dpa
    { cat box.dpa; printf x; } >long.dpa
    : >nothing.dpa
    damage box.dpa version.dpa 12 4
    damage box.dpa sum.dpa $((size - 100)) 170
    sed 's/$/\r/' box.dpa >text.dpa
    for name in magic short stub long nothing version sum text; do
        refuses "info: $name" $name.dpa: info $name.dpa
        refuses "replay: $name" $name.dpa: replay $name.dpa box.csv -o out/x
        refuses "make trace: $name" $name.dpa: make trace --mesh $name.dpa -o out/x
        run info $name.dpa --verify
        check "info --verify: $name: exit $status" test $status -eq 1
        check "info --verify: $name: $(cat stdout)" grep -q "$name.dpa.*byte [0-9]" stdout
        run info $name.dpa --verify --json
        check "info --verify --json: $name: exit $status" test $status -eq 1
    done
    refuses 'info: newer' newer info version.dpa
    refuses 'info: checksum' normals info sum.dpa
    run info --verify box.dpa
    check "info --verify: exit $status" test $status -eq 0
    run info --verify --json box.dpa
    check "info --verify --json: exit $status" test $status -eq 0
}

# Two triangles that cross, two that touch; a file that does not tell.
self_intersections()
{
    printf 'v 0 0 0\nv 2 0 0\nv 0 2 0\nv 0.5 0.5 %s\nv 0.5 0.5 1\nv 1 1 1\nf 1 2 3\nf 4 5 6\n' -1 >cross.obj
    sed 's/-1/0/' cross.obj >touch.obj
    succeeds 'compile: two that cross' compile cross.obj -o cross.dpa
    check "compile: $(cat stdout)" grep -q 'self-intersections: 1 pair of triangles, 0 and 1$' stdout
    run info cross.dpa
    check "info: two that cross" grep -q '^  self-intersections *1$' stdout
    check 'info --json: two that cross' test "$(info_count cross.dpa self_intersections)" = 1
    succeeds 'compile: two that touch' compile touch.obj -o touch.dpa
    check "compile: $(cat stdout)" test "$(grep -c self stdout)" -eq 0
    check 'info --json: two that touch' test "$(info_count touch.dpa self_intersections)" = 0
    run info "$tests/golden/torus_3.dpa"
    check "info: format 3" grep -q '^  self-intersections *not known$' stdout
    run info "$tests/golden/torus_3.dpa" --json
    check "info --json: format 3" grep -q '"self_intersections":null,' stdout
}

# damage FROM TO AT VALUE: a copy with one byte changed; the value is used, or the one above it
damage()
{
    cp "$1" "$2"
    old=$(od -An -tu1 -j "$3" -N 1 "$1" | tr -d ' ')
    new=$4
    [ "$old" -eq "$new" ] && new=$((new + 1))
    printf "\\$(printf %03o "$new")" | dd of="$2" bs=1 seek="$3" conv=notrunc 2>dd.log
}

# What is read comes once, from whatever it is: more than a buffer of it, and nothing is lost.
pipes()
{
    rm -f pipe && mkfifo pipe
    for file in torus.obj torus.ply; do
        succeeds "make $file" make torus 2000 -o $file
        succeeds "compile $file" compile $file -o direct.dpa
        cat $file >pipe &
        timeout 60 "$program" compile pipe -o pipe.dpa >stdout 2>stderr
        check "compile a pipe, $file: exit $?: $(cat stderr)" test -e pipe.dpa
        { kill $! && wait $!; } 2>/dev/null
        check "compile a pipe, $file: other bytes" cmp -s direct.dpa pipe.dpa
        for name in - /dev/stdin; do
            rm -f pipe.dpa
            # shellcheck disable=SC2002
            cat $file | "$program" compile $name -o pipe.dpa >stdout 2>stderr
            check "compile $name, $file: $(cat stderr)" cmp -s direct.dpa pipe.dpa
        done
    done
    "$program" replay - torus.csv -o piped.out <torus.dpa >stdout 2>stderr
    "$program" replay torus.dpa torus.csv -o direct.out >stdout 2>stderr
    check 'replay -' cmp -s piped.out direct.out
    # shellcheck disable=SC2002
    cat "$tests/../docs/samples/arm.urdf" | "$program" compile - -o out/x >stdout 2>stderr
    status=$?
    if is_refusal 'a URDF is read from a file'; then ok; else bad "a URDF from a pipe: $reason"; fi
    rm -f pipe
}

# Files that the readers refuse, and odd ones that they take: tests/golden-bad/expected.txt.
golden_files()
{
    count=0
    while read -r name result kind place; do
        case $name in '#'* | '') continue ;; esac
        count=$((count + 1))
        file=$tests/golden-bad/$name
        where=$name
        case $kind-$place in
        line-*) where=$name:$place: ;;
        byte-0) ;; # as good as no place
        byte-*) where="byte $place" ;;
        esac
        case $result in
        DPT_E_*)
            refuses "golden $name" "$name" compile "$file" -o out/x
            check "golden $name: no '$where' in: $(cat stderr)" grep -qF "$where" stderr
            ;;
        0)
            refuses "golden $name" "$name" compile "$file" -o out/x
            ;;
        *)
            # A file whose triangles are all degenerate reads well and has nothing to feel.
            run compile "$file" -o golden.dpa
            if [ $status -eq 0 ]; then
                check "golden $name" test "$("$program" info golden.dpa --json |
                    sed 's/.*"source":{"triangles":\([0-9]*\),.*/\1/')" -eq "$result"
            else
                check "golden $name: $(cat stderr)" grep -q degenerate stderr
            fi
            ;;
        esac
    done <"$tests/golden-bad/expected.txt"
    check 'golden files: too few' test $count -gt 100
}

outputs()
{
    refuses 'make: no such folder' none/x.ply make box -o none/x.ply
    refuses 'compile: no such folder' none/x.dpa compile box.ply -o none/x.dpa
    refuses 'replay: no such folder' none/x.csv replay box.dpa box.csv -o none/x.csv
    refuses 'make trace: no such folder' none/x.csv make trace --mesh box.dpa -o none/x.csv
    mkdir -p folder.ply
    refuses 'make: output is a folder' folder.ply make box -o folder.ply
    check 'folder.ply.part is left' test ! -e folder.ply.part

    # A full disk, by the limit on a file's size: what was there stays, nothing is left beside it.
    succeeds 'make for full disk' make torus 20000 -o large.ply
    full small.dpa compile box.ply -o small.dpa # fails as the file is closed
    full make.ply make torus 20000 -o make.ply
    full compile.dpa compile large.ply -o compile.dpa
    full replay.csv replay torus.dpa torus.csv -o replay.csv
    full trace.csv make trace --mesh torus.dpa --ticks 1000 -o trace.csv
    echo keep >kept.dpa
    refuses 'compile over a file' none.obj compile none.obj -o kept.dpa
    trace few.csv 0,1
    refuses 'replay over a file' few.csv replay box.dpa few.csv -o kept.dpa
    check 'kept.dpa has changed' test "$(cat kept.dpa)" = keep
    "$program" compile box.ply -o - >stdout.dpa 2>stderr
    check 'compile -o -' cmp -s stdout.dpa box.dpa
    "$program" replay box.dpa box.csv -o box.out >stdout 2>stderr
    "$program" replay box.dpa box.csv -o - >stdout.out 2>stderr
    check 'replay -o -' cmp -s stdout.out box.out
    "$program" make trace --mesh torus.dpa --ticks 400 -o - >stdout.csv 2>stderr
    check 'make trace -o -' cmp -s stdout.csv torus.csv
    check 'a file is named -' test ! -e -
    chmod 640 kept.dpa
    succeeds 'compile over a file' compile box.ply -o kept.dpa
    check 'its permissions have changed' test "$(ls -l kept.dpa | cut -c 1-10)" = -rw-r-----
    overwrites box.ply compile box.ply -o box.ply
    overwrites box.dpa replay box.dpa box.csv -o box.dpa
    overwrites box.csv replay box.dpa box.csv -o ./box.csv
    overwrites torus.dpa make trace --mesh torus.dpa -o torus.dpa
    overwrites box.dpa run box.dpa --device sim --ticks 5 --record box.dpa
    overwrites box.csv run box.dpa --device 'replay:./box.csv?rate=500' --ticks 2 --record box.csv
    printf '\357\273\277t,x,y,z\n0,0,0,0\n' >hand.csv
    mkdir -p C:
    cp box.csv C:/record.csv
    overwrites C:/record.csv run box.dpa --device 'replay:C:/record.csv?rate=500' --ticks 2 --record C:/record.csv
    overwrites hand.csv run box.dpa --device 'sim:?dofs=3&hand=hand.csv' --ticks 5 --record hand.csv
    refuses 'a record beside the report' '--record needs a file' run box.dpa --device sim --ticks 5 --record -
    refuses 'a record nowhere, before anything is felt' 'nowhere/r.csv: cannot be written' \
        run box.dpa --device sim --ticks 5 --record nowhere/r.csv
    refuses 'a record of no device' 'no driver' run box.dpa --device nothing --ticks 5 --record out/r.csv
    ln -s box.ply link.ply
    cp box.ply beside.PLY
    refuses 'over a source beside its input' 'a source by its name' compile box.ply -o beside.PLY
    check 'a source beside the input has changed' cmp -s box.ply beside.PLY
    overwrites box.ply compile box.ply -o link.ply
    overwrites box.ply compile link.ply -o box.ply
    rm link.ply
    mkfifo pipe
    cat pipe >through &
    "$program" make box -o box-pipe.ply && "$program" compile box-pipe.ply -o pipe >/dev/null
    wait $!
    "$program" compile box-pipe.ply -o direct.dpa >/dev/null
    if [ -p pipe ] && cmp -s through direct.dpa; then ok; else bad "a pipe as output is replaced"; fi
    ln -s target.dpa link.dpa
    "$program" compile box-pipe.ply -o link.dpa >/dev/null
    if [ -L link.dpa ] && cmp -s target.dpa direct.dpa; then ok; else bad "a link as output is replaced"; fi
    rm -f pipe through box-pipe.ply direct.dpa link.dpa target.dpa
    # The reader of what is printed has gone.
    (sleep 0.5; "$program" compile box.ply -o out/x 2>stderr; echo $? >code) | true
    status=$(cat code)
    : >stdout
    if is_refusal 'Broken pipe'; then ok; else bad "compile | true: $reason"; fi
    if [ -c /dev/full ]; then
        for command in 'compile box.ply -o -' 'replay box.dpa box.csv -o -' 'info box.dpa' \
            'info box.dpa --json' 'replay box.dpa box.csv -o box.out --json' --help \
            'make trace --mesh torus.dpa --ticks 1000 -o -' 'make --help' 'compile box.ply -o out/x' \
            'make laparoscopic -o out/x.ply' 'replay box.dpa box.csv -o out/x' \
            'replay box.dpa box.csv -o out/x --json' 'info magic.dpa --verify'; do
            # shellcheck disable=SC2086
            "$program" $command >/dev/full 2>stderr
            status=$?
            : >stdout
            if is_refusal 'No space left'; then ok; else bad "$command >/dev/full: $reason"; fi
            rm -rf out && mkdir out
        done
        refuses 'compile -o /dev/full' 'No space left' compile large.ply -o /dev/full
    else
        skip 'standard output that is full: no /dev/full'
    fi
}

# overwrites FILE ARGUMENT...: refused, for FILE is an input; it is as it was
overwrites()
{
    file=$1
    shift
    cp "$file" before
    refuses "$1 over its input $file" 'it is an input too' "$@"
    check "$1 over its input: $file has changed" cmp -s "$file" before
    cp before "$file"
}

# full FILE ARGUMENT...: the command fails as it writes, and FILE still says "keep"
full()
{
    file=$1
    shift
    echo keep >"$file"
    (ulimit -f 2 && exec "$program" "$@") >stdout 2>stderr
    status=$?
    if is_refusal "$file"; then ok; else bad "full disk, $1: $reason"; fi
    check "full disk, $1: $file has changed" test "$(cat "$file")" = keep
    check "full disk, $1: $file.part is left" test ! -e "$file.part"
}

answers()
{
    succeeds 'replay' replay box.dpa box.csv -o box.out
    check 'OUT.csv: header' test "$(head -n 1 box.out)" = "$out_header"
    check 'OUT.csv: rows' test "$(wc -l <box.out)" -eq "$(wc -l <box.csv)"
    succeeds 'replay torus' replay torus.dpa torus.csv -o torus.out --radius 0.003
    check 'OUT.csv: rows, torus' test "$(wc -l <torus.out)" -eq 401
    check 'OUT.csv: fields' test "$(awk -F, 'NF != 22' torus.out | wc -l)" -eq 0
    check 'OUT.csv: ticks' test "$(column torus.out 1)" = "$(column torus.csv 1)"
    check 'OUT.csv: nan or inf' test -z "$(grep -i -e nan -e inf torus.out)"
    check 'OUT.csv: exact' test "$(column torus.out 2 | sort -u)" = exact

    succeeds 'replay --radius' replay box.dpa box.csv -o push.out --radius 0.004 --stiffness 1000
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
    check '--until track: columns' awk -F, 'NR > 1 && $3 $5 $6 $17 $18 $19 $20 $21 $22 != "" ||
        NF != 22 || $4 == "" { wrong = 1 } END { exit wrong }' track.out
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
        box:1200 hub:3 hub:5000; do
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
        'torus liver stomach spleen membrane cloth star sphere box hub laparoscopic '

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

# has_keys FILE KEY...: it is one line of JSON that has all these, a dot for each object
has_keys()
{
    python3 -c '
import json, sys
text = open(sys.argv[1]).read()
assert text.count("\n") == 1 and text.endswith("\n")
found = json.loads(text, parse_constant=lambda word: sys.exit("not JSON: " + word))
for path in sys.argv[2:]:
    value = found
    for key in path.split("."):
        value = value[key]
    assert value is not None and value != []
' "$@" 2>python.log
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
    refuses 'a strip that there is not' '--strip takes shadow or routes' \
        replay torus.dpa torus.csv -o out/o.csv --strip line
}

c_array()
{
    cat >opens.c <<'C'
#include <dynpoint.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
extern const uint64_t torus_mesh[];
extern const size_t torus_mesh_size;
static uint64_t file[1 << 20];
int main(void)
{
    const dpt_mesh *mesh[2];
    dpt_hit hit[2] = { DPT_HIT_INIT, DPT_HIT_INIT };
    FILE *stream = fopen("torus_mesh.dpa", "rb");
    size_t size = stream ? fread(file, 1, sizeof file, stream) : 0;
    if (size != torus_mesh_size || memcmp(file, torus_mesh, size) || (uintptr_t)torus_mesh % 64)
        return 1;
    if (dpt_mesh_open(torus_mesh, torus_mesh_size, &mesh[0]) || dpt_mesh_open(file, size, &mesh[1]))
        return 2;
    for (int i = 0; i < 1000; i++) {
        double ends[6];
        for (int k = 0; k < 6; k++)
            ends[k] = 0.001 * ((i * 37 + k * 101) % 331 - 165);
        for (int m = 0; m < 2; m++)
            if (dpt_query_segments(mesh[m], NULL, ends, NULL, 1, &hit[m], NULL) != DPT_OK)
                return 3;
        if (memcmp(&hit[0], &hit[1], sizeof hit[0]) || hit[0].status != DPT_STATUS_EXACT)
            return 4;
    }
    return 0;
}
C
    succeeds '--c-array' compile torus.obj -o torus_mesh.c --c-array torus_mesh
    succeeds '--c-array: the file' compile torus.obj -o torus_mesh.dpa
    # At most 3 bytes of text for one of the file.
    check "--c-array: $(wc -c <torus_mesh.c) bytes" \
        test "$(wc -c <torus_mesh.c)" -le $((3 * $(wc -c <torus_mesh.dpa)))
    if ! command -v "${CC:-cc}" >/dev/null; then
        skip '--c-array: no C compiler'
        return
    fi
    for compiler in "${CC:-cc} -std=c99" 'clang -std=c99' 'g++ -x c++ -std=c++11' 'clang++ -x c++ -std=c++11'; do
        if ! command -v "${compiler%% *}" >/dev/null; then
            skip "--c-array: no ${compiler%% *}"
            continue
        fi
        # A library that was built with a sanitizer or for coverage wants its runtime.
        rm -f opens torus_mesh.o
        # shellcheck disable=SC2086
        $compiler -pedantic -Wall -Wextra -Wshadow -Wconversion -Werror -c torus_mesh.c -o torus_mesh.o \
            2>cc.log
        check "--c-array, $compiler: $(tail -n 1 cc.log)" test $? -eq 0
        for runtime in '' -fsanitize=address,undefined --coverage; do
            # shellcheck disable=SC2086
            ${CC:-cc} -std=c99 -Wall -Wextra -Werror $runtime -I"$tests/../include" opens.c \
                torus_mesh.o "$build/libdynpoint.a" -lm -o opens 2>cc.log && break
        done
        check "--c-array, $compiler: $(tail -n 1 cc.log)" test -x opens
        ./opens
        code=$?
        check "--c-array, $compiler: not the file's answers: $code" test $code -eq 0
        # No writable data: it may lie in flash.
        check "--c-array, $compiler: not constant" \
            test -z "$(objdump -h torus_mesh.o | awk '$2 ~ /^\.s?(data|bss)$/ && $3 !~ /^0+$/')"
    done
}

# What is said of a device, and the whole tick on one, all without hardware.
devices()
{
    succeeds 'device list' device list
    check 'device list names sim' grep -q '^sim ' stdout
    check 'device list names replay' grep -q '^replay ' stdout
    check 'device list names openhaptics' grep -q '^openhaptics ' stdout
    succeeds 'selftest of a sound device' device selftest sim
    check 'without consent nothing is pushed' grep -q 'not tested without may_move, --move' stdout
    check 'what a coupling is computed from is shown' grep -q '^  mass 0.1 kg, damping 0.5 Ns/m$' stdout
    check 'no turn is none' test "$(grep -c 'w, x, y, z' stdout)" -eq 0
    { echo t,x,y,z,rx,ry,rz; echo 0,0,0,0,0,0,3.14159265358979312; } >turned.csv
    run device selftest 'sim:?dofs=6&hand=turned.csv'
    check "no turn with w last: $(cat stdout)" grep -q 'is it sent as x, y, z, w? The order is w, x, y, z' stdout
    succeeds 'selftest with consent' device selftest sim --move
    check 'six pushes' test "$(grep -c 'moves the hand that way' stdout)" -eq 6
    check 'a watchdog is asked' grep -q 'ok   without commands its watchdog ends a force' stdout
    run device selftest 'sim:?fault=estop@0.3'
    check 'selftest of one that stops' test $status -eq 1
    check 'says what fails' grep -q 'FAIL ready all the time' stdout
    run device watch 'sim:?live=1&hand=press' --for 0.2
    check 'watch ends' test $status -eq 0
    check 'watch, a line a sample' awk -F, 'NR > 1 && $2 == "ready" && NF == 10 { n++ }
        END { exit n < 20 }' stdout
    refuses 'no such driver' 'nothing' device watch nothing
    refuses 'no such verb' 'is needed' device look sim
    refuses 'no device' '--device NAME are needed' run box.dpa
    refuses 'a device that is not there' 'nothing' run box.dpa --device nothing
    refuses 'a record without an end' '--record needs --ticks or --for' \
        run box.dpa --device sim --record out/r.csv
    refuses 'a place of two numbers' '--at takes three numbers' \
        run box.dpa --device sim --ticks 5 --at 1,2

    succeeds 'run' run torus.dpa --device 'sim:?hand=press' --ticks 4000 --record lived.csv
    check 'it touches' grep -q '^  in contact on [1-9]' stdout
    succeeds 'run again' run torus.dpa --device 'sim:?hand=press' --ticks 4000 --record again.csv
    check 'the same motion, bit for bit' cmp -s lived.csv again.csv
    run run torus.dpa --device 'sim:?hand=press' --for 4 --record again.csv
    check 'four seconds of its own time are as many' cmp -s lived.csv again.csv
    check 'and no one needs a hint' test $status,"$(wc -l <stderr)" = 0,0
    run run torus.dpa --device 'sim:?live=1&hand=press' --for 0.5 --record live.csv --json
    check "--for is enough for a record: $(cat stderr)" test $status -eq 0
    check 'which has all of it' test "$(grep -c '^[0-9]' live.csv)" = "$(sed 's/.*"fresh":\([0-9]*\),.*/\1/' stdout)"
    check 'and some' test "$(grep -c '^[0-9]' live.csv)" -gt 100
    refuses 'too long a record' '--record: at most' \
        run torus.dpa --device 'sim:?live=1' --for 1e6 --record out/r.csv
    refuses 'too many ticks for one' '--record: at most' \
        run torus.dpa --device sim --ticks 100000001 --record out/r.csv
    for budget in "3000 sim" "1500 sim:?rate=2000" "200 sim:?rate=50000" "0 sim --budget 0" "7 sim --budget 7"; do
        # shellcheck disable=SC2086
        run run torus.dpa --ticks 5 --json --device ${budget#* }
        check "a budget of $budget" grep -q "\"budget\":${budget%% *}}" stdout
    done
    run run torus.dpa --device 'sim:?hand=press' --ticks 4000 --budget 7
    check 'what so little leaves undecided is told' grep -q '^  unknown on [1-9][0-9]*, with --budget 7$' stdout
    refuses 'too large a budget' '--budget must be 0 to' run torus.dpa --device sim --ticks 5 --budget 4294967296
    succeeds 'without a budget' run torus.dpa --device 'sim:?hand=press' --ticks 4000 --budget 0 --record again.csv
    check 'the usual one is not reached' cmp -s lived.csv again.csv
    succeeds 'what was lived, replayed' replay torus.dpa lived.csv -o o.csv --radius 0.002 --budget 3000
    in_contact=$(column o.csv 3 | grep -c penetrating)
    run run torus.dpa --device 'sim:?hand=press' --ticks 4000 --json
    check 'as many ticks in contact' grep -q "\"penetrating\":$in_contact," stdout
    run run box.dpa --device sim --for 0.05 --json
    check 'a sim that does not wait' test $status -eq 0
    check 'says so, in a line, and what to do' test "$(grep -c "'sim:?hand=press&live=1'" stderr),$(wc -l <stderr)" = 1,1
    check 'and nothing else changes' grep -q '^{"ticks":[0-9]*,.*}$' stdout
    for told in 'sim --ticks 5' 'sim:?live=1 --for 0.05' "replay:./box.csv --for 1"; do
        # shellcheck disable=SC2086
        run run box.dpa --device $told
        check "nothing of it with $told" test "$(grep -c 'live=1' stderr)" -eq 0
    done
    run run torus.dpa --device 'sim:?live=1&hand=press' --for 0.5 --json
    check 'a live run ends' test $status -eq 0
    mv stdout run.json
    check 'also after no time' timeout 60 "$program" run torus.dpa --device 'sim:?live=1' --for 1e-9 --json >/dev/null
    run run torus.dpa --device 'sim:?hand=press' --ticks 4000 --force-max 0 --json
    check 'no force is no force' grep -q '"clamped":[1-9]' stdout
    refuses 'a force below none' '--force-max must be 0 to 1000' \
        run torus.dpa --device sim --ticks 5 --force-max -1
    refuses 'settings without a ?' 'only settings, as in sim:?live=1' \
        run torus.dpa --device sim:live=1 --ticks 5
    check "run --json: $(tail -n 1 python.log)" has_keys run.json ticks fresh stale missed sent \
        refused late_us.median took_us.p99 real_time locked contacts deepest strongest

    succeeds 'no certificate' replay torus.dpa lived.csv -o none.csv --radius 0.002 --certificate-bytes 0
    succeeds 'a certificate' replay torus.dpa lived.csv -o some.csv --radius 0.002
    check 'costs time, never truth' awk -F, 'NR == FNR { d[FNR] = $4; next } d[FNR] != $4 { n++ } END { exit n > 0 }' none.csv some.csv
    "$program" replay torus.dpa lived.csv -o none.csv --certificate-bytes 0 --json >none.json
    "$program" replay torus.dpa lived.csv -o some.csv --json >some.json
    less=$(sed 's/.*"bytes":\([0-9]*\).*/\1/' none.json) more=$(sed 's/.*"bytes":\([0-9]*\).*/\1/' some.json)
    check 'a mebibyte less' test $((more - less)) -eq 1048576
    refuses 'too much of it' '--certificate-bytes must be' \
        replay torus.dpa lived.csv -o out/o.csv --certificate-bytes 9000000000000000

    # With a stiff spring the bare force is far above what a guard lets through: 5 N, 2 N more a tick.
    succeeds 'replay, bare' replay torus.dpa lived.csv -o o.csv --radius 0.002 --stiffness 50000
    check 'above the limit' awk -F, 'NR > 1 && $17 * $17 + $18 * $18 + $19 * $19 > 50 { n++ } END { exit !n }' o.csv
    succeeds 'replay --limit' replay torus.dpa lived.csv -o o.csv --radius 0.002 --stiffness 50000 --limit
    check 'within the limits' awk -F, 'NR > 1 {
            n += $17 * $17 + $18 * $18 + $19 * $19 > 1
            if ($17 * $17 + $18 * $18 + $19 * $19 > 25.0001 || ($18 - y) * ($18 - y) > 4.0001) bad = 1
            y = $18
        } END { exit bad || n < 100 }' o.csv

    refuses 'nothing else is simulated' 'only serial and can:' device simulate can
    refuses 'an arm is needed' 'arm=FILE' device simulate 'can:vcan0?gear=8,8,8'
    refuses 'an arm is needed' 'arm=FILE' run torus.dpa --device 'can:can0'
    "$program" device simulate serial --for 60 >simulated 2>/dev/null &
    simulator=$!
    for wait in 1 2 3 4 5 6 7 8 9 10; do
        [ -s simulated ] || sleep 0.2
    done
    name=$(cat simulated)
    run device watch "$name" --for 0.5
    check 'watch over a line' awk -F, 'NR > 1 && $2 == "ready" && NF == 10 { n++ }
        END { exit n < 20 }' stdout
    run run torus.dpa --device "$name" --for 2 --json
    check 'run over a line' test $status -eq 0
    check 'no frame damaged' grep -q '"device_damaged":0,' stdout
    check 'many fresh samples' awk -F'[:,]' '{ exit $4 < 200 }' stdout
    # A host that dies leaves the device in fault: its watchdog missed the commands.
    "$program" run torus.dpa --device "$name" --for 20 >killed 2>&1 &
    host=$!
    sleep 2
    kill -KILL $host
    wait $host 2>/dev/null
    sleep 0.3
    run device watch "$name" --for 0.1
    check 'it has stopped itself' grep -q ',fault,' stdout
    run run torus.dpa --device "$name" --for 1 --json
    check 'the next host ends that' test $status -eq 0
    check 'and is told' grep -q 'had stopped itself (watchdog)' stderr
    check 'there is force again' grep -q '"not_ready":0,' stdout
    # A terminal that is closed, and a report that no one reads: the device is closed all the same, and so is in no fault.
    "$program" run torus.dpa --device "$name" --for 20 >killed 2>&1 &
    host=$!
    sleep 2
    kill -HUP $host
    wait $host
    check 'a hang-up ends it in order' test $? -eq 0
    sleep 0.3
    run device watch "$name" --for 0.1
    check 'and leaves no fault' test "$(grep -c ,fault, stdout)" -eq 0
    "$program" run torus.dpa --device "$name" --for 1 2>/dev/null | :
    sleep 0.3
    run device watch "$name" --for 0.1
    check 'a report that no one reads leaves none' test "$(grep -c ,fault, stdout)" -eq 0
    kill -TERM $simulator && wait $simulator
    check 'the simulated device ends in order' test $? -eq 0
    refuses 'a line that is gone' "$name" device watch "$name"

    # The vendor's library is not needed; a stand-in for it is loaded as it would be.
    refuses 'a library that is not there' 'there is no library' device watch 'openhaptics:?library=/nowhere/libHD.so'
    name="openhaptics:?library=$build/tests/libHD-stand-in.so&silent=5"
    if [ ! -e "$build/tests/libHD-stand-in.so" ]; then
        skip 'openhaptics: make test-programs builds the stand-in'
        return
    fi
    succeeds 'selftest of the stand-in' device selftest "$name"
    STAND_IN_SWING=0.03
    export STAND_IN_SWING
    run run torus.dpa --device "$name" --for 2 --json
    unset STAND_IN_SWING
    check 'run on the stand-in' test $status -eq 0
    check 'which touches' grep -q '"contacts":[1-9]' stdout
    check 'with many fresh samples' awk -F'[:,]' '{ exit $4 < 200 }' stdout
}

# vertices FILE FACTOR: the corners of a box of 181 x 120 x 90 units, times FACTOR
vertices()
{
    awk -v f="$2" 'BEGIN { for (i = 0; i < 8; i++)
        printf "v %.17g %.17g %.17g\n", f * 181 * (i % 2), f * 120 * (int(i / 2) % 2), f * 90 * int(i / 4)
        print "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6" }' >"$1"
}

# A mesh in another unit than its user thinks, and lengths that do not go with it.
units()
{
    vertices mm.obj 1
    notes 'millimetres taken for metres' 'mm.obj: note: its box is 181 x 120 x 90 m: is it in millimetres? --unit mm' \
        compile mm.obj -o large.dpa
    check "compile: its box: $(cat stdout)" grep -q '^  box 181 x 120 x 90 m$' stdout
    succeeds 'info of it' info large.dpa
    check "info: the hint: $(cat stdout)" grep -q 'is it in millimetres? --unit mm' stdout
    notes '--unit mm' '' compile mm.obj -o unit.dpa --unit mm
    check "compile: its box in m: $(cat stdout)" grep -q '^  box 0.181 x 0.12 x 0.09 m$' stdout
    run info unit.dpa
    check 'info: a hint that is not needed' test "$(grep -c 'is it in' stdout)" -eq 0
    for pair in mm:0.001 cm:0.01 m:1 in:0.0254; do
        succeeds "--unit ${pair%:*}" compile mm.obj -o unit.dpa --unit ${pair%:*}
        succeeds "--scale ${pair#*:}" compile mm.obj -o scale.dpa --scale ${pair#*:}
        check "--unit ${pair%:*}: other bytes" cmp -s unit.dpa scale.dpa
    done
    vertices m.obj 0.001
    notes 'metres taken for millimetres' 'm.obj: note: its box is 0.000181 x 0.00012 x 9e-05 m: is it in metres? --unit m' \
        compile m.obj -o small.dpa --unit mm
    vertices far.obj 1000
    notes 'metres taken for micrometres' 'which unit is it in?' compile far.obj -o far.dpa
    refuses 'two scales' '--unit and --scale' compile mm.obj -o out/x --unit mm --scale 0.001
    for value in '' MM inch 0.001; do
        refuses "--unit '$value'" "--unit: '$value' is not mm, cm, m or in" compile mm.obj -o out/x --unit "$value"
    done
    notes 'a radius in metres' '' replay box.dpa box.csv -o o.csv --radius 0.08 --strip-width 0.08
    for option in --radius --strip-width; do
        notes "$option in another unit" "box.dpa: note: $option 2 m is much for its box of 0.12 x 0.1 x 0.08 m" \
            replay box.dpa box.csv -o o.csv $option 2
    done
}

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
    refuses 'a mesh in XML' 'mesh.dae: neither OBJ' compile mesh.dae -o out/x
    refuses 'the line of a refusal' 'zero_axis.urdf:14: joint' \
        compile "$golden/zero_axis.urdf" -o out/x
    refuses 'notes of what is refused' "arm.urdf: there is no link 'nonesuch'" \
        compile "$sample" -o out/x --tool nonesuch
    refuses '--tool with a mesh' '--tool and --packages are for a URDF' \
        compile box.ply -o out/x --tool tip
    refuses '--packages with a mesh' '--tool and --packages are for a URDF' \
        compile box.ply -o out/x --packages .
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
    refuses 'a package that is not found' "link 'b': 'package://plates" compile plate.urdf -o out/x
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
    run run arm.dpa --device sim --at 0.2,0,0.003 --ticks 1 --json
    check "a millimetre in the desk: $(cat stdout)" grep -q \
        '"contacts":1,"penetrating":1,"unknown":0,"deepest":0.000999999[0-9]*,"strongest":0.4999998' stdout
    run run arm.dpa --device sim --at 0.35,0,0.003 --ticks 1 --json
    check "beside the desk, away from it: $(cat stdout)" grep -q '"contacts":0,' stdout
    run run arm.dpa --device sim --at 0.2,0,0.003 --ticks 2000 --json
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
    refuses 'a record of the arm' '--record needs the stylus' \
        run arm.dpa --device sim --ticks 5 --record out/r.csv
    refuses 'a scene without a body' 'whose scene has no body' run noted.dpa --device sim --ticks 5
    refuses 'a tool without a capsule' 'its tool has no capsule' \
        run box.dpa --tool forearm.dpa --device sim --ticks 5
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
help_and_version
usage_errors
bad_traces
endless_traces
good_traces
bad_inputs
self_intersections
pipes
golden_files
outputs
answers
same_bytes
shapes
json
devices
c_array
units
descriptions
echo "$passed passed, $failed failed, $skipped skipped"
[ $failed -eq 0 ]
