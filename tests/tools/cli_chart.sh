#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# dynpoint chart: rows of every method and law, what they get wrong, the picture read back by its own axes, and what is
# refused. `sh tests/tools/cli_chart.sh BUILD [part]`.
. "$(dirname "$0")/cli.sh"

# cell FILE PART NAME COLUMN
cell()
{
    awk -F, -v part="$2" -v name="$3" -v column="$4" '/^#/ { next }
        !head { for (i = 1; i <= NF; i++) at[$i] = i; head = 1; next }
        $1 == name && $2 == part { print $at[column] }' "$1"
}

# cell_is FILE PART NAME COLUMN TEST NUMBER, as awk compares
cell_is()
{
    got=$(cell "$1" "$2" "$3" "$4")
    check "$1, $2, $3: $4 is '$got', not $5 $6" awk "BEGIN { exit !(\"$got\" != \"\" && $got + 0 $5 $6) }"
}

# Peers that answer as we do but for two ticks, or only whether they meet, or not at all.
make_peers()
{
    mkdir peers
    succeeds 'our answers' replay star.dpa star.trace.csv --until track -o ours.csv
    awk -F, -v CONVFMT=%.17g 'NR == 1 { print "tick,distance,triangle"; next } NR == 9 { $4 += 0.003 }
        $4 == 0 && !missed { $4 = 0.001; missed = 1 } { print $1 "," $4 ",0" }' ours.csv >near.answers
    awk -F, 'NR == 1 { print "tick,distance,triangle"; next } { print $1 "," ($4 == 0 && NR != 2 ? 0 : "") ",0" }' \
        ours.csv >meets.answers
    for peer in near meets; do
        cat >peers/peer_$peer <<END
#!/bin/sh
[ "\$(wc -l <"\$2")" -eq 10001 ] && [ "\$(wc -c <"\$1")" -eq $((8 + 1002 * 12 + 2000 * 12)) ] && [ "\$3" = -o ] &&
    cp $peer.answers "\$4" && echo '{"first_ns":9,"build_ns":2000000,"ns":{"median":400,"p99":900,"p999":950,"max":999},
"ns_crossing":{"median":200,"p99":300,"p999":300,"max":300},"ns_histogram":{"edges":[16,17],"counts":[0,3,9996]}}'
END
    done
    printf '#!/bin/sh\nexit 1\n' >peers/peer_broken
    chmod +x peers/peer_*
}

peers()
{
    check 'one that fails is named' grep -qx 'dynpoint chart: peers/peer_broken: it failed, and is left out' star.stderr
    cell_is star.csv pair near wrong '==' 2
    cell_is star.csv pair near missed_crossings '==' 1
    cell_is star.csv pair near distance_error_m '==' 0.003
    cell_is star.csv pair near p99_us '==' 0.9
    cell_is star.csv pair near crossing_median_us '==' 0.2
    check 'times that a peer does not tell are empty' test -z "$(cell star.csv pair near other_p99_us)"
    cell_is star.csv pair exact crossing_median_us '>' 0
    cell_is star.csv pair exact other_median_us '>' 0
    cell_is star.csv pair meets wrong '<=' 1
    check 'one that tells no distance has none' test -z "$(cell star.csv pair meets distance_error_m)"
    check 'how long they take to begin' grep -qx '# peer near: takes the mesh in in 2 ms' star.csv
    check 'nothing of theirs is left' test -z "$(ls star.peer.* 2>/dev/null)"
    refuses 'none there' 'there is no program peer_NAME' chart star.dpa --peers out -o out/x
    refuses 'no folder of them' 'nowhere: cannot be read' chart star.dpa --peers nowhere -o out/x
    refuses 'of a scene' 'they know a single rigid mesh' chart membrane --peers peers -o out/x
}

prepare_star()
{
    succeeds 'a star' make star 2000 -o star.ply
    succeeds 'compiled' compile star.ply -o star.dpa
    succeeds 'the trace that a chart makes' make trace --mesh star.dpa --length 0.1 --ticks 10000 -o star.trace.csv
    make_peers
    succeeds 'its chart' chart star.dpa --length 0.1 --passes 1 --peers peers -o star
    mv stderr star.stderr
    check 'three files, and nothing beside them' test "$(ls star.csv star.svg star.histograms.csv star.*.part 2>/dev/null | wc -l)" -eq 3
}

