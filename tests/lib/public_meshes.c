/* SPDX-License-Identifier: BSD-3-Clause */
#include "lib/public_meshes.h"

#include <dirent.h>

#include "lib/check.h"

static int is_mesh(const struct dirent *entry)
{
    return entry->d_name[0] != '.' && strcmp(entry->d_name, TOO_LARGE_MESH) != 0;
}

void for_each_public_mesh(const char *data, visit_mesh *visit, void *user)
{
    static const char *const folders[] = { "organs", "tools", "sheets_tori", "hard" };
    for (size_t f = 0; f < sizeof folders / sizeof *folders; f++) {
        char path[1024];
        struct dirent **entries = NULL;
        snprintf(path, sizeof path, "%s/meshes/%s", data, folders[f]);
        const int count = scandir(path, &entries, is_mesh, alphasort);
        CHECK(count > 0, "%s is empty", path);
        for (int i = 0; i < count; i++) {
            visit(folders[f], entries[i]->d_name, user);
            free(entries[i]);
        }
        free(entries);
    }
}
