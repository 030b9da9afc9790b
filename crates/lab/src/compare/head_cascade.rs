//! A regression cascade on local features that moves a head (thesis 5.1, 5.2).
//!
//! A stage reads the features at the head's landmarks, predicts by a linear regression where the
//! landmarks are, and fits the head to them; the next stage reads at the fitted head. Ours: the
//! fit in each stage, and a regression for each view of |yaw|. A face that is turned to the image
//! left is read in a mirror.

use super::fit::{Free, Target, fit};
use super::person::Sketch;
use super::state::State;
use crate::features::local::{FaceCrop, Features};
use crate::features::regression::Linear;
use glam::Vec2;
use posewise::align::{Shape, mirror};
use posewise::image::Frame;
use posewise::math::{Similarity, head_angles};
use posewise::shape::{LANDMARKS, MIRROR};
use posewise_metrics::landmarks::INNER;
use serde::{Deserialize, Serialize};

/// Middles of the views \[deg of |yaw|\].
pub const VIEWS: [f32; 5] = [0.0, 20.0, 40.0, 60.0, 80.0];
/// Millimetres of the head in a canonical unit; a face's box is 64 units wide.
const MM: f32 = 2.2;
/// Width of the fit's prior over that of the motion between frames: the cascade has seen the whole
/// face.
const WIDE: f64 = 4.0;
/// Standard deviation of a landmark that counts whole \[canonical units\].
const SURE: f32 = 1.0;

/// The stages.
#[derive(Serialize, Deserialize)]
pub struct HeadCascade {
    /// In the order in which they move the head.
    pub stages: Vec<Stage>,
}

/// One stage.
#[derive(Serialize, Deserialize)]
pub struct Stage {
    /// What is read at the landmarks.
    pub features: Features,
    /// Of each of [`VIEWS`].
    pub views: Vec<View>,
}

/// The regression of one view.
#[derive(Serialize, Deserialize)]
pub struct View {
    /// From features to displacements of the landmarks \[canonical units\].
    pub weights: Linear,
    /// Root mean square of the distances that are left of each landmark, on faces that the weights
    /// were not learned from \[canonical units\].
    pub left: Vec<f32>,
}

/// A head in a frame as a stage sees it.
pub struct Look {
    /// The head's landmarks \[px\].
    pub shape: Shape,
    /// From canonical units to the frame: upright as the head, in its size.
    canonical: Similarity,
    is_mirrored: bool,
    /// |yaw| \[deg\].
    pub yaw_deg: f32,
}

impl Look {
    /// The head in this state.
    pub fn at(head: &Sketch<'_>, state: &State) -> Look {
        let shape = head.shape(state);
        // The image of the head's axis from brow to chin, which a nod turns in profile.
        let down = state.rotation.y_axis.truncate().normalize_or(Vec2::Y);
        let scale = MM * head.camera.fx / state.translation.z;
        let inner = &shape[INNER..];
        let middle = |k: usize| inner.iter().map(|p| p[k]).sum::<f32>() / inner.len() as f32;
        let yaw_deg = head_angles(&state.rotation).yaw_deg;
        Look {
            canonical: Similarity {
                a: scale * down.y,
                b: -scale * down.x,
                tx: middle(0),
                ty: middle(1),
            },
            is_mirrored: yaw_deg < 0.0,
            yaw_deg: yaw_deg.abs(),
            shape,
        }
    }

    /// What it shows, `step` canonical units a px.
    pub fn crop(&self, frame: &Frame<'_>, step: f32) -> FaceCrop {
        let crop = FaceCrop::placed(frame, &self.canonical, &self.shape, step);
        match self.is_mirrored {
            true => crop.mirrored(),
            false => crop,
        }
    }

    /// The nearest of [`VIEWS`].
    pub fn view(&self) -> usize {
        let off = |view: &usize| (VIEWS[*view] - self.yaw_deg).abs();
        let all = 0..VIEWS.len();
        all.min_by(|a, b| off(a).total_cmp(&off(b)))
            .expect("there are views")
    }

