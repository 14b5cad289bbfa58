/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Integrators of springs, ours and two of others, on the same bodies in one run: what a tick costs, how far a press is
 * from what it should be, what stays stable, and what becomes of energy. Prints CSV.
 *
 *     spring_methods press [MESH.dpa]    how exact, and in what time
 *     spring_methods energy [MESH.dpa]   what is kept when a press is let go without damping, 1: all; and what becomes of
 *                                        nodes that are thrown about, at stiffnesses and steps, 0: it was refused
 *
 * The mesh has springs; without one it is a block of 21 x 21 x 23 nodes.
 *
 * A press: 0.3 N on the nodes within 20 mm of the highest one, for 1 s in ticks of 1 ms; of stiffer bodies as many times
 * more. Its true end is that of Newton's method, and its true way that of `plain` in substeps of 1/16 ms. Numbers behind
 * `xpbd` are substeps, behind `vbd` sweeps, behind `implicit` passes (spring_others.h).
 */
#include <float.h>

#include "bench/spring_others.h"
#include "bench/timing.h"
#include "deform/made_net.h"
#include "mesh/mesh_format.h"
#include "oracle/spring_balance.h"

#define PATCH 0.02 /* m */
#define PUSH  0.3  /* N */
#define DRAG  5.0  /* 1/s, of the block */

struct method {
    const char *name;
    uint32_t kind, count, integrator;
};

enum { PLAIN, XPBD, VBD, OURS };

static const struct method methods[] = {
    { "plain 1", PLAIN, 1, 0 },
    { "symplectic", OURS, 2, DPT_INTEGRATOR_SYMPLECTIC },
    { "implicit 1", OURS, 1, DPT_INTEGRATOR_IMPLICIT },
    { "implicit 2", OURS, 2, DPT_INTEGRATOR_IMPLICIT },
    { "implicit 4", OURS, 4, DPT_INTEGRATOR_IMPLICIT },
    { "implicit 8", OURS, 8, DPT_INTEGRATOR_IMPLICIT },
    { "xpbd 1", XPBD, 1, 0 },
    { "xpbd 2", XPBD, 2, 0 },
    { "xpbd 4", XPBD, 4, 0 },
    { "xpbd 8", XPBD, 8, 0 },
    { "vbd 1", VBD, 1, 0 },
    { "vbd 2", VBD, 2, 0 },
    { "vbd 4", VBD, 4, 0 },
};
enum { METHODS = sizeof methods / sizeof *methods };

static void *room(size_t count, size_t size)
{
    void *made = calloc(count, size);
    if (!made)
        exit(2);
    return made;
}

static void list_springs(struct body *body)
{
    const struct spring_net *net = &body->net;
    body->nodes = net->nodes;
    body->springs = net->springs;
    body->list = room(net->springs, sizeof *body->list);
    body->first = room((size_t)net->nodes + 2, sizeof *body->first);
    body->row = room(2 * (size_t)net->springs, sizeof *body->row);
    uint32_t count = 0;
    for (uint32_t slice = 0; slice < net->slices; slice++)
        for (uint32_t lane = 0; lane < LANES && LANES * slice + lane < net->nodes; lane++)
            for (uint32_t entry = net->first[slice]; entry < net->first[slice + 1]; entry++) {
                const size_t at = LANES * (size_t)entry + lane;
                const uint32_t node = LANES * slice + lane, other = net->neighbour[at];
                if (other <= node || net->stiffness[at] == 0.0f)
                    continue;
                body->list[count++] = (struct link){ node, other, net->stiffness[at], net->length[at] };
                body->first[node + 2]++;
                body->first[other + 2]++;
            }
    for (uint32_t node = 0; node < net->nodes; node++)
        body->first[node + 2] += body->first[node + 1];
    for (uint32_t i = 0; i < count; i++) {
        body->row[body->first[body->list[i].a + 1]++] = i;
        body->row[body->first[body->list[i].b + 1]++] = i;
    }
    float **const arrays[] = {
        &body->load, &body->x, &body->before, &body->v, &body->force, &body->target, &body->last
    };
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
        *arrays[i] = room(3 * (size_t)net->nodes, sizeof(float));
}

/* The body and the load are so many times as stiff and large. */
static void push(struct body *body, double stiffness)
{
    body->stiffness = (float)stiffness;
    for (uint32_t i = 0; i < body->load_count; i++)
        for (uint32_t k = 0; k < 3; k++) {
            body->loads[i].force[k] = stiffness * PUSH * body->unit[i].force[k];
            body->load[3 * body->loads[i].vertex + k] = (float)body->loads[i].force[k];
        }
}

