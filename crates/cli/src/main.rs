//! The `posewise` command: feeds files, pipes and cameras to the tracker, and measures it.
//!
//! | file | what it does |
//! |---|---|
//! | `cli` | the grammar |
//! | `source/` | INPUT → a stream of [`picture::Picture`]s |
//! | `track`, `faces`, `session` | `posewise track`: the loop and its trackers |
//! | `csv`, `jsonl`, `log`, `overlay/`, `plot` | its outputs |
//! | `streams/` | its results as datagrams for other programs |
//! | `monitor/` | a driver monitor over the results |
//! | `calibration` | camera and lens from a file |
//! | `view/` | `posewise view`: a web server that shows the tracker's frames |
//! | `index/` | `posewise index`: tables of many videos |
//! | `demo`, `demo_clip` | `posewise demo` |
//! | `eval/` | `posewise eval …` |
//! | `bench`, `scenes`, `steps`, `stages`, `stack` | `posewise bench` |
//! | `bounded` | reading files that may be anything |
//! | `destination`, `interrupt`, `output` | output files, signals, standard output |
//! | `clip`, `random` | clips in memory and reproducible chance, for the two above |
//! | `model_file`, `model_info` | reading models, `posewise model info` |
//! | `manual` | manual pages and shell completions, for packages |

mod bench;
mod bounded;
mod calibration;
mod cli;
mod clip;
mod csv;
mod demo;
mod demo_clip;
mod destination;
mod eval;
mod faces;
mod frame_sizes;
mod index;
mod interrupt;
mod jsonl;
mod lens;
mod log;
mod manual;
mod model_file;
mod model_info;
mod monitor;
mod output;
mod overlay;
mod picture;
mod plot;
mod random;
mod scenes;
mod session;
mod source;
mod stack;
mod stages;
mod steps;
mod streams;
mod text;
mod track;
mod view;

use std::process::ExitCode;

use clap::Parser;

use cli::{Cli, Command, EvalCommand, ModelCommand};

/// The tracker is plain data and may be moved by value; debug builds keep several copies.
const STACK_BYTES: usize = 64 << 20;

/// The columns of `track --csv`, then those that `--monitor` adds.
fn columns() -> String {
    let (own, more) = (csv::documentation(), monitor::columns::documentation());
    format!("{own}\nWith `--monitor`, at the end:\n\n{more}")
}

/// Tells the library what of the processor it cannot find out without an operating system.
fn detect_cpu() {
    #[cfg(target_arch = "aarch64")]
    // SAFETY: the operating system says so.
    unsafe {
        posewise::network::set_dotprod(std::arch::is_aarch64_feature_detected!("dotprod"));
    }
}

/// Writing beyond the limit of a file's size becomes an error like others, in place of a signal
/// that ends the program and leaves what is half-written.
fn report_large_files() {
    #[cfg(unix)]
    // SAFETY: no handler is set, the signal is only ignored.
    unsafe {
        libc::signal(libc::SIGXFSZ, libc::SIG_IGN);
    }
}

fn main() -> ExitCode {
    detect_cpu();
    report_large_files();
    let cli = Cli::parse();
    let run = || {
        match cli.command {
            Command::Track(args) => return track::run(&args),
            Command::View(args) => view::run(&args),
            Command::Index(args) => return index::run(&args),
            Command::Demo(args) => demo::run(&args),
            Command::Eval(EvalCommand::Landmarks(args)) => eval::landmarks::run(&args),
            Command::Eval(EvalCommand::Profiles(args)) => eval::profiles::run(&args),
            Command::Eval(EvalCommand::Angles(args)) => eval::angles::run(&args),
            Command::Eval(EvalCommand::Pose(args)) => eval::pose::run(&args),
            Command::Eval(EvalCommand::Deviations(args)) => eval::deviations::run(&args),
            Command::Eval(EvalCommand::Eyes(args)) => eval::eyes::run(&args),
            Command::Eval(EvalCommand::Monitor(args)) => eval::monitor::run(&args),
            Command::Eval(EvalCommand::Jitter(args)) => eval::jitter::run(&args),
            Command::Eval(EvalCommand::Recovery(args)) => eval::recovery::run(&args),
            Command::Eval(EvalCommand::Latency(args)) => eval::latency::run(&args),
            Command::Eval(EvalCommand::Faceless(args)) => eval::faceless::run(&args),
            Command::Eval(EvalCommand::Drift(args)) => eval::drift::run(&args),
            Command::Bench(args) => bench::run(&args),
            Command::Model(ModelCommand::Info { file }) => model_info::run(&file),
            Command::Columns => output::print(&columns()),
            Command::Manual { folder } => manual::write(&folder),
        }
        .map(|()| None)
    };
    let outcome = std::thread::Builder::new()
        .stack_size(STACK_BYTES)
        .spawn(run)
        .map(|thread| thread.join());
    match outcome {
        Ok(Ok(Ok(None))) => ExitCode::SUCCESS,
        Ok(Ok(Ok(Some(status)))) => ExitCode::from(status),
        Ok(Ok(Err(error))) if output::is_broken_pipe(&error) => ExitCode::SUCCESS,
        Ok(Ok(Err(error))) => {
            eprintln!("posewise: {error:#}");
            ExitCode::FAILURE
        }
        Ok(Err(_)) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("posewise: cannot start a thread: {error}");
            ExitCode::FAILURE
        }
    }
}
