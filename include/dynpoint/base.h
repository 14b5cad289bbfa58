/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Version, linkage, and the rules that hold for every header.
 *
 * Stability: from 0.3 on, exported symbols, constants and structs only grow; the soname is 1, and the symbols' version
 * DYNPOINT_0_3. Only baseline.h is experimental. The loader refuses a program that was linked to 0.1 or 0.2.
 *
 * Names and lifetimes: all nouns follow one pattern. A header describes only what differs from it.
 *
 *     dpt_NOUN_def_init          fills a dpt_NOUN_def with the defaults
 *     dpt_NOUN_bytes, _create    the bytes that a noun needs, and a noun in a block of yours. There is no destroy: free
 *                                the block when the noun is no longer used. Until then the block stays where it is
 *     dpt_NOUN_init              prepares a struct in your own memory. There is nothing to close
 *     dpt_NOUN_open, _close      a noun that holds memory or system resources of its own: close it. An open of bytes (a
 *                                mesh, an arm) holds nothing and has no close: it uses your bytes where they are
 *     dpt_NOUN_add, _remove      a member of a world, by its id
 *     dpt_compiled_free          frees what a compiler made
 *     dpt_NOUN_get_..., _set_... read and change. _get_info fills a dpt_NOUN_info, the present state; _get_counts a
 *                                dpt_NOUN_counts, numbers that only grow
 *     dpt_NOUN_is_...            1 or 0
 *
 * Sizes: a struct that may grow begins with `uint32_t size`. The caller sets it to sizeof. In an array, the size of the
 * first item holds for all items, and must be a multiple of 8. All other structs never change. The caller may be older
 * or newer than the library:
 *
 *     size                       an input                                       an output
 *     below the first release's  DPT_E_SIZE                                     DPT_E_SIZE
 *     up to the library's        a missing field has its default                filled as far as it goes
 *     above it                   the rest must be zero, else DPT_E_UNSUPPORTED  the rest is zeroed
 *
 * A default is what the release without that field did. A field that is missing from settings (dpt_tool_settings and
 * the like) keeps its value. A size above 4096 is DPT_E_SIZE: it usually means that the field was not set.
 *
 * Fields: reserved fields of an input must be 0, else DPT_E_ARGUMENT; those of an output are 0. Character arrays end in
 * 0 and never change their length. Enums may gain values, and flags may gain bits: ignore those that you do not know.
 *
 * Errors: every public function accepts any input. NULL, NaN, stale ids and wrong sizes give a code (result.h). Outputs
 * then stay as they were, or get safe values. The library never returns a NaN. A call that fails changes nothing unless
 * its header says so.
 *
 * Arithmetic: in the calling thread, the library needs rounding to nearest, subnormals (neither FTZ nor DAZ) and masked
 * floating-point traps. "The same bits" means: the same calls to the same release give the same bits on every machine
 * and with every kernel. Another release may differ within the stated bounds.
 *
 * Threads: an open mesh is read-only, and threads may share it. Different worlds may run in different threads; one
 * world belongs to one thread at a time. A callback must return. It must not end or free its caller.
 */
#ifndef DYNPOINT_BASE_H
#define DYNPOINT_BASE_H

#include <stddef.h>
#include <stdint.h>

#define DPT_VERSION_MAJOR  0
#define DPT_VERSION_MINOR  3
#define DPT_VERSION_PATCH  0
#define DPT_VERSION_STRING "0.3.0"
/* For comparisons: major << 16 | minor << 8 | patch. */
#define DPT_VERSION_NUMBER 0x000300

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

/* The version of the running library: DPT_VERSION_STRING at the time of its build. */
DPT_API const char *dpt_version(void);

/* The same as a number: DPT_VERSION_NUMBER at the time of its build. */
DPT_API uint32_t dpt_version_number(void);

DPT_END

#endif
