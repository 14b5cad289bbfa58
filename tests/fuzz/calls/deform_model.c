/* SPDX-License-Identifier: BSD-3-Clause */
#include "fuzz/calls/deform_model.h"

#include "fuzz/calls/rules.h"

/* Under the sanitizers nothing is behind a block, so that a read there ends the run too. */
#ifdef __SANITIZE_ADDRESS__
enum { PATTERN = 0xa5, BEFORE = 64, BEHIND = 0 };
#else
enum { PATTERN = 0xa5, BEFORE = 64, BEHIND = 64 };
#endif

enum { POINTS_MANY = 1000, LOADS_MAX = 4096 };

/* Of a way that is done in part, in m: float's rounding in each step. */
static const double ROUNDING = 1e-6;

/* Of the peak of the forces: what sums of loads may be off by. */
static const double BALANCE = 1e-9;

/* Of a triangle's longest side: heights below that. */
static const double THIN = 1e-3;

/* ---- blocks ---- */

void soft_takes_blocks(struct soft *soft, size_t room, size_t off, int count)
{
    soft->room = room;
    soft->offset = BEFORE + 8 * draw_below(8) + off;
    for (int i = 0; i < count; i++) {
        soft->block[i] = malloc(soft->offset + room + BEHIND);
        HOLDS(soft->block[i], "memory ran out");
        memset(soft->block[i], PATTERN, soft->offset + room + BEHIND);
        memset(soft_block(soft, i), i ? 0xff : 0x5c, room);
    }
}

void soft_is_gone(struct soft *soft)
{
    for (int i = 0; soft && i < 2; i++) {
        for (size_t k = 0; soft->block[i] && k < soft->offset; k++)
            HOLDS(soft->block[i][k] == PATTERN, "written before a body's block");
        for (int k = 0; soft->block[i] && k < BEHIND; k++)
            HOLDS(soft_block(soft, i)[soft->room + (size_t)k] == PATTERN, "written behind a body's block");
        free(soft->block[i]);
    }
    free(soft);
}

/* ---- where vertices are ---- */

/* As get_vertices tells it; every world of the scene says the same. */
static const float *told_positions(const struct scene *scene, const struct model_body *body)
{
    const float *told[2] = { NULL, NULL };
    uint32_t count = 0;
    EACH_WORLD(scene, i)
    {
        HOLDS(dpt_body_get_vertices(scene->world[i], body->id, &told[i], &count) == DPT_OK, "body %x has no vertices",
              body->id);
        HOLDS(count == body->subject->vertices, "%u vertices, and not %u", count, body->subject->vertices);
    }
    HOLDS(scene->world_count < 2 || !memcmp(told[0], told[1], 3 * sizeof(float) * count),
          "the twin's vertices are elsewhere");
    return told[0];
}

void soft_must_be_there(const struct scene *scene, const struct model_body *body)
{
    const float *told = told_positions(scene, body);
    for (uint32_t k = 0; k < 3 * body->subject->vertices; k++)
        HOLDS(told[k] == body->soft->now[k], "vertex %u, axis %u: %.9g, and not %.9g", k / 3, k % 3, (double)told[k],
              (double)body->soft->now[k]);
}

/* On its way for a time more. The model's own positions are those that are told, if they are near the way. */
static void go_on(const struct scene *scene, const struct model_body *body, double dt)
{
    struct soft *soft = body->soft;
    const float *told = told_positions(scene, body);
    soft->way += dt;
    const double left = soft->def.period - soft->way;
    const int arrives = left <= 1e-9 * dt;
    const double t = arrives ? 1.0 : soft->way / soft->def.period;
    for (uint32_t k = 0; k < 3 * body->subject->vertices; k++) {
        const double from = (double)soft->begin[k], to = (double)soft->end[k];
        HOLDS((arrives ? told[k] == soft->end[k] : fabs(from + t * (to - from) - (double)told[k]) <= ROUNDING) ||
                  soft->def.response == DPT_RESPONSE_DISPLACE,
              "vertex %u, axis %u: %.9g after %g of the way from %.9g to %.9g", k / 3, k % 3, (double)told[k], t, from,
              to);
    }
    soft->is_on_its_way = !arrives;
    if (soft->def.response != DPT_RESPONSE_DISPLACE)
        memcpy(soft->now, told, 3 * sizeof *told * body->subject->vertices);
}

/* A tool may have moved it out of the way, at the end of a step. */
static int may_be_displaced(const struct scene *scene, const struct model_body *body)
{
    int may = 0;
    for (uint32_t t = 0; t < scene->tool_count; t++)
        may |= !has_proxy(scene, scene->tool[t].law);
    return may && !body->unfelt && body->soft->def.response == DPT_RESPONSE_DISPLACE &&
           scene->def.strip == DPT_STRIP_KIND_SHADOW;
}

