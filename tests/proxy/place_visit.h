/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A tool with a proxy is led through a hard place, and each tick is judged:
 *   - it never penetrates: oracle/brute.h over the triangles of all bodies
 *   - its own motion never raises its energy
 *   - the wrench changes no faster than the device and a fold explain
 *   - the force turns by at most 30 degrees, but in a fold or where the device moves as far as it is away
 * Metric, energy and work are worked out here, from the tool's points.
 */
#ifndef DPT_TESTS_PLACE_VISIT_H
#define DPT_TESTS_PLACE_VISIT_H

#include "lib/rig.h"
#include "lib/solid.h"

enum { VISIT_BODIES = 50 };

struct visit_body {
    const struct solid *solid;
    dpt_pose pose;
    dpt_body id; /* 0: that of the rig */
};

struct visit {
    const char *name;
    struct rig rig;
    struct visit_body bodies[VISIT_BODIES];
    uint32_t body_count;
    double centre[3], rho; /* of the tool, in its frame; rho 0: a ball */
    int is_straight;
    double axis[3];
    double clearance;       /* m, of the largest body */
    double bodies_moved;    /* m, in this tick, at most */
    dpt_pose device, proxy; /* in the last tick */
    dpt_wrench wrench;
    double work;       /* J, done on the device */
    double energy_max; /* J */
    uint64_t ticks, acts, folds, lagging;
    int is_replaced; /* turned by more than 1 rad from the device, it was put there: world.h */
};

/* Centre and mean square of the distance from it, over many points of the segments. */
static inline void visit_measure(struct visit *visit)
{
    enum { POINTS = 2000 };
    const struct rig *rig = &visit->rig;
    double whole = 0, square = 0;
    visit->is_straight = 1;
    for (int pass = 0; pass < 2; pass++) {
        for (uint32_t i = 0; i < rig->count; i++) {
            const dpt_segment *segment = &rig->segments[i];
            const double length = apart(segment->a, segment->b);
            for (int n = 0; n < POINTS; n++)
                for (int k = 0; k < 3; k++) {
                    const double x = segment->a[k] + (n + 0.5) / POINTS * (segment->b[k] - segment->a[k]);
                    if (pass == 0)
                        visit->centre[k] += length / POINTS * x;
                    else
                        square += length / POINTS * (x - visit->centre[k]) * (x - visit->centre[k]);
                }
            whole += pass == 0 ? length : 0;
        }
        for (int k = 0; k < 3 && pass == 0; k++)
            visit->centre[k] = whole > 0 ? visit->centre[k] / whole : rig->segments[0].a[k];
    }
    visit->rho = whole > 0 ? sqrt(square / whole) : 0;
    for (int k = 0; k < 3; k++)
        visit->axis[k] = rig->segments[0].b[k] - rig->segments[0].a[k];
    visit->is_straight = rig->count == 1;
    unit3(visit->axis);
}

/* The angle between two orientations; of a straight tool between its axes. */
static inline double angle_apart(const struct visit *visit, const dpt_pose *from, const dpt_pose *to)
{
    const double *p = from->orientation, *q = to->orientation;
    double a[3], b[3], c[3];
    if (visit->is_straight) {
        turn3(p, visit->axis, a);
        turn3(q, visit->axis, b);
        cross3(a, b, c);
        return atan2(length3(c), dot3(a, b));
    }
    for (int k = 0; k < 3; k++)
        c[k] = p[0] * q[1 + k] - q[0] * p[1 + k] -
               (p[1 + (k + 1) % 3] * q[1 + (k + 2) % 3] - p[1 + (k + 2) % 3] * q[1 + (k + 1) % 3]);
    return 2 * atan2(sqrt(dot3(c, c)), fabs(p[0] * q[0] + dot3(p + 1, q + 1)));
}

/* m: how far two poses of the tool are apart. */
static inline double poses_apart(const struct visit *visit, const dpt_pose *from, const dpt_pose *to)
{
    double a[3], b[3];
    pose_point(from, visit->centre, a);
    pose_point(to, visit->centre, b);
    return hypot(apart(a, b), visit->rho > 0 ? visit->rho * angle_apart(visit, from, to) : 0);
}

static inline void visit_open(struct visit *visit, const char *name, const dpt_segment *segments, uint32_t count)
{
    dpt_world_def def;
    dpt_world_def_init(&def);
    def.max_bodies = VISIT_BODIES;
    *visit = (struct visit){ .name = name };
    rig_open(&visit->rig, &def, NULL, segments, count);
    visit_measure(visit);
}

