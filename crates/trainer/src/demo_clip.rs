//! The clip that the repository ships for `posewise demo`: a procedural head (no photograph of
//! anybody) in front of a procedural room, with exact truth per frame.
//!
//! The clip is grey y4m (`Cmono`) behind gzip; the truth has the columns of the development clips:
//! angles, rotation, position of the eyes' midpoint, intrinsics, weights, the projections of the
//! 68 fixed vertices and whether each is seen.

use crate::head::Head;
use crate::render::contour::{Landmarker, Points};
use crate::render::draw::{Eyes, Posed, Prop, Scene, View, draw};
use crate::render::effects::Camera;
use crate::render::expression::{Expression, gaze_directions};
use crate::render::light::Lights;
use crate::render::mesh::Mesh;
use crate::render::noise::smoothstep;
use crate::render::people::People;
use crate::render::person::Person;
use crate::render::skin::{Lids, Looks};
use crate::render::{background, props};
use anyhow::Result;
use flate2::{Compression, write::GzEncoder};
use glam::{Mat3, Vec3};
use posewise::math::{HeadAngles, head_rotation};
use posewise::shape::{Intrinsics, LANDMARKS};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::fmt::Write as _;
use std::fs::File;
use std::io::Write;
use std::path::Path;

const WIDTH: usize = 320;
const HEIGHT: usize = 240;
const FPS: usize = 20;
const FRAMES: usize = 120;
const SEED: u64 = 26;

/// Where the head is and what it does at a moment.
struct Moment {
    angles: HeadAngles,
    at: Vec3,
    blink: f32,
    jaw: f32,
    smile: f32,
    brows: f32,
    pucker: f32,
    gaze: (f32, f32),
}

/// 0 outside `from..to`, a smooth bump of height 1 between.
fn bump(t: f32, from: f32, to: f32) -> f32 {
    let x = ((t - from) / (to - from)).clamp(0.0, 1.0);
    (std::f32::consts::PI * x).sin().powi(2)
}

/// One full swing to the right and the left within `from..to`.
fn swing(t: f32, from: f32, to: f32) -> f32 {
    let x = ((t - from) / (to - from)).clamp(0.0, 1.0);
    (std::f32::consts::TAU * x).sin()
}

/// The script, `t` in seconds of six.
fn moment(t: f32) -> Moment {
    let talk = smoothstep(0.2, 0.5, t) * (1.0 - smoothstep(3.9, 4.2, t));
    let yaw = 60.0 * swing(t, 0.7, 3.7) + 2.0 * (1.3 * t).sin();
    let near = bump(t, 4.3, 6.0);
    let blinks = [0.45, 1.9, 3.75, 5.1].map(|at| bump(t, at - 0.12, at + 0.16));
    Moment {
        angles: HeadAngles {
            yaw_deg: yaw,
            pitch_deg: 20.0 * swing(t, 3.6, 5.0) + 3.0 * (0.9 * t).sin(),
            roll_deg: 20.0 * swing(t, 4.4, 5.9) + 4.0 * (0.8 * t + 0.5).sin(),
        },
        at: Vec3::new(
            12.0 * (0.7 * t).sin(),
            -4.0 + 4.0 * (1.1 * t).cos(),
            520.0 - 150.0 * near,
        ),
        blink: blinks.into_iter().fold(0.04, f32::max),
        jaw: talk * (0.16 + 0.14 * (11.0 * t).sin() + 0.08 * (6.3 * t).sin()).max(0.0)
            + 0.55 * bump(t, 4.2, 5.0),
        smile: 0.8 * bump(t, 4.9, 6.3) + 0.1,
        brows: 0.7 * bump(t, 2.0, 2.6) + 0.6 * bump(t, 4.2, 4.9),
        pucker: talk * 0.25 * (0.5 + 0.5 * (4.1 * t).sin()),
        gaze: (-0.004 * yaw, 0.0),
    }
}

