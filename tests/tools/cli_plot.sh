#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# dynpoint plot: charts read back by their own axes, gaps, long runs, odd names, and what is refused.
# `sh tests/tools/cli_plot.sh BUILD [part]`.
. "$(dirname "$0")/cli.sh"

# reads_back WHAT PANELS CHART ARGUMENT...: it is drawn as the CSV files say (read_plot.py), in these panels
reads_back()
{
    what=$1 panels=$2
    shift 2
    python3 -B "$tests/tools/read_plot.py" "$@" >read.log 2>&1
    check "$what: $(tail -n 3 read.log)" test $? -eq 0
    check "$what: panels $(head -n 1 read.log)" test "$(head -n 1 read.log)" = "$panels"
}

runs()
{
    succeeds 'a push along the torus' replay torus.dpa torus.csv -o proxy.csv
    succeeds 'the push at one point' replay torus.dpa torus.csv --law point -o point.csv
    succeeds 'a run' run torus.dpa --device 'sim:?hand=press&cycle=1' --ticks 2000 --record press.dpr
    succeeds 'another' run torus.dpa --device 'sim:?hand=press&cycle=1' --ticks 2600 --law point --record other.dpr
    succeeds 'by the clock' run torus.dpa --device 'sim:?hand=press&cycle=1&live=1' --ticks 400 --record live.dpr
    for run in press other live; do
        succeeds "$run.csv" record csv $run.dpr -o $run.csv
    done
}

pictures()
{
    notes 'a replay' '' plot proxy.csv -o proxy.svg
    reads_back 'a replay' 'Force Gap Energy' proxy.svg proxy.csv
    notes 'depth' 'not drawn: Energy (no numbers)' plot point.csv -o point.svg
    reads_back 'depth' 'Force Depth Gap' point.svg point.csv
    notes 'two replays' 'not drawn: Energy (none in point.csv)' plot proxy.csv point.csv -o both.svg
    reads_back 'two replays' 'Force Depth Gap' both.svg proxy.csv point.csv
    notes 'a window' '' plot proxy.csv --from 0.1 --to 0.25 -o window.svg
    reads_back 'a window' 'Force Gap Energy' window.svg --from 0.1 --to 0.25 proxy.csv
    notes 'ticks of 2 ms' '' plot proxy.csv --dt 0.002 -o slow.svg
    reads_back 'ticks of 2 ms' 'Force Gap Energy' slow.svg --dt 0.002 proxy.csv
    notes 'a recording' '' plot press.dpr -o press.svg
    reads_back 'a recording' 'Force Gap Energy' press.svg press.csv
    succeeds 'its columns' plot press.csv -o columns.svg --title press.dpr
    succeeds 'with its name' plot press.dpr -o named.svg --title press.dpr
    check 'a recording and its columns: other lines' test "$(sed 's/press\.[cd][sp][vr]//g' columns.svg | cksum)" = \
        "$(sed 's/press\.[cd][sp][vr]//g' named.svg | cksum)"
    notes 'two recordings' '' plot press.dpr other.dpr -o runs.svg
    reads_back 'two recordings' 'Force Depth Gap Energy' runs.svg press.csv other.csv
    notes 'lateness' '' plot live.dpr -o live.svg
    reads_back 'lateness' 'Force Gap Energy Lateness' live.svg live.csv
    notes 'lateness of one' 'not drawn: Lateness (none in press.dpr)' plot live.dpr press.dpr -o late.svg
    reads_back 'lateness of one' 'Force Gap Energy' late.svg live.csv press.csv
    notes 'a replay and a recording' '' plot proxy.csv press.dpr -o mixed.svg
    reads_back 'a replay and a recording' 'Force Gap Energy' mixed.svg proxy.csv press.csv
    run plot proxy.csv -o -
    check 'on standard output' cmp -s stdout proxy.svg
    LC_ALL=de_DE.UTF-8 "$program" plot - -o again.svg --title proxy.csv <proxy.csv
    succeeds 'the same' plot proxy.csv -o named.svg --title proxy.csv
    check 'another locale, standard input: other bytes' test "$(sed 's/standard input/proxy.csv/g' again.svg | cksum)" = \
        "$(cksum <named.svg)"
}

