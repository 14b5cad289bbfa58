/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Where the patch of a proxy (docs/algorithms/patch.md) ends: no room for another triangle, or another constraint; no
 * room for a list; and a tool that starts from rest and leaves its patch in the same tick, by a budget or without one.
 */
#include "lib/fixture.h"
#include "proxy/patch_constraints.h"
#include "proxy/proxy_constraints.h"
#include "proxy/tick_at.h"

static const dpt_segment needle = { { 0, -0.01, 0 }, { 0, 0.01, 0 }, 1e-3 };

static struct fixture ball;
static dpt_mesh_info info;

/* The needle lies on the top of the ball, pressed 1 mm deep. */
static int lay_down(struct rig *rig, uint32_t budget)
{
    dpt_world_def def = rig_def(DPT_LAW_PROXY);
    def.budget = budget;
    def.max_contacts = 0;
    if (!rig_open(rig, &def, ball.mesh, &needle, 1))
        return 0;
    rig->device.position[2] = info.box_max[2] + 0.005;
    rig_place(rig);
    for (int k = 0; k < 50; k++) {
        rig->device.position[2] -= 1e-4;
        rig_step(rig);
    }
    CHECK(rig->force.reason == DPT_FORCE_ACTS, "it is not held");
    return 1;
}

/* A tick and its list round the needle that lies there. */
static int look_around(struct rig *rig, struct proxy_tick *tick, struct patch_view *view)
{
    if (!lay_down(rig, 0))
        return 0;
    patch_of(rig)->still.body_id = 0;
    tick_at_proxy(rig, tick);
    const int is_seen = dpti_patch_begin(tick, view) && dpti_patch_look(tick, view, view->near) &&
                        view->sides[0].nearest != PATCH_TRIANGLES_MAX;
    CHECK(is_seen, "nothing is near");
    return is_seen;
}

/* Triangles without a constraint, as all their pairs are out of reach, take room as well. */
static void no_more_triangles_are_held_than_there_is_room_for(void)
{
    const vec3 none = { 0.0, 0.0, 0.0 };
    static struct proxy_tick tick;
    static struct patch_view view;
    struct rig rig;
    uint32_t held = 0;
    if (look_around(&rig, &tick, &view))
        for (uint32_t k = 0; k < HALF_SPACES_MAX + 8; k++)
            held += (uint32_t)dpti_patch_hold(&tick, &view, view.sides[0].nearest, -0.5, none);
    CHECK(held == HALF_SPACES_MAX && tick.triangle_count == HALF_SPACES_MAX && tick.space_count == 0,
          "%u held, %u triangles, %u constraints", held, tick.triangle_count, tick.space_count);
    rig_close(&rig);
}

/* Where a nearer pair takes the number of a constraint, the next solve does not begin with what that one held. */
static void a_constraint_that_is_replaced_is_forgotten(void)
{
    static struct proxy_tick tick;
    static struct patch_view view;
    struct rig rig;
    for (int is_nearer = 0; is_nearer < 2; is_nearer++) {
        if (look_around(&rig, &tick, &view)) {
            tick.triangles[tick.triangle_count++] =
                (struct proxy_triangle){ 0, view.body->id, view.list[view.sides[0].nearest].triangle };
            tick.space_count = HALF_SPACES_MAX;
            for (uint32_t i = 0; i < HALF_SPACES_MAX; i++)
                tick.sources[i].gap = is_nearer ? 1.0 : -1.0;
            tick.is_begun = 1;
            dpti_proxy_gather_triangle(&tick, 0, 0.01);
            CHECK(tick.is_begun == !is_nearer, "a solve begins %s", tick.is_begun ? "there" : "anew");
        }
        rig_close(&rig);
    }
}

/* Where no list had room, eight ticks that move the tool pass before the next one is made. */
static void a_crowded_tool_waits_for_eight_ticks(void)
{
    struct rig rig;
    if (!lay_down(&rig, 0))
        return;
    for (uint32_t k = 0; k <= 8; k++) {
        rig.device.position[0] += 2e-4;
        rig_step(&rig);
        if (k == 0)
            patch_of(&rig)->crowded = 8;
        CHECK(patch_of(&rig)->crowded == 8 - k, "tick %u: %u are left", k, patch_of(&rig)->crowded);
    }
    rig_close(&rig);
}

