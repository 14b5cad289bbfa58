/* SPDX-License-Identifier: BSD-3-Clause */
#include "lab/tissue.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/sincos.h"
#include "base/vec3.h"

int spring_body_open(struct spring_body *body, dpt_world *world)
{
    dpt_deformable_def deform;
    dpt_springs_def springs;
    dpt_deformable_def_init(&deform);
    dpt_springs_def_init(&springs);
    deform.mesh = springs.mesh = body->mesh;
    deform.load_radius = body->load_radius;
    springs.integrator = body->integrator;
    body->world = world;
    body->block = malloc(dpt_deformable_bytes(&deform));
    body->springs_block = malloc(dpt_springs_bytes(&springs));
    return body->block && body->springs_block &&
           dpt_body_add_deformable(world, body->block, dpt_deformable_bytes(&deform), &deform, &body->body) == DPT_OK &&
           dpt_springs_create(body->springs_block, dpt_springs_bytes(&springs), &springs, &body->springs) == DPT_OK;
}

void spring_body_close(struct spring_body *body)
{
    free(body->block);
    free(body->springs_block);
    body->block = body->springs_block = NULL;
}

void spring_body_step(struct spring_body *body, double dt)
{
    dpt_springs_info report = { .size = sizeof report };
    if (!body->is_free)
        return;
    if (dpt_body_step_springs(body->world, body->body, body->springs, dt, &report) != DPT_OK)
        body->has_failed = 1;
    body->held += (report.flags & DPT_SPRINGS_FLAG_HELD) != 0;
    body->nodes += report.nodes;
    body->active += report.active;
}

double spring_body_energy(const struct spring_body *body)
{
    double elastic = 0.0, kinetic = 0.0;
    dpt_springs_get_energy(body->springs, &elastic, &kinetic);
    return elastic + kinetic;
}

enum { LOADS_MAX = 8192, SWEEPS_MAX = 400 };

/* The share of the right side that conjugate gradients may leave. */
#define LEFT 1e-6

const struct tissue_matter tissue_soft = { .foundation = 1e5, .tension = 30.0, .damping = 5e3, .mass = 20.0 };

struct tissue_link {
    uint32_t from, to;
    uint32_t triangles; /* at the edge */
    double weight;      /* half the sum of the cotangents of the angles across it */
};

static int compare_links(const void *a, const void *b)
{
    const struct tissue_link *x = a, *y = b;
    if (x->from != y->from)
        return x->from < y->from ? -1 : 1;
    return (x->to > y->to) - (x->to < y->to);
}

/* Both ways of the edge that is across corner k of a triangle. Returns a third of the triangle's area. */
static double link_across(const struct tissue *tissue, const uint32_t *corners, uint32_t k, struct tissue_link *links)
{
    const uint32_t a = corners[(k + 1) % 3], b = corners[(k + 2) % 3];
    double u[3], v[3];
    for (int i = 0; i < 3; i++) {
        const float tip = tissue->rest[3 * (size_t)corners[k] + (size_t)i];
        u[i] = (double)(tissue->rest[3 * (size_t)a + (size_t)i] - tip);
        v[i] = (double)(tissue->rest[3 * (size_t)b + (size_t)i] - tip);
    }
    const double twice = length(cross(vec3_of(u), vec3_of(v)));
    const double weight = twice > 0.0 ? 0.5 * vec3_dot(u, v) / twice : 0.0;
    links[0] = (struct tissue_link){ a, b, 1, weight };
    links[1] = (struct tissue_link){ b, a, 1, weight };
    return twice / 6.0;
}

/* Sort, and add up what two triangles gave to the same edge. Vertices of edges with one triangle are fixed. */
static void merge_links(struct tissue *tissue, size_t given)
{
    struct tissue_link *links = tissue->links;
    size_t kept = 0;
    qsort(links, given, sizeof *links, compare_links);
    for (size_t i = 0; i < given; i++) {
        if (kept && !compare_links(&links[kept - 1], &links[i])) {
            links[kept - 1].weight += links[i].weight;
            links[kept - 1].triangles++;
        } else {
            links[kept++] = links[i];
        }
    }
    for (size_t i = 0, v = 0; v <= tissue->vertices; v++) {
        while (i < kept && links[i].from < v)
            i++;
        tissue->first[v] = (uint32_t)i;
    }
    for (size_t i = 0; i < kept; i++) {
        tissue->pull[links[i].from] += links[i].weight;
        if (links[i].triangles == 1)
            tissue->is_fixed[links[i].from] = tissue->is_fixed[links[i].to] = 1;
    }
}

