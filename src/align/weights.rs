//! Animation weights that the 3D face has no modes for (section `WGHT`): puffed cheeks, a rolled
//! lip, a mouth moved aside.
//!
//! Landmarks alone hardly show them. What the refiners' networks see around eyes and mouth does,
//! and they have run already: a few linear combinations of what their last heads read are taken
//! from each run. A small network with one hidden layer makes weights of these, of what the
//! landmarks differ by from the fitted face, of the fitted weights and of the turn of the head. It
//! knows one side of the face, as the refiners do: the person's left side is seen mirrored.

use super::regressor::MAX_INPUTS;
use crate::math::dot;
use crate::shape::{FITTED, FITTED_MIRROR, LANDMARKS, MIRROR};
use posewise_format::{Blob, ModelError, Section, Tag};

/// Name of the section.
pub const WEIGHTS_TAG: Tag = *b"WGHT";

/// Capacity: refiners of a model.
pub const MAX_REFINERS: usize = 3;
/// Capacity: combinations of what a refiner's run sees.
pub const MAX_SEEN: usize = 12;
/// Capacity: hidden values.
const MAX_HIDDEN: usize = 32;

/// Weights that belong to no side: `cheekPuff`, `jawForward`, `mouthClose`, `mouthRollLower`,
/// `mouthRollUpper`, `mouthShrugLower`, `mouthShrugUpper`.
pub const MIDDLE_WEIGHTS: usize = 7;
/// Weights of each side: `eyeSquint`, `mouthDimple`, `mouthLeft` or `mouthRight`, `mouthPress`,
/// `noseSneer`.
pub const SIDE_WEIGHTS: usize = 5;
/// Outputs of a run: the weights of the middle, then those of the person's right side.
pub const WEIGHT_OUTPUTS: usize = MIDDLE_WEIGHTS + SIDE_WEIGHTS;

/// Inputs of the geometry: what the landmarks differ by, fitted weights, the turn of the head.
pub const GEOMETRY: usize = 2 * LANDMARKS + FITTED + 2;
/// Capacity: inputs of a run.
pub const MAX_WEIGHT_INPUTS: usize = GEOMETRY + 2 * MAX_SEEN * MAX_REFINERS;

/// Inputs of a run; those beyond the model's are not used.
pub type Inputs = [f32; MAX_WEIGHT_INPUTS];

/// Inputs are this many standard deviations from their means at most.
const FARTHEST: f32 = 5.0;

/// What a fitted face is, as far as weights follow from it.
#[derive(Clone, Copy, Debug)]
pub struct FaceGeometry {
    /// What the landmarks differ by from the fitted face, along the axes of the head \[mm\].
    pub residuals: [[f32; 2]; LANDMARKS],
    /// The fitted weights.
    pub fitted: [f32; FITTED],
    /// Yaw and pitch of the face against the line of sight \[rad\].
    pub turn: [f32; 2],
}

/// What the refiners have seen in their last run, and the inputs of the last run of the weights.
#[derive(Clone)]
pub struct Seen {
    /// By refiner: of the plain crop, and of the mirrored one.
    runs: [[[f32; MAX_SEEN]; 2]; MAX_REFINERS],
    inputs: Inputs,
}

impl Seen {
    /// Nothing.
    pub const NOTHING: Seen = Seen {
        runs: [[[0.0; MAX_SEEN]; 2]; MAX_REFINERS],
        inputs: [0.0; MAX_WEIGHT_INPUTS],
    };

    /// The inputs of the last run.
    #[cfg(feature = "unstable-internals")]
    pub fn inputs(&self) -> &Inputs {
        &self.inputs
    }
}

/// A checked view of section `WGHT`; empty where the model lacks it.
///
/// Content, in this order: for each of the three refiners `seen, inputs: u32`, and where `seen` is
/// not 0 `project: i8[seen·inputs]`, `scale: f32[seen]`; `hidden: u32`; `mean, scale: f32[inputs]`
/// of all inputs; `weights: i8[hidden·inputs]`, `weight_scale, bias: f32[hidden]`; `expand:
/// f32[hidden·12]`, by hidden value; `direct: i8[12·inputs]`, `direct_scale, offset: f32[12]`.
///
/// The inputs are those of the geometry, then of each refiner what it has seen of the own side and
/// of the other side of the face.
#[derive(Clone, Debug, Default)]
pub struct WeightModel<'m> {
    content: Option<Section<'m>>,
}

/// What is taken of a refiner.
#[derive(Clone, Copy, Debug, Default)]
struct View<'m> {
    /// Numbers that are taken of each run.
    seen: usize,
    /// What the refiner's last head reads.
    inputs: usize,
    project: &'m [i8],
    scale: &'m [f32],
}

/// What is taken of all refiners.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Views<'m>([View<'m>; MAX_REFINERS]);

/// The network behind it.
struct Network<'m> {
    mean: &'m [f32],
    scale: &'m [f32],
    weights: &'m [i8],
    weight_scale: &'m [f32],
    bias: &'m [f32],
    expand: &'m [f32],
    direct: &'m [i8],
    direct_scale: &'m [f32],
    offset: &'m [f32],
}

