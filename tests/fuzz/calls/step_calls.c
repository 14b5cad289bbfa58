/* SPDX-License-Identifier: BSD-3-Clause */
/* The step, good and bad, and then all that a world tells of it. */
#include "fuzz/calls/deform_model.h"
#include "fuzz/calls/rules.h"

enum { CONTACTS_MAX = 40, STRIP_MAX = 48 };

/* What all segments came to, as dpt_step sums it up. */
struct sum {
    uint32_t segments, status, contact, work, contacts;
    double distance;
    int any, may_be_bounded;
};

static int gravity(uint32_t contact)
{
    return contact == DPT_CONTACT_PENETRATING ? 3
           : contact == DPT_CONTACT_TOUCHING  ? 2
           : contact == DPT_CONTACT_UNKNOWN   ? 1
                                              : 0;
}

/* `may_be_far`: a bounded hit may be of a segment that was left out, which the step's status does not count. */
static void add_up(struct sum *sum, const dpt_hit *hit, int may_be_far)
{
    if (!sum->segments++)
        *sum = (struct sum){
            .segments = 1, .status = DPT_STATUS_EXACT, .contact = DPT_CONTACT_SEPARATED, .contacts = sum->contacts
        };
    sum->work += hit->work;
    if (hit->status == DPT_STATUS_BOUNDED && may_be_far)
        sum->may_be_bounded = 1;
    else if (hit->status < sum->status)
        sum->status = hit->status;
    if (gravity(hit->contact) > gravity(sum->contact))
        sum->contact = hit->contact;
    if (hit->status != DPT_STATUS_STALE && (!sum->any || hit->distance < sum->distance)) {
        sum->distance = hit->distance;
        sum->any = 1;
    }
}

static void read_strip(struct scene *scene, const struct model_tool *tool, const dpt_hit *hit)
{
    static dpt_overlap overlaps[STRIP_MAX];
    const uint32_t segment = hit->segment;
    const struct body_then *body = scene_body_then(scene, hit->body);
    uint32_t count = 0, flags = 0;
    overlaps[0].size = sizeof *overlaps;
    HOLDS(RESULT(dpt_tool_get_strip, scene->world[0], tool->id, segment, overlaps, STRIP_MAX, &count, &flags) == DPT_OK,
          "no strip of segment %u", segment);
    if (scene->least.strip < count)
        scene->least.strip = count;
    for (uint32_t i = 0; i < count; i++)
        numbers_are_finite(&overlaps[i].distance, 10, "an overlap");
    if (!has_proxy(scene, tool->law_then))
        overlaps_must_hold(overlaps, count, tool->at[segment].radius);
    else if (!tool->has_grown)
        overlaps_must_hold(overlaps, count, tool->proxy_at[segment].radius);
    if (body && !has_proxy(scene, tool->law_then) && tool->answers == ANSWERS_THERE)
        strip_must_be_true(scene, body, &tool->at[segment], overlaps, count < STRIP_MAX ? count : STRIP_MAX);
    HOLDS(!(flags & DPT_STRIP_FLAG_FULL) || count == scene->def.strip_capacity ||
              scene->def.strip == DPT_STRIP_KIND_ROUTES,
          "full with %u of %u", count, scene->def.strip_capacity);
}

static uint32_t read_contacts(struct scene *scene, const struct model_tool *tool)
{
    static dpt_contact contacts[CONTACTS_MAX];
    uint32_t count = 0;
    contacts[0].size = sizeof *contacts;
    HOLDS(RESULT(dpt_tool_get_contacts, scene->world[0], tool->id, contacts, CONTACTS_MAX, &count) ==
              (scene->def.max_contacts ? DPT_OK : DPT_E_FULL),
          "contacts, with room for %u", scene->def.max_contacts);
    HOLDS(count <= scene->def.max_contacts, "%u contacts of %u", count, scene->def.max_contacts);
    HOLDS(count == 0 || scene->def.until != DPT_UNTIL_TRACK, "%u contacts of the pair alone", count);
    for (uint32_t i = 0; i < count; i++)
        numbers_are_finite(&contacts[i].s0, 24, "a contact");
    contacts_must_hold(scene, tool, contacts, count);
    return count;
}

