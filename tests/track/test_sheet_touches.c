/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Touches, corners, borders and holes of open sheets: what comes to a vertex or an edge, or past the border, and stays
 * in front, is not deep; what goes through a corner is.
 *
 * Usage: test_sheet_touches [crossings = 100000] [seed = 1]; of a hole there is a way for each hundred of them.
 */
#include "track/sheet_ride.h"

static unsigned long crossing_count = 100000;

/* An axis alone, from a first tick on. */
static uint32_t first_contact(struct sheet *sheet, const struct state *state)
{
    struct scene scene;
    struct tick_answer answer = { .hit.contact = UINT32_MAX };
    if (scene_begin(&scene, sheet, 0, NULL)) {
        scene_place(&scene, state, 1);
        scene_tick(&scene, &answer);
        CHECK(answer.hit.contact == DPT_CONTACT_UNKNOWN || fabs(answer.hit.gap) <= answer.hit.error_bound, "%s: gap %g",
              sheet->name, answer.hit.gap);
    }
    rig_close(&scene.rig);
    return answer.hit.contact;
}

/* An axis that comes to a vertex or an edge, and stays on its side of the sheet, is known from the first tick on. */
static void a_touch_does_not_go_through(void)
{
    /* A tent of four walls, its ridge from the apex at 0 to 0.02 m along y. */
    static const double tent[18] = { 0,    0,    0,     0,     0.02, 0,     0.03,  -0.03, -0.02,
                                     0.03, 0.05, -0.02, -0.03, 0.05, -0.02, -0.03, -0.03, -0.02 };
    static const uint32_t walls[18] = { 0, 2, 3, 0, 3, 1, 1, 3, 4, 1, 4, 5, 1, 5, 0, 0, 5, 2 };
    static const struct {
        double end[2][3];
        int touches;
    } c[] = {
        { { { -0.01, 0, 0 }, { 0.01, 0, 0 } }, 1 },          { { { -0.01, 0.01, 0 }, { 0.01, 0.01, 0 } }, 1 },
        { { { -0.01, -0.001, 0 }, { 0.01, 0.001, 0 } }, 1 }, { { { 0, 0, -0.01 }, { 0, 0, 0.01 } }, 0 },
        { { { -0.01, 0, 0.01 }, { 0.01, 0, -0.01 } }, 0 },   { { { -0.01, 0.01, 0.01 }, { 0.01, 0.01, -0.01 } }, 0 }
    };
    /* It comes as near to a vertex as rounding, from behind. */
    static const struct state cloth_touch = {
        .end = { { 0.04384709555593512, 0.0096923861485569748, -0.13278427512575422 },
                 { 0.049037606084691279, -0.019501429469810615, -0.13398297305075171 } },
        .tool = { { 0.09342690058767833, -0.01147897853946369, 0.12916807205450256 },
                  { 0.99933759947247791, -0.0044584696808080719, 0.019177805994699263, 0.030605491107319756 } },
        .body = DPT_POSE_IDENTITY
    };
    struct sheet sheet;
    memset(&sheet, 0, sizeof sheet);
    if (fixture_from_arrays(&sheet.fixture, tent, 6, walls, 6) && sheet_of(&sheet, "tent"))
        for (size_t i = 0; i < COUNT(c); i++) {
            struct state state = { .free = 1, .tool = DPT_POSE_IDENTITY, .body = DPT_POSE_IDENTITY };
            memcpy(state.end, c[i].end, sizeof state.end);
            uint32_t contact = first_contact(&sheet, &state);
            CHECK(contact == (c[i].touches ? DPT_CONTACT_TOUCHING : DPT_CONTACT_UNKNOWN), "tent: contact %u%s", contact,
                  motion_text(&state, &state));
        }
    sheet_free(&sheet);
    if (sheet_from_shape(&sheet, "cloth", 800, 0.0))
        CHECK(first_contact(&sheet, &cloth_touch) == DPT_CONTACT_TOUCHING, "cloth: not a touch");
    sheet_free(&sheet);
}

/*
 * Through a bowl, back in front of it, and then round its border without meeting anything: what is behind then is not
 * deep. A tick each, of a body that turns by half a radian.
 */
