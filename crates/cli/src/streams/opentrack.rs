//! opentrack's input "UDP over network": six doubles x, y, z \[cm\], yaw, pitch, roll \[deg\].
//!
//! The signs are those of opentrack's own camera tracker (`tracker-neuralnet`), for a camera in
//! front of the person whose picture is not mirrored: x > 0 to the image right, y > 0 up, z > 0
//! away from the camera; yaw > 0 turns the face to the image left (the person's right), pitch > 0
//! up, roll > 0 tilts the head clockwise in the image. Its angles are composed as ours.

use anyhow::Result;
use posewise::{State, TrackResult};

const CM_PER_MM: f64 = 0.1;

/// One datagram for a face; none without, so that opentrack keeps the last pose.
pub fn datagrams(result: &TrackResult) -> Result<Vec<Vec<u8>>> {
    if result.state == State::Searching {
        return Ok(Vec::new());
    }
    let [x, y, z] = result.translation_mm.map(|mm| f64::from(mm) * CM_PER_MM);
    let values = [
        x,
        -y,
        z,
        -f64::from(result.yaw_deg),
        f64::from(result.pitch_deg),
        f64::from(result.roll_deg),
    ];
    Ok(vec![values.iter().flat_map(|v| v.to_le_bytes()).collect()])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signs_and_units_by_hand() {
        let mut result = TrackResult::default();
        assert!(datagrams(&result).unwrap().is_empty(), "no face");
        result.state = State::Tracking;
        // 12 cm to the image right, 3 cm below the axis, 60 cm away.
        result.translation_mm = [120.0, 30.0, 600.0];
        (result.yaw_deg, result.pitch_deg, result.roll_deg) = (10.0, 20.0, 30.0);
        let bytes = datagrams(&result).unwrap().concat();
        let (doubles, rest) = bytes.as_chunks::<8>();
        let values: Vec<f64> = doubles.iter().map(|b| f64::from_le_bytes(*b)).collect();
        assert_eq!(values, [12.0, -3.0, 60.0, -10.0, 20.0, 30.0]);
        assert!(rest.is_empty());
    }
}
