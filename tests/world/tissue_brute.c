/* SPDX-License-Identifier: BSD-3-Clause */
#include "world/tissue_brute.h"

#include "deform/spring_state.h"
#include "world/tissue_patch.h"
#include "world/tissue_triangle.h"

/* The share of a missing gap that is made good in a substep. */
#define RECOVERED 0.2

int brute_open(struct brute *brute, struct tissue_rig *tissue)
{
    memset(brute, 0, sizeof *brute);
    brute->tissue = tissue;
    brute->begin = calloc((size_t)TISSUE_BODIES * BRUTE_ROOM, sizeof *brute->begin);
    brute->end = calloc((size_t)TISSUE_BODIES * BRUTE_ROOM, sizeof *brute->end);
    brute->mine = calloc((size_t)TISSUE_BODIES * BRUTE_ROOM, sizeof *brute->mine);
    tissue_rig_open(tissue);
    return brute->begin && brute->end && brute->mine;
}

void brute_close(struct brute *brute)
{
    tissue_rig_close(brute->tissue);
    free(brute->begin);
    free(brute->end);
    free(brute->mine);
}

/* ---- pairs ---- */

/* m/N: of a body's own surface; 0: it is hard. */
static double yields_of(const struct brute *brute, uint32_t b)
{
    dpt_body_settings settings = { .size = sizeof settings };
    dpt_body_get_settings(brute->tissue->rig.world, brute->tissue->body[b].id, &settings);
    return settings.stiffness > 0.0 ? 1.0 / settings.stiffness : 0.0;
}

static void add_node(struct brute_pair *pair, uint32_t node, double weight)
{
    uint32_t i = 0;
    while (i < pair->count && pair->node[i] != node)
        i++;
    CHECK(i < BRUTE_NODES, "too many nodes");
    if (i == BRUTE_NODES)
        return;
    if (i == pair->count) {
        pair->node[i] = node;
        pair->weight[pair->count++] = 0.0;
    }
    pair->weight[i] += weight;
}

static void add_vertex(const struct brute *brute, struct brute_pair *pair, uint32_t vertex, double weight)
{
    const uint32_t *nodes;
    const float *weights;
    uint32_t node_count;
    dpt_mesh_get_embedding(brute->tissue->body[pair->body].mesh.mesh, &nodes, &weights, &node_count);
    if (!nodes)
        add_node(pair, vertex, weight);
    for (uint32_t m = 4 * vertex; nodes && m < 4 * vertex + 4; m++)
        add_node(pair, nodes[m], weight * (double)weights[m]);
}

/* A patch is that of the surface as it is, about the pair's point there; without one the corners take the load. */
static void find_nodes(struct brute *brute, struct brute_pair *pair, const uint32_t *corners, const double weight[3])
{
    const struct tissue_body *body = &brute->tissue->body[pair->body];
    uint32_t vertices = 0;
    if (!body->springs)
        return;
    tissue_vertices(brute->tissue, body, &vertices);
    const struct patch_vertex *patch =
        body->load_radius > 0.0 ? patch_at(brute->tissue, body, pair->q, pair->n, corners) : NULL;
    for (uint32_t i = 0; i < (patch ? vertices : 3); i++)
        if (!patch)
            add_vertex(brute, pair, corners[i], weight[i]);
        else if (patch[i].is_in)
            add_vertex(brute, pair, i, patch[i].weight);
}

void brute_without_spin(const struct brute *brute, uint32_t t, double turn[3])
{
    double ends[6], axis[3];
    pose_ends(&brute->proxy[t], &brute->tissue->tool[t].segment, ends);
    for (int k = 0; k < 3; k++)
        axis[k] = ends[3 + k] - ends[k];
    const double square = dot3(axis, axis), spin = square > 0.0 ? dot3(turn, axis) / square : 0.0;
    for (int k = 0; k < 3 && !(brute->hull && t == 0); k++)
        turn[k] -= spin * axis[k];
}