static void round_the_border_is_in_front(void)
{
    static const struct state way[3] = {
        { .free = 1,
          .end = { { 0.13080753548749791, 0.28318087946392223, -0.52958259624064252 },
                   { 0.065984316638362919, 0.42866825625259553, -0.32020446871249603 } },
          .tool = DPT_POSE_IDENTITY,
          .body = { { 0.025456113910777435, 0.27664843194865074, -0.3181290908967811 },
                    { 0.40320882652670709, -0.49801638120538311, -0.7509378120029836, 0.15967068850049404 } } },
        { .free = 1,
          .end = { { 0.13168499489278465, 0.28164539791522764, -0.53252254398530274 },
                   { 0.066822172068389807, 0.42709252117053831, -0.32313072799521098 } },
          .tool = DPT_POSE_IDENTITY,
          .body = { { 0.016889857235161641, 0.2530918785994597, -0.34728792999160685 },
                    { 0.51678298505520215, -0.44970095414917943, -0.7284823019813218, -0.0042348429423418217 } } },
        { .free = 1,
          .end = { { 0.1325624542980714, 0.2801099163665331, -0.53546249172996307 },
                   { 0.067660027498416708, 0.42551678608848104, -0.32605698727792587 } },
          .tool = DPT_POSE_IDENTITY,
          .body = { { 0.0083236005595458493, 0.2295353252502686, -0.3764467690864326 },
                    { 0.60834077080969928, -0.38222703285131016, -0.67499144756269303, -0.16795995845904579 } } }
    };
    static const int order[4] = { 1, 0, 1, 2 };
    struct sheet sheet;
    struct scene scene;
    struct sums sums = { .worst_off = -HUGE_VAL };
    if (sheet_from_grid(&sheet, "bowl", 1.0, 0) && scene_begin(&scene, &sheet, 0, NULL)) {
        struct scene like = scene;
        like.def.margin = 0.0014;
        like.def.side_limit = 0.0;
        rig_close(&scene.rig);
        if (scene_begin(&scene, &sheet, 0, &like)) {
            struct ride ride = { .scene = &scene, .sums = &sums };
            for (int i = 0; i < 4; i++)
                ride_tick(&ride, &way[order[i]], i == 0, -1.0);
            CHECK(sums.sided == 2 && sums.clean == 2 && ride.knowledge == UNCROSSED,
                  "through in %lu ticks, free in %lu, then %d", sums.sided, sums.clean, ride.knowledge);
        }
        rig_close(&scene.rig);
    }
    sheet_free(&sheet);
}

/*
 * Through a corner of a bowl within one tick, its ends passing beside: then what is behind lies between points that are
 * not.
 */
static void through_a_corner_is_behind(void)
{
    static const double from[2][3] = { { -0.026655499654475, -0.20307381662083, 0.0011775914167 },
                                       { -0.21666300190435, -0.07832561418408, 0.0121932122627 } };
    static const double pace[3] = { 0.00486645292, 0.00585813891, 0.02103877755 };
    struct sheet sheet;
    struct scene scene = { NULL };
    struct sums sums = { .worst_off = -HUGE_VAL };
    if (sheet_from_grid(&sheet, "bowl", 1.0, 0) && scene_begin(&scene, &sheet, 0, NULL)) {
        struct scene like = scene;
        like.def.margin = 0.001;
        like.def.side_limit = 0.0;
        rig_close(&scene.rig);
        if (scene_begin(&scene, &sheet, 0, &like)) {
            struct ride ride = { .scene = &scene, .sums = &sums };
            for (int i = 0; i < 5; i++) {
                struct state now = {
                    .free = 1, .radius = 0.0003, .tool = DPT_POSE_IDENTITY, .body = DPT_POSE_IDENTITY
                };
                for (int e = 0; e < 2; e++)
                    add_scaled(now.end[e], from[e], i, pace);
                ride_tick(&ride, &now, i == 0, -1.0);
            }
            CHECK(sums.behind == 2, "behind in %lu ticks", sums.behind);
        }
        rig_close(&scene.rig);
    }
    sheet_free(&sheet);
}

/*
 * From above the sheet to below it through a corner of the hole, in one tick and back, at times with the surface at its
 * border: nothing is crossed, and so nothing is deep.
 */
static void a_way_through_a_hole_is_free(void)
{
    struct sheet sheet;
    struct sums sums = { .worst_off = -HUGE_VAL };
    struct scene scene = { NULL };
    if (!sheet_from_grid(&sheet, "hole", 0.0, 1))
        return;
    for (unsigned long i = 0; i < crossing_count / 100; i++) {
        if (i % 100 == 0) {
            rig_close(&scene.rig);
            if (!scene_begin(&scene, &sheet, 0, NULL))
                return;
        }
        struct ride ride = { .scene = &scene, .sums = &sums };
        struct state state[2];
        double over = power_in(-4.0, -2.7), height = power_in(-4.0, -2.3), w = 0.3 / 16.0;
        double beside = over * random_in(&sheet_random, 1.2, 4.0), u[3];
        double length = one_in(2) ? 0.0 : 0.3 * over, radius = one_in(2) ? 0.0 : power_in(-4.0, -2.5);
        any_unit(u);
        for (int k = 0; k < 2; k++) {
            const double at[3] = { -w + (k ? beside : -over), -w + (k ? -over : beside), k ? -height : height };
            state[k] =
                (struct state){ .free = 1, .radius = radius, .tool = DPT_POSE_IDENTITY, .body = DPT_POSE_IDENTITY };
            memcpy(state[k].end[0], at, sizeof at);
            add_scaled(state[k].end[1], at, fmin(length, 0.5 * height), u);
        }
        for (int k = 0; k < 4; k++)
            ride_tick(&ride, &state[k % 2], k == 0, -1.0);
    }
    rig_close(&scene.rig);
    printf("    %lu ticks, did not cross %lu, met %lu, clear %lu, undecided %lu, not judged %lu\n", sums.ticks,
           sums.clean, sums.met, sums.clear, sums.undecided, sums.doubtful);
    sheet_free(&sheet);
}

int main(int argc, char **argv)
{
    take_count(argc, argv, &crossing_count, &sheet_random);
    TEST(a_touch_does_not_go_through);
    TEST(round_the_border_is_in_front);
    TEST(through_a_corner_is_behind);
    TEST(a_way_through_a_hole_is_free);
    return check_report();
}
