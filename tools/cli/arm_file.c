/* SPDX-License-Identifier: BSD-3-Clause */
#include "cli/arm_file.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "built_with.h"
#include "cli/json_text.h"
#include "scene/host_file.h"
#include "text/open_file.h"

#ifdef DPT_HAS_URDF
#include "dynpoint/urdf.h"
#endif

int arm_options_are_given(const struct arm_options *options)
{
    return options->tool || options->packages || options->without_scene || options->skip.count > 0;
}

int is_urdf_name(const char *path)
{
    return host_file_ends_in(path, ".urdf") || host_file_ends_in(path, ".xml");
}

int is_urdf_text(const char *text)
{
    char head[4096] = { 0 };
    strncpy(head, text, sizeof head - 1);
    const char *at = head + (strncmp(head, "\xef\xbb\xbf", 3) ? 0 : 3);
    at += strspn(at, " \t\r\n");
    return *at == '<' && strstr(at, "<robot");
}

#ifdef DPT_HAS_URDF

static void show_note(void *user, uint64_t line, const char *text)
{
    if (line)
        fprintf(stderr, "%s:%" PRIu64 ": note: %s\n", (const char *)user, line, text);
    else
        fprintf(stderr, "%s: note: %s\n", (const char *)user, text);
}

/* Append the folders of a list (folder_length), with ':' between them, each with an ending. `to` has room. */
static void add_folders(char *to, const char *folders, const char *ending)
{
    for (const char *at = folders ? folders : ""; *at;) {
        const size_t length = folder_length(at);
        if (length)
            sprintf(to + strlen(to), "%s%.*s%s", *to ? ":" : "", (int)length, at, ending);
        at += length + (at[length] != '\0');
    }
}

/* The folders that hold packages: those given, then those of ROS 1 and ROS 2. The caller frees; NULL: no memory. */
static char *package_folders(const char *given)
{
    static const char share[] = "/share";
    const char *ros = getenv("ROS_PACKAGE_PATH"), *ament = getenv("AMENT_PREFIX_PATH");
    size_t size = 3 + (given ? strlen(given) : 0) + (ros ? strlen(ros) : 0);
    for (const char *at = ament ? ament : ""; *at; at++)
        size += 1 + (at[0] == ':' || at[0] == ';' || !at[1] ? sizeof share : 0);
    char *folders = calloc(1, size);
    if (folders) {
        add_folders(folders, given, "");
        add_folders(folders, ros, "");
        add_folders(folders, ament, share);
    }
    return folders;
}

int compile_urdf(const char *path, const dpt_compile_def *mesh, const struct arm_options *options,
                 dpt_compiled *compiled)
{
    const char *skip[OPTION_TEXTS_MAX + 1] = { NULL };
    char *packages = package_folders(options->packages);
    memcpy(skip, options->skip.text, options->skip.count * sizeof *skip);
    const dpt_urdf_def def = { .size = sizeof def,
                               .without_scene = options->without_scene ? 1 : 0,
                               .tool = options->tool,
                               .packages = packages,
                               .mesh = mesh,
                               .note = show_note,
                               .user = (char *)(uintptr_t)path,
                               .skip = skip };
    dpt_diag diag = { .size = sizeof diag };
    const dpt_result result = packages ? dpt_urdf_compile_file(path, &def, compiled, &diag) : DPT_E_MEMORY;
    if (!packages)
        return complain("compile", "%s: memory ran out", path);
    free(packages);
    if (result == DPT_OK)
        return 0;
    if (diag.line)
        return complain("compile", "%s:%" PRIu64 ": %s", path, diag.line, diag.text);
    return complain("compile", "%s: %s", path, diag.text);
}

#else

int compile_urdf(const char *path, const dpt_compile_def *mesh, const struct arm_options *options,
                 dpt_compiled *compiled)
{
    (void)mesh, (void)options, (void)compiled;
    return complain("compile",
                    "%s: this build reads no URDF: install urdfdom, expat and a C++ compiler (Debian: "
                    "liburdfdom-dev libexpat1-dev g++ pkg-config) and run make again",
                    path);
}

