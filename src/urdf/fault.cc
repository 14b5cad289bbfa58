/* SPDX-License-Identifier: BSD-3-Clause */
#include "urdf/fault.h"

#include <algorithm>
#include <cstdarg>
#include <cstdio>

/* Longer than dpt_diag.text, into which it is cut to fit. */
static const size_t text_max = 512;

static std::string one_line(std::string text)
{
    for (char &c : text)
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
            c = '?';
    return text;
}

static std::string format_text(const char *format, va_list arguments)
{
    char text[text_max];
    vsnprintf(text, sizeof text, format, arguments);
    return one_line(text);
}

std::string line_of_text(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    std::string text = format_text(format, arguments);
    va_end(arguments);
    return text;
}

void refuse(dpt_result code, size_t line, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    Fault fault = { code, line, format_text(format, arguments) };
    va_end(arguments);
    throw fault;
}

/* Is the byte at `at` a continuation byte of a UTF-8 character? */
static bool is_inside_character(const std::string &text, size_t at)
{
    return at < text.size() && (static_cast<unsigned char>(text[at]) & 0xc0) == 0x80;
}

/* The text between quotes. If it is longer than head + tail bytes, its middle is cut out. */
static std::string shortened(const std::string &text, size_t head, size_t tail)
{
    if (text.size() <= head + tail)
        return "'" + one_line(text) + "'";
    while (head && is_inside_character(text, head))
        head--;
    size_t tail_begin = text.size() - tail;
    while (is_inside_character(text, tail_begin))
        tail_begin++;
    return "'" + one_line(text.substr(0, head)) + "..." + one_line(text.substr(tail_begin)) + "'";
}

std::string quoted(const std::string &name)
{
    return shortened(name, 40, 0);
}

void refuse_path(dpt_result code, size_t line, const std::string &owner, const std::string &path,
                 const std::string &reason)
{
    const size_t min_path_bytes = 32;
    size_t path_bytes = sizeof(dpt_diag::text) - sizeof "'...'";
    std::string prefix = owner + ": ";
    if (prefix.size() + min_path_bytes + reason.size() > path_bytes)
        prefix.clear();
    path_bytes -= std::min(path_bytes - min_path_bytes, prefix.size() + reason.size());
    refuse(code, line, "%s%s%s", prefix.c_str(),
           shortened(path, path_bytes / 3, path_bytes - path_bytes / 3).c_str(), reason.c_str());
}
