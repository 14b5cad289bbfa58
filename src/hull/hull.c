/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A hull has at most 64 corners and is made once, so the simplest method suffices: the plane through any three corners
 * is a face if all corners lie on it or on one side of it. Where corners nearly lie in a plane, rounding may make this
 * inconsistent. Then the check of the polyhedron refuses the hull.
 */
#include "base/return_if_error.h"
#include "base/sincos.h"
#include "base/sized.h"
#include "hull/hull_state.h"

/* Corners that are nearer to a plane than this share of the hull's size lie on it. */
#define ON_PLANE 1e-12

/* The same, for what rounding makes of the plane of a thin triangle of that height, as a part of the size. */
#define ON_PLANE_THIN (1e-15)
#define ON_PLANE_MAX  1e-9

struct build {
    struct dpt_hull hull;
    double size;                         /* m: the longest side of the corners' box */
    uint64_t on_face[HULL_FACES_MAX];    /* corners that lie on a face, as bits */
    uint64_t leads_to[HULL_CORNERS_MAX]; /* corners that a loop leads to from this one, as bits */
    uint32_t loop_count;
    int is_bad;
};

static dpt_result read_def(const dpt_hull_def *given, dpt_hull_def *def)
{
    *def = (dpt_hull_def){ .size = sizeof *def };
    if (!given)
        return DPT_E_ARGUMENT;
    DPT_TRY(sized_read(given, sizeof *def, def, sizeof *def));
    if (def->corner_count < 3 || def->corner_count > HULL_CORNERS_MAX || !def->corners || def->reserved_pointer)
        return DPT_E_ARGUMENT;
    if (!(def->radius >= 0.0 && def->radius <= DPT_COORDINATE_MAX))
        return DPT_E_FINITE;
    for (uint32_t i = 0; i < def->corner_count; i++)
        if (!vec3_within(def->corners + 3 * (size_t)i, DPT_COORDINATE_MAX))
            return DPT_E_FINITE;
    return DPT_OK;
}

/* The middle of the corners' extent along a direction. */
static double middle_along(const struct dpt_hull *hull, vec3 n)
{
    const double max = support_of(hull->corner, hull->corner_count, n);
    const double min = -support_of(hull->corner, hull->corner_count, scaled(n, -1.0));
    return 0.5 * (max + min);
}

/* A segment along the unit vector x, and how far corners are from it. It ends where the farthest corners allow. */
static void try_direction(struct dpt_hull *hull, vec3 x)
{
    vec3 across[2], centre = { 0.0, 0.0, 0.0 };
    double farthest = 0.0, low = HUGE_VAL, high = -HUGE_VAL;
    unit_across(x, across);
    for (int k = 0; k < 2; k++)
        centre = along(centre, middle_along(hull, across[k]), across[k]);
    for (uint32_t i = 0; i < hull->corner_count; i++) {
        const vec3 offset = sub(hull->corner[i], centre);
        farthest = max_of(farthest, length(along(offset, -dot(offset, x), x)));
    }
    for (uint32_t i = 0; i < hull->corner_count; i++) {
        const vec3 offset = sub(hull->corner[i], centre);
        const double at = dot(offset, x), off = length(along(offset, -at, x));
        const double spare = sqrt(max_of(0.0, farthest * farthest - off * off));
        low = min_of(low, at + spare);
        high = max_of(high, at - spare);
    }
    if (low > high)
        low = high = 0.5 * (low + high);
    const vec3 a = along(centre, low, x), u = scaled(x, high - low);
    double reach = 0.0;
    for (uint32_t i = 0; i < hull->corner_count; i++) {
        const double s = nearest_on(a, u, hull->corner[i]);
        reach = max_of(reach, length(sub(hull->corner[i], along(a, s, u))));
    }
    if (reach >= hull->reach)
        return;
    hull->axis_a = a;
    hull->axis_b = add(a, u);
    hull->reach = reach;
}

/*
 * Set the axis of a hull that has corners and edges, so that `reach` is small, and `reach`. Along an edge, or between
 * two corners, a hull is thinner than it is across most other directions.
 */