static int make_net(struct tissue *tissue)
{
    const uint32_t *corners;
    uint32_t triangles;
    dpt_mesh_get_triangles(tissue->mesh, &corners, NULL, &triangles);
    dpt_mesh_get_vertices(tissue->mesh, &tissue->rest, &tissue->vertices);
    const size_t n = tissue->vertices, given = 6 * (size_t)triangles;
    tissue->links = malloc(given * sizeof *tissue->links);
    tissue->first = malloc((n + 1) * sizeof *tissue->first);
    tissue->is_fixed = calloc(n, 1);
    tissue->area = calloc(n, sizeof *tissue->area);
    tissue->pull = calloc(n, sizeof *tissue->pull);
    tissue->off = calloc(3 * n, sizeof *tissue->off);
    tissue->speed = calloc(3 * n, sizeof *tissue->speed);
    tissue->load = calloc(3 * n, sizeof *tissue->load);
    tissue->kept = malloc(6 * n * sizeof *tissue->kept);
    tissue->positions = malloc(3 * n * sizeof *tissue->positions);
    tissue->ahead = malloc(3 * n * sizeof *tissue->ahead);
    tissue->answered = malloc(LOADS_MAX * sizeof *tissue->answered);
    tissue->last_positions = malloc(3 * n * sizeof *tissue->last_positions);
    tissue->answers = calloc(n, sizeof *tissue->answers);
    tissue->loads = malloc(LOADS_MAX * sizeof *tissue->loads);
    tissue->last = malloc(LOADS_MAX * sizeof *tissue->last);
    int is_made = tissue->links && tissue->first && tissue->is_fixed && tissue->area && tissue->pull && tissue->off &&
                  tissue->speed && tissue->load && tissue->positions && tissue->loads && tissue->last &&
                  tissue->last_positions && tissue->answers && tissue->kept && tissue->ahead && tissue->answered;
    for (size_t i = 0; i < sizeof tissue->scratch / sizeof *tissue->scratch; i++) {
        tissue->scratch[i] = calloc(3 * n, sizeof **tissue->scratch);
        is_made = is_made && tissue->scratch[i];
    }
    for (size_t t = 0; is_made && t < triangles; t++)
        for (uint32_t k = 0; k < 3; k++)
            tissue->area[corners[3 * t + k]] +=
                link_across(tissue, corners + 3 * t, k, tissue->links + 6 * t + 2 * (size_t)k);
    if (is_made)
        merge_links(tissue, given);
    return is_made;
}

/* How far a newton on a vertex would move it in a step if the others stood still. */
static void tell_compliances(struct tissue *tissue)
{
    const struct tissue_matter *matter = &tissue->matter;
    const double h = tissue_period(tissue),
                 per_area = matter->mass / (h * h) + matter->damping / h + matter->foundation;
    for (size_t v = 0; v < tissue->vertices; v++)
        tissue->answers[v] =
            tissue->is_fixed[v]
                ? 0.0f
                : (float)(tissue->compliance / (per_area * tissue->area[v] + matter->tension * tissue->pull[v]));
}

int tissue_open(struct tissue *tissue, dpt_world *world)
{
    dpt_deformable_def def;
    dpt_deformable_def_init(&def);
    def.mesh = tissue->mesh;
    def.period = tissue->is_interpolated ? tissue_period(tissue) : 0.0;
    def.load_radius = tissue->load_radius;
    def.response = tissue->response;
    def.compliance = tissue->compliance;
    tissue->world = world;
    if (!make_net(tissue))
        return 0;
    tell_compliances(tissue);
    def.compliances = tissue->answers;
    tissue->block = malloc(dpt_deformable_bytes(&def));
    return tissue->block &&
           dpt_body_add_deformable(world, tissue->block, dpt_deformable_bytes(&def), &def, &tissue->body) == DPT_OK;
}

