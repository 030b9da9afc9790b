//! The monitor of a run: it sees each result, and its events become lines of text.

use std::io::Write;

use anyhow::{Context, Result, anyhow};
use posewise::monitor::{Monitor, MonitorEvent, MonitorState, Observation, Place, Zone};
use posewise::{Intrinsics, TrackResult};

use serde_json::{Value, json};

use super::keep::{Keeper, Turn};
use super::{json, zones};
use crate::cli::MonitorArgs;
use crate::parse::DriverPlace;

/// Events that are kept for a page: more than it shows.
const MOST_EVENTS: usize = 24;

/// A monitor and where its events go.
pub struct Watch {
    monitor: Monitor,
    zones: Vec<Zone>,
    keeper: Keeper,
    out: Option<Box<dyn Write>>,
    /// All events so far, for the plot.
    pub events: Vec<MonitorEvent>,
    /// All states so far, if the plot wants them.
    pub states: Vec<MonitorState>,
    keeps: bool,
}

impl Watch {
    /// A monitor with these settings. States are kept if something will draw them.
    pub fn new(args: &MonitorArgs, out: Option<Box<dyn Write>>, keeps: bool) -> Result<Self> {
        let preset = args.monitor_preset;
        let given = args.monitor_zones.as_deref().map(zones::read).transpose()?;
        let zones = given.unwrap_or_else(|| preset.zones().to_vec());
        let mut config = preset.config();
        config.zones_by = args.monitor_zones_by;
        (config.place, config.place_mm) = match args.monitor_place {
            DriverPlace::Learnt => (Place::Learnt, config.place_mm),
            DriverPlace::Any => (Place::Any, config.place_mm),
            DriverPlace::At(at_mm) => (Place::Given, at_mm),
        };
        let monitor = Monitor::with_zones(&config, &zones);
        Ok(Watch {
            monitor: monitor.map_err(|e| anyhow!("{e}"))?,
            zones,
            keeper: Keeper::new(config.place_radius_mm),
            out,
            events: Vec::new(),
            states: Vec::new(),
            keeps,
        })
    }

    /// What is to be done with the tracker, so that it follows the driver.
    pub fn keep(
        &mut self,
        timestamp_us: i64,
        camera: &Intrinsics,
        size: (i32, i32),
    ) -> Option<Turn> {
        let state = self.monitor.state();
        self.keeper.see(&state, timestamp_us, camera, size)
    }

    /// The result of a frame.
    pub fn see(&mut self, result: &TrackResult, timestamp_us: i64) -> Result<()> {
        self.observe(&Observation::from(result), timestamp_us)
    }

    /// What is seen of a frame.
    pub fn observe(&mut self, seen: &Observation, timestamp_us: i64) -> Result<()> {
        let updated = self.monitor.update(seen, timestamp_us);
        updated.map_err(|e| anyhow!("{e}"))?;
        while let Some(event) = self.monitor.events().pop() {
            if let Some(out) = &mut self.out {
                writeln!(out, "{}", line(&event)).context("cannot write the events")?;
            }
            self.events.push(event);
        }
        if self.keeps {
            self.states.push(self.monitor.state());
        }
        Ok(())
    }

    /// Forgets all events but the last ones: nobody may ask for them for days.
    pub fn forget_old_events(&mut self) {
        let old = self.events.len().saturating_sub(MOST_EVENTS);
        self.events.drain(..old);
    }

    /// What the page of `posewise view` shows; it has the events from then on anew.
    pub fn message(&mut self) -> (Value, Value) {
        let events: Value = self.events.drain(..).map(|e| json::event(&e)).collect();
        let monitor = json!({ "state": json::state(&self.state()), "events": events });
        (monitor, json::zones(&self.zones))
    }

    /// What is known now.
    pub fn state(&self) -> MonitorState {
        self.monitor.state()
    }

    /// Hands everything on to the file.
    pub fn flush(&mut self) -> Result<()> {
        match &mut self.out {
            Some(out) => out.flush().context("cannot write the events"),
            None => Ok(()),
        }
    }

    /// Closes the file.
    pub fn close(&mut self) {
        self.out = None;
    }
}

/// Time, event, when it began and for how long it was known to go on, as
/// `4.966667 s  microsleep  from 3.933333 s  for 1.000 s`.
fn line(event: &MonitorEvent) -> String {
    let seconds = |us: i64| us as f64 / 1e6;
    let mut line = format!(
        "{:.6} s  {}",
        seconds(event.timestamp_us),
        event.kind.name()
    );
    if event.duration_us > 0 {
        line += &format!(
            "  from {:.6} s  for {:.3} s",
            seconds(event.start_us),
            f64::from(event.duration_us) / 1e6
        );
    }
    if let Some(zone) = event.zone {
        line += &format!("  zone {zone}");
    }
    if event.value != 0.0 {
        line += &format!("  value {:.3}", event.value);
    }
    if event.is_cut {
        line += "  cut";
    }
    line
}
