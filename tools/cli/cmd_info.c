/* SPDX-License-Identifier: BSD-3-Clause */
/* dynpoint info: what a compiled mesh or arm holds and what the compiler found. */
#include "cli/cmd_info.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "cli/arm_file.h"
#include "cli/command_options.h"
#include "cli/commands.h"
#include "scene/host_file.h"

static const char help[] =
    "usage: dynpoint info FILE.dpa [--json] [--verify] [--sections] [--thickness]\n"
    "\n"
    "Shows what a compiled mesh holds, and what was wrong with its source; or the joints, links, tool\n"
    "and bodies of an arm.\n"
    "\n"
    "  --json       one JSON object on standard output, a mesh's sections too\n"
    "  --verify     check every byte; exit status 1, with the place, when the file is damaged\n"
    "  --sections   of a mesh: where each section of the file lies, and its checksum\n"
    "  --thickness  of a mesh: how thick its walls are, by a ray inward from each triangle; takes\n"
    "               a second for 50,000 triangles\n";

/* Cells of a lattice that lie across what a tool touches: with fewer its force is more than a tenth too high. */
enum { CELLS_ACROSS = 4 };

/* m: a cell of the lattice in which springs carry the vertices: its shortest spring. 0: there is none. */
static double lattice_cell(const dpt_mesh *mesh, const dpt_mesh_info *info)
{
    dpt_mesh_springs springs = { .size = sizeof springs };
    double shortest = 0.0;
    if (!info->nodes || !info->spring_nodes || dpt_mesh_get_springs(mesh, &springs) != DPT_OK)
        return 0.0;
    for (size_t i = 0; i < 16 * (size_t)info->spring_entries; i++)
        if (springs.stiffness[i] > 0.0f && (!(shortest > 0.0) || (double)springs.length[i] < shortest))
            shortest = (double)springs.length[i];
    return shortest;
}

/* m: a tool that is pressed in by a quarter of its radius touches what is as wide as its radius. */
static double tool_radius_for(double cell)
{
    return CELLS_ACROSS * cell;
}

void print_mesh_json(const dpt_mesh *mesh, const dpt_mesh_info *info, const struct mesh_thickness *thickness)
{
    printf("{\"triangles\":%" PRIu32 ",\"vertices\":%" PRIu32 ",\"scale\":%.17g,\"rounding\":%.17g,", info->triangles,
           info->vertices, info->scale, info->rounding);
    printf("\"open_edges\":%" PRIu32 ",\"nonmanifold_edges\":%" PRIu32 ",\"wrong_way_edges\":%" PRIu32
           ",\"components\":%" PRIu32 ",\"closed_components\":%" PRIu32 ",\"inward_components\":%" PRIu32
           ",\"turned_triangles\":%" PRIu32 ",\"solid_components\":%" PRIu32 ",\"cavities\":%" PRIu32
           ",\"winding_components\":%" PRIu32 ",\"buried_components\":%" PRIu32 ",",
           info->open_edges, info->nonmanifold_edges, info->wrong_way_edges, info->components, info->closed_components,
           info->inward_components, info->turned_triangles, info->solid_components, info->cavities,
           info->winding_components, info->buried_components);
    if (info->self_intersections == DPT_NONE)
        printf("\"self_intersections\":null,\"self_intersections_more\":null,");
    else
        printf("\"self_intersections\":%" PRIu32 ",\"self_intersections_more\":%s,", info->self_intersections,
               info->self_intersections_more ? "true" : "false");
    printf("\"dropped\":{\"degenerate\":%" PRIu32 ",\"duplicate\":%" PRIu32 "},", info->dropped_degenerate,
           info->dropped_duplicate);
    printf("\"unused_vertices\":%" PRIu32 ",\"concave_polygons\":%" PRIu32 ",\"source\":{\"triangles\":%" PRIu32
           ",\"vertices\":%" PRIu32 ",\"bytes\":%" PRIu64 ",\"hash\":\"%016" PRIx64 "\"},",
           info->unused_vertices, info->concave_polygons, info->source_triangles, info->source_vertices,
           info->source_bytes, info->source_hash);
    printf("\"nodes\":%" PRIu32 ",\"outside_vertices\":%" PRIu32 ",\"outside_distance\":%.17g,", info->nodes,
           info->outside_vertices, info->outside_distance);
    printf("\"spring_nodes\":%" PRIu32 ",\"springs\":%" PRIu32 ",\"spring_entries\":%" PRIu32
           ",\"fixed_nodes\":%" PRIu32 ",\"viscosity\":%.17g,\"spring_mass\":%.17g,"
           "\"poisson\":%.17g,\"stable_step\":%.17g,",
           info->spring_nodes, info->springs, info->spring_entries, info->fixed_nodes, info->viscosity,
           info->spring_mass, info->poisson, info->stable_step);
    const double cell = lattice_cell(mesh, info);
    if (cell > 0.0)
        printf("\"lattice_cell\":%.17g,\"tool_radius\":%.17g,", cell, tool_radius_for(cell));
    else
        printf("\"lattice_cell\":null,\"tool_radius\":null,");
    printf("\"box\":[[%.17g,%.17g,%.17g],[%.17g,%.17g,%.17g]],", info->box_min[0], info->box_min[1], info->box_min[2],
           info->box_max[0], info->box_max[1], info->box_max[2]);
    printf("\"origin\":[%.17g,%.17g,%.17g],", info->origin[0], info->origin[1], info->origin[2]);
    printf("\"crease_edges\":%" PRIu32 ",\"normalless_vertices\":%" PRIu32 ",\"crease\":%.17g,", info->crease_edges,
           info->normalless_vertices, info->crease);
    if (thickness && thickness->walls)
        printf("\"thickness\":{\"walls\":%" PRIu32 ",\"least\":%.17g,\"low\":%.17g,\"triangle\":%" PRIu32 "},",
               thickness->walls, thickness->min, thickness->low, thickness->triangle);
    else if (thickness)
        printf("\"thickness\":{\"walls\":0,\"least\":null,\"low\":null,\"triangle\":null},");
    printf("\"format\":%" PRIu32 ",\"tree_levels\":%" PRIu32 ",\"bytes\":%" PRIu64 ",\"sections\":[",
           info->format_version, info->tree_levels, info->bytes);
    dpt_mesh_section section = { .size = sizeof section };
    for (uint32_t i = 0; dpt_mesh_get_section(mesh, i, &section) == DPT_OK; i++)
        printf("%s{\"name\":\"%s\",\"offset\":%" PRIu64 ",\"bytes\":%" PRIu64 ",\"crc32\":\"%08" PRIx32 "\"}",
               i ? "," : "", section.name, section.offset, section.bytes, section.crc32);
    printf("]}\n");
}

