/* SPDX-License-Identifier: BSD-3-Clause */
/* What arms, guards, and loops with a device of its own time answer. A part of answers.c, which alone includes it. */
#ifndef DPT_BENCH_ANSWERS_DEVICE_H
#define DPT_BENCH_ANSWERS_DEVICE_H

#include "bench/answers_subjects.h"

struct arm_arrays {
    dpt_arm_def def;
    dpt_arm_joint joints[DPT_JOINTS_MAX];
    dpt_arm_link links[12];
    dpt_segment segments[2];
    dpt_arm_body body;
};

/* A chain, of which links may mimic a joint before, and some links beside it. */
static void draw_arm(struct arm_arrays *arm)
{
    dpt_arm_def *def = &arm->def;
    memset(arm, 0, sizeof *arm);
    *def = (dpt_arm_def){ .size = sizeof *def,
                          .joints = arm->joints,
                          .links = arm->links,
                          .segments = arm->segments,
                          .bodies = &arm->body,
                          .segment_count = below(3),
                          .body_count = below(2),
                          .name = "drawn",
                          .root_name = "base",
                          .tool_name = "tool" };
    const uint32_t most = 1 + below(DPT_JOINTS_MAX);
    def->link_count = most + below(4);
    for (uint32_t i = 0; i < def->link_count; i++) {
        dpt_arm_link *link = &arm->links[i];
        *link = (dpt_arm_link){ .size = sizeof *link,
                                .parent = i - 1, /* -1: DPT_NONE */
                                .slides = (uint32_t)once_in(4),
                                .pose = draw_pose(0.4),
                                .factor = 1.0,
                                .mass = once_in(4) ? 0.0 : in(0.0, 2.0) };
        draw_unit(link->axis, 3);
        for (int k = 0; k < 3; k++)
            link->centre[k] = in(-0.1, 0.1);
        if (def->joint_count == 0 || (def->joint_count < most && !once_in(4))) {
            dpt_arm_joint *joint = &arm->joints[def->joint_count];
            link->joint = def->joint_count++;
            *joint = (dpt_arm_joint){ .size = sizeof *joint,
                                      .kind = link->slides ? DPT_JOINT_PRISMATIC : DPT_JOINT_REVOLUTE,
                                      .lower = in(-2.0, 0.0),
                                      .upper = in(0.0, 2.0),
                                      .velocity = in(0.0, 5.0),
                                      .effort = in(0.0, 5.0) };
            snprintf(joint->name, sizeof joint->name, "joint_%u", link->joint);
        } else {
            link->joint = below(def->joint_count);
            link->factor = in(0.2, 2.0) * (once_in(2) ? -1.0 : 1.0);
            link->offset = in(-1.0, 1.0);
        }
    }
    def->tool_link = def->link_count - 1;
    def->tool = draw_pose(0.2);
    for (int i = 0; i < 2; i++)
        arm->segments[i] = (dpt_segment){ { 0, 0, 0.1 * i }, { 0.01, 0, 0.2 }, in(0.0, 0.01) };
    arm->body = (dpt_arm_body){ .size = sizeof arm->body, .pose = draw_pose(0.5), .mesh = subjects[below(3)].mesh };
}

static void arm_kinematics(const dpt_arm *arm, uint32_t joint_count)
{
    double joints[DPT_JOINTS_MAX], rates[DPT_JOINTS_MAX], efforts[DPT_JOINTS_MAX] = { 0 };
    double velocity[3] = { 0 }, spin[3] = { 0 }, jacobian[6 * DPT_JOINTS_MAX] = { 0 };
    const double gravity[3] = { in(-1, 1), in(-1, 1), -9.81 };
    const dpt_wrench wrench = { { in(-5, 5), in(-5, 5), in(-5, 5) }, { in(-1, 1), 0.0, 0.5 } };
    dpt_pose tool = DPT_POSE_IDENTITY;
    for (int i = 0; i < DPT_JOINTS_MAX; i++) {
        joints[i] = in(-7.0, 7.0);
        rates[i] = in(-3.0, 3.0);
    }
    if (once_in(40))
        joints[0] = NAN;
    const int32_t results[5] = {
        (int32_t)dpt_arm_forward(arm, joints, &tool),
        (int32_t)dpt_arm_velocity(arm, joints, rates, velocity, spin),
        (int32_t)dpt_arm_jacobian(arm, joints, jacobian),
        (int32_t)dpt_arm_efforts(arm, joints, &wrench, efforts),
        0,
    };
    begin("kinematics");
    for (int i = 0; i < 4; i++)
        put_code("result", results[i]);
    put_numbers("position", tool.position, 3);
    put_numbers("orientation", tool.orientation, 4);
    put_numbers("velocity", velocity, 3);
    put_numbers("spin", spin, 3);
    put_numbers("jacobian", jacobian, 6 * (size_t)joint_count);
    put_numbers("effort", efforts, DPT_JOINTS_MAX);
    put_code("weight_result", (int32_t)dpt_arm_weight(arm, joints, gravity, efforts));
    put_numbers("weight", efforts, DPT_JOINTS_MAX);
    end();
}

