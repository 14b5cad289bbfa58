/* SPDX-License-Identifier: BSD-3-Clause */
#include "lab/spring_body.h"

#include <stdlib.h>

int spring_body_open(struct spring_body *body, dpt_world *world)
{
    dpt_deformable_def deform;
    dpt_springs_def springs;
    dpt_deformable_def_init(&deform);
    dpt_springs_def_init(&springs);
    deform.mesh = springs.mesh = body->mesh;
    deform.load_radius = body->load_radius;
    springs.integrator = body->integrator;
    body->world = world;
    body->block = malloc(dpt_deformable_bytes(&deform));
    body->springs_block = malloc(dpt_springs_bytes(&springs));
    return body->block && body->springs_block &&
           dpt_body_add_deformable(world, body->block, dpt_deformable_bytes(&deform), &deform, &body->body) == DPT_OK &&
           dpt_springs_create(body->springs_block, dpt_springs_bytes(&springs), &springs, &body->springs) == DPT_OK;
}

void spring_body_close(struct spring_body *body)
{
    free(body->block);
    free(body->springs_block);
    body->block = body->springs_block = NULL;
}

void spring_body_step(struct spring_body *body, double dt)
{
    dpt_springs_info report = { .size = sizeof report };
    if (!body->is_free)
        return;
    if (dpt_body_step_springs(body->world, body->body, body->springs, dt, &report) != DPT_OK)
        body->has_failed = 1;
    body->held += (report.flags & DPT_SPRINGS_FLAG_HELD) != 0;
    body->nodes += report.nodes;
    body->active += report.active;
}

double spring_body_energy(const struct spring_body *body)
{
    double elastic = 0.0, kinetic = 0.0;
    dpt_springs_get_energy(body->springs, &elastic, &kinetic);
    return elastic + kinetic;
}