static void take_displaced(const struct scene *scene, const struct model_body *body)
{
    struct soft *soft = body->soft;
    const float *told = told_positions(scene, body);
    int has_moved = 0;
    for (uint32_t k = 0; k < 3 * body->subject->vertices; k++) {
        HOLDS(isfinite(told[k]), "vertex %u is displaced to %g", k / 3, (double)told[k]);
        has_moved |= told[k] != soft->now[k];
        HOLDS(told[k] >= soft->wall_low[k % 3] && told[k] <= soft->wall_high[k % 3],
              "vertex %u is displaced to %.9g, out of the box of %.9g to %.9g", k / 3, (double)told[k],
              (double)soft->wall_low[k % 3], (double)soft->wall_high[k % 3]);
    }
    if (!has_moved)
        return;
    met[MET_DISPLACED]++;
    soft->is_affine = 0;
    memcpy(soft->now, told, 3 * sizeof *told * body->subject->vertices);
}

void softs_have_stepped(struct scene *scene, double dt)
{
    for (uint32_t b = 0; b < scene->body_count; b++) {
        struct model_body *body = &scene->body[b];
        struct soft *soft = body->soft;
        if (!soft)
            continue;
        const int displaces = dt > 0.0 && may_be_displaced(scene, body);
        const int moves = dt > 0.0 && soft->is_on_its_way;
        if (moves)
            go_on(scene, body, dt);
        for (uint32_t i = 0; i < scene->then_count && dt > 0.0; i++)
            if (scene->then[i].id == body->id) {
                float *positions = scene->then_positions[i];
                memcpy(positions, soft->now, 3 * sizeof *positions * body->subject->vertices);
                scene->then[i].positions = positions;
                scene->then[i].is_affine = soft->is_affine;
                scene->then[i].is_vague = moves && soft->def.response == DPT_RESPONSE_DISPLACE;
            }
        if (displaces || (moves && soft->def.response == DPT_RESPONSE_DISPLACE))
            take_displaced(scene, body);
        else
            soft_must_be_there(scene, body);
    }
}

/* ---- triangles ---- */

static int corners_of(const struct subject *subject, const float *positions, uint32_t triangle, double corners[9])
{
    if (!positions)
        return dpt_mesh_get_triangle(subject->mesh, triangle, corners) == DPT_OK;
    if (triangle >= subject->source_triangles || subject->place[triangle] >= subject->triangles)
        return 0;
    const uint32_t *vertex = subject->corners + 3 * (size_t)subject->place[triangle];
    for (int k = 0; k < 9; k++)
        corners[k] = (double)positions[3 * vertex[k / 3] + (uint32_t)k % 3];
    return 1;
}

int corners_now(const struct model_body *body, uint32_t triangle, double corners[9])
{
    return corners_of(body->subject, body->soft ? body->soft->now : NULL, triangle, corners);
}

int corners_then(const struct body_then *body, uint32_t triangle, double corners[9])
{
    return corners_of(body->subject, body->positions, triangle, corners);
}

int is_solid_then(const struct body_then *body)
{
    return body->subject->is_solid && (!body->positions || body->is_affine);
}

int all_are_known(const struct scene *scene)
{
    int known = 1;
    for (uint32_t i = 0; i < scene->then_count; i++)
        known &= !scene->then[i].is_vague;
    return known;
}

/* ---- loads ---- */

static void add_turned(const double at[3], const double force[3], double sum[6])
{
    for (int k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        sum[k] += force[k];
        sum[3 + k] += at[i] * force[j] - at[j] * force[i];
    }
}

/* All that tools could touch is deformable, and with few points one tool has not taken those of another. */
static int bodies_have_all_loads(struct scene *scene)
{
    int have = scene->then_count > 0 && all_are_known(scene);
    for (uint32_t i = 0; i < scene->then_count && have; i++) {
        const struct model_body *body = scene_body(scene, scene->then[i].id);
        have &= body && body->soft && (scene->tool_count == 1 || body->soft->def.max_points >= POINTS_MANY);
    }
    return have;
}

