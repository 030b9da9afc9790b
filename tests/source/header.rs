//! `include/posewise.h` is up to date with `src/ffi`, and its version is that of Cargo.toml.

use crate::common::c::{STRICT, cc, succeed};
use crate::common::{root, scratch};
use posewise::ffi::{monitor, names};
use std::collections::BTreeMap;
use std::fmt::Write;

/// The longest line \[columns\].
const MAX_COLUMNS: usize = 100;

/// The header that cbindgen generates, formatted by [`tidy`].
fn generate() -> String {
    let config = cbindgen::Config::from_file(root().join("cbindgen.toml")).expect("cbindgen.toml");
    let mut bytes = Vec::new();
    cbindgen::Builder::new()
        .with_config(config)
        .with_src(root().join("src/ffi/types.rs"))
        .with_src(root().join("src/ffi/weights.rs"))
        .with_src(root().join("src/ffi/monitor_types.rs"))
        .with_src(root().join("src/ffi/api.rs"))
        .with_src(root().join("src/ffi/names.rs"))
        .with_src(root().join("src/ffi/monitor.rs"))
        .generate()
        .expect("cbindgen reads src/ffi")
        .write(&mut bytes);
    with_initialisers(&tidy(&String::from_utf8(bytes).expect("UTF-8")))
}

/// Adds, after each struct that starts with `struct_size`, a macro that initialises it: the size
/// and zeros. It names every field, because compilers warn where some are missing.
fn with_initialisers(header: &str) -> String {
    let mut out = String::new();
    let mut zeros = None::<Vec<String>>;
    for line in header.lines() {
        writeln!(out, "{line}").unwrap();
        if line.starts_with("typedef struct") && line.ends_with('{') {
            zeros = Some(Vec::new());
        } else if let Some(name) = line.strip_prefix("} ") {
            let name = name.trim_end_matches(';');
            let zeros = zeros.take().unwrap_or_default();
            if zeros.first().is_some_and(|size| size.starts_with("sizeof")) {
                out += &initialiser(name, &zeros);
            }
        } else if let (Some(zeros), Some(field)) = (&mut zeros, line.strip_suffix(';')) {
            zeros.push(zero(field.trim()));
        }
    }
    out
}

/// The initial value of a field, given by its declaration.
fn zero(field: &str) -> String {
    let (kind, name) = field.rsplit_once(' ').expect("a type and a name");
    // Of an array that does not fit into a line, the elements that are not named are 0 too.
    let zeros = |count: usize| match count {
        0..=16 => format!("{{{}}}", vec!["0"; count].join(", ")),
        _ => "{0}".into(),
    };
    match (kind, name.split_once('[')) {
        (_, Some((_, count))) => zeros(count.trim_end_matches(']').parse().expect("a number")),
        _ if name == "struct_size" => "sizeof".into(),
        _ if name.starts_with('*') => "NULL".into(),
        ("posewise_intrinsics" | "posewise_roi", _) => zeros(4),
        ("posewise_monitor_perclos", _) => zeros(6),
        ("posewise_lens", _) => format!("{{0, {}}}", zeros(5)),
        _ => "0".into(),
    }
}

/// The macro that initialises a struct.
fn initialiser(name: &str, zeros: &[String]) -> String {
    let macro_name = format!("{}_INIT", name.to_uppercase());
    let mut lines = vec![String::from("    {")];
    for (i, zero) in zeros.iter().enumerate() {
        let value = zero.replace("sizeof", &format!("sizeof({name})"));
        let end = if i + 1 < zeros.len() { "," } else { "}" };
        let line = lines.last_mut().expect("at least one");
        // A blank before it, a comma after it, and the backslash that continues the macro.
        if line.len() + value.len() + 4 > MAX_COLUMNS {
            lines.push(format!("     {value}{end}"));
        } else {
            let blank = if i == 0 { "" } else { " " };
            *line += &format!("{blank}{value}{end}");
        }
    }
    let values = lines.join(" \\\n");
    format!(
        "/// Initialises a {name}: struct_size is set, all other fields are 0.\n\
         #define {macro_name} \\\n{values}\n"
    )
}

