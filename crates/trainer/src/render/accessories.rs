//! Things worn on a head, in head axes: glasses, long hair, caps, masks.

use super::draw::Prop;
use super::mesh::{Material, Mesh};
use super::mirror::Mirror;
use super::noise::fractal;
use glam::{Mat3, Vec2, Vec3};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeMap;

/// How far spectacles bend back towards the temples \[mm per mm² from the middle\].
const BEND: f32 = 0.0022;

/// Radius of a lens' front \[mm\].
const CURVED_MM: f32 = 130.0;
/// Rings of a lens, in that of its rim.
const RINGS: [f32; 3] = [1.0, 0.7, 0.35];
/// Lids and lashes, this far around the middle of an eye, are this far behind a lens \[mm\].
const LIDS_MM: Vec2 = Vec2::new(17.0, 11.0);
const CLEAR_MM: f32 = 3.5;

/// Spectacles that sit on a head of these vertices (head axes); frames and lenses.
pub fn glasses(rng: &mut ChaCha8Rng, mesh: &Mesh, head: &[Vec3]) -> Vec<Prop> {
    let at = |i: usize| head[mesh.landmarks[i] as usize];
    let eyes = [at(36).lerp(at(39), 0.5), at(42).lerp(at(45), 0.5)];
    // Their temples reach back to the ears.
    let ears = [at(0), at(16)].map(|p| p + Vec3::new(p.x.signum() * 2.0, 2.0, 42.0));
    let bridge = at(27);
    let half = Vec2::new(rng.random_range(23.0..30.0), rng.random_range(13.0..25.0));
    let power = rng.random_range(2.0..4.5f32);
    let thick = rng.random_range(0.5..2.4f32);
    let colour = if rng.random_bool(0.75) {
        0.02
    } else {
        rng.random_range(0.05..0.6)
    };
    let dark = rng.random_bool(0.35);
    let front = (bridge.z - rng.random_range(-2.0..4.0)).min(before_lids(eyes, head));
    let down = rng.random_range(0.0..6.0);
    let mut frame = Prop::opaque(0.5);
    let mut lens = Prop {
        gloss: rng.random_range(0.0..1.0f32).powi(2) * 0.5,
        opacity: if dark {
            rng.random_range(0.75..0.97)
        } else {
            rng.random_range(0.02..0.15)
        },
        ..Prop::default()
    };
    let (mut inner, mut centres) = ([Vec3::ZERO; 2], [Vec3::ZERO; 2]);
    for k in 0..2 {
        let side = if k == 0 { -1.0 } else { 1.0 };
        let centre = Vec3::new(
            side * eyes[k].x.abs().max(half.x + 7.0),
            eyes[k].y + down,
            front,
        );
        let rim = rim(centre, half, power);
        let ring: Vec<(Vec3, f32)> = rim.iter().map(|p| (*p, thick)).collect();
        frame.tube(&ring, colour, true);
        let rings = RINGS.map(|share| curved(centre, &rim, share));
        lens.skin(&rings, if dark { 0.015 } else { 0.3 }, false);
        let hub = curved(centre, &rim, 0.0)[0];
        lens.fill(rim.len(), hub);
        let out = Vec3::new(2.0 * BEND * centre.x, 0.0, -1.0).normalize();
        centres[k] = hub - CURVED_MM * out;
        let x_out = centre.x + side * half.x;
        let hinge = Vec3::new(x_out, centre.y - 0.4 * half.y, front + BEND * x_out * x_out);
        let ear = ears[k] + Vec3::new(side * 3.0, -6.0, 0.0);
        frame.tube(
            &[
                (hinge, thick),
                (hinge.lerp(ear, 0.5) + Vec3::X * side * 3.0, thick),
                (ear, thick),
            ],
            colour,
            false,
        );
        inner[k] = centre - Vec3::new(side * half.x, 0.3 * half.y, 0.0);
    }
    let mid = inner[0].lerp(inner[1], 0.5) - Vec3::new(0.0, 2.5, 1.0);
    frame.tube(
        &[(inner[0], thick), (mid, thick), (inner[1], thick)],
        colour,
        false,
    );
    lens.mirror = Mirror::random(rng, centres);
    vec![frame, lens]
}

/// How far to the front lenses are that clear the lids.
fn before_lids(eyes: [Vec3; 2], head: &[Vec3]) -> f32 {
    let is_near = |v: &&Vec3| {
        let near = |eye: &Vec3| (**v - *eye).truncate().abs().cmplt(LIDS_MM).all();
        v.z < eyes[0].z.max(eyes[1].z) + LIDS_MM.x && eyes.iter().any(near)
    };
    let flat = |v: &Vec3| v.z - BEND * v.x * v.x;
    let nearest = head
        .iter()
        .filter(is_near)
        .map(flat)
        .fold(f32::MAX, f32::min);
    nearest - CLEAR_MM
}

