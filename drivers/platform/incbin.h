/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Bytes of files in a program, by the assembler: EMBED_SECTION, then EMBED_NAME("name") ":\n .incbin ...\n" for each,
 * and ".text\n" at the end. A name is seen in its own source alone.
 */
#ifndef DPT_PLATFORM_INCBIN_H
#define DPT_PLATFORM_INCBIN_H

#if defined __APPLE__
#define EMBED_SECTION    ".const\n"
#define EMBED_NAME(name) "_" name
#elif defined _WIN32
#define EMBED_SECTION    ".section .rdata,\"dr\"\n"
#define EMBED_NAME(name) name
#else
#define EMBED_SECTION    ".section .rodata\n"
#define EMBED_NAME(name) name
#endif

#endif
