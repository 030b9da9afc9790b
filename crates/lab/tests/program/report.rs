//! `posewise-lab report`: its files, and the page in Chromium.

use crate::common::skip::need;
use crate::common::{FRAMES, Run, lab, two_clips};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Columns of the demo clip's truth with the pose and the camera.
const BEFORE_LANDMARKS: usize = 21;

fn starts(program: &str) -> bool {
    Command::new(program).arg("--version").output().is_ok()
}

/// A page of posewise and of a program that found half of the frames, whose name is no markup.
fn report(run: &Run) -> PathBuf {
    for name in ["a", "b"] {
        std::fs::write(run.path(&format!("{name}.json")), "{\"seed\": 1}").expect("writable");
    }
    lab(&mut run.arguments(&["compare", "--results", "results"]));
    std::fs::create_dir(run.path("other")).expect("writable");
    for name in ["a", "b"] {
        let table = run.path(&format!("results/posewise/{name}.csv"));
        let table = std::fs::read_to_string(table).expect("a table");
        let rows: Vec<&str> = table.lines().take(1 + FRAMES / 2).collect();
        let path = run.path(&format!("other/{name}.csv"));
        std::fs::write(path, rows.join("\n")).expect("writable");
    }
    let mut report = run.arguments(&["report", "--results", "results", "--out", "page.html"]);
    lab(report.args(["--csv", "<b>other<script>=other"]));
    run.path("page.html")
}

fn json(path: &Path) -> serde_json::Value {
    let text = std::fs::read_to_string(path).expect("a file");
    serde_json::from_str(&text).expect("JSON")
}

#[test]
fn figures_are_those_of_the_table() {
    let run = two_clips();
    let page = report(&run);
    let figures = json(&page.with_extension("json"));
    lab(run
        .arguments(&["compare", "--results", "results"])
        .args(["--json", "rows.json"]));
    assert_eq!(
        figures["systems"][0]["row"],
        json(&run.path("rows.json"))[0]
    );
    let other = &figures["systems"][1];
    assert_eq!(other["row"]["tracked_percent"], 50.0);
    assert!(other["robustness"]["shares"][100].as_f64() <= Some(0.5));
    assert!(figures["systems"][0]["calibration"]["landmarks"][0]["count"].is_u64());
    let csv = std::fs::read_to_string(page.with_extension("csv")).expect("a file");
    assert_eq!(
        csv.lines().count(),
        1 + 2 * 3,
        "a row for each clip, and one for both"
    );
    assert!(csv.starts_with("method,clip,frames,tracked_percent,"));
    let page = std::fs::read_to_string(page).expect("a file");
    assert!(!page.contains("<b>other"), "names are no markup");
}

/// Without a description that says that a clip is rendered, nobody is shown.
#[test]
fn people_are_not_shown_unasked() {
    let run = two_clips();
    let page = |more: &[&str]| {
        lab(run.arguments(&["report", "--out", "page.html"]).args(more));
        std::fs::read_to_string(run.path("page.html")).expect("a file")
    };
    assert!(!page(&[]).contains("data:image/jpeg"));
    assert!(page(&["--show-people"]).contains("data:image/jpeg"));
}

/// Real heads may have a labelled pose only.
#[test]
fn clips_without_labelled_landmarks_have_angle_errors() {
    let run = two_clips();
    for name in ["a", "b"] {
        let path = run.path(&format!("{name}.csv"));
        let table = std::fs::read_to_string(&path).expect("a table");
        let first = |line: &str| {
            line.split(',')
                .take(BEFORE_LANDMARKS)
                .collect::<Vec<_>>()
                .join(",")
        };
        let rows: Vec<String> = table.lines().map(first).collect();
        std::fs::write(path, rows.join("\n")).expect("writable");
    }
    lab(&mut run.arguments(&["report", "--show-people", "--out", "page.html"]));
    let row = &json(&run.path("page.json"))["systems"][0]["row"];
    assert!(row["mean_deg"].is_f64() && row["nme_percent"].is_null());
    assert!(row["jitter_percent"].is_null());
}

#[test]
fn the_page_works_in_chromium() {
    let web = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../web");
    let has = |name: &str| web.join("node_modules").join(name).exists();
    let packages = has("playwright-core") && has("axe-core");
    if !need("node", starts("node"))
        || !need("chromium", starts("chromium"))
        || !need("packages (npm ci --prefix web)", packages)
    {
        return;
    }
    let run = two_clips();
    let page = report(&run);
    let out = Path::new(env!("CARGO_TARGET_TMPDIR")).join("report");
    std::fs::create_dir_all(&out).expect("target/ is writable");
    let mut node = Command::new("node");
    node.arg(web.join("test/report.mjs")).arg(&page).arg(&out);
    println!("{}", lab(&mut node));
}
