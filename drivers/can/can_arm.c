/* SPDX-License-Identifier: BSD-3-Clause */
#include "can/can_arm.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/quaternion.h"
#include "base/return_if_error.h"
#include "base/wrench_limit.h"
#include "settings.h"
#include "text/parse_number.h"

#define TURN            6.283185307179586476925
#define GRAVITY         9.80665
#define FILE_BYTES_MAX  (64l << 20)
#define WATCHDOG_UNSAID 0.05 /* s; for motors whose watchdog the driver sets */
#define FORCE_MAX       1e6  /* N, Nm; above it efforts might not be finite */

/* Read the watchdog: a number of seconds, "none", or "" if it was not given. */
static dpt_result read_watchdog(struct can_settings *settings, const char *text, dpt_device_error *error)
{
    const char *end = text + strlen(text);
    settings->gives_force = *text != '\0';
    if (!settings->gives_force || !strcmp(text, "none"))
        return DPT_OK;
    if (parse_double(text, end, &settings->watchdog) != end ||
        !(settings->watchdog > 0.0 && settings->watchdog <= 10.0))
        return device_error(error, DPT_E_SETTING,
                            "watchdog is the time that is configured at the controllers, in s, at "
                            "most 10, or none where they have none");
    return DPT_OK;
}

dpt_result can_settings_read(const char *where, struct can_settings *s, dpt_device_error *error)
{
    const struct can_settings defaults = { .drive = "odrive",
                                           .axes = "-y+z-x",
                                           .firmware = "auto",
                                           .rate = 1000.0,
                                           .weight = 1.0,
                                           .answer = 2.0,
                                           .silent = 0.05,
                                           .heartbeat = 0.1 };
    char watchdog[32] = "";
    *s = defaults;
    const struct setting settings[] = {
        { .name = "arm", .text = s->arm, .text_bytes = sizeof s->arm },
        { .name = "drive", .text = s->drive, .text_bytes = sizeof s->drive },
        { .name = "model", .text = s->model, .text_bytes = sizeof s->model },
        { .name = "answers", .text = s->answers, .text_bytes = sizeof s->answers },
        { .name = "nodes", .text = s->nodes, .text_bytes = sizeof s->nodes },
        { .name = "gear", .text = s->gear, .text_bytes = sizeof s->gear },
        { .name = "zero", .text = s->zero, .text_bytes = sizeof s->zero },
        { .name = "torque", .text = s->torque, .text_bytes = sizeof s->torque },
        { .name = "centre", .text = s->centre, .text_bytes = sizeof s->centre },
        { .name = "axes", .text = s->axes, .text_bytes = sizeof s->axes },
        { .name = "firmware", .text = s->firmware, .text_bytes = sizeof s->firmware },
        { .name = "rate", .number = &s->rate, .min = 50, .max = 5000 },
        { .name = "weight", .number = &s->weight, .max = 1 },
        { .name = "request", .number = &s->request, .max = 1 },
        { .name = "answer", .number = &s->answer, .min = 0.2, .max = 60 },
        { .name = "silent", .number = &s->silent, .min = 0.002, .max = 10 },
        { .name = "heartbeat", .number = &s->heartbeat, .min = 0.001, .max = 1 },
        { .name = "watchdog", .text = watchdog, .text_bytes = sizeof watchdog },
    };
    DPT_TRY(settings_read(where, s->interface, sizeof s->interface, settings, sizeof settings / sizeof *settings,
                          &s->dynamics, error));
    if (strcmp(s->firmware, "auto") && strcmp(s->firmware, "0.5") && strcmp(s->firmware, "0.6"))
        return device_error(error, DPT_E_SETTING, "firmware is auto, 0.5 or 0.6");
    if (s->weight != floor(s->weight) || s->request != floor(s->request))
        return device_error(error, DPT_E_SETTING, "weight and request are 0 or 1");
    if (s->silent * s->rate < 3.0)
        return device_error(error, DPT_E_SETTING, "silent is less than three periods of rate");
    return read_watchdog(s, watchdog, error);
}

