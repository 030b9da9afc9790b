/* large.c MODEL FRAMES WIDTH HEIGHT SCALE - tracks a face in enlarged frames. The test counts the
 * instructions of the steps that only track. Fails unless the face is tracked there. */
#include "check.h"

/* A step that only tracks: what callgrind counts. */
posewise_status tracking_step(posewise_tracker *t, const posewise_frame *f, posewise_result *r);
__attribute__((noinline)) posewise_status
tracking_step(posewise_tracker *t, const posewise_frame *f, posewise_result *r) {
    return posewise_step(t, f, r);
}

int main(int argc, char **argv) {
    posewise_result r = POSEWISE_RESULT_INIT;
    posewise_tracker *t;
    guarded model, memory, pixels;
    clip frames;
    uint32_t scale, x, y;
    size_t i;
    if (argc != 6)
        return 2;
    model = guarded_file(argv[1]);
    frames = clip_read(argv[2], argv[3], argv[4]);
    scale = (uint32_t)strtoul(argv[5], NULL, 10);
    memory = guarded_new(POSEWISE_MEMORY_SIZE, 0);
    pixels = guarded_new((size_t)frames.width * scale * frames.height * scale, 0);
    CHECK_STATUS(posewise_init(&t, memory.start, memory.len, model.start, model.len, NULL),
                 POSEWISE_OK);
    for (i = 0; i < 6; i++) {
        posewise_frame f = clip_frame(&frames, i);
        const uint8_t *from = f.data;
        for (y = 0; y < f.height * scale; y++)
            for (x = 0; x < f.width * scale; x++)
                pixels.start[(size_t)y * f.width * scale + x] =
                    from[(size_t)(y / scale) * f.width + x / scale];
        f.width *= scale, f.height *= scale, f.stride = f.width;
        f.data = pixels.start;
        f.data_len = pixels.len;
        CHECK_STATUS(i < 2 ? posewise_step(t, &f, &r) : tracking_step(t, &f, &r), POSEWISE_OK);
        CHECK(i == 0 || r.state == POSEWISE_TRACKING);
    }
    printf("# %.0f px wide\n", (double)r.face_box[2]);
    guarded_free(pixels);
    guarded_free(memory);
    guarded_free(model);
    guarded_free(frames.bytes);
    return failures != 0;
}
