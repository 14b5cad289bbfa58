/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The passivity observer and controller (passivity.h): its account against sums of the test's own, its bound for whatever
 * moves and whatever is asked, and closed loops of a hand-held mass and a wall, which are stable with it.
 *
 *     test_passivity [STEPS of random motion = 200000]
 *
 * The closed loops have one coordinate and a hand that is a spring and a damper; the stability laboratory has the rest.
 */
#include "dynpoint/passivity.h"

#include "dynpoint/coupling.h"
#include "dynpoint/guard.h"
#include "lib/check.h"
#include "lib/pose.h"

static uint64_t steps_wanted = 200000;

static dpt_passivity passivity;

static dpt_passivity_def def_of(double damping)
{
    dpt_passivity_def def;
    dpt_passivity_def_init(&def);
    def.damping = damping;
    def.force_slew = def.torque_slew = 0;
    return def;
}

static void begin(const dpt_passivity_def *def)
{
    passivity.size = sizeof passivity;
    const dpt_result result = dpt_passivity_init(&passivity, def);
    CHECK(result == DPT_OK, "%s", dpt_result_name(result));
}

static dpt_passivity_info told(void)
{
    dpt_passivity_info info = { .size = sizeof info };
    CHECK(dpt_passivity_get_info(&passivity, &info) == DPT_OK, "info");
    return info;
}

/* One sample; what was asked for, and then allowed, is in *wrench. */
static void take(const dpt_pose *pose, const dpt_wrench *sent, double dt, double energy, double body_work,
                 dpt_wrench *wrench)
{
    const dpt_passivity_sample sample = {
        .size = sizeof sample, .dt = dt, .energy = energy, .body_work = body_work, .pose = *pose, .sent = *sent
    };
    const dpt_result result = dpt_passivity_step(&passivity, &sample, wrench);
    CHECK(result == DPT_OK, "%s", dpt_result_name(result));
}

static void random_vector(uint64_t *seed, double most, double v[3])
{
    do
        for (int k = 0; k < 3; k++)
            v[k] = random_in(seed, -most, most);
    while (length3(v) > most);
}

/* By a rotation vector, about the world's axes. */
static void turn(dpt_pose *pose, const double v[3])
{
    const double angle = length3(v), half = 0.5 * angle, share = angle > 0 ? sin(half) / angle : 0.5;
    const double by[4] = { cos(half), share * v[0], share * v[1], share * v[2] };
    pose_turn_by(pose, by);
}

static void the_account_is_what_was_given_and_taken(void)
{
    dpt_passivity_def def = def_of(3);
    uint64_t seed = 5;
    double account = 0, damped = 0, worked = 0;
    dpt_pose pose = DPT_POSE_IDENTITY;
    dpt_wrench sent = { { 0 }, { 0 } };
    def.spin_damping = 0.01;
    def.observe_only = 1;
    def.reserve = 1;
    begin(&def);
    take(&pose, &sent, 1e-3, 0, 0, &(dpt_wrench){ { 0 }, { 0 } });
    for (int i = 0; i < 2000; i++) {
        double shift[3], rotation[3], work = 0;
        const double dt = random_in(&seed, 1e-4, 2e-3), bodies = random_in(&seed, 0, 1e-5);
        dpt_wrench asked;
        random_vector(&seed, 1e-3, shift);
        random_vector(&seed, 1e-2, rotation);
        random_vector(&seed, 1, asked.force);
        random_vector(&seed, 0.02, asked.torque);
        for (int k = 0; k < 3; k++) {
            pose.position[k] += shift[k];
            work += sent.force[k] * shift[k] + sent.torque[k] * rotation[k];
        }
        turn(&pose, rotation);
        damped += 0.8 * (3 * pow(length3(shift), 2) + 0.01 * pow(length3(rotation), 2)) / dt;
        worked += bodies;
        account =
            fmin(account + 0.8 * (3 * pow(length3(shift), 2) + 0.01 * pow(length3(rotation), 2)) / dt + bodies - work,
                 0.5 + 1);
        const dpt_wrench before = asked;
        take(&pose, &sent, dt, 0.5, bodies, &asked);
        CHECK(!memcmp(&asked, &before, sizeof asked), "an observer changes the wrench");
        sent = asked;
    }
    const dpt_passivity_info info = told();
    CHECK(fabs(info.account - account) < 1e-9 && fabs(info.damped - damped) < 1e-9 &&
              fabs(info.body_work - worked) < 1e-9,
          "account %.12g, not %.12g; damped %g, not %g; bodies %g, not %g", info.account, account, info.damped, damped,
          info.body_work, worked);
    CHECK(info.steps == 2001 && info.acted == 0, "%u steps, acted in %u", (unsigned)info.steps, (unsigned)info.acted);
}

