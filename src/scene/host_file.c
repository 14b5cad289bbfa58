/* SPDX-License-Identifier: BSD-3-Clause */
#include "scene/host_file.h"

#include <ctype.h>
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "platform/file.h"
#include "text/open_file.h"

enum { FIRST_ROOM = 1 << 16, PIECE_BYTES = 4096 };

/* What has no length may be endless: a pipe, /dev/zero. */
static const size_t STREAM_MAX = (size_t)1 << 30;

int host_file_ends_in(const char *path, const char *ending)
{
    const size_t length = strlen(path), count = strlen(ending);
    if (length <= count)
        return 0;
    for (size_t i = 0; i < count; i++)
        if (tolower((unsigned char)path[length - count + i]) != ending[i])
            return 0;
    return 1;
}

int host_file_is_same(const char *path, const char *other)
{
    struct file_status one, two;
    return path && other && file_get_status(path, &one) == 0 && file_get_status(other, &two) == 0 &&
           one.volume == two.volume && one.number == two.number;
}

int host_file_is_of_device(const char *path, const char *device)
{
    char piece[PIECE_BYTES];
    int is_same = 0;
    for (const char *at = strchr(device, ':'); at && *at && !is_same;) {
        const size_t length = strcspn(++at, "?&=");
        snprintf(piece, sizeof piece, "%.*s", (int)length, at);
        is_same = host_file_is_same(piece, path);
        at += length;
    }
    return is_same;
}

static int has_length(FILE *file)
{
    struct file_status status;
    return file_get_stream_status(file, &status) == 0 && status.is_regular;
}

/* All that comes, with room for a zero behind it. NULL: reading failed, and errno says why; EFBIG: beyond STREAM_MAX. */
static unsigned char *read_all(FILE *file, size_t *size)
{
    unsigned char *bytes = NULL;
    const size_t max = has_length(file) ? SIZE_MAX : STREAM_MAX;
    size_t room = 0, got = 1;
    *size = 0;
    while (got) {
        if (*size + 1 >= room) {
            const size_t larger = room ? 2 * room : FIRST_ROOM;
            void *grown = file_memory(larger);
            if (!grown) {
                errno = ENOMEM;
                break;
            }
            if (bytes)
                memcpy(grown, bytes, *size);
            free(bytes);
            bytes = grown;
            room = larger;
        }
        got = fread(bytes + *size, 1, room - *size - 1, file);
        *size += got;
        if (*size > max) {
            errno = EFBIG;
            break;
        }
    }
    if (!got && !ferror(file))
        return bytes;
    free(bytes);
    return NULL;
}

void *host_file_load(const char *path, size_t *size, dpt_host_error *error)
{
    FILE *file = strcmp(path, "-") ? open_file(path, "rb") : stdin;
    if (!file) {
        host_refuse(error, DPT_E_OPEN, "%s: cannot be opened: %s", path, strerror(errno));
        return NULL;
    }
    unsigned char *bytes = read_all(file, size);
    const int reason = errno;
    if (file != stdin)
        fclose(file);
    if (bytes)
        bytes[*size] = 0;
    else if (reason == EFBIG)
        host_refuse(error, DPT_E_LIMIT,
                    "%s: it has no length, and more than %zu bytes come: what is larger must be a file", path,
                    STREAM_MAX);
    else
        host_refuse(error, reason == ENOMEM ? DPT_E_MEMORY : DPT_E_OPEN, "%s: cannot be read: %s", path,
                    strerror(reason));
    return bytes;
}

void *host_file_copy(const void *bytes, size_t size, dpt_host_error *error)
{
    void *copy = file_memory(size + 1);
    if (!copy) {
        host_refuse(error, DPT_E_MEMORY, "memory ran out");
        return NULL;
    }
    memcpy(copy, bytes, size);
    ((char *)copy)[size] = 0;
    return copy;
}

int host_file_is_arm(const void *bytes, size_t size)
{
    return dpt_arm_verify(bytes, size, NULL) != DPT_E_MAGIC;
}

static void refuse_bytes(const char *path, const dpt_mesh_fault *fault, dpt_result result, const char *cure,
                         dpt_host_error *error)
{
    host_refuse(error, result, "%s: byte %" PRIu64 " (%s): %s%s", path, fault->byte, fault->section,
                dpt_result_text(result), cure);
}

const dpt_mesh *host_file_open_mesh(const char *path, void *bytes, size_t size, dpt_host_error *error)
{
    const dpt_mesh *mesh = NULL;
    dpt_mesh_fault fault = { .size = sizeof fault };
    dpt_result result = dpt_mesh_convert(bytes, size, &fault);
    if (result == DPT_OK)
        result = dpt_mesh_open(bytes, size, &mesh);
    if (result != DPT_OK)
        refuse_bytes(path, &fault, result, result == DPT_E_MAGIC ? "; dynpoint compile makes one" : "", error);
    return mesh;
}

const dpt_arm *host_file_open_arm(const char *path, void *bytes, size_t size, dpt_host_error *error)
{
    const dpt_arm *arm = NULL;
    dpt_mesh_fault fault = { .size = sizeof fault };
    dpt_result result = dpt_arm_convert(bytes, size, &fault);
    if (result == DPT_OK)
        result = dpt_arm_open(bytes, size, &arm);
    if (result != DPT_OK)
        refuse_bytes(path, &fault, result, "", error);
    return arm;
}
