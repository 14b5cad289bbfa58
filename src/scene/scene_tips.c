/* SPDX-License-Identifier: BSD-3-Clause */
#include "scene/scene_tips.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/frame.h"
#include "scene/tip_shape.h"
#include "text/parse_number.h"

int jaw_motion_parse(struct jaw_motion *motion, const char *text, const char *end)
{
    double numbers[4] = { 0.0, 0.0, 0.0, -1.0 };
    int count = 0;
    for (; text && count < 4; count++) {
        text = parse_double(text, end, &numbers[count]);
        if (!text || (text < end && *text != ':'))
            return 0;
        if (text == end)
            break;
        text++;
    }
    if (count != 0 && count != 2 && count != 3)
        return 0;
    *motion = (struct jaw_motion){
        .is_given = 1, .from = numbers[0], .to = numbers[count ? 1 : 0], .seconds = numbers[2], .button = numbers[3]
    };
    return 1;
}

const char *jaw_motion_fault(const struct jaw_motion *motion)
{
    if (!(motion->from >= 0.0 && motion->from <= 1.0 && motion->to >= 0.0 && motion->to <= 1.0))
        return "its shares must be 0 to 1";
    if (!(motion->seconds >= 0.0 && motion->seconds <= 1e6))
        return "its time must be 0 to 1e6 s";
    if (motion->button == -1.0)
        return NULL;
    if (!(motion->button >= 0.0 && motion->button <= 31.0 && motion->button == floor(motion->button)))
        return "its button must be 0 to 31";
    return motion->seconds > 0.0 ? NULL : "with a button its time must be above 0";
}

dpt_result jaw_motion_read(struct jaw_motion *motion, const char *name, const char *text, dpt_host_error *error)
{
    if (!jaw_motion_parse(motion, text, text + strlen(text)))
        return host_refuse(error, DPT_E_ARGUMENT, "%s takes SHARE or FROM:TO:SECONDS[:BUTTON]; it is '%s'", name, text);
    const char *fault = jaw_motion_fault(motion);
    return fault ? host_refuse(error, DPT_E_ARGUMENT, "%s %s: %s", name, text, fault) : DPT_OK;
}

double jaw_motion_time(const struct jaw_motion *motion, double time, double dt, uint32_t buttons)
{
    if (motion->button < 0.0)
        return time + dt;
    const int is_down = (int)(buttons >> (uint32_t)motion->button & 1);
    return fmax(0.0, fmin(motion->seconds, is_down ? time + dt : time - dt));
}

double jaw_motion_share(const struct jaw_motion *motion, double time)
{
    const double part = time < motion->seconds ? time / motion->seconds : 1.0;
    return motion->from + part * (motion->to - motion->from);
}

#define FULL_TURN 6.28318530717958648

/* The hull of one of the arm's tips. */
static dpt_result make_of_arm(const dpt_arm *arm, uint32_t index, void **block, const dpt_hull **hull)
{
    dpt_arm_tip tip = { .size = sizeof tip };
    dpt_result result = dpt_arm_get_tip(arm, index, &tip);
    if (result != DPT_OK)
        return result;
    const dpt_hull_def def = {
        .size = sizeof def, .corner_count = tip.corner_count, .corners = tip.corners, .radius = tip.radius
    };
    const size_t bytes = dpt_hull_bytes(&def);
    *block = malloc(bytes ? bytes : 1);
    return *block ? dpt_hull_create(*block, bytes, &def, hull) : DPT_E_MEMORY;
}

/* The jaws' coordinates at a time of the motion. */
static void find_jaws(const struct scene_tips *tips, double *jaws)
{
    dpt_arm_joint jaw = { .size = sizeof jaw };
    const double share = jaw_motion_share(&tips->motion, tips->time);
    for (uint32_t i = 0; i < tips->jaws; i++) {
        dpt_arm_get_jaw(tips->arm, i, &jaw);
        if (!tips->motion.is_given)
            jaws[i] = fmax(jaw.lower, fmin(jaw.upper, 0.0));
        else if (jaw.kind == DPT_JOINT_CONTINUOUS)
            jaws[i] = share * FULL_TURN;
        else
            jaws[i] = jaw.lower + share * (jaw.upper - jaw.lower);
    }
}

static dpt_result find_poses(struct scene_tips *tips, const double *jaws)
{
    dpt_result result = DPT_OK;
    for (uint32_t i = tips->shapes.count; result == DPT_OK && i < tips->count; i++)
        result = dpt_arm_tip_pose(tips->arm, i - tips->shapes.count, jaws, &tips->poses[i]);
    return result;
}

