//! The cumulative error distribution of `eval landmarks`, plotted.

use plotters::coord::Shift;
use plotters::prelude::*;
use posewise_cli::plot::{Chart, Drawn};
use posewise_metrics::cumulative::ced;

use super::landmark_metrics::{Outcome, WIDE_AUC_NME};

/// The curves of 68 and of the 51 inner landmarks.
pub struct Curve {
    lines: [Line; 2],
}

struct Line {
    name: &'static str,
    /// Error and share of pictures, in %.
    corners: Vec<(f64, f64)>,
    color: RGBColor,
}

impl Curve {
    /// Of all pictures.
    pub fn of(outcomes: &[Outcome]) -> Curve {
        let line = |name, from: usize, color| {
            let errors: Vec<f64> = outcomes.iter().filter_map(|o| o.nme(from, 68)).collect();
            let curve = ced(&errors, outcomes.len(), WIDE_AUC_NME);
            let percent = |(error, share): (f64, f64)| (100.0 * error, 100.0 * share);
            Line {
                name,
                corners: curve.into_iter().map(percent).collect(),
                color,
            }
        };
        Curve {
            lines: [line("68 landmarks", 0, BLUE), line("51 inner", 17, RED)],
        }
    }
}

impl Chart for Curve {
    fn draw<DB: DrawingBackend>(&self, root: &DrawingArea<DB, Shift>) -> Drawn<DB> {
        let caption = "pictures [%] over error [% of the distance of the outer eye corners]";
        let mut chart = ChartBuilder::on(root)
            .margin(24)
            .caption(caption, ("sans-serif", 16))
            .x_label_area_size(28)
            .y_label_area_size(48)
            .build_cartesian_2d(0.0..100.0 * WIDE_AUC_NME, 0.0..100.0)?;
        chart.configure_mesh().light_line_style(WHITE).draw()?;
        for line in &self.lines {
            let color = line.color;
            chart
                .draw_series(LineSeries::new(line.corners.iter().copied(), color))?
                .label(line.name)
                .legend(move |(x, y)| PathElement::new([(x, y), (x + 16, y)], color));
        }
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::LowerRight)
            .border_style(BLACK)
            .background_style(WHITE)
            .label_font(("sans-serif", 14))
            .draw()?;
        root.present()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use posewise_cli::plot;

    #[test]
    fn the_curve_is_drawn() {
        let label = std::array::from_fn(|i| [(i % 10) as f64 * 10.0, (i / 10) as f64 * 15.0]);
        let found = label.map(|[x, y]: [f64; 2]| [x + 1.0, y]);
        let outcomes = [
            Outcome::new(&label, Some(&found)),
            Outcome::new(&label, None),
        ];
        let curve = Curve::of(&outcomes);
        assert_eq!(curve.lines[0].corners.last(), Some(&(10.0, 50.0)));
        let dir = tempfile::tempdir().unwrap();
        for name in ["a.svg", "a.png"] {
            plot::save(&dir.path().join(name), &curve).unwrap();
        }
        let text = std::fs::read_to_string(dir.path().join("a.svg")).unwrap();
        assert!(text.contains("51 inner") && text.contains("polyline"));
        let image = image::open(dir.path().join("a.png")).unwrap().into_rgb8();
        assert!(image.pixels().any(|p| p.0 == [0, 0, 255]));
    }
}
