//! Looks at the eyes of the face that was tracked: lids, glasses, gaze.

use super::eye::{EYE_LOOKS, Eye, EyeUnknown, Eyes, Gaze};
use super::geometry::{gaze_angles, length};
use super::glasses::Lenses;
use super::policy::{
    EYE_DARK, EYE_LOOK_RAD, EYE_MAX_BLUR, EYE_MAX_GLARE, EYE_MIN_FACING_COSINE, EYE_MIN_PX_PER_MM,
    EYE_MIN_VISIBILITY, EYE_VISIBLE, EYE_VISIBLE_AFTER_ALL, GAZE_MAX_SIGMA_DEG, GAZE_MIN_OPEN,
    GAZE_SHARED, NATURAL_GAZE_FACING_COSINE,
};
use super::step::Step;
use super::{State, Tracker};
use crate::align::{EyeModel, EyePlace, SeenEye};
use crate::image::Frame;
use crate::math::rotation_from_quaternion;
use crate::shape::{Intrinsics, Pose};
use glam::{Mat3, Vec3};

/// First landmark of the person's left and right eye.
const FIRST: [usize; 2] = [42, 36];

/// What the network is run with.
struct Look<'a> {
    model: &'a EyeModel<'a>,
    frame: &'a Frame<'a>,
    camera: Intrinsics,
    rotation: Mat3,
    /// See [`Pose::facing_cosine`].
    facing: f32,
    now_us: i64,
}

impl Tracker {
    /// Looks at the eyes of the face that this step tracks, if the settings say so; in another
    /// state, and with a model without the network, they are unknown.
    pub(super) fn look(&mut self, step: &Step<'_>) {
        if self.config.gaze {
            self.look_at_eyes(step);
        }
    }

    #[inline(never)]
    fn look_at_eyes(&mut self, step: &Step<'_>) {
        let mut eyes = Eyes::EMPTY;
        let model = &step.model.eyes;
        if self.result.state != State::Tracking || !model.is_present() {
            self.result.eyes = eyes;
            return;
        }
        let pose = Pose {
            rotation: rotation_from_quaternion(self.result.rotation),
            translation_mm: self.result.translation_mm.into(),
        };
        let look = Look {
            model,
            frame: step.frame,
            camera: step.camera(&self.config),
            rotation: pose.rotation,
            facing: pose.facing_cosine(),
            now_us: step.now_us,
        };
        let mut lenses = Lenses::default();
        for ((eye, first), mirror) in eyes.each.iter_mut().zip(FIRST).zip([true, false]) {
            *eye = self.eye(&look, (first, mirror), &mut lenses);
            let camera = Vec3::from(eye.gaze.camera);
            eye.gaze.head = (look.rotation.transpose() * camera).to_array();
        }
        [eyes.glasses, eyes.dark_glasses] = lenses.mean().unwrap_or([-1.0; 2]);
        if let Some(glasses) = lenses.before_visible() {
            self.target.glasses.see(glasses, look.now_us);
        }
        eyes.gaze = both(&eyes.each, &look.rotation);
        if self.config.natural_gaze {
            self.correct_gaze(&mut eyes, &look);
        }
        eyes.look = looks(&eyes.each);
        self.result.eyes = eyes;
    }

    /// Learns from the gaze of both eyes, and takes off what is always wrong with it.
    #[inline(never)]
    fn correct_gaze(&mut self, eyes: &mut Eyes, look: &Look<'_>) {
        let natural = &mut self.target.natural_gaze;
        let is_known = |gaze: &&mut Gaze| gaze.unknown == EyeUnknown::Known;
        let faces = look.facing >= NATURAL_GAZE_FACING_COSINE;
        if faces && eyes.gaze.unknown == EyeUnknown::Known {
            natural.see(gaze_angles(Vec3::from(eyes.gaze.head)), look.now_us);
        }
        let [left, right] = &mut eyes.each;
        let gazes = [&mut left.gaze, &mut right.gaze, &mut eyes.gaze];
        for gaze in gazes.into_iter().filter(is_known) {
            natural.correct(gaze, &look.rotation);
        }
    }