#endif

const dpt_arm *open_arm(const char *command, const char *path, void *bytes, size_t size)
{
    dpt_host_error error = { .size = sizeof error };
    const dpt_arm *arm = host_file_open_arm(path, bytes, size, &error);
    if (!arm)
        complain(command, "%s", error.text);
    return arm;
}

void report_arm(FILE *file, const dpt_compiled *compiled, const char *out)
{
    const dpt_arm *arm;
    dpt_arm_info info = { .size = sizeof info };
    if (dpt_arm_open(compiled->bytes, compiled->size, &arm) != DPT_OK || dpt_arm_get_info(arm, &info) != DPT_OK)
        return;
    fprintf(file, "%s: arm %s, %" PRIu32 " joint%s, tool %s of %" PRIu32 " capsule%s", out, info.name, info.joints,
            info.joints == 1 ? "" : "s", info.tool_name, info.segments, info.segments == 1 ? "" : "s");
    if (info.tips)
        fprintf(file, " and %" PRIu32 " tip%s", info.tips, info.tips == 1 ? "" : "s");
    if (info.jaws)
        fprintf(file, " with %" PRIu32 " jaw%s", info.jaws, info.jaws == 1 ? "" : "s");
    fprintf(file, ", %" PRIu32 " bod%s, %.6g kg, %.1f kB\n", info.bodies, info.bodies == 1 ? "y" : "ies", info.mass,
            (double)info.bytes / 1e3);
}

static const char *const kinds[] = { "revolute", "continuous", "prismatic" };

/* Joints are coordinates of the arm or jaws; links are the arm's, or jaw links. */
typedef dpt_result get_joint_fn(const dpt_arm *arm, uint32_t index, dpt_arm_joint *joint);
typedef dpt_result get_link_fn(const dpt_arm *arm, uint32_t index, dpt_arm_link *link);

static void print_joints(const dpt_arm *arm, const char *what, get_joint_fn *get_joint)
{
    const double degree = 3.14159265358979323846 / 180.0;
    dpt_arm_joint joint = { .size = sizeof joint };
    for (uint32_t i = 0; get_joint(arm, i, &joint) == DPT_OK; i++) {
        printf("  %s %" PRIu32 " %-20s %-10s", what, i, joint.name, kinds[joint.kind]);
        if (joint.kind == DPT_JOINT_REVOLUTE)
            printf(" %.6g .. %.6g degrees", joint.lower / degree, joint.upper / degree);
        else if (joint.kind == DPT_JOINT_PRISMATIC)
            printf(" %.6g .. %.6g m", joint.lower, joint.upper);
        if (joint.effort > 0.0)
            printf(", %.6g %s", joint.effort, joint.kind == DPT_JOINT_PRISMATIC ? "N" : "Nm");
        if (joint.velocity > 0.0)
            printf(", %.6g %s", joint.velocity, joint.kind == DPT_JOINT_PRISMATIC ? "m/s" : "rad/s");
        putchar('\n');
    }
}

static void print_links(const dpt_arm *arm, const char *what, const char *root, get_link_fn *get_link,
                        get_joint_fn *get_joint)
{
    dpt_arm_link link = { .size = sizeof link };
    for (uint32_t i = 0; get_link(arm, i, &link) == DPT_OK; i++) {
        dpt_arm_joint joint = { .size = sizeof joint };
        get_joint(arm, link.joint, &joint);
        printf("  %s %-2" PRIu32 " on ", what, i);
        if (link.parent == DPT_NONE)
            printf("%s", root);
        else
            printf("%s %" PRIu32, what, link.parent);
        printf(", %s (%.6g, %.6g, %.6g) by ", link.slides ? "slides along" : "turns about", link.axis[0], link.axis[1],
               link.axis[2]);
        if (link.factor < 1.0 || link.factor > 1.0)
            printf("%.6g ", link.factor);
        printf("%s", joint.name);
        if (link.offset < 0.0 || link.offset > 0.0)
            printf(" %+.6g", link.offset);
        printf(", %.6g kg\n", link.mass);
    }
}

