/* SPDX-License-Identifier: BSD-3-Clause */
#include "view/server/view_fixture.h"

#include "lib/check.h"

uint64_t field_of(const unsigned char *bytes, size_t offset, int size)
{
    uint64_t value = 0;
    for (int i = size; i-- > 0;)
        value = value << 8 | bytes[offset + (size_t)i];
    return value;
}

static void set_field(unsigned char *bytes, size_t offset, int size, uint64_t value)
{
    for (int i = 0; i < size; i++)
        bytes[offset + (size_t)i] = (unsigned char)(value >> 8 * i);
}

static unsigned char *random_bytes(size_t size, uint64_t seed)
{
    unsigned char *bytes = malloc(size + 1);
    if (!bytes)
        abort();
    for (size_t i = 0; i < size; i++)
        bytes[i] = (unsigned char)random_bits(&seed);
    return bytes;
}

/* Fields that are the server's to set are wrong here. */
static int next_frame(void *user, struct view_message *message)
{
    struct view_fixture *fixture = user;
    if (__atomic_load_n(&fixture->paused, __ATOMIC_RELAXED))
        return 0;
    const uint64_t made = __atomic_fetch_add(&fixture->asked, 1, __ATOMIC_RELAXED);
    const size_t size = VIEW_FRAME_HEADER_BYTES + fixture->frame_bytes + 40 * FIXTURE_TICKS;
    set_field(fixture->frame, 0, 4, VIEW_MESSAGE_FRAME);
    set_field(fixture->frame, 4, 4, fixture->frame_bytes);
    set_field(fixture->frame, 8, 4, FIXTURE_TICKS);
    set_field(fixture->frame, 16, 8, FIXTURE_NUMBERS * (made + 5));
    set_field(fixture->frame, 24, 8, UINT64_MAX);
    set_field(fixture->frame, 32, 8, FIXTURE_LOST);
    set_field(fixture->frame, 80, 8, FIXTURE_TICKS * (made + 1));
    set_field(fixture->frame, size - 8, 8, made);
    *message = (struct view_message){ fixture->frame, size };
    return 1;
}

static void heard_hand(void *user, const double position[3])
{
    struct view_fixture *fixture = user;
    memcpy(fixture->hand, position, sizeof fixture->hand);
    __atomic_fetch_add(&fixture->hands, 1, __ATOMIC_RELEASE);
}

void fixture_prepare(struct view_fixture *fixture, size_t scene_bytes, size_t frame_bytes)
{
    *fixture = (struct view_fixture){ .frame_bytes = frame_bytes };
    fixture->page = random_bytes(FIXTURE_PAGE_BYTES, 1);
    fixture->scene = random_bytes(scene_bytes, 2);
    fixture->frame = random_bytes(VIEW_FRAME_HEADER_BYTES + frame_bytes + 40 * FIXTURE_TICKS, 3);
    set_field(fixture->scene, 0, 4, VIEW_MESSAGE_SCENE);
    fixture->first[0] = (struct view_message){ fixture->scene, scene_bytes };
    fixture->def = (struct view_server_def){ .command = "dynpoint view liver.dpa",
                                             .page = fixture->page,
                                             .page_size = FIXTURE_PAGE_BYTES,
                                             .csp = FIXTURE_CSP,
                                             .control = 1,
                                             .first = fixture->first,
                                             .first_count = 1,
                                             .next = next_frame,
                                             .heard_hand = heard_hand,
                                             .user = fixture };
}

void fixture_open(struct view_fixture *fixture)
{
    char url[VIEW_URL_BYTES];
    const char *fault = view_server_open(&fixture->def, &fixture->server);
    if (fault) {
        printf("    the server does not open: %s\n", fault);
        exit(1);
    }
    fixture->port = view_server_port(fixture->server);
    view_server_url(fixture->server, url);
    snprintf(fixture->token, sizeof fixture->token, "%s", strchr(url, '#') + 1);
    snprintf(fixture->host, sizeof fixture->host, "127.0.0.1:%u", (unsigned)fixture->port);
    snprintf(fixture->origin, sizeof fixture->origin, "http://%s", fixture->host);
}

void fixture_close(struct view_fixture *fixture)
{
    view_server_close(fixture->server);
    free(fixture->page);
    free(fixture->scene);
    free(fixture->frame);
}

int fixture_socket(struct view_fixture *fixture, struct web_client *client, int with_token)
{
    if (!web_open(client, "127.0.0.1", fixture->port))
        return 0;
    const int status = web_upgrade(client, fixture->host, fixture->origin);
    if (status == 101 && with_token)
        web_text(client, fixture->token);
    return status;
}

void fixture_client(struct view_fixture *fixture, struct web_client *client)
{
    const int status = fixture_socket(fixture, client, 1);
    CHECK(status == 101, "status %d", status);
    const struct web_message scene = web_receive(client, 5.0);
    CHECK(scene.event == WEB_BINARY && scene.size == fixture->first[0].size &&
              !memcmp(scene.bytes, fixture->first[0].bytes, scene.size),
          "event %d of %zu bytes is not the scene", (int)scene.event, scene.size);
    web_text(client, "ready");
}

void fixture_expect_close(struct view_fixture *fixture, struct web_client *client, unsigned code, const char *what)
{
    struct web_message message;
    do
        message = web_receive(client, 4.0);
    while (message.event == WEB_BINARY);
    CHECK(message.event == WEB_CLOSE && message.code == code, "%s: event %d, code %u", what, (int)message.event,
          message.code);
    web_close(client);
    struct web_client other;
    CHECK(fixture_socket(fixture, &other, 1) == 101 && web_receive(&other, 4.0).event == WEB_BINARY,
          "after %s another is not served", what);
    web_close(&other);
}

struct view_server_counts fixture_counts(const struct view_fixture *fixture)
{
    struct view_server_counts counts;
    view_server_counts(fixture->server, &counts);
    return counts;
}
