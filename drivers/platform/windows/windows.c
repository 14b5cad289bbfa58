/* SPDX-License-Identifier: BSD-3-Clause */
/* Windows: clocks, threads, libraries, files, names. Names go to the system in its own UTF-16 (text/open_file.h). */
#include <windows.h>

#include <bcrypt.h>
#include <errno.h>
#include <fcntl.h>
#include <io.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "platform/clock.h"
#include "platform/file.h"
#include "platform/library.h"
#include "platform/machine.h"
#include "platform/thread.h"
#include "platform/windows/windows_text.h"
#include "text/open_file.h"

const char *const library_names_of_hd[] = { "HD.dll", NULL };
const char library_names_text_of_hd[] = "HD.dll";

char *windows_text(const wchar_t *wide)
{
    const int size = WideCharToMultiByte(CP_UTF8, 0, wide, -1, NULL, 0, NULL, NULL);
    char *text = size > 0 ? malloc((size_t)size) : NULL;
    if (text)
        WideCharToMultiByte(CP_UTF8, 0, wide, -1, text, size, NULL, NULL);
    return text;
}

static void copy_text(const wchar_t *wide, char *text, size_t room)
{
    char *made = windows_text(wide);
    snprintf(text, room, "%s", made && strlen(made) < room ? made : "");
    free(made);
}

/* ---- clocks ---- */

static const uint64_t SECOND = 1000000000u;

/* Files' times count 100 ns, from 1601 on. */
static uint64_t ns_of(FILETIME time, uint64_t before)
{
    return 100 * (((uint64_t)time.dwHighDateTime << 32 | time.dwLowDateTime) - before);
}

uint64_t clock_now(void)
{
    LARGE_INTEGER rate, count;
    QueryPerformanceFrequency(&rate);
    QueryPerformanceCounter(&count);
    const uint64_t ticks = (uint64_t)count.QuadPart, a_second = (uint64_t)rate.QuadPart;
    return ticks / a_second * SECOND + ticks % a_second * SECOND / a_second;
}

dpt_result clock_read(uint64_t *now)
{
    *now = clock_now();
    return DPT_OK;
}

/* The counter goes on while the machine is suspended. */
dpt_result clock_read_suspended(uint64_t *now, int64_t *suspended)
{
    *suspended = 0;
    return clock_read(now);
}

uint64_t clock_thread(void)
{
    FILETIME begun, ended, system, own;
    if (!GetThreadTimes(GetCurrentThread(), &begun, &ended, &system, &own))
        return 0;
    return ns_of(system, 0) + ns_of(own, 0);
}

uint64_t clock_wall(void)
{
    FILETIME time;
    GetSystemTimePreciseAsFileTime(&time);
    return ns_of(time, 116444736000000000u);
}

/* Of high resolution, which Windows 10 has from version 1803 on; one of 1 to 16 ms before. */
int clock_timer_open(struct clock_timer *timer)
{
    timer->handle = CreateWaitableTimerExW(NULL, NULL, 2, TIMER_ALL_ACCESS);
    if (!timer->handle)
        timer->handle = CreateWaitableTimerExW(NULL, NULL, 0, TIMER_ALL_ACCESS);
    return timer->handle != NULL;
}

int clock_timer_wait(const struct clock_timer *timer, uint64_t deadline)
{
    const uint64_t now = clock_now();
    if (now >= deadline)
        return 0;
    const LARGE_INTEGER due = { .QuadPart = -(LONGLONG)((deadline - now + 99) / 100) };
    if (!timer->handle)
        Sleep((DWORD)((deadline - now + 999999) / 1000000));
    else if (!SetWaitableTimer(timer->handle, &due, 0, NULL, NULL, FALSE) ||
             WaitForSingleObject(timer->handle, INFINITE) != WAIT_OBJECT_0)
        return -1;
    return 0;
}

void clock_timer_close(struct clock_timer *timer)
{
    if (timer->handle)
        CloseHandle(timer->handle);
    timer->handle = NULL;
}

void clock_sleep(uint64_t ns)
{
    struct clock_timer timer;
    clock_timer_open(&timer);
    clock_timer_wait(&timer, clock_now() + ns);
    clock_timer_close(&timer);
}

/* ---- threads and libraries ---- */

int thread_start(pthread_t *thread, void *(*run)(void *user), void *user)
{
    return pthread_create(thread, NULL, run, user);
}

void *library_load(const char *name, char *reason, size_t room)
{
    wchar_t *wide = wide_path(name), text[200];
    HMODULE library = wide ? LoadLibraryW(wide) : NULL;
    const DWORD error = library ? 0 : GetLastError();
    reason[0] = '\0';
    if (!library && (!wide || (error == ERROR_MOD_NOT_FOUND && !SearchPathW(NULL, wide, L".dll", 0, NULL, NULL)))) {
        snprintf(reason, room, "%s: No such file or directory", name);
    } else if (!library) {
        char *why =
            FormatMessageW(FORMAT_MESSAGE_FROM_SYSTEM | FORMAT_MESSAGE_IGNORE_INSERTS, NULL, error, 0, text, 200, NULL)
                ? windows_text(text)
                : NULL;
        if (why)
            why[strcspn(why, "\r\n")] = '\0';
        snprintf(reason, room, "%s: %s", name, why ? why : "it does not load");
        free(why);
    }
    free(wide);
    return library;
}

