/* large.c MODEL FRAMES WIDTH HEIGHT SCALE - finds a face in an enlarged frame and tracks it in the
 * next ones. The test counts the instructions of the steps that only track. Fails unless the face
 * is tracked there. */
#include "guarded.h"

/* A step that only tracks: what callgrind counts. */
posewise_status tracking_step(posewise_tracker *t, const posewise_frame *f, posewise_result *r);
__attribute__((noinline)) posewise_status
tracking_step(posewise_tracker *t, const posewise_frame *f, posewise_result *r) {
    return posewise_step(t, f, r);
}

/* The next frame of the clip, enlarged. */
static posewise_frame enlarged(const clip *frames, size_t i, uint32_t scale, guarded pixels) {
    posewise_frame f = clip_frame(frames, i);
    const uint8_t *from = f.data;
    uint32_t x, y;
    for (y = 0; y < f.height * scale; y++)
        for (x = 0; x < f.width * scale; x++)
            pixels.start[(size_t)y * f.width * scale + x] =
                from[(size_t)(y / scale) * f.width + x / scale];
    f.width *= scale, f.height *= scale, f.stride = f.width;
    f.data = pixels.start;
    f.data_len = pixels.len;
    return f;
}

int main(int argc, char **argv) {
    posewise_result r = POSEWISE_RESULT_INIT;
    posewise_tracker *t;
    guarded model, memory, pixels;
    clip frames;
    uint32_t scale;
    size_t i;
    int64_t time = 0;
    if (argc != 6)
        return 2;
    model = guarded_file(argv[1]);
    frames = clip_read(argv[2], argv[3], argv[4]);
    scale = (uint32_t)strtoul(argv[5], NULL, 10);
    memory = guarded_new(POSEWISE_MEMORY_SIZE, 0);
    pixels = guarded_new((size_t)frames.width * scale * frames.height * scale, 0);
    CHECK_STATUS(posewise_init(&t, memory.start, memory.len, model.start, model.len, NULL),
                 POSEWISE_OK);
    posewise_frame f = enlarged(&frames, 0, scale, pixels);
    for (i = 0; i < 60 && r.state != POSEWISE_TRACKING; i++) {
        f.timestamp_us = time += 33000;
        CHECK_STATUS(posewise_step(t, &f, &r), POSEWISE_OK);
    }
    for (i = 1; i < 6; i++) {
        f = enlarged(&frames, i, scale, pixels);
        f.timestamp_us = time += 33000;
        CHECK_STATUS(tracking_step(t, &f, &r), POSEWISE_OK);
        CHECK(r.state == POSEWISE_TRACKING);
    }
    printf("# %.0f px wide\n", (double)r.face_box[2]);
    guarded_free(pixels);
    guarded_free(memory);
    guarded_free(model);
    guarded_free(frames.bytes);
    return failures != 0;
}
