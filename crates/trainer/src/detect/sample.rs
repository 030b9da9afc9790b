//! Augmented patches: the pixels of a window on a fixed grid of offsets.

use posewise::detect::{Detection, GRID, Pixel, Window};
use posewise::image::{Crop, Frame, FrameLayout, warp};
use posewise::math::Similarity;
use rand::Rng;
use rand_chacha::ChaCha8Rng;

use super::faces::Face;
use super::options::SIDE_Q8;

/// Pixels of a patch.
pub const PATCH: usize = GRID * GRID;

/// The window of a face.
pub fn window(at: &Detection) -> Window {
    let q4 = |v: f32| (v * 16.0).round() as i32;
    Window::new(
        q4(at.x),
        q4(at.y),
        q4(at.size * SIDE_Q8 as f32 / 256.0),
        at.roll,
    )
}

/// Appends the window's patch.
pub fn cut(frame: &Frame<'_>, window: &Window, out: &mut Vec<u8>) {
    out.extend((0..PATCH).map(|pixel| window.read(frame, pixel as Pixel)));
}

/// Largest deviations of a window from the face.
#[derive(Clone, Copy, Debug)]
pub struct Jitter {
    /// Of the centre along each axis, over size.
    pub shift: f32,
    /// Of the log of the size.
    pub log_size: f32,
    /// \[rad\]
    pub roll: f32,
}

impl Jitter {
    /// Half a step of the grid each way, and a little more.
    pub const SCAN: Jitter = Jitter {
        shift: 0.07,
        log_size: 0.10,
        roll: 0.28,
    };
    /// The errors of merged hits, and those left after refinement.
    pub const REFINE: Jitter = Jitter {
        shift: 0.14,
        log_size: 0.18,
        roll: 0.36,
    };

    /// A window near the face.
    pub fn draw(&self, truth: &Detection, rng: &mut ChaCha8Rng) -> Detection {
        let mut within = |limit: f32| rng.random_range(-limit..=limit);
        Detection {
            x: truth.x + truth.size * within(self.shift),
            y: truth.y + truth.size * within(self.shift),
            size: truth.size * within(self.log_size).exp(),
            roll: truth.roll + within(self.roll),
            ..*truth
        }
    }
}

/// Calls `with` on a changed picture of the face (scaled, blurred) and on where the face is there.
pub fn with_view<T>(
    face: &Face,
    rng: &mut ChaCha8Rng,
    with: impl FnOnce(&Frame<'_>, &Detection, &mut ChaCha8Rng) -> T,
) -> T {
    let frame = face.picture.frame();
    if rng.random_bool(0.35) {
        return with(&frame, &face.truth, rng);
    }
    const SIDE: usize = 124;
    let size: f32 = rng.random_range(26.0f32.ln()..54.0f32.ln()).exp();
    let scale = face.truth.size / size;
    let centre = (SIDE as f32 - 1.0) / 2.0;
    let to_frame = Similarity {
        a: scale,
        b: 0.0,
        tx: face.truth.x - scale * centre,
        ty: face.truth.y - scale * centre,
    };
    let mut crop = Box::new(Crop::new());
    warp(&frame, &to_frame, SIDE, &mut crop);
    let mut luma = crop.luma().to_vec();
    if rng.random_bool(0.3) {
        blur(&mut luma, SIDE, rng);
    }
    let layout = FrameLayout::grey(SIDE as u32, SIDE as u32);
    let small = Frame::new(&layout, &luma).expect("a crop is a frame");
    let truth = Detection {
        x: centre,
        y: centre,
        size,
        ..face.truth
    };
    with(&small, &truth, rng)
}

/// Mean over a short line: defocus or motion, whichever way it falls.
fn blur(luma: &mut [u8], side: usize, rng: &mut ChaCha8Rng) {
    let source = luma.to_vec();
    let taps = rng.random_range(2..=3usize);
    let step = match rng.random_range(0..4) {
        0 => 1,
        1 => side,
        2 => side + 1,
        _ => side - 1,
    };
    for (i, pixel) in luma.iter_mut().enumerate() {
        let sum: usize = (0..taps)
            .map(|k| source[(i + k * step).min(source.len() - 1)] as usize)
            .sum();
        *pixel = (sum / taps) as u8;
    }
}

/// Light, contrast, noise and occluders on a patch: changes after which a face is still a face.
pub fn disturb(patch: &mut [u8], rng: &mut ChaCha8Rng, occlude: bool) {
    // Every fifth looks as at night, in haze or against the light.
    let dim = rng.random_bool(0.2);
    let contrast = if dim {
        rng.random_range(0.1f32.ln()..0.4f32.ln()).exp()
    } else {
        rng.random_range(0.4f32..1.35)
    };
    let middle = if dim && rng.random_bool(0.5) {
        128.0 * contrast
    } else {
        rng.random_range(60.0f32..190.0)
    };
    let (gx, gy) = if rng.random_bool(0.4) {
        (
            rng.random_range(-0.4f32..0.4),
            rng.random_range(-0.3f32..0.3),
        )
    } else {
        (0.0, 0.0)
    };
    let sigma = match rng.random_range(0..10) {
        0..3 => 0.0,
        3..9 => rng.random_range(0.0f32..6.0) * contrast.max(0.5),
        _ => rng.random_range(6.0f32..24.0) * contrast,
    };
    let covered = (occlude && rng.random_bool(0.07)).then(|| {
        let (w, h) = (rng.random_range(8..20), rng.random_range(8..18));
        let x = rng.random_range(0..GRID - w);
        let y = rng.random_range(GRID / 4..GRID - h / 2);
        (x, y, w, h, rng.random_range(20.0f32..230.0))
    });
    for (i, pixel) in patch.iter_mut().enumerate() {
        let (x, y) = (i % GRID, i / GRID);
        let across = |v: usize| v as f32 / GRID as f32 - 0.5;
        let mut v = *pixel as f32;
        if let Some((x0, y0, w, h, level)) = covered
            && (x0..x0 + w).contains(&x)
            && (y0..y0 + h).contains(&y)
        {
            v = level + 0.1 * (v - 128.0);
        }
        v = (v - 128.0) * contrast + middle;
        v *= 1.0 + gx * across(x) + gy * across(y);
        *pixel = (v + sigma * gauss(rng)).clamp(0.0, 255.0) as u8;
    }
}

/// Roughly normal, unit variance: a sum of four bytes.
fn gauss(rng: &mut ChaCha8Rng) -> f32 {
    let bytes = rng.random::<u32>().to_le_bytes();
    let sum: f32 = bytes.iter().map(|b| *b as f32).sum();
    // Four uniform bytes: mean 510, standard deviation 147.8.
    (sum - 510.0) / 147.8
}