static void print_counts(const dpt_mesh_info *info)
{
    const struct {
        const char *name;
        uint32_t count;
    } rows[] = {
        { "triangles", info->triangles },
        { "vertices", info->vertices },
        { "components", info->components },
        { "  closed", info->closed_components },
        { "  wound inward, turned", info->inward_components },
        { "  with an inside", info->solid_components },
        { "  walls of cavities", info->cavities },
        { "  within another one", info->buried_components },
        { "  by winding number", info->winding_components },
        { "open edges", info->open_edges },
        { "non-manifold edges", info->nonmanifold_edges },
        { "wrong-way edges", info->wrong_way_edges },
        { "creases", info->crease_edges },
        { "triangles turned", info->turned_triangles },
        { "degenerate, dropped", info->dropped_degenerate },
        { "duplicate, dropped", info->dropped_duplicate },
        { "unused vertices", info->unused_vertices },
        { "vertices without normal", info->normalless_vertices },
        { "concave polygons", info->concave_polygons },
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        printf("  %-24s %10" PRIu32 "\n", rows[i].name, rows[i].count);
    if (info->self_intersections == DPT_NONE)
        printf("  %-24s %10s\n", "self-intersections", "not known");
    else
        printf("  %-24s %10" PRIu32 "%s\n", "self-intersections", info->self_intersections,
               info->self_intersections_more ? " or more" : "");
}

static void print_thickness(const struct mesh_thickness *thickness)
{
    if (thickness->walls)
        printf("  %-24s %10.6g m at triangle %" PRIu32 "; a hundredth of %" PRIu32 " walls have at most %.6g m\n",
               "thinnest wall", thickness->min, thickness->triangle, thickness->walls, thickness->low);
    else
        printf("  %-24s %10s\n", "thinnest wall", "none");
}

static void print_text(const char *path, const dpt_mesh *mesh, const dpt_mesh_info *info,
                       const struct mesh_thickness *thickness, int has_sections)
{
    printf("%s: dynpoint mesh, format %" PRIu32 ", %" PRIu64 " bytes, %.1f a triangle\n", path, info->format_version,
           info->bytes, (double)info->bytes / info->triangles);
    print_counts(info);
    printf("  %-24s %10.6g m per unit, rounded by at most %.3g m\n", "scale", info->scale, info->rounding);
    printf("  %-24s %10.6g x %.6g x %.6g m from (%.6g, %.6g, %.6g)\n", "box", info->box_max[0] - info->box_min[0],
           info->box_max[1] - info->box_min[1], info->box_max[2] - info->box_min[2], info->box_min[0], info->box_min[1],
           info->box_min[2]);
    if (info->origin[0] != 0.0 || info->origin[1] != 0.0 || info->origin[2] != 0.0)
        printf("  %-24s %10.9g, %.9g, %.9g m: its origin is there in the source\n", "moved to the origin from",
               info->origin[0], info->origin[1], info->origin[2]);
    if (size_hint(info))
        printf("  %-24s %s, of dynpoint compile\n", "", size_hint(info));
    if (thickness)
        print_thickness(thickness);
    if (info->crease > 0.0)
        printf("  %-24s %10.6g degrees\n", "crease", info->crease * (180.0 / 3.14159265358979323846));
    if (info->nodes) {
        printf("  %-24s %10" PRIu32 "\n", "nodes, embedded in", info->nodes);
        printf("  %-24s %10" PRIu32 ", at most %.3g m\n", "  vertices outside", info->outside_vertices,
               info->outside_distance);
    }
    if (info->spring_nodes) {
        printf("  %-24s %10" PRIu32 " between %" PRIu32 " nodes, %" PRIu32 " of them fixed\n", "springs", info->springs,
               info->spring_nodes, info->fixed_nodes);
        printf("  %-24s %10.6g kg, Poisson's ratio %.4g, viscosity %.4g s\n", "  mass", info->spring_mass,
               info->poisson, info->viscosity);
        printf("  %-24s %10.6g s: of symplectic Euler without damping\n", "  stable step", info->stable_step);
        const double cell = lattice_cell(mesh, info);
        if (cell > 0.0)
            printf("  %-24s %10.6g m; felt within a tenth by round tools of a radius of %.3g m or more\n",
                   "  cell of the lattice", cell, tool_radius_for(cell));
    }
    if (info->source_bytes)
        printf("  %-24s %10" PRIu64 " bytes, hash %016" PRIx64 "\n", "source", info->source_bytes, info->source_hash);
    dpt_mesh_section section = { .size = sizeof section };
    for (uint32_t i = 0; has_sections && dpt_mesh_get_section(mesh, i, &section) == DPT_OK; i++)
        printf("  section %-16s %10" PRIu64 " bytes at %-10" PRIu64 " crc %08" PRIx32 "\n", section.name, section.bytes,
               section.offset, section.crc32);
}

/* A damaged file is an answer, no error: exit status 1, and its place on standard output. */
static int verify(const char *path)
{
    size_t size;
    dpt_mesh_fault fault = { .size = sizeof fault };
    void *bytes = load_file("info", path, &size);
    if (!bytes)
        return 2;
    dpt_result result =
        host_file_is_arm(bytes, size) ? dpt_arm_convert(bytes, size, &fault) : dpt_mesh_convert(bytes, size, &fault);
    if (result == DPT_OK)
        printf("%s: sound, %zu bytes\n", path, size);
    else
        printf("%s: damaged at byte %" PRIu64 " (%s): %s\n", path, fault.byte, fault.section, dpt_result_text(result));
    free(bytes);
    return result == DPT_OK ? 0 : 1;
}

int command_info(int argc, char **argv)
{
    const char *path;
    int json = 0, check = 0, is_measured = 0, has_sections = 0;
    size_t operands;
    const struct option_def options[] = { { .name = "--json", .flag = &json },
                                          { .name = "--verify", .flag = &check },
                                          { .name = "--sections", .flag = &has_sections },
                                          { .name = "--thickness", .flag = &is_measured } };
    static const struct operand_def taken[] = { { .kind = VALUE_FILE } };
    int status = parse_options(argc, argv, COMMAND_SYNTAX(options, help, taken), &path, 1, &operands);
    if (status >= 0)
        return status;
    if (operands != 1)
        return complain("info", "a file is needed (see --help)");
    if (check && is_measured)
        return complain("info", "--verify does not go with --thickness");
    if (check && !json)
        return verify(path);
    size_t size;
    struct mesh_thickness thickness;
    dpt_mesh_info info = { .size = sizeof info };
    void *bytes = load_file("info", path, &size);
    if (!bytes)
        return 2;
    const dpt_mesh *mesh = NULL;
    const dpt_arm *arm = NULL;
    if (host_file_is_arm(bytes, size))
        arm = open_arm("info", path, bytes, size);
    else
        mesh = open_mesh("info", path, bytes, size);
    if (arm && is_measured) {
        free(bytes);
        return complain("info", "%s: --thickness is of a mesh; this is an arm", path);
    }
    if (mesh && is_measured && mesh_thickness_measure("info", mesh, &thickness)) {
        free(bytes);
        return 2;
    }
    if (arm && json) {
        print_arm_json(arm);
    } else if (arm) {
        print_arm_text(path, arm);
    } else if (mesh) {
        dpt_mesh_get_info(mesh, &info);
        if (json)
            print_mesh_json(mesh, &info, is_measured ? &thickness : NULL);
        else
            print_text(path, mesh, &info, is_measured ? &thickness : NULL, has_sections);
    }
    free(bytes);
    return arm || mesh ? 0 : check ? 1 : 2;
}
