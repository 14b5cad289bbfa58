/* SPDX-License-Identifier: BSD-3-Clause */
#include "urdf/urdf_scene.h"

#include <cinttypes>
#include <cstdio>
#include <cstring>
#include <utility>

extern "C"
{
#include "text/open_file.h"
}

namespace
{

bool begins_with(const std::string &text, const char *prefix)
{
    return text.compare(0, std::strlen(prefix), prefix) == 0;
}

bool file_exists(const std::string &path)
{
    std::FILE *file = open_file(path.c_str(), "rb");
    if (file)
        std::fclose(file);
    return file;
}

/* The folder of a path, with what ends its name; or empty. */
std::string folder_of(const std::string &path)
{
    return path.substr(0, path.find_last_of(PATH_SEPARATORS) + 1);
}

/* The last name of a path of a folder. */
std::string name_of(std::string folder)
{
    while (!folder.empty() && std::strchr(PATH_SEPARATORS, folder.back()))
        folder.pop_back();
    return folder.substr(folder.find_last_of(PATH_SEPARATORS) + 1);
}

int hex_digit(char c)
{
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
}

/* Decode the %XX of an address: %20 is a space. */
std::string percent_decoded(const std::string &text, size_t line, const std::string &owner)
{
    std::string result;
    for (size_t i = 0; i < text.size(); i++) {
        if (text[i] != '%') {
            result += text[i];
            continue;
        }
        int high = i + 2 < text.size() ? hex_digit(text[i + 1]) : -1,
            low = i + 2 < text.size() ? hex_digit(text[i + 2]) : -1;
        if (high < 0 || low < 0 || 16 * high + low < 0x20)
            refuse_path(DPT_E_SYNTAX, line, owner, text,
                        ": '%' is not followed by two digits of a character");
        result += static_cast<char>(16 * high + low);
        i += 2;
    }
    return result;
}

/* Whether a path begins at a root, and not in some folder. */
bool is_rooted(const std::string &path)
{
    return (!path.empty() && std::strchr(PATH_SEPARATORS, path[0])) ||
           (HAS_DRIVES && drive_length(path.c_str()));
}

/* The path of file://PATH: that of file:///C:/ros begins with the drive. */
std::string path_of_address(const std::string &path)
{
    return HAS_DRIVES && drive_length(path.c_str() + 1) ? path.substr(1) : path;
}

/* The path of package://REST. REST is NAME/..., `packages` as in dpt_urdf_def, `file` the URDF. */
std::string path_in_package(const std::string &rest, const std::string &file, const char *packages,
                            size_t line, const std::string &owner)
{
    size_t slash = rest.find('/');
    std::string name = rest.substr(0, slash);
    if (slash == std::string::npos || name.empty() || name == "." || name == "..")
        refuse_path(DPT_E_SYNTAX, line, owner, "package://" + rest, " names no package and file");
    for (const char *at = packages; at && *at;) {
        const size_t length = folder_length(at), drive = drive_length(at);
        for (size_t count : { drive ? drive + folder_length(at + drive) : 0, length }) {
            const std::string folder(at, count);
            if (count && file_exists(folder + "/" + rest))
                return folder + "/" + rest;
            if (count && name_of(folder) == name && file_exists(folder + rest.substr(slash)))
                return folder + rest.substr(slash);
        }
        at += length + (at[length] != '\0');
    }
    /* "./" comes first, so that "../" can follow a name without a folder. */
    std::string folder = folder_of(file);
    if (!is_rooted(folder))
        folder = "./" + folder;
    for (size_t up = 0; up < 32; up++) {
        if (file_exists(folder + rest))
            return folder + rest;
        folder += "../";
    }
    const std::string beside = folder_of(file) + rest.substr(slash + 1);
    if (!file_exists(beside))
        refuse_path(DPT_E_OPEN, line, owner, "package://" + rest,
                    " is not found: name the folder that holds the package by --packages");
    return beside;
}

} // namespace

