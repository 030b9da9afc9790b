//! `posewise-lab eval mesh`: the dense mesh on rendered heads, whose vertices are known exactly.
//!
//! Heads of both families, that no training has seen, turn up to 60°. Each is tracked through
//! frames of the same picture. A vertex counts where the head shows it. Its distance from the truth
//! is given in the picture, in % of the longer side of the box around the true landmarks; and in
//! space, after the mesh was scaled by how far the head truly is over how far it was found, and
//! moved and turned onto the truth. Of the morphable head, the truth is the same vertex.
//! MakeHuman's heads have other vertices. There the mesh is moved onto the points of MakeHuman's
//! mean skin that are nearest to the mean mesh when that is drawn to its landmarks; the truth is
//! then the point of the head's skin that is nearest to the vertex.
//!
//! Jitter: the first pictures again, with new noise in each frame.

use super::mesh_picture::Row;
use crate::eval::on_renders;
use crate::output;
use crate::random::Random;
use crate::rigid::moved_onto;
use anyhow::{Context, Result};
use glam::{Vec2, Vec3};
use image::GrayImage;
use posewise::mesh::{MAX_VERTICES, MeshSpace, MeshVertex};
use posewise::shape::{Identity, LANDMARKS};
use posewise::{Config, FaceHint, Frame, FrameLayout, Model, State, Tracker};
use posewise_metrics::mean;
use posewise_metrics::mesh::{ByRegion, Region, unrest};
use posewise_train::head::Head;
use posewise_train::mesh::{Place, Thinned, nearest, places_on, thinned};
use posewise_train::render::{self, Kind, Renderer, SampleSpec, mesh::Material, sample::Rendered};
use rayon::prelude::*;
use serde_json::{Map, Value, json};
use std::path::{Path, PathBuf};

/// Options of `posewise-lab eval mesh`.
#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    pub on: on_renders::Args,
    /// Rendered heads
    #[arg(long, default_value_t = 400)]
    pub count: u64,
    /// Seed of people and pictures; no training has it
    #[arg(long, default_value_t = 4242)]
    pub seed: u64,
    /// Draw the mesh over some of the heads, larger, in place of measuring it
    #[arg(long, value_name = "FILE")]
    pub picture: Option<PathBuf>,
}

/// Frames of each picture.
const FRAMES: i64 = 10;
/// Pictures and frames for the jitter, and the noise of these \[grey levels\].
const STILL: usize = 40;
const STILL_FRAMES: i64 = 30;
const NOISE: i32 = 4;
/// Frames at the beginning that do not count, in which the identity is learnt.
const LEARNT: usize = 10;

/// Heads of the picture.
const DRAWN: [u64; 3] = [0, 1, 2];

/// What is drawn: larger faces than in most of the training.
fn spec() -> SampleSpec {
    SampleSpec {
        face_px: (90.0, 220.0),
        margin: 0.6,
        yaw_deg: 60.0,
        inner_share: 0.8,
        pitch_deg: 25.0,
        roll_deg: 20.0,
        occluders: 0.0,
        glasses: 0.1,
        caps: 0.0,
        masks: 0.0,
        infrared: 0.1,
        defects: 0.5,
        persons: render::Persons::Procedural,
        makehuman: render::MAKEHUMAN,
        panoramas: render::PANORAMAS,
        ..SampleSpec::default()
    }
}

/// What the vertices are on rendered heads.
struct Truth {
    /// Of the morphable head, and of MakeHuman's.
    places: [Vec<Place>; 2],
    /// Triangles of MakeHuman's skin.
    skin: Vec<[u32; 3]>,
    regions: Vec<Region>,
}

/// How the numbers of turned heads are named, and up to which yaw \[deg\].
const BANDS: [(&str, f32); 2] = [("yaw_0_30", 30.0), ("yaw_30_60", f32::INFINITY)];

/// How far vertices are from where they belong.
#[derive(Default)]
struct Apart {
    picture: ByRegion,
    space_mm: ByRegion,
}

