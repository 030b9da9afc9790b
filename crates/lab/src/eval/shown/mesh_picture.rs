//! Rendered heads side by side, with the mesh that was found over them.

use image::imageops::{FilterType, resize};
use image::{GrayImage, Rgb, RgbImage};
use imageproc::drawing::draw_line_segment_mut;
use posewise::mesh::{MeshLine, MeshTopology, MeshVertex};
use std::collections::BTreeSet;

/// Side of a head \[px\].
const SIDE: u32 = 400;

/// Edges of triangles, and loops and lines.
const EDGE: Rgb<u8> = Rgb([110, 150, 205]);
const LINE: Rgb<u8> = Rgb([255, 190, 60]);

/// A vertex is drawn from this visibility on.
const SEEN: f32 = 0.5;

/// A picture of heads in one row.
pub struct Row(RgbImage);

impl Row {
    pub fn new() -> Row {
        Row(RgbImage::new(0, SIDE))
    }

    /// Adds a square picture with the mesh over it.
    pub fn add(&mut self, luma: &GrayImage, mesh: &[MeshVertex], topology: &MeshTopology<'_>) {
        let scale = SIDE as f32 / luma.width() as f32;
        let larger = resize(luma, SIDE, SIDE, FilterType::CatmullRom);
        // Few greys, so that the file stays small.
        let grey = |x: u32, y: u32| larger[(x, y)].0[0] & 0xF0;
        let mut head = RgbImage::from_fn(SIDE, SIDE, |x, y| Rgb([grey(x, y); 3]));
        let mut draw = |pairs: &BTreeSet<(u16, u16)>, color: Rgb<u8>| {
            for (a, b) in pairs {
                let [a, b] = [a, b].map(|v| mesh[usize::from(*v)]);
                if a.visibility.min(b.visibility) > SEEN {
                    // Pixels' centres are at whole numbers, before and after.
                    let at = |v: MeshVertex| [v.x, v.y].map(|p| (p + 0.5) * scale - 0.5);
                    draw_line_segment_mut(&mut head, at(a).into(), at(b).into(), color);
                }
            }
        };
        let pair = |a: u16, b: u16| (a.min(b), a.max(b));
        let edges = topology.triangles.iter();
        let edges = edges.flat_map(|[a, b, c]| [pair(*a, *b), pair(*b, *c), pair(*c, *a)]);
        draw(&edges.collect(), EDGE);
        let lines = MeshLine::ALL
            .iter()
            .skip(1)
            .filter(|line| **line != MeshLine::Edge);
        let lines = lines.flat_map(|line| {
            let vertices = topology.line(*line);
            let is_brow = matches!(line, MeshLine::LeftBrow | MeshLine::RightBrow);
            let back = vertices.first().filter(|_| !is_brow);
            let next = vertices.iter().skip(1).chain(back);
            vertices.iter().zip(next).map(|(a, b)| pair(*a, *b))
        });
        draw(&lines.collect(), LINE);
        let before = self.0.width();
        let wider = RgbImage::from_fn(before + SIDE, SIDE, |x, y| match x < before {
            true => self.0[(x, y)],
            false => head[(x - before, y)],
        });
        self.0 = wider;
    }

    pub fn picture(&self) -> &RgbImage {
        &self.0
    }
}
