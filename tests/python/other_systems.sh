#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# What the wheels for Windows, macOS and musl are built of and run by: sh tests/python/other_systems.sh FOLDER PYTHON, which
# has ziglang. Once: each part has a file NAME.complete when it is there.
#   jansson  the sources of Debian's package
#   urdf     those of urdfdom and of what it stands on. Debian's changes to TinyXML cure faults that were found in it since;
#            expat is the newest that can be had.
#   windows  CPython 3.11 for Windows, as Maven's org.bytedeco:cpython packs it. It leaves out python3.dll, which hands what
#            is in the limited API to python311.dll: made here, of all that the package's own python3.lib lists. With the last
#            NumPy whose calls wine 8 has.
#   musl     CPython 3.11, of the sources of Debian's package, compiled by musl-gcc; with the last NumPy that Debian's musl
#            loads
# Status 1, and a line for each part that cannot be had.
set -u
mkdir -p "$1" || exit 1
folder=$(cd "$1" && pwd) status=0
case $2 in /*) python=$2 ;; *) python=$PWD/$2 ;; esac
# numpy PLATFORM VERSION: into the folder site here.
numpy() {
    "$python" -m pip install --quiet --no-deps --disable-pip-version-check --target site --platform "$1" --only-binary=:all: \
        --python-version 3.11 "numpy==$2"
}
jansson() {
    sh tests/lib/sources.sh "$folder/source" jansson && cp -R "$folder/source/jansson" "$folder/jansson"
}
urdf() {
    sh tests/lib/sources.sh "$folder/source" urdfdom urdfdom-headers console-bridge tinyxml &&
        SUITE=sid sh tests/lib/sources.sh "$folder/sid" expat && mkdir "$folder/urdf" &&
        cp -R "$folder"/source/urdfdom "$folder"/source/urdfdom-headers "$folder"/source/console-bridge "$folder"/source/tinyxml \
            "$folder"/sid/expat "$folder/urdf" && cd "$folder/urdf/tinyxml" && tar xf "$folder"/source/apt/tinyxml/*.debian.tar.* || return 1
    while read -r change; do patch -p1 -s <"debian/patches/$change" || return 1; done <debian/patches/series
}
windows() {
    mkdir "$folder/windows" && cd "$folder/windows" &&
        mvn -B dependency:copy -Dartifact=org.bytedeco:cpython:3.11.3-1.5.9:jar:windows-x86_64 -DoutputDirectory="$PWD" &&
        "$python" -m zipfile -e cpython-*.jar . && mv org/bytedeco/cpython/windows-x86_64 python || return 1
    {
        printf 'LIBRARY python3.dll\nEXPORTS\n'
        nm python/libs/python3.lib 2>/dev/null | sed -n 's/^.* [A-Z] __imp_\(.*\)$/\1 = python311.\1/p' | sort -u
    } >python3.def
    echo 'int DllMain(void *library, unsigned why, void *reserved) { return 1; }' >python3.c
    "$python" -m ziglang cc -target x86_64-windows-gnu -w -shared python3.c python3.def -o python/python3.dll && numpy win_amd64 1.26.4
}
musl() {
    sh tests/lib/sources.sh "$folder/source" python3.11 && mkdir -p "$folder/musl/programs" "$folder/musl/kernel" && cd "$folder/musl" || return 1
    # The kernel's headers alone, which are for every C library; and no word of the folders of Debian's.
    for name in linux asm asm-generic; do
        for place in /usr/include "/usr/include/$(cc -dumpmachine)"; do
            [ ! -d "$place/$name" ] || ln -sfn "$place/$name" "kernel/$name"
        done
    done
    printf '#!/bin/sh\ncase $1 in -print-multiarch | --print-multiarch) exit ;; esac\nexec musl-gcc -isystem "%s" "$@"\n' \
        "$PWD/kernel" >programs/musl-cc
    printf '#!/bin/sh\nexit 1\n' >programs/dpkg-architecture
    chmod +x programs/*
    PATH=$PWD/programs:$PATH
    mkdir made && cd made && PKG_CONFIG_LIBDIR=$PWD ../../source/python3.11/configure CC=musl-cc CFLAGS=-O1 OPT= --prefix="$folder/musl/python" \
        --without-ensurepip --disable-test-modules --build=x86_64-linux-musl && make -j"${JOBS:-2}" && make install && cd .. &&
        numpy musllinux_1_1_x86_64 1.26.4
}
unset CC
for part in jansson urdf windows musl; do
    [ ! -f "$folder/$part.complete" ] || continue
    rm -rf "${folder:?}/$part"
    if ("$part") >"$folder/$part.log" 2>&1; then
        touch "$folder/$part.complete"
    else
        echo "$part: it cannot be had, see $folder/$part.log"
        status=1
    fi
done
exit $status
