//! `posewise track --retarget`: what an avatar gets is what the file says, in every output.

use std::net::UdpSocket;

use crate::common::{arg, fails_with, posewise};
use ::posewise::{ANIMATION_NAMES, ANIMATIONS};
use rosc::{OscPacket, OscType};
use serde_json::Value;

/// A rendered head.
const DEMO: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/data/demo.y4m.gz");
const FRAMES: usize = 8;
const FILE: &str = r#"{ "shapes": {
    "jawOpen": { "gain": 2, "offset": 0.1, "clamp": [0.2, 0.9] },
    "cheekSquintLeft": { "from": { "mouthSmileLeft": 0.5, "browInnerUp": 0.5 } },
    "mouthPucker": { "from": {} }
} }"#;

/// What the file makes of the weights of a frame.
fn expected(animation: &Value) -> Vec<(&'static str, f64)> {
    let at = |name: &str| animation[name].as_f64().unwrap();
    vec![
        ("jawOpen", (2.0 * at("jawOpen") + 0.1).clamp(0.2, 0.9)),
        (
            "cheekSquintLeft",
            0.5 * (at("mouthSmileLeft") + at("browInnerUp")),
        ),
        ("mouthPucker", 0.0),
        ("mouthSmileLeft", at("mouthSmileLeft")),
        ("tongueOut", 0.0),
    ]
}

fn names(packet: OscPacket, found: &mut Vec<(String, f64)>) {
    match packet {
        OscPacket::Message(message) if message.addr == "/VMC/Ext/Blend/Val" => {
            let [OscType::String(name), OscType::Float(weight)] = &message.args[..] else {
                panic!("a name and a weight");
            };
            found.push((name.clone(), f64::from(*weight)));
        }
        OscPacket::Message(_) => {}
        OscPacket::Bundle(bundle) => bundle.content.into_iter().for_each(|p| names(p, found)),
    }
}

#[test]
fn every_output_has_the_weights_of_the_file() {
    let dir = tempfile::tempdir().unwrap();
    let path = |name: &str| dir.path().join(name);
    let (file, csv, glb) = (path("avatar.json"), path("t.csv"), path("head.glb"));
    std::fs::write(&file, FILE).unwrap();
    let receiver = UdpSocket::bind("127.0.0.1:0").unwrap();
    let to = receiver.local_addr().unwrap().to_string();
    let run = posewise()
        .args(["track", DEMO, "--frames", &FRAMES.to_string(), "--quiet"])
        .args(["--retarget", arg(&file), "--jsonl", "-", "--csv", arg(&csv)])
        .args(["--gltf", arg(&glb), "--osc", &to])
        .assert()
        .success();
    let lines = String::from_utf8(run.get_output().stdout.clone()).unwrap();
    let rows: Vec<Value> = lines
        .lines()
        .map(|l| serde_json::from_str(l).unwrap())
        .collect();
    let close = |a: f64, b: f64| assert!((a - b).abs() < 6e-4, "{a} {b}");

    let mut faces = 0;
    for row in &rows {
        let avatar = row["avatar"].as_object().unwrap();
        assert_eq!(avatar.len(), 52);
        if row["state"] == "searching" {
            assert!(avatar.values().all(|weight| weight == 0.0));
            continue;
        }
        faces += 1;
        for (name, weight) in expected(&row["animation"]) {
            close(avatar[name].as_f64().unwrap(), weight);
        }
    }
    assert!(faces >= FRAMES - 2);

    let table = std::fs::read_to_string(&csv).unwrap();
    let mut table = table
        .lines()
        .map(|line| line.split(',').collect::<Vec<_>>());
    let header = table.next().unwrap();
    assert_eq!(
        header
            .iter()
            .filter(|name| name.starts_with("avatar_"))
            .count(),
        52
    );
    for (cells, row) in table.zip(&rows) {
        assert_eq!(cells.len(), header.len());
        for (name, weight) in row["avatar"].as_object().unwrap() {
            let at = header
                .iter()
                .position(|column| *column == format!("avatar_{name}"));
            close(
                cells[at.unwrap()].parse().unwrap(),
                weight.as_f64().unwrap(),
            );
        }
    }

    receiver.set_nonblocking(true).unwrap();
    let (mut sent, mut buffer) = (Vec::new(), [0; 2048]);
    while let Ok(length) = receiver.recv(&mut buffer) {
        names(
            rosc::decoder::decode_udp(&buffer[..length]).unwrap().1,
            &mut sent,
        );
    }
    // Without the gaze's eight.
    let avatars = rows
        .iter()
        .filter(|row| row["state"] != "searching")
        .flat_map(|row| {
            let avatar = row["avatar"].as_object().unwrap().iter();
            avatar.filter(|(name, _)| !name.starts_with("eyeLook"))
        });
    let mut avatars: Vec<(String, f64)> = avatars
        .map(|(name, weight)| (name.to_ascii_lowercase(), weight.as_f64().unwrap()))
        .collect();
    assert_eq!(sent.len(), 44 * faces);
    // The objects' names are in another order.
    for frame in 0..faces {
        let of = 44 * frame..44 * (frame + 1);
        avatars[of.clone()].sort_by(|a, b| a.0.cmp(&b.0));
        let mut sent: Vec<(String, f64)> = sent[of.clone()]
            .iter()
            .map(|(name, weight)| (name.to_ascii_lowercase(), *weight))
            .collect();
        sent.sort_by(|a, b| a.0.cmp(&b.0));
        for ((sent, weight), (name, expected)) in sent.iter().zip(&avatars[of]) {
            assert_eq!(sent, name);
            close(*weight, *expected);
        }
    }
    check_gltf(&std::fs::read(&glb).unwrap(), &rows);
}

