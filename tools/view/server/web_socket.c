/* SPDX-License-Identifier: BSD-3-Clause */
/* The page's web socket: what it says, and what is sent to it next. */
#include <stdlib.h>
#include <string.h>

#include "view/server/server_state.h"

/* NULL: a free one. */
static struct connection **place_of(struct view_server *server, const struct connection *connection)
{
    for (size_t i = 0; i < VIEW_CLIENTS_MAX; i++)
        if (server->known[i] == connection)
            return &server->known[i];
    return NULL;
}

int upgrade_asked(struct view_server *server, struct lws *wsi)
{
    char host[128], origin[160], path[8];
    if (!copy_header(wsi, WSI_TOKEN_HOST, host, sizeof host) ||
        !copy_header(wsi, WSI_TOKEN_ORIGIN, origin, sizeof origin) || !view_origin_is_own(&server->host, host, origin))
        return request_refused(server, wsi, HTTP_STATUS_FORBIDDEN);
    if (!copy_header(wsi, WSI_TOKEN_GET_URI, path, sizeof path) || strcmp(path, "/") != 0)
        return request_refused(server, wsi, HTTP_STATUS_NOT_FOUND);
    if (!place_of(server, NULL))
        return request_refused(server, wsi, HTTP_STATUS_SERVICE_UNAVAILABLE);
    return 0;
}

int client_came(struct view_server *server, struct lws *wsi, struct connection *connection)
{
    server->web_sockets++;
    *connection = (struct connection){ .stage = STAGE_NEEDS_TOKEN, .wsi = wsi };
    connection->allowance = VIEW_MESSAGES_A_SECOND;
    connection->heard_at = lws_now_usecs();
    lws_set_timer_usecs(wsi, TOKEN_SECONDS * LWS_USEC_PER_SEC);
    return 0;
}

void clients_wake(struct view_server *server)
{
    for (size_t i = 0; i < VIEW_CLIENTS_MAX; i++)
        if (server->known[i])
            lws_callback_on_writable(server->known[i]->wsi);
}

/* Nothing is held for it any more; its place is free before the other side has answered the close. */
static void let_go(struct view_server *server, struct connection *connection, enum connection_stage stage)
{
    if (connection->stage == STAGE_KNOWN) {
        *place_of(server, connection) = NULL;
        count_one(&server->counts.clients, (uint64_t)-1);
    }
    connection->stage = stage;
    connection->message = NULL;
    shared_release(connection->shared);
    connection->shared = NULL;
}

static int client_refused(struct view_server *server, struct lws *wsi, struct connection *connection,
                          enum lws_close_status status)
{
    count_one(&server->counts.refused, 1);
    let_go(server, connection, STAGE_REFUSED);
    lws_close_reason(wsi, status, NULL, 0);
    return -1;
}

int client_late(struct view_server *server, struct lws *wsi, struct connection *connection)
{
    return client_refused(server, wsi, connection, LWS_CLOSE_STATUS_POLICY_VIOLATION);
}

void client_left(struct view_server *server, struct connection *connection)
{
    server->web_sockets--;
    let_go(server, connection, STAGE_CLOSED);
}

static int is_allowed(struct connection *connection)
{
    const lws_usec_t now = lws_now_usecs();
    connection->allowance += VIEW_MESSAGES_A_SECOND * 1e-6 * (double)(now - connection->heard_at);
    if (connection->allowance > VIEW_MESSAGES_A_SECOND)
        connection->allowance = VIEW_MESSAGES_A_SECOND;
    connection->heard_at = now;
    connection->allowance -= 1.0;
    return connection->allowance >= 0.0;
}

/* 0 if the client may not say so. */
static int obey(struct view_server *server, struct lws *wsi, struct connection *connection, size_t size)
{
    struct view_request request;
    switch (view_request_parse(connection->text, size, &request)) {
    case VIEW_REQUEST_READY:
        if (connection->is_ready)
            return 0;
        connection->is_ready = 1;
        frames_look(server);
        break;
    case VIEW_REQUEST_DRAWN:
        if (connection->undrawn == 0)
            return 0;
        connection->undrawn--;
        break;
    case VIEW_REQUEST_HAND:
        if (!server->def.control)
            return 0;
        server->def.heard_hand(server->def.user, request.position);
        return 1;
    case VIEW_REQUEST_UNKNOWN:
        return 0;
    }
    lws_callback_on_writable(wsi);
    return 1;
}

