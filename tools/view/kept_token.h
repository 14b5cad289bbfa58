/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A token that outlives the program, for a port that the user chose: when the next run serves there, a page that is open
 * finds it again by itself. It lies in a file of the user's runtime folder (XDG_RUNTIME_DIR), which only this user may
 * read. Without such a folder, or if the file is not the user's alone, nothing is kept.
 */
#ifndef DPT_TOOLS_KEPT_TOKEN_H
#define DPT_TOOLS_KEPT_TOKEN_H

#include <stdint.h>

#include "view/view_token.h"

/* The token of this port: the kept one, or else a new one, which is kept from now on. Returns 0 if none is kept. */
int view_token_keep(uint16_t port, struct view_token *token);

#endif
