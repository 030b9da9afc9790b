//! `posewise-lab`: experiments that no model needs. They measure what was considered for the models
//! and left out, or not yet taken in; docs/accuracy.md holds their figures.

mod compare;
mod features;
mod product;
mod protocol;
mod report;
mod rigid;
#[cfg(test)]
#[path = "../../../tests/common/skip.rs"]
#[allow(dead_code)] // tests here lack data at most
mod skip;
mod store;
mod sweeps;
mod table;
mod templates;
mod tracked;
mod truth;
mod video;

use anyhow::Result;
use clap::{Parser, Subcommand};

/// Experiments with posewise.
#[derive(Parser)]
#[command(version)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Compare kinds of local features in small linear cascades; prints a table.
    Features(features::Args),
    /// Render clips with exact truth to validate pose and covered faces, harder than training.
    Sweeps(sweeps::Args),
    /// Follow a clip with posewise or a tracker of the thesis.
    Track(compare::TrackArgs),
    /// Print the measures of several trackers on clips with truth.
    Compare(compare::TableArgs),
    /// Write the comparison as one HTML page, as JSON and as CSV.
    Report(report::Args),
    /// Print a public data set's own measures.
    Protocol(protocol::Args),
    /// Render clips in which two people pass each other, with the places of both faces.
    Crossings(sweeps::CrossingArgs),
    /// Render clips of drivers with exact truth, for the driver monitor.
    DriverClips(sweeps::DriverArgs),
    /// Render a stand-in for U3PT, the thesis' data set: ten subjects, five videos each.
    RenderU3pt(sweeps::U3ptArgs),
}

fn main() -> Result<()> {
    match Cli::parse().command {
        Command::Features(args) => features::run(&args),
        Command::Track(args) => compare::run_track(&args),
        Command::Compare(args) => compare::run_table(&args),
        Command::Report(args) => report::run(&args),
        Command::Protocol(args) => protocol::run(&args),
        Command::Sweeps(args) => sweeps::run(&args),
        Command::Crossings(args) => sweeps::run_crossings(&args),
        Command::DriverClips(args) => sweeps::run_driver_clips(&args),
        Command::RenderU3pt(args) => sweeps::run_u3pt(&args),
    }
}
