/* y4m.c - tracks the face of a y4m video on standard input and prints one CSV line per frame.
 *
 *     ffmpeg -v error -i face.mp4 -pix_fmt yuv420p -f yuv4mpegpipe - | ./y4m [MODEL] > face.csv
 *
 * MODEL is a .posewise file; without it, the model built into the library is used.
 * Reads 8-bit mono, 4:2:0, 4:1:1, 4:2:2 and 4:4:4. C99, nothing but the standard library. */
#include "posewise.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    uint32_t width, height;
    uint32_t fps_num, fps_den;
    size_t frame_len; /* luma and chroma [bytes] */
} video;

static void *aligned_alloc_or_exit(size_t len) {
    /* C99 has no aligned_alloc. This program frees nothing, so it drops the start of the block. */
    char *memory = malloc(len + POSEWISE_ALIGN);
    if (memory == NULL) {
        fprintf(stderr, "y4m: out of memory\n");
        exit(1);
    }
    return memory + (POSEWISE_ALIGN - (uintptr_t)memory % POSEWISE_ALIGN);
}

static void *read_file(const char *path, size_t *len) {
    FILE *file = fopen(path, "rb");
    void *bytes;
    long size;
    if (file == NULL || fseek(file, 0, SEEK_END) != 0 || (size = ftell(file)) < 0) {
        fprintf(stderr, "y4m: cannot open %s\n", path);
        exit(1);
    }
    rewind(file);
    *len = (size_t)size;
    bytes = aligned_alloc_or_exit(*len);
    if (fread(bytes, 1, *len, file) != *len) {
        fprintf(stderr, "y4m: cannot read %s\n", path);
        exit(1);
    }
    fclose(file);
    return bytes;
}

/* Bytes of a frame in this colour space ("420jpeg", "mono", ...); 0 if it is not supported. */
static size_t frame_len(const char *colour, size_t width, size_t height) {
    const size_t luma = width * height;
    const size_t half_width = (width + 1) / 2, half_height = (height + 1) / 2;
    if (strcmp(colour, "mono") == 0)
        return luma;
    if (strcmp(colour, "420") == 0 || strcmp(colour, "420jpeg") == 0 ||
        strcmp(colour, "420mpeg2") == 0 || strcmp(colour, "420paldv") == 0)
        return luma + 2 * half_width * half_height;
    if (strcmp(colour, "411") == 0)
        return luma + 2 * ((width + 3) / 4) * height;
    if (strcmp(colour, "422") == 0)
        return luma + 2 * half_width * height;
    if (strcmp(colour, "444") == 0)
        return 3 * luma;
    return 0;
}

/* Reads "YUV4MPEG2 W640 H480 F30:1 C420jpeg ..."; 0 if the header is invalid. */
static int read_header(FILE *in, video *v) {
    char line[512], colour[32] = "420";
    char *word;
    if (fgets(line, sizeof line, in) == NULL || strncmp(line, "YUV4MPEG2 ", 10) != 0)
        return 0;
    v->fps_num = 30;
    v->fps_den = 1;
    for (word = strtok(line + 10, " \n"); word != NULL; word = strtok(NULL, " \n")) {
        if (word[0] == 'W')
            v->width = (uint32_t)strtoul(word + 1, NULL, 10);
        else if (word[0] == 'H')
            v->height = (uint32_t)strtoul(word + 1, NULL, 10);
        else if (word[0] == 'F')
            sscanf(word + 1, "%u:%u", &v->fps_num, &v->fps_den);
        else if (word[0] == 'C')
            snprintf(colour, sizeof colour, "%s", word + 1);
    }
    if (v->width < 1 || v->width > 16384 || v->height < 1 || v->height > 16384)
        return 0;
    if (v->fps_num == 0 || v->fps_den == 0) /* "0:0" means unknown */
        v->fps_num = 30, v->fps_den = 1;
    v->frame_len = frame_len(colour, v->width, v->height);
    return v->frame_len != 0;
}

