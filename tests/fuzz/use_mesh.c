/* SPDX-License-Identifier: BSD-3-Clause */
#include <math.h>
#include <string.h>

#include "dynpoint/baseline.h"
#include "fuzz/target.h"

enum { SEGMENTS = 4, TICKS = 4, CONTACTS = 4, STRIP = 24, SEARCH = 200 };

uint64_t fuzz_accepted;

static void ask_sections(const dpt_mesh *mesh, const dpt_mesh_info *info)
{
    dpt_mesh_section section = { .size = sizeof section };
    uint32_t id = 0;
    for (; dpt_mesh_get_section(mesh, id, &section) == DPT_OK; id++)
        MUST(section.offset <= info->bytes && section.bytes <= info->bytes - section.offset);
    MUST(id > 0);
}

/* What somebody else's physics asks: each vertex by its number in the source, and by its nodes. */
static void ask_driving(const dpt_mesh *mesh, const dpt_mesh_info *info)
{
    const uint32_t *sources, *nodes;
    const float *weights;
    uint32_t count, node_count;
    const dpt_result result = dpt_mesh_get_vertex_sources(mesh, &sources, &count);
    MUST(result == (info->format_version > 4 ? DPT_OK : DPT_E_UNSUPPORTED));
    MUST(dpt_mesh_get_embedding(mesh, &nodes, &weights, &node_count) == DPT_OK);
    MUST(node_count == info->nodes && info->outside_vertices <= info->vertices);
    if (result == DPT_OK)
        for (uint32_t v = 0; v < count; v++)
            MUST(sources[v] < info->source_vertices);
    for (uint32_t v = 0; node_count && v < info->vertices; v++) {
        double sum = 0.0;
        for (uint32_t k = 4 * v; k < 4 * v + 4; k++) {
            MUST(nodes[k] < node_count && fabs((double)weights[k]) <= 128.0);
            sum += (double)weights[k];
        }
        MUST(fabs(sum - 1.0) <= 1e-4);
    }
}

/* Each spring ends at a node, which has it too. */
static void ask_springs(const dpt_mesh *mesh, const dpt_mesh_info *info)
{
    dpt_mesh_springs net = { .size = sizeof net };
    uint64_t upward = 0, downward = 0;
    MUST(dpt_mesh_get_springs(mesh, &net) == DPT_OK && net.nodes == info->spring_nodes);
    for (uint32_t i = 0; i < net.nodes; i++) {
        MUST(net.mass[i] >= 0.0f && net.drag[i] >= 0.0f && fabsf(net.rest[3 * (size_t)i]) <= 2e6f);
        for (uint32_t e = 16 * net.first[i / 16] + i % 16; e < 16 * net.first[i / 16 + 1]; e += 16) {
            MUST(net.neighbours[e] < net.nodes && net.length[e] > 0.0f);
            upward += net.neighbours[e] > i;
            downward += net.neighbours[e] < i;
        }
    }
    MUST(upward == net.springs && downward == net.springs);
}

/* How many source numbers have a triangle. */
static uint32_t ask_triangles(const dpt_mesh *mesh, const dpt_mesh_info *info)
{
    double corners[9];
    uint32_t found = 0;
    for (uint32_t number = 0; number < info->source_triangles; number++) {
        if (dpt_mesh_get_triangle(mesh, number, corners) != DPT_OK)
            continue;
        found++;
        for (int i = 0; i < 9; i++)
            MUST(fabs(corners[i]) <= DPT_COORDINATE_MAX);
    }
    MUST(dpt_mesh_get_triangle(mesh, info->source_triangles, corners) == DPT_E_ARGUMENT);
    return found;
}

/* Segments in and about the box: across it, from a corner, a point, and one far away. */
static void choose_segments(const dpt_mesh_info *info, double ends[6 * SEGMENTS])
{
    static const double share[SEGMENTS][6] = { { -0.1, 0.3, 0.4, 1.1, 0.6, 0.7 },
                                               { 0.0, 0.0, 0.0, 0.5, 0.5, 0.5 },
                                               { 0.5, 0.45, 0.55, 0.5, 0.45, 0.55 },
                                               { 2.0, 1.5, 0.5, 3.0, 0.5, 0.25 } };
    for (int i = 0; i < 6 * SEGMENTS; i++) {
        double low = info->box_min[i % 3], high = info->box_max[i % 3];
        double at = low + share[i / 6][i % 6] * (high - low);
        ends[i] = fmin(fmax(at, -0.9 * DPT_COORDINATE_MAX), 0.9 * DPT_COORDINATE_MAX);
    }
}

