//! The functions of `include/posewise.h`.
//!
//! The header is generated from this file: the comments below are written for the C reader. It is
//! longer than others, because the header has one place for each group of functions.

// The contract of all pointers stands at the head of the header and of memory.rs.
#![allow(clippy::missing_safety_doc)]

use super::block::{self, BLOCK_SIZE};
use super::convert::{
    camera_from, config_error, config_from, distortion_from, event_to, face_of, frame_from,
    hint_from, landmarks_of, load, model_bytes, model_info_to, result_to, roi_from, step_error,
};
use super::events::Places;
use super::memory::written;
use super::types::*;
use super::{float_env, memory};
use crate::PARTS;
use crate::network;
use crate::shape::{ANIMATIONS, Distortion, LANDMARKS};
use crate::track::{Config, EVENTS, EYE_LOOKS, FoundFace, MAX_EXCLUDED};
use core::ffi::{CStr, c_char, c_void};

const _: () = assert!(POSEWISE_LANDMARKS as usize == LANDMARKS);
const _: () = assert!(POSEWISE_ANIMATIONS as usize == ANIMATIONS);
const _: () = assert!(POSEWISE_EYE_LOOKS as usize == EYE_LOOKS);
const _: () = assert!(POSEWISE_EVENTS as usize == EVENTS);
const _: () = assert!(POSEWISE_EXCLUDED as usize == MAX_EXCLUDED);
const _: () = assert!(POSEWISE_ALIGN as usize == posewise_format::ALIGN);
const _: () = assert!(POSEWISE_PART_MESH == 1 << (PARTS.len() - 1));

/// POSEWISE_VERSION of the linked library.
#[unsafe(no_mangle)]
pub extern "C" fn posewise_version() -> u32 {
    POSEWISE_VERSION
}

/// POSEWISE_ABI of the linked library.
#[unsafe(no_mangle)]
pub extern "C" fn posewise_abi() -> u32 {
    POSEWISE_ABI
}

/// The optional parts that the linked library was built with: bits POSEWISE_PART_*.
#[unsafe(no_mangle)]
pub extern "C" fn posewise_parts() -> u32 {
    let bits = PARTS.iter().zip(0u32..);
    bits.fold(0, |parts, ((_, has), bit)| parts | u32::from(*has) << bit)
}

/// Says which instructions the processor has beyond those that the library was compiled for: bits
/// POSEWISE_CPU_*, or 0. Steps get faster; results have the same bits. It holds for all trackers
/// from their next step on, so call it once at the start. Without it, a library for AArch64 uses
/// what every such processor has; on x86-64 the library finds out by itself, and the bits of other
/// machines have no effect. On Linux, POSEWISE_CPU_DOTPROD is HWCAP_ASIMDDP of getauxval(AT_HWCAP).
/// A bit that is not true ends the program with an illegal instruction.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn posewise_set_cpu(features: u32) -> posewise_status {
    status(|| {
        if features & !POSEWISE_CPU_DOTPROD != 0 {
            return Err(POSEWISE_E_FLAGS);
        }
        // SAFETY: the caller's contract.
        unsafe { network::set_dotprod(features & POSEWISE_CPU_DOTPROD != 0) };
        Ok(())
    })
}

