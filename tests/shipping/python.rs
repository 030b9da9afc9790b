//! The Python package of `python/`: the wheel builds, installs and passes its own tests.

use crate::common::c::{exists, succeed};
use crate::common::skip::need;
use crate::common::{root, scratch};
use crate::package::write_notices;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The Python that `.ci/tools` makes, or the machine's, if it has what the tests import.
pub fn python() -> Option<String> {
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

/// pip, which asks nobody.
fn pip(python: &str, verb: &str) -> Command {
    let mut pip = Command::new(python);
    pip.args(["-m", "pip", "--quiet", "--disable-pip-version-check", verb]);
    pip.args(["--no-deps", "--no-index"]);
    pip
}

/// Builds the wheel and unpacks it as pip does, into a folder of its own.
fn install(python: &str) -> (PathBuf, PathBuf) {
    write_notices();
    let (wheels, site) = (scratch("python/wheels"), scratch("python/site"));
    for folder in [&wheels, &site] {
        std::fs::remove_dir_all(folder).expect("a folder");
    }
    let mut build = pip(python, "wheel");
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
    let mut into = pip(python, "install");
    succeed(into.arg("--target").arg(&site).arg(&wheel));
    (wheel, site)
}

/// In an environment that has nothing but the wheel and numpy, the clip is tracked.
fn check_clean(python: &str, wheel: &Path) {
    let clean = scratch("python/clean");
    std::fs::remove_dir_all(&clean).expect("a folder");
    let mut make = Command::new(python);
    succeed(make.args(["-m", "venv", "--without-pip"]).arg(&clean));
    let own = clean.join("bin/python").display().to_string();
    let site = "import sysconfig; print(sysconfig.get_path('purelib'), end='')";
    let site = |python: &str| PathBuf::from(succeed(Command::new(python).args(["-c", site])));
    for entry in std::fs::read_dir(site(python)).expect("a folder") {
        let path = entry.expect("an entry").path();
        let name = path.file_name().expect("a name");
        if name.to_string_lossy().starts_with("numpy") {
            succeed(Command::new("ln").arg("-s").arg(&path).arg(site(&own)));
        }
    }
    let mut install = Command::new(python);
    install.args(["-m", "pip", "--python", &own, "--quiet", "install"]);
    // numpy is there, as the wheel asks for it.
    succeed(install.arg("--no-index").arg(wheel));
    let clip = xtask::demo_clip(&scratch("python")).expect("the demo clip");
    let mut track = Command::new(&own);
    // Neither the sources nor another installation are found.
    track.args(["-I"]).arg(root().join("python/tests/clean.py"));
    assert_eq!(succeed(track.arg(clip)), "120 4\n");
}

#[test]
fn the_wheel_passes_its_tests() {
    if !cfg!(target_os = "linux") || !crate::common::c::require("make") {
        return;
    }
    let Some(python) = python() else { return };
    let (wheel, site) = install(&python);
    check_clean(&python, &wheel);
    let mut pytest = Command::new(&python);
    pytest.args(["-m", "pytest", "-q", "-rs", "-p", "no:cacheprovider"]);
    pytest.arg(root().join("python/tests"));
    pytest.current_dir(scratch("python"));
    let said = succeed(pytest.env("PYTHONPATH", &site));
    println!("{said}");
    // "SKIPPED [1] FILE:LINE: …: no pyarrow", or "… No module named 'cv2'".
    for line in said.lines().filter(|line| line.starts_with("SKIPPED ")) {
        let module = line.rsplit(' ').next().unwrap_or(line);
        need(&format!("module {module} of Python"), false);
    }
    let mut mypy = Command::new(&python);
    mypy.args([
        "-m",
        "mypy",
        "--strict",
        "--ignore-missing-imports",
        "--cache-dir",
    ]);
    // Of the package, and of a caller who finds it as any installed one.
    mypy.arg(scratch("python/mypy")).arg(site.join("posewise"));
    mypy.arg(root().join("python/tests/typed.py"));
    succeed(mypy.env("MYPYPATH", &site).current_dir(scratch("python")));
}
