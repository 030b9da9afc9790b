//! Draws random samples: a person, an expression, a pose, lights, surroundings, a camera.

use super::contour::{Landmarker, Points, is_drawn};
use super::deform::Deformation;
use super::draw::{Eyes, Posed, Prop, Scene, View, draw};
use super::effects::Camera;
use super::environment::{Panorama, Sky};
use super::expression::{Expression, random_gaze};
use super::eye_truth::{EyeTruth, eye_truth};
use super::lids::Lids;
use super::light::Lights;
use super::makehuman::{Family, Groups, Member};
use super::mesh::{IDENTITIES, Mesh};
use super::noise::normal;
use super::people::People;
use super::person::Person;
use super::raster::Target;
use super::spec::SampleSpec;
use super::{accessories, background, dead_leaves, props};
use glam::{Mat3, Vec2, Vec3};
use image::GrayImage;
use posewise::math::{HeadAngles, head_rotation};
use posewise::shape::{FITTED, Intrinsics, LANDMARKS};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::sync::Arc;

/// A rendered face with its truth.
#[derive(Clone, Debug)]
pub struct Sample {
    /// 8-bit luma, row-major.
    pub luma: Vec<u8>,
    /// Pixels per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// The 68 points; the jaw follows the visible outline.
    pub landmarks: [Vec2; LANDMARKS],
    /// Whether each is seen: neither turned away nor covered.
    pub visible: [bool; LANDMARKS],
    /// The 68 fixed vertices \[mm, camera axes\].
    pub points3d: [Vec3; LANDMARKS],
    /// Head pose.
    pub angles: HeadAngles,
    /// The head's origin in camera axes \[mm\].
    pub position: Vec3,
    /// The camera.
    pub camera: Intrinsics,
    /// Weights of `posewise::shape::FITTED_NAMES`.
    pub animation: [f32; FITTED],
    /// Who it is; procedural people count down from `u32::MAX`.
    pub person: u32,
}

/// A sample, and the head that it shows.
pub struct Rendered {
    /// The sample.
    pub sample: Sample,
    /// The truth of the image left's and the image right's eye.
    pub eyes: [EyeTruth; 2],
    /// Groups that the person belongs to; only MakeHuman's heads tell.
    pub groups: Option<Groups>,
    /// Its expression.
    pub expression: Expression,
    /// Its skin, without hair that stands off it.
    pub skin: Posed,
    view: View,
    depths: Target,
}

impl Rendered {
    /// Whether the head is one of MakeHuman's.
    pub fn is_makehuman(&self) -> bool {
        self.groups.is_some()
    }

    /// Whether a point of the skin with this normal (camera axes) is seen: it faces the camera, and
    /// nothing is before it.
    pub fn shows(&self, point: Vec3, normal: Vec3) -> bool {
        normal.dot(point) < 0.0 && is_drawn(point, &self.view, &self.depths)
    }
}

/// Changes the seed of a person's pictures from that of the person.
const PICTURES: u64 = 0x9c_70e5;

/// Share of samples among a panorama that it is also behind. It is coarser than a photograph.
const SKY_BEHIND: f64 = 0.35;
/// Share of synthetic scenes without pieces of photographs, where no photographed scenes are.
const LEAVES: f64 = 0.3;

/// Pictures that heads are drawn before.
#[derive(Default)]
pub struct Behind {
    /// Scenes without people.
    pub scenes: Vec<GrayImage>,
    /// Photographs of people, of which pieces are behind others where there are no scenes.
    pub people: Vec<GrayImage>,
}

/// Draws samples; one for all threads.
pub struct Renderer {
    /// The head.
    pub mesh: Mesh,
    /// Finds the 68 points.
    pub landmarker: Landmarker,
    people: People,
    behind: Behind,
    makehuman: Option<Family>,
    panoramas: Vec<Arc<Panorama>>,
}

