/* SPDX-License-Identifier: BSD-3-Clause */
/* Deformable bodies that the nodes of a coarser mesh move: they follow as they are embedded, and loads go to the nodes. */
#include "fuzz/calls/deform_model.h"

/* A lattice of springs has other nodes; those are not moved here. */
enum { CELL_NODES = 4, LOADS_MAX = 256, GIVEN_SLOT = 2 };

/* How a body's mesh is embedded; no nodes if it is not, or there is no such body. */
struct embedding {
    const uint32_t *nodes;
    const float *weights;
    uint32_t count;
};

static struct embedding embedding_of(const struct model_body *body)
{
    struct embedding of = { .count = 0 };
    if (body && body->soft)
        dpt_mesh_get_embedding(body->subject->mesh, &of.nodes, &of.weights, &of.count);
    return of;
}

/* Mostly a body that has nodes. */
static uint32_t draw_id(struct scene *scene)
{
    for (uint32_t i = 0; i < scene->body_count && !draw_one_in(8); i++)
        if (embedding_of(&scene->body[i]).count == CELL_NODES)
            return scene->body[i].id;
    return draw_body_id(scene);
}

/* The cell of subjects.c, a little out of shape. */
static void draw_nodes(float *nodes)
{
    static const double rest[12] = { 0, 0, 0.4, 0.4, 0, -0.2, -0.2, 0.3, -0.2, -0.2, -0.3, -0.2 };
    const double off = draw_one_in(4) ? 0.0 : draw_one_in(20) ? 10.0 : 0.01;
    for (int k = 0; k < 12; k++)
        nodes[k] = (float)(rest[k] + draw_in(-off, off));
}

/* Where the vertices are to be; 0 if one of them is not in the box, -1 if that is a matter of rounding. */
static int follow_nodes(const struct model_body *body, const struct embedding *of, const float *nodes, float *positions)
{
    const struct soft *soft = body->soft;
    int is_inside = 1;
    for (uint32_t v = 0; v < body->subject->vertices; v++)
        for (uint32_t k = 0; k < 3; k++) {
            double sum = 0.0;
            for (uint32_t n = 4 * v; n < 4 * v + 4; n++)
                sum += (double)of->weights[n] * (double)nodes[3 * of->nodes[n] + k];
            const float x = positions[3 * v + k] = (float)sum;
            const float low = soft->wall_low[k], high = soft->wall_high[k];
            const float slack = 1e-6f;
            if (!(x >= low - slack && x <= high + slack))
                return 0;
            if (!(x >= low + slack && x <= high - slack))
                is_inside = -1;
        }
    return is_inside;
}

static void nodes_have_moved(struct model_body *body, const float *positions)
{
    struct soft *soft = body->soft;
    const size_t bytes = 3 * sizeof *positions * body->subject->vertices;
    met[MET_DEFORMED]++;
    soft->is_affine = 0;
    if (!(soft->def.period > 0.0)) {
        memcpy(soft->now, positions, bytes);
        return;
    }
    met[MET_ON_ITS_WAY]++;
    memcpy(soft->begin, soft->now, sizeof soft->begin);
    memcpy(soft->end, positions, bytes);
    soft->is_on_its_way = 1;
    soft->way = 0.0;
}

