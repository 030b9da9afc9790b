/* api.c MODEL FRAMES WIDTH HEIGHT - calls every function with all kinds of invalid arguments.
 * Compiled as C99, also with sanitizers. Prints each check that fails, nothing on success.
 * Longer than other files: a list of tests that do not depend on each other. */
#define _POSIX_C_SOURCE 200112L /* posix_memalign */
#include "exact.h"
#include "guarded.h"

#include <limits.h>
#include <math.h>

static guarded model;
static clip frames;

/* All outputs of a step. */
typedef struct {
    posewise_result result;
    posewise_landmark landmarks[POSEWISE_LANDMARKS];
    float animation[(POSEWISE_ANIMATIONS + 1) / 2 * 2]; /* without padding behind it */
} outputs;

/* The smoothed result belongs to the same frame. */
static void smoothed(const posewise_tracker *t, const posewise_result *raw) {
    posewise_result r = POSEWISE_RESULT_INIT;
    posewise_landmark l[POSEWISE_LANDMARKS];
    float w[POSEWISE_ANIMATIONS], square = 0;
    size_t i;
    CHECK_STATUS(posewise_smoothed(t, &r), POSEWISE_OK);
    CHECK_STATUS(posewise_smoothed_landmarks(t, l, POSEWISE_LANDMARKS), POSEWISE_OK);
    CHECK_STATUS(posewise_smoothed_animation(t, w, POSEWISE_ANIMATIONS), POSEWISE_OK);
    CHECK(r.state == raw->state && r.timestamp_us == raw->timestamp_us);
    CHECK(r.age_us == raw->age_us && r.landmark_count == raw->landmark_count);
    for (i = 0; i < 4; i++)
        square += r.rotation[i] * r.rotation[i];
    CHECK(r.state == POSEWISE_SEARCHING ? square == 0 : square > 0.999f && square < 1.001f);
    for (i = 0; i < POSEWISE_ANIMATIONS; i++)
        CHECK(w[i] >= 0 && w[i] <= 1);
}

/* A step whose outputs have guards on both sides. */
static posewise_status step(posewise_tracker *t, const posewise_frame *f, outputs *a) {
    guarded result = guarded_new(sizeof a->result, 0x77);
    guarded landmarks = guarded_new(sizeof a->landmarks, 0x77);
    guarded animation = guarded_new(sizeof a->animation, 0x77);
    posewise_result *r = (posewise_result *)(void *)result.start;
    posewise_status status;
    r->struct_size = sizeof *r;
    status = posewise_step(t, f, r);
    if (status == POSEWISE_OK) {
        CHECK_STATUS(posewise_landmarks(t, (posewise_landmark *)(void *)landmarks.start,
                                        POSEWISE_LANDMARKS),
                     POSEWISE_OK);
        CHECK_STATUS(posewise_animation(t, (float *)(void *)animation.start, POSEWISE_ANIMATIONS),
                     POSEWISE_OK);
        CHECK(r->struct_size == sizeof *r);
        CHECK(r->timestamp_us == f->timestamp_us);
        CHECK(r->state <= POSEWISE_COASTING);
        smoothed(t, r);
    }
    memcpy(&a->result, result.start, sizeof a->result);
    memcpy(a->landmarks, landmarks.start, sizeof a->landmarks);
    memcpy(a->animation, animation.start, sizeof a->animation);
    guarded_free(result);
    guarded_free(landmarks);
    guarded_free(animation);
    return status;
}

static posewise_tracker *init(guarded memory, const posewise_config *config) {
    posewise_tracker *t = NULL;
    CHECK_STATUS(posewise_init(&t, memory.start, memory.len, model.start, model.len, config),
                 POSEWISE_OK);
    CHECK((uint8_t *)t == memory.start);
    return t;
}

static guarded tracker_memory(uint8_t fill) {
    return guarded_new(posewise_memory_size(NULL), fill);
}

static void test_constants(void) {
    posewise_status s, other;
    uint32_t i;
    CHECK(posewise_version() == POSEWISE_VERSION);
    CHECK(posewise_abi() == POSEWISE_ABI);
    CHECK(posewise_set_cpu(0) == POSEWISE_OK);
    CHECK(posewise_set_cpu(POSEWISE_CPU_DOTPROD << 1) == POSEWISE_E_FLAGS);
    CHECK(posewise_set_cpu(UINT32_MAX) == POSEWISE_E_FLAGS);
    CHECK(posewise_memory_align() == POSEWISE_ALIGN);
    CHECK(posewise_memory_size(NULL) > 0);
    CHECK(posewise_memory_size(NULL) <= POSEWISE_MEMORY_SIZE);
    for (s = -32; s <= 0; s++) {
        CHECK(strcmp(posewise_strerror(s), "unknown status") != 0);
        for (other = -32; other < s; other++)
            CHECK(strcmp(posewise_strerror(s), posewise_strerror(other)) != 0);
    }
    CHECK(strcmp(posewise_strerror(1), "unknown status") == 0);
    CHECK(strcmp(posewise_strerror(INT32_MIN), "unknown status") == 0);
    for (i = 0; i < POSEWISE_ANIMATIONS; i++)
        CHECK(posewise_animation_name(i) != NULL && strlen(posewise_animation_name(i)) > 3);
    CHECK(posewise_animation_name(POSEWISE_ANIMATIONS) == NULL);
    CHECK(posewise_animation_name(UINT32_MAX) == NULL);
    CHECK(strcmp(posewise_animation_name(POSEWISE_ANIMATION_JAW_OPEN), "jawOpen") == 0);
    CHECK(strcmp(posewise_eye_look_name(POSEWISE_EYE_LOOK_IN_RIGHT), "eyeLookInRight") == 0);
    CHECK(posewise_eye_look_name(POSEWISE_EYE_LOOKS) == NULL);
    CHECK(strcmp(posewise_state_name(POSEWISE_COASTING), "coasting") == 0);
    CHECK(strcmp(posewise_loss_name(POSEWISE_LOSS_LOW_CONFIDENCE), "low-confidence") == 0);
    CHECK(strcmp(posewise_event_name(POSEWISE_EVENT_FILTER_OFF), "filter-off") == 0);
    CHECK(strcmp(posewise_eye_status_name(POSEWISE_EYE_KNOWN), "known") == 0);
    CHECK(strcmp(posewise_eye_status_name(POSEWISE_EYE_DARK_GLASSES), "dark-glasses") == 0);
    CHECK(posewise_state_name(POSEWISE_COASTING + 1) == NULL);
    CHECK(posewise_loss_name(UINT32_MAX) == NULL);
    CHECK(posewise_event_name(POSEWISE_EVENT_FORGOTTEN + 1) == NULL);
    CHECK(posewise_eye_status_name(POSEWISE_EYE_UNCERTAIN + 1) == NULL);
}

static void test_default_model(void) {
    size_t len = 1;
    const void *built_in = posewise_default_model(&len);
    CHECK((built_in == NULL) == (len == 0));
    CHECK((uintptr_t)built_in % POSEWISE_ALIGN == 0);
    if (built_in != NULL)
        CHECK_STATUS(posewise_model_check(built_in, len), POSEWISE_OK);
    CHECK(posewise_default_model(NULL) == NULL);
    {
        size_t lens[2] = {3, 3};
        CHECK(posewise_default_model((size_t *)(void *)((char *)lens + 1)) == NULL);
        CHECK(lens[0] == 3 && lens[1] == 3);
    }
}

/* posewise_memory_size() and posewise_init() reject the settings. */
static void config_rejected(const posewise_config *config) {
    guarded memory = tracker_memory(0xA5);
    posewise_tracker *t = (posewise_tracker *)(void *)&failures;
    CHECK(posewise_memory_size(config) == 0);
    CHECK_STATUS(posewise_init(&t, memory.start, memory.len, model.start, model.len, config),
                 POSEWISE_E_ARG);
    CHECK(t == (posewise_tracker *)(void *)&failures);
    CHECK(filled(memory.start, memory.len, 0xA5));
    guarded_free(memory);
}

static void test_config(void) {
    static const float wrong_focal[] = {-1.0f, NAN, INFINITY, -INFINITY};
    const posewise_config zero = POSEWISE_CONFIG_INIT;
    posewise_config c = zero, pair[2];
    guarded alone = guarded_new(sizeof c, 0xFF);
    size_t i;
    memcpy(alone.start, &zero, sizeof zero.struct_size);
    CHECK_STATUS(posewise_config_default((posewise_config *)(void *)alone.start), POSEWISE_OK);
    guarded_free(alone);
    memset(pair, 0, sizeof pair);
    CHECK_STATUS(posewise_config_default(NULL), POSEWISE_E_ARG);
    CHECK_STATUS(posewise_config_default((posewise_config *)(void *)((char *)pair + 1)),
                 POSEWISE_E_ARG);
    CHECK_STATUS(posewise_config_default(&c), POSEWISE_OK);
    CHECK(c.struct_size == sizeof c && c.min_face_px > 0 && c.scan_budget > 0);
    CHECK(posewise_memory_size(&c) == posewise_memory_size(NULL));
    /* Exact settings: 0 is 0, and out of range for some. */
    CHECK(c.flags == POSEWISE_EXACT);
    c.smoothing_beta = 0;
    CHECK(posewise_memory_size(&c) == posewise_memory_size(NULL));
    c.min_face_px = 0, config_rejected(&c);
    c = zero, c.flags = POSEWISE_EXACT, config_rejected(&c);
    CHECK(posewise_memory_size(&zero) == posewise_memory_size(NULL));
    c = zero, c.struct_size = sizeof c + 8, config_rejected(&c);
    config_rejected((const posewise_config *)(const void *)((const char *)pair + 2));
    c = zero, c.flags = 1, config_rejected(&c);
    c = zero, c.flags = 4, config_rejected(&c);
    c = zero, c.gaze = POSEWISE_GAZE_NATURAL + 1, config_rejected(&c);
    c = zero, c.min_face_px = 23, config_rejected(&c);
    c = zero, c.min_face_px = 4097, config_rejected(&c);
    c = zero, c.scan_budget = 99, config_rejected(&c);
    c = zero, c.scan_budget = 10000001, config_rejected(&c);
    c = zero, c.smoothing_hz = 0.001f, config_rejected(&c);
    c = zero, c.smoothing_hz = NAN, config_rejected(&c);
    c = zero, c.smoothing_beta = -1, config_rejected(&c);
    c = zero, c.smoothing_beta = INFINITY, config_rejected(&c);
    for (i = 0; i < sizeof wrong_focal / sizeof *wrong_focal; i++) {
        c = zero, c.intrinsics.fx = wrong_focal[i], c.intrinsics.fy = 500, config_rejected(&c);
        c = zero, c.intrinsics.fy = wrong_focal[i], c.intrinsics.fx = 500, config_rejected(&c);
    }
    c = zero, c.intrinsics.fx = 500, config_rejected(&c);
    c = zero, c.intrinsics.fx = c.intrinsics.fy = 500, c.intrinsics.cx = NAN, config_rejected(&c);
    c = zero, c.intrinsics.fx = c.intrinsics.fy = 500, c.intrinsics.cy = INFINITY;
    config_rejected(&c);
    c = zero, c.intrinsics.cx = 320, config_rejected(&c);
    c = zero, c.roi.width = 16, config_rejected(&c);
    c = zero, c.roi.x = 16384, c.roi.width = c.roi.height = 1, config_rejected(&c);
}

