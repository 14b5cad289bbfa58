/* SPDX-License-Identifier: BSD-3-Clause */
#include "scene/scene_port.h"

static const vec3 tool_axis = { 0.0, 0.0, 1.0 };

int scene_port_set(struct scene_port *port, const double place[3], const double origin[3], double length_of_tool)
{
    const vec3 way = sub(vec3_of(place), vec3_of(origin));
    *port = (struct scene_port){ .is_given = 1, .place = vec3_of(place), .nearest = 0.5 * length_of_tool };
    if (!(length(way) > 0.0))
        return 0;
    port->outward = unit_of(way);
    port->upright = quaternion_of_turn(tool_axis, port->outward);
    return 1;
}

/* From the tip to the port; is_near: along `outward` it is the least that counts, whatever the tip does. */
static vec3 way_out(const struct scene_port *port, const double tip[3], int *is_near)
{
    const vec3 way = sub(port->place, vec3_of(tip));
    const double lacks = port->nearest - dot(way, port->outward);
    *is_near = lacks > 0.0;
    return *is_near ? along(way, lacks, port->outward) : way;
}

void scene_port_aim(const struct scene_port *port, const double tip[3], double orientation[4])
{
    int is_near;
    const vec3 way = way_out(port, tip, &is_near);
    quaternion_store(quaternion_product(quaternion_of_turn(port->outward, unit_of(way)), port->upright), orientation);
}

/*
 * With n the axis, n' its rate of change and o `outward`, the least turn from o has the angular velocity
 * n x n' - n (v . n') / (1 + o . n), v = o x n. So torque t has the power g . n', g = t x n - (t . n) v / (1 + o . n),
 * and n' is -1 / L times the tip's speed across n. o . n is above 0, as the way out is at least `nearest` along o.
 */
void scene_port_carry(const struct scene_port *port, const double tip[3], dpt_wrench *wrench)
{
    int is_near;
    const vec3 way = way_out(port, tip, &is_near), axis = unit_of(way), torque = vec3_of(wrench->torque);
    const vec3 across = cross(port->outward, axis);
    const double spin = dot(torque, axis) / (1.0 + dot(port->outward, axis));
    vec3 lever = scaled(along(cross(torque, axis), -spin, across), 1.0 / length(way));
    if (is_near)
        lever = along(lever, -dot(lever, port->outward), port->outward);
    vec3_store(sub(vec3_of(wrench->force), lever), wrench->force);
    for (int k = 0; k < 3; k++)
        wrench->torque[k] = 0.0;
}
