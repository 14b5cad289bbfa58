/* SPDX-License-Identifier: BSD-3-Clause */
/* dynpoint compile: a mesh or a robot's description in, a .dpa file out. */
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli/arm_file.h"
#include "cli/cmd_info.h"
#include "cli/command_options.h"
#include "cli/commands.h"
#include "cli/compile_list.h"
#include "cli/compile_options.h"
#include "compile/foreign.h"
#include "compile/soup.h"
#include "dynpoint/compile.h"
#include "platform/file.h"
#include "shape/mesh_file.h"
#include "shape/mesh_size.h"

static const char help[] =
    "usage: dynpoint compile IN -o OUT.dpa [--unit UNIT | --scale X] [--crease DEGREES]\n"
    "                        [--recentre] [--c-array NAME] [--json] [-j N] [--nodes BASE]\n"
    "                        [--springs KIND ...] [--tool LINK] [--packages DIRS] [--skip LINK ...]\n"
    "                        [--without-scene]\n"
    "       dynpoint compile --list MANIFEST -o RESULTS.tsv [-j N] [--unit UNIT ...]\n"
    "\n"
    "Compiles an OBJ, STL, PLY or OFF mesh into a file that is used in place, by mmap or from flash.\n"
    "Joins equal vertices, drops degenerate and duplicate triangles, turns closed parts outward; says\n"
    "how large it is and what it found. Anything else compiles as it is. IN may be a pipe; - is standard\n"
    "input.\n"
    "\n"
    "Or a URDF, by its ending .urdf or .xml or by its <robot>: the arm between the root and the tool,\n"
    "with the tool's capsules and the meshes and boxes that stand still. What is left out is noted on\n"
    "standard error.\n"
    "\n"
    "  -o FILE         where to; - is standard output\n"
    "  --unit UNIT     of the source: mm, cm, m or in; default m. A largest side outside of 5 mm to 3 m\n"
    "                  is noted on standard error\n"
    "  --scale X       any other unit: metres of one; --unit mm is --scale 0.001\n"
    "  --crease A      edges bent by more than A degrees are creases: sharp; default 60, 180 is none\n"
    "  --recentre      move the mesh to the origin, and keep in the file by how much; for a source that\n"
    "                  lies so far away that floats are too coarse for it\n"
    "  --c-array NAME  write C source that holds the bytes in an array of that name\n"
    "  --list FILE     compile many: lines IN, a tab, OUT. RESULTS.tsv has a line for each: IN, OUT, DPT_OK or\n"
    "                  an error's name, SHA-256 of the file, seconds, a note. -j N: N at a time. What is\n"
    "                  done is not done again when the command is called again\n"
    "  --json          tell what dynpoint info --json tells of it, instead of the report\n"
    "  -j N            use at most N threads; default 1; the bytes are the same for every N\n"
    "  --nodes BASE    embed the vertices in the tetrahedra of TetGen's BASE.node and BASE.ele, in the\n"
    "                  mesh's unit: physics that moves the nodes moves the mesh\n"
    "  --springs KIND  make masses and springs: sheet (in the surface) or volume (a lattice in the closed\n"
    "                  parts). Lengths in m, of the compiled mesh:\n"
    "                  --young PA (5000), --density KG/M3 (1000), --drag 1/S (0), --viscosity S (0);\n"
    "                  of a sheet --thickness M (0.001), --bending PA (none); of a volume --spacing M,\n"
    "                  --poisson R (0.25, springs alone; 0.1 to 0.45)\n"
    "  --regions FILE  other materials, and what is fixed: lines `box X0 Y0 Z0 X1 Y1 Z1 E DENSITY DRAG`,\n"
    "                  `sphere X Y Z R E DENSITY DRAG`, or `fixed` in place of the last three\n"
    "  --fixed FILE    numbers of vertices of the source, from 0, that do not move\n"
    "  --tool LINK     of a URDF: the link that is the tool; default: the only one without children\n"
    "  --packages DIRS of a URDF: folders that hold the packages of package://, ':' between them (Windows:\n"
    "                  ';'); then those of ROS_PACKAGE_PATH, the share folders of AMENT_PREFIX_PATH, and\n"
    "                  those above the file are looked at\n"
    "  --skip LINK     of a URDF: leave out the collision shapes of this link; may be given several times\n"
    "  --without-scene of a URDF: leave out the meshes and boxes that stand still\n";

