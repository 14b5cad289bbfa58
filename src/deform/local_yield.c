/* SPDX-License-Identifier: BSD-3-Clause */
#include "deform/local_yield.h"

#include <string.h>

#include "deform/deform_loads.h"
#include "mesh/mesh_format.h"

/* s: with this time the loads that count as answered follow those that positions hold the answer to. */
#define KNOWN_TIME 0.01

/* Of the comparisons of loads and motions, that much is left after an answer. */
#define ANSWERS_KEPT 0.9

/*
 * Where a step is foreseen: so many times as far as was found the body is taken to give way. A free mass under a hard
 * tool is held with 7/8 to 2 times of what is right, and soonest with that.
 */
#define FORESEEN_EXCESS 1.4

/* Of the loads: answers to a smaller change say nothing, as of physics that has fallen asleep. */
#define CHANGE_MIN 0.01

/* The body may give way so many times as far as it says. */
#define STRETCH_MIN 1e-3
#define STRETCH_MAX 1e3

/* So many vertices may give way at least: more than a solve has nodes. */
#define ROOM_MIN 2048u

/* N and m: less is nothing. */
#define NO_LOAD  1e-9
#define NO_YIELD 1e-10

struct yield_layout {
    size_t places, list, loads, moved, positions, bytes;
};

static struct yield_layout layout_of(const dpt_deformable_def *def, uint32_t vertices, uint32_t *capacity)
{
    const uint64_t loads = (uint64_t)LOAD_PATCH_MAX * def->max_points, most = loads > ROOM_MIN ? loads : ROOM_MIN;
    const uint64_t room = most < vertices ? most : vertices;
    struct yield_layout layout = { .places = 0 };
    *capacity = (uint32_t)room;
    layout.list = (size_t)mesh_aligned(sizeof(uint32_t) * (uint64_t)vertices);
    layout.loads = layout.list + (size_t)mesh_aligned(sizeof(struct yielding_vertex) * room);
    layout.moved = layout.loads + (size_t)mesh_aligned(sizeof(dpt_load) * loads);
    layout.positions = layout.moved + (size_t)mesh_aligned(sizeof(uint32_t) * room);
    layout.bytes = layout.positions + (size_t)mesh_aligned(3 * sizeof(float) * room);
    return layout;
}

size_t dpti_yield_bytes(const dpt_deformable_def *def, uint32_t vertices)
{
    uint32_t capacity;
    return layout_of(def, vertices, &capacity).bytes;
}

void dpti_yield_make(struct local_yield *yield, void *block, const dpt_deformable_def *def, uint32_t vertices,
                     const float *target)
{
    char *base = block;
    uint32_t capacity;
    const struct yield_layout layout = layout_of(def, vertices, &capacity);
    *yield = (struct local_yield){ .capacity = capacity,
                                   .vertex_count = vertices,
                                   .compliance = def->compliance,
                                   .compliances = def->compliances,
                                   .stretch = 1.0,
                                   .period = def->period,
                                   .part = 1.0,
                                   .target = target,
                                   .places = (void *)(base + layout.places),
                                   .list = (void *)(base + layout.list),
                                   .loads = (void *)(base + layout.loads),
                                   .load_room = LOAD_PATCH_MAX * def->max_points };
    yield->moved.list = (void *)(base + layout.moved);
    yield->moved.positions = (void *)(base + layout.positions);
    memset(yield->places, 0, sizeof *yield->places * (size_t)vertices);
}

void dpti_yield_forget_loads(struct local_yield *yield)
{
    yield->seconds = 0.0;
    for (uint32_t i = 0; i < yield->count; i++)
        yield->list[i].sum = (vec3){ 0.0, 0.0, 0.0 };
}

