//! Every constant and struct of `include/posewise.h`, in the order in which the header shows them.
//!
//! This is the one description of the interface. `cargo xtask interface` makes from it the header,
//! the layouts for JavaScript and Python, and the checks of sizes; `cargo xtask site` makes the
//! reference. The comments are written for the C reader. What they have in brackets is read by a
//! program: `\[unit, least..most, default value, since release\]`, each where it is known; in place
//! of a range, `0 or 1`, or the constants that are the values. -1 may follow a range: `0..1 or -1`.
//! Fields without a comment share the one above, and its defaults are then `a and b`. Constants
//! without an empty line between them are one family.

use core::ffi::c_char;

/// 0xMMmmpp; compare with posewise_version().
pub const POSEWISE_VERSION: u32 = 0x0000_0100;
/// Changes when programs must be recompiled.
pub const POSEWISE_ABI: u32 = 1;
/// Alignment of memory and model \[bytes\].
pub const POSEWISE_ALIGN: u32 = 64;
/// Upper bound of posewise_memory_size() \[bytes\].
pub const POSEWISE_MEMORY_SIZE: u32 = 192 * 1024;
/// Landmarks, iBUG 68 scheme.
pub const POSEWISE_LANDMARKS: u32 = 68;
/// Weights, POSEWISE_ANIMATION_*.
pub const POSEWISE_ANIMATIONS: u32 = 29;
/// Weights of a gaze, POSEWISE_EYE_LOOK_*.
pub const POSEWISE_EYE_LOOKS: u32 = 8;
/// Most boxes of posewise_set_excluded().
pub const POSEWISE_EXCLUDED: u32 = 16;
/// Most trackers of posewise_group_step().
pub const POSEWISE_GROUP_TRACKERS: u32 = 16;
/// Upper bound of a group's memory \[bytes\].
pub const POSEWISE_GROUP_SIZE: u32 = 8 * 1024;
/// Unread events that a tracker keeps.
pub const POSEWISE_EVENTS: u32 = 64;
/// Most vertices of posewise_mesh().
pub const POSEWISE_MESH_VERTICES: u32 = 800;
/// Shape of posewise_mesh_shape(): no animation.
pub const POSEWISE_MESH_NEUTRAL: u32 = 0xFFFF_FFFF;
/// Lines of a mesh, POSEWISE_MESH_LINE_*.
pub const POSEWISE_MESH_LINES: u32 = 8;
/// Dot products of AArch64, for posewise_set_cpu().
pub const POSEWISE_CPU_DOTPROD: u32 = 1;

/// Bytes of what posewise_save_identity() writes.
pub const POSEWISE_IDENTITY_RECORD_SIZE: u32 = 288;

/// Return value of a function: POSEWISE_OK, or a negative error code POSEWISE_E_*.
/// Not an enum, because the width of an enum is a compiler option on ARM.
pub type posewise_status = i32;