/* A region of the settings is that of posewise_set_roi(): a frame must hold it. */
static void test_roi_of_config(void) {
    const posewise_frame f = clip_frame(&frames, 0);
    posewise_config c = POSEWISE_CONFIG_INIT;
    posewise_result r = POSEWISE_RESULT_INIT;
    guarded memory = tracker_memory(0);
    posewise_tracker *t;
    size_t i;
    c.roi.x = 1, c.roi.width = f.width, c.roi.height = f.height;
    CHECK_STATUS(posewise_init(&t, memory.start, memory.len, model.start, model.len, &c),
                 POSEWISE_OK);
    CHECK_STATUS(posewise_step(t, &f, &r), POSEWISE_E_ROI);
    CHECK_STATUS(posewise_set_roi(t, NULL), POSEWISE_OK);
    CHECK_STATUS(posewise_step(t, &f, &r), POSEWISE_OK);
    /* A narrow one at the edge, in which no face is centred. */
    c.roi.x = 0, c.roi.width = 16;
    CHECK_STATUS(posewise_init(&t, memory.start, memory.len, model.start, model.len, &c),
                 POSEWISE_OK);
    for (i = 0; i < 60; i++) {
        const posewise_frame next = clip_frame(&frames, i);
        CHECK_STATUS(posewise_step(t, &next, &r), POSEWISE_OK);
        CHECK(r.state == POSEWISE_SEARCHING);
    }
    guarded_free(memory);
}

static void model_rejected(const void *bytes, size_t len, posewise_status expected) {
    guarded memory = tracker_memory(0xA5);
    posewise_tracker *t = NULL;
    CHECK_STATUS(posewise_model_check(bytes, len), expected);
    CHECK_STATUS(posewise_init(&t, memory.start, memory.len, bytes, len, NULL), expected);
    CHECK(t == NULL);
    CHECK(filled(memory.start, memory.len, 0xA5));
    guarded_free(memory);
}

static void test_model(void) {
    const size_t stride = model.len / 97 + 1;
    guarded copy = guarded_new(model.len + 1, 0);
    size_t i;
    memcpy(copy.start, model.start, model.len);
    CHECK_STATUS(posewise_model_check(model.start, model.len), POSEWISE_OK);
    /* A longer buffer. */
    CHECK_STATUS(posewise_model_check(copy.start, model.len + 1), POSEWISE_OK);
    model_rejected(NULL, model.len, POSEWISE_E_ARG);
    model_rejected(NULL, 0, POSEWISE_E_ARG);
    model_rejected(model.start, SIZE_MAX, POSEWISE_E_MODEL_TRUNCATED);
    model_rejected(model.start, 0, POSEWISE_E_MODEL_TRUNCATED);
    memmove(copy.start + 1, copy.start, model.len);
    model_rejected(copy.start + 1, model.len, POSEWISE_E_MODEL_ALIGN);
    memcpy(copy.start, model.start, model.len);
    for (i = 0; i < 64; i++)
        model_rejected(model.start, i, POSEWISE_E_MODEL_TRUNCATED);
    for (i = 64; i < model.len; i += stride)
        model_rejected(model.start, i, POSEWISE_E_MODEL_TRUNCATED);
    model_rejected(model.start, model.len - 1, POSEWISE_E_MODEL_TRUNCATED);
    for (i = 0; i < 8; i++) {
        copy.start[i] ^= 0x20;
        model_rejected(copy.start, model.len, POSEWISE_E_MODEL_MAGIC);
        copy.start[i] ^= 0x20;
    }
    for (i = 8; i < 12; i++) {
        copy.start[i] ^= 0x40;
        model_rejected(copy.start, model.len, POSEWISE_E_MODEL_VERSION);
        copy.start[i] ^= 0x40;
    }
    /* Single bits: each is found, wherever it is. */
    for (i = 0; i < model.len; i += i < 256 ? 1 : stride) {
        const uint8_t bit = (uint8_t)(1u << i % 8);
        copy.start[i] ^= bit;
        CHECK(posewise_model_check(copy.start, model.len) < 0);
        copy.start[i] ^= bit;
    }
    CHECK_STATUS(posewise_model_check(copy.start, model.len), POSEWISE_OK);
    guarded_free(copy);
}

static int is_text(const char *text, size_t len, const char *expected) {
    return len == strlen(expected) && memcmp(text, expected, len) == 0;
}

static void test_model_info(void) {
    const posewise_model_details empty = POSEWISE_MODEL_DETAILS_INIT;
    guarded copy = guarded_new(model.len, 0);
    posewise_model_details info = empty, *inside;
    CHECK_STATUS(posewise_model_info(model.start, model.len, &info), POSEWISE_OK);
    CHECK(is_text(info.name, info.name_len, "posewise.posewise"));
    CHECK(info.terms == POSEWISE_TERMS_FREE && info.sheet_len > info.name_len);
    CHECK(info.length == model.len && info.format_version > 0);
    CHECK(memcmp(&info.checksum, model.start + 16, 4) == 0);
    CHECK(info.section_count > 6 && info.sections[0] != 0 && info.sections[31] == 0);
    CHECK(info.sections[info.section_count - 1] == 0x4F464E49); /* INFO */
    CHECK(info.check_len == 0 && info.wrong_section == 0);
    /* Of no model only the fault is known. */
    info = empty;
    memcpy(copy.start, model.start, model.len);
    copy.start[8] = 77;
    CHECK_STATUS(posewise_model_info(copy.start, model.len, &info), POSEWISE_OK);
    CHECK(info.format_version == 77 && info.name_len == 0 && info.section_count == 0);
    CHECK(is_text(info.check, info.check_len, "another format version"));
    CHECK_STATUS(posewise_model_info(model.start, 5, &info), POSEWISE_OK);
    CHECK(is_text(info.check, info.check_len, "truncated") && info.format_version == 0);
    /* Wrong calls. */
    info = empty;
    CHECK_STATUS(posewise_model_info(NULL, model.len, &info), POSEWISE_E_NULL);
    CHECK_STATUS(posewise_model_info(model.start, model.len, NULL), POSEWISE_E_NULL);
    CHECK_STATUS(posewise_model_info(model.start, SIZE_MAX, &info), POSEWISE_E_MODEL_TRUNCATED);
    inside = (posewise_model_details *)(void *)(copy.start + 64);
    inside->struct_size = sizeof *inside;
    CHECK_STATUS(posewise_model_info(copy.start, model.len, inside), POSEWISE_E_OVERLAP);
    info.struct_size--;
    CHECK_STATUS(posewise_model_info(model.start, model.len, &info), POSEWISE_E_STRUCT_SIZE);
    CHECK(info.length == 0 && info.check == NULL);
    CHECK((posewise_parts() & POSEWISE_PART_KEYFRAMES) != 0 && posewise_parts() < 32);
    guarded_free(copy);
}

static void test_init(void) {
    const size_t need = posewise_memory_size(NULL);
    guarded memory = guarded_new(need + 64, 0xA5);
    posewise_tracker *t = NULL;
    size_t i;
    CHECK_STATUS(posewise_init(NULL, memory.start, need, model.start, model.len, NULL),
                 POSEWISE_E_ARG);
    CHECK_STATUS(posewise_init((posewise_tracker **)(void *)((char *)&t + 1), memory.start, need,
                               model.start, model.len, NULL),
                 POSEWISE_E_ARG);
    CHECK_STATUS(posewise_init(&t, NULL, need, model.start, model.len, NULL), POSEWISE_E_ARG);
    for (i = 1; i < 64; i++)
        CHECK_STATUS(posewise_init(&t, memory.start + i, need, model.start, model.len, NULL),
                     POSEWISE_E_MEMORY);
    for (i = 0; i < need; i += need / 50 + 1)
        CHECK_STATUS(posewise_init(&t, memory.start, i, model.start, model.len, NULL),
                     POSEWISE_E_MEMORY);
    CHECK_STATUS(posewise_init(&t, memory.start, need - 1, model.start, model.len, NULL),
                 POSEWISE_E_MEMORY);
    /* The tracker would overwrite its model. */
    CHECK_STATUS(posewise_init(&t, model.start, need, model.start, model.len, NULL),
                 POSEWISE_E_ARG);
    CHECK_STATUS(posewise_init(&t, memory.start, need, memory.start + 64, need - 64, NULL),
                 POSEWISE_E_ARG);
    /* `out` would be a part of the tracker. */
    for (i = 0; i < need; i += i < 4096 ? sizeof t : 64 * sizeof t)
        CHECK_STATUS(posewise_init((posewise_tracker **)(void *)(memory.start + i), memory.start,
                                   need, model.start, model.len, NULL),
                     POSEWISE_E_ARG);
    CHECK(t == NULL);
    CHECK(filled(memory.start, memory.len, 0xA5));
    CHECK_STATUS(posewise_init(&t, memory.start, need, model.start, model.len, NULL), POSEWISE_OK);
    CHECK(filled(memory.start + need, 64, 0xA5));
    guarded_free(memory);
}

