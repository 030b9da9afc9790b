/* monitor.c MODEL FRAMES WIDTH HEIGHT - calls every function of the driver monitor with all kinds
 * of invalid arguments, and checks what the settings and a tracker's observations do. Compiled as
 * C99, also with sanitizers. Prints each check that fails, nothing on success. */
#include "guarded.h"

#include <limits.h>
#include <math.h>

static guarded monitor_memory(uint8_t fill) {
    return guarded_new(posewise_monitor_memory_size(NULL), fill);
}

static posewise_monitor *init(guarded memory, const posewise_monitor_config *config) {
    posewise_monitor *m = NULL;
    CHECK_STATUS(posewise_monitor_init(&m, memory.start, memory.len, config), POSEWISE_OK);
    CHECK((uint8_t *)m == memory.start);
    return m;
}

/* Eyes and yaw of a face that is tracked. */
static posewise_monitor_observation face(float eyes, float yaw_deg) {
    posewise_monitor_observation o = POSEWISE_MONITOR_OBSERVATION_INIT;
    o.state = POSEWISE_TRACKING;
    o.confidence = 1;
    o.yaw_deg = yaw_deg;
    o.translation_mm[2] = 700;
    o.eye_open[0] = o.eye_open[1] = eyes;
    return o;
}

static posewise_monitor_state state_of(const posewise_monitor *m) {
    posewise_monitor_state s = POSEWISE_MONITOR_STATE_INIT;
    CHECK_STATUS(posewise_monitor_read(m, &s), POSEWISE_OK);
    CHECK(s.struct_size == sizeof s);
    return s;
}

static void test_sizes(void) {
    const size_t need = posewise_monitor_memory_size(NULL);
    uint32_t kind;
    CHECK(need > 0 && need <= POSEWISE_MONITOR_SIZE && need % POSEWISE_ALIGN == 0);
    for (kind = 0; kind <= POSEWISE_MONITOR_EVENT_LOOK_DOWN_END; kind++)
        CHECK(strlen(posewise_monitor_event_name(kind)) > 2);
    CHECK(strcmp(posewise_monitor_event_name(POSEWISE_MONITOR_EVENT_LONG_GLANCE),
                 "long-glance") == 0);
    CHECK(posewise_monitor_event_name(kind) == NULL);
    CHECK(posewise_monitor_event_name(UINT32_MAX) == NULL);
}

static void config_rejected(const posewise_monitor_config *config, posewise_status expected) {
    guarded memory = monitor_memory(0xA5);
    posewise_monitor *m = NULL;
    CHECK(posewise_monitor_memory_size(config) == 0);
    CHECK_STATUS(posewise_monitor_init(&m, memory.start, memory.len, config), expected);
    CHECK(m == NULL && filled(memory.start, memory.len, 0xA5));
    guarded_free(memory);
}