/// Success.
pub const POSEWISE_OK: i32 = 0;
/// A wrong argument that no other status names.
pub const POSEWISE_E_ARG: i32 = -1;
/// Tracker memory too small or misaligned.
pub const POSEWISE_E_MEMORY: i32 = -2;
/// A model section is missing or invalid.
pub const POSEWISE_E_MODEL: i32 = -3;
/// Inconsistent size, stride, rotation, data_len.
pub const POSEWISE_E_FRAME: i32 = -4;
/// Timestamp not after that of the last frame.
pub const POSEWISE_E_TIME: i32 = -5;
/// Not a POSEWISE_FMT_* value.
pub const POSEWISE_E_FORMAT: i32 = -6;
/// Model not aligned to POSEWISE_ALIGN.
pub const POSEWISE_E_MODEL_ALIGN: i32 = -7;
/// The model is truncated.
pub const POSEWISE_E_MODEL_TRUNCATED: i32 = -8;
/// Not a .posewise model.
pub const POSEWISE_E_MODEL_MAGIC: i32 = -9;
/// Unsupported model format version.
pub const POSEWISE_E_MODEL_VERSION: i32 = -10;
/// Checksum mismatch: the model is corrupt.
pub const POSEWISE_E_MODEL_CHECKSUM: i32 = -11;
/// A pointer is NULL.
pub const POSEWISE_E_NULL: i32 = -12;
/// A pointer is not aligned to its type.
pub const POSEWISE_E_POINTER_ALIGN: i32 = -13;
/// struct_size is not that of a header.
pub const POSEWISE_E_STRUCT_SIZE: i32 = -14;
/// No tracker of this library is there.
pub const POSEWISE_E_TRACKER: i32 = -15;
/// An output, or the model, in tracker memory.
pub const POSEWISE_E_OVERLAP: i32 = -16;
/// An unknown flag, or reserved is not 0.
pub const POSEWISE_E_FLAGS: i32 = -17;
/// Intrinsics out of range.
pub const POSEWISE_E_INTRINSICS: i32 = -18;
/// min_face_px out of range.
pub const POSEWISE_E_MIN_FACE: i32 = -19;
/// scan_budget out of range.
pub const POSEWISE_E_SCAN_BUDGET: i32 = -20;
/// smoothing_hz or smoothing_beta out of range.
pub const POSEWISE_E_SMOOTHING: i32 = -21;
/// A number of the hint is out of range.
pub const POSEWISE_E_HINT: i32 = -22;
/// The region of interest is out of range.
pub const POSEWISE_E_ROI: i32 = -23;
/// Excluded boxes: too many or out of range.
pub const POSEWISE_E_EXCLUDED: i32 = -24;
/// The lens, or a coefficient, out of range.
pub const POSEWISE_E_LENS: i32 = -25;
/// No monitor of this library is there.
pub const POSEWISE_E_MONITOR: i32 = -26;
/// A setting of the monitor is out of range.
pub const POSEWISE_E_MONITOR_CONFIG: i32 = -27;
/// Zones: too many, or not those of their kind.
pub const POSEWISE_E_MONITOR_ZONES: i32 = -28;
/// An output has less room than is needed.
pub const POSEWISE_E_CAPACITY: i32 = -29;
/// There is no face, or there was none yet.
pub const POSEWISE_E_NO_FACE: i32 = -30;
/// The model, or the library, has no mesh.
pub const POSEWISE_E_MESH: i32 = -31;
/// Not a POSEWISE_MESH_SPACE_* value.
pub const POSEWISE_E_MESH_SPACE: i32 = -32;
/// The bytes are no record of this kind.
pub const POSEWISE_E_RECORD: i32 = -33;
/// A record of an unknown version.
pub const POSEWISE_E_RECORD_VERSION: i32 = -34;
/// Not a shape of posewise_mesh_shape().
pub const POSEWISE_E_MESH_SHAPE: i32 = -35;
/// A record is cut, or longer than it is.
pub const POSEWISE_E_RECORD_SIZE: i32 = -36;
/// Checksum mismatch: the record is damaged.
pub const POSEWISE_E_RECORD_CHECKSUM: i32 = -37;
/// A record of a model with another 3D face.
pub const POSEWISE_E_RECORD_MODEL: i32 = -38;
/// No group of this library is there.
pub const POSEWISE_E_GROUP: i32 = -39;
/// Trackers of a group: none, or too many.
pub const POSEWISE_E_GROUP_TRACKERS: i32 = -40;
/// network_period out of range.
pub const POSEWISE_E_NETWORK_PERIOD: i32 = -41;

/// Part: networks that see closer crops.
pub const POSEWISE_PART_REFINERS: u32 = 1;
/// Part: a lost face is found by its looks.
pub const POSEWISE_PART_KEYFRAMES: u32 = 2;
/// Part: the driver monitor.
pub const POSEWISE_PART_MONITOR: u32 = 4;
/// Part: posewise_default_model().
pub const POSEWISE_PART_DEFAULT_MODEL: u32 = 8;
/// Part: the dense mesh.
pub const POSEWISE_PART_MESH: u32 = 16;

