/* SPDX-License-Identifier: BSD-3-Clause */
#include "compile/compiled.h"

static const void *section_named(const struct sections *sections, const char *name)
{
    dpt_mesh_section section = { .size = sizeof section };
    for (uint32_t i = 0; dpt_mesh_get_section(sections->mesh, i, &section) == DPT_OK; i++)
        if (!strcmp(section.name, name))
            return sections->file.bytes + section.offset;
    CHECK(0, "no section %s", name);
    return NULL;
}

int sections_open(struct sections *s, const dpt_compiled *compiled)
{
    *s = (struct sections){ .info.size = sizeof s->info };
    s->file = file_of(compiled->bytes, compiled->size);
    dpt_mesh_convert(s->file.bytes, s->file.size, NULL);
    dpt_result result = dpt_mesh_open(s->file.bytes, s->file.size, &s->mesh);
    CHECK(result == DPT_OK, "%s", dpt_result_name(result));
    if (result != DPT_OK)
        return 0;
    dpt_mesh_get_info(s->mesh, &s->info);
    s->vertices = section_named(s, "vertices");
    s->triangles = section_named(s, "triangles");
    s->neighbours = section_named(s, "neighbours");
    s->fan_first = section_named(s, "fan_first");
    s->fans = section_named(s, "fans");
    s->parts = section_named(s, "parts");
    s->part_table = section_named(s, "part_table");
    s->sources = section_named(s, "sources");
    s->places = section_named(s, "places");
    s->vertex_sources = section_named(s, "vertex_sources");
    s->boxes = section_named(s, "boxes");
    s->leaves = section_named(s, "leaves");
    return 1;
}

static int same_place(const struct source *source, uint32_t a, uint32_t b)
{
    return rounded(source, a, 0) == rounded(source, b, 0) && rounded(source, a, 1) == rounded(source, b, 1) &&
           rounded(source, a, 2) == rounded(source, b, 2);
}

static uint32_t source_corner(const struct source *source, uint32_t triangle, int k)
{
    return source->corners[3 * (size_t)triangle + (size_t)(k % 3)];
}

/* Two corners at one place, or no area in the rounded coordinates. */
static int is_degenerate(const struct source *source, uint32_t t)
{
    double e[2][3], n[3];
    for (int k = 0; k < 3; k++)
        if (same_place(source, source_corner(source, t, k), source_corner(source, t, k + 1)))
            return 1;
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 3; k++)
            e[i][k] = (double)rounded(source, source_corner(source, t, i + 1), k) -
                      (double)rounded(source, source_corner(source, t, 0), k);
    for (int k = 0; k < 3; k++)
        n[k] = e[0][(k + 1) % 3] * e[1][(k + 2) % 3] - e[0][(k + 2) % 3] * e[1][(k + 1) % 3];
    return n[0] == 0.0 && n[1] == 0.0 && n[2] == 0.0;
}

int same_corners(const struct source *source, uint32_t a, uint32_t b)
{
    int found = 0;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            found += same_place(source, source_corner(source, a, i), source_corner(source, b, k));
    return found == 3;
}

static int is_duplicate(const struct source *source, uint32_t t)
{
    for (uint32_t other = 0; other < t; other++)
        if (!is_degenerate(source, other) && same_corners(source, other, t))
            return 1;
    return 0;
}

/* +1: the same corners in the same round, -1: in the other one, 0: other corners. */
static int round_of(const struct source *source, uint32_t t, const double corners[9])
{
    for (int shift = 0; shift < 3; shift++)
        for (int way = 1; way <= 2; way++) {
            int same = 1;
            for (int k = 0; k < 3; k++)
                for (int axis = 0; axis < 3; axis++)
                    same &= corners[3 * k + axis] ==
                            (double)rounded(source, source_corner(source, t, shift + way * k), axis);
            if (same)
                return way == 1 ? 1 : -1;
        }
    return 0;
}

