/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Inside or outside by CGAL, which shoots rays through its AABB tree. A program of its own, never installed; it needs
 * neither our headers nor our library.
 *
 *     inside_cgal MESH.tri POINTS.csv OUT
 *
 * MESH.tri is as tests/bench/peer.h says; corners at one place become one vertex. POINTS.csv: x,y,z a line. OUT: -1
 * inside, 1 outside, 0 on the surface, a line each. The mesh must be closed and manifold.
 */
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <map>
#include <tuple>
#include <vector>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Side_of_triangle_mesh.h>
#include <CGAL/Surface_mesh.h>

typedef CGAL::Exact_predicates_inexact_constructions_kernel Kernel;
typedef CGAL::Surface_mesh<Kernel::Point_3> Surface;

static uint32_t word(std::FILE *file)
{
    uint32_t value = 0;
    for (int i = 0; i < 4; i++)
        value |= (uint32_t)(std::fgetc(file) & 255) << (8 * i);
    return value;
}

static float number(std::FILE *file)
{
    const uint32_t bits = word(file);
    float value;
    std::memcpy(&value, &bits, sizeof value);
    return value;
}

static bool read(const char *path, Surface &surface)
{
    std::FILE *file = std::fopen(path, "rb");
    if (!file)
        return false;
    const uint32_t vertices = word(file), triangles = word(file);
    std::map<std::tuple<float, float, float>, Surface::Vertex_index> places;
    std::vector<Surface::Vertex_index> vertex;
    bool good = true;
    for (uint32_t i = 0; i < vertices; i++) {
        const float x = number(file), y = number(file), z = number(file);
        const auto place = std::make_tuple(x, y, z);
        auto found = places.find(place);
        if (found == places.end())
            found = places.emplace(place, surface.add_vertex(Kernel::Point_3(x, y, z))).first;
        vertex.push_back(found->second);
    }
    for (uint32_t i = 0; i < triangles; i++) {
        const uint32_t a = word(file), b = word(file), c = word(file);
        good = good && a < vertices && b < vertices && c < vertices &&
               surface.add_face(vertex[a], vertex[b], vertex[c]) != Surface::null_face();
    }
    good = good && !std::ferror(file) && !std::feof(file) && CGAL::is_closed(surface);
    std::fclose(file);
    return good;
}

int main(int argc, char **argv)
{
    Surface surface;
    if (argc != 4 || !read(argv[1], surface)) {
        std::fprintf(stderr, "inside_cgal: a closed MESH.tri, POINTS.csv and OUT are needed\n");
        return 2;
    }
    std::FILE *points = std::fopen(argv[2], "r"), *out = std::fopen(argv[3], "w");
    if (!points || !out) {
        std::fprintf(stderr, "inside_cgal: %s or %s cannot be opened\n", argv[2], argv[3]);
        return 2;
    }
    const CGAL::Side_of_triangle_mesh<Surface, Kernel> side(surface);
    for (double x, y, z; std::fscanf(points, "%lf,%lf,%lf", &x, &y, &z) == 3;) {
        const CGAL::Bounded_side told = side(Kernel::Point_3(x, y, z));
        std::fprintf(out, "%d\n",
                     told == CGAL::ON_BOUNDED_SIDE     ? -1
                     : told == CGAL::ON_UNBOUNDED_SIDE ? 1
                                                       : 0);
    }
    std::fclose(points);
    return std::fclose(out) == 0 ? 0 : 2;
}