/// Terms of a model: its sheet lacks them.
pub const POSEWISE_TERMS_UNKNOWN: u32 = 0;
/// Any use, in products too.
pub const POSEWISE_TERMS_FREE: u32 = 1;
/// Some data may restrict it to research.
pub const POSEWISE_TERMS_RESEARCH: u32 = 2;

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

/// Flag of settings: 0 in a field is 0, not its default.
pub const POSEWISE_EXACT: u32 = 2;

/// Rows are stored reversed ("selfie" view).
pub const POSEWISE_FRAME_MIRRORED: u32 = 1;

/// No face; after timestamp_us all but loss are 0.
pub const POSEWISE_SEARCHING: u32 = 0;
/// The face was fitted to this frame.
pub const POSEWISE_TRACKING: u32 = 1;
/// Not fitted: repeats the last fit, age_us old.
pub const POSEWISE_COASTING: u32 = 2;

/// Tracking, or no face was found yet.
pub const POSEWISE_LOSS_NONE: u32 = 0;
/// The confidence fell below its threshold.
pub const POSEWISE_LOSS_LOW_CONFIDENCE: u32 = 1;
/// The centre of the face left the frame.
pub const POSEWISE_LOSS_LEFT_FRAME: u32 = 2;
/// No head pose fits the landmarks.
pub const POSEWISE_LOSS_NO_POSE: u32 = 3;
/// Another tracker has this face.
pub const POSEWISE_LOSS_EXCLUDED: u32 = 4;

/// No face, or a model without this network.
pub const POSEWISE_EYE_NOT_SEEN: u32 = 0;
/// The eye, or its gaze, is known.
pub const POSEWISE_EYE_KNOWN: u32 = 1;
/// The head hides the eye.
pub const POSEWISE_EYE_TURNED: u32 = 2;
/// Something covers it, or it is out of frame.
pub const POSEWISE_EYE_HIDDEN: u32 = 3;
/// It is too small in the picture.
pub const POSEWISE_EYE_SMALL: u32 = 4;
/// It moves too fast.
pub const POSEWISE_EYE_BLURRED: u32 = 5;
/// Light that is too bright, as a reflection.
pub const POSEWISE_EYE_GLARE: u32 = 6;
/// It is behind dark glasses.
pub const POSEWISE_EYE_DARK_GLASSES: u32 = 7;
/// Of a gaze: the eye is shut.
pub const POSEWISE_EYE_SHUT: u32 = 8;
/// What was found is too uncertain.
pub const POSEWISE_EYE_UNCERTAIN: u32 = 9;

/// The eyes are not looked at.
pub const POSEWISE_GAZE_OFF: u32 = 0;
/// Lids, iris, gaze and glasses.
pub const POSEWISE_GAZE_ON: u32 = 1;
/// The same, less part of the mean gaze.
pub const POSEWISE_GAZE_NATURAL: u32 = 2;

/// No distortion; coefficients are 0.
pub const POSEWISE_LENS_PINHOLE: u32 = 0;
/// k1, k2, p1, p2, k3 as in OpenCV.
pub const POSEWISE_LENS_BROWN: u32 = 1;
/// k1, k2, k3, k4, 0: OpenCV's fisheye.
pub const POSEWISE_LENS_FISHEYE: u32 = 2;

/// x, y in px of the upright image, z in mm.
pub const POSEWISE_MESH_SPACE_PICTURE: u32 = 0;
/// The camera frame, in mm.
pub const POSEWISE_MESH_SPACE_CAMERA: u32 = 1;
/// The head frame, in mm.
pub const POSEWISE_MESH_SPACE_HEAD: u32 = 2;

