/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Friction of a proxy where it is hard: several contacts, contacts that come and go, slopes, bodies that move.
 * Oracle: the wrench is a sum of forces in Coulomb's cones, found by coordinate descent over their edges; and closed
 * forms.
 *
 *     test_proxy_friction [PER CENT of the random cases = 100]
 */
#include "lib/rig.h"
#include "lib/solid.h"

#define TOP 0.04

static const dpt_segment ball = { { 0, 0, 0 }, { 0, 0, 0 }, 0.003 };
static const dpt_segment lying = { { -0.01, 0, 0 }, { 0.01, 0, 0 }, 0.002 };

/* Contacts of a tool: where, which way out. */
struct touch {
    double x[3], normal[3];
};

enum { EDGES = 48, TOUCHES_MAX = 4 };

/*
 * How far a wrench about `centre` is from the sum of the cones, as a share of the wrench; `arm` makes torques
 * forces. A ball feels no torque: its turns are the device's.
 */
static double off_the_cones(const double force[3], const double torque[3], const double centre[3], int has_torque,
                            double arm, const struct touch *touches, int count, double friction)
{
    static double edges[TOUCHES_MAX * EDGES][6];
    double left[6], share[TOUCHES_MAX * EDGES] = { 0 };
    for (int t = 0; t < count; t++)
        for (int e = 0; e < EDGES; e++) {
            const double *n = touches[t].normal, angle = 2 * 3.14159265358979 * e / EDGES;
            double side[3], other[3], lever[3], *edge = edges[t * EDGES + e];
            cross3(n, fabs(n[0]) < 0.6 ? (double[3]){ 1, 0, 0 } : (double[3]){ 0, 1, 0 }, side);
            unit3(side);
            cross3(n, side, other);
            for (int k = 0; k < 3; k++) {
                edge[k] = n[k] + friction * (cos(angle) * side[k] + sin(angle) * other[k]);
                lever[k] = touches[t].x[k] - centre[k];
            }
            cross3(lever, edge, edge + 3);
            for (int k = 0; k < 3; k++)
                edge[3 + k] = has_torque ? edge[3 + k] / arm : 0;
        }
    for (int k = 0; k < 3; k++) {
        left[k] = force[k];
        left[3 + k] = torque[k] / arm;
    }
    const double whole = sqrt(dot3(left, left) + dot3(left + 3, left + 3));
    for (int sweep = 0; sweep < 4000; sweep++) {
        if (dot3(left, left) + dot3(left + 3, left + 3) < 1e-6 * whole * whole)
            break;
        for (int i = 0; i < count * EDGES; i++) {
            const double *e = edges[i];
            const double size = dot3(e, e) + dot3(e + 3, e + 3);
            double more = (dot3(left, e) + dot3(left + 3, e + 3)) / size;
            more = fmax(more, -share[i]);
            share[i] += more;
            for (int k = 0; k < 6; k++)
                left[k] -= more * e[k];
        }
    }
    return sqrt(dot3(left, left) + dot3(left + 3, left + 3)) / whole;
}

/* A groove along y, of two planes of that slope. */
static int open_groove(struct solid *groove, double slope)
{
    const double h = 0.1 * slope;
    const double v[] = { -0.1, -0.2, h, 0, -0.2, 0, 0.1, -0.2, h, -0.1, 0.2, h, 0, 0.2, 0, 0.1, 0.2, h };
    const uint32_t corners[] = { 0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4 };
    return solid_from_arrays(groove, "groove", v, 6, corners, 4);
}