# What --json told is the table's rows, column by column.
told_as_json()
{
    [ -x "$(command -v python3)" ] || return 0
    check "--json: $(cat stdout)" has_keys stdout scene ticks passes processor version kernel rows
    check 'each cell is that of the table' python3 -c '
import csv, json
rows = json.load(open("stdout"))["rows"]
table = list(csv.DictReader(line for line in open("star.csv") if line[0] != "#"))
assert len(rows) == len(table) > 3
for told, row in zip(rows, table):
    assert list(told) == list(row)
    for name, cell in row.items():
        assert (told[name] is None) if cell == "" else (str(told[name]) == cell or float(cell) == told[name]), name'
}

# The rows of the nearest pair, which take the least time.
nearest_alone()
{
    succeeds 'a star' make star 2000 -o star.ply
    succeeds 'compiled' compile star.ply -o star.dpa
    succeeds 'its chart' chart star.dpa --length 0.1 --until track --passes 1 -o star --json
    cell_is star.csv pair exact median_us '>' 0
    told_as_json
    as_truth
    [ ! -x "$(command -v python3)" ] || check "read back: $(python3 -B "$tests/tools/read_chart.py" star 2>&1 | tail -n 3)" \
        python3 -B "$tests/tools/read_chart.py" star
}

# One that takes another time in each repeat, and one that fails in the second.
repeats()
{
    mkdir again
    cat >again/peer_other <<'END'
#!/bin/sh
echo >>calls
case $(wc -l <calls) in 1) ns=500 p99=2000 ;; 2) ns=900 p99=1000 ;; *) ns=400 p99=1100 ;; esac
cp near.answers "$4"
echo "{\"first_ns\":9,\"ns\":{\"median\":$ns,\"p99\":$p99,\"p999\":$p99,\"max\":$p99},
\"ns_other\":{\"median\":1$ns,\"p99\":1$p99,\"p999\":1$p99,\"max\":1$p99}}"
END
    cat >again/peer_second <<'END'
#!/bin/sh
[ -e second ] && exit 1
touch second
cp near.answers "$4" && echo '{"first_ns":9,"ns":{"median":400,"p99":900,"p999":950,"max":999}}'
END
    chmod +x again/peer_*
    run chart star.dpa star.trace.csv --until track --passes 1 --repeats 3 --peers again -o thrice
    check "three repeats: $(cat stderr)" test $status -eq 0
    check 'each ran all' test "$(wc -l <calls)" -eq 3
    for pair in median_us:0.5 median_least_us:0.4 median_most_us:0.9 p99_us:1.1 p99_least_us:1 p99_most_us:2 max_us:1.1 \
        other_median_us:1.5 other_median_least_us:1.4 other_median_most_us:1.9 other_p99_most_us:12 whole_p99_least_us:1; do
        cell_is thrice.csv pair other "${pair%:*}" '==' "${pair#*:}"
    done
    check 'what a peer does not tell has no spread' test -z "$(cell thrice.csv pair other crossing_median_most_us)"
    check 'one that fails once is left out' test -z "$(cell thrice.csv pair second median_us)"
    check 'the spread is told' grep -qE '^# times are the middle of 3 repeats; in the middle row the largest median is 1[.0-9]* times the least, in the worst [2-9]' thrice.csv
    check 'of itself' grep -q '^  times are the middle of 3 repeats; ' stdout
    check 'the nearest pair alone' test "$(grep -v '^#' thrice.csv | cut -d, -f2 | sort -u)" = "$(printf 'pair\npart')"
    check 'least, middle and largest are in order' test "$(grep -v '^#' thrice.csv | awk -F, '
        NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
        { for (i in at) if (i ~ /_least_us$/) { name = i; sub("_least_us", "", name)
            if ($at[i] + 0 > $at[name "_us"] + 0 || $at[name "_us"] + 0 > $at[name "_most_us"] + 0) wrong++
            if (name == "median") apart += $at[i] + 0 < $at[name "_most_us"] + 0 } }
        END { print wrong + 0, (apart > 1) }')" = '0 1'
    for file in star thrice; do
        grep -v '^#' $file.csv | awk -F, '$2 == "pair" && $3 != "peer" || NR == 1 { if (NR == 1) for (i = 1; i <= NF; i++) time[i] = $i ~ /_us$/
            for (i = 1; i <= NF; i++) printf "%s,", time[i] ? "" : $i; print "" }' >$file.answers
    done
    check 'the answers are those of one' cmp star.answers thrice.answers
    check 'one repeat has no spread' test "$(cell star.csv pair exact median_least_us)" = "$(cell star.csv pair exact median_most_us)"
    check 'nor a bar' test "$(grep -c 'class="range"' star.svg)" -eq 0
    [ ! -x "$(command -v python3)" ] || check "read back: $(python3 -B "$tests/tools/read_chart.py" thrice 2>&1 | tail -n 3)" \
        python3 -B "$tests/tools/read_chart.py" thrice
}

