/* SPDX-License-Identifier: BSD-3-Clause */
#include "insertion/channel_points.h"

#include "dynpoint/types.h"
#include "nearest/bvh.h"

#include <string.h>

/* m: hits that are nearer to a point lie in it. */
#define NEAR 1e-9

/* As multiples of the radius: of the second point from the first one; and so far apart points tell a direction. */
#define FIRST_STEP 4.0
#define APART      8.0

vec3 dpti_channel_point_at(const struct surface *surface, const struct channel_point *point)
{
    vec3 at = point->rest;
    for (uint32_t i = 0; i < point->hit_count; i++) {
        const struct channel_hit *hit = &point->hits[i];
        at = add(at, surface_point(surface, hit->triangle, hit->weight));
    }
    return at;
}

/* Where a line through a point meets the surface on both sides of it, nearest. */
struct line_hits {
    double distance[2]; /* m; HUGE_VAL: nowhere */
    struct channel_hit hit[2];
};

static void find_hits(struct line_hits *hits, const struct surface *surface, const struct kernel *kernel, vec3 at,
                      vec3 direction, struct work *work)
{
    const double reach = extent_of(sub(at, scaled(add(surface->box_min, surface->box_max), 0.5))) + surface->diagonal;
    const vec3 from = along(at, -reach, direction), way = scaled(direction, 2.0 * reach);
    struct range range;
    uint32_t triangle;
    int may_touch;
    hits->distance[0] = hits->distance[1] = HUGE_VAL;
    dpti_range_begin(&range, surface, kernel, from, way, 0.0, work);
    while ((triangle = dpti_range_next(&range, &may_touch)) != DPT_NONE) {
        const pair met = dpti_triangle_pair(surface, triangle, from, way);
        const double place = (2.0 * met.s - 1.0) * reach;
        const int side = place > 0.0;
        work_spend_between(work, 1);
        if (met.distance2 > 0.0 || !(fabs(place) < hits->distance[side]))
            continue;
        hits->distance[side] = fabs(place);
        hits->hit[side].triangle = triangle;
        memcpy(hits->hit[side].weight, met.weight, sizeof met.weight);
    }
}

static void add_hit(struct channel_point *point, const struct channel_hit *hit, double share)
{
    struct channel_hit *made = &point->hits[point->hit_count++];
    *made = *hit;
    for (int k = 0; k < 3; k++)
        made->weight[k] *= share;
}

/* Returns 0 if the point is not within the surface. */
static int find_point(struct channel_point *point, const struct surface *surface, const struct kernel *kernel, vec3 at,
                      vec3 axis, struct work *work)
{
    struct line_hits lines[3];
    vec3 directions[3] = { axis };
    double sum = 0.0;
    unit_across(axis, directions + 1);
    for (int i = 0; i < 3; i++) {
        find_hits(&lines[i], surface, kernel, at, directions[i], work);
        sum += 1.0 / (max_of(lines[i].distance[0], NEAR) * max_of(lines[i].distance[1], NEAR));
    }
    if (!(sum > 0.0) || work_is_spent(work))
        return 0;
    for (int i = 0; i < 3; i++) {
        const double before = max_of(lines[i].distance[0], NEAR), behind = max_of(lines[i].distance[1], NEAR);
        const double share = 1.0 / (before * behind * sum);
        if (!(share > 0.0))
            continue;
        add_hit(point, &lines[i].hit[0], share * behind / (before + behind));
        add_hit(point, &lines[i].hit[1], share * before / (before + behind));
    }
    return 1;
}

void dpti_channel_add_point(struct channel *channel, const struct surface *surface, const struct kernel *kernel,
                            vec3 at, double place, struct work *work)
{
    struct channel_point made = { .place = place };
    if (channel->point_count == CHANNEL_POINTS_MAX)
        return;
    if (!surface->motion)
        made.rest = at;
    else if (!find_point(&made, surface, kernel, at, channel->axis, work))
        return;
    channel->points[channel->point_count++] = made;
}

void dpti_channel_add_entry(struct channel *channel, const struct surface *surface)
{
    struct channel_point *point = &channel->points[0];
    const vec3 at = surface_point(surface, channel->triangle, channel->weight);
    *point = (struct channel_point){ .place = dot(sub(at, channel->mouth), channel->axis) };
    channel->point_count = 1;
    if (!surface->motion) {
        point->rest = along(channel->mouth, point->place, channel->axis);
        return;
    }
    const struct channel_hit hit = { .triangle = channel->triangle,
                                     .weight = { channel->weight[0], channel->weight[1], channel->weight[2] } };
    add_hit(point, &hit, 1.0);
    /* Where the axis misses the first wall it goes on beside the point. */
    point->offset = sub(along(channel->mouth, point->place, channel->axis), at);
}

