/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A stand-in for the kernel's CAN, so that the driver is tested where there is none: the linker gives the system calls of the
 * line (drivers/can/socketcan.c) and its clock to this file. A bus in memory carries frames between sockets with filters, queues
 * that overflow, confirmations and timestamps as vcan's; the clock is simulated and goes on only while someone waits, a
 * millisecond at a time, of which `can_each_ms` is told.
 *
 * With $DPT_CAN, the name of an interface, the same calls go to the kernel, but for the clock, and timestamps that follow it:
 * so the same test runs on a real one (tests/vm). tests/vm/test_can_bus.c runs by the real clock, too.
 *
 * Either way a saboteur stands between the sockets and the bus: can_fate says of each frame that is sent what becomes of it.
 */
#ifndef DPT_TESTS_CAN_KERNEL_H
#define DPT_TESTS_CAN_KERNEL_H

#define _GNU_SOURCE
#include <errno.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <net/if_arp.h>
#include <poll.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

enum { CAN_SOCKETS = 8, CAN_QUEUE = 1024, CAN_HELD = 4096, CAN_FD = 4000, CAN_TICKS = 1024 };
enum { CAN_PASS = 0, CAN_DROP = -1 };

/* A classic frame begins like one of CAN-FD; `size` tells which it is. */
struct stand_in_frame {
    struct canfd_frame frame;
    size_t size;
    int flags;
    uint32_t dropped;
    uint64_t wall_ns;
};

struct stand_in {
    int is_open, is_bound, wants_own, wants_drops, wants_times, wants_fd;
    can_err_mask_t errors;
    struct can_filter filters[64];
    size_t filter_count, count;
    uint32_t dropped;
    int problem; /* that the next receive answers, once */
    struct stand_in_frame queue[CAN_QUEUE];
};

static const char *can_real; /* the interface, or NULL */
static struct stand_in can_socket_of[CAN_SOCKETS];
static uint64_t can_clock_ns = 5000000000u;
static uint64_t can_ticks, can_began_ns[CAN_TICKS]; /* of simulated milliseconds, the wall's clock */
static void (*can_each_ms)(void);
static int (*can_fate)(int fd, const struct can_frame *frame); /* CAN_PASS, CAN_DROP, ms to hold */
static size_t can_room = 278;                                  /* of a queue, as vcan's with the usual buffer */
static int can_is_down, can_is_gone, can_is_full, can_is_ethernet, can_is_classic, can_no_family;
static int can_spared = -1; /* the socket whose end of the bus is sound whatever the above say */
static void (*can_carried)(int fd, const struct can_frame *frame); /* told of what is on the bus */
static int can_held_open;                                          /* sockets and files that are open */

/* Calls while `can_watched`: counted, and the one of number `can_fail_at` fails with can_fail_errno. */
static int can_watched, can_calls, can_fail_at, can_fail_errno;

static struct {
    int fd;
    uint64_t due_ns;
    size_t size;
    struct canfd_frame frame;
} can_held[CAN_HELD];
static size_t can_holding;

int __real_socket(int domain, int type, int protocol);
int __real_bind(int fd, const struct sockaddr *address, socklen_t size);
int __real_setsockopt(int fd, int level, int name, const void *value, socklen_t size);
int __real_ioctl(int fd, unsigned long request, ...);
int __real_recvmmsg(int fd, struct mmsghdr *headers, unsigned count, int flags, struct timespec *timeout);
int __real_sendmmsg(int fd, struct mmsghdr *headers, unsigned count, int flags);
int __real_poll(struct pollfd *lines, nfds_t count, int timeout);
int __real_close(int fd);
int __real_clock_gettime(clockid_t clock, struct timespec *now);
void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
FILE *__real_fopen(const char *path, const char *mode);
size_t __real_fread(void *to, size_t size, size_t count, FILE *file);

int __wrap_socket(int domain, int type, int protocol);
int __wrap_bind(int fd, const struct sockaddr *address, socklen_t size);
int __wrap_setsockopt(int fd, int level, int name, const void *value, socklen_t size);
int __wrap_ioctl(int fd, unsigned long request, ...);
int __wrap_recvmmsg(int fd, struct mmsghdr *headers, unsigned count, int flags, struct timespec *timeout);
int __wrap_sendmmsg(int fd, struct mmsghdr *headers, unsigned count, int flags);
int __wrap_poll(struct pollfd *lines, nfds_t count, int timeout);
int __wrap_close(int fd);
int __wrap_clock_gettime(clockid_t clock, struct timespec *now);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
FILE *__wrap_fopen(const char *path, const char *mode);
size_t __wrap_fread(void *to, size_t size, size_t count, FILE *file);

