/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Faults end a compilation. They are thrown only inside this library, and caught at its one public function. Notes do
 * not end it.
 */
#ifndef DPT_URDF_FAULT_H
#define DPT_URDF_FAULT_H

#include <cstddef>
#include <string>
#include <vector>

#include "dynpoint/urdf.h"

struct Fault {
    dpt_result code;
    size_t line; /* of the URDF, from 1; 0: no line */
    std::string text;
};

/* Format text as printf does. Control characters become '?', so that it stays one line. */
std::string line_of_text(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* Throw a fault with such a text. */
[[noreturn]] void refuse(dpt_result code, size_t line, const char *format, ...) __attribute__((format(printf, 3, 4)));

/* A name between quotes, for a message: control characters become '?', and a long name is cut. */
std::string quoted(const std::string &name);

/*
 * Throw a fault with the text "OWNER: 'PATH'REASON". If a dpt_diag cannot hold all of it, the middle of the path is cut
 * out, so that the end of the path and the reason stay. If the reason is long, the owner is left out: the line number
 * identifies it too.
 */
[[noreturn]] void refuse_path(dpt_result code, size_t line, const std::string &owner, const std::string &path,
                              const std::string &reason);

/* What was left out or held still. Notes are delivered at the end, when the arm is certain to compile. */
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
