//! Simulated video: scenes, one after the other, in frames of any size and format.

use crate::common::random::Random;
use crate::common::watch::{HEIGHT, Pasted, WIDTH, dimmed, picture};
use crate::common::{Clip, demo, unpacked};
use crate::ffi::types::*;
use crate::targets::memory::Exact;
use std::path::Path;

/// The clips that are shown.
pub struct Library {
    demo: &'static Clip,
    others: Vec<Clip>,
}

impl Library {
    /// The clip of the repository, and those of a folder.
    pub fn new(folder: Option<&Path>) -> Library {
        let mut paths: Vec<_> = (folder.into_iter())
            .flat_map(|folder| std::fs::read_dir(folder).expect("a folder of clips"))
            .map(|entry| entry.expect("an entry").path())
            .filter(|path| path.to_string_lossy().ends_with(".y4m.gz"))
            .collect();
        paths.sort();
        let others = paths.iter().filter_map(|path| unpacked(path)).collect();
        let demo = demo();
        Library { demo, others }
    }
}

/// What a scene shows.
#[derive(Clone, Copy)]
enum Content {
    /// A clip as it is: the demo clip, or another one.
    Clip(usize),
    /// One or two faces of the demo clip, that move.
    Faces([Pasted; 2], usize),
    /// Levels that change slowly over the picture, or not at all.
    Smooth,
    /// Every pixel is random.
    Noise,
    /// Blocks of random levels: edges everywhere.
    Blocks(usize),
}

/// What lies over it.
#[derive(Clone, Copy)]
enum Trouble {
    None,
    /// So little light, and noise of the sensor.
    Dark(f32, f32),
    /// A grey bar that wanders through the picture.
    Bar,
}

/// Some seconds of the same kind.
pub struct Scene {
    content: Content,
    trouble: Trouble,
    seed: u64,
    pub width: usize,
    pub height: usize,
    pub frames: usize,
    /// Time from frame to frame \[µs\].
    pub interval_us: i64,
    layout: Layout,
}

impl Scene {
    pub fn new(random: &mut Random, library: &Library) -> Scene {
        let content = match random.below(16) {
            0..5 => Content::Clip(random.below(library.others.len() + 1)),
            5..10 => {
                let mut face = || Pasted {
                    scale: 0.5 + 2.0 * random.unit(),
                    at: [random.unit() * WIDTH as f32, random.unit() * HEIGHT as f32],
                };
                let faces = [face(), face()];
                Content::Faces(faces, 1 + random.below(2))
            }
            10..12 => Content::Smooth,
            12..14 => Content::Noise,
            _ => Content::Blocks(1 + random.below(40)),
        };
        let any = 1 + random.below(400);
        let (width, height) = match content {
            Content::Clip(n) => size(library.clip(n)),
            Content::Faces(..) => (WIDTH, HEIGHT),
            _ => [(320, 240), (640, 480), (56, 48), (any, 400 / any + 60)][random.below(4)],
        };
        let trouble = match random.below(8) {
            0 => Trouble::Dark(0.05 + random.unit() * 0.5, random.unit() * 60.0),
            1 => Trouble::Bar,
            _ => Trouble::None,
        };
        Scene {
            content,
            trouble,
            seed: random.next(),
            width,
            height,
            frames: 20 + random.below(200),
            interval_us: [16_667, 33_333, 40_000, 66_667, 200_000][random.below(5)],
            layout: Layout::new(random),
        }
    }

