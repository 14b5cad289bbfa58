/* SPDX-License-Identifier: BSD-3-Clause */
#include "track/budget_scene.h"

#if defined(__SANITIZE_ADDRESS__)
uint32_t budget_ticks = 20;
#else
uint32_t budget_ticks = 160;
#endif

const struct scene budget_scenes[SCENES] = { { 1, 1, 0 }, { 5, 1, 1 },  { 12, 1, 0 },
                                             { 1, 3, 0 }, { 5, 40, 1 }, { 12, 3, 0 } };

struct fixture budget_mesh, small_mesh;

double random_signed(uint64_t *random)
{
    return random_in(random, -1.0, 1.0);
}

/* A small turn, from any q to one of unit length. */
static void turn_a_little(dpt_pose *pose, const double turn[3])
{
    double *q = pose->orientation, old[4], size = 0.0;
    memcpy(old, q, sizeof old);
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        q[0] -= turn[k] * old[k + 1];
        q[k + 1] += turn[k] * old[0] + turn[i] * old[j + 1] - turn[j] * old[i + 1];
    }
    for (int k = 0; k < 4; k++)
        size += q[k] * q[k];
    for (int k = 0; k < 4; k++)
        q[k] /= sqrt(size);
}

void input_set_tool(struct budget_input *input)
{
    input->moved = 0.0;
    for (uint32_t i = 0; i < input->scene->segments; i++) {
        const dpt_segment next = pose_segment(&input->pose, &input->own[i]);
        input->moved = fmax(input->moved, apart(next.a, input->now[i].a));
        input->moved = fmax(input->moved, apart(next.b, input->now[i].b));
        input->now[i] = next;
    }
}

void input_start(struct budget_input *input, const struct scene *scene, uint64_t seed)
{
    dpt_mesh_info info = { .size = sizeof info };
    dpt_mesh_get_info(budget_mesh.mesh, &info);
    *input = (struct budget_input){ .random = seed, .scene = scene, .pose = DPT_POSE_IDENTITY };
    for (int k = 0; k < 3; k++)
        input->size = fmax(input->size, info.box_max[k] - info.box_min[k]);
    double apart = (scene->bodies > 3 ? 3.0 : 1.2) * input->size;
    double length = 0.5 * input->size * pow(10.0, -1.5 * random_in(&input->random, 0.0, 1.0));
    for (uint32_t b = 0; b < scene->bodies; b++) {
        struct place *place = &input->places[b];
        *place = (struct place){ b % 3 ? small_mesh.mesh : budget_mesh.mesh, DPT_POSE_IDENTITY, 1 };
        for (int k = 0; k < 3 && b; k++) {
            place->pose.position[k] = apart * random_signed(&input->random);
            input->turn[k] = random_signed(&input->random);
        }
        turn_a_little(&place->pose, input->turn);
    }
    for (uint32_t i = 0; i < scene->segments; i++) {
        dpt_segment *own = &input->own[i];
        own->radius = i % 3 ? 0.01 * i * input->size : 0.0;
        for (int k = 0; k < 3; k++) {
            own->a[k] = scene->rigid || !i ? 0.1 * length * random_signed(&input->random) : own[-1].b[k];
            own->b[k] = own->a[k] + length * random_signed(&input->random);
        }
    }
    for (int k = 0; k < 3; k++)
        input->pose.position[k] =
            0.5 * (info.box_min[k] + info.box_max[k]) + 0.4 * input->size * random_signed(&input->random);
    input_set_tool(input);
}

void input_move(struct budget_input *input, int motion, const dpt_hit *near)
{
    const double speeds[MOTIONS] = { 0.01, 1e-3, 2e-4, 2e-3 / input->size, 0.0, 2e-4 };
    double speed = speeds[motion] * input->size, home = 0.0, spin[3];
    int frozen = (motion == MOVED || motion == REST) && random_bits(&input->random) % 2;
    if (near->distance > 0.02 * input->size)
        home = speed / near->distance;
    int turns = random_bits(&input->random) % 32 == 0 || motion == REST;
    for (int k = 0; k < 3; k++) {
        input->way[k] = turns ? random_signed(&input->random) : input->way[k];
        input->turn[k] = turns ? random_signed(&input->random) : input->turn[k];
        spin[k] = (motion == SPIN ? 0.05 : 0.5 * speeds[motion]) * input->turn[k];
    }
    for (uint32_t b = 0; b < input->scene->bodies && motion == MOVED; b += 1 + b % 3) {
        for (int k = 0; k < 3; k++)
            input->places[b].pose.position[k] += 1e-3 * input->size * input->turn[(b + 1) % 3];
        turn_a_little(&input->places[b].pose, spin);
    }
    for (int k = 0; k < 3 && !frozen; k++) {
        input->pose.position[k] += speed * input->way[k] + home * (near->q[k] - near->p[k]);
        if (motion == JUMP)
            input->pose.position[k] = near->q[k] + 0.3 * input->size * random_signed(&input->random);
    }
    if (!frozen)
        turn_a_little(&input->pose, spin);
    input_set_tool(input);
}

void budget_sim_add_body(struct budget_sim *sim, const struct budget_input *input, uint32_t b)
{
    const struct place *place = &input->places[b];
    sim->body[b] = rig_add_body(&sim->rig, place->mesh, &place->pose);
}

void budget_sim_open(struct budget_sim *sim, const struct budget_input *input, uint32_t method, uint32_t budget,
                     uint64_t bytes)
{
    dpt_world_def def = rig_def(DPT_LAW_POINT);
    def.max_bodies = input->scene->bodies + 1;
    def.method = method;
    def.budget = budget;
    def.certificate_bytes = bytes;
    def.fade = 0.0; /* the force is of this tick alone */
    rig_open(&sim->rig, &def, NULL, NULL, 0);
    for (uint32_t b = 0; b < input->scene->bodies; b++)
        if (input->places[b].there)
            budget_sim_add_body(sim, input, b);
    rig_add_tool(&sim->rig, input->own, input->scene->segments);
}

void budget_sim_step(struct budget_sim *sim, const struct budget_input *input)
{
    const struct scene *scene = input->scene;
    for (uint32_t b = 0; b < scene->bodies; b++)
        if (input->places[b].there)
            dpt_body_set_pose(sim->rig.world, sim->body[b], &input->places[b].pose);
    if (scene->rigid)
        dpt_tool_set_pose(sim->rig.world, sim->rig.tool, &input->pose);
    else
        dpt_tool_set_segments(sim->rig.world, sim->rig.tool, input->now, scene->segments);
    rig_tick(&sim->rig);
    for (uint32_t i = 0; i < scene->segments; i++) {
        sim->hits[i].size = sizeof sim->hits[i];
        dpt_tool_get_segment_hit(sim->rig.world, sim->rig.tool, i, &sim->hits[i]);
    }
}
