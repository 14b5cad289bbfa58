/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Serves the viewer's page and what it draws, to browsers on this machine, by libwebsockets, in a thread of its own.
 *
 *     struct view_server_def def = { .command = "dynpoint view liver.dpa", .page = page, .page_size = size,
 *                                    .csp = csp, .first = &scene, .first_count = 1, .next = next, .user = &me };
 *     struct view_server *server;
 *     const char *fault = view_server_open(&def, &server);
 *     char url[VIEW_URL_BYTES];
 *     view_server_url(server, url);
 *     ...
 *     view_server_end_message(server, "the run ended");
 *     view_server_close(server);
 *
 * What a client gets: the page at "/", by GET or HEAD, from memory; nothing else is served. A web socket of protocol
 * "dynpoint" at "/", which says the token first; then the first of the first messages; after "ready" the other ones and
 * the frames; the end message last. Two frames at most are on their way to a client: it says "drawn" for each
 * (view_request.h). So a slow client gets fewer frames, and nothing queues for it. Fields `dropped` and `ticks_lost` of a
 * live frame are made the client's own: snapshots since its first, and ticks, that it was never sent.
 *
 * Who is refused: a Host that is not this server (403, view_host.h); a web socket whose Origin is missing or is not a
 * page of this server (403); the fifth client (503); other paths (404), other methods (405), HTTP/2. A web socket is closed
 * with 1008 when its first message is not the token, or does not come in 2 s; when a message is longer than 4096
 * bytes, in fragments, binary, or none that view_request.h knows; when a hand comes without `control`, more frames
 * are said to be drawn than were sent, or more than VIEW_MESSAGES_A_SECOND messages come. A connection is closed when
 * its request's headers take more than 2 s, or when it takes nothing of the page for 5 s; from the 33rd on at once.
 *
 * A client that is slow, stopped or dead delays neither the thread nor another client. The server holds: one copy of the
 * newest frame for all, and for each client at most one older, of which it has taken a part; 64 KiB of what its socket did
 * not take; no queue.
 *
 * Nothing is encrypted. By default only this machine reaches the server; view_server_warning says so where more can.
 *
 * The server writes nothing to any stream, and leaves the process's signals as they are; its thread takes none.
 */
#ifndef DPT_TOOLS_VIEW_SERVER_H
#define DPT_TOOLS_VIEW_SERVER_H

#include <stddef.h>
#include <stdint.h>

#include "view/view_request.h"

#define VIEW_CLIENTS_MAX       4
#define VIEW_CONNECTIONS_MAX   32
#define VIEW_UNDRAWN_MAX       2
#define VIEW_FRAMES_A_SECOND   60
#define VIEW_MESSAGES_A_SECOND 500
#define VIEW_URL_BYTES         128
#define VIEW_WARNING_BYTES     640

/* Kinds of messages: the first four bytes, little-endian. A frame has a header of 80 bytes at least. */
enum view_message_kind { VIEW_MESSAGE_SCENE = 1, VIEW_MESSAGE_FRAME = 2, VIEW_MESSAGE_END = 3 };
#define VIEW_FRAME_HEADER_BYTES 80u

struct view_message {
    const void *bytes;
    size_t size;
};

struct view_server;

/* What is pointed to stays valid, and the same, until view_server_close. */
struct view_server_def {
    const char *command; /* that serves this machine alone: for the warning */
    const void *page;
    size_t page_size;
    const char *csp;                  /* the page's Content-Security-Policy */
    const char *address;              /* in numbers; NULL: 127.0.0.1 and, where there is one, ::1 */
    uint16_t port;                    /* 0: a free one */
    const struct view_token *token;   /* read during the call; NULL: a new one */
    int control;                      /* "hand" is heard */
    const struct view_message *first; /* for each client */
    size_t first_count;
    /*
     * Called in the server's thread. next: 1 and a frame that is newer than the one before, which stays valid until the
     * next call, or 0. It is called when a client can take a frame, 60 times a second at most; NULL: there are none.
     */
    int (*next)(void *user, struct view_message *frame);
    void (*heard_hand)(void *user, const double position[3]);
    void *user;
};

struct view_server_counts {
    uint64_t clients;  /* that are connected and gave the token */
    uint64_t refused;  /* requests and web sockets so far, for any of the reasons above */
    uint64_t sent;     /* live frames, over all clients so far */
    uint64_t dropped;  /* frames that a client was not sent, likewise */
    uint64_t messages; /* that were heard, but for tokens */
};

/*
 * Start to serve. Returns NULL, or what is wrong, in words; then *server is NULL. With a port of 0 the same free port is
 * taken on both addresses.
 */
const char *view_server_open(const struct view_server_def *def, struct view_server **server);

uint16_t view_server_port(const struct view_server *server);

/* The page's address with the token, for a browser on this machine: a secret. */
void view_server_url(const struct view_server *server, char url[VIEW_URL_BYTES]);

/* Lines for standard error if other machines reach the server, with the command of a tunnel; else "". Without the token. */
void view_server_warning(const struct view_server *server, char text[VIEW_WARNING_BYTES]);

/* From any thread. */
void view_server_counts(const struct view_server *server, struct view_server_counts *counts);

/*
 * There will be no more frames, and `text` (UTF-8, copied) says why: each client gets the newest frame, then this.
 * The first call counts.
 */
void view_server_end_message(struct view_server *server, const char *text);

/*
 * Take leave of the clients, and free everything. What they still have to get is waited for, half a second at most. NULL
 * is fine.
 */
void view_server_close(struct view_server *server);

#endif
