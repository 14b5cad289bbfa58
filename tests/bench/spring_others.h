/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Integrators of springs that the library does not have, for comparison (spring_methods.c), as their authors describe
 * them, in float and without vector instructions:
 *   xpbd   M. Macklin, M. Mueller, N. Chentanez, XPBD, 2016, in substeps of one iteration (M. Macklin et al., Small steps
 *          in physics simulation, 2019), springs one after the other; with the damping of its section 3.5
 *   vbd    A. H. Chen, Z. Liu, Y. Yang, C. Yuksel, Vertex block descent, 2024: backward Euler by sweeps over the nodes,
 *          one after the other, each a Newton step of one node; begun as in its section 3.7, where nodes fly on under as
 *          much of the load as accelerated them in the last step
 *   plain  symplectic Euler, programmed as they are
 */
#ifndef DPT_BENCH_SPRING_OTHERS_H
#define DPT_BENCH_SPRING_OTHERS_H

#include <math.h>
#include <string.h>

#include "dynpoint/body.h"
#include "mesh/spring_net.h"

struct link {
    uint32_t a, b;
    float stiffness, length;
};

struct body {
    struct spring_net net;
    uint32_t nodes, springs;
    struct link *list;
    uint32_t *first, *row;  /* of each node: numbers of its springs */
    dpt_load *unit, *loads; /* of a press of 1 N; those of now */
    uint32_t load_count;
    float *load; /* 3 a node: of the loads; and where a node is, was, and how fast */
    float *x, *before, *v, *force, *target, *last;
    float stiffness; /* what all are multiplied by */
};

/* Forces of the springs, of nodes where they will be after `lead` s. */
static void plain_forces(struct body *body, float lead)
{
    const float *restrict x = body->target;
    float *restrict f = body->force;
    memcpy(f, body->load, 3 * (size_t)body->nodes * sizeof *f);
    for (uint32_t i = 0; i < 3 * body->nodes; i++)
        body->target[i] = body->x[i] + lead * body->v[i];
    for (uint32_t i = 0; i < body->springs; i++) {
        const struct link *link = &body->list[i];
        const uint32_t a = 3 * link->a, b = 3 * link->b;
        const float dx = x[b] - x[a], dy = x[b + 1] - x[a + 1], dz = x[b + 2] - x[a + 2];
        const float pull =
            body->stiffness * link->stiffness * (1.0f - link->length / sqrtf(dx * dx + dy * dy + dz * dz));
        f[a] += pull * dx;
        f[a + 1] += pull * dy;
        f[a + 2] += pull * dz;
        f[b] -= pull * dx;
        f[b + 1] -= pull * dy;
        f[b + 2] -= pull * dz;
    }
}

static void plain_step(struct body *body, float h)
{
    plain_forces(body, (float)body->net.viscosity);
    for (uint32_t i = 0; i < 3 * body->nodes; i++) {
        const float mass = body->net.mass[i / 3];
        if (mass > 0.0f)
            body->v[i] = (body->v[i] + h * body->force[i] / mass) / (1.0f + h * body->net.drag[i / 3]);
        body->x[i] += h * body->v[i];
    }
}

/* Where nodes would be without springs; drag slows them down first. */
static void fly_on(struct body *body, float h)
{
    for (uint32_t i = 0; i < 3 * body->nodes; i++) {
        const float mass = body->net.mass[i / 3];
        body->before[i] = body->x[i];
        if (mass > 0.0f)
            body->v[i] = (body->v[i] + h * body->load[i] / mass) / (1.0f + h * body->net.drag[i / 3]);
        body->x[i] += h * body->v[i];
        body->target[i] = body->x[i];
    }
}

static void take_speeds(struct body *body, float h)
{
    for (uint32_t i = 0; i < 3 * body->nodes; i++)
        body->v[i] = (body->x[i] - body->before[i]) / h;
}

