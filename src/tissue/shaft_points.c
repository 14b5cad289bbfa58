/* SPDX-License-Identifier: BSD-3-Clause */
#include "tissue/shaft_points.h"

#include <string.h>

#include "tissue/tissue_link.h"
#include "tissue/tissue_shaft.h"
#include "tissue/tissue_twist.h"

static const double whole[CHANNEL_POINTS_MAX] = { 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0 };

/* The points that a row loads, and the share of each, by its number. */
struct loaded_points {
    uint32_t first, end;
    const double *share;
};

static uint32_t shaft_of_row(const struct tissue_solve *solve, const struct tissue_row *row)
{
    return shaft_of_touch(&solve->touches.touch[row->touch]);
}

static struct loaded_points points_of(const struct tissue_solve *solve, const struct tissue_row *row)
{
    const struct touch *touch = &solve->touches.touch[row->touch];
    const struct tissue_shaft *shaft = &solve->shafts[shaft_of_touch(touch)];
    const uint32_t kind = shaft_touch_kind(touch), count = shaft->channel->point_count;
    if (kind == SHAFT_MEAN)
        return (struct loaded_points){ 0, count, shaft->share };
    if (kind == SHAFT_TIP)
        return (struct loaded_points){ count - 1, count, whole };
    return (struct loaded_points){ kind, kind + 1, whole };
}

/* NULL: the point loads no nodes of the solve. */
static const struct tissue_link *link_of(const struct tissue_solve *solve, const struct tissue_shaft *shaft,
                                         uint32_t point)
{
    return shaft->touch[point] ? &solve->links[shaft->touch[point] - 1] : NULL;
}

/* Whether nothing else touches its body: then nodes need not know what moves them. */
static int is_alone(const struct tissue_solve *solve, uint32_t shaft)
{
    for (uint32_t b = 0; b < solve->body_count; b++)
        if (solve->bodies[b].body == solve->shafts[shaft].body)
            return solve->bodies[b].shaft == shaft + 1;
    return 1;
}

/* How far newtons on the points of a shaft move all of them. */
static const struct shaft_products *products_of(struct tissue_solve *solve, uint32_t number)
{
    const struct tissue_shaft *shaft = &solve->shafts[number];
    struct shaft_products *made = &solve->products[number];
    uint32_t products = 0;
    if (made->is_known)
        return made;
    *made = (struct shaft_products){ .is_known = 1, .beside = made->beside };
    for (uint32_t i = 0; i < shaft->channel->point_count; i++) {
        const struct tissue_link *link = link_of(solve, shaft, i), *other;
        if (!link)
            continue;
        dpti_tissue_spread_touch(solve, link, 1.0);
        for (uint32_t k = 0; k <= i; k++)
            if ((other = link_of(solve, shaft, k)) != NULL) {
                made->of[i][k] = made->of[k][i] = tissue_spread_at(solve, other);
                products += other->count;
            }
        dpti_tissue_clear_spread(solve, link);
    }
    work_spend(&solve->work, products / LANES + 1);
    return made;
}

static double sum_of(const struct loaded_points *points, const double *of)
{
    double sum = 0.0;
    for (uint32_t i = points->first; i < points->end; i++)
        sum += points->share[i] * of[i];
    return sum;
}

double dpti_shaft_spread_at(const struct tissue_solve *solve, const struct tissue_row *row)
{
    const struct tissue_shaft *shaft = &solve->shafts[shaft_of_row(solve, row)];
    const struct loaded_points points = points_of(solve, row);
    double sum = 0.0;
    for (uint32_t i = points.first; i < points.end; i++) {
        const struct tissue_link *link = link_of(solve, shaft, i);
        if (link && points.share[i] > 0.0)
            sum += points.share[i] * tissue_spread_at(solve, link);
    }
    return sum;
}

/* A row of points for each touch that is of no shaft: how far newtons on these move it. NULL: it is not known. */
static const double *beside_of(const struct tissue_solve *solve, uint32_t shaft)
{
    return solve->products[shaft].beside ? solve->beside + solve->products[shaft].beside - 1 : NULL;
}

