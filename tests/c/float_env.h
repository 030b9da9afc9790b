/* float_env.h - the floating-point environment of this thread: rounding, flushing of subnormal
 * numbers and trapping exceptions, in the processor's own control register. */
#ifndef FLOAT_ENV_H
#define FLOAT_ENV_H

#include <stdint.h>

#if defined(__x86_64__)

static uint32_t float_env(void) {
    uint32_t mxcsr;
    __asm__ volatile("stmxcsr %0" : "=m"(mxcsr));
    return mxcsr;
}

static void set_float_env(uint32_t mxcsr) {
    __asm__ volatile("ldmxcsr %0" : : "m"(mxcsr) : "memory");
}

/* MXCSR: all exceptions masked; then each way of rounding, flush to zero (bit 15) with subnormals
 * read as zero (bit 6), one with flags set, no exception masked, and all at once. */
static const uint32_t float_envs[] = {0x1F80, 0x3F80, 0x5F80, 0x7F80, 0x9FC0,
                                      0x1FBF, 0x0000, 0xE040};

#elif defined(__aarch64__)

static uint32_t float_env(void) {
    uint64_t fpcr;
    __asm__ volatile("mrs %0, fpcr" : "=r"(fpcr));
    return (uint32_t)fpcr;
}

static void set_float_env(uint32_t value) {
    const uint64_t fpcr = value;
    __asm__ volatile("msr fpcr, %0" : : "r"(fpcr) : "memory");
}

/* FPCR: the default; each way of rounding (bits 22 and 23), flush to zero (24), default NaN (25),
 * all traps (8 to 12, 15), and all at once. */
static const uint32_t float_envs[] = {0,        0x400000,  0x800000, 0xC00000,
                                      0x1000000, 0x2000000, 0x9F00,   0x3C09F00};

#elif defined(__arm__) && defined(__ARM_FP)

static uint32_t float_env(void) {
    uint32_t fpscr;
    __asm__ volatile("vmrs %0, fpscr" : "=r"(fpscr));
    return fpscr;
}

static void set_float_env(uint32_t fpscr) {
    __asm__ volatile("vmsr fpscr, %0" : : "r"(fpscr) : "memory");
}

/* FPSCR: as FPCR of AArch64, with the flags in bits 0 to 7. */
static const uint32_t float_envs[] = {0,        0x400000,  0x800000, 0xC00000,
                                      0x1000000, 0x2000000, 0x9F1F,   0x3C09F00};

#else

static uint32_t float_env(void) { return 0; }
static void set_float_env(uint32_t value) { (void)value; }
static const uint32_t float_envs[] = {0};

#endif

#define FLOAT_ENVS (sizeof float_envs / sizeof *float_envs)

#endif
