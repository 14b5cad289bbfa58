/* SPDX-License-Identifier: BSD-3-Clause */
#include "record/record_fields.h"

#include <inttypes.h>
#include <math.h>
#include <stddef.h>
#include <string.h>

#define AT(field) offsetof(dpt_record, field)
#define U32(name, field)                                                                                               \
    {                                                                                                                  \
        name, AT(field), WORD_U32, 0                                                                                   \
    }
#define U64(name, field)                                                                                               \
    {                                                                                                                  \
        name, AT(field), WORD_U64, 0                                                                                   \
    }
#define F64(name, field)                                                                                               \
    {                                                                                                                  \
        name, AT(field), WORD_F64, 0                                                                                   \
    }
#define ITEM(name, field, i)                                                                                           \
    {                                                                                                                  \
        name, AT(field) + 8 * (i), WORD_F64, 0                                                                         \
    }
#define ANSWER(name, field, w)                                                                                         \
    {                                                                                                                  \
        name, AT(field), w, 1                                                                                          \
    }
#define PART(name, field, i)                                                                                           \
    {                                                                                                                  \
        name, AT(field) + 8 * (i), WORD_F64, 1                                                                         \
    }

/* clang-format off */
const struct record_field record_fields[] = {
    U64("number", number), U32("device", device), U64("sequence", sequence), U64("time_ns", time_ns), F64("dt", dt),
    U32("flags", flags), U32("status", status), U32("reasons", reasons), U32("code", code), U32("buttons", buttons),
    U32("fresh", fresh), U32("commands", commands),
    ITEM("x", pose, 0), ITEM("y", pose, 1), ITEM("z", pose, 2),
    ITEM("qw", pose, 3), ITEM("qx", pose, 4), ITEM("qy", pose, 5), ITEM("qz", pose, 6),
    ITEM("vx", velocity, 0), ITEM("vy", velocity, 1), ITEM("vz", velocity, 2),
    ITEM("wx", spin, 0), ITEM("wy", spin, 1), ITEM("wz", spin, 2),
    ITEM("joint0", joint, 0), ITEM("joint1", joint, 1), ITEM("joint2", joint, 2), ITEM("joint3", joint, 3),
    ITEM("joint4", joint, 4), ITEM("joint5", joint, 5), ITEM("joint6", joint, 6), ITEM("joint7", joint, 7),
    ANSWER("result", result, WORD_I32),
    PART("asked_fx", asked, 0), PART("asked_fy", asked, 1), PART("asked_fz", asked, 2),
    PART("asked_tx", asked, 3), PART("asked_ty", asked, 4), PART("asked_tz", asked, 5),
    ITEM("sent_fx", sent, 0), ITEM("sent_fy", sent, 1), ITEM("sent_fz", sent, 2),
    ITEM("sent_tx", sent, 3), ITEM("sent_ty", sent, 4), ITEM("sent_tz", sent, 5), U64("sent_ns", sent_ns),
    ANSWER("force_reason", force_reason, WORD_U32), ANSWER("force_flags", force_flags, WORD_U32),
    ANSWER("energy", energy, WORD_F64), ANSWER("lag", lag, WORD_F64),
    ANSWER("hit_status", hit_status, WORD_U32), ANSWER("contact", contact, WORD_U32),
    ANSWER("hit_flags", hit_flags, WORD_U32), ANSWER("triangle", triangle, WORD_U32),
    ANSWER("distance", distance, WORD_F64), ANSWER("gap", gap, WORD_F64),
    PART("point_x", point, 0), PART("point_y", point, 1), PART("point_z", point, 2),
    PART("proxy_x", proxy, 0), PART("proxy_y", proxy, 1), PART("proxy_z", proxy, 2),
    PART("proxy_qw", proxy, 3), PART("proxy_qx", proxy, 4), PART("proxy_qy", proxy, 5), PART("proxy_qz", proxy, 6),
    U64("late_ns", late_ns), U64("took_ns", took_ns)
};
/* clang-format on */

const size_t record_field_count = sizeof record_fields / sizeof *record_fields;

int record_field_is_same(const struct record_field *field, const dpt_record *a, const dpt_record *b)
{
    const size_t bytes = field->word == WORD_U32 || field->word == WORD_I32 ? 4 : 8;
    return !memcmp((const unsigned char *)a + field->at, (const unsigned char *)b + field->at, bytes);
}

void record_field_print(FILE *file, const struct record_field *field, const dpt_record *record, int is_json)
{
    const unsigned char *from = (const unsigned char *)record + field->at;
    uint32_t narrow;
    uint64_t wide;
    double number;
    switch (field->word) {
    case WORD_U32:
        memcpy(&narrow, from, sizeof narrow);
        fprintf(file, "%" PRIu32, narrow);
        break;
    case WORD_I32:
        memcpy(&narrow, from, sizeof narrow);
        fprintf(file, "%" PRId32, (int32_t)narrow);
        break;
    case WORD_U64:
        memcpy(&wide, from, sizeof wide);
        fprintf(file, "%" PRIu64, wide);
        break;
    case WORD_F64:
        memcpy(&number, from, sizeof number);
        if (is_json && !isfinite(number))
            fputs("null", file);
        else
            fprintf(file, "%.17g", number);
        break;
    }
}
