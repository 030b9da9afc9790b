//! `posewise-train`: makes the models and what they are made from.

use anyhow::Result;
use clap::{Parser, Subcommand};
use posewise_train::{demo_clip, pipeline, render};
use std::path::PathBuf;

/// Trains the models of posewise.
#[derive(Parser)]
#[command(version)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Train everything and write the model with its data sheet.
    Model(pipeline::Args),
    /// Render faces into the cache.
    Render(render::Args),
    /// Draw rendered samples with their landmarks, to be looked at.
    Sheet(render::sheet::Args),
    /// Render the clip that `posewise demo` tracks.
    DemoClip {
        /// The morphable head.
        #[arg(long, default_value = "../shared/data/facekit.npz")]
        facekit: PathBuf,
        /// Where the clip and its truth go.
        #[arg(long, default_value = "tests/data")]
        out: PathBuf,
    },
}

fn main() -> Result<()> {
    match Cli::parse().command {
        Command::Model(args) => pipeline::run(&args),
        Command::Render(args) => render::run(&args).map(|path| println!("{}", path.display())),
        Command::Sheet(args) => render::sheet::run(&args),
        Command::DemoClip { facekit, out } => demo_clip::write(&facekit, &out),
    }
}
