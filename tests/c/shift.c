/* shift.c [HOURS] - drives for 8 hours of simulated time: three drivers in turn, irregular frames
 * and drops, sun, passengers, stops. Checks that a driver monitor counts exactly what they do, that
 * what it learns does not drift, and that nothing of a driver is left after a change. Compiled as
 * C99, also with sanitizers. Prints each check that fails, nothing on success. */
#include "check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define HOUR_US  3600000000LL
#define CHANGE_US (HOUR_US / 2)

/* What a driver does next, and what happens. */
enum act { ALERT, BLINK, LONG, MICROSLEEP, SLEEP, YAWN, GLANCE, DARK, PASSENGER, DUCK, STOP };

typedef struct driver {
    float yaw_deg, pitch_deg, open, at_mm[3];
} driver;

static const driver drivers[] = {
    {-18, 4, 0.8f, {-60, 10, 640}},
    {6, -5, 0.92f, {40, -30, 720}},
    {13, 8, 1, {0, 40, 580}},
};

static uint32_t seed = 2463534242u;

/* From low to high, Marsaglia's xorshift. */
static float between(float low, float high) {
    seed ^= seed << 13, seed ^= seed >> 17, seed ^= seed << 5;
    return low + (high - low) * (float)(seed >> 8) / 16777216.0f;
}

typedef struct shift {
    posewise_monitor *monitor;
    int64_t now_us;
    const driver *at_wheel;
    uint32_t expected[POSEWISE_MONITOR_EVENT_LOOK_DOWN_END + 1];
    uint32_t counted[POSEWISE_MONITOR_EVENT_LOOK_DOWN_END + 1];
} shift;

static void show(shift *s, const posewise_monitor_observation *o, float longest_s) {
    posewise_monitor_event events[8];
    size_t count, lost, i;
    s->now_us += (int64_t)(1e6f * between(0.015f, longest_s));
    CHECK_STATUS(posewise_monitor_update(s->monitor, o, s->now_us), POSEWISE_OK);
    CHECK_STATUS(posewise_monitor_events(s->monitor, events, 8, &count, &lost), POSEWISE_OK);
    CHECK(lost == 0 && count <= 8);
    for (i = 0; i < count; i++)
        s->counted[events[i].kind]++;
}

static void go_on(shift *s, enum act act, float seconds) {
    const driver *d = s->at_wheel;
    const int64_t end_us = s->now_us + (int64_t)(1e6f * seconds);
    const int is_short = act == BLINK || act == LONG;
    int is_first = 1;
    while (s->now_us < end_us) {
        posewise_monitor_observation o = POSEWISE_MONITOR_OBSERVATION_INIT;
        const double sway = sin((double)s->now_us * 2e-7);
        float yaw = d->yaw_deg + 1.5f * (float)sway, pitch = d->pitch_deg, across;
        o.state = act == DUCK || act == STOP ? POSEWISE_SEARCHING : POSEWISE_TRACKING;
        o.confidence = 0.95f;
        if (act == GLANCE)
            yaw += 40;
        o.yaw_deg = yaw, o.pitch_deg = pitch;
        memcpy(o.translation_mm, d->at_mm, sizeof d->at_mm);
        o.translation_mm[0] += 15 * (float)sway;
        o.eye_open[0] = o.eye_open[1] = d->open * between(0.95f, 1.0f);
        o.jaw_open = between(0, 0.1f);
        if (act == BLINK || act == LONG || act == MICROSLEEP || act == SLEEP || act == PASSENGER)
            o.eye_open[0] = o.eye_open[1] = between(0, 0.05f);
        if (act == YAWN || act == PASSENGER)
            o.jaw_open = 0.85f;
        if (act == DARK)
            o.eye_open[0] = o.eye_open[1] = o.jaw_open = -1;
        if (act == PASSENGER)
            o.translation_mm[0] += 550;
        if (act != DARK) {
            across = cosf(pitch * 0.0174533f);
            o.gaze[0] = sinf(yaw * 0.0174533f) * across;
            o.gaze[1] = -sinf(pitch * 0.0174533f);
            o.gaze[2] = -cosf(yaw * 0.0174533f) * across;
            o.gaze_sigma_deg = 3;
        }
        /* Frames are dropped, but not where the length of a short closure is told by one. */
        show(s, &o, is_short || is_first || between(0, 1) < 0.95f ? 0.05f : 0.3f);
        is_first = 0;
    }
}

static void expect(shift *s, uint32_t kind) {
    s->expected[kind]++;
}

