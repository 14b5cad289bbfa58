/* SPDX-License-Identifier: BSD-3-Clause */
/* Live frames: copied once for all clients, and looked for only when one can take them. */
#include "view/server/server_state.h"

#include <stdlib.h>
#include <string.h>

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
