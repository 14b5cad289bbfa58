/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The sweep of meshes: the float bounds of a swept hull; whole meshes against the sweep of every
 * triangle, with every kernel, hint and budget; sheets crossed from all sides at up to 20 m/s.
 *
 * Usage: test_sweep_mesh [sheets crossed = 200000] [seed = 1].
 */
#include "lib/fixture.h"
#include "nearest/filter_segment.h"
#include "sweep/sweep_scene.h"

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))

static unsigned long crossing_count = 200000;
static uint64_t rng = 1;

/* A mesh that is swept, and what its bounds and numbers are. */
struct body {
    struct fixture fixture;
    struct surface surface;
    double diagonal;
};

static int body_of(struct body *body)
{
    const struct dpt_mesh *mesh = body->fixture.mesh;
    if (!mesh)
        return 0;
    dpti_surface_of_mesh(mesh, &body->surface);
    body->diagonal = length(sub(vec3_of(mesh->box_max), vec3_of(mesh->box_min)));
    return 1;
}

/* Triangles of all kinds about the origin: large, small, slivers, doubled in part. */
static int soup_of(struct body *body)
{
    enum { TRIANGLES = 700 };
    static double vertices[9 * TRIANGLES];
    static uint32_t corners[3 * TRIANGLES];
    for (uint32_t t = 0; t < TRIANGLES; t++) {
        struct scene scene;
        make_any(&rng, t % 3 ? SMALL : t % 2 ? SLIVER : ANY, &scene);
        vec3 off = any_in(&rng, 0.5);
        for (uint32_t k = 0; k < 3; k++) {
            vec3_store(add(scaled(scene.corner[k], 0.3), off), vertices + 9 * t + 3 * k);
            corners[3 * t + k] = 3 * t + k;
        }
    }
    return fixture_from_arrays(&body->fixture, vertices, 3 * TRIANGLES, corners, TRIANGLES) && body_of(body);
}

/* About the body; of a third, fast, slow, or not at all; from a length of 0 to the diagonal. */
static void motion_near(const struct body *body, struct motion *m)
{
    const struct surface *tree = &body->surface;
    uint32_t v = tree->corners[random_bits(&rng) % (3 * (uint64_t)tree->mesh->triangles)];
    double size = body->diagonal, far = power_in(&rng, -5.0, -0.5);
    vec3 at = vec3_of_float(tree->positions + 3 * (size_t)v), u = scaled(any_in(&rng, 1.0), size);
    if (one_in(&rng, 4))
        u = scaled(u, one_in(&rng, 2) ? 0.0 : 1e-3);
    if (one_in(&rng, 4))
        u.z = 0.0;
    at = add(at, scaled(any_in(&rng, size), far));
    m->a = along(at, -random_in(&rng, 0.0, 1.0), u);
    m->b = add(m->a, u);
    double fast = one_in(&rng, 8) ? 0.0 : power_in(&rng, -4.0, -0.3);
    m->da = scaled(any_in(&rng, size), fast);
    m->db = one_in(&rng, 3) ? m->da : scaled(any_in(&rng, size), fast);
}

/* Every triangle, one after the other. */
static struct impact brute_sweep(const struct surface *tree, const struct sweep *sweep)
{
    struct impact first = { .time = 1.0, .triangle = DPT_NONE };
    for (uint32_t t = 0; t < tree->mesh->triangles; t++) {
        struct moving_triangle triangle = { .is_moving = 0 };
        surface_corners(tree, t, triangle.corner);
        uint32_t asked = 0;
        double time;
        if (dpti_sweep_triangle(sweep, &triangle, first.time, &time, &asked) != SWEEP_HIT)
            continue;
        if (time < first.time || first.triangle == DPT_NONE || tree->sources[t] < tree->sources[first.triangle]) {
            first.time = time;
            first.triangle = t;
        }
    }
    return first;
}

static void check_strike(const char *what, const struct impact *found, const struct impact *truth, int result)
{
    CHECK(result == (truth->triangle == DPT_NONE ? SWEEP_FREE : SWEEP_HIT), "%s: result %d", what, result);
    CHECK(found->time == truth->time && found->triangle == truth->triangle, "%s: %u at %.17g, not %u at %.17g", what,
          found->triangle, found->time, truth->triangle, truth->time);
}

