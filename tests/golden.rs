//! Golden replay: the same frames give the same bits, on every machine and after every change that
//! is not meant to alter results. `POSEWISE_BLESS=1 cargo test --test golden` accepts new results.

mod common;

use common::root;
use posewise::eyes::{Eye, EyeUnknown, Eyes, Gaze};
use posewise::mesh::{MAX_VERTICES, MeshShape, MeshSpace, MeshVertex};
use posewise::{ANIMATIONS, Config, Model, State, TrackResult, Tracker};

/// FNV-1a, 64 bits.
struct Hash(u64);

impl Hash {
    fn new() -> Hash {
        Hash(0xCBF2_9CE4_8422_2325)
    }

    fn vertices(&mut self, vertices: &[MeshVertex]) {
        for vertex in vertices {
            let MeshVertex {
                x,
                y,
                z,
                visibility,
            } = vertex;
            [x, y, z, visibility].iter().for_each(|v| self.float(**v));
        }
    }

    fn bytes(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01B3);
        }
    }

    fn float(&mut self, value: f32) {
        assert!(value.is_finite(), "results are finite");
        self.bytes(&value.to_bits().to_le_bytes());
    }

    /// The fields that the tests of JavaScript and Python hash too.
    fn result(&mut self, result: &TrackResult) {
        let TrackResult {
            state,
            timestamp_us,
            age_us,
            confidence,
            face_box,
            rotation,
            yaw_deg,
            pitch_deg,
            roll_deg,
            translation_mm,
            eye_open,
            loss,
            visible_share,
            rotation_sigma_deg,
            translation_sigma_mm,
            landmarks,
            points_mm,
            animation,
            // Hashed by themselves: nothing is seen of them unless the settings ask for it.
            eyes: _,
            facing_yaw_deg,
            facing_pitch_deg,
            facing_roll_deg,
            facing_sigma_deg,
            focal_px,
            camera_assumed,
            ..
        } = result;
        // As in C: an unknown share is −1, a loss that there is none of 0, and all else where there
        // is no face.
        let eye_open = eye_open.map(|open| share(*state, open));
        let loss = loss.map_or(0, |loss| loss as u8);
        self.bytes(&[*state as u8, loss, u8::from(*camera_assumed)]);
        self.bytes(&timestamp_us.to_le_bytes());
        self.bytes(&age_us.to_le_bytes());
        let points = landmarks.iter();
        [confidence, yaw_deg, pitch_deg, roll_deg, visible_share]
            .into_iter()
            .chain(face_box)
            .chain(rotation)
            .chain(translation_mm)
            .chain(&eye_open)
            .chain(rotation_sigma_deg)
            .chain(translation_sigma_mm)
            .chain(points.flat_map(|p| [&p.x, &p.y, &p.confidence, &p.visibility]))
            .chain(points_mm.iter().flatten())
            .chain(animation)
            .chain([facing_yaw_deg, facing_pitch_deg, facing_roll_deg, focal_px])
            .chain(facing_sigma_deg)
            .for_each(|value| self.float(*value));
    }

    fn eyes(&mut self, result: &TrackResult) {
        let Eyes {
            each,
            gaze,
            glasses,
            dark_glasses,
            look,
            ..
        } = &result.eyes;
        for Eye {
            open, iris, gaze, ..
        } in each
        {
            self.bytes(EyeUnknown::name_of(*open).as_bytes());
            self.float(share(result.state, open.ok()));
            iris.iter().for_each(|value| self.float(*value));
            self.gaze(gaze);
        }
        self.gaze(gaze);
        let glasses = [glasses, dark_glasses].map(|glasses| share(result.state, *glasses));
        glasses.iter().chain(look).for_each(|v| self.float(*v));
    }

    fn gaze(&mut self, gaze: &Result<Gaze, EyeUnknown>) {
        self.bytes(EyeUnknown::name_of(*gaze).as_bytes());
        let Gaze {
            camera,
            head,
            sigma_deg,
            ..
        } = gaze.unwrap_or(Gaze::new([0.0; 3], [0.0; 3], 0.0));
        let numbers = camera.iter().chain(&head).chain([&sigma_deg]);
        numbers.for_each(|value| self.float(*value));
    }
}

fn share(state: State, share: Option<f32>) -> f32 {
    share.unwrap_or(if state == State::Searching { 0.0 } else { -1.0 })
}

/// Hashes the demo clip's results by `hashed` and compares them with a file of `tests/data`.
fn check(config: &Config, file: &str, hashed: impl Fn(&mut Hash, &Tracker, &Model<'_>)) {
    let clip = common::demo();
    let model = common::model();
    let mut tracker = common::tracker(config);
    let mut hash = Hash::new();
    let mut tracked = 0;
    for i in 0..clip.luma.len() {
        let (frame, timestamp_us) = (clip.frame(i), clip.time_us(i));
        let result = tracker
            .step(&model, &frame, timestamp_us)
            .expect("in order");
        tracked += usize::from(result.state == State::Tracking);
        hashed(&mut hash, &tracker, &model);
    }
    let found = format!("{:016x} {tracked}/{} tracked\n", hash.0, clip.luma.len());
    let path = root().join("tests/data").join(file);
    if std::env::var_os("POSEWISE_BLESS").is_some() {
        std::fs::write(&path, &found).expect("tests/data is writable");
    }
    let expected = std::fs::read_to_string(&path).unwrap_or_default();
    assert_eq!(
        found, expected,
        "results changed (left: now); if that is meant: POSEWISE_BLESS=1 cargo test --test golden"
    );
}

#[test]
fn demo_clip_gives_the_same_bits() {
    check(&Config::default(), "demo.hash", |hash, tracker, _| {
        hash.result(tracker.result());
    });
}

/// Every field, also one that was added: the shortest texts of two numbers differ if a bit does.
#[test]
fn demo_clip_gives_the_same_text() {
    check(
        &Config::default().with_gaze(true),
        "demo-text.hash",
        |hash, tracker, _| {
            hash.bytes(format!("{:?}", tracker.result()).as_bytes());
        },
    );
}

#[test]
fn demo_clip_gives_the_same_bits_of_the_eyes() {
    let config = Config::default().with_gaze(true).with_natural_gaze(true);
    check(&config, "demo-eyes.hash", |hash, tracker, _| {
        hash.eyes(tracker.result());
    });
}

#[test]
fn demo_clip_gives_the_same_bits_of_the_mesh() {
    check(
        &Config::default(),
        "demo-mesh.hash",
        |hash, tracker, model| {
            let mut vertices = [MeshVertex::default(); MAX_VERTICES];
            for space in [MeshSpace::Picture, MeshSpace::Camera, MeshSpace::Head] {
                let count = tracker
                    .mesh(model, space, &mut vertices)
                    .unwrap_or_default();
                hash.vertices(&vertices[..count]);
            }
            let shapes = (0..ANIMATIONS).map(MeshShape::Animation);
            for shape in [MeshShape::Neutral].into_iter().chain(shapes) {
                let count = tracker.mesh_shape(model, shape, &mut vertices);
                hash.vertices(&vertices[..count.unwrap_or_default()]);
            }
        },
    );
}