static int can_fails(void)
{
    if (!can_watched || ++can_calls != can_fail_at)
        return 0;
    errno = can_fail_errno;
    return 1;
}

static int can_answer(int problem)
{
    errno = problem;
    return problem ? -1 : 0;
}

static struct stand_in *stand_in_of(int fd)
{
    return fd >= CAN_FD && fd < CAN_FD + CAN_SOCKETS ? &can_socket_of[fd - CAN_FD] : NULL;
}

/* The wall's clock is another one, and this far off. */
static uint64_t can_wall_ns = 1000000000000u;

int __wrap_clock_gettime(clockid_t clock, struct timespec *now)
{
    const uint64_t time = can_clock_ns + (clock == CLOCK_REALTIME ? can_wall_ns : 0);
    now->tv_sec = (time_t)(time / 1000000000u);
    now->tv_nsec = (long)(time % 1000000000u);
    return 0;
}

static int is_wanted(const struct stand_in *to, const struct can_frame *frame)
{
    if (frame->can_id & CAN_ERR_FLAG)
        return (frame->can_id & to->errors) != 0;
    for (size_t i = 0; i < to->filter_count; i++)
        if (!((frame->can_id ^ to->filters[i].can_id) & to->filters[i].can_mask))
            return 1;
    return 0;
}

/* A frame is on the bus: all sockets get it, the sender its own as a confirmation. */
static void bus_carries(const struct stand_in *from, const struct can_frame *frame, size_t size)
{
    for (struct stand_in *to = can_socket_of; to < can_socket_of + CAN_SOCKETS; to++) {
        if (!to->is_bound || !is_wanted(to, frame) || (to == from && !to->wants_own) ||
            (size == CANFD_MTU && !to->wants_fd))
            continue;
        if (to->count >= can_room) {
            to->dropped++;
            continue;
        }
        struct stand_in_frame arrived = { .size = size,
                                                .flags = MSG_DONTROUTE | (to == from ? MSG_CONFIRM : 0),
                                                .dropped = to->dropped,
                                                .wall_ns = can_clock_ns + can_wall_ns };
        memcpy(&arrived.frame, frame, size);
        to->queue[to->count++] = arrived;
    }
}

static int put_on_bus(int fd, const struct can_frame *frame, size_t size)
{
    if (can_carried)
        can_carried(fd, frame);
    if (stand_in_of(fd)) {
        bus_carries(stand_in_of(fd), frame, size);
        return 0;
    }
    struct iovec part = { (void *)(uintptr_t)frame, size };
    struct mmsghdr header = { .msg_hdr = { .msg_iov = &part, .msg_iovlen = 1 } };
    return __real_sendmmsg(fd, &header, 1, MSG_DONTWAIT) == 1 ? 0 : -1;
}

/* A millisecond passes. */
static void can_tick(void)
{
    const int watched = can_watched;
    can_watched = 0;
    struct timespec began;
    __real_clock_gettime(CLOCK_REALTIME, &began);
    can_clock_ns += 1000000;
    can_ticks++;
    can_began_ns[can_ticks % CAN_TICKS] = (uint64_t)began.tv_sec * 1000000000u + (uint64_t)began.tv_nsec;
    for (size_t i = 0; i < can_holding; i++)
        if (can_held[i].due_ns <= can_clock_ns) {
            put_on_bus(can_held[i].fd, (const struct can_frame *)&can_held[i].frame, can_held[i].size);
            can_holding--;
            memmove(&can_held[i], &can_held[i + 1], (can_holding - i) * sizeof can_held[0]);
            i--;
        }
    if (can_each_ms)
        can_each_ms();
    can_watched = watched;
}

static const struct can_frame *frame_of(const struct mmsghdr *header)
{
    return header->msg_hdr.msg_iov->iov_base;
}

int __wrap_socket(int domain, int type, int protocol)
{
    if (can_fails())
        return -1;
    if (domain != PF_CAN || can_real) {
        const int fd = __real_socket(domain, type, protocol);
        can_held_open += can_watched && fd >= 0;
        return fd;
    }
    if (can_no_family)
        return can_answer(EAFNOSUPPORT);
    for (int i = 0; i < CAN_SOCKETS; i++)
        if (!can_socket_of[i].is_open) {
            memset(&can_socket_of[i], 0, sizeof can_socket_of[i]);
            can_socket_of[i].is_open = 1;
            can_held_open += can_watched;
            return CAN_FD + i;
        }
    return can_answer(EMFILE);
}

