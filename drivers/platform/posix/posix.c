/* SPDX-License-Identifier: BSD-3-Clause */
/* What Linux and macOS share: clocks, threads, files, names. */
#ifdef __APPLE__
#define _DARWIN_C_SOURCE
#else
#define _GNU_SOURCE
#endif
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/utsname.h>
#include <time.h>
#include <unistd.h>

#include "platform/clock.h"
#include "platform/file.h"
#include "platform/machine.h"
#include "platform/thread.h"

/* ---- clocks ---- */

static const uint64_t SECOND = 1000000000u;

static dpt_result read_ns(clockid_t clock, uint64_t *ns)
{
    struct timespec time;
    if (clock_gettime(clock, &time) != 0)
        return DPT_E_SYSTEM;
    *ns = (uint64_t)time.tv_sec * SECOND + (uint64_t)time.tv_nsec;
    return DPT_OK;
}

dpt_result clock_read(uint64_t *now)
{
    return read_ns(CLOCK_MONOTONIC, now);
}

uint64_t clock_now(void)
{
    uint64_t now = 0;
    read_ns(CLOCK_MONOTONIC, &now);
    return now;
}

uint64_t clock_thread(void)
{
    uint64_t thread = 0;
    read_ns(CLOCK_THREAD_CPUTIME_ID, &thread);
    return thread;
}

uint64_t clock_wall(void)
{
    uint64_t wall = 0;
    read_ns(CLOCK_REALTIME, &wall);
    return wall;
}

void clock_sleep(uint64_t ns)
{
    const struct timespec time = { .tv_sec = (time_t)(ns / SECOND), .tv_nsec = (long)(ns % SECOND) };
    nanosleep(&time, NULL);
}

/* ---- threads ---- */

int thread_start(pthread_t *thread, void *(*run)(void *user), void *user)
{
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    const int error = pthread_create(thread, NULL, run, user);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return error;
}

/* ---- files ---- */

int file_open_read(const char *path)
{
    return open(path, O_RDONLY | O_CLOEXEC);
}

int file_lock(const char *path, int *file)
{
    struct file_status found;
    *file = -1;
    if (file_get_status(path, &found) != 0 || !found.is_regular)
        return 0;
    /* NFS locks what is open to be written. */
    *file = open(path, O_RDWR | O_CLOEXEC);
    if (*file < 0)
        *file = file_open_read(path);
    if (*file < 0 || flock(*file, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK)
        return 0;
    close(*file);
    *file = -1;
    return 1;
}

int file_open_write(const char *path)
{
    return open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
}

int file_open_new(const char *path)
{
    return open(path, O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC | O_NOFOLLOW, 0600);
}

long file_read(int file, void *bytes, size_t size)
{
    return read(file, bytes, size);
}

long file_write(int file, const void *bytes, size_t size)
{
    return write(file, bytes, size);
}

static int fill_status(int result, const struct stat *of, struct file_status *status)
{
    if (result != 0)
        return -1;
    *status = (struct file_status){ .is_regular = S_ISREG(of->st_mode),
                                    .bytes = S_ISREG(of->st_mode) ? (uint64_t)of->st_size : 0,
                                    .volume = (uint64_t)of->st_dev,
                                    .number = (uint64_t)of->st_ino,
                                    .mode = of->st_mode };
    return 0;
}

int file_get_status(const char *path, struct file_status *status)
{
    struct stat found;
    return fill_status(stat(path, &found), &found, status);
}

int file_get_link_status(const char *path, struct file_status *status)
{
    struct stat found;
    return fill_status(lstat(path, &found), &found, status);
}

int file_get_stream_status(FILE *stream, struct file_status *status)
{
    struct stat found;
    return fill_status(fstat(fileno(stream), &found), &found, status);
}

void file_keep_mode(FILE *stream, const struct file_status *other)
{
    fchmod(fileno(stream), (mode_t)other->mode & 0777);
}

int file_cut(int file, uint64_t bytes)
{
    return ftruncate(file, (off_t)bytes) != 0 || lseek(file, (off_t)bytes, SEEK_SET) < 0 ? -1 : 0;
}

int file_cut_stream(FILE *stream, uint64_t bytes)
{
    return file_cut(fileno(stream), bytes);
}

int file_replace(const char *from, const char *to)
{
    return rename(from, to);
}

int file_remove(const char *path)
{
    return unlink(path);
}

int file_remove_folder(const char *path)
{
    return rmdir(path);
}

static int compare_names(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

int file_list(const char *folder, int (*is_wanted)(const char *name), char ***names)
{
    int count = 0, is_whole = 1;
    DIR *opened = opendir(folder);
    *names = NULL;
    if (!opened)
        return -1;
    for (const struct dirent *entry; is_whole && (entry = readdir(opened));) {
        if (!is_wanted(entry->d_name))
            continue;
        char **grown = realloc(*names, (size_t)(count + 1) * sizeof *grown);
        if (grown)
            *names = grown;
        is_whole = grown && (grown[count] = strdup(entry->d_name));
        count += is_whole;
    }
    closedir(opened);
    if (!is_whole) {
        file_list_free(*names, count);
        *names = NULL;
        errno = ENOMEM;
        return -1;
    }
    if (count)
        qsort(*names, (size_t)count, sizeof **names, compare_names);
    return count;
}

void file_list_free(char **names, int count)
{
    for (int i = 0; i < count; i++)
        free(names[i]);
    free(names);
}

void file_temporary_folder(char *folder, size_t room)
{
    const char *temporary = getenv("TMPDIR");
    const int size = snprintf(folder, room, "%s", temporary && temporary[0] ? temporary : "/tmp");
    if (size < 0 || (size_t)size >= room)
        folder[0] = '\0';
}

int file_make_private_folder(const char *parent, char *folder, size_t room)
{
    const int size = snprintf(folder, room, "%s/dynpoint-XXXXXX", parent);
    return size > 0 && (size_t)size < room && mkdtemp(folder) != NULL;
}

/* Of this user, and closed to others. */
static int is_own(const struct stat *status, mode_t kind)
{
    return (status->st_mode & S_IFMT) == kind && status->st_uid == geteuid() && (status->st_mode & 077) == 0;
}

int file_open_kept(const char *folder, const char *path)
{
    struct stat status;
    if (stat(folder, &status) != 0 || !is_own(&status, S_IFDIR))
        return -1;
    const int file = open(path, O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK, 0600);
    if (file < 0 || (fstat(file, &status) == 0 && is_own(&status, S_IFREG)))
        return file;
    close(file);
    return -1;
}

void *file_memory(size_t size)
{
    void *bytes;
    return posix_memalign(&bytes, 64, size) ? NULL : bytes;
}

/* ---- the machine ---- */

void machine_system(char *text, size_t room)
{
    struct utsname name;
    if (uname(&name) >= 0)
        snprintf(text, room, "%s %s", name.sysname, name.release);
    else
        snprintf(text, room, "unknown system");
}

void machine_host(char *text, size_t room)
{
    text[0] = text[room - 1] = '\0';
    if (gethostname(text, room - 1))
        text[0] = '\0';
}
