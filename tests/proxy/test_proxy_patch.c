/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The patches of surface round a proxy (docs/algorithms/patch.md): that each has all triangles within its reach, and a
 * tick's list all within that one's, against all triangles of all bodies; that a motion which they prove comes near none
 * of them; and that with and without them the same is felt, with the same bits and work by all kernels. Of one body or
 * two that cross each other, at rest or in motion; of one segment or several.
 *
 *     test_proxy_patch [TICKS = 1000 [SEED = 0]]   of each tool on each mesh, in one scene that the seed chooses
 */
#include "lib/rig.h"
#include "proxy/part_place.h"
#include "proxy/patch_constraints.h"
#include "proxy/patch_sides.h"
#include "proxy/proxy.h"
#include "proxy/proxy_friction.h"
#include "proxy/solved_motion.h"
#include "proxy/tick_at.h"
#include "proxy/wiping_hand.h"

static unsigned long ticks_wanted = 1000;
static uint64_t first_seed;

static struct subject subjects[] = { { .shape = "liver", .triangles = 5000 },
                                     { .shape = "star", .triangles = 3000 },
                                     { .shape = "torus", .triangles = 4000 },
                                     { .shape = "sphere", .triangles = 2000 } };

static const struct instrument {
    const char *name;
    uint32_t count;
    dpt_segment segments[3];
    uint32_t tips;    /* one, or two side by side */
    double extent[3]; /* of each: a box */
} instruments[] = {
    { "ball of 1 um", 1, { { { 0, 0, 0 }, { 0, 0, 0 }, 1e-6 } }, 0, { 0 } },
    { "ball of 0.1 mm", 1, { { { 0, 0, 0 }, { 0, 0, 0 }, 1e-4 } }, 0, { 0 } },
    { "ball of 1 mm", 1, { { { 0, 0, 0.01 }, { 0, 0, 0.01 }, 1e-3 } }, 0, { 0 } },
    { "ball of 5 mm", 1, { { { 0, 0, 0 }, { 0, 0, 0 }, 5e-3 } }, 0, { 0 } },
    { "line of 30 mm", 1, { { { 0, 0, 0 }, { 0, 0, 0.03 }, 0 } }, 0, { 0 } },
    { "needle of 30 mm", 1, { { { 0, 0, -0.01 }, { 0, 0, 0.02 }, 1e-3 } }, 0, { 0 } },
    { "needle of 0.1 m", 1, { { { 0, 0, 0 }, { 0, 0, 0.1 }, 1e-3 } }, 0, { 0 } },
    { "stepped needle",
      2,
      { { { 0, 0, 0 }, { 0, 0, 0.02 }, 5e-4 }, { { 0, 0, 0.02 }, { 0, 0, 0.1 }, 2e-3 } },
      0,
      { 0 } },
    { "fork",
      3,
      { { { 0, 0, 0 }, { 0, 0, 0.04 }, 2e-3 },
        { { 0, 0, 0 }, { 0.01, 0, -0.01 }, 1e-3 },
        { { 0, 0, 0 }, { -0.01, 0, -0.01 }, 1e-3 } },
      0,
      { 0 } },
    { "plate", 1, { { { 0, 0, 0.01 }, { 0, 0, 0.06 }, 1e-3 } }, 1, { 0.03, 0.001, 0.03 } },
    { "jaws", 1, { { { 0, 0, 0.01 }, { 0, 0, 0.01 }, 0 } }, 2, { 0.004, 0.003, 0.012 } },
};

/* What is under the hand: one body at rest, in motion, or two that cross, of which one may be in motion. */
enum { ALONE, MOVING, TWO, TWO_MOVING, SCENES };
static const char *const scenes[SCENES] = { "at rest", "moving", "two", "two moving" };

#define EACH(list) (sizeof(list) / sizeof *(list))

/* Whether an instrument is tried on a subject: one with tips, which takes longer, on half of them. */
static int is_tried(size_t subject, size_t instrument)
{
    return !instruments[instrument].tips || (subject + instrument) % 2 == 0;
}