/* Pulled about in a groove: the wrench is one that Coulomb allows; the edges of the cones cost 0.3 %. */
static void pull_in_groove(const struct solid *groove, const dpt_segment *segment, double turn, double friction,
                           uint64_t seed)
{
    struct rig rig;
    double worst = 0, aim[3] = { 0, 0, 0 };
    uint64_t acts = 0, off = 0, ticks = 600;
    rig_open(&rig, NULL, groove->mesh, segment, 1);
    rig_set_body(&rig, (dpt_body_settings){ .static_friction = friction, .kinetic_friction = friction });
    pose_orient(&rig.device, (const double[3]){ 0, 0, 1 }, turn);
    rig.device.position[2] = 0.02;
    rig_place(&rig);
    for (uint64_t i = 0; i < ticks; i++) {
        if (i % 60 == 0)
            for (int k = 0; k < 3; k++)
                aim[k] = k == 2 ? random_in(&seed, -0.004, 0.002) : random_in(&seed, -0.004, 0.004);
        for (int k = 0; k < 3; k++)
            rig.device.position[k] += fmax(-2e-4, fmin(2e-4, 0.1 * (aim[k] - rig.device.position[k])));
        rig_step(&rig);
        if (i % 4 || rig_force(&rig) < 0.2)
            continue;
        struct touch touches[TOUCHES_MAX];
        double ends[6];
        int count = 0;
        rig_proxy_ends(&rig, 0, ends);
        for (int e = 0; e < (turn > 0 ? 2 : 1); e++)
            for (int s = -1; s <= 1; s += 2) {
                const double n[3] = { -s * sqrt(0.5), 0, sqrt(0.5) };
                if (dot3(n, ends + 3 * e) > segment->radius + 2e-5)
                    continue;
                for (int k = 0; k < 3; k++) {
                    touches[count].normal[k] = n[k];
                    touches[count].x[k] = ends[3 * e + k] - segment->radius * n[k];
                }
                count++;
            }
        const double wrong = off_the_cones(rig.force.wrench.force, rig.force.wrench.torque, rig.device.position,
                                           segment == &lying, 0.005, touches, count, 1.01 * friction);
        worst = fmax(worst, wrong);
        off += wrong > 0.01;
        acts++;
        CHECK(wrong < 0.01, "friction %g, turn %g, tick %llu: %g off the cones of %d", friction, turn,
              (unsigned long long)i, wrong, count);
    }
    CHECK(acts >= least_seen(ticks / 10), "only %llu ticks", (unsigned long long)acts);
    printf("    friction %g, turn %g: at most %.3g off the cones, %llu of %llu ticks by 1 %%\n", friction, turn, worst,
           (unsigned long long)off, (unsigned long long)acts);
    rig_close(&rig);
}

static void wrenches_are_in_the_cones(void)
{
    struct solid groove;
    if (!open_groove(&groove, 1))
        return;
    for (uint64_t seed = 1; seed <= part_of(3); seed++) {
        pull_in_groove(&groove, &ball, 0, 0.3, seed);
        pull_in_groove(&groove, &ball, 0, 0.8, seed);
        pull_in_groove(&groove, &lying, 0.5 * 3.14159265358979, 0.3, seed);
        pull_in_groove(&groove, &lying, 0.5 * 3.14159265358979, 0.8, seed);
    }
    solid_close(&groove);
}

/*
 * Pressed straight down on a slope it sticks up to the angle of friction, and slips beyond. A lying tool rolls on the
 * slope: the springs of its shift and of its spin, K r^2, share what is held.
 */
static void a_slope_is_held_up_to_its_angle(void)
{
    struct solid box;
    if (!solid_from_shape(&box, "box", 1200))
        return;
    const double friction = 0.4;
    for (int i = 0; i < 12; i++) {
        const dpt_segment *segment = i % 2 ? &lying : &ball;
        const double shares = i % 2 ? 2 : 1;
        const double slope = atan(shares * friction) * (i < 6 ? 0.8 + 0.03 * i : 1.02 + 0.05 * (i - 6));
        dpt_pose pose = DPT_POSE_IDENTITY;
        struct rig rig;
        rig_open(&rig, NULL, box.mesh, segment, 1);
        rig_set_body(&rig, (dpt_body_settings){ .static_friction = friction, .kinetic_friction = friction });
        pose_orient(&pose, (const double[3]){ 1, 0, 0 }, slope);
        dpt_body_teleport(rig.world, rig.body, &pose);
        rig.device.position[2] = (TOP + segment->radius) / cos(slope) + 0.001;
        rig_place(&rig);
        for (int k = 0; k < 60; k++) {
            rig.device.position[2] -= 5e-5;
            rig_step(&rig);
        }
        /* Along the slope: nothing where it sticks, and where it slips what the cone leaves of the depth of 2 mm. */
        const double *p = rig.proxy.position, *d = rig.device.position;
        const double slid = -((p[1] - d[1]) * cos(slope) + (p[2] - d[2]) * sin(slope));
        const double held = 0.002 * sin(slope) / shares, kept = friction * 0.002 * cos(slope);
        const double expected = -fmin(held, kept);
        CHECK(fabs(slid - expected) < 0.01 * held, "%d, slope %g of %g: %g along it, not %g", i, slope, atan(friction),
              slid, expected);
        rig_close(&rig);
    }
    solid_close(&box);
}

