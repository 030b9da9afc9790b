/* exposure.h - exposes a V4L2 camera for the face. A camera's own automatic exposure looks at the
 * whole picture: with an infrared lamp the face is overexposed before a dark background, and with
 * a window behind it underexposed. Needs a camera with V4L2_CID_EXPOSURE_ABSOLUTE, as UVC ones
 * have; others keep their own exposure. Define _DEFAULT_SOURCE before all includes. */
#ifndef EXPOSURE_H
#define EXPOSURE_H
#include "posewise.h"

#include <linux/videodev2.h>
#include <string.h>
#include <sys/ioctl.h>
#include <time.h>

/* Mean grey level of a well exposed face, and the share by which it may be off. */
#define EXPOSURE_TARGET 110.0
#define EXPOSURE_TOLERANCE 0.15
/* A change shows a few frames later. */
#define EXPOSURE_PERIOD 4u

typedef struct {
    int fd; /* < 0: the camera keeps its own exposure */
    int32_t least, most, now; /* exposure time [100 us] */
    unsigned frames;
} exposure;

static int exposure_set(exposure *e, int32_t value) {
    struct v4l2_control c = {V4L2_CID_EXPOSURE_ABSOLUTE, value};
    if (ioctl(e->fd, VIDIOC_S_CTRL, &c) < 0)
        return 0;
    e->now = value;
    return 1;
}

/* Takes over the exposure of an open camera; 0 if it has no such control. */
static int exposure_start(exposure *e, int fd) {
    struct v4l2_control manual = {V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_MANUAL};
    struct v4l2_control current = {V4L2_CID_EXPOSURE_ABSOLUTE, 0};
    struct v4l2_queryctrl range;
    memset(e, 0, sizeof *e);
    memset(&range, 0, sizeof range);
    e->fd = -1;
    range.id = V4L2_CID_EXPOSURE_ABSOLUTE;
    if (ioctl(fd, VIDIOC_QUERYCTRL, &range) < 0 || (range.flags & V4L2_CTRL_FLAG_DISABLED) != 0 ||
        ioctl(fd, VIDIOC_G_CTRL, &current) < 0)
        return 0;
    ioctl(fd, VIDIOC_S_CTRL, &manual); /* some cameras have no other mode */
    e->fd = fd;
    e->least = range.minimum > 1 ? range.minimum : 1;
    e->most = range.maximum;
    e->now = current.value > e->least ? current.value : e->least;
    return 1;
}

/* Mean grey level of an upright frame within a box: x, y, width, height [px]. GREY, NV12 or YUYV:
 * luma is every byte, or every other one. */
static double exposure_mean(const posewise_frame *f, const float box[4]) {
    const size_t step = f->format == POSEWISE_FMT_YUYV ? 2 : 1;
    const long width = (long)f->width, height = (long)f->height;
    long left = (long)box[0], top = (long)box[1], x, y;
    long right = left + (long)box[2], bottom = top + (long)box[3];
    unsigned long sum = 0, count = 0;
    left = left > 0 ? left : 0, top = top > 0 ? top : 0;
    right = right < width ? right : width, bottom = bottom < height ? bottom : height;
    for (y = top; y < bottom; y += 4)
        for (x = left; x < right; x += 4) {
            sum += f->data[(size_t)y * f->stride + (size_t)x * step];
            count++;
        }
    return count != 0 ? (double)sum / (double)count : EXPOSURE_TARGET;
}

/* The next exposure time where the face has this mean: at most doubled or halved. */
static int32_t exposure_next(const exposure *e, double mean) {
    double factor = EXPOSURE_TARGET / (mean > 1 ? mean : 1), next;
    if (factor > 1 - EXPOSURE_TOLERANCE && factor < 1 + EXPOSURE_TOLERANCE)
        return e->now;
    factor = factor > 2 ? 2 : factor < 0.5 ? 0.5 : factor;
    next = e->now * factor + 0.5;
    return next < e->least ? e->least : next > e->most ? e->most : (int32_t)next;
}

/* After each step: exposes for the face, or for the middle of the picture while there is none. */
static void exposure_follow(exposure *e, const posewise_frame *f, const posewise_result *r) {
    const float w = (float)f->width, h = (float)f->height;
    const float middle[4] = {w / 4, h / 4, w / 2, h / 2};
    const float *box = r->state == POSEWISE_SEARCHING ? middle : r->face_box;
    if (e->fd >= 0 && e->frames++ % EXPOSURE_PERIOD == 0)
        exposure_set(e, exposure_next(e, exposure_mean(f, box)));
}

#endif
