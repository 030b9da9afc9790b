/* driver.c - watches a driver: prints an event per line (blink, microsleep, yawn, long-glance ...),
 * and at the end what the monitor knows.
 *
 *     ffmpeg -v error -i drive.mp4 -pix_fmt yuv420p -f yuv4mpegpipe - | ./driver [PRESET]
 *     ./driver PRESET /dev/video0 [FRAMES]
 *
 * PRESET is the number of a POSEWISE_MONITOR_PRESET_*, 0 if there is none. The second form is for
 * Linux and cameras that have YUYV or GREY; it ends after FRAMES or with Ctrl-C. C99.
 *
 * The pattern: step the tracker, observe it, update the monitor with the capture time of the frame,
 * read its events. Frames without a face are observations too; dropped frames need nothing. */
#define _DEFAULT_SOURCE
#include "posewise.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The memory of tracker and monitor, known when compiling. */
static uint8_t tracker_memory[POSEWISE_MEMORY_SIZE + POSEWISE_ALIGN];
static uint8_t monitor_memory[POSEWISE_MONITOR_SIZE + POSEWISE_ALIGN];

typedef struct {
    posewise_tracker *tracker;
    posewise_monitor *monitor;
    unsigned long frames;
} driver;

static void *aligned(uint8_t *memory) {
    return memory + (POSEWISE_ALIGN - (uintptr_t)memory % POSEWISE_ALIGN);
}

/* Prints the message of an error; returns whether there is none. */
static int is_ok(posewise_status status) {
    if (status < 0)
        fprintf(stderr, "driver: %s\n", posewise_strerror(status));
    return status >= 0;
}

static int start(driver *d, uint32_t preset) {
    posewise_monitor_config config = POSEWISE_MONITOR_CONFIG_INIT;
    size_t model_len;
    const void *model = posewise_default_model(&model_len);
    config.preset = preset;
    d->frames = 0;
    return is_ok(posewise_init(&d->tracker, aligned(tracker_memory), POSEWISE_MEMORY_SIZE, model,
                               model_len, NULL)) &&
           is_ok(posewise_monitor_init(&d->monitor, aligned(monitor_memory),
                                       POSEWISE_MONITOR_SIZE, &config));
}

static void print_event(const posewise_monitor_event *e) {
    const char *name = posewise_monitor_event_name(e->kind);
    printf("%" PRId64 " %s from %" PRId64 " us for %" PRIu32 " us", e->timestamp_us,
           name != NULL ? name : "unknown", e->start_us, e->duration_us);
    if (e->zone != POSEWISE_MONITOR_ZONE_UNKNOWN)
        printf(" zone %" PRIu32, e->zone);
    if (e->flags & POSEWISE_MONITOR_CUT)
        printf(" cut");
    printf("\n");
}

/* One frame: tracker, monitor, events. */
static int watch(driver *d, const posewise_frame *frame) {
    posewise_result result = POSEWISE_RESULT_INIT;
    posewise_monitor_observation seen = POSEWISE_MONITOR_OBSERVATION_INIT;
    posewise_monitor_event events[POSEWISE_MONITOR_EVENTS];
    size_t count, overwritten, i;
    const posewise_status stepped = posewise_step(d->tracker, frame, &result);
    if (stepped == POSEWISE_E_TIME)
        return 1; /* a repeated timestamp costs a frame */
    if (!is_ok(stepped) || !is_ok(posewise_monitor_observe(d->tracker, &seen)) ||
        !is_ok(posewise_monitor_update(d->monitor, &seen, frame->timestamp_us)) ||
        !is_ok(posewise_monitor_events(d->monitor, events, POSEWISE_MONITOR_EVENTS, &count,
                                       &overwritten)))
        return 0;
    for (i = 0; i < count; i++)
        print_event(&events[i]);
    fflush(stdout);
    d->frames++;
    return 1;
}

static void print_summary(const driver *d) {
    posewise_monitor_state s = POSEWISE_MONITOR_STATE_INIT;
    if (!is_ok(posewise_monitor_read(d->monitor, &s)))
        return;
    printf("%lu frames, %" PRIu32 " blinks, %" PRIu32 " yawns, %" PRIu32 " nods\n", d->frames,
           s.blinks, s.yawns, s.nods);
    printf("P80 over 60 s: %.1f %% of the %.0f %% that are known\n",
           100 * (double)s.perclos_60.p80, 100 * (double)s.perclos_60.known);
}

/* A y4m video of 8-bit luma with 4:2:0 chroma or none, on standard input. */
static int from_video(driver *d) {
    posewise_frame frame = POSEWISE_FRAME_INIT;
    char line[512];
    unsigned width = 0, height = 0, num = 30, den = 1;
    size_t len;
    uint8_t *pixels;
    const char *word;
    if (fgets(line, sizeof line, stdin) == NULL || strncmp(line, "YUV4MPEG2 ", 10) != 0) {
        fprintf(stderr, "driver: standard input is not a y4m video\n");
        return 0;
    }
    if ((word = strstr(line, " W")) == NULL || sscanf(word, " W%u", &width) != 1 ||
        (word = strstr(line, " H")) == NULL || sscanf(word, " H%u", &height) != 1 || width == 0 ||
        height == 0 || width > 16384 || height > 16384) {
        fprintf(stderr, "driver: the video has no size\n");
        return 0;
    }
    if ((word = strstr(line, " F")) != NULL &&
        (sscanf(word, " F%u:%u", &num, &den) != 2 || num == 0 || den == 0))
        num = 30, den = 1;
    len = (size_t)width * height;
    if (strstr(line, " Cmono") == NULL)
        len += 2 * (size_t)((width + 1) / 2) * ((height + 1) / 2);
    pixels = malloc(len);
    if (pixels == NULL)
        return 0;
    frame.format = POSEWISE_FMT_GREY; /* planar: luma comes first, chroma is not passed */
    frame.width = frame.stride = width;
    frame.height = height;
    frame.data_len = (size_t)width * height;
    frame.data = pixels;
    while (fgets(line, sizeof line, stdin) != NULL && fread(pixels, 1, len, stdin) == len) {
        frame.timestamp_us = (int64_t)((double)d->frames * 1e6 * den / num);
        if (!watch(d, &frame))
            return 0;
    }
    free(pixels);
    return d->frames > 0;
}

