//! What is seen of the fitted face's eyes by the network of single eyes: lids, glasses, gaze.

mod learnt;
mod result;

pub use learnt::PersonsEyes;
pub use result::{EYE_LOOK_NAMES, EYE_LOOKS, Eye, EyeUnknown, Eyes, Gaze};

use super::fit::Fitted;
use super::geometry::{gaze_angles, length};
use super::policy::{
    EYE_DARK, EYE_LOOK_RAD, EYE_MAX_BLUR, EYE_MAX_GLARE, EYE_MIN_FACING_COSINE, EYE_MIN_PX_PER_MM,
    EYE_MIN_VISIBILITY, EYE_VISIBLE, EYE_VISIBLE_AFTER_ALL, GAZE_MAX_SIGMA_DEG, GAZE_MIN_OPEN,
    GAZE_SHARED,
};
use super::step::Step;
use crate::align::{EyePlace, SeenEye, Workspace};
use crate::math::rotation_from_quaternion;
use crate::shape::Pose;
use glam::{Mat3, Vec3};
use learnt::GlassesSeen;

/// One of the person's eyes.
struct Side {
    /// Its first landmark, of six.
    first: usize,
    /// Whether the network sees its mirror image.
    is_mirrored: bool,
}

const LEFT: Side = Side {
    first: 42,
    is_mirrored: true,
};
const RIGHT: Side = Side {
    first: 36,
    is_mirrored: false,
};

/// What both eyes have in common.
struct Face<'a> {
    step: &'a Step<'a>,
    fitted: &'a Fitted<'a>,
    /// Of the head, to the camera.
    rotation: Mat3,
    /// See [`Pose::facing_cosine`].
    facing: f32,
    /// How far it moves while the frame is exposed, at most \[px\].
    blur_px: f32,
    wears_glasses: bool,
}

/// The landmarks of an eye.
struct Outline {
    points: [[f32; 2]; 6],
    /// Their middle.
    at: [f32; 2],
    /// Sum of their visibilities.
    visibility: f32,
    distance_mm: f32,
}

/// Sees both eyes of a face that moves by `blur_px` while the frame is exposed; unknown with a
/// model without the network. What is learnt of the person's glasses is updated; with
/// `natural_gaze`, so is what is always wrong with the gaze, and it is taken off.
#[inline(never)]
pub fn see(
    step: &Step<'_>,
    fitted: &Fitted<'_>,
    blur_px: f32,
    natural_gaze: bool,
    person: &mut PersonsEyes,
    work: &mut Workspace,
) -> Eyes {
    if !step.model.eyes.is_present() {
        return Eyes::EMPTY;
    }
    let pose = Pose {
        // Of the quaternion that is given out, with which both frames of a gaze then agree.
        rotation: rotation_from_quaternion(fitted.fit.state.pose.quaternion()),
        ..fitted.fit.state.pose
    };
    let face = Face {
        step,
        fitted,
        rotation: pose.rotation,
        facing: pose.facing_cosine(),
        blur_px,
        wears_glasses: person.wear_glasses(),
    };
    let mut glasses = GlassesSeen::default();
    let each = [LEFT, RIGHT].map(|side| face.eye(&side, &mut glasses, work));
    let seen = glasses.mean();
    let mut eyes = Eyes {
        each,
        gaze: both(&each, &face.rotation),
        glasses: seen.map(|[probability, _]| probability),
        dark_glasses: seen.map(|[_, dark]| dark),
        ..Eyes::EMPTY
    };
    person.see_glasses(&glasses, step.now_us);
    if natural_gaze {
        person.correct(&mut eyes, &pose, step.now_us);
    }
    eyes.look = look_weights(&eyes.each);
    eyes
}

