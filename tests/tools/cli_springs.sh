#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# dynpoint compile --springs: what it reports, what info says, and the line of what is wrong in the files of regions.
# `sh tests/tools/cli_springs.sh BUILD`.
. "$(dirname "$0")/cli.sh"

springs()
{
    succeeds 'make membrane' make membrane 512 -o membrane.ply
    succeeds '--springs sheet' compile membrane.ply -o sheet.dpa --springs sheet --young 2000 --density 1100 --thickness 0.002
    check "compile: $(cat stdout)" grep -q '^  1056 springs between 289 nodes, 0 of them fixed: 0.088 kg' stdout
    check "compile: it floats" grep -q '^  nothing holds it: .*--regions or --fixed' stdout
    run info sheet.dpa
    check "info: $(cat stdout)" grep -q '^  springs  *1056 between 289 nodes, 0 of them fixed$' stdout
    check 'info: mass' grep -q "^    mass  *0.088 kg, Poisson's ratio 0.3333, viscosity 0 s$" stdout
    check 'info: stable step' grep -q '^    stable step  *[0-9.]* s: of symplectic Euler without damping$' stdout
    check 'info --json: springs' test "$(info_count sheet.dpa springs)" = 1056
    succeeds 'info --verify' info sheet.dpa --verify
    run info box.dpa
    check 'info: no springs' test "$(grep -c '^  springs' stdout)" -eq 0
    check 'info --json: no springs' test "$(info_count box.dpa spring_nodes)" = 0
    run info box.dpa --json
    check 'info --json: no lattice' grep -q '"lattice_cell":null,"tool_radius":null,' stdout

    printf '# the far end\nbox 0.059 -1 -1 1 1 1 fixed\nsphere 0 0 0 0.05 9000 1000 2\n' >regions
    printf '0 1 # two corners\n' >fixed
    succeeds '--springs volume' compile box.ply -o volume.dpa --springs volume --spacing 0.02 --regions regions --fixed fixed \
        --viscosity 0.001 --drag 0.5
    check "compile: $(cat stdout)" grep -q '^  embedded in 210 nodes: all vertices are within cells$' stdout
    check "compile: a part is held" test "$(grep -c 'nothing holds it' stdout)" -eq 0
    check 'info --json: 30 of the end, and a corner' test "$(info_count volume.dpa fixed_nodes)" = 31
    succeeds 'in two threads' compile box.ply -o threads.dpa --springs volume --spacing 0.02 --regions regions --fixed fixed \
        --viscosity 0.001 --drag 0.5 -j 2
    check 'in two threads: other bytes' cmp -s volume.dpa threads.dpa
    succeeds 'a tick of a mesh with springs' replay volume.dpa box.csv -o answers.csv
    succeeds 'a tick without' replay box.dpa box.csv -o plain.csv
    check 'the answers are the same' cmp -s answers.csv plain.csv
}

# wrong WHAT TEXT SAID: a file of regions, and what must be said of it
wrong()
{
    printf "$2" >wrong
    refuses "$1" "$3" compile box.ply -o out/x --springs volume --spacing 0.02 --regions wrong
}

refusals()
{
    refuses 'a kind' "--springs: 'lattice' is none of sheet, volume" compile box.ply -o out/x --springs lattice
    refuses 'without' '--young needs --springs' compile box.ply -o out/x --young 5000
    refuses 'files without' '--fixed needs --springs' compile box.ply -o out/x --fixed fixed
    refuses 'of another kind' '--thickness is not for --springs volume' compile box.ply -o out/x --springs volume --thickness 1
    refuses 'no stiffness' '--young must be 0 to 1e+12, and not 0' compile box.ply -o out/x --springs sheet --young 0
    refuses 'an open mesh' 'membrane.ply: no part of the mesh is closed' compile membrane.ply -o out/x --springs volume
    succeeds "--poisson" compile box.ply -o bulging.dpa --springs volume --spacing 0.02 --poisson 0.45
    succeeds 'info of it' info bulging.dpa --sections
    check 'info: the cell, and the tool' grep -q '0[.]02 m; felt within a tenth by round tools of a radius of 0[.]08 m' stdout
    check 'info: the ratio' grep -q "Poisson's ratio 0.45" stdout
    check 'info: the cells' grep -q 'section cell_nodes' stdout
    refuses 'a ratio that is too large' '--poisson must be 0.1 to 0.45' compile box.ply -o out/x --springs volume --poisson 0.5
    refuses 'a ratio of a sheet' '--poisson is not for --springs sheet' compile box.ply -o out/x --springs sheet --poisson 0.3
    refuses 'too fine' 'more than 4194304 cells' compile box.ply -o out/x --springs volume --spacing 0.0001
    refuses 'with cells' '--nodes and --springs exclude each other' compile box.ply -o out/x --springs volume --nodes wrong
    refuses 'an arm' '--nodes and --springs are for a mesh' compile "$tests/../docs/samples/arm.urdf" -o out/x --springs sheet
    refuses 'no file' 'none' compile box.ply -o out/x --springs sheet --regions none
    cp regions lonely
    refuses 'an output that is an input' 'lonely' compile box.ply -o lonely --springs sheet --regions lonely
    check 'it is there still' test -s lonely
    wrong 'a word' 'box 0 0 0 1 1 1 fixed\ncube 1\n' "wrong:2: 'cube' is not box or sphere"
    wrong 'a number' '\nbox 0 0 0 1 1 x fixed\n' "wrong:2: the highest z is 'x'"
    wrong 'an empty box' 'box 0 0 0 1 -1 1 fixed\n' 'wrong:1: region 1 is empty'
    wrong 'elsewhere' 'box 5 5 5 6 6 6 fixed\n' 'region 1 holds nothing of the body'
    wrong 'everything' 'sphere 0 0 0 1 fixed\n' 'all of the body is fixed'
    echo '1 2 8' >wrong
    refuses 'a vertex' 'vertex 8 is to be fixed, and there are only 8' compile box.ply -o out/x --springs sheet --fixed wrong
    echo '1 -2' >wrong
    refuses 'a negative vertex' 'wrong:1: -2 is no number of a vertex' compile box.ply -o out/x --springs sheet --fixed wrong
}

prepare
springs
refusals
finish
