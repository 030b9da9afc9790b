/* Shared by the C tests: memory that ends where it says. Needs _POSIX_C_SOURCE 200112L before the
 * first header. */
#ifndef EXACT_H
#define EXACT_H
#include "posewise.h"

#include <stdlib.h>
#include <string.h>
#ifdef __NEWLIB__
#include <malloc.h> /* has memalign() in place of posix_memalign() */
#endif

/* Aligned memory of exact length: sanitizers and valgrind detect reads beyond it. */
static void *exact_new(const void *content, size_t len) {
    void *start = NULL;
#ifdef __NEWLIB__
    start = memalign(POSEWISE_ALIGN, len);
#else
    if (posix_memalign(&start, POSEWISE_ALIGN, len) != 0)
        exit(2);
#endif
    if (start == NULL)
        exit(2);
    if (content != NULL)
        memcpy(start, content, len);
    return start;
}

#endif
