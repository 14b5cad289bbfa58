/* SPDX-License-Identifier: BSD-3-Clause */
/* Compiled masses and springs for tests, opened by the public calls; sums that share nothing with the compiler. */
#ifndef DPT_TESTS_SPRING_SUBJECT_H
#define DPT_TESTS_SPRING_SUBJECT_H

#include "dynpoint/compile.h"
#include "lib/dpa.h"

struct subject {
    struct file file;
    const dpt_mesh *mesh;
    dpt_mesh_info info;
    dpt_mesh_springs net;
};

/* Take what was compiled, which is freed. 1: it opens, and all is filled in; the file's bytes are the caller's to free. */
int open_subject(struct subject *subject, dpt_compiled *compiled);

/* Compile a shape of `dynpoint make` with these springs, and open it. Returns as open_subject. */
int make_subject(struct subject *subject, const char *name, uint64_t count, const dpt_spring_net_def *springs);

/* The defaults, of a kind. */
dpt_spring_net_def def_of(uint32_t kind);

/* The mesh's volume by the divergence theorem, and its area by cross products. */
void measure(const dpt_mesh *mesh, double *volume, double *area);

double sum_of_masses(const dpt_mesh_springs *net);

/* The words of a node's row: from words_begin in steps of 16 to before words_end. */
static inline size_t words_begin(const dpt_mesh_springs *net, uint32_t node)
{
    return (size_t)net->first[node / 16] * 16 + node % 16;
}

static inline size_t words_end(const dpt_mesh_springs *net, uint32_t node)
{
    return (size_t)net->first[node / 16 + 1] * 16;
}

/* Each spring is in both rows, once, as long as its nodes are apart; what is none is as the format says. */
void expect_rows(const struct subject *subject);

#endif
