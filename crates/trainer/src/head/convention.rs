//! Where landmarks of the 68-point convention (Sagonas et al., "300 Faces in-the-Wild Challenge",
//! 2013) lie that the kit puts elsewhere. Its points are at even distances on the skin; people
//! place them in pictures, mostly seen from the front.

use super::morphable::Head;
use posewise::shape::{LANDMARKS, MIRROR};

/// Changes whenever a point is put elsewhere: what was made with the old place is then made anew.
pub const CONVENTION_VERSION: u32 = 2;

/// From the middle of the upper lip to a peak of its bow \[mm\].
const BOW_MM: f32 = 5.2;

/// From the kit's tip of the nose down to the point that stands out furthest \[mm\].
const TIP_MM: f32 = 2.1;
/// From the kit's points under the nose up to its edge \[mm\]: in the middle to where the underside
/// turns down into the lip, outside to the crease below the wing.
const UNDER_NOSE_MM: f32 = 1.2;
const UNDER_WING_MM: f32 = 1.8;

/// Lines that points slide along: downwards, and of the image's left side from outside to the
/// middle.
const BRIDGE: [usize; 4] = [27, 28, 29, 30];
const BROW: [usize; 5] = [17, 18, 19, 20, 21];
const UPPER_LID: [usize; 4] = [36, 37, 38, 39];
const LOWER_LID: [usize; 4] = [36, 41, 40, 39];
const UPPER_LIP: [usize; 4] = [48, 49, 50, 51];
const LOWER_LIP: [usize; 4] = [48, 59, 58, 57];
const UPPER_INNER: [usize; 3] = [60, 61, 62];
const LOWER_INNER: [usize; 3] = [60, 67, 66];

impl Head {
    /// From each landmark's vertex to where the convention has it \[mm, head frame\]: evenly as
    /// [`conventional_mm`] says, the tip of the nose where it stands out furthest, the points under
    /// the nose on its edge. The others stay.
    pub fn conventional_offsets_mm(&self) -> Vec<[f32; 3]> {
        let points = self.landmarks.map(|v| self.mean[v as usize]);
        let mut offsets = conventional_mm(&points, TIP_MM);
        offsets[30][1] += TIP_MM;
        let between = 0.5 * (UNDER_WING_MM + UNDER_NOSE_MM);
        let up = [
            UNDER_WING_MM,
            between,
            UNDER_NOSE_MM,
            between,
            UNDER_WING_MM,
        ];
        for (offset, up) in offsets[31..36].iter_mut().zip(up) {
            offset[1] -= up;
        }
        offsets
    }
}

/// From landmarks of a head to where the convention has them \[mm, head frame\]: brows, bridge of
/// the nose, lids and lower lip evenly in the frontal view; the peaks of the bow as far apart as
/// people's, and half way between them and the corners; the inner points of the lips in line with
/// the outer ones above and below. The others stay. The tip of the nose is `tip_mm` below its
/// landmark.
pub fn conventional_mm(points: &[[f32; 3]; LANDMARKS], tip_mm: f32) -> Vec<[f32; 3]> {
    let at = |i: usize| points[i];
    let mut moved = *points;
    let x = |i: usize| at(i)[0];
    let between = |from: f32, to: f32, share: f32| from + share * (to - from);
    let middle = x(51);
    let bow = middle - BOW_MM;
    for (landmark, share) in [(28, 1.0 / 3.0), (29, 2.0 / 3.0)] {
        let even = between(at(27)[1], at(30)[1] + tip_mm, share);
        moved[landmark] = slid(&BRIDGE.map(at), 1, even);
    }
    for (k, &landmark) in BROW.iter().enumerate() {
        let even = between(x(17), x(21), k as f32 / 4.0);
        moved[landmark] = slid(&BROW.map(at), 0, even);
    }
    for (line, points) in [(UPPER_LID, [37, 38]), (LOWER_LID, [41, 40])] {
        for (landmark, share) in points.into_iter().zip([1.0 / 3.0, 2.0 / 3.0]) {
            moved[landmark] = slid(&line.map(at), 0, between(x(36), x(39), share));
        }
    }
    moved[50] = slid(&UPPER_LIP.map(at), 0, bow);
    moved[49] = slid(&UPPER_LIP.map(at), 0, between(x(48), bow, 0.5));
    moved[59] = slid(&LOWER_LIP.map(at), 0, between(x(48), middle, 1.0 / 3.0));
    moved[58] = slid(&LOWER_LIP.map(at), 0, between(x(48), middle, 2.0 / 3.0));
    // Where the line from the one to the other crosses the lips' own.
    let share = (at(61)[1] - moved[50][1]) / (moved[58][1] - moved[50][1]);
    let column = between(moved[50][0], moved[58][0], share);
    moved[61] = slid(&UPPER_INNER.map(at), 0, column);
    moved[67] = slid(&LOWER_INNER.map(at), 0, column);
    let offset = |i: usize| -> [f32; 3] { std::array::from_fn(|k| moved[i][k] - at(i)[k]) };
    (0..LANDMARKS)
        .map(|i| match x(i) > middle {
            true => mirrored(offset(MIRROR[i])),
            false => offset(i),
        })
        .collect()
}

fn mirrored([x, y, z]: [f32; 3]) -> [f32; 3] {
    [-x, y, z]
}

/// The point of a line, along which a coordinate rises, where that has a value.
fn slid(line: &[[f32; 3]], axis: usize, value: f32) -> [f32; 3] {
    let last = line.len() - 2;
    let beyond = |k: &usize| value <= line[k + 1][axis];
    let k = (0..last).find(beyond).unwrap_or(last);
    let (a, b) = (line[k], line[k + 1]);
    let share = ((value - a[axis]) / (b[axis] - a[axis])).clamp(0.0, 1.0);
    std::array::from_fn(|i| a[i] + share * (b[i] - a[i]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_slides_along_its_line() {
        let line = [[0.0, 0.0, 0.0], [2.0, 2.0, 1.0], [4.0, 0.0, 1.0]];
        assert_eq!(slid(&line, 0, 0.0), [0.0; 3]);
        assert_eq!(slid(&line, 0, 1.0), [1.0, 1.0, 0.5]);
        assert_eq!(slid(&line, 0, 3.0), [3.0, 1.0, 1.0]);
        assert_eq!(slid(&line, 0, 5.0), [4.0, 0.0, 1.0]);
    }
}
