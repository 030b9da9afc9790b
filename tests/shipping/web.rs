//! The JavaScript package and the page of `web/`: Node and Chromium give the same bits as this
//! machine, the types fit, and the page works.

use crate::common::c::{command, require, succeed};
use crate::common::skip::{need, skipped};
use crate::common::{demo, grey, model, root, scratch, tracker};
use posewise::{Config, State};
use std::io::Read;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;
use xtask::web;

/// What `npm ci --prefix web` installs.
pub fn has_package(name: &str) -> bool {
    let there = root().join("web/node_modules").join(name).exists();
    need(&format!("{name} (npm ci --prefix web)"), there)
}

/// The folder of the page, built once, if this machine has Rust for WebAssembly.
pub fn site() -> Option<&'static Path> {
    static SITE: OnceLock<Option<PathBuf>> = OnceLock::new();
    let built = SITE.get_or_init(|| {
        // Where `cargo xtask web` builds too; the modules have folders of their own in it.
        let target = Path::new(env!("CARGO_TARGET_TMPDIR")).parent()?;
        if !web::can_be_built(target) {
            return None;
        }
        Some(web::build(target).expect("the page is built"))
    });
    const RUST: &str = "Rust for WebAssembly (rustup target add wasm32-unknown-unknown)";
    need(RUST, built.is_some());
    built.as_deref()
}

/// `layout.js` has the offsets of this program, for pointers of four bytes.
#[test]
fn layout_is_that_of_c() {
    if !require("clang") {
        return;
    }
    let mut clang = Command::new("clang");
    clang.args([
        "--target=wasm32",
        "-std=c11",
        "-ffreestanding",
        "-fsyntax-only",
    ]);
    succeed(
        clang
            .arg("-I")
            .arg(root().join("include"))
            .arg(crate::c::layouts()),
    );
}

/// The comments declare types that fit the code, the page and what a caller in TypeScript writes.
#[test]
fn types_fit() {
    if !require("node") || !has_package("typescript") {
        return;
    }
    let out = scratch("web/types");
    assert!(web::declarations(&out).expect("the types of the package"));
    let declared = std::fs::read_to_string(out.join("posewise.d.ts")).expect("declarations");
    assert!(declared.contains("class FaceTracker"), "{declared}");
    succeed(&mut web::typescript("test/tsconfig.json").expect("TypeScript"));
}

/// Node, with relaxed SIMD, which versions before 22 have behind an option.
fn node() -> Command {
    let mut ask = Command::new("node");
    let engine = root().join("web/engine.js");
    ask.arg("-e").arg(format!(
        "import({engine:?}).then((of) => process.exit(of.hasRelaxedSimd() ? 0 : 1))"
    ));
    let mut node = Command::new("node");
    if !ask.status().is_ok_and(|status| status.success()) {
        node.arg("--experimental-wasm-relaxed-simd");
    }
    node
}

#[test]
fn node_gives_the_same_bits() {
    let (Some(site), true) = (site(), require("node")) else {
        return;
    };
    let clip = xtask::demo_clip(&scratch("web")).expect("the demo clip");
    let expected = std::fs::read_to_string(root().join("tests/data/demo.hash")).expect("a hash");
    for module in [
        "posewise.wasm",
        "posewise-simd128.wasm",
        "posewise-relaxed.wasm",
    ] {
        let mut node = node();
        node.arg(root().join("web/test/replay.mjs"));
        node.arg(site.join(module))
            .arg(site.join("posewise.posewise"));
        assert_eq!(succeed(node.arg(&clip)), expected, "{module}");
    }
}

/// Wrong arguments, memory that cannot grow, calls in the wrong order; the driver monitor.
#[test]
fn faults_of_callers_do_no_harm() {
    let (Some(site), true) = (site(), require("node")) else {
        return;
    };
    for script in ["faults.mjs", "monitor.mjs"] {
        let mut node = Command::new("node");
        node.arg(root().join("web/test").join(script));
        node.arg(site.join("posewise-simd128.wasm"));
        succeed(node.arg(site.join("posewise.posewise")));
    }
}