void tissue_close(struct tissue *tissue)
{
    for (size_t i = 0; i < sizeof tissue->scratch / sizeof *tissue->scratch; i++)
        free(tissue->scratch[i]);
    free(tissue->links);
    free(tissue->first);
    free(tissue->is_fixed);
    free(tissue->area);
    free(tissue->pull);
    free(tissue->off);
    free(tissue->speed);
    free(tissue->load);
    free(tissue->kept);
    free(tissue->positions);
    free(tissue->ahead);
    free(tissue->answered);
    free(tissue->answers);
    free(tissue->loads);
    free(tissue->last);
    free(tissue->last_positions);
    free(tissue->block);
}

/* out = the springs' forces against x, and `inertia` times each vertex's area besides; 0 at fixed vertices. */
static void resist(const struct tissue *tissue, const double *x, double inertia, double *out)
{
    for (size_t v = 0; v < tissue->vertices; v++) {
        const double own = (inertia + tissue->matter.foundation) * tissue->area[v];
        double pull[3] = { 0.0, 0.0, 0.0 };
        for (uint32_t i = tissue->first[v]; i < tissue->first[v + 1]; i++) {
            const struct tissue_link *link = &tissue->links[i];
            for (size_t k = 0; k < 3; k++)
                pull[k] += link->weight * (x[3 * v + k] - x[3 * (size_t)link->to + k]);
        }
        for (size_t k = 0; k < 3; k++)
            out[3 * v + k] = tissue->is_fixed[v] ? 0.0 : own * x[3 * v + k] + tissue->matter.tension * pull[k];
    }
}

/* The direction of steepest descent, by each vertex's own stiffness. Returns left * direction. */
static double condition(const struct tissue *tissue, double inertia, const double *left, double *direction)
{
    double sum = 0.0;
    for (size_t v = 0; v < tissue->vertices; v++) {
        const double own =
            (inertia + tissue->matter.foundation) * tissue->area[v] + tissue->matter.tension * tissue->pull[v];
        for (size_t i = 3 * v; i < 3 * v + 3; i++) {
            direction[i] = left[i] / own;
            sum += left[i] * direction[i];
        }
    }
    return sum;
}

/* Solve resist(x) = right, from what x is on. */
static void solve(struct tissue *tissue, double inertia, const double *right, double *x)
{
    const size_t n = 3 * (size_t)tissue->vertices;
    double *left = tissue->scratch[0], *direction = tissue->scratch[1], *push = tissue->scratch[2];
    double *steepest = tissue->scratch[5];
    const double enough = LEFT * LEFT * condition(tissue, inertia, right, steepest);
    resist(tissue, x, inertia, push);
    for (size_t i = 0; i < n; i++)
        left[i] = right[i] - push[i];
    double size = condition(tissue, inertia, left, direction);
    for (int sweep = 0; sweep < SWEEPS_MAX && size > enough; sweep++) {
        double along = 0.0;
        resist(tissue, direction, inertia, push);
        for (size_t i = 0; i < n; i++)
            along += direction[i] * push[i];
        const double step = size / along;
        for (size_t i = 0; i < n; i++) {
            x[i] += step * direction[i];
            left[i] -= step * push[i];
        }
        const double left_size = condition(tissue, inertia, left, steepest), turn = left_size / size;
        for (size_t i = 0; i < n; i++)
            direction[i] = steepest[i] + turn * direction[i];
        size = left_size;
    }
}

