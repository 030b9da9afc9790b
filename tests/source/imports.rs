//! Which file of a crate imports which. No file imports, directly or through others, one that
//! imports it.
//!
//! Read from the source text: the paths in `use` items and in code, resolved to the file of the
//! module that they name. A path through a re-export (`pub use`) names the file of the item, and
//! the re-export itself is no import. A module's `mod` items and its inline test modules do not
//! count.

use crate::common::{root, scratch};
use proc_macro2::{Delimiter, TokenStream, TokenTree};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Folders with a crate's source; their files are compared with each other only.
fn sources() -> Vec<PathBuf> {
    let crates = std::fs::read_dir(root().join("crates")).expect("a folder");
    let crates = crates.map(|entry| entry.expect("an entry").path());
    let mut sources: Vec<PathBuf> = crates
        .chain([root().to_path_buf()])
        .map(|c| c.join("src"))
        .collect();
    sources.sort();
    sources
}

/// A module as the names from the crate's root.
pub type Module = Vec<String>;

/// Modules by file; the root (`lib.rs`, `main.rs`) is the empty module. A `main.rs` beside a
/// `lib.rs` is a crate of its own, which nothing imports.
pub fn modules(source: &Path) -> BTreeMap<Module, PathBuf> {
    let mut found = BTreeMap::new();
    let mut folders = vec![(source.to_path_buf(), Module::new())];
    while let Some((folder, module)) = folders.pop() {
        for entry in std::fs::read_dir(&folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            let name = path.file_stem().expect("a name").to_string_lossy();
            let child = || [&module[..], &[name.to_string()]].concat();
            if path.is_dir() {
                folders.push((path.clone(), child()));
            } else if path.extension().is_some_and(|e| e == "rs") {
                if name == "main" && folder.join("lib.rs").exists() {
                    continue;
                }
                let module = match &*name {
                    "lib" | "main" | "mod" => module.clone(),
                    _ => child(),
                };
                found.insert(module, path);
            }
        }
    }
    found
}

/// The paths of a file (`a::b::c`), also those of `a::{b, c}`, each with the inline module it is
/// in.
struct Paths {
    found: Vec<(Module, Vec<String>)>,
    /// What `use` items call the last name of a path.
    names: BTreeMap<String, Vec<String>>,
    /// The same for `pub use` items, whatever the visibility.
    exports: BTreeMap<String, Vec<String>>,
    /// Whether a `pub use` item is being read.
    exporting: bool,
}

impl Paths {
    fn of(text: &str) -> Paths {
        let mut paths = Paths {
            found: Vec::new(),
            names: BTreeMap::new(),
            exports: BTreeMap::new(),
            exporting: false,
        };
        let tokens: TokenStream = text.parse().expect("Rust code");
        paths.read(tokens, &Module::new(), &[]);
        paths
    }

    fn read(&mut self, tokens: TokenStream, inline: &Module, prefix: &[String]) {
        let trees: Vec<TokenTree> = tokens.into_iter().collect();
        let mut at = 0;
        while at < trees.len() {
            match &trees[at] {
                TokenTree::Ident(word) if word == "mod" => {
                    if let (Some(TokenTree::Ident(name)), Some(TokenTree::Group(body))) =
                        (trees.get(at + 1), trees.get(at + 2))
                    {
                        if name != "tests" {
                            let inside = [&inline[..], &[name.to_string()]].concat();
                            self.read(body.stream(), &inside, &[]);
                        }
                        at += 1;
                    }
                    at += 2;
                }
                TokenTree::Ident(word) if word == "pub" => {
                    let restricted = matches!(trees.get(at + 1), Some(TokenTree::Group(_)));
                    at += 1 + usize::from(restricted);
                    let next = trees.get(at).map(ToString::to_string);
                    self.exporting = inline.is_empty() && next.as_deref() == Some("use");
                }
                TokenTree::Ident(_) => at = self.path(&trees, at, inline, prefix),
                TokenTree::Group(group) => {
                    self.read(group.stream(), inline, &[]);
                    at += 1;
                }
                TokenTree::Punct(mark) => {
                    self.exporting &= mark.as_char() != ';';
                    at += 1;
                }
                TokenTree::Literal(_) => at += 1,
            }
        }
    }