every_row()
{
    for name in exact 'exact at 8 units' 'exact without cache' tree 'brute force' 'paper in 1 part' \
        'paper in 64 parts' 'paper one step'; do
        cell_is star.csv pair "$name" median_us '>' 0
        check "pair, $name: contact was not asked for" test -z "$(cell star.csv pair "$name" missed)"
    done
    for name in exact 'exact depth alone' tree 'paper in 1 part'; do
        cell_is star.csv contact "$name" unknown '>=' 0
        check "contact, $name: no force was asked for" test -z "$(cell star.csv contact "$name" jump_N)"
    done
    for law in proxy bed point; do
        for name in "$law" "$law at 400 units" "$law at 1600 units" "$law without contacts" "$law by tree"; do
            cell_is star.csv force "$name" jump_N '>' 0
        done
        cell_is star.csv force "$law" wrench_max_N '==' 0
        cell_is star.csv force "$law" wrench_peak_N '>' 1
        cell_is star.csv force "$law at 400 units" max_units '<=' 400
        cell_is star.csv force "$law" world_bytes '>' 1000000
    done
    cell_is star.csv force 'proxy sweeps at 200 units' jump_N '>' 0
    for kernel in avx2 sse2 scalar; do
        [ -z "$(cell star.csv pair "exact by $kernel" kernel)" ] ||
            cell_is star.csv pair "exact by $kernel" max_units '==' "$(cell star.csv pair exact max_units)"
    done
    cell_is star.csv force 'proxy at 400 units' wrench_max_N '>' 1
    cell_is star.csv force 'proxy at 400 units' bounded '>' 100
    check 'the machine is named' grep -q '^# machine: .*; dynpoint [0-9.]*, kernel [a-z0-9]*$' star.csv
    check 'brute force found nothing wrong' grep -q '^# truth: .* 0 of [1-9][0-9]* wrong' star.csv
    check 'build, add and refit are told' grep -q '^# body 0: 2000 triangles, .* compiled in .* added in .* refit ' star.csv
    check 'a cell a column in each row' test "$(grep -v '^#' star.csv | awk -F, '{ print NF }' | sort -u | wc -l)" -eq 1
}

as_truth()
{
    for name in exact 'exact without cache' tree 'brute force'; do
        cell_is star.csv pair "$name" wrong '==' 0
    done
    cell_is star.csv pair 'paper in 64 parts' wrong '>' 100
    cell_is star.csv pair 'exact at 8 units' wrong '>' 10
}

# The same trace by make trace and replay gives the same counts, and the loss is where the paper's descent is.
as_replay_counts()
{
    as_truth
    for name in 'pair,exact at 8 units' 'force,proxy at 400 units' 'pair,paper in 64 parts'; do
        cell_is star.csv "${name%,*}" "${name#*,}" wrong_exact '==' 0
    done
    run replay star.dpa star.trace.csv --method paper --until track --against brute --json -o /dev/null
    counts=$(sed -n 's/.*"against":{[^}]*"wrong":\([0-9]*\),"missed":\([0-9]*\),.*/\1 \2/p' stdout)
    check "replay has $counts wrong and missed" test "$(cell star.csv pair 'paper in 1 part' wrong) $(cell star.csv pair \
        'paper in 1 part' missed_crossings)" = "$counts"
    run replay star.dpa star.trace.csv --radius 0.002 --until contact --json -o /dev/null
    check 'its units are those of replay' grep -q "\"median\":$(cell star.csv contact exact median_units),\"p99\":" stdout
}

