/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef DYNPOINT_BASE_H
#define DYNPOINT_BASE_H

#define DPT_VERSION_STRING "0"
#define DPT_API            __attribute__((visibility("default")))

/* Numbers and words that each source has of its own. */
DPT_API int dpt_one(int x);
DPT_API int dpt_two(int x);
DPT_API int dpt_three(int x);
DPT_API int dpt_shared(int x);
DPT_API const char *dpt_words(int source);

#endif
