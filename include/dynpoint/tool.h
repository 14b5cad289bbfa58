/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Tools of a world: segments, and tips (tip.h), that feel its bodies. Each step gives them a nearest pair, contacts, and
 * a wrench.
 *
 * Answers are those of the last step, whatever was set after it. They may name a body that was removed after it.
 *
 * Threads: as for the world.
 */
#ifndef DYNPOINT_TOOL_H
#define DYNPOINT_TOOL_H

#include "dynpoint/world.h"

DPT_BEGIN

/*
 * A tool is `count` segments in its own frame, at the identity pose at first. Before each step, give a rigid tool its
 * pose, or a free tool its segments. Both move the tool, and the motion is swept; dpt_tool_teleport jumps without a
 * sweep. If the input cannot be used (NULL, not finite, quaternion not of unit length, another count), the call fails,
 * and the tool is stale and has no force until it gets valid input.
 *
 * dpt_tool_set_segments sets the segments in the world frame, as many as the tool has; radii may change. The tool is
 * free then. Several segments with a proxy (DPT_LAW_PROXY) are DPT_E_UNSUPPORTED: move such a tool by its pose.
 * dpt_tool_set_pose and dpt_tool_teleport make it rigid again: the segments set last are taken as segments in its own
 * frame.
 *
 * dpt_tool_get_pose returns the last valid pose, or the identity while the tool is free. `user` is a value of the
 * caller's own, 0 at first.
 */
DPT_API dpt_result dpt_tool_add(dpt_world *world, const dpt_segment *segments, uint32_t count, dpt_tool *tool);
DPT_API dpt_result dpt_tool_remove(dpt_world *world, dpt_tool tool);
DPT_API dpt_result dpt_tool_set_pose(dpt_world *world, dpt_tool tool, const dpt_pose *pose);
DPT_API dpt_result dpt_tool_set_segments(dpt_world *world, dpt_tool tool, const dpt_segment *segments, uint32_t count);
DPT_API dpt_result dpt_tool_teleport(dpt_world *world, dpt_tool tool, const dpt_pose *pose);
DPT_API dpt_result dpt_tool_get_pose(const dpt_world *world, dpt_tool tool, dpt_pose *pose);
DPT_API dpt_result dpt_tool_set_user(dpt_world *world, dpt_tool tool, uint64_t user);
DPT_API dpt_result dpt_tool_get_user(const dpt_world *world, dpt_tool tool, uint64_t *user);

/*
 * Test a motion without moving the tool: from where it was last set to `pose`, or to `segments` in the world frame, up
 * to the first touch. The path is that of a step. Bodies rest where they were last set. The world does not change, and
 * no budget is spent. A long rotation near a large mesh takes far longer than a step.
 *
 *   clearance  m. A surface touches if it is within the radius plus this. If that sum is negative, the axis itself is
 *              tested
 *   first      the first touch, as in dpt_tool_get_sweep; may be NULL.
 *              DPT_SWEEP_HIT   a touch at `time`; 0 if something touches at the beginning. The normal is zero if the
 *                              axis goes through the surface there
 *              DPT_SWEEP_FREE  no touch; `time` is 1
 *              DPT_SWEEP_NONE  unknown, because the tool's or a body's pose cannot be used; `time` is 0
 *   reached    where the tool is at `time`; may be NULL. If `time` is not 0, nothing touches the tool there. With
 *              segments: `count` of them, and it may be the array `segments`
 *
 * Errors are those of dpt_tool_set_pose and dpt_tool_set_segments. They leave outputs and the tool as they were. A
 * clearance that is not finite or beyond DPT_COORDINATE_MAX is DPT_E_FINITE.
 */
DPT_API dpt_result dpt_tool_try_pose(const dpt_world *world, dpt_tool tool, const dpt_pose *pose, double clearance,
                                     dpt_sweep *first, dpt_pose *reached);
DPT_API dpt_result dpt_tool_try_segments(const dpt_world *world, dpt_tool tool, const dpt_segment *segments,
                                         uint32_t count, double clearance, dpt_sweep *first, dpt_segment *reached);