/* Read `count` numbers, as in "8,-8,10". If the text is empty, `numbers` stay as they are. */
static dpt_result read_list(const char *name, const char *text, uint32_t count, double *numbers,
                            dpt_device_error *error)
{
    if (!*text)
        return DPT_OK;
    const char *at = text, *end = text + strlen(text);
    for (uint32_t i = 0; i < count; i++) {
        at = parse_double(at, end, &numbers[i]);
        if (!at || *at != (i + 1 < count ? ',' : '\0') || !within(numbers[i], 1e6))
            return device_error(error, DPT_E_SETTING, "%s: '%.60s' is not %u numbers with commas between", name, text,
                                (unsigned)count);
        at++;
    }
    return DPT_OK;
}

/* The next of `count` words with commas between; the last stands for all that follow it. */
static const char *next_word(const char **at, size_t *length)
{
    const char *word = *at;
    *length = strcspn(word, ",");
    if (word[*length])
        *at = word + *length + 1;
    return word;
}

int can_arm_has_reporters(const struct can_arm *arm)
{
    for (uint32_t i = 0; i < arm->joints; i++)
        if (!arm->ends[i].drive->answers)
            return 1;
    return 0;
}

/* Without a word about the watchdog: motors whose watchdog the driver sets get one; others give no force. */
static void choose_watchdog(struct can_arm *arm, struct can_settings *settings)
{
    if (settings->gives_force)
        return;
    settings->gives_force = !can_arm_has_reporters(arm);
    settings->watchdog = settings->gives_force ? WATCHDOG_UNSAID : 0.0;
}

static dpt_result read_drives(struct can_arm *arm, struct can_settings *settings, dpt_device_error *error)
{
    const char *at_drive = settings->drive, *at_model = settings->model;
    for (uint32_t i = 0; i < arm->joints; i++) {
        struct drive_node *node = &arm->ends[i];
        size_t drive_length, model_length;
        const char *drive = next_word(&at_drive, &drive_length), *model = next_word(&at_model, &model_length);
        node->drive = drive_find(drive, drive_length);
        if (!node->drive)
            return device_error(error, DPT_E_SETTING,
                                "drive: '%.*s' is none of odrive, damiao, robstride, cybergear, moteus",
                                (int)drive_length, drive);
        node->position_range = node->drive->position_range;
        node->velocity_range = node->drive->velocity_range;
        node->torque_range = node->drive->torque_range;
        node->heat_limit = node->drive->heat_limit;
        if (node->drive->has_models && !drive_set_model(node, model, model_length))
            return device_error(
                error, DPT_E_SETTING,
                "model: '%.*s' of joint %u is none of rs-01, rs-02, rs-03, rs-04, nor the manual's ranges "
                "of velocity and torque, as 44:17",
                (int)model_length, model, (unsigned)i);
    }
    choose_watchdog(arm, settings);
    for (uint32_t i = 0; i < arm->joints; i++)
        arm->ends[i].watchdog = settings->watchdog;
    return DPT_OK;
}

static dpt_result read_nodes(struct can_arm *arm, const struct can_settings *settings, dpt_device_error *error)
{
    double nodes[DPT_JOINTS_MAX], answers[DPT_JOINTS_MAX];
    for (uint32_t i = 0; i < arm->joints; i++)
        nodes[i] = i + arm->ends[i].drive->number_min;
    DPT_TRY(read_list("nodes", settings->nodes, arm->joints, nodes, error));
    for (uint32_t i = 0; i < arm->joints; i++) {
        const struct can_drive *drive = arm->ends[i].drive;
        if (!(nodes[i] >= drive->number_min && nodes[i] <= drive->number_max) || nodes[i] != floor(nodes[i]))
            return device_error(error, DPT_E_SETTING, "nodes are numbers of %u to %u of %s, another one for each joint",
                                drive->number_min, drive->number_max, drive->title);
        arm->ends[i].number = (uint16_t)nodes[i];
        answers[i] = drive->answer + (drive->answer_has_number ? nodes[i] : 0.0);
    }
    DPT_TRY(read_list("answers", settings->answers, arm->joints, answers, error));
    for (uint32_t i = 0; i < arm->joints; i++) {
        if (!(answers[i] >= 0.0 && answers[i] < 0x7ff) || answers[i] != floor(answers[i]))
            return device_error(error, DPT_E_SETTING, "answers are ids of 0 to 2046");
        arm->ends[i].answer = (uint16_t)answers[i];
        for (uint32_t k = 0; k < i; k++)
            if (drive_nodes_collide(&arm->ends[k], &arm->ends[i]))
                return device_error(
                    error, DPT_E_SETTING,
                    "the motors of joints %u and %u would use the same ids on the bus: set others at one "
                    "of them, and by ?nodes= (Damiao: and ?answers=)",
                    (unsigned)k, (unsigned)i);
    }
    return DPT_OK;
}

