/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Which parts are solid, that is, have an inside; which solids lie within or cut each other; and how they must be wound
 * (docs/algorithms/winding.md).
 */
#include <stdlib.h>
#include <string.h>

#include "base/return_if_error.h"
#include "compile/cluster.h"
#include "compile/compile_context.h"
#include "mesh/mesh_format.h"

/*
 * A part with defects is solid if the winding number of its other triangles, at the centroid of a triangle, is at least
 * this on average, in size. It is 0.5 for a closed surface and 0 for a flat sheet.
 */
#define SOLID_MIN 0.44

/* Coordinates are floats: the resolution of a mesh is this times its largest coordinate. */
#define RESOLUTION 0x1p-23

/* The number of sample triangles of a part with defects: one in SAMPLES_SHARE, within these limits, spread evenly. */
#define SAMPLES_MIN   32u
#define SAMPLES_MAX   1000u
#define SAMPLES_SHARE 16u

/*
 * Sampling stops, after SAMPLES_MIN / 2, at this much work per triangle of the part. A hub would cost more: its
 * triangles are all near each other.
 */
#define SAMPLES_WORK 16u

/* Does a part lie inside another one? Where the two touch, or the other has holes, this many points decide. */
#define INSIDE_SAMPLES 16u

/* At a winding number between these, in size, a point is neither surely inside nor surely outside. */
#define SURELY_OUTSIDE 0.1
#define SURELY_INSIDE  0.9

/*
 * If the boxes of all parts meet, the pairs of parts grow with the square of their number. So the work on pairs is
 * limited to RELATE_WORK per triangle of the mesh. A unit is one comparison of two boxes; a pair whose boxes meet costs
 * RELATE_TRIANGLE units per triangle of its smaller part. That suffices for 96 parts that all meet each other.
 */
#define RELATE_WORK     3072u
#define RELATE_TRIANGLE 64u

/*
 * A part without an inside may lie within a solid. Parts are checked in order until the work reaches BURY_MIN plus one
 * unit per BURY_SHARE triangles of the mesh. A unit is one triangle against one solid, or BURY_BOXES comparisons of
 * boxes.
 */
#define BURY_MIN   1024u
#define BURY_SHARE 64u
#define BURY_BOXES 64u

struct solid {
    uint32_t part;
    uint32_t first_in_list; /* where its triangles begin in the list by part */
    uint32_t triangle_count;
    int is_closed;
    int is_solid;
    dpt_result result; /* of classify_solids */
    int is_mixed;      /* 1: wound both ways in the source */
    int is_inward;     /* 1: wound inward in the source; if mixed, most of it is */
    int is_flipped;    /* 1: the whole part is turned */
    int needs_winding; /* 1: only the winding number tells its inside (MESH_PART_WINDING) */
    double volume;     /* m^3, negative if wound inward */
    double area;       /* m^2 */
    struct bounds box;
    struct cluster cluster; /* built when first needed */
};

/* One solid lies within another. Both are ranks. */
struct containment {
    uint32_t inner, outer;
};

struct solids {
    struct model *model;
    const struct compile_context *context;
    const uint32_t *part_list; /* the model's */
    const uint32_t *part_first;
    struct solid *solids; /* by rank, the largest volume first, once all were found */
    uint32_t count;
    struct containment *containments;
    size_t containment_count, containment_capacity;
    double touch_distance; /* m; surfaces that are no farther apart touch */
};

/*
 * Measure a part's volume, area and box, with its triangles wound one way (model->is_turned). Returns how many of them
 * are turned for that.
 */
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

/* Is the part thinner than the resolution of its coordinates? Then its volume may be nothing but rounding error. */
static int is_flat(const struct solid *solid)
{
    double extent = max_of(extent_of(solid->box.low), extent_of(solid->box.high));
    return fabs(solid->volume) <= RESOLUTION * extent * solid->area;
}

/* Build the solid's cluster unless it is there. */
static dpt_result ensure_cluster(struct solids *all, struct solid *solid)
{
    if (solid->cluster.node_moments)
        return DPT_OK;
    return cluster_build(&solid->cluster, all->model, all->part_list + solid->first_in_list, solid->triangle_count);
}

/* The centroid of a triangle. *area becomes twice its area; it may be NULL. */
static vec3 centroid_of(const struct model *model, uint32_t triangle, double *area)
{
    vec3 c[3];
    model_corners(model, triangle, c);
    if (area)
        *area = length(cross(sub(c[1], c[0]), sub(c[2], c[0])));
    return scaled(add(add(c[0], c[1]), c[2]), 1.0 / 3.0);
}

