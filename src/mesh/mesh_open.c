/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Verify once, trust afterwards. Everything that a search uses as an index is checked here, whether or not the
 * checksums match. So a forged file can cause wrong answers, but never a read out of bounds.
 */
#include "base/crc32.h"
#include "base/return_if_error.h"
#include "base/sized.h"
#include "base/vec3.h"
#include "dynpoint/mesh.h"
#include "mesh/mesh_swap.h"

static dpt_result fail(dpt_mesh_fault *fault, dpt_result code, uint64_t byte, int section)
{
    if (fault) {
        dpt_mesh_fault own = { .code = code, .byte = byte };
        mesh_section_name(section, own.section);
        sized_write(fault, fault->size, &own, sizeof own);
    }
    return code;
}

static dpt_result fail_at(dpt_mesh_fault *fault, dpt_result code, const struct dpt_mesh *mesh, int id, uint64_t word)
{
    return fail(fault, code, mesh->section[id].offset + 4 * word, id);
}

/* Where a field of the tail stands in a file of this version. */
static uint64_t tail_at(const struct dpt_mesh *mesh, size_t field)
{
    return mesh_tail_offset(mesh->version) + field;
}

/* Version and lengths of a header that is in the host's byte order. */
static dpt_result check_header(const struct dpt_mesh *mesh, size_t size, dpt_mesh_fault *fault)
{
    if (mesh->version > MESH_VERSION)
        return fail(fault, DPT_E_VERSION, offsetof(struct dpt_mesh, version), MESH_HEADER);
    if (mesh->version == 0)
        return fail(fault, DPT_E_LAYOUT, offsetof(struct dpt_mesh, version), MESH_HEADER);
    if (size < mesh_header_bytes(mesh->version))
        return fail(fault, DPT_E_TRUNCATED, size, MESH_HEADER);
    if (mesh->header_bytes != mesh_header_bytes(mesh->version))
        return fail(fault, DPT_E_LAYOUT, offsetof(struct dpt_mesh, header_bytes), MESH_HEADER);
    if (mesh->section_count != mesh_section_count(mesh->version))
        return fail(fault, DPT_E_LAYOUT, offsetof(struct dpt_mesh, section_count), MESH_HEADER);
    if (mesh->reserved)
        return fail(fault, DPT_E_LAYOUT, offsetof(struct dpt_mesh, reserved), MESH_HEADER);
    if (size < mesh->bytes)
        return fail(fault, DPT_E_TRUNCATED, size, MESH_HEADER);
    if (size > mesh->bytes)
        return fail(fault, DPT_E_TRAILING, mesh->bytes, MESH_HEADER);
    return DPT_OK;
}

/* Springs are between vertices, or between the nodes in which these are embedded. */
static int spring_counts_fit(const struct dpt_mesh *mesh)
{
    const struct mesh_tail tail = mesh_tail(mesh);
    if (!tail.spring_nodes)
        return !tail.springs && !tail.spring_entries && !tail.fixed_nodes && !tail.cells;
    return tail.cells <= MESH_CELLS_MAX && tail.spring_nodes == (tail.nodes ? tail.nodes : mesh->vertices) &&
           tail.spring_entries <= MESH_SPRING_ENTRIES_MAX && tail.fixed_nodes <= tail.spring_nodes;
}

