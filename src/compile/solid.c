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
    uint32_t first; /* of its triangles in the list */
    uint32_t count;
    int closed;
    int is_solid;
    dpt_result result; /* of finding that out */
    int mixed;         /* wound both ways in the source */
    int inward;        /* as wound in the source, most of it where mixed */
    int flip;          /* is turned as a whole */
    int winding;       /* MESH_PART_WINDING */
    double volume, area;
    struct bounds box;
    struct cluster cluster; /* made when first asked */
};

/* One lies within another: both by their rank. */
struct inside {
    uint32_t solid, in;
};

struct solids {
    struct model *model;
    soup *source;
    const uint32_t *list; /* the model's, by part */
    const uint32_t *first;
    struct solid *solids; /* by rank: the largest first */
    uint32_t count;
    struct inside *inside;
    size_t inside_count, inside_room;
    double reach; /* what is nearer touches */
};

/* The volume that it encloses, as its triangles will agree, its box, and how many triangles are to be turned. */
static uint32_t measure(const struct solids *all, struct solid *solid)
{
    const struct model *model = all->model;
    const uint32_t *list = all->list + solid->first;
    uint32_t turned = 0;
    double six = 0.0;
    vec3 c[3], origin;
    model_corners(model, list[0], c);
    origin = c[0];
    solid->box = bounds_of_corners(c);
    for (uint32_t i = 0; i < solid->count; i++) {
        model_corners(model, list[i], c);
        solid->box = bounds_join(solid->box, bounds_of_corners(c));
        double here = dot(sub(c[0], origin), cross(sub(c[1], origin), sub(c[2], origin)));
        six += model->turn[list[i]] ? -here : here;
        solid->area += 0.5 * length(cross(sub(c[1], c[0]), sub(c[2], c[0])));
        turned += model->turn[list[i]];
    }
    solid->volume = six / 6.0;
    return turned;
}

/* Thinner than its coordinates tell: what it encloses may be all rounding. */
static int is_flat(const struct solid *solid)
{
    double extent = max_of(extent_of(solid->box.low), extent_of(solid->box.high));
    return fabs(solid->volume) <= RESOLUTION * extent * solid->area;
}

