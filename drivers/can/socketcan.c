/* SPDX-License-Identifier: BSD-3-Clause */
#ifdef __linux__
#define _GNU_SOURCE
#endif
#include "can/socketcan.h"

#include "platform/clock.h"
#include "settings.h"

#ifdef __linux__

#include <dirent.h>
#include <errno.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/netlink.h>
#include <linux/can/raw.h>
#include <linux/if_link.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <net/if_arp.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#define RECEIVE_BUFFER_BYTES (1 << 20) /* so that a host may pause for a while */

static dpt_result explain_error(const char *name, int reason, dpt_device_error *error)
{
    switch (reason) {
    case EAFNOSUPPORT:
    case EPROTONOSUPPORT:
        return device_error(error, DPT_E_UNSUPPORTED,
                            "this kernel has no CAN: load it by sudo modprobe -a can can_raw");
    case ENODEV:
    case ENXIO:
        return device_error(error, DPT_E_DEVICE,
                            "no interface %.20s: is the adapter plugged in? dynpoint device list "
                            "shows those that there are",
                            name);
    case ENETDOWN:
        return device_error(error, DPT_E_DEVICE,
                            "%.20s is down: sudo ip link set %.20s up type can bitrate 1000000 (vcan: up alone)", name,
                            name);
    case EPERM:
    case EACCES:
        return device_error(error, DPT_E_PERMISSION, "no permission for %.20s: %.60s", name, strerror(reason));
    default:
        return device_error(error, DPT_E_SYSTEM, "%.20s: %.80s", name, strerror(reason));
    }
}

static int set_options(int fd, const struct can_wanted *wanted, int count, int is_fd)
{
    struct can_filter filters[SOCKETCAN_WANTED];
    for (int i = 0; i < count; i++) {
        filters[i].can_id = wanted[i].id | (wanted[i].is_extended ? CAN_EFF_FLAG : 0);
        filters[i].can_mask = wanted[i].mask | CAN_EFF_FLAG;
    }
    const can_err_mask_t errors = CAN_ERR_MASK;
    const int on = 1, bytes = RECEIVE_BUFFER_BYTES;
    /* The larger buffer is optional; the other options are required. */
    setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &bytes, sizeof bytes);
    return setsockopt(fd, SOL_CAN_RAW, CAN_RAW_FILTER, filters, (socklen_t)count * (socklen_t)sizeof *filters) ||
           setsockopt(fd, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &errors, sizeof errors) ||
           setsockopt(fd, SOL_CAN_RAW, CAN_RAW_RECV_OWN_MSGS, &on, sizeof on) ||
           (is_fd && setsockopt(fd, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, &on, sizeof on)) ||
           setsockopt(fd, SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof on) ||
           setsockopt(fd, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on);
}

static dpt_result attach(struct socketcan *socketcan, int fd, const char *name, const struct can_wanted *wanted,
                         int count, int is_fd, dpt_device_error *error)
{
    struct ifreq request;
    struct sockaddr_can address;
    memset(&request, 0, sizeof request);
    memset(&address, 0, sizeof address);
    strcpy(request.ifr_name, name);
    if (ioctl(fd, SIOCGIFINDEX, &request))
        return explain_error(name, errno, error);
    address.can_family = AF_CAN;
    address.can_ifindex = socketcan->index = request.ifr_ifindex;
    if (ioctl(fd, SIOCGIFHWADDR, &request))
        return explain_error(name, errno, error);
    if (request.ifr_hwaddr.sa_family != ARPHRD_CAN)
        return device_error(error, DPT_E_DEVICE, "%.20s is no CAN interface", name);
    if (ioctl(fd, SIOCGIFFLAGS, &request))
        return explain_error(name, errno, error);
    if (!(request.ifr_flags & IFF_UP))
        return explain_error(name, ENETDOWN, error);
    if (is_fd && (ioctl(fd, SIOCGIFMTU, &request) || request.ifr_mtu < (int)CANFD_MTU))
        return device_error(
            error, DPT_E_DEVICE,
            "%.20s has no CAN-FD, which moteus needs: sudo ip link set %.20s up type can bitrate 1000000 "
            "dbitrate 5000000 fd on (vcan: mtu 72)",
            name, name);
    if (set_options(fd, wanted, count, is_fd) || bind(fd, (const struct sockaddr *)&address, sizeof address))
        return explain_error(name, errno, error);
    return DPT_OK;
}

/* Note what a failed call says about the interface. */
static void note_failure(struct socketcan *socketcan, int reason)
{
    switch (reason) {
    case EAGAIN:
    case EINTR:
    case ENOBUFS:
    case ENOMEM:
        break;
    case ENETDOWN:
        socketcan->is_down = 1;
        break;
    default:
        socketcan->is_gone = 1;
    }
}