/* Sections follow each other without gap or overlap, and are as long as the counts say. */
static dpt_result check_layout(const struct dpt_mesh *mesh, dpt_mesh_fault *fault)
{
    uint32_t count[MESH_LEVELS_MAX + 1];
    uint64_t nodes, end = mesh->header_bytes;
    uint64_t leaves = ((uint64_t)mesh->triangles + LANES - 1) / LANES;
    if (!mesh->triangles || mesh->leaves != leaves || mesh->triangles > mesh->source_triangles ||
        mesh->triangles > UINT32_MAX / 3 || mesh->vertices > INT32_MAX ||
        (mesh->version > 4 && mesh->vertices > mesh->source_vertices) ||
        mesh->levels != mesh_levels(mesh->leaves, count, &nodes))
        return fail(fault, DPT_E_LAYOUT, offsetof(struct dpt_mesh, triangles), MESH_HEADER);
    if (mesh_tail(mesh).nodes > INT32_MAX || mesh_tail(mesh).outside_vertices > mesh->vertices)
        return fail(fault, DPT_E_LAYOUT, tail_at(mesh, offsetof(struct mesh_tail, nodes)), MESH_HEADER);
    if (!spring_counts_fit(mesh))
        return fail(fault, DPT_E_LAYOUT, tail_at(mesh, offsetof(struct mesh_tail, spring_nodes)), MESH_HEADER);
    for (int id = 0; id < (int)mesh->section_count; id++) {
        const struct mesh_section *section = &mesh->section[id];
        uint64_t at = (uint64_t)((const char *)section - (const char *)mesh);
        char name[16];
        mesh_section_name(id, name);
        if (memcmp(section->name, name, sizeof name) || section->offset != mesh_aligned(end) ||
            section->bytes != 4 * mesh_section_words(mesh, id, nodes) || section->reserved[0] || section->reserved[1] ||
            section->reserved[2])
            return fail(fault, DPT_E_LAYOUT, at, id);
        end = section->offset + section->bytes;
        if (end > mesh->bytes)
            return fail(fault, DPT_E_TRUNCATED, mesh->bytes, id);
    }
    if (end != mesh->bytes)
        return fail(fault, DPT_E_LAYOUT, end, MESH_HEADER);
    return DPT_OK;
}

/* `bytes` is the file in its own byte order; its header has `size` bytes. */
static dpt_result check_header_crc(const void *bytes, size_t size, const struct crc32 *crc, uint32_t expected,
                                   dpt_mesh_fault *fault)
{
    struct dpt_mesh header;
    memcpy(&header, bytes, size);
    header.header_crc32 = 0;
    if (crc32_of(crc, &header, size) != expected)
        return fail(fault, DPT_E_CHECKSUM, 0, MESH_HEADER);
    return DPT_OK;
}

/* `mesh` is the header in the host's byte order, `bytes` the file in its own. */
static dpt_result check_sections_crc(const struct dpt_mesh *mesh, const unsigned char *bytes, const struct crc32 *crc,
                                     dpt_mesh_fault *fault)
{
    uint64_t end = mesh->header_bytes;
    for (int id = 0; id < (int)mesh->section_count; id++) {
        const struct mesh_section *section = &mesh->section[id];
        for (; end < section->offset; end++)
            if (bytes[end])
                return fail(fault, DPT_E_LAYOUT, end, MESH_PADDING);
        if (crc32_of(crc, bytes + section->offset, (size_t)section->bytes) != section->crc32)
            return fail_at(fault, DPT_E_CHECKSUM, mesh, id, 0);
        end = section->offset + section->bytes;
    }
    return DPT_OK;
}

/*
 * Every word of a section is below `limit`, or is a code: at least `first_code`, which is 0 where there are no codes.
 */
static dpt_result check_indices(const struct dpt_mesh *mesh, int id, uint64_t limit, uint32_t first_code,
                                dpt_mesh_fault *fault)
{
    const uint32_t *word = mesh_words(mesh, id);
    uint64_t count = mesh->section[id].bytes / 4;
    for (uint64_t i = 0; i < count; i++)
        if (word[i] >= limit && (!first_code || word[i] < first_code))
            return fail_at(fault, DPT_E_INDEX, mesh, id, i);
    return DPT_OK;
}

static dpt_result check_fans(const struct dpt_mesh *mesh, dpt_mesh_fault *fault)
{
    const uint32_t *first = mesh_words(mesh, MESH_FAN_FIRST);
    for (uint32_t v = 0; v < mesh->vertices; v++)
        if (first[v] > first[v + 1])
            return fail_at(fault, DPT_E_INDEX, mesh, MESH_FAN_FIRST, v + 1);
    if (first[0] != 0)
        return fail_at(fault, DPT_E_INDEX, mesh, MESH_FAN_FIRST, 0);
    if (first[mesh->vertices] != 3 * (uint64_t)mesh->triangles)
        return fail_at(fault, DPT_E_INDEX, mesh, MESH_FAN_FIRST, mesh->vertices);
    return DPT_OK;
}

/* Source numbers and places are each other's inverse: users look up the triangles that a search reports. */
static dpt_result check_sources(const struct dpt_mesh *mesh, dpt_mesh_fault *fault)
{
    const uint32_t *source = mesh_words(mesh, MESH_SOURCES);
    const uint32_t *place = mesh_words(mesh, MESH_PLACES);
    for (uint32_t t = 0; t < mesh->triangles; t++)
        if (place[source[t]] != t)
            return fail_at(fault, DPT_E_INDEX, mesh, MESH_PLACES, source[t]);
    return DPT_OK;
}

