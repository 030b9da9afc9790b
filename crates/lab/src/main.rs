//! `posewise-lab`: the developer's program. It measures accuracy and cost, renders clips with exact
//! truth, and runs trackers of the thesis beside posewise.
//!
//! | module | what it does |
//! |---|---|
//! | `eval/` | accuracy against labels and truth |
//! | `bench/` | time, memory and stack of a step |
//! | `sweeps/` | renders clips with exact truth |
//! | `compare/`, `templates/`, `report/` | trackers of the thesis beside posewise, and their page |
//! | `features/` | kinds of local features in small linear cascades |
//! | `protocol/` | measures of public data sets |
//! | `footage/` | clips in memory, pictures without people |
//! | `product`, `tracked`, `truth`, `table`, `store`, `video` | what several of them read and run |
//! | `output` | reports on standard output, figures as JSON |
//! | `random`, `rigid` | reproducible chance, the rotation between two sets of points |
//!
//! Inputs, settings of the tracker and output are those of the command (`posewise_cli`).

mod bench;
mod compare;
mod eval;
mod features;
mod footage;
#[cfg(test)]
#[path = "../../../tests/common/help.rs"]
mod help;
mod output;
mod product;
mod protocol;
mod random;
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

use clap::{Parser, Subcommand};
use posewise_cli::program;
use std::process::ExitCode;

/// Measures posewise, and experiments with it.
#[derive(Parser)]
#[command(version)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Measure accuracy against labelled data.
    #[command(subcommand)]
    Eval(eval::Command),
    /// Measure time, memory and stack of a step.
    Bench(bench::Args),
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

fn main() -> ExitCode {
    let command = Cli::parse().command;
    program::run("posewise-lab", || {
        match command {
            Command::Eval(command) => eval::run(&command),
            Command::Bench(args) => bench::run(&args),
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
        .map(|()| None)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn help_of_measures_shows_every_default() {
        let program = Cli::command();
        program.clone().debug_assert();
        for name in ["eval", "bench"] {
            help::check(program.find_subcommand(name).expect("a command"));
        }
    }
}
