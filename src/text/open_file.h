/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Files by their names in UTF-8, of any length that the system takes. Windows needs names of another kind for both; else
 * this is fopen.
 */
#ifndef DPT_OPEN_FILE_H
#define DPT_OPEN_FILE_H

#include <stdio.h>
#include <string.h>

/* As fopen, which errno is of. Streams that are opened by "rb", "wb" and "ab" carry bytes as they are. */
FILE *open_file(const char *path, const char *mode);

/* What ends a folder's name in a path; and whether a path may begin with a drive. */
#ifdef _WIN32
#define PATH_SEPARATORS "/\\"
#define HAS_DRIVES      1
#else
#define PATH_SEPARATORS "/"
#define HAS_DRIVES      0
#endif

/* The length of a drive, as of C:/ and of C:\, without what ends it; 0: the path begins with none. On every system. */
static inline size_t drive_length(const char *path)
{
    const int has_letter = (*path >= 'a' && *path <= 'z') || (*path >= 'A' && *path <= 'Z');
    return has_letter && path[1] == ':' && (path[2] == '/' || path[2] == '\\') ? 2 : 0;
}

/* The length of the first folder of a list. ':' ends it; where there are drives, ';' too, and a drive's ':' does not. */
static inline size_t folder_length(const char *list)
{
    const size_t drive = HAS_DRIVES ? drive_length(list) : 0;
    return drive + strcspn(list + drive, HAS_DRIVES ? ":;" : ":");
}

#ifdef _WIN32
#include <wchar.h>
/* The name as Windows wants it, whole and long where it must be; free it. NULL, and errno, if it is none. */
wchar_t *wide_path(const char *path);
#endif

#endif
