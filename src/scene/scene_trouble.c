/* SPDX-License-Identifier: BSD-3-Clause */
#include "scene/scene_trouble.h"

#include <inttypes.h>
#include <stdio.h>

int scene_trouble_note(struct scene_trouble *trouble, const struct scene *scene, const dpt_loop_sample *sample,
                       dpt_result result)
{
    if (scene->is_clutched || !(sample->dt > 0.0))
        return 0;
    trouble->ticks++;
    if (result == DPT_OK)
        return 0;
    if (!trouble->failed++) {
        trouble->failed_first = scene->bodies.tick;
        trouble->why = result;
        trouble->dt = sample->dt;
    }
    return 1;
}

/* What dpt_result_text does not say. */
static const char *reason_of(const struct scene_trouble *trouble)
{
    return trouble->why == DPT_E_ARGUMENT && trouble->dt > DPT_SPRINGS_STEP_MAX
               ? "samples were more than 1 s apart, which no step of springs may be"
               : dpt_result_text(trouble->why);
}

int scene_trouble_text(const struct scene_trouble *trouble, const struct scene *scene, char text[SCENE_TROUBLE_BYTES])
{
    int used = 0;
    text[0] = '\0';
    if (trouble->failed)
        used = snprintf(
            text, SCENE_TROUBLE_BYTES,
            "%" PRIu64 " of %" PRIu64 " ticks failed, and gave no force, the first of them tick %" PRIu64 ": %s%s",
            trouble->failed, trouble->ticks, trouble->failed_first, reason_of(trouble), scene->bodies.held ? "; " : "");
    scene_bodies_held_text(&scene->bodies, text + used, SCENE_TROUBLE_BYTES - (size_t)used);
    return trouble->failed || scene->bodies.held;
}