static const struct surface_times at_rest = { 0, 0.0, 1.0 };

static struct mesh_sweep search_at_rest(const struct body *body, const struct kernel *kernel, const struct sweep *sweep,
                                        double from, struct work *work, struct sweep_progress *progress)
{
    return (struct mesh_sweep){ .surface = &body->surface,
                                .kernel = kernel,
                                .sweep = sweep,
                                .times = &at_rest,
                                .from = from,
                                .work = work,
                                .progress = progress };
}

/* All at once, in one call. */
static int sweep_whole(const struct body *body, const struct kernel *kernel, const struct sweep *sweep, double from,
                       uint32_t hint, struct impact *found, uint32_t *work)
{
    struct sweep_progress progress;
    progress.has_begun = 0;
    struct work meter = { *work, WORK_UNLIMITED };
    struct mesh_sweep search = search_at_rest(body, kernel, sweep, from, &meter, &progress);
    int result = dpti_sweep_mesh(&search, hint, found);
    *work = meter.done;
    CHECK(result != SWEEP_UNFINISHED, "%u units, of any number", *work);
    return result;
}

/*
 * With little work at a time, gone on with until it is done: no more than allowed in any call, nothing said that is not
 * so, no unit spent twice, and in the end the truth. How often it was ended.
 */
static uint32_t check_budget(const struct body *body, const struct kernel *kernel, const struct sweep *sweep,
                             double from, uint32_t hint, const struct impact *truth, uint32_t full)
{
    uint32_t all = 0, ends = 0;
    int result;
    struct impact found;
    struct sweep_progress progress;
    progress.has_begun = 0;
    do {
        uint32_t most = 1 + (uint32_t)(random_bits(&rng) % full);
        most = one_in(&rng, 4) ? 1 : most;
        struct work meter = { 5, 5 + most };
        struct mesh_sweep search = search_at_rest(body, kernel, sweep, from, &meter, &progress);
        result = dpti_sweep_mesh(&search, hint, &found);
        const uint32_t spent = meter.done - 5;
        CHECK(spent <= most, "%u of %u units", spent, most);
        all += spent;
        if (result != SWEEP_UNFINISHED)
            break;
        CHECK(spent == most, "%u of %u units, unfinished", spent, most);
        CHECK(found.triangle == DPT_NONE && found.time == from, "%u at %g", found.triangle, found.time);
        ends++;
    } while (all <= full);
    check_strike("budget", &found, truth, result);
    CHECK(all == full, "%u units in %u calls, %u in one", all, ends + 1, full);
    return ends;
}

/* From a distance that is known; no touch is before the time that it gives. */
static double check_start(const struct body *body, const struct sweep *sweep, const struct impact *truth)
{
    struct pair_search nearest = { .pair.distance2 = HUGE_VAL, .triangle = DPT_NONE };
    dpti_brute_search(&body->surface, sweep->a, sweep->u, &(struct work){ 0, WORK_UNLIMITED }, &nearest);
    double from = dpti_sweep_start(sweep, sqrt(nearest.pair.distance2));
    CHECK(from >= 0.0 && from <= 1.0, "%g", from);
    CHECK(truth->triangle == DPT_NONE || from < truth->time || from == 0.0, "%.17g, hit at %.17g", from, truth->time);
    return from;
}

static void check_pair_of(const struct body *body, const struct sweep *sweep, const struct impact *found,
                          double tolerance)
{
    vec3 a, u;
    dpti_sweep_axis(sweep, found->time, &a, &u);
    pair expected = dpti_triangle_pair(&body->surface, found->triangle, a, u);
    CHECK(expected.distance2 == found->pair.distance2 && expected.s == found->pair.s, "pair");
    CHECK(sqrt(expected.distance2) <= sweep->radius + tolerance, "off");
    vec3 off = sub(sub(along(a, found->pair.s, u), found->q), found->pair.gap);
    CHECK(length(off) <= 1e-14, "q is %g off", length(off));
}