/* Where the springs' other ends are at a time: m from the mesh. */
static void beat_at(const struct tissue *tissue, double time, double *ends)
{
    const struct tissue_beat *beat = &tissue->beat;
    double sine, cosine;
    turn_sincos(beat->rate * time, &sine, &cosine);
    const double height = 0.5 * beat->travel * (1.0 - cosine);
    for (size_t v = 0; v < tissue->vertices; v++) {
        double ratio = 0.0;
        for (size_t k = 0; k < 3 && height > 0.0; k++) {
            const double away = (double)tissue->rest[3 * v + k] - beat->at[k];
            ratio += away * away / (beat->reach * beat->reach);
        }
        const double share = ratio < 1.0 ? (1.0 - ratio) * (1.0 - ratio) : 0.0;
        for (size_t k = 0; k < 3; k++)
            ends[3 * v + k] = height > 0.0 ? height * share * beat->out[k] : 0.0;
    }
}

static void take_loads(struct tissue *tissue)
{
    double seconds;
    memset(tissue->load, 0, 3 * sizeof *tissue->load * (size_t)tissue->vertices);
    tissue->answered_count = 0;
    const dpt_result result =
        tissue->compliance > 0.0
            ? dpt_body_get_mean_loads(tissue->world, tissue->body, tissue->answered, LOADS_MAX, &tissue->answered_count,
                                      &seconds)
            : dpt_body_get_loads(tissue->world, tissue->body, tissue->answered, LOADS_MAX, &tissue->answered_count);
    if (result != DPT_OK) {
        tissue->has_failed = 1;
        return;
    }
    for (uint32_t i = 0; i < tissue->answered_count; i++)
        for (size_t k = 0; k < 3; k++)
            tissue->load[3 * (size_t)tissue->answered[i].vertex + k] += tissue->answered[i].force[k];
}

/* Physics goes on from where the tool put the vertices. */
static void take_positions(struct tissue *tissue)
{
    const float *positions;
    uint32_t count;
    dpt_body_get_vertices(tissue->world, tissue->body, &positions, &count);
    for (size_t i = 0; i < 3 * (size_t)count; i++)
        tissue->off[i] = (double)positions[i] - (double)tissue->rest[i];
}

static void find_positions(const struct tissue *tissue, float *positions)
{
    for (size_t i = 0; i < 3 * (size_t)tissue->vertices; i++)
        positions[i] = (float)((double)tissue->rest[i] + tissue->off[i]);
}

/* The answer, and the loads that it holds. */
static void hand_over(struct tissue *tissue)
{
    dpt_world *world = tissue->world;
    const int answers = tissue->compliance > 0.0 && tissue->matter.foundation > 0.0 && !tissue->is_led;
    dpt_result result =
        answers ? dpt_body_set_answered_loads(world, tissue->body, tissue->answered, tissue->answered_count) : DPT_OK;
    if (result == DPT_OK)
        result = dpt_body_set_vertices(world, tissue->body, 0, tissue->vertices, tissue->positions, -1.0);
    if (result == DPT_OK && tissue->foresees)
        result = dpt_body_set_foreseen_vertices(world, tissue->body, 0, tissue->vertices, tissue->ahead);
    tissue->has_failed |= result != DPT_OK;
    tissue->is_pending = 0;
}

/* Implicit Euler: mass and damping against the motion of this step, springs where it ends. */
static void give_way(struct tissue *tissue, double time)
{
    const struct tissue_matter *matter = &tissue->matter;
    const double h = tissue_period(tissue), n = matter->mass / (h * h), c = matter->damping / h;
    double *right = tissue->scratch[3], *next = tissue->scratch[4], *ends = tissue->scratch[2];
    double *before = tissue->scratch[1];
    beat_at(tissue, time, ends);
    resist(tissue, ends, c, right);
    beat_at(tissue, time - h, before);
    for (size_t v = 0; v < tissue->vertices; v++)
        for (size_t i = 3 * v; i < 3 * v + 3; i++) {
            const double inert = (n + c) * tissue->off[i] + n * h * tissue->speed[i] - c * before[i];
            right[i] = tissue->is_fixed[v] ? 0.0 : right[i] + tissue->area[v] * inert + tissue->load[i];
            next[i] = tissue->is_fixed[v] ? 0.0 : tissue->off[i] + h * tissue->speed[i];
        }
    solve(tissue, n + c, right, next);
    for (size_t i = 0; i < 3 * (size_t)tissue->vertices; i++) {
        tissue->speed[i] = (next[i] - tissue->off[i]) / h;
        tissue->off[i] = next[i];
    }
}

