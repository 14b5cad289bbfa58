/* SPDX-License-Identifier: BSD-3-Clause */
/* The viewer's server: what it serves, and whom it refuses. */
#define _GNU_SOURCE
#include "view/server/view_server.h"

#include <pthread.h>
#include <sys/socket.h>
#include <unistd.h>

#include "lib/check.h"
#include "view/server/view_fixture.h"
#include "view/view_request.h"

static struct view_fixture fixture;

/* Asks in words of HTTP, "%h" being the server's own host, and returns the status; *answer holds all that came. */
static int ask(struct web_client *client, const char *text, int has_body, const char **body, size_t *size)
{
    char request[2048], *at = request;
    for (; *text && at < request + 1900; text++) {
        if (text[0] == '%' && text[1] == 'h') {
            at += sprintf(at, "%s", fixture.host);
            text++;
        } else {
            *at++ = *text;
        }
    }
    *at = '\0';
    CHECK(web_open(client, "127.0.0.1", fixture.port), "no connection");
    CHECK(web_say(client, request), "nobody listens");
    return web_answer(client, has_body, body, size);
}

static int status_of(const char *text)
{
    struct web_client client;
    const char *body;
    size_t size;
    const int status = ask(&client, text, 0, &body, &size);
    web_close(&client);
    return status;
}

static void page_by_get(void)
{
    struct web_client client;
    const char *body;
    size_t size;
    const int status = ask(&client, "GET / HTTP/1.1\r\nHost: %h\r\n\r\n", 1, &body, &size);
    CHECK(status == 200, "status %d", status);
    CHECK(size == FIXTURE_PAGE_BYTES && !memcmp(body, fixture.page, size), "%zu bytes, or other ones", size);
    web_close(&client);
}

static void page_by_head(void)
{
    struct web_client client;
    const char *body;
    size_t size;
    const int status = ask(&client, "HEAD / HTTP/1.1\r\nHost: %h\r\nConnection: close\r\n\r\n", 0, &body, &size);
    CHECK(status == 200, "status %d", status);
    CHECK(strcasestr((const char *)client.bytes, "\r\ncontent-length: 8000000\r\n") != NULL, "%s", client.bytes);
    CHECK(web_ends(&client, 3.0), "the connection stays");
    CHECK(client.bytes + client.used == (const unsigned char *)strstr((const char *)client.bytes, "\r\n\r\n") + 4,
          "HEAD has a body");
    web_close(&client);
}

/* One connection, several requests. */
static void two_requests_in_one_connection(void)
{
    struct web_client client;
    const char *body;
    size_t size;
    ask(&client, "GET / HTTP/1.1\r\nHost: %h\r\n\r\n", 1, &body, &size);
    client.used = 0;
    client.bytes[0] = '\0';
    char request[128];
    snprintf(request, sizeof request, "GET / HTTP/1.1\r\nHost: %s\r\n\r\n", fixture.host);
    web_say(&client, request);
    const int status = web_answer(&client, 1, &body, &size);
    CHECK(status == 200 && size == FIXTURE_PAGE_BYTES && !memcmp(body, fixture.page, size),
          "the second time: status %d, %zu bytes", status, size);
    web_close(&client);
}

static void headers(void)
{
    static const char *const wanted[] = { "\r\ncontent-security-policy: " FIXTURE_CSP "\r\n",
                                          "\r\nx-content-type-options: nosniff\r\n",
                                          "\r\nreferrer-policy: no-referrer\r\n",
                                          "\r\ncross-origin-resource-policy: same-origin\r\n",
                                          "\r\ncross-origin-opener-policy: same-origin\r\n",
                                          "\r\ncache-control: no-store\r\n" };
    static const char *const requests[] = { "GET / HTTP/1.1\r\nHost: %h\r\nOrigin: http://%h\r\n\r\n",
                                            "GET /x HTTP/1.1\r\nHost: %h\r\n\r\n" };
    for (size_t k = 0; k < 2; k++) {
        struct web_client client;
        const char *body;
        size_t size;
        ask(&client, requests[k], 0, &body, &size);
        for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++)
            CHECK(strcasestr((const char *)client.bytes, wanted[i]) != NULL, "no %s", wanted[i] + 2);
        CHECK(!strcasestr((const char *)client.bytes, "access-control-"), "a header of CORS");
        if (k == 0)
            CHECK(strcasestr((const char *)client.bytes, "\r\ncontent-type: text/html; charset=utf-8\r\n"), "the type");
        web_close(&client);
    }
}

