//! The cascade's model (section `ALGN`) and one run through it.

use super::{Shape, Views, place};
use crate::descriptor::{Hog, HogGrid, MAX_FEATURES, Projection, VALUES};
use crate::image::{CROP_MAX, Crop, Frame, warp};
use crate::math::Similarity;
use crate::model::{Blob, ModelError, Section};
use crate::shape::LANDMARKS;

/// Most shape modes, the four of the similarity included.
pub const MAX_MODES: usize = 72;
/// Most stages of a cascade.
pub const MAX_STAGES: usize = 6;
/// Most views.
pub const MAX_VIEWS: usize = 4;

/// Coordinates of a shape: x0, y0, x1, …
const COORDINATES: usize = 2 * LANDMARKS;

/// A checked view of section `ALGN`.
#[derive(Clone, Copy, Debug)]
pub struct AlignModel<'m> {
    mean: &'m Shape,
    /// Shapes in the canonical frame, by view.
    starts: &'m [Shape],
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
    /// Features → shape modes, by view.
    pub regressors: [Option<Regressor<'m>>; MAX_VIEWS],
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
        rows.zip(self.scale)
            .zip(self.bias)
            .map(move |((row, scale), bias)| {
                let sum: i32 = row
                    .iter()
                    .zip(features)
                    .map(|(w, f)| *w as i32 * *f as i32)
                    .sum();
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
    view: usize,
    mirrored: bool,
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
            view: 0,
            mirrored: false,
        }
    }

    /// Features of the stage that ran last, landmark by landmark.
    pub fn features(&self) -> &[i8] {
        self.features.get(..self.used).unwrap_or(&[])
    }

    /// View of the stage that ran last, and whether it looked into a mirror: its features are then
    /// those of the mirror image's landmarks.
    pub fn view(&self) -> (usize, bool) {
        (self.view, self.mirrored)
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
    pub fn describe(
        &mut self,
        frame: &Frame<'_>,
        placement: &super::Placement,
        side: usize,
        grid: HogGrid,
    ) {
        warp(frame, &placement.crop_to_frame, side, &mut self.crop);
        if placement.mirrored {
            self.crop.mirror();
        }
        self.hog
            .describe(&self.crop, grid, &placement.points, &mut self.values);
    }

    /// Projects the descriptors.
    pub fn project(&mut self, projection: &Projection<'_>) {
        let features = projection.features();
        self.used = LANDMARKS * features;
        for (values, out) in self
            .values
            .iter()
            .zip(self.features.chunks_exact_mut(features.max(1)))
        {
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
        let views = s.count(1, MAX_VIEWS, "number of views")?;
        let count = s.count(1, MAX_STAGES, "number of stages")?;
        let track_from = s.count(0, count - 1, "first stage when tracking")?;
        let mean = s.f32s(COORDINATES)?;
        let starts = s.f32s(views * COORDINATES)?;
        let turns = s.f32s(views)?;
        let basis = s.i8s(modes * COORDINATES)?;
        let basis_scale = s.f32s(modes)?;
        let mut stages = [None; MAX_STAGES];
        for stage in stages.iter_mut().take(count) {
            *stage = Some(Stage::read(s, modes, views)?);
        }
        let missing = s.error("it ends too early");
        let model = AlignModel {
            mean: shapes_of(mean).first().ok_or(missing)?,
            starts: shapes_of(starts),
            turns,
            basis,
            basis_scale,
            stages,
            track_from,
        };
        let extent = |shape: &Shape| Similarity::fit(shape, shape).is_some();
        let sound = extent(model.mean) && model.starts.iter().all(extent);
        s.require(sound, "a shape has no extent")?;
        Ok(model)
    }

    /// The mean shape, in the canonical frame.
    pub fn mean(&self) -> &Shape {
        self.mean
    }

    /// Start shapes by turn.
    pub fn views(&self) -> Views<'m> {
        Views {
            starts: self.starts,
            turns: self.turns,
        }
    }

    /// The stages, in order.
    pub fn stages(&self) -> impl Iterator<Item = &Stage<'m>> {
        self.stages.iter().flatten()
    }

    /// Features per landmark of the last stage.
    pub fn features(&self) -> usize {
        self.stages()
            .last()
            .map_or(0, |stage| stage.projection.features())
    }

    /// Index of the first stage to run from a tracked shape.
    pub fn track_from(&self) -> usize {
        self.track_from
    }

    /// Runs the stages from index `first` on; `shape` (frame px) is moved in place. Returns false,
    /// with the shape wherever it was then, when it lost its extent.
    pub fn run(
        &self,
        frame: &Frame<'_>,
        first: usize,
        shape: &mut Shape,
        work: &mut Workspace,
    ) -> bool {
        self.stages()
            .skip(first)
            .all(|stage| self.step(frame, stage, shape, work))
    }

    fn step(
        &self,
        frame: &Frame<'_>,
        stage: &Stage<'m>,
        shape: &mut Shape,
        work: &mut Workspace,
    ) -> bool {
        let Some(view) = self.views().of(shape) else {
            return false;
        };
        let placed = place(self.mean, shape, stage.zoom, stage.side, view.mirrored);
        let regressor = stage.regressors.get(view.index).copied().flatten();
        let (Some(placement), Some(regressor)) = (placed, regressor) else {
            return false;
        };
        (work.view, work.mirrored) = (view.index, view.mirrored);
        work.describe(frame, &placement, stage.side, stage.grid);
        work.project(&stage.projection);
        let mut delta = [[0.0f32; 2]; LANDMARKS];
        let rows = self.basis.chunks_exact(COORDINATES).zip(self.basis_scale);
        for (weight, (mode, scale)) in regressor.outputs(work.features()).zip(rows) {
            let weight = weight * scale;
            for (d, [x, y]) in delta.iter_mut().zip(mode.as_chunks::<2>().0) {
                d[0] += weight * *x as f32;
                d[1] += weight * *y as f32;
            }
        }
        *shape = placement.moved(&delta);
        shape.iter().all(|p| p[0].is_finite() && p[1].is_finite())
    }
}

impl<'m> Stage<'m> {
    fn read(s: &mut Section<'m>, modes: usize, views: usize) -> Result<Self, ModelError> {
        let side = s.count(16, CROP_MAX, "crop side")?;
        let zoom = s.f32()?;
        s.require((1e-3..1e3).contains(&zoom), "zoom out of range")?;
        let spacing = s.count(1, 32, "cell spacing")? as i32;
        let radius = s.count(0, 32, "cell radius")? as i32;
        let projection = Projection::read(s)?;
        let mut regressors = [None; MAX_VIEWS];
        for regressor in regressors.iter_mut().take(views) {
            *regressor = Some(Regressor::read(
                s,
                LANDMARKS * projection.features(),
                modes,
            )?);
        }
        Ok(Stage {
            side,
            zoom,
            grid: HogGrid { spacing, radius },
            projection,
            regressors,
        })
    }
}

fn shapes_of(coordinates: &[f32]) -> &[Shape] {
    coordinates.as_chunks::<2>().0.as_chunks::<LANDMARKS>().0
}