/* Directions that are tried first: from the axis to what is nearest to it at some time, and any. */
static void any_directions(const struct body *body, const struct sweep *sweep, vec3 directions[SWEEP_DIRECTIONS_MAX])
{
    for (int i = 0; i < SWEEP_DIRECTIONS_MAX; i++) {
        struct pair_search nearest = { .pair.distance2 = HUGE_VAL, .triangle = DPT_NONE };
        vec3 a, u;
        dpti_sweep_axis(sweep, 0.2 * i, &a, &u);
        dpti_brute_search(&body->surface, a, u, &(struct work){ 0, WORK_UNLIMITED }, &nearest);
        const double distance = sqrt(nearest.pair.distance2);
        const vec3 any = any_in(&rng, 1.0);
        directions[i] =
            distance > 0.0 && i < 4 ? scaled(nearest.pair.gap, -1.0 / distance) : scaled(any, 1.0 / length(any));
    }
}

/* What a radius touches, half of it and as much of reach may touch. */
static void check_may_touch(const struct body *body, const struct kernel *kernel, const struct motion *motion,
                            const struct sweep *directed, double tolerance)
{
    struct sweep sweep;
    struct sweep_progress progress = { .has_begun = 0 };
    struct work work = { 0, WORK_UNLIMITED };
    uint32_t leaf = DPT_NONE;
    const double half = 0.5 * directed->radius;
    dpti_sweep_begin(&sweep, motion, half, tolerance, dpti_surface_extent(&body->surface));
    sweep.reach[0] = sweep.reach[1] = half;
    sweep.directions = directed->directions;
    sweep.direction_count = directed->direction_count;
    struct mesh_sweep search = search_at_rest(body, kernel, &sweep, 0.0, &work, &progress);
    int status = dpti_sweep_may_touch(&search, &leaf);
    CHECK(status == SWEEP_HIT, "ruled out");
}

static void sweep_body(const char *name, struct body *body, int motions)
{
    struct kernel kernel[8];
    uint32_t kernels = 0, chosen, hits = 0, unfinished = 0, most = 0, later = 0;
    uint64_t all_work = 0, directed_work = 0;
    for (uint32_t id = DPT_KERNEL_SCALAR; id <= DPT_KERNEL_WASM128; id++)
        kernels += (uint32_t)dpti_kernel_get(id, &kernel[kernels], &chosen);
    for (int i = 0; i < motions; i++) {
        vec3 directions[SWEEP_DIRECTIONS_MAX];
        struct motion motion;
        struct sweep sweep;
        struct impact found;
        double tolerance = body->diagonal * (one_in(&rng, 2) ? 1e-6 : power_in(&rng, -11.0, -5.0));
        double radius = one_in(&rng, 2) ? 0.0 : body->diagonal * power_in(&rng, -5.0, -0.3);
        uint32_t work = 0, full = 0, directed = 0;
        motion_near(body, &motion);
        dpti_sweep_begin(&sweep, &motion, radius, tolerance, dpti_surface_extent(&body->surface));
        struct impact truth = brute_sweep(&body->surface, &sweep);
        for (uint32_t k = 0; k < kernels; k++) {
            uint32_t before = full;
            full = 0;
            int result = sweep_whole(body, &kernel[k], &sweep, 0.0, DPT_NONE, &found, &full);
            check_strike(name, &found, &truth, result);
            CHECK(k == 0 || full == before, "%s: %u units, not %u", name, full, before);
        }
        most = full > most ? full : most;
        unfinished += check_budget(body, &kernel[0], &sweep, 0.0, DPT_NONE, &truth, full);
        double from = check_start(body, &sweep, &truth);
        uint32_t hint = (uint32_t)(random_bits(&rng) % body->surface.mesh->triangles);
        hint = one_in(&rng, 2) ? truth.triangle : hint;
        int result = sweep_whole(body, &kernel[0], &sweep, from, hint, &found, &work);
        check_strike("hint", &found, &truth, result);
        if (result == SWEEP_HIT)
            check_pair_of(body, &sweep, &found, tolerance);
        if (from < 1.0)
            check_budget(body, &kernel[0], &sweep, from, hint, &truth, work);
        any_directions(body, &sweep, directions);
        sweep.directions = directions;
        sweep.direction_count = 1 + (uint32_t)(random_bits(&rng) % SWEEP_DIRECTIONS_MAX);
        result = sweep_whole(body, &kernel[kernels - 1], &sweep, 0.0, DPT_NONE, &found, &directed);
        check_strike("directions", &found, &truth, result);
        if (result == SWEEP_HIT)
            check_may_touch(body, &kernel[kernels - 1], &motion, &sweep, tolerance);
        all_work += full;
        directed_work += directed;
        hits += truth.triangle != DPT_NONE;
        later += from > 0.0;
    }
    printf("    %-10s %5d motions, %4u hits, %4u begun later, %4u ended, work at most %5u\n", name, motions, hits,
           later, unfinished, most);
    CHECK(hits > (uint32_t)motions / 10, "%u hits", hits);
    const double share = (double)directed_work / (double)all_work;
    printf("    with directions %.3f of the units\n", share);
    CHECK(share < 1.0, "%g", share);
}

