/* SPDX-License-Identifier: BSD-3-Clause */
/* A needle over spikes, and one held through an organ: the trials of `dynpoint force-test`, method by method. */
#include "lab/lab_lead.h"
#include "lab/lab_mesh.h"

static void note_push(struct lab *lab, int method, const struct push_result *result)
{
    const char *name = lab_method_name(method);
    lab_at_most(lab, name, "ticks that turn the force by over 30 degrees, folds apart",
                lab_per_cent(result->turns, result->ticks), "%", 0.0);
    lab_at_most(lab, name, "ticks that reverse the force, by over 90 degrees",
                lab_per_cent(result->reversals, result->ticks), "%", 0.0);
    lab_at_most(lab, name, "largest |dW| in a tick, of K (3 |motion| + 1 mm)", result->largest_share, "", 1.0);
    lab_note(lab, name, "largest change of force in a tick", result->largest_jump, "N");
    lab_note(lab, name, "ticks with a force", (double)result->ticks, "");
    if (!lab_has_proxy(method))
        return;
    lab_at_most(lab, name, "ticks whose proxy is in the body", (double)result->penetrations, "", 0.0);
    lab_note(lab, name, "ticks with a fold", lab_per_cent(result->folds, result->ticks), "%");
}

static void push_over(struct lab *lab, const char *shape, uint64_t triangles, uint64_t places,
                      int (*trial)(const struct force_trial_def *, struct push_result *))
{
    struct lab_mesh mesh;
    if (!lab_mesh_shape(lab, &mesh, shape, triangles))
        return;
    for (int method = 0; method < LAB_METHODS; method++) {
        struct force_trial_def def = lab_trial_def(method, mesh.mesh);
        struct push_result result;
        def.places = lab_share(lab, places);
        if (trial(&def, &result))
            note_push(lab, method, &result);
        else
            lab->is_out_of_memory = 1;
    }
    lab_mesh_close(&mesh);
}

static void run_spikes(struct lab *lab)
{
    push_over(lab, "star", 20480, 200, force_trial_push);
}

const struct lab_case spikes_case = {
    .name = "spikes",
    .title = "Across spikes and deep concavities",
    .method = "A needle of 100 mm is pushed 5 mm into a star of 48 spikes at random places, upright to "
              "lying, and then led 40 mm across its spikes at 0.1 m/s with a tremor of 0.2 mm. The ball "
              "is this library's proxy of one point at the needle's tip, as point-based toolkits have "
              "it; it is not their code. Where a proxy leaves a spike it reports a fold, and its force may turn there.",
    .advice = "Use the proxy. Between spikes the nearest way out changes from one tick to the next, so "
              "a law without a memory of where the tool came from jumps. A fold is a real event: the "
              "tool has slipped over a spike. Count folds with dpt_force_info if a scene needs to know.",
    .run = run_spikes
};

static void run_medial(struct lab *lab)
{
    push_over(lab, "liver", 20000, 100, force_trial_through);
}

const struct lab_case medial_case = {
    .name = "medial",
    .title = "A needle held through an organ",
    .method = "A needle that is longer than a liver is pushed in sideways by 27 mm, tip first to lying, "
              "and held there with a tremor of 0.2 mm. Somewhere along its axis two ways out are "
              "equally long. The ball is this library's proxy of one point at the tip.",
    .advice = "Never use the push at the deepest point where a tool can go through a thick body. No "
              "stiffness, damping or filter cures its reversals; a filter slow enough to hide them "
              "makes the wall soft and late. The bed turns seldom. The proxy turns only where it reports a fold.",
    .run = run_medial
};