static void test_config(void) {
    const posewise_monitor_config zero = POSEWISE_MONITOR_CONFIG_INIT;
    posewise_monitor_config c = zero, pair[2];
    uint32_t preset;
    memset(pair, 0, sizeof pair);
    for (preset = 0; preset <= POSEWISE_MONITOR_PRESET_EU_DDAW; preset++) {
        c = zero;
        CHECK_STATUS(posewise_monitor_config_default(preset, &c), POSEWISE_OK);
        CHECK(c.preset == preset && c.sleep_us == 3000000 && c.struct_size == sizeof c);
        CHECK(posewise_monitor_memory_size(&c) == posewise_monitor_memory_size(NULL));
        CHECK(c.flags == POSEWISE_EXACT);
        c.zone_margin_deg = 0;
        CHECK(posewise_monitor_memory_size(&c) == posewise_monitor_memory_size(NULL));
        CHECK((c.long_glance_us == 3500000) == (preset == POSEWISE_MONITOR_PRESET_EU_ADDW_FAST));
        CHECK((c.long_glance_us == 6000000) == (preset == POSEWISE_MONITOR_PRESET_EU_ADDW_SLOW));
    }
    c = zero;
    CHECK_STATUS(posewise_monitor_config_default(preset, &c), POSEWISE_E_MONITOR_CONFIG);
    CHECK_STATUS(posewise_monitor_config_default(0, NULL), POSEWISE_E_NULL);
    CHECK_STATUS(posewise_monitor_config_default(
                     0, (posewise_monitor_config *)(void *)((char *)pair + 1)),
                 POSEWISE_E_POINTER_ALIGN);
    CHECK_STATUS(posewise_monitor_config_default(0, pair), POSEWISE_E_STRUCT_SIZE);
    CHECK(posewise_monitor_memory_size(&zero) == posewise_monitor_memory_size(NULL));
#define REJECTED(change, code) c = zero, change, config_rejected(&c, code)
    REJECTED(c.struct_size = 0, POSEWISE_E_STRUCT_SIZE);
    REJECTED(c.struct_size += 4, POSEWISE_E_STRUCT_SIZE);
    REJECTED(c.flags = 4, POSEWISE_E_FLAGS);
    REJECTED(c.preset = 5, POSEWISE_E_MONITOR_CONFIG);
    REJECTED(c.gap_us = 99999, POSEWISE_E_MONITOR_CONFIG);
    REJECTED(c.closed_below = NAN, POSEWISE_E_MONITOR_CONFIG);
    REJECTED(c.closed_below = 0.5f, POSEWISE_E_MONITOR_CONFIG);
    REJECTED(c.min_confidence = -1, POSEWISE_E_MONITOR_CONFIG);
    REJECTED(c.microsleep_us = UINT32_MAX, POSEWISE_E_MONITOR_CONFIG);
    REJECTED(c.nod_deg = INFINITY, POSEWISE_E_MONITOR_CONFIG);
    REJECTED(c.forward_yaw_deg = 91, POSEWISE_E_MONITOR_CONFIG);
    REJECTED(c.cumulative_us = 30000001, POSEWISE_E_MONITOR_CONFIG);
    REJECTED(c.zones_by = POSEWISE_MONITOR_BY_NONE, POSEWISE_E_MONITOR_CONFIG);
    REJECTED(c.place = 3, POSEWISE_E_MONITOR_CONFIG);
    REJECTED(c.place_mm[1] = NAN, POSEWISE_E_MONITOR_CONFIG);
    REJECTED(c.place_radius_mm = 50, POSEWISE_E_MONITOR_CONFIG);
#undef REJECTED
}

static void test_init(void) {
    const size_t need = posewise_monitor_memory_size(NULL);
    guarded memory = guarded_new(need + 64, 0xA5);
    posewise_monitor *m = NULL;
    size_t i;
    CHECK_STATUS(posewise_monitor_init(NULL, memory.start, need, NULL), POSEWISE_E_NULL);
    CHECK_STATUS(posewise_monitor_init((posewise_monitor **)(void *)((char *)&m + 1), memory.start,
                                       need, NULL),
                 POSEWISE_E_POINTER_ALIGN);
    CHECK_STATUS(posewise_monitor_init(&m, NULL, need, NULL), POSEWISE_E_NULL);
    for (i = 1; i < 64; i++)
        CHECK_STATUS(posewise_monitor_init(&m, memory.start + i, need, NULL), POSEWISE_E_MEMORY);
    for (i = 0; i < need; i += 61)
        CHECK_STATUS(posewise_monitor_init(&m, memory.start, i, NULL), POSEWISE_E_MEMORY);
    for (i = 0; i < need; i += sizeof m)
        CHECK_STATUS(posewise_monitor_init((posewise_monitor **)(void *)(memory.start + i),
                                           memory.start, need, NULL),
                     POSEWISE_E_OVERLAP);
    CHECK(m == NULL && filled(memory.start, memory.len, 0xA5));
    CHECK_STATUS(posewise_monitor_init(&m, memory.start, need, NULL), POSEWISE_OK);
    CHECK(filled(memory.start + need, 64, 0xA5));
    guarded_free(memory);
}

