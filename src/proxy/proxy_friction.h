/* SPDX-License-Identifier: BSD-3-Clause */
/* The motion that constraints and friction allow, and what keeps contacts sticking: docs/algorithms/force.md. */
#ifndef DPT_PROXY_FRICTION_H
#define DPT_PROXY_FRICTION_H

#include "force/friction.h"
#include "proxy/proxy_tick.h"

/*
 * The motion nearest to the wanted one that the constraints and friction allow, into tick->solved. Where no motion
 * meets all constraints: one that makes nothing worse; where there is none either: one that leaves half of the
 * clearance. Returns 0 if there is not even that.
 */
int dpti_proxy_solve_rubbing(struct proxy_tick *tick, const double *wanted);

/*
 * At the end of a tick: what holds the proxy where it is. tick->solved and its contacts balance `left`, the
 * displacement from the proxy to its device as unknowns; this is solved once a tick. Returns 0 if nothing holds the
 * proxy, or if that is not known.
 */
int dpti_proxy_solve_held(struct proxy_tick *tick, double *left);

/* After the proxy made that motion: update the slip of each contact. Contacts that slip start anew. */
void dpti_proxy_note_slip(struct proxy_tick *tick, vec3 shift, vec3 turn);

/*
 * Before the tool goes along with a body, as if fixed to it, to a pose: what sticks to other bodies slips meanwhile, and is
 * to make that good.
 */
void dpti_proxy_note_carried(struct proxy_tick *tick, const struct proxy_pose *to, const struct body *body);

/* End a tick: forget contacts that hold nothing any more. */
void dpti_proxy_keep_contacts(struct proxy_tick *tick);

#endif