/// Formats the constants: suffixes, hexadecimal for bit patterns, values and comments in columns,
/// an empty line between families. Removes rustdoc's escapes and names types by their typedef.
fn tidy(header: &str) -> String {
    let header = header.replace("\\[", "[").replace("\\]", "]");
    let mut out = String::new();
    let mut widths = BTreeMap::<_, (usize, usize)>::new();
    for (name, value) in header.lines().filter_map(constant) {
        let (names, values) = widths.entry(family(name)).or_default();
        (*names, *values) = (name.len().max(*names), value.len().max(*values));
    }
    let mut lines = header.lines().peekable();
    let mut previous_family = None;
    while let Some(line) = lines.next() {
        let comment = line.strip_prefix("/// ");
        let define = comment.and(lines.peek()).and_then(|next| constant(next));
        if let (Some(comment), Some((name, value))) = (comment, define) {
            lines.next();
            let family = family(name);
            if Some(family) == previous_family && out.ends_with("\n\n") {
                out.pop();
            }
            previous_family = Some(family);
            let comment = comment.trim_end_matches('.');
            let (name_width, value_width) = widths[family];
            writeln!(
                out,
                "#define {name:<name_width$} {value:<value_width$} ///< {comment}"
            )
            .unwrap();
        } else {
            if !line.is_empty() {
                previous_family = None;
            }
            let line = match line.starts_with("typedef") {
                true => line.to_string(),
                false => line.replace("struct posewise_", "posewise_"),
            };
            writeln!(out, "{line}").unwrap();
        }
    }
    out
}

/// What the names of families begin with, behind `POSEWISE_`; the first that fits counts.
const FAMILIES: [&str; 19] = [
    "ANIMATION_",
    "EVENT_",
    "EYE_LOOK_",
    "EYE_",
    "E_",
    "FMT_",
    "FRAME_",
    "GAZE_",
    "LENS_",
    "LOSS_",
    "MONITOR_DROWSINESS_",
    "MONITOR_EVENT_",
    "MONITOR_EYES_",
    "MONITOR_PRESET_",
    "MONITOR_REASON_",
    "MONITOR_ZONE_",
    "MONITOR_",
    "PART_",
    "TERMS_",
];

/// Constants of one family stand together.
fn family(name: &str) -> &'static str {
    let name = name.trim_start_matches("POSEWISE_");
    match name {
        "OK" => "E_",
        "SEARCHING" | "TRACKING" | "COASTING" => "state",
        "EYE_LOOKS" => "",
        _ => {
            let found = FAMILIES.iter().find(|start| name.starts_with(**start));
            found.copied().unwrap_or_default()
        }
    }
}

/// Name and rewritten value of a `#define` line.
fn constant(line: &str) -> Option<(&str, String)> {
    let (name, value) = line.strip_prefix("#define ")?.split_once(' ')?;
    if !name.starts_with("POSEWISE_") || ["POSEWISE_H", "POSEWISE_API"].contains(&name) {
        return None;
    }
    let value = if name.starts_with("POSEWISE_E_") {
        format!("({value})")
    } else if name == "POSEWISE_OK" {
        value.to_string()
    } else if name.starts_with("POSEWISE_FMT_") || name == "POSEWISE_VERSION" {
        let value: u32 = value.parse().expect("a number");
        let digits = if value > 0xFFFFFF { 8 } else { 6 };
        format!("0x{value:0digits$X}u")
    } else if value.parse::<u32>().is_ok() {
        format!("{value}u")
    } else {
        value.to_string()
    };
    Some((name, value))
}