#define DEGREE (3.14159265358979323846 / 180.0)

/* What callbacks are handed. */
struct listener {
    struct meter meter;
    const char *in; /* the source */
};

static int show_progress(void *user, const char *step, double done)
{
    struct listener *listener = user;
    meter_show(&listener->meter, step, done < 1.0 ? done : 0.999);
    return 0;
}

static void show_note(void *user, const dpt_diag *note)
{
    struct listener *listener = user;
    meter_show(&listener->meter, "", 1.0);
    if (note->line)
        fprintf(stderr, "%s:%" PRIu64 ": note: %s\n", listener->in, note->line, note->text);
    else if (note->byte)
        fprintf(stderr, "%s: byte %" PRIu64 ": note: %s\n", listener->in, note->byte, note->text);
    else
        fprintf(stderr, "%s: note: %s\n", listener->in, note->text);
}

/* Keywords of C and C++, and names that the written file uses. */
static const char taken_names[] =
    " alignas alignof and and_eq asm auto bitand bitor bool break case catch char char16_t "
    "char32_t char8_t class co_await co_return co_yield compl concept const const_cast "
    "consteval constexpr constinit continue decltype default delete do double dynamic_cast "
    "else enum explicit export extern false float for friend goto if inline int long main "
    "mutable namespace new noexcept not not_eq nullptr operator or or_eq private protected "
    "public register reinterpret_cast requires restrict return short signed size_t sizeof "
    "static static_assert static_cast std struct switch template this thread_local throw "
    "true try typedef typeid typename typeof typeof_unqual uint64_t union unsigned using "
    "virtual void volatile wchar_t while xor xor_eq DPA_ALIGNED NULL _Alignas _Alignof "
    "_Atomic _BitInt _Bool _Complex _Decimal128 _Decimal32 _Decimal64 _Generic _Imaginary "
    "_Noreturn _Static_assert _Thread_local ";

static int is_c_name(const char *name)
{
    char between_blanks[24];
    snprintf(between_blanks, sizeof between_blanks, " %s ", name);
    if (!*name || (*name >= '0' && *name <= '9') || strstr(taken_names, between_blanks))
        return 0;
    for (; *name; name++)
        if (!((*name >= 'a' && *name <= 'z') || (*name >= 'A' && *name <= 'Z') || (*name >= '0' && *name <= '9') ||
              *name == '_'))
            return 0;
    return 1;
}

/*
 * Write words of 8 bytes: compilers need a fifth of the time and memory that they need for single bytes, and align the
 * array by themselves.
 */
static void write_c_array(FILE *file, const char *name, const char *kind, const dpt_compiled *compiled)
{
    const unsigned char *byte = compiled->bytes;
    size_t size = compiled->size, words = (size + 7) / 8;
    fprintf(file,
            "/*\n"
            " * A dynpoint %s of %zu bytes: dpt_%s_open(%s, %s_size, &%s).\n"
            " *\n"
            " *     extern const uint64_t %s[];\n"
            " *     extern const size_t %s_size;\n"
            " */\n"
            "#include <stddef.h>\n#include <stdint.h>\n\n"
            "#ifdef __GNUC__\n#define DPA_ALIGNED __attribute__((aligned(64)))\n"
            "#else\n#define DPA_ALIGNED\n#endif\n\n"
            "#if defined __BYTE_ORDER__ && __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__\n"
            "#define SWAPPED(x) \\\n"
            "    ((x) >> 56 | ((x) >> 40 & 0xff00) | ((x) >> 24 & 0xff0000) | \\\n"
            "     ((x) >> 8 & 0xff000000) | ((x) & 0xff000000) << 8 | ((x) & 0xff0000) << 24 | \\\n"
            "     ((x) & 0xff00) << 40 | (x) << 56)\n"
            "#define W(x) SWAPPED((uint64_t)x)\n"
            "#else\n#define W(x) x\n#endif\n\n"
            "#ifdef __cplusplus\nextern \"C\" {\n#endif\n"
            "extern const uint64_t %s[%zu];\nextern const size_t %s_size;\n"
            "#ifdef __cplusplus\n}\n#endif\n\n"
            "const size_t %s_size = %zu;\n"
            "const uint64_t %s[%zu] DPA_ALIGNED = {",
            kind, size, kind, name, name, kind, name, name, name, words, name, name, size, name, words);
    for (size_t i = 0; i < words; i++) {
        uint64_t word = 0;
        for (size_t k = 0; k < 8 && 8 * i + k < size; k++)
            word |= (uint64_t)byte[8 * i + k] << 8 * k;
        fprintf(file, "%sW(0x%" PRIx64 "u),", i % 4 ? "" : "\n", word);
    }
    fputs("\n};\n", file);
}

