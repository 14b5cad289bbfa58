/* SPDX-License-Identifier: BSD-3-Clause */
/* The boundary between C outside and C++ inside. No exception passes it. */
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <new>

#include "base/sized.h"
#include "urdf/urdf_tips.h"

extern "C"
{
#include "text/open_file.h"
}

namespace
{

const size_t bytes_max = static_cast<size_t>(64) << 20;

/* FNV-1a, 64 bits, as for the source of a mesh. */
uint64_t hash_of(const std::string &bytes)
{
    uint64_t hash = 0xcbf29ce484222325u;
    for (char c : bytes)
        hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
    return hash;
}

struct File {
    std::FILE *file;

    ~File()
    {
        if (file)
            std::fclose(file);
    }
};

std::string read_all(const char *path)
{
    File in = { open_file(path, "rb") };
    if (!in.file)
        refuse(DPT_E_OPEN, 0, "it cannot be opened: %s", std::strerror(errno));
    std::string bytes;
    char part[4096];
    while (size_t count = std::fread(part, 1, sizeof part, in.file)) {
        bytes.append(part, count);
        if (bytes.size() > bytes_max)
            refuse(DPT_E_LIMIT, 0, "it is longer than 64 MiB");
    }
    if (std::ferror(in.file))
        refuse(DPT_E_OPEN, 0, "it cannot be read: %s", std::strerror(errno));
    return bytes;
}

/* Take the shapes of these links away. */
void skip_links(Robot *robot, const char *const *names)
{
    for (; names && *names; names++) {
        const char *name = *names;
        const auto link = std::find_if(robot->links.begin(), robot->links.end(),
                                       [name](const Link &l) { return l.name == name; });
        if (link == robot->links.end())
            refuse(DPT_E_ARGUMENT, 0, "there is no link %s to skip", quoted(name).c_str());
        link->shapes.clear();
    }
}

void compile(const char *path, const dpt_urdf_def &def, const dpt_compile_def &mesh,
             dpt_compiled *out)
{
    Notes notes;
    const std::string bytes = read_all(path);
    Robot robot = read_robot(bytes, notes);
    skip_links(&robot, def.skip);
    const Chain chain = chain_of(robot, def.tool, notes);
    Tips tips;
    read_tips(robot, chain, path, def.packages, mesh, notes, &tips);
    Scene scene;
    if (!def.without_scene)
        read_scene(robot, chain, path, def.packages, mesh, notes, &scene);
    std::stable_sort(notes.list.begin(), notes.list.end(),
                     [](const Note &a, const Note &b) { return a.line < b.line; });

    char name[DPT_ARM_NAME], root[DPT_ARM_NAME], tool[DPT_ARM_NAME];
    put_name(name, robot.name, "robot", 0);
    put_name(root, robot.links[robot.root].name, "link", robot.links[robot.root].line);
    put_name(tool, robot.links[chain.tool_link].name, "link", robot.links[chain.tool_link].line);
    dpt_arm_def arm = {};
    arm.size = sizeof arm;
    arm.joint_count = static_cast<uint32_t>(chain.joints.size());
    arm.link_count = static_cast<uint32_t>(chain.links.size());
    arm.segment_count = static_cast<uint32_t>(chain.segments.size());
    arm.body_count = static_cast<uint32_t>(scene.bodies.size());
    arm.tool_link = static_cast<uint32_t>(chain.attachments[chain.tool_link].arm_link);
    arm.tool = pose_of(chain.attachments[chain.tool_link].pose);
    arm.joints = chain.joints.data();
    arm.links = chain.links.data();
    arm.segments = chain.segments.data();
    arm.bodies = scene.bodies.data();
    arm.name = name;
    arm.root_name = root;
    arm.tool_name = tool;
    arm.source_bytes = bytes.size();
    arm.source_hash = hash_of(bytes);
    arm.jaw_count = static_cast<uint32_t>(tips.jaws.size());
    arm.jaw_link_count = static_cast<uint32_t>(tips.jaw_links.size());
    arm.tip_count = static_cast<uint32_t>(tips.tips.size());
    arm.jaws = tips.jaws.data();
    arm.jaw_links = tips.jaw_links.data();
    arm.tips = tips.tips.data();
    dpt_diag diag = {};
    diag.size = sizeof diag;
    dpt_result result = dpt_compile_arm(&arm, out, &diag);
    if (result != DPT_OK)
        refuse(result, 0, "%s", diag.text);
    for (const Note &note : notes.list)
        if (def.note)
            def.note(def.user, note.line, note.text.c_str());
}

dpt_result fill_diag(dpt_diag *diag, dpt_result code, size_t line, const char *text)
{
    if (diag) {
        dpt_diag own = {};
        own.code = code;
        own.line = line;
        const int length = std::snprintf(own.text, sizeof own.text, "%s", text);
        if (length >= static_cast<int>(sizeof own.text))
            std::memcpy(own.text + sizeof own.text - 4, "...", 4);
        sized_write(diag, diag->size, &own, sizeof own);
    }
    return code;
}

/* Read the caller's def, and its def for meshes, into this library's versions of these structs. Throws a fault. */
void read_defs(const dpt_urdf_def *given, dpt_urdf_def *def, dpt_compile_def *mesh)
{
    dpt_result result = given ? sized_read(given, sizeof *def, def, sizeof *def) : DPT_OK;
    if (result == DPT_E_UNSUPPORTED)
        refuse(result, 0, "the def has fields of a newer version");
    if (result != DPT_OK)
        refuse(result, 0, "the def's size field is not set");
    if (given && sized_of(given) < sizeof *def)
        def->skip = NULL; /* of half a pointer */
    if (def->without_scene > 1)
        refuse(DPT_E_ARGUMENT, 0, "without_scene of the def must be 0 or 1");
    if (def->mesh)
        result = sized_read(def->mesh, SIZED_FIRST(dpt_compile_def, crease), mesh, sizeof *mesh);
    if (result == DPT_E_UNSUPPORTED)
        refuse(result, 0, "the def for meshes has fields of a newer version");
    if (result != DPT_OK)
        refuse(result, 0, "the size field of the def for meshes is not set");
    if (!(mesh->scale >= 0.0))
        refuse(DPT_E_ARGUMENT, 0, "the scale of the def for meshes must be positive");
    if (mesh->node_count || mesh->cell_count || mesh->springs)
        refuse(DPT_E_ARGUMENT, 0,
               "the def for meshes has cells or springs: bodies of an arm are rigid");
}

} // namespace

