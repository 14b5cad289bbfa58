/* SPDX-License-Identifier: BSD-3-Clause */
/* The tips of the tool, and the jaws that move them: docs/urdf.md. */
#ifndef DPT_URDF_TIPS_H
#define DPT_URDF_TIPS_H

#include <list>

#include "urdf/urdf_scene.h"

struct Tips {
    std::vector<dpt_arm_joint> jaws;
    std::vector<dpt_arm_link> jaw_links;
    std::vector<dpt_arm_tip> tips;          /* their corners point into `corners` */
    std::list<std::vector<double>> corners; /* of each tip */
};

/* Make the tips. A mesh that cannot be one is noted. Throws a fault; the parameters are those of read_scene. */
void read_tips(const Robot &robot, const Chain &chain, const std::string &file, const char *packages,
               const dpt_compile_def &mesh, Notes &notes, Tips *tips);

#endif