static void set_axis(struct dpt_hull *hull)
{
    hull->reach = HUGE_VAL;
    for (uint32_t i = 0; i < hull->edge_count; i++)
        try_direction(hull, unit_of(sub(hull->corner[hull->edge[i][1]], hull->corner[hull->edge[i][0]])));
    for (uint32_t i = 0; i < hull->corner_count; i++)
        for (uint32_t k = i + 1; k < hull->corner_count; k++)
            try_direction(hull, unit_of(sub(hull->corner[k], hull->corner[i])));
    /* For rounding: frames keep lengths to a few units in the last place. */
    hull->reach *= 1.0 + 0x1p-40;
}

size_t dpt_hull_bytes(const dpt_hull_def *given)
{
    dpt_hull_def def;
    return read_def(given, &def) == DPT_OK ? sizeof(struct dpt_hull) : 0;
}

/* m: the longest side of the corners' box. */
static double size_of(const dpt_hull_def *def)
{
    vec3 low = vec3_of(def->corners), high = low;
    for (uint32_t i = 1; i < def->corner_count; i++) {
        const vec3 at = vec3_of(def->corners + 3 * (size_t)i);
        low = (vec3){ min_of(low.x, at.x), min_of(low.y, at.y), min_of(low.z, at.z) };
        high = (vec3){ max_of(high.x, at.x), max_of(high.y, at.y), max_of(high.z, at.z) };
    }
    return extent_of(sub(high, low));
}

/* Copy the corners; those that rounding alone tells apart once. */
static void copy_corners(struct build *build, const dpt_hull_def *def)
{
    struct dpt_hull *hull = &build->hull;
    build->size = size_of(def);
    for (uint32_t i = 0; i < def->corner_count; i++) {
        const vec3 corner = vec3_of(def->corners + 3 * (size_t)i);
        int is_new = 1;
        for (uint32_t k = 0; k < hull->corner_count; k++)
            is_new &= extent_of(sub(hull->corner[k], corner)) > ON_PLANE * build->size;
        if (is_new)
            hull->corner[hull->corner_count++] = corner;
    }
}

/* The plane of three corners: a unit normal, and how far corners may be from it that lie on it. 0: too thin. */
static int plane_of(const struct build *build, uint32_t i, uint32_t j, uint32_t k, vec3 *normal, double *tolerance)
{
    const vec3 *corner = build->hull.corner;
    const vec3 e = sub(corner[j], corner[i]), f = sub(corner[k], corner[i]), g = sub(f, e);
    const vec3 across = cross(e, f);
    const double twice_area = length(across);
    const double longest = max_of(length(e), max_of(length(f), length(g)));
    const double height = longest > 0.0 ? twice_area / longest : 0.0;
    if (!(height > 0.0))
        return 0;
    *normal = scaled(across, 1.0 / twice_area);
    *tolerance = build->size * (ON_PLANE + ON_PLANE_THIN * build->size / height);
    return *tolerance <= ON_PLANE_MAX * build->size;
}

/* The corner that the loop of a face leads to from `at`: all others of the face are to the left, or nearer. */
static uint32_t next_on_loop(const struct build *build, uint64_t on_face, vec3 normal, uint32_t at, double tolerance)
{
    const vec3 *corner = build->hull.corner;
    uint32_t next = DPT_NONE;
    for (uint32_t i = 0; i < build->hull.corner_count; i++) {
        if (!(on_face >> i & 1) || i == at)
            continue;
        if (next == DPT_NONE) {
            next = i;
            continue;
        }
        const vec3 to_next = sub(corner[next], corner[at]), to_i = sub(corner[i], corner[at]);
        const double left = dot(cross(to_next, to_i), normal);
        const double noise = tolerance * max_of(length(to_next), length(to_i));
        if (left < -noise || (left <= noise && length(to_i) > length(to_next)))
            next = i;
    }
    return next;
}

/* m: how far corners are beyond the plane through one of them. */
static double beyond(const struct dpt_hull *hull, uint32_t corner, vec3 normal)
{
    return support_of(hull->corner, hull->corner_count, normal) - dot(normal, hull->corner[corner]);
}

