/* SPDX-License-Identifier: BSD-3-Clause */
#include "deform/slice_neighbours.h"

#include <stddef.h>

#include "base/lanes.h"

/* So many are told apart: in a lattice a slice has about 30. */
enum { TOLD_APART = 64 };

uint32_t dpti_slice_neighbours(const struct spring_net *net, uint32_t slice, uint32_t *list)
{
    const uint32_t *at = net->neighbour + LANES * (size_t)net->first[slice];
    const uint32_t *end = net->neighbour + LANES * (size_t)net->first[slice + 1];
    uint32_t known[TOLD_APART], count = 0, last = slice;
    for (; at < end; at++) {
        const uint32_t other = *at / LANES;
        const uint32_t most = count < TOLD_APART ? count : TOLD_APART;
        uint32_t i = 0;
        if (other == last || other == slice)
            continue;
        last = other;
        while (i < most && known[i] != other)
            i++;
        if (i < most)
            continue;
        known[count % TOLD_APART] = other;
        if (list)
            list[count] = other;
        count++;
    }
    return count;
}

uint64_t dpti_slice_neighbours_count(const struct spring_net *net)
{
    uint64_t count = 0;
    for (uint32_t slice = 0; slice < net->slices; slice++)
        count += dpti_slice_neighbours(net, slice, NULL);
    return count;
}