impl Renderer {
    /// A renderer of these people before these pictures. `offsets_mm` (head axes) says where
    /// photographs' labels sit against the head's vertices; empty: on them.
    pub fn new(mesh: Mesh, people: People, behind: Behind, offsets_mm: &[[f32; 3]]) -> Renderer {
        Renderer {
            landmarker: Landmarker::new(&mesh, offsets_mm).levelled(&mesh),
            mesh,
            people,
            behind,
            makehuman: None,
            panoramas: Vec::new(),
        }
    }

    /// The same with a second family of heads.
    pub fn with_makehuman(self, family: Family) -> Renderer {
        Renderer {
            makehuman: Some(family),
            ..self
        }
    }

    /// The same among panoramas.
    pub fn with_panoramas(self, panoramas: Vec<Arc<Panorama>>) -> Renderer {
        Renderer { panoramas, ..self }
    }

    /// Sample `index` of a seed; the same every time.
    pub fn sample(&self, seed: u64, index: u64, spec: &SampleSpec) -> Sample {
        self.render(seed, index, spec).sample
    }

    /// The mesh of a family of heads: MakeHuman's, or the morphable head.
    pub fn mesh_of(&self, is_makehuman: bool) -> &Mesh {
        let second = self.makehuman.as_ref().filter(|_| is_makehuman);
        second.map_or(&self.mesh, |family| &family.mesh)
    }

    /// The same sample with all that is known of the head in it.
    pub fn render(&self, seed: u64, index: u64, spec: &SampleSpec) -> Rendered {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(index);
        let rng = &mut rng;
        let spec = &spec.drawn(rng);
        let subject = &self.subject(rng, spec, None);
        self.picture(rng, spec, subject)
    }

    /// Picture `index` of a person of a seed with an expression; the same person for every index.
    /// Of the expression, what the person's head cannot do is left out.
    pub fn portray(
        &self,
        [seed, person, index]: [u64; 3],
        spec: &SampleSpec,
        expression: &Expression,
    ) -> Rendered {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(person);
        let spec = &spec.drawn(&mut rng);
        let subject = &self.subject(&mut rng, spec, Some(expression));
        let mut rng = ChaCha8Rng::seed_from_u64(seed ^ PICTURES);
        rng.set_stream((person << 16) + index);
        self.picture(&mut rng, spec, subject)
    }

    /// A picture of someone.
    fn picture(&self, rng: &mut ChaCha8Rng, spec: &SampleSpec, subject: &Subject<'_>) -> Rendered {
        let (mesh, person, head) = (subject.mesh, subject.person(), &subject.head);
        let angles = random_angles(rng, spec);
        let pose = Pose::random(rng, angles);
        let posed = Posed::new(mesh, head, &person.painted.push_mm, pose.rotation, pose.at);
        let (view, face_px) = frame(rng, mesh, &posed, spec);
        let infrared = rng.random_bool(spec.infrared);
        let mut lights = Lights::random(rng, infrared);
        if !self.panoramas.is_empty() && !infrared && some(rng, spec.panoramas) {
            self.surround(rng, &mut lights, pose.rotation);
        }
        let props = self.props(rng, spec, subject, &posed, &pose);
        let mut eyes = random_eyes(rng, &subject.expression, person, spec);
        if infrared && some(rng, spec.bright_pupils) {
            eyes.retro = rng.random_range(0.3..1.5);
        }
        let behind = self.behind(rng, &view, &lights, spec);
        let mut scene = Scene {
            mesh,
            head: &posed,
            painted: &person.painted,
            eyes,
            props: &props,
            lights: &lights,
        };
        // The jaw is on the skin, not on hair that stands off it.
        let skin = Posed::new(mesh, head, &[], pose.rotation, pose.at);
        let roll_deg = angles.roll_deg;
        let points_of = |drawn: &_| subject.landmarker.points(&skin, &view, drawn, roll_deg);
        let mut drawn = draw(&scene, &view, &behind);
        let mut points = points_of(&drawn);
        if !points.show_a_face() && subject.hair.is_some() {
            scene.props = &props[1..];
            drawn = draw(&scene, &view, &behind);
            points = points_of(&drawn);
        }
        let truth = [0, 1].map(|k| eye_truth(k, &scene, &view, &drawn));
        let camera = Camera::random(
            rng,
            face_px,
            face_light(&drawn.light, &view, &points),
            spec.defects,
        );
        let mut light = drawn.light;
        let luma = camera.develop(rng, &mut light, view.width);
        let sample = Sample {
            luma,
            width: view.width,
            height: view.height,
            landmarks: points.contour,
            visible: points.contour_seen,
            points3d: points.solid,
            angles,
            position: pose.at,
            camera: view.camera,
            animation: subject.expression.animation(),
            person: person.id,
        };
        Rendered {
            sample,
            eyes: truth,
            groups: match &subject.who {
                Who::MakeHuman(member) => Some(member.groups()),
                Who::Morphable(_) => None,
            },
            expression: subject.expression.clone(),
            skin,
            view,
            depths: drawn.target,
        }
    }

