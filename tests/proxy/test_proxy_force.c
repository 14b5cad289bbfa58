/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What is felt of a proxy beside its spring: surfaces that yield, the damper, torsion, a locked rotation, fades, bodies that
 * are not felt. Oracles: closed forms on a box.
 */
#include "lib/rig.h"
#include "lib/solid.h"

/* Of the box of `dynpoint make`, 0.12 x 0.10 x 0.08 m. */
#define TOP 0.04
#define PI  3.14159265358979

static const dpt_segment needle = { { 0, 0, 0 }, { 0, 0, 0.08 }, 0.002 };
static const dpt_segment lying = { { -0.02, 0, 0 }, { 0.02, 0, 0 }, 0.002 };

static struct solid box;

static void set_body(const struct rig *rig, double friction, double stiffness, uint32_t unfelt)
{
    rig_set_body(
        rig, (dpt_body_settings){
                 .static_friction = friction, .kinetic_friction = friction, .stiffness = stiffness, .unfelt = unfelt });
}

static void set_tool(const struct rig *rig, double damping, uint32_t lock_rotation)
{
    dpt_tool_settings settings = { .size = sizeof settings };
    dpt_tool_get_settings(rig->world, rig->tool, &settings);
    settings.damping = damping;
    settings.lock_rotation = lock_rotation;
    const dpt_result result = dpt_tool_set_settings(rig->world, rig->tool, &settings);
    CHECK(result == DPT_OK, "%s", dpt_result_name(result));
}

/* A tool above the box, turned about x, in the open. */
static void open_above(struct rig *rig, const dpt_segment *segment, double tilt)
{
    rig_open(rig, NULL, box.mesh, segment, 1);
    pose_orient(&rig->device, (const double[3]){ 1, 0, 0 }, tilt);
    rig->device.position[2] = TOP + segment->radius + 0.001;
    rig_place(rig);
}

/* Down by `way` in steps of 0.05 mm. */
static void lower(struct rig *rig, double way)
{
    const int steps = (int)ceil(way / 5e-5);
    for (int k = 0; k < steps; k++) {
        rig->device.position[2] -= way / steps;
        rig_step(rig);
    }
}

static double energy_of(double force, double compliance)
{
    return 0.5 * force * force * compliance;
}

/* F / (depth + clearance) = 1 / (1 / K + c^2 / K_r + 1 / k_b), and E = F^2 / 2 times the same; the proxy stays outside. */
static void surfaces_yield_in_series(void)
{
    const double stiffness[] = { 50, 500, 5000, 0 }, tilts[] = { 0, 5, 30, 60, 80 };
    for (size_t i = 0; i < 20; i++) {
        struct rig rig;
        const double k_b = stiffness[i / 5], tilt = tilts[i % 5] * PI / 180, depth = 5e-4;
        double ends[6];
        open_above(&rig, &needle, tilt);
        set_body(&rig, 0, k_b, 0);
        lower(&rig, 0.001 + depth);
        rig_proxy_ends(&rig, 0, ends);
        const double lever = 0.5 * hypot(ends[3] - ends[0], ends[4] - ends[1]);
        const double k_r = RIG_STIFFNESS * 0.08 * 0.08 / 12;
        const double compliance = 1 / RIG_STIFFNESS + lever * lever / k_r + (k_b > 0 ? 1 / k_b : 0);
        const double expected = (depth + 2e-6 * box.diagonal) / compliance;
        CHECK(fabs(rig_force(&rig) / expected - 1) < 0.01, "%g N/m, tilt %g: %g N, expected %g", k_b, tilts[i % 5],
              rig_force(&rig), expected);
        CHECK(fabs(rig.force.energy / energy_of(expected, compliance) - 1) < 0.02, "%g N/m, tilt %g: %g J", k_b,
              tilts[i % 5], rig.force.energy);
        CHECK(fmin(ends[2], ends[5]) > TOP + needle.radius, "the proxy yields itself: %g",
              fmin(ends[2], ends[5]) - TOP - needle.radius);
        rig_close(&rig);
    }
}