static void report_embedding(FILE *file, const dpt_mesh_info *info)
{
    if (!info->nodes)
        return;
    fprintf(file, "  embedded in %" PRIu32 " nodes: ", info->nodes);
    if (info->outside_vertices)
        fprintf(file, "%" PRIu32 " vertices outside of all cells, at most %.3g m\n", info->outside_vertices,
                info->outside_distance);
    else
        fputs("all vertices are within cells\n", file);
}

static void report_origin(FILE *file, const dpt_mesh_info *info)
{
    const double *origin = info->origin;
    if (origin[0] != 0.0 || origin[1] != 0.0 || origin[2] != 0.0)
        fprintf(file, "  moved by (%.9g, %.9g, %.9g) m, rounded by at most %.3g m\n", 0.0 - origin[0], 0.0 - origin[1],
                0.0 - origin[2], info->rounding);
}

static void report_springs(FILE *file, const dpt_mesh_info *info)
{
    if (!info->spring_nodes)
        return;
    fprintf(file,
            "  %" PRIu32 " springs between %" PRIu32 " nodes, %" PRIu32 " of them fixed: %.4g kg, "
            "Poisson's ratio %.2f, stable up to %.3g s\n",
            info->springs, info->spring_nodes, info->fixed_nodes, info->spring_mass, info->poisson, info->stable_step);
    if (!info->fixed_nodes)
        fprintf(
            file,
            "  nothing holds it: a tool pushes it away, and gravity lets it fall; --regions or --fixed holds a part\n");
}

static void print_json(const dpt_compiled *compiled, int is_arm)
{
    const dpt_mesh *mesh;
    const dpt_arm *arm;
    dpt_mesh_info info = { .size = sizeof info };
    if (is_arm && dpt_arm_open(compiled->bytes, compiled->size, &arm) == DPT_OK)
        print_arm_json(arm);
    else if (!is_arm && dpt_mesh_open(compiled->bytes, compiled->size, &mesh) == DPT_OK &&
             dpt_mesh_get_info(mesh, &info) == DPT_OK)
        print_mesh_json(mesh, &info, NULL);
}

static dpt_mesh_info info_of(const dpt_compiled *compiled)
{
    const dpt_mesh *mesh;
    dpt_mesh_info info = { .size = sizeof info };
    if (dpt_mesh_open(compiled->bytes, compiled->size, &mesh) == DPT_OK)
        dpt_mesh_get_info(mesh, &info);
    return info;
}

