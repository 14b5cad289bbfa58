/* SPDX-License-Identifier: BSD-3-Clause */
#include "openhaptics/openhaptics_library.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/frame.h"
#include "base/return_if_error.h"
#include "dynpoint/openhaptics.h"
#include "openhaptics/hd_api.h"
#include "platform/library.h"
#include "settings.h"

/* What packagers look for: https://uapi-group.org/specifications/specs/elf_dlopen_metadata/ */
#ifdef __ELF__
#define NOTE                                                                                                           \
    "[{\"feature\":\"openhaptics\",\"description\":\"Touch and Phantom haptic devices\","                              \
    "\"priority\":\"suggested\",\"soname\":[\"libHD.so.3.4\",\"libHD.so.3.0\",\"libHD.so\"]}]"
static const struct {
    uint32_t owner_size, text_size, type;
    char owner[4];
    char text[sizeof NOTE];
} note __attribute__((used, aligned(4), section(".note.dlopen"))) = { 4, sizeof NOTE, 0x407c0c0a, "FDO", NOTE };
#endif

enum { ERRORS_MAX = 256 };

static struct {
    struct hd_library library;
    char name[256]; /* "": none is loaded */
} loaded;

static const struct {
    const char *name;
    size_t at;
    int is_optional;
} functions[] = {
#define REQUIRED(result, name, arguments) { #name, offsetof(struct hd_library, name), 0 },
#define OPTIONAL(result, name, arguments) { #name, offsetof(struct hd_library, name), 1 },
    HD_FUNCTIONS(REQUIRED, OPTIONAL)
#undef REQUIRED
#undef OPTIONAL
};

/* 1 if library_load's reason says that `file` does not exist: `file` itself, or a library that it needs. */
static int is_missing(const char *file, const char *text)
{
    const size_t length = strlen(file);
    return !strncmp(text, file, length) && text[length] == ':' && strstr(text, "No such file or directory");
}

static dpt_result explain_failure(const char *name, const char *text, dpt_device_error *error)
{
    const size_t length = strcspn(text, ":");
    if (is_missing(name, text))
        return device_error(error, DPT_E_UNSUPPORTED,
                            "there is no library %.100s: leave library= and DPT_HD_LIBRARY out, or "
                            "name that of OpenHaptics",
                            name);
    char needed[64];
    snprintf(needed, sizeof needed, "%.*s", (int)(length < 60 ? length : 60), text);
    if (is_missing(needed, text)) {
        const char *what =
            strstr(needed, "PHANToMIO") || strstr(needed, "PhantomIO")
                ? "the device driver of 3D Systems that belongs to it"
                : (strstr(needed, "libncurses") ? "the package libncurses5 of your system" : "the package that has it");
        return device_error(error, DPT_E_UNSUPPORTED, "%.60s is here, but not %.60s, which it needs: install %s", name,
                            needed, what);
    }
    if (strstr(text, "undefined symbol"))
        return device_error(error, DPT_E_UNSUPPORTED,
                            "OpenHaptics and the device driver are not of one version (%.100s): "
                            "install two that belong together",
                            text);
    return device_error(error, DPT_E_UNSUPPORTED, "%.60s cannot be loaded: %.150s", name, text);
}

static dpt_result find_functions(void *handle, const char *name, dpt_device_error *error)
{
    for (size_t i = 0; i < sizeof functions / sizeof *functions; i++) {
        void *symbol = library_find(handle, functions[i].name);
        if (!symbol && !functions[i].is_optional)
            return device_error(error, DPT_E_UNSUPPORTED, "%.60s has no %s: it is not OpenHaptics, or older than 3.0",
                                name, functions[i].name);
        memcpy((char *)&loaded.library + functions[i].at, &symbol, sizeof symbol);
    }
    return DPT_OK;
}

hd_error hd_take_error(const struct hd_library *library)
{
    const hd_error last = library->hdGetError();
    for (int i = 0; i < ERRORS_MAX && library->hdGetError().code != HD_SUCCESS; i++)
        continue;
    return last;
}

/* One of these names, the first that is there. NULL: *failed is the first that is there and does not load, or NULL. */
static void *load_one_of(const char *const *names, int is_requested, const char **found, const char **failed,
                         char *text, size_t room)
{
    char reason[256];
    *failed = NULL;
    for (; *names; names++) {
        void *library = library_load(*names, reason, sizeof reason);
        *found = *names;
        if (library)
            return library;
        if (*failed || (!is_requested && is_missing(*names, reason)))
            continue;
        *failed = *names;
        snprintf(text, room, "%s", reason);
    }
    return NULL;
}

