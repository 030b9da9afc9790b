//! Trains the refiners (section `RFIN`): samples are the global stage's own answers on the
//! training faces, shaken a little because it errs more on faces that it has not seen.

use super::evaluate::start_of;
use super::network::{Points, Sizes};
use super::open::with_model;
use super::options::{Aperture, Options};
use super::quantize::write_refiner;
use super::samples::{Augment, EXAMPLES, Sample, cut_at, disturb, standardise};
use super::source::{Draw, Source};
use super::starts::{jittered_box, normal, start_from_box};
use super::train::{Trained, train};
use crate::faces::{Face, ratio};
use crate::single_eyes::{self, Single, is_single};
use anyhow::Result;
use posewise::align::{AlignModel, Refiners, Shape, Workspace, place_refiner};
use posewise::math::Similarity;
use posewise::shape::{LANDMARKS, MIRROR};
use posewise_format::SectionWriter;
use posewise_metrics::BoxJitter;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::path::Path;

/// One refiner of the face.
struct Refiner {
    name: &'static str,
    /// In the order of the network's points.
    landmarks: Vec<usize>,
    /// Whether the mirror images are a refiner of their own.
    mirrored: bool,
    /// Side of its crop \[px\].
    side: usize,
    /// Crop px per canonical unit.
    zoom: f32,
    /// Share of renders among its samples.
    rendered: f32,
    /// Share of crops that moved while they were exposed.
    motion_blurred: f32,
    /// Whether eyes seen alone, if there are some, are added in a second round.
    alone: bool,
}

/// In the order in which they run.
fn all() -> [Refiner; 3] {
    [
        Refiner {
            name: "eye",
            landmarks: (17..22).chain(36..42).collect(),
            mirrored: true,
            side: 56,
            zoom: 2.0,
            rendered: 0.5,
            motion_blurred: 0.0,
            alone: false,
        },
        Refiner {
            name: "mouth",
            landmarks: (48..68).collect(),
            mirrored: false,
            side: 56,
            zoom: 1.5,
            rendered: 0.5,
            motion_blurred: 0.0,
            alone: false,
        },
        Refiner {
            name: "lids",
            landmarks: (36..42).collect(),
            mirrored: true,
            side: 48,
            zoom: 3.5,
            rendered: 0.6,
            motion_blurred: 0.3,
            alone: true,
        },
    ]
}

/// Answers of the global stage kept per face.
const STARTS: usize = 2;
/// Iterations that led to them.
const ITERATIONS: usize = 3;
/// Largest mean error of an answer to go on from \[% of the scale\].
const LOST: f32 = 12.0;
/// Weight of a landmark that is not seen.
const HIDDEN: f32 = 0.15;
/// Below this ratio of height to width an eye's lids in a photograph count like hidden ones: the
/// annotator leaves shut eyes half open. Renders teach what those look like.
const NARROW: f32 = 0.2;
/// How far faces move while they are exposed, at most, in canonical units.
const MOTION_BLUR: f32 = 9.0;
/// How much more often than a photograph of a face one of a single eye is drawn.
const SINGLE: f32 = 3.0;

/// How and from where refiners are trained.
pub struct Training<'a> {
    /// Sections of the cascade's global stage.
    pub global: [&'a SectionWriter; 2],
    /// Faces to train on.
    pub faces: &'a [Face],
    /// Folder of real eyes seen alone ([`single_eyes`]); without it eyes and lids have a second
    /// round on the same faces.
    pub eyes: Option<&'a Path>,
    /// As of [`options`].
    pub options: &'a Options,
    /// Folder of checkpoints.
    pub checkpoints: &'a Path,
}