static dpt_result need_cluster(struct solids *all, struct solid *solid)
{
    if (solid->cluster.moments)
        return DPT_OK;
    return cluster_build(&solid->cluster, all->model, all->list + solid->first, solid->count);
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
static uint32_t sample(const struct solids *all, const struct solid *solid, uint32_t k,
                       uint32_t samples)
{
    uint32_t share = k * 2654435769u;
    uint32_t at = samples == solid->count ? k : (uint32_t)((uint64_t)share * solid->count >> 32);
    return all->list[solid->first + at];
}

/*
 * Does a part with defects nearly close? Round a closed surface's own triangles the rest of it goes by half a turn,
 * round those of a flat sheet not at all. Its sign tells which way it is wound.
 */
static dpt_result judge(struct solids *all, struct solid *solid)
{
    uint32_t samples = solid->count / SAMPLES_SHARE;
    samples = samples < SAMPLES_MIN ? SAMPLES_MIN : samples;
    samples = samples > SAMPLES_MAX ? SAMPLES_MAX : samples;
    samples = samples > solid->count ? solid->count : samples;
    uint64_t work = 0, most = (uint64_t)SAMPLES_WORK * solid->count;
    double sum = 0.0, total = 0.0;
    DPT_TRY(need_cluster(all, solid));
    for (uint32_t k = 0; k < samples && (k < SAMPLES_MIN / 2 || work < most); k++) {
        uint32_t t = sample(all, solid, k, samples);
        double area;
        vec3 x = centroid_of(all->model, t, &area);
        double rest = cluster_winding(&solid->cluster, x, t, &work);
        sum += area * rest;
        total += area;
    }
    solid->is_solid = fabs(sum) >= SOLID_MIN * total && !is_flat(solid);
    solid->inward = sum < 0.0;
    return DPT_OK;
}

/* A closed part that is wound half and half has no way of its own: outward. */
static void settle_half(const struct solids *all, struct solid *solid, uint32_t turned)
{
    if (2 * (uint64_t)turned != solid->count || !solid->inward)
        return;
    for (uint32_t i = 0; i < solid->count; i++)
        all->model->turn[all->list[solid->first + i]] ^= 1;
    solid->inward = 0;
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

static void weigh(void *context, size_t first, size_t end)
{
    struct solids *all = context;
    for (size_t i = first; i < end; i++) {
        struct solid *solid = &all->solids[i];
        uint32_t turned = measure(all, solid);
        solid->mixed = turned != 0;
        solid->is_solid = solid->closed;
        if (solid->closed) {
            solid->inward = solid->volume < 0.0 && !is_flat(solid);
            settle_half(all, solid, turned);
        } else {
            solid->result = judge(all, solid);
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
    all->solids = model_array(all->source, candidates, sizeof *all->solids);
    if (!all->solids)
        return DPT_E_MEMORY;
    for (uint32_t p = 0; p < model->part_count; p++) {
        const struct part *part = &model->parts[p];
        if (may_be_solid(part))
            all->solids[all->count++] =
                (struct solid){ .part = p,
                                .first = all->first[p],
                                .count = part->triangles,
                                .closed = (part->flags & MESH_PART_CLOSED) != 0,
                                .winding = model->cuts_itself[p] };
    }
    parallel_for(threads, candidates, 1, weigh, all);
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
static dpt_result surfaces_meet(struct solids *all, struct solid *a, struct solid *b, int *meet)
{
    struct solid *few = a->count < b->count ? a : b, *many = few == a ? b : a;
    DPT_TRY(need_cluster(all, many));
    *meet = 0;
    for (uint32_t i = 0; i < few->count && !*meet; i++)
        *meet = cluster_meets(&many->cluster, all->list[few->first + i], all->reach);
    return DPT_OK;
}

static int box_within(const struct bounds *small, const struct bounds *large)
{
    struct bounds both = bounds_join(*small, *large);
    return !memcmp(&both, large, sizeof both);
}

static dpt_result note_inside(struct solids *all, uint32_t solid, uint32_t in)
{
    if (all->inside_count == all->inside_room) {
        size_t room = all->inside_room ? 2 * all->inside_room : 64;
        struct inside *grown = realloc(all->inside, room * sizeof *grown);
        if (!grown)
            return DPT_E_MEMORY;
        all->inside = grown;
        all->inside_room = room;
    }
    all->inside[all->inside_count++] = (struct inside){ solid, in };
    return DPT_OK;
}

/* Two solids whose boxes meet, by rank: `large` is not the smaller one. */
static dpt_result relate(struct solids *all, uint32_t small_rank, uint32_t large_rank)
{
    struct solid *small = &all->solids[small_rank], *large = &all->solids[large_rank];
    int meet;
    DPT_TRY(surfaces_meet(all, small, large, &meet));
    if (meet)
        small->winding = large->winding = 1;
    if (!meet && large->closed && !box_within(&small->box, &large->box))
        return DPT_OK;
    uint32_t samples = meet || !large->closed ? INSIDE_SAMPLES : 1;
    samples = samples < small->count ? samples : small->count;
    uint64_t work = 0;
    double sum = 0.0;
    DPT_TRY(need_cluster(all, large));
    for (uint32_t k = 0; k < samples; k++) {
        uint32_t t = sample(all, small, k, samples);
        vec3 x = centroid_of(all->model, t, NULL);
        double turns = fabs(cluster_winding(&large->cluster, x, DPT_NONE, &work));
        sum += turns;
        if (turns > SURELY_OUTSIDE && turns < SURELY_INSIDE)
            small->winding = 1;
    }
    return sum > 0.5 * samples ? note_inside(all, small_rank, large_rank) : DPT_OK;
}

struct start {
    double low;
    uint32_t rank;
};

static int by_low(const void *a, const void *b)
{
    const struct start *x = a, *y = b;
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

static uint32_t least_triangles(const struct solid *a, const struct solid *b)
{
    return a->count < b->count ? a->count : b->count;
}

/* What the work does not suffice for is decided by winding number, and wound by what is known of it. */
static dpt_result relate_all(struct solids *all)
{
    if (all->count < 2)
        return DPT_OK;
    uint64_t work = 0, most = (uint64_t)RELATE_WORK * all->model->triangle_count;
    struct start *starts = model_array(all->source, all->count, sizeof *starts);
    if (!starts)
        return DPT_E_MEMORY;
    int axis = sweep_axis(all);
    dpt_result result = DPT_OK;
    for (uint32_t i = 0; i < all->count; i++)
        starts[i] = (struct start){ axis_of(all->solids[i].box.low, axis), i };
    qsort(starts, all->count, sizeof *starts, by_low);
    for (uint32_t i = 0; result == DPT_OK && i < all->count; i++) {
        const struct bounds *box = &all->solids[starts[i].rank].box;
        double end = axis_of(box->high, axis) + all->reach;
        for (uint32_t j = i + 1; result == DPT_OK && j < all->count && starts[j].low <= end; j++) {
            uint32_t a = starts[i].rank, b = starts[j].rank;
            if (work++ > most)
                break;
            if (!bounds_meet(box, &all->solids[b].box, all->reach))
                continue;
            work += RELATE_TRIANGLE * (uint64_t)least_triangles(&all->solids[a], &all->solids[b]);
            result = a < b ? relate(all, b, a) : relate(all, a, b);
        }
        if (work > most)
            all->solids[starts[i].rank].winding = 1;
    }
    free(starts);
    return result;
}

static int by_rank(const void *a, const void *b)
{
    const struct inside *x = a, *y = b;
    if (x->solid != y->solid)
        return x->solid < y->solid ? -1 : 1;
    return x->in < y->in ? -1 : x->in > y->in;
}

static int ends_inward(const struct solid *solid)
{
    return solid->inward != solid->flip;
}

/*
 * From the largest to the smallest. What lies in the open is wound outward; what lies in another is turned as that
 * was, the innermost of them, so that a void stays a void.
 */
static void wind_all(struct solids *all)
{
    struct model *model = all->model;
    if (all->inside_count)
        qsort(all->inside, all->inside_count, sizeof *all->inside, by_rank);
    size_t next = 0;
    for (uint32_t rank = 0; rank < all->count; rank++) {
        struct solid *solid = &all->solids[rank];
        int32_t outside = 0;
        solid->flip = solid->inward;
        for (; next < all->inside_count && all->inside[next].solid == rank; next++) {
            const struct solid *in = &all->solids[all->inside[next].in];
            outside += ends_inward(in) ? -1 : 1;
            solid->flip = in->flip;
        }
        if (outside < 1)
            solid->flip = solid->inward;
        int32_t before = outside - ends_inward(solid); /* where its normals point to */
        uint32_t flags = MESH_PART_SOLID;
        if (solid->winding || !solid->closed)
            flags |= MESH_PART_WINDING;
        else if (before > 0)
            flags |= MESH_PART_BURIED;
        struct part *part = &model->parts[solid->part];
        part->flags |= flags;
        model->solid_parts++;
        model->cavities += (uint32_t)ends_inward(solid);
        model->winding_parts += (flags & MESH_PART_WINDING) != 0;
        model->buried_parts += (flags & MESH_PART_BURIED) != 0;
        model->inward_parts +=
            (uint32_t)(solid->closed && !solid->mixed && solid->inward && solid->flip);
    }
}

/* Wholly inside of a solid, wholly outside, or neither: 1, 0, -1. */
static dpt_result place_sheet(struct solids *all, struct solid *sheet, struct solid *solid,
                              int *inside)
{
    int meet;
    uint32_t samples = sheet->count < INSIDE_SAMPLES ? sheet->count : INSIDE_SAMPLES;
    uint32_t in = 0, out = 0;
    uint64_t work = 0;
    DPT_TRY(surfaces_meet(all, sheet, solid, &meet));
    *inside = meet ? -1 : 0;
    if (meet || !box_within(&sheet->box, &solid->box))
        return DPT_OK;
    DPT_TRY(need_cluster(all, solid));
    for (uint32_t k = 0; k < samples; k++) {
        vec3 x = centroid_of(all->model, sample(all, sheet, k, samples), NULL);
        double turns = fabs(cluster_winding(&solid->cluster, x, DPT_NONE, &work));
        in += turns >= SURELY_INSIDE;
        out += turns <= SURELY_OUTSIDE;
    }
    *inside = in < samples && out < samples ? -1 : in > 0;
    return DPT_OK;
}

/* Is a part that has no inside of its own in another one's, in its material and not in its void? */
static dpt_result is_buried(struct solids *all, struct solid *sheet, uint64_t *asked, int *buried)
{
    int32_t material = 0;
    *buried = 0;
    *asked += all->count / BURY_BOXES;
    for (uint32_t i = 0; i < all->count; i++) {
        struct solid *solid = &all->solids[i];
        int inside;
        if (!bounds_meet(&sheet->box, &solid->box, all->reach))
            continue;
        *asked += sheet->count;
        DPT_TRY(place_sheet(all, sheet, solid, &inside));
        if (inside < 0)
            return DPT_OK;
        if (inside)
            material += ends_inward(solid) ? -1 : 1;
    }
    *buried = material > 0;
    return DPT_OK;
}

/* After the solids are wound. What is not asked, or lies on both sides, is judged by itself. */
static dpt_result bury_sheets(struct solids *all)
{
    struct model *model = all->model;
    uint64_t asked = 0, most = model->triangle_count / BURY_SHARE + BURY_MIN;
    for (uint32_t p = 0; all->count > 0 && p < model->part_count && asked < most; p++) {
        struct part *part = &model->parts[p];
        if (part->flags & MESH_PART_SOLID)
            continue;
        struct solid sheet = { .part = p, .first = all->first[p], .count = part->triangles };
        int buried;
        measure(all, &sheet);
        dpt_result result = is_buried(all, &sheet, &asked, &buried);
        cluster_free(&sheet.cluster);
        DPT_TRY(result);
        if (buried)
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
static void turn_all(struct solids *all)
{
    struct model *model = all->model;
    for (uint32_t rank = 0; rank < all->count; rank++) {
        const struct solid *solid = &all->solids[rank];
        for (uint32_t i = 0; i < solid->count; i++) {
            uint32_t t = all->list[solid->first + i];
            if (model->turn[t] != solid->flip)
                turn_triangle(model, t);
        }
        if (solid->mixed)
            model->parts[solid->part].flags |= MESH_PART_WOUND;
    }
}

/* What is as near as coordinates can tell touches. */
static double touching(const struct model *model)
{
    float most = 0.0f;
    for (size_t i = 0; i < 3 * (size_t)model->vertex_count; i++)
        most = fabsf(model->positions[i]) > most ? fabsf(model->positions[i]) : most;
    return RESOLUTION * (double)most;
}

dpt_result model_solid(struct model *model, soup *source)
{
    struct solids all = { .model = model, .source = source, .reach = touching(model) };
    all.list = model->part_list;
    all.first = model->part_first;
    dpt_result result = find_solids(&all);
    if (result == DPT_OK)
        result = relate_all(&all);
    if (result == DPT_OK) {
        wind_all(&all);
        result = bury_sheets(&all);
    }
    if (result == DPT_OK)
        turn_all(&all);
    if (result == DPT_E_MEMORY)
        soup_fail(source, result, (source_place){ 0, 0 }, "memory ran out");
    for (uint32_t i = 0; all.solids && i < all.count; i++)
        cluster_free(&all.solids[i].cluster);
    free(all.solids);
    free(all.inside);
    return result;
}
