/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What the files of the server share: its state, and a connection's. All of it is the server thread's alone, but for what
 * is marked.
 */
#ifndef DPT_TOOLS_VIEW_SERVER_STATE_H
#define DPT_TOOLS_VIEW_SERVER_STATE_H

#include <libwebsockets.h>
#include <pthread.h>

#include "view/server/view_server.h"
#include "view/view_request.h"

/* What is given to a socket at once, bytes. */
#define VIEW_CHUNK 65536u

enum { HEADERS_SECONDS = 2, TOKEN_SECONDS = 2, PAGE_SECONDS = 5, CLOSE_MILLISECONDS = 500 };

/* A live frame, or the end message, of which several clients may have taken a part. */
struct shared_message {
    unsigned uses;
    size_t size;
    uint64_t serial;       /* of frames, from 1 */
    uint64_t ticks_before; /* in all frames before it */
    unsigned char bytes[];
};

enum connection_stage { STAGE_HTTP, STAGE_NEEDS_TOKEN, STAGE_KNOWN, STAGE_REFUSED, STAGE_CLOSED };

/* Of libwebsockets' own memory, zeros at first. */
struct connection {
    enum connection_stage stage;
    struct lws *wsi;
    int page_is_sent; /* at this time */
    size_t page_sent;

    int is_ready, end_is_queued, end_is_sent;
    unsigned undrawn;
    size_t next_first; /* of the first messages */
    /* The message that is on its way. */
    const unsigned char *message;
    size_t size, sent;
    struct shared_message *shared; /* it is part of this one, or NULL */
    uint64_t dropped, ticks_lost;  /* for its header, if it is a live frame */

    uint64_t serial, frames, first_number, ticks_until, ticks_missed; /* of the live frames so far */
    double allowance;                                                 /* messages that may come */
    lws_usec_t heard_at;                                              /* when it was counted */
    size_t heard;                                                     /* bytes of the message that comes */
    char text[VIEW_REQUEST_BYTES_MAX];
};

struct view_server {
    struct view_server_def def;
    struct view_host host;
    struct view_token token;
    struct lws_context *context;
    struct lws_protocols protocols[2];
    struct lws_protocol_vhost_options headers[6];
    lws_sorted_usec_list_t frame_timer, close_timer;
    int is_looking;
    lws_usec_t look_at; /* next time */
    struct connection *known[VIEW_CLIENTS_MAX];
    unsigned connections, web_sockets;
    pthread_t thread;
    lws_usec_t close_by; /* 0: nobody asked to close */

    struct shared_message *newest, *end;
    uint64_t ticks;

    struct view_server_counts counts; /* atomic: the thread adds, others read */
    pthread_mutex_t lock;             /* of the next two */
    char *end_text;
    int is_closing;

    unsigned char room[LWS_PRE + VIEW_CHUNK]; /* what is written next */
};

static inline struct view_server *server_of(struct lws *wsi)
{
    return lws_context_user(lws_get_context(wsi));
}

static inline void count_one(uint64_t *count, uint64_t more)
{
    __atomic_fetch_add(count, more, __ATOMIC_RELAXED);
}

/* Offsets in a live frame's header. */
enum { FRAME_TICKS = 8, FRAME_NUMBER = 16, FRAME_DROPPED = 24, FRAME_TICKS_LOST = 32 };

/* A field of a message: little-endian, of so many bytes. */
static inline uint64_t read_field(const void *message, size_t offset, int bytes)
{
    const unsigned char *at = (const unsigned char *)message + offset;
    uint64_t value = 0;
    for (int i = bytes; i-- > 0;)
        value = value << 8 | at[i];
    return value;
}

static inline void write_field(unsigned char *message, size_t offset, int bytes, uint64_t value)
{
    for (int i = 0; i < bytes; i++)
        message[offset + (size_t)i] = (unsigned char)(value >> 8 * i);
}

/* Copies a request's header. Returns 0 if there is none, or it is longer than the room. */
static inline int copy_header(struct lws *wsi, enum lws_token_indexes header, char *text, int room)
{
    return lws_hdr_copy(wsi, text, room, header) > 0;
}

/* A request that is not a web socket's, and its answer. They return what a callback returns: not 0 closes. */
int page_requested(struct view_server *server, struct lws *wsi, struct connection *connection, const char *path);
int page_writeable(struct view_server *server, struct lws *wsi, struct connection *connection);

/* Answers with a status, and closes. */
int request_refused(struct view_server *server, struct lws *wsi, unsigned status);

/* Web sockets. upgrade_asked: before the handshake is answered. */
int upgrade_asked(struct view_server *server, struct lws *wsi);
int client_came(struct view_server *server, struct lws *wsi, struct connection *connection);
int client_heard(struct view_server *server, struct lws *wsi, struct connection *connection, const void *bytes,
                 size_t size);
int client_writeable(struct view_server *server, struct lws *wsi, struct connection *connection);
int client_late(struct view_server *server, struct lws *wsi, struct connection *connection);
void client_left(struct view_server *server, struct connection *connection);

/* Whether a client waits for a live frame. */
int client_is_hungry(const struct view_server *server, const struct connection *connection);

/* Lets each client that is known send what it can. */
void clients_wake(struct view_server *server);

/* The newest frame of def.next becomes server->newest. */
void frames_take(struct view_server *server);
/* From now on look for frames, 60 times a second, until no client is ready. */
void frames_look(struct view_server *server);
void shared_release(struct shared_message *message);

#endif
