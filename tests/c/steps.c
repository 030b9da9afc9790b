/* steps.c VIDEO.y4m FRAMES [CPU] - tracks the video's first frames and does nothing else, so that
 * the difference of two runs is what the steps between them took. Prints how many frames were
 * tracked. C99; reads 8-bit mono y4m. */
#include "posewise.h"

#include <stdio.h>
#include <stdlib.h>

static uint8_t memory[POSEWISE_MEMORY_SIZE + POSEWISE_ALIGN];
static uint8_t pixels[640 * 480];

static int fail(const char *what) {
    fprintf(stderr, "steps: %s\n", what);
    return 1;
}

int main(int argc, char **argv) {
    uint8_t *aligned = memory + (POSEWISE_ALIGN - (uintptr_t)memory % POSEWISE_ALIGN);
    posewise_frame frame = POSEWISE_FRAME_INIT;
    posewise_result result = POSEWISE_RESULT_INIT;
    posewise_tracker *tracker;
    posewise_status status;
    size_t model_len;
    const void *model = posewise_default_model(&model_len);
    FILE *video = argc >= 3 ? fopen(argv[1], "rb") : NULL;
    const long frames = argc >= 3 ? strtol(argv[2], NULL, 10) : 0;
    long n, tracked = 0;
    unsigned width, height;
    char line[128];

    if (argc > 3 && posewise_set_cpu((uint32_t)strtol(argv[3], NULL, 10)) != POSEWISE_OK)
        return fail("the features of the processor are unknown");
    if (video == NULL || fgets(line, sizeof line, video) == NULL ||
        sscanf(line, "YUV4MPEG2 W%u H%u", &width, &height) != 2)
        return fail("usage: steps VIDEO.y4m FRAMES [CPU]");
    frame.format = POSEWISE_FMT_GREY;
    frame.width = width;
    frame.height = height;
    frame.stride = width;
    frame.data_len = (size_t)width * height;
    frame.data = pixels;
    if (frame.data_len > sizeof pixels)
        return fail("the frames are too large");
    status = posewise_init(&tracker, aligned, POSEWISE_MEMORY_SIZE, model, model_len, NULL);
    for (n = 0; n < frames && status == POSEWISE_OK; n++) {
        if (fgets(line, sizeof line, video) == NULL ||
            fread(pixels, 1, frame.data_len, video) != frame.data_len)
            return fail("the video ends too early");
        frame.timestamp_us = n * INT64_C(33333);
        status = posewise_step(tracker, &frame, &result);
        tracked += result.state == POSEWISE_TRACKING;
    }
    if (status != POSEWISE_OK)
        return fail(posewise_strerror(status));
    printf("%ld\n", tracked);
    fclose(video);
    return 0;
}
