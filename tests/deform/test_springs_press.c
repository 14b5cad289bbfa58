/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A liver that is pressed for a second, as the compiler made its springs and with the defaults of dpt_springs_def: within
 * 5 % of where its springs are in balance (oracle/spring_balance.h), at any stiffness.
 */
#include "deform/made_net.h"
#include "dynpoint/compile.h"
#include "mesh/mesh_format.h"
#include "oracle/spring_balance.h"
#include "scene/shape.h"

#define PATCH 0.02 /* m */
#define PUSH  0.3  /* N */

static const dpt_spring_region bed = { .kind = DPT_REGION_BOX,
                                       .fixed = 1,
                                       .box = { -0.2, -0.2, -0.1, 0.2, 0.2, -0.035 } };

struct liver {
    dpt_compiled compiled;
    const dpt_mesh *mesh;
    struct spring_net net;
    struct oracle_springs oracle;
    struct oracle_spring *list;
    dpt_load *loads;
    uint32_t load_count;
    double *load, *end; /* 3 a node */
};

static void list_springs(struct liver *liver)
{
    const struct spring_net *net = &liver->net;
    liver->list = calloc(net->springs, sizeof *liver->list);
    for (uint32_t slice = 0; slice < net->slices; slice++)
        for (uint32_t entry = net->first[slice]; entry < net->first[slice + 1]; entry++)
            for (uint32_t lane = 0; lane < LANES; lane++) {
                const size_t at = LANES * (size_t)entry + lane;
                const uint32_t node = LANES * slice + lane, other = net->neighbour[at];
                if (node < other && other < net->nodes && net->stiffness[at] > 0.0f)
                    liver->list[liver->oracle.springs++] =
                        (struct oracle_spring){ node, other, (double)net->stiffness[at], (double)net->length[at] };
            }
    CHECK(liver->oracle.springs == net->springs, "%u springs of %u", liver->oracle.springs, net->springs);
}

/* Down, on the nodes near the highest one, in proportion to their mass. */
static void load(struct liver *liver)
{
    const float *rest = liver->net.rest;
    double sum = 0.0;
    uint32_t top = 0;
    for (uint32_t i = 0; i < liver->net.nodes; i++)
        top = rest[3 * i + 2] > rest[3 * top + 2] ? i : top;
    liver->loads = calloc(liver->net.nodes, sizeof *liver->loads);
    liver->load = calloc(3 * (size_t)liver->net.nodes, sizeof *liver->load);
    for (uint32_t i = 0; i < liver->net.nodes; i++) {
        double square = 0.0;
        for (uint32_t k = 0; k < 3; k++)
            square += pow((double)rest[3 * i + k] - (double)rest[3 * top + k], 2.0);
        const double share = (double)liver->net.mass[i] * (1.0 - square / (PATCH * PATCH));
        if (share > 0.0) {
            liver->loads[liver->load_count++] = (dpt_load){ .vertex = i, .force = { 0, 0, -share } };
            sum += share;
        }
    }
    for (uint32_t i = 0; i < liver->load_count; i++) {
        liver->loads[i].force[2] *= PUSH / sum;
        liver->load[3 * liver->loads[i].vertex + 2] = liver->loads[i].force[2];
    }
}

