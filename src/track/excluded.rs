//! Faces that other trackers follow: this one neither finds nor follows them.

use super::MAX_EXCLUDED;
use super::policy::SAME_FACE;

/// Range of the longer side of a box, and largest coordinate \[px\], as for hints.
const SIDE_PX: core::ops::RangeInclusive<f32> = 1.0..=32_768.0;
const FARTHEST_PX: f32 = 65_536.0;

/// A box by its centre \[px\].
#[derive(Clone, Copy)]
struct Place {
    x: f32,
    y: f32,
    /// Longer side.
    size: f32,
}

/// The boxes that a tracker excludes.
#[derive(Clone)]
pub(super) struct Excluded {
    places: heapless::Vec<Place, MAX_EXCLUDED>,
}

impl Excluded {
    pub(super) const NONE: Excluded = Excluded {
        places: heapless::Vec::new(),
    };

    /// Of boxes left, top, width, height \[px\]; `None` where there are too many, or a number is
    /// out of range.
    pub(super) fn new(boxes: &[[f32; 4]]) -> Option<Excluded> {
        let mut excluded = Excluded::NONE;
        for face_box in boxes {
            excluded.places.push(place(face_box)?).ok()?;
        }
        Some(excluded)
    }

    /// Whether a face with this centre is one of them.
    pub(super) fn contains(&self, [x, y]: [f32; 2]) -> bool {
        let near = |p: &Place| libm::hypotf(x - p.x, y - p.y) < SAME_FACE * p.size;
        self.places.iter().any(near)
    }
}

fn place(&[x, y, width, height]: &[f32; 4]) -> Option<Place> {
    let size = width.max(height);
    let is_valid = SIDE_PX.contains(&size)
        && width > 0.0
        && height > 0.0
        && x.abs() <= FARTHEST_PX
        && y.abs() <= FARTHEST_PX;
    is_valid.then_some(Place {
        x: x + width / 2.0,
        y: y + height / 2.0,
        size,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_face_is_excluded_near_the_centre_of_a_box() {
        let excluded = Excluded::new(&[[100.0, 100.0, 80.0, 100.0]]).unwrap();
        assert!(excluded.contains([140.0, 150.0]) && excluded.contains([170.0, 170.0]));
        assert!(!excluded.contains([181.0, 150.0]));
        assert!(!Excluded::NONE.contains([0.0, 0.0]));
    }

    #[test]
    fn boxes_out_of_range_are_rejected() {
        let good = [0.0, 0.0, 50.0, 50.0];
        assert!(Excluded::new(&[good; MAX_EXCLUDED]).is_some());
        assert!(Excluded::new(&[good; MAX_EXCLUDED + 1]).is_none());
        for bad in [f32::NAN, f32::INFINITY, 1e9, -1e9] {
            for k in 0..4 {
                let mut face_box = good;
                face_box[k] = bad;
                assert!(Excluded::new(&[good, face_box]).is_none(), "{face_box:?}");
            }
        }
    }
}
