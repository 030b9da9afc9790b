//! `posewise track --gltf` and `--obj`: the head that the files have is the one that was tracked.

use std::path::Path;

use crate::common::{arg, fails_with, gradient_clip, has_program, posewise, skip};
use ::posewise::{ANIMATION_NAMES, ANIMATIONS};
use glam::{Quat, Vec3};
use serde_json::Value;

/// A rendered head of 320×240 pixels; 20 frames a second.
const DEMO: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/data/demo.y4m.gz");
const SIZE: [f32; 2] = [320.0, 240.0];
/// Where the tests of the page and of glTF have what they need of npm.
const WEB: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../web");

/// The parts of a binary glTF file.
struct Glb {
    json: Value,
    binary: Vec<u8>,
}

fn word(bytes: &[u8], at: usize) -> usize {
    u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize
}

impl Glb {
    fn read(path: &Path) -> Glb {
        let bytes = std::fs::read(path).unwrap();
        assert_eq!(&bytes[..8], b"glTF\x02\0\0\0");
        assert_eq!(word(&bytes, 8), bytes.len());
        let length = word(&bytes, 12);
        assert_eq!(&bytes[16..20], b"JSON");
        let (json, rest) = bytes[20..].split_at(length);
        assert_eq!(&rest[4..8], b"BIN\0");
        assert_eq!(word(rest, 0), rest.len() - 8);
        Glb {
            json: serde_json::from_slice(json).unwrap(),
            binary: rest[8..].to_vec(),
        }
    }

