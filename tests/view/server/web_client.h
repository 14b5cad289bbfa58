/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A client of HTTP and web sockets that also does what no browser would: every byte is the test's. All that waits gives
 * up after a time.
 */
#ifndef DPT_TESTS_WEB_CLIENT_H
#define DPT_TESTS_WEB_CLIENT_H

#include <stddef.h>
#include <stdint.h>

struct web_client {
    int socket; /* -1: none */
    unsigned char *bytes;
    size_t used, room;
    unsigned char *message; /* the last that was received */
};

/* What the other side sent. */
enum web_event { WEB_NOTHING, WEB_TEXT = 1, WEB_BINARY = 2, WEB_CLOSE = 8, WEB_PONG = 10, WEB_ENDED = 100 };

struct web_message {
    enum web_event event; /* WEB_NOTHING: not in time; WEB_ENDED: the connection did */
    unsigned code;        /* of a close, or 0 */
    size_t size;
    unsigned char *bytes; /* valid until the next call */
    unsigned pieces;      /* frames of the protocol that it came in */
};

double web_now(void); /* s */

/* Returns 0 if nothing listens there. */
int web_open(struct web_client *client, const char *address, uint16_t port);
/* One whose system takes a few thousand bytes that are not read, no more. */
int web_open_narrow(struct web_client *client, const char *address, uint16_t port);
void web_close(struct web_client *client);

/* All of it; returns 0 if the other side does not take it. */
int web_send(struct web_client *client, const void *bytes, size_t size);
int web_say(struct web_client *client, const char *text);

/*
 * Read the answer of an HTTP request with its body, if `has_body`. Returns the status, or 0. The answer's text, headers
 * first, ends with a zero; `body` is where its body begins.
 */
int web_answer(struct web_client *client, int has_body, const char **body, size_t *body_size);

/* Whether the other side ends the connection within so many seconds. */
int web_ends(struct web_client *client, double seconds);

/* Ask for a web socket. NULL leaves the header out. Returns the status: 101 if it is one. */
int web_upgrade(struct web_client *client, const char *host, const char *origin);

/* One frame of the protocol, masked. `first` is its first byte: 0x81 is a whole text. */
int web_frame(struct web_client *client, unsigned first, const void *bytes, size_t size);
int web_text(struct web_client *client, const char *text);
/* A whole text, of which each byte travels by itself. */
int web_text_slowly(struct web_client *client, const char *text);

/* The next whole message. */
struct web_message web_receive(struct web_client *client, double seconds);

#endif