#ifdef __linux__
#include <errno.h>
#include <fcntl.h>
#include <linux/videodev2.h>
#include <poll.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#define BUFFERS 4

static volatile sig_atomic_t stopped;

static void stop(int signal) {
    (void)signal;
    stopped = 1;
}

/* Sets YUYV or GREY, near 640x480; v4l2.c has more formats. */
static int negotiate(int fd, posewise_frame *frame) {
    static const uint32_t formats[] = {V4L2_PIX_FMT_GREY, V4L2_PIX_FMT_YUYV};
    size_t i;
    for (i = 0; i < 2; i++) {
        struct v4l2_format f;
        memset(&f, 0, sizeof f);
        f.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
        f.fmt.pix.width = 640;
        f.fmt.pix.height = 480;
        f.fmt.pix.pixelformat = formats[i];
        if (ioctl(fd, VIDIOC_S_FMT, &f) == 0 && f.fmt.pix.pixelformat == formats[i]) {
            frame->format = formats[i]; /* posewise uses the codes of V4L2 */
            frame->width = f.fmt.pix.width;
            frame->height = f.fmt.pix.height;
            frame->stride = f.fmt.pix.bytesperline;
            return 1;
        }
    }
    return 0;
}

static void *buffers[BUFFERS];

/* Maps and queues the buffers, and starts the stream. */
static int start_stream(int fd) {
    struct v4l2_requestbuffers request;
    struct v4l2_buffer b;
    int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    uint32_t i;
    memset(&request, 0, sizeof request);
    request.count = BUFFERS;
    request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    request.memory = V4L2_MEMORY_MMAP;
    if (ioctl(fd, VIDIOC_REQBUFS, &request) < 0)
        return 0;
    for (i = 0; i < request.count && i < BUFFERS; i++) {
        memset(&b, 0, sizeof b);
        b.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
        b.memory = V4L2_MEMORY_MMAP;
        b.index = i;
        if (ioctl(fd, VIDIOC_QUERYBUF, &b) < 0)
            return 0;
        buffers[i] = mmap(NULL, b.length, PROT_READ, MAP_SHARED, fd, (off_t)b.m.offset);
        if (buffers[i] == MAP_FAILED || ioctl(fd, VIDIOC_QBUF, &b) < 0)
            return 0;
    }
    return ioctl(fd, VIDIOC_STREAMON, &type) == 0;
}

static int from_camera(driver *d, const char *device, unsigned long frames) {
    posewise_frame frame = POSEWISE_FRAME_INIT;
    struct sigaction on_signal;
    const int fd = open(device, O_RDWR | O_NONBLOCK | O_CLOEXEC);
    memset(&on_signal, 0, sizeof on_signal);
    on_signal.sa_handler = stop; /* without SA_RESTART, poll() returns */
    sigaction(SIGINT, &on_signal, NULL);
    if (fd < 0 || !negotiate(fd, &frame) || !start_stream(fd)) {
        fprintf(stderr, "driver: %s: no camera with YUYV or GREY\n", device);
        return 0;
    }
    while (!stopped && (frames == 0 || d->frames < frames)) {
        struct pollfd ready = {.fd = fd, .events = POLLIN};
        struct v4l2_buffer b;
        memset(&b, 0, sizeof b);
        b.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
        b.memory = V4L2_MEMORY_MMAP;
        if (poll(&ready, 1, 5000) <= 0)
            break;
        if (ioctl(fd, VIDIOC_DQBUF, &b) < 0) {
            if (errno == EAGAIN)
                continue;
            break;
        }
        /* The monitor needs the time of the capture, not that of now. */
        frame.timestamp_us = (int64_t)b.timestamp.tv_sec * 1000000 + b.timestamp.tv_usec;
        frame.data = buffers[b.index % BUFFERS];
        frame.data_len = b.bytesused;
        if ((b.flags & V4L2_BUF_FLAG_ERROR) == 0 && !watch(d, &frame))
            break;
        if (ioctl(fd, VIDIOC_QBUF, &b) < 0)
            break;
    }
    close(fd);
    return d->frames > 0;
}
#endif

int main(int argc, char **argv) {
    driver d;
    int worked;
    if (!start(&d, argc > 1 ? (uint32_t)strtoul(argv[1], NULL, 10)
                            : POSEWISE_MONITOR_PRESET_GENERAL))
        return 1;
#ifdef __linux__
    if (argc > 2)
        worked = from_camera(&d, argv[2], argc > 3 ? strtoul(argv[3], NULL, 10) : 0);
    else
#endif
        worked = from_video(&d);
    print_summary(&d);
    return !worked;
}
