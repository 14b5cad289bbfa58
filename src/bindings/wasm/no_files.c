/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The C library that the compiler is linked with asks a host for files. The compiler opens none here, and a module that
 * asks its host for nothing runs anywhere: these stand in its place, and fail.
 */
#include <wasi/api.h>

__wasi_errno_t __wrap___wasi_fd_close(__wasi_fd_t file)
{
    (void)file;
    return __WASI_ERRNO_BADF;
}

__wasi_errno_t __wrap___wasi_fd_seek(__wasi_fd_t file, __wasi_filedelta_t by, __wasi_whence_t from,
                                     __wasi_filesize_t *at)
{
    (void)file;
    (void)by;
    (void)from;
    (void)at;
    return __WASI_ERRNO_BADF;
}

__wasi_errno_t __wrap___wasi_fd_write(__wasi_fd_t file, const __wasi_ciovec_t *parts, size_t count,
                                      __wasi_size_t *written)
{
    (void)file;
    (void)parts;
    (void)count;
    (void)written;
    return __WASI_ERRNO_BADF;
}
