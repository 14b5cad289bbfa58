/* SPDX-License-Identifier: BSD-3-Clause */
/* Masses and springs: the def, its regions, what is fixed, and the layout in the file (docs/algorithms/springs.md). */
#include "compile/spring_build.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/return_if_error.h"
#include "base/sized.h"
#include "base/vec3.h"
#include "compile/soup.h"
#include "mesh/spring_net.h"

static const source_location nowhere = { 0, 0 };

static const dpt_spring_net_def spring_defaults = {
    .young = 5000.0, .density = 1000.0, .thickness = 1e-3, .poisson = 0.25
};

void dpt_spring_net_def_defaults(dpt_spring_net_def *def, size_t size)
{
    sized_defaults(def, size, &spring_defaults, sizeof spring_defaults);
}

static int is_in(double value, double max)
{
    return value >= 0.0 && value <= max;
}

dpt_result springs_check_region(const struct compile_context *context, const dpt_spring_region *region, uint32_t number,
                                source_location location)
{
    const double far = 2.0 * DPT_COORDINATE_MAX, *box = region->box;
    int good = region->kind == DPT_REGION_BOX || region->kind == DPT_REGION_SPHERE;
    if (!good || region->fixed > 1)
        return compile_fail(context, DPT_E_ARGUMENT, location, "region %u is of no known kind", number);
    for (int k = 0; k < 3; k++)
        good &= within(box[k], far) && within(box[3 + k], far) &&
                (region->kind == DPT_REGION_SPHERE || box[k] <= box[3 + k]);
    if (!good || (region->kind == DPT_REGION_SPHERE && !(box[3] > 0.0)))
        return compile_fail(context, DPT_E_ARGUMENT, location, "region %u is empty, or too far", number);
    if (region->fixed)
        return DPT_OK;
    if (!(region->young > 0.0 && region->young <= 1e12))
        return compile_fail(context, DPT_E_ARGUMENT, location,
                            "region %u: Young's modulus must be above 0, at most 1e12 Pa", number);
    if (!(region->density > 0.0 && region->density <= 1e9))
        return compile_fail(context, DPT_E_ARGUMENT, location,
                            "region %u: the density must be above 0, at most 1e9 kg/m^3", number);
    if (!is_in(region->drag, 1e9))
        return compile_fail(context, DPT_E_ARGUMENT, location, "region %u: the drag must be 0 to 1e9 1/s", number);
    return DPT_OK;
}

/* A sheet's Poisson's ratio is that of its springs, whatever the def's default says. */
static dpt_result check_poisson(const struct compile_context *context, dpt_spring_net_def *def)
{
    const double usual = spring_defaults.poisson;
    if (def->poisson == 0.0)
        def->poisson = usual;
    if (!(def->poisson >= CELL_POISSON_MIN && def->poisson <= CELL_POISSON_MAX))
        return compile_fail(context, DPT_E_ARGUMENT, nowhere, "Poisson's ratio must be %g to %g", CELL_POISSON_MIN,
                            CELL_POISSON_MAX);
    if (def->kind == DPT_NET_SHEET && def->poisson != usual)
        return compile_fail(context, DPT_E_ARGUMENT, nowhere, "Poisson's ratio of a sheet is 1/3, it cannot be chosen");
    return DPT_OK;
}

dpt_result springs_check(const struct compile_context *context, dpt_spring_net_def *def)
{
    const struct {
        const char *name;
        double *value, usual, max;
    } numbers[] = {
        { "Young's modulus", &def->young, spring_defaults.young, 1e12 },
        { "density", &def->density, spring_defaults.density, 1e9 },
        { "thickness", &def->thickness, spring_defaults.thickness, 1e6 },
        { "drag", &def->drag, 0.0, 1e9 },
        { "viscosity", &def->viscosity, 0.0, 1e9 },
        { "Young's modulus of bending", &def->bending, 0.0, 1e12 },
        { "spacing", &def->spacing, 0.0, 1e6 },
    };
    if (def->kind != DPT_NET_SHEET && def->kind != DPT_NET_VOLUME)
        return compile_fail(context, DPT_E_ARGUMENT, nowhere, "no such kind of springs");
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        if (!is_in(*numbers[i].value, numbers[i].max))
            return compile_fail(context, DPT_E_ARGUMENT, nowhere, "the %s must be 0 to %g", numbers[i].name,
                                numbers[i].max);
        if (*numbers[i].value == 0.0)
            *numbers[i].value = numbers[i].usual;
    }
    DPT_TRY(check_poisson(context, def));
    if ((def->region_count && !def->regions) || (def->fixed_count && !def->fixed))
        return compile_fail(context, DPT_E_ARGUMENT, nowhere, "no regions or no fixed vertices");
    for (uint32_t i = 0; i < def->region_count; i++)
        DPT_TRY(springs_check_region(context, &def->regions[i], i + 1, nowhere));
    return DPT_OK;
}

