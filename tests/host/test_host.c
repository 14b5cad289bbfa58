/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * libdynpoint_host: a loop of the library's and one of the caller's feel the same, bit for bit; what is refused says why;
 * silence and loss end the force. That a host feels what `dynpoint run` does is for tests/ffi/host.py.
 */
#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "dynpoint/driver.h"
#include "dynpoint/host.h"
#include "lib/check.h"
#include "lib/random.h"
#include "lib/size_checks.h"
#include "lib/vector.h"

enum { TICKS = 600 };

/* What a run was fed with, and what came of it. */
struct felt {
    dpt_device_state state[TICKS];
    dpt_wrench asked[TICKS], sent[TICKS]; /* before the guard; what acted before that sample */
    dpt_result result[TICKS];
    uint32_t count;
};

static void note(void *user, dpt_host *host, const dpt_loop_sample *sample, dpt_result result, const dpt_wrench *wrench)
{
    struct felt *felt = user;
    (void)host;
    if (felt->count == TICKS)
        return;
    felt->state[felt->count] = *sample->state;
    felt->asked[felt->count] = *wrench;
    felt->sent[felt->count] = sample->sent;
    felt->result[felt->count++] = result;
}

static dpt_host *open_host(const dpt_host_def *def)
{
    dpt_host *host;
    dpt_host_error error = { .size = sizeof error };
    const dpt_result result = dpt_host_open(def, &host, &error);
    CHECK(result == DPT_OK && host && error.code == DPT_OK, "%s: %s", def->scene, error.text);
    return host;
}

static dpt_host_info info_of(const dpt_host *host)
{
    dpt_host_info info = { .size = sizeof info };
    CHECK(dpt_host_get_info(host, &info) == DPT_OK, "no info");
    return info;
}

/* The device of `device`, for a loop of one's own. */
static dpt_device_info info_of_device(const char *name)
{
    dpt_device *device;
    dpt_device_info info = { .size = sizeof info };
    CHECK(dpt_device_open(name, &device, NULL) == DPT_OK && dpt_device_get_info(device, &info) == DPT_OK, "%s", name);
    dpt_device_close(device);
    return info;
}

/* The same samples by dpt_host_run and by dpt_host_tick: what is asked for and what is sent are the same bits. */
static void both_loops_feel_the_same(void)
{
    static const struct {
        const char *scene;
        uint32_t law;
        double physics;
    } cases[] = { { "membrane", DPT_NONE, 0.0 },
                  { "laparoscopy", DPT_NONE, 0.0 },
                  { "laparoscopy", DPT_NONE, 500.0 },
                  { "laparoscopy", DPT_LAW_BED, 0.0 } };
    static struct felt run, own;
    const char *device = "sim:?hand=press&cycle=0.4";
    for (size_t c = 0; c < part_of(sizeof cases / sizeof *cases); c++) {
        dpt_host_def def;
        dpt_loop_stats stats = { .size = sizeof stats };
        dpt_host_def_init(&def);
        def.scene = cases[c].scene;
        def.law = cases[c].law;
        def.physics = cases[c].physics;
        def.device = device;
        def.ticks = TICKS;
        def.felt = note;
        run.count = own.count = 0;
        def.user = &run;
        dpt_host *host = open_host(&def);
        CHECK(dpt_host_run(host, &stats, NULL) == DPT_OK && stats.fresh == TICKS && run.count == TICKS,
              "%s: %u of %d ticks", def.scene, run.count, TICKS);
        const dpt_host_info by_run = info_of(host);
        dpt_host_close(host, NULL);
        const dpt_device_info info = info_of_device(device);
        def.device = NULL;
        def.info = &info;
        def.user = &own;
        host = open_host(&def);
        uint32_t wrong = 0, pushed = 0;
        for (uint32_t i = 0; host && i < run.count; i++) {
            dpt_wrench wrench;
            dpt_host_tick(host, &run.state[i], run.state[i].time_ns, &wrench);
            wrong += memcmp(&own.asked[i], &run.asked[i], sizeof wrench) || own.result[i] != run.result[i];
            wrong += i + 1 < run.count && memcmp(&wrench, &run.sent[i + 1], sizeof wrench);
            pushed += length3(wrench.force) > 0.01;
        }
        const dpt_host_info by_own = info_of(host);
        CHECK(!wrong && pushed > TICKS / 10, "%s, law %u, physics %g Hz: %u of %u ticks differ, %u have a force",
              def.scene, def.law, def.physics, wrong, run.count, pushed);
        CHECK(!memcmp(&by_run, &by_own, sizeof by_run) && by_run.ticks == TICKS && by_run.contacts > TICKS / 10,
              "%s: what is counted differs", def.scene);
        dpt_host_close(host, NULL);
    }
}

