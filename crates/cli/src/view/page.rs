//! The page that is served: that of `web/`, with `live.js` in place of the tracker in the browser.

use anyhow::{Result, ensure};

/// A file of the page.
pub struct File {
    /// Its address below that of the page.
    pub path: &'static str,
    /// The type of its content.
    pub kind: &'static str,
    /// What it holds.
    pub text: &'static str,
}

const SCRIPT: &str = "text/javascript; charset=utf-8";

/// A script of `web/`.
macro_rules! script {
    ($path:literal) => {
        File {
            path: $path,
            kind: SCRIPT,
            text: include_str!(concat!("../../assets/web/", $path)),
        }
    };
}

/// Everything that the page loads.
pub const FILES: [File; 14] = [
    File {
        path: "demo/style.css",
        kind: "text/css; charset=utf-8",
        text: include_str!("../../assets/web/demo/style.css"),
    },
    script!("layout.js"),
    script!("demo/charts.js"),
    script!("demo/columns.js"),
    script!("demo/csv.js"),
    script!("demo/display.js"),
    script!("demo/driver/columns.js"),
    script!("demo/driver/panel.js"),
    script!("demo/driver/plan.js"),
    script!("demo/driver/zones.js"),
    script!("demo/live.js"),
    script!("demo/overlay.js"),
    script!("demo/readings.js"),
    script!("demo/save.js"),
];

const INDEX: &str = include_str!("../../assets/web/index.html");

/// What is not true here, and what is.
const CHANGES: [(&str, &str); 5] = [
    ("./demo/app.js", "./demo/live.js"),
    (
        "posewise: face tracking in this page",
        "posewise: live view",
    ),
    (
        "facial animation, in the browser",
        "facial animation, tracked elsewhere",
    ),
    (
        "    <strong>Nothing leaves this page:</strong> pictures are tracked in this browser, and \
         the page is\n    not allowed to send anything anywhere.",
        "    The <code>posewise view</code> command tracks the pictures and sends them here. This \
         page is\n    not allowed to send them anywhere else.",
    ),
    (
        "<span class=\"pixels\">pixels</span>",
        "<span class=\"pixels\">JPEG</span>",
    ),
];

/// The page.
pub fn index() -> Result<String> {
    let lines = INDEX.lines();
    let mut page: String = lines
        .filter(|line| {
            let early = [
                "<link rel=\"modulepreload\"",
                "<script type=\"module\" async",
            ];
            !early.iter().any(|start| line.starts_with(start))
        })
        .flat_map(|line| [line, "\n"])
        .collect();
    for (old, new) in CHANGES {
        ensure!(page.matches(old).count() == 1, "web/index.html: {old}");
        page = page.replace(old, new);
    }
    Ok(page)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every module that a served file imports is served too.
    #[test]
    fn the_page_is_whole() {
        let page = index().unwrap();
        assert!(page.contains("src=\"./demo/live.js\""));
        let imports = FILES.iter().flat_map(|file| {
            let folder = file.path.rsplit_once('/').map_or("", |(folder, _)| folder);
            let lines = file.text.lines().filter(|line| line.starts_with("import "));
            lines.map(move |line| (folder, line.split('\'').nth(1).expect("a path")))
        });
        for (folder, name) in imports {
            let (folder, name) = match name.strip_prefix("../") {
                Some(name) => (folder.rsplit_once('/').map_or("", |(above, _)| above), name),
                None => (folder, name.trim_start_matches("./")),
            };
            let path = format!("{folder}/{name}");
            let path = path.trim_start_matches('/');
            assert!(FILES.iter().any(|file| file.path == path), "{path}");
        }
    }
}
