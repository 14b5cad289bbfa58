#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Which packages are asked for by which command: `sh tests/deps_test.sh BUILD`. In a copy of the scripts, with a dpkg and an
# apt-get that are made up: nothing is installed or downloaded.
set -u
here=$(cd "$(dirname "$0")/.." && pwd) || exit 2
. "$here/tests/lib/verdict.sh"
scratch=$1/deps_test
rm -rf "$scratch"
mkdir -p "$scratch/bin" "$scratch/rest" "$scratch/tree/tools/view/page" "$scratch/tree/tests/lib" "$scratch/tree/tests/js" "$scratch/tree/tests/vm" "$scratch/tree/tests/oracle" "$scratch/tree/tests/python"
scratch=$(cd "$scratch" && pwd) || exit 2
(cd "$here" && cp Makefile "$scratch/tree" && cp tests/deps.sh tests/run.sh tests/programs.txt "$scratch/tree/tests" &&
    cp tests/lib/venv.sh tests/lib/jobs.sh "$scratch/tree/tests/lib" && cp tests/vm/kernel.sh "$scratch/tree/tests/vm" &&
    cp tests/python/foreign_root.sh "$scratch/tree/tests/python")
for file in package.json package-lock.json .npmrc; do
    for folder in tools/view/page tests/js; do : >"$scratch/tree/$folder/$file"; done
done
export INSTALLED="$scratch/installed" CALLS="$scratch/calls" USER_ID=0
unset DEPS MAKEFLAGS MAKELEVEL 2>/dev/null

# tool NAME LINE...: a made-up one
tool() {
    name=$1
    shift
    printf '%s\n' '#!/bin/sh' "$@" >"$scratch/bin/$name"
    chmod 755 "$scratch/bin/$name"
}
tool dpkg 'grep -qx "$2" "$INSTALLED" && echo "Status: install ok installed"'
# Installs what it is asked for, unless it is only asked what that would be.
tool apt-get 'echo "apt-get $*" >>"$CALLS"' 'case "$*" in *--simulate* | *--assume-no* | update* | download*) exit 0 ;; esac' \
    'for word; do case $word in -* | install) ;; *) echo "$word" >>"$INSTALLED" ;; esac; done'
