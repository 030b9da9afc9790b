//! Keypoints: spots that are brighter or darker than their surroundings.
//!
//! The response is the difference of two box filters, a fast stand-in for the difference of
//! Gaussians (as in Agrawal et al., "CenSurE", 2008). Keypoints are its local extremes.

use super::reduced_image::{ReducedImage, WIDTH};

/// Half width of the spot \[px\].
const INNER: usize = 1;
/// Half width of its surroundings \[px\].
const OUTER: usize = 4;
/// A keypoint is the extreme of its neighbourhood up to this distance along each axis \[px\].
const REACH: usize = 3;
/// Least absolute response \[1/81 grey level\]: 3 grey levels.
const RESPONSE_MIN: i16 = 81 * 3;
/// Side of a cell \[px\] …
const CELL: usize = 16;
/// … and the most keypoints in it, which spreads them over the image.
const PER_CELL: usize = 2;
const CELLS: usize = WIDTH.div_ceil(CELL);

/// A spot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Keypoint {
    /// \[px of the reduced image\].
    pub x: u16,
    /// \[px of the reduced image\].
    pub y: u16,
    /// Mean luma of the spot less that of its surroundings \[1/81 grey level\]; never 0.
    pub response: i16,
}

impl Keypoint {
    /// Whether it is darker than its surroundings.
    pub fn is_dark(&self) -> bool {
        self.response < 0
    }
}

type Row = [i16; WIDTH];

/// Keypoints of one row of cells.
type CellRow = [heapless::Vec<Keypoint, PER_CELL, u8>; CELLS];

/// Calls `report` with the keypoints of an image, those with the strongest responses of each cell:
/// at most [`PER_CELL`] in each cell. The work is some twenty additions per pixel.
#[inline(never)]
pub fn keypoints(image: &ReducedImage<'_>, mut report: impl FnMut(Keypoint)) {
    let (width, height) = (image.width(), image.height());
    if width <= 2 * OUTER + 2 * REACH || height <= 2 * OUTER + 2 * REACH {
        return;
    }
    // Column sums over the height of both boxes.
    let (mut inner, mut outer) = ([0i32; WIDTH], [0i32; WIDTH]);
    for y in 0..2 * OUTER {
        add_row(&mut outer, image.row(y), 1);
    }
    for y in OUTER - INNER..OUTER + INNER {
        add_row(&mut inner, image.row(y), 1);
    }
    let mut rows: [Row; 2 * REACH + 1] = [[0; WIDTH]; 2 * REACH + 1];
    let mut cells: CellRow = [const { heapless::Vec::new() }; CELLS];
    for (count, y) in (OUTER..height - OUTER).enumerate() {
        add_row(&mut outer, image.row(y + OUTER), 1);
        add_row(&mut inner, image.row(y + INNER), 1);
        rows.rotate_left(1);
        if let Some(row) = rows.last_mut() {
            responses(&inner, &outer, width, row);
        }
        add_row(&mut outer, image.row(y - OUTER), -1);
        add_row(&mut inner, image.row(y - INNER), -1);
        if count < 2 * REACH {
            continue;
        }
        // The middle one of the rows at hand.
        let middle = y - REACH;
        extremes(&rows, width, middle, &mut cells);
        if middle.is_multiple_of(CELL) || y + 1 == height - OUTER {
            for cell in &mut cells {
                cell.iter().for_each(|k| report(*k));
                cell.clear();
            }
        }
    }
}

fn add_row(sums: &mut [i32; WIDTH], row: &[u8], sign: i32) {
    for (sum, v) in sums.iter_mut().zip(row) {
        *sum += sign * *v as i32;
    }
}

/// Responses along a row; 0 where the boxes leave the image.
fn responses(inner: &[i32; WIDTH], outer: &[i32; WIDTH], width: usize, row: &mut Row) {
    // Prefix sums of the columns.
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
        // 9 pixels of spot against the 81 that include them.
        *out = (9 * (i1 - i0) - (o1 - o0)) as i16;
    }
}

/// Adds the extremes of the middle row to its cells.
fn extremes(rows: &[Row; 2 * REACH + 1], width: usize, y: usize, cells: &mut CellRow) {
    let peaks = peaks(rows);
    let (first, end) = (OUTER + REACH, width - OUTER - REACH);
    // Few are peaks.
    for (block, flags) in peaks.as_chunks::<PEAKS>().0.iter().enumerate() {
        if flags.iter().fold(0, |all, flag| all | flag) == 0 {
            continue;
        }
        for (k, flag) in flags.iter().enumerate() {
            let x = block * PEAKS + k;
            let response = rows.get(REACH).and_then(|row| row.get(x)).copied();
            let response = response.unwrap_or(0);
            if *flag == 0 || x < first || x >= end || !is_extreme(rows, x, response) {
                continue;
            }
            let keypoint = Keypoint {
                x: x as u16,
                y: y as u16,
                response,
            };
            if let Some(cell) = cells.get_mut(x / CELL) {
                add_to_cell(cell, keypoint);
            }
        }
    }
}

/// Flags that are looked at together.
const PEAKS: usize = 16;
const _: () = assert!(WIDTH.is_multiple_of(PEAKS));

/// Which responses of the middle row are strong, and weaker than none of the four beside them; 0
/// elsewhere. Computed in vectors.
#[inline(never)]
fn peaks(rows: &[Row; 2 * REACH + 1]) -> [u8; WIDTH] {
    let mut peaks = [0u8; WIDTH];
    let [_, _, above, here, below, _, _] = rows;
    let beside = here.iter().zip(here.iter().skip(2));
    let vertical = above.iter().skip(1).zip(below.iter().skip(1));
    let middle = here.iter().skip(1).zip(beside).zip(vertical);
    for (peak, ((response, (left, right)), (above, below))) in peaks.iter_mut().skip(1).zip(middle)
    {
        let most = (*left).max(*right).max(*above).max(*below);
        let least = (*left).min(*right).min(*above).min(*below);
        let is_bright = *response >= RESPONSE_MIN && *response >= most;
        let is_dark = *response <= -RESPONSE_MIN && *response <= least;
        *peak = u8::from(is_bright | is_dark);
    }
    peaks
}

/// Whether no response in the neighbourhood of column `x` of the middle row is stronger. Of equal
/// responses the first, row by row, is the extreme.
fn is_extreme(rows: &[Row; 2 * REACH + 1], x: usize, response: i16) -> bool {
    !rows.iter().enumerate().any(|(j, row)| {
        let near = row.get(x - REACH..x + REACH + 1).unwrap_or(&[]);
        near.iter().enumerate().any(|(i, other)| {
            let earlier = (j, i) < (REACH, REACH);
            match response > 0 {
                true => *other > response || earlier && *other == response,
                false => *other < response || earlier && *other == response,
            }
        })
    })
}

/// Keeps the strongest keypoints of a cell.
fn add_to_cell(cell: &mut heapless::Vec<Keypoint, PER_CELL, u8>, keypoint: Keypoint) {
    let strength = |k: &Keypoint| k.response.unsigned_abs();
    if cell.push(keypoint).is_err()
        && let Some(weakest) = cell.iter_mut().min_by_key(|k| strength(k))
        && strength(weakest) < strength(&keypoint)
    {
        *weakest = keypoint;
    }
}
