/* mjpg.h - decodes a frame of motion JPEG to grey. With WITH_JPEG defined, uses libjpeg or
 * libjpeg-turbo; else every frame fails. */
#ifndef MJPG_H
#define MJPG_H
#include <stddef.h>
#include <stdint.h>

#ifdef WITH_JPEG
#include <setjmp.h>
#include <stdio.h>

#include <jpeglib.h> /* needs stdio.h before it */

struct jpeg_errors {
    struct jpeg_error_mgr manager;
    jmp_buf out;
};

static void jpeg_failed(j_common_ptr info) {
    longjmp(((struct jpeg_errors *)info->err)->out, 1);
}

static void jpeg_silent(j_common_ptr info) {
    (void)info;
}

/* Decodes the luma of a JPEG image of this size; 0 if it is corrupt or of another size. */
static int mjpg_decode(const uint8_t *bytes, size_t len, uint8_t *grey, uint32_t width,
                       uint32_t height) {
    struct jpeg_decompress_struct jpeg;
    struct jpeg_errors errors;
    jpeg.err = jpeg_std_error(&errors.manager);
    errors.manager.error_exit = jpeg_failed;
    errors.manager.output_message = jpeg_silent;
    if (setjmp(errors.out) != 0) {
        jpeg_destroy_decompress(&jpeg);
        return 0;
    }
    jpeg_create_decompress(&jpeg);
    jpeg_mem_src(&jpeg, (unsigned char *)(uintptr_t)bytes, (unsigned long)len);
    jpeg_read_header(&jpeg, TRUE);
    jpeg.out_color_space = JCS_GRAYSCALE;
    jpeg.dct_method = JDCT_IFAST;
    jpeg_start_decompress(&jpeg);
    if (jpeg.output_width != width || jpeg.output_height != height)
        longjmp(errors.out, 1);
    while (jpeg.output_scanline < height) {
        JSAMPROW row = grey + (size_t)jpeg.output_scanline * width;
        jpeg_read_scanlines(&jpeg, &row, 1);
    }
    jpeg_finish_decompress(&jpeg);
    jpeg_destroy_decompress(&jpeg);
    return 1;
}
#else
static int mjpg_decode(const uint8_t *bytes, size_t len, uint8_t *grey, uint32_t width,
                       uint32_t height) {
    (void)bytes, (void)len, (void)grey, (void)width, (void)height;
    return 0; /* compiled without MJPG */
}
#endif

#endif
