/* SPDX-License-Identifier: BSD-3-Clause */
/* view_server.h, where the system has libwebsockets. Else `python3 -m dynpoint view` serves by Python's own server. */
#include "view/server/view_server.h"

#include <string.h>

#include "bindings/python/parts/part.h"

static dpy_part view = { .file = "libdynpoint_view.so", .needs = "libwebsockets", .packages = "libwebsockets17" };

static int find(const char *symbol, void *function, size_t size)
{
    void *const found = dpy_part_find(&view, symbol);
    memcpy(function, &found, size);
    return found != NULL;
}

/* The others are called with a server that it made. */
const char *view_server_open(const struct view_server_def *def, struct view_server **server)
{
    const char *(*call)(const struct view_server_def *, struct view_server **);
    *server = NULL;
    return find("view_server_open", &call, sizeof call) ? call(def, server) : view.fault;
}

void view_server_url(const struct view_server *server, char url[VIEW_URL_BYTES])
{
    void (*call)(const struct view_server *, char[VIEW_URL_BYTES]);
    if (find("view_server_url", &call, sizeof call))
        call(server, url);
}

void view_server_warning(const struct view_server *server, char text[VIEW_WARNING_BYTES])
{
    void (*call)(const struct view_server *, char[VIEW_WARNING_BYTES]);
    if (find("view_server_warning", &call, sizeof call))
        call(server, text);
}

void view_server_counts(const struct view_server *server, struct view_server_counts *counts)
{
    void (*call)(const struct view_server *, struct view_server_counts *);
    if (find("view_server_counts", &call, sizeof call))
        call(server, counts);
}

void view_server_end_message(struct view_server *server, const char *text)
{
    void (*call)(struct view_server *, const char *);
    if (find("view_server_end_message", &call, sizeof call))
        call(server, text);
}

void view_server_close(struct view_server *server)
{
    void (*call)(struct view_server *);
    if (find("view_server_close", &call, sizeof call))
        call(server);
}
