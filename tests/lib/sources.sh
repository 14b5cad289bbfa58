#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Sources of Debian's packages, as their authors released them: sh tests/lib/sources.sh FOLDER PACKAGE... unpacks each into
# FOLDER/PACKAGE. Where this machine's packages come from, their sources come from too. Status 1: one cannot be had.
# With SUITE=NAME they are those of another release of Debian.
set -u
mkdir -p "$1/apt/lists/partial" || exit 1
folder=$(cd "$1" && pwd)
shift
{
    if [ -n "${SUITE:-}" ]; then
        sed "/^\$/,\$d; s/^Suites:.*/Suites: $SUITE/" /etc/apt/sources.list.d/debian.sources
    else
        cat /etc/apt/sources.list.d/debian.sources
    fi
} | sed 's/^Types:.*/Types: deb-src/' >"$folder/apt/debian.sources"
[ -s "$folder/apt/debian.sources" ] || exit 1
apt="-o Dir::Etc::sourcelist=$folder/apt/debian.sources -o Dir::Etc::sourceparts=/dev/null -o Dir::State::lists=$folder/apt/lists"
# shellcheck disable=SC2086
apt-get $apt update || exit 1
for package; do
    rm -rf "$folder/apt/$package" "${folder:?}/$package"
    mkdir -p "$folder/apt/$package" "$folder/$package"
    # The newest that is there: a list may be ahead of what can be had. Debian's own changes, which may be gone already where
    # they have been replaced, are not needed here.
    tarball=
    # shellcheck disable=SC2086
    for version in $(apt-cache $apt showsrc --only-source "$package" | sed -n 's/^Version: //p' | sort -urV); do
        (cd "$folder/apt/$package" && apt-get $apt source --download-only "$package=$version")
        tarball=$(find "$folder/apt/$package" -name '*.orig.tar.*' ! -name '*.asc')
        [ -z "$tarball" ] || break
    done
    [ -n "$tarball" ] && tar xf "$tarball" -C "$folder/$package" --strip-components=1 || exit 1
done