/* 1: a message is whole; 0: some of it is still to come; -1: it is none that is taken. */
static int gather(struct lws *wsi, struct connection *connection, const void *bytes, size_t size)
{
    const size_t left = lws_remaining_packet_payload(wsi);
    const size_t room = sizeof connection->text - connection->heard;
    if (lws_frame_is_binary(wsi) || size > room || left > room - size)
        return -1;
    memcpy(connection->text + connection->heard, bytes, size);
    connection->heard += size;
    if (left > 0)
        return 0;
    return lws_is_final_fragment(wsi) && (lws_is_first_fragment(wsi) || connection->heard > size) ? 1 : -1;
}

static int token_heard(struct view_server *server, struct lws *wsi, struct connection *connection, size_t size)
{
    struct connection **place = place_of(server, NULL);
    if (!view_token_is(&server->token, connection->text, size))
        return client_refused(server, wsi, connection, LWS_CLOSE_STATUS_POLICY_VIOLATION);
    /* Others may have come since the handshake. 1013: try again later. */
    if (!place)
        return client_refused(server, wsi, connection, (enum lws_close_status)1013);
    *place = connection;
    connection->stage = STAGE_KNOWN;
    count_one(&server->counts.clients, 1);
    lws_set_timer_usecs(wsi, LWS_SET_TIMER_USEC_CANCEL);
    lws_callback_on_writable(wsi);
    return 0;
}

int client_heard(struct view_server *server, struct lws *wsi, struct connection *connection, const void *bytes,
                 size_t size)
{
    if (connection->stage == STAGE_REFUSED)
        return -1;
    const int gathered = gather(wsi, connection, bytes, size);
    if (gathered == 0)
        return 0;
    const size_t whole = connection->heard;
    connection->heard = 0;
    if (gathered < 0 || !is_allowed(connection))
        return client_refused(server, wsi, connection, LWS_CLOSE_STATUS_POLICY_VIOLATION);
    if (connection->stage == STAGE_NEEDS_TOKEN)
        return token_heard(server, wsi, connection, whole);
    count_one(&server->counts.messages, 1);
    return obey(server, wsi, connection, whole)
               ? 0
               : client_refused(server, wsi, connection, LWS_CLOSE_STATUS_POLICY_VIOLATION);
}

static int has_all_first(const struct view_server *server, const struct connection *connection)
{
    return connection->is_ready && connection->next_first == server->def.first_count;
}

int client_is_hungry(const struct view_server *server, const struct connection *connection)
{
    return connection->stage == STAGE_KNOWN && !connection->message && has_all_first(server, connection) &&
           connection->undrawn < VIEW_UNDRAWN_MAX;
}

static void send_next(struct connection *connection, const void *bytes, size_t size, struct shared_message *shared)
{
    connection->message = bytes;
    connection->size = size;
    connection->sent = 0;
    connection->shared = shared;
    if (shared)
        shared->uses++;
}

static void choose_frame(struct view_server *server, struct connection *connection)
{
    struct shared_message *frame = server->newest;
    const uint64_t number = read_field(frame->bytes, FRAME_NUMBER, 8);
    if (connection->serial == 0) {
        connection->first_number = number;
        connection->ticks_until = frame->ticks_before;
    }
    connection->ticks_missed += frame->ticks_before - connection->ticks_until;
    connection->ticks_until = frame->ticks_before + read_field(frame->bytes, FRAME_TICKS, 4);
    connection->ticks_lost = read_field(frame->bytes, FRAME_TICKS_LOST, 8) + connection->ticks_missed;
    const uint64_t dropped = number - connection->first_number - connection->frames;
    count_one(&server->counts.dropped, dropped - connection->dropped);
    count_one(&server->counts.sent, 1);
    connection->dropped = dropped;
    connection->serial = frame->serial;
    connection->frames++;
    connection->undrawn++;
    send_next(connection, frame->bytes, frame->size, frame);
}

/* What is on its way next, if anything may be. */
static void choose(struct view_server *server, struct connection *connection)
{
    if (!has_all_first(server, connection)) {
        const size_t next = connection->next_first;
        if (next == server->def.first_count || (next > 0 && !connection->is_ready))
            return;
        const struct view_message *message = &server->def.first[next];
        const int is_frame = read_field(message->bytes, 0, 4) == VIEW_MESSAGE_FRAME;
        if (is_frame && connection->undrawn == VIEW_UNDRAWN_MAX)
            return;
        connection->undrawn += (unsigned)is_frame;
        connection->next_first++;
        send_next(connection, message->bytes, message->size, NULL);
        return;
    }
    if (server->newest && connection->serial != server->newest->serial) {
        if (connection->undrawn < VIEW_UNDRAWN_MAX)
            choose_frame(server, connection);
        return;
    }
    if (server->end && !connection->end_is_queued) {
        connection->end_is_queued = 1;
        send_next(connection, server->end->bytes, server->end->size, server->end);
    }
}

