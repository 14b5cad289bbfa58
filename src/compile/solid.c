/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Which parts have an inside, which of them lie within or cut which, and which way round they must be
 * (docs/algorithms/winding.md).
 */
#include <stdlib.h>
#include <string.h>

#include "base/return_if_error.h"
#include "compile/cluster.h"
#include "compile/parallel.h"
#include "mesh/mesh_format.h"

/* A part with defects is solid when the rest of it goes round its triangles as often as that, on average. */
#define SOLID_MIN 0.44

/* Coordinates are floats: of the largest one they tell so much. */
#define RESOLUTION 0x1p-23

/* Of a part's triangles so many are asked, spread evenly over them. */
#define SAMPLES_MIN   32u
#define SAMPLES_MAX   1000u
#define SAMPLES_SHARE 16u

/* Fewer where that costs more than so much a triangle, as at a hub, whose triangles are all near each other. */
#define SAMPLES_WORK 16u

/* Where parts meet, or one of them has holes, that many points of the one tell whether it lies in the other. */
#define INSIDE_SAMPLES 16u

/* Between these a point is neither inside nor outside of a part with defects. */
#define SURELY_OUTSIDE 0.1
#define SURELY_INSIDE  0.9

/*
 * Where the boxes of all parts meet, their pairs are the square of their number. So much work a triangle goes into
 * them, in boxes compared, of which a triangle of the smaller part is worth some; 96 parts that meet each other.
 */
#define RELATE_WORK     3072u
#define RELATE_TRIANGLE 64u

/*
 * What has no inside itself may lie within a solid. That is asked of so many triangles and, in a large mesh, of one in so
 * many, the first ones; so many boxes compared count as one.
 */
#define BURY_MIN   1024u
#define BURY_SHARE 64u
#define BURY_BOXES 64u

struct solid {
    uint32_t part;
    uint32_t first_in_list; /* of its triangles in the list */
    uint32_t triangle_count;
    int is_closed;
    int is_solid;
    dpt_result result; /* of finding that out */
    int is_mixed;      /* wound both ways in the source */
    int is_inward;     /* as wound in the source, most of it where mixed */
    int is_flipped;    /* is turned as a whole */
    int needs_winding; /* MESH_PART_WINDING */
    double volume, area;
    struct bounds box;
    struct cluster cluster; /* made when first asked */
};

/* One lies within another: both by their rank. */
struct containment {
    uint32_t inner, outer;
};

struct solids {
    struct model *model;
    soup *source;
    const uint32_t *part_list; /* the model's, by part */
    const uint32_t *part_first;
    struct solid *solids; /* by rank: the largest first */
    uint32_t count;
    struct containment *containments;
    size_t containment_count, containment_capacity;
    double touch_distance; /* what is nearer touches */
};

/* The volume that it encloses, as its triangles will agree, its box, and how many triangles are to be turned. */
static uint32_t measure(const struct solids *all, struct solid *solid)
{
    const struct model *model = all->model;
    const uint32_t *list = all->part_list + solid->first_in_list;
    uint32_t turned_count = 0;
    double six_volumes = 0.0;
    vec3 c[3], origin;
    model_corners(model, list[0], c);
    origin = c[0];
    solid->box = bounds_of_corners(c);
    for (uint32_t i = 0; i < solid->triangle_count; i++) {
        model_corners(model, list[i], c);
        solid->box = bounds_join(solid->box, bounds_of_corners(c));
        double here = dot(sub(c[0], origin), cross(sub(c[1], origin), sub(c[2], origin)));
        six_volumes += model->is_turned[list[i]] ? -here : here;
        solid->area += 0.5 * length(cross(sub(c[1], c[0]), sub(c[2], c[0])));
        turned_count += model->is_turned[list[i]];
    }
    solid->volume = six_volumes / 6.0;
    return turned_count;
}

/* Thinner than its coordinates tell: what it encloses may be all rounding. */
static int is_flat(const struct solid *solid)
{
    double extent = max_of(extent_of(solid->box.low), extent_of(solid->box.high));
    return fabs(solid->volume) <= RESOLUTION * extent * solid->area;
}

static dpt_result ensure_cluster(struct solids *all, struct solid *solid)
{
    if (solid->cluster.node_moments)
        return DPT_OK;
    return cluster_build(&solid->cluster, all->model, all->part_list + solid->first_in_list,
                         solid->triangle_count);
}

