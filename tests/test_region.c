/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Regions of contact in a world: their integrals and intervals against a quadrature of 4,096 points, whose signed
 * distances are those of zero-length queries (test_depth has them); closed forms over a plane, a cylinder and a sphere;
 * their numbers; sides of open sheets.
 *
 *     test_region           what make check runs
 *     test_region TICKS     so many ticks a slide, 60 if not told
 *
 * Real meshes from DPT_DATA.
 */
#include "solid.h"

static const char *data;
static uint64_t ticks = 60;

/* What a step tells of a tool of one segment, as the quadrature does. */
struct integrals {
    double overlap, moment, thrust[3], thrust_moment[3];
};

/* So much overlap at s, with this way out. */
static void add(struct integrals *sum, double overlap, double s, const double way[3])
{
    sum->overlap += overlap;
    sum->moment += s * overlap;
    for (int k = 0; k < 3; k++) {
        sum->thrust[k] += overlap * way[k];
        sum->thrust_moment[k] += s * overlap * way[k];
    }
}

/* The four of them as vectors, so that one loop serves all. */
enum { INTEGRALS = 4 };
static const char *const integral_names[INTEGRALS] = { "overlap", "moment", "thrust",
                                                       "thrust_moment" };

static void integral_of(const struct integrals *i, int which, double v[3])
{
    const double scalar[3] = { which == 0 ? i->overlap : i->moment, 0, 0 };
    memcpy(v, which == 2 ? i->thrust : which == 3 ? i->thrust_moment : scalar, 3 * sizeof *v);
}

static double integral_apart(const struct integrals *a, const struct integrals *b, int which)
{
    double va[3], vb[3];
    integral_of(a, which, va);
    integral_of(b, which, vb);
    return apart(va, vb);
}

enum { COARSE = 512, FINE = 4096 };

/* Points of the axis in order, each for a piece of it, with the signed distance and the way out. */
struct quadrature {
    size_t count;
    double s[FINE + COARSE], height[FINE + COARSE], width[FINE + COARSE]; /* width in s */
    double way[FINE + COARSE][3];
    struct integrals sum, half; /* of all, and of every second */
};

static void heights_at(const dpt_mesh *mesh, const dpt_pose *pose, const double ends[6],
                       const double *s, size_t count, dpt_hit *hits)
{
    static double points[FINE + COARSE][6];
    for (size_t i = 0; i < count; i++) {
        along(ends, s[i], points[i]);
        memcpy(points[i] + 3, points[i], 3 * sizeof *points[i]);
    }
    hits[0].size = sizeof *hits;
    const dpt_result result = dpt_query_segments(mesh, pose, points[0], NULL, count, hits, NULL);
    CHECK(result == DPT_OK, "%s", dpt_result_name(result));
}

/* Pieces that are beyond reach as a whole, as the distance is 1-Lipschitz, get no points. */
static void take_quadrature(struct quadrature *q, const dpt_mesh *mesh, const dpt_pose *pose,
                            const double ends[6], double reach)
{
    static dpt_hit hits[FINE + COARSE];
    const double length = apart(ends, ends + 3);
    double coarse[COARSE];
    size_t kept = 0;
    q->sum = q->half = (struct integrals){ .overlap = 0 };
    q->count = 0;
    for (int i = 0; i < COARSE; i++)
        coarse[i] = (i + 0.5) / COARSE;
    heights_at(mesh, pose, ends, coarse, COARSE, hits);
    for (int i = 0; i < COARSE; i++)
        if (hits[i].gap - reach <= 0.5 * length / COARSE)
            coarse[kept++] = coarse[i];
    if (!kept)
        return;
    const size_t each = FINE / kept;
    for (size_t i = 0; i < kept; i++)
        for (size_t k = 0; k < each; k++) {
            const double part = ((double)k + 0.5) / (double)each - 0.5;
            q->s[q->count] = coarse[i] + part / COARSE;
            q->width[q->count++] = 1.0 / COARSE / (double)each;
        }
    heights_at(mesh, pose, ends, q->s, q->count, hits);
    for (size_t i = 0; i < q->count; i++) {
        for (int k = 0; k < 3; k++)
            q->way[i][k] = (hits[i].gap < 0 ? -1 : 1) * (hits[i].p[k] - hits[i].q[k]);
        unit3(q->way[i]);
        q->height[i] = hits[i].gap;
        const double w = fmax(0, reach - hits[i].gap) * q->width[i] * length;
        add(&q->sum, w, q->s[i], q->way[i]);
        if (i % 2)
            add(&q->half, 2 * w, q->s[i], q->way[i]);
    }
}

/* Ids that were seen, and when last: one that was gone does not come back. */
struct names {
    uint32_t id[4096];
    uint64_t tick[4096];
    size_t count;
};

static void check_names(struct names *names, uint64_t tick, const dpt_contact *contacts,
                        uint32_t count, const char *text)
{
    for (uint32_t i = 0; i < count; i++) {
        size_t k = 0;
        while (k < names->count && names->id[k] != contacts[i].id)
            k++;
        CHECK(contacts[i].id != 0, "id 0: %s", text);
        for (uint32_t j = 0; j < i; j++)
            CHECK(contacts[j].id != contacts[i].id, "two are %u: %s", contacts[i].id, text);
        CHECK(k == names->count || names->tick[k] + 1 >= tick, "%u is back: %s", contacts[i].id,
              text);
        if (k == names->count && k < 4096)
            names->id[names->count++] = contacts[i].id;
        if (k < 4096)
            names->tick[k] = tick;
    }
}

/* The worst of a run, and what it takes to see it again. */
struct worst {
    double value;
    char text[512];
};

enum { OUTSIDE, BEYOND, MISSED, NOT_THERE, NOT_LEAST, KINDS };
static const char *const kinds[KINDS] = { "of the reach is outside of all regions",
                                          "of the peak is in a region, but beyond the margin",
                                          "of the peak is in no region",
                                          "diagonals off is a region's gap at its own p",
                                          "diagonals above the least in its stretch is a gap" };
static const double allowed[KINDS] = { 0.05, 0.02, 0.01, 1e-5, 1e-5 };

struct scene {
    const struct solid *solid;
    const dpt_pose *pose;
    const char *how;
    double margin, radius, diagonal;
    int cold; /* each tick is a first one */
    struct stage stage;
    struct names names;
    uint64_t tick;
    struct worst worst[KINDS];
};

static const char *scene_text(const struct scene *scene, uint64_t tick, const double ends[6])
{
    static char text[512];
    snprintf(text, sizeof text, "%s, %s, tick %u, margin %g, radius %g: %a %a %a  %a %a %a",
             scene->solid->name, scene->how, (unsigned)tick, scene->margin, scene->radius, ends[0],
             ends[1], ends[2], ends[3], ends[4], ends[5]);
    return text;
}

static void note(struct scene *scene, int kind, double value, const double ends[6])
{
    if (value > scene->worst[kind].value) {
        scene->worst[kind].value = value;
        snprintf(scene->worst[kind].text, sizeof scene->worst[kind].text, "%s",
                 scene_text(scene, scene->tick, ends));
    }
}

