/* SPDX-License-Identifier: BSD-3-Clause */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dynpoint/springs.h"
#include "scene/scene_file.h"
#include "scene/setting_words.h"
#include "scene/shape.h"

/* A box or a sphere. */
static void read_place(dpt_spring_region *region, struct json_reader *reader, const struct json_value *at)
{
    const struct json_value box = json_member(at, "box"), sphere = json_member(at, "sphere");
    const double far = 2.0 * DPT_COORDINATE_MAX;
    if (!box.value == !sphere.value)
        json_refuse(reader, at, "needs a box or a sphere, and not both");
    region->kind = box.value ? DPT_REGION_BOX : DPT_REGION_SPHERE;
    json_take_numbers(reader, at, "box", 6, far, region->box);
    json_take_numbers(reader, at, "sphere", 4, far, region->box);
    if (region->kind == DPT_REGION_SPHERE && !(region->box[3] > 0.0))
        json_refuse(reader, &sphere, "its radius must be above 0");
    for (int k = 0; box.value && k < 3; k++)
        if (!(region->box[k] <= region->box[3 + k]))
            json_refuse(reader, &box, "is empty: lowest x, y, z, then highest x, y, z");
}

static void read_region(dpt_spring_region *region, struct json_reader *reader, const struct json_value *at,
                        const dpt_spring_net_def *springs)
{
    static const char *const keys[] = { "box", "sphere", "fixed", "young", "density", "drag", NULL };
    int fixed = 0, materials = 0;
    if (!json_check_object(reader, at, keys))
        return;
    read_place(region, reader, at);
    json_take_flag(reader, at, "fixed", &fixed);
    for (int i = 3; keys[i]; i++)
        materials += json_member(at, keys[i]).value != NULL;
    if (fixed && materials)
        json_refuse(reader, at, "what is fixed has no material");
    if (!fixed && !materials)
        json_refuse(reader, at, "is neither fixed nor of another material");
    region->fixed = (uint32_t)fixed;
    if (fixed)
        return;
    region->young = springs->young;
    region->density = springs->density;
    region->drag = springs->drag;
    json_take_above(reader, at, "young", 1e12, &region->young);
    json_take_above(reader, at, "density", 1e9, &region->density);
    json_take_number(reader, at, "drag", 0.0, 1e9, &region->drag);
}

static void read_regions(struct scene_file_body *body, struct json_reader *reader, const struct json_value *list)
{
    dpt_spring_net_def *springs = &body->listed.springs;
    const size_t count = json_check_list(reader, list, 0, SCENE_FILE_REGIONS_MAX);
    body->regions = calloc(count + 1, sizeof *body->regions);
    if (!body->regions)
        json_refuse(reader, list, "memory ran out");
    for (size_t i = 0; i < count && !json_has_failed(reader); i++) {
        const struct json_value at = json_item(list, i);
        read_region(&body->regions[i], reader, &at, springs);
    }
    springs->regions = body->regions;
    springs->region_count = (uint32_t)count;
}

/* A key is of one kind of springs alone. */
static void check_kind(struct json_reader *reader, const struct json_value *at, const char *key, int is_its_own,
                       const char *kind)
{
    const struct json_value member = json_member(at, key);
    if (member.value && !is_its_own)
        json_refuse(reader, &member, "is for a %s", kind);
}

static void read_material(struct scene_file_body *body, struct json_reader *reader, const struct json_value *at)
{
    static const char *const keys[] = { "kind",    "young",   "density", "drag",    "viscosity", "thickness",
                                        "bending", "spacing", "poisson", "regions", NULL };
    static const char *const kinds[] = { "sheet", "volume", NULL };
    dpt_spring_net_def *springs = &body->listed.springs;
    if (!json_check_object(reader, at, keys))
        return;
    dpt_spring_net_def_init(springs);
    const int kind = json_take_word(reader, at, "kind", kinds, -1);
    if (kind < 0)
        json_refuse(reader, at, "needs a kind, sheet or volume");
    springs->kind = kind == 0 ? DPT_NET_SHEET : DPT_NET_VOLUME;
    check_kind(reader, at, "thickness", kind == 0, "sheet");
    check_kind(reader, at, "bending", kind == 0, "sheet");
    check_kind(reader, at, "spacing", kind == 1, "volume");
    check_kind(reader, at, "poisson", kind == 1, "volume");
    json_take_above(reader, at, "young", 1e12, &springs->young);
    json_take_above(reader, at, "density", 1e9, &springs->density);
    json_take_number(reader, at, "drag", 0.0, 1e9, &springs->drag);
    json_take_number(reader, at, "viscosity", 0.0, 1e9, &springs->viscosity);
    json_take_above(reader, at, "thickness", 1e6, &springs->thickness);
    json_take_number(reader, at, "bending", 0.0, 1e12, &springs->bending);
    json_take_above(reader, at, "spacing", 1e6, &springs->spacing);
    json_take_number(reader, at, "poisson", 0.1, 0.45, &springs->poisson);
    const struct json_value regions = json_member(at, "regions");
    if (regions.value)
        read_regions(body, reader, &regions);
}