struct yielding_vertex *dpti_yield_of(struct local_yield *yield, uint32_t vertex, const float *position)
{
    if (yield->places[vertex])
        return &yield->list[yield->places[vertex] - 1];
    if (!position || yield->count == yield->capacity)
        return NULL;
    const vec3 at = vec3_of_float(position);
    struct yielding_vertex *of = &yield->list[yield->count];
    const vec3 bound_for = vec3_of_float(yield->target + 3 * (size_t)vertex);
    *of = (struct yielding_vertex){
        .vertex = vertex, .base = at, .last = { at, at }, .foreseen = bound_for, .reached = bound_for
    };
    yield->places[vertex] = ++yield->count;
    return of;
}

int dpti_yield_set_answered(struct local_yield *yield, const float *positions, const dpt_load *loads, uint32_t count)
{
    int has_room = 1;
    yield->has_arrived = 1;
    for (uint32_t i = 0; i < yield->count; i++)
        yield->list[i].answered = (vec3){ 0.0, 0.0, 0.0 };
    for (uint32_t i = 0; i < count; i++) {
        struct yielding_vertex *of = dpti_yield_of(yield, loads[i].vertex, positions + 3 * (size_t)loads[i].vertex);
        if (of)
            of->answered = add(of->answered, vec3_of(loads[i].force));
        has_room &= of != NULL;
    }
    return has_room;
}

void dpti_yield_note_reached(struct local_yield *yield)
{
    for (uint32_t i = 0; i < yield->count; i++)
        yield->list[i].reached = vec3_of_float(yield->target + 3 * (size_t)yield->list[i].vertex);
}

void dpti_yield_begin(struct local_yield *yield, double dt, uint32_t substeps)
{
    const double before = max_of(yield->seconds, yield->period), after = max_of(yield->seconds + dt, yield->period);
    yield->part = yield->is_foreseen ? dt / (after * (double)substeps) : 1.0;
    yield->held = yield->is_foreseen ? 1.0 - (1.0 - before / after) / (double)substeps : 0.0;
}

/* In a whole step of physics. */
static double whole_compliance(const struct local_yield *yield, uint32_t vertex)
{
    const double own = yield->compliances ? (double)yield->compliances[vertex] : yield->compliance;
    return own > 0.0 && own <= DPT_COMPLIANCE_MAX ? yield->stretch * own : 0.0;
}

double dpti_yield_compliance(const struct local_yield *yield, uint32_t vertex)
{
    return yield->part * whole_compliance(yield, vertex);
}

/* Whether the change of the loads does as much, as far as the body says, as to say anything. */
static int has_changed(const struct local_yield *yield)
{
    double all = 0.0, change = 0.0;
    for (uint32_t i = 0; i < yield->count; i++) {
        const struct yielding_vertex *of = &yield->list[i];
        const vec3 grown = sub(of->answered, of->bound);
        all += whole_compliance(yield, of->vertex) * dot(of->answered, of->answered);
        change += whole_compliance(yield, of->vertex) * dot(grown, grown);
    }
    return !(change < CHANGE_MIN * CHANGE_MIN * all);
}

/*
 * How far vertices go, compared with what the change of their loads should do; 1: nothing is known of that. Their motion is
 * right for it, or more than that, as it holds what goes on by itself: so it bounds a body that says too much. The change of
 * their motion is little where all goes smoothly, and right, or up to twice or half of that, where loads swing with the steps
 * of physics: so it finds a body that says too little, and that swings for it. Where their motion was foreseen, what is
 * beyond that is right.
 */
static double stretch_of(struct local_yield *yield)
{
    double *sums = yield->answers;
    for (uint32_t i = 0; i < yield->count; i++) {
        const struct yielding_vertex *of = &yield->list[i];
        const vec3 grown = sub(of->answered, of->bound), target = vec3_of_float(yield->target + 3 * (size_t)of->vertex);
        const vec3 moved = yield->is_foreseen ? sub(of->reached, of->foreseen) : sub(target, of->last[0]);
        sums[0] += whole_compliance(yield, of->vertex) * dot(grown, grown);
        sums[1] += dot(grown, moved);
        sums[2] += dot(grown, sub(moved, sub(of->last[0], of->last[1])));
    }
    if (!(sums[0] > 0.0))
        return 1.0;
    if (yield->is_foreseen)
        return FORESEEN_EXCESS * sums[1] / sums[0];
    const double most = sums[1] > 0.0 ? min_of(2.0 * sums[1] / sums[0], 1.0) : 1.0;
    return max_of(sums[2] / sums[0], most);
}

