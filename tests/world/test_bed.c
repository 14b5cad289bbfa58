/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The bed: its wrench is the gradient of the energy that it reports, on a plane both are closed forms, and a tool that is
 * split into pieces feels the same. Differences of the energy share the library's integrals with the wrench: they cannot
 * judge those (test_contact_integrals does).
 */
#include "lib/rig.h"
#include "lib/solid.h"

#define STIFFNESS 500.0
#define TOP       0.04 /* of the box of `dynpoint make` */

enum { SEGMENTS = 8 };

static void bed_open(struct rig *bed, const dpt_mesh *mesh, const dpt_segment *segments, uint32_t count)
{
    dpt_world_def def = rig_def(DPT_LAW_BED);
    def.stiffness = STIFFNESS;
    rig_open(bed, &def, mesh, segments, count);
}

/* What is felt at a pose, without a past. */
static void feel(struct rig *bed, const dpt_pose *pose)
{
    bed->device = *pose;
    rig_place(bed);
}

/* Turned about its origin by a small rotation vector. */
static dpt_pose moved(const dpt_pose *from, const double shift[3], const double turn[3])
{
    dpt_pose to = *from;
    const double by[4] = { 1, turn[0] / 2, turn[1] / 2, turn[2] / 2 };
    for (int k = 0; k < 3; k++)
        to.position[k] += shift[k];
    pose_turn_by(&to, by);
    return to;
}

/* Closed forms of a plane: a lying tool has K for its line and K / 2 for each end, an upright one its lower end and its line. */
static void on_a_plane_it_is_a_closed_form(void)
{
    const double L = 0.06, r = 0.002, depth = 0.0015;
    const dpt_segment lying = { { -L / 2, 0, 0 }, { L / 2, 0, 0 }, r };
    const dpt_segment upright = { { 0, 0, 0 }, { 0, 0, L }, r };
    struct solid box;
    struct rig bed;
    dpt_pose pose = DPT_POSE_IDENTITY;
    if (!solid_from_shape(&box, "box", 300))
        return;
    pose.position[2] = TOP + r - depth;
    bed_open(&bed, box.mesh, &lying, 1);
    feel(&bed, &pose);
    const double flat = 2 * STIFFNESS * depth;
    CHECK(fabs(bed.force.wrench.force[2] / flat - 1) < 1e-6, "%g N lying, not %g", bed.force.wrench.force[2], flat);
    /* The top is a float: off by 1e-9 m, which counts twice in a square. */
    CHECK(fabs(bed.force.energy / (0.5 * flat * depth) - 1) < 1e-5, "energy %g", bed.force.energy);
    rig_close(&bed);
    bed_open(&bed, box.mesh, &upright, 1);
    feel(&bed, &pose);
    const double tip = STIFFNESS / 2 * depth + STIFFNESS / L * depth * depth / 2;
    CHECK(fabs(bed.force.wrench.force[2] / tip - 1) < 1e-3, "%g N upright, not %g", bed.force.wrench.force[2], tip);
    rig_close(&bed);
    solid_close(&box);
}

/* The same tool in 1 to 8 pieces, tilted. */
static void pieces_feel_as_the_whole(void)
{
    struct solid box;
    dpt_force_info whole = { .size = sizeof whole };
    if (!solid_from_shape(&box, "box", 300))
        return;
    for (uint32_t count = 1; count <= SEGMENTS; count++) {
        dpt_segment pieces[SEGMENTS];
        dpt_pose pose = DPT_POSE_IDENTITY;
        struct rig bed;
        for (uint32_t i = 0; i < count; i++) {
            const double from = -0.03 + 0.06 * i / count, to = -0.03 + 0.06 * (i + 1) / count;
            pieces[i] = (dpt_segment){ { from, 0, 0 }, { to, 0, 0 }, 0.002 };
        }
        pose.position[2] = TOP + 0.002;
        pose.orientation[0] = cos(0.01);
        pose.orientation[2] = sin(0.01);
        bed_open(&bed, box.mesh, pieces, count);
        feel(&bed, &pose);
        if (count == 1)
            whole = bed.force;
        CHECK(bed.force.wrench.force[2] > 0.1, "no force");
        for (int k = 0; k < 3; k++)
            CHECK(fabs(bed.force.wrench.force[k] - whole.wrench.force[k]) < 1e-9 &&
                      fabs(bed.force.wrench.torque[k] - whole.wrench.torque[k]) < 1e-9,
                  "%u pieces: force off by %g, torque by %g", count, bed.force.wrench.force[k] - whole.wrench.force[k],
                  bed.force.wrench.torque[k] - whole.wrench.torque[k]);
        rig_close(&bed);
    }
    solid_close(&box);
}

/* A second box beside the first, their tops flush. */
static void flush_open(struct rig *bed, const struct solid *box, const dpt_segment *tool, double width)
{
    dpt_world_def def = rig_def(DPT_LAW_BED);
    dpt_pose beside = DPT_POSE_IDENTITY;
    dpt_body second;
    beside.position[0] = width;
    def.stiffness = STIFFNESS;
    def.max_bodies = 2;
    rig_open(bed, &def, box->mesh, tool, 1);
    CHECK(dpt_body_add(bed->world, box->mesh, &beside, &second) == DPT_OK, "no second body");
}

