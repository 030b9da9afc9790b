/* abi.c - checks sizes and offsets of every struct at compile time. They depend on the width of a
 * pointer only, not on compiler or machine. */
#include "posewise.h"

#define HOLDS(name, condition) typedef char name[(condition) ? 1 : -1]
#define SIZE(type, bytes) HOLDS(type##_size, sizeof(type) == (bytes))
#define FIELD(type, field, at) HOLDS(type##_##field, offsetof(type, field) == (at))

HOLDS(posewise_status_size, sizeof(posewise_status) == 4);

SIZE(posewise_intrinsics, 16);
FIELD(posewise_intrinsics, fx, 0);
FIELD(posewise_intrinsics, fy, 4);
FIELD(posewise_intrinsics, cx, 8);
FIELD(posewise_intrinsics, cy, 12);

SIZE(posewise_roi, 16);
SIZE(posewise_lens, 24);
FIELD(posewise_lens, model, 0);
FIELD(posewise_lens, coefficients, 4);

SIZE(posewise_config, 84);
FIELD(posewise_config, struct_size, 0);
FIELD(posewise_config, flags, 4);
FIELD(posewise_config, min_face_px, 8);
FIELD(posewise_config, scan_budget, 12);
FIELD(posewise_config, intrinsics, 16);
FIELD(posewise_config, smoothing_hz, 32);
FIELD(posewise_config, smoothing_beta, 36);
FIELD(posewise_config, lens, 40);
FIELD(posewise_config, gaze, 64);
FIELD(posewise_config, roi, 68);

SIZE(posewise_frame, 40 + sizeof(size_t) + sizeof(void *));
FIELD(posewise_frame, struct_size, 0);
FIELD(posewise_frame, format, 4);
FIELD(posewise_frame, timestamp_us, 8);
FIELD(posewise_frame, width, 16);
FIELD(posewise_frame, height, 20);
FIELD(posewise_frame, stride, 24);
FIELD(posewise_frame, rotation_deg, 28);
FIELD(posewise_frame, flags, 32);
FIELD(posewise_frame, reserved, 36);
FIELD(posewise_frame, data_len, 40);
FIELD(posewise_frame, data, 40 + sizeof(size_t));

SIZE(posewise_result, 304);
FIELD(posewise_result, struct_size, 0);
FIELD(posewise_result, state, 4);
FIELD(posewise_result, timestamp_us, 8);
FIELD(posewise_result, age_us, 16);
FIELD(posewise_result, landmark_count, 24);
FIELD(posewise_result, confidence, 28);
FIELD(posewise_result, face_box, 32);
FIELD(posewise_result, rotation, 48);
FIELD(posewise_result, yaw_deg, 64);
FIELD(posewise_result, pitch_deg, 68);
FIELD(posewise_result, roll_deg, 72);
FIELD(posewise_result, translation_mm, 76);
FIELD(posewise_result, eye_open, 88);
FIELD(posewise_result, loss, 96);
FIELD(posewise_result, visible_share, 100);
FIELD(posewise_result, rotation_sigma_deg, 104);
FIELD(posewise_result, translation_sigma_mm, 116);
FIELD(posewise_result, eye_open_probability, 128);
FIELD(posewise_result, eye_status, 136);
FIELD(posewise_result, iris_left, 144);
FIELD(posewise_result, iris_right, 152);
FIELD(posewise_result, gaze_status, 160);
FIELD(posewise_result, gaze_sigma_deg, 172);
FIELD(posewise_result, gaze_left, 184);
FIELD(posewise_result, gaze_right, 196);
FIELD(posewise_result, gaze, 208);
FIELD(posewise_result, gaze_head, 220);
FIELD(posewise_result, glasses, 232);
FIELD(posewise_result, dark_glasses, 236);
FIELD(posewise_result, eye_look, 240);
FIELD(posewise_result, facing_yaw_deg, 272);
FIELD(posewise_result, facing_pitch_deg, 276);
FIELD(posewise_result, facing_roll_deg, 280);
FIELD(posewise_result, facing_sigma_deg, 284);
FIELD(posewise_result, focal_px, 296);
FIELD(posewise_result, camera_assumed, 300);

SIZE(posewise_face, 28);
SIZE(posewise_landmark, 28);
FIELD(posewise_landmark, x, 0);
FIELD(posewise_landmark, y, 4);
FIELD(posewise_landmark, confidence, 8);
FIELD(posewise_landmark, visibility, 12);
FIELD(posewise_landmark, x_mm, 16);
FIELD(posewise_landmark, y_mm, 20);
FIELD(posewise_landmark, z_mm, 24);

SIZE(posewise_event, 40);
FIELD(posewise_event, timestamp_us, 0);
FIELD(posewise_event, kind, 8);
FIELD(posewise_event, loss, 12);
FIELD(posewise_event, face_box, 16);
FIELD(posewise_event, confidence, 32);
FIELD(posewise_event, reserved, 36);

