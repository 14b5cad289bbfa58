/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The motions of motion.h.
 */
#include "data/motion.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Below DPT_COORDINATE_MAX, with room for a tool that is a little off. */
static const double farthest = 9e5;

static const double turn_of_circle = 6.283185307179586;

/* SplitMix64; check.h has it too, with a test runner that no test calls here. */
static uint64_t random_bits(uint64_t *state)
{
    uint64_t z = (*state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

/* Uniform in [low, high). */
static double random_in(uint64_t *state, double low, double high)
{
    return low + (high - low) * ((double)(random_bits(state) >> 11) * 0x1p-53);
}

void motion_free(struct motion *motion)
{
    free(motion->ends);
    free(motion->jumps);
    memset(motion, 0, sizeof *motion);
}

double motion_diagonal(const struct motion_place *place)
{
    double square = 0;
    for (int k = 0; k < 3; k++)
        square += (place->high[k] - place->low[k]) * (place->high[k] - place->low[k]);
    return sqrt(square);
}

/* A test without memory has nothing to say. */
static void *grown(void *array, size_t bytes)
{
    array = realloc(array, bytes);
    if (!array) {
        fprintf(stderr, "memory ran out\n");
        exit(2);
    }
    return array;
}

static void append(struct motion *motion, const double a[3], const double b[3], int jump)
{
    double ends[6], extent = 0;
    if (motion->count == motion->room) {
        motion->room = motion->room ? 2 * motion->room : 1024;
        motion->ends = grown(motion->ends, motion->room * sizeof *motion->ends);
        motion->jumps = grown(motion->jumps, motion->room);
    }
    memcpy(ends, a, 3 * sizeof *a);
    memcpy(ends + 3, b, 3 * sizeof *b);
    for (int k = 0; k < 6; k++)
        extent = fmax(extent, fabs(ends[k]));
    for (int k = 0; k < 6 && extent > farthest; k++)
        ends[k] *= farthest / extent;
    memcpy(motion->ends[motion->count], ends, sizeof ends);
    motion->jumps[motion->count++] = (unsigned char)jump;
}

/* out = from + t along */
static void walk(double out[3], const double from[3], double t, const double along[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = from[k] + t * along[k];
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(double out[3], const double a[3], const double b[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

/* Recordings. */

enum form {
    JOINTS,       /* waist, shoulder, elbow, and the gimbal's yaw, pitch, roll */
    SCALAR_FIRST, /* w, x, y, z */
    SCALAR_LAST   /* x, y, z, w */
};

static const struct recording_form {
    const char *file;
    enum form form;
} forms[MOTION_RECORDINGS] = {
    [MOTION_GEOMAGIC] = { "geomagic_touch_recording_100hz.csv", JOINTS },
    [MOTION_LANDMARKS] = { "plus_stylus_landmarks_15hz.csv", SCALAR_FIRST },
    [MOTION_WATERTANK] = { "plus_watertank_46hz.csv", SCALAR_FIRST },
    [MOTION_MOCAP] = { "tum_fr2_desk_mocap.txt", SCALAR_LAST },
};

const char *const motion_names[MOTION_RECORDINGS] = { "geomagic", "landmarks", "watertank", "mocap" };

/* Numbers from the line's start on, blanks or a comma between them. */
static int numbers_in(const char *line, double *numbers, int most)
{
    int count = 0;
    while (count < most) {
        char *end;
        numbers[count] = strtod(line, &end);
        if (end == line)
            break;
        count++;
        line = end + strspn(end, ", \t");
    }
    return count;
}

static void normalise(double q[4])
{
    const double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    for (int k = 0; k < 4; k++)
        q[k] = length > 0 ? q[k] / length : k == 0;
}

/* q then turns about one of its own axes first. */
static void turn_about(double q[4], int axis, double angle)
{
    const double c = cos(angle / 2), s = sin(angle / 2);
    const int i = 1 + axis, j = 1 + (axis + 1) % 3, k = 1 + (axis + 2) % 3;
    const double w = c * q[0] - s * q[i], x = c * q[i] + s * q[0];
    const double y = c * q[j] + s * q[k], z = c * q[k] - s * q[j];
    q[0] = w, q[i] = x, q[j] = y, q[k] = z;
}

/*
 * The arm's first joint turns about the vertical, the next two about the horizontal; the gimbal
 * about the forearm, across it and along the stylus. Where the joints have their zeros does not
 * matter here: the hand's turning is in it.
 */
static void turn_of_joints(double q[4], const double joint[6])
{
    static const int axis[6] = { 1, 0, 0, 1, 0, 2 };
    q[0] = 1, q[1] = q[2] = q[3] = 0;
    for (int i = 0; i < 6; i++)
        turn_about(q, axis[i], joint[i]);
}

static int sample_of(struct sample *sample, const char *line, enum form form)
{
    double n[10];
    const int wanted = form == JOINTS ? 10 : 8;
    if (numbers_in(line, n, wanted) < wanted)
        return -1;
    sample->time = n[0];
    memcpy(sample->at, n + 1, sizeof sample->at);
    memcpy(sample->turn, n + 4, sizeof sample->turn);
    if (form == JOINTS) {
        turn_of_joints(sample->turn, n + 4);
    } else if (form == SCALAR_LAST) {
        sample->turn[0] = n[7];
        memcpy(sample->turn + 1, n + 4, 3 * sizeof *n);
    }
    normalise(sample->turn);
    return 0;
}

int recording_read(struct recording *recording, const char *data, int kind)
{
    char line[1024];
    memset(recording, 0, sizeof *recording);
    snprintf(line, sizeof line, "%s/traces/%s", data, forms[kind].file);
    FILE *file = fopen(line, "r");
    if (!file)
        return -1;
    size_t room = 0;
    while (fgets(line, sizeof line, file)) {
        struct sample sample;
        if (sample_of(&sample, line, forms[kind].form))
            continue; /* a header */
        const size_t count = recording->count;
        if (count && sample.time <= recording->samples[count - 1].time)
            continue; /* the same stamp again */
        if (count == room) {
            room = room ? 2 * room : 1024;
            recording->samples = grown(recording->samples, room * sizeof sample);
        }
        for (int k = 0; k < 3; k++) {
            recording->low[k] = count ? fmin(recording->low[k], sample.at[k]) : sample.at[k];
            recording->high[k] = count ? fmax(recording->high[k], sample.at[k]) : sample.at[k];
        }
        recording->samples[recording->count++] = sample;
    }
    fclose(file);
    return recording->count < 2 ? -1 : 0;
}

void recording_free(struct recording *recording)
{
    free(recording->samples);
    memset(recording, 0, sizeof *recording);
}

/* How many ticks begin between this sample and the next; none where the device was not seen. */
static size_t ticks_after(const struct recording *recording, size_t i, double *first)
{
    const double longest = 0.5;
    const double begin = 1e3 * (recording->samples[i].time - recording->samples[0].time);
    const double end = 1e3 * (recording->samples[i + 1].time - recording->samples[0].time);
    *first = ceil(begin);
    return end - begin > 1e3 * longest ? 0 : (size_t)(ceil(end) - ceil(begin));
}

static struct sample between(const struct sample *from, const struct sample *to, double share)
{
    struct sample sample = *from;
    double same = 0;
    for (int k = 0; k < 4; k++)
        same += from->turn[k] * to->turn[k];
    for (int k = 0; k < 3; k++)
        sample.at[k] += share * (to->at[k] - from->at[k]);
    for (int k = 0; k < 4; k++)
        sample.turn[k] += share * ((same < 0 ? -1 : 1) * to->turn[k] - from->turn[k]);
    normalise(sample.turn);
    return sample;
}

static void append_sample(struct motion *motion, const struct sample *sample, const struct recording *recording,
                          const struct motion_place *place, int jump)
{
    const struct motion_place own = { .low = { recording->low[0], recording->low[1], recording->low[2] },
                                      .high = { recording->high[0], recording->high[1], recording->high[2] } };
    const double scale = motion_diagonal(place) / motion_diagonal(&own);
    const double *q = sample->turn;
    const double along[3] = { 2 * (q[1] * q[3] + q[0] * q[2]), 2 * (q[2] * q[3] - q[0] * q[1]),
                              1 - 2 * (q[1] * q[1] + q[2] * q[2]) };
    double a[3], b[3];
    for (int k = 0; k < 3; k++)
        a[k] = (place->low[k] + place->high[k]) / 2 +
               scale * (sample->at[k] - (recording->low[k] + recording->high[k]) / 2);
    walk(b, a, place->tool * motion_diagonal(place), along);
    append(motion, a, b, jump);
}

void motion_recorded(struct motion *motion, const struct recording *recording, const struct motion_place *place,
                     uint64_t seed, size_t ticks)
{
    const struct sample *samples = recording->samples;
    size_t total = 0, begin = 0, tick = 0;
    double first;
    int jump = 1;
    for (size_t i = 0; i + 1 < recording->count; i++)
        total += ticks_after(recording, i, &first);
    if (ticks == 0 || ticks > total)
        ticks = total;
    else
        begin = (size_t)random_in(&seed, 0, (double)(total - ticks + 1));
    for (size_t i = 0; i + 1 < recording->count; i++) {
        const size_t here = ticks_after(recording, i, &first);
        jump |= here == 0 && samples[i + 1].time - samples[i].time > 1e-3;
        for (size_t j = 0; j < here; j++, tick++) {
            if (tick < begin || tick >= begin + ticks)
                continue;
            const double time = samples[0].time + 1e-3 * (first + (double)j);
            const double share = (time - samples[i].time) / (samples[i + 1].time - samples[i].time);
            const struct sample now = between(&samples[i], &samples[i + 1], share);
            append_sample(motion, &now, recording, place, jump);
            jump = 0;
        }
    }
}

/* At random. */

/* What one kind of random motion is made of; `spin` is an axis, as long as the angle of a tick. */
struct wander {
    const struct motion_place *place;
    uint64_t *seed;
    double diagonal;
    double at[3], along[3]; /* the middle of the tool, and half of it */
    double step[3], spin[3];
};

/* A power of ten. */
static double random_power(uint64_t *seed, double low, double high)
{
    return pow(10, random_in(seed, low, high));
}

static void random_direction(uint64_t *seed, double out[3], double length)
{
    double square;
    do {
        for (int k = 0; k < 3; k++)
            out[k] = random_in(seed, -1, 1);
        square = dot(out, out);
    } while (!(square > 0.01 && square <= 1));
    for (int k = 0; k < 3; k++)
        out[k] *= length / sqrt(square);
}

static void random_in_box(const struct wander *w, double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = random_in(w->seed, w->place->low[k], w->place->high[k]);
}

/* Somewhere in the box, `length` diagonals long. */
static void place_tool(struct wander *w, double length)
{
    random_in_box(w, w->at);
    random_direction(w->seed, w->along, length * w->diagonal / 2);
}

static const float *random_triangle(const struct wander *w)
{
    return w->place->corners + 9 * (random_bits(w->seed) % w->place->triangles);
}

static void corner_of(double out[3], const float *triangle, uint64_t i)
{
    for (int k = 0; k < 3; k++)
        out[k] = (double)triangle[3 * (i % 3) + (uint64_t)k];
}

/* Small, in the box, or beside a vertex, an edge or a face. */
static void small_tool(struct wander *w)
{
    place_tool(w, random_in(w->seed, 0, 0.05));
    if (random_bits(w->seed) % 2)
        return;
    const float *triangle = random_triangle(w);
    const uint64_t feature = random_bits(w->seed) % 3;
    double away[3];
    corner_of(w->at, triangle, 0);
    for (uint64_t i = 1; i <= feature; i++) {
        double edge[3];
        corner_of(edge, triangle, i);
        walk(edge, edge, -1, w->at);
        walk(w->at, w->at, random_in(w->seed, 0, 1), edge);
    }
    random_direction(w->seed, away, random_in(w->seed, 0, 0.02) * w->diagonal);
    walk(w->at, w->at, 1, away);
    for (int k = 0; k < 3; k++)
        w->along[k] *= 0.1;
}

static void append_wander(struct motion *motion, const struct wander *w, int jump)
{
    double a[3], b[3];
    walk(a, w->at, -1, w->along);
    walk(b, w->at, 1, w->along);
    append(motion, a, b, jump);
}

static void go_on(struct wander *w)
{
    double turned[3];
    walk(w->at, w->at, 1, w->step);
    cross(turned, w->spin, w->along);
    walk(turned, w->along, 1, turned);
    const double now = dot(turned, turned);
    for (int k = 0; k < 3 && now > 0; k++)
        turned[k] *= sqrt(dot(w->along, w->along) / now);
    memcpy(w->along, turned, sizeof turned);
}

/* Through a vertex, or ending in it with the very bits. */
static void append_vertex(struct motion *motion, const struct wander *w)
{
    double corner[3], along[3], a[3], b[3];
    corner_of(corner, random_triangle(w), random_bits(w->seed));
    random_direction(w->seed, along, w->place->tool * w->diagonal / 2);
    walk(a, corner, -1, along);
    walk(b, corner, 1, along);
    switch (random_bits(w->seed) % 3) {
    case 0:
        append(motion, a, b, 1);
        break;
    case 1:
        append(motion, corner, b, 0);
        break;
    default:
        append(motion, a, corner, 0);
    }
}

/* Along an edge: the edge itself, a part of it, beyond both its ends, or at its side. */
static void append_edge(struct motion *motion, const struct wander *w)
{
    const uint64_t i = random_bits(w->seed), how = random_bits(w->seed) % 4;
    const float *triangle = random_triangle(w);
    double from[3], to[3], edge[3], away[3], a[3], b[3];
    corner_of(from, triangle, i % 3);
    corner_of(to, triangle, i % 3 + 1);
    walk(edge, to, -1, from);
    const double beyond = how == 0 ? 0 : how == 1 ? -random_in(w->seed, 0, 0.5) : 4;
    walk(a, from, -beyond, edge);
    walk(b, to, beyond, edge);
    if (how == 3) {
        random_direction(w->seed, away, random_power(w->seed, -14, -2) * w->diagonal);
        walk(a, a, 1, away);
        walk(b, b, 1, away);
    }
    append(motion, a, b, (int)(i % 2));
}

/*
 * A point, or a tool that points at the surface, goes over an edge so slowly that the triangle
 * which it leaves stays within rounding of the nearest for many ticks.
 */
static void begin_creeping(struct wander *w)
{
    const uint64_t i = random_bits(w->seed);
    const float *triangle = random_triangle(w);
    double from[3], edge[3], side[3], normal[3], across[3];
    corner_of(from, triangle, i % 3);
    corner_of(edge, triangle, i % 3 + 1);
    corner_of(side, triangle, i % 3 + 2);
    walk(edge, edge, -1, from);
    walk(side, side, -1, from);
    cross(normal, edge, side);
    cross(across, normal, edge);
    const double high = random_power(w->seed, -4, 0) * w->diagonal;
    const double pace = sqrt(high * w->diagonal) * random_power(w->seed, -8.5, -7.5);
    const double up = high / sqrt(dot(normal, normal)), on = pace / sqrt(dot(across, across));
    if (!(isfinite(up) && isfinite(on)))
        return; /* a sliver: the tool that is there already will do */
    const double height = random_bits(w->seed) % 2 ? up : -up, length = i % 2 ? height : 0;
    walk(w->at, from, random_in(w->seed, 0.1, 0.9), edge);
    walk(w->at, w->at, height + length, normal);
    walk(w->at, w->at, -8 * on, across);
    for (int k = 0; k < 3; k++) {
        w->along[k] = length * normal[k];
        w->step[k] = on * across[k];
    }
}

enum {
    RESTING,
    SLOW,
    FAST,
    SPINNING,
    JUMPING,
    A_POINT,
    LONG,
    FAR,
    THROUGH_VERTICES,
    ALONG_EDGES,
    CREEPING,
    SMALL,
    WANDERS
};

/* Speeds are those of a box of 0.35 m, in diagonals a tick. */
static void begin_wander(struct wander *w, uint64_t kind)
{
    const double slow = 0.01 / 0.35 / 1e3, fast = 2 / 0.35 / 1e3;
    double away[3];
    memset(w->step, 0, sizeof w->step);
    memset(w->spin, 0, sizeof w->spin);
    place_tool(w, kind == A_POINT ? 0 : kind == LONG ? 10 : w->place->tool);
    if (kind == SLOW || kind == LONG || kind == A_POINT || kind == SPINNING)
        random_direction(w->seed, w->step, slow * w->diagonal);
    if (kind == FAST || kind == FAR)
        random_direction(w->seed, w->step, fast * w->diagonal);
    if (kind == SPINNING || kind == FAR)
        random_direction(w->seed, w->spin, 20 * turn_of_circle / 1e3);
    if (kind == FAR) {
        random_direction(w->seed, away, 100 * w->diagonal);
        walk(w->at, w->at, 1, away);
    }
    if (kind == CREEPING)
        begin_creeping(w);
}

static void append_random(struct motion *motion, struct wander *w, uint64_t kind, int first)
{
    switch (kind) {
    case THROUGH_VERTICES:
        append_vertex(motion, w);
        break;
    case ALONG_EDGES:
        append_edge(motion, w);
        break;
    case SMALL:
        small_tool(w);
        append_wander(motion, w, first);
        break;
    case JUMPING:
        place_tool(w, w->place->tool);
        append_wander(motion, w, random_bits(w->seed) % 2 != 0);
        break;
    default:
        append_wander(motion, w, first);
        go_on(w);
    }
}

void motion_random(struct motion *motion, const struct motion_place *place, uint64_t seed, size_t ticks)
{
    struct wander w = { .place = place, .seed = &seed, .diagonal = motion_diagonal(place) };
    uint64_t kind = random_bits(&seed) % WANDERS;
    for (size_t i = 0; i < ticks; i++) {
        const int first = i % 20 == 0;
        if (first) {
            kind = (kind + 1) % WANDERS;
            begin_wander(&w, kind);
        }
        /* Most pieces begin without a word to the world that the tool has jumped. */
        append_random(motion, &w, kind, first && random_bits(&seed) % 4 == 0);
    }
    if (ticks > 0)
        motion->jumps[motion->count - ticks] = 1;
}

void motion_small(struct motion *motion, const struct motion_place *place, uint64_t seed, size_t ticks)
{
    struct wander w = { .place = place, .seed = &seed, .diagonal = motion_diagonal(place) };
    for (size_t i = 0; i < ticks; i++) {
        small_tool(&w);
        append_wander(motion, &w, i == 0);
    }
}

/* Sliding. */

static int write_bytes(const char *path, const void *bytes, size_t size)
{
    FILE *file = fopen(path, "wb");
    if (!file)
        return -1;
    const int whole = fwrite(bytes, 1, size, file) == size;
    return fclose(file) == 0 && whole ? 0 : -1;
}

static int read_trace(struct motion *motion, const char *path, size_t ticks)
{
    char line[1024];
    const size_t before = motion->count;
    FILE *file = fopen(path, "r");
    if (!file)
        return -1;
    while (fgets(line, sizeof line, file)) {
        double n[7];
        if (numbers_in(line, n, 7) == 7)
            append(motion, n + 1, n + 4, motion->count == before);
    }
    fclose(file);
    return motion->count - before == ticks ? 0 : -1;
}

int motion_slide(struct motion *motion, const char *dynpoint, const char *scratch, const void *compiled, size_t size,
                 uint64_t seed, size_t ticks)
{
    char mesh[1024], trace[1024], command[4096];
    snprintf(mesh, sizeof mesh, "%s.dpa", scratch);
    snprintf(trace, sizeof trace, "%s.csv", scratch);
    snprintf(command, sizeof command, "'%s' make trace --mesh '%s' -o '%s' --seed %u --ticks %zu", dynpoint, mesh,
             trace, (unsigned)(seed % 1000000), ticks);
    int result = write_bytes(mesh, compiled, size);
    if (result == 0)
        result = system(command) == 0 ? read_trace(motion, trace, ticks) : -1;
    remove(mesh);
    remove(trace);
    return result;
}