/// The landmarks, iBUG 68: no line.
pub const POSEWISE_MESH_LINE_LANDMARKS: u32 = 0;
/// Loop of the outer edge of the lips.
pub const POSEWISE_MESH_LINE_OUTER_LIPS: u32 = 1;
/// Loop of the inner edge of the lips.
pub const POSEWISE_MESH_LINE_INNER_LIPS: u32 = 2;
/// Loop of the lids of the left eye.
pub const POSEWISE_MESH_LINE_LEFT_EYE: u32 = 3;
/// Loop of the lids of the right eye.
pub const POSEWISE_MESH_LINE_RIGHT_EYE: u32 = 4;
/// The left brow, outwards.
pub const POSEWISE_MESH_LINE_LEFT_BROW: u32 = 5;
/// The right brow, towards the nose.
pub const POSEWISE_MESH_LINE_RIGHT_BROW: u32 = 6;
/// Loop of the edge of the mesh.
pub const POSEWISE_MESH_LINE_EDGE: u32 = 7;

/// Too little was seen, or it fits both.
pub const POSEWISE_LIKENESS_UNKNOWN: u32 = 0;
/// A head of the same shape.
pub const POSEWISE_LIKENESS_SAME: u32 = 1;
/// A head of another shape.
pub const POSEWISE_LIKENESS_OTHER: u32 = 2;

/// A new face is tracked.
pub const POSEWISE_EVENT_ACQUIRED: u32 = 0;
/// A lost face is tracked again, with its identity.
pub const POSEWISE_EVENT_REACQUIRED: u32 = 1;
/// Not found: its last fit is repeated.
pub const POSEWISE_EVENT_COASTING: u32 = 2;
/// The face is given up; the search begins.
pub const POSEWISE_EVENT_LOST: u32 = 3;
/// Probably no face; its region needs more.
pub const POSEWISE_EVENT_SUPPRESSED: u32 = 4;
/// Noisy frames are box-filtered from here on.
pub const POSEWISE_EVENT_FILTER_ON: u32 = 5;
/// Frames are no longer filtered.
pub const POSEWISE_EVENT_FILTER_OFF: u32 = 6;
/// posewise_reset() was called.
pub const POSEWISE_EVENT_RESET: u32 = 7;
/// posewise_forget_identity() was called.
pub const POSEWISE_EVENT_FORGOTTEN: u32 = 8;

/// A camera without its lens, in pixels of the upright image. All four 0 select the default: a
/// horizontal field of view of 60 degrees and the principal point at the image centre.
/// This struct never grows.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct posewise_intrinsics {
    /// Focal lengths \[px, 1..1000000\]; fy is 0.1..10 times fx.
    pub fx: f32,
    pub fy: f32,
    /// Principal point \[px, -100000..100000\].
    pub cx: f32,
    pub cy: f32,
}

/// A region of interest: a rectangle of the upright image. All four 0: the whole frame. This struct
/// never grows.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct posewise_roi {
    /// Upper left corner \[px, 0..16383\].
    pub x: u32,
    pub y: u32,
    /// Width and height \[px, 1..16384\]; x + width and y + height are at most 16384.
    pub width: u32,
    pub height: u32,
}

/// The distortion of a lens. Landmarks and boxes stay in the picture as the lens shows it; pose and
/// points in mm are those without it. This struct never grows.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct posewise_lens {
    /// What the coefficients mean \[POSEWISE_LENS_*\].
    pub model: u32,
    /// Numbers of the lens \[-10000..10000\]. With POSEWISE_LENS_BROWN, Brown-Conrady, x and y at
    /// unit depth and s = x^2 + y^2: x times (1 + k1 s + k2 s^2 + k3 s^3) plus 2 p1 x y + p2 (s + 2
    /// x^2), y likewise with p1 and p2 swapped; p1, p2 are -0.1..0.1. With POSEWISE_LENS_FISHEYE,
    /// Kannala-Brandt, a point at the angle t from the axis is at t (1 + k1 t^2 + k2 t^4 + k3 t^6 +
    /// k4 t^8); all are -10..10. The picture must not turn back within 1 degree of the axis.
    pub coefficients: [f32; 5],
}

