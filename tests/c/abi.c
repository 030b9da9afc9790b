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

SIZE(posewise_config, 64);
FIELD(posewise_config, struct_size, 0);
FIELD(posewise_config, flags, 4);
FIELD(posewise_config, min_face_px, 8);
FIELD(posewise_config, scan_budget, 12);
FIELD(posewise_config, intrinsics, 16);
FIELD(posewise_config, smoothing_hz, 32);
FIELD(posewise_config, smoothing_beta, 36);
FIELD(posewise_config, lens, 40);

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

SIZE(posewise_result, 128);
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