void check_triangles(const struct source *source, const struct sections *s, int *turned)
{
    uint32_t degenerate = 0, duplicate = 0, kept = 0, flipped = 0;
    for (uint32_t t = 0; t < source->triangle_count; t++) {
        double corners[9] = { 77.0 };
        dpt_result result = dpt_mesh_get_triangle(s->mesh, t, corners);
        uint32_t place = s->places[t];
        if (is_degenerate(source, t) || is_duplicate(source, t)) {
            uint32_t code = is_degenerate(source, t) ? MESH_DROPPED_DEGENERATE : MESH_DROPPED_DUPLICATE;
            degenerate += code == MESH_DROPPED_DEGENERATE;
            duplicate += code == MESH_DROPPED_DUPLICATE;
            CHECK(place == code && result == DPT_E_ARGUMENT && corners[0] == 77.0, "triangle %u is not dropped: %x, %d",
                  t, place, result);
            continue;
        }
        kept++;
        CHECK(result == DPT_OK && place < s->info.triangles, "triangle %u is dropped", t);
        if (result != DPT_OK || place >= s->info.triangles)
            continue;
        CHECK(s->sources[place] == t, "%u is at %u, where %u is", t, place, s->sources[place]);
        turned[place] = round_of(source, t, corners);
        CHECK(turned[place] != 0, "triangle %u has other corners", t);
        flipped += turned[place] == -1;
    }
    const dpt_mesh_info *info = &s->info;
    CHECK(info->triangles == kept && info->dropped_degenerate == degenerate && info->dropped_duplicate == duplicate &&
              info->turned_triangles == flipped,
          "%u kept, %u degenerate, %u duplicate, %u turned; not %u, %u, %u, %u", info->triangles,
          info->dropped_degenerate, info->dropped_duplicate, info->turned_triangles, kept, degenerate, duplicate,
          flipped);
    CHECK(info->source_triangles == source->triangle_count && info->source_vertices == source->vertex_count,
          "%u and %u in the source", info->source_triangles, info->source_vertices);
}

static int is_used(const struct source *source, uint32_t vertex)
{
    for (size_t c = 0; c < 3 * (size_t)source->triangle_count; c++)
        if (source->corners[c] == vertex)
            return 1;
    return 0;
}

/* Each vertex has the number of the first one of the source that is used and lies there. */
static void check_vertex_sources(const struct source *source, const struct sections *s)
{
    for (uint32_t v = 0; v < s->info.vertices; v++) {
        uint32_t number = 0;
        for (; number < source->vertex_count; number++) {
            int is_there = 1;
            for (int k = 0; k < 3; k++)
                is_there &= rounded(source, number, k) == s->vertices[3 * (size_t)v + (size_t)k];
            if (is_there && is_used(source, number))
                break;
        }
        CHECK(s->vertex_sources[v] == number, "vertex %u is %u, not %u", v, s->vertex_sources[v], number);
    }
}

/* Distinct, used by a triangle, the box about them, the source's unused ones and the rounding. */
static void check_vertices(const struct source *source, const struct sections *s)
{
    uint32_t unused = 0;
    double rounding = 0.0;
    for (uint32_t v = 0; v < s->info.vertices; v++) {
        const float *at = s->vertices + 3 * (size_t)v;
        CHECK(s->fan_first[v] < s->fan_first[v + 1], "vertex %u is not used", v);
        for (uint32_t w = 0; w < v; w++)
            CHECK(memcmp(at, s->vertices + 3 * (size_t)w, 12), "%u and %u are one", v, w);
        for (int k = 0; k < 3; k++)
            CHECK(at[k] >= s->info.box_min[k] && at[k] <= s->info.box_max[k] && !(at[k] == 0.0f && signbit(at[k])),
                  "vertex %u is outside, or -0", v);
    }
    for (uint32_t v = 0; v < source->vertex_count; v++) {
        unused += !is_used(source, v);
        for (int k = 0; k < 3; k++)
            rounding = fmax(rounding, fabs((double)rounded(source, v, k) -
                                           source->scale * source->vertices[3 * (size_t)v + (size_t)k]));
    }
    CHECK(s->info.unused_vertices == unused, "%u unused, not %u", s->info.unused_vertices, unused);
    CHECK(s->info.rounding == rounding && s->info.scale == source->scale, "rounding %g, not %g", s->info.rounding,
          rounding);
    for (int k = 0; k < 3; k++) {
        int low = 0, high = 0;
        for (uint32_t v = 0; v < s->info.vertices; v++) {
            low |= s->vertices[3 * (size_t)v + (size_t)k] == s->info.box_min[k];
            high |= s->vertices[3 * (size_t)v + (size_t)k] == s->info.box_max[k];
        }
        CHECK(low && high, "the box is too large along %d", k);
    }
}

