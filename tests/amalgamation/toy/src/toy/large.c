/* SPDX-License-Identifier: BSD-3-Clause */
#define KIND(name) dpti_large_##name
#define LIMIT      1000
#include "toy/shared.h"

#if LIMIT > 10
#include "toy/body.h"
#endif