void *library_load_apart(const char *name, char *reason, size_t room)
{
    return library_load(name, reason, room);
}

void *library_find(void *library, const char *name)
{
    const FARPROC found = GetProcAddress(library, name);
    void *address;
    memcpy(&address, &found, sizeof address);
    return address;
}

/* ---- files ---- */

static int fail(void)
{
    switch (GetLastError()) {
    case ERROR_FILE_NOT_FOUND:
    case ERROR_PATH_NOT_FOUND:
    case ERROR_INVALID_NAME:
        errno = ENOENT;
        break;
    case ERROR_ACCESS_DENIED:
    case ERROR_SHARING_VIOLATION:
        errno = EACCES;
        break;
    case ERROR_ALREADY_EXISTS:
        errno = EEXIST;
        break;
    case ERROR_DISK_FULL:
        errno = ENOSPC;
        break;
    default:
        errno = EIO;
    }
    return -1;
}

static int open_as(const char *path, int how)
{
    wchar_t *wide = wide_path(path);
    const int file = wide ? _wopen(wide, how | _O_BINARY | _O_NOINHERIT, _S_IREAD | _S_IWRITE) : -1;
    free(wide);
    return file;
}

int file_open_read(const char *path)
{
    return open_as(path, _O_RDONLY);
}

/* Of a byte far behind what is read: such a lock keeps readers out. */
int file_lock(const char *path, int *file)
{
    OVERLAPPED at = { .Offset = 0x7FFFFFFE };
    struct file_status found;
    *file = file_get_status(path, &found) == 0 && found.is_regular ? file_open_read(path) : -1;
    if (*file < 0 ||
        LockFileEx((HANDLE)_get_osfhandle(*file), LOCKFILE_EXCLUSIVE_LOCK | LOCKFILE_FAIL_IMMEDIATELY, 0, 1, 0, &at) ||
        (GetLastError() != ERROR_LOCK_VIOLATION && GetLastError() != ERROR_IO_PENDING))
        return 0;
    _close(*file);
    *file = -1;
    return 1;
}

int file_open_write(const char *path)
{
    return open_as(path, _O_WRONLY | _O_CREAT | _O_TRUNC);
}

int file_open_new(const char *path)
{
    return open_as(path, _O_WRONLY | _O_CREAT | _O_EXCL);
}

long file_read(int file, void *bytes, size_t size)
{
    return _read(file, bytes, size < LONG_MAX ? (unsigned)size : LONG_MAX);
}

long file_write(int file, const void *bytes, size_t size)
{
    return _write(file, bytes, size < LONG_MAX ? (unsigned)size : LONG_MAX);
}

static void fill_status(HANDLE file, struct file_status *status)
{
    BY_HANDLE_FILE_INFORMATION found;
    *status = (struct file_status){ .is_regular = 0 };
    if (GetFileType(file) != FILE_TYPE_DISK || !GetFileInformationByHandle(file, &found))
        return;
    status->is_regular = !(found.dwFileAttributes & (FILE_ATTRIBUTE_DIRECTORY | FILE_ATTRIBUTE_REPARSE_POINT));
    status->bytes = status->is_regular ? (uint64_t)found.nFileSizeHigh << 32 | found.nFileSizeLow : 0;
    status->volume = found.dwVolumeSerialNumber;
    status->number = (uint64_t)found.nFileIndexHigh << 32 | found.nFileIndexLow;
}

static int get_status(const char *path, DWORD how, struct file_status *status)
{
    wchar_t *wide = wide_path(path);
    HANDLE file = wide ? CreateFileW(wide, FILE_READ_ATTRIBUTES, FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE,
                                     NULL, OPEN_EXISTING, FILE_FLAG_BACKUP_SEMANTICS | how, NULL)
                       : INVALID_HANDLE_VALUE;
    free(wide);
    if (file == INVALID_HANDLE_VALUE)
        return fail();
    fill_status(file, status);
    CloseHandle(file);
    return 0;
}

int file_get_status(const char *path, struct file_status *status)
{
    return get_status(path, 0, status);
}

int file_get_link_status(const char *path, struct file_status *status)
{
    return get_status(path, FILE_FLAG_OPEN_REPARSE_POINT, status);
}

int file_get_stream_status(FILE *stream, struct file_status *status)
{
    const HANDLE file = (HANDLE)_get_osfhandle(_fileno(stream));
    if (file == INVALID_HANDLE_VALUE)
        return -1;
    fill_status(file, status);
    return 0;
}

/* Who may use a file comes from its folder. */
void file_keep_mode(FILE *stream, const struct file_status *other)
{
    (void)stream, (void)other;
}