/* One region for itself. */
static void check_region(struct scene *scene, const double ends[6],
                         const struct quadrature *quadrature, const dpt_contact *c)
{
    const double bound = 1e-5 * scene->diagonal, tiny = 1e-12 * scene->diagonal;
    const char *text = scene_text(scene, scene->tick, ends);
    double p[3], q[3] = { 0, 0, 0 }, corners[9], way[3], least = INFINITY;
    CHECK(c->s0 >= 0 && c->s0 <= c->s && c->s <= c->s1 && c->s1 <= 1, "%g <= %g <= %g: %s", c->s0,
          c->s, c->s1, text);
    CHECK(c->gap <= scene->margin + bound, "gap %g: %s", c->gap, text);
    along(ends, c->s, p);
    CHECK(apart(p, c->p) <= tiny, "p: %s", text);
    CHECK(fabs(c->weight[0] + c->weight[1] + c->weight[2] - 1) <= 1e-12, "weights: %s", text);
    CHECK(fmin(c->weight[0], fmin(c->weight[1], c->weight[2])) >= 0, "weights: %s", text);
    CHECK(dpt_mesh_triangle(scene->solid->mesh, c->triangle, corners) == DPT_OK, "triangle %u: %s",
          c->triangle, text);
    for (int i = 0; i < 9; i++)
        q[i % 3] += c->weight[i / 3] * corners[i];
    /* A pose keeps distances; without one q is where the weights say. */
    if (!scene->pose)
        CHECK(apart(q, c->q) <= tiny, "q is %g off its weights: %s", apart(q, c->q), text);
    CHECK(fabs(sqrt(dot3(c->normal, c->normal)) - 1) <= 1e-9, "normal %g: %s",
          sqrt(dot3(c->normal, c->normal)), text);
    for (int k = 0; k < 3; k++)
        way[k] = c->p[k] - c->q[k];
    const double distance = unit3(way);
    const double sign = c->gap + scene->radius < 0 ? -1 : 1;
    CHECK(fabs(sign * distance - (c->gap + scene->radius)) <= bound, "gap %.9g, but %.9g apart: %s",
          c->gap, distance, text);
    if (distance > 1e-7 * scene->diagonal)
        CHECK(sign * dot3(way, c->normal) >= 1 - 1e-9, "normal is %g off: %s",
              1 - sign * dot3(way, c->normal), text);
    double at[6] = { p[0], p[1], p[2], p[0], p[1], p[2] };
    dpt_hit hit = DPT_HIT_INIT;
    dpt_query_segments(scene->solid->mesh, scene->pose, at, NULL, 1, &hit, NULL);
    note(scene, NOT_THERE, fabs(hit.gap - scene->radius - c->gap) / scene->diagonal, ends);
    for (size_t i = 0; i < quadrature->count; i++)
        if (quadrature->s[i] >= c->s0 && quadrature->s[i] <= c->s1)
            least = fmin(least, quadrature->height[i] - scene->radius);
    note(scene, NOT_LEAST, (c->gap - least) / scene->diagonal, ends);
    CHECK(c->contact == DPT_CONTACT_UNKNOWN ||
              (c->contact == DPT_CONTACT_PENETRATING) == (c->gap < -hit.error_bound) ||
              fabs(c->gap) < 1e-9 * scene->diagonal,
          "contact %u, gap %g: %s", c->contact, c->gap, text);
}

/* Within the intervals the surface is within the margin, and outside of them it is not. */
static void check_intervals(struct scene *scene, const double ends[6],
                            const struct quadrature *quadrature, const dpt_contact *contacts,
                            uint32_t count)
{
    const double length = apart(ends, ends + 3), reach = scene->margin + scene->radius;
    double missed = 0, beyond = 0, outside = 0;
    for (size_t i = 0; i < quadrature->count; i++) {
        const double s = quadrature->s[i], w = reach - quadrature->height[i];
        int within = 0, inner = 0;
        for (uint32_t k = 0; k < count; k++) {
            within |= s >= contacts[k].s0 && s <= contacts[k].s1;
            inner |= s > contacts[k].s0 && s < contacts[k].s1;
        }
        if (!within && w > 0) {
            missed += w * quadrature->width[i] * length;
            outside = fmax(outside, w / reach);
        }
        if (inner && w < 0)
            beyond -= w * quadrature->width[i] * length;
    }
    note(scene, OUTSIDE, outside, ends);
    note(scene, BEYOND, beyond, ends);
    note(scene, MISSED, missed, ends);
}

/* Some of its points against brute force and solid angles. */
static void check_quadrature(const struct scene *scene, const double ends[6],
                             const struct quadrature *quadrature)
{
    for (size_t i = 0; i < quadrature->count; i += 1 + quadrature->count / 8) {
        double x[3];
        along(ends, quadrature->s[i], x);
        const double height = oracle_signed(&scene->solid->oracle, x);
        CHECK(fabs(height - quadrature->height[i]) <= 1e-9 * scene->diagonal,
              "%.12g, not %.12g at %g: %s", quadrature->height[i], height, quadrature->s[i],
              scene_text(scene, scene->tick, ends));
    }
}

/* What all ticks gave: ours, the quadrature's, that of every second of its points, and that of the deepest point. */
struct record {
    struct integrals ours, truth, half, single;
    double ends[6];
};

static double peak_of(const struct record *record, uint64_t count, int which)
{
    const struct integrals zero = { .overlap = 0 };
    double peak = 0;
    for (uint64_t i = 0; i < count; i++)
        peak = fmax(peak, integral_apart(&record[i].truth, &zero, which));
    return peak;
}

static uint64_t check_run(const struct scene *scene, const struct record *record, uint64_t count)
{
    double worst[INTEGRALS] = { 0 }, jump[INTEGRALS] = { 0 };
    uint64_t single_jumps = 0;
    const char *name = scene->solid->name, *how = scene->how;
    for (int which = 0; which < INTEGRALS; which++) {
        /* A thrust is an overlap with directions. Where they cancel, its own peak says nothing of what is felt. */
        const double peak = fmax(peak_of(record, count, which % 2), 1e-30);
        uint64_t at = 0, jump_at = 0;
        double doubt = 0;
        for (uint64_t i = 0; i < count; i++) {
            const struct record *now = &record[i], *before = &record[i ? i - 1 : 0];
            const double off = integral_apart(&now->ours, &now->truth, which) / peak;
            const double step = integral_apart(&now->truth, &before->truth, which) / peak;
            const double went = integral_apart(&now->ours, &before->ours, which) / peak - step;
            const double single = integral_apart(&now->single, &before->single, which) / peak;
            doubt = fmax(doubt, integral_apart(&now->half, &now->truth, which) / peak);
            if (off > worst[which]) {
                worst[which] = off;
                at = i;
            }
            if (went > jump[which]) {
                jump[which] = went;
                jump_at = i;
            }
            single_jumps += single > step + 0.005;
        }
        CHECK(doubt <= 0.002, "the quadrature is not sure of %s by %.2f %%", integral_names[which],
              100 * doubt);
        CHECK(worst[which] <= 0.02, "%s is %.2f %% off: %s", integral_names[which],
              100 * worst[which], scene_text(scene, at, record[at].ends));
        /* Spikes that cancel are where the library falls short of half a per cent. */
        const double most = strcmp(name, "star") == 0 ? 0.01 : 0.005;
        CHECK(scene->cold || jump[which] <= most, "%s jumps by %.2f %% more: %s",
              integral_names[which], 100 * jump[which],
              scene_text(scene, jump_at, record[jump_at].ends));
    }
    for (int kind = 0; kind < KINDS; kind++)
        CHECK(scene->worst[kind].value <= allowed[kind], "%.2g %s: %s", scene->worst[kind].value,
              kinds[kind], scene->worst[kind].text);
    printf("    %-26s %-12s off %5.2f %5.2f %6.2f %5.2f %%, jumps %5.2f %5.2f %5.2f %5.2f %%, "
           "missed %.2f %%, one point "
           "%u\n",
           name, how, 100 * worst[0], 100 * worst[1], 100 * worst[2], 100 * worst[3], 100 * jump[0],
           100 * jump[1], 100 * jump[2], 100 * jump[3], 100 * scene->worst[MISSED].value,
           (unsigned)single_jumps);
    return single_jumps;
}

