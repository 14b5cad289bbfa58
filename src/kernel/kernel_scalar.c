/* SPDX-License-Identifier: BSD-3-Clause */
/* Built without vectors (Makefile), as the plain reference of all others. */
#define KERNEL(name) dpti_kernel_scalar_##name
#define KERNEL_TARGET
#include "kernel/kernel_body.h"
