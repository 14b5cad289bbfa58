/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Shapes whose surface is a function of direction from a centre: sphere, star and organs. Each is a
 * geodesic sphere laid onto that surface, so none can intersect itself.
 *
 * Organs stand as they are seen from the front: x to the patient's left, y up, z to the viewer.
 */
#include "scene/shape.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/sincos.h"
#include "base/vec3.h"

/*
 * The geodesic sphere: an icosahedron with one corner up (+y), each side cut in k, laid out in
 * rings from the top down. A ring has five sectors of `steps` edges.
 */
struct icosahedron {
    double top[3], upper[5][3], lower[5][3], bottom[3];
};

static void icosahedron_init(struct icosahedron *ico)
{
    double height = sqrt(0.2), across = 2.0 * height, sine, cosine;
    const struct icosahedron poles = { .top = { 0.0, 1.0, 0.0 }, .bottom = { 0.0, -1.0, 0.0 } };
    *ico = poles;
    for (int s = 0; s < 5; s++) {
        turn_sincos(0.2 * s, &sine, &cosine);
        ico->upper[s][0] = across * sine;
        ico->upper[s][1] = height;
        ico->upper[s][2] = across * cosine;
        turn_sincos(0.2 * s + 0.1, &sine, &cosine);
        ico->lower[s][0] = across * sine;
        ico->lower[s][1] = -height;
        ico->lower[s][2] = across * cosine;
    }
}

static uint32_t ring_steps(uint32_t k, uint32_t ring)
{
    return ring < k ? ring : ring > 2 * k ? 3 * k - ring : k;
}

static void blend(const double *a, uint32_t wa, const double *b, uint32_t wb, const double *c, uint32_t wc,
                  double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = wa * a[i] + wb * b[i] + wc * c[i];
    vec3_normalise(out);
}

static void ring_point(const struct icosahedron *ico, uint32_t k, uint32_t ring, uint32_t sector, uint32_t i,
                       double out[3])
{
    uint32_t next = (sector + 1) % 5, row = ring - k; /* row: below the upper corners */
    const double *upper = ico->upper[sector], *upper_next = ico->upper[next];
    const double *lower = ico->lower[sector], *lower_next = ico->lower[next];
    if (ring < k)
        blend(ico->top, k - ring, upper, ring - i, upper_next, i, out);
    else if (ring > 2 * k)
        blend(ico->bottom, ring - 2 * k, lower, 3 * k - ring - i, lower_next, i, out);
    else if (i <= k - row)
        blend(upper, k - row - i, upper_next, i, lower, row, out);
    else
        blend(upper_next, k - row, lower, k - i, lower_next, i - (k - row), out);
}

static size_t ring_vertex(size_t first, uint32_t steps, uint32_t sector, uint32_t i)
{
    return steps ? first + (sector * steps + i) % (5 * steps) : first;
}

/* The triangles between two rings that differ by one step a sector at most. */
static void join_rings(struct shape *shape, size_t above, uint32_t above_steps, size_t below, uint32_t below_steps)
{
    uint32_t steps = above_steps > below_steps ? above_steps : below_steps;
    for (uint32_t sector = 0; sector < 5; sector++) {
        for (uint32_t i = 0; i < steps; i++) {
            size_t a = ring_vertex(above, above_steps, sector, i);
            size_t b = ring_vertex(below, below_steps, sector, i);
            size_t a_next = ring_vertex(above, above_steps, sector, i + 1);
            size_t b_next = ring_vertex(below, below_steps, sector, i + 1);
            if (above_steps < below_steps) {
                shape_add_triangle(shape, a, b, b_next);
                if (i < above_steps)
                    shape_add_triangle(shape, a, b_next, a_next);
            } else {
                shape_add_triangle(shape, a, b, a_next);
                if (i < below_steps)
                    shape_add_triangle(shape, a_next, b, b_next);
            }
        }
    }
}