/* Along a screw, force gives what torque takes: one account tells that nothing is gained. */
static void force_and_torque_share_one_account(void)
{
    dpt_passivity_def def = def_of(0);
    dpt_pose pose = DPT_POSE_IDENTITY;
    const dpt_wrench sent = { { 0, 0, 1 }, { 0, 0, -0.01 } };
    const double twist[3] = { 0, 0, 0.1 };
    begin(&def);
    for (int i = 0; i < 1000; i++) {
        dpt_wrench asked = sent;
        take(&pose, &sent, 1e-3, 0, 0, &asked);
        CHECK(i < 2 || asked.force[2] == 1, "step %d: the force is taken away", i);
        pose.position[2] += 1e-3;
        turn(&pose, twist);
    }
    CHECK(told().acted == 0 && fabs(told().account) < 1e-12, "account %g", told().account);
}

/* Whatever moves, whatever is asked: without a slew behind it the account stays above -2 eps. */
static void the_account_is_bounded_for_all_motion(void)
{
    uint64_t seed = 11;
    double worst = 0;
    unsigned acted = 0;
    for (int game = 0; game < 20; game++) {
        dpt_passivity_def def = def_of(game % 2 ? 0 : 1);
        dpt_pose pose = DPT_POSE_IDENTITY;
        dpt_wrench sent = { { 0 }, { 0 } };
        double course[3] = { 1, 0, 0 };
        begin(&def);
        for (uint64_t i = 0; i < steps_wanted / 20; i++) {
            double shift[3], rotation[3];
            dpt_wrench asked;
            random_vector(&seed, 2e-3, shift);
            random_vector(&seed, 1e-2, rotation);
            random_vector(&seed, def.force_max, asked.force);
            random_vector(&seed, def.torque_max, asked.torque);
            /* A law that always pushes on, or to and fro, or at random. */
            for (int k = 0; k < 3 && game % 3; k++) {
                course[k] = game % 3 == 1 && i % 7 == 0 ? -course[k] : course[k];
                shift[k] = 1e-3 * course[k];
                asked.force[k] = course[k] * def.force_max * 0.99;
            }
            for (int k = 0; k < 3; k++)
                pose.position[k] += shift[k];
            turn(&pose, rotation);
            take(&pose, &sent, 1e-3, random_in(&seed, 0, 1e-2), random_in(&seed, -1e-3, 1e-3), &asked);
            sent = asked;
        }
        const dpt_passivity_info info = told();
        CHECK(info.account_min >= -2 * info.eps, "game %d: %g eps", game, info.account_min / info.eps);
        worst = fmin(worst, info.account_min / info.eps);
        acted += info.acted > 0;
    }
    CHECK(worst < -0.5 && acted == 20, "not tried: %g eps, acted in %u games", worst, acted);
    printf("    account at least %.2f eps\n", worst);
}

static void what_is_credited_is_limited(void)
{
    dpt_passivity_def def = def_of(0);
    const dpt_pose pose = DPT_POSE_IDENTITY;
    const dpt_wrench none = { { 0 }, { 0 } };
    dpt_wrench asked = none;
    begin(&def);
    for (int i = 0; i < 100; i++)
        take(&pose, &none, 1e-3, 0.003, 1, &asked);
    CHECK(fabs(told().body_work - 0.1) < 1e-12, "1 W for 0.1 s: %g J", told().body_work);
    CHECK(fabs(told().account - 0.013) < 1e-12, "energy and reserve: %g J", told().account);
    take(&pose, &none, 1e-3, 0, 0, &asked);
    CHECK(fabs(told().account - 0.01) < 1e-12, "the reserve: %g J", told().account);
    take(&pose, &none, 1e-3, 0, -1, &asked);
    CHECK(told().account == 0, "bodies take what there is, not more: %g J", told().account);
}

/* A mass that a hand holds at a wall, by 20 steps a period. */
struct hand_loop {
    double mass, damping, period, stiffness;
    int delay;         /* periods, at most 3 */
    double hand, firm; /* of the hand: N/m and Ns/m; its target is `deep` m in the wall */
    double deep, loss; /* m; share of samples that are lost */
    double slew;       /* N/s, of the guard; 0: unlimited */
    uint32_t is_off;   /* the controller */
};

struct hand_result {
    double speed; /* m/s, largest in the last quarter */
    double force; /* N, mean in the last quarter */
    dpt_passivity_info info;
};

static double wall(double stiffness, double x)
{
    return x < 0 ? -stiffness * x : 0;
}

