/* SPDX-License-Identifier: BSD-3-Clause */
/* Springs (springs.h): docs/algorithms/springs.md. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "base/return_if_error.h"
#include "base/sized.h"
#include "deform/active_region.h"
#include "deform/cell_volume.h"
#include "deform/loaded_step.h"
#include "deform/spring_step.h"
#include "deform/spring_vertices.h"
#include "deform/springs_net.h"
#include "mesh/mesh_format.h"

#define GRAVITY_MAX 1e6
#define SCALE_MIN   1e-9
#define SCALE_MAX   1e9
#define CONTACT_MAX 1e12
#define SLEEP_MAX   1e6
#define ITERATIONS  1024u
#define COUNT_MAX   65535u
#define LOADS_MAX   (1u << 24)
#define BLOCK_ALIGN 64u

typedef char first_release[sizeof(dpt_springs_def) % 8 == 0 ? 1 : -1];

void dpt_springs_def_defaults(dpt_springs_def *def, size_t size)
{
    const dpt_springs_def defaults = {
        .max_loads = 4096, .stiffness = 1.0, .sleep_speed = 1e-3, .sleep_steps = 64, .iterations = 2, .max_substeps = 16
    };
    sized_defaults(def, size, &defaults, sizeof defaults);
}

static int is_in(double value, double low, double high)
{
    return value >= low && value <= high;
}

dpt_result dpti_springs_read_def(const dpt_springs_def *given, dpt_springs_def *def)
{
    if (!given)
        return DPT_E_ARGUMENT;
    dpt_springs_def_init(def);
    DPT_TRY(sized_read(given, SIZED_FIRST(dpt_springs_def, min_substeps), def, sizeof *def));
    const double real[] = { def->gravity[0], def->gravity[1],  def->gravity[2],
                            def->stiffness,  def->sleep_speed, def->contact_stiffness };
    for (size_t i = 0; i < sizeof real / sizeof *real; i++)
        if (!(fabs(real[i]) <= DBL_MAX))
            return DPT_E_FINITE;
    for (int k = 0; k < 3; k++)
        if (!is_in(def->gravity[k], -GRAVITY_MAX, GRAVITY_MAX))
            return DPT_E_ARGUMENT;
    const uint32_t substeps = def->integrator == DPT_INTEGRATOR_IMPLICIT ? COUNT_MAX : def->max_substeps;
    if (def->reserved || def->reserved_pointer || def->reserved_word || def->min_substeps > substeps ||
        def->max_loads < 1 || def->max_loads > LOADS_MAX || def->integrator > DPT_INTEGRATOR_IMPLICIT ||
        !is_in(def->stiffness, SCALE_MIN, SCALE_MAX) || !is_in(def->contact_stiffness, 0.0, CONTACT_MAX) ||
        !is_in(def->sleep_speed, 0.0, SLEEP_MAX) || def->sleep_steps < 2 || def->sleep_steps > COUNT_MAX ||
        def->iterations < 1 || def->iterations > ITERATIONS || def->max_substeps < 1 || def->max_substeps > COUNT_MAX)
        return DPT_E_ARGUMENT;
    return DPT_OK;
}

/* Takes `count` items of `size` bytes from a block, or only counts them if the block is NULL. */
struct block {
    char *base;
    uint64_t used;
};

static void *take(struct block *block, uint64_t count, size_t size)
{
    char *at = block->base ? block->base + block->used : NULL;
    block->used += (count * size + BLOCK_ALIGN - 1) / BLOCK_ALIGN * BLOCK_ALIGN;
    return at;
}

