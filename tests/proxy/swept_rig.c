/* SPDX-License-Identifier: BSD-3-Clause */
#include "proxy/swept_rig.h"

#include "proxy/patch_sides.h"

void rig_use_sweeps(const struct rig *rig)
{
    patches_of(rig->world, 0)->is_off = 1;
}