/* The first `count` words of a section are floats of at most `limit` in size. */
static dpt_result check_some_floats(const struct dpt_mesh *mesh, int id, uint64_t count, float limit,
                                    dpt_mesh_fault *fault)
{
    const float *word = mesh_floats(mesh, id);
    for (uint64_t i = 0; i < count; i++)
        if (!(fabsf(word[i]) <= limit))
            return fail_at(fault, DPT_E_FINITE, mesh, id, i);
    return DPT_OK;
}

static dpt_result check_floats(const struct dpt_mesh *mesh, int id, float limit, dpt_mesh_fault *fault)
{
    return check_some_floats(mesh, id, mesh->section[id].bytes / 4, limit, fault);
}

/* All vertices are in the header's box: rounding is judged by its size. */
static dpt_result check_box(const struct dpt_mesh *mesh, dpt_mesh_fault *fault)
{
    const float *word = mesh_floats(mesh, MESH_VERTICES);
    for (size_t i = 0; i < 3 * (size_t)mesh->vertices; i++)
        if (!(word[i] >= mesh->box_min[i % 3] && word[i] <= mesh->box_max[i % 3]))
            return fail_at(fault, DPT_E_FINITE, mesh, MESH_VERTICES, i);
    return DPT_OK;
}

/* The moments are finite, and the words behind them name only lanes that hold a triangle. */
static dpt_result check_moments(const struct dpt_mesh *mesh, dpt_mesh_fault *fault)
{
    const uint32_t *lanes;
    if (!mesh_moments(mesh, &lanes))
        return DPT_OK;
    uint64_t floats = mesh->section[MESH_MOMENTS].bytes / 4 - mesh->leaves;
    DPT_TRY(check_some_floats(mesh, MESH_MOMENTS, floats, 1e30f, fault));
    for (uint32_t leaf = 0; leaf < mesh->leaves; leaf++)
        if (lanes[leaf] & ~lanes_of(mesh->triangles - leaf * LANES))
            return fail_at(fault, DPT_E_INDEX, mesh, MESH_MOMENTS, floats + leaf);
    return DPT_OK;
}

static dpt_result check_numbers(const struct dpt_mesh *mesh, dpt_mesh_fault *fault)
{
    const double limit = 2.0 * DPT_COORDINATE_MAX;
    const struct mesh_tail tail = mesh_tail(mesh);
    if (!vec3_within(mesh->box_min, limit) || !vec3_within(mesh->box_max, limit) ||
        !vec3_within(mesh->filter_centre, limit) || !within(mesh->filter_scale, 1e300) || !(mesh->filter_scale > 0.0) ||
        !within(mesh->scale, 1e300) || !within(mesh->rounding, 1e300))
        return fail(fault, DPT_E_FINITE, offsetof(struct dpt_mesh, scale), MESH_HEADER);
    if (!(tail.crease >= 0.0 && tail.crease <= 4.0))
        return fail(fault, DPT_E_FINITE, tail_at(mesh, offsetof(struct mesh_tail, crease)), MESH_HEADER);
    if (!(tail.outside_distance >= 0.0 && tail.outside_distance <= 2.0 * limit))
        return fail(fault, DPT_E_FINITE, tail_at(mesh, offsetof(struct mesh_tail, outside_distance)), MESH_HEADER);
    if (!vec3_within(tail.origin, MESH_ORIGIN_MAX))
        return fail(fault, DPT_E_FINITE, tail_at(mesh, offsetof(struct mesh_tail, origin)), MESH_HEADER);
    return DPT_OK;
}

/* The pair of triangles that cut each other has two source numbers, or none. */
static dpt_result check_example(const struct dpt_mesh *mesh, dpt_mesh_fault *fault)
{
    const struct mesh_tail tail = mesh_tail(mesh);
    const uint32_t *pair = tail.self_intersection, count = mesh->source_triangles;
    if ((pair[0] >= count || pair[1] >= count) && (pair[0] & pair[1]) != DPT_NONE)
        return fail(fault, DPT_E_INDEX, tail_at(mesh, offsetof(struct mesh_tail, self_intersection)), MESH_HEADER);
    return DPT_OK;
}

