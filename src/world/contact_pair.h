/* SPDX-License-Identifier: BSD-3-Clause */
/* Contact of one segment and one body: its gap, its regions and their sides. */
#ifndef DPT_CONTACT_PAIR_H
#define DPT_CONTACT_PAIR_H

#include "world/world_state.h"

/* What it adds to the segment's gap; its regions into the world. CONTACT_... */
int dpti_contact_pair_find(struct contact_pair *contact_pair, double *gap);

#endif
