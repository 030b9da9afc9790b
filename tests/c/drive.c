/* drive.c MINUTES - shows a driver monitor a simulated drive of MINUTES, and prints a hash
 * of all its states and events. The line is the same on every machine. C99. */
#include "posewise.h"
#include "hash.h"

#include <stdio.h>
#include <stdlib.h>

static uint8_t memory[POSEWISE_MONITOR_SIZE + POSEWISE_ALIGN];

/* Xorshift; no floating point, so that each machine draws the same. */
static uint32_t random_state = 2463534242u;

static uint32_t below(uint32_t limit) {
    random_state ^= random_state << 13;
    random_state ^= random_state >> 17;
    random_state ^= random_state << 5;
    return random_state % limit;
}

/* A number from low to high in steps of 1/16, which floats hold exactly. */
static float between(int low, int high) {
    return (float)(low * 16 + (int)below((uint32_t)(high - low) * 16 + 1)) / 16.0f;
}

/* What the driver does for a while [us]. */
enum { DRIVES, SHUTS, DROOPS, YAWNS, GLANCES, NODS, IS_LOST, IS_UNSURE, ACTS };

static int64_t act_length(uint32_t act) {
    switch (act) {
    case SHUTS:
        return 60000 + 1000 * (int64_t)below(below(4) ? 400 : 7000);
    case IS_LOST:
        return 100000 + 1000 * (int64_t)below(below(6) ? 3000 : 150000);
    case YAWNS:
        return 1500000 + 1000 * (int64_t)below(4000);
    default:
        return 500000 + 1000 * (int64_t)below(5000);
    }
}

static posewise_monitor_observation seen_in(uint32_t act) {
    posewise_monitor_observation o = POSEWISE_MONITOR_OBSERVATION_INIT;
    const float open = act == SHUTS ? 0 : act == DROOPS ? 0.375f : 0.8125f;
    o.state = act == IS_LOST ? POSEWISE_SEARCHING : POSEWISE_TRACKING;
    o.confidence = act == IS_UNSURE ? 0.25f : 0.9375f;
    o.yaw_deg = (act == GLANCES ? 35 : 0) + between(-4, 4);
    o.pitch_deg = (act == NODS ? -25 : 0) + between(-3, 3);
    o.translation_mm[0] = between(-40, 40);
    o.translation_mm[2] = between(600, 700);
    o.rotation_sigma_deg[0] = o.rotation_sigma_deg[1] = o.rotation_sigma_deg[2] = 2;
    o.eye_open[0] = below(40) ? open + (float)below(128) / 1024.0f : -1;
    o.eye_open[1] = below(40) ? open + (float)below(128) / 1024.0f : -1;
    if (act == NODS)
        o.eye_open[0] = o.eye_open[1] = 0.0625f;
    o.jaw_open = act == YAWNS ? 0.75f : 0.125f;
    return o;
}

int main(int argc, char **argv) {
    uint8_t *aligned = memory + (POSEWISE_ALIGN - (uintptr_t)memory % POSEWISE_ALIGN);
    const int64_t length_us = argc == 2 ? strtol(argv[1], NULL, 10) * INT64_C(60000000) : 0;
    posewise_monitor_event events[POSEWISE_MONITOR_EVENTS];
    posewise_monitor_state state = POSEWISE_MONITOR_STATE_INIT;
    posewise_monitor *monitor;
    posewise_status status =
        posewise_monitor_init(&monitor, aligned, POSEWISE_MONITOR_SIZE, NULL);
    unsigned long steps = 0, noticed = 0;
    int64_t now = 0, act_ends = 0;
    uint32_t act = DRIVES;
    while (status == POSEWISE_OK && now < length_us) {
        posewise_monitor_observation seen;
        size_t count = 0, overwritten = 0;
        if (now >= act_ends) {
            act = act == DRIVES ? below(ACTS) : DRIVES;
            act_ends = now + act_length(act);
        }
        seen = seen_in(act);
        status = posewise_monitor_update(monitor, &seen, now);
        if (status == POSEWISE_OK)
            status = posewise_monitor_events(monitor, events, POSEWISE_MONITOR_EVENTS, &count,
                                             &overwritten);
        if (status == POSEWISE_OK)
            status = posewise_monitor_read(monitor, &state);
        hash_bytes(&state, sizeof state);
        hash_bytes(events, count * sizeof *events);
        steps++;
        noticed += (unsigned long)count;
        /* 25 frames a second with jitter, dropped frames, and a clock that is set back once. */
        now += 40000 + below(4000) + (below(20) ? 0 : 200000);
        if (steps == 20000)
            now -= 3000000;
    }
    if (status != POSEWISE_OK || noticed == 0) {
        fprintf(stderr, "drive: %s\n", posewise_strerror(status));
        return 1;
    }
    print_hash();
    printf(" %lu observations, %lu events\n", steps, noticed);
    return 0;
}
