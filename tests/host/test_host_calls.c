/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Random sequences of calls on hosts, against a model that knows which definitions are good, which ticks have a sample, and
 * what the counts are: `test_host_calls [COUNT [SEED]]` opens so many hosts. Every function is total; the wrench is finite
 * and within its limits, always.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dynpoint/host.h"
#include "lib/check.h"
#include "lib/fixture.h"
#include "lib/random.h"
#include "lib/vector.h"

enum { CALLS = 300, CODES_MAX = 8 };

static unsigned long host_count = 120;
static uint64_t seed = 1;
static struct fixture rigid, soft;

static uint64_t draw(uint64_t below)
{
    return random_bits(&seed) % below;
}

static int one_in(uint64_t count)
{
    return draw(count) == 0;
}

/* A definition that is drawn, with what it points to. */
struct drawn {
    dpt_host_def def;
    dpt_device_info info;
    dpt_host_body bodies[2];
    dpt_segment segments[2];
    dpt_pose pose;
    const char *tips[3];
    int is_soft;
    dpt_result code[CODES_MAX]; /* what may be wrong with it */
    int codes;
};

/* What the ticks of a host came to, counted by the model. */
struct model {
    const struct drawn *drawn;
    dpt_host *host;
    dpt_host_info info;
    uint64_t felt; /* calls of the function of that name */
    dpt_result result;
    /* Of the samples so far. */
    dpt_device_state last;
    int has_sequence, has_time, is_lost, has_pose;
    uint64_t sequence, time_ns, now_ns;
    double hand[3];
    int is_stopped;
    uint64_t limited; /* ticks whose force is at its limit */
};

static void fail_with(struct drawn *drawn, dpt_result code)
{
    if (drawn->codes < CODES_MAX)
        drawn->code[drawn->codes++] = code;
}

static void draw_device(struct drawn *drawn)
{
    static const double rates[] = { 0.0, 500.0, 1000.0, 2000.0 };
    dpt_device_info *info = &drawn->info;
    *info = (dpt_device_info){ .size = sizeof *info, .rate = 1000.0, .mass = 0.1, .damping = 0.5 };
    info->pose_dofs = one_in(2) ? 3 : 6;
    info->wrench_dofs = info->pose_dofs == 6 && one_in(2) ? 6 : 3;
    info->inertia = info->wrench_dofs == 6 ? 1e-4 : 0.0;
    info->spin_damping = info->wrench_dofs == 6 ? 1e-3 : 0.0;
    info->force_max = one_in(2) ? 3.0 : 8.0;
    info->torque_max = info->wrench_dofs == 6 ? 0.1 : 0.0;
    drawn->def.rate = rates[draw(4)];
    if (one_in(4)) {
        drawn->def.device = "sim:?hand=press&cycle=0.2";
        drawn->def.ticks = 1 + draw(40);
    } else {
        drawn->def.info = info;
    }
}

static void draw_scene(struct drawn *drawn)
{
    static const dpt_pose upright = DPT_POSE_IDENTITY;
    dpt_host_def *def = &drawn->def;
    if (one_in(8)) {
        def->scene = "tori";
        return;
    }
    drawn->is_soft = one_in(3);
    drawn->pose = upright;
    drawn->pose.position[0] = random_in(&seed, -0.01, 0.01);
    for (int i = 0; i < 2; i++)
        drawn->bodies[i] = (dpt_host_body){ .size = sizeof drawn->bodies[i],
                                            .mesh = drawn->is_soft ? soft.mesh : rigid.mesh,
                                            .pose = i ? &drawn->pose : NULL,
                                            .name = one_in(2) ? "own" : NULL,
                                            .integrator = DPT_INTEGRATOR_IMPLICIT };
    def->bodies = drawn->bodies;
    def->body_count = 1 + (uint32_t)draw(2);
    def->gravity = one_in(2) ? 9.81 : 0.0;
    drawn->segments[0] = (dpt_segment){ { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.05 }, 0.003 };
    drawn->segments[1] = (dpt_segment){ { 0.0, 0.0, 0.05 }, { 0.0, 0.02, 0.06 }, 0.001 };
    if (one_in(3)) {
        def->segments = drawn->segments;
        def->segment_count = 1 + (uint32_t)draw(2);
    }
    if (drawn->is_soft && one_in(2))
        def->physics = 250.0;
}

