/* SPDX-License-Identifier: BSD-3-Clause */
/* The words of settings, in options and in files, in the order of the numbers that they stand for. */
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

#endif
