/* layout.c - prints size and offsets of every struct, to be compared with those in Rust. */
#include "posewise.h"

#include <stdio.h>

#define SIZE(type) printf(#type " %u\n", (unsigned)sizeof(type))
#define FIELD(type, field) printf(#type "." #field " %u\n", (unsigned)offsetof(type, field))

int main(void) {
    SIZE(posewise_intrinsics);
    FIELD(posewise_intrinsics, fx);
    FIELD(posewise_intrinsics, fy);
    FIELD(posewise_intrinsics, cx);
    FIELD(posewise_intrinsics, cy);
    SIZE(posewise_roi);
    FIELD(posewise_roi, x);
    FIELD(posewise_roi, y);
    FIELD(posewise_roi, width);
    FIELD(posewise_roi, height);
    SIZE(posewise_lens);
    FIELD(posewise_lens, model);
    FIELD(posewise_lens, coefficients);
    SIZE(posewise_config);
    FIELD(posewise_config, struct_size);
    FIELD(posewise_config, flags);
    FIELD(posewise_config, min_face_px);
    FIELD(posewise_config, scan_budget);
    FIELD(posewise_config, intrinsics);
    FIELD(posewise_config, smoothing_hz);
    FIELD(posewise_config, smoothing_beta);
    FIELD(posewise_config, lens);
    SIZE(posewise_frame);
    FIELD(posewise_frame, struct_size);
    FIELD(posewise_frame, format);
    FIELD(posewise_frame, timestamp_us);
    FIELD(posewise_frame, width);
    FIELD(posewise_frame, height);
    FIELD(posewise_frame, stride);
    FIELD(posewise_frame, rotation_deg);
    FIELD(posewise_frame, flags);
    FIELD(posewise_frame, reserved);
    FIELD(posewise_frame, data_len);
    FIELD(posewise_frame, data);
    SIZE(posewise_hint);
    FIELD(posewise_hint, struct_size);
    FIELD(posewise_hint, face_box);
    FIELD(posewise_hint, yaw_deg);
    FIELD(posewise_hint, roll_deg);
    SIZE(posewise_result);
    FIELD(posewise_result, struct_size);
    FIELD(posewise_result, state);
    FIELD(posewise_result, timestamp_us);
    FIELD(posewise_result, age_us);
    FIELD(posewise_result, landmark_count);
    FIELD(posewise_result, confidence);
    FIELD(posewise_result, face_box);
    FIELD(posewise_result, rotation);
    FIELD(posewise_result, yaw_deg);
    FIELD(posewise_result, pitch_deg);
    FIELD(posewise_result, roll_deg);
    FIELD(posewise_result, translation_mm);
    FIELD(posewise_result, eye_open);
    FIELD(posewise_result, loss);
    FIELD(posewise_result, visible_share);
    FIELD(posewise_result, rotation_sigma_deg);
    FIELD(posewise_result, translation_sigma_mm);
    SIZE(posewise_face);
    FIELD(posewise_face, face_box);
    FIELD(posewise_face, yaw_deg);
    FIELD(posewise_face, roll_deg);
    FIELD(posewise_face, confidence);
    SIZE(posewise_landmark);
    FIELD(posewise_landmark, x);
    FIELD(posewise_landmark, y);
    FIELD(posewise_landmark, confidence);
    FIELD(posewise_landmark, visibility);
    FIELD(posewise_landmark, x_mm);
    FIELD(posewise_landmark, y_mm);
    FIELD(posewise_landmark, z_mm);
    SIZE(posewise_event);
    FIELD(posewise_event, timestamp_us);
    FIELD(posewise_event, kind);
    FIELD(posewise_event, loss);
    FIELD(posewise_event, face_box);
    FIELD(posewise_event, confidence);
    FIELD(posewise_event, reserved);
    return 0;
}
