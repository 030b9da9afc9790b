//! The cascade's model (section `ALGN`) and one run through it.

use super::{Shape, place};
use crate::descriptor::{Hog, HogGrid, MAX_FEATURES, Projection, VALUES};
use crate::image::{CROP_MAX, Crop, Frame, warp};
use crate::math::Similarity;
use crate::model::{Blob, ModelError, Section};
use crate::shape::LANDMARKS;

/// Most shape modes, the four of the similarity included.
pub const MAX_MODES: usize = 72;
/// Most stages of a cascade.
pub const MAX_STAGES: usize = 6;
const MAX_STARTS: usize = 8;

/// Coordinates of a shape: x0, y0, x1, …
const COORDINATES: usize = 2 * LANDMARKS;

/// A checked view of section `ALGN`.
#[derive(Clone, Copy, Debug)]
pub struct AlignModel<'m> {
    mean: &'m [f32],
    /// `starts.len()/COORDINATES` shapes in the canonical frame.
    starts: &'m [f32],
    turns: &'m [f32],
    /// `modes` rows of [`COORDINATES`].
    basis: &'m [i8],
    basis_scale: &'m [f32],
    stages: [Option<Stage<'m>>; MAX_STAGES],
    track_from: usize,
}

/// One stage of the cascade.
#[derive(Clone, Copy, Debug)]
pub struct Stage<'m> {
    /// Side of the crop \[px\].
    pub side: usize,
    /// Crop px per canonical unit.
    pub zoom: f32,
    /// Cells around each landmark.
    pub grid: HogGrid,
    /// The learned part of the features.
    pub projection: Projection<'m>,
    /// Features → shape modes.
    pub regressor: Regressor<'m>,
}

/// A linear map with `i8` weights: `out[o] = scale[o]·Σ weight[o][k]·feature[k] + bias[o]`.
#[derive(Clone, Copy, Debug)]
pub struct Regressor<'m> {
    inputs: usize,
    weight: &'m [i8],
    scale: &'m [f32],
    bias: &'m [f32],
}

impl<'m> Regressor<'m> {
    /// Reads `weight: i8[outputs·inputs], scale: f32[outputs], bias: f32[outputs]`.
    ///
    /// # Errors
    /// When the section ends.
    pub fn read(
        section: &mut Section<'m>,
        inputs: usize,
        outputs: usize,
    ) -> Result<Self, ModelError> {
        Ok(Regressor {
            inputs,
            weight: section.i8s(outputs * inputs)?,
            scale: section.f32s(outputs)?,
            bias: section.f32s(outputs)?,
        })
    }

    /// The outputs, one by one.
    pub fn outputs<'a>(&'a self, features: &'a [i8]) -> impl Iterator<Item = f32> + 'a {
        let rows = self.weight.chunks_exact(self.inputs.max(1));
        rows.zip(self.scale).zip(self.bias).map(move |((row, scale), bias)| {
            let sum: i32 = row.iter().zip(features).map(|(w, f)| *w as i32 * *f as i32).sum();
            sum as f32 * scale + bias
        })
    }
}

/// Working memory of a run; holds nothing between runs but the last stage's features.
#[derive(Clone)]
pub struct Workspace {
    crop: Crop,
    hog: Hog,
    values: [[u8; VALUES]; LANDMARKS],
    features: [i8; LANDMARKS * MAX_FEATURES],
    used: usize,
}

impl Default for Workspace {
    fn default() -> Self {
        Self::new()
    }
}

impl Workspace {
    /// Empty working memory.
    pub const fn new() -> Self {
        Workspace {
            crop: Crop::new(),
            hog: Hog::new(),
            values: [[0; VALUES]; LANDMARKS],
            features: [0; LANDMARKS * MAX_FEATURES],
            used: 0,
        }
    }

    /// Features of the stage that ran last, landmark by landmark.
    pub fn features(&self) -> &[i8] {
        self.features.get(..self.used).unwrap_or(&[])
    }

    /// Descriptors of the stage that ran last.
    pub fn values(&self) -> &[[u8; VALUES]; LANDMARKS] {
        &self.values
    }

    /// The crop of the stage that ran last.
    pub fn crop(&self) -> &Crop {
        &self.crop
    }

    /// Cuts the crop of a placement and describes it around the points.
    pub fn describe(&mut self, frame: &Frame<'_>, placement: &super::Placement, side: usize, grid: HogGrid) {
        warp(frame, &placement.crop_to_frame, side, &mut self.crop);
        self.hog.describe(&self.crop, grid, &placement.points, &mut self.values);
    }

    /// Projects the descriptors.
    pub fn project(&mut self, projection: &Projection<'_>) {
        let features = projection.features();
        self.used = LANDMARKS * features;
        for (values, out) in self.values.iter().zip(self.features.chunks_exact_mut(features.max(1))) {
            projection.project(values, out);
        }
    }
}

impl<'m> AlignModel<'m> {
    /// Name of the section.
    pub const TAG: [u8; 4] = *b"ALGN";

