/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What the codec and a tick of the library take on a Cortex-M7: instructions, bytes of RAM and of stack. Prints lines
 * "NAME NUMBER", which run.sh makes a table of. The mesh is an array in flash, used where it lies. Run on the host as
 * well (board_host.c), it must print the same sums of bits.
 */
#include <stdalign.h>
#include <string.h>

#include "dynpoint.h"
#include "firmware/board.h"
#include "serial/wire_device.h"

extern const unsigned char flash_mesh[];
extern const size_t flash_mesh_size;
extern const unsigned char flash_arm[];
extern const size_t flash_arm_size;

enum { FRAMES = 100, TICKS = 2000, WORLD = 256 * 1024 };

static alignas(8) uint8_t block[WORLD];
static uint32_t times[TICKS];

static void say(const char *name, uint32_t number)
{
    board_print(name);
    board_print(" ");
    board_print_number(number);
    board_print("\n");
}

/* FNV-1a, over the bits of all frames, or wrenches and distances. */
static uint32_t bits;

static void mix(const void *bytes, size_t size)
{
    for (size_t i = 0; i < size; i++)
        bits = (bits ^ ((const uint8_t *)bytes)[i]) * 16777619u;
}

static void must(int condition, const char *what)
{
    if (!condition) {
        board_print(what);
        board_print(": failed\n");
        board_exit(1);
    }
}

static void measure_state(unsigned pose_dofs, const char *encode, const char *decode)
{
    struct wire_message message = { .type = WIRE_STATE, .session = 1 }, got;
    struct wire_reader reader = { 0 };
    uint8_t frame[WIRE_FRAME_MAX];
    size_t size = 0;
    message.as.state.pose_dofs = (uint8_t)pose_dofs;
    message.as.state.status = WIRE_STATUS_READY;
    message.as.state.orientation[0] = 1;
    for (int i = 0; i < 3; i++)
        message.as.state.position[i] = message.as.state.velocity[i] = 0.01f * (float)(i + 1);
    count_start();
    for (int i = 0; i < FRAMES; i++)
        size = wire_encode(&message, frame);
    say(encode, count_instructions() / FRAMES);
    for (int i = 0; i < FRAMES; i++)
        for (size_t k = 0; k < size; k++)
            wire_read(&reader, frame[k], &got);
    say(decode, count_instructions() / FRAMES);
    must(reader.messages == FRAMES, "decode");
}

/* All that the protocol costs a device in a sample: a command comes, a state goes. */
static void measure_sample(void)
{
    const struct wire_info info = {
        .pose_dofs = 6, .wrench_dofs = 6, .rate = 1000, .force_max = 5, .torque_max = 1, .watchdog = 0.02f
    };
    static struct wire_device device;
    struct wire_sample sample = { .orientation = { 1, 0, 0, 0 } };
    struct wire_message message = { .type = WIRE_HELLO, .session = 1 };
    uint8_t frame[WIRE_FRAME_MAX], out[WIRE_OUT_MAX];
    wire_device_init(&device, &info);
    size_t size = wire_encode(&message, frame);
    for (size_t k = 0; k < size; k++)
        wire_device_take(&device, frame[k]);
    message.type = WIRE_ORDER;
    message.as.order = WIRE_ENABLE;
    size = wire_encode(&message, frame);
    for (size_t k = 0; k < size; k++)
        wire_device_take(&device, frame[k]);
    wire_device_sample(&device, &sample, out);
    uint32_t sum = 0;
    for (uint32_t i = 0; i < FRAMES; i++) {
        message.type = WIRE_COMMAND;
        message.as.command.sequence = i + 1;
        message.as.command.answers = device.sequence;
        for (int k = 0; k < 3; k++)
            message.as.command.force[k] = message.as.command.torque[k] = 0.1f * (float)k;
        size = wire_encode(&message, frame);
        count_start();
        for (size_t k = 0; k < size; k++)
            wire_device_take(&device, frame[k]);
        const size_t said = wire_device_sample(&device, &sample, out);
        sum += count_instructions();
        mix(out, said);
    }
    must(device.commands.accepted == FRAMES && wire_device_status(&device) == WIRE_STATUS_READY, "sample");
    say("sample", sum / FRAMES);
    say("device_bytes", sizeof device);
}

