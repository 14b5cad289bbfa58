/* SPDX-License-Identifier: BSD-3-Clause */
/* The page, in pieces as the socket takes them. */
#include "view/server/server_state.h"

#include <string.h>

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
