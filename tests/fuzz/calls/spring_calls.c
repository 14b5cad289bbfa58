/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Physics of springs: made, stepped, moved and asked, well and badly; alone, and with a deformable body. Each has a twin
 * with the scalar kernel, which must have the same bits.
 */
#include "fuzz/calls/deform_model.h"
#include "fuzz/calls/rules.h"

enum { PAIRS = 3, LOADS_MOST = 8, NODES_MOST = 4096, GIVEN_SLOT = 2, LIST_SLOT = 3 };

struct pair_of_springs {
    const struct subject *subject;
    dpt_springs *made[2];
    unsigned char *block[2];
    dpt_springs_def def;
    uint32_t nodes;
    /* J: what IMPLICIT may not exceed: the energy when nodes were set last, if nothing has worked on them since. */
    double most;
};

static struct pair_of_springs pairs[PAIRS];

static void drop(struct pair_of_springs *pair)
{
    for (int i = 0; i < 2; i++)
        free(pair->block[i]);
    memset(pair, 0, sizeof *pair);
}

static void end(void)
{
    for (int i = 0; i < PAIRS; i++)
        drop(&pairs[i]);
}

/* One that is there; NULL: there is none, which is the caller's to answer. */
static struct pair_of_springs *draw_pair(void)
{
    struct pair_of_springs *pair = &pairs[draw_below(PAIRS)];
    return pair->made[0] ? pair : NULL;
}

static int has_springs(const struct subject *subject)
{
    dpt_mesh_info info = { .size = sizeof info };
    dpt_mesh_get_info(subject->mesh, &info);
    return info.springs > 0 && info.spring_nodes <= NODES_MOST;
}

/* Mostly one with springs. */
static const struct subject *draw_springy(void)
{
    const struct subject *subject = draw_subject();
    return has_springs(subject) || draw_one_in(8) ? subject : &subjects[2];
}

static double energy_of(const struct pair_of_springs *pair, int which)
{
    double elastic = NAN, kinetic = NAN;
    HOLDS(RESULT(dpt_springs_get_energy, pair->made[which], &elastic, &kinetic) == DPT_OK, "no energy");
    HOLDS(elastic >= 0.0 && kinetic >= 0.0, "%g J and %g J", elastic, kinetic);
    return elastic + kinetic;
}

/* ---- made ---- */

struct given_def {
    const struct subject *subject;
    const void *given;
    dpt_springs_def def;
    struct codes codes;
};

static void spoil_def(struct given_def *of)
{
    dpt_springs_def *def = &of->def;
    double *const numbers[] = { &def->stiffness, &def->contact_stiffness, &def->sleep_speed, &def->gravity[0],
                                &def->gravity[2] };
    switch (draw_below(11)) {
    case 0:
        def->integrator = 3 + draw_below(3);
        break;
    case 1:
        def->iterations = draw_one_in(2) ? 0 : 1025;
        break;
    case 2:
        def->max_substeps = draw_one_in(2) ? 0 : 65536;
        break;
    case 3:
        def->sleep_steps = draw_one_in(2) ? 1 : 65536;
        break;
    case 4:
        def->max_loads = draw_one_in(2) ? 0 : (1u << 24) + 1;
        break;
    case 5:
        def->reserved = 1;
        break;
    case 6:
        def->reserved_pointer = def;
        break;
    case 7:
        def->min_substeps = 65536;
        break;
    case 8:
        def->reserved_word = 1;
        break;
    case 9: {
        const double wrong[] = { NAN, INFINITY, -INFINITY };
        *numbers[draw_below(5)] = wrong[draw_below(3)];
        may_fail(&of->codes, 1, DPT_E_FINITE);
        return;
    }
    default:
        *numbers[draw_below(5)] = draw_one_in(2) ? 1e300 : -1e300;
    }
    may_fail(&of->codes, 1, DPT_E_ARGUMENT);
}