/* Every function with a pointer that is not to a monitor. */
static void no_monitor(posewise_monitor *m) {
    const posewise_monitor_observation o = face(1, 0);
    posewise_monitor_state s = POSEWISE_MONITOR_STATE_INIT;
    posewise_monitor_event event;
    uint8_t record[POSEWISE_MONITOR_RECORD_SIZE];
    size_t count = 7, lost = 7;
    CHECK_STATUS(posewise_monitor_update(m, &o, 1), POSEWISE_E_ARG);
    CHECK_STATUS(posewise_monitor_read(m, &s), POSEWISE_E_ARG);
    CHECK_STATUS(posewise_monitor_events(m, &event, 1, &count, &lost), POSEWISE_E_ARG);
    CHECK_STATUS(posewise_monitor_set_zones(m, NULL, 0), POSEWISE_E_ARG);
    CHECK_STATUS(posewise_monitor_forget_driver(m), POSEWISE_E_ARG);
    CHECK_STATUS(posewise_monitor_save(m, record, sizeof record), POSEWISE_E_ARG);
    CHECK_STATUS(posewise_monitor_restore(m, record, sizeof record), POSEWISE_E_ARG);
    CHECK(count == 7 && lost == 7 && s.timestamp_us == 0);
}

static void test_no_monitor(const guarded *model) {
    static const uint8_t fills[] = {0x00, 0xFF, 0xA5};
    posewise_tracker *t;
    posewise_monitor_observation o = POSEWISE_MONITOR_OBSERVATION_INIT;
    guarded memory;
    size_t i;
    for (i = 0; i < sizeof fills; i++) {
        memory = monitor_memory(fills[i]);
        no_monitor((posewise_monitor *)(void *)memory.start);
        CHECK(filled(memory.start, memory.len, fills[i]));
        guarded_free(memory);
    }
    memory = monitor_memory(0);
    init(memory, NULL);
    no_monitor(NULL);
    no_monitor((posewise_monitor *)(void *)(memory.start + 1));
    no_monitor((posewise_monitor *)(void *)(memory.start + 64));
    /* A monitor is no tracker, and a tracker no monitor. */
    CHECK_STATUS(posewise_monitor_observe((posewise_tracker *)(void *)memory.start, &o),
                 POSEWISE_E_TRACKER);
    guarded_free(memory);
    memory = guarded_new(posewise_memory_size(NULL), 0);
    CHECK_STATUS(posewise_init(&t, memory.start, memory.len, model->start, model->len, NULL),
                 POSEWISE_OK);
    no_monitor((posewise_monitor *)(void *)t);
    guarded_free(memory);
}

