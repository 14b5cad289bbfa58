/* SPDX-License-Identifier: BSD-3-Clause */
#include "view/view_token.h"

#include <errno.h>
#include <sys/random.h>

int view_token_make(struct view_token *token)
{
    unsigned char random[VIEW_TOKEN_DIGITS / 2];
    ssize_t got;
    do
        got = getrandom(random, sizeof random, 0);
    while (got < 0 && errno == EINTR);
    if (got != (ssize_t)sizeof random)
        return -1;
    for (size_t i = 0; i < VIEW_TOKEN_DIGITS; i++)
        token->digits[i] = "0123456789abcdef"[random[i / 2] >> (i % 2 ? 0 : 4) & 15];
    token->digits[VIEW_TOKEN_DIGITS] = '\0';
    return 0;
}

int view_token_is(const struct view_token *token, const void *bytes, size_t size)
{
    const volatile unsigned char *heard = bytes;
    unsigned difference = 0;
    if (size != VIEW_TOKEN_DIGITS)
        return 0;
    for (size_t i = 0; i < VIEW_TOKEN_DIGITS; i++)
        difference |= (unsigned)heard[i] ^ (unsigned char)token->digits[i];
    return difference == 0;
}
