/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/mesh_checks.h"

#include <math.h>

#include "contact/winding_number.h"

struct file small_file, large_file, holed_file, embedded_file, sheet_file, volume_file;

int open_files(void)
{
    small_file = file_of_shape("sphere", 40);
    large_file = file_of_shape("sphere", 600);
    holed_file = file_of_holed_shape("sphere", 40, 1);
    embedded_file = file_of_embedded_shape("sphere", 40);
    sheet_file = file_of_sprung_shape("sphere", 40, DPT_NET_SHEET);
    volume_file = file_of_sprung_shape("sphere", 40, DPT_NET_VOLUME);
    return small_file.size && large_file.size && holed_file.size && embedded_file.size && sheet_file.size &&
           volume_file.size;
}

void free_files(void)
{
    free(volume_file.bytes);
    free(sheet_file.bytes);
    free(embedded_file.bytes);
    free(holed_file.bytes);
    free(small_file.bytes);
    free(large_file.bytes);
}

dpt_mesh_fault verified(const struct file *file)
{
    dpt_mesh_fault fault = { .size = sizeof fault };
    dpt_result result = dpt_mesh_verify(file->bytes, file->size, &fault);
    CHECK(fault.code == result, "the fault says %d, verify %d", fault.code, result);
    CHECK(memchr(fault.section, 0, sizeof fault.section) != NULL, "section has no end");
    return fault;
}

dpt_mesh_fault fault_of(const struct file *file)
{
    const dpt_mesh *untouched = (const dpt_mesh *)(const void *)&small_file, *mesh = untouched;
    dpt_mesh_fault fault = verified(file);
    dpt_result opened = dpt_mesh_open(file->bytes, file->size, &mesh);
    CHECK(opened == fault.code, "open %d, verify %d", opened, fault.code);
    CHECK(mesh == (opened == DPT_OK ? (const void *)file->bytes : (const void *)untouched),
          "%d, and the output is changed", opened);
    return fault;
}

void expect_fault(const struct file *file, dpt_result code, uint64_t byte, const char *section)
{
    dpt_mesh_fault fault = fault_of(file);
    CHECK(fault.code == code && fault.byte == byte && !strcmp(fault.section, section),
          "%s at %llu (%s), not %s at %llu (%s)", dpt_result_name(fault.code), (unsigned long long)fault.byte,
          fault.section, dpt_result_name(code), (unsigned long long)byte, section);
}

static int is_sound(const dpt_hit *hit)
{
    const double numbers[] = { hit->distance, hit->gap,  hit->depth, hit->s,    hit->p[0],        hit->q[0],
                               hit->p[1],     hit->q[1], hit->p[2],  hit->q[2], hit->error_bound, hit->lower_bound };
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        if (!isfinite(numbers[i]) && hit->status != DPT_STATUS_STALE)
            return 0;
    return 1;
}

/* Every vertex gathered from the source's, and moved by nodes: both stay within the arrays. */
static void use_driving(const dpt_mesh *mesh)
{
    dpt_mesh_info info = { .size = sizeof info };
    const uint32_t *sources, *nodes;
    const float *weights;
    uint32_t count = 0, node_count;
    dpt_mesh_get_info(mesh, &info);
    if (dpt_mesh_get_vertex_sources(mesh, &sources, &count) == DPT_OK)
        for (uint32_t v = 0; v < count; v++)
            CHECK(sources[v] < info.source_vertices, "vertex %u is %u", v, sources[v]);
    CHECK(dpt_mesh_get_embedding(mesh, &nodes, &weights, &node_count) == DPT_OK, "no embedding");
    for (uint32_t i = 0; i < (node_count ? 4 * count : 0); i++)
        CHECK(nodes[i] < node_count && fabs(weights[i]) <= 128.0, "node %u, weight %g", nodes[i], weights[i]);
}

/* Each spring's other end is a node, and has the spring too. */
static void use_springs(const dpt_mesh *mesh)
{
    dpt_mesh_springs net = { .size = sizeof net };
    double sum = 0.0;
    CHECK(dpt_mesh_get_springs(mesh, &net) == DPT_OK, "no answer about springs");
    for (uint32_t i = 0; i < net.nodes; i++) {
        CHECK(net.mass[i] >= 0.0f && net.drag[i] >= 0.0f && fabsf(net.rest[3 * i]) <= 2e6f, "node %u", i);
        for (uint32_t e = net.first[i / 16] * 16 + i % 16; e < net.first[i / 16 + 1] * 16; e += 16) {
            const uint32_t other = net.neighbours[e];
            CHECK(other < net.nodes && net.length[e] > 0.0f, "node %u, %u", i, other);
            sum += (double)net.stiffness[e] * (i < other ? 1.0 : -1.0);
        }
    }
    CHECK(fabs(sum) <= 1e16, "%g N/m on one side", sum);
}

void use_mesh(const dpt_mesh *mesh, uint64_t *random)
{
    static double block[12288];
    double ends[6 * 4];
    struct surface surface;
    struct kernel kernel;
    struct work work = work_of(WORK_UNLIMITED);
    uint32_t chosen;
    dpt_hit hits[4] = { DPT_HIT_INIT };
    dpt_query_def query = { .size = sizeof query };
    dpt_world_def def;
    dpt_world *world;
    dpt_body body;
    dpt_tool tool;
    for (int i = 0; i < 24; i++)
        ends[i] = random_in(random, -0.15, 0.15);
    use_driving(mesh);
    use_springs(mesh);
    dpti_surface_of_mesh(mesh, &surface);
    dpti_kernel_get(DPT_KERNEL_AUTO, &kernel, &chosen);
    for (int i = 0; i < 8; i++)
        CHECK(isfinite(dpti_winding_number(&surface, &kernel, vec3_of(ends + 3 * i), &work)),
              "a winding number that is none");
    for (query.method = 0; query.method <= DPT_METHOD_BRUTE; query.method++) {
        dpt_query_segments(mesh, NULL, ends, NULL, 4, hits, &query);
        for (int i = 0; i < 4; i++)
            CHECK(is_sound(&hits[i]), "hit %d is not finite", i);
    }
    dpt_world_def_init(&def);
    def.law = DPT_LAW_POINT;
    def.max_bodies = def.max_tools = def.max_segments = 1;
    def.max_tips = 0;
    def.certificate_bytes = 2048;
    def.smooth_normals = 1;
    CHECK(dpt_world_bytes(&def) <= sizeof block, "%zu bytes", dpt_world_bytes(&def));
    if (dpt_world_create(block, sizeof block, &def, &world) != DPT_OK ||
        dpt_body_add(world, mesh, NULL, &body) != DPT_OK)
        return;
    for (int i = 0; i < 4; i++) {
        dpt_segment segment = { { ends[6 * i], ends[6 * i + 1], ends[6 * i + 2] },
                                { ends[6 * i + 3], ends[6 * i + 4], ends[6 * i + 5] },
                                0.05 };
        dpt_wrench wrench;
        if (i == 0)
            dpt_tool_add(world, &segment, 1, &tool);
        dpt_tool_set_segments(world, tool, &segment, 1);
        dpt_world_step(world, 1e-3, NULL);
        dpt_tool_get_hit(world, tool, hits);
        dpt_tool_get_wrench(world, tool, &wrench);
        CHECK(is_sound(hits) && isfinite(wrench.force[0] + wrench.torque[0]), "not finite");
    }
}