    /// Someone with an expression.
    fn subject(
        &self,
        rng: &mut ChaCha8Rng,
        spec: &SampleSpec,
        expression: Option<&Expression>,
    ) -> Subject<'_> {
        let family = (self.makehuman.as_ref()).filter(|_| some(rng, spec.makehuman));
        if let Some(family) = family {
            return self.makehuman(rng, family, spec, expression);
        }
        let person = self.people.pick(rng, &self.mesh, spec.persons);
        let (head, expression) = self.head(rng, &person, spec, expression);
        Subject {
            mesh: &self.mesh,
            landmarker: &self.landmarker,
            who: Who::Morphable(person),
            head,
            expression,
            hair: None,
            strands: Vec::new(),
            size: 1.0,
        }
    }

    /// One of the second family.
    fn makehuman<'a>(
        &self,
        rng: &mut ChaCha8Rng,
        family: &'a Family,
        spec: &SampleSpec,
        expression: Option<&Expression>,
    ) -> Subject<'a> {
        let member = family.pick(rng);
        let mesh = &family.mesh;
        let calm = if spec.everyday > 0.0 { 0.75 } else { 1.0 };
        let neutral = family.neutral(rng, &member, calm);
        let mut expression = expression.map_or_else(|| random_expression(rng, spec), Clone::clone);
        expression.keep(mesh);
        let deformation = Deformation::random(rng, mesh, 0.5 * calm);
        let vertices = |weights: &[(usize, f32)]| {
            let mut head = neutral.clone();
            mesh.express(&mut head, weights);
            head.iter_mut().for_each(|v| *v = deformation.apply(*v));
            mesh.settle(&mut head);
            head
        };
        let lids = Lids::new(mesh, vertices);
        let mut weights = expression.weights(mesh);
        lids.shut(mesh, &mut weights);
        let mut head = vertices(&weights);
        lids.cover_eyeballs(mesh, &mut head);
        mesh.settle(&mut head);
        Subject {
            mesh,
            landmarker: &family.landmarker,
            hair: family.hair(&member, &head),
            strands: family.strands(&member, &head),
            size: family.size(&neutral),
            who: Who::MakeHuman(member),
            head,
            expression,
        }
    }

    /// The vertices of a head of this person (head axes), and its expression.
    fn head(
        &self,
        rng: &mut ChaCha8Rng,
        person: &Person,
        spec: &SampleSpec,
        expression: Option<&Expression>,
    ) -> (Vec<Vec3>, Expression) {
        let identity = self.identity(rng, person);
        let expression = expression.map_or_else(|| random_expression(rng, spec), Clone::clone);
        let mut weights = expression.weights(&self.mesh);
        let strength = deformation_of(person, spec);
        let deformation = Deformation::random(rng, &self.mesh, strength);
        let vertices = |weights: &[(usize, f32)]| {
            let mut head = self.mesh.vertices(&identity, weights);
            head.iter_mut().for_each(|v| *v = deformation.apply(*v));
            head
        };
        if !spec.shutting {
            return (vertices(&weights), expression);
        }
        let lids = Lids::new(&self.mesh, vertices);
        lids.shut(&self.mesh, &mut weights);
        let mut head = vertices(&weights);
        lids.cover_eyeballs(&self.mesh, &mut head);
        (head, expression)
    }

    fn identity(&self, rng: &mut ChaCha8Rng, person: &Person) -> Vec<f32> {
        // A procedural skin fits anybody; a photographed one mostly its owner.
        let spread = if person.identity.is_empty() { 1.1 } else { 0.4 };
        (0..IDENTITIES)
            .map(|k| {
                let own = person.identity.get(k).copied().unwrap_or(0.0);
                own + spread * normal(rng).clamp(-2.5, 2.5)
            })
            .collect()
    }

    /// Puts a panorama round a head, in place of the lamps or beside a weaker one.
    fn surround(&self, rng: &mut ChaCha8Rng, lights: &mut Lights, rotation: Mat3) {
        let level = rng.random_range(0.45..1.0);
        let (sky, key) = Sky::random(rng, &self.panoramas, rotation, level);
        let lamp = rng.random_bool(0.25);
        if !lamp || key.length() > lights.key_power {
            lights.key_power = key.length();
            lights.key = key.normalize_or(-Vec3::Z);
        } else {
            lights.key_power *= 0.6;
        }
        lights.ambient = 0.0;
        lights.fill_power *= if lamp { 1.0 } else { 0.0 };
        lights.sky = Some(sky);
    }

    /// What is behind the head, in linear light.
    fn behind(
        &self,
        rng: &mut ChaCha8Rng,
        view: &View,
        lights: &Lights,
        spec: &SampleSpec,
    ) -> Vec<f32> {
        if let Some(sky) = lights.sky.as_ref().filter(|_| rng.random_bool(SKY_BEHIND)) {
            let wide = rng.random_range(1.0..3.5f32);
            return sky.background([view.width, view.height], &view.camera, wide);
        }
        let mut behind = self.background(rng, view, spec);
        let level = rng.random_range(0.3..1.6);
        behind.iter_mut().for_each(|b| *b *= level);
        behind
    }

    fn background(&self, rng: &mut ChaCha8Rng, view: &View, spec: &SampleSpec) -> Vec<f32> {
        let (width, height) = (view.width, view.height);
        if !rng.random_bool(spec.photo_backgrounds) {
            return background::procedural(rng, width, height);
        }
        let Behind { scenes, people } = &self.behind;
        if !scenes.is_empty() {
            let pick = &scenes[rng.random_range(0..scenes.len())];
            return background::from_photo(rng, pick, width, height);
        }
        let is_plain = people.is_empty() || rng.random_bool(LEAVES);
        let scene = dead_leaves::scene(rng, width, height);
        match is_plain {
            true => scene,
            false => background::collage(rng, people, scene, width),
        }
    }

    /// What is drawn beside the head (camera axes); a mesh of hair, if there is one, comes first.
    fn props(
        &self,
        rng: &mut ChaCha8Rng,
        spec: &SampleSpec,
        subject: &Subject,
        posed: &Posed,
        pose: &Pose,
    ) -> Vec<Prop> {
        let (mesh, person, head) = (subject.mesh, subject.person(), &subject.head);
        let seed = rng.random();
        let mut torso = props::torso(pose.angles, pose.rotation, pose.at, person.cloth, seed);
        for v in &mut torso.vertices {
            *v = pose.at + (*v - pose.at) * subject.size;
        }
        let mut all: Vec<Prop> = subject.hair.iter().cloned().collect();
        accessories::wear(&mut all, pose.rotation, pose.at);
        all.push(torso);
        if rng.random_bool(spec.glasses) {
            let mut worn = accessories::glasses(rng, mesh, head);
            accessories::wear(&mut worn, pose.rotation, pose.at);
            all.extend(worn);
        }
        let mut worn = self.worn(rng, spec, subject);
        worn.extend(subject.strands.iter().cloned());
        accessories::wear(&mut worn, pose.rotation, pose.at);
        all.extend(worn);
        if rng.random_bool(spec.occluders) {
            let over = mesh.landmarks[rng.random_range(0..LANDMARKS)] as usize;
            let point = posed.vertices[over];
            let gap = rng.random_range(25.0..70.0);
            let over = point - point.normalize() * gap;
            let hand = rng.random_bool(0.65);
            let albedo = person.skin * rng.random_range(0.6..1.3);
            all.push(match hand {
                true => props::hand(rng, over, albedo),
                false => props::lump(rng, over),
            });
        }
        all
    }

    /// Long hair, a cap, a mask (head axes).
    fn worn(&self, rng: &mut ChaCha8Rng, spec: &SampleSpec, subject: &Subject) -> Vec<Prop> {
        let (mesh, person, head) = (subject.mesh, subject.person(), &subject.head);
        let [hair, cap, mask] =
            [spec.long_hair, spec.caps, spec.masks].map(|share| some(rng, share));
        let at = |i: usize| head[mesh.landmarks[i] as usize];
        let mut all = Vec::new();
        if let Some(albedo) = person.hair.filter(|_| hair) {
            all.push(accessories::long_hair(rng, [at(0), at(16)], albedo));
        }
        if cap {
            all.push(accessories::cap(rng));
        }
        if mask {
            all.push(accessories::mask(rng, mesh, head));
        }
        all
    }
}