static void only_the_page(void)
{
    static const struct {
        const char *request;
        int status;
    } cases[] = {
        { "GET /index.html HTTP/1.1\r\nHost: %h\r\n\r\n", 404 },
        { "GET /../etc/passwd HTTP/1.1\r\nHost: %h\r\n\r\n", 404 },
        { "GET /etc/passwd HTTP/1.1\r\nHost: %h\r\n\r\n", 404 },
        { "GET /?x=1 HTTP/1.1\r\nHost: %h\r\n\r\n", 404 },
        { "GET /favicon.ico HTTP/1.1\r\nHost: %h\r\n\r\n", 404 },
        { "POST / HTTP/1.1\r\nHost: %h\r\nContent-Length: 0\r\n\r\n", 405 },
        { "PUT / HTTP/1.1\r\nHost: %h\r\nContent-Length: 3\r\n\r\nabc", 405 },
        { "DELETE / HTTP/1.1\r\nHost: %h\r\n\r\n", 405 },
        { "OPTIONS / HTTP/1.1\r\nHost: %h\r\n\r\n", 405 },
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const int status = status_of(cases[i].request);
        CHECK(status == cases[i].status, "%d for %.20s", status, cases[i].request);
    }
    /* What is no method ends the connection. */
    const int status = status_of("BREW / HTTP/1.1\r\nHost: %h\r\n\r\n");
    CHECK(status == 0 || status >= 400, "status %d", status);
}

static void foreign_hosts(void)
{
    char request[256];
    static const char *const hosts[] = { "evil.example", "evil.example:%u", "127.0.0.1", "localhost:1",
                                         "127.0.0.2:%u" };
    for (size_t i = 0; i < sizeof hosts / sizeof *hosts; i++) {
        char host[64];
        struct web_client client;
        snprintf(host, sizeof host, hosts[i], (unsigned)fixture.port);
        snprintf(request, sizeof request, "GET / HTTP/1.1\r\nHost: %s\r\n\r\n", host);
        CHECK(status_of(request) == 403, "%s gets the page", host);
        CHECK(web_open(&client, "127.0.0.1", fixture.port), "no connection");
        const int status = web_upgrade(&client, host, fixture.origin);
        CHECK(status == 403, "a web socket at %s: %d", host, status);
        web_close(&client);
    }
    CHECK(status_of("GET / HTTP/1.1\r\n\r\n") == 403, "no Host");
    CHECK(status_of("GET / HTTP/1.1\r\nHost: %h\r\nHost: evil.example\r\n\r\n") == 403, "two");
    static const char *const own[] = { "localhost:%u", "[::1]:%u", "127.0.0.1:%u" };
    for (size_t i = 0; i < sizeof own / sizeof *own; i++) {
        char host[64];
        snprintf(host, sizeof host, own[i], (unsigned)fixture.port);
        snprintf(request, sizeof request, "GET / HTTP/1.1\r\nHost: %s\r\n\r\n", host);
        CHECK(status_of(request) == 200, "%s does not", host);
    }
}

static void foreign_origins(void)
{
    static const char *const origins[] = { NULL,
                                           "null",
                                           "http://evil.example",
                                           "https://127.0.0.1:%u",
                                           "http://127.0.0.1:1",
                                           "http://127.0.0.1:%u.evil.example",
                                           "file://",
                                           "http://localhost:%u" };
    for (size_t i = 0; i < sizeof origins / sizeof *origins; i++) {
        struct web_client client;
        char origin[96] = "";
        if (origins[i])
            snprintf(origin, sizeof origin, origins[i], (unsigned)fixture.port);
        CHECK(web_open(&client, "127.0.0.1", fixture.port), "no connection");
        const int status = web_upgrade(&client, fixture.host, origins[i] ? origin : NULL);
        CHECK(status == 403, "a page of '%s': %d", origin, status);
        web_close(&client);
    }
}

static void other_upgrades(void)
{
    struct web_client client;
    const char *body;
    size_t size;
    const int status = ask(&client,
                           "GET / HTTP/1.1\r\nHost: %h\r\nConnection: Upgrade, HTTP2-Settings\r\n"
                           "Upgrade: h2c\r\nHTTP2-Settings: AAMAAABkAAQAAP__\r\n\r\n",
                           0, &body, &size);
    CHECK(status != 101, "HTTP/2 without being asked to");
    web_close(&client);
    CHECK(web_open(&client, "127.0.0.1", fixture.port), "no connection");
    web_say(&client, "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n");
    CHECK(web_ends(&client, 3.0), "HTTP/2 from the start");
    web_close(&client);
}

