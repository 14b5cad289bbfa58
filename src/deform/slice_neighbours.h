/* SPDX-License-Identifier: BSD-3-Clause */
/* Which slices of a net springs lead to, from each slice. */
#ifndef DPT_SLICE_NEIGHBOURS_H
#define DPT_SLICE_NEIGHBOURS_H

#include "mesh/spring_net.h"

/*
 * The slices that springs lead to from `slice`, without itself. One of many may occur twice. Returns how many; `list`
 * may be NULL.
 */
uint32_t dpti_slice_neighbours(const struct spring_net *net, uint32_t slice, uint32_t *list);

/* The same, of all slices together. */
uint64_t dpti_slice_neighbours_count(const struct spring_net *net);

#endif