static void report_mesh(FILE *file, const dpt_compiled *compiled, const char *out)
{
    const dpt_mesh_info info = info_of(compiled);
    fprintf(file,
            "%s: %" PRIu32 " triangles, %" PRIu32 " vertices, %" PRIu32 " part%s (%" PRIu32
            " closed), %.1f MB\n  box %s\n",
            out, info.triangles, info.vertices, info.components, info.components == 1 ? "" : "s",
            info.closed_components, (double)info.bytes / 1e6, size_text(&info).text);
    const struct {
        const char *what;
        uint32_t count;
    } found[] = {
        { "degenerate triangles dropped", info.dropped_degenerate },
        { "duplicate triangles dropped", info.dropped_duplicate },
        { "unused vertices left out", info.unused_vertices },
        { "parts wound inward, turned", info.inward_components },
        { "triangles turned", info.turned_triangles },
        { "edges run through twice in one direction", info.wrong_way_edges },
        { "open edges", info.open_edges },
        { "non-manifold edges", info.nonmanifold_edges },
        { "concave polygons", info.concave_polygons },
    };
    for (size_t i = 0; i < sizeof found / sizeof *found; i++)
        if (found[i].count)
            fprintf(file, "  %8" PRIu32 " %s\n", found[i].count, found[i].what);
    const uint32_t pairs = info.self_intersections, *pair = info.self_intersection;
    const int one = pairs == 1 && !info.self_intersections_more;
    if (pairs)
        fprintf(file, "  self-intersections: %" PRIu32 "%s of triangles, %s%" PRIu32 " and %" PRIu32 "\n", pairs,
                one                            ? " pair"
                : info.self_intersections_more ? " or more pairs"
                                               : " pairs",
                one ? "" : "such as ", pair[0], pair[1]);
    else if (info.self_intersections_more)
        fputs("  self-intersections: none found, but the search stopped before its end\n", file);
    report_origin(file, &info);
    report_embedding(file, &info);
    report_springs(file, &info);
}

static void note_size(const dpt_compiled *compiled, const char *in)
{
    const dpt_mesh_info info = info_of(compiled);
    const char *hint = size_hint(&info);
    if (hint)
        fprintf(stderr, "%s: note: its box is %s: %s\n", in, size_text(&info).text, hint);
}

/* Name the command that makes a foreign file one that is read. */
static int complain_of_format(const char *in, const struct foreign_format *foreign)
{
    static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._/-";
    char way[512];
    const char *from = strcmp(in, "-") && !in[strspn(in, plain)] && strlen(in) < 200 ? in : "IN";
    snprintf(way, sizeof way, foreign->command, from, "OUT.stl");
    if (!foreign->packages)
        return complain("compile", "%s: this is %s: %s, %s", in, foreign->name, way, foreign->unit);
    return complain("compile", "%s: this is %s: python3 -c \"%s\" (after pip install %s), then compile OUT.stl with %s",
                    in, foreign->name, way, foreign->packages, foreign->unit);
}

static int compile_mesh(const char *in, const void *bytes, size_t size, dpt_compile_def *def, dpt_compiled *compiled)
{
    dpt_diag diag = { .size = sizeof diag };
    def->format = source_format(in, bytes, size);
    const struct foreign_format *foreign = def->format == DPT_FORMAT_AUTO ? foreign_format_of(bytes, size) : NULL;
    if (foreign)
        return complain_of_format(in, foreign);
    if (dpt_compile_bytes(bytes, size, def, compiled, &diag) == DPT_OK)
        return 0;
    return complain_of_file("compile", in, &diag);
}

/*
 * Compile a mesh, which is opened once and may be a pipe, or a URDF, whose reader needs the path to find what it names.
 */
static int compile_input(const char *in, dpt_compile_def *def, const struct arm_options *arm, dpt_compiled *compiled,
                         int *is_arm)
{
    struct file_status found;
    size_t size;
    int status;
    *is_arm = is_urdf_name(in);
    if (*is_arm && (def->cell_count || def->springs))
        return complain("compile", "%s: --nodes and --springs are for a mesh", in);
    if (*is_arm)
        return compile_urdf(in, def, arm, compiled);
    void *bytes = load_file("compile", in, &size);
    if (!bytes)
        return 2;
    *is_arm = is_urdf_text(bytes);
    if (*is_arm && (file_get_status(in, &found) != 0 || !found.is_regular))
        status = complain("compile",
                          "%s: a URDF is read from a file, not from a pipe: what it names is looked for beside it", in);
    else if (*is_arm && (def->cell_count || def->springs))
        status = complain("compile", "%s: --nodes and --springs are for a mesh", in);
    else if (*is_arm)
        status = compile_urdf(in, def, arm, compiled);
    else if (arm_options_are_given(arm))
        status = complain("compile", "%s: --tool, --packages, --skip and --without-scene are for a URDF", in);
    else
        status = compile_mesh(in, bytes, size, def, compiled);
    free(bytes);
    return status;
}

