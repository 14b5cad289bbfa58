/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A tool that enters by a port: its axis leads through it; what the hand feels is the gradient, by differences, of the
 * energy of springs that hold places of the tool; by the law of the lever; a tip at the port or beyond turns nothing
 * over; no direction of the port is odd. And recordings tell which port a listed scene had.
 */
#include "scene/scene_port.h"

#include "lib/check.h"
#include "lib/random.h"
#include "scene/scene.h"
#include "scene/scene_list.h"

enum { PLACES = 4, TRIALS = 200 };
#define LENGTH 0.1

static const double origin[3] = { 0.01, 0.05, 0.0 }, place[3] = { 0.01, 0.11, 0.06 };

/* Of the tool's frame, a spring to each from a place of the scene. */
struct springs {
    double on_tool[PLACES][3], in_scene[PLACES][3];
};

static double energy(const struct springs *springs, const struct scene_port *port, const double tip[3],
                     dpt_wrench *told)
{
    double orientation[4], sum = 0.0;
    scene_port_aim(port, tip, orientation);
    for (int i = 0; i < PLACES; i++) {
        double at[3];
        quaternion_rotate(orientation, springs->on_tool[i], at);
        const vec3 arm = vec3_of(at), stretch = sub(vec3_of(springs->in_scene[i]), add(vec3_of(tip), arm));
        sum += 0.5 * dot(stretch, stretch);
        if (told) {
            vec3_store(add(vec3_of(told->force), stretch), told->force);
            vec3_store(add(vec3_of(told->torque), cross(arm, stretch)), told->torque);
        }
    }
    return sum;
}

static void is_the_gradient(void)
{
    const double step = 1e-6;
    uint64_t seed = 7;
    int near = 0;
    for (int trial = 0; trial < TRIALS; trial++) {
        struct scene_port port;
        struct springs springs;
        dpt_wrench wrench = { .force = { 0.0 } };
        double tip[3], worst = 0.0;
        scene_port_set(&port, place, origin, LENGTH);
        for (int k = 0; k < 3; k++)
            tip[k] = origin[k] + 0.05 * (random_in(&seed, 0.0, 1.0) - 0.3);
        for (int i = 0; i < PLACES; i++)
            for (int k = 0; k < 3; k++) {
                springs.on_tool[i][k] = 0.1 * (random_in(&seed, 0.0, 1.0) - 0.5);
                springs.in_scene[i][k] = 0.3 * (random_in(&seed, 0.0, 1.0) - 0.5);
            }
        near += dot(sub(port.place, vec3_of(tip)), port.outward) < port.nearest;
        energy(&springs, &port, tip, &wrench);
        scene_port_carry(&port, tip, &wrench);
        for (int k = 0; k < 3; k++) {
            double less[3] = { tip[0], tip[1], tip[2] }, more[3] = { tip[0], tip[1], tip[2] };
            less[k] -= step;
            more[k] += step;
            const double slope =
                (energy(&springs, &port, less, NULL) - energy(&springs, &port, more, NULL)) / (2.0 * step);
            worst = max_of(worst, fabs(slope - wrench.force[k]));
            CHECK(wrench.torque[k] == 0.0, "a torque of %g is left", wrench.torque[k]);
        }
        CHECK(worst < 1e-8, "trial %d: %g N from the gradient", trial, worst);
    }
    CHECK(near > TRIALS / 10 && near < 9 * TRIALS / 10, "%d of %d near the port's plane", near, TRIALS);
}

static void leads_through_the_port(void)
{
    struct scene_port port;
    uint64_t seed = 3;
    scene_port_set(&port, place, origin, LENGTH);
    for (int trial = 0; trial < TRIALS; trial++) {
        double tip[3], orientation[4], axis[3];
        for (int k = 0; k < 3; k++)
            tip[k] = origin[k] + 0.02 * (random_in(&seed, 0.0, 1.0) - 0.5);
        scene_port_aim(&port, tip, orientation);
        quaternion_rotate(orientation, (const double[]){ 0.0, 0.0, 1.0 }, axis);
        const vec3 way = sub(vec3_of(place), vec3_of(tip));
        CHECK(length(cross(vec3_of(axis), way)) < 1e-15 && dot(vec3_of(axis), way) > 0.0, "trial %d: beside the port",
              trial);
    }
}

/* A force across, at s from the tip, has the share 1 - s / L; one along the tool the whole. */
static void is_a_lever(void)
{
    struct scene_port port;
    scene_port_set(&port, (const double[]){ 0.0, 0.0, 0.2 }, (const double[]){ 0.0, 0.0, 0.0 }, LENGTH);
    for (double s = 0.0; s <= 0.4; s += 0.05) {
        const double tip[3] = { 0.0, 0.0, 0.0 };
        dpt_wrench wrench = { .force = { 3.0, 0.0, 2.0 }, .torque = { 0.0, 3.0 * s, 0.0 } };
        scene_port_carry(&port, tip, &wrench);
        CHECK(fabs(wrench.force[0] - 3.0 * (1.0 - s / 0.2)) < 1e-14 && fabs(wrench.force[2] - 2.0) < 1e-15,
              "%g m from the tip: %g, %g N", s, wrench.force[0], wrench.force[2]);
    }
}

