//! Clips in which two people pass each other and swap sides, one behind the other, with the
//! places of both faces per frame: do trackers keep them apart?

use super::Material;
use super::clip::{Set, Studio, write_clip};
use super::motion::Moment;
use super::plan::{Hair, Kind, SEED, SIZE, Sweep};
use super::truth::{self, Drawing, Landmarks};
use anyhow::Result;
use glam::Vec3;
use posewise::shape::Intrinsics;
use posewise_train::head::Head;
use posewise_train::render::draw::View;
use posewise_train::render::noise::smoothstep;
use rand::Rng;
use std::path::PathBuf;

/// Width of a face that distances are chosen for \[mm\].
const FACE_MM: f32 = 140.0;
/// When they begin to move, and when they stand again \[share of the clip\].
const MOVES: [f32; 2] = [0.22, 0.78];
/// First of the streams of the seed, behind those of the sweeps.
const FIRST_STREAM: u64 = 1000;

/// Settings of `posewise-lab crossings`.
#[derive(Clone, Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    pub material: Material,
    /// Where clips (.y4m.gz), truths (.csv) and descriptions (.json) go. A clip whose description
    /// is there and agrees is not rendered again.
    #[arg(long)]
    pub out: PathBuf,
    /// Number of clips.
    #[arg(long, default_value_t = 8)]
    pub clips: usize,
    /// Frames of each clip, at 25 per second.
    #[arg(long, default_value_t = 110)]
    pub frames: usize,
}

/// Renders all clips.
pub fn run(args: &Args) -> Result<()> {
    let kit = Head::load(&args.material.facekit)?;
    let studio = Studio::new(&kit, None, args.material.pictures()?)?;
    std::fs::create_dir_all(&args.out)?;
    (0..args.clips).try_for_each(|n| render(&studio, args, n))
}

/// The person before, or behind, in one of the clips.
fn person(args: &Args, clip: usize, which: usize) -> Sweep {
    let stream = FIRST_STREAM + 2 * clip as u64 + which as u64;
    Sweep {
        name: format!("crossing-{:02}", clip + 1),
        kind: Kind::Crossing,
        hair: [Hair::Short, Hair::Bald, Hair::Big, Hair::Long][stream as usize % 4],
        view_deg: 60.0,
        seed: (SEED ^ args.material.seed, stream),
        person: None,
        size: SIZE,
        frames: args.frames,
        fps: 25,
    }
}

/// Where a person stands at the start \[mm, camera axes\]; at the end on the other side.
struct Path {
    start: Vec3,
}

impl Path {
    fn at(&self, share: f32) -> Vec3 {
        let way = 1.0 - 2.0 * smoothstep(MOVES[0], MOVES[1], share);
        Vec3::new(self.start.x * way, self.start.y, self.start.z)
    }
}

fn render(studio: &Studio, args: &Args, clip: usize) -> Result<()> {
    let sweeps = [0, 1].map(|which| person(args, clip, which));
    let description = serde_json::to_string_pretty(&sweeps)?;
    let columns = "frame,person,x,y,width,height,uncovered".to_owned();
    write_clip(&sweeps[0], &args.out, &description, columns, || {
        let mut near = Set::new(studio, &sweeps[0])?;
        let mut far = Set::new(studio, &sweeps[1])?;
        let [width, height] = SIZE;
        let focal = width as f32 / 2.0 / (sweeps[0].view_deg / 2.0).to_radians().tan();
        let middle = SIZE.map(|n| (n - 1) as f32 / 2.0);
        let view = || View {
            width,
            height,
            camera: Intrinsics::new(focal, focal, middle[0], middle[1]),
        };
        (near.view, far.view) = (view(), view());
        far.lights = near.lights.clone();
        let behind = far.behind.clone();
        // The camera must not make faces disappear: noise and blur of an ordinary one.
        near.camera.noise = near.camera.noise.min(3.0);
        let paths = paths(&mut near, focal);
        Ok(move |number: usize| {
            let share = number as f32 / args.frames as f32;
            (near.at, far.at) = (paths[0].at(share), paths[1].at(share));
            let moment = |set: &Set| -> Moment { set.motion.at(number as f32 / 25.0) };
            let (moment_near, moment_far) = (moment(&near), moment(&far));
            let (front, back) = (near.figure(&moment_near), far.figure(&moment_far));
            far.behind = behind.clone();
            near.behind = far.drawn(&back, &moment_far).light;
            let mut light = near.drawn(&front, &moment_near).light;
            let luma = near.camera.develop(&mut near.rng, &mut light, width);
            let cover = Drawing {
                mesh: near.mesh(),
                head: Some(&front.posed),
                props: &front.own,
            };
            let (face, hidden) = (near.landmarks(&front), far.landmarks(&back));
            let uncovered = truth::uncovered_share(&hidden, &far.view, &cover);
            let rows = [
                row(number, 0, &face, 1.0),
                row(number, 1, &hidden, uncovered),
            ];
            Ok((luma, rows.join("\n")))
        })
    })
}

/// Ways of the person before and the one behind.
fn paths(near: &mut Set<'_>, focal: f32) -> [Path; 2] {
    let rng = &mut near.rng;
    let side = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
    let face_px = rng.random_range(105.0..135.0f32);
    let farther = rng.random_range(1.15..1.4f32);
    let mut path = |side: f32, z: f32| {
        let x_px = rng.random_range(135.0..175.0f32);
        let y_px = rng.random_range(-40.0..0.0f32);
        Path {
            start: Vec3::new(side * x_px, y_px, focal) * z / focal,
        }
    };
    let z = focal * FACE_MM / face_px;
    [path(side, z), path(-side, farther * z)]
}

/// One line of the truth: a face's box.
fn row(frame: usize, person: usize, landmarks: &Landmarks, uncovered: f32) -> String {
    let mut low = landmarks.points[0];
    let mut high = low;
    for p in &landmarks.points {
        (low, high) = (low.min(*p), high.max(*p));
    }
    let size = high - low;
    format!(
        "{frame},{person},{:.2},{:.2},{:.2},{:.2},{uncovered:.3}",
        low.x, low.y, size.x, size.y
    )
}