/* From 1 mm above to 2 mm deep. */
static void press(struct rig *rig)
{
    for (int k = 0; k < 30; k++) {
        rig->device.position[2] -= 1e-4;
        rig_step(rig);
    }
}

/* A body that moves under a tool that sticks takes it along, up to the cone, with the force of the spring. */
static void a_body_that_moves_takes_it_along(void)
{
    struct solid box;
    if (!solid_from_shape(&box, "box", 1200))
        return;
    for (int i = 0; i < 2; i++) {
        const dpt_segment *segment = i ? &lying : &ball;
        const double friction = 0.5, depth = 0.002, step = 2e-5;
        dpt_pose pose = DPT_POSE_IDENTITY;
        struct rig rig;
        rig_open(&rig, NULL, box.mesh, segment, 1);
        rig_set_body(&rig, (dpt_body_settings){ .static_friction = friction, .kinetic_friction = friction });
        rig.device.position[2] = TOP + segment->radius + 0.001;
        rig_place(&rig);
        press(&rig);
        for (int k = 1; k <= 200; k++) {
            pose.position[0] = step * k;
            dpt_body_set_pose(rig.world, rig.body, &pose);
            rig_step(&rig);
            const double expected = RIG_STIFFNESS * fmin(step * k, friction * depth);
            CHECK(fabs(rig.force.wrench.force[0] - expected) < 0.01 * friction * RIG_STIFFNESS * depth,
                  "%d, tick %d: %g N, not %g", i, k, rig.force.wrench.force[0], expected);
        }
        rig_close(&rig);
    }
    solid_close(&box);
}

/*
 * A tool lies across the edges of two boxes and sticks to both. One goes to and fro along its edge: the point that touches
 * there goes with it, the one on the other edge stays where it is, however often.
 */
static void what_sticks_to_two_bodies_stays_on_both(void)
{
    struct solid box;
    if (!solid_from_shape(&box, "box", 1200))
        return;
    for (int moving = 0; moving < 2; moving++) {
        const double friction = 0.8, way = 2e-5, aside = 0.006;
        const double *half = box.info.box_max, top = sqrt(0.5) * (half[0] + half[2]);
        dpt_pose places[2] = { DPT_POSE_IDENTITY, DPT_POSE_IDENTITY };
        dpt_body bodies[2];
        double touched[2][3], start[2][3], now[2][3], stayed = 0, followed = 0;
        struct rig rig;
        rig_open(&rig, NULL, box.mesh, &lying, 1);
        bodies[0] = rig.body;
        CHECK(!dpt_body_add(rig.world, box.mesh, NULL, &bodies[1]), "a second box");
        for (int b = 0; b < 2; b++) {
            rig.body = bodies[b];
            rig_set_body(&rig, (dpt_body_settings){ .static_friction = friction, .kinetic_friction = friction });
            places[b].position[0] = (b ? aside : -aside) - sqrt(0.5) * (half[2] - half[0]);
            pose_orient(&places[b], (const double[3]){ 0, 1, 0 }, 0.25 * 3.14159265358979);
            CHECK(!dpt_body_teleport(rig.world, bodies[b], &places[b]), "a place");
        }
        rig.device.position[2] = top + lying.radius + 0.001;
        rig_place(&rig);
        press(&rig);
        for (int b = 0; b < 2; b++) {
            memcpy(start[b], (const double[3]){ b ? aside : -aside, 0, top }, sizeof start[b]);
            pose_local(&rig.proxy, start[b], touched[b]);
        }
        for (int k = 1; k <= 2000; k++) {
            places[moving].position[1] = way * sin(0.05 * k);
            CHECK(!dpt_body_set_pose(rig.world, bodies[moving], &places[moving]), "a place");
            rig_step(&rig);
            for (int b = 0; b < 2; b++)
                pose_point(&rig.proxy, touched[b], now[b]);
            now[moving][1] -= places[moving].position[1];
            stayed = fmax(stayed, apart(now[!moving], start[!moving]));
            followed = fmax(followed, apart(now[moving], start[moving]));
        }
        printf("    one of two moves by %g m: what sticks to it is off by %.2g m, to the other by %.2g m\n", way,
               followed, stayed);
        CHECK(stayed < 0.02 * way, "body %d moves: what sticks to the other one moved by %g m", moving, stayed);
        CHECK(followed < 0.02 * way, "body %d moves: what sticks to it is %g m off", moving, followed);
        rig_close(&rig);
    }
    solid_close(&box);
}

