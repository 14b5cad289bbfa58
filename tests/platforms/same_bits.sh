# SPDX-License-Identifier: BSD-3-Clause
# For the scripts beside it, which set build and scratch.
#
#     same_bits RUNNER PROGRAM   a program for another system, run by RUNNER, makes the files of build/dynpoint, and each
#                                replays what the other recorded; in a folder whose name has blanks and umlauts
same_bits() {
    runner=$1
    case $2 in /*) other=$2 ;; *) other=$PWD/$2 ;; esac
    case $build in /*) own=$build/dynpoint ;; *) own=$PWD/$build/dynpoint ;; esac
    there="$scratch/Größe und Maß"
    mkdir -p "$there"
    "$own" make liver 4000 -o "$scratch/liver.obj" >"$scratch/out" 2>&1 &&
        "$own" compile "$scratch/liver.obj" -o "$scratch/liver.dpa" >>"$scratch/out" 2>&1 &&
        "$own" run "$scratch/liver.dpa" --device 'sim:?hand=press' --ticks 3000 --record "$scratch/own.dpr" >>"$scratch/out" 2>&1
    verdict $? "this machine's own program makes a mesh, compiles it and records a run"
    (cd "$there" && $runner "$other" make liver 4000 -o "Leber ä.obj") >>"$scratch/out" 2>&1 && cmp "$there/Leber ä.obj" "$scratch/liver.obj"
    verdict $? "the mesh has the same bytes, in a folder with blanks and umlauts"
    (cd "$there" && $runner "$other" compile "Leber ä.obj" -o "Leber ä.dpa") >>"$scratch/out" 2>&1 && cmp "$there/Leber ä.dpa" "$scratch/liver.dpa"
    verdict $? "and so has the .dpa"
    sed 's/$/\r/' "$scratch/liver.obj" >"$there/crlf.obj" && "$own" compile "$there/crlf.obj" -o "$scratch/crlf.dpa" >>"$scratch/out" 2>&1 &&
        (cd "$there" && $runner "$other" compile - -o - <crlf.obj) 2>>"$scratch/out" >"$scratch/piped.dpa" && cmp "$scratch/piped.dpa" "$scratch/crlf.dpa"
    verdict $? "and from lines that end in CR LF, through standard input and output"
    cp "$scratch/own.dpr" "$there/Aufnahme ö.dpr"
    (cd "$there" && $runner "$other" replay "Aufnahme ö.dpr" "Leber ä.dpa") >"$scratch/replay.out" 2>&1 &&
        grep -q '3000 ticks, all the same bits' "$scratch/replay.out"
    verdict $? "it replays this machine's recording: all the same bits"
    (cd "$there" && $runner "$other" run "Leber ä.dpa" --device 'sim:?hand=press' --ticks 3000 --record theirs.dpr) >>"$scratch/out" 2>&1 &&
        "$own" replay "$there/theirs.dpr" "$scratch/liver.dpa" >"$scratch/replay.out" 2>&1 &&
        grep -q '3000 ticks, all the same bits' "$scratch/replay.out"
    verdict $? "and this machine replays its recording: all the same bits"
}
