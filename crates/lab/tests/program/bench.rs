//! `posewise-lab bench` on the clip that ships with posewise.

use crate::common::{arg, fails_with, program};

#[test]
fn bench_measures_and_names_bad_inputs() {
    let dir = tempfile::tempdir().unwrap();
    let json = dir.path().join("bench.json");
    program()
        .args(["bench", "--json", arg(&json)])
        .assert()
        .success();
    let json: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(json).unwrap()).unwrap();
    assert_eq!(json["frame"], serde_json::json!([320, 240]));
    let number = |part: &str, key: &str| json[part][key].as_u64().unwrap();
    for part in ["tracking", "acquiring", "searching", "coasting", "all"] {
        assert!(number(part, "steps") > 0, "{part}");
        assert!(number(part, "median_ns") <= number(part, "p99_ns"));
        assert!(number(part, "p99_ns") <= number(part, "max_ns"));
    }
    let worst = json["worst_ns"].as_u64().unwrap();
    assert_eq!(number("all", "max_ns"), worst);
    assert_eq!(
        number(json["worst_state"].as_str().unwrap(), "max_ns"),
        worst
    );
    let ratio = worst as f64 / number("tracking", "median_ns") as f64;
    assert!((json["worst_over_tracking"].as_f64().unwrap() - ratio).abs() < 1e-9);
    let stages = json["stages"].as_array().unwrap();
    for stage in ["global stage", "refiners", "verifier", "3D fit", "tile"] {
        assert!(
            stages
                .iter()
                .any(|s| s["name"] == stage && s["ns"].as_u64() > Some(0))
        );
    }
    assert!(stages[0]["multiply_adds"].as_u64() > Some(1_000_000));
    let sizes = json["frame_sizes"].as_array().unwrap();
    assert_eq!(
        sizes.last().unwrap()["frame"],
        serde_json::json!([3840, 2160])
    );
    for row in sizes {
        assert!(row["tracking"]["steps"].as_u64() > Some(0), "{row}");
        assert!(
            row["searching_p99_over_tracking"].as_f64() > Some(0.0),
            "{row}"
        );
    }
    let shared = json["trackers"].as_array().unwrap();
    assert_eq!(shared.last().unwrap()["count"].as_u64(), Some(16));
    for row in shared {
        assert!(row["tracking"]["median_ns"].as_u64() > Some(0), "{row}");
    }
    assert!(json["model_bytes"].as_u64().unwrap() >= 64);
    assert!(json["tracker_bytes"].as_u64().unwrap() > 1000);
    if cfg!(unix) {
        assert!(json["peak_stack_bytes"].as_u64().is_some());
    }
    fails_with(
        &["bench", "--input", "none.mp4"],
        &["no such file", "none.mp4"],
    );
    let run = program()
        .args(["bench", "--kernel", "mmx"])
        .assert()
        .code(2);
    let said = String::from_utf8_lossy(&run.get_output().stderr).into_owned();
    for word in ["--kernel", "mmx", "this machine runs", "scalar"] {
        assert!(said.contains(word), "{said}");
    }
    fails_with(
        &["bench", "--clutter", "none"],
        &["cannot list folder none"],
    );
    let args = [
        "bench",
        "--json",
        "/no/such/dir/b.json",
        "--input",
        "none.mp4",
    ];
    fails_with(&args, &["none.mp4"]);
}