impl<'m> View<'m> {
    fn read(s: &mut Section<'m>) -> Result<Self, ModelError> {
        let seen = s.count(0, MAX_SEEN, "too much is seen")?;
        let inputs = s.count(0, MAX_INPUTS, "too many inputs")?;
        if seen == 0 {
            return Ok(View::default());
        }
        Ok(View {
            seen,
            inputs,
            project: s.i8s(seen * inputs)?,
            scale: s.f32s(seen)?,
        })
    }
}

impl<'m> Views<'m> {
    fn read(s: &mut Section<'m>) -> Result<Self, ModelError> {
        let mut views = Views::default();
        for view in &mut views.0 {
            *view = View::read(s)?;
        }
        Ok(views)
    }

    /// Number of all inputs.
    fn inputs(&self) -> usize {
        GEOMETRY + self.0.iter().map(|view| 2 * view.seen).sum::<usize>()
    }

    /// Takes what a refiner's last head has read in a run.
    pub(super) fn take(&self, refiner: usize, mirror: bool, read: &[u8], seen: &mut Seen) {
        let view = self.0.get(refiner).copied().unwrap_or_default();
        let out = (seen.runs.get_mut(refiner)).map(|[plain, mirrored]| match mirror {
            false => plain,
            true => mirrored,
        });
        let Some(out) = out.filter(|_| view.seen > 0 && read.len() == view.inputs) else {
            return;
        };
        let mut sums = [0; MAX_SEEN];
        crate::network::dots(read, view.project, &mut sums);
        for (out, (sum, scale)) in out.iter_mut().zip(sums.iter().zip(view.scale)) {
            *out = *sum as f32 * scale;
        }
    }
}

impl<'m> Network<'m> {
    fn read(s: &mut Section<'m>, inputs: usize) -> Result<Self, ModelError> {
        let hidden = s.count(1, MAX_HIDDEN, "number of hidden values")?;
        Ok(Network {
            mean: s.f32s(inputs)?,
            scale: s.f32s(inputs)?,
            weights: s.i8s(hidden * inputs)?,
            weight_scale: s.f32s(hidden)?,
            bias: s.f32s(hidden)?,
            expand: s.f32s(hidden * WEIGHT_OUTPUTS)?,
            direct: s.i8s(WEIGHT_OUTPUTS * inputs)?,
            direct_scale: s.f32s(WEIGHT_OUTPUTS)?,
            offset: s.f32s(WEIGHT_OUTPUTS)?,
        })
    }

    /// The outputs for the inputs of both sides.
    fn run(&self, [right, left]: [&[f32]; 2]) -> [[f32; WEIGHT_OUTPUTS]; 2] {
        let sides = [self.scaled(right), self.scaled(left)];
        let count = right.len().min(left.len());
        let sides = (sides.each_ref()).map(|inputs| inputs.get(..count).unwrap_or(&[]));
        let mut out = [[0.0; WEIGHT_OUTPUTS]; 2];
        let constants = self.direct_scale.iter().zip(self.offset);
        let rows = self.direct.chunks_exact(count.max(1));
        for (k, (row, (scale, offset))) in rows.zip(constants).enumerate() {
            for (out, sum) in out.iter_mut().zip(row_dots(row, sides)) {
                if let Some(out) = out.get_mut(k) {
                    *out = scale * sum + offset;
                }
            }
        }
        let constants = self.weight_scale.iter().zip(self.bias);
        let rows = self.weights.chunks_exact(count.max(1));
        let expand = self.expand.as_chunks::<WEIGHT_OUTPUTS>().0;
        for ((row, (scale, bias)), expand) in rows.zip(constants).zip(expand) {
            for (out, sum) in out.iter_mut().zip(row_dots(row, sides)) {
                let value = (scale * sum + bias).max(0.0);
                for (out, weight) in out.iter_mut().zip(expand) {
                    *out += value * weight;
                }
            }
        }
        out
    }

    /// Inputs in standard deviations from their means.
    #[expect(clippy::manual_clamp, reason = "what is no number becomes one")]
    fn scaled(&self, raw: &[f32]) -> Inputs {
        let mut inputs = [0.0; MAX_WEIGHT_INPUTS];
        let scaled = raw.iter().zip(self.mean.iter().zip(self.scale));
        for (input, (raw, (mean, scale))) in inputs.iter_mut().zip(scaled) {
            *input = ((raw - mean) * scale).max(-FARTHEST).min(FARTHEST);
        }
        inputs
    }
}

/// Σ weight·input of the inputs of both sides.
fn row_dots(row: &[i8], sides: [&[f32]; 2]) -> [f32; 2] {
    let mut weights = [0.0; MAX_WEIGHT_INPUTS];
    for (weight, value) in weights.iter_mut().zip(row) {
        *weight = f32::from(*value);
    }
    let weights = weights.get(..row.len()).unwrap_or(&[]);
    sides.map(|inputs| dot(weights, inputs))
}