static void read_tool(struct scene *scene, const struct model_tool *tool, struct sum *sum)
{
    dpt_hit hits[SEGMENTS_MAX], best = DPT_HIT_INIT;
    dpt_sweep sweep = { .size = sizeof sweep };
    dpt_wrench wrench;
    const dpt_world *world = scene->world[0];
    for (uint32_t i = 0; i < tool->count; i++) {
        hits[i].size = sizeof *hits;
        HOLDS(RESULT(dpt_tool_get_segment_hit, world, tool->id, i, &hits[i]) == DPT_OK, "no hit");
        numbers_are_finite(&hits[i].distance, 12, "a hit");
        hit_must_hold(scene, tool, i, &hits[i]);
        if (draw_one_in(6) && scene->is_as_stepped) {
            hit_must_be_true(scene, tool, &hits[i]);
            gap_must_be_true(scene, tool, &hits[i]);
        }
        add_up(sum, &hits[i], tool->near_only_then && tool->count > 1);
        HOLDS(RESULT(dpt_tool_get_sweep, world, tool->id, i, &sweep) == DPT_OK, "no sweep");
        numbers_are_finite(&sweep.time, 8, "a sweep");
        sweep_must_hold(scene, tool, i, &sweep);
        read_strip(scene, tool, &hits[i]);
    }
    HOLDS(RESULT(dpt_tool_get_hit, world, tool->id, &best) == DPT_OK, "no hit");
    twin_finds_hits(scene, tool->id);
    HOLDS(best.segment < tool->count && !memcmp(&best, &hits[best.segment], sizeof best),
          "the tool's hit is none of its segments'");
    for (uint32_t i = 0; i < tool->count && best.status != DPT_STATUS_STALE; i++)
        HOLDS(best.distance - tool->at[best.segment].radius <= hits[i].distance - tool->at[i].radius,
              "segment %u is nearer than the tool", i);
    HOLDS(RESULT(dpt_tool_get_wrench, world, tool->id, &wrench) == DPT_OK, "no wrench");
    dpt_force_info report = { .size = sizeof report };
    HOLDS(RESULT(dpt_tool_get_force_info, world, tool->id, &report) == DPT_OK, "no report");
    wrench_must_hold(scene, tool, hits, &wrench, &report);
    proxy_must_hold(scene, tool, &report);
    sum->contacts += read_contacts(scene, tool);
}

/* Everything that the world tells. */
static struct sum read_all(struct scene *scene)
{
    struct sum sum = { .segments = 0 };
    for (uint32_t t = 0; t < scene->tool_count; t++)
        read_tool(scene, &scene->tool[t], &sum);
    loads_must_hold(scene);
    return sum;
}

static void audit(void)
{
    struct scene *scene = draw_scene();
    if (!scene)
        return;
    const struct sum sum = read_all(scene);
    HOLDS(sum.contacts <= scene->contacts_then, "%u contacts, and there were %u", sum.contacts, scene->contacts_then);
}

static int has_soft(const struct scene *scene)
{
    int has = 0;
    for (uint32_t i = 0; i < scene->body_count; i++)
        has |= scene->body[i].soft != NULL;
    return has;
}

static void step_must_hold(const struct scene *scene, const dpt_step *step)
{
    const uint32_t flags = DPT_STEP_FLAG_CONTACTS_FULL | (has_soft(scene) ? DPT_STEP_FLAG_BODY_HELD : 0u);
    HOLDS(step->status <= DPT_STATUS_EXACT && step->contact <= DPT_CONTACT_PENETRATING && !(step->flags & ~flags) &&
              step->distance >= 0.0,
          "status %u, contact %u, flags %x", step->status, step->contact, step->flags);
    HOLDS(!scene->def.budget || step->work <= scene->def.budget, "work %u of a budget of %u", step->work,
          scene->def.budget);
    HOLDS(step->contacts <= scene->def.max_contacts, "%u contacts of %u", step->contacts, scene->def.max_contacts);
    dpt_world_info usage = { .size = sizeof usage };
    dpt_world_get_info(scene->world[0], &usage);
    HOLDS(!(step->flags & DPT_STEP_FLAG_CONTACTS_FULL) || usage.contacts > scene->def.max_contacts,
          "full, and the most that was wanted is %u of %u", usage.contacts, scene->def.max_contacts);
}

static void step_must_sum_up(struct scene *scene, const dpt_step *step)
{
    const struct sum sum = read_all(scene);
    HOLDS(sum.contacts == step->contacts, "%u contacts, and there are %u", step->contacts, sum.contacts);
    HOLDS(sum.work == step->work, "work %u, and not %u", step->work, sum.work);
    HOLDS(sum.any || (step->status == DPT_STATUS_STALE && step->distance == 0.0), "status %u", step->status);
    HOLDS(!sum.any || ((step->status == sum.status ||
                        (sum.may_be_bounded && scene->def.budget && step->status == DPT_STATUS_BOUNDED)) &&
                       step->contact == sum.contact && step->distance == sum.distance),
          "status %u, contact %u, distance %g, and not %u, %u, %g", step->status, step->contact, step->distance,
          sum.status, sum.contact, sum.distance);
}

static double draw_dt(struct codes *codes)
{
    static const double odd[] = { 0.0, -0.0, -0.001, NAN, INFINITY, -INFINITY, 1e300, 1e-300 };
    const double usual[] = { 0.001, 0.001, 0.001, 1e-4, 0.02 };
    const double dt = draw_one_in(16) ? odd[draw_below(8)] : usual[draw_below(5)];
    may_fail(codes, !(dt > 0.0 && dt <= 1e6), DPT_E_ARGUMENT);
    return dt;
}

