/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A forger who knows the format: words of a compiled mesh are changed, then lengths, places and checksums made good, so
 * that the damage reaches the checks behind them. With REPAIR_INDICES and REPAIR_FLOATS nothing is left to refuse: the
 * mesh opens, is nonsense, and must still be used without harm.
 *
 * The bytes: which mesh; REPAIR_..., OTHER_ORDER and above them which one of FUZZ_QUERY to FUZZ_STRIP; then 8 for each
 * change: how, section, index of 16 bits, value of 32.
 */
#include <math.h>
#include <string.h>

#include "base/crc32.h"
#include "dynpoint/compile.h"
#include "fuzz/target.h"
#include "mesh/mesh_swap.h"
#include "scene/shape.h"

enum { REPAIR_INDICES = 1, REPAIR_FLOATS = 2, OTHER_ORDER = 4, ASKED_SHIFT = 3 };

enum { TRIANGLES_MAX = 512, COUNT_MAX = 1024, EDITS_MAX = 64 };

/*
 * One leaf; with moments; several parts; a sheet; two levels of boxes; an embedding; springs of a sheet, of a volume, and
 * of one whose cells keep it.
 */
static const struct {
    const char *shape;
    uint64_t triangles;
    size_t missing;
    int has_cells;
    uint32_t springs;
    double poisson;
} sources[] = { { "box", 12, 0, 0, 0, 0.0 },
                { "torus", 40, 2, 0, 0, 0.0 },
                { "box", 300, 13, 0, 0, 0.0 },
                { "cloth", 32, 0, 0, 0, 0.0 },
                { "hub", 270, 0, 0, 0, 0.0 },
                { "torus", 40, 0, 1, 0, 0.0 },
                { "cloth", 32, 0, 0, DPT_NET_SHEET, 0.0 },
                { "box", 12, 0, 0, DPT_NET_VOLUME, 0.0 },
                { "box", 12, 0, 0, DPT_NET_VOLUME, 0.45 } };

/* Two cells in five nodes, which hold a part of the torus. */
static const double cell_nodes[] = { 0, 0, -0.3, 0.3, -0.2, 0.1, 0, 0.3, 0.1, -0.3, -0.2, 0.1, 0, 0, 0.4 };
static const uint32_t cell_corners[] = { 0, 1, 2, 3, 1, 2, 3, 4 };

enum { BASES = sizeof sources / sizeof *sources };

static dpt_compiled bases[BASES];

static void make_bases(void)
{
    if (bases[0].bytes)
        return;
    for (int i = 0; i < BASES; i++) {
        struct shape shape;
        shape_reason reason;
        const dpt_spring_net_def springs = {
            .size = sizeof springs, .kind = sources[i].springs, .spacing = 0.04, .poisson = sources[i].poisson
        };
        const dpt_compile_def def = { .size = sizeof def,
                                      .springs = sources[i].springs ? &springs : NULL,
                                      .nodes = cell_nodes,
                                      .cells = cell_corners,
                                      .node_count = sources[i].has_cells ? 5 : 0,
                                      .cell_count = sources[i].has_cells ? 2 : 0 };
        MUST(shape_make(sources[i].shape, sources[i].triangles, 0, &shape, reason) == 0);
        MUST(dpt_compile_arrays(shape.vertices, shape.vertex_count, shape.corners,
                                shape.triangle_count - sources[i].missing, &def, &bases[i], NULL) == DPT_OK);
        shape_free(&shape);
    }
}

static uint32_t word_at(const uint8_t *bytes)
{
    uint32_t word;
    memcpy(&word, bytes, sizeof word);
    return word;
}

/* The words of the header that an edit reaches: those before the section table, and the tail. */
static const uint32_t table_begins = offsetof(struct dpt_mesh, section) / 4;

/* What looks like a number, a count or a code, at the edges of what is allowed. */
static uint32_t odd_word(uint32_t which)
{
    static const uint32_t odd[] = { 0,          1,          15,         16,         17,         255,        256,
                                    257,        0x7fffffff, 0x80000000, 0xffffffff, 0xfffffffe, 0xfffffffd, 0xfffffffc,
                                    0x55555555, 0x55555556, 0x3f800000, 0xbf800000, 0x7f800000, 0xff800000, 0x7fc00000,
                                    0x49742400, 0x7149f2ca, 0x00000001, 0x33800000 };
    return odd[which % (sizeof odd / sizeof *odd)];
}