static void draw_good(struct drawn *drawn)
{
    dpt_host_def *def = &drawn->def;
    static const uint32_t laws[] = { DPT_NONE, DPT_LAW_PROXY, DPT_LAW_BED, DPT_LAW_POINT };
    memset(drawn, 0, sizeof *drawn);
    dpt_host_def_init(def);
    draw_device(drawn);
    draw_scene(drawn);
    def->law = laws[draw(4)];
    const int has_proxy = def->law == DPT_NONE || def->law == DPT_LAW_PROXY;
    def->flags = (uint32_t)draw(8);
    def->stiffness = one_in(2) ? 0.0 : random_in(&seed, 50.0, 3000.0);
    def->friction = has_proxy && one_in(2) ? random_in(&seed, 0.0, 1.0) : NAN;
    def->zoom = one_in(2) ? NAN : random_in(&seed, 0.5, 2.0);
    def->force_scale = one_in(2) ? NAN : random_in(&seed, 0.5, 2.0);
    def->clutch = one_in(2) ? DPT_NONE : (uint32_t)draw(32);
    def->budget = one_in(2) ? 0 : 200 + (uint32_t)draw(2000);
    def->force_max = one_in(2) ? NAN : random_in(&seed, 0.0, 20.0);
    drawn->tips[0] = "box:0.01,0.01,0.02";
    if (has_proxy && one_in(4))
        def->tips = drawn->tips;
}

/* One thing that is wrong; some go with some scenes alone. */
static void spoil(struct drawn *drawn)
{
    static const struct {
        size_t at;
        double value;
    } numbers[] = { { offsetof(dpt_host_def, stiffness), -1.0 },   { offsetof(dpt_host_def, stiffness), NAN },
                    { offsetof(dpt_host_def, gain_margin), 0.9 },  { offsetof(dpt_host_def, friction), -0.1 },
                    { offsetof(dpt_host_def, damping), INFINITY }, { offsetof(dpt_host_def, zoom), 0.0 },
                    { offsetof(dpt_host_def, force_scale), 2e3 },  { offsetof(dpt_host_def, physics), 0.5 },
                    { offsetof(dpt_host_def, physics), NAN },      { offsetof(dpt_host_def, rate), -1.0 },
                    { offsetof(dpt_host_def, force_max), 1e4 },    { offsetof(dpt_host_def, gravity), -1.0 },
                    { offsetof(dpt_host_def, origin), 2e6 },       { offsetof(dpt_host_def, length), 20.0 },
                    { offsetof(dpt_host_def, radius), -0.1 } };
    enum { NUMBERS = sizeof numbers / sizeof *numbers };
    dpt_host_def *def = &drawn->def;
    const uint64_t which = draw(NUMBERS + 14);
    dpt_result code = DPT_E_ARGUMENT;
    if (which < NUMBERS) {
        memcpy((char *)def + numbers[which].at, &numbers[which].value, sizeof numbers[which].value);
    } else if (which == NUMBERS) {
        def->flags |= 1u << (8 + draw(24));
    } else if (which == NUMBERS + 1) {
        def->law = 3 + (uint32_t)draw(100);
    } else if (which == NUMBERS + 2) {
        def->clutch = 32 + (uint32_t)draw(100);
    } else if (which == NUMBERS + 3) {
        def->device = "nonesuch";
        code = DPT_E_UNSUPPORTED;
    } else if (which == NUMBERS + 4) {
        def->device = NULL;
        def->info = NULL;
    } else if (which == NUMBERS + 5) {
        def->identified = "no/such/file";
        code = DPT_E_OPEN;
    } else if (which == NUMBERS + 6) {
        def->tips = drawn->tips;
        drawn->tips[0] = "ball:1";
    } else if (which == NUMBERS + 7) {
        def->jaw = one_in(2) ? "ajar" : "0:1:1";
    } else if (which == NUMBERS + 8) {
        def->body_count = def->body_count ? 0 : 1;
    } else if (which == NUMBERS + 9) {
        def->scene = def->scene ? NULL : "liver";
    } else if (which == NUMBERS + 10) {
        def->size = one_in(2) ? 4 : 5000;
        code = DPT_E_SIZE;
    } else if (which == NUMBERS + 11) {
        def->segments = drawn->segments;
        def->segment_count = 1;
        drawn->segments[0].radius = NAN;
    } else if (which == NUMBERS + 12) {
        drawn->info.size = 4;
        def->device = NULL;
        def->info = &drawn->info;
        code = DPT_E_SIZE;
    } else {
        def->flags |= DPT_HOST_FLAG_EMBED;
    }
    fail_with(drawn, code);
}