/* A vertex's weights are floats of bounded size, and their sum is 1: the first of four that are not is named. */
static dpt_result check_weights(const struct dpt_mesh *mesh, dpt_mesh_fault *fault)
{
    const float *w = mesh_floats(mesh, MESH_EMBED_WEIGHTS);
    uint64_t count = mesh->section[MESH_EMBED_WEIGHTS].bytes / 4;
    DPT_TRY(check_floats(mesh, MESH_EMBED_WEIGHTS, MESH_WEIGHT_MAX, fault));
    for (uint64_t i = 0; i < count; i += 4) {
        const double sum = (double)w[i] + (double)w[i + 1] + (double)w[i + 2] + (double)w[i + 3];
        if (!(fabs(sum - 1.0) <= MESH_WEIGHT_SUM))
            return fail_at(fault, DPT_E_FINITE, mesh, MESH_EMBED_WEIGHTS, i);
    }
    return DPT_OK;
}

/* What a program that moves the vertices needs. */
static dpt_result check_driving(const struct dpt_mesh *mesh, dpt_mesh_fault *fault)
{
    if (mesh->version < 5)
        return DPT_OK;
    DPT_TRY(check_indices(mesh, MESH_VERTEX_SOURCES, mesh->source_vertices, 0, fault));
    DPT_TRY(check_indices(mesh, MESH_EMBED_NODES, mesh_tail(mesh).nodes, 0, fault));
    return check_weights(mesh, fault);
}

/* A number of a net that is there: 0 is allowed only where it means something. */
static int is_spring_number(float x)
{
    return x >= MESH_SPRING_MIN && x <= MESH_SPRING_MAX;
}

static dpt_result check_nodes(const struct dpt_mesh *mesh, const struct spring_net *net, dpt_mesh_fault *fault)
{
    uint32_t fixed = 0;
    DPT_TRY(check_floats(mesh, MESH_SPRING_REST, 2.0f * (float)DPT_COORDINATE_MAX, fault));
    for (uint32_t i = 0; i < net->nodes; i++) {
        if (net->mass[i] != 0.0f && !is_spring_number(net->mass[i]))
            return fail_at(fault, DPT_E_FINITE, mesh, MESH_SPRING_MASS, i);
        fixed += net->mass[i] == 0.0f;
    }
    for (uint32_t i = 0; i < net->nodes; i++)
        if (!(net->drag[i] >= 0.0f && net->drag[i] <= MESH_DAMPING_MAX))
            return fail_at(fault, DPT_E_FINITE, mesh, MESH_SPRING_DRAG, i);
    if (fixed != mesh_tail(mesh).fixed_nodes)
        return fail(fault, DPT_E_FINITE, tail_at(mesh, offsetof(struct mesh_tail, fixed_nodes)), MESH_HEADER);
    return DPT_OK;
}

static dpt_result check_slices(const struct dpt_mesh *mesh, const struct spring_net *net, dpt_mesh_fault *fault)
{
    const uint32_t *first = net->first;
    for (uint32_t s = 0; s < net->slices; s++)
        if (first[s] > first[s + 1] || first[s + 1] - first[s] > MESH_SLICE_ENTRIES_MAX)
            return fail_at(fault, DPT_E_INDEX, mesh, MESH_SPRING_FIRST, s + 1);
    if (first[0] != 0)
        return fail_at(fault, DPT_E_INDEX, mesh, MESH_SPRING_FIRST, 0);
    if (first[net->slices] != mesh_tail(mesh).spring_entries)
        return fail_at(fault, DPT_E_INDEX, mesh, MESH_SPRING_FIRST, net->slices);
    return DPT_OK;
}

/* The first word of a slice's entries. */
static uint32_t first_word(const struct spring_net *net, uint32_t slice)
{
    return net->first[slice] * LANES;
}

/* Neighbours ascend along a row, and are nodes; a lane without a spring names its own. */
static dpt_result check_rows(const struct dpt_mesh *mesh, const struct spring_net *net, dpt_mesh_fault *fault)
{
    for (uint32_t s = 0; s < net->slices; s++) {
        uint64_t lowest[LANES] = { 0 };
        for (uint32_t e = first_word(net, s); e < first_word(net, s + 1); e++) {
            const uint32_t lane = e % LANES, node = s * LANES + lane, end = net->neighbour[e];
            if (end == node)
                continue;
            if (node >= net->nodes || end >= net->nodes || end < lowest[lane])
                return fail_at(fault, DPT_E_INDEX, mesh, MESH_SPRING_ENDS, e);
            lowest[lane] = (uint64_t)end + 1;
        }
    }
    return DPT_OK;
}

