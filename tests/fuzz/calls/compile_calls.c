/* SPDX-License-Identifier: BSD-3-Clause */
/* The compiler: arrays of a few triangles, well and badly formed; bytes and files; arms from arrays. */
#include "dynpoint/compile.h"
#include "fuzz/calls/calls.h"
#include "lib/arm_random.h"

enum { VERTICES_MAX = 24, TRIANGLES_MAX = 24, NODES_MAX = 6, CELLS_MAX = 2, REGIONS_MAX = 2 };

static dpt_compiled adopted;

struct progress {
    int calls, stops_at;
};

static int progress(void *user, const char *step, double done)
{
    struct progress *of = user;
    HOLDS(step && step[0] && done >= 0.0 && done <= 1.0, "progress %g", done);
    return ++of->calls == of->stops_at;
}

/* A def that says little, or something wrong. */
struct given_def {
    const void *given;
    dpt_compile_def def;
    struct progress progress;
    double nodes[3 * NODES_MAX];
    uint32_t cells[4 * CELLS_MAX];
    dpt_spring_net_def springs;
    dpt_spring_region regions[REGIONS_MAX];
    uint32_t fixed;
    struct codes codes;
};

/* An embedding: any nodes, any cells. What is counted but not there is the def's to refuse. */
static void draw_cells(struct given_def *of)
{
    dpt_compile_def *def = &of->def;
    for (int i = 0; i < 3 * NODES_MAX; i++)
        of->nodes[i] = draw_in(-0.2, 0.2);
    for (int i = 0; i < 4 * CELLS_MAX; i++)
        of->cells[i] = draw_below(NODES_MAX);
    if (draw_one_in(16))
        of->nodes[draw_below(3 * NODES_MAX)] = draw_odd_number();
    if (draw_one_in(16))
        of->cells[draw_below(4 * CELLS_MAX)] = (uint32_t)draw_bits() >> draw_below(32);
    def->nodes = draw_one_in(30) ? NULL : of->nodes;
    def->cells = draw_one_in(30) ? NULL : of->cells;
    def->node_count = draw_one_in(30) ? 0 : NODES_MAX - draw_below(2);
    def->cell_count = draw_one_in(30) ? 0 : 1 + draw_below(CELLS_MAX);
}

/* What of these the compiler refuses; what has no volume or is too far from a vertex is its to say. */
static void cells_may_fail(struct given_def *of)
{
    const dpt_compile_def *def = &of->def;
    const uint32_t nodes = def->node_count, cells = def->cell_count;
    if (!nodes && !cells)
        return;
    of->codes.or_done |= !of->codes.count;
    may_fail(&of->codes, !nodes || !cells || !def->nodes || !def->cells, DPT_E_ARGUMENT);
    of->codes.or_done &= nodes && cells && def->nodes && def->cells;
    for (uint32_t i = 0; i < 4 * cells; i++)
        may_fail(&of->codes, of->cells[i] >= nodes, DPT_E_INDEX);
    for (uint32_t i = 0; i < 4 * cells; i++)
        of->codes.or_done &= of->cells[i] < nodes;
    may_fail(&of->codes, 1, DPT_E_FINITE);
}

/* Springs of either kind, some of them nonsense. */
static void draw_springs(struct given_def *of)
{
    dpt_spring_net_def *springs = &of->springs;
    CALL(dpt_spring_net_def_defaults, springs, sizeof *springs);
    springs->kind = draw_one_in(16) ? draw_below(5) : 1 + draw_below(2);
    springs->spacing = draw_in(0.02, 0.2);
    springs->viscosity = draw_in(0.0, 0.01);
    springs->bending = draw_one_in(2) ? 0.0 : draw_in(0.0, 1e4);
    for (int i = 0; i < REGIONS_MAX; i++) {
        dpt_spring_region *region = &of->regions[i];
        *region = (dpt_spring_region){ .kind = draw_one_in(16) ? draw_below(5) : 1 + draw_below(2),
                                       .fixed = draw_below(2),
                                       .young = draw_in(1.0, 1e5),
                                       .density = draw_in(1.0, 1e4) };
        for (int k = 0; k < 6; k++)
            region->box[k] = k < 3 ? draw_in(-0.2, 0.1) : draw_in(0.0, 0.3);
    }
    of->fixed = draw_below(VERTICES_MAX);
    springs->regions = draw_one_in(30) ? NULL : of->regions;
    springs->region_count = draw_below(REGIONS_MAX + 1);
    springs->fixed = draw_one_in(30) ? NULL : &of->fixed;
    springs->fixed_count = draw_below(2);
    double *const numbers[] = { &springs->young,   &springs->density, &springs->drag,        &springs->viscosity,
                                &springs->spacing, &springs->bending, &of->regions[0].young, &of->regions[0].box[2] };
    if (draw_one_in(12))
        *numbers[draw_below(8)] = draw_odd_number();
    if (draw_one_in(30))
        springs->size = (uint32_t)draw_bits() >> draw_below(32);
    of->def.springs = springs;
}

