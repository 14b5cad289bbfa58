/* SPDX-License-Identifier: BSD-3-Clause */
#include "deform/made_net.h"

static void *grown(void *list, size_t count, size_t size)
{
    void *more = realloc(list, count * size);
    if (!more)
        exit(2);
    return more;
}

uint32_t net_node(struct made_net *net, double x, double y, double z, double mass)
{
    const double at[3] = { x, y, z };
    const uint32_t node = net->nodes++;
    net->rest = grown(net->rest, 3 * (size_t)net->nodes, sizeof *net->rest);
    net->mass = grown(net->mass, net->nodes, sizeof *net->mass);
    net->drag = grown(net->drag, net->nodes, sizeof *net->drag);
    net->links = grown(net->links, NET_LINKS * (size_t)net->nodes, sizeof *net->links);
    net->degree = grown(net->degree, net->nodes, sizeof *net->degree);
    net->degree[node] = 0;
    for (int k = 0; k < 3; k++)
        net->rest[3 * (size_t)node + (size_t)k] = (float)at[k];
    net->mass[node] = (float)mass;
    net->drag[node] = 0.0f;
    return node;
}

static double apart(const struct made_net *net, uint32_t a, uint32_t b)
{
    double sum = 0.0;
    for (size_t k = 0; k < 3; k++) {
        const double d = (double)net->rest[3 * (size_t)b + k] - (double)net->rest[3 * (size_t)a + k];
        sum += d * d;
    }
    return sqrt(sum);
}

/* A node's springs so far, at most NET_LINKS. */
static uint32_t *link_of(struct made_net *net, uint32_t node)
{
    return net->links + NET_LINKS * (size_t)node;
}

static void add_link(struct made_net *net, uint32_t node, uint32_t spring)
{
    CHECK(net->degree[node] < NET_LINKS, "too many springs at node %u", node);
    if (net->degree[node] < NET_LINKS)
        link_of(net, node)[net->degree[node]++] = spring;
}

void net_spring(struct made_net *net, uint32_t a, uint32_t b, double stiffness, double length)
{
    for (uint32_t i = 0; i < net->degree[a]; i++) {
        struct net_spring *old = &net->list[link_of(net, a)[i]];
        if ((old->a == a && old->b == b) || (old->a == b && old->b == a)) {
            old->stiffness += stiffness;
            return;
        }
    }
    if (net->springs == net->room) {
        net->room = 2 * net->room + 64;
        net->list = grown(net->list, net->room, sizeof *net->list);
    }
    add_link(net, a, net->springs);
    add_link(net, b, net->springs);
    net->list[net->springs++] = (struct net_spring){ a, b, stiffness, length < 0.0 ? apart(net, a, b) : length };
}

void net_drag(struct made_net *net, double drag)
{
    for (uint32_t node = 0; node < net->nodes; node++)
        net->drag[node] = (float)drag;
}

void net_fix(struct made_net *net, uint32_t node)
{
    net->mass[node] = 0.0f;
}

static void make_rows(struct made_net *net)
{
    const uint32_t slices = (net->nodes + LANES - 1) / LANES;
    uint32_t *count = calloc(LANES * (size_t)slices, sizeof *count), entries = 0;
    net->first = calloc((size_t)slices + 1, sizeof *net->first);
    for (uint32_t i = 0; i < net->springs; i++) {
        count[net->list[i].a]++;
        count[net->list[i].b]++;
    }
    for (uint32_t slice = 0; slice < slices; slice++) {
        uint32_t most = 0;
        for (uint32_t lane = 0; lane < LANES; lane++)
            most = count[LANES * slice + lane] > most ? count[LANES * slice + lane] : most;
        net->first[slice] = entries;
        entries += most;
    }
    net->first[slices] = entries;
    net->neighbour = calloc(LANES * ((size_t)entries + 1), sizeof *net->neighbour);
    net->stiffness = calloc(LANES * ((size_t)entries + 1), sizeof *net->stiffness);
    net->length = calloc(LANES * ((size_t)entries + 1), sizeof *net->length);
    for (uint32_t slice = 0; slice < slices; slice++)
        for (uint32_t entry = net->first[slice]; entry < net->first[slice + 1]; entry++)
            for (uint32_t lane = 0; lane < LANES; lane++) {
                const size_t at = LANES * (size_t)entry + lane;
                const uint32_t node = LANES * slice + lane;
                net->neighbour[at] = node < net->nodes ? node : net->nodes - 1;
                net->length[at] = 1.0f;
            }
    memset(count, 0, LANES * (size_t)slices * sizeof *count);
    for (uint32_t i = 0; i < net->springs; i++)
        for (int end = 0; end < 2; end++) {
            const struct net_spring *spring = &net->list[i];
            const uint32_t node = end ? spring->b : spring->a, other = end ? spring->a : spring->b;
            const size_t entry = (size_t)net->first[node / LANES] + count[node]++;
            const size_t at = LANES * entry + node % LANES;
            net->neighbour[at] = other;
            net->stiffness[at] = (float)spring->stiffness;
            net->length[at] = (float)spring->length;
        }
    free(count);
    net->rows = (struct spring_net){ .nodes = net->nodes,
                                     .slices = slices,
                                     .springs = net->springs,
                                     .rest = net->rest,
                                     .mass = net->mass,
                                     .drag = net->drag,
                                     .first = net->first,
                                     .neighbour = net->neighbour,
                                     .stiffness = net->stiffness,
                                     .length = net->length,
                                     .viscosity = net->viscosity };
}

