#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The meshes that the program reads: damaged ones, odd ones, through pipes, in another unit.
# `sh tests/tools/cli_meshes.sh BUILD [part]`.
. "$(dirname "$0")/cli.sh"

# damage FROM TO AT VALUE: a copy with one byte changed; the value is used, or the one above it
damage()
{
    cp "$1" "$2"
    old=$(od -An -tu1 -j "$3" -N 1 "$1" | tr -d ' ')
    new=$4
    [ "$old" -eq "$new" ] && new=$((new + 1))
    printf "\\$(printf %03o "$new")" | dd of="$2" bs=1 seek="$3" conv=notrunc 2>dd.log
}

# What people have: formats of others, headers of others, bytes behind the end.
foreign_inputs()
{
    printf '# vtk DataFile Version 5.1\nx\n' >organ.vtk
    printf '<?xml version="1.0"?>\n<VTKFile type="PolyData">' >organ.vtp
    printf 'glTF\002\000\000\000' >organ.glb
    printf '{"asset":{"version":"2.0"}}' >organ.gltf
    printf 'PK\003\004 3D/3dmodel.model' >organ.3mf
    printf '<COLLADA/>' >organ.dae
    printf '$MeshFormat\n' >organ.msh
    printf '\037\213\010' >organ.stl.gz
    while read -r name words; do
        refuses "compile: $name" "$words" compile "$name" -o out/x
        cp "$name" organ.stl
        refuses "compile: $name by content" 'organ.stl: this is ' compile organ.stl -o out/x
    done <<'WORDS'
organ.vtk this is VTK: python3 -c "import pyvista; pyvista.read('organ.vtk').extract_surface().triangulate().save('OUT.stl')"
organ.vtp (after pip install pyvista), then compile OUT.stl with --unit mm
organ.glb import trimesh; trimesh.load('organ.glb', force='mesh').export('OUT.stl')
organ.gltf then compile OUT.stl with --unit m: that of glTF
organ.3mf (after pip install trimesh networkx lxml), then compile OUT.stl with --unit mm
organ.dae (after pip install trimesh pycollada), then compile OUT.stl with --scale X
organ.msh this is a mesh of Gmsh: python3 -c "import pyvista;
organ.stl.gz gzip -dc 'organ.stl.gz' | dynpoint compile - -o OUT.dpa, with the --unit
WORDS
    notes 'bytes behind an STL' '1 triangles that binary STL announces: left out' \
        compile "$tests/golden-bad/binary_trailing.stl" -o trailing.dpa
    notes 'text behind an STL' 'text_after_end.stl:10: note: text follows the last solid' \
        compile "$tests/golden-bad/text_after_end.stl" -o trailing.dpa
    printf '# 3D Slicer output. SPACE=LPS\nv 0 0 0\nv .1 0 0\nv 0 .1 0\nf 1 2 3\n' >slicer.obj
    notes 'axes of 3D Slicer' 'note: SPACE=LPS, by 3D Slicer, in mm' compile slicer.obj -o slicer.dpa
}

