//! Soak: hours of video in simulated time, through the C ABI, with every invariant checked.
//!
//! A session is about a minute of video for one to three trackers that share a model. Its scenes
//! are clips of a face, cuts, noise, pictures without a face and darkness, in frames of any size
//! and format; its timestamps jump; its settings change between frames; all functions of the
//! header are called. Each session follows from its seed alone. Checked on every step:
//!
//! - every number is finite and in the range that the header states (`outputs.rs`);
//! - the change of state is an allowed one, and the log of events says the same;
//! - a face that coasts repeats the last fit, for half a second at most;
//! - a call that must fail does, with the right status, and changes nothing;
//! - guards around the memory of tracker and outputs are whole; model and frame are unchanged;
//! - a copy of a tracker gives the same bits;
//! - a driver monitor of each tracker knows eyes of tracked faces only.
//!
//! Every fourth session runs twice, on memory with other content, and must give the same bits.
//!
//! A test run does two sessions. `.ci/nightly` does more, by these variables:
//!
//! ```text
//! POSEWISE_SOAK_HOURS    hours of video
//! POSEWISE_SOAK_MINUTES  minutes after which it ends earlier
//! POSEWISE_SOAK_SEED     seed of the first session; the next ones count on
//! POSEWISE_SOAK_CLIPS    a folder of y4m.gz clips that are shown too
//! POSEWISE_SOAK_REPORT   where the report is written
//! ```

mod calls;
mod checks;
#[path = "../common/mod.rs"]
mod common;
mod session;
mod tally;
#[path = "../../fuzz/src/targets/mod.rs"]
#[allow(dead_code)] // only some of the targets' parts are used here
mod targets;
mod video;

// The targets use `crate::ffi`.
use posewise::ffi;

use session::Session;
use std::time::{Duration, Instant};
use tally::Tally;
use targets::memory::Exact;
use targets::tiny;
use video::Library;

/// One session in this number runs twice: the first.
const REPEATED: u64 = 4;
/// One session in this number uses the tiny model, which takes nearly anything for a face: the
/// second.
const TINY: u64 = 8;

/// A number from the environment.
fn variable(name: &str) -> Option<f64> {
    let text = std::env::var(name).ok()?;
    Some(text.parse().unwrap_or_else(|_| panic!("{name}={text}")))
}

#[test]
fn every_invariant_holds() {
    let clips = std::env::var_os("POSEWISE_SOAK_CLIPS");
    let library = Library::new(clips.as_ref().map(|folder| folder.as_ref()));
    let hours = variable("POSEWISE_SOAK_HOURS").unwrap_or(1.5 / 60.0);
    let most = variable("POSEWISE_SOAK_MINUTES").unwrap_or(1e6) * 60.0;
    let first = variable("POSEWISE_SOAK_SEED").unwrap_or(1.0) as u64;
    let trained = Exact::of(posewise::DEFAULT_MODEL, posewise_format::ALIGN);
    let start = Instant::now();
    let mut tally = Tally::default();
    for seed in first.. {
        let done = tally.video_us as f64 >= hours * 3.6e9;
        if done || start.elapsed() > Duration::from_secs_f64(most) {
            break;
        }
        println!("session {seed}"); // shown when it fails
        let model = match seed % TINY {
            2 => (tiny::model(), false),
            _ => (&trained, true),
        };
        let hash = Session::run(seed, model, &library, 0x00, &mut tally);
        if seed % REPEATED == 1 {
            let again = Session::run(seed, model, &library, 0xFF, &mut Tally::default());
            assert_eq!(hash, again, "old content of the memory shows");
            tally.repeated += 1;
        }
        assert!(trained.get() == posewise::DEFAULT_MODEL && tiny::is_whole());
        tally.hash = tally.hash.rotate_left(1) ^ hash;
    }
    let report = tally.report(first, start.elapsed());
    print!("{report}");
    if let Some(path) = std::env::var_os("POSEWISE_SOAK_REPORT") {
        std::fs::write(path, report).expect("the report can be written");
    }
}
