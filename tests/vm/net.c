/* SPDX-License-Identifier: BSD-3-Clause */
#include "vm/net.h"

#include <errno.h>
#include <linux/can/netlink.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

/* IFF_ECHO, which libraries' headers leave out. */
#define ECHO_FLAG (1u << 18)

struct request {
    struct nlmsghdr header;
    struct ifinfomsg link;
    uint8_t attributes[256];
};

static struct request request_of(uint16_t type, uint16_t flags, const char *name)
{
    struct request request = { .header = { .nlmsg_len = NLMSG_LENGTH(sizeof request.link),
                                           .nlmsg_type = type,
                                           .nlmsg_flags = (uint16_t)(NLM_F_REQUEST | flags) } };
    request.link.ifi_index = name ? (int)if_nametoindex(name) : 0;
    return request;
}

static struct rtattr *append(struct request *request, uint16_t type, const void *value, size_t size)
{
    struct rtattr *attribute = (struct rtattr *)((uint8_t *)request + request->header.nlmsg_len);
    attribute->rta_type = type;
    attribute->rta_len = (uint16_t)RTA_LENGTH(size);
    if (size)
        memcpy(RTA_DATA(attribute), value, size);
    request->header.nlmsg_len += (uint32_t)RTA_SPACE(size);
    return attribute;
}

/* What was appended since then lies within `attribute`. */
static void enclose(struct request *request, struct rtattr *attribute)
{
    uint8_t *end = (uint8_t *)request + request->header.nlmsg_len;
    attribute->rta_len = (uint16_t)(end - (uint8_t *)attribute);
}

/* The first answer, into `answer` of `size` bytes. */
static int ask(const struct request *request, void *answer, size_t size)
{
    const int line = socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE);
    const struct nlmsghdr *header = answer;
    int result = 0;
    if (line < 0 || send(line, request, request->header.nlmsg_len, 0) < 0 ||
        recv(line, answer, size, 0) < (ssize_t)sizeof *header)
        result = errno ? errno : EIO;
    else if (header->nlmsg_type == NLMSG_ERROR)
        result = -((const struct nlmsgerr *)NLMSG_DATA(header))->error;
    if (line >= 0)
        close(line);
    return result;
}

static int tell(struct request *request)
{
    uint64_t answer[512];
    request->header.nlmsg_flags |= NLM_F_ACK;
    return request->link.ifi_index || request->header.nlmsg_flags & NLM_F_CREATE ? ask(request, answer, sizeof answer)
                                                                                 : ENODEV;
}

int net_add(const char *name)
{
    struct request request = request_of(RTM_NEWLINK, NLM_F_CREATE | NLM_F_EXCL, NULL);
    append(&request, IFLA_IFNAME, name, strlen(name) + 1);
    struct rtattr *info = append(&request, IFLA_LINKINFO, NULL, 0);
    append(&request, IFLA_INFO_KIND, "vcan", 4);
    enclose(&request, info);
    return tell(&request);
}

int net_remove(const char *name)
{
    struct request request = request_of(RTM_DELLINK, 0, name);
    return tell(&request);
}

static int set_up(const char *name, unsigned flags)
{
    struct request request = request_of(RTM_NEWLINK, 0, name);
    request.link.ifi_flags = flags;
    request.link.ifi_change = IFF_UP;
    return tell(&request);
}

int net_up(const char *name)
{
    return set_up(name, IFF_UP);
}

int net_down(const char *name)
{
    return set_up(name, 0);
}

/* A property of a CAN controller. */
static int set_can(const char *name, uint16_t type, const void *value, size_t size)
{
    struct request request = request_of(RTM_NEWLINK, 0, name);
    struct rtattr *info = append(&request, IFLA_LINKINFO, NULL, 0);
    append(&request, IFLA_INFO_KIND, "can", 3);
    struct rtattr *data = append(&request, IFLA_INFO_DATA, NULL, 0);
    append(&request, type, value, size);
    enclose(&request, data);
    enclose(&request, info);
    return tell(&request);
}

int net_set_bitrate(const char *name, uint32_t bitrate)
{
    const struct can_bittiming timing = { .bitrate = bitrate };
    return set_can(name, IFLA_CAN_BITTIMING, &timing, sizeof timing);
}

int net_restart(const char *name)
{
    const uint32_t yes = 1;
    return set_can(name, IFLA_CAN_RESTART, &yes, sizeof yes);
}

int net_set_queue(const char *name, uint32_t frames)
{
    struct request request = request_of(RTM_NEWLINK, 0, name);
    append(&request, IFLA_TXQLEN, &frames, sizeof frames);
    return tell(&request);
}

/* Attributes, and those within them that matter: the link's at depth 0, the controller's at 2. */
static void take(struct net_state *state, const uint8_t *at, size_t size, int depth)
{
    while (size >= sizeof(struct rtattr)) {
        const struct rtattr *attribute = (const struct rtattr *)at;
        const size_t length = attribute->rta_len, whole = RTA_ALIGN(length);
        const uint8_t *value = at + RTA_LENGTH(0);
        const int type = attribute->rta_type & NLA_TYPE_MASK;
        uint32_t number = 0;
        if (length < RTA_LENGTH(0) || length > size)
            return;
        if (length >= RTA_LENGTH(sizeof number))
            memcpy(&number, value, sizeof number);
        if (depth == 0 && type == IFLA_MTU)
            state->mtu = number;
        else if (depth == 0 && type == IFLA_CARRIER)
            state->carrier = *value;
        else if (depth == 0 && type == IFLA_TXQLEN)
            state->queue = number;
        else if (depth == 2 && type == IFLA_CAN_STATE)
            state->error_state = (int)number;
        else if (depth == 2 && type == IFLA_CAN_BITTIMING) /* begins with it */
            state->bitrate = number;
        else if ((depth == 0 && type == IFLA_LINKINFO) || (depth == 1 && type == IFLA_INFO_DATA))
            take(state, value, length - RTA_LENGTH(0), depth + 1);
        at += whole;
        size -= whole < size ? whole : size;
    }
}

int net_query(const char *name, struct net_state *state)
{
    uint64_t answer[2048];
    const struct request request = request_of(RTM_GETLINK, 0, name);
    const int result = request.link.ifi_index ? ask(&request, answer, sizeof answer) : ENODEV;
    memset(state, 0, sizeof *state);
    state->error_state = -1;
    if (result)
        return result;
    const struct nlmsghdr *header = (const struct nlmsghdr *)answer;
    const struct ifinfomsg *link = NLMSG_DATA(header);
    state->up = (link->ifi_flags & IFF_UP) != 0;
    state->running = (link->ifi_flags & IFF_RUNNING) != 0;
    state->echo = (link->ifi_flags & ECHO_FLAG) != 0;
    take(state, (const uint8_t *)IFLA_RTA(link), IFLA_PAYLOAD(header), 0);
    return 0;
}