std::string mesh_path(const std::string &name, const std::string &file, const char *packages,
                      size_t line, const std::string &owner)
{
    if (name.empty())
        refuse(DPT_E_SYNTAX, line, "%s: a mesh without a file's name", owner.c_str());
    if (begins_with(name, "package://"))
        return path_in_package(percent_decoded(name.substr(10), line, owner), file, packages, line,
                               owner);
    if (begins_with(name, "file:///"))
        return path_of_address(percent_decoded(name.substr(7), line, owner));
    if (begins_with(name, "file://localhost/"))
        return path_of_address(percent_decoded(name.substr(16), line, owner));
    if (name.find("://") != std::string::npos)
        refuse_path(DPT_E_UNSUPPORTED, line, owner, name,
                    ": only package://NAME/..., file:///... and plain names are taken");
    return is_rooted(name) ? name : folder_of(file) + name;
}

/* ---- the scene ---- */

namespace
{

struct SceneBuilder {
    const Robot &robot;
    const Chain &chain;
    const std::string &file;
    const char *packages;
    const dpt_compile_def &mesh;
    Notes &notes;
    Scene *scene;

    dpt_compile_def def_with_scale(double scale) const;
    void add_body(const Link &link, const Frame &pose, const dpt_compiled &compiled);
    void add_box(const Link &link, const Frame &pose, const Shape &shape);
    void add_mesh(const Link &link, const Frame &pose, const Shape &shape);
};

dpt_compile_def SceneBuilder::def_with_scale(double scale) const
{
    dpt_compile_def def = mesh;
    def.scale = scale;
    return def;
}

void SceneBuilder::add_body(const Link &link, const Frame &pose, const dpt_compiled &compiled)
{
    scene->meshes.back() = compiled;
    if (scene->bodies.size() == DPT_ARM_BODIES_MAX)
        refuse(DPT_E_LIMIT, link.line, "link %s: the scene has more than %d meshes and boxes",
               quoted(link.name).c_str(), DPT_ARM_BODIES_MAX);
    dpt_arm_body body = {};
    body.size = sizeof body;
    body.pose = pose_of(pose);
    put_name(body.name, link.name, "link", link.line);
    dpt_result result = dpt_mesh_convert(compiled.bytes, compiled.size, NULL);
    if (result == DPT_OK)
        result = dpt_mesh_open(compiled.bytes, compiled.size, &body.mesh);
    if (result != DPT_OK)
        refuse(result, link.line, "link %s: %s", quoted(link.name).c_str(),
               dpt_result_text(result));
    scene->bodies.push_back(body);
}

void SceneBuilder::add_box(const Link &link, const Frame &pose, const Shape &shape)
{
    static const uint32_t corners[36] = { 0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                          2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5 };
    double vertices[24];
    for (int i = 0; i < 8; i++) {
        vertices[3 * i] = (i & 1 ? 0.5 : -0.5) * shape.size.x;
        vertices[3 * i + 1] = (i & 2 ? 0.5 : -0.5) * shape.size.y;
        vertices[3 * i + 2] = (i & 4 ? 0.5 : -0.5) * shape.size.z;
    }
    if (!(shape.size.x > 0.0 && shape.size.y > 0.0 && shape.size.z > 0.0))
        refuse(DPT_E_SYNTAX, link.line, "link %s: a box of the scene has no volume",
               quoted(link.name).c_str());
    dpt_compile_def scaled_def = def_with_scale(1.0);
    dpt_compiled compiled;
    dpt_diag diag = {};
    diag.size = sizeof diag;
    scene->meshes.push_back(dpt_compiled());
    dpt_result result = dpt_compile_arrays(vertices, 8, corners, 12, &scaled_def, &compiled, &diag);
    if (result != DPT_OK)
        refuse(result, link.line, "link %s: a box: %s", quoted(link.name).c_str(), diag.text);
    add_body(link, pose, compiled);
}

void SceneBuilder::add_mesh(const Link &link, const Frame &pose, const Shape &shape)
{
    CompiledMesh compiled;
    compile_mesh(link, shape, file, packages, mesh, notes, &compiled);
    scene->meshes.push_back(dpt_compiled());
    std::swap(scene->meshes.back(), compiled.file);
    add_body(link, pose, scene->meshes.back());
    /* The mesh may have been moved: its body makes up for it. */
    dpt_mesh_info info = {};
    info.size = sizeof info;
    dpt_mesh_get_info(scene->bodies.back().mesh, &info);
    const Vec origin = { info.origin[0], info.origin[1], info.origin[2] };
    scene->bodies.back().pose = pose_of(Frame{ pose * origin, pose.w, pose.v });
}

} // namespace

