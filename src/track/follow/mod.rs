//! The target on the next frame: where it should be, how it looks, and whether it is still there.

mod anchor;
mod appearance;
mod motion;
mod target;

pub use appearance::Appearance;
pub use target::Target;

use super::align::{Candidate, Origin, Start};
use super::geometry::{centre, is_in_frame};
use super::output::Loss;
use super::policy::{CUT_SHARE, IN_PLACE_SHARES, UNTRUSTED_KEEP_CONFIDENCE};
use super::search::Excluded;
use super::step::Step;
use crate::align::{Networks, Workspace};

/// Sees the target at its predicted place. Where its confidence is low there, the place where it
/// was last trusted is tried too, because whatever covers a face draws the landmarks along.
#[inline(never)]
pub fn see_target(
    step: &Step<'_>,
    target: &mut Target,
    excluded: &Excluded,
    work: &mut Workspace,
) -> Candidate {
    let networks = match target.is_fast() {
        true => Networks::All,
        false => step.networks,
    };
    let predicted = Start::near(target.predict(step.now_us), Origin::Tracked).with(networks);
    let mut first = see_at(step, &predicted, target, excluded, work);
    let is_low = first.is_finite && first.confidence.face < UNTRUSTED_KEEP_CONFIDENCE;
    let Some(anchor) = target.anchor().filter(|_| is_low).copied() else {
        return first;
    };
    work.exchange_features();
    // Of a face of which so little is seen, an average makes nothing better.
    let anchor = Start::near(anchor, Origin::Tracked).with(Networks::First);
    let mut second = see_at(step, &anchor, target, excluded, work);
    first.units += second.units;
    let is_free = !excluded.contains(centre(&second.shape));
    let is_better = second.confidence.face > first.confidence.face;
    if second.is_finite && is_free && is_better {
        second.units = first.units;
        return second;
    }
    work.exchange_features();
    first
}

fn see_at(
    step: &Step<'_>,
    start: &Start,
    target: &mut Target,
    excluded: &Excluded,
    work: &mut Workspace,
) -> Candidate {
    let mut candidate = Candidate::new(step, start, work);
    candidate.recognise(&mut target.appearance, excluded, work);
    candidate
}

/// Whether what was seen of the target is good enough to go on with; else why it is lost.
pub fn verify_target(
    step: &Step<'_>,
    candidate: &Candidate,
    target: &Target,
    excluded: &Excluded,
) -> Result<(), Loss> {
    if !candidate.is_finite {
        return Err(Loss::LowConfidence);
    }
    if excluded.contains(centre(&candidate.shape)) {
        return Err(Loss::Excluded);
    }
    if !is_kept(step, candidate, target) {
        return Err(Loss::LowConfidence);
    }
    match is_in_frame(&candidate.shape, step.frame) {
        true => Ok(()),
        false => Err(Loss::LeftFrame),
    }
}

/// Whether the target is still there by its confidence, or by what surrounds its face.
fn is_kept(step: &Step<'_>, candidate: &Candidate, target: &Target) -> bool {
    let confidence = &candidate.confidence;
    let kept = confidence.face >= target.min_confidence(candidate.recognised, step.now_us);
    if !target.is_trusted() || confidence.face >= UNTRUSTED_KEEP_CONFIDENCE {
        return kept;
    }
    let centre = centre(&candidate.shape);
    if target.last.unchanged(step.frame, centre).most() < CUT_SHARE {
        return false;
    }
    let may_be_covered = target.anchor.is_set() && target.may_be_covered(step.now_us);
    kept || may_be_covered && {
        let share = target.anchor.unchanged(step.frame, centre).in_place;
        confidence.visible_share() + share >= IN_PLACE_SHARES
    }
}
