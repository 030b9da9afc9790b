/* stack.h - how deep a call goes into the stack: what lies below the caller is painted before the
 * call and looked at after it. Needs no thread and no OS, so that it works on every target. */
#ifndef STACK_H
#define STACK_H

#include <stddef.h>

#define STACK_PAINTED (64u * 1024u)
#define STACK_PAINT 0xC3u

/* Paints the stack below the caller, or gives the bytes of it that were touched since. One function
 * for both, so that both have the same frame at the same place. */
static __attribute__((noinline)) size_t stack_walk(int paint) {
    unsigned char area[STACK_PAINTED];
    volatile unsigned char *at = area;
    size_t untouched = 0;
    __asm__("" : "+r"(at)); /* the compiler must not know that the bytes were never written */
    if (paint)
        for (; untouched < STACK_PAINTED; untouched++)
            at[untouched] = STACK_PAINT;
    while (untouched < STACK_PAINTED && at[untouched] == STACK_PAINT)
        untouched++;
    return STACK_PAINTED - untouched;
}

#endif