static dpt_result check_spring_numbers(const struct dpt_mesh *mesh, const struct spring_net *net, dpt_mesh_fault *fault)
{
    for (uint32_t s = 0; s < net->slices; s++)
        for (uint32_t e = first_word(net, s); e < first_word(net, s + 1); e++) {
            const int is_none = net->neighbour[e] == s * LANES + e % LANES;
            if (is_none ? net->stiffness[e] != 0.0f : !is_spring_number(net->stiffness[e]))
                return fail_at(fault, DPT_E_FINITE, mesh, MESH_SPRING_STIFFNESS, e);
            if (is_none ? net->length[e] != 1.0f : !is_spring_number(net->length[e]))
                return fail_at(fault, DPT_E_FINITE, mesh, MESH_SPRING_LENGTH, e);
        }
    return DPT_OK;
}

/* Where in the row of `node` its spring to `end` is; UINT32_MAX: nowhere. */
static uint32_t find_spring(const struct spring_net *net, uint32_t node, uint32_t end)
{
    const uint32_t last = first_word(net, node / LANES + 1);
    for (uint32_t e = first_word(net, node / LANES) + node % LANES; e < last; e += LANES)
        if (net->neighbour[e] == end)
            return e;
    return UINT32_MAX;
}

/*
 * Each spring stands in both rows, with the same numbers. A row has no neighbour twice, so it is enough to look from
 * the lower node, and to count both directions.
 */
static dpt_result check_symmetry(const struct dpt_mesh *mesh, const struct spring_net *net, dpt_mesh_fault *fault)
{
    uint64_t upward = 0, downward = 0;
    for (uint32_t s = 0; s < net->slices; s++)
        for (uint32_t e = first_word(net, s); e < first_word(net, s + 1); e++) {
            const uint32_t node = s * LANES + e % LANES, end = net->neighbour[e];
            downward += end < node;
            if (end <= node)
                continue;
            const uint32_t other = find_spring(net, end, node);
            if (other == UINT32_MAX)
                return fail_at(fault, DPT_E_INDEX, mesh, MESH_SPRING_ENDS, e);
            if (net->stiffness[other] != net->stiffness[e] || net->length[other] != net->length[e])
                return fail_at(fault, DPT_E_FINITE, mesh, MESH_SPRING_STIFFNESS, e);
            upward++;
        }
    if (upward != downward || upward != net->springs)
        return fail(fault, DPT_E_INDEX, tail_at(mesh, offsetof(struct mesh_tail, springs)), MESH_HEADER);
    return DPT_OK;
}

/*
 * The header's numbers. The step is at most 2 / omega, and a node by itself, all others held, has omega^2 = (sum k) / m:
 * a net can have no longer one. It may need a shorter one, which the solver looks for.
 */
static dpt_result check_step(const struct dpt_mesh *mesh, const struct spring_net *net, dpt_mesh_fault *fault)
{
    const struct mesh_tail tail = mesh_tail(mesh);
    const double max = (double)MESH_SPRING_MAX, step2 = tail.stable_step * tail.stable_step;
    const uint64_t at = tail_at(mesh, offsetof(struct mesh_tail, viscosity));
    if (!(tail.viscosity >= 0.0 && tail.viscosity <= (double)MESH_DAMPING_MAX) ||
        !(tail.spring_mass >= 0.0 && tail.spring_mass <= max * net->nodes) ||
        !(tail.poisson >= 0.0 && tail.poisson <= 0.5) || !(tail.stable_step > 0.0 && tail.stable_step <= max))
        return fail(fault, DPT_E_FINITE, at, MESH_HEADER);
    for (uint32_t i = 0; i < net->nodes; i++) {
        const uint32_t last = first_word(net, i / LANES + 1);
        double sum = 0.0;
        for (uint32_t e = first_word(net, i / LANES) + i % LANES; e < last; e += LANES)
            sum += (double)net->stiffness[e];
        if (net->mass[i] > 0.0f && !(step2 * sum <= 4.0 * (1.0 + MESH_STEP_ROUNDING) * (double)net->mass[i]))
            return fail(fault, DPT_E_FINITE, tail_at(mesh, offsetof(struct mesh_tail, stable_step)), MESH_HEADER);
    }
    return DPT_OK;
}