/* A run's ends, one tick after another. */
typedef void next_ends(void *of, double ends[6]);

static uint64_t run(struct scene *scene, next_ends *next, void *of, uint64_t count)
{
    static struct quadrature quadrature;
    struct record *record = calloc(count, sizeof *record);
    if (!record ||
        !stage_open(&scene->stage, scene->solid->mesh, scene->pose, scene->margin, 32, 0)) {
        free(record);
        return 0;
    }
    for (uint64_t i = scene->tick = 0; i < count; scene->tick = ++i) {
        dpt_contact contacts[STAGE_CONTACTS], *deepest = NULL;
        double ends[6];
        next(of, ends);
        if (scene->cold)
            stage_jump(&scene->stage);
        stage_tick(&scene->stage, ends, scene->radius);
        const uint32_t found = stage_contacts(&scene->stage, contacts);
        take_quadrature(&quadrature, scene->solid->mesh, scene->pose, ends,
                        scene->margin + scene->radius);
        memcpy(record[i].ends, ends, sizeof ends);
        record[i].truth = quadrature.sum;
        record[i].half = quadrature.half;
        if (i % 16 == 0 && !scene->pose)
            check_quadrature(scene, ends, &quadrature);
        CHECK(scene->stage.step.contacts == found, "%u contacts, not %u: %s",
              scene->stage.step.contacts, found, scene_text(scene, scene->tick, ends));
        for (uint32_t k = 0; k < found; k++) {
            const dpt_contact *c = &contacts[k];
            check_region(scene, ends, &quadrature, c);
            record[i].ours.overlap += c->overlap;
            record[i].ours.moment += c->moment;
            for (int d = 0; d < 3; d++) {
                record[i].ours.thrust[d] += c->thrust[d];
                record[i].ours.thrust_moment[d] += c->thrust_moment[d];
            }
            if (!deepest || c->gap < deepest->gap)
                deepest = &contacts[k];
        }
        check_names(&scene->names, i, contacts, found, scene_text(scene, scene->tick, ends));
        check_intervals(scene, ends, &quadrature, contacts, found);
        if (deepest)
            add(&record[i].single, record[i].ours.overlap, deepest->s, deepest->normal);
    }
    scene->worst[BEYOND].value /= fmax(peak_of(record, count, 0), 1e-30);
    scene->worst[MISSED].value /= fmax(peak_of(record, count, 0), 1e-30);
    const uint64_t single_jumps = check_run(scene, record, count);
    stage_close(&scene->stage);
    free(record);
    return single_jumps;
}

/* Sliding: gap from a little free to well pressed in, and back. */
struct sliding {
    struct slide slide;
    double high, low;
    uint64_t tick;
    const dpt_pose *pose;
};

static void out_of_frame(const dpt_pose *pose, double ends[6])
{
    for (int e = 0; e < 2; e++) {
        const double *o = pose->orientation;
        double *x = ends + 3 * e, t[3], moved[3];
        for (int k = 0; k < 3; k++)
            t[k] = 2 * (o[1 + (k + 1) % 3] * x[(k + 2) % 3] - o[1 + (k + 2) % 3] * x[(k + 1) % 3]);
        for (int k = 0; k < 3; k++)
            moved[k] = pose->position[k] + x[k] + o[0] * t[k] +
                       (o[1 + (k + 1) % 3] * t[(k + 2) % 3] - o[1 + (k + 2) % 3] * t[(k + 1) % 3]);
        memcpy(x, moved, sizeof moved);
    }
}

static void next_slide(void *of, double ends[6])
{
    struct sliding *sliding = of;
    const double phase = fabs((double)(sliding->tick++ % 200) / 100 - 1);
    sliding->slide.gap = sliding->low + phase * (sliding->high - sliding->low);
    slide_step(&sliding->slide);
    memcpy(ends, sliding->slide.ends, sizeof sliding->slide.ends);
    if (sliding->pose)
        out_of_frame(sliding->pose, ends);
}

/* Pushing: straight into the mesh and through it, turning a little. */
struct pushing {
    double ends[6], step[3], axis[3], turn;
};

static void next_push(void *of, double ends[6])
{
    struct pushing *pushing = of;
    for (int k = 0; k < 6; k++)
        pushing->ends[k] += pushing->step[k % 3];
    turn_about(pushing->ends, 0.5, pushing->axis, pushing->turn);
    memcpy(ends, pushing->ends, sizeof pushing->ends);
}

/* From the tick `from_tick` on, for so many. */
static void slide_over(const struct solid *solid, const dpt_pose *pose, const char *how, int cold,
                       double margin, double radius, double length, uint64_t seed,
                       uint64_t from_tick, uint64_t count, uint64_t *single_jumps)
{
    struct scene *scene = calloc(1, sizeof *scene);
    struct sliding sliding = { .high = 0.5 * margin, .pose = pose };
    const double diagonal = solid->diagonal;
    scene->solid = solid;
    scene->pose = pose;
    scene->how = how;
    scene->cold = cold;
    scene->diagonal = diagonal;
    scene->margin = margin * diagonal;
    scene->radius = radius * diagonal;
    slide_begin(&sliding.slide, solid, seed, length * diagonal, scene->radius);
    /* 0.1 m/s for a diagonal of 0.35 m */
    sliding.slide.step = 3e-4 * diagonal;
    sliding.slide.spin = 0.003;
    sliding.high = 0.5 * scene->margin;
    sliding.low = radius > 0 ? -0.5 * scene->radius : 0.1 * scene->margin;
    for (int i = 0; i < 200; i++) { /* into contact */
        double ends[6];
        sliding.tick = 0;
        next_slide(&sliding, ends);
    }
    for (uint64_t i = 0; i < from_tick; i++) {
        double ends[6];
        next_slide(&sliding, ends);
    }
    *single_jumps += run(scene, next_slide, &sliding, count);
    free(scene);
}

/* The same. */
static void push_into(const struct solid *solid, const char *how, double margin, double radius,
                      double length, uint64_t seed, uint64_t from_tick, uint64_t count)
{
    struct scene *scene = calloc(1, sizeof *scene);
    struct pushing pushing;
    double lie[3], way[3], from[3];
    const double diagonal = solid->diagonal;
    scene->solid = solid;
    scene->how = how;
    scene->diagonal = diagonal;
    scene->margin = margin * diagonal;
    scene->radius = radius * diagonal;
    random_unit(&seed, lie);
    random_unit(&seed, way);
    random_unit(&seed, pushing.axis);
    const float *c = solid->corners + 9 * (random_bits(&seed) % solid->place.triangles);
    for (int k = 0; k < 3; k++) {
        from[k] = (double)c[k] - 0.02 * diagonal * way[k];
        pushing.ends[k] = from[k] - 0.5 * length * diagonal * lie[k];
        pushing.ends[3 + k] = from[k] + 0.5 * length * diagonal * lie[k];
        pushing.step[k] = 3e-4 * diagonal * way[k];
    }
    pushing.turn = 0.001;
    for (uint64_t i = 0; i < from_tick; i++) {
        double ends[6];
        next_push(&pushing, ends);
    }
    run(scene, next_push, &pushing, count);
    free(scene);
}

