/* replay.c VIDEO.y4m FRAMES [CPU] - prints a hash of all bytes of all results for the video's first
 * frames, gaze, mesh and driver monitor included. The line is the same on every machine. Standard
 * error gets the sizes of model and tracker and the peak stacks of posewise_init, _step, _step_at,
 * _detect and _mesh, or _mesh_shape [bytes]. C99 with GCC's attributes; reads 8-bit mono y4m. */
#include "posewise.h"
#include "float_env.h"
#include "hash.h"
#include "stack.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Static memory, small enough for a microcontroller board: the frames are the largest. */
static uint8_t memory[POSEWISE_MEMORY_SIZE + POSEWISE_ALIGN];
static uint8_t pixels[640 * 480], last[640 * 480];
static posewise_landmark landmarks[POSEWISE_LANDMARKS];
static float animation[POSEWISE_ANIMATIONS];
static posewise_mesh_vertex vertices[POSEWISE_MESH_VERTICES];
static uint8_t monitor_memory[POSEWISE_MONITOR_SIZE + POSEWISE_ALIGN];

static int fail(const char *what) {
    fprintf(stderr, "replay: %s\n", what);
    return 1;
}

/* The deepest stacks so far. */
static size_t step_stack, step_at_stack, detect_stack, mesh_stack;

/* Notes how deep the stack was, if it was the deepest. */
static void deepest(size_t *stack, size_t used) {
    *stack = used > *stack ? used : *stack;
}

/* The next floating-point environment, none of which must matter. */
static uint32_t next_env(void) {
    static unsigned count;
    set_float_env(float_envs[count++ % FLOAT_ENVS]);
    return float_env();
}

/* Restores the own environment; a call must not have changed the one that was set for it. */
static void own_env(uint32_t own, uint32_t before) {
    const uint32_t after = float_env();
    set_float_env(own);
    if (before != after) {
        fprintf(stderr, "replay: the floating-point environment was changed\n");
        exit(1);
    }
}

/* A step, with a hint unless that is NULL. */
static posewise_status step(posewise_tracker *tracker, posewise_frame *frame,
                            const posewise_hint *hint, posewise_result *result) {
    const uint32_t own = float_env();
    uint32_t before;
    posewise_status status;
    stack_walk(1);
    before = next_env();
    if (hint != NULL)
        status = posewise_step_at(tracker, frame, hint, result);
    else
        status = posewise_step(tracker, frame, result);
    own_env(own, before);
    deepest(hint != NULL ? &step_at_stack : &step_stack, stack_walk(0));
    return status;
}

/* Scans the whole frame; hashes all faces and gives the largest one's box in the hint. */
static posewise_status detect(posewise_tracker *tracker, posewise_frame *frame,
                              posewise_hint *hint) {
    static posewise_face faces[16];
    posewise_status status = POSEWISE_OK;
    uint32_t finished = 0, before;
    while (status == POSEWISE_OK && !finished) {
        const uint32_t own = float_env();
        size_t count;
        stack_walk(1);
        before = next_env();
        status = posewise_detect(tracker, frame, faces, 16, &count, &finished);
        own_env(own, before);
        deepest(&detect_stack, stack_walk(0));
        if (status == POSEWISE_OK && count > 0) {
            hash_bytes(faces, count * sizeof *faces);
            memcpy(hint->face_box, faces[0].face_box, sizeof hint->face_box);
        }
    }
    return status;
}

/* A function that writes vertices: posewise_mesh or posewise_mesh_shape. */
typedef posewise_status (*mesh_function)(const posewise_tracker *, uint32_t, posewise_mesh_vertex *,
                                         size_t, size_t *);

/* Hashes what it writes, if there is a mesh. */
static posewise_status vertices_of(const posewise_tracker *tracker, mesh_function function,
                                   uint32_t which) {
    const uint32_t own = float_env();
    size_t count;
    uint32_t before;
    posewise_status status;
    stack_walk(1);
    before = next_env();
    status = function(tracker, which, vertices, POSEWISE_MESH_VERTICES, &count);
    own_env(own, before);
    deepest(&mesh_stack, stack_walk(0));
    if (status == POSEWISE_OK)
        hash_bytes(vertices, count * sizeof *vertices);
    return status;
}

/* Hashes the mesh in every space, and every shape of the head, if there is one. */
static posewise_status mesh(const posewise_tracker *tracker) {
    posewise_status status = POSEWISE_OK;
    uint32_t which;
    for (which = 0; status == POSEWISE_OK && which <= POSEWISE_MESH_SPACE_HEAD; which++)
        status = vertices_of(tracker, posewise_mesh, which);
    for (which = 0; status == POSEWISE_OK && which < POSEWISE_ANIMATIONS; which++)
        status = vertices_of(tracker, posewise_mesh_shape, which);
    if (status == POSEWISE_OK)
        status = vertices_of(tracker, posewise_mesh_shape, POSEWISE_MESH_NEUTRAL);
    return status == POSEWISE_E_MESH || status == POSEWISE_E_NO_FACE ? POSEWISE_OK : status;
}

/* Shows the monitor what the tracker saw, and hashes what it knows then. */
static posewise_status watch(const posewise_tracker *tracker, posewise_monitor *monitor,
                             int64_t timestamp_us) {
    posewise_monitor_observation seen = POSEWISE_MONITOR_OBSERVATION_INIT;
    posewise_monitor_state state = POSEWISE_MONITOR_STATE_INIT;
    posewise_status status = posewise_monitor_observe(tracker, &seen);
    if (status == POSEWISE_OK)
        status = posewise_monitor_update(monitor, &seen, timestamp_us);
    if (status == POSEWISE_OK)
        status = posewise_monitor_read(monitor, &state);
    hash_bytes(&seen, sizeof seen);
    hash_bytes(&state, sizeof state);
    return status;
}

