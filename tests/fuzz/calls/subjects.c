/* SPDX-License-Identifier: BSD-3-Clause */
/* What calls are about: tiny meshes of all kinds, arms, a trace, an OBJ. Made once, and never changed. */
#include <unistd.h>

#include "dynpoint/compile.h"
#include "fuzz/calls/calls.h"
#include "lib/arm_random.h"
#include "scene/shape.h"

/* The last one is this game's own, if it has one. */
struct subject subjects[MESHES + 1];
struct arm_subject arm_subjects[ARMS];
char trace_path[64], obj_path[64];

static dpt_compiled compiled[MESHES + 1 + ARMS];

static int take_triangles(struct subject *subject)
{
    const uint32_t *numbers;
    uint32_t count;
    if (subject->source_triangles > TRIANGLES_MOST ||
        dpt_mesh_get_vertices(subject->mesh, &subject->positions, &subject->vertices) != DPT_OK ||
        dpt_mesh_get_triangles(subject->mesh, &subject->corners, &numbers, &count) != DPT_OK ||
        subject->vertices > VERTICES_MOST)
        return 0;
    memset(subject->place, 0xff, sizeof subject->place);
    for (uint32_t i = 0; i < count; i++)
        subject->place[numbers[i]] = i;
    return 1;
}

static int take_mesh(struct subject *subject, const char *name, dpt_compiled *bytes)
{
    dpt_mesh_info info = { .size = sizeof info };
    if (dpt_mesh_convert(bytes->bytes, bytes->size, NULL) != DPT_OK ||
        dpt_mesh_open(bytes->bytes, bytes->size, &subject->mesh) != DPT_OK ||
        dpt_mesh_get_info(subject->mesh, &info) != DPT_OK)
        return 0;
    subject->name = name;
    subject->bytes = bytes->bytes;
    subject->size = bytes->size;
    subject->source_triangles = info.source_triangles;
    subject->triangles = info.triangles;
    subject->is_solid = info.components == 1 && info.closed_components == 1 && info.self_intersections == 0;
    return take_triangles(subject);
}

/* A cell of four nodes about the origin. */
static const double nodes[] = { 0, 0, 0.4, 0.4, 0, -0.2, -0.2, 0.3, -0.2, -0.2, -0.3, -0.2 };
static const uint32_t cell[] = { 0, 1, 2, 3 };

/* `missing`: without its last triangles. `has_cell`: embedded. The membrane has springs. */
static int open_shape(int i, const char *name, uint64_t count, size_t missing, int has_cell)
{
    const dpt_spring_net_def springs = { .size = sizeof springs, .kind = DPT_NET_SHEET };
    const dpt_compile_def def = { .size = sizeof def,
                                  .springs = i == 2 ? &springs : NULL,
                                  .nodes = nodes,
                                  .cells = cell,
                                  .node_count = has_cell ? 4 : 0,
                                  .cell_count = has_cell ? 1 : 0 };
    struct shape shape;
    shape_reason reason;
    if (shape_make(name, count, 0, &shape, reason) != 0)
        return 0;
    const dpt_result result = dpt_compile_arrays(shape.vertices, shape.vertex_count, shape.corners,
                                                 shape.triangle_count - missing, &def, &compiled[i], NULL);
    shape_free(&shape);
    return result == DPT_OK && take_mesh(&subjects[i], name, &compiled[i]);
}

/* Loose triangles across each other, two of them dropped: one without area, one that is there twice. */
static int open_soup(int i)
{
    enum { TRIANGLES = 9 };
    double vertices[9 * TRIANGLES];
    uint32_t corners[3 * TRIANGLES];
    uint64_t random = 11;
    for (int k = 0; k < 9 * TRIANGLES; k++)
        vertices[k] = random_in(&random, -0.06, 0.06);
    for (uint32_t k = 0; k < 3 * TRIANGLES; k++)
        corners[k] = k;
    corners[14] = corners[13];
    memcpy(corners + 18, corners + 3, 3 * sizeof *corners);
    return dpt_compile_arrays(vertices, 3 * TRIANGLES, corners, TRIANGLES, NULL, &compiled[i], NULL) == DPT_OK &&
           take_mesh(&subjects[i], "soup", &compiled[i]);
}