/// Settings. A NULL pointer to this struct selects all defaults; without POSEWISE_EXACT so does 0
/// in a field. Intrinsics or a region of zeros are none in either case.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct posewise_config {
    /// sizeof(posewise_config).
    pub struct_size: u32,
    /// 0 or POSEWISE_EXACT.
    pub flags: u32,
    /// Least width of a face to search for \[px, 24..4096, default 40\].
    pub min_face_px: u32,
    /// Work per step while searching \[100..10000000, default 3600\]: 2600 is about a tracking
    /// step, 700 is one tile of the detector. A smaller budget shortens a step and delays
    /// detection.
    pub scan_budget: u32,
    /// The camera; see posewise_set_intrinsics().
    pub intrinsics: posewise_intrinsics,
    /// Of the One-Euro filter behind posewise_smoothed() (Casiez et al., CHI 2012): cutoff
    /// frequency at rest \[Hz, 0.01..100, default 1\]; lower values reduce jitter.
    pub smoothing_hz: f32,
    /// Of the same filter: increase of the cutoff per unit of speed \[0..1000, default 12\]; higher
    /// values reduce lag. Speed is in face widths, radians or weights per second.
    pub smoothing_beta: f32,
    /// The lens of the camera; other than POSEWISE_LENS_PINHOLE only with intrinsics.
    pub lens: posewise_lens,
    /// Whether to look at the eyes of the tracked face \[POSEWISE_GAZE_*\]. _ON fills
    /// eye_open_probability to eye_look of posewise_result. It takes more time: a network for each
    /// eye. _OFF: those fields stay 0. _NATURAL: as _ON, for a person who looks straight ahead most
    /// of the time, as a driver does: part of the mean of the gaze in the head frame is taken off
    /// it, at most 8 degrees.
    pub gaze: u32,
    /// Where faces are searched for; see posewise_set_roi(). All four 0: the whole frame.
    pub roi: posewise_roi,
    /// Number of frames of which one is seen with all networks \[1..8, default 1\]. On the others,
    /// what the second network of the global stage and the mouth's mirrored run changed when they
    /// last ran is taken. With 4 a step takes a fifth less on average, and landmarks jitter a tenth
    /// more.
    pub network_period: u32,
}

/// One camera frame. The library reads it only during the call.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct posewise_frame {
    /// sizeof(posewise_frame).
    pub struct_size: u32,
    /// Pixel format \[POSEWISE_FMT_*\]: the values of V4L2_PIX_FMT_*. Only luma is read.
    pub format: u32,
    /// Capture time of the frame \[us\], on any monotonic clock; must increase from step to step.
    pub timestamp_us: i64,
    /// Stored width and height \[px, 1..16384\].
    pub width: u32,
    pub height: u32,
    /// Distance between the starts of two rows \[bytes\] (V4L2: bytesperline); at least one row.
    pub stride: u32,
    /// Clockwise rotation that makes the stored image upright \[deg\]: 0, 90, 180 or 270. Results
    /// are in pixels of the upright image.
    pub rotation_deg: u32,
    /// 0 or POSEWISE_FRAME_MIRRORED. Mirroring is undone before the rotation.
    pub flags: u32,
    /// Must be 0. Keeps the struct free of padding.
    pub reserved: u32,
    /// Readable length at data \[bytes\]. The last row need not be padded to the stride.
    pub data_len: usize,
    /// First byte of the first stored row.
    pub data: *const u8,
}

/// Where a face is expected, for posewise_step_at(): found by another detector, or by a tracker of
/// another camera.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct posewise_hint {
    /// sizeof(posewise_hint).
    pub struct_size: u32,
    /// Box of the landmarks in the upright image: x, y, width, height \[px\]. It reaches from the
    /// brows to below the chin and from ear to ear; boxes of whole heads are larger. The longer
    /// side is at least 16.
    pub face_box: [f32; 4],
    /// As facing_yaw_deg of posewise_result \[deg, -180..180\], 0 where it is not known.
    pub yaw_deg: f32,
    /// Roll as in posewise_result \[deg, -360..360\], 0 where it is not known.
    pub roll_deg: f32,
}

