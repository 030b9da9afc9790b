//! Events that last: which true ones were found, and which found ones are false.

/// Share of a level's time that a found closure must have \[of the true length\].
const FOUND_SHARE: f64 = 0.5;

/// When something was \[s\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// From the first frame on.
    pub start_s: f64,
    /// How long.
    pub length_s: f64,
}

impl Span {
    /// How long both are; below 0 where they are apart.
    pub fn overlap_s(&self, other: &Span) -> f64 {
        let end = |span: &Span| span.start_s + span.length_s;
        end(self).min(end(other)) - self.start_s.max(other.start_s)
    }
}

/// Events of a kind: true ones, those of them found, and false ones.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Events {
    /// True ones.
    pub truth: usize,
    /// Those of them that were found.
    pub found: usize,
    /// Found ones that are not true.
    pub invented: usize,
}

impl Events {
    /// Adds those of another clip.
    pub fn add(&mut self, other: &Events) {
        self.truth += other.truth;
        self.found += other.found;
        self.invented += other.invented;
    }
}

/// True events of a length, and those that overlap with found ones of at least half of it.
pub fn level(truth: &[Span], found: &[Span], least_s: f64) -> Events {
    let long = truth.iter().filter(|span| span.length_s >= least_s);
    let is_found = |span: &&Span| {
        let long_enough = |f: &&Span| f.length_s >= FOUND_SHARE * span.length_s.min(least_s);
        let mut found = found.iter().filter(long_enough);
        found.any(|f| f.overlap_s(span) > 0.0)
    };
    Events {
        truth: long.clone().count(),
        found: long.filter(is_found).count(),
        invented: 0,
    }
}

/// Found events of a length that overlap with true ones in at most this share of their time.
pub fn invented(found: &[Span], truth: &[Span], least_s: f64, share: f64) -> usize {
    let long = found.iter().filter(|span| span.length_s >= least_s);
    let is_invented = |span: &&Span| {
        let true_s: f64 = truth.iter().map(|t| t.overlap_s(span).max(0.0)).sum();
        true_s <= share * span.length_s
    };
    long.filter(is_invented).count()
}