/// Descriptions of all statuses.
static TEXTS: [(posewise_status, &CStr); 42] = [
    (POSEWISE_OK, c"success"),
    (POSEWISE_E_ARG, c"an argument is invalid"),
    (
        POSEWISE_E_MEMORY,
        c"the tracker's memory is too small or not 64-byte aligned",
    ),
    (
        POSEWISE_E_MODEL,
        c"a section of the model is missing or invalid",
    ),
    (
        POSEWISE_E_FRAME,
        c"width, height, stride, rotation and data_len of the frame are inconsistent",
    ),
    (
        POSEWISE_E_TIME,
        c"the timestamp is not after that of the last frame",
    ),
    (POSEWISE_E_FORMAT, c"the pixel format is not supported"),
    (POSEWISE_E_MODEL_ALIGN, c"the model is not 64-byte aligned"),
    (POSEWISE_E_MODEL_TRUNCATED, c"the model is truncated"),
    (POSEWISE_E_MODEL_MAGIC, c"not a .posewise model"),
    (
        POSEWISE_E_MODEL_VERSION,
        c"the format version of the model is not supported",
    ),
    (
        POSEWISE_E_MODEL_CHECKSUM,
        c"the checksum of the model does not match: the model is corrupt",
    ),
    (POSEWISE_E_NULL, c"a pointer is NULL"),
    (
        POSEWISE_E_POINTER_ALIGN,
        c"a pointer is not aligned to its type",
    ),
    (
        POSEWISE_E_STRUCT_SIZE,
        c"struct_size is not set, or not the size of the struct in a posewise.h",
    ),
    (
        POSEWISE_E_TRACKER,
        c"the pointer is not to a tracker of this library",
    ),
    (
        POSEWISE_E_OVERLAP,
        c"an output or the model lies in the tracker's memory",
    ),
    (
        POSEWISE_E_FLAGS,
        c"an unknown flag is set, or reserved is not 0",
    ),
    (
        POSEWISE_E_INTRINSICS,
        c"intrinsics: fx, fy must be 1..1000000, fy/fx 0.1..10, cx, cy -100000..100000",
    ),
    (
        POSEWISE_E_LENS,
        c"the lens: an unknown model, a coefficient out of range, or one that it does not have",
    ),
    (POSEWISE_E_MIN_FACE, c"min_face_px must be 24..4096"),
    (POSEWISE_E_SCAN_BUDGET, c"scan_budget must be 100..10000000"),
    (
        POSEWISE_E_HINT,
        c"the hint: its box must be 16..32768 px, its yaw -180..180, its roll -360..360 degrees",
    ),
    (
        POSEWISE_E_EXCLUDED,
        c"more than 16 excluded boxes, or one whose sides are not 1..32768 px",
    ),
    (
        POSEWISE_E_ROI,
        c"the region of interest is empty, ends beyond 16384 px or is not in the frame",
    ),
    (
        POSEWISE_E_MONITOR,
        c"the pointer is not to a driver monitor of this library",
    ),
    (
        POSEWISE_E_MONITOR_CONFIG,
        c"a setting of the driver monitor is out of range, or two are out of order",
    ),
    (
        POSEWISE_E_MONITOR_ZONES,
        c"more than 8 zones, or one whose kind or numbers are no zone",
    ),
    (POSEWISE_E_RECORD, c"the bytes are no record of this kind"),
    (
        POSEWISE_E_RECORD_VERSION,
        c"the record has a version that this library does not read",
    ),
    (
        POSEWISE_E_CAPACITY,
        c"an output has less room than is needed",
    ),
    (
        POSEWISE_E_NO_FACE,
        c"there is no face, or there was none yet",
    ),
    (
        POSEWISE_E_MESH,
        c"the model has no mesh, or the library was built without",
    ),
    (
        POSEWISE_E_MESH_SHAPE,
        c"the shape of the mesh is no POSEWISE_ANIMATION_*, nor neutral",
    ),
    (POSEWISE_E_NETWORK_PERIOD, c"network_period must be 1..8"),
    (
        POSEWISE_E_GROUP,
        c"the pointer is not to a group of this library",
    ),
    (POSEWISE_E_GROUP_TRACKERS, c"a group has 1..16 trackers"),
    (
        POSEWISE_E_MESH_SPACE,
        c"the space of the mesh is not a POSEWISE_MESH_SPACE_*",
    ),
    (
        POSEWISE_E_SMOOTHING,
        c"smoothing_hz must be 0.01..100 and smoothing_beta 0..1000",
    ),
    (
        POSEWISE_E_RECORD_SIZE,
        c"the record is cut, or has bytes behind its end",
    ),
    (
        POSEWISE_E_RECORD_CHECKSUM,
        c"the checksum of the record does not match: the record is damaged",
    ),
    (
        POSEWISE_E_RECORD_MODEL,
        c"the record was made with another 3D face than the model's",
    ),
];

/// A description of a status: one line of English, static, never NULL.
#[unsafe(no_mangle)]
pub extern "C" fn posewise_strerror(status: posewise_status) -> *const c_char {
    let described = TEXTS.iter().find(|(other, _)| *other == status);
    described
        .map_or(c"unknown status", |(_, text)| text)
        .as_ptr()
}

