/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What a budget does to contact: the gap comes first, regions with what is left, and a tool that rests has both after
 * some ticks, as if there were no budget. What a region says of itself is so: one that is not coarse is as right as a
 * quadrature of single points tells, which takes signs from the library's own queries.
 */
#include "track/budget_contact_scene.h"

static double overlap_of(const struct contact_world *one)
{
    double sum = 0.0;
    for (uint32_t i = 0; i < one->count; i++)
        sum += one->contacts[i].overlap;
    return sum;
}

/* By points, each of which is a query of its own. */
static double quadrature(const dpt_mesh *mesh, const dpt_segment *axis)
{
    enum { POINTS = 4096 };
    static double ends[6 * POINTS];
    static dpt_hit hits[POINTS];
    double sum = 0.0, square = 0.0;
    hits[0].size = sizeof *hits;
    for (int i = 0; i < POINTS; i++)
        for (int k = 0; k < 3; k++)
            ends[6 * i + k] = ends[6 * i + 3 + k] = axis->a[k] + (i + 0.5) / POINTS * (axis->b[k] - axis->a[k]);
    CHECK(dpt_query_segments(mesh, NULL, ends, NULL, POINTS, hits, NULL) == DPT_OK, "query");
    for (int i = 0; i < POINTS; i++)
        sum += fmax(0.0, axis->radius + contact_margin - hits[i].gap);
    for (int k = 0; k < 3; k++)
        square += pow(axis->b[k] - axis->a[k], 2);
    return sum * sqrt(square) / POINTS;
}

static const char *const names[] = { "torus", "liver", "star", "sphere" };
enum { SHAPES = sizeof names / sizeof *names };

static int open_shape(struct subject *subject, int which)
{
    static const uint64_t counts[SHAPES] = { 5568, 5000, 0, 1280 };
    int made = subject_from_shape(subject, names[which], counts[which]);
    contact_margin = 0.01 * subject->diagonal;
    return made;
}

/* A real pair: p on the axis, q on the triangle that is named, as far apart as the gap says. */
static void contact_is_real(const struct subject *subject, const dpt_segment *axis, const dpt_contact *contact)
{
    double corners[9], s, p[3], q[3], off[3] = { 0.0 }, gap[3];
    dpt_mesh_get_triangle(subject->mesh, contact->triangle, corners);
    for (int k = 0; k < 3; k++) {
        off[0] = fmax(off[0], fabs(axis->a[k] + contact->s * (axis->b[k] - axis->a[k]) - contact->p[k]));
        gap[k] = contact->p[k] - contact->q[k];
    }
    const double point[6] = {
        contact->q[0], contact->q[1], contact->q[2], contact->q[0], contact->q[1], contact->q[2]
    };
    off[1] = dpt_segment_triangle(point, corners, &s, p, q);
    off[2] = fabs(sqrt(gap[0] * gap[0] + gap[1] * gap[1] + gap[2] * gap[2]) - fabs(contact->gap + axis->radius));
    for (int k = 0; k < 3; k++)
        CHECK(off[k] < 1e-9 * subject->diagonal, "%s: %d off by %g", subject->name, k, off[k]);
}

/* Real pairs, none deeper than the tool; those that are not coarse as deep as without a budget. */
static void regions_are_true(const struct subject *subject, const dpt_segment *axis)
{
    const double tolerance = 2e-5 * subject->diagonal;
    for (uint32_t i = 0; i < small_world.count; i++) {
        contact_is_real(subject, axis, &small_world.contacts[i]);
        CHECK(small_world.contacts[i].gap > small_world.rig.hit.gap - tolerance, "%s: %g is deeper than the tool, %g",
              subject->name, small_world.contacts[i].gap, small_world.rig.hit.gap);
        if (!small_world.coarse && !ample_world.coarse && small_world.count == ample_world.count)
            CHECK(fabs(small_world.contacts[i].gap - ample_world.contacts[i].gap) < tolerance,
                  "%s: region %u: %g, not %g", subject->name, i, small_world.contacts[i].gap,
                  ample_world.contacts[i].gap);
    }
}

/* A rest in some pose, if the axis crosses. */
static struct rests {
    uint32_t count, later, tired, bare, coarse_first, longest, longest_fine;
    double gap, overlap;
} rests;