/* Each kind of error has its code. */
static void test_codes(void) {
    guarded memory = tracker_memory(0);
    posewise_tracker *t = init(memory, NULL);
    posewise_config c = POSEWISE_CONFIG_INIT;
    posewise_frame f = clip_frame(&frames, 0);
    posewise_result r = POSEWISE_RESULT_INIT, unset;
    posewise_intrinsics narrow = {0.5f, 0.5f, 0, 0};
    posewise_hint hint = POSEWISE_HINT_INIT;
    const posewise_roi empty = {1, 1, 0, 1}, beyond = {4294967295u, 0, 4294967295u, 1};
    const float boxes[8] = {1, 2, 30, 40, 1, 2, -30, -40};
    posewise_face faces[16];
    size_t count = 77, i;
    uint32_t finished = 77;
    const posewise_roi wide = {1, 0, f.width, f.height};
    memset(&unset, 0, sizeof unset);
    CHECK_STATUS(posewise_step(NULL, &f, &r), POSEWISE_E_NULL);
    CHECK_STATUS(posewise_step(t, &f, NULL), POSEWISE_E_NULL);
    CHECK_STATUS(posewise_step(t, &f, (posewise_result *)(void *)((char *)&r + 1)),
                 POSEWISE_E_POINTER_ALIGN);
    CHECK_STATUS(posewise_step(t, &f, &unset), POSEWISE_E_STRUCT_SIZE);
    CHECK_STATUS(posewise_reset((posewise_tracker *)(void *)model.start), POSEWISE_E_TRACKER);
    CHECK_STATUS(posewise_init(&t, model.start, model.len, model.start, model.len, NULL),
                 POSEWISE_E_OVERLAP);
    CHECK_STATUS(posewise_set_intrinsics(t, &narrow), POSEWISE_E_INTRINSICS);
    f.reserved = 1;
    CHECK_STATUS(posewise_step(t, &f, &r), POSEWISE_E_FLAGS);
    f.reserved = 0;
    CHECK_STATUS(posewise_step_at(t, &f, NULL, &r), POSEWISE_E_NULL);
    CHECK_STATUS(posewise_step_at(t, &f, &hint, &r), POSEWISE_E_HINT);
    hint.face_box[2] = hint.face_box[3] = 80;
    CHECK_STATUS(posewise_step_at(t, &f, &hint, &r), POSEWISE_OK);
    hint.struct_size = 4;
    CHECK_STATUS(posewise_step_at(t, &f, &hint, &r), POSEWISE_E_STRUCT_SIZE);
    CHECK_STATUS(posewise_set_roi(t, &empty), POSEWISE_E_ROI);
    CHECK_STATUS(posewise_set_roi(t, &beyond), POSEWISE_E_ROI);
    CHECK_STATUS(posewise_set_roi(t, (posewise_roi *)(void *)((char *)&wide + 1)),
                 POSEWISE_E_POINTER_ALIGN);
    CHECK_STATUS(posewise_set_roi(t, &wide), POSEWISE_OK);
    f.timestamp_us += 1;
    CHECK_STATUS(posewise_step(t, &f, &r), POSEWISE_E_ROI);
    CHECK_STATUS(posewise_set_roi(t, NULL), POSEWISE_OK);
    CHECK_STATUS(posewise_step(t, &f, &r), POSEWISE_OK);
    f.timestamp_us += 1;
    CHECK_STATUS(posewise_set_excluded(t, NULL, 0), POSEWISE_OK);
    CHECK_STATUS(posewise_set_excluded(t, NULL, 1), POSEWISE_E_NULL);
    CHECK_STATUS(posewise_set_excluded(t, boxes, 1), POSEWISE_OK);
    CHECK_STATUS(posewise_set_excluded(t, boxes, 2), POSEWISE_E_EXCLUDED);
    CHECK_STATUS(posewise_set_excluded(t, boxes, POSEWISE_EXCLUDED + 1), POSEWISE_E_EXCLUDED);
    CHECK_STATUS(posewise_set_excluded(t, boxes, SIZE_MAX), POSEWISE_E_EXCLUDED);
    CHECK_STATUS(posewise_set_excluded(t, NULL, 0), POSEWISE_OK);
    CHECK_STATUS(posewise_detect(t, &f, NULL, 1, &count, &finished), POSEWISE_E_NULL);
    CHECK_STATUS(posewise_detect(t, &f, faces, 2, NULL, &finished), POSEWISE_E_NULL);
    CHECK_STATUS(posewise_detect(t, &f, faces, 2, &count, NULL), POSEWISE_E_NULL);
    CHECK_STATUS(posewise_detect(t, NULL, faces, 2, &count, &finished), POSEWISE_E_NULL);
    CHECK_STATUS(posewise_detect(t, &f, (posewise_face *)(void *)memory.start, 1, &count,
                                 &finished),
                 POSEWISE_E_OVERLAP);
    CHECK_STATUS(posewise_detect(t, &f, faces, 2, (size_t *)(void *)memory.start, &finished),
                 POSEWISE_E_OVERLAP);
    CHECK_STATUS(posewise_detect(t, &f, faces, 2, &count, (uint32_t *)(void *)memory.start),
                 POSEWISE_E_OVERLAP);
    CHECK(count == 77 && finished == 77);
    CHECK_STATUS(posewise_detect(t, &f, faces, 0, &count, &finished), POSEWISE_OK);
    CHECK(count == 0 && finished == 0);
    for (i = 0; i < 400 && !count; i++)
        CHECK_STATUS(posewise_detect(t, &f, faces, SIZE_MAX, &count, &finished), POSEWISE_OK);
    CHECK(count == 1 && faces[0].confidence >= 0.8f && faces[0].face_box[2] > 40);
    CHECK_STATUS(posewise_step(t, &f, &r), POSEWISE_OK);
#define CODE(change, code)                                                                     \
    (c.flags = 0, c.min_face_px = 0, c.scan_budget = 0, c.smoothing_hz = 0, change);           \
    CHECK_STATUS(posewise_init(&t, memory.start, memory.len, model.start, model.len, &c), code)
    CODE(c.flags = 1, POSEWISE_E_FLAGS);
    CODE(c.min_face_px = 1, POSEWISE_E_MIN_FACE);
    CODE(c.scan_budget = 1, POSEWISE_E_SCAN_BUDGET);
    CODE(c.smoothing_hz = -1, POSEWISE_E_SMOOTHING);
    CODE(c.network_period = 9, POSEWISE_E_NETWORK_PERIOD);
#undef CODE
    guarded_free(memory);
}

/* Every function with a pointer that is not to a tracker. */
static void no_tracker(posewise_tracker *t) {
    const posewise_frame f = clip_frame(&frames, 0);
    outputs a, before;
    posewise_event event;
    posewise_face face;
    uint8_t record[POSEWISE_IDENTITY_RECORD_SIZE] = {0};
    size_t count = 7, lost = 7;
    uint32_t finished = 7;
    memset(&a, 0x77, sizeof a);
    a.result.struct_size = sizeof a.result;
    before = a;
    CHECK_STATUS(posewise_step(t, &f, &a.result), POSEWISE_E_ARG);
    CHECK_STATUS(posewise_landmarks(t, a.landmarks, POSEWISE_LANDMARKS), POSEWISE_E_ARG);
    CHECK_STATUS(posewise_animation(t, a.animation, POSEWISE_ANIMATIONS), POSEWISE_E_ARG);
    CHECK_STATUS(posewise_smoothed(t, &a.result), POSEWISE_E_ARG);
    CHECK_STATUS(posewise_smoothed_landmarks(t, a.landmarks, POSEWISE_LANDMARKS), POSEWISE_E_ARG);
    CHECK_STATUS(posewise_smoothed_animation(t, a.animation, POSEWISE_ANIMATIONS), POSEWISE_E_ARG);
    CHECK_STATUS(posewise_reset(t), POSEWISE_E_ARG);
    CHECK_STATUS(posewise_forget_identity(t), POSEWISE_E_ARG);
    CHECK_STATUS(posewise_save_identity(t, record, sizeof record), POSEWISE_E_ARG);
    CHECK_STATUS(posewise_restore_identity(t, record, sizeof record), POSEWISE_E_ARG);
    CHECK_STATUS(posewise_compare_identity(t, record, sizeof record, &finished), POSEWISE_E_ARG);
    CHECK_STATUS(posewise_set_intrinsics(t, NULL), POSEWISE_E_ARG);
    CHECK_STATUS(posewise_set_lens(t, NULL), POSEWISE_E_ARG);
    CHECK_STATUS(posewise_set_roi(t, NULL), POSEWISE_E_ARG);
    CHECK_STATUS(posewise_events(t, &event, 1, &count, &lost), POSEWISE_E_ARG);
    CHECK_STATUS(posewise_set_excluded(t, NULL, 0), POSEWISE_E_ARG);
    CHECK_STATUS(posewise_detect(t, &f, &face, 1, &count, &finished), POSEWISE_E_ARG);
    CHECK(count == 7 && lost == 7 && finished == 7);
    CHECK(memcmp(&a, &before, sizeof a) == 0);
}

static void test_wrong_order(void) {
    static const uint8_t fills[] = {0x00, 0xFF, 0xA5};
    guarded memory;
    size_t i;
    for (i = 0; i < sizeof fills; i++) {
        memory = tracker_memory(fills[i]);
        no_tracker((posewise_tracker *)(void *)memory.start);
        CHECK(filled(memory.start, memory.len, fills[i]));
        guarded_free(memory);
    }
    memory = tracker_memory(0);
    init(memory, NULL);
    no_tracker(NULL);
    no_tracker((posewise_tracker *)(void *)(memory.start + 1));
    no_tracker((posewise_tracker *)(void *)(memory.start + 64));
    guarded_free(memory);
}

/* The outputs of a tracker before its first step and after a reset are zero. */
static void expect_empty(posewise_tracker *t) {
    posewise_landmark l[POSEWISE_LANDMARKS];
    float w[POSEWISE_ANIMATIONS];
    memset(l, 0x33, sizeof l);
    memset(w, 0x33, sizeof w);
    CHECK_STATUS(posewise_landmarks(t, l, POSEWISE_LANDMARKS), POSEWISE_OK);
    CHECK_STATUS(posewise_animation(t, w, POSEWISE_ANIMATIONS), POSEWISE_OK);
    CHECK(filled((uint8_t *)l, sizeof l, 0));
    CHECK(filled((uint8_t *)w, sizeof w, 0));
    memset(l, 0x33, sizeof l);
    memset(w, 0x33, sizeof w);
    CHECK_STATUS(posewise_smoothed_landmarks(t, l, POSEWISE_LANDMARKS), POSEWISE_OK);
    CHECK_STATUS(posewise_smoothed_animation(t, w, POSEWISE_ANIMATIONS), POSEWISE_OK);
    CHECK(filled((uint8_t *)l, sizeof l, 0));
    CHECK(filled((uint8_t *)w, sizeof w, 0));
}

