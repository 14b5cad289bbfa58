/* SPDX-License-Identifier: BSD-3-Clause */
#include "proxy/patch_sides.h"

#include "proxy/patch_tips.h"

enum { BYTES_PATCH = 1984 };
typedef char patch_fits[sizeof(struct proxy_patch) <= BYTES_PATCH ? 1 : -1];

/* Beside what is asked for: so many times the reach at first, for the ticks to come; halved down to the least. */
#define SPARE_MOST  8.0
#define SPARE_LEAST 0.25

/* Many leaves are dear: they are worth it where no patch of one block has that much to spare. */
#define SPARE_SMALL 1.0

uint64_t dpti_patch_bytes(const dpt_world_def *def)
{
    return BYTES_PATCH * PATCH_BODIES * ((uint64_t)def->max_segments + def->max_tips);
}

void dpti_patches_forget(const struct dpt_world *world, const struct tool *tool)
{
    for (uint32_t i = 0; i < PATCH_BODIES * tool_part_count(tool); i++) {
        struct proxy_patch *patch = &patches_of_part(world, tool_part(world, tool, i / PATCH_BODIES))[i % PATCH_BODIES];
        patch->reach = patch->spare = 0.0;
        patch->crowded = 0;
        patch->body_id = patch->still.body_id = 0;
    }
}

double dpti_patch_place_side(const struct patch_view *view, struct patch_side *side)
{
    const struct frame *body = &side->body->frame;
    const struct patch_axis *axis = &view->axes[side->number];
    const vec3 a = side->a, b = add(side->a, side->u);
    side->a = frame_to_local(body, axis->a);
    side->u = (vec3){ 0.0, 0.0, 0.0 };
    if (view->is_ball)
        return length(sub(side->a, a));
    side->u = sub(frame_to_local(body, axis->b), side->a);
    if (side->tip)
        return dpti_patch_tip_place(side, &view->placed);
    return max_of(length(sub(side->a, a)), length(sub(add(side->a, side->u), b)));
}

/* All leaves within reach of the axis, at most so many. 0: there are more, or the work is spent. */
static int fill(struct dpt_world *world, const struct patch_side *side, double reach, uint32_t most)
{
    struct proxy_patch *patch = side->patch;
    const struct surface *surface = &side->body->surface;
    struct range range;
    uint32_t leaf;
    patch->count = 0;
    patch->reach = 0.0;
    dpti_range_begin(&range, surface, &world->kernel, side->a, side->u, reach, &world->work);
    while ((leaf = dpti_range_next_leaf(&range)) != DPT_NONE) {
        if (patch->count == most)
            return 0;
        const float *rows = surface_node(surface, 1, leaf / LANES, &world->work);
        float *box = patch->box[patch->count / LANES];
        for (uint32_t row = 0; row < MESH_BOX_WORDS; row += LANES)
            box[row + patch->count % LANES] = rows[row + leaf % LANES];
        patch->leaf[patch->count++] = leaf;
    }
    if (work_is_spent(&world->work))
        return 0;
    patch->a = side->a;
    patch->b = add(side->a, side->u);
    patch->reach = reach;
    patch->body_id = side->body->id;
    return 1;
}

/* See that the patch has all triangles within `need` of the axis. */
static int cover(struct dpt_world *world, const struct patch_side *side, double need, double reach)
{
    struct proxy_patch *patch = side->patch;
    if (patch->reach > 0.0 && patch->body_id == side->body->id && patch_off_centre(side) + need <= patch->reach)
        return 1;
    double spare = patch->spare > 0.0 ? min_of(SPARE_MOST, 1.5 * patch->spare) : SPARE_MOST;
    for (; spare >= SPARE_LEAST; spare *= 0.5) {
        patch->spare = spare;
        if (fill(world, side, need + spare * reach, spare > SPARE_SMALL ? LANES : PATCH_LEAVES))
            return 1;
        if (work_is_spent(&world->work))
            return 0;
    }
    return 0;
}

/*
 * The sides within reach: one of each segment or tip and each body whose box is so near. *others: no other body has a gap below
 * that, m. Returns 0 if there are too many, or one is of a body that deforms.
 */
static int list_sides(const struct dpt_world *world, struct patch_view *view, double reach, double *others)
{
    *others = HUGE_VAL;
    view->side_count = view->tip_count = 0;
    for (uint32_t i = 0; i < view->axis_count; i++) {
        const struct patch_axis *axis = &view->axes[i];
        const struct box box = box_of_axis(axis->a, axis->b);
        const double radius = part_radius(axis->part), spread = axis->part.tip ? axis->part.tip->hull->reach : 0.0;
        for (uint32_t slot = 0; slot < world->body_slot_end; slot++) {
            const struct body *body = &world->bodies[slot];
            const double gap = box_distance(&box, &world->boxes[slot]) - spread - radius;
            if (!body_is_there(body))
                continue;
            if (gap > reach) {
                *others = min_of(*others, gap);
                continue;
            }
            if (body->surface.motion || view->side_count == PATCH_SIDES_MAX ||
                (axis->part.tip && view->tip_count == PATCH_TIP_SIDES_MAX))
                return 0;
            struct patch_side *side = &view->sides[view->side_count++];
            side->part = axis->part;
            side->tip = axis->part.tip ? &view->tips[view->tip_count++] : NULL;
            side->radius = radius;
            side->spread = spread;
            side->body = body;
            side->number = i;
            side->nearest = PATCH_TRIANGLES_MAX;
            side->patch = NULL;
            dpti_patch_place_side(view, side);
        }
    }
    return 1;
}

static int is_taken(const struct patch_view *view, const struct proxy_patch *patch)
{
    for (uint32_t i = 0; i < view->side_count; i++)
        if (view->sides[i].patch == patch)
            return 1;
    return 0;
}

/*
 * Each side takes a patch of its segment: first those take one that have been of their body, as it may hold. Returns 0 if
 * there are too few.
 */
static int share_patches(const struct dpt_world *world, struct patch_view *view)
{
    for (int is_new = 0; is_new < 2; is_new++)
        for (uint32_t i = 0; i < view->side_count; i++) {
            struct patch_side *side = &view->sides[i];
            struct proxy_patch *patches = patches_of_part(world, side->part);
            for (int k = 0; k < PATCH_BODIES && !side->patch; k++)
                if (!is_taken(view, &patches[k]) && (is_new || patches[k].body_id == side->body->id))
                    side->patch = &patches[k];
            if (is_new && !side->patch)
                return 0;
        }
    return 1;
}

/* Patches of all sides with the triangles whose gaps are at most that, m. 0: there is no room. */
static int cover_all(struct dpt_world *world, const struct patch_view *view, double reach)
{
    for (uint32_t i = 0; i < view->side_count; i++)
        if (!cover(world, &view->sides[i], view->sides[i].spread + view->sides[i].radius + reach, reach))
            return 0;
    return 1;
}

double dpti_patch_find_sides(struct dpt_world *world, struct patch_view *view, double reach, double least,
                             double *others)
{
    if (!list_sides(world, view, reach, others) || !share_patches(world, view))
        return 0.0;
    for (; !cover_all(world, view, reach); view->room = reach *= 0.5)
        if (reach < least || work_is_spent(&world->work))
            return 0.0;
    return reach;
}