    /// Displacements that lead to a shape of the frame \[canonical units\], x and y of each
    /// landmark.
    pub fn displacements(&self, to: &Shape) -> Vec<f32> {
        let back = self.canonical.inverse().expect("a head has extent");
        let moved: Shape = std::array::from_fn(|i| {
            let (to, from) = (back.apply(to[i]), back.apply(self.shape[i]));
            [to[0] - from[0], to[1] - from[1]]
        });
        let moved = if self.is_mirrored {
            mirror(&moved)
        } else {
            moved
        };
        moved.into_iter().flatten().collect()
    }

    /// The shape of the frame that displacements lead to.
    pub fn moved(&self, displacements: &[f32]) -> Shape {
        let moved: Shape =
            std::array::from_fn(|i| [displacements[2 * i], displacements[2 * i + 1]]);
        let moved = if self.is_mirrored {
            mirror(&moved)
        } else {
            moved
        };
        std::array::from_fn(|i| {
            let [dx, dy] = self.canonical.apply_vector(moved[i]);
            [self.shape[i][0] + dx, self.shape[i][1] + dy]
        })
    }

    /// The head near `prior` whose inner landmarks come nearest to those of a shape, which are
    /// `left` off.
    pub fn settled(
        &self,
        head: &Sketch<'_>,
        prior: &State,
        shape: &Shape,
        left: &[f32],
    ) -> Option<State> {
        let target = |landmark: usize| {
            let read = if self.is_mirrored {
                MIRROR[landmark]
            } else {
                landmark
            };
            Target {
                landmark,
                at: shape[landmark],
                weight: (SURE / left[read]).powi(2).min(1.0),
            }
        };
        let targets: Vec<Target> = (INNER..LANDMARKS).map(target).collect();
        let pose = fit(head, prior, &targets, Free::Pose, WIDE)?;
        fit(head, &pose, &targets, Free::All, WIDE)
    }
}

impl HeadCascade {
    /// The head in a frame and its landmarks there, from where it was before. `None` if it was
    /// nowhere.
    pub fn run(
        &self,
        frame: &Frame<'_>,
        head: &Sketch<'_>,
        before: &State,
    ) -> Option<(State, Shape)> {
        let mut found = (*before, head.shape(before));
        for stage in &self.stages {
            let look = Look::at(head, &found.0);
            let crop = look.crop(frame, stage.features.step);
            let view = &stage.views[look.view()];
            let shape = look.moved(&view.weights.of(&stage.features.of(&crop)));
            found = (look.settled(head, before, &shape, &view.left)?, shape);
        }
        let is_finite = found.1.iter().flatten().all(|v| v.is_finite());
        is_finite.then_some(found)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A head that is turned in the picture.
    fn look(is_mirrored: bool) -> Look {
        let angle = |i: usize| i as f32 * 0.37;
        Look {
            shape: std::array::from_fn(|i| [90.0 + 30.0 * angle(i).cos(), 70.0 + i as f32]),
            canonical: Similarity {
                a: 1.2,
                b: -0.5,
                tx: 90.0,
                ty: 100.0,
            },
            is_mirrored,
            yaw_deg: 27.0,
        }
    }

    #[test]
    fn displacements_lead_to_their_shape() {
        for is_mirrored in [false, true] {
            let look = look(is_mirrored);
            let to: Shape = std::array::from_fn(|i| [i as f32, 90.0 - 0.5 * i as f32]);
            let moved = look.moved(&look.displacements(&to));
            let pairs = moved.iter().flatten().zip(to.iter().flatten());
            assert!(pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-2));
        }
    }

    #[test]
    fn a_head_belongs_to_the_nearest_view() {
        assert_eq!(VIEWS[look(false).view()], 20.0);
    }
}
