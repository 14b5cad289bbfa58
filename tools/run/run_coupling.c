/* SPDX-License-Identifier: BSD-3-Clause */
#include "run/run_coupling.h"

#include <math.h>

#include "base/vec3.h"
#include "cli/command_options.h"
#include "scene/tool_spread.h"

const char *coupling_limit_word(uint32_t limit)
{
    static const char *const words[] = { "asked", "stability", "rotation", "step", "maker", "unknown" };
    return limit < sizeof words / sizeof *words ? words[limit] : "?";
}

/* What counts for the tool's turns: its segments, then the axes of its tips. Returns how many there are. */
static uint32_t list_parts(const struct scene *scene, dpt_segment *parts)
{
    const uint32_t segments = scene->segment_count;
    for (uint32_t i = 0; i < segments; i++) {
        parts[i] = scene->segments[i];
        if (scene->has_stylus)
            parts[i].b[2] = scene->length;
    }
    for (uint32_t i = 0; i < scene->tips.count; i++) {
        dpt_segment *part = &parts[segments + i];
        scene_tips_axis(&scene->tips, i, part->a, part->b);
    }
    return segments + scene->tips.count;
}

/* The tool's root mean squared distance from its centre, and how far that is from the pose's origin. */
static void measure_tool(const struct scene *scene, double *rho, double *lever)
{
    dpt_segment parts[DPT_ARM_SEGMENTS_MAX + SCENE_TIPS_MAX];
    double centre[3];
    const uint32_t count = list_parts(scene, parts);
    *rho = tool_spread(parts, count, centre);
    *lever = vec3_length(centre);
}

static void say_why(const struct scene *scene, const dpt_coupling *coupling, double asked)
{
    const char *which = scene->zoom != 1.0 || scene->force_scale != 1.0 ? " of the scene" : "";
    switch (coupling->limit) {
    case DPT_COUPLING_STABILITY:
    case DPT_COUPLING_ROTATION:
        if (coupling->delay_needed > 0.0)
            complain(scene->command,
                     "%g N/m%s need T/2 + t_d <= %.3g ms; this device has %.3g. It is held by %.4g "
                     "N/m%s (--unstable takes %g all the same)",
                     asked, which, 1e3 * coupling->delay_needed, 1e3 * coupling->delay, coupling->stiffness,
                     coupling->limit == DPT_COUPLING_ROTATION ? ", as its rotation is weaker" : "", asked);
        break;
    case DPT_COUPLING_STEP:
        complain(scene->command, "%.4g N/m instead of %g: the device's steps would be felt", coupling->stiffness,
                 asked);
        break;
    case DPT_COUPLING_MAKER:
        complain(scene->command, "%.4g N/m instead of %g: its maker states no more", coupling->stiffness, asked);
        break;
    case DPT_COUPLING_UNKNOWN:
        complain(scene->command,
                 "%.4g N/m instead of %g: the device's mass and damping are not known. Measure "
                 "them: dynpoint device identify (--unstable takes %g all the same)",
                 coupling->stiffness, asked, asked);
        break;
    default:
        break;
    }
}

int run_coupling_find(const struct scene *scene, const dpt_device_info *device, const struct coupling_options *options,
                      dpt_coupling *coupling)
{
    dpt_coupling_def def;
    *coupling = (dpt_coupling){ .size = sizeof *coupling };
    dpt_coupling_def_init(&def);
    dpt_device_fill_coupling(device, &def);
    measure_tool(scene, &def.rho, &def.lever);
    def.rate = options->rate;
    def.loop_delay = options->loop_delay;
    def.zoom = scene->zoom;
    def.force_scale = scene->force_scale;
    def.tool_damping = scene->force.damping;
    def.gain_margin = options->gain_margin;
    def.stiffness = isnan(options->stiffness) ? 0.0 : options->stiffness;
    const dpt_result result = dpt_coupling_for_device(&def, coupling);
    if (result != DPT_OK)
        return complain(scene->command, "no coupling for this device: %s", dpt_result_text(result));
    return 0;
}

int run_coupling_choose(struct scene *scene, const dpt_device_info *device, const struct coupling_options *options,
                        dpt_coupling *coupling)
{
    const int is_asked = !isnan(options->stiffness);
    if (run_coupling_find(scene, device, options, coupling))
        return 2;
    /* A stiffness of 0 is asked for by those who want no force. */
    if (is_asked && (options->is_unstable || options->stiffness == 0.0)) {
        coupling->limit = DPT_COUPLING_ASKED;
        coupling->stiffness = options->stiffness;
    } else if (is_asked) {
        say_why(scene, coupling, options->stiffness);
    }
    scene->force.stiffness = coupling->stiffness;
    return 0;
}