/// Writes the default settings with their values and POSEWISE_EXACT: what is set to 0 then is 0. As
/// for every struct, out->struct_size must be set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn posewise_config_default(out: *mut posewise_config) -> posewise_status {
    status(|| {
        let default = Config::default();
        let config = posewise_config {
            flags: POSEWISE_EXACT,
            min_face_px: default.min_face_px,
            scan_budget: default.scan_budget,
            smoothing_hz: default.smoothing.cutoff_hz,
            smoothing_beta: default.smoothing.beta,
            network_period: default.network_period,
            ..Default::default()
        };
        // SAFETY: the caller's contract.
        unsafe { memory::write_struct(out, memory::checked_size(out)?, &config) };
        Ok(())
    })
}

/// Memory that posewise_init() needs for these settings (NULL: defaults) \[bytes\], at most
/// POSEWISE_MEMORY_SIZE; 0 if the settings are invalid.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn posewise_memory_size(config: *const posewise_config) -> usize {
    // SAFETY: the caller's contract.
    match status(|| unsafe { config_from(config).map(drop) }) {
        POSEWISE_OK => BLOCK_SIZE,
        _ => 0,
    }
}

/// POSEWISE_ALIGN of the linked library.
#[unsafe(no_mangle)]
pub extern "C" fn posewise_memory_align() -> usize {
    POSEWISE_ALIGN as usize
}

/// The model built into the library, aligned; *len is its length \[bytes\]. NULL and 0 if the
/// library was built without one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn posewise_default_model(len: *mut usize) -> *const c_void {
    if memory::check_pointer(len).is_err() {
        return core::ptr::null();
    }
    #[cfg(feature = "default-model")]
    let model = crate::DEFAULT_MODEL;
    #[cfg(not(feature = "default-model"))]
    let model: &[u8] = &[];
    // SAFETY: checked above.
    unsafe { len.write(model.len()) };
    if model.is_empty() {
        core::ptr::null()
    } else {
        model.as_ptr().cast()
    }
}

/// Checks a whole model as posewise_init() does: POSEWISE_OK, or the error.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn posewise_model_check(
    model: *const c_void,
    model_len: usize,
) -> posewise_status {
    status(|| {
        // SAFETY: the caller's contract.
        load(unsafe { model_bytes(model, model_len)? }).map(|_| ())
    })
}

/// Writes name, terms and sections of a model and, of one that posewise_model_check() refuses,
/// which section and which check failed. Returns POSEWISE_OK for such a model too.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn posewise_model_info(
    model: *const c_void,
    model_len: usize,
    out: *mut posewise_model_details,
) -> posewise_status {
    status(|| {
        // SAFETY: the caller's contract, here and below.
        let size = unsafe { memory::checked_size(out)? };
        let bytes = unsafe { model_bytes(model, model_len)? };
        memory::require_disjoint(bytes.as_ptr(), bytes.len(), out, size)?;
        unsafe { memory::write_struct(out, size, &model_info_to(bytes)) };
        Ok(())
    })
}

/// Checks the model and the settings (NULL: defaults), then creates a tracker in memory. Memory and
/// model must outlive the tracker. The model is not copied; trackers may share it. Nothing needs to
/// be freed: the caller may reuse the memory at any time.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn posewise_init(
    out: *mut *mut posewise_tracker,
    memory: *mut c_void,
    memory_len: usize,
    model: *const c_void,
    model_len: usize,
    config: *const posewise_config,
) -> posewise_status {
    status(|| {
        memory::check_pointer(out)?;
        memory::check_pointer(memory.cast::<u8>())?;
        // SAFETY: the caller's contract.
        let config = unsafe { config_from(config)? };
        memory::check_room(memory, memory_len, BLOCK_SIZE)?;
        // SAFETY: the caller's contract.
        let model = unsafe { model_bytes(model, model_len)? };
        // The tracker would overwrite its model, or `out` the tracker.
        memory::require_disjoint(memory, BLOCK_SIZE, model.as_ptr(), model.len())?;
        memory::require_disjoint(memory, BLOCK_SIZE, out, size_of::<*mut posewise_tracker>())?;
        // SAFETY: aligned and long enough, as just checked.
        unsafe { block::place(memory.cast(), model, &config)? };
        // SAFETY: checked above.
        unsafe { out.write(memory.cast()) };
        Ok(())
    })
}

