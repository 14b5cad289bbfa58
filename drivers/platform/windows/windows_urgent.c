/* SPDX-License-Identifier: BSD-3-Clause */
#include "platform/urgent.h"

#include <string.h>
#include <windows.h>

#include "dynpoint/loop.h"

/* Memory is not locked, and processors are not kept awake: Windows lets no program ask for either as a whole. */
uint32_t urgent_begin(struct urgent *saved, uint32_t priority, uint32_t lock, uint32_t cpu, uint32_t awake)
{
    uint32_t notes = (lock ? DPT_LOOP_NOTE_NO_LOCK : 0) | (awake ? DPT_LOOP_NOTE_NO_AWAKE : 0);
    const HANDLE thread = GetCurrentThread();
    memset(saved, 0, sizeof *saved);
    saved->latency = -1;
    if (cpu) {
        saved->processors[0] = cpu <= 64 ? SetThreadAffinityMask(thread, (DWORD_PTR)1 << (cpu - 1)) : 0;
        saved->is_pinned = saved->processors[0] != 0;
        notes |= saved->is_pinned ? 0 : DPT_LOOP_NOTE_NO_CPU;
    }
    if (!priority)
        return notes;
    saved->priority = GetThreadPriority(thread);
    saved->is_scheduled =
        saved->priority != THREAD_PRIORITY_ERROR_RETURN && SetThreadPriority(thread, THREAD_PRIORITY_TIME_CRITICAL);
    return notes | (saved->is_scheduled ? 0 : DPT_LOOP_NOTE_NO_PRIORITY);
}

uint32_t urgent_end(const struct urgent *saved)
{
    uint32_t notes = 0;
    const HANDLE thread = GetCurrentThread();
    if (saved->is_scheduled && !SetThreadPriority(thread, saved->priority))
        notes |= DPT_LOOP_NOTE_NO_RETURN;
    if (saved->is_pinned && !SetThreadAffinityMask(thread, (DWORD_PTR)saved->processors[0]))
        notes |= DPT_LOOP_NOTE_NO_RETURN;
    return notes;
}