static void meshes_are_met_as_their_triangles_are(void)
{
    static const struct {
        const char *shape;
        uint32_t count;
        int motions;
    } c[] = { { "membrane", 512, 1500 },
              { "cloth", 3200, 400 },
              { "liver", 5000, 300 },
              { "star", 2400, 300 },
              { NULL, 0, 1500 } };
    for (size_t i = 0; i < COUNT(c); i++) {
        struct body body;
        if (c[i].shape ? fixture_from_shape(&body.fixture, c[i].shape, c[i].count) && body_of(&body) : soup_of(&body))
            sweep_body(c[i].shape ? c[i].shape : "soup", &body,
                       1 + (int)((unsigned long)c[i].motions * crossing_count / 200000));
        fixture_free(&body.fixture);
    }
}

/* A hull of four points, with a reach or none. Half move by little beside their length, as tools do; others anyhow. */
static void any_swath(struct swept_hull *hull, vec3 end[4])
{
    double far = 0.0;
    double reach = one_in(&rng, 8) ? 50.0 : 1.5, span = power_in(&rng, -3.0, 0.0);
    vec3 about = any_in(&rng, reach), x = any_in(&rng, 1.0), y;
    const int is_slow = one_in(&rng, 2);
    hull->limit = (float)power_in(&rng, -4.0, 0.0);
    for (int e = 0; e < 4; e++) {
        end[e] = e > 1 && is_slow ? add(end[e - 2], any_in(&rng, 0.01 * span)) : add(about, any_in(&rng, span));
        far = max_of(far, length(end[e]));
        put_float(end[e], hull->end[e]);
    }
    if (is_slow)
        x = add(sub(end[1], end[0]), sub(end[3], end[2]));
    x = scaled(x, 1.0 / length(x));
    y = across_in(&rng, x);
    put_float(x, hull->axis[0]);
    put_float(y, hull->axis[1]);
    put_float(cross(x, y), hull->axis[2]);
    put_float(about, hull->centre);
    for (int k = 0; k < 3; k++)
        hull->half[k] = (float)(random_in(&rng, 0.0, 1.0) * span);
    const int has_reach = one_in(&rng, 2);
    for (int k = 0; k < 2; k++)
        hull->reach[k] = has_reach && !one_in(&rng, 3) ? (float)(random_in(&rng, 0.0, 1.0) * span) : 0.0f;
    hull->beside = hull->limit + (hull->reach[0] > hull->reach[1] ? hull->reach[0] : hull->reach[1]) +
                   (float)(PIECE_MARGIN * (1.0 + far));
}

/* An end within its reach, often towards a place. */
static vec3 beside(vec3 end, float reach, vec3 place)
{
    const vec3 way = one_in(&rng, 3) ? any_in(&rng, 1.0) : sub(place, end);
    const double part = one_in(&rng, 2) ? 1.0 : random_in(&rng, 0.0, 1.0);
    return along(end, part * (double)reach / length(way), way);
}

/* The part *from..*to of the axis a, b that is beside a triangle, along the tool; 0 if there is none. */
static int part_beside(const struct swept_hull *hull, const vec3 v[3], vec3 a, vec3 b, double *from, double *to)
{
    const vec3 x = vec3_of_float(hull->axis[0]);
    const double low = min_of(dot(x, v[0]), min_of(dot(x, v[1]), dot(x, v[2])));
    const double high = max_of(dot(x, v[0]), max_of(dot(x, v[1]), dot(x, v[2])));
    const double rise = dot(x, sub(b, a)), beside = (double)hull->beside;
    *from = 0.0;
    *to = 1.0;
    if (rise <= 0.0)
        return 1;
    *from = max_of(0.0, (low - beside - dot(x, a)) / rise);
    *to = min_of(1.0, (high + beside - dot(x, a)) / rise);
    return *from <= *to;
}

