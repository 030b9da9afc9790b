/* faces.c - tracks several faces: one tracker each, which share the model and do not take each
 * other's face. Reads grey frames of WIDTH x HEIGHT bytes at 30 per second on standard input and
 * prints one CSV line per frame and face.
 *
 *     ffmpeg -v error -i people.mp4 -pix_fmt gray -f rawvideo - | ./faces WIDTH HEIGHT
 *
 * The pattern: trackers that have a face go first. A tracker without one excludes the faces that
 * the others track, so its search finds another one or none. Where two are on the same face, one
 * has slid onto it when its own face was covered: the one whose claim is smaller excludes it. */
#include "posewise.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FACES 3
/* Trackers without a face that lost theirs within this time search. If there is none, and none is
 * coasting, another one does: else it would find the face that one has just lost. */
#define RETURN_US 2000000
/* Share of a claim that one frame replaces: a claim is the mean of about 15 frames. */
#define CLAIM_SHARE 0.065f
/* A face whose tracker has this claim is expected back; a false positive is lost before. */
#define ESTABLISHED 0.3f
/* Two boxes are of one face when their centres are nearer than this share of the longer side. */
#define SAME_FACE 0.4f

typedef struct {
    posewise_tracker *tracker;
    posewise_result result;
    float claim;        /* recent mean of confidence times visible share */
    int64_t tracked_us; /* when it last tracked an established face; -RETURN_US if never */
} face;

static int is_same(const float a[4], const float b[4]) {
    const float x = a[0] + a[2] / 2 - b[0] - b[2] / 2, y = a[1] + a[3] / 2 - b[1] - b[3] / 2;
    const float side = b[2] > b[3] ? b[2] : b[3];
    return sqrtf(x * x + y * y) < SAME_FACE * side;
}

/* Excludes the faces that a tracker must leave to others, then steps. */
static posewise_status step(face *all, int own, const posewise_frame *frame) {
    float boxes[4 * FACES];
    size_t count = 0;
    face *f = &all[own];
    const int has_face = f->result.state == POSEWISE_TRACKING;
    posewise_status status;
    int k;
    for (k = 0; k < FACES; k++) {
        const face *other = &all[k];
        const int is_greater = other->claim > f->claim || (other->claim == f->claim && k < own);
        if (k == own || other->result.state != POSEWISE_TRACKING)
            continue;
        if (has_face && !(is_greater && is_same(f->result.face_box, other->result.face_box)))
            continue;
        memcpy(boxes + 4 * count++, other->result.face_box, sizeof other->result.face_box);
    }
    status = posewise_set_excluded(f->tracker, boxes, count);
    if (status == POSEWISE_OK)
        status = posewise_step(f->tracker, frame, &f->result);
    return status;
}

/* One frame for all trackers. */
static posewise_status step_all(face *all, const posewise_frame *frame) {
    posewise_status status = POSEWISE_OK;
    int k, searching = 0, newest = -1;
    for (k = 0; k < FACES && status == POSEWISE_OK; k++) {
        if (all[k].result.state != POSEWISE_SEARCHING)
            status = step(all, k, frame);
        searching |= all[k].result.state == POSEWISE_COASTING;
    }
    for (k = 0; k < FACES && status == POSEWISE_OK; k++) {
        const int is_back_soon = frame->timestamp_us - all[k].tracked_us < RETURN_US;
        if (all[k].result.timestamp_us == frame->timestamp_us) {
            /* Its step is done; it may have lost its face on this frame. */
            searching |= all[k].result.state == POSEWISE_SEARCHING && is_back_soon;
            continue;
        }
        if (newest < 0 || all[k].tracked_us > all[newest].tracked_us)
            newest = k;
        if (is_back_soon) {
            status = step(all, k, frame);
            searching = 1;
        }
    }
    if (status == POSEWISE_OK && !searching && newest >= 0)
        status = step(all, newest, frame);
    for (k = 0; k < FACES; k++) {
        const posewise_result *r = &all[k].result;
        const float now = r->state == POSEWISE_TRACKING ? r->confidence * r->visible_share : 0;
        all[k].claim += CLAIM_SHARE * (now - all[k].claim);
        if (r->state == POSEWISE_TRACKING && all[k].claim > ESTABLISHED)
            all[k].tracked_us = frame->timestamp_us;
    }
    return status;
}

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
    posewise_status status = POSEWISE_OK;
    face all[FACES];
    size_t model_len, len;
    const void *model = posewise_default_model(&model_len);
    uint8_t *pixels;
    long index;
    int k;
    if (argc != 3) {
        fprintf(stderr, "usage: faces WIDTH HEIGHT < FRAMES\n");
        return 2;
    }
    for (k = 0; k < FACES && status == POSEWISE_OK; k++) {
        len = posewise_memory_size(NULL);
        all[k].result = none;
        all[k].result.timestamp_us = -1;
        all[k].claim = 0;
        all[k].tracked_us = -RETURN_US;
        status = posewise_init(&all[k].tracker, allocate(len), len, model, model_len, NULL);
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
        status = step_all(all, &frame);
        for (k = 0; k < FACES; k++) {
            const posewise_result *r = &all[k].result;
            if (status == POSEWISE_OK && r->state != POSEWISE_SEARCHING)
                printf("%ld,%d,%u,%.1f,%.1f,%.1f,%.1f,%.3f\n", index, k, (unsigned)r->state,
                       (double)r->face_box[0], (double)r->face_box[1], (double)r->face_box[2],
                       (double)r->face_box[3], (double)r->confidence);
        }
    }
    fprintf(stderr, "faces: %s\n", posewise_strerror(status));
    return 1;
}
