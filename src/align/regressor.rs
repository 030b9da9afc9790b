//! A convolutional network with regression heads: from a crop to points in it.

use crate::image::{CROP_MAX, Crop};
use crate::network::{Activations, MAX_FEATURES, Map, Network};
use crate::shape::LANDMARKS;
use posewise_format::{ModelError, Section};

/// Capacity: rank of a head.
pub const MAX_RANK: usize = 96;
/// Capacity: heads of a regressor.
pub const MAX_HEADS: usize = 4;
/// Capacity: input features of a head.
pub const MAX_INPUTS: usize = LANDMARKS * MAX_FEATURES;

/// A head's input holds the whole coarse map.
pub const GLOBAL: u32 = 1;
/// A head's input holds the fine map at the points that the head before it predicted.
pub const SHAPE_INDEXED: u32 = 2;

/// Crop sides that a model may have \[px\]: at least so much.
const MIN_SIDE: usize = 16;
/// Zooms that a model may have \[crop px per canonical unit\].
const ZOOMS: core::ops::Range<f32> = 1e-3..1e3;
/// Points are clamped to this distance from the crop's centre before they are rounded \[px\].
const FARTHEST_PX: f32 = 1000.0;

/// A checked network with its heads. Points are in crop px relative to the crop's centre.
#[derive(Clone, Copy, Debug)]
pub struct Regressor<'m> {
    /// Side of the crop \[px\].
    side: usize,
    /// Crop px per canonical unit.
    zoom: f32,
    network: Network<'m>,
    /// The map whose values are the features of a point.
    fine: Map,
    /// The map that is read as a whole.
    coarse: Map,
    heads: [Option<Head<'m>>; MAX_HEADS],
}

/// A linear regression of low rank: features → `rank` numbers → displacement of every point.
#[derive(Clone, Copy, Debug)]
struct Head<'m> {
    /// [`GLOBAL`], [`SHAPE_INDEXED`], or both.
    sources: u32,
    /// Number of input features.
    inputs: usize,
    /// `rank` rows of `inputs` weights.
    project: &'m [i8],
    /// Value of weight 1 of each row of `project`.
    scale: &'m [f32],
    /// Added to each projection.
    bias: &'m [f32],
    /// `rank` rows of `2·points` weights, `x0, y0, …`.
    expand: &'m [i8],
    /// Value of weight 1 of each row of `expand` \[px\].
    expand_scale: &'m [f32],
    /// Constant displacement, `2·points` numbers \[px\].
    offset: &'m [f32],
}

/// Working memory of a run; its content between runs is not used.
#[derive(Clone)]
pub struct Memory {
    maps: Activations,
    /// Input of the current head.
    features: [u8; MAX_INPUTS],
}

impl Memory {
    /// Empty working memory.
    pub const fn new() -> Self {
        Memory {
            maps: Activations::new(),
            features: [0; MAX_INPUTS],
        }
    }

    /// The memory of a network's maps, for a network of another module between two runs.
    pub fn maps(&mut self) -> &mut Activations {
        &mut self.maps
    }

    /// As [`Activations::scratch`].
    pub fn scratch(&mut self) -> &mut [u8] {
        self.maps.scratch()
    }
}

impl<'m> Regressor<'m> {
    /// As [`Regressor::read`], and checks that no sum of its network overflows.
    ///
    /// # Errors
    /// Likewise, or when a sum might overflow.
    #[inline(always)]
    pub fn open(s: &mut Section<'m>, points: usize) -> Result<Self, ModelError> {
        let regressor = Self::read(s, points);
        if let Ok(regressor) = &regressor {
            regressor.network.check_bounds(s)?;
        }
        regressor
    }

