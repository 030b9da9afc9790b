//! The camera: defocus, motion blur, exposure, noise, compression.

use crate::picture::Picture;
use image::codecs::jpeg::{JpegDecoder, JpegEncoder};
use image::{DynamicImage, ExtendedColorType};
use rand::Rng;
use rand_chacha::ChaCha8Rng;

/// What a camera does to light.
#[derive(Clone, Debug)]
pub struct Camera {
    /// Defocus: sigma of a Gaussian \[px\].
    pub blur_px: f32,
    /// Motion during the exposure (x, y) \[px\].
    pub motion_px: (f32, f32),
    /// Factor on linear light.
    pub exposure: f32,
    /// Exponent of the response; 1/2.2 is the usual.
    pub gamma: f32,
    /// Lifts black (haze), 0..1.
    pub haze: f32,
    /// Sigma of the noise \[grey levels\].
    pub noise: f32,
    /// JPEG quality; `None` leaves the picture as it is.
    pub jpeg: Option<u8>,
}

impl Picture {
    /// As a camera shows it.
    pub fn through(&self, camera: &Camera, rng: &mut ChaCha8Rng) -> Picture {
        let mut light = self.luma.iter().map(|v| *v as f32 / 255.0).collect();
        Picture {
            size: self.size,
            luma: camera.develop(rng, &mut light, self.size[0] as usize),
        }
    }
}

impl Camera {
    /// A random camera for a face of this width \[px\] and mean linear light; `defects`
    /// scales blur and noise.
    pub fn random(rng: &mut ChaCha8Rng, face_px: f32, face_light: f32, defects: f32) -> Camera {
        let blur = rng.random_range(0.0..1.0f32).powi(2) * 0.018 * defects * face_px;
        let motion = if rng.random_bool(0.2) {
            rng.random_range(0.0..0.09) * defects * face_px
        } else {
            0.0
        };
        let (s, c) = rng.random_range(0.0..std::f32::consts::TAU).sin_cos();
        let gamma = 1.0 / rng.random_range(1.7..2.6f32);
        // Expose the face anywhere from dim to bright.
        let grey = rng
            .random_range(0.2..0.72f32)
            .max(rng.random_range(0.2..0.6));
        Camera {
            blur_px: blur.max(0.25),
            motion_px: (motion * c, motion * s),
            exposure: grey.powf(1.0 / gamma) / face_light.max(0.004),
            gamma,
            haze: if rng.random_bool(0.3) {
                rng.random_range(0.0..0.2)
            } else {
                0.0
            },
            noise: rng.random_range(0.0..1.0f32).powi(2) * 11.0 * defects,
            jpeg: rng.random_bool(0.4).then(|| rng.random_range(25..92)),
        }
    }

    /// A camera at night, in haze, out of focus, moving or with strong compression; its defects are
    /// scaled to a face of this width \[px\].
    pub fn poor(rng: &mut ChaCha8Rng, face_px: f32) -> Camera {
        let mut up_to = |share: f64, most: f32| match rng.random_bool(share) {
            true => rng.random_range(0.0..most),
            false => 0.0,
        };
        let dark = up_to(0.5, 3.0);
        let haze = up_to(0.3, 0.85);
        let blur_px = up_to(0.4, 0.06) * face_px;
        let motion = up_to(0.3, 0.12) * face_px;
        let (s, c) = rng.random_range(0.0..std::f32::consts::TAU).sin_cos();
        let exposure = (-dark).exp();
        // Dark pictures show the quantisation of their levels and of the sensor's amplifier.
        let noise = 25.0 * (exposure * (1.0 - haze)).max(0.12);
        Camera {
            blur_px,
            motion_px: (motion * c, motion * s),
            exposure,
            gamma: 1.0,
            haze,
            noise: rng.random_range(0.0..1.0f32).powi(2) * noise,
            jpeg: rng.random_bool(0.3).then(|| rng.random_range(10..60)),
        }
    }