/* What the user says. */
struct compile_settings {
    const char *in, *out, *array, *unit, *nodes, *list;
    struct arm_options arm;
    double scale, crease;
    int recentre, json;
    uint64_t threads;
    struct spring_options springs;
};

/* The same with cells, where there are any, or with springs. */
static int compile_with_nodes(struct compile_settings *settings, dpt_compile_def *def, dpt_compiled *compiled,
                              int *is_arm)
{
    const char *nodes = settings->nodes;
    struct cell_files cells = { .node_path = NULL };
    int status = spring_options_take(&settings->springs, "compile", settings->out, def);
    if (nodes && def->recentre)
        status = complain("compile", "--nodes and --recentre exclude each other: the nodes would stay where they are");
    if (nodes && def->springs)
        status = complain("compile", "--nodes and --springs exclude each other");
    if (nodes && status == 0)
        status = cell_files_name(&cells, "compile", nodes);
    if (nodes && status == 0)
        status = output_check("compile", settings->out, (const char *const[]){ cells.node_path, cells.ele_path, NULL });
    if (nodes && status == 0)
        status = cell_files_load(&cells, "compile", def);
    if (status == 0)
        status = compile_input(settings->in, def, &settings->arm, compiled, is_arm);
    cell_files_free(&cells);
    spring_options_free(&settings->springs);
    return status;
}

/* Returns -1 to go on, else the exit status. */
static int read_settings(struct compile_settings *settings, int argc, char **argv)
{
    size_t operands;
    struct spring_options *springs = &settings->springs;
    *settings = (struct compile_settings){ .scale = NAN, .crease = 60.0, .threads = 1 };
    spring_options_init(springs);
    const struct option_def options[] = { { .name = "-o", .text = &settings->out, .kind = VALUE_FILE },
                                          { .name = "--list", .text = &settings->list, .kind = VALUE_FILE },
                                          { .name = "--json", .flag = &settings->json },
                                          { .name = "-j", .count = &settings->threads },
                                          { .name = "--unit", .text = &settings->unit, .words = unit_words },
                                          { .name = "--scale", .number = &settings->scale },
                                          { .name = "--crease", .number = &settings->crease },
                                          { .name = "--recentre", .flag = &settings->recentre },
                                          { .name = "--c-array", .text = &settings->array },
                                          { .name = "--nodes", .text = &settings->nodes, .kind = VALUE_FILE },
                                          { .name = "--springs", .text = &springs->kind, .words = spring_kinds },
                                          { .name = "--young", .number = &springs->young },
                                          { .name = "--density", .number = &springs->density },
                                          { .name = "--drag", .number = &springs->drag },
                                          { .name = "--viscosity", .number = &springs->viscosity },
                                          { .name = "--thickness", .number = &springs->thickness },
                                          { .name = "--bending", .number = &springs->bending },
                                          { .name = "--spacing", .number = &springs->spacing },
                                          { .name = "--poisson", .number = &springs->poisson },
                                          { .name = "--regions", .text = &springs->regions_path, .kind = VALUE_FILE },
                                          { .name = "--fixed", .text = &springs->fixed_path, .kind = VALUE_FILE },
                                          { .name = "--tool", .text = &settings->arm.tool },
                                          { .name = "--packages", .text = &settings->arm.packages, .kind = VALUE_FILE },
                                          { .name = "--skip", .texts = &settings->arm.skip },
                                          { .name = "--without-scene", .flag = &settings->arm.without_scene } };
    static const struct operand_def taken[] = { { .kind = VALUE_FILE } };
    int status = parse_options(argc, argv, COMMAND_SYNTAX(options, help, taken), &settings->in, 1, &operands);
    if (status >= 0)
        return status;
    if (settings->list && (operands || !settings->out))
        return complain("compile", "--list names the inputs: -o RESULTS.tsv is needed, and no other file");
    if (!settings->list && (operands != 1 || !settings->out))
        return complain("compile", "an input file and -o FILE are needed (see --help)");
    return -1;
}