/* What they make of the mesh, and what is in a region, is the compiler's to say. */
static void springs_may_fail(struct given_def *of)
{
    of->codes.or_done |= !of->codes.count;
    may_fail(&of->codes, 1, DPT_E_ARGUMENT);
    may_fail(&of->codes, 1, DPT_E_FINITE);
    may_fail(&of->codes, 1, DPT_E_LIMIT);
    may_fail(&of->codes, of->springs.fixed_count > 0, DPT_E_INDEX);
    may_fail(&of->codes, of->springs.size != sizeof of->springs, DPT_E_SIZE);
    may_fail(&of->codes, of->springs.size > sizeof of->springs, DPT_E_UNSUPPORTED);
}

static void draw_def(struct given_def *of)
{
    const size_t first = offsetof(dpt_compile_def, crease);
    *of = (struct given_def){ .given = NULL };
    dpt_compile_def *def = &of->def;
    if (draw_one_in(3))
        return;
    if (draw_one_in(4)) {
        CALL(dpt_compile_def_defaults, def, sizeof *def);
    } else {
        *def = (dpt_compile_def){ .format = draw_one_in(12) ? draw_below(7) : 0,
                                  .crease = draw_one_in(2) ? 0.0 : draw_in(0.01, 3.1),
                                  .threads = draw_below(3),
                                  .recentre = draw_one_in(30) ? 2u : draw_below(2) };
        def->scale = draw_one_in(2) ? 0.0 : draw_in(0.1, 10.0);
    }
    if (draw_one_in(20))
        *(draw_one_in(2) ? &def->scale : &def->crease) = draw_odd_number();
    if (draw_one_in(3)) {
        of->progress.stops_at = draw_one_in(2) ? 1 + (int)draw_below(8) : 0;
        def->progress = progress;
        def->user = &of->progress;
    }
    if (draw_one_in(4))
        def->name = draw_one_in(2) ? "a.b/organ.stl" : "organ.";
    if (draw_one_in(4))
        draw_cells(of);
    if (draw_one_in(4))
        draw_springs(of);
    uint32_t size = draw_size(first, sizeof *def);
    /* Half a pointer leads anywhere, and half a count is one. */
    if (size > offsetof(dpt_compile_def, nodes) && size < offsetof(dpt_compile_def, name))
        size = sizeof *def;
    of->given = draw_input(2, def, size, first, sizeof *def, &of->codes);
    /* What it does not reach to has its default. */
    if (size < sizeof *def)
        def->recentre = 0;
    if (size < offsetof(dpt_compile_def, threads))
        def->crease = 0.0;
    may_fail(&of->codes,
             def->format > DPT_FORMAT_OFF || def->recentre > 1 || !(def->scale >= 0.0) || !(def->scale <= 1e30) ||
                 !(def->crease >= 0.0 && def->crease <= 3.1415926536),
             DPT_E_ARGUMENT);
    /* Half a field is nobody's. */
    of->codes.or_done = !of->codes.count && size > first && size < sizeof *def;
    may_fail(&of->codes, of->codes.or_done, DPT_E_ARGUMENT);
    if (size >= offsetof(dpt_compile_def, springs))
        cells_may_fail(of);
    may_fail(&of->codes, size >= offsetof(dpt_compile_def, springs) && def->cell_count && def->recentre,
             DPT_E_ARGUMENT);
    if (size >= offsetof(dpt_compile_def, name) && def->springs)
        springs_may_fail(of);
}

struct outcome {
    dpt_compiled out;
    int has_diag;
    uint32_t diag_size;
};