/* p on the tool, q on the triangle where it is foreseen, both in the world. */
static void add_pair(struct brute *brute, uint32_t t, uint32_t b, const double p[3], const double q[3], double radius,
                     const uint32_t *corners, double v[3][3])
{
    const struct tissue_tool *tool = &brute->tissue->tool[t];
    struct brute_pair pair = { .tool = t, .body = b };
    double arm[3], turn[3], centre[6], weight[3], moved[3] = { 0.0, 0.0, 0.0 };
    const double distance = apart(p, q);
    if (!(distance - radius < BRUTE_NEAR + BRUTE_PUSH * yields_of(brute, b)))
        return;
    weights_at(q, v, weight);
    for (int k = 0; k < 9; k++)
        moved[k % 3] += weight[k / 3] * brute->moved[k / 3][k % 3];
    pose_ends(&brute->proxy[t], &tool->segment, centre);
    for (int k = 0; k < 3; k++) {
        pair.q[k] = q[k] - moved[k];
        pair.n[k] = (p[k] - q[k]) / distance;
        arm[k] = p[k] - moved[k] - 0.5 * (centre[k] + centre[3 + k]);
    }
    for (uint32_t i = 0; i < brute->count; i++)
        if (brute->pair[i].tool == t && brute->pair[i].body == b && apart(brute->pair[i].q, pair.q) < 1e-11 &&
            apart(brute->pair[i].n, pair.n) < 1e-9)
            return;
    pair.gap = distance - radius - brute->clearance + dot3(pair.n, moved);
    cross3(arm, pair.n, turn);
    brute_without_spin(brute, t, turn);
    for (int k = 0; k < 3; k++) {
        pair.row[k] = pair.n[k];
        pair.row[3 + k] = tool->rho > 0.0 ? turn[k] / tool->rho : 0.0;
    }
    find_nodes(brute, &pair, corners, weight);
    CHECK(brute->count < BRUTE_PAIRS, "too many pairs");
    if (brute->count < BRUTE_PAIRS)
        brute->pair[brute->count++] = pair;
}

static void pairs_of_segment(struct brute *brute, uint32_t t, uint32_t b, const uint32_t *corners, double v[3][3])
{
    const dpt_segment *segment = &brute->tissue->tool[t].segment;
    double ends[6], p[3], q[3];
    pose_ends(&brute->proxy[t], segment, ends);
    const int is_ball = !(apart(ends, ends + 3) > 0.0);
    for (int end = 0; end < (is_ball ? 1 : 2); end++) {
        nearest_on_triangle(ends + 3 * end, v, q);
        add_pair(brute, t, b, ends + 3 * end, q, segment->radius, corners, v);
    }
    for (int k = 0; k < 3 && !is_ball; k++)
        if (nearest_of_segments(ends, ends + 3, v[k], v[(k + 1) % 3], p, q))
            add_pair(brute, t, b, p, q, segment->radius, corners, v);
}

/* A pair of two convex bodies that a plane across it parts, but for a lean by the sine 0.3. */
static int is_parted(const struct brute *brute, double corner[][3], const double p[3], const double q[3],
                     double v[3][3])
{
    const double distance = apart(p, q);
    for (uint32_t i = 0; i < brute->hull->corner_count + 3; i++) {
        const int of_hull = i < brute->hull->corner_count;
        const double *x = of_hull ? corner[i] : v[i - brute->hull->corner_count], *from = of_hull ? p : q;
        double rise = 0.0;
        for (int k = 0; k < 3; k++)
            rise += (x[k] - from[k]) * (q[k] - p[k]) * (of_hull ? 1.0 : -1.0);
        if (rise > 0.3 * apart(x, from) * distance)
            return 0;
    }
    return 1;
}

