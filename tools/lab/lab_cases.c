/* SPDX-License-Identifier: BSD-3-Clause */
#include "lab/lab_cases.h"

#include "lab/lab.h"

const struct lab_case *const lab_cases[] = {
#define CASE(name) &name##_case,
    LAB_CASES
#undef CASE
        NULL
};
