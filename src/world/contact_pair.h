/* SPDX-License-Identifier: BSD-3-Clause */
/* Contact of one segment and one body: its gap, its regions and their sides. */
#ifndef DPT_CONTACT_PAIR_H
#define DPT_CONTACT_PAIR_H

#include "world/persistent_contacts.h"

/* One segment and one body, this tick. */
struct meeting {
    struct dpt_world *world;
    const struct body *body;
    uint32_t segment;
    double radius;
    struct axis axis;
    struct nearest nearest;
    struct sides sides;
    struct profile *profile;
};

/* What it adds to the segment's gap; its regions into the world. CONTACT_... */
int dpti_contact_pair_meet(struct meeting *meeting, double *gap);

#endif