static void pairs_of_tip(struct brute *brute, uint32_t b, const uint32_t *corners, double v[3][3])
{
    const struct oracle_hull *hull = brute->hull;
    double corner[ORACLE_CORNERS][3], p[3], q[3];
    for (uint32_t i = 0; i < hull->corner_count; i++) {
        pose_point(&brute->proxy[0], hull->corner[i], corner[i]);
        nearest_on_triangle(corner[i], v, q);
        if (is_parted(brute, corner, corner[i], q, v))
            add_pair(brute, 0, b, corner[i], q, brute->hull_radius, corners, v);
    }
    for (uint32_t e = 0; e < hull->edge_count; e++)
        for (int k = 0; k < 3; k++)
            if (nearest_of_segments(corner[hull->edge[e][0]], corner[hull->edge[e][1]], v[k], v[(k + 1) % 3], p, q) &&
                is_parted(brute, corner, p, q, v))
                add_pair(brute, 0, b, p, q, brute->hull_radius, corners, v);
    for (uint32_t f = 0; f < hull->face_count; f++)
        for (uint32_t i = 1; i + 1 < hull->side_count[f]; i++)
            for (int k = 0; k < 3; k++) {
                double fan[3][3];
                memcpy(fan[0], corner[hull->side[f][0]], sizeof fan[0]);
                memcpy(fan[1], corner[hull->side[f][i]], sizeof fan[1]);
                memcpy(fan[2], corner[hull->side[f][i + 1]], sizeof fan[2]);
                nearest_on_triangle(v[k], fan, p);
                if (is_parted(brute, corner, p, v[k], v))
                    add_pair(brute, 0, b, p, v[k], brute->hull_radius, corners, v);
            }
}

static void pairs_of_body(struct brute *brute, uint32_t b, uint32_t t)
{
    static double moved[BRUTE_ROOM];
    const struct tissue_rig *tissue = brute->tissue;
    const struct tissue_body *body = &tissue->body[b];
    const int is_tip = t == 0 && brute->hull;
    uint32_t vertices = 0, triangles;
    const float *position = tissue_vertices(tissue, body, &vertices);
    const uint32_t *corners = tissue_corners(body, &triangles);
    memset(moved, 0, sizeof moved);
    if (brute->substeps)
        tissue_foresee(tissue, body, brute->substeps, is_tip ? brute->hull_radius : tissue->tool[t].segment.radius,
                       moved);
    for (uint32_t i = 0; i < triangles; i++) {
        double v[3][3];
        for (int k = 0; k < 9; k++) {
            const uint32_t at = 3 * corners[3 * i + (uint32_t)k / 3] + (uint32_t)k % 3;
            brute->moved[k / 3][k % 3] = moved[at];
            v[k / 3][k % 3] = (double)position[at] + moved[at] + body->place[k % 3];
        }
        if (is_tip)
            pairs_of_tip(brute, b, corners + 3 * i, v);
        else
            pairs_of_segment(brute, t, b, corners + 3 * i, v);
    }
}

void brute_find_pairs(struct brute *brute)
{
    brute->count = 0;
    for (uint32_t b = 0; b < brute->tissue->body_count; b++)
        for (uint32_t t = 0; t < brute->tissue->tool_count; t++)
            pairs_of_body(brute, b, t);
}

