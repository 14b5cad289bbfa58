/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A server with made-up messages: a page of random bytes, a scene of a size that is asked for, and frames of which each
 * carries the sum of all ticks so far. One at a time.
 */
#ifndef DPT_TESTS_VIEW_FIXTURE_H
#define DPT_TESTS_VIEW_FIXTURE_H

#include <stddef.h>
#include <stdint.h>

#include "view/server/view_server.h"
#include "view/server/web_client.h"

enum { FIXTURE_PAGE_BYTES = 8000000, FIXTURE_TICKS = 2, FIXTURE_NUMBERS = 3, FIXTURE_LOST = 7 };

#define FIXTURE_CSP "default-src 'none'; frame-ancestors 'none'"

struct view_fixture {
    struct view_server_def def;
    struct view_server *server;
    uint16_t port;
    char token[40], host[40], origin[48];
    unsigned char *page, *scene, *frame;
    struct view_message first[4];
    size_t frame_bytes; /* of the snapshot in a live frame */
    int paused;         /* there are no new frames; atomic */
    uint64_t asked;     /* frames that were made; atomic */
    uint64_t hands;     /* that were heard; atomic */
    double hand[3];
};

/* Settings in fixture.def and fixture.frame_bytes may be changed between these two. */
void fixture_prepare(struct view_fixture *fixture, size_t scene_bytes, size_t frame_bytes);
void fixture_open(struct view_fixture *fixture);
void fixture_close(struct view_fixture *fixture);

/* A web socket, with the token or without; returns the status of the handshake. */
int fixture_socket(struct view_fixture *fixture, struct web_client *client, int with_token);

/* One that has its scene and is ready for frames. */
void fixture_client(struct view_fixture *fixture, struct web_client *client);

/* What the test sends to be refused leads to a close with this code, and the server serves on. */
void fixture_expect_close(struct view_fixture *fixture, struct web_client *client, unsigned code, const char *what);

struct view_server_counts fixture_counts(const struct view_fixture *fixture);

uint64_t field_of(const unsigned char *bytes, size_t offset, int size);

#endif