static void draw_def(struct given_def *of)
{
    const uint32_t first = offsetof(dpt_springs_def, min_substeps), today = sizeof of->def;
    const uint32_t size = draw_size(first, today);
    const int is_of_today = size >= today;
    memset(of, 0, sizeof *of);
    of->subject = draw_springy();
    CALL(dpt_springs_def_defaults, &of->def, sizeof of->def);
    of->def.mesh = of->subject->mesh;
    of->def.integrator = draw_below(3);
    of->def.stiffness = draw_one_in(2) ? 1.0 : exp(draw_in(-6.0, 6.0));
    of->def.contact_stiffness = draw_one_in(2) ? 0.0 : draw_in(0.0, 100.0);
    of->def.sleep_speed = draw_one_in(3) ? 0.0 : exp(draw_in(-12.0, -1.0));
    of->def.sleep_steps = 2 + draw_below(8);
    of->def.iterations = 1 + draw_below(12);
    of->def.max_substeps = 1 + draw_below(100);
    of->def.min_substeps = is_of_today && draw_one_in(2) ? draw_below(9) : 0;
    may_fail(&of->codes, of->def.integrator != DPT_INTEGRATOR_IMPLICIT && of->def.min_substeps > of->def.max_substeps,
             DPT_E_ARGUMENT);
    of->def.max_loads = 1 + draw_below(200);
    if (draw_one_in(2))
        of->def.gravity[draw_below(3)] = draw_in(-10.0, 10.0);
    if (is_of_today && draw_one_in(4))
        spoil_def(of);
    if (draw_one_in(40)) {
        of->def.mesh = NULL;
        may_fail(&of->codes, 1, DPT_E_ARGUMENT);
    }
    may_fail(&of->codes, of->def.mesh && !has_springs(of->subject), DPT_E_UNSUPPORTED);
    of->given = draw_input(GIVEN_SLOT, &of->def, size, first, today, &of->codes);
}

static unsigned char *new_block(size_t bytes)
{
    unsigned char *block = malloc(bytes + 16);
    HOLDS(block, "memory ran out");
    memset(block, 0xa5, bytes + 16);
    return block;
}

static void block_is_guarded(const unsigned char *block, size_t bytes)
{
    for (size_t i = bytes; i < bytes + 16; i++)
        HOLDS(block[i] == 0xa5, "written behind the block");
}

static void make_twin(struct pair_of_springs *pair)
{
    dpt_springs_def def = pair->def;
    def.kernel = DPT_KERNEL_SCALAR;
    const size_t bytes = CALL(dpt_springs_bytes, &def);
    pair->block[1] = new_block(bytes);
    HOLDS(RESULT(dpt_springs_create, pair->block[1], bytes, &def, &pair->made[1]) == DPT_OK, "no twin");
}

static void create(void)
{
    struct pair_of_springs *pair = &pairs[draw_below(PAIRS)];
    struct given_def of;
    dpt_springs *made = NULL;
    draw_def(&of);
    drop(pair);
    const int no_block = draw_one_in(60), no_out = draw_one_in(60), is_off = draw_one_in(40);
    const int is_small = draw_one_in(40);
    const size_t bytes = CALL(dpt_springs_bytes, of.given);
    HOLDS((bytes == 0) == (of.codes.count > 0), "%zu bytes", bytes);
    may_fail(&of.codes, no_block || no_out, DPT_E_ARGUMENT);
    may_fail(&of.codes, is_off, DPT_E_ALIGN);
    may_fail(&of.codes, is_small, DPT_E_MEMORY);
    const size_t room = bytes ? bytes : 64;
    unsigned char *block = new_block(room);
    call_with("integrator %llu, %llu bytes", of.def.integrator, room, 0, 0);
    const dpt_result result = RESULT(dpt_springs_create, no_block ? NULL : block + (is_off ? 4 : 0),
                                     is_small ? room - 1 : room, of.given, no_out ? NULL : &made);
    expect(result, &of.codes);
    block_is_guarded(block, room);
    if (result != DPT_OK) {
        free(block);
        return;
    }
    *pair = (struct pair_of_springs){ .subject = of.subject, .made = { made }, .block = { block }, .def = of.def };
    pair->nodes = CALL(dpt_springs_get_count, made);
    HOLDS(pair->nodes > 0 && pair->nodes <= NODES_MOST, "%u nodes", pair->nodes);
    make_twin(pair);
    pair->most = energy_of(pair, 0);
}

