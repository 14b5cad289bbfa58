/* SPDX-License-Identifier: BSD-3-Clause */
/* Worlds: defs of all sorts, blocks that do and do not serve, a new world in a block in use, reset, usage. */
#include "fuzz/calls/world_model.h"

enum { GUARD = 64, PATTERN = 0xa5, BYTES_MAX = 3 << 20, KERNELS = 7 };

/* What this machine answered to each kernel: always the same. 0: not asked yet. */
static int kernel_is_there[KERNELS], kernel_is_not[KERNELS];

/* ---- the block, guarded on both sides ---- */

static void check_guards(const struct scene *scene, int i)
{
    const unsigned char *before = scene->block[i], *behind = scene_block(scene, i) + scene->room;
    for (size_t k = 0; k < GUARD; k++)
        HOLDS(before[k] == PATTERN && behind[k] == PATTERN, "something wrote about a world's block");
}

static void give_back(struct scene *scene)
{
    for (int i = 0; i < 2; i++) {
        if (scene->block[i])
            check_guards(scene, i);
        free(scene->block[i]);
        scene->block[i] = NULL;
    }
    scene->world_count = 0;
}

/* Filled with something else in each twin: nothing that was there before may count. */
static void take_blocks(struct scene *scene, size_t room, int count)
{
    give_back(scene);
    scene->room = room;
    scene->offset = GUARD + 8 * draw_below(8);
    for (int i = 0; i < count; i++) {
        scene->block[i] = malloc(scene->offset + room + GUARD);
        HOLDS(scene->block[i], "memory ran out");
        memset(scene->block[i], PATTERN, scene->offset + room + GUARD);
        memset(scene_block(scene, i), i ? 0xff : 0x5c, room);
    }
}

/* ---- defs ---- */

static void draw_good_def(dpt_world_def *def, dpt_baseline_def *baseline)
{
    static const uint32_t budgets[] = { 1, 5, 40, 200, 1000, 5000 };
    static const double margins[] = { 0.0, 0.001, 0.005, 0.02, 0.1 };
    static const uint64_t caches[] = { 0, 272, 1000, 4096, 1 << 16 };
    CALL(dpt_world_def_defaults, def, sizeof *def);
    CALL(dpt_baseline_def_defaults, baseline, sizeof *baseline);
    def->max_bodies = 1 + draw_below(draw_one_in(8) ? 20 : 4);
    def->max_tools = 1 + draw_below(draw_one_in(8) ? TOOLS_MAX : 3);
    def->max_segments = 1 + draw_below(draw_one_in(8) ? SEGMENTS_MAX : 6);
    def->method = draw_one_in(2) ? DPT_METHOD_EXACT : draw_below(4);
    def->until = draw_one_in(4) ? draw_below(3) : DPT_UNTIL_RESPOND;
    if (def->method == DPT_METHOD_EXACT && draw_one_in(2))
        def->budget = budgets[draw_below(6)];
    def->sweep_budget = draw_one_in(2) ? 0 : budgets[draw_below(6)];
    def->max_tips = draw_below(5);
    def->stiffness = draw_one_in(8) ? 0.0 : draw_in(1.0, 2000.0);
    def->certificate_bytes = caches[draw_below(5)];
    def->margin = margins[draw_below(5)];
    if (draw_one_in(3))
        def->onset = draw_in(-0.1, 1.0) * def->margin;
    def->side_limit = draw_one_in(2) ? 0.0 : draw_in(0.0, 0.1);
    def->fade = draw_one_in(2) ? 0.0 : draw_in(0.0, 0.02);
    def->max_contacts = draw_one_in(4) ? draw_below(3) : 1 + draw_below(32);
    def->smooth_normals = draw_below(2);
    def->law = draw_one_in(2) ? DPT_LAW_PROXY : draw_one_in(3) ? DPT_LAW_BED : DPT_LAW_POINT;
    if (draw_one_in(2)) {
        def->strip = 1 + draw_below(2);
        def->strip_capacity = 1 + draw_below(40);
        def->strip_search = draw_one_in(8) ? 0 : 8 + draw_below(200);
        def->strip_width = draw_one_in(2) ? 0.0 : draw_in(0.0, 0.02);
        def->strip_depth = draw_one_in(2) ? 0.0 : draw_in(0.0, 0.05);
    }
    def->kernel = draw_one_in(2) ? DPT_KERNEL_AUTO : draw_below(9);
    if (def->method == DPT_METHOD_PAPER) {
        baseline->parts = 1 + draw_below(3);
        baseline->one_step = draw_below(2);
    }
}

