//! The alignment cascade: frame and initial shape in, 68 landmarks out.
//!
//! Each iteration of the *global stage* warps the face into an upright crop of canonical size and
//! runs a small convolutional network on it ([`crate::network`]), which gives feature maps. The
//! first head regresses all landmarks from the coarsest map. Each further head reads the fine map
//! at the 68 landmarks of the head before it (shape-indexed features, Cao et al., IJCV 2014) and
//! moves all landmarks by a linear function of all these features, so that landmarks correct each
//! other (coarse-to-fine correlative regression, thesis 5.1). A model may hold a second ensemble
//! member, which sees the mirrored crop; both predictions are averaged. *Local refiners* of the
//! same kind then see the eyes with brows, the mouth and the lids in closer crops. A linear *shape
//! regression* finally corrects each landmark by the whole shape. All arithmetic from pixels to the
//! sums of a prediction is in integers.
//!
//! An iteration depends on its input shape only through the similarity transform that maps the mean
//! shape onto it: repeated iterations do not drift.
//!
//! The *canonical frame* is that of the mean shape: origin at its centroid, upright. The model's
//! `zoom` is the number of crop pixels per canonical unit.

mod cascade;
mod correction;
mod ensemble;
mod eyes;
mod placement;
mod refiners;
mod regressor;
mod rotation_regression;
mod shape;
mod shape_regression;
mod views;
mod weights;
mod workspace;

pub use cascade::AlignModel;
pub use correction::Networks;
pub use ensemble::EnsembleMember;
pub use eyes::{EyeModel, EyePlace, SeenEye};
pub use refiners::Refiners;
pub use rotation_regression::RotationRegression;
pub use shape::Shape;
pub use weights::{FaceGeometry, MIDDLE_WEIGHTS, WEIGHT_OUTPUTS};
pub use workspace::Workspace;

#[cfg(feature = "unstable-internals")]
pub use cascade::MAX_VIEWS;
#[cfg(feature = "unstable-internals")]
pub use eyes::{EYE_OUTPUTS, EYES_TAG};
#[cfg(feature = "unstable-internals")]
pub use placement::{Placement, mirror, place};
#[cfg(feature = "unstable-internals")]
pub use refiners::{MAX_POINTS, place_refiner};
#[cfg(feature = "unstable-internals")]
pub use regressor::{GLOBAL, MAX_HEADS, MAX_INPUTS, MAX_RANK, SHAPE_INDEXED};
#[cfg(feature = "unstable-internals")]
pub use rotation_regression::{crop_to_camera, input_of};
#[cfg(feature = "unstable-internals")]
pub use shape_regression::{ShapeRegression, deviation};
#[cfg(feature = "unstable-internals")]
pub use views::{View, Views};
#[cfg(feature = "unstable-internals")]
pub use weights::{
    GEOMETRY, Inputs, MAX_REFINERS, MAX_SEEN, MAX_WEIGHT_INPUTS, SIDE_WEIGHTS, Seen, WEIGHTS_TAG,
    WeightModel,
};
