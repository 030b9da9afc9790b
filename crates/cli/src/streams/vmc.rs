//! The Virtual Motion Capture protocol (<https://protocol.vmc.info>) over OSC, as tools for avatars
//! read it: head rotation and blendshapes.
//!
//! The protocol's axes are Unity's: left-handed, x to the avatar's right, y up, z forward. Ours
//! (x to the person's left, y to the chin, z to the back of the head) are their opposites, all
//! three: a rotation has the same matrix, and the same quaternion, in both.

use anyhow::{Result, anyhow};
use posewise::eyes::EYE_LOOK_NAMES;
use posewise::{ANIMATION_NAMES, State, TrackResult};
use rosc::{OscBundle, OscMessage, OscPacket, OscTime, OscType};

use crate::retarget::SHAPES;

/// OSC's time tag for "at once".
const AT_ONCE: OscTime = OscTime {
    seconds: 0,
    fractional: 1,
};
/// `/VMC/Ext/OK`: a model is loaded; it is calibrated; calibrated in the normal way.
const STATUS: [i32; 3] = [1, 3, 0];

/// Largest payload of UDP over IPv4 in an Ethernet frame \[bytes\]: what is larger comes in
/// fragments, of which none may be lost.
const MOST: usize = 1500 - 20 - 8;

/// Weights of an avatar, in the order of [`SHAPES`].
type Avatar = [f32; SHAPES.len()];

/// Datagrams that are each within an Ethernet frame: status, time and head; then the blendshapes,
/// in as many as they take, the 8 of the eyes among them if the gaze is looked for. Without a face
/// only the status, which says so.
pub fn datagrams(
    result: &TrackResult,
    gaze: bool,
    avatar: Option<&Avatar>,
) -> Result<Vec<Vec<u8>>> {
    let has_face = result.state != State::Searching;
    let status = STATUS.into_iter().chain([i32::from(has_face)]);
    let seconds = result.timestamp_us as f64 / 1e6;
    let mut first = vec![
        message("/VMC/Ext/OK", status.map(OscType::Int).collect()),
        message("/VMC/Ext/T", vec![OscType::Float(seconds as f32)]),
    ];
    if !has_face {
        return Ok(vec![bundle(first)?]);
    }
    first.push(head(result));
    let mut datagrams = vec![bundle(first)?];
    datagrams.extend(bundles(blendshapes(result, gaze, avatar))?);
    Ok(datagrams)
}

/// Messages in as few bundles as hold them.
fn bundles(messages: Vec<OscPacket>) -> Result<Vec<Vec<u8>>> {
    let mut full = Vec::new();
    let mut last = bundle(Vec::new())?;
    for message in messages {
        let bytes = encode(&message)?;
        // A bundle is a head, then for each message its length and itself.
        if last.len() + 4 + bytes.len() > MOST {
            full.push(std::mem::replace(&mut last, bundle(Vec::new())?));
        }
        last.extend((bytes.len() as u32).to_be_bytes());
        last.extend(bytes);
    }
    full.push(last);
    Ok(full)
}

/// The head's rotation to that of the camera. Where the bone is belongs to the avatar: 0.
fn head(result: &TrackResult) -> OscPacket {
    let numbers = [[0.0; 3].as_slice(), &result.rotation].concat();
    let name = OscType::String("Head".into());
    let values = numbers.into_iter().map(OscType::Float);
    message(
        "/VMC/Ext/Bone/Pos",
        [name].into_iter().chain(values).collect(),
    )
}

/// All weights, then the order to show them. Those of eyes whose gaze is unknown are 0.
fn blendshapes(result: &TrackResult, gaze: bool, avatar: Option<&Avatar>) -> Vec<OscPacket> {
    let weights: Vec<(&str, f32)> = match avatar {
        Some(weights) => SHAPES.into_iter().zip(*weights).collect(),
        None => {
            let weights = ANIMATION_NAMES.into_iter().zip(result.animation);
            weights
                .chain(EYE_LOOK_NAMES.into_iter().zip(result.eyes.look))
                .collect()
        }
    };
    weights
        .into_iter()
        .filter(|(name, _)| gaze || !EYE_LOOK_NAMES.contains(name))
        .map(|(name, weight)| {
            let name = OscType::String(capitalized(name));
            message("/VMC/Ext/Blend/Val", vec![name, OscType::Float(weight)])
        })
        .chain([message("/VMC/Ext/Blend/Apply", Vec::new())])
        .collect()
}

