#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# `sh install.sh BUILD FOLDER`: puts the package of `make npm` where `npm install` would, without asking a registry.
set -eu
into=$2/node_modules/dynpoint
rm -rf "$into"
mkdir -p "$into"
tar xzf "$(ls "$1"/npm/dynpoint-*.tgz)" -C "$into" --strip-components 1
