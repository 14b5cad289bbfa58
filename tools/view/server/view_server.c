/* SPDX-License-Identifier: BSD-3-Clause */
#include "view/server/view_server.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "platform/machine.h"
#include "platform/program.h"
#include "platform/sockets.h"
#include "platform/thread.h"
#include "view/server/server_state.h"

/* How often another free port is tried, where ::1 does not have the one that 127.0.0.1 has. */
enum { PORTS_TRIED = 16 };

/*
 * What the kernel keeps for a client, bytes. By itself it would take megabytes: pictures of long ago, and a socket
 * that has room again only when a third of them is gone.
 */
enum { SOCKET_ROOM = 262144 };

static const char *const no_port = "the port cannot be taken: it is in use, or not allowed";

/* It wakes the thread when the time to close is over. */
static void close_now(lws_sorted_usec_list_t *timer)
{
    (void)timer;
}

static struct shared_message *make_end(const char *text)
{
    const size_t size = strlen(text);
    struct shared_message *end = malloc(sizeof *end + 8 + size);
    if (!end)
        return NULL;
    *end = (struct shared_message){ .uses = 1, .size = 8 + size };
    write_field(end->bytes, 0, 4, VIEW_MESSAGE_END);
    write_field(end->bytes, 4, 4, size);
    memcpy(end->bytes + 8, text, size);
    return end;
}

/* What was asked for from other threads. */
static void asked(struct view_server *server)
{
    pthread_mutex_lock(&server->lock);
    char *text = server->end_text;
    server->end_text = NULL;
    const int is_closing = server->is_closing;
    pthread_mutex_unlock(&server->lock);
    if (text && !server->end) {
        frames_take(server);
        server->end = make_end(text);
    }
    free(text);
    if (is_closing && !server->close_by) {
        server->close_by = lws_now_usecs() + CLOSE_MILLISECONDS * LWS_US_PER_MS;
        lws_sul_schedule(server->context, 0, &server->close_timer, close_now, CLOSE_MILLISECONDS * LWS_US_PER_MS);
    }
    lws_callback_on_writable_all_protocol(server->context, &server->protocols[0]);
}

static int connected(struct view_server *server, struct lws *wsi)
{
    const int room = SOCKET_ROOM;
    server->connections++;
    lws_set_opaque_user_data(wsi, server);
    setsockopt(lws_get_socket_fd(wsi), SOL_SOCKET, SO_SNDBUF, (const void *)&room, sizeof room);
    lws_set_timer_usecs(wsi, HEADERS_SECONDS * LWS_USEC_PER_SEC);
    return 0;
}

static int late(struct view_server *server, struct lws *wsi, struct connection *connection)
{
    if (connection && connection->stage == STAGE_KNOWN)
        return 0;
    return connection && connection->stage == STAGE_NEEDS_TOKEN ? client_late(server, wsi, connection) : -1;
}

static int on_event(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in, size_t size)
{
    struct view_server *server = server_of(wsi);
    switch ((int)reason) {
    case LWS_CALLBACK_FILTER_NETWORK_CONNECTION:
        return server->connections >= VIEW_CONNECTIONS_MAX;
    case LWS_CALLBACK_SERVER_NEW_CLIENT_INSTANTIATED:
        return connected(server, wsi);
    case LWS_CALLBACK_WSI_DESTROY:
        /* Those that listen were never counted. */
        server->connections -= lws_get_opaque_user_data(wsi) != NULL;
        return 0;
    case LWS_CALLBACK_HTTP:
        return page_requested(server, wsi, user, in);
    case LWS_CALLBACK_HTTP_WRITEABLE:
        return page_writeable(server, wsi, user);
    case LWS_CALLBACK_HTTP_CONFIRM_UPGRADE:
        /* And not h2c, which it would take by itself. */
        return strcmp(in, "websocket") != 0;
    case LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION:
        return upgrade_asked(server, wsi);
    case LWS_CALLBACK_ESTABLISHED:
        return client_came(server, wsi, user);
    case LWS_CALLBACK_RECEIVE:
        return client_heard(server, wsi, user, in, size);
    case LWS_CALLBACK_SERVER_WRITEABLE:
        return client_writeable(server, wsi, user);
    case LWS_CALLBACK_CLOSED:
        client_left(server, user);
        return 0;
    case LWS_CALLBACK_TIMER:
        return late(server, wsi, user);
    case LWS_CALLBACK_EVENT_WAIT_CANCELLED:
        /* It comes once for each of the two hosts, and once early. */
        if (server->context)
            asked(server);
        return 0;
    default:
        return 0;
    }
}

