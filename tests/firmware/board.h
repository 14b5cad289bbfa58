/* SPDX-License-Identifier: BSD-3-Clause */
/* The board that QEMU emulates (mps2-an500): start, millisecond, UART, and words to the one who started it. */
#ifndef BOARD_H
#define BOARD_H

#include <stddef.h>
#include <stdint.h>

/* To QEMU's console, by semihosting; and the end, with a status. */
void board_print(const char *text);
void board_print_number(uint32_t number);
void board_exit(int status) __attribute__((noreturn));

/* The UART: -1 when nothing has come; bytes to send must fit as a whole, else 0 and none is sent. */
void uart_start(void);
int uart_get(void);
int uart_put(const uint8_t *bytes, size_t size);

/* To the second UART, whose other end takes all at once. */
void meter_put(const void *bytes, size_t size);

/* Milliseconds since clock_start; board_idle sends what waits, and then sleeps until something happens. */
void clock_start(void);
uint32_t clock_ms(void);
void board_idle(void);

/* Instructions since the last call, with QEMU's -icount shift=0, in steps of 40; less than 6e8. */
void count_start(void);
uint32_t count_instructions(void);

/* The most bytes that the stack has held. */
uint32_t stack_used(void);

#endif
