/* control.c DEVICE NAME - presses a V4L2 device's button, or sets a switch, by its name. Linux. */
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
    for (; fd >= 0 && ioctl(fd, VIDIOC_QUERYCTRL, &query) == 0;
         query.id |= V4L2_CTRL_FLAG_NEXT_CTRL)
        if (strcmp((const char *)query.name, argv[2]) == 0) {
            control.id = query.id;
            control.value = 1;
            return ioctl(fd, VIDIOC_S_CTRL, &control) == 0 ? 0 : 1;
        }
    fprintf(stderr, "control: no button '%s'\n", argc >= 3 ? argv[2] : "");
    return 1;
}