# histogram FILE PART NAME OF: "ticks", and the bins in which their median, 99 % and largest are
histogram()
{
    awk -F, -v part="$2" -v name="$3" -v of="$4" '$1 != name || $2 != part || $3 != of { next }
        { total += $6; low[++n] = $4; high[n] = $5 == "" ? 1e300 : $5; until[n] = total }
        function bin(share,  i) { for (i = 1; until[i] < share * total; i++); return low[i] " " high[i] " " }
        END { print total + 0, n ? bin(0.5) bin(0.99) bin(1) : "" }' "$1"
}

histograms()
{
    check "the histograms' head" test "$(head -n 1 star.histograms.csv)" = name,part,of,from,to,ticks
    for row in 'pair,exact' 'pair,tree' 'pair,paper in 16 parts' 'contact,exact' 'force,proxy' 'force,bed at 400 units'; do
        for of in work:units:1 ns:us:1000; do # times are told in four digits
            unit=${of#*:}
            set -- $(histogram star.histograms.csv "${row%%,*}" "${row#*,}" "${of%%:*}")
            check "$row, ${of%%:*}: all ticks but the first" test "$1" -eq 9999
            for which in median p99 max; do
                check "$row, ${of%%:*}: its $which is in its bin, from $2 to $3" awk -v low="$2" -v high="$3" -v scale="${unit#*:}" \
                    -v value="$(cell star.csv "${row%%,*}" "${row#*,}" "${which}_${unit%:*}")" \
                    'BEGIN { v = value * scale; near = scale > 1 ? 6e-4 : 0; exit !(v >= low * (1 - near) && v < high * (1 + near)) }'
                shift 2
            done
        done
    done
    check "a peer's are its own" test "$(grep '^near,' star.histograms.csv)" = "$(printf 'near,pair,ns,16,17,3\nnear,pair,ns,17,19,9996')"
    check 'one that counts none has none' test -z "$(grep '^other,' thrice.histograms.csv)"
}

pictures()
{
    [ -x "$(command -v python3)" ] || { skip 'charts read back: no python3'; return; }
    python3 -B "$tests/tools/read_chart.py" star >read.log 2>&1
    check "the picture: $(tail -n 3 read.log)" test $? -eq 0
    check "its panels: $(head -n 1 read.log)" grep -qxE 'Nearest pair 1[4-7], Contact 7, Force 23, Force 23' read.log
}

# A sheet that gives way, by a scene file and a trace of a file.
soft()
{
    cat >sheet.json <<'END'
{ "bodies": [ { "shape": "membrane", "triangles": 50, "material": { "kind": "sheet", "young": 1e5, "drag": 10,
  "viscosity": 0.001, "regions": [ { "box": [-0.11, -0.11, -0.01, -0.0999, 0.11, 0.01], "fixed": true } ] } } ] }
END
    succeeds 'a sheet' make membrane 50 -o sheet.ply
    succeeds 'compiled' compile sheet.ply -o sheet.dpa
    succeeds 'a trace over it' make trace --mesh sheet.dpa --length 0.1 --ticks 10000 -o sheet.trace.csv
    run chart sheet.json sheet.trace.csv --passes 1 -o soft --title 'a <sheet>'
    if [ $status -eq 2 ] && grep -q jansson stderr; then
        skip 'charts of scene files: built without jansson'
        return
    fi
    check "a scene file: $(cat stderr)" test $status -eq 0
    check 'the trace is named' grep -q '^# dynpoint chart sheet.json: 10000 ticks of sheet.trace.csv' soft.csv
    for name in 'proxy euler' 'proxy implicit' 'proxy rigid'; do
        cell_is soft.csv force "$name" whole_median_us '>' 0
    done
    cell_is soft.csv force proxy body_bytes '>' 1000
    cell_is soft.csv force 'proxy rigid' body_bytes '==' 0
    check 'brute force found nothing wrong on it' grep -q '^# truth: .* 0 of [1-9][0-9]* wrong' soft.csv
    check 'its title' grep -qF '<title>a &lt;sheet&gt;</title>' soft.svg
    check 'its physics is in the times' grep -q '>Time of a tick with its physics' soft.svg
    cat >tip.json <<'END'
{ "bodies": [ { "shape": "membrane", "triangles": 50 } ],
  "tool": { "length": 0.1, "tips": [ { "shape": "box", "extent": [0.004, 0.004, 0.01] } ] } }
END
    run chart tip.json --passes 1 -o tip
    check "a tool with a tip: $(cat stderr)" test $status -eq 0
    run chart tip.json --passes 2 -o again
    for run in tip again; do
        grep -v '^#' $run.csv | awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) time[i] = $i ~ /_us$/ }
            { for (i = 1; i <= NF; i++) printf "%s,", time[i] ? "" : $i; print "" }' >$run.answers
    done
    check 'another run, of two passes: other answers' cmp tip.answers again.answers
    check 'is felt by a proxy alone' test "$(grep -v '^#' tip.csv | cut -d, -f2,5 | sort -u)" = "$(printf 'force,proxy\npart,law')"
    check 'what judges it is held against brute force' grep -q '^# truth: .* 0 of [1-9][0-9]* wrong' tip.csv
    check 'its panels' test "$(grep -c 'class="panel"' tip.svg)" -eq 2
    sed '$s/} ] } } \] }/} ] }, "physics": { "room": 0.01 } } ] }/' sheet.json >tight.json
    check 'a sheet with little room' grep -q room tight.json
    run chart tight.json star.trace.csv --passes 1 -o torn
    check "a trace that pulls it out of its room: $(cat stderr)" test $status -eq 0
    check 'what judges it failed, too' test "$(cell torn.csv force 'proxy rigid' failure)" = DPT_E_FINITE
    check 'a row of it has all its cells' test "$(grep -v '^#' torn.csv | awk -F, '{ print NF }' | sort -u | wc -l)" -eq 1
    check 'and is not drawn' test "$(grep -c 'class="mark"' torn.svg)" -eq "$(grep -v '^#' torn.csv | awk -F, '
        NR == 1 { for (i = 1; i <= NF; i++) if ($i == "failure") at = i; next }
        $at == "" { n += $2 == "force" ? 2 : 1 } END { print n + 0 }')"
    [ ! -x "$(command -v python3)" ] || check "read back: $(python3 -B "$tests/tools/read_chart.py" soft 2>&1 | tail -n 3)" \
        python3 -B "$tests/tools/read_chart.py" soft
}

