//! Draws the frames of a clip and writes them with their truth.

use super::body::Body;
use super::candide::{Candide, Face};
use super::casting::{Torso, framing, lights, looks, worn};
use super::covers::{Covering, Wearer};
use super::motion::{Moment, Motion};
use super::plan::{Kind, Sweep};
use super::truth::{self, Landmarks, Row};
use anyhow::{Context, Result};
use flate2::{Compression, write::GzEncoder};
use glam::{Mat3, Vec3};
use image::GrayImage;
use posewise::math::head_rotation;
use posewise_train::head::Head;
use posewise_train::render::draw::{Drawn, Eyes, Posed, Prop, Scene, View, draw};
use posewise_train::render::effects::Camera;
use posewise_train::render::expression::{Expression, gaze_directions};
use posewise_train::render::light::Lights;
use posewise_train::render::mesh::Mesh;
use posewise_train::render::person::Person;
use posewise_train::render::{People, accessories, background};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::Serialize;
use std::fs::File;
use std::io::Write;
use std::path::Path;

/// Where the head turns and nods, from its origin between the eyes \[mm, head axes\].
const NECK: Vec3 = Vec3::new(0.0, 70.0, 85.0);
/// Raised when clips of the same plan would come out otherwise.
const VERSION: u32 = 1;

/// What all clips share.
pub struct Studio {
    mesh: Mesh,
    people: People,
    candide: Option<Candide>,
    backgrounds: Vec<GrayImage>,
}

/// What is written beside a clip.
#[derive(Serialize)]
struct Description<'a> {
    version: u32,
    width: usize,
    height: usize,
    backgrounds: usize,
    #[serde(flatten)]
    sweep: &'a Sweep,
}

impl Studio {
    /// With a morphable head and, where there is its file, Candide-3.
    pub fn new(kit: &Head, candide: Option<&Path>, backgrounds: Vec<GrayImage>) -> Result<Self> {
        let mesh = Mesh::new(kit)?;
        Ok(Studio {
            people: People::new(&mesh, 1, 0, false),
            candide: candide.map(|path| Candide::read(path, &mesh)).transpose()?,
            mesh,
            backgrounds,
        })
    }

    /// Writes a clip unless it is there.
    pub fn render(&self, sweep: &Sweep, folder: &Path) -> Result<()> {
        let description = serde_json::to_string_pretty(&Description {
            version: VERSION,
            width: sweep.size[0],
            height: sweep.size[1],
            backgrounds: self.background_count(),
            sweep,
        })?;
        write_clip(sweep, folder, &description, truth::columns(), || {
            let mut set = Set::new(self, sweep)?;
            Ok(move |number| {
                let moment = set.moment(number);
                let (luma, row) = set.frame(number, moment);
                Ok((luma, row.text()?))
            })
        })
    }

    /// How many pictures clips are drawn before.
    pub fn background_count(&self) -> usize {
        self.backgrounds.len()
    }
}

/// Writes a clip (.y4m.gz), its truth (.csv) and its description (.json), unless that is there and
/// agrees. `begin` prepares what draws a frame and a row of the truth.
pub fn write_clip<Draw>(
    sweep: &Sweep,
    folder: &Path,
    description: &str,
    columns: String,
    begin: impl FnOnce() -> Result<Draw>,
) -> Result<()>
where
    Draw: FnMut(usize) -> Result<(Vec<u8>, String)>,
{
    let path = |extension: &str| folder.join(format!("{}.{extension}", sweep.name));
    if std::fs::read_to_string(path("json")).is_ok_and(|text| text == description) {
        return Ok(());
    }
    if let Some(parent) = path("json").parent() {
        std::fs::create_dir_all(parent)?;
    }
    let mut draw = begin()?;
    let file = File::create(path("y4m.gz")).with_context(|| sweep.name.clone())?;
    let mut clip = GzEncoder::new(file, Compression::fast());
    let ([width, height], fps) = (sweep.size, sweep.fps);
    writeln!(clip, "YUV4MPEG2 W{width} H{height} F{fps}:1 Ip A1:1 Cmono")?;
    let mut rows = vec![columns];
    for number in 0..sweep.frames {
        let (luma, row) = draw(number)?;
        clip.write_all(b"FRAME\n")?;
        clip.write_all(&luma)?;
        rows.push(row);
    }
    clip.finish()?;
    std::fs::write(path("csv"), rows.join("\n") + "\n")?;
    // Last, so that an interrupted clip is rendered again.
    std::fs::write(path("json"), description)?;
    Ok(())
}

/// Whose head it is.
enum Kin<'a> {
    Kit(Body),
    Candide(&'a Candide, Face),
}

