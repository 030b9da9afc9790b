/* mjpg.c JPEG FRAMES WIDTH HEIGHT - tests the decoder of the camera example. The decoded image is
 * close to the first frame; truncated and corrupt images do not crash. Compiled with sanitizers. */
#include "guarded.h"

#include "../../ffi-examples/mjpg.h"

int main(int argc, char **argv) {
    guarded jpeg, out;
    clip frames;
    posewise_frame first;
    size_t i, far = 0;
    if (argc != 5)
        return 2;
    jpeg = guarded_file(argv[1]);
    frames = clip_read(argv[2], argv[3], argv[4]);
    first = clip_frame(&frames, 0);
    out = guarded_new(first.data_len, 0);
    CHECK(mjpg_decode(jpeg.start, jpeg.len, out.start, first.width, first.height) == 1);
    for (i = 0; i < out.len; i++)
        far += abs(out.start[i] - first.data[i]) > 12;
    CHECK(far < out.len / 100);
    CHECK(mjpg_decode(jpeg.start, jpeg.len, out.start, first.width - 1, first.height) == 0);
    CHECK(mjpg_decode(jpeg.start, 0, out.start, first.width, first.height) == 0);
    for (i = 0; i < jpeg.len; i += jpeg.len / 40 + 1) {
        mjpg_decode(jpeg.start, i, out.start, first.width, first.height);
        jpeg.start[i] ^= 0xFF;
        mjpg_decode(jpeg.start, jpeg.len, out.start, first.width, first.height);
        jpeg.start[i] ^= 0xFF;
    }
    guarded_free(jpeg);
    guarded_free(frames.bytes);
    guarded_free(out);
    return failures != 0;
}
