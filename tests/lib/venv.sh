#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Python packages from PyPI, in a folder of their own: sh tests/lib/venv.sh FOLDER REQUIREMENTS. Once: a folder that has
# all of them holds the file "complete". Status 1, and a line that says why, where that cannot be done.
set -u
folder=$1
[ ! -f "$folder/complete" ] || exit 0
mkdir -p "$(dirname "$folder")"
rm -rf "$folder"
{ python3 -m venv "$folder" && timeout 300 "$folder/bin/pip" install --no-cache-dir --disable-pip-version-check --retries 1 \
    --timeout 20 -r "$2"; } >"$folder.log" 2>&1 && touch "$folder/complete" && exit 0
echo "no packages of $2: no python3 with venv, or PyPI cannot be reached; see $folder.log"
exit 1
