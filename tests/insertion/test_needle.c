/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The forces on a needle against their closed forms (docs/algorithms/insertion.md): the three terms of Okamura, Simone
 * and O'Leary (2004), the toughness from two insertions at one place (Azar and Hayward 2008), the loop of friction,
 * rest, layers, and what an observer of energy sees.
 */
#include "insertion/needle_rig.h"

#include "dynpoint/passivity.h"

#define STIFFNESS RIG_STIFFNESS

/* m: walls are felt that much before they are touched, 2e-6 of the box's diagonal. */
#define CLEARANCE 4e-7

/* A line through points, by least squares. */
struct line_fit {
    double count, x, y, xx, xy;
};

static void fit_add(struct line_fit *fit, double x, double y)
{
    fit->count += 1;
    fit->x += x;
    fit->y += y;
    fit->xx += x * x;
    fit->xy += x * y;
}

static double fit_slope(const struct line_fit *fit)
{
    return (fit->count * fit->xy - fit->x * fit->y) / (fit->count * fit->xx - fit->x * fit->x);
}

static double fit_at_zero(const struct line_fit *fit)
{
    return (fit->y - fit_slope(fit) * fit->x) / fit->count;
}

static void check_near(double is, double wanted, double share, const char *what)
{
    CHECK(fabs(is - wanted) <= share * fabs(wanted), "%s is %.6g, not %.6g", what, is, wanted);
}

/* What is stiff, what rubs and what cuts, from the forces of one insertion alone. */
static void three_terms(double surface, double lean)
{
    struct needle_rig needle;
    dpt_body_settings gel = needle_gel();
    gel.stiffness = surface;
    gel.static_friction = gel.kinetic_friction = lean > 0 ? 1.0 : 0.0;
    needle_open(&needle, &gel, 1);
    needle.lean[0] = lean;
    needle_step(&needle);
    rig_place(&needle.rig);
    const double stiffness = surface > 0 ? STIFFNESS * surface / (STIFFNESS + surface) : STIFFNESS;
    struct line_fit pressed = { .count = 0 }, inside = { .count = 0 };
    double most = 0;
    int ruptures = 0, was_flagged = 0;
    for (int i = 0; i < 60000; i++) {
        needle.depth = -0.002 + 1e-6 * i;
        needle_step(&needle);
        const double force = needle_force(&needle);
        const uint32_t flags = needle.rig.force.flags;
        if (!(flags & DPT_FORCE_FLAG_INSERTED)) {
            if (force > 0.1)
                fit_add(&pressed, needle.depth, force);
            most = fmax(most, force);
        } else if (!(flags & DPT_FORCE_FLAG_RUPTURE) && needle.depth > 0.02) {
            fit_add(&inside, needle_channel(&needle).depth, force);
        }
        ruptures += (flags & DPT_FORCE_FLAG_RUPTURE) && !was_flagged;
        was_flagged = (flags & DPT_FORCE_FLAG_RUPTURE) != 0;
    }
    if (!(lean > 0))
        check_near(fit_slope(&pressed), stiffness, 0.01, "the stiffness before puncture");
    check_near(most, gel.puncture_force, 0.02, "the force at puncture");
    check_near(fit_slope(&inside), gel.shaft_friction, 0.02, "the friction of the shaft");
    check_near(fit_at_zero(&inside), gel.cutting_force, 0.02, "the cutting force");
    CHECK(ruptures == 1, "%d ruptures", ruptures);
    needle_close(&needle);
}

static void the_three_terms_are_recovered(void)
{
    three_terms(0, 0);
    three_terms(800, 0);
    three_terms(0, 0.3);
    three_terms(800, 0.3);
}