/// The result of one frame. Every number is finite.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct posewise_result {
    /// sizeof(posewise_result), set by the caller.
    pub struct_size: u32,
    /// What the tracker does \[POSEWISE_SEARCHING, _TRACKING, _COASTING\].
    pub state: u32,
    /// Capture time of the frame \[us\], as given in posewise_frame.
    pub timestamp_us: i64,
    /// Time since the frame of the last fit \[us\]; 0 while tracking.
    pub age_us: i64,
    /// Number of landmarks that posewise_landmarks() gives: 68; 0 while searching.
    pub landmark_count: u32,
    /// Calibrated probability that this is a face whose landmarks are right \[0..1\]. Right: the
    /// mean error is below a tenth of the distance between the outer eye corners.
    pub confidence: f32,
    /// Bounding box of the landmarks: x, y, width, height \[px\].
    pub face_box: [f32; 4],
    /// Head-to-camera rotation as a unit quaternion x, y, z, w \[-1..1\].
    pub rotation: [f32; 4],
    /// Yaw of the rotation relative to the camera's axes \[deg, -180..180\]. > 0: the face turns to
    /// the image right.
    pub yaw_deg: f32,
    /// Pitch, likewise \[deg, -90..90\]. > 0: the face turns up.
    pub pitch_deg: f32,
    /// Roll, likewise \[deg, -180..180\]. > 0: the face tilts clockwise in the image.
    pub roll_deg: f32,
    /// Origin of the head frame, midway between the eyeballs, in the camera frame \[mm\].
    pub translation_mm: [f32; 3],
    /// Eye opening, the person's left and right eye \[0..1 or -1\]: 0 shut, 1 open, -1 unknown
    /// because the eye is hidden or moves too fast.
    pub eye_open: [f32; 2],
    /// Why tracking was lost, while coasting or searching \[POSEWISE_LOSS_*\].
    pub loss: u32,
    /// Mean visibility of the landmarks \[0..1\]: low when much of the face is occluded.
    pub visible_share: f32,
    /// Standard deviations of the rotation about the camera's x, y and z axes \[deg, 0..180\], as
    /// measured on rendered heads, by how the face is turned and how much of it is seen. Without
    /// intrinsics they hold the unknown focal length.
    pub rotation_sigma_deg: [f32; 3],
    /// Standard deviations of translation_mm \[mm, 0..100000\], estimated likewise.
    pub translation_sigma_mm: [f32; 3],
    /// Calibrated probability that the person's left and right eye is open \[0..1 or -1\], by a
    /// network that sees one eye at a time; -1 where eye_status is neither POSEWISE_EYE_KNOWN nor
    /// POSEWISE_EYE_UNCERTAIN. This and all down to eye_look is 0 unless state is POSEWISE_TRACKING
    /// and posewise_config has gaze, and with a model without that network.
    pub eye_open_probability: [f32; 2],
    /// Whether the lids of the left and right eye are known, else why they are not
    /// \[POSEWISE_EYE_*\]. With POSEWISE_EYE_UNCERTAIN there is a probability.
    pub eye_status: [u32; 2],
    /// Middle of the left iris in the upright image: x, y \[px\]; that of the landmarks of the eye
    /// where its gaze is unknown.
    pub iris_left: [f32; 2],
    /// Middle of the right iris, likewise \[px\].
    pub iris_right: [f32; 2],
    /// Whether the gaze of the left eye, the right eye and both together is known, else why it is
    /// not \[POSEWISE_EYE_*\]. The numbers of a gaze are 0 where it is unknown.
    pub gaze_status: [u32; 3],
    /// Standard deviations of these gazes along each axis across them \[deg\].
    pub gaze_sigma_deg: [f32; 3],
    /// Unit direction in which the left eye looks, camera frame \[-1..1\].
    pub gaze_left: [f32; 3],
    /// That of the right eye, likewise \[-1..1\].
    pub gaze_right: [f32; 3],
    /// That of both eyes together, likewise \[-1..1\].
    pub gaze: [f32; 3],
    /// That of both eyes in the head frame \[-1..1\]: (0, 0, -1) is straight ahead.
    pub gaze_head: [f32; 3],
    /// Probability that the person wears glasses \[0..1 or -1\]; -1 where neither eye is seen.
    pub glasses: f32,
    /// Probability that these are dark \[0..1 or -1\]; -1 where neither eye is seen.
    pub dark_glasses: f32,
    /// ARKit's weights of the gaze by POSEWISE_EYE_LOOK_* \[0..1\]; 0 where it is unknown.
    pub eye_look: [f32; 8],
    /// Facing: yaw relative to the line from the face to the camera \[deg, -180..180\]. All three
    /// 0: the face looks into the lens, wherever in the picture it is. Signs as of yaw_deg,
    /// pitch_deg and roll_deg, which are relative to the camera's axes. These hardly depend on the
    /// focal length; use them where it is not known.
    pub facing_yaw_deg: f32,
    /// Pitch, likewise \[deg, -90..90\].
    pub facing_pitch_deg: f32,
    /// Roll, likewise \[deg, -180..180\].
    pub facing_roll_deg: f32,
    /// Standard deviations of the facing yaw, pitch and roll \[deg, 0..180\].
    pub facing_sigma_deg: [f32; 3],
    /// Focal length along x with which the face was fitted \[px\].
    pub focal_px: f32,
    /// Whether 60 degrees across the frame were assumed, for want of intrinsics \[0 or 1\].
    pub camera_assumed: u32,
    /// Angle between the direction of the face and the line to the camera \[deg, 0..180\]: what
    /// facing_yaw_deg and facing_pitch_deg are together. 0: the face looks into the lens.
    pub facing_angle_deg: f32,
    /// Distance between the outer eye corners as if seen from the front \[px\]: how large the face
    /// is, however it is turned. Errors of landmarks are in proportion to it.
    pub interocular_px: f32,
}

