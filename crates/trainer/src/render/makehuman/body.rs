//! The mesh of MakeHuman's mean adult, in the morphable head's axes and with its expressions'
//! names.

use crate::head::makehuman::{Mix, Moves, mix};
use crate::head::{MakeHuman, conventional_mm};
use crate::render::background::linear;
use crate::render::mesh::{Material, Mesh, Runs, Shape};
use crate::render::noise::smoothstep;
use anyhow::{Context, Result, ensure};
use glam::{Mat3, Vec2, Vec3};
use image::GrayImage;
use posewise::shape::{FITTED_NAMES, JAW, LANDMARKS};
use std::collections::BTreeMap;
use std::path::Path;

/// Parts and what they are made of, in the order in which they are drawn.
const PARTS: [(&str, Material); 7] = [
    ("skin", Material::Skin),
    ("eye_socket", Material::Socket),
    ("mouth_inside", Material::Mouth),
    ("tongue", Material::Mouth),
    ("teeth", Material::Teeth),
    ("eye_r", Material::EyeRight),
    ("eye_l", Material::EyeLeft),
];

/// Facial units by the ARKit names nearest to them, with factors at which landmarks move about as
/// far as those of the morphable head. Units without a side are split at the middle line.
const ARKIT: [(&str, &[(&str, f32)]); 37] = [
    ("browDownLeft", &[("eyebrows-left-down", 1.0)]),
    ("browDownRight", &[("eyebrows-right-down", 1.0)]),
    (
        "browInnerUp",
        &[
            ("eyebrows-left-inner-up", 1.0),
            ("eyebrows-right-inner-up", 1.0),
            ("eyebrows-left-up", 0.3),
            ("eyebrows-right-up", 0.3),
        ],
    ),
    (
        "browOuterUpLeft",
        &[("eyebrows-left-extern-up", 0.7), ("eyebrows-left-up", 0.5)],
    ),
    (
        "browOuterUpRight",
        &[
            ("eyebrows-right-extern-up", 0.7),
            ("eyebrows-right-up", 0.5),
        ],
    ),
    ("eyeBlinkLeft", &[("eye-left-closure", 0.81)]),
    ("eyeBlinkRight", &[("eye-right-closure", 0.81)]),
    ("eyeSquintLeft", &[("eye-left-slit", 0.35)]),
    ("eyeSquintRight", &[("eye-right-slit", 0.35)]),
    ("eyeWideLeft", &[("eye-left-opened-up", 1.0)]),
    ("eyeWideRight", &[("eye-right-opened-up", 1.0)]),
    // Lids follow the gaze as far as those of the morphable head; there are no units for it.
    ("eyeLookDownLeft", &[("eye-left-closure", 0.44)]),
    ("eyeLookDownRight", &[("eye-right-closure", 0.44)]),
    ("eyeLookUpLeft", &[("eye-left-opened-up", 0.7)]),
    ("eyeLookUpRight", &[("eye-right-opened-up", 0.7)]),
    ("jawOpen", &[("mouth-open", 0.95)]),
    ("mouthFrownLeft", &[("mouth-depression", 0.7)]),
    ("mouthFrownRight", &[("mouth-depression", 0.7)]),
    ("mouthFunnel", &[("mouth-protusion", 0.84)]),
    (
        "mouthLowerDownLeft",
        &[("mouth-depression-retraction", 0.5)],
    ),
    (
        "mouthLowerDownRight",
        &[("mouth-depression-retraction", 0.5)],
    ),
    ("mouthPressLeft", &[("mouth-compression", 1.0)]),
    ("mouthPressRight", &[("mouth-compression", 1.0)]),
    ("mouthPucker", &[("mouth-pursing", 0.94)]),
    ("mouthShrugLower", &[("mouth-eversion", 1.0)]),
    (
        "mouthSmileLeft",
        &[
            ("mouth-corner-puller", 1.0),
            ("mouth-upward-retraction", 0.25),
        ],
    ),
    (
        "mouthSmileRight",
        &[
            ("mouth-corner-puller", 1.0),
            ("mouth-upward-retraction", 0.25),
        ],
    ),
    ("mouthStretchLeft", &[("mouth-retraction", 1.0)]),
    ("mouthStretchRight", &[("mouth-retraction", 1.0)]),
    (
        "mouthUpperUpLeft",
        &[("mouth-elevation", 1.0), ("mouth-parling", 0.4)],
    ),
    (
        "mouthUpperUpRight",
        &[("mouth-elevation", 1.0), ("mouth-parling", 0.4)],
    ),
    (
        "noseSneerLeft",
        &[("nose-left-elevation", 1.0), ("nose-left-dilatation", 0.5)],
    ),
    (
        "noseSneerRight",
        &[
            ("nose-right-elevation", 1.0),
            ("nose-right-dilatation", 0.5),
        ],
    ),
    ("jawLeft", &[("mouth-open", 0.0)]),
    ("jawRight", &[("mouth-open", 0.0)]),
    ("cheekPuff", &[]),
    ("mouthClose", &[]),
];