    /// Reads and checks the section.
    ///
    /// # Errors
    /// When it is missing, too short, or a number is out of range.
    pub fn open(blob: &Blob<'m>) -> Result<Self, ModelError> {
        let s = &mut blob.section(&Self::TAG)?;
        let modes = s.count(4, MAX_MODES, "number of modes")?;
        let starts = s.count(1, MAX_STARTS, "number of start shapes")?;
        let count = s.count(1, MAX_STAGES, "number of stages")?;
        let track_from = s.count(0, count - 1, "first stage when tracking")?;
        let mean = s.f32s(COORDINATES)?;
        let starts_shapes = s.f32s(starts * COORDINATES)?;
        let turns = s.f32s(starts)?;
        let basis = s.i8s(modes * COORDINATES)?;
        let basis_scale = s.f32s(modes)?;
        let mut stages = [None; MAX_STAGES];
        for stage in stages.iter_mut().take(count) {
            *stage = Some(Stage::read(s, modes)?);
        }
        let model = AlignModel {
            mean,
            starts: starts_shapes,
            turns,
            basis,
            basis_scale,
            stages,
            track_from,
        };
        let extent = Similarity::fit(&model.mean(), &model.mean());
        s.require(extent.is_some(), "the mean shape has no extent")?;
        Ok(model)
    }

    /// The mean shape, in the canonical frame.
    pub fn mean(&self) -> Shape {
        shape_of(self.mean)
    }

    /// The start shape whose turn (−1 image left … 1 image right) is nearest, in the canonical
    /// frame.
    pub fn start(&self, turn: f32) -> Shape {
        let distance = |t: &f32| libm::fabsf(t - turn);
        let shapes = self.starts.chunks_exact(COORDINATES).zip(self.turns);
        let nearest = shapes.min_by(|(_, a), (_, b)| distance(a).total_cmp(&distance(b)));
        nearest.map_or([[0.0; 2]; LANDMARKS], |(shape, _)| shape_of(shape))
    }

    /// The shape to start the next frame from when this one ended with `shape` (frame px): halfway
    /// to the start shape that resembles it most.
    ///
    /// A cascade that starts from its own answer drifts, because each run adds a little of the same
    /// error; pulled back to a shape that the training fixed, it does not (docs/accuracy.md).
    pub fn relaxed(&self, shape: &Shape) -> Shape {
        let fitted = self.starts.chunks_exact(COORDINATES).filter_map(|start| {
            let start = shape_of(start);
            let to_frame = Similarity::fit(&start, shape)?;
            let start = start.map(|p| to_frame.apply(p));
            let squares = start.iter().zip(shape).map(|(a, b)| {
                let (dx, dy) = (a[0] - b[0], a[1] - b[1]);
                dx * dx + dy * dy
            });
            Some((squares.sum::<f32>(), start))
        });
        let nearest = fitted.min_by(|(a, _), (b, _)| a.total_cmp(b));
        let mut relaxed = *shape;
        for (p, q) in relaxed.iter_mut().zip(nearest.map_or(*shape, |(_, start)| start)) {
            *p = [(p[0] + q[0]) / 2.0, (p[1] + q[1]) / 2.0];
        }
        relaxed
    }

    /// The stages, in order.
    pub fn stages(&self) -> impl Iterator<Item = &Stage<'m>> {
        self.stages.iter().flatten()
    }

    /// Features per landmark of the last stage.
    pub fn features(&self) -> usize {
        self.stages().last().map_or(0, |stage| stage.projection.features())
    }

    /// Index of the first stage to run from a tracked shape.
    pub fn track_from(&self) -> usize {
        self.track_from
    }

    /// Runs the stages from index `first` on; `shape` (frame px) is moved in place. Returns false,
    /// with the shape wherever it was then, when it lost its extent.
    pub fn run(&self, frame: &Frame<'_>, first: usize, shape: &mut Shape, work: &mut Workspace) -> bool {
        let mean = self.mean();
        self.stages().skip(first).all(|stage| self.step(frame, stage, &mean, shape, work))
    }

    fn step(
        &self,
        frame: &Frame<'_>,
        stage: &Stage<'m>,
        mean: &Shape,
        shape: &mut Shape,
        work: &mut Workspace,
    ) -> bool {
        let Some(placement) = place(mean, shape, stage.zoom, stage.side) else {
            return false;
        };
        work.describe(frame, &placement, stage.side, stage.grid);
        work.project(&stage.projection);
        let mut delta = [[0.0f32; 2]; LANDMARKS];
        let rows = self.basis.chunks_exact(COORDINATES).zip(self.basis_scale);
        for (weight, (mode, scale)) in stage.regressor.outputs(work.features()).zip(rows) {
            let weight = weight * scale;
            for (d, [x, y]) in delta.iter_mut().zip(mode.as_chunks::<2>().0) {
                d[0] += weight * *x as f32;
                d[1] += weight * *y as f32;
            }
        }
        let moves = shape.iter_mut().zip(&placement.canonical).zip(&delta);
        for ((point, from), d) in moves {
            *point = placement.canonical_to_frame.apply([from[0] + d[0], from[1] + d[1]]);
        }
        shape.iter().all(|p| p[0].is_finite() && p[1].is_finite())
    }
}

impl<'m> Stage<'m> {
    fn read(s: &mut Section<'m>, modes: usize) -> Result<Self, ModelError> {
        let side = s.count(16, CROP_MAX, "crop side")?;
        let zoom = s.f32()?;
        s.require((1e-3..1e3).contains(&zoom), "zoom out of range")?;
        let spacing = s.count(1, 32, "cell spacing")? as i32;
        let radius = s.count(0, 32, "cell radius")? as i32;
        let projection = Projection::read(s)?;
        let regressor = Regressor::read(s, LANDMARKS * projection.features(), modes)?;
        Ok(Stage { side, zoom, grid: HogGrid { spacing, radius }, projection, regressor })
    }
}

fn shape_of(coordinates: &[f32]) -> Shape {
    let mut shape = [[0.0; 2]; LANDMARKS];
    for (point, xy) in shape.iter_mut().zip(coordinates.as_chunks::<2>().0) {
        *point = *xy;
    }
    shape
}