static void find_beside(struct tissue_solve *solve, uint32_t number)
{
    const struct tissue_shaft *shaft = &solve->shafts[number];
    const uint32_t points = shaft->channel->point_count, count = solve->touches.count * points;
    struct shaft_products *known = &solve->products[number];
    double *made = solve->beside + solve->beside_count;
    uint32_t products = 0;
    if (known->beside || solve->beside_count + count > TISSUE_BESIDE)
        return;
    memset(made, 0, count * sizeof *made);
    known->beside = solve->beside_count + 1;
    solve->beside_count += count;
    for (uint32_t k = 0; k < points; k++) {
        const struct tissue_link *link = link_of(solve, shaft, k);
        if (!link)
            continue;
        dpti_tissue_spread_touch(solve, link, 1.0);
        for (uint32_t i = 0; i < solve->touches.count; i++)
            if (!solve->touches.touch[i].shaft && solve->links[i].body == link->body) {
                made[i * points + k] = tissue_spread_at(solve, &solve->links[i]);
                products += solve->links[i].count;
            }
        dpti_tissue_clear_spread(solve, link);
    }
    work_spend(&solve->work, products / LANES + 1);
}

void dpti_shafts_find_beside(struct tissue_solve *solve)
{
    for (uint32_t i = 0; i < solve->shaft_count; i++)
        if (!is_alone(solve, i))
            find_beside(solve, i);
}

double dpti_shaft_moved_by(const struct tissue_solve *solve, const struct tissue_row *row, uint32_t touch)
{
    const uint32_t shaft = shaft_of_row(solve, row);
    const double *beside = beside_of(solve, shaft);
    const struct loaded_points points = points_of(solve, row);
    return beside ? sum_of(&points, beside + touch * solve->shafts[shaft].channel->point_count)
                  : dpti_shaft_spread_at(solve, row);
}

/* A newton of a row, as it moves what touches along its own shaft, m: by the kind of touch. */
struct moved_touches {
    uint32_t shaft;
    double by[SHAFT_TOUCHES];
};

static void set_moved(const struct tissue_solve *solve, const struct shaft_products *products,
                      const struct loaded_points *points, struct moved_touches *moved)
{
    const struct tissue_shaft *shaft = &solve->shafts[moved->shaft];
    const uint32_t count = shaft->channel->point_count;
    for (uint32_t i = 0; i < count; i++)
        moved->by[i] = sum_of(points, products->of[i]);
    moved->by[SHAFT_TIP] = moved->by[count - 1];
    moved->by[SHAFT_MEAN] = 0.0;
    for (uint32_t i = 0; i < count; i++)
        moved->by[SHAFT_MEAN] += shaft->share[i] * moved->by[i];
}

/* How far the point of a row that is not of the shaft moves by a newton of one that is, which may be in `spread`. */
static double product_of(const struct tissue_solve *solve, const struct tissue_row *row, const struct tissue_row *other)
{
    const struct tissue_link *its = &solve->links[other->touch];
    if (other->is_twist)
        return dpti_twist_product(solve, &solve->tools[its->tool].twist, row->within);
    const double along_both = dot(other->within, row->within);
    if (solve->touches.touch[other->touch].shaft)
        return dpti_shaft_spread_at(solve, other) * along_both;
    return along_both * (beside_of(solve, shaft_of_row(solve, row)) ? dpti_shaft_moved_by(solve, row, other->touch)
                                                                    : tissue_spread_at(solve, its));
}

/* Whether what a row of a shaft moves beside its own is asked of nodes: by other shafts, twists, and without room. */
static int needs_spread(struct tissue_solve *solve, uint32_t shaft)
{
    if (is_alone(solve, shaft))
        return 0;
    for (uint32_t t = 0; t < solve->tool_count; t++)
        if (solve->tools[t].twist.row)
            return 1;
    return solve->shaft_count > 1 || !beside_of(solve, shaft);
}

static void spread_points(struct tissue_solve *solve, const struct tissue_row *row, int is_over)
{
    const struct tissue_shaft *shaft = &solve->shafts[shaft_of_row(solve, row)];
    const struct loaded_points points = points_of(solve, row);
    for (uint32_t i = points.first; i < points.end; i++) {
        const struct tissue_link *link = link_of(solve, shaft, i);
        if (!link || !(points.share[i] > 0.0))
            continue;
        if (is_over)
            dpti_tissue_clear_spread(solve, link);
        else
            dpti_tissue_spread_touch(solve, link, points.share[i]);
    }
}