static void rest(const struct subject *subject, const dpt_segment *axis, uint32_t budget)
{
    uint32_t known = 0, fine = 0;
    contact_world_open(&ample_world, subject->mesh, axis, 0);
    contact_world_open(&small_world, subject->mesh, axis, budget);
    contact_world_step(&ample_world);
    if (ample_world.rig.hit.distance == 0.0 && is_known(&ample_world)) {
        for (uint32_t tick = 1; tick <= TICKS_MAX && !(fine && tick > fine + 5); tick++) {
            contact_world_step(&small_world);
            CHECK(small_world.rig.step.work <= budget, "%u of %u units", small_world.rig.step.work, budget);
            if (!is_known(&small_world)) {
                CHECK(small_world.rig.hit.flags & DPT_HIT_FLAG_BUDGET, "flags %u", small_world.rig.hit.flags);
                CHECK(!known && small_world.rig.hit.depth == 0.0, "%s: unknown at tick %u, known at %u", subject->name,
                      tick, known);
                continue;
            }
            rests.coarse_first += !known && small_world.coarse;
            known = known ? known : tick;
            CHECK(small_world.coarse || small_world.count, "%s: no region", subject->name);
            fine = small_world.coarse ? 0 : fine ? fine : tick;
            rests.gap = fmax(rests.gap, fabs(small_world.rig.hit.gap - ample_world.rig.hit.gap) / subject->diagonal);
            regions_are_true(subject, axis);
        }
        CHECK(known, "%s: never known, budget %u", subject->name, budget);
        rests.tired += !fine && small_world.rig.step.work < budget; /* the samples have no more room */
        rests.bare += !fine && small_world.rig.step.work == budget;
        rests.count++;
        rests.later += known > 1;
        rests.longest = known > rests.longest ? known : rests.longest;
        rests.longest_fine = fine > rests.longest_fine ? fine : rests.longest_fine;
        double due = quadrature(subject->mesh, axis);
        if (fine)
            rests.overlap = fmax(rests.overlap, fabs(overlap_of(&small_world) - due) / due);
    }
    rig_close(&ample_world.rig);
    rig_close(&small_world.rig);
}

static void a_rest_comes_to_its_contact(void)
{
    uint64_t seed = 11;
    for (int which = 0; which < SHAPES; which++) {
        struct subject subject;
        if (!open_shape(&subject, which))
            return;
        rests = (struct rests){ 0 };
        for (uint32_t i = 0; i < rest_count(); i++) {
            dpt_segment axis = random_axis(&subject, &seed, 0.6);
            rest(&subject, &axis, i % 2 ? SMALL : 3 * SMALL);
        }
        printf("    %-12s %u rests, %u not known at once, after %u ticks at most;", subject.name, rests.count,
               rests.later, rests.longest);
        printf(" fine after %u, never %u and %u;", rests.longest_fine, rests.tired, rests.bare);
        printf(" gap off by %.1e of the diagonal, overlap by %.2f %%\n", rests.gap, 100.0 * rests.overlap);
        CHECK(rests.count > rest_count() / 3 && rests.later + rests.coarse_first > rests.count / 10, "%u of %u",
              rests.later + rests.coarse_first, rests.count);
        CHECK(rests.longest <= 10 && rests.bare <= 1 + rests.count / 40, "%u ticks, %u", rests.longest, rests.bare);
        CHECK(rests.gap < 2e-5, "%g", rests.gap);
        CHECK(rests.overlap < 0.005, "%g", rests.overlap);
        subject_close(&subject);
    }
}

/* Near the holes of the last one a side is a winding number, which may take 510 units at once. */
static void organs_at_rest(void)
{
    static const char *const files[] = { "openhelp_liver.stl", "gallbladder_fine.stl", "skull_and_teeth_sofa.obj" };
    uint64_t seed = 4;
    const char *data = getenv("DPT_DATA");
    if (!data) {
        SKIP("organs_at_rest", "DPT_DATA is not set");
        return;
    }
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        struct subject subject;
        if (!subject_from_file(&subject, data, "organs", files[i]))
            return;
        contact_margin = 0.01 * subject.diagonal;
        rests = (struct rests){ 0 };
        for (uint32_t k = 0; k < rest_count() / 4; k++) {
            dpt_segment axis = random_axis(&subject, &seed, 0.6);
            rest(&subject, &axis, 3 * SMALL);
        }
        printf("    %-26s %u rests, %u not known at once, after %u ticks at most;", subject.name, rests.count,
               rests.later, rests.longest);
        printf(" gap off by %.1e of the diagonal\n", rests.gap);
        CHECK(rests.count > rest_count() / 20 && rests.longest < 40 && rests.gap < 2e-5, "%u, %u, %g", rests.count,
              rests.longest, rests.gap);
        subject_close(&subject);
    }
}

/* One tick of both worlds, the axis a little nearer to the end of its way. */
static void step_both_towards(dpt_segment *axis, const dpt_segment *way)
{
    for (int k = 0; k < 3; k++) {
        axis->a[k] += (way->a[k] - axis->a[k]) / 300.0;
        axis->b[k] += (way->b[k] - axis->b[k]) / 300.0;
    }
    dpt_tool_set_segments(ample_world.rig.world, ample_world.rig.tool, axis, 1);
    dpt_tool_set_segments(small_world.rig.world, small_world.rig.tool, axis, 1);
    contact_world_step(&ample_world);
    contact_world_step(&small_world);
}

