/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Regions of contact in a world: their integrals and intervals against a quadrature at the same poses, on slides and
 * thrusts over meshes, and on ticks at which they jumped once.
 *
 *     test_contact_integrals           what make check runs
 *     test_contact_integrals TICKS     so many ticks a slide, 60 if not told
 *
 * Real meshes from DPT_DATA.
 */
#include "contact/depth_checks.h"
#include "contact/quadrature.h"

static const char *data;
static uint64_t ticks = 60;

/* The worst of a run, and what it takes to see it again. */
struct worst {
    double value;
    char text[512];
};

enum { OUTSIDE, BEYOND, MISSED, NOT_THERE, NOT_MIN, KINDS };
static const char *const kinds[KINDS] = { "of the reach is outside of all regions",
                                          "of the peak is in a region, but beyond the margin",
                                          "of the peak is in no region", "diagonals off is a region's gap at its own p",
                                          "diagonals above the least in its stretch is a gap" };
static const double allowed[KINDS] = { 0.05, 0.02, 0.01, 1e-5, 1e-5 };

struct scene {
    const struct solid *solid;
    const dpt_pose *pose;
    const char *how;
    double margin, radius, diagonal;
    int cold; /* each tick is a first one */
    struct rig rig;
    struct id_history names;
    uint64_t tick;
    struct worst worst[KINDS];
};

static const char *scene_text(const struct scene *scene, uint64_t tick, const double ends[6])
{
    static char text[512];
    snprintf(text, sizeof text, "%s, %s, tick %u, margin %g, radius %g: %a %a %a  %a %a %a", scene->solid->name,
             scene->how, (unsigned)tick, scene->margin, scene->radius, ends[0], ends[1], ends[2], ends[3], ends[4],
             ends[5]);
    return text;
}

static void note(struct scene *scene, int kind, double value, const double ends[6])
{
    if (value > scene->worst[kind].value) {
        scene->worst[kind].value = value;
        snprintf(scene->worst[kind].text, sizeof scene->worst[kind].text, "%s", scene_text(scene, scene->tick, ends));
    }
}

/* One region for itself. */
static void check_region(struct scene *scene, const double ends[6], const struct quadrature *quadrature,
                         const dpt_contact *c)
{
    const double bound = 1e-5 * scene->diagonal, tiny = 1e-12 * scene->diagonal;
    const char *text = scene_text(scene, scene->tick, ends);
    double p[3], q[3] = { 0, 0, 0 }, corners[9], way[3], least = INFINITY;
    CHECK(c->s0 >= 0 && c->s0 <= c->s && c->s <= c->s1 && c->s1 <= 1, "%g <= %g <= %g: %s", c->s0, c->s, c->s1, text);
    CHECK(c->gap <= scene->margin + bound, "gap %g: %s", c->gap, text);
    point_at(ends, c->s, p);
    CHECK(apart(p, c->p) <= tiny, "p: %s", text);
    CHECK(fabs(c->weight[0] + c->weight[1] + c->weight[2] - 1) <= 1e-12, "weights: %s", text);
    CHECK(fmin(c->weight[0], fmin(c->weight[1], c->weight[2])) >= 0, "weights: %s", text);
    CHECK(dpt_mesh_get_triangle(scene->solid->mesh, c->triangle, corners) == DPT_OK, "triangle %u: %s", c->triangle,
          text);
    for (int i = 0; i < 9; i++)
        q[i % 3] += c->weight[i / 3] * corners[i];
    /* A pose keeps distances; without one q is where the weights say. */
    if (!scene->pose)
        CHECK(apart(q, c->q) <= tiny, "q is %g off its weights: %s", apart(q, c->q), text);
    CHECK(fabs(sqrt(dot3(c->normal, c->normal)) - 1) <= 1e-9, "normal %g: %s", sqrt(dot3(c->normal, c->normal)), text);
    for (int k = 0; k < 3; k++)
        way[k] = c->p[k] - c->q[k];
    const double distance = unit3(way);
    const double sign = c->gap + scene->radius < 0 ? -1 : 1;
    CHECK(fabs(sign * distance - (c->gap + scene->radius)) <= bound, "gap %.9g, but %.9g apart: %s", c->gap, distance,
          text);
    if (distance > 1e-7 * scene->diagonal)
        CHECK(sign * dot3(way, c->normal) >= 1 - 1e-9, "normal is %g off: %s", 1 - sign * dot3(way, c->normal), text);
    double at[6] = { p[0], p[1], p[2], p[0], p[1], p[2] };
    dpt_hit hit = DPT_HIT_INIT;
    dpt_query_segments(scene->solid->mesh, scene->pose, at, NULL, 1, &hit, NULL);
    note(scene, NOT_THERE, fabs(hit.gap - scene->radius - c->gap) / scene->diagonal, ends);
    for (size_t i = 0; i < quadrature->count; i++)
        if (quadrature->s[i] >= c->s0 && quadrature->s[i] <= c->s1)
            least = fmin(least, quadrature->height[i] - scene->radius);
    note(scene, NOT_MIN, (c->gap - least) / scene->diagonal, ends);
    CHECK(c->contact == DPT_CONTACT_UNKNOWN || (c->contact == DPT_CONTACT_PENETRATING) == (c->gap < -hit.error_bound) ||
              fabs(c->gap) < 1e-9 * scene->diagonal,
          "contact %u, gap %g: %s", c->contact, c->gap, text);
}

