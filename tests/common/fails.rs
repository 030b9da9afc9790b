//! Programs that must fail.

/// Runs a program, which must fail with exit code 1, no panic, and a message that contains each of
/// `words`.
pub fn fails(mut program: assert_cmd::Command, words: &[&str]) {
    let run = program.assert();
    let output = run.get_output();
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{program:?}: {said}");
    assert!(!said.contains("panicked"), "{program:?}: {said}");
    for word in words {
        assert!(said.contains(word), "{program:?} must say {word:?}: {said}");
    }
}