static void place_vertices(struct dpt_springs *springs, struct block *block)
{
    const struct dpt_mesh *mesh = springs->def.mesh;
    struct spring_vertices *vertices = &springs->vertices;
    const uint64_t links = dpti_spring_links(mesh), groups = mesh_slices(mesh->vertices);
    vertices->first = take(block, links ? groups + 1 : 0, sizeof(uint32_t));
    vertices->slices = take(block, links, sizeof(uint32_t));
    vertices->points = take(block, links ? SPRING_POINTS * (uint64_t)springs->net.slices : 0, sizeof(float));
    vertices->moved = take(block, springs->net.slices, 1);
    vertices->list = take(block, mesh->vertices, sizeof(uint32_t));
    vertices->positions = take(block, 3 * LANES * groups + 1, sizeof(float));
    vertices->loads = take(block, springs->def.max_loads, sizeof(dpt_load));
    springs->contact.fixed = take(block, springs->net.slices, sizeof(uint16_t));
    springs->contact.next = take(block, springs->net.slices, sizeof(uint16_t));
    springs->contact.moved = take(block, springs->net.slices, 1);
}

static void place_volumes(struct dpt_springs *springs, struct block *block)
{
    const struct spring_net *net = &springs->net;
    struct cell_volumes *volumes = &springs->volumes;
    volumes->pulls = take(block, net->cell_slices * (uint64_t)CELL_PULLS + SPRING_POINTS, sizeof(float));
    volumes->places = take(block, net->slices * (uint64_t)CELL_CORNERS, sizeof(uint32_t));
    volumes->first = take(block, (uint64_t)net->cell_slices + 1, sizeof(uint32_t));
    volumes->slices = take(block, dpti_cells_corner_slices(net), sizeof(uint32_t));
    volumes->active = take(block, net->cell_slices, sizeof(uint32_t));
    volumes->bound = take(block, LANES * (uint64_t)net->first[net->slices], sizeof(float));
    if (springs->def.integrator == DPT_INTEGRATOR_IMPLICIT)
        volumes->energy = take(block, net->cell_slices, sizeof(double));
}

static void place(struct dpt_springs *springs, struct block *block)
{
    const uint64_t slices = springs->net.slices;
    struct active_region *region = &springs->region;
    struct spring_solve *solve = &springs->solve;
    springs->nodes = take(block, slices, sizeof *springs->nodes);
    for (int i = 0; i < 2; i++) {
        springs->state[i] = take(block, slices, sizeof *springs->state[i]);
        springs->points[i] = take(block, slices * SPRING_POINTS, sizeof(float));
        springs->loads[i].force = take(block, slices * SPRING_ROWS, sizeof(float));
        springs->loads[i].marked = take(block, slices, 1);
        springs->loads[i].slices = take(block, slices, sizeof(uint32_t));
    }
    region->slices = take(block, slices, sizeof(uint32_t));
    region->is_awake = take(block, slices, 1);
    region->is_fixed = take(block, slices, 1);
    region->quiet = take(block, slices, sizeof *region->quiet);
    region->square = take(block, slices, sizeof(float));
    region->drag = take(block, slices, sizeof(float));
    region->first = take(block, slices + 1, sizeof(uint32_t));
    region->neighbours = take(block, dpti_slice_neighbours_count(&springs->net), sizeof(uint32_t));
    region->is_told = take(block, slices, 1);
    region->told = take(block, slices * SPRING_ROWS, sizeof(float));
    region->held = take(block, slices * SPRING_ROWS, sizeof(float));
    if (springs->def.mesh)
        place_vertices(springs, block);
    if (springs->net.cells)
        place_volumes(springs, block);
    if (springs->def.integrator != DPT_INTEGRATOR_IMPLICIT) {
        springs->forces = take(block, slices * SPRING_ROWS, sizeof(float));
        springs->is_forced = take(block, slices, 1);
        return;
    }
    solve->systems = take(block, slices, sizeof *solve->systems);
    solve->force = take(block, slices * SPRING_ROWS, sizeof(float));
    solve->product = take(block, slices * SPRING_ROWS, sizeof(float));
    solve->direction = take(block, slices * SPRING_POINTS, sizeof(float));
    solve->is_near = take(block, slices, 1);
    solve->near = take(block, slices, sizeof(uint32_t));
    solve->stiffness = take(block, slices * LANES, sizeof(float));
    solve->begin = take(block, slices, sizeof *solve->begin);
    solve->energy = take(block, slices, sizeof(double));
}