/* One field, sometimes to what it may not be. */
static void spoil_def(dpt_world_def *def, dpt_baseline_def *baseline)
{
    uint32_t *counts[] = { &def->max_bodies, &def->max_tools, &def->max_segments };
    double *numbers[] = { &def->stiffness,   &def->margin, &def->side_limit, &def->strip_width,
                          &def->strip_depth, &def->fade,   &def->onset };
    switch (draw_below(12)) {
    case 0:
        *counts[draw_below(3)] = draw_one_in(2) ? 0 : 65534 + draw_below(4);
        break;
    case 1:
        def->method = 4 + draw_below(3);
        break;
    case 2:
        def->until = 3 + draw_below(3);
        break;
    case 3:
        def->budget = 7;
        break;
    case 4:
        *numbers[draw_below(7)] = draw_odd_number();
        break;
    case 5:
        def->certificate_bytes = ((uint64_t)1 << 40) - 1 + draw_below(3);
        break;
    case 6:
        def->max_contacts = 65534 + draw_below(4);
        break;
    case 7:
        def->smooth_normals = 2;
        break;
    case 8:
        def->strip = 3;
        break;
    case 9:
        def->strip_capacity = draw_one_in(2) ? 0 : (1 << 20) + draw_below(2);
        break;
    case 10:
        def->law = draw_one_in(2) ? 1 : 3 + draw_below(3);
        def->reserved_pointer = draw_one_in(2) ? def : NULL;
        break;
    default:
        if (draw_one_in(2))
            baseline->parts = draw_one_in(2) ? 0 : 63 + draw_below(3);
        else
            *(draw_one_in(2) ? &baseline->one_step : &baseline->reserved) = 2;
    }
}

static int is_wrong_count(uint32_t count)
{
    return count < 1 || count > 65535;
}

static int is_wrong_number(double number, double most)
{
    return !(number >= 0.0 && number <= most);
}

/* world.h and baseline.h, field by field. `either`: they leave it free. */
static int def_is_wrong(const dpt_world_def *def, const dpt_baseline_def *baseline, int *either)
{
    const int strip_is_wrong = is_wrong_number(def->strip_width, DPT_COORDINATE_MAX) ||
                               is_wrong_number(def->strip_depth, DPT_COORDINATE_MAX) || def->strip_capacity < 1 ||
                               def->strip_capacity > 1 << 20 || def->strip_search > 1 << 28;
    *either = (strip_is_wrong && !def->strip) || (baseline->parts > 1 && def->method != DPT_METHOD_PAPER);
    return is_wrong_count(def->max_bodies) || is_wrong_count(def->max_tools) || is_wrong_count(def->max_segments) ||
           def->method > DPT_METHOD_PAPER || def->until > DPT_UNTIL_CONTACT ||
           (def->budget && def->method != DPT_METHOD_EXACT) || is_wrong_number(def->stiffness, 1e9) ||
           is_wrong_number(def->margin, 1e6) || !(def->onset <= def->margin && def->onset >= -DPT_COORDINATE_MAX) ||
           is_wrong_number(def->side_limit, DPT_COORDINATE_MAX) || is_wrong_number(def->fade, 1.0) ||
           def->certificate_bytes > (uint64_t)1 << 40 || def->max_contacts > 65535 || def->smooth_normals > 1 ||
           def->strip > DPT_STRIP_KIND_ROUTES || def->reserved_pointer || def->law > DPT_LAW_PROXY ||
           (strip_is_wrong && def->strip) || baseline->parts < 1 || baseline->parts > 64 || baseline->one_step > 1 ||
           baseline->reserved;
}