static void defaults(void)
{
    dpt_springs_def whole;
    const uint32_t size = draw_size(sizeof whole, sizeof whole);
    const int is_null = draw_one_in(20);
    void *out = output_of_defaults(0, size);
    call_with("size %llu", size, 0, 0, 0);
    CALL(dpt_springs_def_defaults, is_null ? NULL : out, size);
    CALL(dpt_springs_def_defaults, &whole, sizeof whole);
    defaults_must_hold(0, size, is_null, &whole, sizeof whole);
}

/* ---- where nodes are ---- */

struct nodes {
    float positions[3 * NODES_MOST], speeds[3 * NODES_MOST];
};

static void read_nodes(const struct pair_of_springs *pair, int which, struct nodes *to)
{
    HOLDS(RESULT(dpt_springs_get_nodes, pair->made[which], pair->nodes, to->positions, to->speeds) == DPT_OK,
          "no nodes");
}

/* Of the nodes that the springs have; what lies behind is of others. */
static int nodes_are_same(const struct pair_of_springs *pair, const struct nodes *one, const struct nodes *other)
{
    const size_t bytes = 3 * (size_t)pair->nodes * sizeof(float);
    return !memcmp(one->positions, other->positions, bytes) && !memcmp(one->speeds, other->speeds, bytes);
}

/* Finite, the same in both, and those of the game's digest. */
static void nodes_must_hold(const struct pair_of_springs *pair, struct nodes *now)
{
    static struct nodes twin;
    read_nodes(pair, 0, now);
    for (uint32_t i = 0; i < 3 * pair->nodes; i++)
        HOLDS(fabsf(now->positions[i]) <= (float)DPT_COORDINATE_MAX && fabsf(now->speeds[i]) <= 1e9f,
              "node %u is at %g, %g m/s", i / 3, (double)now->positions[i], (double)now->speeds[i]);
    game_digest(now->positions, 3 * (size_t)pair->nodes * sizeof(float));
    if (!pair->made[1])
        return;
    read_nodes(pair, 1, &twin);
    HOLDS(nodes_are_same(pair, &twin, now), "the twin is elsewhere");
}

static void get_nodes(void)
{
    const struct pair_of_springs *pair = draw_pair();
    if (!pair)
        return;
    const int no_springs = draw_one_in(20), no_positions = draw_one_in(20);
    const uint32_t count = draw_one_in(8) ? pair->nodes + draw_below(3) - 1 : pair->nodes;
    struct codes codes = { .count = 0 };
    float *positions = output_of(0, 3 * (size_t)pair->nodes * sizeof *positions);
    may_fail(&codes, no_springs || no_positions || count != pair->nodes, DPT_E_ARGUMENT);
    const dpt_result result =
        RESULT(dpt_springs_get_nodes, no_springs ? NULL : pair->made[0], count, no_positions ? NULL : positions, NULL);
    expect(result, &codes);
    outputs_are_guarded(0, 1);
    HOLDS(CALL(dpt_springs_get_count, NULL) == 0 && CALL(dpt_springs_get_stable_step, NULL) == 0.0, "of NULL");
}