/* Within the intervals the surface is within the margin, and outside of them it is not. */
static void check_intervals(struct scene *scene, const double ends[6], const struct quadrature *quadrature,
                            const dpt_contact *contacts, uint32_t count)
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
static void check_quadrature(const struct scene *scene, const double ends[6], const struct quadrature *quadrature)
{
    for (size_t i = 0; i < quadrature->count; i += 1 + quadrature->count / 8) {
        double x[3];
        point_at(ends, quadrature->s[i], x);
        const double height = oracle_signed(&scene->solid->oracle, x);
        CHECK(fabs(height - quadrature->height[i]) <= 1e-9 * scene->diagonal, "%.12g, not %.12g at %g: %s",
              quadrature->height[i], height, quadrature->s[i], scene_text(scene, scene->tick, ends));
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
        const double peak = fmax(peak_of(record, count, which < 4 ? which % 2 : which), 1e-30);
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
        CHECK(doubt <= 0.002, "the quadrature is not sure of %s by %.2f %%", integral_names[which], 100 * doubt);
        CHECK(worst[which] <= 0.02, "%s is %.2f %% off: %s", integral_names[which], 100 * worst[which],
              scene_text(scene, at, record[at].ends));
        /* Spikes that cancel are where the library falls short of half a per cent. */
        const double most = strcmp(name, "star") == 0 ? 0.01 : 0.005;
        CHECK(scene->cold || jump[which] <= most, "%s jumps by %.2f %% more: %s", integral_names[which],
              100 * jump[which], scene_text(scene, jump_at, record[jump_at].ends));
    }
    for (int kind = 0; kind < KINDS; kind++)
        CHECK(scene->worst[kind].value <= allowed[kind], "%.2g %s: %s", scene->worst[kind].value, kinds[kind],
              scene->worst[kind].text);
    printf("    %-26s %-12s off %5.2f %5.2f %6.2f %5.2f %%, jumps %5.2f %5.2f %5.2f %5.2f %%, "
           "missed %.2f %%, one point %u\n",
           name, how, 100 * worst[0], 100 * worst[1], 100 * worst[2], 100 * worst[3], 100 * jump[0], 100 * jump[1],
           100 * jump[2], 100 * jump[3], 100 * scene->worst[MISSED].value, (unsigned)single_jumps);
    return single_jumps;
}

/* A run's ends, one tick after another. */
typedef void next_ends(void *of, double ends[6]);