static void check_hit(const dpt_hit *hit)
{
    const double numbers[] = { hit->distance, hit->gap,  hit->depth, hit->s,    hit->p[0],        hit->p[1],
                               hit->p[2],     hit->q[0], hit->q[1],  hit->q[2], hit->error_bound, hit->lower_bound };
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        MUST(isfinite(numbers[i]));
    MUST(hit->s >= 0.0 && hit->s <= 1.0 && hit->distance >= 0.0 && hit->depth >= 0.0);
    MUST(hit->status <= DPT_STATUS_EXACT && hit->contact <= DPT_CONTACT_PENETRATING);
}

/* The answer is that of the triangle that it names. */
static void check_pair(const dpt_mesh *mesh, const double ends[6], const dpt_hit *hit)
{
    double corners[9];
    MUST(hit->status == DPT_STATUS_EXACT);
    MUST(dpt_mesh_get_triangle(mesh, hit->triangle, corners) == DPT_OK);
    double distance = dpt_segment_triangle(ends, corners, NULL, NULL, NULL);
    MUST(fabs(distance - hit->distance) <= hit->error_bound);
    MUST(hit->lower_bound <= distance + hit->error_bound);
}

static void ask_queries(const dpt_mesh *mesh, const double ends[6 * SEGMENTS], double radius, int origin)
{
    static const uint32_t methods[] = { DPT_METHOD_BRUTE, DPT_METHOD_TREE, DPT_METHOD_EXACT };
    const double radii[SEGMENTS] = { 0.0, radius, radius, radius };
    dpt_hit hits[3][SEGMENTS];
    for (int m = 0; m < 3; m++) {
        dpt_query_def def = { .size = sizeof def, .method = methods[m] };
        memset(hits[m], 0, sizeof hits[m]);
        hits[m][0].size = sizeof hits[m][0];
        dpt_result result = dpt_query_segments(mesh, NULL, ends, radii, SEGMENTS, hits[m], &def);
        MUST(result == DPT_OK || (origin == FUZZ_FORGED && result == DPT_E_LAYOUT));
        for (int i = 0; i < SEGMENTS; i++) {
            check_hit(&hits[m][i]);
            if (origin != FUZZ_COMPILED)
                continue;
            check_pair(mesh, ends + 6 * i, &hits[m][i]);
            MUST(fabs(hits[m][i].distance - hits[0][i].distance) <= hits[m][i].error_bound + hits[0][i].error_bound);
        }
    }
}

static dpt_world *make_world(void *block, size_t room, uint32_t method, uint32_t budget, uint32_t kernel,
                             uint32_t strip)
{
    dpt_world_def def;
    dpt_world *world = NULL;
    dpt_world_def_init(&def);
    def.law = DPT_LAW_POINT;
    def.max_bodies = def.max_tools = 1;
    def.max_segments = 2;
    def.max_tips = 0;
    def.max_contacts = CONTACTS;
    def.certificate_bytes = 2048;
    def.method = method;
    def.budget = budget;
    def.kernel = kernel;
    def.strip = strip;
    def.strip_capacity = STRIP;
    def.strip_search = SEARCH;
    MUST(dpt_world_bytes(&def) <= room);
    MUST(dpt_world_create(block, room, &def, &world) == DPT_OK);
    return world;
}

static void ask_tool(const dpt_world *world, dpt_tool tool)
{
    dpt_hit hit = DPT_HIT_INIT;
    dpt_contact contacts[CONTACTS] = { { .size = sizeof contacts[0] } };
    dpt_sweep sweep = { .size = sizeof sweep };
    dpt_wrench wrench;
    uint32_t count;
    MUST(dpt_tool_get_hit(world, tool, &hit) == DPT_OK);
    check_hit(&hit);
    MUST(dpt_tool_get_wrench(world, tool, &wrench) == DPT_OK);
    for (int i = 0; i < 3; i++)
        MUST(isfinite(wrench.force[i]) && isfinite(wrench.torque[i]));
    MUST(dpt_tool_get_contacts(world, tool, contacts, CONTACTS, &count) == DPT_OK);
    for (uint32_t i = 0; i < count && i < CONTACTS; i++)
        MUST(contacts[i].s0 >= 0.0 && contacts[i].s0 <= contacts[i].s1 && contacts[i].s1 <= 1.0 &&
             isfinite(contacts[i].gap) && isfinite(contacts[i].overlap) && isfinite(contacts[i].normal[0]) &&
             isfinite(contacts[i].thrust[0]));
    for (uint32_t i = 0; i < 2; i++) {
        MUST(dpt_tool_get_sweep(world, tool, i, &sweep) == DPT_OK);
        MUST(isfinite(sweep.time) && isfinite(sweep.q[0]) && isfinite(sweep.normal[0]));
    }
}