/// The unit tests of the library as WebAssembly, those of the kernels among them.
#[test]
#[ignore = "builds the library once more: .ci/nightly"]
fn unit_tests_pass_in_node() {
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).join("web/unit");
    if site().is_none() || !require("node") {
        return;
    }
    let module = target.join("unit.wasm");
    let mut cargo = Command::new(env!("CARGO"));
    cargo
        .current_dir(root())
        .args(["rustc", "--quiet", "--lib"]);
    cargo.args(["--profile=release", "--no-default-features"]);
    // The crate type makes cargo build whole dependencies, which a program needs.
    cargo.args(["--crate-type=cdylib", "--target=wasm32-unknown-unknown"]);
    cargo.arg("--target-dir").arg(&target);
    cargo.args(["--", "--test", "-o"]).arg(&module);
    cargo.env("RUSTFLAGS", "-Ctarget-feature=+simd128,+relaxed-simd");
    match cargo.output() {
        Ok(output) if output.status.success() => {}
        // Debian's Rust for WebAssembly has no std, which tests need, and not every machine can
        // fetch it.
        _ => {
            skipped("std for WebAssembly (rustup target add wasm32-unknown-unknown)");
            return;
        }
    }
    let mut node = node();
    node.arg(root().join("web/test/unit.mjs")).arg(&module);
    succeed(&mut node);
}

/// The clip as Chromium's fake camera reads it: with chroma.
fn fake_camera() -> PathBuf {
    let clip = demo();
    let (width, height) = (clip.width, clip.height);
    let mut y4m = format!("YUV4MPEG2 W{width} H{height} F20:1 Ip A1:1 C420jpeg\n").into_bytes();
    for luma in &clip.luma {
        y4m.extend(b"FRAME\n");
        y4m.extend(luma);
        y4m.extend(std::iter::repeat_n(128, width * height / 2));
    }
    let path = scratch("web").join("camera.y4m");
    std::fs::write(&path, y4m).expect("target/ is writable");
    path
}

/// Little-endian values of a file.
struct Bytes<R>(R);

impl<R: Read> Bytes<R> {
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let mut bytes = [0; N];
        self.0.read_exact(&mut bytes).ok().map(|()| bytes)
    }

    fn u32(&mut self) -> u32 {
        u32::from_le_bytes(self.take().expect("a whole record"))
    }
}

/// Frames that the page got from the camera, and what it made of them, are tracked here too.
fn check_frames(path: &Path) {
    let file = std::fs::File::open(path).expect("frames.bin");
    let mut bytes = Bytes(std::io::BufReader::new(file));
    let (model, mut tracker) = (model(), tracker(&Config::default()));
    let mut tracked = 0;
    while let Some(time) = bytes.take() {
        let (width, height) = (bytes.u32(), bytes.u32());
        let mut luma = vec![0; (width * height) as usize];
        bytes.0.read_exact(&mut luma).expect("a whole picture");
        let frame = grey(width as usize, height as usize, &luma);
        let time_us = i64::from_le_bytes(time);
        let result = tracker.step(&model, &frame, time_us).expect("in order");
        tracked += usize::from(result.state == State::Tracking);
        let ours = [result.yaw_deg, result.pitch_deg, result.roll_deg]
            .into_iter()
            .chain(result.landmarks.iter().flat_map(|l| [l.x, l.y]));
        for value in ours {
            assert_eq!(bytes.u32(), value.to_bits(), "at {time_us} us");
        }
    }
    assert!(tracked >= 20, "{tracked} frames were tracked");
}

