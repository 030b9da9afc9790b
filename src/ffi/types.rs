//! Every constant and struct of `include/posewise.h`, in the order in which the header shows them.
//!
//! The header is generated from this file: the comments below are written for the C reader.
//! Nothing here refers to the rest of the crate, so a test can compare the layouts with a C
//! compiler's.

/// 0xMMmmpp; compare with posewise_version().
pub const POSEWISE_VERSION: u32 = 0x0000_0100;
/// Grows when programs must be compiled anew.
pub const POSEWISE_ABI: u32 = 1;
/// Of the tracker's memory and of the model \[bytes\].
pub const POSEWISE_ALIGN: u32 = 64;
/// Enough for any posewise_config \[bytes\].
pub const POSEWISE_MEMORY_SIZE: u32 = 208 * 1024;
/// iBUG 68.
pub const POSEWISE_LANDMARKS: u32 = 68;
/// Weights; see posewise_animation_name().
pub const POSEWISE_ANIMATIONS: u32 = 24;

/// What a function answers: POSEWISE_OK, or a negative POSEWISE_E_* that says what is wrong.
/// Not an enum, because the width of an enum is a build option on ARM.
pub type posewise_status = i32;

/// Success.
pub const POSEWISE_OK: i32 = 0;
/// Wrong pointer, struct_size, flag or setting.
pub const POSEWISE_E_ARG: i32 = -1;
/// Tracker memory too small or misaligned.
pub const POSEWISE_E_MEMORY: i32 = -2;
/// A section of the model is missing or wrong.
pub const POSEWISE_E_MODEL: i32 = -3;
/// Size, stride, rotation, data_len disagree.
pub const POSEWISE_E_FRAME: i32 = -4;
/// Not after the timestamp of the frame before.
pub const POSEWISE_E_TIME: i32 = -5;
/// None of POSEWISE_FMT_*.
pub const POSEWISE_E_FORMAT: i32 = -6;
/// Model not at a multiple of POSEWISE_ALIGN.
pub const POSEWISE_E_MODEL_ALIGN: i32 = -7;
/// The model's bytes end too early.
pub const POSEWISE_E_MODEL_TRUNCATED: i32 = -8;
/// Not a .posewise model.
pub const POSEWISE_E_MODEL_MAGIC: i32 = -9;
/// A format version that is not read here.
pub const POSEWISE_E_MODEL_VERSION: i32 = -10;
/// Checksum wrong: the model was changed.
pub const POSEWISE_E_MODEL_CHECKSUM: i32 = -11;

/// 8-bit grey.
pub const POSEWISE_FMT_GREY: u32 = 0x5945_5247;
/// 10-bit grey in 16-bit little-endian words.
pub const POSEWISE_FMT_Y10: u32 = 0x2030_3159;
/// 16-bit grey, little-endian.
pub const POSEWISE_FMT_Y16: u32 = 0x2036_3159;
/// 4:2:2 packed, Y first.
pub const POSEWISE_FMT_YUYV: u32 = 0x5659_5559;
/// 4:2:2 packed, U first.
pub const POSEWISE_FMT_UYVY: u32 = 0x5956_5955;
/// 4:2:0; pass the Y plane, chroma is not read.
pub const POSEWISE_FMT_NV12: u32 = 0x3231_564E;
/// 4:2:0; pass the Y plane, chroma is not read.
pub const POSEWISE_FMT_NV21: u32 = 0x3132_564E;
/// I420; pass the Y plane, chroma is not read.
pub const POSEWISE_FMT_YU12: u32 = 0x3231_5559;
/// 24-bit R, G, B in memory.
pub const POSEWISE_FMT_RGB3: u32 = 0x3342_4752;
/// 24-bit B, G, R in memory.
pub const POSEWISE_FMT_BGR3: u32 = 0x3352_4742;
/// 32-bit R, G, B, unused in memory.
pub const POSEWISE_FMT_XB24: u32 = 0x3432_4258;
/// 32-bit R, G, B, alpha in memory.
pub const POSEWISE_FMT_AB24: u32 = 0x3432_4241;
/// 32-bit B, G, R, unused in memory.
pub const POSEWISE_FMT_XR24: u32 = 0x3432_5258;
/// 32-bit B, G, R, alpha in memory.
pub const POSEWISE_FMT_AR24: u32 = 0x3432_5241;
/// 32-bit unused, R, G, B in memory.
pub const POSEWISE_FMT_BX24: u32 = 0x3432_5842;
/// 32-bit alpha, R, G, B in memory.
pub const POSEWISE_FMT_BA24: u32 = 0x3432_4142;
/// 32-bit unused, B, G, R in memory.
pub const POSEWISE_FMT_RX24: u32 = 0x3432_5852;
/// 32-bit alpha, B, G, R in memory.
pub const POSEWISE_FMT_RA24: u32 = 0x3432_4152;

