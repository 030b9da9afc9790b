/* search.c MODEL FRAMES WIDTH HEIGHT - searching for faces: posewise_detect, posewise_step_at,
 * regions of interest, excluded boxes, lenses, events. All memory has exactly the stated length,
 * and that of trackers and outputs was never written: sanitizers and valgrind detect what goes
 * beyond it, and what depends on it. Prints each check that fails. C99. */
#define _POSIX_C_SOURCE 200112L /* posix_memalign */
#include "exact.h"
#include "guarded.h"

#include <math.h>

#define MOST 16 /* faces of one call of posewise_detect */

static guarded model;
static clip frames;

/* A tracker with these settings, in memory that was never written; it is free()d. */
static posewise_tracker *tracker_new(const posewise_config *config) {
    const size_t need = posewise_memory_size(config);
    posewise_tracker *t = NULL;
    CHECK_STATUS(posewise_init(&t, exact_new(NULL, need), need, model.start, model.len, config),
                 POSEWISE_OK);
    if (t == NULL)
        exit(1);
    return t;
}

/* A frame of the clip in memory of its own, which is free()d. */
static posewise_frame frame_new(size_t index) {
    posewise_frame f = clip_frame(&frames, index);
    f.data = exact_new(f.data, f.data_len);
    return f;
}

static void frame_free(posewise_frame f) {
    free((void *)(uintptr_t)f.data);
}

static int near_face(const float *a, const float *b) {
    const float x = a[0] + a[2] / 2 - b[0] - b[2] / 2, y = a[1] + a[3] / 2 - b[1] - b[3] / 2;
    return x * x + y * y < 0.16f * b[2] * b[2];
}

/* The faces of a whole scan, or the first `most`, with this capacity, into `all`; gives their
 * number. */
static size_t scan(posewise_tracker *t, const posewise_frame *f, size_t capacity,
                   posewise_face *all, size_t most) {
    const size_t room = capacity < MOST ? capacity : MOST;
    size_t *count = exact_new(NULL, sizeof *count), sum = 0, calls, i;
    uint32_t *finished = exact_new(NULL, sizeof *finished);
    *finished = 0;
    for (calls = 0; calls < 1000 && sum < most && !*finished; calls++) {
        posewise_face *out = exact_new(NULL, room * sizeof *out);
        CHECK_STATUS(posewise_detect(t, f, out, capacity, count, finished), POSEWISE_OK);
        CHECK(*count <= room && *finished <= 1);
        for (i = 0; i < *count; i++) {
            const posewise_face face = out[i];
            CHECK(face.confidence >= 0 && face.confidence <= 1);
            CHECK(face.face_box[2] > 0 && face.face_box[3] > 0);
            CHECK(fabsf(face.yaw_deg) <= 90 && fabsf(face.roll_deg) <= 180);
            if (sum < most)
                all[sum++] = face;
        }
        free(out);
    }
    CHECK(*finished == 1 || sum == most);
    free(count), free(finished);
    return sum;
}

/* Every capacity finds the face; excluded, or out of the region of interest, it is not found. */
static void test_detect(void) {
    static const size_t capacities[] = {1, MOST + 1, SIZE_MAX};
    posewise_tracker *t = tracker_new(NULL);
    const posewise_frame f = frame_new(0);
    posewise_face found[64];
    posewise_roi *roi = exact_new(NULL, sizeof *roi);
    float *boxes = exact_new(NULL, sizeof found->face_box);
    size_t i, n, k;
    for (i = 0; i < sizeof capacities / sizeof *capacities; i++) {
        n = scan(t, &f, capacities[i], found, 64);
        CHECK(n > 0);
        for (k = 1; k < n; k++)
            CHECK(near_face(found[k].face_box, found[0].face_box));
    }
    memcpy(boxes, found[0].face_box, sizeof found->face_box);
    CHECK_STATUS(posewise_set_excluded(t, boxes, 1), POSEWISE_OK);
    CHECK(scan(t, &f, MOST, found, 64) == 0);
    CHECK_STATUS(posewise_set_excluded(t, NULL, 0), POSEWISE_OK);
    roi->x = roi->y = 0;
    roi->width = (uint32_t)(boxes[0] + boxes[2] / 4);
    roi->height = f.height;
    CHECK_STATUS(posewise_set_roi(t, roi), POSEWISE_OK);
    CHECK(scan(t, &f, MOST, found, 64) == 0);
    roi->width = f.width;
    CHECK_STATUS(posewise_set_roi(t, roi), POSEWISE_OK);
    CHECK(scan(t, &f, MOST, found, 64) > 0);
    free(roi), free(boxes), free(t);
    frame_free(f);
}

