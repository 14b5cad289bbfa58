/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Holds the public headers against layouts.txt. A hosted compiler makes a program that says in
 * words what differs on this machine. A freestanding one (-ffreestanding -fsyntax-only) compiles
 * only when nothing does: so machines that cannot be run here, or have no C library here, are
 * checked too. With -DDPT_CDEF the hosted one holds dynpoint_cdef.h against it instead.
 */
#ifdef DPT_CDEF
#include <stddef.h>
#include <stdint.h>

#include "dynpoint_cdef.h"
#else
#include <dynpoint.h>
#include <dynpoint/baseline.h>
#include <dynpoint/compile.h>
#include <dynpoint/convex.h>
#include <dynpoint/driver.h>
#include <dynpoint/host.h>
#include <dynpoint/identify.h>
#include <dynpoint/loop.h>
#include <dynpoint/recorder.h>
#include <dynpoint/selftest.h>
#include <dynpoint/urdf.h>
#endif

#define PICK(lp64, ilp32)  (sizeof(void *) == 8 ? (size_t)(lp64) : (size_t)(ilp32))
#define BYTES(type, field) sizeof(((type *)0)->field)

/* First pass over the list: what the listed fields of each struct add up to. */
/* clang-format off */
#define TYPE(type, bytes)
#define STRUCT(type) enum { fields_of_##type = 0
#define FIELD(type, field, at64, bytes64, at32, bytes32) + BYTES(type, field)
#define SIZE(type, bytes64, bytes32) };
#define VALUE(name, value)
#include "layouts.txt"
/* clang-format on */
#undef TYPE
#undef STRUCT
#undef FIELD
#undef SIZE
#undef VALUE

/* Second pass: each line against the compiler. A struct larger than its fields has hidden padding,
 * or a field that is not listed. */
#define STRUCT(type)
#if __STDC_HOSTED__

#include <stdio.h>

static int checked, wrong;

static void expect(const char *what, const char *part, long long is, long long listed)
{
    checked++;
    if (is == listed)
        return;
    wrong++;
    printf("  %s %s: %lld, in the list %lld\n", what, part, is, listed);
}

#define EXPECT(what, part, is, listed) expect(what, part, (long long)(is), (long long)(listed));
#define TYPE(type, bytes)              EXPECT(#type, "size", sizeof(type), bytes)
#define FIELD(type, field, at64, bytes64, at32, bytes32)                                                               \
    EXPECT(#type, #field " offset", offsetof(type, field), PICK(at64, at32))                                           \
    EXPECT(#type, #field " size", BYTES(type, field), PICK(bytes64, bytes32))
#define SIZE(type, bytes64, bytes32)                                                                                   \
    EXPECT(#type, "size", sizeof(type), PICK(bytes64, bytes32))                                                        \
    EXPECT(#type, "size without gaps", fields_of_##type, sizeof(type))
#define VALUE(name, value) EXPECT(#name, "", name, value)

int main(void)
{
#include "layouts.txt"
    printf("  %d numbers of the list, %d differ\n", checked, wrong);
    return wrong != 0;
}

#else

#define ASSERT(claim, holds) typedef char claim[(holds) ? 1 : -1];
#define TYPE(type, bytes)    ASSERT(type##_has_its_size, sizeof(type) == (bytes))
#define FIELD(type, field, at64, bytes64, at32, bytes32)                                                               \
    ASSERT(type##_##field##_has_its_place,                                                                             \
           offsetof(type, field) == PICK(at64, at32) && BYTES(type, field) == PICK(bytes64, bytes32))
#define SIZE(type, bytes64, bytes32)                                                                                   \
    ASSERT(type##_has_its_size, sizeof(type) == PICK(bytes64, bytes32))                                                \
    ASSERT(type##_has_no_gaps, sizeof(type) == fields_of_##type)
#define VALUE(name, value) ASSERT(name##_has_its_value, (name) == (value))
#include "layouts.txt"

#endif
