#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# What `make install` does, and `make uninstall`: `sh install.sh BUILD` copies what make has built, and builds nothing;
# `sh install.sh --remove` removes the files that the manifest lists, its folders where they are empty then, and no more.
# The Makefile gives DESTDIR, PREFIX and the folders of its head, VERSION, SOVERSION, LIBRARIES (names without an ending),
# and, for those who link statically, THREADS, DL, JANSSON and CCD (yes or no).
set -eu
manifest=$DATADIR/dynpoint/manifest

if [ "$1" = --remove ]; then
    [ -f "$DESTDIR$manifest" ] || { echo "nothing is installed there: no $DESTDIR$manifest" >&2; exit 1; }
    while IFS= read -r file; do
        rm -f "$DESTDIR$file"
    done <"$DESTDIR$manifest"
    sed 's|/[^/]*$||' "$DESTDIR$manifest" | LC_ALL=C sort -ru | while IFS= read -r folder; do
        # Those that are dynpoint's own; a folder that others use may be empty today.
        case $folder in
        */dynpoint | */dynpoint/*) rmdir "$DESTDIR$folder" 2>/dev/null || : ;;
        esac
    done
    rm -f "$DESTDIR$manifest"
    rmdir "$DESTDIR$DATADIR/dynpoint" 2>/dev/null || :
    exit
fi

build=$1
[ -x "$build/dynpoint" ] || { echo "nothing is built in $build: run make first" >&2; exit 1; }
umask 022
list=$(mktemp)
trap 'rm -f "$list"' EXIT

# put MODE FOLDER FILE...
put() {
    mode=$1 folder=$2
    shift 2
    install -d "$DESTDIR$folder"
    install -m "$mode" "$@" "$DESTDIR$folder"
    for file; do echo "$folder/${file##*/}"; done >>"$list"
}

# written FOLDER NAME: what comes on standard input
written() {
    install -d "$DESTDIR$1"
    cat >"$DESTDIR$1/$2"
    chmod 644 "$DESTDIR$1/$2"
    echo "$1/$2" >>"$list"
}

# The way up from a folder to the prefix, as "../.."; nothing where it is not below it.
up_from() {
    case $1 in
    "$PREFIX"/*) echo "${1#"$PREFIX"/}" | sed 's|[^/][^/]*|..|g' ;;
    esac
}

# A folder as seen from the prefix, or as it is.
below() { # FOLDER PREFIX_AS_WRITTEN
    case $1 in
    "$PREFIX"/*) echo "$2/${1#"$PREFIX"/}" ;;
    *) echo "$1" ;;
    esac
}

# What a static library needs beside itself, for people who link it: packages, and libraries.
needs() {
    case $1 in
    libdynpoint) echo "- - -lm" ;;
    *_compile) echo "libdynpoint - -lm $THREADS" ;;
    *_drivers) echo "libdynpoint - -lm $THREADS $DL" ;;
    *_convex) echo "libdynpoint ccd -lm" ;;
    *_urdf) echo "libdynpoint_compile urdfdom,console_bridge,expat -lm -lstdc++" ;;
    *_host)
        private=$([ "$CCD" = no ] || printf libdynpoint_convex)$([ "$JANSSON" = no ] || printf ,jansson)
        echo "libdynpoint_drivers,libdynpoint_compile ${private:--} -lm $THREADS"
        ;;
    esac
}

# Beside the .pc, so that a tree that is moved as a whole still works.
package() {
    up=$(up_from "$PKGCONFIGDIR")
    set -- "$1" $(needs "$1")
    lib=$1 requires=$2 private=$3
    shift 3
    echo "prefix=${up:+\${pcfiledir\}/$up}"
    [ -n "$up" ] || echo "prefix=$PREFIX"
    echo "libdir=$(below "$LIBDIR" '${prefix}')"
    echo "includedir=$(below "$INCLUDEDIR" '${prefix}')"
    echo
    echo "Name: $lib"
    echo 'Description: line-shaped haptic tools against triangle meshes'
    echo "Version: $VERSION"
    echo 'Cflags: -I${includedir}'
    [ "$requires" = - ] || echo "Requires: $(echo "$requires" | tr , ' ')"
    [ "$private" = - ] || echo "Requires.private: $(echo "$private" | sed 's/^,//; s/,/ /g')"
    echo "Libs: -L\${libdir} -l${lib#lib}"
    echo "Libs.private: $*"
}

put 755 "$BINDIR" "$build/dynpoint"
put 644 "$INCLUDEDIR" include/dynpoint.h "$build/include/dynpoint_cdef.h"
put 644 "$INCLUDEDIR/dynpoint" include/dynpoint/*.h
for lib in $LIBRARIES; do
    put 644 "$LIBDIR" "$build/$lib.a"
    put 755 "$LIBDIR" "$build/$lib.so.$SOVERSION"
    ln -sf "$lib.so.$SOVERSION" "$DESTDIR$LIBDIR/$lib.so"
    echo "$LIBDIR/$lib.so" >>"$list"
    package "$lib" | written "$PKGCONFIGDIR" "$lib.pc"
done

cmake=$LIBDIR/cmake/dynpoint
up=$(up_from "$cmake")
where=${up:+\${CMAKE_CURRENT_LIST_DIR\}/$up}
sed "s|@PREFIX@|${where:-$PREFIX}|; s|@LIBDIR@|$(below "$LIBDIR" '${dynpoint_prefix}')|
     s|@INCLUDEDIR@|$(below "$INCLUDEDIR" '${dynpoint_prefix}')|; s|@SOVERSION@|$SOVERSION|
     s|@COMPONENTS@|$(for lib in $LIBRARIES; do echo "${lib#libdynpoint}" | sed 's/^_//; s/^$/core/'; done | tr '\n' ' ' | sed 's/ $//')|
     s|@JANSSON@|$JANSSON|; s|@CCD@|$CCD|" tools/packaging/cmake/dynpointConfig.cmake.in | written "$cmake" dynpointConfig.cmake
sed "s|@VERSION@|$VERSION|" tools/packaging/cmake/dynpointConfigVersion.cmake.in | written "$cmake" dynpointConfigVersion.cmake

put 644 "$DATADIR/doc/dynpoint" LICENSE README.md "$build/summary.txt"
(cd docs && find . -type f ! -path '*/pictures/*' ! -path '*/charts/*') | sed 's|^\./||' | LC_ALL=C sort >"$list.docs"
while IFS= read -r page; do
    case $page in */*) folder=/${page%/*} ;; *) folder= ;; esac
    put 644 "$DATADIR/doc/dynpoint/docs$folder" "docs/$page"
done <"$list.docs"
rm -f "$list.docs"
[ ! -e "$build/man/dynpoint.1" ] || put 644 "$MANDIR/man1" "$build"/man/*.1
put 644 "$DATADIR/bash-completion/completions" tools/packaging/complete/dynpoint.bash
mv "$DESTDIR$DATADIR/bash-completion/completions/dynpoint.bash" "$DESTDIR$DATADIR/bash-completion/completions/dynpoint"
sed -i 's|/completions/dynpoint.bash$|/completions/dynpoint|' "$list"
put 644 "$DATADIR/zsh/site-functions" tools/packaging/complete/_dynpoint
put 644 "$DATADIR/fish/vendor_completions.d" tools/packaging/complete/dynpoint.fish
LC_ALL=C sort "$list" | written "$DATADIR/dynpoint" manifest.new
mv "$DESTDIR$DATADIR/dynpoint/manifest.new" "$DESTDIR$manifest"
echo "installed $(wc -l <"$list") files below $PREFIX; make uninstall removes them"
