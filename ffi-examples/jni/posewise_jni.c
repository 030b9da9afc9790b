/* posewise_jni.c - native functions of dev/posewise/Tracker.java. Allocates nothing. */
#include "posewise.h"

#include <jni.h>

#define NATIVE(type, name) JNIEXPORT type JNICALL Java_dev_posewise_Tracker_##name

/* The aligned part of the Java object's buffer; NULL if the buffer is not direct or too short. */
static posewise_tracker *tracker_in(JNIEnv *env, jobject memory) {
    uint8_t *start = (*env)->GetDirectBufferAddress(env, memory);
    if (start == NULL || (*env)->GetDirectBufferCapacity(env, memory) <
                             (jlong)(POSEWISE_MEMORY_SIZE + POSEWISE_ALIGN))
        return NULL;
    start += POSEWISE_ALIGN - (uintptr_t)start % POSEWISE_ALIGN;
    return (posewise_tracker *)(void *)start;
}

NATIVE(jint, memorySize)(JNIEnv *env, jclass class) {
    (void)env, (void)class;
    return (jint)(POSEWISE_MEMORY_SIZE + POSEWISE_ALIGN);
}

NATIVE(jint, init)(JNIEnv *env, jclass class, jobject memory) {
    posewise_tracker *tracker;
    size_t model_len;
    const void *model = posewise_default_model(&model_len);
    (void)class;
    return posewise_init(&tracker, tracker_in(env, memory), POSEWISE_MEMORY_SIZE, model, model_len,
                         NULL);
}

NATIVE(jint, step)
(JNIEnv *env, jclass class, jobject memory, jobject luma, jint width, jint height, jint stride,
 jint rotation_deg, jboolean mirrored, jlong timestamp_us, jfloatArray pose,
 jfloatArray landmarks) {
    posewise_tracker *tracker = tracker_in(env, memory);
    posewise_landmark points[POSEWISE_LANDMARKS];
    jfloat xy[2 * POSEWISE_LANDMARKS];
    posewise_result r = POSEWISE_RESULT_INIT;
    posewise_frame f = POSEWISE_FRAME_INIT;
    const jlong len = (*env)->GetDirectBufferCapacity(env, luma);
    posewise_status status;
    unsigned i;
    (void)class;
    f.format = POSEWISE_FMT_GREY;
    f.timestamp_us = timestamp_us;
    /* A negative number becomes one that is too large, which the library rejects. */
    f.width = (uint32_t)width;
    f.height = (uint32_t)height;
    f.stride = (uint32_t)stride;
    f.rotation_deg = (uint32_t)rotation_deg;
    f.flags = mirrored ? POSEWISE_FRAME_MIRRORED : 0;
    f.data = (*env)->GetDirectBufferAddress(env, luma);
    f.data_len = len < 0 ? 0 : (size_t)len;
    status = posewise_step(tracker, &f, &r);
    if (status == POSEWISE_OK)
        status = posewise_landmarks(tracker, points, POSEWISE_LANDMARKS);
    if (status < 0)
        return status;
    for (i = 0; i < POSEWISE_LANDMARKS; i++) {
        xy[2 * i] = points[i].x;
        xy[2 * i + 1] = points[i].y;
    }
    (*env)->SetFloatArrayRegion(env, landmarks, 0, 2 * POSEWISE_LANDMARKS, xy);
    {
        const jfloat all[] = {r.yaw_deg,           r.pitch_deg,         r.roll_deg,
                              r.translation_mm[0], r.translation_mm[1], r.translation_mm[2],
                              r.confidence};
        (*env)->SetFloatArrayRegion(env, pose, 0, sizeof all / sizeof *all, all);
    }
    return (jint)r.state;
}

NATIVE(jint, reset)(JNIEnv *env, jclass class, jobject memory) {
    (void)class;
    return posewise_reset(tracker_in(env, memory));
}

NATIVE(jstring, strerror)(JNIEnv *env, jclass class, jint status) {
    (void)class;
    return (*env)->NewStringUTF(env, posewise_strerror(status));
}
