//! `include/posewise.h` is up to date with `src/ffi`, and its version is that of Cargo.toml.

use crate::common::root;
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
        .with_src(root().join("src/ffi/monitor_types.rs"))
        .with_src(root().join("src/ffi/api.rs"))
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
        ("posewise_intrinsics", _) => zeros(4),
        ("posewise_perclos", _) => zeros(6),
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
        "// Initialises a {name}: struct_size is set, all other fields are 0.\n\
         #define {macro_name} \\\n{values}\n"
    )
}

/// Formats the constants: suffixes, hexadecimal for bit patterns, values and comments in columns,
/// an empty line between families. Removes rustdoc's escapes and names types by their typedef.
fn tidy(header: &str) -> String {
    let header = header.replace("\\[", "[").replace("\\]", "]");
    let mut out = String::new();
    let constants = header.lines().filter_map(constant);
    let (names, values): (Vec<_>, Vec<_>) = constants.map(|(n, v)| (n.len(), v.len())).unzip();
    let width = |lengths: Vec<usize>| lengths.into_iter().max().unwrap_or(0);
    let (name_width, value_width) = (width(names), width(values));
    let mut lines = header.lines().peekable();
    let mut previous_family = None;
    while let Some(line) = lines.next() {
        let comment = line.strip_prefix("// ");
        let define = comment.and(lines.peek()).and_then(|next| constant(next));
        if let (Some(comment), Some((name, value))) = (comment, define) {
            lines.next();
            let family = Some(family(name));
            if family == previous_family && out.ends_with("\n\n") {
                out.pop();
            }
            previous_family = family;
            let comment = comment.trim_end_matches('.');
            writeln!(
                out,
                "#define {name:<name_width$} {value:<value_width$} // {comment}"
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

/// Second words of the names of families.
const FAMILIES: [&str; 15] = [
    "E", "EVENT", "FMT", "FRAME", "LENS", "LOSS", "MONITOR", "PRESET", "ZONE", "EYES", "UNKNOWN",
    "LEVEL", "DRIVER", "PART", "TERMS",
];

/// Constants of one family stand together.
fn family(name: &str) -> &str {
    match name.split('_').nth(1) {
        Some("OK") => "E",
        Some("SEARCHING" | "TRACKING" | "COASTING") => "state",
        Some(family) if FAMILIES.contains(&family) => family,
        _ => "",
    }
}

/// Name and rewritten value of a `#define` line.
fn constant(line: &str) -> Option<(&str, String)> {
    let (name, value) = line.strip_prefix("#define ")?.split_once(' ')?;
    if !name.starts_with("POSEWISE_") || name == "POSEWISE_H" {
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
    let api = read("api.rs") + &read("monitor.rs");
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
