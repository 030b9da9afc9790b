//! A tracker in guarded memory, and all its outputs after a step, checked.

use super::memory::{Exact, Guarded};
use crate::ffi::{api::*, mesh::*, types::*};
use std::mem::size_of;

/// Result, landmarks and animation weights, byte by byte.
#[derive(Clone, PartialEq, Eq)]
pub struct Outputs(Vec<u8>);

const RESULT: usize = size_of::<posewise_result>();
const LANDMARK: usize = size_of::<posewise_landmark>();
const LANDMARKS: usize = POSEWISE_LANDMARKS as usize;
const ANIMATIONS: usize = POSEWISE_ANIMATIONS as usize;

/// The four-byte words of some bytes.
fn words(bytes: &[u8]) -> impl Iterator<Item = u32> + '_ {
    let (words, _) = bytes.as_chunks::<4>();
    words.iter().map(|b| u32::from_le_bytes(*b))
}

impl Outputs {
    /// The outputs of a tracker whose last step wrote the bytes `result`.
    pub fn of(tracker: *const posewise_tracker, result: &[u8]) -> Outputs {
        let landmarks = Guarded::new(LANDMARKS * LANDMARK, 0x77);
        let weights = Guarded::new(ANIMATIONS * 4, 0x77);
        // SAFETY: the memory is as long as the capacities say.
        unsafe {
            let status = posewise_landmarks(tracker, landmarks.ptr().cast(), LANDMARKS);
            assert_eq!(status, POSEWISE_OK);
            let status = posewise_animation(tracker, weights.ptr().cast(), ANIMATIONS);
            assert_eq!(status, POSEWISE_OK);
        }
        landmarks.check();
        weights.check();
        check_smoothed(tracker);
        let state = words(result).nth(1).expect("a state");
        check_mesh(tracker, state);
        let outputs = Outputs([&result[..RESULT], landmarks.get(), weights.get()].concat());
        outputs.check();
        outputs
    }

    pub fn bytes(&self) -> &[u8] {
        &self.0
    }

    pub fn landmarks(&self) -> &[u8] {
        &self.0[RESULT..RESULT + LANDMARKS * LANDMARK]
    }

    pub fn animation(&self) -> &[u8] {
        &self.0[RESULT + LANDMARKS * LANDMARK..]
    }

    pub fn timestamp_us(&self) -> i64 {
        self.result().timestamp_us
    }

    pub fn is_tracking(&self) -> bool {
        self.result().state == POSEWISE_TRACKING
    }

    pub fn result(&self) -> posewise_result {
        // SAFETY: as long as the struct, in which every bit pattern is valid.
        unsafe { self.0.as_ptr().cast::<posewise_result>().read_unaligned() }
    }

    /// Checks what the header states of every result.
    fn check(&self) {
        let r = self.result();
        let text = finite_text(&r);
        assert!(words(&self.0[RESULT..]).all(|w| f32::from_bits(w).is_finite()));
        let weights: Vec<f32> = words(self.animation()).map(f32::from_bits).collect();
        let unit = |v: &f32| (0.0..=1.0).contains(v);
        assert!(weights.iter().all(unit), "{weights:?}");
        assert!(unit(&r.confidence), "{r:?}");
        for landmark in self.landmarks().chunks_exact(LANDMARK) {
            let v: Vec<f32> = words(landmark).map(f32::from_bits).collect();
            assert!(unit(&v[2]) && unit(&v[3]), "{v:?}");
        }
        match r.state {
            POSEWISE_SEARCHING => {
                let zero = posewise_result {
                    struct_size: r.struct_size,
                    timestamp_us: r.timestamp_us,
                    loss: r.loss,
                    ..Default::default()
                };
                assert_eq!(text, format!("{zero:?}"), "searching, but not zero");
                assert!(words(&self.0[RESULT..]).all(|w| w == 0));
            }
            POSEWISE_TRACKING | POSEWISE_COASTING => {
                assert_eq!(r.landmark_count, POSEWISE_LANDMARKS);
                assert!(r.age_us >= 0 && (r.state == POSEWISE_COASTING || r.age_us == 0));
                let norm: f32 = r.rotation.iter().map(|v| v * v).sum();
                assert!((norm - 1.0).abs() < 1e-3, "no unit quaternion: {r:?}");
                let turns = [r.yaw_deg, r.roll_deg, r.facing_yaw_deg, r.facing_roll_deg];
                assert!(turns.iter().all(|v| v.abs() <= 180.01), "{r:?}");
                let pitches = [r.pitch_deg, r.facing_pitch_deg];
                assert!(pitches.iter().all(|v| v.abs() <= 90.01), "{r:?}");
                let is_half_turn = |v: &f32| (0.0..=180.0).contains(v);
                assert!(r.facing_sigma_deg.iter().all(is_half_turn), "{r:?}");
                assert!(r.focal_px >= 1.0 && r.camera_assumed <= 1, "{r:?}");
                assert!(
                    is_half_turn(&r.facing_angle_deg) && r.interocular_px >= 0.0,
                    "{r:?}"
                );
                assert!(r.eye_open.iter().all(|v| unit(v) || *v == -1.0), "{r:?}");
                check_eyes(&r);
            }
            other => panic!("state {other}"),
        }
    }
}