/* Returns 0, or 2 after a message. */
static int check_settings(struct compile_settings *settings)
{
    const char *out = settings->out, *unit = settings->unit;
    struct file_status there;
    if (output_check("compile", out, (const char *const[]){ settings->list ? settings->list : settings->in, NULL }))
        return 2;
    if (settings->list && (settings->array || settings->nodes || settings->json || strcmp(out, "-") == 0 ||
                           arm_options_are_given(&settings->arm)))
        return complain("compile", "--list takes neither --c-array, --nodes, --json, -o - nor what is for a URDF");
    if ((mesh_file_writer(out) || is_urdf_name(out)) && file_get_status(out, &there) == 0)
        return complain("compile", "%s: it is there, and a source by its name: what is compiled ends in .dpa", out);
    if (settings->array  ? output_check_name("compile", out, ".c .h", "source text in C")
        : settings->list ? output_check_name("compile", out, ".tsv .txt", "a table")
                         : output_check_name("compile", out, ".dpa .obj .stl .ply .off", "a compiled mesh or arm"))
        return 2;
    if (!settings->threads)
        return complain("compile", "-j must be 1 or more");
    if (settings->json && strcmp(out, "-") == 0)
        return complain("compile", "--json and -o - both want standard output");
    if (unit && !isnan(settings->scale))
        return complain("compile", "--unit and --scale say the same: give one of them");
    if (isnan(settings->scale))
        settings->scale = unit ? unit_metres(unit) : 1.0;
    if (!(settings->scale > 0.0 && settings->scale <= 1e30))
        return complain("compile", "--scale must be above 0, at most 1e30");
    if (!(settings->crease > 0.0 && settings->crease <= 180.0))
        return complain("compile", "--crease must be 0 to 180 degrees, and not 0");
    if (settings->array && !is_c_name(settings->array))
        return complain("compile", "--c-array: '%s' is not a name that an array can have in C and C++",
                        settings->array);
    return 0;
}

/* Write the bytes, and report on them. Returns 0, or 2 after a message. */
static int keep_compiled(const struct compile_settings *settings, const dpt_compiled *compiled, int is_arm)
{
    struct output output;
    int status = output_open(&output, "compile", settings->out);
    if (status)
        return status;
    if (settings->array)
        write_c_array(output.file, settings->array, is_arm ? "arm" : "mesh", compiled);
    else
        fwrite(compiled->bytes, compiled->size, 1, output.file);
    status = output_complete(&output, "compile");
    if (status == 0) {
        if (settings->json)
            print_json(compiled, is_arm);
        else
            (is_arm ? report_arm : report_mesh)(strcmp(settings->out, "-") ? stdout : stderr, compiled, settings->out);
        status = output_keep(&output, "compile");
    }
    if (status == 0 && !is_arm)
        note_size(compiled, settings->in);
    return status;
}

static int compile_all(struct compile_settings *settings, dpt_compile_def *def)
{
    int status = spring_options_take(&settings->springs, "compile", settings->out, def);
    def->progress = NULL;
    if (status == 0)
        status = compile_list(settings->list, settings->out, def);
    spring_options_free(&settings->springs);
    return status;
}

int command_compile(int argc, char **argv)
{
    struct compile_settings settings;
    int is_arm, status = read_settings(&settings, argc, argv);
    if (status >= 0)
        return status;
    if (check_settings(&settings))
        return 2;
    struct listener listener = { .in = settings.in };
    dpt_compile_def def = { .size = sizeof def,
                            .scale = settings.scale,
                            .progress = show_progress,
                            .user = &listener,
                            .note = show_note,
                            .note_user = &listener,
                            .recentre = settings.recentre ? 1 : 0,
                            .crease = settings.crease * DEGREE,
                            .threads = settings.threads < UINT32_MAX ? (uint32_t)settings.threads : UINT32_MAX };
    if (settings.list)
        return compile_all(&settings, &def);
    dpt_compiled compiled;
    status = compile_with_nodes(&settings, &def, &compiled, &is_arm);
    meter_show(&listener.meter, "", 1.0);
    if (status != 0)
        return status;
    status = keep_compiled(&settings, &compiled, is_arm);
    dpt_compiled_free(&compiled);
    return status;
}