static void arms_run(int count)
{
    for (int number = 0; number < count; number++) {
        struct arm_arrays arrays;
        dpt_compiled file = { NULL, 0 };
        dpt_diag diag = { .size = sizeof diag };
        dpt_arm_info info = { .size = sizeof info };
        const dpt_arm *arm = NULL;
        random_state = 0xa2a00000u + (uint32_t)number;
        snprintf(place, sizeof place, "arm %d", number);
        draw_arm(&arrays);
        if (once_in(20))
            arrays.links[below(arrays.def.link_count)].axis[1] = 3.0;
        dpt_result result = dpt_compile_arm(&arrays.def, &file, &diag);
        begin("compile");
        put_code("result", (int32_t)result);
        put_count("size", file.size);
        put_hash("bytes", hash_bytes(1, file.bytes, file.size));
        put_word("text", result == DPT_OK ? "" : diag.text);
        end();
        if (result == DPT_OK)
            put_result("open", dpt_arm_open(file.bytes, file.size, &arm));
        if (arm) {
            put_result("info", dpt_arm_get_info(arm, &info));
            for (int i = 0; i < 50; i++)
                arm_kinematics(arm, info.joints);
            for (int i = 0; i < 20; i++) { /* one byte is wrong, then right again */
                dpt_mesh_fault fault = { .size = sizeof fault };
                unsigned char *byte = (unsigned char *)file.bytes + bits() % file.size;
                *byte ^= 0x20;
                put_fault("verify", dpt_arm_verify(file.bytes, file.size, &fault), &fault);
                *byte ^= 0x20;
            }
        }
        dpt_compiled_free(&file);
    }
}

static void guards_run(int count)
{
    for (int number = 0; number < count; number++) {
        dpt_guard_def def;
        dpt_guard guard = { .size = sizeof guard };
        uint64_t now = 0;
        dpt_guard_def_init(&def);
        random_state = 0x6a2d0000u + (uint32_t)number;
        snprintf(place, sizeof place, "guard %d", number);
        if (number % 2) {
            def.force_max = in(0.0, 10.0);
            def.force_slew = once_in(3) ? 0.0 : in(0.0, 5000.0);
            def.torque_slew = once_in(3) ? 0.0 : in(0.0, 100.0);
            def.hold = in(0.0, 0.01);
            def.stop = once_in(3) ? 0.0 : in(0.0, 0.01);
            def.start = once_in(3) ? 0.0 : in(0.0, 0.2);
        }
        put_result("init", dpt_guard_init(&guard, number % 2 ? &def : NULL));
        for (int tick = 0; tick < 400; tick++) {
            dpt_wrench command, out = { { 0 }, { 0 } };
            const double size = once_in(5) ? 20.0 : 4.0;
            for (int i = 0; i < 3; i++) {
                command.force[i] = in(-size, size);
                command.torque[i] = 0.05 * in(-size, size);
            }
            if (once_in(100))
                command.force[0] = NAN;
            now += once_in(50) ? 20000000 : 900000 + below(200000);
            const int silent = tick / 7 % 9 == 0 || once_in(10);
            dpt_guard_step(&guard, now, silent ? NULL : &command, !once_in(80), &out);
            put_wrench("guarded", DPT_OK, &out);
            put_guard(&guard);
        }
    }
}

struct feeling {
    dpt_world *world;
    dpt_tool tool;
    double scale, offset[3];
};

