use super::clip::Studio;
use super::covers::Cover;
use super::motion::Motion;
use super::plan::{Kind, Sweep, sweeps};
use super::{Material, u3pt};
use crate::rigid::rotation_onto;
use glam::{Mat3, Vec3};
use posewise::shape::LANDMARKS;
use posewise_train::head::Head;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

#[test]
fn the_plan_covers_what_it_must() {
    let all = sweeps(1, true);
    let count = |is: &dyn Fn(&Kind) -> bool| all.iter().filter(|s| is(&s.kind)).count();
    assert!(count(&|k| *k == Kind::Yaw) >= 16);
    assert!(count(&|k| matches!(k, Kind::Covered(_))) >= 8);
    assert!(count(&|k| *k == Kind::Candide) >= 2);
    let mut names: Vec<&str> = all.iter().map(|s| s.name.as_str()).collect();
    names.sort();
    names.dedup();
    assert_eq!(names.len(), all.len(), "names differ");
}

#[test]
fn heads_turn_to_profile_and_not_too_fast() {
    let plan = sweeps(1, true);
    for sweep in &plan {
        let mut rng = ChaCha8Rng::seed_from_u64(sweep.seed.0);
        rng.set_stream(sweep.seed.1);
        let motion = Motion::new(&mut rng, sweep);
        let at = |n: usize| motion.at(n as f32 / sweep.fps as f32).angles;
        let mut most = 0.0f32;
        for n in 1..sweep.frames {
            let speed = (at(n).yaw_deg - at(n - 1).yaw_deg).abs() * sweep.fps as f32;
            assert!(speed < 95.0, "{}: {speed}", sweep.name);
            most = most.max(at(n).yaw_deg.abs());
        }
        let reach = match sweep.kind {
            Kind::Yaw | Kind::Candide => 93.0..95.1,
            _ => 0.0..48.0,
        };
        assert!(reach.contains(&most), "{}: {most}", sweep.name);
    }
}

#[test]
fn a_cover_comes_and_goes() {
    let plan = sweeps(1, false);
    let hand = plan
        .iter()
        .find(|s| s.kind == Kind::Covered(Cover::HandOnEyes));
    let hand = hand.unwrap();
    let motion = Motion::new(&mut ChaCha8Rng::seed_from_u64(3), hand);
    let cover = |t: f32| motion.at(t).cover;
    assert_eq!((cover(0.5), cover(2.0), cover(4.3)), (0.0, 1.0, 0.0));
}

#[test]
fn a_rotation_is_found() {
    let from = [
        (1.0, 2.0, 3.0),
        (4.0, -1.0, 0.5),
        (-2.0, 0.0, 1.0),
        (0.0, 5.0, -3.0),
    ];
    let from = from.map(|(x, y, z)| Vec3::new(x, y, z));
    let turn = Mat3::from_rotation_y(0.3) * Mat3::from_rotation_x(-0.2);
    let to = from.map(|p| turn * p + Vec3::new(7.0, 8.0, 9.0));
    let found = rotation_onto(&from, &to);
    assert!(
        (found - turn)
            .to_cols_array()
            .iter()
            .all(|d| d.abs() < 1e-5)
    );
}

/// A ball with 68 points on its front, which stands for a head.
pub fn ball() -> Head {
    const ROUND: u32 = 32;
    const UP: u32 = 24;
    let vertex = |n: u32| {
        let (s, c) = (std::f32::consts::PI * (n / ROUND) as f32 / (UP - 1) as f32).sin_cos();
        let (x, z) = (std::f32::consts::TAU * (n % ROUND) as f32 / ROUND as f32).sin_cos();
        [90.0 * s * x, 20.0 - 100.0 * c, 60.0 - 90.0 * s * z]
    };
    let mean: Vec<[f32; 3]> = (0..ROUND * UP).map(vertex).collect();
    let mut triangles = Vec::new();
    for (k, i) in (0..UP - 1).flat_map(|k| (0..ROUND).map(move |i| (k, i))) {
        let (a, b) = (k * ROUND + i, k * ROUND + (i + 1) % ROUND);
        // The outside is counter-clockwise.
        triangles.extend([[a, a + ROUND, b], [b, a + ROUND, b + ROUND]]);
    }
    let on_front = |i: usize| {
        let at = Vec3::new(
            (i % 10) as f32 * 9.0 - 40.0,
            (i / 10) as f32 * 12.0 - 20.0,
            -30.0,
        );
        let far = |v: &usize| Vec3::from(mean[*v]).distance_squared(at);
        let nearest = (0..mean.len()).min_by(|a, b| far(a).total_cmp(&far(b)));
        nearest.unwrap() as u32
    };
    Head {
        uv: mean
            .iter()
            .map(|p| [0.5 + 0.004 * p[0], 0.5 - 0.004 * p[1]])
            .collect(),
        triangle_uv: triangles.clone(),
        identity: Vec::new(),
        expressions: Vec::new(),
        landmarks: std::array::from_fn(on_front),
        jaw: std::array::from_fn(|_| Vec::new()),
        jaw_edge: [None; 17],
        vertex_part: vec![0; mean.len()],
        triangle_part: vec![0; triangles.len()],
        part_names: vec!["face".into()],
        animation: std::array::from_fn(|_| None),
        triangles,
        mean,
    }
}