/* Calls in unusual order. */
static void test_any_order(void) {
    guarded memory = tracker_memory(0xFF), other = tracker_memory(0x00);
    posewise_tracker *t = init(memory, NULL), *reference = init(other, NULL), *rejected = NULL;
    const posewise_config wrong = {.struct_size = sizeof wrong, .flags = 1};
    posewise_frame f;
    outputs a, b;
    size_t i, round;
    expect_empty(t);
    CHECK_STATUS(posewise_forget_identity(t), POSEWISE_OK);
    CHECK_STATUS(posewise_reset(t), POSEWISE_OK);
    CHECK_STATUS(posewise_reset(t), POSEWISE_OK);
    expect_empty(t);
    for (round = 0; round < 2; round++) {
        for (i = 0; i < frames.count && i < 10; i++) {
            f = clip_frame(&frames, i);
            CHECK_STATUS(step(t, &f, &a), POSEWISE_OK);
            if (round == 0)
                CHECK_STATUS(step(reference, &f, &b), POSEWISE_OK);
            /* An init that fails leaves the tracker in that memory unchanged. */
            CHECK_STATUS(posewise_init(&rejected, memory.start, memory.len, model.start, model.len,
                                       &wrong),
                         POSEWISE_E_ARG);
            CHECK_STATUS(posewise_init(&rejected, memory.start, memory.len, model.start,
                                       model.len - 1, NULL),
                         POSEWISE_E_MODEL_TRUNCATED);
        }
        CHECK(rejected == NULL);
        CHECK(memcmp(&a, &b, sizeof a) == 0);
        /* An init that succeeds creates a new tracker in the same memory. */
        t = init(memory, NULL);
        expect_empty(t);
    }
    guarded_free(memory);
    guarded_free(other);
}

/* All of the caller's memory has exactly the stated length. */
static void test_past_the_end(void) {
    const size_t need = posewise_memory_size(NULL), image = (size_t)frames.width * frames.height;
    static const uint32_t sizes[] = {0, 4, 39, 4097, UINT32_MAX};
    void *own_model = exact_new(model.start, model.len), *memory = exact_new(NULL, need);
    posewise_tracker **out = exact_new(NULL, sizeof *out);
    posewise_config *c = exact_new(NULL, sizeof *c);
    posewise_intrinsics *camera = exact_new(NULL, sizeof *camera);
    posewise_frame *f = exact_new(NULL, sizeof *f);
    posewise_result *r = exact_new(NULL, sizeof *r);
    posewise_landmark *l = exact_new(NULL, POSEWISE_LANDMARKS * sizeof *l);
    float *w = exact_new(NULL, POSEWISE_ANIMATIONS * sizeof *w);
    size_t *len = exact_new(NULL, sizeof *len), i;
    uint32_t *head = exact_new(NULL, sizeof *head);
    posewise_tracker *t;
    posewise_default_model(len);
    c->struct_size = sizeof *c;
    CHECK_STATUS(posewise_config_default(c), POSEWISE_OK);
    CHECK(posewise_memory_size(c) == need);
    CHECK_STATUS(posewise_model_check(own_model, model.len), POSEWISE_OK);
    CHECK_STATUS(posewise_init(out, memory, need, own_model, model.len, c), POSEWISE_OK);
    t = *out;
    camera->fx = camera->fy = 400;
    camera->cx = camera->cy = 100;
    CHECK_STATUS(posewise_set_intrinsics(t, camera), POSEWISE_OK);
    for (i = 0; i < frames.count && i < 10; i++) {
        uint8_t *data;
        *f = clip_frame(&frames, i);
        data = exact_new(f->data, image);
        f->data = data;
        r->struct_size = sizeof *r;
        CHECK_STATUS(posewise_step(t, f, r), POSEWISE_OK);
        free(data);
        CHECK_STATUS(posewise_landmarks(t, l, POSEWISE_LANDMARKS), POSEWISE_OK);
        CHECK_STATUS(posewise_landmarks(t, l + POSEWISE_LANDMARKS - 1, 1), POSEWISE_OK);
        CHECK_STATUS(posewise_animation(t, w, POSEWISE_ANIMATIONS), POSEWISE_OK);
        CHECK_STATUS(posewise_animation(t, w + POSEWISE_ANIMATIONS - 1, 1), POSEWISE_OK);
    }
    /* Of a struct whose size is invalid, only the size is in memory. */
    *f = clip_frame(&frames, frames.count);
    for (i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        *head = sizes[i];
        CHECK_STATUS(posewise_config_default((posewise_config *)(void *)head), POSEWISE_E_ARG);
        CHECK(posewise_memory_size((posewise_config *)(void *)head) == 0);
        CHECK_STATUS(posewise_init(out, memory, need, own_model, model.len,
                                   (posewise_config *)(void *)head),
                     POSEWISE_E_ARG);
        CHECK_STATUS(posewise_step(t, (posewise_frame *)(void *)head, r), POSEWISE_E_ARG);
        CHECK_STATUS(posewise_step(t, f, (posewise_result *)(void *)head), POSEWISE_E_ARG);
        CHECK(*head == sizes[i]);
    }
    for (i = 1; i < model.len; i += i < 256 ? 1 : model.len / 23) {
        void *cut = exact_new(model.start, i);
        CHECK_STATUS(posewise_model_check(cut, i), POSEWISE_E_MODEL_TRUNCATED);
        free(cut);
    }
    free(own_model), free(memory), free(out), free(c), free(camera), free(f), free(r);
    free(l), free(w), free(len), free(head);
}

static void test_step_pointers(void) {
    guarded memory = tracker_memory(0);
    posewise_tracker *t = init(memory, NULL);
    posewise_frame f = clip_frame(&frames, 0);
    posewise_result r = POSEWISE_RESULT_INIT, pair[2];
    memset(pair, 0, sizeof pair);
    CHECK_STATUS(posewise_step(t, NULL, &r), POSEWISE_E_ARG);
    CHECK_STATUS(posewise_step(t, &f, NULL), POSEWISE_E_ARG);
    memcpy(memory.start + 4096, &r.struct_size, sizeof r.struct_size);
    CHECK_STATUS(posewise_step(t, &f, (posewise_result *)(void *)(memory.start + 4096)),
                 POSEWISE_E_ARG);
    CHECK_STATUS(posewise_smoothed(t, (posewise_result *)(void *)(memory.start + 4096)),
                 POSEWISE_E_OVERLAP);
    CHECK_STATUS(posewise_landmarks(t, (posewise_landmark *)(void *)memory.start, 1),
                 POSEWISE_E_OVERLAP);
    CHECK_STATUS(posewise_smoothed_landmarks(t, (posewise_landmark *)(void *)memory.start, 68),
                 POSEWISE_E_OVERLAP);
    CHECK_STATUS(posewise_animation(t, (float *)(void *)memory.start, 1), POSEWISE_E_OVERLAP);
    CHECK_STATUS(posewise_smoothed_animation(t, (float *)(void *)memory.start, 24),
                 POSEWISE_E_OVERLAP);
    t = init(memory, NULL);
    CHECK_STATUS(posewise_step(t, (const posewise_frame *)(const void *)((char *)&f + 1), &r),
                 POSEWISE_E_ARG);
    CHECK_STATUS(posewise_step(t, &f, (posewise_result *)(void *)((char *)pair + 1)),
                 POSEWISE_E_ARG);
    guarded_free(memory);
}

/* A struct whose struct_size was never set: whatever it holds, but for the true size, the call is
 * refused and nothing is written, neither into the struct nor beyond it. */
static void size_refused(posewise_tracker *t, uint32_t size) {
    guarded any = guarded_new(4200, 0xEE);
    posewise_frame f = clip_frame(&frames, 0);
    posewise_result r = POSEWISE_RESULT_INIT;
    void *start = any.start;
    memcpy(start, &size, sizeof size);
    /* The others: those of earlier headers. */
    if (size != sizeof(posewise_config) && size != 40 && size != 64 && size != 68 && size != 84) {
        CHECK_STATUS(posewise_config_default(start), POSEWISE_E_ARG);
        CHECK(posewise_memory_size(start) == 0);
    }
    /* 128 and 304: those of the first headers. */
    if (size != sizeof(posewise_result) && size != 128 && size != 304) {
        CHECK_STATUS(posewise_step(t, &f, start), POSEWISE_E_ARG);
        CHECK_STATUS(posewise_smoothed(t, start), POSEWISE_E_ARG);
    }
    CHECK(memcmp(start, &size, sizeof size) == 0);
    CHECK(filled(any.start + sizeof size, any.len - sizeof size, 0xEE));
    if (size != sizeof f) {
        memset(start, 0, any.len);
        memcpy(start, &f, sizeof f);
        memcpy(start, &size, sizeof size);
        CHECK_STATUS(posewise_step(t, start, &r), POSEWISE_E_ARG);
    }
    guarded_free(any);
}

static void test_struct_sizes(void) {
    guarded memory = tracker_memory(0);
    posewise_tracker *t = init(memory, NULL);
    uint32_t size;
    for (size = 0; size < 300; size++)
        size_refused(t, size);
    for (; size <= 4096; size += 31)
        size_refused(t, size);
    size_refused(t, 4096);
    size_refused(t, 0x55555555);
    size_refused(t, UINT32_MAX);
    guarded_free(memory);
}

/* The initialisers set struct_size and nothing else. */
static void test_initialisers(void) {
    static const posewise_config config = POSEWISE_CONFIG_INIT;
    static const posewise_frame frame = POSEWISE_FRAME_INIT;
    static const posewise_result result = POSEWISE_RESULT_INIT;
    posewise_config c;
    posewise_frame f;
    posewise_result r;
    memset(&c, 0, sizeof c), memset(&f, 0, sizeof f), memset(&r, 0, sizeof r);
    c.struct_size = sizeof c, f.struct_size = sizeof f, r.struct_size = sizeof r;
    CHECK(memcmp(&c, &config, sizeof c) == 0);
    CHECK(memcmp(&f, &frame, sizeof f) == 0);
    CHECK(memcmp(&r, &result, sizeof r) == 0);
}

