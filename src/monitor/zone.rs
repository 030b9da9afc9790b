//! Zones of interest, and which of them a direction meets.

use glam::Vec3;

/// Most zones of a monitor.
pub const MAX_ZONES: usize = 8;

/// Where the driver may look. Where zones overlap, the first one counts.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Zone {
    /// Where it is.
    pub shape: ZoneShape,
    /// Looking there is looking at the road; elsewhere is away.
    pub is_road: bool,
    /// Time of a stay that does not count as away \[µs\]; `u32::MAX`: none of it does.
    pub grace_us: u32,
}

/// The place of a zone.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum ZoneShape {
    /// A range of directions, relative to that of the road: yaw > 0 is to the image right, pitch
    /// > 0 is up \[deg\].
    Angles {
        /// Least and largest yaw.
        yaw_deg: [f32; 2],
        /// Least and largest pitch.
        pitch_deg: [f32; 2],
    },
    /// A box along the axes of the camera frame \[mm\].
    Box {
        /// Its least corner.
        min_mm: [f32; 3],
        /// Its largest corner.
        max_mm: [f32; 3],
    },
    /// A parallelogram in the camera frame \[mm\]: centre ± `half_u_mm` ± `half_v_mm`, whose cross
    /// product is at least 100 mm² and a tenth of the product of their lengths.
    Plane {
        /// Its centre.
        centre_mm: [f32; 3],
        /// From the centre to the middle of a side.
        half_u_mm: [f32; 3],
        /// From the centre to the middle of another side.
        half_v_mm: [f32; 3],
    },
}

/// Where the driver looks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum ZoneState {
    /// It is not known.
    #[default]
    Unknown,
    /// In no zone: neither on the road nor away.
    Outside,
    /// In the zone of this index.
    In(u8),
}

/// Largest coordinate of a zone \[mm\]: as far as a car is long, and far from what overflows.
const FARTHEST_MM: f32 = 20_000.0;
/// Least sine of the angle between the sides of a plane, and least area of it \[mm²\].
const LEAST_SINE: f32 = 0.1;
const LEAST_MM2: f32 = 100.0;

/// Where the head is, and where it or its gaze is turned to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Direction {
    /// Yaw and pitch from the road \[deg\].
    pub(super) yaw_deg: f32,
    pub(super) pitch_deg: f32,
    /// From here, camera frame \[mm\].
    pub(super) origin_mm: Vec3,
    /// Along this unit vector in the camera frame.
    pub(super) ray: Vec3,
    /// Standard deviation of yaw and pitch \[deg\].
    pub(super) sigma_deg: f32,
}

impl Zone {
    /// A zone that is not the road, without grace.
    pub const fn new(shape: ZoneShape) -> Zone {
        Zone {
            shape,
            is_road: false,
            grace_us: 0,
        }
    }

    /// As the road.
    pub const fn as_road(self) -> Zone {
        Zone {
            is_road: true,
            ..self
        }
    }

    /// With a time that does not count as away \[µs\].
    pub const fn with_grace(self, grace_us: u32) -> Zone {
        Zone { grace_us, ..self }
    }

    /// Whether the numbers are those of a zone.
    pub(super) fn is_valid(&self) -> bool {
        // No comparison holds for a NaN.
        let is_range = |[a, b]: [f32; 2], most: f32| a < b && a >= -most && b <= most;
        match self.shape {
            ZoneShape::Angles { yaw_deg, pitch_deg } => {
                is_range(yaw_deg, 180.0) && is_range(pitch_deg, 180.0)
            }
            ZoneShape::Box { min_mm, max_mm } => min_mm
                .iter()
                .zip(max_mm)
                .all(|(a, b)| is_range([*a, b], FARTHEST_MM)),
            ZoneShape::Plane {
                centre_mm,
                half_u_mm,
                half_v_mm,
            } => {
                let numbers = [centre_mm, half_u_mm, half_v_mm];
                let in_range = |v: &f32| v.abs() <= FARTHEST_MM;
                let (u, v) = (Vec3::from(half_u_mm), Vec3::from(half_v_mm));
                let area = length(u.cross(v));
                numbers.iter().flatten().all(in_range)
                    && area >= LEAST_MM2
                    && area >= LEAST_SINE * length(u) * length(v)
            }
        }
    }