/* At 0.9 of the cone and with a tremor it stays where it sticks, for 10^5 ticks. */
static void what_sticks_does_not_creep(void)
{
    static const dpt_segment needle = { { 0, 0, 0 }, { 0, 0, 0.1 }, 0.001 };
    struct solid box;
    if (!solid_from_shape(&box, "box", 1200))
        return;
    const uint64_t ticks = part_of(100000);
    for (int i = 0; i < 2; i++) {
        const dpt_segment *segment = i ? &needle : &ball;
        const double friction = 0.5, depth = 0.002, place[3] = { 0.0123, 0.0071, TOP + segment->radius };
        double start[6], ends[6], far = 0;
        struct rig rig;
        rig_open(&rig, NULL, box.mesh, segment, 1);
        rig_set_body(&rig, (dpt_body_settings){ .static_friction = friction, .kinetic_friction = friction });
        pose_orient(&rig.device, (const double[3]){ 1, 0, 0 }, i ? 0.5 : 0.0);
        memcpy(rig.device.position, place, sizeof place);
        rig.device.position[2] += 0.001;
        rig_place(&rig);
        press(&rig);
        for (int k = 0; k < 90; k++) {
            rig.device.position[0] += 0.01 * friction * depth;
            rig_step(&rig);
        }
        const dpt_pose held = rig.device;
        for (uint64_t k = 0; k < ticks; k++) {
            for (int d = 0; d < 3; d++)
                rig.device.position[d] = held.position[d] + 3e-5 * sin((0.06 + 0.007 * d) * (double)k);
            rig_step(&rig);
            rig_proxy_ends(&rig, 0, ends);
            if (k == 0)
                memcpy(start, ends, sizeof start);
            far = fmax(far, fabs(ends[0] - start[0]));
            if (rig.force.slipping)
                break;
        }
        printf("    %s: in %llu ticks it is off by %.2g m at most\n", i ? "needle" : "ball", (unsigned long long)ticks,
               far);
        CHECK(!rig.force.slipping && rig.force.sticking == 1, "%d: it slips", i);
        CHECK(far < 1e-6, "%d: its end moved by %g m", i, far);
        rig_close(&rig);
    }
    solid_close(&box);
}