SIZE(posewise_monitor_config, 136);
FIELD(posewise_monitor_config, struct_size, 0);
FIELD(posewise_monitor_config, flags, 4);
FIELD(posewise_monitor_config, preset, 8);
FIELD(posewise_monitor_config, gap_us, 12);
FIELD(posewise_monitor_config, min_confidence, 16);
FIELD(posewise_monitor_config, eye_yaw_deg, 20);
FIELD(posewise_monitor_config, eye_pitch_deg, 24);
FIELD(posewise_monitor_config, closed_below, 28);
FIELD(posewise_monitor_config, open_above, 32);
FIELD(posewise_monitor_config, blink_us, 36);
FIELD(posewise_monitor_config, long_closure_us, 40);
FIELD(posewise_monitor_config, microsleep_us, 44);
FIELD(posewise_monitor_config, sleep_us, 48);
FIELD(posewise_monitor_config, unresponsive_us, 52);
FIELD(posewise_monitor_config, drowsy_p80_60, 56);
FIELD(posewise_monitor_config, drowsy_p80_180, 60);
FIELD(posewise_monitor_config, awake_share, 64);
FIELD(posewise_monitor_config, min_known, 68);
FIELD(posewise_monitor_config, yawn_above, 72);
FIELD(posewise_monitor_config, yawn_below, 76);
FIELD(posewise_monitor_config, yawn_us, 80);
FIELD(posewise_monitor_config, yawn_max_us, 84);
FIELD(posewise_monitor_config, nod_deg, 88);
FIELD(posewise_monitor_config, nod_us, 92);
FIELD(posewise_monitor_config, forward_yaw_deg, 96);
FIELD(posewise_monitor_config, forward_pitch_deg, 100);
FIELD(posewise_monitor_config, natural_yaw_deg, 104);
FIELD(posewise_monitor_config, natural_pitch_deg, 108);
FIELD(posewise_monitor_config, zone_margin_deg, 112);
FIELD(posewise_monitor_config, long_glance_us, 116);
FIELD(posewise_monitor_config, cumulative_us, 120);
FIELD(posewise_monitor_config, return_us, 124);
FIELD(posewise_monitor_config, clear_us, 128);
FIELD(posewise_monitor_config, degraded_us, 132);

SIZE(posewise_monitor_zone, 48);
FIELD(posewise_monitor_zone, kind, 0);
FIELD(posewise_monitor_zone, flags, 4);
FIELD(posewise_monitor_zone, grace_us, 8);
FIELD(posewise_monitor_zone, numbers, 12);

SIZE(posewise_monitor_observation, 60);
FIELD(posewise_monitor_observation, struct_size, 0);
FIELD(posewise_monitor_observation, state, 4);
FIELD(posewise_monitor_observation, confidence, 8);
FIELD(posewise_monitor_observation, yaw_deg, 12);
FIELD(posewise_monitor_observation, pitch_deg, 16);
FIELD(posewise_monitor_observation, translation_mm, 20);
FIELD(posewise_monitor_observation, rotation_sigma_deg, 32);
FIELD(posewise_monitor_observation, eye_open, 44);
FIELD(posewise_monitor_observation, jaw_open, 52);
FIELD(posewise_monitor_observation, camera_assumed, 56);

SIZE(posewise_monitor_perclos, 24);
FIELD(posewise_monitor_perclos, p70, 0);
FIELD(posewise_monitor_perclos, p80, 4);
FIELD(posewise_monitor_perclos, em, 8);
FIELD(posewise_monitor_perclos, known, 12);
FIELD(posewise_monitor_perclos, closures, 16);
FIELD(posewise_monitor_perclos, mean_closure_us, 20);

SIZE(posewise_monitor_state, 216);
FIELD(posewise_monitor_state, struct_size, 0);
FIELD(posewise_monitor_state, eyes, 4);
FIELD(posewise_monitor_state, timestamp_us, 8);
FIELD(posewise_monitor_state, eyes_reason, 16);
FIELD(posewise_monitor_state, openness, 20);
FIELD(posewise_monitor_state, closure_us, 24);
FIELD(posewise_monitor_state, blinks, 28);
FIELD(posewise_monitor_state, yawns, 32);
FIELD(posewise_monitor_state, nods, 36);
FIELD(posewise_monitor_state, mouth_open_us, 40);
FIELD(posewise_monitor_state, zone, 44);
FIELD(posewise_monitor_state, zone_us, 48);
FIELD(posewise_monitor_state, away_us, 52);
FIELD(posewise_monitor_state, away_30_us, 56);
FIELD(posewise_monitor_state, natural_is_final, 60);
FIELD(posewise_monitor_state, from_road_deg, 64);
FIELD(posewise_monitor_state, natural_deg, 72);
FIELD(posewise_monitor_state, open_eye, 80);
FIELD(posewise_monitor_state, open_eye_is_final, 88);
FIELD(posewise_monitor_state, drowsiness, 92);
FIELD(posewise_monitor_state, degraded, 96);
FIELD(posewise_monitor_state, reserved, 100);
FIELD(posewise_monitor_state, zones_us, 104);
FIELD(posewise_monitor_state, perclos_60, 168);
FIELD(posewise_monitor_state, perclos_180, 192);

SIZE(posewise_monitor_event, 40);
FIELD(posewise_monitor_event, timestamp_us, 0);
FIELD(posewise_monitor_event, start_us, 8);
FIELD(posewise_monitor_event, duration_us, 16);
FIELD(posewise_monitor_event, kind, 20);
FIELD(posewise_monitor_event, zone, 24);
FIELD(posewise_monitor_event, flags, 28);
FIELD(posewise_monitor_event, value, 32);
FIELD(posewise_monitor_event, reserved, 36);
