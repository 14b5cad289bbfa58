/* SPDX-License-Identifier: BSD-3-Clause */
#include "tissue/tissue_twist.h"

#include <string.h>

#include "proxy/proxy_force.h"
#include "tissue/tissue_link.h"
#include "tissue/tissue_solve.h"
#include "track/tool_parts.h"

/* As a share of itself: what a twist that slips pulls with is found when it changes by less. */
#define SETTLED 5e-3

/* m: touches are at one place if they are no farther apart than the tool is thick, and so much. */
#define BESIDE 1e-4

/* m: where torsion moves the tool's surface by less, it does not drive it. */
#define DRIVEN 1e-12

static int has_twist(const struct tissue_tool *tool)
{
    return tool->twist.row != 0;
}

static double radius_at(const struct tissue_solve *solve, uint32_t touch)
{
    const struct touch *at = &solve->touches.touch[touch];
    return part_radius(tool_part(solve->world, &solve->world->tools[at->tool_slot], at->part));
}

struct tissue_link dpti_twist_part(struct tissue_solve *solve, struct tissue_twist *twist, uint32_t axis)
{
    return (struct tissue_link){ .body = solve->links[twist->touch].body,
                                 .tool = solve->links[twist->touch].tool,
                                 .count = twist->count,
                                 .node = twist->node,
                                 .weight = twist->force[axis] };
}

double dpti_twist_product(const struct tissue_solve *solve, const struct tissue_twist *twist, vec3 within)
{
    double sum = 0.0;
    for (uint32_t k = 0; k < twist->count; k++)
        sum += solve->spread[twist->node[k]] *
               (within.x * twist->force[0][k] + within.y * twist->force[1][k] + within.z * twist->force[2][k]);
    return sum;
}

/* A corner's share of the couple goes to the nodes that it follows. Returns 0 if there is no room for them. */
static int load_corner(struct tissue_solve *solve, struct tissue_twist *twist, uint32_t vertex, vec3 force)
{
    const uint32_t body = solve->links[twist->touch].body;
    const struct spring_vertices *vertices = &solve->bodies[body].step.springs->vertices;
    for (size_t k = 4 * (size_t)vertex; k < 4 * (size_t)vertex + (vertices->nodes ? 4 : 1); k++) {
        const double weight = vertices->nodes ? (double)vertices->weights[k] : 1.0;
        const uint32_t number =
            weight != 0.0 ? dpti_tissue_node(solve, body, vertices->nodes ? vertices->nodes[k] : vertex) : 0;
        uint32_t at = 0;
        if (number == DPT_NONE) {
            solve->is_full = 1;
            return 0;
        }
        if (weight == 0.0)
            continue;
        while (at < twist->count && twist->node[at] != number)
            at++;
        twist->count += at == twist->count;
        twist->node[at] = (uint16_t)number;
        twist->force[0][at] += weight * force.x;
        twist->force[1][at] += weight * force.y;
        twist->force[2][at] += weight * force.z;
    }
    return 1;
}

/*
 * A couple about the normal: of each corner across it and across the way from the middle, as large as that. One newton of it
 * is a torque of the tool's radius.
 */
static int set_couple(struct tissue_solve *solve, struct tissue_twist *twist, const struct body *body)
{
    const struct touch *touch = &solve->touches.touch[twist->touch];
    const double radius = radius_at(solve, twist->touch);
    double square = 0.0;
    vec3 v[3];
    surface_corners(&body->surface, touch->triangle, v);
    for (uint32_t k = 0; k < 3; k++)
        twist->corner[k] = frame_to_world(&body->frame, v[k]);
    const vec3 middle = scaled(add(add(twist->corner[0], twist->corner[1]), twist->corner[2]), 1.0 / 3.0);
    for (uint32_t k = 0; k < 3; k++) {
        twist->push[k] = cross(touch->normal, sub(twist->corner[k], middle));
        square += dot(twist->push[k], twist->push[k]);
    }
    if (!(square > 0.0 && radius > 0.0))
        return 0;
    twist->widest = sqrt(square / 3.0);
    for (uint32_t k = 0; k < 3; k++)
        twist->push[k] = scaled(twist->push[k], radius / square);
    for (uint32_t k = 0; k < 3 && solve->links[twist->touch].body != DPT_NONE; k++)
        if (!load_corner(solve, twist, surface_corner(&body->surface, touch->triangle, k),
                         frame_turn_back(&body->frame, twist->push[k])))
            return 0;
    return 1;
}

