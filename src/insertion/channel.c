/* SPDX-License-Identifier: BSD-3-Clause */
#include "insertion/channel.h"

#include "dynpoint/types.h"

#include <string.h>

/* Steps to where a ball begins to touch a triangle, at most, and m: a shorter one is not made. */
enum { STEPS_MAX = 24 };
#define STEP_LEAST 1e-14

/* As a share of the radius, or m for a line: places that are nearer to each other are the same. */
#define SAME_SHARE 1e-6
#define SAME_LEAST 1e-9

static double same_of(const struct channel *channel)
{
    return max_of(SAME_SHARE * channel->radius, SAME_LEAST);
}

static double distance2_at(const struct channel_search *search, const vec3 v[3], double at)
{
    pair nearest;
    point_triangle(along(search->channel.mouth, at, search->channel.axis), v, &nearest);
    return nearest.distance2;
}

/*
 * Where the ball begins to touch a triangle, from a place where it does not, by Newton's method. The distance is convex along
 * the line, so no step passes the border.
 */
static double border_from(const struct channel_search *search, const vec3 v[3], double apart)
{
    for (int i = 0; i < STEPS_MAX; i++) {
        pair nearest;
        point_triangle(along(search->channel.mouth, apart, search->channel.axis), v, &nearest);
        const double distance = sqrt(nearest.distance2), left = distance - search->channel.radius;
        const double slope = distance > 0.0 ? dot(nearest.gap, search->channel.axis) / distance : 0.0;
        const double step = slope != 0.0 ? left / slope : 0.0;
        if (!(left > 0.0) || !(fabs(step) > STEP_LEAST) || !(fabs(step) < search->reach))
            break;
        apart -= step;
    }
    return apart;
}

/* The first place from `from` on, by steps of `step` that double, where the ball does not touch. */
static double apart_beyond(const struct channel_search *search, const vec3 v[3], double from, double step)
{
    const double radius2 = search->channel.radius * search->channel.radius;
    double at = from + step;
    while (distance2_at(search, v, at) <= radius2 && fabs(step) < search->reach) {
        step *= 2.0;
        at = from + step;
    }
    return at;
}

/* Put a stretch among the walls; those that it touches become one with it. Without room the farthest is the limit. */
static void add_wall(struct channel *channel, struct channel_stretch added)
{
    uint32_t first = 0, end;
    while (first < channel->wall_count && channel->walls[first].to < added.from)
        first++;
    for (end = first; end < channel->wall_count && channel->walls[end].from <= added.to; end++) {
        if (channel->walls[end].from <= added.from)
            added.region = channel->walls[end].region;
        added.from = min_of(added.from, channel->walls[end].from);
        added.to = max_of(added.to, channel->walls[end].to);
    }
    if (end == first && channel->wall_count == CHANNEL_WALLS_MAX) {
        const double last = first == CHANNEL_WALLS_MAX ? added.from : channel->walls[CHANNEL_WALLS_MAX - 1].from;
        channel->limit = min_of(channel->limit, last);
        if (first == CHANNEL_WALLS_MAX)
            return;
        channel->wall_count = CHANNEL_WALLS_MAX - 1;
        end = first;
    }
    const uint32_t behind = channel->wall_count - end;
    memmove(&channel->walls[first + 1], &channel->walls[end], behind * sizeof *channel->walls);
    channel->walls[first] = added;
    channel->wall_count = first + 1 + behind;
}

/* Put a crossing among the others. Where the line meets an edge, each triangle there has the same one. */
static void add_crossing(struct channel_search *search, const struct channel_crossing *added)
{
    uint32_t i = search->crossing_count;
    for (uint32_t k = 0; k < search->crossing_count; k++)
        if (search->crossings[k].is_entering == added->is_entering &&
            fabs(search->crossings[k].at - added->at) < same_of(&search->channel))
            return;
    while (i > 0 && search->crossings[i - 1].at > added->at)
        i--;
    if (search->crossing_count == CHANNEL_CROSSINGS_MAX) {
        const double last = i == CHANNEL_CROSSINGS_MAX ? added->at : search->crossings[CHANNEL_CROSSINGS_MAX - 1].at;
        search->channel.limit = min_of(search->channel.limit, last);
        if (i == CHANNEL_CROSSINGS_MAX)
            return;
        search->crossing_count--;
    }
    memmove(&search->crossings[i + 1], &search->crossings[i], (search->crossing_count - i) * sizeof *search->crossings);
    search->crossings[i] = *added;
    search->crossing_count++;
}

static uint32_t region_of(const struct channel_search *search, uint32_t triangle)
{
    return search->regions ? search->regions[search->surface->sources[triangle]] : 0;
}