static void print_tips(const dpt_arm *arm)
{
    dpt_arm_tip tip = { .size = sizeof tip };
    for (uint32_t i = 0; dpt_arm_get_tip(arm, i, &tip) == DPT_OK; i++) {
        printf("    tip %s, %" PRIu32 " corners, radius %.6g m", tip.name, tip.corner_count, tip.radius);
        if (tip.link != DPT_NONE)
            printf(", on jaw link %" PRIu32, tip.link);
        putchar('\n');
    }
}

void print_arm_text(const char *path, const dpt_arm *arm)
{
    dpt_arm_info info = { .size = sizeof info };
    dpt_segment segment;
    dpt_arm_body body = { .size = sizeof body };
    dpt_arm_get_info(arm, &info);
    printf("%s: dynpoint arm %s, format %" PRIu32 ", %" PRIu64 " bytes\n", path, info.name, info.format_version,
           info.bytes);
    print_joints(arm, "joint", dpt_arm_get_joint);
    print_links(arm, "link", info.root_name, dpt_arm_get_link, dpt_arm_get_joint);
    printf("  mass %.6g kg\n", info.mass);
    printf("  tool %s on link %" PRIu32 " at (%.6g, %.6g, %.6g) m\n", info.tool_name, info.tool_link,
           info.tool.position[0], info.tool.position[1], info.tool.position[2]);
    for (uint32_t i = 0; dpt_arm_get_segment(arm, i, &segment) == DPT_OK; i++)
        printf("    capsule (%.6g, %.6g, %.6g) to (%.6g, %.6g, %.6g) m, radius %.6g m\n", segment.a[0], segment.a[1],
               segment.a[2], segment.b[0], segment.b[1], segment.b[2], segment.radius);
    print_tips(arm);
    print_joints(arm, "jaw", dpt_arm_get_jaw);
    print_links(arm, "jaw link", info.tool_name, dpt_arm_get_jaw_link, dpt_arm_get_jaw);
    for (uint32_t i = 0; dpt_arm_get_body(arm, i, &body) == DPT_OK; i++) {
        dpt_mesh_info mesh = { .size = sizeof mesh };
        dpt_mesh_get_info(body.mesh, &mesh);
        printf("  body %s at (%.6g, %.6g, %.6g) m, %" PRIu32 " triangles\n", body.name, body.pose.position[0],
               body.pose.position[1], body.pose.position[2], mesh.triangles);
    }
    if (info.source_bytes)
        printf("  source %" PRIu64 " bytes, hash %016" PRIx64 "\n", info.source_bytes, info.source_hash);
}

/* Print a key and its name. */
static void print_name(const char *key, const char *name)
{
    printf("\"%s\":", key);
    json_write_text(stdout, name);
}

static void print_numbers(const char *key, const double *number, int count)
{
    printf("\"%s\":[", key);
    for (int i = 0; i < count; i++)
        printf("%s%.17g", i ? "," : "", number[i]);
    putchar(']');
}

static void print_pose(const dpt_pose *pose)
{
    print_numbers("position", pose->position, 3);
    putchar(',');
    print_numbers("orientation", pose->orientation, 4);
}

static void print_joints_json(const dpt_arm *arm, const char *key, get_joint_fn *get_joint)
{
    dpt_arm_joint joint = { .size = sizeof joint };
    printf(",\"%s\":[", key);
    for (uint32_t i = 0; get_joint(arm, i, &joint) == DPT_OK; i++) {
        fputs(i ? ",{" : "{", stdout);
        print_name("name", joint.name);
        printf(",\"kind\":\"%s\",\"lower\":%.17g,\"upper\":%.17g,\"velocity\":%.17g,"
               "\"effort\":%.17g,\"damping\":%.17g,\"friction\":%.17g}",
               kinds[joint.kind], joint.lower, joint.upper, joint.velocity, joint.effort, joint.damping,
               joint.friction);
    }
    putchar(']');
}

