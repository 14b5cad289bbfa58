/* SPDX-License-Identifier: BSD-3-Clause */
#include "dynpoint/compile.h"
#include "fuzz/target.h"

FUZZ_TARGET(ply)
{
    fuzz_reader(DPT_FORMAT_PLY, bytes, size);
    return 0;
}