/* The pose, how it moves, and the motors' efforts. Not opened yet: the reader's stack would hide the tick's. */
static __attribute__((noinline)) void measure_arm(void)
{
    const dpt_arm *arm = (const void *)flash_arm;
    const double rates[3] = { 0.1, -0.2, 0.3 };
    uint32_t sum = 0;
    for (int i = 0; i < FRAMES; i++) {
        const double joints[3] = { 0.02 * i - 1, 0.01 * i, 0.5 - 0.01 * i };
        const dpt_wrench wrench = { { 1, 0.02 * i, -2 }, { 0, 0, 0 } };
        double velocity[3], spin[3], efforts[3];
        dpt_pose tool;
        count_start();
        dpt_arm_forward(arm, joints, &tool);
        dpt_arm_velocity(arm, joints, rates, velocity, spin);
        dpt_arm_efforts(arm, joints, &wrench, efforts);
        sum += count_instructions();
        mix(&tool, sizeof tool);
        mix(velocity, sizeof velocity);
        mix(efforts, sizeof efforts);
    }
    say("arm_tick", sum / FRAMES);
    say("stack_arm", stack_used());
}

static __attribute__((noinline)) void open_arm(void)
{
    const dpt_arm *arm;
    count_start();
    must(dpt_arm_open(flash_arm, flash_arm_size, &arm) == DPT_OK, "dpt_arm_open");
    say("arm_open", count_instructions());
    say("stack_arm_open", stack_used());
    say("arm_bytes", (uint32_t)flash_arm_size);
}

static uint32_t ranked(uint32_t rank)
{
    for (uint32_t i = 1; i < TICKS; i++)
        for (uint32_t k = i; k > 0 && times[k] < times[k - 1]; k--) {
            const uint32_t swap = times[k];
            times[k] = times[k - 1];
            times[k - 1] = swap;
        }
    return times[rank];
}

/* One body of the mesh, one tool of one segment. */
struct scene {
    dpt_mesh_info info;
    dpt_world_def def;
    dpt_world *world;
    dpt_body body;
    dpt_tool tool;
    double center[3], span[3]; /* of the mesh */
};

static void scene_open(struct scene *scene, uint32_t until, uint32_t contacts, uint32_t law)
{
    const dpt_mesh *mesh;
    dpt_mesh_info *info = &scene->info;
    dpt_world_def *def = &scene->def;
    must(dpt_mesh_open(flash_mesh, flash_mesh_size, &mesh) == DPT_OK, "dpt_mesh_open");
    info->size = sizeof *info;
    dpt_mesh_get_info(mesh, info);
    must(info->triangles == 512, "triangles");
    dpt_world_def_init(def);
    def->max_bodies = def->max_tools = def->max_segments = 1;
    def->max_contacts = contacts;
    def->certificate_bytes = 16 * 1024;
    def->until = until;
    def->law = law;
    must(dpt_world_bytes(def) <= sizeof block, "dpt_world_bytes");
    must(dpt_world_create(block, sizeof block, def, &scene->world) == DPT_OK, "dpt_world_create");
    must(dpt_body_add(scene->world, mesh, NULL, &scene->body) == DPT_OK, "dpt_body_add");
    for (int i = 0; i < 3; i++) {
        scene->center[i] = 0.5 * (info->box_min[i] + info->box_max[i]);
        scene->span[i] = info->box_max[i] - info->box_min[i];
    }
}

static void say_ticks(const struct scene *scene, const char *const names[4])
{
    say(names[0], ranked(TICKS / 2));
    say(names[1], ranked(TICKS * 99 / 100));
    say(names[2], ranked(TICKS - 1));
    say(names[3], (uint32_t)dpt_world_bytes(&scene->def));
}

/* A tool of 0.86 of the mesh's diagonal that slides over it and dips into it. */
static void measure_tick(uint32_t until, uint32_t contacts, const char *const names[4])
{
    static struct scene scene;
    scene_open(&scene, until, contacts, DPT_LAW_POINT);
    const double *center = scene.center, *span = scene.span;
    const dpt_segment axis = { { 0, 0, 0 }, { 0.6 * span[0], 0.6 * span[1], 0.1 * span[0] }, 0.002 };
    must(dpt_tool_add(scene.world, &axis, 1, &scene.tool) == DPT_OK, "dpt_tool_add");
    uint32_t exact = 0;
    for (int tick = 0; tick < TICKS; tick++) {
        dpt_step step = { .size = sizeof step };
        dpt_wrench wrench;
        const double along = (double)tick / TICKS;
        const int phase = tick % 400;
        const double dip = 0.00015 * (phase < 200 ? phase : 400 - phase);
        const dpt_pose pose = { { center[0] - (0.6 - 0.5 * along) * span[0], center[1] - (0.1 + 0.5 * along) * span[1],
                                  scene.info.box_max[2] + 0.01 - dip },
                                { 1, 0, 0, 0 } };
        count_start();
        dpt_tool_set_pose(scene.world, scene.tool, &pose);
        dpt_world_step(scene.world, 0.001, &step);
        dpt_tool_get_wrench(scene.world, scene.tool, &wrench);
        times[tick] = count_instructions();
        exact += step.status == DPT_STATUS_EXACT;
        mix(&step.distance, sizeof step.distance);
        mix(&wrench, sizeof wrench);
    }
    must(exact == TICKS, "exact");
    say_ticks(&scene, names);
}

