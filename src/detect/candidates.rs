//! Candidates of a scan: hits of the network's cells, merged.

use super::Detection;

/// Most candidates kept at once; a new one then replaces the one of the lowest score.
const CANDIDATES_MAX: usize = 24;
/// Most hits of a tile; a new one then replaces the one of the lowest score.
const HITS_MAX: usize = 32;

/// Hits of one face are nearer than this \[of the larger size\] …
const SAME_DISTANCE: f32 = 0.2;
/// … and their sizes differ by less than this factor. Both are as the tiles were trained: cells
/// within a fifth of the size are to report the face.
const SAME_RATIO: f32 = 1.4;
/// A reported candidate is seen again only where the sizes differ by less than this factor. A face
/// that is too small for a level is reported there at the level's least size, up to 1.5 times its
/// own, and its attempt fails. The next level sees its own size, which is then attempted too.
const REPORTED_RATIO: f32 = 1.2;
/// A hit that is this near to a better one \[of the larger size\], and within this factor of its
/// size, is no second face: faces do not overlap by more than a half.
const COMPETING_DISTANCE: f32 = 0.5;
const COMPETING_RATIO: f32 = 2.5;
/// A reported candidate is reported again where a later tile sees it with so much more of a score
/// \[logit\]: the tile before held a part of it.
const BETTER_SCORE: f32 = 1.0;

#[derive(Clone, Copy, Debug)]
struct Candidate {
    face: Detection,
    reported: bool,
    /// Whether a tile of its own has shown it.
    seen: bool,
}

/// Hits of a tile.
pub(super) struct Hits {
    list: heapless::Vec<Detection, HITS_MAX>,
}

/// The candidates of all tiles of a scan so far.
#[derive(Clone, Debug)]
pub(super) struct Candidates {
    list: heapless::Vec<Candidate, CANDIDATES_MAX>,
}

/// Whether centres lie within `distance` of the larger size and sizes within a factor of `ratio`.
fn overlaps(a: &Detection, b: &Detection, distance: f32, ratio: f32) -> bool {
    let (small, large) = (a.size.min(b.size), a.size.max(b.size));
    let (dx, dy) = (a.x - b.x, a.y - b.y);
    dx * dx + dy * dy < distance * distance * large * large && large < small * ratio
}

impl Hits {
    /// No hit yet.
    pub const EMPTY: Hits = Hits {
        list: heapless::Vec::new(),
    };

    /// Adds a hit.
    pub fn add(&mut self, hit: &Detection) {
        if let Err(hit) = self.list.push(*hit) {
            let lowest = (self.list.iter_mut()).min_by(|a, b| a.score.total_cmp(&b.score));
            if let Some(lowest) = lowest.filter(|lowest| lowest.score < hit.score) {
                *lowest = hit;
            }
        }
    }

    /// Takes the best face and the hits that compete with it.
    pub fn take(&mut self) -> Option<Detection> {
        let (at, best) = self.best()?;
        let face = self.merged(&best);
        let mut index = 0;
        self.list.retain(|hit| {
            let is_best = index == at;
            index += 1;
            !is_best && !overlaps(hit, &best, COMPETING_DISTANCE, COMPETING_RATIO)
        });
        Some(face)
    }

    /// The best hit and its index; of equals the first, so that the order of the cells decides.
    fn best(&self) -> Option<(usize, Detection)> {
        let hits = self.list.iter().copied().enumerate();
        hits.reduce(|a, b| if a.1.score >= b.1.score { a } else { b })
    }

    /// Mean of the hits of one face, by score, with the best score.
    fn merged(&self, best: &Detection) -> Detection {
        let (mut sum, mut face) = (0.0f32, Detection::default());
        for hit in &self.list {
            if overlaps(hit, best, SAME_DISTANCE, SAME_RATIO) {
                // Hits at the threshold count a little.
                let weight = hit.score + 0.25;
                sum += weight;
                face.x += weight * (hit.x - best.x);
                face.y += weight * (hit.y - best.y);
                face.size += weight * (hit.size - best.size);
                face.roll += weight * (hit.roll - best.roll);
                face.yaw += weight * (hit.yaw - best.yaw);
            }
        }
        let mean = |own: f32, sum_of: f32| own + sum_of / sum.max(0.25);
        Detection {
            x: mean(best.x, face.x),
            y: mean(best.y, face.y),
            size: mean(best.size, face.size),
            roll: mean(best.roll, face.roll),
            yaw: mean(best.yaw, face.yaw),
            score: best.score,
        }
    }
}

