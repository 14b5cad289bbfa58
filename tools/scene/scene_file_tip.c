/* SPDX-License-Identifier: BSD-3-Clause */
#include "scene/scene_file.h"

#include <math.h>

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
    const uint32_t most = tip_sides_max(tip->kind);
    if (member.value && !most)
        json_refuse(reader, &member, "is for a cylinder or a cone, or what is curved");
    json_take_count(reader, at, "sides", 3, most, &sides);
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
