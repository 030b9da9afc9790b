/* v4l2.c - tracks the face in the images of a Linux camera and prints one line per frame.
 *
 *     ./v4l2 [DEVICE [FRAMES [FORMAT [face]]]]   default: /dev/video0, until Ctrl-C, any format
 *
 * FORMAT is GREY, NV12, YUYV or, compiled with -DWITH_JPEG and linked with -ljpeg, MJPG; - is any.
 * FRAMES 0 is until Ctrl-C. With the word face the camera is exposed for the face, as infrared
 * cameras with a lamp need it (exposure.h). C99 and Linux; every UVC camera has YUYV or MJPG.
 * Frames are read in the driver's buffers (mmap). */
#define _DEFAULT_SOURCE
#include "posewise.h"

#include "exposure.h"
#include "mjpg.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/videodev2.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

#define WANTED_WIDTH 640
#define WANTED_HEIGHT 480
#define BUFFERS 4
#define TIMEOUT_MS 5000

/* In order of decoding work. */
static const uint32_t formats[] = {
    V4L2_PIX_FMT_GREY, V4L2_PIX_FMT_NV12, V4L2_PIX_FMT_YUYV,
#ifdef WITH_JPEG
    V4L2_PIX_FMT_MJPEG,
#endif
};

typedef struct {
    int fd;
    struct v4l2_pix_format pix;
    struct {
        void *start;
        size_t len;
    } buffers[BUFFERS];
    uint32_t count;
} camera;

static volatile sig_atomic_t stopped;

static void stop(int signal) {
    (void)signal;
    stopped = 1;
}

/* Prints the system's error message; returns -1. */
static int fail(const char *what) {
    fprintf(stderr, "v4l2: %s: %s\n", what, strerror(errno));
    return -1;
}

/* ioctl() that is repeated after a signal, unless the program is to stop. */
static int control(int fd, unsigned long request, void *argument) {
    int result;
    do
        result = ioctl(fd, request, argument);
    while (result < 0 && errno == EINTR && !stopped);
    return result;
}

/* 0 for any format, 1 for none. */
static uint32_t fourcc_of(const char *word) {
    if (strcmp(word, "-") == 0)
        return 0;
    return strlen(word) == 4 ? v4l2_fourcc(word[0], word[1], word[2], word[3]) : 1;
}

/* Sets the first format that the camera accepts; drivers may set another one instead of failing. */
static int negotiate(camera *c, uint32_t only) {
    size_t i;
    for (i = 0; i < sizeof formats / sizeof *formats; i++) {
        struct v4l2_format f;
        if (only != 0 && only != formats[i])
            continue;
        memset(&f, 0, sizeof f);
        f.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
        f.fmt.pix.width = WANTED_WIDTH;
        f.fmt.pix.height = WANTED_HEIGHT;
        f.fmt.pix.pixelformat = formats[i];
        f.fmt.pix.field = V4L2_FIELD_NONE;
        if (control(c->fd, VIDIOC_S_FMT, &f) < 0) {
            if (errno != EINVAL)
                return fail("cannot set a format");
        } else if (f.fmt.pix.pixelformat == formats[i]) {
            c->pix = f.fmt.pix;
            return 0;
        }
    }
    errno = EINVAL;
    return fail("no format that this program reads");
}

static int queue(const camera *c, uint32_t index) {
    struct v4l2_buffer b;
    memset(&b, 0, sizeof b);
    b.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    b.memory = V4L2_MEMORY_MMAP;
    b.index = index;
    return control(c->fd, VIDIOC_QBUF, &b);
}