/* A step with the same loads, and back. */
static void look_ahead(struct tissue *tissue, double time)
{
    const size_t n = 3 * (size_t)tissue->vertices, bytes = n * sizeof *tissue->kept;
    memcpy(tissue->kept, tissue->off, bytes);
    memcpy(tissue->kept + n, tissue->speed, bytes);
    give_way(tissue, time);
    find_positions(tissue, tissue->ahead);
    memcpy(tissue->off, tissue->kept, bytes);
    memcpy(tissue->speed, tissue->kept + n, bytes);
}

void tissue_advance(struct tissue *tissue)
{
    const uint64_t tick = tissue->tick;
    if (tissue->is_held)
        return;
    tissue->tick++;
    if (tissue->is_pending && tick == tissue->due)
        hand_over(tissue);
    if (tick % tissue->ticks)
        return;
    const double time = TISSUE_TICK * (double)tick;
    if (tissue->matter.foundation > 0.0) {
        if (tissue->response == DPT_RESPONSE_DISPLACE)
            take_positions(tissue);
        if (!tissue->is_led)
            take_loads(tissue);
        give_way(tissue, time);
    } else {
        beat_at(tissue, time, tissue->off);
    }
    find_positions(tissue, tissue->positions);
    if (tissue->foresees)
        look_ahead(tissue, time + tissue_period(tissue));
    tissue->steps++;
    tissue->is_pending = !tissue->drops || tissue->steps % tissue->drops;
    tissue->due = tick + tissue->late;
    if (tissue->is_pending && !tissue->late)
        hand_over(tissue);
}

void tissue_yield(struct tissue *tissue)
{
    if (tissue->compliance > 0.0 &&
        dpt_body_step_springs(tissue->world, tissue->body, NULL, TISSUE_TICK, NULL) != DPT_OK)
        tissue->has_failed = 1;
}

static double work_of(const dpt_load *loads, uint32_t count, const float *before, const float *now)
{
    double sum = 0.0;
    for (uint32_t i = 0; i < count; i++)
        for (size_t k = 0; k < 3; k++) {
            const size_t at = 3 * (size_t)loads[i].vertex + k;
            sum += loads[i].force[k] * ((double)now[at] - (double)before[at]);
        }
    return sum;
}

double tissue_work(struct tissue *tissue)
{
    const float *now;
    uint32_t count, vertices;
    double work = 0.0;
    dpt_body_get_vertices(tissue->world, tissue->body, &now, &vertices);
    if (dpt_body_get_loads(tissue->world, tissue->body, tissue->loads, LOADS_MAX, &count) != DPT_OK)
        return NAN;
    /* Loads act on the tissue; between two steps they are the mean of both. */
    if (tissue->is_watched)
        work = -0.5 * (work_of(tissue->last, tissue->last_count, tissue->last_positions, now) +
                       work_of(tissue->loads, count, tissue->last_positions, now));
    tissue->is_watched = 1;
    tissue->last_count = count;
    memcpy(tissue->last, tissue->loads, count * sizeof *tissue->last);
    memcpy(tissue->last_positions, now, 3 * sizeof *now * (size_t)vertices);
    return work;
}

void tissue_move(struct tissue *tissue, uint32_t vertex, const double by[3])
{
    for (size_t k = 0; k < 3; k++)
        tissue->off[3 * (size_t)vertex + k] += by[k];
}

void tissue_rest(struct tissue *tissue)
{
    const size_t n = 3 * (size_t)tissue->vertices;
    memset(tissue->off, 0, n * sizeof *tissue->off);
    memset(tissue->speed, 0, n * sizeof *tissue->speed);
    tissue->tick = 0;
    tissue->is_watched = tissue->is_pending = 0;
    find_positions(tissue, tissue->positions);
    if (dpt_body_set_vertices(tissue->world, tissue->body, 0, tissue->vertices, tissue->positions, -1.0) != DPT_OK)
        tissue->has_failed = 1;
}
