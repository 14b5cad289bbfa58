/* SPDX-License-Identifier: BSD-3-Clause */
#define _GNU_SOURCE
#include "view/server/web_client.h"

#include <arpa/inet.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

static const double patience = 5.0;

double web_now(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static int open_with(struct web_client *client, const char *address, uint16_t port, int room)
{
    struct sockaddr_in four = { .sin_family = AF_INET, .sin_port = htons(port) };
    struct sockaddr_in6 six = { .sin6_family = AF_INET6, .sin6_port = htons(port) };
    const int is_4 = inet_pton(AF_INET, address, &four.sin_addr) == 1;
    *client = (struct web_client){ .socket = -1 };
    if (!is_4 && inet_pton(AF_INET6, address, &six.sin6_addr) != 1)
        return 0;
    client->socket = socket(is_4 ? AF_INET : AF_INET6, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const int on = 1;
    if (room > 0)
        setsockopt(client->socket, SOL_SOCKET, SO_RCVBUF, &room, sizeof room);
    if (client->socket >= 0 && setsockopt(client->socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on) == 0 &&
        connect(client->socket, is_4 ? (const struct sockaddr *)&four : (const struct sockaddr *)&six,
                is_4 ? sizeof four : sizeof six) == 0)
        return 1;
    web_close(client);
    return 0;
}

int web_open(struct web_client *client, const char *address, uint16_t port)
{
    return open_with(client, address, port, 0);
}

int web_open_narrow(struct web_client *client, const char *address, uint16_t port)
{
    return open_with(client, address, port, 4096);
}

void web_close(struct web_client *client)
{
    if (client->socket >= 0)
        close(client->socket);
    free(client->bytes);
    free(client->message);
    *client = (struct web_client){ .socket = -1 };
}

static int is_ready(struct web_client *client, short event, double until)
{
    struct pollfd poll_for = { .fd = client->socket, .events = event };
    const double left = until - web_now();
    return poll(&poll_for, 1, left > 0.0 ? (int)(1e3 * left) + 1 : 0) > 0;
}

int web_send(struct web_client *client, const void *bytes, size_t size)
{
    const char *at = bytes;
    const double until = web_now() + patience;
    while (size > 0) {
        if (!is_ready(client, POLLOUT, until))
            return 0;
        const ssize_t sent = send(client->socket, at, size, MSG_NOSIGNAL | MSG_DONTWAIT);
        if (sent < 0)
            return 0;
        at += sent;
        size -= (size_t)sent;
    }
    return 1;
}

int web_say(struct web_client *client, const char *text)
{
    return web_send(client, text, strlen(text));
}

/* 1: something came; 0: not in time; -1: it ended. */
static int read_more(struct web_client *client, double until)
{
    if (client->room - client->used < 65536) {
        client->room = 2 * client->room + 131072;
        client->bytes = realloc(client->bytes, client->room);
        if (!client->bytes)
            abort();
    }
    if (!is_ready(client, POLLIN, until))
        return 0;
    const ssize_t got = recv(client->socket, client->bytes + client->used, client->room - client->used - 1, 0);
    if (got <= 0)
        return -1;
    client->used += (size_t)got;
    client->bytes[client->used] = '\0';
    return 1;
}

static void drop(struct web_client *client, size_t size)
{
    memmove(client->bytes, client->bytes + size, client->used - size);
    client->used -= size;
}

static size_t head_size(const struct web_client *client)
{
    const char *end = client->bytes ? strstr((const char *)client->bytes, "\r\n\r\n") : NULL;
    return end ? (size_t)(end - (const char *)client->bytes) + 4 : 0;
}

int web_answer(struct web_client *client, int has_body, const char **body, size_t *body_size)
{
    const double until = web_now() + patience;
    size_t head;
    int status = 0;
    while (!(head = head_size(client)))
        if (read_more(client, until) <= 0)
            return 0;
    const char *text = (const char *)client->bytes;
    const char *length = strcasestr(text, "\r\ncontent-length: ");
    *body_size = has_body && length && length < text + head ? strtoul(length + 18, NULL, 10) : 0;
    while (client->used < head + *body_size)
        if (read_more(client, until) <= 0)
            return 0;
    *body = (const char *)client->bytes + head;
    return sscanf((const char *)client->bytes, "HTTP/1.%*1d %d", &status) == 1 ? status : 0;
}

int web_ends(struct web_client *client, double seconds)
{
    const double until = web_now() + seconds;
    int result;
    while ((result = read_more(client, until)) > 0)
        ;
    return result < 0;
}

int web_upgrade(struct web_client *client, const char *host, const char *origin)
{
    char text[1024], host_line[256] = "", origin_line[256] = "";
    const char *body;
    size_t body_size;
    if (host)
        snprintf(host_line, sizeof host_line, "Host: %s\r\n", host);
    if (origin)
        snprintf(origin_line, sizeof origin_line, "Origin: %s\r\n", origin);
    snprintf(text, sizeof text,
             "GET / HTTP/1.1\r\n%s%sUpgrade: websocket\r\nConnection: Upgrade\r\n"
             "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n"
             "Sec-WebSocket-Protocol: dynpoint\r\n\r\n",
             host_line, origin_line);
    if (!web_say(client, text))
        return 0;
    const int status = web_answer(client, 0, &body, &body_size);
    if (status == 101 && !strstr((const char *)client->bytes, "s3pPLMBiTxaQ9kYGzzhZRbK+xOo="))
        return 0;
    if (status == 101)
        drop(client, head_size(client));
    return status;
}

/* Returns its size; the block is the caller's to free. */
static size_t make_frame(unsigned first, const void *bytes, size_t size, unsigned char **frame)
{
    static const unsigned char mask[4] = { 0x12, 0x9a, 0x5c, 0xe7 };
    size_t at = 0;
    *frame = malloc(size + 14);
    if (!*frame)
        abort();
    (*frame)[at++] = (unsigned char)first;
    const int wide = size < 126 ? 0 : size < 65536 ? 2 : 8;
    (*frame)[at++] = (unsigned char)(0x80 | (wide == 0 ? size : wide == 2 ? 126 : 127));
    for (int i = wide; i-- > 0;)
        (*frame)[at++] = (unsigned char)(size >> 8 * i);
    memcpy(*frame + at, mask, 4);
    at += 4;
    for (size_t i = 0; i < size; i++)
        (*frame)[at++] = (unsigned char)(((const unsigned char *)bytes)[i] ^ mask[i % 4]);
    return at;
}

int web_frame(struct web_client *client, unsigned first, const void *bytes, size_t size)
{
    unsigned char *frame;
    const size_t frame_size = make_frame(first, bytes, size, &frame);
    const int sent = web_send(client, frame, frame_size);
    free(frame);
    return sent;
}

int web_text_slowly(struct web_client *client, const char *text)
{
    unsigned char *frame;
    const size_t size = make_frame(0x81, text, strlen(text), &frame);
    int sent = 1;
    for (size_t i = 0; i < size && sent; i++) {
        sent = web_send(client, frame + i, 1);
        usleep(2000);
    }
    free(frame);
    return sent;
}

int web_text(struct web_client *client, const char *text)
{
    return web_frame(client, 0x81, text, strlen(text));
}

/* The size of the frame at an offset with its head, or 0 if it is not all there. */
static size_t frame_at(const struct web_client *client, size_t at, size_t *head)
{
    const unsigned char *bytes = client->bytes + at;
    const size_t there = client->used - at;
    if (there < 2)
        return 0;
    const int wide = bytes[1] < 126 ? 0 : bytes[1] == 126 ? 2 : 8;
    size_t size = wide ? 0 : bytes[1];
    *head = 2 + (size_t)wide;
    if (there < *head)
        return 0;
    for (int i = 0; i < wide; i++)
        size = size << 8 | bytes[2 + i];
    return there < *head + size ? 0 : *head + size;
}

/* The bytes of a message that is all there, pieces and their heads; 0: not in time, or the connection ended. */
static size_t wait_for_message(struct web_client *client, double until, struct web_message *message)
{
    size_t at = 0, head = 0, size;
    for (;;) {
        while (at > client->used || !(size = frame_at(client, at, &head))) {
            const int result = read_more(client, until);
            if (result <= 0) {
                message->event = result < 0 ? WEB_ENDED : WEB_NOTHING;
                return 0;
            }
        }
        const unsigned first = client->bytes[at];
        /* A close may come between pieces; what was begun is never finished then. */
        if (first & 8 && at > 0) {
            drop(client, at);
            at = 0;
            message->pieces = 0;
        }
        if (message->pieces++ == 0)
            message->event = (enum web_event)(first & 15);
        at += size;
        if (first & 0x80)
            return at;
    }
}

struct web_message web_receive(struct web_client *client, double seconds)
{
    struct web_message message = { .event = WEB_NOTHING };
    const size_t whole = wait_for_message(client, web_now() + seconds, &message);
    free(client->message);
    client->message = NULL;
    if (!whole)
        return message;
    client->message = malloc(whole);
    if (!client->message)
        abort();
    for (size_t at = 0, head = 0, size; at < whole; at += size) {
        size = frame_at(client, at, &head);
        memcpy(client->message + message.size, client->bytes + at + head, size - head);
        message.size += size - head;
    }
    drop(client, whole);
    message.bytes = client->message;
    if (message.event == WEB_CLOSE && message.size >= 2)
        message.code = (unsigned)message.bytes[0] << 8 | message.bytes[1];
    return message;
}