/* version: what the mesh was compiled as. */
static void edit(struct dpt_mesh *mesh, uint32_t version, const uint8_t *change)
{
    const uint32_t sections = mesh_section_count(version);
    const uint32_t id = change[1] % (sections + 1), value = word_at(change + 4);
    const int in_header = id == sections;
    uint32_t *words = in_header ? (uint32_t *)(void *)mesh : (uint32_t *)mesh_words(mesh, (int)id);
    uint32_t count = in_header ? table_begins : (uint32_t)(mesh->section[id].bytes / 4);
    uint32_t at = (uint32_t)(change[2] | change[3] << 8);
    if (!count)
        return;
    if (in_header && at >= 0x8000) {
        words += mesh_tail_offset(version) / 4;
        count = (uint32_t)(mesh_tail_bytes(version) / 4);
    }
    at %= count;
    switch (change[0] % 5) {
    case 0:
        words[at] = value;
        break;
    case 1:
        words[at] = odd_word(value);
        break;
    case 2:
        words[at] = words[value % count];
        break;
    case 3:
        words[at] += (value & 31) - 16;
        break;
    default:
        for (uint32_t i = at; i < count && i < at + 16; i++)
            words[i] = odd_word(value);
    }
}

static uint32_t limited(uint32_t count, uint32_t least, uint32_t most)
{
    return count < least ? least : count > most ? least + count % (most - least + 1) : count;
}

/* Counts as they are where a file of that size can be had; all that follows from them. */
static void repair_counts(struct dpt_mesh *header, uint32_t compiled_version)
{
    uint32_t count[MESH_LEVELS_MAX + 1];
    uint64_t nodes, end;
    memcpy(header->magic, MESH_MAGIC, sizeof header->magic);
    header->byte_order = MESH_BYTE_ORDER;
    const uint32_t version = limited(header->version, 1, MESH_VERSION);
    struct mesh_tail tail = { .cells = 0 };
    memcpy(&tail, (char *)header + mesh_tail_offset(compiled_version), mesh_tail_bytes(compiled_version));
    header->version = version;
    tail.nodes = limited(tail.nodes, 0, COUNT_MAX);
    tail.spring_entries = limited(tail.spring_entries, 0, COUNT_MAX);
    header->header_bytes = mesh_header_bytes(header->version);
    header->section_count = mesh_section_count(header->version);
    header->triangles = limited(header->triangles, 1, TRIANGLES_MAX);
    header->vertices = limited(header->vertices, 1, COUNT_MAX);
    header->source_triangles = limited(header->source_triangles, header->triangles, COUNT_MAX);
    if (version > 4)
        header->source_vertices = limited(header->source_vertices, header->vertices, COUNT_MAX);
    header->parts = limited(header->parts, 1, COUNT_MAX);
    if (tail.outside_vertices > header->vertices)
        tail.outside_vertices = 0;
    if (tail.spring_nodes)
        tail.spring_nodes = tail.nodes ? tail.nodes : header->vertices;
    else
        tail.springs = tail.spring_entries = tail.fixed_nodes = 0;
    tail.cells = tail.spring_nodes >= 8 ? limited((uint32_t)tail.cells, 0, COUNT_MAX) : 0;
    if (tail.fixed_nodes > tail.spring_nodes)
        tail.fixed_nodes = 0;
    header->leaves = (header->triangles + LANES - 1) / LANES;
    header->levels = mesh_levels(header->leaves, count, &nodes);
    header->reserved = 0;
    memcpy((char *)header + mesh_tail_offset(version), &tail, mesh_tail_bytes(version));
    end = header->header_bytes;
    for (int id = 0; id < (int)header->section_count && id < MESH_SECTION_COUNT; id++) {
        struct mesh_section *section = &header->section[id];
        *section = (struct mesh_section){ .offset = mesh_aligned(end) };
        mesh_section_name(id, section->name);
        section->bytes = 4 * mesh_section_words(header, id, nodes);
        end = section->offset + section->bytes;
    }
    header->bytes = end;
}

