//! What a program gets when it links one of the libraries: no panics, no heap, no stray symbols.

use crate::common::c::{cc, example, library, require, succeed};
use crate::common::{root, scratch};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

/// Names in a linked program that belong to the panic machinery.
fn panics(program: &Path) -> Vec<String> {
    let names = succeed(Command::new("nm").arg(program));
    let names = names.lines().filter(|line| line.contains("panicking"));
    names.map(String::from).collect()
}

/// The program of `CONTROL_C` with a Rust library of this code, in a folder of this name.
fn control(name: &str, code: &str) -> PathBuf {
    let folder = scratch(name);
    let (rust, c) = (folder.join("control.rs"), folder.join("control.c"));
    let (library, program) = (folder.join("libcontrol.a"), folder.join("control"));
    std::fs::write(&rust, code).expect("target/ is writable");
    std::fs::write(&c, CONTROL_C).expect("target/ is writable");
    let mut rustc = Command::new(std::env::var("RUSTC").unwrap_or("rustc".into()));
    rustc.args(["--edition=2024", "--crate-type=staticlib", "-Cpanic=abort"]);
    rustc
        .args(["-Copt-level=3", "-Clto=fat", "-o"])
        .arg(&library);
    succeed(rustc.arg(&rust));
    let mut link = Command::new(cc());
    link.arg(&c).arg(&library).arg("-Wl,--gc-sections");
    succeed(link.arg("-o").arg(&program));
    program
}

#[test]
fn nothing_panics() {
    if !require("nm") {
        return;
    }
    // The control shows that a panic would be seen.
    let program = control("control", CONTROL_RUST);
    assert!(!panics(&program).is_empty(), "the control panics");

    for program in [example(), whole()] {
        let panics = panics(program);
        assert!(
            panics.is_empty(),
            "the library can panic:\n{}",
            panics.join("\n")
        );
    }
}

/// A panic, which only builds with checks can reach, ends the program.
#[test]
fn a_panic_traps() {
    let handler = root().join("src/ffi/panic.rs");
    let code = CONTROL_RUST.lines().filter(|line| !line.contains("panic"));
    let code: Vec<&str> = code.collect();
    let code = code.join("\n").replace(
        "#![no_std]",
        &format!(
            "#![no_std]\n#[path = \"{}\"]\nmod panic;",
            handler.display()
        ),
    );
    let program = control("panics", &code);
    // The element beyond the last; a program that loops would be ended by SIGTERM.
    let mut run = Command::new("timeout");
    let status = run.arg("10").arg(&program).args(["a", "b", "c"]).status();
    use std::os::unix::process::ExitStatusExt;
    let status = status.expect("timeout runs");
    let ended = status.code().or(status.signal().map(|signal| 128 + signal));
    const SIGILL: i32 = 4;
    assert_eq!(ended, Some(128 + SIGILL));
}

/// Only the header's functions can be seen: whatever else is in the program, it does not clash.
#[test]
fn only_the_functions_of_the_header_are_visible() {
    if !require("make") || !require("nm") {
        return;
    }
    let mut functions = xtask::functions_of_the_header().expect("posewise.h");
    functions.sort_unstable();
    let shared = shared_library();
    for (which, library) in [("--extern-only", library()), ("--dynamic", &shared)] {
        let mut nm = Command::new("nm");
        let nm = succeed(nm.args([which, "--defined-only"]).arg(library));
        let names = nm.lines().filter_map(|line| line.split(' ').nth(2));
        let mut names: Vec<_> = names.collect();
        names.sort_unstable();
        assert_eq!(names, functions, "{}", library.display());
    }
}

/// The shared library beside the static one; its name has the number of the ABI.
fn shared_library() -> PathBuf {
    let abi = posewise::ffi::types::POSEWISE_ABI;
    library().with_file_name(format!("libposewise.so.{abi}"))
}

#[test]
fn the_shared_library_is_hardened_and_needs_little() {
    if !require("make") || !require("readelf") || !require("nm") {
        return;
    }
    let library = shared_library();
    let elf = |options: &str| succeed(Command::new("readelf").args([options, "-W"]).arg(&library));
    let dynamic = elf("--dynamic");
    let soname = library.file_name().expect("a name").display();
    assert!(
        dynamic.contains(&format!("soname: [{soname}]")),
        "{dynamic}"
    );
    assert!(
        dynamic.contains("NOW") && !dynamic.contains("TEXTREL"),
        "{dynamic}"
    );
    let segments = elf("--segments");
    let stack = segments
        .lines()
        .find(|line| line.contains("GNU_STACK"))
        .expect("a header");
    assert!(!stack.contains("RWE"), "{stack}");
    let mut nm = Command::new("nm");
    let undefined = succeed(nm.args(["--dynamic", "--undefined-only"]).arg(&library));
    let names = undefined
        .lines()
        .map(|line| line.trim().trim_start_matches("U "));
    let names = names.map(|name| name.split('@').next().unwrap_or(name));
    let unexpected: Vec<_> = names.filter(|name| !C_LIBRARY.contains(name)).collect();
    assert!(unexpected.is_empty(), "{unexpected:?}");
}

