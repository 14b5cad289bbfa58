/* SPDX-License-Identifier: BSD-3-Clause */
/* What the program asks of Windows. */
#include "platform/sockets.h"

#include <windows.h>

#include <conio.h>
#include <fcntl.h>
#include <io.h>
#include <shellapi.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "platform/program.h"
#include "platform/windows/windows_text.h"
#include "text/open_file.h"

char **program_begin(int *argc, char **argv)
{
    int count = 0;
    DWORD mode;
    FILE *const streams[] = { stdin, stdout, stderr };
    wchar_t **wide = CommandLineToArgvW(GetCommandLineW(), &count);
    char **arguments = wide ? calloc((size_t)count + 1, sizeof *arguments) : NULL;
    for (int i = 0; i < 3; i++)
        _setmode(_fileno(streams[i]), _O_BINARY);
    SetConsoleOutputCP(CP_UTF8);
    const HANDLE console = GetStdHandle(STD_OUTPUT_HANDLE);
    if (GetConsoleMode(console, &mode))
        SetConsoleMode(console, mode | ENABLE_VIRTUAL_TERMINAL_PROCESSING);
    for (int i = 0; arguments && i < count; i++)
        arguments[i] = windows_text(wide[i]);
    LocalFree(wide);
    if (!arguments)
        return argv;
    *argc = count;
    return arguments;
}

/* ---- the end ---- */

static void (*call_stop)(void);

static BOOL WINAPI on_console(DWORD event)
{
    (void)event;
    call_stop();
    return TRUE;
}

static void CALLBACK on_time(void *user, BOOLEAN is_time)
{
    (void)user, (void)is_time;
    call_stop();
}

void program_watch(void (*stop)(void), double seconds)
{
    HANDLE timer;
    call_stop = stop;
    SetConsoleCtrlHandler(on_console, TRUE);
    if (seconds < 1e6)
        CreateTimerQueueTimer(&timer, NULL, on_time, NULL, (DWORD)(1e3 * seconds), 0, WT_EXECUTEONLYONCE);
}

/* Windows ends no program for either. */
void program_ignore_file_limit(void)
{
}

void program_ignore_closed_pipe(void)
{
}

void program_keep_closed_pipe(void (*call)(void *user), void *user)
{
    call(user);
}

/* ---- keys ---- */

void keyboard_open(struct keyboard *keyboard)
{
    DWORD mode;
    *keyboard = (struct keyboard){ .is_terminal = GetConsoleMode(GetStdHandle(STD_INPUT_HANDLE), &mode) != 0 };
}

int keyboard_is_pressed(const struct keyboard *keyboard)
{
    return keyboard->is_terminal && _kbhit() && _getch() >= 0;
}

void keyboard_close(struct keyboard *keyboard)
{
    keyboard->is_terminal = 0;
}

/* ---- other programs ---- */

/* One word of a command line, as CommandLineToArgvW reads it; 0 if there is no room. */
static int add_word(char *line, size_t room, const char *word)
{
    size_t at = strlen(line), slashes = 0;
    if (at + 2 * strlen(word) + 4 > room)
        return 0;
    if (at)
        line[at++] = ' ';
    line[at++] = '"';
    for (;; word++) {
        if (*word == '\\') {
            slashes++;
            line[at++] = '\\';
            continue;
        }
        /* Before a quote each backslash stands twice. */
        if (*word == '"' || !*word)
            for (; slashes; slashes--)
                line[at++] = '\\';
        slashes = 0;
        if (!*word)
            break;
        if (*word == '"')
            line[at++] = '\\';
        line[at++] = *word;
    }
    line[at++] = '"';
    line[at] = '\0';
    return 1;
}

int program_run(const char *const *words, const char *output)
{
    enum { LINE_ROOM = 32000 };
    char *line = calloc(1, LINE_ROOM);
    wchar_t *wide = calloc(LINE_ROOM, sizeof *wide), *path = wide_path(output);
    SECURITY_ATTRIBUTES inherited = { .nLength = sizeof inherited, .bInheritHandle = TRUE };
    PROCESS_INFORMATION process = { .hProcess = NULL };
    DWORD status = 1;
    int is_ready = line && wide && path;
    for (; is_ready && *words; words++)
        is_ready = add_word(line, LINE_ROOM, *words);
    HANDLE file = is_ready ? CreateFileW(path, GENERIC_WRITE, FILE_SHARE_READ, &inherited, CREATE_ALWAYS, 0, NULL)
                           : INVALID_HANDLE_VALUE;
    STARTUPINFOW start = { .cb = sizeof start,
                           .dwFlags = STARTF_USESTDHANDLES,
                           .hStdInput = GetStdHandle(STD_INPUT_HANDLE),
                           .hStdOutput = file,
                           .hStdError = GetStdHandle(STD_ERROR_HANDLE) };
    if (file != INVALID_HANDLE_VALUE && MultiByteToWideChar(CP_UTF8, 0, line, -1, wide, LINE_ROOM) &&
        CreateProcessW(NULL, wide, NULL, NULL, TRUE, 0, NULL, NULL, &start, &process)) {
        WaitForSingleObject(process.hProcess, INFINITE);
        GetExitCodeProcess(process.hProcess, &status);
        CloseHandle(process.hThread);
        CloseHandle(process.hProcess);
    }
    if (file != INVALID_HANDLE_VALUE)
        CloseHandle(file);
    free(line);
    free(wide);
    free(path);
    return status == 0;
}

const char *program_open_document(const char *path, long *process)
{
    wchar_t *wide = wide_path(path);
    /* What is above 32 is no error. */
    const int is_opened = wide && (INT_PTR)ShellExecuteW(NULL, L"open", wide, NULL, NULL, SW_SHOWNORMAL) > 32;
    free(wide);
    *process = 0;
    return is_opened ? NULL : "no browser is set up for HTML files";
}

void program_forget(long process)
{
    (void)process;
}

int sockets_have_local_6(void)
{
    WSADATA ignored;
    struct sockaddr_in6 address = { .sin6_family = AF_INET6 };
    if (WSAStartup(MAKEWORD(2, 2), &ignored) != 0)
        return 0;
    address.sin6_addr.s6_addr[15] = 1;
    const SOCKET probe = socket(AF_INET6, SOCK_STREAM, 0);
    const int has_6 = probe != INVALID_SOCKET && bind(probe, (const struct sockaddr *)&address, sizeof address) == 0;
    if (probe != INVALID_SOCKET)
        closesocket(probe);
    WSACleanup();
    return has_6;
}
