/* SPDX-License-Identifier: BSD-3-Clause */
#include "cli/quantity.h"

#include <stddef.h>
#include <string.h>

#include "cli/command_options.h"
#include "text/parse_number.h"

static const struct unit {
    enum quantity_kind kind;
    const char *word;
    double size;
} units[] = {
    { QUANTITY_LENGTH, "m", 1.0 },       { QUANTITY_LENGTH, "cm", 1e-2 }, { QUANTITY_LENGTH, "mm", 1e-3 },
    { QUANTITY_LENGTH, "um", 1e-6 },     { QUANTITY_FORCE, "N", 1.0 },    { QUANTITY_FORCE, "mN", 1e-3 },
    { QUANTITY_RATE, "Hz", 1.0 },        { QUANTITY_RATE, "kHz", 1e3 },   { QUANTITY_STIFFNESS, "N/m", 1.0 },
    { QUANTITY_STIFFNESS, "N/mm", 1e3 },
};
enum { UNITS = sizeof units / sizeof *units };

int quantity_read(const char *command, const char *option, const char *text, enum quantity_kind kind, double *value)
{
    static const char *const known[] = { "m, cm, mm or um", "N or mN", "Hz or kHz", "N/m or N/mm" };
    const char *unit = parse_double(text, text + strlen(text), value);
    if (!unit)
        return complain(command, "%s: '%s' is not a number", option, text);
    while (*unit == ' ')
        unit++;
    for (int i = 0; *unit && i < UNITS; i++)
        if (units[i].kind == kind && !strcmp(unit, units[i].word)) {
            *value *= units[i].size;
            return 0;
        }
    return *unit ? complain(command, "%s: '%s' is not in %s", option, text, known[kind]) : 0;
}