static void test_outputs(void) {
    guarded memory = tracker_memory(0);
    posewise_tracker *t = init(memory, NULL);
    const posewise_frame f = clip_frame(&frames, 0);
    posewise_landmark l[POSEWISE_LANDMARKS + 4];
    float w[POSEWISE_ANIMATIONS + 4];
    outputs a;
    size_t i;
    CHECK_STATUS(step(t, &f, &a), POSEWISE_OK);
    CHECK_STATUS(posewise_landmarks(t, NULL, 68), POSEWISE_E_ARG);
    CHECK_STATUS(posewise_animation(t, NULL, 24), POSEWISE_E_ARG);
    CHECK_STATUS(posewise_landmarks(t, (posewise_landmark *)(void *)((char *)l + 2), 1),
                 POSEWISE_E_ARG);
    CHECK_STATUS(posewise_animation(t, (float *)(void *)((char *)w + 2), 1), POSEWISE_E_ARG);
    CHECK_STATUS(posewise_smoothed(t, NULL), POSEWISE_E_ARG);
    CHECK_STATUS(posewise_smoothed(t, (posewise_result *)(void *)((char *)&a.result + 1)),
                 POSEWISE_E_ARG);
    CHECK_STATUS(posewise_smoothed_landmarks(t, NULL, 68), POSEWISE_E_ARG);
    CHECK_STATUS(posewise_smoothed_animation(t, NULL, 24), POSEWISE_E_ARG);
    for (i = 0; i <= POSEWISE_LANDMARKS + 4; i++) {
        const size_t n = i < POSEWISE_LANDMARKS ? i : POSEWISE_LANDMARKS;
        memset(l, 0x33, sizeof l);
        CHECK_STATUS(posewise_landmarks(t, l, i), POSEWISE_OK);
        CHECK(memcmp(l, a.landmarks, n * sizeof *l) == 0);
        CHECK(filled((uint8_t *)(l + n), sizeof l - n * sizeof *l, 0x33));
    }
    for (i = 0; i <= POSEWISE_ANIMATIONS + 4; i++) {
        const size_t n = i < POSEWISE_ANIMATIONS ? i : POSEWISE_ANIMATIONS;
        memset(w, 0x33, sizeof w);
        CHECK_STATUS(posewise_animation(t, w, i), POSEWISE_OK);
        CHECK(memcmp(w, a.animation, n * sizeof *w) == 0);
        CHECK(filled((uint8_t *)(w + n), sizeof w - n * sizeof *w, 0x33));
    }
    guarded_free(memory);
}

/* A call for a shape that must fail writes nothing. */
static void shape_refused(const posewise_tracker *t, uint32_t shape, size_t capacity,
                          posewise_status expected) {
    static posewise_mesh_vertex v[POSEWISE_MESH_VERTICES];
    size_t count = 77;
    memset(v, 0x33, sizeof v);
    CHECK_STATUS(posewise_mesh_shape(t, shape, v, capacity, &count), expected);
    CHECK(count == 77 && filled((uint8_t *)v, sizeof v, 0x33));
}

/* Shapes of the head of a tracker, in memory, that has a face. */
static void mesh_shapes(const posewise_tracker *t, guarded memory, size_t vertex_count) {
    static posewise_mesh_vertex neutral[POSEWISE_MESH_VERTICES], v[POSEWISE_MESH_VERTICES];
    posewise_mesh_vertex *inside = (posewise_mesh_vertex *)(void *)memory.start;
    const size_t most = POSEWISE_MESH_VERTICES;
    const uint32_t last = POSEWISE_ANIMATIONS - 1;
    size_t count = 0, i;
    uint32_t shape;
    shape_refused(t, POSEWISE_ANIMATIONS, most, POSEWISE_E_MESH_SHAPE);
    shape_refused(t, POSEWISE_MESH_NEUTRAL - 1, 0, POSEWISE_E_MESH_SHAPE);
    shape_refused(t, POSEWISE_MESH_NEUTRAL, vertex_count - 1, POSEWISE_E_CAPACITY);
    shape_refused(t, last, 0, POSEWISE_E_CAPACITY);
    CHECK_STATUS(posewise_mesh_shape(t, 0, NULL, most, &count), POSEWISE_E_NULL);
    CHECK_STATUS(posewise_mesh_shape(t, 0, v, most, NULL), POSEWISE_E_NULL);
    CHECK_STATUS(posewise_mesh_shape(NULL, 0, v, most, &count), POSEWISE_E_NULL);
    CHECK_STATUS(posewise_mesh_shape(t, 0, inside, most, &count), POSEWISE_E_OVERLAP);
    CHECK_STATUS(posewise_mesh_shape(t, 0, v, most, (size_t *)(void *)v), POSEWISE_E_OVERLAP);
    CHECK(count == 0);
    CHECK_STATUS(posewise_mesh_shape(t, POSEWISE_MESH_NEUTRAL, neutral, SIZE_MAX, &count),
                 POSEWISE_OK);
    CHECK(count == vertex_count);
    for (shape = 0; shape <= last; shape++) {
        float moved = 0;
        memset(v, 0x33, sizeof v);
        CHECK_STATUS(posewise_mesh_shape(t, shape, v, vertex_count, &count), POSEWISE_OK);
        CHECK(count == vertex_count);
        CHECK(filled((uint8_t *)(v + count), sizeof v - count * sizeof *v, 0x33));
        for (i = 0; i < count; i++) {
            moved = fmaxf(moved, fabsf(v[i].y - neutral[i].y) + fabsf(v[i].z - neutral[i].z));
            CHECK(v[i].visibility == 1);
        }
        CHECK(moved > 1 && moved < 100);
    }
}

/* A call for a mesh that must fail writes nothing. */
static void mesh_refused(const posewise_tracker *t, uint32_t space, size_t capacity,
                         posewise_status expected) {
    static posewise_mesh_vertex v[POSEWISE_MESH_VERTICES];
    size_t count = 77;
    memset(v, 0x33, sizeof v);
    CHECK_STATUS(posewise_mesh(t, space, v, capacity, &count), expected);
    CHECK(count == 77 && filled((uint8_t *)v, sizeof v, 0x33));
}

static void test_mesh(void) {
    guarded memory = tracker_memory(0);
    posewise_tracker *t = init(memory, NULL);
    posewise_mesh_topology tables = POSEWISE_MESH_TOPOLOGY_INIT;
    static posewise_mesh_vertex v[POSEWISE_MESH_VERTICES];
    posewise_mesh_vertex *inside = (posewise_mesh_vertex *)(void *)memory.start;
    size_t count = 0, i;
    outputs a;
    uint32_t space;
    CHECK_STATUS(posewise_mesh_tables(t, NULL), POSEWISE_E_NULL);
    tables.struct_size--;
    CHECK_STATUS(posewise_mesh_tables(t, &tables), POSEWISE_E_STRUCT_SIZE);
    CHECK(tables.vertex_count == 0);
    tables.struct_size++;
    CHECK_STATUS(posewise_mesh_tables(t, &tables), POSEWISE_OK);
    CHECK(tables.vertex_count >= 468 && tables.vertex_count <= POSEWISE_MESH_VERTICES);
    for (i = 0; i < 3 * (size_t)tables.triangle_count; i++)
        CHECK(tables.triangles[i] < tables.vertex_count);
    for (i = 0; i < 2 * (size_t)tables.vertex_count; i++)
        CHECK(tables.uvs[i] >= 0 && tables.uvs[i] <= 1);
    for (i = 0; i < POSEWISE_MESH_LINES; i++)
        CHECK(tables.line_starts[i] < tables.line_starts[i + 1]);
    for (i = 0; i < tables.line_starts[POSEWISE_MESH_LINES]; i++)
        CHECK(tables.lines[i] < tables.vertex_count);
    CHECK(tables.line_starts[POSEWISE_MESH_LINE_LANDMARKS + 1] == POSEWISE_LANDMARKS);
    mesh_refused(t, POSEWISE_MESH_SPACE_HEAD, POSEWISE_MESH_VERTICES, POSEWISE_E_NO_FACE);
    shape_refused(t, POSEWISE_MESH_NEUTRAL, POSEWISE_MESH_VERTICES, POSEWISE_E_NO_FACE);
    for (i = 0; i < frames.count; i++) {
        const posewise_frame f = clip_frame(&frames, i);
        CHECK_STATUS(step(t, &f, &a), POSEWISE_OK);
        if (a.result.state == POSEWISE_TRACKING)
            break;
    }
    CHECK(a.result.state == POSEWISE_TRACKING);
    mesh_refused(t, POSEWISE_MESH_SPACE_HEAD + 1, POSEWISE_MESH_VERTICES, POSEWISE_E_MESH_SPACE);
    mesh_refused(t, UINT32_MAX, 0, POSEWISE_E_MESH_SPACE);
    mesh_refused(t, POSEWISE_MESH_SPACE_HEAD, tables.vertex_count - 1, POSEWISE_E_CAPACITY);
    mesh_refused(t, POSEWISE_MESH_SPACE_PICTURE, 0, POSEWISE_E_CAPACITY);
    CHECK_STATUS(posewise_mesh(t, 0, NULL, POSEWISE_MESH_VERTICES, &count), POSEWISE_E_NULL);
    CHECK_STATUS(posewise_mesh(t, 0, v, POSEWISE_MESH_VERTICES, NULL), POSEWISE_E_NULL);
    CHECK_STATUS(posewise_mesh(NULL, 0, v, POSEWISE_MESH_VERTICES, &count), POSEWISE_E_NULL);
    CHECK_STATUS(posewise_mesh(t, 0, inside, POSEWISE_MESH_VERTICES, &count), POSEWISE_E_OVERLAP);
    CHECK_STATUS(posewise_mesh(t, 0, v, POSEWISE_MESH_VERTICES, (size_t *)(void *)memory.start),
                 POSEWISE_E_OVERLAP);
    CHECK_STATUS(posewise_mesh(t, 0, v, POSEWISE_MESH_VERTICES, (size_t *)(void *)v),
                 POSEWISE_E_OVERLAP);
    CHECK(count == 0);
    for (space = POSEWISE_MESH_SPACE_PICTURE; space <= POSEWISE_MESH_SPACE_HEAD; space++) {
        memset(v, 0x33, sizeof v);
        CHECK_STATUS(posewise_mesh(t, space, v, SIZE_MAX, &count), POSEWISE_OK);
        CHECK(count == tables.vertex_count);
        CHECK(filled((uint8_t *)(v + count), sizeof v - count * sizeof *v, 0x33));
        for (i = 0; i < count; i++)
            CHECK(v[i].visibility >= 0 && v[i].visibility <= 1 && fabsf(v[i].x) < 1e5f);
    }
    mesh_shapes(t, memory, tables.vertex_count);
    CHECK_STATUS(posewise_reset(t), POSEWISE_OK);
    shape_refused(t, POSEWISE_MESH_NEUTRAL, POSEWISE_MESH_VERTICES, POSEWISE_E_NO_FACE);
    guarded_free(memory);
}

