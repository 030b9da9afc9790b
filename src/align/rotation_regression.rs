//! The head's rotation, regressed on the cascade's features and shape (section `ROTN`).
//!
//! Landmarks alone leave the yaw of a profile to the few that are not hidden, and those that the
//! cascade only estimates pull it towards the camera. Features and landmarks together, regressed on
//! the true rotations of rendered heads, do not share that bias. The 3D fit takes the result as a
//! Gaussian prior beside the landmarks (maximum a posteriori, thesis 3.1).

use super::shape::Shape;
use super::shape_regression::deviation;
use crate::math::{HeadAngles, head_rotation, towards};
use crate::shape::{Intrinsics, LANDMARKS, RotationPrior};
use glam::{Mat3, Vec3};
use posewise_format::{Blob, ModelError};

/// A checked view of section `ROTN`.
#[derive(Clone, Copy, Debug)]
pub struct RotationRegression<'m> {
    /// Of all landmarks.
    features: usize,
    views: [Option<ViewWeights<'m>>; MAX_VIEWS],
}

/// The regression of one signed view. Each angle is `scale · (weights · inputs) + bias`.
#[derive(Clone, Copy, Debug)]
struct ViewWeights<'m> {
    /// Rows of weights for yaw, pitch and roll: of the features `[68][features]`, then of the
    /// shape `[136]`.
    weights: &'m [i8],
    /// \[deg\]
    scale: &'m [f32],
    /// \[deg\]
    bias: &'m [f32],
    /// Standard deviations of the rotation vector about the crop's axes x, y, z \[rad\].
    sigma: &'m [f32],
}

/// Capacity: signed views (frontal, and three to each side).
const MAX_VIEWS: usize = 7;

/// Number of coordinates of a shape.
const COORDINATES: usize = 2 * LANDMARKS;

/// Steps per canonical unit in which the shape's coordinates are read.
const COORDINATE_STEPS: f32 = 4.0;

/// Least standard deviation \[rad\]; a smaller one would outweigh all landmarks.
const LEAST_SIGMA_RAD: f32 = 0.01;

/// A coordinate of a shape's deviation from the mean shape \[canonical units\] as an input of the
/// regression.
pub fn input_of(coordinate: f32) -> i8 {
    libm::roundf(coordinate * COORDINATE_STEPS) as i8
}

impl<'m> RotationRegression<'m> {
    /// Name of the section.
    pub const TAG: [u8; 4] = *b"ROTN";

    /// No regression: there is no prior.
    pub const NONE: RotationRegression<'static> = RotationRegression {
        features: 0,
        views: [None; MAX_VIEWS],
    };

    /// Reads and checks the section; `features` per landmark and signed `views` are those of the
    /// cascade. The section holds `features, views: u32`, then for each view the fields of a
    /// `ViewWeights` in their order. [`RotationRegression::NONE`] where the model lacks it.
    ///
    /// # Errors
    /// When the section is too short, its sizes differ from the cascade's or a number is out of
    /// range.
    pub fn open(blob: &Blob<'m>, features: usize, views: usize) -> Result<Self, ModelError> {
        let mut s = match blob.section(&Self::TAG) {
            Err(ModelError::Missing(_)) => return Ok(Self::NONE),
            other => other?,
        };
        s.count(features, features, "features differ from the cascade's")?;
        s.count(
            views,
            views.min(MAX_VIEWS),
            "views differ from the cascade's",
        )?;
        let mut regression = RotationRegression {
            features: LANDMARKS * features,
            ..Self::NONE
        };
        for view in regression.views.iter_mut().take(views) {
            let weights = ViewWeights {
                weights: s.i8s(3 * (LANDMARKS * features + COORDINATES))?,
                scale: s.f32s(3)?,
                bias: s.f32s(3)?,
                sigma: s.f32s(3)?,
            };
            let is_valid = weights.sigma.iter().all(|v| *v >= LEAST_SIGMA_RAD);
            s.require(is_valid, "a standard deviation is too small")?;
            *view = Some(weights);
        }
        Ok(regression)
    }

    /// The prior of a face from the cascade's features (`[68][features]`), its signed view
    /// ([`super::Workspace::view`]) and its final shape (frame px). `None` without a
    /// regression for the view, and when the shape has no extent.
    #[inline(never)]
    pub fn predict(
        &self,
        features: &[i8],
        view: usize,
        mean: &Shape,
        shape: &Shape,
        camera: &Intrinsics,
    ) -> Option<RotationPrior> {
        let weights = self.views.get(view)?.as_ref()?;
        if features.len() != self.features {
            return None;
        }
        let (to_frame, deviation) = deviation(mean, shape)?;
        let [yaw_deg, pitch_deg, roll_deg] = weights.angles(features, &deviation);
        let local = head_rotation(HeadAngles {
            yaw_deg,
            pitch_deg,
            roll_deg,
        });
        let from_crop = crop_to_camera(shape, to_frame.angle(), camera);
        let mut sigmas = weights.sigma.iter();
        let information = Vec3::from_array([(); 3].map(|()| {
            let sigma = sigmas.next().copied().unwrap_or(1.0);
            1.0 / (sigma * sigma)
        }));
        let information = Mat3::from_diagonal(information);
        Some(RotationPrior {
            rotation: from_crop * local,
            information: from_crop * information * from_crop.transpose(),
            weight: 1.0,
        })
    }
}

impl ViewWeights<'_> {
    /// Yaw, pitch and roll relative to the crop's camera \[deg\].
    fn angles(&self, features: &[i8], deviation: &Shape) -> [f32; 3] {
        let rows = self.weights.len() / 3;
        let mut rows = self.weights.chunks_exact(rows.max(1));
        let mut numbers = self.scale.iter().zip(self.bias);
        [(); 3].map(|()| {
            let row = rows.next().unwrap_or_default();
            let (of_features, of_shape) =
                row.split_at_checked(features.len()).unwrap_or((&[], &[]));
            let coordinates = deviation.as_flattened().iter().map(|v| input_of(*v));
            let sum = dot(of_features, features.iter().copied()) + dot(of_shape, coordinates);
            let (scale, bias) = numbers.next().unwrap_or((&0.0, &0.0));
            scale * sum as f32 + bias
        })
    }
}

fn dot(weights: &[i8], inputs: impl Iterator<Item = i8>) -> i32 {
    weights
        .iter()
        .zip(inputs)
        .map(|(w, v)| i32::from(*w) * i32::from(v))
        .sum()
}

/// The rotation from the axes of a camera that looks straight at a face's middle and is rolled with
/// it to the camera's axes.
pub fn crop_to_camera(shape: &Shape, roll: f32, camera: &Intrinsics) -> Mat3 {
    let [x, y] = shape
        .iter()
        .fold([0.0, 0.0], |sum, p| [sum[0] + p[0], sum[1] + p[1]]);
    let n = LANDMARKS as f32;
    let [[x, y]] = camera.undistorted(&[[x / n, y / n]]);
    let ray = Vec3::new(
        (x - camera.cx) / camera.fx,
        (y - camera.cy) / camera.fy,
        1.0,
    );
    let (sin, cos) = (libm::sinf(roll), libm::cosf(roll));
    let rolled = Mat3::from_cols(Vec3::new(cos, sin, 0.0), Vec3::new(-sin, cos, 0.0), Vec3::Z);
    towards(ray) * rolled
}
