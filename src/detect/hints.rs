//! Where the next finer level should look first.
//!
//! A coarse level gives a face that is too small for it a higher score than what surrounds it, far
//! below a hit's. A finer level evaluates the tiles in the order of these scores, in a few passes,
//! so that a small face in a large frame comes early in the scan.

/// Cells along each side of the frame.
const SIDE: usize = 24;
const CELLS: usize = SIDE * SIDE;

/// Passes over a level's tiles.
pub(super) const PASSES: u8 = 8;
/// Cells that belong to the first pass, to the first two and so on. Half of the faces come in the
/// first twentieth of the tiles, so the first passes are short.
const SHARES: [usize; PASSES as usize - 1] = [
    CELLS / 64,
    CELLS / 32,
    CELLS / 16,
    CELLS / 8,
    CELLS / 4,
    3 * CELLS / 8,
    CELLS / 2,
];

/// The best score of each cell of the frame at one level.
#[derive(Clone, Debug)]
pub(super) struct Scores {
    cells: [u8; CELLS],
}

/// Which pass each cell of the frame belongs to.
#[derive(Clone, Debug)]
pub(super) struct Order {
    /// Four bits a cell.
    passes: [u8; CELLS / 2],
}

impl Scores {
    pub const NONE: Scores = Scores { cells: [0; CELLS] };

    /// Adds a score at a place \[shares of the frame's width and height, 0..1\].
    pub fn add(&mut self, place: [f32; 2], score: u8) {
        let [x, y] = place.map(cell);
        if let Some(best) = self.cells.get_mut(y * SIDE + x) {
            *best = score.max(*best);
        }
    }

    /// The best score when the best `cells` are left out. Sorting could panic.
    fn after(&self, cells: usize) -> u8 {
        let mut at_score = [0u16; 256];
        for score in self.cells {
            if let Some(count) = at_score.get_mut(usize::from(score)) {
                *count += 1;
            }
        }
        let mut above = 0;
        let score = at_score.iter().rposition(|count| {
            above += usize::from(*count);
            above > cells
        });
        score.unwrap_or(0) as u8
    }
}

impl Order {
    /// One pass over everything.
    pub const NONE: Order = Order {
        passes: [0; CELLS / 2],
    };

    /// By the scores of a level.
    pub fn new(scores: &Scores) -> Order {
        let least = SHARES.map(|share| scores.after(share));
        let pass = |score: &u8| least.iter().filter(|least| score < *least).count() as u8;
        let mut order = Order::NONE;
        for (two, scores) in order.passes.iter_mut().zip(scores.cells.chunks_exact(2)) {
            *two = (scores.iter().rev()).fold(0, |bits, score| bits << 4 | pass(score));
        }
        order
    }

    /// The first pass of a cell between two places \[shares of the frame's width and height\].
    pub fn pass(&self, low: [f32; 2], high: [f32; 2]) -> u8 {
        let ([left, top], [right, bottom]) = (low.map(cell), high.map(cell));
        let cells = (top..=bottom).flat_map(|y| (left..=right).map(move |x| y * SIDE + x));
        let pass = |cell: usize| {
            let two = self.passes.get(cell / 2).copied().unwrap_or(0);
            two >> (4 * (cell % 2)) & 15
        };
        cells.map(pass).min().unwrap_or(0)
    }
}

fn cell(place: f32) -> usize {
    ((place * SIDE as f32) as usize).min(SIDE - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn high_scores_come_first() {
        let mut scores = Scores::NONE;
        for k in 0..CELLS {
            let place = [k % SIDE, k / SIDE].map(|i| (i as f32 + 0.5) / SIDE as f32);
            scores.add(place, (k / 4) as u8);
        }
        scores.add([0.03, 0.03], 255);
        let order = Order::new(&scores);
        let pass = |x: f32, y: f32| order.pass([x, y], [x, y]);
        assert_eq!([0.9, 0.2].map(|x| pass(x, 0.99)), [0, 1]);
        let later = [0.94, 0.9, 0.8, 0.65, 0.55, 0.1];
        assert_eq!(later.map(|y| pass(0.9, y)), [2, 3, 4, 5, 6, 7]);
        assert_eq!(pass(0.01, 0.01), 0);
        assert_eq!(order.pass([0.5, 0.6], [0.9, 0.99]), 0);
        assert_eq!(Order::NONE.pass([0.0; 2], [1.0; 2]), 0);
    }
}