/// Errors of one family.
#[derive(Default)]
struct Errors {
    all: Apart,
    /// Of the heads of each of [`BANDS`].
    bands: [Apart; BANDS.len()],
    /// Visibility of each vertex as found, and whether it truly faces the camera.
    visibility: Vec<(f64, bool)>,
    heads: usize,
    found: usize,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    let file = args.on.file()?;
    let model = file.model()?;
    let head = Head::load(&args.on.data.join("facekit.npz"))?;
    let renderer = args.on.renderer(args.seed, Kind::Near)?;
    if let Some(path) = &args.picture {
        return draw(&model, &renderer, args.seed, path);
    }
    let neutral = model.face().neutral(&Identity::default());
    let truth = Truth::new(&thinned(&head, neutral.landmarks())?, &renderer)?;
    let rendered = |index| renderer.render(args.seed, index, &spec());
    let tracked: Vec<(bool, f32, Option<Vec<Measured>>)> = (0..args.count)
        .into_par_iter()
        .map(|index| {
            let rendered = rendered(index);
            let measured = truth.measure(&model, &rendered)?;
            Ok((
                rendered.is_makehuman(),
                rendered.sample.angles.yaw_deg,
                measured,
            ))
        })
        .collect::<Result<_>>()?;
    let mut errors = [Errors::default(), Errors::default()];
    for (is_makehuman, yaw_deg, measured) in tracked {
        errors[usize::from(is_makehuman)].add(&truth, yaw_deg, measured.as_deref());
    }
    let still: Vec<[f64; 2]> = (0..args.count)
        .take(STILL)
        .collect::<Vec<_>>()
        .into_par_iter()
        .filter_map(|index| jitter(&model, &rendered(index), index).transpose())
        .collect::<Result<_>>()?;
    let of = |k: usize| mean(&still.iter().map(|pair| pair[k]).collect::<Vec<_>>());
    let [morphable, makehuman] = errors.map(|errors| errors.figures());
    let figures = json!({
        "jitter": {
            "pictures": still.len(), "landmarks_px": of(0), "vertices_px": of(1),
            "ratio": of(1).zip(of(0)).map(|(vertices, landmarks)| vertices / landmarks),
        },
        "morphable": morphable,
        "makehuman": makehuman,
    });
    output::show(&figures, args.on.json.as_deref())
}

/// Draws the mesh over [`DRAWN`] heads.
fn draw(model: &Model<'_>, renderer: &Renderer, seed: u64, path: &Path) -> Result<()> {
    let spec = SampleSpec {
        face_px: (280.0, 280.0),
        margin: 0.3,
        defects: 0.0,
        ..spec()
    };
    let topology = model.mesh_topology().context("the model has no mesh")?;
    let mut row = Row::new();
    for index in DRAWN {
        let rendered = renderer.render(seed, index, &spec);
        let mut tracker = start(model, &rendered)?;
        for k in 1..FRAMES {
            step(&mut tracker, model, &rendered, &rendered.sample.luma, k)?;
        }
        let mut mesh = [MeshVertex::default(); MAX_VERTICES];
        let count = tracker.mesh(model, MeshSpace::Picture, &mut mesh)?;
        let sample = &rendered.sample;
        let [width, height] = [sample.width, sample.height].map(|side| side as u32);
        let luma = GrayImage::from_raw(width, height, sample.luma.clone());
        row.add(&luma.context("a whole picture")?, &mesh[..count], &topology);
    }
    Ok(row.picture().save(path)?)
}

/// A vertex on one picture.
struct Measured {
    vertex: usize,
    picture: f64,
    space_mm: f64,
    visibility: f64,
    is_facing: bool,
    is_seen: bool,
}

impl Truth {
    fn new(thinned: &Thinned, renderer: &Renderer) -> Result<Truth> {
        let other = renderer.mesh_of(true);
        let landmarks = other.landmarks.map(|v| other.mean[v as usize]);
        let skin = &other.triangles[other.run(Material::Skin)];
        let own = renderer.mesh_of(false);
        let numbers = |v: &u32| own.mean[*v as usize].to_array().map(f64::from);
        let points: Vec<[f64; 3]> = thinned.vertices.iter().map(numbers).collect();
        let marks: [[f64; 3]; LANDMARKS] = std::array::from_fn(|i| points[i]);
        Ok(Truth {
            places: [
                thinned.vertices.iter().map(|v| Place::at(*v)).collect(),
                places_on(thinned, &landmarks, &other.mean, skin)?,
            ],
            skin: skin.to_vec(),
            regions: points.iter().map(|p| Region::of(*p, &marks)).collect(),
        })
    }