static void look_at(struct channel_search *search, uint32_t triangle)
{
    struct channel *channel = &search->channel;
    vec3 v[3];
    surface_corners(search->surface, triangle, v);
    const pair nearest =
        dpti_triangle_pair(search->surface, triangle, channel->mouth, scaled(channel->axis, search->reach));
    const double at = nearest.s * search->reach;
    if (!(nearest.distance2 <= channel->radius * channel->radius))
        return;
    if (nearest.distance2 == 0.0) {
        const vec3 normal = dpti_surface_face_normal(search->surface, triangle);
        struct channel_crossing crossing = { at, dot(normal, channel->axis) < 0.0, triangle, { 0.0, 0.0, 0.0 } };
        memcpy(crossing.weight, nearest.weight, sizeof crossing.weight);
        add_crossing(search, &crossing);
    }
    const double step = channel->radius + same_of(channel);
    const double before = apart_beyond(search, v, at, -step), behind = apart_beyond(search, v, at, step);
    const struct channel_stretch wall = { border_from(search, v, before), border_from(search, v, behind),
                                          region_of(search, triangle), 0 };
    if (wall.from <= channel->length)
        add_wall(channel, wall);
    if (wall.from < search->first) {
        search->first = wall.from;
        channel->triangle = triangle;
        memcpy(channel->weight, nearest.weight, sizeof channel->weight);
    }
}

/* The stretches between where the line goes in and where it comes out again. */
static void find_layers(struct channel_search *search)
{
    struct channel *channel = &search->channel;
    int depth = 0;
    struct channel_stretch layer = { 0.0, 0.0, 0, 0 };
    channel->layer_count = 0;
    for (uint32_t i = 0; i < search->crossing_count; i++) {
        const struct channel_crossing *crossing = &search->crossings[i];
        if (crossing->is_entering && depth++ == 0) {
            layer.from = crossing->at;
            layer.region = region_of(search, crossing->triangle);
        }
        if (crossing->is_entering || depth == 0 || --depth > 0)
            continue;
        layer.to = crossing->at;
        if (channel->layer_count < CHANNEL_LAYERS_MAX)
            channel->layers[channel->layer_count++] = layer;
        else
            channel->limit = min_of(channel->limit, layer.from);
    }
}

static void find_entry(struct channel_search *search)
{
    struct channel *channel = &search->channel;
    const struct channel_crossing *first = search->crossings;
    channel->entry = channel->wall_count ? channel->walls[0].from : 0.0;
    channel->is_from_inside = search->crossing_count && !first->is_entering;
    if (!search->crossing_count || !channel->wall_count || first->at > channel->walls[0].to)
        return;
    channel->entry = first->at;
    channel->triangle = first->triangle;
    memcpy(channel->weight, first->weight, sizeof channel->weight);
}

static void set_search(struct channel_search *search, const struct channel *channel, const struct surface *surface,
                       const uint8_t *regions)
{
    const vec3 centre = scaled(add(surface->box_min, surface->box_max), 0.5);
    search->channel = *channel;
    search->surface = surface;
    search->regions = regions;
    search->first = HUGE_VAL;
    search->is_begun = 1;
    search->crossing_count = 0;
    search->reach =
        max_of(channel->length, length(sub(channel->mouth, centre)) + surface->diagonal) + 2.0 * channel->radius;
    search->channel.limit = channel->length;
    search->channel.wall_count = search->channel.open_count = 0;
    search->channel.deepest = 0.0;
}

void dpti_channel_search_begin(struct channel_search *search, const struct channel *channel,
                               const struct surface *surface, const uint8_t *regions, const struct kernel *kernel,
                               struct work *work)
{
    set_search(search, channel, surface, regions);
    dpti_range_begin(&search->range, surface, kernel, channel->mouth, scaled(channel->axis, search->reach),
                     channel->radius, work);
}

static void finish(struct channel_search *search)
{
    find_layers(search);
    find_entry(search);
    search->is_begun = 0;
}

int dpti_channel_search_on(struct channel_search *search)
{
    struct work *work = search->range.work;
    int may_touch;
    for (;;) {
        const uint32_t triangle = dpti_range_next(&search->range, &may_touch);
        if (triangle == DPT_NONE)
            break;
        look_at(search, triangle);
        work_spend_between(work, 1);
    }
    if (!dpti_range_is_over(&search->range))
        return 0;
    finish(search);
    return 1;
}

/* ---- a line in tissue ---- */

/*
 * As a multiple of the radius, and of the length: how far from a line triangles are noted beyond the radius. And as a
 * multiple of that, at most, where it did not suffice.
 */
#define MARGIN        1.0
#define MARGIN_LENGTH (1.0 / 512.0)
#define MARGIN_MOST   16.0