/* Its row: of how the tool's surface turns, times the radius. Returns 0 if the tool has no such turn. */
static int set_row(const struct tissue_solve *solve, const struct tissue_tool *tool, struct tissue_twist *twist,
                   struct tissue_row *row)
{
    const vec3 none = { 0.0, 0.0, 0.0 };
    double square = 0.0;
    for (uint32_t k = 0; k < 3; k++)
        twist->torque =
            add(twist->torque, cross(sub(twist->corner[k], solve->touches.touch[twist->touch].at), twist->push[k]));
    *row = (struct tissue_row){ .touch = twist->touch, .is_twist = 1, .along = none, .within = none };
    for (uint32_t k = 3; k < proxy_unknowns(tool->proxy); k++) {
        row->lever[k] = dot(twist->torque, tool->axes[k - 3]) / proxy_rho_of(tool->proxy, k);
        square += row->lever[k] * row->lever[k];
    }
    return square > 0.0;
}

/*
 * Over the coefficient of friction, N: a sphere that is pressed in by `depth` touches on a disc of the radius sqrt(2 r depth),
 * and Coulomb's torsion on a disc under even pressure is 2/3 of its radius times the friction's force. The corners of the
 * triangle are pulled no more than that. A tool that touches at several places is held by these: there is torsion only as
 * far as this place holds more than all others.
 */
static double limit_of(const struct tissue_solve *solve, const struct tissue_tool *tool)
{
    const struct touch *at = &solve->touches.touch[tool->twist.touch];
    const double radius = radius_at(solve, tool->twist.touch);
    double here = 0.0, all = 0.0;
    for (uint32_t i = 0; i < solve->touches.count; i++) {
        const struct touch *touch = &solve->touches.touch[i];
        const vec3 away = sub(touch->at, at->at);
        if (&solve->tools[solve->links[i].tool] != tool)
            continue;
        all += solve->multiplier[i];
        if (touch->part == at->part && touch->body_id == at->body_id && length(away) <= radius + BESIDE)
            here += solve->multiplier[i];
    }
    if (!(2.0 * here > all))
        return 0.0;
    const double disc = sqrt(2.0 * radius * here / tool->proxy->coupling.stiffness);
    const double arm = min_of(min_of(radius, disc), tool->twist.widest);
    return here * (2.0 * here / all - 1.0) * (2.0 / 3.0) * arm / radius;
}

/* The tool is held about the normal of a touch that rubs, from now on. */
static void begin_twist(struct tissue_solve *solve, struct tissue_tool *tool, const struct tissue_rub *rub)
{
    const struct touch *touch = &solve->touches.touch[rub->touch];
    const struct body *body = world_find_body(solve->world, touch->body_id);
    struct tissue_twist *twist = &tool->twist;
    *twist = (struct tissue_twist){ .is_known = 1,
                                    .touch = rub->touch,
                                    .state = rub->twist != 0.0 ? RUB_SLIPS : RUB_STICKS,
                                    .hold = rub->hold,
                                    .kinetic = rub->kinetic,
                                    .pull = rub->twist };
    const uint32_t number = solve->links[rub->touch].body;
    if (number != DPT_NONE && solve->bodies[number].step.yield)
        return;
    if (!set_couple(solve, twist, body) || !(limit_of(solve, tool) > 0.0) ||
        !set_row(solve, tool, twist, &solve->rows[solve->row_count]))
        return;
    if (body_has_moved(solve->world, body))
        twist->carried = radius_at(solve, rub->touch) * dot(dpti_body_turned(body), touch->normal);
    twist->row = solve->row_count++;
}

/* The rub of a tool that pushes most, as pushes are known; NULL without one. */
static const struct tissue_rub *strongest_rub(const struct tissue_solve *solve, const struct tissue_tool *tool)
{
    const struct tissue_rub *best = NULL;
    double most = 0.0;
    for (uint32_t r = 0; r < solve->rub_count; r++) {
        const struct tissue_rub *rub = &solve->rubs[r];
        if (&solve->tools[solve->links[rub->touch].tool] == tool && solve->multiplier[rub->touch] > most) {
            most = solve->multiplier[rub->touch];
            best = rub;
        }
    }
    return best;
}