    /// Every vertex of a picture; `None` where the face is not tracked.
    fn measure(&self, model: &Model<'_>, rendered: &Rendered) -> Result<Option<Vec<Measured>>> {
        let mut tracker = start(model, rendered)?;
        for k in 1..FRAMES {
            step(&mut tracker, model, rendered, &rendered.sample.luma, k)?;
        }
        if tracker.result().state != State::Tracking {
            return Ok(None);
        }
        let mut found = [MeshVertex::default(); MAX_VERTICES];
        let count = tracker.mesh(model, MeshSpace::Camera, &mut found)?;
        let found = &found[..count];
        let (sample, skin) = (&rendered.sample, &rendered.skin);
        let places = &self.places[usize::from(rendered.is_makehuman())];
        let marked: Vec<Vec3> = places.iter().map(|p| p.of(&skin.vertices)).collect();
        let far = tracker.result().translation_mm[2];
        let position = |v: &MeshVertex| Vec3::new(v.x, v.y, v.z);
        let scale = sample.position.z / far;
        let scaled: Vec<Vec3> = found.iter().map(|v| position(v) * scale).collect();
        let is_seen = |k: &usize| rendered.shows(marked[*k], places[*k].of(&skin.normals));
        let seen: Vec<usize> = (0..count).filter(is_seen).collect();
        let chosen = |of: &[Vec3]| -> Vec<Vec3> { seen.iter().map(|k| of[*k]).collect() };
        let moved = moved_onto(&chosen(&scaled), &chosen(&marked), &scaled);
        let [low, high] = extent(&sample.landmarks);
        let size = (high - low).max_element();
        let at = |p: Vec3| Vec2::from(sample.camera.image_of(p.to_array()));
        let all = (0..count).map(|k| {
            let place = match rendered.is_makehuman() {
                true => nearest(moved[k], &skin.vertices, &self.skin),
                false => places[k],
            };
            let (truth, normal) = (place.of(&skin.vertices), place.of(&skin.normals));
            let apart = at(position(&found[k])).distance(at(truth));
            Measured {
                vertex: k,
                picture: f64::from(100.0 * apart / size),
                space_mm: moved[k].distance(truth).into(),
                visibility: found[k].visibility.into(),
                is_facing: normal.dot(truth) < 0.0,
                is_seen: rendered.shows(truth, normal),
            }
        });
        Ok(Some(all.collect()))
    }
}

impl Apart {
    fn add(&mut self, region: Region, vertex: &Measured) {
        self.picture.add(region, vertex.picture);
        self.space_mm.add(region, vertex.space_mm);
    }

    fn mean(&self, region: Option<Region>) -> Value {
        json!({"picture_percent": self.picture.mean(region),
            "space_mm": self.space_mm.mean(region)})
    }

    fn figures(&self) -> Map<String, Value> {
        let regions = Region::ALL.iter();
        let regions: Map<String, Value> = regions
            .map(|(region, name)| (String::from(*name), self.mean(Some(*region))))
            .collect();
        [
            (String::from("all"), self.mean(None)),
            (String::from("regions"), Value::Object(regions)),
        ]
        .into_iter()
        .collect()
    }
}

impl Errors {
    fn add(&mut self, truth: &Truth, yaw_deg: f32, measured: Option<&[Measured]>) {
        self.heads += 1;
        self.found += usize::from(measured.is_some());
        let band = BANDS.iter().position(|(_, to)| yaw_deg.abs() < *to);
        let mut band = band.and_then(|k| self.bands.get_mut(k));
        for vertex in measured.unwrap_or_default() {
            self.visibility.push((vertex.visibility, vertex.is_facing));
            if vertex.is_seen {
                let region = truth.regions[vertex.vertex];
                self.all.add(region, vertex);
                if let Some(band) = &mut band {
                    band.add(region, vertex);
                }
            }
        }
    }

