//! What is generated from `src/ffi` is up to date, and what its comments say is so.

use crate::common::c::{STRICT, cc, succeed};
use crate::common::{root, scratch};
use posewise::ffi::api::{posewise_config_default, posewise_memory_size};
use posewise::ffi::monitor::{posewise_monitor_config_default, posewise_monitor_memory_size};
use posewise::ffi::monitor_types::{POSEWISE_MONITOR_PRESET_GENERAL, posewise_monitor_config};
use posewise::ffi::types::{POSEWISE_OK, posewise_config};
use posewise::ffi::{monitor, names};
use xtask::interface::{self as generated, Field, Kind, Table, layout};

fn table() -> Table {
    Table::read().expect("src/ffi is read")
}

/// The header, the layouts for JavaScript and Python, and their likes.
#[test]
fn generated_files_are_up_to_date() {
    generated::check().unwrap_or_else(|error| panic!("{error:#}"));
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
    let header = std::fs::read_to_string(root().join("include/posewise.h")).expect("posewise.h");
    let folder = std::fs::read_dir(root().join("src/ffi")).expect("a folder");
    let text = |path: &std::path::Path| std::fs::read_to_string(path).expect("a source");
    let count = folder.map(|entry| text(&entry.expect("an entry").path()));
    let count: usize = count
        .map(|t| t.matches("#[unsafe(no_mangle)]\n").count())
        .sum();
    let functions = table().functions;
    assert_eq!(
        functions.len(),
        count,
        "in the files that the header is made of"
    );
    for function in functions {
        let name = function.name;
        assert!(
            header.contains(&format!("{name}(")),
            "{name} is not in the header"
        );
        assert!(!function.comment.is_empty(), "{name} has no comment");
    }
}

/// A struct of the header of each release is accepted: where fields came later, memory.rs has the
/// size before them.
#[test]
fn sizes_of_earlier_releases_are_accepted() {
    let memory = std::fs::read_to_string(root().join("src/ffi/memory.rs")).expect("memory.rs");
    let table = table();
    for item in table.structs.iter().filter(|item| item.grows()) {
        let name = format!("posewise_{}", item.name);
        let (_, section) = memory
            .split_once(&format!("impl Growing for {name} {{"))
            .unwrap_or_else(|| panic!("{name} in memory.rs"));
        let (_, list) = section.split_once("= &[").expect("a list");
        let (list, _) = list.split_once(']').expect("its end");
        let (_, starts) = layout::offsets(item, &table, size_of::<usize>()).expect("a layout");
        let fields: Vec<_> = item.fields.iter().zip(starts).collect();
        for pair in fields.windows(2) {
            let [(before, _), (field, start)] = [pair[0], pair[1]];
            let is_listed = list.split(", ").any(|size| size == start.to_string());
            let is_new = field.facts.since != before.facts.since;
            assert!(
                !is_new || is_listed,
                "{start}, the size before {name}.{}",
                field.name
            );
        }
    }
}

/// A struct of settings, and the numbers in it by the fields of the table.
struct Settings<T> {
    name: &'static str,
    default: T,
    is_valid: fn(&T) -> bool,
}

impl<T: Copy> Settings<T> {
    /// The fields that are one number with a default or a range, and where they are.
    fn numbers(&self, table: &Table) -> Vec<(Field, usize)> {
        let item = table.get(self.name).expect("a struct");
        let (_, starts) = layout::offsets(item, table, size_of::<usize>()).expect("a layout");
        let numbers = item.fields.iter().cloned().zip(starts);
        let is_number = |f: &Field| matches!(f.kind, Kind::U32 | Kind::F32) && f.count.is_none();
        let is_stated = |f: &Field| f.facts.default.is_some() || f.facts.range.is_some();
        numbers
            .filter(|(f, _)| is_number(f) && is_stated(f))
            .collect()
    }

    fn get(&self, kind: &Kind, at: usize) -> f64 {
        let start = std::ptr::from_ref(&self.default).cast::<u8>();
        // SAFETY: a field of four bytes is there.
        let bits = unsafe { start.add(at).cast::<u32>().read() };
        match kind {
            Kind::F32 => f64::from(f32::from_bits(bits)),
            _ => f64::from(bits),
        }
    }

    /// Whether the defaults are valid with these bits in a field.
    fn is_valid_with(&self, at: usize, bits: u32) -> bool {
        let mut settings = self.default;
        let start = std::ptr::from_mut(&mut settings).cast::<u8>();
        // SAFETY: a field of four bytes is there.
        unsafe { start.add(at).cast::<u32>().write(bits) };
        (self.is_valid)(&settings)
    }

