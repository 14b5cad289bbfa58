/* SPDX-License-Identifier: BSD-3-Clause */
/* Write the file (mesh_format.h, docs/format.md). The same mesh gives the same bytes on every machine. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/byte_order.h"
#include "base/crc32.h"
#include "base/vec3.h"
#include "compile/cluster.h"
#include "compile/compile_context.h"
#include "compile/model.h"
#include "mesh/mesh_swap.h"

/* The least work for a thread of its own: leaves, and bytes of sections. */
#define LEAVES_MIN  256u
#define SECTION_MIN ((size_t)1 << 18)

/* A box in the filter's frame; that of the mesh's own frame in set_frame. */
struct node_box {
    double low[3], high[3];
};

/* What all pieces of a parallel loop share. */
struct writing {
    struct dpt_mesh mesh; /* the header */
    const struct model *model;
    char *bytes;            /* the file */
    struct node_box *boxes; /* of the leaves */
    struct winding_moment *leaf_moments;
    struct crc32 crc;
};

static const struct node_box empty_box = { { HUGE_VAL, HUGE_VAL, HUGE_VAL }, { -HUGE_VAL, -HUGE_VAL, -HUGE_VAL } };

static void box_add(struct node_box *box, const double *low, const double *high)
{
    for (int k = 0; k < 3; k++) {
        box->low[k] = min_of(box->low[k], low[k]);
        box->high[k] = max_of(box->high[k], high[k]);
    }
}

/*
 * Set the filter's frame: the centre of the mesh's box, and the power of two that scales the largest half width into
 * 0.5..1.
 */
static void set_frame(struct dpt_mesh *mesh, const struct model *model)
{
    struct node_box box = empty_box;
    for (size_t v = 0; v < model->vertex_count; v++) {
        vec3 x = vec3_of_float(model->positions + 3 * v);
        box_add(&box, &x.x, &x.x);
    }
    double half_width = 0.0;
    for (int k = 0; k < 3; k++) {
        mesh->box_min[k] = box.low[k];
        mesh->box_max[k] = box.high[k];
        mesh->filter_centre[k] = 0.5 * (box.low[k] + box.high[k]);
        half_width = max_of(half_width, 0.5 * (box.high[k] - box.low[k]));
    }
    int exponent;
    frexp(half_width, &exponent);
    mesh->filter_scale = ldexp(1.0, -exponent);
}

static void set_counts(struct dpt_mesh *mesh, const struct model *model, const soup *source)
{
    memcpy(mesh->magic, MESH_MAGIC, sizeof mesh->magic);
    mesh->byte_order = MESH_BYTE_ORDER;
    const double *origin = source->origin;
    const int is_moved = origin[0] != 0.0 || origin[1] != 0.0 || origin[2] != 0.0;
    mesh->version = is_moved || model->cell_count ? MESH_VERSION : MESH_VERSION_PLAIN;
    mesh->header_bytes = mesh_header_bytes(mesh->version);
    mesh->section_count = mesh_section_count(mesh->version);
    mesh->writer_version = DPT_VERSION_NUMBER;
    mesh->triangles = model->triangle_count;
    mesh->vertices = model->vertex_count;
    mesh->source_triangles = model->source_triangle_count;
    mesh->source_vertices = model->source_vertex_count;
    mesh->parts = model->part_count;
    mesh->leaves = (model->triangle_count + LANES - 1) / LANES;
    mesh->dropped_degenerate = model->dropped_degenerate;
    mesh->dropped_duplicate = model->dropped_duplicate;
    mesh->unused_vertices = model->unused_vertices;
    mesh->concave_polygons = source->concave_polygons;
    mesh->open_edges = model->open_edges;
    mesh->nonmanifold_edges = model->nonmanifold_edges;
    mesh->wrong_way_edges = model->wrong_way_edges;
    mesh->closed_components = model->closed_parts;
    mesh->inward_components = model->inward_parts;
    mesh->turned_triangles = model->turned_triangles;
    struct mesh_tail tail = { .solid_components = model->solid_parts,
                              .cavities = model->cavities,
                              .winding_components = model->winding_parts,
                              .buried_components = model->buried_parts,
                              .crease_edges = model->crease_edges,
                              .normalless_vertices = model->normalless_vertices,
                              .crease = model->crease,
                              .self_intersections = model->self_intersections,
                              .self_intersections_more = model->self_intersections_more,
                              .nodes = model->node_count,
                              .outside_vertices = model->outside_vertices,
                              .outside_distance = model->outside_distance,
                              .spring_nodes = model->spring_nodes,
                              .springs = model->spring_count,
                              .spring_entries = model->spring_entries,
                              .fixed_nodes = model->fixed_nodes,
                              .viscosity = model->viscosity,
                              .spring_mass = model->mass,
                              .poisson = model->poisson,
                              .stable_step = model->stable_step,
                              .cell_size = model->cell_size,
                              .cells = model->cell_count };
    memcpy(tail.origin, origin, sizeof tail.origin);
    memcpy(tail.self_intersection, model->self_intersection, sizeof model->self_intersection);
    if (mesh->version == MESH_VERSION)
        mesh->tail = tail;
    else
        memcpy((char *)mesh + mesh_tail_offset(MESH_VERSION_PLAIN), &tail, mesh_tail_bytes(MESH_VERSION_PLAIN));
    mesh->scale = source->context->scale;
    mesh->rounding = source->rounding;
}

