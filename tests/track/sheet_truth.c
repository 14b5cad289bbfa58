/* SPDX-License-Identifier: BSD-3-Clause */
#include "track/sheet_truth.h"

dpt_pose pose_between(const dpt_pose *from, const dpt_pose *to, double t)
{
    dpt_pose at;
    double half = 0.5 * pose_angle(from, to), same = 0.0;
    for (int k = 0; k < 3; k++)
        at.position[k] = (1.0 - t) * from->position[k] + t * to->position[k];
    for (int k = 0; k < 4; k++)
        same += from->orientation[k] * to->orientation[k];
    double p = half > 1e-9 ? sin((1.0 - t) * half) / sin(half) : 1.0 - t;
    double q = half > 1e-9 ? sin(t * half) / sin(half) : t, size = 0.0;
    for (int k = 0; k < 4; k++) {
        at.orientation[k] = p * from->orientation[k] + (same < 0.0 ? -q : q) * to->orientation[k];
        size += at.orientation[k] * at.orientation[k];
    }
    for (int k = 0; k < 4; k++)
        at.orientation[k] /= sqrt(size);
    return at;
}

struct ends3 ends_between(const struct state *from, const struct state *to, double t)
{
    struct ends3 at;
    const dpt_pose tool = pose_between(&from->tool, &to->tool, t);
    const dpt_pose body = pose_between(&from->body, &to->body, t);
    for (int e = 0; e < 2; e++) {
        double x[3];
        for (int k = 0; k < 3; k++)
            x[k] = (1.0 - t) * from->end[e][k] + t * to->end[e][k];
        if (!to->free)
            pose_point(&tool, x, x);
        pose_local(&body, x, at.end[e]);
    }
    return at;
}

double most_speed(const struct state *from, const struct state *to)
{
    double most = 0.0, turn = pose_angle(&from->body, &to->body);
    for (int e = 0; e < 2; e++) {
        double speed = to->free ? apart(from->end[e], to->end[e])
                                : apart(from->tool.position, to->tool.position) +
                                      pose_angle(&from->tool, &to->tool) * length3(to->end[e]);
        double x[3], far;
        memcpy(x, from->end[e], sizeof x);
        if (!to->free)
            pose_point(&from->tool, x, x);
        speed += apart(from->body.position, to->body.position);
        far = apart(x, from->body.position) + speed;
        most = fmax(most, speed + turn * far);
    }
    return most;
}

static int edge_order(const void *a, const void *b)
{
    return memcmp(a, b, 6 * sizeof(double));
}

/* Edges that only one triangle has; corners at one place are one. */
static int sheet_borders(struct sheet *sheet)
{
    size_t count = 3 * (size_t)sheet->count;
    double *edges = malloc(6 * count * sizeof *edges);
    sheet->border = malloc(9 * (sheet->info.open_edges + 1) * sizeof *sheet->border);
    for (size_t i = 0; edges && i < count; i++) {
        const double *c = sheet->corners + 9 * (i / 3);
        const double *a = c + 3 * (i % 3), *b = c + 3 * ((i + 1) % 3);
        int swap = memcmp(a, b, 3 * sizeof *a) > 0;
        memcpy(edges + 6 * i, swap ? b : a, 3 * sizeof *a);
        memcpy(edges + 6 * i + 3, swap ? a : b, 3 * sizeof *a);
    }
    if (edges)
        qsort(edges, count, 6 * sizeof *edges, edge_order);
    for (size_t i = 0; edges && sheet->border && i < count; i++) {
        const double *e = edges + 6 * i;
        if ((i && !edge_order(e - 6, e)) || (i + 1 < count && !edge_order(e, e + 6)) ||
            sheet->borders == sheet->info.open_edges)
            continue;
        double *to = sheet->border + 9 * (size_t)sheet->borders++;
        memcpy(to, e, 6 * sizeof *e);
        memcpy(to + 6, e + 3, 3 * sizeof *e);
    }
    CHECK(sheet->borders == sheet->info.open_edges, "%s: %u open edges, not %u", sheet->name, sheet->borders,
          sheet->info.open_edges);
    free(edges);
    sheet->edgy = calloc(sheet->count, 1);
    for (size_t i = 0; sheet->edgy && i < count; i++)
        for (uint32_t k = 0; k < sheet->borders; k++)
            if (!memcmp(sheet->corners + 3 * i, sheet->border + 9 * (size_t)k, 3 * sizeof(double)) ||
                !memcmp(sheet->corners + 3 * i, sheet->border + 9 * (size_t)k + 3, 3 * sizeof(double)))
                sheet->edgy[i / 3] = 1;
    return sheet->border != NULL && sheet->edgy != NULL;
}

