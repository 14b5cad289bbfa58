/* SPDX-License-Identifier: BSD-3-Clause */
/* The setting of a plan in a recording's text. */
#ifndef DPT_TOOLS_PLAN_TEXT_H
#define DPT_TOOLS_PLAN_TEXT_H

#include "measure/measure_setting.h"
#include "scene/scene_text.h"

void plan_text_note(struct scene_text *text, const struct measure_setting *setting);

/* As far as a scene's text has it; law, stiffness and the like are the text's own. */
struct measure_setting plan_text_setting(const struct scene_text *text);

#endif
