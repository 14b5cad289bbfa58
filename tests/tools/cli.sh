# SPDX-License-Identifier: BSD-3-Clause
# The program from outside, for the scripts tests/tools/cli_TOPIC.sh: exit status, what goes to which stream, which files
# are there then. They are called with BUILD, write below a folder of their own there, and may run beside each other.
#
# With a second argument, "part", a script that takes long runs a part of itself: `make test` does so.
#
# An error is exit status 2, exactly one line on standard error, nothing on standard output, and no output file, nor the
# .part beside it.
tests=$(cd "$(dirname "$0")/.." && pwd) || exit 2
. "$tests/lib/verdict.sh"
quiet=1 # a hundred golden files would hide what fails
build=${1:?usage: sh $0 BUILD [part]}
is_part=$([ "${2:-}" != part ] || echo yes)
build=$(cd "$build" && pwd) || exit 2
program=$build/dynpoint
work=$build/tests/$(basename "$0" .sh).$$
LC_ALL=C
export LC_ALL

mkdir -p "$work/out" || exit 2
trap 'rm -rf "$work"' EXIT
trap 'exit 2' HUP INT TERM
cd "$work" || exit 2

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
out_header=$out_header,lower_bound,fx,fy,fz,tx,ty,tz,energy,ox,oy,oz,qw,qi,qj,qk

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
