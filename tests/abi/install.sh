#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# What make takes from its caller, and what install and uninstall do: `sh tests/abi/install.sh BUILD`. Flags are looked
# at in the commands that make would run.
set -u
. "$(dirname "$0")/../lib/verdict.sh"
build=$1
scratch=$PWD/$build/tests/install
rm -rf "$scratch"
mkdir -p "$scratch"
quiet=1

# ---- flags ----

# From the environment, as packagers give them: a line a command.
env CPPFLAGS=-DOF_CPP CFLAGS='-O1 -DOF_C' CXXFLAGS='-O1 -DOF_CXX' LDFLAGS=-Wl,-z,of_ld \
    make -n B="$scratch/none" >"$scratch/commands" 2>&1
grep -E ' -c .*\.c -o ' "$scratch/commands" >"$scratch/c"
grep -E ' -c .*\.cc -o ' "$scratch/commands" >"$scratch/cxx"
# Programs and shared libraries; what joins objects is no link.
grep -E ' -shared |-o [^ ]*/dynpoint$' "$scratch/commands" | grep -v -- ' -c ' >"$scratch/links"
[ "$(wc -l <"$scratch/c")" -gt 200 ] && [ "$(wc -l <"$scratch/links")" -ge 5 ]
verdict $? "make compiles $(wc -l <"$scratch/c") files of C, $(wc -l <"$scratch/cxx") of C++, and links $(wc -l <"$scratch/links")"
# all_have FILE FLAG..., none_has FILE FLAG
all_have() {
    of=$1
    shift
    for flag; do
        grep -vF -e " $flag " "$of" >"$scratch/without" && { head -n 1 "$scratch/without" | cut -c 1-200; return 1; }
    done
    return 0
}
all_have "$scratch/c" -DOF_CPP -O1 -DOF_C -ffp-contract=off && ! grep -qF -e -DOF_CXX "$scratch/c"
verdict $? "C has CPPFLAGS and CFLAGS, and what keeps its bits"
# The flags that keep bits come behind the caller's.
! grep -vE -e '-DOF_C .*-ffp-contract=off' "$scratch/c"
verdict $? "in front of what keeps its bits"
if [ -s "$scratch/cxx" ]; then
    all_have "$scratch/cxx" -DOF_CPP -O1 -DOF_CXX -ffp-contract=off && ! grep -qE -e '-DOF_C( |$)' "$scratch/cxx"
    verdict $? "C++ has CPPFLAGS and CXXFLAGS"
else
    skip "CXXFLAGS: this build has no C++"
fi
all_have "$scratch/links" -Wl,-z,of_ld
verdict $? "what is linked has LDFLAGS"
make -n B="$scratch/none" CFLAGS='-O2 -flto' "$scratch/none/libdynpoint.a" | grep -e ' -r ' >"$scratch/joins"
[ "$(grep -c -e '-flto.*-flinker-output=nolto-rel' "$scratch/joins")" -eq 1 ]
verdict $? "with -flto objects are joined by the compiler"

# ---- summary ----

make -s summary B="$scratch/few" DRIVERS='sim can' URDF=no CONVEX=no LDFLAGS=-Wl,--as-needed >"$scratch/summary" &&
    grep -qx 'driver can  *yes' "$scratch/summary" && grep -qx 'driver serial  *no: it is not in DRIVERS' "$scratch/summary" &&
    grep -qE '^robots in URDF +no: (left out by URDF=no|needs urdfdom and a C\+\+ compiler: make deps light)$' "$scratch/summary" &&
    grep -qx 'LDFLAGS  *-Wl,--as-needed' "$scratch/summary"
verdict $? "make summary says what is built in, what is not, and why"
# A compiler that finds no header beside its own: nothing else is there.
printf '#!/bin/sh\ncase "$*" in *"-x c"*) exit 1 ;; esac\nexec cc "$@"\n' >"$scratch/bare_cc"
chmod +x "$scratch/bare_cc"
make -s summary B="$scratch/bare" CC="$scratch/bare_cc" >"$scratch/summary" 2>&1
[ "$(grep -c ' no: needs .*: make deps ' "$scratch/summary")" -ge 3 ]
verdict $? "and of what is missing, which group of make deps brings it"
[ "$(grep -c . "$build/summary.txt")" -ge 15 ]
verdict $? "make writes it"

# ---- install ----