static void set_nodes(void)
{
    static struct nodes before, given, after;
    struct pair_of_springs *pair = draw_pair();
    if (!pair)
        return;
    const int no_springs = draw_one_in(30), no_positions = draw_one_in(30), is_wrong = draw_one_in(12);
    const uint32_t first = draw_below(pair->nodes), count = draw_below(pair->nodes - first + 1);
    const uint32_t asked = is_wrong && draw_one_in(2) ? pair->nodes - first + 1 : count;
    struct codes codes = { .count = 0 };
    dpt_result result = DPT_OK;
    read_nodes(pair, 0, &before);
    for (uint32_t i = 0; i < 3 * pair->nodes; i++) {
        given.positions[i] = before.positions[i] + (float)draw_in(-0.01, 0.01);
        given.speeds[i] = (float)draw_in(-1.0, 1.0);
    }
    if (is_wrong && asked == count && count) {
        const float wrong[] = { NAN, INFINITY, -3e38f };
        (draw_one_in(2) ? given.positions : given.speeds)[3 * first + draw_below(3 * count)] = wrong[draw_below(3)];
        may_fail(&codes, 1, DPT_E_FINITE);
    }
    may_fail(&codes, no_springs || (no_positions && asked) || asked != count, DPT_E_ARGUMENT);
    for (int i = 0; i < 2 && (i == 0 || pair->made[1]); i++)
        SAME_RESULT(i, result,
                    RESULT(dpt_springs_set_nodes, no_springs ? NULL : pair->made[i], first, asked,
                           no_positions ? NULL : given.positions + 3 * (size_t)first,
                           given.speeds + 3 * (size_t)first));
    expect(result, &codes);
    nodes_must_hold(pair, &after);
    pair->most = result == DPT_OK ? energy_of(pair, 0) : pair->most;
    for (uint32_t i = 0; i < 3 * pair->nodes; i++) {
        const int is_set = result == DPT_OK && i / 3 >= first && i / 3 < first + count;
        HOLDS(after.positions[i] == (is_set ? given : before).positions[i], "node %u is elsewhere", i / 3);
    }
}

/* ---- steps ---- */

static void get_energy(void)
{
    const struct pair_of_springs *pair = draw_pair();
    double a, b;
    if (!pair)
        return;
    const uint32_t what = draw_below(4);
    struct codes codes = { .count = 0 };
    may_fail(&codes, what < 3, DPT_E_ARGUMENT);
    const dpt_result result =
        RESULT(dpt_springs_get_energy, what == 0 ? NULL : pair->made[0], what == 1 ? NULL : &a, what == 2 ? NULL : &b);
    expect(result, &codes);
    if (pair->made[1])
        HOLDS(energy_of(pair, 0) == energy_of(pair, 1), "the twin has another energy");
}

static void get_compliances(void)
{
    static float compliances[2][3 * TRIANGLES_MOST];
    const struct pair_of_springs *pair = draw_pair();
    const uint32_t what = draw_below(5);
    const double dt = what == 3 ? draw_odd_number() : exp(draw_in(-9.0, 0.0));
    if (!pair || pair->subject->vertices > 3 * TRIANGLES_MOST)
        return;
    const uint32_t count = pair->subject->vertices + (what == 2);
    struct codes codes = { .count = 0 };
    may_fail(&codes, what < 3, DPT_E_ARGUMENT);
    may_fail(&codes, !(fabs(dt) <= 1e308), DPT_E_FINITE);
    may_fail(&codes, !(dt >= DPT_SPRINGS_STEP_MIN && dt <= DPT_SPRINGS_STEP_MAX), DPT_E_ARGUMENT);
    const dpt_result result = RESULT(dpt_springs_get_compliances, what == 0 ? NULL : pair->made[0], dt, count,
                                     what == 1 ? NULL : compliances[0]);
    expect(result, &codes);
    if (result != DPT_OK || !pair->made[1])
        return;
    dpt_springs_get_compliances(pair->made[1], dt, count, compliances[1]);
    for (uint32_t i = 0; i < count; i++)
        HOLDS(compliances[0][i] >= 0.0f && compliances[0][i] <= (float)DPT_COMPLIANCE_MAX &&
                  compliances[0][i] == compliances[1][i],
              "vertex %u gives way by %g m/N", i, (double)compliances[0][i]);
}

