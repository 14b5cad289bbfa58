/* SPDX-License-Identifier: BSD-3-Clause */
/* The paper's response: a pin is dragged over a membrane that is moved out of its way. How smooth is its force? */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/sincos.h"
#include "lab/hand_loop.h"
#include "lab/lab.h"

enum { MESHES = 4, RESPONSES = 2, SETTLING = 400, TICKS = 2048, FEW = 512, STRIP = 4096 };

#define RADIUS    0.005
#define LENGTH    0.08
#define DEPTH     5e-3
#define SPEED     0.02
#define STIFFNESS 500.0
#define CUT       100.0 /* Hz */

/* The membrane has no mass: only the tool moves it. */
static const struct tissue_matter matter = { 1e5, 30.0, 5e3, 0.0 };

/* Cells across a membrane of 0.1 m: edges of a half, the whole, 0.7 and 1.4 of the pin's radius. */
static const uint32_t cells[MESHES] = { 40, 20, 28, 14 };
#define SIDE 0.1

/* Which triangles are moved out of the pin. */
enum response { ALONE, ALL };

/* Of a drag: the largest jump in a tick, and root of the mean square above 100 Hz, of the mean force; and N. */
struct jitter {
    double jump, noise, mean;
};

struct drag {
    struct scene_stage stage;
    struct tissue tissue;
    dpt_overlap *strip;
    double (*force)[3]; /* of so many ticks */
    int ticks;
};

static int open_drag(struct drag *drag, const struct hand_mesh *mesh, int method, enum response response)
{
    const dpt_segment pin = { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, LENGTH }, RADIUS };
    dpt_tool_settings settings = { .size = sizeof settings };
    dpt_world_def def;
    dpt_world_def_init(&def);
    def.law = method == LAB_POINT ? DPT_LAW_POINT : DPT_LAW_BED;
    def.strip = DPT_STRIP_KIND_SHADOW;
    def.strip_width = RADIUS;
    def.strip_capacity = STRIP;
    def.max_contacts = LAB_CONTACTS;
    def.max_bodies = def.max_tools = def.max_segments = 1;
    *drag = (struct drag){ .tissue = { .mesh = mesh->mesh, .matter = matter, .ticks = 1 } };
    drag->tissue.response = response == ALL ? DPT_RESPONSE_DISPLACE : DPT_RESPONSE_LOAD;
    drag->tissue.is_led = 1;
    drag->strip = malloc(STRIP * sizeof *drag->strip);
    drag->force = malloc(TICKS * sizeof *drag->force);
    if (!drag->strip || !drag->force || scene_stage_open(&drag->stage, &def) != DPT_OK ||
        !tissue_open(&drag->tissue, drag->stage.world) ||
        scene_stage_add_tool(&drag->stage, &pin, 1, NULL, 0) != DPT_OK)
        return 0;
    dpt_tool_get_settings(drag->stage.world, drag->stage.tool, &settings);
    settings.stiffness = STIFFNESS;
    return dpt_tool_set_settings(drag->stage.world, drag->stage.tool, &settings) == DPT_OK;
}

static void close_drag(struct drag *drag)
{
    tissue_close(&drag->tissue);
    scene_stage_close(&drag->stage);
    free(drag->strip);
    free(drag->force);
}

/* Move the nearest triangle alone out of the pin, straight down, as a method without a strip does. */
static void move_nearest(struct drag *drag)
{
    const dpt_overlap *nearest = NULL;
    const uint32_t *corners, *numbers;
    uint32_t count, flags, triangles;
    drag->strip[0].size = sizeof *drag->strip;
    dpt_tool_get_strip(drag->stage.world, drag->stage.tool, 0, drag->strip, STRIP, &count, &flags);
    for (uint32_t i = 0; i < count && i < STRIP; i++)
        if (!nearest || drag->strip[i].distance < nearest->distance)
            nearest = &drag->strip[i];
    if (!nearest || !(nearest->overlap > 0.0))
        return;
    dpt_mesh_get_triangles(drag->tissue.mesh, &corners, &numbers, &triangles);
    for (uint32_t t = 0; t < triangles; t++)
        for (uint32_t k = 0; k < 3 && numbers[t] == nearest->triangle; k++)
            tissue_move(&drag->tissue, corners[3 * t + k], (double[3]){ 0.0, 0.0, -nearest->overlap });
}

