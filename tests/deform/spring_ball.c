/* SPDX-License-Identifier: BSD-3-Clause */
#include "deform/spring_ball.h"

#include "scene/shape.h"

static void compile_ball(struct ball *ball, uint32_t kind, uint64_t triangles, double spacing)
{
    dpt_spring_net_def net;
    dpt_compile_def def;
    struct shape shape;
    shape_reason reason;
    dpt_spring_net_def_init(&net);
    dpt_compile_def_init(&def);
    net.kind = kind;
    net.drag = 5.0;
    net.viscosity = 1e-3;
    net.spacing = spacing;
    def.springs = &net;
    CHECK(!shape_make("sphere", triangles, 0, &shape, reason), "%s", reason);
    CHECK(dpt_compile_arrays(shape.vertices, shape.vertex_count, shape.corners, shape.triangle_count, &def,
                             &ball->compiled, NULL) == DPT_OK,
          "not compiled");
    shape_free(&shape);
    CHECK(dpt_mesh_open(ball->compiled.bytes, ball->compiled.size, &ball->mesh) == DPT_OK, "bad");
}

int ball_open(struct ball *ball, uint32_t kind, uint64_t triangles, double spacing, uint32_t kernel)
{
    dpt_world_def world = rig_def(DPT_LAW_PROXY);
    dpt_deformable_def deform;
    dpt_springs_def springs;
    memset(ball, 0, sizeof *ball);
    dpt_deformable_def_init(&deform);
    dpt_springs_def_init(&springs);
    world.kernel = springs.kernel = kernel;
    if (!rig_has_kernel(kernel))
        return 0;
    compile_ball(ball, kind, triangles, spacing);
    deform.mesh = springs.mesh = ball->mesh;
    rig_open(&ball->rig, &world, NULL, NULL, 0);
    rig_add_deformable(&ball->rig, &deform);
    ball->springs = rig_add_springs(&ball->rig, &springs);
    return 1;
}

void ball_close(struct ball *ball)
{
    dpt_compiled_free(&ball->compiled);
    rig_close(&ball->rig);
}

void ball_step(struct ball *ball, dpt_springs_info *report)
{
    const dpt_result result = dpt_body_step_springs(ball->rig.world, ball->rig.body, ball->springs, 1e-3, report);
    CHECK(result == DPT_OK, "%s", dpt_result_name(result));
}
