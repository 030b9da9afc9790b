//! Models that are missing, foreign, truncated or altered, from the outside.

use crate::common::{arg, fails_with, gradient_clip, posewise};

const DEFAULT: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../models/posewise.posewise"
);

#[test]
fn info_prints_the_default_model() {
    let run = posewise()
        .args(["model", "info", DEFAULT])
        .assert()
        .success();
    let said = String::from_utf8_lossy(&run.get_output().stdout).into_owned();
    assert!(said.contains("format version 5"), "{said}");
    assert!(said.contains("can track with it"), "{said}");
}

#[test]
fn bad_models_are_named_by_every_command() {
    let dir = tempfile::tempdir().unwrap();
    let good = std::fs::read(DEFAULT).unwrap();
    let clip = dir.path().join("clip.y4m");
    std::fs::write(&clip, gradient_clip(32, 32, 1)).unwrap();
    let mut version = good.clone();
    version[8] = 99;
    let mut reserved = good.clone();
    reserved[40] ^= 1;
    let mut flipped = good.clone();
    *flipped.last_mut().unwrap() ^= 0x10;
    let cases: [(&[u8], &str); 7] = [
        (&[], "truncated"),
        (&good[..20], "truncated"),
        (&good[..good.len() - 1], "truncated"),
        (
            b"GIF89a, which is no model at all, but long enough",
            "not a .posewise model",
        ),
        (&version, "format version 99"),
        (&reserved, "checksum"),
        (&flipped, "checksum"),
    ];
    for (bytes, why) in cases {
        let path = dir.path().join("bad.posewise");
        std::fs::write(&path, bytes).unwrap();
        let model = arg(&path);
        fails_with(
            &["model", "info", model],
            Vec::new(),
            &["bad.posewise", why],
        );
        let track = ["track", arg(&clip), "--model", model];
        fails_with(&track, Vec::new(), &["bad.posewise", why]);
        fails_with(
            &["demo", "--model", model],
            Vec::new(),
            &["bad.posewise", why],
        );
    }
    fails_with(
        &["model", "info", "none.posewise"],
        Vec::new(),
        &["cannot read model none.posewise"],
    );
    fails_with(
        &["model", "info", arg(dir.path())],
        Vec::new(),
        &["cannot read model"],
    );
}

/// Files without an end are given up, long before memory is.
#[cfg(unix)]
#[test]
fn endless_files_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    let clip = dir.path().join("clip.y4m");
    std::fs::write(&clip, gradient_clip(32, 32, 1)).unwrap();
    let (clip, out) = (arg(&clip), dir.path().join("out"));
    let zero = "/dev/zero";
    for args in [
        &["model", "info", zero][..],
        &["track", clip, "--model", zero],
        &["track", clip, "--calibration", zero],
        &["track", clip, "--monitor", "--monitor-zones", zero],
        &["index", zero, "--out", arg(&out)],
        &["index", clip, "--calibration", zero, "--out", arg(&out)],
    ] {
        // 2 GB of addresses.
        let run = crate::common::limited("-v 2000000").args(args).assert();
        let said = String::from_utf8_lossy(&run.get_output().stderr).into_owned();
        assert_eq!(run.get_output().status.code(), Some(1), "{args:?}: {said}");
        assert!(
            said.contains("/dev/zero") && said.contains("MB"),
            "{args:?}: {said}"
        );
    }
}
