#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Sources of Debian's packages, as their authors released them: sh tests/lib/sources.sh FOLDER PACKAGE... unpacks each into
# FOLDER/PACKAGE. Where this machine's packages come from, their sources come from too. Status 1: one cannot be had.
set -u
mkdir -p "$1/apt/lists/partial" || exit 1
folder=$(cd "$1" && pwd)
shift
sed 's/^Types:.*/Types: deb-src/' /etc/apt/sources.list.d/debian.sources >"$folder/apt/debian.sources" || exit 1
apt="-o Dir::Etc::sourcelist=$folder/apt/debian.sources -o Dir::Etc::sourceparts=/dev/null -o Dir::State::lists=$folder/apt/lists"
# shellcheck disable=SC2086
apt-get $apt update || exit 1
for package; do
    rm -rf "$folder/apt/$package" "${folder:?}/$package"
    mkdir -p "$folder/apt/$package" "$folder/$package"
    # Debian's own changes, which may be gone already where they have been replaced, are not needed.
    # shellcheck disable=SC2086
    (cd "$folder/apt/$package" && apt-get $apt source --download-only "$package")
    tar xf "$folder/apt/$package"/*.orig.tar.* -C "$folder/$package" --strip-components=1 || exit 1
done
