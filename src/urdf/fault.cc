/* SPDX-License-Identifier: BSD-3-Clause */
#include "urdf/fault.h"

#include <algorithm>
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

/* Within a character of UTF-8. */
static bool is_within(const std::string &text, size_t at)
{
    return at < text.size() && (static_cast<unsigned char>(text[at]) & 0xc0) == 0x80;
}

/* `head` and `tail` bytes of it at most; what is between them is cut. */
static std::string cut(const std::string &text, size_t head, size_t tail)
{
    if (text.size() <= head + tail)
        return "'" + one_line(text) + "'";
    while (head && is_within(text, head))
        head--;
    size_t from = text.size() - tail;
    while (is_within(text, from))
        from++;
    return "'" + one_line(text.substr(0, head)) + "..." + one_line(text.substr(from)) + "'";
}

std::string quoted(const std::string &name)
{
    return cut(name, 40, 0);
}

void refuse_path(dpt_result code, size_t line, const std::string &owner, const std::string &path,
                 const std::string &reason)
{
    const size_t least = 32;
    size_t room = sizeof(dpt_diag::text) - sizeof "'...'";
    std::string whose = owner + ": ";
    if (whose.size() + least + reason.size() > room)
        whose.clear();
    room -= std::min(room - least, whose.size() + reason.size());
    refuse(code, line, "%s%s%s", whose.c_str(), cut(path, room / 3, room - room / 3).c_str(),
           reason.c_str());
}
