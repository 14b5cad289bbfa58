/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * From a soup to a mesh: join equal vertices, drop degenerate and duplicate triangles. The hash tables use open
 * addressing and are never more than half full. So time and space are linear for any input: a hub of 50,000 triangles
 * costs no more than any other 50,000.
 */
#include <stdlib.h>
#include <string.h>

#include "base/return_if_error.h"
#include "base/vec3.h"
#include "compile/model.h"
#include "mesh/mesh_format.h"

void model_free(struct model *model)
{
    free(model->positions);
    free(model->vertex_sources);
    free(model->corners);
    free(model->sources);
    free(model->places);
    free(model->neighbours);
    free(model->fan_first);
    free(model->fans);
    free(model->part_of);
    free(model->parts);
    free(model->is_turned);
    free(model->part_list);
    free(model->part_first);
    free(model->part_cuts_itself);
    free(model->normals);
    free(model->flags);
    free(model->embedding_nodes);
    free(model->embedding_weights);
    free(model->spring_rest);
    free(model->spring_mass);
    free(model->spring_drag);
    free(model->spring_first);
    free(model->spring_ends);
    free(model->spring_stiffness);
    free(model->spring_length);
    free(model->cell_nodes);
    free(model->cell_stiffness);
    memset(model, 0, sizeof *model);
}

/* A hash set of triples of words. An entry is the index of a triple in `words`. */
struct triples {
    const uint32_t *words; /* 3 per entry; borrowed */
    uint32_t *slots;       /* of the hash table: an entry, or DPT_NONE */
    size_t mask;           /* number of slots, a power of two, less 1 */
};

static int triples_init(struct triples *set, soup *source, const void *words, size_t max_entries)
{
    size_t slots = 16;
    while (slots < 2 * max_entries)
        slots *= 2;
    set->words = words;
    set->mask = slots - 1;
    set->slots = compile_alloc(source->context, slots, sizeof *set->slots);
    if (set->slots)
        memset(set->slots, 0xff, slots * sizeof *set->slots);
    return set->slots ? 1 : 0;
}

static uint64_t mix(uint64_t h)
{
    h = (h ^ (h >> 32)) * 0xd6e8feb86659fd93u;
    h = (h ^ (h >> 32)) * 0xd6e8feb86659fd93u;
    return h ^ (h >> 32);
}

/* Return the entry in the set that has the same words. If there is none, add `entry` and return it. */
static uint32_t triples_find_or_add(struct triples *set, uint32_t entry)
{
    const uint32_t *w = set->words + 3 * (size_t)entry;
    size_t slot = (size_t)mix(mix((uint64_t)w[0] << 32 | w[1]) + w[2]) & set->mask;
    while (set->slots[slot] != DPT_NONE) {
        uint32_t other = set->slots[slot];
        if (!memcmp(set->words + 3 * (size_t)other, w, 3 * sizeof *w))
            return other;
        slot = (slot + 1) & set->mask;
    }
    set->slots[slot] = entry;
    return entry;
}

/*
 * joined[v] becomes the lowest-numbered vertex at the position of v, or DPT_NONE if no triangle uses v. Vertices are
 * numbered as in the source.
 */
static dpt_result join_vertices(struct model *model, soup *source, uint32_t *joined)
{
    struct triples set;
    if (!triples_init(&set, source, source->positions, source->vertex_count))
        return DPT_E_MEMORY;
    memset(joined, 0xff, source->vertex_count * sizeof *joined);
    for (size_t c = 0; c < 3 * source->triangle_count; c++)
        joined[source->corners[c]] = 0;
    for (uint32_t v = 0; v < source->vertex_count; v++) {
        if (joined[v] == DPT_NONE)
            model->unused_vertices++;
        else
            joined[v] = triples_find_or_add(&set, v);
    }
    free(set.slots);
    return DPT_OK;
}

static int is_degenerate(const float *positions, const uint32_t *c)
{
    if (c[0] == c[1] || c[1] == c[2] || c[2] == c[0])
        return 1;
    vec3 v0 = vec3_of_float(positions + 3 * (size_t)c[0]);
    vec3 e1 = sub(vec3_of_float(positions + 3 * (size_t)c[1]), v0);
    vec3 e2 = sub(vec3_of_float(positions + 3 * (size_t)c[2]), v0);
    vec3 n = cross(e1, e2);
    return n.x == 0.0 && n.y == 0.0 && n.z == 0.0;
}

static void sort3(uint32_t w[3])
{
    for (int i = 0; i < 3; i++) {
        int k = i == 1;
        if (w[k] > w[k + 1]) {
            uint32_t t = w[k];
            w[k] = w[k + 1];
            w[k + 1] = t;
        }
    }
}

/*
 * Keep the triangles that have area and no earlier duplicate. Their corners are still vertices of the source, joined.
 */
static dpt_result keep_triangles(struct model *model, soup *source, const uint32_t *joined)
{
    uint32_t *sorted = compile_alloc(source->context, source->triangle_count, 3 * sizeof *sorted);
    struct triples set = { .slots = NULL };
    if (!sorted || !triples_init(&set, source, sorted, source->triangle_count)) {
        free(sorted);
        return DPT_E_MEMORY;
    }
    uint32_t kept_count = 0;
    for (uint32_t t = 0; t < source->triangle_count; t++) {
        uint32_t *corner = model->corners + 3 * (size_t)kept_count, *key = sorted + 3 * (size_t)kept_count;
        for (int k = 0; k < 3; k++)
            key[k] = corner[k] = joined[source->corners[3 * (size_t)t + (size_t)k]];
        sort3(key);
        if (is_degenerate(source->positions, corner)) {
            model->places[t] = MESH_DROPPED_DEGENERATE;
            model->dropped_degenerate++;
        } else if (triples_find_or_add(&set, kept_count) != kept_count) {
            model->places[t] = MESH_DROPPED_DUPLICATE;
            model->dropped_duplicate++;
        } else {
            model->places[t] = kept_count;
            model->sources[kept_count++] = t;
        }
    }
    model->triangle_count = kept_count;
    free(sorted);
    free(set.slots);
    return DPT_OK;
}

dpt_result model_clean(struct model *model, soup *source)
{
    size_t triangles = source->triangle_count;
    model->source_triangle_count = (uint32_t)triangles;
    model->source_vertex_count = (uint32_t)source->vertex_count;
    model->corners = compile_alloc(source->context, triangles, 3 * sizeof *model->corners);
    model->sources = compile_alloc(source->context, triangles, sizeof *model->sources);
    model->places = compile_alloc(source->context, triangles, sizeof *model->places);
    uint32_t *joined = compile_alloc(source->context, source->vertex_count, sizeof *joined);
    dpt_result result = DPT_E_MEMORY;
    if (model->corners && model->sources && model->places && joined) {
        result = join_vertices(model, source, joined);
        if (result == DPT_OK)
            result = keep_triangles(model, source, joined);
    }
    free(joined);
    if (result == DPT_OK && !model->triangle_count)
        return compile_fail(source->context, DPT_E_EMPTY, (source_location){ 0, 0 },
                            "no triangle with an area: %zu read, %u degenerate", triangles, model->dropped_degenerate);
    return result;
}