impl Candidates {
    /// None yet.
    pub const EMPTY: Candidates = Candidates {
        list: heapless::Vec::new(),
    };

    /// Adds a face of a tile, or gives a candidate of an earlier tile its place.
    pub fn insert(&mut self, face: Detection) {
        let new = Candidate {
            face,
            reported: false,
            seen: false,
        };
        let competes = |c: &&mut Candidate| {
            !c.reported && overlaps(&c.face, &face, COMPETING_DISTANCE, COMPETING_RATIO)
        };
        let is_same = |c: &&mut Candidate| {
            c.reported && overlaps(&c.face, &face, SAME_DISTANCE, REPORTED_RATIO)
        };
        if let Some(seen) = self.list.iter_mut().find(is_same) {
            if face.score > seen.face.score + BETTER_SCORE {
                *seen = new;
            }
        } else if let Some(other) = self.list.iter_mut().find(competes) {
            if face.score > other.face.score {
                *other = new;
            }
        } else if let Err(new) = self.list.push(new) {
            let rank = |c: &Candidate| (!c.reported, c.face.score);
            let lowest = self.list.iter_mut().min_by(|a, b| {
                let ((a_open, a), (b_open, b)) = (rank(a), rank(b));
                a_open.cmp(&b_open).then(a.total_cmp(&b))
            });
            if let Some(lowest) = lowest {
                *lowest = new;
            }
        }
    }

    /// Whether any was not reported yet.
    pub fn has_pending(&self) -> bool {
        self.list.iter().any(|c| !c.reported)
    }

    /// Reports the best candidate that was not reported yet.
    pub fn report(&mut self) -> Option<Detection> {
        self.report_from(f32::NEG_INFINITY)
    }

    /// As [`Self::report`], where its score is at least this.
    pub fn report_from(&mut self, score: f32) -> Option<Detection> {
        reported(self.best(score, |_| true)?)
    }

    /// As [`Self::report_from`], of those that a tile of their own has shown or that are larger
    /// than this \[frame px\].
    pub fn report_seen(&mut self, score: f32, size: f32) -> Option<Detection> {
        reported(self.best(score, |c| c.seen || c.face.size > size)?)
    }

    /// The best candidate of the others, where its score is at least this.
    pub fn unseen(&mut self, score: f32, size: f32) -> Option<Detection> {
        self.best_unseen(score, size).map(|c| c.face)
    }

    /// What a tile of its own shows of [`Self::unseen`], which takes that place; if nothing, it
    /// counts as reported.
    pub fn see(&mut self, face: Option<Detection>, size: f32) {
        if let Some(candidate) = self.best_unseen(f32::NEG_INFINITY, size) {
            candidate.seen = true;
            candidate.reported = face.is_none();
            candidate.face = face.unwrap_or(candidate.face);
        }
    }

    fn best_unseen(&mut self, score: f32, size: f32) -> Option<&mut Candidate> {
        self.best(score, |c| !c.seen && c.face.size <= size)
    }

    /// The best of some candidates that was not reported yet, where its score is at least this.
    fn best(&mut self, score: f32, of: impl Fn(&Candidate) -> bool) -> Option<&mut Candidate> {
        let open = self.list.iter_mut().filter(|c| !c.reported && of(c));
        let best = open.max_by(|a, b| a.face.score.total_cmp(&b.face.score))?;
        (best.face.score >= score).then_some(best)
    }
}