int can_arm_is_fd(const struct can_arm *arm)
{
    for (uint32_t i = 0; i < arm->joints; i++)
        if (arm->ends[i].drive->is_fd)
            return 1;
    return 0;
}

int can_arm_wanted(const struct can_arm *arm, struct can_wanted *wanted)
{
    int count = 0;
    for (uint32_t i = 0; i < arm->joints; i++)
        count += arm->ends[i].drive->wanted(&arm->ends[i], wanted + count);
    return count;
}

/*
 * One turn of the motor is 1 / gear turns of a rotary joint, and 1 / gear metres of a slider. Power is the same
 * on both sides: effort * d joint = torque * 2 pi * d turns.
 */
static dpt_result read_gears(struct can_arm *arm, const struct can_settings *settings, dpt_device_error *error)
{
    double gear[DPT_JOINTS_MAX];
    for (uint32_t i = 0; i < arm->joints; i++)
        gear[i] = arm->is_slider[i] ? 0.0 : 1.0;
    DPT_TRY(read_list("gear", settings->gear, arm->joints, gear, error));
    for (uint32_t i = 0; i < arm->joints; i++) {
        if (!(fabs(gear[i]) >= 1e-6))
            return device_error(error, DPT_E_SETTING,
                                "gear: joint %u needs one: turns of the motor for %s, negative "
                                "where they go against each other",
                                (unsigned)i, arm->is_slider[i] ? "a metre" : "a turn of the joint");
        arm->joint_per_turn[i] = arm->is_slider[i] ? 1.0 / gear[i] : TURN / gear[i];
        arm->torque_per_effort[i] = arm->is_slider[i] ? 1.0 / (gear[i] * TURN) : 1.0 / gear[i];
    }
    DPT_TRY(read_list("zero", settings->zero, arm->joints, arm->zero, error));
    DPT_TRY(read_list("torque", settings->torque, arm->joints, arm->joint_limit, error));
    for (uint32_t i = 0; i < arm->joints; i++)
        if (!(arm->joint_limit[i] > 0.0))
            return device_error(error, DPT_E_SETTING,
                                "torque: the arm's file has no limit for joint %u: give the "
                                "joints' limits, Nm or N, by ?torque=",
                                (unsigned)i);
    return DPT_OK;
}

/* Read where the device's x, y and z point in the root's frame, as in "-y+z-x"; it must be right-handed. */
static dpt_result read_axes(struct can_arm *arm, const char *text, dpt_device_error *error)
{
    double m[3][3] = { { 0.0 } };
    const char *at = text;
    for (int i = 0; i < 3 && at; i++) {
        arm->sign[i] = *at == '-' ? -1.0 : 1.0;
        at += *at == '-' || *at == '+';
        const char *found = *at ? strchr("xyz", *at) : NULL;
        arm->root_axis[i] = (uint8_t)(found ? found - "xyz" : 0);
        at = found ? at + 1 : NULL;
        m[i][arm->root_axis[i]] = arm->sign[i];
    }
    const double determinant = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                               m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                               m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
    if (!at || *at || determinant != 1.0)
        return device_error(error, DPT_E_SETTING, "axes: '%.10s' is no right-handed choice of x, y and z, as -y+z-x is",
                            text);
    const double square[4] = { 1.0 + m[0][0] + m[1][1] + m[2][2], 1.0 + m[0][0] - m[1][1] - m[2][2],
                               1.0 - m[0][0] + m[1][1] - m[2][2], 1.0 - m[0][0] - m[1][1] + m[2][2] };
    for (int i = 0; i < 4; i++)
        arm->root_to_device[i] = 0.5 * sqrt(square[i]);
    /* The signs of the components, relative to the first that is not 0: w, or else the first of x, y, z. */
    if (arm->root_to_device[0] > 0.0) {
        arm->root_to_device[1] *= m[2][1] - m[1][2] < 0.0 ? -1.0 : 1.0;
        arm->root_to_device[2] *= m[0][2] - m[2][0] < 0.0 ? -1.0 : 1.0;
        arm->root_to_device[3] *= m[1][0] - m[0][1] < 0.0 ? -1.0 : 1.0;
    } else {
        if (arm->root_to_device[1] > 0.0) {
            arm->root_to_device[2] *= m[0][1] + m[1][0] < 0.0 ? -1.0 : 1.0;
            arm->root_to_device[3] *= m[0][2] + m[2][0] < 0.0 ? -1.0 : 1.0;
        } else {
            arm->root_to_device[3] *= m[1][2] + m[2][1] < 0.0 ? -1.0 : 1.0;
        }
    }
    return DPT_OK;
}

