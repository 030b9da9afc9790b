/* feed.c DEVICE CLIP.y4m - plays a grey 320x240 clip in a loop on a V4L2 output, until killed. Each
 * pixel is repeated 4x3 times: 1280x720 scaled to 4:3 is the original image. Linux. */
#define _DEFAULT_SOURCE
#include <fcntl.h>
#include <linux/videodev2.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/mman.h>

#define WIDTH 320
#define HEIGHT 240
#define OUT_WIDTH (4 * WIDTH)
#define OUT_HEIGHT (3 * HEIGHT)
#define BUFFERS 4

static int fail(const char *what) {
    perror(what);
    return 1;
}

/* Draws the clip's next frame; after the last one, the first. */
static int draw(FILE *clip, uint8_t *out) {
    static uint8_t in[HEIGHT][WIDTH];
    char line[128];
    size_t x, y;
    if (fgets(line, sizeof line, clip) == NULL) {
        rewind(clip); /* the header of the clip, then that of the frame */
        if (fgets(line, sizeof line, clip) == NULL || fgets(line, sizeof line, clip) == NULL)
            return -1;
    }
    if (fread(in, 1, sizeof in, clip) != sizeof in)
        return -1;
    for (y = 0; y < OUT_HEIGHT; y++)
        for (x = 0; x < OUT_WIDTH; x++)
            out[y * OUT_WIDTH + x] = in[y / 3][x / 4];
    return 0;
}

int main(int argc, char **argv) {
    struct v4l2_format f;
    struct v4l2_requestbuffers request;
    struct v4l2_buffer b;
    uint8_t *starts[BUFFERS];
    int type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
    uint32_t i;
    char head[128];
    FILE *clip = argc == 3 ? fopen(argv[2], "rb") : NULL;
    const int fd = argc == 3 ? open(argv[1], O_RDWR) : -1;
    if (clip == NULL || fd < 0 || fgets(head, sizeof head, clip) == NULL)
        return fail("feed DEVICE CLIP.y4m");
    memset(&f, 0, sizeof f);
    f.type = (uint32_t)type;
    if (ioctl(fd, VIDIOC_G_FMT, &f) < 0)
        return fail("G_FMT");
    f.fmt.pix.width = OUT_WIDTH;
    f.fmt.pix.height = OUT_HEIGHT;
    f.fmt.pix.pixelformat = V4L2_PIX_FMT_GREY;
    f.fmt.pix.bytesperline = 0;
    memset(&request, 0, sizeof request);
    request.count = BUFFERS;
    request.type = (uint32_t)type;
    request.memory = V4L2_MEMORY_MMAP;
    if (ioctl(fd, VIDIOC_S_FMT, &f) < 0 || f.fmt.pix.sizeimage != OUT_WIDTH * OUT_HEIGHT ||
        ioctl(fd, VIDIOC_REQBUFS, &request) < 0)
        return fail("S_FMT, REQBUFS");
    memset(&b, 0, sizeof b);
    b.type = (uint32_t)type;
    b.memory = V4L2_MEMORY_MMAP;
    for (i = 0;; i++) {
        if (i == BUFFERS && ioctl(fd, VIDIOC_STREAMON, &type) < 0)
            return fail("STREAMON");
        b.index = i;
        if (ioctl(fd, i < BUFFERS ? VIDIOC_QUERYBUF : VIDIOC_DQBUF, &b) < 0)
            return fail("QUERYBUF, DQBUF");
        if (i < BUFFERS)
            starts[i] = mmap(NULL, b.length, PROT_READ | PROT_WRITE, MAP_SHARED, fd,
                             (off_t)b.m.offset);
        if (starts[b.index] == MAP_FAILED || draw(clip, starts[b.index]) < 0)
            return fail("mmap, draw");
        b.bytesused = OUT_WIDTH * OUT_HEIGHT;
        b.field = V4L2_FIELD_NONE;
        if (ioctl(fd, VIDIOC_QBUF, &b) < 0)
            return fail("QBUF");
    }
}