static vec3 centroid_of(const struct model *model, uint32_t triangle, double *area)
{
    vec3 c[3];
    model_corners(model, triangle, c);
    if (area)
        *area = length(cross(sub(c[1], c[0]), sub(c[2], c[0])));
    return scaled(add(add(c[0], c[1]), c[2]), 1.0 / 3.0);
}

/* The k-th of `samples` triangles, the first ones already spread over the part, by the golden section. */
static uint32_t sample_triangle(const struct solids *all, const struct solid *solid, uint32_t k,
                                uint32_t samples)
{
    uint32_t spread = k * 2654435769u;
    uint32_t at = samples == solid->triangle_count
                      ? k
                      : (uint32_t)((uint64_t)spread * solid->triangle_count >> 32);
    return all->part_list[solid->first_in_list + at];
}

/*
 * Does a part with defects nearly close? Round a closed surface's own triangles the rest of it goes by half a turn,
 * round those of a flat sheet not at all. Its sign tells which way it is wound.
 */
static dpt_result judge_defective(struct solids *all, struct solid *solid)
{
    uint32_t samples = solid->triangle_count / SAMPLES_SHARE;
    samples = samples < SAMPLES_MIN ? SAMPLES_MIN : samples;
    samples = samples > SAMPLES_MAX ? SAMPLES_MAX : samples;
    samples = samples > solid->triangle_count ? solid->triangle_count : samples;
    uint64_t work = 0, max_work = (uint64_t)SAMPLES_WORK * solid->triangle_count;
    double sum = 0.0, total = 0.0;
    DPT_TRY(ensure_cluster(all, solid));
    for (uint32_t k = 0; k < samples && (k < SAMPLES_MIN / 2 || work < max_work); k++) {
        uint32_t t = sample_triangle(all, solid, k, samples);
        double area;
        vec3 x = centroid_of(all->model, t, &area);
        double rest = cluster_winding(&solid->cluster, x, t, &work);
        sum += area * rest;
        total += area;
    }
    solid->is_solid = fabs(sum) >= SOLID_MIN * total && !is_flat(solid);
    solid->is_inward = sum < 0.0;
    return DPT_OK;
}

/* A closed part that is wound half and half has no way of its own: outward. */
static void wind_half_outward(const struct solids *all, struct solid *solid, uint32_t turned_count)
{
    if (2 * (uint64_t)turned_count != solid->triangle_count || !solid->is_inward)
        return;
    for (uint32_t i = 0; i < solid->triangle_count; i++)
        all->model->is_turned[all->part_list[solid->first_in_list + i]] ^= 1;
    solid->is_inward = 0;
    solid->volume = -solid->volume;
}

/* Four triangles enclose something, three do not. */
static int may_be_solid(const struct part *part)
{
    return part->triangles >= 4;
}

static int by_size(const void *a, const void *b)
{
    const struct solid *x = a, *y = b;
    double vx = fabs(x->volume), vy = fabs(y->volume);
    if (vx != vy)
        return vx > vy ? -1 : 1;
    return x->part < y->part ? -1 : 1;
}

static void classify_solids(void *context, size_t first, size_t end)
{
    struct solids *all = context;
    for (size_t i = first; i < end; i++) {
        struct solid *solid = &all->solids[i];
        uint32_t turned_count = measure(all, solid);
        solid->is_mixed = turned_count != 0;
        solid->is_solid = solid->is_closed;
        if (solid->is_closed) {
            solid->is_inward = solid->volume < 0.0 && !is_flat(solid);
            wind_half_outward(all, solid, turned_count);
        } else {
            solid->result = judge_defective(all, solid);
            if (!solid->is_solid)
                cluster_free(&solid->cluster);
        }
    }
}

static dpt_result find_solids(struct solids *all)
{
    struct model *model = all->model;
    const uint32_t threads = model->triangle_count < PARALLEL_MIN ? 1 : all->source->threads;
    uint32_t candidates = 0, found = 0;
    for (uint32_t p = 0; p < model->part_count; p++)
        candidates += (uint32_t)may_be_solid(&model->parts[p]);
    all->solids = model_alloc(all->source, candidates, sizeof *all->solids);
    if (!all->solids)
        return DPT_E_MEMORY;
    for (uint32_t p = 0; p < model->part_count; p++) {
        const struct part *part = &model->parts[p];
        if (may_be_solid(part))
            all->solids[all->count++] =
                (struct solid){ .part = p,
                                .first_in_list = all->part_first[p],
                                .triangle_count = part->triangles,
                                .is_closed = (part->flags & MESH_PART_CLOSED) != 0,
                                .needs_winding = model->part_cuts_itself[p] };
    }
    parallel_for(threads, candidates, 1, classify_solids, all);
    for (uint32_t i = 0; i < candidates; i++)
        DPT_TRY(all->solids[i].result);
    for (uint32_t i = 0; i < candidates; i++)
        if (all->solids[i].is_solid)
            all->solids[found++] = all->solids[i];
    all->count = found;
    qsort(all->solids, all->count, sizeof *all->solids, by_size);
    return DPT_OK;
}