/* That of a subject and an instrument. */
static int scene_of(size_t subject, size_t instrument)
{
    return (int)((subject + instrument + first_seed) % SCENES);
}

/* Where the bodies of a scene are: the second is some mm aside; what moves goes to and fro by mm, and turns. */
static void place_bodies(struct rig *rig, int scene, const dpt_body *bodies, int tick)
{
    static const double axis[3] = { 0.48, 0.6, 0.64 };
    const uint32_t moves = scene == MOVING ? 0 : 1;
    dpt_pose pose = DPT_POSE_IDENTITY;
    if (scene != MOVING && scene != TWO_MOVING)
        return;
    for (int k = 0; k < 3; k++)
        pose.position[k] = 3e-3 * sin(0.01 * (1 + 0.3 * k) * tick) + (moves ? 2e-3 * (k + 1) : 0);
    pose_orient(&pose, axis, 0.02 * sin(0.007 * tick));
    CHECK(dpt_body_set_pose(rig->world, bodies[moves], &pose) == DPT_OK, "no pose");
}

/* So far, of all runs. */
static struct {
    uint64_t patches, lists, listed, sides, proven, refused;
} all;

/* Every triangle that near to its axis is in a leaf of the patch. */
static void judge_patch(const struct rig *rig, const struct proxy_patch *patch, const char *name)
{
    const struct surface *surface = &world_find_body(rig->world, patch->body_id)->surface;
    const vec3 u = sub(patch->b, patch->a);
    all.patches++;
    for (uint32_t t = 0, at = 0; t < surface_triangles(surface); t++) {
        const double distance = sqrt(dpti_triangle_pair(surface, t, patch->a, u).distance2);
        while (at + 1 < patch->count && patch->leaf[at] < t / LANES)
            at++;
        CHECK((patch->count && patch->leaf[at] == t / LANES) || distance > patch->reach * (1 - 1e-12),
              "%s: triangle %u at %g is not in a patch of %g", name, t, distance, patch->reach);
    }
}

/* Of a triangle in the list, which grows as motions need; NULL: it is not there. */
static const struct patch_triangle *listed_as(const struct patch_view *view, uint32_t segment, const struct body *body,
                                              uint32_t triangle)
{
    for (uint32_t i = 0; i < view->count; i++) {
        const struct patch_side *side = patch_side_of(view, &view->list[i]);
        if (side->number == segment && side->body == body && view->list[i].triangle == triangle)
            return &view->list[i];
    }
    return NULL;
}

/*
 * Every triangle within the view's reach is in its list, with a bound of its gap that is true; and the nearest is
 * found.
 */
static void judge_view(const struct proxy_tick *tick, const struct patch_view *view, const char *name)
{
    const double rounding = 1e-12;
    double least = HUGE_VAL;
    all.lists++;
    all.sides += view->side_count;
    for (uint32_t n = 0; n < view->axis_count * tick->world->body_slot_end; n++) {
        const struct patch_axis *axis = &view->axes[n % view->axis_count];
        const struct body *body = &tick->world->bodies[n / view->axis_count];
        const struct part_place place = part_at(axis, body, &tick->at, &tick->at, 0.0);
        for (uint32_t t = 0; t < surface_triangles(&body->surface); t++) {
            const double gap = gap_at(&place, &body->surface, t, view->reach);
            const struct patch_triangle *listed = listed_as(view, n % view->axis_count, body, t);
            least = fmin(least, gap);
            all.listed += listed != NULL;
            CHECK(listed || gap > view->reach - rounding, "%s: triangle %u at %g is not in the list of %g", name, t,
                  gap, view->reach);
            CHECK(!listed || listed->gap <= gap + rounding, "%s: triangle %u at %g, not %g", name, t, gap, listed->gap);
        }
    }
    CHECK(fabs(fmin(least, view->near) - tick->gap) < rounding, "%s: a gap of %g, not %g", name, least, tick->gap);
}

enum { PLACES = 5 };

/*
 * Of a motion that is proven, a part and a body: it, its ends and corners on straight lines, is never as near to a triangle
 * as the least gap.
 */
