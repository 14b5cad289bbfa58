/* SPDX-License-Identifier: BSD-3-Clause */
/* No net energy on the borders of passivity: Colgate's, and Abbott's and Okamura's. */
#include <math.h>

#include "lab/hand_sway.h"
#include "lab/lab_cases.h"

enum { HANDS = 4, TOOLS = 2, MESHES = 2, DAMPINGS = 3, STEPS = 3 };

/*
 * What the hand has put in and not got back, J, from the true motion: the device's damping and friction are credited
 * whole. It is at most the energy that the law stores, so that nothing can be saved up. eps is the largest force times
 * the largest motion between two samples: what one sample can be off by.
 */
struct account {
    double now, least, eps;
};

#define MASS    0.1
#define DAMPING 0.5
#define PERIOD  1e-3
#define TICKS   3000

/* Shares of the device's damping that the coupling has as virtual damping. */
static const double dampings[DAMPINGS] = { 0.0, 0.5, 0.25 };

/* Steps of the encoders and friction; 2 f_c / D is below, at and above 2 b / T. */
static const struct {
    double step, friction;
} steps[STEPS] = { { 5e-5, 0.01 }, { 2e-5, 0.01 }, { 1e-4, 0.1 } };

static const struct hand_tool tools[TOOLS] = { { 0.0, 0.005, 0.0 }, { 0.06, 0.002, 0.0 } };

/* A firm and a soft hand that press and let go; one that only holds; none. The device falls with the last two. */
static void set_hand(struct hand_device *device, int hand)
{
    device->script = hand < 2 ? "press" : hand == 2 ? "hold" : NULL;
    device->grip = hand == 0 ? 2000.0 : 200.0;
    device->turn_grip = device->inertia / device->mass * device->grip;
    device->reach = 0.01;
    device->cycle = 0.5;
    device->weight = hand < 2 ? 0.0 : 0.5;
}

static struct account account_of(const struct hand_loop *loop)
{
    const struct hand_device *device = &loop->device;
    struct account account = { 0.0, 0.0, 0.0 };
    double motion = 0.0, force = 0.0;
    for (size_t i = 1; i < loop->count; i++) {
        const struct hand_moment *now = &loop->track[i], *before = now - 1;
        double moved = 0.0, sent = 0.0;
        for (int k = 0; k < HAND_AXES; k++) {
            const double by = now->at[k] - before->at[k];
            const double damping = k < 3 ? device->damping : device->turn_damping;
            const double unit = k < 3 || device->inertia <= 0.0 ? 1.0 : sqrt(device->inertia / device->mass);
            account.now +=
                damping * by * by * device->rate + (k < 3 ? device->friction * fabs(by) : 0.0) - now->sent[k] * by;
            moved += unit * unit * by * by;
            sent += now->sent[k] * now->sent[k] / (unit * unit);
        }
        account.now = fmin(account.now, now->energy);
        account.least = fmin(account.least, account.now);
        motion = fmax(motion, sqrt(moved));
        force = fmax(force, sqrt(sent));
    }
    account.eps = force * motion;
    return account;
}

/* The least account, in eps, of a loop with a hand: of this account, and of the library's observer. */
static void try_loop(const struct hand_mesh *mesh, const struct hand_loop *as, int hand, double stiffness,
                     double *account, double *observer)
{
    struct hand_loop loop = *as;
    struct hand_place place = { .mesh = mesh };
    dpt_passivity_def def;
    uint64_t seed = 11;
    dpt_passivity_def_init(&def);
    def.damping = loop.device.damping / 0.8;
    def.spin_damping = loop.device.turn_damping / 0.8;
    def.observe_only = 1;
    def.reserve = 0.0;
    loop.place = &place;
    loop.passivity = &def;
    loop.stiffness = stiffness;
    set_hand(&loop.device, hand);
    hand_place_middle(mesh, &place);
    if (hand_loop_open(&loop) && (mesh->shape.triangle_count > 12 ? hand_loop_seek(&loop, mesh, &seed, 0.01, &place)
                                                                  : hand_loop_lower(&loop, 0.01))) {
        hand_loop_lift(&loop, 0.002);
        if (hand_loop_run(&loop, TICKS)) {
            const struct account seen = account_of(&loop);
            *account = hand_smaller(*account, seen.least / seen.eps);
            *observer = hand_smaller(*observer, hand_loop_account(&loop).account_min / seen.eps);
        } else {
            *account = NAN;
        }
    } else {
        *account = NAN;
    }
    hand_loop_close(&loop);
}