/* The old content over and over, or zeros. */
static void take_content(struct dpt_mesh *mesh, const struct dpt_mesh *from, uint32_t sections)
{
    for (int id = 0; id < (int)mesh->section_count; id++) {
        uint32_t *to = (uint32_t *)mesh_words(mesh, id);
        const uint32_t *old = (uint32_t)id < sections ? mesh_words(from, id) : NULL;
        const size_t words = mesh->section[id].bytes / 4, have = old ? from->section[id].bytes / 4 : 0;
        for (size_t i = 0; i < words; i++)
            to[i] = have ? old[i % have] : 0;
    }
}

static void repair_words(struct dpt_mesh *mesh, int id, uint32_t limit, uint32_t codes)
{
    uint32_t *word = (uint32_t *)mesh_words(mesh, id);
    for (size_t i = 0; i < mesh->section[id].bytes / 4; i++)
        if (word[i] >= limit && (!codes || word[i] < codes))
            word[i] %= limit;
}

/* Where they do not lead back, all anew. */
static void repair_sources(struct dpt_mesh *mesh)
{
    uint32_t *source = (uint32_t *)mesh_words(mesh, MESH_SOURCES);
    uint32_t *place = (uint32_t *)mesh_words(mesh, MESH_PLACES);
    int wrong = 0;
    for (uint32_t t = 0; t < mesh->triangles; t++)
        wrong |= place[source[t]] != t;
    for (uint32_t number = 0; wrong && number < mesh->source_triangles; number++)
        place[number] = number < mesh->triangles ? number : MESH_DROPPED_DEGENERATE;
    for (uint32_t t = 0; wrong && t < mesh->triangles; t++)
        source[t] = t;
}

/* A field of the tail, in a file of any version. */
static void *tail_field(struct dpt_mesh *mesh, size_t field)
{
    return (char *)mesh + mesh_tail_offset(mesh->version) + field;
}

/* The springs, to be repaired. A node's row: word first[node / 16] * 16 + node % 16, and every 16th from there. */
struct net {
    struct spring_net is;
    struct mesh_tail *tail;
    float *rest, *mass, *drag, *stiffness, *length;
    uint32_t *first, *ends, entries;
};

static int net_of(struct dpt_mesh *mesh, struct net *net)
{
    if (!mesh_spring_net(mesh, &net->is))
        return 0;
    net->tail = tail_field(mesh, 0);
    net->rest = net->tail->nodes ? (float *)net->is.rest : NULL;
    net->mass = (float *)net->is.mass;
    net->drag = (float *)net->is.drag;
    net->first = (uint32_t *)net->is.first;
    net->ends = (uint32_t *)net->is.neighbour;
    net->stiffness = (float *)net->is.stiffness;
    net->length = (float *)net->is.length;
    net->entries = net->tail->spring_entries;
    return 1;
}

static int slices_are_wrong(const struct net *net)
{
    int wrong = net->first[0] != 0 || net->first[net->is.slices] != net->entries;
    for (uint32_t s = 0; s < net->is.slices; s++)
        wrong |= net->first[s] > net->first[s + 1] || net->first[s + 1] - net->first[s] > 1024;
    return wrong;
}

/* The word of `end` in the row of a node; UINT32_MAX: it is not there. */
static uint32_t word_to(const struct net *net, uint32_t node, uint32_t end)
{
    for (uint32_t e = 16 * net->first[node / 16] + node % 16; e < 16 * net->first[node / 16 + 1]; e += 16)
        if (net->ends[e] == end)
            return e;
    return UINT32_MAX;
}

static int rows_are_wrong(const struct net *net)
{
    int wrong = 0;
    for (uint32_t node = 0; node < 16 * net->is.slices; node++) {
        int64_t before = -1;
        for (uint32_t e = 16 * net->first[node / 16] + node % 16; e < 16 * net->first[node / 16 + 1]; e += 16) {
            const uint32_t end = net->ends[e];
            if (end == node)
                continue;
            wrong |= node >= net->is.nodes || end >= net->is.nodes || end <= before;
            before = end;
        }
    }
    return wrong;
}

/* Springs that stand in one row alone, or are not as many as the header says. */
static int pairs_are_wrong(const struct net *net)
{
    uint64_t ends = 0;
    int wrong = 0;
    for (uint32_t node = 0; node < net->is.nodes; node++)
        for (uint32_t e = 16 * net->first[node / 16] + node % 16; e < 16 * net->first[node / 16 + 1]; e += 16)
            if (net->ends[e] != node) {
                wrong |= word_to(net, net->ends[e], node) == UINT32_MAX;
                ends++;
            }
    return wrong || ends != 2 * (uint64_t)net->tail->springs;
}

