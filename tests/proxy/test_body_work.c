/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The work of moving bodies on a tool (dpt_force_info.body_work), against the balance of energy: what a law stores
 * more is what bodies and the hand did. The hand's part is the wrench times its motion. It cannot judge friction, which
 * loses energy, but by a bound.
 */
#include "lib/rig.h"
#include "lib/solid.h"

enum { BEATS = 3, TICKS = 800 }; /* ticks a beat */

static struct solid box, liver;
static const dpt_segment capsule = { { -0.03, 0, 0 }, { 0.03, 0, 0 }, 0.002 };
static const dpt_segment offset = { { 0, 0.01, 0 }, { 0, 0.05, 0 }, 0.002 };
static const dpt_segment ball = { { 0, 0, 0 }, { 0, 0, 0 }, 0.004 };

/* How a body moves: up and down, along, and turning. */
struct beat {
    double along[3]; /* m, amplitude */
    double turn;     /* rad, amplitude, about x */
    double hand;     /* m, amplitude of the hand up and down, a quarter of a beat behind */
};

struct books {
    double stored, bodies, hand; /* J: gained since the start */
    double worst, range;         /* J: largest difference, largest energy */
    dpt_force_info last;
    dpt_pose device;
};

static dpt_pose beaten(const struct beat *beat, double phase)
{
    dpt_pose pose = DPT_POSE_IDENTITY;
    const double x[3] = { 1, 0, 0 }, swing = sin(2 * 3.14159265358979 * phase);
    for (int k = 0; k < 3; k++)
        pose.position[k] = beat->along[k] * swing;
    pose_orient(&pose, x, beat->turn * swing);
    return pose;
}

/* The work on the hand: mean of two wrenches times the motion; the tool does not turn. */
static void note(struct books *books, const struct rig *rig, double start)
{
    double work = 0;
    for (int k = 0; k < 3; k++)
        work += 0.5 * (books->last.wrench.force[k] + rig->force.wrench.force[k]) *
                (rig->device.position[k] - books->device.position[k]);
    books->hand -= work;
    books->bodies += rig->force.body_work;
    books->stored = rig->force.energy - start;
    books->worst = fmax(books->worst, fabs(books->stored - books->bodies - books->hand));
    books->range = fmax(books->range, rig->force.energy);
    books->last = rig->force;
    books->device = rig->device;
}

static void set_law(struct rig *rig, uint32_t law, double friction)
{
    dpt_tool_settings tool = { .size = sizeof tool };
    dpt_body_settings body = { .size = sizeof body };
    dpt_tool_get_settings(rig->world, rig->tool, &tool);
    dpt_body_get_settings(rig->world, rig->body, &body);
    tool.law = law;
    body.static_friction = body.kinetic_friction = friction;
    CHECK(dpt_tool_set_settings(rig->world, rig->tool, &tool) == DPT_OK, "settings");
    rig_set_body(rig, body);
}

/* From above down to `depth` below the top of the mesh's box in the middle. */
static void press(struct rig *rig, const struct solid *solid, double depth)
{
    const double top = solid->info.box_max[2];
    for (int k = 0; k < 2; k++)
        rig->device.position[k] = 0.5 * (solid->info.box_min[k] + solid->info.box_max[k]);
    rig->device.position[2] = top + 0.02;
    rig_place(rig);
    for (int i = 0; i <= 200; i++) {
        rig->device.position[2] = top + 0.02 - (0.02 + depth) * i / 200;
        rig_step(rig);
    }
}

static struct books beat_on(const struct solid *solid, const dpt_segment *segment, uint32_t law, double friction,
                            double stiffness, const struct beat *beat)
{
    struct rig rig;
    struct books books = { .stored = 0 };
    rig_open(&rig, NULL, solid->mesh, segment, 1);
    set_law(&rig, law, friction);
    dpt_body_settings body = { .size = sizeof body };
    dpt_body_get_settings(rig.world, rig.body, &body);
    body.stiffness = stiffness;
    rig_set_body(&rig, body);
    press(&rig, solid, 0.004);
    CHECK(rig.force.reason == DPT_FORCE_ACTS, "reason %u", rig.force.reason);
    CHECK(rig.force.body_work == 0, "a body at rest works: %g", rig.force.body_work);
    const double start = rig.force.energy, height = rig.device.position[2];
    books.last = rig.force;
    books.device = rig.device;
    for (int i = 1; i <= BEATS * TICKS; i++) {
        const double phase = (double)i / TICKS;
        const dpt_pose pose = beaten(beat, phase);
        CHECK(dpt_body_set_pose(rig.world, rig.body, &pose) == DPT_OK, "pose");
        rig.device.position[2] = height + beat->hand * (1 - cos(2 * 3.14159265358979 * phase));
        rig_step(&rig);
        note(&books, &rig, start);
    }
    rig_close(&rig);
    return books;
}