/*
 * Each body pushes for itself: the figures of docs/algorithms/force.md. A tool that lies along the seam of two flush bodies is
 * pushed twice, beside it aside too, and beyond its radius by one; an axis in the seam, below the tops, not at all.
 */
static void flush_bodies_push_each(void)
{
    const double L = 0.03, r = 0.002, flat = 2 * STIFFNESS;
    static const struct {
        double depth, off, up, aside; /* m; radii from the seam; force, of that of one body */
    } places[] = { { 0.0005, 0.0, 2.0, 0.0 },  { 0.0005, 0.5, 1.33, 0.22 }, { 0.0005, 1.1, 1.0, 0.0 },
                   { 0.0005, -1.1, 1.0, 0.0 }, { 0.0015, 0.0, 2.0, 0.0 },   { 0.0025, 0.0, 0.0, 0.0 } };
    const dpt_segment along = { { 0, -L / 2, 0 }, { 0, L / 2, 0 }, r };
    dpt_mesh_info info = { .size = sizeof info };
    struct solid box;
    struct rig bed;
    if (!solid_from_shape(&box, "box", 300))
        return;
    dpt_mesh_get_info(box.mesh, &info);
    flush_open(&bed, &box, &along, info.box_max[0] - info.box_min[0]);
    for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
        dpt_pose pose = DPT_POSE_IDENTITY;
        pose.position[0] = info.box_max[0] + places[i].off * r;
        pose.position[2] = TOP + r - places[i].depth;
        feel(&bed, &pose);
        const double *force = bed.force.wrench.force, one = flat * places[i].depth;
        CHECK(fabs(force[2] / one - places[i].up) < 0.005 && fabs(force[0] / one - places[i].aside) < 0.005,
              "%g m deep, %g radii from the seam: %g and aside %g times the force of one body", places[i].depth,
              places[i].off, force[2] / one, force[0] / one);
    }
    rig_close(&bed);
    solid_close(&box);
}

/* Force and torque against differences of the energy, of bent tools in several meshes. */
static void the_wrench_is_the_gradient(void)
{
    static const char *const shapes[] = { "sphere", "torus", "liver" };
    static const uint64_t triangles[] = { 1280, 4096, 5000 };
    const dpt_segment tool[3] = { { { -0.03, 0, 0 }, { 0, 0, 0.01 }, 0.002 },
                                  { { 0, 0, 0.01 }, { 0.03, 0, 0 }, 0.003 },
                                  { { 0, 0, 0.01 }, { 0, 0.02, 0.02 }, 0.001 } };
    for (size_t m = 0; m < 3; m++) {
        struct solid solid;
        struct rig bed;
        uint64_t seed = 7 + m;
        uint32_t acts = 0, near = 0;
        if (!solid_from_shape(&solid, shapes[m], triangles[m]))
            continue;
        bed_open(&bed, solid.mesh, tool, 3);
        for (int i = 0; i < 60; i++) {
            struct slide slide;
            dpt_pose pose = DPT_POSE_IDENTITY;
            const double h = 2e-5;
            double axis[3], worst = 0, size = 0;
            slide_begin(&slide, &solid, 100 * m + (uint64_t)i, 0.02, 0.002);
            random_unit(&seed, axis);
            for (int k = 0; k < 3; k++) {
                pose.position[k] = slide.ends[k] * 0.97;
                pose.orientation[1 + k] = 0.5 * axis[k];
            }
            pose.orientation[0] = sqrt(0.75);
            feel(&bed, &pose);
            const dpt_wrench wrench = bed.force.wrench;
            if (bed.force.reason != DPT_FORCE_ACTS)
                continue;
            acts++;
            for (int d = 0; d < 6; d++) {
                double shift[3] = { 0 }, turn[3] = { 0 }, energy[2];
                for (int sign = 0; sign < 2; sign++) {
                    const double by = sign ? h : -h;
                    (d < 3 ? shift : turn)[d % 3] = d < 3 ? by : by / 0.03;
                    const dpt_pose at = moved(&pose, shift, turn);
                    feel(&bed, &at);
                    energy[sign] = bed.force.energy;
                }
                const double slope = -(energy[1] - energy[0]) / (2 * (d < 3 ? h : h / 0.03));
                const double felt = d < 3 ? wrench.force[d] : wrench.torque[d - 3];
                const double scale = d < 3 ? 1 : 0.03;
                worst = fmax(worst, fabs(slope - felt) / scale);
                size = fmax(size, fabs(felt) / scale);
            }
            near += worst < 0.03 * size;
        }
        /* Where ways out meet, a difference tells nothing: some poses may be off. */
        CHECK(acts > 20 && near > acts * 85 / 100, "%s: the gradient fits at %u of %u", shapes[m], near, acts);
        rig_close(&bed);
        solid_close(&solid);
    }
}

int main(void)
{
    TEST(on_a_plane_it_is_a_closed_form);
    TEST(pieces_feel_as_the_whole);
    TEST(flush_bodies_push_each);
    TEST(the_wrench_is_the_gradient);
    return check_report();
}
