/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * IMPLICIT with more passes than a step needs: they end where nothing is left to solve. Bodies of the scenes by name, at
 * rest, under a load and let go: no step fails or is held, more passes change nothing, and all kernels give the same bits.
 */
#include <math.h>

#include "lib/check.h"
#include "mesh/mesh_format.h"
#include "scene/scene_bodies.h"
#include "scene/scene_list.h"

enum { STEPS = 16, LOADED_FROM = 2, LOADED_TO = 10, PASSES_ENOUGH = 64 };
#define STEP 1e-3 /* s */
#define LOAD 0.1  /* N, on one node */

/* How far those of PASSES_ENOUGH may be off, m: floats of a body of 0.5 m. */
#define OFF_MAX 1e-7

struct subject {
    const char *name;
    const struct scene_body *body;
    double gravity[3]; /* m/s^2, in the body's frame */
    uint32_t nodes, loaded;
};

/* Positions and speeds after all steps; for free(). NULL: this machine does not have the kernel. */
static float *run(const struct subject *subject, uint32_t passes, uint32_t kernel)
{
    const dpt_load load = { .vertex = subject->loaded, .force = { LOAD, LOAD, -LOAD } };
    dpt_springs_info report = { .size = sizeof report };
    dpt_springs_def def;
    dpt_springs *springs;
    dpt_springs_def_init(&def);
    def.mesh = subject->body->mesh;
    def.integrator = DPT_INTEGRATOR_IMPLICIT;
    def.iterations = passes;
    def.kernel = kernel;
    def.sleep_speed = 0.0;
    memcpy(def.gravity, subject->gravity, sizeof def.gravity);
    void *block = malloc(dpt_springs_bytes(&def));
    if (dpt_springs_create(block, dpt_springs_bytes(&def), &def, &springs) != DPT_OK) {
        free(block);
        return NULL;
    }
    uint32_t held = 0, failed = 0;
    for (int i = 0; i < STEPS; i++) {
        const uint32_t loads = i >= LOADED_FROM && i < LOADED_TO;
        failed += dpt_springs_step(springs, STEP, &load, loads, &report) != DPT_OK;
        held += report.flags & DPT_SPRINGS_FLAG_HELD;
    }
    CHECK(!failed && !held, "%s, %u passes, %s: %u steps failed, %u were held", subject->name, passes,
          dpt_kernel_name(kernel), failed, held);
    float *state = malloc(6 * (size_t)subject->nodes * sizeof *state);
    dpt_springs_get_nodes(springs, subject->nodes, state, state + 3 * (size_t)subject->nodes);
    free(block);
    return state;
}

static void compare_kernels(const struct subject *subject, uint32_t passes, const float *first)
{
    for (uint32_t kernel = DPT_KERNEL_SCALAR; kernel <= DPT_KERNEL_WASM128; kernel++) {
        float *state = run(subject, passes, kernel);
        CHECK(state ? !memcmp(state, first, 6 * (size_t)subject->nodes * sizeof *state) : kernel > DPT_KERNEL_SCALAR,
              "%s, %u passes: %s has other bits", subject->name, passes, dpt_kernel_name(kernel));
        free(state);
    }
}

/* How far nodes are from those of PASSES_ENOUGH, and those from where they were at rest. */
static void compare_places(const struct subject *subject, const struct spring_net *net, const float *first)
{
    float *enough = run(subject, PASSES_ENOUGH, DPT_KERNEL_AUTO);
    double off = 0.0, moved = 0.0;
    for (size_t i = 0; enough && i < 3 * (size_t)subject->nodes; i++) {
        off = fmax(off, fabs((double)first[i] - (double)enough[i]));
        moved = fmax(moved, fabs((double)first[i] - (double)net->rest[i]));
    }
    CHECK(enough && off <= OFF_MAX && moved > 100.0 * OFF_MAX, "%s: %g m off, of %g", subject->name, off, moved);
    free(enough);
}

static void compare(const char *name, const struct scene_bodies *bodies, const struct spring_net *net)
{
    struct subject subject = { .name = name,
                               .body = &bodies->body[0],
                               .gravity = { 0.0, 0.0, -bodies->gravity },
                               .nodes = net->nodes,
                               .loaded = net->nodes / 2 };
    while (net->mass[subject.loaded] == 0.0f)
        subject.loaded++;
    float *first = run(&subject, 256, DPT_KERNEL_SCALAR);
    CHECK(first, "%s: no springs", name);
    if (!first)
        return;
    compare_kernels(&subject, 256, first);
    compare_kernels(&subject, 1024, first);
    compare_places(&subject, net, first);
    free(first);
}

static void more_passes_change_nothing(void)
{
    static const char *const names[] = { "membrane", "cloth", "laparoscopy", "soft-liver" };
    for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
        struct file_identity identity = { .bytes = 0 };
        dpt_host_error error = { .size = sizeof error };
        struct scene_bodies bodies = { .count = 0 };
        struct spring_net net;
        if (scene_bodies_of_list(&bodies, scene_listed(names[n]), &identity, &error) == DPT_OK &&
            mesh_spring_net(bodies.body[0].mesh, &net))
            compare(names[n], &bodies, &net);
        else
            CHECK(0, "no soft body in %s", names[n]);
        scene_bodies_close(&bodies);
    }
}

int main(void)
{
    TEST(more_passes_change_nothing);
    return check_report();
}