dpt_result hd_library_load(const char *name, const struct hd_library **library, dpt_device_error *error)
{
    const char *requested_name = *name ? name : getenv("DPT_HD_LIBRARY");
    requested_name = requested_name && *requested_name ? requested_name : NULL;
    *library = &loaded.library;
    if (loaded.name[0] && (!requested_name || !strcmp(requested_name, loaded.name)))
        return DPT_OK;
    if (loaded.name[0])
        return device_error(error, DPT_E_SETTING,
                            "this program has loaded %.60s, and can have only one: leave library= "
                            "out, or start another program for %.60s",
                            loaded.name, requested_name);
    const char *const requested[] = { requested_name, NULL };
    const char *found = NULL, *failed = NULL;
    char text[256];
    void *handle = load_one_of(requested_name ? requested : library_names_of_hd, requested_name != NULL, &found,
                               &failed, text, sizeof text);
    if (!handle && failed)
        return explain_failure(failed, text, error);
    if (!handle)
        return device_error(error, DPT_E_UNSUPPORTED,
                            "OpenHaptics is not installed (no %s): get its "
                            "developer edition and the Touch device driver from 3D Systems, or say "
                            "where it is by ?library= or DPT_HD_LIBRARY",
                            library_names_text_of_hd);
    const dpt_result result = find_functions(handle, found, error);
    if (result == DPT_OK)
        snprintf(loaded.name, sizeof loaded.name, "%s", found);
    return result;
}

/* ---- units ---- */

static const double MM = 1000.0, AXES_ERROR_MAX = 0.1;

int dpt_hd_is_force_error(uint32_t code)
{
    return code >= HD_WARM_MOTORS && code <= HD_FORCE_ERROR;
}

int dpt_hd_is_scheduler_error(uint32_t code)
{
    return (code >= HD_COMM_ERROR && code <= HD_TIMER_ERROR) || code == HD_INVALID_PRIORITY ||
           code == HD_SCHEDULER_FULL;
}

dpt_result dpt_hd_to_metres(const double from[3], double to[3])
{
    if (!from || !to)
        return DPT_E_ARGUMENT;
    if (!vec3_within(from, DPT_COORDINATE_MAX * MM))
        return DPT_E_FINITE;
    for (int k = 0; k < 3; k++)
        to[k] = from[k] / MM;
    return DPT_OK;
}

dpt_result dpt_hd_to_millimetres(const double from[3], double to[3])
{
    if (!from || !to)
        return DPT_E_ARGUMENT;
    if (!vec3_within(from, DPT_COORDINATE_MAX))
        return DPT_E_FINITE;
    for (int k = 0; k < 3; k++)
        to[k] = from[k] * MM;
    return DPT_OK;
}

/* The quaternion of a right-handed frame, w >= 0. Divides by the largest component, so never by a small number. */
static void quaternion_of(vec3 x, vec3 y, vec3 z, double q[4])
{
    const double square[4] = { 1.0 + x.x + y.y + z.z, 1.0 + x.x - y.y - z.z, 1.0 - x.x + y.y - z.z,
                               1.0 - x.x - y.y + z.z };
    int largest = 0;
    for (int i = 1; i < 4; i++)
        if (square[i] > square[largest])
            largest = i;
    const double root = sqrt(square[largest]), part = 0.5 / root;
    const double wx = part * (y.z - z.y), wy = part * (z.x - x.z), wz = part * (x.y - y.x);
    const double xy = part * (y.x + x.y), xz = part * (z.x + x.z), yz = part * (z.y + y.z);
    const double rows[4][4] = {
        { 0.5 * root, wx, wy, wz }, { wx, 0.5 * root, xy, xz }, { wy, xy, 0.5 * root, yz }, { wz, xz, yz, 0.5 * root }
    };
    for (int i = 0; i < 4; i++)
        q[i] = rows[largest][0] < 0.0 ? -rows[largest][i] : rows[largest][i];
}

dpt_result dpt_hd_to_pose(const double transform[16], dpt_pose *pose)
{
    if (!transform || !pose)
        return DPT_E_ARGUMENT;
    for (int i = 0; i < 12; i += 4)
        if (!vec3_within(transform + i, DPT_COORDINATE_MAX))
            return DPT_E_FINITE;
    vec3 x = vec3_of(transform), y = vec3_of(transform + 4), z = vec3_of(transform + 8);
    double position[3];
    DPT_TRY(dpt_hd_to_metres(transform + 12, position));
    if (!within(length(x) - 1.0, AXES_ERROR_MAX) || !within(length(y) - 1.0, AXES_ERROR_MAX) ||
        !within(length(z) - 1.0, AXES_ERROR_MAX) || !within(dot(x, y), AXES_ERROR_MAX) ||
        !within(dot(y, z), AXES_ERROR_MAX) || !within(dot(z, x), AXES_ERROR_MAX) || dot(cross(x, y), z) < 0.0)
        return DPT_E_POSE;
    z = unit_of(z);
    x = unit_of(along(x, -dot(x, z), z));
    y = cross(z, x);
    vec3_store(vec3_of(position), pose->position);
    quaternion_of(x, y, z, pose->orientation);
    return DPT_OK;
}

dpt_result dpt_hd_to_transform(const dpt_pose *pose, double transform[16])
{
    struct frame frame;
    if (!pose || !transform)
        return DPT_E_ARGUMENT;
    DPT_TRY(frame_of_pose(pose, &frame));
    vec3_store(frame.x, transform);
    vec3_store(frame.y, transform + 4);
    vec3_store(frame.z, transform + 8);
    dpt_hd_to_millimetres(pose->position, transform + 12);
    for (int i = 0; i < 4; i++)
        transform[4 * i + 3] = i == 3 ? 1.0 : 0.0;
    return DPT_OK;
}
