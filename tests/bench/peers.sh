# SPDX-License-Identifier: BSD-3-Clause
# To be read in by a script that has set `dir`: builds the peers into it and sets `ready` to the names of those that are
# there. PEERS names the peers to build ("fcl cgal"), all by default; one that cannot be built is named and left out, and
# is never a failure.

# Each peer: name, package, source, and what its rows are called.
peers='fcl libfcl-dev peer_fcl.cpp FCL OBBRSS
coal coal(PyPI) peer_coal.cpp Coal OBBRSS
cgal libcgal-dev peer_cgal.cpp CGAL AABB_tree
embree libembree-dev peer_embree.cpp Embree points
bullet libbullet-dev peer_bullet.cpp Bullet swept-box
libccd libccd-dev peer_libccd.cpp libccd MPR
zbuffer libegl-dev,libgles-dev peer_zbuffer.cpp z-buffer Mesa'

has_header() { echo "#include <$1>" | g++ -std=c++17 -E -x c++ - >/dev/null 2>&1; }

# Sets cflags and libs for a peer, or fails where its package is not here.
flags_of() {
    cflags= libs=
    case $1 in
    fcl)
        pkg-config --exists fcl 2>/dev/null || return 1
        cflags=$(pkg-config --cflags fcl) libs=$(pkg-config --libs fcl)
        ;;
    coal) # a wheel in a virtual environment below build/, as other packages of PyPI
        for prefix in "$PWD"/build/venv/lib/python3*/site-packages/cmeel.prefix; do
            [ -f "$prefix/lib/pkgconfig/coal.pc" ] || return 1
            cflags=$(PKG_CONFIG_PATH=$prefix/lib/pkgconfig pkg-config --cflags coal 2>/dev/null) || return 1
            libs="-L$prefix/lib -lcoal -Wl,-rpath,$prefix/lib"
        done
        cflags="$cflags -DNDEBUG"
        ;;
    cgal)
        has_header CGAL/AABB_tree.h || return 1
        cflags='-DNDEBUG -DCGAL_DISABLE_GMP'
        ;;
    embree)
        if has_header embree4/rtcore.h; then libs=-lembree4
        elif has_header embree3/rtcore.h; then libs=-lembree3
        else return 1; fi
        ;;
    bullet) # the build in double where there is one
        for package in bullet-float64 bullet; do
            pkg-config --exists $package 2>/dev/null || continue
            cflags="$(pkg-config --cflags $package) -DNDEBUG"
            libs=$(pkg-config --libs $package)
            return 0
        done
        return 1
        ;;
    libccd)
        pkg-config --exists ccd 2>/dev/null || return 1
        cflags=$(pkg-config --cflags ccd) libs=$(pkg-config --libs ccd)
        ;;
    zbuffer)
        pkg-config --exists egl glesv2 2>/dev/null || return 1
        cflags=$(pkg-config --cflags egl glesv2) libs=$(pkg-config --libs egl glesv2)
        ;;
    esac
}

# The judge of crossings as $dir/crossings; fails where there is no g++. $build has the tests' oracle.
build_judge() {
    [ -x "$dir/crossings" ] && [ -z "$(find tests/bench/crossings.cpp tests/bench/*.h "$build/tests/oracle/brute.o" -newer "$dir/crossings")" ] &&
        return 0
    command -v g++ >/dev/null 2>&1 &&
        g++ -O2 -std=c++17 tests/bench/crossings.cpp "$build/tests/oracle/brute.o" -lm -o "$dir/crossings"
}

ready= out=
while read -r peer package source method kernel; do
    case " ${PEERS-all} " in
    *" all "* | *" $peer "*) ;;
    *) continue ;;
    esac
    program=$dir/peer_$peer
    if ! command -v g++ >/dev/null 2>&1 || ! command -v pkg-config >/dev/null 2>&1; then
        out="$out, $method (g++ or pkg-config is not here)"
    elif ! flags_of "$peer"; then
        out="$out, $method ($package is not here)"
    elif [ -x "$program" ] && [ -z "$(find "tests/bench/$source" tests/bench/*.h -newer "$program")" ]; then
        ready="$ready $peer"
    elif g++ -O3 $cflags -std=c++17 "tests/bench/$source" -o "$program" $libs 2>"$program.log"; then
        ready="$ready $peer"
    else
        rm -f "$program"
        out="$out, $method ($package is here, but the peer does not build: $program.log)"
    fi
done <<END
$peers
END
[ -z "$out" ] || echo "left out: ${out#, }"
