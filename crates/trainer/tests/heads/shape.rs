//! The 3D face: section written and read back, poses and identities recovered.

use glam::{Mat3, Vec3};
use posewise::math::HeadAngles;
use posewise::shape::{
    Animation, FITTED, FaceFit, FaceModel, FaceState, FitOptions, Identity, IdentityEstimator,
    Intrinsics, LANDMARKS, MAX_IDENTITIES, Observed, Pose, Project, RotationPrior, fit,
};
use posewise_format::{AlignedBytes, Blob, blob, reseal};
use posewise_train::face_section::{face_section, open};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::sync::LazyLock;

static BYTES: LazyLock<Vec<u8>> =
    LazyLock::new(|| blob(&[face_section(&crate::common::head(), None).unwrap()]));
static MODEL: LazyLock<AlignedBytes> = LazyLock::new(|| AlignedBytes::new(&BYTES));

/// The 3D face of a head of no one.
fn face() -> FaceModel<'static> {
    open(&Blob::open(&MODEL).unwrap()).unwrap()
}

const CAMERA: Intrinsics = Intrinsics::new(550.0, 550.0, 319.5, 239.5);
const NOBODY: Identity = [0.0; MAX_IDENTITIES];
const ALL: [f32; LANDMARKS] = [1.0; LANDMARKS];

fn gauss(rng: &mut impl Rng) -> f32 {
    let (u, v): (f32, f32) = (rng.random_range(1e-6..1.0), rng.random());
    (-2.0 * u.ln()).sqrt() * (std::f32::consts::TAU * v).cos()
}

/// Landmarks that a camera would see, the jaw on the contour.
fn seen(
    face: &FaceModel<'_>,
    state: &FaceState,
    noise_px: f32,
    rng: &mut impl Rng,
) -> [[f32; 2]; LANDMARKS] {
    let shape = face.animated(&face.neutral(&state.identity), &state.animation);
    let contour = shape.contour(face, &state.pose);
    let mut index = 0;
    [(); LANDMARKS].map(|()| {
        let point = contour.get(index).map_or(index, |p| *p as usize);
        index += 1;
        let [x, y] = CAMERA.project(state.pose.apply(shape.at(point)));
        [x + noise_px * gauss(rng), y + noise_px * gauss(rng)]
    })
}

fn pose(yaw_deg: f32, pitch_deg: f32, roll_deg: f32) -> Pose {
    let angles = HeadAngles {
        yaw_deg,
        pitch_deg,
        roll_deg,
    };
    Pose::of_angles(angles, Vec3::new(30.0, -20.0, 550.0))
}

/// Angle between two rotations \[deg\].
fn apart(a: &Pose, b: &Pose) -> f32 {
    let r = a.rotation * b.rotation.transpose();
    let cos = (r.x_axis.x + r.y_axis.y + r.z_axis.z - 1.0) / 2.0;
    cos.clamp(-1.0, 1.0).acos().to_degrees()
}

fn fitted(
    face: &FaceModel<'_>,
    points: &[[f32; 2]; LANDMARKS],
    start: Option<&FaceState>,
) -> FaceFit {
    let observed = Observed {
        points,
        weights: &ALL,
    };
    fit(
        face,
        &CAMERA,
        &observed,
        start,
        &NOBODY,
        &FitOptions::default(),
    )
    .expect("a fit")
}

