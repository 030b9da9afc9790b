//! A contact sheet of rendered samples: pictures with their landmarks, to be looked at.

use super::cache;
use anyhow::{Context, Result};
use image::{Rgb, RgbImage};
use std::path::{Path, PathBuf};

/// Settings of `posewise-train sheet`.
#[derive(Clone, Debug, clap::Args)]
pub struct Args {
    /// A file of renders, whose path `posewise-train render` prints.
    #[arg(long)]
    pub renders: PathBuf,
    /// The picture to write.
    #[arg(long, default_value = "sheet.png")]
    pub out: PathBuf,
    /// Samples on it, and in a row.
    #[arg(long, default_value_t = 60)]
    pub count: usize,
    /// Samples in a row.
    #[arg(long, default_value_t = 10)]
    pub columns: usize,
}

/// Side of a tile \[px\].
const TILE: u32 = 160;
const SEEN: Rgb<u8> = Rgb([60, 255, 60]);
const HIDDEN: Rgb<u8> = Rgb([255, 60, 60]);

/// Draws the sheet: seen landmarks green, hidden ones red.
pub fn run(args: &Args) -> Result<()> {
    let samples = cache::read(&args.renders, args.count)?;
    let columns = args.columns.max(1);
    let rows = samples.len().div_ceil(columns);
    let mut sheet = RgbImage::new(columns as u32 * TILE, rows as u32 * TILE);
    for (at, sample) in samples.iter().enumerate() {
        let corner = [(at % columns) as u32 * TILE, (at / columns) as u32 * TILE];
        let scale = TILE as f32 / sample.width.max(sample.height) as f32;
        for y in 0..TILE {
            for x in 0..TILE {
                let from = |v: u32| (v as f32 / scale) as usize;
                let (u, v) = (from(x), from(y));
                if u < sample.width && v < sample.height {
                    let grey = sample.luma[v * sample.width + u];
                    sheet.put_pixel(corner[0] + x, corner[1] + y, Rgb([grey; 3]));
                }
            }
        }
        for (p, seen) in sample.landmarks.iter().zip(sample.visible) {
            let [x, y] = [p.x, p.y].map(|v| (v * scale).round());
            let inside = |v: f32| (0.0..TILE as f32).contains(&v);
            if inside(x) && inside(y) {
                let colour = if seen { SEEN } else { HIDDEN };
                sheet.put_pixel(corner[0] + x as u32, corner[1] + y as u32, colour);
            }
        }
    }
    write(&sheet, &args.out)
}

fn write(sheet: &RgbImage, path: &Path) -> Result<()> {
    sheet
        .save(path)
        .with_context(|| format!("writing {}", path.display()))
}
