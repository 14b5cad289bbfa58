#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# A program in Go, for tests/languages/check.sh: sh tests/languages/go/run.sh BUILD ROOM ROUNDS.
#
# cgo over the headers of the single files, and the libraries that make has built. With RELEASE=yes cgo compiles the
# single files too, with ASan and UBSan under Go's own instrumentation, and misuse runs on that.
set -u
build=$(cd "$1" && pwd) room=$2 rounds=$3
status=0

said() { # STATUS WHAT
    if [ "$1" -eq 0 ]; then echo "ok $2"; else echo "FAIL $2" && status=1; fi
}
for tool in go python3; do
    command -v $tool >/dev/null 2>&1 || { echo "skip the program and misuse: no $tool" && exit 1; }
done
case $(go env GOVERSION) in
"" | go1.[0-9] | go1.[0-9].* | go1.1[0-9]* | go1.2[01]*)
    echo "skip the program and misuse: $(go version), not 1.22"
    exit 1
    ;;
esac
flock "$build/wasm.lock" make -s amalgamation B="$1" >&2
said $? "single files"
. tests/languages/blocks.sh
{
    printf 'package main\n\n// #include "dynpoint.h"\nimport "C"\n\nfunc shown(vertices [][3]float64, '
    echo 'corners [][3]uint32, pose C.dpt_pose, wrench C.dpt_wrench) error {'
    block docs/go.md go 1 && printf '\t_ = body\n\treturn err\n}\n'
} >"$room/shown" || said 1 "docs/go.md has no block"
cp src/bindings/go/world.go tests/languages/go/*.go "$build"/amalgamation/*.h "$room" && cd "$room" || exit 2
printf 'module touch\n\ngo 1.22\n' >go.mod
export GOFLAGS=-mod=mod GOTOOLCHAIN=local GOPROXY=off GO111MODULE=on
[ -n "${GOCACHE:-${HOME:-}}" ] || export GOCACHE="$build/go-cache"

[ -z "$(gofmt -l .)" ] && mv shown shown.go && go vet . >&2
said $? "gofmt and go vet, of the page's block too"
libraries="$build/libdynpoint_compile.a $build/libdynpoint.a"
CGO_LDFLAGS=$libraries go build -o touch . >&2 && touched=$(./touch "$rounds") && echo "touch Go $touched"
said $? "the ten seconds"
# What was freed is not as it was: where glibc is.
MALLOC_PERTURB_=165 CGO_LDFLAGS=$libraries go test -count=1 . >misuse.log 2>&1
said $? "misuse: $(tail -n 1 misuse.log)"
[ $status -eq 0 ] || cat misuse.log >&2
if [ "${RELEASE:-no}" != no ]; then
    cp "$build"/amalgamation/*.c .
    CGO_CFLAGS='-O1 -g -fsanitize=undefined -fno-sanitize-recover=undefined' CGO_LDFLAGS=-fsanitize=undefined \
        ASAN_OPTIONS=detect_leaks=0 go test -count=1 -asan . >sanitized.log 2>&1
    said $? "misuse, with ASan and UBSan: $(tail -n 1 sanitized.log)"
    go build -o whole . >&2 && [ "$(./whole | cut -d' ' -f 1,2)" = "$(echo "$touched" | cut -d' ' -f 1,2)" ]
    said $? "cgo compiles the single files, and the wrenches are the same"
    [ $status -eq 0 ] || cat sanitized.log >&2
fi
exit $status
