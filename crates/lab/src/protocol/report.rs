//! Tables of measures, and curves.

use posewise_metrics::cumulative::{area_under_ced, ced};
use posewise_metrics::mean;
use posewise_metrics::pose::PoseErrors;
use std::fmt::Write as _;

/// What a protocol found.
#[derive(Default)]
pub struct Report {
    /// Markdown.
    pub text: String,
    /// Name, and corners of the curve: error and share of frames or pictures.
    pub curves: Vec<(String, Vec<(f64, f64)>)>,
}

/// A value with two digits behind the point, or a dash.
pub fn cell(value: Option<f64>) -> String {
    value.map_or("–".into(), |v| format!("{v:.2}"))
}

impl Report {
    /// A line of text.
    pub fn line(&mut self, text: &str) {
        // Writing to a String cannot fail.
        let _ = writeln!(self.text, "{text}");
    }

    /// Adds the report of one system, named where there are others.
    pub fn add(&mut self, system: &str, is_named: bool, other: Report) {
        if is_named {
            self.line(&format!("## {system}\n"));
        }
        self.text += &other.text;
        let named = |name: String| match is_named {
            true => format!("{system}: {name}"),
            false => name,
        };
        let curves = other.curves.into_iter();
        self.curves
            .extend(curves.map(|(name, curve)| (named(name), curve)));
    }

    /// A row of a table.
    pub fn row(&mut self, cells: &[String]) {
        self.line(&format!("| {} |", cells.join(" | ")));
    }

    /// The head of a table.
    pub fn head(&mut self, titles: &[&str]) {
        self.line(&format!("| {} |", titles.join(" | ")));
        self.line(&format!("|{}", "---|".repeat(titles.len())));
    }

    /// The head of [`Report::pose`]'s rows.
    pub fn pose_head(&mut self) {
        self.head(&[
            "clip",
            "frames",
            "P_s %",
            "E_yaw °",
            "E_pitch °",
            "E_roll °",
            "E_m °",
        ]);
    }

    /// P_s and errors of pose.
    pub fn pose(&mut self, name: &str, errors: &PoseErrors) {
        let axis = |i: usize| cell(errors.mean().map(|e| e[i]));
        self.row(&[
            name.into(),
            errors.len().to_string(),
            cell(errors.success().map(|s| 100.0 * s)),
            axis(0),
            axis(1),
            axis(2),
            cell(errors.mean_angle()),
        ]);
    }
}

/// NME of pictures \[% of the unit\]; those without a face count in the area and the failures.
#[derive(Clone, Debug, Default)]
pub struct Nme {
    errors: Vec<f64>,
    pictures: usize,
}

impl Nme {
    /// One picture.
    pub fn push(&mut self, percent: Option<f64>) {
        self.pictures += 1;
        self.errors.extend(percent);
    }

    /// The head of [`Nme::row`].
    pub fn head(report: &mut Report, limit: f64) {
        report.head(&[
            "pictures",
            "n",
            "found %",
            "NME %",
            &format!("AUC to {limit} % in %"),
            &format!("above {limit} % in %"),
        ]);
    }

    /// Mean of the pictures found, area under the CED, share of failures; and the curve.
    pub fn row(&self, report: &mut Report, name: &str, limit: f64) {
        let share = |count: usize| 100.0 * count as f64 / self.pictures.max(1) as f64;
        let good = self.errors.iter().filter(|e| **e <= limit).count();
        report.row(&[
            name.into(),
            self.pictures.to_string(),
            cell(Some(share(self.errors.len()))),
            cell(mean(&self.errors)),
            cell(Some(
                100.0 * area_under_ced(&self.errors, self.pictures, limit),
            )),
            cell(Some(share(self.pictures - good))),
        ]);
        let curve = ced(&self.errors, self.pictures, limit);
        report.curves.push((name.into(), curve));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_without_a_face_are_failures() {
        let mut nme = Nme::default();
        for error in [Some(4.0), Some(12.0), None, Some(2.0)] {
            nme.push(error);
        }
        let mut report = Report::default();
        nme.row(&mut report, "all", 8.0);
        assert_eq!(report.text, "| all | 4 | 75.00 | 6.00 | 31.25 | 50.00 |\n");
        assert_eq!(report.curves[0].1.last(), Some(&(8.0, 0.5)));
    }
}
