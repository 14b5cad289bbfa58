/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What a step of springs costs, and where it is stable.
 *
 *     springs cost [NX NY NZ]   ns a spring and whole step, and ms a step, of a block of nodes: a plain scalar loop over
 *                               springs, and each kernel and integrator, in turns; prints CSV
 *     springs map               a small block at stiffnesses and steps with each integrator, for a second: prints CSV
 *
 * Springs are counted once. Times are the least of PASSES turns of TURN steps each. `asleep` is a step of a body at rest.
 * In a map, `outcome` is the largest energy over that at the start, 0 for a step that was refused; EULER and SYMPLECTIC
 * are asked for one substep, 16, and once without a limit, by the loops themselves.
 */
#include "bench/timing.h"
#include "deform/made_net.h"

enum { PASSES = 15, TURN = 4 };

/* The plain loop: one spring after the other, then one node after the other. */
struct plain {
    uint32_t nodes, springs;
    float *x, *v, *f, *per_mass;
    struct {
        uint32_t a, b;
        float stiffness, length;
    } * list;
};

static void plain_step(struct plain *plain, float h)
{
    float *restrict f = plain->f;
    const float *restrict x = plain->x;
    memset(f, 0, 3 * (size_t)plain->nodes * sizeof *f);
    for (uint32_t i = 0; i < plain->springs; i++) {
        const uint32_t a = 3 * plain->list[i].a, b = 3 * plain->list[i].b;
        const float dx = x[b] - x[a], dy = x[b + 1] - x[a + 1], dz = x[b + 2] - x[a + 2];
        const float pull =
            plain->list[i].stiffness * (1.0f - plain->list[i].length / sqrtf(dx * dx + dy * dy + dz * dz));
        f[a] += pull * dx;
        f[a + 1] += pull * dy;
        f[a + 2] += pull * dz;
        f[b] -= pull * dx;
        f[b + 1] -= pull * dy;
        f[b + 2] -= pull * dz;
    }
    for (uint32_t i = 0; i < 3 * plain->nodes; i++) {
        plain->v[i] += h * plain->per_mass[i / 3] * f[i];
        plain->x[i] += h * plain->v[i];
    }
}

static struct plain plain_of(const struct made_net *net)
{
    const size_t n = 3 * (size_t)net->nodes;
    struct plain plain = { .nodes = net->nodes, .springs = net->springs };
    plain.x = malloc(n * sizeof *plain.x);
    plain.v = calloc(n, sizeof *plain.v);
    plain.f = calloc(n, sizeof *plain.f);
    plain.per_mass = malloc(net->nodes * sizeof *plain.per_mass);
    plain.list = malloc(net->springs * sizeof *plain.list);
    memcpy(plain.x, net->rest, n * sizeof *plain.x);
    for (uint32_t i = 0; i < net->nodes; i++)
        plain.per_mass[i] = net->mass[i] > 0.0f ? 1.0f / net->mass[i] : 0.0f;
    for (uint32_t i = 0; i < net->springs; i++) {
        plain.list[i].a = net->list[i].a;
        plain.list[i].b = net->list[i].b;
        plain.list[i].stiffness = (float)net->list[i].stiffness;
        plain.list[i].length = (float)net->list[i].length;
    }
    return plain;
}

struct subject {
    char name[48];
    uint32_t substeps;
    double least;
    int asleep;
    struct made_net net; /* shares its net */
};

static const char *const integrators[] = { "symplectic", "euler", "implicit" };

static int open_subject(struct subject *subject, const struct made_net *net, uint32_t kernel, uint32_t integrator,
                        uint32_t iterations, int asleep)
{
    dpt_springs_def def;
    dpt_springs_def_init(&def);
    def.kernel = kernel;
    def.integrator = integrator;
    def.iterations = iterations;
    def.sleep_speed = asleep ? 1e-3 : 0.0;
    def.sleep_steps = 2;
    subject->net = *net;
    subject->net.block = NULL;
    subject->least = 1e300;
    subject->asleep = asleep;
    sprintf(subject->name, "%s%s", integrators[integrator], asleep ? " asleep" : "");
    if (integrator == DPT_INTEGRATOR_IMPLICIT)
        sprintf(subject->name + strlen(subject->name), " %u", iterations);
    sprintf(subject->name + strlen(subject->name), ",%s", dpt_kernel_name(kernel));
    if (net_reopen(&subject->net, &def) != DPT_OK)
        return 0;
    /* Every node moves a little. */
    float *x = malloc(3 * (size_t)net->nodes * sizeof *x);
    uint64_t seed = 3;
    for (size_t i = 0; i < 3 * (size_t)net->nodes; i++)
        x[i] = net->rest[i] + (asleep ? 0.0f : (float)random_in(&seed, -1e-5, 1e-5));
    dpt_springs_set_nodes(subject->net.made, 0, net->nodes, x, NULL);
    free(x);
    return 1;
}

