#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# dynpoint compile --nodes: TetGen's files, what info says of them, and the line of what is wrong in them.
# `sh tests/tools/cli_embedding.sh BUILD`.
. "$(dirname "$0")/cli.sh"

# cube BASE HALF FIRST: two files with a cube about the origin, cut in six; nodes counted from FIRST
cube()
{
    awk -v h="$2" -v n="$3" 'BEGIN { print "8 3 0 1"
        for (i = 0; i < 8; i++)
            print i + n, h * (2 * (i % 2) - 1), h * (2 * (int(i / 2) % 2) - 1), h * (2 * int(i / 4) - 1), 1 }' >"$1.node"
    awk -v n="$3" 'BEGIN { print "# two of three axes first\n6 4 0"
        split("1 2 1 4 2 1 2 4 4 1 4 2", step, " ")
        for (i = 0; i < 6; i++)
            print i + n, n, n + step[2 * i + 1], n + step[2 * i + 1] + step[2 * i + 2], n + 7 }' >"$1.ele"
}

embeds()
{
    cube large 0.2 1
    cube small 0.05 0
    succeeds 'compile --nodes' compile box.ply -o large.dpa --nodes large
    check "compile: $(cat stdout)" grep -q '^  embedded in 8 nodes: all vertices are within cells$' stdout
    succeeds 'info --verify' info large.dpa --verify
    check 'info --json: nodes' test "$(info_count large.dpa nodes)" = 8
    check 'info --json: outside' test "$(info_count large.dpa outside_vertices)" = 0
    # The box is 0.12 x 0.1 x 0.08: its corners are 10 mm off the small cube's, along one axis.
    succeeds 'compile --nodes: outside' compile box.ply -o small.dpa --nodes small
    check "compile: $(cat stdout)" grep -q '^  embedded in 8 nodes: 8 vertices outside of all cells, at most 0.01 m$' stdout
    run info small.dpa
    check "info: $(cat stdout)" grep -q '^    vertices outside  *8, at most 0.01 m$' stdout
    check 'info: nodes' grep -q '^  nodes, embedded in  *8$' stdout
    check 'info --json: 8 outside' test "$(info_count small.dpa outside_vertices)" = 8
    run info box.dpa
    check 'info: no nodes' test "$(grep -c 'embedded in' stdout)" -eq 0
    check 'info --json: no nodes' test "$(info_count box.dpa nodes)" = 0
    run info "$tests/golden/torus_4.dpa" --json
    check 'info --json: format 4' grep -q '"nodes":0,"outside_vertices":0,"outside_distance":0,' stdout
    for base in large.node large.ele; do
        succeeds "--nodes $base" compile box.ply -o ending.dpa --nodes $base
        check "--nodes $base: other bytes" cmp -s large.dpa ending.dpa
    done
    sed 's/$/\r/' large.node >crlf.node
    cp large.ele crlf.ele
    succeeds '--nodes: CR LF' compile box.ply -o crlf.dpa --nodes crlf
    check '--nodes: CR LF: other bytes' cmp -s large.dpa crlf.dpa
    # By millimetres alike, on two threads too.
    cube mm 200 0
    vertices mm.obj
    succeeds '--nodes --unit' compile mm.obj -o mm.dpa --nodes mm --unit mm
    check 'info --json: millimetres' test "$(info_count mm.dpa outside_vertices)" = 0
    succeeds '--nodes -j' compile mm.obj -o threads.dpa --nodes mm --unit mm -j 2
    check '--nodes -j: other bytes' cmp -s mm.dpa threads.dpa
    succeeds '--nodes --c-array' compile box.ply -o box.c --nodes large --c-array box
    succeeds 'a tick of an embedded mesh' replay large.dpa box.csv -o answers.csv
    succeeds 'a tick without' replay box.dpa box.csv -o plain.csv
    check 'the answers are the same' cmp -s answers.csv plain.csv
}

# A box of 120 x 100 x 80 units.
vertices()
{
    awk 'BEGIN { for (i = 0; i < 8; i++)
        print "v", 120 * (i % 2) - 60, 100 * (int(i / 2) % 2) - 50, 80 * int(i / 4) - 40
        print "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6" }' >"$1"
}

# wrong WHAT NODE ELE TEXT: sed commands on both files, and what must be said
wrong()
{
    sed "$2" large.node >wrong.node
    sed "$3" large.ele >wrong.ele
    refuses "$1" "$4" compile box.ply -o out/x --nodes wrong
}

refusals()
{
    refuses 'no files' 'none.node' compile box.ply -o out/x --nodes none
    cp large.node lonely.node
    refuses 'one file' 'lonely.ele' compile box.ply -o out/x --nodes lonely
    refuses 'an output that is an input' 'large.ele' compile box.ply -o large.ele --nodes large
    check 'it is there still' test -s large.ele
    refuses 'an arm' '--nodes and --springs are for a mesh' compile "$tests/../docs/samples/arm.urdf" -o out/x --nodes large
    wrong 'a word' '3s/0.2/two/' '' "wrong.node:3: x is 'two': not a number"
    wrong 'too few nodes' '$d' '' 'wrong.node:9: the file ends after 7 of 8 nodes'
    wrong 'a node twice' '4s/^3/2/' '' 'wrong.node:4: node 2 follows node 2'
    wrong 'an infinite node' '5s/-0.2/inf/' '' 'wrong.node:5: z is inf: not a finite number'
    wrong 'a node that is not there' '' '4s/8/9/' 'wrong.ele:4: cell 2 names node 9: there are 8, counted from 1'
    wrong 'a flat cell' '' '5s/ 4 8/ 4 2/' 'wrong.ele:5: cell 3 has no volume'
    wrong 'cells of ten nodes' '' '2s/4/10/' 'wrong.ele:2: the nodes of a cell is 10: only 4 is read'
    wrong 'too many cells' '' '$a 7 1 2 4 8' 'wrong.ele:9: text follows the last of 6 cells'
    cube mm 200 0
    succeeds 'nodes in another unit, about the mesh' compile box.ply -o mm.dpa --nodes mm
    cube um 0.0002 0
    refuses 'nodes in another unit' ' is 0.0874 m from all cells: too far for weights of at most 100' \
        compile box.ply -o out/x --nodes um
}

prepare
embeds
refusals
finish