/// Checks what the header states of the eyes of a face.
fn check_eyes(r: &posewise_result) {
    let unit = |v: &f32| (0.0..=1.0).contains(v);
    let or_unknown = |v: &f32| unit(v) || *v == -1.0;
    assert!(r.eye_open_probability.iter().all(or_unknown), "{r:?}");
    assert!(
        or_unknown(&r.glasses) && or_unknown(&r.dark_glasses),
        "{r:?}"
    );
    assert!(r.eye_look.iter().all(unit), "{r:?}");
    let gazes = [r.gaze_left, r.gaze_right, r.gaze];
    for ((gaze, unknown), sigma_deg) in gazes.iter().zip(r.gaze_status).zip(r.gaze_sigma_deg) {
        let norm: f32 = gaze.iter().map(|v| v * v).sum();
        match unknown {
            POSEWISE_EYE_KNOWN => {
                assert!((norm - 1.0).abs() < 1e-3 && sigma_deg > 0.0, "{r:?}");
            }
            _ => assert!(norm == 0.0 && sigma_deg == 0.0, "{r:?}"),
        }
    }
}

/// A struct as text, with all fields, those of a later header too; every number must be finite.
fn finite_text(value: &impl std::fmt::Debug) -> String {
    let text = format!("{value:?}");
    let finite = !text.contains("NaN") && !text.contains("inf");
    assert!(finite, "a number is not finite: {text}");
    text
}

const SPACES: [u32; 3] = [
    POSEWISE_MESH_SPACE_PICTURE,
    POSEWISE_MESH_SPACE_CAMERA,
    POSEWISE_MESH_SPACE_HEAD,
];
const MOST_VERTICES: usize = POSEWISE_MESH_VERTICES as usize;

/// `posewise_mesh()`, or `posewise_mesh_shape()`.
type MeshFunction = unsafe extern "C" fn(
    *const posewise_tracker,
    u32,
    *mut posewise_mesh_vertex,
    usize,
    *mut usize,
) -> i32;

/// Checks what the header states of the mesh of the last step, in every space, and of the shapes of
/// the head.
fn check_mesh(tracker: *const posewise_tracker, state: u32) {
    for space in SPACES {
        let status = check_vertices(tracker, posewise_mesh, space);
        let searching = state == POSEWISE_SEARCHING;
        assert!(status == POSEWISE_E_MESH || (status == POSEWISE_E_NO_FACE) == searching);
    }
    let (status, ..) = vertices(tracker, posewise_mesh, 3, MOST_VERTICES);
    assert_eq!(status, POSEWISE_E_MESH_SPACE);
    for shape in (0..POSEWISE_ANIMATIONS).chain([POSEWISE_MESH_NEUTRAL]) {
        let status = check_vertices(tracker, posewise_mesh_shape, shape);
        // That of the last face, if there was one.
        assert!(status != POSEWISE_E_NO_FACE || state == POSEWISE_SEARCHING);
    }
    let shape = POSEWISE_ANIMATIONS;
    let (status, ..) = vertices(tracker, posewise_mesh_shape, shape, MOST_VERTICES);
    assert_eq!(status, POSEWISE_E_MESH_SHAPE);
}

