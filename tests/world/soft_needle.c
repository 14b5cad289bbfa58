/* SPDX-License-Identifier: BSD-3-Clause */
#include "world/soft_needle.h"

/* Its end a is the point, and it stands upright. */
static const dpt_segment shaft = { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, NEEDLE_LENGTH }, NEEDLE_RADIUS };

dpt_body_settings soft_needle_gel(double friction)
{
    return (dpt_body_settings){ .size = sizeof(dpt_body_settings),
                                .side_limit = -1.0,
                                .puncture_force = 0.4,
                                .cutting_force = 0.1,
                                .shaft_friction = friction };
}

void soft_needle_set_gel(struct soft_needle *needle, const struct tissue_body *body, const dpt_body_settings *gel)
{
    dpt_body_settings settings = { .size = sizeof settings };
    dpt_body_get_settings(needle->tissue.rig.world, body->id, &settings);
    settings.puncture_force = gel->puncture_force;
    settings.toughness = gel->toughness;
    settings.cutting_force = gel->cutting_force;
    settings.shaft_friction = gel->shaft_friction;
    settings.shaft_viscosity = gel->shaft_viscosity;
    settings.shaft_stiffness = gel->shaft_stiffness;
    const dpt_result result = dpt_body_set_settings(needle->tissue.rig.world, body->id, &settings);
    CHECK(result == DPT_OK, "settings: %s", dpt_result_name(result));
}

struct tissue_def soft_needle_liver(uint32_t integrator)
{
    struct tissue_def def = tissue_ball();
    def.young = 5e3;
    def.spacing = 0.012;
    def.integrator = integrator;
    return def;
}

void soft_needle_aim(struct soft_needle *needle)
{
    needle->tool->device.position[2] = needle->body->top + needle->body->place[2] - needle->depth;
}

double soft_needle_tick(struct soft_needle *needle)
{
    soft_needle_aim(needle);
    return tissue_rig_tick(&needle->tissue);
}

/* A needle above a body. */
static int place_needle(struct soft_needle *needle, double stiffness)
{
    dpt_tool_settings settings = { .size = sizeof settings };
    needle->tool = tissue_rig_add_tool(&needle->tissue, &shaft, stiffness);
    dpt_tool_get_settings(needle->tissue.rig.world, needle->tool->id, &settings);
    settings.piercing = DPT_PIERCING_A;
    CHECK(dpt_tool_set_settings(needle->tissue.rig.world, needle->tool->id, &settings) == DPT_OK, "no needle");
    needle->tool->device.position[0] = NEEDLE_LATERAL;
    needle->tool->device.position[1] = 0.002;
    needle->depth = -0.002;
    soft_needle_aim(needle);
    tissue_rig_place(&needle->tissue);
    return 1;
}

static int open_in(struct soft_needle *needle, const struct tissue_def *def, const dpt_body_settings *gel,
                   double stiffness)
{
    needle->body = tissue_rig_add_soft(&needle->tissue, def);
    if (!needle->body)
        return 0;
    soft_needle_set_gel(needle, needle->body, gel);
    return place_needle(needle, stiffness);
}

int soft_needle_open(struct soft_needle *needle, const struct tissue_def *def, const dpt_body_settings *gel,
                     double stiffness)
{
    return soft_needle_open_within(needle, def, gel, stiffness, 0);
}

int soft_needle_open_within(struct soft_needle *needle, const struct tissue_def *def, const dpt_body_settings *gel,
                            double stiffness, uint32_t budget)
{
    memset(needle, 0, sizeof *needle);
    tissue_rig_open_pierced(&needle->tissue, 6, budget, DPT_KERNEL_AUTO);
    return open_in(needle, def, gel, stiffness);
}

int soft_needle_open_unlisted(struct soft_needle *needle, const struct tissue_def *def, const dpt_body_settings *gel,
                              double stiffness)
{
    memset(needle, 0, sizeof *needle);
    tissue_rig_open_unlisted(&needle->tissue, 6);
    return open_in(needle, def, gel, stiffness);
}