static uint32_t corner_at(const struct sections *s, uint32_t t, uint32_t k)
{
    return s->triangles[3 * (size_t)t + k % 3];
}

/* Does t run through the edge from -> to (1), or to -> from (-1)? */
static int runs_through(const struct sections *s, uint32_t t, uint32_t from, uint32_t to)
{
    for (uint32_t k = 0; k < 3; k++) {
        if (corner_at(s, t, k) == from && corner_at(s, t, k + 1) == to)
            return 1;
        if (corner_at(s, t, k) == to && corner_at(s, t, k + 1) == from)
            return -1;
    }
    return 0;
}

/* What is known of each part when all edges have been looked at. */
struct part_found {
    uint32_t triangles, open, many, against, source_against;
    uint32_t first; /* triangle */
};

/*
 * Every edge by comparing all triangles with all. `join` is the least triangle that each is
 * connected with, as far as found; returns whether it changed.
 */
static int check_edges(const struct sections *s, const int *turned, uint32_t *join, struct part_found *at,
                       dpt_mesh_info *sum)
{
    int changed = 0;
    for (uint32_t t = 0; t < s->info.triangles; t++)
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t from = corner_at(s, t, k), to = corner_at(s, t, k + 1), others = 0;
            uint32_t other = 0, lower = 0;
            int way = 0;
            for (uint32_t u = 0; u < s->info.triangles; u++) {
                int runs = u == t ? 0 : runs_through(s, u, from, to);
                if (runs == 0)
                    continue;
                others++;
                lower += u < t;
                other = u;
                way = runs;
                changed |= join[u] != join[t];
                join[t] = join[u] = join[u] < join[t] ? join[u] : join[t];
            }
            uint32_t expected = others == 0 ? MESH_EDGE_OPEN : others == 1 ? other : MESH_EDGE_MANY;
            CHECK(s->neighbours[3 * (size_t)t + k] == expected, "edge %u of %u: %x, not %x", k, t,
                  s->neighbours[3 * (size_t)t + k], expected);
            struct part_found *part = &at[s->parts[t]];
            part->many += others > 1; /* each side of such an edge */
            if (lower)
                continue;
            part->open += others == 0;
            part->against += others == 1 && way == 1;
            part->source_against += others == 1 && way * turned[t] * turned[other] == 1;
            sum->open_edges += others == 0;
            sum->nonmanifold_edges += others > 1;
            sum->wrong_way_edges += others == 1 && way * turned[t] * turned[other] == 1;
        }
    return changed;
}

/* Can all triangles be wound one way? By trying: each agrees with a neighbour that is decided. */
static int is_orientable(const struct sections *s, uint32_t part, int *side)
{
    int changed = 1, orientable = 1;
    for (uint32_t t = 0, first = 1; t < s->info.triangles; t++) {
        side[t] = s->parts[t] == part && first;
        first &= s->parts[t] != part;
    }
    while (changed) {
        changed = 0;
        for (uint32_t t = 0; t < s->info.triangles; t++)
            for (uint32_t k = 0; k < 3 && side[t]; k++) {
                uint32_t n = s->neighbours[3 * (size_t)t + k];
                if (n >= s->info.triangles)
                    continue;
                int wanted = -side[t] * runs_through(s, n, corner_at(s, t, k), corner_at(s, t, k + 1));
                if (wanted == 0)
                    continue; /* no neighbour: check_edges has said so */
                orientable &= side[n] == 0 || side[n] == wanted;
                changed |= side[n] == 0;
                side[n] = wanted;
            }
    }
    return orientable;
}