/* A def as it is handed over, and what it means. */
struct given_def {
    const void *given;
    dpt_world_def def;
    dpt_baseline_def baseline;
    struct codes codes;
};

enum { DEF_SLOT = 6, BASELINE_SLOT = 7 };

/* Of a scene that has a world, sometimes its own once more. */
static void draw_def(const struct scene *scene, struct given_def *of)
{
    dpt_world_def good = scene->def;
    dpt_baseline_def parts = scene->baseline;
    *of = (struct given_def){ .given = NULL };
    if (!scene->world_count || draw_one_in(2)) {
        draw_good_def(&good, &parts);
        if (draw_one_in(6))
            spoil_def(&good, &parts);
    }
    of->def = good;
    of->baseline = parts;
    if (draw_one_in(60)) {
        may_fail(&of->codes, 1, DPT_E_ARGUMENT);
        return;
    }
    good.baseline = NULL;
    if (good.method == DPT_METHOD_PAPER || draw_one_in(6)) {
        const uint32_t size = draw_size(sizeof parts, sizeof parts);
        good.baseline = draw_input(BASELINE_SLOT, &parts, size, sizeof parts, sizeof parts, &of->codes);
    } else {
        of->baseline = (dpt_baseline_def){ .parts = 1 };
    }
    const uint32_t size = draw_size(offsetof(dpt_world_def, max_channels), sizeof good);
    of->given = draw_input(DEF_SLOT, &good, size, offsetof(dpt_world_def, max_channels), sizeof good, &of->codes);
    int either;
    may_fail(&of->codes, def_is_wrong(&of->def, &of->baseline, &either), DPT_E_ARGUMENT);
    if (either) {
        of->codes.or_done = !of->codes.count;
        may_fail(&of->codes, 1, DPT_E_ARGUMENT);
    }
}

static int kernel_is_wrong(uint32_t kernel)
{
    return kernel >= KERNELS || kernel_is_not[kernel];
}

static void note_kernel(uint32_t kernel, dpt_result result)
{
    if (kernel >= KERNELS) {
        HOLDS(result != DPT_OK, "there is no kernel %u", kernel);
        return;
    }
    *(result == DPT_OK ? &kernel_is_there[kernel] : &kernel_is_not[kernel]) = 1;
    HOLDS(!kernel_is_there[kernel] || !kernel_is_not[kernel], "kernel %u comes and goes", kernel);
    HOLDS(result == DPT_OK || (kernel != DPT_KERNEL_AUTO && kernel != CALL(dpt_kernel_best)),
          "kernel %u is said to be the best", kernel);
}

/* ---- moves ---- */

static void ask_bytes(void)
{
    struct given_def of;
    draw_def(&scenes[draw_below(SCENES)], &of);
    call_with("def of size %llu", of.given ? *(const uint32_t *)of.given : 0, 0, 0, 0);
    const size_t bytes = CALL(dpt_world_bytes, of.given);
    if (!of.codes.or_done)
        HOLDS((bytes == 0) == (of.codes.count > 0), "%zu bytes", bytes);
    if (bytes && bytes <= BYTES_MAX)
        HOLDS(bytes == CALL(dpt_world_bytes, of.given), "another time otherwise");
    outputs_are_guarded(DEF_SLOT, 1);
}

/* Blocks that are none: NULL, off by a few bytes, too small. The one in use stays as it is. */
static void create_in_vain(struct scene *scene, const struct given_def *of, size_t bytes)
{
    struct codes codes = of->codes;
    static uint64_t small[8];
    dpt_world *untouched = (dpt_world *)small, *world = untouched;
    const int no_block = draw_one_in(4), no_world = draw_one_in(4), is_off = draw_one_in(2);
    const size_t given = draw_one_in(2) ? 0 : bytes - 1 - draw_below(8);
    const size_t off = is_off ? 1 + draw_below(7) : 0;
    unsigned char *block = scene->block[0] ? scene_block(scene, 0) + off : (unsigned char *)small + off;
    codes.or_done = 0;
    may_fail(&codes, no_block || no_world, DPT_E_ARGUMENT);
    may_fail(&codes, off != 0, DPT_E_ALIGN);
    may_fail(&codes, 1, DPT_E_MEMORY);
    may_fail(&codes, of->def.kernel != DPT_KERNEL_AUTO, DPT_E_UNSUPPORTED);
    call_with("block off by %llu, of %llu bytes", off, given, 0, 0);
    expect(RESULT(dpt_world_create, no_block ? NULL : block, given, of->given, no_world ? NULL : &world), &codes);
    HOLDS(world == untouched || world == NULL, "a world that was not made");
    if (scene->block[0])
        check_guards(scene, 0);
}