/* What a step of dt may answer: it is known of an explicit one whether it is stable. */
static void step_codes(const struct pair_of_springs *pair, double dt, struct codes *codes)
{
    const double stable = CALL(dpt_springs_get_stable_step, pair->made[0]);
    HOLDS(stable >= 0.0 && stable <= DPT_SPRINGS_STEP_MAX, "a stable step of %g s", stable);
    may_fail(codes, !(fabs(dt) <= 1e308), DPT_E_FINITE);
    may_fail(codes, !(dt >= DPT_SPRINGS_STEP_MIN && dt <= DPT_SPRINGS_STEP_MAX), DPT_E_ARGUMENT);
    if (pair->def.integrator == DPT_INTEGRATOR_IMPLICIT || !(dt >= DPT_SPRINGS_STEP_MIN && dt <= DPT_SPRINGS_STEP_MAX))
        return;
    const double most = 0.9 * stable * pair->def.max_substeps;
    codes->or_done = !codes->count && fabs(dt / most - 1.0) < 1e-9;
    may_fail(codes, !(dt <= most * (1.0 - 1e-9)), DPT_E_UNSTABLE);
}

static double draw_step(const struct pair_of_springs *pair)
{
    const double stable = CALL(dpt_springs_get_stable_step, pair->made[0]);
    if (draw_one_in(30))
        return draw_odd_number();
    if (pair->def.integrator == DPT_INTEGRATOR_IMPLICIT)
        return exp(draw_in(-9.0, 0.0));
    return fmin(stable * pair->def.max_substeps * draw_in(0.01, 1.0), DPT_SPRINGS_STEP_MAX);
}

static uint32_t draw_loads(const struct pair_of_springs *pair, dpt_load *loads, struct codes *codes)
{
    const uint32_t count = draw_one_in(2) ? 0 : draw_below(LOADS_MOST + 1);
    for (uint32_t i = 0; i < count; i++) {
        loads[i] = (dpt_load){ .vertex = draw_below(pair->nodes) };
        for (int k = 0; k < 3; k++)
            loads[i].force[k] = draw_in(-0.1, 0.1);
    }
    if (!count || !draw_one_in(20))
        return count;
    dpt_load *load = &loads[draw_below(count)];
    const uint32_t what = draw_below(3);
    if (what == 0)
        load->vertex = pair->nodes + draw_below(3);
    else if (what == 1)
        load->reserved = 1;
    else
        load->force[draw_below(3)] = draw_one_in(2) ? NAN : 1e10;
    may_fail(codes, 1, what < 2 ? DPT_E_ARGUMENT : DPT_E_FINITE);
    return count;
}

static void spring_report_must_hold(const struct pair_of_springs *pair, const dpt_springs_info *report)
{
    HOLDS(report->nodes == pair->nodes && report->active <= report->nodes && report->substeps >= 1 &&
              report->substeps >= pair->def.min_substeps &&
              (report->substeps <= pair->def.max_substeps || report->substeps == pair->def.min_substeps) &&
              report->flags <= DPT_SPRINGS_FLAG_HELD && !report->work && report->result == DPT_OK &&
              !report->reserved_word,
          "%u of %u nodes, %u substeps", report->active, report->nodes, report->substeps);
}

