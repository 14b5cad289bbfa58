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

static void make_cells(struct made_net *net);

dpt_result net_open(struct made_net *net, const dpt_springs_def *def)
{
    make_rows(net);
    make_cells(net);
    return net_reopen(net, def);
}

void net_close(struct made_net *net)
{
    void *all[] = { net->corners, net->cell_stiffness, net->cell_nodes, net->cell_k,    net->links,
                    net->degree,  net->rest,           net->mass,       net->drag,      net->list,
                    net->first,   net->length,         net->neighbour,  net->stiffness, net->block };
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        free(all[i]);
    memset(net, 0, sizeof *net);
}

static void add_cell(struct made_net *net, const uint32_t corner[8], double k)
{
    net->corners = grown(net->corners, (size_t)net->cells + 1, sizeof *net->corners);
    net->cell_stiffness = grown(net->cell_stiffness, (size_t)net->cells + 1, sizeof *net->cell_stiffness);
    memcpy(net->corners[net->cells], corner, sizeof *net->corners);
    net->cell_stiffness[net->cells++] = k;
}

static void make_cells(struct made_net *net)
{
    const uint32_t slices = (net->cells + LANES - 1) / LANES;
    net->cell_nodes = grown(net->cell_nodes, 8 * LANES * ((size_t)slices + 1), sizeof *net->cell_nodes);
    net->cell_k = grown(net->cell_k, LANES * ((size_t)slices + 1), sizeof *net->cell_k);
    for (uint32_t i = 0; i < LANES * slices; i++) {
        const uint32_t cell = i < net->cells ? i : net->cells - 1;
        net->cell_k[i] = i < net->cells ? (float)net->cell_stiffness[i] : 0.0f;
        for (uint32_t c = 0; c < 8; c++)
            net->cell_nodes[8 * LANES * (i / LANES) + LANES * c + i % LANES] = net->corners[cell][c];
    }
    net->rows.cells = net->cells;
    net->rows.cell_slices = slices;
    net->rows.cell_nodes = net->cell_nodes;
    net->rows.cell_stiffness = net->cell_k;
    net->rows.cell_size = net->cell_size;
    net->rows.poisson = net->poisson;
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
    const int has_cells = net->poisson > 0.0 && net->poisson != 0.25;
    const double k = has_cells ? 0.5 / (1.0 + net->poisson) * e * s : 0.4 * e * s;
    net->cell_size = s;
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
                add_cube(net, corner, k);
                if (has_cells)
                    add_cell(net, corner, k);
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

static double triple(const double a[3], const double b[3], const double c[3])
{
    return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

double net_cell_energy(const struct made_net *net, uint32_t cell, const double x[24])
{
    const double nu = net->poisson, s = net->cell_size, slope = 2.0 * nu / (1.0 - 2.0 * nu) - 1.0;
    const double steep = slope > 1.6 ? 1.25 * slope : 2.0, turn = slope > 1.6 ? 63.0 / 64.0 : 0.75;
    const double at_turn = (turn - 1.0) * slope;
    double edge[3][3] = { { 0.0 } }, size = 0.0;
    for (int c = 0; c < 8; c++)
        for (int axis = 0; axis < 3; axis++)
            for (int k = 0; k < 3; k++)
                edge[axis][k] += (c >> axis & 1 ? 1.0 : -1.0) * x[3 * c + k] / (4.0 * s);
    for (int i = 0; i < 9; i++)
        size += edge[i / 3][i % 3] * edge[i / 3][i % 3];
    const double felt = size <= 3.375 ? size : 4.125 - 0.75 * 0.75 / (size - 2.625);
    const double v = (size > 0.0 ? felt / size : 1.0) * triple(edge[0], edge[1], edge[2]);
    /* The pressure is straight from where it is -2 to the turn, from there to 1, and on to where it is 2 or -2. */
    const double low = turn - (2.0 + at_turn) / steep, high = 1.0 + 2.0 / fabs(slope);
    double sum = 0.0;
    if (v > high)
        sum = 0.5 * slope * (high - 1.0) * (high - 1.0) + slope * (high - 1.0) * (v - high);
    else if (v >= turn)
        sum = 0.5 * slope * (v - 1.0) * (v - 1.0);
    else {
        const double from = v > low ? v : low;
        sum = 0.5 * slope * (turn - 1.0) * (turn - 1.0) + at_turn * (from - turn) +
              0.5 * steep * (from - turn) * (from - turn) - 2.0 * (v - from);
    }
    return net->cell_stiffness[cell] * s * s * sum;
}

static void corners_at(const struct made_net *net, uint32_t cell, const float *x, double to[24])
{
    for (size_t c = 0; c < 8; c++)
        for (size_t k = 0; k < 3; k++)
            to[3 * c + k] = (double)x[3 * (size_t)net->corners[cell][c] + k];
}

static void add_cell_force(const struct made_net *net, uint32_t cell, const float *x, double *force)
{
    const double by = 1e-5 * net->cell_size;
    double at[24];
    corners_at(net, cell, x, at);
    for (size_t i = 0; i < 24; i++) {
        const double here = at[i];
        at[i] = here + by;
        const double more = net_cell_energy(net, cell, at);
        at[i] = here - by;
        force[3 * (size_t)net->corners[cell][i / 3] + i % 3] -= (more - net_cell_energy(net, cell, at)) / (2.0 * by);
        at[i] = here;
    }
}

void net_forces(const struct made_net *net, const float *x, double *force)
{
    memset(force, 0, 3 * (size_t)net->nodes * sizeof *force);
    for (uint32_t i = 0; i < net->springs; i++) {
        const struct net_spring *spring = &net->list[i];
        const size_t a = 3 * (size_t)spring->a, b = 3 * (size_t)spring->b;
        double d[3], square = 0.0;
        for (size_t k = 0; k < 3; k++)
            d[k] = (double)x[b + k] - (double)x[a + k], square += d[k] * d[k];
        for (size_t k = 0; k < 3; k++) {
            const double pull = spring->stiffness * (sqrt(square) - spring->length) * d[k] / sqrt(square);
            force[a + k] += pull;
            force[b + k] -= pull;
        }
    }
    for (uint32_t cell = 0; cell < net->cells; cell++)
        add_cell_force(net, cell, x, force);
}

static void difference(const double x[24], int from, int to, double d[3])
{
    for (int k = 0; k < 3; k++)
        d[k] = x[3 * to + k] - x[3 * from + k];
}

double net_cell_volume(const struct made_net *net, uint32_t cell, const float *x)
{
    /* Two triangles a face, wound outward. */
    static const int face[6][4] = { { 0, 4, 6, 2 }, { 1, 3, 7, 5 }, { 0, 1, 5, 4 },
                                    { 2, 6, 7, 3 }, { 0, 2, 3, 1 }, { 4, 5, 7, 6 } };
    double at[24], sum = 0.0, a[3], b[3], c[3];
    corners_at(net, cell, x, at);
    for (int f = 0; f < 6; f++)
        for (int half = 1; half < 3; half++) {
            difference(at, 0, face[f][0], a);
            difference(at, 0, face[f][half], b);
            difference(at, 0, face[f][half + 1], c);
            sum += triple(a, b, c) / 6.0;
        }
    return sum;
}

int net_cell_is_turned(const struct made_net *net, uint32_t cell, const float *x)
{
    double at[24], a[3], b[3], c[3];
    corners_at(net, cell, x, at);
    for (int corner = 0; corner < 8; corner++) {
        const int turns = (corner & 1) ^ (corner >> 1 & 1) ^ (corner >> 2);
        difference(at, corner, corner ^ 1, a);
        difference(at, corner, corner ^ 2, b);
        difference(at, corner, corner ^ 4, c);
        if (!((turns ? -1.0 : 1.0) * triple(a, b, c) > 0.0))
            return 1;
    }
    return 0;
}
