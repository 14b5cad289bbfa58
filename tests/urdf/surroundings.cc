/* SPDX-License-Identifier: BSD-3-Clause */
#include "urdf/surroundings.h"

#include <cstdio>
#include <cstdlib>
#include <locale>
#include <new>

#include <console_bridge/console.h>

#include "urdf/outline.h"

namespace
{

struct Comma : std::numpunct<char> {
    char do_decimal_point() const override
    {
        return ',';
    }
    char do_thousands_sep() const override
    {
        return '.';
    }
    std::string do_grouping() const override
    {
        return "\3";
    }
};

struct Counter : console_bridge::OutputHandler {
    int count = 0;

    void log(const std::string &, console_bridge::LogLevel, const char *, int) override
    {
        count++;
    }
} counter;

console_bridge::OutputHandler *original;

bool granted()
{
    if (allocations_left > 0)
        allocations_left--;
    else if (allocations_left == 0)
        return false;
    return true;
}

} // namespace

__thread long allocations_left = -1;
__thread long blocks_in_c;

extern "C" {

int notes_on_quaternion(const char *value, char *text, unsigned long room)
{
    Notes notes;
    text[0] = 0;
    try {
        Outline outline = outline_of(
            std::string("<robot version=\"1.1\"><joint name=\"j\"><origin quat_xyzw=\"") + value +
            "\"/></joint></robot>");
        outline_check(&outline, true, notes);
    } catch (const Fault &fault) {
        std::snprintf(text, room, "%s", fault.text.c_str());
        return -1;
    }
    for (const Note &note : notes.list)
        std::snprintf(text, room, "%s", note.text.c_str());
    return static_cast<int>(notes.list.size());
}
void *__real_malloc(std::size_t size);
void *__real_calloc(std::size_t count, std::size_t size);
void *__real_realloc(void *block, std::size_t size);
void __real_free(void *block);
void *__wrap_malloc(std::size_t size);
void *__wrap_calloc(std::size_t count, std::size_t size);
void *__wrap_realloc(void *block, std::size_t size);
void __wrap_free(void *block);

/* Of the leak sanitizer, where it is. */
void __lsan_ignore_object(const void *block) __attribute__((weak));
}

void comma_in_cpp(int on)
{
    std::locale::global(on ? std::locale(std::locale::classic(), new Comma)
                           : std::locale::classic());
}

void log_begin(void)
{
    counter.count = 0;
    original = console_bridge::getOutputHandler();
    console_bridge::useOutputHandler(&counter);
    console_bridge::setLogLevel(console_bridge::CONSOLE_BRIDGE_LOG_NONE);
}

int log_is_ours(void)
{
    return console_bridge::getOutputHandler() == &counter &&
           console_bridge::getLogLevel() == console_bridge::CONSOLE_BRIDGE_LOG_NONE;
}

int log_count(void)
{
    return counter.count;
}

int log_end(void)
{
    console_bridge::restorePreviousOutputHandler();
    console_bridge::setLogLevel(console_bridge::CONSOLE_BRIDGE_LOG_WARN);
    return console_bridge::getOutputHandler() == original;
}

void log_something(void)
{
    console_bridge::log("here", 1, console_bridge::CONSOLE_BRIDGE_LOG_ERROR, "something");
}

void *operator new(std::size_t size)
{
    void *block = granted() ? __real_malloc(size ? size : 1) : NULL;
    if (!block)
        throw std::bad_alloc();
    if (allocations_left >= 0 && __lsan_ignore_object)
        __lsan_ignore_object(block);
    return block;
}

void *operator new(std::size_t size, const std::nothrow_t &) noexcept
{
    return granted() ? __real_malloc(size ? size : 1) : NULL;
}

void *operator new[](std::size_t size)
{
    return operator new(size);
}

void operator delete(void *block) noexcept
{
    __real_free(block);
}

void operator delete[](void *block) noexcept
{
    __real_free(block);
}

/* As libraries of C++14 call it. */
__attribute__((visibility("default"))) void operator delete(void *block, std::size_t) noexcept;
__attribute__((visibility("default"))) void operator delete[](void *block, std::size_t) noexcept;

void operator delete(void *block, std::size_t) noexcept
{
    __real_free(block);
}

void operator delete[](void *block, std::size_t) noexcept
{
    __real_free(block);
}

extern "C" {

void *__wrap_malloc(std::size_t size)
{
    void *block = granted() ? __real_malloc(size) : NULL;
    blocks_in_c += block != NULL;
    return block;
}

void *__wrap_calloc(std::size_t count, std::size_t size)
{
    void *block = granted() ? __real_calloc(count, size) : NULL;
    blocks_in_c += block != NULL;
    return block;
}

void *__wrap_realloc(void *block, std::size_t size)
{
    void *grown = granted() ? __real_realloc(block, size) : NULL;
    blocks_in_c += grown && !block;
    return grown;
}

void __wrap_free(void *block)
{
    blocks_in_c -= block != NULL;
    __real_free(block);
}
}