int soft_needle_open_on(struct soft_needle *needle, const struct tissue_def *def, const dpt_body_settings *gel,
                        double stiffness, uint32_t kernel)
{
    memset(needle, 0, sizeof *needle);
    tissue_rig_open_pierced(&needle->tissue, 6, 0, kernel);
    return open_in(needle, def, gel, stiffness);
}

int soft_needle_open_over(struct soft_needle *needle, const struct tissue_def *def, double stiffness)
{
    memset(needle, 0, sizeof *needle);
    tissue_rig_open_pierced(&needle->tissue, 6, 0, DPT_KERNEL_AUTO);
    needle->body = tissue_rig_add_mesh(&needle->tissue, def);
    return needle->body && place_needle(needle, stiffness);
}

void soft_needle_close(struct soft_needle *needle)
{
    tissue_rig_close(&needle->tissue);
}

/* The device goes to a depth, slowly. */
void soft_needle_go(struct soft_needle *needle, double depth)
{
    const int ticks = (int)ceil(fabs(depth - needle->depth) / NEEDLE_SLOW);
    const double from = needle->depth;
    for (int i = 1; i <= ticks; i++) {
        needle->depth = from + (depth - from) * i / ticks;
        soft_needle_tick(needle);
    }
}

void soft_needle_hold(struct soft_needle *needle, int ticks)
{
    for (int i = 0; i < ticks; i++)
        soft_needle_tick(needle);
}

uint32_t soft_needle_channels(const struct soft_needle *needle, dpt_channel *all, uint32_t capacity)
{
    return rig_channels(&needle->tissue.rig, needle->tool->id, all, capacity);
}

dpt_channel soft_needle_channel(const struct soft_needle *needle)
{
    return rig_channel(&needle->tissue.rig, needle->tool->id);
}

/* m: from the entry, where the triangle and its weights have it, to the axis where the tool's spring ends. */
double soft_needle_beside_entry(const struct soft_needle *needle)
{
    const dpt_channel channel = soft_needle_channel(needle);
    const uint32_t *corners, *numbers;
    uint32_t count, vertices, place = 0;
    double ends[6], along[3], from[3];
    const float *at = tissue_vertices(&needle->tissue, needle->body, &vertices);
    CHECK(dpt_mesh_get_triangles(needle->body->mesh.mesh, &corners, &numbers, &count) == DPT_OK, "triangles");
    while (place < count && numbers[place] != channel.triangle)
        place++;
    tissue_tool_end(needle->tool, ends);
    for (int c = 0; c < 3; c++) {
        along[c] = (ends[3 + c] - ends[c]) / NEEDLE_LENGTH;
        from[c] = -ends[c];
    }
    for (int c = 0; c < 9; c++)
        from[c % 3] += channel.weight[c / 3] * (double)at[3 * corners[3 * place + (uint32_t)c / 3] + (uint32_t)c % 3];
    const double on = dot3(from, along);
    for (int c = 0; c < 3; c++)
        from[c] -= on * along[c];
    return length3(from);
}

int soft_needle_crosses(const double ends[6], const float *vertices, const uint32_t *corners, double *share)
{
    const double way[3] = { ends[3] - ends[0], ends[4] - ends[1], ends[5] - ends[2] };
    double v[3][3], e[2][3], p[3], q[3], from[3];
    for (int k = 0; k < 9; k++)
        v[k / 3][k % 3] = (double)vertices[3 * (size_t)corners[k / 3] + (size_t)(k % 3)];
    for (int k = 0; k < 3; k++) {
        e[0][k] = v[1][k] - v[0][k];
        e[1][k] = v[2][k] - v[0][k];
        from[k] = ends[k] - v[0][k];
    }
    cross3(way, e[1], p);
    cross3(from, e[0], q);
    const double size = dot3(e[0], p), a = dot3(from, p) / size, b = dot3(way, q) / size;
    *share = dot3(e[1], q) / size;
    return a >= 0.0 && b >= 0.0 && a + b <= 1.0 && *share > 0.0 && *share < 1.0;
}

