/* SPDX-License-Identifier: BSD-3-Clause */
/* Compiled meshes: opened, verified and turned, whole and damaged; what they tell, in and out of range. */
#include "fuzz/calls/rules.h"

enum { DAMAGED_MAX = 1 << 15 };

static uint64_t damaged[DAMAGED_MAX / 8 + 8];

/*
 * dpt_mesh_open, _verify and _convert, or an arm's; of NULL, off by some bytes, cut, or with a byte that is
 * another.
 */
static void open(void)
{
    const struct subject *mesh = draw_subject();
    const int of_arm = draw_one_in(4);
    const struct arm_subject *arm = &arm_subjects[draw_below(ARMS)];
    const size_t whole = of_arm ? arm->size : mesh->size;
    if (whole > DAMAGED_MAX)
        return;
    const size_t off = draw_one_in(10) ? 1 + draw_below(7) : 0;
    const size_t size = draw_one_in(6) ? draw_below((uint32_t)whole) : whole;
    const int no_bytes = draw_one_in(30), how = (int)draw_below(3), has_fault = draw_one_in(2);
    unsigned char *bytes = (unsigned char *)damaged + off;
    memcpy(bytes, of_arm ? arm->bytes : mesh->bytes, whole);
    int is_damaged = size < whole;
    if (draw_one_in(2) && size) {
        bytes[draw_below((uint32_t)size)] ^= (unsigned char)(1 + draw_below(255));
        is_damaged = 1;
    }
    const uint32_t fault_size = draw_size(sizeof(dpt_mesh_fault), sizeof(dpt_mesh_fault));
    dpt_mesh_fault *fault = output_sized(0, fault_size), now;
    const dpt_mesh *opened = NULL;
    const dpt_arm *opened_arm = NULL;
    struct codes codes = { .count = 0 };
    may_fail(&codes, no_bytes, DPT_E_ARGUMENT);
    may_fail(&codes, off != 0, DPT_E_ALIGN);
    if (how && has_fault)
        size_codes_of_output(fault_size, sizeof now, 0, &codes);
    for (int code = DPT_E_INDEX; code <= DPT_E_MAGIC; code++)
        may_fail(&codes, is_damaged, code);
    may_fail(&codes, is_damaged, DPT_E_FINITE);
    may_fail(&codes, is_damaged, DPT_E_POSE);
    call_with("%llu bytes of %llu, off by %llu", size, whole, off, 0);
    fault = has_fault ? fault : NULL;
    const void *given = no_bytes ? NULL : bytes;
    dpt_result result;
    if (of_arm)
        result = how == 0   ? RESULT(dpt_arm_open, given, size, &opened_arm)
                 : how == 1 ? RESULT(dpt_arm_verify, given, size, fault)
                            : RESULT(dpt_arm_convert, no_bytes ? NULL : bytes, size, fault);
    else
        result = how == 0   ? RESULT(dpt_mesh_open, given, size, &opened)
                 : how == 1 ? RESULT(dpt_mesh_verify, given, size, fault)
                            : RESULT(dpt_mesh_convert, no_bytes ? NULL : bytes, size, fault);
    expect(result, &codes);
    HOLDS((opened || opened_arm) == (result == DPT_OK && how == 0), "%s", dpt_result_name(result));
    outputs_are_guarded(0, 1);
    if (!how || !has_fault || output_is_untouched(0, sizeof fault_size))
        return;
    if (output_read(0, fault_size, sizeof now, sizeof now, &now) && result != DPT_OK)
        HOLDS(now.code == result && now.byte <= whole && memchr(now.section, 0, sizeof now.section),
              "code %d, byte %llu", now.code, (unsigned long long)now.byte);
}

