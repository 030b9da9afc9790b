/* gstposewise.c - a GStreamer element that tracks the face in the video that passes through it.
 *
 *     gst-launch-1.0 -m v4l2src ! videoconvert ! posewise ! videoconvert ! autovideosink
 *
 * Frames go on unchanged and uncopied. For each of them the element posts a message whose structure
 * is named "posewise": timestamp, stream-time and running-time [ns]; state; confidence; while there
 * is a face, yaw, pitch and roll [degrees], translation of the head in the camera's coordinates
 * [mm], box (x, y, width, height) and landmarks (x and y of all 68) [px].
 *
 * `make -C ffi-examples gst-plugin` makes libgstposewise.so; GST_PLUGIN_PATH names its folder. C99;
 * needs gstreamer-video-1.0. */
#include "posewise.h"

#include <gst/video/gstvideofilter.h>
#include <gst/video/video.h>

/* Plane 0 of each is the luma. */
#define FORMATS "{ GRAY8, NV12, NV21, I420, YV12 }"

GST_DEBUG_CATEGORY_STATIC(posewise_debug);
#define GST_CAT_DEFAULT posewise_debug

typedef struct {
    GstVideoFilter parent;
    gchar *model_path; /* NULL: the built-in model. */
    void *model;       /* What was read from model_path. */
    void *memory;
    posewise_tracker *tracker;
} GstPosewise;

typedef struct {
    GstVideoFilterClass parent;
} GstPosewiseClass;

G_DEFINE_TYPE(GstPosewise, gst_posewise, GST_TYPE_VIDEO_FILTER)

enum { PROP_MODEL = 1 };

static void set_property(GObject *object, guint id, const GValue *value, GParamSpec *spec) {
    GstPosewise *self = (GstPosewise *)object;
    if (id != PROP_MODEL) {
        G_OBJECT_WARN_INVALID_PROPERTY_ID(object, id, spec);
        return;
    }
    GST_OBJECT_LOCK(self);
    g_free(self->model_path);
    self->model_path = g_value_dup_string(value);
    GST_OBJECT_UNLOCK(self);
}

static void get_property(GObject *object, guint id, GValue *value, GParamSpec *spec) {
    GstPosewise *self = (GstPosewise *)object;
    if (id != PROP_MODEL) {
        G_OBJECT_WARN_INVALID_PROPERTY_ID(object, id, spec);
        return;
    }
    GST_OBJECT_LOCK(self);
    g_value_set_string(value, self->model_path);
    GST_OBJECT_UNLOCK(self);
}

static void finalize(GObject *object) {
    g_free(((GstPosewise *)object)->model_path);
    G_OBJECT_CLASS(gst_posewise_parent_class)->finalize(object);
}

/* The model: from model_path into aligned memory, else the built-in one. NULL if it cannot be read;
 * says why. */
static const void *model_of(GstPosewise *self, size_t *len) {
    GError *error = NULL;
    gchar *path, *bytes = NULL;
    GST_OBJECT_LOCK(self);
    path = g_strdup(self->model_path);
    GST_OBJECT_UNLOCK(self);
    if (path == NULL)
        return posewise_default_model(len);
    if (g_file_get_contents(path, &bytes, len, &error)) {
        self->model = g_aligned_alloc(1, *len + 1, POSEWISE_ALIGN);
        memcpy(self->model, bytes, *len);
        g_free(bytes);
    } else {
        GST_ELEMENT_ERROR(self, RESOURCE, OPEN_READ, ("%s", error->message), (NULL));
        g_clear_error(&error);
    }
    g_free(path);
    return self->model;
}

static gboolean stop(GstBaseTransform *base) {
    GstPosewise *self = (GstPosewise *)base;
    g_clear_pointer(&self->model, g_aligned_free);
    g_clear_pointer(&self->memory, g_aligned_free);
    self->tracker = NULL;
    return TRUE;
}

