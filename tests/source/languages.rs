//! JavaScript and Python reach every function of the header, and an example shows every call.

use crate::common::root;
use std::collections::BTreeSet;
use std::fs;
use xtask::interface::Table;

/// Functions that neither language needs, and why.
const NEITHER: [(&str, &str); 6] = [
    (
        "default_model",
        "both packages have the models as files, and libraries without one",
    ),
    ("state_name", "words are generated from the constants"),
    ("loss_name", "words are generated from the constants"),
    ("event_name", "words are generated from the constants"),
    ("eye_status_name", "words are generated from the constants"),
    (
        "monitor_event_name",
        "words are generated from the constants",
    ),
];

/// Functions that JavaScript does not need, and why.
const NOT_JAVASCRIPT: [(&str, &str); 1] = [(
    "set_cpu",
    "the compiler of the browser knows the processor; no bit is for WebAssembly",
)];

/// What trackers of JavaScript and Python have that needs no example.
const PLAIN: [&str; 1] = ["pending"];

/// Files of a folder whose names end so, as one text.
fn text(folder: &str, ending: &str) -> String {
    let entries = fs::read_dir(root().join(folder)).expect(folder);
    let paths = entries.map(|entry| entry.expect("an entry").path());
    let mut paths: Vec<_> = paths
        .filter(|path| path.to_string_lossy().ends_with(ending))
        .collect();
    paths.sort();
    assert!(!paths.is_empty(), "{folder}/*{ending}");
    let texts = paths
        .iter()
        .map(|path| fs::read_to_string(path).expect("a text"));
    texts.collect()
}

#[test]
fn every_function_is_reached() {
    let table = Table::read().expect("src/ffi is read");
    let declared = text("python/posewise", "_library.py");
    // Where the types of the arguments are is no call.
    let (list, _) = declared
        .split_once("]:\n    _function = ")
        .expect("the list");
    let python = text("python/posewise", ".py").replace(list, "");
    let javascript = text("web", ".js");
    let mut unreached = Vec::new();
    for function in &table.functions {
        let name = function.name.strip_prefix("posewise_").expect("a prefix");
        let is_listed = |list: &[(&str, &str)]| list.iter().any(|(listed, _)| *listed == name);
        let is_called = |text: &str, quote: &str| {
            let calls = [
                format!("{quote}{name}{quote}"),
                format!(".posewise_{name}("),
            ];
            calls.iter().any(|call| text.contains(call))
        };
        let languages = [
            ("Python", is_called(&python, "\""), is_listed(&NEITHER)),
            (
                "JavaScript",
                is_called(&javascript, "'"),
                is_listed(&NEITHER) || is_listed(&NOT_JAVASCRIPT),
            ),
        ];
        for (language, is_reached, is_unneeded) in languages {
            if is_reached == is_unneeded {
                unreached.push((language, name, is_unneeded));
            }
        }
    }
    assert!(
        unreached.is_empty(),
        "reached although the list says no (true), or not reached (false): {unreached:?}"
    );
}

/// The public methods of a text: what stands between a start and an end of a line.
fn methods(text: &str, starts: &[&str], end: char) -> BTreeSet<String> {
    let lines = text.lines().filter_map(|line| {
        let rest = starts.iter().find_map(|start| line.strip_prefix(start))?;
        let (name, _) = rest.split_once(end)?;
        let is_name = name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
        (is_name && !name.starts_with('_')).then(|| name.to_owned())
    });
    lines.collect()
}

#[test]
fn every_call_is_in_an_example() {
    let shown = text("python/examples", ".py")
        + &fs::read_to_string(root().join("python/README.md")).expect("a page");
    let python = text("python/posewise", "_tracker.py")
        + &text("python/posewise", "_group.py")
        + &text("python/posewise", "_monitor.py")
        + &text("python/posewise", "_handle.py")
        + &text("python/posewise", "_model.py")
        + &text("python/posewise", "_video.py");
    let mut calls = methods(&python, &["    def ", "def "], '(');
    for internal in ["path_of", "checked"] {
        assert!(calls.remove(internal), "{internal}");
    }
    assert!(calls.len() > 20, "{calls:?}");
    calls.retain(|name| !shown.contains(&format!("{name}(")));
    assert_eq!(calls, BTreeSet::new(), "no example in Python");

    let shown = text("web/examples", ".mjs")
        + &text("web/test/app", ".js")
        + &fs::read_to_string(root().join("web/README.md")).expect("a page");
    let javascript = ["posewise.js", "tracker.js", "group.js", "monitor.js"];
    let javascript = javascript.map(|name| text("web", name));
    let starts = ["  async ", "  static async ", "  get ", "  "];
    let mut calls = methods(&javascript.concat(), &starts, '(');
    calls.retain(|name| !["constructor", "if", "for"].contains(&&**name));
    assert!(calls.len() > 20, "{calls:?}");
    calls.retain(|name| !PLAIN.contains(&&**name) && !shown.contains(&format!("{name}(")));
    assert_eq!(calls, BTreeSet::new(), "no example in JavaScript");
}