    /// Reads a regressor that was opened before, of `points` points: `side: u32, zoom: f32, fine,
    /// coarse, heads, rank: u32` (`fine` and `coarse` are numbers of nodes), the network, and for
    /// each head `sources: u32, project: i8[rank·inputs], scale, bias: f32[rank], expand:
    /// i8[rank·2·points], expand_scale: f32[rank], offset: f32[2·points]`.
    ///
    /// # Errors
    /// When the section is too short or a number is out of range.
    pub fn read(s: &mut Section<'m>, points: usize) -> Result<Self, ModelError> {
        let side = s.count(MIN_SIDE, CROP_MAX, "crop side")?;
        let zoom = s.f32()?;
        s.require(ZOOMS.contains(&zoom), "zoom out of range")?;
        let [fine, coarse] = [s.u32()? as usize, s.u32()? as usize];
        let heads = s.count(1, MAX_HEADS, "number of heads")?;
        let rank = s.count(1, MAX_RANK, "rank")?;
        let network = Network::read(s, side)?;
        let missing = s.error("it lacks a map");
        let maps = network.map(fine).zip(network.map(coarse));
        let (fine, coarse) = maps.ok_or(missing)?;
        s.require(
            fine.channels() <= MAX_FEATURES && fine.side() > 1,
            "too many features per landmark",
        )?;
        s.require(fine.is_disjoint(&coarse), "a head's map is overwritten")?;
        let mut regressor = Regressor {
            side,
            zoom,
            network,
            fine,
            coarse,
            heads: [None; MAX_HEADS],
        };
        for head in regressor.heads.iter_mut().take(heads) {
            *head = Some(Head::read(s, rank, points, &fine, &coarse)?);
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

    /// Multiply-adds of one run: the network and its heads.
    #[cfg(feature = "unstable-internals")]
    pub fn multiply_adds(&self) -> usize {
        let head = |head: &Head<'_>| head.project.len() + head.expand.len();
        let heads: usize = self.heads.iter().flatten().map(head).sum();
        self.network.multiply_adds() + heads
    }

    /// Regresses the points, in place, on the standardised crop.
    pub fn run(&self, crop: &Crop, points: &mut [[f32; 2]], work: &mut Memory) {
        self.network.run(crop, &mut work.maps);
        let local = points.len() * self.features();
        for head in self.heads.iter().flatten() {
            if head.sources == GLOBAL {
                head.add(work.maps.values(&self.coarse), points);
                continue;
            }
            if let Some(features) = work.features.get_mut(..local) {
                self.features_at(points, &work.maps, features);
            }
            if head.sources & GLOBAL != 0
                && let Some(rest) = work.features.get_mut(local..head.inputs)
            {
                let values = work.maps.values(&self.coarse);
                rest.iter_mut().zip(values).for_each(|(r, v)| *r = *v);
            }
            head.add(work.features.get(..head.inputs).unwrap_or(&[]), points);
        }
    }

    /// How many numbers the last head reads.
    pub fn last_inputs(&self) -> usize {
        let last = self.heads.iter().flatten().last();
        last.map_or(0, |head| head.inputs)
    }

    /// What the last head has read in the last run; nothing where it reads the coarse map alone.
    pub fn last_read<'w>(&self, work: &'w Memory) -> &'w [u8] {
        let last = self.heads.iter().flatten().last();
        let read = last.filter(|head| head.sources != GLOBAL);
        let inputs = read.map_or(0, |head| head.inputs);
        work.features.get(..inputs).unwrap_or(&[])
    }

    /// Features of the last run's crop at these points, `[points][features]`, 0..127.
    pub fn describe(&self, points: &[[f32; 2]], work: &mut Memory, out: &mut [i8]) {
        let count = points.len() * self.features();
        if let Some(features) = work.features.get_mut(..count) {
            self.features_at(points, &work.maps, features);
            for (out, value) in out.iter_mut().zip(features) {
                *out = (*value >> 1) as i8;
            }
        }
    }