static int start(camera *c, const char *device, uint32_t only) {
    struct v4l2_capability can;
    struct v4l2_requestbuffers request;
    int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    uint32_t i;
    c->fd = open(device, O_RDWR | O_NONBLOCK | O_CLOEXEC);
    if (c->fd < 0 || control(c->fd, VIDIOC_QUERYCAP, &can) < 0)
        return fail(device);
    if ((can.device_caps & V4L2_CAP_VIDEO_CAPTURE) == 0 ||
        (can.device_caps & V4L2_CAP_STREAMING) == 0) {
        errno = ENOTSUP;
        return fail(device); /* many cameras have a second device node for metadata */
    }
    if (negotiate(c, only) < 0)
        return -1;
    memset(&request, 0, sizeof request);
    request.count = BUFFERS;
    request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    request.memory = V4L2_MEMORY_MMAP;
    if (control(c->fd, VIDIOC_REQBUFS, &request) < 0)
        return fail("cannot get buffers");
    c->count = request.count < BUFFERS ? request.count : BUFFERS;
    for (i = 0; i < c->count; i++) {
        struct v4l2_buffer b;
        memset(&b, 0, sizeof b);
        b.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
        b.memory = V4L2_MEMORY_MMAP;
        b.index = i;
        if (control(c->fd, VIDIOC_QUERYBUF, &b) < 0)
            return fail("cannot get a buffer");
        c->buffers[i].len = b.length;
        c->buffers[i].start =
            mmap(NULL, b.length, PROT_READ | PROT_WRITE, MAP_SHARED, c->fd, (off_t)b.m.offset);
        if (c->buffers[i].start == MAP_FAILED || queue(c, i) < 0)
            return fail("cannot map a buffer");
    }
    return control(c->fd, VIDIOC_STREAMON, &type) < 0 ? fail("cannot start") : 0;
}

/* Waits for a filled buffer: returns 1; 0 after Ctrl-C; -1 on an error of the camera. */
static int wait_frame(camera *c, struct v4l2_buffer *b) {
    while (!stopped) {
        struct pollfd p = {.fd = c->fd, .events = POLLIN};
        const int ready = poll(&p, 1, TIMEOUT_MS);
        if (ready < 0 && errno != EINTR)
            return fail("cannot wait");
        if (ready == 0) {
            errno = ETIMEDOUT;
            return fail("no frame");
        }
        if (ready <= 0)
            continue;
        memset(b, 0, sizeof *b);
        b->type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
        b->memory = V4L2_MEMORY_MMAP;
        if (control(c->fd, VIDIOC_DQBUF, b) == 0)
            return 1;
        if (errno == ENODEV || (errno != EAGAIN && errno != EINTR && errno != EIO) ||
            (p.revents & (POLLERR | POLLHUP)) != 0)
            return fail("the camera is gone");
    }
    return 0;
}

static void finish(camera *c) {
    int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    uint32_t i;
    if (c->fd < 0)
        return;
    ioctl(c->fd, VIDIOC_STREAMOFF, &type);
    for (i = 0; i < c->count; i++)
        if (c->buffers[i].start != NULL && c->buffers[i].start != MAP_FAILED)
            munmap(c->buffers[i].start, c->buffers[i].len);
    close(c->fd);
}

/* Capture time of the frame [us]: the driver's timestamp, or the current time without one. */
static int64_t capture_time_us(const struct v4l2_buffer *b) {
    struct timespec now;
    if ((b->flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) != V4L2_BUF_FLAG_TIMESTAMP_UNKNOWN)
        return (int64_t)b->timestamp.tv_sec * 1000000 + b->timestamp.tv_usec;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000000 + now.tv_nsec / 1000;
}

static void print_line(unsigned long index, const posewise_frame *f, const posewise_result *r) {
    static const char *const states[] = {"searching", "tracking", "coasting"};
    printf("%lu %lld us %ux%u %s", index, (long long)f->timestamp_us, f->width, f->height,
           states[r->state % 3]);
    if (r->state != POSEWISE_SEARCHING)
        printf(" yaw %.1f pitch %.1f roll %.1f deg at %.0f %.0f %.0f mm, confidence %.2f",
               (double)r->yaw_deg, (double)r->pitch_deg, (double)r->roll_deg,
               (double)r->translation_mm[0], (double)r->translation_mm[1],
               (double)r->translation_mm[2], (double)r->confidence);
    printf("\n");
    fflush(stdout);
}