/* Nothing is left on an error; and the diag says why. */
static void outcome_must_hold(struct outcome *of, dpt_result result, int no_out)
{
    outputs_are_guarded(0, 1);
    if (no_out)
        return;
    HOLDS((result == DPT_OK) == (of->out.bytes != NULL) && (of->out.bytes || !of->out.size), "%s, %zu bytes",
          dpt_result_name(result), of->out.size);
    HOLDS((uintptr_t)of->out.bytes % 64 == 0, "not aligned to 64");
    dpt_diag now;
    if (!of->has_diag || result == DPT_OK || output_is_untouched(0, sizeof of->diag_size))
        return;
    if (!output_read(0, of->diag_size, sizeof now, sizeof now, &now))
        return;
    HOLDS(now.code == result && now.text[0] && memchr(now.text, 0, sizeof now.text), "%s: %.40s",
          dpt_result_name(result), now.text);
}

static dpt_diag *draw_diag(struct outcome *of, struct codes *codes)
{
    of->has_diag = !draw_one_in(3);
    of->diag_size = draw_size(sizeof(dpt_diag), sizeof(dpt_diag));
    dpt_diag *diag = output_sized(0, of->diag_size);
    if (of->has_diag)
        size_codes_of_output(of->diag_size, sizeof *diag, 0, codes);
    return of->has_diag ? diag : NULL;
}

/* It opens, and tells of as many triangles; it may be this game's own from now on. */
static void take(struct outcome *of, size_t triangles)
{
    const dpt_mesh *mesh = NULL;
    dpt_mesh_info info = { .size = sizeof info };
    if (!of->out.bytes)
        return;
    HOLDS(RESULT(dpt_mesh_convert, of->out.bytes, of->out.size, NULL) == DPT_OK &&
              RESULT(dpt_mesh_open, of->out.bytes, of->out.size, &mesh) == DPT_OK &&
              RESULT(dpt_mesh_get_info, mesh, &info) == DPT_OK,
          "what was compiled does not open");
    HOLDS(info.source_triangles == triangles || !triangles, "%u triangles of %zu", info.source_triangles, triangles);
    game_digest(of->out.bytes, of->out.size);
    int is_near = info.nodes <= 4; /* as the game's nodes are */
    for (int k = 0; k < 3; k++)
        is_near &= info.box_min[k] > -1.0 && info.box_max[k] < 1.0;
    if (is_near && !subject_is_adopted() && draw_one_in(2)) {
        adopted = of->out;
        subject_adopt(mesh, of->out.bytes, of->out.size);
        return;
    }
    CALL(dpt_compiled_free, &of->out);
}

/* Vertices at few places, so that some are equal. */
static uint32_t draw_vertices(double *vertices)
{
    const uint32_t count = draw_one_in(20) ? 0 : 1 + draw_below(VERTICES_MAX);
    const double scale = draw_one_in(20) ? 1e6 : 0.1;
    for (uint32_t i = 0; i < 3 * count; i++)
        vertices[i] = draw_one_in(2) ? scale * (draw_below(4) - 1.5) : draw_in(-scale, scale);
    if (draw_one_in(16) && count)
        vertices[draw_below(3 * count)] = draw_odd_number();
    return count;
}

/*
 * Whether floats may be too coarse for a mesh: their rounding is above a tenth of the median edge, which is no shorter than
 * the shortest.
 */
static int may_be_coarse(const double *vertices, const uint32_t *corners, uint32_t triangles, uint32_t count,
                         double scale)
{
    double far = 0.0, shortest = HUGE_VAL;
    for (uint32_t i = 0; i < 3 * triangles; i++) {
        const uint32_t from = corners[i], to = corners[i % 3 == 2 ? i - 2 : i + 1];
        double square = 0.0;
        for (int k = 0; from < count && to < count && k < 3; k++) {
            const double way = scale * (vertices[3 * to + (uint32_t)k] - vertices[3 * from + (uint32_t)k]);
            far = fmax(far, fabs(scale * vertices[3 * from + (uint32_t)k]));
            square += way * way;
        }
        if (square > 0.0)
            shortest = fmin(shortest, sqrt(square));
    }
    return 0x1p-23 * far > 0.1 * shortest;
}