    /// Reads the path that begins at a word; returns what comes after it.
    fn path(
        &mut self,
        trees: &[TokenTree],
        mut at: usize,
        inline: &Module,
        prefix: &[String],
    ) -> usize {
        let mark_at = |at: usize| match trees.get(at) {
            Some(TokenTree::Punct(punct)) => Some(punct.as_char()),
            _ => None,
        };
        let is = |at: usize, mark: char| mark_at(at) == Some(mark);
        // `.method`, `$crate` and `'lifetime` are no paths.
        let follows = at > 0 && ['.', '$', '\''].iter().any(|mark| is(at - 1, *mark));
        let mut path = prefix.to_vec();
        let mut renamed = None;
        loop {
            match trees.get(at) {
                Some(TokenTree::Ident(word)) => path.push(word.to_string()),
                Some(TokenTree::Group(group)) if group.delimiter() == Delimiter::Brace => {
                    self.read_group(group.stream(), inline, &path);
                    return at + 1;
                }
                _ => break,
            }
            at += 1;
            if !(is(at, ':') && is(at + 1, ':')) {
                break;
            }
            at += 2;
        }
        if let (Some(TokenTree::Ident(word)), Some(TokenTree::Ident(name))) =
            (trees.get(at), trees.get(at + 1))
            && word == "as"
        {
            renamed = Some(name.to_string());
        }
        if !follows && path.len() > 1 {
            let last = path.last().expect("a path").clone();
            let name = renamed.unwrap_or(last);
            if self.exporting {
                self.exports.insert(name, path);
            } else {
                self.names.entry(name).or_insert(path.clone());
                self.found.push((inline.clone(), path));
            }
        }
        at
    }

    /// The members of `prefix::{…}`.
    fn read_group(&mut self, tokens: TokenStream, inline: &Module, prefix: &[String]) {
        let trees: Vec<TokenTree> = tokens.into_iter().collect();
        let mut at = 0;
        while at < trees.len() {
            at = match &trees[at] {
                TokenTree::Ident(word) if word == "self" => {
                    self.found.push((inline.clone(), prefix.to_vec()));
                    at + 1
                }
                TokenTree::Ident(word) if word == "as" => at + 2,
                TokenTree::Ident(_) => self.path(&trees, at, inline, prefix),
                _ => at + 1,
            };
        }
    }
}

/// The path from the crate's root; `None` for what is not of this crate.
fn absolute(
    path: &[String],
    here: &Module,
    names: &BTreeMap<String, Vec<String>>,
    modules: &BTreeMap<Module, PathBuf>,
) -> Option<Vec<String>> {
    let first = path.first()?.as_str();
    let rest = &path[1..];
    match first {
        "crate" => Some(rest.to_vec()),
        "self" => Some([here, rest].concat()),
        "super" => {
            let parent = here[..here.len().checked_sub(1)?].to_vec();
            match rest.first().is_some_and(|word| word == "super") {
                true => absolute(rest, &parent, names, modules),
                false => Some([&parent[..], rest].concat()),
            }
        }
        _ => {
            let child = [&here[..], &[first.to_string()]].concat();
            if modules.contains_key(&child) {
                return Some([&child[..], rest].concat());
            }
            let import = names.get(first).filter(|import| import[0] != first)?;
            let import = absolute(import, here, &BTreeMap::new(), modules)?;
            Some([&import[..], rest].concat())
        }
    }
}

/// The module whose file defines the item of a path, re-exports followed.
fn owner(
    mut path: Vec<String>,
    modules: &BTreeMap<Module, PathBuf>,
    texts: &BTreeMap<Module, Paths>,
) -> Option<Module> {
    loop {
        let prefixes = (0..=path.len()).rev().map(|n| path[..n].to_vec());
        let module = prefixes.into_iter().find(|m| modules.contains_key(m))?;
        let rest = &path[module.len()..];
        let exports = &texts[&module].exports;
        let Some(export) = rest.first().and_then(|name| exports.get(name)) else {
            return Some(module);
        };
        let Some(target) = absolute(export, &module, &BTreeMap::new(), modules) else {
            return Some(module);
        };
        path = [&target[..], &rest[1..]].concat();
    }
}