static void print_links_json(const dpt_arm *arm, const char *key, get_link_fn *get_link)
{
    dpt_arm_link link = { .size = sizeof link };
    printf(",\"%s\":[", key);
    for (uint32_t i = 0; get_link(arm, i, &link) == DPT_OK; i++) {
        printf("%s{\"parent\":%" PRId64 ",\"joint\":%" PRIu32 ",\"slides\":%s,", i ? "," : "",
               link.parent == DPT_NONE ? (int64_t)-1 : (int64_t)link.parent, link.joint,
               link.slides ? "true" : "false");
        print_pose(&link.pose);
        putchar(',');
        print_numbers("axis", link.axis, 3);
        printf(",\"factor\":%.17g,\"offset\":%.17g,\"mass\":%.17g,", link.factor, link.offset, link.mass);
        print_numbers("centre", link.centre, 3);
        putchar('}');
    }
    putchar(']');
}

static void print_tips_json(const dpt_arm *arm)
{
    dpt_arm_tip tip = { .size = sizeof tip };
    printf("],\"tips\":[");
    for (uint32_t i = 0; dpt_arm_get_tip(arm, i, &tip) == DPT_OK; i++) {
        fputs(i ? ",{" : "{", stdout);
        print_name("name", tip.name);
        printf(",\"jaw_link\":%" PRId64 ",\"radius\":%.17g,", tip.link == DPT_NONE ? (int64_t)-1 : (int64_t)tip.link,
               tip.radius);
        print_numbers("corners", tip.corners, 3 * (int)tip.corner_count);
        putchar('}');
    }
    putchar(']');
}

void print_arm_json(const dpt_arm *arm)
{
    dpt_arm_info info = { .size = sizeof info };
    dpt_arm_body body = { .size = sizeof body };
    dpt_segment segment;
    dpt_arm_get_info(arm, &info);
    putchar('{');
    print_name("arm", info.name);
    putchar(',');
    print_name("root", info.root_name);
    print_joints_json(arm, "joints", dpt_arm_get_joint);
    print_links_json(arm, "links", dpt_arm_get_link);
    printf(",\"tool\":{");
    print_name("name", info.tool_name);
    printf(",\"link\":%" PRIu32 ",", info.tool_link);
    print_pose(&info.tool);
    printf(",\"capsules\":[");
    for (uint32_t i = 0; dpt_arm_get_segment(arm, i, &segment) == DPT_OK; i++) {
        fputs(i ? ",{" : "{", stdout);
        print_numbers("a", segment.a, 3);
        putchar(',');
        print_numbers("b", segment.b, 3);
        printf(",\"radius\":%.17g}", segment.radius);
    }
    print_tips_json(arm);
    print_joints_json(arm, "jaws", dpt_arm_get_jaw);
    print_links_json(arm, "jaw_links", dpt_arm_get_jaw_link);
    printf("},\"bodies\":[");
    for (uint32_t i = 0; dpt_arm_get_body(arm, i, &body) == DPT_OK; i++) {
        dpt_mesh_info mesh = { .size = sizeof mesh };
        dpt_mesh_get_info(body.mesh, &mesh);
        fputs(i ? ",{" : "{", stdout);
        print_name("name", body.name);
        putchar(',');
        print_pose(&body.pose);
        printf(",\"triangles\":%" PRIu32 "}", mesh.triangles);
    }
    printf("],\"mass\":%.17g,\"source\":{\"bytes\":%" PRIu64 ",\"hash\":\"%016" PRIx64 "\"},\"format\":%" PRIu32
           ",\"bytes\":%" PRIu64 "}\n",
           info.mass, info.source_bytes, info.source_hash, info.format_version, info.bytes);
}