static void arrays(void)
{
    double vertices[3 * VERTICES_MAX];
    uint32_t corners[3 * TRIANGLES_MAX];
    struct given_def def;
    struct outcome of = { .out = { NULL, 0 } };
    const uint32_t count = draw_vertices(vertices);
    const uint32_t triangles = draw_one_in(20) ? 0 : 1 + draw_below(TRIANGLES_MAX);
    for (uint32_t i = 0; i < 3 * triangles; i++)
        corners[i] = count ? draw_below(count) : 0;
    if (draw_one_in(16) && triangles)
        corners[draw_below(3 * triangles)] = (uint32_t)draw_bits() >> draw_below(32);
    draw_def(&def);
    struct codes codes = def.codes;
    dpt_diag *diag = draw_diag(&of, &codes);
    const int no_out = draw_one_in(40), no_vertices = draw_one_in(40), no_corners = draw_one_in(40);
    const double scale = def.given && def.def.scale != 0.0 ? def.def.scale : 1.0;
    const int is_moved = def.given && def.def.recentre;
    const double farthest = is_moved ? 1e9 : DPT_COORDINATE_MAX;
    may_fail(&codes, no_out || (no_vertices && count) || (no_corners && triangles), DPT_E_ARGUMENT);
    for (uint32_t i = 0; i < 3 * count; i++)
        may_fail(&codes, !(fabs(scale * vertices[i]) <= farthest), DPT_E_FINITE);
    for (uint32_t i = 0; i < 3 * triangles; i++)
        may_fail(&codes, corners[i] >= count, DPT_E_INDEX);
    may_fail(&codes, def.progress.stops_at > 0, DPT_E_CANCELLED);
    may_fail(&codes, !triangles, DPT_E_EMPTY);
    /*
     * Whether a triangle has an area after rounding is the compiler's to say; so is whether it comes to the last
     * step.
     */
    codes.or_done |= !codes.count || (codes.count == 1 && def.progress.stops_at > 0);
    may_fail(&codes, 1, DPT_E_EMPTY);
    /* A mesh that is moved may be far away, but not larger; vertices of no triangle do not count. */
    for (uint32_t i = 0; i < 3 * count; i++)
        may_fail(&codes, is_moved && fabs(scale * vertices[i]) > 0.5 * DPT_COORDINATE_MAX, DPT_E_FINITE);
    may_fail(&codes, may_be_coarse(vertices, corners, triangles, count, scale), DPT_E_FINITE);
    call_with("%llu vertices, %llu triangles", count, triangles, 0, 0);
    const dpt_result result = RESULT(dpt_compile_arrays, no_vertices ? NULL : vertices, count,
                                     no_corners ? NULL : corners, triangles, def.given, no_out ? NULL : &of.out, diag);
    expect(result, &codes);
    outcome_must_hold(&of, result, no_out);
    HOLDS(!def.progress.stops_at || def.progress.calls <= def.progress.stops_at, "it went on after it was stopped");
    if (result == DPT_OK)
        take(&of, triangles);
}

/* As text, and from a file; what a reader makes of any bytes is for tests/fuzz. */
static void bytes(void)
{
    static const char *const texts[] = { "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
                                         "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "", "f 1 2 3\n",
                                         "nothing that is known" };
    struct given_def def;
    struct outcome of = { .out = { NULL, 0 } };
    draw_def(&def);
    struct codes codes = def.codes;
    dpt_diag *diag = draw_diag(&of, &codes);
    const int of_file = draw_one_in(2), no_out = draw_one_in(40), no_text = draw_one_in(20);
    const uint32_t which = draw_below(5);
    const char *path = which ? obj_path : "/nonexistent/mesh.obj";
    may_fail(&codes, no_out || no_text, DPT_E_ARGUMENT);
    may_fail(&codes, of_file && !which && !no_text, DPT_E_OPEN);
    may_fail(&codes, def.progress.stops_at > 0, DPT_E_CANCELLED);
    const double scale = def.given && def.def.scale != 0.0 ? def.def.scale : 1.0;
    const int is_usual = scale > 1e-3 && scale < 1e3;
    const int is_plain = of_file && which && is_usual && (!def.given || !def.def.format);
    codes.or_done |= !codes.count || (codes.count == 1 && def.progress.stops_at > 0);
    const dpt_result read[] = { DPT_E_FORMAT, DPT_E_SYNTAX, DPT_E_INDEX, DPT_E_EMPTY, DPT_E_TRUNCATED, DPT_E_FINITE };
    struct codes readers = codes;
    for (int i = 0; i < 6 && !is_plain; i++)
        may_fail(&readers, 1, read[i]);
    const dpt_result result =
        of_file ? RESULT(dpt_compile_file, no_text ? NULL : path, def.given, no_out ? NULL : &of.out, diag)
                : RESULT(dpt_compile_bytes, no_text ? NULL : texts[which], no_text ? 4 : strlen(texts[which]),
                         def.given, no_out ? NULL : &of.out, diag);
    expect(result, &readers);
    outcome_must_hold(&of, result, no_out);
    if (result == DPT_OK)
        take(&of, 0);
}

