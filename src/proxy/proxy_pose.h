/* SPDX-License-Identifier: BSD-3-Clause */
/* Where a proxy is, how far it is from its device, and its small motions: docs/algorithms/force.md. */
#ifndef DPT_PROXY_POSE_H
#define DPT_PROXY_POSE_H

#include "force/spring.h"
#include "track/world_state.h"

/* A tool's placement, with what is worked out of it once. */
struct proxy_pose {
    dpt_pose pose; /* of the tool's frame, in the world */
    struct frame frame;
    struct quaternion turn;
    vec3 centre; /* in the world */
    vec3 axis;   /* unit, in the world, of a straight tool */
};

/*
 * The unknowns of a motion: 3 of the shift, then of the turn 0 (a ball), 2 (a straight tool) or 3; then the spin of a
 * straight tool, if friction can hold it.
 */
static inline uint32_t proxy_unknowns(const struct proxy *proxy)
{
    if (proxy->shape != PROXY_STRAIGHT)
        return proxy->shape == PROXY_BALL ? 3 : 6;
    return proxy->coupling.spin_rho > 0.0 ? 6 : 5;
}

/* m: what a turn by 1 rad counts as, for an unknown from 3 on. */
static inline double proxy_rho_of(const struct proxy *proxy, uint32_t unknown)
{
    return unknown == 5 && proxy->shape == PROXY_STRAIGHT ? proxy->coupling.spin_rho : proxy->coupling.rho;
}

/* The whole turn of a displacement from a pose, its spin included. */
static inline vec3 proxy_whole_turn(const struct displacement *displacement, const struct proxy_pose *from)
{
    return along(displacement->turn, displacement->spin, from->axis);
}

/* Centre, extent, coupling and shape of a tool, from its segments; again whenever they change. */
void dpti_proxy_measure(const struct dpt_world *world, const struct tool *tool, struct proxy *proxy);

struct proxy_pose dpti_proxy_pose_of(const struct proxy *proxy, const dpt_pose *pose);

/*
 * `at`, with the device's spin about the tool's own axis, of a ball with all of its turn: no contact holds these. Where
 * friction can hold the spin, it stays within `spin_max`, rad, of the device's. The tool's segments stay where they
 * are.
 */
struct proxy_pose dpti_proxy_spun_as(const struct proxy *proxy, const struct proxy_pose *at,
                                     const struct proxy_pose *device, double spin_max);

/* The pose as it is told: a spin that is not felt follows the device. Within a tick it would move ends by rounding. */
dpt_pose dpti_proxy_told_pose(const struct proxy *proxy);

/*
 * The device as a proxy in a channel feels it (src/proxy/proxy_channel.h). One that gives no torque (lock_rotation) turns the
 * tool about the origin of its frame to how the proxy is turned, without being felt.
 */
struct proxy_pose dpti_proxy_device_in_channel(const struct tool *tool, const struct proxy *proxy,
                                               struct quaternion turn);

/* From one pose to another; of a straight tool the least turn between its axes, and the spin beside it. */
struct displacement dpti_proxy_displacement(const struct proxy *proxy, const struct proxy_pose *from,
                                            const struct proxy_pose *to);

/*
 * A displacement as the spring pulls: beyond 1 rad its torque grows no more, and within 1 rad of half a turn it falls to
 * nothing, as the least turn changes its direction there. The turn is that of the torque.
 */
struct displacement dpti_proxy_pulled(const struct displacement *displacement);

/* rad^2: what the spring stores in the turn of a displacement, over K_r, beyond half the square of the turn of its pull. */
double dpti_proxy_stored_beyond(const struct displacement *displacement);

/* Two unit vectors across the axis, then the axis, for the turns of a straight tool; of others the world's x, y, z. */
void dpti_proxy_turn_axes(const struct proxy *proxy, const struct proxy_pose *at, vec3 axes[3]);

/* A displacement as unknowns, all in m, and back. */
void dpti_proxy_to_unknowns(const struct proxy *proxy, const vec3 axes[3], const struct displacement *displacement,
                            double *unknowns);
struct displacement dpti_proxy_of_unknowns(const struct proxy *proxy, const vec3 axes[3], const double *unknowns);

/* `at`, moved; the turn must be small (quaternion_of_small_turn). */
struct proxy_pose dpti_proxy_moved(const struct proxy *proxy, const struct proxy_pose *at,
                                   const struct displacement *displacement);

#endif