/// Which modules each module's file imports.
pub fn imports(source: &Path) -> BTreeMap<Module, BTreeSet<Module>> {
    let modules = modules(source);
    let read = |path: &PathBuf| Paths::of(&std::fs::read_to_string(path).expect("a source file"));
    let texts: BTreeMap<Module, Paths> = (modules
        .iter()
        .map(|(module, path)| (module.clone(), read(path))))
    .collect();
    let of = |(module, paths): (&Module, &Paths)| {
        let mut used = BTreeSet::new();
        for (inline, path) in &paths.found {
            let here = [&module[..], inline].concat();
            let path = absolute(path, &here, &paths.names, &modules);
            let owner = path.and_then(|path| owner(path, &modules, &texts));
            used.extend(owner.filter(|owner| owner != module));
        }
        (module.clone(), used)
    };
    texts.iter().map(of).collect()
}

/// A cycle of imports, if there is one.
fn cycle(imports: &BTreeMap<Module, BTreeSet<Module>>) -> Option<Vec<Module>> {
    fn visit(
        module: &Module,
        imports: &BTreeMap<Module, BTreeSet<Module>>,
        done: &mut BTreeSet<Module>,
        path: &mut Vec<Module>,
    ) -> Option<Vec<Module>> {
        if let Some(start) = path.iter().position(|m| m == module) {
            return Some(path[start..].to_vec());
        }
        if done.contains(module) {
            return None;
        }
        path.push(module.clone());
        let found = imports[module]
            .iter()
            .find_map(|next| visit(next, imports, done, path));
        path.pop();
        done.insert(module.clone());
        found
    }
    let mut done = BTreeSet::new();
    imports
        .keys()
        .find_map(|module| visit(module, imports, &mut done, &mut Vec::new()))
}

#[test]
fn no_crate_has_an_import_cycle() {
    let shown = |cycle: Vec<Module>| {
        let names: Vec<String> = cycle.iter().map(|m| m.join("::")).collect();
        names.join(" -> ")
    };
    let sources = sources();
    assert!(sources.len() > 1, "{sources:?}");
    let cycles: Vec<String> = sources
        .iter()
        .filter_map(|source| {
            let found = cycle(&imports(source))?;
            Some(format!("{}: {}", source.display(), shown(found)))
        })
        .collect();
    assert!(cycles.is_empty(), "{}", cycles.join("\n"));
}

#[test]
fn a_cycle_is_found() {
    let folder = scratch("cycles");
    let write = |name: &str, text: &str| {
        std::fs::create_dir_all(folder.join("b")).expect("a folder");
        std::fs::write(folder.join(name), text).expect("a file");
    };
    write("lib.rs", "pub mod a; pub mod b; pub mod c;");
    write(
        "a.rs",
        "use crate::b::{self as other, inner::{X, Y}}; fn f() { other::g() }",
    );
    write(
        "b/mod.rs",
        "mod inner; pub(crate) use inner::{X, Y as Z}; pub fn g() {}",
    );
    write(
        "b/inner.rs",
        "pub struct X; pub struct Y; mod tests { use crate::a; }",
    );
    write("c.rs", "pub fn h(_: crate::b::Z) { crate::a::f() }");
    let module = |text: &str| -> Module { text.split("::").map(String::from).collect() };
    let found = imports(&folder);
    assert!(found[&module("a")].contains(&module("b::inner")));
    assert!(found[&module("a")].contains(&module("b")));
    assert!(found[&module("b::inner")].is_empty());
    assert!(found[&module("b")].is_empty());
    assert!(found[&module("c")].contains(&module("b::inner")));
    assert!(!found[&module("c")].contains(&module("b")));
    assert_eq!(cycle(&found), None);
    write(
        "b/inner.rs",
        "use super::super::c; pub struct X; pub struct Y;",
    );
    let found = cycle(&imports(&folder)).expect("a -> b::inner -> c -> a");
    assert_eq!(found.len(), 3);
}
