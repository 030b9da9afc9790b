//! `posewise track --monitor` on the clip of the repository.

use crate::common::{arg, fails_with, posewise};
use std::path::Path;

fn data(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data");
    path.join(name).display().to_string()
}

#[test]
fn a_driver_is_watched() {
    let clip = data("demo.y4m.gz");
    let dir = tempfile::tempdir().unwrap();
    let path = |name: &str| dir.path().join(name);
    let (csv, plot) = (path("t.csv"), path("t.png"));
    let events = path("events.txt");
    let monitor = format!("--monitor={}", arg(&events));
    let files = ["--csv", arg(&csv), "--plot", arg(&plot)];
    let run = posewise()
        .args([
            "track",
            &clip,
            "-q",
            &monitor,
            "--monitor-preset",
            "euro-ncap",
        ])
        .args(files)
        .assert();
    run.success();
    let events = std::fs::read_to_string(events).unwrap();
    let blinks = events
        .lines()
        .filter(|line| line.contains("  blink  from "))
        .count();
    assert!(blinks >= 3, "{events}");
    assert!(image::open(&plot).unwrap().width() > 600);
    let table = std::fs::read_to_string(&csv).unwrap();
    let header = table.lines().next().unwrap();
    assert!(
        header.ends_with(",degraded,zone_by,road_gaze_yaw_deg,road_gaze_pitch_deg"),
        "{header}"
    );
    let last = table.lines().last().unwrap();
    assert_eq!(last.split(',').count(), header.split(',').count());
}

#[test]
fn wrong_options_are_explained() {
    let clip = data("demo.y4m.gz");
    let refused = |rest: &[&str], words: &[&str]| {
        fails_with(&[&["track", &clip][..], rest].concat(), Vec::new(), words);
    };
    refused(&["--monitor", "--faces", "2"], &["--monitor", "one driver"]);
    let dir = tempfile::tempdir().unwrap();
    let zones = dir.path().join("zones.json");
    std::fs::write(&zones, "[{}]").unwrap();
    refused(
        &["--monitor", "--monitor-zones", arg(&zones)],
        &["zones.json", "angles, box, plane"],
    );
    refused(
        &["--monitor", "--monitor-zones", "none.json"],
        &["none.json"],
    );
    for wrong in [
        &["--monitor", "--monitor-place=-100,0,-5"][..],
        &["--monitor-place", "any"],
        &["--monitor", "--monitor-zones-by", "nose"],
    ] {
        let run = posewise().args(["track", &clip]).args(wrong).assert();
        run.code(2);
    }
}
