#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# A Python for AArch64, and what a wheel for it is linked to, out of Debian's packages, unpacked and not installed: sh
# tests/python/foreign_root.sh FOLDER. NumPy for it comes from PyPI. Once: a folder that has all of it holds the file
# "complete".
set -u
folder=$1
[ ! -f "$folder/complete" ] || exit 0
rm -rf "$folder"
mkdir -p "$folder/apt/lists/partial" "$folder/apt/cache/archives/partial" || exit 1
mkdir "$folder/packages" "$folder/tree" "$folder/site" || exit 1
folder=$(cd "$folder" && pwd)
: >"$folder/apt/status"
apt() { # COMMAND...
    what=$1
    shift
    apt-get "$what" -qq -o APT::Architecture=arm64 -o APT::Architectures=arm64 -o APT::Sandbox::User=root \
        -o Dir::State::lists="$folder/apt/lists" -o Dir::State::status="$folder/apt/status" -o Dir::Cache="$folder/apt/cache" "$@"
}
unpack() {
    for package in "$folder"/packages/*.deb; do dpkg -x "$package" "$folder/tree" || return 1; done
}
{
    apt update &&
        (cd "$folder/packages" && apt download libc6 libgcc-s1 libstdc++6 zlib1g libexpat1 libffi8 libssl3 libbz2-1.0 \
            liblzma5 libuuid1 libpython3.11-minimal python3.11-minimal libpython3.11-stdlib \
            libjansson4 libjansson-dev libccd2 libccd-dev) &&
        unpack &&
        python3 -m venv "$folder/pip" &&
        "$folder/pip/bin/python" -m pip install --quiet --target "$folder/site" --platform manylinux_2_28_aarch64 \
            --platform manylinux_2_27_aarch64 --platform manylinux2014_aarch64 --only-binary=:all: --python-version 3.11 numpy==2.4.6 &&
        touch "$folder/complete"
} >"$folder/log" 2>&1 && exit 0
echo "no Python for AArch64: Debian or PyPI cannot be reached; see $folder/log"
exit 1