/*
 * Settings of a tool; used like dpt_body_settings. DPT_LAW_PROXY for a free tool of several segments is
 * DPT_E_UNSUPPORTED.
 */
typedef struct dpt_tool_settings {
    uint32_t size;    /* sizeof(dpt_tool_settings), set by the caller */
    uint32_t law;     /* DPT_LAW_...; changing it is a teleport to where the tool is */
    double stiffness; /* N/m, 0..1e9; 0: no force */
    /*
     * Of the proxy, Nm/rad, 0..1e9; 0: stiffness times the mean square of the distance of the segments' points from
     * their centre, which is L^2 / 12 for one segment of length L. It counts as 1e-6 to 1e6 times that. Of points
     * alone, all count alike. The torque grows with the turn up to 1 rad. A tool that stands on its tip stands up to the
     * force of twice this stiffness over L, and leans or lies beyond it: 7.5 L Nm/rad hold it up to 10 N.
     */
    double rotational_stiffness;
    /*
     * Of the proxy, Ns/m, 0..1e9: a damper beside the spring, in rotation in the same proportion. It takes its speed
     * from the last two steps, and never pulls the tool towards the surface; 0
     */
    double damping;
    /* 1: the proxy does not turn away from the device, for devices that give no torque; 0 */
    uint32_t lock_rotation;
    /*
     * 1: of the tool's segments, those alone are searched for that may be nearest, or within the margin of a body. The
     * hit of each other is DPT_STATUS_BOUNDED, with a pair that was nearest before and a true lower bound, and without a
     * gap; dpt_step.status does not count it. For tools of many segments. With DPT_METHOD_EXACT alone, the others search
     * for all; docs/algorithms/near_only.md; 0
     */
    uint32_t near_only;
    /*
     * DPT_PIERCING_...: the end of its segment with which the tool pierces bodies that can be (insertion.h). For rigid
     * tools of one segment of a length and radius above 0, without tips and with DPT_LAW_PROXY, in worlds with room for
     * channels; else DPT_E_UNSUPPORTED. A change takes it out of its channels, as a teleport does.
     * dpt_tool_set_segments makes it DPT_PIERCING_NONE and closes its holes. DPT_PIERCING_NONE
     */
    uint32_t piercing;
    uint32_t reserved; /* 0 */
} dpt_tool_settings;

enum { DPT_PIERCING_NONE = 0, DPT_PIERCING_A = 1, DPT_PIERCING_B = 2 };

DPT_API dpt_result dpt_tool_set_settings(dpt_world *world, dpt_tool tool, const dpt_tool_settings *settings);
DPT_API dpt_result dpt_tool_get_settings(const dpt_world *world, dpt_tool tool, dpt_tool_settings *settings);

/*
 * The pose of the tool's proxy, from the last step: of its frame, in the world; of a free tool that of a frame whose
 * origin is end a and whose x axis points to end b. It is the device's pose where nothing is in the way. For a viewer
 * to draw. Before the first step since the tool was placed it is where the tool was set last. A tool without a proxy
 * has the pose of dpt_tool_get_pose. The identity on an error.
 *
 * While a free tool touches something, its proxy grows only slowly to a greater length or radius.
 */
DPT_API dpt_result dpt_tool_get_proxy(const dpt_world *world, dpt_tool tool, dpt_pose *pose);

/*
 * The pose in which the last step of springs left the tool (dpt_body_step_springs), beside the tissue as it is after that.
 * There friction holds it, and there its proxy goes in the next step of the world. It is the pose of dpt_tool_get_proxy
 * after a step of the world, until springs are stepped, and for tools that touch none. The identity on an error.
 */
DPT_API dpt_result dpt_tool_get_end(const dpt_world *world, dpt_tool tool, dpt_pose *pose);

/* As dpt_body_is_valid. */
DPT_API int dpt_tool_is_valid(const dpt_world *world, dpt_tool tool);

