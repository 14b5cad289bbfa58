/* SPDX-License-Identifier: BSD-3-Clause */
/* No net energy on the borders of passivity: Colgate's, and Abbott's and Okamura's. */
#include <math.h>

#include "base/vec3.h"
#include "lab/hand_sway.h"
#include "lab/lab.h"
#include "lab/lab_lead.h"

enum { HANDS = 4, TOOLS = 2, MESHES = 2, DAMPINGS = 3, STEPS = 3 };

/*
 * What the hand has put in and not got back, J, from the true motion: the device's damping and friction are credited
 * whole. It is at most the energy that the law stores, so that nothing can be saved up. eps is the largest force times
 * the largest motion between two samples: what one sample can be off by.
 */
struct account {
    double now, min, eps;
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
        account.min = fmin(account.min, account.now);
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
            *account = hand_min(*account, seen.min / seen.eps);
            *observer = hand_min(*observer, hand_loop_account(&loop).account_min / seen.eps);
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
    .name = "energy",
    .title = "Energy on the borders of passivity",
    .method = "Firm and soft hands press a ball and a lying tool into a plane and a liver and let go, and "
              "the device falls on to them without a hand, at 1 kHz without delay. The stiffness is that of "
              "Colgate (K T/2 + B = b), with virtual damping of 0 to half the device's, or with steps of "
              "encoders and friction that of Abbott and Okamura (the smaller of 2 b/T and 2 f_c/D). An "
              "account holds what the hand has put in and not got back, with all damping and friction of "
              "the device credited, at most the energy that the law stores. A passive law never takes it "
              "below what one sample can be off by: eps, the largest force times the largest motion. The "
              "point law has no energy. The bed feels up to twice as stiff as it is set, and a ball at the "
              "tip turns the device by a lever.",
    .advice = "If a device must be passive with every hand, stay below the smaller of 2 (b - B)/T and 2 "
              "f_c/D, and keep delay away. The proxy gives back no more than that bound of a plain spring says.",
    .run = run
};

/* Energy: net work over closed paths, and an hour of the same motion. */

/* Paths up to 5 mm deep, and up to 30 mm: past the middle of what is thin. */
static void go_round_paths(struct lab *lab, int method, const dpt_mesh *mesh, struct path_result *worst)
{
    static const double depths[] = { 0.005, 0.03 };
    for (int i = 0; i < 2; i++) {
        struct force_trial_def def = lab_trial_def(method, mesh);
        struct path_result result;
        def.depth = depths[i];
        def.paths = lab_share(lab, method == LAB_BED ? 10 : 20);
        if (!force_trial_paths(&def, &result)) {
            lab->is_out_of_memory = 1;
            return;
        }
        worst->paths += result.paths;
        worst->emitting += result.emitting;
        worst->emitted_max = fmax(worst->emitted_max, result.emitted_max);
        worst->lost_max = fmax(worst->lost_max, result.lost_max);
    }
}

static void run_work(struct lab *lab)
{
    static const char *const shapes[] = { "liver", "box", "torus" };
    static const uint64_t triangles[] = { 4000, 1200, 4000 };
    struct path_result worst[LAB_METHODS] = { { .paths = 0 } };
    for (int i = 0; i < 3; i++) {
        struct lab_mesh mesh;
        if (!lab_mesh_shape(lab, &mesh, shapes[i], triangles[i]))
            return;
        for (int method = 0; method < LAB_METHODS; method++)
            go_round_paths(lab, method, mesh.mesh, &worst[method]);
        lab_mesh_close(&mesh);
    }
    for (int method = 0; method < LAB_METHODS; method++) {
        const char *name = lab_method_name(method);
        const struct path_result *result = &worst[method];
        lab_at_most(lab, name, "most energy given on a closed path, of its range", 100.0 * result->emitted_max, "%",
                    0.1);
        lab_at_most(lab, name, "closed paths that give more than 0.1 % of it",
                    lab_per_cent(result->emitting, result->paths), "%", 0.0);
        if (method == LAB_PROXY)
            lab_at_most(lab, name, "most energy lost on a path without a fold", 100.0 * result->lost_max, "%", 5.0);
        else
            lab_note(lab, name, "most energy lost on a path without a fold", 100.0 * result->lost_max, "%");
        lab_note(lab, name, "closed paths", (double)result->paths, "");
    }
}

const struct lab_case work_case = {
    .name = "work",
    .title = "Net work over closed paths",
    .method = "A tool is led round closed paths without friction, from the open up to 5 and 30 mm into "
              "a liver, a box and a torus, and back, in steps of at most 0.05 mm. The work that it "
              "yields is compared with the range of the energy on that path. The point has no energy of "
              "its own; F^2 / 2K stands for it. The ball is this library's proxy of one point.",
    .advice = "A law that yields energy on a closed path can drive a hand without end, and no damping "
              "in the air accounts for it. Use the proxy or the bed where a device has little damping "
              "of its own, and keep the passivity observer on: friction, delays and moving bodies are "
              "not covered by this figure.",
    .run = run_work
};

