//! The Python package of `python/`: the wheel builds, installs and passes its own tests.

use crate::common::c::{exists, succeed};
use crate::common::skip::need;
use crate::common::{root, scratch};
use crate::package::write_notices;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The Python that `.ci/tools` makes, or the machine's, if it has what the tests import.
fn python() -> Option<String> {
    let own = std::env::var("POSEWISE_PYTHON").unwrap_or("python3".into());
    // setuptools wants to be the first.
    let needs = "import setuptools, av, cv2, matplotlib, mypy, numpy, pip, pytest, wheel";
    let mut asked = Command::new(&own);
    let can = exists(&own)
        && asked
            .args(["-c", needs])
            .output()
            .is_ok_and(|o| o.status.success());
    need(&format!("{own} that can {needs}"), can).then_some(own)
}

/// Held while a wheel is built: setuptools works in one folder beside the sources.
pub fn building_a_wheel() -> std::sync::MutexGuard<'static, ()> {
    static BUILDING: std::sync::Mutex<()> = std::sync::Mutex::new(());
    BUILDING.lock().unwrap_or_else(|failed| failed.into_inner())
}

/// Builds the wheel and unpacks it as pip does, into a folder of its own.
fn install(python: &str) -> PathBuf {
    write_notices();
    let (wheels, site) = (scratch("python/wheels"), scratch("python/site"));
    for folder in [&wheels, &site] {
        std::fs::remove_dir_all(folder).expect("a folder");
    }
    let pip = |verb: &str| {
        let mut pip = Command::new(python);
        pip.args([
            "-m",
            "pip",
            "--quiet",
            "--disable-pip-version-check",
            verb,
            "--no-deps",
        ]);
        pip.arg("--no-index");
        pip
    };
    let mut build = pip("wheel");
    // The library lies beside those that cargo builds, and is up to date there.
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).parent();
    build.env("CARGO_TARGET_DIR", target.expect("a build folder"));
    build
        .args(["--no-build-isolation", "--wheel-dir"])
        .arg(&wheels);
    {
        let _alone = building_a_wheel();
        succeed(build.arg(root().join("python")));
    }
    let mut entries = std::fs::read_dir(&wheels).expect("a folder");
    let wheel = entries.next().expect("a wheel").expect("an entry").path();
    let name = wheel.file_name().expect("a name").to_string_lossy();
    assert!(name.contains("-py3-none-manylinux_2_17_"), "{name}");
    let size = std::fs::metadata(&wheel).expect("a file").len();
    println!("{name}: {size} bytes");
    succeed(pip("install").arg("--target").arg(&site).arg(&wheel));
    site
}

#[test]
fn the_wheel_passes_its_tests() {
    if !cfg!(target_os = "linux") || !crate::common::c::require("make") {
        return;
    }
    let Some(python) = python() else { return };
    let site = install(&python);
    let mut pytest = Command::new(&python);
    // What is skipped is said.
    pytest.args(["-m", "pytest", "-q", "-rs", "-p", "no:cacheprovider"]);
    pytest.arg(root().join("python/tests"));
    println!(
        "{}",
        succeed(
            pytest
                .current_dir(scratch("python"))
                .env("PYTHONPATH", &site)
        )
    );
    let mut mypy = Command::new(&python);
    mypy.args([
        "-m",
        "mypy",
        "--strict",
        "--ignore-missing-imports",
        "--cache-dir",
    ]);
    mypy.arg(scratch("python/mypy")).arg(site.join("posewise"));
    succeed(mypy.current_dir(scratch("python")));
}