impl Face<'_> {
    /// Sees one eye, and adds what the network says of glasses.
    #[inline(never)]
    fn eye(&self, side: &Side, glasses: &mut GlassesSeen, work: &mut Workspace) -> Eye {
        let Some(outline) = self.outline(side) else {
            return Eye::EMPTY;
        };
        let seen = self.run(&outline, side, work).and_then(|seen| {
            glasses.add(&seen, outline.has_landmarks());
            self.check(&seen, outline.has_landmarks())?;
            Ok(seen)
        });
        match seen {
            Ok(seen) => self.known(&seen),
            Err(unknown) => Eye::unknown(unknown, outline.at),
        }
    }

    fn outline(&self, side: &Side) -> Option<Outline> {
        let six = side.first..side.first + 6;
        let points = self.fitted.shape().get(six.clone())?.as_array::<6>()?;
        let visibility = self.fitted.confidence().visibility.get(six.clone())?;
        let points_mm = self.fitted.fit.points_mm.get(six)?;
        Some(Outline {
            points: *points,
            at: middle(points),
            visibility: visibility.iter().sum(),
            distance_mm: points_mm.iter().map(|p| p.z).sum::<f32>() / 6.0,
        })
    }

    /// Runs the network on an eye that is near and sharp enough and turned to the camera.
    fn run(
        &self,
        outline: &Outline,
        side: &Side,
        work: &mut Workspace,
    ) -> Result<SeenEye, EyeUnknown> {
        let (frame, camera) = (self.step.frame, &self.step.camera);
        let is_inside = |v: f32, size: i32| (0.0..size as f32).contains(&v);
        let [x, y] = outline.at;
        if self.facing < EYE_MIN_FACING_COSINE {
            return Err(EyeUnknown::Turned);
        }
        if !is_inside(x, frame.width()) || !is_inside(y, frame.height()) {
            return Err(EyeUnknown::Hidden);
        }
        if camera.fx / outline.distance_mm < EYE_MIN_PX_PER_MM {
            return Err(EyeUnknown::Small);
        }
        if self.blur_px > EYE_MAX_BLUR * outline.width_px() {
            return Err(EyeUnknown::Blurred);
        }
        let [undistorted] = camera.undistorted(&[outline.at]);
        let (points, distance_mm) = (&outline.points, outline.distance_mm);
        let place = EyePlace::new(points, undistorted, camera, &self.rotation, distance_mm);
        let network = &self.step.model.eyes;
        place
            .and_then(|place| network.run(frame, &place, side.is_mirrored, work))
            .ok_or(EyeUnknown::Uncertain)
    }

    /// Whether nothing hides an eye that the network has seen.
    fn check(&self, seen: &SeenEye, has_landmarks: bool) -> Result<(), EyeUnknown> {
        if seen.dark >= EYE_DARK {
            return Err(EyeUnknown::DarkGlasses);
        }
        let is_hidden = match has_landmarks {
            true => seen.visible < EYE_VISIBLE,
            false => !self.wears_glasses || seen.glasses.min(seen.visible) < EYE_VISIBLE_AFTER_ALL,
        };
        if seen.glare > EYE_MAX_GLARE || is_hidden && self.wears_glasses {
            return Err(EyeUnknown::Glare);
        }
        match is_hidden {
            true => Err(EyeUnknown::Hidden),
            false => Ok(()),
        }
    }

    /// An eye that is seen; its gaze is unknown where it is shut or uncertain.
    fn known(&self, seen: &SeenEye) -> Eye {
        let sigma_deg = seen.sigma_rad.to_degrees();
        let gaze = if seen.open < GAZE_MIN_OPEN {
            Err(EyeUnknown::Shut)
        } else if sigma_deg > GAZE_MAX_SIGMA_DEG {
            Err(EyeUnknown::Uncertain)
        } else {
            Ok(Gaze {
                camera: seen.gaze.to_array(),
                head: (self.rotation.transpose() * seen.gaze).to_array(),
                sigma_deg,
            })
        };
        Eye {
            open: Ok(seen.open),
            iris: seen.iris,
            gaze,
        }
    }
}

impl Outline {
    fn has_landmarks(&self) -> bool {
        self.visibility >= EYE_MIN_VISIBILITY
    }

    /// Distance of the corners \[px\].
    fn width_px(&self) -> f32 {
        let [outer, _, _, inner, ..] = self.points;
        length([inner[0] - outer[0], inner[1] - outer[1]])
    }
}

fn middle(points: &[[f32; 2]; 6]) -> [f32; 2] {
    let sum = points
        .iter()
        .fold([0.0f32; 2], |sum, p| [sum[0] + p[0], sum[1] + p[1]]);
    sum.map(|v| v / 6.0)
}

/// The gaze of both eyes: their mean, weighted by the inverse of the variances.
fn both(eyes: &[Eye; 2], rotation: &Mat3) -> Result<Gaze, EyeUnknown> {
    let known = || eyes.iter().flat_map(|eye| &eye.gaze);
    let weight = |gaze: &Gaze| 1.0 / (gaze.sigma_deg * gaze.sigma_deg).max(1e-3);
    let sum: Vec3 = known().map(|g| weight(g) * Vec3::from(g.camera)).sum();
    let weights: f32 = known().map(weight).sum();
    if weights <= 0.0 || sum.length_squared() < 1e-12 {
        let [left, right] = eyes.map(|eye| eye.gaze);
        // A shut or hidden eye says more than one that is turned away.
        return match left {
            Err(EyeUnknown::Turned) => right,
            _ => left,
        };
    }
    let camera = sum.normalize();
    // The errors of both eyes have a part in common: that of the pose.
    let single = known().map(|g| g.sigma_deg).fold(f32::MAX, f32::min);
    let mean = libm::sqrtf(1.0 / weights);
    Ok(Gaze {
        camera: camera.to_array(),
        head: (rotation.transpose() * camera).to_array(),
        sigma_deg: GAZE_SHARED * single + (1.0 - GAZE_SHARED) * mean,
    })
}

/// ARKit's weights of the gazes.
fn look_weights(eyes: &[Eye; 2]) -> [f32; EYE_LOOKS] {
    // Angles to the person's left and down.
    let [left, right] = eyes.each_ref().map(|eye| match &eye.gaze {
        Ok(gaze) => gaze_angles(Vec3::from(gaze.head)),
        Err(_) => [0.0; 2],
    });
    let weight = |angle: f32| (angle / EYE_LOOK_RAD).clamp(0.0, 1.0);
    [
        weight(-left[1]),
        weight(-right[1]),
        weight(left[1]),
        weight(right[1]),
        weight(-left[0]),
        weight(right[0]),
        weight(left[0]),
        weight(-right[0]),
    ]
}