fn u3pt(subjects: usize, frames: usize, width: usize) -> Vec<Sweep> {
    u3pt::plan(&u3pt::Args {
        material: Material {
            facekit: "".into(),
            backgrounds: None,
            seed: 1,
        },
        out: "".into(),
        only: Vec::new(),
        subjects,
        frames,
        width,
    })
}

#[test]
fn subjects_turn_as_far_as_they_must() {
    let plan = u3pt(10, 150, 640);
    assert_eq!(plan.len(), 50);
    for (folder, axis, reach) in [("yaw", 0, 90.0), ("pitch", 1, 40.0), ("roll", 2, 45.0)] {
        for video in plan.iter().filter(|v| v.name.starts_with(folder)) {
            let mut rng = ChaCha8Rng::seed_from_u64(video.seed.0);
            rng.set_stream(video.seed.1);
            let motion = Motion::new(&mut rng, video);
            let angle = |n: usize| {
                let angles = motion.at(n as f32 / video.fps as f32).angles;
                [angles.yaw_deg, angles.pitch_deg, angles.roll_deg][axis]
            };
            let (low, high) = (0..video.frames)
                .map(angle)
                .fold((f32::MAX, f32::MIN), |(low, high), angle| {
                    (low.min(angle), high.max(angle))
                });
            assert!((low + reach).abs() < 1.5, "{}: {low}", video.name);
            assert!((high - reach).abs() < 1.5, "{}: {high}", video.name);
        }
    }
}

#[test]
fn a_small_set_is_rendered_with_its_truth() {
    let studio = Studio::new(&ball(), None, Vec::new()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let plan = u3pt(1, 2, 96);
    let table = |video: &Sweep| {
        studio.render(video, folder.path()).unwrap();
        let path = folder.path().join(format!("{}.csv", video.name));
        let clip = folder.path().join(format!("{}.y4m.gz", video.name));
        let first = crate::video::frames(&clip).unwrap().next().unwrap();
        assert_eq!(first.unwrap().dimensions(), (96, 72));
        crate::truth::read(&path).unwrap()
    };
    let tables: Vec<_> = plan.iter().map(table).collect();
    for truth in &tables {
        assert_eq!(truth.len(), 2);
        assert_eq!(truth[0].focal, tables[0][0].focal, "the subject's camera");
    }
}

#[test]
fn two_frames_have_their_truth() {
    let studio = Studio::new(&ball(), None, Vec::new()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let mut plan = sweeps(1, false);
    plan.iter_mut().for_each(|s| s.frames = 2);
    let read = |name: &str| std::fs::read(folder.path().join(name)).unwrap();
    let glasses = plan
        .iter()
        .find(|s| s.kind == Kind::Covered(Cover::Sunglasses));
    for sweep in [&plan[0], glasses.unwrap()] {
        studio.render(sweep, folder.path()).unwrap();
        let name = |extension: &str| format!("{}.{extension}", sweep.name);
        let mut frames = Vec::new();
        let clip = read(&name("y4m.gz"));
        std::io::Read::read_to_end(&mut flate2::read::GzDecoder::new(&*clip), &mut frames).unwrap();
        assert!(frames.len() > 2 * 640 * 480 && frames.len() < 2 * 640 * 480 + 100);
        let text = String::from_utf8(read(&name("csv"))).unwrap();
        let lines: Vec<Vec<&str>> = text.lines().map(|l| l.split(',').collect()).collect();
        assert_eq!(lines.len(), 3);
        assert!(lines.iter().all(|l| l.len() == lines[0].len()));
        let number = |column: &str| -> f32 {
            let at = lines[0].iter().position(|c| *c == column).unwrap();
            lines[1][at].parse().unwrap()
        };
        assert_eq!(number("in_frame"), 1.0);
        assert_eq!(
            number("occluder"),
            f32::from(u8::from(sweep.name.starts_with("sun")))
        );
        let seen = (0..LANDMARKS)
            .filter(|i| number(&format!("v{i}")) > 0.5)
            .count();
        assert!(seen > LANDMARKS / 2, "{}: {seen}", sweep.name);
        // Once more: nothing is done where the description agrees, and else the same.
        std::fs::write(folder.path().join(name("csv")), "kept").unwrap();
        studio.render(sweep, folder.path()).unwrap();
        assert_eq!(read(&name("csv")), b"kept");
        std::fs::remove_file(folder.path().join(name("json"))).unwrap();
        studio.render(sweep, folder.path()).unwrap();
        assert_eq!(
            (read(&name("csv")), read(&name("y4m.gz"))),
            (text.into_bytes(), clip)
        );
    }
}