static dpt_result feel_at(struct feeling *feeling, const dpt_device_state *state, double dt, dpt_wrench *wrench)
{
    dpt_pose pose = state->pose;
    for (int i = 0; i < 3; i++)
        pose.position[i] = feeling->offset[i] + feeling->scale * pose.position[i];
    begin("sample");
    put_count("status", state->status);
    put_count("reasons", state->reasons);
    put_count("sequence", state->sequence);
    put_count("time_ns", state->time_ns);
    put_number("dt", dt);
    put_numbers("position", state->pose.position, 3);
    put_numbers("orientation", state->pose.orientation, 4);
    put_numbers("velocity", state->velocity, 3);
    put_numbers("spin", state->spin, 3);
    end();
    dpt_tool_set_pose(feeling->world, feeling->tool, &pose);
    dpt_result result = dpt_world_step(feeling->world, dt, NULL);
    dpt_tool_get_wrench(feeling->world, feeling->tool, wrench);
    put_wrench("feels", result, wrench);
    return result;
}

#ifdef BEFORE_SAMPLES
static dpt_result feel(void *user, const dpt_device_state *state, double dt, dpt_wrench *wrench)
{
    return feel_at(user, state, dt, wrench);
}
#else
static dpt_result feel(void *user, const dpt_loop_sample *sample, dpt_wrench *wrench)
{
    return feel_at(user, sample->state, sample->dt, wrench);
}
#endif

static void loop_run(uint32_t number, const char *name, const struct subject *subject)
{
    dpt_device *device;
    dpt_device_error error = { .size = sizeof error };
    dpt_device_info info = { .size = sizeof info };
    dpt_device_counts counts = { .size = sizeof counts };
    dpt_loop_def def;
    dpt_loop *loop;
    dpt_loop_stats stats = { .size = sizeof stats };
    dpt_world_def world_def;
    struct feeling feeling = { .scale = 1.0 };
    dpt_body body;
    snprintf(place, sizeof place, "loop %u", number);
    dpt_result result = dpt_device_open(name, &device, &error);
    put_result("open", result);
    if (result != DPT_OK)
        return;
    dpt_world_def_init(&world_def);
    world_def.max_contacts = 32;
    world_def.law = DPT_LAW_POINT;
    void *block = malloc(dpt_world_bytes(&world_def));
    const dpt_segment stylus = { { 0, 0, 0 }, { 0, 0, 0.1 }, 0.002 };
    dpt_world_create(block, dpt_world_bytes(&world_def), &world_def, &feeling.world);
    dpt_body_add(feeling.world, subject->mesh, NULL, &body);
    dpt_tool_add(feeling.world, &stylus, 1, &feeling.tool);
    dpt_device_get_info(device, &info);
    result = dpt_device_map(&info, subject->info.box_min, subject->info.box_max, &feeling.scale, feeling.offset);
    begin("map");
    put_code("result", (int32_t)result);
    put_number("scale", feeling.scale);
    put_numbers("offset", feeling.offset, 3);
    end();
    dpt_loop_def_init(&def);
    def.priority = def.lock = 0;
    def.ticks = 1500;
    def.tick = feel;
    def.user = &feeling;
    put_result("loop_create", dpt_loop_open(device, &def, &loop));
    result = dpt_loop_run(loop, &stats);
    begin("stats");
    put_code("result", (int32_t)result);
    put_count("ticks", stats.ticks);
    put_count("fresh", stats.fresh);
    put_count("failed", stats.failed);
    put_count("stale", stats.stale);
    put_count("not_ready", stats.not_ready);
    put_count("lost", stats.lost);
    put_count("sent", stats.sent);
    put_count("refused", stats.refused);
    put_count("stops", stats.stops);
    put_count("clamped", stats.clamped);
    put_count("slewed", stats.slewed);
    dpt_device_get_counts(device, &counts);
    put_count("samples", counts.samples);
    put_count("commands", counts.commands);
    put_count("missed", counts.missed);
    end();
    dpt_loop_close(loop);
    dpt_device_close(device);
    free(block);
}

static void loops_run(void)
{
    static const char *const names[] = { "sim:?hand=press", "sim:?hand=wipe&dofs=6&delay=2",
                                         "sim:?hand=press&reach=0.05&cycle=1&step=1e-5",
                                         "sim:?hand=hold&fault=estop@0.5", "sim:?hand=nobody" };
    for (uint32_t i = 0; i < sizeof names / sizeof names[0]; i++)
        for (uint32_t k = 0; k < 4; k++)
            loop_run(4 * i + k, names[i], &subjects[(4 * i + k) % subject_count]);
}

#endif