/* The diagonals of a cell's faces lead to its corners, and are springs. */
static dpt_result check_corners(const struct dpt_mesh *mesh, const struct spring_net *net, uint32_t cell,
                                dpt_mesh_fault *fault)
{
    const uint32_t first = 8 * LANES * (cell / LANES) + cell % LANES;
    for (uint32_t a = 0; a < 8; a++)
        for (uint32_t axes = 3; axes < 7; axes += axes == 3 ? 2 : 1) {
            const uint32_t from = net->cell_nodes[first + LANES * a], to = net->cell_nodes[first + LANES * (a ^ axes)];
            if (from == to || find_spring(net, from, to) == UINT32_MAX)
                return fail_at(fault, DPT_E_INDEX, mesh, MESH_CELL_NODES, first + LANES * a);
        }
    return DPT_OK;
}

static dpt_result check_cells(const struct dpt_mesh *mesh, const struct spring_net *net, dpt_mesh_fault *fault)
{
    if (!net->cells)
        return DPT_OK;
    if (!(net->cell_size >= (double)MESH_SPRING_MIN && net->cell_size <= (double)MESH_SPRING_MAX) ||
        !(net->poisson >= CELL_POISSON_MIN && net->poisson <= CELL_POISSON_MAX))
        return fail(fault, DPT_E_FINITE, tail_at(mesh, offsetof(struct mesh_tail, cell_size)), MESH_HEADER);
    DPT_TRY(check_indices(mesh, MESH_CELL_NODES, net->nodes, 0, fault));
    for (uint32_t cell = 0; cell < LANES * net->cell_slices; cell++)
        if (cell < net->cells ? !is_spring_number(net->cell_stiffness[cell]) : net->cell_stiffness[cell] != 0.0f)
            return fail_at(fault, DPT_E_FINITE, mesh, MESH_CELL_STIFFNESS, cell);
    for (uint32_t cell = 0; cell < net->cells; cell++)
        DPT_TRY(check_corners(mesh, net, cell, fault));
    return DPT_OK;
}

static dpt_result check_springs(const struct dpt_mesh *mesh, dpt_mesh_fault *fault)
{
    struct spring_net net;
    if (!mesh_spring_net(mesh, &net))
        return DPT_OK;
    DPT_TRY(check_nodes(mesh, &net, fault));
    DPT_TRY(check_slices(mesh, &net, fault));
    DPT_TRY(check_rows(mesh, &net, fault));
    DPT_TRY(check_spring_numbers(mesh, &net, fault));
    DPT_TRY(check_symmetry(mesh, &net, fault));
    DPT_TRY(check_step(mesh, &net, fault));
    return check_cells(mesh, &net, fault);
}

static dpt_result check_content(const struct dpt_mesh *mesh, dpt_mesh_fault *fault)
{
    DPT_TRY(check_numbers(mesh, fault));
    DPT_TRY(check_example(mesh, fault));
    DPT_TRY(check_floats(mesh, MESH_VERTICES, (float)DPT_COORDINATE_MAX, fault));
    DPT_TRY(check_box(mesh, fault));
    DPT_TRY(check_indices(mesh, MESH_TRIANGLES, mesh->vertices, 0, fault));
    DPT_TRY(check_indices(mesh, MESH_NEIGHBOURS, mesh->triangles, MESH_EDGE_MANY, fault));
    DPT_TRY(check_fans(mesh, fault));
    DPT_TRY(check_indices(mesh, MESH_FANS, mesh->triangles, 0, fault));
    DPT_TRY(check_indices(mesh, MESH_PARTS, mesh->parts, 0, fault));
    DPT_TRY(check_indices(mesh, MESH_SOURCES, mesh->source_triangles, 0, fault));
    DPT_TRY(check_indices(mesh, MESH_PLACES, mesh->triangles, MESH_DROPPED_DUPLICATE, fault));
    DPT_TRY(check_sources(mesh, fault));
    DPT_TRY(check_floats(mesh, MESH_BOXES, 1e30f, fault));
    DPT_TRY(check_floats(mesh, MESH_LEAVES, 1e30f, fault));
    DPT_TRY(check_moments(mesh, fault));
    if (mesh_stores_normals(mesh))
        DPT_TRY(check_floats(mesh, MESH_NORMALS, 1.0f, fault));
    if (mesh_flags(mesh))
        DPT_TRY(check_indices(mesh, MESH_FLAGS, MESH_FLAGS_END, 0, fault));
    DPT_TRY(check_driving(mesh, fault));
    return check_springs(mesh, fault);
}