size_t dpti_springs_net_bytes(const dpt_springs_def *def, const struct spring_net *net)
{
    struct dpt_springs springs = { .net = *net, .def = *def };
    struct block block = { .base = NULL };
    place(&springs, &block);
    block.used += sizeof springs + BLOCK_ALIGN;
    return net->nodes && block.used <= SIZE_MAX ? (size_t)block.used : 0;
}

static void begin_masses(struct dpt_springs *springs)
{
    const struct spring_net *net = &springs->net;
    for (uint32_t node = 0; node < net->nodes; node++) {
        struct spring_nodes *nodes = springs->nodes + node / LANES;
        nodes->per_mass[node % LANES] = net->mass[node] > 0.0f ? 1.0f / net->mass[node] : 0.0f;
        nodes->drag[node % LANES] = net->drag[node];
    }
}

static void begin_nodes(struct dpt_springs *springs)
{
    const struct spring_net *net = &springs->net;
    for (uint32_t node = 0; node < net->nodes; node++)
        for (uint32_t row = 0; row < 3; row++)
            springs->state[0][node / LANES].x[LANES * row + node % LANES] = net->rest[3 * (size_t)node + row];
    memcpy(springs->state[1], springs->state[0], net->slices * sizeof *springs->state[0]);
    for (size_t slice = 0; slice < net->slices; slice++)
        for (int i = 0; i < 2; i++)
            springs->kernel.spring_points(springs->state[0] + slice, 0.0f, springs->points[i] + SPRING_POINTS * slice);
}

dpt_result dpti_springs_create_net(void *block, size_t bytes, const dpt_springs_def *given,
                                   const struct spring_net *net, dpt_springs **springs)
{
    dpt_springs_def def;
    struct kernel kernel;
    uint32_t chosen;
    if (!block || !springs)
        return DPT_E_ARGUMENT;
    DPT_TRY(dpti_springs_read_def(given, &def));
    const size_t needed = dpti_springs_net_bytes(&def, net);
    if (!needed)
        return DPT_E_ARGUMENT;
    if ((uintptr_t)block % 8)
        return DPT_E_ALIGN;
    if (bytes < needed)
        return DPT_E_MEMORY;
    if (!dpti_kernel_get(def.kernel, &kernel, &chosen))
        return DPT_E_UNSUPPORTED;
    memset(block, 0, needed);
    struct dpt_springs *made = block;
    char *base = (char *)block + sizeof *made;
    base += (BLOCK_ALIGN - (uintptr_t)base % BLOCK_ALIGN) % BLOCK_ALIGN;
    struct block rest = { .base = base };
    made->net = *net;
    made->def = def;
    made->kernel = kernel;
    made->rows = (struct spring_rows){ net->first, net->neighbour, net->stiffness, net->length };
    made->bound = made->rows;
    made->lead = net->viscosity;
    place(made, &rest);
    begin_masses(made);
    if (net->cells)
        dpti_cells_begin(made);
    dpti_springs_find_step(made);
    begin_nodes(made);
    if (def.mesh)
        dpti_spring_vertices_begin(made);
    dpti_region_begin(made);
    if (def.integrator == DPT_INTEGRATOR_IMPLICIT)
        dpti_implicit_begin(made);
    *springs = made;
    return DPT_OK;
}

size_t dpt_springs_bytes(const dpt_springs_def *given)
{
    dpt_springs_def def;
    struct spring_net net;
    return dpti_springs_read_def(given, &def) == DPT_OK && def.mesh && mesh_spring_net(def.mesh, &net)
               ? dpti_springs_net_bytes(&def, &net)
               : 0;
}

dpt_result dpt_springs_create(void *block, size_t bytes, const dpt_springs_def *given, dpt_springs **springs)
{
    dpt_springs_def def;
    struct spring_net net;
    DPT_TRY(dpti_springs_read_def(given, &def));
    if (!def.mesh)
        return DPT_E_ARGUMENT;
    return mesh_spring_net(def.mesh, &net) ? dpti_springs_create_net(block, bytes, &def, &net, springs)
                                           : DPT_E_UNSUPPORTED;
}