static void refuse_null(void)
{
    const dpt_mesh *mesh;
    const struct subject *subject = draw_subject();
    HOLDS(RESULT(dpt_mesh_open, subject->bytes, subject->size, NULL) == DPT_E_ARGUMENT, "nowhere");
    HOLDS(RESULT(dpt_mesh_open, arm_subjects[0].bytes, arm_subjects[0].size, &mesh) == DPT_E_MAGIC,
          "an arm is no mesh");
    HOLDS(RESULT(dpt_mesh_open, subject->bytes, subject->size, &mesh) == DPT_OK && mesh == subject->mesh,
          "a pointer into the bytes");
}

static void info(void)
{
    const struct subject *subject = draw_subject();
    const int no_mesh = draw_one_in(40), no_out = draw_one_in(40);
    const size_t first = offsetof(dpt_mesh_info, solid_components);
    dpt_mesh_info now;
    const uint32_t size = draw_size(first, sizeof now);
    struct codes codes = { .count = 0 };
    may_fail(&codes, no_mesh || no_out, DPT_E_ARGUMENT);
    if (!no_out)
        size_codes_of_output(size, first, 0, &codes);
    dpt_mesh_info *out = output_sized(0, size);
    call_with("size %llu", size, 0, 0, 0);
    const dpt_result result = RESULT(dpt_mesh_get_info, no_mesh ? NULL : subject->mesh, no_out ? NULL : out);
    expect(result, &codes);
    outputs_are_guarded(0, 1);
    if (result != DPT_OK) {
        HOLDS(output_is_untouched(0, sizeof size), "written on an error");
        return;
    }
    const int is_whole = output_read(0, size, sizeof now, sizeof now, &now);
    numbers_are_finite(&now.scale, 8, "scale, rounding, the box");
    HOLDS(now.triangles + now.dropped_degenerate + now.dropped_duplicate == now.source_triangles &&
              now.triangles == subject->triangles && now.bytes == subject->size,
          "%u triangles of %u", now.triangles, now.source_triangles);
    HOLDS(now.closed_components <= now.components && now.box_min[0] <= now.box_max[0] &&
              (!is_whole || (now.solid_components <= now.components && isfinite(now.crease))),
          "%u of %u parts are closed", now.closed_components, now.components);
}

static void section(void)
{
    const struct subject *subject = draw_subject();
    const uint32_t index = draw_one_in(8) ? (uint32_t)draw_bits() >> draw_below(32) : draw_below(28);
    const int no_mesh = draw_one_in(40), no_out = draw_one_in(40);
    uint32_t sections; /* docs/format.md: how many there are depends on the version of the file */
    dpt_mesh_section now;
    const uint32_t size = draw_size(sizeof now, sizeof now);
    dpt_mesh_section *out = output_sized(0, size);
    struct codes codes = { .count = 0 };
    memcpy(&sections, (const unsigned char *)subject->mesh + 24, sizeof sections);
    may_fail(&codes, no_mesh || no_out || index >= sections, DPT_E_ARGUMENT);
    if (!no_out)
        size_codes_of_output(size, sizeof now, 0, &codes);
    call_with("section %llu, size %llu", index, size, 0, 0);
    const dpt_result result = RESULT(dpt_mesh_get_section, no_mesh ? NULL : subject->mesh, index, no_out ? NULL : out);
    expect(result, &codes);
    outputs_are_guarded(0, 1);
    if (result == DPT_OK && output_read(0, size, sizeof now, sizeof now, &now))
        HOLDS(now.offset <= subject->size && now.bytes <= subject->size - now.offset &&
                  memchr(now.name, 0, sizeof now.name),
              "section %u at %llu", index, (unsigned long long)now.offset);
}