double dpti_channel_next_point(const struct channel *channel)
{
    double step = FIRST_STEP * channel->radius;
    if (channel->point_count == CHANNEL_POINTS_MAX)
        return HUGE_VAL;
    for (uint32_t i = 1; i < channel->point_count; i++)
        step *= 2.0;
    return channel->points[0].place + max_of(step, channel->length / 1024.0);
}

double dpti_channel_held_by(const struct channel *channel, uint32_t number, double anchor)
{
    const int is_new = channel->deepest < channel->points[0].place + 2.0 * channel->radius;
    const double rim = number ? 0.0 : is_new ? 2.0 * channel->radius : channel->radius;
    const double from = channel->points[number].place - rim;
    const double to = number + 1 < channel->point_count ? channel->points[number + 1].place : HUGE_VAL;
    return max_of(0.0, min_of(anchor, to) - from);
}

double dpti_channel_share(const struct channel *channel, uint32_t number, double anchor)
{
    double sum = 0.0;
    for (uint32_t i = 0; i < channel->point_count; i++)
        sum += dpti_channel_held_by(channel, i, anchor);
    if (!(sum > 0.0))
        return number ? 0.0 : 1.0;
    return dpti_channel_held_by(channel, number, anchor) / sum;
}

void dpti_channel_points_at(const struct channel *channel, const struct surface *surface, vec3 at[CHANNEL_POINTS_MAX])
{
    for (uint32_t i = 0; i < channel->point_count; i++)
        at[i] = dpti_channel_point_at(surface, &channel->points[i]);
}

double dpti_channel_mean_place(const struct channel *channel, const vec3 at[CHANNEL_POINTS_MAX], double anchor,
                               vec3 tip, vec3 axis)
{
    double sum = 0.0;
    for (uint32_t i = 0; i < channel->point_count; i++) {
        const double share = dpti_channel_share(channel, i, anchor);
        if (share > 0.0)
            sum += share * (dot(sub(tip, at[i]), axis) + channel->points[i].place);
    }
    return sum;
}

void dpti_channel_follow(struct channel *channel, const struct surface *surface)
{
    if (!surface->motion || !channel->point_count)
        return;
    const struct channel_point *first = &channel->points[0], *last = &channel->points[channel->point_count - 1];
    const vec3 from = dpti_channel_point_at(surface, first), to = dpti_channel_point_at(surface, last);
    if (last->place - first->place >= APART * channel->radius)
        channel->axis = unit_of(sub(add(to, last->offset), add(from, first->offset)));
    channel->mouth = along(add(to, last->offset), -last->place, channel->axis);
}

static struct channel_stretch moved(struct channel_stretch stretch, double way)
{
    stretch.from += way;
    stretch.to += way;
    return stretch;
}

/* All walls that begin where the line is open are open, as are the first `kept`; and it is open to their ends. */
static void open_walls(struct channel *channel, uint32_t kept)
{
    channel->open_count = 0;
    while (channel->open_count < channel->wall_count &&
           (channel->open_count < kept || channel->walls[channel->open_count].from <= channel->opened))
        channel->opened = max_of(channel->opened, channel->walls[channel->open_count++].to);
}

/* Layers as they are found, by `way` along the line. One that the tip has gone into keeps its region. */
static void take_layers(struct channel *channel, const struct channel *found, double way)
{
    const int are_same = found->layer_count == channel->layer_count;
    for (uint32_t i = 0; i < found->layer_count; i++) {
        const struct channel_stretch was = channel->layers[i];
        channel->layers[i] = moved(found->layers[i], way);
        if (are_same && was.from < channel->deepest)
            channel->layers[i].region = was.region;
    }
    channel->layer_count = found->layer_count;
}

int dpti_channel_lay_again(struct channel *channel, const struct surface *surface, const uint8_t *regions,
                           const struct kernel *kernel, double from, struct work *work)
{
    struct channel line = *channel;
    struct channel_search search;
    line.mouth = along(channel->mouth, from, channel->axis);
    line.length = 2.0 * channel->length;
    if (!dpti_channel_search_near(&search, &line, surface, regions, kernel, work, &channel->near))
        return 0;
    const struct channel *found = &search.channel;
    /* Walls may move by more than they are thick: as many as before are the same ones. The first was the way in. */
    const uint32_t kept = found->wall_count == channel->wall_count && channel->open_count ? channel->open_count : 1;
    for (uint32_t i = 0; i < found->wall_count; i++)
        channel->walls[i] = moved(found->walls[i], from);
    take_layers(channel, found, from);
    channel->wall_count = found->wall_count;
    channel->entry = found->entry + from;
    /* Its rear end stays outside. */
    channel->limit = found->limit + from;
    if (found->wall_count)
        channel->limit = min_of(channel->limit, channel->walls[0].from + channel->length);
    open_walls(channel, kept);
    return 1;
}

void dpti_channel_open_wall(struct channel *channel)
{
    channel->opened = max_of(channel->opened, channel->walls[channel->open_count++].to + channel->radius);
}
