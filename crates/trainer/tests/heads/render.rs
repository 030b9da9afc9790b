//! Rendered samples of a head of no one: repeatable, and with landmarks where they belong.

use posewise_train::head::Head;
use posewise_train::render::lids::Lids;
use posewise_train::render::mesh::Mesh;
use posewise_train::render::{Behind, People, Persons, Renderer, SampleSpec, cache};

/// The head with texture coordinates from its frontal view.
fn head() -> Head {
    let mut head = crate::common::head();
    let to_uv = |v: &[f32; 3]| [0.5 + v[0] / 200.0, 0.5 - (v[1] - 30.0) / 260.0];
    head.uv = head.mean.iter().map(to_uv).collect();
    head.triangle_uv = head.triangles.clone();
    head
}

fn renderer() -> Renderer {
    let mesh = Mesh::new(&head()).unwrap();
    let people = People::new(&mesh, 2, 1, false);
    Renderer::new(mesh, people, Behind::default(), &[])
}

fn spec() -> SampleSpec {
    SampleSpec {
        persons: Persons::Procedural,
        face_px: (60.0, 80.0),
        yaw_deg: 45.0,
        occluders: 0.0,
        glasses: 0.0,
        long_hair: 0.0,
        caps: 0.0,
        masks: 0.0,
        ..SampleSpec::default()
    }
}

#[test]
fn a_sample_is_the_same_every_time() {
    let (a, b) = (renderer(), renderer());
    // Another order of drawing changes nothing.
    let first = a.sample(3, 5, &spec());
    let _ = b.sample(3, 4, &spec());
    let second = b.sample(3, 5, &spec());
    assert_eq!(format!("{first:?}"), format!("{second:?}"));
    assert_ne!(first.luma, a.sample(3, 6, &spec()).luma);
    assert_ne!(first.luma, a.sample(4, 5, &spec()).luma);
}

#[test]
fn landmarks_lie_inside_with_the_wanted_margin() {
    let renderer = renderer();
    for index in 0..8 {
        let s = renderer.sample(1, index, &spec());
        assert_eq!(s.luma.len(), s.width * s.height);
        let [low, high] = [0.2, 0.8].map(|share| share * s.width as f32);
        let inside = |v: f32| (low..high).contains(&v);
        assert!(
            s.landmarks.iter().all(|p| inside(p.x) && inside(p.y)),
            "{:?}",
            s.landmarks
        );
        assert!(s.visible[30], "nothing covers the tip of the nose");
    }
}

#[test]
fn the_far_jaw_slides_to_the_outline() {
    let renderer = renderer();
    let turned = (0..64).map(|i| renderer.sample(2, i, &spec()));
    let turned = turned.filter(|s| s.angles.yaw_deg > 25.0 && s.angles.roll_deg.abs() < 8.0);
    let mut seen = 0;
    for s in turned {
        let c = s.camera;
        let vertex = |i: usize| c.fx * s.points3d[i].x / s.points3d[i].z + c.cx;
        // Nose to the image right: the image right's cheek hides its jaw line.
        assert!(
            s.landmarks[14].x >= vertex(14),
            "the far side moves outwards"
        );
        assert!(
            (s.landmarks[2].x - vertex(2)).abs() < 4.0,
            "the near side stays"
        );
        seen += 1;
    }
    assert!(seen > 3);
}

#[test]
fn the_jaw_runs_downwards_beside_the_cheeks() {
    let spec = SampleSpec {
        pitch_deg: 0.0,
        roll_deg: 0.0,
        ..spec()
    };
    let renderer = renderer();
    for index in 0..16 {
        let s = renderer.sample(2, index, &spec);
        for i in 0..6 {
            let [a, b] = [i, i + 1].map(|k| s.landmarks[k].y);
            let [c, d] = [16 - i, 15 - i].map(|k| s.landmarks[k].y);
            assert!(a < b && c < d, "{:?}", s.landmarks);
        }
    }
}

