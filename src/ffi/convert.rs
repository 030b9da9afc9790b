//! Conversion between C values and the crate's types, and from errors to status codes.

use super::memory;
use super::types::*;
use crate::image::{Frame, FrameLayout, PixelFormat, Roi, Rotation};
use crate::shape::{Distortion, Intrinsics, LANDMARKS};
use crate::track::{
    Config, ConfigError, Event, EventKind, EyeUnknown, Eyes, FaceHint, FoundFace, Gaze, Loss,
    Model, Smoothing, State, StepError, TrackResult,
};
use core::ffi::{c_char, c_void};
use posewise_format::{FORMAT_VERSION, ModelError, ModelInfo, ModelTerms};

/// The bytes of a model; or the error.
///
/// # Safety
/// As at the head of memory.rs; the model outlives its use.
pub(super) unsafe fn model_bytes(
    model: *const c_void,
    len: usize,
) -> Result<&'static [u8], posewise_status> {
    // SAFETY: the caller's contract.
    unsafe { memory::bytes(model.cast(), len, POSEWISE_E_MODEL_TRUNCATED) }
}

/// Checks a model; its errors become `POSEWISE_E_MODEL*`.
pub(super) fn load(bytes: &'static [u8]) -> Result<Model<'static>, posewise_status> {
    Model::load(bytes).map_err(|error| match error {
        ModelError::Misaligned => POSEWISE_E_MODEL_ALIGN,
        ModelError::Truncated => POSEWISE_E_MODEL_TRUNCATED,
        ModelError::Magic => POSEWISE_E_MODEL_MAGIC,
        ModelError::Version { .. } => POSEWISE_E_MODEL_VERSION,
        ModelError::Checksum => POSEWISE_E_MODEL_CHECKSUM,
        // Table, Missing, Section.
        _ => POSEWISE_E_MODEL,
    })
}

/// What a model says of itself, and what is wrong with it, with `struct_size` 0.
pub(super) fn model_info_to(bytes: &'static [u8]) -> posewise_model_details {
    let mut to = posewise_model_details {
        struct_size: 0, // write_struct() keeps the caller's
        format_version: 0,
        length: 0,
        checksum: 0,
        terms: POSEWISE_TERMS_UNKNOWN,
        section_count: 0,
        sections: [0; 32],
        wrong_section: 0,
        reserved: 0,
        name: core::ptr::null(),
        name_len: 0,
        sheet: core::ptr::null(),
        sheet_len: 0,
        check: core::ptr::null(),
        check_len: 0,
    };
    let error = match ModelInfo::read(bytes) {
        Ok(info) => {
            describe(&info, &mut to);
            Model::load(bytes).err()
        }
        Err(error) => Some(error),
    };
    if let Some(ModelError::Version { found }) = error {
        to.format_version = found;
    }
    let section = error.and_then(|error| error.section());
    to.wrong_section = section.map_or(0, u32::from_le_bytes);
    (to.check, to.check_len) = text_to(error.map_or("", |error| error.check()));
    to
}

/// What a model says of itself.
fn describe(info: &ModelInfo<'_>, to: &mut posewise_model_details) {
    to.format_version = FORMAT_VERSION;
    to.length = info.blob.total_len() as u32;
    to.checksum = info.checksum;
    to.terms = match info.terms {
        ModelTerms::Free => POSEWISE_TERMS_FREE,
        ModelTerms::Research => POSEWISE_TERMS_RESEARCH,
        _ => POSEWISE_TERMS_UNKNOWN,
    };
    for (name, (tag, _)) in to.sections.iter_mut().zip(info.blob.sections()) {
        *name = u32::from_le_bytes(tag);
        to.section_count += 1;
    }
    (to.name, to.name_len) = text_to(info.name);
    (to.sheet, to.sheet_len) = text_to(info.sheet);
}

fn text_to(text: &str) -> (*const c_char, usize) {
    (text.as_ptr().cast(), text.len())
}

/// Checked settings; the default where the caller's pointer is NULL, or a field is 0 and not exact.
///
/// # Safety
/// As at the head of memory.rs.
pub(super) unsafe fn config_from(
    config: *const posewise_config,
) -> Result<Config, posewise_status> {
    let default = Config::default();
    if config.is_null() {
        return Ok(default);
    }
    // SAFETY: the caller's contract.
    let given = unsafe { memory::read_struct(config)? };
    if given.flags & !POSEWISE_EXACT != 0 || given.gaze > POSEWISE_GAZE_NATURAL {
        return Err(POSEWISE_E_FLAGS);
    }
    let or = |value, default| or_default(value, default, given.flags);
    let or_f32 = |value, default| or_default(value, default, given.flags);
    let config = Config {
        intrinsics: camera_from(&given.intrinsics, &given.lens)?,
        min_face_px: or(given.min_face_px, default.min_face_px),
        scan_budget: or(given.scan_budget, default.scan_budget),
        smoothing: Smoothing {
            cutoff_hz: or_f32(given.smoothing_hz, default.smoothing.cutoff_hz),
            beta: or_f32(given.smoothing_beta, default.smoothing.beta),
        },
        gaze: given.gaze != POSEWISE_GAZE_OFF,
        natural_gaze: given.gaze == POSEWISE_GAZE_NATURAL,
        roi: roi_from(&given.roi),
        network_period: or(given.network_period, default.network_period),
    };
    config.check().map_err(config_error)?;
    Ok(config)
}

/// A setting; its default where it is 0 and not exact.
pub(super) fn or_default<T: Default + PartialEq>(value: T, default: T, flags: u32) -> T {
    match value == T::default() && flags & POSEWISE_EXACT == 0 {
        true => default,
        false => value,
    }
}

/// The status of settings that are out of range.
pub(super) fn config_error(error: ConfigError) -> posewise_status {
    match error {
        ConfigError::Intrinsics => POSEWISE_E_INTRINSICS,
        ConfigError::Distortion => POSEWISE_E_LENS,
        ConfigError::MinFace => POSEWISE_E_MIN_FACE,
        ConfigError::ScanBudget => POSEWISE_E_SCAN_BUDGET,
        ConfigError::Smoothing => POSEWISE_E_SMOOTHING,
        ConfigError::Roi => POSEWISE_E_ROI,
        ConfigError::Excluded => POSEWISE_E_EXCLUDED,
        ConfigError::NetworkPeriod => POSEWISE_E_NETWORK_PERIOD,
    }
}

/// The camera with its lens; `None`, the default, where all intrinsics are 0. The tracker checks
/// the ranges.
pub(super) fn camera_from(
    given: &posewise_intrinsics,
    lens: &posewise_lens,
) -> Result<Option<Intrinsics>, posewise_status> {
    let posewise_intrinsics { fx, fy, cx, cy } = *given;
    let distortion = distortion_from(lens).ok_or(POSEWISE_E_LENS)?;
    if [fx, fy, cx, cy] != [0.0; 4] {
        return Ok(Some(
            Intrinsics::new(fx, fy, cx, cy).with_distortion(distortion),
        ));
    }
    match distortion {
        Distortion::None => Ok(None),
        _ => Err(POSEWISE_E_INTRINSICS),
    }
}

/// `None` for an unknown model, and where a coefficient that it does not have is not 0.
pub(super) fn distortion_from(lens: &posewise_lens) -> Option<Distortion> {
    let posewise_lens {
        model,
        coefficients,
    } = *lens;
    match (model, coefficients) {
        (POSEWISE_LENS_PINHOLE, [0.0, 0.0, 0.0, 0.0, 0.0]) => Some(Distortion::None),
        (POSEWISE_LENS_BROWN, [k1, k2, p1, p2, k3]) => {
            Some(Distortion::BrownConrady { k1, k2, p1, p2, k3 })
        }
        (POSEWISE_LENS_FISHEYE, [k1, k2, k3, k4, 0.0]) => {
            Some(Distortion::KannalaBrandt { k1, k2, k3, k4 })
        }
        _ => None,
    }
}

/// `None`, the whole frame, where all are 0. The tracker checks other values.
pub(super) fn roi_from(given: &posewise_roi) -> Option<Roi> {
    let posewise_roi {
        x,
        y,
        width,
        height,
    } = *given;
    ([x, y, width, height] != [0; 4]).then_some(Roi::new(x, y, width, height))
}

/// The frame that a C struct describes.
///
/// # Safety
/// As at the head of memory.rs; the pixels are only read during the call.
pub(super) unsafe fn frame_from<'a>(given: &posewise_frame) -> Result<Frame<'a>, posewise_status> {
    if given.flags & !POSEWISE_FRAME_MIRRORED != 0 || given.reserved != 0 {
        return Err(POSEWISE_E_FLAGS);
    }
    // SAFETY: the caller's contract.
    let data = unsafe { memory::bytes(given.data, given.data_len, POSEWISE_E_FRAME)? };
    let rotation = match given.rotation_deg {
        0 => Rotation::None,
        90 => Rotation::Cw90,
        180 => Rotation::Half,
        270 => Rotation::Cw270,
        _ => return Err(POSEWISE_E_FRAME),
    };
    let layout = FrameLayout {
        format: PixelFormat::from_fourcc(given.format).ok_or(POSEWISE_E_FORMAT)?,
        width: given.width,
        height: given.height,
        stride: given.stride,
        rotation,
        mirrored: given.flags & POSEWISE_FRAME_MIRRORED != 0,
    };
    Frame::new(&layout, data).map_err(|_| POSEWISE_E_FRAME)
}

/// The hint that a C struct describes; the tracker checks its numbers.
pub(super) fn hint_from(given: &posewise_hint) -> FaceHint {
    FaceHint::new(given.face_box).with_angles(given.yaw_deg, given.roll_deg)
}

/// The status of a frame that the tracker rejects.
pub(super) fn step_error(error: StepError) -> posewise_status {
    match error {
        StepError::Time => POSEWISE_E_TIME,
        StepError::Hint => POSEWISE_E_HINT,
        StepError::Roi => POSEWISE_E_ROI,
        StepError::Group => POSEWISE_E_GROUP_TRACKERS,
    }
}

/// A result as its C struct, with `struct_size` 0.
pub(super) fn result_to(result: &TrackResult) -> posewise_result {
    let (state, landmark_count) = match result.state {
        State::Searching => (POSEWISE_SEARCHING, 0),
        State::Tracking => (POSEWISE_TRACKING, LANDMARKS as u32),
        State::Coasting => (POSEWISE_COASTING, LANDMARKS as u32),
    };
    let Eyes {
        each: [left, right],
        gaze,
        glasses,
        dark_glasses,
        look,
        ..
    } = &result.eyes;
    let gazes = [&left.gaze, &right.gaze, gaze];
    let direction = |gaze: &Result<Gaze, EyeUnknown>| gaze.map_or([0.0; 3], |gaze| gaze.camera);
    // Of a state without a face all is 0; else an unknown share is −1.
    let unknown = match result.state {
        State::Searching => 0.0,
        State::Tracking | State::Coasting => -1.0,
    };
    posewise_result {
        struct_size: 0, // write_struct() keeps the caller's
        state,
        timestamp_us: result.timestamp_us,
        age_us: result.age_us,
        landmark_count,
        confidence: result.confidence,
        face_box: result.face_box,
        rotation: result.rotation,
        yaw_deg: result.yaw_deg,
        pitch_deg: result.pitch_deg,
        roll_deg: result.roll_deg,
        translation_mm: result.translation_mm,
        eye_open: result.eye_open.map(|open| open.unwrap_or(unknown)),
        loss: loss_to(result.loss),
        visible_share: result.visible_share,
        rotation_sigma_deg: result.rotation_sigma_deg,
        translation_sigma_mm: result.translation_sigma_mm,
        eye_open_probability: [left.open, right.open].map(|open| open.unwrap_or(unknown)),
        eye_status: [left.open, right.open].map(eye_status_to),
        iris_left: left.iris,
        iris_right: right.iris,
        gaze_status: gazes.map(|gaze| eye_status_to(*gaze)),
        gaze_sigma_deg: gazes.map(|gaze| gaze.map_or(0.0, |gaze| gaze.sigma_deg)),
        gaze_left: direction(&left.gaze),
        gaze_right: direction(&right.gaze),
        gaze: direction(gaze),
        gaze_head: gaze.map_or([0.0; 3], |gaze| gaze.head),
        glasses: glasses.unwrap_or(unknown),
        dark_glasses: dark_glasses.unwrap_or(unknown),
        eye_look: *look,
        facing_yaw_deg: result.facing_yaw_deg,
        facing_pitch_deg: result.facing_pitch_deg,
        facing_roll_deg: result.facing_roll_deg,
        facing_sigma_deg: result.facing_sigma_deg,
        focal_px: result.focal_px,
        camera_assumed: u32::from(result.camera_assumed),
        facing_angle_deg: result.facing_angle_deg,
        interocular_px: result.interocular_px,
    }
}

fn eye_status_to<T>(known: Result<T, EyeUnknown>) -> u32 {
    match known {
        Err(EyeUnknown::NotSeen) => POSEWISE_EYE_NOT_SEEN,
        Ok(_) => POSEWISE_EYE_KNOWN,
        Err(EyeUnknown::Turned) => POSEWISE_EYE_TURNED,
        Err(EyeUnknown::Hidden) => POSEWISE_EYE_HIDDEN,
        Err(EyeUnknown::Small) => POSEWISE_EYE_SMALL,
        Err(EyeUnknown::Blurred) => POSEWISE_EYE_BLURRED,
        Err(EyeUnknown::Glare) => POSEWISE_EYE_GLARE,
        Err(EyeUnknown::DarkGlasses) => POSEWISE_EYE_DARK_GLASSES,
        Err(EyeUnknown::Shut) => POSEWISE_EYE_SHUT,
        Err(EyeUnknown::Uncertain) => POSEWISE_EYE_UNCERTAIN,
    }
}

fn loss_to(loss: Option<Loss>) -> u32 {
    match loss {
        None => POSEWISE_LOSS_NONE,
        Some(Loss::LowConfidence) => POSEWISE_LOSS_LOW_CONFIDENCE,
        Some(Loss::LeftFrame) => POSEWISE_LOSS_LEFT_FRAME,
        Some(Loss::NoPose) => POSEWISE_LOSS_NO_POSE,
        Some(Loss::Excluded) => POSEWISE_LOSS_EXCLUDED,
    }
}

/// An event as its C struct.
pub(super) fn event_to(event: &Event) -> posewise_event {
    posewise_event {
        timestamp_us: event.timestamp_us,
        kind: match event.kind {
            EventKind::Acquired => POSEWISE_EVENT_ACQUIRED,
            EventKind::Reacquired => POSEWISE_EVENT_REACQUIRED,
            EventKind::Coasting => POSEWISE_EVENT_COASTING,
            EventKind::Lost => POSEWISE_EVENT_LOST,
            EventKind::Suppressed => POSEWISE_EVENT_SUPPRESSED,
            EventKind::FilterOn => POSEWISE_EVENT_FILTER_ON,
            EventKind::FilterOff => POSEWISE_EVENT_FILTER_OFF,
            EventKind::Reset => POSEWISE_EVENT_RESET,
            EventKind::Forgotten => POSEWISE_EVENT_FORGOTTEN,
        },
        loss: loss_to(event.loss),
        face_box: event.face_box,
        confidence: event.confidence,
        reserved: 0,
    }
}

/// A face of a frame as its C struct.
pub(super) fn face_of(face: &FoundFace) -> posewise_face {
    posewise_face {
        face_box: face.face_box,
        yaw_deg: face.yaw_deg,
        roll_deg: face.roll_deg,
        confidence: face.confidence,
    }
}

/// The landmarks of a result in the order of the iBUG 68 scheme.
pub(super) fn landmarks_of(result: &TrackResult) -> impl Iterator<Item = posewise_landmark> {
    let points = result.landmarks.iter().zip(&result.points_mm);
    points.map(|(landmark, &[x_mm, y_mm, z_mm])| posewise_landmark {
        x: landmark.x,
        y: landmark.y,
        confidence: landmark.confidence,
        visibility: landmark.visibility,
        x_mm,
        y_mm,
        z_mm,
    })
}

const _: () = {
    assert!(
        posewise_format::MAX_SECTIONS == 32,
        "posewise_model_details.sections"
    );
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_region_of_the_settings_is_taken_and_checked() {
        let config = |roi: [u32; 4]| {
            let [x, y, width, height] = roi;
            let given = posewise_config {
                struct_size: size_of::<posewise_config>() as u32,
                roi: posewise_roi {
                    x,
                    y,
                    width,
                    height,
                },
                ..Default::default()
            };
            // SAFETY: a whole struct.
            unsafe { config_from(&given) }
        };
        assert_eq!(config([0; 4]), Ok(Config::default()));
        let roi = Some(Roi::new(8, 16, 320, 240));
        assert_eq!(config([8, 16, 320, 240]).map(|config| config.roi), Ok(roi));
        assert_eq!(config([8, 0, 0, 0]), Err(POSEWISE_E_ROI));
        assert_eq!(config([16384, 0, 1, 1]), Err(POSEWISE_E_ROI));
    }

    #[test]
    fn zero_is_a_default_unless_settings_are_exact() {
        let config = |flags, smoothing_beta| {
            let given = posewise_config {
                struct_size: size_of::<posewise_config>() as u32,
                flags,
                min_face_px: 40,
                scan_budget: 3600,
                smoothing_hz: 1.0,
                smoothing_beta,
                network_period: 1,
                ..Default::default()
            };
            // SAFETY: a whole struct.
            unsafe { config_from(&given) }.map(|config| config.smoothing.beta)
        };
        assert_eq!(config(0, 0.0), Ok(Smoothing::default().beta));
        assert_eq!(config(POSEWISE_EXACT, 0.0), Ok(0.0));
        assert_eq!(config(1, 0.0), Err(POSEWISE_E_FLAGS));
    }

    #[test]
    fn formats_are_those_of_the_image_module() {
        let header = [
            POSEWISE_FMT_GREY,
            POSEWISE_FMT_Y10,
            POSEWISE_FMT_Y16,
            POSEWISE_FMT_YUYV,
            POSEWISE_FMT_UYVY,
            POSEWISE_FMT_NV12,
            POSEWISE_FMT_NV21,
            POSEWISE_FMT_YU12,
            POSEWISE_FMT_RGB3,
            POSEWISE_FMT_BGR3,
            POSEWISE_FMT_XB24,
            POSEWISE_FMT_AB24,
            POSEWISE_FMT_XR24,
            POSEWISE_FMT_AR24,
            POSEWISE_FMT_BX24,
            POSEWISE_FMT_BA24,
            POSEWISE_FMT_RX24,
            POSEWISE_FMT_RA24,
        ];
        assert_eq!(header, PixelFormat::FOURCC.map(|(_, code)| code));
    }
}