static void check_overlaps(const dpt_overlap *overlaps, uint32_t count)
{
    for (uint32_t i = 0; i < count && i < STRIP; i++)
        MUST(isfinite(overlaps[i].distance) && isfinite(overlaps[i].gap) && isfinite(overlaps[i].overlap) &&
             isfinite(overlaps[i].q[0]) && overlaps[i].s >= 0.0 && overlaps[i].s <= 1.0);
}

static void ask_tool_strips(const dpt_world *world, dpt_tool tool)
{
    dpt_overlap overlaps[STRIP] = { { .size = sizeof overlaps[0] } };
    uint32_t count, flags;
    for (uint32_t i = 0; i < 2; i++) {
        MUST(dpt_tool_get_strip(world, tool, i, overlaps, STRIP, &count, &flags) == DPT_OK);
        check_overlaps(overlaps, count);
    }
}

static int corners_shared(const dpt_mesh *mesh, uint32_t one, uint32_t other)
{
    double a[9], b[9];
    int shared = 0;
    MUST(dpt_mesh_get_triangle(mesh, one, a) == DPT_OK && dpt_mesh_get_triangle(mesh, other, b) == DPT_OK);
    for (int i = 0; i < 9; i += 3)
        for (int k = 0; k < 9; k += 3)
            shared += !memcmp(a + i, b + k, 3 * sizeof *a);
    return shared;
}

/* From triangle to triangle over common corners, both ends included; the table's is the same. */
static void check_route(const dpt_mesh *mesh, const dpt_strip *strip, dpt_result result, uint32_t from, uint32_t to,
                        int origin)
{
    uint32_t count, flags;
    const uint32_t *triangles = dpt_strip_get_triangles(strip, &count, &flags);
    MUST(result == DPT_OK || count == 0);
    MUST(count <= STRIP);
    if (origin != FUZZ_COMPILED || result != DPT_OK)
        return;
    MUST(count > 0 && triangles[0] == from);
    MUST((flags & DPT_STRIP_FLAG_FULL) || triangles[count - 1] == to);
    for (uint32_t i = 1; i < count; i++)
        MUST(corners_shared(mesh, triangles[i - 1], triangles[i]) > 0);
}

static void ask_routes(const dpt_mesh *mesh, dpt_strip *strip, const dpt_mesh_info *info, int origin)
{
    static uint64_t room[16384];
    const dpt_route_table *table = NULL;
    const size_t bytes = dpt_route_table_bytes(mesh);
    if (bytes && bytes <= sizeof room)
        MUST(dpt_route_table_create(room, sizeof room, mesh, &table) == DPT_OK);
    for (uint32_t i = 0; i < 3; i++) {
        const uint32_t from = i, to = info->source_triangles - 1 - i;
        dpt_result result = dpt_strip_route(strip, mesh, from, to);
        uint32_t direct[STRIP], count, again;
        check_route(mesh, strip, result, from, to, origin);
        const uint32_t *triangles = dpt_strip_get_triangles(strip, &count, NULL);
        memcpy(direct, triangles, count * sizeof *direct);
        if (!table)
            continue;
        dpt_result by_table = dpt_strip_route_by_table(strip, table, from, to);
        triangles = dpt_strip_get_triangles(strip, &again, NULL);
        MUST(origin != FUZZ_COMPILED || result == DPT_E_FULL ||
             (result == by_table && count == again && !memcmp(direct, triangles, count * sizeof *direct)));
    }
    dpt_strip_routes(strip, mesh, 0, info->source_triangles / 2, info->source_triangles - 1);
}

