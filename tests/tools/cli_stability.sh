#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# dynpoint stability: the laboratory of force, with few ticks. `sh tests/tools/cli_stability.sh BUILD [part]`. What fails
# and what holds is looked at where all runs.
. "$(dirname "$0")/cli.sh"

lab_effort=0.05
[ ! "$is_part" ] || lab_effort=0.01
geometry='spikes microconcave thinsheet parallel rocking slot bodies segments medial border sidelimit folds slivers coincident
    scale hour work tilt budget'
[ ! "$is_part" ] || geometry='thinsheet medial segments tilt'

listed()
{
    succeeds 'stability --list' stability --list
    cp stdout list
    for case in $geometry; do
        check "--list: $case" grep -q "^$case  *[A-Z0-9]" list
    done
    check '--list: a name twice' test "$(cut -d' ' -f1 list | sort -u | wc -l)" -eq "$(wc -l <list)"
    # Each case that runs without being named is run by this script or one of its neighbours, which hold the exit status.
    tried=$(sed -n "/^geometry='/,/'\$/p; /^loops='/p; /^tissue='/p" "$tests"/tools/cli_stability*.sh | tr "='" '  ')
    for case in $(sed -n '/only where named/!s/ .*//p' list); do
        check "no test runs $case" test -n "$(echo "$tried" | grep -w "$case")"
    done
}

refusals()
{
    refuses 'no such case' "case: 'wobble' is none of" stability rocking wobble
    refuses 'unknown option' --frob stability --frob
    for effort in 0 -1 1.01 nan hard; do
        refuses "--effort $effort" --effort stability rocking --effort $effort
    done
}

# fails METHOD CASE TEXT; holds METHOD CASE TEXT: a figure with the text in it does
fails()
{
    check "$2: $1 does not fail: $3" grep -q "^$2	$1	fails	.*$3" verdicts
}

holds()
{
    check "$2: $1 does not hold: $3" grep -q "^$2	$1	holds	.*$3" verdicts
}

shown()
{
    # shellcheck disable=SC2086
    run stability $geometry --effort "$lab_effort" --json
    check "exit $status: $(cat stderr)" test $status -eq 0
    cp stdout json
    # shellcheck disable=SC2086
    python3 -c '
import json, sys
names = []
for line in open("json"):
    case = json.loads(line, parse_constant=lambda word: sys.exit("not JSON: " + word))
    names.append(case["case"])
    assert len(case["title"]) > 10 and len(case["method"]) > 100 and len(case["advice"]) > 50, case["case"]
    for text in (case["title"], case["method"], case["advice"]):
        assert "  " not in text and text == text.strip(), text
    figures = case["figures"]
    assert {"bed", "proxy", "point"} <= {figure["method"] for figure in figures}, case["case"]
    assert len({(f["method"], f["what"]) for f in figures}) == len(figures), case["case"]
    for figure in figures:
        assert figure["value"] is not None, (case["case"], figure)
        print(case["case"], figure["method"], figure.get("verdict", "-"), figure["what"], sep="\t")
        limits = [key for key in ("at_most", "at_least") if key in figure]
        assert len(limits) == ("verdict" in figure), figure
        if limits:
            sign = 1 if limits[0] == "at_most" else -1
            is_met = sign * figure["value"] <= sign * figure[limits[0]]
            assert figure["verdict"] == ("holds" if is_met else "fails"), figure
    assert any(f["method"] == "proxy" and f.get("verdict") == "holds" for f in figures), case["case"]
    for point in case["points"]:
        assert point["chart"].startswith("stability-") and None not in (point["x"], point["y"]), point
assert names == sys.argv[1:], names
' $geometry >verdicts 2>python.log
    check "--json: $(tail -n 1 python.log)" test ! -s python.log
}

# A laboratory in which nothing fails tests nothing.
baselines()
{
    fails point spikes 'turn the force by over 30 degrees'
    fails point medial 'turn the force by over 30 degrees'
    fails point medial 'reverse the force'
    fails point rocking 'largest change of torque'
    fails point parallel 'largest change of torque'
    fails point segments 'in one piece'
    fails point folds 'largest |dW|'
    fails point slot 'largest |dW|'
    fails point border 'largest |dW|'
    fails bed border 'largest |dW|'
    fails bed bodies 'from the force of one body'
    fails bed coincident 'from one body'
    fails bed budget 'contact unknown, at all budgets'
    for method in point bed; do
        fails $method thinsheet 'through a wall of 0.2 mm'
        fails $method thinsheet 'least force'
        fails $method sidelimit 'largest loss of force'
    done
    for case in $geometry; do
        check "$case: the proxy fails" test -z "$(grep "^$case	proxy	fails" verdicts)"
    done
    holds proxy thinsheet 'least force'
    holds proxy medial 'reverse the force'
    holds proxy segments 'in one piece'
    holds bed segments 'in one piece'
    holds proxy tilt 'departure from 1 /'
    check 'tilt: a chart of every method and of the formula' test "$(grep -o '"chart":"stability-tilt","series":"[a-z]*"' json |
        sort -u | wc -l)" -eq 5
}

# A proxy that crawls uses the whole of its bound, and rounding does not break it. With fewer places none does so.
bounds()
{
    succeeds 'budget, of more places' stability budget --effort 0.15 --json
    told='"method":"proxy","what":"below 200 units: largest |dW|, of K (3 |motion| + 1 mm)","value"'
    check "the bound is met: $(grep -oF "$told" stdout)" grep -qF "$told:1," stdout
}

# docs/commands.md, docs/stability.md and --help say how many cases run where none is named.
counted()
{
    cases=$(grep -vc '(only where named)$' list)
    for page in docs/commands.md docs/stability.md; do
        check "$page: not $cases cases, but $(grep -oE '[0-9]+ cases' "$tests/../$page")" \
            test "$(grep -oE '[0-9]+ cases' "$tests/../$page")" = "$cases cases"
    done
    succeeds 'stability --help' stability --help
    check "--help: not $cases cases" grep -q "default: $cases cases, all but " stdout
}

# docs/stability.md tells what the program says: what short cases say with all their places and ticks.
told()
{
    run stability rocking segments sidelimit tilt scale --effort 1 --json
    check "exit $status: $(cat stderr)" test $status -eq 0
    python3 -B -c '
import json, sys
sys.path.insert(0, sys.argv[1] + "/bench")
import stability
page = open(sys.argv[1] + "/../docs/stability.md").read()
for line in open("stdout"):
    case = json.loads(line)
    for part in (stability.figures_table(case), stability.wrap(case["method"]), stability.wrap(case["advice"])):
        if part not in page:
            print(case["case"], next((row for row in part.split("\n") if row not in page), "rows"), sep=": ")
' "$tests" >differs 2>&1
    check "docs/stability.md is not of this program: $(head -n 1 differs)" test ! -s differs
}

# The same figures again, as a table too.
again()
{
    succeeds 'again' stability segments tilt --effort "$lab_effort" --json
    grep -E '^{"case":"(segments|tilt)"' json >first
    check 'other figures' cmp -s first stdout
    succeeds 'a table' stability segments --effort "$lab_effort"
    check 'a table: a title' grep -q '^segments: ' stdout
    check 'a table: what holds and what fails' test \
        "$(grep -c '  holds$' stdout),$(grep -c '  fails$' stdout)" = 2,1
    check 'a table: no meter where no one looks' test ! -s stderr
}

listed
refusals
shown
[ "$is_part" ] || baselines
[ "$is_part" ] || bounds
counted
[ "$is_part" ] || told
again
finish