static struct hand_loop loop_of(int method, const struct hand_tool *tool, double damping)
{
    struct hand_loop loop = { .tool = *tool, .method = method, .damping = damping };
    loop.device = hand_device_even(MASS, DAMPING, 0.0, hand_loop_rho(&loop));
    return loop;
}

/* K T / 2 + |B| = b, and three times that. */
static void try_colgate(struct lab *lab, const struct hand_mesh *meshes, int method)
{
    const uint64_t loops = lab_share(lab, HANDS * TOOLS * MESHES * DAMPINGS);
    double account = 0.0, observer = 0.0, beyond = 0.0, unused = 0.0;
    for (uint64_t i = 0; i < loops; i++) {
        const int hand = (int)(HANDS - 1 - i % HANDS);
        const struct hand_mesh *mesh = &meshes[i / HANDS % MESHES];
        const double damping = DAMPING * dampings[i / HANDS / MESHES / TOOLS];
        const struct hand_loop loop = loop_of(method, &tools[i / HANDS / MESHES % TOOLS], damping);
        const double border = 2.0 * (DAMPING - damping) / PERIOD;
        try_loop(mesh, &loop, hand, border, &account, &observer);
        if (damping == 0.0)
            try_loop(mesh, &loop, hand, 3.0 * border, &beyond, &unused);
    }
    const char *word = lab_method_name(method);
    lab_at_least(lab, word, "least account on the border of Colgate", account, "eps", -1.0);
    lab_note(lab, word, "least account at three times that stiffness", beyond, "eps");
    if (method != LAB_PROXY)
        return;
    lab_at_most(lab, "observer", "least account at three times the border of Colgate", beyond, "eps", -1.0);
    lab_at_least(lab, "observer", "least account on that border as dpt_passivity keeps it", observer, "eps", -1.0);
}

/* K = min(2 b / T, 2 f_c / D) */
static void try_abbott(struct lab *lab, const struct hand_mesh *meshes, int method)
{
    const uint64_t loops = lab_share(lab, HANDS * STEPS);
    double account = 0.0, unused = 0.0;
    for (uint64_t i = 0; i < loops; i++) {
        struct hand_loop loop = loop_of(method, &tools[0], 0.0);
        loop.device.step = steps[i / HANDS].step;
        loop.device.friction = steps[i / HANDS].friction;
        const double border = fmin(2.0 * DAMPING / PERIOD, 2.0 * loop.device.friction / loop.device.step);
        try_loop(&meshes[0], &loop, (int)(HANDS - 1 - i % HANDS), border, &account, &unused);
    }
    lab_at_least(lab, lab_method_name(method), "least account on the border of Abbott and Okamura", account, "eps",
                 -1.0);
}

static void run(struct lab *lab)
{
    struct hand_mesh meshes[MESHES] = { { .mesh = NULL }, { .mesh = NULL } };
    if (!hand_mesh_open(&meshes[0], "box", 12, 3.0) || !hand_mesh_open(&meshes[1], "liver", 10000, 1.0)) {
        lab->is_out_of_memory = 1;
    } else {
        for (int method = LAB_BED; method < LAB_METHODS; method++) {
            try_colgate(lab, meshes, method);
            try_abbott(lab, meshes, method);
        }
    }
    hand_mesh_close(&meshes[0]);
    hand_mesh_close(&meshes[1]);
}

const struct lab_case energy_case = {
    "energy", "Energy on the borders of passivity",
    "Firm and soft hands press a ball and a lying tool into a plane and a liver and let go, and "
    "the device falls on to them without a hand, at 1 kHz without delay. The stiffness is that of "
    "Colgate (K T/2 + B = b), with virtual damping of 0 to half the device's, or with steps of "
    "encoders and friction that of Abbott and Okamura (the smaller of 2 b/T and 2 f_c/D). An "
    "account holds what the hand has put in and not got back, with all damping and friction of "
    "the device credited, at most the energy that the law stores. A passive law never takes it "
    "below what one sample can be off by: eps, the largest force times the largest motion. The "
    "point law has no energy. The bed feels up to twice as stiff as it is set, and a ball at the "
    "tip turns the device by a lever.",
    "If a device must be passive with every hand, stay below the smaller of 2 (b - B)/T and 2 "
    "f_c/D, and keep delay away. The proxy gives back no more than that bound of a plain spring says.",
    run
};
