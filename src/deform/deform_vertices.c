/* SPDX-License-Identifier: BSD-3-Clause */
#include "deform/deform_vertices.h"

#include "mesh/surface.h"

typedef char groups_agree[(int)MOTION_GROUP == (int)KERNEL_GROUP ? 1 : -1];

/* Rounding up: of one operation, and of a length that is scaled. */
#define ROUND_UP        (1.0f + 0x1p-23f)
#define ROUND_UP_LENGTH (1.0f + 0x1p-20f)

/* In the filter's frame, vertices and the centres of boxes lie within -1..1. */
#define LACK_MAX 2.0f

/* The box's ends, once for each vertex of a group. */
static void repeat_box(const struct surface *surface, float low[MOTION_GROUP_FLOATS], float high[MOTION_GROUP_FLOATS])
{
    double min[3], max[3];
    vec3_store(surface->box_min, min);
    vec3_store(surface->box_max, max);
    for (int i = 0; i < MOTION_GROUP_FLOATS; i++) {
        low[i] = (float)min[i % 3];
        high[i] = (float)max[i % 3];
    }
}

int dpti_deform_is_inside(const struct surface *surface, const struct kernel *kernel, const float *positions,
                          uint32_t count)
{
    float low[MOTION_GROUP_FLOATS], high[MOTION_GROUP_FLOATS];
    const uint32_t groups = count / MOTION_GROUP, rest = count % MOTION_GROUP;
    repeat_box(surface, low, high);
    if (kernel->outside(positions, groups, low, high))
        return 0;
    for (size_t i = 3 * (size_t)(count - rest); i < 3 * (size_t)count; i++)
        if (!(positions[i] >= low[i % 3] && positions[i] <= high[i % 3]))
            return 0;
    return 1;
}

static void extend(double low[3], double high[3], const float position[3])
{
    for (int k = 0; k < 3; k++) {
        low[k] = min_of(low[k], (double)position[k]);
        high[k] = max_of(high[k], (double)position[k]);
    }
}

int dpti_deform_is_in_limit(const struct surface *surface, const float *positions, uint32_t count)
{
    const struct surface_motion *motion = surface->motion;
    for (size_t i = 0; i < 3 * (size_t)count; i++)
        if (!((double)positions[i] >= motion->limit_min[i % 3] && (double)positions[i] <= motion->limit_max[i % 3]))
            return 0;
    return 1;
}

void dpti_deform_extent(const struct surface *surface, const struct vertex_update *update, const float *target,
                        double low[3], double high[3])
{
    const struct surface_motion *motion = surface->motion;
    for (int k = 0; k < 3; k++) {
        low[k] = HUGE_VAL;
        high[k] = -HUGE_VAL;
    }
    for (size_t i = 0; i < update->count; i++)
        extend(low, high, update->positions + 3 * i);
    for (uint32_t v = 0; v < motion->mesh->vertices; v++) {
        extend(low, high, motion->positions + 3 * (size_t)v);
        extend(low, high, surface_motion_previous(motion, v, update->tick));
        if (target)
            extend(low, high, target + 3 * (size_t)v);
    }
}

/* The first update of a tick. */
static void begin_tick(struct surface_motion *motion, uint32_t tick)
{
    if (motion->tick == tick)
        return;
    motion->tick = tick;
    memset(motion->step, 0, motion->first[motion->levels + 1] * sizeof *motion->step);
}

/* Move whole groups. moved: how far, the squares in m^2; with a bound they are not measured. */
static void move_groups(const struct kernel *kernel, const float *next, const float *last, float *to, uint32_t groups,
                        double bound, float *square)
{
    if (bound < 0.0) {
        kernel->move(next, last, to, groups, square);
        return;
    }
    memcpy(to, next, (size_t)MOTION_GROUP_FLOATS * groups * sizeof *to);
    for (uint32_t group = 0; group < groups; group++)
        square[group] = ROUND_UP_LENGTH * (float)(bound * bound);
}

