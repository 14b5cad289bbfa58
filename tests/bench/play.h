/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A motion of a tool and of a body's vertices, played through each of our methods, one method after the other, each
 * with a world of its own. What peers get (README.md here) is the same bit for bit: all bodies stand in the world's
 * frame.
 *
 *   exact    until track, contact and respond (with the proxy's force)
 *   paper-K  the dynamic point in K parts: until track, and until respond with the paper's force
 *   brute    every triangle: until track, and until respond with the paper's force
 */
#ifndef DPT_BENCH_PLAY_H
#define DPT_BENCH_PLAY_H

#include <stdio.h>

#include "dynpoint.h"

enum { PLAY_BODIES = 8 };

struct play {
    const char *name; /* begins each row, and the names of files */
    const dpt_mesh *mesh[PLAY_BODIES];
    int bodies;
    int with_brute;
    double radius;      /* of the tool */
    const double *ends; /* 6 numbers a tick: the tool's ends a and b */
    int ticks;
    /* The positions of all vertices of the first body in a tick; NULL: no vertex moves. */
    const float *(*positions)(void *self, int tick);
    void *self;
    const float *first; /* where MESH.tri has the first body's vertices; NULL: where its mesh has them */
};

/*
 * Prints rows `name,method,until,ticks,positions,step,step_p99`: medians and 99 % in ns, the first tick left out;
 * `positions` is how long dpt_body_set_vertices took, 0 where no vertex moves. Of each method the answers until track
 * go to the file DIR/NAME.METHOD.csv: tick, distance, and triangle as MESH.tri has it. Ends the program on any failure.
 */
void play_all(const struct play *play, FILE *rows, const char *dir);

/*
 * For the peers: DIR/NAME.tri, all bodies as one mesh, and DIR/NAME.csv, the trace. play_write_motion writes
 * DIR/NAME.motion, where vertices move (vertex_motion.h).
 */
void play_write(const struct play *play, const char *dir);
void play_write_motion(const struct play *play, const char *dir);

#endif
