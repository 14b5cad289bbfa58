/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * By which names a server may be called. A page of another site can make its own name lead to this machine; a browser
 * still sends that name in Host and Origin, and here it is refused.
 */
#ifndef DPT_TOOLS_VIEW_HOST_H
#define DPT_TOOLS_VIEW_HOST_H

#include <stddef.h>
#include <stdint.h>

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