/* All vertices, none of which has moved in this tick: the old positions stay where they are, as the last tick's. */
static void move_all(struct surface_motion *motion, const struct kernel *kernel, const struct vertex_update *update)
{
    const uint32_t vertices = motion->mesh->vertices, whole = motion->groups - 1;
    const size_t floats = (size_t)MOTION_GROUP_FLOATS * whole;
    float *last = motion->positions, *to = motion->previous;
    move_groups(kernel, update->positions, last, to, whole, update->bound, motion->group_moved);
    float next[MOTION_GROUP_FLOATS] = { 0.0f };
    memcpy(next, update->positions + floats, (3 * (size_t)vertices - floats) * sizeof *next);
    move_groups(kernel, next, last + floats, to + floats, 1, update->bound, motion->group_moved + whole);
    motion->positions = to;
    motion->previous = last;
    for (uint32_t group = 0; group < motion->groups; group++)
        motion->group_tick[group] = update->tick;
}

/* A group has moved by a distance, given as its square; paths add up. */
static void add_to_group(struct surface_motion *motion, uint32_t group, float square)
{
    const float before = sqrtf(motion->group_moved[group]), now = before + sqrtf(square);
    motion->group_moved[group] = before > 0.0f ? ROUND_UP_LENGTH * now * now : ROUND_UP_LENGTH * square;
}

/* Move one group; the last tick's positions are put aside once a tick. In a list it may be moved again. */
static void move_group(struct surface_motion *motion, const struct kernel *kernel, uint32_t group, const float *next,
                       const struct vertex_update *update)
{
    const size_t at = (size_t)MOTION_GROUP_FLOATS * group;
    float last[MOTION_GROUP_FLOATS] = { 0.0f }, square;
    memcpy(last, motion->positions + at, MOTION_GROUP_FLOATS * sizeof *last);
    if (motion->group_tick[group] != update->tick)
        memcpy(motion->previous + at, last, MOTION_GROUP_FLOATS * sizeof *last);
    motion->group_tick[group] = update->tick;
    move_groups(kernel, next, last, motion->positions + at, 1, update->bound, &square);
    add_to_group(motion, group, square);
}

/* Whether a group is whole in an update, one vertex after the other, from its i-th vertex on. */
static int is_whole_group(const struct vertex_update *update, uint32_t i, uint32_t group)
{
    uint32_t same = 0;
    if (update->count - i < MOTION_GROUP)
        return 0;
    for (uint32_t k = 0; k < MOTION_GROUP; k++)
        same += (update->list ? update->list[i + k] : update->first + i + k) == MOTION_GROUP * group + k;
    return same == MOTION_GROUP;
}

/* The vertices of an update that follow each other in one group are moved together. */
static void move_some(struct surface_motion *motion, const struct kernel *kernel, const struct vertex_update *update)
{
    for (uint32_t i = 0; i < update->count;) {
        const uint32_t group = (update->list ? update->list[i] : update->first + i) / MOTION_GROUP;
        float next[MOTION_GROUP_FLOATS] = { 0.0f };
        if (is_whole_group(update, i, group)) {
            move_group(motion, kernel, group, update->positions + 3 * (size_t)i, update);
            i += MOTION_GROUP;
            continue;
        }
        memcpy(next, motion->positions + (size_t)MOTION_GROUP_FLOATS * group, MOTION_GROUP_FLOATS * sizeof *next);
        for (; i < update->count; i++) {
            const uint32_t vertex = update->list ? update->list[i] : update->first + i;
            if (vertex / MOTION_GROUP != group)
                break;
            memcpy(next + 3 * (size_t)(vertex % MOTION_GROUP), update->positions + 3 * (size_t)i, 3 * sizeof *next);
        }
        move_group(motion, kernel, group, next, update);
    }
}

/* From squares, m^2, to lengths in the filter's frame. */
static void scale_groups(struct surface_motion *motion)
{
    const float scale = motion->scale * ROUND_UP_LENGTH;
    for (uint32_t group = 0; group < motion->groups; group++)
        motion->group_moved[group] = sqrtf(motion->group_moved[group]) * scale;
}

static float max_of_float(float a, float b)
{
    return a > b ? a : b;
}