/* Where flat triangles meet, several of them hold the tool; the face yields as everywhere. */
static void a_flat_face_yields_once(void)
{
    const dpt_segment ball = { { 0, 0, 0 }, { 0, 0, 0 }, 0.003 };
    const double depth = 0.002, expected = (depth + 2e-6 * box.diagonal) * RIG_STIFFNESS / 2;
    struct rig rig;
    open_above(&rig, &ball, 0);
    set_body(&rig, 0, RIG_STIFFNESS, 0);
    lower(&rig, 0.001 + depth);
    for (int way = 0; way < 2; way++)
        for (int i = -40; i <= 40; i++) {
            rig.device.position[0] = 5e-4 * i;
            rig.device.position[1] = way ? rig.device.position[0] : 0;
            rig_step(&rig);
            CHECK(fabs(rig_force(&rig) / expected - 1) < 1e-3, "way %d, at %g mm: %g N, expected %g", way, 0.5 * i,
                  rig_force(&rig), expected);
        }
    rig_close(&rig);
}

/* So soft that its compliance is beyond all numbers. */
static void a_surface_of_no_stiffness_gives_no_force(void)
{
    struct rig rig;
    open_above(&rig, &needle, 0);
    set_body(&rig, 0, 1e-310, 0);
    lower(&rig, 0.003);
    CHECK(rig_force(&rig) < 1e-12 && rig.force.energy >= 0 && rig.force.energy < 1e-12, "%g N, %g J", rig_force(&rig),
          rig.force.energy);
    rig_close(&rig);
}

/* Both ends touch: their stiffnesses add up, and with friction the cone is of what is left. */
static void two_ends_yield_together(void)
{
    struct rig rig;
    const double k_b = 400, depth = 1e-3;
    open_above(&rig, &lying, 0);
    set_body(&rig, 0, k_b, 0);
    lower(&rig, 0.001 + depth);
    const double expected = (depth + 2e-6 * box.diagonal) / (1 / RIG_STIFFNESS + 1 / (2 * k_b));
    CHECK(fabs(rig_force(&rig) / expected - 1) < 0.01, "%g N, expected %g", rig_force(&rig), expected);
    set_body(&rig, 0.4, k_b, 0);
    for (int k = 0; k < 100; k++) {
        rig.device.position[0] += 2e-5;
        rig_step(&rig);
    }
    const double *F = rig.force.wrench.force;
    CHECK(fabs(F[2] / expected - 1) < 0.01 && fabs(-F[0] / F[2] / 0.4 - 1) < 0.01, "%g N up, %g N along", F[2], F[0]);
    CHECK(rig.force.slipping == 2 && rig.force.sticking == 0, "%u slip, %u stick", rig.force.slipping,
          rig.force.sticking);
    rig_close(&rig);
}

/* A groove of a soft and a hard side: each yields for itself. */
static void each_body_yields_for_itself(void)
{
    const dpt_segment ball = { { 0, 0, 0 }, { 0, 0, 0 }, 0.003 };
    const double h = sqrt(0.5);
    struct rig rig;
    open_above(&rig, &ball, 0);
    /* Two boxes turned by 45 degrees about y, whose tops meet at x = 0. */
    for (int side = -1; side <= 1; side += 2) {
        dpt_pose pose = { { 0, 0, 0 }, { 1, 0, 0, 0 } };
        pose_orient(&pose, (const double[3]){ 0, 1, 0 }, -side * PI / 4);
        pose.position[0] = side * (h * 0.06 + h * TOP);
        pose.position[2] = h * 0.06 - h * TOP;
        if (side > 0)
            rig_add_body(&rig, box.mesh, &pose);
        else
            dpt_body_teleport(rig.world, rig.body, &pose);
    }
    set_body(&rig, 0, 250, 0);
    rig.device.position[0] = 0;
    rig.device.position[2] = 0.003 / h + 1e-3;
    rig_place(&rig);
    CHECK(rig.force.reason == DPT_FORCE_FREE, "reason %u", rig.force.reason);
    lower(&rig, 3e-3);
    const double depth = 2e-3 * h, K = RIG_STIFFNESS;
    const double soft = depth / (1 / K + 1 / 250.0), hard = depth * K;
    const double x = h * (soft - hard), z = h * (soft + hard);
    CHECK(fabs(rig.force.wrench.force[0] / x - 1) < 0.01 && fabs(rig.force.wrench.force[2] / z - 1) < 0.01,
          "%g and %g N, expected %g and %g", rig.force.wrench.force[0], rig.force.wrench.force[2], x, z);
    rig_close(&rig);
}

