//! Shards of `posewise-lab compare` and `protocol`, as job arrays run them, give the same bits as a
//! single run, and what was done is not done again.

mod common;

use common::{Run, lab, two_clips};
use std::path::Path;
use std::process::Command;

/// The rows of `--json`, less the processor times.
fn rows(run: &Run, arguments: &[&str]) -> Vec<serde_json::Value> {
    let path = run.path("rows.json");
    lab(run.arguments(arguments).arg("--json").arg(&path));
    let text = std::fs::read_to_string(path).expect("rows.json");
    let mut rows: Vec<serde_json::Value> = serde_json::from_str(&text).expect("rows");
    for row in &mut rows {
        row.as_object_mut().expect("a row").remove("milliseconds");
    }
    rows
}

/// The number of tables in a folder.
fn tables(folder: &Path) -> usize {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let names = entries.map(|entry| entry.expect("an entry").file_name());
    names
        .filter(|name| name.to_string_lossy().ends_with(".csv"))
        .count()
}

/// Runs a line of the docs in bash.
fn bash(run: &Run, line: &str) {
    let mut bash = Command::new("bash");
    bash.args(["-euc", line]).current_dir(run.path(""));
    bash.env("LAB", env!("CARGO_BIN_EXE_posewise-lab"));
    bash.env("POSEWISE_LAB", env!("CARGO_BIN_EXE_posewise-lab"));
    bash.env("JOBS", Path::new(env!("CARGO_MANIFEST_DIR")).join("jobs"));
    let status = bash.status().expect("bash");
    assert!(status.success(), "{line}");
}

#[test]
fn shards_give_the_bits_of_a_single_run() {
    let run = two_clips();
    let single = rows(&run, &["compare", "--each"]);
    assert_eq!(single.len(), 3, "a row for each clip, and one for both");
    assert!(single[2]["tracked_percent"].as_f64() > Some(90.0));

    // xargs runs two at a time; a third shard has nothing to do.
    bash(
        &run,
        "seq 3 | xargs -P 2 -I{} \"$LAB\" compare a.y4m b.y4m --methods posewise \
         --results xargs --shard {}/3",
    );
    assert_eq!(
        rows(&run, &["merge", "--each", "--results", "xargs"]),
        single
    );

    if Command::new("parallel").arg("--version").output().is_ok() {
        bash(
            &run,
            "parallel --will-cite \"$LAB\" compare a.y4m b.y4m --methods posewise \
             --results parallel --shard {}/2 ::: 1 2",
        );
        let merged = rows(&run, &["merge", "--each", "--results", "parallel"]);
        assert_eq!(merged, single);
    } else {
        let must = std::env::var_os("POSEWISE_REQUIRE_TARGETS").is_some();
        assert!(!must, "there is no parallel");
        eprintln!("skipped: no parallel");
    }

    // A job array, of which one task was not run.
    let task = "\"$JOBS/compare.sbatch\" 2 a.y4m b.y4m --methods posewise --results slurm";
    bash(&run, &format!("SLURM_ARRAY_TASK_ID=2 {task}"));
    let mut merge = run.arguments(&["merge", "--results", "slurm"]);
    let failed = merge.output().expect("posewise-lab");
    assert!(!failed.status.success());
    let error = String::from_utf8_lossy(&failed.stderr).into_owned();
    assert!(
        error.contains("1 results are missing, as posewise/a"),
        "{error}"
    );
    bash(&run, &format!("SLURM_ARRAY_TASK_ID=1 {task}"));
    assert_eq!(
        rows(&run, &["merge", "--each", "--results", "slurm"]),
        single
    );
}

#[test]
fn what_is_done_is_not_done_again() {
    let run = two_clips();
    let shard =
        |index: &str| lab(&mut run.arguments(&["compare", "--results", "r", "--shard", index]));
    assert_eq!(shard("1/2"), "1 results, 1 of them tracked now\n");
    // As if the second had been stopped while it wrote.
    let first = std::fs::read_to_string(run.path("r/posewise/a.csv")).expect("a table");
    std::fs::write(run.path("r/posewise/b.csv"), &first[..100]).expect("writable");
    assert_eq!(shard("1/1"), "2 results, 1 of them tracked now\n");
    assert_eq!(shard("1/1"), "2 results, 0 of them tracked now\n");
    // Of other frames the results are others.
    let mut other = run.arguments(&["compare", "--results", "r", "--frames", "7"]);
    let failed = other.output().expect("posewise-lab");
    assert!(
        !failed.status.success(),
        "results of other settings are not used"
    );
}

#[test]
fn protocols_have_shards_too() {
    let run = two_clips();
    let protocol = |more: &[&str]| {
        let mut arguments = vec!["protocol", "subsets", "--data", "."];
        arguments.extend(more);
        lab(run.plain(&arguments).current_dir(run.path("")))
    };
    // In the folder of the data, tables of results would be truths.
    let kept = tempfile::tempdir().expect("a folder");
    let kept = kept.path().to_str().expect("UTF-8");
    let single = protocol(&[]);
    for shard in ["2/2", "1/2"] {
        assert_eq!(protocol(&["--results", kept, "--shard", shard]), "");
    }
    assert_eq!(tables(Path::new(kept)), 2);
    assert_eq!(protocol(&["--results", kept]), single);
}
