/* start.c - start-up code for a Cortex-M4F: vectors, floating point, memory, arguments of main().
 * Files and printf go to the debugger (semihosting), which a product does not need.
 * Prints the peak stack of main() on standard error, unless the program paints the stack itself. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

extern uint32_t data_load[], data_start[], data_end[], bss_start[], bss_end[];
extern uint32_t stack_limit[], stack_top[];
extern void initialise_monitor_handles(void);
int main(int argc, char **argv);
void reset(void);

/* Gets the words of the debugger's command line. */
static int arguments(char **words, int capacity) {
    static char line[256];
    struct {
        char *line;
        uint32_t len;
    } block = {line, sizeof line};
    register uint32_t operation __asm__("r0") = 0x15; /* SYS_GET_CMDLINE */
    register void *parameter __asm__("r1") = &block;
    int count = 0;
    char *word;
    __asm__ volatile("bkpt 0xAB" : "+r"(operation) : "r"(parameter) : "memory");
    for (word = strtok(line, " "); word != NULL && count < capacity; word = strtok(NULL, " "))
        words[count++] = word;
    return count;
}

#define PAINT 0xC3C3C3C3u

static void paint_stack(void) {
    uintptr_t own;
    volatile uint32_t *at = stack_limit;
    __asm__("mov %0, sp" : "=r"(own));
    while ((uintptr_t)at < own)
        *at++ = PAINT;
}

static void print_stack(void) {
    const uint32_t *deepest = stack_limit;
    while (*deepest == PAINT)
        deepest++;
    fprintf(stderr, "stack: %lu bytes\n",
            (unsigned long)((const char *)stack_top - (const char *)deepest));
}

void reset(void) {
    static char *words[8];
    int status;
    *(volatile uint32_t *)0xE000ED88 |= 0xFu << 20; /* CPACR: enable the floating-point unit */
    __asm__ volatile("dsb\nisb" ::: "memory");
    memcpy(data_start, data_load, (size_t)((char *)data_end - (char *)data_start));
    memset(bss_start, 0, (size_t)((char *)bss_end - (char *)bss_start));
    initialise_monitor_handles();
    paint_stack();
    status = main(arguments(words, 8), words);
    print_stack();
    exit(status);
}

static void fault(void) {
    _Exit(99);
}

union vector {
    void *stack;
    void (*handler)(void);
};

__attribute__((section(".vectors"), used)) static const union vector vectors[16] = {
    {.stack = stack_top}, {.handler = reset}, {.handler = fault}, {.handler = fault},
    {.handler = fault},   {.handler = fault}, {.handler = fault},
};