static void take_error_frame(struct socketcan *socketcan, const struct canfd_frame *frame)
{
    if (frame->can_id & CAN_ERR_RESTARTED)
        socketcan->is_bus_off = socketcan->is_error_passive = 0;
    if (frame->can_id & CAN_ERR_BUSOFF)
        socketcan->is_bus_off = 1;
    if (frame->can_id & CAN_ERR_CRTL) {
        const uint8_t state = frame->data[1];
        if (state & (CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE))
            socketcan->is_error_passive = 1;
        else if (state & (CAN_ERR_CRTL_ACTIVE | CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING))
            socketcan->is_error_passive = 0;
        if (state & CAN_ERR_CRTL_RX_OVERFLOW)
            socketcan->overruns++;
    }
}

/* Find the attribute of this kind among `bytes` of attributes; NULL if there is none. */
static const struct rtattr *find_attribute(const struct rtattr *at, size_t bytes, unsigned kind)
{
    size_t left = bytes;
    while (left >= sizeof *at && at->rta_len >= sizeof *at && at->rta_len <= left) {
        if ((at->rta_type & NLA_TYPE_MASK) == kind)
            return at;
        const size_t step = RTA_ALIGN(at->rta_len);
        if (step > left)
            break;
        left -= step;
        at = (const struct rtattr *)(const void *)((const char *)at + step);
    }
    return NULL;
}

static const struct rtattr *within_attribute(const struct rtattr *at, unsigned kind)
{
    return at ? find_attribute(RTA_DATA(at), RTA_PAYLOAD(at), kind) : NULL;
}

static void take_link_state(struct socketcan *socketcan, const struct nlmsghdr *head, size_t size)
{
    const size_t before = NLMSG_LENGTH(sizeof(struct ifinfomsg));
    if (size < before || head->nlmsg_type != RTM_NEWLINK)
        return;
    const struct rtattr *info =
        find_attribute((const void *)((const char *)head + NLMSG_ALIGN(before)), size - before, IFLA_LINKINFO);
    const struct rtattr *kind = within_attribute(info, IFLA_INFO_KIND);
    /* The kind may be sent with or without its final zero. */
    if (!kind || RTA_PAYLOAD(kind) < 3 || RTA_PAYLOAD(kind) > 4 || memcmp(RTA_DATA(kind), "can", RTA_PAYLOAD(kind)))
        return;
    const struct rtattr *data = within_attribute(info, IFLA_INFO_DATA);
    const struct rtattr *state = within_attribute(data, IFLA_CAN_STATE);
    const struct rtattr *timing = within_attribute(data, IFLA_CAN_BITTIMING);
    uint32_t bus_state = CAN_STATE_ERROR_ACTIVE;
    struct can_bittiming bits;
    if (state && RTA_PAYLOAD(state) >= sizeof bus_state) {
        memcpy(&bus_state, RTA_DATA(state), sizeof bus_state);
        socketcan->is_error_passive = bus_state == CAN_STATE_ERROR_PASSIVE;
        socketcan->is_bus_off = bus_state == CAN_STATE_BUS_OFF;
    }
    if (timing && RTA_PAYLOAD(timing) >= sizeof bits) {
        memcpy(&bits, RTA_DATA(timing), sizeof bits);
        socketcan->bitrate = bits.bitrate;
    }
    const struct rtattr *data_timing = within_attribute(data, IFLA_CAN_DATA_BITTIMING);
    if (data_timing && RTA_PAYLOAD(data_timing) >= sizeof bits) {
        memcpy(&bits, RTA_DATA(data_timing), sizeof bits);
        socketcan->data_bitrate = bits.bitrate;
    }
}

void socketcan_query(struct socketcan *socketcan)
{
    struct {
        struct nlmsghdr head;
        struct ifinfomsg link;
    } request;
    union {
        struct nlmsghdr head;
        char bytes[8192];
    } answer;
    const int fd = socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE);
    if (fd < 0)
        return;
    memset(&request, 0, sizeof request);
    request.head.nlmsg_len = sizeof request;
    request.head.nlmsg_type = RTM_GETLINK;
    request.head.nlmsg_flags = NLM_F_REQUEST;
    request.link.ifi_index = socketcan->index;
    struct pollfd waiting = { fd, POLLIN, 0 };
    if (send(fd, &request, sizeof request, MSG_DONTWAIT) == (ssize_t)sizeof request && poll(&waiting, 1, 100) > 0) {
        const ssize_t size = recv(fd, &answer, sizeof answer, MSG_DONTWAIT);
        if (size >= (ssize_t)sizeof answer.head)
            take_link_state(socketcan, &answer.head, (size_t)size);
    }
    close(fd);
}