static void to_device(const struct can_arm *arm, const double *root, double *device)
{
    for (int i = 0; i < 3; i++)
        device[i] = arm->sign[i] * root[arm->root_axis[i]];
}

void can_arm_to_root(const struct can_arm *arm, const double *device, double *root)
{
    for (int i = 0; i < 3; i++)
        root[arm->root_axis[i]] = arm->sign[i] * device[i];
}

static void device_position(const struct can_arm *arm, const dpt_pose *tool, double *position)
{
    double root[3];
    for (int i = 0; i < 3; i++)
        root[i] = tool->position[i] - arm->centre[i];
    to_device(arm, root, position);
}

static double coordinate_at(const dpt_arm_joint *joint, double weight_share)
{
    return joint->kind == DPT_JOINT_CONTINUOUS ? 0.5 * TURN * (2.0 * weight_share - 1.0)
                                               : joint->lower + weight_share * (joint->upper - joint->lower);
}

/* Coordinate i of all joints at point n of a coarse grid; returns how many points there are. */
static uint32_t grid_point(const struct can_arm *arm, uint32_t n, double *joints)
{
    const uint32_t steps = arm->joints > 5 ? 3 : 5;
    uint32_t points = 1;
    for (uint32_t i = 0, rest = n; i < arm->joints; i++, rest /= steps) {
        dpt_arm_joint joint = { .size = sizeof joint };
        dpt_arm_get_joint(arm->arm, i, &joint);
        joints[i] = coordinate_at(&joint, (double)(rest % steps) / (steps - 1));
        points *= steps;
    }
    return points;
}

/* The workspace: the box, in the device's frame, around the tool's positions on the grid. */
static void measure_workspace(struct can_arm *arm)
{
    double joints[DPT_JOINTS_MAX], position[3];
    dpt_pose tool;
    const uint32_t points = grid_point(arm, 0, joints);
    for (uint32_t n = 0; n < points; n++) {
        grid_point(arm, n, joints);
        if (dpt_arm_forward(arm->arm, joints, &tool) != DPT_OK)
            continue;
        device_position(arm, &tool, position);
        for (int k = 0; k < 3; k++) {
            arm->workspace_min[k] = min_of(arm->workspace_min[k], position[k]);
            arm->workspace_max[k] = max_of(arm->workspace_max[k], position[k]);
        }
    }
}

void can_arm_steps(const struct can_arm *arm, double *position, double *angle)
{
    double joints[DPT_JOINTS_MAX], velocity[3], spin[3];
    *position = *angle = 0.0;
    const uint32_t points = grid_point(arm, 0, joints);
    for (uint32_t i = 0; i < arm->joints; i++)
        if (!(drive_position_step(&arm->ends[i]) > 0.0))
            return;
    for (uint32_t n = 0; n < points; n++) {
        grid_point(arm, n, joints);
        for (uint32_t i = 0; i < arm->joints; i++) {
            double step[DPT_JOINTS_MAX] = { 0.0 };
            step[i] = fabs(arm->joint_per_turn[i]) * drive_position_step(&arm->ends[i]);
            if (dpt_arm_velocity(arm->arm, joints, step, velocity, spin) != DPT_OK)
                continue;
            *position = max_of(*position, vec3_length(velocity));
            *angle = max_of(*angle, vec3_length(spin));
        }
    }
}

