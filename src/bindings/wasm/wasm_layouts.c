/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What a field of each public struct is, as the compiler has it, for the JavaScript layer; tools/packaging/wasm_layer.js
 * reads it. The list is the one that holds the ABI (tests/abi/layouts.txt).
 */
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

struct layout_row {
    const char *type, *field; /* no field: the struct's own size */
    uint32_t offset, bytes;
    const char *item; /* u32 i32 u64 i64 f32 f64 text; p: a pointer; "": anything else */
    double value;     /* of a constant: its row has a type alone */
};

#define ITEM(type, field)                                                                                              \
    _Generic(((type *)0)->field, uint32_t: "u32", uint32_t *: "u32", int32_t: "i32",               \
             int32_t *: "i32", uint64_t: "u64", uint64_t *: "u64", int64_t: "i64",                 \
             int64_t *: "i64", float: "f32", float *: "f32", double: "f64", double *: "f64",       \
             double(*)[3]: "f64",                                                                  \
             char *: "text", dpt_pose: "f64", dpt_wrench: "f64", dpt_segment: "f64", default: "")

/* clang-format off */
#define TYPE(type, bytes)
#define STRUCT(type)
#define FIELD(type, field, at64, bytes64, at32, bytes32) \
    { #type, #field, offsetof(type, field), sizeof(((type *)0)->field), ITEM(type, field), 0 },
#define SIZE(type, bytes64, bytes32) { #type, 0, 0, sizeof(type), "", 0 },
#define VALUE(name, number) { #name, 0, 0, 0, "", name },
const struct layout_row layout_rows[] = {
#include <layouts.txt>
    VALUE(DPT_NONE, ) /* a macro, which the list does not have */
    { 0, 0, 0, 0, 0, 0 }
};
/* clang-format on */

DPT_API const struct layout_row *get_layout_rows(void);
const struct layout_row *get_layout_rows(void)
{
    return layout_rows;
}
