//! An animated head as binary glTF 2.0
//! (<https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html>).

use anyhow::{Context, Result, ensure};
use posewise::mesh::MeshTopology;
use posewise::{ANIMATION_NAMES, Intrinsics};
use serde_json::{Value, json};

use super::binary::{Binary, Use};
use super::recording::Recording;
use super::surface::Surface;

/// "glTF", "JSON" and "BIN", as little-endian numbers; the version of the container.
const MAGIC: u32 = 0x4654_6C67;
const JSON: u32 = 0x4E4F_534A;
const BIN: u32 = 0x004E_4942;
const VERSION: u32 = 2;

/// Of viewers' shading: grey, as rough as plaster.
const COLOUR: [f32; 4] = [0.8, 0.8, 0.8, 1.0];
const ROUGHNESS: f32 = 0.7;
/// Nearest that a viewer has to draw \[m\]. The core fits no face that is nearer.
const NEAREST_M: f32 = 0.01;

/// What the file is made of.
pub struct Head<'a> {
    /// The face without animation.
    pub neutral: Surface,
    /// With each weight at 1.
    pub shapes: Vec<Surface>,
    /// How vertices are joined.
    pub topology: MeshTopology<'a>,
    /// The camera, and the size of its frames \[px\].
    pub camera: Intrinsics,
    /// Width and height.
    pub size: (i32, i32),
    /// At least one frame, and a key for each.
    pub recording: &'a Recording,
}

/// The bytes of the file.
pub fn file(head: &Head<'_>) -> Result<Vec<u8>> {
    let mut binary = Binary::default();
    let document = document(head, &mut binary)?;
    let mut text = serde_json::to_vec(&document)?;
    text.resize(text.len().next_multiple_of(4), b' ');
    let total = 12 + 8 + text.len() + 8 + binary.bytes.len();
    let mut out = Vec::with_capacity(total);
    let length = |bytes: usize| u32::try_from(bytes).context("a .glb file cannot have 4 GB");
    let words = |out: &mut Vec<u8>, words: &[u32]| {
        out.extend(words.iter().flat_map(|word| word.to_le_bytes()));
    };
    words(&mut out, &[MAGIC, VERSION, length(total)?]);
    words(&mut out, &[length(text.len())?, JSON]);
    out.extend(text);
    words(&mut out, &[length(binary.bytes.len())?, BIN]);
    out.extend(binary.bytes);
    Ok(out)
}

/// The JSON part. Its numbers go into `binary`.
fn document(head: &Head<'_>, binary: &mut Binary) -> Result<Value> {
    let keys = &head.recording.keys;
    let first = keys.first().context("no keyframe")?;
    ensure!(
        keys.len() == head.recording.times.len(),
        "frames without a key"
    );
    let mesh = mesh(head, binary);
    let animation = animation(head.recording, binary);
    Ok(json!({
        "asset": {
            "version": "2.0",
            "generator": concat!("posewise ", env!("CARGO_PKG_VERSION")),
        },
        "scene": 0,
        "scenes": [{ "name": "scene", "nodes": [0, 1] }],
        "nodes": [
            {
                "name": "head",
                "mesh": 0,
                "translation": first.translation,
                "rotation": first.rotation,
                "weights": first.weights.as_slice(),
            },
            { "name": "camera", "camera": 0 },
        ],
        "cameras": [camera(&head.camera, head.size)],
        "meshes": [mesh],
        "materials": [{
            "name": "head",
            "pbrMetallicRoughness": {
                "baseColorFactor": COLOUR, "metallicFactor": 0.0, "roughnessFactor": ROUGHNESS,
            },
            // It is a mask: seen from behind it has an inside.
            "doubleSided": true,
        }],
        "animations": [animation],
        "buffers": [{ "byteLength": binary.bytes.len() }],
        "bufferViews": binary.views,
        "accessors": binary.accessors,
    }))
}

/// The camera, at the origin. Its axes are those of glTF's cameras; a principal point beside the
/// middle of the frame they do not have.
fn camera(camera: &Intrinsics, (width, height): (i32, i32)) -> Value {
    let (width, height) = (width as f32, height as f32);
    json!({
        "name": "camera",
        "type": "perspective",
        "perspective": {
            "yfov": 2.0 * (height / (2.0 * camera.fy)).atan(),
            "aspectRatio": (width / camera.fx) / (height / camera.fy),
            "znear": NEAREST_M,
        },
    })
}

/// The neutral face with a morph target for each weight.
fn mesh(head: &Head<'_>, binary: &mut Binary) -> Value {
    let Head {
        neutral,
        shapes,
        topology,
        ..
    } = head;
    // From the top of the texture downwards.
    let uvs: Vec<[f32; 2]> = topology.uvs.iter().map(|[u, v]| [*u, 1.0 - v]).collect();
    let indices = binary.triangles(topology.triangles);
    let attributes = json!({
        "POSITION": binary.bounded(Use::Vertices, &arrays(neutral.places.iter())),
        "NORMAL": binary.vectors(Use::Vertices, &arrays(neutral.normals.iter())),
        "TEXCOORD_0": binary.vectors(Use::Vertices, &uvs),
    });
    let targets: Vec<Value> = (shapes.iter())
        .map(|shape| {
            let moves = differences(&shape.places, &neutral.places);
            let turns = differences(&shape.normals, &neutral.normals);
            json!({
                "POSITION": binary.bounded(Use::Vertices, &moves),
                "NORMAL": binary.vectors(Use::Vertices, &turns),
            })
        })
        .collect();
    json!({
        "name": "head",
        "primitives": [{
            "attributes": attributes, "indices": indices, "material": 0, "targets": targets,
        }],
        "extras": { "targetNames": ANIMATION_NAMES.as_slice() },
    })
}

fn arrays<'a>(vectors: impl Iterator<Item = &'a glam::Vec3>) -> Vec<[f32; 3]> {
    vectors.map(glam::Vec3::to_array).collect()
}

fn differences(of: &[glam::Vec3], from: &[glam::Vec3]) -> Vec<[f32; 3]> {
    let pairs = of.iter().zip(from);
    pairs.map(|(a, b)| (*a - *b).to_array()).collect()
}

/// Place, rotation and weights of node 0.
fn animation(recording: &Recording, binary: &mut Binary) -> Value {
    let keys = &recording.keys;
    let times = binary.times(&recording.times);
    let translations: Vec<_> = keys.iter().map(|key| key.translation).collect();
    let rotations: Vec<_> = keys.iter().map(|key| key.rotation).collect();
    let weights: Vec<f32> = keys.iter().flat_map(|key| key.weights).collect();
    let outputs = [
        ("translation", binary.vectors(Use::Keys, &translations)),
        ("rotation", binary.vectors(Use::Keys, &rotations)),
        ("weights", binary.scalars(Use::Keys, &weights)),
    ];
    let samplers = outputs.map(|(_, output)| json!({ "input": times, "output": output }));
    let channel = |(i, (path, _)): (usize, &(&str, usize))| -> Value {
        json!({ "sampler": i, "target": { "node": 0, "path": path } })
    };
    let channels: Vec<Value> = outputs.iter().enumerate().map(channel).collect();
    json!({ "name": "track", "samplers": samplers, "channels": channels })
}
