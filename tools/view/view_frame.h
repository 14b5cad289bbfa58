/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A frame: what the viewer's page draws at one moment (docs/view.md, "Messages"). A header, a snapshot of the world, and
 * what the plots show of the ticks since the frame before. Little-endian.
 */
#ifndef DPT_TOOLS_VIEW_FRAME_H
#define DPT_TOOLS_VIEW_FRAME_H

#include <stddef.h>
#include <stdint.h>

enum { VIEW_HEADER_BYTES = 80, VIEW_TICK_BYTES = 40 };

struct view_frame_header {
    uint32_t snapshot_bytes, ticks; /* what follows */
    uint64_t number;                /* of the snapshots made, from 0 */
    uint64_t dropped;               /* snapshots that were not sent */
    uint64_t ticks_lost;            /* ticks of which the plots know nothing */
    double haptic_hz, physics_hz, view_hz;
    double late_p99, took_p99; /* of the last ticks, s */
};

/* One tick, for the plots. */
struct view_tick {
    double time;      /* of the world, s */
    float force;      /* N */
    float depth;      /* m: how far the device is in the surface */
    float energy;     /* J: that the law stores */
    float late, took; /* s */
    uint32_t contact; /* DPT_CONTACT_... */
    uint32_t reason;  /* DPT_FORCE_... */
};

/* The bytes of a frame with so much behind its header. */
size_t view_frame_bytes(size_t snapshot_bytes, size_t ticks);

/* Write VIEW_HEADER_BYTES, and VIEW_TICK_BYTES. */
void view_frame_put_header(const struct view_frame_header *header, unsigned char *to);
void view_frame_put_tick(const struct view_tick *tick, unsigned char *to);

#endif