static void try_solid(const struct solid *solid, int all)
{
    uint64_t jumps = 0;
    slide_over(solid, NULL, "capsule", 0, 0.003, 0.01, 0.4, 1, 0, ticks, &jumps);
    slide_over(solid, NULL, "line", 0, 0.003, 0, 0.5, 3, 0, ticks, &jumps);
    push_into(solid, "pushed", 0.003, 0.01, 0.5, 5, 0, ticks);
    if (all) {
        slide_over(solid, NULL, "first ticks", 1, 0.003, 0.01, 0.6, 8, 0, ticks, &jumps);
        slide_over(solid, NULL, "long capsule", 0, 0.0006, 0.02, 0.9, 2, 0, ticks, &jumps);
        slide_over(solid, NULL, "wide margin", 0, 0.02, 0.005, 0.7, 4, 0, ticks, &jumps);
        push_into(solid, "pushed line", 0.003, 0, 0.3, 6, 0, ticks);
    }
    CHECK(!all || jumps > 0, "%s: one point would do", solid->name);
}

static void try_shape(const char *name, uint64_t count)
{
    struct solid solid;
    if (solid_from_shape(&solid, name, count))
        try_solid(&solid, 1);
    solid_close(&solid);
}

static void integrals_on_a_torus(void)
{
    try_shape("torus", 5568);
}

static void integrals_on_a_liver(void)
{
    try_shape("liver", 8000);
}

static void integrals_on_a_star(void)
{
    try_shape("star", 2000);
}

static void integrals_on_organs(void)
{
    static const char *const names[] = { "organs/openhelp_liver.stl", "organs/openhelp_spleen.stl",
                                         "organs/gallbladder_low.stl", "hard/spot.obj" };
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        struct solid solid;
        char path[4096];
        snprintf(path, sizeof path, "%s/meshes/%s", data, names[i]);
        if (solid_from_file(&solid, names[i], path, 1))
            try_solid(&solid, 0);
        solid_close(&solid);
    }
}

/* Deep ticks at which integrals jumped, or a stretch ended too early, and what was wrong with them. */
static void integrals_of_deep_lines(void)
{
    static const struct {
        const char *shape;
        uint64_t triangles, from, count;
        const char *how;
    } c[] = { { "torus", 5568, 250, 45, "walls that pass between samples" },
              { "liver", 8000, 95, 15, "walls that meet at a sample" },
              { "star", 2000, 100, 20, "an end between two walls" },
              { "star", 2000, 210, 12, "an end along a wall" } };
    for (size_t i = 0; i < sizeof c / sizeof *c; i++) {
        struct solid solid;
        if (solid_from_shape(&solid, c[i].shape, c[i].triangles))
            push_into(&solid, c[i].how, 0.003, 0, 0.3, 6, c[i].from, c[i].count);
        solid_close(&solid);
    }
    struct solid solid;
    uint64_t jumps = 0;
    if (solid_from_shape(&solid, "liver", 8000))
        push_into(&solid, "walls that take turns", 0.003, 0.01, 0.5, 5, 554, 40);
    solid_close(&solid);
    if (solid_from_shape(&solid, "star", 2000))
        slide_over(&solid, NULL, "a stretch beyond one that ends", 0, 0.02, 0.005, 0.7, 4, 1520, 35,
                   &jumps);
    solid_close(&solid);
    char path[4096];
    snprintf(path, sizeof path, "%s/meshes/organs/gallbladder_low.stl", data ? data : "");
    if (data && solid_from_file(&solid, "gallbladder", path, 1)) {
        push_into(&solid, "samples that are trapped", 0.003, 0.01, 0.5, 5, 40, 90);
        slide_over(&solid, NULL, "an estimate that is far off", 0, 0.003, 0.01, 0.4, 1, 1090, 28,
                   &jumps);
        solid_close(&solid);
    }
}

static void integrals_with_a_pose(void)
{
    const dpt_pose pose = { { 0.3, -0.2, 0.7 }, { 0.5, -0.5, 0.5, 0.5 } };
    struct solid solid;
    uint64_t jumps = 0;
    if (solid_from_shape(&solid, "torus", 2000))
        slide_over(&solid, &pose, "with a pose", 0, 0.003, 0.01, 0.4, 7, 0, ticks, &jumps);
    solid_close(&solid);
}

/* Closed forms. */

/* Integrals of w = reach - height(x) where it is positive, for a height along the tool; dense, in double. */
static void integrate(double (*height)(const void *of, double s), const void *of, double length,
                      double reach, double *overlap, double *moment)
{
    enum { POINTS = 2000 };
    *overlap = *moment = 0;
    for (int i = 0; i < POINTS; i++) {
        const double s = (i + 0.5) / POINTS, w = fmax(0, reach - height(of, s)) * length / POINTS;
        *overlap += w;
        *moment += s * w;
    }
}

/* A sheet at z = 0, finely cut; what a tool over it, or pressed through it from above, must be told. */
static void integrate_flat(double w0, double w1, double length, double *overlap, double *moment)
{
    double from = 0, to = 1;
    if (w0 < 0)
        from = w1 > 0 ? w0 / (w0 - w1) : 1;
    if (w1 < 0)
        to = w0 > 0 ? w0 / (w0 - w1) : from;
    const double middle = 0.5 * (from + to), width = (to - from) * length;
    const double low = w0 + from * (w1 - w0), half = w0 + middle * (w1 - w0),
                 high = w0 + to * (w1 - w0);
    /* Simpson's rule, exact for both. */
    *overlap = width / 6 * (low + 4 * half + high);
    *moment = width / 6 * (from * low + 4 * middle * half + to * high);
}

