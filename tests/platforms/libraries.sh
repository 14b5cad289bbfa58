#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# jansson and libwebsockets for Windows: sh tests/platforms/libraries.sh FOLDER. Debian has no packages of these for
# mingw-w64, so its source packages are compiled. Once: a folder that has both holds the file "complete". Status 1, and a
# line that says why, where that cannot be done.
set -u
case $1 in /*) folder=$1 ;; *) folder=$PWD/$1 ;; esac
[ ! -f "$folder/complete" ] || exit 0
rm -rf "$folder"
mkdir -p "$folder/lib/pkgconfig"
{
    sh tests/lib/sources.sh "$folder/source" jansson libwebsockets && cd "$folder/source" &&
        common="-DCMAKE_SYSTEM_NAME=Windows -DCMAKE_C_COMPILER=x86_64-w64-mingw32-gcc -DCMAKE_RC_COMPILER=x86_64-w64-mingw32-windres
            -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX=$folder" &&
        cmake -S jansson -B made/jansson $common -DJANSSON_BUILD_DOCS=OFF -DJANSSON_WITHOUT_TESTS=ON -DJANSSON_EXAMPLES=OFF &&
        make -C made/jansson install &&
        cmake -S libwebsockets -B made/libwebsockets $common -DLWS_WITH_SSL=OFF -DLWS_WITHOUT_TESTAPPS=ON -DLWS_WITH_SHARED=OFF \
            -DLWS_IPV6=ON -DLWS_WITHOUT_EXTENSIONS=ON -DLWS_WITH_MINIMAL_EXAMPLES=OFF -DLWS_WITH_HTTP2=OFF -DDISABLE_WERROR=ON &&
        make -C made/libwebsockets install &&
        printf '%s\n' 'Name: libwebsockets' 'Description: web sockets' 'Version: 4.1.6' "Cflags: -I$folder/include" \
            "Libs: -L$folder/lib -lwebsockets_static -lws2_32 -liphlpapi -lpsapi" >"$folder/lib/pkgconfig/libwebsockets.pc" &&
        touch "$folder/complete"
} >"$folder.log" 2>&1
[ -f "$folder/complete" ] && exit 0
echo "no jansson and libwebsockets for Windows: no mingw-w64 and cmake, or no source packages of Debian; see $folder.log"
exit 1
