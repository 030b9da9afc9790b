/* ros2.c FRAMES WIDTH HEIGHT - publishes the frames as images for ffi-examples/ros2, each until its
 * pose comes, and prints the quaternion of each pose. */
#include "messages.h"
#include <dds/dds.h>

#include <stdio.h>
#include <stdlib.h>

typedef sensor_msgs_msg_dds__Image_ Image;
typedef geometry_msgs_msg_dds__PoseStamped_ PoseStamped;

int main(int argc, char **argv) {
    const char *domain = getenv("ROS_DOMAIN_ID");
    dds_entity_t participant =
        dds_create_participant((dds_domainid_t)(domain ? atoi(domain) : 0), NULL, NULL);
    dds_entity_t images, poses, writer, reader;
    dds_qos_t *qos = dds_create_qos();
    Image image = {0};
    FILE *file;
    uint32_t size, i;
    if (argc != 4 || participant < 0)
        return 2;
    file = fopen(argv[1], "rb");
    image.width = (uint32_t)atoi(argv[2]);
    image.height = (uint32_t)atoi(argv[3]);
    size = image.width * image.height;
    images = dds_create_topic(participant, &sensor_msgs_msg_dds__Image__desc, "rt/image_raw", NULL,
                              NULL);
    poses = dds_create_topic(participant, &geometry_msgs_msg_dds__PoseStamped__desc, "rt/head_pose",
                             NULL, NULL);
    dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
    writer = dds_create_writer(participant, images, qos, NULL);
    reader = dds_create_reader(participant, poses, qos, NULL);
    for (i = 0; i < 300; i++) { /* at most 30 s */
        dds_publication_matched_status_t sent;
        dds_subscription_matched_status_t got;
        dds_get_publication_matched_status(writer, &sent);
        dds_get_subscription_matched_status(reader, &got);
        if (sent.current_count > 0 && got.current_count > 0)
            break;
        dds_sleepfor(DDS_MSECS(100));
    }
    image.header.frame_id = (char *)"camera";
    image.encoding = (char *)"mono8";
    image.step = image.width;
    image.data._buffer = malloc(size);
    image.data._length = image.data._maximum = size;
    for (i = 0; fread(image.data._buffer, 1, size, file) == size; i++) {
        void *sample = NULL;
        dds_sample_info_t info;
        int wait;
        static int most = 100; /* While it searches, no pose comes. */
        image.header.stamp.sec = (int32_t)(i / 20);
        image.header.stamp.nanosec = i % 20 * 50000000;
        dds_write(writer, &image);
        for (wait = 0; wait < most; wait++) {
            if (dds_take(reader, &sample, &info, 1, 1) > 0)
                break;
            dds_sleepfor(DDS_MSECS(10));
        }
        if (sample != NULL && info.valid_data) {
            const PoseStamped *p = sample;
            printf("%d.%02u %s %.9g %.9g %.9g %.9g\n", (int)p->header.stamp.sec,
                   p->header.stamp.nanosec / 10000000, p->header.frame_id, p->pose.orientation.x,
                   p->pose.orientation.y, p->pose.orientation.z, p->pose.orientation.w);
            dds_return_loan(reader, &sample, 1);
            most = 1000;
        }
    }
    dds_delete(participant);
    return 0;
}