static void *serve(void *user)
{
    struct view_server *server = user;
    while (lws_service(server->context, 0) >= 0)
        if (server->close_by && (!server->web_sockets || lws_now_usecs() >= server->close_by))
            break;
    return NULL;
}

static void set_headers(struct view_server *server)
{
    const char *const lines[][2] = { { "content-security-policy:", server->def.csp },
                                     { "x-content-type-options:", "nosniff" },
                                     { "referrer-policy:", "no-referrer" },
                                     { "cross-origin-resource-policy:", "same-origin" },
                                     { "cross-origin-opener-policy:", "same-origin" },
                                     { "cache-control:", "no-store" } };
    const size_t count = sizeof lines / sizeof *lines;
    for (size_t i = 0; i < count; i++)
        server->headers[i] = (struct lws_protocol_vhost_options){
            .next = i + 1 < count ? &server->headers[i + 1] : NULL, .name = lines[i][0], .value = lines[i][1]
        };
}

/* Listens on one address. Returns the port, or 0. */
static uint16_t listen_on(struct view_server *server, struct lws_context_creation_info *info, const char *address,
                          const char *name)
{
    const int is_6 = view_address_kind(address) == VIEW_ADDRESS_6;
    const uint64_t before = info->options;
    info->iface = view_address_is_every(address) ? NULL : address;
    info->vhost_name = name;
    /* Without this libwebsockets 4.1.6 takes an address of version 4 for every address; with it, one of version 6. */
    if (!is_6)
        info->options |= LWS_SERVER_OPTION_DISABLE_IPV6;
    struct lws_vhost *host = lws_create_vhost(server->context, info);
    info->options = before;
    const int port = host ? lws_get_vhost_listen_port(host) : 0;
    return port > 0 ? (uint16_t)port : 0;
}

static void drop_context(struct view_server *server)
{
    struct lws_context *context = server->context;
    server->context = NULL;
    if (context)
        lws_context_destroy(context);
}

/* What is to be made, and what came of it. */
struct creation {
    struct lws_context_creation_info *info;
    struct lws_context *context;
};

static void create(void *user)
{
    struct creation *creation = user;
    creation->context = lws_create_context(creation->info);
}

/* libwebsockets lets the process ignore closed pipes; the program has its own way with them. */
static struct lws_context *create_context(struct lws_context_creation_info *info)
{
    struct creation creation = { .info = info };
    program_keep_closed_pipe(create, &creation);
    return creation.context;
}

static const char *listen_once(struct view_server *server)
{
    static const lws_retry_bo_t patience = { .secs_since_valid_ping = 15, .secs_since_valid_hangup = 40 };
    const char *address = server->def.address ? server->def.address : "127.0.0.1";
    struct lws_context_creation_info info = { .port = server->def.port,
                                              .protocols = server->protocols,
                                              .headers = server->headers,
                                              .server_string = "dynpoint",
                                              .user = server,
                                              .gid = -1,
                                              .uid = -1,
                                              .max_http_header_data = 4096,
                                              .max_http_header_pool = VIEW_CONNECTIONS_MAX,
                                              /* Some are its own. */
                                              .fd_limit_per_thread = VIEW_CONNECTIONS_MAX + 16,
                                              /* Its own are longer than those of this file. */
                                              .timeout_secs = 3 * PAGE_SECONDS,
                                              .timeout_secs_ah_idle = 3 * PAGE_SECONDS,
                                              .keepalive_timeout = 3 * PAGE_SECONDS,
                                              .retry_and_idle_policy = &patience,
                                              .options = LWS_SERVER_OPTION_EXPLICIT_VHOSTS |
                                                         LWS_SERVER_OPTION_FAIL_UPON_UNABLE_TO_BIND };
    server->context = create_context(&info);
    if (!server->context)
        return "no memory for the server, or no file descriptors";
    server->host.port = listen_on(server, &info, address, "first");
    if (!server->host.port)
        return no_port;
    info.port = server->host.port;
    return server->def.address || !sockets_have_local_6() || listen_on(server, &info, "::1", "second") ? NULL : no_port;
}

