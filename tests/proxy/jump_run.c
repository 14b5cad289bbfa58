/* SPDX-License-Identifier: BSD-3-Clause */
#include "proxy/jump_run.h"

#include "lib/rig.h"

enum { JUDGED_EACH = 16 };

#define FOLD_SPEED  1.0
#define ROUNDING    1e-6
#define OVERLAPPING 1e-9

struct run {
    const struct jump_run_def *def;
    struct rig rig;
    struct hand hand;
    double stiffness, rho;
    double free_turn[3]; /* the tool's axis when it was free last */
    int was_inside, was_put;
    struct jump_counts *counts;
};

static void axis_of(const struct run *run, const dpt_pose *pose, double axis[3], double centre[3])
{
    double ends[6];
    pose_ends(pose, &run->rig.segments[0], ends);
    point_at(ends, 0.5, centre);
    for (int k = 0; k < 3; k++)
        axis[k] = ends[3 + k] - ends[k];
    unit3(axis);
}

static double angle(const double a[3], const double b[3])
{
    double across[3];
    cross3(a, b, across);
    return atan2(length3(across), dot3(a, b));
}

/* The norm of the device's motion. With friction its spin is a part of it. */
static double motion(const struct run *run, const dpt_pose *from, const dpt_pose *to)
{
    double u[3], v[3], c[3], d[3];
    axis_of(run, from, u, c);
    axis_of(run, to, v, d);
    const double shift = apart(c, d), turned = angle(u, v), turn = run->rho * turned;
    double spin2 = 0;
    if (run->def->friction > 0) {
        const double whole = pose_angle(from, to);
        spin2 = run->rig.segments[0].radius * run->rig.segments[0].radius * fmax(0, whole * whole - turned * turned);
    }
    return sqrt(shift * shift + turn * turn + spin2);
}

/* Force, and torque about the device's centre over rho. */
static void felt(const struct run *run, double w[6])
{
    const dpt_wrench *wrench = &run->rig.force.wrench;
    double axis[3], centre[3], lever[3], moment[3];
    axis_of(run, &run->rig.device, axis, centre);
    for (int k = 0; k < 3; k++)
        lever[k] = centre[k] - run->rig.device.position[k];
    cross3(lever, wrench->force, moment);
    for (int k = 0; k < 3; k++) {
        w[k] = wrench->force[k];
        w[3 + k] = run->rho > 0 ? (wrench->torque[k] - moment[k]) / run->rho : 0;
    }
}

static void tell(const struct run *run, const char *what, double value, double turned)
{
    const dpt_force_info *force = &run->rig.force;
    double u[3], v[3], c[3];
    if (!run->def->tell)
        return;
    axis_of(run, &run->rig.device, u, c);
    axis_of(run, &run->rig.proxy, v, c);
    fprintf(run->def->tell, "%s,%s,%s,%g,%llu,%llu,%s,%g,", run->def->oracle->solid->name,
            hand_motion_names[run->def->motion], hand_holding_names[run->def->holding], run->def->friction,
            (unsigned long long)run->def->seed, (unsigned long long)run->hand.tick, what, value);
    fprintf(run->def->tell, "reason %u,flags %u,force %.3g,device turned %.2f,from the proxy %.2f\n", force->reason,
            force->flags, length3(force->wrench.force), turned, run->rho > 0 ? angle(u, v) : 0.0);
}

static void judge_side(struct run *run, double turned)
{
    double ends[6];
    uint64_t seed = run->hand.tick;
    rig_proxy_ends(&run->rig, 0, ends);
    const double radius = run->rig.segments[0].radius;
    const double gap = soak_distance(run->def->oracle, ends, radius + 2e-3) - radius;
    if (gap < -OVERLAPPING) {
        run->counts->overlaps++;
        tell(run, "overlaps", gap, turned);
    }
    if (!run->def->oracle->is_closed)
        return;
    const int is_inside =
        soak_is_inside(run->def->oracle, ends, &seed) || soak_is_inside(run->def->oracle, ends + 3, &seed);
    if (is_inside && !run->was_inside) {
        run->counts->passed++;
        tell(run, "passed", gap, turned);
    }
    run->was_inside = is_inside;
}

static void tick(struct run *run)
{
    struct jump_counts *counts = run->counts;
    const dpt_pose before = run->rig.device;
    double was[6], is[6], axis[3], centre[3], change = 0;
    felt(run, was);
    hand_move(&run->hand, &run->rig.device);
    rig_step(&run->rig);
    felt(run, is);
    const dpt_force_info *force = &run->rig.force;
    for (int k = 0; k < 6; k++)
        change += (is[k] - was[k]) * (is[k] - was[k]);
    axis_of(run, &run->rig.device, axis, centre);
    if (force->reason == DPT_FORCE_FREE)
        memcpy(run->free_turn, axis, sizeof axis);
    const double turned = run->rho > 0 ? angle(axis, run->free_turn) : 0;
    const double bound = run->stiffness * (3 * motion(run, &before, &run->rig.device) + FOLD_SPEED * RIG_DT);
    const double jump = sqrt(change) / bound;
    const int is_put =
        force->reason > DPT_FORCE_FREE || force->flags & (DPT_FORCE_FLAG_REPLACED | DPT_FORCE_FLAG_SQUEEZED);
    counts->ticks++;
    counts->acts += force->reason == DPT_FORCE_ACTS;
    counts->force += length3(force->wrench.force);
    counts->largest = fmax(counts->largest, jump);
    if (jump > 1 + ROUNDING) {
        counts->jumps++;
        tell(run, "jump", jump, turned);
    }
    if (is_put && !run->was_put) {
        counts->puts++;
        counts->early += turned < 1;
        tell(run, "put", 0, turned);
    }
    run->was_put = is_put;
    if (!is_put && (run->hand.tick % JUDGED_EACH == 0 || jump > 0.9))
        judge_side(run, turned);
}

void jump_run(const struct jump_run_def *def, struct jump_counts *counts)
{
    struct run run = { .def = def, .counts = counts };
    dpt_tool_settings settings = { .size = sizeof settings };
    dpt_body_settings body = { .size = sizeof body };
    hand_begin(&run.hand, def->oracle->solid, def->motion, def->holding, def->depth, def->seed);
    rig_open(&run.rig, NULL, def->oracle->solid->mesh, &def->segment, 1);
    dpt_tool_get_settings(run.rig.world, run.rig.tool, &settings);
    dpt_body_get_settings(run.rig.world, run.rig.body, &body);
    body.static_friction = body.kinetic_friction = def->friction;
    rig_set_body(&run.rig, body);
    run.stiffness = settings.stiffness;
    run.rho = apart(def->segment.a, def->segment.b) / sqrt(12);
    hand_move(&run.hand, &run.rig.device);
    rig_place(&run.rig);
    /* A place in a fold of the mesh has no room above it. */
    const uint64_t ticks = run.rig.force.reason == DPT_FORCE_FREE ? def->ticks : 0;
    for (uint64_t i = 0; i < ticks; i++)
        tick(&run);
    counts->folds += run.rig.force.folds;
    rig_close(&run.rig);
}