/// One landmark. This struct never grows, so the layout of arrays stays the same.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct posewise_landmark {
    /// Position in the upright image \[px\]. Points 0..16 follow the visible contour of the jaw.
    /// The others are images of x_mm, y_mm, z_mm; hidden ones are estimated from the rest.
    pub x: f32,
    pub y: f32,
    /// Calibrated probability that the error of (x, y) is below a tenth of the distance between
    /// the outer eye corners of the same face seen from the front \[0..1\].
    pub confidence: f32,
    /// Calibrated probability that the landmark is visible \[0..1\]: neither the head itself nor
    /// anything in front of it hides it.
    pub visibility: f32,
    /// Point of the 3D face in the camera frame \[mm\]; for points 0..16 a fixed point of the jaw.
    pub x_mm: f32,
    pub y_mm: f32,
    pub z_mm: f32,
}

/// An event of the log that posewise_events() reads. confidence and face_box are those of the fit
/// that was accepted, or the last ones of the face that is lost; 0 where there is no face. This
/// struct never grows, so the layout of arrays stays the same. Later libraries may have kinds that
/// this header lacks.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct posewise_event {
    /// Capture time of the frame \[us\]; of a call between two frames, that of the first.
    pub timestamp_us: i64,
    /// What happened \[POSEWISE_EVENT_*\].
    pub kind: u32,
    /// Why the face is lost; while searching, why the last one was \[POSEWISE_LOSS_*\].
    pub loss: u32,
    /// Bounding box of the landmarks: x, y, width, height \[px\].
    pub face_box: [f32; 4],
    /// As in posewise_result \[0..1\].
    pub confidence: f32,
    /// 0. Keeps the struct free of padding.
    pub reserved: u32,
}