/* What a client gets before it has said the token: nothing. */
static void wrong_tokens(void)
{
    char token[40];
    struct web_client client;
    static const char *const what[] = { "another", "a short one", "a long one", "none" };
    for (int i = 0; i < 4; i++) {
        snprintf(token, sizeof token, "%s", fixture.token);
        if (i == 0)
            token[31] ^= 1;
        else if (i == 1)
            token[31] = '\0';
        else if (i == 2)
            strcat(token, "0");
        else
            strcpy(token, "ready");
        CHECK(fixture_socket(&fixture, &client, 0) == 101, "no web socket");
        web_text(&client, token);
        const struct web_message message = web_receive(&client, 4.0);
        CHECK(message.event == WEB_CLOSE && message.code == 1008, "%s: event %d, code %u", what[i], (int)message.event,
              message.code);
        web_close(&client);
    }
    CHECK(fixture_socket(&fixture, &client, 0) == 101, "no web socket");
    const struct web_message message = web_receive(&client, 0.3);
    CHECK(message.event == WEB_NOTHING, "without a token: event %d", (int)message.event);
    web_text(&client, fixture.token);
    CHECK(web_receive(&client, 4.0).event == WEB_BINARY, "the token is refused");
    web_close(&client);
}

static void wrong_messages(void)
{
    static char huge[VIEW_REQUEST_BYTES_MAX + 1];
    struct web_client client;
    memset(huge, 'x', sizeof huge);
    fixture_client(&fixture, &client);
    web_text(&client, "steer 1 2 3");
    fixture_expect_close(&fixture, &client, 1008, "an unknown word");
    fixture_client(&fixture, &client);
    web_text(&client, "ready");
    fixture_expect_close(&fixture, &client, 1008, "ready twice");
    fixture_client(&fixture, &client);
    web_text(&client, "hand 1 2 inf");
    fixture_expect_close(&fixture, &client, 1008, "a hand that is nowhere");
    fixture_client(&fixture, &client);
    web_frame(&client, 0x82, "hand 1 2 3", 10);
    fixture_expect_close(&fixture, &client, 1008, "a binary message");
    fixture_client(&fixture, &client);
    web_frame(&client, 0x01, "hand 1", 6);
    web_frame(&client, 0x80, " 2 3", 4);
    fixture_expect_close(&fixture, &client, 1008, "a message in fragments");
    fixture_client(&fixture, &client);
    web_frame(&client, 0x01, "hand 1 2 3", 10);
    web_frame(&client, 0x80, "", 0);
    fixture_expect_close(&fixture, &client, 1008, "a fragment that is whole");
    fixture_client(&fixture, &client);
    web_frame(&client, 0x81, huge, sizeof huge);
    fixture_expect_close(&fixture, &client, 1008, "4097 bytes");
    CHECK(fixture_socket(&fixture, &client, 0) == 101, "no web socket");
    web_frame(&client, 0x81, huge, sizeof huge);
    fixture_expect_close(&fixture, &client, 1008, "4097 bytes instead of a token");
    CHECK(fixture_socket(&fixture, &client, 0) == 101, "no web socket");
    web_frame(&client, 0x01, fixture.token, 16);
    web_frame(&client, 0x80, fixture.token + 16, 16);
    fixture_expect_close(&fixture, &client, 1008, "the token in fragments");
    CHECK(fixture.hands == 0, "a hand was heard");
}

/* More acknowledgements than frames would let the server send without end. */
static void drawn_too_often(void)
{
    struct web_client client;
    __atomic_store_n(&fixture.paused, 1, __ATOMIC_RELAXED);
    fixture_client(&fixture, &client);
    web_text(&client, "drawn");
    web_text(&client, "drawn");
    web_text(&client, "drawn");
    fixture_expect_close(&fixture, &client, 1008, "more drawn than sent");
    __atomic_store_n(&fixture.paused, 0, __ATOMIC_RELAXED);
}

static int is_heard(uint64_t count)
{
    for (int i = 0; i < 200 && __atomic_load_n(&fixture.hands, __ATOMIC_ACQUIRE) < count; i++)
        usleep(10000);
    return __atomic_load_n(&fixture.hands, __ATOMIC_ACQUIRE) == count;
}

