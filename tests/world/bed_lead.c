/* SPDX-License-Identifier: BSD-3-Clause */
#include "world/bed_lead.h"

#define TURN  6.283185307179586
#define CLEAR 0.003 /* above the place, at the path's beginning */

void bed_path_make(struct bed_path *path, const struct solid *solid, uint64_t seed)
{
    const float *c = solid->corners + 9 * (random_bits(&seed) % (uint64_t)solid->place.triangles);
    double u[3], v[3];
    for (int k = 0; k < 3; k++) {
        u[k] = (double)c[3 + k] - (double)c[k];
        v[k] = (double)c[6 + k] - (double)c[k];
        path->place[k] = ((double)c[k] + (double)c[3 + k] + (double)c[6 + k]) / 3;
    }
    cross3(u, v, path->out);
    unit3(path->out);
    random_unit(&seed, u);
    cross3(path->out, u, path->side);
    unit3(path->side);
    cross3(path->out, path->side, path->other);
    path->depth = random_in(&seed, 0.002, 0.01);
    path->wide = random_in(&seed, 0, 0.006);
    path->lean = random_in(&seed, 0, TURN / 4);
    path->tilt = random_in(&seed, 0, 0.3);
    path->phase = random_in(&seed, 0, TURN);
}

void bed_path_at(const struct bed_path *path, double t, dpt_pose *pose, double ends[6])
{
    const double angle = TURN * t, *n = path->out;
    const double mean = cos(path->lean) * n[0] + sin(path->lean) * path->side[0];
    const double sway = path->tilt * (sin(angle + path->phase) - sin(path->phase));
    const double height =
        BED_RADIUS + CLEAR - 0.5 * (path->depth + CLEAR) * (1 - cos(angle)) + 0.5 * BED_LENGTH * cos(path->lean);
    double axis[3];
    for (int k = 0; k < 3; k++) {
        axis[k] = cos(path->lean + sway) * n[k] + sin(path->lean + sway) * path->side[k] +
                  path->tilt * sin(2 * angle) * path->other[k];
        axis[k] *= mean < 0 ? -1 : 1;
        pose->position[k] = path->place[k] + height * n[k] +
                            path->wide * (sin(angle) * path->side[k] + sin(2 * angle + path->phase) * path->other[k]);
    }
    unit3(axis);
    /* The least turn from x; the axis never points against it. */
    const double w = 1 + axis[0], size = sqrt(w * w + axis[1] * axis[1] + axis[2] * axis[2]);
    pose->orientation[0] = w / size;
    pose->orientation[1] = 0;
    pose->orientation[2] = -axis[2] / size;
    pose->orientation[3] = axis[1] / size;
    for (int k = 0; k < 3; k++) {
        ends[k] = pose->position[k] - 0.5 * BED_LENGTH * axis[k];
        ends[3 + k] = pose->position[k] + 0.5 * BED_LENGTH * axis[k];
    }
}

uint32_t bed_path_ticks(const struct bed_path *path, double step)
{
    enum { PARTS = 400 };
    double last[6], ends[6], farthest = 0;
    dpt_pose pose;
    bed_path_at(path, 0, &pose, last);
    for (int i = 1; i <= PARTS; i++) {
        bed_path_at(path, (double)i / PARTS, &pose, ends);
        farthest = fmax(farthest, ends_moved(last, ends));
        memcpy(last, ends, sizeof last);
    }
    return (uint32_t)(PARTS * farthest * 1.02 / step) + 1;
}

int bed_lead_open(struct rig *rig, const dpt_mesh *mesh)
{
    const dpt_segment segment = { { -BED_LENGTH / 2, 0, 0 }, { BED_LENGTH / 2, 0, 0 }, BED_RADIUS };
    dpt_world_def def = rig_def(DPT_LAW_BED);
    def.margin = 0.001;
    def.stiffness = BED_STIFFNESS;
    return rig_open(rig, &def, mesh, &segment, 1);
}