/// Processes one frame and writes its result. The work per call is bounded for any frame content;
/// nothing blocks.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn posewise_step(
    tracker: *mut posewise_tracker,
    frame: *const posewise_frame,
    out: *mut posewise_result,
) -> posewise_status {
    status(|| {
        // SAFETY: the caller's contract, here and below.
        let block = unsafe { block::get_mut(tracker)? };
        let given = unsafe { memory::read_struct(frame)? };
        let size = unsafe { memory::checked_size(out)? };
        memory::require_disjoint(tracker, BLOCK_SIZE, out, size)?;
        let frame = unsafe { frame_from(&given)? };
        let result = block
            .tracker
            .step(&block.model, &frame, given.timestamp_us)
            .map_err(step_error)?;
        unsafe { memory::write_struct(out, size, &result_to(result)) };
        Ok(())
    })
}

/// As posewise_step(), for a caller who expects a face somewhere: while searching, it is attempted
/// there first, then at what the detector finds near it, then the search goes on; one step in four
/// only searches. A face that is tracked, or was a moment ago, stays: call posewise_reset() first
/// to change it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn posewise_step_at(
    tracker: *mut posewise_tracker,
    frame: *const posewise_frame,
    hint: *const posewise_hint,
    out: *mut posewise_result,
) -> posewise_status {
    status(|| {
        // SAFETY: the caller's contract, here and below.
        let block = unsafe { block::get_mut(tracker)? };
        let given = unsafe { memory::read_struct(frame)? };
        let hint = hint_from(&unsafe { memory::read_struct(hint)? });
        let size = unsafe { memory::checked_size(out)? };
        memory::require_disjoint(tracker, BLOCK_SIZE, out, size)?;
        let frame = unsafe { frame_from(&given)? };
        let result = block
            .tracker
            .step_at(&block.model, &frame, given.timestamp_us, &hint)
            .map_err(step_error)?;
        unsafe { memory::write_struct(out, size, &result_to(result)) };
        Ok(())
    })
}

/// Looks for faces in a frame, whatever the tracker does, and writes the largest first: at most
/// min(capacity, 16) of them, and their number. frame->timestamp_us is not read.
///
/// A call does the work of posewise_config.scan_budget and at most one alignment more, and ends
/// early when out is full. The next call, on the same frame or the next one of a video, goes on
/// from there, until *finished is 1: then every place was searched, and the call after that begins
/// anew. With capacity 0 a call searches nothing, so *finished stays 0. Only faces in the region of
/// interest that are not excluded are found. A face may be found again by a later call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn posewise_detect(
    tracker: *mut posewise_tracker,
    frame: *const posewise_frame,
    out: *mut posewise_face,
    capacity: usize,
    count: *mut usize,
    finished: *mut u32,
) -> posewise_status {
    status(|| {
        // SAFETY: the caller's contract, here and below.
        let block = unsafe { block::get_mut(tracker)? };
        let given = unsafe { memory::read_struct(frame)? };
        memory::check_pointer(out)?;
        memory::check_pointer(count)?;
        memory::check_pointer(finished)?;
        let mut found = [FoundFace::default(); MAX_FOUND];
        let most = capacity.min(found.len());
        let bytes = written::<posewise_face>(capacity, MAX_FOUND);
        memory::require_disjoint(tracker, BLOCK_SIZE, out, bytes)?;
        memory::require_disjoint(tracker, BLOCK_SIZE, count, size_of::<usize>())?;
        memory::require_disjoint(tracker, BLOCK_SIZE, finished, size_of::<u32>())?;
        let frame = unsafe { frame_from(&given)? };
        let found = found.get_mut(..most).unwrap_or_default();
        let detected = block
            .tracker
            .detect(&block.model, &frame, found)
            .map_err(step_error)?;
        unsafe {
            memory::write_first(out, detected.count, found.iter().map(face_of))?;
            count.write(detected.count);
            finished.write(u32::from(detected.finished));
        }
        Ok(())
    })
}

