//! Events of a monitor: a ring that the caller reads when it wants to.

use crate::track::EventRing;

/// Unread events that a monitor keeps. Chosen: a restless driver has about one event a second.
pub const MONITOR_EVENTS: usize = 24;

/// What happened.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum MonitorEventKind {
    /// A closure ended that was no longer than a blink.
    #[default]
    Blink,
    /// Eyes have been closed for longer than a blink.
    LongClosure,
    /// Eyes have been closed for the time of a microsleep.
    Microsleep,
    /// Eyes have been closed for the time of sleep.
    Sleep,
    /// Eyes have been closed for the time of an unresponsive driver.
    Unresponsive,
    /// A closure that was longer than a blink ended.
    ClosureEnd,
    /// The mouth has been open for the time of a yawn.
    Yawn,
    /// That yawn ended.
    YawnEnd,
    /// The head dropped and came up again, with closed eyes.
    Nod,
    /// A glance away from the road ended; `zone` is where it was last.
    Glance,
    /// A glance away from the road has become too long.
    LongGlance,
    /// Too much of the last 30 s was away from the road.
    CumulativeGlance,
    /// The driver is drowsy; `value` is P80 over 60 s.
    Drowsy,
    /// The driver is no longer drowsy.
    DrowsyEnd,
    /// Eyes have been unknown for a long time.
    Degraded,
    /// Eyes are known again.
    Restored,
    /// The open eyes of this person are learnt; `value` is their mean.
    OpenEyeLearnt,
    /// The natural pose of this person is learnt; `value` is the offset in yaw \[deg\].
    NaturalLearnt,
    /// A timestamp was before the last one: closures, yawns, looks down and glances have ended.
    ClockBack,
    /// The eyes have looked down for a while.
    LookDown,
    /// That look ended.
    LookDownEnd,
}

impl MonitorEventKind {
    /// Every kind, in the order of the C ABI.
    pub const ALL: [MonitorEventKind; 21] = [
        MonitorEventKind::Blink,
        MonitorEventKind::LongClosure,
        MonitorEventKind::Microsleep,
        MonitorEventKind::Sleep,
        MonitorEventKind::Unresponsive,
        MonitorEventKind::ClosureEnd,
        MonitorEventKind::Yawn,
        MonitorEventKind::YawnEnd,
        MonitorEventKind::Nod,
        MonitorEventKind::Glance,
        MonitorEventKind::LongGlance,
        MonitorEventKind::CumulativeGlance,
        MonitorEventKind::Drowsy,
        MonitorEventKind::DrowsyEnd,
        MonitorEventKind::Degraded,
        MonitorEventKind::Restored,
        MonitorEventKind::OpenEyeLearnt,
        MonitorEventKind::NaturalLearnt,
        MonitorEventKind::ClockBack,
        MonitorEventKind::LookDown,
        MonitorEventKind::LookDownEnd,
    ];

    /// Its name in every table and language, as `long-closure`.
    pub const fn name(self) -> &'static str {
        match self {
            MonitorEventKind::Blink => "blink",
            MonitorEventKind::LongClosure => "long-closure",
            MonitorEventKind::Microsleep => "microsleep",
            MonitorEventKind::Sleep => "sleep",
            MonitorEventKind::Unresponsive => "unresponsive",
            MonitorEventKind::ClosureEnd => "closure-end",
            MonitorEventKind::Yawn => "yawn",
            MonitorEventKind::YawnEnd => "yawn-end",
            MonitorEventKind::Nod => "nod",
            MonitorEventKind::Glance => "glance",
            MonitorEventKind::LongGlance => "long-glance",
            MonitorEventKind::CumulativeGlance => "cumulative-glance",
            MonitorEventKind::Drowsy => "drowsy",
            MonitorEventKind::DrowsyEnd => "drowsy-end",
            MonitorEventKind::Degraded => "degraded",
            MonitorEventKind::Restored => "restored",
            MonitorEventKind::OpenEyeLearnt => "open-eye-learnt",
            MonitorEventKind::NaturalLearnt => "natural-learnt",
            MonitorEventKind::ClockBack => "clock-back",
            MonitorEventKind::LookDown => "look-down",
            MonitorEventKind::LookDownEnd => "look-down-end",
        }
    }
}

/// One event.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct MonitorEvent {
    /// Timestamp of the observation at which it was noticed \[µs\].
    pub timestamp_us: i64,
    /// Timestamp at which what it is about began \[µs\]. If the clock was set back since: for what
    /// ends with that, in the time before, so it may be after `timestamp_us`; for what lasts on,
    /// the first timestamp after it.
    pub start_us: i64,
    /// Known duration of it so far \[µs\]: without what was unknown in between, and without the
    /// jump of a clock that was set back.
    pub duration_us: u32,
    /// What happened.
    pub kind: MonitorEventKind,
    /// The zone of a glance.
    pub zone: Option<u8>,
    /// It ended because it could no longer be seen: `duration_us` is the least that it was.
    pub is_cut: bool,
    /// Openness, openness of the jaw, degrees or share, as the kind says; 0 elsewhere.
    pub value: f32,
}

/// The unread events of a monitor.
pub type MonitorEventLog = EventRing<MonitorEvent, MONITOR_EVENTS>;

impl MonitorEventLog {
    pub(super) const EMPTY: MonitorEventLog = EventRing::new(MonitorEvent {
        timestamp_us: 0,
        start_us: 0,
        duration_us: 0,
        kind: MonitorEventKind::Blink,
        zone: None,
        is_cut: false,
        value: 0.0,
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_have_names_and_stand_in_order() {
        for (i, kind) in MonitorEventKind::ALL.into_iter().enumerate() {
            assert_eq!(kind as usize, i);
            assert!(kind.name().len() > 2);
        }
    }
}
