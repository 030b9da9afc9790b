//! The tracker's events as lines of text: what `track --log` writes.

use std::io::{self, Write};

use posewise::{Event, EventLog};

/// Writes the unread events, one a line, and how many were overwritten unread; with the tracker's
/// number where there are several.
pub fn write(out: &mut dyn Write, face_id: Option<usize>, events: &mut EventLog) -> io::Result<()> {
    let face = face_id.map_or(String::new(), |id| format!("#{id}  "));
    match events.take_overwritten() {
        0 => {}
        count => writeln!(out, "{face}{count} events overwritten")?,
    }
    while let Some(event) = events.pop() {
        writeln!(out, "{face}{}", line(&event))?;
    }
    Ok(())
}

/// Time, event and what is known of the face, as
/// `3.240000 s  lost  low-confidence  confidence 0.912  box 210,96 104x118`.
fn line(event: &Event) -> String {
    let seconds = event.timestamp_us as f64 / 1e6;
    let mut line = format!("{seconds:.6} s  {}", event.kind.name());
    if let Some(loss) = event.loss {
        line += &format!("  {}", loss.name());
    }
    let [x, y, width, height] = event.face_box;
    if width > 0.0 {
        let confidence = event.confidence;
        line += &format!("  confidence {confidence:.3}  box {x:.0},{y:.0} {width:.0}x{height:.0}");
    }
    line
}
