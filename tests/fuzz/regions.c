/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Files of springs: the bytes up to the first zero are one of regions, those behind it one of fixed vertices. Refused
 * with a line, or a square gets springs with what they hold.
 */
#include <math.h>
#include <string.h>

#include "compile/read_regions.h"
#include "fuzz/target.h"

static void check_refusal(dpt_result result, const dpt_diag *diag, const uint8_t *bytes, size_t size)
{
    uint64_t lines = 1;
    for (size_t i = 0; i < size; i++)
        lines += bytes[i] == '\n' || bytes[i] == '\r';
    MUST(result == DPT_E_FINITE || result == DPT_E_ARGUMENT || result == DPT_E_INDEX || result == DPT_E_FORMAT ||
         result == DPT_E_SYNTAX);
    MUST(diag->code == result && diag->line <= lines);
    const char *end = memchr(diag->text, 0, sizeof diag->text);
    MUST(end && end > diag->text);
    for (const char *at = diag->text; at < end; at++)
        MUST(*at >= ' ' && *at <= '~');
}

static void make_springs(const struct spring_regions *read)
{
    static const double vertices[] = { 0, 0, 0, 0.1, 0, 0, 0.1, 0.1, 0, 0, 0.1, 0 };
    static const uint32_t corners[] = { 0, 1, 2, 0, 2, 3 };
    const dpt_spring_net_def springs = { .size = sizeof springs,
                                         .kind = DPT_NET_SHEET,
                                         .regions = read->regions,
                                         .fixed = read->fixed,
                                         .region_count = (uint32_t)read->region_count,
                                         .fixed_count = (uint32_t)read->fixed_count };
    const dpt_compile_def def = { .size = sizeof def, .springs = &springs };
    dpt_diag diag = { .size = sizeof diag };
    dpt_compiled compiled;
    const dpt_mesh *opened;
    const dpt_result result = dpt_compile_arrays(vertices, 4, corners, 2, &def, &compiled, &diag);
    MUST(result == DPT_OK || result == DPT_E_FINITE || result == DPT_E_INDEX ||
         (result == DPT_E_ARGUMENT &&
          (strstr(diag.text, "holds nothing") || strstr(diag.text, "all of the body is fixed"))));
    if (result != DPT_OK)
        return;
    fuzz_accepted++;
    MUST(dpt_mesh_open(compiled.bytes, compiled.size, &opened) == DPT_OK);
    fuzz_use_mesh(opened, FUZZ_COMPILED, FUZZ_QUERY);
    dpt_compiled_free(&compiled);
}

FUZZ_TARGET(regions)
{
    const uint8_t *zero = size ? memchr(bytes, 0, size) : NULL;
    const size_t region_size = zero ? (size_t)(zero - bytes) : size;
    const size_t fixed_at = zero ? region_size + 1 : size;
    struct spring_regions read = { .regions = NULL };
    dpt_diag diag = { .size = sizeof diag };
    struct compile_context context;
    compile_context_init(&context, NULL, &diag);
    dpt_result result = regions_read(&read, &context, bytes, region_size);
    if (result != DPT_OK)
        check_refusal(result, &diag, bytes, region_size);
    if (result == DPT_OK) {
        result = fixed_read(&read, &context, bytes + fixed_at, size - fixed_at);
        if (result != DPT_OK)
            check_refusal(result, &diag, bytes + fixed_at, size - fixed_at);
    }
    for (size_t i = 0; i < read.region_count; i++)
        for (int k = 0; k < 6; k++)
            MUST(fabs(read.regions[i].box[k]) <= 2.0 * DPT_COORDINATE_MAX);
    if (result == DPT_OK)
        make_springs(&read);
    regions_free(&read);
    return 0;
}