static void step(void)
{
    static struct nodes before, after;
    struct pair_of_springs *pair = draw_pair();
    dpt_springs_info report[2] = { { .size = sizeof report[0] }, { .size = sizeof report[0] } };
    dpt_load loads[LOADS_MOST];
    dpt_result result = DPT_OK;
    if (!pair)
        return;
    const double dt = draw_step(pair);
    const int no_springs = draw_one_in(60), has_report = draw_one_in(2);
    struct codes codes = { .count = 0 };
    step_codes(pair, dt, &codes);
    const uint32_t count = draw_loads(pair, loads, &codes);
    const int no_loads = count && draw_one_in(30);
    may_fail(&codes, no_springs || no_loads, DPT_E_ARGUMENT);
    read_nodes(pair, 0, &before);
    call_with("integrator %llu, dt %llu ns, %llu loads", pair->def.integrator,
              dt > 0.0 && dt < 1.0 ? (uint64_t)(1e9 * dt) : 0, count, 0);
    for (int i = 0; i < 2 && (i == 0 || pair->made[1]); i++)
        SAME_RESULT(i, result,
                    RESULT(dpt_springs_step, no_springs ? NULL : pair->made[i], dt, no_loads ? NULL : loads, count,
                           has_report ? &report[i] : NULL));
    expect(result, &codes);
    nodes_must_hold(pair, &after);
    const int is_free =
        !count && pair->def.gravity[0] == 0.0 && pair->def.gravity[1] == 0.0 && pair->def.gravity[2] == 0.0;
    if (result != DPT_OK) {
        HOLDS(nodes_are_same(pair, &before, &after), "it has moved after an error");
        return;
    }
    if (has_report)
        spring_report_must_hold(pair, &report[0]);
    pair->most = is_free ? pair->most : HUGE_VAL;
    if (pair->def.integrator == DPT_INTEGRATOR_IMPLICIT)
        HOLDS(energy_of(pair, 0) <= pair->most * (1.0 + 1e-3) + 1e-6, "%g J, %g J before", energy_of(pair, 0),
              pair->most);
}

/* Both go on from where they are, awake where the loads would wake them. */
static void foresee(void)
{
    static struct nodes before, after;
    static float foreseen[2][3 * NODES_MOST];
    struct pair_of_springs *pair = draw_pair();
    dpt_load loads[LOADS_MOST];
    dpt_result result = DPT_OK;
    if (!pair)
        return;
    const uint32_t what = draw_below(20);
    const double dt = draw_step(pair);
    struct codes codes = { .count = 0 };
    step_codes(pair, dt, &codes);
    const uint32_t count = draw_loads(pair, loads, &codes);
    may_fail(&codes, what < 3, DPT_E_ARGUMENT);
    read_nodes(pair, 0, &before);
    for (int i = 0; i < 2 && (i == 0 || pair->made[1]); i++)
        SAME_RESULT(i, result,
                    RESULT(dpt_springs_foresee, what == 0 ? NULL : pair->made[i], dt, loads, count,
                           pair->nodes + (what == 1), what == 2 ? NULL : foreseen[i]));
    expect(result, &codes);
    HOLDS(result != DPT_OK || !pair->made[1] ||
              !memcmp(foreseen[0], foreseen[1], 3 * sizeof foreseen[0][0] * pair->nodes),
          "the twin foresees something else");
    read_nodes(pair, 0, &after);
    HOLDS(nodes_are_same(pair, &before, &after), "it has moved");
}

/* ---- with a deformable body ---- */

/* Mostly a body of the springs' mesh, which may be added for it. */
static uint32_t draw_id(struct scene *scene, const struct pair_of_springs *pair)
{
    for (uint32_t i = 0; i < scene->body_count && !draw_one_in(10); i++)
        if (scene->body[i].soft && scene->body[i].subject == pair->subject)
            return scene->body[i].id;
    if (draw_one_in(2) && scene->body_count < scene->def.max_bodies) {
        const uint32_t count = scene->body_count;
        scene_gets_soft(scene, pair->subject);
        if (scene->body_count > count)
            return scene->body[count].id;
    }
    return draw_body_id(scene);
}