impl Kin<'_> {
    /// Vertices of the face at rest, head axes.
    fn neutral(&self, mesh: &Mesh) -> Vec<Vec3> {
        match self {
            Kin::Kit(body) => body.vertices(mesh, &Expression::default()),
            Kin::Candide(candide, face) => candide.draw(face, &Expression::default()).0,
        }
    }
}

/// Everything of a clip that stays the same from frame to frame.
pub struct Set<'a> {
    studio: &'a Studio,
    sweep: &'a Sweep,
    kin: Kin<'a>,
    person: Person,
    pub motion: Motion,
    covering: Option<Covering>,
    /// Hair and caps, head axes.
    pub worn: Vec<Prop>,
    torso: Torso,
    pub lights: Lights,
    pub eyes: Eyes,
    pub view: View,
    /// Where the eyes' middle is while the head looks ahead \[mm, camera axes\].
    pub at: Vec3,
    /// How the camera is turned about its axis, against what is before it.
    pub turned: Mat3,
    /// What it is drawn before.
    pub behind: Vec<f32>,
    /// Light that the lens spreads over the picture; empty for none.
    pub glare: Vec<f32>,
    pub camera: Camera,
    pub rng: ChaCha8Rng,
}

/// A head before the camera, and what is drawn of it.
pub struct Figure {
    rotation: Mat3,
    at: Vec3,
    vertices: Vec<Vec3>,
    pub posed: Posed,
    /// Props that are a part of the person's body.
    pub own: Vec<Prop>,
    /// Hair, caps and covers.
    over: Vec<Prop>,
    /// Of these the cover of the clip's script.
    covers: Vec<Prop>,
}