    /// Looks at the eye whose first landmark is given, and adds what it says of glasses.
    #[inline(never)]
    fn eye(&mut self, look: &Look<'_>, (first, mirror): (usize, bool), lenses: &mut Lenses) -> Eye {
        let six = self.result.landmarks.get(first..first + 6);
        let points_mm = self.result.points_mm.get(first..first + 6);
        let Some((six, points_mm)) = six.and_then(|s| s.as_array::<6>()).zip(points_mm) else {
            return Eye::EMPTY;
        };
        let visibility: f32 = six.iter().map(|l| l.visibility).sum();
        let six = six.map(|l| [l.x, l.y]);
        let unseen = |unknown| Eye::unknown(unknown, middle(&six));
        let at = middle(&six);
        let inside = |v: f32, size: i32| (0.0..size as f32).contains(&v);
        let [outer, _, _, inner, ..] = six;
        let width_px = length([inner[0] - outer[0], inner[1] - outer[1]]);
        let distance_mm = points_mm.iter().map(|[_, _, z]| z).sum::<f32>() / 6.0;
        if look.facing < EYE_MIN_FACING_COSINE {
            return unseen(EyeUnknown::Turned);
        }
        if !inside(at[0], look.frame.width()) || !inside(at[1], look.frame.height()) {
            return unseen(EyeUnknown::Hidden);
        }
        if look.camera.fx / distance_mm < EYE_MIN_PX_PER_MM {
            return unseen(EyeUnknown::Small);
        }
        if self.target.motion.blur_px() > EYE_MAX_BLUR * width_px {
            return unseen(EyeUnknown::Blurred);
        }
        let [undistorted] = look.camera.undistorted(&[at]);
        let place = EyePlace::new(&six, undistorted, &look.camera, &look.rotation, distance_mm);
        let seen =
            place.and_then(|place| look.model.run(look.frame, &place, mirror, &mut self.work));
        let Some(seen) = seen else {
            return unseen(EyeUnknown::Uncertain);
        };
        let has_landmarks = visibility >= EYE_MIN_VISIBILITY;
        lenses.add(&seen, has_landmarks);
        if seen.dark >= EYE_DARK {
            return unseen(EyeUnknown::DarkGlasses);
        }
        let wears_glasses = self.target.glasses.are_worn();
        let is_hidden = match has_landmarks {
            true => seen.visible < EYE_VISIBLE,
            false => !wears_glasses || seen.glasses.min(seen.visible) < EYE_VISIBLE_AFTER_ALL,
        };
        if seen.glare > EYE_MAX_GLARE || is_hidden && wears_glasses {
            return unseen(EyeUnknown::Glare);
        }
        match is_hidden {
            true => unseen(EyeUnknown::Hidden),
            false => eye_of(&seen),
        }
    }
}

fn middle(points: &[[f32; 2]; 6]) -> [f32; 2] {
    let sum = points
        .iter()
        .fold([0.0f32; 2], |sum, p| [sum[0] + p[0], sum[1] + p[1]]);
    sum.map(|v| v / 6.0)
}

/// An eye that is seen.
fn eye_of(seen: &SeenEye) -> Eye {
    let sigma_deg = seen.sigma_rad.to_degrees();
    let unknown = if seen.open < GAZE_MIN_OPEN {
        EyeUnknown::Shut
    } else if sigma_deg > GAZE_MAX_SIGMA_DEG {
        EyeUnknown::Uncertain
    } else {
        EyeUnknown::Known
    };
    let gaze = match unknown {
        EyeUnknown::Known => Gaze {
            unknown,
            camera: seen.gaze.to_array(),
            sigma_deg,
            ..Gaze::EMPTY
        },
        _ => Gaze {
            unknown,
            ..Gaze::EMPTY
        },
    };
    Eye {
        unknown: EyeUnknown::Known,
        open: seen.open,
        iris: seen.iris,
        gaze,
    }
}

/// The gaze of both eyes: their mean, weighted by the inverse of the variances.
fn both(eyes: &[Eye; 2], rotation: &Mat3) -> Gaze {
    let known = || (eyes.iter().map(|eye| &eye.gaze)).filter(|g| g.unknown == EyeUnknown::Known);
    let weight = |gaze: &Gaze| 1.0 / (gaze.sigma_deg * gaze.sigma_deg).max(1e-3);
    let sum: Vec3 = known().map(|g| weight(g) * Vec3::from(g.camera)).sum();
    let weights: f32 = known().map(weight).sum();
    if weights <= 0.0 || sum.length_squared() < 1e-12 {
        let [left, right] = eyes;
        let unknown = left.gaze.unknown;
        return Gaze {
            // A shut or hidden eye says more than one that is turned away.
            unknown: match unknown {
                EyeUnknown::Turned => right.gaze.unknown,
                _ => unknown,
            },
            ..Gaze::EMPTY
        };
    }
    let camera = sum.normalize();
    // The errors of both eyes have a part in common: that of the pose.
    let single = known().map(|g| g.sigma_deg).fold(f32::MAX, f32::min);
    let mean = libm::sqrtf(1.0 / weights);
    Gaze {
        unknown: EyeUnknown::Known,
        camera: camera.to_array(),
        head: (rotation.transpose() * camera).to_array(),
        sigma_deg: GAZE_SHARED * single + (1.0 - GAZE_SHARED) * mean,
    }
}

/// ARKit's weights of the gazes.
fn looks(eyes: &[Eye; 2]) -> [f32; EYE_LOOKS] {
    // Angles to the subject's left and down.
    let [left, right] = eyes.each_ref().map(|eye| match eye.gaze.unknown {
        EyeUnknown::Known => gaze_angles(Vec3::from(eye.gaze.head)),
        _ => [0.0; 2],
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