static void read_physics(struct listed_body *listed, struct json_reader *reader, const struct json_value *at)
{
    static const char *const keys[] = { "integrator",  "iterations", "sleep_speed", "response",
                                        "load_radius", "period",     "room",        NULL };
    static const char *const responses[] = { "load", "displace", NULL };
    uint64_t iterations = 0;
    double sleep_speed = NAN;
    if (!json_check_object(reader, at, keys))
        return;
    listed->integrator =
        (uint32_t)json_take_word(reader, at, "integrator", integrator_words, DPT_INTEGRATOR_SYMPLECTIC);
    check_kind(reader, at, "iterations", listed->integrator == DPT_INTEGRATOR_IMPLICIT,
               "body with \"integrator\": \"implicit\"");
    json_take_count(reader, at, "iterations", 1, 1024, &iterations);
    json_take_number(reader, at, "sleep_speed", 0.0, 1e6, &sleep_speed);
    listed->response = (uint32_t)json_take_word(reader, at, "response", responses, DPT_RESPONSE_LOAD);
    json_take_above(reader, at, "load_radius", DPT_COORDINATE_MAX, &listed->load_radius);
    json_take_number(reader, at, "period", 0.0, 1000.0, &listed->period);
    json_take_above(reader, at, "room", DPT_COORDINATE_MAX, &listed->room);
    listed->iterations = (uint32_t)iterations;
    if (!isnan(sleep_speed))
        listed->sleep_speed = sleep_speed > 0.0 ? sleep_speed : LISTED_SLEEPS_NEVER;
}

static void read_surface_regions(struct surface_regions *regions, struct json_reader *reader,
                                 const struct json_value *list)
{
    static const char *const keys[] = { "box",           "sphere",         "puncture_force",  "toughness",
                                        "cutting_force", "shaft_friction", "shaft_viscosity", NULL };
    regions->count = (uint32_t)json_check_list(reader, list, 0, DPT_BODY_REGIONS_MAX);
    for (uint32_t i = 0; i < regions->count && !json_has_failed(reader); i++) {
        const struct json_value at = json_item(list, i);
        dpt_body_region *law = &regions->law[i];
        *law = (dpt_body_region){ .size = sizeof *law };
        if (!json_check_object(reader, &at, keys))
            return;
        read_place(&regions->place[i], reader, &at);
        json_take_number(reader, &at, "puncture_force", 0.0, 1e6, &law->puncture_force);
        json_take_number(reader, &at, "toughness", 0.0, 1e9, &law->toughness);
        json_take_number(reader, &at, "cutting_force", 0.0, 1e6, &law->cutting_force);
        json_take_number(reader, &at, "shaft_friction", 0.0, 1e6, &law->shaft_friction);
        json_take_number(reader, &at, "shaft_viscosity", 0.0, 1e6, &law->shaft_viscosity);
    }
}

static void read_surface(struct scene_file_body *body, struct json_reader *reader, const struct json_value *at)
{
    dpt_body_settings *settings = &body->settings;
    static const char *const keys[] = { "static_friction",
                                        "kinetic_friction",
                                        "stiffness",
                                        "side_limit",
                                        "unfelt",
                                        "puncture_force",
                                        "toughness",
                                        "cutting_force",
                                        "shaft_friction",
                                        "shaft_viscosity",
                                        "shaft_stiffness",
                                        "regions",
                                        NULL };
    int unfelt = 0;
    if (!json_check_object(reader, at, keys))
        return;
    json_take_number(reader, at, "static_friction", 0.0, 10.0, &settings->static_friction);
    settings->kinetic_friction = settings->static_friction;
    json_take_number(reader, at, "kinetic_friction", 0.0, settings->static_friction, &settings->kinetic_friction);
    json_take_number(reader, at, "stiffness", 0.0, 1e9, &settings->stiffness);
    json_take_number(reader, at, "side_limit", 0.0, DPT_COORDINATE_MAX, &settings->side_limit);
    json_take_flag(reader, at, "unfelt", &unfelt);
    settings->unfelt = (uint32_t)unfelt;
    json_take_number(reader, at, "puncture_force", 0.0, 1e6, &settings->puncture_force);
    json_take_number(reader, at, "toughness", 0.0, 1e9, &settings->toughness);
    json_take_number(reader, at, "cutting_force", 0.0, 1e6, &settings->cutting_force);
    json_take_number(reader, at, "shaft_friction", 0.0, 1e6, &settings->shaft_friction);
    json_take_number(reader, at, "shaft_viscosity", 0.0, 1e6, &settings->shaft_viscosity);
    json_take_number(reader, at, "shaft_stiffness", 0.0, 1e12, &settings->shaft_stiffness);
    const struct json_value regions = json_member(at, "regions");
    if (regions.value)
        read_surface_regions(&body->surface_regions, reader, &regions);
}