/* The toughness is the difference of two insertions' forces at one depth, over the width of the cut. */
static void toughness_is_that_of_two_insertions(void)
{
    struct needle_rig needle;
    const dpt_body_settings gel = { .size = sizeof gel, .toughness = 1500, .shaft_friction = 30 };
    needle_open(&needle, &gel, 1);
    double first[400], second[400], peak = 0, sum = 0;
    const double area = acos(-1.0) * NEEDLE_RADIUS * NEEDLE_RADIUS;
    for (int again = 0; again < 2; again++) {
        needle.depth = -0.003;
        needle_step(&needle);
        for (int i = 0; i < 400; i++) {
            for (int k = 0; k < 50; k++) {
                needle_go(&needle, -0.003 + 1e-4 * (i - 1) + 2e-6 * (k + 1), 0.002);
                if (!again && !(needle.rig.force.flags & DPT_FORCE_FLAG_INSERTED))
                    peak = fmax(peak, needle.rig.force.energy);
            }
            (again ? second : first)[i] = needle_force(&needle);
        }
        needle_go(&needle, -0.003, 0.02);
    }
    check_near(peak, gel.toughness * area, 0.02, "the energy at puncture");
    const double ends = 2 * NEEDLE_RADIUS;
    /* At one depth of the tip: the first needle's device is farther by what cutting takes. */
    const double behind = gel.toughness * ends / STIFFNESS;
    for (int i = 200; i < 380; i++) {
        const double shift = behind / 1e-4;
        const int low = (int)floor(i - shift);
        const double share = i - shift - low;
        sum += first[i] - ((1 - share) * second[low] + share * second[low + 1]);
    }
    check_near(sum / 180 / ends, gel.toughness, 0.02, "the toughness");
    CHECK(needle_channel(&needle).ruptures == 1, "%u ruptures", needle_channel(&needle).ruptures);
    needle_close(&needle);
}

/* To and fro through the whole box: what is inside stays the same. */
static void loop_of_friction(double bristles)
{
    struct needle_rig needle;
    dpt_body_settings gel = needle_gel();
    gel.shaft_stiffness = bristles;
    needle_open(&needle, &gel, 1);
    needle_go(&needle, 0.096, 0.02);
    const double middle = 0.09, range = 0.0145;
    const double limit = gel.shaft_friction * 0.08;
    const double shaft = bristles > 0 ? bristles * 0.08 : limit / 1e-5;
    const double spring = STIFFNESS * shaft / (STIFFNESS + shaft);
    double area = 0, last = 0;
    for (int round = 0; round < 3; round++)
        for (int i = 0; i < 8000; i++) {
            const double from = needle.depth;
            needle.depth = middle - range * cos(2 * acos(-1.0) * i / 8000);
            needle_step(&needle);
            area += round == 2 ? 0.5 * (last + needle_force(&needle)) * (needle.depth - from) : 0;
            last = needle_force(&needle);
        }
    check_near(area, 4 * limit * (range - limit / spring), 0.01, "the loop's area");
    CHECK(needle_channel(&needle).ruptures == 2, "%u ruptures", needle_channel(&needle).ruptures);
    needle_close(&needle);
}

/* At 0.9 of the friction's limit, with tremor. */
static void nothing_creeps(void)
{
    struct needle_rig needle;
    dpt_body_settings gel = needle_gel();
    gel.shaft_stiffness = 2e4;
    gel.shaft_viscosity = 10;
    needle_open(&needle, &gel, 1);
    needle_go(&needle, 0.05, 0.02);
    const double inside = needle_channel(&needle).inside, limit = gel.shaft_friction * inside;
    needle_go(&needle, needle.depth - (needle_force(&needle) - 0.9 * limit) / STIFFNESS, 0.02);
    const double rest = needle.depth;
    double low = 1, high = -1, first = 0, last = 0;
    for (int i = 0; i < 100000; i++) {
        needle.depth = rest + 0.00003 * sin(0.05 * i);
        needle_step(&needle);
        const double tip = needle_tip(&needle);
        if (i >= 628) {
            low = fmin(low, tip);
            high = fmax(high, tip);
        }
        first += i >= 628 && i < 628 + 1257 ? tip / 1257 : 0;
        last += i >= 100000 - 1257 ? tip / 1257 : 0;
    }
    CHECK(fabs(last - first) < 1e-7, "the tip has gone %g m", last - first);
    CHECK(high - low < 0.00004, "it goes to and fro by %g m", high - low);
    needle_close(&needle);
}

/*
 * Bodies behind each other: the walls rupture in their order, each at its force, and each body has its share of the
 * load.
 */
