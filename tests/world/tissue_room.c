/* SPDX-License-Identifier: BSD-3-Clause */
#include "world/tissue_room.h"

/* How often it gives way, and by how many times what is missing at most. */
enum { TURNS = 4 };
#define LONGEST 50.0

/* A pose after a motion of the tool's centre and a turn about it by 2 atan(|turn| / 2). */
static dpt_pose pose_moved(const struct tissue_tool *tool, const dpt_pose *from, const double way[6])
{
    double ends[6], turn[4] = { 1.0, 0.0, 0.0, 0.0 };
    dpt_pose pose = *from, arm = DPT_POSE_IDENTITY;
    pose_ends(from, &tool->segment, ends);
    for (int k = 0; k < 3; k++) {
        turn[1 + k] = tool->rho > 0.0 ? 0.5 * way[3 + k] / tool->rho : 0.0;
        pose.position[k] -= 0.5 * (ends[k] + ends[3 + k]);
    }
    pose_turn_by(&pose, turn);
    pose_turn_by(&arm, turn);
    turn3(arm.orientation, pose.position, arm.position);
    for (int k = 0; k < 3; k++)
        pose.position[k] = 0.5 * (ends[k] + ends[3 + k]) + way[k] + arm.position[k];
    return pose;
}

/* m: the least gap of all pairs of a tool at a pose. The brute's pairs are these. */
static double least_gap(struct brute *brute, uint32_t t, const dpt_pose *pose)
{
    double least = HUGE_VAL;
    uint32_t count = 0;
    brute->proxy[t] = *pose;
    brute_find_pairs(brute);
    for (uint32_t i = 0; i < brute->count; i++)
        if (brute->pair[i].tool == t) {
            least = fmin(least, brute->pair[i].gap);
            brute->pair[count++] = brute->pair[i];
        }
    brute->count = count;
    return least;
}

/* The least motion that leaves no gap below 0: its pushes are those of a spring of 1 N/m. Returns its length, m. */
static double least_way(struct brute *brute, double way[6])
{
    for (uint32_t i = 0; i < brute->count; i++) {
        brute->pair[i].free_gap = brute->pair[i].gap;
        for (uint32_t j = 0; j < brute->count; j++)
            brute->matrix[i][j] = brute_product(brute->pair[i].row, brute->pair[j].row);
    }
    brute_solve_pairs(brute);
    for (int k = 0; k < 6; k++) {
        way[k] = 0.0;
        for (uint32_t i = 0; i < brute->count; i++)
            way[k] += brute->pair[i].push * brute->pair[i].row[k];
    }
    return sqrt(brute_product(way, way));
}

dpt_pose room_of_end(struct brute *brute, uint32_t t, const double way[6], double *motion)
{
    const struct tissue_tool *tool = &brute->tissue->tool[t];
    const dpt_pose from = brute->proxy[t];
    dpt_pose pose = pose_moved(tool, &from, way), end = pose;
    double most = -HUGE_VAL;
    *motion = 0.0;
    for (int turn = 0; turn < TURNS; turn++) {
        const double gap = least_gap(brute, t, &pose);
        double back[6];
        if (gap > most)
            end = pose;
        most = fmax(most, gap);
        if (most >= -0.5 * brute->clearance)
            break;
        const double size = least_way(brute, back);
        if (size > LONGEST * (brute->clearance - gap))
            break;
        *motion += size;
        pose = pose_moved(tool, &pose, back);
    }
    return end;
}
