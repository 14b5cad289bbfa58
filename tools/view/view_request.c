/* SPDX-License-Identifier: BSD-3-Clause */
#include "view/view_request.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "platform/file.h"
#include "platform/machine.h"
#include "platform/sockets.h"
#include "text/parse_number.h"

static int is_word(const char *text, size_t size, const char *word)
{
    return size == strlen(word) && memcmp(text, word, size) == 0;
}

static int parse_position(const char *text, const char *end, double position[3])
{
    for (int k = 0; k < 3; k++) {
        if (text == end || *text != ' ')
            return 0;
        text = parse_double(text + 1, end, &position[k]);
        /* Not "<= max" turned round: it must refuse what is not a number. */
        if (!text || !(fabs(position[k]) <= VIEW_REQUEST_HAND_MAX))
            return 0;
    }
    return text == end;
}

enum view_request_kind view_request_parse(const char *text, size_t size, struct view_request *request)
{
    double position[3];
    *request = (struct view_request){ .kind = VIEW_REQUEST_UNKNOWN };
    if (size > VIEW_REQUEST_BYTES_MAX)
        return request->kind;
    if (is_word(text, size, "ready")) {
        request->kind = VIEW_REQUEST_READY;
    } else if (is_word(text, size, "drawn")) {
        request->kind = VIEW_REQUEST_DRAWN;
    } else if (size > 4 && memcmp(text, "hand", 4) == 0 && parse_position(text + 4, text + size, position)) {
        request->kind = VIEW_REQUEST_HAND;
        memcpy(request->position, position, sizeof position);
    }
    return request->kind;
}

int view_token_make(struct view_token *token)
{
    unsigned char random[VIEW_TOKEN_DIGITS / 2];
    if (machine_random(random, sizeof random) != 0)
        return -1;
    for (size_t i = 0; i < VIEW_TOKEN_DIGITS; i++)
        token->digits[i] = "0123456789abcdef"[random[i / 2] >> (i % 2 ? 0 : 4) & 15];
    token->digits[VIEW_TOKEN_DIGITS] = '\0';
    return 0;
}

int view_token_is(const struct view_token *token, const void *bytes, size_t size)
{
    const volatile unsigned char *heard = bytes;
    unsigned difference = 0;
    if (size != VIEW_TOKEN_DIGITS)
        return 0;
    for (size_t i = 0; i < VIEW_TOKEN_DIGITS; i++)
        difference |= (unsigned)heard[i] ^ (unsigned char)token->digits[i];
    return difference == 0;
}

enum { PATH_BYTES = 300 };

static int is_token(const struct view_token *token, long size)
{
    return size == VIEW_TOKEN_DIGITS && strspn(token->digits, "0123456789abcdef") == VIEW_TOKEN_DIGITS;
}

static int read_or_make(int file, struct view_token *token)
{
    memset(token, 0, sizeof *token);
    if (is_token(token, file_read(file, token->digits, VIEW_TOKEN_DIGITS)))
        return 1;
    return view_token_make(token) == 0 && file_cut(file, 0) == 0 &&
           file_write(file, token->digits, VIEW_TOKEN_DIGITS) == VIEW_TOKEN_DIGITS;
}

int view_token_keep(uint16_t port, struct view_token *token)
{
    const char *folder = getenv("XDG_RUNTIME_DIR");
    char path[PATH_BYTES];
    if (!folder || folder[0] != '/' || strlen(folder) > PATH_BYTES - 40)
        return 0;
    snprintf(path, sizeof path, "%s/dynpoint-view-%u", folder, (unsigned)port);
    const int file = file_open_kept(folder, path);
    const int is_kept = file >= 0 && read_or_make(file, token);
    if (file >= 0)
        close(file);
    return is_kept;
}

enum { HTTP_PORT = 80 };

enum view_address view_address_kind(const char *address)
{
    struct in6_addr bytes;
    if (inet_pton(AF_INET, address, &bytes) == 1)
        return VIEW_ADDRESS_4;
    return inet_pton(AF_INET6, address, &bytes) == 1 ? VIEW_ADDRESS_6 : VIEW_ADDRESS_INVALID;
}

int view_address_is_every(const char *address)
{
    struct in_addr four;
    struct in6_addr six;
    if (inet_pton(AF_INET, address, &four) == 1)
        return four.s_addr == htonl(INADDR_ANY);
    return inet_pton(AF_INET6, address, &six) == 1 && IN6_IS_ADDR_UNSPECIFIED(&six);
}

int view_address_is_local(const char *address)
{
    struct in_addr four;
    struct in6_addr six;
    if (inet_pton(AF_INET, address, &four) == 1)
        return ntohl(four.s_addr) >> 24 == IN_LOOPBACKNET;
    return inet_pton(AF_INET6, address, &six) == 1 && IN6_IS_ADDR_LOOPBACK(&six);
}

/* The name without the port and brackets; 0 if the port is another. A browser leaves out that of HTTP. */
static int split(const struct view_host *host, const char *text, char name[INET6_ADDRSTRLEN], int *is_bracketed)
{
    char port[8];
    const size_t size = strlen(text);
    size_t name_size;
    const int port_size = snprintf(port, sizeof port, ":%u", (unsigned)host->port);
    if (size > (size_t)port_size && strcmp(text + size - (size_t)port_size, port) == 0)
        name_size = size - (size_t)port_size;
    else if (host->port == HTTP_PORT)
        name_size = size;
    else
        return 0;
    *is_bracketed = name_size > 2 && text[0] == '[' && text[name_size - 1] == ']';
    if (*is_bracketed) {
        text++;
        name_size -= 2;
    }
    if (name_size >= INET6_ADDRSTRLEN)
        return 0;
    memcpy(name, text, name_size);
    name[name_size] = '\0';
    return 1;
}

/* However they are written. */
static int is_same_address(const char *one, const char *other)
{
    struct in6_addr bytes[2];
    const enum view_address kind = view_address_kind(one);
    const int family = kind == VIEW_ADDRESS_4 ? AF_INET : AF_INET6;
    memset(bytes, 0, sizeof bytes);
    return kind != VIEW_ADDRESS_INVALID && inet_pton(family, one, &bytes[0]) == 1 &&
           inet_pton(family, other, &bytes[1]) == 1 && !memcmp(&bytes[0], &bytes[1], sizeof *bytes);
}

int view_host_is_own(const struct view_host *host, const char *text)
{
    char name[INET6_ADDRSTRLEN];
    int is_bracketed;
    if (!split(host, text, name, &is_bracketed))
        return 0;
    if (is_bracketed ? !strcmp(name, "::1") : !strcmp(name, "127.0.0.1") || !strcmp(name, "localhost"))
        return 1;
    if (!host->address || view_address_kind(name) != (is_bracketed ? VIEW_ADDRESS_6 : VIEW_ADDRESS_4))
        return 0;
    return view_address_is_every(host->address) || is_same_address(name, host->address);
}

int view_origin_is_own(const struct view_host *host, const char *host_text, const char *origin)
{
    static const char scheme[] = "http://";
    return view_host_is_own(host, host_text) && !strncmp(origin, scheme, sizeof scheme - 1) &&
           !strcmp(origin + sizeof scheme - 1, host_text);
}