/*
 * The nearest pair of a tool and all bodies, from the last step, at the device's pose. Where a proxy is held back, the
 * contact is DPT_CONTACT_PENETRATING, and gap and depth are not known. The force does not need this pair, so it is
 * searched for when it is read first: here, in a snapshot, or in a step that reports (dpt_world_step). The search spends
 * no more than the step has left of its budget. It adds to the hit's `work` and not to dpt_world_info.work, and nothing
 * later depends on it. If a body was added, removed, teleported, or made felt or unfelt between the step and the first
 * reading, or with tips if a body was moved, the hit is stale. With deformable bodies, and with near_only, each step
 * searches.
 */
DPT_API dpt_result dpt_tool_get_hit(const dpt_world *world, dpt_tool tool, dpt_hit *hit);

/* The same of one segment of the tool, from 0. */
DPT_API dpt_result dpt_tool_get_segment_hit(const dpt_world *world, dpt_tool tool, uint32_t segment, dpt_hit *hit);

/*
 * The tool's contacts, from the last step. They are sorted by segment. Within a segment they are grouped by body, in no
 * stated order of bodies. Within a body they run from the segment's end a.
 *   contacts   at most `capacity` are written. contacts[0].size must be set. May be NULL if capacity is 0
 *   count      how many there are, which may be more than `capacity`
 *
 * DPT_E_FULL: the world has no room for contacts, as by default: dpt_world_def.max_contacts is 0. Then none are searched
 * for, and `count` is 0.
 */
DPT_API dpt_result dpt_tool_get_contacts(const dpt_world *world, dpt_tool tool, dpt_contact *contacts,
                                         uint32_t capacity, uint32_t *count);

/* The first touch of a segment of the tool (counted from 0) between the last two steps. A proxy has none. */
DPT_API dpt_result dpt_tool_get_sweep(const dpt_world *world, dpt_tool tool, uint32_t segment, dpt_sweep *sweep);

/*
 * The strip of a segment (counted from 0), and the overlap of the segment with each of its triangles, as
 * dpt_strip_overlaps computes it. The strip is empty if the segment was not within the margin, or if the world has no
 * strips. A strip of routes is also empty if the triangles of the segment's ends and of the nearest point are not
 * connected.
 *   flags   DPT_STRIP_FLAG_...; may be NULL
 */
DPT_API dpt_result dpt_tool_get_strip(const dpt_world *world, dpt_tool tool, uint32_t segment, dpt_overlap *overlaps,
                                      uint32_t capacity, uint32_t *count, uint32_t *flags);

/*
 * Whether a tool feels a force in the last step, and if not, why. The first of these that holds:
 *   STALE      there is no answer: the tool was added or teleported, or the world was reset, after the last step; or
 *              the step failed; or the tool's or a body's input cannot be used
 *   OFF        the world's `until` ends before the response, or the tool's stiffness is 0
 *   ACTS       at least one segment is pushed: there is a force
 *   UNDECIDED  at least one segment may touch something, but the direction of its force is unknown: its contact is
 *              DPT_CONTACT_UNKNOWN, or it goes through a surface that has no sides
 *   FREE       no segment penetrates anything, or there are no bodies
 *   INSIDE     DPT_LAW_PROXY: the tool began inside something, or a body was added or teleported around it, and it has
 *              not been outside since
 */
enum {
    DPT_FORCE_ACTS = 0,
    DPT_FORCE_FREE = 1,
    DPT_FORCE_STALE = 2,
    DPT_FORCE_UNDECIDED = 3,
    DPT_FORCE_OFF = 4,
    DPT_FORCE_INSIDE = 5
};