/// Someone to be drawn.
struct Subject<'a> {
    mesh: &'a Mesh,
    landmarker: &'a Landmarker,
    who: Who,
    /// Vertices (head axes).
    head: Vec<Vec3>,
    expression: Expression,
    /// A mesh of hair (head axes).
    hair: Option<Prop>,
    /// Brows and lashes (head axes).
    strands: Vec<Prop>,
    /// Against an adult.
    size: f32,
}

enum Who {
    Morphable(Arc<Person>),
    MakeHuman(Arc<Member>),
}

impl Subject<'_> {
    fn person(&self) -> &Person {
        match &self.who {
            Who::Morphable(person) => person,
            Who::MakeHuman(member) => &member.person,
        }
    }
}

/// A camera that frames the 68 points with the wanted margin, and the box's longer side.
fn frame(rng: &mut ChaCha8Rng, mesh: &Mesh, posed: &Posed, spec: &SampleSpec) -> (View, f32) {
    let face_px = rng.random_range(spec.face_px.0..=spec.face_px.1);
    let unit = View::unit();
    let points = mesh
        .landmarks
        .map(|v| unit.project(posed.vertices[v as usize]));
    let low = points.iter().fold(Vec2::MAX, |m, p| m.min(*p));
    let high = points.iter().fold(Vec2::MIN, |m, p| m.max(*p));
    let focal = face_px / (high - low).max_element().max(1e-6);
    let side = (face_px * (1.0 + 2.0 * spec.margin)).round();
    let jitter = Vec2::new(rng.random_range(-0.5..0.5), rng.random_range(-0.5..0.5));
    let centre = Vec2::splat((side - 1.0) / 2.0) + jitter - (low + high) * 0.5 * focal;
    let view = View {
        width: side as usize,
        height: side as usize,
        camera: Intrinsics::new(focal, focal, centre.x, centre.y),
    };
    (view, face_px)
}

