//! The dense mesh: it lies where the landmarks are, and every wrong call is refused with a reason.

use crate::common::{demo, grey, model, tracker};
use glam::Vec3;
use posewise::ffi::types::posewise_mesh_vertex;
use posewise::mesh::{MAX_VERTICES, MeshError, MeshLine, MeshShape, MeshSpace, MeshVertex};
use posewise::{ANIMATION_NAMES, ANIMATIONS, Config, Model, State, Tracker};
use posewise_format::{AlignedBytes, without};

/// What no mesh has.
const UNTOUCHED: MeshVertex = MeshVertex {
    x: -77.0,
    y: -77.0,
    z: -77.0,
    visibility: -77.0,
};

/// Calls `look` after each frame of the demo clip in which the face is tracked.
fn watch(model: &Model<'_>, mut look: impl FnMut(&Tracker)) {
    let clip = demo();
    let mut tracker = tracker(&Config::default());
    for i in 0..clip.luma.len() {
        let result = tracker.step(model, &clip.frame(i), clip.time_us(i));
        if result.expect("in order").state == State::Tracking {
            look(&tracker);
        }
    }
}

fn mesh(tracker: &Tracker, model: &Model<'_>, space: MeshSpace) -> Vec<MeshVertex> {
    let mut vertices = [UNTOUCHED; MAX_VERTICES];
    let count = tracker.mesh(model, space, &mut vertices);
    vertices[..count.expect("a face")].to_vec()
}

#[test]
fn vertices_of_landmarks_lie_at_the_landmarks() {
    let model = model();
    let mut checked = 0;
    watch(&model, |tracker| {
        let vertices = mesh(tracker, &model, MeshSpace::Picture);
        let landmarks = tracker.result().landmarks.iter().zip(&vertices);
        // Those of the jaw follow the contour, the vertices are fixed points of the head.
        for (landmark, vertex) in landmarks.skip(17) {
            if landmark.confidence * landmark.visibility >= 0.5 {
                let off = (vertex.x - landmark.x).hypot(vertex.y - landmark.y);
                assert!(off < 0.01, "{off} px off: {landmark:?} {vertex:?}");
                checked += 1;
            }
        }
    });
    assert!(checked > 2000, "{checked} landmarks");
}

#[test]
fn the_spaces_show_the_same_face() {
    let model = model();
    watch(&model, |tracker| {
        let [picture, camera, head] = [MeshSpace::Picture, MeshSpace::Camera, MeshSpace::Head]
            .map(|space| mesh(tracker, &model, space));
        let result = tracker.result();
        let f = result.focal_px;
        for ((p, c), h) in picture.iter().zip(&camera).zip(&head) {
            // The clip's frames have 320×240 pixels.
            let (x, y) = (f * c.x / c.z + 159.5, f * c.y / c.z + 119.5);
            assert!((p.x - x).abs() < 0.01 && (p.y - y).abs() < 0.01 && p.z == c.z);
            let far = |v: &MeshVertex, from: [f32; 3]| {
                (v.x - from[0]).hypot(v.y - from[1]).hypot(v.z - from[2])
            };
            let apart = far(c, result.translation_mm) - far(h, [0.0; 3]);
            assert!(apart.abs() < 0.05, "{apart}");
            assert_eq!((p.visibility, c.visibility), (h.visibility, h.visibility));
        }
        // The tip of the nose is before the eyes and below them.
        assert!(head[30].z < -30.0 && head[30].y > 20.0 && head[30].visibility == 1.0);
    });
}

#[test]
fn wrong_calls_say_why_and_write_nothing() {
    let model = model();
    let mut vertices = [UNTOUCHED; MAX_VERTICES];
    let mut refused = |tracker: &Tracker, model: &Model<'_>, room: usize, why: MeshError| {
        let answer = tracker.mesh(model, MeshSpace::Camera, &mut vertices[..room]);
        assert_eq!(answer, Err(why));
        assert!(vertices.iter().all(|v| *v == UNTOUCHED));
    };
    let new = tracker(&Config::default());
    refused(&new, &model, MAX_VERTICES, MeshError::NoFace);
    let bytes = without(posewise::DEFAULT_MODEL, &[*b"MESH"]);
    let bytes = AlignedBytes::new(&bytes.expect("a model"));
    let bare = Model::load(&bytes).expect("the section is optional");
    assert!(bare.mesh_topology().is_none());
    let count = model.mesh_topology().expect("a mesh").vertices;
    let mut frames = 0;
    watch(&model, |tracker| {
        refused(tracker, &bare, MAX_VERTICES, MeshError::NoMesh);
        let too_small = MeshError::Capacity { vertices: count };
        refused(tracker, &model, count - 1, too_small);
        refused(tracker, &model, 0, too_small);
        frames += 1;
    });
    assert!(frames > 0);
    assert_eq!(size_of::<posewise_mesh_vertex>(), size_of::<MeshVertex>());
}

#[test]
fn lines_are_joined_by_triangles() {
    let model = model();
    let topology = model.mesh_topology().expect("a mesh");
    assert!((468..=MAX_VERTICES).contains(&topology.vertices));
    assert!(topology.line(MeshLine::Landmarks).iter().copied().eq(0..68));
    let is_edge = |a: u16, b: u16| {
        (topology.triangles.iter()).any(|corners| corners.contains(&a) && corners.contains(&b))
    };
    for line in MeshLine::ALL.into_iter().skip(1) {
        let vertices = topology.line(line);
        let brow = matches!(line, MeshLine::LeftBrow | MeshLine::RightBrow);
        let next = vertices
            .iter()
            .skip(1)
            .chain(vertices.first().filter(|_| !brow));
        let joined = vertices.iter().zip(next);
        assert!(vertices.len() >= 5);
        assert!(joined.into_iter().all(|(a, b)| is_edge(*a, *b)), "{line:?}");
    }
}

