/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The paper's Figure 10: one mesh, a torus of the paper's sizes as a rule, rigid and deforming.
 *
 *     tori MESH.dpa TRACE.csv NAME DIR [MOTION STEP]     prints rows as play.h has them; writes what the peers need
 *
 * The trace moves the tool. With MOTION and STEP, of vertex_motion.h, every vertex moves in each tick.
 */
#include "bench/plain_files.h"
#include "bench/play.h"
#include "bench/vertex_motion.h"

enum { TICKS_MAX = 20000 };

static const float *moved(void *self, int tick)
{
    struct vertex_motion *motion = self;
    vertex_motion_at(motion, (size_t)tick);
    return motion->positions;
}

int main(int argc, char **argv)
{
    struct vertex_motion motion;
    const float *rest;
    uint32_t vertices;
    size_t ticks;
    if (argc != 5 && argc != 7)
        plain_fail("tori", "MESH.dpa TRACE.csv NAME DIR [MOTION STEP] are needed");
    const dpt_mesh *mesh = plain_open_mesh(argv[1]);
    double *trace = plain_read_trace(argv[2], TICKS_MAX, &ticks);
    struct play play = { .name = argv[3], .mesh = { mesh }, .bodies = 1, .ends = trace, .ticks = (int)ticks };
    dpt_mesh_get_vertices(mesh, &rest, &vertices);
    if (argc == 7) {
        if (!vertex_motion_open(&motion, argv[5], atof(argv[6]), rest, vertices, trace))
            plain_fail("tori", "no such motion");
        play.positions = moved;
        play.self = &motion;
    }
    play_write(&play, argv[4]);
    play_all(&play, stdout, argv[4]);
    if (argc == 7)
        vertex_motion_close(&motion);
    free(trace);
    return 0;
}