/* The pin sinks to its depth, and then goes across, at an angle to the membrane's lines. */
static void place_pin(struct drag *drag, int tick)
{
    const double along = tick > SETTLING ? SPEED * TISSUE_TICK * (tick - SETTLING) : 0.0;
    const double sunk = fmin(2.0 * tick / SETTLING, 1.0);
    const dpt_pose pose = { { -0.02 + 0.96 * along, -0.006 + 0.28 * along, RADIUS + 1e-3 - (DEPTH + 1e-3) * sunk },
                            { 1.0, 0.0, 0.0, 0.0 } };
    if (tick)
        dpt_tool_set_pose(drag->stage.world, drag->stage.tool, &pose);
    else
        dpt_tool_teleport(drag->stage.world, drag->stage.tool, &pose);
}

static void run_drag(struct drag *drag, enum response response)
{
    for (int tick = 0; tick < SETTLING + drag->ticks; tick++) {
        dpt_wrench wrench;
        place_pin(drag, tick);
        tissue_advance(&drag->tissue);
        dpt_world_step(drag->stage.world, TISSUE_TICK, NULL);
        dpt_tool_get_wrench(drag->stage.world, drag->stage.tool, &wrench);
        if (response == ALONE)
            move_nearest(drag);
        if (tick >= SETTLING)
            memcpy(drag->force[tick - SETTLING], wrench.force, sizeof wrench.force);
    }
}

/* N^2: of one component's change about its mean, above the cut; through a window of Hann. */
static double power_above(const struct drag *drag, int k)
{
    static double windowed[TICKS], sine[TICKS], cosine[TICKS];
    const int bins = (int)(CUT * TISSUE_TICK * drag->ticks);
    double mean = 0.0, weight = 0.0, power = 0.0, low = 0.0;
    for (int i = 0; i < drag->ticks; i++) {
        turn_sincos((double)i / drag->ticks, &sine[i], &cosine[i]);
        mean += drag->force[i][k] / drag->ticks;
    }
    for (int i = 0; i < drag->ticks; i++) {
        const double hann = 0.5 * (1.0 - cosine[i]);
        windowed[i] = hann * (drag->force[i][k] - mean);
        power += windowed[i] * windowed[i];
        weight += hann * hann;
    }
    for (int b = 0; b <= bins; b++) {
        double real = 0.0, imaginary = 0.0;
        for (int i = 0; i < drag->ticks; i++) {
            const int turn = (int)((long)i * b % drag->ticks);
            real += windowed[i] * cosine[turn];
            imaginary += windowed[i] * sine[turn];
        }
        low += (b ? 2.0 : 1.0) * (real * real + imaginary * imaginary) / drag->ticks;
    }
    return fmax(power - low, 0.0) / weight;
}

static struct jitter jitter_of(const struct drag *drag)
{
    struct jitter jitter = { 0.0, 0.0, 0.0 };
    double power = 0.0;
    for (int i = 0; i < drag->ticks; i++) {
        double size = 0.0, jump = 0.0;
        for (int k = 0; k < 3; k++) {
            const double by = i ? drag->force[i][k] - drag->force[i - 1][k] : 0.0;
            size += drag->force[i][k] * drag->force[i][k];
            jump += by * by;
        }
        jitter.mean += sqrt(size) / drag->ticks;
        jitter.jump = fmax(jitter.jump, sqrt(jump));
    }
    for (int k = 0; k < 3; k++)
        power += power_above(drag, k);
    jitter.jump /= jitter.mean;
    jitter.noise = sqrt(power) / jitter.mean;
    return jitter;
}

static struct jitter drag_pin(const struct hand_mesh *mesh, int method, enum response response, int ticks)
{
    struct jitter jitter = { NAN, NAN, NAN };
    struct drag drag;
    if (open_drag(&drag, mesh, method, response)) {
        drag.ticks = ticks;
        run_drag(&drag, response);
        if (!drag.tissue.has_failed)
            jitter = jitter_of(&drag);
    }
    close_drag(&drag);
    return jitter;
}