faults()
{
    head -n 10000 star.trace.csv >short.csv
    refuses '9999 ticks' 'it has 9999 ticks, and at least 10000 are needed' chart star.dpa short.csv -o out/x
    refuses 'fewer to make' '--ticks must be' chart star.dpa --ticks 9999 -o out/x
    refuses 'nothing' 'and -o NAME are needed' chart
    refuses 'no name' 'and -o NAME are needed' chart star.dpa
    refuses 'no scene' 'none.dpa' chart none.dpa -o out/x
    refuses 'no trace' 'none.csv' chart star.dpa none.csv -o out/x
    refuses 'a trace that is none' 'star.ply:1' chart star.dpa star.ply -o out/x
    refuses 'into no folder' 'nowhere/x.csv: cannot be written' chart star.dpa -o nowhere/x
    refuses 'standard output' '-o takes a name' chart star.dpa -o -
    refuses 'onto its trace' 'star.trace.csv: it is an input too' chart star.dpa star.trace.csv -o star.trace
    refuses 'no repeats' '--repeats must be' chart star.dpa --repeats 0 -o out/x
    refuses 'no such stage' "--until: 'never' is none of respond, track, contact" chart star.dpa --until never -o out/x
    refuses 'a tip without a force' 'tip.json: nothing feels it with --until contact' chart tip.json --until contact -o out/x
    refuses 'no passes' '--passes must be' chart star.dpa --passes 0 -o out/x
    refuses 'unknown option' --frob chart --frob
    for pair in length:-1 radius:2 stiffness:-1 friction:11; do
        refuses "--$pair" "--${pair%%:*}" chart star.dpa --"${pair%%:*}" "${pair#*:}" -o out/x
    done
    mkdir -p taken.svg
    run chart star.dpa star.trace.csv -o taken
    check "a folder in the way: exit $status" test $status -eq 2
    check 'and nothing is left' test ! -e taken.csv -a ! -e taken.csv.part
    timeout -s TERM 1 "$program" chart star.dpa star.trace.csv --passes 1000 -o cut >stdout 2>stderr
    check 'an interrupt leaves nothing' test -z "$(ls cut.* 2>/dev/null)"
    run chart --help
    check '--help' grep -q '^usage: dynpoint chart ' stdout
}

nearest_alone
[ ! "$is_part" ] || finish
prepare_star
every_row
as_replay_counts
peers
repeats
histograms
pictures
soft
faults
finish