/* Do two surfaces touch? The smaller one's triangles against the other's cluster. */
static dpt_result surfaces_touch(struct solids *all, struct solid *a, struct solid *b, int *touch)
{
    struct solid *smaller = a->triangle_count < b->triangle_count ? a : b,
                 *larger = smaller == a ? b : a;
    DPT_TRY(ensure_cluster(all, larger));
    *touch = 0;
    for (uint32_t i = 0; i < smaller->triangle_count && !*touch; i++)
        *touch = cluster_touches(&larger->cluster, all->part_list[smaller->first_in_list + i],
                                 all->touch_distance);
    return DPT_OK;
}

static int box_within(const struct bounds *small, const struct bounds *large)
{
    struct bounds joined = bounds_join(*small, *large);
    return !memcmp(&joined, large, sizeof joined);
}

static dpt_result add_containment(struct solids *all, uint32_t solid, uint32_t inside_count)
{
    if (all->containment_count == all->containment_capacity) {
        size_t capacity = all->containment_capacity ? 2 * all->containment_capacity : 64;
        struct containment *grown = realloc(all->containments, capacity * sizeof *grown);
        if (!grown)
            return DPT_E_MEMORY;
        all->containments = grown;
        all->containment_capacity = capacity;
    }
    all->containments[all->containment_count++] = (struct containment){ solid, inside_count };
    return DPT_OK;
}

/* Two solids whose boxes meet, by rank: `large` is not the smaller one. */
static dpt_result relate_pair(struct solids *all, uint32_t small_rank, uint32_t large_rank)
{
    struct solid *small = &all->solids[small_rank], *large = &all->solids[large_rank];
    int touch;
    DPT_TRY(surfaces_touch(all, small, large, &touch));
    if (touch)
        small->needs_winding = large->needs_winding = 1;
    if (!touch && large->is_closed && !box_within(&small->box, &large->box))
        return DPT_OK;
    uint32_t samples = touch || !large->is_closed ? INSIDE_SAMPLES : 1;
    samples = samples < small->triangle_count ? samples : small->triangle_count;
    uint64_t work = 0;
    double sum = 0.0;
    DPT_TRY(ensure_cluster(all, large));
    for (uint32_t k = 0; k < samples; k++) {
        uint32_t t = sample_triangle(all, small, k, samples);
        vec3 x = centroid_of(all->model, t, NULL);
        double winding = fabs(cluster_winding(&large->cluster, x, DPT_NONE, &work));
        sum += winding;
        if (winding > SURELY_OUTSIDE && winding < SURELY_INSIDE)
            small->needs_winding = 1;
    }
    return sum > 0.5 * samples ? add_containment(all, small_rank, large_rank) : DPT_OK;
}

struct axis_start {
    double low;
    uint32_t rank;
};

static int by_low(const void *a, const void *b)
{
    const struct axis_start *x = a, *y = b;
    if (x->low != y->low)
        return x->low < y->low ? -1 : 1;
    return x->rank < y->rank ? -1 : x->rank > y->rank;
}