static void drive(shift *s) {
    const float chance = between(0, 1);
    const enum act act = chance < 0.6f    ? BLINK
                         : chance < 0.68f ? LONG
                         : chance < 0.71f ? MICROSLEEP
                         : chance < 0.72f ? SLEEP
                         : chance < 0.76f ? YAWN
                         : chance < 0.88f ? GLANCE
                         : chance < 0.92f ? DARK
                         : chance < 0.96f ? PASSENGER
                         : chance < 0.99f ? DUCK
                                          : STOP;
    /* At least and at most so long [s]. */
    static const float lengths[][2] = {{0, 0},   {0.15f, 0.35f}, {0.7f, 0.85f}, {1.4f, 2.2f},
                                       {3.6f, 5}, {2.5f, 4},      {0.9f, 2},     {1, 8},
                                       {1, 40},  {1, 5},         {60, 400}};
    go_on(s, act, between(lengths[act][0], lengths[act][1]));
    if (act == BLINK)
        expect(s, POSEWISE_MONITOR_EVENT_BLINK);
    if (act == LONG || act == MICROSLEEP || act == SLEEP) {
        expect(s, POSEWISE_MONITOR_EVENT_LONG_CLOSURE);
        expect(s, POSEWISE_MONITOR_EVENT_CLOSURE_END);
    }
    if (act == MICROSLEEP || act == SLEEP)
        expect(s, POSEWISE_MONITOR_EVENT_MICROSLEEP);
    if (act == SLEEP)
        expect(s, POSEWISE_MONITOR_EVENT_SLEEP);
    if (act == YAWN) {
        expect(s, POSEWISE_MONITOR_EVENT_YAWN);
        expect(s, POSEWISE_MONITOR_EVENT_YAWN_END);
    }
    if (act == GLANCE)
        expect(s, POSEWISE_MONITOR_EVENT_GLANCE);
    go_on(s, ALERT, between(2, 6));
}

static posewise_monitor_state state_of(const shift *s) {
    posewise_monitor_state state = POSEWISE_MONITOR_STATE_INIT;
    CHECK_STATUS(posewise_monitor_read(s->monitor, &state), POSEWISE_OK);
    return state;
}

/* What is learnt is that of who drives. */
static void check_learnt(const shift *s) {
    const posewise_monitor_state m = state_of(s);
    const driver *d = s->at_wheel;
    CHECK(m.natural_is_final && m.open_eye_is_final && m.place_is_final);
    CHECK(fabsf(m.natural_deg[0] - d->yaw_deg) < 2 && fabsf(m.natural_deg[1] - d->pitch_deg) < 2);
    CHECK(fabsf(m.natural_gaze_deg[0] - d->yaw_deg) < 2);
    CHECK(fabsf(m.open_eye[0] - 0.975f * d->open) < 0.03f);
    CHECK(fabsf(m.place_mm[0] - d->at_mm[0]) < 20 && fabsf(m.place_mm[2] - d->at_mm[2]) < 20);
}

static void check_counts(const shift *s) {
    static const uint32_t kinds[] = {
        POSEWISE_MONITOR_EVENT_BLINK,       POSEWISE_MONITOR_EVENT_LONG_CLOSURE,
        POSEWISE_MONITOR_EVENT_MICROSLEEP,  POSEWISE_MONITOR_EVENT_SLEEP,
        POSEWISE_MONITOR_EVENT_CLOSURE_END, POSEWISE_MONITOR_EVENT_UNRESPONSIVE,
        POSEWISE_MONITOR_EVENT_YAWN,        POSEWISE_MONITOR_EVENT_YAWN_END,
        POSEWISE_MONITOR_EVENT_GLANCE,      POSEWISE_MONITOR_EVENT_NOD,
        POSEWISE_MONITOR_EVENT_CLOCK_BACK,  POSEWISE_MONITOR_EVENT_LOOK_DOWN};
    size_t i;
    for (i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        const uint32_t kind = kinds[i];
        if (s->counted[kind] != s->expected[kind]) {
            printf("%s: %lu, not %lu\n", posewise_monitor_event_name(kind),
                   (unsigned long)s->counted[kind], (unsigned long)s->expected[kind]);
            failures++;
        }
    }
}

static uint8_t memory[POSEWISE_MONITOR_SIZE + POSEWISE_ALIGN];

int main(int argc, char **argv) {
    const double hours = argc > 1 ? atof(argv[1]) : 8;
    uint8_t *aligned = memory + (POSEWISE_ALIGN - (uintptr_t)memory % POSEWISE_ALIGN);
    shift s;
    int turn = 0;
    memset(&s, 0, sizeof s);
    CHECK_STATUS(posewise_monitor_init(&s.monitor, aligned, POSEWISE_MONITOR_SIZE, NULL),
                 POSEWISE_OK);
    if (failures > 0)
        return 1;
    while ((double)s.now_us < hours * (double)HOUR_US) {
        const int64_t until_us = s.now_us + CHANGE_US;
        const uint32_t blinks = s.counted[POSEWISE_MONITOR_EVENT_BLINK];
        const uint32_t yawns = s.counted[POSEWISE_MONITOR_EVENT_YAWN];
        posewise_monitor_state m;
        s.at_wheel = &drivers[turn++ % 3];
        CHECK_STATUS(posewise_monitor_forget_driver(s.monitor), POSEWISE_OK);
        m = state_of(&s);
        CHECK(!m.natural_is_final && !m.open_eye_is_final && !m.place_is_final);
        CHECK(m.open_eye[0] == 1 && m.natural_deg[0] == 0 && m.place_mm[2] == 0);
        CHECK(m.perclos_180.known == 0 && m.drowsiness == POSEWISE_MONITOR_DROWSINESS_UNKNOWN);
        go_on(&s, ALERT, 120);
        check_learnt(&s);
        while (s.now_us < until_us)
            drive(&s);
        check_learnt(&s);
        m = state_of(&s);
        CHECK(m.blinks == s.counted[POSEWISE_MONITOR_EVENT_BLINK] - blinks);
        CHECK(m.yawns == s.counted[POSEWISE_MONITOR_EVENT_YAWN] - yawns && m.nods == 0);
        go_on(&s, STOP, 30);
    }
    check_counts(&s);
    return failures != 0;
}
