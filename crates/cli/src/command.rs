//! Which command runs.

use anyhow::Result;

use crate::cli::{Cli, Command, ModelCommand};
use crate::{csv, demo, index, manual, model_info, monitor, output, track, view};

/// Runs a command; the exit status that it asks for, if any.
pub fn run(cli: Cli) -> Result<Option<u8>> {
    match cli.command {
        Command::Track(args) => return track::run(&args),
        Command::View(args) => view::run(&args),
        Command::Index(args) => return index::run(&args),
        Command::Demo(args) => demo::run(&args),
        Command::Model(ModelCommand::Info { file }) => model_info::run(&file),
        Command::Columns => output::print(&columns()),
        Command::Manual { folder } => manual::write(&folder),
    }
    .map(|()| None)
}

/// The columns of `track --csv`, then those that `--monitor` adds.
fn columns() -> String {
    let (own, more) = (csv::documentation(), monitor::columns::documentation());
    format!("{own}\nWith `--monitor`, at the end:\n\n{more}")
}