static void test_pointers(void) {
    guarded memory = monitor_memory(0);
    posewise_monitor *m = init(memory, NULL);
    posewise_monitor_observation o = face(1, 0), pair[2];
    posewise_monitor_state s = POSEWISE_MONITOR_STATE_INIT;
    posewise_monitor_event e[4];
    size_t count = 7, lost = 7;
    void *const inside = memory.start + 128;
    memset(pair, 0, sizeof pair);
    CHECK_STATUS(posewise_monitor_update(m, NULL, 1), POSEWISE_E_NULL);
    CHECK_STATUS(posewise_monitor_update(
                     m, (posewise_monitor_observation *)(void *)((char *)pair + 2), 1),
                 POSEWISE_E_POINTER_ALIGN);
    CHECK_STATUS(posewise_monitor_update(m, pair, 1), POSEWISE_E_STRUCT_SIZE);
    CHECK_STATUS(posewise_monitor_update(m, &o, 1), POSEWISE_OK);
    CHECK_STATUS(posewise_monitor_update(m, &o, 1), POSEWISE_E_TIME);
    CHECK_STATUS(posewise_monitor_read(m, NULL), POSEWISE_E_NULL);
    s.struct_size = 0;
    CHECK_STATUS(posewise_monitor_read(m, &s), POSEWISE_E_STRUCT_SIZE);
    CHECK_STATUS(posewise_monitor_events(m, NULL, 3, &count, &lost), POSEWISE_E_NULL);
    CHECK_STATUS(posewise_monitor_events(m, e, 3, NULL, &lost), POSEWISE_E_NULL);
    CHECK_STATUS(posewise_monitor_events(m, e, 3, &count, NULL), POSEWISE_E_NULL);
    CHECK_STATUS(posewise_monitor_events(m, inside, 3, &count, &lost), POSEWISE_E_OVERLAP);
    CHECK_STATUS(posewise_monitor_events(m, e, 3, inside, &lost), POSEWISE_E_OVERLAP);
    CHECK_STATUS(posewise_monitor_events(m, e, 3, &count, inside), POSEWISE_E_OVERLAP);
    CHECK(count == 7 && lost == 7);
    CHECK_STATUS(posewise_monitor_events(m, e, SIZE_MAX, &count, &lost), POSEWISE_OK);
    CHECK(count == 0 && lost == 0);
    {
        /* The state would be written into the monitor. */
        posewise_monitor_state *own = inside;
        own->struct_size = sizeof *own;
        own->timestamp_us = 77;
        CHECK_STATUS(posewise_monitor_read(m, own), POSEWISE_E_OVERLAP);
        CHECK(own->timestamp_us == 77);
    }
    guarded_free(memory);
}

static void test_zones(void) {
    guarded memory = monitor_memory(0);
    posewise_monitor_config c = POSEWISE_MONITOR_CONFIG_INIT;
    posewise_monitor_observation o = face(1, 0);
    posewise_monitor *m;
    posewise_monitor_zone zones[POSEWISE_MONITOR_ZONES + 1] = {
        {POSEWISE_MONITOR_ZONE_BOX,
         POSEWISE_MONITOR_ZONE_ROAD,
         0,
         {-100, -100, -10, 100, 100, 10, 0, 0, 0}},
        {POSEWISE_MONITOR_ZONE_PLANE, 0, 0, {400, 0, 0, 100, 0, 0, 0, 200, 0}},
        {POSEWISE_MONITOR_ZONE_ANGLES, 0, UINT32_MAX, {-180, 180, -180, -30, 0, 0, 0, 0, 0}},
    };
    size_t i;
    c.flags = POSEWISE_MONITOR_FIXED_POSE;
    c.zones_by = POSEWISE_MONITOR_BY_HEAD;
    m = init(memory, &c);
    CHECK_STATUS(posewise_monitor_set_zones(m, NULL, 1), POSEWISE_E_NULL);
    CHECK_STATUS(posewise_monitor_set_zones(
                     m, (posewise_monitor_zone *)(void *)((char *)zones + 1), 1),
                 POSEWISE_E_POINTER_ALIGN);
    CHECK_STATUS(posewise_monitor_set_zones(m, zones, SIZE_MAX), POSEWISE_E_MONITOR_ZONES);
    CHECK_STATUS(posewise_monitor_set_zones(m, zones, POSEWISE_MONITOR_ZONES + 1),
                 POSEWISE_E_MONITOR_ZONES);
    /* The fourth is empty. */
    CHECK_STATUS(posewise_monitor_set_zones(m, zones, 4), POSEWISE_E_MONITOR_ZONES);
    zones[0].numbers[8] = 1;
    CHECK_STATUS(posewise_monitor_set_zones(m, zones, 3), POSEWISE_E_MONITOR_ZONES);
    zones[0].numbers[8] = 0, zones[0].kind = 3;
    CHECK_STATUS(posewise_monitor_set_zones(m, zones, 3), POSEWISE_E_MONITOR_ZONES);
    zones[0].kind = POSEWISE_MONITOR_ZONE_BOX, zones[0].flags = 2;
    CHECK_STATUS(posewise_monitor_set_zones(m, zones, 3), POSEWISE_E_FLAGS);
    zones[0].flags = POSEWISE_MONITOR_ZONE_ROAD, zones[1].numbers[3] = NAN;
    CHECK_STATUS(posewise_monitor_set_zones(m, zones, 3), POSEWISE_E_MONITOR_ZONES);
    zones[1].numbers[3] = 100;
    CHECK_STATUS(posewise_monitor_set_zones(m, zones, 3), POSEWISE_OK);
    for (i = 0; i < 4; i++) {
        static const float at[4][2] = {{0, 0}, {30, 0}, {0, -40}, {-40, 0}};
        static const uint32_t in[4] = {0, 1, 2, POSEWISE_MONITOR_ZONE_OUTSIDE};
        o.yaw_deg = at[i][0], o.pitch_deg = at[i][1];
        CHECK_STATUS(posewise_monitor_update(m, &o, (int64_t)i + 1), POSEWISE_OK);
        CHECK(state_of(m).zone == in[i] && state_of(m).zone_by == POSEWISE_MONITOR_BY_HEAD);
    }
    CHECK_STATUS(posewise_monitor_set_zones(m, NULL, 0), POSEWISE_OK);
    CHECK_STATUS(posewise_monitor_update(m, &o, 10), POSEWISE_OK);
    CHECK(state_of(m).zone == POSEWISE_MONITOR_ZONE_OUTSIDE);
    guarded_free(memory);
}

