/* SPDX-License-Identifier: BSD-3-Clause */
/* Numbers with a unit, as "0.1mm". */
#ifndef DPT_TOOLS_CMD_PLAN_H
#define DPT_TOOLS_CMD_PLAN_H

/* Numbers with a unit, as "0.1mm". */

enum quantity_kind { QUANTITY_LENGTH, QUANTITY_FORCE, QUANTITY_RATE, QUANTITY_STIFFNESS };

/*
 * Read a number and its unit, one of the kind's: m, cm, mm, um; N, mN; Hz, kHz; N/m, N/mm. Without a unit it is in m, N, Hz
 * or N/m. Returns 0, or 2 after a message that names the option.
 */
int quantity_read(const char *command, const char *option, const char *text, enum quantity_kind kind, double *value);

#endif