/* A step that must fail leaves tracker and output unchanged. */
static void frame_refused(posewise_tracker *t, const posewise_frame *f, posewise_status expected) {
    outputs a, before;
    memset(&before, 0x77, sizeof before);
    before.result.struct_size = sizeof before.result;
    CHECK_STATUS(step(t, f, &a), expected);
    CHECK(memcmp(&a, &before, sizeof a) == 0);
}

static void bad_frames(posewise_tracker *t, const posewise_frame *good) {
    posewise_frame f;
#define BAD(change, status) (f = *good, change, frame_refused(t, &f, status))
    BAD(f.data = NULL, POSEWISE_E_ARG);
    BAD(f.flags = 2, POSEWISE_E_ARG);
    BAD(f.flags = UINT32_MAX, POSEWISE_E_ARG);
    BAD(f.reserved = 1, POSEWISE_E_ARG);
    BAD(f.width = 0, POSEWISE_E_FRAME);
    BAD(f.height = 0, POSEWISE_E_FRAME);
    BAD(f.width = 16385, POSEWISE_E_FRAME);
    BAD(f.height = 16385, POSEWISE_E_FRAME);
    BAD(f.width = UINT32_MAX, POSEWISE_E_FRAME);
    BAD((f.height = UINT32_MAX, f.stride = UINT32_MAX), POSEWISE_E_FRAME);
    BAD(f.stride = f.width - 1, POSEWISE_E_FRAME);
    BAD(f.stride = 0, POSEWISE_E_FRAME);
    BAD(f.stride = UINT32_MAX, POSEWISE_E_FRAME);
    BAD(f.data_len = 0, POSEWISE_E_FRAME);
    BAD(f.data_len -= 1, POSEWISE_E_FRAME);
    BAD(f.data_len = SIZE_MAX, POSEWISE_E_FRAME);
    BAD(f.rotation_deg = 1, POSEWISE_E_FRAME);
    BAD(f.rotation_deg = 360, POSEWISE_E_FRAME);
    BAD(f.format = 0, POSEWISE_E_FORMAT);
    BAD(f.format = 0x47504A4D, POSEWISE_E_FORMAT); /* MJPG */
    BAD(f.format = POSEWISE_FMT_YUYV, POSEWISE_E_FRAME);
    BAD(f.format = POSEWISE_FMT_RGB3, POSEWISE_E_FRAME);
#undef BAD
}

static void test_bad_frames_change_nothing(void) {
    guarded left = tracker_memory(0), right = tracker_memory(0);
    posewise_tracker *disturbed = init(left, NULL), *reference = init(right, NULL);
    posewise_intrinsics nan_camera = {NAN, 500, 0, 0};
    posewise_frame f;
    outputs a, b;
    size_t i;
    for (i = 0; i < frames.count && i < 20; i++) {
        f = clip_frame(&frames, i);
        bad_frames(disturbed, &f);
        CHECK_STATUS(posewise_set_intrinsics(disturbed, &nan_camera), POSEWISE_E_ARG);
        CHECK_STATUS(step(disturbed, &f, &a), POSEWISE_OK);
        CHECK_STATUS(step(reference, &f, &b), POSEWISE_OK);
        CHECK(memcmp(&a, &b, sizeof a) == 0);
        frame_refused(disturbed, &f, POSEWISE_E_TIME);
        f.timestamp_us -= 1000;
        frame_refused(disturbed, &f, POSEWISE_E_TIME);
        f.timestamp_us = INT64_MIN;
        frame_refused(disturbed, &f, POSEWISE_E_TIME);
    }
    guarded_free(left);
    guarded_free(right);
}

static void test_formats(void) {
    static const struct {
        uint32_t format, bytes;
    } formats[] = {
        {POSEWISE_FMT_GREY, 1}, {POSEWISE_FMT_Y10, 2},  {POSEWISE_FMT_Y16, 2},
        {POSEWISE_FMT_YUYV, 2}, {POSEWISE_FMT_UYVY, 2}, {POSEWISE_FMT_NV12, 1},
        {POSEWISE_FMT_NV21, 1}, {POSEWISE_FMT_YU12, 1}, {POSEWISE_FMT_RGB3, 3},
        {POSEWISE_FMT_BGR3, 3}, {POSEWISE_FMT_XB24, 4}, {POSEWISE_FMT_AB24, 4},
        {POSEWISE_FMT_XR24, 4}, {POSEWISE_FMT_AR24, 4}, {POSEWISE_FMT_BX24, 4},
        {POSEWISE_FMT_BA24, 4}, {POSEWISE_FMT_RX24, 4}, {POSEWISE_FMT_RA24, 4},
    };
    guarded memory = tracker_memory(0);
    posewise_tracker *t = init(memory, NULL);
    posewise_frame f = clip_frame(&frames, 0);
    outputs a;
    size_t i;
    for (i = 0; i < sizeof formats / sizeof *formats; i++) {
        /* Memory that ends with the last row: a sanitizer detects a read beyond it. */
        const size_t len = (size_t)formats[i].bytes * 40 + 39 * 200;
        uint8_t *data = malloc(len);
        uint32_t turn;
        if (data == NULL)
            exit(2);
        memset(data, (int)i * 13, len);
        f.format = formats[i].format;
        f.width = f.height = 40;
        f.stride = 200;
        f.data = data;
        f.data_len = len;
        for (turn = 0; turn < 8; turn++) {
            f.rotation_deg = turn % 4 * 90;
            f.flags = turn / 4 * POSEWISE_FRAME_MIRRORED;
            f.timestamp_us++;
            CHECK_STATUS(step(t, &f, &a), POSEWISE_OK);
        }
        f.data_len--;
        f.timestamp_us++;
        frame_refused(t, &f, POSEWISE_E_FRAME);
        free(data);
    }
    guarded_free(memory);
}

static void test_extreme_times(void) {
    static const int64_t times[] = {INT64_MIN, INT64_MIN + 1, -1, 0, 1, INT64_MAX - 1, INT64_MAX};
    guarded memory = tracker_memory(0);
    posewise_tracker *t = init(memory, NULL);
    posewise_frame f = clip_frame(&frames, 0);
    outputs a;
    size_t i, round;
    for (round = 0; round < 2; round++) {
        for (i = 0; i < sizeof times / sizeof *times; i++) {
            f.timestamp_us = times[i];
            CHECK_STATUS(step(t, &f, &a), POSEWISE_OK);
            CHECK(a.result.age_us >= 0);
        }
        frame_refused(t, &f, POSEWISE_E_TIME);
        CHECK_STATUS(posewise_reset(t), POSEWISE_OK);
    }
    guarded_free(memory);
}

static void test_intrinsics(void) {
    guarded memory = tracker_memory(0);
    posewise_tracker *t = init(memory, NULL);
    const posewise_intrinsics zero = {0, 0, 0, 0};
    static const posewise_intrinsics good[] = {
        {900, 900, 320, 240}, {1, 1, 0, 0}, {1e6f, 1e6f, 1e5f, -1e5f}, {500, 51, 0, 0},
        {500, 4999, 0, 0},
    };
    static const posewise_intrinsics bad[] = {
        {NAN, 1, 1, 1},  {1, NAN, 1, 1},      {1, 1, NAN, 1},       {1, 1, 1, NAN},
        {0, 900, 0, 0},  {900, 0, 0, 0},      {-900, 900, 0, 0},    {900, -900, 0, 0},
        {0, 0, 320, 240}, {INFINITY, 1, 0, 0}, {1, 1, -INFINITY, 0},
        {0.9f, 1, 0, 0}, {1e-6f, 1e-6f, 0, 0}, {1.1e6f, 1e6f, 0, 0}, {1e6f, 1.1e6f, 0, 0},
        {500, 49, 0, 0}, {500, 5001, 0, 0},   {900, 900, 1.1e5f, 0}, {900, 900, 0, -1.1e5f},
    };
    size_t i;
    for (i = 0; i < sizeof good / sizeof *good; i++)
        CHECK_STATUS(posewise_set_intrinsics(t, &good[i]), POSEWISE_OK);
    CHECK_STATUS(posewise_set_intrinsics(t, &zero), POSEWISE_OK);
    CHECK_STATUS(posewise_set_intrinsics(t, NULL), POSEWISE_OK);
    for (i = 0; i < sizeof bad / sizeof *bad; i++)
        CHECK_STATUS(posewise_set_intrinsics(t, &bad[i]), POSEWISE_E_ARG);
    CHECK_STATUS(posewise_set_intrinsics(
                     t, (const posewise_intrinsics *)(const void *)((const char *)bad + 1)),
                 POSEWISE_E_ARG);
    guarded_free(memory);
}

