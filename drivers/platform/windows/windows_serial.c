/* SPDX-License-Identifier: BSD-3-Clause */
/* COM ports: "COM3", or with what Windows puts before it, "\\.\COM3". */
#include <windows.h>

#include <errno.h>
#include <fcntl.h>
#include <io.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "platform/clock.h"
#include "platform/serial_line.h"
#include "settings.h"

enum { NAMES_ROOM = 1 << 16, NAP = 500000 };

static HANDLE port_of(int fd)
{
    return (HANDLE)_get_osfhandle(fd);
}

static dpt_result explain_open_error(const char *path, dpt_device_error *error)
{
    switch (GetLastError()) {
    case ERROR_FILE_NOT_FOUND:
    case ERROR_PATH_NOT_FOUND:
        return device_error(error, DPT_E_DEVICE,
                            "%.60s is not there: is the device plugged in and switched on? Ports are COM1, COM2 and so "
                            "on; the device manager lists them",
                            path);
    case ERROR_ACCESS_DENIED:
    case ERROR_SHARING_VIOLATION:
        return device_error(error, DPT_E_SYSTEM, "%.60s is in use by another program: end that one first", path);
    default:
        return device_error(error, DPT_E_SYSTEM, "%.60s: error %lu of Windows", path, GetLastError());
    }
}

static dpt_result set_up_port(HANDLE port, const char *path, uint32_t speed, dpt_device_error *error)
{
    /* A read takes what has come. A write waits for 1 ms at most, which is as short as can be said. */
    COMMTIMEOUTS times = { .ReadIntervalTimeout = MAXDWORD, .WriteTotalTimeoutConstant = 1 };
    DCB settings = { .DCBlength = sizeof settings };
    if (!GetCommState(port, &settings))
        return device_error(error, DPT_E_DEVICE, "%.60s is not a serial port", path);
    settings = (DCB){ .DCBlength = sizeof settings,
                      .BaudRate = speed,
                      .fBinary = TRUE,
                      .fDtrControl = DTR_CONTROL_ENABLE,
                      .fRtsControl = RTS_CONTROL_ENABLE,
                      .ByteSize = 8,
                      .Parity = NOPARITY,
                      .StopBits = ONESTOPBIT };
    if (!SetCommState(port, &settings))
        return device_error(error, DPT_E_SYSTEM,
                            "%.60s does not take %u baud: choose another by ?speed=, the same as the device's", path,
                            (unsigned)speed);
    settings.BaudRate = 0;
    if (!GetCommState(port, &settings) || settings.BaudRate != speed)
        return device_error(error, DPT_E_SYSTEM,
                            "%.60s runs at %u baud where %u were asked for: it does not have that speed; choose one by "
                            "?speed=, the same as the device's",
                            path, (unsigned)settings.BaudRate, (unsigned)speed);
    if (!SetCommTimeouts(port, &times) || !PurgeComm(port, PURGE_RXCLEAR | PURGE_TXCLEAR))
        return explain_open_error(path, error);
    return DPT_OK;
}

dpt_result serial_line_open(const char *path, uint32_t speed, int *fd, dpt_device_error *error)
{
    char name[300];
    *fd = -1;
    snprintf(name, sizeof name, "%s%s", strncmp(path, "\\\\", 2) ? "\\\\.\\" : "", path);
    HANDLE port = CreateFileA(name, GENERIC_READ | GENERIC_WRITE, 0, NULL, OPEN_EXISTING, 0, NULL);
    if (port == INVALID_HANDLE_VALUE)
        return explain_open_error(path, error);
    dpt_result result = set_up_port(port, path, speed, error);
    if (result == DPT_OK) {
        *fd = _open_osfhandle((intptr_t)port, _O_RDWR | _O_BINARY);
        result = *fd < 0 ? device_error(error, DPT_E_SYSTEM, "%.60s: too many files are open", path) : DPT_OK;
    }
    if (result != DPT_OK)
        CloseHandle(port);
    return result;
}

long serial_line_read(int fd, void *bytes, size_t size)
{
    DWORD count = 0;
    return ReadFile(port_of(fd), bytes, (DWORD)size, &count, NULL) ? (long)count : -1;
}

long serial_line_write(int fd, const void *bytes, size_t size)
{
    DWORD count = 0;
    return WriteFile(port_of(fd), bytes, (DWORD)size, &count, NULL) ? (long)count : -1;
}

void serial_line_wait(int fd, uint64_t deadline)
{
    const uint64_t longest = clock_now() + 20000000u, until = deadline < longest ? deadline : longest;
    COMSTAT state;
    DWORD faults;
    while (ClearCommError(port_of(fd), &faults, &state) && !state.cbInQue && clock_now() < until)
        clock_sleep(NAP);
}

void serial_line_close(int fd)
{
    PurgeComm(port_of(fd), PURGE_RXABORT | PURGE_TXABORT | PURGE_RXCLEAR | PURGE_TXCLEAR);
    _close(fd);
}

void serial_line_find(void (*found)(void *user, const char *path, const char *about), void *user)
{
    char *names = malloc(NAMES_ROOM);
    const DWORD size = names ? QueryDosDeviceA(NULL, names, NAMES_ROOM) : 0;
    for (const char *name = names; size && *name; name += strlen(name) + 1)
        if (!strncmp(name, "COM", 3) && name[3] >= '0' && name[3] <= '9')
            found(user, name, "serial port");
    free(names);
}

int serial_line_simulate(char *path, size_t room)
{
    (void)path, (void)room;
    errno = ENOSYS;
    return -1;
}