/* At 4096 bytes a message is still heard, and however it travels. */
static void hands_are_heard(void)
{
    struct web_client client;
    char text[VIEW_REQUEST_BYTES_MAX];
    const uint64_t before = fixture.hands;
    memset(text, '0', sizeof text);
    memcpy(text, "hand 1.5 -2 0.", 14);
    fixture_client(&fixture, &client);
    web_frame(&client, 0x81, text, sizeof text);
    CHECK(is_heard(before + 1), "it was not heard");
    CHECK(fixture.hand[0] == 1.5 && fixture.hand[1] == -2.0 && fixture.hand[2] == 0.0, "%g %g %g", fixture.hand[0],
          fixture.hand[1], fixture.hand[2]);
    web_text_slowly(&client, "hand 3 2 1");
    CHECK(is_heard(before + 2), "byte by byte it was not heard");
    CHECK(fixture.hand[0] == 3.0 && fixture.hand[2] == 1.0, "%g", fixture.hand[0]);
    web_text_slowly(&client, "hand 3 2 ");
    fixture_expect_close(&fixture, &client, 1008, "byte by byte a wrong one");
}

static void too_many_messages(void)
{
    struct web_client client;
    fixture_client(&fixture, &client);
    for (int i = 0; i < 3 * VIEW_MESSAGES_A_SECOND && web_text(&client, "hand 0 0 0"); i++)
        ;
    fixture_expect_close(&fixture, &client, 1008, "too many messages");
}

static void fifth_client(void)
{
    struct web_client clients[VIEW_CLIENTS_MAX], one_more;
    for (int i = 0; i < VIEW_CLIENTS_MAX; i++)
        fixture_client(&fixture, &clients[i]);
    CHECK(fixture_counts(&fixture).clients == VIEW_CLIENTS_MAX, "%llu clients",
          (unsigned long long)fixture_counts(&fixture).clients);
    const int status = fixture_socket(&fixture, &one_more, 1);
    CHECK(status == 503, "the fifth: %d", status);
    web_close(&one_more);
    /* A refused one frees its place at once, though it does not answer the close. */
    web_text(&clients[0], "nonsense");
    struct web_message message;
    do
        message = web_receive(&clients[0], 4.0);
    while (message.event == WEB_BINARY);
    CHECK(message.event == WEB_CLOSE, "event %d", (int)message.event);
    fixture_client(&fixture, &one_more);
    web_close(&one_more);
    for (int i = 0; i < VIEW_CLIENTS_MAX; i++)
        web_close(&clients[i]);
    for (int i = 0; i < 200 && fixture_counts(&fixture).clients; i++)
        usleep(10000);
    CHECK(fixture_counts(&fixture).clients == 0, "who has left still counts");
}

/* Who has no token keeps nobody out who has it. */
static void strangers_take_no_place(void)
{
    struct web_client strangers[8], clients[VIEW_CLIENTS_MAX + 1];
    for (int i = 0; i < 8; i++)
        CHECK(fixture_socket(&fixture, &strangers[i], 0) == 101, "no web socket");
    for (int i = 0; i <= VIEW_CLIENTS_MAX; i++)
        CHECK(fixture_socket(&fixture, &clients[i], 0) == 101, "no web socket");
    for (int i = 0; i <= VIEW_CLIENTS_MAX; i++) {
        web_text(&clients[i], fixture.token);
        const struct web_message message = web_receive(&clients[i], 4.0);
        if (i < VIEW_CLIENTS_MAX)
            CHECK(message.event == WEB_BINARY, "client %d: event %d", i, (int)message.event);
        else
            CHECK(message.event == WEB_CLOSE && message.code == 1013, "the fifth: event %d, %u", (int)message.event,
                  message.code);
    }
    for (int i = 0; i < 8; i++)
        web_close(&strangers[i]);
    for (int i = 0; i <= VIEW_CLIENTS_MAX; i++)
        web_close(&clients[i]);
}

/* Each waits for two seconds: all at once. */
static void deadlines(void)
{
    struct web_client silent, slow, started, tokenless, idle;
    char line[64];
    const char *body;
    size_t size;
    CHECK(web_open(&silent, "127.0.0.1", fixture.port), "no connection");
    CHECK(web_open(&slow, "127.0.0.1", fixture.port), "no connection");
    CHECK(web_open(&started, "127.0.0.1", fixture.port), "no connection");
    CHECK(fixture_socket(&fixture, &tokenless, 0) == 101, "no web socket");
    CHECK(ask(&idle, "GET / HTTP/1.1\r\nHost: %h\r\n\r\n", 1, &body, &size) == 200, "no page");
    const double begin = web_now();
    web_say(&started, "GET / HTTP/1.1\r\nHost: ");
    /* A byte now and then does not keep it open. */
    for (int i = 0; i < 35; i++) {
        snprintf(line, sizeof line, i ? "X" : "GET / HTTP/1.1\r\n");
        web_say(&slow, line);
        usleep(100000);
    }
    CHECK(web_ends(&slow, 0.1), "a slow request stays");
    CHECK(web_ends(&silent, 0.1), "a silent connection stays");
    CHECK(web_ends(&started, 0.1), "half a request stays");
    CHECK(web_ends(&idle, 0.1), "an idle connection stays");
    const struct web_message message = web_receive(&tokenless, 0.1);
    CHECK(message.event == WEB_CLOSE && message.code == 1008, "no token in time: event %d, code %u", (int)message.event,
          message.code);
    CHECK(web_now() - begin < 6.0, "%g s", web_now() - begin);
    web_close(&silent);
    web_close(&slow);
    web_close(&started);
    web_close(&tokenless);
    web_close(&idle);
}

