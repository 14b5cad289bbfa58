/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/frame.h"
#include "dynpoint/openhaptics.h"
#include "openhaptics/hd_api.h"

static const double MM = 1000.0, AXES_ERROR_MAX = 0.1;

int dpt_hd_is_force_error(uint32_t code)
{
    return code >= HD_WARM_MOTORS && code <= HD_FORCE_ERROR;
}

int dpt_hd_is_scheduler_error(uint32_t code)
{
    return (code >= HD_COMM_ERROR && code <= HD_TIMER_ERROR) || code == HD_INVALID_PRIORITY ||
           code == HD_SCHEDULER_FULL;
}

dpt_result dpt_hd_to_metres(const double from[3], double to[3])
{
    if (!from || !to)
        return DPT_E_ARGUMENT;
    if (!vec3_within(from, DPT_COORDINATE_MAX * MM))
        return DPT_E_FINITE;
    for (int k = 0; k < 3; k++)
        to[k] = from[k] / MM;
    return DPT_OK;
}

dpt_result dpt_hd_to_millimetres(const double from[3], double to[3])
{
    if (!from || !to)
        return DPT_E_ARGUMENT;
    if (!vec3_within(from, DPT_COORDINATE_MAX))
        return DPT_E_FINITE;
    for (int k = 0; k < 3; k++)
        to[k] = from[k] * MM;
    return DPT_OK;
}

/* The quaternion of a right-handed frame, w >= 0. Divides by the largest component, so never by a small number. */
static void quaternion_of(vec3 x, vec3 y, vec3 z, double q[4])
{
    const double square[4] = { 1.0 + x.x + y.y + z.z, 1.0 + x.x - y.y - z.z, 1.0 - x.x + y.y - z.z,
                               1.0 - x.x - y.y + z.z };
    int largest = 0;
    for (int i = 1; i < 4; i++)
        if (square[i] > square[largest])
            largest = i;
    const double root = sqrt(square[largest]), part = 0.5 / root;
    const double wx = part * (y.z - z.y), wy = part * (z.x - x.z), wz = part * (x.y - y.x);
    const double xy = part * (y.x + x.y), xz = part * (z.x + x.z), yz = part * (z.y + y.z);
    const double rows[4][4] = {
        { 0.5 * root, wx, wy, wz }, { wx, 0.5 * root, xy, xz }, { wy, xy, 0.5 * root, yz }, { wz, xz, yz, 0.5 * root }
    };
    for (int i = 0; i < 4; i++)
        q[i] = rows[largest][0] < 0.0 ? -rows[largest][i] : rows[largest][i];
}

dpt_result dpt_hd_to_pose(const double transform[16], dpt_pose *pose)
{
    if (!transform || !pose)
        return DPT_E_ARGUMENT;
    for (int i = 0; i < 12; i += 4)
        if (!vec3_within(transform + i, DPT_COORDINATE_MAX))
            return DPT_E_FINITE;
    vec3 x = vec3_of(transform), y = vec3_of(transform + 4), z = vec3_of(transform + 8);
    double position[3];
    const dpt_result result = dpt_hd_to_metres(transform + 12, position);
    if (result != DPT_OK)
        return result;
    if (!within(length(x) - 1.0, AXES_ERROR_MAX) || !within(length(y) - 1.0, AXES_ERROR_MAX) ||
        !within(length(z) - 1.0, AXES_ERROR_MAX) || !within(dot(x, y), AXES_ERROR_MAX) ||
        !within(dot(y, z), AXES_ERROR_MAX) || !within(dot(z, x), AXES_ERROR_MAX) || dot(cross(x, y), z) < 0.0)
        return DPT_E_POSE;
    z = unit_of(z);
    x = unit_of(along(x, -dot(x, z), z));
    y = cross(z, x);
    vec3_store(vec3_of(position), pose->position);
    quaternion_of(x, y, z, pose->orientation);
    return DPT_OK;
}

dpt_result dpt_hd_to_transform(const dpt_pose *pose, double transform[16])
{
    struct frame frame;
    if (!pose || !transform)
        return DPT_E_ARGUMENT;
    const dpt_result result = frame_of_pose(pose, &frame);
    if (result != DPT_OK)
        return result;
    vec3_store(frame.x, transform);
    vec3_store(frame.y, transform + 4);
    vec3_store(frame.z, transform + 8);
    dpt_hd_to_millimetres(pose->position, transform + 12);
    for (int i = 0; i < 4; i++)
        transform[4 * i + 3] = i == 3 ? 1.0 : 0.0;
    return DPT_OK;
}