/// What a function writes where there is room for `capacity` vertices.
fn vertices(
    tracker: *const posewise_tracker,
    function: MeshFunction,
    which: u32,
    capacity: usize,
) -> (i32, Guarded, usize) {
    let vertices = Guarded::new(capacity * size_of::<posewise_mesh_vertex>(), UNTOUCHED);
    let count = Guarded::new(size_of::<usize>(), UNTOUCHED);
    let out = (vertices.ptr().cast(), count.ptr().cast());
    // SAFETY: as long as the capacity says.
    let status = unsafe { function(tracker, which, out.0, capacity, out.1) };
    vertices.check();
    count.check();
    let untouched = |memory: &Guarded| memory.get().iter().all(|b| *b == UNTOUCHED);
    assert!(status == POSEWISE_OK || untouched(&vertices) && untouched(&count));
    let count = usize::from_ne_bytes(count.get().try_into().expect("a length"));
    (status, vertices, count)
}

/// Checks the vertices that a function writes; returns its status.
fn check_vertices(tracker: *const posewise_tracker, function: MeshFunction, which: u32) -> i32 {
    let (status, written, count) = vertices(tracker, function, which, MOST_VERTICES);
    if [POSEWISE_E_MESH, POSEWISE_E_NO_FACE].contains(&status) {
        return status;
    }
    assert_eq!(status, POSEWISE_OK);
    assert!((LANDMARKS..=MOST_VERTICES).contains(&count));
    let length = count * size_of::<posewise_mesh_vertex>();
    let (written, rest) = written.get().split_at(length);
    assert!(rest.iter().all(|b| *b == UNTOUCHED));
    let numbers: Vec<f32> = words(written).map(f32::from_bits).collect();
    assert!(numbers.iter().all(|v| v.is_finite()), "{numbers:?}");
    let mut seen = numbers.iter().skip(3).step_by(4);
    assert!(seen.all(|v| (0.0..=1.0).contains(v)), "{numbers:?}");
    let (too_small, ..) = vertices(tracker, function, which, count - 1);
    assert_eq!(too_small, POSEWISE_E_CAPACITY);
    status
}

/// The smoothed result has the state of the last one, and finite numbers.
fn check_smoothed(tracker: *const posewise_tracker) {
    let mut smoothed = posewise_result {
        struct_size: RESULT as u32,
        ..Default::default()
    };
    // SAFETY: a whole struct.
    let status = unsafe { posewise_smoothed(tracker, &mut smoothed) };
    assert_eq!(status, POSEWISE_OK);
    finite_text(&smoothed);
    let found = smoothed.state != POSEWISE_SEARCHING;
    assert_eq!(found, smoothed.landmark_count == POSEWISE_LANDMARKS);
}

/// Byte of memory for outputs before a call.
pub const UNTOUCHED: u8 = 0x55;

const FACE: usize = size_of::<posewise_face>();

/// Most faces of one call of `posewise_detect()`.
const MOST_FACES: usize = 16;

/// Memory for the outputs of `posewise_detect()`: faces, their count, whether it has finished.
pub fn faces_memory(capacity: usize) -> [Guarded; 3] {
    [
        capacity.min(MOST_FACES) * FACE,
        size_of::<usize>(),
        size_of::<u32>(),
    ]
    .map(|len| Guarded::new(len, UNTOUCHED))
}

/// Checks what the header states of the outputs of `posewise_detect()`.
pub fn check_faces([faces, count, finished]: [&Guarded; 3]) {
    let count = usize::from_ne_bytes(count.get().try_into().expect("a length"));
    let finished = u32::from_ne_bytes(finished.get().try_into().expect("a word"));
    assert!(count * FACE <= faces.len() && finished <= 1);
    let (found, rest) = faces.get().split_at(count * FACE);
    assert!(rest.iter().all(|b| *b == UNTOUCHED));
    for face in found.chunks_exact(FACE) {
        // SAFETY: as long as the struct, in which every bit pattern is valid.
        let face = unsafe { face.as_ptr().cast::<posewise_face>().read_unaligned() };
        let text = finite_text(&face);
        let [_, _, width, height] = face.face_box;
        assert!(width > 0.0 && height > 0.0, "{text}");
        assert!(
            face.yaw_deg.abs() <= 90.0 && face.roll_deg.abs() <= 180.01,
            "{text}"
        );
        assert!((0.0..=1.0).contains(&face.confidence), "{text}");
    }
}