/* A tool that goes through a mesh slowly: contact on nearly every tick with a sixth of what regions may take. */
static void in_motion_the_gap_comes_first(void)
{
    uint64_t seed = 3;
    for (int which = 0; which < 3; which++) {
        struct subject subject;
        uint32_t crossing = 0, unknown = 0, coarse = 0;
        double off = 0.0;
        if (!open_shape(&subject, which))
            return;
        dpt_segment axis = random_axis(&subject, &seed, 0.6), way = axis;
        contact_world_open(&ample_world, subject.mesh, &axis, 0);
        contact_world_open(&small_world, subject.mesh, &axis, 2 * SMALL);
        for (uint32_t tick = 0; tick < tick_count(); tick++) {
            if (tick % 400 == 0)
                way = random_axis(&subject, &seed, 0.6);
            step_both_towards(&axis, &way);
            CHECK(small_world.rig.step.work <= 2 * SMALL, "%u units", small_world.rig.step.work);
            if (ample_world.rig.hit.distance > 0.0)
                continue;
            crossing++;
            unknown += !is_known(&small_world);
            CHECK(is_known(&small_world) != !!(small_world.rig.hit.flags & DPT_HIT_FLAG_BUDGET), "flags %u",
                  small_world.rig.hit.flags);
            coarse += is_known(&small_world) && small_world.coarse;
            if (is_known(&small_world))
                off = fmax(off, fabs(small_world.rig.hit.gap - ample_world.rig.hit.gap) / subject.diagonal);
            if (is_known(&small_world))
                regions_are_true(&subject, &axis);
        }
        printf("    %-12s %u ticks cross, %u unknown, %u coarse; gap off by %.1e of the diagonal\n", subject.name,
               crossing, unknown, coarse, off);
        CHECK(crossing > tick_count() / 5 && (which == 2 || unknown <= 1 + crossing / 100), "%u of %u", unknown,
              crossing);
        CHECK(off < 2e-5, "%g", off);
        rig_close(&ample_world.rig);
        rig_close(&small_world.rig);
        subject_close(&subject);
    }
}

/* With more than it needs, a tool in motion does the work of one without a budget. */
static void what_is_ample_is_no_dearer(void)
{
    enum { TICKS = 1000 }; /* the first ones are dearer */
    uint64_t seed = 4;
    for (int which = 0; which < 2; which++) {
        struct subject subject;
        uint64_t work[2] = { 0, 0 };
        if (!open_shape(&subject, which))
            return;
        dpt_segment axis = random_axis(&subject, &seed, 0.6), way = axis;
        contact_world_open(&ample_world, subject.mesh, &axis, 0);
        contact_world_open(&small_world, subject.mesh, &axis, 20000);
        for (uint32_t tick = 0; tick < TICKS; tick++) {
            if (tick % 400 == 0)
                way = random_axis(&subject, &seed, 0.6);
            step_both_towards(&axis, &way);
            work[0] += ample_world.rig.step.work;
            work[1] += small_world.rig.step.work;
        }
        const double ratio = (double)work[1] / (double)work[0];
        printf("    %-12s %.4f of the work without a budget\n", subject.name, ratio);
        CHECK(ratio < 1.01, "%g", ratio);
        rig_close(&ample_world.rig);
        rig_close(&small_world.rig);
        subject_close(&subject);
    }
}

/* Without a budget too: a region says when room or work for its samples ended before it was as right as the others. */
static void what_is_not_coarse_is_right(void)
{
    uint64_t seed = 8;
    for (int which = 0; which < SHAPES; which++) {
        struct subject subject;
        uint32_t count[2] = { 0, 0 };
        double off[2] = { 0.0, 0.0 };
        if (!open_shape(&subject, which))
            return;
        for (uint32_t i = 0; i < pose_count(); i++) {
            dpt_segment axis = random_axis(&subject, &seed, 2.0);
            contact_world_open(&ample_world, subject.mesh, &axis, 0);
            contact_world_step(&ample_world);
            if (is_known(&ample_world) && ample_world.rig.hit.distance == 0.0) {
                int coarse = ample_world.coarse != 0;
                double due = quadrature(subject.mesh, &axis);
                count[coarse]++;
                off[coarse] = fmax(off[coarse], fabs(overlap_of(&ample_world) - due) / due);
            }
            rig_close(&ample_world.rig);
        }
        printf("    %-12s fine %u, overlap off by %.2f %%; coarse %u, by %.2f %%\n", subject.name, count[0],
               100.0 * off[0], count[1], 100.0 * off[1]);
        CHECK(count[0] > pose_count() / 7 && off[0] < 0.005, "%u, %g", count[0], off[0]);
        CHECK(which == 2 ? off[1] > off[0] : count[1] < count[0] / 4, "%u, %g", count[1], off[1]);
        subject_close(&subject);
    }
}