impl Training<'_> {
    /// Trains section `RFIN`; goes on from checkpoints if there are some.
    pub fn run(&self) -> Result<SectionWriter> {
        let mut refiners = all().into_iter().peekable();
        let mut out = SectionWriter::new(Refiners::TAG);
        out.scalar(refiners.len() as u32);
        let start = |model: &AlignModel<'_>| Ok(starts(model, self.faces));
        let [first, second] = self.global;
        let mut starts = with_model(&self.global, start)?;
        while let Some(refiner) = refiners.next() {
            println!("refiner: {}", refiner.name);
            let (mut trained, samples) = self.round(&refiner, self.faces, &starts, None)?;
            let write = |trained: &Trained, out: &mut SectionWriter| {
                write_refiner(trained, &refiner.landmarks, refiner.mirrored, &samples, out)
            };
            if let Some(eyes) = self.eyes.filter(|_| refiner.alone) {
                // The last stage: with it the section is whole.
                let mut so_far = out.clone();
                write(&trained, &mut so_far)?;
                let find = |model: &AlignModel<'_>| {
                    let found = single_eyes::for_training(model, eyes)?.into_iter();
                    Ok(found.map(|eye| Start::of_single(model, eye)).unzip())
                };
                let (alone, found): (Vec<_>, Vec<_>) = with_model(&[first, second, &so_far], find)?;
                let faces = [self.faces, &alone[..]].concat();
                let starts: Vec<_> = starts.iter().copied().chain(found).collect();
                println!("second round, with eyes seen alone");
                trained = self.round(&refiner, &faces, &starts, Some(trained))?.0;
            } else if self.eyes.is_none() && refiner.mirrored {
                println!("second round");
                trained = self.round(&refiner, self.faces, &starts, Some(trained))?.0;
            }
            let mut alone = SectionWriter::new(Refiners::TAG);
            alone.scalar(1u32);
            for out in [&mut alone, &mut out] {
                write(&trained, out)?;
            }
            if refiners.peek().is_some() {
                // The next stage goes on from where this one ends.
                with_model(&[first, second, &alone], |model| {
                    advance(model, self.faces, &mut starts);
                    Ok(())
                })?;
            }
        }
        Ok(out)
    }

    /// One round of a refiner, after another one or the first; and samples as it meets them.
    fn round(
        &self,
        refiner: &Refiner,
        faces: &[Face],
        starts: &[[Start; STARTS]],
        after: Option<Trained>,
    ) -> Result<(Trained, Vec<Sample>)> {
        let mut options = Options {
            sizes: Sizes::of_refiner(refiner.landmarks.len(), refiner.side, refiner.zoom),
            rendered: refiner.rendered,
            augment: Augment {
                motion_blur: refiner.motion_blurred,
                motion_blur_px: MOTION_BLUR * refiner.zoom,
                ..self.options.augment
            },
            ..self.options.clone()
        };
        let mut name = refiner.name.to_string();
        if after.is_some() {
            options.seed ^= 0xe7e;
            options.rate *= 0.5;
            name += "-second";
        }
        let source = RefinerFaces {
            faces,
            starts,
            options: &options,
            draw: Draw::new(faces, &options, |face| refiner.interest(face))?,
            refiner,
        };
        let name = format!("{name}.checkpoint");
        let initial = after.map(|trained| trained.parameters);
        let trained = train(&source, &options, &self.checkpoints.join(name), initial)?;
        let mut rng = ChaCha8Rng::seed_from_u64(options.seed ^ 2);
        Ok((trained, source.samples(EXAMPLES, &mut rng)))
    }
}

/// How refiners are trained.
pub fn options(seed: u64, steps: usize) -> Options {
    Options {
        seed,
        steps,
        turned: 1.0,
        augment: Augment {
            coarse: 0.25,
            ..Augment::default()
        },
        aperture: Aperture {
            lids: 4.0,
            lips: 1.0,
            from: 0.0,
        },
        ..Options::default()
    }
}

impl Refiner {
    /// How much more often than others a face is drawn: closed eyes and open mouths are rare.
    fn interest(&self, face: &Face) -> f32 {
        let ratio = |ends, aperture: &[_]| ratio(&face.landmarks, ends, aperture);
        if is_single(face) {
            SINGLE
        } else if self.mirrored && face.yaw_deg.is_none() {
            1.0
        } else if self.mirrored {
            let right = ratio([36, 39], &[[37, 41], [38, 40]]);
            let left = ratio([42, 45], &[[43, 47], [44, 46]]);
            1.0 + 20.0 * (0.2 - right.min(left)).clamp(0.0, 0.2)
        } else {
            let open = ratio([60, 64], &[[61, 67], [62, 66], [63, 65]]);
            1.0 + 4.0 * (open - 0.1).clamp(0.0, 0.6)
        }
    }
}

/// What a refiner starts from.
#[derive(Clone, Copy)]
struct Start {
    /// The global stage's answer: canonical frame → frame px.
    seat: Similarity,
    /// As the stages so far have left it.
    shape: Shape,
}

impl Start {
    /// The face and the starts of an eye seen alone.
    fn of_single(model: &AlignModel<'_>, single: Single) -> (Face, [Start; STARTS]) {
        let seat = Similarity::fit(model.mean(), &single.found);
        let start = Start {
            seat: seat.expect("an eye has extent"),
            shape: single.found,
        };
        (single.face, [start; STARTS])
    }
}

/// Where the global stage ends on every face, from boxes as a detector gives them; at the label
/// where it goes astray.
fn starts(model: &AlignModel<'_>, faces: &[Face]) -> Vec<[Start; STARTS]> {
    let ends = ends(model, faces).into_iter();
    ends.zip(faces)
        .map(|(ends, face)| {
            ends.map(|end| {
                let shape = end.unwrap_or(face.landmarks);
                let seat = Similarity::fit(model.mean(), &shape);
                Start {
                    seat: seat.expect("an answer has extent"),
                    shape,
                }
            })
        })
        .collect()
}