/* Closures, more events than the queue holds, a copy, another driver. */
static void test_events(void) {
    guarded memory = monitor_memory(0), copy = monitor_memory(0);
    posewise_monitor *m = init(memory, NULL), *second;
    posewise_monitor_event e[POSEWISE_MONITOR_EVENTS + 1];
    posewise_monitor_state s;
    const posewise_monitor_observation open = face(0.9f, 0), shut = face(0, 0);
    const uint32_t kinds[] = {POSEWISE_MONITOR_EVENT_LONG_CLOSURE,
                              POSEWISE_MONITOR_EVENT_MICROSLEEP,
                              POSEWISE_MONITOR_EVENT_CLOSURE_END};
    int64_t now = INT64_MIN;
    size_t count, lost, i;
    CHECK(state_of(m).eyes == POSEWISE_MONITOR_EYES_UNKNOWN);
    for (i = 0; i < 90; i++, now += 33333)
        CHECK_STATUS(posewise_monitor_update(m, i >= 30 && i < 75 ? &shut : &open, now),
                     POSEWISE_OK);
    memcpy(copy.start, memory.start, memory.len);
    second = (posewise_monitor *)(void *)copy.start;
    CHECK_STATUS(posewise_monitor_events(second, e, 8, &count, &lost), POSEWISE_OK);
    CHECK(count == 3 && lost == 0);
    for (i = 0; i < 3; i++)
        CHECK(e[i].kind == kinds[i] && e[i].start_us == INT64_MIN + 30 * 33333);
    CHECK(e[2].duration_us == 45 * 33333 && e[2].flags == 0 && e[2].reserved == 0);
    CHECK(e[2].zone == POSEWISE_MONITOR_ZONE_UNKNOWN);
    s = state_of(m);
    CHECK(s.eyes == POSEWISE_MONITOR_EYES_OPEN && s.blinks == 0 && s.perclos_60.closures == 0);
    for (i = 0; i < 40 * 20; i++, now += 33333)
        CHECK_STATUS(posewise_monitor_update(m, i % 20 < 5 ? &shut : &open, now), POSEWISE_OK);
    s = state_of(m);
    CHECK(s.blinks == 40 && s.perclos_60.p80 > 0.2f && s.perclos_60.known < 0.5f);
    CHECK_STATUS(posewise_monitor_events(m, e, POSEWISE_MONITOR_EVENTS + 1, &count, &lost),
                 POSEWISE_OK);
    CHECK(count == POSEWISE_MONITOR_EVENTS && lost == 43 - POSEWISE_MONITOR_EVENTS);
    CHECK_STATUS(posewise_monitor_update(m, &open, INT64_MAX), POSEWISE_OK);
    s = state_of(m);
    CHECK(s.timestamp_us == INT64_MAX && s.perclos_180.known == 0);
    CHECK_STATUS(posewise_monitor_update(m, &open, INT64_MIN), POSEWISE_OK);
    CHECK_STATUS(posewise_monitor_forget_driver(m), POSEWISE_OK);
    CHECK(state_of(m).blinks == 0);
    guarded_free(memory);
    guarded_free(copy);
}

