/* SPDX-License-Identifier: BSD-3-Clause */
#include "text/open_file.h"

#ifdef _WIN32
#include <errno.h>
#include <stdlib.h>
#include <windows.h>

/* Where shorter names end. A folder's must leave room for a file's of the old kind, 8.3. */
enum { SHORT_PATH = MAX_PATH - 13 };

static wchar_t *to_wide(const char *text)
{
    const int count = MultiByteToWideChar(CP_UTF8, MB_ERR_INVALID_CHARS, text, -1, NULL, 0);
    wchar_t *wide = count > 0 ? malloc((size_t)count * sizeof *wide) : NULL;
    if (wide)
        MultiByteToWideChar(CP_UTF8, 0, text, -1, wide, count);
    else
        errno = count > 0 ? ENOMEM : ENOENT;
    return wide;
}

/* Where it is too long, C:\... becomes \\?\C:\..., and \\server\share\... becomes \\?\UNC\server\share\... */
static wchar_t *to_long(wchar_t *path)
{
    static const wchar_t local[] = L"\\\\?\\", remote[] = L"\\\\?\\UNC\\";
    const DWORD room = GetFullPathNameW(path, 0, NULL, NULL);
    if (room < SHORT_PATH)
        return path;
    wchar_t *longer = room ? malloc(sizeof remote + room * sizeof *longer) : NULL;
    if (longer) {
        const size_t lead = 7; /* as much as the longer of the two needs */
        wchar_t *whole = longer + lead;
        GetFullPathNameW(path, room, whole, NULL);
        const int is_remote = whole[0] == L'\\' && whole[1] == L'\\';
        const wchar_t *prefix = is_remote ? remote : local;
        const wchar_t *rest = is_remote ? whole + 2 : whole;
        const size_t size = wcslen(prefix);
        wmemmove(longer + size, rest, wcslen(rest) + 1);
        wmemcpy(longer, prefix, size);
    } else {
        errno = ENOMEM;
    }
    free(path);
    return longer;
}

wchar_t *wide_path(const char *path)
{
    wchar_t *wide = to_wide(path);
    /* What begins so is already as long as it may be, or a device. */
    return !wide || wcsncmp(wide, L"\\\\?\\", 4) == 0 ? wide : to_long(wide);
}

FILE *open_file(const char *path, const char *mode)
{
    wchar_t *wide = wide_path(path), *wide_mode = wide ? to_wide(mode) : NULL;
    FILE *file = wide_mode ? _wfopen(wide, wide_mode) : NULL;
    free(wide);
    free(wide_mode);
    return file;
}

#else

FILE *open_file(const char *path, const char *mode)
{
    return fopen(path, mode);
}

#endif
