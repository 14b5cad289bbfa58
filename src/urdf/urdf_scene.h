/* SPDX-License-Identifier: BSD-3-Clause */
/* The scene: the meshes and boxes that are fixed to the root, compiled. */
#ifndef DPT_URDF_SCENE_H
#define DPT_URDF_SCENE_H

#include "urdf/chain.h"

struct Scene {
    std::vector<dpt_compiled> meshes;
    std::vector<dpt_arm_body> bodies; /* their meshes point into `meshes` */

    Scene()
    {
    }
    ~Scene();
    Scene(const Scene &) = delete;
    Scene &operator=(const Scene &) = delete;
};

/* A mesh, compiled. */
struct CompiledMesh {
    dpt_compiled file;

    CompiledMesh() : file()
    {
    }
    ~CompiledMesh()
    {
        dpt_compiled_free(&file);
    }
    CompiledMesh(const CompiledMesh &) = delete;
    CompiledMesh &operator=(const CompiledMesh &) = delete;
};

/* Compile the mesh that a shape of a link names. Throws a fault, adds notes. The parameters are those of read_scene. */
void compile_mesh(const Link &link, const Shape &shape, const std::string &file, const char *packages,
                  const dpt_compile_def &mesh, Notes &notes, CompiledMesh *compiled);

/*
 * Compile the scene. Throws a fault, adds notes.
 *
 *   file       path of the URDF
 *   packages   as in dpt_urdf_def
 *   mesh       as in dpt_urdf_def, in this library's version
 */
void read_scene(const Robot &robot, const Chain &chain, const std::string &file, const char *packages,
                const dpt_compile_def &mesh, Notes &notes, Scene *scene);

/*
 * The path of the mesh file that `name` means, as urdf.h says. Throws a fault for a name that means no file, and for
 * one in a package that is not found; other files need not exist. `line` and `owner` are for the message.
 */
std::string mesh_path(const std::string &name, const std::string &file, const char *packages, size_t line,
                      const std::string &owner);

#endif