/// Gives the boxes of faces that other trackers follow, which replace those given before: `count`
/// boxes, at most POSEWISE_EXCLUDED, of four numbers each: x, y, width, height \[px\]. From the
/// next step on, this tracker neither finds nor follows a face there. Its own face, if it is one of
/// them, is lost with POSEWISE_LOSS_EXCLUDED. boxes may be NULL if count is 0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn posewise_set_excluded(
    tracker: *mut posewise_tracker,
    boxes: *const f32,
    count: usize,
) -> posewise_status {
    status(|| {
        // SAFETY: the caller's contract.
        let tracker = &mut unsafe { block::get_mut(tracker)? }.tracker;
        if count > MAX_EXCLUDED {
            return Err(POSEWISE_E_EXCLUDED);
        }
        let boxes: &[[f32; 4]] = if count == 0 {
            &[]
        } else {
            memory::check_pointer(boxes)?;
            // SAFETY: non-NULL, aligned, and `count` boxes by the caller's contract.
            unsafe { core::slice::from_raw_parts(boxes.cast(), count) }
        };
        tracker.set_excluded(boxes).map_err(config_error)
    })
}

/// Writes the first min(capacity, POSEWISE_LANDMARKS) landmarks of the last step; all zero while
/// searching.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn posewise_landmarks(
    tracker: *const posewise_tracker,
    out: *mut posewise_landmark,
    capacity: usize,
) -> posewise_status {
    status(|| {
        // SAFETY: the caller's contract.
        let result = unsafe { block::get(tracker)? }.tracker.result();
        let most = written::<posewise_landmark>(capacity, LANDMARKS);
        memory::require_disjoint(tracker, BLOCK_SIZE, out, most)?;
        // SAFETY: the caller's contract.
        unsafe { memory::write_first(out, capacity, landmarks_of(result)) }
    })
}

/// Writes the first min(capacity, POSEWISE_ANIMATIONS) animation weights of the last step, 0..1;
/// all zero while searching. From POSEWISE_ANIMATION_CHEEK_PUFF on they are those that the 3D face
/// has no modes for; with a model without section `WGHT` they are 0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn posewise_animation(
    tracker: *const posewise_tracker,
    out: *mut f32,
    capacity: usize,
) -> posewise_status {
    status(|| {
        // SAFETY: the caller's contract.
        let result = unsafe { block::get(tracker)? }.tracker.result();
        let most = written::<f32>(capacity, ANIMATIONS);
        memory::require_disjoint(tracker, BLOCK_SIZE, out, most)?;
        // SAFETY: the caller's contract.
        unsafe { memory::write_first(out, capacity, result.animation.into_iter()) }
    })
}

/// The result of the last step, smoothed over time by a One-Euro filter: less jitter, about one
/// frame of lag. Pose, box and eye_open are smoothed, the other fields are unchanged.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn posewise_smoothed(
    tracker: *const posewise_tracker,
    out: *mut posewise_result,
) -> posewise_status {
    status(|| {
        // SAFETY: the caller's contract, here and below.
        let result = unsafe { block::get(tracker)? }.tracker.smoothed();
        let size = unsafe { memory::checked_size(out)? };
        memory::require_disjoint(tracker, BLOCK_SIZE, out, size)?;
        unsafe { memory::write_struct(out, size, &result_to(result)) };
        Ok(())
    })
}

/// As posewise_landmarks(), smoothed likewise; confidence and visibility are unchanged.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn posewise_smoothed_landmarks(
    tracker: *const posewise_tracker,
    out: *mut posewise_landmark,
    capacity: usize,
) -> posewise_status {
    status(|| {
        // SAFETY: the caller's contract.
        let result = unsafe { block::get(tracker)? }.tracker.smoothed();
        let most = written::<posewise_landmark>(capacity, LANDMARKS);
        memory::require_disjoint(tracker, BLOCK_SIZE, out, most)?;
        // SAFETY: the caller's contract.
        unsafe { memory::write_first(out, capacity, landmarks_of(result)) }
    })
}

/// As posewise_animation(), smoothed likewise.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn posewise_smoothed_animation(
    tracker: *const posewise_tracker,
    out: *mut f32,
    capacity: usize,
) -> posewise_status {
    status(|| {
        // SAFETY: the caller's contract.
        let result = unsafe { block::get(tracker)? }.tracker.smoothed();
        let most = written::<f32>(capacity, ANIMATIONS);
        memory::require_disjoint(tracker, BLOCK_SIZE, out, most)?;
        // SAFETY: the caller's contract.
        unsafe { memory::write_first(out, capacity, result.animation.into_iter()) }
    })
}

