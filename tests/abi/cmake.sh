#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# As projects built with CMake take the libraries: find_package of what is installed, and add_subdirectory of the single
# files, from C and from C++. `sh tests/abi/cmake.sh BUILD`.
set -u
. "$(dirname "$0")/../lib/verdict.sh"
build=$1
quiet=1
command -v cmake >/dev/null 2>&1 || { skip "CMake: there is none"; finish; }
scratch=$PWD/$build/tests/cmake
rm -rf "$scratch"
mkdir -p "$scratch"
log=$scratch/log
: >"$log"
make -s install B="$build" DESTDIR="$scratch/staged" PREFIX=/opt/dp >>"$log" 2>&1
verdict $? "make install, see $log"
# It is moved as a whole.
mkdir -p "$scratch/elsewhere" && mv "$scratch/staged/opt/dp" "$scratch/elsewhere/dp"
prefix=$scratch/elsewhere/dp

# project NAME LANGUAGE SOURCE LINES...: a project of one program
project() {
    name=$1 language=$2 source=$3
    shift 3
    mkdir -p "$scratch/$name"
    cp "$source" "$scratch/$name/main.$([ "$language" = CXX ] && echo cc || echo c)"
    {
        echo 'cmake_minimum_required(VERSION 3.13)'
        echo "project(user $language)"
        printf '%s\n' "$@"
        echo "add_executable(user main.$([ "$language" = CXX ] && echo cc || echo c))"
        echo "set_target_properties(user PROPERTIES ${language}_STANDARD $([ "$language" = CXX ] && echo 17 || echo 99))"
        echo 'target_link_libraries(user ${wanted})'
    } >"$scratch/$name/CMakeLists.txt"
}

# made NAME [OPTION...]: it is configured and built
made() {
    name=$1
    shift
    cmake -S "$scratch/$name" -B "$scratch/$name/build" "$@" >"$scratch/said" 2>&1 &&
        cmake --build "$scratch/$name/build" >>"$scratch/said" 2>&1
    status=$?
    cat "$scratch/said" >>"$log"
    return $status
}

project shared C tests/abi/user.c 'find_package(dynpoint 0.3 REQUIRED COMPONENTS core compile)' 'set(wanted dynpoint::compile)'
made shared -DCMAKE_PREFIX_PATH="$prefix" && "$scratch/shared/build/user" &&
    readelf -d "$scratch/shared/build/user" | grep -q 'NEEDED.*libdynpoint_compile'
verdict $? "find_package: shared libraries, see $log"
project static C tests/abi/user.c 'set(dynpoint_STATIC ON)' 'find_package(dynpoint REQUIRED)' 'set(wanted dynpoint::compile)'
made static -DCMAKE_PREFIX_PATH="$prefix" && "$scratch/static/build/user" &&
    ! readelf -d "$scratch/static/build/user" | grep -q 'NEEDED.*libdynpoint'
verdict $? "find_package: static libraries, see $log"
if command -v "${CXX:-c++}" >/dev/null 2>&1; then
    project host CXX tests/abi/host_user.cc 'find_package(dynpoint REQUIRED COMPONENTS host drivers)' 'set(wanted dynpoint::host)'
    made host -DCMAKE_PREFIX_PATH="$prefix" && [ "$("$scratch/host/build/user")" = "$("$build/dynpoint" -V | cut -d ' ' -f 2)" ]
    verdict $? "find_package: a host with drivers in C++17, see $log"
    project static_host CXX tests/abi/host_user.cc 'find_package(dynpoint REQUIRED COMPONENTS host)' 'set(wanted dynpoint::host_static)'
    made static_host -DCMAKE_PREFIX_PATH="$prefix" && "$scratch/static_host/build/user" >/dev/null
    verdict $? "find_package: the same, static, see $log"
else
    skip "a host in C++: no C++ compiler"
fi
project missing C tests/abi/user.c 'find_package(dynpoint REQUIRED COMPONENTS core haptics)' 'set(wanted dynpoint::core)'
! made missing -DCMAKE_PREFIX_PATH="$prefix" && grep -q 'dynpoint has no component haptics here' "$scratch/said"
verdict $? "find_package: a component that there is not is named, see $log"
for version in 0.2 0.4 1.0 0.3.9; do
    project "version_$version" C tests/abi/user.c "find_package(dynpoint $version REQUIRED)" 'set(wanted dynpoint::core)'
    ! made "version_$version" -DCMAKE_PREFIX_PATH="$prefix" && grep -q 'compatible with requested' "$scratch/said"
    verdict $? "find_package: version $version is refused, see $log"
done

if [ -e "$build/amalgamation/CMakeLists.txt" ]; then
    cp -r "$build/amalgamation" "$scratch/single"
    # Debug, which compiles in a quarter of the time.
    language=$(command -v "${CXX:-c++}" >/dev/null 2>&1 && echo CXX || echo C)
    project inside $language tests/abi/user.c 'add_subdirectory(../single dynpoint)' 'add_definitions(-DALONE)' 'set(wanted dynpoint::compile)'
    made inside -DCMAKE_BUILD_TYPE=Debug && "$scratch/inside/build/user"
    verdict $? "add_subdirectory: the single files, in a project in $language, see $log"
else
    skip "the single files by add_subdirectory: no python3"
fi
finish