static void check_flat(const struct stage *stage, const char *how, const double ends[6],
                       double radius, double margin, double up, const dpt_hit *hit)
{
    dpt_contact contacts[STAGE_CONTACTS];
    const double flat[6] = { ends[0], ends[1], up * ends[2], ends[3], ends[4], up * ends[5] };
    const uint32_t count = stage_contacts(stage, contacts);
    const double gap = fmin(flat[2], flat[5]) - radius, length = apart(ends, ends + 3);
    double overlap, moment;
    CHECK(fabs(hit->gap - gap) <= 1e-9, "%s: gap %.12g, not %.12g at %a %a %a", how, hit->gap, gap,
          ends[0], ends[1], ends[2]);
    CHECK(hit->contact == (gap > 1e-12    ? DPT_CONTACT_SEPARATED
                           : gap < -1e-12 ? DPT_CONTACT_PENETRATING
                                          : hit->contact),
          "%s: contact %u, gap %g", how, hit->contact, gap);
    CHECK(count == (gap <= margin), "%s: %u regions at a gap of %.9g", how, count, gap);
    if (count != 1)
        return;
    const dpt_contact *c = contacts;
    CHECK(fabs(c->gap - gap) <= 1e-9, "%s: gap %.12g, not %.12g", how, c->gap, gap);
    CHECK(fabs(c->normal[0]) <= 1e-9 && fabs(c->normal[1]) <= 1e-9 &&
              fabs(c->normal[2] - up) <= 1e-9,
          "%s: normal %.12g %.12g %.12g at %a %a %a", how, c->normal[0], c->normal[1], c->normal[2],
          ends[0], ends[1], ends[2]);
    integrate_flat(margin + radius - flat[2], margin + radius - flat[5], length, &overlap, &moment);
    const double slack = 1e-9 * (margin + fabs(gap)) * length + 1e-15;
    CHECK(fabs(c->overlap - overlap) <= slack, "%s: overlap %.9g, not %.9g", how, c->overlap,
          overlap);
    CHECK(fabs(c->moment - moment) <= slack, "%s: moment %.9g, not %.9g", how, c->moment, moment);
    CHECK(fabs(c->thrust[2] - up * overlap) <= slack && fabs(c->thrust[0]) <= slack,
          "%s: thrust %.9g, not %.9g", how, c->thrust[2], up * overlap);
}

/*
 * Slides over a sheet, its height going from the margin down and through: `ends` at height 0, moved by `step` a tick.
 * Exact: the mesh is the plane.
 */
static void slide_flat(const struct solid *solid, const char *how, const double ends[6],
                       const double step[2], double radius, double up, double top, double bottom)
{
    struct stage stage;
    const double margin = 0.001, fall = (bottom - top) * 1.2 / 400;
    const int count = 400;
    if (!stage_open(&stage, solid->mesh, NULL, margin, 32, 0))
        return;
    for (int i = 0; i < count; i++) {
        double now[6];
        double height = fmax(bottom, top + fall * i);
        const double low = fmin(ends[2], ends[5]) + height - radius;
        if (fabs(low) < -1.5 * fall) /* for some ticks it just touches */
            height = radius - fmin(ends[2], ends[5]);
        for (int e = 0; e < 2; e++) {
            now[3 * e] = ends[3 * e] + i * step[0];
            now[3 * e + 1] = ends[3 * e + 1] + i * step[1];
            now[3 * e + 2] = up * (ends[3 * e + 2] + height);
        }
        const dpt_hit hit = stage_tick(&stage, now, radius);
        check_flat(&stage, how, now, radius, margin, up, &hit);
    }
    stage_close(&stage);
}

/* Cells of 10 mm: along a grid line with its vertices, along the cells' diagonals, across all. */
static void flat_sheet(void)
{
    const double steps[3][2] = { { 0.0003, 0 }, { 0.0003, 0.0003 }, { 0.00027, 0.00021 } };
    struct solid solid;
    const double grid = (double)-0.08f; /* where vertices are */
    if (!solid_from_shape(&solid, "membrane", 800))
        return;
    for (int way = 0; way < 3; way++)
        for (int side = 0; side < 2; side++) {
            const double up = side ? -1 : 1;
            const double ball[6] = { grid, grid, 0, grid, grid, 0 };
            const double lying[6] = { grid, grid, 0, -0.03, -0.06, 0 };
            const double tilted[6] = { grid, grid, 0, -0.04, -0.07, 0.01 };
            const double steep[6] = { -0.079, grid, 0.15, grid, grid, 0 };
            slide_flat(&solid, "ball", ball, steps[way], 0.005, up, 0.0065, -0.004);
            slide_flat(&solid, "point", ball, steps[way], 0, up, 0.0015, -0.004);
            slide_flat(&solid, "lying", lying, steps[way], 0.003, up, 0.0045, -0.003);
            slide_flat(&solid, "tilted", tilted, steps[way], 0.002, up, 0.0035, -0.006);
            slide_flat(&solid, "tilted line", tilted, steps[way], 0, up, 0.0015, -0.006);
            slide_flat(&solid, "steep line", steep, steps[way], 0, up, 0.0015, -0.02);
        }
    solid_close(&solid);
}

/* The upper face of a box, z = 0.04: the same, as long as no other face is nearer. */
static void flat_face(void)
{
    struct solid solid;
    struct stage stage;
    if (!solid_from_shape(&solid, "box", 768) ||
        !stage_open(&stage, solid.mesh, NULL, 0.001, 32, 0))
        return;
    const double top = solid.info.box_max[2];
    for (int i = 0; i < 400; i++) {
        const double x = -0.03 + 0.0001 * i, y = i < 200 ? 0 : 0.00007 * (i - 200);
        const double height = 0.004 - 0.00002 * i;
        const double ends[6] = { x, y, top + height, x + 0.02, y + 0.005, top + height + 0.003 };
        const dpt_hit hit = stage_tick(&stage, ends, 0.002);
        dpt_contact contacts[STAGE_CONTACTS];
        const uint32_t count = stage_contacts(&stage, contacts);
        const double gap = ends[2] - top - 0.002;
        CHECK(fabs(hit.gap - gap) <= 1e-5 * solid.diagonal, "gap %.9g, not %.9g", hit.gap, gap);
        CHECK(count == (gap <= 0.001), "%u regions at %g", count, gap);
        if (count == 1)
            CHECK(fabs(contacts[0].normal[2] - 1) <= 1e-9 && fabs(contacts[0].normal[0]) <= 1e-9,
                  "normal %g %g %g", contacts[0].normal[0], contacts[0].normal[1],
                  contacts[0].normal[2]);
    }
    stage_close(&stage);
    solid_close(&solid);
}

enum { ROUND = 96 };

static void place_cylinder(double u, double v, double x[3])
{
    const double angle = 2 * 3.14159265358979323846 * v;
    x[0] = 0.05 * cos(angle);
    x[1] = 0.05 * sin(angle);
    x[2] = 0.3 * u - 0.15;
}

/* The axis of a straight tool over a round body: sqrt(least^2 + (length (s - middle))^2) - body's radius. */
struct round_height {
    double least, length, middle, radius;
};

static double height_of_round(const void *of, double s)
{
    const struct round_height *r = of;
    const double along_it = r->length * (s - r->middle);
    return sqrt(r->least * r->least + along_it * along_it) - r->radius;
}

/*
 * A mesh inscribed in a round body of radius R holds that of radius R - sag: heights are above those over the body by 0
 * to sag, so gap is too, and the overlap is between those of both. To that 2 % of the largest overlap, what the
 * integrals are allowed. Its faces are tilted by at most `tilt` against the sphere or cylinder.
 */
