/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * How answers.c writes an answer: a line says where it was got and what it is, then each of its fields by name. Numbers
 * are the 16 hexadecimal digits of their bits, so that two lines are the same only where all bits are.
 *
 *     world 3 tick 17 tool 1.0 hit result=0 status=3 ... distance=3f50624dd2f1a9fc ...
 */
#ifndef DPT_BENCH_ANSWERS_H
#define DPT_BENCH_ANSWERS_H

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dynpoint.h"
#include "dynpoint/compile.h"
#include "dynpoint/loop.h"

/* Of commits before 0.2, by the names of now. */
#if __has_include("dynpoint/baseline.h")
#include "dynpoint/baseline.h"

static inline void set_baseline(dpt_world_def *def, dpt_baseline_def *baseline, uint32_t parts, uint32_t one_step)
{
    dpt_baseline_def_init(baseline);
    baseline->parts = parts;
    baseline->one_step = one_step;
    def->baseline = baseline;
}
#else
typedef int dpt_baseline_def;

static inline void set_baseline(dpt_world_def *def, dpt_baseline_def *baseline, uint32_t parts, uint32_t one_step)
{
    (void)baseline;
    def->parts = parts;
    def->one_step = one_step;
}

#define DPT_HIT_FLAG_CROSSING       DPT_HIT_CROSSING
#define DPT_STRIP_KIND_NONE         DPT_STRIP_NONE
#define DPT_STRIP_KIND_ROUTES       DPT_STRIP_ROUTES
#define DPT_STRIP_KIND_SHADOW       DPT_STRIP_SHADOW
#define dpt_mesh_get_triangle       dpt_mesh_triangle
#define dpt_mesh_get_triangle_flags dpt_mesh_triangle_flags
#define dpt_mesh_get_vertex_normals dpt_mesh_vertex_normals
#define dpt_strip_get_triangles     dpt_strip_triangles
#endif

/* Of commits whose guards were open, and whose ticks were told a state and dt. */
#if !__has_include("dynpoint/selftest.h")
#define BEFORE_SAMPLES
#endif

static char out_text[1 << 16];
static size_t out_used;
static uint64_t out_lines, out_values;

static inline void out_flush(void)
{
    if (fwrite(out_text, 1, out_used, stdout) != out_used)
        exit(2);
    out_used = 0;
}

static inline void put_text(const char *text)
{
    const size_t length = strlen(text);
    if (out_used + length > sizeof out_text)
        out_flush();
    memcpy(out_text + out_used, text, length);
    out_used += length;
}

static inline void put_hex(uint64_t bits, int digits)
{
    char text[17];
    for (int i = digits; i-- > 0; bits >>= 4)
        text[i] = "0123456789abcdef"[bits & 15];
    text[digits] = 0;
    put_text(text);
}

static inline void put_name(const char *name)
{
    put_text(" ");
    put_text(name);
    put_text("=");
    out_values++;
}

static inline void put_count(const char *name, uint64_t value)
{
    char text[24];
    snprintf(text, sizeof text, "%" PRIu64, value);
    put_name(name);
    put_text(text);
}

static inline void put_code(const char *name, int32_t value)
{
    char text[24];
    snprintf(text, sizeof text, "%" PRId32, value);
    put_name(name);
    put_text(text);
}

static inline void put_numbers(const char *name, const double *values, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        char indexed[48];
        uint64_t bits;
        memcpy(&bits, &values[i], sizeof bits);
        snprintf(indexed, sizeof indexed, "%s%zu", name, i);
        put_name(count > 1 ? indexed : name);
        put_hex(bits, 16);
    }
}

static inline void put_number(const char *name, double value)
{
    put_numbers(name, &value, 1);
}

static inline void put_word(const char *name, const char *value)
{
    put_name(name);
    put_text("'");
    put_text(value);
    put_text("'");
}

