//! Plots as SVG or PNG; here that of yaw, pitch, roll and confidence over time.

use std::path::Path;

use anyhow::{Context, Result, anyhow, bail};
use image::RgbImage;
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters_backend::text_anchor::{HPos, VPos};
use plotters_backend::{BackendColor, BackendStyle, BackendTextStyle, DrawingBackend};
use plotters_backend::{BackendCoord, DrawingErrorKind};
use posewise::{State, TrackResult};

use crate::{output, text};

const SIZE: (u32, u32) = (1200, 700);

/// What is plotted of one frame.
pub struct Sample {
    time_s: f64,
    /// Yaw, pitch, roll \[deg\]; `None` while searching, which leaves a gap.
    angles: Option<[f64; 3]>,
    confidence: f64,
}

impl Sample {
    /// Takes what is plotted from a result.
    pub fn of(result: &TrackResult) -> Self {
        let angles = [result.yaw_deg, result.pitch_deg, result.roll_deg].map(f64::from);
        Sample {
            time_s: result.timestamp_us as f64 / 1e6,
            angles: (result.state != State::Searching).then_some(angles),
            confidence: f64::from(result.confidence),
        }
    }
}

/// Refuses names whose extension is neither `.svg` nor `.png`, before any work is done.
pub fn check_name(path: &Path) -> Result<()> {
    match extension(path).as_str() {
        "svg" | "png" => Ok(()),
        _ => bail!(
            "--plot {}: the name must end in .svg or .png",
            path.display()
        ),
    }
}

/// Something that can be drawn.
pub trait Chart {
    /// Draws it on a white area.
    fn draw<DB: DrawingBackend>(&self, root: &DrawingArea<DB, Shift>) -> Drawn<DB>;
}

/// Draws angles and confidence over time and writes the file.
pub fn write(path: &Path, samples: &[Sample]) -> Result<()> {
    save(path, &Angles(samples))
}

/// Draws and writes the file.
pub fn save(path: &Path, chart: &impl Chart) -> Result<()> {
    if extension(path) == "svg" {
        let mut svg = String::new();
        let root = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
        let drawn = root.fill(&WHITE).and_then(|()| chart.draw(&root));
        drawn.map_err(|e| anyhow!("cannot draw the plot: {e}"))?;
        drop(root);
        std::fs::write(path, svg).with_context(|| format!("cannot write {}", path.display()))
    } else {
        let mut bitmap = Bitmap(RgbImage::from_pixel(SIZE.0, SIZE.1, image::Rgb([255; 3])));
        chart
            .draw(&(&mut bitmap).into_drawing_area())
            .map_err(|e| anyhow!("cannot draw the plot: {e}"))?;
        output::write_png(path, &bitmap.0)
    }
}

fn extension(path: &Path) -> String {
    let extension = path.extension().and_then(|e| e.to_str());
    extension.unwrap_or("").to_lowercase()
}

/// What drawing gives.
pub type Drawn<DB> = Result<(), DrawingAreaErrorKind<<DB as DrawingBackend>::ErrorType>>;

struct Angles<'a>(&'a [Sample]);

impl Chart for Angles<'_> {
    fn draw<DB: DrawingBackend>(&self, root: &DrawingArea<DB, Shift>) -> Drawn<DB> {
        let samples = self.0;
        let (upper, lower) = root.split_vertically(SIZE.1 * 2 / 3);
        draw_angles(&upper, samples)?;
        let mut confidence = ChartBuilder::on(&lower)
            .margin(12)
            .caption("confidence over time [s]", ("sans-serif", 16))
            .x_label_area_size(28)
            .y_label_area_size(48)
            .build_cartesian_2d(span(samples), 0.0..1.05)?;
        confidence.configure_mesh().light_line_style(WHITE).draw()?;
        let points = samples.iter().map(|s| (s.time_s, s.confidence));
        confidence.draw_series(LineSeries::new(points, BLACK))?;
        root.present()
    }
}

/// The time that the samples take \[s\].
fn span(samples: &[Sample]) -> std::ops::Range<f64> {
    let start = samples.first().map_or(0.0, |s| s.time_s);
    start..samples.last().map_or(0.0, |s| s.time_s).max(start + 1e-3)
}

