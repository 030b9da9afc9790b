//! Links between pages lead to files and headings that are there.

use super::style::text_files;
use crate::common::root;
use std::path::Path;

/// The targets of a page's links.
fn targets(text: &str) -> impl Iterator<Item = &str> {
    let links = text.split("](").skip(1);
    links.filter_map(|rest| rest.split_once(')').map(|(target, _)| target))
}

/// Whether a page has a heading with this anchor, as forges make them.
fn has_heading(page: &Path, anchor: &str) -> bool {
    let text = std::fs::read_to_string(page).unwrap_or_default();
    let headings = text.lines().filter(|line| line.starts_with('#'));
    headings.into_iter().any(|line| {
        let title = line.trim_start_matches('#').trim().to_lowercase();
        let kept = title
            .chars()
            .filter(|c| c.is_alphanumeric() || " -_".contains(*c));
        kept.map(|c| if c == ' ' { '-' } else { c })
            .eq(anchor.chars())
    })
}

#[test]
fn links_lead_somewhere() {
    let mut files = Vec::new();
    text_files(root(), &mut files);
    files.retain(|path| path.extension().is_some_and(|ending| ending == "md"));
    // The texts of generated pages, whose links are those of docs/accuracy.md.
    files.retain(|path| !path.starts_with(root().join("crates/xtask")));
    let (mut count, mut broken) = (0, String::new());
    for page in &files {
        let text = std::fs::read_to_string(page).expect("UTF-8");
        for target in targets(&text).filter(|target| !target.contains(':')) {
            let (path, anchor) = target.split_once('#').unwrap_or((target, ""));
            let file = match path {
                "" => page.clone(),
                _ => page.with_file_name(path),
            };
            count += 1;
            if !file.exists() || !anchor.is_empty() && !has_heading(&file, anchor) {
                broken += &format!("{}: {target}\n", page.display());
            }
        }
    }
    assert!(broken.is_empty(), "broken links:\n{broken}");
    assert!(count > 100, "{count} links");
}
