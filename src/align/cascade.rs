//! The cascade's model (section `ALGN`) and one run through it.

use super::{Shape, Views, place};
use crate::image::{CROP_MAX, Crop, Frame, warp};
use crate::math::Similarity;
use crate::model::{Blob, ModelError, Section};
use crate::network::{Activations, Map, Network};
use crate::shape::LANDMARKS;

/// Most dimensions of an answer.
pub const MAX_MODES: usize = 96;
/// Most answers of one pass: the first, and corrections.
pub const MAX_HEADS: usize = 4;
/// Most views.
pub const MAX_VIEWS: usize = 4;
/// Most features per landmark.
pub const MAX_FEATURES: usize = 48;

/// Coordinates of a shape: x0, y0, x1, …
const COORDINATES: usize = 2 * LANDMARKS;

/// A checked view of section `ALGN`.
#[derive(Clone, Copy, Debug)]
pub struct AlignModel<'m> {
    mean: &'m Shape,
    /// Shapes in the canonical frame, by view.
    starts: &'m [Shape],
    turns: &'m [f32],
    /// Passes after a detection.
    passes: usize,
    /// Side of the crop \[px\].
    side: usize,
    /// Crop px per canonical unit.
    zoom: f32,
    network: Network<'m>,
    /// What the corrections read, around the landmarks.
    fine: Map,
    /// What the first answer reads, whole.
    last: Map,
    heads: [Option<Head<'m>>; MAX_HEADS],
}

/// A linear map in two steps: features → modes → displacement of every landmark.
#[derive(Clone, Copy, Debug)]
struct Head<'m> {
    inputs: usize,
    /// `modes` rows of `inputs`.
    squeeze: &'m [i8],
    scale: &'m [f32],
    bias: &'m [f32],
    /// `modes` rows of [`COORDINATES`].
    spread: &'m [i8],
    spread_scale: &'m [f32],
    outer: &'m [f32],
}