/* Pressed in at a speed v: K depth + B v. Drawn out fast: nothing pulls back. Along a plane: nothing. */
static void a_damper_acts_against_the_push_alone(void)
{
    const double B = 3, v = 0.05;
    struct rig rig;
    open_above(&rig, &lying, 0);
    set_tool(&rig, B, 0);
    lower(&rig, 0.002);
    const double depth = 0.001 + 2e-6 * box.diagonal;
    const double expected = RIG_STIFFNESS * depth + B * v;
    CHECK(fabs(rig_force(&rig) / expected - 1) < 1e-3, "%g N, expected %g", rig_force(&rig), expected);
    rig_step(&rig);
    CHECK(fabs(rig_force(&rig) / (RIG_STIFFNESS * depth) - 1) < 1e-3, "%g N at rest", rig_force(&rig));
    for (int k = 0; k < 50; k++) {
        rig.device.position[0] += 5e-5;
        rig_step(&rig);
        CHECK(fabs(rig_force(&rig) / (RIG_STIFFNESS * depth) - 1) < 1e-3, "%g N along the plane", rig_force(&rig));
    }
    for (int k = 0; k < 4; k++) {
        rig.device.position[2] += 3e-4;
        rig_step(&rig);
        CHECK(rig.force.wrench.force[2] >= -1e-9, "it is pulled back by %g N", -rig.force.wrench.force[2]);
    }
    CHECK(rig.force.reason == DPT_FORCE_FREE && rig_force(&rig) == 0.0, "reason %u, %g N", rig.force.reason,
          rig_force(&rig));
    rig_close(&rig);
}

/* It only takes energy: on a path in and out the work is that of the damper, and of the spring none. */
static void a_damper_takes_energy(void)
{
    double work[2];
    for (int damped = 0; damped < 2; damped++) {
        struct rig rig;
        double before = 0;
        work[damped] = 0;
        open_above(&rig, &needle, 0.5);
        set_tool(&rig, damped ? 1.0 : 0.0, 0);
        for (int k = 0; k < 400; k++) {
            const double step = -5e-5 * cos(2 * PI * (k + 0.5) / 400) - (k < 200 ? 2e-5 : -2e-5);
            rig.device.position[2] += step;
            rig_step(&rig);
            work[damped] += 0.5 * (before + rig.force.wrench.force[2]) * step;
            before = rig.force.wrench.force[2];
        }
        CHECK(rig.force.reason == DPT_FORCE_FREE, "reason %u", rig.force.reason);
        rig_close(&rig);
    }
    CHECK(fabs(work[0]) < 1e-6 && work[1] < -1e-5, "%g J without, %g J with", work[0], work[1]);
}

/* A device without torque: the proxy's orientation is the device's, and any contact is as stiff as K. */
static void a_locked_rotation_is_the_devices(void)
{
    const double tilts[] = { 0, 5, 30, 60, 80 };
    for (size_t i = 0; i < sizeof tilts / sizeof *tilts; i++) {
        struct rig rig;
        double along[3], proxy[3];
        open_above(&rig, &needle, tilts[i] * PI / 180);
        set_tool(&rig, 0, 1);
        lower(&rig, 0.004);
        const double expected = RIG_STIFFNESS * (0.003 + 2e-6 * box.diagonal);
        CHECK(fabs(rig_force(&rig) / expected - 1) < 1e-3, "tilt %g: %g N, expected %g", tilts[i], rig_force(&rig),
              expected);
        for (int k = 0; k < 200; k++) {
            pose_orient(&rig.device, (const double[3]){ 1, 0, 0 }, tilts[i] * PI / 180 + 0.1 * sin(0.05 * k));
            rig_step(&rig);
            turn3(rig.device.orientation, needle.b, along);
            turn3(rig.proxy.orientation, needle.b, proxy);
            const double off = hypot(along[1] - proxy[1], along[2] - proxy[2]) / 0.08;
            CHECK(off < 1e-4, "tilt %g: turned by %g rad", tilts[i], off);
        }
        rig_close(&rig);
    }
}