static gboolean start(GstBaseTransform *base) {
    GstPosewise *self = (GstPosewise *)base;
    size_t len = 0;
    const void *model = model_of(self, &len);
    posewise_status status;
    if (model == NULL)
        return FALSE;
    self->memory = g_aligned_alloc(1, POSEWISE_MEMORY_SIZE, POSEWISE_ALIGN);
    status = posewise_init(&self->tracker, self->memory, POSEWISE_MEMORY_SIZE, model, len, NULL);
    if (status == POSEWISE_OK)
        return TRUE;
    GST_ELEMENT_ERROR(self, LIBRARY, INIT, ("%s", posewise_strerror(status)), (NULL));
    stop(base);
    return FALSE;
}

/* Another stream, or another place in it: the face is another, and time may go back. */
static gboolean sink_event(GstBaseTransform *base, GstEvent *event) {
    GstPosewise *self = (GstPosewise *)base;
    GstEventType type = GST_EVENT_TYPE(event);
    if (self->tracker != NULL && (type == GST_EVENT_FLUSH_STOP || type == GST_EVENT_STREAM_START))
        posewise_reset(self->tracker);
    return GST_BASE_TRANSFORM_CLASS(gst_posewise_parent_class)->sink_event(base, event);
}

/* Appends numbers to the structure as one array. */
static void set_array(GstStructure *out, const char *name, const float *numbers, guint count) {
    GValue array = G_VALUE_INIT, number = G_VALUE_INIT;
    guint i;
    g_value_init(&array, GST_TYPE_ARRAY);
    g_value_init(&number, G_TYPE_FLOAT);
    for (i = 0; i < count; i++) {
        g_value_set_float(&number, numbers[i]);
        gst_value_array_append_value(&array, &number);
    }
    g_value_unset(&number);
    gst_structure_take_value(out, name, &array);
}

static void set_face(GstStructure *out, const GstPosewise *self, const posewise_result *r) {
    posewise_landmark landmarks[POSEWISE_LANDMARKS];
    float points[2 * POSEWISE_LANDMARKS];
    guint i;
    gst_structure_set(out, "yaw", G_TYPE_FLOAT, r->yaw_deg, "pitch", G_TYPE_FLOAT, r->pitch_deg,
                      "roll", G_TYPE_FLOAT, r->roll_deg, NULL);
    set_array(out, "translation", r->translation_mm, 3);
    set_array(out, "box", r->face_box, 4);
    if (posewise_landmarks(self->tracker, landmarks, POSEWISE_LANDMARKS) != POSEWISE_OK)
        return;
    for (i = 0; i < POSEWISE_LANDMARKS; i++) {
        points[2 * i] = landmarks[i].x;
        points[2 * i + 1] = landmarks[i].y;
    }
    set_array(out, "landmarks", points, 2 * POSEWISE_LANDMARKS);
}

static void post(GstPosewise *self, GstClockTime pts, const posewise_result *r) {
    static const char *const states[] = {"searching", "tracking", "coasting"};
    const GstSegment *segment = &GST_BASE_TRANSFORM(self)->segment;
    GstStructure *out = gst_structure_new(
        "posewise", "timestamp", G_TYPE_UINT64, pts, "stream-time", G_TYPE_UINT64,
        gst_segment_to_stream_time(segment, GST_FORMAT_TIME, pts), "running-time", G_TYPE_UINT64,
        gst_segment_to_running_time(segment, GST_FORMAT_TIME, pts), "state", G_TYPE_STRING,
        states[r->state % 3], "confidence", G_TYPE_FLOAT, r->confidence, NULL);
    if (r->landmark_count == POSEWISE_LANDMARKS)
        set_face(out, self, r);
    gst_element_post_message(GST_ELEMENT(self), gst_message_new_element(GST_OBJECT(self), out));
}

