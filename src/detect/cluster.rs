//! Overlapping hits, merged: a fixed table of weighted sums.

use super::Detection;
use super::window::Q4;

/// Most clusters kept at once; the weakest makes room.
const CLUSTERS: usize = 24;

/// A window that was taken for a face.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hit {
    /// Centre and size \[1/16 px\].
    pub x: i32,
    pub y: i32,
    pub size: i32,
    /// \[1/65536 turn\].
    pub roll: i32,
    /// > 0.
    pub score: i32,
    /// Number of the pass over one size.
    pub pass: u16,
}

/// Score-weighted sums over hits that overlap.
#[derive(Clone, Copy, Debug, Default)]
struct Cluster {
    // Sum of scores; 0 marks a free place.
    strength: i64,
    x: i64,
    y: i64,
    size: i64,
    roll: i64,
    last_pass: u16,
    // Already answered with in this sweep.
    reported: bool,
    // Hit in this slice.
    fresh: bool,
}

/// A cluster's mean: \[1/16 px\], \[1/65536 turn\].
#[derive(Clone, Copy, Debug)]
struct Mean {
    x: i32,
    y: i32,
    size: i32,
    roll: i32,
}

impl Cluster {
    const FREE: Cluster = Cluster {
        strength: 0,
        x: 0,
        y: 0,
        size: 0,
        roll: 0,
        last_pass: 0,
        reported: false,
        fresh: false,
    };

    fn mean(&self) -> Option<Mean> {
        // Strength is a count of positive scores: the division is by > 0 or there is no cluster.
        let over = |sum: i64| sum.checked_div(self.strength).map(|v| v as i32);
        Some(Mean {
            x: over(self.x)?,
            y: over(self.y)?,
            size: over(self.size)?,
            roll: over(self.roll)?,
        })
    }

    /// The score is the strength over `confirm`, less one.
    fn report(&mut self, confirm: i32) -> Option<Detection> {
        self.reported = true;
        let mean = self.mean()?;
        let px = |v: i32| v as f32 / Q4 as f32;
        Some(Detection {
            x: px(mean.x),
            y: px(mean.y),
            size: px(mean.size),
            roll: turns(mean.roll),
            yaw: 0.0,
            score: self.strength as f32 / confirm.max(1) as f32 - 1.0,
        })
    }

    fn add(&mut self, hit: &Hit) {
        let weight = hit.score as i64;
        self.strength += weight;
        self.x += weight * hit.x as i64;
        self.y += weight * hit.y as i64;
        self.size += weight * hit.size as i64;
        self.roll += weight * hit.roll as i64;
        self.last_pass = hit.pass;
        self.fresh = true;
    }
}

/// The same face: centres within `near`/16 of the larger size, sizes within a factor of
/// `ratio`/16.
fn overlaps(a: &Mean, b: &Mean, near: i64, ratio: i64) -> bool {
    let (small, large) = (a.size.min(b.size) as i64, a.size.max(b.size) as i64);
    let limit = large * near;
    let apart = |p: i32, q: i32| (p as i64 - q as i64).abs() * 16;
    apart(a.x, b.x) < limit && apart(a.y, b.y) < limit && large * 16 < small * ratio
}

/// All clusters of a scan.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Clusters {
    table: [Cluster; CLUSTERS],
}

impl Clusters {
    /// No hit yet.
    pub const EMPTY: Clusters = Clusters {
        table: [Cluster::FREE; CLUSTERS],
    };

    /// Adds a hit to the cluster that it overlaps, or starts one.
    pub fn add(&mut self, hit: Hit) {
        let at = Mean {
            x: hit.x,
            y: hit.y,
            size: hit.size,
            roll: hit.roll,
        };
        let joins = |c: &&mut Cluster| {
            // What was told proved wrong: hits beside it must not be drawn into it.
            !c.reported
                && c.mean().is_some_and(|mean| {
                    // A third of the size and a factor of 1.5: twice the tolerance of the trees.
                    overlaps(&mean, &at, 5, 24) && (mean.roll - at.roll).abs() < 8_192
                })
        };
        if let Some(cluster) = self.table.iter_mut().find(joins) {
            cluster.add(&hit);
        } else if let Some(weakest) = self.table.iter_mut().min_by_key(|c| c.strength) {
            *weakest = Cluster::FREE;
            weakest.add(&hit);
        }
    }

    /// From here on another frame may be looked at.
    pub fn begin_slice(&mut self) {
        self.table.iter_mut().for_each(|c| c.fresh = false);
    }

    /// The best cluster; `None` if there is none, or if it was still hit in pass `pass`, unless that
    /// was the last. Each cluster is told once.
    pub fn report(&mut self, confirm: i32, pass: u16, last: bool) -> Option<Detection> {
        let best = self.best(confirm, |_| true)?;
        match last || best.last_pass < pass {
            true => best.report(confirm),
            false => None,
        }
    }

    /// The best cluster that was hit in this slice, complete or not.
    pub fn report_fresh(&mut self, confirm: i32) -> Option<Detection> {
        self.best(confirm, |c| c.fresh)?.report(confirm)
    }

    /// Of these and not yet told the largest cluster of at least `confirm`, or the strongest of those
    /// that overlap it.
    fn best(&mut self, confirm: i32, of: impl Fn(&Cluster) -> bool) -> Option<&mut Cluster> {
        let open = |c: &Cluster| !c.reported && c.strength >= confirm as i64 && of(c);
        let open_mean = |c: &Cluster| if open(c) { c.mean() } else { None };
        let largest = self
            .table
            .iter()
            .filter_map(open_mean)
            .max_by_key(|mean| mean.size)?;
        // Windows a step too large around a face may make a weak cluster of their own.
        let near = |c: &&mut Cluster| open_mean(c).is_some_and(|m| overlaps(&m, &largest, 8, 64));
        self.table
            .iter_mut()
            .filter(near)
            .max_by_key(|c| c.strength)
    }
}

/// 1/65536 turn in radians.
pub(super) fn turns(roll: i32) -> f32 {
    roll as f32 * (core::f32::consts::TAU / 65_536.0)
}