static void check_round(const struct stage *stage, const char *how, const struct round_height *r,
                        double sag, double tilt, double tool_radius, double margin, double peak,
                        const double way[3], const dpt_hit *hit)
{
    dpt_contact contacts[STAGE_CONTACTS];
    const uint32_t count = stage_contacts(stage, contacts);
    const double gap = r->least - r->radius - tool_radius, bound = 1e-7;
    double most, least, most_moment, least_moment, overlap = 0, moment = 0;
    CHECK(hit->gap >= gap - bound && hit->gap <= gap + sag + bound, "%s: gap %.9g, not %.9g", how,
          hit->gap, gap);
    integrate(height_of_round, r, r->length, margin + tool_radius, &most, &most_moment);
    integrate(height_of_round, r, r->length, margin + tool_radius - sag, &least, &least_moment);
    for (uint32_t i = 0; i < count; i++) {
        overlap += contacts[i].overlap;
        moment += contacts[i].moment;
        CHECK(contacts[i].gap > gap + sag + bound || dot3(contacts[i].normal, way) >= cos(tilt),
              "%s: normal %g off, not %g", how, acos(dot3(contacts[i].normal, way)), tilt);
    }
    CHECK(count == 1 || gap > margin - sag, "%s: %u regions", how, count);
    CHECK(overlap <= most + 0.02 * peak && overlap >= least - 0.02 * peak,
          "%s: overlap %.9g, not %.9g to %.9g", how, overlap, least, most);
    CHECK(moment <= most_moment + 0.02 * peak && moment >= least_moment - 0.02 * peak,
          "%s: moment %.9g, not %.9g to %.9g", how, moment, least_moment, most_moment);
}

static void round_cylinder(void)
{
    const double pi = 3.14159265358979323846, radius = 0.05, margin = 0.001, tool = 0.004;
    const double sag = radius * (1 - cos(pi / ROUND)) + 1e-8, tilt = pi / ROUND + 1e-6;
    struct solid solid;
    if (!solid_from_net(&solid, "cylinder", 30, ROUND, 1, place_cylinder))
        return;
    for (int kind = 0; kind < 3; kind++) {
        struct stage stage;
        if (!stage_open(&stage, solid.mesh, NULL, margin, 32, 0))
            return;
        const double length = kind == 2 ? 0 : 0.06;
        struct round_height r = { radius + tool - 0.002, length, 0.4, radius };
        double peak, moment;
        if (kind == 1) /* along the axis: a height everywhere the same */
            r.length = 0;
        integrate(height_of_round, &r, length, margin + tool, &peak, &moment);
        for (int i = 0; i < 500; i++) {
            const double angle = 0.003 * i, d = r.least = radius + tool + 0.0015 - 0.000007 * i;
            const double way[3] = { cos(angle), sin(angle), 0 };
            const double side[3] = { kind ? 0 : -sin(angle), kind ? 0 : cos(angle), kind ? 1 : 0 };
            double ends[6];
            for (int k = 0; k < 3; k++) {
                const double foot = d * way[k] + (k == 2 ? -0.05 + 0.0002 * i : 0);
                ends[k] = foot - 0.4 * length * side[k];
                ends[3 + k] = foot + 0.6 * length * side[k];
            }
            const dpt_hit hit = stage_tick(&stage, ends, tool);
            if (kind == 0) {
                check_round(&stage, "across", &r, sag, tilt, tool, margin, peak, way, &hit);
            } else {
                dpt_contact contacts[STAGE_CONTACTS];
                const uint32_t count = stage_contacts(&stage, contacts);
                const double gap = d - radius - tool, most = fmax(0, margin - gap) * length;
                const char *how = kind == 1 ? "along" : "ball";
                CHECK(hit.gap >= gap - 1e-7 && hit.gap <= gap + sag, "%s: gap %.9g, not %.9g", how,
                      hit.gap, gap);
                CHECK(count == 1 || gap > margin - sag, "%s: %u regions", how, count);
                for (uint32_t k = 0; k < count; k++) {
                    CHECK(dot3(contacts[k].normal, way) >= cos(tilt), "%s: normal %g off", how,
                          acos(dot3(contacts[k].normal, way)));
                    CHECK(contacts[k].overlap <= most + 1e-9 &&
                              contacts[k].overlap >= most - sag * length - 1e-9,
                          "%s: overlap %.9g, not %.9g", how, contacts[k].overlap, most);
                    CHECK(fabs(contacts[k].moment - 0.5 * contacts[k].overlap) <=
                              0.02 * peak + 1e-12,
                          "%s: moment %.9g, overlap %.9g", how, contacts[k].moment,
                          contacts[k].overlap);
                }
            }
        }
        stage_close(&stage);
    }
    solid_close(&solid);
}

static void round_sphere(void)
{
    const double margin = 0.001, tool = 0.004;
    double outer = 0, inner = INFINITY, peak, moment;
    struct solid solid;
    struct stage stage;
    if (!solid_from_shape(&solid, "sphere", 5120) ||
        !stage_open(&stage, solid.mesh, NULL, margin, 32, 0))
        return;
    double tilt = 0;
    for (uint32_t t = 0; t < solid.place.triangles; t++) {
        double c[9], n[3];
        for (int k = 0; k < 9; k++)
            c[k] = (double)solid.corners[9 * (size_t)t + (size_t)k];
        for (int k = 0; k < 3; k++) {
            const int i = (k + 1) % 3, j = (k + 2) % 3;
            n[k] = (c[3 + i] - c[i]) * (c[6 + j] - c[j]) - (c[3 + j] - c[j]) * (c[6 + i] - c[i]);
        }
        unit3(n);
        inner = fmin(inner, dot3(n, c));
        for (int i = 0; i < 9; i += 3) {
            const double far = sqrt(dot3(c + i, c + i));
            outer = fmax(outer, far);
            tilt = fmax(tilt, acos(dot3(n, c + i) / far));
        }
    }
    struct round_height r = { outer + tool - 0.002, 0.08, 0.3, outer };
    integrate(height_of_round, &r, r.length, margin + tool, &peak, &moment);
    for (int i = 0; i < 500; i++) {
        const double a = 0.004 * i, b = 0.0017 * i;
        const double way[3] = { cos(a) * cos(b), sin(a) * cos(b), sin(b) };
        const double side[3] = { -sin(a), cos(a), 0 };
        double ends[6];
        r.least = outer + tool + 0.0015 - 0.000007 * i;
        for (int k = 0; k < 3; k++) {
            ends[k] = r.least * way[k] - 0.3 * r.length * side[k];
            ends[3 + k] = r.least * way[k] + 0.7 * r.length * side[k];
        }
        const dpt_hit hit = stage_tick(&stage, ends, tool);
        check_round(&stage, "sphere", &r, outer - inner, 2 * tilt, tool, margin, peak, way, &hit);
    }
    stage_close(&stage);
    solid_close(&solid);
}

/* Numbers: two bumps, their tops 0.0202 m high and 0.06 m apart, between them 0.013 m. */

static void place_bumps(double u, double v, double x[3])
{
    x[0] = 0.2 * v - 0.1;
    x[1] = 0.2 * u - 0.1;
    x[2] = 0;
    for (int side = -1; side <= 1; side += 2) {
        const double off = x[0] - 0.03 * side;
        x[2] += 0.02 * exp(-(off * off + x[1] * x[1]) / 0.0008);
    }
}

static void over_bumps(double x, double y, double z, double ends[6])
{
    const double at[6] = { x - 0.07, y, z, x + 0.07, y, z };
    memcpy(ends, at, sizeof at);
}

/* Down from above until both are within the margin of 4 mm, slowly or at once. */
static dpt_hit lower_to_bumps(struct stage *stage, int ticks_down)
{
    dpt_hit hit = DPT_HIT_INIT;
    for (int i = 0; i < ticks_down; i++) {
        double ends[6];
        over_bumps(0.001, 0.002, 0.0225 + 0.0001 * (ticks_down - 1 - i), ends);
        hit = stage_tick(stage, ends, 0.003);
    }
    return hit;
}