impl Moment {
    /// The face's expression.
    fn expression(&self) -> Expression {
        let mut face = Expression::default();
        face.gaze = self.gaze;
        for (name, weight) in [
            ("eyeBlinkLeft", self.blink),
            ("eyeBlinkRight", self.blink),
            ("jawOpen", self.jaw),
            ("mouthSmileLeft", self.smile),
            ("mouthSmileRight", self.smile),
            ("mouthPucker", self.pucker),
            ("browInnerUp", self.brows),
            ("browOuterUpLeft", self.brows),
            ("browOuterUpRight", self.brows),
        ] {
            face.add(name, weight);
        }
        face.follow_gaze(1.0 - self.blink);
        face
    }
}

/// Everything that stays the same from frame to frame.
struct Set {
    mesh: Mesh,
    landmarker: Landmarker,
    person: Person,
    identity: Vec<f32>,
    lights: Lights,
    view: View,
    behind: Vec<f32>,
}

impl Set {
    fn new(head: &Head) -> Result<Set> {
        let mesh = Mesh::new(head)?;
        let looks = Looks {
            seed: 5,
            skin: 0.33,
            hair: 0.035,
            brow: (0.22, 3.2),
            lips: 0.62,
            beard: 0.0,
            blotches: 0.7,
            hair_mm: 15.0,
            hairline_mm: 62.0,
            lashes: 0.75,
            iris: 0.07,
            cloth: 0.12,
            lids: Lids::default(),
        };
        let person = People::new(&mesh, 1, SEED, false).make(&mesh, u32::MAX, &looks);
        let mut rng = ChaCha8Rng::seed_from_u64(SEED);
        let mut behind = background::procedural(&mut rng, WIDTH, HEIGHT);
        behind.iter_mut().for_each(|b| *b = 0.05 + 0.5 * *b);
        Ok(Set {
            landmarker: Landmarker::new(&mesh, &[]),
            mesh,
            person,
            identity: vec![-0.4, 0.5, 0.3, -0.6, 0.4, 0.2, -0.3, 0.5],
            lights: Lights {
                ambient: 0.45,
                gradient: Vec3::new(0.1, -0.35, -0.15),
                key: Vec3::new(-0.45, -0.5, -0.75).normalize(),
                key_power: 0.6,
                fill: Vec3::new(0.8, -0.1, -0.6).normalize(),
                fill_power: 0.18,
                sheen: 0.04,
                sheen_exponent: 12.0,
                infrared: 0.0,
                sky: None,
            },
            view: View {
                width: WIDTH,
                height: HEIGHT,
                camera: Intrinsics::of_frame(WIDTH as i32, HEIGHT as i32),
            },
            behind,
        })
    }

    fn frame(&self, number: usize) -> Frame {
        let moment = moment(number as f32 / FPS as f32);
        let face = moment.expression();
        let head = self
            .mesh
            .vertices(&self.identity, &face.weights(&self.mesh));
        let rotation = head_rotation(moment.angles);
        let push = &self.person.painted.push_mm;
        let posed = Posed::new(&self.mesh, &head, push, rotation, moment.at);
        let torso: [Prop; 1] = [props::torso(
            moment.angles,
            rotation,
            moment.at,
            self.person.cloth,
            9,
        )];
        let scene = Scene {
            mesh: &self.mesh,
            head: &posed,
            painted: &self.person.painted,
            eyes: Eyes {
                gaze: gaze_directions(&face, 0.05),
                white: 0.45,
                iris: self.person.iris,
                pupil: 0.38,
                mottled: 0.0,
            },
            props: &torso,
            lights: &self.lights,
        };
        let drawn = draw(&scene, &self.view, &self.behind);
        let roll_deg = moment.angles.roll_deg;
        let points = self.landmarker.points(&posed, &self.view, &drawn, roll_deg);
        let camera = Camera {
            blur_px: 0.6,
            motion_px: (0.0, 0.0),
            exposure: 1.55,
            gamma: 1.0 / 2.2,
            haze: 0.02,
            // Noise would double the file.
            noise: 0.0,
            jpeg: None,
        };
        let mut rng = ChaCha8Rng::seed_from_u64(SEED + 1);
        rng.set_stream(number as u64);
        let mut light = drawn.light;
        Frame {
            luma: camera.develop(&mut rng, &mut light, WIDTH),
            moment,
            rotation,
            points,
        }
    }

