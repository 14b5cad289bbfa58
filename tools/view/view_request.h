/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What a viewer's page may say to the server, once its token was accepted. A pure function of bytes that anyone may have
 * sent.
 *
 *     ready           the scene was read, frames may come
 *     drawn           one more frame was drawn
 *     hand X Y Z      where the simulated hand is to go: decimal numbers, m, in the scene's frame
 *
 * Words and numbers are separated by one space. Nothing comes before, after or between.
 */
#ifndef DPT_TOOLS_VIEW_REQUEST_H
#define DPT_TOOLS_VIEW_REQUEST_H

#include <stddef.h>
#include <stdint.h>

/* The longest message that the server takes, bytes. */
#define VIEW_REQUEST_BYTES_MAX 4096u
/* The largest coordinate of a hand, m. */
#define VIEW_REQUEST_HAND_MAX 1e6

enum view_request_kind { VIEW_REQUEST_UNKNOWN, VIEW_REQUEST_READY, VIEW_REQUEST_DRAWN, VIEW_REQUEST_HAND };

struct view_request {
    enum view_request_kind kind;
    double position[3]; /* of a hand: finite, within VIEW_REQUEST_HAND_MAX; else 0 */
};

/* `text` needs no zero at its end. Returns the kind. */
enum view_request_kind view_request_parse(const char *text, size_t size, struct view_request *request);

/*
 * The secret that lets a page see a run: 128 random bits of the kernel's, as 32 hexadecimal digits. It stands in the
 * fragment of the page's address, which browsers send to nobody; it belongs in no log and on no command line.
 */

#define VIEW_TOKEN_DIGITS 32u

struct view_token {
    char digits[VIEW_TOKEN_DIGITS + 1];
};

/* Returns 0, or -1 if the kernel gives no random bits. */
int view_token_make(struct view_token *token);

/* Whether `size` bytes are the token. How long the answer takes depends on the size alone. */
int view_token_is(const struct view_token *token, const void *bytes, size_t size);

/*
 * A token that outlives the program, for a port that the user chose: when the next run serves there, a page that is open
 * finds it again by itself. It lies in a file of the user's runtime folder (XDG_RUNTIME_DIR), which only this user may
 * read. Without such a folder, or if the file is not the user's alone, nothing is kept.
 */

/* The token of this port: the kept one, or else a new one, which is kept from now on. Returns 0 if none is kept. */
int view_token_keep(uint16_t port, struct view_token *token);

/*
 * By which names a server may be called. A page of another site can make its own name lead to this machine; a browser
 * still sends that name in Host and Origin, and here it is refused.
 */

struct view_host {
    const char *address; /* that was given, in numbers; NULL: this machine alone */
    uint16_t port;
};

enum view_address { VIEW_ADDRESS_INVALID, VIEW_ADDRESS_4, VIEW_ADDRESS_6 };

/* Of a text in numbers: 192.0.2.1, 2001:db8::1. Names are invalid. */
enum view_address view_address_kind(const char *address);

/* Whether the address takes connections of every network (0.0.0.0, ::), or of this machine alone (127.0.0.0/8, ::1). */
int view_address_is_every(const char *address);
int view_address_is_local(const char *address);

/*
 * Whether a request's Host is this server: 127.0.0.1, localhost, [::1] or the address that was given, with the port. An
 * address that stands for all stands for any in numbers: those lead where they say.
 */
int view_host_is_own(const struct view_host *host, const char *text);

/* Whether an Origin is a page of this server at the same Host. */
int view_origin_is_own(const struct view_host *host, const char *host_text, const char *origin);

#endif