/// A face of a frame, from posewise_detect(). This struct never grows.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct posewise_face {
    /// Box of the landmarks in the upright image: x, y, width, height \[px\].
    pub face_box: [f32; 4],
    /// As facing_yaw_deg of posewise_result \[deg, -90..90\]; rough.
    pub yaw_deg: f32,
    /// Roll as in posewise_result \[deg, -180..180\].
    pub roll_deg: f32,
    /// As in posewise_result \[0..1\].
    pub confidence: f32,
}

/// What a model says of itself, and what is wrong with it. The texts are UTF-8 without a NUL; name
/// and sheet lie in the model, check is static.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct posewise_model_details {
    /// sizeof(posewise_model_details), set by the caller.
    pub struct_size: u32,
    /// Version of the model format. If it is another than that of the library, or the bytes are no
    /// whole model, the fields down to sections are 0, and name and sheet are empty.
    pub format_version: u32,
    /// Length of the model, which may be less than that of the memory it is in \[bytes\].
    pub length: u32,
    /// CRC-32 by which models are told apart.
    pub checksum: u32,
    /// What the terms of the data that it was trained on allow \[POSEWISE_TERMS_*\].
    pub terms: u32,
    /// Number of sections, and the name of each: four characters, the first in the lowest byte.
    pub section_count: u32,
    pub sections: [u32; 32],
    /// Name of the section that is missing or wrong, 0 where it is another fault.
    pub wrong_section: u32,
    /// 0. Keeps the struct free of padding.
    pub reserved: u32,
    /// Name of the model, as "posewise.posewise".
    pub name: *const c_char,
    pub name_len: usize,
    /// Its data sheet, in Markdown: what it was trained on, with which terms.
    pub sheet: *const c_char,
    pub sheet_len: usize,
    /// Which check the model failed, in English; empty for a model that the library can track with.
    pub check: *const c_char,
    pub check_len: usize,
}

/// One vertex of posewise_mesh(). This struct never grows, so the layout of arrays stays the same.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct posewise_mesh_vertex {
    /// In the space that was asked for \[by kind\]: px or mm.
    pub x: f32,
    pub y: f32,
    /// In POSEWISE_MESH_SPACE_PICTURE the distance along the camera's axis \[mm\].
    pub z: f32,
    /// Whether the surface there faces the camera \[0..1\]: 0 where it turns away, 1 where it is
    /// seen at 12 degrees or more, half way at the edge. What covers it does not count.
    pub visibility: f32,
}

/// How the vertices of a mesh are joined. The tables lie in the model.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct posewise_mesh_topology {
    /// sizeof(posewise_mesh_topology), set by the caller.
    pub struct_size: u32,
    /// Number of vertices.
    pub vertex_count: u32,
    /// Number of triangles.
    pub triangle_count: u32,
    /// Where each of POSEWISE_MESH_LINE_* begins in lines; it ends where the next one begins, the
    /// last at the ninth number. Of a loop the last vertex is joined to the first.
    pub line_starts: [u32; 9],
    /// Three vertices of each triangle, counter-clockwise as seen from outside of the face.
    pub triangles: *const u16,
    /// Two numbers of each vertex, 0..1: u to the right and v upwards in a texture of the face.
    pub uvs: *const f32,
    /// The vertices of all lines.
    pub lines: *const u16,
}

/// A tracker, opaque. It starts at the start of the caller's memory and holds no pointer into
/// itself: a memcpy of posewise_memory_size() bytes to memory of the same alignment is a second,
/// independent tracker. No output of a call may lie in that memory.
pub struct posewise_tracker {
    _private: [u8; 0],
}

/// What several trackers share, opaque: see posewise_group_step(). It starts at the start of the
/// caller's memory and holds no pointer.
pub struct posewise_group {
    _private: [u8; 0],
}
