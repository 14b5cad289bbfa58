/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * An ear is a corner whose triangle with its two neighbours holds no other corner. Only corners that are not convex can
 * be in the way; they lie in a tree of boxes along a Z-order curve. Corners only become more convex when ears are cut,
 * and a corner that is no ear stays none until one of its neighbours is cut. So each corner is asked about three times.
 */
#include "compile/ear_cut.h"

#include <stdlib.h>
#include <string.h>

#include "base/angle.h"
#include "compile/compile_context.h"
#include "compile/exact_sign.h"

#define LEAF_CORNERS 8u

/*
 * What is in the way of an ear, and so not let pass. Where a polygon touches itself, corners lie on the edges of all
 * triangles that are left, or beyond them by rounding: then corners that turn clockwise by rounding are cut, and after them
 * more and more is let pass. Whatever it is, the triangles' windings prove the result.
 */
enum { BLOCKED_NEARBY, STRAIGHTENED, BLOCKED_ON_DIAGONAL, BLOCKED_WITHIN, BLOCKED_BY_NONE };

struct ear_corner {
    double at[2];
    uint32_t before, after;
    uint32_t leaf; /* the box that holds it; 0: none */
    uint8_t is_cut, is_queued;
};

struct ear_box {
    double low[2], high[2];
    uint32_t count; /* corners in it that may be in the way */
};

struct ear_place {
    uint64_t key; /* along the curve */
    uint32_t corner;
};

/* One polygon. */
struct ear_state {
    struct ear_corner *corners;
    struct ear_box *boxes; /* a heap: the root is 1, the children of k are 2 k and 2 k + 1 */
    struct ear_place *places;
    uint32_t *queue;
    uint32_t n, left, leaves; /* leaves: 0, or a power of two */
    uint32_t queue_first, queue_count;
    int level;
    int is_straighter; /* 1: a corner was cut at this level */
    double rounding;
    uint64_t work, work_max;
};

void ear_cutter_free(struct ear_cutter *cutter)
{
    free(cutter->corners);
    free(cutter->boxes);
    free(cutter->places);
    free(cutter->queue);
    memset(cutter, 0, sizeof *cutter);
}

static int reserve(void **array, size_t *capacity, size_t need, size_t item_size)
{
    if (need <= *capacity)
        return 1;
    void *bigger = grow_array(*array, capacity, need, item_size);
    if (bigger)
        *array = bigger;
    return bigger ? 1 : 0;
}

static int is_at(const struct ear_corner *a, const struct ear_corner *b)
{
    return a->at[0] == b->at[0] && a->at[1] == b->at[1];
}

static int turn_at(const struct ear_state *state, const struct ear_corner *corner)
{
    return turn_of(state->corners[corner->before].at, corner->at, state->corners[corner->after].at);
}

/* ---- the corners that may be in the way ---- */

/* Put a zero between the bits of 0..2^31 - 1. */
static uint64_t spread(uint64_t x)
{
    x = (x | x << 16) & 0x0000ffff0000ffffu;
    x = (x | x << 8) & 0x00ff00ff00ff00ffu;
    x = (x | x << 4) & 0x0f0f0f0f0f0f0f0fu;
    x = (x | x << 2) & 0x3333333333333333u;
    return (x | x << 1) & 0x5555555555555555u;
}

static int compare_places(const void *left, const void *right)
{
    const struct ear_place *a = left, *b = right;
    if (a->key != b->key)
        return a->key < b->key ? -1 : 1;
    return a->corner < b->corner ? -1 : a->corner > b->corner;
}

static void box_clear(struct ear_box *box)
{
    *box = (struct ear_box){ { HUGE_VAL, HUGE_VAL }, { -HUGE_VAL, -HUGE_VAL }, 0 };
}

static void box_join(struct ear_box *box, const double low[2], const double high[2], uint32_t count)
{
    for (int k = 0; k < 2; k++) {
        box->low[k] = min_of(box->low[k], low[k]);
        box->high[k] = max_of(box->high[k], high[k]);
    }
    box->count += count;
}