namespace
{

/* What the compiler notes of a mesh becomes a note of the link. */
struct MeshNotes {
    const Link &link;
    const Shape &shape;
    Notes &notes;
};

std::string place_of(const dpt_diag &diag)
{
    return diag.line   ? line_of_text(": line %" PRIu64, diag.line)
           : diag.byte ? line_of_text(": byte %" PRIu64, diag.byte)
                       : "";
}

void hear_note(void *user, const dpt_diag *note)
{
    const MeshNotes *of = static_cast<const MeshNotes *>(user);
    of->notes.add(of->link.line, "link " + quoted(of->link.name) + ": '" + of->shape.file + "'" +
                                     place_of(*note) + ": " + note->text);
}

/* Formats of scenes that robots' descriptions name. */
const char *scene_format(const std::string &ending)
{
    return ending == "dae"                       ? "COLLADA"
           : ending == "glb" || ending == "gltf" ? "glTF"
                                                 : NULL;
}

} // namespace

void compile_mesh(const Link &link, const Shape &shape, const std::string &file,
                  const char *packages, const dpt_compile_def &mesh, Notes &notes,
                  CompiledMesh *compiled)
{
    const std::string owner = "link " + quoted(link.name);
    const std::string path = mesh_path(shape.file, file, packages, link.line, owner);
    const Vec &scale = shape.size;
    if (!(scale.x > 0.0 && scale.x == scale.y && scale.x == scale.z))
        refuse_path(DPT_E_UNSUPPORTED, link.line, owner, shape.file,
                    ": its scale must be one positive number three times: scale the mesh itself");
    size_t dot = shape.file.rfind('.');
    std::string ending = dot == std::string::npos ? "" : shape.file.substr(dot + 1);
    for (char &c : ending)
        c = static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
    if (scene_format(ending))
        refuse_path(DPT_E_UNSUPPORTED, link.line, owner, shape.file,
                    std::string(" is ") + scene_format(ending) +
                        ": make it an STL (docs/urdf.md#collada-and-gltf), or leave it out: --skip LINK");
    MeshNotes mesh_notes = { link, shape, notes };
    dpt_compile_def scaled_def = mesh;
    scaled_def.note = hear_note;
    scaled_def.note_user = &mesh_notes;
    scaled_def.scale = (mesh.scale > 0.0 ? mesh.scale : 1.0) * scale.x;
    dpt_diag diag = {};
    diag.size = sizeof diag;
    dpt_result result = dpt_compile_file(path.c_str(), &scaled_def, &compiled->file, &diag);
    if (result != DPT_OK)
        refuse_path(result, link.line, owner, shape.file, place_of(diag) + ": " + diag.text);
}

Scene::~Scene()
{
    for (dpt_compiled &mesh : meshes)
        dpt_compiled_free(&mesh);
}

void read_scene(const Robot &robot, const Chain &chain, const std::string &file,
                const char *packages, const dpt_compile_def &mesh, Notes &notes, Scene *scene)
{
    SceneBuilder builder = { robot, chain, file, packages, mesh, notes, scene };
    for (size_t i = 0; i < robot.links.size(); i++) {
        if (chain.attachments[i].fixed_group != robot.root)
            continue;
        for (const Shape &shape : robot.links[i].shapes) {
            const Frame pose = chain.attachments[i].pose * shape.origin;
            if (shape.kind == Shape::BOX)
                builder.add_box(robot.links[i], pose, shape);
            if (shape.kind == Shape::MESH)
                builder.add_mesh(robot.links[i], pose, shape);
        }
    }
}
