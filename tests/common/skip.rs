//! Tests that are skipped because a tool is missing: said at once, and counted at the end of the
//! run by `crates/xtask/tests/skipped.rs`.

use std::io::Write;

/// Whether something that a test needs is there; else the test is skipped. With
/// `POSEWISE_REQUIRE_TARGETS`, as in .ci/run, what is missing is a failure.
pub fn need(what: &str, is_there: bool) -> bool {
    if !is_there {
        let must = std::env::var_os("POSEWISE_REQUIRE_TARGETS").is_some();
        assert!(!must, "there is no {what}");
        skipped(what);
    }
    is_there
}

/// Counts a test that is skipped without this. The harness hides what tests print with macros.
pub fn skipped(what: &str) {
    let thread = std::thread::current();
    let line = format!(
        "skipped: {}: no {what}\n",
        thread.name().unwrap_or("a test")
    );
    let _ = std::io::stderr().write_all(line.as_bytes());
    let mut options = std::fs::OpenOptions::new();
    let file = options.create(true).append(true).open(list());
    let written = file.and_then(|mut file| file.write_all(line.as_bytes()));
    written.expect("target/tmp is writable");
}

/// What this run of cargo has skipped.
pub fn list() -> std::path::PathBuf {
    let program = std::env::current_exe().expect("the path of this test");
    // target/release/deps/PROGRAM
    let target = program.ancestors().nth(3).expect("a build folder");
    std::fs::create_dir_all(target.join("tmp")).expect("target/ is writable");
    #[cfg(unix)]
    let run = std::os::unix::process::parent_id();
    #[cfg(not(unix))]
    let run = 0;
    target.join(format!("tmp/skipped-{run}.txt"))
}