static const char *start(struct view_server *server)
{
    const char *fault = NULL;
    if (server->def.token)
        server->token = *server->def.token;
    else if (view_token_make(&server->token))
        return "the system gives no random numbers";
    for (int tried = 0; tried < PORTS_TRIED; tried++) {
        drop_context(server);
        fault = listen_once(server);
        if (fault != no_port || server->def.port)
            break;
    }
    if (fault)
        return fault;
    return thread_start(&server->thread, serve, server) == 0 ? NULL : "no thread for the server";
}

static void free_server(struct view_server *server)
{
    drop_context(server);
    shared_release(server->newest);
    shared_release(server->end);
    free(server->end_text);
    pthread_mutex_destroy(&server->lock);
    free(server);
}

const char *view_server_open(const struct view_server_def *def, struct view_server **server)
{
    struct view_server *made = NULL;
    *server = NULL;
    if (def->address && view_address_kind(def->address) == VIEW_ADDRESS_INVALID)
        return "an address is wanted in numbers, as 192.0.2.1 or ::1";
    made = calloc(1, sizeof *made);
    if (!made)
        return "no memory for the server";
    made->def = *def;
    made->host.address = def->address;
    made->protocols[0] = (struct lws_protocols){ .name = "dynpoint",
                                                 .callback = on_event,
                                                 .per_session_data_size = sizeof(struct connection),
                                                 .rx_buffer_size = VIEW_REQUEST_BYTES_MAX };
    set_headers(made);
    pthread_mutex_init(&made->lock, NULL);
    lws_set_log_level(0, NULL);
    const char *fault = start(made);
    if (fault)
        free_server(made);
    else
        *server = made;
    return fault;
}

uint16_t view_server_port(const struct view_server *server)
{
    return server->host.port;
}

/* An address as a part of URLs. */
static void url_host(const char *address, char text[64])
{
    snprintf(text, 64, view_address_kind(address) == VIEW_ADDRESS_6 ? "[%s]" : "%s", address);
}

void view_server_url(const struct view_server *server, char url[VIEW_URL_BYTES])
{
    const char *address = server->def.address;
    char host[64];
    url_host(!address || view_address_is_every(address) ? "127.0.0.1" : address, host);
    snprintf(url, VIEW_URL_BYTES, "http://%s:%u/#%s", host, (unsigned)server->host.port, server->token.digits);
}

void view_server_warning(const struct view_server *server, char text[VIEW_WARNING_BYTES])
{
    const char *address = server->def.address;
    const unsigned port = server->host.port;
    char machine[65] = "";
    text[0] = '\0';
    if (!address || view_address_is_local(address))
        return;
    machine_host(machine, sizeof machine);
    if (!machine[0])
        snprintf(machine, sizeof machine, "THIS-MACHINE");
    snprintf(text, VIEW_WARNING_BYTES,
             "warning: other machines reach %s port %u, and nothing is encrypted: who listens on the "
             "way sees all of it.\n"
             "Safer: here\n    %s\nand on the other machine\n    ssh -N -L %u:127.0.0.1:%u %s\n"
             "and there a browser at the address that the first one prints.\n",
             address, port, server->def.command, port, port, machine);
}

void view_server_counts(const struct view_server *server, struct view_server_counts *counts)
{
    *counts = (struct view_server_counts){ .clients = __atomic_load_n(&server->counts.clients, __ATOMIC_RELAXED),
                                           .refused = __atomic_load_n(&server->counts.refused, __ATOMIC_RELAXED),
                                           .sent = __atomic_load_n(&server->counts.sent, __ATOMIC_RELAXED),
                                           .dropped = __atomic_load_n(&server->counts.dropped, __ATOMIC_RELAXED),
                                           .messages = __atomic_load_n(&server->counts.messages, __ATOMIC_RELAXED) };
}