/* In one block, or two; the second one's kernel is another. */
static dpt_result create_all(struct scene *scene, const struct given_def *of, int count, size_t room)
{
    dpt_result result = DPT_OK;
    for (int i = 0; i < count && result == DPT_OK; i++) {
        const uint32_t kernel = i ? DPT_KERNEL_SCALAR : of->def.kernel;
        unsigned char *def = (unsigned char *)(uintptr_t)of->given;
        dpt_world *world = NULL;
        memcpy(def + offsetof(dpt_world_def, kernel), &kernel, sizeof kernel);
        if (i) /* of what was there before the first one has all, the second nothing */
            memset(scene_block(scene, i), 0xff, scene->room);
        call_with("a block of %llu bytes, kernel %llu", room, kernel, 0, 0);
        result = RESULT(dpt_world_create, scene_block(scene, i), room, of->given, &world);
        note_kernel(kernel, result);
        HOLDS((result == DPT_OK) == (world != NULL), "%s", dpt_result_name(result));
        if (world)
            scene->world[i] = world;
        check_guards(scene, i);
    }
    return result;
}

static void create(void)
{
    struct scene *scene = &scenes[draw_below(SCENES)];
    struct given_def of;
    draw_def(scene, &of);
    const size_t bytes = CALL(dpt_world_bytes, of.given);
    HOLDS(of.codes.or_done || (bytes == 0) == (of.codes.count > 0), "%zu bytes", bytes);
    if (!bytes || bytes > BYTES_MAX || draw_one_in(6)) {
        create_in_vain(scene, &of, bytes ? bytes : 64);
        return;
    }
    const int count = draw_one_in(2) ? 2 : 1;
    const int is_anew = scene->world_count >= count && bytes <= scene->room && draw_one_in(2);
    if (!is_anew) {
        take_blocks(scene, bytes + (draw_one_in(3) ? 8 * draw_below(1 << 13) : 0), count);
        scene_forgets(scene);
    }
    struct codes codes = { .count = 0 };
    const dpt_result result = create_all(scene, &of, count, scene->room);
    may_fail(&codes, kernel_is_wrong(of.def.kernel), DPT_E_UNSUPPORTED);
    may_fail(&codes, of.def.kernel >= KERNELS, DPT_E_ARGUMENT);
    expect(result, &codes);
    if (result != DPT_OK)
        return; /* the world that was in the block is still there */
    met[MET_ANEW] += is_anew ? 1 : 0;
    scene_forgets(scene);
    scene->world_count = count;
    scene->def = of.def;
    scene->baseline = of.baseline;
    if (draw_one_in(6))
        return;
    scene_gets_bodies(scene);
    scene_gets_tools(scene);
}

static void defaults(void)
{
    const uint32_t size = draw_size(sizeof(dpt_world_def), sizeof(dpt_world_def));
    const int is_null = draw_one_in(20);
    void *out = output_of_defaults(0, size), *given = is_null ? NULL : out;
    dpt_world_def world;
    dpt_baseline_def baseline;
    call_with("size %llu", size, 0, 0, 0);
    if (draw_one_in(2)) {
        CALL(dpt_world_def_defaults, given, size);
        CALL(dpt_world_def_defaults, &world, sizeof world);
        defaults_must_hold(0, size, is_null, &world, sizeof world);
    } else {
        CALL(dpt_baseline_def_defaults, given, size);
        CALL(dpt_baseline_def_defaults, &baseline, sizeof baseline);
        defaults_must_hold(0, size, is_null, &baseline, sizeof baseline);
    }
}

