/* faces.c - tracks several faces: a group of trackers, each of which follows a face of its own.
 * Reads grey frames of WIDTH x HEIGHT bytes at 30 per second on standard input and prints one CSV
 * line per frame and face.
 *
 *     ffmpeg -v error -i people.mp4 -pix_fmt gray -f rawvideo - | ./faces WIDTH HEIGHT
 */
#include "posewise.h"

#include <stdio.h>
#include <stdlib.h>

#define FACES 3

static void *allocate(size_t len) {
    /* C99 has no aligned_alloc. This program frees nothing, so it drops the start of the block. */
    char *memory = malloc(len + POSEWISE_ALIGN);
    if (memory == NULL) {
        fprintf(stderr, "faces: out of memory\n");
        exit(1);
    }
    return memory + (POSEWISE_ALIGN - (uintptr_t)memory % POSEWISE_ALIGN);
}

int main(int argc, char **argv) {
    static const posewise_result none = POSEWISE_RESULT_INIT;
    posewise_frame frame = POSEWISE_FRAME_INIT;
    posewise_tracker *trackers[FACES];
    posewise_result results[FACES];
    posewise_group *group;
    size_t model_len, len = posewise_group_memory_size();
    const void *model = posewise_default_model(&model_len);
    posewise_status status = posewise_group_init(&group, allocate(len), len);
    uint8_t *pixels;
    long index;
    int k;
    if (argc != 3) {
        fprintf(stderr, "usage: faces WIDTH HEIGHT < FRAMES\n");
        return 2;
    }
    for (k = 0; k < FACES && status == POSEWISE_OK; k++) {
        len = posewise_memory_size(NULL);
        results[k] = none;
        status = posewise_init(&trackers[k], allocate(len), len, model, model_len, NULL);
    }
    frame.format = POSEWISE_FMT_GREY;
    frame.width = frame.stride = (uint32_t)strtoul(argv[1], NULL, 10);
    frame.height = (uint32_t)strtoul(argv[2], NULL, 10);
    frame.data_len = (size_t)frame.width * frame.height;
    frame.data = pixels = allocate(frame.data_len);
    printf("frame,face_id,state,x,y,width,height,confidence\n");
    for (index = 0; status == POSEWISE_OK; index++) {
        if (fread(pixels, 1, frame.data_len, stdin) != frame.data_len)
            return 0;
        frame.timestamp_us = index * 1000000 / 30;
        status = posewise_group_step(group, trackers, FACES, &frame, results);
        for (k = 0; k < FACES; k++) {
            const posewise_result *r = &results[k];
            if (status == POSEWISE_OK && r->state != POSEWISE_SEARCHING)
                printf("%ld,%d,%u,%.1f,%.1f,%.1f,%.1f,%.3f\n", index, k, (unsigned)r->state,
                       (double)r->face_box[0], (double)r->face_box[1], (double)r->face_box[2],
                       (double)r->face_box[3], (double)r->confidence);
        }
    }
    fprintf(stderr, "faces: %s\n", posewise_strerror(status));
    return 1;
}