static void set_sections(struct dpt_mesh *mesh, uint64_t nodes)
{
    uint64_t end = mesh->header_bytes;
    struct mesh_section *section = mesh->section;
    for (int id = 0; id < (int)mesh->section_count; id++, section++) {
        mesh_section_name(id, section->name);
        section->offset = mesh_aligned(end);
        section->bytes = 4 * mesh_section_words(mesh, id, nodes);
        end = section->offset + section->bytes;
    }
    mesh->bytes = end;
}

/* Transform a position from the mesh's frame to the filter's, in double. */
static void to_filter_frame(const struct dpt_mesh *mesh, const float *position, double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = (position[k] - mesh->filter_centre[k]) * mesh->filter_scale;
}

/* Write the leaves, and compute their boxes. Empty lanes of the last leaf repeat its last triangle. */
static void fill_leaves(void *context, size_t first, size_t end)
{
    const struct writing *writing = context;
    const struct dpt_mesh *mesh = &writing->mesh;
    const struct model *model = writing->model;
    float *leaves = (float *)(void *)(writing->bytes + mesh->section[MESH_LEAVES].offset);
    for (uint32_t leaf = (uint32_t)first; leaf < end; leaf++) {
        float *block = leaves + (size_t)leaf * MESH_LEAF_WORDS;
        struct node_box box = empty_box;
        for (uint32_t lane = 0; lane < LANES; lane++) {
            uint32_t t = leaf * LANES + lane;
            t = t < mesh->triangles ? t : mesh->triangles - 1;
            for (uint32_t k = 0; k < 3; k++) {
                double x[3];
                to_filter_frame(mesh, model->positions + 3 * (size_t)model->corners[3 * (size_t)t + k], x);
                box_add(&box, x, x);
                for (uint32_t axis = 0; axis < 3; axis++)
                    block[(3 * k + axis) * LANES + lane] = (float)x[axis];
            }
        }
        writing->boxes[leaf] = box;
    }
}

/* Store centre and half width in float. The half width is rounded up, so that the stored box holds `box`. */
static void put_box(float *block, uint32_t lane, const struct node_box *box)
{
    for (uint32_t k = 0; k < 3; k++) {
        float centre = (float)(0.5 * (box->low[k] + box->high[k]));
        double half_width = max_of(box->high[k] - (double)centre, (double)centre - box->low[k]);
        float half_float = (float)half_width;
        block[k * LANES + lane] = centre;
        block[(3 + k) * LANES + lane] =
            (double)half_float < half_width ? nextafterf(half_float, HUGE_VALF) : half_float;
    }
}

/*
 * Write the boxes of all levels, from the leaves up. `boxes` holds the level below, and is overwritten level by level.
 */
static void fill_boxes(const struct dpt_mesh *mesh, float *nodes, struct node_box *boxes, const uint32_t *count)
{
    for (uint32_t level = 1; level <= mesh->levels; level++)
        for (uint32_t node = 0; node < count[level]; node++, nodes += MESH_BOX_WORDS) {
            struct node_box box = empty_box;
            for (uint32_t lane = 0; lane < LANES; lane++) {
                uint32_t child = node * LANES + lane;
                child = child < count[level - 1] ? child : count[level - 1] - 1;
                put_box(nodes, lane, &boxes[child]);
                box_add(&box, boxes[child].low, boxes[child].high);
            }
            boxes[node] = box;
        }
}

