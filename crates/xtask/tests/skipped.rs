//! The last of the workspace's tests, by the name of its package: says what the others skipped, and
//! what they leave to `.ci/nightly`.

use std::path::Path;

#[path = "../../../tests/common/skip.rs"]
#[allow(dead_code)] // it skips nothing itself
mod skip;

fn main() {
    let list = skip::list();
    let text = std::fs::read_to_string(&list).unwrap_or_default();
    let _ = std::fs::remove_file(list);
    println!("\n{} skips for what is missing here", text.lines().count());
    print!("{text}");
    if std::env::args().any(|argument| argument.ends_with("ignored")) {
        return; // the night's run
    }
    let left = left_to_the_night();
    println!("{} tests are left to .ci/nightly", left.len());
    print!("{}", left.concat());
}

/// Lines about the tests that are marked so: `#[ignore = "WHY: .ci/nightly"]`.
fn left_to_the_night() -> Vec<String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut folders = ["crates", "src", "tests"]
        .map(|name| root.join(name))
        .to_vec();
    let mut left = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).expect("a folder of the repository") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|ending| ending == "rs") {
                let text = std::fs::read_to_string(&path).expect("a source file");
                let file = path.strip_prefix(&root).expect("inside").display();
                left.extend(
                    marked(&text).map(|(test, why)| format!("left: {file}: {test}: {why}\n")),
                );
            }
        }
    }
    left.sort();
    left
}

/// Names of the marked tests in a source file, and why each is marked.
fn marked(source: &str) -> impl Iterator<Item = (&str, &str)> {
    source.split("#[ignore = \"").skip(1).filter_map(|rest| {
        let (why, rest) = rest.split_once("\"]\nfn ")?;
        Some((rest.split('(').next()?, why.strip_suffix(": .ci/nightly")?))
    })
}