/// Stored left to right reversed ("selfie").
pub const POSEWISE_FRAME_MIRRORED: u32 = 1;

/// No face; fields below timestamp_us are 0, but for loss.
pub const POSEWISE_SEARCHING: u32 = 0;
/// Fitted on this frame.
pub const POSEWISE_TRACKING: u32 = 1;
/// Not fitted: the last fit, age_us old.
pub const POSEWISE_COASTING: u32 = 2;

/// It is tracked, or there was none yet.
pub const POSEWISE_LOSS_NONE: u32 = 0;
/// It no longer looked like a face with landmarks where they should be.
pub const POSEWISE_LOSS_LOW_CONFIDENCE: u32 = 1;
/// Its middle left the frame.
pub const POSEWISE_LOSS_LEFT_FRAME: u32 = 2;
/// No head pose explains the landmarks.
pub const POSEWISE_LOSS_NO_POSE: u32 = 3;

/// A pinhole camera without distortion, in pixels of the upright frame. All four 0: a camera with
/// a 60 degree horizontal field of view and the principal point in the middle. This struct is
/// complete and never grows.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct posewise_intrinsics {
    /// Focal lengths \[px\], finite, > 0.
    pub fx: f32,
    pub fy: f32,
    /// Principal point \[px\], finite.
    pub cx: f32,
    pub cy: f32,
}

/// Settings. NULL in place of this struct means all defaults.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct posewise_config {
    /// sizeof(posewise_config).
    pub struct_size: u32,
    /// 0; no flags yet.
    pub flags: u32,
    /// Narrowest face searched for \[px\], 24..4096. 0: the default, 40.
    pub min_face_px: u32,
    /// Work per step while searching, 100..10000000; a window is about two, six in a frame full
    /// of noise. Bounds the time of a step, at the price of finding a face later. 0: the default, 3000.
    pub scan_budget: u32,
    /// The camera; see posewise_set_intrinsics().
    pub intrinsics: posewise_intrinsics,
    /// How posewise_smoothed() filters (One-Euro): the cutoff for a face that does not move \[Hz\],
    /// 0.01..100, lower is steadier; and how much it rises per unit of speed, up to 1000, higher is
    /// prompter (units: widths of the face, radians, whole weights per second). 0: the defaults,
    /// 1 and 12.
    pub smoothing_hz: f32,
    pub smoothing_beta: f32,
}

/// One camera frame, borrowed for the one call.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct posewise_frame {
    /// sizeof(posewise_frame).
    pub struct_size: u32,
    /// POSEWISE_FMT_*: the values of V4L2_PIX_FMT_*. Only luma is read.
    pub format: u32,
    /// When the frame was taken \[us\], on any monotonic clock; must increase from step to step.
    pub timestamp_us: i64,
    /// Stored size \[px\], 1..16384.
    pub width: u32,
    pub height: u32,
    /// Bytes from row to row (V4L2: bytesperline); at least a row of pixels.
    pub stride: u32,
    /// Clockwise turn that makes the stored picture upright: 0, 90, 180 or 270. Results are in
    /// pixels of the upright picture.
    pub rotation_deg: u32,
    /// 0 or POSEWISE_FRAME_MIRRORED. Mirroring is undone before the turn.
    pub flags: u32,
    /// 0; keeps the struct free of padding.
    pub reserved: u32,
    /// Bytes readable at data. The last row need not be padded to the stride.
    pub data_len: usize,
    /// The first byte of the top row, as stored.
    pub data: *const u8,
}

