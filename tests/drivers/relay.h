/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Stands in the line between a host and a device, both of them behind ptys, and passes frames on, or not: one that a
 * test drops, damages or holds back.
 */
#ifndef DPT_TESTS_RELAY_H
#define DPT_TESTS_RELAY_H

#define _GNU_SOURCE
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <termios.h>
#include <unistd.h>

#include "serial/wire.h"

enum { RELAY_HELD = 256, RELAY_DROP = -1, RELAY_PASS = 0 };

struct relay_frame {
    int due;
    size_t size;
    uint8_t bytes[WIRE_FRAME_MAX];
};

/* One direction. `fate` says RELAY_DROP, RELAY_PASS, or for how many turns the frame is held; it may change its bytes. */
struct relay_way {
    int from, to;
    int (*fate)(struct relay_way *way, uint8_t *frame, size_t size);
    void (*delivered)(struct relay_way *way, const uint8_t *frame, size_t size);
    int turn, holding;
    size_t size;
    uint8_t bytes[4 * WIRE_FRAME_MAX];
    struct relay_frame held[RELAY_HELD];
};

/* Passed if the line has room; a frame that has none is dropped as a whole, or the test's fault. */
static inline void relay_deliver(struct relay_way *way, const uint8_t *frame, size_t size)
{
    if (write(way->to, frame, size) == (ssize_t)size && way->delivered)
        way->delivered(way, frame, size);
}

/* One turn: what was held long enough, then what has come. */
static inline void relay_turn(struct relay_way *way)
{
    uint8_t in[4096];
    way->turn++;
    for (int i = 0; i < way->holding; i++)
        if (way->held[i].due <= way->turn) {
            relay_deliver(way, way->held[i].bytes, way->held[i].size);
            way->holding--;
            memmove(&way->held[i], &way->held[i + 1], (size_t)(way->holding - i) * sizeof way->held[0]);
            i--;
        }
    for (ssize_t count; (count = read(way->from, in, sizeof in)) > 0;)
        for (ssize_t k = 0; k < count; k++) {
            if (way->size < sizeof way->bytes)
                way->bytes[way->size++] = in[k];
            if (in[k] != 0)
                continue;
            const int turns = way->fate ? way->fate(way, way->bytes, way->size) : RELAY_PASS;
            if (turns == RELAY_PASS || (turns > 0 && way->size > WIRE_FRAME_MAX)) {
                relay_deliver(way, way->bytes, way->size);
            } else if (turns > 0 && way->holding < RELAY_HELD) {
                struct relay_frame *held = &way->held[way->holding++];
                held->due = way->turn + turns;
                held->size = way->size;
                memcpy(held->bytes, way->bytes, way->size);
            }
            way->size = 0;
        }
}

/* A raw pty for the host to open; its name into `path`. The other end, which does not block, or -1. */
static inline int relay_pty(char path[64])
{
    struct termios settings;
    const int master = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
    const char *name = master >= 0 && !grantpt(master) && !unlockpt(master) ? ptsname(master) : NULL;
    if (!name || strlen(name) >= 64 || tcgetattr(master, &settings))
        return -1;
    strcpy(path, name);
    cfmakeraw(&settings);
    return tcsetattr(master, TCSANOW, &settings) ? -1 : master;
}

/* A pty of someone else's as a host opens it. */
static inline int relay_open(const char *path)
{
    struct termios settings;
    const int line = open(path, O_RDWR | O_NOCTTY | O_NONBLOCK);
    if (line < 0 || tcgetattr(line, &settings))
        return -1;
    cfmakeraw(&settings);
    settings.c_cc[VMIN] = 1;
    return tcsetattr(line, TCSANOW, &settings) ? -1 : line;
}

#endif