/* Sample triangle k of `samples`. The golden section spreads any first k of them over the part. Returns a place. */
static uint32_t sample_triangle(const struct solids *all, const struct solid *solid, uint32_t k, uint32_t samples)
{
    uint32_t spread = k * 2654435769u;
    uint32_t at = samples == solid->triangle_count ? k : (uint32_t)((uint64_t)spread * solid->triangle_count >> 32);
    return all->part_list[solid->first_in_list + at];
}

/*
 * Is a part with defects solid? At the centroid of a triangle, the winding number of the part's other triangles is 0.5
 * in size if the part nearly closes, and 0 on a flat sheet. Its sign tells how the part is wound.
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

/*
 * Wind a closed part outward if exactly half of its triangles are wound either way: then neither way is the source's.
 */
static void wind_half_outward(const struct solids *all, struct solid *solid, uint32_t turned_count)
{
    if (2 * (uint64_t)turned_count != solid->triangle_count || !solid->is_inward)
        return;
    for (uint32_t i = 0; i < solid->triangle_count; i++)
        all->model->is_turned[all->part_list[solid->first_in_list + i]] ^= 1;
    solid->is_inward = 0;
    solid->volume = -solid->volume;
}

/* It takes four triangles to enclose a volume. */
static int may_be_solid(const struct part *part)
{
    return part->triangles >= 4;
}

/* Order solids by falling volume. */
static int by_size(const void *a, const void *b)
{
    const struct solid *x = a, *y = b;
    double vx = fabs(x->volume), vy = fabs(y->volume);
    if (vx != vy)
        return vx > vy ? -1 : 1;
    return x->part < y->part ? -1 : 1;
}

/* For candidates first..end: find whether each is solid, and how it is wound. */
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