/* Also while the proxy is on its way: over the box's edges and back, turned by as much as it can follow. */
static void a_locked_torque_is_one_of_its_force(void)
{
    struct rig rig;
    double along[3], arm[3], moment[3], worst = 0;
    int on_the_way = 0;
    open_above(&rig, &needle, 0.6);
    set_tool(&rig, 0, 1);
    for (int k = 0; k < 4000; k++) {
        rig.device.position[0] = 0.06 * sin(0.013 * k);
        rig.device.position[1] = 0.06 * sin(0.0171 * k);
        rig.device.position[2] = TOP - 0.01 + 0.02 * cos(0.01 * k);
        pose_orient(&rig.device, (const double[3]){ 1, 0, 0 }, 0.6 + 0.5 * sin(0.21 * k));
        rig_step(&rig);
        turn3(rig.device.orientation, needle.b, along);
        for (int i = 0; i < 3; i++)
            arm[i] = 0.5 * along[i];
        const double *f = rig.force.wrench.force;
        for (int i = 0; i < 3; i++)
            moment[i] =
                rig.force.wrench.torque[i] - arm[(i + 1) % 3] * f[(i + 2) % 3] + arm[(i + 2) % 3] * f[(i + 1) % 3];
        const double torque = sqrt(dot3(moment, moment));
        on_the_way += rig.force.lag > 1e-6 && torque > 0;
        worst = fmax(worst, torque - (1 + 1e-9) * 0.5 * sqrt(dot3(along, along)) * rig_force(&rig));
    }
    CHECK(worst <= 1e-12, "%g N m too much", worst);
    CHECK(on_the_way > 20, "%d steps on the way", on_the_way);
    rig_close(&rig);
}

/*
 * A tip on end, spun: the torque is K r^2 per rad until it is 2/3 mu N a, a = min(r, sqrt(2 r depth)). Spun back it
 * sticks again. Without friction there is none.
 */
static void a_spinning_tip_has_torsion(void)
{
    const double friction[] = { 0, 0.3, 0.8 }, up[3] = { 0, 0, 1 };
    for (size_t i = 0; i < sizeof friction / sizeof *friction; i++) {
        struct rig rig;
        const double depth = 5e-4, r = needle.radius, mu = friction[i];
        open_above(&rig, &needle, 0);
        set_body(&rig, mu, 0, 0);
        lower(&rig, 0.001 + depth);
        const double N = rig_force(&rig), a = fmin(r, sqrt(2 * r * depth));
        const double limit = 2.0 / 3 * mu * N * a;
        double angle = 0;
        for (int k = 0; k < 400; k++) {
            angle += k < 250 ? 2e-3 : -2e-3;
            pose_orient(&rig.device, up, angle);
            rig_step(&rig);
            const double torque = -rig.force.wrench.torque[2];
            const double turn = k < 250 ? angle : limit / (RIG_STIFFNESS * r * r) - (0.5 - angle);
            const double stuck = RIG_STIFFNESS * r * r * turn;
            const double expected = fmin(fmax(stuck, -limit), limit);
            CHECK(fabs(torque - expected) < 0.01 * limit + 1e-9, "friction %g, %g rad: %g Nm, expected %g", mu, angle,
                  torque, expected);
            CHECK(fabs(rig.force.wrench.force[2] / N - 1) < 1e-6 &&
                      hypot(rig.force.wrench.force[0], rig.force.wrench.force[1]) < 1e-6 * N,
                  "friction %g: the force turns", mu);
        }
        rig_close(&rig);
    }
}