    /// Luma of a frame.
    fn luma(&self, frame: usize, library: &Library) -> Vec<u8> {
        let (w, h) = (self.width, self.height);
        let mut random = Random(self.seed ^ frame as u64);
        let mut luma = match self.content {
            Content::Clip(n) => {
                let clip = library.clip(n);
                let at = (self.seed as usize % 1000 + frame) % clip.luma.len();
                clip.luma[at].clone()
            }
            Content::Faces(faces, count) => {
                let moved = faces.map(|mut face| {
                    face.at[0] += 60.0 * (frame as f32 / 20.0 + face.scale).sin();
                    face
                });
                picture(library.demo, frame, &moved[..count])
            }
            Content::Smooth => {
                let (dx, dy) = (self.seed as usize % 5, self.seed as usize / 5 % 5);
                let level = |i: usize| ((i % w * dx + i / w * dy) / 8 + frame) as u8;
                (0..w * h).map(level).collect()
            }
            Content::Noise => (0..w * h).map(|_| random.next() as u8).collect(),
            Content::Blocks(side) => {
                let mixed = |i: usize| Random(self.seed ^ (i as u64) << 20).next() as u8;
                let block = |i: usize| mixed((i % w + frame) / side + i / w / side * 1000);
                (0..w * h).map(block).collect()
            }
        };
        match self.trouble {
            Trouble::None => {}
            Trouble::Dark(light, noise) => dimmed(&mut luma, light, noise, frame),
            Trouble::Bar => {
                let from = frame * 5 % w;
                for row in luma.chunks_exact_mut(w) {
                    row[from..(from + w / 4).min(w)].fill(120);
                }
            }
        }
        luma
    }

    /// A frame as a camera delivers it, without a timestamp.
    pub fn frame(&self, number: usize, library: &Library) -> Picture {
        let luma = self.luma(number, library);
        self.layout.picture(&luma, self.width, self.height)
    }
}

fn size(clip: &Clip) -> (usize, usize) {
    (clip.width, clip.height)
}

impl Library {
    fn clip(&self, index: usize) -> &Clip {
        match index {
            0 => self.demo,
            n => &self.others[n - 1],
        }
    }
}

/// Formats, and the bytes of a pixel of this level.
const FORMATS: [(u32, usize); 5] = [
    (POSEWISE_FMT_GREY, 1),
    (POSEWISE_FMT_NV12, 1),
    (POSEWISE_FMT_YUYV, 2),
    (POSEWISE_FMT_BGR3, 3),
    (POSEWISE_FMT_RA24, 4),
];

/// How pictures lie in memory.
struct Layout {
    format: u32,
    pixel: usize,
    padding: usize,
    mirrored: bool,
    rotation_deg: u32,
}

impl Layout {
    fn new(random: &mut Random) -> Layout {
        let index = random.below(2 * FORMATS.len());
        let (format, pixel) = FORMATS.get(index).copied().unwrap_or(FORMATS[0]);
        Layout {
            format,
            pixel,
            padding: random.below(3) * 5,
            mirrored: random.once_in(4),
            rotation_deg: match random.once_in(8) {
                true => 90 * random.below(4) as u32,
                false => 0,
            },
        }
    }

    /// In memory that ends with the last row.
    fn picture(&self, luma: &[u8], width: usize, height: usize) -> Picture {
        let row = width * self.pixel;
        let stride = row + self.padding;
        let mut data = Exact::new(stride * (height - 1) + row, 1, 9);
        let rows = data.get_mut().chunks_mut(stride);
        for (row, levels) in rows.zip(luma.chunks_exact(width)) {
            for (pixel, level) in row.chunks_exact_mut(self.pixel).zip(levels) {
                pixel.fill(*level);
            }
        }
        Picture {
            frame: posewise_frame {
                struct_size: size_of::<posewise_frame>() as u32,
                format: self.format,
                timestamp_us: 0,
                width: width as u32,
                height: height as u32,
                stride: stride as u32,
                rotation_deg: self.rotation_deg,
                flags: u32::from(self.mirrored) * POSEWISE_FRAME_MIRRORED,
                reserved: 0,
                data_len: data.get().len(),
                data: data.ptr(),
            },
            before: data.get().to_vec(),
            data,
        }
    }
}

/// A frame and its memory.
pub struct Picture {
    pub frame: posewise_frame,
    before: Vec<u8>,
    data: Exact,
}

impl Picture {
    /// Width and height of the upright picture.
    pub fn upright(&self) -> [u32; 2] {
        match self.frame.rotation_deg % 180 {
            0 => [self.frame.width, self.frame.height],
            _ => [self.frame.height, self.frame.width],
        }
    }

    pub fn is_whole(&self) -> bool {
        self.data.get() == self.before
    }
}
