//! Errors of the vertices of a face, by its regions, and how still they are.

use crate::statistics::mean;

/// A region of the face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Region {
    Forehead,
    Brows,
    Eyes,
    Nose,
    Lips,
    Cheeks,
    Chin,
    Temples,
    Ears,
}

impl Region {
    /// Every one, and its name.
    pub const ALL: [(Region, &str); 9] = [
        (Region::Forehead, "forehead"),
        (Region::Brows, "brows"),
        (Region::Eyes, "eyes"),
        (Region::Nose, "nose"),
        (Region::Lips, "lips"),
        (Region::Cheeks, "cheeks"),
        (Region::Chin, "chin"),
        (Region::Temples, "temples"),
        (Region::Ears, "ears"),
    ];

    /// That of a point of the neutral face \[mm\], x to the person's left, y to the chin, z to the
    /// back of the head from between the eyes. `landmarks` are those of the same face.
    pub fn of(point: [f64; 3], landmarks: &[[f64; 3]; 68]) -> Region {
        let far = |of: std::ops::Range<usize>| {
            let squares = landmarks[of].iter().map(|p| {
                let d = [0, 1, 2].map(|k| p[k] - point[k]);
                d.iter().map(|v| v * v).sum::<f64>()
            });
            squares.fold(f64::INFINITY, f64::min).sqrt()
        };
        let [x, y, z] = point;
        // Of what is drawn around landmarks, the nearest.
        let near = [
            (far(17..27) / 9.0, Region::Brows),
            (far(27..36) / 13.0, Region::Nose),
            (far(36..48) / 13.0, Region::Eyes),
            (far(48..68) / 11.0, Region::Lips),
        ];
        let nearest = near.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
        match nearest {
            Some((share, region)) if share <= 1.0 => region,
            _ if z > 58.0 && y > -8.0 => Region::Ears,
            _ if y < -18.0 && x.abs() < 48.0 => Region::Forehead,
            _ if y < 4.0 => Region::Temples,
            _ if y > 84.0 => Region::Chin,
            _ => Region::Cheeks,
        }
    }
}

/// Errors of many vertices, by region.
#[derive(Clone, Debug, Default)]
pub struct ByRegion(Vec<(Region, f64)>);

impl ByRegion {
    /// Adds the error of a vertex.
    pub fn add(&mut self, region: Region, error: f64) {
        self.0.push((region, error));
    }

    /// The mean of those of a region, or of all.
    pub fn mean(&self, region: Option<Region>) -> Option<f64> {
        let chosen = self
            .0
            .iter()
            .filter(|(of, _)| region.is_none_or(|wanted| wanted == *of));
        mean(&chosen.map(|(_, error)| *error).collect::<Vec<_>>())
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.0.len()
    }
}

/// How far each point is from its mean over the frames of a still face, as r.m.s. \[px\].
pub fn unrest(frames: &[Vec<[f64; 2]>]) -> Vec<f64> {
    let points = frames.iter().map(Vec::len).min().unwrap_or(0);
    let of = |i: usize| {
        let centre = [0, 1].map(|k| mean(&frames.iter().map(|f| f[i][k]).collect::<Vec<_>>()));
        let [cx, cy] = centre.map(Option::unwrap_or_default);
        let squares = frames
            .iter()
            .map(|f| (f[i][0] - cx).powi(2) + (f[i][1] - cy).powi(2));
        mean(&squares.collect::<Vec<_>>())
            .unwrap_or_default()
            .sqrt()
    };
    (0..points).map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn regions_are_around_their_landmarks() {
        let mut landmarks = [[0.0, 0.0, 0.0]; 68];
        landmarks[17..27].fill([30.0, -25.0, -10.0]);
        landmarks[27..36].fill([0.0, 30.0, -40.0]);
        landmarks[36..48].fill([30.0, 0.0, -5.0]);
        landmarks[48..68].fill([0.0, 70.0, -30.0]);
        let of = |x, y, z| Region::of([x, y, z], &landmarks);
        assert_eq!(of(30.0, -20.0, -8.0), Region::Brows);
        assert_eq!(of(28.0, 6.0, -4.0), Region::Eyes);
        assert_eq!(of(2.0, 64.0, -28.0), Region::Lips);
        assert_eq!(of(-40.0, 50.0, 0.0), Region::Cheeks);
        assert_eq!(of(0.0, 110.0, -20.0), Region::Chin);
        assert_eq!(of(0.0, -60.0, -10.0), Region::Forehead);
        assert_eq!(of(70.0, -20.0, 30.0), Region::Temples);
        assert_eq!(of(75.0, 30.0, 65.0), Region::Ears);
    }

    #[test]
    fn what_stays_has_no_unrest() {
        let still = vec![vec![[5.0, 7.0], [1.0, 1.0]]; 4];
        assert_eq!(unrest(&still), [0.0, 0.0]);
        let shaken = [[-1.0, 0.0], [1.0, 0.0]].map(|p| vec![p]);
        assert_eq!(unrest(&shaken), [1.0]);
        assert!(unrest(&[]).is_empty());
    }
}