static void a_first_tick_finds_all_regions(void)
{
    struct solid solid;
    struct stage stage;
    dpt_contact c[STAGE_CONTACTS];
    if (!solid_from_net(&solid, "bumps", 60, 60, 0, place_bumps) ||
        !stage_open(&stage, solid.mesh, NULL, 0.004, 32, 0))
        return;
    lower_to_bumps(&stage, 1);
    CHECK(stage_contacts(&stage, c) == 2, "%u regions over two bumps", stage_contacts(&stage, c));
    stage_close(&stage);
    solid_close(&solid);
}

static void numbers_live_as_long_as_regions(void)
{
    struct solid solid;
    struct stage stage;
    struct names names = { .count = 0 };
    dpt_contact c[STAGE_CONTACTS];
    uint32_t count = 0, first[2] = { 0, 0 }, joined = 0, split[2];
    double ends[6];
    uint64_t tick = 0;
    if (!solid_from_net(&solid, "bumps", 60, 60, 0, place_bumps) ||
        !stage_open(&stage, solid.mesh, NULL, 0.004, 32, 0))
        return;
    /* Down until both bumps are within the margin, then about. */
    for (int i = 0; i <= 100; i++) {
        over_bumps(0, 0, 0.0325 - 0.0001 * i, ends);
        stage_tick(&stage, ends, 0.003);
        count = stage_contacts(&stage, c);
        check_names(&names, tick++, c, count, "down");
    }
    CHECK(count == 2, "%u regions over two bumps", count);
    for (int k = 0; k < 2; k++)
        first[k] = c[k].id;
    for (int i = 0; i < 400; i++) {
        const double turn = 2 * 3.14159265358979323846 * i / 200;
        over_bumps(0.005 * sin(turn), 0.004 * sin(2 * turn), 0.0225, ends);
        stage_tick(&stage, ends, 0.003);
        count = stage_contacts(&stage, c);
        check_names(&names, tick++, c, count, "about");
        CHECK(count == 2 && c[0].id == first[0] && c[1].id == first[1],
              "%u regions, %u and %u, not %u and %u", count, c[0].id, c[1].id, first[0], first[1]);
        CHECK(count < 2 || (c[0].s1 <= c[1].s0 && c[0].s < 0.5 && c[1].s > 0.5), "order");
    }
    /* Lower: one. */
    for (int i = 0; i <= 80; i++) {
        over_bumps(0, 0, 0.0225 - 0.00005 * i, ends);
        stage_tick(&stage, ends, 0.003);
        count = stage_contacts(&stage, c);
        check_names(&names, tick++, c, count, "joining");
        CHECK(count == 1 || count == 2, "%u regions", count);
        for (uint32_t k = 0; k < count; k++)
            CHECK(c[k].id == first[0] || c[k].id == first[1], "%u is new", c[k].id);
    }
    CHECK(count == 1, "%u regions where all is within the margin", count);
    joined = c[0].id;
    /* Up: two again, one of them as before. */
    for (int i = 0; i <= 80; i++) {
        over_bumps(0, 0, 0.0185 + 0.00005 * i, ends);
        stage_tick(&stage, ends, 0.003);
        count = stage_contacts(&stage, c);
        check_names(&names, tick++, c, count, "splitting");
    }
    CHECK(count == 2, "%u regions after the split", count);
    for (int k = 0; k < 2; k++)
        split[k] = c[k].id;
    CHECK((split[0] == joined) != (split[1] == joined), "%u and %u, one of them from %u", split[0],
          split[1], joined);
    const uint32_t other = split[0] == joined ? split[1] : split[0];
    CHECK(other != first[0] && other != first[1], "%u is used again", other);
    /* Away and back: all new. */
    for (int i = -100; i <= 100; i++) {
        over_bumps(0, 0, 0.0225 + 0.0001 * abs(100 - abs(i)), ends);
        stage_tick(&stage, ends, 0.003);
        count = stage_contacts(&stage, c);
        check_names(&names, tick++, c, count, "back");
        CHECK(i || count == 0, "%u regions", count);
        CHECK(abs(i) != 100 || count == 2, "%u regions", count);
    }
    stage_close(&stage);
    solid_close(&solid);
}

static void room_for_contacts(void)
{
    struct solid solid;
    struct stage stage;
    double ends[6], gap = 0;
    if (!solid_from_net(&solid, "bumps", 60, 60, 0, place_bumps))
        return;
    over_bumps(0.001, 0.002, 0.0225, ends);
    /* Slowly, as what a first tick finds is another test. */
    static const uint32_t room[4] = { 32, 2, 1, 0 };
    for (int i = 0; i < 4; i++) {
        dpt_contact c[STAGE_CONTACTS];
        dpt_wrench wrench;
        if (!stage_open(&stage, solid.mesh, NULL, 0.004, room[i], 0))
            continue;
        lower_to_bumps(&stage, 100);
        for (int k = 0; k < 3; k++) {
            const dpt_hit hit = stage_tick(&stage, ends, 0.003);
            const int full = (stage.step.flags & DPT_STEP_CONTACTS_FULL) != 0;
            const uint32_t count = stage_contacts(&stage, c), fit = room[i] < 2 ? room[i] : 2;
            if (!i && !k)
                gap = hit.gap;
            CHECK(count == fit && stage.step.contacts == fit, "%u, %u regions in room for %u",
                  count, stage.step.contacts, room[i]);
            CHECK(full == (room[i] == 1), "flags %u, room for %u", stage.step.flags, room[i]);
            CHECK(fabs(hit.gap - gap) <= 1e-5 * solid.diagonal, "gap %.9g, not %.9g, room for %u",
                  hit.gap, gap, room[i]);
            CHECK(dpt_tool_get_wrench(stage.world, stage.tool, &wrench) == DPT_OK &&
                      wrench.force[2] > 0,
                  "no force with room for %u", room[i]);
        }
        stage_close(&stage);
    }
    /* The caller's room. */
    if (stage_open(&stage, solid.mesh, NULL, 0.004, 32, 0)) {
        struct {
            dpt_contact contact;
            double newer[2];
        } longer[3];
        dpt_contact c[2];
        uint32_t count = 77;
        lower_to_bumps(&stage, 100);
        CHECK(dpt_tool_get_contacts(stage.world, stage.tool, NULL, 0, &count) == DPT_OK &&
                  count == 2,
              "%u", count);
        memset(c, 0x5a, sizeof c);
        c[0].size = sizeof *c;
        CHECK(dpt_tool_get_contacts(stage.world, stage.tool, c, 1, &count) == DPT_OK && count == 2,
              "%u", count);
        CHECK(c[0].size == sizeof *c && c[0].segment == 0 && c[0].body == stage.body &&
                  c[1].size == 0x5a5a5a5a,
              "wrote beyond");
        c[0].size = 8;
        CHECK(dpt_tool_get_contacts(stage.world, stage.tool, c, 1, &count) == DPT_E_SIZE, "size");
        c[0].size = 0;
        CHECK(dpt_tool_get_contacts(stage.world, stage.tool, c, 2, &count) == DPT_E_SIZE, "size");
        memset(longer, 0x5a, sizeof longer);
        longer[0].contact.size = sizeof *longer;
        CHECK(dpt_tool_get_contacts(stage.world, stage.tool, &longer[0].contact, 3, &count) ==
                      DPT_OK &&
                  count == 2,
              "%u", count);
        const unsigned char *tail = (const unsigned char *)longer[1].newer;
        for (size_t i = 0; i < sizeof longer[1].newer; i++)
            CHECK(tail[i] == 0x5a, "wrote into the tail");
        CHECK(longer[1].contact.size == sizeof *longer && longer[1].contact.s > 0.5,
              "size %u, s %g", longer[1].contact.size, longer[1].contact.s);
        CHECK(longer[2].contact.size == 0x5a5a5a5a, "wrote beyond");
        CHECK(dpt_tool_get_contacts(stage.world, 0, c, 0, &count) != DPT_OK, "a tool 0");
        stage_close(&stage);
    }
    solid_close(&solid);
}

