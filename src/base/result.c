/* SPDX-License-Identifier: BSD-3-Clause */
#include "dynpoint/result.h"

const char *dpt_version(void)
{
    return DPT_VERSION_STRING;
}

typedef char number_has_its_parts
    [DPT_VERSION_NUMBER == (DPT_VERSION_MAJOR << 16 | DPT_VERSION_MINOR << 8 | DPT_VERSION_PATCH) ? 1 : -1];

uint32_t dpt_version_number(void)
{
    return DPT_VERSION_NUMBER;
}

const char *dpt_result_text(dpt_result code)
{
#define RESULT_TEXT(name, value, text)                                                                                 \
    case name:                                                                                                         \
        return text;
    switch (code) {
        DPT_RESULTS(RESULT_TEXT)
    default:
        return "an unknown code";
    }
#undef RESULT_TEXT
}

const char *dpt_result_name(dpt_result code)
{
#define RESULT_NAME(name, value, text)                                                                                 \
    case name:                                                                                                         \
        return #name;
    switch (code) {
        DPT_RESULTS(RESULT_NAME)
    default:
        return "DPT_E_?";
    }
#undef RESULT_NAME
}
