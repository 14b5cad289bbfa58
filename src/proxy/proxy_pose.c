/* SPDX-License-Identifier: BSD-3-Clause */
#include "proxy/proxy_pose.h"

#include "track/tool_parts.h"

/* A tool is straight if no end is farther from the line of its longest segment than that share of its length. */
#define STRAIGHT 1e-9

/* rad: a smaller spin is left out, so that a proxy at rest keeps its bits. */
#define SPUN 1e-8

/* m: below this length, or this size of a tool, it is a point: a ball, whose turns are not felt. */
#define BALL 1e-9

/* By which factor a rotational stiffness may change rho at most, so that the unknowns stay finite. */
#define RHO_FACTOR 1e3

/* The line of all segments: from one end to the end that is farthest from it. */
static int is_straight(const struct segment *segments, uint32_t count, vec3 *axis)
{
    const vec3 from = segments[0].a;
    double longest = -1.0;
    for (uint32_t i = 0; i < 2 * count; i++) {
        const vec3 u = sub(i % 2 ? segments[i / 2].a : segments[i / 2].b, from);
        if (length(u) > longest) {
            longest = length(u);
            *axis = u;
        }
    }
    *axis = unit_of(*axis);
    for (uint32_t i = 0; i < count; i++)
        if (length(cross(sub(segments[i].a, from), *axis)) > STRAIGHT * longest ||
            length(cross(sub(segments[i].b, from), *axis)) > STRAIGHT * longest)
            return 0;
    return 1;
}

/* Whether a body that the proxy remembers has friction. */
static int is_rubbing(const struct dpt_world *world, const struct proxy *proxy)
{
    for (uint32_t i = 0; i < PROXY_MEMORY; i++) {
        const uint32_t id = proxy->memory[i].body_id;
        const struct body *body = id ? world_find_body(world, id) : NULL;
        if (body && body->static_friction > 0.0)
            return 1;
    }
    return 0;
}

/* m: the lever of friction against a spin. One that is so thin has none: the square of its lever may be 0. */
static double spin_radius_of(const struct segment *segments, uint32_t count)
{
    double max_radius = 0.0;
    for (uint32_t i = 0; i < count; i++)
        max_radius = max_of(max_radius, segments[i].radius);
    return max_radius > BALL ? max_radius : 0.0;
}

/* The ends of a segment, or of a tip's axis where the tool was given it: a jaw that opens changes no force. */
static void ends_of(struct part part, vec3 *a, vec3 *b)
{
    *a = part.tip ? part.tip->home_a : part.segment->a;
    *b = part.tip ? part.tip->home_b : part.segment->b;
}

/* How far a tip's corners are from the centre. */
static double tip_extent(const struct dpt_hull *hull, vec3 centre)
{
    double farthest = 0.0;
    for (uint32_t i = 0; i < hull->corner_count; i++)
        farthest = max_of(farthest, length(sub(hull->corner[i], centre)));
    return farthest;
}

/* The mean of |x - centre|^2 over a segment is that of its middle and a twelfth of its square. Points count alike. */
void dpti_proxy_measure(const struct dpt_world *world, const struct tool *tool, struct proxy *proxy)
{
    const struct segment *segments = &world->segments[tool->first_segment];
    const uint32_t count = tool_part_count(tool);
    double whole = 0.0, weights = 0.0, square = 0.0;
    vec3 sum = { 0.0, 0.0, 0.0 }, a, b;
    for (uint32_t i = 0; i < count; i++) {
        ends_of(tool_part(world, tool, i), &a, &b);
        whole += length(sub(b, a));
    }
    for (uint32_t i = 0; i < count; i++) {
        ends_of(tool_part(world, tool, i), &a, &b);
        const double weight = whole > BALL ? length(sub(b, a)) : 1.0;
        sum = along(sum, 0.5 * weight, add(a, b));
        weights += weight;
    }
    proxy->centre = scaled(sum, 1.0 / weights);
    proxy->extent = 0.0;
    for (uint32_t i = 0; i < count; i++) {
        ends_of(tool_part(world, tool, i), &a, &b);
        const vec3 u = sub(b, a);
        a = sub(a, proxy->centre);
        b = sub(b, proxy->centre);
        const vec3 middle = scaled(add(a, b), 0.5);
        square += (whole > BALL ? length(u) : 1.0) * (dot(middle, middle) + dot(u, u) / 12.0);
        proxy->extent = max_of(proxy->extent, max_of(length(a), length(b)));
    }
    for (uint32_t i = 0; i < tool->tip_count; i++)
        proxy->extent = max_of(proxy->extent, tip_extent(tool_tip(world, tool, i)->hull, proxy->centre));
    const double own = max_of(sqrt(square / weights), BALL);
    if (tool->tip_count)
        proxy->shape = PROXY_BENT;
    else if (!(proxy->extent > BALL))
        proxy->shape = PROXY_BALL;
    else
        proxy->shape = is_straight(segments, tool->segment_count, &proxy->axis) ? PROXY_STRAIGHT : PROXY_BENT;
    double rho = sqrt(square / weights);
    if (tool->rotational_stiffness > 0.0 && tool->stiffness > 0.0)
        rho = sqrt(tool->rotational_stiffness / tool->stiffness);
    rho = min_of(max_of(rho, own / RHO_FACTOR), own * RHO_FACTOR);
    proxy->coupling = (struct coupling){ tool->stiffness, tool->lock_rotation ? own * RHO_FACTOR : rho,
                                         proxy->shape == PROXY_STRAIGHT && is_rubbing(world, proxy)
                                             ? spin_radius_of(segments, tool->segment_count)
                                             : 0.0 };
}

