/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Motions of a tool for tests, 1 ms a tick: recorded by real devices (the folder traces of
 * DPT_DATA), sliding over a mesh (dynpoint make trace), and made up at random to reach what hands
 * do not. A seed names a motion. Each call appends to a motion; its first tick is a jump.
 *
 * All of them are cut to what the library takes: a segment with a coordinate beyond 9e5 m is shrunk
 * towards the origin.
 */
#ifndef DPT_TESTS_DATA_MOTION_H
#define DPT_TESTS_DATA_MOTION_H

#include <stddef.h>
#include <stdint.h>

struct motion {
    double (*ends)[6];    /* ax, ay, az, bx, by, bz */
    unsigned char *jumps; /* nonzero where the tick does not follow from the one before */
    size_t count, room;
};

void motion_free(struct motion *motion);

/* What a motion goes through. */
struct motion_place {
    double low[3], high[3]; /* the mesh's box */
    double tool;            /* length of the tool, as a share of the box's diagonal */
    const float *corners;   /* 9 numbers a triangle */
    uint32_t triangles;
};

/* 0.3 m for a box with a diagonal of 0.35 m */
#define MOTION_TOOL 0.86

double motion_diagonal(const struct motion_place *place);

/* What the device told, without ticks. */
struct sample {
    double time, at[3];
    double turn[4]; /* quaternion, w first */
};

struct recording {
    struct sample *samples;
    size_t count;
    double low[3], high[3];
};

enum {
    MOTION_GEOMAGIC,  /* a haptic stylus, 100 Hz */
    MOTION_LANDMARKS, /* a tracked stylus going from point to point, 15 Hz */
    MOTION_WATERTANK, /* a probe going up and down, 46 Hz */
    MOTION_MOCAP,     /* a body held in a hand, 300 Hz, with a gap of 12 s */
    MOTION_RECORDINGS
};

extern const char *const motion_names[MOTION_RECORDINGS];

/* Read a recording of the folder `data`/traces; -1 when that cannot be. */
int recording_read(struct recording *recording, const char *data, int kind);
void recording_free(struct recording *recording);

/*
 * A recording moved into the box by one scale, the diagonal of its own box to that of the mesh's,
 * its tip where the device was: `ticks` consecutive ones from where the seed says, or all of them
 * (0). Position is interpolated linearly, orientation too and then normalised; over a gap the tool
 * jumps.
 */
void motion_recorded(struct motion *motion, const struct recording *recording, const struct motion_place *place,
                     uint64_t seed, size_t ticks);

/*
 * Pieces of 20 ticks, in turn: at rest, slow, fast, spinning, jumping, a point, ten diagonals long,
 * a hundred diagonals away, through vertices, along edges, creeping over edges, and small.
 */
void motion_random(struct motion *motion, const struct motion_place *place, uint64_t seed, size_t ticks);

/* Small tools alone, each somewhere else, half of them close to the surface, on both sides. */
void motion_small(struct motion *motion, const struct motion_place *place, uint64_t seed, size_t ticks);

/*
 * What the program `dynpoint` makes for a compiled mesh. Mesh and trace pass through files whose
 * names begin with `scratch`; they are removed. -1 when it cannot be run or writes something else.
 */
int motion_slide(struct motion *motion, const char *dynpoint, const char *scratch, const void *compiled, size_t size,
                 uint64_t seed, size_t ticks);

#endif
