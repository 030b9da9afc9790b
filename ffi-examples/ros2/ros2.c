/* ros2.c - head pose for ROS 2: subscribes to the topic image_raw (sensor_msgs/msg/Image in mono8,
 * rgb8 or bgr8) and publishes head_pose (geometry_msgs/msg/PoseStamped in the camera's optical
 * frame, metres) for each image with a face.
 *
 *     ROS_DOMAIN_ID=0 ./ros2
 *
 * It uses the wire protocol of ROS 2, DDS, by Cyclone DDS alone, and needs nothing of ROS 2. It is
 * therefore no node: it has topics, but no parameters, and `ros2 node` does not list it. C99. */
#include "posewise.h"

#include "messages.h"
#include <dds/dds.h>

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef sensor_msgs_msg_dds__Image_ Image;
typedef geometry_msgs_msg_dds__PoseStamped_ PoseStamped;

static uint8_t memory[POSEWISE_MEMORY_SIZE + POSEWISE_ALIGN];
static dds_entity_t stopped;

static void stop(int number) {
    (void)number;
    dds_set_guardcondition(stopped, true);
}

static int fail(const char *what) {
    fprintf(stderr, "ros2: %s\n", what);
    return 1;
}

/* The pixel format of an encoding; 0 if it is another. */
static uint32_t format_of(const char *encoding) {
    if (strcmp(encoding, "mono8") == 0)
        return POSEWISE_FMT_GREY;
    if (strcmp(encoding, "rgb8") == 0)
        return POSEWISE_FMT_RGB3;
    return strcmp(encoding, "bgr8") == 0 ? POSEWISE_FMT_BGR3 : 0;
}

static posewise_status step(posewise_tracker *tracker, const Image *image,
                            posewise_result *result) {
    posewise_frame frame = POSEWISE_FRAME_INIT;
    frame.format = format_of(image->encoding);
    frame.width = image->width;
    frame.height = image->height;
    frame.stride = image->step;
    frame.data = image->data._buffer;
    frame.data_len = image->data._length;
    frame.timestamp_us =
        INT64_C(1000000) * image->header.stamp.sec + image->header.stamp.nanosec / 1000;
    return posewise_step(tracker, &frame, result);
}

/* Tracks an image and publishes the pose of its face. */
static void track(posewise_tracker *tracker, const Image *image, dds_entity_t writer) {
    posewise_result result = POSEWISE_RESULT_INIT;
    PoseStamped out;
    posewise_status status = step(tracker, image, &result);
    if (status == POSEWISE_E_TIME) { /* a recording that begins again */
        posewise_reset(tracker);
        status = step(tracker, image, &result);
    }
    if (status != POSEWISE_OK) {
        fail(posewise_strerror(status));
        return;
    }
    if (result.state == POSEWISE_SEARCHING)
        return;
    out.header = image->header;
    out.pose.position.x = (double)result.translation_mm[0] / 1000.0;
    out.pose.position.y = (double)result.translation_mm[1] / 1000.0;
    out.pose.position.z = (double)result.translation_mm[2] / 1000.0;
    out.pose.orientation.x = (double)result.rotation[0];
    out.pose.orientation.y = (double)result.rotation[1];
    out.pose.orientation.z = (double)result.rotation[2];
    out.pose.orientation.w = (double)result.rotation[3];
    if (dds_write(writer, &out) != DDS_RETCODE_OK)
        fail("cannot publish");
}

/* Images and poses until a signal; returns the program's exit status. */
static int follow(posewise_tracker *tracker, dds_entity_t participant) {
    dds_qos_t *qos = dds_create_qos();
    dds_entity_t images, poses, reader, writer, waitset;
    images = dds_create_topic(participant, &sensor_msgs_msg_dds__Image__desc, "rt/image_raw", NULL,
                              NULL);
    poses = dds_create_topic(participant, &geometry_msgs_msg_dds__PoseStamped__desc, "rt/head_pose",
                             NULL, NULL);
    /* The newest image only: a tracker that is late does without the others. */
    dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 1);
    dds_qset_reliability(qos, DDS_RELIABILITY_BEST_EFFORT, 0);
    reader = dds_create_reader(participant, images, qos, NULL);
    dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 10);
    dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_MSECS(100));
    writer = dds_create_writer(participant, poses, qos, NULL);
    dds_delete_qos(qos);
    waitset = dds_create_waitset(participant);
    if (reader < 0 || writer < 0 || waitset < 0)
        return fail("cannot create the topics");
    dds_waitset_attach(waitset, dds_create_readcondition(reader, DDS_ANY_STATE), 0);
    dds_waitset_attach(waitset, stopped, 1);
    for (;;) {
        dds_attach_t woken = 0;
        dds_sample_info_t info;
        void *sample = NULL;
        if (dds_waitset_wait(waitset, &woken, 1, DDS_INFINITY) > 0 && woken == 1)
            return 0;
        if (dds_take(reader, &sample, &info, 1, 1) <= 0)
            continue;
        if (info.valid_data)
            track(tracker, sample, writer);
        dds_return_loan(reader, &sample, 1);
    }
}

int main(void) {
    uint8_t *aligned = memory + (POSEWISE_ALIGN - (uintptr_t)memory % POSEWISE_ALIGN);
    const char *domain = getenv("ROS_DOMAIN_ID");
    size_t model_len;
    const void *model = posewise_default_model(&model_len);
    posewise_tracker *tracker;
    posewise_status status =
        posewise_init(&tracker, aligned, POSEWISE_MEMORY_SIZE, model, model_len, NULL);
    dds_entity_t participant;
    int failed;
    if (status != POSEWISE_OK)
        return fail(posewise_strerror(status));
    participant = dds_create_participant((dds_domainid_t)(domain ? atoi(domain) : 0), NULL, NULL);
    if (participant < 0)
        return fail("no network for DDS");
    stopped = dds_create_guardcondition(participant);
    signal(SIGINT, stop);
    signal(SIGTERM, stop);
    failed = follow(tracker, participant);
    dds_delete(participant);
    return failed;
}