/* m: of rounding, beside a margin. */
#define ROUNDING 1e-9

static float travel_of(const struct surface *surface)
{
    return surface->motion->travel[surface->motion->first[surface->motion->levels]];
}

static double distance_from_line(const struct channel_near *near, vec3 at)
{
    const vec3 from = sub(at, near->from);
    const double s = dot(from, near->way) / dot(near->way, near->way);
    return length(sub(from, scaled(near->way, max_of(0.0, min_of(s, 1.0)))));
}

/* Whether all near the line of a search is, or will be, noted. The distance from a straight line is largest at an end. */
static int is_near_noted(const struct channel_search *search, const struct channel_near *near)
{
    const struct channel *line = &search->channel;
    const struct surface *surface = search->surface;
    if (!(near->margin > 0.0) || near->begun != surface->motion->begun)
        return 0;
    const double moved = ((double)travel_of(surface) - (double)near->travel) / surface->filter_scale;
    const double aside = max_of(distance_from_line(near, line->mouth),
                                distance_from_line(near, along(line->mouth, search->reach, line->axis)));
    return moved + aside + ROUNDING < near->margin;
}

/* Begin to note, beyond both ends of the line, too, as it goes on along itself. A margin that did not suffice doubles. */
static void begin_near(const struct channel_search *search, const struct kernel *kernel, struct work *work,
                       struct channel_near *near)
{
    const struct channel *line = &search->channel;
    const struct surface *surface = search->surface;
    const double margin = max_of(MARGIN * line->radius, MARGIN_LENGTH * line->length);
    const double last = near->is_known ? 0.0 : near->margin;
    near->is_known = near->count = 0;
    near->begun = surface->motion->begun;
    near->travel = travel_of(surface);
    near->margin = max_of(margin, min_of(2.0 * last, MARGIN_MOST * margin));
    near->from = along(line->mouth, -line->length, line->axis);
    near->way = scaled(line->axis, search->reach + 2.0 * line->length);
    dpti_range_begin(&near->range, surface, kernel, near->from, near->way, line->radius + near->margin, work);
}

/* Go on. Returns 0 if the work was spent; without room for all, none are known. */
static int note_near(struct channel_near *near)
{
    int may_touch;
    while (!near->is_known) {
        const uint32_t triangle = dpti_range_next(&near->range, &may_touch);
        near->is_known = triangle == DPT_NONE && dpti_range_is_over(&near->range);
        if (triangle == DPT_NONE)
            return (int)near->is_known;
        if (near->count == CHANNEL_NEAR_MAX) {
            near->margin = 0.0;
            return 1;
        }
        near->triangle[near->count++] = triangle;
    }
    return 1;
}

int dpti_channel_search_near(struct channel_search *search, const struct channel *channel,
                             const struct surface *surface, const uint8_t *regions, const struct kernel *kernel,
                             struct work *work, struct channel_near *near)
{
    set_search(search, channel, surface, regions);
    if (!is_near_noted(search, near))
        begin_near(search, kernel, work, near);
    if (!note_near(near))
        return 0;
    if (!near->is_known) {
        dpti_channel_search_begin(search, channel, surface, regions, kernel, work);
        return dpti_channel_search_on(search);
    }
    for (uint32_t i = 0; i < near->count; i++)
        look_at(search, near->triangle[i]);
    work_spend_between(work, near->count);
    finish(search);
    return 1;
}

double dpti_channel_stop(const struct channel *channel, double clearance)
{
    const double wall =
        channel->open_count < channel->wall_count ? channel->walls[channel->open_count].from - clearance : HUGE_VAL;
    return min_of(channel->limit, wall);
}

double dpti_layer_inside(const struct channel *channel, uint32_t layer, double tip)
{
    const struct channel_stretch *stretch = &channel->layers[layer];
    return max_of(0.0, min_of(tip, stretch->to) - max_of(tip - channel->length, stretch->from));
}

double dpti_channel_inside(const struct channel *channel, double tip)
{
    double inside = 0.0;
    for (uint32_t i = 0; i < channel->layer_count; i++)
        inside += dpti_layer_inside(channel, i, tip);
    return inside;
}

uint32_t dpti_channel_layers(const struct channel *channel, double tip)
{
    uint32_t count = 0;
    while (count < channel->layer_count && channel->layers[count].from < tip)
        count++;
    return count;
}

double dpti_channel_uncut(const struct channel *channel)
{
    for (uint32_t i = 0; i < channel->layer_count; i++)
        if (channel->deepest < channel->layers[i].to)
            return max_of(channel->deepest, channel->layers[i].from);
    return HUGE_VAL;
}