/// What every C compiler, freestanding too, may ask for.
const C_LIBRARY: [&str; 5] = ["memcpy", "memmove", "memset", "memcmp", "bcmp"];

/// A program may hold other static libraries in Rust, whichever comes first; panics of the other
/// one are still caught. What cargo makes alone links too, where not all of it is asked for.
#[test]
fn other_rust_libraries_link_beside_it() {
    let folder = scratch("two");
    let other = |name: &str, code: &str, flags: &[&str]| {
        let (source, library) = (folder.join(name), folder.join(format!("lib{name}.a")));
        std::fs::write(&source, code).expect("target/ is writable");
        let mut rustc = Command::new(std::env::var("RUSTC").unwrap_or("rustc".into()));
        rustc.args([
            "--edition=2024",
            "--crate-type=staticlib",
            "--crate-name",
            name,
        ]);
        succeed(rustc.args(flags).arg("-o").arg(&library).arg(&source));
        library
    };
    let with_std = other("with_std", WITH_STD, &["-Copt-level=1"]);
    let without = other(
        "without_std",
        WITHOUT_STD,
        &["-Copt-level=1", "-Cpanic=abort"],
    );
    let main = folder.join("main.c");
    std::fs::write(&main, TWO_C).expect("target/ is writable");
    let by_cargo = scratch("dist").join("dist/libposewise.a");
    for (i, other) in [&with_std, &without].into_iter().enumerate() {
        let (all, end) = (
            Path::new("-Wl,--whole-archive"),
            Path::new("-Wl,--no-whole-archive"),
        );
        let orders: [&[&Path]; 4] = [
            &[all, library(), end, other],
            &[other, all, library(), end],
            &[&by_cargo, other],
            &[other, &by_cargo],
        ];
        for libraries in orders {
            let program = folder.join(format!("program{i}"));
            let mut link = Command::new(cc());
            link.arg("-I").arg(root().join("include")).arg(&main);
            link.args(libraries)
                .args(["-lpthread", "-ldl", "-lm", "-o"]);
            succeed(link.arg(&program));
            succeed(&mut Command::new(&program));
        }
    }
}

const WITH_STD: &str = r#"
#[unsafe(no_mangle)]
pub extern "C" fn other(n: usize) -> i32 {
    std::panic::set_hook(Box::new(|_| {}));
    let caught = std::panic::catch_unwind(|| vec![1, 2, 3][n]);
    if caught.is_err() { 42 } else { 0 }
}
"#;

const WITHOUT_STD: &str = r#"#![no_std]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! { loop {} }
#[unsafe(no_mangle)]
extern "C" fn rust_eh_personality() {}
#[unsafe(no_mangle)]
pub extern "C" fn other(n: usize) -> i32 { if n == 7 { 42 } else { 0 } }
"#;

const TWO_C: &str = "#include \"posewise.h\"
int other(size_t);
int main(void) {
    size_t len;
    const void *model = posewise_default_model(&len);
    return posewise_model_check(model, len) != POSEWISE_OK || other(7) != 42;
}
";

const CONTROL_RUST: &str = r#"#![no_std]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! { loop {} }
#[unsafe(no_mangle)]
pub extern "C" fn control(n: usize) -> u8 {
    static VALUES: [u8; 4] = [1, 2, 3, 4];
    VALUES[n]
}
"#;

const CONTROL_C: &str = "#include <stddef.h>
unsigned char control(size_t);
int main(int argc, char **argv) { return control((size_t)argc) + (argv == 0); }
";

#[test]
fn nothing_is_asked_of_the_system() {
    if !require("nm") {
        return;
    }
    let undefined = succeed(Command::new("nm").arg("-u").arg(whole()));
    let names = undefined
        .lines()
        .map(|line| line.trim().trim_start_matches("U "));
    let is_allowed = |name: &&str| C_LIBRARY.contains(name) || *name == "_GLOBAL_OFFSET_TABLE_";
    let unexpected: Vec<_> = names.filter(|name| !is_allowed(name)).collect();
    assert!(unexpected.is_empty(), "{unexpected:?}");
}

/// One relocatable object of everything reachable from the header's functions.
fn whole() -> &'static Path {
    static WHOLE: OnceLock<PathBuf> = OnceLock::new();
    WHOLE.get_or_init(|| {
        let whole = scratch("c").join("whole.o");
        let mut link = Command::new(cc());
        link.args(["-r", "-nostdlib", "-Wl,--gc-sections"]);
        for name in xtask::functions_of_the_header().expect("posewise.h") {
            link.arg(format!("-Wl,-u,{name},--gc-keep-exported"));
        }
        succeed(link.arg(library()).arg("-o").arg(&whole));
        whole
    })
}