static dpt_result check_beginning(const void *bytes, size_t size, dpt_mesh_fault *fault)
{
    const size_t known = sizeof((struct dpt_mesh *)0)->magic + 8;
    if (!bytes)
        return DPT_E_ARGUMENT;
    if (fault)
        DPT_TRY(sized_check(fault, sizeof *fault, 0));
    if ((uintptr_t)bytes % 8)
        return fail(fault, DPT_E_ALIGN, 0, MESH_HEADER);
    size_t magic = size < 8 ? size : 8;
    if (size == 0 || memcmp(bytes, MESH_MAGIC, magic))
        return fail(fault, size == 0 ? DPT_E_TRUNCATED : DPT_E_MAGIC, 0, MESH_HEADER);
    if (size < known)
        return fail(fault, DPT_E_TRUNCATED, size, MESH_HEADER);
    return DPT_OK;
}

/*
 * Check all of a file. `header` is its header in the host's byte order. A short file is read no further than its end.
 */
static dpt_result check_file(const struct dpt_mesh *header, const void *bytes, size_t size, const struct crc32 *crc,
                             dpt_mesh_fault *fault)
{
    DPT_TRY(check_header(header, size, fault));
    DPT_TRY(check_header_crc(bytes, header->header_bytes, crc, header->header_crc32, fault));
    DPT_TRY(check_layout(header, fault));
    return check_sections_crc(header, (const unsigned char *)bytes, crc, fault);
}

dpt_result dpt_mesh_verify(const void *bytes, size_t size, dpt_mesh_fault *fault)
{
    DPT_TRY(check_beginning(bytes, size, fault));
    struct dpt_mesh header = { .bytes = 0 };
    memcpy(&header, bytes, size < sizeof header ? size : sizeof header);
    const uint64_t order_at = offsetof(struct dpt_mesh, byte_order);
    if (header.byte_order == MESH_BYTE_ORDER_SWAPPED)
        return fail(fault, DPT_E_BYTE_ORDER, order_at, MESH_HEADER);
    if (header.byte_order != MESH_BYTE_ORDER)
        return fail(fault, DPT_E_LAYOUT, order_at, MESH_HEADER);
    struct crc32 crc;
    crc32_init(&crc);
    DPT_TRY(check_file(&header, bytes, size, &crc, fault));
    return check_content((const struct dpt_mesh *)bytes, fault);
}

dpt_result dpt_mesh_open(const void *bytes, size_t size, const dpt_mesh **mesh)
{
    if (!mesh)
        return DPT_E_ARGUMENT;
    DPT_TRY(dpt_mesh_verify(bytes, size, NULL));
    *mesh = bytes;
    return DPT_OK;
}

dpt_result dpt_mesh_convert(void *bytes, size_t size, dpt_mesh_fault *fault)
{
    DPT_TRY(check_beginning(bytes, size, fault));
    struct dpt_mesh header = { .bytes = 0 };
    memcpy(&header, bytes, size < sizeof header ? size : sizeof header);
    if (header.byte_order != MESH_BYTE_ORDER_SWAPPED)
        return dpt_mesh_verify(bytes, size, fault);

    struct crc32 crc;
    crc32_init(&crc);
    uint32_t version = header.version;
    mesh_swap4(&version, 1);
    mesh_swap_header(&header, version);
    DPT_TRY(check_file(&header, bytes, size, &crc, fault));
    for (uint32_t id = 0; id < header.section_count; id++) {
        struct mesh_section *section = &header.section[id];
        unsigned char *content = (unsigned char *)bytes + section->offset;
        mesh_swap4(content, section->bytes / 4);
        section->crc32 = crc32_of(&crc, content, (size_t)section->bytes);
    }
    header.header_crc32 = 0;
    header.header_crc32 = crc32_of(&crc, &header, header.header_bytes);
    memcpy(bytes, &header, header.header_bytes);
    return check_content((const struct dpt_mesh *)bytes, fault);
}
