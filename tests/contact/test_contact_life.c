/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The life of contact regions in a world: their numbers, the room for them, and the sides that they hold of open
 * sheets.
 */
#include "contact/depth_checks.h"

/* Numbers: two bumps, their tops 0.0202 m high and 0.06 m apart, between them 0.013 m. */

static void place_bumps(double u, double v, double x[3])
{
    x[0] = 0.2 * v - 0.1;
    x[1] = 0.2 * u - 0.1;
    x[2] = 0;
    for (int side = -1; side <= 1; side += 2) {
        const double off = x[0] - 0.03 * side;
        x[2] += 0.02 * exp(-(off * off + x[1] * x[1]) / 0.0008);
    }
}

static void over_bumps(double x, double y, double z, double ends[6])
{
    const double at[6] = { x - 0.07, y, z, x + 0.07, y, z };
    memcpy(ends, at, sizeof at);
}

/* Down from above until both are within the margin of 4 mm, slowly or at once. */
static dpt_hit lower_to_bumps(struct rig *rig, int ticks_down)
{
    dpt_hit hit = DPT_HIT_INIT;
    for (int i = 0; i < ticks_down; i++) {
        double ends[6];
        over_bumps(0.001, 0.002, 0.0225 + 0.0001 * (ticks_down - 1 - i), ends);
        hit = rig_step_ends(rig, ends, 0.003);
    }
    return hit;
}

static void a_first_tick_finds_all_regions(void)
{
    struct solid solid;
    struct rig rig;
    dpt_contact c[RIG_CONTACTS];
    if (!solid_from_net(&solid, "bumps", 60, 60, 0, place_bumps) || !depth_rig_open(&rig, solid.mesh, 0.004, 32))
        return;
    lower_to_bumps(&rig, 1);
    CHECK(rig_contacts(&rig, c) == 2, "%u regions over two bumps", rig_contacts(&rig, c));
    rig_close(&rig);
    solid_close(&solid);
}

/* One tick with the tool there; its contacts, whose ids are checked. Returns how many. */
static uint32_t tick_over_bumps(struct rig *rig, double x, double y, double z, struct id_history *ids, dpt_contact *c,
                                const char *text)
{
    double ends[6];
    over_bumps(x, y, z, ends);
    rig_step_ends(rig, ends, 0.003);
    const uint32_t count = rig_contacts(rig, c);
    check_ids(ids, ids->ticks++, c, count, text);
    return count;
}