/// The weights of the last key are those of the last row, of the shapes that the head has.
fn check_gltf(bytes: &[u8], rows: &[Value]) {
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    let json: Value = serde_json::from_slice(&bytes[20..20 + length]).unwrap();
    let output = json["animations"][0]["samplers"][2]["output"]
        .as_u64()
        .unwrap() as usize;
    let view = json["accessors"][output]["bufferView"].as_u64().unwrap() as usize;
    let view = &json["bufferViews"][view];
    let number = |name: &str| view[name].as_u64().unwrap() as usize;
    let end = 20 + length + 8 + number("byteOffset") + number("byteLength");
    let last = &bytes[end - 4 * ANIMATIONS..end];
    let weights = last
        .as_chunks::<4>()
        .0
        .iter()
        .map(|word| f32::from_le_bytes(*word));
    for (name, weight) in ANIMATION_NAMES.iter().zip(weights) {
        let expected = rows.last().unwrap()["avatar"][*name].as_f64().unwrap();
        assert!((f64::from(weight) - expected).abs() < 1e-6, "{name}");
    }
}

#[test]
fn what_is_wrong_in_a_file_is_said_before_anything_is_tracked() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("avatar.json");
    // Standard input is not read: nothing is tracked.
    let fails = |words: &[&str]| {
        fails_with(&["track", "-", "--retarget", arg(&file)], Vec::new(), words);
    };
    fails(&["cannot read retargeting", "avatar.json"]);
    std::fs::write(&file, "{").unwrap();
    fails(&["cannot use retargeting", "avatar.json", "not JSON"]);
    std::fs::write(&file, r#"{"shapes": {"jawOpn": {}}}"#).unwrap();
    fails(&["avatar.json", "shapes.jawOpn: ARKit has no such shape"]);
    std::fs::write(&file, FILE).unwrap();
    let args = ["track", DEMO, "--retarget", arg(&file), "--csv", arg(&file)];
    fails_with(&args, Vec::new(), &["would overwrite", "--retarget"]);
}