dpt_result scene_tips_make(struct scene_tips *tips, const char *path, const char *jaw, const struct tip_shapes *shapes,
                           const dpt_arm *arm, const struct jaw_motion *motion, dpt_host_error *error)
{
    static const dpt_pose identity = DPT_POSE_IDENTITY;
    dpt_arm_info info = { .size = sizeof info };
    double jaws[DPT_JOINTS_MAX];
    if (arm)
        dpt_arm_get_info(arm, &info);
    tips->shapes = *shapes;
    tips->motion = *motion;
    tips->arm = info.tips ? arm : NULL;
    tips->jaws = info.jaws;
    if (motion->is_given && !tips->jaws && !tips->has_seen_jaws)
        return host_refuse(error, DPT_E_ARGUMENT, "%s: its tool has no jaws to move (%s)", path, jaw);
    for (; tips->count < shapes->count + info.tips; tips->count++) {
        const uint32_t i = tips->count;
        tips->poses[i] = identity;
        const dpt_result result = i < shapes->count
                                      ? tip_shape_make(&shapes->shape[i], &tips->blocks[i], &tips->hulls[i])
                                      : make_of_arm(arm, i - shapes->count, &tips->blocks[i], &tips->hulls[i]);
        if (result != DPT_OK) {
            free(tips->blocks[i]);
            if (result == DPT_E_UNSUPPORTED && i < shapes->count && curved_tip_left_out())
                return host_refuse(error, DPT_E_ABSENT, "%s: tip %" PRIu32 ": %s", path, i + 1, curved_tip_left_out());
            return host_refuse(error, result, "%s: tip %" PRIu32 ": %s", path, i + 1, dpt_result_text(result));
        }
    }
    find_jaws(tips, jaws);
    find_poses(tips, jaws);
    return DPT_OK;
}

void scene_tips_close(struct scene_tips *tips)
{
    for (uint32_t i = 0; i < tips->count; i++)
        free(tips->blocks[i]);
}

dpt_result scene_tips_add(const struct scene_tips *tips, dpt_world *world, dpt_tool tool)
{
    dpt_tip all[SCENE_TIPS_MAX];
    for (uint32_t i = 0; i < tips->count; i++)
        all[i] = (dpt_tip){ .size = sizeof *all, .hull = tips->hulls[i], .pose = &tips->poses[i] };
    return dpt_tool_set_tips(world, tool, all, tips->count);
}

dpt_result scene_tips_move(struct scene_tips *tips, dpt_world *world, dpt_tool tool, double dt, uint32_t buttons)
{
    double jaws[DPT_JOINTS_MAX];
    if (tips->has_seen_jaws || tips->jaws)
        tips->time = jaw_motion_time(&tips->motion, tips->time, dt, buttons);
    if (!tips->jaws)
        return DPT_OK;
    find_jaws(tips, jaws);
    dpt_result result = find_poses(tips, jaws);
    for (uint32_t i = tips->shapes.count; result == DPT_OK && i < tips->count; i++)
        result = dpt_tool_set_tip_pose(world, tool, i, &tips->poses[i]);
    return result;
}

static void to_tool(const struct scene_tips *tips, uint32_t tip, const double from[3], double to[3])
{
    struct frame frame;
    frame_of_pose(&tips->poses[tip], &frame);
    vec3_store(frame_to_world(&frame, vec3_of(from)), to);
}

void scene_tips_axis(const struct scene_tips *tips, uint32_t tip, double a[3], double b[3])
{
    dpt_hull_info info = { .size = sizeof info };
    dpt_hull_get_info(tips->hulls[tip], &info);
    to_tool(tips, tip, info.axis[0], a);
    to_tool(tips, tip, info.axis[1], b);
}

double scene_tips_drop(const struct scene_tips *tips, double min)
{
    double corner[3], drop = min;
    for (uint32_t i = 0; i < tips->count; i++) {
        dpt_hull_info info = { .size = sizeof info };
        dpt_hull_get_info(tips->hulls[i], &info);
        for (uint32_t k = 0; dpt_hull_get_corner(tips->hulls[i], k, corner) == DPT_OK; k++) {
            to_tool(tips, i, corner, corner);
            drop = fmax(drop, info.radius - corner[1]);
        }
    }
    return drop;
}

double scene_tips_opening(const struct scene_tips *tips)
{
    return tips->motion.is_given ? jaw_motion_share(&tips->motion, tips->time) : 0.5;
}
