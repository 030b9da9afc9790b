//! `cargo xtask picture`: the picture in `README.md`, from frames of the demo clip.

use std::process::Command;

use anyhow::{Context, Result, ensure};

use crate::root;

/// Three of the six frames of `posewise demo`'s picture, side by side, larger, and in few colours,
/// so that the file stays small.
const FILTER: &str = "split=3[a][b][c]; \
    [a]crop=240:228:360:12,pad=242:228:0:0:white[x]; \
    [b]crop=240:228:360:252,pad=242:228:0:0:white[y]; \
    [c]crop=240:228:680:252[z]; \
    [x][y][z]hstack=3,scale=iw*3/2:-1:flags=lanczos,split[s][t]; \
    [s]palettegen=max_colors=128[p]; [t][p]paletteuse=dither=none";

/// Writes `docs/tracked.png`; needs ffmpeg.
pub fn write() -> Result<()> {
    let folder = root().join("target/picture");
    std::fs::create_dir_all(&folder)?;
    let manifest = root().join("Cargo.toml");
    let mut demo = Command::new("cargo");
    demo.args([
        "run",
        "--release",
        "--quiet",
        "--bin",
        "posewise",
        "--manifest-path",
    ]);
    demo.arg(manifest).arg("demo").current_dir(&folder);
    ensure!(
        demo.status().context("cargo")?.success(),
        "posewise demo failed"
    );
    let mut ffmpeg = Command::new("ffmpeg");
    ffmpeg
        .args(["-v", "error", "-y", "-i"])
        .arg(folder.join("posewise-demo.png"));
    ffmpeg
        .args(["-filter_complex", FILTER])
        .arg(root().join("docs/tracked.png"));
    ensure!(
        ffmpeg.status().context("ffmpeg")?.success(),
        "ffmpeg failed"
    );
    Ok(())
}