/* Sides of an open sheet. */

static int is_zero(const dpt_wrench *w)
{
    return dot3(w->force, w->force) == 0 && dot3(w->torque, w->torque) == 0;
}

/* Slowly down to a depth beyond the limit: forgotten there, and not before. */
static void press_to_the_limit(const struct solid *solid, double up, double radius)
{
    const double limit = 0.02, step = 0.0002;
    struct stage stage;
    if (!stage_open(&stage, solid->mesh, NULL, 0.001, 32, limit))
        return;
    for (int i = 0; i < 200; i++) {
        const double z = 0.0105 - step * i, gap = z - radius;
        const double ends[6] = { 0.0113, 0.0071, up * z, 0.0113, 0.0071, up * z };
        const dpt_hit hit = stage_tick(&stage, ends, radius);
        if (gap > -limit)
            CHECK((hit.flags & DPT_HIT_GAP) && fabs(hit.gap - gap) <= 1e-9,
                  "gap %.9g, not %.9g, from %g", hit.gap, gap, up);
        else if (gap < -limit - 2 * step)
            CHECK(fabs(hit.gap - (-z - radius)) <= 1e-9,
                  "gap %.9g behind the limit, not %.9g, from %g", hit.gap, -z - radius, up);
    }
    stage_close(&stage);
}

/* Pressed through, then sideways beyond the border and at once back: forgotten there, while it touches. */
static void press_beyond_the_border(const struct solid *solid)
{
    const double radius = 0.003, z = -0.002, border = solid->info.box_max[0];
    struct stage stage;
    if (!stage_open(&stage, solid->mesh, NULL, 0.001, 32, 0))
        return;
    for (int i = 0; i < 60; i++) {
        const double height = 0.006 + (z - 0.006) * i / 59;
        const double ends[6] = { 0.08, 0.0071, height, 0.08, 0.0071, height };
        stage_tick(&stage, ends, radius);
    }
    for (int i = 0; i < 420; i++) {
        const double x = 0.101 - 0.0001 * abs(210 - i), beyond = fmax(0, x - border);
        const double ends[6] = { x, 0.0071, z, x, 0.0071, z };
        const dpt_hit hit = stage_tick(&stage, ends, radius);
        const int forgotten = i > 210 || x > border + 1e-6;
        const double gap = (forgotten ? hypot(beyond, z) : z) - radius;
        if (forgotten || x < border - 1e-6)
            CHECK(fabs(hit.gap - gap) <= 1e-9, "gap %.9g, not %.9g at x = %g, tick %d", hit.gap,
                  gap, x, i);
    }
    stage_close(&stage);
}

static void teleport_forgets(const struct solid *solid)
{
    const double radius = 0.003;
    struct stage stage;
    dpt_hit hit;
    if (!stage_open(&stage, solid->mesh, NULL, 0.001, 32, 0))
        return;
    double ends[6] = { 0.0113, 0.0071, 0.006, 0.0113, 0.0071, 0.006 };
    for (int i = 0; i <= 50; i++) {
        ends[2] = ends[5] = 0.006 - 0.0002 * i;
        hit = stage_tick(&stage, ends, radius);
    }
    CHECK(fabs(hit.gap - (-0.004 - radius)) <= 1e-9, "gap %.9g", hit.gap);
    stage_jump(&stage);
    hit = stage_tick(&stage, ends, radius);
    CHECK(fabs(hit.gap - (0.004 - radius)) <= 1e-9, "gap %.9g after a teleport", hit.gap);
    stage_close(&stage);
}

/* Crossing from the first tick on there is no side; once it has been free, there is. */
static void a_first_tick_that_crosses(const struct solid *solid)
{
    const double radius = 0.002;
    struct stage stage;
    dpt_wrench wrench;
    if (!stage_open(&stage, solid->mesh, NULL, 0.001, 32, 0))
        return;
    for (int i = 0; i < 250; i++) {
        /* Standing on its end: through the sheet, out of it upwards, and in again. */
        const double z = i < 100 ? -0.005 + 0.0001 * i : 0.005 - 0.0001 * (i - 100);
        const double ends[6] = { 0.0113, 0.0071, z, 0.0123, 0.0091, z + 0.05 };
        const dpt_hit hit = stage_tick(&stage, ends, radius);
        dpt_tool_get_wrench(stage.world, stage.tool, &wrench);
        if (i < 49) {
            CHECK(hit.contact == DPT_CONTACT_UNKNOWN && !(hit.flags & DPT_HIT_GAP),
                  "tick %d: contact %u, gap %g", i, hit.contact, hit.gap);
            CHECK(is_zero(&wrench), "tick %d: force %g", i, wrench.force[2]);
        }
        if (i > 51) {
            CHECK((hit.flags & DPT_HIT_GAP) && fabs(hit.gap - (z - radius)) <= 1e-9,
                  "tick %d: gap %.9g, not %.9g", i, hit.gap, z - radius);
            CHECK(z >= radius ? is_zero(&wrench) : wrench.force[2] > 0, "tick %d: force %g at %g",
                  i, wrench.force[2], z);
        }
    }
    stage_close(&stage);
}

static void sheets_keep_their_side(void)
{
    struct solid solid;
    if (!solid_from_shape(&solid, "membrane", 800))
        return;
    for (int side = -1; side <= 1; side += 2) {
        press_to_the_limit(&solid, side, 0.003);
        press_to_the_limit(&solid, side, 0);
    }
    press_beyond_the_border(&solid);
    teleport_forgets(&solid);
    a_first_tick_that_crosses(&solid);
    solid_close(&solid);
}

int main(int argc, char **argv)
{
    setvbuf(stdout, NULL, _IOLBF, 0);
    data = getenv("DPT_DATA");
    if (argc > 1)
        ticks = strtoull(argv[1], NULL, 10);
    if (ticks < 20 || ticks > 100000000) {
        printf("test_region: from 20 ticks a slide to 100000000\n");
        return 2;
    }
    TEST(flat_sheet);
    TEST(flat_face);
    TEST(round_cylinder);
    TEST(round_sphere);
    TEST(a_first_tick_finds_all_regions);
    TEST(numbers_live_as_long_as_regions);
    TEST(room_for_contacts);
    TEST(sheets_keep_their_side);
    TEST(integrals_with_a_pose);
    TEST(integrals_of_deep_lines);
    TEST(integrals_on_a_torus);
    TEST(integrals_on_a_liver);
    TEST(integrals_on_a_star);
    if (data)
        TEST(integrals_on_organs);
    else
        SKIP("regions on public meshes", "DPT_DATA does not name the data folder");
    return check_report();
}
