/* replay.c VIDEO.y4m FRAMES - prints a hash of all bytes of all results for the video's first
 * frames. The line is the same on every machine. Standard error gets the sizes of model and tracker
 * and the peak stack of posewise_init and posewise_step [bytes].
 * C99 with GCC's attributes; reads 8-bit mono y4m. */
#include "posewise.h"
#include "float_env.h"
#include "stack.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* FNV-1a, 64 bits. */
static uint64_t hash = 0xCBF29CE484222325u;

static void hash_bytes(const void *bytes, size_t len) {
    const uint8_t *at = bytes;
    while (len-- > 0)
        hash = (hash ^ *at++) * 0x100000001B3u;
}

/* Static memory, small enough for a microcontroller board: the frames are the largest. */
static uint8_t memory[POSEWISE_MEMORY_SIZE + POSEWISE_ALIGN];
static uint8_t pixels[640 * 480], last[640 * 480];
static posewise_landmark landmarks[POSEWISE_LANDMARKS];
static float animation[POSEWISE_ANIMATIONS];

static int fail(const char *what) {
    fprintf(stderr, "replay: %s\n", what);
    return 1;
}

/* The deepest stack of a step so far. */
static size_t step_stack;

static posewise_status step(posewise_tracker *tracker, posewise_frame *frame,
                            posewise_result *result) {
    static unsigned count;
    const uint32_t own = float_env();
    uint32_t before, after;
    posewise_status status;
    size_t used;
    stack_walk(1);
    /* Each step in another floating-point environment, which must not matter. */
    set_float_env(float_envs[count++ % FLOAT_ENVS]);
    before = float_env();
    status = posewise_step(tracker, frame, result);
    after = float_env();
    set_float_env(own);
    used = stack_walk(0);
    if (before != after) {
        fprintf(stderr, "replay: the floating-point environment was changed\n");
        exit(1);
    }
    step_stack = used > step_stack ? used : step_stack;
    return status;
}

int main(int argc, char **argv) {
    uint8_t *aligned = memory + (POSEWISE_ALIGN - (uintptr_t)memory % POSEWISE_ALIGN);
    posewise_frame frame = POSEWISE_FRAME_INIT;
    posewise_result result = POSEWISE_RESULT_INIT;
    posewise_tracker *tracker;
    posewise_status status;
    unsigned width, height;
    size_t model_len, len, init_stack;
    const void *model = posewise_default_model(&model_len);
    long count = 0, tracked = 0, more;
    unsigned landmark_count = 0;
    FILE *video = argc == 3 ? fopen(argv[1], "rb") : NULL;
    char line[128];

    if (video == NULL)
        return fail("usage: replay VIDEO.y4m FRAMES");
    if (fgets(line, sizeof line, video) == NULL ||
        sscanf(line, "YUV4MPEG2 W%u H%u", &width, &height) != 2 ||
        (len = (size_t)width * height) > sizeof pixels)
        return fail("the video is not y4m, or too large");
    stack_walk(1);
    status = posewise_init(&tracker, aligned, POSEWISE_MEMORY_SIZE, model, model_len, NULL);
    init_stack = stack_walk(0);
    if (status != POSEWISE_OK)
        return fail(posewise_strerror(status));
    frame.format = POSEWISE_FMT_GREY;
    frame.width = width;
    frame.height = height;
    frame.stride = width;
    frame.data_len = len;
    frame.data = pixels;
    while (count < strtol(argv[2], NULL, 10) && fgets(line, sizeof line, video) != NULL) {
        if (fread(pixels, 1, len, video) != len)
            return fail("the video is truncated");
        frame.timestamp_us = count * INT64_C(50000);
        status = step(tracker, &frame, &result);
        if (status == POSEWISE_OK)
            status = posewise_landmarks(tracker, landmarks, POSEWISE_LANDMARKS);
        if (status == POSEWISE_OK)
            status = posewise_animation(tracker, animation, POSEWISE_ANIMATIONS);
        if (status != POSEWISE_OK)
            return fail(posewise_strerror(status));
        hash_bytes(&result, sizeof result);
        hash_bytes(landmarks, sizeof landmarks);
        hash_bytes(animation, sizeof animation);
        tracked += result.state == POSEWISE_TRACKING;
        if (result.landmark_count > landmark_count)
            landmark_count = result.landmark_count;
        count++;
    }
    /* The face goes and comes back, so that the stack of a loss is measured, too. */
    memcpy(last, pixels, len);
    for (more = 0; more < 60 && status == POSEWISE_OK; more++) {
        memcpy(pixels, last, len);
        if (more % 30 < 20)
            memset(pixels, 128, len);
        frame.timestamp_us += INT64_C(50000);
        status = step(tracker, &frame, &result);
    }
    if (status != POSEWISE_OK || result.state != POSEWISE_TRACKING)
        return fail("the face did not come back");
    fprintf(stderr, "model: %lu bytes\ntracker: %lu bytes\nlandmarks: %u\n",
            (unsigned long)model_len, (unsigned long)posewise_memory_size(NULL), landmark_count);
    fprintf(stderr, "stack of posewise_init: %lu bytes\nstack of posewise_step: %lu bytes\n",
            (unsigned long)init_stack, (unsigned long)step_stack);
    /* In halves, because the smallest C libraries do not print 64 bits. */
    printf("%08lx%08lx %ld frames, %ld tracked\n", (unsigned long)(hash >> 32),
           (unsigned long)(hash & 0xFFFFFFFFu), count, tracked);
    return 0;
}
