/* SPDX-License-Identifier: BSD-3-Clause */
/* Text of Windows as UTF-8; free it. NULL: memory ran out. */
#ifndef DPT_PLATFORM_WINDOWS_TEXT_H
#define DPT_PLATFORM_WINDOWS_TEXT_H

#include <wchar.h>

char *windows_text(const wchar_t *wide);

#endif
