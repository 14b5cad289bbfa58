/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What ends a compilation: thrown inside of this library only, caught at its one entry.
 */
#ifndef DPT_URDF_FAULT_H
#define DPT_URDF_FAULT_H

#include <cstddef>
#include <string>

#include "dynpoint/urdf.h"

struct Fault {
    dpt_result code;
    size_t line; /* of the URDF, from 1; 0: of none */
    std::string text;
};

/* A line from a printf format: control characters become '?', so that it stays one. */
std::string line_of_text(const char *format, ...) __attribute__((format(printf, 1, 2)));

[[noreturn]] void refuse(dpt_result code, size_t line, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* A name between quotes, cut where it would fill the line. */
std::string quoted(const std::string &name);

/* To whoever listens. */
struct Notes {
    dpt_urdf_note *hear;
    void *user;

    void say(size_t line, const std::string &text) const;
};

#endif
