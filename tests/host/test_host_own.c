/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What a host is given by pointer: bodies and segments feel as the same things from files do, bit for bit, or are refused
 * with a reason; tips and jaws; recordings that carry their scene.
 */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "dynpoint/host.h"
#include "lib/check.h"
#include "lib/fixture.h"
#include "lib/size_checks.h"
#include "lib/vector.h"

enum { TICKS = 400, TRIANGLES = 2000 };

static struct fixture liver;
static char folder[] = "/tmp/dynpoint-host-XXXXXX", mesh_path[64], record_path[64];

/* What was asked for, tick by tick. */
struct felt {
    dpt_wrench asked[TICKS];
    uint32_t count, pushed;
};

static void note(void *user, dpt_host *host, const dpt_loop_sample *sample, dpt_result result, const dpt_wrench *wrench)
{
    struct felt *felt = user;
    (void)host;
    (void)sample;
    if (result != DPT_OK || felt->count == TICKS)
        return;
    felt->pushed += length3(wrench->force) > 0.01;
    felt->asked[felt->count++] = *wrench;
}

static dpt_host_def usual(void)
{
    dpt_host_def def;
    dpt_host_def_init(&def);
    def.device = "sim:?hand=press&cycle=0.3";
    def.ticks = TICKS;
    return def;
}

static dpt_host_body own_body(void)
{
    return (dpt_host_body){ .size = sizeof(dpt_host_body), .mesh = liver.mesh };
}

/* The number of ticks that had a force. */
static uint32_t feel(dpt_host_def def, struct felt *felt)
{
    dpt_host *host;
    dpt_host_error error = { .size = sizeof error };
    memset(felt, 0, sizeof *felt);
    def.felt = note;
    def.user = felt;
    CHECK(dpt_host_open(&def, &host, &error) == DPT_OK, "%s", error.text);
    if (!host)
        return 0;
    CHECK(dpt_host_run(host, NULL, &error) == DPT_OK && felt->count == TICKS, "%u ticks: %s", felt->count, error.text);
    CHECK(dpt_host_close(host, &error) == DPT_OK, "%s", error.text);
    return felt->pushed;
}

static uint32_t differ(const struct felt *a, const struct felt *b)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < TICKS; i++)
        count += memcmp(&a->asked[i], &b->asked[i], sizeof a->asked[i]) != 0;
    return count;
}

static void refuses(const dpt_host_def *def, dpt_result code, const char *text)
{
    dpt_host *host = (void *)&host;
    dpt_host_error error = { .size = sizeof error };
    const dpt_result result = dpt_host_open(def, &host, &error);
    CHECK(result == code && !host && strstr(error.text, text) && !strstr(error.text, "--"), "'%s': %s: '%s'", text,
          dpt_result_name(result), error.text);
}

static void bodies_feel_as_their_file_does(void)
{
    static struct felt of_file, own, turned;
    const dpt_segment stylus = { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.1 }, 0.002 };
    const dpt_pose aside = { { 0.2, 0.0, 0.0 }, { 1.0, 0.0, 0.0, 0.0 } };
    dpt_host_body bodies[2] = { own_body(), own_body() };
    dpt_host_def def = usual();
    bodies[1].pose = &aside;
    def.scene = mesh_path;
    CHECK(feel(def, &of_file) > TICKS / 10, "%u ticks push", of_file.pushed);
    def.scene = NULL;
    def.bodies = bodies;
    def.body_count = 1;
    feel(def, &own);
    CHECK(!differ(&of_file, &own), "%u of %d ticks differ", differ(&of_file, &own), TICKS);
    def.body_count = 2;
    feel(def, &own);
    CHECK(!differ(&of_file, &own), "with another body aside %u of %d ticks differ", differ(&of_file, &own), TICKS);
    /* Friction of its own is felt, and that of the def is in place of it. */
    const dpt_body_settings rough = { .size = sizeof rough, .static_friction = 0.8, .kinetic_friction = 0.8 };
    bodies[0].settings = &rough;
    CHECK(feel(def, &own) > TICKS / 10 && differ(&of_file, &own), "no friction is felt");
    def.friction = 0.0;
    feel(def, &own);
    CHECK(!differ(&of_file, &own), "friction 0: %u ticks differ", differ(&of_file, &own));
    /* A segment in a tool's frame. */
    def.segments = &stylus;
    def.segment_count = 1;
    CHECK(feel(def, &turned) > TICKS / 10, "%u ticks push", turned.pushed);
}

static void a_caller_moves_bodies(void)
{
    const dpt_pose away = { { 0.0, -1.0, 0.0 }, { 1.0, 0.0, 0.0, 0.0 } };
    const dpt_host_body body = own_body();
    dpt_host_def def = usual();
    dpt_host *host;
    dpt_pose pose;
    def.bodies = &body;
    def.body_count = 1;
    CHECK(dpt_host_open(&def, &host, NULL) == DPT_OK, "open");
    CHECK(!dpt_host_get_body(host, 1) && !dpt_host_get_body(NULL, 0), "there is one body");
    dpt_world *world = dpt_host_get_world(host);
    CHECK(dpt_body_set_pose(world, dpt_host_get_body(host, 0), &away) == DPT_OK &&
              dpt_body_get_pose(world, dpt_host_get_body(host, 0), &pose) == DPT_OK && pose.position[1] == -1.0,
          "it is moved");
    dpt_host_close(host, NULL);
}