/* List the corners that are not convex, along the curve. */
static uint32_t sort_places(struct ear_state *state)
{
    struct ear_box all;
    uint32_t count = 0;
    box_clear(&all);
    for (uint32_t i = 0; i < state->n; i++)
        box_join(&all, state->corners[i].at, state->corners[i].at, 1);
    const double size = max_of(all.high[0] - all.low[0], all.high[1] - all.low[1]);
    const double scale = size > 0.0 ? 2147483647.0 / size : 0.0;
    for (uint32_t i = 0; i < state->n; i++) {
        const struct ear_corner *corner = &state->corners[i];
        if (turn_at(state, corner) > 0)
            continue;
        const uint64_t x = (uint64_t)(scale * (corner->at[0] - all.low[0]));
        const uint64_t y = (uint64_t)(scale * (corner->at[1] - all.low[1]));
        state->places[count++] = (struct ear_place){ spread(x) | spread(y) << 1, i };
    }
    qsort(state->places, count, sizeof *state->places, compare_places);
    return count;
}

static void make_boxes(struct ear_state *state, uint32_t count)
{
    for (uint32_t k = 1; k < 2 * state->leaves; k++)
        box_clear(&state->boxes[k]);
    for (uint32_t i = 0; i < count; i++) {
        struct ear_corner *corner = &state->corners[state->places[i].corner];
        corner->leaf = state->leaves + i / LEAF_CORNERS;
        box_join(&state->boxes[corner->leaf], corner->at, corner->at, 1);
    }
    for (uint32_t k = state->leaves; k-- > 1;)
        for (uint32_t child = 2 * k; child < 2 * k + 2; child++)
            box_join(&state->boxes[k], state->boxes[child].low, state->boxes[child].high, state->boxes[child].count);
}

/* A corner that is convex now, or cut, is in no ear's way any more. */
static void take_out(struct ear_state *state, struct ear_corner *corner)
{
    for (uint32_t k = corner->leaf; k > 0; k /= 2)
        state->boxes[k].count--;
    corner->leaf = 0;
}

/* Does the whole box lie outside of the edge from p to q of a triangle, by more than `slack`, for certain? */
static int edge_leaves_out(const double p[2], const double q[2], const double low[2], const double high[2],
                           double slack)
{
    const double dx = q[0] - p[0], dy = q[1] - p[1];
    const double a = dx * ((dx > 0.0 ? high[1] : low[1]) - p[1]), b = dy * ((dy > 0.0 ? low[0] : high[0]) - p[0]);
    return a - b < -slack * (fabs(dx) + fabs(dy)) - SIGN_ROUNDING * (fabs(a) + fabs(b));
}

static int box_is_outside(const double *const x[3], const double low[2], const double high[2], double slack)
{
    for (int k = 0; k < 2; k++)
        if (max_of(x[0][k], max_of(x[1][k], x[2][k])) + slack < low[k] ||
            min_of(x[0][k], min_of(x[1][k], x[2][k])) - slack > high[k])
            return 1;
    return edge_leaves_out(x[0], x[1], low, high, slack) || edge_leaves_out(x[1], x[2], low, high, slack) ||
           edge_leaves_out(x[2], x[0], low, high, slack);
}

/* How far outside of a triangle corners are in its way. */
static double slack_of(const struct ear_state *state)
{
    return state->level <= STRAIGHTENED ? state->rounding : 0.0;
}

/* Does the way from the ear's own place to `at` lead into it? */
static int leads_into(const double *const x[3], const double at[2])
{
    return turn_of(x[0], x[1], at) > 0 && turn_of(x[1], x[2], at) > 0;
}

/*
 * Is the corner in the way of the ear at x[1]? One at the place of a neighbour is not. One at the ear's own place is where
 * its edges cross the ear.
 */
static int is_in_the_way(const struct ear_state *state, const double *const x[3], const struct ear_corner *corner)
{
    const double *at = corner->at;
    if (at[0] == x[1][0] && at[1] == x[1][1])
        return leads_into(x, state->corners[corner->before].at) || leads_into(x, state->corners[corner->after].at);
    if ((at[0] == x[0][0] && at[1] == x[0][1]) || (at[0] == x[2][0] && at[1] == x[2][1]))
        return 0;
    if (state->level <= STRAIGHTENED)
        return !box_is_outside(x, at, at, state->rounding);
    return turn_of(x[0], x[1], at) > 0 && turn_of(x[1], x[2], at) > 0 &&
           turn_of(x[2], x[0], at) >= (state->level == BLOCKED_WITHIN);
}

static int leaf_blocks(struct ear_state *state, uint32_t leaf, const double *const x[3])
{
    const uint32_t first = (leaf - state->leaves) * LEAF_CORNERS;
    uint32_t left = state->boxes[leaf].count;
    for (uint32_t i = first; left > 0; i++) {
        const struct ear_corner *corner = &state->corners[state->places[i].corner];
        if (corner->leaf == 0)
            continue;
        left--;
        state->work++;
        if (is_in_the_way(state, x, corner))
            return 1;
    }
    return 0;
}