int main(int argc, char **argv) {
    uint8_t *aligned = memory + (POSEWISE_ALIGN - (uintptr_t)memory % POSEWISE_ALIGN);
    uint8_t *watching =
        monitor_memory + (POSEWISE_ALIGN - (uintptr_t)monitor_memory % POSEWISE_ALIGN);
    posewise_config config = POSEWISE_CONFIG_INIT;
    posewise_monitor *monitor;
    posewise_frame frame = POSEWISE_FRAME_INIT;
    posewise_result result = POSEWISE_RESULT_INIT;
    posewise_hint hint = POSEWISE_HINT_INIT;
    posewise_tracker *tracker;
    posewise_status status;
    unsigned width, height;
    size_t model_len, len, init_stack;
    const void *model = posewise_default_model(&model_len);
    long count = 0, tracked = 0, more;
    unsigned landmark_count = 0;
    FILE *video = argc >= 3 ? fopen(argv[1], "rb") : NULL;
    char line[128];

    if (argc > 3 && posewise_set_cpu((uint32_t)strtol(argv[3], NULL, 10)) != POSEWISE_OK)
        return fail("the features of the processor are unknown");
    if (video == NULL)
        return fail("usage: replay VIDEO.y4m FRAMES [CPU]");
    if (fgets(line, sizeof line, video) == NULL ||
        sscanf(line, "YUV4MPEG2 W%u H%u", &width, &height) != 2 ||
        (len = (size_t)width * height) > sizeof pixels)
        return fail("the video is not y4m, or too large");
    config.gaze = POSEWISE_GAZE_ON;
    stack_walk(1);
    status = posewise_init(&tracker, aligned, POSEWISE_MEMORY_SIZE, model, model_len, &config);
    init_stack = stack_walk(0);
    if (status == POSEWISE_OK)
        status = posewise_monitor_init(&monitor, watching, POSEWISE_MONITOR_SIZE, NULL);
    if (status != POSEWISE_OK)
        return fail(posewise_strerror(status));
    frame.format = POSEWISE_FMT_GREY;
    frame.width = width;
    frame.height = height;
    frame.stride = width;
    frame.data_len = len;
    frame.data = pixels;
    while (count < strtol(argv[2], NULL, 10) && fgets(line, sizeof line, video) != NULL) {
        if (fread(pixels, 1, len, video) != len)
            return fail("the video is truncated");
        frame.timestamp_us = count * INT64_C(50000);
        status = step(tracker, &frame, NULL, &result);
        if (status == POSEWISE_OK)
            status = posewise_landmarks(tracker, landmarks, POSEWISE_LANDMARKS);
        if (status == POSEWISE_OK)
            status = posewise_animation(tracker, animation, POSEWISE_ANIMATIONS);
        if (status == POSEWISE_OK)
            status = watch(tracker, monitor, frame.timestamp_us);
        if (status == POSEWISE_OK)
            status = mesh(tracker);
        if (status != POSEWISE_OK)
            return fail(posewise_strerror(status));
        hash_bytes(&result, sizeof result);
        hash_bytes(landmarks, sizeof landmarks);
        hash_bytes(animation, sizeof animation);
        tracked += result.state == POSEWISE_TRACKING;
        if (result.landmark_count > landmark_count)
            landmark_count = result.landmark_count;
        count++;
    }
    /* The face goes and comes back, so that the stack of a loss is measured, too. */
    memcpy(last, pixels, len);
    for (more = 0; more < 60 && status == POSEWISE_OK; more++) {
        memcpy(pixels, last, len);
        if (more % 30 < 20)
            memset(pixels, 128, len);
        frame.timestamp_us += INT64_C(50000);
        status = step(tracker, &frame, NULL, &result);
    }
    if (status != POSEWISE_OK || result.state != POSEWISE_TRACKING)
        return fail("the face did not come back");
    /* Found by the whole scan, then expected where it was found. */
    status = detect(tracker, &frame, &hint);
    if (status == POSEWISE_OK)
        status = posewise_reset(tracker);
    if (status == POSEWISE_OK)
        status = step(tracker, &frame, &hint, &result);
    if (status != POSEWISE_OK || result.state != POSEWISE_TRACKING)
        return fail("the face was not detected");
    hash_bytes(&result, sizeof result);
    fprintf(stderr, "model: %lu bytes\ntracker: %lu bytes\nlandmarks: %u\n",
            (unsigned long)model_len, (unsigned long)posewise_memory_size(NULL), landmark_count);
    fprintf(stderr, "stack of posewise_init: %lu bytes\nstack of posewise_step: %lu bytes\n",
            (unsigned long)init_stack, (unsigned long)step_stack);
    fprintf(stderr, "stack of posewise_step_at: %lu bytes\nstack of posewise_detect: %lu bytes\n",
            (unsigned long)step_at_stack, (unsigned long)detect_stack);
    fprintf(stderr, "stack of posewise_mesh: %lu bytes\n", (unsigned long)mesh_stack);
    print_hash();
    printf(" %ld frames, %ld tracked\n", count, tracked);
    return 0;
}
