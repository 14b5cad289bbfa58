/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Walks near any mesh, closed bodies and soups among them: what is so whatever its defects, and on those without any,
 * that the gap changes with the motion and its sign with a crossing.
 *
 * Usage: test_gap_continuity [crossings = 100000] [seed = 1]; a walk has 1000 ticks and one for each 50 crossings.
 * DPT_DATA names the folder of public meshes; open sheets among them are crossed as in test_sheets, once for each 500.
 */
#include "track/sheet_flight.h"

static unsigned long crossing_count = 100000;

/* Any motion near a mesh: what is so on every one, whatever its defects. */
struct walk_sums {
    unsigned long ticks, hits, crossing, unknown, flips_in, flips_out;
    struct sums truth;
};

static void walk_from(const struct sheet *sheet, struct state *state, double length)
{
    double at[3], u[3], normal[3];
    any_target(sheet, at, normal);
    any_unit(u);
    add_scaled(at, at, (one_in(2) ? 1.0 : -1.0) * power_in(-5.0, -1.0) * sheet->unit, normal);
    double share = random_in(&sheet_random, 0.0, 1.0);
    for (int e = 0; e < 2; e++)
        add_scaled(state->end[e], at, (e - share) * length, u);
}

static void walk_on(const struct sheet *sheet, const double drift[3], struct state *state)
{
    double u[3], turn[3], length = apart(state->end[0], state->end[1]);
    double by = 0.02 * sheet->unit * power_in(-3.0, 0.0);
    any_unit(u);
    any_unit(turn);
    for (int e = 0; e < 2; e++) {
        add_scaled(state->end[e], state->end[e], by, u);
        add_scaled(state->end[e], state->end[e], by, drift);
        add_scaled(state->end[e], state->end[e], e && length > 0.0 ? by * random_in(&sheet_random, 0.0, 1.0) : 0.0,
                   turn);
    }
}

/*
 * `closed`: the gap is bound to the motion as the distance is, and its sign to a crossing; elsewhere what changes its
 * sign without one is counted. Sheets that are not crossed never go from in front to behind.
 */
static void walk_tick(struct scene *scene, const struct state *was, const struct tick_answer *before,
                      const struct state *now, const struct tick_answer *answer, int closed, struct walk_sums *sums)
{
    const struct sheet *sheet = scene->sheet;
    double size = sheet->diagonal + length3(now->end[0]);
    double motion = fmax(apart(was->end[0], now->end[0]), apart(was->end[1], now->end[1]));
    double small = before->hit.error_bound + answer->hit.error_bound + 1e-14 * size;
    double by = fabs(answer->hit.distance - before->hit.distance) - motion;
    CHECK(by <= small, "%s: the distance changes by %g more than the motion%s", sheet->name, by, motion_text(was, now));
    if (before->hit.contact == DPT_CONTACT_UNKNOWN || answer->hit.contact == DPT_CONTACT_UNKNOWN)
        return;
    double tolerance = 2e-5 * sheet->diagonal;
    by = fabs(answer->hit.gap - before->hit.gap) - motion;
    if (closed) {
        CHECK(by <= tolerance, "%s: the gap changes by %g more than the motion%s", sheet->name, by,
              motion_text(was, now));
    }
    /* Of the axis, wholly on one side at both ticks, and not through anything in between. */
    if (before->hit.distance <= small || answer->hit.distance <= small || answer->sweep.status != DPT_SWEEP_FREE)
        return;
    int in_before = before->hit.gap + was->radius < 0.0, in_now = answer->hit.gap + now->radius < 0.0;
    sums->flips_in += !in_before && in_now;
    sums->flips_out += in_before && !in_now;
    CHECK(!closed || in_before == in_now, "%s: gap from %g to %g, not crossed%s", sheet->name, before->hit.gap,
          answer->hit.gap, motion_text(was, now));
}

static void walk(struct sheet *sheet, unsigned long ticks, unsigned long judged, int closed)
{
    struct walk_sums sums = { .truth.worst_off = -HUGE_VAL };
    struct scene scene = { NULL };
    struct tick_answer answer, before = { .contacts = 0 };
    while (sums.ticks < ticks) {
        if (sums.ticks % 1000 < 20) {
            rig_close(&scene.rig);
            if (!scene_begin(&scene, sheet, 0, NULL))
                return;
        }
        struct state state = { .free = 1, .tool = DPT_POSE_IDENTITY, .body = DPT_POSE_IDENTITY };
        struct state was;
        double drift[3];
        any_unit(drift);
        state.radius = one_in(2) ? 0.0 : power_in(-4.0, -1.5) * sheet->unit;
        walk_from(sheet, &state, one_in(6) ? 0.0 : power_in(-3.0, -0.30103) * sheet->unit);
        struct ride ride = { .scene = &scene, .sums = &sums.truth };
        for (int i = 0; i < 20; i++, was = state, before = answer) {
            if (i)
                walk_on(sheet, drift, &state);
            scene_place(&scene, &state, i == 0);
            scene_tick(&scene, &answer);
            sums.ticks++;
            sums.hits += answer.sweep.status == DPT_SWEEP_HIT;
            sums.crossing += answer.hit.distance == 0.0;
            sums.unknown += answer.hit.contact == DPT_CONTACT_UNKNOWN;
            if (!i)
                continue;
            walk_tick(&scene, &was, &before, &state, &answer, closed, &sums);
            if (sums.truth.swept >= judged || before.hit.distance <= before.hit.error_bound)
                continue;
            ride.previous = was;
            ride.started = 1;
            ride.previous_distance = before.hit.distance;
            ride.previous_error = before.hit.error_bound;
            check_sweep(&ride, &state, &answer.sweep, -1.0);
        }
    }
    const dpt_mesh_info *info = &sheet->info;
    int sided = info->open_edges && !info->solid_components && !info->nonmanifold_edges && !info->wrong_way_edges &&
                info->components == 1;
    CHECK(!sided || sums.flips_in == 0, "%s: behind, not crossed, %lu times", sheet->name, sums.flips_in);
    rig_close(&scene.rig);
    printf("    %-30s %6u triangles, %6lu ticks: %lu hits, %lu crossing, %lu unknown; sign of the gap changed "
           "%lu in, %lu out; judged %lu, met %lu, undecided %lu\n",
           sheet->name, sheet->count, sums.ticks, sums.hits, sums.crossing, sums.unknown, sums.flips_in, sums.flips_out,
           sums.truth.swept, sums.truth.met, sums.truth.undecided);
}