/* If one index is wrong, there are no springs. */
static void repair_net(struct dpt_mesh *mesh)
{
    struct net net;
    if (!net_of(mesh, &net) || !(slices_are_wrong(&net) || rows_are_wrong(&net) || pairs_are_wrong(&net)))
        return;
    for (uint32_t s = 0; s <= net.is.slices; s++)
        net.first[s] = s < net.is.slices ? 0 : net.entries;
    for (uint32_t e = 0; e < 16 * net.entries; e++) {
        net.ends[e] = 16 * (net.is.slices - 1) + e % 16;
        net.stiffness[e] = 0.0f;
        net.length[e] = 1.0f;
    }
    net.tail->springs = 0;
}

static int is_number(float x)
{
    return x >= 1e-15f && x <= 1e15f;
}

static int node_numbers_are_wrong(const struct net *net)
{
    uint32_t fixed = 0;
    int wrong = 0;
    for (uint32_t i = 0; net->rest && i < 3 * net->is.nodes; i++)
        wrong |= !(fabsf(net->rest[i]) <= 2e6f);
    for (uint32_t i = 0; i < net->is.nodes; i++) {
        wrong |=
            (net->mass[i] != 0.0f && !is_number(net->mass[i])) || !(net->drag[i] >= 0.0f) || !(net->drag[i] <= 1e9f);
        fixed += net->mass[i] == 0.0f;
    }
    const struct mesh_tail *tail = net->tail;
    return wrong || fixed != tail->fixed_nodes || !(tail->viscosity >= 0.0) || !(tail->viscosity <= 1e9) ||
           !(tail->spring_mass >= 0.0) || !(tail->spring_mass <= (double)1e15f * net->is.nodes) ||
           !(tail->poisson >= 0.0) || !(tail->poisson <= 0.5) || !(tail->stable_step > 0.0) ||
           !(tail->stable_step <= (double)1e15f);
}

static int spring_numbers_are_wrong(const struct net *net)
{
    const double step = net->tail->stable_step;
    int wrong = 0;
    for (uint32_t node = 0; node < 16 * net->is.slices; node++) {
        double sum = 0.0;
        for (uint32_t e = 16 * net->first[node / 16] + node % 16; e < 16 * net->first[node / 16 + 1]; e += 16) {
            const uint32_t end = net->ends[e];
            const float k = net->stiffness[e], length = net->length[e];
            if (end == node) {
                wrong |= k != 0.0f || length != 1.0f;
                continue;
            }
            wrong |= !is_number(k) || !is_number(length);
            const uint32_t back = word_to(net, end, node);
            if (back != UINT32_MAX)
                wrong |= net->stiffness[back] != k || net->length[back] != length;
            sum += (double)k;
        }
        if (node < net->is.nodes && net->mass[node] > 0.0f)
            wrong |= !(step * step * sum <= 4.0 * (1.0 + 1e-5) * (double)net->mass[node]);
    }
    return wrong;
}

/* If one number is wrong, all nodes are alike, and so are all springs. */
static void repair_net_numbers(struct dpt_mesh *mesh)
{
    struct net net;
    if (!net_of(mesh, &net))
        return;
    const int has_rows = !slices_are_wrong(&net) && !rows_are_wrong(&net);
    if (!node_numbers_are_wrong(&net) && !(has_rows && spring_numbers_are_wrong(&net)))
        return;
    for (uint32_t i = 0; net.rest && i < 3 * net.is.nodes; i++)
        net.rest[i] = 0.0f;
    for (uint32_t i = 0; i < net.is.nodes; i++) {
        net.mass[i] = 1.0f;
        net.drag[i] = 0.0f;
    }
    for (uint32_t node = 0; has_rows && node < 16 * net.is.slices; node++)
        for (uint32_t e = 16 * net.first[node / 16] + node % 16; e < 16 * net.first[node / 16 + 1]; e += 16) {
            net.stiffness[e] = net.ends[e] == node ? 0.0f : 1.0f;
            net.length[e] = 1.0f;
        }
    net.tail->fixed_nodes = 0;
    net.tail->viscosity = net.tail->poisson = 0.0;
    net.tail->spring_mass = 1.0;
    net.tail->stable_step = 1e-9;
}