/* Both trackers give the same: what only one of them was called with has changed nothing. */
static void expect_alike(posewise_tracker *a, posewise_tracker *b) {
    posewise_result of_a = POSEWISE_RESULT_INIT, of_b = POSEWISE_RESULT_INIT;
    size_t i;
    for (i = 0; i < 3; i++) {
        const posewise_frame f = clip_frame(&frames, i);
        CHECK_STATUS(posewise_step(a, &f, &of_a), POSEWISE_OK);
        CHECK_STATUS(posewise_step(b, &f, &of_b), POSEWISE_OK);
        CHECK(memcmp(&of_a, &of_b, sizeof of_a) == 0);
    }
}

/* Neither a call without room nor one that fails writes faces, or changes the tracker. */
static void test_detect_refused(void) {
    /* What a good frame is changed by: a factor of its width, then differences. */
    static const struct {
        uint32_t width, stride, rotation_deg, flags, format, struct_size;
        posewise_status status;
    } bad[] = {
        {1, 0, 0, 0, 0, 0, POSEWISE_E_ROI},   {0, 0, 0, 0, 0, 0, POSEWISE_E_FRAME},
        {1, 1, 0, 0, 0, 0, POSEWISE_E_FRAME}, {1, 0, 1, 0, 0, 0, POSEWISE_E_FRAME},
        {1, 0, 0, 2, 0, 0, POSEWISE_E_FLAGS}, {1, 0, 0, 0, 1, 0, POSEWISE_E_FORMAT},
        {1, 0, 0, 0, 0, 1, POSEWISE_E_STRUCT_SIZE},
    };
    posewise_tracker *t = tracker_new(NULL), *undisturbed = tracker_new(NULL);
    const posewise_roi beyond = {1, 0, frames.width, 1};
    posewise_frame f = frame_new(0), good;
    guarded out = guarded_new(MOST * sizeof(posewise_face), 0x33);
    posewise_face *faces = (posewise_face *)(void *)out.start;
    size_t count = 7, i;
    uint32_t finished = 7;
    CHECK_STATUS(posewise_detect(t, &f, faces, 0, &count, &finished), POSEWISE_OK);
    CHECK(count == 0 && finished == 0);
    CHECK_STATUS(posewise_set_roi(t, &beyond), POSEWISE_OK);
    count = 7, finished = 7;
    good = f;
    for (i = 0; i < sizeof bad / sizeof *bad; i++) {
        f = good;
        f.width *= bad[i].width;
        f.stride -= bad[i].stride;
        f.rotation_deg += bad[i].rotation_deg;
        f.flags += bad[i].flags;
        f.format += bad[i].format;
        f.struct_size -= bad[i].struct_size;
        CHECK_STATUS(posewise_detect(t, &f, faces, MOST, &count, &finished), bad[i].status);
    }
    f = good;
    CHECK(count == 7 && finished == 7 && filled(out.start, out.len, 0x33));
    CHECK_STATUS(posewise_set_roi(t, NULL), POSEWISE_OK);
    expect_alike(t, undisturbed);
    guarded_free(out);
    free(t), free(undisturbed);
    frame_free(f);
}

/* A hint with one number out of range is refused and changes nothing. */
static void test_hints_refused(void) {
    static const float bad[] = {NAN, INFINITY, -INFINITY, 1e9f, -1e9f};
    posewise_tracker *t = tracker_new(NULL), *undisturbed = tracker_new(NULL);
    const posewise_frame f = frame_new(0);
    posewise_hint *hint = exact_new(NULL, sizeof *hint);
    guarded out = guarded_new(sizeof(posewise_result), 0x33);
    posewise_result *r = (posewise_result *)(void *)out.start;
    size_t i, k;
    r->struct_size = sizeof *r;
    for (i = 0; i < sizeof bad / sizeof *bad; i++)
        for (k = 0; k < 6; k++) {
            const posewise_hint good = {sizeof good, {100, 80, 90, 90}, 10, -10};
            *hint = good;
            (k < 4 ? &hint->face_box[k] : k == 4 ? &hint->yaw_deg : &hint->roll_deg)[0] = bad[i];
            CHECK_STATUS(posewise_step_at(t, &f, hint, r), POSEWISE_E_HINT);
        }
    CHECK(filled(out.start + 4, out.len - 4, 0x33));
    expect_alike(t, undisturbed);
    guarded_free(out);
    free(hint), free(t), free(undisturbed);
    frame_free(f);
}

