/* SPDX-License-Identifier: BSD-3-Clause */
#include "deform/spring_rig.h"

static void *grown(void *list, size_t count, size_t size)
{
    void *more = realloc(list, count * size);
    if (!more)
        exit(2);
    return more;
}

uint32_t rig_node(struct rig *rig, double x, double y, double z, double mass)
{
    const double at[3] = { x, y, z };
    const uint32_t node = rig->nodes++;
    rig->rest = grown(rig->rest, 3 * (size_t)rig->nodes, sizeof *rig->rest);
    rig->mass = grown(rig->mass, rig->nodes, sizeof *rig->mass);
    rig->drag = grown(rig->drag, rig->nodes, sizeof *rig->drag);
    rig->links = grown(rig->links, RIG_LINKS * (size_t)rig->nodes, sizeof *rig->links);
    rig->degree = grown(rig->degree, rig->nodes, sizeof *rig->degree);
    rig->degree[node] = 0;
    for (int k = 0; k < 3; k++)
        rig->rest[3 * (size_t)node + (size_t)k] = (float)at[k];
    rig->mass[node] = (float)mass;
    rig->drag[node] = 0.0f;
    return node;
}

static double apart(const struct rig *rig, uint32_t a, uint32_t b)
{
    double sum = 0.0;
    for (size_t k = 0; k < 3; k++) {
        const double d = (double)rig->rest[3 * (size_t)b + k] - (double)rig->rest[3 * (size_t)a + k];
        sum += d * d;
    }
    return sqrt(sum);
}

/* A node's springs so far, at most RIG_LINKS. */
static uint32_t *link_of(struct rig *rig, uint32_t node)
{
    return rig->links + RIG_LINKS * (size_t)node;
}

static void add_link(struct rig *rig, uint32_t node, uint32_t spring)
{
    CHECK(rig->degree[node] < RIG_LINKS, "too many springs at node %u", node);
    if (rig->degree[node] < RIG_LINKS)
        link_of(rig, node)[rig->degree[node]++] = spring;
}

void rig_spring(struct rig *rig, uint32_t a, uint32_t b, double stiffness, double length)
{
    for (uint32_t i = 0; i < rig->degree[a]; i++) {
        struct rig_spring *old = &rig->list[link_of(rig, a)[i]];
        if ((old->a == a && old->b == b) || (old->a == b && old->b == a)) {
            old->stiffness += stiffness;
            return;
        }
    }
    if (rig->springs == rig->room) {
        rig->room = 2 * rig->room + 64;
        rig->list = grown(rig->list, rig->room, sizeof *rig->list);
    }
    add_link(rig, a, rig->springs);
    add_link(rig, b, rig->springs);
    rig->list[rig->springs++] = (struct rig_spring){ a, b, stiffness, length < 0.0 ? apart(rig, a, b) : length };
}

void rig_drag(struct rig *rig, double drag)
{
    for (uint32_t node = 0; node < rig->nodes; node++)
        rig->drag[node] = (float)drag;
}

void rig_fix(struct rig *rig, uint32_t node)
{
    rig->mass[node] = 0.0f;
}

static void make_rows(struct rig *rig)
{
    const uint32_t slices = (rig->nodes + LANES - 1) / LANES;
    uint32_t *count = calloc(LANES * (size_t)slices, sizeof *count), entries = 0;
    rig->first = calloc((size_t)slices + 1, sizeof *rig->first);
    for (uint32_t i = 0; i < rig->springs; i++) {
        count[rig->list[i].a]++;
        count[rig->list[i].b]++;
    }
    for (uint32_t slice = 0; slice < slices; slice++) {
        uint32_t most = 0;
        for (uint32_t lane = 0; lane < LANES; lane++)
            most = count[LANES * slice + lane] > most ? count[LANES * slice + lane] : most;
        rig->first[slice] = entries;
        entries += most;
    }
    rig->first[slices] = entries;
    rig->neighbour = calloc(LANES * ((size_t)entries + 1), sizeof *rig->neighbour);
    rig->stiffness = calloc(LANES * ((size_t)entries + 1), sizeof *rig->stiffness);
    rig->length = calloc(LANES * ((size_t)entries + 1), sizeof *rig->length);
    for (uint32_t slice = 0; slice < slices; slice++)
        for (uint32_t entry = rig->first[slice]; entry < rig->first[slice + 1]; entry++)
            for (uint32_t lane = 0; lane < LANES; lane++) {
                const size_t at = LANES * (size_t)entry + lane;
                const uint32_t node = LANES * slice + lane;
                rig->neighbour[at] = node < rig->nodes ? node : rig->nodes - 1;
                rig->length[at] = 1.0f;
            }
    memset(count, 0, LANES * (size_t)slices * sizeof *count);
    for (uint32_t i = 0; i < rig->springs; i++)
        for (int end = 0; end < 2; end++) {
            const struct rig_spring *spring = &rig->list[i];
            const uint32_t node = end ? spring->b : spring->a, other = end ? spring->a : spring->b;
            const size_t entry = (size_t)rig->first[node / LANES] + count[node]++;
            const size_t at = LANES * entry + node % LANES;
            rig->neighbour[at] = other;
            rig->stiffness[at] = (float)spring->stiffness;
            rig->length[at] = (float)spring->length;
        }
    free(count);
    rig->net = (struct spring_net){ .nodes = rig->nodes,
                                    .slices = slices,
                                    .springs = rig->springs,
                                    .rest = rig->rest,
                                    .mass = rig->mass,
                                    .drag = rig->drag,
                                    .first = rig->first,
                                    .neighbour = rig->neighbour,
                                    .stiffness = rig->stiffness,
                                    .length = rig->length,
                                    .viscosity = rig->viscosity };
}