uint32_t dpt_springs_get_count(const dpt_springs *springs)
{
    return springs ? springs->net.nodes : 0;
}

double dpt_springs_get_stable_step(const dpt_springs *springs)
{
    return springs ? springs->stable_step : 0.0;
}

static dpt_result check_loads(const struct dpt_springs *springs, const dpt_load *loads, uint32_t count)
{
    if (count && !loads)
        return DPT_E_ARGUMENT;
    for (uint32_t i = 0; i < count; i++) {
        if (loads[i].vertex >= springs->net.nodes || loads[i].reserved)
            return DPT_E_ARGUMENT;
        for (int k = 0; k < 3; k++)
            if (!is_in(loads[i].force[k], -SPRING_LOAD_MAX, SPRING_LOAD_MAX))
                return DPT_E_FINITE;
    }
    return DPT_OK;
}

dpt_result dpti_springs_check_step(double dt, const dpt_springs_info *info)
{
    if (info)
        DPT_TRY(sized_check(info, SIZED_FIRST(dpt_springs_info, result), 0));
    if (!(fabs(dt) <= DBL_MAX))
        return DPT_E_FINITE;
    if (!(dt >= DPT_SPRINGS_STEP_MIN && dt <= DPT_SPRINGS_STEP_MAX))
        return DPT_E_ARGUMENT;
    return DPT_OK;
}

static dpt_result check_step(const struct dpt_springs *springs, double dt, const dpt_load *loads, uint32_t count,
                             const dpt_springs_info *info)
{
    if (!springs)
        return DPT_E_ARGUMENT;
    DPT_TRY(dpti_springs_check_step(dt, info));
    return dpti_springs_substeps_of(springs, dt) ? check_loads(springs, loads, count) : DPT_E_UNSTABLE;
}

dpt_result dpt_springs_step(dpt_springs *springs, double dt, const dpt_load *loads, uint32_t count,
                            dpt_springs_info *info)
{
    DPT_TRY(check_step(springs, dt, loads, count, info));
    struct loaded_step step;
    if (!dpti_loaded_step_make(&step, springs, dt, loads, count, NULL)) {
        dpti_loaded_step_undo(&step);
        return DPT_E_FINITE;
    }
    dpti_loaded_step_take(&step);
    dpti_loaded_step_keep(&step);
    if (info)
        sized_write(info, info->size, &step.info, sizeof step.info);
    return DPT_OK;
}

dpt_result dpt_springs_foresee(dpt_springs *springs, double dt, const dpt_load *loads, uint32_t load_count,
                               uint32_t count, float *positions)
{
    if (!springs || !positions || count != springs->net.nodes)
        return DPT_E_ARGUMENT;
    DPT_TRY(check_step(springs, dt, loads, load_count, NULL));
    struct loaded_step step;
    const struct spring_solve solve = springs->solve;
    const int is_done = dpti_loaded_step_make(&step, springs, dt, loads, load_count, NULL);
    if (is_done)
        dpt_springs_get_nodes(springs, count, positions, NULL);
    dpti_loaded_step_undo(&step);
    if (springs->def.integrator == DPT_INTEGRATOR_IMPLICIT)
        dpti_implicit_return(springs, solve.account, solve.common);
    return is_done ? DPT_OK : DPT_E_FINITE;
}

dpt_result dpt_springs_get_nodes(const dpt_springs *springs, uint32_t count, float *positions, float *speeds)
{
    if (!springs || !positions || count != springs->net.nodes)
        return DPT_E_ARGUMENT;
    const struct spring_slice *state = springs->state[springs->now];
    for (uint32_t node = 0; node < count; node++)
        for (uint32_t row = 0; row < 3; row++) {
            const uint32_t at = LANES * row + node % LANES;
            positions[3 * (size_t)node + row] = state[node / LANES].x[at];
            if (speeds)
                speeds[3 * (size_t)node + row] = state[node / LANES].v[at];
        }
    return DPT_OK;
}

