/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The patch of surface round a proxy (docs/algorithms/patch.md): that it is complete, against all triangles of the body;
 * that it makes no difference to what is felt; and that it is used.
 *
 *     test_proxy_patch [TICKS = 2000]   of each tool on each mesh
 */
#include "lib/fixture.h"
#include "lib/rig.h"
#include "proxy/proxy.h"
#include "proxy/proxy_patch.h"

static int ticks_wanted = 2000;

static struct subject {
    const char *shape;
    uint64_t triangles;
    struct fixture fixture;
    struct surface surface;
    vec3 centre;
    double diagonal;
} subjects[] = { { .shape = "liver", .triangles = 5000 },
                 { .shape = "star", .triangles = 3000 },
                 { .shape = "torus", .triangles = 4000 },
                 { .shape = "sphere", .triangles = 2000 } };

static const struct instrument {
    const char *name;
    dpt_segment segment;
} instruments[] = {
    { "ball of 1 um", { { 0, 0, 0 }, { 0, 0, 0 }, 1e-6 } },
    { "ball of 0.1 mm", { { 0, 0, 0 }, { 0, 0, 0 }, 1e-4 } },
    { "ball of 1 mm", { { 0, 0, 0.01 }, { 0, 0, 0.01 }, 1e-3 } },
    { "ball of 5 mm", { { 0, 0, 0 }, { 0, 0, 0 }, 5e-3 } },
    { "line of 30 mm", { { 0, 0, 0 }, { 0, 0, 0.03 }, 0 } },
    { "needle of 30 mm", { { 0, 0, -0.01 }, { 0, 0, 0.02 }, 1e-3 } },
    { "needle of 0.1 m", { { 0, 0, 0 }, { 0, 0, 0.1 }, 1e-3 } },
};

#define EACH(list) (sizeof(list) / sizeof *(list))

static int open_subject(struct subject *subject)
{
    if (!fixture_from_shape(&subject->fixture, subject->shape, subject->triangles))
        return 0;
    dpti_surface_of_mesh(subject->fixture.mesh, &subject->surface);
    subject->centre = scaled(add(subject->surface.box_min, subject->surface.box_max), 0.5);
    subject->diagonal = length(sub(subject->surface.box_max, subject->surface.box_min));
    return 1;
}

/* A hand that wipes close to the surface, with a tremor, from place to place. */
struct hand {
    const struct subject *subject;
    uint64_t seed;
    double at[3], aim[3], speed, turn;
    int tick;
};

static void hand_begin(struct hand *hand, const struct subject *subject, uint64_t seed)
{
    double way[3];
    *hand = (struct hand){ .subject = subject, .seed = seed };
    random_unit(&hand->seed, way);
    vec3_store(along(subject->centre, 0.5 * subject->diagonal + 0.05, vec3_of(way)), hand->at);
}

/* A place near that of the last aim: all places are on or a little below the surface. */
static void hand_aim(struct hand *hand)
{
    const struct surface *surface = &hand->subject->surface;
    const double last[3] = { hand->aim[0], hand->aim[1], hand->aim[2] };
    do {
        const uint32_t triangle = (uint32_t)(random_bits(&hand->seed) % surface_triangles(surface));
        vec3_store(surface_corner_point(surface, triangle, 0), hand->aim);
    } while (hand->tick && apart(hand->aim, last) > 0.03);
    for (int k = 0; k < 3; k++)
        hand->aim[k] += random_in(&hand->seed, -0.002, 0.002);
    hand->speed = hand->tick ? pow(10, random_in(&hand->seed, -5, -3)) : 1e-3;
}

static void hand_move(struct hand *hand, dpt_pose *pose)
{
    static const double axis[3] = { 0.6, 0, 0.8 };
    double way[3];
    if (hand->tick % 300 == 0)
        hand_aim(hand);
    for (int k = 0; k < 3; k++)
        way[k] = hand->aim[k] - hand->at[k];
    const double far = unit3(way);
    for (int k = 0; k < 3; k++) {
        hand->at[k] += fmin(hand->speed, 0.02 * far) * way[k];
        pose->position[k] = hand->at[k] + 3e-5 * sin(0.06 * (1 + 0.1 * k) * hand->tick + k);
    }
    hand->turn += hand->speed * random_in(&hand->seed, 0, 3);
    pose_orient(pose, axis, hand->turn);
    hand->tick++;
}

static struct proxy_patch *patch_of(const struct rig *rig)
{
    return rig->world->patches;
}

/* So far, of all runs. */
static struct {
    uint64_t ticks, acts, known, judged, used;
} all;

/* Every triangle that near to its axis is in a leaf of the patch. */
static void judge_complete(const struct rig *rig, const char *name)
{
    const struct proxy_patch *patch = patch_of(rig);
    const struct surface *surface = &rig->world->bodies[0].surface;
    if (!(patch->reach > 0.0))
        return;
    all.known++;
    const vec3 u = sub(patch->b, patch->a);
    for (uint32_t t = 0, at = 0; t < surface_triangles(surface); t++) {
        const pair found = dpti_triangle_pair(surface, t, patch->a, u);
        while (at + 1 < patch->count && patch->leaf[at] < t / LANES)
            at++;
        const int is_in = patch->count && patch->leaf[at] == t / LANES;
        all.judged++;
        CHECK(is_in || sqrt(found.distance2) > patch->reach * (1 - 1e-12),
              "%s: triangle %u at %g is not in a patch of %g", name, t, sqrt(found.distance2), patch->reach);
    }
}

