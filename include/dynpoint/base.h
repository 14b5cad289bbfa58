/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Version, linkage and the rules that hold for every header.
 *
 * Stability: until 1.0 the soname is 0. Since 0.2 exported symbols, constants and structs only grow; baseline.h alone is
 * experimental. A program that was linked to 0.1 is refused when it is loaded. A struct that may grow begins with
 * `uint32_t size`, which the caller sets to sizeof; of an array the first item's counts for all, and is a multiple of 8.
 * All other structs are frozen. A caller may be older or newer than the library:
 *
 *     size                       an input                                       an output
 *     below the first release's  DPT_E_SIZE                                     DPT_E_SIZE
 *     up to the library's        what is missing has its default                filled as far as it goes
 *     above it                   the rest must be zero, else DPT_E_UNSUPPORTED  the rest is zeroed
 *
 * A default is what the release without that field did; a field that is missing from settings (dpt_tool_settings and the
 * like) stays as it is. A size above 4096 is DPT_E_SIZE; it usually means that the field was not set. Reserved fields of
 * an input must be 0, else DPT_E_ARGUMENT; of an output they are 0. Character arrays end in 0 and never change their
 * length. Enums may gain values, and flags bits: ignore what you do not know.
 *
 * Every public function is total: NULL, NaN, stale ids and wrong sizes give a code (result.h), and outputs are left as
 * they were or written safe. No NaN leaves the library. A call that fails changes nothing, unless its header says so.
 *
 * Arithmetic: calls expect round to nearest, subnormals on (neither FTZ nor DAZ) and masked floating-point traps in the
 * calling thread. "The same bits" means: the same calls to the same release give the same bits on every machine, with
 * every kernel. Another release may differ within the stated bounds.
 *
 * Threads: an open mesh is read-only and may be shared; different worlds may run in different threads, one world in one
 * thread at a time. A callback must return; it must not end or free what is calling it.
 */
#ifndef DYNPOINT_BASE_H
#define DYNPOINT_BASE_H

#include <stddef.h>
#include <stdint.h>

#define DPT_VERSION_MAJOR  0
#define DPT_VERSION_MINOR  2
#define DPT_VERSION_PATCH  0
#define DPT_VERSION_STRING "0.2.0"
/* To compare: major << 16 | minor << 8 | patch. */
#define DPT_VERSION_NUMBER 0x000200

#if defined(_WIN32)
#if defined(DPT_BUILD_SHARED)
#define DPT_API __declspec(dllexport)
#elif defined(DPT_USE_SHARED)
#define DPT_API __declspec(dllimport)
#else
#define DPT_API
#endif
#elif defined(__GNUC__)
#define DPT_API __attribute__((visibility("default")))
#else
#define DPT_API
#endif

#ifdef __cplusplus
#define DPT_BEGIN extern "C" {
#define DPT_END   }
#else
#define DPT_BEGIN
#define DPT_END
#endif

DPT_BEGIN

/* The version of the library that runs, as DPT_VERSION_STRING was when it was built. */
DPT_API const char *dpt_version(void);

/* The same, as DPT_VERSION_NUMBER was. */
DPT_API uint32_t dpt_version_number(void);

DPT_END

#endif