/* Along x, y or z: the side that is pressed, which is the one that is free. */
static void press(struct body *body)
{
    const float *rest = body->net.rest;
    double fixed[3] = { 0.0 }, middle[3] = { 0.0 }, sum = 0.0;
    uint32_t count = 0, top = 0;
    for (uint32_t i = 0; i < body->nodes; i++) {
        count += body->net.mass[i] == 0.0f;
        for (int k = 0; k < 3; k++) {
            middle[k] += (double)rest[3 * i + (uint32_t)k] / body->nodes;
            fixed[k] += body->net.mass[i] == 0.0f ? (double)rest[3 * i + (uint32_t)k] : 0.0;
        }
    }
    const int up = fabs(fixed[2] / count - middle[2]) > 0.01 ? 2 : 1;
    double best = -1e9;
    for (uint32_t i = 0; i < body->nodes; i++) {
        double height = (double)rest[3 * i + (uint32_t)up];
        for (int k = 0; k < 3; k++)
            height -= k == up ? 0.0 : fabs((double)rest[3 * i + (uint32_t)k] - middle[k]);
        if (height > best)
            best = height, top = i;
    }
    body->unit = room(body->nodes, sizeof *body->unit);
    for (uint32_t i = 0; i < body->nodes; i++) {
        double square = 0.0;
        for (uint32_t k = 0; k < 3; k++)
            square += pow((double)rest[3 * i + k] - (double)rest[3 * top + k], 2.0);
        /* By mass: a node of few springs, at a slant surface, gets a small load. */
        const double share = (double)body->net.mass[i] * (1.0 - square / (PATCH * PATCH));
        if (share > 0.0) {
            body->unit[body->load_count].vertex = i;
            body->unit[body->load_count++].force[up] = share;
            sum += share;
        }
    }
    for (uint32_t i = 0; i < body->load_count; i++)
        body->unit[i].force[up] *= -1.0 / sum;
    body->loads = room(body->load_count, sizeof *body->loads);
    memcpy(body->loads, body->unit, body->load_count * sizeof *body->loads);
    push(body, 1.0);
}

/* m: how far loads went, weighted by their force. */
static double depth_of(const struct body *body, const float *x)
{
    double sum = 0.0;
    for (uint32_t i = 0; i < body->load_count; i++)
        for (uint32_t k = 0; k < 3; k++) {
            const uint32_t at = 3 * body->unit[i].vertex + k;
            sum += body->unit[i].force[k] * ((double)x[at] - (double)body->net.rest[at]);
        }
    return sum;
}

static double energy_of(const struct body *body)
{
    double sum = 0.0;
    for (uint32_t i = 0; i < body->springs; i++) {
        const struct link *link = &body->list[i];
        double square = 0.0;
        for (uint32_t k = 0; k < 3; k++)
            square += pow((double)body->x[3 * link->b + k] - (double)body->x[3 * link->a + k], 2.0);
        sum += 0.5 * (double)body->stiffness * (double)link->stiffness * pow(sqrt(square) - (double)link->length, 2.0);
    }
    for (uint32_t i = 0; i < 3 * body->nodes; i++)
        sum += 0.5 * (double)body->net.mass[i / 3] * pow((double)body->v[i], 2.0);
    return sum;
}

/* Fills in where nodes are in the end (oracle/spring_balance.h). */
static void true_end(const struct body *body, float *end)
{
    const size_t n = 3 * (size_t)body->nodes;
    struct oracle_spring *list = room(body->springs, sizeof *list);
    double *load = room(n, sizeof *load), *x = room(n, sizeof *x);
    const struct oracle_springs springs = { body->nodes, body->springs, list, body->net.mass, load };
    for (uint32_t i = 0; i < body->springs; i++)
        list[i] = (struct oracle_spring){ body->list[i].a, body->list[i].b, (double)body->list[i].stiffness,
                                          (double)body->list[i].length };
    for (size_t i = 0; i < n; i++) {
        load[i] = (double)body->load[i];
        x[i] = (double)body->net.rest[i];
    }
    const double left = oracle_spring_balance(&springs, 2e-3, x);
    if (!(left >= 0.0 && left < 1e-8))
        fprintf(stderr, "spring_methods: no balance: %g m\n", left);
    for (size_t i = 0; i < n; i++)
        end[i] = (float)x[i];
    free(list);
    free(load);
    free(x);
}

