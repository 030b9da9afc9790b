/* static_memory.c - a tracker in static memory, without heap, files or an operating system.
 *
 * Needs a library that was built with a model, and of the C library only memcpy, memset, memmove
 * and memcmp. On a board, call process() for each camera frame. */
#include "posewise.h"

/* C99 cannot align a variable: reserve POSEWISE_ALIGN bytes more and round the address up. */
static uint8_t memory[POSEWISE_MEMORY_SIZE + POSEWISE_ALIGN];
static posewise_tracker *tracker;

/* Called once, at power-on. */
static posewise_status start(void) {
    uint8_t *aligned = memory + (POSEWISE_ALIGN - (uintptr_t)memory % POSEWISE_ALIGN);
    size_t model_len;
    const void *model = posewise_default_model(&model_len);
    return posewise_init(&tracker, aligned, POSEWISE_MEMORY_SIZE, model, model_len, NULL);
}

/* Processes one frame of luma. */
static posewise_status process(const uint8_t *luma, uint32_t width, uint32_t height,
                              int64_t timestamp_us, posewise_result *result) {
    posewise_frame frame = POSEWISE_FRAME_INIT;
    frame.format = POSEWISE_FMT_GREY;
    frame.timestamp_us = timestamp_us;
    frame.width = width;
    frame.height = height;
    frame.stride = width;
    frame.data_len = (size_t)width * height;
    frame.data = luma;
    return posewise_step(tracker, &frame, result);
}

/* In place of the camera's loop: ten black frames without a face. */
int main(void) {
    static uint8_t luma[320 * 240];
    static posewise_result result = POSEWISE_RESULT_INIT;
    int64_t i;
    if (start() != POSEWISE_OK)
        return 1;
    for (i = 0; i < 10; i++)
        if (process(luma, 320, 240, i * 33333, &result) != POSEWISE_OK ||
            result.state != POSEWISE_SEARCHING)
            return 2;
    return 0;
}
