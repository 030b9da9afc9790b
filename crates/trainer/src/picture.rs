//! Grey pictures in memory.

use anyhow::{Context, Result};
use posewise::image::{Crop, Frame, FrameLayout, warp};
use posewise::math::Similarity;
use std::path::{Path, PathBuf};

/// A grey picture.
#[derive(Clone)]
pub struct Picture {
    /// Width and height \[px\].
    pub size: [u32; 2],
    /// Row-major luma.
    pub luma: Vec<u8>,
}

impl Picture {
    /// The picture as the core sees it.
    pub fn frame(&self) -> Frame<'_> {
        let layout = FrameLayout::grey(self.size[0], self.size[1]);
        Frame::new(&layout, &self.luma).expect("a picture is as large as it says")
    }

    /// Picture files of a folder, in the order of their names.
    pub fn list(folder: &Path) -> Result<Vec<PathBuf>> {
        let list = std::fs::read_dir(folder);
        let list = list.with_context(|| format!("reading {}", folder.display()))?;
        let mut paths: Vec<PathBuf> = list.map(|f| Ok(f?.path())).collect::<Result<_>>()?;
        paths.retain(|p| p.extension().is_some_and(|e| e == "jpg" || e == "png"));
        paths.sort();
        Ok(paths)
    }

    /// Reads a picture file as luma (BT.601).
    pub fn read(path: &Path) -> Result<Picture> {
        let image = image::open(path).with_context(|| format!("reading {}", path.display()))?;
        let grey = image.to_luma8();
        Ok(Picture {
            size: [grey.width(), grey.height()],
            luma: grey.into_raw(),
        })
    }

    /// Left and right exchanged.
    pub fn mirrored(&self) -> Picture {
        let rows = self.luma.chunks_exact(self.size[0] as usize);
        Picture {
            size: self.size,
            luma: rows.flat_map(|row| row.iter().rev().copied()).collect(),
        }
    }

    /// Turned clockwise by a quarter.
    pub fn turned(&self) -> Picture {
        let [w, h] = self.size;
        let column = |x| self.luma[x..].iter().step_by(w as usize).rev().copied();
        Picture {
            size: [h, w],
            luma: (0..w as usize).flat_map(column).collect(),
        }
    }

    /// In all eight orientations.
    pub fn orientations(&self) -> Vec<Picture> {
        let mut all = vec![self.clone()];
        (0..3).for_each(|k| all.push(all[k].turned()));
        all.extend(all.iter().map(Picture::mirrored).collect::<Vec<_>>());
        all
    }

    /// A square crop of `side` px around the origin of `to_frame`, row by row.
    pub fn crop(&self, to_frame: &Similarity, side: usize, mirror: bool) -> Vec<f32> {
        let centre = (side as f32 - 1.0) / 2.0;
        let [tx, ty] = to_frame.apply([-centre, -centre]);
        let mut crop = Crop::new();
        let from_corner = Similarity {
            tx,
            ty,
            ..*to_frame
        };
        warp(&self.frame(), &from_corner, side, &mut crop);
        if mirror {
            crop.mirror();
        }
        crop.luma().iter().map(|v| f32::from(*v)).collect()
    }

    /// Luma between pixels; beyond the edge, that of the edge.
    pub fn at(&self, [x, y]: [f32; 2]) -> f32 {
        let [width, height] = self.size.map(|side| side as usize);
        let place = |v: f32, side: usize| {
            let v = v.clamp(0.0, side as f32 - 1.0);
            let first = v as usize;
            (first, (first + 1).min(side - 1), v - first as f32)
        };
        let ((left, right, u), (top, bottom, v)) = (place(x, width), place(y, height));
        let along = |row: usize| {
            let [a, b] = [left, right].map(|column| f32::from(self.luma[row * width + column]));
            a + u * (b - a)
        };
        let [upper, lower] = [along(top), along(bottom)];
        upper + v * (lower - upper)
    }

    /// Each pixel the mean of 2×2.
    pub fn halved(&self) -> Picture {
        let [width, height] = self.size.map(|side| (side / 2).max(1));
        let frame = self.frame();
        let luma = (0..height as i32)
            .flat_map(|y| (0..width as i32).map(move |x| (2 * x, 2 * y)))
            .map(|(x, y)| {
                let at = |dx, dy| frame.luma(x + dx, y + dy) as u32;
                ((at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1) + 2) / 4) as u8
            })
            .collect();
        Picture {
            size: [width, height],
            luma,
        }
    }

    /// Each pixel the mean of (2 radius + 1)².
    pub fn blurred(&self, radius: i32) -> Picture {
        let frame = self.frame();
        let area = ((2 * radius + 1) * (2 * radius + 1)) as u32;
        let [width, height] = self.size.map(|side| side as i32);
        let luma = (0..height)
            .flat_map(|y| (0..width).map(move |x| (x, y)))
            .map(|(x, y)| {
                let sum: u32 = (-radius..=radius)
                    .flat_map(|dy| (-radius..=radius).map(move |dx| (dx, dy)))
                    .map(|(dx, dy)| frame.luma(x + dx, y + dy) as u32)
                    .sum();
                (sum / area) as u8
            })
            .collect();
        Picture {
            size: self.size,
            luma,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_has_eight_orientations() {
        let picture = Picture {
            size: [3, 2],
            luma: vec![1, 2, 3, 4, 5, 6],
        };
        let turned = picture.turned();
        assert_eq!(
            (turned.size, &turned.luma[..]),
            ([2, 3], &[4, 1, 5, 2, 6, 3][..])
        );
        let mut all = picture.orientations();
        all.sort_by(|a, b| (a.size, &a.luma).cmp(&(b.size, &b.luma)));
        all.dedup_by(|a, b| a.luma == b.luma && a.size == b.size);
        assert_eq!(all.len(), 8);
    }
}