/* Corners of a face in order, and the edges that they make. */
static void add_face(struct build *build, uint64_t on_face, vec3 normal, double tolerance)
{
    struct dpt_hull *hull = &build->hull;
    vec3 middle = { 0.0, 0.0, 0.0 };
    double farthest = -1.0, count = 0.0;
    uint32_t start = 0;
    if (hull->face_count == HULL_FACES_MAX) {
        build->is_bad = 1;
        return;
    }
    struct hull_face *face = &hull->face[hull->face_count];
    build->on_face[hull->face_count++] = on_face;
    *face = (struct hull_face){ normal, build->loop_count, 0 };
    for (uint32_t i = 0; i < hull->corner_count; i++)
        if (on_face >> i & 1) {
            middle = add(middle, hull->corner[i]);
            count += 1.0;
        }
    middle = scaled(middle, 1.0 / count);
    for (uint32_t i = 0; i < hull->corner_count; i++)
        if ((on_face >> i & 1) && length(sub(hull->corner[i], middle)) > farthest) {
            farthest = length(sub(hull->corner[i], middle));
            start = i;
        }
    uint32_t at = start;
    vec3 area = { 0.0, 0.0, 0.0 };
    do {
        const uint32_t next = next_on_loop(build, on_face, normal, at, tolerance);
        if (build->loop_count == HULL_LOOPS_MAX || face->count == hull->corner_count ||
            (build->leads_to[at] >> next & 1)) {
            build->is_bad = 1;
            return;
        }
        build->leads_to[at] |= (uint64_t)1 << next;
        hull->loop[build->loop_count++] = (uint8_t)at;
        face->count++;
        area = add(area, cross(sub(hull->corner[at], middle), sub(hull->corner[next], middle)));
        at = next;
    } while (at != start);
    /* The three corners that found the plane may make a thin triangle: the whole face tells its normal better. */
    area = unit_of(area);
    if (beyond(hull, start, area) <= beyond(hull, start, normal))
        face->normal = area;
    build->is_bad |= face->count < 3;
}

/* Add the plane of three corners as a face, or as the two faces of a flat hull, if it is one that is not there yet. */
static void try_plane(struct build *build, uint32_t i, uint32_t j, uint32_t k)
{
    struct dpt_hull *hull = &build->hull;
    const uint64_t three = (uint64_t)1 << i | (uint64_t)1 << j | (uint64_t)1 << k;
    uint64_t on_face = 0;
    double tolerance;
    int above = 0, below = 0;
    vec3 normal;
    for (uint32_t f = 0; f < hull->face_count; f++)
        if ((build->on_face[f] & three) == three)
            return;
    if (!plane_of(build, i, j, k, &normal, &tolerance))
        return;
    for (uint32_t c = 0; c < hull->corner_count && !(above && below); c++) {
        const double height = dot(normal, sub(hull->corner[c], hull->corner[i]));
        above |= height > tolerance;
        below |= height < -tolerance;
        if (within(height, tolerance))
            on_face |= (uint64_t)1 << c;
    }
    if (above && below)
        return;
    if (!above)
        add_face(build, on_face, normal, tolerance);
    if (!below)
        add_face(build, on_face, scaled(normal, -1.0), tolerance);
    hull->is_flat |= !above && !below;
}

/* Each edge leads one way on one face and back on another, and the numbers are those of a polyhedron. */
static int is_polyhedron(struct build *build)
{
    struct dpt_hull *hull = &build->hull;
    uint32_t used = 0;
    for (uint32_t i = 0; i < hull->corner_count; i++) {
        used += build->leads_to[i] != 0;
        for (uint32_t k = 0; k < hull->corner_count; k++) {
            const uint64_t there = build->leads_to[i] >> k & 1, back = build->leads_to[k] >> i & 1;
            if (there != back)
                return 0;
            if (!there || k < i)
                continue;
            if (hull->edge_count == HULL_EDGES_MAX)
                return 0;
            hull->edge[hull->edge_count][0] = (uint8_t)i;
            hull->edge[hull->edge_count++][1] = (uint8_t)k;
        }
    }
    return used >= 3 && used + hull->face_count == hull->edge_count + 2;
}