/* A face that is expected where it is, is tracked at once; the events say so. */
static void test_step_at(void) {
    posewise_tracker *t = tracker_new(NULL);
    posewise_hint *hint = exact_new(NULL, sizeof *hint);
    posewise_event *event = exact_new(NULL, sizeof *event);
    posewise_result *r = exact_new(NULL, sizeof *r);
    size_t *count = exact_new(NULL, sizeof *count), *lost = exact_new(NULL, sizeof *lost), i;
    posewise_face face;
    posewise_frame f = frame_new(0);
    CHECK(scan(t, &f, 1, &face, 1) == 1);
    hint->struct_size = sizeof *hint;
    memcpy(hint->face_box, face.face_box, sizeof face.face_box);
    hint->yaw_deg = face.yaw_deg;
    hint->roll_deg = face.roll_deg;
    r->struct_size = sizeof *r;
    CHECK_STATUS(posewise_step_at(t, &f, hint, r), POSEWISE_OK);
    CHECK(r->state == POSEWISE_TRACKING && near_face(r->face_box, face.face_box));
    CHECK_STATUS(posewise_events(t, event, 1, count, lost), POSEWISE_OK);
    CHECK(*count == 1 && *lost == 0 && event->kind == POSEWISE_EVENT_ACQUIRED);
    /* Another tracker takes the face. */
    CHECK_STATUS(posewise_set_excluded(t, r->face_box, 1), POSEWISE_OK);
    for (i = 1; i < 4; i++) {
        frame_free(f);
        f = frame_new(i);
        CHECK_STATUS(posewise_step_at(t, &f, hint, r), POSEWISE_OK);
        CHECK(r->state != POSEWISE_TRACKING && r->loss == POSEWISE_LOSS_EXCLUDED);
    }
    free(hint), free(event), free(r), free(count), free(lost), free(t);
    frame_free(f);
}

/* Tracks through each lens, which is changed between two frames. */
static void test_lenses(void) {
    static const posewise_lens lenses[] = {
        {POSEWISE_LENS_BROWN, {-0.12f, 0.012f, 0.001f, -0.0007f, -0.0004f}},
        {POSEWISE_LENS_FISHEYE, {-0.02f, 0.004f, -0.003f, 0.0005f, 0}},
        {POSEWISE_LENS_PINHOLE, {0, 0, 0, 0, 0}},
    };
    posewise_config config = POSEWISE_CONFIG_INIT;
    posewise_lens *lens = exact_new(NULL, sizeof *lens);
    posewise_result *r = exact_new(NULL, sizeof *r);
    posewise_tracker *t;
    size_t i, tracked = 0;
    config.intrinsics.fx = config.intrinsics.fy = 277;
    config.intrinsics.cx = 160, config.intrinsics.cy = 120;
    t = tracker_new(&config);
    r->struct_size = sizeof *r;
    for (i = 0; i < frames.count && i < 24; i++) {
        const posewise_frame f = frame_new(i);
        *lens = lenses[i % 3];
        CHECK_STATUS(posewise_set_lens(t, lens), POSEWISE_OK);
        CHECK_STATUS(posewise_step(t, &f, r), POSEWISE_OK);
        tracked += r->state == POSEWISE_TRACKING;
        frame_free(f);
    }
    CHECK(tracked > i / 4); /* it is found first */
    free(lens), free(r), free(t);
}

int main(int argc, char **argv) {
    if (argc != 5)
        return 2;
    model = guarded_file(argv[1]);
    frames = clip_read(argv[2], argv[3], argv[4]);
    test_detect();
    test_detect_refused();
    test_hints_refused();
    test_step_at();
    test_lenses();
    guarded_free(model);
    guarded_free(frames.bytes);
    return failures != 0;
}
