//! The C ABI is the recorded one: functions, their arguments, structs with the places of their
//! fields, as libabigail sees them in a library of the header's functions, which have no code.
//! By night, the library itself is compared too, by what Rust's compiler says of it to debuggers.

use crate::common::c::{cc, require, succeed};
use crate::common::{root, scratch};
use std::path::{Path, PathBuf};
use std::process::Command;

/// What `abidw` writes of the header that was accepted last.
const RECORD: &str = "tests/data/posewise.abi";

/// The test that writes the record.
const RENEW: &str = "POSEWISE_BLESS=1 cargo test --release --test shipping -- abi::";

fn header() -> String {
    std::fs::read_to_string(root().join("include/posewise.h")).expect("posewise.h")
}

/// A library with the functions of a header, in a folder of this name.
fn library_of(header: &str, name: &str) -> PathBuf {
    let folder = scratch("abi").join(name);
    std::fs::create_dir_all(&folder).expect("target/ is writable");
    std::fs::write(folder.join("posewise.h"), header).expect("target/ is writable");
    // A declaration begins with POSEWISE_API and has no comments inside.
    let declarations = header.split("\nPOSEWISE_API").skip(1);
    let functions = declarations.filter_map(|text| text.split_once(';').map(|(head, _)| head));
    let functions = functions.map(|head| format!("{head} {{ __builtin_trap(); }}\n"));
    let code: Vec<_> = ["#include \"posewise.h\"\n".into()]
        .into_iter()
        .chain(functions)
        .collect();
    std::fs::write(folder.join("abi.c"), code.concat()).expect("target/ is writable");
    let abi = number(header);
    let library = folder.join("libposewise.so");
    let mut compile = Command::new(cc());
    compile
        .current_dir(&folder)
        .args(["-g", "-O0", "-w", "-shared", "-fPIC", "-nostdlib"]);
    compile.arg(format!("-Wl,-soname,libposewise.so.{abi}"));
    succeed(compile.arg("-o").arg(&library).arg("abi.c"));
    library
}

/// `POSEWISE_ABI` of a header.
fn number(header: &str) -> u32 {
    let (_, rest) = header
        .split_once("#define POSEWISE_ABI ")
        .expect("POSEWISE_ABI");
    let digits = rest.trim_start().split('u').next().expect("a number");
    digits.parse().expect("a number")
}

/// What of the recorded ABI a library changes, in libabigail's words; nothing where it is the same.
fn changes(library: &Path) -> Option<String> {
    let mut compare = Command::new("abidiff");
    compare.args([
        "--no-show-locs",
        "--no-architecture",
        "--no-corpus-path",
        "--show-bytes",
    ]);
    // Changes that it calls harmless are changes too, as another name of a field.
    compare
        .arg("--harmless")
        .arg(root().join(RECORD))
        .arg(library);
    let compared = compare.output().expect("abidiff runs");
    let said = String::from_utf8_lossy(&compared.stdout).into_owned();
    const CHANGED: i32 = 4;
    const INCOMPATIBLE: i32 = 8;
    match compared.status.code() {
        Some(0) => None,
        Some(code) if code & !(CHANGED | INCOMPATIBLE) == 0 => Some(said),
        code => panic!("abidiff: {code:?}\n{said}"),
    }
}

#[test]
fn the_abi_is_the_recorded_one() {
    if !require("abidw") || !require("abidiff") {
        return;
    }
    let library = library_of(&header(), "header");
    if std::env::var_os("POSEWISE_BLESS").is_some() {
        if root().join(RECORD).exists()
            && let Some(changes) = changes(&library)
        {
            println!("accepted:\n{changes}");
        }
        let mut write = Command::new("abidw");
        write.args(["--no-show-locs", "--no-architecture", "--no-corpus-path"]);
        write.args([
            "--no-comp-dir-path",
            "--no-elf-needed",
            "--type-id-style",
            "hash",
        ]);
        write.arg("--out-file").arg(root().join(RECORD));
        succeed(write.arg(&library));
    }
    if let Some(changes) = changes(&library) {
        panic!(
            "the C ABI is another one than that of {RECORD}:\n{changes}\nPrograms that are \
             compiled already must go on as CHANGELOG.md says, or POSEWISE_ABI grows. Then: {RENEW}"
        );
    }
}

