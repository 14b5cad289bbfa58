#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The manual's pages, from what `dynpoint help` says: `sh man.sh PROGRAM FOLDER` writes FOLDER/dynpoint.1 and a
# dynpoint-COMMAND.1 for each command.
set -eu
program=$1 folder=$2
if ! "$program" --version >/dev/null 2>&1; then
    echo "no manual pages: $program does not run on this machine"
    exit
fi
mkdir -p "$folder"
version=$("$program" --version | cut -d ' ' -f 2)

# page NAME SUMMARY, with the help's text on standard input: its usage lines are the synopsis, the rest stands as it is
page() {
    printf '.TH %s 1 "" "dynpoint %s" "dynpoint"\n.SH NAME\n%s \\- %s\n.SH SYNOPSIS\n.nf\n' \
        "$(echo "$1" | tr a-z A-Z)" "$version" "$1" "$2"
    sed 's/\\/\\e/g; s/-/\\-/g; s/^\([.'\'']\)/\\\&\1/' | awk '
        !body && /^(usage:|       )/ { sub(/^usage: |^       /, ""); print; next }
        !body { body = 1; print ".fi\n.SH DESCRIPTION\n.nf"; if ($0 == "") next }
        { print }'
    printf '.fi\n'
}

"$program" help | page dynpoint 'lets a line-shaped tool feel triangle meshes' >"$folder/dynpoint.1"
"$program" help | sed -n 's/^  \([a-z-][a-z-]*\)  *\(.*\)$/\1 \2/p' | while read -r command what; do
    {
        "$program" help "$command" | page "dynpoint-$command" "$what"
        printf '.SH SEE ALSO\n.BR dynpoint (1)\n'
    } >"$folder/dynpoint-$command.1"
done
{
    printf '.SH SEE ALSO\n'
    "$program" help | sed -n 's/^  \([a-z-][a-z-]*\)  .*$/.BR dynpoint-\1 (1)/p'
} >>"$folder/dynpoint.1"
