//! The truth of a frame, with the columns that `posewise-lab eval pose` and `eval eyes` read.

use super::motion::Moment;
use anyhow::Result;
use glam::{Mat3, Vec2, Vec3};
use posewise::shape::{Intrinsics, JAW, LANDMARKS};
use posewise_train::render::contour::is_drawn;
use posewise_train::render::draw::{HIDES, Posed, Prop, SUPER, View};
use posewise_train::render::glare::{self, GLARE};
use posewise_train::render::mesh::Mesh;
use posewise_train::render::raster::{Cull, Projected, Target};
use std::fmt::Write as _;

/// A frame's truth.
pub struct Row {
    pub frame: usize,
    pub time: f32,
    pub moment: Moment,
    pub rotation: Mat3,
    /// The middle between the eyes \[mm, camera axes\].
    pub at: Vec3,
    pub camera: Intrinsics,
    pub landmarks: Landmarks,
}

/// What can hide landmarks.
pub struct Drawing<'a> {
    pub mesh: &'a Mesh,
    pub head: Option<&'a Posed>,
    pub props: &'a [Prop],
}

impl Drawing<'_> {
    fn depths(&self, view: &View) -> Target {
        let mut target = Target::new(view.width * SUPER, view.height * SUPER);
        let to_samples = |vertices: &[Vec3]| -> Vec<Projected> {
            vertices.iter().map(|v| view.to_samples(*v)).collect()
        };
        if let Some(head) = self.head {
            let points = to_samples(&head.vertices);
            target.draw(&points, &self.mesh.triangles, 0, Cull::Back);
        }
        for prop in self.props {
            target.draw(&to_samples(&prop.vertices), &prop.triangles, 0, Cull::None);
        }
        target
    }
}

/// The 68 fixed points of a frame.
pub struct Landmarks {
    /// Projections \[px\].
    pub points: [Vec2; LANDMARKS],
    solid: [Vec3; LANDMARKS],
    /// Not hidden by the head.
    seen: [bool; LANDMARKS],
    /// Covered by anything else.
    covered: [bool; LANDMARKS],
    /// Whether the cover of the script covers any of them.
    occluder: bool,
    in_frame: f32,
}

impl Landmarks {
    /// Of a `bare` head (without the volume of its hair); `own` is what is drawn of the body,
    /// `over` what is worn or held, `covers` what of it is the cover of the clip's script. What
    /// lets light pass covers eyes where it mirrors more than [`GLARE`].
    pub fn new(
        view: &View,
        mesh: &Mesh,
        bare: &Posed,
        own: &Drawing,
        over: &[Prop],
        covers: &[Prop],
    ) -> Landmarks {
        let solid = mesh.landmarks.map(|v| bare.vertices[v as usize]);
        let points = solid.map(|p| view.project(p));
        let hidden_by = |drawing: &Drawing| {
            let target = drawing.depths(view);
            solid.map(|p| !is_drawn(p, view, &target))
        };
        let hides = |props: &[Prop]| match props {
            [] => [false; LANDMARKS],
            _ => hidden_by(&Drawing {
                mesh,
                head: None,
                props,
            }),
        };
        let (opaque, clear): (Vec<_>, Vec<_>) =
            over.iter().cloned().partition(|prop| prop.opacity > HIDES);
        let glare = glare::before(&solid, &clear, view);
        let is_blinded = |i: usize| (36..48).contains(&i) && glare[i] > GLARE;
        let by_props = hides(&opaque);
        let by_head = hidden_by(own);
        let faces = |i: usize| {
            let along = bare.normals[mesh.landmarks[i] as usize].dot(solid[i].normalize());
            // The outline's own normal is square to the view; lids and lips fold where they close.
            along
                < match i {
                    0..JAW => 0.25,
                    36..48 | 60..LANDMARKS => 0.6,
                    _ => 0.1,
                }
        };
        let inside = |p: &&Vec2| {
            let last = Vec2::new(view.width as f32 - 0.5, view.height as f32 - 0.5);
            p.cmpge(Vec2::splat(-0.5)).all() && p.cmplt(last).all()
        };
        Landmarks {
            in_frame: points.iter().filter(inside).count() as f32 / LANDMARKS as f32,
            points,
            solid,
            seen: std::array::from_fn(|i| faces(i) && !by_head[i]),
            covered: std::array::from_fn(|i| by_props[i] || is_blinded(i)),
            occluder: hides(covers).contains(&true),
        }
    }

    /// Aspect ratios of the right and the left eye, and the mouth's inner gap over its width.
    fn ratios(&self) -> [f32; 3] {
        let gap = |a: usize, b: usize| (self.solid[a] - self.solid[b]).length();
        [
            (gap(37, 41) + gap(38, 40)) / (2.0 * gap(36, 39)),
            (gap(43, 47) + gap(44, 46)) / (2.0 * gap(42, 45)),
            gap(62, 66) / gap(48, 54),
        ]
    }
}

/// Share of the landmarks of one head that nothing of another one hides.
pub fn uncovered_share(landmarks: &Landmarks, view: &View, other: &Drawing) -> f32 {
    let target = other.depths(view);
    let seen = landmarks
        .solid
        .iter()
        .filter(|p| is_drawn(**p, view, &target));
    seen.count() as f32 / LANDMARKS as f32
}

/// The table's first line.
pub fn columns() -> String {
    let mut names = String::from("frame,time,yaw,pitch,roll,eye_mid_x,eye_mid_y,eye_mid_z");
    names += ",r00,r01,r02,r10,r11,r12,r20,r21,r22,fx,fy,cx,cy";
    names += ",eyeBlink_L,eyeBlink_R,jawOpen,mouthSmile,ear_R,ear_L,mar,eyes_closed";
    names += ",occluder,in_frame";
    (0..LANDMARKS).for_each(|i| names += &format!(",x{i},y{i}"));
    for mark in ["v", "o"] {
        (0..LANDMARKS).for_each(|i| names += &format!(",{mark}{i}"));
    }
    names
}

impl Row {
    /// One line of the table.
    pub fn text(&self) -> Result<String> {
        let (m, l) = (&self.moment, &self.landmarks);
        let mut row = format!("{},{:.5}", self.frame, self.time);
        let a = m.angles;
        let mut put = |values: &[f32]| values.iter().try_for_each(|v| write!(row, ",{v:.5}"));
        put(&[a.yaw_deg, a.pitch_deg, a.roll_deg])?;
        put(&self.at.to_array())?;
        put(&self.rotation.transpose().to_cols_array())?;
        let c = self.camera;
        put(&[c.fx, c.fy, c.cx, c.cy])?;
        put(&[m.blink, m.blink, m.jaw, m.smile])?;
        put(&l.ratios())?;
        write!(row, ",{},{}", u8::from(m.blink > 0.8), u8::from(l.occluder))?;
        write!(row, ",{:.3}", l.in_frame)?;
        for p in l.points {
            write!(row, ",{:.3},{:.3}", p.x, p.y)?;
        }
        for flag in l.seen.iter().chain(&l.covered) {
            write!(row, ",{}", u8::from(*flag))?;
        }
        Ok(row)
    }
}