/* A lying tool that is spun about itself drags its surface over the plane: mu N along, at most. */
static void a_lying_tool_rolls_and_slips(void)
{
    struct rig rig;
    const double mu = 0.3, x[3] = { 1, 0, 0 };
    open_above(&rig, &lying, 0);
    set_body(&rig, mu, 0, 0);
    lower(&rig, 0.002);
    const double N = rig.force.wrench.force[2];
    for (int k = 1; k <= 600; k++) {
        pose_orient(&rig.device, x, 2e-3 * k);
        rig_step(&rig);
        const double *F = rig.force.wrench.force, *T = rig.force.wrench.torque;
        CHECK(fabs(F[1]) <= mu * F[2] * 1.01, "%g N across, %g N up", F[1], F[2]);
        /* The torque about the axis is that of the force at the surface. */
        CHECK(fabs(T[0] - lying.radius * F[1]) < 0.02 * mu * N * lying.radius + 1e-9,
              "%g Nm about the axis, %g N across", T[0], F[1]);
    }
    CHECK(fabs(fabs(rig.force.wrench.force[1]) / (mu * N) - 1) < 0.02 && rig.force.slipping == 2,
          "%g N across after a turn by 1.2 rad, %u slip", rig.force.wrench.force[1], rig.force.slipping);
    rig_close(&rig);
}

/* Led far aside, a thin tool that sticks rolls by several turns; its spin stays within 1.5 rad of the device's. */
static void a_tool_that_rolls_far_is_not_spun_far(void)
{
    const dpt_segment thin = { { -0.02, 0, 0 }, { 0.02, 0, 0 }, 0.001 };
    for (int way = -1; way <= 1; way += 2) {
        struct rig rig;
        double most = 0;
        open_above(&rig, &thin, 0);
        set_body(&rig, 2, 0, 0);
        lower(&rig, 0.006);
        for (int k = 0; k < 5; k++) {
            rig.device.position[1] += 0.003 * way;
            rig_step(&rig);
            const double *q = rig.proxy.orientation;
            most = fmax(most, 2 * atan2(fabs(q[1]), fabs(q[0])));
        }
        CHECK(rig.force.reason == DPT_FORCE_ACTS && most > 0.5 && most <= 1.5 + 1e-6, "way %d: spun by %g rad", way,
              most);
        rig_close(&rig);
    }
}

/* The length of a wrench on `lying`, whose centre is the frame's origin, N. */
static double wrench_length(const dpt_wrench *wrench)
{
    const double rho = 0.04 / sqrt(12), torque = length3(wrench->torque) / rho, force = length3(wrench->force);
    return sqrt(force * force + torque * torque);
}

/* What is felt of a fold changes by so much in a tick of a device at rest, N. */
#define PACE (RIG_STIFFNESS * 1.0 * RIG_DT)

/* With the device at rest, the wrench fades in a straight line, and as fast as what is felt of a fold changes. */
static void check_fade(struct rig *rig, const char *text)
{
    double before = wrench_length(&rig->force.wrench);
    const int ticks = (int)ceil(before / PACE - 1e-6);
    CHECK(ticks > 0, "%s: %g N", text, before);
    for (int k = 1; k <= ticks; k++) {
        CHECK(rig->force.flags & DPT_FORCE_FLAG_FADING && rig->force.reason != DPT_FORCE_ACTS,
              "%s: reason %u, flags %u", text, rig->force.reason, rig->force.flags);
        rig_step(rig);
        const double now = wrench_length(&rig->force.wrench), fell = before - now;
        CHECK(k < ticks ? fabs(fell - PACE) < 1e-6 * PACE : fell < (1 + 1e-6) * PACE, "%s: %g N after %g N", text, now,
              before);
        before = now;
    }
    CHECK(before == 0.0 && !(rig->force.flags & DPT_FORCE_FLAG_FADING), "%s: %g N, flags %u", text, before,
          rig->force.flags);
}

/* Turned by more than 1 rad away, the proxy begins again at the device: the force fades. */
static void a_proxy_that_begins_again_fades(void)
{
    struct rig rig;
    double last = 0;
    int faded = 0;
    open_above(&rig, &lying, 0);
    lower(&rig, 0.003);
    for (int k = 0; k < 400 && !faded; k++) {
        last = rig_force(&rig);
        pose_orient(&rig.device, (const double[3]){ 0, 1, 0 }, 4e-3 * k);
        rig_step(&rig);
        faded = (rig.force.flags & DPT_FORCE_FLAG_REPLACED) != 0;
    }
    CHECK(faded, "it never began again");
    CHECK(rig_force(&rig) < last, "%g N after %g N", rig_force(&rig), last);
    check_fade(&rig, "turned");
    CHECK(rig.force.reason == DPT_FORCE_INSIDE, "reason %u", rig.force.reason);
    rig_close(&rig);
}

