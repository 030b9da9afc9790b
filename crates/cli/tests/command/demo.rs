//! `posewise demo` on the clip that ships with posewise.

use crate::common::posewise;

#[test]
fn demo_writes_picture_and_table() {
    let dir = tempfile::tempdir().unwrap();
    let run = posewise()
        .arg("demo")
        .current_dir(dir.path())
        .assert()
        .success();
    let said = String::from_utf8_lossy(&run.get_output().stdout).into_owned();
    for word in ["frames", "tracked", "step", "model", "tracker memory"] {
        assert!(said.contains(word), "{said}");
    }
    let table = std::fs::read_to_string(dir.path().join("posewise-demo.csv")).unwrap();
    assert_eq!(table.lines().count(), 121);
    let sheet = image::open(dir.path().join("posewise-demo.png")).unwrap();
    assert_eq!((sheet.width(), sheet.height()), (3 * 320, 2 * 240));
}