static int is_expected(const struct drawn *drawn, dpt_result result)
{
    int is_one = !drawn->codes && result == DPT_OK;
    for (int i = 0; i < drawn->codes; i++)
        is_one |= result == drawn->code[i];
    return is_one;
}

/* The model counts what the host counts, by what the world tells behind each step. */
static void note(void *user, dpt_host *host, const dpt_loop_sample *sample, dpt_result result, const dpt_wrench *wrench)
{
    struct model *model = user;
    dpt_host_info *info = &model->info;
    dpt_hit hit = DPT_HIT_INIT;
    const double force = length3(wrench->force);
    model->felt++;
    model->result = result;
    info->ticks++;
    info->clutched += result == DPT_E_NOT_READY;
    info->failed += result != DPT_OK && result != DPT_E_NOT_READY;
    if (result != DPT_OK)
        return;
    model->has_pose = 1;
    dpt_tool_get_hit(dpt_host_get_world(host), dpt_host_get_tool(host), &hit);
    info->reasons |= sample->state->reasons;
    info->contacts += hit.contact != DPT_CONTACT_SEPARATED;
    info->penetrating += hit.contact == DPT_CONTACT_PENETRATING;
    info->unknown += hit.contact == DPT_CONTACT_UNKNOWN;
    info->force_max = fmax(info->force_max, force);
}

static double force_limit(const struct drawn *drawn)
{
    const double own = isnan(drawn->def.force_max) ? 5.0 : drawn->def.force_max;
    return fmin(own, drawn->info.force_max);
}

static int is_sound(const dpt_pose *pose)
{
    double square = 0.0;
    for (int k = 0; k < 4; k++)
        square += pose->orientation[k] * pose->orientation[k];
    for (int k = 0; k < 3; k++)
        if (!(fabs(pose->position[k]) <= DPT_COORDINATE_MAX))
            return 0;
    return fabs(square - 1.0) <= 2e-6;
}

static void draw_state(struct model *model, dpt_device_state *state)
{
    static const double nasty[] = { NAN, INFINITY, -INFINITY, 2e6 };
    *state = (dpt_device_state){ .size = sizeof *state,
                                 .status = one_in(200) ? (uint32_t)draw(5) : DPT_DEVICE_STATUS_READY,
                                 .reasons = one_in(8) ? 1u << draw(11) : 0,
                                 .buttons = one_in(10) ? (uint32_t)random_bits(&seed) : 0,
                                 .fresh = one_in(12) ? 0 : (uint32_t)(1 + draw(3)),
                                 .sequence = one_in(300) ? random_bits(&seed)
                                                         : model->sequence + (one_in(20) ? 0 : 1 + draw(2)),
                                 .pose = DPT_POSE_IDENTITY };
    /* The hand sinks, shakes, and seldom jumps, so that most hosts push back in the end. */
    for (int k = 0; k < 3; k++)
        model->hand[k] += random_in(&seed, -2e-4, 2e-4) - (k == 1 ? 2e-4 : 0.0);
    if (one_in(60))
        model->hand[draw(3)] = random_in(&seed, -0.02, 0.01);
    memcpy(state->pose.position, model->hand, sizeof model->hand);
    if (one_in(20))
        random_turn(&seed, state->pose.orientation);
    if (one_in(200))
        (&state->pose.position[0])[draw(7)] = nasty[draw(4)];
    model->now_ns += one_in(200) ? draw(4000000000u) : 1000000;
    state->time_ns = one_in(200) ? random_bits(&seed) : model->now_ns;
    if (one_in(200))
        state->size = (uint32_t)draw(8);
}

/* What the sample's time is; 0: there is none. */
static double take_sample(struct model *model, const dpt_device_state *state)
{
    const double rate = model->drawn->def.rate > 0.0 ? model->drawn->def.rate : model->drawn->info.rate;
    const int is_taken = state->size >= sizeof *state;
    double dt = 1.0 / rate;
    if (is_taken)
        model->last = *state;
    if (model->last.status == DPT_DEVICE_STATUS_LOST) {
        if (!model->is_lost)
            model->has_sequence = model->has_time = 0;
        model->is_lost = 1;
        return 0.0;
    }
    model->is_lost = 0;
    if (!is_taken || !state->fresh || (model->has_sequence && state->sequence <= model->sequence))
        return 0.0;
    model->has_sequence = 1;
    model->sequence = state->sequence;
    if (!is_sound(&state->pose))
        return 0.0;
    if (model->has_time && state->time_ns > model->time_ns)
        dt = (double)(state->time_ns - model->time_ns) * 1e-9;
    model->has_time = 1;
    model->time_ns = state->time_ns;
    return dt;
}

