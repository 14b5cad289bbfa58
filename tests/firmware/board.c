/* SPDX-License-Identifier: BSD-3-Clause */
#include "firmware/board.h"

int main(void);
void reset(void);

extern uint32_t data_source[], data_begin[], data_end[], bss_begin[], bss_end[], stack_top[], paint_end[];

#define REGISTER(address) (*(volatile uint32_t *)(uintptr_t)(address))
#define SYSTICK_CONTROL   REGISTER(0xe000e010)
#define SYSTICK_RELOAD    REGISTER(0xe000e014)
#define SYSTICK_VALUE     REGISTER(0xe000e018)
#define INTERRUPT_ENABLE  REGISTER(0xe000e100)
#define COPROCESSORS      REGISTER(0xe000ed88)
#define UART_DATA         REGISTER(0x40004000)
#define UART_STATE        REGISTER(0x40004004)
#define UART_CONTROL      REGISTER(0x40004008)
#define UART_INTERRUPT    REGISTER(0x4000400c)
#define UART_DIVIDER      REGISTER(0x40004010)
#define METER_DATA        REGISTER(0x40005000)
#define METER_STATE       REGISTER(0x40005004)
#define METER_CONTROL     REGISTER(0x40005008)
#define METER_DIVIDER     REGISTER(0x40005010)

enum { CLOCK_HZ = 25000000, RECEIVED = 1024, SENDING = 1024 };

static int semihost(uint32_t operation, const void *argument)
{
    register uint32_t r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
    return (int)r0;
}

void board_print(const char *text)
{
    semihost(0x04, text);
}

void board_print_number(uint32_t number)
{
    char digits[11], *at = digits + sizeof digits - 1;
    *at = 0;
    do
        *--at = (char)('0' + number % 10);
    while (number /= 10);
    board_print(at);
}

void board_exit(int status)
{
    const uint32_t block[2] = { 0x20026, (uint32_t)status };
    for (;;)
        semihost(0x20, block);
}

/* Single producer, single consumer: each side writes its own index alone. */
static volatile uint8_t received[RECEIVED];
static volatile uint32_t received_in, received_out;
static uint8_t sending[SENDING];
static uint32_t sending_in, sending_out;
static volatile uint32_t milliseconds;

static void uart_interrupt(void)
{
    UART_INTERRUPT = 2;
    while (UART_STATE & 2) {
        const uint8_t byte = (uint8_t)UART_DATA;
        if (received_in - received_out < RECEIVED)
            received[received_in++ % RECEIVED] = byte;
    }
}

static void tick_interrupt(void)
{
    milliseconds++;
}

void uart_start(void)
{
    UART_DIVIDER = CLOCK_HZ / 1000000;
    UART_CONTROL = 1 | 2 | 8;
    INTERRUPT_ENABLE = 1;
    METER_DIVIDER = CLOCK_HZ / 1000000;
    METER_CONTROL = 1;
}

int uart_get(void)
{
    if (received_out == received_in)
        return -1;
    return received[received_out++ % RECEIVED];
}

int uart_put(const uint8_t *bytes, size_t size)
{
    if (SENDING - (sending_in - sending_out) < size)
        return 0;
    for (size_t i = 0; i < size; i++)
        sending[sending_in++ % SENDING] = bytes[i];
    return 1;
}

void meter_put(const void *bytes, size_t size)
{
    const uint8_t *at = bytes;
    for (size_t i = 0; i < size; i++) {
        while (METER_STATE & 1)
            ;
        METER_DATA = at[i];
    }
}

void clock_start(void)
{
    SYSTICK_RELOAD = CLOCK_HZ / 1000 - 1;
    SYSTICK_VALUE = 0;
    SYSTICK_CONTROL = 7;
}

uint32_t clock_ms(void)
{
    return milliseconds;
}

void board_idle(void)
{
    while (sending_out != sending_in && !(UART_STATE & 1))
        UART_DATA = sending[sending_out++ % SENDING];
    if (sending_out == sending_in)
        __asm__ volatile("wfi");
}

static uint32_t counted;

void count_start(void)
{
    SYSTICK_RELOAD = 0xffffff;
    SYSTICK_VALUE = 0;
    SYSTICK_CONTROL = 5;
    while (SYSTICK_VALUE == 0)
        ;
    counted = SYSTICK_VALUE;
}

uint32_t count_instructions(void)
{
    const uint32_t now = SYSTICK_VALUE, passed = (counted - now) & 0xffffff;
    counted = SYSTICK_VALUE;
    return 40 * passed;
}

#define PAINT 0x5a5a5a5au

uint32_t stack_used(void)
{
    const uint32_t *at = bss_end;
    while (*at == PAINT)
        at++;
    return (uint32_t)((uintptr_t)stack_top - (uintptr_t)at);
}

static void fault(void)
{
    board_print("the processor stopped: a fault\n");
    board_exit(3);
}

void reset(void)
{
    uint32_t *to = data_begin;
    COPROCESSORS |= 0xfu << 20;
    __asm__ volatile("dsb\nisb");
    for (const uint32_t *from = data_source; to < data_end;)
        *to++ = *from++;
    for (to = bss_begin; to < bss_end;)
        *to++ = 0;
    while (to < paint_end)
        *to++ = PAINT;
    board_exit(main());
}

#define VECTOR(handler) (uintptr_t)(handler)
__attribute__((section(".vectors"), used)) static const uintptr_t vectors[17] = {
    VECTOR(stack_top),
    VECTOR(reset),
    VECTOR(fault),
    VECTOR(fault),
    VECTOR(fault),
    VECTOR(fault),
    VECTOR(fault),
    0,
    0,
    0,
    0,
    VECTOR(fault),
    VECTOR(fault),
    0,
    VECTOR(fault),
    VECTOR(tick_interrupt),
    VECTOR(uart_interrupt),
};
