/* SPDX-License-Identifier: BSD-3-Clause */
#define _GNU_SOURCE
#include "vm/slcan.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/can.h>
#include <linux/sockios.h>
#include <linux/tty.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include "vm/net.h"

/* Length of a frame's line in `line`, ended by \r. */
static size_t spell(char line[SLCAN_LINE], const struct can_frame *frame)
{
    const int remote = (frame->can_id & CAN_RTR_FLAG) != 0;
    const int extended = (frame->can_id & CAN_EFF_FLAG) != 0;
    int size = snprintf(line, SLCAN_LINE, extended ? "%c%08X%u" : "%c%03X%u", "tTrR"[2 * remote + extended],
                        frame -> can_id &(extended ? CAN_EFF_MASK : CAN_SFF_MASK), frame -> can_dlc);
    for (int i = 0; i < frame->can_dlc && !remote; i++)
        size += snprintf(line + size, (size_t)(SLCAN_LINE - size), "%02X", frame->data[i]);
    line[size] = '\r';
    return (size_t)size + 1;
}

/* Whether it is a frame's. */
static int parse(const char *line, struct can_frame *frame)
{
    const char *kind = *line ? strchr("tTrR", *line) : NULL;
    if (!kind)
        return 0;
    const size_t digits = *line == 'T' || *line == 'R' ? 8 : 3;
    const int remote = *line == 'r' || *line == 'R';
    char number[9] = "";
    memset(frame, 0, sizeof *frame);
    if (strlen(line) < digits + 2)
        return 0;
    memcpy(number, line + 1, digits);
    frame->can_id = (canid_t)strtoul(number, NULL, 16) | (digits == 8 ? CAN_EFF_FLAG : 0) | (remote ? CAN_RTR_FLAG : 0);
    frame->can_dlc = (uint8_t)(line[digits + 1] - '0');
    if (frame->can_dlc > 8 || strlen(line) != digits + 2 + (remote ? 0u : 2u * frame->can_dlc))
        return 0;
    for (int i = 0; i < frame->can_dlc && !remote; i++) {
        memcpy(number, line + digits + 2 + 2 * i, 2);
        number[2] = 0;
        frame->data[i] = (uint8_t)strtoul(number, NULL, 16);
    }
    return 1;
}

static void put(struct slcan *adapter, const char *bytes, size_t size)
{
    pthread_mutex_lock(&adapter->saying);
    while (size > 0) {
        const ssize_t count = write(adapter->master, bytes, size);
        if (count < 0 && errno != EAGAIN && errno != EINTR)
            break;
        bytes += count > 0 ? count : 0;
        size -= count > 0 ? (size_t)count : 0;
    }
    pthread_mutex_unlock(&adapter->saying);
}

static void heard(struct slcan *adapter, const char *line)
{
    struct can_frame frame;
    if (parse(line, &frame)) {
        adapter->lost += write(adapter->far, &frame, sizeof frame) < 0;
        return;
    }
    pthread_mutex_lock(&adapter->saying);
    const size_t used = strlen(adapter->commands);
    snprintf(adapter->commands + used, sizeof adapter->commands - used, "%s ", line);
    pthread_mutex_unlock(&adapter->saying);
}

static void *pump(void *user)
{
    struct slcan *adapter = user;
    char line[SLCAN_LINE], out[SLCAN_LINE], in[4096], command;
    size_t size = 0;
    int hanging = 0;
    for (;;) {
        struct pollfd ways[3] = { { .fd = adapter->control[1], .events = POLLIN },
                                  { .fd = adapter->far, .events = POLLIN },
                                  { .fd = hanging ? -1 : adapter->master, .events = POLLIN } };
        struct can_frame frame;
        if (poll(ways, 3, -1) < 0)
            continue;
        if (ways[0].revents) {
            if (read(adapter->control[1], &command, 1) != 1 || command == 'q')
                return NULL;
            hanging = command == 'h';
            if (write(adapter->control[1], &command, 1) != 1)
                return NULL;
            continue;
        }
        if (ways[1].revents && read(adapter->far, &frame, sizeof frame) == sizeof frame)
            put(adapter, out, spell(out, &frame));
        const ssize_t count = ways[2].revents ? read(adapter->master, in, sizeof in) : 0;
        for (ssize_t i = 0; i < count; i++) {
            if (in[i] != '\r') {
                line[size] = in[i];
                size += size + 1 < sizeof line;
                continue;
            }
            line[size] = 0;
            size = 0;
            if (*line)
                heard(adapter, line);
        }
    }
}

