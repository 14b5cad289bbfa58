/* SPDX-License-Identifier: BSD-3-Clause */
/* Threads and mutexes are those of pthread.h, which mingw-w64 and zig have on Windows too. */
#ifndef DPT_PLATFORM_THREAD_H
#define DPT_PLATFORM_THREAD_H

#include <pthread.h>

/* Start a thread that no signal interrupts: they go to the host's threads. Returns 0, or pthread_create's error. */
int thread_start(pthread_t *thread, void *(*run)(void *user), void *user);

#endif
