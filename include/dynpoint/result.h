/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Result codes. Every function that can fail returns a dpt_result: 0 is success, errors are negative. The values never
 * change. Each group of errors leaves numbers free for more of its kind.
 *
 * Threads: every function may be called from any thread.
 */
#ifndef DYNPOINT_RESULT_H
#define DYNPOINT_RESULT_H

#include "dynpoint/base.h"

/* clang-format off */
/*         name                value  text */
#define DPT_RESULTS(X)                                                                             \
    X(DPT_OK,                     0, "done")                                                       \
    X(DPT_E_ARGUMENT,            -1, "an argument is NULL or outside its stated range")            \
    X(DPT_E_SIZE,                -2, "a struct's size field is not one that this library knows")   \
    X(DPT_E_FINITE,              -3, "a number is not finite or outside its range")                \
    X(DPT_E_POSE,                -4, "a quaternion (w, x, y, z) or an axis is not of unit length") \
    X(DPT_E_ALIGN,               -5, "a block of memory is not aligned to 8 bytes")                \
    X(DPT_E_MEMORY,              -6, "the block is too small, or memory ran out")                  \
    X(DPT_E_FULL,                -7, "the fixed capacity is used up")                              \
    X(DPT_E_HANDLE,              -8, "the id is stale, null or of another kind")                   \
    X(DPT_E_UNSUPPORTED,         -9, "this build or machine does not have what was asked for")     \
    X(DPT_E_DROPPED,            -10, "the compiler dropped that triangle")                         \
    X(DPT_E_UNREACHABLE,        -11, "no triangles that touch lead from one to the other")         \
    X(DPT_E_UNSTABLE,           -12, "so long a step is not stable in as few substeps as allowed")  \
    X(DPT_E_ABSENT,             -13, "this build of the library was made without that part")       \
    X(DPT_E_MAGIC,              -20, "not a dynpoint file, or not of the kind asked for")          \
    X(DPT_E_VERSION,            -21, "written in a newer format than this library reads")          \
    X(DPT_E_BYTE_ORDER,         -22, "the file is little-endian and this host is not: convert it") \
    X(DPT_E_TRUNCATED,          -23, "the file ends before its content does")                      \
    X(DPT_E_TRAILING,           -24, "bytes follow the end of the content")                        \
    X(DPT_E_LAYOUT,             -25, "a section is missing, misplaced or of the wrong length")     \
    X(DPT_E_CHECKSUM,           -26, "a checksum does not match: the file is damaged")             \
    X(DPT_E_INDEX,              -27, "an index points outside its array")                          \
    X(DPT_E_OPEN,               -40, "the file cannot be opened or read")                          \
    X(DPT_E_WRITE,              -41, "the file cannot be written")                                 \
    X(DPT_E_FORMAT,             -42, "the file is of no known format")                             \
    X(DPT_E_SYNTAX,             -43, "the file breaks the rules of its format")                    \
    X(DPT_E_EMPTY,              -44, "the mesh has no triangle that counts")                       \
    X(DPT_E_LIMIT,              -45, "there is more than the format can number or hold")           \
    X(DPT_E_CANCELLED,          -46, "the progress callback asked to stop")                        \
    X(DPT_E_LOST,               -60, "the device is gone: unplugged, or it does not answer")       \
    X(DPT_E_BUSY,               -61, "there was no room for the command: the next one counts")     \
    X(DPT_E_NOT_READY,          -62, "the device gives no force now: its state says why")          \
    X(DPT_E_DEVICE,             -63, "no device is there, or it is not one of that kind")          \
    X(DPT_E_PERMISSION,         -64, "this user may not open the device")                          \
    X(DPT_E_SETTING,            -65, "a setting in the device's name is unknown or out of range")  \
    X(DPT_E_PROTOCOL,           -66, "the device speaks another version of the protocol")          \
    X(DPT_E_SYSTEM,             -67, "the operating system refused a call")
/* clang-format on */

typedef int32_t dpt_result;

#define DPT_RESULT_ENUM(name, value, text) name = value,
enum { DPT_RESULTS(DPT_RESULT_ENUM) DPT_RESULT_END = 1 };
#undef DPT_RESULT_ENUM

DPT_BEGIN

/* One line of English for a code. Never NULL, even for a number that is no code. */
DPT_API const char *dpt_result_text(dpt_result code);

/* The name of a code, such as "DPT_E_ARGUMENT". Never NULL. */
DPT_API const char *dpt_result_name(dpt_result code);

DPT_END

#endif