static double volume_of(const struct sections *s, uint32_t part)
{
    double volume = 0.0, c[9];
    const double *o = s->info.box_min;
    for (uint32_t t = 0; t < s->info.triangles; t++) {
        if (s->parts[t] != part || dpt_mesh_get_triangle(s->mesh, s->sources[t], c) != DPT_OK)
            continue;
        for (int i = 0; i < 9; i++)
            c[i] -= o[i % 3];
        volume += c[0] * (c[4] * c[8] - c[5] * c[7]) + c[1] * (c[5] * c[6] - c[3] * c[8]) +
                  c[2] * (c[3] * c[7] - c[4] * c[6]);
    }
    return volume / 6.0;
}

static void check_parts(const struct sections *s, const int *turned, const uint32_t *join, struct part_found *found,
                        dpt_mesh_info *sum)
{
    int *side = malloc(s->info.triangles * sizeof *side);
    for (uint32_t t = 0; t < s->info.triangles; t++) {
        struct part_found *part = &found[s->parts[t]];
        if (part->triangles++ == 0)
            part->first = t;
        CHECK(join[t] == part->first, "triangle %u is connected with %u, not %u", t, join[t], part->first);
    }
    for (uint32_t p = 0; p < s->info.components; p++) {
        const struct part_found *part = &found[p];
        const uint32_t *entry = s->part_table + 4 * (size_t)p;
        int whole = !part->open && !part->many && is_orientable(s, p, side);
        uint32_t flags = (whole ? MESH_PART_CLOSED : 0) | (part->many ? 0 : MESH_PART_MANIFOLD) |
                         (part->against ? 0 : MESH_PART_WOUND);
        const int solid = (entry[0] & MESH_PART_SOLID) != 0;
        const int winding = (entry[0] & MESH_PART_WINDING) != 0;
        const int buried = (entry[0] & MESH_PART_BURIED) != 0;
        const double volume = volume_of(s, p);
        CHECK((entry[0] & 7u) == flags, "part %u has flags %u, not %u", p, entry[0], flags);
        CHECK(entry[0] < 64u && (solid || !whole) && (solid || (!winding && !buried)) && !(winding && buried) &&
                  (whole || winding || !solid),
              "part %u has flags %u", p, entry[0]);
        sum->solid_components += (uint32_t)solid;
        sum->winding_components += (uint32_t)winding;
        sum->buried_components += (uint32_t)buried;
        CHECK(entry[1] == part->triangles && entry[2] == part->open && entry[3] == part->many,
              "part %u: %u triangles, %u open, %u many; not %u, %u, %u", p, entry[1], entry[2], entry[3],
              part->triangles, part->open, part->many);
        CHECK(p == 0 || part->first > found[p - 1].first, "part %u is out of order", p);
        sum->closed_components += (uint32_t)whole;
        sum->inward_components += whole && !part->source_against && turned[part->first] == -1 && volume >= 0.0;
        sum->cavities += whole && volume < -1e-3;
        CHECK(!whole || !part->against, "part %u is wound both ways", p);
        for (uint32_t t = 0; t < s->info.triangles && !solid; t++)
            CHECK(s->parts[t] != p || turned[t] == 1, "triangle %u of a sheet is turned", t);
    }
    free(side);
}

void check_fans(const struct sections *s)
{
    for (uint32_t v = 0; v < s->info.vertices; v++) {
        uint32_t i = s->fan_first[v];
        for (uint32_t t = 0; t < s->info.triangles; t++)
            if (corner_at(s, t, 0) == v || corner_at(s, t, 1) == v || corner_at(s, t, 2) == v) {
                CHECK(i < s->fan_first[v + 1] && s->fans[i] == t, "%u is not in the fan of %u", t, v);
                i++;
            }
        CHECK(i == s->fan_first[v + 1], "the fan of %u ends at %u", v, i);
    }
}

void check_leaves(const struct sections *s)
{
    struct dpt_mesh header = header_of(&s->file);
    for (uint32_t i = 0; i < header.leaves * LANES; i++) {
        uint32_t t = i < s->info.triangles ? i : s->info.triangles - 1;
        const float *lane = s->leaves + (size_t)(i / LANES) * MESH_LEAF_WORDS + i % LANES;
        for (uint32_t k = 0; k < 9; k++) {
            float x = s->vertices[3 * (size_t)corner_at(s, t, k / 3) + k % 3];
            double at = ((double)x - header.filter_centre[k % 3]) * header.filter_scale;
            CHECK(lane[k * LANES] == (float)at && fabs(at) <= 1.0, "lane %u of leaf %u", i % LANES, i / LANES);
        }
    }
}