static void judge_motion(const struct proxy_tick *tick, const struct patch_axis *axis, const struct body *body,
                         const struct proxy_pose *to, const char *name)
{
    const struct surface *surface = &body->surface;
    for (int k = 0; k < PLACES; k++) {
        const double time = k / (PLACES - 1.0);
        const struct part_place place = part_at(axis, body, &tick->at, to, time);
        for (uint32_t t = 0; t < surface_triangles(surface); t++) {
            const double gap = gap_at(&place, surface, t, tick->min_gap);
            CHECK(gap >= tick->min_gap, "%s: at %g of a proven motion, %g from triangle %u", name, time, gap, t);
        }
    }
}

/* The same of a segment between these times: a sweep past each triangle by itself meets nothing. */
static void judge_sweep(const struct proxy_tick *tick, const struct patch_axis *axis, const struct body *body,
                        const struct proxy_pose *to, const char *name)
{
    const struct surface *surface = &body->surface;
    vec3 a, b, to_a, to_b;
    if (axis->part.tip)
        return;
    axis_at(axis, body, &tick->at, &a, &b);
    axis_at(axis, body, to, &to_a, &to_b);
    const struct motion motion = { a, b, sub(to_a, a), sub(to_b, b) };
    struct sweep sweep;
    dpti_sweep_begin(&sweep, &motion, axis->part.segment->radius + tick->min_gap, 0.0, dpti_surface_extent(surface));
    for (uint32_t t = 0; t < surface_triangles(surface); t++) {
        struct moving_triangle triangle = { .is_moving = 0 };
        uint32_t evaluations = 0;
        double met = 1.0;
        surface_corners(surface, t, triangle.corner);
        CHECK(dpti_sweep_triangle(&sweep, &triangle, 1.0, &met, &evaluations) == SWEEP_FREE,
              "%s: a proven motion meets triangle %u at %g", name, t, met);
    }
}

/* Make constraints of the nearest triangles of all sides. Returns 0 if there are none. */
static int hold_nearest(struct proxy_tick *tick, struct patch_view *view, double reach)
{
    const vec3 none = { 0.0, 0.0, 0.0 };
    int held = 0;
    for (uint32_t i = 0; i < view->side_count; i++)
        if (view->sides[i].nearest != PATCH_TRIANGLES_MAX)
            held += dpti_patch_hold(tick, view, view->sides[i].nearest, reach, none);
    return held;
}

/*
 * Any motion of the proxy up to a length, as far as the nearest triangle lets it, or through everything; judged if it is
 * proven.
 */
static void try_motion(struct proxy_tick *tick, struct patch_view *view, double size, int is_held, uint64_t *seed,
                       const char *name)
{
    const uint32_t n = proxy_unknowns(tick->proxy);
    double wanted[HALF_SPACE_DIMENSIONS] = { 0.0 }, met;
    for (uint32_t k = 0; k < n; k++)
        wanted[k] = random_in(seed, -size, size);
    tick->space_count = tick->triangle_count = 0;
    if (!dpti_patch_look(tick, view, 4.0 * size) || !hold_nearest(tick, view, 4.0 * size) ||
        !dpti_proxy_solve_rubbing(tick, wanted))
        return;
    if (!is_held) {
        memcpy(tick->solved.y, wanted, sizeof wanted);
        tick->solved.active_count = tick->space_count = tick->triangle_count = 0;
        for (uint32_t i = 0; i < view->count; i++)
            view->list[i].is_held = 0;
    }
    const struct proxy_pose to = dpti_solved_pose(tick, tick->solved.y, 1.0);
    if (dpti_patch_prove(tick, view, &to, 4.0 * size, &met) != PATCH_FREE) {
        all.refused++;
        return;
    }
    all.proven++;
    for (uint32_t n_axis = 0; n_axis < view->axis_count; n_axis++)
        for (uint32_t slot = 0; slot < tick->world->body_slot_end; slot++) {
            judge_motion(tick, &view->axes[n_axis], &tick->world->bodies[slot], &to, name);
            judge_sweep(tick, &view->axes[n_axis], &tick->world->bodies[slot], &to, name);
        }
    tick->at = to;
    if (dpti_patch_look(tick, view, size))
        judge_view(tick, view, name);
}