/* A triangle's corners, normals and flags: all there, or none. */
static void triangle(void)
{
    const struct subject *subject = draw_subject();
    const uint32_t number =
        draw_one_in(4) ? (uint32_t)draw_bits() >> draw_below(32) : draw_below(subject->source_triangles);
    const int no_mesh = draw_one_in(40), no_out = draw_one_in(40), kind = (int)draw_below(3);
    const dpt_mesh *mesh = no_mesh ? NULL : subject->mesh;
    double corners[9];
    struct codes codes = { .count = 0 };
    may_fail(&codes, no_mesh || no_out || number >= subject->source_triangles, DPT_E_ARGUMENT);
    const int is_there = RESULT(dpt_mesh_get_triangle, subject->mesh, number, corners) == DPT_OK;
    HOLDS(is_there || codes.count || subject->triangles < subject->source_triangles, "triangle %u is missing", number);
    may_fail(&codes, !is_there, DPT_E_ARGUMENT);
    double *out = output_of(0, 9 * sizeof *out);
    uint32_t *flags = output_of(1, sizeof *flags);
    out = no_out ? NULL : out;
    call_with("triangle %llu of %llu", number, subject->source_triangles, 0, 0);
    const dpt_result result = kind == 0   ? RESULT(dpt_mesh_get_triangle, mesh, number, out)
                              : kind == 1 ? RESULT(dpt_mesh_get_vertex_normals, mesh, number, out)
                                          : RESULT(dpt_mesh_get_triangle_flags, mesh, number, no_out ? NULL : flags);
    expect(result, &codes);
    outputs_are_guarded(0, 2);
    if (result != DPT_OK) {
        HOLDS(output_is_untouched(0, 0) && output_is_untouched(1, 0), "written on an error");
        return;
    }
    if (kind == 2) {
        HOLDS(*flags < 1u << 18, "flags %x", *flags);
        return;
    }
    numbers_are_finite(out, 9, "a triangle");
    game_digest(out, 9 * sizeof *out);
    const double zero[3] = { 0.0, 0.0, 0.0 };
    for (int k = 0; kind == 1 && k < 9; k += 3)
        HOLDS(apart(out + k, zero) == 0.0 || fabs(apart(out + k, zero) - 1.0) < 1e-6, "a normal of length %g",
              apart(out + k, zero));
}

static void all_at_once(void)
{
    const struct subject *subject = draw_subject();
    const int no_mesh = draw_one_in(10), no_out = draw_one_in(10), no_count = draw_one_in(10);
    const dpt_mesh *mesh = no_mesh ? NULL : subject->mesh;
    const float *xyz = NULL;
    const uint32_t *corners = NULL, *numbers = NULL;
    uint32_t vertices = 0, triangles = 0;
    struct codes codes = { .count = 0 };
    may_fail(&codes, no_mesh || no_out || no_count, DPT_E_ARGUMENT);
    expect(RESULT(dpt_mesh_get_vertices, mesh, no_out ? NULL : &xyz, no_count ? NULL : &vertices), &codes);
    expect(RESULT(dpt_mesh_get_triangles, mesh, no_out ? NULL : &corners, &numbers, no_count ? NULL : &triangles),
           &codes);
    if (codes.count)
        return;
    HOLDS(triangles == subject->triangles, "%u triangles", triangles);
    for (uint32_t i = 0; i < 3 * triangles; i++)
        HOLDS(corners[i] < vertices && isfinite(xyz[3 * corners[i]]), "corner %u", i);
    for (uint32_t i = 0; i < triangles; i++)
        HOLDS(numbers[i] < subject->source_triangles, "number %u", numbers[i]);
}

