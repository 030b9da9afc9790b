"""Structs and constants of include/posewise.h.

Generated. To change it, edit src/ffi and run
    POSEWISE_BLESS=1 cargo test --release --test source
"""

from __future__ import annotations

from ctypes import Structure, c_float, c_int64, c_size_t, c_uint32, c_void_p

ABI = 1
ALIGN = 64
LANDMARKS = 68
ANIMATIONS = 24
EYE_LOOKS = 8
UNREAD_EVENTS = 64

STATES = (
    "searching",
    "tracking",
    "coasting",
)
LOSSES = (
    "none",
    "low-confidence",
    "left-frame",
    "no-pose",
    "excluded",
)
EVENTS = (
    "acquired",
    "reacquired",
    "coasting",
    "lost",
    "suppressed",
    "filter-on",
    "filter-off",
    "reset",
    "forgotten",
)
EYES = (
    "not-seen",
    "known",
    "turned",
    "hidden",
    "small",
    "blurred",
    "glare",
    "dark-glasses",
    "shut",
    "uncertain",
)
LENSES = (
    "pinhole",
    "brown",
    "fisheye",
)
TERMS = (
    "unknown",
    "free",
    "research",
)

# Pixel formats by name.
FORMATS = {
    "GREY": 0x59455247,
    "Y10": 0x20303159,
    "Y16": 0x20363159,
    "YUYV": 0x56595559,
    "UYVY": 0x59565955,
    "NV12": 0x3231564E,
    "NV21": 0x3132564E,
    "YU12": 0x32315559,
    "RGB3": 0x33424752,
    "BGR3": 0x33524742,
    "XB24": 0x34324258,
    "AB24": 0x34324241,
    "XR24": 0x34325258,
    "AR24": 0x34325241,
    "BX24": 0x34325842,
    "BA24": 0x34324142,
    "RX24": 0x34325852,
    "RA24": 0x34324152,
}

# Bits of the optional parts by name.
PARTS = {
    "refiners": 1,
    "verifier": 2,
    "keyframes": 4,
    "monitor": 8,
    "default-model": 16,
}


class Intrinsics(Structure):
    _fields_ = [
        ("fx", c_float),
        ("fy", c_float),
        ("cx", c_float),
        ("cy", c_float),
    ]


class Lens(Structure):
    _fields_ = [
        ("model", c_uint32),
        ("coefficients", c_float * 5),
    ]


class Roi(Structure):
    _fields_ = [
        ("x", c_uint32),
        ("y", c_uint32),
        ("width", c_uint32),
        ("height", c_uint32),
    ]


class Config(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("flags", c_uint32),
        ("min_face_px", c_uint32),
        ("scan_budget", c_uint32),
        ("intrinsics", Intrinsics),
        ("smoothing_hz", c_float),
        ("smoothing_beta", c_float),
        ("lens", Lens),
        ("gaze", c_uint32),
        ("roi", Roi),
    ]


class Model_details(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("format_version", c_uint32),
        ("length", c_uint32),
        ("checksum", c_uint32),
        ("terms", c_uint32),
        ("section_count", c_uint32),
        ("sections", c_uint32 * 32),
        ("wrong_section", c_uint32),
        ("reserved", c_uint32),
        ("name", c_void_p),
        ("name_len", c_size_t),
        ("sheet", c_void_p),
        ("sheet_len", c_size_t),
        ("check", c_void_p),
        ("check_len", c_size_t),
    ]


class Frame(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("format", c_uint32),
        ("timestamp_us", c_int64),
        ("width", c_uint32),
        ("height", c_uint32),
        ("stride", c_uint32),
        ("rotation_deg", c_uint32),
        ("flags", c_uint32),
        ("reserved", c_uint32),
        ("data_len", c_size_t),
        ("data", c_void_p),
    ]


class Result(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("state", c_uint32),
        ("timestamp_us", c_int64),
        ("age_us", c_int64),
        ("landmark_count", c_uint32),
        ("confidence", c_float),
        ("face_box", c_float * 4),
        ("rotation", c_float * 4),
        ("yaw_deg", c_float),
        ("pitch_deg", c_float),
        ("roll_deg", c_float),
        ("translation_mm", c_float * 3),
        ("eye_open", c_float * 2),
        ("loss", c_uint32),
        ("visible_share", c_float),
        ("rotation_sigma_deg", c_float * 3),
        ("translation_sigma_mm", c_float * 3),
        ("eye_open_probability", c_float * 2),
        ("eye_status", c_uint32 * 2),
        ("iris_left", c_float * 2),
        ("iris_right", c_float * 2),
        ("gaze_status", c_uint32 * 3),
        ("gaze_sigma_deg", c_float * 3),
        ("gaze_left", c_float * 3),
        ("gaze_right", c_float * 3),
        ("gaze", c_float * 3),
        ("gaze_head", c_float * 3),
        ("glasses", c_float),
        ("dark_glasses", c_float),
        ("eye_look", c_float * 8),
        ("facing_yaw_deg", c_float),
        ("facing_pitch_deg", c_float),
        ("facing_roll_deg", c_float),
        ("facing_sigma_deg", c_float * 3),
        ("focal_px", c_float),
        ("camera_assumed", c_uint32),
    ]


