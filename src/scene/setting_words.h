/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The words of settings, in options and in files, in the order of the numbers that they stand for; and what settings are
 * called by those who read our texts.
 */
#ifndef DPT_SCENE_SETTING_WORDS_H
#define DPT_SCENE_SETTING_WORDS_H

#include <stddef.h>

/* DPT_LAW_... */
static const char *const law_names[] = { "point", "bed", "proxy", NULL };

/* DPT_UNTIL_... */
static const char *const until_words[] = { "respond", "track", "contact", NULL };

/* DPT_STRIP_KIND_... */
static const char *const strip_words[] = { "none", "shadow", "routes", NULL };

/* DPT_INTEGRATOR_... */
static const char *const integrator_words[] = { "symplectic", "euler", "implicit", NULL };

/* enum body_look */
static const char *const body_look_words[] = { "organ", "cloth", "bone", NULL };

/* enum tool_look */
static const char *const tool_look_words[] = { "none", "stylus", "needle", "scalpel", "forceps", "laparoscope", NULL };

/* A setting that a text names: an option of the program, or a field or a flag of dpt_host_def. */
struct setting_names {
    const char *law, *length, *radius, *physics, *tool, *tip, *jaw, *unstable, *embed;
};

/* For a command, as in scene_def; "" or NULL: for callers of the library. */
static inline const struct setting_names *setting_names_for(const char *command)
{
    static const struct setting_names options = { .law = "--law",
                                                  .length = "--length",
                                                  .radius = "--radius",
                                                  .physics = "--physics",
                                                  .tool = "--tool",
                                                  .tip = "--tip",
                                                  .jaw = "--jaw",
                                                  .unstable = "--unstable",
                                                  .embed = "--embed" };
    static const struct setting_names fields = { .law = "law",
                                                 .length = "length",
                                                 .radius = "radius",
                                                 .physics = "physics",
                                                 .tool = "tool",
                                                 .tip = "tips",
                                                 .jaw = "jaw",
                                                 .unstable = "DPT_HOST_FLAG_UNSTABLE",
                                                 .embed = "DPT_HOST_FLAG_EMBED" };
    return command && command[0] ? &options : &fields;
}

#endif
