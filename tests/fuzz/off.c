/* SPDX-License-Identifier: BSD-3-Clause */
#include "dynpoint/compile.h"
#include "fuzz/target.h"

FUZZ_TARGET(off)
{
    fuzz_reader(DPT_FORMAT_OFF, bytes, size);
    return 0;
}