static int is_within(const dpt_spring_region *region, const double x[3])
{
    const double *box = region->box;
    if (region->kind == DPT_REGION_SPHERE) {
        const vec3 off = sub(vec3_of(x), vec3_of(box));
        return dot(off, off) <= box[3] * box[3];
    }
    for (int k = 0; k < 3; k++)
        if (!(x[k] >= box[k] && x[k] <= box[3 + k]))
            return 0;
    return 1;
}

struct material spring_material(struct net *net, const double x[3])
{
    const dpt_spring_net_def *def = net->def;
    struct material material = { def->young, def->density, def->drag };
    for (uint32_t i = 0; i < def->region_count; i++) {
        const dpt_spring_region *region = &def->regions[i];
        if (region->fixed || !is_within(region, x))
            continue;
        net->is_used[i] = 1;
        material = (struct material){ region->young, region->density, region->drag };
    }
    return material;
}

dpt_result spring_add(struct net *net, uint32_t a, uint32_t b, double stiffness)
{
    if (net->share_count == UINT32_MAX)
        return compile_fail(net->source->context, DPT_E_LIMIT, nowhere, "more springs than can be numbered");
    if (net->share_count == net->share_capacity) {
        struct spring_share *grown = grow_array(net->shares, &net->share_capacity, net->share_count + 1, sizeof *grown);
        if (!grown)
            return compile_fail(net->source->context, DPT_E_MEMORY, nowhere, "memory ran out");
        net->shares = grown;
    }
    net->shares[net->share_count] = (struct spring_share){
        .low = a < b ? a : b, .high = a < b ? b : a, .order = (uint32_t)net->share_count, .stiffness = stiffness
    };
    net->share_count++;
    return DPT_OK;
}

static void fix_regions(struct net *net, uint8_t *is_fixed)
{
    for (uint32_t i = 0; i < net->def->region_count; i++)
        for (uint32_t v = 0; v < net->node_count && net->def->regions[i].fixed; v++) {
            double x[3];
            vec3_store(vec3_of_float(net->rest + 3 * (size_t)v), x);
            if (is_within(&net->def->regions[i], x))
                is_fixed[v] = net->is_used[i] = 1;
        }
}

/* Vertices by position, then by number, for the search of those that were joined. */
struct placed {
    float x[3];
    uint32_t vertex;
};

static int compare_places(const float a[3], const float b[3])
{
    for (int k = 0; k < 3; k++)
        if (a[k] != b[k])
            return a[k] < b[k] ? -1 : 1;
    return 0;
}

static int compare_placed(const void *a, const void *b)
{
    return compare_places(((const struct placed *)a)->x, ((const struct placed *)b)->x);
}

static int compare_place(const void *x, const void *placed)
{
    return compare_places((const float *)x, ((const struct placed *)placed)->x);
}

/* Fix a vertex of the model: its node, or the nodes that move it. */
static void fix_vertex(const struct model *model, uint32_t v, uint8_t *is_fixed)
{
    if (!model->embedding_nodes)
        is_fixed[v] = 1;
    for (size_t k = 4 * (size_t)v; model->embedding_nodes && k < 4 * (size_t)v + 4; k++)
        if (model->embedding_weights[k] != 0.0f)
            is_fixed[model->embedding_nodes[k]] = 1;
}

/* Fix the vertex of the model at the position of one of the source's vertices. placed: the model's, in order. */
static dpt_result fix_source_vertex(const struct net *net, const struct model *model, const struct placed *placed,
                                    uint32_t number, uint8_t *is_fixed)
{
    const soup *source = net->source;
    if (number >= source->vertex_count)
        return compile_fail(source->context, DPT_E_INDEX, nowhere, "vertex %u is to be fixed, and there are only %zu",
                            number, source->vertex_count);
    const struct placed *found =
        bsearch(source->positions + 3 * (size_t)number, placed, model->vertex_count, sizeof *placed, compare_place);
    if (!found)
        return compile_fail(source->context, DPT_E_ARGUMENT, nowhere,
                            "vertex %u is to be fixed, and no triangle uses it", number);
    fix_vertex(model, found->vertex, is_fixed);
    return DPT_OK;
}

