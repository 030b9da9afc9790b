//! What the object files of a static library define and ask for.

use anyhow::{Context, Result, ensure};
use object::read::archive::ArchiveFile;
use object::{BinaryFormat, File, Object, ObjectSymbol, SymbolScope};
use std::collections::BTreeSet;
use std::path::Path;

/// Functions that every C library has. `bzero` and `memset_pattern16` are Apple's.
const MEMORY_FUNCTIONS: [&str; 6] = [
    "bzero",
    "memcmp",
    "memcpy",
    "memmove",
    "memset",
    "memset_pattern16",
];

/// What is in a static library.
#[derive(Debug, Default)]
pub struct Contents {
    /// Formats and machines of its object files, as `Elf Aarch64`.
    pub machines: BTreeSet<String>,
    /// What other programs can link to.
    pub exported: BTreeSet<String>,
    /// What its functions ask of other libraries.
    pub imported: BTreeSet<String>,
}

/// Names of an object file's global symbols.
#[derive(Default)]
struct Member {
    defined: BTreeSet<String>,
    undefined: BTreeSet<String>,
}

/// Reads a static library.
pub fn contents(archive: &Path) -> Result<Contents> {
    let bytes = std::fs::read(archive).with_context(|| format!("cannot read {archive:?}"))?;
    let mut contents = Contents::default();
    let mut members = Vec::new();
    for entry in ArchiveFile::parse(&*bytes)?.members() {
        let entry = entry?;
        let name = String::from_utf8_lossy(entry.name());
        let file = File::parse(entry.data(&*bytes)?).with_context(|| name.to_string())?;
        let machine = format!("{:?} {:?}", file.format(), file.architecture());
        contents.machines.insert(machine);
        let mut member = Member::default();
        for symbol in file.symbols().filter(ObjectSymbol::is_global) {
            // Apple's C compilers put an underscore before each name.
            let name = symbol.name()?;
            let name = match file.format() {
                BinaryFormat::MachO => name.strip_prefix('_').unwrap_or(name),
                _ => name,
            };
            if symbol.is_undefined() {
                member.undefined.insert(name.into());
                continue;
            }
            member.defined.insert(name.into());
            // Apple's linker keeps those of narrower scope inside of the program.
            if symbol.scope() == SymbolScope::Dynamic {
                contents.exported.insert(name.into());
            }
        }
        members.push(member);
    }
    contents.imported = imported(&members);
    Ok(contents)
}

/// What the object files ask for that a linker takes for the functions of the header, and that
/// none of them defines. Apple's library also holds parts of Rust's that no function needs.
fn imported(members: &[Member]) -> BTreeSet<String> {
    let is_own = |name: &String| name.starts_with("posewise_");
    let own = |member: &&Member| member.defined.iter().any(is_own);
    let mut wanted: Vec<&Member> = members.iter().filter(own).collect();
    let mut seen = BTreeSet::new();
    let mut imported = BTreeSet::new();
    while let Some(member) = wanted.pop() {
        for name in member
            .undefined
            .iter()
            .filter(|name| seen.insert(name.to_string()))
        {
            match members.iter().find(|other| other.defined.contains(name)) {
                Some(other) => wanted.push(other),
                None => _ = imported.insert(name.clone()),
            }
        }
    }
    imported
}

/// Fails when a library is for another machine, exports other names than those of the header, or
/// asks for more than the memory functions of a C library.
pub(super) fn check(archive: &Path, machine: &str) -> Result<()> {
    let found = contents(archive)?;
    ensure!(
        found.machines.iter().eq([machine]),
        "{archive:?} is for {:?}",
        found.machines
    );
    let mut exported = found.exported.iter();
    let foreign = exported.find(|name| !name.starts_with("posewise_"));
    ensure!(foreign.is_none(), "{archive:?} exports {foreign:?}");
    let has_step = found.exported.contains("posewise_step");
    ensure!(has_step, "{archive:?} exports no posewise_step");
    let known = |name: &&String| MEMORY_FUNCTIONS.contains(&name.as_str());
    let missing = found.imported.iter().find(|name| !known(name));
    ensure!(missing.is_none(), "{archive:?} asks for {missing:?}");
    Ok(())
}