static int open_liver(struct liver *liver)
{
    const dpt_spring_net_def springs = { .size = sizeof springs,
                                         .kind = DPT_NET_VOLUME,
                                         .young = 5000.0,
                                         .density = 1000.0,
                                         .drag = 5.0,
                                         .viscosity = 1e-3,
                                         .regions = &bed,
                                         .region_count = 1 };
    struct shape shape;
    shape_reason reason;
    dpt_compile_def def;
    dpt_compile_def_init(&def);
    def.springs = &springs;
    memset(liver, 0, sizeof *liver);
    if (shape_make("liver", 2692, 0, &shape, reason) != 0)
        return 0;
    const dpt_result result = dpt_compile_arrays(shape.vertices, shape.vertex_count, shape.corners,
                                                 shape.triangle_count, &def, &liver->compiled, NULL);
    shape_free(&shape);
    if (result != DPT_OK || dpt_mesh_open(liver->compiled.bytes, liver->compiled.size, &liver->mesh) != DPT_OK ||
        !mesh_spring_net(liver->mesh, &liver->net))
        return 0;
    list_springs(liver);
    load(liver);
    liver->oracle.nodes = liver->net.nodes;
    liver->oracle.list = liver->list;
    liver->oracle.mass = liver->net.mass;
    liver->oracle.load = liver->load;
    liver->end = calloc(3 * (size_t)liver->net.nodes, sizeof *liver->end);
    for (size_t i = 0; i < 3 * (size_t)liver->net.nodes; i++)
        liver->end[i] = (double)liver->net.rest[i];
    const double left = oracle_spring_balance(&liver->oracle, 2e-3, liver->end);
    CHECK(left >= 0.0 && left < 1e-8, "the oracle's last step was %g m", left);
    const double rest = oracle_spring_rest(&liver->oracle, liver->end);
    CHECK(rest < 1e-6 * PUSH, "%g N are left", rest);
    return 1;
}

static void close_liver(struct liver *liver)
{
    free(liver->list);
    free(liver->loads);
    free(liver->load);
    free(liver->end);
    dpt_compiled_free(&liver->compiled);
}

/* How deep the load is, by its own weight. x or at. */
static double depth_of(const struct liver *liver, const float *x, const double *at)
{
    double sum = 0.0;
    for (uint32_t i = 0; i < liver->load_count; i++) {
        const size_t z = 3 * (size_t)liver->loads[i].vertex + 2;
        sum += liver->loads[i].force[2] * ((x ? (double)x[z] : at[z]) - (double)liver->net.rest[z]) / PUSH;
    }
    return sum;
}

static void press(const struct liver *liver, uint32_t integrator, double stiffness, double dt)
{
    dpt_springs_def def;
    dpt_springs *springs;
    dpt_springs_def_init(&def);
    def.mesh = liver->mesh;
    def.integrator = integrator;
    def.stiffness = stiffness;
    const size_t bytes = dpt_springs_bytes(&def);
    void *block = malloc(bytes);
    dpt_load *loads = malloc(liver->load_count * sizeof *loads);
    float *x = malloc(3 * (size_t)liver->net.nodes * sizeof *x);
    memcpy(loads, liver->loads, liver->load_count * sizeof *loads);
    for (uint32_t i = 0; i < liver->load_count; i++)
        loads[i].force[2] *= stiffness;
    CHECK(dpt_springs_create(block, bytes, &def, &springs) == DPT_OK, "not made");
    for (int i = 0; i < (int)(1.0 / dt + 0.5); i++)
        CHECK(dpt_springs_step(springs, dt, loads, liver->load_count, NULL) == DPT_OK, "no step");
    dpt_springs_get_nodes(springs, liver->net.nodes, x, NULL);
    const double depth = depth_of(liver, x, NULL), whole = depth_of(liver, NULL, liver->end);
    printf("    integrator %u, stiffness x %g, %g ms: %.4f mm, off by %.3f %%\n", integrator, stiffness, 1e3 * dt,
           1e3 * depth, 100.0 * (depth / whole - 1.0));
    CHECK(whole > 1e-3 && fabs(depth / whole - 1.0) < 0.05, "%g m deep, not %g", depth, whole);
    free(block);
    free(loads);
    free(x);
}

static void a_pressed_liver_ends_where_it_should(void)
{
    struct liver liver;
    CHECK(open_liver(&liver), "no liver");
    press(&liver, DPT_INTEGRATOR_SYMPLECTIC, 1.0, 1e-3);
    press(&liver, DPT_INTEGRATOR_IMPLICIT, 1.0, 1e-3);
    press(&liver, DPT_INTEGRATOR_IMPLICIT, 1.0, 4e-3);
    press(&liver, DPT_INTEGRATOR_IMPLICIT, 1e3, 1e-3);
    press(&liver, DPT_INTEGRATOR_IMPLICIT, 1e6, 1e-3);
    close_liver(&liver);
}

int main(void)
{
    TEST(a_pressed_liver_ends_where_it_should);
    return check_report();
}