/* These two ask for the page when the program begins. */
static struct web_client unread, slow;
static double asked_at;
static pthread_t slow_reader;

/* Six seconds for all of it, a part each fiftieth of a second. */
static void *read_page_slowly(void *user)
{
    static unsigned char part[FIXTURE_PAGE_BYTES / 300];
    size_t *size = user;
    ssize_t got;
    while ((got = recv(slow.socket, part, sizeof part, MSG_WAITALL)) > 0) {
        *size += (size_t)got;
        usleep(20000);
    }
    return NULL;
}

static size_t read_slowly;

static void ask_and_read_slowly(void)
{
    char request[128];
    snprintf(request, sizeof request, "GET / HTTP/1.1\r\nHost: %s\r\n\r\n", fixture.host);
    CHECK(web_open_narrow(&unread, "127.0.0.1", fixture.port) && web_say(&unread, request), "nobody listens");
    CHECK(web_open_narrow(&slow, "127.0.0.1", fixture.port) && web_say(&slow, request), "nobody listens");
    CHECK(pthread_create(&slow_reader, NULL, read_page_slowly, &read_slowly) == 0, "no thread");
    asked_at = web_now();
}

/* A page that nobody reads is taken back after five seconds; who reads slowly gets all of it. */
static void page_that_is_not_read(void)
{
    while (web_now() < asked_at + 8.0)
        usleep(50000);
    CHECK(web_ends(&unread, 2.0), "the connection stays");
    CHECK(unread.used < FIXTURE_PAGE_BYTES / 8, "much of it came: %zu bytes", unread.used);
    pthread_join(slow_reader, NULL);
    CHECK(web_now() > asked_at + 6.0, "it was not slow");
    CHECK(read_slowly > FIXTURE_PAGE_BYTES, "the slow one has %zu bytes", read_slowly);
    web_close(&unread);
    web_close(&slow);
}

static void connections_are_bounded(void)
{
    struct web_client clients[VIEW_CONNECTIONS_MAX + 8];
    int ended = 0;
    usleep(500000);
    for (int i = 0; i < VIEW_CONNECTIONS_MAX + 8; i++)
        CHECK(web_open(&clients[i], "127.0.0.1", fixture.port), "no connection");
    for (int i = 0; i < VIEW_CONNECTIONS_MAX + 8; i++)
        ended += web_ends(&clients[i], i < VIEW_CONNECTIONS_MAX ? 0.0 : 2.0);
    CHECK(ended == 8, "%d of %d were refused", ended, VIEW_CONNECTIONS_MAX + 8);
    for (int i = 0; i < VIEW_CONNECTIONS_MAX + 8; i++)
        web_close(&clients[i]);
    struct web_client after;
    for (int i = 0; i < 100 && fixture_socket(&fixture, &after, 1) != 101; i++) {
        web_close(&after);
        usleep(10000);
    }
    CHECK(web_receive(&after, 4.0).event == WEB_BINARY, "afterwards nobody is served");
    web_close(&after);
}

int main(void)
{
    fixture_prepare(&fixture, 200000, 1000);
    fixture_open(&fixture);
    TEST(ask_and_read_slowly);
    TEST(page_by_get);
    TEST(page_by_head);
    TEST(two_requests_in_one_connection);
    TEST(headers);
    TEST(only_the_page);
    TEST(foreign_hosts);
    TEST(foreign_origins);
    TEST(other_upgrades);
    TEST(wrong_tokens);
    TEST(wrong_messages);
    TEST(drawn_too_often);
    TEST(hands_are_heard);
    TEST(too_many_messages);
    TEST(fifth_client);
    TEST(strangers_take_no_place);
    TEST(deadlines);
    TEST(page_that_is_not_read);
    TEST(connections_are_bounded);
    fixture_close(&fixture);
    return check_report();
}