void scene_steps(struct scene *scene)
{
    struct codes codes = { .count = 0 };
    const int no_world = draw_one_in(100), no_out = draw_one_in(4);
    const double dt = draw_dt(&codes);
    dpt_step now;
    const size_t first = offsetof(dpt_step, contacts);
    const uint32_t size = draw_size(first, sizeof now);
    dpt_result result = DPT_OK;
    may_fail(&codes, no_world, DPT_E_ARGUMENT);
    if (!no_out)
        size_codes_of_output(size, first, 0, &codes);
    call_with("scene %llu, size %llu", (uint64_t)(scene - scenes), size, 0, 0);
    EACH_WORLD(scene, i)
    {
        dpt_step *out = output_sized(i, size);
        SAME_RESULT(i, result, RESULT(dpt_world_step, world_or_null(scene, i, no_world), dt, no_out ? NULL : out));
    }
    expect(result, &codes);
    outputs_are_guarded(0, scene->world_count);
    if (scene->world_count == 2)
        outputs_agree(1);
    if (result != DPT_OK) {
        if (!no_world) {
            scene_is_stale(scene);
            softs_have_stepped(scene, 0.0);
        }
        if (draw_one_in(2))
            read_all(scene);
        return;
    }
    scene_has_stepped(scene, dt);
    scene->contacts_then = scene->def.max_contacts;
    if (no_out) {
        scene->contacts_then = read_all(scene).contacts;
        loads_are_due(scene);
        loads_must_hold(scene);
        return;
    }
    if (!output_read(0, size, sizeof now, offsetof(dpt_step, distance), &now))
        return;
    scene->contacts_then = now.contacts;
    loads_are_due(scene);
    step_must_hold(scene, &now);
    met[MET_CONTACTS_FULL] += now.flags & DPT_STEP_FLAG_CONTACTS_FULL ? 1 : 0;
    met[MET_TWIN] += scene->world_count == 2;
    if (draw_one_in(3))
        step_must_sum_up(scene, &now);
    if (scene->least.contacts < now.contacts)
        scene->least.contacts = now.contacts;
    if (scene->least.work < now.work)
        scene->least.work = now.work;
}

static void step(void)
{
    struct scene *scene = draw_scene();
    if (scene)
        scene_steps(scene);
}

/* A tool that moves a little between steps: what is carried from tick to tick is used. */
static void ride(void)
{
    struct scene *scene = draw_scene();
    if (!scene || !scene->tool_count)
        return;
    const uint32_t ticks = 2 + draw_below(6);
    const uint32_t which = draw_below(scene->tool_count);
    double way[3];
    for (int k = 0; k < 3; k++)
        way[k] = draw_in(-0.01, 0.01);
    for (uint32_t i = 0; i < ticks; i++) {
        struct model_tool *tool = &scene->tool[which];
        dpt_pose pose = tool->pose;
        for (int k = 0; k < 3; k++)
            pose.position[k] += way[k];
        struct codes codes = { .count = 0 };
        pose_codes(&pose, &codes);
        dpt_result result = DPT_OK;
        EACH_WORLD(scene, w)
        SAME_RESULT(w, result, RESULT(dpt_tool_set_pose, scene->world[w], tool->id, &pose));
        expect(result, &codes);
        tool_has_pose(scene, tool, result == DPT_OK ? &pose : NULL);
        scene_steps(scene);
    }
}

/* Of a radius that just reaches the surface. */
static void touch(void)
{
    struct scene *scene = draw_scene();
    struct model_tool *tool = scene && scene->tool_count ? &scene->tool[draw_below(scene->tool_count)] : NULL;
    dpt_hit hit = DPT_HIT_INIT;
    if (!tool || tool->answers != ANSWERS_THERE || !scene->is_as_stepped)
        return;
    HOLDS(RESULT(dpt_tool_get_hit, scene->world[0], tool->id, &hit) == DPT_OK, "no hit");
    twin_finds_hits(scene, tool->id);
    struct codes codes = { .count = 0 };
    dpt_segment segments[SEGMENTS_MAX];
    memcpy(segments, tool->at, tool->count * sizeof *segments);
    segments[hit.segment].radius = hit.distance;
    segments_codes(scene, tool, segments, tool->count, &codes);
    dpt_result result = DPT_OK;
    EACH_WORLD(scene, w)
    SAME_RESULT(w, result, RESULT(dpt_tool_set_segments, scene->world[w], tool->id, segments, tool->count));
    expect(result, &codes);
    tool_has_segments(scene, tool, result == DPT_OK ? segments : NULL);
    scene_steps(scene);
}

static const struct move moves[] = {
    { "step", step, 40 }, { "ride", ride, 10 }, { "touch", touch, 4 }, { "audit", audit, 8 }, { NULL, NULL, 0 }
};

const struct noun step_noun = { "step", NULL, NULL, moves };
