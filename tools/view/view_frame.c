/* SPDX-License-Identifier: BSD-3-Clause */
#include "view/view_frame.h"

#include <string.h>

static unsigned char *put4(unsigned char *to, uint32_t value)
{
    for (uint32_t i = 0; i < 4; i++)
        to[i] = (unsigned char)(value >> 8 * i);
    return to + 4;
}

static unsigned char *put8(unsigned char *to, uint64_t value)
{
    for (uint32_t i = 0; i < 8; i++)
        to[i] = (unsigned char)(value >> 8 * i);
    return to + 8;
}

static unsigned char *put_double(unsigned char *to, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return put8(to, bits);
}

static unsigned char *put_float(unsigned char *to, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return put4(to, bits);
}

size_t view_frame_bytes(size_t snapshot_bytes, size_t ticks)
{
    return VIEW_HEADER_BYTES + snapshot_bytes + ticks * VIEW_TICK_BYTES;
}

void view_frame_put_header(const struct view_frame_header *header, unsigned char *to)
{
    to = put4(to, 2); /* the kind: a frame */
    to = put4(to, header->snapshot_bytes);
    to = put4(to, header->ticks);
    to = put4(to, 0);
    to = put8(to, header->number);
    to = put8(to, header->dropped);
    to = put8(to, header->ticks_lost);
    to = put_double(to, header->haptic_hz);
    to = put_double(to, header->physics_hz);
    to = put_double(to, header->view_hz);
    to = put_double(to, header->late_p99);
    put_double(to, header->took_p99);
}

void view_frame_put_tick(const struct view_tick *tick, unsigned char *to)
{
    to = put_double(to, tick->time);
    to = put_float(to, tick->force);
    to = put_float(to, tick->depth);
    to = put_float(to, tick->energy);
    to = put_float(to, tick->late);
    to = put_float(to, tick->took);
    to = put4(to, tick->contact);
    to = put4(to, tick->reason);
    put4(to, 0);
}
