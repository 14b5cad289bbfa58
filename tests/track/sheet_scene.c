/* SPDX-License-Identifier: BSD-3-Clause */
#include "track/sheet_scene.h"

uint64_t sheet_random = 1;

void any_unit(double v[3])
{
    do
        for (int k = 0; k < 3; k++)
            v[k] = random_in(&sheet_random, -1.0, 1.0);
    while (length3(v) > 1.0 || length3(v) < 0.1);
    unit_or_z(v);
}

int sheet_from_grid(struct sheet *sheet, const char *name, double bend, int hole)
{
    enum { N = 16 };
    static double vertices[3 * (N + 1) * (N + 1)];
    static uint32_t corners[6 * N * N];
    size_t count = 0;
    memset(sheet, 0, sizeof *sheet);
    for (int i = 0; i <= N; i++)
        for (int k = 0; k <= N; k++) {
            double *v = vertices + 3 * (i * (N + 1) + k);
            v[0] = 0.3 * ((double)i / N - 0.5);
            v[1] = 0.3 * ((double)k / N - 0.5);
            v[2] = bend * (v[0] * v[0] + v[1] * v[1]);
        }
    for (uint32_t i = 0; i < N; i++)
        for (uint32_t k = 0; k < N; k++) {
            uint32_t a = i * (N + 1) + k, b = a + N + 1;
            const uint32_t two[6] = { a, b, b + 1, a, b + 1, a + 1 };
            if (hole && i >= N / 2 - 1 && i <= N / 2 && k >= N / 2 - 1 && k <= N / 2)
                continue;
            memcpy(corners + 3 * count, two, sizeof two);
            count += 2;
        }
    return fixture_from_arrays(&sheet->fixture, vertices, COUNT(vertices) / 3, corners, count) && sheet_of(sheet, name);
}

int scene_begin(struct scene *scene, struct sheet *sheet, uint32_t budget, const struct scene *like)
{
    static const double margins[3] = { 0.0, 0.001, 0.005 };
    *scene = (struct scene){ .sheet = sheet };
    dpt_world_def *def = &scene->def;
    *def = rig_def(DPT_LAW_POINT);
    def->margin = margins[random_bits(&sheet_random) % 3] * sheet->unit;
    def->side_limit = one_in(3) ? 0.02 * sheet->unit : 0.0;
    def->smooth_normals = (uint32_t)one_in(2);
    def->certificate_bytes = 1 << 16;
    def->fade = 0.0; /* the force is of this tick alone */
    if (like)
        *def = like->def;
    def->budget = budget;
    return rig_open(&scene->rig, def, sheet->fixture.mesh, &rig_point, 1);
}

void scene_place(struct scene *scene, const struct state *state, int teleport)
{
    dpt_segment segment = { .radius = state->radius };
    memcpy(segment.a, state->end[0], sizeof segment.a);
    memcpy(segment.b, state->end[1], sizeof segment.b);
    dpt_result result = dpt_body_set_pose(scene->rig.world, scene->rig.body, &state->body);
    CHECK(result == DPT_OK, "body: %s", dpt_result_name(result));
    if (teleport && !state->free) {
        dpt_tool_remove(scene->rig.world, scene->rig.tool);
        scene->rig.tool = rig_add_tool(&scene->rig, &segment, 1);
    }
    if (teleport)
        dpt_tool_teleport(scene->rig.world, scene->rig.tool, &state->tool);
    result = state->free ? dpt_tool_set_segments(scene->rig.world, scene->rig.tool, &segment, 1)
                         : dpt_tool_set_pose(scene->rig.world, scene->rig.tool, &state->tool);
    CHECK(result == DPT_OK, "move: %s", dpt_result_name(result));
}

static int finite3(const double v[3])
{
    return isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]);
}