/* Leaves out the triangles above the ring `open`, which leaves a border of 5 `open` edges. */
static void add_geodesic(struct shape *shape, uint32_t k, uint32_t open, const double stretch[3],
                         const struct shape_surface *surface)
{
    struct icosahedron ico;
    icosahedron_init(&ico);
    size_t above = 0;
    for (uint32_t ring = open; ring <= 3 * k; ring++) {
        uint32_t steps = ring_steps(k, ring);
        size_t first = shape->vertex_count;
        for (uint32_t sector = 0; sector < (steps ? 5 : 1); sector++) {
            for (uint32_t i = 0; i < (steps ? steps : 1); i++) {
                double p[3];
                ring_point(&ico, k, ring, sector, i, p);
                for (int n = 0; n < 3; n++)
                    p[n] *= stretch[n];
                surface->project(surface->context, p);
                shape_add_vertex(shape, p[0], p[1], p[2]);
            }
        }
        if (ring > open)
            join_rings(shape, above, ring_steps(k, ring - 1), first, steps);
        above = first;
    }
}

/* How many rings an opening takes: about an eighth of the way down to the upper corners. */
static uint32_t opening(uint32_t k)
{
    return k < 12 ? 1 : (k + 4) / 8;
}

/*
 * The surface, seen from its centre, in exactly `count` triangles; an odd count leaves it open at
 * the top. `stretch` is its rough size along the axes, which spreads the vertices.
 */
static int make_round(uint32_t count, const double stretch[3], const struct shape_surface *surface, struct shape *shape)
{
    uint32_t k = square_root_below(count / 20), open = count % 2 ? opening(k) : 0;
    while (open && 20 * (k + 1) * (k + 1) - 5 * opening(k + 1) * opening(k + 1) <= count)
        open = opening(++k);
    uint32_t base = 20 * k * k - 5 * open * open;
    if (shape_begin(shape, (size_t)10 * k * k + 2 + (count - base), count))
        return -1;
    add_geodesic(shape, k, open, stretch, surface);
    return shape_split_to(shape, count, surface);
}

static void project_on_sphere(const void *context, double p[3])
{
    (void)context;
    vec3_normalise(p);
    for (int i = 0; i < 3; i++)
        p[i] *= 0.1;
}

int shape_sphere(uint32_t count, uint64_t seed, struct shape *shape)
{
    const struct shape_surface surface = { project_on_sphere, NULL };
    const double stretch[3] = { 1.0, 1.0, 1.0 };
    (void)seed;
    return make_round(count, stretch, &surface, shape);
}

/* A smooth hill of height 1 around a direction, 0 beyond the angle whose cosine is `edge`. */
static double hill(const double direction[3], const double top[3], double edge)
{
    double t = (vec3_dot(direction, top) - edge) / (1.0 - edge);
    return t > 0.0 ? t * t * (3.0 - 2.0 * t) : 0.0;
}

/* Star: spikes on a spiral of equal areas. */
enum { STAR_SPIKES = 48 };

struct star {
    double spikes[STAR_SPIKES][3];
};

static void project_on_star(const void *context, double p[3])
{
    /* The cosine of 13 degrees: a spike is 7 degrees to either side at half its height. */
    const double edge = 0.97437006478523525;
    const struct star *star = context;
    double height = 0.0;
    vec3_normalise(p);
    for (int s = 0; s < STAR_SPIKES; s++) {
        double height_here = 1.0 - (1.0 - vec3_dot(p, star->spikes[s])) / (1.0 - edge);
        if (height_here > height)
            height = height_here;
    }
    for (int i = 0; i < 3; i++)
        p[i] *= 0.06 + 0.09 * height * height;
}

int shape_star(uint32_t count, uint64_t seed, struct shape *shape)
{
    const double golden_turn = 0.38196601125010515, stretch[3] = { 1.0, 1.0, 1.0 };
    double start = shape_random(&seed);
    struct star star;
    const struct shape_surface surface = { project_on_star, &star };
    for (int s = 0; s < STAR_SPIKES; s++) {
        double y = 1.0 - (2 * s + 1) / (double)STAR_SPIKES, across = sqrt(1.0 - y * y), sine, cosine;
        turn_sincos(start + golden_turn * s, &sine, &cosine);
        star.spikes[s][0] = across * sine;
        star.spikes[s][1] = y;
        star.spikes[s][2] = across * cosine;
    }
    return make_round(count, stretch, &surface, shape);
}