/* A body is added round a proxy that is held: nothing of its force is true any more, and it fades. */
static void a_body_that_is_added_round_it_fades(void)
{
    struct rig rig;
    dpt_pose pose = DPT_POSE_IDENTITY;
    open_above(&rig, &lying, 0);
    lower(&rig, 0.003);
    const double last = rig_force(&rig);
    pose.position[2] = TOP;
    rig_add_body(&rig, box.mesh, &pose);
    rig_step(&rig);
    CHECK(fabs(last - rig_force(&rig) - PACE) < 1e-6, "%g N after %g N", rig_force(&rig), last);
    check_fade(&rig, "added");
    rig_close(&rig);
}

/* Beside one that is felt: the search passes over it, and its pose may come and go. */
static void one_that_is_not_felt_hides_nothing(void)
{
    struct rig rig;
    dpt_hit hit = DPT_HIT_INIT;
    dpt_pose pose = DPT_POSE_IDENTITY;
    open_above(&rig, &lying, 0);
    pose.position[2] = -0.2;
    const dpt_body other = rig_add_body(&rig, box.mesh, &pose);
    set_body(&rig, 0, 0, 1);
    dpt_body_set_pose(rig.world, rig.body, NULL);
    pose.position[2] = 0;
    dpt_body_set_pose(rig.world, rig.body, &pose);
    lower(&rig, 0.002);
    dpt_tool_get_hit(rig.world, rig.tool, &hit);
    CHECK(rig.force.reason == DPT_FORCE_FREE && hit.body == other && hit.distance > 0.1, "reason %u, %g m from body %x",
          rig.force.reason, hit.distance, hit.body);
    rig_close(&rig);
}

/* A body that is not felt is not there: no hit, no force. Felt again, round the tool, it is one that the tool began in. */
static void a_body_that_is_not_felt_is_not_there(void)
{
    struct rig rig;
    dpt_hit hit = DPT_HIT_INIT;
    open_above(&rig, &lying, 0);
    set_body(&rig, 0, 0, 1);
    lower(&rig, 0.01);
    dpt_tool_get_hit(rig.world, rig.tool, &hit);
    CHECK(rig.force.reason == DPT_FORCE_FREE && rig_force(&rig) == 0.0 && !rig.step.contacts &&
              hit.status == DPT_STATUS_STALE,
          "reason %u, %g N, status %u", rig.force.reason, rig_force(&rig), hit.status);
    set_body(&rig, 0, 0, 0);
    lower(&rig, 0.001);
    CHECK(rig.force.reason == DPT_FORCE_INSIDE && rig_force(&rig) == 0.0, "reason %u, %g N", rig.force.reason,
          rig_force(&rig));
    rig.device.position[2] = TOP + 0.01;
    rig_step(&rig);
    rig_step(&rig);
    lower(&rig, 0.01);
    CHECK(rig.force.reason == DPT_FORCE_ACTS, "reason %u", rig.force.reason);
    /* Its push ends at once; and where it is, valid or not, is nobody's affair. */
    set_body(&rig, 0, 0, 1);
    CHECK(dpt_body_set_pose(rig.world, rig.body, NULL) == DPT_E_ARGUMENT, "no pose");
    rig_step(&rig);
    CHECK(rig.force.reason == DPT_FORCE_FREE && rig_force(&rig) == 0.0 && !rig.force.flags, "reason %u, %g N",
          rig.force.reason, rig_force(&rig));
    set_body(&rig, 0, 0, 0);
    rig_step(&rig);
    CHECK(rig.force.reason == DPT_FORCE_STALE, "felt again, without a pose: reason %u", rig.force.reason);
    rig_close(&rig);
}

/* What the function of `a_function_of_its_own` was given, and what it is to do. */
struct shaper {
    uint64_t calls;
    dpt_force_info seen;
    double factor;
};