/* Dragged over many triangles, contacts split, merge and change: it slips at the cone of motion all the way. */
static void contacts_that_change_keep_the_cone(void)
{
    struct solid box;
    uint64_t seed = 6;
    if (!solid_from_shape(&box, "box", 4800))
        return;
    for (uint64_t turn = 0; turn < part_of(12); turn++) {
        struct rig rig;
        const double friction = 0.3, yaw = random_in(&seed, 0, 3.1), way = random_in(&seed, 0, 6.2);
        uint64_t off = 0;
        rig_open(&rig, NULL, box.mesh, &lying, 1);
        rig_set_body(&rig, (dpt_body_settings){ .static_friction = friction, .kinetic_friction = friction });
        pose_orient(&rig.device, (const double[3]){ 0, 0, 1 }, yaw);
        rig.device.position[0] = -0.025 * cos(way);
        rig.device.position[1] = -0.025 * sin(way);
        rig.device.position[2] = TOP + lying.radius + 0.001;
        rig_place(&rig);
        for (int i = 0; i < 30; i++) {
            rig.device.position[2] -= 1e-4;
            rig_step(&rig);
        }
        for (int i = 0; i < 500; i++) {
            rig.device.position[0] += 1e-4 * cos(way);
            rig.device.position[1] += 1e-4 * sin(way);
            rig_step(&rig);
            const double *f = rig.force.wrench.force, across = hypot(f[0], f[1]);
            CHECK(across <= 1.01 * friction * f[2], "yaw %g, tick %d: %g N across, %g out", yaw, i, across, f[2]);
            off += i > 100 && across < 0.97 * friction * f[2];
        }
        CHECK(off < 10, "yaw %g: %llu of 400 ticks below the cone", yaw, (unsigned long long)off);
        rig_close(&rig);
    }
    solid_close(&box);
}

/*
 * A tip that lies on two triangles which are nearly flat has one contact: it slips at the cone, and held below it stays,
 * whichever of the two takes the load. The proxy is at rest in each tick.
 */
static void two_triangles_under_a_tip_are_one_contact(void)
{
    static const dpt_segment needle = { { 0, 0, 0 }, { 0, 0, 0.1 }, 0.002 };
    const double friction = 0.3, depth = 0.005;
    uint64_t seed = 7;
    for (uint64_t turn = 0; turn < part_of(24); turn++) {
        struct solid groove;
        struct rig rig;
        double tremor[3] = { 0, 0, 0 }, stuck[6], tip[6];
        uint64_t lagging = 0;
        if (!open_groove(&groove, random_in(&seed, 0.01, 0.12)))
            return;
        rig_open(&rig, NULL, groove.mesh, &needle, 1);
        rig_set_body(&rig, (dpt_body_settings){ .static_friction = friction, .kinetic_friction = friction });
        pose_orient(&rig.device, (const double[3]){ 1, 0, 0 }, random_in(&seed, -0.3, 0.3));
        rig.device.position[2] = needle.radius + 0.001;
        rig_place(&rig);
        for (int i = 0; i < 60; i++) {
            rig.device.position[2] -= depth / 50;
            rig_step(&rig);
        }
        for (int i = 0; i < 400; i++) {
            rig.device.position[1] += 1e-4;
            for (int k = 0; k < 3; k++) {
                rig.device.position[k] -= tremor[k];
                tremor[k] = 0.9 * tremor[k] + random_in(&seed, -6e-5, 6e-5);
                rig.device.position[k] += tremor[k];
            }
            rig_step(&rig);
            const double *f = rig.force.wrench.force;
            lagging += rig.force.lag > 0.01 * rig_force(&rig) / RIG_STIFFNESS;
            CHECK(rig.force.sticking + rig.force.slipping == 1, "turn %llu, tick %d: %u and %u",
                  (unsigned long long)turn, i, rig.force.sticking, rig.force.slipping);
            CHECK(fabs(f[1]) <= 1.01 * friction * hypot(f[0], f[2]), "turn %llu, tick %d: %g N across, %g out",
                  (unsigned long long)turn, i, f[1], f[2]);
            CHECK(i < 100 || f[1] <= -0.9 * friction * f[2], "turn %llu, tick %d: %g N across",
                  (unsigned long long)turn, i, f[1]);
        }
        CHECK(!lagging, "turn %llu: %llu of 400 ticks lag", (unsigned long long)turn, (unsigned long long)lagging);
        for (int k = 0; k < 3; k++) {
            rig.device.position[k] -= tremor[k];
            tremor[k] = 0;
        }
        for (int i = 0; i < 20; i++) {
            rig.device.position[1] += 1e-4;
            rig_step(&rig);
        }
        rig.device.position[1] -= 0.1 * friction * depth;
        for (int i = 0; i < 4000; i++) {
            for (int k = 0; k < 3; k++)
                rig.device.position[k] += i % 2 ? -tremor[k] : 0;
            for (int k = 1; k < 3 && i % 2 == 0; k++) {
                tremor[k] = random_in(&seed, -1e-5, 1e-5);
                rig.device.position[k] += tremor[k];
            }
            rig_step(&rig);
            rig_proxy_ends(&rig, 0, i < 200 ? stuck : tip);
        }
        CHECK(fabs(tip[1] - stuck[1]) < 1e-6, "turn %llu: it crept by %g m", (unsigned long long)turn,
              tip[1] - stuck[1]);
        rig_close(&rig);
        solid_close(&groove);
    }
}

