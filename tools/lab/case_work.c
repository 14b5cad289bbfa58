/* SPDX-License-Identifier: BSD-3-Clause */
/* Energy: net work over closed paths, and an hour of the same motion. */
#include <math.h>

#include "base/vec3.h"
#include "lab/lab_lead.h"
#include "lab/lab_mesh.h"

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
        worst->most_emitted = fmax(worst->most_emitted, result.most_emitted);
        worst->most_lost = fmax(worst->most_lost, result.most_lost);
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
        lab_at_most(lab, name, "most energy given on a closed path, of its range", 100.0 * result->most_emitted, "%",
                    0.1);
        lab_at_most(lab, name, "closed paths that give more than 0.1 % of it",
                    lab_per_cent(result->emitting, result->paths), "%", 0.0);
        if (method == LAB_PROXY)
            lab_at_most(lab, name, "most energy lost on a path without a fold", 100.0 * result->most_lost, "%", 5.0);
        else
            lab_note(lab, name, "most energy lost on a path without a fold", 100.0 * result->most_lost, "%");
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
    double most_given;    /* J, of a lap */
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
    *hour = (struct hour){ .most_given = -HUGE_VAL };
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
            hour->most_given = fmax(hour->most_given, hour->work);
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
        lab_at_most(lab, name, "most energy given in a lap, of its range", 100.0 * hour->most_given / hour->energy, "%",
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