/* Processes a filled buffer: returns 1 with a result, 0 for an unusable frame, -1 on an error. */
static int process(const camera *c, const struct v4l2_buffer *b, uint8_t *grey,
                   posewise_tracker *tracker, posewise_frame *f, posewise_result *r) {
    const uint8_t *bytes = c->buffers[b->index].start;
    posewise_status status;
    if ((b->flags & V4L2_BUF_FLAG_ERROR) != 0)
        return 0;
    f->timestamp_us = capture_time_us(b);
    f->data = bytes;
    f->data_len = b->bytesused;
    if (c->pix.pixelformat == V4L2_PIX_FMT_MJPEG) {
        if (!mjpg_decode(bytes, b->bytesused, grey, f->width, f->height))
            return 0;
        f->data = grey;
        f->data_len = (size_t)f->stride * f->height;
    }
    status = posewise_step(tracker, f, r);
    if (status == POSEWISE_OK)
        return 1;
    fprintf(stderr, "v4l2: %s\n", posewise_strerror(status));
    /* A short buffer or a repeated timestamp costs a frame; other errors are bugs. */
    return status == POSEWISE_E_FRAME || status == POSEWISE_E_TIME ? 0 : -1;
}

int main(int argc, char **argv) {
    static uint8_t memory[POSEWISE_MEMORY_SIZE + POSEWISE_ALIGN];
    uint8_t *aligned = memory + (POSEWISE_ALIGN - (uintptr_t)memory % POSEWISE_ALIGN);
    const unsigned long frames = argc > 2 ? strtoul(argv[2], NULL, 10) : 0;
    camera c = {.fd = -1};
    struct sigaction on_signal;
    struct v4l2_buffer b;
    exposure for_face = {.fd = -1};
    posewise_frame frame = POSEWISE_FRAME_INIT;
    posewise_result result = POSEWISE_RESULT_INIT;
    posewise_tracker *tracker;
    posewise_status status;
    size_t model_len;
    const void *model = posewise_default_model(&model_len);
    uint8_t *grey = NULL;
    unsigned long index = 0;
    int got = -1;

    status = posewise_init(&tracker, aligned, POSEWISE_MEMORY_SIZE, model, model_len, NULL);
    if (status < 0) {
        fprintf(stderr, "v4l2: %s\n", posewise_strerror(status));
        return 1;
    }
    memset(&on_signal, 0, sizeof on_signal);
    on_signal.sa_handler = stop; /* without SA_RESTART, a blocking call returns */
    sigaction(SIGINT, &on_signal, NULL);
    sigaction(SIGTERM, &on_signal, NULL);

    if (start(&c, argc > 1 ? argv[1] : "/dev/video0", argc > 3 ? fourcc_of(argv[3]) : 0) == 0) {
        /* posewise uses the codes of V4L2; JPEG is decoded to grey. */
        const int jpeg = c.pix.pixelformat == V4L2_PIX_FMT_MJPEG;
        frame.format = jpeg ? POSEWISE_FMT_GREY : c.pix.pixelformat;
        frame.width = c.pix.width;
        frame.height = c.pix.height;
        frame.stride = jpeg ? c.pix.width : c.pix.bytesperline;
        if (jpeg && (grey = malloc((size_t)frame.width * frame.height)) == NULL)
            stopped = 1;
        fprintf(stderr, "v4l2: %.4s %ux%u\n", (const char *)&c.pix.pixelformat, frame.width,
                frame.height);
        if (argc > 4 && !exposure_start(&for_face, c.fd))
            fprintf(stderr, "v4l2: the camera keeps its own exposure\n");
        while ((got = wait_frame(&c, &b)) > 0) {
            const int processed = process(&c, &b, grey, tracker, &frame, &result);
            if (processed > 0) {
                print_line(index++, &frame, &result);
                exposure_follow(&for_face, &frame, &result);
            }
            if (processed < 0 || queue(&c, b.index) < 0) {
                got = processed < 0 ? -1 : fail("the camera is gone");
                break;
            }
            if (frames != 0 && index == frames)
                break;
        }
    }
    finish(&c);
    free(grey);
    fprintf(stderr, "v4l2: %lu frames\n", index);
    return got < 0;
}