static GstFlowReturn transform_frame_ip(GstVideoFilter *filter, GstVideoFrame *map) {
    GstPosewise *self = (GstPosewise *)filter;
    GstClockTime pts = GST_BUFFER_PTS(map->buffer);
    posewise_frame frame = POSEWISE_FRAME_INIT;
    posewise_result result = POSEWISE_RESULT_INIT;
    posewise_status status;
    if (!GST_CLOCK_TIME_IS_VALID(pts)) {
        GST_WARNING_OBJECT(self, "a frame without a time is not tracked");
        return GST_FLOW_OK;
    }
    frame.format = POSEWISE_FMT_GREY;
    frame.timestamp_us = (int64_t)(pts / GST_USECOND);
    frame.width = (uint32_t)GST_VIDEO_FRAME_WIDTH(map);
    frame.height = (uint32_t)GST_VIDEO_FRAME_HEIGHT(map);
    frame.stride = (uint32_t)GST_VIDEO_FRAME_PLANE_STRIDE(map, 0);
    frame.data_len = (size_t)frame.stride * (frame.height - 1) + frame.width;
    frame.data = GST_VIDEO_FRAME_PLANE_DATA(map, 0);
    status = posewise_step(self->tracker, &frame, &result);
    if (status == POSEWISE_E_TIME) { /* a new segment that starts before the last frame */
        posewise_reset(self->tracker);
        status = posewise_step(self->tracker, &frame, &result);
    }
    if (status != POSEWISE_OK) {
        GST_ELEMENT_ERROR(self, STREAM, FAILED, ("%s", posewise_strerror(status)), (NULL));
        return GST_FLOW_ERROR;
    }
    post(self, pts, &result);
    return GST_FLOW_OK;
}

static void gst_posewise_init(GstPosewise *self) {
    /* Frames are read, not written. */
    gst_base_transform_set_passthrough(GST_BASE_TRANSFORM(self), TRUE);
}

static void gst_posewise_class_init(GstPosewiseClass *class) {
    GObjectClass *object = G_OBJECT_CLASS(class);
    GstElementClass *element = GST_ELEMENT_CLASS(class);
    GstBaseTransformClass *base = GST_BASE_TRANSFORM_CLASS(class);
    GstCaps *caps = gst_caps_from_string(GST_VIDEO_CAPS_MAKE(FORMATS));
    object->set_property = set_property;
    object->get_property = get_property;
    object->finalize = finalize;
    g_object_class_install_property(
        object, PROP_MODEL,
        g_param_spec_string("model", "Model", "A .posewise file; none: the built-in model", NULL,
                            G_PARAM_READWRITE | GST_PARAM_MUTABLE_READY |
                                G_PARAM_STATIC_STRINGS));
    gst_element_class_add_pad_template(
        element, gst_pad_template_new("src", GST_PAD_SRC, GST_PAD_ALWAYS, caps));
    gst_element_class_add_pad_template(
        element, gst_pad_template_new("sink", GST_PAD_SINK, GST_PAD_ALWAYS, caps));
    gst_caps_unref(caps);
    gst_element_class_set_static_metadata(element, "Face tracker", "Filter/Analyzer/Video",
                                          "Posts head pose and 68 landmarks of a face",
                                          "posewise");
    base->start = start;
    base->stop = stop;
    base->sink_event = sink_event;
    GST_VIDEO_FILTER_CLASS(class)->transform_frame_ip = transform_frame_ip;
}

static gboolean plugin_init(GstPlugin *plugin) {
    GST_DEBUG_CATEGORY_INIT(posewise_debug, "posewise", 0, "face tracker");
    return gst_element_register(plugin, "posewise", GST_RANK_NONE, gst_posewise_get_type());
}

#define PACKAGE "posewise"
GST_PLUGIN_DEFINE(GST_VERSION_MAJOR, GST_VERSION_MINOR, posewise, "Face tracker", plugin_init,
                  "0.1.0", "MIT/X11", "posewise", "Unknown package origin")