impl<'a> Set<'a> {
    /// Casts a clip and exposes its first frame.
    pub fn new(studio: &'a Studio, sweep: &'a Sweep) -> Result<Set<'a>> {
        let mut set = Set::cast(studio, sweep)?;
        let moment = set.motion.at(0.0);
        set.expose(&moment);
        Ok(set)
    }

    /// Casts a clip, whose exposure is not set.
    pub fn cast(studio: &'a Studio, sweep: &'a Sweep) -> Result<Set<'a>> {
        let seeded = |(seed, stream): (u64, u64)| {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            rng.set_stream(stream);
            rng
        };
        let mut rng = seeded(sweep.seed);
        let mut of_person = sweep.person.map(seeded);
        let rng_ = of_person.as_mut().unwrap_or(&mut rng);
        let looks = looks(rng_, sweep);
        let mesh = &studio.mesh;
        let kin = match (sweep.kind, &studio.candide) {
            (Kind::Candide, candide) => {
                let candide = candide.as_ref().context("no --candide FILE is given")?;
                Kin::Candide(candide, candide.face(rng_, &looks))
            }
            (Kind::Driver(_), _) => Kin::Kit(Body::new(rng_, mesh).shutting(mesh)),
            _ => Kin::Kit(Body::new(rng_, mesh)),
        };
        let neutral = kin.neutral(mesh);
        let number = sweep.person.unwrap_or(sweep.seed).1;
        let person = studio.people.make(mesh, number as u32, &looks);
        let rng_ = &mut rng;
        let covering = sweep
            .kind
            .cover()
            .map(|cover| Covering::new(rng_, cover, mesh, &neutral, looks.skin, looks.hair));
        let (view, at) = framing(rng_, sweep.view_deg, sweep.size);
        let rng_ = of_person.as_mut().unwrap_or(&mut rng);
        let worn = worn(rng_, sweep.hair, mesh, &neutral, looks.hair);
        let rng_ = &mut rng;
        Ok(Set {
            worn,
            motion: Motion::new(rng_, sweep),
            torso: Torso::random(rng_),
            lights: lights(rng_),
            eyes: Eyes {
                gaze: [Vec3::NEG_Z; 2],
                white: rng_.random_range(0.2..0.32) + 0.4 * looks.skin,
                iris: looks.iris,
                pupil: rng_.random_range(0.3..0.55),
                mottled: 0.0,
                retro: 0.0,
            },
            turned: Mat3::IDENTITY,
            behind: studio.background(rng_, sweep.size),
            glare: Vec::new(),
            camera: Camera::random(rng_, 150.0, 1.0, 0.5),
            studio,
            sweep,
            kin,
            person,
            covering,
            view,
            at,
            rng,
        })
    }

    /// Sets the exposure by the face's light at a moment.
    pub fn expose(&mut self, moment: &Moment) {
        self.camera.motion_px = (0.0, 0.0);
        self.camera.jpeg = None;
        let figure = self.figure(moment);
        let drawn = self.drawn(&figure, moment);
        let landmarks = self.landmarks(&figure);
        let [width, height] = self.sweep.size;
        let mut values = Vec::new();
        for p in &landmarks.points[17..60] {
            let (x, y) = (p.x.round() as i64, p.y.round() as i64);
            if (0..width as i64).contains(&x) && (0..height as i64).contains(&y) {
                values.push(drawn.light[y as usize * width + x as usize]);
            }
        }
        let mean = values.iter().sum::<f32>() / values.len().max(1) as f32;
        self.camera.exposure /= mean.max(0.01);
    }

    fn time(&self, number: usize) -> f32 {
        number as f32 / self.sweep.fps as f32
    }

    fn moment(&self, number: usize) -> Moment {
        self.motion.at(self.time(number))
    }

    /// Draws a frame of the clip at a moment.
    pub fn frame(&mut self, number: usize, moment: Moment) -> (Vec<u8>, Row) {
        let time = self.time(number);
        let figure = self.figure(&moment);
        let mut light = self.drawn(&figure, &moment).light;
        for (light, glare) in light.iter_mut().zip(&self.glare) {
            *light += glare;
        }
        let row = Row {
            frame: number,
            time,
            rotation: figure.rotation,
            at: figure.at,
            camera: self.view.camera,
            landmarks: self.landmarks(&figure),
            moment,
        };
        (
            self.camera
                .develop(&mut self.rng, &mut light, self.view.width),
            row,
        )
    }

    /// The person at a moment.
    pub fn figure(&self, moment: &Moment) -> Figure {
        let face = moment.expression();
        let rotation = self.turned * head_rotation(moment.angles);
        // The head turns on its neck.
        let at = self.turned * (self.at + moment.sway + NECK) - rotation * NECK;
        let torso = self.torso.prop(moment, rotation, at, self.person.cloth);
        let mesh = self.mesh();
        let (vertices, mut own) = match &self.kin {
            Kin::Kit(body) => (body.vertices(mesh, &face), Vec::new()),
            Kin::Candide(candide, of) => candide.draw(of, &face),
        };
        accessories::wear(&mut own, rotation, at);
        own.push(torso);
        let push: &[f32] = match self.kin {
            Kin::Kit(_) => &self.person.painted.push_mm,
            Kin::Candide(..) => &[],
        };
        let posed = Posed::new(mesh, &vertices, push, rotation, at);
        let wearer = Wearer {
            mesh,
            head: &vertices,
            posed: &posed,
            at,
        };
        let covers = self.covering.as_ref();
        let covers = covers.map_or(Vec::new(), |c| c.props(&wearer, moment.cover));
        let mut over = self.worn.clone();
        accessories::wear(&mut over, rotation, at);
        over.extend(covers.iter().cloned());
        Figure {
            rotation,
            at,
            vertices,
            posed,
            own,
            over,
            covers,
        }
    }

    /// The person before what is behind.
    pub fn drawn(&self, figure: &Figure, moment: &Moment) -> Drawn {
        let all = [figure.own.as_slice(), &figure.over].concat();
        let mut lights = self.lights.clone();
        lights.key = Mat3::from_rotation_y(moment.light_turn) * lights.key;
        let scene = Scene {
            mesh: self.mesh(),
            head: &figure.posed,
            painted: &self.person.painted,
            eyes: Eyes {
                gaze: gaze_directions(&moment.expression(), 0.04),
                ..self.eyes
            },
            props: &all,
            lights: &lights,
        };
        draw(&scene, &self.view, &self.behind)
    }

    /// Of a figure.
    pub fn landmarks(&self, figure: &Figure) -> Landmarks {
        let bare = Posed::new(
            self.mesh(),
            &figure.vertices,
            &[],
            figure.rotation,
            figure.at,
        );
        let head = truth::Drawing {
            mesh: self.mesh(),
            head: Some(&figure.posed),
            props: &figure.own,
        };
        Landmarks::new(
            &self.view,
            self.mesh(),
            &bare,
            &head,
            &figure.over,
            &figure.covers,
        )
    }

    /// Vertices of the face at rest, head axes.
    pub fn neutral(&self) -> Vec<Vec3> {
        self.kin.neutral(self.mesh())
    }

    /// Topology of the head.
    pub fn mesh(&self) -> &'a Mesh {
        match self.kin {
            Kin::Kit(_) => &self.studio.mesh,
            Kin::Candide(candide, _) => &candide.mesh,
        }
    }
}

impl Studio {
    fn background(&self, rng: &mut ChaCha8Rng, [width, height]: [usize; 2]) -> Vec<f32> {
        let level = rng.random_range(0.4..1.4f32);
        let mut light = match self.backgrounds.len() {
            0 => background::procedural(rng, width, height),
            n => {
                let photo = &self.backgrounds[rng.random_range(0..n)];
                background::from_photo(rng, photo, width, height)
            }
        };
        light.iter_mut().for_each(|l| *l *= level);
        light
    }
}
