//! Which tracker, and how.

use super::descriptor::Descriptor;
use super::{bayes, face_model, gaussian, synthesis, view_based};
use crate::product;
use serde::Serialize;
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
    /// A table from pose to descriptors (4.3), with wide-baseline matching (4.2).
    ViewBased,
    /// Pose-wise SVM templates (4.4).
    Svm,
    /// A regression cascade on RBM features (5.1).
    Cascade,
    /// The cascade, then the templates (5.2).
    Hybrid,
}

impl Method {
    /// All of them.
    pub const ALL: [Method; 8] = [
        Method::Posewise,
        Method::Gaussian,
        Method::Sparse,
        Method::Adaptive,
        Method::ViewBased,
        Method::Svm,
        Method::Cascade,
        Method::Hybrid,
    ];

    /// As on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Method::Posewise => "posewise",
            Method::Gaussian => "gaussian",
            Method::Sparse => "sparse",
            Method::Adaptive => "adaptive",
            Method::ViewBased => "view-based",
            Method::Svm => "svm",
            Method::Cascade => "cascade",
            Method::Hybrid => "hybrid",
        }
    }

    /// Whether it learns from other faces beforehand.
    pub fn is_trained(self) -> bool {
        matches!(self, Method::Svm | Method::Cascade | Method::Hybrid)
    }

    /// Whether frames are matched with keyframes (thesis 4.2): each one, or after a loss.
    pub fn matches_keyframes(self) -> bool {
        matches!(self, Method::ViewBased | Method::Svm | Method::Hybrid)
    }

    /// Weight of the energy against the prior's, as the energies have different units. Tuned on the
    /// clip 04_free, that of `Sparse` on four others (docs/dev/lab.md).
    pub fn weight(self) -> f64 {
        match self {
            Method::Posewise | Method::Svm | Method::Cascade | Method::Hybrid => 0.0,
            Method::Gaussian | Method::Adaptive => 300.0,
            Method::Sparse => 30.0,
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
    /// The 3D face of the comparators.
    #[serde(skip_serializing_if = "face_model::Kind::is_morphable")]
    #[arg(long, default_value = "morphable")]
    pub face_model: face_model::Kind,
    /// Candide-3's wireframe (`--face-model candide`).
    #[serde(skip)]
    #[arg(long, default_value = "../shared/data/candide3.wfm")]
    pub candide: PathBuf,
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
    /// Match no keyframes (`view-based`, `svm`, `hybrid`).
    #[arg(long)]
    pub no_keyframes: bool,
    #[command(flatten)]
    pub training: TrainingOptions,
    #[serde(skip)]
    #[command(flatten)]
    pub product: product::Options,
    /// Stop after this number of frames.
    #[arg(long)]
    pub frames: Option<usize>,
}

/// What `svm`, `cascade` and `hybrid` learn from, and where that is kept.
#[derive(Clone, Debug, clap::Args, Serialize)]
pub struct TrainingOptions {
    /// Folder of what `svm`, `cascade` and `hybrid` have learned; they learn where it is not there.
    #[serde(skip)]
    #[arg(long, default_value = "cache/comparators")]
    pub trained: PathBuf,
    /// Learn from this file of `posewise-train render`; without it faces are rendered.
    #[arg(long)]
    pub renders: Option<PathBuf>,
    /// Learn from the photographs of this folder too: labels in `train.csv`, pictures in `train/`.
    #[arg(long)]
    pub photographs: Option<PathBuf>,
    /// Number of rendered faces that templates learn from.
    #[arg(long, default_value_t = 3000)]
    pub training_faces: usize,
    /// Number of rendered faces that the cascade learns from.
    #[arg(long, default_value_t = 3000)]
    pub cascade_faces: usize,
}