static const struct beat beats[] = {
    { { 0, 0, 0.002 }, 0, 0 },
    { { 0.004, 0.002, 0.001 }, 0.02, 0 },
    { { 0.001, 0, 0.0015 }, 0.03, 0.001 },
};

static void what_is_stored_is_what_bodies_and_the_hand_did(void)
{
    const struct solid *solids[] = { &box, &liver };
    const dpt_segment *tools[] = { &ball, &capsule, &offset };
    const uint32_t laws[] = { DPT_LAW_PROXY, DPT_LAW_BED };
    double worst = 0;
    for (int i = 0; i < 36; i++) {
        const struct beat *beat = &beats[i / 12];
        const struct books books = beat_on(solids[i % 2], tools[i / 4 % 3], laws[i / 2 % 2], 0, 0, beat);
        CHECK(books.range > 1e-4, "case %d: only %g J", i, books.range);
        CHECK(books.worst < 0.01 * books.range, "case %d: off by %g of %g J", i, books.worst, books.range);
        worst = fmax(worst, books.worst / books.range);
    }
    printf("    36 cases: off by at most %.2g of the largest energy\n", worst);
}

static void surfaces_that_yield_do_less(void)
{
    for (int i = 0; i < 3; i++) {
        const struct books hard = beat_on(&box, &ball, DPT_LAW_PROXY, 0, 0, &beats[i]);
        const struct books soft = beat_on(&box, &ball, DPT_LAW_PROXY, 0, 500, &beats[i]);
        CHECK(soft.worst < 0.02 * soft.range && soft.range < 0.6 * hard.range, "beat %d: off by %g of %g J; rigid %g J",
              i, soft.worst, soft.range, hard.range);
    }
}

/* What friction drags along is work, too; more than is stored, as slip loses some. */
static void a_body_that_drags_the_tool_works(void)
{
    const struct beat drag = { { 0.006, 0, 0 }, 0, 0 };
    const struct books slides = beat_on(&box, &capsule, DPT_LAW_PROXY, 0, 0, &drag);
    const struct books drags = beat_on(&box, &capsule, DPT_LAW_PROXY, 0.5, 0, &drag);
    CHECK(fabs(slides.bodies) < 1e-6, "without friction %g J", slides.bodies);
    CHECK(drags.bodies > drags.stored + 1e-4, "%g J for %g J stored", drags.bodies, drags.stored);
    /* At most the friction's force times the way, three times to and fro. */
    const double limit = 0.5 * RIG_STIFFNESS * 0.0045 * 0.006 * 4 * BEATS;
    CHECK(drags.bodies < limit, "%g J, at most %g", drags.bodies, limit);
}

/* Between two plates that move towards each other by different ways. */
static void each_of_two_bodies_works_by_its_own_motion(void)
{
    struct rig rig;
    struct books books = { .stored = 0 };
    dpt_body second;
    rig_open(&rig, NULL, box.mesh, &capsule, 1);
    press(&rig, &box, 0.003);
    const double x = box.info.box_max[0] - box.info.box_min[0];
    dpt_pose pose = DPT_POSE_IDENTITY;
    pose.position[0] = 0.5 * x + 0.035;
    pose.position[2] = 0.01;
    CHECK(dpt_body_add(rig.world, box.mesh, &pose, &second) == DPT_OK, "second");
    rig_step(&rig);
    rig_step(&rig);
    const double start = rig.force.energy, aside = pose.position[0];
    books.last = rig.force;
    books.device = rig.device;
    for (int i = 1; i <= BEATS * TICKS; i++) {
        const struct beat up = { { 0, 0, 0.001 }, 0, 0 };
        const double phase = (double)i / TICKS;
        const dpt_pose first = beaten(&up, phase);
        pose.position[0] = aside - 0.01 * sin(3.14159265358979 * phase) * sin(3.14159265358979 * phase);
        dpt_body_set_pose(rig.world, rig.body, &first);
        dpt_body_set_pose(rig.world, second, &pose);
        rig_step(&rig);
        note(&books, &rig, start);
    }
    CHECK(books.worst < 0.02 * books.range && books.range > 1e-3, "off by %g of %g J", books.worst, books.range);
    rig_close(&rig);
}

int main(void)
{
    if (!solid_from_shape(&box, "box", 300) || !solid_from_shape(&liver, "liver", 5000))
        return 1;
    TEST(what_is_stored_is_what_bodies_and_the_hand_did);
    TEST(surfaces_that_yield_do_less);
    TEST(a_body_that_drags_the_tool_works);
    TEST(each_of_two_bodies_works_by_its_own_motion);
    solid_close(&box);
    solid_close(&liver);
    return check_report();
}