/* One iteration: multipliers begin at 0, so that they need not be kept. */
static void xpbd_step(struct body *body, float h)
{
    float *restrict x = body->x;
    const float *restrict before = body->before;
    const float damping = (float)body->net.viscosity / h;
    fly_on(body, h);
    for (uint32_t i = 0; i < body->springs; i++) {
        const struct link *link = &body->list[i];
        const uint32_t a = 3 * link->a, b = 3 * link->b;
        const float ma = body->net.mass[link->a], mb = body->net.mass[link->b];
        const float wa = ma > 0.0f ? 1.0f / ma : 0.0f, wb = mb > 0.0f ? 1.0f / mb : 0.0f;
        const float d[3] = { x[b] - x[a], x[b + 1] - x[a + 1], x[b + 2] - x[a + 2] };
        const float size = sqrtf(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
        float way = 0.0f;
        if (!(wa + wb > 0.0f) || !(size > 0.0f))
            continue;
        for (uint32_t k = 0; k < 3; k++)
            way += d[k] / size * (d[k] - (before[b + k] - before[a + k]));
        const float soft = 1.0f / (body->stiffness * link->stiffness * h * h);
        const float push = -(size - link->length + damping * way) / ((1.0f + damping) * (wa + wb) + soft);
        for (uint32_t k = 0; k < 3; k++) {
            x[a + k] -= wa * push * d[k] / size;
            x[b + k] += wb * push * d[k] / size;
        }
    }
    take_speeds(body, h);
}

/* x = (matrix)^-1 f, of a symmetric one: xx, xy, xz, yy, yz, zz. */
static void solve_3(const float m[6], const float f[3], float x[3])
{
    const float a = m[3] * m[5] - m[4] * m[4], b = m[2] * m[4] - m[1] * m[5];
    const float c = m[1] * m[4] - m[2] * m[3], det = m[0] * a + m[1] * b + m[2] * c;
    const float d = m[0] * m[5] - m[2] * m[2], e = m[1] * m[2] - m[0] * m[4];
    x[0] = (a * f[0] + b * f[1] + c * f[2]) / det;
    x[1] = (b * f[0] + d * f[1] + e * f[2]) / det;
    x[2] = (c * f[0] + e * f[1] + (m[0] * m[3] - m[1] * m[1]) * f[2]) / det;
}

static void vbd_node(struct body *body, uint32_t node, float inertia, float damping)
{
    float *restrict x = body->x;
    const float *before = body->before;
    float matrix[6] = { inertia, 0.0f, 0.0f, inertia, 0.0f, inertia }, f[3], by[3];
    for (uint32_t k = 0; k < 3; k++)
        f[k] = inertia * (body->target[3 * node + k] - x[3 * node + k]);
    for (uint32_t i = body->first[node]; i < body->first[node + 1]; i++) {
        const struct link *link = &body->list[body->row[i]];
        const uint32_t a = 3 * node, b = 3 * (link->a == node ? link->b : link->a);
        const float d[3] = { x[b] - x[a], x[b + 1] - x[a + 1], x[b + 2] - x[a + 2] };
        const float size = sqrtf(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
        const float k = body->stiffness * link->stiffness, turn = 1.0f - link->length / size;
        /* A spring that is pressed would make the matrix smaller across: left out. */
        const float across = turn > 0.0f ? turn : 0.0f, along = (1.0f - across) / (size * size);
        float way[3], inner = 0.0f;
        for (uint32_t c = 0; c < 3; c++) {
            way[c] = d[c] - (before[b + c] - before[a + c]);
            inner += along * d[c] * way[c];
        }
        for (uint32_t c = 0; c < 3; c++)
            f[c] += k * (turn * d[c] + damping * (across * way[c] + inner * d[c]));
        const float more = k * (1.0f + damping);
        matrix[0] += more * (across + along * d[0] * d[0]);
        matrix[1] += more * along * d[0] * d[1];
        matrix[2] += more * along * d[0] * d[2];
        matrix[3] += more * (across + along * d[1] * d[1]);
        matrix[4] += more * along * d[1] * d[2];
        matrix[5] += more * (across + along * d[2] * d[2]);
    }
    solve_3(matrix, f, by);
    for (uint32_t k = 0; k < 3; k++)
        x[3 * node + k] += by[k];
}

/* Where sweeps begin. last: speeds one step before those of now. */
static void vbd_begin(struct body *body, uint32_t node, float h)
{
    const float mass = body->net.mass[node];
    float along = 0.0f, square = 0.0f;
    for (uint32_t i = 3 * node; i < 3 * node + 3; i++) {
        along += (body->force[i] - body->last[i]) / h * body->load[i] / mass;
        square += body->load[i] / mass * (body->load[i] / mass);
    }
    if (!(mass > 0.0f && square > 0.0f))
        return;
    const float share = along < 0.0f ? 0.0f : along > square ? 1.0f : along / square;
    for (uint32_t i = 3 * node; i < 3 * node + 3; i++)
        body->x[i] -= (1.0f - share) * h * h * body->load[i] / mass;
}

static void vbd_step(struct body *body, float h, uint32_t sweeps)
{
    const float damping = (float)body->net.viscosity / h;
    memcpy(body->force, body->v, 3 * (size_t)body->nodes * sizeof *body->v);
    fly_on(body, h);
    for (uint32_t node = 0; node < body->nodes; node++)
        vbd_begin(body, node, h);
    memcpy(body->last, body->force, 3 * (size_t)body->nodes * sizeof *body->v);
    for (uint32_t sweep = 0; sweep < sweeps; sweep++)
        for (uint32_t node = 0; node < body->nodes; node++) {
            const float mass = body->net.mass[node] * (1.0f + h * body->net.drag[node]);
            if (mass > 0.0f)
                vbd_node(body, node, mass / (h * h), damping);
        }
    take_speeds(body, h);
}

#endif
