//! Pictures that end within the face, for `posewise-lab eval landmarks --cut`.

use image::GrayImage;
use image::imageops::crop_imm;
use posewise_metrics::landmarks::bounds;

use super::landmark_metrics::Points;

/// The picture without what lies beyond a line that leaves this share of the landmarks' box on its
/// other side, and where its corner was \[px\]. Side 0 is the left one, then right, top and bottom.
pub fn cut(
    picture: &GrayImage,
    landmarks: &Points,
    share: f64,
    side: usize,
) -> (GrayImage, [f64; 2]) {
    let [left, top, right, bottom] = bounds(landmarks);
    let [width, height] = [picture.width(), picture.height()];
    let mut low = [0, 0];
    let mut high = [width, height];
    let axis = usize::from(side >= 2);
    let (near, far, length) = match axis {
        0 => (left, right, width),
        _ => (top, bottom, height),
    };
    let line = |at: f64| (at.round().max(0.0) as u32).min(length);
    match side % 2 {
        0 => low[axis] = line(near + share * (far - near)).min(length.saturating_sub(1)),
        _ => high[axis] = line(far - share * (far - near)).max(1),
    }
    let size = [high[0] - low[0], high[1] - low[1]];
    let inside = crop_imm(picture, low[0], low[1], size[0], size[1]).to_image();
    (inside, low.map(f64::from))
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Luma;

    #[test]
    fn a_share_of_the_box_is_outside() {
        let picture = GrayImage::from_fn(100, 80, |x, y| Luma([(x + y) as u8]));
        let mut landmarks = [[40.0, 30.0]; 68];
        landmarks[1] = [80.0, 50.0];
        let cut = |side: usize| {
            let (inside, corner) = cut(&picture, &landmarks, 0.25, side);
            assert_eq!(inside[(0, 0)].0[0], (corner[0] + corner[1]) as u8);
            (inside.dimensions(), corner)
        };
        assert_eq!(cut(0), ((50, 80), [50.0, 0.0]));
        assert_eq!(cut(1), ((70, 80), [0.0, 0.0]));
        assert_eq!(cut(2), ((100, 45), [0.0, 35.0]));
        assert_eq!(cut(3), ((100, 45), [0.0, 0.0]));
    }

    #[test]
    fn something_is_left() {
        let picture = GrayImage::new(10, 10);
        let landmarks = [[-50.0, -50.0], [-40.0, -40.0]];
        let landmarks: Points = std::array::from_fn(|i| landmarks[i % 2]);
        for side in 0..4 {
            let (inside, _) = cut(&picture, &landmarks, 0.5, side);
            assert!(inside.width() > 0 && inside.height() > 0);
        }
    }
}
