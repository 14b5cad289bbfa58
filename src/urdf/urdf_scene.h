/* SPDX-License-Identifier: BSD-3-Clause */
/* The meshes and boxes that are fixed to the root, compiled. */
#ifndef DPT_URDF_SCENE_H
#define DPT_URDF_SCENE_H

#include "urdf/chain.h"

struct Scene {
    std::vector<dpt_compiled> meshes;
    std::vector<dpt_arm_body> bodies; /* into `meshes` */

    Scene()
    {
    }
    ~Scene();
    Scene(const Scene &) = delete;
    Scene &operator=(const Scene &) = delete;
};

/* `file`: of the URDF; `packages` and `mesh` as in dpt_urdf_def, `mesh` whole. */
void read_scene(const Robot &robot, const Chain &chain, const std::string &file,
                const char *packages, const dpt_compile_def &mesh, Scene *scene);

/* The file that a mesh's name means, as urdf.h says; it need not be there. A fault for what names none. */
std::string mesh_path(const std::string &name, const std::string &file, const char *packages,
                      size_t line, const std::string &owner);

#endif
