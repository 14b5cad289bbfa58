/* SPDX-License-Identifier: BSD-3-Clause */
#include <string.h>

#include "dynpoint/compile.h"
#include "fuzz/target.h"
#include "mesh/mesh_format.h"

static uint64_t lines_of(const uint8_t *bytes, size_t size)
{
    uint64_t lines = 1;
    for (size_t i = 0; i < size; i++)
        lines += bytes[i] == '\n' || bytes[i] == '\r';
    return lines;
}

/* One of the reasons that a file can give, with a place in it. */
static void check_refusal(dpt_result result, const dpt_compiled *compiled, const dpt_diag *diag, const uint8_t *bytes,
                          size_t size)
{
    MUST(!compiled->bytes && compiled->size == 0);
    MUST(result == DPT_E_FINITE || result == DPT_E_TRUNCATED || result == DPT_E_TRAILING || result == DPT_E_INDEX ||
         result == DPT_E_FORMAT || result == DPT_E_SYNTAX || result == DPT_E_EMPTY);
    MUST(diag->code == result && diag->byte <= size && diag->line <= lines_of(bytes, size));
    const char *end = memchr(diag->text, 0, sizeof diag->text);
    MUST(end && end > diag->text);
    for (const char *at = diag->text; at < end; at++)
        MUST(*at >= ' ' && *at <= '~');
}

struct noted {
    const uint8_t *bytes;
    size_t size;
};

/* A place in the file, and printable text. */
static void check_note(void *user, const dpt_diag *note)
{
    const struct noted *of = user;
    const char *end = memchr(note->text, 0, sizeof note->text);
    MUST(note->code == DPT_OK && note->byte <= of->size && note->line <= lines_of(of->bytes, of->size));
    MUST(end && end > note->text);
    for (const char *at = note->text; at < end; at++)
        MUST(*at >= ' ' && *at <= '~');
}

/* A source number's place has that number; the others are counted as dropped. */
static void check_places(const struct dpt_mesh *mesh)
{
    const uint32_t *places = mesh_words(mesh, MESH_PLACES);
    const uint32_t *sources = mesh_words(mesh, MESH_SOURCES);
    uint32_t kept = 0, degenerate = 0, duplicate = 0;
    for (uint32_t number = 0; number < mesh->source_triangles; number++) {
        const uint32_t place = places[number];
        kept += place < mesh->triangles && sources[place] == number;
        degenerate += place == MESH_DROPPED_DEGENERATE;
        duplicate += place == MESH_DROPPED_DUPLICATE;
    }
    MUST(kept == mesh->triangles);
    MUST(degenerate == mesh->dropped_degenerate && duplicate == mesh->dropped_duplicate);
    MUST(kept + degenerate + duplicate == mesh->source_triangles);
}

/* Over an edge lies a triangle that has this one over the same edge. */
static void check_neighbours(const struct dpt_mesh *mesh)
{
    const uint32_t *neighbours = mesh_words(mesh, MESH_NEIGHBOURS);
    const uint32_t *corners = mesh_words(mesh, MESH_TRIANGLES);
    const uint32_t *parts = mesh_words(mesh, MESH_PARTS);
    for (uint32_t i = 0; i < 3 * mesh->triangles; i++) {
        const uint32_t other = neighbours[i], t = i / 3;
        const uint32_t a = corners[i], b = corners[3 * t + (i + 1) % 3];
        uint32_t back = 0;
        for (uint32_t k = 0; other < mesh->triangles && k < 3; k++) {
            const uint32_t c = corners[3 * other + k], d = corners[3 * other + (k + 1) % 3];
            back += neighbours[3 * other + k] == t && ((a == d && b == c) || (a == c && b == d));
        }
        MUST(other >= mesh->triangles || (back == 1 && parts[other] == parts[t]));
    }
}

/* A vertex's fan is ascending, and each triangle in it has that vertex. */
static void check_fans(const struct dpt_mesh *mesh)
{
    const uint32_t *first = mesh_words(mesh, MESH_FAN_FIRST);
    const uint32_t *fans = mesh_words(mesh, MESH_FANS);
    const uint32_t *corners = mesh_words(mesh, MESH_TRIANGLES);
    for (uint32_t v = 0; v < mesh->vertices; v++) {
        MUST(first[v] < first[v + 1]);
        for (uint32_t i = first[v]; i < first[v + 1]; i++) {
            const uint32_t *c = corners + 3 * fans[i];
            MUST(i == first[v] || fans[i] > fans[i - 1]);
            MUST(c[0] == v || c[1] == v || c[2] == v);
        }
    }
}

static void check_compiled(const dpt_compiled *compiled, const dpt_compiled *again, int asked)
{
    const dpt_mesh *mesh;
    MUST(compiled->size == again->size && !memcmp(compiled->bytes, again->bytes, again->size));
    MUST(dpt_mesh_verify(compiled->bytes, compiled->size, NULL) == DPT_OK);
    MUST(dpt_mesh_open(compiled->bytes, compiled->size, &mesh) == DPT_OK);
    check_places(mesh);
    check_neighbours(mesh);
    check_fans(mesh);
    fuzz_use_mesh(mesh, FUZZ_COMPILED, asked);
}

void fuzz_reader(uint32_t format, const uint8_t *bytes, size_t size)
{
    struct noted noted = { bytes, size };
    const dpt_compile_def def = {
        .size = sizeof def, .format = format, .recentre = size % 4 == 0, .note = check_note, .note_user = &noted
    };
    dpt_diag diag = { .size = sizeof diag };
    dpt_compiled compiled, again;
    dpt_result result = dpt_compile_bytes(bytes, size, &def, &compiled, &diag);
    if (result != DPT_OK) {
        check_refusal(result, &compiled, &diag, bytes, size);
        return;
    }
    fuzz_accepted++;
    MUST(dpt_compile_bytes(bytes, size, &def, &again, &diag) == DPT_OK);
    check_compiled(&compiled, &again, 1 << size % FUZZ_KINDS); /* one of them, for time */
    dpt_compiled_free(&compiled);
    dpt_compiled_free(&again);
}
