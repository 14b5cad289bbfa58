#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The first hour of someone who embeds the library, in an empty chroot of Debian with compilers, CMake and pkg-config:
# `sh tests/platforms/embedder.sh BUILD [COMMIT]`. The sources are those of COMMIT, or HEAD, built and installed as the
# README says. Then each task is tried in the ways below, the one a user would try first before the others, until one works:
# those that fail are stumbles. Of HEAD there must be none. docs/install.md has the table. The chroot, 1.4 GB, is made once by
# debootstrap, as root; JOBS (2) is for make.
set -u
. "$(dirname "$0")/../lib/verdict.sh"
build=$1 commit=${2:-HEAD}
quiet=1
for tool in debootstrap chroot git tar; do
    command -v $tool >/dev/null 2>&1 || { skip "an embedder's first hour: no $tool"; finish; }
done
[ "$(id -u)" -eq 0 ] || { skip "an embedder's first hour: a chroot needs root"; finish; }
place=$PWD/$build/embedder
base=$place/base
mkdir -p "$place"
log=$place/log
: >"$log"
if [ ! -e "$base/made" ]; then
    rm -rf "$base"
    debootstrap --variant=minbase --include=gcc,g++,make,cmake,pkg-config,python3-minimal,gcc-arm-none-eabi,libnewlib-arm-none-eabi \
        bookworm "$base" >>"$log" 2>&1 || { skip "an embedder's first hour: debootstrap failed, see $log"; finish; }
    : >"$base/made"
fi
rm -rf "$base/src" "$base/home" "$base/usr/local"
mkdir -p "$base/src" "$base/home" "$base/usr/local"
git archive "$commit" | tar -x -C "$base/src"
here=$(cd "$(dirname "$0")/.." && pwd)
cp "$here/abi/user.c" "$base/home/user.c"
cp "$here/abi/user.c" "$base/home/user.cc"
cp "$here/abi/host_user.cc" "$base/home/host.cc"

# inside COMMAND...: without anything of this machine's environment
inside() {
    env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/home LC_ALL=C chroot "$base" /bin/sh -ec "cd /home; $1" >>"$log" 2>&1
}

# cmake_project LINES...: a CMakeLists.txt, configured, built and run
cmake_project() {
    printf "rm -rf p; mkdir p; cd p; cat >CMakeLists.txt <<'END'\ncmake_minimum_required(VERSION 3.13)\n"
    printf '%s\n' "$@"
    printf 'END\ncmake -S . -B b -DCMAKE_BUILD_TYPE=Debug && cmake --build b && b/user >/dev/null'
}

# The seconds of processor time that commands took so far.
computed() {
    times >"$place/times"
    sed -n '2s/[ms]/ /gp' "$place/times" | awk '{ print 60 * $1 + $2 + 60 * $3 + $4 }'
}

# task NAME WAY...: the first that works; its number less one are the stumbles
task() {
    name=$1 stumbles=0
    computed >"$place/begun"
    shift
    for way; do
        echo "== $name: $way" >>"$log"
        if inside "$way"; then
            computed >"$place/ended"
            printf '%s|%.1f|%d\n' "$name" "$(paste "$place/ended" "$place/begun" | awk '{ print $1 - $2 }')" $stumbles >>"$place/table"
            return
        fi
        stumbles=$((stumbles + 1))
    done
    printf '%s|-|%d, and no way left\n' "$name" $stumbles >>"$place/table"
}

: >"$place/table"
task 'make' "cd /src; make -j${JOBS:-2}"
task 'make install, into /usr/local' 'cd /src; make install; ldconfig'
task 'single files' 'cd /src; make amalgamation'
pkg='find_package(PkgConfig REQUIRED)'
task 'a C program, by find_package' \
    "$(cmake_project 'project(user C)' 'find_package(dynpoint 0.3 REQUIRED COMPONENTS core compile)' \
        'add_executable(user ../user.c)' 'target_link_libraries(user dynpoint::compile)')" \
    "$(cmake_project 'project(user C)' "$pkg" 'pkg_check_modules(dp REQUIRED IMPORTED_TARGET libdynpoint_compile)' \
        'add_executable(user ../user.c)' 'target_link_libraries(user PkgConfig::dp)')" \
    "$(cmake_project 'project(user C)' 'add_executable(user ../user.c)' 'target_link_libraries(user dynpoint_compile dynpoint)')"
single='add_executable(user ../user.cc ../dynpoint/dynpoint.c ../dynpoint/dynpoint_compile.c)'
begin='rm -rf dynpoint; cp -r /src/build/amalgamation dynpoint;'
rest='target_compile_definitions(user PRIVATE ALONE)
target_include_directories(user PRIVATE ../dynpoint)
find_package(Threads REQUIRED)
target_link_libraries(user Threads::Threads m)'
as_cxx='set_source_files_properties(../dynpoint/dynpoint.c ../dynpoint/dynpoint_compile.c PROPERTIES LANGUAGE CXX)'
task 'single files in a C++ project, by add_subdirectory' \
    "$begin $(cmake_project 'project(user CXX)' 'add_subdirectory(../dynpoint dynpoint)' 'add_executable(user ../user.cc)' \
        'target_compile_definitions(user PRIVATE ALONE)' 'target_link_libraries(user dynpoint::compile)')" \
    "$begin $(cmake_project 'project(user CXX)' "$single" "$rest")" \
    "$begin $(cmake_project 'project(user CXX)' "$single" "$as_cxx" "$rest")" \
    "$begin $(cmake_project 'project(user C CXX)' "$single" "$rest")"