#[test]
fn poses_come_back_to_profile() {
    let face = &face();
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    for yaw in (-90..=90).step_by(15) {
        for (pitch, roll) in [(0.0, 0.0), (20.0, -15.0), (-20.0, 30.0)] {
            let truth = FaceState {
                pose: pose(yaw as f32, pitch, roll),
                ..FaceState::default()
            };
            let exact = seen(face, &truth, 0.0, &mut rng);
            let fit = fitted(face, &exact, None);
            let off = apart(&fit.state.pose, &truth.pose);
            assert!(
                off < 0.5,
                "yaw {yaw} pitch {pitch}: {off} deg from exact points"
            );
            assert!((fit.state.pose.translation_mm - truth.pose.translation_mm).length() < 5.0);
            // 2.5 % of the 64 mm between the eyes.
            let noisy = seen(face, &truth, 1.6 * 550.0 / 550.0, &mut rng);
            let off = apart(&fitted(face, &noisy, None).state.pose, &truth.pose);
            assert!(
                off < 4.0,
                "yaw {yaw} pitch {pitch}: {off} deg from noisy points"
            );
        }
    }
}

#[test]
fn a_prior_of_the_rotation_counts_by_its_weight() {
    let face = &face();
    let mut rng = ChaCha8Rng::seed_from_u64(9);
    let truth = FaceState {
        pose: pose(70.0, 0.0, 0.0),
        ..FaceState::default()
    };
    let points = seen(face, &truth, 0.5, &mut rng);
    let prior = pose(80.0, 0.0, 0.0);
    let yaw_with = |weight: f32| {
        let information = 1.0 / 5f32.to_radians().powi(2);
        let options = FitOptions {
            rotation: Some(RotationPrior {
                rotation: prior.rotation,
                information: Mat3::from_diagonal(Vec3::splat(information)),
                weight,
            }),
            ..FitOptions::default()
        };
        let observed = Observed {
            points: &points,
            weights: &ALL,
        };
        let fit = fit(face, &CAMERA, &observed, None, &NOBODY, &options).expect("a fit");
        fit.state.pose.angles().yaw_deg
    };
    let alone = fitted(face, &points, None).state.pose.angles().yaw_deg;
    let (weak, strong) = (yaw_with(0.01), yaw_with(1e4));
    assert!((weak - alone).abs() < 0.3, "{alone} {weak}");
    assert!(strong > alone + 3.0 && strong < 80.5, "{alone} {strong}");
}

#[test]
fn expressions_do_not_turn_the_head() {
    let face = &face();
    let mut rng = ChaCha8Rng::seed_from_u64(8);
    let mut animation: Animation = [0.0; FITTED];
    (animation[9], animation[5], animation[2]) = (0.6, 0.9, 0.5);
    for yaw in [0.0, 40.0, -80.0] {
        let truth = FaceState {
            pose: pose(yaw, 5.0, 5.0),
            animation,
            ..FaceState::default()
        };
        let before = FaceState {
            pose: pose(yaw + 6.0, 0.0, 8.0),
            ..FaceState::default()
        };
        let fit = fitted(face, &seen(face, &truth, 0.5, &mut rng), Some(&before));
        assert!(apart(&fit.state.pose, &truth.pose) < 2.5, "{yaw}");
        assert!(
            (fit.state.animation[9] - 0.6).abs() < 0.2,
            "jaw {}",
            fit.state.animation[9]
        );
        assert!(fit.state.animation.iter().all(|w| (0.0..=1.0).contains(w)));
        assert!(
            fit.covariance
                .iter()
                .enumerate()
                .all(|(i, row)| row[i] > 0.0)
        );
    }
}

#[test]
fn identity_is_learned_from_frames() {
    let face = &face();
    let mut rng = ChaCha8Rng::seed_from_u64(9);
    let mut person = NOBODY;
    (person[0], person[1], person[2]) = (1.5, -1.0, 1.0);
    let mut estimator = IdentityEstimator::new();
    let mut identity = NOBODY;
    for k in 0..30 {
        let truth = FaceState {
            pose: pose(3.0 * k as f32 - 45.0, 5.0, 0.0),
            identity: person,
            ..FaceState::default()
        };
        let points = seen(face, &truth, 0.7, &mut rng);
        let observed = Observed {
            points: &points,
            weights: &ALL,
        };
        let options = FitOptions::default();
        let fit = fit(face, &CAMERA, &observed, None, &identity, &options).unwrap();
        estimator.add(face, &CAMERA, &observed, &fit, 0.2);
        identity = estimator.estimate();
    }
    let distance = |a: &Identity, b: &Identity| {
        let (a, b) = (face.neutral(a), face.neutral(b));
        let sum: f32 = (0..LANDMARKS).map(|i| (a.at(i) - b.at(i)).length()).sum();
        sum / LANDMARKS as f32
    };
    let (before, after) = (distance(&NOBODY, &person), distance(&identity, &person));
    assert!(
        after < 0.5 * before,
        "{after} mm from the person, {before} mm at first"
    );
    assert!(size_of::<IdentityEstimator>() <= 16 << 10 && size_of::<FaceState>() <= 1 << 10);
}