void brute_way_to(const struct brute *brute, uint32_t t, const dpt_pose *pose, double way[6])
{
    const struct tissue_tool *tool = &brute->tissue->tool[t];
    double from[6], to[6], turn[3] = { 0.0, 0.0, 0.0 };
    pose_ends(&brute->proxy[t], &tool->segment, from);
    pose_ends(pose, &tool->segment, to);
    if (brute->hull && t == 0) {
        const double *q = brute->proxy[t].orientation, back[4] = { q[0], -q[1], -q[2], -q[3] };
        double between[4];
        turn_times(pose->orientation, back, between);
        const double sine = length3(between + 1), angle = 2.0 * atan2(sine, fabs(between[0]));
        for (int k = 0; k < 3 && sine > 0.0; k++)
            turn[k] = copysign(angle, between[0]) * between[1 + k] / sine;
    } else if (tool->rho > 0.0) {
        double u[3], v[3];
        for (int k = 0; k < 3; k++) {
            u[k] = from[3 + k] - from[k];
            v[k] = to[3 + k] - to[k];
        }
        cross3(u, v, turn);
        const double sine = length3(turn), angle = atan2(sine, dot3(u, v));
        for (int k = 0; k < 3 && sine > 0.0; k++)
            turn[k] *= angle / sine;
    }
    for (int k = 0; k < 3; k++) {
        way[k] = 0.5 * (to[k] + to[3 + k] - from[k] - from[3 + k]);
        way[3 + k] = tool->rho * turn[k];
    }
}

/* ---- the problem ---- */

static double response_of(const struct tissue_body *body, uint32_t node, double h)
{
    dpt_mesh_springs net = { .size = sizeof net };
    dpt_mesh_get_springs(body->mesh.mesh, &net);
    const double mass = (double)net.mass[node];
    return mass > 0.0 ? h * h / (mass * (1.0 + h * (double)net.drag[node])) : 0.0;
}

/*
 * m/N: how the body's own surface yields at one pair to a push of another of the same tool: less with distance, and not
 * beyond the tool's thickness.
 */
static double yield_of(const struct brute *brute, const struct brute_pair *a, const struct brute_pair *b)
{
    const double thickness = 2.0 * brute->tissue->tool[a->tool].segment.radius;
    if (a->tool != b->tool || a->body != b->body)
        return 0.0;
    const double near = fmax(1.0 - apart(a->q, b->q) / thickness, 0.0);
    return near * near * dot3(a->n, b->n) * yields_of(brute, a->body);
}

static void make_matrix(struct brute *brute, double h)
{
    brute->loosest = 0.0;
    for (uint32_t i = 0; i < brute->count; i++) {
        struct brute_pair *pair = &brute->pair[i];
        for (uint32_t k = 0; k < pair->count; k++) {
            pair->response[k] = response_of(&brute->tissue->body[pair->body], pair->node[k], h);
            brute->loosest = fmax(brute->loosest, pair->response[k]);
        }
    }
    for (uint32_t i = 0; i < brute->count; i++)
        for (uint32_t j = 0; j < brute->count; j++) {
            const struct brute_pair *a = &brute->pair[i], *b = &brute->pair[j];
            double sum = 0.0;
            for (uint32_t k = 0; k < a->count && a->body == b->body; k++)
                for (uint32_t m = 0; m < b->count; m++)
                    if (a->node[k] == b->node[m])
                        sum += a->weight[k] * b->weight[m] * a->response[k] * dot3(a->n, b->n);
            if (a->tool == b->tool)
                sum += brute_product(a->row, b->row) / brute->tissue->tool[a->tool].stiffness;
            sum += yield_of(brute, a, b);
            brute->matrix[i][j] = sum;
        }
}

void brute_read_nodes(const struct tissue_rig *tissue, double *at)
{
    for (uint32_t b = 0; b < tissue->body_count; b++)
        if (tissue->body[b].springs)
            tissue_nodes(&tissue->body[b], at + BRUTE_ROOM * (size_t)b);
}

void brute_add_speeds(const struct tissue_rig *tissue, double h, double *at)
{
    static float positions[BRUTE_ROOM], speeds[BRUTE_ROOM];
    for (uint32_t b = 0; b < tissue->body_count; b++) {
        const struct tissue_body *body = &tissue->body[b];
        if (!body->springs || body->integrator != DPT_INTEGRATOR_EULER)
            continue;
        const uint32_t count = dpt_springs_get_count(body->springs);
        dpt_springs_get_nodes(body->springs, count, positions, speeds);
        for (uint32_t i = 0; i < 3 * count; i++)
            at[BRUTE_ROOM * (size_t)b + i] += h * (double)speeds[i];
    }
}