/* Decimals of the user's own are seldom exact; those of a unit quaternion are taken as they are. */
void scene_file_read_pose(dpt_pose *pose, struct json_reader *reader, const struct json_value *at, const char *place,
                          double max)
{
    const struct json_value member = json_member(at, "orientation");
    double *q = pose->orientation, square = 0.0;
    json_take_numbers(reader, at, place, 3, max, pose->position);
    json_take_numbers(reader, at, "orientation", 4, 2.0, q);
    for (int k = 0; k < 4; k++)
        square += q[k] * q[k];
    const double length = sqrt(square);
    if (!(fabs(length - 1.0) <= 1e-3))
        json_refuse(reader, &member, "a quaternion w, x, y, z has the length 1; this has %.6g", length);
    for (int k = 0; k < 4 && fabs(length - 1.0) > 1e-9; k++)
        q[k] /= length;
}

/* The table's own name of a shape. */
static const char *read_shape(struct json_reader *reader, const struct json_value *at)
{
    const struct json_value member = json_member(at, "shape");
    const char *name = json_take_text(reader, at, "shape");
    for (size_t i = 0; name && i < shape_kind_count; i++)
        if (!strcmp(shape_kinds[i].name, name))
            return shape_kinds[i].name;
    if (name)
        json_refuse(reader, &member, "'%.40s' is no shape of dynpoint make", name);
    return NULL;
}

/* Whether the body gives way, as far as the file tells. */
static void read_softness(struct scene_file_body *body, struct json_reader *reader, const struct json_value *at)
{
    const struct json_value rigid = json_member(at, "rigid"), physics = json_member(at, "physics");
    const int has_material = body->listed.springs.kind != 0;
    int is_rigid = -1;
    json_take_flag(reader, at, "rigid", &is_rigid);
    if (is_rigid == 1 && has_material)
        json_refuse(reader, &rigid, "what has a material gives way");
    if (is_rigid == 1 && physics.value)
        json_refuse(reader, &physics, "is for a body that gives way");
    if (!body->mesh && !has_material && (is_rigid == 0 || physics.value))
        json_refuse(reader, at, "a shape that gives way needs a material");
    if (is_rigid == 1)
        body->softness = SCENE_FILE_RIGID;
    else if (is_rigid == 0 || physics.value)
        body->softness = SCENE_FILE_SOFT;
}

/* Vertices that are moved out of a tool's way are nodes. */
static void check_response(struct json_reader *reader, const struct json_value *physics,
                           const struct listed_body *listed)
{
    const struct json_value at = json_member(physics, "response");
    if (listed->response == DPT_RESPONSE_DISPLACE && listed->springs.kind == DPT_NET_VOLUME)
        json_refuse(reader, &at, "displace is for a sheet");
}

static void read_colour(struct listed_body *listed, struct json_reader *reader, const struct json_value *at)
{
    const struct json_value list = json_member(at, "colour");
    listed->has_colour = list.value != NULL;
    json_take_numbers(reader, at, "colour", 3, 1.0, listed->colour);
    for (int k = 0; k < 3; k++)
        if (listed->colour[k] < 0.0)
            json_refuse(reader, &list, "has red, green and blue from 0 to 1");
}