/* Coefficients of each lens, right and wrong; a lens needs intrinsics. */
static void test_lens(void) {
    guarded memory = tracker_memory(0), other = tracker_memory(0);
    posewise_tracker *t = init(memory, NULL), *unused = NULL;
    const posewise_intrinsics camera = {400, 400, 160, 120};
    posewise_config c = POSEWISE_CONFIG_INIT;
    static const posewise_lens good[] = {
        {POSEWISE_LENS_PINHOLE, {0}},
        {POSEWISE_LENS_BROWN, {-0.3f, 0.1f, 0.001f, -0.002f, 0.01f}},
        {POSEWISE_LENS_BROWN, {1e4f, 1e4f, 0.1f, -0.1f, 1e4f}},
        {POSEWISE_LENS_FISHEYE, {0.1f, -0.02f, 0.01f, -0.001f, 0}},
        {POSEWISE_LENS_FISHEYE, {10, 10, 10, 10, 0}},
    };
    static const posewise_lens bad[] = {
        {POSEWISE_LENS_PINHOLE, {0, 0, 0, 0, 0.1f}},   {3, {0}},
        {UINT32_MAX, {0}},                             {POSEWISE_LENS_BROWN, {NAN}},
        {POSEWISE_LENS_BROWN, {0, 0, 0, 0, INFINITY}}, {POSEWISE_LENS_BROWN, {0, 0, 0.11f, 0, 0}},
        {POSEWISE_LENS_BROWN, {-10001, 0, 0, 0, 0}},   {POSEWISE_LENS_BROWN, {-10000, 0, 0, 0, 0}},
        {POSEWISE_LENS_FISHEYE, {0, 0, 0, 0, 0.1f}},   {POSEWISE_LENS_FISHEYE, {0, 0, 0, 11, 0}},
        {POSEWISE_LENS_FISHEYE, {0, NAN, 0, 0, 0}},
    };
    size_t i;
    CHECK_STATUS(posewise_set_lens(t, NULL), POSEWISE_OK);
    CHECK_STATUS(posewise_set_lens(t, &good[0]), POSEWISE_OK);
    CHECK_STATUS(posewise_set_lens(t, &good[1]), POSEWISE_E_INTRINSICS);
    c.lens = good[1];
    CHECK(posewise_memory_size(&c) == 0);
    CHECK_STATUS(posewise_init(&unused, other.start, other.len, model.start, model.len, &c),
                 POSEWISE_E_INTRINSICS);
    c.intrinsics = camera;
    CHECK_STATUS(posewise_set_intrinsics(t, &camera), POSEWISE_OK);
    for (i = 0; i < sizeof good / sizeof *good; i++) {
        c.lens = good[i];
        CHECK_STATUS(posewise_init(&unused, other.start, other.len, model.start, model.len, &c),
                     POSEWISE_OK);
        CHECK_STATUS(posewise_set_lens(t, &good[i]), POSEWISE_OK);
    }
    for (i = 0; i < sizeof bad / sizeof *bad; i++) {
        c.lens = bad[i];
        CHECK_STATUS(posewise_init(&unused, other.start, other.len, model.start, model.len, &c),
                     POSEWISE_E_LENS);
        CHECK_STATUS(posewise_set_lens(t, &bad[i]), POSEWISE_E_LENS);
    }
    CHECK_STATUS(posewise_set_lens(
                     t, (const posewise_lens *)(const void *)((const char *)good + 1)),
                 POSEWISE_E_ARG);
    /* Without intrinsics the lens is gone too. */
    CHECK_STATUS(posewise_set_intrinsics(t, NULL), POSEWISE_OK);
    CHECK_STATUS(posewise_set_lens(t, &good[1]), POSEWISE_E_INTRINSICS);
    guarded_free(other);
    guarded_free(memory);
}

/* Settings of the first header: what follows them in memory is not read. */
static void test_first_config(void) {
    guarded memory = tracker_memory(0);
    posewise_config c = POSEWISE_CONFIG_INIT;
    posewise_tracker *t = NULL;
    c.struct_size = 40;
    memset(&c.lens, 0xFF, sizeof c.lens);
    CHECK(posewise_memory_size(&c) == posewise_memory_size(NULL));
    CHECK_STATUS(posewise_init(&t, memory.start, memory.len, model.start, model.len, &c),
                 POSEWISE_OK);
    CHECK_STATUS(posewise_config_default(&c), POSEWISE_OK);
    CHECK(c.struct_size == 40 && filled((const uint8_t *)&c.lens, sizeof c.lens, 0xFF));
    guarded_free(memory);
}

/* A result of the first header: what follows it in memory is not written. */
static void test_first_result(void) {
    guarded memory = tracker_memory(0);
    posewise_tracker *t = init(memory, NULL);
    const posewise_frame f = clip_frame(&frames, 0);
    posewise_result r;
    memset(&r, 0xFF, sizeof r);
    r.struct_size = 128;
    CHECK_STATUS(posewise_step(t, &f, &r), POSEWISE_OK);
    CHECK(r.struct_size == 128 && r.timestamp_us == f.timestamp_us);
    CHECK(filled((const uint8_t *)&r + 128, sizeof r - 128, 0xFF));
    guarded_free(memory);
}

/* With twice the focal length, the same image means twice the distance. */
static void test_zoom(void) {
    guarded memory = tracker_memory(0);
    posewise_tracker *t = init(memory, NULL);
    posewise_intrinsics camera = {400, 400, 160, 120};
    posewise_frame f;
    outputs a, zoomed;
    size_t i;
    memset(&a, 0, sizeof a);
    CHECK_STATUS(posewise_set_intrinsics(t, &camera), POSEWISE_OK);
    for (i = 0; i < frames.count; i++) {
        f = clip_frame(&frames, i);
        CHECK_STATUS(step(t, &f, &a), POSEWISE_OK);
    }
    camera.fx = camera.fy = 800;
    CHECK_STATUS(posewise_set_intrinsics(t, &camera), POSEWISE_OK);
    f.timestamp_us++;
    CHECK_STATUS(step(t, &f, &zoomed), POSEWISE_OK);
    CHECK(zoomed.result.state == a.result.state);
    if (a.result.state == POSEWISE_TRACKING) {
        const float times = zoomed.result.translation_mm[2] / a.result.translation_mm[2];
        CHECK(times > 1.8f && times < 2.2f);
    }
    guarded_free(memory);
}

/* Events are read once, in order, into memory with guards. A log that is full counts what it lost;
 * a call that fails takes nothing out. */
static void test_events(void) {
    guarded memory = tracker_memory(0), out = guarded_new(3 * sizeof(posewise_event), 0x77);
    posewise_tracker *t = init(memory, NULL);
    posewise_event *e = (posewise_event *)(void *)out.start, *own = (posewise_event *)(void *)t;
    size_t i, count = 7, lost = 7, *inside = (size_t *)(void *)(memory.start + 4096);
    uint32_t state = POSEWISE_SEARCHING;
    posewise_result r = POSEWISE_RESULT_INIT;
    CHECK_STATUS(posewise_events(t, e, 3, &count, &lost), POSEWISE_OK);
    CHECK(count == 0 && lost == 0 && filled(out.start, out.len, 0x77));
    for (i = 0; i < frames.count && state == POSEWISE_SEARCHING; i++) {
        const posewise_frame f = clip_frame(&frames, i);
        CHECK_STATUS(posewise_step(t, &f, &r), POSEWISE_OK);
        state = r.state;
    }
    CHECK_STATUS(posewise_forget_identity(t), POSEWISE_OK);
    CHECK_STATUS(posewise_reset(t), POSEWISE_OK);
    CHECK_STATUS(posewise_events(t, NULL, 3, &count, &lost), POSEWISE_E_NULL);
    CHECK_STATUS(posewise_events(t, e, 3, NULL, &lost), POSEWISE_E_NULL);
    CHECK_STATUS(posewise_events(t, e, 3, &count, NULL), POSEWISE_E_NULL);
    CHECK_STATUS(posewise_events(t, own, 3, &count, &lost), POSEWISE_E_OVERLAP);
    CHECK_STATUS(posewise_events(t, e, 3, inside, &lost), POSEWISE_E_OVERLAP);
    CHECK_STATUS(posewise_events(t, e, 3, &count, inside), POSEWISE_E_OVERLAP);
    CHECK_STATUS(posewise_events(t, e, 0, &count, &lost), POSEWISE_OK);
    CHECK(count == 0 && lost == 0 && filled(out.start, out.len, 0x77));
    if (state == POSEWISE_TRACKING) {
        CHECK_STATUS(posewise_events(t, e, 2, &count, &lost), POSEWISE_OK);
        CHECK(count == 2 && lost == 0);
        CHECK(e[0].kind == POSEWISE_EVENT_ACQUIRED && e[0].loss == POSEWISE_LOSS_NONE);
        CHECK(e[0].timestamp_us == r.timestamp_us && e[0].confidence == r.confidence);
        CHECK(memcmp(e[0].face_box, r.face_box, sizeof r.face_box) == 0 && e[0].reserved == 0);
        CHECK(e[1].kind == POSEWISE_EVENT_FORGOTTEN);
        CHECK(e[1].timestamp_us == r.timestamp_us);
        CHECK_STATUS(posewise_events(t, e, 3, &count, &lost), POSEWISE_OK);
        CHECK(count == 1 && lost == 0 && e[0].kind == POSEWISE_EVENT_RESET);
    }
    for (i = 0; i < POSEWISE_EVENTS + 5; i++)
        CHECK_STATUS(posewise_forget_identity(t), POSEWISE_OK);
    CHECK_STATUS(posewise_events(t, e, 3, &count, &lost), POSEWISE_OK);
    CHECK(count == 3 && lost >= 5);
    for (i = 3; count != 0 && i < 100; i += count) {
        CHECK_STATUS(posewise_events(t, e, 3, &count, &lost), POSEWISE_OK);
        CHECK(lost == 0);
    }
    CHECK(i == POSEWISE_EVENTS && count == 0);
    guarded_free(out);
    guarded_free(memory);
}

/* Tracking continues, and the shape of the head is estimated anew. */
static void test_forget_person(void) {
    guarded kept = tracker_memory(0), forgot = tracker_memory(0);
    posewise_tracker *a = init(kept, NULL), *b = init(forgot, NULL);
    const size_t when = frames.count / 2;
    outputs of_a, of_b;
    size_t i, differ = 0;
    CHECK_STATUS(posewise_forget_identity(b), POSEWISE_OK); /* no face yet: no effect */
    for (i = 0; i < frames.count; i++) {
        const posewise_frame f = clip_frame(&frames, i);
        CHECK_STATUS(step(a, &f, &of_a), POSEWISE_OK);
        CHECK_STATUS(step(b, &f, &of_b), POSEWISE_OK);
        CHECK(of_a.result.state == of_b.result.state);
        differ += memcmp(&of_a, &of_b, sizeof of_a) != 0;
        if (i < when)
            CHECK(differ == 0);
        if (i == when)
            CHECK_STATUS(posewise_forget_identity(b), POSEWISE_OK);
    }
    if (of_a.result.state == POSEWISE_TRACKING)
        CHECK(differ > 0);
    guarded_free(kept);
    guarded_free(forgot);
}