/* A host with a loop of one's own, pressed onto a membrane until it pushes. */
struct pressed {
    dpt_host *host;
    dpt_device_info info;
    dpt_device_state state;
    dpt_wrench wrench;
};

static dpt_result tick(struct pressed *pressed, uint32_t fresh)
{
    pressed->state.time_ns += 1000000;
    pressed->state.fresh = fresh;
    pressed->state.sequence += fresh;
    return dpt_host_tick(pressed->host, &pressed->state, pressed->state.time_ns, &pressed->wrench);
}

static void press(struct pressed *pressed)
{
    dpt_host_def def;
    *pressed = (struct pressed){ .info = info_of_device("sim"), .state = { .size = sizeof pressed->state } };
    pressed->info.flags = 0;
    pressed->info.force_max = 5.0;
    pressed->state.status = DPT_DEVICE_STATUS_READY;
    pressed->state.pose = (dpt_pose)DPT_POSE_IDENTITY;
    dpt_host_def_init(&def);
    def.scene = "tori";
    def.info = &pressed->info;
    pressed->host = open_host(&def);
    for (int i = 0; i < 1000; i++) {
        pressed->state.pose.position[1] = -1e-5 * i;
        CHECK(tick(pressed, 1) == DPT_OK, "tick %d", i);
    }
    CHECK(length3(pressed->wrench.force) > 0.5, "only %g N", length3(pressed->wrench.force));
}

static void silence_and_loss_end_the_force(void)
{
    struct pressed pressed;
    press(&pressed);
    /* As long as a command holds, three periods here, and then down. */
    int ticks = 0;
    for (; ticks < 20 && length3(pressed.wrench.force) > 0.0; ticks++)
        tick(&pressed, 0);
    CHECK(ticks >= 3 && ticks <= 6, "it ends after %d ticks", ticks);
    for (int i = 0; i < 200; i++)
        tick(&pressed, 1);
    CHECK(length3(pressed.wrench.force) > 0.5, "only %g N again", length3(pressed.wrench.force));
    static const uint32_t statuses[] = { DPT_DEVICE_STATUS_LOST, DPT_DEVICE_STATUS_FAULT, DPT_DEVICE_STATUS_UNREADY };
    for (size_t i = 0; i < sizeof statuses / sizeof *statuses; i++) {
        pressed.state.status = statuses[i];
        tick(&pressed, 1);
        CHECK(length3(pressed.wrench.force) + length3(pressed.wrench.torque) == 0.0, "status %u: %g N", statuses[i],
              length3(pressed.wrench.force));
        pressed.state.status = DPT_DEVICE_STATUS_READY;
        tick(&pressed, 1);
        CHECK(length3(pressed.wrench.force) < 0.2, "%g N at once", length3(pressed.wrench.force));
        for (int k = 0; k < 200; k++)
            tick(&pressed, 1);
        CHECK(length3(pressed.wrench.force) > 0.5, "only %g N again", length3(pressed.wrench.force));
    }
    dpt_host_close(pressed.host, NULL);
}

