/* SPDX-License-Identifier: BSD-3-Clause */
#include "proxy/jaw_rig.h"

void jaws_give(struct jaws *jaws, double radius)
{
    static const dpt_pose identity = DPT_POSE_IDENTITY;
    dpt_tip tips[2];
    jaws->radius = radius;
    for (int j = 0; j < 2; j++) {
        const double z[2] = { j ? -JAW_HEIGHT : radius, j ? -radius : JAW_HEIGHT };
        for (int c = 0; c < JAW_CORNERS; c++) {
            double *corner = jaws->corners[j] + 3 * c;
            corner[0] = c & 1 ? JAW_LENGTH : 0.001;
            corner[1] = c & 2 ? JAW_WIDTH / 2 : -JAW_WIDTH / 2;
            corner[2] = z[(c & 4) / 4];
        }
        const dpt_hull_def def = {
            .size = sizeof def, .corner_count = JAW_CORNERS, .corners = jaws->corners[j], .radius = radius
        };
        CHECK(dpt_hull_create(jaws->blocks[j], sizeof jaws->blocks[j], &def, &jaws->hulls[j]) == DPT_OK, "hull %d", j);
        jaws->wanted[j] = identity;
        tips[j] = (dpt_tip){ .size = sizeof *tips, .hull = jaws->hulls[j] };
    }
    CHECK(dpt_tool_set_tips(jaws->rig.world, jaws->rig.tool, tips, 2) == DPT_OK, "tips");
}

void jaws_open(struct jaws *jaws, const dpt_world_def *def, const dpt_mesh *mesh, double radius)
{
    rig_open(&jaws->rig, def, mesh, &rig_point, 1);
    jaws_give(jaws, radius);
}

void jaws_want(struct jaws *jaws, double angle)
{
    for (int j = 0; j < 2; j++) {
        pose_orient(&jaws->wanted[j], (const double[3]){ 0, 1, 0 }, j ? angle : -angle);
        const dpt_result result = dpt_tool_set_tip_pose(jaws->rig.world, jaws->rig.tool, (uint32_t)j, &jaws->wanted[j]);
        CHECK(result == DPT_OK, "%s", dpt_result_name(result));
    }
}

dpt_pose jaw_pose(const struct jaws *jaws, int jaw)
{
    dpt_pose pose = DPT_POSE_IDENTITY;
    CHECK(dpt_tool_get_tip_pose(jaws->rig.world, jaws->rig.tool, (uint32_t)jaw, &pose) == DPT_OK, "jaw %d", jaw);
    return pose;
}

void jaw_corners(const struct jaws *jaws, int jaw, double corners[3 * JAW_CORNERS])
{
    const dpt_pose pose = jaw_pose(jaws, jaw), *tool = &jaws->rig.proxy;
    for (int c = 0; c < JAW_CORNERS; c++) {
        pose_point(&pose, jaws->corners[jaw] + 3 * c, corners + 3 * c);
        pose_point(tool, corners + 3 * c, corners + 3 * c);
    }
}

struct oracle_interval jaw_gap(const struct jaws *jaws, int jaw, const struct oracle_triangles *triangles, double limit)
{
    double corners[3 * JAW_CORNERS];
    jaw_corners(jaws, jaw, corners);
    struct oracle_interval gap = oracle_hull_surface(corners, JAW_CORNERS, triangles, 0, limit + jaws->radius, NULL);
    gap.lower -= jaws->radius;
    gap.upper -= jaws->radius;
    return gap;
}

int jaw_is_there(const struct jaws *jaws, int jaw)
{
    const dpt_pose pose = jaw_pose(jaws, jaw);
    return memcmp(&pose, &jaws->wanted[jaw], sizeof pose) == 0;
}

struct solid jaw_sheet;
static double rim; /* the sheet's least x */

int jaw_sheet_open(void)
{
    if (!solid_from_shape(&jaw_sheet, "membrane", 512))
        return 0;
    for (uint32_t i = 0; i < 3 * jaw_sheet.info.triangles; i++)
        rim = fmin(rim, jaw_sheet.corners[3 * i]);
    return 1;
}

void stand_at_rim(struct jaws *jaws, double y, double angle)
{
    static const dpt_pose identity = DPT_POSE_IDENTITY;
    jaws->rig.device = identity;
    jaws->rig.device.position[0] = rim - 0.005;
    jaws->rig.device.position[1] = y;
    jaws_want(jaws, angle);
    rig_place(&jaws->rig);
}

int jaws_passed(const struct jaws *jaws)
{
    int count = 0;
    for (int j = 0; j < 2; j++) {
        double corners[3 * JAW_CORNERS];
        jaw_corners(jaws, j, corners);
        for (int c = 1; c < JAW_CORNERS; c += 2)
            count += !((j ? -corners[3 * c + 2] : corners[3 * c + 2]) - jaws->radius > 0);
    }
    return count;
}