/// Where the stages of a model end on every face, from boxes as a detector gives them; nowhere when
/// that is far from the label.
pub(super) fn ends(model: &AlignModel<'_>, faces: &[Face]) -> Vec<[Option<Shape>; STARTS]> {
    faces
        .par_iter()
        .enumerate()
        .map_init(
            || Box::new(Workspace::new()),
            |work, (index, face)| {
                let mut rng = ChaCha8Rng::seed_from_u64(11);
                rng.set_stream(index as u64);
                [(); STARTS].map(|()| {
                    let views = model.views();
                    let (at, size, roll) =
                        jittered_box(&views, &face.landmarks, &BoxJitter::DETECTOR, &mut rng);
                    let start = start_of(model, face.turn());
                    let mut shape = start_from_box(&start, at, size, roll);
                    let ran = model.run(&face.picture.frame(), ITERATIONS, &mut shape, work);
                    let pairs = shape.iter().zip(&face.landmarks);
                    let sum: f32 = pairs.map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1])).sum();
                    let lost = 100.0 * sum / LANDMARKS as f32 > LOST * face.scale();
                    (ran && !lost).then_some(shape)
                })
            },
        )
        .collect()
}

/// Moves the starts by the refiners of a model.
fn advance(model: &AlignModel<'_>, faces: &[Face], starts: &mut [[Start; STARTS]]) {
    faces.par_iter().zip(starts).for_each_init(
        || Box::new(Workspace::new()),
        |work, (face, starts)| {
            for start in starts {
                let before = start.shape;
                if !model.run(&face.picture.frame(), 0, &mut start.shape, work) {
                    start.shape = before;
                }
            }
        },
    );
}

struct RefinerFaces<'a> {
    faces: &'a [Face],
    starts: &'a [[Start; STARTS]],
    options: &'a Options,
    draw: Draw,
    refiner: &'a Refiner,
}

impl RefinerFaces<'_> {
    /// The lids among an eye's landmarks, where its label cannot be trusted.
    fn doubtful(&self, face: &Face, [a, b, c, d, e, f]: [usize; 6]) -> Vec<usize> {
        let photograph = face.yaw_deg.is_none();
        let narrow = ratio(&face.landmarks, [a, d], &[[b, f], [c, e]]) < NARROW;
        match self.refiner.mirrored && photograph && narrow && !is_single(face) {
            true => vec![b, c, e, f],
            false => vec![],
        }
    }
}

impl Source for RefinerFaces<'_> {
    fn draw(&self, rng: &mut ChaCha8Rng) -> Sample {
        let index = self.draw.next(rng);
        let face = &self.faces[index];
        let Start { seat, shape } = &self.starts[index][rng.random_range(0..STARTS)];
        let mirrored = !is_single(face) && rng.random_bool(0.5);
        let which = |k: usize| if mirrored { MIRROR[k] } else { k };
        let landmarks: Vec<usize> = self.refiner.landmarks.iter().map(|k| which(*k)).collect();
        let doubtful = match mirrored {
            false => self.doubtful(face, [36, 37, 38, 39, 40, 41]),
            true => self.doubtful(face, [45, 44, 43, 42, 47, 46]),
        };
        let unit = seat.scale();
        let (grow, turn) = ((0.04 * normal(rng)).exp(), 0.04 * normal(rng));
        let shaken = Similarity {
            a: grow * turn.cos(),
            b: grow * turn.sin(),
            tx: 0.0,
            ty: 0.0,
        };
        let seat = shaken.then(seat);
        let mut points: Points = landmarks.iter().map(|k| shape[*k]).collect();
        let n = points.len() as f32;
        let centre = [0, 1].map(|k| points.iter().map(|p| p[k]).sum::<f32>() / n);
        let shift = [0, 1].map(|_| 0.6 * unit * normal(rng));
        let stretch = [0, 1].map(|_| (0.06 * normal(rng)).exp());
        for p in &mut points {
            for k in 0..2 {
                p[k] = centre[k]
                    + shift[k]
                    + stretch[k] * (p[k] - centre[k])
                    + 0.25 * unit * normal(rng);
            }
        }
        let sizes = &self.options.sizes;
        let to_frame = place_refiner(&seat, &points, sizes.zoom).expect("an answer has extent");
        let mut crop = cut_at(face, &to_frame, sizes.side);
        if mirrored {
            crop.chunks_exact_mut(sizes.side).for_each(<[f32]>::reverse);
        }
        disturb(&mut crop, sizes.side, &self.options.augment, rng);
        standardise(&mut crop);
        let back = to_frame.inverse().expect("a crop has extent");
        let side = if mirrored { -1.0 } else { 1.0 };
        let into = |p: [f32; 2]| {
            let [x, y] = back.apply(p);
            [side * x, y]
        };
        Sample {
            crop,
            start: points.iter().map(|p| into(*p)).collect(),
            truth: landmarks.iter().map(|k| into(face.landmarks[*k])).collect(),
            weights: landmarks
                .iter()
                .map(|k| match face.visible[*k] && !doubtful.contains(k) {
                    true => 1.0,
                    false => HIDDEN,
                })
                .collect(),
        }
    }

    fn aperture(&self, aperture: &Aperture) -> Vec<([usize; 2], f32)> {
        let local = |k: usize| self.refiner.landmarks.iter().position(|l| *l == k);
        aperture
            .pairs()
            .filter_map(|([a, b], weight)| Some(([local(a)?, local(b)?], weight)))
            .collect()
    }

    fn offset(&self) -> Points {
        vec![[0.0; 2]; self.refiner.landmarks.len()]
    }
}