dpt_result rig_reopen(struct rig *rig, const dpt_springs_def *def)
{
    const size_t bytes = dpti_springs_net_bytes(def, &rig->net);
    free(rig->block);
    rig->block = malloc(bytes);
    rig->made = NULL;
    return dpti_springs_create_net(rig->block, bytes, def, &rig->net, &rig->made);
}

dpt_result rig_open(struct rig *rig, const dpt_springs_def *def)
{
    make_rows(rig);
    return rig_reopen(rig, def);
}

void rig_close(struct rig *rig)
{
    void *all[] = { rig->links, rig->degree, rig->rest,      rig->mass,      rig->drag, rig->list,
                    rig->first, rig->length, rig->neighbour, rig->stiffness, rig->block };
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        free(all[i]);
    memset(rig, 0, sizeof *rig);
}

/* What a cube gives to each of its pairs of corners, which are numbered by bits: x 1, y 2, z 4. */
static void add_cube(struct rig *rig, const uint32_t corner[8], double k)
{
    for (uint32_t a = 0; a < 8; a++)
        for (uint32_t b = a + 1; b < 8; b++) {
            const int axes = __builtin_popcount(a ^ b);
            if (axes < 3)
                rig_spring(rig, corner[a], corner[b], axes == 1 ? 0.25 * k : 0.5 * k, -1.0);
        }
}

void rig_block(struct rig *rig, uint32_t nx, uint32_t ny, uint32_t nz, double s, double e, double density)
{
    const uint32_t from = rig->nodes;
    for (uint32_t z = 0; z < nz; z++)
        for (uint32_t y = 0; y < ny; y++)
            for (uint32_t x = 0; x < nx; x++) {
                const double share =
                    (x && x < nx - 1 ? 1.0 : 0.5) * (y && y < ny - 1 ? 1.0 : 0.5) * (z && z < nz - 1 ? 1.0 : 0.5);
                rig_node(rig, s * x, s * y, s * z, density * s * s * s * share);
            }
    for (uint32_t z = 0; z + 1 < nz; z++)
        for (uint32_t y = 0; y + 1 < ny; y++)
            for (uint32_t x = 0; x + 1 < nx; x++) {
                uint32_t corner[8];
                for (uint32_t i = 0; i < 8; i++)
                    corner[i] = from + (x + (i & 1)) + nx * ((y + (i >> 1 & 1)) + ny * (z + (i >> 2)));
                add_cube(rig, corner, 0.4 * e * s);
            }
}

static const float *nodes_of(const struct rig *rig, int speeds)
{
    static float *positions, *fast;
    static size_t room;
    if (room < 3 * (size_t)rig->nodes) {
        room = 3 * (size_t)rig->nodes;
        positions = grown(positions, room, sizeof *positions);
        fast = grown(fast, room, sizeof *fast);
    }
    CHECK(dpt_springs_get_nodes(rig->made, rig->nodes, positions, fast) == DPT_OK, "no nodes");
    return speeds ? fast : positions;
}

const float *rig_positions(const struct rig *rig)
{
    return nodes_of(rig, 0);
}

const float *rig_speeds(const struct rig *rig)
{
    return nodes_of(rig, 1);
}

void rig_steps(struct rig *rig, double dt, uint32_t steps)
{
    for (uint32_t i = 0; i < steps; i++) {
        const dpt_result result = dpt_springs_step(rig->made, dt, NULL, 0, NULL);
        CHECK(result == DPT_OK, "step %u: %s", i, dpt_result_name(result));
        if (result != DPT_OK)
            return;
    }
}

double *rig_matrix(const struct rig *rig)
{
    const size_t n = 3 * (size_t)rig->nodes;
    double *matrix = calloc(n * n, sizeof *matrix);
    for (uint32_t i = 0; i < rig->springs; i++) {
        const struct rig_spring *spring = &rig->list[i];
        const size_t end[2] = { 3 * (size_t)spring->a, 3 * (size_t)spring->b };
        const double length = apart(rig, spring->a, spring->b);
        double d[3];
        for (size_t k = 0; k < 3; k++)
            d[k] = ((double)rig->rest[end[1] + k] - (double)rig->rest[end[0] + k]) / length;
        for (size_t k = 0; k < 3; k++)
            for (size_t l = 0; l < 3; l++) {
                const double turn = 1.0 - spring->length / length;
                const double stiffness = spring->stiffness * ((1.0 - turn) * d[k] * d[l] + (k == l ? turn : 0.0));
                for (size_t a = 0; a < 2; a++)
                    for (size_t b = 0; b < 2; b++)
                        if (rig->mass[end[a] / 3] > 0.0f && rig->mass[end[b] / 3] > 0.0f)
                            matrix[(end[a] + k) * n + end[b] + l] += a == b ? stiffness : -stiffness;
            }
    }
    return matrix;
}
