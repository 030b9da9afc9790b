//! Trains the fine stages (section `PART`): samples are the global stage's own answers on the
//! training faces, shaken a little because it errs more on faces that it has not seen.

use super::evaluate::start_of;
use super::network::{Points, Sizes};
use super::quantise::write_part;
use super::samples::{Augment, Sample, cut_at, disturb, standardise};
use super::starts::{Jitter, jittered_box, normal, start_from_box};
use super::train::{Draw, Gaps, Options, Source, train};
use crate::faces::Face;
use crate::pack::SectionWriter;
use anyhow::Result;
use posewise::align::{AlignModel, Parts, Shape, Workspace, placed};
use posewise::math::Similarity;
use posewise::shape::{LANDMARKS, MIRROR};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::path::Path;

/// One part of the face.
struct Part {
    name: &'static str,
    /// In the order of the network's points.
    landmarks: Vec<usize>,
    /// Whether the mirror images are a part of their own.
    twin: bool,
    /// Crop px per canonical unit.
    zoom: f32,
}

fn all() -> [Part; 2] {
    [
        Part {
            name: "eye",
            landmarks: (17..22).chain(36..42).collect(),
            twin: true,
            zoom: 2.0,
        },
        Part {
            name: "mouth",
            landmarks: (48..68).collect(),
            twin: false,
            zoom: 1.5,
        },
    ]
}

/// Answers of the global stage kept per face.
const STARTS: usize = 2;
/// Passes that led to them.
const PASSES: usize = 3;
/// Errors of the boxes that they began from.
const JITTER: Jitter = Jitter {
    shift: 0.05,
    log_size: 0.08,
    roll: 0.14,
};
/// Largest mean error of an answer to go on from \[% of the scale\].
const LOST: f32 = 12.0;
/// Weight of a landmark that is not seen.
const HIDDEN: f32 = 0.15;

/// Trains section `PART` for this cascade; goes on from checkpoints in `cache`, whose names hold
/// `key`.
pub fn train_parts(
    model: &AlignModel<'_>,
    faces: &[Face],
    options: &Options,
    cache: &Path,
    key: u32,
) -> Result<SectionWriter> {
    let starts = starts(model, faces);
    let parts = all();
    let mut out = SectionWriter::new(Parts::TAG);
    out.scalar(parts.len() as u32);
    for part in parts {
        let options = Options {
            sizes: Sizes::of_part(part.landmarks.len(), part.zoom),
            ..options.clone()
        };
        let source = PartFaces {
            faces,
            mean: model.mean(),
            starts: &starts,
            options: &options,
            draw: Draw::new(faces, &options, |face| part.interest(face))?,
            part: &part,
        };
        println!("fine stage: {}", part.name);
        let checkpoint = cache.join(format!("{}-{key:08x}.checkpoint", part.name));
        let trained = train(&source, &options, &checkpoint, None)?;
        let examples = source.crops(
            super::EXAMPLES,
            &mut ChaCha8Rng::seed_from_u64(options.seed ^ 2),
        );
        write_part(&trained, &part.landmarks, part.twin, &examples, &mut out)?;
    }
    Ok(out)
}

/// How fine stages are trained.
pub fn options(seed: u64, steps: usize) -> Options {
    Options {
        seed,
        steps,
        rendered: 0.5,
        turned: 1.0,
        augment: Augment {
            coarse: 0.25,
            ..Augment::default()
        },
        gaps: Gaps {
            lids: 4.0,
            lips: 1.0,
            from: 0.0,
        },
        ..Options::default()
    }
}

impl Part {
    /// How much more often than others a face is drawn: closed eyes and open mouths are rare.
    fn interest(&self, face: &Face) -> f32 {
        let p = &face.landmarks;
        let distance = |a: usize, b: usize| (p[a][0] - p[b][0]).hypot(p[a][1] - p[b][1]);
        let ratio = |ends: [usize; 2], gaps: &[[usize; 2]]| {
            let gap: f32 = gaps.iter().map(|[a, b]| distance(*a, *b)).sum();
            gap / gaps.len() as f32 / distance(ends[0], ends[1]).max(1.0)
        };
        if self.twin {
            let right = ratio([36, 39], &[[37, 41], [38, 40]]);
            let left = ratio([42, 45], &[[43, 47], [44, 46]]);
            1.0 + 20.0 * (0.2 - right.min(left)).clamp(0.0, 0.2)
        } else {
            let open = ratio([60, 64], &[[61, 67], [62, 66], [63, 65]]);
            1.0 + 4.0 * (open - 0.1).clamp(0.0, 0.6)
        }
    }
}

/// Where the global stage ends on every face, from boxes as a detector gives them.
fn starts(model: &AlignModel<'_>, faces: &[Face]) -> Vec<[Shape; STARTS]> {
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
                    let (at, size, roll) = jittered_box(&views, &face.landmarks, &JITTER, &mut rng);
                    let start = start_of(model, face.turn());
                    let mut shape = start_from_box(&start, at, size, roll);
                    let ran = model.run(&face.picture.frame(), PASSES, &mut shape, work);
                    let pairs = shape.iter().zip(&face.landmarks);
                    let sum: f32 = pairs.map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1])).sum();
                    let lost = 100.0 * sum / LANDMARKS as f32 > LOST * face.scale();
                    if ran && !lost { shape } else { face.landmarks }
                })
            },
        )
        .collect()
}

struct PartFaces<'a> {
    faces: &'a [Face],
    mean: &'a Shape,
    starts: &'a [[Shape; STARTS]],
    options: &'a Options,
    draw: Draw,
    part: &'a Part,
}

impl Source for PartFaces<'_> {
    fn draw(&self, rng: &mut ChaCha8Rng) -> Sample {
        let index = self.draw.next(rng);
        let face = &self.faces[index];
        let shape = &self.starts[index][rng.random_range(0..STARTS)];
        let mirrored = rng.random_bool(0.5);
        let which = |k: usize| if mirrored { MIRROR[k] } else { k };
        let landmarks: Vec<usize> = self.part.landmarks.iter().map(|k| which(*k)).collect();
        let mut seat = Similarity::fit(self.mean, shape).expect("an answer has extent");
        let unit = seat.scale();
        let (grow, turn) = ((0.04 * normal(rng)).exp(), 0.04 * normal(rng));
        let shaken = Similarity {
            a: grow * turn.cos(),
            b: grow * turn.sin(),
            tx: 0.0,
            ty: 0.0,
        };
        seat = shaken.then(&seat);
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
        let to_frame = placed(&seat, &points, sizes.zoom).expect("an answer has extent");
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
                .map(|k| if face.visible[*k] { 1.0 } else { HIDDEN })
                .collect(),
        }
    }

    fn gaps(&self, gaps: &Gaps) -> Vec<([usize; 2], f32)> {
        let local = |k: usize| self.part.landmarks.iter().position(|l| *l == k);
        gaps.pairs()
            .filter_map(|([a, b], weight)| Some(([local(a)?, local(b)?], weight)))
            .collect()
    }

    fn offset(&self) -> Points {
        vec![[0.0; 2]; self.part.landmarks.len()]
    }
}