dpt_result socketcan_open(struct socketcan *socketcan, const char *name, const struct can_wanted *wanted, int count,
                          int is_fd, dpt_device_error *error)
{
    memset(socketcan, 0, sizeof *socketcan);
    socketcan->fd = -1;
    if (!name[0] || strlen(name) >= IFNAMSIZ)
        return device_error(error, DPT_E_SETTING, "'%.20s' is no name of an interface, as can0 is", name);
    const int fd = socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW);
    if (fd < 0)
        return explain_error(name, errno, error);
    const dpt_result result = attach(socketcan, fd, name, wanted, count, is_fd, error);
    if (result == DPT_OK) {
        socketcan->fd = fd;
        socketcan_query(socketcan);
    } else {
        close(fd);
    }
    return result;
}

/* The control data of a frame, aligned as the system requires. */
#define CONTROL_BYTES (CMSG_SPACE(sizeof(struct timespec)) + CMSG_SPACE(sizeof(uint32_t)))
#define CONTROL_WORDS ((CONTROL_BYTES + 7) / 8)

/* Returns when a frame came, on the monotonic clock, and updates the count of dropped frames. */
static uint64_t read_control(struct socketcan *socketcan, struct msghdr *header, uint64_t now, uint64_t wall)
{
    uint64_t time = now;
    for (struct cmsghdr *at = CMSG_FIRSTHDR(header); at; at = CMSG_NXTHDR(header, at)) {
        if (at->cmsg_level != SOL_SOCKET)
            continue;
        if (at->cmsg_type == SO_RXQ_OVFL) {
            uint32_t dropped;
            memcpy(&dropped, CMSG_DATA(at), sizeof dropped);
            if ((int32_t)(dropped - socketcan->dropped) > 0)
                socketcan->dropped = dropped;
        } else if (at->cmsg_type == SO_TIMESTAMPNS) {
            struct timespec timestamp;
            memcpy(&timestamp, CMSG_DATA(at), sizeof timestamp);
            const uint64_t stamped = (uint64_t)timestamp.tv_sec * 1000000000u + (uint64_t)timestamp.tv_nsec;
            /* The time of day may have been set meanwhile: ignore an impossible age. */
            if (stamped < wall && wall - stamped < 1000000000u)
                time = now - (wall - stamped);
        }
    }
    return time;
}

int socketcan_receive(struct socketcan *socketcan, struct can_message *messages)
{
    struct canfd_frame frames[SOCKETCAN_BATCH];
    struct iovec parts[SOCKETCAN_BATCH];
    struct mmsghdr headers[SOCKETCAN_BATCH];
    uint64_t controls[SOCKETCAN_BATCH][CONTROL_WORDS];
    socketcan->is_drained = 1;
    if (socketcan->fd < 0 || socketcan->is_gone)
        return 0;
    memset(headers, 0, sizeof headers);
    for (int i = 0; i < SOCKETCAN_BATCH; i++) {
        parts[i].iov_base = &frames[i];
        parts[i].iov_len = sizeof frames[i];
        headers[i].msg_hdr.msg_iov = &parts[i];
        headers[i].msg_hdr.msg_iovlen = 1;
        headers[i].msg_hdr.msg_control = controls[i];
        headers[i].msg_hdr.msg_controllen = sizeof controls[i];
    }
    const int count = recvmmsg(socketcan->fd, headers, SOCKETCAN_BATCH, MSG_DONTWAIT, NULL);
    if (count < 0) {
        note_failure(socketcan, errno);
        return 0;
    }
    socketcan->is_drained = count < SOCKETCAN_BATCH;
    const uint64_t wall = clock_wall(), now = clock_now();
    int received = 0;
    for (int i = 0; i < count; i++) {
        /* A classic frame begins like one of CAN-FD. */
        const struct canfd_frame *frame = &frames[i];
        const int is_fd = headers[i].msg_len == CANFD_MTU;
        const uint64_t time = read_control(socketcan, &headers[i].msg_hdr, now, wall);
        if ((!is_fd && headers[i].msg_len != CAN_MTU) || frame->len > (is_fd ? CANFD_MAX_DLEN : CAN_MAX_DLEN))
            continue;
        if (frame->can_id & CAN_ERR_FLAG) {
            take_error_frame(socketcan, frame);
            continue;
        }
        struct can_message *message = &messages[received++];
        message->time_ns = time;
        const int is_extended = (frame->can_id & CAN_EFF_FLAG) != 0;
        message->id = frame->can_id & (is_extended ? CAN_EFF_MASK : CAN_SFF_MASK);
        message->size = frame->len;
        message->flags = (uint8_t)((frame->can_id & CAN_RTR_FLAG ? CAN_MESSAGE_REMOTE : 0) |
                                   (headers[i].msg_hdr.msg_flags & MSG_CONFIRM ? CAN_MESSAGE_OWN : 0) |
                                   (is_extended ? CAN_MESSAGE_EXTENDED : 0) | (is_fd ? CAN_MESSAGE_FD : 0));
        memset(message->data, 0, sizeof message->data);
        memcpy(message->data, frame->data, is_fd ? CANFD_MAX_DLEN : CAN_MAX_DLEN);
    }
    return received;
}

