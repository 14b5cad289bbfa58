/* SPDX-License-Identifier: BSD-3-Clause */
#define _POSIX_C_SOURCE 200809L
#include <stdio.h>
#include <string.h>
#include <sys/utsname.h>

#include "base/crc32.h"
#include "plan/plan.h"

#ifdef __clang__
#define COMPILER "clang " __clang_version__
#elif defined __GNUC__
#define COMPILER "gcc " __VERSION__
#else
#define COMPILER "?"
#endif

/* ASCII without quotes, so that it stands in a text of JSON and in a comment of C as it is. */
static void take_text(char *to, size_t room, const char *from)
{
    size_t n = 0;
    for (; *from && n + 1 < room; from++)
        if (*from >= ' ' && *from <= '~' && !strchr("\"\\*/", *from))
            to[n++] = *from;
    while (n > 0 && to[n - 1] == ' ')
        n--;
    to[n] = '\0';
}

/* The line of Linux, or what POSIX knows. */
static void find_processor(char *to, size_t room)
{
    struct utsname name;
    char line[256];
    FILE *file = fopen("/proc/cpuinfo", "r");
    take_text(to, room, uname(&name) < 0 ? "unknown" : name.machine);
    while (file && fgets(line, sizeof line, file)) {
        const char *colon = strchr(line, ':');
        if (!strncmp(line, "model name", 10) && colon && colon[1]) {
            take_text(to, room, colon + 2);
            break;
        }
    }
    if (file)
        fclose(file);
}

void plan_machine_of_here(struct plan_machine *machine, uint32_t kernel)
{
    find_processor(machine->processor, sizeof machine->processor);
    take_text(machine->kernel, sizeof machine->kernel, dpt_kernel_name(kernel));
    take_text(machine->compiler, sizeof machine->compiler, COMPILER);
    take_text(machine->version, sizeof machine->version, dpt_version());
}

void plan_meshes_of(struct plan *plan, const struct scene *scene)
{
    plan->mesh_count = scene->bodies.count;
    for (uint32_t i = 0; i < plan->mesh_count; i++) {
        const dpt_mesh *mesh = scene->bodies.body[i].mesh;
        const float *vertices;
        const uint32_t *corners, *numbers;
        uint32_t count;
        struct crc32 crc;
        crc32_init(&crc);
        dpt_mesh_get_vertices(mesh, &vertices, &count);
        plan->mesh[i].crc32 = crc32_more(&crc, 0, vertices, (size_t)count * 3 * sizeof *vertices);
        dpt_mesh_get_triangles(mesh, &corners, &numbers, &count);
        plan->mesh[i].crc32 =
            crc32_more(&crc, plan->mesh[i].crc32, corners, (size_t)count * 3 * sizeof *corners);
        plan->mesh[i].triangles = count;
    }
}