/// Fails when a file is not what it is generated from; writes it with `POSEWISE_BLESS`.
fn check_generated(path: &str, fresh: &str) {
    let file = root().join(path);
    if std::env::var_os("POSEWISE_BLESS").is_some() {
        std::fs::write(&file, fresh).expect("the repository is writable");
    }
    let committed = std::fs::read_to_string(&file).unwrap_or_default();
    assert!(
        committed.replace('\r', "") == fresh,
        "{path} is stale; run: POSEWISE_BLESS=1 cargo test --release --test source"
    );
}

/// The header, of `src/ffi`, and what is read from it for JavaScript and Python.
#[test]
fn generated_files_are_up_to_date() {
    let header = generate();
    for line in header.lines() {
        assert!(line.chars().count() <= MAX_COLUMNS, "too long: {line}");
    }
    check_generated("include/posewise.h", &header);
    use xtask::{python, web::layout};
    check_generated(layout::FILE, &layout::text().expect("posewise.h is read"));
    check_generated(python::FILE, &python::text().expect("posewise.h is read"));
}

#[test]
fn version_is_that_of_the_crate() {
    let part = |text: &str| text.parse::<u32>().expect("a number");
    let version = part(env!("CARGO_PKG_VERSION_MAJOR")) << 16
        | part(env!("CARGO_PKG_VERSION_MINOR")) << 8
        | part(env!("CARGO_PKG_VERSION_PATCH"));
    assert_eq!(
        posewise::ffi::types::POSEWISE_VERSION,
        version,
        "POSEWISE_VERSION, Cargo.toml"
    );
}

#[test]
fn every_exported_function_is_declared() {
    let read = |name| std::fs::read_to_string(root().join("src/ffi").join(name)).expect(name);
    let api = read("api.rs") + &read("names.rs") + &read("monitor.rs");
    let header = std::fs::read_to_string(root().join("include/posewise.h")).expect("posewise.h");
    let exported = api
        .split("extern \"C\" fn ")
        .skip(1)
        .filter_map(|rest| rest.split('(').next());
    let mut count = 0;
    for name in exported {
        assert!(
            header.contains(&format!("{name}(")),
            "{name} is not in the header"
        );
        count += 1;
    }
    assert_eq!(count, api.matches("#[unsafe(no_mangle)]").count());
}

#[test]
fn documented_defaults_are_the_defaults() {
    let header = std::fs::read_to_string(root().join("include/posewise.h")).expect("posewise.h");
    let config = posewise::Config::default();
    for (field, value) in [
        ("min_face_px", config.min_face_px),
        ("scan_budget", config.scan_budget),
    ] {
        let field_at = header
            .find(&format!("uint32_t {field};"))
            .unwrap_or_else(|| panic!("{field} is a field"));
        let comment = &header[..field_at];
        let stated = comment.rsplit("the default, ").next().unwrap_or("");
        let stated = stated.split('.').next().unwrap_or("");
        assert_eq!(
            stated,
            value.to_string(),
            "default of {field} in ffi/types.rs"
        );
    }
}

/// The text that a function of names gives, without the NUL.
fn text(name: *const std::ffi::c_char) -> Option<&'static str> {
    // SAFETY: NULL, or a static string that ends with a NUL.
    let name = (!name.is_null()).then(|| unsafe { std::ffi::CStr::from_ptr(name) });
    name.map(|name| name.to_str().expect("ASCII"))
}

/// The words that JavaScript and Python have, which are those of the constants, are the library's.
#[test]
fn words_are_the_same_in_all_languages() {
    let header = xtask::header::read().expect("posewise.h is read");
    let functions: [(&str, extern "C" fn(u32) -> *const std::ffi::c_char); 5] = [
        ("STATE", names::posewise_state_name),
        ("LOSS", names::posewise_loss_name),
        ("EVENT", names::posewise_event_name),
        ("EYE", names::posewise_eye_status_name),
        ("MONITOR_EVENT", monitor::posewise_monitor_event_name),
    ];
    for (kind, name_of) in functions {
        let words = header.words(kind).expect(kind);
        assert!(words.len() > 2);
        for (i, word) in (0..).zip(&words) {
            assert_eq!(text(name_of(i)), Some(&**word), "{kind} {i}");
        }
        for i in [words.len() as u32, u32::MAX] {
            assert_eq!(text(name_of(i)), None, "{kind} {i}");
        }
    }
}