/* From where the proxy is, without a change of the world but of its patch. Tips have none for long motions. */
static void judge(const struct rig *rig, int has_tips, uint64_t *seed, const char *name)
{
    const double size = 1e-5 * pow(10, random_in(seed, 0, has_tips ? 0.7 : 2.7));
    const struct proxy before = *rig->world->proxies;
    struct proxy_tick tick;
    struct patch_view view;
    tick_at_proxy(rig, &tick);
    if (!dpti_patch_begin(&tick, &view) || !dpti_patch_look(&tick, &view, 4.0 * size))
        return;
    judge_view(&tick, &view, name);
    try_motion(&tick, &view, size, 1, seed, name);
    *rig->world->proxies = before;
    tick_at_proxy(rig, &tick);
    if (dpti_patch_begin(&tick, &view) && dpti_patch_look(&tick, &view, 4.0 * size))
        try_motion(&tick, &view, size, 0, seed, name);
    *rig->world->proxies = before;
}

/* Boxes: one at the tool's origin, or two, one beside the other. The hull lies in the block. */
static void give_tips(struct rig *rig, const struct instrument *instrument, uint64_t *block, uint64_t bytes)
{
    double corners[3 * DPT_HULL_CORNERS_MAX];
    dpt_hull_shape shape = { .size = sizeof shape, .kind = DPT_HULL_KIND_BOX };
    dpt_hull_def def = { .size = sizeof def, .corners = corners };
    dpt_tip tips[2] = { { .size = sizeof *tips }, { .size = sizeof *tips } };
    if (!instrument->tips)
        return;
    memcpy(shape.extent, instrument->extent, sizeof shape.extent);
    CHECK(dpt_hull_shape_corners(&shape, corners, DPT_HULL_CORNERS_MAX, &def.corner_count) == DPT_OK &&
              dpt_hull_create(block, bytes, &def, &tips[0].hull) == DPT_OK,
          "no hull");
    tips[1].hull = tips[0].hull;
    CHECK(dpt_tool_set_tips(rig->world, rig->tool, tips, instrument->tips) == DPT_OK, "no tips");
    for (uint32_t i = 0; i < instrument->tips && instrument->tips > 1; i++) {
        dpt_pose pose = DPT_POSE_IDENTITY;
        pose.position[0] = i ? 0.003 : -0.003;
        CHECK(dpt_tool_set_tip_pose(rig->world, rig->tool, i, &pose) == DPT_OK, "no pose");
    }
}

/* Returns the bodies of the scene. */
static void open_rig(struct rig *rig, const struct subject *subject, const struct instrument *instrument, int scene,
                     double friction, uint32_t kernel, dpt_body bodies[2])
{
    static uint64_t block[2048];
    dpt_world_def def = rig_def(DPT_LAW_PROXY);
    def.kernel = kernel;
    dpt_body_settings settings = { .size = sizeof settings };
    dpt_pose aside = DPT_POSE_IDENTITY;
    def.max_contacts = 0;
    rig_open(rig, &def, subject->fixture.mesh, instrument->segments, instrument->count);
    give_tips(rig, instrument, block, sizeof block);
    bodies[0] = bodies[1] = rig->body;
    for (int k = 0; k < 3; k++)
        aside.position[k] = 2e-3 * (k + 1);
    if (scene == TWO || scene == TWO_MOVING)
        bodies[1] = rig_add_body(rig, subject->fixture.mesh, &aside);
    dpt_body_get_settings(rig->world, rig->body, &settings);
    settings.static_friction = settings.kinetic_friction = friction;
    for (int i = 0; i < 2; i++)
        CHECK(dpt_body_set_settings(rig->world, bodies[i], &settings) == DPT_OK, "no settings");
}

/* One tick of the hand, and of the bodies. */
static void rig_move(struct rig *rig, struct hand *hand, int scene, const dpt_body *bodies)
{
    hand_move(hand, &rig->device);
    if (hand->tick > 1)
        place_bodies(rig, scene, bodies, hand->tick - 1);
}

