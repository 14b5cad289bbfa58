/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The files of `dynpoint compile --regions` and `--fixed`. A word that begins with # ends its line.
 *
 *     box     X0 Y0 Z0  X1 Y1 Z1   E DENSITY DRAG      a material in a box, lowest corner first
 *     sphere  X Y Z  RADIUS        E DENSITY DRAG      or in a sphere
 *     box     X0 Y0 Z0  X1 Y1 Z1   fixed               nodes in it do not move; likewise in a sphere
 *
 * A file of fixed vertices has their numbers in the source, from 0, separated by blanks or ends of lines.
 */
#ifndef DPT_COMPILE_READ_REGIONS_H
#define DPT_COMPILE_READ_REGIONS_H

#include "compile/soup.h"

struct spring_regions {
    dpt_spring_region *regions;
    uint32_t *fixed;
    size_t region_count, region_capacity;
    size_t fixed_count, fixed_capacity;
};

/*
 * Read all bytes of one of the files. Errors go to the diag of `source`. A region that the compiler would refuse is
 * refused here, with its line. Returns DPT_OK, or fills the diag and returns its code. Call regions_free in either
 * case; begin with a zeroed struct.
 */
dpt_result regions_read(struct spring_regions *read, const struct compile_context *context, const unsigned char *bytes,
                        size_t size);
dpt_result fixed_read(struct spring_regions *read, const struct compile_context *context, const unsigned char *bytes,
                      size_t size);
void regions_free(struct spring_regions *read);

#endif