/*
 * Organs: some ellipsoids that all contain the centre, blended, with dents. All lengths in metres.
 */
struct lobe {
    double centre[3], axes[3]; /* half axes, of which the first two are turned about z */
    double cosine, sine;
};

struct dent {
    double direction[3], edge, depth; /* cosine of its half-width; depth as a share of the radius */
};

enum { LOBES_MAX = 3, DENTS_MAX = 3, BUMPS = 14 };

struct organ {
    double position[3], stretch[3];
    struct lobe lobes[LOBES_MAX];
    struct dent dents[DENTS_MAX];
};

struct organ_surface {
    const struct organ *organ;
    struct dent dents[DENTS_MAX + BUMPS];
};

static void into_lobe(const struct lobe *lobe, const double v[3], double out[3])
{
    out[0] = (lobe->cosine * v[0] + lobe->sine * v[1]) / lobe->axes[0];
    out[1] = (lobe->cosine * v[1] - lobe->sine * v[0]) / lobe->axes[1];
    out[2] = v[2] / lobe->axes[2];
}

/* How far the lobe reaches from the origin, which it contains, in a direction. */
static double lobe_reach(const struct lobe *lobe, const double direction[3])
{
    double d[3], c[3];
    into_lobe(lobe, direction, d);
    into_lobe(lobe, lobe->centre, c);
    double dd = vec3_dot(d, d), dc = vec3_dot(d, c);
    return (dc + sqrt(dc * dc + dd * (1.0 - vec3_dot(c, c)))) / dd;
}

static double organ_reach(const struct organ_surface *surface, const double direction[3])
{
    const struct organ *organ = surface->organ;
    double sum = 0.0, factor = 1.0;
    for (int i = 0; i < LOBES_MAX; i++) {
        double reach = lobe_reach(&organ->lobes[i], direction), square = reach * reach;
        sum += square * square * square * square;
    }
    for (int i = 0; i < DENTS_MAX + BUMPS; i++) {
        const struct dent *dent = &surface->dents[i];
        factor *= 1.0 - dent->depth * hill(direction, dent->direction, dent->edge);
    }
    return factor * sqrt(sqrt(sqrt(sum))); /* the eighth root: near to the largest, but smooth */
}

static void project_on_organ(const void *context, double p[3])
{
    const struct organ_surface *surface = context;
    vec3_normalise(p);
    double reach = organ_reach(surface, p);
    for (int i = 0; i < 3; i++)
        p[i] *= reach;
}

static void random_direction(uint64_t *state, double direction[3])
{
    double sine, cosine, y = 2.0 * shape_random(state) - 1.0, across = sqrt(1.0 - y * y);
    turn_sincos(shape_random(state), &sine, &cosine);
    direction[0] = across * sine;
    direction[1] = y;
    direction[2] = across * cosine;
}

static int make_organ(const struct organ *organ, uint32_t count, uint64_t seed, struct shape *shape)
{
    struct organ_surface organ_surface = { .organ = organ };
    const struct shape_surface surface = { project_on_organ, &organ_surface };
    for (int i = 0; i < DENTS_MAX; i++) {
        organ_surface.dents[i] = organ->dents[i];
        vec3_normalise(organ_surface.dents[i].direction);
    }
    for (int i = DENTS_MAX; i < DENTS_MAX + BUMPS; i++) {
        random_direction(&seed, organ_surface.dents[i].direction);
        organ_surface.dents[i].edge = 0.75 + 0.2 * shape_random(&seed);
        organ_surface.dents[i].depth = 0.06 * shape_random(&seed) - 0.03;
    }
    if (make_round(count, organ->stretch, &surface, shape))
        return -1;
    for (size_t i = 0; i < 3 * shape->vertex_count; i++)
        shape->vertices[i] += organ->position[i % 3];
    return 0;
}

