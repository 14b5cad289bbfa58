/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The secret that lets a page see a run: 128 random bits of the kernel's, as 32 hexadecimal digits. It stands in the
 * fragment of the page's address, which browsers send to nobody; it belongs in no log and on no command line.
 */
#ifndef DPT_TOOLS_VIEW_TOKEN_H
#define DPT_TOOLS_VIEW_TOKEN_H

#include <stddef.h>

#define VIEW_TOKEN_DIGITS 32u

struct view_token {
    char digits[VIEW_TOKEN_DIGITS + 1];
};

/* Returns 0, or -1 if the kernel gives no random bits. */
int view_token_make(struct view_token *token);

/* Whether `size` bytes are the token. How long the answer takes depends on the size alone. */
int view_token_is(const struct view_token *token, const void *bytes, size_t size);

#endif
