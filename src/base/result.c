/* SPDX-License-Identifier: BSD-3-Clause */
#include "dynpoint/result.h"

const char *dpt_version(void)
{
    return DPT_VERSION_STRING;
}

const char *dpt_result_text(dpt_result code)
{
#define RESULT_TEXT(name, value, text)                                                             \
    case name:                                                                                     \
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
#define RESULT_NAME(name, value, text)                                                             \
    case name:                                                                                     \
        return #name;
    switch (code) {
        DPT_RESULTS(RESULT_NAME)
    default:
        return "DPT_E_?";
    }
#undef RESULT_NAME
}