static int open_arm(int i)
{
    static const double tip_corners[12] = { 0, 0, 0, 0.01, 0, 0, 0, 0.01, 0, 0, 0, 0.01 };
    static struct arm_arrays arrays;
    struct arm_subject *arm = &arm_subjects[i];
    dpt_compiled *bytes = &compiled[MESHES + 1 + i];
    uint64_t random = 3 + (uint64_t)i;
    arm_random(&random, &arrays);
    arrays.def.segment_count = (uint32_t)i;
    for (int k = 0; k < i; k++)
        arrays.segments[k] = (dpt_segment){ { 0, 0, 0 }, { 0, 0, 0.1 }, 0.01 };
    arrays.def.jaws = arrays.jaws;
    arrays.def.jaw_links = arrays.jaw_links;
    arrays.def.tips = arrays.tips;
    arrays.def.body_count = i == 1;
    arrays.bodies[0] = (dpt_arm_body){
        .size = sizeof(dpt_arm_body), .pose = DPT_POSE_IDENTITY, .mesh = subjects[0].mesh, .name = "box"
    };
    /* The second arm has jaws: what moves its own first joint, once more at the tool. */
    if (i == 1) {
        arrays.jaws[0] = arrays.joints[0];
        arrays.jaw_links[0] = arrays.links[0];
        arrays.jaw_links[0].parent = DPT_NONE;
        arrays.jaw_links[0].slides = arrays.jaws[0].kind == DPT_JOINT_PRISMATIC;
        arrays.jaw_links[0].joint = 0;
        arrays.def.jaw_count = arrays.def.jaw_link_count = 1;
        arrays.def.tip_count = 2;
        for (int k = 0; k < 2; k++)
            arrays.tips[k] = (dpt_arm_tip){
                .size = sizeof *arrays.tips, .link = k ? 0 : DPT_NONE, .corner_count = 4, .corners = tip_corners
            };
    }
    if (dpt_compile_arm(&arrays.def, bytes, NULL) != DPT_OK ||
        dpt_arm_convert(bytes->bytes, bytes->size, NULL) != DPT_OK ||
        dpt_arm_open(bytes->bytes, bytes->size, &arm->arm) != DPT_OK)
        return 0;
    arm->bytes = bytes->bytes;
    arm->size = bytes->size;
    arm->joints = arrays.def.joint_count;
    arm->links = arrays.def.link_count;
    arm->segments = arrays.def.segment_count;
    arm->bodies = arrays.def.body_count;
    arm->jaws = arrays.def.jaw_count;
    arm->jaw_links = arrays.def.jaw_link_count;
    arm->tips = arrays.def.tip_count;
    return 1;
}

static FILE *new_file(char path[64])
{
    strcpy(path, "/tmp/dynpoint-calls-XXXXXX");
    const int file = mkstemp(path);
    return file < 0 ? NULL : fdopen(file, "w");
}

static int write_files(void)
{
    FILE *trace = new_file(trace_path), *obj = new_file(obj_path);
    if (!trace || !obj)
        return 0;
    fprintf(trace, "tick,ax,ay,az,bx,by,bz\n");
    for (int i = 0; i < 40; i++)
        fprintf(trace, "%d,%g,%g,0,%g,0.02,%g\n", i < 20 ? i : i + 5, 0.001 * i, 0.1 - 0.004 * i, 0.02 + 0.001 * i,
                0.001 * (i % 7));
    fprintf(obj, "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
    return fclose(trace) == 0 && fclose(obj) == 0;
}

int subjects_open(void)
{
    if (!open_shape(0, "box", 12, 0, 0) || !open_shape(1, "torus", 200, 0, 1) || !open_shape(2, "membrane", 18, 0, 0) ||
        !open_shape(3, "sphere", 60, 0, 0) || !open_soup(4) || !open_shape(5, "torus", 48, 3, 0) ||
        !open_shape(6, "hub", 7, 0, 0) || !write_files())
        return 0;
    for (int i = 0; i < ARMS; i++)
        if (!open_arm(i))
            return 0;
    return 1;
}

void subjects_close(void)
{
    for (size_t i = 0; i < sizeof compiled / sizeof *compiled; i++)
        dpt_compiled_free(&compiled[i]);
    unlink(trace_path);
    unlink(obj_path);
}

int subject_is_adopted(void)
{
    return subjects[MESHES].mesh != NULL;
}

void subject_adopt(const dpt_mesh *mesh, void *bytes, size_t size)
{
    dpt_compiled taken = { bytes, size };
    HOLDS(mesh && take_mesh(&subjects[MESHES], "compiled", &taken), "what compiled does not open");
}

const struct subject *draw_subject(void)
{
    return &subjects[draw_below(MESHES + (subject_is_adopted() ? 1u : 0u))];
}