/* The corners of cell c are words 128 (c / 16) + c % 16, and every 16th from there. */
static int corners_are_wrong(const struct net *net, const uint32_t *corner)
{
    for (uint32_t a = 0; a < 8; a++)
        for (uint32_t b = 0; b < 8; b++) {
            const uint32_t from = corner[16 * a], to = corner[16 * b];
            const int is_diagonal = (a ^ b) == 3 || (a ^ b) == 5 || (a ^ b) == 6;
            if (is_diagonal && (from == to || word_to(net, from, to) == UINT32_MAX))
                return 1;
        }
    return 0;
}

/* Indices that are too large become 0. Of cells that are not made good by that, none is: another word changes each time. */
static void repair_cells(struct dpt_mesh *mesh)
{
    struct net net;
    if (!net_of(mesh, &net) || !net.is.cells)
        return;
    uint32_t *corner = (uint32_t *)mesh_words(mesh, MESH_CELL_NODES);
    for (uint32_t i = 0; i < 128 * net.is.cell_slices; i++)
        if (corner[i] >= net.is.nodes)
            corner[i] = 0;
    for (uint32_t c = 0; c < net.is.cells; c++)
        if (corners_are_wrong(&net, corner + 128 * (c / 16) + c % 16)) {
            const uint32_t first = 128 * (c / 16) + c % 16, node = corner[first] ? 0 : 1;
            for (uint32_t a = 0; a < 8; a++)
                corner[first + 16 * a] = node;
            return;
        }
}

static void repair_cell_numbers(struct dpt_mesh *mesh)
{
    struct net net;
    if (!net_of(mesh, &net) || !net.is.cells)
        return;
    float *stiffness = (float *)mesh_floats(mesh, MESH_CELL_STIFFNESS);
    for (uint32_t c = 0; c < 16 * net.is.cell_slices; c++)
        if (c < net.is.cells ? !is_number(stiffness[c]) : stiffness[c] != 0.0f)
            stiffness[c] = c < net.is.cells ? 1.0f : 0.0f;
    if (!(net.tail->poisson >= 0.1) || !(net.tail->poisson <= 0.45))
        net.tail->poisson = 0.3;
    if (!(net.tail->cell_size >= (double)1e-15f) || !(net.tail->cell_size <= (double)1e15f))
        net.tail->cell_size = 1.0;
}

static void repair_indices(struct dpt_mesh *mesh)
{
    uint32_t *first = (uint32_t *)mesh_words(mesh, MESH_FAN_FIRST);
    const uint32_t *lanes;
    repair_words(mesh, MESH_TRIANGLES, mesh->vertices, 0);
    repair_words(mesh, MESH_NEIGHBOURS, mesh->triangles, MESH_EDGE_MANY);
    repair_words(mesh, MESH_FANS, mesh->triangles, 0);
    repair_words(mesh, MESH_PARTS, mesh->parts, 0);
    repair_words(mesh, MESH_SOURCES, mesh->source_triangles, 0);
    repair_words(mesh, MESH_PLACES, mesh->triangles, MESH_DROPPED_DUPLICATE);
    repair_sources(mesh);
    if (mesh_flags(mesh))
        repair_words(mesh, MESH_FLAGS, MESH_FLAGS_END, 0);
    first[0] = 0;
    for (uint32_t v = 1; v < mesh->vertices; v++)
        first[v] = first[v] > 3 * mesh->triangles ? 3 * mesh->triangles
                   : first[v] < first[v - 1]      ? first[v - 1]
                                                  : first[v];
    first[mesh->vertices] = 3 * mesh->triangles;
    if (mesh->version > 4)
        repair_words(mesh, MESH_VERTEX_SOURCES, mesh->source_vertices, 0);
    if (mesh_tail(mesh).nodes)
        repair_words(mesh, MESH_EMBED_NODES, mesh_tail(mesh).nodes, 0);
    repair_net(mesh);
    repair_cells(mesh);
    uint32_t *example = tail_field(mesh, offsetof(struct mesh_tail, self_intersection));
    if (mesh->version > 3 && (example[0] >= mesh->source_triangles || example[1] >= mesh->source_triangles))
        example[0] = example[1] = DPT_NONE;
    if (mesh_moments(mesh, &lanes))
        for (uint32_t leaf = 0; leaf < mesh->leaves; leaf++)
            ((uint32_t *)lanes)[leaf] &= lanes_of(mesh->triangles - leaf * LANES);
}

