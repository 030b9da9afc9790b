//! Pose through lenses with a horizontal field of view of 120°: the rendered demo clip as such a
//! camera shows it, in the middle of the picture and towards its edge. The error is that of a
//! pinhole camera which looks there too.

#[path = "../common/lenses.rs"]
mod lenses;

use crate::common::{demo, grey, model, tracker};
use glam::{Mat3, Quat, Vec3};
use lenses::{FISHEYE, WIDE};
use posewise::shape::Project;
use posewise::{Config, Distortion, Intrinsics, Model, State};

/// The clip's camera: 60° across 320×240.
const CLIP: Intrinsics = Intrinsics::new(277.128, 277.128, 159.5, 119.5);
/// Focal length of all cameras: at the axis the face is as large as in the clip \[px\].
const FOCAL: f32 = 277.128;
/// Step between the frames of the clip that are tracked.
const EVERY: usize = 3;

/// Angle between axis and edge of the picture \[rad\].
const HALF_FIELD: f32 = 60.0 * std::f32::consts::PI / 180.0;

/// The picture's size and the camera of a lens: as wide as the field of view, in proportion 4:3.
fn camera(distortion: Distortion) -> (usize, usize, Intrinsics) {
    let at_origin = Intrinsics::new(FOCAL, FOCAL, 0.0, 0.0).with_distortion(distortion);
    let edge = Vec3::new(HALF_FIELD.tan(), 0.0, 1.0) * 1000.0;
    let width = (2.0 * at_origin.image_of(edge.to_array())[0]) as usize / 4 * 4;
    let height = width * 3 / 4;
    let (cx, cy) = ((width - 1) as f32 / 2.0, (height - 1) as f32 / 2.0);
    let camera = Intrinsics::new(FOCAL, FOCAL, cx, cy).with_distortion(distortion);
    (width, height, camera)
}

/// For each pixel of a camera, where the clip shows what it sees; the clip's camera is turned by
/// `to_clip`.
fn lookup((width, height, camera): (usize, usize, Intrinsics), to_clip: Mat3) -> Vec<[f32; 2]> {
    let pixels = (0..width * height).map(|i| [(i % width) as f32, (i / width) as f32]);
    let seen = pixels.map(|pixel| {
        let [[x, y]] = camera.undistorted(&[pixel]);
        let ray = Vec3::new(
            (x - camera.cx) / camera.fx,
            (y - camera.cy) / camera.fy,
            1.0,
        );
        let ray = to_clip * ray.normalize();
        // Behind the clip's camera there is nothing: its edge is repeated far out.
        CLIP.project(ray * 1000.0)
    });
    seen.collect()
}

/// A frame of the clip by a lookup, bilinear; its edges are repeated.
fn warped(luma: &[u8], lookup: &[[f32; 2]]) -> Vec<u8> {
    let at = |x: usize, y: usize| f32::from(luma[y * 320 + x]);
    let pixels = lookup.iter().map(|[x, y]| {
        let (x, y) = (x.clamp(0.0, 318.999), y.clamp(0.0, 238.999));
        let (i, j, u, v) = (x as usize, y as usize, x.fract(), y.fract());
        let row = |j: usize| at(i, j) * (1.0 - u) + at(i + 1, j) * u;
        (row(j) * (1.0 - v) + row(j + 1) * v).round() as u8
    });
    pixels.collect()
}

/// The true rotation in each frame of the clip.
fn truth() -> Vec<Mat3> {
    let path = crate::common::root().join("tests/data/demo.csv");
    let table = std::fs::read_to_string(path).expect("tests/data/demo.csv");
    let mut lines = table.lines();
    let header: Vec<&str> = lines.next().expect("a header").split(',').collect();
    let first = header.iter().position(|name| *name == "r00").expect("r00");
    let rows = lines.map(|line| {
        let numbers = line.split(',').skip(first).take(9);
        let r: Vec<f32> = numbers.map(|n| n.parse().expect("a number")).collect();
        Mat3::from_cols_array(&r.try_into().expect("nine")).transpose()
    });
    rows.collect()
}

/// Mean angle between true and tracked rotation over the frames that are tracked \[deg\], and how
/// many are.
fn error(model: &Model<'_>, distortion: Distortion, view_deg: [f32; 2]) -> (f32, usize) {
    let clip = demo();
    let camera = camera(distortion);
    // The camera turns away from the face: by yaw, then by pitch.
    let [yaw, pitch] = view_deg.map(f32::to_radians);
    let to_clip = Mat3::from_rotation_y(yaw) * Mat3::from_rotation_x(pitch);
    let lookup = lookup(camera, to_clip);
    let config = Config::default()
        .with_intrinsics(camera.2)
        .with_scan_budget(10_000_000);
    let mut tracker = tracker(&config);
    let (mut sum, mut tracked) = (0.0, 0);
    for (i, truth) in truth().iter().enumerate().step_by(EVERY) {
        let luma = warped(&clip.luma[i], &lookup);
        let frame = grey(camera.0, camera.1, &luma);
        let now_us = (i as i64 + 1) * 50_000;
        let result = tracker.step(model, &frame, now_us).expect("time goes on");
        if result.state == State::Tracking {
            let found = Mat3::from_quat(Quat::from_array(result.rotation));
            let expected = to_clip.transpose() * *truth;
            let trace = (expected.transpose() * found).to_cols_array();
            let cosine = (trace[0] + trace[4] + trace[8] - 1.0) / 2.0;
            sum += cosine.clamp(-1.0, 1.0).acos().to_degrees();
            tracked += 1;
        }
    }
    (sum / tracked as f32, tracked)
}

#[test]
fn the_pose_is_that_of_a_pinhole_camera() {
    let model = model();
    for view_deg in [[0.0, 0.0], [25.0, 0.0], [-35.0, 10.0]] {
        let (pinhole, all) = error(&model, Distortion::None, view_deg);
        for distortion in [WIDE, FISHEYE] {
            let (lens, tracked) = error(&model, distortion, view_deg);
            println!(
                "{view_deg:?} {distortion:?}: {lens:.2}° of {tracked}, {pinhole:.2}° of {all}"
            );
            assert!(tracked + 2 >= all, "{tracked} tracked");
            assert!(lens <= pinhole + 0.3, "{lens}° and {pinhole}°");
        }
    }
}

/// Without the lens the test above would fail: the angles are several degrees off.
#[test]
fn a_lens_that_is_left_out_matters() {
    let clip = demo();
    let model = model();
    let (width, height, camera) = camera(FISHEYE);
    let to_clip = Mat3::from_rotation_y(35f32.to_radians());
    let luma = warped(&clip.luma[0], &lookup((width, height, camera), to_clip));
    let frame = grey(width, height, &luma);
    let yaw = |camera: Intrinsics| {
        let config = Config::default()
            .with_intrinsics(camera)
            .with_scan_budget(10_000_000);
        let mut tracker = tracker(&config);
        let result = *tracker.step(&model, &frame, 1).expect("the first");
        assert_eq!(result.state, State::Tracking);
        (result.yaw_deg, result.landmarks)
    };
    let (with, landmarks) = yaw(camera);
    let (without, same) = yaw(camera.with_distortion(Distortion::None));
    println!("yaw {with:.1}°, {without:.1}° without the lens");
    assert!((with - without).abs() > 3.0);
    // Landmarks are those of the picture, whatever the lens.
    assert_eq!(landmarks.map(|l| [l.x, l.y]), same.map(|l| [l.x, l.y]));
}