    fn bytes(&self, accessor: &Value) -> (&[u8], usize) {
        let accessor = &self.json["accessors"][accessor.as_u64().unwrap() as usize];
        let view = &self.json["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
        let number = |name: &str| view[name].as_u64().unwrap() as usize;
        let start = number("byteOffset");
        let bytes = &self.binary[start..start + number("byteLength")];
        (bytes, accessor["count"].as_u64().unwrap() as usize)
    }

    fn floats(&self, accessor: &Value) -> Vec<f32> {
        let (bytes, _) = self.bytes(accessor);
        let words = bytes.as_chunks::<4>().0.iter();
        words.map(|word| f32::from_le_bytes(*word)).collect()
    }

    fn vectors(&self, accessor: &Value) -> Vec<Vec3> {
        let floats = self.floats(accessor);
        floats
            .as_chunks::<3>()
            .0
            .iter()
            .map(|v| Vec3::from_array(*v))
            .collect()
    }

    fn primitive(&self) -> &Value {
        &self.json["meshes"][0]["primitives"][0]
    }

    fn triangles(&self) -> Vec<[usize; 3]> {
        let (bytes, _) = self.bytes(&self.primitive()["indices"]);
        let indices = bytes.as_chunks::<2>().0.iter();
        let indices: Vec<usize> = indices
            .map(|i| usize::from(u16::from_le_bytes(*i)))
            .collect();
        indices.as_chunks::<3>().0.to_vec()
    }

    /// Numbers of the animation of the head: times, or what a channel says at these.
    fn keys(&self, path: Option<&str>) -> Vec<f32> {
        let animation = &self.json["animations"][0];
        let Some(path) = path else {
            return self.floats(&animation["samplers"][0]["input"]);
        };
        let channels = animation["channels"].as_array().unwrap().iter();
        let mut channels = channels.filter(|c| c["target"]["path"] == path);
        let sampler = channels.next().unwrap()["sampler"].as_u64().unwrap() as usize;
        self.floats(&animation["samplers"][sampler]["output"])
    }

    /// The vertices in the world, as a player shows the keyframe of this index.
    fn shown(&self, key: usize) -> Vec<Vec3> {
        let weights = &self.keys(Some("weights"))[key * ANIMATIONS..][..ANIMATIONS];
        let mut places = self.vectors(&self.primitive()["attributes"]["POSITION"]);
        let targets = self.primitive()["targets"].as_array().unwrap();
        assert_eq!(targets.len(), ANIMATIONS);
        for (target, weight) in targets.iter().zip(weights) {
            let moves = self.vectors(&target["POSITION"]);
            places
                .iter_mut()
                .zip(moves)
                .for_each(|(place, by)| *place += *weight * by);
        }
        let turn = Quat::from_slice(&self.keys(Some("rotation"))[4 * key..][..4]);
        let to = Vec3::from_slice(&self.keys(Some("translation"))[3 * key..][..3]);
        places.into_iter().map(|place| turn * place + to).collect()
    }

    /// Where the camera of the file sees a point \[px\].
    fn project(&self, point: Vec3) -> [f32; 2] {
        let lens = &self.json["cameras"][0]["perspective"];
        let number = |name: &str| lens[name].as_f64().unwrap() as f32;
        let scale = 1.0 / (number("yfov") / 2.0).tan();
        let x = scale / number("aspectRatio") * point.x / -point.z;
        let y = scale * point.y / -point.z;
        [
            (1.0 + x) / 2.0 * SIZE[0] - 0.5,
            (1.0 - y) / 2.0 * SIZE[1] - 0.5,
        ]
    }
}

/// Standard output of `track` on the demo clip.
fn tracked(options: &[&str], more: &[&str]) -> Vec<u8> {
    let mut run = posewise();
    run.args(["track", DEMO, "--quiet"])
        .args(options)
        .args(more);
    run.assert().success().get_output().stdout.clone()
}

/// The JSON lines of a run.
fn rows(text: &[u8]) -> Vec<Value> {
    let lines = std::str::from_utf8(text).unwrap().lines();
    lines
        .map(|line| serde_json::from_str(line).unwrap())
        .collect()
}

#[test]
fn the_camera_of_the_file_sees_the_head_where_it_was() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("head.glb");
    let rows = rows(&tracked(&["--gltf", arg(&path)], &["--jsonl", "-"]));
    let glb = Glb::read(&path);
    let times = glb.keys(None);
    assert_eq!(times.len(), rows.len());
    assert_eq!(
        glb.json["meshes"][0]["extras"]["targetNames"],
        serde_json::json!(ANIMATION_NAMES.as_slice())
    );
    let (mut off_px, mut count) = (0.0, 0);
    for (key, row) in rows.iter().enumerate() {
        let time_us = 1e6 * f64::from(times[key]);
        assert!((time_us - row["timestamp_us"].as_f64().unwrap()).abs() < 1.0);
        if row["state"] != "tracking" {
            continue;
        }
        let shown = glb.shown(key);
        // Of the jaw, landmarks are of the contour.
        for (vertex, landmark) in shown
            .iter()
            .zip(row["landmarks"].as_array().unwrap())
            .skip(17)
        {
            let [x, y] = glb.project(*vertex);
            let at = |i: usize| landmark[i].as_f64().unwrap() as f32;
            off_px += (x - at(0)).hypot(y - at(1));
            count += 1;
        }
    }
    let mean = off_px / count as f32;
    println!("{mean:.2} px off in the mean, of {count} landmarks");
    assert!(count > 2000 && mean < 1.5, "{mean} px");
}

