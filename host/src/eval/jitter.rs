//! `posewise eval jitter`: how much the landmarks tremble.
//!
//! Per landmark the r.m.s. of the second difference (frame before, this, next) over all runs of
//! tracked frames, scaled to an inter-ocular distance of 40 px; then the median over landmarks. The
//! same of what is left when the similarity that the landmarks follow together is taken off each
//! second difference: the face moves as a whole, a bad tracker's landmarks tremble each by itself.

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
        let [jitter, rest] = jitter(&Table::read(path)?)?;
        let name = path.display().to_string();
        let shown = |v: Option<f64>| v.map_or("-".into(), |v| format!("{v:.3}"));
        writeln!(
            out,
            "{name}: {} px per {INTER_OCULAR} px between the eyes, {} beside motions as a whole",
            shown(jitter),
            shown(rest)
        )?;
        rows.push(json!({"csv": name, "jitter_px": jitter, "rest_px": rest}));
    }
    output::print(&out)?;
    if let Some(path) = &args.json {
        output::write_json(path, &json!({"clips": rows}))?;
    }
    Ok(())
}

/// Of the landmarks as they are, and without what they do together.
fn jitter(table: &Table) -> Result<[Option<f64>; 2]> {
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
    let (mut squares, mut count) = ([[0.0; 68]; 2], 0.0);
    for three in shapes.windows(3) {
        let [Some(a), Some(b), Some(c)] = three else {
            continue;
        };
        let scale = INTER_OCULAR / (b[36][0] - b[45][0]).hypot(b[36][1] - b[45][1]).max(1.0);
        count += 1.0;
        let trembles: [[f64; 2]; 68] =
            std::array::from_fn(|i| [0, 1].map(|k| (a[i][k] - 2.0 * b[i][k] + c[i][k]) * scale));
        let whole = as_a_whole(b, &trembles);
        for (i, (d, w)) in trembles.iter().zip(whole).enumerate() {
            squares[0][i] += d[0].powi(2) + d[1].powi(2);
            squares[1][i] += (d[0] - w[0]).powi(2) + (d[1] - w[1]).powi(2);
        }
    }
    Ok(squares.map(|of| {
        let values = of.map(|sum| (sum / count).sqrt());
        median(&values).filter(|v| v.is_finite())
    }))
}

/// The part of the displacements that a similarity of the shape explains, in the sense of least
/// squares.
fn as_a_whole(shape: &[[f64; 2]; 68], displacements: &[[f64; 2]; 68]) -> [[f64; 2]; 68] {
    let mean = |of: &[[f64; 2]; 68]| [0, 1].map(|k| of.iter().map(|p| p[k]).sum::<f64>() / 68.0);
    let (centre, shift) = (mean(shape), mean(displacements));
    let at = shape.map(|p| [p[0] - centre[0], p[1] - centre[1]]);
    let extent: f64 = at.iter().map(|p| p[0] * p[0] + p[1] * p[1]).sum();
    let pairs = || at.iter().zip(displacements);
    let grow = pairs().map(|(p, d)| p[0] * d[0] + p[1] * d[1]).sum::<f64>() / extent.max(1e-9);
    let turn = pairs().map(|(p, d)| p[0] * d[1] - p[1] * d[0]).sum::<f64>() / extent.max(1e-9);
    at.map(|[x, y]| {
        [
            shift[0] + grow * x - turn * y,
            shift[1] + grow * y + turn * x,
        ]
    })
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
        let jitter = jitter(&table).expect("numbers")[0].expect("frames");
        assert!((jitter - 2.0).abs() < 0.05, "{jitter}");
    }

    #[test]
    fn what_moves_together_is_told_apart() {
        let shape: [[f64; 2]; 68] = std::array::from_fn(|i| {
            let (sin, cos) = (i as f64).sin_cos();
            [100.0 + 30.0 * cos, 80.0 + 20.0 * sin]
        });
        let turned = shape.map(|[x, y]| [0.1 * x - 0.02 * y + 3.0, 0.1 * y + 0.02 * x - 1.0]);
        for (whole, d) in as_a_whole(&shape, &turned).iter().zip(turned) {
            assert!((whole[0] - d[0]).hypot(whole[1] - d[1]) < 1e-9);
        }
    }
}
