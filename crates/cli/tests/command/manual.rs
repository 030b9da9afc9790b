//! Manual pages and shell completions follow from the grammar, and the shells accept them.

use crate::common::skip::skipped;
use crate::common::{arg, posewise};
use std::path::Path;
use std::process::Command;

/// What a program prints, or nothing where it is missing.
fn said(program: &str, arguments: &[&str]) -> Option<String> {
    let Ok(output) = Command::new(program).args(arguments).output() else {
        skipped(program);
        return None;
    };
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let (out, errors) = (text(&output.stdout), text(&output.stderr));
    assert!(output.status.success(), "{program}: {out}{errors}");
    assert_eq!(errors, "", "{program}");
    Some(out)
}

/// What bash offers for the last of these words.
fn completions(script: &Path, words: &[&str]) -> Option<String> {
    let [.., previous, last] = words else {
        panic!("two words at least")
    };
    let script = script.display();
    let (line, index) = (words.join(" "), words.len() - 1);
    let typed = format!("COMP_WORDS=({line}); COMP_CWORD={index}");
    let ask = format!(". '{script}'; {typed}; _posewise posewise {last} {previous}");
    said("bash", &["-c", &format!("{ask}; echo ${{COMPREPLY[@]}}")])
}

#[test]
fn pages_and_completions_are_whole() {
    let folder = tempfile::tempdir().unwrap();
    posewise()
        .args(["manual", arg(folder.path())])
        .assert()
        .success();
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).expect(name);

    for page in ["posewise", "posewise-track", "posewise-model-info"] {
        let path = folder.path().join(format!("man/man1/{page}.1"));
        // groff prints its warnings, of which there must be none.
        if let Some(text) = said("groff", &["-Kutf8", "-man", "-ww", "-Tutf8", arg(&path)]) {
            assert!(text.contains(page), "{page}: {text}");
        }
    }
    assert!(read("man/man1/posewise-track.1").contains("overlay\\-style"));

    let bash = folder
        .path()
        .join("bash-completion/completions/posewise.bash");
    if let Some(offered) = completions(&bash, &["posewise", "mo"]) {
        assert_eq!(offered.trim(), "model");
    }
    if let Some(offered) = completions(&bash, &["posewise", "track", "--overlay"]) {
        assert_eq!(offered.trim(), "--overlay --overlay-style");
    }
    // The command that writes them is nobody's but the packages'.
    let all = [
        "bash-completion/completions/posewise.bash",
        "man/man1/posewise.1",
    ];
    for file in all.into_iter().chain(["zsh/site-functions/_posewise"]) {
        assert!(!read(file).contains("manual"), "{file}");
    }
    assert!(read("fish/vendor_completions.d/posewise.fish").contains("overlay-style"));
}