/*
 * By how many margins a bound is above the distance of a triangle to a segment within the hull, as far as that is beside
 * the triangle. A bound beyond the limit counts for the whole segment, with the limit.
 */
static double excess(const float *rows, int lane, float bound, const struct swept_hull *hull, const vec3 end[4])
{
    double s = random_in(&rng, 0.0, 1.0), t = random_in(&rng, 0.0, 1.0), far = 0.0;
    vec3 a = along(end[0], t, sub(end[2], end[0])), b = along(end[1], t, sub(end[3], end[1])), v[3];
    if (one_in(&rng, 3)) {
        const uint64_t last = 2 * (random_bits(&rng) % 2);
        a = end[last], b = end[1 + last];
    }
    for (int k = 0; k < 3; k++)
        v[k] = (vec3){ rows[3 * k * LANES + lane], rows[(3 * k + 1) * LANES + lane], rows[(3 * k + 2) * LANES + lane] };
    double from, to, over = -HUGE_VAL;
    const int has_part = part_beside(hull, v, a, b, &from, &to);
    a = beside(a, hull->reach[0], v[0]);
    b = beside(b, hull->reach[1], v[random_bits(&rng) % 3]);
    const vec3 u = sub(b, a);
    from += (one_in(&rng, 2) ? s : 0.0) * (to - from);
    for (int e = 0; e < 4; e++)
        far = max_of(far, length(end[e]) + (double)hull->reach[e % 2]);
    if (has_part)
        over =
            (double)bound - sqrt(segment_triangle(along(a, from, u), scaled(u, to - from), v[0], v[1], v[2]).distance2);
    if (bound > hull->limit)
        over = max_of(over, (double)hull->limit - sqrt(segment_triangle(a, u, v[0], v[1], v[2]).distance2));
    return over / kernel_swept_margin(far);
}

static void swept_bounds_are_sound(void)
{
    struct body body;
    struct kernel kernel[8];
    uint32_t kernels = 0, chosen, closed = 0;
    double worst = -HUGE_VAL;
    if (!soup_of(&body))
        return;
    for (uint32_t id = DPT_KERNEL_SCALAR; id <= DPT_KERNEL_WASM128; id++)
        kernels += (uint32_t)dpti_kernel_get(id, &kernel[kernels], &chosen);
    for (int i = 0; i < 10000; i++) {
        struct swept_hull hull;
        vec3 end[4];
        any_swath(&hull, end);
        uint32_t leaf = (uint32_t)(random_bits(&rng) % body.surface.mesh->leaves), lanes[2] = { 0, 0 };
        const float *rows = body.surface.leaves + (size_t)leaf * MESH_LEAF_WORDS;
        const float *boxes = body.surface.level[1] + (size_t)(leaf / LANES) * MESH_BOX_WORDS;
        float first[2][LANES], bound[2][LANES];
        for (uint32_t k = 0; k < kernels; k++) {
            uint32_t open = kernel[k].swept_triangles(rows, &hull, bound[0]);
            uint32_t open_boxes = kernel[k].swept_boxes(boxes, &hull, bound[1]);
            if (k == 0) {
                memcpy(first, bound, sizeof first);
                lanes[0] = open, lanes[1] = open_boxes;
            }
            CHECK(open == lanes[0] && open_boxes == lanes[1], "lanes of kernel %u", k);
            CHECK(!memcmp(bound, first, sizeof bound), "bounds of kernel %u", k);
        }
        closed += lanes[0] != 0xffff;
        for (int lane = 0; lane < LANES; lane++) {
            double over = excess(rows, lane, first[0][lane], &hull, end);
            worst = max_of(worst, max_of(over, excess(rows, lane, first[1][leaf % LANES], &hull, end)));
            CHECK(first[0][lane] <= hull.limit || !(lanes[0] >> lane & 1), "lane %d", lane);
        }
        CHECK(worst <= 1.0, "%g margins above the distance", worst);
    }
    printf("    above the distance by at most %.3f margins\n", worst);
    CHECK(closed > 1000, "%u closed", closed);
    fixture_free(&body.fixture);
}