/// A tracker in memory of its own.
pub struct Tracker {
    memory: Guarded,
    out: Guarded,
}

impl Tracker {
    /// A tracker in memory that was filled with `fill`; or the status, with the memory untouched.
    pub fn new(
        model: &Exact,
        config: Option<&posewise_config>,
        fill: u8,
    ) -> Result<Tracker, posewise_status> {
        let config = config.map_or(std::ptr::null(), std::ptr::from_ref);
        // SAFETY: NULL or a whole struct.
        let size = unsafe { posewise_memory_size(config) };
        let memory = Guarded::new(size, fill);
        let mut tracker = std::ptr::null_mut();
        // SAFETY: the memory is as long as stated, and the caller keeps the model.
        let status = unsafe {
            let len = model.get().len();
            let (start, model) = (memory.ptr().cast(), model.ptr().cast());
            posewise_init(&mut tracker, start, size, model, len, config)
        };
        memory.check();
        if status != POSEWISE_OK {
            assert!(tracker.is_null() && memory.get().iter().all(|b| *b == fill));
            return Err(status);
        }
        assert_eq!(tracker.cast::<u8>(), memory.ptr());
        let out = Guarded::new(RESULT, 0);
        Ok(Tracker { memory, out })
    }

    pub fn ptr(&self) -> *mut posewise_tracker {
        self.memory.ptr().cast()
    }

    /// The tracker's bytes, between their guards.
    pub fn memory(&mut self) -> &mut Guarded {
        &mut self.memory
    }

    /// One step. Checks that a failed step leaves its output untouched.
    ///
    /// # Safety
    /// `frame` is NULL or as `posewise.h` describes it.
    pub unsafe fn step(
        &mut self,
        frame: *const posewise_frame,
    ) -> Result<Outputs, posewise_status> {
        // SAFETY: the caller's contract.
        unsafe { self.step_at(frame, std::ptr::null()) }
    }

    /// As [`step`](Self::step), with a hint unless that is NULL.
    ///
    /// # Safety
    /// `frame` and `hint` are NULL or as `posewise.h` describes them.
    pub unsafe fn step_at(
        &mut self,
        frame: *const posewise_frame,
        hint: *const posewise_hint,
    ) -> Result<Outputs, posewise_status> {
        let tracker = self.memory.ptr().cast();
        let size = RESULT as u32;
        self.out.get_mut().fill(0x77);
        self.out.get_mut()[..4].copy_from_slice(&size.to_ne_bytes());
        // SAFETY: the caller's contract.
        let status = unsafe {
            match hint.is_null() {
                true => posewise_step(tracker, frame, self.out.ptr().cast()),
                false => posewise_step_at(tracker, frame, hint, self.out.ptr().cast()),
            }
        };
        self.memory.check();
        self.out.check();
        assert_eq!(self.out.get()[..4], size.to_ne_bytes());
        if status != POSEWISE_OK {
            assert!(self.out.get()[4..].iter().all(|b| *b == 0x77));
            return Err(status);
        }
        Ok(Outputs::of(tracker, self.out.get()))
    }

    /// Faces of a frame, their count, and whether the scan has finished. Checks that a failed call
    /// leaves its outputs untouched.
    ///
    /// # Safety
    /// `frame` is NULL or as `posewise.h` describes it.
    pub unsafe fn detect(
        &mut self,
        frame: *const posewise_frame,
    ) -> Result<[Vec<u8>; 3], posewise_status> {
        let [faces, count, finished] = faces_memory(MOST_FACES);
        // SAFETY: the caller's contract.
        let status = unsafe {
            posewise_detect(
                self.memory.ptr().cast(),
                frame,
                faces.ptr().cast(),
                MOST_FACES,
                count.ptr().cast(),
                finished.ptr().cast(),
            )
        };
        self.memory.check();
        let outputs = [&faces, &count, &finished];
        for output in outputs {
            output.check();
            let untouched = output.get().iter().all(|b| *b == UNTOUCHED);
            assert!(status == POSEWISE_OK || untouched);
        }
        if status != POSEWISE_OK {
            return Err(status);
        }
        check_faces(outputs);
        Ok(outputs.map(|output| output.get().to_vec()))
    }
}
