/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A port in a wall, through which a tool enters: the fulcrum about which it turns. A hand that gives three coordinates
 * moves the tip; the tool's z axis leads from there through the port.
 *
 * The port holds the tool across without friction, so it does no work. What the hand feels at the tip is then the force
 * and torque on the tool by the lever about the port: a force across, at `s` from the tip of a tool whose port is at L,
 * has the share 1 - s / L. It is the gradient of the same energy, as it is the derivative of the pose by the tip's place.
 *
 * Nearer to the port's plane than half the tool's length the tool's axis turns no faster than it does there, and passes
 * beside the port: so no lever is longer than 1, and a tip that is drawn out of the port does not turn the tool over.
 * Where it comes so near beside the line from its first place to the port, the force along that line has a step.
 */
#ifndef DPT_SCENE_PORT_H
#define DPT_SCENE_PORT_H

#include "base/quaternion.h"
#include "dynpoint/types.h"

/* Begin with zeros: no port. */
struct scene_port {
    int is_given;
    vec3 place;                /* m, in the scene's frame */
    vec3 outward;              /* unit vector: from where the tip is at first to the port */
    struct quaternion upright; /* the least turn of the tool's z axis to it */
    double nearest;            /* m, above 0: along `outward`, how far the port counts as away from the tip at least */
};

/*
 *   place    of the port, m
 *   origin   where the tip is at first, m
 *   length   of the tool, m, above 0
 * Returns 0 if the two places are one.
 */
int scene_port_set(struct scene_port *port, const double place[3], const double origin[3], double length);

/* The orientation of a tool whose tip is there: `upright`, then the least turn of its axis, below a right angle. */
void scene_port_aim(const struct scene_port *port, const double tip[3], double orientation[4]);

/* The wrench on a tool, with its torque about the tip, as force at the tip. */
void scene_port_carry(const struct scene_port *port, const double tip[3], dpt_wrench *wrench);

#endif