static void complete_on(const struct subject *subject, const struct instrument *instrument, int scene, uint64_t seed)
{
    struct hand hand;
    struct rig rig;
    dpt_body bodies[2];
    double last[PATCH_BODIES * 3] = { 0 }; /* of the segments */
    char name[80];
    snprintf(name, sizeof name, "%s, %s, %s", subject->shape, instrument->name, scenes[scene]);
    open_rig(&rig, subject, instrument, scene, 0.0, DPT_KERNEL_AUTO, bodies);
    hand_begin(&hand, subject, seed);
    for (unsigned long tick = 0; tick < ticks_wanted / 2; tick++) {
        rig_move(&rig, &hand, scene, bodies);
        if (tick)
            rig_step(&rig);
        else
            rig_place(&rig);
        for (uint32_t i = 0; i < PATCH_BODIES * instrument->count; i++) {
            const struct proxy_patch *patch = &patch_of(&rig)[i];
            if (patch->reach > 0.0 && patch->a.x + patch->reach != last[i])
                judge_patch(&rig, patch, name);
            last[i] = patch->a.x + patch->reach;
        }
        if (tick % (instrument->tips ? 6 : 24) == 0)
            judge(&rig, instrument->tips > 0, &hand.seed, name);
    }
    rig_close(&rig);
}

static void patches_are_complete_and_prove(void)
{
    for (size_t s = 0; s < EACH(subjects); s++) {
        if (!open_subject(&subjects[s]))
            return;
        for (size_t i = 0; i < EACH(instruments); i++)
            if (is_tried(s, i))
                complete_on(&subjects[s], &instruments[i], scene_of(s, i), first_seed + 10 * s + i);
        fixture_free(&subjects[s].fixture);
    }
    printf("    %llu patches, %llu lists of %.1f from %.1f patches, %llu motions proven, %llu not\n",
           (unsigned long long)all.patches, (unsigned long long)all.lists, (double)all.listed / (double)all.lists,
           (double)all.sides / (double)all.lists, (unsigned long long)all.proven, (unsigned long long)all.refused);
    const uint64_t least = ticks_wanted / 20;
    CHECK(all.patches > least && all.lists > least && all.proven > least && all.refused > least, "too few");
}

/*
 * Of each scene, ticks in contact at whose end the proxy had arrived in both worlds, and others; of the first, what felt
 * something else.
 */
static struct {
    uint64_t ticks, others, differ, farther;
} felt[SCENES];

/* As shares: of what is felt, by which two ways to the same place may differ; and of the energy, of the same place. */
#define CONVERGED 6e-4
#define SAME      1e-3

/*
 * The same of what rubs on a body that moves at several places at once: without patches the tool goes there by other
 * motions. Where it may come to rest is a whole region then, and its way tells where in that it does.
 */
#define CONVERGED_RUBBED 6e-3
#define SAME_RUBBED      1e-2

/* Whether what holds a tool is more than one place, by either world. */
static int is_held_by_several(const struct rig *with, const struct rig *without)
{
    return with->world->load_count > 1 || without->world->load_count > 1;
}

/* Whether a tick ended before the proxy arrived. */
static int is_under_way(const struct rig *rig)
{
    return rig->force.flags || rig->force.lag > CONVERGED * apart(rig->proxy.position, rig->device.position);
}

static void compare(const struct rig *with, const struct rig *without, const struct subject *subject, int scene,
                    int is_dragged)
{
    const int is_rubbed = is_dragged && is_held_by_several(with, without);
    const double size = length3(with->force.wrench.force), energy = without->force.energy;
    if (with->force.reason != DPT_FORCE_ACTS)
        return;
    if (is_under_way(with) || is_under_way(without)) {
        felt[scene].others++;
        return;
    }
    felt[scene].ticks++;
    if (apart(with->force.wrench.force, without->force.wrench.force) <=
        (is_rubbed ? CONVERGED_RUBBED : CONVERGED) * size + RIG_STIFFNESS * 1e-6 * subject->diagonal)
        return;
    felt[scene].differ++;
    felt[scene].farther += with->force.energy > (1 + (is_rubbed ? SAME_RUBBED : SAME)) * energy;
}