dpt_result net_reopen(struct made_net *net, const dpt_springs_def *def)
{
    const size_t bytes = dpti_springs_net_bytes(def, &net->rows);
    free(net->block);
    net->block = malloc(bytes);
    net->made = NULL;
    return dpti_springs_create_net(net->block, bytes, def, &net->rows, &net->made);
}

dpt_result net_open(struct made_net *net, const dpt_springs_def *def)
{
    make_rows(net);
    return net_reopen(net, def);
}

void net_close(struct made_net *net)
{
    void *all[] = { net->links, net->degree, net->rest,      net->mass,      net->drag, net->list,
                    net->first, net->length, net->neighbour, net->stiffness, net->block };
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        free(all[i]);
    memset(net, 0, sizeof *net);
}

/* What a cube gives to each of its pairs of corners, which are numbered by bits: x 1, y 2, z 4. */
static void add_cube(struct made_net *net, const uint32_t corner[8], double k)
{
    for (uint32_t a = 0; a < 8; a++)
        for (uint32_t b = a + 1; b < 8; b++) {
            const int axes = __builtin_popcount(a ^ b);
            if (axes < 3)
                net_spring(net, corner[a], corner[b], axes == 1 ? 0.25 * k : 0.5 * k, -1.0);
        }
}

void net_block(struct made_net *net, uint32_t nx, uint32_t ny, uint32_t nz, double s, double e, double density)
{
    const uint32_t from = net->nodes;
    for (uint32_t z = 0; z < nz; z++)
        for (uint32_t y = 0; y < ny; y++)
            for (uint32_t x = 0; x < nx; x++) {
                const double share =
                    (x && x < nx - 1 ? 1.0 : 0.5) * (y && y < ny - 1 ? 1.0 : 0.5) * (z && z < nz - 1 ? 1.0 : 0.5);
                net_node(net, s * x, s * y, s * z, density * s * s * s * share);
            }
    for (uint32_t z = 0; z + 1 < nz; z++)
        for (uint32_t y = 0; y + 1 < ny; y++)
            for (uint32_t x = 0; x + 1 < nx; x++) {
                uint32_t corner[8];
                for (uint32_t i = 0; i < 8; i++)
                    corner[i] = from + (x + (i & 1)) + nx * ((y + (i >> 1 & 1)) + ny * (z + (i >> 2)));
                add_cube(net, corner, 0.4 * e * s);
            }
}

static const float *nodes_of(const struct made_net *net, int speeds)
{
    static float *positions, *fast;
    static size_t room;
    if (room < 3 * (size_t)net->nodes) {
        room = 3 * (size_t)net->nodes;
        positions = grown(positions, room, sizeof *positions);
        fast = grown(fast, room, sizeof *fast);
    }
    CHECK(dpt_springs_get_nodes(net->made, net->nodes, positions, fast) == DPT_OK, "no nodes");
    return speeds ? fast : positions;
}

const float *net_positions(const struct made_net *net)
{
    return nodes_of(net, 0);
}

const float *net_speeds(const struct made_net *net)
{
    return nodes_of(net, 1);
}

void net_steps(struct made_net *net, double dt, uint32_t steps)
{
    for (uint32_t i = 0; i < steps; i++) {
        const dpt_result result = dpt_springs_step(net->made, dt, NULL, 0, NULL);
        CHECK(result == DPT_OK, "step %u: %s", i, dpt_result_name(result));
        if (result != DPT_OK)
            return;
    }
}

double *net_matrix(const struct made_net *net)
{
    const size_t n = 3 * (size_t)net->nodes;
    double *matrix = calloc(n * n, sizeof *matrix);
    for (uint32_t i = 0; i < net->springs; i++) {
        const struct net_spring *spring = &net->list[i];
        const size_t end[2] = { 3 * (size_t)spring->a, 3 * (size_t)spring->b };
        const double length = apart(net, spring->a, spring->b);
        double d[3];
        for (size_t k = 0; k < 3; k++)
            d[k] = ((double)net->rest[end[1] + k] - (double)net->rest[end[0] + k]) / length;
        for (size_t k = 0; k < 3; k++)
            for (size_t l = 0; l < 3; l++) {
                const double turn = 1.0 - spring->length / length;
                const double stiffness = spring->stiffness * ((1.0 - turn) * d[k] * d[l] + (k == l ? turn : 0.0));
                for (size_t a = 0; a < 2; a++)
                    for (size_t b = 0; b < 2; b++)
                        if (net->mass[end[a] / 3] > 0.0f && net->mass[end[b] / 3] > 0.0f)
                            matrix[(end[a] + k) * n + end[b] + l] += a == b ? stiffness : -stiffness;
            }
    }
    return matrix;
}
