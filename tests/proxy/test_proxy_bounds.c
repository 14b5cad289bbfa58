/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * How smooth and how late the force of a proxy is (docs/algorithms/force.md): a capsule is led over a surface by a random
 * motion at up to 0.1 m/s, pressed in by a share of its radius. Norms are worked out here, from the tool's length.
 *
 *     test_proxy_bounds [PER CENT of the ticks = 100]
 */
#include "lib/rig.h"
#include "lib/solid.h"

#define LENGTH 0.06
#define RADIUS 0.002

static const dpt_segment capsule_of_tests = { { -0.03, 0, 0 }, { 0.03, 0, 0 }, RADIUS };

/* m^2: of a straight tool, about its middle, which is the origin of its frame. */
static const double rho2 = LENGTH * LENGTH / 12;

struct lead {
    struct rig rig;
    uint64_t seed;
    double deep;              /* how deep the device is to be pressed in */
    double along[3], axis[3]; /* m and rad a tick */
    dpt_wrench wrench;        /* of the last tick */
    double away;              /* |p - d|_M, of the last tick */
};

static double away_of(const struct rig *rig)
{
    return rig->force.reason == DPT_FORCE_ACTS ? sqrt(2 * rig->force.energy / RIG_STIFFNESS) : 0;
}

static void open_lead(struct lead *lead, const struct solid *solid, double deep, uint64_t seed)
{
    *lead = (struct lead){ .seed = seed, .deep = deep };
    rig_open(&lead->rig, NULL, solid->mesh, &capsule_of_tests, 1);
    lead->rig.device.position[2] = solid->info.box_max[2] + 0.01;
    rig_place(&lead->rig);
}

/* Along the surface, with a turn; out or in, towards the depth that is wanted. Returns the motion's norm, m. */
static double lead_on(struct lead *lead, const struct solid *solid)
{
    struct rig *rig = &lead->rig;
    const double speed = 6e-5, off = lead->deep - away_of(rig);
    double in[3], turn[3], shift[3], x[3];
    for (int k = 0; k < 3; k++) {
        const double middle = 0.5 * (solid->info.box_min[k] + solid->info.box_max[k]);
        in[k] = lead->away > 0 ? -rig->force.wrench.force[k] : middle - rig->device.position[k];
        lead->along[k] = 0.995 * lead->along[k] + random_in(&lead->seed, -1, 1) * 6e-6;
        lead->axis[k] = 0.995 * lead->axis[k] + random_in(&lead->seed, -1, 1) * 6e-5;
    }
    unit3(in);
    turn3(rig->device.orientation, (const double[3]){ 1, 0, 0 }, x);
    const double fast = sqrt(dot3(lead->along, lead->along)), press = fmax(-3e-5, fmin(3e-5, off));
    const double inward = dot3(lead->along, in), spun = dot3(lead->axis, x);
    for (int k = 0; k < 3; k++) {
        shift[k] = (lead->along[k] - inward * in[k]) * fmin(1, speed / fmax(fast, 1e-12)) + press * in[k];
        turn[k] = lead->axis[k] - spun * x[k];
        rig->device.position[k] += shift[k];
    }
    pose_turn_by(&rig->device, (const double[4]){ 1, turn[0] / 2, turn[1] / 2, turn[2] / 2 });
    lead->wrench = rig->force.wrench;
    lead->away = away_of(rig);
    rig_step(rig);
    return sqrt(dot3(shift, shift) + rho2 * dot3(turn, turn));
}

/* |dW| of a tick, N. */
static double change_of(const struct lead *lead)
{
    double square = 0;
    for (int k = 0; k < 3; k++) {
        const double f = lead->rig.force.wrench.force[k] - lead->wrench.force[k];
        const double t = lead->rig.force.wrench.torque[k] - lead->wrench.torque[k];
        square += f * f + t * t / rho2;
    }
    return sqrt(square);
}

/*
 * On convex bodies |dW| <= 1.25 K |motion| while |p - d| is at most a fifth of the radius. Deeper, an upright tip on a
 * sharp edge is pressed beyond its balance: the tip swings sideways by twice as much as the norm of the motion, so that in
 * this norm its sphere has a quarter of the radius.
 */