/* Keep the springs' memory, or put it back. */
static void keep(const struct tissue_rig *tissue, void **kept, int is_back)
{
    for (uint32_t b = 0; b < tissue->body_count; b++) {
        const struct tissue_body *body = &tissue->body[b];
        void *block = body->springs ? tissue->rig.blocks[body->block] : NULL;
        if (block && !is_back)
            memcpy(kept[b] = realloc(kept[b], body->bytes), block, body->bytes);
        else if (block)
            memcpy(block, kept[b], body->bytes);
    }
}

int brute_is_touched(const struct tissue_rig *tissue)
{
    for (uint32_t t = 0; t < tissue->tool_count; t++) {
        dpt_force_info info = { .size = sizeof info };
        dpt_tool_get_force_info(tissue->rig.world, tissue->tool[t].id, &info);
        if (info.reason == DPT_FORCE_ACTS)
            return 1;
    }
    return 0;
}

/* s: the viscosity of a body in a substep: SYMPLECTIC has three quarters of it where tools touch, no more than is stable. */
static double viscosity_of(const struct dpt_springs *springs, double h, int touched)
{
    const double wide = h / 0.9, stable = 0.5 * (4.0 / (springs->square * wide) - wide);
    if (springs->def.integrator != DPT_INTEGRATOR_SYMPLECTIC || !touched)
        return springs->net.viscosity;
    return fmax(springs->net.viscosity, fmin(0.75 * h, stable));
}

/* A body that no tool is near is stepped by itself. */
static int is_near(const struct brute *brute, uint32_t body)
{
    for (uint32_t i = 0; i < brute->count; i++)
        if (brute->pair[i].body == body)
            return 1;
    return 0;
}

static void step_by_hand(const struct brute *brute, double h, int is_loaded)
{
    const struct tissue_rig *tissue = brute->tissue;
    static dpt_load loads[BRUTE_PAIRS * BRUTE_NODES];
    for (uint32_t b = 0; b < tissue->body_count; b++) {
        uint32_t count = 0;
        for (uint32_t i = 0; i < brute->count && is_loaded; i++) {
            const struct brute_pair *pair = &brute->pair[i];
            for (uint32_t k = 0; k < pair->count && pair->body == b && pair->push > 0.0; k++) {
                loads[count].vertex = pair->node[k];
                for (int d = 0; d < 3; d++)
                    loads[count].force[d] = -pair->push * pair->weight[k] * pair->n[d];
                count++;
            }
        }
        struct dpt_springs *springs = tissue->body[b].springs;
        if (springs) {
            const double own = springs->net.viscosity;
            springs->net.viscosity = viscosity_of(springs, h, brute_is_touched(tissue) && is_near(brute, b));
            CHECK(dpt_springs_step(springs, h, loads, count, NULL) == DPT_OK, "not stepped");
            springs->net.viscosity = own;
        }
    }
}

double brute_surface_motion(const struct brute_pair *pair, const double *from, const double *to)
{
    double sum = 0.0;
    for (uint32_t k = 0; k < pair->count; k++)
        for (uint32_t d = 0; d < 3; d++) {
            const size_t i = BRUTE_ROOM * (size_t)pair->body + 3 * pair->node[k] + d;
            sum += pair->weight[k] * pair->n[d] * (to[i] - from[i]);
        }
    return sum;
}