/* A lap of 2 s: down to the surface, 2 mm in, along it and back out. */
enum { LAP = 2000 };

static void aim_on_lap(struct lab_lead *lead, const struct place *place, int tick)
{
    const double angle = 6.283185307179586 * tick / LAP;
    const double height = LAB_RADIUS + 0.002 * cos(angle), aside = 0.01 * sin(2.0 * angle);
    const double lean = 0.8 + 0.3 * sin(angle);
    double x[3], axis[3];
    for (int k = 0; k < 3; k++) {
        x[k] = place->x[k] + height * place->normal[k] + aside * place->across[k];
        axis[k] = cos(lean) * place->normal[k] + sin(lean) * place->side[k];
    }
    lab_lead_aim(lead, x, axis);
}

struct hour {
    double force[LAP][3]; /* of the second lap */
    double drift;         /* N, the largest */
    double work;          /* J, of the lap */
    double given_max;     /* J, of a lap */
    double energy;        /* J, the largest */
    double units;         /* that the lap took */
    double first_units;   /* that the second lap took */
};

static void tally_tick(struct hour *hour, const struct lab_lead *lead, uint64_t lap, int phase)
{
    const dpt_wrench *now = &lead->lead.force.wrench, *was = &lead->lead.last.wrench;
    double shift[3], turn[3], off[3];
    force_lead_motion(&lead->lead, shift, turn);
    for (int k = 0; k < 3; k++) {
        hour->work +=
            0.5 * (now->force[k] + was->force[k]) * shift[k] + 0.5 * (now->torque[k] + was->torque[k]) * turn[k];
        if (lap == 1)
            hour->force[phase][k] = now->force[k];
        off[k] = now->force[k] - hour->force[phase][k];
    }
    if (lap > 1)
        hour->drift = fmax(hour->drift, vec3_length(off));
    hour->energy = fmax(hour->energy, lead->lead.force.energy);
    hour->units += lead->work;
}

static void go_round(struct hour *hour, struct lab_lead *lead, const struct place *place, uint64_t laps)
{
    *hour = (struct hour){ .given_max = -HUGE_VAL };
    aim_on_lap(lead, place, 0);
    lab_lead_start(lead);
    for (uint64_t lap = 0; lap < laps; lap++) {
        hour->work = hour->units = 0.0;
        for (int phase = 0; phase < LAP; phase++) {
            aim_on_lap(lead, place, phase + 1);
            lab_lead_step(lead);
            tally_tick(hour, lead, lap, phase);
        }
        if (lap > 0)
            hour->given_max = fmax(hour->given_max, hour->work);
        if (lap == 1)
            hour->first_units = hour->units;
    }
}

static void note_hour(struct lab *lab, int method, const struct lab_lead *lead, const struct hour *hour)
{
    const char *name = lab_method_name(method);
    lab_note(lab, name, "ticks", (double)lead->tally.ticks, "");
    lab_at_most(lab, name, "drift of the force at the same phase, of its peak",
                100.0 * hour->drift / lead->tally.largest, "%", 1.0);
    if (method != LAB_POINT)
        lab_at_most(lab, name, "most energy given in a lap, of its range", 100.0 * hour->given_max / hour->energy, "%",
                    0.1);
    lab_at_most(lab, name, "work of the last lap, of the second one", hour->units / hour->first_units, "", 1.01);
    lab_tally_note(lab, method, &lead->tally);
}

static void run_hour(struct lab *lab)
{
    struct lab_mesh mesh;
    if (!lab_mesh_shape(lab, &mesh, "liver", 10000))
        return;
    for (int method = 0; method < LAB_METHODS; method++) {
        const struct lab_lead_def def = { .method = method, .meshes = { mesh.mesh } };
        const uint64_t laps = lab_share(lab, method == LAB_PROXY ? 3600000 / LAP : 60000 / LAP);
        struct lab_lead lead;
        struct place place;
        struct hour hour;
        if (lab_lead_open(lab, &lead, &def)) {
            lead.def.mesh = mesh.mesh;
            force_lead_place(&lead.lead, &place);
            go_round(&hour, &lead, &place, laps > 3 ? laps : 3);
            note_hour(lab, method, &lead, &hour);
        }
        lab_lead_close(&lead);
    }
    lab_mesh_close(&mesh);
}

const struct lab_case hour_case = {
    .name = "hour",
    .title = "An hour of the same motion",
    .method = "A tool goes round the same path again and again: from the open 2 mm into a liver, along "
              "it, tilting, and out, in 2 s. The proxy does so for an hour at 1 kHz, the others for a "
              "minute. Each lap is compared with the second one, tick by tick. The world has one block "
              "of memory and allocates nothing; the work of a lap shows whether its state grows.",
    .advice = "A world may run for days without a reset. Poses should come from the device itself and "
              "not from sums of its speeds, which drift.",
    .run = run_hour
};