/// The page's table has the columns of the command's.
fn check_table(path: &Path) {
    let table = std::fs::read_to_string(path).expect("page.csv");
    let names = table.lines().next().expect("a line").split(',');
    let read = |name: &str| std::fs::read_to_string(root().join(name)).expect("docs");
    let docs = read("docs/command-line.md") + &read("docs/driver-monitor.md");
    for name in names.clone() {
        // Of what there is for each landmark, the docs have the first one.
        let stem = name.trim_end_matches(|c: char| c.is_ascii_digit());
        let known = [format!("`{name}`"), format!("`{stem}0`")];
        assert!(known.iter().any(|name| docs.contains(name)), "{name}");
    }
    let columns = names.count();
    assert!(table.lines().count() > 5, "a row for each frame");
    assert!(table.lines().all(|row| row.split(',').count() == columns));
}

/// The page, served, and its address, if this machine has what the scripts of `web/test` drive it
/// with.
fn served() -> Option<(&'static Path, String)> {
    let site = site()?;
    let has_programs = require("node") && require("chromium");
    if !has_programs || !has_package("playwright-core") || !has_package("axe-core") {
        return None;
    }
    let server = web::Site::bind(site, 0).expect("a free port");
    let url = server.url().expect("bound");
    std::thread::spawn(move || server.serve());
    Some((site, url))
}

#[test]
fn the_page_works_in_chromium() {
    let Some((site, url)) = served() else { return };
    let out = scratch("web/page");
    let mut node = Command::new("node");
    node.arg(root().join("web/test/page.mjs")).arg(url);
    node.arg(site).arg(fake_camera()).arg(&out);
    println!("{}", succeed(&mut node));
    check_frames(&out.join("frames.bin"));
    check_table(&out.join("page.csv"));
    check_table(&out.join("driver.csv"));
}

/// How long a step takes in Chromium with each module, and here with AVX2: in the quickest eight
/// steps in a row, in turns.
#[test]
#[ignore = "measures times, of which other programs make others: .ci/nightly"]
fn steps_in_chromium_beside_avx2() {
    let Some((_, url)) = served() else { return };
    let modules = [
        "posewise-relaxed.wasm",
        "posewise-simd128.wasm",
        "posewise.wasm",
    ];
    let mut least = [f64::INFINITY; 4];
    for _ in 0..3 {
        let mut node = Command::new("node");
        node.arg(root().join("web/test/steps.mjs")).arg(&url);
        let said = succeed(node.args(modules));
        let ms = said
            .lines()
            .map(|line| line.rsplit(' ').next().expect("a time"));
        let ms = ms.map(|ms| ms.parse().expect("a number")).chain(avx2_ms());
        for (least, ms) in least.iter_mut().zip(ms) {
            *least = least.min(ms);
        }
    }
    let [modules_ms @ .., avx2] = least;
    println!("AVX2: {avx2:.3} ms");
    for (module, ms) in modules.iter().zip(modules_ms) {
        println!("{module}: {ms:.3} ms, {:.2} times AVX2", ms / avx2);
    }
}

/// The same steps here with AVX2 \[ms\], where this machine has it.
fn avx2_ms() -> Option<f64> {
    use posewise::network::{KernelName, chosen_kernel, select_kernel};
    const STEPS: usize = 8;
    let before = chosen_kernel();
    if !select_kernel(KernelName::Avx2) {
        return None;
    }
    let (model, mut tracker) = (model(), tracker(&Config::default()));
    let mut least = f64::INFINITY;
    for first in (0..800).step_by(STEPS) {
        let start = std::time::Instant::now();
        for i in first..first + STEPS {
            let frame = demo().frame(39 - 39usize.abs_diff(i % 78));
            let step = tracker.step(&model, &frame, 50_000 * i as i64);
            step.expect("in order");
        }
        let ms = start.elapsed().as_secs_f64() * 1e3 / STEPS as f64;
        if first >= 100 {
            least = least.min(ms);
        }
    }
    select_kernel(before);
    Some(least)
}