uint32_t soft_needle_stretches(const struct soft_needle *needle, double lengths[SOFT_NEEDLE_STRETCHES])
{
    enum { ROOM = 2 * SOFT_NEEDLE_STRETCHES };
    double ends[6], local[6], crossings[ROOM];
    uint32_t count = 0, stretches = 0, triangles, vertices;
    const float *at = tissue_vertices(&needle->tissue, needle->body, &vertices);
    const uint32_t *corners = tissue_corners(needle->body, &triangles);
    tissue_tool_end(needle->tool, ends);
    for (int k = 0; k < 6; k++)
        local[k] = ends[k] - needle->body->place[k % 3];
    for (uint32_t t = 0; t < triangles && count < ROOM; t++)
        count += (uint32_t)soft_needle_crosses(local, at, corners + 3 * (size_t)t, &crossings[count]);
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t k = i + 1; k < count; k++)
            if (crossings[k] < crossings[i]) {
                const double nearer = crossings[k];
                crossings[k] = crossings[i];
                crossings[i] = nearer;
            }
    /* From the point on: an odd number where it is inside. */
    for (uint32_t i = 0; i < count; i++)
        if ((i + count) % 2)
            lengths[stretches++] = NEEDLE_LENGTH * (crossings[i] - (i ? crossings[i - 1] : 0.0));
    return stretches;
}

double soft_needle_inside(const struct soft_needle *needle)
{
    double lengths[SOFT_NEEDLE_STRETCHES], inside = 0.0;
    const uint32_t count = soft_needle_stretches(needle, lengths);
    for (uint32_t i = 0; i < count; i++)
        inside += lengths[i];
    return inside;
}

static int is_cell(int (*is_solid)(int x, int y, int z), int x, int y, int z)
{
    const int is_within =
        x >= 0 && x < SOFT_NEEDLE_CELLS && y >= 0 && y < SOFT_NEEDLE_CELLS && z >= 0 && z < SOFT_NEEDLE_CELLS;
    return is_within && is_solid(x, y, z);
}

const struct tissue_arrays *soft_needle_cells(int (*is_solid)(int x, int y, int z))
{
    enum { CELLS = SOFT_NEEDLE_CELLS, SIDE = CELLS + 1, TRIANGLES_MOST = 12 * CELLS * CELLS * CELLS };
    static const int step[3][3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
    static double vertices[3 * SIDE * SIDE * SIDE];
    static uint32_t corners[3 * TRIANGLES_MOST];
    static struct tissue_arrays arrays = { .vertices = vertices,
                                           .vertex_count = SIDE * SIDE * SIDE,
                                           .corners = corners };
    uint32_t count = 0;
    for (int i = 0; i < SIDE * SIDE * SIDE; i++) {
        vertices[3 * i] = SOFT_NEEDLE_CELL * (i % SIDE - CELLS / 2);
        vertices[3 * i + 1] = SOFT_NEEDLE_CELL * (i / SIDE % SIDE - CELLS / 2);
        vertices[3 * i + 2] = SOFT_NEEDLE_CELL * (i / SIDE / SIDE);
    }
    for (int i = 0; i < CELLS * CELLS * CELLS; i++)
        for (int face = 0; face < 6; face++) {
            const int at[3] = { i % CELLS, i / CELLS % CELLS, i / CELLS / CELLS };
            const int d = face / 2, way = face % 2 ? 1 : -1, *n = step[d], *u = step[(d + 1) % 3],
                      *v = step[(d + 2) % 3];
            uint32_t quad[4];
            if (!is_cell(is_solid, at[0], at[1], at[2]) ||
                is_cell(is_solid, at[0] + way * n[0], at[1] + way * n[1], at[2] + way * n[2]))
                continue;
            for (int k = 0; k < 4; k++) {
                const int a = way > 0 ? k == 1 || k == 2 : k >= 2, b = way > 0 ? k >= 2 : k == 1 || k == 2;
                int c[3];
                for (int m = 0; m < 3; m++)
                    c[m] = at[m] + (way > 0 ? n[m] : 0) + a * u[m] + b * v[m];
                quad[k] = (uint32_t)(c[0] + SIDE * (c[1] + SIDE * c[2]));
            }
            const uint32_t two[6] = { quad[0], quad[1], quad[2], quad[0], quad[2], quad[3] };
            memcpy(corners + 6 * count, two, sizeof two);
            count++;
        }
    arrays.triangles = 2 * count;
    return &arrays;
}