static void numbers_live_as_long_as_regions(void)
{
    struct solid solid;
    struct rig rig;
    struct id_history ids = { .count = 0 };
    dpt_contact c[RIG_CONTACTS];
    uint32_t count = 0, first[2] = { 0, 0 }, joined = 0, split[2];
    if (!solid_from_net(&solid, "bumps", 60, 60, 0, place_bumps) || !depth_rig_open(&rig, solid.mesh, 0.004, 32))
        return;
    /* Down until both bumps are within the margin, then about. */
    for (int i = 0; i <= 100; i++) {
        count = tick_over_bumps(&rig, 0, 0, 0.0325 - 0.0001 * i, &ids, c, "down");
    }
    CHECK(count == 2, "%u regions over two bumps", count);
    for (int k = 0; k < 2; k++)
        first[k] = c[k].id;
    for (int i = 0; i < 400; i++) {
        const double turn = 2 * 3.14159265358979323846 * i / 200;
        count = tick_over_bumps(&rig, 0.005 * sin(turn), 0.004 * sin(2 * turn), 0.0225, &ids, c, "about");
        CHECK(count == 2 && c[0].id == first[0] && c[1].id == first[1], "%u regions, %u and %u, not %u and %u", count,
              c[0].id, c[1].id, first[0], first[1]);
        CHECK(count < 2 || (c[0].s1 <= c[1].s0 && c[0].s < 0.5 && c[1].s > 0.5), "order");
    }
    /* Lower: one. */
    for (int i = 0; i <= 80; i++) {
        count = tick_over_bumps(&rig, 0, 0, 0.0225 - 0.00005 * i, &ids, c, "joining");
        CHECK(count == 1 || count == 2, "%u regions", count);
        for (uint32_t k = 0; k < count; k++)
            CHECK(c[k].id == first[0] || c[k].id == first[1], "%u is new", c[k].id);
    }
    CHECK(count == 1, "%u regions where all is within the margin", count);
    joined = c[0].id;
    /* Up: two again, one of them as before. */
    for (int i = 0; i <= 80; i++) {
        count = tick_over_bumps(&rig, 0, 0, 0.0185 + 0.00005 * i, &ids, c, "splitting");
    }
    CHECK(count == 2, "%u regions after the split", count);
    for (int k = 0; k < 2; k++)
        split[k] = c[k].id;
    CHECK((split[0] == joined) != (split[1] == joined), "%u and %u, one of them from %u", split[0], split[1], joined);
    const uint32_t other = split[0] == joined ? split[1] : split[0];
    CHECK(other != first[0] && other != first[1], "%u is used again", other);
    /* Away and back: all new. */
    for (int i = -100; i <= 100; i++) {
        count = tick_over_bumps(&rig, 0, 0, 0.0225 + 0.0001 * abs(100 - abs(i)), &ids, c, "back");
        CHECK(i || count == 0, "%u regions", count);
        CHECK(abs(i) != 100 || count == 2, "%u regions", count);
    }
    rig_close(&rig);
    solid_close(&solid);
}

/* The caller's room: none, too little, structs of a newer library, and sizes that are none. */
static void room_of_the_caller(struct rig *rig)
{
    struct {
        dpt_contact contact;
        double newer[2];
    } longer[3];
    dpt_contact c[2];
    uint32_t count = 77;
    lower_to_bumps(rig, 100);
    CHECK(dpt_tool_get_contacts(rig->world, rig->tool, NULL, 0, &count) == DPT_OK && count == 2, "%u", count);
    memset(c, 0x5a, sizeof c);
    c[0].size = sizeof *c;
    CHECK(dpt_tool_get_contacts(rig->world, rig->tool, c, 1, &count) == DPT_OK && count == 2, "%u", count);
    CHECK(c[0].size == sizeof *c && c[0].segment == 0 && c[0].body == rig->body && c[1].size == 0x5a5a5a5a,
          "wrote beyond");
    c[0].size = 8;
    CHECK(dpt_tool_get_contacts(rig->world, rig->tool, c, 1, &count) == DPT_E_SIZE, "size");
    c[0].size = 0;
    CHECK(dpt_tool_get_contacts(rig->world, rig->tool, c, 2, &count) == DPT_E_SIZE, "size");
    memset(longer, 0x5a, sizeof longer);
    longer[0].contact.size = sizeof *longer;
    CHECK(dpt_tool_get_contacts(rig->world, rig->tool, &longer[0].contact, 3, &count) == DPT_OK && count == 2, "%u",
          count);
    const unsigned char *tail = (const unsigned char *)longer[1].newer;
    for (size_t i = 0; i < sizeof longer[1].newer; i++)
        CHECK(tail[i] == 0, "the tail that this library does not know is not zero");
    CHECK(longer[1].contact.size == sizeof *longer && longer[1].contact.s > 0.5, "size %u, s %g",
          longer[1].contact.size, longer[1].contact.s);
    CHECK(longer[2].contact.size == 0x5a5a5a5a, "wrote beyond");
    CHECK(dpt_tool_get_contacts(rig->world, 0, c, 0, &count) != DPT_OK, "a tool 0");
}

