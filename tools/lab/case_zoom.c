/* SPDX-License-Identifier: BSD-3-Clause */
/* With a zoom the hand feels another stiffness than the scene has. */
#include <math.h>

#include "dynpoint/coupling.h"
#include "lab/hand_sway.h"
#include "lab/lab_cases.h"

enum { ZOOMS = 4, MESHES = 2 };

static const double zooms[ZOOMS] = { 4.0, 0.5, 2.0, 1.0 };

#define MASS    0.1
#define DAMPING 0.5
#define DELAY   1.0
#define SECONDS 2.5

struct worst {
    double felt;     /* share that the hand's stiffness is off zoom and force scale times the scene's */
    double growth;   /* of b / 2m, with the coupling that was chosen */
    double unscaled; /* with that of zoom 1, where the zoom is above the margin of 1.5; the least */
};

/* A tip on a device without torque. */
static void try_zoom(const struct hand_mesh *mesh, int is_plane, double zoom, struct worst *worst)
{
    struct hand_place place;
    struct hand_loop loop = { .device = hand_device_even(MASS, DAMPING, DELAY, 0.0),
                              .place = &place,
                              .tool = { 0.06, 0.002, 0.5 },
                              .method = LAB_PROXY,
                              .zoom = zoom };
    struct hand_loop plain = loop;
    struct hand_law law;
    uint64_t seed = 3;
    plain.zoom = 1.0;
    const double chosen = hand_loop_choose(&loop, 1.5).stiffness;
    const double unscaled = hand_loop_choose(&plain, 1.5).stiffness;
    loop.stiffness = chosen;
    hand_place_middle(mesh, &place);
    if (!hand_loop_open(&loop) ||
        !(is_plane ? hand_loop_lower(&loop, 0.2) : hand_loop_seek(&loop, mesh, &seed, 0.2, &place))) {
        worst->growth = NAN;
        hand_loop_close(&loop);
        return;
    }
    hand_law_find(&loop, &law);
    hand_hold(&loop, &law, zoom * fmax(chosen, unscaled));
    struct hand_search search = hand_search_for_law(&loop, &law, zoom * chosen, SECONDS);
    search.tap.stiffness = law.stiffness[0];
    worst->felt = hand_greater(worst->felt, fabs(law.stiffness[0] / (zoom * chosen) - 1.0));
    const double unit = DAMPING / (2.0 * MASS);
    worst->growth = hand_greater(worst->growth, hand_sway(&loop, &search.tap).growth / unit);
    if (zoom > 1.5) {
        hand_loop_stiffen(&loop, unscaled, 0.0, 0.0);
        search.tap.stiffness = zoom * unscaled;
        worst->unscaled = hand_smaller(worst->unscaled, hand_sway(&loop, &search.tap).growth / unit);
    }
    loop.force_scale = 1.0 / zoom;
    hand_loop_return(&loop);
    hand_law_find(&loop, &law);
    worst->felt = hand_greater(worst->felt, fabs(law.stiffness[0] / loop.stiffness - 1.0));
    hand_loop_close(&loop);
}

static void run(struct lab *lab)
{
    static const char *const names[MESHES] = { "box", "liver" };
    struct worst worst = { 0.0, -HUGE_VAL, HUGE_VAL };
    const uint64_t count = lab_share(lab, ZOOMS * MESHES);
    for (int m = 0; m < MESHES; m++) {
        struct hand_mesh mesh;
        if (!hand_mesh_open(&mesh, names[m], m ? 10000 : 12, m ? 1.0 : 3.0)) {
            lab->is_out_of_memory = 1;
            return;
        }
        for (uint64_t i = (uint64_t)m; i < (count > 2 ? count : 2); i += MESHES)
            try_zoom(&mesh, m == 0, zooms[i / MESHES], &worst);
        hand_mesh_close(&mesh);
    }
    lab_at_most(lab, "proxy", "largest share that the hand feels beside zoom times scale times stiffness", worst.felt,
                "", 0.01);
    lab_at_most(lab, "proxy", "fastest growth with the coupling that was chosen for the zoom", worst.growth, "b/2m",
                0.0);
    lab_at_least(lab, "proxy", "least growth at zooms of 2 and 4 with that of zoom 1", worst.unscaled, "b/2m", 0.0);
}

const struct lab_case zoom_case = {
    "zoom", "Zoom",
    "One metre of the hand is 0.5 to 4 m of the scene, and forces are not scaled, or by 1 / zoom. "
    "The hand feels the stiffness times zoom and scale. The stiffness at the hand is measured by "
    "differences, on a plane and on a liver. A tap has to die away at the coupling that "
    "dpt_coupling_for_device chooses for the zoom, and grows at zooms of 2 and 4 if the coupling "
    "is the one for a zoom of 1.",
    "Choose the coupling again whenever zoom or force scale change, and tell both to "
    "dpt_coupling_for_device. A scale of forces of 1 / zoom keeps the stiffness at the hand.",
    run
};
