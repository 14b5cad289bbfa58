/* SPDX-License-Identifier: BSD-3-Clause */
/* The coupling of a scene: as stiff as its device can hold (dynpoint/coupling.h). */
#ifndef DPT_HOST_COUPLING_H
#define DPT_HOST_COUPLING_H

#include "dynpoint/coupling.h"
#include "scene/scene.h"

/* From a sample to its command, by the clock: the deadline's phase behind the sample, and the tick's own time. */
#define HOST_LOOP_DELAY_PERIODS 0.25

struct coupling_options {
    double stiffness; /* asked for, N/m; NAN: as stiff as the device can hold */
    double gain_margin;
    double rate;       /* of the loop, Hz */
    double loop_delay; /* s */
    int is_unstable;   /* the stiffness counts, whatever the device can hold */
};

/* What counts of a tool, and of how it is moved. */
struct coupled_tool {
    double rho, lever; /* m: as in dpt_coupling_def */
    double zoom, force_scale;
    double damping; /* of its spring, Ns/m */
};

/* That of a scene that was opened. */
struct coupled_tool host_coupled_tool(const struct scene *scene);

/* The coupling that these options ask for, or the stiffest that holds. */
dpt_result host_coupling_find(const struct coupled_tool *tool, const dpt_device_info *device,
                              const struct coupling_options *options, dpt_coupling *coupling, dpt_host_error *error);

/*
 * Choose the coupling for a scene that was opened, into its force options. Where it is less stiff than was asked for, a
 * note says why.
 */
dpt_result host_coupling_choose(struct scene *scene, const dpt_device_info *device,
                                const struct coupling_options *options, dpt_coupling *coupling, dpt_host_error *error);

#endif