/*
 * One end goes through `through`, in a flat sheet z = 0, at the time t, by up to 20 mm a tick,
 * steeply or nearly in the sheet; the other one stays behind. Returns t.
 */
static double make_crossing(vec3 *way, struct motion *m)
{
    vec3 through = any_in(&rng, 0.0999), u = any_in(&rng, 1.0);
    *way = any_in(&rng, 1.0);
    through.z = 0.0;
    if (one_in(&rng, 3))
        way->z *= power_in(&rng, -6.0, 0.0);
    if (one_in(&rng, 3))
        u.z *= power_in(&rng, -9.0, 0.0);
    if (one_in(&rng, 3)) { /* over a vertex or an edge of the grid */
        through.x = 0.0125 * whole_in(&rng, -7, 7);
        through.y = one_in(&rng, 2) ? through.x : through.y;
    }
    *way = scaled(*way, 0.02 * power_in(&rng, -3.0, 0.0) / length(*way));
    u = scaled(u, one_in(&rng, 8) ? 0.0 : power_in(&rng, -3.0, -0.5) / length(u));
    u.z = way->z > 0.0 ? -fabs(u.z) : fabs(u.z);
    double t = one_in(&rng, 4) ? whole_in(&rng, 0, 1) : random_in(&rng, 0.0, 1.0);
    m->a = along(through, -t, *way);
    m->b = add(m->a, u);
    m->da = *way;
    m->db = add(*way, scaled(u, random_in(&rng, 0.0, 1e-2)));
    if (one_in(&rng, 2))
        *m = (struct motion){ m->b, m->a, m->db, m->da };
    return t;
}

/*
 * It is met no later than t. A quarter of them are beside the sheet; a hit there, or off the axis,
 * is invented.
 */
static void sheets_are_crossed_at_any_speed(void)
{
    struct body body;
    struct kernel kernel;
    uint32_t chosen;
    unsigned long missed = 0, invented = 0, free = 0;
    if (!fixture_from_shape(&body.fixture, "membrane", 512) || !body_of(&body))
        return;
    dpti_kernel_get(DPT_KERNEL_AUTO, &kernel, &chosen);
    for (unsigned long i = 0; i < crossing_count; i++) {
        struct motion m;
        vec3 way;
        double t = make_crossing(&way, &m);
        int crosses = i % 4 != 0;
        if (!crosses) {
            m.a.z += way.z > 0.0 ? -0.5 : 0.5;
            m.b.z += way.z > 0.0 ? -0.5 : 0.5;
        }
        struct sweep sweep;
        struct impact found;
        uint32_t work = 0;
        double tolerance = body.diagonal * (one_in(&rng, 2) ? 1e-6 : 1e-11);
        dpti_sweep_begin(&sweep, &m, 0.0, tolerance, dpti_surface_extent(&body.surface));
        int hit = sweep_whole(&body, &kernel, &sweep, 0.0, DPT_NONE, &found, &work) == SWEEP_HIT;
        missed += crosses && !(hit && found.time <= t + 1e-12);
        CHECK(!crosses || (hit && found.time <= t + 1e-12), "missed: result %d at %.17g, not %.17g", hit, found.time,
              t);
        vec3 a, axis;
        dpti_sweep_axis(&sweep, found.time, &a, &axis);
        int off = hit && sqrt(dpti_triangle_pair(&body.surface, found.triangle, a, axis).distance2) > tolerance;
        invented += (unsigned)off + (!crosses && hit);
        CHECK(!off && !(hit && !crosses), "invented at %.17g", found.time);
        free += !hit;
    }
    printf("    %lu motions, %lu missed, %lu invented, %lu free\n", crossing_count, missed, invented, free);
    fixture_free(&body.fixture);
}

/*
 * m: the largest radius with which the axis touches nothing, each point beside its line by its reach, at any of some
 * places and times. It may be smaller between them.
 */
static double room_at_samples(const struct sweep *sweep, const vec3 corner[3])
{
    enum { TIMES = 24, PLACES = 16 };
    double least = HUGE_VAL;
    for (int t = 0; t <= TIMES; t++) {
        vec3 a, u;
        dpti_sweep_axis(sweep, (double)t / TIMES, &a, &u);
        for (int k = 0; k <= PLACES; k++) {
            const double s = (double)k / PLACES;
            pair found;
            point_triangle(along(a, s, u), corner, &found);
            least = min_of(least, sqrt(found.distance2) - (1.0 - s) * sweep->reach[0] - s * sweep->reach[1]);
        }
    }
    return least;
}

