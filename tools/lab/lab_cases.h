/* SPDX-License-Identifier: BSD-3-Clause */
/* The cases of the laboratory, in the order in which they are told. Each is defined in the file of its subject. */
#ifndef DPT_TOOLS_LAB_CASES_H
#define DPT_TOOLS_LAB_CASES_H

#include "lab/lab.h"

/* Geometry: a tool is led. */
#define LAB_GEOMETRY_CASES                                                                                             \
    CASE(spikes)                                                                                                       \
    CASE(microconcave)                                                                                                 \
    CASE(thinsheet)                                                                                                    \
    CASE(parallel)                                                                                                     \
    CASE(rocking)                                                                                                      \
    CASE(slot)                                                                                                         \
    CASE(bodies)                                                                                                       \
    CASE(segments)                                                                                                     \
    CASE(medial)                                                                                                       \
    CASE(border)                                                                                                       \
    CASE(sidelimit)                                                                                                    \
    CASE(folds)                                                                                                        \
    CASE(slivers)                                                                                                      \
    CASE(coincident)                                                                                                   \
    CASE(scale)                                                                                                        \
    CASE(hour)                                                                                                         \
    CASE(work)                                                                                                         \
    CASE(tilt)                                                                                                         \
    CASE(budget)

/* Loops: a simulated hand holds a device. */
#define LAB_LOOP_CASES                                                                                                 \
    CASE(wall)                                                                                                         \
    CASE(organs)                                                                                                       \
    CASE(delay)                                                                                                        \
    CASE(rate)                                                                                                         \
    CASE(phase)                                                                                                        \
    CASE(zoom)                                                                                                         \
    CASE(energy)                                                                                                       \
    CASE(late)                                                                                                         \
    CASE(rest)                                                                                                         \
    CASE(beat)

/* Tissue: vertices move. */
#define LAB_TISSUE_CASES                                                                                               \
    CASE(tissue)                                                                                                       \
    CASE(soft)                                                                                                         \
    CASE(pulse)                                                                                                        \
    CASE(reaction)                                                                                                     \
    CASE(displace)                                                                                                     \
    CASE(springs)

#define LAB_CASES                                                                                                      \
    LAB_GEOMETRY_CASES                                                                                                 \
    LAB_LOOP_CASES                                                                                                     \
    LAB_TISSUE_CASES

#define CASE(name) extern const struct lab_case name##_case;
LAB_CASES
#undef CASE

#endif