extern "C" void dpt_urdf_def_defaults(dpt_urdf_def *def, size_t size)
{
    const dpt_urdf_def defaults = {};
    sized_defaults(def, size, &defaults, sizeof defaults);
}

extern "C" dpt_result dpt_urdf_compile_file(const char *path, const dpt_urdf_def *given,
                                            dpt_compiled *out, dpt_diag *diag)
{
    if (out) {
        out->bytes = NULL;
        out->size = 0;
    }
    if (diag && sized_check(diag, sizeof *diag, 0) != DPT_OK)
        return DPT_E_SIZE;
    if (!out)
        return fill_diag(diag, DPT_E_ARGUMENT, 0, "no place for the bytes");
    try {
        dpt_urdf_def def = {};
        dpt_compile_def mesh = {};
        mesh.size = sizeof mesh;
        read_defs(given, &def, &mesh);
        if (!path)
            refuse(DPT_E_ARGUMENT, 0, "no name of a file");
        compile(path, def, mesh, out);
        return fill_diag(diag, DPT_OK, 0, "");
    } catch (const Fault &fault) {
        return fill_diag(diag, fault.code, fault.line, fault.text.c_str());
    } catch (const std::bad_alloc &) {
        return fill_diag(diag, DPT_E_MEMORY, 0, "memory ran out");
    } catch (const std::exception &failure) {
        return fill_diag(diag, DPT_E_SYNTAX, 0, failure.what());
    } catch (...) {
        return fill_diag(diag, DPT_E_SYNTAX, 0, "urdfdom failed");
    }
}