/* Of arrays that are right but for one number. */
static void arm(void)
{
    static struct arm_arrays arrays;
    struct outcome of = { .out = { NULL, 0 } };
    struct codes codes = { .count = 0 };
    arm_random(&run.random, &arrays);
    dpt_arm_def *good = &arrays.def;
    const int no_out = draw_one_in(40), no_def = draw_one_in(40), is_wrong = draw_one_in(2);
    if (is_wrong)
        switch (draw_below(6)) {
        case 0:
            good->joint_count = draw_one_in(2) ? 0 : 9;
            may_fail(&codes, 1, DPT_E_LIMIT);
            break;
        case 1:
            good->links = NULL;
            may_fail(&codes, 1, DPT_E_ARGUMENT);
            break;
        case 2:
            good->tool_link = good->link_count;
            may_fail(&codes, 1, DPT_E_INDEX);
            may_fail(&codes, 1, DPT_E_LAYOUT);
            break;
        case 3:
            arrays.links[0].pose.position[1] = NAN;
            may_fail(&codes, 1, DPT_E_FINITE);
            break;
        case 4:
            arrays.links[0].axis[0] += 0.5;
            may_fail(&codes, 1, DPT_E_POSE);
            break;
        default:
            arrays.joints[0].size = draw_one_in(2) ? 0 : 4104;
            may_fail(&codes, 1, DPT_E_SIZE);
        }
    dpt_diag *diag = draw_diag(&of, &codes);
    const size_t first = offsetof(dpt_arm_def, jaw_count);
    const void *given = draw_input(2, good, draw_size(first, sizeof *good), first, sizeof *good, &codes);
    may_fail(&codes, no_out || no_def, DPT_E_ARGUMENT);
    const dpt_result result = RESULT(dpt_compile_arm, no_def ? NULL : given, no_out ? NULL : &of.out, diag);
    expect(result, &codes);
    outcome_must_hold(&of, result, no_out);
    if (result != DPT_OK)
        return;
    const dpt_arm *opened = NULL;
    HOLDS(RESULT(dpt_arm_convert, of.out.bytes, of.out.size, NULL) == DPT_OK &&
              RESULT(dpt_arm_open, of.out.bytes, of.out.size, &opened) == DPT_OK,
          "what was compiled does not open");
    game_digest(of.out.bytes, of.out.size);
    CALL(dpt_compiled_free, &of.out);
    HOLDS(!of.out.bytes && !of.out.size, "given back, and still there");
}