static void check_tick(struct model *model)
{
    const struct drawn *drawn = model->drawn;
    const dpt_host_def *def = &drawn->def;
    dpt_device_state state;
    dpt_wrench wrench = { { NAN, NAN, NAN }, { NAN, NAN, NAN } };
    draw_state(model, &state);
    const double dt = take_sample(model, &state);
    const int has_pose = model->has_pose, is_taken = state.size >= sizeof state;
    const uint64_t felt = model->felt;
    const dpt_result result = dpt_host_tick(model->host, &state, model->now_ns, &wrench);
    CHECK(model->felt - felt == (dt > 0.0), "a tick with a dt of %g is felt %u times", dt,
          (unsigned)(model->felt - felt));
    const int is_clutched = dt > 0.0 && def->clutch != DPT_NONE && state.buttons >> def->clutch & 1 && has_pose;
    if (!is_taken)
        CHECK(result == DPT_E_SIZE, "%s", dpt_result_name(result));
    else if (!(dt > 0.0))
        CHECK(result == DPT_OK, "without a sample: %s", dpt_result_name(result));
    else if (is_clutched)
        CHECK(result == DPT_E_NOT_READY, "the clutch is down: %s", dpt_result_name(result));
    else if (dt <= (drawn->is_soft ? 1.0 : 1e6) && (dt >= 1e-9 || !drawn->is_soft))
        CHECK(result == DPT_OK, "a tick of %g s: %s", dt, dpt_result_name(result));
    else
        CHECK(result != DPT_OK, "a tick of %g s succeeds", dt);
    const double force = length3(wrench.force), torque = length3(wrench.torque);
    CHECK(force <= force_limit(drawn) * (1.0 + 1e-12) && torque <= 0.2, "%g N, %g Nm", force, torque);
    model->limited += force > 0.0 && force > 0.999 * force_limit(drawn);
    if (model->last.status != DPT_DEVICE_STATUS_READY)
        CHECK(force + torque == 0.0, "%g N of a device that is not ready", force);
}

static void check_run(struct model *model)
{
    dpt_loop_stats stats = { .size = sizeof stats };
    dpt_host_error error = { .size = sizeof error };
    const uint64_t felt = model->felt, due = model->is_stopped ? 0 : model->drawn->def.ticks;
    const dpt_result result = dpt_host_run(model->host, one_in(2) ? &stats : NULL, one_in(2) ? &error : NULL);
    CHECK(result == DPT_OK && model->felt - felt == due, "%s: %u ticks instead of %u", dpt_result_name(result),
          (unsigned)(model->felt - felt), (unsigned)due);
    CHECK(!error.text[0], "%s", error.text);
    model->is_stopped = 0;
}

static void check_info(const struct model *model)
{
    const dpt_host_info *own = &model->info;
    dpt_host_info info = { .size = sizeof info };
    CHECK(dpt_host_get_info(model->host, &info) == DPT_OK, "no info");
    CHECK(info.ticks == own->ticks && info.failed == own->failed && info.clutched == own->clutched,
          "%u ticks, %u failed, %u clutched; and not %u, %u, %u", (unsigned)info.ticks, (unsigned)info.failed,
          (unsigned)info.clutched, (unsigned)own->ticks, (unsigned)own->failed, (unsigned)own->clutched);
    CHECK(info.contacts == own->contacts && info.penetrating == own->penetrating && info.unknown == own->unknown &&
              info.reasons == own->reasons && info.force_max == own->force_max,
          "%u contacts, %u inside, %u unknown, %g N; and not %u, %u, %u, %g N", (unsigned)info.contacts,
          (unsigned)info.penetrating, (unsigned)info.unknown, info.force_max, (unsigned)own->contacts,
          (unsigned)own->penetrating, (unsigned)own->unknown, own->force_max);
    CHECK(info.limited <= info.ticks && isfinite(info.taken) && info.account_min <= 0.0 && isfinite(info.depth_max),
          "%g J, %g J", info.taken, info.account_min);
    CHECK(!info.failed == !strstr(info.trouble, "ticks failed"), "%u failed: '%s'", (unsigned)info.failed,
          info.trouble);
}

