/* SPDX-License-Identifier: BSD-3-Clause */
#include "proxy/tip_rig.h"

void tip_rig_give(struct tip_rig *tip, uint32_t kind, const double extent[3], double radius)
{
    double corners[3 * DPT_HULL_CORNERS_MAX];
    dpt_hull_shape shape = { .size = sizeof shape, .kind = kind };
    dpt_hull_def def = { .size = sizeof def, .corners = corners, .radius = radius };
    memcpy(shape.extent, extent, sizeof shape.extent);
    shape.sides = kind == DPT_HULL_KIND_CYLINDER || kind == DPT_HULL_KIND_CONE ? 8 : 0;
    dpt_result result = dpt_hull_shape_corners(&shape, corners, DPT_HULL_CORNERS_MAX, &def.corner_count);
    CHECK(result == DPT_OK, "shape: %s", dpt_result_name(result));
    CHECK(dpt_hull_bytes(&def) <= sizeof tip->block, "%zu bytes", dpt_hull_bytes(&def));
    result = dpt_hull_create(tip->block, sizeof tip->block, &def, &tip->hull);
    CHECK(result == DPT_OK, "hull: %s", dpt_result_name(result));
    const char *fault = oracle_hull_read(tip->hull, &tip->as);
    CHECK(!fault, "%s", fault);
    tip->radius = radius;
    const dpt_tip given = { .size = sizeof given, .hull = tip->hull };
    result = dpt_tool_set_tips(tip->rig.world, tip->rig.tool, &given, 1);
    CHECK(result == DPT_OK, "tip: %s", dpt_result_name(result));
}

void tip_rig_open(struct tip_rig *tip, const dpt_world_def *def, const dpt_mesh *mesh, uint32_t kind,
                  const double extent[3], double radius)
{
    rig_open(&tip->rig, def, mesh, &rig_point, 1);
    tip_rig_give(tip, kind, extent, radius);
}

void tip_rig_corners(const struct tip_rig *tip, const dpt_pose *pose, double *corners)
{
    for (uint32_t i = 0; i < tip->as.corner_count; i++)
        pose_point(pose, tip->as.corner[i], corners + 3 * i);
}

struct oracle_triangles tip_triangles(const struct solid *solid)
{
    const size_t count = 9 * (size_t)solid->info.triangles;
    double *corners = malloc(count * sizeof *corners);
    for (size_t i = 0; i < count; i++)
        corners[i] = solid->corners[i];
    return (struct oracle_triangles){ corners, NULL, solid->info.triangles };
}

struct oracle_interval tip_rig_gap(const struct tip_rig *tip, const struct oracle_triangles *triangles,
                                   const dpt_pose *pose, double limit)
{
    double corners[3 * ORACLE_CORNERS];
    tip_rig_corners(tip, pose, corners);
    struct oracle_interval gap =
        oracle_hull_surface(corners, tip->as.corner_count, triangles, 0, limit + tip->radius, NULL);
    gap.lower -= tip->radius;
    gap.upper -= tip->radius;
    return gap;
}

uint32_t tip_rig_contact(const struct tip_rig *tip, dpt_contact *contact)
{
    dpt_contact all[RIG_CONTACTS];
    const uint32_t count = rig_contacts(&tip->rig, all);
    uint32_t found = 0;
    for (uint32_t i = 0; i < count; i++)
        if (all[i].segment >= tip->rig.count) {
            *contact = all[i];
            found++;
        }
    return found;
}