static int send_piece(struct view_server *server, struct lws *wsi, struct connection *connection)
{
    unsigned char *start = server->room + LWS_PRE;
    const size_t left = connection->size - connection->sent;
    const size_t size = left < VIEW_CHUNK ? left : VIEW_CHUNK;
    memcpy(start, connection->message + connection->sent, size);
    if (connection->sent == 0 && connection->shared && connection->shared->serial) {
        write_field(start, FRAME_DROPPED, 8, connection->dropped);
        write_field(start, FRAME_TICKS_LOST, 8, connection->ticks_lost);
    }
    const int flags = lws_write_ws_flags(LWS_WRITE_BINARY, connection->sent == 0, size == left);
    if (lws_write(wsi, start, size, (enum lws_write_protocol)flags) < (int)size)
        return -1;
    connection->sent += size;
    if (size == left) {
        shared_release(connection->shared);
        connection->shared = NULL;
        connection->message = NULL;
    }
    lws_callback_on_writable(wsi);
    return 0;
}

int client_writeable(struct view_server *server, struct lws *wsi, struct connection *connection)
{
    if (connection->stage == STAGE_REFUSED)
        return -1;
    if (connection->stage == STAGE_KNOWN && !connection->message)
        choose(server, connection);
    if (connection->message)
        return send_piece(server, wsi, connection);
    /* The socket took all, the end too: it is called again only then. */
    connection->end_is_sent = connection->end_is_queued;
    if (server->close_by &&
        (connection->end_is_sent || !server->end || connection->stage != STAGE_KNOWN || !connection->is_ready)) {
        let_go(server, connection, STAGE_CLOSED);
        lws_close_reason(wsi, LWS_CLOSE_STATUS_GOINGAWAY, NULL, 0);
        return -1;
    }
    return 0;
}

/* Live frames: copied once for all clients, and looked for only when one can take them. */

void shared_release(struct shared_message *message)
{
    if (message && --message->uses == 0)
        free(message);
}

void frames_take(struct view_server *server)
{
    struct view_message found;
    if (!server->def.next || server->end || !server->def.next(server->def.user, &found) ||
        found.size < VIEW_FRAME_HEADER_BYTES)
        return;
    const uint64_t ticks_before = server->ticks;
    server->ticks += read_field(found.bytes, FRAME_TICKS, 4);
    struct shared_message *frame = malloc(sizeof *frame + found.size);
    /* Without memory it is one more that nobody was sent. */
    if (!frame)
        return;
    *frame = (struct shared_message){ .uses = 1,
                                      .size = found.size,
                                      .serial = server->newest ? server->newest->serial + 1 : 1,
                                      .ticks_before = ticks_before };
    memcpy(frame->bytes, found.bytes, found.size);
    shared_release(server->newest);
    server->newest = frame;
}

static void look(lws_sorted_usec_list_t *timer)
{
    struct view_server *server = lws_container_of(timer, struct view_server, frame_timer);
    const lws_usec_t now = lws_now_usecs(), period = LWS_USEC_PER_SEC / VIEW_FRAMES_A_SECOND;
    int is_wanted = 0, are_ready = 0;
    for (size_t i = 0; i < VIEW_CLIENTS_MAX; i++) {
        const struct connection *client = server->known[i];
        are_ready |= client && client->is_ready;
        is_wanted |= client && client_is_hungry(server, client);
    }
    server->look_at += period;
    /* After a pause it goes on from now. */
    if (server->look_at < now - period)
        server->look_at = now;
    server->is_looking = are_ready;
    if (are_ready)
        lws_sul_schedule(server->context, 0, timer, look, server->look_at > now ? server->look_at - now : 1);
    if (is_wanted) {
        frames_take(server);
        clients_wake(server);
    }
}

void frames_look(struct view_server *server)
{
    if (server->is_looking)
        return;
    server->is_looking = 1;
    server->look_at = lws_now_usecs();
    lws_sul_schedule(server->context, 0, &server->frame_timer, look, 1);
}