/// Draws yaw, pitch and roll over time.
pub fn draw_angles<DB: DrawingBackend>(
    area: &DrawingArea<DB, Shift>,
    samples: &[Sample],
) -> Drawn<DB> {
    let largest = samples.iter().filter_map(|s| s.angles).flatten();
    let largest = largest.filter(|v| v.is_finite());
    let largest = largest.fold(20.0f64, |m, v| m.max(v.abs())).ceil() + 5.0;
    let mut angles = ChartBuilder::on(area)
        .margin(12)
        .caption("head angles [deg]", ("sans-serif", 16))
        .x_label_area_size(28)
        .y_label_area_size(48)
        .build_cartesian_2d(span(samples), -largest..largest)?;
    angles.configure_mesh().light_line_style(WHITE).draw()?;
    let lines = [("yaw", RED), ("pitch", GREEN), ("roll", BLUE)];
    for (i, (name, color)) in lines.into_iter().enumerate() {
        for run in samples.split(|s| s.angles.is_none()) {
            let points = run.iter().filter_map(|s| Some((s.time_s, s.angles?[i])));
            angles.draw_series(LineSeries::new(points, color))?;
        }
        let none: [(f64, f64); 0] = [];
        angles
            .draw_series(LineSeries::new(none, color))?
            .label(name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 16, y)], color));
    }
    angles
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperRight)
        .border_style(BLACK)
        .background_style(WHITE)
        .label_font(("sans-serif", 14))
        .draw()?;
    Ok(())
}

/// plotters' bitmap, with the built-in font in place of the system's.
struct Bitmap(RgbImage);

type Done = Result<(), DrawingErrorKind<std::convert::Infallible>>;

impl DrawingBackend for &mut Bitmap {
    type ErrorType = std::convert::Infallible;

    fn get_size(&self) -> (u32, u32) {
        self.0.dimensions()
    }

    fn ensure_prepared(&mut self) -> Done {
        Ok(())
    }

    fn present(&mut self) -> Done {
        Ok(())
    }

    fn draw_pixel(&mut self, (x, y): BackendCoord, color: BackendColor) -> Done {
        if let (Ok(x), Ok(y)) = (u32::try_from(x), u32::try_from(y))
            && let Some(pixel) = self.0.get_pixel_mut_checked(x, y)
        {
            let (r, g, b) = color.rgb;
            for (old, new) in pixel.0.iter_mut().zip([r, g, b]) {
                let mixed = f64::from(*old) * (1.0 - color.alpha) + f64::from(new) * color.alpha;
                *old = mixed.round() as u8;
            }
        }
        Ok(())
    }

    fn draw_text<S: BackendTextStyle>(
        &mut self,
        words: &str,
        style: &S,
        (x, y): BackendCoord,
    ) -> Done {
        let width = text::width(words);
        let left = match style.anchor().h_pos {
            HPos::Left => x,
            HPos::Center => x - width / 2,
            HPos::Right => x - width,
        };
        let top = match style.anchor().v_pos {
            VPos::Top => y,
            VPos::Center => y - text::GLYPH / 2,
            VPos::Bottom => y - text::GLYPH,
        };
        let color = style.color();
        text::each_pixel(words, |dx, dy| {
            // Drawing cannot fail: the error type has no values.
            let _ = self.draw_pixel((left + dx, top + dy), color.color());
        });
        Ok(())
    }

    fn estimate_text_size<S: BackendTextStyle>(
        &self,
        words: &str,
        _: &S,
    ) -> Result<(u32, u32), DrawingErrorKind<Self::ErrorType>> {
        Ok((text::width(words) as u32, text::GLYPH as u32))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn writes_both_formats() {
        let samples: Vec<Sample> = (0..90)
            .map(|i| Sample {
                time_s: f64::from(i) / 30.0,
                angles: (!(30..40).contains(&i)).then(|| {
                    let v = f64::from(i);
                    [40.0 * (v / 9.0).sin(), 10.0, -v / 3.0]
                }),
                confidence: 0.8,
            })
            .collect();
        let dir = tempfile::tempdir().unwrap();
        let svg = dir.path().join("a.svg");
        write(&svg, &samples).unwrap();
        let text = std::fs::read_to_string(&svg).unwrap();
        assert!(text.contains("yaw") && text.contains("polyline"));
        let png = dir.path().join("a.png");
        write(&png, &samples).unwrap();
        let image = image::open(&png).unwrap().into_rgb8();
        assert!(image.pixels().any(|p| p.0 == [255, 0, 0]));
        // One sample, and none at all, are no reason to fail.
        write(&png, &samples[..1]).unwrap();
        write(&svg, &[]).unwrap();
        assert!(check_name(Path::new("a.txt")).is_err());
    }
}