static void find_stretch(struct local_yield *yield)
{
    const double stretch = yield->stretch;
    yield->stretch = 1.0;
    if (!has_changed(yield)) {
        yield->stretch = stretch;
        return;
    }
    for (int k = 0; k < 3; k++)
        yield->answers[k] *= ANSWERS_KEPT;
    yield->stretch = min_of(max_of(stretch_of(yield), STRETCH_MIN), STRETCH_MAX);
}

/* What has given way is in the way to where physics foresees it. */
static void bind_foreseen(struct local_yield *yield)
{
    for (uint32_t i = 0; i < yield->count; i++) {
        struct yielding_vertex *of = &yield->list[i];
        of->contained = of->known = of->bound;
        of->base = add(of->base, of->yield);
        of->yield = of->before = (vec3){ 0.0, 0.0, 0.0 };
        of->foreseen = vec3_of_float(yield->target + 3 * (size_t)of->vertex);
    }
}

void dpti_yield_arrive(struct local_yield *yield)
{
    if (!yield->has_arrived)
        return;
    yield->has_arrived = 0;
    find_stretch(yield);
    for (uint32_t i = 0; i < yield->count; i++) {
        struct yielding_vertex *of = &yield->list[i];
        of->bound = of->answered;
        of->last[1] = of->last[0];
        of->last[0] = yield->foresees ? of->reached : vec3_of_float(yield->target + 3 * (size_t)of->vertex);
    }
    if (yield->foresees != yield->is_foreseen)
        memset(yield->answers, 0, sizeof yield->answers);
    yield->is_foreseen = yield->foresees;
    if (yield->is_foreseen)
        bind_foreseen(yield);
    dpti_yield_forget_loads(yield);
}

void dpti_yield_move_on(struct local_yield *yield, double share, float *next)
{
    for (uint32_t i = 0; i < yield->count; i++) {
        struct yielding_vertex *of = &yield->list[i];
        const size_t at = 3 * (size_t)of->vertex;
        of->base = along(of->base, share, sub(vec3_of_float(yield->target + at), of->base));
        of->contained = along(of->contained, share, sub(of->bound, of->contained));
        const vec3 place = add(of->base, of->yield);
        next[at] = (float)place.x;
        next[at + 1] = (float)place.y;
        next[at + 2] = (float)place.z;
    }
}

int dpti_yield_note(struct local_yield *yield, const float *positions, uint32_t count, double dt)
{
    int has_room = 1;
    yield->seconds += dt;
    for (uint32_t i = 0; i < count; i++) {
        struct yielding_vertex *of =
            dpti_yield_of(yield, yield->loads[i].vertex, positions + 3 * (size_t)yield->loads[i].vertex);
        if (of)
            of->sum = along(of->sum, dt, vec3_of(yield->loads[i].force));
        has_room &= of != NULL;
    }
    return has_room;
}

uint32_t dpti_yield_mean(const struct local_yield *yield, dpt_load *loads, uint32_t capacity)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < yield->count && yield->seconds > 0.0; i++) {
        const vec3 sum = yield->list[i].sum;
        if (sum.x == 0.0 && sum.y == 0.0 && sum.z == 0.0)
            continue;
        if (count < capacity) {
            loads[count] = (dpt_load){ .vertex = yield->list[i].vertex };
            vec3_store(scaled(sum, 1.0 / yield->seconds), loads[count].force);
        }
        count++;
    }
    return count;
}

/* The loads that count as answered at the end of a tick. */
static vec3 known_after(const struct local_yield *yield, const struct yielding_vertex *of, double dt)
{
    return yield->is_foreseen ? of->bound : along(of->known, dt / (KNOWN_TIME + dt), sub(of->contained, of->known));
}

