//! The last of the workspace's tests, by the name of its package: says what the others skipped.

#[path = "../../../tests/common/skip.rs"]
#[allow(dead_code)] // it skips nothing itself
mod skip;

fn main() {
    let list = skip::list();
    let text = std::fs::read_to_string(&list).unwrap_or_default();
    let _ = std::fs::remove_file(list);
    println!("\n{} skips for what is missing here", text.lines().count());
    print!("{text}");
}