static double axis_of(vec3 v, int axis)
{
    return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

/* The axis along which all of them together are longest: along it the fewest boxes meet. */
static int sweep_axis(const struct solids *all)
{
    struct bounds box = all->solids[0].box;
    for (uint32_t i = 1; i < all->count; i++)
        box = bounds_join(box, all->solids[i].box);
    vec3 size = sub(box.high, box.low);
    return size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
}

static uint32_t min_triangles(const struct solid *a, const struct solid *b)
{
    return a->triangle_count < b->triangle_count ? a->triangle_count : b->triangle_count;
}

/* What the work does not suffice for is decided by winding number, and wound by what is known of it. */
static dpt_result relate_all(struct solids *all)
{
    if (all->count < 2)
        return DPT_OK;
    uint64_t work = 0, max_work = (uint64_t)RELATE_WORK * all->model->triangle_count;
    struct axis_start *starts = model_alloc(all->source, all->count, sizeof *starts);
    if (!starts)
        return DPT_E_MEMORY;
    int axis = sweep_axis(all);
    dpt_result result = DPT_OK;
    for (uint32_t i = 0; i < all->count; i++)
        starts[i] = (struct axis_start){ axis_of(all->solids[i].box.low, axis), i };
    qsort(starts, all->count, sizeof *starts, by_low);
    for (uint32_t i = 0; result == DPT_OK && i < all->count; i++) {
        const struct bounds *box = &all->solids[starts[i].rank].box;
        double end = axis_of(box->high, axis) + all->touch_distance;
        for (uint32_t j = i + 1; result == DPT_OK && j < all->count && starts[j].low <= end; j++) {
            uint32_t a = starts[i].rank, b = starts[j].rank;
            if (work++ > max_work)
                break;
            if (!bounds_meet(box, &all->solids[b].box, all->touch_distance))
                continue;
            work += RELATE_TRIANGLE * (uint64_t)min_triangles(&all->solids[a], &all->solids[b]);
            result = a < b ? relate_pair(all, b, a) : relate_pair(all, a, b);
        }
        if (work > max_work)
            all->solids[starts[i].rank].needs_winding = 1;
    }
    free(starts);
    return result;
}

static int by_rank(const void *a, const void *b)
{
    const struct containment *x = a, *y = b;
    if (x->inner != y->inner)
        return x->inner < y->inner ? -1 : 1;
    return x->outer < y->outer ? -1 : x->outer > y->outer;
}

static int is_inward_at_last(const struct solid *solid)
{
    return solid->is_inward != solid->is_flipped;
}

/*
 * From the largest to the smallest. What lies in the open is wound outward; what lies in another is turned as that
 * was, the innermost of them, so that a void stays a void.
 */
static void wind_solids(struct solids *all)
{
    struct model *model = all->model;
    if (all->containment_count)
        qsort(all->containments, all->containment_count, sizeof *all->containments, by_rank);
    size_t next = 0;
    for (uint32_t rank = 0; rank < all->count; rank++) {
        struct solid *solid = &all->solids[rank];
        int32_t layers = 0;
        solid->is_flipped = solid->is_inward;
        for (; next < all->containment_count && all->containments[next].inner == rank; next++) {
            const struct solid *outer = &all->solids[all->containments[next].outer];
            layers += is_inward_at_last(outer) ? -1 : 1;
            solid->is_flipped = outer->is_flipped;
        }
        if (layers < 1)
            solid->is_flipped = solid->is_inward;
        int32_t layers_in_front =
            layers - is_inward_at_last(solid); /* where its normals point to */
        uint32_t flags = MESH_PART_SOLID;
        if (solid->needs_winding || !solid->is_closed)
            flags |= MESH_PART_WINDING;
        else if (layers_in_front > 0)
            flags |= MESH_PART_BURIED;
        struct part *part = &model->parts[solid->part];
        part->flags |= flags;
        model->solid_parts++;
        model->cavities += (uint32_t)is_inward_at_last(solid);
        model->winding_parts += (flags & MESH_PART_WINDING) != 0;
        model->buried_parts += (flags & MESH_PART_BURIED) != 0;
        model->inward_parts += (uint32_t)(solid->is_closed && !solid->is_mixed &&
                                          solid->is_inward && solid->is_flipped);
    }
}

/* Wholly inside of a solid, wholly outside, or neither: 1, 0, -1. */
static dpt_result locate_sheet(struct solids *all, struct solid *sheet, struct solid *solid,
                               int *inside)
{
    int touch;
    uint32_t samples =
        sheet->triangle_count < INSIDE_SAMPLES ? sheet->triangle_count : INSIDE_SAMPLES;
    uint32_t inside_count = 0, outside_count = 0;
    uint64_t work = 0;
    DPT_TRY(surfaces_touch(all, sheet, solid, &touch));
    *inside = touch ? -1 : 0;
    if (touch || !box_within(&sheet->box, &solid->box))
        return DPT_OK;
    DPT_TRY(ensure_cluster(all, solid));
    for (uint32_t k = 0; k < samples; k++) {
        vec3 x = centroid_of(all->model, sample_triangle(all, sheet, k, samples), NULL);
        double winding = fabs(cluster_winding(&solid->cluster, x, DPT_NONE, &work));
        inside_count += winding >= SURELY_INSIDE;
        outside_count += winding <= SURELY_OUTSIDE;
    }
    *inside = inside_count < samples && outside_count < samples ? -1 : inside_count > 0;
    return DPT_OK;
}

/* Is a part that has no inside of its own in another one's, in its material and not in its void? */
static dpt_result is_buried(struct solids *all, struct solid *sheet, uint64_t *work,
                            int *is_inside_material)
{
    int32_t layers = 0;
    *is_inside_material = 0;
    *work += all->count / BURY_BOXES;
    for (uint32_t i = 0; i < all->count; i++) {
        struct solid *solid = &all->solids[i];
        int inside;
        if (!bounds_meet(&sheet->box, &solid->box, all->touch_distance))
            continue;
        *work += sheet->triangle_count;
        DPT_TRY(locate_sheet(all, sheet, solid, &inside));
        if (inside < 0)
            return DPT_OK;
        if (inside)
            layers += is_inward_at_last(solid) ? -1 : 1;
    }
    *is_inside_material = layers > 0;
    return DPT_OK;
}

/* After the solids are wound. What is not asked, or lies on both sides, is judged by itself. */
static dpt_result mark_buried_sheets(struct solids *all)
{
    struct model *model = all->model;
    uint64_t work = 0, max_work = model->triangle_count / BURY_SHARE + BURY_MIN;
    for (uint32_t p = 0; all->count > 0 && p < model->part_count && work < max_work; p++) {
        struct part *part = &model->parts[p];
        if (part->flags & MESH_PART_SOLID)
            continue;
        struct solid sheet = { .part = p,
                               .first_in_list = all->part_first[p],
                               .triangle_count = part->triangles };
        int is_inside_material;
        measure(all, &sheet);
        dpt_result result = is_buried(all, &sheet, &work, &is_inside_material);
        cluster_free(&sheet.cluster);
        DPT_TRY(result);
        if (is_inside_material)
            part->flags |= MESH_PART_BURIED;
    }
    return DPT_OK;
}

/* (0, 1, 2) becomes (0, 2, 1): edges 01, 12, 20 become 02, 21, 10. */
static void turn_triangle(struct model *model, uint32_t t)
{
    uint32_t *corner = model->corners + 3 * (size_t)t;
    uint32_t *neighbour = model->neighbours + 3 * (size_t)t;
    uint32_t c = corner[1], n = neighbour[0];
    corner[1] = corner[2];
    corner[2] = c;
    neighbour[0] = neighbour[2];
    neighbour[2] = n;
    model->turned_triangles++;
}

/* What has no inside stays as it was wound. */
static void turn_triangles(struct solids *all)
{
    struct model *model = all->model;
    for (uint32_t rank = 0; rank < all->count; rank++) {
        const struct solid *solid = &all->solids[rank];
        for (uint32_t i = 0; i < solid->triangle_count; i++) {
            uint32_t t = all->part_list[solid->first_in_list + i];
            if (model->is_turned[t] != solid->is_flipped)
                turn_triangle(model, t);
        }
        if (solid->is_mixed)
            model->parts[solid->part].flags |= MESH_PART_WOUND;
    }
}

/* What is as near as coordinates can tell touches. */
static double touch_distance_of(const struct model *model)
{
    float max_size = 0.0f;
    for (size_t i = 0; i < 3 * (size_t)model->vertex_count; i++)
        max_size = fabsf(model->positions[i]) > max_size ? fabsf(model->positions[i]) : max_size;
    return RESOLUTION * (double)max_size;
}

dpt_result model_solid(struct model *model, soup *source)
{
    struct solids all = { .model = model,
                          .source = source,
                          .touch_distance = touch_distance_of(model) };
    all.part_list = model->part_list;
    all.part_first = model->part_first;
    dpt_result result = find_solids(&all);
    if (result == DPT_OK)
        result = relate_all(&all);
    if (result == DPT_OK) {
        wind_solids(&all);
        result = mark_buried_sheets(&all);
    }
    if (result == DPT_OK)
        turn_triangles(&all);
    if (result == DPT_E_MEMORY)
        soup_fail(source, result, (source_location){ 0, 0 }, "memory ran out");
    for (uint32_t i = 0; all.solids && i < all.count; i++)
        cluster_free(&all.solids[i].cluster);
    free(all.solids);
    free(all.containments);
    return result;
}