#[test]
fn the_mesh_faces_outwards_and_its_texture_is_upright() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("head.glb");
    tracked(&["--gltf", arg(&path)], &["--frames", "12"]);
    let glb = Glb::read(&path);
    let attributes = &glb.primitive()["attributes"];
    let places = glb.vectors(&attributes["POSITION"]);
    let normals = glb.vectors(&attributes["NORMAL"]);
    let uvs = glb.floats(&attributes["TEXCOORD_0"]);
    assert!(
        normals
            .iter()
            .all(|normal| (normal.length() - 1.0).abs() < 1e-3)
    );
    // The tip of the nose is in front, looks forwards, and is lower in the head than the brows, and
    // in a texture, whose v goes down. Y is up, and the person's left is at +x.
    let (nose, brow, left_eye) = (30, 24, 45);
    assert!(places[nose].z > 0.03 && normals[nose].z > 0.5);
    assert!(places[brow].y > places[nose].y && places[left_eye].x > 0.03);
    assert!(uvs[2 * brow + 1] < uvs[2 * nose + 1] && uvs[2 * left_eye] > uvs[2 * nose]);
    let triangles = glb.triangles();
    let outwards = triangles.iter().filter(|corners| {
        let [a, b, c] = corners.map(|corner| places[corner]);
        (b - a).cross(c - a).z > 0.0
    });
    let share = outwards.count() as f32 / triangles.len() as f32;
    assert!(share > 0.9, "{share}");
    // What a weight turns, it turns a little.
    for target in glb.primitive()["targets"].as_array().unwrap() {
        let turned = glb.vectors(&target["NORMAL"]);
        assert!(turned.iter().all(|turn| turn.length() <= 2.0));
    }
}

#[test]
fn khronos_finds_no_fault() {
    let validator = Path::new(WEB).join("node_modules/gltf-validator");
    let has_validator = skip::need("the npm package gltf-validator", validator.is_dir());
    if !has_validator || !has_program("node") {
        return;
    }
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("head.glb");
    for options in [["--frames", "80"], ["--frames", "4"], ["--focal", "300"]] {
        tracked(&["--gltf", arg(&path), "--gaze", "--smooth"], &options);
        let mut node = std::process::Command::new("node");
        node.arg(Path::new(WEB).join("test/gltf.mjs")).arg(&path);
        let said = node.output().unwrap();
        let report = String::from_utf8_lossy(&said.stdout).into_owned();
        assert!(
            said.status.success(),
            "{report}{}",
            String::from_utf8_lossy(&said.stderr)
        );
        assert!(report.contains("0 errors, 0 warnings"), "{report}");
    }
}

/// Places and corners of an OBJ file.
fn read_obj(text: &str) -> (Vec<Vec3>, Vec<[usize; 3]>) {
    let (mut places, mut triangles) = (Vec::new(), Vec::new());
    let (mut uvs, mut normals) = (0, 0);
    for line in text.lines() {
        let (kind, rest) = line.split_once(' ').unwrap();
        let mut words = rest.split(' ');
        let mut number = || -> f32 { words.next().unwrap().parse().unwrap() };
        match kind {
            "v" => places.push(Vec3::new(number(), number(), number())),
            "vn" => normals += usize::from(Vec3::new(number(), number(), number()).is_finite()),
            "vt" => uvs += usize::from((0.0..=1.0).contains(&number())),
            "f" => triangles.push(std::array::from_fn(|_| {
                let corner = words.next().unwrap();
                let indices: Vec<usize> = corner.split('/').map(|i| i.parse().unwrap()).collect();
                assert!(indices.len() == 3 && indices.iter().all(|i| *i == indices[0]));
                indices[0] - 1
            })),
            _ => assert!(["#", "o"].contains(&kind), "{line}"),
        }
    }
    assert_eq!((uvs, normals), (places.len(), places.len()));
    (places, triangles)
}

#[test]
fn an_obj_has_the_face_of_its_frame() {
    let dir = tempfile::tempdir().unwrap();
    let path = |name: &str| dir.path().join(name);
    let obj = |name: &str, options: &[&str]| -> (Vec<Vec3>, Vec<[usize; 3]>) {
        tracked(&["--frames", "30", "--obj", arg(&path(name))], options);
        read_obj(&std::fs::read_to_string(path(name)).unwrap())
    };
    let glb = path("head.glb");
    let (last, triangles) = obj("last.obj", &["--gltf", arg(&glb)]);
    let glb = Glb::read(&glb);
    assert_eq!(triangles, glb.triangles());
    // Its face is that of the animation, but for what landmarks drew.
    let shown = glb.shown(29);
    let turn = Quat::from_slice(&glb.keys(Some("rotation"))[4 * 29..][..4]).inverse();
    let to = Vec3::from_slice(&glb.keys(Some("translation"))[3 * 29..][..3]);
    let off = last
        .iter()
        .zip(&shown)
        .map(|(a, b)| a.distance(turn * (*b - to)));
    let mean = off.sum::<f32>() / last.len() as f32;
    assert!(mean < 0.004, "{mean} m");
    assert_eq!(obj("30.obj", &["--obj-frame", "30"]).0, last);
    assert_ne!(obj("20.obj", &["--obj-frame", "20"]).0, last);
}