static int cost(uint32_t nx, uint32_t ny, uint32_t nz)
{
    enum { MOST = 24 };
    static struct subject subject[MOST];
    struct made_net net = { 0 };
    dpt_springs_def def;
    dpt_springs_def_init(&def);
    net_block(&net, nx, ny, nz, 0.004, 5000.0, 1000.0);
    net.viscosity = 1e-4;
    for (uint32_t i = 0; i < nx * ny; i++)
        net_fix(&net, i);
    if (net_open(&net, &def) != DPT_OK)
        return 1;
    struct plain plain = plain_of(&net);
    uint32_t count = 0;
    for (uint32_t id = DPT_KERNEL_SCALAR; id <= DPT_KERNEL_WASM128; id++)
        count += (uint32_t)open_subject(&subject[count], &net, id, DPT_INTEGRATOR_SYMPLECTIC, 1, 0);
    const uint32_t best = dpt_kernel_best();
    for (uint32_t iterations = 1; iterations <= 8; iterations *= 2)
        count += (uint32_t)open_subject(&subject[count], &net, best, DPT_INTEGRATOR_IMPLICIT, iterations, 0);
    count += (uint32_t)open_subject(&subject[count], &net, best, DPT_INTEGRATOR_SYMPLECTIC, 1, 1);
    double least = 1e300;
    const double h = 0.5 * net.made->stable_step;
    for (int pass = 0; pass < PASSES; pass++) {
        double t = now();
        for (int i = 0; i < TURN; i++)
            plain_step(&plain, (float)h);
        t = (now() - t) / TURN;
        least = t < least ? t : least;
        for (uint32_t s = 0; s < count; s++) {
            t = now();
            for (int i = 0; i < TURN; i++)
                dpt_springs_step(subject[s].net.made, h, NULL, 0, NULL);
            t = (now() - t) / TURN;
            subject[s].least = t < subject[s].least ? t : subject[s].least;
        }
    }
    printf("nodes,springs,subject,kernel,ns_per_spring,ms_per_step,times_plain\n");
    printf("%u,%u,plain loop,scalar,%.3f,%.3f,1\n", net.nodes, net.springs, least / net.springs, 1e-6 * least);
    for (uint32_t s = 0; s < count; s++)
        printf("%u,%u,%s,%.3f,%.4f,%.2f\n", net.nodes, net.springs, subject[s].name, subject[s].least / net.springs,
               1e-6 * subject[s].least, least / subject[s].least);
    return 0;
}

/* A block that is struck, for a second or 2000 steps: the largest energy over that at the start; 0: refused. */
static double strike(struct made_net *net, uint32_t integrator, double stiffness, double dt, uint32_t substeps)
{
    dpt_springs_def def;
    dpt_springs_def_init(&def);
    def.integrator = integrator;
    def.stiffness = stiffness;
    def.sleep_speed = 0.0;
    def.max_substeps = substeps ? substeps : 1;
    if (net_reopen(net, &def) != DPT_OK)
        return 0.0;
    float *x = malloc(3 * (size_t)net->nodes * sizeof *x);
    double elastic, kinetic, first, most = 0.0;
    uint64_t seed = 3;
    for (size_t i = 0; i < 3 * (size_t)net->nodes; i++)
        x[i] = net->rest[i] + (net->mass[i / 3] > 0.0f ? (float)random_in(&seed, -1e-3, 1e-3) : 0.0f);
    dpt_springs_set_nodes(net->made, 0, net->nodes, x, NULL);
    free(x);
    dpt_springs_get_energy(net->made, &elastic, &kinetic);
    first = elastic + kinetic;
    const int steps = dt > 5e-4 ? (int)(1.0 / dt) + 1 : 2000;
    for (int i = 0; i < steps; i++) {
        if (substeps ? dpt_springs_step(net->made, dt, NULL, 0, NULL) != DPT_OK
                     : !dpti_springs_substeps(net->made, dt, 1))
            return substeps ? 0.0 : 1e12;
        dpt_springs_get_energy(net->made, &elastic, &kinetic);
        most = elastic + kinetic > most ? elastic + kinetic : most;
    }
    return most / first;
}

static int map(void)
{
    struct made_net net = { 0 };
    dpt_springs_def def;
    dpt_springs_def_init(&def);
    net_block(&net, 6, 6, 6, 0.01, 5000.0, 1000.0);
    net.viscosity = 1e-4;
    for (uint32_t i = 0; i < 36; i++)
        net_fix(&net, i);
    if (net_open(&net, &def) != DPT_OK)
        return 1;
    printf("integrator,substeps,stiffness,step,stable_step,outcome\n");
    for (uint32_t integrator = DPT_INTEGRATOR_SYMPLECTIC; integrator <= DPT_INTEGRATOR_IMPLICIT; integrator++)
        for (uint32_t substeps = 0; substeps <= 16; substeps = substeps ? 16 * substeps : 1)
            for (double stiffness = 0.01; stiffness < 2e6; stiffness *= sqrt(10.0))
                for (double dt = 1e-5; dt < 0.2; dt *= sqrt(10.0)) {
                    if (integrator == DPT_INTEGRATOR_IMPLICIT && substeps != 1)
                        continue;
                    const double outcome = strike(&net, integrator, stiffness, dt, substeps);
                    printf("%s,%u,%.4g,%.4g,%.4g,%.4g\n", integrators[integrator], substeps, stiffness, dt,
                           dpt_springs_get_stable_step(net.made), outcome);
                }
    net_close(&net);
    return 0;
}

int main(int argc, char **argv)
{
    if (argc == 2 && !strcmp(argv[1], "map"))
        return map();
    if (argc >= 2 && !strcmp(argv[1], "cost") && (argc == 2 || argc == 5)) {
        uint32_t size[3] = { 29, 29, 30 };
        for (int k = 0; k < 3 && argc == 5; k++)
            size[k] = (uint32_t)strtoul(argv[2 + k], NULL, 10);
        if (size[0] > 1 && size[1] > 1 && size[2] > 1)
            return cost(size[0], size[1], size[2]);
    }
    fprintf(stderr, "springs cost [NX NY NZ] | springs map\n");
    return 2;
}
