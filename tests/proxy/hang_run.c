/* SPDX-License-Identifier: BSD-3-Clause */
#include "proxy/hang_run.h"

#include "lib/rig.h"
#include "oracle/ball_path.h"

#define DEPTH      5e-3
#define ABOVE      3e-3
#define SPEED      0.1
#define SLIDER     1e-3
#define SMOOTH     0.05 /* of a tick */
#define CLEARANCE  2e-6 /* of the diagonal */
#define FOLD_SPEED 1.0  /* m/s: a proxy goes 2 |device's motion| and that in a tick at most */
#define AS_FAR     0.05

/*
 * A hand that wipes: a ball of 1 mm slides over the mesh, and the hand is below it. Which way is up changes slowly, also at
 * edges.
 */
struct wipe {
    struct slide slide;
    double up[3], height;
};

static void wipe_up(const struct wipe *wipe, double up[3])
{
    dpt_hit hit = DPT_HIT_INIT;
    dpt_query_segments(wipe->slide.mesh, NULL, wipe->slide.ends, NULL, 1, &hit, NULL);
    for (int k = 0; k < 3; k++)
        up[k] = hit.p[k] - hit.q[k];
    unit3(up);
}

static void wipe_begin(struct wipe *wipe, const struct solid *solid, uint64_t seed)
{
    slide_begin(&wipe->slide, solid, seed, 0, SLIDER);
    wipe->slide.step = SPEED * RIG_DT;
    wipe_up(wipe, wipe->up);
    wipe->height = ABOVE;
}

static void wipe_move(struct wipe *wipe, dpt_pose *pose)
{
    double up[3];
    slide_step(&wipe->slide);
    wipe_up(wipe, up);
    for (int k = 0; k < 3; k++)
        wipe->up[k] += SMOOTH * (up[k] - wipe->up[k]);
    unit3(wipe->up);
    wipe->height = fmax(-DEPTH, wipe->height - SPEED * RIG_DT);
    for (int k = 0; k < 3; k++)
        pose->position[k] = wipe->slide.ends[k] + (wipe->height - SLIDER) * wipe->up[k];
}

void hang_run(const struct solid *solid, double radius, uint64_t seed, uint64_t ticks, struct hang_sums *sums)
{
    const dpt_segment ball = { { 0, 0, 0 }, { 0, 0, 0 }, radius };
    struct rig rig;
    struct wipe wipe;
    struct ball_path path;
    wipe_begin(&wipe, solid, seed);
    rig_open(&rig, NULL, solid->mesh, &ball, 1);
    wipe_move(&wipe, &rig.device);
    rig_place(&rig);
    if (!ball_path_open(&path, solid->corners, solid->place.triangles, radius + CLEARANCE * fmin(1, solid->diagonal),
                        rig.device.position))
        exit(2);
    for (uint64_t tick = 0; tick < ticks && rig.force.reason <= DPT_FORCE_FREE; tick++) {
        const dpt_pose before = rig.device;
        wipe_move(&wipe, &rig.device);
        rig_step(&rig);
        const double longest = 2 * apart(before.position, rig.device.position) + FOLD_SPEED * RIG_DT;
        sums->folding += !ball_path_follow(&path, rig.device.position, longest);
        const double far = apart(rig.proxy.position, rig.device.position), due = apart(path.at, rig.device.position);
        sums->ticks++;
        sums->force += rig_force(&rig);
        sums->oracle += RIG_STIFFNESS * due;
        sums->farther += far > (1 + AS_FAR) * due + 1e-5;
        sums->nearer += far < (1 - AS_FAR) * due - 1e-5;
    }
    ball_path_close(&path);
    rig_close(&rig);
}
