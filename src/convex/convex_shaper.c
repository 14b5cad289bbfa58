/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/frame.h"
#include "base/sized.h"
#include "dynpoint/convex.h"

#define STIFFNESS_MAX 1e9

static int is_valid(const dpt_convex_shaper *shaper)
{
    dpt_convex_shaper known;
    return sized_read(shaper, sizeof known, &known, sizeof known) == DPT_OK && shaper->shape &&
           (shaper->bodies || !shaper->body_count) && (shaper->law == DPT_LAW_POINT || shaper->law == DPT_LAW_BED) &&
           shaper->stiffness >= 0.0 && shaper->stiffness <= STIFFNESS_MAX;
}

/* Add a force of `stiffness` times the depth. */
static void push(const dpt_convex_contact *contact, const dpt_pose *tool, double stiffness, dpt_wrench *wrench)
{
    const vec3 force = scaled(vec3_of(contact->direction), stiffness * contact->depth);
    const vec3 arm = sub(vec3_of(contact->point), vec3_of(tool->position));
    vec3_store(add(vec3_of(wrench->force), force), wrench->force);
    vec3_store(add(vec3_of(wrench->torque), cross(arm, force)), wrench->torque);
}

void dpt_convex_shape_wrench(void *user, const dpt_force_info *info, double dt, dpt_wrench *wrench)
{
    dpt_convex_shaper *shaper = user;
    dpt_convex_contact deepest = { .size = sizeof deepest, .contact = DPT_CONTACT_UNKNOWN, .triangle = DPT_NONE };
    dpt_pose tool;
    (void)info;
    (void)dt;
    if (!shaper || !wrench || !is_valid(shaper))
        return;
    /* A bed's end has half of the tool's stiffness (docs/algorithms/force.md). */
    const double stiffness = shaper->law == DPT_LAW_BED ? 0.5 * shaper->stiffness : shaper->stiffness;
    shaper->body = DPT_NONE;
    shaper->energy = 0.0;
    const int has_pose = dpt_tool_get_pose(shaper->world, shaper->tool, &tool) == DPT_OK;
    shaper->errors += (uint32_t)!has_pose;
    for (uint32_t i = 0; has_pose && i < shaper->body_count; i++) {
        const dpt_convex_body *body = &shaper->bodies[i];
        dpt_convex_contact contact = { .size = sizeof contact };
        if (dpt_convex_touch(shaper->shape, &tool, body->mesh, body->pose, &contact) != DPT_OK) {
            shaper->errors++;
            continue;
        }
        if (contact.contact == DPT_CONTACT_PENETRATING) {
            push(&contact, &tool, stiffness, wrench);
            shaper->energy += 0.5 * stiffness * contact.depth * contact.depth;
        }
        if (deepest.status != DPT_STATUS_BOUNDED || contact.depth > deepest.depth) {
            deepest = contact;
            shaper->body = contact.contact == DPT_CONTACT_PENETRATING ? i : DPT_NONE;
        }
    }
    if (shaper->contact && sized_check(shaper->contact, sizeof deepest, 0) == DPT_OK)
        sized_write(shaper->contact, shaper->contact->size, &deepest, sizeof deepest);
}