/// ARKit's name as Unity spells it, which is what the protocol refers to; some receivers
/// distinguish case.
fn capitalized(name: &str) -> String {
    let (first, rest) = name.split_at_checked(1).unwrap_or((name, ""));
    first.to_ascii_uppercase() + rest
}

fn message(address: &str, args: Vec<OscType>) -> OscPacket {
    OscPacket::Message(OscMessage {
        addr: address.into(),
        args,
    })
}

fn bundle(content: Vec<OscPacket>) -> Result<Vec<u8>> {
    let packet = OscPacket::Bundle(OscBundle {
        timetag: AT_ONCE,
        content,
    });
    encode(&packet)
}

fn encode(packet: &OscPacket) -> Result<Vec<u8>> {
    rosc::encoder::encode(packet).map_err(|e| anyhow!("cannot encode OSC: {e:?}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{EulerRot, Quat, Vec3};

    /// Where the avatar's forward and up axes point, in Unity's frame.
    fn turned(yaw_deg: f32, pitch_deg: f32, roll_deg: f32) -> (Vec3, Vec3) {
        let [yaw, pitch, roll] = [yaw_deg, pitch_deg, roll_deg].map(f32::to_radians);
        let mut result = TrackResult::default();
        result.rotation = Quat::from_euler(EulerRot::YXZ, -yaw, -pitch, roll).to_array();
        let OscPacket::Message(OscMessage { args, .. }) = head(&result) else {
            panic!("a message");
        };
        let floats: Vec<f32> = args.into_iter().filter_map(OscType::float).collect();
        assert_eq!(floats[..3], [0.0; 3]);
        let quat = Quat::from_slice(&floats[3..]);
        (quat * Vec3::Z, quat * Vec3::Y)
    }

    /// Unity: x is the avatar's right, y up, z forward.
    #[test]
    fn signs_by_hand() {
        let (forward, up) = turned(30.0, 0.0, 0.0);
        assert!(forward.x < -0.4 && up.y > 0.99, "to the avatar's left");
        let (forward, _) = turned(0.0, 20.0, 0.0);
        assert!(forward.y > 0.3, "up");
        let (forward, up) = turned(0.0, 0.0, 10.0);
        // Clockwise in the image: the top of the head moves to the image right, the person's left.
        assert!(forward.z > 0.99 && up.x < -0.1, "to the left shoulder");
    }

    #[test]
    fn datagrams_are_whole_frames() {
        let mut result = TrackResult::default();
        assert_eq!(datagrams(&result, true, None).unwrap().len(), 1);
        result.state = State::Tracking;
        let avatar = [0.5; SHAPES.len()];
        for (gaze, avatar) in [
            (false, None),
            (true, None),
            (false, Some(&avatar)),
            (true, Some(&avatar)),
        ] {
            let sent = datagrams(&result, gaze, avatar).unwrap();
            assert!(sent.iter().all(|d| d.len() <= MOST), "no fragments");
            let shapes = blendshapes(&result, gaze, avatar);
            let looks = EYE_LOOK_NAMES.len();
            let count = match avatar {
                Some(_) => SHAPES.len() - looks,
                None => ANIMATION_NAMES.len(),
            };
            assert_eq!(shapes.len(), count + if gaze { looks } else { 0 } + 1);
            // Each is there once, in its order.
            let mut received = Vec::new();
            for datagram in &sent[1..] {
                let packet = rosc::decoder::decode_udp(datagram).unwrap().1;
                let OscPacket::Bundle(bundle) = packet else {
                    panic!("a bundle");
                };
                assert!(!bundle.content.is_empty());
                received.extend(bundle.content);
            }
            assert_eq!(received, shapes);
        }
        assert_eq!(capitalized("eyeBlinkLeft"), "EyeBlinkLeft");
    }
}