/// A ring of a lens' surface, whose size is this share of the rim's.
fn curved(centre: Vec3, rim: &[Vec3], share: f32) -> Vec<Vec3> {
    let sag = |r: Vec2| r.length_squared() / (2.0 * CURVED_MM);
    let hub = centre + Vec3::new(0.0, 0.0, BEND * centre.x * centre.x);
    let point = |p: &Vec3| {
        let out = (*p - hub).truncate();
        let bulge = sag(out) - sag(share * out);
        hub + share * (*p - hub) - Vec3::Z * bulge
    };
    rim.iter().map(point).collect()
}

/// The rim round a lens: a superellipse.
fn rim(centre: Vec3, half: Vec2, power: f32) -> Vec<Vec3> {
    let round = |v: f32| v.signum() * v.abs().powf(2.0 / power);
    let point = |i: usize| {
        let (s, c) = (i as f32 / 28.0 * std::f32::consts::TAU).sin_cos();
        let x = centre.x + half.x * round(c);
        Vec3::new(x, centre.y + half.y * round(s), centre.z + BEND * x * x)
    };
    (0..28).map(point).collect()
}

/// Moves props from head axes to camera axes.
pub fn wear(props: &mut [Prop], rotation: Mat3, at: Vec3) {
    props.iter_mut().for_each(|p| p.transform(rotation, at));
}

/// Depth of the skull's middle, around which rings of hair and caps are built \[mm\].
const SKULL_Z: f32 = 72.0;

/// Hair that falls past the ears to the jaw, the shoulders or the chest, open at the face. `jaw`:
/// the landmarks 0 and 16, which give the head's width.
pub fn long_hair(rng: &mut ChaCha8Rng, jaw: [Vec3; 2], albedo: f32) -> Prop {
    const SIDES: usize = 72;
    const ROWS: usize = 16;
    let half = (jaw[1].x - jaw[0].x).abs() / 2.0 + rng.random_range(6.0..20.0);
    let deep = rng.random_range(98.0..112.0);
    let length = [0.5f32, 0.8, 1.0][rng.random_range(0..3)] * rng.random_range(170.0..260.0);
    // How far the hair leaves the face free at both sides, at eye level and lower down.
    let open: [[f32; 2]; 2] = std::array::from_fn(|_| {
        let eyes = rng.random_range(50.0..82.0f32);
        [eyes, eyes + rng.random_range(-14.0..22.0)]
    });
    let flare = rng.random_range(-0.12..0.35f32);
    let wave = rng.random_range(0.0..5.0f32);
    let seed = rng.random();
    let mut prop = Prop::opaque(rng.random_range(0.0..0.15));
    let rings: Vec<Vec<Vec3>> = (0..ROWS)
        .map(|row| {
            let t = row as f32 / (ROWS - 1) as f32;
            let y = -72.0 + (length + 72.0) * t;
            // Under the crown's own hair at the top, loose below the ears.
            let grow = 0.86 + 0.14 * (t * 6.0).min(1.0) + flare * (t - 0.3).max(0.0);
            (0..=SIDES)
                .map(|side| {
                    let u = side as f32 / SIDES as f32;
                    let of = usize::from(u > 0.5);
                    let edge = open[of][0] + (open[of][1] - open[of][0]) * t;
                    let turn = (edge + (360.0 - open[0][0] - open[1][0]) * u).to_radians();
                    let ripple = wave * fractal(Vec3::new(u * 9.0, y * 0.03, 0.0), 2, seed);
                    let (s, c) = turn.sin_cos();
                    Vec3::new(
                        -s * (half * grow + ripple),
                        y,
                        SKULL_Z - c * (deep * grow + ripple),
                    )
                })
                .collect()
        })
        .collect();
    prop.sheet(&rings, albedo);
    for (v, a) in prop.vertices.iter().zip(&mut prop.albedo) {
        let around = (v.z - SKULL_Z).atan2(v.x);
        let strands = fractal(Vec3::new(around * 14.0, v.y * 0.006, 0.0), 3, seed ^ 1);
        *a *= (1.0 + 0.7 * strands).max(0.25);
    }
    prop
}

/// A cap with a visor.
pub fn cap(rng: &mut ChaCha8Rng) -> Prop {
    let albedo = rng.random_range(0.02..0.6);
    // Half width, height over the edge, half depth.
    let size = Vec3::new(
        rng.random_range(82.0..90.0),
        rng.random_range(74.0..90.0),
        rng.random_range(104.0..112.0),
    );
    let edge = rng.random_range(-62.0..-44.0f32);
    let seed = rng.random();
    let mut prop = Prop::opaque(0.03);
    let rim = |turn: f32, up: f32| {
        let (s, c) = turn.sin_cos();
        let flat = (1.0 - up * up).max(0.0).sqrt();
        Vec3::new(
            s * flat * size.x,
            edge - up * size.y,
            SKULL_Z - c * flat * size.z,
        )
    };
    let turns = |n: usize| (0..=n).map(move |i| i as f32 / n as f32 * std::f32::consts::TAU);
    let dome: Vec<Vec<Vec3>> = (0..=8)
        .map(|k| turns(40).map(|t| rim(t, k as f32 / 8.0)).collect())
        .collect();
    prop.sheet(&dome, albedo);
    if rng.random_bool(0.8) {
        let reach = rng.random_range(45.0..75.0f32);
        let drop = rng.random_range(2.0..26.0f32);
        let visor = albedo * rng.random_range(0.4..1.2);
        let rows: Vec<Vec<Vec3>> = (0..=5)
            .map(|k| {
                let out = k as f32 / 5.0;
                (0..=20)
                    .map(|i| {
                        let across = i as f32 / 10.0 - 1.0;
                        let long = reach * (1.0 - across * across).max(0.0).sqrt();
                        rim(across * 1.15, 0.0)
                            + Vec3::new(0.0, drop * out * (1.0 + 0.6 * across * across), 0.0)
                            - Vec3::Z * long * out
                    })
                    .collect()
            })
            .collect();
        prop.sheet(&rows, visor);
    }
    for (v, a) in prop.vertices.iter().zip(&mut prop.albedo) {
        *a *= (1.0 + 0.25 * fractal(*v * 0.06, 3, seed)).max(0.1);
    }
    prop
}

