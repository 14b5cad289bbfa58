/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What other programs write: formats that are not read, but known; what stands behind an STL; the axes of 3D Slicer.
 *
 *     test_foreign [GOLDEN]
 *
 * GOLDEN is the folder golden-bad; from the top of the tree it is found without.
 */
#include "compile/foreign.h"

#include <inttypes.h>

#include "compile/heard.h"
#include "compile/reading.h"

static const char *golden = "tests/golden-bad";

/* All bytes of a file. */
static unsigned char *load(const char *name, size_t *size)
{
    char path[1024];
    unsigned char *bytes = calloc(1, 4096);
    snprintf(path, sizeof path, "%s/%s", golden, name);
    FILE *file = fopen(path, "rb");
    *size = file ? fread(bytes, 1, 4096, file) : 0;
    CHECK(*size > 0 && *size < 4096, "%s", path);
    if (file)
        fclose(file);
    return bytes;
}

/* Read, and hear what is noted. */
static struct heard notes_of(uint32_t format, const void *bytes, size_t size, size_t triangles)
{
    struct heard h = { 0 };
    const dpt_compile_def def = { .size = sizeof def, .note = hear, .note_user = &h };
    reading r;
    read_bytes(&r, format, bytes, size, &def);
    CHECK(r.result == DPT_OK && r.soup.triangle_count == triangles, "%s", r.diag.text);
    soup_free(&r.soup);
    return h;
}

static void what_follows_an_stl_is_noted(void)
{
    size_t size = 0;
    unsigned char *bytes = load("binary_trailing.stl", &size);
    struct heard h = notes_of(DPT_FORMAT_STL, bytes, size, 1);
    CHECK(h.count == 1 && h.last.byte == 134 && h.last.line == 0 && h.last.code == DPT_OK &&
              strstr(h.last.text, "follow the 1 triangles"),
          "byte %" PRIu64 ": %s", h.last.byte, h.last.text);
    h = notes_of(DPT_FORMAT_STL, bytes, 134, 1);
    CHECK(h.count == 0, "%s", h.last.text);
    free(bytes);
    bytes = load("text_after_end.stl", &size);
    h = notes_of(DPT_FORMAT_STL, bytes, size, 1);
    CHECK(h.count == 1 && h.last.line == 10, "line %" PRIu64 ": %s", h.last.line, h.last.text);
    free(bytes);
}

/* The header of a binary STL, a comment of a PLY and of an OBJ, the name of an ASCII STL. */
static void axes_of_slicer_are_noted(void)
{
    static const char obj[] = "# 3D Slicer output. SPACE=RAS\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    static const char stl[] =
        "solid 3D Slicer output. SPACE=LPS\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 "
        "0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n";
    unsigned char binary[134] = "3D Slicer output. SPACE=LPS";
    binary[80] = 1;
    struct heard h = notes_of(DPT_FORMAT_OBJ, obj, sizeof obj - 1, 1);
    CHECK(h.count == 1 && h.last.byte == 20 && strstr(h.last.text, "SPACE=RAS, by 3D Slicer") &&
              strstr(h.last.text, "x to the patient's right"),
          "%s", h.last.text);
    h = notes_of(DPT_FORMAT_STL, stl, sizeof stl - 1, 1);
    CHECK(h.count == 1 && strstr(h.last.text, "SPACE=LPS"), "%s", h.last.text);
    h = notes_of(DPT_FORMAT_STL, binary, sizeof binary, 1);
    CHECK(h.count == 1 && h.last.byte == 18 && strstr(h.last.text, "x to the patient's left") &&
              h.last.text[strlen(h.last.text) - 1] != '.',
          "%s", h.last.text);
    memset(binary + 18, 'x', 6);
    h = notes_of(DPT_FORMAT_STL, binary, sizeof binary, 1);
    CHECK(h.count == 0, "%s", h.last.text);
}

/* By content alone: the name says STL. */
static void foreign_formats_are_told(void)
{
    static const struct {
        const char *content, *name;
    } cases[] = { { "# vtk DataFile Version 5.1\nvtk output\nASCII\nDATASET POLYDATA\n", "VTK" },
                  { "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\">", "VTK" },
                  { "glTF\2", "glTF" },
                  { " {\"scene\":0,\"asset\":{\"version\":\"2.0\"}}", "glTF" },
                  { "PK\3\4 3D/3dmodel.model", "3MF" },
                  { "PK\3\4 liver.stl", "a ZIP archive" },
                  { "\xef\xbb\xbf<?xml version=\"1.0\"?><COLLADA xmlns=\"x\">", "COLLADA" },
                  { "$MeshFormat\n4.1 0 8\n", "a mesh of Gmsh" },
                  { "\x1f\x8b\x08", "compressed by gzip" } };
    static const char *const others[] = { "{\"a\": 1}", "<robot>", "# vtk\nv 0 0 0\n", "PK", "", "<", "$Mesh" };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const unsigned char *bytes = (const unsigned char *)cases[i].content;
        const size_t size = strlen(cases[i].content);
        const struct foreign_format *foreign = foreign_format_of(bytes, size);
        reading r;
        CHECK(foreign && strcmp(foreign->name, cases[i].name) == 0, "%s: %s", cases[i].name,
              foreign ? foreign->name : "none");
        CHECK(source_format("organ.stl", bytes, size) == DPT_FORMAT_AUTO, "%s is read", cases[i].name);
        read_bytes(&r, DPT_FORMAT_AUTO, bytes, size, NULL);
        CHECK(r.result == DPT_E_FORMAT && strstr(r.diag.text, cases[i].name) && strstr(r.diag.text, "make it an STL"),
              "%s", r.diag.text);
        soup_free(&r.soup);
    }
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        CHECK(!foreign_format_of((const unsigned char *)others[i], strlen(others[i])), "%s", others[i]);
}

int main(int argc, char **argv)
{
    if (argc > 1)
        golden = argv[1];
    TEST(foreign_formats_are_told);
    TEST(what_follows_an_stl_is_noted);
    TEST(axes_of_slicer_are_noted);
    return check_report();
}