/// How far a jaw goes sideways where it opens by a millimetre.
const SIDEWAYS: f32 = 0.22;
/// Half the width in which a unit without a side is split \[mm\].
const SPLIT_MM: f32 = 10.0;

/// Albedo of gums and teeth over what their bright pictures have; of the cheeks from inside.
const BRIGHT: f32 = 0.75;
const CHEEK: f32 = 0.06;

/// Below the eyes by so much a torso takes the place of the mean adult's neck, and of what is as
/// wide as shoulders \[mm\].
const CHEST_MM: f32 = 168.0;
const NECK_MM: f32 = 75.0;

/// What a vertex of an ear moves at least when ears are made larger \[mm\].
const EAR_MM: f32 = 2.5;

/// The square of the skins' atlas that shows the face, in its pixels: its left and upper edges and
/// its side. The top of the head is at the left of the atlas, the subject's left above.
const FACE: [f32; 3] = [252.0, 440.0, 500.0];
/// Width and height of the atlas; of the head's part of it.
const ATLAS: Vec2 = Vec2::new(752.0, 2062.0);
const HEAD_ROWS: f32 = 1380.0;

/// Weights of the mean adult.
fn adult(data: &MakeHuman) -> Vec<(usize, f32)> {
    let names = data.macros.iter().map(|(name, _)| name);
    let grown = |name: &String| name.ends_with("young") || name.ends_with("old");
    let grown = (0..).zip(names).filter(|(_, name)| grown(name));
    let places: Vec<usize> = grown.map(|(at, _)| at).collect();
    let share = 1.0 / places.len().max(1) as f32;
    places.into_iter().map(|at| (at, share)).collect()
}

fn mean(data: &MakeHuman) -> Vec<Vec3> {
    data.mixed(&adult(data), &[], &[])
}

/// The rotation about x, with a factor of the size, that brings the mean adult's inner landmarks
/// nearest to those of the morphable head.
pub fn alignment(data: &MakeHuman, morphable: &Mesh) -> Mat3 {
    let mean = mean(data);
    let inner = JAW..LANDMARKS;
    let own: Vec<Vec3> = inner
        .clone()
        .map(|i| mix(&mean, &data.landmarks[i]))
        .collect();
    let other: Vec<Vec3> = inner
        .map(|i| morphable.mean[morphable.landmarks[i] as usize])
        .collect();
    let centred = |points: &[Vec3]| -> Vec<Vec3> {
        let middle = points.iter().sum::<Vec3>() / points.len() as f32;
        points.iter().map(|p| *p - middle).collect()
    };
    let (own, other) = (centred(&own), centred(&other));
    let pairs = || own.iter().zip(&other);
    let along: f32 = pairs().map(|(a, b)| a.y * b.y + a.z * b.z).sum();
    let across: f32 = pairs().map(|(a, b)| a.y * b.z - a.z * b.y).sum();
    let sideways: f32 = pairs().map(|(a, b)| a.x * b.x).sum();
    let size: f32 = own.iter().map(|a| a.length_squared()).sum();
    let scale = (sideways + along.hypot(across)) / size;
    Mat3::from_rotation_x(across.atan2(along)) * scale
}

