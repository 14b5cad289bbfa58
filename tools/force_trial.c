/* SPDX-License-Identifier: BSD-3-Clause */
#include "force_trial.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define DT 1e-3

/* m/s: how fast a proxy may move beside its device; world.h. */
#define FOLD_SPEED 1.0

/* Forces below these count for nothing: of the largest one, and N. */
#define SMALL_SHARE 0.02
#define SMALL_FORCE 0.05

struct lead {
    const struct force_trial_def *def;
    void *block;
    dpt_world *world;
    dpt_tool tool;
    dpt_pose device, before;
    dpt_force_report force, last;
    uint64_t seed;
    double rho; /* m: what a turn of 1 rad counts as */
};

static double uniform(uint64_t *seed, double low, double high)
{
    uint64_t z = (*seed += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return low + (high - low) * ((double)((z ^ (z >> 31)) >> 11) * 0x1p-53);
}

static double product(const double *a, const double *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double size_of(const double *a)
{
    return sqrt(product(a, a));
}

static void make_unit(double *a)
{
    const double size = size_of(a);
    for (int k = 0; k < 3 && size > 0.0; k++)
        a[k] /= size;
}

static void cross(const double *a, const double *b, double *c)
{
    for (int k = 0; k < 3; k++)
        c[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

static int lead_open(struct lead *lead, const struct force_trial_def *def)
{
    const dpt_pose identity = DPT_POSE_IDENTITY;
    const dpt_segment segment = { { -0.5 * def->length, 0.0, 0.0 },
                                  { 0.5 * def->length, 0.0, 0.0 },
                                  def->radius };
    dpt_world_def world;
    dpt_body body;
    dpt_world_def_init(&world);
    world.law = def->law;
    world.stiffness = def->stiffness;
    world.max_bodies = world.max_tools = world.max_segments = 1;
    const size_t bytes = dpt_world_bytes(&world);
    *lead = (struct lead){ .def = def, .device = identity, .before = identity, .seed = def->seed };
    lead->rho = def->length / sqrt(12.0);
    lead->block = malloc(bytes ? bytes : 1);
    lead->force.size = sizeof lead->force;
    return lead->block && dpt_world_create(lead->block, bytes, &world, &lead->world) == DPT_OK &&
           dpt_body_add(lead->world, def->mesh, NULL, &body) == DPT_OK &&
           dpt_tool_add(lead->world, &segment, 1, &lead->tool) == DPT_OK;
}

static void lead_close(struct lead *lead)
{
    free(lead->block);
}

/* The orientation that turns x to a unit vector. */
static void point_along(const double *axis, double *orientation)
{
    const double x[3] = { 1.0, 0.0, 0.0 };
    double v[3];
    cross(x, axis, v);
    const double w = 1.0 + axis[0];
    if (w > 1e-9) {
        const double size = sqrt(w * w + product(v, v));
        orientation[0] = w / size;
        for (int k = 0; k < 3; k++)
            orientation[1 + k] = v[k] / size;
        return;
    }
    orientation[0] = orientation[1] = orientation[3] = 0.0;
    orientation[2] = 1.0;
}

static void step(struct lead *lead)
{
    lead->last = lead->force;
    dpt_tool_set_pose(lead->world, lead->tool, &lead->device);
    dpt_world_step(lead->world, DT, NULL);
    dpt_tool_get_force_report(lead->world, lead->tool, &lead->force);
}

static void start(struct lead *lead)
{
    dpt_tool_teleport(lead->world, lead->tool, &lead->device);
    dpt_world_step(lead->world, DT, NULL);
    lead->before = lead->device;
    step(lead);
    lead->last = lead->force;
}

/* Where the tool points. */
static void axis_of(const double *q, double *axis)
{
    axis[0] = 1.0 - 2.0 * (q[2] * q[2] + q[3] * q[3]);
    axis[1] = 2.0 * (q[1] * q[2] + q[0] * q[3]);
    axis[2] = 2.0 * (q[1] * q[3] - q[0] * q[2]);
}

/* How the device moved since the last tick: of its middle, and the least turn of its axis, which is small. */
static void motion_of(const struct lead *lead, double *shift, double *turn)
{
    double before[3], now[3];
    axis_of(lead->before.orientation, before);
    axis_of(lead->device.orientation, now);
    cross(before, now, turn);
    for (int k = 0; k < 3; k++)
        shift[k] = lead->device.position[k] - lead->before.position[k];
}

/* A place on the mesh, and the way out of it there. */
static int pick_place(struct lead *lead, double *x, double *normal)
{
    dpt_mesh_info info = { .size = sizeof info };
    dpt_mesh_get_info(lead->def->mesh, &info);
    for (int tries = 0; tries < 1000; tries++) {
        double corners[9], u[3], v[3];
        const uint32_t number = (uint32_t)uniform(&lead->seed, 0.0, (double)info.source_triangles);
        if (dpt_mesh_get_triangle(lead->def->mesh, number, corners) != DPT_OK)
            continue;
        for (int k = 0; k < 3; k++) {
            x[k] = (corners[k] + corners[3 + k] + corners[6 + k]) / 3.0;
            u[k] = corners[3 + k] - corners[k];
            v[k] = corners[6 + k] - corners[k];
        }
        cross(u, v, normal);
        make_unit(normal);
        if (size_of(normal) > 0.5)
            return 1;
    }
    return 0;
}

/* The least gap of the tool's surface at a pose; crossing is below 0. */
static double gap_at(const struct lead *lead, const dpt_pose *pose)
{
    const double half = 0.5 * lead->def->length;
    double x[3];
    axis_of(pose->orientation, x);
    double ends[6];
    dpt_hit hit = DPT_HIT_INIT;
    for (int k = 0; k < 3; k++) {
        ends[k] = pose->position[k] - half * x[k];
        ends[3 + k] = pose->position[k] + half * x[k];
    }
    dpt_query_segments(lead->def->mesh, NULL, ends, NULL, 1, &hit, NULL);
    return hit.distance - lead->def->radius;
}

/* |force|^2 + |torque|^2 / rho^2 of a difference of wrenches, as a length. */
static double wrench_jump(const struct lead *lead)
{
    double square = 0.0;
    for (int k = 0; k < 3; k++) {
        const double f = lead->force.wrench.force[k] - lead->last.wrench.force[k];
        const double t = lead->force.wrench.torque[k] - lead->last.wrench.torque[k];
        square += f * f + t * t / (lead->rho * lead->rho);
    }
    return sqrt(square);
}

static void judge_push(struct lead *lead, double largest, struct push_result *result)
{
    const struct force_trial_def *def = lead->def;
    double shift[3], turn[3];
    motion_of(lead, shift, turn);
    const double moved = sqrt(product(shift, shift) + lead->rho * lead->rho * product(turn, turn));
    const double now = size_of(lead->force.wrench.force), was = size_of(lead->last.wrench.force);
    const double small = fmax(SMALL_FORCE, SMALL_SHARE * largest);
    const int is_fold = (lead->force.flags & DPT_FORCE_FLAG_FOLD) != 0;
    const double cosine = product(lead->force.wrench.force, lead->last.wrench.force);
    double jump[3];
    for (int k = 0; k < 3; k++)
        jump[k] = lead->force.wrench.force[k] - lead->last.wrench.force[k];
    result->ticks += lead->force.reason == DPT_FORCE_ACTS;
    result->folds += (lead->force.flags & DPT_FORCE_FLAG_FOLD) != 0;
    result->unknown += lead->force.reason == DPT_FORCE_UNDECIDED;
    if (now > small && was > small && cosine < cos(0.5235987755982988) * now * was && !is_fold)
        result->turns++;
    result->jumps += wrench_jump(lead) > def->stiffness * (3.0 * moved + FOLD_SPEED * DT);
    result->largest_jump = fmax(result->largest_jump, size_of(jump));
    if (def->law != DPT_LAW_PROXY)
        return;
    dpt_pose proxy;
    dpt_tool_get_proxy(lead->world, lead->tool, &proxy);
    const double gap = gap_at(lead, &proxy);
    result->least_gap = fmin(result->least_gap, gap);
    result->penetrations += gap < 0.0;
    result->lagging +=
        !is_fold && now > SMALL_FORCE && lead->force.lag > 0.01 * now / def->stiffness;
}

/* From outside to the depth, then along the surface, with a tremor. */
static int push_at(struct lead *lead, double tilt, struct push_result *result)
{
    const struct force_trial_def *def = lead->def;
    double x[3], n[3], side[3], axis[3], other[3], tremor[3] = { 0.0, 0.0, 0.0 }, largest = 0.0;
    if (!pick_place(lead, x, n))
        return 0;
    for (int k = 0; k < 3; k++)
        other[k] = uniform(&lead->seed, -1.0, 1.0);
    cross(n, other, side);
    make_unit(side);
    for (int k = 0; k < 3; k++)
        axis[k] = cos(tilt) * n[k] + sin(tilt) * side[k];
    point_along(axis, lead->device.orientation);
    /* End a is the one that goes in. */
    const double start_gap = 0.004, from = start_gap + def->radius, to = def->radius - def->depth;
    const double down = def->speed * DT;
    const int ticks_down = (int)((from - to) / down), ticks = ticks_down + 400;
    for (int i = 0; i <= ticks; i++) {
        const double height = fmax(to, from - down * i);
        const double along = i > ticks_down ? down * (i - ticks_down) : 0.0;
        lead->before = lead->device;
        for (int k = 0; k < 3; k++) {
            tremor[k] = 0.9 * tremor[k] + uniform(&lead->seed, -6e-5, 6e-5);
            lead->device.position[k] =
                x[k] + height * n[k] + 0.5 * def->length * axis[k] + along * side[k] + tremor[k];
        }
        if (i == 0) {
            if (!(gap_at(lead, &lead->device) > 0.5 * start_gap))
                return 1; /* something else is there */
            start(lead);
            if (lead->force.reason != DPT_FORCE_FREE)
                return 1; /* it is inside of something */
            continue;
        }
        step(lead);
        largest = fmax(largest, size_of(lead->force.wrench.force));
        judge_push(lead, largest, result);
    }
    return 1;
}

int force_trial_push(const struct force_trial_def *def, struct push_result *result)
{
    static const double tilts[] = { 0.0, 0.3, 0.8, 1.3, 1.5 };
    struct lead lead;
    int is_done = lead_open(&lead, def);
    *result = (struct push_result){ .least_gap = HUGE_VAL };
    for (uint64_t i = 0; i < def->places && is_done; i++)
        is_done = push_at(&lead, tilts[i % 5], result);
    lead_close(&lead);
    return is_done;
}

int force_trial_inside(const struct force_trial_def *def, struct inside_result *result)
{
    struct lead lead;
    int is_done = lead_open(&lead, def);
    *result = (struct inside_result){ .places = 0 };
    for (uint64_t i = 0; i < def->places && is_done; i++) {
        double x[3], n[3];
        is_done = pick_place(&lead, x, n);
        if (!is_done)
            break;
        point_along(n, lead.device.orientation);
        /* The tip is deeper than its radius, the shaft goes out through the surface. */
        for (int k = 0; k < 3; k++)
            lead.device.position[k] = x[k] + (0.5 * def->length - def->depth) * n[k];
        if (gap_at(&lead, &lead.device) > -def->radius)
            continue; /* it does not cross here */
        start(&lead);
        result->places++;
        for (int t = 0; t < 200; t++) {
            for (int k = 0; k < 3; k++)
                lead.device.position[k] += uniform(&lead.seed, -1e-4, 1e-4);
            step(&lead);
            result->felt += size_of(lead.force.wrench.force) > 0.0;
        }
    }
    lead_close(&lead);
    return is_done;
}

/* A closed path: out, in by up to the depth, along, tilting, and back, in steps of at most 0.05 mm. */
static int path_at(struct lead *lead, struct path_result *result)
{
    const struct force_trial_def *def = lead->def;
    enum { STEPS = 8000 };
    double x[3], n[3], side[3], other[3], axis[3], work = 0.0, high = 0.0;
    int folds = 0;
    if (!pick_place(lead, x, n))
        return 0;
    for (int k = 0; k < 3; k++)
        other[k] = uniform(&lead->seed, -1.0, 1.0);
    cross(n, other, side);
    make_unit(side);
    cross(n, side, other);
    const double depth = uniform(&lead->seed, 0.2, 1.0) * def->depth, wide = 0.006;
    const double tilt = uniform(&lead->seed, 0.0, 0.6);
    const double phase = uniform(&lead->seed, 0.0, 6.283185307179586);
    for (int i = 0; i <= STEPS; i++) {
        const double t = 6.283185307179586 * i / STEPS;
        const double height = def->radius + 0.002 - 0.5 * (depth + 0.002) * (1.0 - cos(t));
        for (int k = 0; k < 3; k++)
            axis[k] = n[k] + tilt * (sin(t + phase) * side[k] + sin(2.0 * t) * other[k]);
        make_unit(axis);
        lead->before = lead->device;
        point_along(axis, lead->device.orientation);
        for (int k = 0; k < 3; k++)
            lead->device.position[k] = x[k] + height * n[k] + 0.5 * def->length * axis[k] +
                                       wide * (sin(t) * side[k] + sin(2.0 * t) * other[k]);
        if (i == 0) {
            if (!(gap_at(lead, &lead->device) > 0.0))
                return 1;
            start(lead);
            if (lead->force.reason != DPT_FORCE_FREE)
                return 1;
            continue;
        }
        double shift[3], turn[3];
        step(lead);
        motion_of(lead, shift, turn);
        for (int k = 0; k < 3; k++)
            work += 0.5 * (lead->force.wrench.force[k] + lead->last.wrench.force[k]) * shift[k] +
                    0.5 * (lead->force.wrench.torque[k] + lead->last.wrench.torque[k]) * turn[k];
        const double force = size_of(lead->force.wrench.force);
        const double energy =
            def->law == DPT_LAW_POINT ? 0.5 * force * force / def->stiffness : lead->force.energy;
        high = fmax(high, energy);
        folds += (lead->force.flags & DPT_FORCE_FLAG_FOLD) != 0;
    }
    /* What is not worth a force, or has not come back to the open, tells nothing. */
    if (!(high > 1e-6) || size_of(lead->force.wrench.force) > 0.0)
        return 1;
    result->paths++;
    result->emitting += work > 1e-3 * high;
    result->most_emitted = fmax(result->most_emitted, work / high);
    if (!folds)
        result->most_lost = fmax(result->most_lost, -work / high);
    return 1;
}

int force_trial_paths(const struct force_trial_def *def, struct path_result *result)
{
    struct lead lead;
    int is_done = lead_open(&lead, def);
    *result = (struct path_result){ .paths = 0 };
    for (uint64_t i = 0; i < def->paths && is_done; i++)
        is_done = path_at(&lead, result);
    lead_close(&lead);
    return is_done;
}
