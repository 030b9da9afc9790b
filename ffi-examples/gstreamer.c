/* gstreamer.c - tracks the face in what a GStreamer pipeline delivers; one line per frame.
 *
 *     ./gstreamer v4l2src
 *     ./gstreamer 'filesrc location=face.mp4 ! decodebin'
 *
 * The argument is all that comes before the conversion to grey and the appsink. No frame is
 * dropped: for a camera, add drop=true to the appsink where a step takes longer than a frame. C99;
 * needs gstreamer-app-1.0 and gstreamer-video-1.0. */
#include "posewise.h"

#include <gst/app/gstappsink.h>
#include <gst/gst.h>
#include <gst/video/video.h>

#include <stdio.h>

static uint8_t memory[POSEWISE_MEMORY_SIZE + POSEWISE_ALIGN];

static int fail(const char *what) {
    fprintf(stderr, "gstreamer: %s\n", what);
    return 1;
}

/* The pipeline from its description, and its sink. */
static GstElement *pipeline_new(const char *source, GstElement **sink) {
    GError *error = NULL;
    char *line = g_strdup_printf("%s ! videoconvert ! video/x-raw,format=GRAY8 ! "
                                 "appsink name=sink max-buffers=2 sync=false",
                                 source);
    GstElement *pipeline = gst_parse_launch(line, &error);
    g_free(line);
    if (error != NULL) {
        fail(error->message);
        g_clear_error(&error);
        if (pipeline != NULL)
            gst_object_unref(pipeline);
        return NULL;
    }
    *sink = gst_bin_get_by_name(GST_BIN(pipeline), "sink");
    return pipeline;
}

/* One step with a sample: plane 0 with its stride, where it is. */
static posewise_status step(posewise_tracker *tracker, GstSample *sample, int64_t time_us,
                            posewise_result *result) {
    posewise_frame frame = POSEWISE_FRAME_INIT;
    posewise_status status;
    GstVideoInfo info;
    GstVideoFrame map;
    if (!gst_video_info_from_caps(&info, gst_sample_get_caps(sample)) ||
        !gst_video_frame_map(&map, &info, gst_sample_get_buffer(sample), GST_MAP_READ))
        return POSEWISE_E_FRAME;
    frame.format = POSEWISE_FMT_GREY;
    frame.timestamp_us = time_us;
    frame.width = (uint32_t)GST_VIDEO_FRAME_WIDTH(&map);
    frame.height = (uint32_t)GST_VIDEO_FRAME_HEIGHT(&map);
    frame.stride = (uint32_t)GST_VIDEO_FRAME_PLANE_STRIDE(&map, 0);
    frame.data_len = (size_t)frame.stride * (frame.height - 1) + frame.width;
    frame.data = GST_VIDEO_FRAME_PLANE_DATA(&map, 0);
    status = posewise_step(tracker, &frame, result);
    gst_video_frame_unmap(&map);
    return status;
}

static void print_line(int64_t time_us, const posewise_result *r) {
    static const char *const states[] = {"searching", "tracking", "coasting"};
    printf("%" G_GINT64_FORMAT " us %s", time_us, states[r->state % 3]);
    if (r->state != POSEWISE_SEARCHING)
        printf(" yaw %.1f pitch %.1f roll %.1f deg", (double)r->yaw_deg, (double)r->pitch_deg,
               (double)r->roll_deg);
    printf("\n");
    fflush(stdout);
}

/* Whether the pipeline has failed; says why. */
static int has_failed(GstBus *bus) {
    GstMessage *message = gst_bus_pop_filtered(bus, GST_MESSAGE_ERROR);
    GError *error = NULL;
    if (message == NULL)
        return 0;
    gst_message_parse_error(message, &error, NULL);
    fail(error->message);
    g_clear_error(&error);
    gst_message_unref(message);
    return 1;
}

/* Tracks until the end of the stream; returns the program's exit status. */
static int follow(GstBus *bus, GstAppSink *sink, posewise_tracker *tracker) {
    posewise_result result = POSEWISE_RESULT_INIT;
    int failed = 0;
    while (!failed && !gst_app_sink_is_eos(sink)) {
        GstSample *sample = gst_app_sink_try_pull_sample(sink, 100 * GST_MSECOND);
        GstClockTime pts;
        int64_t time_us;
        posewise_status status;
        if (sample == NULL) {
            failed = has_failed(bus);
            continue;
        }
        pts = GST_BUFFER_PTS(gst_sample_get_buffer(sample));
        time_us = GST_CLOCK_TIME_IS_VALID(pts) ? (int64_t)(pts / 1000) : 0;
        status = step(tracker, sample, time_us, &result);
        gst_sample_unref(sample);
        if (status == POSEWISE_OK)
            print_line(time_us, &result);
        else if (status != POSEWISE_E_TIME) /* a repeated timestamp costs a frame */
            failed = fail(posewise_strerror(status));
    }
    return failed || has_failed(bus);
}

int main(int argc, char **argv) {
    uint8_t *aligned = memory + (POSEWISE_ALIGN - (uintptr_t)memory % POSEWISE_ALIGN);
    size_t model_len;
    const void *model = posewise_default_model(&model_len);
    posewise_tracker *tracker;
    posewise_status status;
    GstElement *pipeline, *sink = NULL;
    GstBus *bus;
    int failed;
    gst_init(&argc, &argv);
    if (argc != 2)
        return fail("usage: gstreamer SOURCE, as 'v4l2src'");
    status = posewise_init(&tracker, aligned, POSEWISE_MEMORY_SIZE, model, model_len, NULL);
    if (status != POSEWISE_OK)
        return fail(posewise_strerror(status));
    pipeline = pipeline_new(argv[1], &sink);
    if (pipeline == NULL)
        return 1;
    bus = gst_element_get_bus(pipeline);
    gst_element_set_state(pipeline, GST_STATE_PLAYING);
    failed = follow(bus, GST_APP_SINK(sink), tracker);
    gst_element_set_state(pipeline, GST_STATE_NULL);
    gst_object_unref(bus);
    gst_object_unref(sink);
    gst_object_unref(pipeline);
    return failed;
}