/* What a program needs that moves the vertices by physics of its own. */
static void driving(void)
{
    const struct subject *subject = draw_subject();
    const int no_mesh = draw_one_in(10), no_out = draw_one_in(10), no_count = draw_one_in(10);
    const dpt_mesh *mesh = no_mesh ? NULL : subject->mesh;
    const uint32_t *sources = NULL, *nodes = NULL;
    const float *weights = NULL;
    uint32_t vertices = 0, node_count = 77;
    dpt_mesh_info now = { .size = sizeof now };
    struct codes codes = { .count = 0 };
    may_fail(&codes, no_mesh || no_out || no_count, DPT_E_ARGUMENT);
    expect(RESULT(dpt_mesh_get_vertex_sources, mesh, no_out ? NULL : &sources, no_count ? NULL : &vertices), &codes);
    expect(RESULT(dpt_mesh_get_embedding, mesh, no_out ? NULL : &nodes, &weights, no_count ? NULL : &node_count),
           &codes);
    HOLDS(!codes.count || (!sources && !vertices && !nodes && !weights && node_count == 77), "written on an error");
    if (codes.count)
        return;
    HOLDS(RESULT(dpt_mesh_get_info, subject->mesh, &now) == DPT_OK && now.nodes == node_count &&
              now.vertices == vertices && now.outside_vertices <= vertices && now.outside_distance >= 0.0,
          "%u nodes, %u vertices", node_count, vertices);
    HOLDS((nodes != NULL) == (node_count > 0) && (weights != NULL) == (node_count > 0), "arrays of %u nodes",
          node_count);
    for (uint32_t v = 0; v < vertices; v++)
        HOLDS(sources[v] < now.source_vertices, "vertex %u is %u", v, sources[v]);
    for (uint32_t i = 0; node_count && i < 4 * vertices; i++)
        HOLDS(nodes[i] < node_count && fabs((double)weights[i]) <= 128.0, "node %u, weight %g", nodes[i],
              (double)weights[i]);
}

/* Springs: each end is a node, and has the spring too. */
static void springs(void)
{
    const struct subject *subject = draw_subject();
    const int no_mesh = draw_one_in(10), no_out = draw_one_in(10);
    dpt_mesh_springs now;
    dpt_mesh_info info = { .size = sizeof info };
    const uint32_t size = draw_size(sizeof now, sizeof now);
    struct codes codes = { .count = 0 };
    may_fail(&codes, no_mesh || no_out, DPT_E_ARGUMENT);
    if (!no_out)
        size_codes_of_output(size, sizeof now, 0, &codes);
    dpt_mesh_springs *out = output_sized(0, size);
    const dpt_result result = RESULT(dpt_mesh_get_springs, no_mesh ? NULL : subject->mesh, no_out ? NULL : out);
    expect(result, &codes);
    outputs_are_guarded(0, 1);
    if (result != DPT_OK) {
        HOLDS(output_is_untouched(0, sizeof size), "written on an error");
        return;
    }
    /* The pointers are none of the game's. */
    const uint64_t digest = run.digest;
    const int is_whole = output_read(0, size, sizeof now, sizeof now, &now);
    run.digest = digest;
    game_digest(&now, offsetof(dpt_mesh_springs, rest));
    if (!is_whole)
        return;
    HOLDS(RESULT(dpt_mesh_get_info, subject->mesh, &info) == DPT_OK && info.spring_nodes == now.nodes &&
              info.springs == now.springs && info.fixed_nodes <= now.nodes &&
              (info.stable_step > 0.0) == (now.nodes > 0) && now.slices == (now.nodes + 15) / 16,
          "%u nodes, %u springs", now.nodes, now.springs);
    double sum = 0.0;
    for (uint32_t i = 0; i < now.nodes; i++)
        for (uint32_t e = now.first[i / 16] * 16 + i % 16; e < now.first[i / 16 + 1] * 16; e += 16) {
            HOLDS(now.neighbours[e] < now.nodes && now.length[e] > 0.0f, "node %u, %u", i, now.neighbours[e]);
            sum += i < now.neighbours[e] ? 1.0 : i > now.neighbours[e] ? -1.0 : 0.0;
        }
    HOLDS(sum == 0.0, "%g springs too many at the lower ends", sum);
}

static const struct move moves[] = {
    { "open", open, 3 },       { "refuse NULL", refuse_null, 1 }, { "info", info, 4 },
    { "section", section, 3 }, { "triangle", triangle, 8 },       { "all at once", all_at_once, 1 },
    { "driving", driving, 2 }, { "springs", springs, 2 },         { NULL, NULL, 0 }
};

const struct noun mesh_noun = { "mesh", NULL, NULL, moves };