/* Whatever the samples are, the wrench is finite and within the limits. */
static void samples_may_be_anything(void)
{
    struct pressed pressed;
    uint64_t seed = 3;
    press(&pressed);
    static const double nasty[] = { NAN, INFINITY, -INFINITY, 1e300, 0.0, -0.0, 1e-310, 2e6 };
    const dpt_device_state good = pressed.state;
    uint32_t wrong = 0;
    for (uint64_t i = 0; i < part_of(5000); i++) {
        dpt_device_state state = good;
        uint64_t now = pressed.state.time_ns += random_bits(&seed) % 3000000;
        state.time_ns = random_bits(&seed) % 8 ? now : random_bits(&seed);
        state.sequence = random_bits(&seed) % 8 ? ++pressed.state.sequence : random_bits(&seed);
        state.fresh = (uint32_t)(random_bits(&seed) % 3);
        state.status = random_bits(&seed) % 8 ? DPT_DEVICE_STATUS_READY : (uint32_t)(random_bits(&seed) % 5);
        for (int k = 0; k < 3; k++)
            state.pose.position[k] += random_in(&seed, -0.001, 0.001);
        if (random_bits(&seed) % 4 == 0)
            (&state.pose.position[0])[random_bits(&seed) % 7] = nasty[random_bits(&seed) % 8];
        if (random_bits(&seed) % 64 == 0)
            state.size = (uint32_t)(random_bits(&seed) % sizeof state);
        dpt_wrench wrench = { { NAN, 0, 0 }, { 0, 0, 0 } };
        dpt_host_tick(pressed.host, &state, now, &wrench);
        wrong += !(length3(wrench.force) <= 5.0 + 1e-9) || !(length3(wrench.torque) <= 1.0);
    }
    CHECK(wrong == 0, "%u wrenches are beyond the limits", wrong);
    dpt_host_close(pressed.host, NULL);
}

static void refuses(const char *what, const dpt_host_def *def, dpt_result code, const char *text)
{
    dpt_host *host = (void *)&host;
    dpt_host_error error = { .size = sizeof error };
    const dpt_result result = dpt_host_open(def, &host, &error);
    CHECK(result == code && !host && error.code == code && strstr(error.text, text) && !strchr(error.text, '\n'),
          "%s: %s: '%s'", what, dpt_result_name(result), error.text);
    CHECK(dpt_host_open(def, &host, NULL) == code && !host, "%s, without an error to fill", what);
}

static dpt_host_def usual(void)
{
    dpt_host_def def;
    dpt_host_def_init(&def);
    def.scene = "membrane";
    def.device = "sim";
    return def;
}

static void what_cannot_be_says_why(void)
{
    dpt_host_def def = usual();
    dpt_host *host;
    def.scene = NULL;
    refuses("no scene", &def, DPT_E_ARGUMENT, "a scene is needed");
    def.scene = "nothing.dpa";
    refuses("no file", &def, DPT_E_OPEN, "nothing.dpa: cannot be opened");
    def = usual();
    def.device = NULL;
    refuses("no device", &def, DPT_E_ARGUMENT, "a device is needed");
    def.device = "nonesuch";
    refuses("no such device", &def, DPT_E_UNSUPPORTED, "nonesuch");
    def = usual();
    def.identified = "nothing.txt";
    refuses("no dynamics", &def, DPT_E_OPEN, "nothing.txt");
    def = usual();
    def.scene = "liver";
    def.physics = 100.0;
    refuses("physics of what is rigid", &def, DPT_E_ARGUMENT, "none of its bodies gives way");
    def = usual();
    def.law = DPT_LAW_BED;
    def.friction = 0.5;
    refuses("friction without a proxy", &def, DPT_E_ARGUMENT, "for the law proxy");
    static const struct {
        size_t at;
        double value;
        const char *name;
    } numbers[] = { { offsetof(dpt_host_def, stiffness), -1.0, "stiffness" },
                    { offsetof(dpt_host_def, stiffness), NAN, "stiffness" },
                    { offsetof(dpt_host_def, gain_margin), 0.5, "gain_margin" },
                    { offsetof(dpt_host_def, friction), -0.1, "friction" },
                    { offsetof(dpt_host_def, damping), INFINITY, "damping" },
                    { offsetof(dpt_host_def, zoom), 0.0, "zoom" },
                    { offsetof(dpt_host_def, force_scale), 1e4, "force_scale" },
                    { offsetof(dpt_host_def, length), 11.0, "length" },
                    { offsetof(dpt_host_def, radius), -1.0, "radius" },
                    { offsetof(dpt_host_def, force_max), 1001.0, "force_max" },
                    { offsetof(dpt_host_def, rate), 0.5, "rate" },
                    { offsetof(dpt_host_def, rate), NAN, "rate" },
                    { offsetof(dpt_host_def, origin), 2e6, "origin" } };
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        def = usual();
        memcpy((char *)&def + numbers[i].at, &numbers[i].value, sizeof numbers[i].value);
        refuses(numbers[i].name, &def, DPT_E_ARGUMENT, numbers[i].name);
    }
    def = usual();
    def.flags = 1u << 31;
    refuses("an unknown flag", &def, DPT_E_ARGUMENT, "flags");
    CHECK(dpt_host_open(NULL, &host, NULL) == DPT_E_ARGUMENT && !host, "no def");
    CHECK(dpt_host_open(&def, NULL, NULL) == DPT_E_ARGUMENT, "no host");
}