static void layers_come_in_order(void)
{
    struct needle_rig needle;
    dpt_body_settings skin = needle_gel(), organ = needle_gel();
    dpt_pose below = DPT_POSE_IDENTITY;
    skin.puncture_force = 0.8;
    skin.cutting_force = 0.1;
    skin.shaft_friction = 20;
    organ.puncture_force = 2.5;
    organ.cutting_force = 0.7;
    needle_open(&needle, &skin, 4);
    struct solid thin;
    double corners[24];
    uint32_t faces[36];
    for (int i = 0; i < 8; i++)
        for (int k = 0; k < 3; k++)
            corners[3 * i + k] = (i >> k & 1 ? 1 : -1) * (k == 2 ? 0.004 : 0.05);
    static const uint32_t box[36] = { 0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                      2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5 };
    memcpy(faces, box, sizeof faces);
    CHECK(solid_from_arrays(&thin, "skin", corners, 8, faces, 12), "skin");
    /* The skin is 8 mm thick, 12 mm above the box: its top is where the needle expects that of the box. */
    below.position[2] = -0.08;
    dpt_body_set_pose(needle.rig.world, needle.rig.body, &below);
    rig_set_body(&needle.rig, organ);
    dpt_pose above = DPT_POSE_IDENTITY;
    above.position[2] = NEEDLE_TOP - 0.004;
    const dpt_body first = rig_add_body(&needle.rig, thin.mesh, &above), second = needle.rig.body;
    needle.rig.body = first;
    rig_set_body(&needle.rig, skin);
    rig_place(&needle.rig);
    static const double walls[3] = { 0, 0.008, 0.08 };
    const double most[3] = { 0.8, 0.8 + 20 * 0.008, 2.5 + 20 * 0.008 };
    int seen = 0, was_flagged = 0;
    double last_force = 0;
    dpt_wrench on_skin, on_organ;
    for (int i = 0; i < 49500; i++) {
        needle.depth = -0.005 + 2e-6 * i;
        needle_step(&needle);
        const int is_flagged = (needle.rig.force.flags & DPT_FORCE_FLAG_RUPTURE) != 0;
        if (is_flagged && !was_flagged && seen < 3) {
            CHECK(fabs(needle_tip(&needle) + NEEDLE_RADIUS - walls[seen]) < 1e-4, "wall %d at %g", seen,
                  needle_tip(&needle));
            check_near(last_force, most[seen], 0.02, "the force at a wall");
        }
        seen += is_flagged && !was_flagged;
        was_flagged = is_flagged;
        last_force = needle_force(&needle);
    }
    CHECK(seen == 3, "%d ruptures", seen);
    dpt_channel channels[4];
    CHECK(needle_channels(&needle, channels, 4) == 2, "two channels");
    CHECK(channels[0].body == first && channels[1].body == second && channels[0].ruptures == 2, "bodies");
    dpt_body_get_wrench(needle.rig.world, first, &on_skin);
    dpt_body_get_wrench(needle.rig.world, second, &on_organ);
    check_near(-on_skin.force[2], 20 * 0.008, 0.02, "the load on the skin");
    check_near(-on_organ.force[2], 0.7 + 40 * channels[1].inside, 0.02, "the load on the organ");
    CHECK(fabs(on_skin.force[2] + on_organ.force[2] + needle.rig.force.wrench.force[2]) < 1e-12, "loads sum up");
    needle_close(&needle);
    solid_close(&thin);
}

/*
 * No tick changes the force by more than the law's bound, and where it drops faster than the hand moves that is a
 * rupture. In no tick is more energy stored than the hand has given, so a rupture takes what was held.
 */