/*
 * A tool with a proxy on a body with friction. It is pressed in by 5 mm and led on, with a tremor and stops: it sticks
 * and slips. `tilt` is the third coordinate of the way from its tip to its end, `across` the other two.
 */
static void measure_proxy(double across, double tilt, const char *const names[4])
{
    static struct scene scene;
    scene_open(&scene, DPT_UNTIL_RESPOND, 0, DPT_LAW_PROXY);
    const dpt_segment axis = { { 0, 0, 0 }, { across, across, tilt }, 0.002 };
    dpt_body_settings settings = { .size = sizeof settings };
    must(dpt_tool_add(scene.world, &axis, 1, &scene.tool) == DPT_OK, "dpt_tool_add");
    must(dpt_body_get_settings(scene.world, scene.body, &settings) == DPT_OK, "settings");
    settings.static_friction = 0.5;
    settings.kinetic_friction = 0.4;
    must(dpt_body_set_settings(scene.world, scene.body, &settings) == DPT_OK, "settings");
    uint32_t acts = 0, sticks = 0, slips = 0;
    dpt_pose before = DPT_POSE_IDENTITY;
    double along = 0;
    for (int tick = 0; tick < TICKS; tick++) {
        dpt_step step = { .size = sizeof step };
        dpt_force_info report = { .size = sizeof report };
        dpt_pose proxy;
        const double depth = tick < 100 ? 5e-5 * tick : 0.005, height = 0.00205 - depth;
        const double tremor = 1e-5 * ((tick * 7) % 11 - 5);
        along += tick % 400 < 250 ? 5e-5 : 0;
        const dpt_pose pose = { { scene.info.box_min[0] + 0.02 + along + tremor, scene.center[1] + 0.5 * tremor,
                                  scene.info.box_max[2] + height },
                                { 1, 0, 0, 0 } };
        count_start();
        dpt_tool_set_pose(scene.world, scene.tool, &pose);
        dpt_world_step(scene.world, 0.001, &step);
        dpt_tool_get_force_info(scene.world, scene.tool, &report);
        times[tick] = count_instructions();
        dpt_tool_get_proxy(scene.world, scene.tool, &proxy);
        const double slid = proxy.position[0] - before.position[0];
        acts += report.reason == DPT_FORCE_ACTS;
        /* A tip that sticks rolls a little, where the tool turns about it. */
        sticks += tick > 100 && slid < 1e-5 && slid > -1e-5;
        slips += tick > 100 && slid > 2e-5;
        before = proxy;
        mix(&proxy, sizeof proxy);
        mix(&report.wrench, sizeof report.wrench);
    }
    must(acts > TICKS - 100, "pressed in");
    must(sticks > 100 && slips > 100, "stick and slip");
    say_ticks(&scene, names);
}

int main(void)
{
    measure_arm();
    measure_state(3, "encode_3", "decode_3");
    measure_state(6, "encode_6", "decode_6");
    measure_sample();
    say("stack_wire", stack_used());
    open_arm();
    say("mesh_bytes", (uint32_t)flash_mesh_size);
    static const char *const names[3][4] = {
        { "track_median", "track_p99", "track_most", "track_bytes" },
        { "depth_median", "depth_p99", "depth_most", "depth_bytes" },
        { "tick_median", "tick_p99", "tick_most", "tick_bytes" },
    };
    measure_tick(DPT_UNTIL_TRACK, 0, names[0]);
    measure_tick(DPT_UNTIL_RESPOND, 0, names[1]);
    measure_tick(DPT_UNTIL_RESPOND, 4, names[2]);
    static const char *const of_proxy[2][4] = {
        { "needle_median", "needle_p99", "needle_most", "needle_bytes" },
        { "lying_median", "lying_p99", "lying_most", "lying_bytes" },
    };
    measure_proxy(0.02, 0.06, of_proxy[0]);
    measure_proxy(0.05, 0.0, of_proxy[1]);
    say("stack", stack_used());
    say("bits", bits);
    board_print("end\n");
    return 0;
}
