//! The `posewise` command.

use std::process::ExitCode;

use clap::Parser;
use posewise_cli::cli::Cli;
use posewise_cli::{command, program};

fn main() -> ExitCode {
    let cli = Cli::parse();
    program::run("posewise", || command::run(cli))
}