/// Debian's list of symbols, by which packages know from which version on they work.
#[test]
fn debian_lists_every_function() {
    let list = root().join("packaging/debian/libposewise1.symbols");
    let list = std::fs::read_to_string(list).expect("the list");
    let (soname, list) = list.split_once(" libposewise1 #MINVER#\n").expect("a head");
    assert_eq!(soname, format!("libposewise.so.{}", number(&header())));
    let names = list
        .lines()
        .filter_map(|line| line.strip_prefix(' ')?.split('@').next());
    let mut functions = xtask::functions_of_the_header().expect("posewise.h");
    functions.sort_unstable();
    assert_eq!(names.collect::<Vec<_>>(), functions);
}

/// The names of types differ between Rust and C, which is not counted; sizes, places, the number
/// and order of arguments do.
#[test]
#[ignore = "builds the library with debugging information: .ci/nightly"]
fn the_library_has_the_recorded_abi() {
    if !require("abidiff") || !require("make") {
        return;
    }
    let target = scratch("abi/library");
    let mut make = Command::new("make");
    make.env("CARGO_PROFILE_DIST_DEBUG", "2");
    make.args(["--silent", "lib", "-C"]).arg(root());
    succeed(make.arg(format!("TARGET_DIR={}", target.display())));
    let library = target.join("libposewise.so");
    let mut link = Command::new(cc());
    link.args(["-shared", "-nostartfiles"]);
    let soname = format!("libposewise.so.{}", posewise::ffi::types::POSEWISE_ABI);
    link.arg(format!("-Wl,-soname,{soname},--whole-archive"));
    link.arg(target.join("dist/lib/libposewise.a"));
    link.arg("-Wl,--no-whole-archive");
    succeed(link.arg("-o").arg(&library));
    let compared = |library: &Path, other: &Path| {
        let mut compare = Command::new("abidiff");
        compare.args(["--no-architecture", "--no-corpus-path", "--no-show-locs"]);
        let compared = compare.args([library, other]).output();
        compared.expect("abidiff runs")
    };
    let same = compared(&library, &root().join(RECORD));
    let said = String::from_utf8_lossy(&same.stdout).into_owned();
    assert!(
        same.status.success() && said.contains("filtered out"),
        "{said}"
    );
    let header = header();
    for (name, old, new, _) in CHANGES.iter().filter(|(name, ..)| *name != "renamed") {
        let other = library_of(&header.replacen(old, new, 1), &format!("night-{name}"));
        assert!(
            !compared(&library, &other).status.success(),
            "{name} is not found"
        );
    }
}

/// Changes of the header that must be found, with what is said of each.
const CHANGES: [(&str, &str, &str, &str); 6] = [
    (
        "moved",
        "    float yaw_deg;\n",
        "    float shift_deg;\n    float yaw_deg;\n",
        "offset changed",
    ),
    (
        "wider",
        "    uint32_t landmark_count;\n",
        "    uint64_t landmark_count;\n",
        "landmark_count",
    ),
    (
        "renamed",
        "    float interocular_px;\n",
        "    float eyes_px;\n",
        "interocular_px",
    ),
    (
        "argument",
        "posewise_status posewise_reset(posewise_tracker *tracker);",
        "posewise_status posewise_reset(posewise_tracker *tracker, int how);",
        "parameter 2",
    ),
    (
        "gone",
        "POSEWISE_API posewise_status posewise_reset(posewise_tracker *tracker);\n",
        "",
        "posewise_reset",
    ),
    (
        "number",
        "#define POSEWISE_ABI ",
        "#define POSEWISE_ABI 9u //",
        "SONAME changed",
    ),
];

#[test]
fn changes_of_the_abi_are_found() {
    if !require("abidiff") {
        return;
    }
    let header = header();
    for (name, old, new, said) in CHANGES {
        assert!(header.contains(old), "{name}: the header has no {old:?}");
        let changed = header.replacen(old, new, 1);
        let changes = changes(&library_of(&changed, name));
        let changes = changes.unwrap_or_else(|| panic!("{name} is not found"));
        assert!(changes.contains(said), "{name}:\n{changes}");
    }
}
