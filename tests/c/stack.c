/* stack.c MODEL FRAMES WIDTH HEIGHT - prints the deepest stack of posewise_init and posewise_step.
 * Each call runs on a thread whose stack was painted before. POSIX. */
#define _POSIX_C_SOURCE 200809L
#include "check.h"

#include <pthread.h>

#define STACK_LEN (2u << 20)
#define PAINT 0xC3

static guarded model, memory;
static clip frames;
static posewise_tracker *tracker;

static void *nothing(void *unused) {
    return unused;
}

static void *run_init(void *unused) {
    CHECK_STATUS(
        posewise_init(&tracker, memory.start, memory.len, model.start, model.len, NULL), 0);
    return unused;
}

static void *run_steps(void *unused) {
    static posewise_result result;
    size_t i;
    result.struct_size = sizeof result;
    for (i = 0; i < frames.count; i++) {
        posewise_frame f = clip_frame(&frames, i);
        CHECK_STATUS(posewise_step(tracker, &f, &result), POSEWISE_OK);
    }
    return unused;
}

/* Bytes of stack that the thread touched. */
static size_t measure(void *(*run)(void *)) {
    static uint8_t stack[STACK_LEN] __attribute__((aligned(4096)));
    pthread_attr_t attributes;
    pthread_t thread;
    size_t untouched = 0;
    memset(stack, PAINT, sizeof stack);
    if (pthread_attr_init(&attributes) != 0 ||
        pthread_attr_setstack(&attributes, stack, sizeof stack) != 0 ||
        pthread_create(&thread, &attributes, run, NULL) != 0 || pthread_join(thread, NULL) != 0)
        exit(2);
    while (untouched < sizeof stack && stack[untouched] == PAINT)
        untouched++;
    return sizeof stack - untouched;
}

int main(int argc, char **argv) {
    size_t thread_itself;
    if (argc != 5)
        return 2;
    model = guarded_file(argv[1]);
    frames = clip_read(argv[2], argv[3], argv[4]);
    memory = guarded_new(posewise_memory_size(NULL), 0);
    thread_itself = measure(nothing);
    printf("memory %zu\n", posewise_memory_size(NULL));
    printf("init %zu\n", measure(run_init) - thread_itself);
    printf("step %zu\n", measure(run_steps) - thread_itself);
    guarded_free(memory);
    guarded_free(model);
    guarded_free(frames.bytes);
    return failures != 0;
}