struct proxy_pose dpti_proxy_pose_of(const struct proxy *proxy, const dpt_pose *pose)
{
    struct proxy_pose made = { .pose = *pose };
    /* A pose may be off unit length by 1e-6; the frame is not. */
    made.turn = quaternion_unit(quaternion_of(pose->orientation));
    frame_of_pose(pose, &made.frame);
    made.centre = frame_to_world(&made.frame, proxy->centre);
    made.axis = frame_turn(&made.frame, proxy->axis);
    return made;
}

struct proxy_pose dpti_proxy_device_in_channel(const struct tool *tool, const struct proxy *proxy,
                                               struct quaternion turn)
{
    dpt_pose pose = tool->pose;
    if (tool->lock_rotation)
        quaternion_store(turn, pose.orientation);
    return dpti_proxy_pose_of(proxy, &pose);
}

/* The orientation with this axis, by the least turn from the device's. */
static struct quaternion turned_to(const struct proxy_pose *device, vec3 axis)
{
    return quaternion_unit(quaternion_product(quaternion_of_turn(device->axis, axis), device->turn));
}

/* rad: the spin of a straight tool from one pose to another, beside the least turn between its axes. */
static double spin_of(const struct proxy_pose *from, const struct proxy_pose *to)
{
    const struct quaternion spun = quaternion_product(to->turn, quaternion_inverse(turned_to(from, to->axis)));
    return dot(quaternion_rotation_vector(spun), to->axis);
}

/* The same segments in another orientation. */
static struct proxy_pose with_turn(const struct proxy *proxy, const struct proxy_pose *at, struct quaternion turn)
{
    dpt_pose pose;
    quaternion_store(turn, pose.orientation);
    vec3_store(sub(at->centre, quaternion_turn(turn, proxy->centre)), pose.position);
    return dpti_proxy_pose_of(proxy, &pose);
}

struct proxy_pose dpti_proxy_spun_as(const struct proxy *proxy, const struct proxy_pose *at,
                                     const struct proxy_pose *device, double spin_max)
{
    struct quaternion turn = device->turn;
    if (proxy->shape == PROXY_BENT)
        return *at;
    if (proxy->shape == PROXY_STRAIGHT)
        turn = turned_to(device, at->axis);
    if (proxy->coupling.spin_rho > 0.0) {
        const double spin = spin_of(device, at);
        if (fabs(spin) <= spin_max)
            return *at;
        const vec3 limit = scaled(at->axis, spin > 0.0 ? spin_max : -spin_max);
        turn = quaternion_product(quaternion_of_small_turn(limit), turn);
    }
    turn = quaternion_unit(turn);
    const struct quaternion now = quaternion_unit(at->turn);
    const double sign = turn.w * now.w + dot(turn.v, now.v) < 0.0 ? 1.0 : -1.0;
    const double off_w = turn.w + sign * now.w;
    const vec3 off = along(turn.v, sign, now.v);
    if (off_w * off_w + dot(off, off) < SPUN * SPUN)
        return *at;
    return with_turn(proxy, at, turn);
}