    /// Light in, 8-bit luma out.
    pub fn develop(&self, rng: &mut ChaCha8Rng, light: &mut Vec<f32>, width: usize) -> Vec<u8> {
        blur(light, width, self.blur_px);
        motion_blur(light, width, self.motion_px);
        let luma = light
            .iter()
            .map(|l| {
                let v = (l * self.exposure).max(0.0).powf(self.gamma);
                // A soft shoulder instead of hard clipping.
                let v = if v > 0.8 {
                    0.8 + 0.2 * (1.0 - (-(v - 0.8) * 5.0).exp())
                } else {
                    v
                };
                let v = self.haze + (1.0 - self.haze) * v;
                // The sum of four uniforms approximates a Gaussian.
                let n: f32 = (0..4).map(|_| rng.random_range(-0.866..0.866f32)).sum();
                (255.0 * v + self.noise * n + 0.5).clamp(0.0, 255.0) as u8
            })
            .collect();
        match self.jpeg {
            Some(quality) => compress(luma, width, quality),
            None => luma,
        }
    }
}

/// A separable Gaussian.
fn blur(light: &mut [f32], width: usize, sigma: f32) {
    if sigma < 0.2 {
        return;
    }
    let radius = (2.5 * sigma).ceil() as i32;
    let mut kernel: Vec<f32> = (-radius..=radius)
        .map(|k| (-0.5 * (k as f32 / sigma).powi(2)).exp())
        .collect();
    let sum: f32 = kernel.iter().sum();
    kernel.iter_mut().for_each(|k| *k /= sum);
    let height = light.len() / width;
    let mut rows = vec![0.0; light.len()];
    for (out, row) in rows.chunks_exact_mut(width).zip(light.chunks_exact(width)) {
        for (x, o) in out.iter_mut().enumerate() {
            let at = |k: usize| (x as i32 + k as i32 - radius).clamp(0, width as i32 - 1) as usize;
            *o = kernel.iter().enumerate().map(|(k, w)| w * row[at(k)]).sum();
        }
    }
    light.fill(0.0);
    for (y, out) in light.chunks_exact_mut(width).enumerate() {
        for (k, w) in kernel.iter().enumerate() {
            let from = (y as i32 + k as i32 - radius).clamp(0, height as i32 - 1) as usize;
            let row = &rows[from * width..][..width];
            out.iter_mut().zip(row).for_each(|(o, r)| *o += w * r);
        }
    }
}

/// Averages along a line, centred so that nothing moves.
fn motion_blur(light: &mut Vec<f32>, width: usize, motion: (f32, f32)) {
    let length = motion.0.hypot(motion.1);
    if length < 0.7 {
        return;
    }
    let height = light.len() / width;
    let taps = length.ceil() as i32 + 1;
    let mut out = vec![0.0; light.len()];
    for k in 0..taps {
        let t = k as f32 / (taps - 1) as f32 - 0.5;
        let (dx, dy) = ((motion.0 * t).round() as i32, (motion.1 * t).round() as i32);
        for (y, row) in out.chunks_exact_mut(width).enumerate() {
            let from = (y as i32 + dy).clamp(0, height as i32 - 1) as usize;
            let from = &light[from * width..][..width];
            for (x, o) in row.iter_mut().enumerate() {
                *o += from[(x as i32 + dx).clamp(0, width as i32 - 1) as usize];
            }
        }
    }
    out.iter_mut().for_each(|o| *o /= taps as f32);
    *light = out;
}

/// Encodes and decodes as JPEG; a picture that cannot be coded is returned as it was.
fn compress(luma: Vec<u8>, width: usize, quality: u8) -> Vec<u8> {
    let height = luma.len() / width;
    let mut bytes = Vec::new();
    let coded = JpegEncoder::new_with_quality(&mut bytes, quality).encode(
        &luma,
        width as u32,
        height as u32,
        ExtendedColorType::L8,
    );
    let decoded = coded.and_then(|()| JpegDecoder::new(std::io::Cursor::new(&bytes)));
    match decoded.and_then(DynamicImage::from_decoder) {
        Ok(picture) if picture.width() as usize == width => picture.to_luma8().into_raw(),
        _ => luma,
    }
}
