/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * How stiff a coupling a device can hold (docs/algorithms/coupling.md). A device is sampled: between two samples the
 * force stands still while the hand moves, so a spring gives back more than it took. The device's own damping must make
 * up for that. From what is known of the device and its loop, dpt_coupling_for_device chooses the stiffest coupling that
 * is stable with a gain margin.
 *
 *     dpt_coupling_def def;
 *     dpt_coupling coupling = { .size = sizeof coupling };
 *     dpt_coupling_def_init(&def);
 *     dpt_device_fill_coupling(&info, &def);            or fill in the fields of a device of your own
 *     def.rho = ...; def.lever = ...; def.zoom = ...;
 *     dpt_coupling_for_device(&def, &coupling);
 *     settings.stiffness = coupling.stiffness;
 *     settings.rotational_stiffness = coupling.rotational_stiffness;
 *
 * Pure: no device, no clock. May be called from any thread. It takes about a millisecond, so call it before the loop.
 */
#ifndef DYNPOINT_COUPLING_H
#define DYNPOINT_COUPLING_H

#include "dynpoint/types.h"

DPT_BEGIN

/*
 * What the coupling is chosen for. dpt_coupling_def_init fills in the defaults: 0 but where another is given last. Tool
 * and wishes are in the scene's metres, the device in the hand's.
 *
 * The device: as the fields of dpt_device_info with the same names; 0 is unknown, and for a limit none.
 *   mass, inertia             kg and kg m2, 0..1000
 *   damping, spin_damping     Ns/m and Nms/rad, 0..1e6
 *   friction, spin_friction   N and Nm, at least 0
 *   position_step, angle_step m and rad, at least 0
 *   delay                     s, 0..10: from a sample to its command, without the loop's
 *   force_max, torque_max     N and Nm, at least 0
 *   stiffness_max             N/m, that its maker states, at least 0
 * The loop:
 *   rate                      Hz, 1..100000; 1000
 *   loop_delay                s, 0..10: from a sample's arrival until its command is sent
 *   zoom                      metres of the scene for one of the hand, 1e-6..1e6; 1
 *   force_scale               newtons at the hand for one of the scene, 1e-6..1e6; 1
 * The tool:
 *   rho                       m, at least 0: root of the mean squared distance of the axis points from their centre;
 *                             L / sqrt(12) for one segment of length L
 *   lever                     m, at least 0: from the pose's origin to that centre
 * The wishes:
 *   stiffness                 N/m, 0..1e9; 0: as stiff as the device allows
 *   rotational_stiffness      Nm/rad, 0..1e9; 0: the stiffness times rho^2, as tools have it
 *   tool_damping              Ns/m, 0..1e9: dpt_tool_settings.damping
 *   gain_margin               1..100: the loop is stable even if stiffness and damping are so many times higher; 1.5
 */
typedef struct dpt_coupling_def {
    uint32_t size;       /* sizeof(dpt_coupling_def), set by dpt_coupling_def_init */
    uint32_t has_torque; /* 1: the device gives torque; 0: force alone, no limit of rotation; 0 */
    double mass;
    double inertia;
    double damping;
    double spin_damping;
    double friction;
    double spin_friction;
    double position_step;
    double angle_step;
    double delay;
    double force_max;
    double torque_max;
    double stiffness_max;
    double rate;
    double loop_delay;
    double zoom;
    double force_scale;
    double rho;
    double lever;
    double stiffness;
    double rotational_stiffness;
    double tool_damping;
    double gain_margin;
} dpt_coupling_def;

/* What limits the stiffness; dpt_coupling.limit. */
enum {
    DPT_COUPLING_ASKED = 0,     /* nothing: it is what was asked for */
    DPT_COUPLING_STABILITY = 1, /* translation: damping, rate and delay */
    DPT_COUPLING_ROTATION = 2,  /* rotation, by its own or by the lever */
    DPT_COUPLING_STEP = 3,      /* the steps of the encoder would be felt */
    DPT_COUPLING_MAKER = 4,     /* the maker's stiffness */
    DPT_COUPLING_UNKNOWN = 5    /* mass or damping is unknown; measure them */
};

/* Bits of dpt_coupling.flags. */
enum {
    /*
     * Friction is enough to stop what the encoder's steps stir up: it is at least half a step times the stiffness. A
     * device without that hums, by about two steps.
     */
    DPT_COUPLING_FLAG_RESTS = 1
};

/*
 * The choice. The first three are values for dpt_tool_settings, of the scene.
 *   limit         DPT_COUPLING_...
 *   delay         T/2 + t_d, s: half a period, and all delays
 *   delay_needed  what that must be for the stiffness that was asked for, rate and delays changed alike, within 1/1000
 *                 to 1000 times of `delay`; 0: nothing was asked, or mass or damping is unknown, or none is short enough
 *   stable        N/m at the hand: stiffness at which the sampled device alone is at its limit, without a margin. The
 *                 spectral radius of its exact model is 1 there; 0: unknown
 *   stable_turn   Nm/rad at the hand: likewise
 *   depth         m of the scene: where the force reaches force_max, at most DPT_COORDINATE_MAX; 0: there is none
 */
typedef struct dpt_coupling {
    uint32_t size; /* sizeof(dpt_coupling), set by the caller */
    uint32_t limit;
    uint32_t flags; /* DPT_COUPLING_FLAG_... */
    uint32_t reserved;
    double stiffness;            /* N/m */
    double rotational_stiffness; /* Nm/rad; 0: the stiffness times rho^2 */
    double damping;              /* Ns/m: the one asked for */
    double delay;
    double delay_needed;
    double stable;
    double stable_turn;
    double depth;
} dpt_coupling;

/* Fill in the first `size` bytes; what dpt_coupling_def_init calls with its own caller's sizeof. */
DPT_API void dpt_coupling_def_defaults(dpt_coupling_def *def, size_t size);

static inline void dpt_coupling_def_init(dpt_coupling_def *def)
{
    dpt_coupling_def_defaults(def, sizeof *def);
}

/*
 * Choose. The stiffness is never above the one asked for. Where mass or damping is unknown, it is at most the maker's,
 * or 100 N/m.
 *
 * DPT_E_ARGUMENT: a value is out of range. DPT_E_FINITE: one is not finite.
 */
DPT_API dpt_result dpt_coupling_for_device(const dpt_coupling_def *def, dpt_coupling *coupling);

/*
 * N/m: the stiffness up to which a mass with viscous damping is stable that is held by a sampled spring and damper. For
 * a plane that is the stiffest wall. Rotation is the same with inertia, Nms/rad and Nm/rad.
 *   damping          of the device, Ns/m
 *   period, delay    s; of delays above 16 periods within 0.1 %
 *   virtual_damping  on the difference of two samples, Ns/m
 * 0 if no stiffness is stable, or an argument is not finite, negative, or its mass or period is 0.
 */
DPT_API double dpt_stable_stiffness(double mass, double damping, double period, double delay, double virtual_damping);

DPT_END

#endif