    fn figures(&self) -> Value {
        let agreed = self
            .visibility
            .iter()
            .filter(|(v, faces)| (*v > 0.5) == *faces)
            .count();
        let mut figures = json!({
            "heads": self.heads, "tracked": self.found, "vertices": self.all.picture.count(),
            "visibility_right": agreed as f64 / self.visibility.len().max(1) as f64,
        });
        if let Some(figures) = figures.as_object_mut() {
            figures.extend(self.all.figures());
            for ((name, _), band) in BANDS.iter().zip(&self.bands) {
                figures.insert(String::from(*name), Value::Object(band.figures()));
            }
        }
        figures
    }
}

fn extent(points: &[Vec2]) -> [Vec2; 2] {
    let low = points.iter().fold(Vec2::MAX, |low, p| low.min(*p));
    let high = points.iter().fold(Vec2::MIN, |high, p| high.max(*p));
    [low, high]
}

/// A tracker that was shown where the face is.
fn start(model: &Model<'_>, rendered: &Rendered) -> Result<Box<Tracker>> {
    let sample = &rendered.sample;
    let mut config = Config::default();
    config.intrinsics = Some(sample.camera);
    let mut tracker = Box::new(Tracker::new(&config).context("settings")?);
    let [low, high] = extent(&sample.landmarks);
    let size = high - low;
    let layout = FrameLayout::grey(sample.width as u32, sample.height as u32);
    let frame = Frame::new(&layout, &sample.luma)?;
    tracker.step_at(
        model,
        &frame,
        0,
        &FaceHint::new([low.x, low.y, size.x, size.y]),
    )?;
    Ok(tracker)
}

fn step(
    tracker: &mut Tracker,
    model: &Model<'_>,
    rendered: &Rendered,
    luma: &[u8],
    number: i64,
) -> Result<()> {
    let sample = &rendered.sample;
    let layout = FrameLayout::grey(sample.width as u32, sample.height as u32);
    tracker.step(model, &Frame::new(&layout, luma)?, 33_333 * number)?;
    Ok(())
}

/// Mean unrest of the landmarks and of the vertices that are seen, while new noise comes in each
/// frame; `None` where the face is lost.
fn jitter(model: &Model<'_>, rendered: &Rendered, seed: u64) -> Result<Option<[f64; 2]>> {
    let mut tracker = start(model, rendered)?;
    let mut random = Random::of(seed);
    let (mut landmarks, mut vertices) = (Vec::new(), Vec::new());
    let mut seen = Vec::new();
    for number in 1..=STILL_FRAMES {
        // The sum of two even distributions is nearly a normal one.
        let mut noisy = |luma: &u8| {
            let noise = random.within(NOISE) + random.within(NOISE);
            (i32::from(*luma) + noise).clamp(0, 255) as u8
        };
        let luma: Vec<u8> = rendered.sample.luma.iter().map(&mut noisy).collect();
        step(&mut tracker, model, rendered, &luma, number)?;
        let result = tracker.result();
        if result.state != State::Tracking {
            return Ok(None);
        }
        let mut mesh = [MeshVertex::default(); MAX_VERTICES];
        let count = tracker.mesh(model, MeshSpace::Picture, &mut mesh)?;
        let mesh = &mesh[..count];
        landmarks.push(
            result
                .landmarks
                .iter()
                .map(|l| [l.x, l.y].map(f64::from))
                .collect(),
        );
        vertices.push(mesh.iter().map(|v| [v.x, v.y].map(f64::from)).collect());
        seen = mesh.iter().map(|v| v.visibility > 0.5).collect();
    }
    let of_landmarks = unrest(&landmarks[LEARNT..]);
    let of_vertices = unrest(&vertices[LEARNT..]).into_iter().zip(seen);
    let of_vertices: Vec<f64> = of_vertices
        .filter(|(_, seen)| *seen)
        .map(|(v, _)| v)
        .collect();
    Ok(mean(&of_landmarks)
        .zip(mean(&of_vertices))
        .map(|(l, v)| [l, v]))
}