static void repair_some_floats(float *floats, size_t count, float limit)
{
    for (size_t i = 0; i < count; i++)
        if (!(fabsf(floats[i]) <= limit))
            floats[i] = 0.0f;
}

static void repair_doubles(double *numbers, size_t count, double limit)
{
    for (size_t i = 0; i < count; i++)
        if (!(fabs(numbers[i]) <= limit))
            numbers[i] = 0.0;
}

/* All of a vertex's weights anew, if one of them or their sum is wrong. */
static void repair_weights(struct dpt_mesh *mesh)
{
    float *weight = (float *)mesh_floats(mesh, MESH_EMBED_WEIGHTS);
    for (size_t v = 0; v < mesh->vertices; v++, weight += 4) {
        const double sum = (double)weight[0] + (double)weight[1] + (double)weight[2] + (double)weight[3];
        int wrong = !(fabs(sum - 1.0) <= 0x1p-16);
        for (int k = 0; k < 4; k++)
            wrong |= !(fabsf(weight[k]) <= 128.0f);
        for (int k = 0; wrong && k < 4; k++)
            weight[k] = k == 2 ? 1.0f : 0.0f;
    }
}

static void repair_floats(struct dpt_mesh *mesh)
{
    static const struct {
        int id;
        float limit;
    } floats[] = { { MESH_VERTICES, (float)DPT_COORDINATE_MAX }, { MESH_BOXES, 1e30f }, { MESH_LEAVES, 1e30f } };
    const uint32_t *lanes;
    for (size_t i = 0; i < sizeof floats / sizeof *floats; i++)
        repair_some_floats((float *)mesh_floats(mesh, floats[i].id), mesh->section[floats[i].id].bytes / 4,
                           floats[i].limit);
    if (mesh_moments(mesh, &lanes))
        repair_some_floats((float *)mesh_floats(mesh, MESH_MOMENTS),
                           mesh->section[MESH_MOMENTS].bytes / 4 - mesh->leaves, 1e30f);
    if (mesh_normals(mesh))
        repair_some_floats((float *)mesh_normals(mesh), mesh->section[MESH_NORMALS].bytes / 4, 1.0f);
    if (mesh_tail(mesh).nodes)
        repair_weights(mesh);
    repair_net_numbers(mesh);
    repair_cell_numbers(mesh);
    double *crease = tail_field(mesh, offsetof(struct mesh_tail, crease));
    if (mesh->version > 2 && !(*crease >= 0.0 && *crease <= 4.0))
        *crease = 0.0;
    double *distance = tail_field(mesh, offsetof(struct mesh_tail, outside_distance));
    if (mesh->version > 4 && !(*distance >= 0.0 && *distance <= 4.0 * DPT_COORDINATE_MAX))
        *distance = 0.0;
    repair_doubles(mesh->box_min, 3, 2.0 * DPT_COORDINATE_MAX);
    repair_doubles(mesh->box_max, 3, 2.0 * DPT_COORDINATE_MAX);
    const float *word = mesh_floats(mesh, MESH_VERTICES);
    for (size_t i = 0; i < 3 * (size_t)mesh->vertices; i++) {
        mesh->box_min[i % 3] = fmin(mesh->box_min[i % 3], word[i]);
        mesh->box_max[i % 3] = fmax(mesh->box_max[i % 3], word[i]);
    }
    repair_doubles(mesh->filter_centre, 3, 2.0 * DPT_COORDINATE_MAX);
    repair_doubles(&mesh->scale, 1, 1e300);
    repair_doubles(&mesh->rounding, 1, 1e300);
    if (!(mesh->filter_scale > 0.0) || !(mesh->filter_scale <= 1e300))
        mesh->filter_scale = 1.0;
}

static void seal(struct dpt_mesh *mesh, const struct crc32 *crc)
{
    for (int id = 0; id < (int)mesh->section_count; id++) {
        struct mesh_section *section = &mesh->section[id];
        section->crc32 = crc32_of(crc, mesh_section(mesh, id), section->bytes);
    }
    mesh->header_crc32 = 0;
    mesh->header_crc32 = crc32_of(crc, mesh, mesh->header_bytes);
}

