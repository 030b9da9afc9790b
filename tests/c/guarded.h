/* Shared by the C tests: guarded memory, test frames. */
#ifndef GUARDED_H
#define GUARDED_H
#include "check.h"

#include <stdlib.h>
#include <string.h>

/* Memory aligned to POSEWISE_ALIGN with a guard on both sides. */
#define GUARD 256u
typedef struct {
    uint8_t *raw, *start;
    size_t len;
} guarded;

static guarded guarded_new(size_t len, uint8_t fill) {
    guarded g;
    g.raw = malloc(len + 2 * GUARD + POSEWISE_ALIGN);
    if (g.raw == NULL)
        exit(2);
    g.start = g.raw + GUARD;
    g.start += POSEWISE_ALIGN - (uintptr_t)g.start % POSEWISE_ALIGN;
    g.len = len;
    memset(g.raw, 0x5C, len + 2 * GUARD + POSEWISE_ALIGN);
    memset(g.start, fill, len);
    return g;
}

static int filled(const uint8_t *bytes, size_t len, uint8_t with) {
    size_t i;
    for (i = 0; i < len; i++)
        if (bytes[i] != with)
            return 0;
    return 1;
}

/* Checks the guards and frees the memory. */
static void guarded_free(guarded g) {
    const size_t before = (size_t)(g.start - g.raw);
    CHECK(filled(g.raw, before, 0x5C));
    CHECK(filled(g.start + g.len, 2 * GUARD + POSEWISE_ALIGN - before, 0x5C));
    free(g.raw);
}

/* Reads a whole file into guarded memory. */
static guarded guarded_file(const char *path) {
    FILE *file = fopen(path, "rb");
    guarded g;
    long len;
    if (file == NULL || fseek(file, 0, SEEK_END) != 0 || (len = ftell(file)) < 0) {
        printf("cannot read %s\n", path);
        exit(2);
    }
    rewind(file);
    g = guarded_new((size_t)len, 0);
    if (fread(g.start, 1, g.len, file) != g.len)
        exit(2);
    fclose(file);
    return g;
}

/* Test frames: grey, one after the other, without padding. */
typedef struct {
    guarded bytes;
    uint32_t width, height;
    size_t count;
} clip;

static clip clip_read(const char *path, const char *width, const char *height) {
    clip c;
    c.bytes = guarded_file(path);
    c.width = (uint32_t)strtoul(width, NULL, 10);
    c.height = (uint32_t)strtoul(height, NULL, 10);
    c.count = c.bytes.len / ((size_t)c.width * c.height);
    return c;
}

static posewise_frame clip_frame(const clip *c, size_t index) {
    posewise_frame f = POSEWISE_FRAME_INIT;
    const size_t len = (size_t)c->width * c->height;
    f.format = POSEWISE_FMT_GREY;
    f.timestamp_us = (int64_t)index * 33333;
    f.width = c->width;
    f.height = c->height;
    f.stride = c->width;
    f.data_len = len;
    f.data = c->bytes.start + index % c->count * len;
    return f;
}

#endif