static void room_for_contacts(void)
{
    struct solid solid;
    struct rig rig;
    double ends[6], gap = 0;
    if (!solid_from_net(&solid, "bumps", 60, 60, 0, place_bumps))
        return;
    over_bumps(0.001, 0.002, 0.0225, ends);
    /* Slowly, as what a first tick finds is another test. */
    static const uint32_t room[4] = { 32, 2, 1, 0 };
    for (int i = 0; i < 4; i++) {
        dpt_contact c[RIG_CONTACTS];
        dpt_wrench wrench;
        if (!depth_rig_open(&rig, solid.mesh, 0.004, room[i]))
            continue;
        lower_to_bumps(&rig, 100);
        for (int k = 0; k < 3; k++) {
            const dpt_hit hit = rig_step_ends(&rig, ends, 0.003);
            const int full = (rig.step.flags & DPT_STEP_FLAG_CONTACTS_FULL) != 0;
            const uint32_t count = room[i] ? rig_contacts(&rig, c) : 0, fit = room[i] < 2 ? room[i] : 2;
            if (!i && !k)
                gap = hit.gap;
            CHECK(count == fit && rig.step.contacts == fit, "%u, %u regions in room for %u", count, rig.step.contacts,
                  room[i]);
            CHECK(full == (room[i] == 1), "flags %u, room for %u", rig.step.flags, room[i]);
            CHECK(fabs(hit.gap - gap) <= 1e-5 * solid.diagonal, "gap %.9g, not %.9g, room for %u", hit.gap, gap,
                  room[i]);
            CHECK(dpt_tool_get_wrench(rig.world, rig.tool, &wrench) == DPT_OK && wrench.force[2] > 0,
                  "no force with room for %u", room[i]);
        }
        rig_close(&rig);
    }
    if (depth_rig_open(&rig, solid.mesh, 0.004, 32)) {
        room_of_the_caller(&rig);
        rig_close(&rig);
    }
    solid_close(&solid);
}

/* Sides of an open sheet. */

static int is_zero(const dpt_wrench *w)
{
    return dot3(w->force, w->force) == 0 && dot3(w->torque, w->torque) == 0;
}

/* Slowly down to a depth beyond the limit: forgotten there, and not before. */
static void press_to_the_limit(const struct solid *solid, double up, double radius)
{
    const double limit = 0.02, step = 0.0002;
    dpt_world_def def = rig_def(DPT_LAW_POINT);
    struct rig rig;
    def.side_limit = limit;
    if (!rig_open(&rig, &def, solid->mesh, &rig_point, 1))
        return;
    for (int i = 0; i < 200; i++) {
        const double z = 0.0105 - step * i, gap = z - radius;
        const double ends[6] = { 0.0113, 0.0071, up * z, 0.0113, 0.0071, up * z };
        const dpt_hit hit = rig_step_ends(&rig, ends, radius);
        if (gap > -limit)
            CHECK((hit.flags & DPT_HIT_FLAG_GAP) && fabs(hit.gap - gap) <= 1e-9, "gap %.9g, not %.9g, from %g", hit.gap,
                  gap, up);
        else if (gap < -limit - 2 * step)
            CHECK(fabs(hit.gap - (-z - radius)) <= 1e-9, "gap %.9g behind the limit, not %.9g, from %g", hit.gap,
                  -z - radius, up);
    }
    rig_close(&rig);
}

/* Pressed through, then sideways beyond the border and at once back: forgotten there, while it touches. */
static void press_beyond_the_border(const struct solid *solid)
{
    const double radius = 0.003, z = -0.002, border = solid->info.box_max[0];
    struct rig rig;
    if (!depth_rig_open(&rig, solid->mesh, 0.001, 32))
        return;
    for (int i = 0; i < 60; i++) {
        const double height = 0.006 + (z - 0.006) * i / 59;
        const double ends[6] = { 0.08, 0.0071, height, 0.08, 0.0071, height };
        rig_step_ends(&rig, ends, radius);
    }
    for (int i = 0; i < 420; i++) {
        const double x = 0.101 - 0.0001 * abs(210 - i), beyond = fmax(0, x - border);
        const double ends[6] = { x, 0.0071, z, x, 0.0071, z };
        const dpt_hit hit = rig_step_ends(&rig, ends, radius);
        const int forgotten = i > 210 || x > border + 1e-6;
        const double gap = (forgotten ? hypot(beyond, z) : z) - radius;
        if (forgotten || x < border - 1e-6)
            CHECK(fabs(hit.gap - gap) <= 1e-9, "gap %.9g, not %.9g at x = %g, tick %d", hit.gap, gap, x, i);
    }
    rig_close(&rig);
}