/// The mesh: the family's vertices, then the landmarks and the ends of the jaw's lines.
pub fn mesh(data: &MakeHuman, folder: &Path) -> Result<Mesh> {
    let mut vertices = mean(data);
    let (numbers, materials) = drawn_triangles(data, &vertices)?;
    let mut means: Vec<(u32, Mix)> = Vec::new();
    let mut add = |of: &Mix| {
        let next = (vertices.len() + means.len()) as u32;
        means.push((next, of.clone()));
        next
    };
    let landmarks = std::array::from_fn(|i| add(&data.landmarks[i]));
    let jaw_edge = std::array::from_fn(|i| match i {
        6..=10 => None,
        _ => data.jaw_lines[i].last().map(&mut add),
    });
    vertices.resize(vertices.len() + means.len(), Vec3::ZERO);
    let ear = ears(data);
    let skin = numbers.len();
    let mut mesh = Mesh {
        ear: (numbers.iter())
            .map(|n| data.triangles[*n].map(|v| ear[v as usize]))
            .collect(),
        triangles: numbers.iter().map(|n| data.triangles[*n]).collect(),
        corner_uv: (numbers.iter())
            .map(
                |n| match data.part("skin") == Some(data.triangle_part[*n]) {
                    true => two_tiles(data.corner_uv[*n]),
                    false => data.corner_uv[*n],
                },
            )
            .collect(),
        inner_albedo: Some(inner_albedo(data, &numbers, folder)?),
        materials,
        landmarks,
        jaw_edge,
        eyes: data.eyes.clone(),
        identity: Vec::new(),
        shapes: shapes(data, &vertices),
        animation: Vec::new(),
        reached: Vec::new(),
        open: Vec::new(),
        mean: vertices,
        means,
    };
    ensure!(skin > 0, "no skin");
    let place = |name: &&str| mesh.shapes.iter().position(|s| s.name == *name);
    mesh.animation = FITTED_NAMES.iter().map(place).collect();
    let mut mean = std::mem::take(&mut mesh.mean);
    mesh.settle(&mut mean);
    mesh.mean = mean;
    Ok(mesh.lit())
}

/// Numbers of the triangles that are drawn, sorted by material, and each material's run of them.
fn drawn_triangles(data: &MakeHuman, mean: &[Vec3]) -> Result<(Vec<usize>, Runs)> {
    let below = |p: Vec3| p.y > CHEST_MM || (p.y > NECK_MM && p.x.abs() > 0.8 * NECK_MM);
    let chest = |t: &[u32; 3]| t.iter().all(|v| below(mean[*v as usize]));
    let (mut numbers, mut materials) = (Vec::new(), Runs::new());
    for (name, material) in PARTS {
        let part = data.part(name).with_context(|| format!("no part {name}"))?;
        let start = numbers.len();
        let of_part = (0..data.triangles.len()).filter(|n| data.triangle_part[*n] == part);
        numbers.extend(of_part.filter(|n| !chest(&data.triangles[*n])));
        match materials.last_mut() {
            Some((last, run)) if *last == material => run.end = numbers.len(),
            _ => materials.push((material, start..numbers.len())),
        }
    }
    Ok((numbers, materials))
}

/// Vertices that belong to an ear.
fn ears(data: &MakeHuman) -> Vec<bool> {
    let mut ear = vec![false; data.base.len()];
    let larger = data
        .details
        .iter()
        .filter(|d| d.name.contains("ear-scale|"));
    for (v, d) in larger.flat_map(|d| &d.sides[1]) {
        ear[*v as usize] |= d.length() > EAR_MM;
    }
    ear
}

/// Texture coordinates of a triangle of the skin: the first tile shows the face upright, the second
/// everything else.
fn two_tiles(uv: [Vec2; 3]) -> [Vec2; 3] {
    let [left, top, side] = FACE;
    let face = uv.map(|uv| {
        let p = uv * ATLAS;
        Vec2::new((top + side - p.y) / side, 1.0 - (p.x - left) / side)
    });
    let inside = |p: &Vec2| p.min_element() > 0.005 && p.max_element() < 0.995;
    if face.iter().all(inside) {
        return face;
    }
    uv.map(|uv| {
        let p = uv * ATLAS;
        let q = match p.y < HEAD_ROWS {
            true => Vec2::new(HEAD_ROWS - p.y, p.x),
            // The neck below the head.
            false => Vec2::new(p.x, 770.0 + p.y - HEAD_ROWS),
        };
        let q = (q / HEAD_ROWS).clamp(Vec2::splat(0.003), Vec2::splat(0.997));
        Vec2::new(1.0 + q.x, 1.0 - q.y)
    })
}