task 'single files as C++, without a C compiler' \
    "$begin $(cmake_project 'project(user CXX)' 'set(CMAKE_CXX_STANDARD 17)' "$single" "$as_cxx" "$rest")"
task 'a host with drivers in C++17' \
    "$(cmake_project 'project(user CXX)' 'set(CMAKE_CXX_STANDARD 17)' 'find_package(dynpoint REQUIRED COMPONENTS host drivers)' \
        'add_executable(user ../host.cc)' 'target_link_libraries(user dynpoint::host)')" \
    "$(cmake_project 'project(user CXX)' 'set(CMAKE_CXX_STANDARD 17)' "$pkg" \
        'pkg_check_modules(dp REQUIRED IMPORTED_TARGET libdynpoint_host)' 'add_executable(user ../host.cc)' \
        'target_link_libraries(user PkgConfig::dp)')"
static='! readelf -d user | grep -q NEEDED.*dynpoint && ./user >/dev/null'
task 'the host, linked to static libraries' \
    "$(cmake_project 'project(user CXX)' 'set(CMAKE_CXX_STANDARD 17)' 'set(dynpoint_STATIC ON)' \
        'find_package(dynpoint REQUIRED COMPONENTS host drivers)' 'add_executable(user ../host.cc)' \
        'target_link_libraries(user dynpoint::host)') && ! readelf -d b/user | grep -q NEEDED.*dynpoint" \
    "g++ -std=c++17 host.cc -static \$(pkg-config --cflags --libs --static libdynpoint_host) -o user && $static" \
    "g++ -std=c++17 host.cc \$(pkg-config --cflags --libs --static libdynpoint_host) -o user && $static" \
    "g++ -std=c++17 host.cc -Wl,-Bstatic -ldynpoint_host -ldynpoint_drivers -ldynpoint_compile -ldynpoint -Wl,-Bdynamic -lm -pthread -ldl -o user && $static"
task 'a program without any shared library' \
    "cc user.c -static \$(pkg-config --cflags --libs --static libdynpoint_compile) -o user && ./user && ! readelf -d user | grep -q NEEDED" \
    "cc user.c -static -ldynpoint_compile -ldynpoint -lm -pthread -o user && ./user"
task 'a tree that was moved' \
    "rm -rf /opt/dp; make -C /src -s install PREFIX=/usr DESTDIR=/home/staged; mv staged/usr /opt/dp; export PKG_CONFIG_PATH=/opt/dp/lib/pkgconfig
        cc user.c \$(pkg-config --cflags --libs libdynpoint_compile) -Wl,-rpath,/opt/dp/lib -o user && [ -z \"\$(pkg-config --cflags libdynpoint_compile | grep -v /opt/dp)\" ] && ./user" \
    "cc user.c -I/opt/dp/include -L/opt/dp/lib -ldynpoint_compile -ldynpoint -Wl,-rpath,/opt/dp/lib -o user && ./user"
cat >"$base/home/firmware.c" <<'C'
#include "dynpoint.h"
static unsigned char block[400000];
int main(void)
{
    dpt_world_def def;
    dpt_world *world;
    dpt_world_def_init(&def);
    def.max_bodies = def.max_tools = def.max_segments = 1;
    def.certificate_bytes = 16384;
    return dpt_world_bytes(&def) > sizeof block || dpt_world_create(block, sizeof block, &def, &world) != DPT_OK;
}
C
arm='arm-none-eabi-gcc -mcpu=cortex-m7 -mthumb -mfloat-abi=hard -mfpu=fpv5-d16 -O2 -ffunction-sections -fdata-sections'
task 'firmware for a Cortex-M7: the core in one file' \
    "$begin $arm -Idynpoint -c dynpoint/dynpoint.c -o core.o && $arm -Idynpoint firmware.c core.o --specs=nosys.specs -Wl,--gc-sections -lm -o firmware.elf && arm-none-eabi-size firmware.elf"

echo "an embedder's first hour, $(git log -1 --format=%h "$commit"): task, seconds of processor time, stumbles"
sed 's/|/ | /g; s/^/  /' "$place/table"
if [ "$commit" = HEAD ]; then
    [ "$(wc -l <"$place/table")" -eq 11 ] && ! grep -v '|0$' "$place/table" >"$place/stumbled"
    verdict $? "eleven tasks are done in the way that is tried first: $(tr '\n' ' ' <"$place/stumbled"), see $log"
fi
finish