/* Softer than was asked for: that is a note, and no failure. */
static void notes_are_said(void)
{
    dpt_host *host;
    dpt_host_def def = usual();
    dpt_host_error error = { .size = sizeof error };
    def.stiffness = 1e6;
    CHECK(dpt_host_open(&def, &host, &error) == DPT_OK && error.code == DPT_OK && strstr(error.text, "N/m"), "'%s'",
          error.text);
    const dpt_host_info info = info_of(host);
    CHECK(info.stiffness < 2000.0 && info.limit == DPT_COUPLING_STABILITY && info.stable > info.stiffness, "%g N/m",
          info.stiffness);
    dpt_host_close(host, NULL);
    def.flags = DPT_HOST_FLAG_UNSTABLE;
    host = open_host(&def);
    CHECK(info_of(host).stiffness == 1e6, "%g N/m", info_of(host).stiffness);
    dpt_host_close(host, NULL);
}

static void every_scene_opens(void)
{
    uint32_t count = 0;
    for (const char *name; (name = dpt_host_get_scene(count)) != NULL; count++) {
        dpt_host_def def = usual();
        if (count >= part_of(100))
            continue;
        def.scene = name;
        def.ticks = 20;
        dpt_host *host = open_host(&def);
        CHECK(dpt_host_run(host, NULL, NULL) == DPT_OK && info_of(host).ticks == 20, "%s", name);
        CHECK(dpt_host_run(host, NULL, NULL) == DPT_OK && info_of(host).ticks == 40, "%s again", name);
        CHECK(dpt_host_get_world(host) && dpt_host_get_tool(host), "%s: no world", name);
        dpt_host_close(host, NULL);
    }
    CHECK(count >= 6 && !dpt_host_get_scene(UINT32_MAX), "%u scenes", count);
}

/* A device that stops itself gives no force, and the host tells so, and why. */
static void a_fault_is_told(void)
{
    dpt_host_def def = usual();
    def.device = "sim:?hand=press&fault=estop@0.2";
    def.ticks = 500;
    dpt_host *host = open_host(&def);
    CHECK(dpt_host_run(host, NULL, NULL) == DPT_OK || info_of(host).ticks == 500, "it ended");
    const dpt_host_info info = info_of(host);
    CHECK(strstr(info.trouble, "the device had stopped itself on 3") && strstr(info.trouble, " of 500 ticks (") &&
              strstr(info.trouble, "), and gave no force") && !strchr(info.trouble, '\n'),
          "'%s'", info.trouble);
    dpt_host_close(host, NULL);
    def.device = "sim:?hand=press";
    host = open_host(&def);
    dpt_host_run(host, NULL, NULL);
    CHECK(!info_of(host).trouble[0], "'%s'", info_of(host).trouble);
    dpt_host_close(host, NULL);
}

