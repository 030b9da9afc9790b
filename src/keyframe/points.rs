//! Keypoints: where a small spot is brighter or darker than what surrounds it.

use super::picture::{HEIGHT, Picture, WIDTH};

/// Half the side of the spot \[px\].
const INNER: usize = 1;
/// Half the side of its surroundings \[px\].
const OUTER: usize = 4;
/// A keypoint is the extreme among so many neighbours to each side.
const REACH: usize = 3;
/// Least difference between spot and surroundings \[1/81 grey level\].
const LEAST: i16 = 81 * 3;
/// Side of a cell \[px\] …
const CELL: usize = 16;
/// … and the most keypoints in it.
const PER_CELL: usize = 2;
const CELLS: usize = WIDTH.div_ceil(CELL);

/// Most keypoints of a picture.
pub const KEYPOINTS_MAX: usize = CELLS * HEIGHT.div_ceil(CELL) * PER_CELL;

/// A spot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Keypoint {
    /// Pixel.
    pub x: u16,
    /// Pixel.
    pub y: u16,
    /// How much brighter it is than its surroundings \[1/81 grey level\]; never 0.
    pub strength: i16,
}

impl Keypoint {
    /// Whether it is a dark spot.
    pub fn dark(&self) -> bool {
        self.strength < 0
    }
}

type Row = [i16; WIDTH];

/// Tells the keypoints of a picture, the strongest [`PER_CELL`] of each cell: at most
/// [`KEYPOINTS_MAX`]. The work is that of some twenty additions per pixel.
#[inline(never)]
pub fn keypoints(picture: &Picture<'_>, mut each: impl FnMut(Keypoint)) {
    let (width, height) = (picture.width(), picture.height());
    if width <= 2 * OUTER + 2 * REACH || height <= 2 * OUTER + 2 * REACH {
        return;
    }
    // Sums over the columns of both squares around the row.
    let (mut inner, mut outer) = ([0i32; WIDTH], [0i32; WIDTH]);
    for y in 0..2 * OUTER {
        add(&mut outer, picture.row(y), 1);
    }
    for y in OUTER - INNER..OUTER + INNER {
        add(&mut inner, picture.row(y), 1);
    }
    let mut rows: [Row; 2 * REACH + 1] = [[0; WIDTH]; 2 * REACH + 1];
    let mut band = [[Keypoint::default(); PER_CELL]; CELLS];
    for (count, y) in (OUTER..height - OUTER).enumerate() {
        add(&mut outer, picture.row(y + OUTER), 1);
        add(&mut inner, picture.row(y + INNER), 1);
        rows.rotate_left(1);
        if let Some(row) = rows.last_mut() {
            differences(&inner, &outer, width, row);
        }
        add(&mut outer, picture.row(y - OUTER), -1);
        add(&mut inner, picture.row(y - INNER), -1);
        if count < 2 * REACH {
            continue;
        }
        // The row in the middle of those seven.
        let middle = y - REACH;
        extremes(&rows, width, middle, &mut band);
        if middle.is_multiple_of(CELL) || y + 1 == height - OUTER {
            let found = band.iter().flatten().filter(|k| k.strength != 0);
            found.for_each(|k| each(*k));
            band = Default::default();
        }
    }
}

fn add(sums: &mut [i32; WIDTH], row: &[u8], sign: i32) {
    for (sum, v) in sums.iter_mut().zip(row) {
        *sum += sign * *v as i32;
    }
}

/// Spot less surroundings along a row, 0 where the squares leave the picture.
fn differences(inner: &[i32; WIDTH], outer: &[i32; WIDTH], width: usize, row: &mut Row) {
    let (mut inner_before, mut outer_before) = ([0i32; WIDTH + 1], [0i32; WIDTH + 1]);
    let (mut a, mut b) = (0, 0);
    let before = inner_before.iter_mut().zip(&mut outer_before).skip(1);
    for ((sum_a, sum_b), (i, o)) in before.zip(inner.iter().zip(outer)) {
        a += i;
        b += o;
        (*sum_a, *sum_b) = (a, b);
    }
    row.fill(0);
    let lows = inner_before.iter().skip(OUTER - INNER).zip(&outer_before);
    let highs = inner_before.iter().skip(OUTER + INNER + 1);
    let highs = highs.zip(outer_before.iter().skip(2 * OUTER + 1));
    let out = row.iter_mut().skip(OUTER).take(width - 2 * OUTER);
    for (out, ((i0, o0), (i1, o1))) in out.zip(lows.zip(highs)) {
        *out = (9 * (i1 - i0) - (o1 - o0)) as i16;
    }
}

/// Puts the extremes of the middle row into its cells.
fn extremes(
    rows: &[Row; 2 * REACH + 1],
    width: usize,
    y: usize,
    band: &mut [[Keypoint; PER_CELL]; CELLS],
) {
    let Some(middle) = rows.get(REACH) else {
        return;
    };
    let inside = middle.iter().enumerate().take(width - OUTER - REACH);
    for (x, value) in inside.skip(OUTER + REACH) {
        let value = *value;
        if value.unsigned_abs() < LEAST as u16 {
            continue;
        }
        // As large as the one beside it is not an extreme, except to the right and below.
        let beaten = rows.iter().enumerate().any(|(j, row)| {
            let near = row.get(x - REACH..x + REACH + 1).unwrap_or(&[]);
            near.iter().enumerate().any(|(i, other)| {
                let earlier = (j, i) < (REACH, REACH);
                match value > 0 {
                    true => *other > value || earlier && *other == value,
                    false => *other < value || earlier && *other == value,
                }
            })
        });
        if beaten {
            continue;
        }
        let found = Keypoint {
            x: x as u16,
            y: y as u16,
            strength: value,
        };
        let Some(cell) = band.get_mut(x / CELL) else {
            continue;
        };
        let weakest = cell.iter_mut().min_by_key(|k| k.strength.unsigned_abs());
        if let Some(weakest) = weakest
            && weakest.strength.unsigned_abs() < value.unsigned_abs()
        {
            *weakest = found;
        }
    }
}