/// Coordinates in the skins' atlas, 0..1 and v down, of the corners of the mesh's skin.
pub fn skin_uv(data: &MakeHuman, mesh: &Mesh) -> Vec<[Vec2; 3]> {
    let place: BTreeMap<[u32; 3], usize> = (data.triangles.iter().copied()).zip(0..).collect();
    let skin = &mesh.triangles[mesh.run(Material::Skin)];
    skin.iter().map(|t| data.corner_uv[place[t]]).collect()
}

/// Albedo of the corners of teeth, gums, tongue and cheeks; 0 elsewhere.
fn inner_albedo(data: &MakeHuman, numbers: &[usize], folder: &Path) -> Result<Vec<[f32; 3]>> {
    let picture = |name: &str| -> Result<GrayImage> {
        let path = folder.join("mouth").join(name);
        let picture = image::open(&path).with_context(|| path.display().to_string())?;
        Ok(picture.to_luma8())
    };
    let (teeth, tongue) = (picture("teeth.jpg")?, picture("tongue.jpg")?);
    let at = |picture: &GrayImage, uv: Vec2| {
        let inside = |v: f32, n: u32| ((v * n as f32).max(0.0) as u32).min(n - 1);
        let (x, y) = (
            inside(uv.x, picture.width()),
            inside(uv.y, picture.height()),
        );
        BRIGHT * linear(picture.get_pixel(x, y).0[0])
    };
    let albedo = |n: &usize| {
        let uv = data.corner_uv[*n];
        match data.part_names[data.triangle_part[*n] as usize].as_str() {
            "teeth" => uv.map(|uv| at(&teeth, uv)),
            "tongue" => uv.map(|uv| at(&tongue, uv)),
            "mouth_inside" => [CHEEK; 3],
            _ => [0.0; 3],
        }
    };
    Ok(numbers.iter().map(albedo).collect())
}

/// The facial units under ARKit's names.
fn shapes(data: &MakeHuman, mean: &[Vec3]) -> Vec<Shape> {
    let mut shapes = Vec::new();
    for (name, units) in ARKIT {
        let mut sum: BTreeMap<u32, Vec3> = BTreeMap::new();
        let sideways = match name {
            "jawLeft" => SIDEWAYS,
            "jawRight" => -SIDEWAYS,
            _ => 0.0,
        };
        for (unit, factor) in units {
            let one_sided = unit.contains("left") || unit.contains("right");
            let empty = Moves::new();
            for (v, d) in data.unit(unit).unwrap_or(&empty) {
                let x = mean[*v as usize].x;
                let share = match name {
                    _ if one_sided || sideways != 0.0 => 1.0,
                    _ if name.ends_with("Left") => smoothstep(-SPLIT_MM, SPLIT_MM, x),
                    _ if name.ends_with("Right") => smoothstep(-SPLIT_MM, SPLIT_MM, -x),
                    _ => 1.0,
                };
                let moved = *factor * share * *d + Vec3::X * (sideways * d.length());
                *sum.entry(*v).or_default() += moved;
            }
        }
        if !sum.is_empty() {
            shapes.push(Shape {
                name: name.to_owned(),
                moves: sum.into_iter().collect(),
            });
        }
    }
    shapes
}

/// From each landmark to where labels sit \[mm, head axes\]: where the convention has it, and
/// `moved_mm` from there.
pub fn offsets_mm(mesh: &Mesh, moved_mm: &[Vec3]) -> Vec<[f32; 3]> {
    let points = mesh.landmarks.map(|v| mesh.mean[v as usize].to_array());
    let conventional = conventional_mm(&points, 0.0);
    let moved = |i: usize| moved_mm.get(i).copied().unwrap_or_default();
    (0..LANDMARKS)
        .map(|i| (Vec3::from(conventional[i]) + moved(i)).to_array())
        .collect()
}