/* There and back: what the other byte order's file converts to is this one. */
static void convert(const struct dpt_mesh *mesh, const struct crc32 *crc)
{
    const size_t size = mesh->bytes;
    struct dpt_mesh *other = malloc(size), header = { .bytes = 0 };
    MUST(other);
    memcpy(other, mesh, size);
    memcpy(&header, mesh, mesh->header_bytes);
    header.header_crc32 = 0;
    for (int id = 0; id < (int)mesh->section_count; id++) {
        mesh_swap4((char *)other + mesh->section[id].offset, mesh->section[id].bytes / 4);
        header.section[id].crc32 = crc32_of(crc, (char *)other + mesh->section[id].offset, mesh->section[id].bytes);
    }
    mesh_swap_header(&header, mesh->version);
    header.header_crc32 = crc32_of(crc, &header, mesh->header_bytes);
    mesh_swap4(&header.header_crc32, 1);
    memcpy(other, &header, mesh->header_bytes);
    MUST(dpt_mesh_verify(other, size, NULL) == DPT_E_BYTE_ORDER);
    MUST(dpt_mesh_convert(other, size, NULL) == dpt_mesh_verify(mesh, size, NULL));
    MUST(!memcmp(other, mesh, size));
    free(other);
}

/* A block of the file's exact length. */
static struct dpt_mesh *forge(const uint8_t *bytes, size_t size, const struct crc32 *crc)
{
    const dpt_compiled *base = &bases[bytes[0] % BASES];
    struct dpt_mesh *edited = malloc(base->size), header = { .bytes = 0 };
    MUST(edited);
    memcpy(edited, base->bytes, base->size);
    const uint32_t version = edited->version;
    for (size_t i = 0; i < EDITS_MAX && 2 + 8 * (i + 1) <= size; i++)
        edit(edited, version, bytes + 2 + 8 * i);
    memcpy(&header, edited, sizeof header);
    repair_counts(&header, version);
    struct dpt_mesh *mesh = calloc(1, header.bytes);
    MUST(mesh);
    memcpy(mesh, &header, header.header_bytes);
    take_content(mesh, edited, mesh_section_count(version));
    free(edited);
    if (bytes[1] & REPAIR_INDICES)
        repair_indices(mesh);
    if (bytes[1] & REPAIR_FLOATS)
        repair_floats(mesh);
    seal(mesh, crc);
    return mesh;
}

/* What a repair would change must be refused, and nothing else. */
static int needs(void (*repair)(struct dpt_mesh *mesh), const struct dpt_mesh *mesh)
{
    const size_t size = mesh->bytes;
    struct dpt_mesh *copy = malloc(size);
    MUST(copy);
    memcpy(copy, mesh, size);
    repair(copy);
    int changed = memcmp(copy, mesh, size) != 0;
    free(copy);
    return changed;
}

FUZZ_TARGET(forged)
{
    struct crc32 crc;
    dpt_mesh_fault fault = { .size = sizeof fault };
    const dpt_mesh *opened;
    if (size < 2)
        return 0;
    make_bases();
    crc32_init(&crc);
    struct dpt_mesh *mesh = forge(bytes, size, &crc);
    dpt_result result = dpt_mesh_verify(mesh, mesh->bytes, &fault);
    const int wrong_index = needs(repair_indices, mesh), wrong_float = needs(repair_floats, mesh);
    MUST(result == DPT_OK || result == DPT_E_INDEX || result == DPT_E_FINITE);
    MUST((result == DPT_OK) == (!wrong_index && !wrong_float));
    MUST(result != DPT_E_INDEX || wrong_index);
    MUST(result != DPT_E_FINITE || wrong_float);
    if (bytes[1] & OTHER_ORDER)
        convert(mesh, &crc);
    if (result == DPT_OK) {
        fuzz_accepted++;
        MUST(dpt_mesh_open(mesh, mesh->bytes, &opened) == DPT_OK);
        fuzz_use_mesh(opened, FUZZ_FORGED, 1 << (bytes[1] >> ASKED_SHIFT) % FUZZ_KINDS);
    }
    free(mesh);
    return 0;
}