/// Wire, mask and make-up lie on the face; textures of the visitor's.
#[test]
fn the_page_draws_the_dense_mesh() {
    let Some((site, url)) = served() else { return };
    let mut node = Command::new("node");
    node.arg(root().join("web/test/face.mjs")).arg(url);
    println!("{}", succeed(node.arg(site).arg(scratch("web/face"))));
}

/// Takes are recorded and saved, by the page that is served and by the one from a disk. Of the demo
/// clip the page saves what the command writes.
#[test]
fn the_page_saves_takes() {
    let Some((site, url)) = served() else { return };
    if !has_package("gltf-validator") {
        return;
    }
    let out = scratch("web/takes");
    let script = |name: &str| {
        let mut node = Command::new("node");
        node.arg(root().join("web/test").join(name));
        node
    };
    succeed(script("record.mjs").arg(url).arg(site).arg(&out));
    let clip = xtask::demo_clip(&scratch("web")).expect("the demo clip");
    let of_command = out.join("command.glb");
    let mut track = Command::new(command());
    track.arg("track").arg(&clip).arg("--gltf").arg(&of_command);
    succeed(track.arg("--quiet"));
    let mut take = script("take.mjs");
    take.arg(site.join("posewise-simd128.wasm"));
    take.arg(site.join("posewise.posewise"));
    succeed(take.args([&clip, &of_command, &out.join("clip.glb")]));
    for file in ["page.glb", "standalone.glb", "clip.glb"] {
        succeed(script("gltf.mjs").arg(out.join(file)));
    }
}

/// Retargeting files mean the same to the page as to the command, whose tests have these cases too.
#[test]
fn the_page_reads_retargeting_files_as_the_command() {
    if !require("node") {
        return;
    }
    let names = posewise::ANIMATION_NAMES
        .into_iter()
        .chain(posewise::eyes::EYE_LOOK_NAMES);
    let names: Vec<&str> = names.collect();
    let mut node = Command::new("node");
    node.arg(root().join("web/test/retargeting.mjs"));
    node.arg(root().join("tests/data/retargeting.json"));
    succeed(node.arg(names.join(",")));
}

/// The avatar follows the face, on the page that is served and on the one from a disk.
#[test]
fn the_page_shows_an_avatar() {
    let Some((site, url)) = served() else { return };
    let mut node = Command::new("node");
    node.arg(root().join("web/test/avatar.mjs")).arg(url);
    println!("{}", succeed(node.arg(site).arg(scratch("web/avatar"))));
}

/// What lies outside the folder is not served.
#[test]
fn the_server_stays_in_its_folder() {
    let folder = scratch("web/served");
    std::fs::create_dir_all(folder.join("site")).expect("target/ is writable");
    std::fs::write(folder.join("secret.txt"), "secret").expect("target/ is writable");
    std::fs::write(folder.join("site/index.html"), "page").expect("target/ is writable");
    let server = web::Site::bind(&folder.join("site"), 0).expect("a free port");
    let url = server.url().expect("bound");
    let address = url
        .trim_start_matches("http://")
        .trim_end_matches('/')
        .to_owned();
    std::thread::spawn(move || server.serve());
    let ask = |request: &str| {
        let mut stream = std::net::TcpStream::connect(&address).expect("it listens");
        write!(stream, "{request}\r\n\r\n").expect("it reads");
        let mut text = String::new();
        stream.read_to_string(&mut text).expect("it answers");
        text
    };
    assert!(ask("GET / HTTP/1.1").ends_with("\r\n\r\npage"));
    assert!(ask("GET /index.html?a HTTP/1.1").starts_with("HTTP/1.1 200 "));
    let secret = folder.join("secret.txt");
    for path in [
        "/../secret.txt",
        "/none",
        &format!("/{}", secret.display()),
        "/%2e%2e/secret.txt",
    ] {
        assert!(
            ask(&format!("GET {path} HTTP/1.1")).starts_with("HTTP/1.1 404 "),
            "{path}"
        );
    }
    assert!(ask("POST / HTTP/1.1").starts_with("HTTP/1.1 404 "));
}
