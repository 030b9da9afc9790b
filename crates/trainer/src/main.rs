//! `posewise-train`: makes the models and what they are made from.

use anyhow::Result;
use clap::{Parser, Subcommand};
use posewise_format::Tag;
use posewise_train::{eyes, pipeline, render, single_eyes};
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
    /// Train the network of single eyes and write a model with it: one that is finished, with all
    /// other sections as they are.
    AddEyes(pipeline::eyes::AddArgs),
    /// Write a model with the dense mesh of its head: one that is finished, with all other sections
    /// as they are.
    AddMesh(pipeline::add::Args),
    /// Train animation weights that are seen and write a model with them: one that is finished,
    /// with all other sections as they are.
    AddWeights(pipeline::weights::AddArgs),
    /// Render faces and print the path of their file.
    Render(render::Args),
    /// Draw rendered samples with their landmarks, to be looked at.
    Sheet(render::sheet::Args),
    /// Measure whether the lid refiner separates real shut eyes from open ones.
    Eyes(single_eyes::Args),
    /// Measure what a tracker says of the eyes of rendered heads.
    Gaze(eyes::tracked::Args),
    /// Measure where people mark landmarks against where a model puts them.
    Marks(pipeline::marks::Args),
    /// Leave sections out of a model: ENSM (the global stage's ensemble member), RFIN (refiners,
    /// and with them what SREG holds), SREG (shape regression), WGHT (weights that are seen), MESH
    /// (the dense mesh) or INFO (the data sheet).
    Trim {
        /// The model.
        model: PathBuf,
        /// Where the smaller one goes.
        out: PathBuf,
        /// A section's tag; repeat for several.
        #[arg(long, required = true, value_parser = tag)]
        without: Vec<Tag>,
    },
}

fn tag(text: &str) -> Result<Tag, &'static str> {
    let tag = text.as_bytes().try_into();
    tag.map_err(|_| "a tag has four characters")
}

fn main() -> Result<()> {
    match Cli::parse().command {
        Command::Model(args) => pipeline::run(&args),
        Command::AddEyes(args) => pipeline::eyes::add(&args),
        Command::AddMesh(args) => pipeline::mesh::add(&args),
        Command::AddWeights(args) => pipeline::weights::add(&args),
        Command::Render(args) => {
            pipeline::renders::run(&args).map(|path| println!("{}", path.display()))
        }
        Command::Sheet(args) => render::sheet::run(&args),
        Command::Eyes(args) => single_eyes::run(&args),
        Command::Gaze(args) => eyes::tracked::run(&args),
        Command::Marks(args) => pipeline::marks::run(&args),
        Command::Trim {
            model,
            out,
            without,
        } => {
            let bytes = std::fs::read(&model)?;
            let smaller = posewise_format::without(&bytes, &without)?;
            Ok(std::fs::write(&out, smaller)?)
        }
    }
}