static void spin_is_the_devices(const struct rig *rig, int tick)
{
    double same = 0;
    for (int k = 0; k < 4; k++)
        same += rig->proxy.orientation[k] * rig->device.orientation[k];
    CHECK(fabs(same) > 1 - 1e-9, "tick %d: the proxy's spin is not the device's", tick);
}

/* Without friction a lying tool that is spun about its own axis goes nowhere, and its proxy spins with it. */
static void a_spin_moves_nothing(void)
{
    struct solid box;
    struct rig rig;
    if (!solid_from_shape(&box, "box", 1200))
        return;
    rig_open(&rig, NULL, box.mesh, &lying, 1);
    rig.device.position[2] = TOP + lying.radius + 0.001;
    rig_place(&rig);
    press(&rig);
    const dpt_pose at = rig.proxy;
    for (int i = 0; i < 2000; i++) {
        pose_orient(&rig.device, (const double[3]){ 1, 0, 0 }, 0.01 * i);
        rig_step(&rig);
        CHECK(apart(rig.proxy.position, at.position) < 1e-8, "tick %d: %g m away", i,
              apart(rig.proxy.position, at.position));
        CHECK(fabs(rig_force(&rig) - 1) < 1e-3, "tick %d: %g N", i, rig_force(&rig));
        spin_is_the_devices(&rig, i);
    }
    rig_close(&rig);
    solid_close(&box);
}

/*
 * One that is too thin for friction to have a lever about its axis spins with its device, on a surface that rubs too: the
 * square of the lever is 0 here.
 */
static void nothing_holds_the_spin_of_a_thin_line(void)
{
    static const dpt_segment thin = { { -0.01, 0, 0 }, { 0.01, 0, 0 }, 1e-200 };
    struct solid box;
    struct rig rig;
    if (!solid_from_shape(&box, "box", 1200))
        return;
    rig_open(&rig, NULL, box.mesh, &thin, 1);
    rig_set_body(&rig, (dpt_body_settings){ .static_friction = 0.5, .kinetic_friction = 0.5 });
    rig.device.position[2] = TOP + 0.001;
    rig_place(&rig);
    press(&rig);
    CHECK(rig.force.reason == DPT_FORCE_ACTS, "it is not held");
    for (int i = 0; i < 200; i++) {
        pose_orient(&rig.device, (const double[3]){ 1, 0, 0 }, 0.01 * i);
        rig_step(&rig);
        spin_is_the_devices(&rig, i);
    }
    rig_close(&rig);
    solid_close(&box);
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(wrenches_are_in_the_cones);
    TEST(a_slope_is_held_up_to_its_angle);
    TEST(a_body_that_moves_takes_it_along);
    TEST(what_sticks_to_two_bodies_stays_on_both);
    TEST(what_sticks_does_not_creep);
    TEST(contacts_that_change_keep_the_cone);
    TEST(two_triangles_under_a_tip_are_one_contact);
    TEST(a_spin_moves_nothing);
    TEST(nothing_holds_the_spin_of_a_thin_line);
    return check_report();
}
