# SPDX-License-Identifier: BSD-3-Clause
# JavaScript: the scene with the package of npm, as it is installed (check.sh beside this folder calls it).
for tool in clang wasm-ld node npm; do
    if ! command -v $tool >/dev/null; then
        echo "skip no $tool (make deps wasm)"
        exit 0
    fi
done
case $(node --version) in
v[0-9].* | v1[0-7].*)
    echo "skip node $(node --version), not 18 (make deps wasm)"
    exit 0
    ;;
esac
if ! echo '#include <stdlib.h>' | clang --target=wasm32-wasi -E -x c - >/dev/null 2>&1; then
    echo "skip no C library for WebAssembly (make deps wasm)"
    exit 0
fi
if ! python3 -c 'import pycparser' 2>/dev/null; then
    echo "skip no pycparser (make deps light)"
    exit 0
fi
flock "$1/wasm.lock" make -s npm >&2 && sh tests/js/install.sh "$1" "$2" &&
    cp tests/languages/js/touch.mjs "$2" || exit 1
echo "touch javascript $(node "$2/touch.mjs" "$3")"