/// A cloth mask over nose, mouth and chin of `head`.
pub fn mask(rng: &mut ChaCha8Rng, mesh: &Mesh, head: &[Vec3]) -> Prop {
    let at = |i: usize| head[mesh.landmarks[i] as usize];
    let top = at(28).lerp(at(29), rng.random_range(0.0..1.0f32));
    let (ear, chin) = ([at(1), at(15)], at(8));
    // Its upper edge runs from the nose to the ears, its lower one under the chin.
    let worn = |v: u32| -> bool {
        let p = head[v as usize];
        let ear = ear[usize::from(p.x > 0.0)];
        let t = (p.x / ear.x).clamp(0.0, 1.0);
        let upper = top.y + (ear.y + 6.0 - top.y) * t * t;
        p.y > upper && p.y < chin.y + 6.0 - 45.0 * t * t && p.z < ear.z - 4.0
    };
    let (mut prop, index) = skin_part(mesh, head, worn);
    let lips: Vec<u32> = (48..60)
        .filter_map(|i| index.get(&mesh.corner_of(i)).copied())
        .collect();
    close_mouth(&mut prop, &lips);
    stretch(&mut prop);
    let gap = rng.random_range(8.0..12.0f32);
    for v in &mut prop.vertices {
        *v += (*v - Vec3::new(0.0, v.y, 60.0)).normalize_or_zero() * gap;
    }
    let albedo = if rng.random_bool(0.7) {
        rng.random_range(0.35..0.8)
    } else {
        rng.random_range(0.02..0.3)
    };
    let (seed, pleats) = (rng.random(), rng.random_range(0.0..0.25f32));
    let shade = |v: &Vec3| {
        let weave = 1.0 + 0.15 * fractal(*v * 0.08, 2, seed);
        albedo * weave * (1.0 + pleats * (v.y * 0.5).sin())
    };
    prop.albedo = prop.vertices.iter().map(shade).collect();
    prop
}

/// The skin's triangles whose vertices all satisfy `wanted`, and the new number of each vertex.
fn skin_part(
    mesh: &Mesh,
    head: &[Vec3],
    wanted: impl Fn(u32) -> bool,
) -> (Prop, BTreeMap<u32, u32>) {
    let mut prop = Prop::opaque(0.0);
    let mut index: BTreeMap<u32, u32> = BTreeMap::new();
    let run = mesh.run(Material::Skin);
    for (t, uv) in mesh.triangles[run.clone()].iter().zip(&mesh.corner_uv[run]) {
        if uv[0].x > 1.0 || !t.iter().all(|v| wanted(*v)) {
            continue;
        }
        prop.triangles.push(t.map(|v| {
            let next = index.len() as u32;
            *index.entry(v).or_insert_with(|| {
                prop.vertices.push(head[v as usize]);
                next
            })
        }));
    }
    (prop, index)
}

/// Closes the skin's hole inside the lips with a fan of triangles.
fn close_mouth(prop: &mut Prop, lips: &[u32]) {
    let middle = prop.vertices.len() as u32;
    let sum: Vec3 = lips.iter().map(|v| prop.vertices[*v as usize]).sum();
    prop.vertices.push(sum / lips.len().max(1) as f32);
    for (k, a) in lips.iter().enumerate() {
        let b = lips[(k + 1) % lips.len()];
        prop.triangles.push([*a, b, middle]);
    }
}

/// Moves vertices outwards to the mean of their neighbours, so that cloth spans lips and nostrils.
fn stretch(prop: &mut Prop) {
    let pairs: Vec<(u32, u32)> = prop
        .triangles
        .iter()
        .flat_map(|[a, b, c]| [(*a, *b), (*b, *c), (*c, *a)])
        .collect();
    for _ in 0..30 {
        let mut sums = vec![(Vec3::ZERO, 0.0f32); prop.vertices.len()];
        for (a, b) in &pairs {
            for (to, from) in [(a, b), (b, a)] {
                let sum = &mut sums[*to as usize];
                *sum = (sum.0 + prop.vertices[*from as usize], sum.1 + 1.0);
            }
        }
        for (v, (sum, n)) in prop.vertices.iter_mut().zip(&sums) {
            let mean = *sum / n.max(1.0);
            v.z = v.z.min(mean.z);
        }
    }
}
