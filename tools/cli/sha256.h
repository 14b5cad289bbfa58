/* SPDX-License-Identifier: BSD-3-Clause */
/* SHA-256 of bytes, as FIPS 180-4 has it and `sha256sum` prints it. */
#ifndef DPT_TOOLS_SHA256_H
#define DPT_TOOLS_SHA256_H

#include <stddef.h>

enum { SHA256_TEXT = 65 };

/* 64 hexadecimal digits and a zero. */
void sha256_text(const void *bytes, size_t size, char text[SHA256_TEXT]);

#endif
