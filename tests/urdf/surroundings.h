/* SPDX-License-Identifier: BSD-3-Clause */
/* What a C++ program may have done around a call of ours: its locale, its log, its memory. */
#ifndef DPT_TESTS_SURROUNDINGS_H
#define DPT_TESTS_SURROUNDINGS_H

#ifdef __cplusplus
extern "C" {
#endif

/* The global C++ locale writes 1.5 as 1,5 and 1000 as 1.000; 0 puts the classic one back. */
void comma_in_cpp(int on);

/* Let console_bridge's messages go to a counter of ours, from level NONE on. */
void log_begin(void);
/* Whether handler and level are those still; how many came. */
int log_is_ours(void);
int log_count(void);
/* Whether the handler before it is back. */
int log_end(void);

/* Log one message as urdfdom would, from this thread. */
void log_something(void);

/*
 * What is said of the origin's quaternion of a joint, by an urdfdom that has them or not: notes, or -1 for a refusal;
 * the last one's text.
 */
int notes_on_quaternion(const char *value, char *text, unsigned long room);

/*
 * So many allocations of this thread succeed from now on, in C++ and in our C; -1: all. Meanwhile leaks of C++ are not reported:
 * TinyXML 2.6 has some.
 */
extern __thread long allocations_left;

/* Blocks that our C has now, of this thread. */
extern __thread long blocks_in_c;

#ifdef __cplusplus
}
#endif

#endif
