//! `posewise-lab eval`: accuracy against labelled data.

mod camera;
mod clips;
mod on_renders;
mod shown;
mod stills;

use anyhow::Result;
use clap::Subcommand;
use clips::{deviations, eyes, identities, jitter, monitor, pose};
use shown::{drift, faceless, latency, mesh, recovery, turns, weights};
use stills::{angles, landmarks, people, profiles};

pub use stills::profile_metrics::errors as profile_errors;
pub use stills::profiles::read_labels as profile_labels;

/// What is measured.
#[derive(Subcommand)]
pub enum Command {
    /// 68 landmarks on labelled stills
    Landmarks(landmarks::Args),
    /// Marked landmarks and yaw on stills of profiles
    Profiles(profiles::Args),
    /// Yaw and pitch on stills with labelled angles
    Angles(angles::Args),
    /// Head pose and landmarks against per-frame truth
    Pose(clips::ClipsArgs),
    /// Whether the standard deviations of a pose are true, against per-frame truth
    Deviations(deviations::Args),
    /// Eye openness and closures against per-frame truth
    Eyes(clips::ClipsArgs),
    /// Events and measures of the driver monitor against per-frame truth
    Monitor(monitor::Args),
    /// Whether heads that were seen before are told from others
    Identities(identities::Args),
    /// Jitter of the landmarks of a tracked clip
    Jitter(jitter::Args),
    /// The dense mesh on rendered heads, whose vertices are known
    Mesh(mesh::Args),
    /// Animation weights on rendered people, whose weights are known
    Weights(weights::Args),
    /// Landmarks on rendered people, by sex, age, skin and light
    People(people::Args),
    /// Frames until a face that disappeared is tracked again elsewhere
    Recovery(recovery::Args),
    /// Frames until a small face anywhere in a photograph is tracked
    Latency(latency::Args),
    /// Frames tracked in pictures without people
    Faceless(faceless::Args),
    /// Angle errors over many minutes
    Drift(drift::Args),
    /// What faces of a group lose by taking turns with some networks
    Turns(turns::Args),
}

/// Runs the command.
pub fn run(command: &Command) -> Result<()> {
    match command {
        Command::Landmarks(args) => landmarks::run(args),
        Command::Profiles(args) => profiles::run(args),
        Command::Angles(args) => angles::run(args),
        Command::Pose(args) => pose::run(args),
        Command::Deviations(args) => deviations::run(args),
        Command::Eyes(args) => eyes::run(args),
        Command::Monitor(args) => monitor::run(args),
        Command::Identities(args) => identities::run(args),
        Command::Jitter(args) => jitter::run(args),
        Command::Mesh(args) => mesh::run(args),
        Command::Weights(args) => weights::run(args),
        Command::People(args) => people::run(args),
        Command::Recovery(args) => recovery::run(args),
        Command::Latency(args) => latency::run(args),
        Command::Faceless(args) => faceless::run(args),
        Command::Drift(args) => drift::run(args),
        Command::Turns(args) => turns::run(args),
    }
}
