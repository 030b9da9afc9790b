/* exposure.c - ffi-examples/exposure.h on a simulated camera: the face gets its grey level whatever
 * the light, and stays there. */
#define _DEFAULT_SOURCE
#include "../../ffi-examples/exposure.h"
#include "check.h"

#define WIDTH 64
#define HEIGHT 48

static uint8_t pixels[WIDTH * HEIGHT * 2];

/* A frame of a face of this grey level in the middle, before a background that is four times as
 * bright. */
static posewise_frame show(uint32_t format, double level) {
    posewise_frame f = POSEWISE_FRAME_INIT;
    const uint32_t step = format == POSEWISE_FMT_YUYV ? 2 : 1;
    uint32_t x, y;
    f.format = format;
    f.width = WIDTH;
    f.height = HEIGHT;
    f.stride = WIDTH * step;
    f.data = pixels;
    f.data_len = (size_t)f.stride * HEIGHT;
    memset(pixels, 128, sizeof pixels);
    for (y = 0; y < HEIGHT; y++)
        for (x = 0; x < WIDTH; x++) {
            const int face = x >= 16 && x < 48 && y >= 12 && y < 36;
            const double bright = face ? level : 4 * level;
            pixels[y * f.stride + x * step] = (uint8_t)(bright > 255 ? 255 : bright);
        }
    return f;
}

int main(void) {
    static const double lights[] = {0.02, 0.1, 1, 5, 20};
    static const uint32_t formats[] = {POSEWISE_FMT_GREY, POSEWISE_FMT_YUYV};
    const float box[4] = {16, 12, 32, 24}, outside[4] = {-500, 900, 10, 10};
    const float wide[4] = {-9, -9, 500, 500};
    exposure none;
    size_t i;
    for (i = 0; i < 10; i++) {
        exposure e = {-1, 1, 5000, 156, 0};
        int32_t before = 0;
        int n;
        for (n = 0; n < 12; n++) {
            const posewise_frame f = show(formats[i % 2], lights[i / 2] * e.now);
            before = e.now;
            e.now = exposure_next(&e, exposure_mean(&f, box));
        }
        CHECK(e.now == before);
        CHECK(lights[i / 2] * e.now > 90 && lights[i / 2] * e.now < 132);
    }
    {
        const exposure e = {-1, 10, 200, 150, 0};
        const posewise_frame f = show(POSEWISE_FMT_GREY, 20);
        CHECK(exposure_next(&e, 10) == 200); /* the longest */
        CHECK(exposure_next(&e, 0) == 200);
        CHECK(exposure_next(&e, 255) == 75);
        CHECK(exposure_next(&e, EXPOSURE_TARGET) == 150);
        CHECK(exposure_mean(&f, outside) == EXPOSURE_TARGET);
        CHECK(exposure_mean(&f, wide) > 20 && exposure_mean(&f, wide) < 80);
    }
    /* What has no control keeps its own exposure. */
    CHECK(!exposure_start(&none, -1) && none.fd < 0);
    {
        const posewise_frame f = show(POSEWISE_FMT_GREY, 20);
        const posewise_result r = POSEWISE_RESULT_INIT;
        exposure_follow(&none, &f, &r);
        CHECK(none.now == 0);
        none.fd = 1000; /* no such file: what cannot be set is not taken for set */
        none.most = 100;
        none.now = 50;
        exposure_follow(&none, &f, &r);
        CHECK(none.now == 50);
    }
    return failures != 0;
}