static void ask_strips(const dpt_mesh *mesh, const dpt_mesh_info *info, const double ends[6 * SEGMENTS], double radius,
                       int origin)
{
    static uint64_t block[2048];
    const dpt_strip_def def = { .size = sizeof def, .capacity = STRIP, .search = SEARCH };
    dpt_overlap overlaps[STRIP] = { { .size = sizeof overlaps[0] } };
    dpt_strip *strip;
    uint32_t count;
    MUST(dpt_strip_create(block, sizeof block, &def, &strip) == DPT_OK);
    ask_routes(mesh, strip, info, origin);
    for (int i = 0; i < SEGMENTS; i++) {
        dpt_shadow shadow = { .size = sizeof shadow,
                              .triangle = (uint32_t)i % info->source_triangles,
                              .direction = { 0.1 * i, 0.2, -1.0 },
                              .width = radius,
                              .depth = i * 4.0 * radius };
        memcpy(shadow.segment.a, ends + 6 * i, sizeof shadow.segment.a);
        memcpy(shadow.segment.b, ends + 6 * i + 3, sizeof shadow.segment.b);
        shadow.segment.radius = radius;
        dpt_result result = dpt_strip_shadow(strip, mesh, NULL, &shadow);
        MUST(result == DPT_OK || result == DPT_E_DROPPED);
        MUST(dpt_strip_overlaps(strip, mesh, NULL, &shadow.segment, 1, overlaps, STRIP, &count) == DPT_OK);
        check_overlaps(overlaps, count);
    }
}

/* The chosen segments in turn: the tool goes in, through and out. */
static void ask_world(const dpt_mesh *mesh, const double ends[6 * SEGMENTS], double radius, uint32_t method,
                      uint32_t budget, uint32_t kernel, uint32_t strip)
{
    static double block[16384];
    dpt_world *world = make_world(block, sizeof block, method, budget, kernel, strip);
    dpt_segment segments[2];
    dpt_step step = { .size = sizeof step };
    dpt_body body;
    dpt_tool tool;
    MUST(dpt_body_add(world, mesh, NULL, &body) == DPT_OK);
    for (int tick = 0; tick < TICKS; tick++) {
        for (int i = 0; i < 2; i++) {
            const double *from = ends + 6 * ((tick + i) % SEGMENTS);
            memcpy(segments[i].a, from, sizeof segments[i].a);
            memcpy(segments[i].b, from + 3, sizeof segments[i].b);
            segments[i].radius = radius;
        }
        if (tick == 0)
            MUST(dpt_tool_add(world, segments, 2, &tool) == DPT_OK);
        else
            MUST(dpt_tool_set_segments(world, tool, segments, 2) == DPT_OK);
        dpt_result result = dpt_world_step(world, 1e-3, &step);
        MUST(result == DPT_OK || result == DPT_E_LAYOUT);
        MUST(isfinite(step.distance) && step.status <= DPT_STATUS_EXACT);
        ask_tool(world, tool);
        if (strip != DPT_STRIP_KIND_NONE)
            ask_tool_strips(world, tool);
    }
}

void fuzz_use_mesh(const dpt_mesh *mesh, int origin, int asked)
{
    dpt_mesh_info info = { .size = sizeof info };
    double ends[6 * SEGMENTS];
    MUST(dpt_mesh_get_info(mesh, &info) == DPT_OK);
    ask_sections(mesh, &info);
    ask_driving(mesh, &info);
    ask_springs(mesh, &info);
    uint32_t found = ask_triangles(mesh, &info);
    MUST(origin == FUZZ_FORGED || found == info.triangles);
    choose_segments(&info, ends);
    double radius = 0.01 * fmin(fabs(info.box_max[0] - info.box_min[0]), DPT_COORDINATE_MAX);
    if (asked & FUZZ_QUERY)
        ask_queries(mesh, ends, radius, origin);
    if (asked & FUZZ_TICK)
        ask_world(mesh, ends, radius, DPT_METHOD_EXACT, 0, DPT_KERNEL_AUTO, DPT_STRIP_KIND_NONE);
    if (asked & FUZZ_BUDGET)
        ask_world(mesh, ends, radius, DPT_METHOD_EXACT, 2, DPT_KERNEL_SCALAR, DPT_STRIP_KIND_SHADOW);
    if (asked & FUZZ_PAPER)
        ask_world(mesh, ends, radius, DPT_METHOD_PAPER, 0, DPT_KERNEL_SCALAR, DPT_STRIP_KIND_ROUTES);
    if (asked & FUZZ_STRIP)
        ask_strips(mesh, &info, ends, radius, origin);
}