    /// Whether a direction meets the zone, or passes it by at most `margin_deg`.
    fn contains(&self, direction: &Direction, margin_deg: f32) -> bool {
        match self.shape {
            ZoneShape::Angles { yaw_deg, pitch_deg } => {
                let within = |[a, b]: [f32; 2], v: f32| v >= a - margin_deg && v <= b + margin_deg;
                within(yaw_deg, direction.yaw_deg) && within(pitch_deg, direction.pitch_deg)
            }
            ZoneShape::Box { min_mm, max_mm } => {
                let (min, max) = (Vec3::from(min_mm), Vec3::from(max_mm));
                let centre = (min + max) / 2.0;
                let more = Vec3::splat(margin_mm(direction, centre, margin_deg));
                meets_box(direction, min - more, max + more)
            }
            ZoneShape::Plane {
                centre_mm,
                half_u_mm,
                half_v_mm,
            } => {
                let centre = Vec3::from(centre_mm);
                let more = margin_mm(direction, centre, margin_deg);
                let longer = |side: Vec3| side * (1.0 + more / length(side).max(1.0));
                let (u, v) = (Vec3::from(half_u_mm), Vec3::from(half_v_mm));
                meets_plane(direction, centre, longer(u), longer(v))
            }
        }
    }
}

/// What an angle is at the distance of a point \[mm\].
fn margin_mm(direction: &Direction, at: Vec3, margin_deg: f32) -> f32 {
    length(at - direction.origin_mm) * margin_deg.to_radians()
}

fn length(v: Vec3) -> f32 {
    libm::sqrtf(v.dot(v))
}

/// Slabs, Kay and Kajiya 1986.
fn meets_box(direction: &Direction, min: Vec3, max: Vec3) -> bool {
    let (mut near, mut far) = (0.0f32, f32::INFINITY);
    for axis in 0..3 {
        let part = |v: Vec3| match axis {
            0 => v.x,
            1 => v.y,
            _ => v.z,
        };
        let (from, along) = (part(direction.origin_mm), part(direction.ray));
        let (low, high) = (part(min) - from, part(max) - from);
        if along.abs() < 1e-6 {
            // Parallel to this pair of faces.
            if low > 0.0 || high < 0.0 {
                return false;
            }
            continue;
        }
        let (a, b) = (low / along, high / along);
        near = near.max(a.min(b));
        far = far.min(a.max(b));
    }
    near <= far
}

/// Whether the ray meets the parallelogram, from either side.
fn meets_plane(direction: &Direction, centre: Vec3, u: Vec3, v: Vec3) -> bool {
    let normal = u.cross(v);
    let along = normal.dot(direction.ray);
    let square = normal.dot(normal);
    if along * along < 1e-6 * square {
        return false;
    }
    let distance = normal.dot(centre - direction.origin_mm) / along;
    let at = direction.origin_mm + direction.ray * distance - centre;
    // Coordinates along the sides, by Cramer's rule in the plane.
    let a = at.cross(v).dot(normal) / square;
    let b = u.cross(at).dot(normal) / square;
    distance >= 0.0 && a.abs() <= 1.0 && b.abs() <= 1.0
}

/// The zones of a monitor.
#[derive(Clone)]
pub(super) struct Zones {
    list: heapless::Vec<Zone, MAX_ZONES>,
}

impl Zones {
    /// `None` for too many zones, or numbers that are none.
    pub(super) fn new(zones: &[Zone]) -> Option<Zones> {
        let list = heapless::Vec::from_slice(zones).ok()?;
        zones.iter().all(Zone::is_valid).then_some(Zones { list })
    }

    pub(super) fn get(&self, index: u8) -> Option<&Zone> {
        self.list.get(usize::from(index))
    }

