//! What `track --monitor --plot` draws: head angles, openness with closures, PERCLOS, zones with
//! events, over time.

use std::path::Path;

use anyhow::Result;
use plotters::coord::Shift;
use plotters::prelude::*;
use posewise::monitor::{EyeState, MonitorEvent, MonitorEventKind, MonitorState};

use super::columns::zone_number;
use crate::plot::{self, Chart, Drawn, Sample};

/// Draws a run and writes the file.
pub fn write(
    path: &Path,
    samples: &[Sample],
    states: &[MonitorState],
    events: &[MonitorEvent],
) -> Result<()> {
    plot::save(
        path,
        &Panels {
            samples,
            states,
            events,
        },
    )
}

struct Panels<'a> {
    samples: &'a [Sample],
    states: &'a [MonitorState],
    events: &'a [MonitorEvent],
}

/// Pixels of the names of events, which stand beside each other on as many lines.
const LINES: usize = 4;

impl Chart for Panels<'_> {
    fn draw<DB: DrawingBackend>(&self, root: &DrawingArea<DB, Shift>) -> Drawn<DB> {
        let panels = root.split_evenly((4, 1));
        let [angles, eyes, perclos, zones] = &panels[..] else {
            return Ok(());
        };
        plot::draw_angles(angles, self.samples)?;
        self.draw_eyes(eyes)?;
        self.draw_perclos(perclos)?;
        self.draw_zones(zones)?;
        root.present()
    }
}

fn seconds(timestamp_us: i64) -> f64 {
    timestamp_us as f64 / 1e6
}

impl Panels<'_> {
    fn span(&self) -> std::ops::Range<f64> {
        let at = |state: Option<&MonitorState>| state.map_or(0.0, |s| seconds(s.timestamp_us));
        let start = at(self.states.first());
        start..at(self.states.last()).max(start + 1e-3)
    }

    /// Openness, with gaps where it is unknown, and closed eyes in red.
    fn draw_eyes<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>) -> Drawn<DB> {
        let mut chart = ChartBuilder::on(area)
            .margin(8)
            .caption(
                "openness of the eyes, closed in red, a gap: unknown",
                ("sans-serif", 14),
            )
            .x_label_area_size(20)
            .y_label_area_size(48)
            .build_cartesian_2d(self.span(), 0.0..1.05)?;
        chart.configure_mesh().light_line_style(WHITE).draw()?;
        let point = |s: &MonitorState| Some((seconds(s.timestamp_us), f64::from(s.openness?)));
        for run in self.states.split(|s| s.openness.is_none()) {
            chart.draw_series(LineSeries::new(run.iter().filter_map(point), BLACK))?;
        }
        for run in self.states.split(|s| s.eyes != EyeState::Closed) {
            chart.draw_series(LineSeries::new(
                run.iter().filter_map(point),
                RED.stroke_width(3),
            ))?;
        }
        Ok(())
    }

    /// P80 and EM over 60 s, and how much of it is known.
    fn draw_perclos<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>) -> Drawn<DB> {
        let mut chart = ChartBuilder::on(area)
            .margin(8)
            .caption("over the last 60 s", ("sans-serif", 14))
            .x_label_area_size(20)
            .y_label_area_size(48)
            .build_cartesian_2d(self.span(), 0.0..1.05)?;
        chart.configure_mesh().light_line_style(WHITE).draw()?;
        type Value = fn(&MonitorState) -> f32;
        let lines: [(&str, RGBColor, Value); 3] = [
            ("P80", RED, |s| s.perclos_60.p80),
            ("EM", BLUE, |s| s.perclos_60.em),
            ("known", GREEN, |s| s.perclos_60.known),
        ];
        for (name, color, value) in lines {
            let point = |s: &MonitorState| (seconds(s.timestamp_us), f64::from(value(s)));
            chart
                .draw_series(LineSeries::new(self.states.iter().map(point), color))?
                .label(name)
                .legend(move |(x, y)| PathElement::new([(x, y), (x + 16, y)], color));
        }
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::UpperRight)
            .border_style(BLACK)
            .background_style(WHITE)
            .label_font(("sans-serif", 14))
            .draw()?;
        Ok(())
    }

    /// The zone's index, and a line for each event with its name; blinks have only the line.
    fn draw_zones<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>) -> Drawn<DB> {
        let mut chart = ChartBuilder::on(area)
            .margin(8)
            .caption(
                "zone (-1 unknown, -2 outside) and events",
                ("sans-serif", 14),
            )
            .x_label_area_size(20)
            .y_label_area_size(48)
            .build_cartesian_2d(self.span(), -2.5..12.5)?;
        chart.configure_mesh().light_line_style(WHITE).draw()?;
        let zone = |s: &MonitorState| (seconds(s.timestamp_us), zone_number(s.zone));
        chart.draw_series(LineSeries::new(self.states.iter().map(zone), BLACK))?;
        let mut named = 0;
        for event in self.events {
            let at = seconds(event.timestamp_us);
            let is_blink = event.kind == MonitorEventKind::Blink;
            let color = if is_blink { CYAN } else { RED };
            let line = PathElement::new([(at, -2.5), (at, 12.0)], color);
            chart.draw_series(std::iter::once(line))?;
            if is_blink {
                continue;
            }
            let height = 12.0 - 1.2 * (named % LINES) as f64;
            named += 1;
            let text = Text::new(event.kind.name(), (at, height), ("sans-serif", 12));
            chart.draw_series(std::iter::once(text))?;
        }
        Ok(())
    }
}