/* Fix the def's vertices. The source's vertices at one position are one vertex of the model. */
static dpt_result fix_vertices(struct net *net, const struct model *model, uint8_t *is_fixed)
{
    const dpt_spring_net_def *def = net->def;
    dpt_result result = DPT_OK;
    if (!def->fixed_count)
        return DPT_OK;
    struct placed *placed = compile_alloc(net->source->context, model->vertex_count, sizeof *placed);
    if (!placed)
        return DPT_E_MEMORY;
    for (uint32_t v = 0; v < model->vertex_count; v++) {
        memcpy(placed[v].x, model->positions + 3 * (size_t)v, sizeof placed[v].x);
        placed[v].vertex = v;
    }
    qsort(placed, model->vertex_count, sizeof *placed, compare_placed);
    for (uint32_t i = 0; i < def->fixed_count && result == DPT_OK; i++)
        result = fix_source_vertex(net, model, placed, def->fixed[i], is_fixed);
    free(placed);
    return result;
}

/* The nodes that do not move; and no region is in vain. */
static dpt_result fix(struct net *net, const struct model *model, uint8_t *is_fixed)
{
    uint32_t fixed = 0;
    fix_regions(net, is_fixed);
    for (uint32_t i = 0; i < net->def->region_count; i++)
        if (!net->is_used[i])
            return compile_fail(net->source->context, DPT_E_ARGUMENT, nowhere,
                                "region %u holds nothing of the body: a triangle or a cell is where its centre is",
                                i + 1);
    DPT_TRY(fix_vertices(net, model, is_fixed));
    for (uint32_t v = 0; v < net->node_count; v++)
        fixed += is_fixed[v];
    if (fixed == net->node_count)
        return compile_fail(net->source->context, DPT_E_ARGUMENT, nowhere, "all of the body is fixed");
    return DPT_OK;
}

static dpt_result add_springs(struct net *net, struct model *model, const struct spring_lattice *lattice,
                              uint8_t *is_fixed)
{
    memset(net->mass, 0, net->node_count * sizeof *net->mass);
    memset(net->is_used, 0, net->def->region_count);
    memset(is_fixed, 0, net->node_count);
    DPT_TRY(lattice ? spring_lattice_springs(net, lattice) : sheet_springs(net, model));
    DPT_TRY(fix(net, model, is_fixed));
    return spring_lay_out(net, model, is_fixed);
}

/* With the nodes in place: masses, springs, what is fixed, and the layout. lattice: NULL for a sheet. */
static dpt_result finish(struct net *net, struct model *model, const struct spring_lattice *lattice)
{
    net->mass = compile_alloc(net->source->context, net->node_count, sizeof *net->mass);
    net->is_used = compile_alloc(net->source->context, net->def->region_count, 1);
    uint8_t *is_fixed = compile_alloc(net->source->context, net->node_count, 1);
    const dpt_result result =
        net->mass && net->is_used && is_fixed ? add_springs(net, model, lattice, is_fixed) : DPT_E_MEMORY;
    free(net->mass);
    free(net->is_used);
    free(net->shares);
    free(net->cell_bound);
    free(net->cell_nodes);
    free(net->cell_stiffness);
    free(is_fixed);
    return result;
}

static dpt_result lattice_net(struct net *net, struct model *model, soup *source, struct spring_lattice *lattice)
{
    DPT_TRY(spring_lattice_make(lattice, model, source, net->def->spacing));
    DPT_TRY(spring_lattice_embed(lattice, model, source));
    net->node_count = lattice->node_count;
    net->rest = lattice->rest;
    net->grid = lattice->grid;
    model->poisson = net->def->poisson;
    DPT_TRY(finish(net, model, lattice));
    model->spring_rest = lattice->rest;
    lattice->rest = NULL;
    return DPT_OK;
}

dpt_result model_springs(struct model *model, soup *source)
{
    const dpt_compile_def *given = source->context->def;
    const dpt_spring_net_def *def = given ? given->springs : NULL;
    struct net net = { .def = def, .source = source };
    if (!def)
        return DPT_OK;
    model->viscosity = def->viscosity;
    if (def->kind == DPT_NET_SHEET) {
        net.node_count = model->vertex_count;
        net.rest = model->positions;
        model->poisson = 1.0 / 3.0;
        return finish(&net, model, NULL);
    }
    struct spring_lattice lattice = { .share = NULL };
    const dpt_result result = lattice_net(&net, model, source, &lattice);
    spring_lattice_free(&lattice);
    return result;
}
