/* SPDX-License-Identifier: BSD-3-Clause */
#include "world/broad_phase.h"

struct box dpti_box_in_world(vec3 low, vec3 high, const struct frame *frame)
{
    vec3 half = scaled(sub(high, low), 0.5);
    vec3 centre = frame_to_world(frame, scaled(add(low, high), 0.5));
    double slop = 0x1p-46 * (extent_of(centre) + extent_of(low) + extent_of(high));
    vec3 wide = {
        fabs(frame->x.x) * half.x + fabs(frame->y.x) * half.y + fabs(frame->z.x) * half.z + slop,
        fabs(frame->x.y) * half.x + fabs(frame->y.y) * half.y + fabs(frame->z.y) * half.z + slop,
        fabs(frame->x.z) * half.x + fabs(frame->y.z) * half.y + fabs(frame->z.z) * half.z + slop,
    };
    return (struct box){ sub(centre, wide), add(centre, wide) };
}

void dpti_near_move(struct near *near, vec3 a, vec3 b)
{
    /* Forgotten within some hundred ticks: a list should not be made anew at each stop. */
    near->speed *= 1.0 - 1.0 / 256.0;
    if (near->known) {
        double motion = larger(length(sub(a, near->a)), length(sub(b, near->b)));
        near->speed = larger(near->speed, motion);
    }
    near->a = a;
    near->b = b;
    near->known = 1;
}

double dpti_near_reach(const struct near *near)
{
    struct box axis = box_of_axis(near->a, near->b);
    const struct box *home = &near->now.box;
    if (!(near->now.room > 0.0))
        return 0.0;
    double least = smaller(axis.low.x - home->low.x, home->high.x - axis.high.x);
    least = smaller(least, smaller(axis.low.y - home->low.y, home->high.y - axis.high.y));
    least = smaller(least, smaller(axis.low.z - home->low.z, home->high.z - axis.high.z));
    return larger(0.0, least);
}

/* Room for 128 ticks of the present motion, and for some that begins from rest. */
static double wanted(const struct near *near, double distance)
{
    double size = length(sub(near->b, near->a));
    return distance + 0.125 * (distance + size) + 128.0 * near->speed;
}

int dpti_near_is_wide(const struct near *near, double distance)
{
    return near->now.room > 4.0 * wanted(near, distance);
}

void dpti_near_settle(struct near *near, double distance)
{
    struct box axis = box_of_axis(near->a, near->b);
    double room = wanted(near, distance);
    vec3 all = { room, room, room };
    near->next = (struct home){ .box = { sub(axis.low, all), add(axis.high, all) },
                                .room = room,
                                .which = 1 - near->now.which };
    near->scanning = 1;
    near->scanned = 0;
}

void dpti_near_arrive(struct near *near)
{
    near->now = near->next;
    near->scanning = 0;
}