static int attach(struct slcan *adapter)
{
    struct termios settings;
    const int discipline = N_SLCAN;
    const char *path = NULL;
    adapter->master = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (adapter->master >= 0 && !grantpt(adapter->master) && !unlockpt(adapter->master))
        path = ptsname(adapter->master);
    adapter->line = path ? open(path, O_RDWR | O_NOCTTY | O_CLOEXEC) : -1;
    if (adapter->line < 0 || tcgetattr(adapter->line, &settings))
        return errno;
    cfmakeraw(&settings);
    if (tcsetattr(adapter->line, TCSANOW, &settings) || ioctl(adapter->line, TIOCSETD, &discipline) ||
        ioctl(adapter->line, SIOCGIFNAME, adapter->name))
        return errno;
    return 0;
}

int slcan_plug(struct slcan *adapter, int bus)
{
    int pair[2] = { -1, bus };
    memset(adapter, 0, sizeof *adapter);
    adapter->bus = adapter->master = adapter->line = adapter->far = -1;
    pthread_mutex_init(&adapter->saying, NULL);
    const int kind = SOCK_CLOEXEC | SOCK_NONBLOCK;
    if ((bus < 0 && socketpair(AF_UNIX, SOCK_SEQPACKET | kind, 0, pair)) ||
        socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, adapter->control))
        return errno;
    adapter->bus = pair[0];
    adapter->far = pair[1];
    int result = attach(adapter);
    if (!result)
        result = pthread_create(&adapter->thread, NULL, pump, adapter);
    if (result) {
        const int all[] = { adapter->bus,  adapter->far,        adapter->master,
                            adapter->line, adapter->control[0], adapter->control[1] };
        for (size_t i = 0; i < sizeof all / sizeof *all; i++)
            if (all[i] >= 0)
                close(all[i]);
        return result;
    }
    result = net_set_bitrate(adapter->name, 1000000);
    result = result ? result : net_up(adapter->name);
    if (result)
        slcan_unplug(adapter);
    return result;
}

void slcan_unplug(struct slcan *adapter)
{
    struct net_state state;
    if (write(adapter->control[0], "q", 1) == 1)
        pthread_join(adapter->thread, NULL);
    close(adapter->master);
    close(adapter->line);
    while (net_query(adapter->name, &state) == 0)
        poll(NULL, 0, 1);
    close(adapter->control[0]);
    close(adapter->control[1]);
    close(adapter->far);
    if (adapter->bus >= 0)
        close(adapter->bus);
    pthread_mutex_destroy(&adapter->saying);
}

void slcan_say(struct slcan *adapter, const char *line)
{
    char bytes[SLCAN_LINE];
    const int size = snprintf(bytes, sizeof bytes, "%s\r", line);
    put(adapter, bytes, (size_t)size);
}

void slcan_commands(struct slcan *adapter, char commands[SLCAN_COMMANDS])
{
    pthread_mutex_lock(&adapter->saying);
    memcpy(commands, adapter->commands, SLCAN_COMMANDS);
    memset(adapter->commands, 0, SLCAN_COMMANDS);
    pthread_mutex_unlock(&adapter->saying);
}

void slcan_hang(struct slcan *adapter, int hang)
{
    char done;
    if (write(adapter->control[0], hang ? "h" : "g", 1) != 1 || read(adapter->control[0], &done, 1) != 1)
        perror("slcan_hang");
}
