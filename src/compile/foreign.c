/* SPDX-License-Identifier: BSD-3-Clause */
#include "compile/foreign.h"

#include <string.h>

/* How far the words are looked for that begin a file. */
#define HEAD_BYTES 4096u

#define BY_PYVISTA "import pyvista; pyvista.read('%s').extract_surface().triangulate().save('%s')"
#define BY_TRIMESH "import trimesh; trimesh.load('%s', force='mesh').export('%s')"

enum { VTK, GLTF, THREE_MF, COLLADA, GMSH, GZIP, ZIP };

static const struct foreign_format formats[] = {
    [VTK] = { "VTK", "pyvista", BY_PYVISTA, "--unit mm, if it is of mm: it does not say" },
    [GLTF] = { "glTF", "trimesh", BY_TRIMESH, "--unit m: that of glTF" },
    [THREE_MF] = { "3MF", "trimesh networkx lxml", BY_TRIMESH, "--unit mm, unless its <model unit=...> says another" },
    [COLLADA] = { "COLLADA", "trimesh pycollada", BY_TRIMESH, "--scale X of its <unit meter=\"X\">, else --unit m" },
    [GMSH] = { "a mesh of Gmsh", "pyvista meshio", BY_PYVISTA, "--unit mm, if it is of mm: it does not say" },
    [GZIP] = { "compressed by gzip", NULL, "gzip -dc '%s' | dynpoint compile - -o OUT.dpa",
               "with the --unit of what it holds" },
    [ZIP] = { "a ZIP archive", NULL, "unzip '%s'", "then compile what it holds" },
};

static int begins(const unsigned char *bytes, size_t size, const char *with)
{
    return size >= strlen(with) && memcmp(bytes, with, strlen(with)) == 0;
}

static int holds(const unsigned char *bytes, size_t size, const char *word)
{
    const size_t length = strlen(word);
    for (const unsigned char *at = bytes, *end = bytes + size; (size_t)(end - at) >= length; at++) {
        at = memchr(at, word[0], (size_t)(end - at) - length + 1);
        if (!at)
            return 0;
        if (memcmp(at, word, length) == 0)
            return 1;
    }
    return 0;
}

static const unsigned char *after_blanks(const unsigned char *bytes, const unsigned char *end)
{
    if (begins(bytes, (size_t)(end - bytes), "\xef\xbb\xbf"))
        bytes += 3;
    while (bytes < end && (*bytes == ' ' || *bytes == '\t' || *bytes == '\r' || *bytes == '\n'))
        bytes++;
    return bytes;
}

const struct foreign_format *foreign_format_of(const unsigned char *bytes, size_t size)
{
    const unsigned char *text = after_blanks(bytes, bytes + size);
    const size_t length = (size_t)(bytes + size - text), head = length < HEAD_BYTES ? length : HEAD_BYTES;
    if (begins(bytes, size, "\x1f\x8b"))
        return &formats[GZIP];
    if (begins(bytes, size, "PK\x03\x04"))
        return &formats[holds(bytes, size, "3D/3dmodel.model") ? THREE_MF : ZIP];
    if (begins(bytes, size, "glTF"))
        return &formats[GLTF];
    if (begins(text, length, "# vtk DataFile Version"))
        return &formats[VTK];
    if (begins(text, length, "$MeshFormat"))
        return &formats[GMSH];
    if (begins(text, length, "<") && holds(text, head, "<VTKFile"))
        return &formats[VTK];
    if (begins(text, length, "<") && holds(text, head, "<COLLADA"))
        return &formats[COLLADA];
    if (begins(text, length, "{") && holds(text, length, "\"asset\""))
        return &formats[GLTF];
    return NULL;
}
