/* SPDX-License-Identifier: BSD-3-Clause */
/* A deformable ball of springs in a world without tools. */
#ifndef DPT_TESTS_SPRING_BALL_H
#define DPT_TESTS_SPRING_BALL_H

#include "dynpoint/compile.h"
#include "lib/rig.h"

struct ball {
    dpt_compiled compiled;
    const dpt_mesh *mesh;
    struct rig rig;
    dpt_springs *springs;
};

/* kind: DPT_NET_...; spacing: of a volume, m. Returns 0 if this machine does not have the kernel. */
int ball_open(struct ball *ball, uint32_t kind, uint64_t triangles, double spacing, uint32_t kernel);
void ball_close(struct ball *ball);

/* One step of 1 ms of the springs; `report` is filled in. */
void ball_step(struct ball *ball, dpt_springs_info *report);

#endif
