/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The proxy (docs/algorithms/force.md): where it is, by every triangle, and that the wrench is that of a spring to it.
 * What lies between two steps cannot be judged here; that a closed body is not entered can.
 */
#include "fuzz/calls/deform_model.h"
#include "fuzz/calls/rules.h"

/* Of the wrench's sums. */
static const double ROUNDING = 1e-9;

static const double zero[3] = { 0.0, 0.0, 0.0 };

/* A tool's middle in its frame, and the mean square of its points' distance from there; of points alone, all alike. */
struct shape {
    double centre[3], square;
};

static struct shape shape_of(const dpt_segment *segments, uint32_t count)
{
    struct shape shape = { .square = 0.0 };
    double whole = 0.0;
    for (uint32_t i = 0; i < count; i++)
        whole += apart(segments[i].a, segments[i].b);
    for (uint32_t i = 0; i < count; i++) {
        const double length = apart(segments[i].a, segments[i].b);
        const double weight = whole > 0.0 ? length / whole : 1.0 / count;
        for (int k = 0; k < 3; k++)
            shape.centre[k] += weight * 0.5 * (segments[i].a[k] + segments[i].b[k]);
    }
    for (uint32_t i = 0; i < count; i++) {
        const double length = apart(segments[i].a, segments[i].b);
        double middle[3];
        for (int k = 0; k < 3; k++)
            middle[k] = 0.5 * (segments[i].a[k] + segments[i].b[k]);
        const double far = apart(middle, shape.centre);
        const double weight = whole > 0.0 ? length / whole : 1.0 / count;
        shape.square += weight * (far * far + length * length / 12.0);
    }
    return shape;
}

/* Of the segment that is farthest away: the others turn with it. */
static double slack_of_tool(const struct scene *scene, const struct model_tool *tool)
{
    double slack = 0.0;
    for (uint32_t i = 0; i < tool->count; i++)
        slack = fmax(slack, slack_of(scene, &tool->at[i]));
    return slack;
}

/* Whether nothing but the spring makes the wrench of this step. */
static int is_spring_alone(const struct scene *scene, const struct model_tool *tool, const dpt_force_info *report)
{
    int yields = 0;
    for (uint32_t i = 0; i < scene->body_count; i++)
        yields |= scene->body[i].stiffness > 0.0;
    return !yields && !(tool->damping > 0.0) && !(report->flags & (DPT_FORCE_FLAG_FADING | DPT_FORCE_FLAG_BEHIND));
}

/* rad */
#define SPIN_MAX 1.5

/* What the spring stores at half a turn, over its stiffness: its torque grows up to 1 rad and falls from 1 rad before. */
#define STORED_MAX (3.14159265358979 - 1.0)

/* A spring between the two middles; its torque about the middle is at most that of 1 rad. */
static void spring_must_hold(const struct scene *scene, const struct model_tool *tool, const dpt_force_info *report)
{
    const double K = tool->stiffness_then, slack = 10.0 * slack_of_tool(scene, tool);
    const double *F = report->wrench.force, *T = report->wrench.torque;
    const struct shape shape = shape_of(tool->is_free ? tool->at : tool->segment, tool->count);
    double device[3], proxy[3], expected[3], arm[3], about[3];
    to_world(&tool->pose, shape.centre, device);
    to_world(&tool->proxy, shape.centre, proxy);
    for (int k = 0; k < 3; k++) {
        if (tool->is_free)
            proxy[k] = 0.5 * (tool->proxy_at[0].a[k] + tool->proxy_at[0].b[k]);
        expected[k] = K * (proxy[k] - device[k]);
        arm[k] = device[k] - tool->origin[k];
    }
    const double far = apart(proxy, device), size = K * far;
    HOLDS(apart(F, expected) <= ROUNDING * size + K * slack, "%g N, and not %g", apart(F, zero), size);
    const double shaped = K * shape.square;
    double turning = tool->rotational_stiffness > 0.0 ? tool->rotational_stiffness : shaped;
    if (tool->lock_rotation)
        turning = 1e9 + 1e6 * shaped;
    turning = fmin(fmax(turning, 1e-6 * shaped), 1e6 * shaped);
    /* Friction holds a straight tool's spin back by at most SPIN_MAX where it rolls, at K r^2 (force.md). */
    double stored = STORED_MAX * turning;
    for (uint32_t i = 0; i < tool->count; i++) {
        const double spinning = K * tool->segment[i].radius * tool->segment[i].radius;
        turning += SPIN_MAX * spinning;
        stored += 0.5 * SPIN_MAX * SPIN_MAX * spinning;
    }
    for (int k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        about[k] = T[k] - (arm[i] * F[j] - arm[j] * F[i]);
    }
    const double lever = apart(arm, zero) + slack;
    HOLDS(apart(about, zero) <= turning * (1.0 + ROUNDING) + ROUNDING * lever * size + lever * K * slack,
          "%g Nm of a turn, at %g Nm/rad", apart(about, zero), turning);
    const double shift = 0.5 * size * far, least = K * slack * slack + 1e-300;
    HOLDS(report->energy >= shift * (1.0 - ROUNDING) - size * slack - least &&
              report->energy <= (shift + stored) * (1.0 + ROUNDING) + size * slack + least,
          "%g J, %g of them of the shift", report->energy, shift);
}