void dpti_shafts_give_column(struct tissue_solve *solve, uint32_t index, uint32_t first, double *column)
{
    const struct tissue_row *row = &solve->rows[index];
    const struct tissue_link *link = &solve->links[row->touch];
    const double compliance = 1.0 / solve->tools[link->tool].stiffness;
    const struct loaded_points points = points_of(solve, row);
    struct moved_touches moved = { .shaft = shaft_of_row(solve, row) };
    const uint32_t own = 1 + SHAFT_TOUCHES * moved.shaft;
    dpti_shafts_find_beside(solve);
    const int has_spread = needs_spread(solve, moved.shaft);
    set_moved(solve, products_of(solve, moved.shaft), &points, &moved);
    if (has_spread)
        spread_points(solve, row, 0);
    for (uint32_t i = first; i < solve->row_count; i++) {
        const struct tissue_row *other = &solve->rows[i];
        const struct tissue_link *its = &solve->links[other->touch];
        const uint32_t kind = solve->touches.touch[other->touch].shaft - own;
        double product = 0.0;
        column[i] = 0.0;
        /* Those of touches are not asked for. */
        if (i < solve->touches.count && solve->touches.touch[i].shaft)
            continue;
        if (kind < SHAFT_TOUCHES)
            column[i] = moved.by[kind] * dot(other->within, row->within);
        else if (link->body != DPT_NONE && its->body == link->body)
            column[i] = product_of(solve, row, other);
        if (its->tool != link->tool)
            continue;
        for (uint32_t k = 0; k < TOUCH_DIMENSIONS; k++)
            product += row->lever[k] * other->lever[k];
        column[i] += product * compliance;
    }
    if (index >= first)
        column[index] += row->compliance;
    if (has_spread)
        spread_points(solve, row, 1);
    work_spend(&solve->work, (solve->row_count - first) * TOUCH_DIMENSIONS / LANES + 1);
}

/* ---- forces ---- */

void dpti_shafts_forget_known(struct tissue_solve *solve)
{
    for (uint32_t i = 0; i < solve->shaft_count; i++)
        memset(solve->shafts[i].known, 0, sizeof solve->shafts[i].known);
}

/* A force on the tool along a row pushes its points the other way. */
static void push_points(const struct tissue_solve *solve, const struct tissue_row *row, double force, vec3 *on)
{
    const struct loaded_points points = points_of(solve, row);
    for (uint32_t i = points.first; i < points.end; i++)
        on[i] = along(on[i], -force * points.share[i], row->within);
}

void dpti_shaft_push(struct tissue_solve *solve, const struct tissue_row *row, double force)
{
    dpti_tissue_push_tool(solve, row, force);
    push_points(solve, row, force, solve->shafts[shaft_of_row(solve, row)].known);
}

void dpti_shafts_push_nodes(struct tissue_solve *solve)
{
    for (uint32_t i = 0; i < solve->shaft_count; i++) {
        const struct tissue_shaft *shaft = &solve->shafts[i];
        for (uint32_t k = 0; k < shaft->channel->point_count && !is_alone(solve, i); k++) {
            const struct tissue_link *link = link_of(solve, shaft, k);
            if (link && dot(shaft->known[k], shaft->known[k]) > 0.0)
                dpti_tissue_add_answer(solve, link, 1.0, shaft->known[k]);
        }
    }
}

/* How far nodes take a point. */
static vec3 moved_by_nodes(const struct tissue_solve *solve, const struct tissue_link *link)
{
    vec3 moved = { 0.0, 0.0, 0.0 };
    for (uint32_t k = 0; k < link->count; k++) {
        const struct tissue_node *node = &solve->nodes[link->node[k]];
        moved = along(moved, link->weight[k], add(node->moved, node->answer));
    }
    return moved;
}

/* How far forces on the points of a shaft move one of them. */
static vec3 moved_by_points(const struct tissue_solve *solve, uint32_t shaft, uint32_t point, const vec3 *force)
{
    vec3 moved = { 0.0, 0.0, 0.0 };
    for (uint32_t i = 0; i < solve->shafts[shaft].channel->point_count; i++)
        moved = along(moved, solve->products[shaft].of[point][i], force[i]);
    return moved;
}