/* Two worlds, one without patches, which begins each tick as the other does. */
static void same_on(const struct subject *subject, const struct instrument *instrument, int scene, double friction,
                    uint64_t seed)
{
    struct hand hand;
    struct rig with, without;
    dpt_body bodies[2], others[2];
    open_rig(&with, subject, instrument, scene, friction, DPT_KERNEL_AUTO, bodies);
    open_rig(&without, subject, instrument, scene, friction, DPT_KERNEL_AUTO, others);
    patch_of(&without)->is_off = 1;
    hand_begin(&hand, subject, seed);
    for (unsigned long tick = 0; tick < ticks_wanted; tick++) {
        rig_move(&with, &hand, scene, bodies);
        without.device = with.device;
        if (tick == 0) {
            rig_place(&with);
            rig_place(&without);
            continue;
        }
        place_bodies(&without, scene, others, hand.tick - 1);
        *without.world->proxies = *with.world->proxies;
        rig_step(&with);
        rig_step(&without);
        compare(&with, &without, subject, scene, friction > 0 && (scene == MOVING || scene == TWO_MOVING));
    }
    rig_close(&with);
    rig_close(&without);
}

/* Where several places are as near, a tick may end at another; it is seldom farther from the device. */
static void patches_make_no_difference(void)
{
    for (size_t s = 0; s < EACH(subjects); s++) {
        if (!open_subject(&subjects[s]))
            return;
        for (size_t i = 0; i < EACH(instruments); i++) {
            if (!is_tried(s, i))
                continue;
            same_on(&subjects[s], &instruments[i], scene_of(s, i), 0.0, first_seed + 100 * s + i);
            same_on(&subjects[s], &instruments[i], scene_of(s, i), 0.4, first_seed + 100 * s + i);
        }
        fixture_free(&subjects[s].fixture);
    }
    double ticks = 0, differ = 0, farther = 0;
    for (int k = 0; k < SCENES; k++) {
        printf("    %s: %llu ticks and %llu under way; %llu differ, %llu of them farther\n", scenes[k],
               (unsigned long long)felt[k].ticks, (unsigned long long)felt[k].others,
               (unsigned long long)felt[k].differ, (unsigned long long)felt[k].farther);
        CHECK(felt[k].ticks > 3 * ticks_wanted, "%s: too few", scenes[k]);
        CHECK((double)felt[k].differ <= 0.01 * (double)felt[k].ticks, "%s: too many differ", scenes[k]);
        ticks += (double)felt[k].ticks;
        differ += (double)felt[k].differ;
        farther += (double)felt[k].farther;
    }
    CHECK(differ <= 0.01 * ticks && farther <= 0.001 * ticks, "too many differ");
}

/* The sum of the bits of all forces and of the work of each tick. */
static uint64_t bits_of_run(const struct subject *subject, const struct instrument *instrument, int scene,
                            uint32_t kernel)
{
    struct hand hand;
    struct rig rig;
    dpt_body bodies[2];
    uint64_t hash = 0xcbf29ce484222325u;
    open_rig(&rig, subject, instrument, scene, 0.2, kernel, bodies);
    hand_begin(&hand, subject, 9);
    for (unsigned long tick = 0; tick < ticks_wanted / 2; tick++) {
        rig_move(&rig, &hand, scene, bodies);
        if (tick)
            rig_step(&rig);
        else
            rig_place(&rig);
        const unsigned char *byte = (const unsigned char *)&rig.force.wrench;
        for (size_t k = 0; k < sizeof rig.force.wrench; k++)
            hash = (hash ^ byte[k]) * 0x100000001b3u;
        hash = (hash ^ rig.world->work.done) * 0x100000001b3u;
    }
    rig_close(&rig);
    return hash;
}