static void open_rig(struct rig *rig, const struct subject *subject, const struct instrument *instrument,
                     double friction)
{
    dpt_world_def def = rig_def(DPT_LAW_PROXY);
    dpt_body_settings settings = { .size = sizeof settings };
    def.max_contacts = 0;
    rig_open(rig, &def, subject->fixture.mesh, &instrument->segment, 1);
    dpt_body_get_settings(rig->world, rig->body, &settings);
    settings.static_friction = settings.kinetic_friction = friction;
    rig_set_body(rig, settings);
}

static void complete_on(const struct subject *subject, const struct instrument *instrument, uint64_t seed)
{
    struct hand hand;
    struct rig rig;
    char name[80];
    snprintf(name, sizeof name, "%s, %s", subject->shape, instrument->name);
    open_rig(&rig, subject, instrument, 0.0);
    hand_begin(&hand, subject, seed);
    double last = -1.0;
    for (int tick = 0; tick < ticks_wanted; tick++) {
        hand_move(&hand, &rig.device);
        if (tick)
            rig_step(&rig);
        else
            rig_place(&rig);
        const double now = patch_of(&rig)->a.x + patch_of(&rig)->reach;
        if (now != last)
            judge_complete(&rig, name);
        last = now;
    }
    rig_close(&rig);
}

static void patches_are_complete(void)
{
    for (size_t s = 0; s < EACH(subjects); s++) {
        if (!open_subject(&subjects[s]))
            return;
        for (size_t i = 0; i < EACH(instruments); i++)
            complete_on(&subjects[s], &instruments[i], 10 * s + i);
        fixture_free(&subjects[s].fixture);
    }
    CHECK(all.known > 100, "only %llu patches", (unsigned long long)all.known);
    printf("  %llu patches, %llu triangles\n", (unsigned long long)all.known, (unsigned long long)all.judged);
}

/* Of the ticks in contact: how many differ by more than the two ways to find the same place may. */
static struct {
    uint64_t ticks, differ;
    double largest;
} felt;

/* Two worlds, one without patches, which begins each tick as the other does. */
static void same_on(const struct subject *subject, const struct instrument *instrument, double friction, uint64_t seed)
{
    struct hand hand;
    struct rig with, without;
    uint64_t ticks = 0, differ = 0;
    double worst = 0;
    open_rig(&with, subject, instrument, friction);
    open_rig(&without, subject, instrument, friction);
    patch_of(&without)->is_off = 1;
    hand_begin(&hand, subject, seed);
    for (int tick = 0; tick < ticks_wanted; tick++) {
        hand_move(&hand, &with.device);
        without.device = with.device;
        if (tick == 0) {
            rig_place(&with);
            rig_place(&without);
            continue;
        }
        *proxy_of(without.world, without.world->tools) = *proxy_of(with.world, with.world->tools);
        rig_step(&with);
        rig_step(&without);
        const double size = length3(with.force.wrench.force);
        const double other = apart(with.force.wrench.force, without.force.wrench.force);
        if (with.force.reason != DPT_FORCE_ACTS)
            continue;
        ticks++;
        if (other > 6e-4 * size + 500.0 * 1e-6 * subject->diagonal) {
            differ++;
            worst = fmax(worst, other);
            {
                const double m = apart(with.proxy.position, with.device.position),
                             n = apart(without.proxy.position, without.device.position);
                printf("tick %d F %.4f diff %.5f flags %x %x lag %.2g %.2g E %.6g %.6g |p-d| %.6f %.6f\n", tick, size,
                       other, with.force.flags, without.force.flags, with.force.lag, without.force.lag,
                       with.force.energy, without.force.energy, m, n);
            }
        }
    }
    printf("%-8s %-16s mu %.1f: %6llu ticks, %5llu differ, worst %g N\n", subject->shape, instrument->name, friction,
           (unsigned long long)ticks, (unsigned long long)differ, worst);
    felt.ticks += ticks;
    felt.differ += differ;
    felt.largest = fmax(felt.largest, worst);
    rig_close(&with);
    rig_close(&without);
}

static void patches_make_no_difference(void)
{
    for (size_t s = 0; s < EACH(subjects); s++) {
        if (!open_subject(&subjects[s]))
            return;
        for (size_t i = 0; i < EACH(instruments); i++) {
            same_on(&subjects[s], &instruments[i], 0.0, 100 * s + i);
            same_on(&subjects[s], &instruments[i], 0.4, 100 * s + i);
        }
        fixture_free(&subjects[s].fixture);
    }
}

int main(int argc, char **argv)
{
    if (argc > 1)
        ticks_wanted = atoi(argv[1]);
    TEST(patches_are_complete);
    TEST(patches_make_no_difference);
    return check_report();
}