fn random_expression(rng: &mut ChaCha8Rng, spec: &SampleSpec) -> Expression {
    let mut expression = Expression::random(rng);
    if some(rng, spec.closing) {
        expression.close(rng);
    }
    if some(rng, spec.looking) {
        expression.look(rng);
    }
    expression
}

fn random_eyes(
    rng: &mut ChaCha8Rng,
    expression: &Expression,
    person: &Person,
    spec: &SampleSpec,
) -> Eyes {
    let mut eyes = Eyes {
        gaze: random_gaze(rng, expression),
        // Shaded and seen through a wet film it is hardly brighter than pale skin.
        white: rng.random_range(0.2..0.32) + 0.4 * person.skin,
        iris: person.iris,
        pupil: rng.random_range(0.25..0.6),
        mottled: 0.0,
        retro: 0.0,
    };
    if some(rng, spec.odd_eyes) {
        eyes.white = rng.random_range(0.05..1.1);
        eyes.mottled = rng.random_range(0.0..0.8f32).max(0.2) - 0.2;
        if rng.random_bool(0.3) {
            eyes.iris = eyes.white;
            eyes.pupil = 0.0;
        }
    }
    eyes
}

/// How strongly a person's head is deformed: a photographed skin fits others than its owner less.
fn deformation_of(person: &Person, spec: &SampleSpec) -> f32 {
    let strength = if spec.everyday > 0.0 { 0.4 } else { 1.0 };
    strength * if person.identity.is_empty() { 1.0 } else { 0.5 }
}