static void nothing_may_be_null(void)
{
    dpt_wrench wrench = { { 1, 1, 1 }, { 1, 1, 1 } };
    dpt_host_info info = { .size = sizeof info, .ticks = 7 };
    const dpt_device_state state = { .size = sizeof state };
    dpt_host *host = NULL;
    dpt_host_close(NULL, NULL);
    dpt_host_stop(NULL);
    CHECK(dpt_host_run(NULL, NULL, NULL) == DPT_E_ARGUMENT, "run");
    CHECK(dpt_host_tick(NULL, &state, 0, &wrench) == DPT_E_ARGUMENT && length3(wrench.force) == 0.0, "tick");
    CHECK(dpt_host_get_info(NULL, &info) == DPT_E_ARGUMENT && info.ticks == 0, "info");
    CHECK(!dpt_host_get_world(NULL) && !dpt_host_get_tool(NULL), "world");
    dpt_host_def def = usual();
    host = open_host(&def);
    CHECK(dpt_host_tick(host, &state, 0, &wrench) == DPT_E_ARGUMENT, "the loop is the host's");
    CHECK(dpt_host_get_info(host, NULL) == DPT_E_ARGUMENT, "no info");
    dpt_host_close(host, NULL);
    const dpt_device_info device = info_of_device("sim");
    def.device = NULL;
    def.info = &device;
    host = open_host(&def);
    CHECK(dpt_host_run(host, NULL, NULL) == DPT_E_ARGUMENT, "the loop is the caller's");
    CHECK(dpt_host_tick(host, NULL, 0, &wrench) == DPT_E_ARGUMENT &&
              dpt_host_tick(host, &state, 0, NULL) == DPT_E_ARGUMENT,
          "NULL");
    dpt_host_close(host, NULL);
}

static void *stop(void *host)
{
    dpt_host_stop(host);
    return NULL;
}

static void another_thread_stops_it(void)
{
    dpt_host_def def = usual();
    pthread_t thread;
    dpt_host *host = open_host(&def);
    CHECK(pthread_create(&thread, NULL, stop, host) == 0, "no thread");
    CHECK(dpt_host_run(host, NULL, NULL) == DPT_OK, "it ended");
    pthread_join(thread, NULL);
    dpt_host_close(host, NULL);
}

/* What only counts of the sizes of structs are asked for (lib/size_checks.h). */

static dpt_result def_of(void *given)
{
    dpt_host_def *def = given;
    dpt_host *host;
    def->scene = "membrane";
    def->device = "sim";
    const dpt_result result = dpt_host_open(given, &host, NULL);
    dpt_host_close(host, NULL);
    return result;
}

static dpt_result error_of(void *given)
{
    const dpt_host_def def = usual();
    dpt_host *host;
    const dpt_result result = dpt_host_open(&def, &host, given);
    dpt_host_close(host, NULL);
    return result;
}

static dpt_host *counted;

static dpt_result counts_of(void *given)
{
    return dpt_host_get_info(counted, given);
}

static dpt_result info_taken(void *given)
{
    dpt_host_def def = usual();
    dpt_host *host;
    def.device = NULL;
    def.info = given;
    const dpt_result result = dpt_host_open(&def, &host, NULL);
    dpt_host_close(host, NULL);
    return result;
}

static dpt_result state_taken(void *given)
{
    dpt_wrench wrench;
    return dpt_host_tick(counted, given, 0, &wrench);
}

static void fill_def(void *def, size_t size)
{
    dpt_host_def_defaults(def, size);
}

static void structs_of_any_size(void)
{
    dpt_host_def def;
    const dpt_device_info device = info_of_device("sim");
    const dpt_device_state state = { .size = sizeof state };
    const struct sized of_def = { "dpt_host_def", offsetof(dpt_host_def, tips), sizeof(dpt_host_def), def_of };
    const struct sized of_error = { "dpt_host_error", sizeof(dpt_host_error), sizeof(dpt_host_error), error_of };
    const struct sized of_info = { "dpt_host_info", sizeof(dpt_host_info), sizeof(dpt_host_info), counts_of };
    const struct sized of_device = { "dpt_device_info of a host", sizeof device, sizeof device, info_taken };
    const struct sized of_state = { "dpt_device_state of a tick", sizeof state, sizeof state, state_taken };
    dpt_host_def_init(&def);
    check_input(&of_def, &def);
    check_defaults(&of_def, fill_def, &def);
    check_output(&of_error);
    check_input(&of_device, &device);
    def = usual();
    def.device = NULL;
    def.info = &device;
    counted = open_host(&def);
    check_output(&of_info);
    check_input(&of_state, &state);
    dpt_host_close(counted, NULL);
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(both_loops_feel_the_same);
    TEST(silence_and_loss_end_the_force);
    TEST(samples_may_be_anything);
    TEST(what_cannot_be_says_why);
    TEST(notes_are_said);
    TEST(every_scene_opens);
    TEST(a_fault_is_told);
    TEST(nothing_may_be_null);
    TEST(another_thread_stops_it);
    TEST(structs_of_any_size);
    return check_report();
}
