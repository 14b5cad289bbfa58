/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The structs of snapshot.h, of callers that are older or newer than the library: with the first release's size, today's,
 * and 8 bytes more. What the fields mean is for test_snapshot.c.
 */
#include "lib/size_checks.h"
#include "world/snapshot_scene.h"

static struct scene scene;

#define READER(noun)                                                                                                   \
    static dpt_result noun(void *out)                                                                                  \
    {                                                                                                                  \
        return dpt_snapshot_get_##noun(block, bytes, 0, out);                                                          \
    }
READER(body)
READER(tool)
READER(segment)
READER(contact)
READER(strip)

static dpt_result info(void *out)
{
    return dpt_snapshot_get_info(block, bytes, out);
}

static const struct sized outputs[] = {
    { "dpt_snapshot_info", offsetof(dpt_snapshot_info, channels), sizeof(dpt_snapshot_info), info },
    { "dpt_snapshot_body", sizeof(dpt_snapshot_body), sizeof(dpt_snapshot_body), body },
    { "dpt_snapshot_tool", offsetof(dpt_snapshot_tool, end), sizeof(dpt_snapshot_tool), tool },
    { "dpt_snapshot_segment", sizeof(dpt_snapshot_segment), sizeof(dpt_snapshot_segment), segment },
    { "dpt_snapshot_contact", sizeof(dpt_snapshot_contact), sizeof(dpt_snapshot_contact), contact },
    { "dpt_snapshot_strip", sizeof(dpt_snapshot_strip), sizeof(dpt_snapshot_strip), strip },
};

static void outputs_are_filled_as_far_as_they_go(void)
{
    for (size_t i = 0; i < sizeof outputs / sizeof *outputs; i++)
        check_output(&outputs[i]);
}

static dpt_result snapshot_def(void *given)
{
    static unsigned char room[ROOM];
    size_t size;
    const dpt_result result = dpt_world_take_snapshot(scene.rig.world, given, room, sizeof room, &size);
    CHECK((result == DPT_OK) == (dpt_snapshot_bytes(scene.rig.world, given) > 0), "%s", dpt_result_name(result));
    return result;
}

static void defaults(void *def, size_t size)
{
    dpt_snapshot_def_defaults(def, size);
}

static void the_def_is_taken_as_far_as_it_goes(void)
{
    const struct sized def = { "dpt_snapshot_def", sizeof(dpt_snapshot_def), sizeof(dpt_snapshot_def), snapshot_def };
    dpt_snapshot_def good;
    dpt_snapshot_def_init(&good);
    check_input(&def, &good);
    check_defaults(&def, defaults, &good);
}

int main(void)
{
    scene_in_contact(&scene);
    take(&scene, NULL);
    TEST(outputs_are_filled_as_far_as_they_go);
    TEST(the_def_is_taken_as_far_as_it_goes);
    scene_close(&scene);
    return check_report();
}