impl<'m> WeightModel<'m> {
    /// Reads and checks the section. `heads`: what the last heads of the refiners read.
    ///
    /// # Errors
    /// [`ModelError::Section`] when it is too short, a number is out of range, or it belongs to
    /// other refiners.
    #[inline(never)]
    pub(super) fn open(blob: &Blob<'m>, heads: &[usize]) -> Result<Self, ModelError> {
        let content = match blob.section(&WEIGHTS_TAG) {
            Err(ModelError::Missing(_)) => return Ok(WeightModel::default()),
            other => other?,
        };
        let s = &mut content.clone();
        let views = Views::read(s)?;
        let fits = (views.0.iter().enumerate())
            .all(|(k, view)| view.seen == 0 || heads.get(k) == Some(&view.inputs));
        s.require(fits, "it belongs to other refiners")?;
        Network::read(s, views.inputs())?;
        Ok(WeightModel {
            content: Some(content),
        })
    }

    /// What is taken of the refiners.
    pub(super) fn views(&self) -> Views<'m> {
        // Reading cannot fail: `open` checked the section.
        let views = self.content.clone().map(|mut s| Views::read(&mut s));
        views.and_then(Result::ok).unwrap_or_default()
    }

    /// Multiply-adds for both sides of a face.
    #[cfg(feature = "unstable-internals")]
    pub fn multiply_adds(&self) -> usize {
        let Some(mut s) = self.content.clone() else {
            return 0;
        };
        let Ok(views) = Views::read(&mut s) else {
            return 0;
        };
        let network = Network::read(&mut s, views.inputs());
        let of_network = network.map_or(0, |n| n.weights.len() + n.expand.len() + n.direct.len());
        let of_views: usize = views.0.iter().map(|view| view.project.len()).sum();
        2 * (of_network + of_views)
    }

    /// Weights of the middle and of the person's right side, and likewise with the left side, of a
    /// face that the refiners have just seen. `None` where the model lacks the section.
    #[inline(never)]
    pub fn run(&self, face: &FaceGeometry, seen: &mut Seen) -> Option<[[f32; WEIGHT_OUTPUTS]; 2]> {
        let mut s = self.content.clone()?;
        let views = Views::read(&mut s).ok()?;
        let network = Network::read(&mut s, views.inputs()).ok()?;
        seen.set_inputs(face, &views);
        let count = views.inputs();
        let [plain, mirrored] = [seen.inputs, views.mirrored(&seen.inputs)];
        let sides = [&plain, &mirrored].map(|inputs| inputs.get(..count).unwrap_or(&[]));
        Some(network.run(sides))
    }

    /// The inputs of the mirror image of a face with these.
    #[cfg(feature = "unstable-internals")]
    pub fn mirrored(&self, inputs: &Inputs) -> Inputs {
        self.views().mirrored(inputs)
    }

    /// Number of inputs.
    #[cfg(feature = "unstable-internals")]
    pub fn inputs(&self) -> usize {
        self.views().inputs()
    }
}

impl Views<'_> {
    /// The inputs of the mirror image of a face with these.
    fn mirrored(&self, inputs: &Inputs) -> Inputs {
        let mut out = [0.0; MAX_WEIGHT_INPUTS];
        let at = |index: usize| inputs.get(index).copied().unwrap_or_default();
        let residuals = out.as_chunks_mut::<2>().0.iter_mut();
        for (out, other) in residuals.zip(MIRROR) {
            *out = [-at(2 * other), at(2 * other + 1)];
        }
        let fitted = out.iter_mut().skip(2 * LANDMARKS);
        for (out, other) in fitted.zip(FITTED_MIRROR) {
            *out = at(2 * LANDMARKS + other);
        }
        let turn = 2 * LANDMARKS + FITTED;
        let turned = [-at(turn), at(turn + 1)];
        (out.iter_mut().skip(turn))
            .zip(turned)
            .for_each(|(out, v)| *out = v);
        let mut first = GEOMETRY;
        for View { seen, .. } in self.0 {
            let sides = (0..seen).map(|k| [first + seen + k, first + k]);
            for (k, [of_own, of_other]) in sides.enumerate() {
                let places = [(first + k, of_own), (first + seen + k, of_other)];
                for (to, from) in places {
                    if let Some(out) = out.get_mut(to) {
                        *out = at(from);
                    }
                }
            }
            first += 2 * seen;
        }
        out
    }
}

impl Seen {
    /// Sets the inputs for a face.
    fn set_inputs(&mut self, face: &FaceGeometry, views: &Views<'_>) {
        let runs = self.runs.iter().zip(&views.0);
        let seen = runs.flat_map(|(runs, view)| {
            let taken = move |run: &'_ [f32; MAX_SEEN]| (*run).into_iter().take(view.seen);
            runs.iter().flat_map(taken)
        });
        let geometry = face.residuals.as_flattened().iter();
        let geometry = geometry.chain(&face.fitted).chain(&face.turn).copied();
        for (out, value) in self.inputs.iter_mut().zip(geometry.chain(seen)) {
            *out = value;
        }
    }
}
