/* static_memory.c - a tracker without heap, files or an operating system: everything is static.
 *
 * Needs a library that was built with a model inside, and of the C library only memcpy, memset,
 * memmove and memcmp. On a board, call follow() for each frame that the camera hands over. */
#include "posewise.h"

/* C99 has no word for alignment: set aside one step more and round up. */
static uint8_t memory[POSEWISE_MEMORY_SIZE + POSEWISE_ALIGN];
static posewise_tracker *tracker;

/* Once, at power-on. */
static posewise_status start(void) {
    uint8_t *aligned = memory + (POSEWISE_ALIGN - (uintptr_t)memory % POSEWISE_ALIGN);
    size_t model_len;
    const void *model = posewise_default_model(&model_len);
    return posewise_init(&tracker, aligned, POSEWISE_MEMORY_SIZE, model, model_len, NULL);
}

/* One frame of luma; the answer stays with the caller. */
static posewise_status follow(const uint8_t *luma, uint32_t width, uint32_t height,
                              int64_t timestamp_us, posewise_result *answer) {
    posewise_frame frame = {.struct_size = sizeof frame};
    frame.format = POSEWISE_FMT_GREY;
    frame.timestamp_us = timestamp_us;
    frame.width = width;
    frame.height = height;
    frame.stride = width;
    frame.data_len = (size_t)width * height;
    frame.data = luma;
    answer->struct_size = sizeof *answer;
    return posewise_step(tracker, &frame, answer);
}

/* A stand-in for the camera's loop: ten dark frames, in which there is nobody. */
int main(void) {
    static uint8_t luma[320 * 240];
    static posewise_result answer;
    int64_t i;
    if (start() != POSEWISE_OK)
        return 1;
    for (i = 0; i < 10; i++)
        if (follow(luma, 320, 240, i * 33333, &answer) != POSEWISE_OK ||
            answer.state != POSEWISE_SEARCHING)
            return 2;
    return 0;
}
