#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Do two commits answer alike, bit for bit? For changes that are to move code and no answer.
#
#     sh tests/bench/compare.sh [--speed] OLD [NEW]
#
# OLD and NEW are commits, built in build/compare/COMMIT (kept there for the next time); NEW is by default the working
# tree as it is, in build/. Of a commit nothing is used but what every layout of the tree has: `make all`, build/dynpoint,
# the static libraries and include/. Meshes, sources and scenes are those of the tree that this script lies in.
#
#   files    Both programs make, compile, show, trace, replay and run the same things, with every method, kernel and
#            stage, with budgets and strips, well-formed and not. Compared by cmp: files, what was said, what was complained of
#            and exit statuses. Times are taken out of summaries (the keys of ns); counts of work stay in.
#   answers  answers.c, compiled against the headers and linked with the libraries of each, writes all that the library
#            answers in random scenes, which the program does not show: contacts, sweeps, strips, sides, several bodies
#            and tools, arms, guards, devices with a time of their own. Both write at once, and nothing is kept.
#            WORLDS=1000 says how many worlds of 150 ticks.
#   speed    With --speed: replays of a liver, a torus and a cloth by turns, old, new, old, new ..., PAIRS=9 of each.
#            A ratio is new / old of the two medians (or 99 %) of a pair; shown are the median of the ratios, the least
#            and largest of them, and the ratio of the least times of all runs, which other work on the machine disturbs
#            least. A clock that counts in tens of ns makes ratios of 100 ns coarse: OLD against itself shows how coarse.
#
# With DPT_DATA, the folder of public meshes, some organs too. Takes about two minutes on two cores beside the builds, and
# --speed about three more. Ends with "equal: N files, M answers", or with status 1 and a list of what differs; what was
# made then stays in build/compare/OLD-NEW, the two versions of a file that differs (of the first 20) in differ/ there.
set -u
speed=
[ "${1:-}" = --speed ] && speed=1 && shift
if [ $# -lt 1 ] || [ $# -gt 2 ]; then
    echo "usage: sh tests/bench/compare.sh [--speed] OLD [NEW]" >&2
    exit 2
fi
root=$(cd "$(dirname "$0")/../.." && pwd) || exit 2
compare=$root/build/compare
data=${DPT_DATA:+$(cd "$DPT_DATA" && pwd)}
unset MAKEFLAGS MAKELEVEL CONFIG

fail() {
    echo "compare: $*" >&2
    exit 2
}

# Builds a commit, if that was not done before, and says where.
commit() {
    sha=$(git -C "$root" rev-parse --verify --quiet --short=12 "$1^{commit}") || fail "$1 is no commit"
    tree=$compare/$sha
    if [ ! -e "$tree/built" ]; then
        echo "building $1 ($sha)" >&2
        rm -rf "$tree"
        mkdir -p "$tree"
        git -C "$root" archive "$sha" | tar -x -C "$tree" || fail "cannot unpack $sha"
        make -s -j2 -C "$tree" all >"$tree/make.out" 2>&1 || fail "$1 does not build: $tree/make.out"
        touch "$tree/built"
    fi
    echo "$tree"
}

old=$(commit "$1") || exit 2
if [ $# -eq 2 ]; then
    new=$(commit "$2") || exit 2
    new_name=$(basename "$new")
else
    new=$root new_name=tree
    make -s -j2 -C "$root" all >&2 || fail "the working tree does not build"
fi
work=$compare/$(basename "$old")-$new_name
rm -rf "$work"
mkdir -p "$work/old" "$work/new" "$work/differ"

# ---- files ----

files=0 differences=0 refused=0
: >"$work/list"

differ() { # what name: the versions are kept while they are few
    differences=$((differences + 1))
    echo "$1: $2" >>"$work/list"
    if [ "$differences" -le 20 ]; then
        echo "  DIFFERS $1: $2"
        cp "$work/old/$2" "$work/differ/$differences.old.$2"
        cp "$work/new/$2" "$work/differ/$differences.new.$2"
    fi
}

untimed() { # times out of a summary, as a table or as JSON
    sed -E -e 's/"(first_ns|ns[a-z_]*|[a-z]*_us)":(\{[^}]*\}|[0-9.]+),?//g' "$1" >"$1.untimed" && mv "$1.untimed" "$1"
}

one_side() { # side tree words...
    cd "$work/$1" || exit 2
    program=$2/build/dynpoint
    shift 2
    "$program" "$@" >said 2>complained </dev/null
    echo $? >status
    case " $* " in *" --json "*) untimed said ;; esac
}

# both FILES WORDS...: `dynpoint WORDS...` by both, in a folder each. Compared: FILES that it writes, and what it says.
# Files are named out.* where no one needs them later.
both() {
    written=$1
    shift
    one_side old "$old" "$@" &
    one_side new "$new" "$@"
    wait $!
    read -r status <"$work/old/status"
    for name in $written said complained status; do
        if [ ! -e "$work/old/$name" ] && [ ! -e "$work/new/$name" ] && [ "$status" != 0 ]; then
            continue # refused: nothing is written
        fi
        touch "$work/old/$name" "$work/new/$name"
        files=$((files + 1))
        cmp -s "$work/old/$name" "$work/new/$name" || differ "$*" "$name"
    done
    rm -f "$work/old"/out.* "$work/new"/out.*
}

# As both, of what is to succeed: a line says so where neither does, and nothing was compared.
both_succeed() {
    both "$@"
    [ "$status" = 0 ] && return 0
    shift
    refused=$((refused + 1))
    echo "  REFUSED by both: dynpoint $*: $(head -n 1 "$work/old/complained")"
    return 1
}

kernels=
for kernel in scalar sse2 avx2 avx512 neon; do
    one_side old "$old" make box -o box.obj
    one_side old "$old" compile box.obj -o box.dpa
    one_side old "$old" make trace --mesh box.dpa --ticks 2 -o box.csv
    one_side old "$old" replay box.dpa box.csv -o out.csv --kernel $kernel
    [ "$(cat "$work/old/status")" = 0 ] && kernels="$kernels $kernel"
done

replay() { # options...: of the mesh $mesh and the trace $trace
    both_succeed out.csv replay "$mesh.dpa" "$trace.csv" -o out.csv --json "$@"
}

trace() { # name seed options...
    trace=$mesh-$1
    both_succeed "$trace.csv" make trace --mesh "$mesh.dpa" -o "$trace.csv" --seed "$2" $3
}

# The diagonal of a mesh, times 0.0057: 2 mm on a liver.
radius() {
    sed -n 's/.*"box":\[\[\([^]]*\)\],\[\([^]]*\)\]\].*/\1,\2/p' "$work/new/said" |
        awk -F, '{ printf "%.6g", 0.0057 * sqrt(($4 - $1) ^ 2 + ($5 - $2) ^ 2 + ($6 - $3) ^ 2) }'
}

replays_some() {
    replay --radius "$r"
    replay --method tree --radius "$r" --until contact
    replay --radius "$r" --budget 200 --limit
    replay --strip shadow --strip-width "$r"
}

replays_all() {
    for until in track contact respond; do
        replay --until $until
        replay --until $until --radius "$r"
    done
    for budget in 30 200 1000; do
        replay --radius "$r" --budget $budget
        replay --budget $budget --until contact
    done
    for kernel in $kernels; do
        replay --radius "$r" --kernel "$kernel"
        replay --radius "$r" --kernel "$kernel" --budget 200 --until track
        replay --method tree --kernel "$kernel" --until track
        replay --method paper --parts 4 --kernel "$kernel"
    done
    replay --radius "$r" --limit
    replay --radius "$r" --limit --budget 200 --stiffness 4000
    replay --radius "$r" --certificate-bytes 0
    replay --radius "$r" --certificate-bytes 2720 --dt 0.0005
    replay --radius "$r" --strip shadow
    replay --radius "$r" --strip routes
    replay --method tree --radius "$r"
    replay --method paper --radius "$r"
    replay --method paper --parts 4 --radius "$r" --strip shadow
    replay --method paper --one-step
    replay --method paper --parts 4 --one-step --radius "$r"
}

# explore MESH: of its .dpa; all replays of one motion, some of a fast one and of one with jumps.
explore() {
    mesh=$1
    both_succeed '' info "$mesh.dpa" || return
    both_succeed '' info "$mesh.dpa" --verify
    both_succeed '' info "$mesh.dpa" --json || return
    r=$(radius)
    trace slow 1 "--ticks 400" || return
    [ "$2" = all ] && replays_all
    [ "$3" = brute ] && replay --method brute --radius "$r" && replay --against brute --every 7
    replays_some
    trace fast 2 "--ticks 300 --speed 15 --band 0.02" || return
    for side in old new; do
        awk 'NR < 100 || NR > 150' "$work/$side/$trace.csv" >"$work/$side/$mesh-jumps.csv"
    done
    replays_some
    trace=$mesh-jumps
    replays_some
    [ "$2" = all ] || return
    trace third 3 "--ticks 300 --band 0.001 --length 0.05" || return
    replays_some
}

# made SHAPE N FORMAT ALL BRUTE
made() {
    mesh=$1-$2
    both_succeed "$mesh.$3" make "$1" "$2" -o "$mesh.$3" || return
    both_succeed "$mesh.dpa" compile "$mesh.$3" -o "$mesh.dpa" -j 2 || return
    explore "$mesh" "$4" "$5"
}

began=$(date +%s)
echo "old $old"
echo "new $new"
echo "kernels:$kernels"
made torus 5568 stl all -
made torus 128 obj all brute
made liver 5000 ply all -
made liver 1000 off some brute
made stomach 2001 stl all -
made spleen 1000 obj some brute
made membrane 512 ply all brute
made membrane 2 obj some brute
made cloth 2048 off all -
made star 2000 stl all -
made sphere 500 obj all brute
made box 12 ply all brute
made box 300 stl some brute
made hub 301 obj all brute
made hub 3 obj some brute
both_succeed 'lap-liver.stl lap-stomach.stl lap-spleen.stl' make laparoscopic 3000 -o lap.stl --seed 4
for part in lap-liver lap-stomach lap-spleen; do
    both_succeed $part.dpa compile $part.stl -o $part.dpa && explore $part some -
done
for shape in torus liver stomach spleen membrane cloth star sphere hub; do
    both_succeed out.stl make $shape 2048 -o out.stl --seed 7
done
for options in "--c-array organ" "--crease 20" "--crease 180 --scale 0.001" "-j 4"; do
    both_succeed out.dpa compile liver-5000.ply -o out.dpa $options
done

# Real ones: file, its scale, all or some.
if [ -n "$data" ] && [ -d "$data/meshes" ]; then
    while read -r file scale how; do
        mesh=$(basename "${file%.*}")
        both_succeed "$mesh.dpa" compile "$data/meshes/$file" -o "$mesh.dpa" --scale "$scale" && explore "$mesh" "$how" -
    done <<LIST
organs/openhelp_liver.stl 0.001 all
organs/liver_dirty_low.stl 0.001 all
organs/liver_intraop_patch.stl 0.001 all
organs/vessel_open_ends.stl 0.001 some
organs/liver_metres.stl 1 some
organs/skin_wound_oss.ply 0.01 some
organs/skull_and_teeth_sofa.obj 0.01 some
organs/openhelp_scene_low.stl 0.001 some
hard/chair_double_sided.obj 0.01 some
hard/bunny_dirty.ply 1 some
LIST
    for file in "$data"/meshes/malformed/* "$data"/meshes/hard/*; do
        both out.dpa compile "$file" -o out.dpa
    done
else
    echo "DPT_DATA names no folder of meshes: no organs"
fi

# What is refused, and in what words.
for file in "$root"/tests/golden-bad/*.*; do
    both out.dpa compile "$file" -o out.dpa
done
for file in "$root"/tests/golden/*.dpa; do
    both '' info "$file"
    both '' info "$file" --json --verify
done

# Robots, where there is a reader of URDF; live runs, of a simulated device with a time of its own.
arms=no
if both "arm.dpa" compile "$root/docs/samples/arm.urdf" -o arm.dpa; [ "$status" = 0 ]; then
    arms=yes
    both_succeed '' info arm.dpa --json
    for file in "$root"/tests/golden-urdf/*.urdf; do
        both out.dpa compile "$file" -o out.dpa
    done
    both_succeed '' run arm.dpa --device 'sim:?hand=press' --at 0.2,0,0.01 --ticks 2000 --json
    both_succeed '' run liver-5000.dpa --tool arm.dpa --device 'sim:?hand=press&dofs=6' --ticks 2000 --json
else
    echo "no reader of URDF: no arms"
fi
for mesh in liver-5000 membrane-512 torus-5568; do
    both_succeed out.csv run $mesh.dpa --device 'sim:?hand=press' --ticks 3000 --record out.csv --json
    both_succeed out.csv run $mesh.dpa --device 'sim:?hand=wipe&dofs=6&delay=2' --radius 0 --ticks 3000 --record out.csv --json
done
echo "files: $files compared, $differences differ, $refused commands refused by both, arms: $arms, $(($(date +%s) - began)) s"

# ---- answers ----

build_answers() { # tree side
    ${CC:-cc} -std=gnu99 -O1 -ffp-contract=off -I"$1/include" -I"$1/tests" "$1/tests/bench/answers.c" \
        "$1/build/libdynpoint_compile.a" "$1/build/libdynpoint_drivers.a" "$1/build/libdynpoint.a" \
        -lm -pthread -ldl -o "$work/$2/answers" || fail "answers.c does not build with $1"
}

answers_of() { # side: into its pipe
    cd "$work/$1" || exit 2
    ./answers --worlds "${WORLDS:-1000}" $subjects >pipe 2>met
    echo $? >status
}

# First difference, field by field, and of which kinds there are how many, for as long as the two are in step.
show_difference() {
    paste -d '\n' "$work/old/pipe" "$work/new/pipe" | awk -v numbers="$work/old/answers --number" '
        function kind(line) { sub(/ [^ =]*=.*/, "", line); return line }
        NR % 2 { a = $0; next }
        a == $0 { next }
        {
            if (!first) {
                first = NR / 2
                printf "  first, line %d: %s\n", first, kind(a)
                if (kind(a) != kind($0))
                    printf "    new has: %s\n", kind($0)
                count = split(a, old); split($0, new)
                for (i = 1; i <= count; i++)
                    if (old[i] != new[i]) {
                        name = value = old[i]; other = new[i]
                        sub(/=.*/, "", name); sub(/[^=]*=/, "", value); sub(/[^=]*=/, "", other)
                        command = numbers " " value " " other
                        if (length(value) == 16 && (command | getline shown) > 0)
                            value = value " " other " (" shown ")"
                        else
                            value = value " " other
                        close(command)
                        print "    " name ": " value
                    }
            }
            if (kind(a) != kind($0)) {
                printf "  out of step from line %d on: %s / %s\n", NR / 2, kind(a), kind($0)
                exit
            }
            what = kind(a); sub(/.* /, "", what)
            differ[what]++
        }
        END { for (what in differ) print "  " differ[what] " lines of " what }'
}

