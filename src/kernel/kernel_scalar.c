/* SPDX-License-Identifier: BSD-3-Clause */
/* The reference for all other kernels: built without vectors (Makefile). */
#define KERNEL(name) dpti_kernel_scalar_##name
#define KERNEL_TARGET
#include "kernel/kernel_body.h"