static struct hand_result hold(const struct hand_loop *loop, double seconds)
{
    struct hand_result result = { .speed = 0 };
    dpt_passivity_def def = def_of(loop->damping);
    dpt_guard guard = { .size = sizeof guard };
    dpt_guard_def limits;
    dpt_guard_def_init(&limits);
    limits.force_slew = def.force_slew = loop->slew;
    limits.start = 0;
    def.delay = loop->delay * loop->period;
    def.observe_only = loop->is_off;
    begin(&def);
    CHECK(dpt_guard_init(&guard, &limits) == DPT_OK, "guard");
    const int ticks = (int)(seconds / loop->period);
    double x = 1e-3, v = 0, since = 0, under_way[4] = { 0 };
    dpt_wrench sent = { { 0 }, { 0 } };
    uint64_t seed = 3;
    for (int i = 0; i < ticks; i++) {
        const uint64_t now = (uint64_t)((i + 1) * loop->period * 1e9);
        since += loop->period;
        dpt_wrench asked = { { 0, wall(loop->stiffness, x), 0 }, { 0 } };
        const int is_lost = random_in(&seed, 0, 1) < loop->loss;
        if (!is_lost) {
            const dpt_pose pose = { { 0, x, 0 }, { 1, 0, 0, 0 } };
            const double energy = 0.5 * loop->stiffness * fmin(x, 0) * fmin(x, 0);
            take(&pose, &sent, since, energy, 0, &asked);
            since = 0;
        }
        dpt_guard_step(&guard, now, is_lost ? NULL : &asked, 1, &sent);
        memmove(under_way + 1, under_way, 3 * sizeof *under_way);
        under_way[0] = sent.force[1];
        const double h = loop->period / 20;
        for (int k = 0; k < 20; k++) {
            v += h / loop->mass *
                 (under_way[loop->delay] - (loop->damping + loop->firm) * v - loop->hand * (x + loop->deep));
            x += h * v;
        }
        if (i < ticks - ticks / 4)
            continue;
        result.speed = fmax(result.speed, fabs(v));
        result.force += under_way[loop->delay] / (ticks / 4);
    }
    result.info = told();
    return result;
}

static struct hand_loop hand_loop_of(int delay, double part)
{
    struct hand_loop loop = { .mass = 0.1, .damping = 0.5, .period = 1e-3, .delay = delay };
    loop.hand = 200;
    loop.deep = 0.01;
    loop.stiffness = part * dpt_stable_stiffness(0.1, 0.5, 1e-3, delay * 1e-3, 0);
    return loop;
}

static void it_is_idle_where_the_wall_is_stable(void)
{
    const double parts[] = { 0.2, 0.5, 0.66, 0.78 };
    for (int i = 0; i < 16; i++) {
        const struct hand_loop loop = hand_loop_of(i / 4, parts[i % 4]);
        const struct hand_result with = hold(&loop, 6);
        CHECK(with.info.acted == 0, "delay %d, %g of the limit: acted %u times", loop.delay, parts[i % 4],
              (unsigned)with.info.acted);
        CHECK(with.force > 0.2, "delay %d: only %g N", loop.delay, with.force);
    }
}

static void it_calms_walls_that_are_not(void)
{
    const double parts[] = { 1.2, 1.5, 2, 5 };
    for (int i = 0; i < 16; i++) {
        struct hand_loop loop = hand_loop_of(i / 4, parts[i % 4]);
        loop.slew = i % 2 ? 2000 : 0;
        const struct hand_result with = hold(&loop, 6);
        loop.is_off = 1;
        const struct hand_result without = hold(&loop, 6);
        CHECK(with.info.account_min >= -2 * with.info.eps, "delay %d, %g: %g eps", loop.delay, parts[i % 4],
              with.info.account_min / with.info.eps);
        CHECK(without.info.account_min < -2 * without.info.eps, "delay %d, %g: passive without the controller",
              loop.delay, parts[i % 4]);
        CHECK(with.speed < 0.5 * without.speed && with.force > 0.8,
              "delay %d, %g of the limit: %g m/s, %g N; without %g m/s", loop.delay, parts[i % 4], with.speed,
              with.force, without.speed);
    }
}

/* 20 % of the samples are lost, 1 and 10 kHz, hands from stiff to all but absent. */
static void the_account_is_bounded_in_loops(void)
{
    const double hands[][2] = { { 2000, 2 }, { 200, 0 }, { 20, 0 }, { 2, 0 } };
    const double parts[] = { 0.67, 1.5, 3, 10 };
    double worst = 0;
    for (int i = 0; i < 4 * 4 * 3 * 2; i++) {
        struct hand_loop loop = hand_loop_of(i / 16 % 3, 1);
        loop.period = i / 48 ? 1e-4 : 1e-3;
        loop.stiffness = parts[i / 4 % 4] * dpt_stable_stiffness(0.1, 0.5, loop.period, loop.delay * loop.period, 0);
        loop.hand = hands[i % 4][0];
        loop.firm = hands[i % 4][1];
        loop.deep = fmin(2 / loop.hand, 0.1);
        loop.loss = 0.2;
        loop.slew = 2000;
        const struct hand_result result = hold(&loop, 3);
        CHECK(result.info.account_min >= -2 * result.info.eps, "%g Hz, delay %d, hand %g, %g of the limit: %g eps",
              1 / loop.period, loop.delay, loop.hand, parts[i / 4 % 4], result.info.account_min / result.info.eps);
        worst = fmin(worst, result.info.account_min / result.info.eps);
    }
    printf("    96 loops: account at least %.2f eps\n", worst);
}

