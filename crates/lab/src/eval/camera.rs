//! What a poor camera makes of a picture, for `posewise-lab eval`: defocus, dim light, haze, noise.

use image::GrayImage;
use imageproc::{filter::gaussian_blur_f32, map::map_subpixels_mut, noise::gaussian_noise_mut};
use posewise_cli::parse::within;

/// Defects of a poor camera, applied to the pictures in this order.
#[derive(clap::Args, Clone, Copy)]
pub struct Args {
    /// Blur the pictures: sigma of a Gaussian [px]
    #[arg(long, value_name = "PX", default_value_t = 0.0,
        value_parser = within(0.0, 100.0))]
    pub blur: f64,
    /// Leave this share of their contrast, as haze does
    #[arg(long, value_name = "F", default_value_t = 1.0, value_parser = within(0.0, 1.0))]
    pub contrast: f64,
    /// Multiply their grey levels: 0.15 is a dim room
    #[arg(long, value_name = "F", default_value_t = 1.0, value_parser = within(0.0, 100.0))]
    pub gain: f64,
    /// Add noise of this deviation [grey levels]
    #[arg(long, value_name = "SIGMA", default_value_t = 0.0,
        value_parser = within(0.0, 255.0))]
    pub noise: f64,
}

/// The grey level that haze draws everything towards.
const HAZE: f64 = 110.0;

/// A camera without defects.
pub const GOOD: Args = Args {
    gain: 1.0,
    contrast: 1.0,
    blur: 0.0,
    noise: 0.0,
};

/// The picture as that camera shows it; another `seed` gives other noise.
pub fn through(args: &Args, mut picture: GrayImage, seed: u64) -> GrayImage {
    if args.blur > 0.0 {
        picture = gaussian_blur_f32(&picture, args.blur as f32);
    }
    if args.gain != 1.0 || args.contrast != 1.0 {
        map_subpixels_mut(&mut picture, |v| {
            let hazy = HAZE + args.contrast * (f64::from(v) - HAZE);
            (args.gain * hazy).round().clamp(0.0, 255.0) as u8
        });
    }
    if args.noise > 0.0 {
        gaussian_noise_mut(&mut picture, 0.0, args.noise, seed);
    }
    picture
}

#[cfg(test)]
mod tests {
    use super::*;

    fn edge() -> GrayImage {
        GrayImage::from_fn(32, 32, |x, _| image::Luma([if x < 16 { 10 } else { 210 }]))
    }

    #[test]
    fn a_good_camera_changes_nothing() {
        assert_eq!(through(&GOOD, edge(), 1), edge());
    }

    #[test]
    fn each_defect_does_what_it_says() {
        let of = |args: Args, seed| through(&args, edge(), seed);
        let dim = of(Args { gain: 0.1, ..GOOD }, 1);
        assert_eq!((dim[(0, 0)].0, dim[(31, 0)].0), ([1], [21]));
        let hazy = Args {
            contrast: 0.5,
            ..GOOD
        };
        let hazy = of(hazy, 1);
        assert_eq!((hazy[(0, 0)].0, hazy[(31, 0)].0), ([60], [160]));
        let soft = of(Args { blur: 2.0, ..GOOD }, 1);
        assert!(soft[(15, 9)].0[0] > 60 && soft[(16, 9)].0[0] < 160);
        let noisy = Args { noise: 5.0, ..GOOD };
        let (a, b) = (of(noisy, 1), of(noisy, 2));
        assert!(a == of(noisy, 1) && a != b);
        let right: Vec<f64> = a.pixels().map(|p| f64::from(p.0[0])).collect();
        let right: Vec<f64> = right.chunks(32).flat_map(|r| r[16..].to_vec()).collect();
        let n = right.len() as f64;
        let mean = right.iter().sum::<f64>() / n;
        let deviation = (right.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n).sqrt();
        assert!((mean - 210.0).abs() < 1.0 && (deviation - 5.0).abs() < 1.0);
    }
}