/* A method on a body; `springs` are those of ours. */
struct run {
    struct body *body;
    const struct method *method;
    dpt_springs *springs;
    void *block;
};

static void run_open(struct run *run, struct body *body, const struct method *method, const float *from)
{
    const struct spring_net *net = &body->net;
    run->body = body;
    run->method = method;
    run->block = NULL;
    memcpy(body->x, from, 3 * (size_t)net->nodes * sizeof *from);
    memset(body->v, 0, 3 * (size_t)net->nodes * sizeof *body->v);
    memset(body->last, 0, 3 * (size_t)net->nodes * sizeof *body->last);
    if (method->kind != OURS)
        return;
    dpt_springs_def def;
    dpt_springs_def_init(&def);
    def.integrator = method->integrator;
    def.iterations = method->count;
    def.stiffness = (double)body->stiffness;
    def.sleep_speed = 0.0;
    const size_t bytes = dpti_springs_net_bytes(&def, net);
    run->block = room(bytes, 1);
    if (dpti_springs_create_net(run->block, bytes, &def, net, &run->springs) != DPT_OK)
        exit(2);
    dpt_springs_set_nodes(run->springs, 0, net->nodes, from, NULL);
}

/* A tick. Returns 0 if it was refused. */
static int run_tick(struct run *run, double dt, int is_pressed)
{
    struct body *body = run->body;
    const uint32_t count = run->method->count;
    if (run->method->kind == OURS)
        return dpt_springs_step(run->springs, dt, body->loads, is_pressed ? body->load_count : 0, NULL) == DPT_OK;
    for (uint32_t i = 0; i < (run->method->kind == VBD ? 1 : count); i++)
        if (run->method->kind == VBD)
            vbd_step(body, (float)dt, count);
        else
            (run->method->kind == XPBD ? xpbd_step : plain_step)(body, (float)(dt / count));
    return 1;
}

static void run_look(struct run *run)
{
    if (run->method->kind == OURS)
        dpt_springs_get_nodes(run->springs, run->body->nodes, run->body->x, run->body->v);
}

/* How far off a press is from its end, and from its way where that is known, in per cent. */
static void measure_press(struct body *body, const float *end, double stiffness)
{
    static const double moments[] = { 0.05, 0.2, 1.0 };
    const struct method exact = { "plain 16", PLAIN, 16, 0 };
    const double depth = depth_of(body, end);
    double way[3] = { NAN, NAN, NAN }, seen[3];
    struct run run;
    push(body, stiffness);
    for (int m = stiffness > 1.0 ? 1 : -1; m < METHODS; m++) {
        const struct method *method = m < 0 ? &exact : methods + m;
        double least = DBL_MAX, worst = 0.0;
        uint32_t next = 0;
        int is_done = 1;
        run_open(&run, body, method, body->net.rest);
        for (int tick = 1; tick <= 1000 && is_done; tick++) {
            const double t = now();
            is_done = run_tick(&run, 1e-3, 1);
            least = fmin(least, now() - t);
            if (tick == (int)(1000.0 * moments[next] + 0.5)) {
                run_look(&run);
                seen[next] = depth_of(body, body->x);
                way[next] = m < 0 ? seen[next] : way[next];
                next += next < 2;
            }
        }
        for (uint32_t i = 0; i < 3 * body->nodes; i++)
            worst = fmax(worst, fabs((double)body->x[i] - (double)end[i]));
        free(run.block);
        if (!is_done) {
            printf("%u,%g,%s,refused\n", body->nodes, stiffness, method->name);
            continue;
        }
        printf("%u,%g,%s,%.3f,%.3f,%.3f", body->nodes, stiffness, method->name, 1e-6 * least,
               100.0 * (seen[2] / depth - 1.0), 100.0 * worst / depth);
        for (int i = 0; i < 3; i++)
            printf(isnan(way[i]) ? "," : ",%.3f", 100.0 * (seen[i] / way[i] - 1.0));
        printf("\n");
        fflush(stdout);
    }
    push(body, 1.0);
}