void check_boxes(const struct sections *s)
{
    struct dpt_mesh header = header_of(&s->file);
    uint64_t width = LANES, count = (s->info.triangles + LANES - 1) / LANES;
    uint32_t levels = 0;
    const float *node = s->boxes;
    for (; levels == 0 || count > 1; levels++, width *= LANES) {
        uint64_t children = count;
        count = (count + LANES - 1) / LANES;
        for (uint64_t i = 0; i < count * LANES; i++) {
            const float *box = node + i / LANES * MESH_BOX_WORDS + i % LANES;
            uint64_t child = i < children ? i : children - 1;
            for (uint64_t t = child * width; t < (child + 1) * width && t < s->info.triangles; t++)
                for (uint32_t k = 0; k < 9; k++) {
                    float x = s->vertices[3 * (size_t)corner_at(s, (uint32_t)t, k / 3) + k % 3];
                    double at = ((double)x - header.filter_centre[k % 3]) * header.filter_scale;
                    double off = fabs(at - box[k % 3 * LANES]);
                    CHECK(off <= box[(3 + k % 3) * LANES] + 0x1p-52, "box %u of level %u", (uint32_t)i, levels + 1);
                }
        }
        node += count * MESH_BOX_WORDS;
    }
    CHECK(levels == s->info.tree_levels, "%u levels, not %u", s->info.tree_levels, levels);
    CHECK((const void *)node == (const void *)(s->boxes + header.section[MESH_BOXES].bytes / 4),
          "the boxes end elsewhere");
}

void check_compiled(const struct source *source, const dpt_compiled *compiled)
{
    struct sections s;
    if (!sections_open(&s, compiled)) {
        sections_close(&s);
        return;
    }
    dpt_mesh_info sum = { .size = sizeof sum };
    int *turned = calloc(s.info.triangles, sizeof *turned);
    uint32_t *join = malloc(s.info.triangles * sizeof *join);
    struct part_found *found = calloc(s.info.components, sizeof *found);
    for (uint32_t t = 0; t < s.info.triangles; t++)
        join[t] = t;
    check_triangles(source, &s, turned);
    check_vertices(source, &s);
    check_vertex_sources(source, &s);
    while (check_edges(&s, turned, join, found, &sum)) {
        memset(found, 0, s.info.components * sizeof *found);
        sum = (dpt_mesh_info){ .size = sizeof sum };
    }
    check_parts(&s, turned, join, found, &sum);
    CHECK(s.info.open_edges == sum.open_edges && s.info.nonmanifold_edges == sum.nonmanifold_edges &&
              s.info.wrong_way_edges == sum.wrong_way_edges,
          "%u open, %u many, %u against; not %u, %u, %u", s.info.open_edges, s.info.nonmanifold_edges,
          s.info.wrong_way_edges, sum.open_edges, sum.nonmanifold_edges, sum.wrong_way_edges);
    CHECK(s.info.closed_components == sum.closed_components && s.info.inward_components == sum.inward_components,
          "%u closed, %u inward; not %u, %u", s.info.closed_components, s.info.inward_components, sum.closed_components,
          sum.inward_components);
    CHECK(s.info.solid_components == sum.solid_components && s.info.winding_components == sum.winding_components &&
              s.info.buried_components == sum.buried_components,
          "%u solid, %u by winding, %u buried; not %u, %u, %u", s.info.solid_components, s.info.winding_components,
          s.info.buried_components, sum.solid_components, sum.winding_components, sum.buried_components);
    /* Nothing is wound inward that lies in no other. */
    CHECK(sum.cavities <= s.info.cavities && s.info.cavities < sum.solid_components + !sum.solid_components,
          "%u cavities, not %u of %u", s.info.cavities, sum.cavities, sum.solid_components);
    check_fans(&s);
    check_leaves(&s);
    check_boxes(&s);
    free(turned);
    free(join);
    free(found);
    sections_close(&s);
}
