/* SPDX-License-Identifier: BSD-3-Clause */
#include "dynpoint/compile.h"
#include "fuzz/target.h"

FUZZ_TARGET(stl)
{
    fuzz_reader(DPT_FORMAT_STL, bytes, size);
    return 0;
}