int sheet_of(struct sheet *sheet, const char *name)
{
    sheet->name = name;
    sheet->search_steps = 300;
    sheet->info.size = sizeof sheet->info;
    dpt_mesh_get_info(sheet->fixture.mesh, &sheet->info);
    size_t room = sheet->info.triangles;
    sheet->corners = malloc(9 * room * sizeof *sheet->corners);
    sheet->balls = malloc(4 * room * sizeof *sheet->balls);
    sheet->numbers = malloc(room * sizeof *sheet->numbers);
    sheet->near = malloc(48 * room * sizeof *sheet->near);
    sheet->count = 0;
    if (!sheet->corners || !sheet->balls || !sheet->numbers || !sheet->near)
        return 0;
    for (uint32_t t = 0; t < sheet->info.source_triangles && sheet->count < room; t++) {
        double *c = sheet->corners + 9 * (size_t)sheet->count;
        double *ball = sheet->balls + 4 * (size_t)sheet->count;
        if (dpt_mesh_get_triangle(sheet->fixture.mesh, t, c) != DPT_OK)
            continue;
        for (int k = 0; k < 3; k++)
            ball[k] = (c[k] + c[3 + k] + c[6 + k]) / 3.0;
        ball[3] = fmax(apart(ball, c), fmax(apart(ball, c + 3), apart(ball, c + 6)));
        sheet->numbers[sheet->count++] = t;
    }
    sheet->diagonal = apart(sheet->info.box_min, sheet->info.box_max);
    sheet->unit = sheet->diagonal / 0.3;
    return sheet->count > 0 && sheet_borders(sheet);
}

int sheet_from_file(struct sheet *sheet, const char *path, const char *name)
{
    dpt_diag diag = { .size = sizeof diag };
    memset(sheet, 0, sizeof *sheet);
    if (dpt_compile_file(path, NULL, &sheet->fixture.compiled, &diag) != DPT_OK)
        return 0;
    dpt_result result =
        dpt_mesh_open(sheet->fixture.compiled.bytes, sheet->fixture.compiled.size, &sheet->fixture.mesh);
    CHECK(result == DPT_OK, "%s: %s", path, dpt_result_name(result));
    return result == DPT_OK && sheet_of(sheet, name);
}

void sheet_free(struct sheet *sheet)
{
    fixture_free(&sheet->fixture);
    free(sheet->corners);
    free(sheet->balls);
    free(sheet->numbers);
    free(sheet->near);
    free(sheet->border);
    free(sheet->edgy);
    memset(sheet, 0, sizeof *sheet);
}

static double axis_to_point(const struct ends3 *axis, const double x[3])
{
    double u[3], w[3];
    add_scaled(u, axis->end[1], -1.0, axis->end[0]);
    add_scaled(w, x, -1.0, axis->end[0]);
    double uu = dot3(u, u), s = uu > 0.0 ? dot3(u, w) / uu : 0.0;
    add_scaled(w, w, -fmin(1.0, fmax(0.0, s)), u);
    return length3(w);
}

uint32_t near_axis(const struct sheet *sheet, const struct ends3 *axis, double reach)
{
    uint32_t count = 0;
    for (uint32_t t = 0; t < sheet->count; t++) {
        const double *ball = sheet->balls + 4 * (size_t)t;
        if (axis_to_point(axis, ball) <= (reach + ball[3]) * (1.0 + 1e-12))
            sheet->near[count++] = t;
    }
    return count;
}

struct close closest(const struct sheet *sheet, const uint32_t *list, uint32_t count, const struct ends3 *axis)
{
    struct close best = { .distance = HUGE_VAL, .triangle = 0 };
    for (uint32_t i = 0; i < count; i++) {
        double s, d = to_triangle(axis, sheet->corners + 9 * (size_t)list[i], &s, NULL);
        if (d < best.distance)
            best = (struct close){ d, s, list[i] };
    }
    return best;
}

struct close closest_of_all(const struct sheet *sheet, const struct ends3 *axis)
{
    double least = HUGE_VAL;
    for (uint32_t t = 0; t < sheet->count; t++) {
        const double *ball = sheet->balls + 4 * (size_t)t;
        least = fmin(least, axis_to_point(axis, ball) + ball[3]);
    }
    return closest(sheet, sheet->near, near_axis(sheet, axis, least), axis);
}

/* A point of the axis gets from one side of a near triangle to the other within this short time. */
static int passes(const struct sheet *sheet, const uint32_t *list, uint32_t count, const struct ends3 *from,
                  const struct ends3 *to, double s)
{
    struct ends3 way;
    axis_point(way.end[0], from, s);
    axis_point(way.end[1], to, s);
    return closest(sheet, list, count, &way).distance == 0.0;
}