/* A hash of many bytes, where they are too many to be written. FNV-1a, a word at a time. */
static inline uint64_t hash_bytes(uint64_t hash, const void *bytes, size_t size)
{
    const unsigned char *at = bytes;
    for (; size >= 8; size -= 8, at += 8) {
        uint64_t word;
        memcpy(&word, at, 8);
        hash = (hash ^ word) * 0x100000001b3u;
        hash ^= hash >> 29;
    }
    for (; size; size--, at++)
        hash = (hash ^ *at) * 0x100000001b3u;
    return hash;
}

static inline void put_hash(const char *name, uint64_t hash)
{
    put_name(name);
    put_hex(hash, 16);
}

static char place[96];

static inline void begin(const char *what)
{
    put_text(place);
    put_text(" ");
    put_text(what);
}

static inline void end(void)
{
    put_text("\n");
    out_lines++;
}

/* What a call alone returned. */
static inline void put_result(const char *what, dpt_result result)
{
    begin(what);
    put_code("result", (int32_t)result);
    end();
}

static inline void put_hit(const char *what, dpt_result result, const dpt_hit *hit)
{
    begin(what);
    put_code("result", (int32_t)result);
    put_count("status", hit->status);
    put_count("contact", hit->contact);
    put_count("flags", hit->flags);
    put_count("triangle", hit->triangle);
    put_count("segment", hit->segment);
    put_count("body", hit->body);
    put_count("work", hit->work);
    put_number("distance", hit->distance);
    put_number("gap", hit->gap);
    put_number("depth", hit->depth);
    put_number("s", hit->s);
    put_numbers("p", hit->p, 3);
    put_numbers("q", hit->q, 3);
    put_number("error_bound", hit->error_bound);
    put_number("lower_bound", hit->lower_bound);
    end();
}

static inline void put_contact(const dpt_contact *contact)
{
    begin("contact");
    put_count("id", contact->id);
    put_count("body", contact->body);
    put_count("segment", contact->segment);
    put_count("triangle", contact->triangle);
    put_count("contact", contact->contact);
    put_count("flags", contact->flags);
    put_number("s0", contact->s0);
    put_number("s1", contact->s1);
    put_number("s", contact->s);
    put_number("gap", contact->gap);
    put_numbers("p", contact->p, 3);
    put_numbers("q", contact->q, 3);
    put_numbers("normal", contact->normal, 3);
    put_numbers("weight", contact->weight, 3);
    put_number("overlap", contact->overlap);
    put_number("moment", contact->moment);
    put_numbers("thrust", contact->thrust, 3);
    put_numbers("thrust_moment", contact->thrust_moment, 3);
    end();
}

static inline void put_sweep(dpt_result result, const dpt_sweep *sweep)
{
    begin("sweep");
    put_code("result", (int32_t)result);
    put_count("status", sweep->status);
    put_count("segment", sweep->segment);
    put_count("body", sweep->body);
    put_count("triangle", sweep->triangle);
    put_number("time", sweep->time);
    put_number("s", sweep->s);
    put_numbers("q", sweep->q, 3);
    put_numbers("normal", sweep->normal, 3);
    end();
}

static inline void put_overlap(const dpt_overlap *overlap)
{
    begin("overlap");
    put_count("triangle", overlap->triangle);
    put_count("flags", overlap->flags);
    put_number("distance", overlap->distance);
    put_number("s", overlap->s);
    put_numbers("q", overlap->q, 3);
    put_numbers("weight", overlap->weight, 3);
    put_number("gap", overlap->gap);
    put_number("overlap", overlap->overlap);
    end();
}

/* A strip's pairs: the first ones in full, of all of them a hash. */
enum { OVERLAPS_IN_FULL = 16 };