/* Nothing is nearer to its surface than it may be, and it is in no closed body. */
static void it_must_be_outside(const struct scene *scene, const struct model_tool *tool)
{
    for (uint32_t i = 0; i < tool->count; i++) {
        const dpt_segment *at = &tool->proxy_at[i];
        const double distance = true_distance(scene, at);
        HOLDS(distance >= at->radius - slack_of_tool(scene, tool),
              "segment %u of the proxy is %.17g m from a body, its radius is %.17g", i, distance, at->radius);
        for (uint32_t b = 0; b < scene->then_count && distance > 1e-9; b++)
            HOLDS(!is_solid_then(&scene->then[b]) || fabs(times_inside(&scene->then[b], at->a)) < 0.5,
                  "segment %u of the proxy is in body %x", i, scene->then[b].id);
    }
}

static void it_must_be_the_device(const struct scene *scene, const struct model_tool *tool)
{
    if (!tool->is_free) {
        HOLDS(!memcmp(&tool->proxy, &tool->pose, sizeof tool->pose), "free, and %g m from the device",
              apart(tool->proxy.position, tool->pose.position));
        return;
    }
    const double slack = slack_of_tool(scene, tool);
    HOLDS(apart(tool->proxy_at[0].a, tool->at[0].a) <= slack &&
              (tool->has_grown || apart(tool->proxy_at[0].b, tool->at[0].b) <= slack),
          "free, and %g m, %g m from the device", apart(tool->proxy_at[0].a, tool->at[0].a),
          apart(tool->proxy_at[0].b, tool->at[0].b));
}

void proxy_must_hold(const struct scene *scene, const struct model_tool *tool, const dpt_force_info *report)
{
    dpt_pose pose[2];
    dpt_force_info twin = { .size = sizeof twin };
    EACH_WORLD(scene, i)
    HOLDS(RESULT(dpt_tool_get_proxy, scene->world[i], tool->id, &pose[i]) == DPT_OK, "no proxy");
    if (scene->world_count == 2) {
        dpt_tool_get_force_info(scene->world[1], tool->id, &twin);
        HOLDS(!memcmp(&pose[0], &pose[1], sizeof *pose) && !memcmp(report, &twin, sizeof twin),
              "the twin's proxy is elsewhere");
    }
    const double *q = pose->orientation;
    const double size = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    numbers_are_finite(pose->position, 7, "a proxy");
    HOLDS(fabs(sqrt(size) - 1.0) <= 1.000001e-6, "a quaternion of length %.17g", sqrt(size));
    if (!has_proxy(scene, tool->law)) {
        HOLDS(!memcmp(pose, &tool->pose, sizeof *pose), "not the tool's pose, and no proxy");
        return;
    }
    if (tool->answers != ANSWERS_THERE || !scene->is_as_stepped)
        return;
    HOLDS(!memcmp(pose, &tool->proxy, sizeof *pose), "the proxy has moved without a step");
    met[MET_HELD] += report->reason == DPT_FORCE_ACTS;
    met[MET_HELD_FREE] += report->reason == DPT_FORCE_ACTS && tool->is_free;
    met[MET_BEGAN_INSIDE] += report->reason == DPT_FORCE_INSIDE;
    met[MET_FOLD] += (report->flags & DPT_FORCE_FLAG_FOLD) != 0;
    met[MET_SQUEEZED] += (report->flags & DPT_FORCE_FLAG_SQUEEZED) != 0;
    met[MET_BEHIND] += (report->flags & DPT_FORCE_FLAG_BEHIND) != 0;
    met[MET_REPLACED] += (report->flags & DPT_FORCE_FLAG_REPLACED) != 0;
    if (report->reason == DPT_FORCE_FREE)
        it_must_be_the_device(scene, tool);
    if (report->reason == DPT_FORCE_ACTS && !tool->has_grown && is_spring_alone(scene, tool, report))
        spring_must_hold(scene, tool, report);
    if (all_are_known(scene) && (report->reason == DPT_FORCE_ACTS || report->reason == DPT_FORCE_FREE))
        it_must_be_outside(scene, tool);
}