/*
 * The force, N, or torque, Nm, that the arm can give along every axis, with its joints in the middle of their limits.
 */
static double max_along_axes(const struct can_arm *arm, int is_torque)
{
    double min_strength = 1e3;
    for (int i = 0; i < 3; i++) {
        dpt_wrench wrench = { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.0 } };
        double efforts[DPT_JOINTS_MAX];
        (is_torque ? wrench.torque : wrench.force)[i] = 1.0;
        if (dpt_arm_efforts(arm->arm, arm->middle, &wrench, efforts) != DPT_OK)
            return 0.0;
        for (uint32_t k = 0; k < arm->joints; k++)
            if (fabs(efforts[k]) > 0.0)
                min_strength = min_of(min_strength, arm->limit[k] / fabs(efforts[k]));
    }
    return min_strength;
}

void can_arm_apply_ranges(struct can_arm *arm)
{
    for (uint32_t i = 0; i < arm->joints; i++) {
        struct drive_node *node = &arm->ends[i];
        const double step = drive_torque_step(node), per_effort = fabs(arm->torque_per_effort[i]);
        arm->limit[i] = arm->joint_limit[i];
        if (node->torque_range > 0.0)
            arm->limit[i] = min_of(arm->limit[i], node->torque_range / per_effort);
        node->torque_limit = arm->limit[i] * per_effort;
        arm->limit[i] = max_of(arm->limit[i] - 0.5 * step / per_effort, 0.0);
    }
    arm->force_max = max_along_axes(arm, 0);
    arm->torque_max = arm->wrench_dofs == 6 ? max_along_axes(arm, 1) : 0.0;
}

static dpt_result set_up(struct can_arm *arm, struct can_settings *settings, dpt_device_error *error)
{
    dpt_arm_joint joint[DPT_JOINTS_MAX];
    dpt_arm_info info = { .size = sizeof info };
    dpt_pose tool;
    dpt_arm_get_info(arm->arm, &info);
    arm->joints = info.joints;
    arm->wrench_dofs = info.joints >= 6 ? 6 : 3;
    for (uint32_t i = 0; i < arm->joints; i++) {
        joint[i].size = sizeof joint[i];
        dpt_arm_get_joint(arm->arm, i, &joint[i]);
        arm->is_slider[i] = joint[i].kind == DPT_JOINT_PRISMATIC;
        arm->joint_limit[i] = joint[i].effort;
        arm->middle[i] = coordinate_at(&joint[i], 0.5);
    }
    const dpt_result result = dpt_arm_forward(arm->arm, arm->middle, &tool);
    if (result != DPT_OK)
        return device_error(error, result, "the arm's joints have no middle");
    memcpy(arm->centre, tool.position, sizeof arm->centre);
    DPT_TRY(read_drives(arm, settings, error));
    DPT_TRY(read_nodes(arm, settings, error));
    DPT_TRY(read_gears(arm, settings, error));
    DPT_TRY(read_axes(arm, settings->axes, error));
    DPT_TRY(read_list("centre", settings->centre, 3, arm->centre, error));
    const double down[3] = { 0.0, settings->weight != 0.0 && info.mass > 0.0 ? -GRAVITY : 0.0, 0.0 };
    can_arm_to_root(arm, down, arm->gravity);
    measure_workspace(arm);
    can_arm_apply_ranges(arm);
    return DPT_OK;
}

static dpt_result read_file(const char *path, void **bytes, size_t *size, dpt_device_error *error)
{
    FILE *file = fopen(path, "rb");
    if (!file)
        return device_error(error, DPT_E_OPEN, "%.120s: %.80s", path, strerror(errno));
    long length = fseek(file, 0, SEEK_END) ? -1 : ftell(file);
    dpt_result result = DPT_E_OPEN;
    if (length > 0 && length <= FILE_BYTES_MAX && !fseek(file, 0, SEEK_SET)) {
        *bytes = malloc((size_t)length);
        *size = (size_t)length;
        result = !*bytes ? DPT_E_MEMORY : fread(*bytes, 1, *size, file) == (size_t)length ? DPT_OK : DPT_E_OPEN;
    }
    fclose(file);
    return result == DPT_OK ? DPT_OK
                            : device_error(error, result, "%.120s: %.80s", path,
                                           result == DPT_E_MEMORY ? "no memory" : "cannot be read");
}