static inline void put_overlaps(const char *what, dpt_result result, const dpt_overlap *overlaps, uint32_t held,
                                uint32_t count, uint32_t flags)
{
    uint64_t hash = 0xcbf29ce484222325u;
    for (uint32_t i = 0; i < held; i++) {
        if (i < OVERLAPS_IN_FULL)
            put_overlap(&overlaps[i]);
        hash = hash_bytes(hash, &overlaps[i].triangle, sizeof overlaps[i].triangle);
        hash = hash_bytes(hash, &overlaps[i].flags, sizeof overlaps[i].flags);
        hash = hash_bytes(hash, &overlaps[i].distance, sizeof(double));
        hash = hash_bytes(hash, &overlaps[i].s, sizeof(double));
        hash = hash_bytes(hash, overlaps[i].q, sizeof overlaps[i].q);
        hash = hash_bytes(hash, overlaps[i].weight, sizeof overlaps[i].weight);
        hash = hash_bytes(hash, &overlaps[i].gap, sizeof(double));
        hash = hash_bytes(hash, &overlaps[i].overlap, sizeof(double));
    }
    begin(what);
    put_code("result", (int32_t)result);
    put_count("count", count);
    put_count("flags", flags);
    put_hash("all", hash);
    end();
}

static inline void put_wrench(const char *what, dpt_result result, const dpt_wrench *wrench)
{
    begin(what);
    put_code("result", (int32_t)result);
    put_numbers("force", wrench->force, 3);
    put_numbers("torque", wrench->torque, 3);
    end();
}

static inline void put_step(dpt_result result, const dpt_step *step)
{
    begin("step");
    put_code("result", (int32_t)result);
    put_count("status", step->status);
    put_count("contact", step->contact);
    put_count("work", step->work);
    put_number("distance", step->distance);
    put_count("contacts", step->contacts);
    put_count("flags", step->flags);
    end();
}

static inline void put_fault(const char *what, dpt_result result, const dpt_mesh_fault *fault)
{
    begin(what);
    put_code("result", (int32_t)result);
    put_code("code", fault->code);
    put_count("byte", fault->byte);
    put_word("section", fault->section);
    end();
}

static inline void put_info(dpt_result result, const dpt_mesh_info *info)
{
    begin("info");
    put_code("result", (int32_t)result);
    put_count("format_version", info->format_version);
    put_count("triangles", info->triangles);
    put_count("vertices", info->vertices);
    put_count("source_triangles", info->source_triangles);
    put_count("source_vertices", info->source_vertices);
    put_count("dropped_degenerate", info->dropped_degenerate);
    put_count("dropped_duplicate", info->dropped_duplicate);
    put_count("unused_vertices", info->unused_vertices);
    put_count("concave_polygons", info->concave_polygons);
    put_count("open_edges", info->open_edges);
    put_count("nonmanifold_edges", info->nonmanifold_edges);
    put_count("wrong_way_edges", info->wrong_way_edges);
    put_count("components", info->components);
    put_count("closed_components", info->closed_components);
    put_count("inward_components", info->inward_components);
    put_count("turned_triangles", info->turned_triangles);
    put_count("tree_levels", info->tree_levels);
    put_number("scale", info->scale);
    put_number("rounding", info->rounding);
    put_numbers("box_min", info->box_min, 3);
    put_numbers("box_max", info->box_max, 3);
    put_count("source_bytes", info->source_bytes);
    put_count("source_hash", info->source_hash);
    put_count("bytes", info->bytes);
    put_count("solid_components", info->solid_components);
    put_count("cavities", info->cavities);
    put_count("winding_components", info->winding_components);
    put_count("buried_components", info->buried_components);
    put_count("crease_edges", info->crease_edges);
    put_count("normalless_vertices", info->normalless_vertices);
    put_number("crease", info->crease);
    end();
}

static inline void put_guard(const dpt_guard *guard)
{
#ifdef BEFORE_SAMPLES
    const dpt_guard info = *guard;
#else
    dpt_guard_info info = { .size = sizeof info };
    dpt_guard_get_info(guard, &info);
#endif
    begin("guard");
    put_count("state", info.state);
    put_count("stops", info.stops);
    put_count("clamped", info.clamped);
    put_count("slewed", info.slewed);
    put_count("not_finite", info.not_finite);
    put_number("gain", info.gain);
    put_numbers("sent", info.sent.force, 3);
    put_numbers("sent_torque", info.sent.torque, 3);
    end();
}

#endif
