/* control.c DEVICE NAME - sets a V4L2 button or switch control to 1. Linux. */
#define _DEFAULT_SOURCE
#include <fcntl.h>
#include <linux/videodev2.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>

int main(int argc, char **argv) {
    struct v4l2_queryctrl query;
    struct v4l2_control control;
    int fd = argc >= 3 ? open(argv[1], O_RDWR | O_NONBLOCK) : -1;
    memset(&query, 0, sizeof query);
    query.id = V4L2_CTRL_FLAG_NEXT_CTRL;
    while (fd >= 0 && ioctl(fd, VIDIOC_QUERYCTRL, &query) == 0) {
        if (strcmp((const char *)query.name, argv[2]) == 0) {
            control.id = query.id;
            control.value = 1;
            return ioctl(fd, VIDIOC_S_CTRL, &control) == 0 ? 0 : 1;
        }
        query.id |= V4L2_CTRL_FLAG_NEXT_CTRL;
    }
    fprintf(stderr, "control: no control '%s'\n", argc >= 3 ? argv[2] : "");
    return 1;
}