dpt_result can_arm_open(struct can_arm *arm, struct can_settings *settings, dpt_device_error *error)
{
    size_t size = 0;
    memset(arm, 0, sizeof *arm);
    if (!settings->arm[0])
        return device_error(error, DPT_E_SETTING,
                            "which arm? Name its compiled file by ?arm=FILE.dpa (dynpoint compile makes it of a URDF)");
    dpt_result result = read_file(settings->arm, &arm->bytes, &size, error);
    if (result == DPT_OK) {
        result = dpt_arm_open(arm->bytes, size, &arm->arm);
        if (result == DPT_E_BYTE_ORDER && dpt_arm_convert(arm->bytes, size, NULL) == DPT_OK)
            result = dpt_arm_open(arm->bytes, size, &arm->arm);
        if (result != DPT_OK)
            device_error(error, result, "%.120s is no compiled arm: %.100s", settings->arm, dpt_result_text(result));
    }
    if (result == DPT_OK)
        result = set_up(arm, settings, error);
    if (result != DPT_OK)
        can_arm_close(arm);
    return result;
}

void can_arm_close(struct can_arm *arm)
{
    free(arm->bytes);
    arm->bytes = NULL;
}

void can_arm_joints(const struct can_arm *arm, const float *turns, const float *rates, double *joints, double *speeds)
{
    for (uint32_t i = 0; i < arm->joints; i++) {
        joints[i] = arm->zero[i] + (double)turns[i] * arm->joint_per_turn[i];
        speeds[i] = (double)rates[i] * arm->joint_per_turn[i];
    }
}

dpt_result can_arm_pose(const struct can_arm *arm, const double *joints, const double *speeds, dpt_device_state *state)
{
    dpt_pose tool;
    double velocity[3], spin[3];
    DPT_TRY(dpt_arm_forward(arm->arm, joints, &tool));
    DPT_TRY(dpt_arm_velocity(arm->arm, joints, speeds, velocity, spin));
    device_position(arm, &tool, state->pose.position);
    quaternion_multiply(arm->root_to_device, tool.orientation, state->pose.orientation);
    to_device(arm, velocity, state->velocity);
    to_device(arm, spin, state->spin);
    memcpy(state->joint, joints, arm->joints * sizeof *joints);
    return DPT_OK;
}

dpt_result can_arm_torques(const struct can_arm *arm, const double *joints, const dpt_wrench *wrench,
                           double weight_share, float *torques)
{
    dpt_wrench root;
    double efforts[DPT_JOINTS_MAX], weight[DPT_JOINTS_MAX] = { 0.0 };
    double wrench_scale = 1.0, weight_scale = 1.0;
    can_arm_to_root(arm, wrench->force, root.force);
    can_arm_to_root(arm, wrench->torque, root.torque);
    if (arm->wrench_dofs < 6)
        memset(root.torque, 0, sizeof root.torque);
    limit_length(root.force, FORCE_MAX);
    limit_length(root.torque, FORCE_MAX);
    DPT_TRY(dpt_arm_efforts(arm->arm, joints, &root, efforts));
    if (extent_of(vec3_of(arm->gravity)) > 0.0)
        DPT_TRY(dpt_arm_weight(arm->arm, joints, arm->gravity, weight));
    for (uint32_t i = 0; i < arm->joints; i++) {
        weight[i] *= weight_share;
        weight_scale =
            fabs(weight[i]) > arm->limit[i] ? min_of(weight_scale, arm->limit[i] / fabs(weight[i])) : weight_scale;
    }
    for (uint32_t i = 0; i < arm->joints; i++) {
        weight[i] *= weight_scale;
        const double effort_left = arm->limit[i] - (efforts[i] > 0.0 ? weight[i] : -weight[i]);
        if (fabs(efforts[i]) > effort_left)
            wrench_scale = min_of(wrench_scale, max_of(effort_left, 0.0) / fabs(efforts[i]));
    }
    for (uint32_t i = 0; i < arm->joints; i++)
        torques[i] = (float)((weight[i] + wrench_scale * efforts[i]) * arm->torque_per_effort[i]);
    return DPT_OK;
}
