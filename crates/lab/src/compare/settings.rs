//! Which tracker, and how.

use super::descriptor::Descriptor;
use super::{bayes, gaussian, synthesis, view_based};
use crate::product;
use std::path::PathBuf;

/// A tracker.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Method {
    /// This product, through its public interface.
    Posewise,
    /// Gaussian models of a synthesised face (thesis 3.2).
    Gaussian,
    /// Codebooks and sparse reconstruction (3.3).
    Sparse,
    /// Gaussian models that are updated on line (3.4).
    Adaptive,
    /// A table from pose to descriptors (4.3).
    ViewBased,
}

impl Method {
    /// All of them.
    pub const ALL: [Method; 5] = [
        Method::Posewise,
        Method::Gaussian,
        Method::Sparse,
        Method::Adaptive,
        Method::ViewBased,
    ];

    /// As on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Method::Posewise => "posewise",
            Method::Gaussian => "gaussian",
            Method::Sparse => "sparse",
            Method::Adaptive => "adaptive",
            Method::ViewBased => "view-based",
        }
    }

    /// Weight of the energy against the prior's, tuned on the clip 04_free (docs/lab.md): the
    /// energies have different units.
    pub fn weight(self) -> f64 {
        match self {
            Method::Posewise => 0.0,
            Method::Gaussian | Method::Adaptive => 300.0,
            Method::Sparse => 400.0,
            Method::ViewBased => 300.0,
        }
    }
}

/// Settings of the comparators.
#[derive(Clone, Debug, clap::Args, serde::Serialize)]
pub struct Settings {
    /// The morphable head.
    #[serde(skip)]
    #[arg(long, default_value = "../shared/data/facekit.npz")]
    pub facekit: PathBuf,
    /// What is read at a landmark.
    #[arg(long, default_value = "gradients")]
    pub descriptor: Descriptor,
    #[command(flatten)]
    pub grid: synthesis::Grid,
    #[command(flatten)]
    pub search: bayes::Search,
    #[command(flatten)]
    pub rates: gaussian::Rates,
    #[command(flatten)]
    pub views: view_based::Views,
    #[serde(skip)]
    #[command(flatten)]
    pub product: product::Options,
    /// Stop after so many frames.
    #[arg(long)]
    pub frames: Option<usize>,
}