/* What was learnt of a driver outlives the monitor; a record that is none changes nothing. */
static void test_record(void) {
    const posewise_monitor_observation ahead = face(0.9f, 20);
    uint8_t record[POSEWISE_MONITOR_RECORD_SIZE], before[POSEWISE_MONITOR_RECORD_SIZE];
    guarded memory = monitor_memory(0);
    posewise_monitor *m = init(memory, NULL);
    posewise_monitor_state s;
    size_t i;
    for (i = 0; i < 3000; i++)
        CHECK_STATUS(posewise_monitor_update(m, &ahead, (int64_t)i * 33333), POSEWISE_OK);
    s = state_of(m);
    CHECK(s.natural_is_final == 1 && s.open_eye_is_final == 1 && s.natural_deg[0] > 18);
    CHECK_STATUS(posewise_monitor_save(m, NULL, sizeof record), POSEWISE_E_NULL);
    CHECK_STATUS(posewise_monitor_save(m, record, sizeof record - 1), POSEWISE_E_CAPACITY);
    CHECK_STATUS(posewise_monitor_save(m, (uint8_t *)m, sizeof record), POSEWISE_E_OVERLAP);
    CHECK_STATUS(posewise_monitor_save(m, record, sizeof record), POSEWISE_OK);
    CHECK_STATUS(posewise_monitor_forget_driver(m), POSEWISE_OK);
    CHECK_STATUS(posewise_monitor_save(m, before, sizeof before), POSEWISE_OK);
    for (i = 0; i < sizeof record; i++) {
        const posewise_status expected = i < 8    ? POSEWISE_E_RECORD
                                         : i < 12 ? POSEWISE_E_RECORD_VERSION
                                                  : POSEWISE_E_RECORD_CHECKSUM;
        record[i] ^= 1;
        CHECK_STATUS(posewise_monitor_restore(m, record, sizeof record), expected);
        record[i] ^= 1;
        CHECK_STATUS(posewise_monitor_restore(m, record, i), POSEWISE_E_RECORD_SIZE);
    }
    CHECK_STATUS(posewise_monitor_restore(m, NULL, sizeof record), POSEWISE_E_NULL);
    CHECK(state_of(m).natural_deg[0] == 0);
    CHECK_STATUS(posewise_monitor_restore(m, record, sizeof record), POSEWISE_OK);
    CHECK_STATUS(posewise_monitor_update(m, &ahead, 0), POSEWISE_OK);
    s = state_of(m);
    CHECK(s.natural_is_final == 0 && s.open_eye_is_final == 0 && s.natural_deg[0] > 18);
    CHECK(s.zone == 0);
    CHECK_STATUS(posewise_monitor_restore(m, before, sizeof before), POSEWISE_OK);
    guarded_free(memory);
}

