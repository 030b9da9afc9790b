//! Settings of `posewise-lab driver-clips`.

use super::super::Material;
use std::path::PathBuf;

/// Settings of `posewise-lab driver-clips`.
#[derive(Clone, Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    pub material: Material,
    /// Where clips (.y4m.gz), truths (.csv) and descriptions (.json) go. A clip whose description
    /// is there and agrees is not rendered again.
    #[arg(long)]
    pub out: PathBuf,
    /// Render only clips whose names begin with one of these; repeat for several.
    #[arg(long)]
    pub only: Vec<String>,
    /// Length of each clip \[s\].
    #[arg(long, default_value_t = 60)]
    pub seconds: usize,
    /// Frames per second.
    #[arg(long, default_value_t = 25)]
    pub fps: usize,
    /// Width of the frames, 4 : 3 \[px\].
    #[arg(long, default_value_t = 480)]
    pub width: usize,
}