static void own_things_that_cannot_be_say_why(void)
{
    const dpt_segment bad = { { 0.0, 0.0, NAN }, { 0.0, 0.0, 0.1 }, 0.002 };
    const dpt_host_body good = own_body();
    dpt_host_body body = good;
    dpt_host_def def = usual();
    def.bodies = &body;
    refuses(&def, DPT_E_ARGUMENT, "a scene is needed");
    def.scene = "liver";
    def.body_count = 1;
    refuses(&def, DPT_E_ARGUMENT, "not both");
    def.scene = NULL;
    def.body_count = 65;
    refuses(&def, DPT_E_ARGUMENT, "bodies must be 1 to 64");
    def.body_count = 1;
    body.mesh = NULL;
    refuses(&def, DPT_E_ARGUMENT, "bodies[0]: it has no mesh");
    body = good;
    body.flags = 2;
    refuses(&def, DPT_E_ARGUMENT, "bodies[0]: it has flags");
    body = good;
    body.period = -1.0;
    refuses(&def, DPT_E_ARGUMENT, "period");
    body = good;
    body.sleep_speed = NAN;
    refuses(&def, DPT_E_ARGUMENT, "sleep_speed");
    body = good;
    body.integrator = 3;
    refuses(&def, DPT_E_ARGUMENT, "integrator");
    body = good;
    body.response = DPT_RESPONSE_DISPLACE;
    refuses(&def, DPT_E_ARGUMENT, "laws point and bed (law)");
    body = good;
    def.segments = &bad;
    def.segment_count = 1;
    refuses(&def, DPT_E_ARGUMENT, "segments[0]");
    def.segment_count = 65;
    refuses(&def, DPT_E_ARGUMENT, "segments must be 1 to 64");
    def.segments = NULL;
    def.segment_count = 0;
    def.record = record_path;
    refuses(&def, DPT_E_UNSUPPORTED, "record");
    def.record = NULL;
    def.flags = DPT_HOST_FLAG_EMBED;
    refuses(&def, DPT_E_ARGUMENT, "needs record");
    def.flags = 0;
    def.physics = 100.0;
    refuses(&def, DPT_E_ARGUMENT, "physics: none of its bodies gives way");
    def.physics = 0.0;
    def.jaw = "0:1:2";
    refuses(&def, DPT_E_ARGUMENT, "no jaws to move (jaw)");
    def.jaw = "wide";
    refuses(&def, DPT_E_ARGUMENT, "jaw takes SHARE");
}

/* A tip is felt, by its words. */
static void tips_are_felt(void)
{
    static struct felt bare, with;
    const char *tips[TICKS] = { "box:0.01,0.03,0.01" };
    dpt_host_def def = usual();
    def.scene = mesh_path;
    def.origin[0] = def.origin[2] = 0.0;
    def.origin[1] = 0.1;
    feel(def, &bare);
    def.tips = tips;
    CHECK(feel(def, &with) > 0 && differ(&bare, &with), "a tip changes nothing");
    tips[1] = "ball:1";
    refuses(&def, DPT_E_ARGUMENT, "tips takes SHAPE");
    for (int i = 0; i < 17; i++)
        tips[i] = "box:0.01,0.03,0.01";
    refuses(&def, DPT_E_ARGUMENT, "tips must be 16 at most");
}

/* So many bytes of a file are those of another. */
static int holds(const char *path, const void *bytes, size_t size)
{
    static unsigned char all[1 << 22];
    FILE *file = fopen(path, "rb");
    const size_t count = file ? fread(all, 1, sizeof all, file) : 0;
    if (file)
        fclose(file);
    for (size_t at = 0; at + size <= count; at++)
        if (!memcmp(all + at, bytes, size))
            return 1;
    return 0;
}

static void a_recording_carries_its_scene(void)
{
    static struct felt felt;
    dpt_host_def def = usual();
    dpt_host_error error = { .size = sizeof error };
    dpt_host *host;
    def.scene = mesh_path;
    def.record = record_path;
    feel(def, &felt);
    CHECK(!holds(record_path, liver.compiled.bytes, 4096), "it was not asked for");
    def.flags = DPT_HOST_FLAG_EMBED;
    feel(def, &felt);
    CHECK(holds(record_path, liver.compiled.bytes, 4096), "the mesh is not in it");
    def.scene = "liver";
    CHECK(dpt_host_open(&def, &host, &error) == DPT_OK && strstr(error.text, "DPT_HOST_FLAG_EMBED: a scene by name"),
          "'%s'", error.text);
    dpt_host_close(host, NULL);
}

static dpt_result body_of(void *given)
{
    dpt_host_def def = usual();
    dpt_host *host;
    def.bodies = given;
    def.body_count = 1;
    const dpt_result result = dpt_host_open(&def, &host, NULL);
    dpt_host_close(host, NULL);
    return result;
}

static void bodies_of_any_size(void)
{
    const dpt_host_body body = own_body();
    check_input(&(struct sized){ "dpt_host_body", sizeof body, sizeof body, body_of }, &body);
}

static int set_up(void)
{
    if (!fixture_from_shape(&liver, "liver", TRIANGLES) || !mkdtemp(folder))
        return 0;
    snprintf(mesh_path, sizeof mesh_path, "%s/liver.dpa", folder);
    snprintf(record_path, sizeof record_path, "%s/felt.dpr", folder);
    FILE *file = fopen(mesh_path, "wb");
    const int is_written = file && fwrite(liver.compiled.bytes, 1, liver.compiled.size, file) == liver.compiled.size;
    return file && fclose(file) == 0 && is_written;
}

int main(void)
{
    CHECK(set_up(), "%s", folder);
    TEST(bodies_feel_as_their_file_does);
    TEST(a_caller_moves_bodies);
    TEST(own_things_that_cannot_be_say_why);
    TEST(tips_are_felt);
    TEST(a_recording_carries_its_scene);
    TEST(bodies_of_any_size);
    unlink(mesh_path);
    unlink(record_path);
    rmdir(folder);
    fixture_free(&liver);
    return check_report();
}