/* How far each leaf's vertices moved, then each node's. */
static void gather_moved(struct surface_motion *motion)
{
    const float *restrict by_group = motion->group_moved;
    float *restrict by_leaf = motion->moved;
    for (uint32_t leaf = 0; leaf < motion->count[0]; leaf++) {
        const uint32_t *group = motion->leaf_groups + MOTION_LEAF_GROUPS * (size_t)leaf;
        by_leaf[leaf] = max_of_float(max_of_float(by_group[group[0]], by_group[group[1]]),
                                     max_of_float(by_group[group[2]], by_group[group[3]]));
    }
    for (uint64_t i = 0; i < motion->more_count; i++) {
        const uint32_t leaf = motion->more_groups[2 * i];
        by_leaf[leaf] = max_of_float(by_group[motion->more_groups[2 * i + 1]], by_leaf[leaf]);
    }
    for (uint32_t level = 1; level <= motion->levels; level++)
        for (uint32_t node = 0; node < motion->count[level]; node++) {
            const float *child = motion->moved + motion->first[level - 1] + node * LANES;
            float moved = 0.0f;
            for (int i = 0; i < LANES; i++)
                moved = max_of_float(child[i], moved);
            motion->moved[motion->first[level] + node] = moved;
        }
}

static void add_moved(struct surface_motion *motion)
{
    const uint32_t nodes = motion->first[motion->levels + 1];
    const float *restrict moved = motion->moved;
    float *restrict step = motion->step, *restrict travel = motion->travel;
    for (uint32_t i = 0; i < nodes; i++) {
        const float one = moved[i] > 0.0f ? ROUND_UP : 1.0f;
        step[i] = one * (step[i] + moved[i]);
        travel[i] = one * (travel[i] + moved[i]);
    }
}

/*
 * What a box lacks stays, the rest of its travel is taken away: it need not be wider than all that vertices can reach.
 * Beyond that, -1 as what was followed says that a leaf or node is not up to date.
 */
static void begin_travels_anew(struct surface_motion *motion)
{
    const uint32_t nodes = motion->first[motion->levels + 1];
    motion->begun++;
    for (uint32_t i = 0; i < nodes; i++) {
        const float wider = ROUND_UP * (motion->travel[i] - motion->boxed[i]);
        const float lacks = wider < LACK_MAX ? wider : LACK_MAX;
        const int is_followed = motion->followed[i] == motion->travel[i];
        motion->travel[i] = lacks;
        motion->boxed[i] = 0.0f;
        motion->followed[i] = is_followed ? lacks : -1.0f;
    }
    memset(motion->remade, 0, motion->count[1] * sizeof *motion->remade);
}

/* Travels after an update whose groups have moved by group_moved, in m^2. */
static double finish_update(struct surface *surface, int *has_begun_anew)
{
    struct surface_motion *motion = surface->motion;
    const uint32_t root = motion->first[motion->levels];
    scale_groups(motion);
    gather_moved(motion);
    add_moved(motion);
    *has_begun_anew = motion->travel[root] > MOTION_TRAVEL_MAX;
    if (*has_begun_anew)
        begin_travels_anew(motion);
    return (double)motion->moved[root] / surface->filter_scale;
}

double dpti_deform_move(struct surface *surface, const struct kernel *kernel, const struct vertex_update *update,
                        int *has_begun_anew)
{
    struct surface_motion *motion = surface->motion;
    const int is_whole = !update->list && update->count == motion->mesh->vertices;
    const int is_first = motion->tick != update->tick;
    begin_tick(motion, update->tick);
    if (is_whole && is_first) {
        move_all(motion, kernel, update);
        surface->positions = motion->positions;
    } else {
        memset(motion->group_moved, 0, motion->groups * sizeof *motion->group_moved);
        move_some(motion, kernel, update);
    }
    return finish_update(surface, has_begun_anew);
}

void dpti_deform_begin(struct surface *surface, uint32_t tick)
{
    struct surface_motion *motion = surface->motion;
    begin_tick(motion, tick);
    memset(motion->group_moved, 0, motion->groups * sizeof *motion->group_moved);
}

void dpti_deform_put(struct surface *surface, uint32_t vertex, vec3 to)
{
    struct surface_motion *motion = surface->motion;
    const uint32_t group = vertex / MOTION_GROUP;
    const size_t at = (size_t)MOTION_GROUP_FLOATS * group;
    float *position = motion->positions + 3 * (size_t)vertex;
    const float next[3] = { (float)to.x, (float)to.y, (float)to.z };
    const vec3 rounded = vec3_of_float(next);
    const vec3 low = sub(rounded, surface->box_min), high = sub(surface->box_max, rounded);
    if (!(low.x >= 0.0 && low.y >= 0.0 && low.z >= 0.0 && high.x >= 0.0 && high.y >= 0.0 && high.z >= 0.0))
        return;
    if (motion->group_tick[group] != motion->tick)
        memcpy(motion->previous + at, motion->positions + at, MOTION_GROUP_FLOATS * sizeof *motion->positions);
    motion->group_tick[group] = motion->tick;
    const vec3 moved = sub(rounded, vec3_of_float(position));
    add_to_group(motion, group, (float)dot(moved, moved));
    memcpy(position, next, sizeof next);
}