/// The shape of the person's own head.
fn shape(tracker: &Tracker, model: &Model<'_>, shape: MeshShape) -> Vec<Vec3> {
    let mut vertices = [UNTOUCHED; MAX_VERTICES];
    let count = tracker.mesh_shape(model, shape, &mut vertices);
    let vertices = &vertices[..count.expect("a face")];
    assert!(vertices.iter().all(|v| v.visibility == 1.0));
    vertices.iter().map(|v| Vec3::new(v.x, v.y, v.z)).collect()
}

#[test]
fn shapes_and_weights_give_the_face() {
    let model = model();
    let mut last = Vec::new();
    watch(&model, |tracker| {
        let neutral = shape(tracker, &model, MeshShape::Neutral);
        let mut face = neutral.clone();
        for (index, weight) in tracker.result().animation.into_iter().enumerate() {
            let shape = shape(tracker, &model, MeshShape::Animation(index));
            for ((point, neutral), moved) in face.iter_mut().zip(&neutral).zip(&shape) {
                *point += weight * (*moved - *neutral);
            }
        }
        // What is left is what landmarks drew.
        let drawn = mesh(tracker, &model, MeshSpace::Head);
        let off = (face.iter().zip(&drawn)).map(|(a, b)| a.distance(Vec3::new(b.x, b.y, b.z)));
        let mean = off.sum::<f32>() / face.len() as f32;
        assert!(mean < 4.0, "{mean} mm");
        last = neutral;
    });
    // Between the eyes is the origin, the nose is before it, the chin below.
    assert!(last[27].length() < 40.0 && last[30].z < -30.0 && last[8].y > 70.0);
}

#[test]
fn every_weight_moves_its_part_of_the_head() {
    let model = model();
    let mut tracker = tracker(&Config::default());
    let clip = demo();
    for i in 0..10 {
        let step = tracker.step(&model, &clip.frame(i), clip.time_us(i));
        step.expect("in order");
    }
    let neutral = shape(&tracker, &model, MeshShape::Neutral);
    let moves = |name: &str| -> Vec<Vec3> {
        let index = ANIMATION_NAMES.iter().position(|known| *known == name);
        let index = index.unwrap_or_else(|| panic!("{name}"));
        let shape = shape(&tracker, &model, MeshShape::Animation(index));
        shape.iter().zip(&neutral).map(|(a, b)| *a - *b).collect()
    };
    for name in ANIMATION_NAMES {
        let most = moves(name)
            .into_iter()
            .map(Vec3::length)
            .fold(0.0, f32::max);
        assert!((1.0..60.0).contains(&most), "{name}: {most} mm");
    }
    // The chin goes down, and the brows stay; the upper lids come down.
    let jaw = moves("jawOpen");
    assert!(
        jaw[8].y > 5.0 && jaw[19].length() < 0.5,
        "{} {}",
        jaw[8],
        jaw[19]
    );
    let blink = moves("eyeBlinkLeft");
    assert!(blink[43].y > 2.0 && blink[37].length() < 0.5);
}

#[test]
fn the_shape_outlives_the_face_but_no_reset() {
    let model = model();
    let mut vertices = [UNTOUCHED; MAX_VERTICES];
    let mut refused = |tracker: &Tracker, shape: MeshShape, room: usize, why: MeshError| {
        let answer = tracker.mesh_shape(&model, shape, &mut vertices[..room]);
        assert_eq!(answer, Err(why));
        assert!(vertices.iter().all(|v| *v == UNTOUCHED));
    };
    let mut tracker = tracker(&Config::default());
    refused(
        &tracker,
        MeshShape::Neutral,
        MAX_VERTICES,
        MeshError::NoFace,
    );
    let clip = demo();
    for i in 0..40 {
        let step = tracker.step(&model, &clip.frame(i), clip.time_us(i));
        step.expect("in order");
    }
    let own = shape(&tracker, &model, MeshShape::Neutral);
    let pixels = [128; 320 * 240];
    for i in 0..40 {
        let step = tracker.step(&model, &grey(320, 240, &pixels), clip.time_us(40 + i));
        step.expect("in order");
    }
    assert_eq!(tracker.result().state, State::Searching);
    assert_eq!(shape(&tracker, &model, MeshShape::Neutral), own);
    let count = own.len();
    let too_small = MeshError::Capacity { vertices: count };
    refused(&tracker, MeshShape::Neutral, count - 1, too_small);
    for index in [ANIMATIONS, usize::MAX] {
        refused(
            &tracker,
            MeshShape::Animation(index),
            MAX_VERTICES,
            MeshError::Shape,
        );
    }
    // Without the person's identity it is the mean head.
    tracker.forget_identity();
    let mean = shape(&tracker, &model, MeshShape::Neutral);
    let off = own.iter().zip(&mean).map(|(a, b)| a.distance(*b));
    let off = off.fold(0.0, f32::max);
    assert!((0.5..40.0).contains(&off), "{off} mm");
    tracker.reset();
    refused(
        &tracker,
        MeshShape::Neutral,
        MAX_VERTICES,
        MeshError::NoFace,
    );
}
