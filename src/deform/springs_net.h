/* SPDX-License-Identifier: BSD-3-Clause */
/* Springs of a net that is no mesh's: as dpt_springs_bytes and dpt_springs_create for a mesh. */
#ifndef DPT_SPRINGS_NET_H
#define DPT_SPRINGS_NET_H

#include "deform/spring_state.h"

/* Check the caller's def, without its mesh. */
dpt_result dpti_springs_read_def(const dpt_springs_def *given, dpt_springs_def *def);

/* 0: the net has no nodes, or is too large for memory. */
size_t dpti_springs_net_bytes(const dpt_springs_def *def, const struct spring_net *net);

/* The net's arrays are used in place; they are valid, as mesh/spring_net.h says. */
dpt_result dpti_springs_create_net(void *block, size_t bytes, const dpt_springs_def *given,
                                   const struct spring_net *net, dpt_springs **springs);

#endif
