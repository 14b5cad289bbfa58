/* SPDX-License-Identifier: BSD-3-Clause */
#include "host/host_coupling.h"

#include <math.h>

#include "base/return_if_error.h"
#include "base/vec3.h"
#include "host/tool_spread.h"
#include "scene/setting_words.h"

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

/* rho is the root mean squared distance from the tool's centre, the lever how far that is from the pose's origin. */
struct coupled_tool host_coupled_tool(const struct scene *scene)
{
    dpt_segment parts[DPT_ARM_SEGMENTS_MAX + SCENE_TIPS_MAX];
    double centre[3];
    const uint32_t count = list_parts(scene, parts);
    struct coupled_tool tool = { .zoom = scene->zoom,
                                 .force_scale = scene->force_scale,
                                 .damping = scene->force.damping };
    tool.rho = tool_spread(parts, count, centre);
    tool.lever = vec3_length(centre);
    return tool;
}

static void say_why(const struct scene *scene, const dpt_coupling *coupling, double asked, dpt_host_error *error)
{
    const char *which = scene->zoom != 1.0 || scene->force_scale != 1.0 ? " of the scene" : "";
    const char *by_rotation = coupling->limit == DPT_COUPLING_ROTATION ? ", as its rotation is weaker" : "";
    const char *unstable = setting_names_for(scene->command)->unstable;
    switch (coupling->limit) {
    case DPT_COUPLING_STABILITY:
    case DPT_COUPLING_ROTATION:
        if (coupling->delay_needed > 0.0)
            host_note(error,
                      "%g N/m%s need T/2 + t_d <= %.3g ms; this device has %.3g. It is held by %.4g "
                      "N/m%s (%s takes %g all the same)",
                      asked, which, 1e3 * coupling->delay_needed, 1e3 * coupling->delay, coupling->stiffness,
                      by_rotation, unstable, asked);
        else
            host_note(error,
                      "%.4g N/m instead of %g%s: this device holds no more, however short its delay%s (%s "
                      "takes %g all the same)",
                      coupling->stiffness, asked, which, by_rotation, unstable, asked);
        break;
    case DPT_COUPLING_STEP:
        host_note(error, "%.4g N/m instead of %g: the device's steps would be felt", coupling->stiffness, asked);
        break;
    case DPT_COUPLING_MAKER:
        host_note(error, "%.4g N/m instead of %g: its maker states no more", coupling->stiffness, asked);
        break;
    case DPT_COUPLING_UNKNOWN:
        host_note(error,
                  "%.4g N/m instead of %g: the device's mass and damping are not known. Measure "
                  "them: dynpoint device identify (%s takes %g all the same)",
                  coupling->stiffness, asked, unstable, asked);
        break;
    default:
        break;
    }
}

static dpt_coupling_def coupling_def_of(const struct coupled_tool *tool, const dpt_device_info *device,
                                        const struct coupling_options *options)
{
    dpt_coupling_def def;
    dpt_coupling_def_init(&def);
    dpt_device_fill_coupling(device, &def);
    def.rho = tool->rho;
    def.lever = tool->lever;
    def.rate = options->rate;
    def.loop_delay = options->loop_delay;
    def.zoom = tool->zoom;
    def.force_scale = tool->force_scale;
    def.tool_damping = tool->damping;
    def.gain_margin = options->gain_margin;
    def.stiffness = isnan(options->stiffness) ? 0.0 : options->stiffness;
    return def;
}

static dpt_result find_coupling(const dpt_coupling_def *def, dpt_coupling *coupling, dpt_host_error *error)
{
    *coupling = (dpt_coupling){ .size = sizeof *coupling };
    const dpt_result result = dpt_coupling_for_device(def, coupling);
    return result == DPT_OK ? DPT_OK
                            : host_refuse(error, result, "no coupling for this device: %s", dpt_result_text(result));
}

dpt_result host_coupling_find(const struct coupled_tool *tool, const dpt_device_info *device,
                              const struct coupling_options *options, dpt_coupling *coupling, dpt_host_error *error)
{
    const dpt_coupling_def def = coupling_def_of(tool, device, options);
    return find_coupling(&def, coupling, error);
}

/*
 * An upright tool stands up to UPRIGHT_FORCE, N, if its stiffness against turns is that times half of its length
 * (docs/algorithms/force.md). With UPRIGHT_MARGIN times as much a hand's lean grows threefold at most. A share of
 * UPRIGHT_PRICE of the stiffness is given for that, at most; it is found in so many halvings. Where a stiffness is asked
 * for, the tool's shape gives that against turns.
 */
#define UPRIGHT_FORCE  10.0
#define UPRIGHT_MARGIN 1.5
#define UPRIGHT_PRICE  0.1
enum { UPRIGHT_HALVINGS = 6 };

/* The stiffness against turns that holds an upright tool, or as much of it as the device can hold at that price. */
static dpt_result hold_upright(dpt_coupling_def *def, dpt_coupling *coupling, dpt_host_error *error)
{
    const double least = (1.0 - UPRIGHT_PRICE) * coupling->stiffness;
    double low = coupling->stiffness * def->rho * def->rho,
           high = UPRIGHT_MARGIN * UPRIGHT_FORCE * sqrt(3.0) * def->rho;
    if (!(coupling->stable_turn > 0.0) || !(low < high))
        return DPT_OK;
    def->rotational_stiffness = high;
    for (int i = 0; i <= UPRIGHT_HALVINGS; i++) {
        dpt_coupling tried;
        DPT_TRY(find_coupling(def, &tried, error));
        const int is_held =
            tried.stiffness >= least && tried.rotational_stiffness >= (1.0 - 1e-9) * def->rotational_stiffness;
        if (is_held)
            *coupling = tried;
        if (is_held && i == 0)
            return DPT_OK;
        *(is_held ? &low : &high) = def->rotational_stiffness;
        def->rotational_stiffness = 0.5 * (low + high);
    }
    return DPT_OK;
}

dpt_result host_coupling_choose(struct scene *scene, const dpt_device_info *device,
                                const struct coupling_options *options, dpt_coupling *coupling, dpt_host_error *error)
{
    const int is_asked = !isnan(options->stiffness);
    const struct coupled_tool tool = host_coupled_tool(scene);
    dpt_coupling_def def = coupling_def_of(&tool, device, options);
    DPT_TRY(find_coupling(&def, coupling, error));
    if (!is_asked && scene->force.law == DPT_LAW_PROXY && !scene->planned)
        DPT_TRY(hold_upright(&def, coupling, error));
    /* A stiffness of 0 is asked for by those who want no force. */
    if (is_asked && (options->is_unstable || options->stiffness == 0.0)) {
        coupling->limit = DPT_COUPLING_ASKED;
        coupling->stiffness = options->stiffness;
    } else if (is_asked) {
        say_why(scene, coupling, options->stiffness, error);
    }
    scene->force.stiffness = coupling->stiffness;
    scene->force.rotational_stiffness = coupling->rotational_stiffness;
    return DPT_OK;
}