/* A tool through two bodies needs both. */
static void of_several_bodies(void)
{
    struct subject liver, star;
    uint64_t seed = 21;
    uint32_t both = 0, later = 0;
    if (!open_shape(&liver, 1) || !open_shape(&star, 2))
        return;
    for (uint32_t i = 0; i < rest_count() / 3; i++) {
        dpt_segment axis = random_axis(&liver, &seed, 2.0);
        dpt_pose pose = DPT_POSE_IDENTITY;
        dpt_body body;
        uint32_t known = 0, bodies = 0, coarse = 1;
        for (int k = 0; k < 3; k++)
            pose.position[k] = random_in(&seed, -0.3, 0.3) * liver.diagonal;
        contact_world_open(&ample_world, liver.mesh, &axis, 0);
        contact_world_open(&small_world, liver.mesh, &axis, SMALL);
        dpt_body_add(ample_world.rig.world, star.mesh, &pose, &body);
        dpt_body_add(small_world.rig.world, star.mesh, &pose, &body);
        contact_world_step(&ample_world);
        for (uint32_t k = 0; k < ample_world.count; k++)
            bodies |= 1u << (ample_world.contacts[k].body == body);
        for (uint32_t tick = 1; tick <= TICKS_MAX && bodies == 3; tick++) {
            contact_world_step(&small_world);
            CHECK(is_known(&small_world) || !known, "tick %u: unknown, known at %u", tick, known);
            known = known || !is_known(&small_world) ? known : tick;
            coarse = small_world.coarse;
        }
        if (bodies == 3 && is_known(&ample_world)) {
            CHECK(known, "never known");
            CHECK(fabs(small_world.rig.hit.gap - ample_world.rig.hit.gap) < 2e-5 * star.diagonal, "%g, not %g",
                  small_world.rig.hit.gap, ample_world.rig.hit.gap);
            both++;
            later += known > 1 || coarse;
        }
        rig_close(&ample_world.rig);
        rig_close(&small_world.rig);
    }
    printf("    %u rests through both, %u not at once or still coarse\n", both, later);
    CHECK(both > rest_count() / 20 && later > 0, "%u, %u", both, later);
    subject_close(&liver);
    subject_close(&star);
}

/* What was found of a body is another's no more. */
static void what_was_found_leaves_with_its_body(void)
{
    struct subject first, second;
    const dpt_segment axis = { { 0.001, -0.002, 0.003 }, { 0.3, 0.4, 0.2 }, 0.001 };
    if (!subject_from_shape(&first, "sphere", 1280) || !subject_from_shape(&second, "sphere", 320))
        return;
    for (int resets = 0; resets < 2; resets++) {
        contact_world_open(&small_world, first.mesh, &axis, SMALL);
        contact_world_open(&ample_world, resets ? first.mesh : second.mesh, &axis, SMALL);
        for (int tick = 0; tick < 20; tick++)
            contact_world_step(&small_world);
        CHECK(is_known(&small_world) && small_world.rig.hit.distance == 0.0, "no contact");
        if (resets) {
            dpt_world_reset(small_world.rig.world);
        } else {
            dpt_body_remove(small_world.rig.world, small_world.rig.body);
            dpt_body_add(small_world.rig.world, second.mesh, NULL, &small_world.rig.body);
        }
        for (int tick = 0; tick < 20; tick++) {
            contact_world_step(&small_world);
            contact_world_step(&ample_world);
            CHECK(small_world.rig.step.work == ample_world.rig.step.work &&
                      small_world.rig.hit.gap == ample_world.rig.hit.gap &&
                      small_world.rig.hit.contact == ample_world.rig.hit.contact,
                  "%d, tick %d: work %u and %u, gap %g and %g", resets, tick, small_world.rig.step.work,
                  ample_world.rig.step.work, small_world.rig.hit.gap, ample_world.rig.hit.gap);
        }
        CHECK(is_known(&ample_world), "no contact");
        rig_close(&small_world.rig);
        rig_close(&ample_world.rig);
    }
    subject_close(&first);
    subject_close(&second);
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(a_rest_comes_to_its_contact);
    TEST(organs_at_rest);
    TEST(in_motion_the_gap_comes_first);
    TEST(what_is_ample_is_no_dearer);
    TEST(what_is_not_coarse_is_right);
    TEST(of_several_bodies);
    TEST(what_was_found_leaves_with_its_body);
    return check_report();
}