/* Reads "FRAME ...\n" and the pixels: 1; 0 at the end; -1 if the video is truncated or corrupt. */
static int read_frame(FILE *in, const video *v, uint8_t *pixels) {
    char line[512];
    if (fgets(line, sizeof line, in) == NULL)
        return 0;
    if (strncmp(line, "FRAME", 5) != 0 || strchr(line, '\n') == NULL)
        return -1;
    return fread(pixels, 1, v->frame_len, in) == v->frame_len ? 1 : -1;
}

static void print_header(void) {
    unsigned i;
    printf("frame,timestamp_us,state,yaw_deg,pitch_deg,roll_deg,tx_mm,ty_mm,tz_mm,confidence");
    for (i = 0; i < POSEWISE_LANDMARKS; i++)
        printf(",x_%u", i);
    for (i = 0; i < POSEWISE_LANDMARKS; i++)
        printf(",y_%u", i);
    printf("\n");
}

static void print_row(unsigned long frame, const posewise_result *r, const posewise_landmark *l) {
    static const char *const states[] = {"searching", "tracking", "coasting"};
    unsigned i;
    /* Nine digits represent a float exactly. */
    printf("%lu,%lld,%s,%.9g,%.9g,%.9g", frame, (long long)r->timestamp_us, states[r->state % 3],
           (double)r->yaw_deg, (double)r->pitch_deg, (double)r->roll_deg);
    printf(",%.9g,%.9g,%.9g,%.9g", (double)r->translation_mm[0], (double)r->translation_mm[1],
           (double)r->translation_mm[2], (double)r->confidence);
    for (i = 0; i < POSEWISE_LANDMARKS; i++)
        printf(",%.9g", (double)l[i].x);
    for (i = 0; i < POSEWISE_LANDMARKS; i++)
        printf(",%.9g", (double)l[i].y);
    printf("\n");
}

int main(int argc, char **argv) {
    posewise_landmark landmarks[POSEWISE_LANDMARKS];
    posewise_result result = POSEWISE_RESULT_INIT;
    posewise_frame frame = POSEWISE_FRAME_INIT;
    posewise_tracker *tracker;
    posewise_status status;
    const void *model;
    size_t model_len;
    const size_t memory_len = posewise_memory_size(NULL);
    void *memory = aligned_alloc_or_exit(memory_len);
    uint8_t *pixels;
    video v = {0};
    unsigned long index = 0;
    int got;

    model = argc > 1 ? read_file(argv[1], &model_len) : posewise_default_model(&model_len);
    status = posewise_init(&tracker, memory, memory_len, model, model_len, NULL);
    if (status < 0) {
        fprintf(stderr, "y4m: %s\n", posewise_strerror(status));
        return 1;
    }
    if (!read_header(stdin, &v)) {
        fprintf(stderr, "y4m: standard input is not an 8-bit y4m video\n");
        return 1;
    }
    pixels = aligned_alloc_or_exit(v.frame_len);
    frame.format = POSEWISE_FMT_GREY; /* planar: luma comes first, chroma is not passed */
    frame.width = v.width;
    frame.height = v.height;
    frame.stride = v.width;
    frame.data_len = (size_t)v.width * v.height;
    frame.data = pixels;
    print_header();
    while ((got = read_frame(stdin, &v, pixels)) == 1) {
        frame.timestamp_us = (int64_t)((double)index * 1e6 * v.fps_den / v.fps_num);
        status = posewise_step(tracker, &frame, &result);
        if (status == POSEWISE_OK)
            status = posewise_landmarks(tracker, landmarks, POSEWISE_LANDMARKS);
        if (status < 0) {
            fprintf(stderr, "y4m: frame %lu: %s\n", index, posewise_strerror(status));
            return 1;
        }
        print_row(index++, &result, landmarks);
    }
    if (got < 0) {
        fprintf(stderr, "y4m: the video is truncated or corrupt at frame %lu\n", index);
        return 1;
    }
    if (index == 0) {
        fprintf(stderr, "y4m: the video has no frames\n");
        return 1;
    }
    return 0;
}