static void convex_bodies_are_smooth(void)
{
    static const char *const shapes[] = { "box", "sphere" };
    for (int i = 0; i < 2; i++) {
        struct solid solid;
        struct lead lead;
        double most = 0;
        uint64_t judged = 0;
        if (!solid_from_shape(&solid, shapes[i], i ? 5000 : 1200))
            return;
        open_lead(&lead, &solid, 0.18 * RADIUS, 7 + (uint64_t)i);
        for (uint64_t t = 0; t < part_of(40000); t++) {
            const double motion = lead_on(&lead, &solid);
            if (fmax(lead.away, away_of(&lead.rig)) > 0.2 * RADIUS)
                continue;
            judged += lead.rig.force.reason == DPT_FORCE_ACTS;
            /* What the clearance leaves open is no motion of the device's. */
            const double share = change_of(&lead) / (RIG_STIFFNESS * (motion + 2e-6));
            most = fmax(most, share);
            CHECK(share <= 1.25, "%s, tick %llu: %g times K |motion| of %g, away %g, flags %u", shapes[i],
                  (unsigned long long)t, share, motion, lead.away, lead.rig.force.flags);
        }
        printf("    %-8s at most %.3f K |motion|, %llu ticks\n", shapes[i], most, (unsigned long long)judged);
        CHECK(judged > part_of(20000), "%llu ticks", (unsigned long long)judged);
        rig_close(&lead.rig);
        solid_close(&solid);
    }
}

/* At most 1 % of |p - d| on 99.9 % of the ticks up to half the radius, on 99 % deeper; folds apart. */
static void it_lags_by_little(void)
{
    static const char *const shapes[] = { "box", "sphere", "liver", "stomach" };
    for (int i = 0; i < 8; i++) {
        struct solid solid;
        struct lead lead;
        const int is_deep = i >= 4;
        uint64_t judged = 0, late = 0, folds = 0;
        if (!solid_from_shape(&solid, shapes[i % 4], i % 4 ? 5000 : 4800))
            return;
        open_lead(&lead, &solid, is_deep ? 2.0 * RADIUS : 0.4 * RADIUS, 20 + (uint64_t)i);
        for (uint64_t t = 0; t < part_of(40000); t++) {
            lead_on(&lead, &solid);
            const double away = away_of(&lead.rig);
            const int is_fold = (lead.rig.force.flags & DPT_FORCE_FLAG_FOLD) != 0;
            folds += (uint64_t)is_fold;
            if (is_fold || away < 1e-5 || (away > 0.5 * RADIUS) != is_deep)
                continue;
            judged++;
            late += lead.rig.force.lag > 0.01 * away;
        }
        printf("    %-8s %s: %llu of %llu ticks lag, %llu folds\n", shapes[i % 4], is_deep ? "deep" : "flat",
               (unsigned long long)late, (unsigned long long)judged, (unsigned long long)folds);
        CHECK(judged > part_of(15000), "%s: %llu ticks", shapes[i % 4], (unsigned long long)judged);
        CHECK((double)late <= (is_deep ? 0.01 : 0.001) * (double)judged, "%s: %llu of %llu lag", shapes[i % 4],
              (unsigned long long)late, (unsigned long long)judged);
        rig_close(&lead.rig);
        solid_close(&solid);
    }
}

/* A tool that is split into pieces is felt as the whole, within K times 4e-6 of the diagonal. */
static void pieces_are_felt_as_the_whole(void)
{
    enum { PIECES = 4 };
    struct solid solid;
    if (!solid_from_shape(&solid, "liver", 5000))
        return;
    for (uint32_t pieces = 2; pieces <= PIECES; pieces++) {
        struct lead lead;
        struct rig split;
        dpt_segment segments[PIECES];
        double most = 0;
        uint64_t folds = 0;
        for (uint32_t i = 0; i < pieces; i++)
            segments[i] = (dpt_segment){ { -0.03 + LENGTH * i / pieces, 0, 0 },
                                         { -0.03 + LENGTH * (i + 1) / pieces, 0, 0 },
                                         RADIUS };
        open_lead(&lead, &solid, 0.4 * RADIUS, 3);
        rig_open(&split, NULL, solid.mesh, segments, pieces);
        split.device = lead.rig.device;
        rig_place(&split);
        for (uint64_t t = 0; t < part_of(8000) && !folds; t++) {
            lead_on(&lead, &solid);
            split.device = lead.rig.device;
            rig_step(&split);
            folds += ((lead.rig.force.flags | split.force.flags) & DPT_FORCE_FLAG_FOLD) != 0;
            if (fmax(lead.rig.force.lag, split.force.lag) > 1e-7)
                continue;
            for (int k = 0; k < 3; k++)
                most = fmax(most, fabs(lead.rig.force.wrench.force[k] - split.force.wrench.force[k]));
        }
        CHECK(most <= RIG_STIFFNESS * 4e-6 * solid.diagonal, "%u pieces: %g N off", pieces, most);
        printf("    %u pieces: %.3g of K D\n", pieces, most / RIG_STIFFNESS / solid.diagonal);
        rig_close(&split);
        rig_close(&lead.rig);
    }
    solid_close(&solid);
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(convex_bodies_are_smooth);
    TEST(it_lags_by_little);
    TEST(pieces_are_felt_as_the_whole);
    return check_report();
}
