/* SPDX-License-Identifier: BSD-3-Clause */
#define _POSIX_C_SOURCE 200809L
#include "view/kept_token.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { PATH_BYTES = 300 };

/* Of this user, and closed to others. */
static int is_own(const struct stat *status, mode_t kind)
{
    return (status->st_mode & S_IFMT) == kind && status->st_uid == geteuid() && (status->st_mode & 077) == 0;
}

static int is_token(const struct view_token *token, ssize_t size)
{
    return size == VIEW_TOKEN_DIGITS && strspn(token->digits, "0123456789abcdef") == VIEW_TOKEN_DIGITS;
}

static int read_or_make(int file, struct view_token *token)
{
    struct stat status;
    if (fstat(file, &status) != 0 || !is_own(&status, S_IFREG))
        return 0;
    memset(token, 0, sizeof *token);
    if (is_token(token, read(file, token->digits, VIEW_TOKEN_DIGITS)))
        return 1;
    return view_token_make(token) == 0 && ftruncate(file, 0) == 0 &&
           pwrite(file, token->digits, VIEW_TOKEN_DIGITS, 0) == VIEW_TOKEN_DIGITS;
}

int view_token_keep(uint16_t port, struct view_token *token)
{
    const char *folder = getenv("XDG_RUNTIME_DIR");
    struct stat status;
    char path[PATH_BYTES];
    if (!folder || folder[0] != '/' || strlen(folder) > PATH_BYTES - 40 || stat(folder, &status) != 0 ||
        !is_own(&status, S_IFDIR))
        return 0;
    snprintf(path, sizeof path, "%s/dynpoint-view-%u", folder, (unsigned)port);
    const int file = open(path, O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK, 0600);
    const int is_kept = file >= 0 && read_or_make(file, token);
    if (file >= 0)
        close(file);
    return is_kept;
}
