#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# What the tests can use beside a C compiler and make, as Debian packages. Without an argument prints the
# list, what is missing and its size, and installs it when that can be done (root, apt-get, DEPS not
# "no"); nothing here is needed by the library or the demo, and a test whose package is missing is skipped. With
# liburdfdom-dev and g++ the library for robots' descriptions is built too.
set -u
packages="python3 pkg-config g++ libfcl-dev libcgal-dev libgmp-dev gcc-aarch64-linux-gnu
libc6-dev-arm64-cross gcc-arm-linux-gnueabihf libc6-dev-armhf-cross gcc-s390x-linux-gnu libc6-dev-s390x-cross qemu-user-static
gcc-arm-none-eabi libnewlib-arm-none-eabi qemu-system-arm qemu-system-x86 xz-utils python3-venv python3-cffi
liburdfdom-dev libexpat1-dev"

missing=
for package in $packages; do
    dpkg -s "$package" >/dev/null 2>&1 || missing="$missing $package"
done
echo "packages that the tests can use: $(echo $packages)"
if [ -z "$missing" ]; then
    echo "all are here"
    exit 0
fi
echo "missing:$missing"
command -v apt-get >/dev/null 2>&1 || { echo "no apt-get: their tests are skipped"; exit 0; }
apt-get install --simulate $missing >/dev/null 2>&1 || [ "${DEPS:-yes}" = no ] || apt-get update -qq >/dev/null 2>&1
apt-get install --assume-no $missing 2>/dev/null | grep -E '^(Need to get|After this)' || true
if [ "${DEPS:-yes}" = no ]; then
    echo "DEPS=no: their tests are skipped"
elif [ "$(id -u)" -ne 0 ]; then
    echo "not root: install them with 'sudo make deps'; until then their tests are skipped"
else
    DEBIAN_FRONTEND=noninteractive apt-get install -y -qq $missing >/dev/null 2>&1 ||
        echo "apt-get failed: their tests are skipped"
fi
exit 0