static inline struct visit_body *visit_add(struct visit *visit, const struct solid *solid, const dpt_pose *pose)
{
    const dpt_pose identity = DPT_POSE_IDENTITY;
    struct visit_body *body = &visit->bodies[visit->body_count++];
    *body = (struct visit_body){ solid, pose ? *pose : identity, 0 };
    const dpt_result result = dpt_body_add(visit->rig.world, solid->mesh, &body->pose, &body->id);
    CHECK(result == DPT_OK, "%s: %s", visit->name, dpt_result_name(result));
    visit->clearance = fmax(visit->clearance, 2e-6 * solid->diagonal);
    return body;
}

static inline void visit_close(struct visit *visit)
{
    rig_close(&visit->rig);
}

/* Move a body before the next tick; its corners move by at most `moved`. */
static inline void visit_move(struct visit *visit, struct visit_body *body, const dpt_pose *pose)
{
    double moved = 0;
    for (int corner = 0; corner < 8; corner++) {
        double x[3], from[3], to[3];
        for (int k = 0; k < 3; k++)
            x[k] = (double)(corner >> k & 1 ? body->solid->place.high[k] : body->solid->place.low[k]);
        pose_point(&body->pose, x, from);
        pose_point(pose, x, to);
        moved = fmax(moved, apart(from, to));
    }
    visit->bodies_moved = fmax(visit->bodies_moved, moved);
    body->pose = *pose;
    dpt_body_set_pose(visit->rig.world, body->id, pose);
}

/* The least gap of the proxy to all bodies. */
static inline double proxy_gap(const struct visit *visit)
{
    double least = INFINITY;
    for (uint32_t s = 0; s < visit->rig.count; s++) {
        double ends[6];
        rig_proxy_ends(&visit->rig, s, ends);
        for (uint32_t b = 0; b < visit->body_count; b++) {
            const struct visit_body *body = &visit->bodies[b];
            double local[6];
            pose_local(&body->pose, ends, local);
            pose_local(&body->pose, ends + 3, local + 3);
            least = fmin(least, oracle_brute(body->solid->brute, local, NULL) - visit->rig.segments[s].radius);
        }
    }
    return least;
}

/* rad^2: the integral of a torque that grows up to 1 rad, stays, and falls to nothing from 1 rad before half a turn on. */
static inline double stored_by_turn(double angle)
{
    const double left = 3.14159265358979 - angle;
    if (angle <= 1)
        return 0.5 * angle * angle;
    return left >= 1 ? angle - 0.5 : 3.14159265358979 - 1 - 0.5 * left * left;
}

static inline double energy_between(const struct visit *visit, const dpt_pose *proxy, const dpt_pose *device)
{
    double a[3], b[3];
    pose_point(proxy, visit->centre, a);
    pose_point(device, visit->centre, b);
    const double off = apart(a, b), angle = visit->rho > 0 ? angle_apart(visit, proxy, device) : 0;
    return RIG_STIFFNESS * (0.5 * off * off + visit->rho * visit->rho * stored_by_turn(angle));
}

/* J: the trapezoidal work of the wrench, which is about the frame's origin, over the last motion. */
static inline double work_of(const struct visit *visit)
{
    const struct rig *rig = &visit->rig;
    const double *p = visit->device.orientation, *q = rig->device.orientation;
    double work = 0;
    for (int k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        const double shift = rig->device.position[k] - visit->device.position[k];
        const double turn = 2 * (p[0] * q[1 + k] - q[0] * p[1 + k] + p[1 + i] * q[1 + j] * 1.0 - p[1 + j] * q[1 + i]);
        work += 0.5 * (rig->force.wrench.force[k] + visit->wrench.force[k]) * shift +
                0.5 * (rig->force.wrench.torque[k] + visit->wrench.torque[k]) * turn;
    }
    return work;
}

/* |change of the wrench| about the tool's centre, N. */
static inline double wrench_jump(const struct visit *visit)
{
    double force[2][3], torque[2][3], sum = 0;
    for (int n = 0; n < 2; n++) {
        const dpt_pose *device = n ? &visit->rig.device : &visit->device;
        const dpt_wrench *wrench = n ? &visit->rig.force.wrench : &visit->wrench;
        double arm[3];
        turn3(device->orientation, visit->centre, arm);
        for (int k = 0; k < 3; k++) {
            const int i = (k + 1) % 3, j = (k + 2) % 3;
            force[n][k] = wrench->force[k];
            torque[n][k] = wrench->torque[k] - (arm[i] * wrench->force[j] - arm[j] * wrench->force[i]);
        }
    }
    for (int k = 0; k < 3; k++) {
        const double f = force[1][k] - force[0][k], t = torque[1][k] - torque[0][k];
        sum += f * f + (visit->rho > 0 ? t * t / (visit->rho * visit->rho) : 0);
    }
    return sqrt(sum);
}

