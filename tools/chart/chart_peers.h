/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Rows of other libraries: programs peer_NAME of a folder, as tests/bench/peers.sh builds them (tests/bench/README.md). Each
 * runs by itself over the same mesh and trace, and is judged here by our distances.
 */
#ifndef DPT_TOOLS_CHART_PEERS_H
#define DPT_TOOLS_CHART_PEERS_H

#include "chart/chart_rows.h"

/*
 * Before anything is measured. Returns 0, or 2 after a message: there is no such folder or no program in it; or the scene is
 * not a single rigid mesh that is felt by a stylus, which is all that peers support.
 */
int chart_peers_check(const struct scene *scene, const char *folder);

/*
 * Add a row for each program that runs, after chart_rows_measure. One that fails is named on standard error and left out.
 * Files for them lie beside the path `beside`, and are removed. Returns 0, or 2 after a message.
 */
int chart_peers_measure(struct chart_rows *rows, const struct scene *scene, const struct csv_table *trace,
                        const char *folder, const char *beside, uint32_t passes);

#endif
