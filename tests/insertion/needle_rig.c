/* SPDX-License-Identifier: BSD-3-Clause */
#include "insertion/needle_rig.h"

dpt_body_settings needle_gel(void)
{
    return (dpt_body_settings){
        .size = sizeof(dpt_body_settings), .puncture_force = 1.0, .cutting_force = 0.5, .shaft_friction = 40.0
    };
}

/* Where the device has the needle. */
static void aim(struct needle_rig *needle)
{
    dpt_pose *device = &needle->rig.device;
    const double toward[3] = { needle->lean[0], needle->lean[1], -1.0 };
    double unit[3] = { toward[0], toward[1], toward[2] };
    const double size = length3(unit);
    for (int k = 0; k < 3; k++)
        unit[k] /= size;
    turn_from_z(unit, device->orientation);
    const double tip[3] = { needle->at[0], needle->at[1], NEEDLE_TOP };
    for (int k = 0; k < 3; k++)
        device->position[k] = tip[k] + (needle->depth - NEEDLE_LENGTH) * unit[k];
}

int needle_open(struct needle_rig *needle, const dpt_body_settings *gel, uint32_t channels)
{
    return needle_open_within(needle, gel, channels, 0, rig_def(DPT_LAW_PROXY).sweep_budget);
}

int needle_open_within(struct needle_rig *needle, const dpt_body_settings *gel, uint32_t channels, uint32_t budget,
                       uint32_t sweep_budget)
{
    static const dpt_segment shaft = { { 0, 0, 0 }, { 0, 0, NEEDLE_LENGTH }, NEEDLE_RADIUS };
    dpt_tool_settings settings = { .size = sizeof settings };
    dpt_world_def def = rig_def(DPT_LAW_PROXY);
    def.max_channels = channels;
    def.budget = budget;
    def.sweep_budget = sweep_budget;
    *needle = (struct needle_rig){ .at = { 0.011, 0.007 }, .depth = -0.005 };
    if (!solid_from_shape(&needle->box, "box", 12) || !rig_open(&needle->rig, &def, needle->box.mesh, &shaft, 1))
        return 0;
    if (gel)
        rig_set_body(&needle->rig, *gel);
    dpt_tool_get_settings(needle->rig.world, needle->rig.tool, &settings);
    settings.piercing = channels ? DPT_PIERCING_B : DPT_PIERCING_NONE;
    CHECK(dpt_tool_set_settings(needle->rig.world, needle->rig.tool, &settings) == DPT_OK, "settings");
    aim(needle);
    rig_place(&needle->rig);
    return 1;
}

void needle_open_over_plates(struct needle_rig *needle, struct solid *pile, int plates, double thickness, double pitch)
{
    static const uint32_t faces[36] = { 0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                        2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5 };
    double corners[24 * NEEDLE_PLATES_MAX];
    uint32_t triangles[36 * NEEDLE_PLATES_MAX];
    for (int plate = 0; plate < plates; plate++) {
        for (int i = 0; i < 24; i++) {
            const int k = i % 3, high = i / 3 >> k & 1;
            corners[24 * plate + i] =
                k < 2 ? (high ? 0.05 : -0.05) : NEEDLE_TOP - pitch * plate - (high ? 0 : thickness);
        }
        for (int i = 0; i < 36; i++)
            triangles[36 * plate + i] = faces[i] + 8 * (uint32_t)plate;
    }
    needle_open(needle, NULL, 1);
    CHECK(solid_from_arrays(pile, "pile", corners, 8 * (uint32_t)plates, triangles, 12 * (uint32_t)plates), "pile");
    dpt_body_remove(needle->rig.world, needle->rig.body);
    needle->rig.body = rig_add_body(&needle->rig, pile->mesh, NULL);
    rig_set_body(&needle->rig, needle_gel());
    rig_place(&needle->rig);
}

void needle_close(struct needle_rig *needle)
{
    rig_close(&needle->rig);
    solid_close(&needle->box);
}

void needle_step(struct needle_rig *needle)
{
    aim(needle);
    rig_step(&needle->rig);
}

void needle_go(struct needle_rig *needle, double depth, double speed)
{
    const double from = needle->depth, way = depth - from;
    const int ticks = (int)ceil(fabs(way) / (speed * needle->rig.dt));
    for (int i = 1; i <= ticks; i++) {
        needle->depth = from + way * i / ticks;
        needle_step(needle);
    }
}

void needle_wander(struct needle_rig *needle, struct needle_wander *wander)
{
    wander->speed = 0.999 * wander->speed + random_in(&wander->seed, -0.004, 0.005);
    wander->depth += wander->speed * needle->rig.dt;
    if (wander->depth < -0.004 || wander->depth > 0.092)
        wander->speed = wander->depth < 0 ? 0.01 : -0.01;
    needle->depth = wander->depth + random_in(&wander->seed, -2e-6, 2e-6);
    needle_step(needle);
}

double needle_force(const struct needle_rig *needle)
{
    const double *force = needle->rig.force.wrench.force;
    const double size = sqrt(1.0 + needle->lean[0] * needle->lean[0] + needle->lean[1] * needle->lean[1]);
    return -(force[0] * needle->lean[0] + force[1] * needle->lean[1] - force[2]) / size;
}

double needle_tip(const struct needle_rig *needle)
{
    double ends[6];
    rig_proxy_ends(&needle->rig, 0, ends);
    return NEEDLE_TOP - ends[5];
}

uint32_t needle_channels(const struct needle_rig *needle, dpt_channel *channels, uint32_t capacity)
{
    return rig_channels(&needle->rig, needle->rig.tool, channels, capacity);
}

dpt_channel needle_channel(const struct needle_rig *needle)
{
    return rig_channel(&needle->rig, needle->rig.tool);
}