static uint64_t run(struct scene *scene, next_ends *next, void *of, uint64_t count)
{
    static struct quadrature quadrature;
    struct record *record = calloc(count, sizeof *record);
    if (!record || !depth_rig_open(&scene->rig, NULL, scene->margin, 32) ||
        !rig_add_body(&scene->rig, scene->solid->mesh, scene->pose)) {
        free(record);
        return 0;
    }
    for (uint64_t i = scene->tick = 0; i < count; scene->tick = ++i) {
        dpt_contact contacts[RIG_CONTACTS], *deepest = NULL;
        double ends[6];
        next(of, ends);
        if (scene->cold)
            dpt_tool_teleport(scene->rig.world, scene->rig.tool, &scene->rig.device);
        rig_step_ends(&scene->rig, ends, scene->radius);
        const uint32_t found = rig_contacts(&scene->rig, contacts);
        take_quadrature(&quadrature, scene->solid->mesh, scene->pose, ends, scene->margin + scene->radius);
        memcpy(record[i].ends, ends, sizeof ends);
        record[i].truth = quadrature.sum;
        record[i].half = quadrature.half;
        if (i % 16 == 0 && !scene->pose)
            check_quadrature(scene, ends, &quadrature);
        CHECK(scene->rig.step.contacts == found, "%u contacts, not %u: %s", scene->rig.step.contacts, found,
              scene_text(scene, scene->tick, ends));
        for (uint32_t k = 0; k < found; k++) {
            const dpt_contact *c = &contacts[k];
            check_region(scene, ends, &quadrature, c);
            record[i].ours.overlap += c->overlap;
            record[i].ours.moment += c->moment;
            record[i].ours.square += c->square;
            for (int d = 0; d < 3; d++) {
                record[i].ours.thrust[d] += c->thrust[d];
                record[i].ours.thrust_moment[d] += c->thrust_moment[d];
            }
            if (!deepest || c->gap < deepest->gap)
                deepest = &contacts[k];
        }
        check_ids(&scene->names, i, contacts, found, scene_text(scene, scene->tick, ends));
        check_intervals(scene, ends, &quadrature, contacts, found);
        if (deepest)
            add_overlap(&record[i].single, record[i].ours.overlap, deepest->s, deepest->normal);
    }
    scene->worst[BEYOND].value /= fmax(peak_of(record, count, 0), 1e-30);
    scene->worst[MISSED].value /= fmax(peak_of(record, count, 0), 1e-30);
    const uint64_t single_jumps = check_run(scene, record, count);
    rig_close(&scene->rig);
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
static void slide_over(const struct solid *solid, const dpt_pose *pose, const char *how, int cold, double margin,
                       double radius, double length, uint64_t seed, uint64_t from_tick, uint64_t count,
                       uint64_t *single_jumps)
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
static void push_into(const struct solid *solid, const char *how, double margin, double radius, double length,
                      uint64_t seed, uint64_t from_tick, uint64_t count)
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
        slide_over(&solid, NULL, "a stretch beyond one that ends", 0, 0.02, 0.005, 0.7, 4, 1520, 35, &jumps);
    solid_close(&solid);
    char path[4096];
    snprintf(path, sizeof path, "%s/meshes/organs/gallbladder_low.stl", data ? data : "");
    if (data && solid_from_file(&solid, "gallbladder", path, 1)) {
        push_into(&solid, "samples that are trapped", 0.003, 0.01, 0.5, 5, 40, 90);
        slide_over(&solid, NULL, "an estimate that is far off", 0, 0.003, 0.01, 0.4, 1, 1090, 28, &jumps);
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

int main(int argc, char **argv)
{
    setvbuf(stdout, NULL, _IOLBF, 0);
    data = getenv("DPT_DATA");
    if (argc > 1)
        ticks = strtoull(argv[1], NULL, 10);
    if (ticks < 20 || ticks > 100000000) {
        printf("test_contact_integrals: from 20 ticks a slide to 100000000\n");
        return 2;
    }
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
