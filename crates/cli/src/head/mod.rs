//! The tracked head as files for 3D programs: `track --gltf`, animated, and `--obj`, of one frame.
//!
//! `recording` collects keyframes; at the end the tracker gives the person's own head, `surface`
//! its normals, and `gltf`, with `binary`, or `obj` writes it. `axes` turns our frames to theirs.

mod axes;
mod binary;
mod gltf;
mod obj;
mod recording;
mod surface;

use std::io::Write;
use std::path::Path;

use anyhow::{Context, Result, anyhow, bail};
use posewise::mesh::{MeshError, MeshShape, MeshTopology, MeshVertex};
use posewise::{ANIMATIONS, Model, State, TrackResult};

use crate::cli::TrackArgs;
use crate::destination::Destination;
use crate::output;
use crate::session::Session;
use recording::Recording;
use surface::Surface;

/// The files that were asked for.
pub struct HeadFiles<'m> {
    topology: Option<MeshTopology<'m>>,
    animated: Option<(File, Recording)>,
    still: Option<(File, Still)>,
}

/// A file that is written at the end.
struct File {
    name: String,
    destination: Destination,
    out: Box<dyn Write>,
}

/// The mesh of one frame.
struct Still {
    /// The frame that is wanted; `None`: the last one that was fitted.
    wanted: Option<u64>,
    /// The frame that was found.
    found: Option<(u64, Vec<MeshVertex>)>,
    /// The last one that was seen.
    last: u64,
}

/// Refuses what cannot be written, before anything is tracked.
pub fn check(args: &TrackArgs, model: &Model<'_>) -> Result<()> {
    if args.gltf.is_none() && args.obj.is_none() {
        return Ok(());
    }
    let option = match args.gltf {
        Some(_) => "--gltf",
        None => "--obj",
    };
    if args.faces > 1 {
        bail!("{option} writes one head: not with --faces");
    }
    let is_text = |path: &Path| {
        path.extension()
            .is_some_and(|e| e.eq_ignore_ascii_case("gltf"))
    };
    if let Some(path) = args.gltf.as_deref().filter(|path| is_text(path)) {
        bail!(
            "--gltf writes binary glTF: call it .glb, not {}",
            path.display()
        );
    }
    if model.mesh_topology().is_none() {
        bail!("{option} needs a model with section MESH, which this one lacks");
    }
    Ok(())
}

impl<'m> HeadFiles<'m> {
    /// Opens them. [`check`] was called.
    pub fn open(args: &TrackArgs, model: &Model<'m>) -> Result<Self> {
        let still = |file| {
            let still = Still {
                wanted: args.obj_frame,
                found: None,
                last: 0,
            };
            (file, still)
        };
        let animated = |file| (file, Recording::default());
        let open = |path: &Option<_>| path.as_deref().map(File::open).transpose();
        Ok(HeadFiles {
            topology: model.mesh_topology(),
            animated: open(&args.gltf)?.map(animated),
            still: open(&args.obj)?.map(still),
        })
    }

    /// Takes what is needed of a frame, counted from 1. `result` is what all outputs show.
    pub fn add(
        &mut self,
        frame: u64,
        timestamp_us: i64,
        result: &TrackResult,
        session: &Session<'_>,
    ) -> Result<()> {
        if let Some((_, recording)) = &mut self.animated {
            recording.add(result, timestamp_us);
        }
        if let Some((_, still)) = &mut self.still {
            still.add(frame, session)?;
        }
        Ok(())
    }

    /// Writes them, and gives them their names.
    pub fn finish(self, session: &Session<'_>) -> Result<()> {
        let Some(topology) = self.topology else {
            return Ok(());
        };
        if let Some((file, recording)) = self.animated {
            let name = &file.name;
            let surface = |shape| match session.mesh_shape(shape) {
                Ok(vertices) => Ok(Surface::new(&vertices, topology.triangles)),
                Err(MeshError::NoFace) => Err(anyhow!("no face was found: {name} is not written")),
                Err(error) => Err(anyhow!("{error}")),
            };
            let shapes = (0..ANIMATIONS).map(|index| surface(MeshShape::Animation(index)));
            let bytes = gltf::file(&gltf::Head {
                neutral: surface(MeshShape::Neutral)?,
                shapes: shapes.collect::<Result<_>>()?,
                topology,
                camera: session.intrinsics(),
                size: session.size(),
                recording: &recording,
            })?;
            file.finish(|out| out.write_all(&bytes))?;
        }
        if let Some((file, still)) = self.still {
            let (frame, vertices) = still.take(&file.name)?;
            let surface = Surface::new(&vertices, topology.triangles);
            file.finish(|out| obj::write(out, frame, &surface, &topology))?;
        }
        Ok(())
    }
}

impl File {
    fn open(path: &Path) -> Result<Self> {
        let destination = Destination::new(path);
        let out = output::open(&destination)?;
        Ok(File {
            name: path.display().to_string(),
            destination,
            out,
        })
    }

    fn finish(mut self, write: impl FnOnce(&mut dyn Write) -> std::io::Result<()>) -> Result<()> {
        let written = write(&mut *self.out).and_then(|()| self.out.flush());
        written.with_context(|| format!("cannot write {}", self.name))?;
        self.destination.finish()
    }
}

impl Still {
    fn add(&mut self, frame: u64, session: &Session<'_>) -> Result<()> {
        self.last = frame;
        let is_wanted = match self.wanted {
            Some(wanted) => frame == wanted && session.result().state != State::Searching,
            None => session.result().state == State::Tracking,
        };
        if is_wanted {
            let vertices = session.mesh().map_err(|error| anyhow!("{error}"))?;
            self.found = Some((frame, vertices));
        }
        Ok(())
    }

    /// What was found, for the file of this name.
    fn take(self, name: &str) -> Result<(u64, Vec<MeshVertex>)> {
        match (self.found, self.wanted) {
            (Some(found), _) => Ok(found),
            (None, None) => bail!("no face was found: {name} is not written"),
            (None, Some(frame)) if frame > self.last => bail!(
                "--obj-frame {frame}: the last frame is {}; {name} is not written",
                self.last
            ),
            (None, Some(frame)) => bail!("frame {frame} has no face: {name} is not written"),
        }
    }
}
