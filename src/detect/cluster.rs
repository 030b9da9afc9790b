//! Merges overlapping hits: a fixed-capacity list of score-weighted sums.

use super::Detection;
use super::window::Q4;

/// Most clusters kept at once; a new one then replaces the weakest.
const CLUSTERS_MAX: usize = 24;

/// A hit joins a cluster whose centre is this near \[1/16 of the larger size\] …
const JOIN_DISTANCE: i64 = 5;
/// … and whose size differs by less than this factor \[1/16\]. Both are twice the displacement that
/// the trees are trained to tolerate.
const JOIN_RATIO: i64 = 24;
/// … and whose roll differs by less than this \[1/65536 revolution\]: 45°.
const JOIN_ROLL: i32 = 8_192;
/// Clusters this near \[1/16 of the larger size\] and within this factor of size \[1/16\] compete:
/// of these only the strongest is reported. Windows a step too large around a face may form a weak
/// cluster of their own.
const COMPETING_DISTANCE: i64 = 8;
const COMPETING_RATIO: i64 = 64;

/// A window that the cascades accept as a face.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hit {
    /// Centre and size \[1/16 px\].
    pub x: i32,
    pub y: i32,
    pub size: i32,
    /// \[1/65536 revolution\].
    pub roll: i32,
    /// > 0.
    pub score: i32,
    /// Number of the scan's size level.
    pub level: u16,
}

/// Score-weighted sums over hits that overlap.
#[derive(Clone, Debug)]
struct Cluster {
    /// Sum of scores, > 0.
    strength: i64,
    x: i64,
    y: i64,
    size: i64,
    roll: i64,
    last_level: u16,
    /// Already reported in this scan.
    reported: bool,
    /// Hit during this call.
    fresh: bool,
}

/// A cluster's mean: \[1/16 px\], \[1/65536 revolution\].
#[derive(Clone, Copy, Debug)]
struct Mean {
    x: i32,
    y: i32,
    size: i32,
    roll: i32,
}

impl Cluster {
    fn new(hit: &Hit) -> Cluster {
        let mut cluster = Cluster {
            strength: 0,
            x: 0,
            y: 0,
            size: 0,
            roll: 0,
            last_level: 0,
            reported: false,
            fresh: false,
        };
        cluster.add(hit);
        cluster
    }

    fn add(&mut self, hit: &Hit) {
        let weight = hit.score as i64;
        // Saturating: a forged model may give every window of a large frame the largest score.
        let add = |sum: &mut i64, v: i32| *sum = sum.saturating_add(weight * v as i64);
        add(&mut self.strength, 1);
        add(&mut self.x, hit.x);
        add(&mut self.y, hit.y);
        add(&mut self.size, hit.size);
        add(&mut self.roll, hit.roll);
        self.last_level = hit.level;
        self.fresh = true;
    }

    fn mean(&self) -> Option<Mean> {
        // Strength is a sum of positive scores, so the fallback of a division by 0 is never taken.
        let over = |sum: i64| sum.checked_div(self.strength).map(|v| v as i32);
        Some(Mean {
            x: over(self.x)?,
            y: over(self.y)?,
            size: over(self.size)?,
            roll: over(self.roll)?,
        })
    }

    /// The mean as a detection, with the score strength / `confirm` − 1.
    fn report(&mut self, confirm: i32) -> Option<Detection> {
        self.reported = true;
        let mean = self.mean()?;
        let px = |v: i32| v as f32 / Q4 as f32;
        Some(Detection {
            x: px(mean.x),
            y: px(mean.y),
            size: px(mean.size),
            roll: radians(mean.roll),
            yaw: 0.0,
            score: self.strength as f32 / confirm.max(1) as f32 - 1.0,
        })
    }
}

/// Whether centres lie within `distance`/16 of the larger size and sizes within a factor of
/// `ratio`/16.
fn overlaps(a: &Mean, b: &Mean, distance: i64, ratio: i64) -> bool {
    let (small, large) = (a.size.min(b.size) as i64, a.size.max(b.size) as i64);
    let limit = large * distance;
    let apart = |p: i32, q: i32| (p as i64 - q as i64).abs() * 16;
    apart(a.x, b.x) < limit && apart(a.y, b.y) < limit && large * 16 < small * ratio
}

/// All clusters of a scan.
#[derive(Clone, Debug)]
pub(super) struct Clusters {
    list: heapless::Vec<Cluster, CLUSTERS_MAX>,
}

impl Clusters {
    /// No hit yet.
    pub const EMPTY: Clusters = Clusters {
        list: heapless::Vec::new(),
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
            // A cluster that was reported and rejected must not draw in its neighbours' hits.
            !c.reported
                && c.mean().is_some_and(|mean| {
                    overlaps(&mean, &at, JOIN_DISTANCE, JOIN_RATIO)
                        && (mean.roll - at.roll).abs() < JOIN_ROLL
                })
        };
        if let Some(cluster) = self.list.iter_mut().find(joins) {
            cluster.add(&hit);
        } else if let Err(new) = self.list.push(Cluster::new(&hit))
            && let Some(weakest) = self.list.iter_mut().min_by_key(|c| c.strength)
        {
            *weakest = new;
        }
    }

    /// A new call of the scan begins, maybe on another frame.
    pub fn begin_call(&mut self) {
        self.list.iter_mut().for_each(|c| c.fresh = false);
    }

    /// Reports the best cluster. `None` if there is none, or if it was hit at the size `level`,
    /// unless that was the `last`: smaller sizes may still add to it. Each cluster is reported
    /// once.
    pub fn report(&mut self, confirm: i32, level: u16, last: bool) -> Option<Detection> {
        let best = self.best(confirm, |_| true)?;
        match last || best.last_level < level {
            true => best.report(confirm),
            false => None,
        }
    }

    /// Reports the best cluster that was hit during this call, complete or not.
    pub fn report_fresh(&mut self, confirm: i32) -> Option<Detection> {
        self.best(confirm, |c| c.fresh)?.report(confirm)
    }

    /// Of the clusters that are `eligible`, not yet reported and at least `confirm` strong: the
    /// strongest of those that compete with the largest.
    fn best(&mut self, confirm: i32, eligible: impl Fn(&Cluster) -> bool) -> Option<&mut Cluster> {
        let open = |c: &Cluster| !c.reported && c.strength >= confirm as i64 && eligible(c);
        let open_mean = |c: &Cluster| if open(c) { c.mean() } else { None };
        let largest = self
            .list
            .iter()
            .filter_map(open_mean)
            .max_by_key(|mean| mean.size)?;
        let competes = |c: &&mut Cluster| {
            open_mean(c)
                .is_some_and(|mean| overlaps(&mean, &largest, COMPETING_DISTANCE, COMPETING_RATIO))
        };
        self.list
            .iter_mut()
            .filter(competes)
            .max_by_key(|c| c.strength)
    }
}

/// \[1/65536 revolution\] in radians.
pub(super) fn radians(roll: i32) -> f32 {
    roll as f32 * (core::f32::consts::TAU / 65_536.0)
}