void scene_file_read_body(struct scene_file_body *body, struct json_reader *reader, const struct json_value *at,
                          const char *path)
{
    static const char *const keys[] = { "mesh",     "shape",   "triangles", "rigid",  "position", "orientation",
                                        "material", "physics", "surface",   "colour", "look",     NULL };
    const dpt_pose identity = DPT_POSE_IDENTITY;
    if (!json_check_object(reader, at, keys))
        return;
    const struct json_value mesh = json_member(at, "mesh"), shape = json_member(at, "shape"),
                            triangles = json_member(at, "triangles"), material = json_member(at, "material"),
                            physics = json_member(at, "physics"), surface = json_member(at, "surface");
    body->settings.size = sizeof body->settings;
    body->listed.pose = identity;
    if (!mesh.value == !shape.value)
        json_refuse(reader, at, "needs a mesh or a shape, and not both");
    if (mesh.value && triangles.value)
        json_refuse(reader, &triangles, "is for a shape");
    if (mesh.value && material.value)
        json_refuse(reader, &material, "is for a shape: a mesh has its springs of dynpoint compile --springs");
    body->mesh = scene_file_take_path(reader, at, "mesh", path);
    body->listed.shape = read_shape(reader, at);
    json_take_count(reader, at, "triangles", 1, SHAPE_TRIANGLES_MAX, &body->listed.triangles);
    scene_file_read_pose(&body->listed.pose, reader, at, "position", DPT_COORDINATE_MAX);
    if (material.value)
        read_material(body, reader, &material);
    if (physics.value)
        read_physics(&body->listed, reader, &physics);
    check_response(reader, &physics, &body->listed);
    if (surface.value)
        read_surface(body, reader, &surface);
    read_softness(body, reader, at);
    read_colour(&body->listed, reader, at);
    body->listed.look = (enum body_look)json_take_word(reader, at, "look", body_look_words, BODY_LOOK_ORGAN);
}

static void read_extent(struct tip_shape *tip, struct json_reader *reader, const struct json_value *at)
{
    const struct json_value list = json_member(at, "extent");
    json_take_numbers(reader, at, "extent", 3, HUGE_VAL, tip->extent);
    for (int k = 0; k < 3; k++) {
        const struct json_value item = json_item(&list, (size_t)k);
        if (!(tip->extent[k] >= 0.0 && tip->extent[k] <= TIP_EXTENT_MAX))
            json_refuse(reader, &item, "must be 0 to %g; it is %g", TIP_EXTENT_MAX, tip->extent[k]);
    }
    const struct json_value y = json_item(&list, 1);
    if (tip_is_round(tip->kind) && tip->extent[1] != 0.0 && tip->extent[1] != tip->extent[0])
        json_refuse(reader, &y, "is the diameter, as along x, or 0: a %s is round", tip_shape_words[tip->kind]);
}

static void read_sides(struct tip_shape *tip, struct json_reader *reader, const struct json_value *at)
{
    const struct json_value member = json_member(at, "sides");
    uint64_t sides = 0;
    const uint32_t max = tip_sides_max(tip->kind);
    if (member.value && !max)
        json_refuse(reader, &member, "is for a cylinder or a cone, or what is curved");
    json_take_count(reader, at, "sides", 3, max, &sides);
    tip->sides = (uint32_t)sides;
}

static void read_tip(struct tip_shape *tip, struct json_reader *reader, const struct json_value *at)
{
    static const char *const keys[] = { "shape", "extent", "radius", "sides", "at", "orientation", NULL };
    static const dpt_pose identity = DPT_POSE_IDENTITY;
    tip->pose = identity;
    if (!json_check_object(reader, at, keys))
        return;
    if (!json_member(at, "shape").value || !json_member(at, "extent").value)
        json_refuse(reader, at, "needs a shape and an extent");
    tip->kind = (uint32_t)json_take_word(reader, at, "shape", tip_shape_words, 0);
    read_extent(tip, reader, at);
    json_take_number(reader, at, "radius", 0.0, TIP_RADIUS_MAX, &tip->radius);
    read_sides(tip, reader, at);
    scene_file_read_pose(&tip->pose, reader, at, "at", TIP_EXTENT_MAX);
    const char *fault = json_has_failed(reader) ? NULL : tip_shape_fault(tip);
    if (fault)
        json_refuse(reader, at, "%s", fault);
}

void scene_file_read_tips(struct tip_shapes *tips, struct json_reader *reader, const struct json_value *list)
{
    const size_t count = json_check_list(reader, list, 1, TIP_SHAPES_MAX);
    for (size_t i = 0; i < count && !json_has_failed(reader); i++) {
        const struct json_value at = json_item(list, i);
        read_tip(&tips->shape[i], reader, &at);
    }
    tips->count = (uint32_t)count;
}