/* Is a corner in the way of this ear? */
static int is_blocked(struct ear_state *state, const double *const x[3])
{
    uint32_t stack[64], depth = 0; /* one for each level of a tree of at most 2^32 leaves */
    const double slack = slack_of(state);
    if (state->leaves)
        stack[depth++] = 1;
    while (depth) {
        const uint32_t k = stack[--depth];
        state->work++;
        const struct ear_box *box = &state->boxes[k];
        if (!box->count || box_is_outside(x, box->low, box->high, slack))
            continue;
        if (k >= state->leaves) {
            if (leaf_blocks(state, k, x))
                return 1;
        } else {
            stack[depth++] = 2 * k + 1;
            stack[depth++] = 2 * k;
        }
    }
    return 0;
}

/* ---- cutting ---- */

static void enqueue(struct ear_state *state, uint32_t corner)
{
    if (state->corners[corner].is_queued)
        return;
    state->corners[corner].is_queued = 1;
    state->queue[(state->queue_first + state->queue_count++) % state->n] = corner;
}

static uint32_t dequeue(struct ear_state *state)
{
    const uint32_t corner = state->queue[state->queue_first];
    state->queue_first = (state->queue_first + 1) % state->n;
    state->queue_count--;
    state->corners[corner].is_queued = 0;
    return corner;
}

/* Does the polygon turn back here, or stand still? Then nothing is lost without this corner. */
static int is_needless(const double *const x[3])
{
    const double in[2] = { x[1][0] - x[0][0], x[1][1] - x[0][1] }, out[2] = { x[2][0] - x[1][0], x[2][1] - x[1][1] };
    return !(in[0] * out[0] + in[1] * out[1] > 0.0);
}

/* Does it turn clockwise by no more than rounding may have moved its corners? */
static int is_nearly_straight(const struct ear_state *state, const double *const x[3])
{
    const double in[2] = { x[1][0] - x[0][0], x[1][1] - x[0][1] }, out[2] = { x[2][0] - x[1][0], x[2][1] - x[1][1] };
    const double size = fabs(in[0]) + fabs(in[1]) + fabs(out[0]) + fabs(out[1]);
    return in[0] * out[1] - in[1] * out[0] >= -state->rounding * size;
}

static int may_cut(struct ear_state *state, const struct ear_corner *corner)
{
    const double *const x[3] = { state->corners[corner->before].at, corner->at, state->corners[corner->after].at };
    const int turn = turn_of(x[0], x[1], x[2]);
    if (state->level == BLOCKED_BY_NONE)
        return turn >= 0 || is_nearly_straight(state, x);
    if (turn < 0)
        return state->level == STRAIGHTENED && is_nearly_straight(state, x);
    return turn > 0 ? !is_blocked(state, x) : is_needless(x);
}

static void cut(struct ear_state *state, uint32_t ear, uint32_t **triangle)
{
    struct ear_corner *corner = &state->corners[ear];
    const uint32_t sides[2] = { corner->before, corner->after };
    const uint32_t corners[3] = { sides[0], ear, sides[1] };
    memcpy(*triangle, corners, sizeof corners);
    *triangle += 3;
    corner->is_cut = 1;
    if (corner->leaf)
        take_out(state, corner);
    state->corners[sides[0]].after = sides[1];
    state->corners[sides[1]].before = sides[0];
    state->left--;
    for (int k = 0; k < 2; k++) {
        struct ear_corner *side = &state->corners[sides[k]];
        if (side->leaf && turn_at(state, side) > 0)
            take_out(state, side);
        enqueue(state, sides[k]);
    }
}

static void enqueue_all(struct ear_state *state)
{
    for (uint32_t i = 0; i < state->n; i++)
        if (!state->corners[i].is_cut)
            enqueue(state, i);
}

/* No ear is left: let more pass. Returns 0 if there is nothing more. */
static int try_again(struct ear_state *state)
{
    if (state->level == BLOCKED_BY_NONE)
        return 0;
    state->level = state->level == STRAIGHTENED && state->is_straighter ? BLOCKED_NEARBY : state->level + 1;
    state->is_straighter = 0;
    state->work += state->left;
    enqueue_all(state);
    return 1;
}