tool apt-cache 'echo "apt-cache $*" >>"$CALLS"'
tool id 'echo "$USER_ID"'
tool python3 'echo "python3 $*" >>"$CALLS"; exit 1'
tool cc 'exit 1'
# This machine's other commands, but for node and npm; of those that are there twice the first.
echo "$PATH" | tr ':' '\n' | while read -r folder; do ln -s "$folder"/* "$scratch/rest" 2>/dev/null; done
rm -f "$scratch/rest/node" "$scratch/rest/npm"
MAKE=$(command -v make)
tool make 'case $1 in deps) exec "$MAKE" "$@" ;; *) exit 1 ;; esac'
export MAKE

# asks COMMAND...: in the copy, where no package is installed; $status, what it says in $scratch/says, calls in $CALLS
asks() {
    : >"$CALLS"
    : >"$INSTALLED"
    (cd "$scratch/tree" && PATH="$scratch/bin:$scratch/rest" "$@") >"$scratch/says" 2>&1 </dev/null
    status=$?
}
installed() { sort "$INSTALLED" | tr '\n' ' '; }
untouched() { ! grep -qE '^python3 -m venv|^apt-get (download|update)|^apt-get install.* -y' "$CALLS" && [ ! -s "$INSTALLED" ]; }

light='g++ libccd-dev libexpat1-dev libgmp-dev libjansson-dev liburdfdom-dev pkg-config python3 python3-cffi python3-pycparser '
firmware='gcc-arm-none-eabi libnewlib-arm-none-eabi qemu-system-arm '
asks sh tests/run.sh check
check "make check installs the light group: $(installed)" test "$(installed)" = "$light"
check "and prints it" grep -q "^missing: $light" "$scratch/says"
check "and fetches nothing from elsewhere" test "$(grep -cE '^python3 -m venv|download' "$CALLS")" -eq 0
sh "$here/tests/deps.sh" | awk '/^[a-z]/ { group = $1 } group !~ /^(newton|lerobot|docs|wheels|platforms)$/' | sed -n 's/^            \([a-z]\)/\1/p' |
    grep -v '^missing here' | tr ' ' '\n' | sort -u >"$scratch/all"
DEPS=all
export DEPS
asks sh tests/run.sh check
check "with DEPS=all it installs every package" test "$(installed)" = "$(tr '\n' ' ' <"$scratch/all")"
check "first what its builds look for" grep -q '^packages of light view: ' "$scratch/says"
check "and fetches all" test "$(grep -c '^python3 -m venv' "$CALLS")" -eq 6
DEPS=no
export DEPS
asks sh tests/run.sh check
check "with DEPS=no it installs nothing" untouched
check "and says so" grep -q '^DEPS=no: nothing is installed' "$scratch/says"
unset DEPS
USER_ID=1000
asks sh tests/run.sh check
check "without root neither" untouched
check "and says how" grep -q "sudo make deps light" "$scratch/says"
USER_ID=0
asks sh tests/run.sh test
check "make test asks for nothing" test "$(grep -c '^apt' "$CALLS")" -eq 0 -a ! -s "$INSTALLED"

asks make deps
check "make deps installs nothing" untouched
for group in light peers kinematics soft cross firmware vm motors view python newton wasm languages; do
    check "it lists $group with what it downloads" grep -qE "^$group +[0-9]+ MB.* to download: " "$scratch/says"
done
asks make deps firmware
check "make deps firmware installs firmware: $(installed)" test "$(installed)" = "$firmware"
check "without what is only recommended" grep -q 'apt-get install --no-install-recommends -y' "$CALLS"
asks make deps firmware light
check "two groups: $(installed)" test "$(installed)" = "$(echo "$firmware$light" | tr ' ' '\n' | sort | tr '\n' ' ' | sed 's/^ //')"
asks make deps all
check "make deps all installs every package that make check uses" test "$(installed)" = "$(tr '\n' ' ' <"$scratch/all")"
check "and tries PyPI" test "$(grep -c '^python3 -m venv' "$CALLS")" -eq 6
check "and a kernel" grep -q '^apt-cache depends linux-image-amd64' "$CALLS"
check "what could not be fetched gives status 2" test $status -eq 2
view='chromium libwebsockets-dev nodejs npm pkg-config webp '
asks make deps view
check "make deps view installs view: $(installed)" test "$(installed)" = "$view"
check "without npm there is no three.js" grep -q 'no three.js' "$scratch/says"
check "that gives status 2" test $status -eq 2
tool node 'exit 1'
tool npm 'echo "npm $* in ${PWD##*/}" >>"$CALLS"; mkdir -p node_modules/three; : >node_modules/three/package.json'
asks make deps view
check "node and npm that are there are not asked for: $(installed)" test "$(installed)" = 'chromium libwebsockets-dev pkg-config webp '
check "npm gets what is locked" grep -q '^npm ci .*in view$' "$CALLS"
check "into build/view" test $status -eq 0 -a -e "$scratch/tree/build/view/node_modules/three/package.json"
asks make deps view
check "not twice" test "$(grep -c '^npm' "$CALLS")" -eq 0 -a $status -eq 0
echo '{}' >"$scratch/tree/tools/view/page/package-lock.json"
asks make deps view
check "but when another is locked" test "$(grep -c '^npm ci' "$CALLS")" -eq 1
rm "$scratch/bin/node" "$scratch/bin/npm"
asks make deps nonesuch
check "an unknown group is an error" test $status -eq 2
check "which names those there are" grep -q 'light peers kinematics soft cross firmware vm motors view build counts abi python newton lerobot wheels platforms docs wasm languages or all' "$scratch/says"
check "and installs nothing" untouched
(cd "$scratch/tree" && PATH="$scratch/bin:$scratch/rest" sh tests/vm/kernel.sh) >"$scratch/says" 2>&1
check "a test alone fetches no kernel" test $? -eq 77 -a ! -s "$INSTALLED"
check "and says what does" grep -q 'make deps vm' "$scratch/says"
check "the project's own check asks for all" grep -q '^DEPS=all .*make check' "$here/.ci/run"
finish