/// Working memory of a run; holds nothing between runs but the last pass's features.
#[derive(Clone)]
pub struct Workspace {
    crop: Crop,
    maps: Activations,
    read: [u8; LANDMARKS * MAX_FEATURES],
    features: [i8; LANDMARKS * MAX_FEATURES],
    used: usize,
    view: usize,
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
            maps: Activations::new(),
            read: [0; LANDMARKS * MAX_FEATURES],
            features: [0; LANDMARKS * MAX_FEATURES],
            used: 0,
            view: 0,
        }
    }

    /// Features at the landmarks where the run that was last ended, landmark by landmark.
    pub fn features(&self) -> &[i8] {
        self.features.get(..self.used).unwrap_or(&[])
    }

    /// View of the shape where that run ended: 0 towards the camera, then the model's views turned
    /// to the image right, then those turned left.
    pub fn view(&self) -> usize {
        self.view
    }

    /// The crop of the last pass.
    pub fn crop(&self) -> &Crop {
        &self.crop
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
        let views = s.count(1, MAX_VIEWS, "number of views")?;
        let passes = s.count(1, 8, "number of passes")?;
        let side = s.count(16, CROP_MAX, "crop side")?;
        let zoom = s.f32()?;
        s.require((1e-3..1e3).contains(&zoom), "zoom out of range")?;
        let [fine, last] = [s.u32()? as usize, s.u32()? as usize];
        let heads = s.count(1, MAX_HEADS, "number of answers")?;
        let modes = s.count(1, MAX_MODES, "number of modes")?;
        let mean = s.f32s(COORDINATES)?;
        let starts = s.f32s(views * COORDINATES)?;
        let turns = s.f32s(views)?;
        let network = Network::read(s, side)?;
        let missing = s.error("it lacks a map");
        let (fine, last) = network.map(fine).zip(network.map(last)).ok_or(missing)?;
        s.require(
            fine.channels() <= MAX_FEATURES && fine.side() > 1,
            "too many features per landmark",
        )?;
        s.require(fine.apart(&last), "an answer's map is overwritten")?;
        let mut model = AlignModel {
            mean: shapes_of(mean).first().ok_or(missing)?,
            starts: shapes_of(starts),
            turns,
            passes,
            side,
            zoom,
            network,
            fine,
            last,
            heads: [None; MAX_HEADS],
        };
        for (index, head) in model.heads.iter_mut().take(heads).enumerate() {
            let inputs = match index {
                0 => last.range().len(),
                _ => LANDMARKS * fine.channels(),
            };
            *head = Some(Head::read(s, inputs, modes)?);
        }
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

    /// Number of views, turns to the left counted apart: what [`Workspace::view`] stays below.
    pub fn signed_views(&self) -> usize {
        2 * self.starts.len() - 1
    }

    /// Features per landmark.
    pub fn features(&self) -> usize {
        self.fine.channels()
    }

    /// Passes to run after a detection; one is enough from the frame before.
    pub fn passes(&self) -> usize {
        self.passes
    }

    /// The convolutional part.
    pub fn network(&self) -> &Network<'m> {
        &self.network
    }

    /// Runs `passes` times; `shape` (frame px) says where to look and is moved in place. Returns
    /// false, with the shape wherever it was then, when it lost its extent.
    pub fn run(
        &self,
        frame: &Frame<'_>,
        passes: usize,
        shape: &mut Shape,
        work: &mut Workspace,
    ) -> bool {
        if !(0..passes).all(|_| self.pass(frame, shape, work)) {
            return false;
        }
        let Some(view) = self.views().of(shape) else {
            return false;
        };
        work.view = match view.mirrored {
            false => view.index,
            true => self.starts.len() + view.index - 1,
        };
        true
    }

    fn pass(&self, frame: &Frame<'_>, shape: &mut Shape, work: &mut Workspace) -> bool {
        let Some(placed) = place(self.mean, shape, self.zoom, self.side) else {
            return false;
        };
        warp(frame, &placed.corner_to_frame, self.side, &mut work.crop);
        self.network.run(&work.crop, &mut work.maps);
        // In crop px from the crop's centre.
        let mut points = [[0.0f32; 2]; LANDMARKS];
        work.used = LANDMARKS * self.fine.channels();
        for (index, head) in self.heads.iter().flatten().enumerate() {
            if index == 0 {
                head.add(work.maps.values(&self.last), &mut points);
            } else {
                self.read(&points, work);
                head.add(work.read.get(..work.used).unwrap_or(&[]), &mut points);
            }
        }
        self.read(&points, work);
        for (feature, value) in work.features.iter_mut().zip(&work.read) {
            *feature = (value >> 1) as i8;
        }
        *shape = points.map(|p| placed.centred_to_frame.apply(p));
        shape.iter().all(|p| p[0].is_finite() && p[1].is_finite())
    }

    /// Reads the fine map at the points, between its pixels.
    fn read(&self, points: &Shape, work: &mut Workspace) {
        let (side, n) = (self.fine.side(), self.fine.channels());
        let values = work.maps.values(&self.fine);
        // Crop px per pixel of the map, which its strides fix to a whole number.
        let step = self.side.div_ceil(side.max(1)).max(1);
        let centre = (self.side as f32 - 1.0) / 2.0;
        // 8 bits of fraction; the last pixel has no neighbour to the right.
        let last = ((side as i32 - 1) << 8) - 1;
        let at = |v: f32| {
            let v = (v + centre).clamp(-1000.0, 1000.0) * (256.0 / step as f32);
            (libm::roundf(v) as i32).max(0).min(last) as usize
        };
        for ([x, y], out) in points.iter().zip(work.read.chunks_exact_mut(n.max(1))) {
            let (x, y) = (at(*x), at(*y));
            let (fx, fy) = ((x & 255) as u32, (y & 255) as u32);
            let first = ((y >> 8) * side + (x >> 8)) * n;
            let pixel = |at: usize| values.get(at..at + n).unwrap_or(&[]);
            let (a, b) = (pixel(first), pixel(first + n));
            let (c, d) = (pixel(first + side * n), pixel(first + side * n + n));
            for (out, ((a, b), (c, d))) in out.iter_mut().zip(a.iter().zip(b).zip(c.iter().zip(d)))
            {
                let top = *a as u32 * (256 - fx) + *b as u32 * fx;
                let bottom = *c as u32 * (256 - fx) + *d as u32 * fx;
                *out = ((top * (256 - fy) + bottom * fy + (1 << 15)) >> 16) as u8;
            }
        }
    }
}

impl<'m> Head<'m> {
    /// Reads `squeeze: i8[modes·inputs], scale: f32[modes], bias: f32[modes],
    /// spread: i8[modes·136], spread_scale: f32[modes], outer: f32[136]`.
    fn read(s: &mut Section<'m>, inputs: usize, modes: usize) -> Result<Self, ModelError> {
        Ok(Head {
            inputs,
            squeeze: s.i8s(modes * inputs)?,
            scale: s.f32s(modes)?,
            bias: s.f32s(modes)?,
            spread: s.i8s(modes * COORDINATES)?,
            spread_scale: s.f32s(modes)?,
            outer: s.f32s(COORDINATES)?,
        })
    }

    /// Moves the points by what the features say.
    fn add(&self, features: &[u8], points: &mut Shape) {
        for (p, o) in points.iter_mut().zip(self.outer.as_chunks::<2>().0) {
            *p = [p[0] + o[0], p[1] + o[1]];
        }
        let squeeze = self.squeeze.chunks_exact(self.inputs.max(1));
        let spread = self.spread.chunks_exact(COORDINATES);
        let constants = self.scale.iter().zip(self.bias).zip(self.spread_scale);
        for ((weights, row), ((scale, bias), spread_scale)) in squeeze.zip(spread).zip(constants) {
            let sum: i32 = crate::network::dot(features, weights);
            let mode = (sum as f32 * scale + bias) * spread_scale;
            for (p, [x, y]) in points.iter_mut().zip(row.as_chunks::<2>().0) {
                p[0] += mode * *x as f32;
                p[1] += mode * *y as f32;
            }
        }
    }
}

fn shapes_of(coordinates: &[f32]) -> &[Shape] {
    coordinates.as_chunks::<2>().0.as_chunks::<LANDMARKS>().0
}