/* Numbers that no tracker gives. */
static void test_wild_observations(void) {
    static const float wild[] = {NAN, INFINITY, -INFINITY, 3e38f, -3e38f, 1e-40f, -1, 0, 1, 90};
    const size_t kinds = sizeof wild / sizeof *wild;
    guarded memory = monitor_memory(0);
    posewise_monitor *m = init(memory, NULL);
    uint32_t random = 1;
    int64_t now = 0;
    size_t i, k;
    for (i = 0; i < 20000; i++) {
        posewise_monitor_observation o = face(1, 0);
        float *const numbers = &o.confidence;
        posewise_monitor_state s;
        const float *shares;
        for (k = 0; k < 12; k++) {
            random = random * 1664525u + 1013904223u;
            if (random >> 24 < 64)
                memcpy((char *)numbers + 4 * k, &wild[(random >> 16) % kinds], 4);
        }
        o.state = random % 7 == 0 ? random : POSEWISE_TRACKING;
        now += (random >> 8) % 200000 + 1;
        if (random % 1000 == 0)
            now = (int64_t)((uint64_t)random << 33);
        CHECK(posewise_monitor_update(m, &o, now) <= 0);
        s = state_of(m);
        shares = &s.perclos_60.p70;
        for (k = 0; k < 4; k++)
            CHECK(shares[k] >= 0 && shares[k] <= 1);
        CHECK(s.openness == -1 || (s.openness >= 0 && s.openness <= 1));
        CHECK(fabsf(s.from_road_deg[0]) < 1e6f && fabsf(s.natural_deg[1]) <= 90);
    }
    guarded_free(memory);
}

/* What a tracker sees goes through. */
static void test_tracker(const guarded *model, const clip *frames) {
    guarded memory = guarded_new(posewise_memory_size(NULL), 0), own = monitor_memory(0);
    posewise_monitor *m = init(own, NULL);
    posewise_tracker *t;
    posewise_result r = POSEWISE_RESULT_INIT;
    posewise_monitor_observation o = POSEWISE_MONITOR_OBSERVATION_INIT, pair[2];
    size_t i, known = 0;
    memset(pair, 0, sizeof pair);
    CHECK_STATUS(posewise_init(&t, memory.start, memory.len, model->start, model->len, NULL),
                 POSEWISE_OK);
    CHECK_STATUS(posewise_monitor_observe(t, NULL), POSEWISE_E_NULL);
    CHECK_STATUS(posewise_monitor_observe(NULL, &o), POSEWISE_E_NULL);
    CHECK_STATUS(posewise_monitor_observe(t, pair), POSEWISE_E_STRUCT_SIZE);
    CHECK_STATUS(posewise_monitor_observe(
                     t, (posewise_monitor_observation *)(void *)((char *)pair + 1)),
                 POSEWISE_E_POINTER_ALIGN);
    for (i = 0; i < frames->count; i++) {
        const posewise_frame f = clip_frame(frames, i);
        CHECK_STATUS(posewise_step(t, &f, &r), POSEWISE_OK);
        CHECK_STATUS(posewise_monitor_observe(t, &o), POSEWISE_OK);
        CHECK(o.state == r.state && o.yaw_deg == r.yaw_deg);
        CHECK((o.eye_open[1] < 0) == (r.eye_open[1] < 0) && o.eye_open[1] <= 1);
        CHECK(o.eye_open[1] >= r.eye_open[1]);
        CHECK(o.jaw_open >= -1 && o.jaw_open <= 1 && o.struct_size == sizeof o);
        CHECK_STATUS(posewise_monitor_update(m, &o, f.timestamp_us), POSEWISE_OK);
        known += state_of(m).eyes != POSEWISE_MONITOR_EYES_UNKNOWN;
    }
    printf("# eyes known in %lu of %lu frames\n", (unsigned long)known,
           (unsigned long)frames->count);
    guarded_free(memory);
    guarded_free(own);
}

int main(int argc, char **argv) {
    guarded model;
    clip frames;
    if (argc != 5)
        return 2;
    model = guarded_file(argv[1]);
    frames = clip_read(argv[2], argv[3], argv[4]);
    test_sizes();
    test_config();
    test_init();
    test_no_monitor(&model);
    test_pointers();
    test_zones();
    test_events();
    test_record();
    test_wild_observations();
    test_tracker(&model, &frames);
    guarded_free(model);
    guarded_free(frames.bytes);
    return failures != 0;
}