static void reset(void)
{
    struct scene *scene = draw_scene();
    if (!scene)
        return;
    const int no_world = draw_one_in(20);
    struct codes codes = { .count = 0 };
    may_fail(&codes, no_world, DPT_E_ARGUMENT);
    EACH_WORLD(scene, i)
    expect(RESULT(dpt_world_reset, world_or_null(scene, i, no_world)), &codes);
    if (!no_world)
        scene_is_stale(scene);
}

static void usage(void)
{
    struct scene *scene = draw_scene();
    if (!scene)
        return;
    const int no_world = draw_one_in(30), no_out = draw_one_in(30);
    const uint32_t size = draw_size(sizeof(dpt_world_info), sizeof(dpt_world_info));
    dpt_world_info now;
    dpt_result result = DPT_OK;
    struct codes codes = { .count = 0 };
    may_fail(&codes, no_world || no_out, DPT_E_ARGUMENT);
    if (!no_out)
        size_codes_of_output(size, sizeof now, 0, &codes);
    EACH_WORLD(scene, i)
    {
        void *out = output_sized(i, size);
        SAME_RESULT(i, result, RESULT(dpt_world_get_info, world_or_null(scene, i, no_world), no_out ? NULL : out));
    }
    expect(result, &codes);
    outputs_are_guarded(0, scene->world_count);
    if (result != DPT_OK) {
        HOLDS(output_is_untouched(0, sizeof size), "written on an error");
        return;
    }
    if (!output_read(0, size, sizeof now, sizeof now, &now))
        return;
    const dpt_world_info *least = &scene->least;
    HOLDS(now.bodies == least->bodies && now.tools == least->tools && now.segments == least->segments,
          "%u bodies, %u tools, %u segments at once, and not %u, %u, %u", now.bodies, now.tools, now.segments,
          least->bodies, least->tools, least->segments);
    HOLDS(now.contacts >= least->contacts && now.work >= least->work && now.strip >= least->strip,
          "%u contacts, %u work, strips of %u; seen were %u, %u, %u", now.contacts, now.work, now.strip,
          least->contacts, least->work, least->strip);
    HOLDS(now.strip <= (scene->def.strip ? scene->def.strip_capacity : 0), "strip %u", now.strip);
    HOLDS(!scene->def.budget || now.work <= scene->def.budget, "work %u of a budget of %u", now.work,
          scene->def.budget);
    scene->least = now;
    /* Twins have kernels of their own. */
    for (int i = 0; i < scene->world_count; i++)
        memset((char *)output_at(i) + offsetof(dpt_world_info, kernel), 0, sizeof now.kernel);
    if (scene->world_count == 2)
        outputs_agree(1);
}

static void kernel(void)
{
    struct scene *scene = draw_scene();
    const uint32_t best = CALL(dpt_kernel_best);
    HOLDS(best > DPT_KERNEL_AUTO && best < KERNELS, "kernel %u is the best", best);
    if (!scene)
        return;
    dpt_world_info info = { .size = sizeof info };
    HOLDS(RESULT(dpt_world_get_info, scene->world[0], &info) == DPT_OK, "no info");
    const uint32_t now = info.kernel;
    const uint32_t asked = scene->def.kernel ? scene->def.kernel : best;
    HOLDS(now == asked, "kernel %u, and not %u", now, asked);
}

static void end(void)
{
    for (int i = 0; i < SCENES; i++) {
        give_back(&scenes[i]);
        scene_forgets(&scenes[i]);
    }
}

static void begin(void)
{
    for (int i = 0; i < 2 * SCENES; i++)
        create();
}

static const struct move moves[] = { { "create", create, 4 }, { "bytes", ask_bytes, 3 }, { "defaults", defaults, 2 },
                                     { "reset", reset, 3 },   { "usage", usage, 5 },     { "kernel", kernel, 2 },
                                     { NULL, NULL, 0 } };

const struct noun world_noun = { "world", begin, end, moves };