double dpti_deform_end(struct surface *surface, int *has_begun_anew)
{
    return finish_update(surface, has_begun_anew);
}

/* ---- the paper's response ---- */

/* Corners are moved by the overlap times this, so that rounding to float leaves no overlap. */
#define BEYOND (1.0 + 1e-6)

/* More than the rounding of a distance. */
#define CLEAR (1.0 + 1e-9)

/*
 * How a triangle's nearest point has to move, m; 0 if the tool does not touch it. As a rule it moves away from the axis.
 * Where the axis goes through the triangle or is behind it, it moves against the normal on the tool's side. Normals alone
 * would not do: triangles of a crater's wall may fold over.
 */
static vec3 exit_displacement(const struct surface *surface, const struct displacing_tool *tool, uint32_t place,
                              double weight[3])
{
    const dpt_pose identity = DPT_POSE_IDENTITY;
    const vec3 none = { 0.0, 0.0, 0.0 };
    const pair found = dpti_triangle_pair(surface, place, tool->a, tool->u);
    const double distance = sqrt(found.distance2);
    const vec3 normal = scaled(dpti_surface_face_normal(surface, place), (double)tool->side);
    const struct strip_tool at_strip = { tool->a, tool->u, tool->radius, tool->side };
    struct frame frame;
    dpt_overlap overlap;
    for (int k = 0; k < 3; k++)
        weight[k] = found.weight[k];
    if (distance > 0.0 && (!tool->is_behind || dot(found.gap, normal) >= 0.0))
        return distance < tool->radius ? scaled(found.gap, -BEYOND * (tool->radius - distance) / distance) : none;
    frame_of_pose(&identity, &frame);
    dpti_strip_overlap(surface, &frame, &at_strip, place, &overlap);
    return scaled(normal, -BEYOND * overlap.overlap);
}

/* By a ball about its middle: most of a strip is beside the tool. */
static int is_clear(const struct surface *surface, const struct displacing_tool *tool, uint32_t place)
{
    vec3 v[3];
    double square = 0.0;
    if (tool->is_behind)
        return 0;
    surface_corners(surface, place, v);
    const vec3 middle = scaled(add(add(v[0], v[1]), v[2]), 1.0 / 3.0);
    for (int k = 0; k < 3; k++) {
        const vec3 r = sub(v[k], middle);
        square = max_of(square, dot(r, r));
    }
    const vec3 from = sub(middle, tool->a);
    const double uu = dot(tool->u, tool->u);
    const double s = uu > 0.0 ? min_of(max_of(dot(from, tool->u) / uu, 0.0), 1.0) : 0.0;
    const vec3 away = along(from, -s, tool->u);
    const double reach = CLEAR * (sqrt(square) + tool->radius);
    return dot(away, away) > reach * reach;
}

/* Returns 1 if it was moved. */
static int displace_triangle(struct surface *surface, const struct displacing_tool *tool, uint32_t place)
{
    double weight[3], square = 0.0;
    if (is_clear(surface, tool, place))
        return 0;
    const vec3 displacement = exit_displacement(surface, tool, place, weight);
    if (!(dot(displacement, displacement) > 0.0))
        return 0;
    for (int k = 0; k < 3; k++)
        square += weight[k] * weight[k];
    for (uint32_t k = 0; k < 3; k++) {
        const uint32_t vertex = surface_corner(surface, place, k);
        if (weight[k] > 0.0)
            dpti_deform_put(surface, vertex, along(surface_vertex(surface, vertex), weight[k] / square, displacement));
    }
    return 1;
}

void dpti_displace(struct surface *surface, const struct dpt_strip *strip, const struct displacing_tool *tool,
                   uint32_t passes)
{
    const uint32_t *places = mesh_words(surface->mesh, MESH_PLACES);
    int is_moved = 1;
    for (uint32_t pass = 0; pass < passes && is_moved; pass++) {
        is_moved = 0;
        for (uint32_t i = 0; i < strip->count; i++)
            is_moved |= displace_triangle(surface, tool, places[strip->triangles[i]]);
    }
}
