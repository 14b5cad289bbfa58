/* SPDX-License-Identifier: BSD-3-Clause */
/* CAN_RAW sockets for tests: bound by name, non-blocking, one frame at a time with all that the kernel says of it. */
#ifndef DPT_TESTS_VM_CAN_SOCKET_H
#define DPT_TESTS_VM_CAN_SOCKET_H

#include <errno.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <poll.h>
#include <stdint.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

/* A socket on interface `name`; -1 and errno. */
static inline int can_socket(const char *name)
{
    const int line = socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC | SOCK_NONBLOCK, CAN_RAW);
    const struct sockaddr_can address = { .can_family = AF_CAN, .can_ifindex = (int)if_nametoindex(name) };
    int problem = line < 0 ? errno : address.can_ifindex == 0 ? ENODEV : 0;
    if (!problem && bind(line, (const struct sockaddr *)&address, sizeof address))
        problem = errno;
    if (problem && line >= 0)
        close(line);
    errno = problem;
    return problem ? -1 : line;
}

static inline int can_option(int line, int option, int value)
{
    return setsockopt(line, SOL_CAN_RAW, option, &value, sizeof value);
}

static inline struct can_frame can_frame_of(canid_t id, unsigned size, uint64_t data)
{
    struct can_frame frame = { .can_id = id, .can_dlc = (uint8_t)size };
    for (unsigned i = 0; i < size && i < 8; i++)
        frame.data[i] = (uint8_t)(data >> 8 * i);
    return frame;
}

/* 0, or an errno. */
static inline int can_send(int line, const struct can_frame *frame)
{
    const ssize_t size = write(line, frame, sizeof *frame);
    return size == (ssize_t)sizeof *frame ? 0 : size < 0 ? errno : EIO;
}

struct can_heard {
    int problem; /* 0, or an errno: EAGAIN if there is no frame */
    struct can_frame frame;
    int flags;        /* MSG_CONFIRM: sent by this socket; MSG_DONTROUTE: on this machine */
    uint32_t dropped; /* by this socket so far, with SO_RXQ_OVFL; 0 if the kernel says nothing */
};

/* The next frame, if it comes within `wait` milliseconds. */
static inline struct can_heard can_next(int line, int wait)
{
    struct can_heard heard = { .problem = 0 };
    struct iovec place = { &heard.frame, sizeof heard.frame };
    uint64_t control[16];
    struct msghdr message = {
        .msg_iov = &place, .msg_iovlen = 1, .msg_control = control, .msg_controllen = sizeof control
    };
    struct pollfd ready = { .fd = line, .events = POLLIN };
    poll(&ready, 1, wait);
    const ssize_t size = recvmsg(line, &message, MSG_DONTWAIT);
    heard.problem = size == (ssize_t)sizeof heard.frame ? 0 : size < 0 ? errno : EIO;
    heard.flags = message.msg_flags;
    for (struct cmsghdr *part = CMSG_FIRSTHDR(&message); size >= 0 && part; part = CMSG_NXTHDR(&message, part))
        if (part->cmsg_level == SOL_SOCKET && part->cmsg_type == SO_RXQ_OVFL)
            memcpy(&heard.dropped, CMSG_DATA(part), sizeof heard.dropped);
    return heard;
}

#endif