    /// Compares defaults and ranges with the comments.
    fn check(&self) {
        assert!((self.is_valid)(&self.default));
        let numbers = self.numbers(&table());
        for (field, at) in &numbers {
            let name = &field.name;
            if let Some(stated) = &field.facts.default {
                let stated: f32 = stated.parse().expect("a number");
                assert_eq!(
                    self.get(&field.kind, *at),
                    f64::from(stated),
                    "default of {name}"
                );
            }
            let Some(range) = &field.facts.range else {
                continue;
            };
            let [least, most] = range
                .each_ref()
                .map(|text| text.parse::<f32>().expect("a number"));
            let outside = match field.kind {
                Kind::F32 => [least.next_down(), most.next_up()].map(f32::to_bits),
                _ => [(least as u32).saturating_sub(1), most as u32 + 1],
            };
            // 0 is the default.
            for bits in outside.into_iter().filter(|bits| *bits << 1 != 0) {
                assert!(
                    !self.is_valid_with(*at, bits),
                    "{name}: {bits:#x} is not in its range"
                );
            }
        }
        assert!(numbers.len() > 3, "{} fields", numbers.len());
    }
}

#[test]
fn documented_defaults_and_ranges_are_those_of_the_library() {
    let mut default = posewise_config {
        struct_size: size_of::<posewise_config>() as u32,
        ..Default::default()
    };
    // SAFETY: a whole struct, here and below.
    assert_eq!(
        unsafe { posewise_config_default(&mut default) },
        POSEWISE_OK
    );
    let is_valid = |config: &posewise_config| unsafe { posewise_memory_size(config) } != 0;
    let name = "config";
    Settings {
        name,
        default,
        is_valid,
    }
    .check();

    let mut default = posewise_monitor_config {
        struct_size: size_of::<posewise_monitor_config>() as u32,
        ..Default::default()
    };
    let preset = POSEWISE_MONITOR_PRESET_GENERAL;
    let status = unsafe { posewise_monitor_config_default(preset, &mut default) };
    assert_eq!(status, POSEWISE_OK);
    let is_valid =
        |config: &posewise_monitor_config| unsafe { posewise_monitor_memory_size(config) } != 0;
    let name = "monitor_config";
    Settings {
        name,
        default,
        is_valid,
    }
    .check();
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
    let table = table();
    let functions: [(&str, extern "C" fn(u32) -> *const std::ffi::c_char); 5] = [
        ("STATE", names::posewise_state_name),
        ("LOSS", names::posewise_loss_name),
        ("EVENT", names::posewise_event_name),
        ("EYE", names::posewise_eye_status_name),
        ("MONITOR_EVENT", monitor::posewise_monitor_event_name),
    ];
    for (kind, name_of) in functions {
        let words = table.words(kind).expect(kind);
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
    let table = table();
    let constants = |prefix| table.with_prefix(prefix);
    let animations = constants("ANIMATION_").len();
    assert_eq!(animations, posewise::ANIMATIONS);
    for (name, i) in constants("ANIMATION_") {
        let weight = text(names::posewise_animation_name(i as u32)).expect("a name");
        assert_eq!(name, constant_of(weight));
    }
    assert_eq!(constants("EYE_LOOK_").len(), posewise::eyes::EYE_LOOKS);
    for (name, i) in constants("EYE_LOOK_") {
        let weight = text(names::posewise_eye_look_name(i as u32)).expect("a name");
        assert_eq!(format!("EYE_LOOK_{name}"), constant_of(weight));
    }
    let beyond = posewise::ANIMATIONS as u32;
    assert_eq!(text(names::posewise_animation_name(beyond)), None);
    assert_eq!(text(names::posewise_eye_look_name(8)), None);
}

/// Rust and C say the same words of the driver monitor.
#[test]
fn words_of_the_monitor_are_those_of_rust() {
    use posewise::monitor::{Drowsiness, EyeState, Preset, UnknownReason, ZonesBy};
    let table = table();
    let words = |kind| table.words(kind).expect(kind);
    assert_eq!(words("MONITOR_PRESET"), Preset::ALL.map(Preset::name));
    let unknown = EyeState::Unknown(UnknownReason::NoFace);
    let eyes = [unknown, EyeState::Open, EyeState::Closed];
    assert_eq!(words("MONITOR_EYES"), eyes.map(EyeState::name));
    let reasons = [
        None,
        Some(UnknownReason::NoFace),
        Some(UnknownReason::LowConfidence),
        Some(UnknownReason::Turned),
        Some(UnknownReason::Hidden),
        Some(UnknownReason::Elsewhere),
    ];
    let reasons = reasons.map(UnknownReason::name_of);
    assert_eq!(words("MONITOR_REASON"), reasons);
    let by = [Some(ZonesBy::Gaze), Some(ZonesBy::Head), None];
    assert_eq!(words("MONITOR_BY"), by.map(ZonesBy::name_of));
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
