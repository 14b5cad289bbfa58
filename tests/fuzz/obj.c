/* SPDX-License-Identifier: BSD-3-Clause */
#include "dynpoint/compile.h"
#include "fuzz/target.h"

FUZZ_TARGET(obj)
{
    fuzz_reader(DPT_FORMAT_OBJ, bytes, size);
    return 0;
}