documented()
{
    check 'the picture of docs/plot.md is drawn' sh "$tests/pictures/draw_plot.sh" "$build" laws.svg
    check 'the picture of docs/plot.md: other bytes' cmp -s laws.svg "$tests/../docs/pictures/plot-laws.svg"
}

# Rows of replay -o by awk: N ticks with a force of its own, and what `more` makes of them.
rows()
{
    awk -v n="$1" "BEGIN { print \"tick,fx,fy,fz,gap,depth,energy\"; for (i = 0; i < n; i++) { t = i; f = sin(i / 50)
        g = 0.001 * cos(i / 37); e = f * f / 1000; $2; print t \",\" f \",0,0,\" g \",\" (g < 0 ? -g : 0) \",\" e } }"
}

gaps()
{
    rows 1000 'if (i % 250 > 200) f = i % 2 ? "" : "nan"; if (i > 600) t += 300' >gaps.csv
    succeeds 'empty cells, and a jump' plot gaps.csv -o gaps.svg
    sed 's/nan//' gaps.csv >empty.csv
    reads_back 'empty cells, and a jump' 'Force Depth Gap Energy' gaps.svg empty.csv
    check 'its gap is counted' grep -q '>1000 ticks, 1 gap<' gaps.svg
    check 'five stretches of force' test "$(sed -n '/>Force, mN</,/<\/g>/p' gaps.svg | grep linecap | tr -cd M)" = MMMMM
    rows 1 '' >one.csv
    succeeds 'one tick' plot one.csv -o one.svg
    check 'is one dot' grep -q 'M[0-9. ]*h0"' one.svg
    reads_back 'one tick' 'Force Gap Energy' one.svg one.csv
    rows 300 'f = 0; g = 1; e = 0' >still.csv
    succeeds 'no force at all' plot still.csv -o still.svg
    reads_back 'no force at all' 'Force Gap Energy' still.svg still.csv
    rows 300 'f *= 1e-5; g *= 1e4; e = i % 3 ? 1e29 : -1e29' >sizes.csv
    succeeds 'very small and very large' plot sizes.csv -o sizes.svg
    reads_back 'very small and very large' 'Force Depth Gap Energy' sizes.svg sizes.csv
    check 'in millionths' grep -q '>Force, uN<' sizes.svg
}

# Single ticks stand out of 200,000, and what is drawn stays small.
long_runs()
{
    rows 200000 'f = f * 0.1 + (i % 7) * 0.01; if (i == 12345) f = 9; if (i == 150001) e = 0.5
        if (i == 99999) g = -0.03' >long.csv
    succeeds 'a long run' plot long.csv -o long.svg
    reads_back 'a long run' 'Force Depth Gap Energy' long.svg long.csv
    awk -F, '{ print }' OFS=, long.csv | sed 's/,9,0,0,/,0.1,0,0,/' >calm.csv
    succeeds 'two long runs' plot long.csv calm.csv -o long.svg
    reads_back 'two long runs' 'Force Depth Gap Energy' long.svg long.csv calm.csv
    check 'no number that is none' test "$(grep -ciE 'nan|inf[^o]' long.svg)" -eq 0
}

# Whatever the bytes of a name or a title are, the picture is sound XML.
names()
{
    odd='a<b>&"c'\''.csv'
    cp proxy.csv "$odd"
    succeeds 'a name of markup' plot "$odd" -o odd.svg
    reads_back 'a name of markup' 'Force Gap Energy' odd.svg "$odd"
    check 'its name is its title' grep -qxF "title: $odd" read.log
    succeeds 'a title that is no text' plot proxy.csv -o odd.svg --title "$(printf 'x\377\300\200\355\240\200y\001z')"
    reads_back 'a title that is no text' 'Force Gap Energy' odd.svg proxy.csv
    long=$(printf '%0300d' 1)
    succeeds 'a long title' plot proxy.csv -o odd.svg --title "$long"
    check 'is whole for a screen reader' grep -q "<title>$long</title>" odd.svg
    check 'and cut in the picture' test "$(grep -c "$long" odd.svg)" -eq 1
}