static void shape(void *user, const dpt_force_info *report, double dt, dpt_wrench *wrench)
{
    struct shaper *shaper = user;
    CHECK(dt == RIG_DT, "dt %g", dt);
    shaper->calls++;
    shaper->seen = *report;
    for (int k = 0; k < 3; k++)
        wrench->force[k] *= shaper->factor;
    if (report->reason == DPT_FORCE_FREE)
        wrench->force[0] = 0.25; /* a guide */
}

/* It has the wrench of the law, and what it makes of it is told; where it is not finite there is none. */
static void a_function_of_its_own_shapes_the_wrench(void)
{
    struct rig rig;
    struct shaper shaper = { .factor = 0.5 };
    const dpt_tool nobody = 77;
    open_above(&rig, &lying, 0);
    CHECK(dpt_tool_set_shaper(rig.world, rig.tool, shape, &shaper) == DPT_OK, "set");
    CHECK(dpt_tool_set_shaper(rig.world, nobody, shape, NULL) == DPT_E_HANDLE, "no tool");
    CHECK(dpt_tool_set_shaper(NULL, rig.tool, shape, NULL) == DPT_E_ARGUMENT, "no world");
    rig_step(&rig);
    CHECK(rig.force.reason == DPT_FORCE_FREE && rig.force.wrench.force[0] == 0.25 &&
              rig.force.flags == DPT_FORCE_FLAG_SHAPED,
          "%g N, flags %u", rig.force.wrench.force[0], rig.force.flags);
    lower(&rig, 0.002);
    const double expected = RIG_STIFFNESS * (0.001 + 2e-6 * box.diagonal);
    CHECK(fabs(shaper.seen.wrench.force[2] / expected - 1) < 1e-3 &&
              rig.force.wrench.force[2] == 0.5 * shaper.seen.wrench.force[2],
          "%g N of %g", rig.force.wrench.force[2], shaper.seen.wrench.force[2]);
    CHECK(fabs(rig.force.energy / (0.5 * expected * 0.001) - 1) < 1e-2, "the law's energy, not %g", rig.force.energy);
    shaper.factor = INFINITY;
    rig_step(&rig);
    CHECK(rig_force(&rig) == 0.0 && rig.force.reason == DPT_FORCE_UNDECIDED, "%g N, reason %u", rig_force(&rig),
          rig.force.reason);
    const uint64_t calls = shaper.calls;
    dpt_tool_set_pose(rig.world, rig.tool, NULL);
    rig_tick(&rig);
    CHECK(shaper.calls == calls, "a stale tool's wrench was shaped");
    dpt_world_reset(rig.world);
    rig.device.position[2] = TOP + 0.003;
    rig_step(&rig);
    CHECK(shaper.calls == calls + 1, "it does not outlast a reset");
    rig_step(&rig);
    lower(&rig, 0.002);
    CHECK(dpt_tool_set_shaper(rig.world, rig.tool, NULL, NULL) == DPT_OK, "end");
    rig_step(&rig);
    CHECK(rig.force.flags == 0 && fabs(rig.force.wrench.force[2] / expected - 1) < 1e-3, "%g N, flags %u",
          rig.force.wrench.force[2], rig.force.flags);
    rig_close(&rig);
}

int main(void)
{
    if (!solid_from_shape(&box, "box", 1200))
        return 1;
    TEST(surfaces_yield_in_series);
    TEST(a_flat_face_yields_once);
    TEST(a_surface_of_no_stiffness_gives_no_force);
    TEST(two_ends_yield_together);
    TEST(each_body_yields_for_itself);
    TEST(a_damper_acts_against_the_push_alone);
    TEST(a_damper_takes_energy);
    TEST(a_locked_rotation_is_the_devices);
    TEST(a_locked_torque_is_one_of_its_force);
    TEST(a_spinning_tip_has_torsion);
    TEST(a_lying_tool_rolls_and_slips);
    TEST(a_tool_that_rolls_far_is_not_spun_far);
    TEST(a_proxy_that_begins_again_fades);
    TEST(a_body_that_is_added_round_it_fades);
    TEST(a_body_that_is_not_felt_is_not_there);
    TEST(one_that_is_not_felt_hides_nothing);
    TEST(a_function_of_its_own_shapes_the_wrench);
    solid_close(&box);
    return check_report();
}
