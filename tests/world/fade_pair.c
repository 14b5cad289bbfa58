/* SPDX-License-Identifier: BSD-3-Clause */
#include "world/fade_pair.h"

int pair_open(struct pair *pair, const struct fixture *mesh, const dpt_pose *pose, const dpt_segment *segments,
              uint32_t count, const dpt_world_def *like, double dt)
{
    *pair = (struct pair){ .fade = like->fade, .dt = dt };
    for (int w = 0; w < 2; w++) {
        dpt_world_def def = *like;
        def.fade = w == FADES ? like->fade : 0.0;
        if (!rig_open(&pair->rig[w], &def, NULL, segments, count))
            return 0;
        pair->rig[w].dt = dt;
        for (int b = 0; b < BODIES && mesh; b++)
            if (!b || pose)
                pair->body[w][b] = rig_add_body(&pair->rig[w], mesh->mesh, b ? pose : NULL);
    }
    return 1;
}

/* Is `said` the way's share from `was` to `truth`? */
static int is_on_way(const dpt_wrench *reported, const dpt_wrench *previous, const dpt_wrench *truth, double share)
{
    for (int k = 0; k < 6; k++) {
        double from = number_of(previous, k), to = number_of(truth, k);
        double off = fabs(number_of(reported, k) - (from + share * (to - from)));
        if (!(off <= 1e-12 * (fabs(from) + fabs(to))))
            return 0;
    }
    return 1;
}

/* The body that pushes the tool back through an open sheet: of the deepest contact, if that has a side. */
static dpt_body sided_body(const struct pair *pair, dpt_body of)
{
    dpt_contact contact[8];
    uint32_t count = 0;
    double least = HUGE_VAL;
    dpt_body body = 0;
    contact[0].size = sizeof contact[0];
    dpt_tool_get_contacts(pair->rig[TRUE_ONE].world, pair->rig[TRUE_ONE].tool, contact, 8, &count);
    for (uint32_t i = 0; i < count && i < 8; i++)
        if (contact[i].gap < least && (!of || contact[i].body == of)) {
            least = contact[i].gap;
            body = contact[i].flags & DPT_CONTACT_FLAG_SIDED ? contact[i].body : 0;
        }
    return body;
}

/* What holds of the two answers of any tick. */
static void check_answers(const struct pair *pair)
{
    dpt_wrench alone;
    dpt_tool_get_wrench(pair->rig[FADES].world, pair->rig[FADES].tool, &alone);
    CHECK(memcmp(&pair->hit, &pair->rig[TRUE_ONE].hit, sizeof pair->hit) == 0, "hits differ");
    CHECK(memcmp(&alone, &pair->reported.wrench, sizeof alone) == 0, "get_wrench says another");
    CHECK(pair->reported.reason == pair->truth.reason, "reasons %u and %u", pair->reported.reason, pair->truth.reason);
    CHECK(!(pair->truth.flags & DPT_FORCE_FLAG_FADING), "a fade of 0 fades");
    CHECK(size_of_force(&pair->truth.wrench) == 0.0 || pair->truth.reason == DPT_FORCE_ACTS, "a force by reason %u",
          pair->truth.reason);
}

void pair_step(struct pair *pair)
{
    const dpt_force_info previous = pair->reported;
    rig_tick(&pair->rig[FADES]);
    rig_tick(&pair->rig[TRUE_ONE]);
    pair->reported = pair->rig[FADES].force;
    pair->truth = pair->rig[TRUE_ONE].force;
    pair->hit = pair->rig[FADES].hit;
    check_answers(pair);

    const int unknown = pair->truth.reason == DPT_FORCE_UNDECIDED;
    const int fades = (pair->reported.flags & DPT_FORCE_FLAG_FADING) != 0;
    const int must = unknown && !pair->was_unknown && size_of_force(&previous.wrench) > 0.0;
    const int full = (pair->rig[TRUE_ONE].step.flags & DPT_STEP_FLAG_CONTACTS_FULL) != 0;
    const int may = must || (pair->sided && !sided_body(pair, pair->sided)) ||
                    (full | pair->was_full); /* not all contacts are told */
    pair->was_full = full;
    const double left = pair->left - pair->dt > 1e-9 * pair->dt ? pair->left : pair->dt;
    const double anew = pair->fade > pair->dt * (1.0 + 1e-9) ? pair->fade : pair->dt;
    const int goes_on = is_on_way(&pair->reported.wrench, &previous.wrench, &pair->truth.wrench, pair->dt / left);
    const int begins = is_on_way(&pair->reported.wrench, &previous.wrench, &pair->truth.wrench, pair->dt / anew);
    CHECK(must ? begins : goes_on || (may && begins),
          "%g N, from %g to %g with %g s left: goes on %d, begins %d, must %d, may %d",
          size_of_force(&pair->reported.wrench), size_of_force(&previous.wrench), size_of_force(&pair->truth.wrench),
          pair->left, goes_on, begins, must, may);
    const int begun = must || (may && begins && !goes_on);
    pair->left = begun ? anew - pair->dt : left - pair->dt;
    pair->left = pair->left > 1e-9 * pair->dt ? pair->left : 0.0;
    CHECK(fades == (pair->left > 0.0) || (may && !begun && fades), "flag %d, %g s left", fades, pair->left);
    if (fades && !(pair->left > 0.0)) /* it began, but both ways were the same */
        pair->left = anew - pair->dt;
    CHECK(fades || memcmp(&pair->reported.wrench, &pair->truth.wrench, sizeof pair->truth.wrench) == 0,
          "no fade, but %g N for %g", size_of_force(&pair->reported.wrench), size_of_force(&pair->truth.wrench));
    CHECK(size_of_force(&pair->reported.wrench) <=
              (1.0 + 1e-12) * fmax(size_of_force(&previous.wrench), size_of_force(&pair->truth.wrench)),
          "more than previous felt, and is true");
    pair->begun += (unsigned)begun;
    pair->ticks += (unsigned)fades;
    pair->taken_up += fades && pair->was_unknown && !unknown;
    if (size_of_force(&pair->truth.wrench) > 0.0)
        pair->sided = sided_body(pair, 0);
    else if (unknown)
        pair->sided = 0;
    pair->was_unknown = unknown;
}

dpt_pose pose_at(double x, double y, double z)
{
    dpt_pose pose = DPT_POSE_IDENTITY;
    pose.position[0] = x;
    pose.position[1] = y;
    pose.position[2] = z;
    return pose;
}

void pair_go(struct pair *pair, const dpt_pose *from, const dpt_pose *to)
{
    double way = 0.0;
    for (int k = 0; k < 3; k++)
        way += fabs(to->position[k] - from->position[k]);
    const int ticks = 1 + (int)(way / 5e-4);
    for (int t = 1; t <= ticks; t++) {
        dpt_pose pose = *to;
        for (int k = 0; k < 3; k++)
            pose.position[k] = from->position[k] + (to->position[k] - from->position[k]) * t / ticks;
        pair_pose(pair, &pose);
        pair_step(pair);
    }
}