/* List the solids by rank. */
static dpt_result find_solids(struct solids *all)
{
    struct model *model = all->model;
    const uint32_t threads = model->triangle_count < PARALLEL_MIN ? 1 : all->context->threads;
    uint32_t candidates = 0, found = 0;
    for (uint32_t p = 0; p < model->part_count; p++)
        candidates += (uint32_t)may_be_solid(&model->parts[p]);
    all->solids = compile_alloc(all->context, candidates, sizeof *all->solids);
    if (!all->solids)
        return DPT_E_MEMORY;
    for (uint32_t p = 0; p < model->part_count; p++) {
        const struct part *part = &model->parts[p];
        if (may_be_solid(part))
            all->solids[all->count++] = (struct solid){ .part = p,
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

/* Do two surfaces touch? Sets *touch. Tests the triangles of the smaller part against the cluster of the larger one. */
static dpt_result surfaces_touch(struct solids *all, struct solid *a, struct solid *b, int *touch)
{
    struct solid *smaller = a->triangle_count < b->triangle_count ? a : b, *larger = smaller == a ? b : a;
    DPT_TRY(ensure_cluster(all, larger));
    *touch = 0;
    for (uint32_t i = 0; i < smaller->triangle_count && !*touch; i++)
        *touch = cluster_touches(&larger->cluster, all->part_list[smaller->first_in_list + i], all->touch_distance);
    return DPT_OK;
}

static int box_within(const struct bounds *small, const struct bounds *large)
{
    struct bounds joined = bounds_join(*small, *large);
    return !memcmp(&joined, large, sizeof joined);
}

static dpt_result add_containment(struct solids *all, uint32_t inner_rank, uint32_t outer_rank)
{
    if (all->containment_count == all->containment_capacity) {
        size_t capacity = all->containment_capacity ? 2 * all->containment_capacity : 64;
        struct containment *grown = realloc(all->containments, capacity * sizeof *grown);
        if (!grown)
            return DPT_E_MEMORY;
        all->containments = grown;
        all->containment_capacity = capacity;
    }
    all->containments[all->containment_count++] = (struct containment){ inner_rank, outer_rank };
    return DPT_OK;
}

/*
 * Relate two solids whose boxes meet: do they touch, and does the smaller one lie in the larger one? Both are ranks,
 * with large_rank < small_rank.
 */
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

/* Where the box of a solid begins along the sweep axis. */
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

/* The axis along which all solids together are longest: there the fewest boxes meet. */
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

/*
 * Relate all pairs of solids whose boxes meet, by a sweep along one axis. When the work has run out, the remaining
 * solids are decided by winding number, and wound by what was found until then.
 */
static dpt_result relate_all(struct solids *all)
{
    if (all->count < 2)
        return DPT_OK;
    uint64_t work = 0, max_work = (uint64_t)RELATE_WORK * all->model->triangle_count;
    struct axis_start *starts = compile_alloc(all->context, all->count, sizeof *starts);
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

/* Is the solid wound inward after all turning? */
static int is_inward_at_last(const struct solid *solid)
{
    return solid->is_inward != solid->is_flipped;
}

/*
 * Decide which solids to flip, from the largest to the smallest, and set the flags of their parts. A solid that lies in
 * no material is wound outward. One that lies in others is flipped if the innermost of those was, so that a void stays
 * a void.
 */
static void wind_solids(struct solids *all)
{
    struct model *model = all->model;
    if (all->containment_count)
        qsort(all->containments, all->containment_count, sizeof *all->containments, by_rank);
    size_t next = 0;
    for (uint32_t rank = 0; rank < all->count; rank++) {
        struct solid *solid = &all->solids[rank];
        int32_t layers = 0; /* solids around it, less cavities around it: above 0 is in material */
        solid->is_flipped = solid->is_inward;
        for (; next < all->containment_count && all->containments[next].inner == rank; next++) {
            const struct solid *outer = &all->solids[all->containments[next].outer];
            layers += is_inward_at_last(outer) ? -1 : 1;
            solid->is_flipped = outer->is_flipped;
        }
        if (layers < 1)
            solid->is_flipped = solid->is_inward;
        /* The layers of material on the side of its normals. */
        int32_t layers_in_front = layers - is_inward_at_last(solid);
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
        model->inward_parts +=
            (uint32_t)(solid->is_closed && !solid->is_mixed && solid->is_inward && solid->is_flipped);
    }
}

/*
 * Find where a part without an inside (a sheet) lies: *inside is 1 wholly inside of the solid, 0 wholly outside, else
 * -1.
 */
static dpt_result locate_sheet(struct solids *all, struct solid *sheet, struct solid *solid, int *inside)
{
    int touch;
    uint32_t samples = sheet->triangle_count < INSIDE_SAMPLES ? sheet->triangle_count : INSIDE_SAMPLES;
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

/*
 * Does a sheet lie wholly in the material of solids, not in a void? The work is added to *work. *is_inside_material
 * stays 0 for a sheet that is partly inside of a solid.
 */
static dpt_result is_buried(struct solids *all, struct solid *sheet, uint64_t *work, int *is_inside_material)
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

/*
 * Mark the sheets that lie in the material of solids. The solids must be wound already. A sheet that lies on both sides
 * of a solid, or comes after the work has run out, stays unmarked: its side is decided without the solids.
 */
static dpt_result mark_buried_sheets(struct solids *all)
{
    struct model *model = all->model;
    uint64_t work = 0, max_work = model->triangle_count / BURY_SHARE + BURY_MIN;
    for (uint32_t p = 0; all->count > 0 && p < model->part_count && work < max_work; p++) {
        struct part *part = &model->parts[p];
        if (part->flags & MESH_PART_SOLID)
            continue;
        struct solid sheet = { .part = p, .first_in_list = all->part_first[p], .triangle_count = part->triangles };
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

/* Reverse a triangle's winding: corners (0, 1, 2) become (0, 2, 1), so edges 01, 12, 20 become 02, 21, 10. */
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

/* Turn the triangles of all solids. Parts without an inside stay wound as in the source. */
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

/* The distance below which coordinates cannot tell two surfaces apart, m. */
static double touch_distance_of(const struct model *model)
{
    float max_size = 0.0f;
    for (size_t i = 0; i < 3 * (size_t)model->vertex_count; i++)
        max_size = fabsf(model->positions[i]) > max_size ? fabsf(model->positions[i]) : max_size;
    return RESOLUTION * (double)max_size;
}

static dpt_result orient_solids(struct solids *all)
{
    DPT_TRY(find_solids(all));
    DPT_TRY(relate_all(all));
    wind_solids(all);
    DPT_TRY(mark_buried_sheets(all));
    turn_triangles(all);
    return DPT_OK;
}

dpt_result model_solid(struct model *model, const struct compile_context *context)
{
    struct solids all = { .model = model, .context = context, .touch_distance = touch_distance_of(model) };
    all.part_list = model->part_list;
    all.part_first = model->part_first;
    const dpt_result result = orient_solids(&all);
    if (result == DPT_E_MEMORY)
        compile_fail(context, result, (source_location){ 0, 0 }, "memory ran out");
    for (uint32_t i = 0; all.solids && i < all.count; i++)
        cluster_free(&all.solids[i].cluster);
    free(all.solids);
    free(all.containments);
    return result;
}