# All sources are newer than what was built, and whatever would be made is noted.
cat >"$scratch/noting_cc" <<END
#!/bin/sh
case "\$*" in *" -o $build/"*) echo "\$*" >>"$scratch/made" ;; esac
exec ${CC:-cc} "\$@"
END
chmod +x "$scratch/noting_cc"
root=$scratch/root prefix=/opt/dp
installs() { # GOAL: with these folders
    make -s "$1" B="$build" CC="$scratch/noting_cc" DESTDIR="$root" PREFIX=$prefix -W include/dynpoint/base.h -W src/world/step.c -W Makefile
}
cksum "$build"/*.a "$build"/*.so.* "$build/dynpoint" >"$scratch/before"
installs install >"$scratch/said" 2>&1
verdict $? "make install: $(tail -n 1 "$scratch/said")"
[ ! -e "$scratch/made" ] && cksum "$build"/*.a "$build"/*.so.* "$build/dynpoint" | cmp -s - "$scratch/before"
verdict $? "it builds nothing, though all sources are newer $(head -n 1 "$scratch/made" 2>/dev/null)"
mkdir "$scratch/empty" && ! make -s install B="$scratch/empty" DESTDIR="$scratch/none_there" >"$scratch/said" 2>&1 &&
    grep -q 'run make first' "$scratch/said" && [ ! -e "$scratch/none_there" ] && [ -z "$(ls "$scratch/empty")" ]
verdict $? "where nothing was built it says so, and puts nothing"
share=$root$prefix/share
cmp -s LICENSE "$share/doc/dynpoint/LICENSE" && cmp -s docs/install.md "$share/doc/dynpoint/docs/install.md" &&
    cmp -s "$build/summary.txt" "$share/doc/dynpoint/summary.txt"
verdict $? "licence, pages and summary"
missing=
for command in dynpoint $("$build/dynpoint" help | sed -n 's/^  \([a-z-][a-z-]*\)  .*/dynpoint-\1/p'); do
    [ -s "$share/man/man1/$command.1" ] || missing="$missing $command"
done
[ -z "$missing" ]
verdict $? "a page of the manual for each command $missing"
if command -v bash >/dev/null 2>&1; then
    PATH=$root$prefix/bin:$PATH bash -c '. "$1"; COMP_LINE="dynpoint sta" COMP_POINT=12; _dynpoint; [ "${COMPREPLY[*]}" = stability ]' \
        bash "$share/bash-completion/completions/dynpoint"
    verdict $? "completion for bash, which completes"
else
    skip "completion for bash: there is none"
fi
[ -s "$share/zsh/site-functions/_dynpoint" ] && [ -s "$share/fish/vendor_completions.d/dynpoint.fish" ]
verdict $? "and for zsh and fish"

# ---- uninstall ----

manifest=$share/dynpoint/manifest
find "$root" -type f -o -type l | sed "s|^$root||" | grep -vx "$prefix/share/dynpoint/manifest" | LC_ALL=C sort | cmp -s - "$manifest"
verdict $? "the manifest lists what was put"
# What others have put beside it, in folders that they share and in dynpoint's own.
for file in bin/dynpoint2 include/other.h include/dynpoint/mine.h lib/libdynpoint_mine.so lib/cmake/other/other.cmake \
    lib/pkgconfig/other.pc share/doc/dynpoint/notes share/man/man1/other.1 share/dynpoint/own share/dynpoint-extra/a; do
    mkdir -p "$(dirname "$root$prefix/$file")" && echo mine >"$root$prefix/$file" && echo "$prefix/$file"
done | LC_ALL=C sort >"$scratch/others"
installs uninstall >"$scratch/said" 2>&1
verdict $? "make uninstall $(cat "$scratch/said")"
find "$root" -type f -o -type l | sed "s|^$root||" | LC_ALL=C sort >"$scratch/left"
cmp -s "$scratch/others" "$scratch/left"
verdict $? "it removes what the manifest lists, and nothing else: $(diff "$scratch/others" "$scratch/left" | head -n 3 | tr '\n' ' ')"
[ -z "$(find "$root" -type d -empty)" ] || [ -z "$(find "$root" -type d -empty | grep -E '/dynpoint(/|$)')" ]
verdict $? "no empty folder of dynpoint's own is left"
! installs uninstall >"$scratch/said" 2>&1 && grep -q 'nothing is installed there' "$scratch/said" &&
    find "$root" -type f | wc -l | grep -qx "$(wc -l <"$scratch/others")"
verdict $? "once more it says that nothing is installed, and removes nothing"
finish
