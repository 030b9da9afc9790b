/* Shared by the C and C++ tests: checks that print their line. */
#ifndef CHECK_H
#define CHECK_H
#include "posewise.h"

#include <stdio.h>

static int failures;

#define CHECK(holds)                                                   \
    do {                                                               \
        if (!(holds)) {                                                \
            printf("%s:%d: %s\n", __FILE__, __LINE__, #holds);         \
            failures++;                                                \
        }                                                              \
    } while (0)

/* POSEWISE_E_ARG stands for the codes into which it is divided. */
#define CHECK_STATUS(call, expected)                                                       \
    do {                                                                                   \
        const long got_ = (call), want_ = (expected);                                      \
        if (got_ != want_ && !(want_ == POSEWISE_E_ARG && got_ <= POSEWISE_E_NULL)) {      \
            printf("%s:%d: %s is %ld, not %ld\n", __FILE__, __LINE__, #call, got_, want_); \
            failures++;                                                                    \
        }                                                                                  \
    } while (0)

#endif