# faulty TEXT REASON: a file of these lines is refused, with its line
faulty()
{
    printf '%b' "$1" >faulty.csv
    refuses "$2" "faulty.csv:$2" plot faulty.csv -o out/faulty.svg
}

faults()
{
    head='tick,fx,fy,fz,gap\n'
    faulty 'a,b\n1,2\n' '1: neither a column tick'
    faulty 'tick,fx,tick\n' '1: there are two columns tick'
    faulty "${head}1,2,3,4\n" '2: there are 4 cells, and the header has 5'
    faulty "${head}1,2,3,4,5\n2,1,2,3,4,5\n" '3: there are 6 cells'
    faulty "${head}1,2,3,4,5\n\n#\n2,1,x,3,4\n" "5: fy: 'x' is not a number"
    faulty "${head}1,2,3,4,0x5\n" "2: gap: '0x5' is not a number"
    faulty "${head}1.5,2,3,4,5\n" "2: tick: '1.5' is not a whole number"
    faulty "${head}5,2,3,4,5\n5,2,3,4,5\n" '3: the tick does not increase'
    faulty 'number,time_ns,flags,status\n1,50,1,2\n2,40,1,2\n' '3: time goes back'
    faulty 'number,time_ns,flags,status\n1,-50,1,2\n' '2: time_ns is below 0'
    faulty "$(printf '%0300d' 0 | tr 0 ,)\n" '1: there are more than 256 cells'
    : >faulty.csv
    refuses 'nothing' 'faulty.csv: there are no ticks' plot faulty.csv -o out/faulty.svg
    printf '%b' "$head" >faulty.csv
    refuses 'no rows' 'faulty.csv: there are no ticks' plot faulty.csv -o out/faulty.svg
    rows 9 'f = g = e = "inf"' >faulty.csv
    refuses 'no numbers' 'faulty.csv: no numbers to draw' plot faulty.csv -o out/faulty.svg
    refuses 'a window behind the end' 'it ends at 0.399 s' plot proxy.csv --from 3 -o out/faulty.svg
    refuses 'no window' '--from must be' plot proxy.csv --from 3 --to 2 -o out/faulty.svg
    refuses 'ticks of no length' '--dt must be' plot proxy.csv --dt 0 -o out/faulty.svg
    refuses 'nothing to draw in' '-o FILE.svg are needed' plot proxy.csv
    refuses 'no run' 'RUN and -o FILE.svg' plot -o out/faulty.svg
    refuses 'onto the run' 'it is an input too' plot proxy.csv -o proxy.csv
    refuses 'standard input twice' 'standard input can be one run only' plot - - -o out/faulty.svg
    refuses 'a folder' 'cannot be' plot . -o out/faulty.svg
    refuses 'a file that is not there' 'nowhere.csv: cannot be opened' plot nowhere.csv -o out/faulty.svg
    refuses 'into no folder' 'cannot be written' plot proxy.csv -o nowhere/faulty.svg
    head -c 30000 press.dpr >cut.dpr
    notes 'a recording that is cut' '' plot cut.dpr -o cut.svg
    { head -c 30000 press.dpr; printf 'xxxxxxxx'; tail -c +30009 press.dpr; } >damaged.dpr
    run plot damaged.dpr -o damaged.svg
    check "a damaged recording: exit $status" test $status -eq 1
    check 'where it is damaged' grep -q 'damaged.dpr: byte [0-9]*: damaged; [0-9]* bytes were left out' stderr
    check 'what could be read is drawn' grep -q '>1999 ticks, 1 gap, damaged<' damaged.svg
}

prepare
[ -x "$(command -v python3)" ] || { skip 'plots read back: no python3'; finish; exit; }
runs
pictures
gaps
[ "$is_part" ] || long_runs
names
faults
documented
finish