/* Calls that cannot be are refused, and change nothing. */
static void check_refused(struct model *model)
{
    const int is_own = model->drawn->def.device == NULL;
    const dpt_device_state state = { .size = sizeof state, .fresh = 1, .status = DPT_DEVICE_STATUS_READY };
    dpt_wrench wrench = { { NAN, NAN, NAN }, { NAN, NAN, NAN } };
    dpt_host_error small = { .size = 4 };
    const uint64_t felt = model->felt;
    dpt_host *host = is_own ? NULL : model->host;
    CHECK(dpt_host_tick(host, &state, 0, &wrench) == DPT_E_ARGUMENT && length3(wrench.force) == 0.0, "tick");
    CHECK(dpt_host_tick(model->host, NULL, 0, &wrench) == DPT_E_ARGUMENT &&
              dpt_host_tick(model->host, &state, 0, NULL) == DPT_E_ARGUMENT,
          "NULL");
    CHECK(dpt_host_run(is_own ? model->host : NULL, NULL, NULL) == DPT_E_ARGUMENT, "run");
    CHECK(dpt_host_run(model->host, NULL, &small) == DPT_E_SIZE, "an error of 4 bytes");
    CHECK(dpt_host_get_info(model->host, NULL) == DPT_E_ARGUMENT && dpt_host_get_info(NULL, NULL) == DPT_E_ARGUMENT &&
              dpt_host_get_info(model->host, (dpt_host_info *)&small) == DPT_E_SIZE,
          "info");
    CHECK(dpt_host_get_world(model->host) && dpt_host_get_tool(model->host) && dpt_host_get_body(model->host, 0) &&
              !dpt_host_get_body(model->host, 64) && !dpt_host_get_body(NULL, 0),
          "world, tool and body");
    CHECK(model->felt == felt, "what was refused is felt");
}

static void use(struct model *model)
{
    const int is_own = model->drawn->def.device == NULL;
    for (uint64_t calls = draw(CALLS); calls > 0; calls--) {
        if (one_in(10))
            check_info(model);
        else if (one_in(16))
            check_refused(model);
        else if (is_own)
            check_tick(model);
        else if (one_in(3)) {
            dpt_host_stop(model->host);
            model->is_stopped = 1;
        } else if (one_in(4))
            check_run(model);
    }
    check_info(model);
}

static void hosts_keep_to_the_model(void)
{
    uint64_t opened = 0, refused = 0, felt = 0, contacts = 0, limited = 0;
    for (unsigned long i = 0; i < host_count && !check_bad; i++) {
        struct drawn drawn;
        struct model model = { .drawn = &drawn };
        dpt_host_error error = { .size = sizeof error };
        draw_good(&drawn);
        while (one_in(3))
            spoil(&drawn);
        drawn.def.felt = note;
        drawn.def.user = &model;
        if (drawn.def.device)
            drawn.info.force_max = HUGE_VAL;
        const int is_told = !one_in(4);
        const dpt_result result = dpt_host_open(&drawn.def, &model.host, is_told ? &error : NULL);
        CHECK(is_expected(&drawn, result) && !model.host == (result != DPT_OK), "host %lu: %s: '%s'", i,
              dpt_result_name(result), error.text);
        CHECK(!is_told || (error.code == result && (result == DPT_OK || error.text[0]) && !strchr(error.text, '\n')),
              "host %lu: %s and '%s'", i, dpt_result_name(result), error.text);
        opened += result == DPT_OK;
        refused += result != DPT_OK;
        if (result == DPT_OK)
            use(&model);
        CHECK(dpt_host_close(model.host, NULL) == DPT_OK, "close");
        felt += model.felt;
        contacts += model.info.contacts;
        limited += model.limited;
        if (check_bad)
            printf("    at host %lu\n", i);
    }
    if (check_bad)
        return;
    CHECK(opened > host_count / 4 && refused > host_count / 10 && felt > 20 * host_count && contacts > 4 * host_count &&
              limited > host_count / 10,
          "%u opened, %u refused, %u ticks, %u contacts, %u at the limit", (unsigned)opened, (unsigned)refused,
          (unsigned)felt, (unsigned)contacts, (unsigned)limited);
}

static int set_up(void)
{
    dpt_spring_net_def net;
    dpt_spring_net_def_init(&net);
    net.kind = DPT_NET_SHEET;
    return fixture_from_shape(&rigid, "liver", 600) && fixture_with_springs(&soft, "liver", 200, &net);
}

int main(int argc, char **argv)
{
    take_count(argc, argv, &host_count, &seed);
    CHECK(set_up(), "no meshes");
    TEST(hosts_keep_to_the_model);
    fixture_free(&rigid);
    fixture_free(&soft);
    return check_report();
}