static void set_nodes(void)
{
    static float positions[3 * VERTICES_MOST];
    struct scene *scene = draw_scene();
    if (!scene)
        return;
    const uint32_t id = draw_id(scene);
    struct model_body *body = scene_body(scene, id);
    const struct embedding of = embedding_of(body);
    const int no_world = draw_one_in(60), no_nodes = draw_one_in(60);
    float *nodes = output_of(GIVEN_SLOT, 12 * sizeof *nodes);
    struct codes codes = { .count = 0 };
    dpt_result result = DPT_OK;
    if (of.count && of.count != CELL_NODES)
        return;
    draw_nodes(nodes);
    const int is_inside = of.count ? follow_nodes(body, &of, nodes, positions) : 1;
    may_fail(&codes, no_world || no_nodes, DPT_E_ARGUMENT);
    may_fail(&codes, !body || !body->soft, DPT_E_HANDLE);
    may_fail(&codes, body && body->soft && !of.count, DPT_E_UNSUPPORTED);
    codes.or_done = !codes.count && is_inside < 0;
    may_fail(&codes, is_inside != 1, DPT_E_FINITE);
    call_with("scene %llu, id %llx", (uint64_t)(scene - scenes), id, 0, 0);
    EACH_WORLD(scene, i)
    SAME_RESULT(i, result, RESULT(dpt_body_set_nodes, world_or_null(scene, i, no_world), id, no_nodes ? NULL : nodes));
    expect(result, &codes);
    outputs_are_guarded(GIVEN_SLOT, 1);
    if (result == DPT_OK)
        nodes_have_moved(body, positions);
    if (body && body->soft)
        soft_must_be_there(scene, body);
}

/* The sum of forces, over loads on vertices or on nodes. */
static void sum_forces(const dpt_load *loads, uint32_t count, double sum[3], double *size)
{
    for (uint32_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) {
            sum[k] += loads[i].force[k];
            *size += fabs(loads[i].force[k]);
        }
}

static void get_node_loads(void)
{
    static dpt_load vertex_loads[LOADS_MAX];
    struct scene *scene = draw_scene();
    if (!scene)
        return;
    const uint32_t id = draw_id(scene);
    const struct model_body *body = scene_body(scene, id);
    const struct embedding of = embedding_of(body);
    const int no_world = draw_one_in(60), no_count = draw_one_in(60);
    uint32_t all = 0, count[2] = { 77, 77 };
    struct codes codes = { .count = 0 };
    dpt_result result = DPT_OK;
    if (of.count && of.count != CELL_NODES)
        return;
    const int is_known = of.count && dpt_body_get_loads(scene->world[0], id, vertex_loads, LOADS_MAX, &all) == DPT_OK;
    const uint32_t capacity = draw_one_in(3) || !is_known ? draw_below(4 * LOADS_MAX) : 4 * all + draw_below(4);
    may_fail(&codes, no_world || no_count, DPT_E_ARGUMENT);
    may_fail(&codes, !body || !body->soft, DPT_E_HANDLE);
    may_fail(&codes, body && body->soft && !of.count, DPT_E_UNSUPPORTED);
    may_fail(&codes, of.count && (!is_known || 4 * all > capacity), DPT_E_FULL);
    call_with("scene %llu, id %llx, capacity %llu", (uint64_t)(scene - scenes), id, capacity, 0);
    EACH_WORLD(scene, i)
    {
        dpt_load *out = output_of(i, capacity * sizeof *out);
        SAME_RESULT(i, result,
                    RESULT(dpt_body_get_node_loads, world_or_null(scene, i, no_world), id, out, capacity,
                           no_count ? NULL : &count[i]));
    }
    expect(result, &codes);
    outputs_are_guarded(0, scene->world_count);
    if (result != DPT_OK)
        return;
    const dpt_load *loads = output_at(0);
    double sum[2][3] = { { 0.0 } }, size = 0.0;
    HOLDS(count[0] == 4 * all, "%u loads on nodes, %u on vertices", count[0], all);
    sum_forces(vertex_loads, all, sum[0], &size);
    sum_forces(loads, count[0], sum[1], &size);
    for (uint32_t i = 0; i < count[0]; i++)
        HOLDS(loads[i].vertex < of.count && !loads[i].reserved, "node %u", loads[i].vertex);
    for (int k = 0; k < 3; k++)
        HOLDS(fabs(sum[0][k] - sum[1][k]) <= 1e-6 * size, "%g N on nodes, %g on vertices", sum[1][k], sum[0][k]);
}

static const struct move moves[] = { { "set nodes", set_nodes, 8 },
                                     { "get node loads", get_node_loads, 6 },
                                     { NULL, NULL, 0 } };

const struct noun node_noun = { "node", NULL, NULL, moves };