int dpti_twists_add(struct tissue_solve *solve)
{
    int has_added = 0;
    for (uint32_t t = 0; t < solve->tool_count; t++) {
        struct tissue_tool *tool = &solve->tools[t];
        /* The turns of a tool that is locked are its device's. */
        if (tool->twist.is_known || proxy_unknowns(tool->proxy) <= 3 || solve->world->tools[tool->slot].lock_rotation)
            continue;
        const struct tissue_rub *rub = strongest_rub(solve, tool);
        if (rub)
            begin_twist(solve, tool, rub);
        has_added |= has_twist(tool);
    }
    return has_added;
}

void dpti_twists_begin(struct tissue_solve *solve)
{
    for (uint32_t t = 0; t < solve->tool_count; t++)
        solve->tools[t].twist.has_returned = 0;
}

void dpti_twists_set_known(struct tissue_solve *solve)
{
    for (uint32_t t = 0; t < solve->tool_count; t++) {
        struct tissue_tool *tool = &solve->tools[t];
        struct tissue_twist *twist = &tool->twist;
        if (!has_twist(tool) || twist->state != RUB_SLIPS)
            continue;
        for (uint32_t k = 0; k < TOUCH_DIMENSIONS; k++)
            tool->known[k] += twist->pull * solve->rows[twist->row].lever[k] / tool->stiffness;
        for (uint32_t axis = 0; axis < 3; axis++) {
            const struct tissue_link part = dpti_twist_part(solve, twist, axis);
            dpti_tissue_add_answer(solve, &part, -twist->pull, twist_axis(axis));
        }
    }
}

void dpti_twists_set_gaps(struct tissue_solve *solve)
{
    const double share = 1.0 / (double)solve->bodies[0].step.info.substeps;
    for (uint32_t t = 0; t < solve->tool_count; t++) {
        const struct tissue_tool *tool = &solve->tools[t];
        const struct tissue_twist *twist = &tool->twist;
        if (!has_twist(tool))
            continue;
        double turned = -share * twist->carried;
        for (uint32_t k = 0; k < TOUCH_DIMENSIONS; k++)
            turned += solve->rows[twist->row].lever[k] * (tool->known[k] - tool->end[k]);
        for (uint32_t k = 0; k < twist->count; k++) {
            const struct tissue_node *node = &solve->nodes[twist->node[k]];
            const vec3 force = { twist->force[0][k], twist->force[1][k], twist->force[2][k] };
            turned -= dot(force, add(node->slid, node->answer));
        }
        solve->free_gap[twist->row] = turned;
        solve->kind[twist->row] = twist->state == RUB_STICKS ? COMPLEMENTARITY_EQUAL : COMPLEMENTARITY_WATCHED;
    }
}

static int set_slipping(struct tissue_twist *twist, double pull)
{
    const int has_changed = twist->state != RUB_SLIPS || fabs(pull - twist->pull) > SETTLED * fabs(pull);
    twist->state = RUB_SLIPS;
    twist->pull = pull;
    return has_changed;
}

static int update(const struct tissue_solve *solve, struct tissue_tool *tool, int may_stick)
{
    struct tissue_twist *twist = &tool->twist;
    const double limit = limit_of(solve, tool), moved = solve->problem.gap[twist->row];
    const double pull = twist->state == RUB_STICKS ? solve->multiplier[twist->row] : twist->pull;
    if (!(limit > 0.0)) {
        const int has_changed = twist->state != RUB_OPEN;
        twist->state = RUB_OPEN;
        twist->pull = 0.0;
        return has_changed;
    }
    const double slides = (pull < 0.0 ? -1.0 : 1.0) * twist->kinetic * limit;
    if (twist->state == RUB_STICKS)
        return fabs(pull) > twist->hold * limit && set_slipping(twist, slides);
    const int is_driven = twist->state == RUB_OPEN || pull * moved > DRIVEN * fabs(pull);
    if (may_stick && !twist->has_returned && is_driven) {
        twist->state = RUB_STICKS;
        twist->has_returned = 1;
        return 1;
    }
    return twist->state == RUB_SLIPS && set_slipping(twist, slides);
}

int dpti_twists_update(struct tissue_solve *solve, int may_stick)
{
    int has_changed = 0;
    for (uint32_t t = 0; t < solve->tool_count; t++)
        if (has_twist(&solve->tools[t]))
            has_changed |= update(solve, &solve->tools[t], may_stick);
    return has_changed | (may_stick && dpti_twists_add(solve));
}