/* What was learnt of a head outlives the tracker; a record that is none changes nothing. */
static void test_person_record(void) {
    guarded memory = tracker_memory(0), other = tracker_memory(0);
    posewise_tracker *t = init(memory, NULL), *u = init(other, NULL);
    uint8_t record[POSEWISE_IDENTITY_RECORD_SIZE], again[POSEWISE_IDENTITY_RECORD_SIZE];
    posewise_result r = POSEWISE_RESULT_INIT;
    uint32_t like = 7, *const inside = (uint32_t *)(void *)(memory.start + 4096);
    size_t i;
    CHECK_STATUS(posewise_save_identity(t, record, sizeof record), POSEWISE_E_NO_FACE);
    for (i = 0; i < frames.count; i++) {
        const posewise_frame f = clip_frame(&frames, i);
        CHECK_STATUS(posewise_step(t, &f, &r), POSEWISE_OK);
    }
    CHECK_STATUS(posewise_save_identity(t, NULL, sizeof record), POSEWISE_E_NULL);
    CHECK_STATUS(posewise_save_identity(t, record, sizeof record - 1), POSEWISE_E_CAPACITY);
    CHECK_STATUS(posewise_save_identity(t, (uint8_t *)t, sizeof record), POSEWISE_E_OVERLAP);
    if (r.state == POSEWISE_TRACKING) {
        CHECK_STATUS(posewise_save_identity(t, record, sizeof record), POSEWISE_OK);
        for (i = 0; i < sizeof record; i++) {
            const posewise_status expected = i < 8    ? POSEWISE_E_RECORD
                                             : i < 12 ? POSEWISE_E_RECORD_VERSION
                                                      : POSEWISE_E_RECORD_CHECKSUM;
            record[i] ^= 1;
            CHECK_STATUS(posewise_restore_identity(u, record, sizeof record), expected);
            CHECK_STATUS(posewise_compare_identity(t, record, sizeof record, &like), expected);
            record[i] ^= 1;
            CHECK_STATUS(posewise_restore_identity(u, record, i), POSEWISE_E_RECORD_SIZE);
        }
        CHECK_STATUS(posewise_restore_identity(u, NULL, sizeof record), POSEWISE_E_NULL);
        CHECK_STATUS(posewise_restore_identity(u, other.start, sizeof record), POSEWISE_E_OVERLAP);
        CHECK_STATUS(posewise_compare_identity(t, NULL, sizeof record, &like), POSEWISE_E_NULL);
        CHECK_STATUS(posewise_compare_identity(t, record, sizeof record, NULL), POSEWISE_E_NULL);
        CHECK_STATUS(posewise_compare_identity(t, record, sizeof record, inside),
                     POSEWISE_E_OVERLAP);
        CHECK(like == 7);
        CHECK_STATUS(posewise_compare_identity(u, record, sizeof record, &like), POSEWISE_OK);
        CHECK(like == POSEWISE_LIKENESS_UNKNOWN);
        CHECK_STATUS(posewise_compare_identity(t, record, sizeof record, &like), POSEWISE_OK);
        CHECK(like != POSEWISE_LIKENESS_OTHER);
        CHECK_STATUS(posewise_restore_identity(u, record, sizeof record), POSEWISE_OK);
        CHECK_STATUS(posewise_save_identity(u, again, sizeof again), POSEWISE_E_NO_FACE);
        for (i = 0; i < frames.count; i++) {
            const posewise_frame f = clip_frame(&frames, i);
            CHECK_STATUS(posewise_step(u, &f, &r), POSEWISE_OK);
        }
        CHECK_STATUS(posewise_save_identity(u, again, sizeof again), POSEWISE_OK);
        CHECK(memcmp(record, again, 16) != 0 && memcmp(record, again, 12) == 0);
        CHECK_STATUS(posewise_reset(u), POSEWISE_OK);
        CHECK_STATUS(posewise_save_identity(u, again, sizeof again), POSEWISE_E_NO_FACE);
    }
    guarded_free(other);
    guarded_free(memory);
}

/* Memory full of zeros or ones, a reset, a copied tracker: the same results bit for bit. */
static void test_same_results(void) {
    guarded zeros = tracker_memory(0x00), ones = tracker_memory(0xFF), moved = tracker_memory(0xA5);
    posewise_tracker *a = init(zeros, NULL), *b = init(ones, NULL), *c;
    outputs *results = calloc(frames.count, sizeof *results), again;
    posewise_frame f;
    size_t i, tracked = 0;
    if (results == NULL)
        exit(2);
    for (i = 0; i < frames.count; i++) {
        f = clip_frame(&frames, i);
        CHECK_STATUS(step(a, &f, &results[i]), POSEWISE_OK);
        CHECK_STATUS(step(b, &f, &again), POSEWISE_OK);
        CHECK(memcmp(&again, &results[i], sizeof again) == 0);
        tracked += again.result.state == POSEWISE_TRACKING;
        CHECK((again.result.landmark_count == 0) == (again.result.state == POSEWISE_SEARCHING));
    }
    CHECK_STATUS(posewise_reset(b), POSEWISE_OK);
    for (i = 0; i < frames.count / 2; i++) {
        f = clip_frame(&frames, i);
        CHECK_STATUS(step(b, &f, &again), POSEWISE_OK);
        CHECK(memcmp(&again, &results[i], sizeof again) == 0);
    }
    memcpy(moved.start, ones.start, posewise_memory_size(NULL));
    memset(ones.start, 0xDD, ones.len);
    c = (posewise_tracker *)(void *)moved.start;
    for (; i < frames.count; i++) {
        f = clip_frame(&frames, i);
        CHECK_STATUS(step(c, &f, &again), POSEWISE_OK);
        CHECK(memcmp(&again, &results[i], sizeof again) == 0);
    }
    printf("# %zu frames, %zu tracked\n", frames.count, tracked);
    free(results);
    guarded_free(zeros);
    guarded_free(ones);
    guarded_free(moved);
}

/* A refused step of a group writes nothing, and its trackers are as before. */
static void group_refused(posewise_group *g, posewise_tracker *const *t, size_t count,
                          const posewise_frame *f, posewise_result *out, posewise_status expected) {
    posewise_result before[2];
    memcpy(before, out, sizeof before);
    CHECK_STATUS(posewise_group_step(g, t, count, f, out), expected);
    CHECK(memcmp(out, before, sizeof before) == 0);
}

static void test_group(void) {
    posewise_frame f = clip_frame(&frames, 0);
    guarded first = tracker_memory(0), second = tracker_memory(0);
    guarded memory = guarded_new(posewise_group_memory_size(), 0x77);
    posewise_tracker *t[POSEWISE_GROUP_TRACKERS + 1] = {NULL}, *same[2], *none[2];
    posewise_result out[2] = {POSEWISE_RESULT_INIT, POSEWISE_RESULT_INIT};
    posewise_group *g = NULL;
    CHECK(memory.len <= POSEWISE_GROUP_SIZE);
    t[0] = init(first, NULL);
    t[1] = init(second, NULL);
    same[0] = same[1] = t[0];
    none[0] = t[0];
    none[1] = NULL;
    CHECK_STATUS(posewise_group_init(NULL, memory.start, memory.len), POSEWISE_E_NULL);
    CHECK_STATUS(posewise_group_init(&g, NULL, memory.len), POSEWISE_E_NULL);
    CHECK_STATUS(posewise_group_init(&g, memory.start, memory.len - 1), POSEWISE_E_MEMORY);
    CHECK_STATUS(posewise_group_init(&g, memory.start + 8, memory.len), POSEWISE_E_MEMORY);
    CHECK_STATUS(posewise_group_init((posewise_group **)(void *)memory.start, memory.start,
                                     memory.len),
                 POSEWISE_E_OVERLAP);
    CHECK(g == NULL && filled(memory.start, memory.len, 0x77));
    group_refused((posewise_group *)(void *)memory.start, t, 2, &f, out, POSEWISE_E_GROUP);
    CHECK_STATUS(posewise_group_init(&g, memory.start, memory.len), POSEWISE_OK);
    CHECK((void *)g == (void *)memory.start);
    group_refused(NULL, t, 2, &f, out, POSEWISE_E_NULL);
    group_refused(g, NULL, 2, &f, out, POSEWISE_E_NULL);
    group_refused(g, t, 0, &f, out, POSEWISE_E_GROUP_TRACKERS);
    group_refused(g, t, POSEWISE_GROUP_TRACKERS + 1, &f, out, POSEWISE_E_GROUP_TRACKERS);
    group_refused(g, t, SIZE_MAX, &f, out, POSEWISE_E_GROUP_TRACKERS);
    group_refused(g, none, 2, &f, out, POSEWISE_E_NULL);
    group_refused(g, same, 2, &f, out, POSEWISE_E_OVERLAP);
    group_refused(g, t, 2, NULL, out, POSEWISE_E_NULL);
    CHECK_STATUS(posewise_group_step(g, t, 2, &f, NULL), POSEWISE_E_NULL);
    CHECK_STATUS(posewise_group_step(g, t, 1, &f, (posewise_result *)(void *)first.start),
                 POSEWISE_E_STRUCT_SIZE);
    out[1].struct_size = 128;
    group_refused(g, t, 2, &f, out, POSEWISE_E_STRUCT_SIZE);
    out[1].struct_size = sizeof out[1];
    f.height = 0;
    group_refused(g, t, 2, &f, out, POSEWISE_E_FRAME);
    f = clip_frame(&frames, 0);
    CHECK_STATUS(posewise_group_step(g, t, 2, &f, out), POSEWISE_OK);
    CHECK(out[0].timestamp_us == f.timestamp_us && out[1].timestamp_us == f.timestamp_us);
    group_refused(g, t, 2, &f, out, POSEWISE_E_TIME);
    /* One face: the second tracker has none. */
    f = clip_frame(&frames, 1);
    CHECK_STATUS(posewise_group_step(g, t, 2, &f, out), POSEWISE_OK);
    CHECK(out[0].state == POSEWISE_TRACKING && out[1].state == POSEWISE_SEARCHING);
    guarded_free(memory);
    guarded_free(second);
    guarded_free(first);
}

int main(int argc, char **argv) {
    guarded before, frames_before;
    if (argc != 5)
        return 2;
    model = guarded_file(argv[1]);
    frames = clip_read(argv[2], argv[3], argv[4]);
    before = guarded_file(argv[1]);
    frames_before = guarded_file(argv[2]);
    test_constants();
    test_default_model();
    test_config();
    test_roi_of_config();
    test_model();
    test_model_info();
    test_init();
    test_codes();
    test_wrong_order();
    test_any_order();
    test_past_the_end();
    test_step_pointers();
    test_struct_sizes();
    test_initialisers();
    test_outputs();
    test_mesh();
    test_bad_frames_change_nothing();
    test_formats();
    test_extreme_times();
    test_intrinsics();
    test_lens();
    test_first_config();
    test_first_result();
    test_zoom();
    test_events();
    test_forget_person();
    test_group();
    test_person_record();
    test_same_results();
    CHECK(memcmp(model.start, before.start, model.len) == 0);
    CHECK(memcmp(frames.bytes.start, frames_before.start, frames.bytes.len) == 0);
    guarded_free(before);
    guarded_free(frames_before);
    guarded_free(model);
    guarded_free(frames.bytes);
    return failures != 0;
}