/* A motion across a turn of that angle changes its rotation vector by more than itself. */
static inline double bend_of(const struct visit *visit)
{
    const double angle = visit->rho > 0 ? angle_apart(visit, &visit->rig.proxy, &visit->rig.device) : 0;
    return angle > 1e-3 ? angle / sin(angle) : 1;
}

/* A turn of the force by more than 30 degrees that the device's motion does not explain. */
static inline int has_turned(const struct visit *visit, double moved)
{
    const double *was = visit->wrench.force, *now = visit->rig.force.wrench.force;
    const double a = sqrt(dot3(was, was)), b = sqrt(dot3(now, now));
    const double small = RIG_STIFFNESS * (3 * moved + 10 * visit->clearance);
    return a > small && b > small && dot3(was, now) < cos(0.5235987755982988) * a * b;
}

static inline void visit_judge(struct visit *visit)
{
    const struct rig *rig = &visit->rig;
    const char *name = visit->name;
    const unsigned long long tick = visit->ticks;
    const int is_fold = (rig->force.flags & DPT_FORCE_FLAG_FOLD) != 0;
    const double moved = poses_apart(visit, &visit->device, &rig->device) + visit->bodies_moved;
    const double off = poses_apart(visit, &rig->proxy, &rig->device);
    const double gap = proxy_gap(visit), jump = wrench_jump(visit);
    const double before = energy_between(visit, &visit->proxy, &rig->device);
    const double after = energy_between(visit, &rig->proxy, &rig->device);
    const double spring = RIG_STIFFNESS * fmax(off, poses_apart(visit, &visit->proxy, &rig->device));
    const double allowed = 1e-9 + spring * (visit->clearance + 2 * visit->bodies_moved);
    CHECK(gap >= 0.7 * 0.375 * visit->clearance, "%s, tick %llu: gap %g", name, tick, gap);
    CHECK(rig->force.reason <= DPT_FORCE_FREE, "%s, tick %llu: reason %u, flags %u", name, tick, rig->force.reason,
          rig->force.flags);
    CHECK(after <= before + allowed, "%s, tick %llu: energy %g J from %g", name, tick, after, before);
    CHECK(fabs(after - rig->force.energy) <= 1e-6 * after + 1e-12, "%s, tick %llu: energy %g, not %g", name, tick,
          rig->force.energy, after);
    CHECK(jump <= RIG_STIFFNESS * (3 * moved + RIG_DT) * bend_of(visit), "%s, tick %llu: jumps by %g N", name, tick,
          jump);
    const int turns = !is_fold && has_turned(visit, moved);
    CHECK(!turns, "%s, tick %llu: force turns, (%g %g %g) to (%g %g %g)", name, tick, visit->wrench.force[0],
          visit->wrench.force[1], visit->wrench.force[2], rig->force.wrench.force[0], rig->force.wrench.force[1],
          rig->force.wrench.force[2]);
    visit->energy_max = fmax(visit->energy_max, after);
    visit->work += work_of(visit);
    visit->acts += rig->force.reason == DPT_FORCE_ACTS;
    visit->folds += (uint64_t)is_fold;
    visit->lagging += !is_fold && off > 10 * visit->clearance && rig->force.lag > 0.01 * off;
}

static inline void visit_remember(struct visit *visit)
{
    visit->device = visit->rig.device;
    visit->proxy = visit->rig.proxy;
    visit->wrench = visit->rig.force.wrench;
    visit->bodies_moved = 0;
}

/* Begin in the open, where rig.device is. */
static inline void visit_begin(struct visit *visit)
{
    rig_place(&visit->rig);
    CHECK(visit->rig.force.reason == DPT_FORCE_FREE, "%s: begins with reason %u", visit->name, visit->rig.force.reason);
    visit->work = visit->energy_max = 0;
    visit->ticks = visit->acts = visit->folds = visit->lagging = 0;
    visit_remember(visit);
}

/* One tick, to rig.device. */
static inline void visit_tick(struct visit *visit)
{
    rig_step(&visit->rig);
    visit->is_replaced |= (visit->rig.force.flags & DPT_FORCE_FLAG_REPLACED) != 0;
    if (visit->is_replaced)
        return;
    visit_judge(visit);
    visit_remember(visit);
    visit->ticks++;
}

/* A closed path is over, in the open: nothing is left, and no work was gained. */
static inline void visit_end(struct visit *visit)
{
    CHECK(visit->rig.force.reason == DPT_FORCE_FREE, "%s: trapped, reason %u, %g N", visit->name,
          visit->rig.force.reason, rig_force(&visit->rig));
    /* Where a way in and a way out differ by the clearance, so does the force's work. */
    const double strongest = sqrt(2 * RIG_STIFFNESS * visit->energy_max);
    CHECK(visit->work <= 1e-3 * visit->energy_max + strongest * visit->clearance, "%s: emits %g J of %g", visit->name,
          visit->work, visit->energy_max);
}

#endif
