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
command -v go >/dev/null 2>&1 || { echo "skip the program and misuse: no go" && exit 1; }
case $(go env GOVERSION) in
go1.[0-9] | go1.[0-9].* | go1.1[0-9]* | go1.2[01]*)
    echo "skip the program and misuse: $(go env GOVERSION), not 1.22"
    exit 1
    ;;
esac
make -s amalgamation B="$1" >&2
said $? "single files"
cp src/bindings/go/world.go tests/languages/go/*.go "$build"/amalgamation/*.h "$room" && cd "$room" || exit 2
printf 'module touch\n\ngo 1.22\n' >go.mod
export GOFLAGS=-mod=mod GOTOOLCHAIN=local GO111MODULE=on
[ -n "${GOCACHE:-${HOME:-}}" ] || export GOCACHE="$build/go-cache"

[ -z "$(gofmt -l .)" ] && go vet . >&2
said $? "gofmt and go vet"
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