/* m: the proxy's gap to the body at the identity pose. */
static double gap_of(const struct rig *rig, const dpt_mesh *mesh)
{
    double ends[6];
    dpt_hit hit = DPT_HIT_INIT;
    rig_proxy_ends(rig, 0, ends);
    CHECK(dpt_query_segments(mesh, NULL, ends, NULL, 1, &hit, NULL) == DPT_OK, "query");
    return hit.distance - rig->segments[0].radius;
}

/* Ticks from rest, of a tool that was left to searches, after which the proxy was put or is too near. */
struct starts {
    uint32_t ticks, held, put, near;
};

static void start_often(const struct fixture *spikes, uint32_t budget, uint64_t seed, struct starts *starts)
{
    dpt_world_def def = rig_def(DPT_LAW_PROXY);
    struct rig rig;
    double out[3], way[3], axis[3];
    def.budget = budget;
    def.max_contacts = 0;
    if (!rig_open(&rig, &def, spikes->mesh, &needle, 1))
        return;
    random_unit(&seed, out);
    random_unit(&seed, axis);
    pose_orient(&rig.device, axis, random_in(&seed, 0, 3));
    for (int k = 0; k < 3; k++)
        rig.device.position[k] = 0.2 * out[k];
    rig_place(&rig);
    for (int k = 0; k < 400 && rig_force(&rig) < 0.5; k++) {
        for (int i = 0; i < 3; i++)
            rig.device.position[i] -= 5e-4 * out[i];
        rig_step(&rig);
    }
    for (int tick = 0; tick < 200; tick++) {
        if (tick % 8 == 0) {
            random_unit(&seed, way);
            const double speed = 1e-4 * pow(10, random_in(&seed, 0, 2));
            for (int k = 0; k < 3; k++)
                way[k] = speed * (way[k] - 0.2 * out[k]);
        }
        for (int k = 0; k < 3 && tick % 8 > 4; k++)
            rig.device.position[k] += way[k];
        rig_step(&rig);
        starts->ticks++;
        starts->held += rig.force.reason == DPT_FORCE_ACTS;
        starts->put += (rig.force.flags & (DPT_FORCE_FLAG_SQUEEZED | DPT_FORCE_FLAG_REPLACED)) != 0;
        starts->near += gap_of(&rig, spikes->mesh) <= 0.0;
    }
    rig_close(&rig);
}

static void what_starts_from_rest_stays_in_front(void)
{
    static const uint32_t budgets[] = { 0, 600, 800, 1000, 1200, 1500, 2000, 3000 };
    struct fixture spikes;
    if (!fixture_from_shape(&spikes, "star", 3000))
        return;
    for (size_t i = 0; i < sizeof budgets / sizeof *budgets; i++) {
        struct starts starts = { 0, 0, 0, 0 };
        for (uint64_t seed = 0; seed < 40; seed++)
            start_often(&spikes, budgets[i], seed, &starts);
        printf("    %u units: %u ticks, %u held, %u put, %u too near\n", budgets[i], starts.ticks, starts.held,
               starts.put, starts.near);
        CHECK(starts.held > starts.ticks / 4, "%u of %u ticks are held", starts.held, starts.ticks);
        CHECK(!starts.put && !starts.near, "with %u units %u proxies were put, and %u were in a body", budgets[i],
              starts.put, starts.near);
    }
    fixture_free(&spikes);
}

int main(void)
{
    if (fixture_from_shape(&ball, "sphere", 2000)) {
        info.size = sizeof info;
        dpt_mesh_get_info(ball.mesh, &info);
        TEST(no_more_triangles_are_held_than_there_is_room_for);
        TEST(a_constraint_that_is_replaced_is_forgotten);
        TEST(a_crowded_tool_waits_for_eight_ticks);
    }
    TEST(what_starts_from_rest_stays_in_front);
    fixture_free(&ball);
    return check_report();
}
