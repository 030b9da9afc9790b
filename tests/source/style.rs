//! No line of a text file is longer than 100 characters, tables in Markdown included: what does not
//! fit into a row belongs in a list or in a sentence below the table.

use crate::common::root;
use std::path::{Path, PathBuf};

const LIMIT: usize = 100;

/// Endings, or whole names, of the files that people write and read.
const ENDINGS: &str = "md rs toml yml c h cpp hpp java modulemap ld sh cmake in txt run tools \
     Makefile js mjs html css py";

/// Folders that hold what programs write.
const OUTPUT: [&str; 5] = ["target", "cache", "corpus", "artifacts", "node_modules"];

/// Hidden folders that people write.
const OWN: [&str; 3] = [".cargo", ".ci", ".github"];

pub fn text_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        let name = path.file_name().expect("a name").to_string_lossy();
        // Licences of others, as they wrote them.
        if name.starts_with("NOTICES") {
            continue;
        }
        let hidden = name.starts_with('.') && !OWN.contains(&&*name);
        if path.is_dir() {
            if !hidden && !OUTPUT.contains(&&*name) && !path.is_symlink() {
                text_files(&path, found);
            }
        } else if let Some(ending) = name.rsplit('.').next()
            && ENDINGS.split(' ').any(|known| known == ending)
        {
            found.push(path);
        }
    }
}

#[test]
fn lines_fit() {
    let mut files = Vec::new();
    text_files(root(), &mut files);
    files.sort();
    let mut long = String::new();
    for path in files {
        let shown = path.strip_prefix(root()).expect("inside");
        let text = std::fs::read_to_string(&path).expect("UTF-8");
        for (i, line) in text.lines().enumerate() {
            let length = line.chars().count();
            if length > LIMIT {
                long += &format!("{}:{}: {length}\n", shown.display(), i + 1);
            }
        }
    }
    assert!(long.is_empty(), "lines above {LIMIT} characters:\n{long}");
}