/* Which faces meet at each edge. */
static void set_edge_faces(struct dpt_hull *hull)
{
    for (uint32_t f = 0; f < hull->face_count; f++) {
        const uint8_t *loop = hull->loop + hull->face[f].first;
        for (uint32_t i = 0; i < hull->face[f].count; i++) {
            const uint8_t from = loop[i], to = loop[(i + 1) % hull->face[f].count];
            for (uint32_t e = 0; e < hull->edge_count; e++)
                for (uint32_t direction = 0; direction < 2; direction++)
                    if (hull->edge[e][direction] == from && hull->edge[e][1 - direction] == to)
                        hull->edge_face[e][direction] = (uint8_t)f;
        }
    }
}

/* Corners that no loop leads to are inside the hull of the others. */
static void leave_out_inner(struct build *build)
{
    struct dpt_hull *hull = &build->hull;
    uint8_t now[HULL_CORNERS_MAX];
    uint32_t count = 0;
    for (uint32_t i = 0; i < hull->corner_count; i++)
        if (build->leads_to[i]) {
            now[i] = (uint8_t)count;
            hull->corner[count++] = hull->corner[i];
        }
    hull->corner_count = count;
    for (uint32_t i = 0; i < build->loop_count; i++)
        hull->loop[i] = now[hull->loop[i]];
    for (uint32_t i = 0; i < hull->edge_count; i++)
        for (int k = 0; k < 2; k++)
            hull->edge[i][k] = now[hull->edge[i][k]];
}

dpt_result dpt_hull_create(void *block, size_t bytes, const dpt_hull_def *given, const dpt_hull **hull)
{
    dpt_hull_def def;
    if (!hull)
        return DPT_E_ARGUMENT;
    *hull = NULL;
    DPT_TRY(read_def(given, &def));
    if (!block)
        return DPT_E_ARGUMENT;
    if ((uintptr_t)block % 8)
        return DPT_E_ALIGN;
    if (bytes < sizeof(struct dpt_hull))
        return DPT_E_MEMORY;
    struct build build;
    memset(&build, 0, sizeof build);
    build.hull.radius = def.radius;
    copy_corners(&build, &def);
    const uint32_t count = build.hull.corner_count;
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t j = i + 1; j < count; j++)
            for (uint32_t k = j + 1; k < count && !build.is_bad; k++)
                try_plane(&build, i, j, k);
    if (build.is_bad || !is_polyhedron(&build))
        return DPT_E_ARGUMENT;
    leave_out_inner(&build);
    set_edge_faces(&build.hull);
    set_axis(&build.hull);
    memcpy(block, &build.hull, sizeof build.hull);
    *hull = block;
    return DPT_OK;
}

dpt_result dpt_hull_get_info(const dpt_hull *hull, dpt_hull_info *info)
{
    if (!hull || !info)
        return DPT_E_ARGUMENT;
    dpt_hull_info now = { .corners = hull->corner_count,
                          .edges = hull->edge_count,
                          .faces = hull->face_count,
                          .radius = hull->radius,
                          .reach = hull->reach };
    DPT_TRY(sized_check(info, sizeof now, 0));
    vec3_store(hull->axis_a, now.axis[0]);
    vec3_store(hull->axis_b, now.axis[1]);
    sized_write(info, info->size, &now, sizeof now);
    return DPT_OK;
}

dpt_result dpt_hull_get_corner(const dpt_hull *hull, uint32_t corner, double at[3])
{
    if (!hull || !at || corner >= hull->corner_count)
        return DPT_E_ARGUMENT;
    vec3_store(hull->corner[corner], at);
    return DPT_OK;
}

dpt_result dpt_hull_get_edge(const dpt_hull *hull, uint32_t edge, uint32_t corners[2])
{
    if (!hull || !corners || edge >= hull->edge_count)
        return DPT_E_ARGUMENT;
    for (int k = 0; k < 2; k++)
        corners[k] = hull->edge[edge][k];
    return DPT_OK;
}