began=$(date +%s)
build_answers "$old" old
build_answers "$new" new
mkfifo "$work/old/pipe" "$work/new/pipe"
subjects="torus-5568.dpa liver-5000.dpa membrane-512.dpa cloth-2048.dpa star-2000.dpa hub-301.dpa stomach-2001.dpa sphere-500.dpa"
for mesh in openhelp_liver liver_dirty_low liver_intraop_patch vessel_open_ends; do
    [ -e "$work/old/$mesh.dpa" ] && [ -e "$work/new/$mesh.dpa" ] && subjects="$subjects $mesh.dpa"
done
for mesh in "$root"/tests/golden/torus*.dpa; do
    subjects="$subjects $mesh"
done
answers_of old &
answers_of new &
cmp "$work/old/pipe" "$work/new/pipe" >"$work/cmp" 2>&1
same=$?
wait
answers=$(sed -n 's/.*, \([0-9]*\) values$/\1/p' "$work/old/met")
if [ $same -eq 0 ] && [ "$(cat "$work/old/status" "$work/new/status")" = "0
0" ] && cmp -s "$work/old/met" "$work/new/met"; then
    echo "answers: $(cat "$work/old/met"), $(($(date +%s) - began)) s"
elif [ $same -eq 0 ]; then
    differences=$((differences + 1))
    echo "answers: both alike as far as they went, but they ended with $(cat "$work/old/status") and $(cat "$work/new/status"): $(cat "$work/old/met" "$work/new/met")"
    echo "answers: ended early" >>"$work/list"
else
    differences=$((differences + 1))
    echo "  DIFFERS answers: $(sed 's/.*differ/differ/; s/.*EOF/EOF/' "$work/cmp")"
    echo "answers: $(sed 's/.*differ/differ/' "$work/cmp")" >>"$work/list"
    answers_of old &
    answers_of new &
    show_difference
    wait
fi

# ---- speed ----

measure() { # side tree pair mesh until: rows of "side pair mesh until ticks what ns"
    "$2/build/dynpoint" replay "$work/$1/$4.dpa" "$work/$1/$4.csv" -o "$work/$1/out.csv" --radius 0.002 --until "$5" \
        --repeat 3 --json >"$work/$1/said" || fail "a replay failed"
    for of in ns ns_crossing ns_other; do
        sed -n "s/.*\"$of\":{\"median\":\([0-9]*\),\"p99\":\([0-9]*\).*/\1 \2/p" "$work/$1/said" |
            while read -r median p99; do
                echo "$1 $3 $4 $5 $of median $median"
                echo "$1 $3 $4 $5 $of p99 $p99"
            done
    done
}

if [ -n "$speed" ]; then
    began=$(date +%s)
    for mesh in liver-50332 torus-61358 cloth-20000; do
        both_succeed "$mesh.ply" make "${mesh%-*}" "${mesh#*-}" -o "$mesh.ply"
        both_succeed "$mesh.dpa" compile "$mesh.ply" -o "$mesh.dpa" -j 2
        both_succeed "$mesh.csv" make trace --mesh "$mesh.dpa" -o "$mesh.csv"
    done
    : >"$work/times"
    pair=0
    while [ $pair -lt "${PAIRS:-9}" ]; do
        for mesh in liver-50332 torus-61358 cloth-20000; do
            for until in track respond; do
                measure old "$old" $pair $mesh $until >>"$work/times"
                measure new "$new" $pair $mesh $until >>"$work/times"
            done
        done
        pair=$((pair + 1))
    done
    echo
    printf '  %-12s %-8s %-12s %-7s %9s %9s  %6s  %-13s %6s\n' mesh until ticks what old/ns new/ns ratio spread least
    awk -v limit=1.03 '
        function sort(v, n,   i, j, x) {
            for (i = 2; i <= n; i++) {
                x = v[i]
                for (j = i - 1; j > 0 && v[j] > x; j--)
                    v[j + 1] = v[j]
                v[j + 1] = x
            }
        }
        function middle(v, n) { sort(v, n); return n % 2 ? v[(n + 1) / 2] : (v[n / 2] + v[n / 2 + 1]) / 2 }
        { key = $3 " " $4 " " $5 " " $6; ns[$1, $2, key] = $7; pairs = $2 + 1 }
        !(key in known) { known[key] = 1; keys[++count] = key }
        END {
            for (k = 1; k <= count; k++) {
                key = keys[k]
                for (i = 0; i < pairs; i++) {
                    a[i + 1] = ns["old", i, key]; b[i + 1] = ns["new", i, key]
                    r[i + 1] = a[i + 1] > 0 ? b[i + 1] / a[i + 1] : 0
                }
                ratio = middle(r, pairs)
                if (ratio == 0)
                    continue
                split(key, part)
                of = part[3] == "ns" ? "all" : part[3] == "ns_other" ? "not through" : "through"
                printf "  %-12s %-8s %-12s %-7s %9.0f %9.0f  %6.3f  %.3f..%.3f  %6.3f\n", part[1], part[2], of, part[4],
                    middle(a, pairs), middle(b, pairs), ratio, r[1], r[pairs], b[1] / a[1]
                if (ratio > limit)
                    slower = slower sprintf("%s%s %s %s %s %.3f (least %.3f)", slower ? "; " : "",
                        part[1], part[2], of, part[4], ratio, b[1] / a[1])
            }
            printf "speed: %s\n", slower ? "ratios above " limit ": " slower : "no ratio above " limit
        }' "$work/times"
    echo "speed: ${PAIRS:-9} pairs, $(($(date +%s) - began)) s"
fi

# ---- what came of it ----

if [ "$differences" -eq 0 ] && [ "$refused" -eq 0 ]; then
    rm -rf "$work"
    echo "equal: $files files, $answers answers"
    exit 0
fi
echo "NOT EQUAL: $differences differences, $refused commands that neither side could do; all in $work/list"
exit 1