    /// Which zone a direction meets: the last one as long as it is within the margin of it.
    pub(super) fn at(&self, direction: &Direction, last: ZoneState, margin_deg: f32) -> ZoneState {
        if let ZoneState::In(index) = last
            && (self.get(index)).is_some_and(|zone| zone.contains(direction, margin_deg))
        {
            return last;
        }
        let mut zones = self.list.iter();
        match zones.position(|zone| zone.contains(direction, 0.0)) {
            Some(index) => ZoneState::In(index as u8),
            None => ZoneState::Outside,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn straight(origin: [f32; 3], ray: [f32; 3]) -> Direction {
        Direction {
            yaw_deg: 0.0,
            pitch_deg: 0.0,
            origin_mm: Vec3::from(origin),
            ray: Vec3::from(ray).normalize(),
            sigma_deg: 0.0,
        }
    }

    #[test]
    fn boxes_and_planes_are_met() {
        // A head at 700 mm, and things beside the camera.
        let head = [0.0, 0.0, 700.0];
        let a_box = ZoneShape::Box {
            min_mm: [100.0, -50.0, -20.0],
            max_mm: [200.0, 50.0, 20.0],
        };
        let a_plane = ZoneShape::Plane {
            centre_mm: [150.0, 0.0, 0.0],
            half_u_mm: [50.0, 0.0, 0.0],
            half_v_mm: [0.0, 50.0, 10.0],
        };
        for shape in [a_box, a_plane] {
            let zone = Zone::new(shape);
            assert!(zone.is_valid());
            let at = |x: f32| straight(head, [x, 0.0, -700.0]);
            assert!(zone.contains(&at(150.0), 0.0), "{shape:?}");
            assert!(!zone.contains(&at(0.0), 0.0));
            assert!(!zone.contains(&at(90.0), 0.0) && zone.contains(&at(90.0), 3.0));
            // Behind the head.
            assert!(!zone.contains(&straight(head, [-150.0, 0.0, 700.0]), 3.0));
        }
    }

    #[test]
    fn a_zone_is_left_beyond_its_margin() {
        let side = |yaw_deg| {
            Zone::new(ZoneShape::Angles {
                yaw_deg,
                pitch_deg: [-90.0, 90.0],
            })
        };
        let zones = Zones::new(&[side([-10.0, 10.0]), side([10.0, 60.0])]).unwrap();
        let mut last = ZoneState::Unknown;
        let mut at = |yaw_deg| {
            let mut direction = straight([0.0; 3], [0.0, 0.0, -1.0]);
            direction.yaw_deg = yaw_deg;
            last = zones.at(&direction, last, 3.0);
            last
        };
        let expected = [(0.0, 0), (12.0, 0), (14.0, 1), (8.0, 1), (6.0, 0)];
        for (yaw, index) in expected {
            assert_eq!(at(yaw), ZoneState::In(index), "{yaw}");
        }
        assert_eq!(at(-50.0), ZoneState::Outside);
    }

    #[test]
    fn what_is_no_zone_is_rejected() {
        let flat = ZoneShape::Box {
            min_mm: [0.0; 3],
            max_mm: [1.0, 1.0, 0.0],
        };
        let line = ZoneShape::Plane {
            centre_mm: [0.0; 3],
            half_u_mm: [50.0, 0.0, 0.0],
            half_v_mm: [90.0, 0.0, 0.0],
        };
        let nan = ZoneShape::Angles {
            yaw_deg: [f32::NAN, 1.0],
            pitch_deg: [0.0, 1.0],
        };
        for shape in [flat, line, nan] {
            assert!(Zones::new(&[Zone::new(shape)]).is_none(), "{shape:?}");
        }
        let zone = Zone::new(ZoneShape::Angles {
            yaw_deg: [0.0, 1.0],
            pitch_deg: [0.0, 1.0],
        });
        assert!(Zones::new(&[zone; MAX_ZONES]).is_some());
        assert!(Zones::new(&[zone; MAX_ZONES + 1]).is_none());
    }
}
