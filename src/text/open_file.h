/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Files by their names in UTF-8, of any length that the system takes. Windows needs names of another kind for both; else
 * this is fopen.
 */
#ifndef DPT_OPEN_FILE_H
#define DPT_OPEN_FILE_H

#include <stdio.h>

/* As fopen, which errno is of. Streams that are opened by "rb", "wb" and "ab" carry bytes as they are. */
FILE *open_file(const char *path, const char *mode);

/* What ends a folder's name in a path. */
#ifdef _WIN32
#define PATH_SEPARATORS "/\\"
#else
#define PATH_SEPARATORS "/"
#endif

#ifdef _WIN32
#include <wchar.h>
/* The name as Windows wants it, whole and long where it must be; free it. NULL, and errno, if it is none. */
wchar_t *wide_path(const char *path);
#endif

#endif
