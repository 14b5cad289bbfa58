/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What ends a compilation: thrown inside of this library only, caught at its one entry.
 */
#ifndef DPT_URDF_FAULT_H
#define DPT_URDF_FAULT_H

#include <cstddef>
#include <string>
#include <vector>

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

/* A name between quotes, control characters '?', cut where it would fill the line. */
std::string quoted(const std::string &name);

/*
 * "OWNER: 'PATH'REASON". Where a dpt_diag has no room for all of it, the path is cut in its middle: its end and the
 * reason are told. A long reason goes without the owner, which the line names too.
 */
[[noreturn]] void refuse_path(dpt_result code, size_t line, const std::string &owner,
                              const std::string &path, const std::string &reason);

/* What was left out or held still, until it is certain that there is an arm. */
struct Note {
    size_t line;
    std::string text;
};

struct Notes {
    std::vector<Note> list;

    void add(size_t line, const std::string &text)
    {
        list.push_back({ line, text });
    }
};

#endif