static void all_kernels_give_the_same_bits(void)
{
    static const uint32_t kernels[] = { DPT_KERNEL_SSE2, DPT_KERNEL_AVX2, DPT_KERNEL_AVX512, DPT_KERNEL_NEON };
    for (size_t s = 0; s < EACH(subjects); s++) {
        if (!open_subject(&subjects[s]))
            return;
        for (size_t i = 0; i < EACH(instruments); i++) {
            if (!is_tried(s, i))
                continue;
            const struct instrument *tool = &instruments[i];
            const int scene = scene_of(s, i);
            const uint64_t bits = bits_of_run(&subjects[s], tool, scene, DPT_KERNEL_SCALAR);
            for (size_t k = 0; k < EACH(kernels); k++)
                CHECK(!rig_has_kernel(kernels[k]) || bits_of_run(&subjects[s], tool, scene, kernels[k]) == bits,
                      "%s, %s, %s: kernel %u", subjects[s].shape, tool->name, scenes[scene], kernels[k]);
        }
        fixture_free(&subjects[s].fixture);
    }
}

/* m: the proxy's gap to a body that is not turned, by a question of its own. */
static double gap_to(const struct rig *rig, const dpt_mesh *mesh, const dpt_pose *pose)
{
    double ends[6];
    const double radius = rig->segments[0].radius;
    dpt_hit hit = DPT_HIT_INIT;
    rig_proxy_ends(rig, 0, ends);
    for (int k = 0; k < 6; k++)
        ends[k] -= pose->position[k % 3];
    CHECK(dpt_query_segments(mesh, NULL, ends, NULL, 1, &hit, NULL) == DPT_OK, "query");
    return hit.distance - radius;
}

/* Between two bodies a hand goes across from one to the other, faster than the tool is thick: it passes neither. */
static void another_body_is_not_passed(void)
{
    static const dpt_segment needle = { { 0, 0, -0.015 }, { 0, 0, 0.015 }, 1e-3 };
    uint64_t seed = 5;
    struct fixture ball;
    struct rig rig;
    uint32_t held = 0, passed = 0;
    if (!fixture_from_shape(&ball, "sphere", 2000))
        return;
    for (int slot = 0; slot < 3; slot++) {
        const double wide = 1e-3 * (slot + 1);
        dpt_mesh_info info = { .size = sizeof info };
        dpt_pose other = DPT_POSE_IDENTITY;
        dpt_mesh_get_info(ball.mesh, &info);
        const double size = info.box_max[0] - info.box_min[0], middle = 0.5 * (info.box_max[0] + info.box_min[0]);
        other.position[0] = size + 2e-3 + wide;
        const double between = middle + 0.5 * size + 1e-3 + 0.5 * wide;
        if (!rig_open(&rig, NULL, ball.mesh, &needle, 1) || !rig_add_body(&rig, ball.mesh, &other))
            continue;
        rig.device.position[0] = between;
        rig_place(&rig);
        for (unsigned long tick = 0; tick < ticks_wanted; tick++) {
            const double to = random_in(&seed, -0.006, 0.006), lean = random_in(&seed, -0.03, 0.03);
            rig.device.position[0] = between + to;
            pose_orient(&rig.device, (const double[3]){ 0, 1, 0 }, lean);
            rig_step(&rig);
            const dpt_pose here = DPT_POSE_IDENTITY;
            held += rig.force.reason == DPT_FORCE_ACTS;
            passed += gap_to(&rig, ball.mesh, &here) < 0.0 || gap_to(&rig, ball.mesh, &other) < 0.0 ||
                      rig.proxy.position[0] < middle || rig.proxy.position[0] > middle + other.position[0];
        }
        rig_close(&rig);
    }
    fixture_free(&ball);
    CHECK(passed == 0 && held > ticks_wanted, "%u of %u held ticks: it is in one of them, or beyond", passed, held);
}

int main(int argc, char **argv)
{
    take_count(argc, argv, &ticks_wanted, &first_seed);
    TEST(patches_are_complete_and_prove);
    TEST(patches_make_no_difference);
    TEST(all_kernels_give_the_same_bits);
    TEST(another_body_is_not_passed);
    return check_report();
}
