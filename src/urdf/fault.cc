/* SPDX-License-Identifier: BSD-3-Clause */
#include "urdf/fault.h"

#include <cstdarg>
#include <cstdio>

/* Longer than dpt_diag.text, which cuts it. */
static const size_t most = 512;

static std::string one_line(std::string text)
{
    for (char &c : text)
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
            c = '?';
    return text;
}

static std::string format_text(const char *format, va_list arguments)
{
    char text[most];
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

std::string quoted(const std::string &name)
{
    const size_t room = 40;
    if (name.size() <= room)
        return "'" + one_line(name) + "'";
    size_t end = room;
    while (end && (static_cast<unsigned char>(name[end]) & 0xc0) == 0x80)
        end--;
    return "'" + one_line(name.substr(0, end)) + "...'";
}
