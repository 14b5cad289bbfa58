/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Hashes of what the library answers, for machines that are to agree bit for bit (tests/amalgamation.sh,
 * tests/cross.sh): meshes compiled here, walks over them with every kernel of the machine, methods, budgets, contacts,
 * sweeps and strips. Prints a line a mesh and a scene; all kernels must come to the same. It uses the single files'
 * headers, and no function of the C library that machines compute differently.
 */
#include <dynpoint.h>
#include <dynpoint_compile.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- drawing (SplitMix64) ---- */

static uint64_t state;

static uint64_t bits(void)
{
    uint64_t z = (state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

static double in(double low, double high)
{
    return low + (high - low) * ((double)(bits() >> 11) * 0x1p-53);
}

static uint32_t contacts_met, sweeps_met, strip_triangles, bounded; /* so that it is seen what there was */

/* ---- hashing (FNV-1a over values, so that byte order does not count) ---- */

static uint64_t hash;

static void mix(uint64_t value)
{
    for (int i = 0; i < 8; i++)
        hash = (hash ^ (value >> (8 * i) & 255)) * 0x100000001b3u;
}

static void mix_number(double value)
{
    uint64_t word;
    memcpy(&word, &value, sizeof word);
    mix(word);
}

static void mix_vector(const double *values)
{
    for (int i = 0; i < 3; i++)
        mix_number(values[i]);
}

/* ---- meshes ---- */

enum { MESHES = 3, SIDE = 24, VERTICES_MAX = 2048, TRIANGLES_MAX = 4096 };

static double vertices[VERTICES_MAX][3];
static uint32_t corners[TRIANGLES_MAX][3];
static size_t vertex_count, triangle_count;
static void *files[MESHES];
static const dpt_mesh *meshes[MESHES];

static uint32_t add_vertex(double x, double y, double z)
{
    const double at[3] = { x, y, z };
    memcpy(vertices[vertex_count], at, sizeof at);
    return (uint32_t)vertex_count++;
}

static void add_triangle(uint32_t a, uint32_t b, uint32_t c)
{
    const uint32_t triangle[3] = { a, b, c };
    memcpy(corners[triangle_count++], triangle, sizeof triangle);
}

/* A face of a cube of side 2, pressed out to a ball with bumps. `round` 0 leaves it a cube. */
static void add_face(int axis, double side, double round, double size)
{
    for (int i = 0; i <= SIDE / 2; i++)
        for (int k = 0; k <= SIDE / 2; k++) {
            double at[3];
            at[axis] = side;
            at[(axis + 1) % 3] = side * (4.0 * i / SIDE - 1.0);
            at[(axis + 2) % 3] = 4.0 * k / SIDE - 1.0;
            double length = sqrt(at[0] * at[0] + at[1] * at[1] + at[2] * at[2]);
            double bump = 1.0 + 0.3 * at[0] * at[1] * at[2];
            double scale = size * (round > 0.0 ? bump / length : 1.0);
            uint32_t here = add_vertex(scale * at[0], scale * at[1], scale * at[2]);
            if (i > 0 && k > 0) {
                uint32_t row = SIDE / 2 + 1;
                add_triangle(here - row - 1, here - 1, here);
                add_triangle(here - row - 1, here, here - row);
            }
        }
}

static void make_mesh(int which)
{
    vertex_count = triangle_count = 0;
    if (which == 1) { /* an open sheet */
        for (int i = 0; i <= SIDE; i++)
            for (int k = 0; k <= SIDE; k++) {
                double x = 2.0 * i / SIDE - 1.0, y = 2.0 * k / SIDE - 1.0;
                uint32_t here = add_vertex(0.1 * x, 0.1 * y, 0.02 * x * x - 0.03 * x * y);
                if (i > 0 && k > 0) {
                    add_triangle(here - SIDE - 2, here - 1, here);
                    add_triangle(here - SIDE - 2, here, here - SIDE - 1);
                }
            }
    } else {
        for (int face = 0; face < 6; face++)
            add_face(face / 2, face % 2 ? 1.0 : -1.0, which == 0 ? 1.0 : 0.0, 0.05);
        for (int i = 0; which == 2 && i < 40; i++) { /* cut by loose triangles */
            uint32_t first = (uint32_t)vertex_count;
            for (int k = 0; k < 3; k++) {
                double x = in(-0.06, 0.06), y = in(-0.06, 0.06), z = in(-0.06, 0.06);
                add_vertex(x, y, z);
            }
            add_triangle(first, first + 1, first + 2);
        }
    }
}

static void must(dpt_result result, const char *what)
{
    if (result != DPT_OK) {
        printf("%s: %s\n", what, dpt_result_name(result));
        exit(1);
    }
}

static void open_mesh(int which)
{
    dpt_compiled file;
    make_mesh(which);
    must(dpt_compile_arrays(&vertices[0][0], vertex_count, &corners[0][0], triangle_count, NULL, &file, NULL),
         "compile");
    hash = 0xcbf29ce484222325u;
    for (size_t i = 0; i < file.size; i++)
        mix(((unsigned char *)file.bytes)[i]);
    printf("mesh %d: %zu triangles, %zu bytes, %016" PRIx64 "\n", which, triangle_count, file.size, hash);
    files[which] = file.bytes;
    must(dpt_mesh_convert(file.bytes, file.size, NULL), "convert");
    must(dpt_mesh_open(file.bytes, file.size, &meshes[which]), "open");
}

/* ---- answers ---- */

static void mix_hit(const dpt_hit *hit)
{
    mix(hit->status);
    mix(hit->contact);
    mix(hit->flags);
    mix(hit->triangle);
    mix(hit->segment);
    mix(hit->body);
    mix(hit->work);
    mix_number(hit->distance);
    mix_number(hit->gap);
    mix_number(hit->depth);
    mix_number(hit->s);
    mix_vector(hit->p);
    mix_vector(hit->q);
    mix_number(hit->error_bound);
    mix_number(hit->lower_bound);
}

static void mix_contacts(const dpt_world *world, dpt_tool tool)
{
    static dpt_contact contacts[16];
    uint32_t count = 0;
    contacts[0].size = sizeof contacts[0];
    mix((uint64_t)dpt_tool_get_contacts(world, tool, contacts, 16, &count));
    mix(count);
    contacts_met += count;
    for (uint32_t i = 0; i < count && i < 16; i++) {
        const dpt_contact *contact = &contacts[i];
        mix(contact->id);
        mix(contact->triangle);
        mix(contact->contact);
        mix(contact->flags);
        mix_number(contact->s0);
        mix_number(contact->s1);
        mix_number(contact->gap);
        mix_vector(contact->normal);
        mix_vector(contact->weight);
        mix_number(contact->overlap);
        mix_number(contact->moment);
        mix_vector(contact->thrust);
        mix_vector(contact->thrust_moment);
    }
}

static void mix_segment(const dpt_world *world, dpt_tool tool, uint32_t segment)
{
    static dpt_overlap overlaps[256];
    dpt_hit hit = DPT_HIT_INIT;
    dpt_sweep sweep = { .size = sizeof sweep };
    uint32_t count = 0, flags = 0;
    mix((uint64_t)dpt_tool_get_segment_hit(world, tool, segment, &hit));
    mix_hit(&hit);
    mix((uint64_t)dpt_tool_get_sweep(world, tool, segment, &sweep));
    mix(sweep.status);
    mix(sweep.triangle);
    sweeps_met += sweep.status == DPT_SWEEP_HIT;
    mix_number(sweep.time);
    mix_vector(sweep.q);
    mix_vector(sweep.normal);
    overlaps[0].size = sizeof overlaps[0];
    mix((uint64_t)dpt_tool_get_strip(world, tool, segment, overlaps, 256, &count, &flags));
    mix(count);
    mix(flags);
    strip_triangles += count;
    for (uint32_t i = 0; i < count && i < 256; i++) {
        mix(overlaps[i].triangle);
        mix(overlaps[i].flags);
        mix_number(overlaps[i].distance);
        mix_number(overlaps[i].gap);
        mix_number(overlaps[i].overlap);
        mix_vector(overlaps[i].q);
    }
}

struct scene {
    uint32_t method, budget, strip, smooth_normals;
    double step; /* m a tick */
};

static void walk(dpt_world *world, const dpt_tool tools[2], const struct scene *scene, int ticks)
{
    dpt_pose pose = DPT_POSE_IDENTITY;
    state = 7;
    for (int tick = 0; tick < ticks; tick++) {
        double square = 0.0;
        for (int i = 0; i < 3; i++)
            pose.position[i] = 0.97 * pose.position[i] + in(-scene->step, scene->step);
        for (int i = 0; i < 4; i++) {
            pose.orientation[i] += in(-0.1, 0.1);
            square += pose.orientation[i] * pose.orientation[i];
        }
        for (int i = 0; i < 4; i++)
            pose.orientation[i] /= sqrt(square);
        for (uint32_t i = 0; i < 2; i++) {
            dpt_pose own = pose;
            own.position[i] += 0.03;
            mix((uint64_t)dpt_tool_set_pose(world, tools[i], &own));
        }
        dpt_step step = { .size = sizeof step };
        mix((uint64_t)dpt_world_step(world, 0.001, &step));
        mix(step.status);
        mix(step.work);
        bounded += step.status == DPT_STATUS_BOUNDED;
        for (uint32_t i = 0; i < 2; i++) {
            dpt_wrench wrench;
            mix((uint64_t)dpt_tool_get_wrench(world, tools[i], &wrench));
            mix_vector(wrench.force);
            mix_vector(wrench.torque);
            mix_contacts(world, tools[i]);
            for (uint32_t segment = 0; segment <= i; segment++)
                mix_segment(world, tools[i], segment);
        }
    }
}

/* The hash of a scene with one kernel; 0 where the machine does not have it. */
static uint64_t run(const struct scene *scene, uint32_t kernel, int ticks)
{
    const dpt_segment segments[2] = { { { 0, 0, -0.04 }, { 0, 0, 0.04 }, 0.003 },
                                      { { 0, 0, 0.04 }, { 0.03, 0, 0.05 }, 0.0 } };
    dpt_world_def def;
    dpt_world *world;
    dpt_body body;
    dpt_tool tools[2];
    dpt_world_def_init(&def);
    def.max_contacts = 32;
    def.law = DPT_LAW_POINT;
    def.method = scene->method;
    def.budget = scene->budget;
    def.strip = scene->strip;
    def.strip_width = 0.004;
    def.smooth_normals = scene->smooth_normals;
    def.certificate_bytes = 1 << 16;
    def.kernel = kernel;
    const size_t size = dpt_world_bytes(&def);
    void *block = malloc(size);
    const dpt_result result = dpt_world_create(block, size, &def, &world);
    hash = contacts_met = sweeps_met = strip_triangles = bounded = 0;
    if (result != DPT_E_UNSUPPORTED) {
        must(result, "create");
        hash = 0xcbf29ce484222325u;
        for (int i = 0; i < MESHES; i++) {
            const dpt_pose pose = { { 0.1 * i - 0.1, 0.02 * i, 0.0 }, { 0.6, 0.0, 0.8, 0.0 } };
            must(dpt_body_add(world, meshes[i], i ? &pose : NULL, &body), "body");
        }
        must(dpt_tool_add(world, segments, 1, &tools[0]), "tool");
        must(dpt_tool_add(world, segments, 2, &tools[1]), "tool");
        walk(world, tools, scene, ticks);
    }
    free(block);
    return hash;
}

int main(int argc, char **argv)
{
    static const struct scene scenes[] = {
        { DPT_METHOD_EXACT, 0, DPT_STRIP_KIND_SHADOW, 0, 0.004 },
        { DPT_METHOD_EXACT, 400, DPT_STRIP_KIND_NONE, 1, 0.002 },
        { DPT_METHOD_EXACT, 60, DPT_STRIP_KIND_ROUTES, 0, 0.008 },
        { DPT_METHOD_TREE, 0, DPT_STRIP_KIND_ROUTES, 1, 0.004 },
        { DPT_METHOD_PAPER, 0, DPT_STRIP_KIND_NONE, 0, 0.004 },
        { DPT_METHOD_BRUTE, 0, DPT_STRIP_KIND_NONE, 0, 0.008 },
    };
    const int ticks = argc > 1 ? atoi(argv[1]) : 150;
    int differ = 0;
    for (int i = 0; i < MESHES; i++)
        open_mesh(i);
    for (size_t i = 0; i < sizeof scenes / sizeof scenes[0]; i++) {
        const uint64_t wanted = run(&scenes[i], DPT_KERNEL_SCALAR, ticks);
        printf("scene %zu: %u contacts, %u sweeps that met, %u triangles of strips, %u ticks bounded, %016" PRIx64 "\n",
               i, contacts_met, sweeps_met, strip_triangles, bounded, wanted);
        for (uint32_t kernel = DPT_KERNEL_SCALAR + 1; kernel <= DPT_KERNEL_WASM128; kernel++) {
            const uint64_t other = run(&scenes[i], kernel, ticks);
            if (other && other != wanted) {
                printf("scene %zu: %s differs\n", i, dpt_kernel_name(kernel));
                differ = 1;
            }
        }
    }
    for (int i = 0; i < MESHES; i++) {
        dpt_compiled file = { files[i], 0 };
        dpt_compiled_free(&file);
    }
    return differ;
}