void view_server_end_message(struct view_server *server, const char *text)
{
    pthread_mutex_lock(&server->lock);
    if (!server->end_text)
        server->end_text = strdup(text);
    pthread_mutex_unlock(&server->lock);
    lws_cancel_service(server->context);
}

void view_server_close(struct view_server *server)
{
    if (!server)
        return;
    pthread_mutex_lock(&server->lock);
    server->is_closing = 1;
    pthread_mutex_unlock(&server->lock);
    lws_cancel_service(server->context);
    pthread_join(server->thread, NULL);
    free_server(server);
}

/* The page, in pieces as the socket takes them. */

/* Enough for the canned headers: the policy lists some hashes of scripts. */
#define HEADER_ROOM 4096u

int request_refused(struct view_server *server, struct lws *wsi, unsigned status)
{
    count_one(&server->counts.refused, 1);
    lws_return_http_status(wsi, status, NULL);
    return -1;
}

static int has_own_host(const struct view_server *server, struct lws *wsi)
{
    char host[128];
    return copy_header(wsi, WSI_TOKEN_HOST, host, sizeof host) && view_host_is_own(&server->host, host);
}

static int send_headers(struct view_server *server, struct lws *wsi, int and_page)
{
    unsigned char *start = server->room + LWS_PRE, *at = start, *end = start + HEADER_ROOM;
    if (lws_add_http_common_headers(wsi, HTTP_STATUS_OK, "text/html; charset=utf-8", server->def.page_size, &at, end) ||
        lws_finalize_http_header(wsi, &at, end))
        return -1;
    const size_t size = (size_t)(at - start);
    return lws_write(wsi, start, size,
                     and_page ? LWS_WRITE_HTTP_HEADERS : LWS_WRITE_HTTP_HEADERS | LWS_WRITE_H2_STREAM_END) < (int)size
               ? -1
               : 0;
}

static int request_done(struct lws *wsi)
{
    lws_set_timer_usecs(wsi, HEADERS_SECONDS * LWS_USEC_PER_SEC);
    return lws_http_transaction_completed(wsi);
}

int page_requested(struct view_server *server, struct lws *wsi, struct connection *connection, const char *path)
{
    const int is_get = lws_hdr_total_length(wsi, WSI_TOKEN_GET_URI) > 0;
    if (!has_own_host(server, wsi))
        return request_refused(server, wsi, HTTP_STATUS_FORBIDDEN);
    if (!is_get && lws_hdr_total_length(wsi, WSI_TOKEN_HEAD_URI) <= 0)
        return request_refused(server, wsi, HTTP_STATUS_METHOD_NOT_ALLOWED);
    if (strcmp(path, "/") != 0 || lws_hdr_total_length(wsi, WSI_TOKEN_HTTP_URI_ARGS) > 0)
        return request_refused(server, wsi, HTTP_STATUS_NOT_FOUND);
    if (send_headers(server, wsi, is_get))
        return -1;
    if (!is_get)
        return request_done(wsi);
    connection->page_is_sent = 1;
    connection->page_sent = 0;
    lws_set_timer_usecs(wsi, PAGE_SECONDS * LWS_USEC_PER_SEC);
    lws_callback_on_writable(wsi);
    return 0;
}

int page_writeable(struct view_server *server, struct lws *wsi, struct connection *connection)
{
    unsigned char *start = server->room + LWS_PRE;
    const size_t left = server->def.page_size - connection->page_sent;
    const size_t size = left < VIEW_CHUNK ? left : VIEW_CHUNK;
    if (!connection->page_is_sent)
        return 0;
    if (left == 0) {
        connection->page_is_sent = 0;
        return request_done(wsi);
    }
    memcpy(start, (const char *)server->def.page + connection->page_sent, size);
    if (lws_write(wsi, start, size, size == left ? LWS_WRITE_HTTP_FINAL : LWS_WRITE_HTTP) < 0)
        return -1;
    connection->page_sent += size;
    lws_set_timer_usecs(wsi, PAGE_SECONDS * LWS_USEC_PER_SEC);
    lws_callback_on_writable(wsi);
    return 0;
}