/* The search for the first touch in one motion. */
struct touch_search {
    const struct sheet *sheet;
    const struct state *from, *to;
    double radius, speed, eps;
    struct truth truth;
    int steps_left;
    int begun; /* truth.clear is known */
};

/* From a time within `eps` of a touch on: a proof that it is one, nearer than the radius or passed by. */
static int prove_touch(struct touch_search *search, const uint32_t *list, uint32_t count, double t)
{
    const struct sheet *sheet = search->sheet;
    struct truth *truth = &search->truth;
    double span = search->eps / search->speed, radius = search->radius;
    struct ends3 at = ends_between(search->from, search->to, t), before = at;
    struct close close = closest(sheet, list, count, &at);
    if (!search->begun) {
        search->begun = truth->sure = 1;
        truth->clear = t;
        truth->triangle = close.triangle;
        truth->s = close.s;
    }
    truth->met = truth->met == TRUTH_MET ? TRUTH_MET : TRUTH_NEAR;
    for (int k = 0; k < 8; k++, span *= 2.0) {
        int met = radius == 0.0 ? close.distance == 0.0 : close.distance - radius < -1e-3 * search->eps;
        for (int i = 0; i < 4 && k && !met && radius == 0.0; i++)
            met = passes(sheet, list, count, &before, &at, i < 2 ? i : i == 2 ? truth->s : close.s);
        if (met) {
            truth->by = truth->met == TRUTH_MET ? fmin(t, truth->by) : t;
            truth->met = TRUTH_MET;
            return 1;
        }
        if (t >= 1.0 || close.distance - radius > 16.0 * search->eps)
            return 0;
        t = fmin(1.0, t + span);
        before = at;
        at = ends_between(search->from, search->to, t);
        close = closest(sheet, list, count, &at);
    }
    return 0;
}

/*
 * What may be within the radius at any time from t0 to t1 is so near at the middle; half and half, until that is
 * nothing or within `eps`. Returns 1 when the first touch is found or the steps are used up.
 */
static int search_interval(struct touch_search *search, double t0, double t1, const uint32_t *list, uint32_t count,
                           uint32_t *room)
{
    double t = 0.5 * (t0 + t1), way = 0.5 * (t1 - t0) * search->speed;
    double reach = way + search->radius + search->eps;
    struct ends3 at = ends_between(search->from, search->to, t);
    uint32_t kept = 0;
    double nearest = HUGE_VAL;
    for (uint32_t i = 0; i < count; i++) {
        const double *ball = search->sheet->balls + 4 * (size_t)list[i];
        if (axis_to_point(&at, ball) > reach + ball[3])
            continue;
        if (reach > 2.0 * ball[3]) { /* it tells little */
            room[kept++] = list[i];
            continue;
        }
        double d = to_triangle(&at, search->sheet->corners + 9 * (size_t)list[i], NULL, NULL);
        nearest = fmin(nearest, d);
        if (d <= reach)
            room[kept++] = list[i];
    }
    if (!kept)
        return 0;
    if (nearest < (search->radius > 0.0 ? search->radius - 1e-3 * search->eps : 1e-300)) {
        search->truth.met = TRUTH_MET;
        search->truth.by = t;
    }
    if (search->steps_left-- <= 0) {
        if (!search->begun)
            search->truth.clear = t0;
        search->truth.met = search->truth.met == TRUTH_MET ? TRUTH_MET : TRUTH_UNDECIDED;
        return 1;
    }
    if (way <= 0.5 * search->eps)
        return prove_touch(search, room, kept, t0) || (search->truth.met == TRUTH_MET && search->truth.by <= t1);
    if (search_interval(search, t0, t, room, kept, room + kept))
        return 1;
    if (search->truth.met == TRUTH_MET && search->begun && search->truth.by <= t)
        return 1;
    return search_interval(search, t, t1, room, kept, room + kept);
}

struct truth truth_of(const struct sheet *sheet, const struct state *from, const struct state *to, double radius)
{
    struct touch_search search = { .sheet = sheet, .from = from, .to = to, .radius = radius };
    search.truth = (struct truth){ .met = TRUTH_CLEAR, .clear = 1.0, .by = 1.0 };
    search.speed = most_speed(from, to) * (1.0 + 1e-9) + 1e-300;
    search.eps = 1e-7 * sheet->diagonal;
    search.steps_left = sheet->search_steps;
    struct ends3 at = ends_between(from, to, 0.5);
    uint32_t count = near_axis(sheet, &at, 0.5 * search.speed + radius + search.eps);
    search_interval(&search, 0.0, 1.0, sheet->near, count, sheet->near + count);
    return search.truth;
}