dpt_pose dpti_proxy_told_pose(const struct proxy *proxy)
{
    const struct proxy_pose at = dpti_proxy_pose_of(proxy, &proxy->pose);
    const struct proxy_pose device = dpti_proxy_pose_of(proxy, &proxy->device_pose);
    return proxy->coupling.spin_rho > 0.0 ? proxy->pose : dpti_proxy_spun_as(proxy, &at, &device, 0.0).pose;
}

struct displacement dpti_proxy_displacement(const struct proxy *proxy, const struct proxy_pose *from,
                                            const struct proxy_pose *to)
{
    struct displacement moved = { sub(to->centre, from->centre), { 0.0, 0.0, 0.0 }, 0.0 };
    if (proxy->shape == PROXY_STRAIGHT)
        moved.turn = least_turn(from->axis, to->axis);
    else if (proxy->shape == PROXY_BENT)
        moved.turn = quaternion_rotation_vector(quaternion_product(to->turn, quaternion_inverse(from->turn)));
    if (proxy->coupling.spin_rho > 0.0)
        moved.spin = spin_of(from, to);
    return moved;
}

/* rad: where the torque of the spring is largest. */
#define TURN_PULLED 1.0

/* rad: the turn that the spring's torque stands for. */
static double turn_pulled(double angle)
{
    return min_of(min_of(angle, TURN_PULLED), max_of(0.0, 0.5 * ANGLE_TURN - angle));
}

struct displacement dpti_proxy_pulled(const struct displacement *displacement)
{
    struct displacement pulled = *displacement;
    const double angle = length(pulled.turn);
    if (angle > TURN_PULLED)
        pulled.turn = scaled(pulled.turn, turn_pulled(angle) / angle);
    return pulled;
}

double dpti_proxy_stored_beyond(const struct displacement *displacement)
{
    const double angle = length(displacement->turn), falls_from = 0.5 * ANGLE_TURN - TURN_PULLED;
    const double pulled = turn_pulled(angle);
    if (!(angle > TURN_PULLED))
        return 0.0;
    return angle <= falls_from ? TURN_PULLED * (angle - TURN_PULLED) : TURN_PULLED * falls_from - pulled * pulled;
}

void dpti_proxy_turn_axes(const struct proxy *proxy, const struct proxy_pose *at, vec3 axes[3])
{
    axes[0] = (vec3){ 1.0, 0.0, 0.0 };
    axes[1] = (vec3){ 0.0, 1.0, 0.0 };
    axes[2] = (vec3){ 0.0, 0.0, 1.0 };
    if (proxy->shape != PROXY_STRAIGHT)
        return;
    unit_across(at->axis, axes);
    axes[2] = at->axis;
}

void dpti_proxy_to_unknowns(const struct proxy *proxy, const vec3 axes[3], const struct displacement *displacement,
                            double *unknowns)
{
    const uint32_t turns = proxy->shape == PROXY_STRAIGHT ? 5 : proxy_unknowns(proxy);
    vec3_store(displacement->shift, unknowns);
    for (uint32_t k = 3; k < turns; k++)
        unknowns[k] = proxy->coupling.rho * dot(displacement->turn, axes[k - 3]);
    if (proxy->coupling.spin_rho > 0.0)
        unknowns[5] = proxy->coupling.spin_rho * displacement->spin;
}

struct displacement dpti_proxy_of_unknowns(const struct proxy *proxy, const vec3 axes[3], const double *unknowns)
{
    const uint32_t turns = proxy->shape == PROXY_STRAIGHT ? 5 : proxy_unknowns(proxy);
    struct displacement moved = { vec3_of(unknowns), { 0.0, 0.0, 0.0 }, 0.0 };
    for (uint32_t k = 3; k < turns; k++)
        moved.turn = along(moved.turn, unknowns[k] / proxy->coupling.rho, axes[k - 3]);
    if (proxy->coupling.spin_rho > 0.0)
        moved.spin = unknowns[5] / proxy->coupling.spin_rho;
    return moved;
}

struct proxy_pose dpti_proxy_moved(const struct proxy *proxy, const struct proxy_pose *at,
                                   const struct displacement *displacement)
{
    struct quaternion turn = at->turn;
    if (proxy->shape != PROXY_BALL)
        turn = quaternion_unit(quaternion_product(quaternion_of_small_turn(proxy_whole_turn(displacement, at)), turn));
    struct proxy_pose from = *at;
    from.centre = add(at->centre, displacement->shift);
    return with_turn(proxy, &from, turn);
}