class Hint(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("face_box", c_float * 4),
        ("yaw_deg", c_float),
        ("roll_deg", c_float),
    ]


class Face(Structure):
    _fields_ = [
        ("face_box", c_float * 4),
        ("yaw_deg", c_float),
        ("roll_deg", c_float),
        ("confidence", c_float),
    ]


class Landmark(Structure):
    _fields_ = [
        ("x", c_float),
        ("y", c_float),
        ("confidence", c_float),
        ("visibility", c_float),
        ("x_mm", c_float),
        ("y_mm", c_float),
        ("z_mm", c_float),
    ]


class Event(Structure):
    _fields_ = [
        ("timestamp_us", c_int64),
        ("kind", c_uint32),
        ("loss", c_uint32),
        ("face_box", c_float * 4),
        ("confidence", c_float),
        ("reserved", c_uint32),
    ]


class Monitor_config(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("flags", c_uint32),
        ("preset", c_uint32),
        ("gap_us", c_uint32),
        ("min_confidence", c_float),
        ("eye_yaw_deg", c_float),
        ("eye_pitch_deg", c_float),
        ("closed_below", c_float),
        ("open_above", c_float),
        ("blink_us", c_uint32),
        ("long_closure_us", c_uint32),
        ("microsleep_us", c_uint32),
        ("sleep_us", c_uint32),
        ("unresponsive_us", c_uint32),
        ("drowsy_p80_60", c_float),
        ("drowsy_p80_180", c_float),
        ("awake_share", c_float),
        ("min_known", c_float),
        ("yawn_above", c_float),
        ("yawn_below", c_float),
        ("yawn_us", c_uint32),
        ("yawn_max_us", c_uint32),
        ("nod_deg", c_float),
        ("nod_us", c_uint32),
        ("forward_yaw_deg", c_float),
        ("forward_pitch_deg", c_float),
        ("natural_yaw_deg", c_float),
        ("natural_pitch_deg", c_float),
        ("zone_margin_deg", c_float),
        ("long_glance_us", c_uint32),
        ("cumulative_us", c_uint32),
        ("return_us", c_uint32),
        ("clear_us", c_uint32),
        ("degraded_us", c_uint32),
    ]


class Monitor_observation(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("state", c_uint32),
        ("confidence", c_float),
        ("yaw_deg", c_float),
        ("pitch_deg", c_float),
        ("translation_mm", c_float * 3),
        ("rotation_sigma_deg", c_float * 3),
        ("eye_open", c_float * 2),
        ("jaw_open", c_float),
        ("camera_assumed", c_uint32),
    ]


class Monitor_perclos(Structure):
    _fields_ = [
        ("p70", c_float),
        ("p80", c_float),
        ("em", c_float),
        ("known", c_float),
        ("closures", c_uint32),
        ("mean_closure_us", c_uint32),
    ]


class Monitor_state(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("eyes", c_uint32),
        ("timestamp_us", c_int64),
        ("eyes_reason", c_uint32),
        ("openness", c_float),
        ("closure_us", c_uint32),
        ("blinks", c_uint32),
        ("yawns", c_uint32),
        ("nods", c_uint32),
        ("mouth_open_us", c_uint32),
        ("zone", c_uint32),
        ("zone_us", c_uint32),
        ("away_us", c_uint32),
        ("away_30_us", c_uint32),
        ("natural_is_final", c_uint32),
        ("from_road_deg", c_float * 2),
        ("natural_deg", c_float * 2),
        ("open_eye", c_float * 2),
        ("open_eye_is_final", c_uint32),
        ("drowsiness", c_uint32),
        ("degraded", c_uint32),
        ("reserved", c_uint32),
        ("zones_us", c_int64 * 8),
        ("perclos_60", Monitor_perclos),
        ("perclos_180", Monitor_perclos),
    ]


class Monitor_event(Structure):
    _fields_ = [
        ("timestamp_us", c_int64),
        ("start_us", c_int64),
        ("duration_us", c_uint32),
        ("kind", c_uint32),
        ("zone", c_uint32),
        ("flags", c_uint32),
        ("value", c_float),
        ("reserved", c_uint32),
    ]


class Monitor_zone(Structure):
    _fields_ = [
        ("kind", c_uint32),
        ("flags", c_uint32),
        ("grace_us", c_uint32),
        ("numbers", c_float * 9),
    ]