    fn truth(&self, number: usize, frame: &Frame) -> Result<String> {
        let m = &frame.moment;
        let mut row = format!("{number},{:.5}", number as f32 / FPS as f32);
        let a = m.angles;
        write!(
            row,
            ",{:.4},{:.4},{:.4}",
            a.yaw_deg, a.pitch_deg, a.roll_deg
        )?;
        // The head's origin is midway between the eyeballs.
        write!(row, ",{:.3},{:.3},{:.3}", m.at.x, m.at.y, m.at.z)?;
        for r in frame.rotation.transpose().to_cols_array() {
            write!(row, ",{r:.7}")?;
        }
        let c = self.view.camera;
        write!(row, ",{:.3},{:.3},{:.1},{:.1}", c.fx, c.fy, c.cx, c.cy)?;
        write!(
            row,
            ",{:.4},{:.4},{:.4},{:.4}",
            m.blink, m.blink, m.jaw, m.smile
        )?;
        let [ear_r, ear_l, mar] = ratios(&frame.points.solid);
        write!(
            row,
            ",{ear_r:.4},{ear_l:.4},{mar:.4},{}",
            u8::from(m.blink > 0.8)
        )?;
        for p in frame.points.fixed {
            write!(row, ",{:.3},{:.3}", p.x, p.y)?;
        }
        for seen in frame.points.fixed_seen {
            write!(row, ",{}", u8::from(seen))?;
        }
        Ok(row)
    }
}

struct Frame {
    luma: Vec<u8>,
    moment: Moment,
    rotation: Mat3,
    points: Points,
}

/// Eye aspect ratios of the right and the left eye, and the mouth's inner gap over its width.
fn ratios(p: &[Vec3; LANDMARKS]) -> [f32; 3] {
    let gap = |a: usize, b: usize| (p[a] - p[b]).length();
    [
        (gap(37, 41) + gap(38, 40)) / (2.0 * gap(36, 39)),
        (gap(43, 47) + gap(44, 46)) / (2.0 * gap(42, 45)),
        gap(62, 66) / gap(48, 54),
    ]
}

fn columns() -> String {
    let mut names = String::from("frame,time,yaw,pitch,roll,eye_mid_x,eye_mid_y,eye_mid_z");
    names += ",r00,r01,r02,r10,r11,r12,r20,r21,r22,fx,fy,cx,cy";
    names += ",eyeBlink_L,eyeBlink_R,jawOpen,mouthSmile,ear_R,ear_L,mar,eyes_closed";
    (0..LANDMARKS).for_each(|i| names += &format!(",x{i},y{i}"));
    (0..LANDMARKS).for_each(|i| names += &format!(",v{i}"));
    names
}

/// Renders the clip to `folder/demo.y4m.gz` and its truth to `folder/demo.csv`.
pub fn write(facekit: &Path, folder: &Path) -> Result<()> {
    let set = Set::new(&Head::load(facekit)?)?;
    std::fs::create_dir_all(folder)?;
    let mut clip = GzEncoder::new(
        File::create(folder.join("demo.y4m.gz"))?,
        Compression::best(),
    );
    writeln!(clip, "YUV4MPEG2 W{WIDTH} H{HEIGHT} F{FPS}:1 Ip A1:1 Cmono")?;
    let mut truth = columns();
    for number in 0..FRAMES {
        let frame = set.frame(number);
        clip.write_all(b"FRAME\n")?;
        clip.write_all(&frame.luma)?;
        truth += "\n";
        truth += &set.truth(number, &frame)?;
    }
    clip.finish()?;
    std::fs::write(folder.join("demo.csv"), truth + "\n")?;
    Ok(())
}