/* The triangles of a leaf that belong to solid parts: returns them as bits, and sets *moment to their moments. */
static uint32_t solid_lanes(const struct dpt_mesh *mesh, const struct model *model, uint32_t leaf,
                            struct winding_moment *moment)
{
    struct winding_moment moments[LANES];
    uint32_t lanes = 0, count = 0;
    for (uint32_t lane = 0; lane < LANES && leaf * LANES + lane < mesh->triangles; lane++) {
        uint32_t t = leaf * LANES + lane;
        double x[3][3];
        if (!(model->parts[model->part_of[t]].flags & MESH_PART_SOLID))
            continue;
        for (uint32_t k = 0; k < 3; k++)
            to_filter_frame(mesh, model->positions + 3 * (size_t)model->corners[3 * (size_t)t + k], x[k]);
        moments[count++] = moment_of_triangle(vec3_of(x[0]), vec3_of(x[1]), vec3_of(x[2]));
        lanes |= 1u << lane;
    }
    *moment = moment_of_sets(moments, count);
    return lanes;
}

/* Write the last words of the `moments` section: one for each leaf. */
static void fill_solid_lanes(void *context, size_t first, size_t end)
{
    const struct writing *writing = context;
    const struct dpt_mesh *mesh = &writing->mesh;
    const struct mesh_section *section = &mesh->section[MESH_MOMENTS];
    uint32_t *lanes = (uint32_t *)(void *)(writing->bytes + section->offset + section->bytes);
    lanes -= mesh->leaves;
    for (uint32_t leaf = (uint32_t)first; leaf < end; leaf++)
        lanes[leaf] = solid_lanes(mesh, writing->model, leaf, &writing->leaf_moments[leaf]);
}

/* Write the moments of all levels, from the leaves up. `moments` is overwritten like the boxes of fill_boxes. */
static void fill_moments(const struct dpt_mesh *mesh, float *nodes, struct winding_moment *moments,
                         const uint32_t *count)
{
    const struct winding_moment none = { .area = 0.0 };
    for (uint32_t level = 1; level <= mesh->levels; level++)
        for (uint32_t node = 0; node < count[level]; node++, nodes += MESH_MOMENT_WORDS) {
            uint32_t first = node * LANES, children = count[level - 1] - first;
            children = children < LANES ? children : LANES;
            for (uint32_t lane = 0; lane < LANES; lane++)
                moment_store(lane < children ? &moments[first + lane] : &none, nodes + lane);
            moments[node] = moment_of_sets(moments + first, children);
        }
}

/* The content of a section that the model holds ready; NULL for the other sections. */
static const void *content_of(const struct model *model, int id)
{
    const struct {
        int id;
        const void *content;
    } ready[] = {
        { MESH_VERTICES, model->positions },
        { MESH_TRIANGLES, model->corners },
        { MESH_NEIGHBOURS, model->neighbours },
        { MESH_FAN_FIRST, model->fan_first },
        { MESH_FANS, model->fans },
        { MESH_PARTS, model->part_of },
        { MESH_PART_TABLE, model->parts },
        { MESH_SOURCES, model->sources },
        { MESH_PLACES, model->places },
        { MESH_NORMALS, model->normals },
        { MESH_FLAGS, model->flags },
        { MESH_VERTEX_SOURCES, model->vertex_sources },
        { MESH_EMBED_NODES, model->embedding_nodes },
        { MESH_EMBED_WEIGHTS, model->embedding_weights },
        { MESH_SPRING_REST, model->spring_rest },
        { MESH_SPRING_MASS, model->spring_mass },
        { MESH_SPRING_DRAG, model->spring_drag },
        { MESH_SPRING_FIRST, model->spring_first },
        { MESH_SPRING_ENDS, model->spring_ends },
        { MESH_SPRING_STIFFNESS, model->spring_stiffness },
        { MESH_SPRING_LENGTH, model->spring_length },
        { MESH_CELL_NODES, model->cell_nodes },
        { MESH_CELL_STIFFNESS, model->cell_stiffness },
    };
    for (size_t i = 0; i < sizeof ready / sizeof *ready; i++)
        if (ready[i].id == id)
            return ready[i].content;
    return NULL;
}

