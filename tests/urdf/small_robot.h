/* SPDX-License-Identifier: BSD-3-Clause */
/* Arms from small descriptions of a test's own, with what was noted of them. */
#ifndef DPT_TESTS_SMALL_ROBOT_H
#define DPT_TESTS_SMALL_ROBOT_H

#include <math.h>
#include <sys/stat.h>
#include <unistd.h>

#include "dynpoint.h"
#include "dynpoint/urdf.h"
#include "lib/check.h"

#define JOINT(name, type, parent, child, more)                                                                         \
    "<joint name=\"" name "\" type=\"" type "\"><parent link=\"" parent "\"/><child link=\"" child "\"/>" more         \
    "</joint>"
#define LIMIT "<limit lower=\"-2\" upper=\"2\" effort=\"1\" velocity=\"1\"/>"
#define MASS(at, kg)                                                                                                   \
    "<inertial><origin xyz=\"" at "\"/><mass value=\"" kg                                                              \
    "\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial>"

static char scratch[64];

/* An open arm, and what was noted of it, a line each. */
struct robot {
    dpt_compiled compiled;
    const dpt_arm *arm;
    dpt_arm_info info;
    char notes[4096];
};

static inline void hear(void *user, uint64_t line, const char *text)
{
    struct robot *robot = user;
    size_t length = strlen(robot->notes);
    snprintf(robot->notes + length, sizeof robot->notes - length, "%lu %s\n", (unsigned long)line, text);
}

static inline struct robot robot_of(const char *path, dpt_urdf_def def)
{
    struct robot robot = { .info = { .size = sizeof robot.info } };
    dpt_diag diag = { .size = sizeof diag };
    def.size = sizeof def;
    def.note = hear;
    def.user = &robot;
    dpt_result result = dpt_urdf_compile_file(path, &def, &robot.compiled, &diag);
    CHECK(result == DPT_OK, "%s:%lu: %s", path, (unsigned long)diag.line, diag.text);
    if (result == DPT_OK)
        result = dpt_arm_open(robot.compiled.bytes, robot.compiled.size, &robot.arm);
    CHECK(result == DPT_OK, "%s: %s", path, dpt_result_name(result));
    if (result != DPT_OK) {
        printf("  FAIL no arm to test\n");
        exit(1);
    }
    dpt_arm_get_info(robot.arm, &robot.info);
    return robot;
}

/* A description between <robot> and </robot>, as a file of its own. */
static inline struct robot robot_in(const char *content, const char *tool)
{
    static int number;
    char path[128];
    snprintf(path, sizeof path, "%s/arm_%d.urdf", scratch, number++);
    FILE *file = fopen(path, "w");
    fprintf(file, "<robot name=\"r\">%s</robot>\n", content);
    fclose(file);
    return robot_of(path, (dpt_urdf_def){ .tool = tool });
}

static inline int near(double a, double b)
{
    return fabs(a - b) <= 1e-12;
}

/* A folder of the test's own. Returns 0 after a message. */
static inline int scratch_make(const char *test)
{
    snprintf(scratch, sizeof scratch, "build/tests/%s.%ld", test, (long)getpid());
    mkdir("build", 0777);
    mkdir("build/tests", 0777);
    if (mkdir(scratch, 0777) == 0)
        return 1;
    printf("  FAIL %s cannot be made\n", scratch);
    return 0;
}

static inline void scratch_remove(void)
{
    char command[128];
    snprintf(command, sizeof command, "rm -rf '%s'", scratch);
    if (system(command) != 0)
        printf("  %s is left\n", scratch);
}

#endif