int bed_lead_begin(struct rig *rig, const struct solid *solid, const struct bed_path *path)
{
    dpt_hit hit = DPT_HIT_INIT;
    double ends[6];
    bed_path_at(path, 0, &rig->device, ends);
    dpt_query_segments(solid->mesh, NULL, ends, NULL, 1, &hit, NULL);
    if (!(hit.gap > BED_RADIUS))
        return 0;
    rig_place(rig);
    return rig->force.reason == DPT_FORCE_FREE;
}

struct bed_felt bed_lead_to(struct rig *rig, const struct bed_path *path, double t)
{
    double ends[6];
    struct bed_felt felt;
    bed_path_at(path, t, &rig->device, ends);
    rig_step(rig);
    memcpy(felt.force, rig->force.wrench.force, sizeof felt.force);
    memcpy(felt.torque, rig->force.wrench.torque, sizeof felt.torque);
    felt.energy = rig->force.energy;
    return felt;
}

/* So much stiffness at s, at a point that the query tells of. */
static void add_push(struct bed_truth *truth, const double ends[6], double s, double stiffness, const dpt_hit *hit)
{
    const double w = BED_RADIUS - hit->gap;
    double way[3], lever[3], turn[3];
    truth->deepest = fmax(truth->deepest, w);
    if (hit->contact == DPT_CONTACT_UNKNOWN)
        truth->is_known = 0;
    if (!(w > 0))
        return;
    for (int k = 0; k < 3; k++) {
        way[k] = (hit->gap < 0 ? -1 : 1) * (hit->p[k] - hit->q[k]);
        lever[k] = (s - 0.5) * (ends[3 + k] - ends[k]);
    }
    unit3(way);
    cross3(lever, way, turn);
    for (int k = 0; k < 3; k++) {
        truth->felt.force[k] += stiffness * w * way[k];
        truth->felt.torque[k] += stiffness * w * turn[k];
    }
    truth->felt.energy += 0.5 * stiffness * w * w;
}

static void query_points(const dpt_mesh *mesh, const double ends[6], const double *s, size_t count, dpt_hit *hits)
{
    static double points[BED_POINTS + 2][6];
    for (size_t i = 0; i < count; i++) {
        point_at(ends, s[i], points[i]);
        memcpy(points[i] + 3, points[i], 3 * sizeof *points[i]);
    }
    hits[0].size = sizeof *hits;
    const dpt_result result = dpt_query_segments(mesh, NULL, points[0], NULL, count, hits, NULL);
    CHECK(result == DPT_OK, "%s", dpt_result_name(result));
}

void bed_truth_at(const dpt_mesh *mesh, const double ends[6], uint32_t points, int skips, struct bed_truth *truth)
{
    enum { GROUP = 16 };
    static dpt_hit hits[BED_POINTS + 2], middle[BED_POINTS / GROUP];
    static double s[BED_POINTS + 2];
    const uint32_t groups = points / GROUP;
    uint32_t count = 2;
    *truth = (struct bed_truth){ .is_known = 1 };
    for (uint32_t g = 0; g < groups; g++)
        s[g] = (g + 0.5) / groups;
    if (skips)
        query_points(mesh, ends, s, groups, middle);
    s[0] = 0;
    s[1] = 1;
    for (uint32_t g = 0; g < groups; g++) {
        if (skips && middle[g].gap - BED_RADIUS > 0.5 * BED_LENGTH / groups)
            continue;
        for (uint32_t i = g * GROUP; i < (g + 1) * GROUP; i++)
            s[count++] = (i + 0.5) / points;
    }
    query_points(mesh, ends, s, count, hits);
    for (uint32_t i = 0; i < count; i++)
        add_push(truth, ends, s[i], i < 2 ? BED_STIFFNESS / 2 : BED_STIFFNESS / points, &hits[i]);
}