int socketcan_send(struct socketcan *socketcan, const struct can_message *messages, int count)
{
    struct canfd_frame frames[SOCKETCAN_BATCH];
    struct iovec parts[SOCKETCAN_BATCH];
    struct mmsghdr headers[SOCKETCAN_BATCH];
    if (socketcan->fd < 0 || socketcan->is_gone || count <= 0)
        return 0;
    memset(headers, 0, sizeof headers);
    memset(frames, 0, sizeof frames);
    for (int i = 0; i < count; i++) {
        const int is_fd = (messages[i].flags & CAN_MESSAGE_FD) != 0;
        frames[i].can_id = messages[i].id | (messages[i].flags & CAN_MESSAGE_REMOTE ? CAN_RTR_FLAG : 0) |
                           (messages[i].flags & CAN_MESSAGE_EXTENDED ? CAN_EFF_FLAG : 0);
        frames[i].len = messages[i].size;
        frames[i].flags = is_fd ? CANFD_BRS : 0;
        memcpy(frames[i].data, messages[i].data, sizeof frames[i].data);
        parts[i].iov_base = &frames[i];
        parts[i].iov_len = is_fd ? CANFD_MTU : CAN_MTU;
        headers[i].msg_hdr.msg_iov = &parts[i];
        headers[i].msg_hdr.msg_iovlen = 1;
    }
    const int sent = sendmmsg(socketcan->fd, headers, (unsigned)count, MSG_DONTWAIT);
    if (sent < 0)
        note_failure(socketcan, errno);
    return sent > 0 ? sent : 0;
}

void socketcan_wait(const struct socketcan *socketcan, uint64_t deadline)
{
    const uint64_t now = clock_now();
    const uint64_t left = deadline > now ? (deadline - now) / 1000000 + 1 : 0;
    struct pollfd waiting = { socketcan->fd, POLLIN, 0 };
    poll(&waiting, 1, left < 20 ? (int)left : 20);
}

void socketcan_close(struct socketcan *socketcan)
{
    if (socketcan->fd >= 0)
        close(socketcan->fd);
    socketcan->fd = -1;
}

void socketcan_find(void (*found)(void *user, const char *name, const char *about), void *user)
{
    DIR *folder = opendir("/sys/class/net");
    if (!folder)
        return;
    for (const struct dirent *entry; (entry = readdir(folder));) {
        char path[300];
        int type = 0;
        snprintf(path, sizeof path, "/sys/class/net/%s/type", entry->d_name);
        FILE *file = entry->d_name[0] == '.' ? NULL : fopen(path, "r");
        if (file && fscanf(file, "%d", &type) == 1 && type == ARPHRD_CAN)
            found(user, entry->d_name, "CAN interface; settings are needed: ?arm=FILE.dpa&gear=...");
        if (file)
            fclose(file);
    }
    closedir(folder);
}

#else

dpt_result socketcan_open(struct socketcan *socketcan, const char *name, const struct can_wanted *wanted, int count,
                          int is_fd, dpt_device_error *error)
{
    (void)name, (void)wanted, (void)count, (void)is_fd;
    socketcan->fd = -1;
    return device_error(error, DPT_E_ABSENT, "SocketCAN is a part of Linux alone");
}

void socketcan_query(struct socketcan *socketcan)
{
    (void)socketcan;
}

int socketcan_receive(struct socketcan *socketcan, struct can_message *messages)
{
    (void)socketcan, (void)messages;
    return 0;
}

int socketcan_send(struct socketcan *socketcan, const struct can_message *messages, int count)
{
    (void)socketcan, (void)messages, (void)count;
    return 0;
}

void socketcan_wait(const struct socketcan *socketcan, uint64_t deadline)
{
    (void)socketcan, (void)deadline;
}

void socketcan_close(struct socketcan *socketcan)
{
    (void)socketcan;
}

void socketcan_find(void (*found)(void *user, const char *name, const char *about), void *user)
{
    (void)found, (void)user;
}

#endif