void loads_are_due(struct scene *scene)
{
    struct due_loads *due = &scene->due;
    *due = (struct due_loads){ .is_known = bodies_have_all_loads(scene) };
    for (uint32_t t = 0; t < scene->tool_count && due->is_known; t++) {
        const struct model_tool *tool = &scene->tool[t];
        dpt_force_info report = { .size = sizeof report };
        dpt_tool_get_force_info(scene->world[0], tool->id, &report);
        due->is_known &= tool->answers == ANSWERS_THERE && !tool->was_shaped &&
                         !(report.flags & DPT_FORCE_FLAG_FADING) &&
                         (tool->law_then != DPT_LAW_BED || scene->contacts_then < scene->def.max_contacts);
        /* A proxy on its way may be held by nothing where it is, and what a budget ends does not tell what holds it. */
        due->is_known &= !(has_proxy(scene, tool->law_then) && report.lag > 0.0) &&
                         ((!scene->def.budget && !scene->def.sweep_budget) || tool->law_then == DPT_LAW_POINT);
        add_turned(tool->origin, report.wrench.force, due->wrench);
        for (int k = 0; k < 3; k++)
            due->wrench[3 + k] += report.wrench.torque[k];
    }
}

static void each_load_must_hold(const struct scene *scene, const struct model_body *body, const dpt_load *loads,
                                uint32_t count)
{
    met[MET_LOADS] += count > 0;
    HOLDS(!scene->due.is_none || !count, "%u loads without a step", count);
    for (uint32_t i = 0; i < count; i++) {
        numbers_are_finite(loads[i].force, 3, "a load");
        HOLDS(loads[i].vertex < body->subject->vertices && !loads[i].reserved, "a load on vertex %u of %u",
              loads[i].vertex, body->subject->vertices);
    }
}

/* Vertices on a line, or at a point, can take no moment: bodies that have none so near to that count. */
static int has_thin_triangle(const struct body_then *then)
{
    double x[9], zero[3] = { 0.0, 0.0, 0.0 };
    for (uint32_t t = 0; t < then->subject->source_triangles; t++) {
        double normal[3], longest = 0.0;
        if (!corners_then(then, t, x))
            continue;
        for (int k = 0; k < 3; k++) {
            const int i = (k + 1) % 3, j = (k + 2) % 3;
            normal[k] = (x[3 + i] - x[i]) * (x[6 + j] - x[j]) - (x[3 + j] - x[j]) * (x[6 + i] - x[i]);
            longest = fmax(longest, apart(x + 3 * k, x + 3 * i));
        }
        if (!(apart(normal, zero) > THIN * longest * longest))
            return 1;
    }
    return 0;
}

/* What loads on a body come to, about the origin, as it was in the last step. */
struct load_sum {
    double wrench[6], peak, far;
    int is_thin; /* moments may be off */
};

static void add_loads(struct load_sum *sum, const struct body_then *then, const dpt_load *loads, uint32_t count)
{
    const double zero[3] = { 0.0, 0.0, 0.0 };
    dpt_pose turned = then->pose;
    memset(turned.position, 0, sizeof turned.position);
    sum->is_thin |= count > 0 && has_thin_triangle(then);
    for (uint32_t i = 0; i < count; i++) {
        double local[3], at[3], force[3];
        for (uint32_t k = 0; k < 3; k++)
            local[k] = (double)then->positions[3 * loads[i].vertex + k];
        to_world(&then->pose, local, at);
        to_world(&turned, loads[i].force, force);
        add_turned(at, force, sum->wrench);
        sum->peak = fmax(sum->peak, apart(force, zero));
        sum->far = fmax(sum->far, apart(at, zero));
    }
}

void loads_must_hold(const struct scene *scene)
{
    static dpt_load loads[LOADS_MAX];
    struct load_sum sum = { .peak = 0.0 };
    uint32_t all = 0, bodies = 0;
    for (uint32_t b = 0; b < scene->body_count; b++) {
        const struct model_body *body = &scene->body[b];
        const struct body_then *then = scene_body_then(scene, body->id);
        uint32_t count = 0;
        if (!body->soft || dpt_body_get_loads(scene->world[0], body->id, loads, LOADS_MAX, &count) != DPT_OK)
            continue;
        each_load_must_hold(scene, body, loads, count);
        all += count;
        bodies += then != NULL;
        if (then)
            add_loads(&sum, then, loads, count);
    }
    if (!scene->due.is_known || bodies < scene->then_count)
        return;
    const double *due = scene->due.wrench;
    const double size = fmax(sum.peak, fmax(fabs(due[0]), fmax(fabs(due[1]), fabs(due[2]))));
    met[MET_BALANCED] += all > 0;
    for (int k = 0; k < (sum.is_thin ? 3 : 6); k++)
        HOLDS(fabs(sum.wrench[k] + due[k]) <= BALANCE * (1.0 + sum.far) * size + 1e-12,
              "%u loads sum up to %.12g on axis %d, the wrench is %.12g", all, sum.wrench[k], k, due[k]);
}