static void body_codes(const struct model_body *body, const struct pair_of_springs *pair, struct codes *codes)
{
    dpt_mesh_info info = { .size = sizeof info };
    dpt_mesh_get_info(pair->subject->mesh, &info);
    may_fail(codes, !body || !body->soft, DPT_E_HANDLE);
    if (!body || !body->soft)
        return;
    const int displaces = body->soft->def.response == DPT_RESPONSE_DISPLACE;
    may_fail(codes, body->subject != pair->subject, DPT_E_ARGUMENT);
    may_fail(codes, displaces && (info.nodes > 0 || body->soft->def.period > 0.0), DPT_E_UNSUPPORTED);
}

/* Where the body is now, the model learns from the first world; the twin must be there, too. */
static void body_has_moved(struct scene *scene, struct model_body *body)
{
    const float *positions;
    uint32_t count;
    HOLDS(dpt_body_get_vertices(scene->world[0], body->id, &positions, &count) == DPT_OK, "no vertices");
    memcpy(body->soft->now, positions, 3 * sizeof *positions * count);
    body->soft->is_affine = 0;
    met[MET_DEFORMED]++;
    soft_must_be_there(scene, body);
}

/*
 * A body with a period has positions on their way, which the model does not know of: it is asked for errors alone. So
 * many loads, or vertices beyond the box, are not foreseen. After an error nothing of it has moved.
 */
static void step_body(void)
{
    struct pair_of_springs *pair = draw_pair();
    struct scene *scene = draw_scene();
    dpt_result result = DPT_OK;
    if (!pair || !scene || (scene->world_count == 2 && !pair->made[1]))
        return;
    const uint32_t id = draw_id(scene, pair);
    struct model_body *body = scene_body(scene, id);
    const int no_world = draw_one_in(60), no_springs = draw_one_in(60);
    const double dt = draw_step(pair);
    struct codes codes = { .count = 0 };
    step_codes(pair, dt, &codes);
    body_codes(body, pair, &codes);
    may_fail(&codes, no_world || no_springs, DPT_E_ARGUMENT);
    if (!codes.count && body->soft->def.period > 0.0)
        return;
    codes.or_done |= !codes.count;
    may_fail(&codes, codes.or_done, DPT_E_FULL);
    may_fail(&codes, codes.or_done, DPT_E_FINITE);
    call_with("scene %llu, id %llx", (uint64_t)(scene - scenes), id, 0, 0);
    const int as_list = draw_one_in(3);
    static struct nodes before, after;
    read_nodes(pair, 0, &before);
    EACH_WORLD(scene, i)
    {
        dpt_world *world = world_or_null(scene, i, no_world);
        dpt_springs *springs = no_springs ? NULL : pair->made[i];
        SAME_RESULT(i, result,
                    as_list ? RESULT(dpt_bodies_step_springs, world, &id, &springs, 1, dt, NULL)
                            : RESULT(dpt_body_step_springs, world, id, springs, dt, NULL));
    }
    expect(result, &codes);
    pair->most = HUGE_VAL;
    if (scene->world_count == 1) { /* the twin is not where it is */
        free(pair->block[1]);
        pair->block[1] = NULL;
        pair->made[1] = NULL;
    }
    if (result == DPT_OK)
        body_has_moved(scene, body);
    else if (body && body->soft)
        soft_must_be_there(scene, body);
    read_nodes(pair, 0, &after);
    if (result != DPT_OK && body && body->soft && body->soft->def.response == DPT_RESPONSE_LOAD)
        HOLDS(nodes_are_same(pair, &before, &after), "its springs have gone on after an error");
}

static const struct move moves[] = { { "create", create, 4 },          { "defaults", defaults, 1 },
                                     { "get nodes", get_nodes, 2 },    { "set nodes", set_nodes, 3 },
                                     { "get energy", get_energy, 2 },  { "get compliances", get_compliances, 2 },
                                     { "foresee", foresee, 2 },        { "step", step, 10 },
                                     { "step a body", step_body, 10 }, { NULL, NULL, 0 } };

const struct noun spring_noun = { "springs", NULL, end, moves };