static unsigned long walk_ticks(void)
{
    return 1000 + crossing_count / 50;
}

static void generated_bodies_are_continuous(void)
{
    static const struct {
        const char *name;
        uint32_t count;
        int closed;
    } c[] = { { "liver", 5000, 1 }, { "stomach", 2000, 1 }, { "spleen", 1000, 1 }, { "star", 2400, 1 },
              { "sphere", 320, 1 }, { "box", 48, 1 },       { "torus", 1000, 1 },  { "stomach", 2001, 0 },
              { "hub", 300, 0 },    { "cloth", 800, 0 } };
    for (size_t i = 0; i < COUNT(c); i++) {
        struct sheet sheet;
        if (sheet_from_shape(&sheet, c[i].name, c[i].count, 0.0))
            walk(&sheet, walk_ticks(), 200, c[i].closed);
        sheet_free(&sheet);
    }
}

/* Triangles of all sizes, through each other. */
static void soups_are_answered(void)
{
    enum { TRIANGLES = 300 };
    static double vertices[9 * TRIANGLES];
    static uint32_t corners[3 * TRIANGLES];
    for (int kind = 0; kind < 3; kind++) {
        struct sheet sheet;
        memset(&sheet, 0, sizeof sheet);
        for (uint32_t i = 0; i < TRIANGLES; i++) {
            double at[3], size = kind == 1 ? power_in(-6.0, -0.5) : 0.1;
            any_unit(at);
            for (uint32_t k = 0; k < 3; k++) {
                double off[3];
                any_unit(off);
                add_scaled(vertices + 9 * i + 3 * k, at, size, off);
                corners[3 * i + k] = 3 * i + k;
            }
            if (kind == 2 && i) /* fans with edges of many triangles */
                memcpy(vertices + 9 * i, vertices + 9 * (i - i % 10), 6 * sizeof *vertices);
        }
        if (fixture_from_arrays(&sheet.fixture, vertices, 3 * TRIANGLES, corners, TRIANGLES) &&
            sheet_of(&sheet, kind == 2 ? "fans"
                             : kind    ? "soup of all sizes"
                                       : "soup"))
            walk(&sheet, walk_ticks(), 1000, 0);
        sheet_free(&sheet);
    }
}

/* The public meshes of the table; `sheets` of them are crossed too. */
static void public_meshes_are_answered(void)
{
    char line[1000], path[1400], name[300];
    FILE *table = fopen("tests/data/data-meshes.txt", "r");
    CHECK(table != NULL, "no table");
    unsigned long meshes = 0;
    while (table && fgets(line, sizeof line, table)) {
        struct sheet sheet;
        if (line[0] == '#' || sscanf(line, "%299s", name) != 1)
            continue;
        snprintf(path, sizeof path, "%s/%s", getenv("DPT_DATA"), name);
        const char *hard = strstr(name, "hard/");
        if (sheet_from_file(&sheet, path, name)) {
            const dpt_mesh_info *info = &sheet.info;
            meshes++;
            walk(&sheet, hard ? 2 * walk_ticks() / 3 : walk_ticks() / 3, 100, 0);
            if (info->open_edges && !info->solid_components && !info->nonmanifold_edges && !info->wrong_way_edges &&
                info->triangles < 5000 && info->components < 3 && !hard)
                fly_through(&sheet, crossing_count / 500);
        }
        sheet_free(&sheet);
    }
    if (table)
        fclose(table);
    printf("    %lu meshes\n", meshes);
    CHECK(meshes > 0, "none in %s", getenv("DPT_DATA"));
}

int main(int argc, char **argv)
{
    take_count(argc, argv, &crossing_count, &sheet_random);
    TEST(generated_bodies_are_continuous);
    TEST(soups_are_answered);
    if (getenv("DPT_DATA"))
        TEST(public_meshes_are_answered);
    else
        SKIP("the public meshes", "DPT_DATA does not name the data folder");
    return check_report();
}