int file_cut(int file, uint64_t bytes)
{
    return _chsize_s(file, (int64_t)bytes) != 0 || _lseeki64(file, (int64_t)bytes, SEEK_SET) < 0 ? -1 : 0;
}

int file_cut_stream(FILE *stream, uint64_t bytes)
{
    return file_cut(_fileno(stream), bytes);
}

int file_replace(const char *from, const char *to)
{
    wchar_t *wide_from = wide_path(from), *wide_to = wide_path(to);
    const int is_done = wide_from && wide_to && MoveFileExW(wide_from, wide_to, MOVEFILE_REPLACE_EXISTING);
    const int result = is_done ? 0 : fail();
    free(wide_from);
    free(wide_to);
    return result;
}

int file_remove(const char *path)
{
    wchar_t *wide = wide_path(path);
    const int result = wide && DeleteFileW(wide) ? 0 : fail();
    free(wide);
    return result;
}

int file_remove_folder(const char *path)
{
    wchar_t *wide = wide_path(path);
    const int result = wide && RemoveDirectoryW(wide) ? 0 : fail();
    free(wide);
    return result;
}

static int compare_names(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

int file_list(const char *folder, int (*is_wanted)(const char *name), char ***names)
{
    WIN32_FIND_DATAW entry;
    const size_t size = strlen(folder) + 3;
    char *pattern = malloc(size);
    int count = 0, is_whole = 1;
    *names = NULL;
    if (!pattern)
        return -1;
    snprintf(pattern, size, "%s/*", folder);
    wchar_t *wide = wide_path(pattern);
    HANDLE found = wide ? FindFirstFileW(wide, &entry) : INVALID_HANDLE_VALUE;
    free(pattern);
    free(wide);
    if (found == INVALID_HANDLE_VALUE)
        return fail();
    do {
        char *name = windows_text(entry.cFileName);
        is_whole = name != NULL;
        if (!name || !is_wanted(name)) {
            free(name);
            continue;
        }
        char **grown = realloc(*names, (size_t)(count + 1) * sizeof *grown);
        is_whole = grown != NULL;
        if (grown) {
            grown[count++] = name;
            *names = grown;
        } else {
            free(name);
        }
    } while (is_whole && FindNextFileW(found, &entry));
    FindClose(found);
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
    wchar_t wide[MAX_PATH + 1] = L"";
    GetTempPathW(MAX_PATH + 1, wide);
    copy_text(wide, folder, room);
    const size_t size = strlen(folder);
    if (size > 1 && folder[size - 1] == '\\')
        folder[size - 1] = '\0';
}

/* What lies among a user's temporary files is this user's alone. */
int file_make_private_folder(const char *parent, char *folder, size_t room)
{
    uint64_t number;
    if (machine_random(&number, sizeof number) != 0)
        return 0;
    const int size = snprintf(folder, room, "%s\\dynpoint-%016llx", parent, (unsigned long long)number);
    wchar_t *wide = size > 0 && (size_t)size < room ? wide_path(folder) : NULL;
    const int is_made = wide && CreateDirectoryW(wide, NULL);
    free(wide);
    return is_made;
}

int file_open_kept(const char *folder, const char *path)
{
    (void)folder, (void)path;
    errno = ENOSYS;
    return -1;
}

void *file_memory(size_t size)
{
    return malloc(size);
}

/* ---- the machine ---- */

void machine_system(char *text, size_t room)
{
    typedef LONG WINAPI get_version(OSVERSIONINFOW *);
    OSVERSIONINFOW version = { .dwOSVersionInfoSize = sizeof version };
    const FARPROC found = GetProcAddress(GetModuleHandleW(L"ntdll.dll"), "RtlGetVersion");
    get_version *ask = NULL;
    memcpy(&ask, &found, sizeof ask);
    if (ask && ask(&version) == 0)
        snprintf(text, room, "Windows %lu.%lu.%lu", version.dwMajorVersion, version.dwMinorVersion,
                 version.dwBuildNumber);
    else
        snprintf(text, room, "Windows");
}

void machine_processor(char *text, size_t room)
{
    wchar_t name[128] = L"unknown";
    DWORD size = sizeof name;
    RegGetValueW(HKEY_LOCAL_MACHINE, L"HARDWARE\\DESCRIPTION\\System\\CentralProcessor\\0", L"ProcessorNameString",
                 RRF_RT_REG_SZ, NULL, name, &size);
    copy_text(name, text, room);
}

void machine_host(char *text, size_t room)
{
    wchar_t name[MAX_COMPUTERNAME_LENGTH + 1] = L"";
    DWORD size = MAX_COMPUTERNAME_LENGTH + 1;
    GetComputerNameW(name, &size);
    copy_text(name, text, room);
}

int machine_random(void *bytes, size_t size)
{
    return BCryptGenRandom(NULL, bytes, (ULONG)size, BCRYPT_USE_SYSTEM_PREFERRED_RNG) == 0 ? 0 : -1;
}