fn reported(candidate: &mut Candidate) -> Option<Detection> {
    candidate.reported = true;
    Some(candidate.face)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hit(x: f32, size: f32, score: f32) -> Detection {
        Detection {
            x,
            y: 50.0,
            size,
            score,
            ..Detection::default()
        }
    }

    fn reports(candidates: &mut Candidates) -> heapless::Vec<f32, CANDIDATES_MAX> {
        core::iter::from_fn(|| candidates.report().map(|face| face.x)).collect()
    }

    #[test]
    fn hits_of_a_face_are_merged() {
        let mut hits = Hits::EMPTY;
        for (x, score) in [(96.0, 1.0), (100.0, 2.0), (104.0, 1.0)] {
            hits.add(&hit(x, 60.0, score));
        }
        hits.add(&hit(125.0, 60.0, 1.5));
        hits.add(&hit(200.0, 60.0, 0.5));
        let faces: [Option<f32>; 3] = core::array::from_fn(|_| hits.take().map(|face| face.x));
        assert_eq!(faces, [Some(100.0), Some(200.0), None]);
    }

    #[test]
    fn the_next_tile_adds_what_is_new_or_far_better() {
        let mut candidates = Candidates::EMPTY;
        let mut tile = |faces: &[Detection]| {
            faces.iter().for_each(|face| candidates.insert(*face));
            reports(&mut candidates)
        };
        assert_eq!(tile(&[hit(100.0, 60.0, 1.0)]), [100.0]);
        assert_eq!(tile(&[hit(101.0, 60.0, 1.5)]), []);
        assert_eq!(tile(&[hit(102.0, 60.0, 2.5)]), [102.0]);
        // A smaller one, where a larger one was rejected.
        assert_eq!(tile(&[hit(102.0, 30.0, 0.1)]), [102.0]);
        // And one whose size the level before could not tell.
        assert_eq!(tile(&[hit(101.0, 48.0, 0.5)]), [101.0]);
    }

    #[test]
    fn a_candidate_is_reported_as_its_own_tile_shows_it() {
        let mut candidates = Candidates::EMPTY;
        candidates.insert(hit(100.0, 60.0, 1.5));
        candidates.insert(hit(300.0, 60.0, 1.0));
        assert_eq!(candidates.report_seen(0.0, 99.0), None);
        assert_eq!(candidates.unseen(2.0, 99.0), None);
        assert_eq!(candidates.unseen(1.0, 99.0), Some(hit(100.0, 60.0, 1.5)));
        candidates.see(Some(hit(104.0, 64.0, 0.5)), 99.0);
        assert_eq!(candidates.report_seen(1.0, 99.0), None);
        assert_eq!(candidates.unseen(1.0, 99.0), Some(hit(300.0, 60.0, 1.0)));
        candidates.see(None, 99.0);
        assert_eq!(candidates.unseen(0.0, 99.0), None);
        assert_eq!(
            candidates.report_seen(0.0, 99.0),
            Some(hit(104.0, 64.0, 0.5))
        );
        assert!(!candidates.has_pending());
        candidates.insert(hit(500.0, 100.0, 0.5));
        assert_eq!(candidates.unseen(0.0, 99.0), None);
        assert_eq!(
            candidates.report_seen(0.0, 99.0),
            Some(hit(500.0, 100.0, 0.5))
        );
    }

    #[test]
    fn the_best_are_kept() {
        let mut candidates = Candidates::EMPTY;
        for k in 0..3 * CANDIDATES_MAX {
            candidates.insert(hit(100.0 * k as f32, 60.0, k as f32));
        }
        let reported = reports(&mut candidates);
        assert_eq!(reported.len(), CANDIDATES_MAX);
        assert_eq!(reported[0], 100.0 * (3 * CANDIDATES_MAX - 1) as f32);
        assert!(candidates.report().is_none(), "each is reported once");
        let mut hits = Hits::EMPTY;
        for k in 0..3 * HITS_MAX {
            hits.add(&hit(-100.0 * k as f32, 60.0, k as f32));
        }
        assert_eq!(hits.list.len(), HITS_MAX);
        assert!(
            hits.list
                .iter()
                .any(|h| h.score == (3 * HITS_MAX - 1) as f32)
        );
    }
}