static void jumps_are_ruptures(void)
{
    for (int kind = 0; kind < 4; kind++) {
        struct needle_rig needle;
        dpt_body_settings gel = needle_gel();
        struct needle_wander wander = { .seed = 7 + (uint64_t)kind };
        double last = 0, stored = 0;
        int was_flagged = 0, flagged = 0;
        gel.puncture_force = 3;
        gel.stiffness = kind & 1 ? 900 : 0;
        gel.shaft_stiffness = kind & 1 ? 0 : 8e3;
        needle_open(&needle, &gel, 1);
        needle.rig.dt = kind & 2 ? 1e-4 : 1e-3;
        wander.depth = needle.depth;
        for (int i = 0; i < 60000; i++) {
            const double before = needle.depth;
            needle_wander(&needle, &wander);
            const double moved = fabs(needle.depth - before), force = needle_force(&needle);
            const int is_flagged = (needle.rig.force.flags & DPT_FORCE_FLAG_RUPTURE) != 0;
            CHECK(fabs(force - last) <= STIFFNESS * (3 * moved + needle.rig.dt) * 1.001 + 1e-9, "tick %d: %g N", i,
                  force - last);
            if (!is_flagged && !was_flagged)
                CHECK(fabs(force - last) <= STIFFNESS * 1.01 * moved + 2e-3, "tick %d: %g N without a flag", i,
                      force - last);
            flagged += is_flagged && !was_flagged;
            const double gained = needle.rig.force.energy - stored - 0.5 * (force + last) * (needle.depth - before);
            CHECK(gained <= 1e-9 + CLEARANCE * fabs(force), "tick %d: %g J gained", i, gained);
            was_flagged = is_flagged;
            last = force;
            stored = needle.rig.force.energy;
        }
        CHECK(flagged >= 1, "no rupture");
        needle_close(&needle);
    }
}

/* J: of bristles, which give by 10 um, and of the tick in which a wall opens. */
#define BRISTLES 4e-5

/*
 * What each rupture sets free, from the tick before its first flag to the first without one: what was stored and given,
 * less what is stored and what friction and cutting took. It is at most what the membrane held, F^2 / 2k.
 */
static double resistance(const struct needle_rig *needle)
{
    dpt_channel channels[16];
    double sum = 0;
    const uint32_t count = needle_channels(needle, channels, 16);
    for (uint32_t i = 0; i < count; i++)
        sum += channels[i].flags & DPT_CHANNEL_FLAG_OCCUPIED ? channels[i].friction + channels[i].tip : 0.0;
    return sum;
}

static void a_rupture_takes_what_was_held(void)
{
    for (int kind = 0; kind < 4; kind++) {
        struct needle_rig needle;
        dpt_body_settings gel = needle_gel();
        uint64_t seed = 5 + (uint64_t)kind;
        double last = 0, stored = 0, held = 0, given = 0, resisted = 0, tip = 0;
        int was_flagged = 0, ruptures = 0;
        gel.puncture_force = kind & 1 ? 1.2 : 3.0;
        gel.stiffness = kind & 2 ? 900 : 0;
        needle_open(&needle, &gel, 16);
        for (int i = 0; i < 16000; i++) {
            const double before = needle.depth, was = stored;
            /* Through the box and out, each time elsewhere. */
            const double phase = i % 4000 / 4000.0;
            if (i % 4000 == 0)
                needle.at[0] = -0.01 + 0.006 * (i / 4000);
            needle.depth = 0.05 - 0.06 * cos(6.283185307179586 * phase) + random_in(&seed, -2e-6, 2e-6);
            needle_step(&needle);
            const double force = needle_force(&needle);
            const int is_flagged = (needle.rig.force.flags & DPT_FORCE_FLAG_RUPTURE) != 0;
            const double resists = resistance(&needle), now = needle_tip(&needle);
            stored = needle.rig.force.energy;
            if (is_flagged && !was_flagged) {
                held = was;
                given = 0;
            }
            if (is_flagged || was_flagged)
                given += 0.5 * (force + last) * (needle.depth - before) - 0.5 * (resists + resisted) * (now - tip);
            if (was_flagged && !is_flagged) {
                const double freed = held + given - stored;
                CHECK(freed >= -BRISTLES && freed <= held + BRISTLES, "kind %d, tick %d: %g J set free of %g held",
                      kind, i, freed, held);
                ruptures += freed > 1e-4;
            }
            was_flagged = is_flagged;
            last = force;
            resisted = resists;
            tip = now;
        }
        CHECK(ruptures >= 4, "%d ruptures", ruptures);
        needle_close(&needle);
    }
}