/* Bits of dpt_force_info.flags. */
enum {
    /* The wrench fades and has not reached its new value, so it may differ from zero whatever `reason` says. */
    DPT_FORCE_FLAG_FADING = 1,
    /* The reason is DPT_FORCE_ACTS, but another segment is undecided, and its part of the wrench is missing. */
    DPT_FORCE_FLAG_PARTIAL = 2,
    /* The pose that held the proxy is gone, and it moves on to another: the force may change fast. */
    DPT_FORCE_FLAG_FOLD = 4,
    /*
     * Moving bodies leave the proxy no free pose, and it is put at the device. There it counts as inside
     * (DPT_FORCE_INSIDE) until it is on the side of all surfaces on which it was. The step's contacts are those before.
     * Where it was stepped together with tissue, it stays: the tissue dents it by up to a half of its radius.
     */
    DPT_FORCE_FLAG_SQUEEZED = 8,
    /*
     * The proxy was turned by more than 1 rad from the device, which has itself turned by 1 rad or more since the proxy
     * was last with it; likewise. A proxy that leans or lies while the device does not turn so far stays where it is.
     */
    DPT_FORCE_FLAG_REPLACED = 16,
    /* A function of the program's own has had the wrench; see dpt_tool_set_shaper. */
    DPT_FORCE_FLAG_SHAPED = 32,
    /*
     * A budget made the proxy wait, or what is felt of it has not caught up since. The wrench is what the surfaces that
     * hold the proxy would give if it had gone on along them, and changes no faster than without a budget:
     * docs/algorithms/force.md.
     */
    DPT_FORCE_FLAG_BEHIND = 64,
    /*
     * The wrench is that of the tissue's step (springs.h), and is not what the proxy's distance from the device says: they
     * differ by more than 5 % plus 5 mN. The surface has moved fast, or has let the proxy go.
     */
    DPT_FORCE_FLAG_APART = 128,
    /*
     * In the tissue's step the tool touched in more places than are counted at one time, or than the budget was enough for:
     * the nearest were. Or there was no push that kept it out of all of them.
     */
    DPT_FORCE_FLAG_CROWDED = 256,
    /* A wall has ruptured before the tip, in this step or just before: the force drops (insertion.h). */
    DPT_FORCE_FLAG_RUPTURE = 512,
    /*
     * The tool is in a channel, or has come out of its last one in this step: friction along its shaft and cutting at its
     * tip are part of the wrench.
     */
    DPT_FORCE_FLAG_INSERTED = 1024,
    /* A wall holds that would have ruptured, as the world or the tool has no room for another channel. */
    DPT_FORCE_FLAG_CHANNELS_FULL = 2048
};

/*
 * What a tool feels in the last step.
 *
 *   wrench  force on the tool, and torque about the origin of its frame (of a free tool: about end a of its first
 *           segment), in world axes, before any limits; docs/algorithms/force.md. With DPT_LAW_POINT it is the sum
 *           over the tool's segments. Zero unless `reason` is DPT_FORCE_ACTS, or DPT_FORCE_FLAG_FADING or _SHAPED
 *           is set
 *   reason  DPT_FORCE_...
 *   flags   DPT_FORCE_FLAG_...
 *
 * Fade: the library itself can end a push while the tool does not move away. It does so if it gives up the side of an
 * open sheet (the tool is deeper than side_limit, a motion could not be followed, the axis is at the sheet's border, or
 * there is no room for the contact), or if the contact becomes unknown. Then the segment's part of the wrench changes
 * in a straight line to its new value, which is zero while the contact is unknown. This takes dpt_world_def.fade
 * seconds, counted by the steps' dt. The wrench is always between the old and the new value. Another such event starts
 * the time again. With a proxy it fades where the proxy is put at its device (DPT_FORCE_FLAG_SQUEEZED, _REPLACED), and
 * where a body that was added or teleported may be round it. There it takes longer if it must: while it fades the wrench
 * changes by at most stiffness * (3 * the device's motion + 1 m/s * dt) in a step, as without a fade. A `fade` of 0 ends it
 * at once.
 *
 * The wrench is zero at once after an error, a teleport, a reset or input that cannot be used, with stiffness 0, and
 * when a rigid tool becomes free or the reverse. The push of a body that is removed or teleported ends at once, too. If
 * the tool moves away, the push goes to zero by itself.
 */