int __wrap_close(int fd)
{
    can_held_open -= can_watched;
    if (!stand_in_of(fd))
        return __real_close(fd);
    stand_in_of(fd)->is_open = stand_in_of(fd)->is_bound = 0;
    return 0;
}

int __wrap_bind(int fd, const struct sockaddr *address, socklen_t size)
{
    if (can_fails())
        return -1;
    if (!stand_in_of(fd))
        return __real_bind(fd, address, size);
    stand_in_of(fd)->is_bound = 1;
    return can_answer(0);
}

int __wrap_setsockopt(int fd, int level, int name, const void *value, socklen_t size)
{
    struct stand_in *to = stand_in_of(fd);
    if (can_fails())
        return -1;
    if (!to)
        return __real_setsockopt(fd, level, name, value, size);
    if (level == SOL_CAN_RAW && name == CAN_RAW_FILTER) {
        memcpy(to->filters, value, size);
        to->filter_count = size / sizeof to->filters[0];
    } else if (level == SOL_CAN_RAW && name == CAN_RAW_ERR_FILTER) {
        memcpy(&to->errors, value, sizeof to->errors);
    } else {
        int on;
        memcpy(&on, value, sizeof on);
        to->wants_fd |= level == SOL_CAN_RAW && name == CAN_RAW_FD_FRAMES && on;
        to->wants_own |= level == SOL_CAN_RAW && name == CAN_RAW_RECV_OWN_MSGS && on;
        to->wants_drops |= level == SOL_SOCKET && name == SO_RXQ_OVFL && on;
        to->wants_times |= level == SOL_SOCKET && name == SO_TIMESTAMPNS && on;
    }
    return can_answer(0);
}

int __wrap_ioctl(int fd, unsigned long request, ...)
{
    va_list arguments;
    va_start(arguments, request);
    void *argument = va_arg(arguments, void *);
    va_end(arguments);
    if (can_fails())
        return -1;
    if (!stand_in_of(fd))
        return __real_ioctl(fd, request, argument);
    struct ifreq *asked = argument;
    if (can_is_gone || strncmp(asked->ifr_name, "can0", 5))
        return can_answer(ENODEV);
    if (request == SIOCGIFINDEX)
        asked->ifr_ifindex = 3;
    else if (request == SIOCGIFHWADDR)
        asked->ifr_hwaddr.sa_family = can_is_ethernet ? ARPHRD_ETHER : ARPHRD_CAN;
    else if (request == SIOCGIFFLAGS)
        asked->ifr_flags = can_is_down ? 0 : IFF_UP;
    else if (request == SIOCGIFMTU)
        asked->ifr_mtu = can_is_classic ? (int)CAN_MTU : (int)CANFD_MTU;
    return can_answer(0);
}

static void put_control(struct msghdr *header, int type, const void *data, size_t size, size_t *used)
{
    union {
        struct cmsghdr head;
        char bytes[64];
    } part;
    memset(&part, 0, sizeof part);
    part.head.cmsg_level = SOL_SOCKET;
    part.head.cmsg_type = type;
    part.head.cmsg_len = CMSG_LEN(size);
    memcpy(CMSG_DATA(&part.head), data, size);
    memcpy((char *)header->msg_control + *used, &part, CMSG_SPACE(size));
    *used += CMSG_SPACE(size);
}

static void fill(const struct stand_in *from, const struct stand_in_frame *arrived, struct mmsghdr *header)
{
    struct timespec stamp;
    stamp.tv_sec = (time_t)(arrived->wall_ns / 1000000000u);
    stamp.tv_nsec = (long)(arrived->wall_ns % 1000000000u);
    size_t used = 0;
    memcpy(header->msg_hdr.msg_iov->iov_base, &arrived->frame, arrived->size);
    header->msg_len = (unsigned)arrived->size;
    header->msg_hdr.msg_flags = arrived->flags;
    if (from->wants_times)
        put_control(&header->msg_hdr, SO_TIMESTAMPNS, &stamp, sizeof stamp, &used);
    if (from->wants_drops && arrived->dropped)
        put_control(&header->msg_hdr, SO_RXQ_OVFL, &arrived->dropped, sizeof arrived->dropped, &used);
    header->msg_hdr.msg_controllen = used;
}

