//! A network and the answers read from its maps: from a crop to points in it.

use crate::image::{CROP_MAX, Crop};
use crate::model::{ModelError, Section};
use crate::network::{Activations, MAX_FEATURES, Map, Network};
use crate::shape::LANDMARKS;

/// Most dimensions of an answer.
pub const MAX_RANK: usize = 96;
/// Most answers of one run.
pub const MAX_HEADS: usize = 4;
/// Most features that an answer reads.
pub const MAX_INPUTS: usize = LANDMARKS * MAX_FEATURES;

/// An answer reads the last map, whole.
pub const GLOBAL: u32 = 1;
/// An answer reads the fine map around the points where the answer before it put them.
pub const SHAPE_INDEXED: u32 = 2;

/// A checked network with its answers. Points are in crop px from the crop's centre.
#[derive(Clone, Copy, Debug)]
pub struct Regressor<'m> {
    /// Side of the crop \[px\].
    side: usize,
    /// Crop px per canonical unit.
    zoom: f32,
    network: Network<'m>,
    fine: Map,
    last: Map,
    heads: [Option<Head<'m>>; MAX_HEADS],
}

/// A linear map in two steps: features → rank → displacement of every point.
#[derive(Clone, Copy, Debug)]
struct Head<'m> {
    reads: u32,
    inputs: usize,
    /// `rank` rows of `inputs`.
    project: &'m [i8],
    scale: &'m [f32],
    bias: &'m [f32],
    /// `rank` rows of `2·points`.
    expand: &'m [i8],
    expand_scale: &'m [f32],
    outer: &'m [f32],
}

/// Working memory of a run; holds nothing between runs.
#[derive(Clone)]
pub struct Memory {
    maps: Activations,
    read: [u8; MAX_INPUTS],
}

impl Memory {
    /// Empty working memory.
    pub const fn new() -> Self {
        Memory {
            maps: Activations::new(),
            read: [0; MAX_INPUTS],
        }
    }

    /// As [`Activations::scratch`].
    pub fn scratch(&mut self) -> &mut [u8] {
        self.maps.scratch()
    }
}

impl<'m> Regressor<'m> {
    /// Reads `side: u32, zoom: f32, fine, last, heads, rank: u32`, the network, and each answer,
    /// for `points` points.
    ///
    /// # Errors
    /// When the section is too short or a number is out of range.
    pub fn read(s: &mut Section<'m>, points: usize) -> Result<Self, ModelError> {
        let side = s.count(16, CROP_MAX, "crop side")?;
        let zoom = s.f32()?;
        s.require((1e-3..1e3).contains(&zoom), "zoom out of range")?;
        let [fine, last] = [s.u32()? as usize, s.u32()? as usize];
        let heads = s.count(1, MAX_HEADS, "number of answers")?;
        let rank = s.count(1, MAX_RANK, "number of rank")?;
        let network = Network::read(s, side)?;
        let missing = s.error("it lacks a map");
        let (fine, last) = network.map(fine).zip(network.map(last)).ok_or(missing)?;
        s.require(
            fine.channels() <= MAX_FEATURES && fine.side() > 1,
            "too many features per landmark",
        )?;
        s.require(fine.apart(&last), "an answer's map is overwritten")?;
        let mut regressor = Regressor {
            side,
            zoom,
            network,
            fine,
            last,
            heads: [None; MAX_HEADS],
        };
        for head in regressor.heads.iter_mut().take(heads) {
            let reads = s.count(1, (GLOBAL | SHAPE_INDEXED) as usize, "what is read")? as u32;
            let whole = last.range().len() * usize::from(reads & GLOBAL != 0);
            let local = points * fine.channels() * usize::from(reads & SHAPE_INDEXED != 0);
            let both = whole > 0 && local > 0;
            s.require(
                !both || whole + local <= MAX_INPUTS,
                "an answer reads too much",
            )?;
            *head = Some(Head {
                reads,
                inputs: whole + local,
                project: s.i8s(rank * (whole + local))?,
                scale: s.f32s(rank)?,
                bias: s.f32s(rank)?,
                expand: s.i8s(rank * 2 * points)?,
                expand_scale: s.f32s(rank)?,
                outer: s.f32s(2 * points)?,
            });
        }
        Ok(regressor)
    }

    /// Side of the crop \[px\].
    pub fn side(&self) -> usize {
        self.side
    }

    /// Crop px per canonical unit.
    pub fn zoom(&self) -> f32 {
        self.zoom
    }

    /// Features per point.
    pub fn features(&self) -> usize {
        self.fine.channels()
    }

    /// Moves the points to where the crop shows them.
    pub fn run(&self, crop: &Crop, points: &mut [[f32; 2]], work: &mut Memory) {
        self.network.run(crop, &mut work.maps);
        let local = points.len() * self.features();
        for head in self.heads.iter().flatten() {
            if head.reads == GLOBAL {
                head.add(work.maps.values(&self.last), points);
                continue;
            }
            if let Some(read) = work.read.get_mut(..local) {
                self.features_at(points, &work.maps, read);
            }
            if head.reads & GLOBAL != 0
                && let Some(rest) = work.read.get_mut(local..head.inputs)
            {
                let values = work.maps.values(&self.last);
                rest.iter_mut().zip(values).for_each(|(r, v)| *r = *v);
            }
            head.add(work.read.get(..head.inputs).unwrap_or(&[]), points);
        }
    }

    /// Features of the last run's crop at these points, point by point, 0 … 127.
    pub fn describe(&self, points: &[[f32; 2]], work: &mut Memory, out: &mut [i8]) {
        if let Some(read) = work.read.get_mut(..points.len() * self.features()) {
            self.features_at(points, &work.maps, read);
            for (out, value) in out.iter_mut().zip(read) {
                *out = (*value >> 1) as i8;
            }
        }
    }

    /// Reads the fine map at the points, between its pixels.
    fn features_at(&self, points: &[[f32; 2]], maps: &Activations, read: &mut [u8]) {
        let (side, n) = (self.fine.side(), self.fine.channels());
        let values = maps.values(&self.fine);
        // Crop px per pixel of the map, which its strides fix to a whole number.
        let step = self.side.div_ceil(side.max(1)).max(1);
        let centre = (self.side as f32 - 1.0) / 2.0;
        // 8 bits of fraction; the last pixel has no neighbour to the right.
        let last = ((side as i32 - 1) << 8) - 1;
        let at = |v: f32| {
            let v = (v + centre).clamp(-1000.0, 1000.0) * (256.0 / step as f32);
            (libm::roundf(v) as i32).max(0).min(last) as usize
        };
        for ([x, y], out) in points.iter().zip(read.chunks_exact_mut(n.max(1))) {
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

impl Head<'_> {
    /// Moves the points by what the features say.
    fn add(&self, features: &[u8], points: &mut [[f32; 2]]) {
        for (p, o) in points.iter_mut().zip(self.outer.as_chunks::<2>().0) {
            *p = [p[0] + o[0], p[1] + o[1]];
        }
        let project = self.project.chunks_exact(self.inputs.max(1));
        let expand = self.expand.chunks_exact(self.outer.len().max(1));
        let constants = self.scale.iter().zip(self.bias).zip(self.expand_scale);
        for ((weights, row), ((scale, bias), expand_scale)) in project.zip(expand).zip(constants) {
            let sum: i32 = crate::network::dot(features, weights);
            let mode = (sum as f32 * scale + bias) * expand_scale;
            for (p, [x, y]) in points.iter_mut().zip(row.as_chunks::<2>().0) {
                p[0] += mode * *x as f32;
                p[1] += mode * *y as f32;
            }
        }
    }
}