/// True in that share of the cases; a share of 0 draws nothing from the generator.
fn some(rng: &mut ChaCha8Rng, share: f64) -> bool {
    share > 0.0 && rng.random_bool(share)
}

/// Where a head is.
pub struct Pose {
    /// Its angles against the camera's axes.
    pub angles: HeadAngles,
    /// Head to camera.
    pub rotation: Mat3,
    /// Its origin \[mm, camera axes\].
    pub at: Vec3,
}

impl Pose {
    fn random(rng: &mut ChaCha8Rng, angles: HeadAngles) -> Pose {
        let far = 320.0 * (1500.0f32 / 320.0).powf(rng.random_range(0.0..1.0));
        // Off the optical axis as faces are in a frame of about 60°.
        let aside = Vec2::new(rng.random_range(-0.28..0.28), rng.random_range(-0.2..0.2));
        Pose {
            angles,
            rotation: head_rotation(angles),
            at: (aside * far).extend(far),
        }
    }
}

fn random_angles(rng: &mut ChaCha8Rng, spec: &SampleSpec) -> HeadAngles {
    let inner = spec.yaw_deg * 2.0 / 3.0;
    let yaw = if rng.random_bool(spec.inner_share as f64) {
        rng.random_range(0.0..=inner)
    } else {
        rng.random_range(inner..=spec.yaw_deg)
    };
    // Pitch and roll crowd round zero: the mean of two uniforms.
    let peaked = |rng: &mut ChaCha8Rng, most: f32| {
        let (a, b): (f32, f32) = (rng.random_range(-1.0..1.0), rng.random_range(-1.0..1.0));
        most * if rng.random_bool(0.5) {
            a
        } else {
            0.5 * (a + b)
        }
    };
    HeadAngles {
        yaw_deg: if rng.random_bool(0.5) { yaw } else { -yaw },
        pitch_deg: peaked(rng, spec.pitch_deg),
        roll_deg: peaked(rng, spec.roll_deg),
    }
}

/// Mean linear light where the inner landmarks are.
fn face_light(light: &[f32], view: &View, points: &Points) -> f32 {
    let at = |p: &Vec2| {
        let (x, y) = (p.x.round() as i64, p.y.round() as i64);
        let inside = (0..view.width as i64).contains(&x) && (0..view.height as i64).contains(&y);
        inside.then(|| light[y as usize * view.width + x as usize])
    };
    let values: Vec<f32> = points.fixed[17..60].iter().filter_map(at).collect();
    values.iter().sum::<f32>() / values.len().max(1) as f32
}
