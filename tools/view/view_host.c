/* SPDX-License-Identifier: BSD-3-Clause */
#include "view/view_host.h"

#include <arpa/inet.h>
#include <stdio.h>
#include <string.h>

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
