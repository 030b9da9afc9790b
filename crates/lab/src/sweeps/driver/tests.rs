use super::super::clip::Studio;
use super::super::motion::Moment;
use super::super::tests::ball;
use super::super::{Material, clip::Set};
use super::night::{self, Moving};
use super::plan::{Clip, Condition, clips};
use super::script::{Script, What};
use super::{Args, scene};

fn args(seconds: usize, width: usize) -> Args {
    Args {
        material: Material {
            facekit: "".into(),
            backgrounds: None,
            seed: 1,
        },
        out: "".into(),
        only: Vec::new(),
        seconds,
        fps: 25,
        width,
    }
}

fn script(studio: &Studio, clip: &Clip) -> Script {
    let mut set = Set::cast(studio, &clip.sweep).unwrap();
    Script::new(&mut set.rng, clip)
}

/// Lengths of the closures \[s\].
fn closures_s(frames: &[Moment]) -> Vec<f32> {
    let shut = |frame: &Moment| frame.blink >= 0.8;
    let runs = frames.chunk_by(|a, b| shut(a) == shut(b));
    let runs = runs.filter(|run| shut(&run[0]));
    runs.map(|run| run.len() as f32 / 25.0).collect()
}

#[test]
fn drivers_do_what_they_must() {
    let studio = Studio::new(&ball(), None, Vec::new()).unwrap();
    let plan = clips(&args(60, 480));
    assert!(plan.len() >= 20);
    let mut all = Vec::new();
    let (mut yawns, mut turned) = (0, 0);
    for clip in &plan {
        assert!(clip.road_deg[0].abs() <= 40.0);
        let script = script(&studio, clip);
        let frames = (0..1500).map(|n| script.at(n as f32 / 25.0));
        let frames: Vec<Moment> = frames.collect();
        let closures = closures_s(&frames);
        let blinks = closures.iter().filter(|s| **s < 0.2).count();
        assert!((5..30).contains(&blinks), "{blinks} {:?}", clip.sweep.name);
        all.extend(closures.into_iter().filter(|s| *s >= 0.2));
        yawns += script.acts.iter().filter(|a| a.what == What::Yawn).count();
        let yaw = |frame: &Moment| frame.angles.yaw_deg.abs();
        turned += frames.iter().filter(|f| yaw(f) >= 60.0).count();
        assert!(frames.iter().all(|f| yaw(f) < 85.0), "{:?}", clip.sweep);
    }
    assert!(all.len() > 80, "{} closures", all.len());
    assert!(all.iter().any(|s| *s > 6.0) && all.iter().any(|s| *s < 0.3));
    assert!(yawns >= 25 && turned > 500, "{yawns} {turned}");
}

/// A driver who does not move, in the light of some moments of a clip.
fn frames(studio: &Studio, name: &str) -> [Vec<u8>; 4] {
    let plan = clips(&args(1, 96));
    let clip = plan.iter().find(|clip| clip.sweep.name == name).unwrap();
    let mut set = Set::cast(studio, &clip.sweep).unwrap();
    night::dress(&mut set, clip.condition);
    let script = Script::new(&mut set.rng, clip);
    set.expose(&script.at(0.0));
    set.camera.noise = 0.0;
    let moving = Moving::random(&mut set, clip.condition).unwrap();
    [0.0, 0.4, 0.9, 1.5].map(|t| {
        moving.shine(&mut set, t);
        set.frame(0, script.at(0.0)).0
    })
}

#[test]
fn light_moves_over_a_face_that_does_not() {
    let studio = Studio::new(&ball(), None, Vec::new()).unwrap();
    for name in ["sun-bars-01", "headlights-01"] {
        let frames = frames(&studio, name);
        let of_pixel = |i: &usize| frames.each_ref().map(|luma| luma[*i]);
        let is_changed = |lumas: &[u8; 4]| lumas.iter().any(|v| v.abs_diff(lumas[0]) > 20);
        let pixels = 0..frames[0].len();
        let changed = pixels.filter(|i| is_changed(&of_pixel(i))).count();
        // The ball is small in a picture of this size.
        assert!(changed > 20, "{name}: {changed}");
    }
}

#[test]
fn a_turned_camera_sees_the_head_tilted() {
    let studio = Studio::new(&ball(), None, Vec::new()).unwrap();
    let plan = clips(&args(1, 96));
    let condition = Condition::TurnedCamera;
    for clip in plan.iter().filter(|clip| clip.condition == condition) {
        let mut set = Set::cast(&studio, &clip.sweep).unwrap();
        night::dress(&mut set, condition);
        let tilt = set.turned.x_axis.y.abs();
        assert!((0.25..0.45).contains(&tilt), "{tilt}");
    }
}

#[test]
fn a_driver_is_rendered_with_the_truth() {
    let studio = Studio::new(&ball(), None, Vec::new()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let mut plan = clips(&args(1, 96));
    plan.iter_mut().for_each(|clip| clip.sweep.frames = 2);
    // The ball's eyes lie outside of the dark lenses, which are shaped for a head.
    for name in ["clear-glasses-01", "wheel-01"] {
        let clip = plan.iter().find(|clip| clip.sweep.name == name).unwrap();
        scene::render(&studio, clip, folder.path()).unwrap();
        let text = std::fs::read_to_string(folder.path().join(format!("{name}.csv"))).unwrap();
        let lines: Vec<Vec<&str>> = text.lines().map(|l| l.split(',').collect()).collect();
        assert_eq!(lines.len(), 3);
        assert!(lines.iter().all(|line| line.len() == lines[0].len()));
        let number = |column: &str| -> f32 {
            let at = lines[0].iter().position(|c| *c == column).unwrap();
            lines[1][at].parse().unwrap()
        };
        let eyes = (36..48).filter(|i| number(&format!("o{i}")) > 0.5).count();
        assert!(eyes < 6, "{name}: {eyes}");
        let gaze = ["x", "y", "z"].map(|axis| number(&format!("gaze_0_{axis}")));
        assert!((gaze.iter().map(|v| v * v).sum::<f32>() - 1.0).abs() < 1e-3);
        assert!(gaze[2] < 0.0, "towards the camera");
    }
}