/* A source that is good, by a scale that is not: no other code will do. */
static void scales(void)
{
    static const double vertices[] = { 0, 0, 0, 0.1, 0, 0, 0, 0.1, 0 };
    static const uint32_t corners[] = { 0, 1, 2 };
    static const char text[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    const double wrong[] = { NAN, -NAN, -1.0, -1e-300, -INFINITY, INFINITY, 1.0001e30 };
    const double good[] = { 0.0, -0.0, 0.001, 25.4 };
    const int is_wrong = draw_one_in(2);
    struct outcome of = { .out = { NULL, 0 } };
    dpt_compile_def def;
    dpt_result result;
    CALL(dpt_compile_def_defaults, &def, sizeof def);
    def.scale = is_wrong ? wrong[draw_below(7)] : good[draw_below(4)];
    output_of(0, 0);
    switch (draw_below(3)) {
    case 0:
        result = RESULT(dpt_compile_file, obj_path, &def, &of.out, NULL);
        break;
    case 1:
        result = RESULT(dpt_compile_bytes, text, sizeof text - 1, &def, &of.out, NULL);
        break;
    default:
        result = RESULT(dpt_compile_arrays, vertices, 3, corners, 1, &def, &of.out, NULL);
    }
    HOLDS(result == (is_wrong ? DPT_E_ARGUMENT : DPT_OK), "%s by a scale of %g", dpt_result_name(result), def.scale);
    outcome_must_hold(&of, result, 0);
    CALL(dpt_compiled_free, &of.out);
}

/* Any points: what comes out is a hull's corners. */
static void hull_of_points(void)
{
    double points[60], corners[3 * DPT_HULL_CORNERS_MAX], radius = 0.0;
    uint64_t block[2048];
    const uint32_t count = draw_below(21), capacity = draw_below(70), flat = draw_below(4);
    uint32_t corner_count = 0;
    const int no_points = draw_one_in(40), no_out = draw_one_in(40);
    struct codes codes = { .count = 0 };
    for (uint32_t i = 0; i < 3 * count; i++)
        points[i] = i % 3 < flat || draw_one_in(30) ? draw_in(-0.1, 0.1) : 0.0;
    if (draw_one_in(20))
        points[draw_below(60)] = draw_odd_number();
    may_fail(&codes, no_points || no_out || count < 3 || capacity < 4 || capacity > 64, DPT_E_ARGUMENT);
    for (uint32_t i = 0; i < 3 * count; i++)
        may_fail(&codes, !(fabs(points[i]) <= DPT_COORDINATE_MAX), DPT_E_FINITE);
    /* What lies on one line is the compiler's to say. */
    codes.or_done |= !codes.count;
    may_fail(&codes, 1, DPT_E_ARGUMENT);
    const dpt_result result = RESULT(dpt_compile_hull, no_points ? NULL : points, count, no_out ? NULL : corners,
                                     capacity, &corner_count, &radius);
    expect(result, &codes);
    if (result != DPT_OK)
        return;
    const dpt_hull_def def = { .size = sizeof def, .corner_count = corner_count, .corners = corners, .radius = radius };
    const dpt_hull *hull;
    HOLDS(corner_count <= capacity && radius >= 0.0 && dpt_hull_create(block, sizeof block, &def, &hull) == DPT_OK,
          "%u corners, radius %g", corner_count, radius);
}

static void defaults(void)
{
    dpt_compile_def whole;
    const uint32_t size = draw_size(offsetof(dpt_compile_def, crease), sizeof whole);
    const int is_null = draw_one_in(20);
    void *out = output_of_defaults(0, size);
    CALL(dpt_compile_def_defaults, is_null ? NULL : out, size);
    CALL(dpt_compile_def_defaults, &whole, sizeof whole);
    defaults_must_hold(0, size, is_null, &whole, sizeof whole);
    HOLDS(whole.scale == 1.0 && fabs(whole.crease - acos(0.5)) < 1e-15 && whole.threads == 1 && !whole.format &&
              !whole.progress && !whole.user && !whole.recentre,
          "scale %g, crease %g, %u threads", whole.scale, whole.crease, whole.threads);
}

static void spring_defaults(void)
{
    dpt_spring_net_def whole;
    const uint32_t size = draw_size(sizeof whole, sizeof whole);
    const int is_null = draw_one_in(20);
    void *out = output_of_defaults(0, size);
    CALL(dpt_spring_net_def_defaults, is_null ? NULL : out, size);
    CALL(dpt_spring_net_def_defaults, &whole, sizeof whole);
    defaults_must_hold(0, size, is_null, &whole, sizeof whole);
    HOLDS(!whole.kind && whole.young == 5000.0 && whole.density == 1000.0 && whole.thickness == 0.001 &&
              whole.drag == 0.0 && !whole.regions && !whole.fixed,
          "E %g Pa, %g kg/m^3, %g m", whole.young, whole.density, whole.thickness);
}

static void free_nothing(void)
{
    dpt_compiled nothing = { NULL, 0 };
    CALL(dpt_compiled_free, NULL);
    CALL(dpt_compiled_free, &nothing);
}

static void end(void)
{
    CALL(dpt_compiled_free, &adopted);
    memset(&subjects[MESHES], 0, sizeof subjects[MESHES]);
}

static const struct move moves[] = { { "arrays", arrays, 3 },
                                     { "hull of points", hull_of_points, 1 },
                                     { "bytes", bytes, 1 },
                                     { "arm", arm, 1 },
                                     { "scales", scales, 1 },
                                     { "defaults", defaults, 1 },
                                     { "free nothing", free_nothing, 1 },
                                     { "spring defaults", spring_defaults, 1 },
                                     { NULL, NULL, 0 } };

const struct noun compile_noun = { "compile", NULL, end, moves };
