#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The kernel that tests/vm/run.sh boots: Debian's, with the modules that it needs, unpacked below build/vm and never
# installed. Once, by `sh tests/vm/kernel.sh fetch` (make deps vm): build/vm/vmlinux (or vmlinuz), build/vm/tree; packed into
# build/vm/initramfs again when init changes. Without "fetch" nothing is downloaded. Where there is none it says why in one
# line, with status 77.
set -u
cd "$(dirname "$0")/../.." || exit 2
cache=build/vm

skip() {
    echo "skip a real kernel: $1"
    exit 77
}

fetch() {
    [ "$(uname -m)" = x86_64 ] || skip "this machine is $(uname -m), not x86_64"
    for tool in apt-get apt-cache dpkg-deb; do
        command -v $tool >/dev/null 2>&1 || skip "no $tool to fetch one with"
    done
    # The metapackage names the release of the day.
    image=$(apt-cache depends linux-image-amd64 2>/dev/null | sed -n 's/^ *Depends: //p' | head -n 1)
    [ -n "$image" ] || skip "apt-get knows no linux-image-amd64 (apt-get update?)"
    new=$PWD/$cache/new.$$
    trap 'rm -rf "$new"' EXIT
    trap 'exit 143' INT TERM HUP
    mkdir -p "$new/tree/bin" "$new/deb" && cd "$new" || exit 2
    (cd deb && timeout 600 apt-get download -qq "$image" busybox-static) >log 2>&1 || skip "$image cannot be downloaded"
    dpkg-deb --fsys-tarfile deb/busybox-static_*.deb | tar -x -O -f - ./bin/busybox >tree/bin/busybox &&
        chmod 755 tree/bin/busybox && ln -s busybox tree/bin/sh || skip "no busybox in busybox-static"
    # Trees that another release does not have are no error; a module that is missing is one, below.
    dpkg-deb --fsys-tarfile deb/linux-image-*.deb | tar -x -C tree -f - --wildcards './boot/vmlinuz*' './lib/modules/*/modules.*' \
        './lib/modules/*/kernel/net/can/*' './lib/modules/*/kernel/drivers/net/can/*' './lib/modules/*/kernel/drivers/virtio/*' \
        './lib/modules/*/kernel/net/9p/*' './lib/modules/*/kernel/fs/9p/*' './lib/modules/*/kernel/fs/netfs/*' \
        './lib/modules/*/kernel/fs/fscache/*' './lib/modules/*/kernel/fs/overlayfs/*' 2>/dev/null
    mv tree/boot/vmlinuz* vmlinuz 2>/dev/null || skip "no kernel in $image"
    rm -rf tree/boot
    find tree/lib -name '*.ko.xz' -exec xz -d {} +
    for module in can-raw vcan slcan 9pnet_virtio overlay; do
        [ -n "$(find tree/lib -name $module.ko)" ] || skip "no module $module in $image"
    done
    tree/bin/busybox depmod -b tree "$(ls tree/lib/modules)" || skip "depmod fails"
    plain
    rm -rf deb log
    cd ../../.. && rm -rf "$cache/tree" && mv "$new"/vmlinu* "$new/tree" "$cache/" || exit 2
    echo "$image" >"$cache/kernel"
}

# The ELF file in the compressed kernel (x86 boot protocol 2.08: payload_offset and payload_length): QEMU enters it at once
# (PVH), which saves seconds of emulated decompression. Without it the compressed one boots too.
plain() {
    sectors=$(od -An -tu1 -j 497 -N 1 vmlinuz)
    offset=$(od -An -tu4 -j 584 -N 4 vmlinuz) length=$(od -An -tu4 -j 588 -N 4 vmlinuz)
    tail -c +$(((sectors + 1) * 512 + offset + 1)) vmlinuz | head -c $((length)) | xz -d -c --single-stream >vmlinux 2>/dev/null &&
        [ "$(head -c 4 vmlinux | tail -c 3)" = ELF ] || rm -f vmlinux
}

mkdir -p "$cache"
# One at a time: the others find what it made.
exec 9>"$cache/lock"
! command -v flock >/dev/null 2>&1 || flock 9
if [ ! -f "$cache/kernel" ] || [ ! -d "$cache/tree" ]; then
    [ "${1:-}" = fetch ] || skip "none is here: make deps vm"
    (fetch) || exit
fi
if [ ! "$cache/initramfs" -nt tests/vm/init ] || [ ! "$cache/initramfs" -nt "$cache/kernel" ]; then
    tree=$PWD/$cache/tree
    cp tests/vm/init "$tree/init" && chmod 755 "$tree/init" || exit 2
    (cd "$tree" && find . | bin/busybox cpio -o -H newc >"../initramfs.$$" 2>/dev/null) || exit 2
    mv "$cache/initramfs.$$" "$cache/initramfs"
fi