static void teleport_forgets(const struct solid *solid)
{
    const double radius = 0.003;
    struct rig rig;
    dpt_hit hit;
    if (!depth_rig_open(&rig, solid->mesh, 0.001, 32))
        return;
    double ends[6] = { 0.0113, 0.0071, 0.006, 0.0113, 0.0071, 0.006 };
    for (int i = 0; i <= 50; i++) {
        ends[2] = ends[5] = 0.006 - 0.0002 * i;
        hit = rig_step_ends(&rig, ends, radius);
    }
    CHECK(fabs(hit.gap - (-0.004 - radius)) <= 1e-9, "gap %.9g", hit.gap);
    dpt_tool_teleport(rig.world, rig.tool, &rig.device);
    hit = rig_step_ends(&rig, ends, radius);
    CHECK(fabs(hit.gap - (0.004 - radius)) <= 1e-9, "gap %.9g after a teleport", hit.gap);
    rig_close(&rig);
}

/* Crossing from the first tick on there is no side; once it has been free, there is. */
static void a_first_tick_that_crosses(const struct solid *solid)
{
    const double radius = 0.002;
    struct rig rig;
    dpt_wrench wrench;
    if (!depth_rig_open(&rig, solid->mesh, 0.001, 32))
        return;
    for (int i = 0; i < 250; i++) {
        /* Standing on its end: through the sheet, out of it upwards, and in again. */
        const double z = i < 100 ? -0.005 + 0.0001 * i : 0.005 - 0.0001 * (i - 100);
        const double ends[6] = { 0.0113, 0.0071, z, 0.0123, 0.0091, z + 0.05 };
        const dpt_hit hit = rig_step_ends(&rig, ends, radius);
        dpt_tool_get_wrench(rig.world, rig.tool, &wrench);
        if (i < 49) {
            CHECK(hit.contact == DPT_CONTACT_UNKNOWN && !(hit.flags & DPT_HIT_FLAG_GAP), "tick %d: contact %u, gap %g",
                  i, hit.contact, hit.gap);
            CHECK(is_zero(&wrench), "tick %d: force %g", i, wrench.force[2]);
        }
        if (i > 51) {
            CHECK((hit.flags & DPT_HIT_FLAG_GAP) && fabs(hit.gap - (z - radius)) <= 1e-9, "tick %d: gap %.9g, not %.9g",
                  i, hit.gap, z - radius);
            CHECK(z >= radius ? is_zero(&wrench) : wrench.force[2] > 0, "tick %d: force %g at %g", i, wrench.force[2],
                  z);
        }
    }
    rig_close(&rig);
}

static void sheets_keep_their_side(void)
{
    struct solid solid;
    if (!solid_from_shape(&solid, "membrane", 800))
        return;
    for (int side = -1; side <= 1; side += 2) {
        press_to_the_limit(&solid, side, 0.003);
        press_to_the_limit(&solid, side, 0);
    }
    press_beyond_the_border(&solid);
    teleport_forgets(&solid);
    a_first_tick_that_crosses(&solid);
    solid_close(&solid);
}

int main(void)
{
    TEST(a_first_tick_finds_all_regions);
    TEST(numbers_live_as_long_as_regions);
    TEST(room_for_contacts);
    TEST(sheets_keep_their_side);
    return check_report();
}