#[test]
fn hopeless_input_gives_no_fit() {
    let face = &face();
    let good = seen(
        face,
        &FaceState::default(),
        0.0,
        &mut ChaCha8Rng::seed_from_u64(1),
    );
    let options = FitOptions::default();
    let attempt =
        |points: &[[f32; 2]; LANDMARKS], weights: &[f32; LANDMARKS], camera: &Intrinsics| {
            fit(
                face,
                camera,
                &Observed { points, weights },
                None,
                &NOBODY,
                &options,
            )
        };
    assert!(attempt(&good, &ALL, &CAMERA).is_some());
    assert!(attempt(&good, &[0.0; LANDMARKS], &CAMERA).is_none());
    assert!(attempt(&good, &[f32::NAN; LANDMARKS], &CAMERA).is_none());
    assert!(attempt(&[[f32::NAN; 2]; LANDMARKS], &ALL, &CAMERA).is_none());
    assert!(attempt(&[[5.0; 2]; LANDMARKS], &ALL, &CAMERA).is_none());
    let mut bad = CAMERA;
    bad.fx = f32::NAN;
    assert!(attempt(&good, &ALL, &bad).is_none());
    // Far outside every picture: whatever comes back is finite.
    let wild = good.map(|[x, y]| [x * 1e18, -y * 1e18]);
    if let Some(fit) = attempt(&wild, &ALL, &CAMERA) {
        assert!(fit.rms_px.is_finite() && fit.points_mm.iter().all(|p| p.is_finite()));
    }
}

/// Rewrites the checksum, so that the section's own checks are what is tested.
fn reopened(mut bytes: Vec<u8>) -> Option<FaceFit> {
    reseal(&mut bytes);
    let bytes = AlignedBytes::new(&bytes);
    let face = open(&Blob::open(&bytes).ok()?).ok()?;
    let points = [(); LANDMARKS].map({
        let mut k = 0.0;
        move |()| {
            k += 1.0;
            [k * 7.0 % 60.0 + 200.0, k * 11.0 % 70.0 + 200.0]
        }
    });
    let observed = Observed {
        points: &points,
        weights: &ALL,
    };
    fit(
        &face,
        &CAMERA,
        &observed,
        None,
        &NOBODY,
        &FitOptions::default(),
    )
}

#[test]
fn damaged_sections_are_refused_or_harmless() {
    let start = 128;
    let mut cut = BYTES.clone();
    // The length in the section table.
    cut[72..76].copy_from_slice(&1000u32.to_le_bytes());
    assert!(reopened(cut).is_none());
    for (at, value) in [(0, 67u32), (0, 1000), (4, 33), (4, u32::MAX)] {
        let mut bytes = BYTES.clone();
        bytes[start + at..start + at + 4].copy_from_slice(&value.to_le_bytes());
        assert!(reopened(bytes).is_none(), "{value} at {at}");
    }
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    for _ in 0..300 {
        let mut bytes = BYTES.clone();
        for _ in 0..rng.random_range(1..20) {
            let at = rng.random_range(start..bytes.len());
            bytes[at] ^= 1 << rng.random_range(0..8);
        }
        reopened(bytes);
    }
}
