#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Where results go: folders, full disks, pipes, links, and files that are inputs too.
# `sh tests/tools/cli_outputs.sh BUILD`.
. "$(dirname "$0")/cli.sh"

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

missing_folders()
{
    refuses 'make: no such folder' none/x.ply make box -o none/x.ply
    refuses 'compile: no such folder' none/x.dpa compile box.ply -o none/x.dpa
    refuses 'replay: no such folder' none/x.csv replay box.dpa box.csv -o none/x.csv
    refuses 'make trace: no such folder' none/x.csv make trace --mesh box.dpa -o none/x.csv
    mkdir -p folder.ply
    refuses 'make: output is a folder' folder.ply make box -o folder.ply
    check 'folder.ply.part is left' test ! -e folder.ply.part
}

# A full disk, by the limit on a file's size: what was there stays, nothing is left beside it.
full_disks()
{
    succeeds 'make for full disk' make torus 20000 -o large.ply
    full small.dpa compile box.ply -o small.dpa # fails as the file is closed
    full make.ply make torus 20000 -o make.ply
    full compile.dpa compile large.ply -o compile.dpa
    full replay.csv replay torus.dpa torus.csv -o replay.csv
    full trace.csv make trace --mesh torus.dpa --ticks 1000 -o trace.csv
}

earlier_files()
{
    echo keep >kept.dpa
    refuses 'compile over a file' none.obj compile none.obj -o kept.dpa
    echo keep >kept.csv
    trace few.csv 0,1
    refuses 'replay over a file' few.csv replay box.dpa few.csv -o kept.csv
    check 'kept files have changed' test "$(cat kept.dpa kept.csv | tr '\n' ' ')" = 'keep keep '
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
}

inputs()
{
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
}

# A name that says another format than what is written, whatever its case; names that say none are taken.
names()
{
    for ending in png PDF txt dpr; do
        refuses "plot to .$ending" 'what is written is a picture in SVG' plot torus.csv -o out/x.$ending
        [ $ending = dpr ] ||
            refuses "record to .$ending" 'let it end in .dpr' run box.dpa --device sim --ticks 5 --record out/x.$ending
    done
    for ending in dpa json svg; do
        refuses "replay to .$ending" 'let it end in .csv' replay box.dpa box.csv -o out/x.$ending
        refuses "make trace to .$ending" 'let it end in .csv' make trace --mesh box.dpa -o out/x.$ending
        refuses "identify to .$ending" 'let it end in .txt' device identify sim -o out/x.$ending
    done
    succeeds 'record' run box.dpa --device sim --ticks 5 --record x.DPR
    refuses 'record csv to .dpr' 'let it end in .csv' record csv x.DPR -o out/x.dpr
    refuses 'compile to .csv' 'let it end in .dpa' compile box.ply -o out/x.csv
    refuses 'compile to .c without an array' 'let it end in .dpa' compile box.ply -o out/x.c
    refuses 'an array to .dpa' 'let it end in .c' compile box.ply -o out/x.dpa --c-array box
    refuses 'view to .svg' 'what is written is a page' view box.dpa -o out/x.svg
    refuses 'plan to .csv' 'let it end in .json' plan box.dpa --error 1mm --rate 1kHz -o out/x.csv
    refuses "plan's header to .json" 'let it end in .h' plan box.dpa --error 1mm --rate 1kHz --header out/x.json
    for name in x.TXT x.out.1 x folder.svg/x; do
        mkdir -p folder.svg
        succeeds "replay to $name" replay box.dpa box.csv -o $name
    done
}

pipes_and_links()
{
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
}

# The reader of what is printed has gone.
no_reader()
{
    (
        trap '' PIPE
        while echo; do :; done 2>/dev/null
        trap - PIPE
        "$program" compile box.ply -o out/x 2>stderr
        echo $? >code
    ) | true
    status=$(cat code)
    : >stdout
    if is_refusal 'Broken pipe'; then ok; else bad "compile | true: $reason"; fi
}

full_streams()
{
    { printf X; tail -c +2 box.dpa; } >magic.dpa
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

prepare
missing_folders
full_disks
earlier_files
inputs
names
pipes_and_links
no_reader
full_streams
finish