/* To and fro near the surface, where little is inside and nothing is cut: bristles hold no more than they got. */
static void shallow_bristles_hold_what_they_got(void)
{
    struct needle_rig needle;
    dpt_body_settings gel = needle_gel();
    gel.puncture_force = 0.1;
    gel.cutting_force = 0;
    gel.shaft_stiffness = 4e3;
    needle_open(&needle, &gel, 1);
    double stored = 0, last = 0, most = 0;
    for (int i = 0; i < 8000; i++) {
        const double before = needle.depth;
        needle.depth = 0.006 - 0.011 * cos(0.004 * i);
        needle_step(&needle);
        const double force = needle_force(&needle);
        const double gained = needle.rig.force.energy - stored - 0.5 * (force + last) * (needle.depth - before);
        CHECK(gained <= 1e-9 + CLEARANCE * fabs(force), "tick %d: %g J gained", i, gained);
        stored = needle.rig.force.energy;
        last = force;
        most = fmax(most, force);
    }
    CHECK(most > 0.2, "it was hardly in: %g N", most);
    needle_close(&needle);
}

/* A hand with noise, delay and quanta: the observer only looks on. */
static void nothing_gives_energy(void)
{
    for (int kind = 0; kind < 8; kind++) {
        struct needle_rig needle;
        dpt_passivity observer = { .size = sizeof observer };
        dpt_passivity_def def;
        dpt_passivity_info info = { .size = sizeof info };
        dpt_body_settings gel = needle_gel();
        dpt_wrench held[3] = { { { 0 }, { 0 } } };
        uint64_t seed = 11 + (uint64_t)kind;
        double at = -0.004, speed = 0, aim = 0.03;
        const int delay = kind & 2 ? 1 : 0;
        const double quantum = kind & 4 ? 2e-5 : 0, mass = 0.1, damping = 3;
        gel.shaft_stiffness = kind & 1 ? 3e4 : 0;
        needle_open(&needle, &gel, 1);
        needle.rig.dt = kind & 1 ? 1e-4 : 1e-3;
        dpt_passivity_def_init(&def);
        def.observe_only = 1;
        def.damping = damping;
        def.delay = delay * needle.rig.dt;
        CHECK(dpt_passivity_init(&observer, &def) == DPT_OK, "observer");
        for (int i = 0; i < 40000; i++) {
            dpt_wrench asked;
            if (i % (kind & 1 ? 4000 : 400) == 0)
                aim = random_in(&seed, -0.01, 0.09);
            needle.depth = quantum > 0 ? quantum * floor(at / quantum + 0.5) : at;
            needle.depth += random_in(&seed, -1e-6, 1e-6);
            needle_step(&needle);
            dpt_passivity_sample sample = { .size = sizeof sample,
                                            .dt = needle.rig.dt,
                                            .energy = needle.rig.force.energy,
                                            .body_work = needle.rig.force.body_work,
                                            .pose = needle.rig.device,
                                            .sent = held[0] };
            asked = held[0] = needle.rig.force.wrench;
            CHECK(dpt_passivity_step(&observer, &sample, &asked) == DPT_OK, "observer: kind %d, sample %d at %g", kind,
                  i, at);
            held[2] = held[1];
            held[1] = needle.rig.force.wrench;
            const double push = held[1 + delay].force[2];
            const double force = 300 * (aim - at) - push - damping * speed;
            speed += force / mass * needle.rig.dt;
            at += speed * needle.rig.dt;
        }
        dpt_passivity_get_info(&observer, &info);
        CHECK(info.account_min >= -2 * info.eps, "kind %d: the account fell to %g, eps %g", kind, info.account_min,
              info.eps);
        CHECK(needle_channels(&needle, NULL, 0) == 1, "it was never in");
        needle_close(&needle);
    }
}

static void loops_of_friction_have_their_areas(void)
{
    loop_of_friction(0);
    loop_of_friction(1e4);
}

int main(void)
{
    TEST(the_three_terms_are_recovered);
    TEST(toughness_is_that_of_two_insertions);
    TEST(loops_of_friction_have_their_areas);
    TEST(nothing_creeps);
    TEST(layers_come_in_order);
    TEST(jumps_are_ruptures);
    TEST(a_rupture_takes_what_was_held);
    TEST(shallow_bristles_hold_what_they_got);
    TEST(nothing_gives_energy);
    return check_report();
}
