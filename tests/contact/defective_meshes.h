/* SPDX-License-Identifier: BSD-3-Clause */
/* Meshes that only winding numbers know the inside of. Each function compiles one, and returns 0 if that fails. */
#ifndef DPT_TESTS_DEFECTIVE_MESHES_H
#define DPT_TESTS_DEFECTIVE_MESHES_H

#include "lib/mesh_builder.h"

/* A shape of `dynpoint make` with so many holes, each of that radius in m. */
int holed_shape(struct mesh_builder *builder, const char *name, uint64_t count, int holes, double radius);

/* A ball of 20,000 triangles of which each 120th is missing. */
int sieve(struct mesh_builder *builder);

/* Four balls in each other, all wound outward, whose holes lie in one plane: four rims around one way in. */
int onion(struct mesh_builder *builder);

/* Two cubes that share an edge, which has four triangles: nothing is open. */
int cubes_with_an_edge_in_common(struct mesh_builder *builder);

/* Two balls that overlap, one with a hole, a third in the first one's material, and a loose sheet that cuts both. */
int balls_and_a_sheet(struct mesh_builder *builder, int has_sheet);

/* One of the kinds of defects, and its name. */
enum { DEFECTS = 10 };
int defective(struct mesh_builder *builder, int kind, const char **name);

/* One of the public meshes with defects, edges that are wound against each other among them. */
enum { DEFECTIVE_FILES = 10 };
int defective_file(struct mesh_builder *builder, const char *data, int i, const char **name);

/* A segment that ends anywhere in the box, or half of the time beside a hole's rim. */
void any_axis(const struct mesh_builder *builder, uint64_t *random, double ends[6]);

#endif
