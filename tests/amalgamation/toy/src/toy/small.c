/* SPDX-License-Identifier: BSD-3-Clause */
#include "toy/shared.h"

#define KIND(name) dpti_small_##name
#define LIMIT      10
#include "toy/body.h"