dpt_result dpt_springs_set_nodes(dpt_springs *springs, uint32_t first, uint32_t count, const float *positions,
                                 const float *speeds)
{
    if (!springs || first > springs->net.nodes || count > springs->net.nodes - first || (count && !positions))
        return DPT_E_ARGUMENT;
    for (size_t i = 0; i < 3 * (size_t)count; i++)
        if (!(fabsf(positions[i]) <= (float)DPT_COORDINATE_MAX) ||
            (speeds && !(fabsf(speeds[i]) <= (float)SPRING_FAST)))
            return DPT_E_FINITE;
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t slice = (first + i) / LANES, lane = (first + i) % LANES;
        struct spring_slice *state = springs->state[springs->now] + slice;
        const int moves = springs->nodes[slice].per_mass[lane] > 0.0f;
        for (uint32_t row = 0; row < 3; row++) {
            const uint32_t at = LANES * row + lane;
            state->x[at] = positions[3 * (size_t)i + row];
            state->rest[at] = 0.0f;
            state->v[at] = speeds && moves ? speeds[3 * (size_t)i + row] : 0.0f;
        }
        if (lane == LANES - 1 || i == count - 1) {
            springs->kernel.spring_points(state, (float)springs->lead,
                                          springs->points[springs->at] + SPRING_POINTS * (size_t)slice);
            dpti_region_disturb(springs, slice);
        }
    }
    dpti_region_list(springs);
    if (springs->def.integrator == DPT_INTEGRATOR_IMPLICIT)
        dpti_implicit_forget(springs);
    return DPT_OK;
}

dpt_result dpt_springs_get_energy(const dpt_springs *springs, double *elastic, double *kinetic)
{
    if (!springs || !elastic || !kinetic)
        return DPT_E_ARGUMENT;
    *elastic = 0.0;
    for (uint32_t slice = 0; slice < springs->net.slices; slice++)
        *elastic += dpti_springs_elastic(springs, slice);
    for (uint32_t slice = 0; slice < springs->net.cell_slices; slice++)
        *elastic += dpti_cells_elastic(springs, slice);
    *kinetic = dpti_springs_kinetic(springs);
    return DPT_OK;
}

/* Of a node by itself: what holds it are its mass, with drag, and its springs, with their viscosity. */
static double compliance_of(const struct dpt_springs *springs, uint32_t node, double dt)
{
    const struct spring_net *net = &springs->net;
    const uint32_t slice = node / LANES, lane = node % LANES;
    const double mass = (double)net->mass[node];
    double stiffness = 0.0;
    for (uint32_t entry = net->first[slice]; entry < net->first[slice + 1]; entry++)
        stiffness += (double)springs->bound.stiffness[LANES * (size_t)entry + lane];
    return mass > 0.0 ? 1.0 / (mass * (1.0 + dt * (double)net->drag[node]) / (dt * dt) +
                               (1.0 + net->viscosity / dt) * springs->def.stiffness * stiffness)
                      : 0.0;
}

dpt_result dpt_springs_get_compliances(const dpt_springs *springs, double dt, uint32_t count, float *compliances)
{
    if (!springs || !compliances || count != springs->def.mesh->vertices)
        return DPT_E_ARGUMENT;
    DPT_TRY(dpti_springs_check_step(dt, NULL));
    const struct spring_vertices *vertices = &springs->vertices;
    for (uint32_t v = 0; v < count; v++) {
        double sum = vertices->nodes ? 0.0 : compliance_of(springs, v, dt);
        for (size_t i = 4 * (size_t)v; vertices->nodes && i < 4 * (size_t)v + 4; i++)
            sum += (double)vertices->weights[i] * (double)vertices->weights[i] *
                   compliance_of(springs, vertices->nodes[i], dt);
        compliances[v] = (float)min_of(sum, DPT_COMPLIANCE_MAX);
    }
    return DPT_OK;
}