#[test]
fn what_cannot_be_written_is_said() {
    let dir = tempfile::tempdir().unwrap();
    let path = |name: &str| dir.path().join(name);
    let (clip, glb, obj) = (path("clip.y4m"), path("h.glb"), path("h.obj"));
    std::fs::write(&clip, gradient_clip(64, 48, 3)).unwrap();
    std::fs::write(&glb, "old").unwrap();
    let fails = |options: &[&str], words: &[&str]| {
        fails_with(&[&["track"], options].concat(), Vec::new(), words);
    };
    let csv = path("t.csv");
    let none = ["no face was found", "h.glb is not written"];
    fails(
        &[arg(&clip), "--gltf", arg(&glb), "--csv", arg(&csv)],
        &none,
    );
    // Other outputs are complete.
    assert_eq!(
        std::fs::read_to_string(&csv).unwrap().lines().count(),
        1 + 3
    );
    fails(&[arg(&clip), "--obj", arg(&obj)], &["no face was found"]);
    let obj_of = |frame: &str, words: &[&str]| {
        fails(
            &[arg(&clip), "--obj", arg(&obj), "--obj-frame", frame],
            words,
        );
    };
    obj_of("2", &["frame 2 has no face", "h.obj is not written"]);
    obj_of("4", &["--obj-frame 4", "the last frame is 3"]);
    fails(
        &[DEMO, "--gltf", arg(&glb), "--faces", "2"],
        &["--gltf", "not with --faces"],
    );
    fails(
        &[DEMO, "--obj", arg(&obj), "--faces", "2"],
        &["--obj", "not with --faces"],
    );
    fails(
        &[DEMO, "--gltf", arg(&path("h.gltf"))],
        &["binary glTF", ".glb"],
    );
    fails(&[arg(&clip), "--gltf", arg(&clip)], &["would overwrite"]);
    let bare = path("bare.posewise");
    let model = posewise_format::without(::posewise::DEFAULT_MODEL, &[*b"MESH"]).unwrap();
    std::fs::write(&bare, model).unwrap();
    let with = |option: &str, file: &Path| {
        // Standard input is not read: nothing is tracked.
        let options = ["-", "--model", arg(&bare), option, arg(file)];
        fails(&options, &[option, "needs a model with section MESH"]);
    };
    with("--gltf", &glb);
    with("--obj", &obj);
    assert_eq!(std::fs::read(&glb).unwrap(), b"old");
    let entries = std::fs::read_dir(dir.path()).unwrap();
    assert_eq!(entries.count(), 4, "nothing else is left");
    for wrong in [["--obj-frame", "2"], ["--obj-frame", "0"]] {
        posewise()
            .args(["track", DEMO])
            .args(wrong)
            .assert()
            .code(2);
    }
}

#[cfg(unix)]
#[test]
fn a_full_disk_leaves_the_old_head() {
    let dir = tempfile::tempdir().unwrap();
    for (option, name) in [("--gltf", "h.glb"), ("--obj", "h.obj")] {
        let path = dir.path().join(name);
        std::fs::write(&path, "old").unwrap();
        let mut run = crate::common::limited("-f 20");
        run.args(["track", DEMO, "--frames", "4", option, arg(&path)]);
        let run = run.assert().code(1);
        let said = String::from_utf8_lossy(&run.get_output().stderr).into_owned();
        assert!(said.contains("cannot write"), "{said}");
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
    }
    assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 2);
}