/* The law gives its force back at a smaller depth than it took it at: it makes energy out of nothing. */
static void energy_out_of_nothing_is_taken_away(void)
{
    for (int is_off = 0; is_off < 2; is_off++) {
        dpt_passivity_def def = def_of(0);
        dpt_pose pose = DPT_POSE_IDENTITY;
        dpt_wrench sent = { { 0 }, { 0 } };
        double gained = 0, before = 0;
        def.observe_only = (uint32_t)is_off;
        begin(&def);
        for (int i = 0; i < 20000; i++) {
            const double x = -1e-3 * (1 - cos(2 * 3.14159265358979 * i / 500));
            const int is_out = i % 500 >= 250;
            dpt_wrench asked = { { 0, wall(is_out ? 1200 : 1000, x), 0 }, { 0 } };
            pose.position[1] = x;
            gained += sent.force[1] * (x - before);
            before = x;
            take(&pose, &sent, 1e-3, 0.5 * 1000 * x * x, 0, &asked);
            sent = asked;
        }
        const dpt_passivity_info info = told();
        CHECK(is_off ? gained > 0.01 : gained < 2 * info.eps, "%s: the hand gained %g J", is_off ? "off" : "on",
              gained);
        CHECK(is_off || (info.taken > 0.01 && info.acted > 100), "taken %g J in %u steps", info.taken,
              (unsigned)info.acted);
    }
}

static void what_is_wrong_gives_no_force(void)
{
    dpt_passivity_sample sample = { .size = sizeof sample, .dt = 1e-3, .pose = DPT_POSE_IDENTITY };
    const dpt_wrench some = { { 1, 0, 0 }, { 0 } };
    dpt_passivity_info info = { .size = sizeof info };
    begin(NULL);
    const dpt_result codes[] = { DPT_E_ARGUMENT, DPT_E_FINITE, DPT_E_FINITE, DPT_E_FINITE, DPT_E_POSE, DPT_E_FINITE };
    double *numbers[] = { &sample.dt,
                          &sample.energy,
                          &sample.body_work,
                          &sample.pose.position[1],
                          &sample.pose.orientation[0],
                          &sample.sent.torque[2] };
    for (int i = 0; i < 6; i++) {
        const double kept = *numbers[i];
        dpt_wrench wrench = some;
        *numbers[i] = NAN;
        const dpt_result result = dpt_passivity_step(&passivity, &sample, &wrench);
        CHECK(result == codes[i] && wrench.force[0] == 0, "number %d: %s", i, dpt_result_name(result));
        *numbers[i] = kept;
    }
    dpt_wrench wrench = { { 1, NAN, 0 }, { 0 } };
    CHECK(dpt_passivity_step(&passivity, &sample, &wrench) == DPT_E_FINITE && wrench.force[0] == 0,
          "a wrench that is not finite");
    CHECK(told().steps == 0, "%u samples were booked", (unsigned)told().steps);
    wrench = some;
    CHECK(dpt_passivity_step(&passivity, &sample, &wrench) == DPT_OK && wrench.force[0] == 1, "a sound one");
    dpt_passivity unmade;
    memset(&unmade, 0, sizeof unmade);
    unmade.size = sizeof unmade;
    CHECK(dpt_passivity_step(&unmade, &sample, &wrench) == DPT_E_ARGUMENT && wrench.force[0] == 0,
          "one that was not initialised");
    CHECK(dpt_passivity_get_info(&unmade, &info) == DPT_E_ARGUMENT && info.steps == 0, "its info");
    dpt_passivity_def def = def_of(-1);
    CHECK(dpt_passivity_init(&passivity, &def) == DPT_E_ARGUMENT, "damping -1");
    CHECK(dpt_passivity_step(&passivity, &sample, &wrench) == DPT_E_ARGUMENT, "after an error");
}

int main(int argc, char **argv)
{
    if (argc > 1)
        steps_wanted = strtoull(argv[1], NULL, 10);
    TEST(the_account_is_what_was_given_and_taken);
    TEST(force_and_torque_share_one_account);
    TEST(the_account_is_bounded_for_all_motion);
    TEST(what_is_credited_is_limited);
    TEST(it_is_idle_where_the_wall_is_stable);
    TEST(it_calms_walls_that_are_not);
    TEST(the_account_is_bounded_in_loops);
    TEST(energy_out_of_nothing_is_taken_away);
    TEST(what_is_wrong_gives_no_force);
    return check_report();
}
