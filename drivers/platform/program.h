/* SPDX-License-Identifier: BSD-3-Clause */
/* What a program asks of its system, and a library does not: arguments, signals, keys, other programs. */
#ifndef DPT_PLATFORM_PROGRAM_H
#define DPT_PLATFORM_PROGRAM_H

/* Call first. Returns the arguments in UTF-8; standard streams carry bytes as they are. */
char **program_begin(int *argc, char **argv);

/*
 * Call `stop` when the user or the system wants the program to end, when a reader of its output has gone, and after so
 * many seconds, if these are below 1e9. It is called at any time, from a signal or from another thread.
 */
void program_watch(void (*stop)(void), double seconds);

/* From now on a write fails, and does not end the program, if a file may not grow; and if a pipe's reader has gone. */
void program_ignore_file_limit(void);
void program_ignore_closed_pipe(void);

/* Call `call`, and undo what it does to how a closed pipe is met. */
void program_keep_closed_pipe(void (*call)(void *user), void *user);

/* Keys that are pressed at a terminal, one by one. */
struct keyboard {
    int is_terminal;
    void *before; /* of the terminal, for close */
};

void keyboard_open(struct keyboard *keyboard);
int keyboard_is_pressed(const struct keyboard *keyboard);
void keyboard_close(struct keyboard *keyboard);

/* Run a program until it ends, its output going to a file. Returns 1 if it ended well. `words` ends in NULL. */
int program_run(const char *const *words, const char *output);

/*
 * Let the desktop open a file of its own accord. Returns NULL, or what went wrong. *process, 0 for none, goes to
 * program_forget once.
 */
const char *program_open_document(const char *path, long *process);
void program_forget(long process);

#endif