#[test]
fn an_interrupted_cache_goes_on() {
    let renderer = renderer();
    let folder = std::env::temp_dir().join(format!("posewise-cache-{}", std::process::id()));
    let path = folder.join("renders.bin");
    assert_eq!(cache::write(&path, &renderer, 1, 3, &spec()).unwrap(), 3);
    let whole = std::fs::read(&path).unwrap();
    std::fs::write(&path, &whole[..whole.len() - 100]).unwrap();
    assert_eq!(
        cache::write(&path, &renderer, 1, 3, &spec()).unwrap(),
        1,
        "the cut record is drawn again"
    );
    assert_eq!(std::fs::read(&path).unwrap(), whole);
    assert_eq!(cache::read(&path, usize::MAX).unwrap().len(), 3);
    // Another spec starts anew.
    let other = SampleSpec {
        margin: 0.5,
        ..spec()
    };
    assert_eq!(cache::write(&path, &renderer, 1, 2, &other).unwrap(), 2);
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn what_is_worn_hides_what_it_covers() {
    let renderer = renderer();
    let plain = SampleSpec {
        yaw_deg: 15.0,
        pitch_deg: 10.0,
        ..spec()
    };
    let seen = |spec: &SampleSpec, points: std::ops::Range<usize>| -> f32 {
        let share = |index: u64| {
            let sample = renderer.sample(5, index, spec);
            let seen = points.clone().filter(|i| sample.visible[*i]).count();
            seen as f32 / points.len() as f32
        };
        (0..12).map(share).sum::<f32>() / 12.0
    };
    let masked = SampleSpec {
        masks: 1.0,
        ..plain.clone()
    };
    let (bare_mouth, bare_eyes) = (seen(&plain, 48..60), seen(&plain, 36..48));
    assert!(seen(&masked, 48..60) < 0.2 * bare_mouth);
    assert!(seen(&masked, 36..48) > 0.9 * bare_eyes);
    for worn in [
        SampleSpec {
            long_hair: 1.0,
            ..plain.clone()
        },
        SampleSpec {
            caps: 1.0,
            ..plain.clone()
        },
    ] {
        assert!(seen(&worn, 48..60) > 0.9 * bare_mouth);
        assert_ne!(
            renderer.sample(5, 0, &worn).luma,
            renderer.sample(5, 0, &plain).luma
        );
    }
}

#[test]
fn a_blink_shuts_wide_and_narrow_eyes() {
    let mut mesh = Mesh::new(&head()).unwrap();
    let weights = |blink: f32| {
        let names = ["eyeBlinkLeft", "eyeBlinkRight"];
        names.map(|name| (mesh.shape(name).unwrap(), blink))
    };
    let weights = [0.0, 0.5, 1.0].map(weights);
    // The second identity mode stretches the head along its vertical axis.
    for stretch in [-4.0, 0.0, 4.0] {
        // Four times the head's own blink, which moves its coarse lids by 3 mm.
        let vertices = |weights: &[(usize, f32)]| {
            let weights: Vec<_> = weights.iter().map(|(at, w)| (*at, 4.0 * w)).collect();
            mesh.vertices(&[0.0, stretch], &weights)
        };
        let lids = Lids::new(&mesh, vertices);
        let gap = |mut weights: [(usize, f32); 2]| {
            lids.shut(&mesh, &mut weights);
            let head = vertices(&weights);
            let at = |i: usize| head[mesh.landmarks[i] as usize].y;
            (at(41) - at(37) + at(40) - at(38)) / 2.0
        };
        let [open, half, shut] = weights.map(gap);
        assert!((shut - 0.5).abs() < 1e-3, "{stretch}: {shut} mm");
        assert!((half - (open + shut) / 2.0).abs() < 1e-3);
    }
    // An eyeball of which two vertices say how large it is, around a corner of the eye.
    let lids = Lids::new(&mesh, |weights| mesh.vertices(&[], weights));
    let mut head = mesh.vertices(&[], &weights[2]);
    let corner = head[mesh.landmarks[37] as usize];
    let (a, b) = (mesh.landmarks[36], mesh.landmarks[39]);
    mesh.eyes[0] = vec![a, b];
    let middle = (head[a as usize] + head[b as usize]) / 2.0;
    assert!(corner.distance(middle) < head[a as usize].distance(middle));
    let radius = head[a as usize].distance(middle);
    lids.cover_eyeballs(&mesh, &mut head);
    assert!(head[mesh.landmarks[37] as usize].distance(middle) > radius + 0.3);
}