# Concave polygons, and meshes far away.
shapes_of_others()
{
    printf 'v .0 0 0\nv .2 0 0\nv .2 .1 0\nv .1 .1 0\nv .1 .2 0\nv .0 .2 0\nv .1 .3 0\n' >l.obj
    { cat l.obj; echo 'f 1 2 3 4 5 6'; } >concave.obj
    notes 'a concave polygon' '' compile concave.obj -o concave.dpa
    check "a concave polygon: $(cat stdout)" grep -q '1 concave polygons$' stdout
    { cat l.obj; echo 'f 1 2 3 4 5 6'; echo 'f 1 3 2 6'; echo 'f 1 3 2 7'; } >crossing.obj
    notes 'polygons that cross themselves' \
        'crossing.obj:9: note: a polygon of 4 corners crosses itself: left a fan of its first corner, and 1 more like it' \
        compile crossing.obj -o concave.dpa
    sed 's/^v /v 600000/' concave.obj >far.obj
    refuses 'a mesh 600 km away' 'far from the origin; --recentre moves it' compile far.obj -o out/x
    succeeds '--recentre' compile far.obj -o far.dpa --recentre
    check "--recentre: $(cat stdout)" grep -q '  moved by (-600000.1, -0.1, 0) m, rounded' stdout
    succeeds 'info of a moved mesh' info far.dpa
    check "info of a moved mesh: $(cat stdout)" grep -q 'moved to the origin from *600000.1, 0.1, 0 m' stdout
    run info far.dpa --json
    check 'info --json of a moved mesh' grep -q '"origin":.600000[.][01][0-9]*,0[.]1[0-9]*,0.' stdout
    sed 's/^v /v 20000/' concave.obj >off.obj
    notes 'a mesh 20 km away' 'far from the origin; --recentre moves it' compile off.obj -o far.dpa
    refuses '--recentre and --nodes' 'exclude each other' compile concave.obj -o out/x --recentre --nodes nothing
    if [ -n "${DPT_DATA:-}" ]; then
        notes 'a reported L' '' compile "$DPT_DATA/reports/polygons/concave_L.obj" -o concave.dpa
        check "a reported L: $(cat stdout)" grep -q '2 concave polygons$' stdout
    else
        skip 'a reported L: DPT_DATA is not set'
    fi
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
    damage box.dpa version.dpa 12 99
    damage box.dpa sum.dpa $((size - 200)) 170
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
    run info box.dpa
    check 'info: no checksums of sections' test "$(grep -c ' crc ' stdout)" = 0
    run info box.dpa --sections
    check 'info --sections: 24 of them' test "$(grep -c '^  section .* crc [0-9a-f]\{8\}$' stdout)" = 24
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

# is_thick FILE LEAST MOST WALLS: the thinnest wall, m, and how many there are
is_thick()
{
    run info "$1" --thickness --json
    check "thickness of $1: $(cat stdout stderr)" python3 -c '
import json, sys
found = json.load(open("stdout"))["thickness"]
least, most, walls = (float(word) for word in sys.argv[1:])
assert least <= found["least"] <= found["low"] <= most and found["walls"] == walls, found
' "$2" "$3" "$4" 2>python.log
}

# Rays inward: closed forms, within what facets leave.
thickness()
{
    succeeds 'make sphere' make sphere 1280 -o sphere.ply
    succeeds 'compile sphere' compile sphere.ply -o sphere.dpa
    is_thick box.dpa 0.0799999 0.0800001 12
    is_thick sphere.dpa 0.199 0.2 1280
    is_thick torus.dpa 0.0785 0.08 2000
    # A box of 2 m with a void of 1.6 in it, shifted by 0.1: 0.1 m of wall at the thinnest. Then that box as a part of its
    # own that is wound outward: rays end at it. Then the two beside each other: the room between them is no wall.
    cube='f 1 3 2|f 1 4 3|f 5 6 7|f 5 7 8|f 1 2 6|f 1 6 5|f 2 3 7|f 2 7 6|f 3 4 8|f 3 8 7|f 4 1 5|f 4 5 8'
    cubes()
    {
        awk -v way="$2" -v at="$3" -v faces="$cube" 'BEGIN {
            split("-1 1 1 -1 -1 1 1 -1", X, " "); split("-1 -1 1 1 -1 -1 1 1", Y, " ")
            for (i = 1; i <= 8; i++) print "v", X[i], Y[i], (i > 4 ? 1 : -1)
            for (i = 1; i <= 8; i++) print "v", at + 0.8 * X[i], 0.8 * Y[i], (i > 4 ? 0.8 : -0.8)
            n = split(faces, F, "|")
            for (k = 0; k < 2; k++) for (i = 1; i <= n; i++) { split(F[i], c, " ")
                a = c[2] + 8 * k; b = c[3] + 8 * k; d = c[4] + 8 * k
                print "f", a, (k && way ? d : b), (k && way ? b : d) } }' >"$1.obj"
        succeeds "compile $1" compile "$1.obj" -o "$1.dpa"
    }
    cubes void 1 0.1
    is_thick void.dpa 0.0999999 0.1000001 24
    cubes beside 0 2
    is_thick beside.dpa 1.5999999 1.6000001 24
    printf 'v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nf 1 4 3 2\nf 5 6 7 8\n' >sheets.obj
    for sheet in cloth membrane sheets; do
        test -e $sheet.obj || succeeds "make $sheet" make $sheet 512 -o $sheet.obj
        succeeds "compile $sheet" compile $sheet.obj -o $sheet.dpa
        run info $sheet.dpa --thickness --json
        check "no thickness of $sheet" grep -q '"thickness":{"walls":0,"least":null,"low":null,"triangle":null}' stdout
        run info $sheet.dpa --thickness
        check "no thickness of $sheet, for people" grep -q '^  thinnest wall *none$' stdout
    done
    run info box.dpa --json
    check 'only where it is asked for' test "$(grep -c thickness stdout)" -eq 0
    refuses 'a file that is verified' '--verify does not go with --thickness' info box.dpa --verify --thickness
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
        refuses "--unit '$value'" "--unit: '$value' is none of mm, cm, m, in" compile mm.obj -o out/x --unit "$value"
    done
    notes 'a radius in metres' '' replay box.dpa box.csv -o o.csv --radius 0.08 --strip-width 0.08
    for option in --radius --strip-width; do
        notes "$option in another unit" "box.dpa: note: $option 2 m is much for its box of 0.12 x 0.1 x 0.08 m" \
            replay box.dpa box.csv -o o.csv $option 2
    done
}

# What has no length and does not end is read up to 2^30 bytes. Not under sanitizers, which take several times that.
endless_inputs()
{
    case $build in */build/*) return ;; esac
    printf '#!/bin/sh\nulimit -v 8000000\nexec timeout 60 %s "$@"\n' "'$program'" >limited && chmod 755 limited
    whole=$program program=$PWD/limited
    refuses 'compile: endless' 'more than 1073741824 bytes come' compile /dev/zero -o out/x.dpa
    refuses 'info: endless' 'more than 1073741824 bytes come' info /dev/zero
    program=$whole
}

prepare
bad_inputs
foreign_inputs
shapes_of_others
endless_inputs
self_intersections
thickness
pipes
[ "$is_part" ] || golden_files
units
finish