/* How far a vertex goes without a tool. */
static vec3 free_way(const struct yielding_vertex *of, const struct local_yield *yield, double dt)
{
    return along(scaled(of->yield, yield->held - 1.0), -dpti_yield_compliance(yield, of->vertex),
                 known_after(yield, of, dt));
}

void dpti_yield_unload(struct local_yield *yield)
{
    for (uint32_t i = 0; i < yield->count; i++)
        yield->list[i].load = (vec3){ 0.0, 0.0, 0.0 };
}

void dpti_yield_load(struct local_yield *yield, uint32_t vertex, vec3 force)
{
    struct yielding_vertex *of = dpti_yield_of(yield, vertex, NULL);
    if (of)
        of->load = add(of->load, force);
}

void dpti_yield_foresee(const struct local_yield *yield, uint32_t slice, double dt, double share,
                        double moved[SPRING_ROWS])
{
    memset(moved, 0, SPRING_ROWS * sizeof *moved);
    for (uint32_t lane = 0; lane < LANES && LANES * slice + lane < yield->vertex_count; lane++) {
        const uint32_t place = yield->places[LANES * slice + lane];
        if (!place)
            continue;
        const vec3 way = scaled(free_way(&yield->list[place - 1], yield, dt), share);
        moved[lane] = way.x;
        moved[LANES + lane] = way.y;
        moved[2 * LANES + lane] = way.z;
    }
}

vec3 dpti_yield_place(const struct local_yield *yield, uint32_t vertex)
{
    const struct yielding_vertex *of = &yield->list[yield->places[vertex] - 1];
    return add(of->base, of->yield);
}

void dpti_yield_go(struct local_yield *yield, double dt, double share)
{
    for (uint32_t i = 0; i < yield->count; i++) {
        struct yielding_vertex *of = &yield->list[i];
        const vec3 way = along(free_way(of, yield, dt), dpti_yield_compliance(yield, of->vertex), of->load);
        of->yield = along(of->yield, share, way);
    }
}

void dpti_yield_return(struct local_yield *yield, double dt)
{
    for (uint32_t i = 0; i < yield->count; i++)
        yield->list[i].yield = scaled(yield->list[i].yield, KNOWN_TIME / (KNOWN_TIME + dt));
}

static int is_idle(const struct yielding_vertex *of)
{
    return extent_of(of->sum) == 0.0 && extent_of(of->answered) == 0.0 && extent_of(of->bound) == 0.0 &&
           extent_of(of->contained) <= NO_LOAD && extent_of(of->known) <= NO_LOAD && extent_of(of->load) == 0.0 &&
           extent_of(of->yield) <= NO_YIELD;
}

/* The vertices that have come to rest where physics has them are left to it. */
void dpti_yield_keep(struct local_yield *yield, double dt)
{
    for (uint32_t i = 0; i < yield->count; i++) {
        struct yielding_vertex *of = &yield->list[i];
        of->known = known_after(yield, of, dt);
        of->before = of->yield;
    }
    for (uint32_t i = 0; i < yield->count;) {
        struct yielding_vertex *of = &yield->list[i];
        if (!is_idle(of)) {
            i++;
            continue;
        }
        yield->places[of->vertex] = 0;
        *of = yield->list[--yield->count];
        if (i < yield->count)
            yield->places[of->vertex] = i + 1;
    }
}

void dpti_yield_undo(struct local_yield *yield)
{
    for (uint32_t i = 0; i < yield->count; i++)
        yield->list[i].yield = yield->list[i].before;
}

uint32_t dpti_yield_gather(struct local_yield *yield)
{
    for (uint32_t i = 0; i < yield->count; i++) {
        const struct yielding_vertex *of = &yield->list[i];
        const vec3 place = add(of->base, of->yield);
        float *to = yield->moved.positions + 3 * (size_t)i;
        yield->moved.list[i] = of->vertex;
        to[0] = (float)place.x;
        to[1] = (float)place.y;
        to[2] = (float)place.z;
    }
    return yield->count;
}