static const struct organ liver = {
    .position = { 0.0, 0.0, 0.0 },
    .stretch = { 0.14, 0.09, 0.06 },
    .lobes = { { { -0.047, -0.010, -0.004 }, { 0.091, 0.081, 0.059 }, 1.0, 0.0 },
               { { 0.050, 0.023, 0.008 }, { 0.093, 0.034, 0.031 }, 0.995, 0.0998749217771909 },
               { { 0.000, 0.032, 0.002 }, { 0.088, 0.049, 0.048 }, 0.96, -0.28 } },
    .dents = { { { 0.42, -0.90, 0.25 }, 0.82, 0.20 },
               { { 0.15, -0.45, -0.85 }, 0.45, 0.26 },
               { { -0.60, -0.60, -0.55 }, 0.70, 0.08 } },
};

int shape_liver(uint32_t count, uint64_t seed, struct shape *shape)
{
    return make_organ(&liver, count, seed, shape);
}

/* Its inlet is the rise at the top. */
static const struct organ stomach = {
    .position = { 0.105, -0.085, -0.02 },
    .stretch = { 0.08, 0.08, 0.045 },
    .lobes = { { { 0.024, 0.022, 0.000 }, { 0.080, 0.042, 0.040 }, 0.6, 0.8 },
               { { 0.004, -0.016, 0.000 }, { 0.062, 0.038, 0.035 }, 0.8, 0.6 },
               { { -0.030, -0.012, 0.000 }, { 0.060, 0.029, 0.027 }, 0.96, -0.28 } },
    .dents = { { { -0.60, 0.80, 0.00 }, 0.60, 0.15 },
               { { 0.00, 1.00, 0.00 }, 0.95, -0.25 },
               { { 0.00, 0.00, -1.00 }, 0.70, 0.10 } },
};

int shape_stomach(uint32_t count, uint64_t seed, struct shape *shape)
{
    return make_organ(&stomach, count, seed, shape);
}

static const struct organ spleen = {
    .position = { 0.22, -0.03, -0.06 },
    .stretch = { 0.03, 0.055, 0.022 },
    .lobes = { { { 0.000, 0.000, 0.000 }, { 0.055, 0.032, 0.021 }, 0.28, 0.96 },
               { { 0.006, 0.012, 0.000 }, { 0.038, 0.028, 0.021 }, 0.6, 0.8 },
               { { 0.006, -0.012, 0.000 }, { 0.038, 0.028, 0.019 }, 0.28, 0.96 } },
    .dents = { { { -1.00, 0.00, 0.30 }, 0.50, 0.25 },
               { { 0.70, 0.60, 0.30 }, 0.90, 0.06 },
               { { 0.00, 0.00, -1.00 }, 0.80, 0.05 } },
};

int shape_spleen(uint32_t count, uint64_t seed, struct shape *shape)
{
    return make_organ(&spleen, count, seed, shape);
}

const char *const laparoscopic_names[LAPAROSCOPIC_BODIES] = { "liver", "stomach", "spleen" };

int shape_make_laparoscopic(uint64_t count, uint64_t seed, struct shape bodies[LAPAROSCOPIC_BODIES],
                            shape_reason reason)
{
    uint64_t liver_count = count / 4 * 2, spleen_count = count / 10 * 2;
    const uint64_t counts[] = { liver_count, count - liver_count - spleen_count, spleen_count };
    memset(bodies, 0, LAPAROSCOPIC_BODIES * sizeof *bodies);
    if (count < LAPAROSCOPIC_MIN || count > SHAPE_TRIANGLES_MAX) {
        snprintf(reason, SHAPE_REASON_BYTES, "laparoscopic has from %d to %u triangles", LAPAROSCOPIC_MIN,
                 SHAPE_TRIANGLES_MAX);
        return -1;
    }
    int failed = 0;
    for (int i = 0; i < LAPAROSCOPIC_BODIES && !failed; i++)
        failed = shape_make(laparoscopic_names[i], counts[i], seed, &bodies[i], reason);
    for (int i = 0; i < LAPAROSCOPIC_BODIES && failed; i++)
        shape_free(&bodies[i]);
    return failed;
}