/// The answer to one frame. Every number is finite.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct posewise_result {
    /// sizeof(posewise_result), set by the caller.
    pub struct_size: u32,
    /// POSEWISE_SEARCHING, POSEWISE_TRACKING or POSEWISE_COASTING.
    pub state: u32,
    /// Of the frame that this answers \[us\].
    pub timestamp_us: i64,
    /// Time since the frame that the fit belongs to \[us\]; 0 while tracking.
    pub age_us: i64,
    /// Landmarks that posewise_landmarks() has: 68; 0 while searching.
    pub landmark_count: u32,
    /// Calibrated probability that this is a face and that the landmarks are right (on average to
    /// a tenth of the distance between the eyes' outer corners), 0..1. In a library built
    /// without the verifier: how well the 3D face fits, from 1 to 0, no probability.
    pub confidence: f32,
    /// Box of the landmarks: x, y, width, height \[px\].
    pub face_box: [f32; 4],
    /// Head-to-camera rotation as a unit quaternion x, y, z, w.
    pub rotation: [f32; 4],
    /// The same rotation as angles \[deg\]. yaw > 0: the face turns to the image right, -180..180.
    /// pitch > 0: it turns up, -90..90. roll > 0: it tilts clockwise in the image, -180..180.
    pub yaw_deg: f32,
    pub pitch_deg: f32,
    pub roll_deg: f32,
    /// The head's origin, midway between the eyeballs, in the camera frame \[mm\].
    pub translation_mm: [f32; 3],
    /// The subject's left and right eye: 0 shut .. 1 open, -1 unknown (hidden, or too fast to tell).
    pub eye_open: [f32; 2],
    /// POSEWISE_LOSS_*: why the face that is now coasted or searched for was lost.
    pub loss: u32,
    /// Mean visibility of the landmarks, 0..1: low when much of the face is covered.
    pub visible_share: f32,
    /// Standard deviations of the rotation about the camera's x, y and z axes \[deg\], from how far
    /// the landmarks of this frame lie from the 3D face.
    pub rotation_sigma_deg: [f32; 3],
    /// Standard deviations of translation_mm \[mm\], likewise.
    pub translation_sigma_mm: [f32; 3],
}

/// One landmark. This struct is complete and never grows, so that arrays of it stay the same.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct posewise_landmark {
    /// Place in the upright picture \[px\]. Points 0..16 follow the jaw's visible contour; the
    /// others are the places of x_mm, y_mm, z_mm, estimated from the rest where they are hidden.
    pub x: f32,
    pub y: f32,
    /// Calibrated probability that (x, y) is right to a tenth of the distance between the eyes'
    /// outer corners, as it is on a face that looks into the camera, 0..1.
    pub confidence: f32,
    /// Calibrated probability that the camera sees it: that neither the head itself nor anything
    /// before it hides it, 0..1. In a library built without the verifier: 1 unless the head itself
    /// hides it, else 0; the landmark's confidence is then the face's.
    pub visibility: f32,
    /// The point of the 3D face, camera frame \[mm\]; for points 0..16 a fixed place on the jaw.
    pub x_mm: f32,
    pub y_mm: f32,
    pub z_mm: f32,
}

/// A tracker: opaque, it starts where the caller's memory starts. It holds no pointer into itself,
/// so a memcpy of posewise_memory_size() bytes to memory of the same alignment is a second tracker
/// that goes on independently.
pub struct posewise_tracker {
    _private: [u8; 0],
}

/// Fails to compile when the fields leave padding, which would be shared between struct versions.
macro_rules! assert_no_padding {
    ($name:ident: $($field:ident: $type:ty),+) => {
        const _: () = {
            let mut end = 0;
            $(
                assert!(core::mem::offset_of!($name, $field) == end);
                end += size_of::<$type>();
            )+
            assert!(size_of::<$name>() == end);
        };
    };
}

assert_no_padding!(posewise_intrinsics: fx: f32, fy: f32, cx: f32, cy: f32);
assert_no_padding!(posewise_config: struct_size: u32, flags: u32, min_face_px: u32,
    scan_budget: u32, intrinsics: posewise_intrinsics, smoothing_hz: f32, smoothing_beta: f32);
assert_no_padding!(posewise_frame: struct_size: u32, format: u32, timestamp_us: i64, width: u32,
    height: u32, stride: u32, rotation_deg: u32, flags: u32, reserved: u32, data_len: usize,
    data: *const u8);
assert_no_padding!(posewise_result: struct_size: u32, state: u32, timestamp_us: i64, age_us: i64,
    landmark_count: u32, confidence: f32, face_box: [f32; 4], rotation: [f32; 4], yaw_deg: f32,
    pitch_deg: f32, roll_deg: f32, translation_mm: [f32; 3], eye_open: [f32; 2],
    loss: u32, visible_share: f32, rotation_sigma_deg: [f32; 3], translation_sigma_mm: [f32; 3]);
assert_no_padding!(posewise_landmark: x: f32, y: f32, confidence: f32, visibility: f32,
    x_mm: f32, y_mm: f32, z_mm: f32);