/* Figures of the mesh whose edges are half of the pin's radius, and of that whose edges are as long. */
static const struct words {
    const char *jump[RESPONSES], *noise[RESPONSES], *less_jump, *less_noise;
} words[2] = { { { "edges of r/2, nearest alone: largest jump, of the mean force",
                   "edges of r/2, strip: largest jump, of the mean force" },
                 { "edges of r/2, nearest alone: rms above 100 Hz, of the mean force",
                   "edges of r/2, strip: rms above 100 Hz, of the mean force" },
                 "edges of r/2: jump with the strip, of that with the nearest alone",
                 "edges of r/2: rms with the strip, of that with the nearest alone" },
               { { "edges of r, nearest alone: largest jump, of the mean force",
                   "edges of r, strip: largest jump, of the mean force" },
                 { "edges of r, nearest alone: rms above 100 Hz, of the mean force",
                   "edges of r, strip: rms above 100 Hz, of the mean force" },
                 "edges of r: jump with the strip, of that with the nearest alone",
                 "edges of r: rms with the strip, of that with the nearest alone" } };

static void try_mesh(struct lab *lab, int which, int method, struct jitter seen[RESPONSES])
{
    static const char *const names[RESPONSES] = { "nearest alone", "strip" };
    struct hand_mesh membrane = { .mesh = NULL };
    const uint64_t count = cells[which];
    const int ticks = lab->effort < 0.5 ? FEW : TICKS;
    if (!hand_mesh_open(&membrane, "membrane", 2 * count * count, 0.5)) {
        lab->is_out_of_memory = 1;
        return;
    }
    for (int response = 0; response < RESPONSES; response++) {
        seen[response] = drag_pin(&membrane, method, (enum response)response, ticks);
        if (method == LAB_POINT)
            lab_point_at(lab, "stability-displace", names[response], 1e3 * SIDE / (double)cells[which],
                         seen[response].noise);
    }
    hand_mesh_close(&membrane);
    if (which > 1)
        return;
    for (int response = 0; response < RESPONSES; response++) {
        lab_note(lab, lab_method_name(method), words[which].jump[response], seen[response].jump, "");
        lab_note(lab, lab_method_name(method), words[which].noise[response], seen[response].noise, "");
    }
}

/* The strip has to gain where the mesh is finer than the pin; where it is not, there is nothing to gain. */
static void run(struct lab *lab)
{
    const int due = (int)lab_share(lab, MESHES);
    struct jitter seen[MESHES][RESPONSES], bed[RESPONSES];
    for (int which = 0; which < due && !lab->is_out_of_memory; which++)
        try_mesh(lab, which, LAB_POINT, seen[which]);
    if (lab->is_out_of_memory)
        return;
    try_mesh(lab, 0, LAB_BED, bed);
    lab_at_most(lab, "strip", words[0].less_jump,
                hand_max(seen[0][ALL].jump / seen[0][ALONE].jump, bed[ALL].jump / bed[ALONE].jump), "", 0.9);
    lab_at_most(lab, "strip", words[0].less_noise,
                hand_max(seen[0][ALL].noise / seen[0][ALONE].noise, bed[ALL].noise / bed[ALONE].noise), "", 0.5);
    if (due < 2)
        return;
    lab_note(lab, "strip", words[1].less_jump, seen[1][ALL].jump / seen[1][ALONE].jump, "");
    lab_note(lab, "strip", words[1].less_noise, seen[1][ALL].noise / seen[1][ALONE].noise, "");
    lab_note(lab, "strip", "mean force at edges of r/2, of that at edges of r", seen[0][ALL].mean / seen[1][ALL].mean,
             "");
    lab_note(lab, "point", "nearest alone: mean force at edges of r/2, of that at edges of r",
             seen[0][ALONE].mean / seen[1][ALONE].mean, "");
}

const struct lab_case displace_case = {
    .name = "displace",
    .title = "A pin is dragged, and the surface moved out of its way",
    .method =
        "An upright pin of r = 5 mm is dragged 5 mm deep over a membrane at 20 mm/s, at 1 kHz, with the "
        "laws point and bed. After each step triangles are moved out of the pin: the nearest alone, "
        "done outside of the library as a method without a strip does it, or all of the strip "
        "(DPT_RESPONSE_DISPLACE). Then the membrane springs back for a tick. Told is the largest change "
        "of the force in a tick, and the root of the mean square of what it has above 100 Hz. The strip "
        "has to take away half of that, and a tenth of the largest jump, where edges are half as long "
        "as the radius. Where they are as long, a pin touches one triangle at a time, and there is nothing to gain.",
    .advice = "Displace with triangles of at most half of the tool's radius, or better hand loads to a physics: "
              "the force of displaced triangles is that of what springs back in a tick. It jumps wherever the "
              "pin leaves a triangle, and is larger on a finer mesh. With edges longer than the radius the "
              "strip makes more noise than the nearest triangle alone.",
    .run = run
};
