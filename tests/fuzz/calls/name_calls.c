/* SPDX-License-Identifier: BSD-3-Clause */
/* Names and texts, of any number. */
#include "fuzz/calls/calls.h"

#define LIST(name, value, text) value,
static const dpt_result known[] = { DPT_RESULTS(LIST) };
#undef LIST

static void results(void)
{
    const dpt_result code = draw_one_in(2) ? -(dpt_result)draw_below(80) : (dpt_result)(uint32_t)draw_bits();
    const char *name = CALL(dpt_result_name, code), *text = CALL(dpt_result_text, code);
    int is_known = 0;
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        is_known |= known[i] == code;
    HOLDS(name && name[0] && text && text[0], "code %d", code);
    HOLDS(is_known == (strcmp(name, "DPT_E_?") != 0), "code %d is %s", code, name);
}

static void kernels(void)
{
    const uint32_t any = draw_one_in(2) ? draw_below(8) : (uint32_t)draw_bits();
    const char *name = CALL(dpt_kernel_name, any);
    HOLDS(name && (any >= 1 && any <= DPT_KERNEL_WASM128) == (strcmp(name, "none") != 0 && strcmp(name, "auto") != 0),
          "kernel %u is %s", any, name);
}

static void version(void)
{
    char text[32];
    const uint32_t number = CALL(dpt_version_number);
    snprintf(text, sizeof text, "%u.%u.%u", number >> 16, number >> 8 & 255, number & 255);
    HOLDS(!strcmp(text, CALL(dpt_version)), "%s", text);
}

static const struct move moves[] = {
    { "results", results, 2 }, { "kernels", kernels, 1 }, { "version", version, 1 }, { NULL, NULL, 0 }
};

const struct noun name_noun = { "name", NULL, NULL, moves };