void dpti_shafts_find_moved(struct tissue_solve *solve)
{
    for (uint32_t i = 0; i < solve->shaft_count; i++) {
        struct tissue_shaft *shaft = &solve->shafts[i];
        const int needs_products = is_alone(solve, i);
        if (needs_products)
            products_of(solve, i);
        for (uint32_t k = 0; k < shaft->channel->point_count; k++) {
            const struct tissue_link *link = link_of(solve, shaft, k);
            shaft->moved[k] = link ? moved_by_nodes(solve, link) : (vec3){ 0.0, 0.0, 0.0 };
            if (link && needs_products)
                shaft->moved[k] = add(shaft->moved[k], moved_by_points(solve, i, k, shaft->known));
        }
    }
}

vec3 dpti_shaft_moved(const struct tissue_solve *solve, const struct tissue_row *row)
{
    const struct tissue_shaft *shaft = &solve->shafts[shaft_of_row(solve, row)];
    const struct loaded_points points = points_of(solve, row);
    vec3 moved = { 0.0, 0.0, 0.0 };
    for (uint32_t i = points.first; i < points.end; i++)
        moved = along(moved, points.share[i], shaft->moved[i]);
    return moved;
}

void dpti_shafts_load_nodes(struct tissue_solve *solve)
{
    for (uint32_t i = 0; i < solve->shaft_count; i++)
        memset(solve->shafts[i].load, 0, sizeof solve->shafts[i].load);
    for (uint32_t i = 0; i < solve->row_count && solve->shaft_count; i++) {
        const struct tissue_row *row = &solve->rows[i];
        if (solve->multiplier[i] != 0.0 && solve->touches.touch[row->touch].shaft)
            push_points(solve, row, solve->multiplier[i], solve->shafts[shaft_of_row(solve, row)].load);
    }
    for (uint32_t i = 0; i < solve->shaft_count; i++)
        for (uint32_t k = 0; k < solve->shafts[i].channel->point_count; k++) {
            const struct tissue_link *link = link_of(solve, &solve->shafts[i], k);
            for (uint32_t n = 0; link && n < link->count; n++) {
                vec3 *load = &solve->nodes[link->node[n]].load;
                *load = along(*load, link->weight[n], solve->shafts[i].load[k]);
            }
        }
}

/* Where a tool ends, as unknowns. */
static void end_of(const struct tissue_solve *solve, uint32_t tool, double end[TOUCH_DIMENSIONS])
{
    memcpy(end, solve->tools[tool].away, TOUCH_DIMENSIONS * sizeof *end);
    for (uint32_t i = 0; i < solve->row_count; i++)
        for (uint32_t k = 0; k < TOUCH_DIMENSIONS && solve->multiplier[i] != 0.0; k++)
            if (solve->links[solve->rows[i].touch].tool == tool)
                end[k] += solve->multiplier[i] * solve->rows[i].lever[k] / solve->tools[tool].stiffness;
}

double dpti_shafts_farthest(const struct tissue_solve *solve)
{
    double farthest = 0.0;
    for (uint32_t i = 0; i < solve->shaft_count; i++) {
        const struct tissue_shaft *shaft = &solve->shafts[i];
        const int moves_by_points = is_alone(solve, i);
        double end[TOUCH_DIMENSIONS];
        vec3 pushed[CHANNEL_POINTS_MAX];
        end_of(solve, shaft->tool, end);
        for (uint32_t k = 0; k < shaft->channel->point_count; k++)
            pushed[k] = sub(shaft->load[k], shaft->known[k]);
        for (uint32_t k = 0; k < shaft->channel->point_count; k++) {
            const struct tissue_link *link = link_of(solve, shaft, k);
            double tool = 0.0;
            if (!link)
                continue;
            const vec3 moved = moves_by_points ? add(shaft->moved[k], moved_by_points(solve, i, k, pushed))
                                               : moved_by_nodes(solve, link);
            for (uint32_t d = 0; d < TOUCH_DIMENSIONS; d++)
                tool += solve->touches.touch[shaft->touch[k] - 1].row[d] * end[d];
            farthest = max_of(farthest, length(moved) + fabs(tool));
        }
    }
    return farthest;
}