/* Whichever way the port lies: a small way turns the tool little, and a torque about its axis is a small force. */
static void has_no_odd_direction(void)
{
    static const double ways[][3] = { { 0.0, 0.0, -0.1 }, { 0.0, 0.0, 0.1 }, { 0.1, 0.0, 0.0 }, { 0.0, -0.06, -0.08 } };
    const double torque = 0.01, step = 1e-4;
    uint64_t seed = 5;
    for (size_t i = 0; i < sizeof ways / sizeof *ways; i++) {
        struct scene_port port;
        double last[4] = { 0.0 };
        scene_port_set(&port, ways[i], (const double[]){ 0.0, 0.0, 0.0 }, LENGTH);
        for (int trial = 0; trial < TRIALS; trial++) {
            double tip[3], now[4], axis[3], alike = 0.0;
            dpt_wrench wrench = { .force = { 0.0 } };
            for (int k = 0; k < 3; k++)
                tip[k] = step * (random_in(&seed, 0.0, 1.0) - 0.5);
            scene_port_aim(&port, tip, now);
            quaternion_rotate(now, (const double[]){ 0.0, 0.0, 1.0 }, axis);
            vec3_store(scaled(vec3_of(axis), torque), wrench.torque);
            scene_port_carry(&port, tip, &wrench);
            const double force = length(vec3_of(wrench.force));
            CHECK(force < torque / LENGTH * step / LENGTH, "way %zu: %g N from %g Nm about the axis", i, force, torque);
            for (int k = 0; k < 4; k++)
                alike += now[k] * last[k];
            CHECK(trial == 0 || fabs(alike) > 1.0 - step, "way %zu, trial %d: it turns by %g", i, trial,
                  2.0 * acos(fabs(alike)));
            memcpy(last, now, sizeof last);
        }
    }
}

/* What a recording or a plan was of. A listed scene's meshes do not tell its port. */
static void is_part_of_what_a_scene_is(void)
{
    const struct listed_scene *with = scene_listed("laparoscopy"), *without = scene_listed("tori");
    const struct listed_scene *const scenes[] = { with, without };
    for (int i = 0; i < 2; i++) {
        struct scene_bodies bodies;
        struct file_identity of_meshes = { .bytes = 0 };
        struct scene scene;
        dpt_host_error error = { .size = sizeof error };
        struct scene_def def = { .command = "run",
                                 .path = scenes[i]->name,
                                 .length = LENGTH,
                                 .radius = 0.002,
                                 .zoom = 1.0,
                                 .force_scale = 1.0,
                                 .clutch = -1,
                                 .force = { .law = DPT_LAW_PROXY, .stiffness = 500.0, .friction = NAN } };
        const dpt_result made = scene_bodies_of_list(&bodies, scenes[i], &of_meshes, &error);
        const dpt_result opened = made == DPT_OK ? scene_open(&scene, &def, &error) : made;
        CHECK(opened == DPT_OK, "%s: %s", scenes[i]->name, error.text);
        if (opened == DPT_OK) {
            CHECK(scene.port.is_given == scenes[i]->has_port && scenes[i]->has_port == !i, "%s: the port",
                  scenes[i]->name);
            CHECK((scene.file.crc32 != of_meshes.crc32 && scene.file.bytes > of_meshes.bytes) == scenes[i]->has_port,
                  "%s: %llu bytes, of meshes %llu", scenes[i]->name, (unsigned long long)scene.file.bytes,
                  (unsigned long long)of_meshes.bytes);
            scene_close(&scene);
        }
        scene_bodies_close(&bodies);
    }
}

/* From deep inside to far outside, by the port: the axis turns by little a step, and no force grows beyond its lever of 1. */
static void turns_nothing_over(void)
{
    struct scene_port port;
    vec3 last = { 0.0, 0.0, 0.0 };
    scene_port_set(&port, place, origin, LENGTH);
    for (int i = 0; i <= 4000; i++) {
        double tip[3], orientation[4], axis[3];
        for (int k = 0; k < 3; k++)
            tip[k] = origin[k] + 5e-4 * (i - 2000.0) / 10.0 * (k == 0 ? 0.01 : 1.0);
        scene_port_aim(&port, tip, orientation);
        quaternion_rotate(orientation, (const double[]){ 0.0, 0.0, 1.0 }, axis);
        const vec3 now = vec3_of(axis);
        CHECK(i == 0 || length(sub(now, last)) < 2e-3, "step %d turns by %g", i, length(sub(now, last)));
        CHECK(dot(now, port.outward) > 0.5, "step %d: turned over", i);
        last = now;
        const vec3 end = scaled(now, LENGTH);
        dpt_wrench wrench = { .force = { 1.0, 0.0, 0.0 } };
        vec3_store(cross(end, vec3_of(wrench.force)), wrench.torque);
        scene_port_carry(&port, tip, &wrench);
        CHECK(length(vec3_of(wrench.force)) < 1.0 + 1e-12, "step %d: %g N", i, length(vec3_of(wrench.force)));
    }
    CHECK(!scene_port_set(&port, place, place, LENGTH), "a port where the tip is was taken");
}

int main(void)
{
    TEST(is_the_gradient);
    TEST(leads_through_the_port);
    TEST(is_a_lever);
    TEST(turns_nothing_over);
    TEST(has_no_odd_direction);
    TEST(is_part_of_what_a_scene_is);
    return check_report();
}