/// Takes the unread events out of the tracker's log, oldest first, and writes the first capacity of
/// them; *count is how many were written. *overwritten is how many were lost since the last call,
/// because more than POSEWISE_EVENTS came unread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn posewise_events(
    tracker: *mut posewise_tracker,
    out: *mut posewise_event,
    capacity: usize,
    count: *mut usize,
    overwritten: *mut usize,
) -> posewise_status {
    status(|| {
        // SAFETY: the caller's contract, here and below.
        let log = unsafe { block::get_mut(tracker)? }.tracker.events();
        let places = Places {
            out,
            capacity,
            count,
            overwritten,
        };
        unsafe { places.fill(log, (tracker, BLOCK_SIZE), event_to) }
    })
}

/// Forgets the face, its identity and the last timestamp; model, settings and unread events stay.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn posewise_reset(tracker: *mut posewise_tracker) -> posewise_status {
    status(|| {
        // SAFETY: the caller's contract.
        unsafe { block::get_mut(tracker)? }.tracker.reset();
        Ok(())
    })
}

/// Forgets the identity, as for a change of driver: the shape of the head is estimated anew from
/// the next frames. Tracking goes on, and the result of the last step stays.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn posewise_forget_identity(
    tracker: *mut posewise_tracker,
) -> posewise_status {
    status(|| {
        // SAFETY: the caller's contract.
        unsafe { block::get_mut(tracker)? }
            .tracker
            .forget_identity();
        Ok(())
    })
}

/// Changes the camera (zoom, another resolution) from the next step on; its lens stays. NULL or all
/// zero: the default, a horizontal field of view of 60 degrees without a lens.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn posewise_set_intrinsics(
    tracker: *mut posewise_tracker,
    intrinsics: *const posewise_intrinsics,
) -> posewise_status {
    status(|| {
        // SAFETY: the caller's contract.
        let tracker = &mut unsafe { block::get_mut(tracker)? }.tracker;
        let camera = if intrinsics.is_null() {
            None
        } else {
            memory::check_pointer(intrinsics)?;
            // SAFETY: checked above.
            camera_from(unsafe { &*intrinsics }, &posewise_lens::default())?
        };
        let distortion = tracker.config().intrinsics.map(|old| old.distortion);
        let camera = camera.map(|camera| camera.with_distortion(distortion.unwrap_or_default()));
        tracker.set_intrinsics(camera).map_err(config_error)
    })
}

/// Changes the lens from the next step on; NULL: none. There must be intrinsics, of the settings or
/// of posewise_set_intrinsics().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn posewise_set_lens(
    tracker: *mut posewise_tracker,
    lens: *const posewise_lens,
) -> posewise_status {
    status(|| {
        // SAFETY: the caller's contract.
        let tracker = &mut unsafe { block::get_mut(tracker)? }.tracker;
        let distortion = if lens.is_null() {
            Distortion::None
        } else {
            memory::check_pointer(lens)?;
            // SAFETY: checked above.
            distortion_from(unsafe { &*lens }).ok_or(POSEWISE_E_LENS)?
        };
        let camera = tracker.config().intrinsics;
        match (camera, distortion) {
            (None, Distortion::None) => Ok(()),
            (None, _) => Err(POSEWISE_E_INTRINSICS),
            (Some(camera), _) => tracker
                .set_intrinsics(Some(camera.with_distortion(distortion)))
                .map_err(config_error),
        }
    })
}

/// Changes the region of interest from the next step on: only faces that are centred in it are
/// found, and only it is scanned, which takes less time. A face that is tracked may leave it. A
/// frame that does not hold all of it is POSEWISE_E_ROI. NULL or all zero: the whole frame.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn posewise_set_roi(
    tracker: *mut posewise_tracker,
    roi: *const posewise_roi,
) -> posewise_status {
    status(|| {
        // SAFETY: the caller's contract.
        let tracker = &mut unsafe { block::get_mut(tracker)? }.tracker;
        let roi = if roi.is_null() {
            None
        } else {
            memory::check_pointer(roi)?;
            // SAFETY: checked above.
            roi_from(unsafe { &*roi })
        };
        tracker.set_roi(roi).map_err(config_error)
    })
}

/// Runs the body of a function in the default floating-point environment; returns its status.
pub(super) fn status(body: impl FnOnce() -> Result<(), posewise_status>) -> posewise_status {
    match float_env::with_default(body) {
        Ok(()) => POSEWISE_OK,
        Err(status) => status,
    }
}

/// Most faces of one call of posewise_detect(): they lie on its stack.
const MAX_FOUND: usize = 16;