/// `JAW_OPEN` of `jawOpen`.
fn constant_of(weight: &str) -> String {
    let letters = weight.chars().flat_map(|c| match c.is_uppercase() {
        true => vec!['_', c],
        false => vec![c.to_ascii_uppercase()],
    });
    letters.collect()
}

#[test]
fn weights_have_the_names_of_their_constants() {
    let header = xtask::header::read().expect("posewise.h is read");
    let constants = |prefix| header.with_prefix(prefix);
    let animations = constants("ANIMATION_").len();
    assert_eq!(animations, posewise::ANIMATIONS);
    for (name, i) in constants("ANIMATION_") {
        let weight = text(names::posewise_animation_name(i as u32)).expect("a name");
        assert_eq!(name, constant_of(weight));
    }
    assert_eq!(constants("EYE_LOOK_").len(), posewise::EYE_LOOKS);
    for (name, i) in constants("EYE_LOOK_") {
        let weight = text(names::posewise_eye_look_name(i as u32)).expect("a name");
        assert_eq!(format!("EYE_LOOK_{name}"), constant_of(weight));
    }
    assert_eq!(text(names::posewise_animation_name(24)), None);
    assert_eq!(text(names::posewise_eye_look_name(8)), None);
}

/// Rust and C say the same words of the driver monitor.
#[test]
fn words_of_the_monitor_are_those_of_rust() {
    use posewise::{Drowsiness, EyeState, Preset, UnknownReason};
    let header = xtask::header::read().expect("posewise.h is read");
    let words = |kind| header.words(kind).expect(kind);
    assert_eq!(words("MONITOR_PRESET"), Preset::ALL.map(Preset::name));
    let eyes = [EyeState::Unknown, EyeState::Open, EyeState::Closed];
    assert_eq!(words("MONITOR_EYES"), eyes.map(EyeState::name));
    let reasons = [
        None,
        Some(UnknownReason::NoFace),
        Some(UnknownReason::LowConfidence),
        Some(UnknownReason::Turned),
        Some(UnknownReason::Hidden),
    ];
    let reasons = reasons.map(UnknownReason::name_of);
    assert_eq!(words("MONITOR_REASON"), reasons);
    let drowsiness = [
        Drowsiness::Unknown,
        Drowsiness::Awake,
        Drowsiness::Questionable,
        Drowsiness::Drowsy,
    ];
    assert_eq!(
        words("MONITOR_DROWSINESS"),
        drowsiness.map(Drowsiness::name)
    );
}

/// The example at the header's head.
fn example(header: &str) -> String {
    let (_, rest) = header.split_once("@code\n").expect("an example");
    let (example, _) = rest.split_once(" * @endcode").expect("an end");
    example.replace("\n * ", "\n").replacen(" * ", "", 1)
}

#[test]
fn the_example_of_the_header_compiles() {
    let header = std::fs::read_to_string(root().join("include/posewise.h")).expect("posewise.h");
    let example = example(&header);
    assert_eq!(example.lines().count(), 10, "{example}");
    let program = format!(
        "#include <posewise.h>\n#include <stdio.h>\n#include <stdlib.h>\n\
         int camera_read(posewise_frame *frame);\nint run(void);\n\
         int run(void) {{\n{example}return status;\n}}\n"
    );
    let file = scratch("header-example").join("example.c");
    std::fs::write(&file, program).expect("target/ is writable");
    for shared in [None, Some("-DPOSEWISE_SHARED")] {
        let mut compile = std::process::Command::new(cc());
        compile.args(["-std=c11", "-fsyntax-only"]).args(STRICT);
        compile.arg("-I").arg(root().join("include"));
        succeed(compile.args(shared).arg(&file));
    }
}