/* What holds of every answer, on every mesh. */
static void check_answer(const char *name, const struct tick_answer *answer)
{
    const dpt_hit *hit = &answer->hit;
    const dpt_sweep *sweep = &answer->sweep;
    const dpt_wrench *wrench = &answer->wrench;
    CHECK(isfinite(hit->distance) && isfinite(hit->gap) && isfinite(hit->depth) && isfinite(hit->s) &&
              finite3(hit->p) && finite3(hit->q) && isfinite(hit->error_bound) && isfinite(hit->lower_bound),
          "%s: not finite", name);
    CHECK(hit->status == DPT_STATUS_EXACT || hit->status == DPT_STATUS_BOUNDED, "%s: status %u", name, hit->status);
    CHECK(hit->contact <= DPT_CONTACT_PENETRATING, "%s: contact %u", name, hit->contact);
    CHECK((hit->contact != DPT_CONTACT_UNKNOWN) == ((hit->flags & DPT_HIT_FLAG_GAP) != 0), "%s: contact %u, flags %u",
          name, hit->contact, hit->flags);
    const uint32_t why = DPT_HIT_FLAG_BUDGET | DPT_HIT_FLAG_NO_SIDE | DPT_HIT_FLAG_CROSSINGS_FULL;
    CHECK((hit->contact == DPT_CONTACT_UNKNOWN) == ((hit->flags & why) != 0), "%s: contact %u, flags %u", name,
          hit->contact, hit->flags);
    CHECK(hit->depth == fmax(0.0, -hit->gap) || hit->contact == DPT_CONTACT_UNKNOWN, "%s: depth %g of gap %g", name,
          hit->depth, hit->gap);
    CHECK(hit->contact != DPT_CONTACT_PENETRATING || hit->gap < 0.0, "%s: gap %g", name, hit->gap);
    CHECK(finite3(wrench->force) && finite3(wrench->torque), "%s: wrench", name);
    int still = hit->contact == DPT_CONTACT_UNKNOWN || hit->contact == DPT_CONTACT_SEPARATED;
    CHECK(!still || (length3(wrench->force) == 0.0 && length3(wrench->torque) == 0.0), "%s: contact %u, force %g", name,
          hit->contact, length3(wrench->force));
    CHECK(isfinite(sweep->time) && sweep->time >= 0.0 && sweep->time <= 1.0 && isfinite(sweep->s) &&
              finite3(sweep->q) && finite3(sweep->normal),
          "%s: sweep", name);
    CHECK(sweep->status <= DPT_SWEEP_UNFINISHED, "%s: sweep %u", name, sweep->status);
    CHECK(sweep->status != DPT_SWEEP_UNFINISHED || hit->contact == DPT_CONTACT_UNKNOWN, "%s: unfinished, contact %u",
          name, hit->contact);
    for (uint32_t i = 0; i < answer->contacts && i < COUNT(answer->contact); i++) {
        const dpt_contact *c = &answer->contact[i];
        double size = length3(c->normal);
        CHECK(isfinite(c->gap) && isfinite(c->overlap) && isfinite(c->moment) && finite3(c->thrust) &&
                  finite3(c->thrust_moment) && finite3(c->p) && finite3(c->q) && finite3(c->weight) && isfinite(size),
              "%s: region", name);
        CHECK(c->id && c->s0 >= 0.0 && c->s1 <= 1.0 && c->s0 <= c->s1 && c->s >= c->s0 - 1e-9 && c->s <= c->s1 + 1e-9,
              "%s: region %u from %g to %g at %g", name, c->id, c->s0, c->s1, c->s);
        CHECK(size == 0.0 || fabs(size - 1.0) < 1e-9, "%s: normal of %g", name, size);
    }
}

void scene_tick(struct scene *scene, struct tick_answer *answer)
{
    answer->sweep = (dpt_sweep){ .size = sizeof answer->sweep };
    answer->contact[0].size = sizeof answer->contact[0];
    rig_tick(&scene->rig);
    answer->step = scene->rig.step;
    answer->hit = scene->rig.hit;
    answer->wrench = scene->rig.force.wrench;
    dpt_tool_get_sweep(scene->rig.world, scene->rig.tool, 0, &answer->sweep);
    dpt_tool_get_contacts(scene->rig.world, scene->rig.tool, answer->contact, COUNT(answer->contact),
                          &answer->contacts);
    check_answer(scene->sheet->name, answer);
}

const char *motion_text(const struct state *from, const struct state *to)
{
    static char text[2][1400];
    static int at;
    const struct state *both[2] = { from, to };
    size_t n = 0;
    char *out = text[at = !at];
    for (int i = 0; i < 2; i++) {
        const struct state *s = both[i];
        n += (size_t)snprintf(out + n, 1400 - n, "%s%s radius %.17g", i ? "\n      to   " : "\n      from ",
                              s->free ? "free" : "rigid", s->radius);
        for (int e = 0; e < 2; e++)
            n += (size_t)snprintf(out + n, 1400 - n, " {%.17g,%.17g,%.17g}", s->end[e][0], s->end[e][1], s->end[e][2]);
        const dpt_pose *pose[2] = { &s->tool, &s->body };
        for (int k = 0; k < 2; k++)
            n += (size_t)snprintf(out + n, 1400 - n, " %s {%.17g,%.17g,%.17g}{%.17g,%.17g,%.17g,%.17g}",
                                  k ? "body" : "tool", pose[k]->position[0], pose[k]->position[1], pose[k]->position[2],
                                  pose[k]->orientation[0], pose[k]->orientation[1], pose[k]->orientation[2],
                                  pose[k]->orientation[3]);
    }
    return out;
}