/*
 * Finish the sections whose middle byte is in first..end: copy content from the model, swap to the file's byte order,
 * and compute the checksum.
 */
static void seal_sections(void *context, size_t first, size_t end)
{
    struct writing *writing = context;
    for (int id = 0; id < MESH_SECTION_COUNT && id < (int)writing->mesh.section_count; id++) {
        struct mesh_section *section = &writing->mesh.section[id];
        char *bytes = writing->bytes + section->offset;
        uint64_t middle = section->offset + section->bytes / 2;
        if (middle < first || middle >= end)
            continue;
        if (content_of(writing->model, id))
            memcpy(bytes, content_of(writing->model, id), (size_t)section->bytes);
        if (!host_is_little())
            mesh_swap4(bytes, section->bytes / 4);
        section->crc32 = crc32_of(&writing->crc, bytes, (size_t)section->bytes);
    }
}

static void seal_header(struct dpt_mesh *mesh, const struct crc32 *crc)
{
    const int swap = !host_is_little();
    const uint32_t size = mesh->header_bytes;
    if (swap)
        mesh_swap_header(mesh, mesh->version);
    uint32_t sum = crc32_of(crc, mesh, size);
    if (swap)
        mesh_swap4(&sum, 1);
    mesh->header_crc32 = sum;
}

/* The address to free is stored just before the block. */
char *compiled_block(size_t size)
{
    char *raw = calloc(1, size + MESH_ALIGN + sizeof raw);
    if (!raw)
        return NULL;
    char *bytes = (char *)(uintptr_t)mesh_aligned((uintptr_t)raw + sizeof raw);
    memcpy(bytes - sizeof raw, &raw, sizeof raw);
    return bytes;
}

void dpt_compiled_free(dpt_compiled *compiled)
{
    if (!compiled || !compiled->bytes)
        return;
    char *raw;
    memcpy(&raw, (char *)compiled->bytes - sizeof raw, sizeof raw);
    free(raw);
    compiled->bytes = NULL;
    compiled->size = 0;
}

dpt_result model_write(const struct model *model, soup *source, uint64_t source_size, uint64_t source_hash,
                       dpt_compiled *out)
{
    struct writing writing;
    struct dpt_mesh *mesh = &writing.mesh;
    uint32_t count[MESH_LEVELS_MAX + 1];
    uint64_t nodes;
    memset(&writing, 0, sizeof writing);
    writing.model = model;
    set_counts(mesh, model, source);
    set_frame(mesh, model);
    mesh->levels = mesh_levels(mesh->leaves, count, &nodes);
    mesh->source_bytes = source_size;
    mesh->source_hash = source_hash;
    set_sections(mesh, nodes);

    const uint32_t threads = source->context->threads, winding = model->winding_parts;
    struct node_box *boxes = writing.boxes = compile_alloc(source->context, mesh->leaves, sizeof *boxes);
    struct winding_moment *moments = writing.leaf_moments =
        compile_alloc(source->context, winding ? mesh->leaves : 0, sizeof *moments);
    char *bytes = boxes && moments && mesh->bytes <= SIZE_MAX / 2 ? compiled_block((size_t)mesh->bytes) : NULL;
    if (!bytes) {
        free(boxes);
        free(moments);
        return compile_fail(source->context, DPT_E_MEMORY, (source_location){ 0, 0 }, "memory ran out");
    }
    writing.bytes = bytes;
    parallel_for(threads, mesh->leaves, LEAVES_MIN, fill_leaves, &writing);
    fill_boxes(mesh, (float *)(void *)(bytes + mesh->section[MESH_BOXES].offset), boxes, count);
    if (winding) {
        parallel_for(threads, mesh->leaves, LEAVES_MIN, fill_solid_lanes, &writing);
        fill_moments(mesh, (float *)(void *)(bytes + mesh->section[MESH_MOMENTS].offset), moments, count);
    }
    free(boxes);
    free(moments);
    out->size = (size_t)mesh->bytes;
    crc32_init(&writing.crc);
    parallel_for(threads, out->size, SECTION_MIN, seal_sections, &writing);
    const uint32_t header_bytes = mesh->header_bytes;
    seal_header(mesh, &writing.crc);
    memcpy(bytes, mesh, header_bytes);
    out->bytes = bytes;
    return DPT_OK;
}