/*
 * A triangle that is ruled out is not touched: a radius that touches at one of the samples is never ruled out. One that is
 * 0.7 of the room is, at times; it would be always, but for planes that stand still and for few cuts.
 */
static void what_is_ruled_out_is_not_touched(void)
{
    enum { MOTIONS = 20000 };
    unsigned near = 0, ruled_out = 0;
    for (int i = 0; i < MOTIONS; i++) {
        struct scene scene;
        struct sweep sweep;
        make_any(&rng, (int)(random_bits(&rng) % 7), &scene);
        struct motion m = scene.motion;
        const double slow = power_in(&rng, -3.0, 0.0);
        m.da = scaled(m.da, one_in(&rng, 3) ? 0.0 : slow);
        m.db = scaled(m.db, slow);
        dpti_sweep_begin(&sweep, &m, 0.0, 0.0, scene_extent(&scene));
        const double reach[2] = { one_in(&rng, 2) ? 0.0 : random_in(&rng, 0.0, 0.2), random_in(&rng, 0.0, 0.2) };
        memcpy(sweep.reach, reach, sizeof reach);
        const double room = room_at_samples(&sweep, scene.corner);
        if (!(room > 1e-6))
            continue;
        const struct moving_triangle triangle = triangle_at_rest(scene.corner);
        for (int touches = 0; touches < 2; touches++) {
            dpti_sweep_begin(&sweep, &m, (touches ? 1.0 + 1e-9 : 0.7) * room, 0.0, scene_extent(&scene));
            memcpy(sweep.reach, reach, sizeof reach);
            const int may_touch = dpti_sweep_may_touch_triangle(&sweep, &triangle);
            CHECK(may_touch || !touches, "ruled out, with %g: %s", room, scene_text(&scene));
            ruled_out += !may_touch;
        }
        near++;
    }
    printf("    %u motions, %u ruled out\n", near, ruled_out);
    CHECK(near > MOTIONS / 3 && ruled_out > near / 2, "%u of %u", ruled_out, near);
}

/*
 * A tool that lies in a sheet touches hundreds of triangles when the motion begins. To find the one with the lowest number
 * costs little more than to go through their boxes: without a look at the numbers, one evaluation each.
 */
static void many_that_touch_at_once_cost_little(void)
{
    struct body body;
    struct kernel kernel;
    uint32_t chosen;
    if (!dpti_kernel_get(DPT_KERNEL_SCALAR, &kernel, &chosen) ||
        !fixture_from_shape(&body.fixture, "membrane", 20000) || !body_of(&body))
        return;
    const struct motion m = { { -0.05, 0.01, 0.0 }, { 0.05, -0.01, 0.0 }, { 0.0, 0.0, 0.01 }, { 0.0, 0.0, 0.01 } };
    struct sweep sweep;
    struct impact found;
    uint32_t work = 0, touched = 0;
    dpti_sweep_begin(&sweep, &m, 0.01, 1e-6 * body.diagonal, dpti_surface_extent(&body.surface));
    const int result = sweep_whole(&body, &kernel, &sweep, 0.0, DPT_NONE, &found, &work);
    const struct impact truth = brute_sweep(&body.surface, &sweep);
    check_strike("lying", &found, &truth, result);
    for (uint32_t t = 0; t < body.surface.mesh->triangles; t++)
        touched += dpti_triangle_pair(&body.surface, t, m.a, sub(m.b, m.a)).distance2 <= 1e-4;
    printf("    %u units, %u triangles touched\n", work, touched);
    CHECK(found.time == 0.0 && touched > 500 && work < touched / 2, "%u units, %u touched", work, touched);
    fixture_free(&body.fixture);
}

int main(int argc, char **argv)
{
    take_count(argc, argv, &crossing_count, &rng);
    TEST(swept_bounds_are_sound);
    TEST(meshes_are_met_as_their_triangles_are);
    TEST(what_is_ruled_out_is_not_touched);
    TEST(many_that_touch_at_once_cost_little);
    TEST(sheets_are_crossed_at_any_speed);
    return check_report();
}