/* What a pair does to its tool in a substep, of which there are as many as 1 / share. */
static void push_tool(struct brute *brute, const struct brute_pair *pair, double share)
{
    dpt_wrench *wrench = &brute->wrench[pair->tool];
    double arm[3], torque[3];
    for (int k = 0; k < 3; k++)
        arm[k] = pair->q[k] - brute->tissue->tool[pair->tool].device.position[k];
    cross3(arm, pair->n, torque);
    for (int k = 0; k < 3; k++) {
        wrench->force[k] += share * pair->push * pair->n[k];
        wrench->torque[k] += share * pair->push * torque[k];
    }
    CHECK(!(yields_of(brute, pair->body) > 0.0) || length3(wrench->force) <= BRUTE_PUSH, "%g N",
          length3(wrench->force));
    for (int k = 0; k < 6; k++)
        brute->way[pair->tool][k] += pair->push * pair->row[k] / brute->tissue->tool[pair->tool].stiffness;
}

/*
 * What a substep asks of each pair: with the tool where the last substep ended, and the surface before its loads act, less
 * than no gap may be left, by four fifths. What the surface itself yields is no part of it.
 */
static void find_least_gaps(struct brute *brute)
{
    for (uint32_t i = 0; i < brute->count; i++) {
        struct brute_pair *pair = &brute->pair[i];
        double now = pair->gap + brute_product(pair->row, brute->way[pair->tool]) -
                     brute_surface_motion(pair, brute->begin, brute->end);
        for (uint32_t k = 0; k < brute->count; k++)
            now += brute->pair[k].push > 0.0 ? brute->pair[k].push * yield_of(brute, pair, &brute->pair[k]) : 0.0;
        pair->least = (1.0 - RECOVERED) * fmin(now, 0.0);
    }
}

/* Gaps with the tools at their devices, and the surface where it would go without pushes. */
static void find_free_gaps(struct brute *brute)
{
    for (uint32_t t = 0; t < brute->tissue->tool_count; t++)
        brute_way_to(brute, t, &brute->tissue->tool[t].device, brute->way[t]);
    for (uint32_t i = 0; i < brute->count; i++) {
        struct brute_pair *pair = &brute->pair[i];
        pair->free_gap = pair->gap + brute_product(pair->row, brute->way[pair->tool]) -
                         brute_surface_motion(pair, brute->begin, brute->end) - pair->least;
    }
}

void brute_solve_tick(struct brute *brute, uint32_t substeps)
{
    struct tissue_rig *tissue = brute->tissue;
    const double h = tissue->rig.dt / substeps;
    void *whole[TISSUE_BODIES] = { NULL }, *before[TISSUE_BODIES] = { NULL };
    memset(brute->wrench, 0, sizeof brute->wrench);
    brute->clearance = tissue_clearance(tissue);
    for (uint32_t t = 0; t < tissue->tool_count; t++) {
        const dpt_pose end = tissue_tool_last_end(tissue, &tissue->tool[t]);
        dpt_tool_get_proxy(tissue->rig.world, tissue->tool[t].id, &brute->proxy[t]);
        brute_way_to(brute, t, &end, brute->way[t]);
    }
    brute->substeps = substeps;
    brute_find_pairs(brute);
    brute->substeps = 0;
    make_matrix(brute, h);
    keep(tissue, whole, 0);
    brute_read_nodes(tissue, brute->begin);
    for (uint32_t s = 0; s < substeps; s++) {
        brute_read_nodes(tissue, brute->end);
        brute_add_speeds(tissue, h, brute->end);
        find_least_gaps(brute);
        keep(tissue, before, 0);
        step_by_hand(brute, h, 0);
        brute_read_nodes(tissue, brute->end);
        brute_add_speeds(tissue, h, brute->end);
        keep(tissue, before, 1);
        find_free_gaps(brute);
        brute_solve_pairs(brute);
        for (uint32_t i = 0; i < brute->count; i++)
            push_tool(brute, &brute->pair[i], 1.0 / substeps);
        step_by_hand(brute, h, 1);
    }
    brute_read_nodes(tissue, brute->mine);
    keep(tissue, whole, 1);
    for (int b = 0; b < TISSUE_BODIES; b++) {
        free(whole[b]);
        free(before[b]);
    }
}