    /// Samples the fine map at the points, bilinearly, in fixed point: `[points][features]`.
    fn features_at(&self, points: &[[f32; 2]], maps: &Activations, features: &mut [u8]) {
        let (side, n) = (self.fine.side(), self.fine.channels());
        let values = maps.values(&self.fine);
        // Crop px per pixel of the map: an integer, the product of the strides.
        let step = self.side.div_ceil(side.max(1)).max(1);
        let centre = (self.side as f32 - 1.0) / 2.0;
        // 8 bits of fraction. The last position has a neighbour on its right.
        let last = ((side as i32 - 1) << 8) - 1;
        let at = |v: f32| {
            let v = (v + centre).clamp(-FARTHEST_PX, FARTHEST_PX) * (256.0 / step as f32);
            ((v.max(0.0) + 0.5) as i32).min(last) as usize
        };
        for ([x, y], out) in points.iter().zip(features.chunks_exact_mut(n.max(1))) {
            let (x, y) = (at(*x), at(*y));
            let (fx, fy) = ((x & 255) as u16, (y & 255) as u16);
            let first = ((y >> 8) * side + (x >> 8)) * n;
            let pixel = |at: usize| values.get(at..at + n).unwrap_or(&[]);
            let (a, b) = (pixel(first), pixel(first + n));
            let (c, d) = (pixel(first + side * n), pixel(first + side * n + n));
            for (out, ((a, b), (c, d))) in out.iter_mut().zip(a.iter().zip(b).zip(c.iter().zip(d)))
            {
                // Nothing overflows 16 bits before the second interpolation.
                let top = u16::from(*a) * (256 - fx) + u16::from(*b) * fx;
                let bottom = u16::from(*c) * (256 - fx) + u16::from(*d) * fx;
                let value =
                    u32::from(top) * u32::from(256 - fy) + u32::from(bottom) * u32::from(fy);
                *out = ((value + (1 << 15)) >> 16) as u8;
            }
        }
    }
}

impl<'m> Head<'m> {
    /// Reads a head, as [`Regressor::read`] describes it.
    fn read(
        s: &mut Section<'m>,
        rank: usize,
        points: usize,
        fine: &Map,
        coarse: &Map,
    ) -> Result<Self, ModelError> {
        let sources = s.count(1, (GLOBAL | SHAPE_INDEXED) as usize, "a head's sources")? as u32;
        let global = coarse.range().len() * usize::from(sources & GLOBAL != 0);
        let local = points * fine.channels() * usize::from(sources & SHAPE_INDEXED != 0);
        let inputs = global + local;
        let both = global > 0 && local > 0;
        s.require(!both || inputs <= MAX_INPUTS, "a head has too many inputs")?;
        Ok(Head {
            sources,
            inputs,
            project: s.i8s(rank * inputs)?,
            scale: s.f32s(rank)?,
            bias: s.f32s(rank)?,
            expand: s.i8s(rank * 2 * points)?,
            expand_scale: s.f32s(rank)?,
            offset: s.f32s(2 * points)?,
        })
    }

    /// Adds the head's prediction from `features` to the points.
    fn add(&self, features: &[u8], points: &mut [[f32; 2]]) {
        for (p, o) in points.iter_mut().zip(self.offset.as_chunks::<2>().0) {
            *p = [p[0] + o[0], p[1] + o[1]];
        }
        let mut sums = [0; MAX_RANK];
        crate::network::dots(features, self.project, &mut sums);
        let expand = self.expand.chunks_exact(self.offset.len().max(1));
        let constants = self.scale.iter().zip(self.bias).zip(self.expand_scale);
        for ((sum, row), ((scale, bias), expand_scale)) in sums.iter().zip(expand).zip(constants) {
            let coefficient = (*sum as f32 * scale + bias) * expand_scale;
            let coordinates = points.as_flattened_mut().iter_mut();
            coordinates
                .zip(row)
                .for_each(|(p, weight)| *p += coefficient * f32::from(*weight));
        }
    }
}