static enum ear_result cut_all(struct ear_state *state, uint32_t *triangle)
{
    enqueue_all(state);
    uint32_t last = 0;
    while (state->left > 3) {
        if (state->work > state->work_max)
            return EAR_TOO_LONG;
        if (!state->queue_count && !try_again(state))
            return EAR_CROSSING;
        const uint32_t ear = dequeue(state);
        if (state->corners[ear].is_cut || !may_cut(state, &state->corners[ear]))
            continue;
        last = state->corners[ear].after;
        cut(state, ear, &triangle);
        state->is_straighter = 1;
    }
    const struct ear_corner *corner = &state->corners[last];
    const uint32_t corners[3] = { corner->before, last, corner->after };
    memcpy(triangle, corners, sizeof corners);
    state->level = BLOCKED_BY_NONE;
    return may_cut(state, corner) ? EAR_DONE : EAR_CROSSING;
}

/* ---- the whole polygon ---- */

/*
 * Does it turn once in all? What winds about itself turns more often. Where it turns back, the turn is half of one, in
 * either direction.
 */
static int turns_once(const struct ear_state *state)
{
    double sum = 0.0, slack = 0.5;
    uint32_t first = 0;
    while (first < state->n && is_at(&state->corners[first], &state->corners[state->corners[first].after]))
        first++;
    if (first == state->n)
        return 1;
    const struct ear_corner *before = &state->corners[first];
    uint32_t here = before->after;
    for (uint32_t i = 0; i < state->n; i++) {
        const struct ear_corner *corner = &state->corners[here], *after = &state->corners[corner->after];
        here = corner->after;
        if (is_at(corner, after))
            continue;
        const vec3 in = { corner->at[0] - before->at[0], corner->at[1] - before->at[1], 0.0 };
        const vec3 out = { after->at[0] - corner->at[0], after->at[1] - corner->at[1], 0.0 };
        const int turn = turn_of(before->at, corner->at, after->at);
        if (turn != 0)
            sum += turn * angle_between(unit_of(in), unit_of(out));
        else if (dot(in, out) < 0.0)
            slack += 0.5 * ANGLE_TURN;
        before = corner;
    }
    return fabs(sum - ANGLE_TURN) <= slack;
}

/* Is the fan of the first corner right as it is? */
static int fan_fits(const double (*xy)[2], uint32_t n)
{
    for (uint32_t i = 1; i + 1 < n; i++)
        if (turn_of(xy[0], xy[i], xy[i + 1]) <= 0)
            return 0;
    return 1;
}

static void make_fan(uint32_t n, uint32_t *triangle)
{
    for (uint32_t i = 1; i + 1 < n; i++, triangle += 3) {
        triangle[0] = 0;
        triangle[1] = i;
        triangle[2] = i + 1;
    }
}

enum ear_result ear_cut(struct ear_cutter *cutter, const double (*xy)[2], uint32_t n, double rounding,
                        uint32_t *triangles)
{
    cutter->work = 0;
    if (!reserve((void **)&cutter->corners, &cutter->corner_capacity, n, sizeof *cutter->corners) ||
        !reserve((void **)&cutter->places, &cutter->place_capacity, n, sizeof *cutter->places) ||
        !reserve((void **)&cutter->queue, &cutter->queue_capacity, n, sizeof *cutter->queue))
        return EAR_NO_MEMORY;
    struct ear_state state = { .corners = cutter->corners,
                               .places = cutter->places,
                               .queue = cutter->queue,
                               .n = n,
                               .left = n,
                               .rounding = rounding,
                               .work_max = EAR_WORK_MIN + (uint64_t)EAR_WORK_PER_CORNER * n };
    for (uint32_t i = 0; i < n; i++)
        state.corners[i] = (struct ear_corner){ .at = { xy[i][0], xy[i][1] },
                                                .before = i > 0 ? i - 1 : n - 1,
                                                .after = i + 1 < n ? i + 1 : 0 };
    if (!turns_once(&state))
        return EAR_CROSSING;
    if (fan_fits(xy, n)) {
        make_fan(n, triangles);
        return EAR_DONE;
    }
    const uint32_t count = sort_places(&state);
    if (count > 0)
        for (state.leaves = 1; state.leaves * (uint64_t)LEAF_CORNERS < count;)
            state.leaves *= 2;
    if (!reserve((void **)&cutter->boxes, &cutter->box_capacity, 2 * (size_t)state.leaves, sizeof *cutter->boxes))
        return EAR_NO_MEMORY;
    state.boxes = cutter->boxes;
    make_boxes(&state, count);
    const enum ear_result result = cut_all(&state, triangles);
    cutter->work = state.work;
    return result;
}
