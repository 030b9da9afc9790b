//! `posewise eval jitter`: how much the landmarks tremble.
//!
//! Per landmark the r.m.s. of the second difference (frame before, this, next) over all runs of
//! tracked frames, scaled to an inter-ocular distance of 40 px; then the median over landmarks.

use std::fmt::Write as _;

use anyhow::Result;
use serde_json::json;

use super::median;
use super::table::Table;
use crate::cli::JitterArgs;
use crate::output;

/// Inter-ocular distance that figures are scaled to \[px\].
const INTER_OCULAR: f64 = 40.0;

/// Runs the command.
pub fn run(args: &JitterArgs) -> Result<()> {
    let mut out = String::new();
    let mut rows = Vec::new();
    for path in &args.csv {
        let jitter = jitter(&Table::read(path)?)?;
        let name = path.display().to_string();
        let shown = jitter.map_or("-".into(), |j| format!("{j:.3}"));
        writeln!(
            out,
            "{name}: {shown} px per {INTER_OCULAR} px between the eyes"
        )?;
        rows.push(json!({"csv": name, "jitter_px": jitter}));
    }
    output::print(&out)?;
    if let Some(path) = &args.json {
        output::write_json(path, &json!({"clips": rows}))?;
    }
    Ok(())
}

fn jitter(table: &Table) -> Result<Option<f64>> {
    let success = table.column("success")?;
    let (xs, ys) = (table.columns68("x_")?, table.columns68("y_")?);
    let mut shapes: Vec<Option<[[f64; 2]; 68]>> = Vec::with_capacity(table.len());
    for row in 0..table.len() {
        let mut shape = [[0.0; 2]; 68];
        for (i, p) in shape.iter_mut().enumerate() {
            *p = [table.number(row, xs[i])?, table.number(row, ys[i])?];
        }
        shapes.push((table.number(row, success)? > 0.5).then_some(shape));
    }
    let (mut squares, mut count) = ([0.0; 68], 0.0);
    for three in shapes.windows(3) {
        let [Some(a), Some(b), Some(c)] = three else {
            continue;
        };
        let scale = INTER_OCULAR / (b[36][0] - b[45][0]).hypot(b[36][1] - b[45][1]).max(1.0);
        count += 1.0;
        for (i, sum) in squares.iter_mut().enumerate() {
            let d = [0, 1].map(|k| (a[i][k] - 2.0 * b[i][k] + c[i][k]) * scale);
            *sum += d[0] * d[0] + d[1] * d[1];
        }
    }
    let values: Vec<f64> = squares.iter().map(|s| (s / count).sqrt()).collect();
    Ok(median(&values).filter(|v| v.is_finite()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steady_motion_does_not_tremble() {
        let mut text = String::from("success");
        (0..68).for_each(|i| text += &format!(",x_{i},y_{i}"));
        for frame in 0..6 {
            text += "\n1";
            for i in 0..68 {
                let x = if i == 45 { 40.0 } else { 0.0 } + 2.0 * f64::from(frame);
                let y = f64::from(frame % 2) * f64::from(u8::from(i > 30));
                text += &format!(",{x},{y}");
            }
        }
        let table = Table::parse("test", text.as_bytes()).expect("a table");
        let jitter = jitter(&table).expect("numbers").expect("frames");
        assert!((jitter - 2.0).abs() < 0.05, "{jitter}");
    }
}