/* The largest energy of `ticks` ticks, and the last, of the first. 0: refused; infinite: not finite. */
static void follow(struct body *body, const struct method *method, const float *from, double dt, int ticks,
                   double *most, double *last)
{
    struct run run;
    run_open(&run, body, method, from);
    const double first = energy_of(body);
    *most = *last = 0.0;
    for (int i = 0; i < ticks; i++) {
        if (!run_tick(&run, dt, 0))
            break;
        run_look(&run);
        *last = energy_of(body) / first;
        *most = *last > *most ? *last : *most;
        if (!(*last < 1e6)) {
            *most = *last = HUGE_VAL;
            break;
        }
    }
    free(run.block);
}

/* Let go of a press: without damping, energy should stay. With it, and thrown about, it should not grow. */
static void measure_energy(struct body *body, const float *end)
{
    static const double scales[] = { 1.0, 1e3, 1e6 }, steps[] = { 1e-3, 1e-2, 0.033 };
    const struct spring_net damped = body->net;
    float *none = room(body->nodes, sizeof *none), *thrown = room(body->nodes, 3 * sizeof *none);
    float *load = body->load;
    uint64_t seed = 7;
    double most, last;
    body->load = room(body->nodes, 3 * sizeof *load);
    for (size_t i = 0; i < 3 * (size_t)body->nodes; i++)
        thrown[i] = end[i] + (damped.mass[i / 3] > 0.0f ? (float)random_in(&seed, -2e-4, 2e-4) : 0);
    printf("nodes,method,stiffness,dt,largest_energy,last_energy\n");
    for (int m = 0; m < METHODS; m++) {
        body->net.drag = none;
        body->net.viscosity = 0.0;
        follow(body, methods + m, end, 1e-3, 1000, &most, &last);
        printf("%u,%s,released,0.001,%.4g,%.4g\n", body->nodes, methods[m].name, most, last);
        body->net = damped;
        for (int i = 0; i < 9; i++) {
            body->stiffness = (float)scales[i % 3];
            follow(body, methods + m, thrown, steps[i / 3], 100, &most, &last);
            printf("%u,%s,%g,%g,%.4g,%.4g\n", body->nodes, methods[m].name, scales[i % 3], steps[i / 3], most, last);
            fflush(stdout);
        }
        body->stiffness = 1.0f;
    }
    free(body->load);
    body->load = load;
    free(none);
    free(thrown);
}

static const dpt_mesh *open_file(const char *path)
{
    const dpt_mesh *mesh = NULL;
    FILE *file = fopen(path, "rb");
    long size = -1;
    void *bytes = NULL;
    if (file && fseek(file, 0, SEEK_END) == 0 && (size = ftell(file)) > 0 && fseek(file, 0, SEEK_SET) == 0 &&
        posix_memalign(&bytes, 64, (size_t)size) == 0 && fread(bytes, (size_t)size, 1, file) == 1)
        dpt_mesh_open(bytes, (size_t)size, &mesh);
    if (file)
        fclose(file);
    return mesh;
}

static int load_body(struct body *body, struct made_net *net, const char *path)
{
    dpt_springs_def def;
    dpt_springs_def_init(&def);
    if (path) {
        const dpt_mesh *mesh = open_file(path);
        return mesh && mesh_spring_net(mesh, &body->net);
    }
    net_block(net, 21, 21, 23, 0.005, 5000.0, 1000.0);
    net_drag(net, DRAG);
    net->viscosity = 1e-3;
    for (uint32_t i = 0; i < 21 * 21; i++)
        net_fix(net, i);
    if (net_open(net, &def) != DPT_OK)
        return 0;
    body->net = net->rows;
    return 1;
}

int main(int argc, char **argv)
{
    struct body body = { .stiffness = 1.0f };
    struct made_net net = { 0 };
    const int is_press = argc > 1 && !strcmp(argv[1], "press");
    if (argc < 2 || argc > 3 || (!is_press && strcmp(argv[1], "energy")) ||
        !load_body(&body, &net, argc > 2 ? argv[2] : NULL)) {
        fprintf(stderr, "spring_methods press|energy [MESH.dpa]\n");
        return 2;
    }
    list_springs(&body);
    press(&body);
    float *end = room(body.nodes, 3 * sizeof *end);
    true_end(&body, end);
    if (is_press) {
        printf("nodes,stiffness,method,ms_a_tick,off_end,worst_node,off_50ms,off_200ms,off_1s\n");
        for (double stiffness = 1.0; stiffness < 1e7; stiffness *= 1e3)
            measure_press(&body, end, stiffness);
    } else {
        measure_energy(&body, end);
    }
    return 0;
}
