/* SPDX-License-Identifier: BSD-3-Clause */
#include "compile/read_regions.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "base/return_if_error.h"
#include "compile/soup.h"
#include "compile/spring_build.h"
#include "compile/text.h"

static dpt_result begin(source_text *text, const struct compile_context *context, const unsigned char *bytes,
                        size_t size)
{
    text_begin(text, context, bytes, size);
    text->has_comments = 1;
    return text_refuse_utf16(text);
}

/* Room for one more item of a list; NULL after filling the diag. */
static void *grown(const source_text *text, void *list, size_t *capacity, size_t count, size_t item)
{
    void *bigger = list;
    if (count == *capacity || count >= UINT32_MAX)
        bigger = count < UINT32_MAX ? grow_array(list, capacity, count + 1, item) : NULL;
    if (!bigger)
        compile_fail(text->context, DPT_E_MEMORY, text_location(text), "memory ran out");
    return bigger;
}

static dpt_result read_place(source_text *text, dpt_spring_region *region)
{
    static const char *const names[2][6] = {
        { "the lowest x", "the lowest y", "the lowest z", "the highest x", "the highest y", "the highest z" },
        { "x of the centre", "y of the centre", "z of the centre", "the radius", NULL, NULL }
    };
    const int is_sphere = region->kind == DPT_REGION_SPHERE;
    for (int k = 0; k < (is_sphere ? 4 : 6); k++)
        DPT_TRY(text_read_double(text, names[is_sphere][k], &region->box[k]));
    return DPT_OK;
}

static dpt_result read_region(source_text *text, dpt_spring_region *region)
{
    source_word word;
    char shown[WORD_SHOWN];
    text_next_word(text, &word);
    region->kind = word_is(&word, "box") ? DPT_REGION_BOX : word_is(&word, "sphere") ? DPT_REGION_SPHERE : 0;
    if (!region->kind)
        return compile_fail(text->context, DPT_E_SYNTAX, text_location(text), "'%s' is not box or sphere",
                            word_printable(&word, shown));
    DPT_TRY(read_place(text, region));
    source_text ahead = *text;
    region->fixed = text_next_word(&ahead, &word) && word_is(&word, "fixed");
    if (region->fixed) {
        *text = ahead;
    } else {
        DPT_TRY(text_read_double(text, "Young's modulus, or fixed,", &region->young));
        DPT_TRY(text_read_double(text, "the density", &region->density));
        DPT_TRY(text_read_double(text, "the drag", &region->drag));
    }
    if (text_next_word(text, &word))
        return compile_fail(text->context, DPT_E_SYNTAX, text_location(text), "'%s' follows the region",
                            word_printable(&word, shown));
    return DPT_OK;
}

dpt_result regions_read(struct spring_regions *read, const struct compile_context *context, const unsigned char *bytes,
                        size_t size)
{
    source_text text;
    DPT_TRY(begin(&text, context, bytes, size));
    while (text_seek_word(&text)) {
        dpt_spring_region region = { .kind = 0 };
        dpt_spring_region *list = grown(&text, read->regions, &read->region_capacity, read->region_count, sizeof *list);
        if (!list)
            return DPT_E_MEMORY;
        read->regions = list;
        DPT_TRY(read_region(&text, &region));
        DPT_TRY(springs_check_region(context, &region, (uint32_t)read->region_count + 1, text_location(&text)));
        list[read->region_count++] = region;
    }
    return DPT_OK;
}

dpt_result fixed_read(struct spring_regions *read, const struct compile_context *context, const unsigned char *bytes,
                      size_t size)
{
    source_text text;
    DPT_TRY(begin(&text, context, bytes, size));
    while (text_seek_word(&text)) {
        int64_t number;
        uint32_t *list = grown(&text, read->fixed, &read->fixed_capacity, read->fixed_count, sizeof *list);
        if (!list)
            return DPT_E_MEMORY;
        read->fixed = list;
        DPT_TRY(text_read_int(&text, "a vertex", &number));
        if (number < 0 || number >= UINT32_MAX)
            return compile_fail(context, DPT_E_INDEX, text_location(&text),
                                "%" PRId64 " is no number of a vertex: they count from 0", number);
        list[read->fixed_count++] = (uint32_t)number;
    }
    return DPT_OK;
}

void regions_free(struct spring_regions *read)
{
    free(read->regions);
    free(read->fixed);
    memset(read, 0, sizeof *read);
}