/* The kernel's stamp is of its clock: the last of our milliseconds that had begun by then. */
static void restamp(struct mmsghdr *header)
{
    for (struct cmsghdr *at = CMSG_FIRSTHDR(&header->msg_hdr); at; at = CMSG_NXTHDR(&header->msg_hdr, at)) {
        struct timespec stamp;
        if (at->cmsg_level != SOL_SOCKET || at->cmsg_type != SO_TIMESTAMPNS)
            continue;
        memcpy(&stamp, CMSG_DATA(at), sizeof stamp);
        const uint64_t stamped = (uint64_t)stamp.tv_sec * 1000000000u + (uint64_t)stamp.tv_nsec;
        uint64_t tick = can_ticks;
        while (tick > 0 && can_ticks - tick < CAN_TICKS - 1 && can_began_ns[tick % CAN_TICKS] > stamped)
            tick--;
        const uint64_t wall = can_clock_ns - (can_ticks - tick) * 1000000u + can_wall_ns;
        stamp.tv_sec = (time_t)(wall / 1000000000u);
        stamp.tv_nsec = (long)(wall % 1000000000u);
        memcpy(CMSG_DATA(at), &stamp, sizeof stamp);
    }
}

int __wrap_recvmmsg(int fd, struct mmsghdr *headers, unsigned count, int flags, struct timespec *timeout)
{
    struct stand_in *from = stand_in_of(fd);
    if (can_fails())
        return -1;
    if (!from) {
        const int taken = __real_recvmmsg(fd, headers, count, flags, timeout);
        for (int i = 0; i < taken; i++)
            restamp(&headers[i]);
        return taken;
    }
    if (from->problem) {
        const int problem = from->problem;
        from->problem = 0;
        return can_answer(problem);
    }
    size_t taken = 0;
    for (; taken < count && taken < from->count; taken++)
        fill(from, &from->queue[taken], &headers[taken]);
    from->count -= taken;
    memmove(from->queue, from->queue + taken, from->count * sizeof from->queue[0]);
    return taken ? (int)taken : can_answer(EAGAIN);
}

int __wrap_sendmmsg(int fd, struct mmsghdr *headers, unsigned count, int flags)
{
    (void)flags;
    if (can_fails())
        return -1;
    for (unsigned i = 0; i < count; i++) {
        const struct can_frame *frame = frame_of(&headers[i]);
        const size_t size = headers[i].msg_hdr.msg_iov->iov_len;
        const int problem = !stand_in_of(fd) || fd == can_spared ? 0
                            : can_is_gone                        ? ENXIO
                            : can_is_down                        ? ENETDOWN
                            : can_is_full                        ? ENOBUFS
                                                                 : 0;
        if (problem)
            return i ? (int)i : can_answer(problem);
        const int fate = can_fate ? can_fate(fd, frame) : CAN_PASS;
        if (fate > 0 && can_holding < CAN_HELD) {
            can_held[can_holding].fd = fd;
            can_held[can_holding].due_ns = can_clock_ns + (uint64_t)fate * 1000000u;
            can_held[can_holding].size = size;
            memcpy(&can_held[can_holding++].frame, frame, size);
        } else if (fate != CAN_DROP && put_on_bus(fd, frame, size)) {
            return i ? (int)i : -1;
        }
    }
    return (int)count;
}

int __wrap_poll(struct pollfd *lines, nfds_t count, int timeout)
{
    if (can_fails())
        return -1;
    for (int passed = 0;; passed++) {
        const struct stand_in *at = stand_in_of(lines->fd);
        const int is_there = at ? at->count > 0 || at->problem : __real_poll(lines, count, 0) > 0;
        if (is_there || passed >= timeout)
            return is_there;
        can_tick();
    }
}

void *__wrap_malloc(size_t size)
{
    return can_fails() ? NULL : __real_malloc(size);
}

void *__wrap_calloc(size_t count, size_t size)
{
    return can_fails() ? NULL : __real_calloc(count, size);
}

FILE *__wrap_fopen(const char *path, const char *mode)
{
    return can_fails() ? NULL : __real_fopen(path, mode);
}

size_t __wrap_fread(void *to, size_t size, size_t count, FILE *file)
{
    return can_fails() ? 0 : __real_fread(to, size, count, file);
}

/* An error frame, as the controller's driver makes it. */
static inline void bus_has_error(uint32_t classes, uint8_t state)
{
    const struct can_frame frame = { .can_id = CAN_ERR_FLAG | classes, .can_dlc = CAN_ERR_DLC, .data = { 0, state } };
    bus_carries(NULL, &frame, sizeof frame);
}

/* The interface was shut, or is gone: whoever listens is told so once. */
static inline void bus_fails(int problem)
{
    can_is_down = problem == ENETDOWN;
    can_is_gone = problem == ENODEV;
    for (int i = 0; problem && i < CAN_SOCKETS; i++)
        if (CAN_FD + i != can_spared) {
            can_socket_of[i].problem = problem;
            can_socket_of[i].count = 0;
        }
}

#endif
