//! How crops of eyes are placed, in renders and in photographs.

use posewise::math::Similarity;

/// Standard deviation of the roll that the tracker errs by \[rad\].
pub const ROLL: f32 = 0.05;

/// A similarity of this logarithm of scale and roll.
pub fn turned(log_scale: f32, roll: f32, [tx, ty]: [f32; 2]) -> Similarity {
    let scale = log_scale.exp();
    Similarity {
        a: scale * roll.cos(),
        b: scale * roll.sin(),
        tx,
        ty,
    }
}
