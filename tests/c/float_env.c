/* float_env.c MODEL FRAMES WIDTH HEIGHT - the caller's floating-point environment does not matter:
 * with each, all functions give the same bits as with the default one, nothing traps, and the
 * environment is afterwards what it was. Prints each check that fails. */
#include "guarded.h"
#include "float_env.h"

#include <math.h>

/* All outputs of a step. */
typedef struct {
    posewise_result result, smoothed;
    posewise_landmark landmarks[POSEWISE_LANDMARKS], smoothed_landmarks[POSEWISE_LANDMARKS];
    float animation[POSEWISE_ANIMATIONS], smoothed_animation[POSEWISE_ANIMATIONS];
} outputs;

static guarded model;
static clip frames;

/* A call in an environment, which stays as it was, flags of exceptions too. */
#define IN_ENV(call)                             \
    do {                                         \
        posewise_status status_;                 \
        uint32_t before_, after_;                \
        set_float_env(env);                      \
        before_ = float_env();                   \
        status_ = (call);                        \
        after_ = float_env();                    \
        set_float_env(float_envs[0]);            \
        CHECK_STATUS(status_, POSEWISE_OK);      \
        CHECK(before_ == after_);                \
    } while (0)

/* Tracks the frames in an environment. */
static void track(uint32_t env, outputs *all) {
    const posewise_intrinsics camera = {333, 334, 160.3f, 119.7f};
    posewise_config config = POSEWISE_CONFIG_INIT, wrong = POSEWISE_CONFIG_INIT;
    guarded memory = guarded_new(POSEWISE_MEMORY_SIZE, 0);
    posewise_model_details info = POSEWISE_MODEL_DETAILS_INIT;
    posewise_tracker *t;
    size_t i;
    memset(all, 0, frames.count * sizeof *all);
    config.intrinsics.fx = config.intrinsics.fy = 500.1f;
    config.smoothing_hz = 1.3f;
    wrong.smoothing_beta = NAN; /* a comparison with it is an invalid operation */
    IN_ENV(posewise_model_check(model.start, model.len));
    IN_ENV(posewise_model_info(model.start, model.len, &info));
    IN_ENV(posewise_init(&t, memory.start, memory.len, model.start, model.len, &config));
    for (i = 0; i < frames.count; i++) {
        const posewise_frame f = clip_frame(&frames, i);
        outputs *out = &all[i];
        out->result.struct_size = out->smoothed.struct_size = sizeof out->result;
        IN_ENV(posewise_step(t, &f, &out->result));
        IN_ENV(posewise_smoothed(t, &out->smoothed));
        IN_ENV(posewise_landmarks(t, out->landmarks, POSEWISE_LANDMARKS));
        IN_ENV(posewise_smoothed_landmarks(t, out->smoothed_landmarks, POSEWISE_LANDMARKS));
        IN_ENV(posewise_animation(t, out->animation, POSEWISE_ANIMATIONS));
        IN_ENV(posewise_smoothed_animation(t, out->smoothed_animation, POSEWISE_ANIMATIONS));
        if (i == frames.count / 2)
            IN_ENV(posewise_set_intrinsics(t, &camera));
    }
    IN_ENV(posewise_forget_identity(t));
    IN_ENV(posewise_reset(t));
    IN_ENV(posewise_config_default(&config));
    set_float_env(env);
    i = posewise_memory_size(&wrong);
    set_float_env(float_envs[0]);
    CHECK(i == 0);
    guarded_free(memory);
}

int main(int argc, char **argv) {
    outputs *expected, *got;
    size_t i, k;
    if (argc != 5)
        return 2;
    model = guarded_file(argv[1]);
    frames = clip_read(argv[2], argv[3], argv[4]);
    expected = calloc(frames.count, sizeof *expected);
    got = calloc(frames.count, sizeof *got);
    if (expected == NULL || got == NULL)
        return 2;
    set_float_env(float_envs[0]);
    track(float_envs[0], expected);
    for (i = 1; i < FLOAT_ENVS; i++) {
        track(float_envs[i], got);
        for (k = 0; k < frames.count; k++)
            if (memcmp(&got[k], &expected[k], sizeof got[k]) != 0) {
                printf("environment %08lx: frame %lu differs\n", (unsigned long)float_envs[i],
                       (unsigned long)k);
                failures++;
                break;
            }
    }
    printf("# %u environments\n", (unsigned)FLOAT_ENVS);
    free(expected);
    free(got);
    guarded_free(model);
    guarded_free(frames.bytes);
    return failures != 0;
}