dpt_result dpt_hull_get_face(const dpt_hull *hull, uint32_t face, uint32_t *corners, uint32_t capacity, uint32_t *count)
{
    if (count)
        *count = 0;
    if (!hull || !count || (!corners && capacity) || face >= hull->face_count)
        return DPT_E_ARGUMENT;
    *count = hull->face[face].count;
    for (uint32_t i = 0; i < *count && i < capacity; i++)
        corners[i] = hull->loop[hull->face[face].first + i];
    return DPT_OK;
}

/* ---- hulls of shapes ---- */

enum { SIDES_DEFAULT = 16, SIDES_MIN = 3 };

static uint32_t sides_max(uint32_t kind)
{
    return kind == DPT_HULL_KIND_CYLINDER ? HULL_CORNERS_MAX / 2 : HULL_CORNERS_MAX - 1;
}

static dpt_result check_shape(dpt_hull_shape *shape)
{
    const int is_round = shape->kind == DPT_HULL_KIND_CYLINDER || shape->kind == DPT_HULL_KIND_CONE;
    if (shape->kind > DPT_HULL_KIND_CONE || shape->reserved)
        return DPT_E_ARGUMENT;
    if (is_round && !shape->sides)
        shape->sides = SIDES_DEFAULT;
    if (is_round ? shape->sides < SIDES_MIN || shape->sides > sides_max(shape->kind) : shape->sides)
        return DPT_E_ARGUMENT;
    for (int k = 0; k < 3; k++)
        if (!(shape->extent[k] >= 0.0 && shape->extent[k] <= DPT_COORDINATE_MAX))
            return DPT_E_FINITE;
    return DPT_OK;
}

struct corner_list {
    double *corners;
    uint32_t capacity, count;
};

static void put(struct corner_list *list, double x, double y, double z)
{
    if (list->count < list->capacity)
        vec3_store((vec3){ x, y, z }, list->corners + 3 * (size_t)list->count);
    list->count++;
}

/* A polygon around a circle across z, with one side's middle on the x axis. */
static void put_polygon(struct corner_list *list, uint32_t sides, double radius, double z)
{
    double sine, cosine;
    turn_sincos(0.5 / sides, &sine, &cosine);
    /* A unit in the last place more than the circle: the polygon holds it. */
    const double outer = radius / cosine * (1.0 + 0x1p-50);
    for (uint32_t i = 0; i < sides; i++) {
        turn_sincos((i + 0.5) / sides, &sine, &cosine);
        put(list, outer * cosine, outer * sine, z);
    }
}

dpt_result dpt_hull_shape_corners(const dpt_hull_shape *given, double *corners, uint32_t capacity, uint32_t *count)
{
    dpt_hull_shape shape = { .size = sizeof shape };
    if (count)
        *count = 0;
    if (!given || !count || (!corners && capacity))
        return DPT_E_ARGUMENT;
    DPT_TRY(sized_read(given, sizeof shape, &shape, sizeof shape));
    DPT_TRY(check_shape(&shape));
    const double x = 0.5 * shape.extent[0], y = 0.5 * shape.extent[1], z = 0.5 * shape.extent[2];
    struct corner_list list = { corners, capacity, 0 };
    switch (shape.kind) {
    case DPT_HULL_KIND_BOX:
    case DPT_HULL_KIND_WEDGE:
        for (int i = 0; i < 8; i++)
            if (shape.kind == DPT_HULL_KIND_BOX || i >= 4)
                put(&list, i & 1 ? x : -x, i & 2 ? y : -y, i & 4 ? z : -z);
        if (shape.kind == DPT_HULL_KIND_WEDGE)
            for (int i = 0; i < 2; i++)
                put(&list, i ? x : -x, 0.0, -z);
        break;
    case DPT_HULL_KIND_CYLINDER:
        put_polygon(&list, shape.sides, x, -z);
        put_polygon(&list, shape.sides, x, z);
        break;
    default:
        put_polygon(&list, shape.sides, x, z);
        put(&list, 0.0, 0.0, -z);
    }
    *count = list.count;
    return list.count > capacity ? DPT_E_FULL : DPT_OK;
}
