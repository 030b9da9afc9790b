//! Drowsiness by P80 over both windows, with hysteresis.

use super::config::MonitorConfig;
use super::state::{Drowsiness, Perclos};

/// The level that follows `last`. A window of which too little is known does not decide; drowsiness
/// ends only when both windows are known to be below what is awake.
pub(super) fn next(last: Drowsiness, windows: &[Perclos; 2], config: &MonitorConfig) -> Drowsiness {
    let [short, long] = windows;
    let is_known = |window: &Perclos| window.known >= config.min_known;
    let limits = [(short, config.drowsy_p80_60), (long, config.drowsy_p80_180)];
    if limits
        .iter()
        .any(|(window, limit)| is_known(window) && window.p80 >= *limit)
    {
        return Drowsiness::Drowsy;
    }
    if !is_known(short) {
        return Drowsiness::Unknown;
    }
    let is_awake = |(window, limit): &(&Perclos, f32)| window.p80 < config.awake_share * limit;
    match limits.iter().all(is_awake) {
        true => Drowsiness::Awake,
        false if last == Drowsiness::Drowsy => Drowsiness::Drowsy,
        false => Drowsiness::Questionable,
    }
}