typedef struct dpt_force_info {
    uint32_t size; /* sizeof(dpt_force_info), set by the caller */
    uint32_t reason;
    uint32_t flags;
    uint32_t law; /* DPT_LAW_... */
    dpt_wrench wrench;
    double energy;  /* that the law stores, J; 0 with DPT_LAW_POINT */
    double lag;     /* of the proxy, m: how far it still is from where it would come to rest */
    uint64_t folds; /* how many there were since the tool was placed */
    /* Of the proxy, contacts with friction that stuck in the step, and that slipped. */
    uint32_t sticking;
    uint32_t slipping;
    /* J: what bodies that moved before the step did on the tool, by its contacts; docs/algorithms/passivity.md. */
    double body_work;
} dpt_force_info;

/* On an error, `reason` is DPT_FORCE_STALE and the wrench is zero. */
DPT_API dpt_result dpt_tool_get_force_info(const dpt_world *world, dpt_tool tool, dpt_force_info *info);

/*
 * A function of the program's own that shapes a tool's wrench: a guide, a vibration, another law. It is called in each
 * step in which the tool has an answer, in worlds that respond, after the tool's law.
 *   info    what the law gives
 *   wrench  that of the info; the function changes it. If it is not finite then, it is zero, and the reason is
 *           DPT_FORCE_UNDECIDED
 * It must not call functions on the same world but the getters of the tool's pose and proxy. What energy it gives or
 * takes is its own affair: the info's energy is that of the law. A NULL function ends it. It stays through
 * dpt_world_reset and changes of settings.
 */
typedef void (*dpt_force_fn)(void *user, const dpt_force_info *info, double dt, dpt_wrench *wrench);

DPT_API dpt_result dpt_tool_set_shaper(dpt_world *world, dpt_tool tool, dpt_force_fn shape, void *user);

/* The wrench of dpt_tool_get_force_info alone; zero on an error. */
DPT_API dpt_result dpt_tool_get_wrench(const dpt_world *world, dpt_tool tool, dpt_wrench *wrench);

/*
 * A point at which a body pushes a tool. The tool's loads sum up to its wrench (dpt_force_info.wrench, before any shaper)
 * within rounding: the forces to its force, and the torques with the moments of the forces to its torque.
 *   body      its id
 *   segment   index of the tool's segment, from 0; tips go on from there
 *   contact   id of the contact (dpt_tool_get_contacts) that the point is in or nearest to; 0 where the world lists none
 *   triangle  source number
 *   point     in the world, on the line of the force: where the tool's surface touches, or within the tool. With
 *             DPT_LAW_BED it is the middle of what the contact pushes
 *   force     on the tool, N, in world axes: with friction
 *   torque    about the point, Nm, in world axes: what the forces cannot carry, as a torque about the normal, or the
 *             part of a locked rotation. 0 where the law is but the points' forces
 * A fade, a damper or a surface that yields makes the wrench another than the law's forces: these are scaled alike, and
 * share the rest by their sizes. A wrench without any point, as while it fades after the contact is over, is that of the
 * tool's nearest pair.
 */
typedef struct dpt_tool_load {
    uint32_t size; /* sizeof(dpt_tool_load), set by the caller; in an array, that of the first item */
    uint32_t body;
    uint32_t segment;
    uint32_t contact;
    uint32_t triangle;
    uint32_t reserved;
    double point[3];
    double force[3];
    double torque[3];
} dpt_tool_load;

/*
 * The tool's loads, from the last step; none while its wrench is zero. A step takes at most 0.3 % longer for them.
 *   loads   at most `capacity` are written. loads[0].size must be set. May be NULL if capacity is 0
 *   count   how many there are, which may be more than `capacity`: at most six for a tool with a proxy, as many as push
 *           where it was stepped together with tissue, one a segment with DPT_LAW_POINT, one a contact with DPT_LAW_BED
 */
DPT_API dpt_result dpt_tool_get_loads(const dpt_world *world, dpt_tool tool, dpt_tool_load *loads, uint32_t capacity,
                                      uint32_t *count);

/* The part of dpt_body_get_wrench that one tool does. */
DPT_API dpt_result dpt_tool_get_body_wrench(const dpt_world *world, dpt_tool tool, dpt_body body, dpt_wrench *wrench);

DPT_END

#endif
